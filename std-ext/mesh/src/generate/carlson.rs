//! Carlson's symmetric elliptic integral of the second kind.
//!
//! Source: B. C. Carlson, Numerical computation of real or complex elliptic integrals, Numerical
//! Algorithms 10 (1995) 13–26.

/// Number of duplications, each of which quarters the differences between the arguments.
const DUPLICATIONS: usize = 40;

/// R_G(x, y, z) = ¼ ∫₀^∞ [(t+x)(t+y)(t+z)]^{-1/2} (x/(t+x) + y/(t+y) + z/(t+z)) t dt for arguments above 0:
/// `½ [z R_F − ⅓ (x − z)(y − z) R_D + √(xy/z)]`, whose terms are all positive if z lies between the other
/// arguments.
pub(super) fn second_kind(arguments: [f64; 3]) -> f64 {
    let mut sorted = arguments;
    sorted.sort_by(f64::total_cmp);
    let [x, z, y] = sorted;
    let (mut a, mut b, mut c) = (x, y, z);
    let (mut sum, mut power) = (0.0, 1.0);
    for _ in 0..DUPLICATIONS {
        let shift = (a * b).sqrt() + (b * c).sqrt() + (c * a).sqrt();
        sum += power / (c.sqrt() * (c + shift));
        power /= 4.0;
        [a, b, c] = [a, b, c].map(|argument| (argument + shift) / 4.0);
    }
    let first_kind = a.sqrt().recip();
    let third_kind = 3.0 * sum + power * first_kind / a;
    let crossed = (x - z) * (y - z) / 3.0;
    0.5 * (z * first_kind - crossed * third_kind + (x * y / z).sqrt())
}

#[cfg(test)]
mod tests {
    use super::second_kind;

    /// Values that Carlson published, section 3.
    #[test]
    fn published_values() {
        for (arguments, expected) in [
            ([2.0, 3.0, 4.0], 1.725_503_028_069_2),
            ([1.0, 1.0, 1.0], 1.0),
        ] {
            let found = second_kind(arguments);
            assert!((found / expected - 1.0).abs() < 1e-13, "{found}");
        }
    }
}

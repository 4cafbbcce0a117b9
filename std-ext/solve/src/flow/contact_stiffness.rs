//! Stiffness of forces that keep surfaces apart or at a wall, for limits of explicit steps.

use std::f64::consts::PI;

/// The pressure by which a repulsion keeps surfaces apart: see [`helfrich::Repulsion`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Barrier {
    /// k, energy per area squared.
    pub strength: f64,
    /// r_c, the range.
    pub cutoff: f64,
    /// c, by which surfaces attract each other; 0 without.
    pub attraction: f64,
}

/// The adhesion by which a wall holds a membrane: see [`helfrich::WallAdhesion`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdhesiveWall {
    /// W, energy per area.
    pub strength: f64,
    /// λ, the range of the attraction.
    pub range: f64,
}

/// Wave number times gap of the mode in which a squeezed film relaxes fastest.
const FASTEST: f64 = 1.793;

/// Pressure where surfaces touch, relative to the largest of μγ̇, G/a, κ/a³ and σ/a. It is large
/// because in a dense suspension few vertices carry the load between two capsules: between 27 capsules
/// in shear at a volume fraction of 42 % it was 6 to 15, for Ca of 0.3 and 1 and `k r_c` of 0.6 to 6
/// G/a. Steps 4.8 times as long as this limit caused no errors there.
const CONTACT: f64 = 10.0;

impl Barrier {
    /// p at the fraction s of the range: `k r_c/2 (1 − s²)² (1 + 2s² − 3c s⁴)/s³`.
    fn pressure(&self, s: f64) -> f64 {
        let q = s * s;
        0.5 * self.strength * self.cutoff * (1.0 - q).powi(2) * self.pressed(q) / (q * s)
    }

    fn pressed(&self, q: f64) -> f64 {
        1.0 + 2.0 * q - 3.0 * self.attraction * q * q
    }

    /// The fraction of the range at which the repulsion balances a pressure.
    fn part(&self, pressure: f64) -> f64 {
        // Beyond `k r_c/(2s³) = P` the pressure is lower: (1 − q)² (1 + 2q) ≤ 1.
        let touching = (0.5 * self.strength * self.cutoff / pressure).cbrt();
        let (mut low, mut high) = (0.0, touching.min(1.0));
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.pressure(middle) > pressure {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }

    /// The gap h of surfaces that touch, where p(h) = 10 P, and −p'(h); P is the largest pressure of
    /// flow and membranes.
    fn contact(&self, pressure: f64) -> (f64, f64) {
        let s = self.part(CONTACT * pressure);
        let (q, gap) = (s * s, s * self.cutoff);
        let pressed = (4.0 - 12.0 * self.attraction * q) / self.pressed(q);
        let exponent = 3.0 + 4.0 * q / (1.0 - q) - q * pressed;
        (gap, self.pressure(s) * exponent / gap)
    }

    /// Force per length that holds a vertex with edges of this length where surfaces touch.
    pub fn stiffness(&self, pressure: f64, edge: f64) -> f64 {
        let (_, slope) = self.contact(pressure);
        0.75_f64.sqrt() * edge * edge * slope
    }

    /// The largest rate, 1/time, at which two touching surfaces return to their distance h, on
    /// meshes with edges of this length in fluid of viscosity μ.
    ///
    /// A normal force per area f cos(kx) on a plane in Stokes flow makes the velocity
    /// `f/(4μk) (1 + k|z|) e^(−k|z|)` at a distance z. Between two planes with opposite forces the
    /// gap changes by `f/(2μk) (1 − (1 + kh) e^(−kh))`. With f = −p'(h) times the change of the
    /// gap, this is the rate. Its maximum is `0.149 |p'(h)| h/μ`, at kh = 1.79; k is at most
    /// π/edge.
    pub fn rate(&self, pressure: f64, edge: f64, viscosity: f64) -> f64 {
        let (gap, slope) = self.contact(pressure);
        let x = FASTEST.min(PI * gap / edge);
        slope * gap * (1.0 - (1.0 + x) * (-x).exp()) / (2.0 * viscosity * x)
    }
}

impl AdhesiveWall {
    /// Force per volume `V″(z) = W/λ² (4q² − 2q)` by which the wall holds a membrane where it is pressed
    /// against it, `−V′(z) = 2 W/λ q (q − 1) = p`.
    pub fn stiffness(&self, pressure: f64) -> f64 {
        let Self { strength, range } = *self;
        let q = 0.5 * (1.0 + (1.0 + 2.0 * pressure * range / strength).sqrt());
        strength / (range * range) * q * (4.0 * q - 2.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rate against a search over all wave numbers, with the slope by differences, and its scaling.
    #[test]
    fn the_rate_is_that_of_the_fastest_wave() {
        let cases = [
            (3.0, 0.2, 0.0, 1.0),
            (1e4, 0.5, 0.0, 2.0),
            (1e-3, 0.1, 0.0, 1.0),
            (3.0, 0.2, 8.0, 1.0),
        ];
        for (strength, cutoff, attraction, pressure) in cases {
            let barrier = Barrier {
                strength,
                cutoff,
                attraction,
            };
            let (gap, _) = barrier.contact(pressure);
            let at = |gap: f64| barrier.pressure(gap / cutoff);
            assert!((at(gap) / (10.0 * pressure) - 1.0).abs() < 1e-9);
            let step = 1e-5 * (cutoff - gap).min(gap);
            let slope = (at(gap - step) - at(gap + step)) / (2.0 * step);
            let stiffness = barrier.stiffness(pressure, 0.5);
            assert!((stiffness / (0.75_f64.sqrt() * 0.25 * slope) - 1.0).abs() < 1e-6);
            for edge in [1e-9, 3.0 * gap] {
                let rate = |k: f64| slope * (1.0 - (1.0 + k * gap) * (-k * gap).exp()) / (2.0 * k);
                let waves = (1..=4000).map(|n| 0.001 * f64::from(n) / gap);
                let waves = waves.filter(|k| k * edge <= PI);
                let expected = waves.map(rate).fold(0.0, f64::max);
                let found = barrier.rate(pressure, edge, 1.0);
                // The slope by differences to 1e-8, the largest wave among those of a grid to 1e-3.
                assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
                let thinner = barrier.rate(pressure, edge, 0.5);
                assert!((thinner / found - 2.0).abs() < 1e-12);
            }
        }
    }

    /// The stiffness against differences of −V′(z) = 2 W/λ q (q − 1), q = exp(−z/λ), where it is p.
    #[test]
    fn a_wall_holds_by_the_slope_of_its_force() {
        for (strength, range, pressure) in [(2.0, 0.3, 5.0), (1e-3, 0.01, 0.2), (1e3, 2.0, 1e-3)] {
            let wall = AdhesiveWall { strength, range };
            let force = |z: f64| {
                let q = (-z / range).exp();
                2.0 * strength / range * q * (q - 1.0)
            };
            let (mut low, mut high) = (-50.0 * range, 0.0);
            for _ in 0..200 {
                let middle = 0.5 * (low + high);
                if force(middle) > pressure {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            let step = 1e-5 * range;
            let slope = (force(low - step) - force(low + step)) / (2.0 * step);
            // Differences over 1e-5 of the range: their error is of order 1e-10, and rounding's 1e-11.
            assert!((wall.stiffness(pressure) / slope - 1.0).abs() < 1e-7);
        }
    }
}

//! Random numbers that are the same on every machine.

use glam::{DVec2, DVec3};

/// SplitMix64: one 64-bit state, good enough to scatter points, and short enough to be read.
///
/// Source: G. Steele, D. Lea, C. Flood, Fast splittable pseudorandom number generators, OOPSLA 2014.
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
}

impl Random {
    /// Starts the sequence of a seed.
    pub fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    fn next(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.state;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// Uniform in [0, 1), a multiple of 2⁻⁵³.
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform in 0 … `count` − 1; 0 if `count` is 0.
    pub fn below(&mut self, count: usize) -> usize {
        ((u128::from(self.next()) * count as u128) >> 64) as usize
    }

    /// Uniform in the unit disc, by rejection, without sine and cosine.
    pub fn in_disc(&mut self) -> DVec2 {
        loop {
            let point = 2.0 * DVec2::new(self.unit(), self.unit()) - DVec2::ONE;
            let square = point.length_squared();
            if 0.0 < square && square < 1.0 {
                return point;
            }
        }
    }

    /// Uniform on the unit circle.
    pub fn on_circle(&mut self) -> DVec2 {
        self.in_disc().normalize()
    }

    /// Uniform on the unit sphere, by Marsaglia's map of the disc.
    pub fn on_sphere(&mut self) -> DVec3 {
        let point = self.in_disc();
        let square = point.length_squared();
        let stretch = 2.0 * (1.0 - square).sqrt();
        DVec3::new(point.x * stretch, point.y * stretch, 1.0 - 2.0 * square).normalize()
    }

    /// 0 … `count` − 1 in a random order.
    pub fn permutation(&mut self, count: usize) -> Vec<u32> {
        let mut order = Vec::from_iter(0..count as u32);
        for last in (1..count).rev() {
            order.swap(last, self.below(last + 1));
        }
        order
    }
}

#[cfg(test)]
mod tests {
    use super::Random;

    /// The generator's published first outputs for seed 1234567.
    #[test]
    fn known_sequence() {
        let mut random = Random::new(1234567);
        let found = [(); 3].map(|()| random.next());
        assert_eq!(
            found,
            [
                6457827717110365317,
                3203168211198807973,
                9817491932198370423
            ]
        );
    }
}

//! Reproducible numbers, for the tests and the soak.

use fric_core::Pose;

/// A reproducible stream of numbers (`SplitMix64`).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// 0 … 1.
    #[expect(clippy::cast_precision_loss, reason = "53 bits")]
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn range(&mut self, least: f64, greatest: f64) -> f64 {
        least + (greatest - least) * self.unit()
    }

    pub fn below(&mut self, count: u64) -> u64 {
        self.bits() % count
    }

    pub fn vector(&mut self, size: f64) -> [f64; 3] {
        [(); 3].map(|()| self.range(-size, size))
    }

    pub fn unit_vector(&mut self) -> [f64; 3] {
        loop {
            let vector = self.vector(1.0);
            let norm = vector.iter().map(|part| part * part).sum::<f64>().sqrt();
            if norm > 0.1 && norm < 1.0 {
                return vector.map(|part| part * (1.0 / norm));
            }
        }
    }

    pub fn pose(&mut self, reach_m: f64) -> Pose {
        let [x, y, z] = self.vector(0.4);
        let norm = (1.0 + x * x + y * y + z * z).sqrt();
        Pose::from_parts(self.vector(reach_m), [x / norm, y / norm, z / norm, 1.0 / norm]).unwrap()
    }
}

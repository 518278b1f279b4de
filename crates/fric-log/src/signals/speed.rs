//! Speed where none is measured.

/// The last length of a cable that was known, and when.
#[derive(Debug, Clone, Copy)]
pub struct LastLength {
    stamp_nanos: i64,
    length_m: f64,
}

impl LastLength {
    /// None yet.
    pub const UNKNOWN: Self = Self { stamp_nanos: 0, length_m: f64::NAN };

    /// Change of length per time; 0 where none was known before, or time went back; NaN where it is not known now.
    #[must_use]
    pub fn speed_m_per_s(&self, length_m: f64, stamp_nanos: i64) -> f64 {
        if !length_m.is_finite() {
            return f64::NAN;
        }
        #[expect(clippy::cast_precision_loss, reason = "an interval between rows")]
        let interval_s = stamp_nanos.saturating_sub(self.stamp_nanos) as f64 * 1e-9;
        let is_known = self.length_m.is_finite() && interval_s > 0.0;
        if is_known { (length_m - self.length_m) / interval_s } else { 0.0 }
    }

    /// Takes in a length; one that is not finite leaves the last as it is.
    pub fn update(&mut self, length_m: f64, stamp_nanos: i64) {
        if length_m.is_finite() {
            *self = Self { stamp_nanos, length_m };
        }
    }
}

//! Counts the cycles between two samples.

/// A counter of cycles, which uses the samples' stamps.
#[derive(Clone, Debug)]
pub struct Clock {
    cycle_s: f64,
    last_stamp_nanos: Option<i64>,
}

impl Clock {
    /// Creates a clock that has not seen a sample.
    pub fn new(cycle_s: f64) -> Self {
        Self { cycle_s, last_stamp_nanos: None }
    }

    /// Returns the cycles since the last sample, as in [`fric_core::CycleInput::elapsed_cycles`]; 1 for the first.
    pub fn elapsed_cycles(&mut self, stamp_nanos: i64) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "an interval between two samples")]
        let elapsed = self.last_stamp_nanos.map_or(1.0, |last| {
            // The nearest integer, because stamps jitter and cycles do not. A clock that is set back counts as one cycle.
            (stamp_nanos.saturating_sub(last) as f64 * 1e-9 / self.cycle_s).round()
        });
        self.last_stamp_nanos = Some(stamp_nanos);
        elapsed
    }
}

//! Warnings about a simulation, one sentence each.

use super::stream::{Imbalance, Simulation};

impl Simulation {
    /// Returns warnings about those parts of the run so far that no real robot could do.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if self.is_among_anchors() {
            let text = "all base points are at one height, and the run is not below them: cables that are nearly level \
                        cannot carry the platform in reality; check `base_m` and `platform_m`, or give a platform that \
                        does not hang `mass_kg` 0";
            warnings.push(text.to_owned());
        }
        if let Some(Imbalance { cycle_count, missing_n, time_s, position_m }) = self.imbalance() {
            warnings.push(format!(
                "the cables cannot hold the platform in {cycle_count} of {} cycles, by up to {missing_n:.3} N at \
                 {time_s:.3} s, where it is at [{:.3}, {:.3}, {:.3}] m: the log is that of a platform on a guide that \
                 carries the rest; for one without check `base_m`, `platform_m` and `mass_kg`",
                self.total_cycles(),
                position_m.x,
                position_m.y,
                position_m.z,
            ));
        }
        warnings
    }
}

//! Groups samples by operating conditions, to show how an estimate depends on the conditions that a log contains.

use crate::samples::cable::CableRecord;
use crate::samples::conditions::{Condition, Spacing, conditions, sign, time};
use crate::samples::record::Row;

/// Number of samples that suffices to place the bin edges of a condition.
const ENOUGH: usize = 4096;
/// The group of a sample that has no value of the condition.
const NONE: u16 = u16::MAX;

/// One grouping per operating condition, by its bins and the direction of motion.
#[derive(Clone, Debug)]
pub struct Groups {
    /// For each condition, the group of every sample.
    pub groupings: Vec<Grouping>,
}

/// The groups of one condition.
#[derive(Clone, Debug)]
pub struct Grouping {
    groups: Vec<u16>,
    /// Number of groups.
    pub count: usize,
}

impl Groups {
    /// Returns the groups of a cable's samples.
    pub fn of(record: &CableRecord<'_>) -> Self {
        // Conditions that contain the sensor's noise would group the samples by their own residual.
        let has_noise = |condition: &Condition<'_>| ["sensor_force", "force_rate"].contains(&condition.signal);
        let mut all = conditions(record);
        all.retain(|condition| !has_noise(condition));
        all.push(time(record));
        let grouping = |condition: Condition<'_>| {
            let (Spacing::Crowds(bins) | Spacing::Widths(bins)) = condition.bins;
            let stride = record.rows.len() / ENOUGH + 1;
            let mut few: Vec<f64> = condition.values().step_by(stride).filter(|value| value.is_finite()).collect();
            few.sort_by(f64::total_cmp);
            let edge = |bin: usize| few.get(bin * few.len() / bins).copied();
            let mut edges: Vec<f64> = (1..bins).filter_map(edge).collect();
            edges.dedup_by(|one, other| one.to_bits() == other.to_bits());
            let group = |(value, row): (f64, &Row)| {
                let bin = edges.partition_point(|edge| *edge <= value);
                let direction = sign(row.signals.displacement_m);
                let direction = if direction > 0.0 { 2 } else { usize::from(direction < 0.0) };
                if value.is_finite() { u16::try_from(3 * bin + direction).unwrap_or(NONE) } else { NONE }
            };
            let groups = condition.values().zip(record.rows).map(group).collect();
            Grouping { groups, count: 3 * (edges.len() + 1) }
        };
        Self { groupings: all.into_iter().map(grouping).collect() }
    }
}

#[cfg(test)]
impl Groups {
    /// Assigns the samples to `count` groups in turn.
    pub fn every(count: usize, samples: usize) -> Self {
        let groups = (0..samples).map(|place| u16::try_from(place % count).unwrap_or(NONE)).collect();
        Self { groupings: vec![Grouping { groups, count }] }
    }
}

impl Grouping {
    /// Returns the group of a sample.
    pub fn of_sample(&self, place: usize) -> Option<usize> {
        self.groups.get(place).filter(|group| **group != NONE).map(|group| usize::from(*group))
    }
}

//! A replay over time, as minimum and maximum of intervals. Memory does not grow with the log.

use fric_core::{Sample, Wrench};
use fric_lab::replay::ReplayedCycle;

use super::friction::CableFriction;

/// Maximum number of extents: a page with them is below 3 MB, with two numbers of 16 bits each, encoded in base64.
const MOST_EXTENTS: usize = 320_000;
/// Maximum number of intervals, whatever the number of channels; beyond it they are merged in pairs.
const MOST_INTERVALS: usize = 40_000;
/// Maximum number of separate stretches.
const MOST_STRETCHES: usize = 200;
/// Channels per cable: before, after, compensated force.
const PER_CABLE: usize = 3;
/// Channels of the wrench: six components before and after.
const OF_WRENCH: usize = 12;

/// Least and greatest of the added values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Extent {
    pub least: f64,
    pub greatest: f64,
}

impl Extent {
    pub(crate) const NOTHING: Self = Self { least: f64::INFINITY, greatest: f64::NEG_INFINITY };

    pub(crate) fn add(&mut self, value: f64) {
        if value.is_finite() {
            self.least = self.least.min(value);
            self.greatest = self.greatest.max(value);
        }
    }

    pub(crate) fn merge(&mut self, other: Self) {
        self.add(other.least);
        self.add(other.greatest);
    }

    pub(crate) fn merged(mut self, other: Self) -> Self {
        self.merge(other);
        self
    }

    /// Returns the least and the greatest value; NaN without values.
    pub(crate) fn ends(self) -> (f64, f64) {
        if self.is_something() { (self.least, self.greatest) } else { (f64::NAN, f64::NAN) }
    }

    pub(crate) fn is_something(self) -> bool {
        self.least <= self.greatest
    }
}

/// A quantity of a replay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Channel {
    /// Frictionless force minus reference, N.
    Before(usize),
    /// Compensated force minus reference, N.
    After(usize),
    /// Compensated force, N.
    Force(usize),
    /// A component of the wrench by frictionless forces, N or N m, minus the reference if the log has one.
    WrenchBefore(usize),
    /// The same by compensated forces.
    WrenchAfter(usize),
}

/// Least and greatest values of some channels, interval by interval.
#[derive(Debug)]
struct Intervals {
    channels: usize,
    most: usize,
    /// Extents of the intervals in sequence, with all channels of one interval together.
    extents: Vec<Extent>,
    /// Time of each interval's first sample since the start, s.
    starts_s: Vec<f64>,
    samples_per_interval: u64,
    samples_in_last: u64,
    first_nanos: Option<i64>,
}

impl Intervals {
    fn new(channels: usize) -> Self {
        Self {
            channels,
            // An even number, because intervals are merged in pairs.
            most: (MOST_EXTENTS / channels.max(1)).clamp(512, MOST_INTERVALS) & !1,
            extents: Vec::new(),
            starts_s: Vec::new(),
            samples_per_interval: 1,
            samples_in_last: 0,
            first_nanos: None,
        }
    }

    /// Begins a sample, in a new interval if the last one is full.
    fn begin(&mut self, stamp_nanos: i64) {
        let first_nanos = *self.first_nanos.get_or_insert(stamp_nanos);
        #[expect(clippy::cast_precision_loss, reason = "to be drawn")]
        let time_s = stamp_nanos.saturating_sub(first_nanos) as f64 * 1e-9;
        if self.starts_s.is_empty() || self.samples_in_last >= self.samples_per_interval {
            if self.starts_s.len() == self.most {
                self.merge_pairs();
            }
            self.starts_s.push(time_s);
            self.extents.resize(self.extents.len() + self.channels, Extent::NOTHING);
            self.samples_in_last = 0;
        }
        self.samples_in_last += 1;
    }

    fn note(&mut self, channel: usize, value: f64) {
        let last = self.extents.len().saturating_sub(self.channels);
        if let Some(extent) = self.extents.get_mut(last + channel) {
            extent.add(value);
        }
    }

    /// Removes the data of the channels from one on.
    fn clear_from(&mut self, channel: usize) {
        for interval in self.extents.chunks_mut(self.channels) {
            interval.iter_mut().skip(channel).for_each(|extent| *extent = Extent::NOTHING);
        }
    }

    fn merge_pairs(&mut self) {
        let channels = self.channels;
        let merge = |pair: &[Extent]| -> Vec<Extent> {
            let (first, second) = pair.split_at(channels);
            first.iter().zip(second).map(|(first, second)| first.merged(*second)).collect()
        };
        self.extents = self.extents.chunks_exact(2 * channels).flat_map(merge).collect();
        self.starts_s = self.starts_s.iter().copied().step_by(2).collect();
        self.samples_per_interval *= 2;
    }

    /// Returns the least and the greatest value of a channel in each interval, NaN where there is none; `None` if there is none at all.
    fn band(&self, channel: usize) -> Option<(Vec<f64>, Vec<f64>)> {
        let extents = self.extents.iter().skip(channel).step_by(self.channels);
        let is_any = extents.clone().any(|extent| extent.is_something());
        is_any.then(|| extents.map(|extent| extent.ends()).unzip())
    }
}

/// The signals of a log over time.
#[derive(Debug)]
pub struct SignalSeries(Intervals);

/// A signal of a cable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Signal {
    /// Force shown by the sensor, N.
    Sensor,
    /// Force measured at the platform, N.
    Reference,
    /// Length, m.
    Length,
}

impl SignalSeries {
    /// Creates an empty series for `cable_count` cables.
    #[must_use]
    pub fn new(cable_count: usize) -> Self {
        Self(Intervals::new(PER_CABLE * cable_count))
    }

    /// Adds a sample.
    pub fn add(&mut self, sample: &Sample<'_>) {
        self.0.begin(sample.stamp_nanos);
        for (cable, (input, reference_n)) in sample.cables.iter().zip(sample.reference_force_n).enumerate() {
            for (signal, value) in [
                (Signal::Sensor, input.sensor_force_n),
                (Signal::Reference, *reference_n),
                (Signal::Length, input.length_m),
            ] {
                self.0.note(PER_CABLE * cable + signal as usize, value);
            }
        }
    }

    pub(crate) fn starts_s(&self) -> &[f64] {
        &self.0.starts_s
    }

    pub(crate) fn band(&self, cable: usize, signal: Signal) -> Option<(Vec<f64>, Vec<f64>)> {
        self.0.band(PER_CABLE * cable + signal as usize)
    }
}

/// All cables of a replay and the wrench, interval by interval, and the friction of each cable over its conditions.
#[derive(Debug)]
pub struct Series {
    cable_count: usize,
    intervals: Intervals,
    /// Time intervals in which a cable is flagged, s.
    flagged_s: Vec<Vec<[f64; 2]>>,
    is_wrench_compared: bool,
    frictions: Vec<CableFriction>,
}

impl Series {
    /// Creates an empty series for `cable_count` cables.
    #[must_use]
    pub fn new(cable_count: usize) -> Self {
        Self {
            cable_count,
            intervals: Intervals::new(PER_CABLE * cable_count + OF_WRENCH),
            flagged_s: vec![Vec::new(); cable_count],
            is_wrench_compared: false,
            frictions: vec![CableFriction::default(); cable_count],
        }
    }

    fn place(&self, channel: Channel) -> usize {
        let wrench = PER_CABLE * self.cable_count;
        match channel {
            Channel::Before(cable) => PER_CABLE * cable,
            Channel::After(cable) => PER_CABLE * cable + 1,
            Channel::Force(cable) => PER_CABLE * cable + 2,
            Channel::WrenchBefore(component) => wrench + component,
            Channel::WrenchAfter(component) => wrench + OF_WRENCH / 2 + component,
        }
    }

    /// Adds a cycle.
    pub fn add(&mut self, sample: &Sample<'_>, cycle: &ReplayedCycle<'_>) {
        self.intervals.begin(sample.stamp_nanos);
        for (cable, (output, reference_n)) in cycle.cables.iter().zip(sample.reference_force_n).enumerate() {
            self.note(Channel::Before(cable), output.frictionless_n - reference_n);
            self.note(Channel::After(cable), output.force_at_platform_n - reference_n);
            self.note(Channel::Force(cable), output.force_at_platform_n);
            if !output.status.is_ok() {
                self.flag(cable);
            } else if let (Some(friction), Some(input)) = (self.frictions.get_mut(cable), sample.cables.get(cable)) {
                friction.add(sample.stamp_nanos, input, output, *reference_n);
            }
        }
        if let Some((before, after)) = cycle.frictionless_wrench.zip(cycle.outside_wrench) {
            self.note_wrenches(sample.outside_wrench, before, after);
        }
    }

    fn note(&mut self, channel: Channel, value: f64) {
        self.intervals.note(self.place(channel), value);
    }

    /// Marks a cable as flagged in the last interval. Flags less than an interval apart form one stretch.
    fn flag(&mut self, cable: usize) {
        let [.., last_s] = self.intervals.starts_s.as_slice() else { return };
        let before_s = self.intervals.starts_s.iter().rev().nth(1).copied().unwrap_or(*last_s);
        let Some(all) = self.flagged_s.get_mut(cable) else { return };
        // Beyond the maximum, stretches are merged.
        let is_full = all.len() >= MOST_STRETCHES;
        match all.last_mut().filter(|stretch| is_full || stretch[1] >= before_s) {
            Some(stretch) => stretch[1] = *last_s,
            None => all.push([*last_s; 2]),
        }
    }

    fn note_wrenches(&mut self, reference: Option<Wrench>, before: Wrench, after: Wrench) {
        if reference.is_some() && !self.is_wrench_compared {
            // Values before the first reference are not deviations.
            self.is_wrench_compared = true;
            self.intervals.clear_from(PER_CABLE * self.cable_count);
        }
        if reference.is_none() && self.is_wrench_compared {
            return;
        }
        for (wrench, channel) in
            [(before, Channel::WrenchBefore as fn(usize) -> Channel), (after, Channel::WrenchAfter)]
        {
            let wrench = reference.map_or(wrench, |reference| wrench - reference);
            for (component, value) in wrench.force_n.iter().chain(wrench.torque_nm.iter()).enumerate() {
                self.note(channel(component), *value);
            }
        }
    }

    /// Returns the start times of the intervals, s.
    pub(crate) fn starts_s(&self) -> &[f64] {
        &self.intervals.starts_s
    }

    /// Returns the least and the greatest value of a quantity in each interval, NaN where there is none; `None` if there is none at all.
    pub(crate) fn band(&self, channel: Channel) -> Option<(Vec<f64>, Vec<f64>)> {
        self.intervals.band(self.place(channel))
    }

    /// Returns the time intervals in which a cable was flagged, s.
    pub(crate) fn flagged_s(&self, cable: usize) -> &[[f64; 2]] {
        self.flagged_s.get(cable).map_or(&[], Vec::as_slice)
    }

    /// Whether the wrench is the deviation from the one in the log.
    pub(crate) fn is_wrench_compared(&self) -> bool {
        self.is_wrench_compared
    }

    /// Returns the friction of a cable over its conditions.
    pub(crate) fn friction(&self, cable: usize) -> Option<&CableFriction> {
        self.frictions.get(cable)
    }
}

#[cfg(test)]
mod tests {
    use fric_core::{CableInput, CableOutput};

    use super::*;

    #[test]
    #[expect(clippy::float_cmp, reason = "whole numbers")]
    fn thinning_keeps_every_extreme() {
        let mut series = Series::new(2);
        let input = CableInput { sensor_force_n: 0.0, length_m: 0.0, speed_m_per_s: 0.0 };
        for index in 0..100_000_i32 {
            let output = CableOutput { force_at_platform_n: f64::from(index), ..CableOutput::default() };
            let sample = Sample {
                stamp_nanos: i64::from(index) * 1_000_000,
                cables: &[input, input],
                reference_force_n: &[0.0, f64::NAN],
                pose: None,
                outside_wrench: None,
            };
            let cables = [output, output];
            let cycle = ReplayedCycle { cables: &cables, outside_wrench: None, frictionless_wrench: None, cycle_ns: 1 };
            series.add(&sample, &cycle);
        }
        let (least, greatest) = series.band(Channel::After(0)).unwrap();
        assert_eq!(least.len(), series.starts_s().len());
        assert!(least.len() <= MOST_EXTENTS / (2 * PER_CABLE + OF_WRENCH));
        assert!(greatest.iter().zip(least.iter().skip(1)).all(|(end, start)| end + 1.0 == *start));
        assert_eq!((least.first(), greatest.last()), (Some(&0.0), Some(&99_999.0)));
        assert!(series.band(Channel::After(1)).is_none() && series.band(Channel::WrenchAfter(0)).is_none());
    }
}

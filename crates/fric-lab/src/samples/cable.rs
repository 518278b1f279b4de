//! The cycles of one cable, as fits and discoveries see them: what the measurements have of it, or with some of it changed.

use std::borrow::Cow;
use std::ops::Range;

use fric_core::CableParams;
use fric_core::effects::UNKNOWN;
use fric_core::signals::{BEFORE_FIRST, Conditioned, RawSignals, SignalLimits, SignalState, condition};

use super::noise::lasting_white_noise;
use super::record::{LogZero, PerLog, Row};

/// Half width of the play that suppresses noise of the length best, as a multiple of the noise's standard deviation. On a log with noise of 3 µm, the
/// rms is 1.42 of its noise with 1σ, 1.03 with 2σ, 1.09 with 3σ, 1.21 with 4σ, and 3.7 without play.
pub const PLAY_OF_NOISE: f64 = 2.0;

/// Cycles and references of a cable with zeros changed in the data; what is as it was is shared.
#[derive(Debug)]
pub(crate) struct Zeroed<'a> {
    rows: Cow<'a, [Row]>,
    references_n: Cow<'a, [f64]>,
}

/// The cycles of one cable.
#[derive(Clone, Copy, Debug)]
pub struct CableRecord<'a> {
    /// Its given parameters.
    pub params: &'a CableParams,
    /// Its cycles, one log after the other.
    pub rows: &'a [Row],
    /// Cable force measured at the platform in each of them, N; NaN if there is none.
    pub references_n: &'a [f64],
    pub(crate) starts: &'a [usize],
    pub(crate) times_s: &'a [f64],
    /// Cycle time of the control loop, s.
    pub cycle_s: f64,
    /// Usual time between two samples of the log, s.
    pub interval_s: f64,
    /// Whether the reference is known rather than measured: it may then be constant, and does not count as interpolated.
    pub(crate) reference_is_known: bool,
    /// Play to either side within which a change of the measured length counts as noise, m.
    pub(crate) length_play_m: f64,
    /// The zero that each log has of its own.
    pub(crate) per_log: Option<PerLog>,
    /// Number of consecutive samples that share noise of the reference: 1, but for one that was interpolated.
    pub(crate) noise_reach: usize,
    /// Noise that the model sees in the sensor force beyond that of the rows.
    pub(crate) added_noise: Option<AddedNoise<'a>>,
}

/// Noise to be added to a sensor force.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AddedNoise<'a> {
    /// The noise in each cycle, N.
    pub noise_n: &'a [f64],
    /// How many times it is added.
    pub strength: f64,
}

impl AddedNoise<'_> {
    /// Returns some cycles with the noise.
    pub fn on(&self, rows: &[Row], cycles: Range<usize>) -> Vec<Row> {
        let mut rows = rows.to_vec();
        let noise_n = self.noise_n.get(cycles).unwrap_or_default();
        rows.iter_mut().zip(noise_n).for_each(|(row, noise_n)| row.signals.sensor_force_n += self.strength * noise_n);
        rows
    }
}

impl<'a> CableRecord<'a> {
    /// Returns cycles and references with the zero of each log changed by so much, N, in the data instead of the parameter: a model with the common zero
    /// leaves on them what it leaves with a zero per log.
    pub(crate) fn with_zeros(&self, changes_n: &[f64]) -> Zeroed<'a> {
        let (mut rows, mut references_n) = (Cow::Borrowed(self.rows), Cow::Borrowed(self.references_n));
        for ((start, log), change_n) in self.logs().zip(changes_n) {
            match self.per_log.map(|per_log| per_log.zero) {
                Some(LogZero::Platform) => {
                    let of_log = references_n.to_mut().iter_mut().skip(start).take(log.len());
                    of_log.for_each(|reference_n| *reference_n -= change_n);
                }
                Some(LogZero::Sensor) => {
                    let of_log = rows.to_mut().iter_mut().skip(start).take(log.len());
                    of_log.for_each(|row| row.signals.sensor_force_n -= change_n);
                }
                None => {}
            }
        }
        Zeroed { rows, references_n }
    }

    /// Returns the same cycles with zeros changed in the data.
    pub(crate) fn zeroed<'b>(&self, zeroed: &'b Zeroed<'_>) -> CableRecord<'b>
    where
        'a: 'b,
    {
        CableRecord { rows: &zeroed.rows, references_n: &zeroed.references_n, ..*self }
    }

    /// Returns the reference in a cycle, N; NaN if there is none.
    #[must_use]
    pub fn reference_n(&self, cycle: usize) -> f64 {
        self.references_n.get(cycle).copied().unwrap_or(f64::NAN)
    }

    /// Returns the force at the platform that the sensor shows in a cycle if there is no friction, N; NaN past the last cycle.
    #[must_use]
    pub(crate) fn frictionless_n(&self, cycle: usize) -> f64 {
        let sensor_n = self.rows.get(cycle).map_or(f64::NAN, |row| row.signals.sensor_force_n);
        sensor_n * self.params.frictionless_gain()
    }

    /// Returns the forces that the sensor shows, N; NaN where it shows none, because such a sample takes the last good one.
    pub(crate) fn shown_forces_n(&self) -> Vec<f64> {
        let shown_n = |row: &Row| if row.signals.sensor_finite { row.signals.sensor_force_n } else { f64::NAN };
        self.rows.iter().map(shown_n).collect()
    }

    /// Returns a stretch of its cycles, as a log of its own.
    pub(crate) fn stretch(&self, cycles: &Range<usize>) -> Self {
        let rows = self.rows.get(cycles.clone()).unwrap_or_default();
        let references_n = self.references_n.get(cycles.clone()).unwrap_or_default();
        let times_s = self.times_s.get(cycles.clone()).unwrap_or_default();
        Self { rows, references_n, starts: &[0], times_s, ..*self }
    }

    /// Returns other cycles of the same cable, as one log.
    pub(crate) fn as_one_log<'b>(&self, rows: &'b [Row], references_n: &'b [f64]) -> CableRecord<'b>
    where
        'a: 'b,
    {
        CableRecord { rows, references_n, starts: &[0], times_s: &[], ..*self }
    }

    /// Returns the same cycles with other start parameters.
    pub(crate) fn with_params<'b>(&self, params: &'b CableParams) -> CableRecord<'b>
    where
        'a: 'b,
    {
        CableRecord { params, ..*self }
    }

    /// Returns the same cycles with other references.
    pub(crate) fn with_references<'b>(&self, references_n: &'b [f64]) -> CableRecord<'b>
    where
        'a: 'b,
    {
        CableRecord { references_n, ..*self }
    }

    /// Returns the same cycles with references interpolated between so many samples.
    pub(crate) fn with_interpolated<'b>(&self, references_n: &'b [f64], noise_reach: usize) -> CableRecord<'b>
    where
        'a: 'b,
    {
        CableRecord { references_n, noise_reach, ..*self }
    }

    /// Returns the standard deviation of the white noise of the length, m; `None` if there is no permanent noise, or the cable always moves by more than
    /// its play from sample to sample.
    pub(crate) fn length_noise_m(&self) -> Option<f64> {
        let of_log = |(_, rows): (usize, &[Row])| {
            rows.iter().map(|row| row.signals.length_m).chain([f64::NAN]).collect::<Vec<f64>>()
        };
        lasting_white_noise(&self.logs().flat_map(of_log).collect::<Vec<f64>>(), PLAY_OF_NOISE)
    }

    /// Returns the record with cycles that were conditioned with this play.
    pub(crate) fn behind_play<'b>(&self, rows: &'b [Row], length_play_m: f64) -> CableRecord<'b>
    where
        'a: 'b,
    {
        CableRecord { rows, length_play_m, ..*self }
    }

    /// Returns its cycles, conditioned again with other limits.
    pub(crate) fn conditioned(&self, limits: &SignalLimits) -> Vec<Row> {
        let mut rows = Vec::with_capacity(self.rows.len());
        for (_, log) in self.logs() {
            let (mut state, mut last) = (SignalState::start(), BEFORE_FIRST);
            for row in log {
                let Conditioned { sensor_force_n, speed_m_per_s, length_m, sensor_finite, motion_finite, .. } =
                    row.signals;
                let known = |is_known: bool, value: f64| if is_known { value } else { f64::NAN };
                let raw = RawSignals {
                    sensor_force_n: known(sensor_finite, sensor_force_n),
                    length_m: known(motion_finite, length_m),
                    speed_m_per_s,
                };
                let signals = condition(limits, &mut state, &raw, row.cycle - last);
                last = row.cycle;
                rows.push(Row {
                    signals: Conditioned { length_m: known(signals.length_m < UNKNOWN, signals.length_m), ..signals },
                    ..*row
                });
            }
        }
        rows
    }

    /// Returns the time of a cycle, s since the first sample. Several logs follow one another.
    #[must_use]
    pub fn time_s(&self, cycle: usize) -> f64 {
        let (past, last_s) = match self.times_s {
            [] => (cycle, 0.0),
            [.., last_s] => (cycle.saturating_sub(self.times_s.len() - 1), *last_s),
        };
        #[expect(clippy::cast_precision_loss, reason = "a count of cycles")]
        let without_pause_s = last_s + past as f64 * self.cycle_s;
        self.times_s.get(cycle).copied().unwrap_or(without_pause_s)
    }

    /// Returns the index of the log that a cycle belongs to.
    pub(crate) fn log_index(&self, cycle: usize) -> usize {
        self.starts.partition_point(|start| *start <= cycle).saturating_sub(1)
    }

    /// Returns the cycles of the log that a cycle belongs to.
    pub(crate) fn log_of(&self, cycle: usize) -> Range<usize> {
        let log = self.log_index(cycle);
        let start = |log: usize| self.starts.get(log).copied();
        start(log).unwrap_or(0)..start(log + 1).unwrap_or(self.rows.len())
    }

    /// Returns the cycles of each log, with the index of the first.
    pub fn logs(&self) -> impl Iterator<Item = (usize, &'a [Row])> + use<'a> {
        let (rows, starts) = (self.rows, self.starts);
        let ends = starts.iter().skip(1).copied().chain([rows.len()]);
        starts.iter().zip(ends).filter_map(move |(start, end)| Some((*start, rows.get(*start..end)?)))
    }
}

//! A reference that is late or early, or whose clock runs at another rate than the winch's.
//!
//! A time error shows in the residual as the rate of the reference: a reference that is late by ε leaves `ε·dF/dt`. Delay and skew are improved
//! iteratively from this part of the residual, after removing what the model's parameters can compensate. They are kept if the evidence is strong,
//! weakened by the memory of what they leave, and the model then agrees better on held-out samples. A gain that is wrong, for example, makes
//! much of a ramp of the load look late, but leaves a rest that lasts; once the gain has its name, nothing is late. An early reference may also mean
//! that the sensor lags, which concerns the machine. It is a fault only if the model agrees better with the reference shifted than with the reference
//! behind a lag of first order, which has the effect of `sensor_lag` without its noise.

use std::sync::atomic::AtomicBool;

use fric_core::effects::Effect;
use fric_core::parameters::OFFSET;

use super::{Fault, RecordingFault};
use crate::discover::cable::given_to;
use crate::discover::lag::{behind_lag, is_better_than_behind_lag};
use crate::discover::naming::STRONG_BIC;
use crate::discover::naming::evidence::delta_bic;
use crate::discover::naming::projection::{Columns, Signals, visit_less_projection};
use crate::discover::workbench::{Model, Trial, Workbench};
use crate::fit::{CableRecord, Parameter, Row};
use crate::lateness::Lateness;
use crate::samples::interpolated::measured;
use crate::samples::split::{Block, split};

/// Minimum relative decrease of the held-out sum of squares. It corresponds to 0.25 % of the rms, as for an effect.
const LEAST_GAIN: f64 = 0.005;
/// Maximum number of improvements, and the fraction of a sample interval below which an improvement counts as none. Noise in the reference makes its
/// rate larger and each improvement smaller, so more improvements are needed. With 8, a delay of 6 ms on a bench with slowly changing forces comes
/// out 5 % short.
const ROUNDS: usize = 24;
const SMALL: f64 = 1e-2;
/// Number of samples on either side over which rates are computed.
const RATE_SAMPLES: usize = 5;

/// The time of the reference is examined if more than this fraction of the residual's squares is correlated with the rate of the reference. It is a
/// twentieth of the required gain, because parameters may compensate for part of it. At half this value more logs are examined in vain; at double, a
/// delay whose rate the parameters compensate for to 90 % is missed.
const SUSPICIOUS_SHARE: f64 = 0.05 * LEAST_GAIN;

/// Maximum skew. Quartz clocks agree to 1e-4, loops that are timed by software to a hundredth; what goes faster apart is no clock.
const MOST_SKEW: f64 = 0.02;

/// A reference that is early by less may be right and the sensor behind it: an amplifier's filter takes no longer, s. A reference that is early by more is
/// moved at once.
const LONGEST_LAG_S: f64 = 1.0;

/// A gap is longer than this many usual intervals, as where the signals of a log are joined.
const GAP_RATIO: f64 = 10.0;

/// The time error of a reference.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Shift {
    /// Delay at the first sample, s.
    delay_s: f64,
    /// Growth of the delay per second, dimensionless.
    skew: f64,
}

/// A way in which a reference may be off in time.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// By a constant time.
    Delay,
    /// By a time that grows.
    Skew,
    /// It is early because the sensor force is behind a lag of first order, with the time constant in place of the delay, negative.
    Lag,
}

impl Kind {
    /// Returns the number of times that determine the shift.
    fn parameter_count(self) -> usize {
        if self == Self::Skew { 2 } else { 1 }
    }
}

/// A linear step towards the correct time.
struct Step {
    shift: Shift,
    /// Decrease of the sum of squares, N², and as a fraction of what the model's parameters cannot compensate.
    gain: f64,
    gain_ratio: f64,
    /// Of the rate of the reference, and its product with the time, beside the residual.
    columns: Columns,
}

/// The result of correcting one kind of shift.
struct Corrected {
    shift: Shift,
    references_n: Vec<f64>,
    trial: Trial,
}

/// References at their correct times.
pub struct Retimed {
    pub references_n: Vec<f64>,
    /// Number of consecutive samples that share noise.
    pub noise_reach: usize,
    /// The fault to report.
    pub fault: RecordingFault,
}

/// Number of samples between which a line and a quadratic B-spline interpolate.
const LINE_REACH: usize = 2;
const SPLINE_REACH: usize = 3;

/// Returns the cable's references at their correct times, and the fault to report. Returns `None` if the time is right or cannot be
/// determined, for instance with a model without friction. A reference that is off by more than its own changes last has no part in the residual that goes
/// with its rate: it is first moved to where it goes with the sensor's force, to within a sample.
pub fn retimed(record: &CableRecord<'_>, stop: &AtomicBool) -> Option<Retimed> {
    // A model without friction leaves all of the friction in the residual, which has rates of its own.
    if record.reference_is_known || record.params.friction().mu <= 0.0 {
        return None;
    }
    let Some(late_s) = far_off_s(record, stop) else { return near_its_time(record, stop) };
    let moved_n = shifted(record, Shift { delay_s: late_s, skew: 0.0 });
    let Some(mut retimed) = near_its_time(&record.with_references(&moved_n), stop) else {
        let fault = RecordingFault {
            fault: Fault::ReferenceDelay,
            parameters: vec![("delay_s", late_s)],
            intervals_s: Vec::new(),
        };
        return Some(Retimed { references_n: moved_n, noise_reach: LINE_REACH, fault });
    };
    // Interpolated twice.
    retimed.noise_reach += 1;
    for (name, value) in &mut retimed.fault.parameters {
        *value += if *name == "delay_s" { late_s } else { 0.0 };
    }
    Some(retimed)
}

/// Returns by how much the reference of a single log is late, in whole sample intervals, s, if that is far more than the rest of this module finds.
fn far_off_s(record: &CableRecord<'_>, stop: &AtomicBool) -> Option<f64> {
    if record.logs().count() != 1 {
        return None;
    }
    // Beside a reference of 0 the residual is the model's force, also where the reference is unknown.
    let (nothing_n, counts) = (vec![0.0; record.rows.len()], vec![true; record.rows.len()]);
    let bench =
        Workbench { record: record.with_references(&nothing_n), blocks: &[], counts: &counts, measured: &counts, stop };
    let mut lateness = Lateness::default();
    let forces_n = bench.residuals_n(&record.params.values());
    for ((place, force_n), reference_n) in forces_n.into_iter().enumerate().zip(record.references_n) {
        #[expect(clippy::cast_possible_truncation, reason = "a time in ns")]
        lateness.add((record.time_s(place) * 1e9) as i64, [force_n, *reference_n]);
    }
    let late_s = lateness.seconds().filter(|late_s| !(-LONGEST_LAG_S..0.0).contains(late_s))?;
    Some((late_s / record.interval_s).round() * record.interval_s)
}

/// The same for a reference that is off by less than its changes last.
fn near_its_time(record: &CableRecord<'_>, stop: &AtomicBool) -> Option<Retimed> {
    let (blocks, measured) = (split(record), measured(record));
    let (counts, start) = given_to(record, stop)?;
    let start = with_zero(record, start);
    let case = Case { record: *record, counts: &counts, blocks: &blocks, measured: &measured, stop };
    let as_it_is = case.bench(record.references_n).try_one(&start);
    if !case.may_gain(record.references_n, &as_it_is)? {
        return None;
    }
    // A wrong time takes parameters to their bounds, where a fit then holds them: friction behind an early reference has no viscosity.
    let near = case.corrected(&as_it_is, Kind::Delay)?;
    let gains = |from: &Trial, to: &Trial| to.held_out < (1.0 - LEAST_GAIN) * from.held_out;
    if !gains(&as_it_is, &near.trial) {
        return None;
    }
    let (used, again) = given_to(&record.with_references(&near.references_n), stop)?;
    let again = with_zero(record, again);
    let is_same = used == counts && again.free == start.free;
    let case = Case { counts: &used, ..case };
    let as_it_is = if is_same { as_it_is } else { case.bench(record.references_n).try_one(&again) };
    let first = case.improvement(record.references_n, &as_it_is, Kind::Skew)?;
    // The evidence is that of the first steps. A value interpolated between two samples has less noise than either, so that any shift by a fraction of
    // an interval makes the sum of squares smaller. The memory is that of what the whole shift leaves.
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let independent = |corrected: &Corrected, kind: Kind| {
        Some(case.bench(record.references_n).count(false) as f64 / case.inflation(corrected, kind)?)
    };
    let is_strong = |first: &Step, corrected: &Corrected, kind: Kind| {
        #[expect(clippy::cast_precision_loss, reason = "one or two")]
        let parameters = kind.parameter_count() as f64;
        Some(delta_bic(independent(corrected, kind)?, 1.0 - first.gain_ratio, parameters) < -STRONG_BIC)
    };
    let shifted = if is_same { near } else { case.corrected(&as_it_is, Kind::Delay)? };
    // For the same reason a skew looks better than none, so the rest after the delay must still be correlated with the rate.
    let may_be_skewed = case.may_gain(&shifted.references_n, &shifted.trial)?;
    let skewed = if may_be_skewed { Some(case.corrected(&as_it_is, Kind::Skew)?) } else { None };
    let fault = |fault, parameters| RecordingFault { fault, parameters, intervals_s: Vec::new() };
    let skewed = skewed.filter(|skewed| skewed.shift.skew.abs() <= MOST_SKEW);
    let skewed = skewed.filter(|skewed| gains(&shifted.trial, &skewed.trial) && gains(&as_it_is, &skewed.trial));
    if let Some(skewed) = skewed
        && is_strong(&first, &skewed, Kind::Skew)?
    {
        let Shift { delay_s, skew } = skewed.shift;
        let fault = fault(Fault::ClockSkew, vec![("skew_ratio", -skew), ("delay_s", delay_s)]);
        return Some(Retimed { references_n: skewed.references_n, noise_reach: SPLINE_REACH, fault });
    }
    let delay_s = shifted.shift.delay_s;
    let first = case.improvement(record.references_n, &as_it_is, Kind::Delay)?;
    if !gains(&as_it_is, &shifted.trial) || !is_strong(&first, &shifted, Kind::Delay)? {
        return None;
    }
    if delay_s < 0.0 {
        let lagging = case.corrected(&as_it_is, Kind::Lag)?;
        let bench = case.bench(&shifted.references_n);
        let [one_n, other_n] =
            [&shifted, &lagging].map(|of: &Corrected| case.bench(&of.references_n).residuals_n(&of.trial.values));
        if !is_better_than_behind_lag(&bench, [LINE_REACH, 1], &one_n, &other_n, -lagging.shift.delay_s)? {
            return None;
        }
    }
    let fault = fault(Fault::ReferenceDelay, vec![("delay_s", delay_s)]);
    Some(Retimed { references_n: shifted.references_n, noise_reach: LINE_REACH, fault })
}

/// Adds the offset to the free parameters if no zero is free, of the whole recording or of each log. A wrong zero leaves a residual that lasts, which would
/// weaken the evidence for a late reference.
fn with_zero(record: &CableRecord<'_>, mut model: Model) -> Model {
    let is_zero = |of: &Parameter| of.place() == OFFSET || of.effect() == Some(Effect::SensorOffset);
    if record.per_log.is_none() && !model.free.iter().any(is_zero) {
        model.free.extend(Parameter::all().find(|of| of.place() == OFFSET));
    }
    model
}

/// Whether a fit's residual, N, is correlated with the rate of the reference at all, constantly or growing with time, or the reference is far off. This check
/// is far cheaper than [`retimed`].
pub fn may_be_off(record: &CableRecord<'_>, left_n: &[f64], stop: &AtomicBool) -> bool {
    let rates = rates(record, record.references_n);
    let (mut left, mut products, mut squares) = (0.0, [0.0; 2], [0.0; 2]);
    for (place, (left_n, rate)) in left_n.iter().zip(&rates).enumerate() {
        if !(left_n * rate).is_finite() {
            continue;
        }
        left += left_n * left_n;
        for (part, column) in [*rate, rate * seconds(record, place)].into_iter().enumerate() {
            products[part] += column * left_n;
            squares[part] += column * column;
        }
    }
    let explains = |part: usize| products[part] * products[part] > SUSPICIOUS_SHARE * left * squares[part];
    left > 0.0 && (explains(0) || explains(1) || far_off_s(record, stop).is_some())
}

/// Returns the time of a sample, s since the first sample of its log.
fn seconds(record: &CableRecord<'_>, place: usize) -> f64 {
    let start = record.starts.get(record.log_index(place)).copied().unwrap_or(0);
    record.time_s(place) - record.time_s(start)
}

/// Returns the rate of the reference, N/s; NaN where it is unknown.
fn rates(record: &CableRecord<'_>, references_n: &[f64]) -> Vec<f64> {
    let mut rates = vec![f64::NAN; references_n.len()];
    for (start, log) in record.logs() {
        let of_log = references_n.get(start..start + log.len()).unwrap_or_default();
        let middles = rates.iter_mut().skip(start + RATE_SAMPLES);
        for ((place, rate), around) in (start..).zip(middles).zip(of_log.windows(2 * RATE_SAMPLES + 1)) {
            let change_n = around[2 * RATE_SAMPLES] - around[0];
            *rate = change_n / (record.time_s(place + 2 * RATE_SAMPLES) - record.time_s(place));
        }
    }
    rates
}

/// One cable with its log.
#[derive(Clone, Copy)]
struct Case<'a> {
    record: CableRecord<'a>,
    counts: &'a [bool],
    blocks: &'a [Block],
    measured: &'a [bool],
    stop: &'a AtomicBool,
}

impl<'a> Case<'a> {
    fn bench<'b>(&self, references_n: &'b [f64]) -> Workbench<'b>
    where
        'a: 'b,
    {
        let Self { record, counts, blocks, measured, stop } = *self;
        Workbench { record: record.with_references(references_n), blocks, counts, measured, stop }
    }

    /// Returns the shift of a kind that leaves the smallest residual.
    fn corrected(&self, as_it_is: &Trial, kind: Kind) -> Option<Corrected> {
        let (mut shift, mut trial) = (Shift::default(), as_it_is.clone());
        let mut references_n = self.record.references_n.to_vec();
        for _ in 0..ROUNDS {
            let Step { shift: step, .. } = self.improvement(&references_n, &trial, kind)?;
            shift = Shift { delay_s: shift.delay_s + step.delay_s, skew: shift.skew + step.skew };
            references_n = match kind {
                Kind::Lag => {
                    let time_constant_s = (-shift.delay_s).max(f64::MIN_POSITIVE);
                    behind_lag(&self.record, self.record.references_n, |past_s| (-past_s / time_constant_s).exp())
                }
                Kind::Delay | Kind::Skew => shifted(&self.record, shift),
            };
            trial = self.bench(&references_n).try_one(&trial.model());
            let last = |(start, log): (usize, &[Row])| seconds(&self.record, (start + log.len()).saturating_sub(1));
            let end_s = self.record.logs().map(last).fold(0.0, f64::max);
            if step.delay_s.abs() + step.skew.abs() * end_s < SMALL * self.record.interval_s {
                break;
            }
        }
        Some(Corrected { shift, references_n, trial })
    }

    /// Whether a delay with a skew would reduce the residual notably.
    fn may_gain(&self, references_n: &[f64], trial: &Trial) -> Option<bool> {
        Some(self.improvement(references_n, trial, Kind::Skew)?.gain >= LEAST_GAIN * trial.training)
    }

    /// Returns the shift that would reduce the residual most.
    fn improvement(&self, references_n: &[f64], trial: &Trial, kind: Kind) -> Option<Step> {
        let count = kind.parameter_count();
        let (mut columns, mut squares) = (Columns::new(count, 0, count), 0.0);
        self.visit(references_n, trial, kind, |rates, residual_n| {
            columns.add(rates, residual_n);
            squares += if residual_n.is_finite() { residual_n * residual_n } else { 0.0 };
        })?;
        let (factors, gain) = columns.fit(&[0, 1][..count])?;
        let shift = Shift { delay_s: -factors[0], skew: factors.get(1).map_or(0.0, |factor| -factor) };
        Some(Step { shift, gain, gain_ratio: gain / squares, columns })
    }

    /// Returns the factor by which memory in what another improvement would leave weakens the evidence, at least 1.
    fn inflation(&self, of: &Corrected, kind: Kind) -> Option<f64> {
        let Step { columns, .. } = self.improvement(&of.references_n, &of.trial, kind)?;
        let mut memory = columns.memory(&[0, 1][..kind.parameter_count()])?;
        self.visit(&of.references_n, &of.trial, kind, |rates, residual_n| memory.add(rates, residual_n))?;
        Some(memory.inflations().into_iter().fold(1.0, f64::max))
    }

    /// Visits the samples that count with the rate of the reference, for a skew also its product with the time, and with the residual, each less what the
    /// model's parameters can compensate.
    fn visit(&self, references_n: &[f64], trial: &Trial, kind: Kind, mut visit: impl FnMut(&[f64], f64)) -> Option<()> {
        let bench = self.bench(references_n);
        let (left, rate_n_per_s) = (bench.evaluated(&trial.values), rates(&self.record, references_n));
        let signals = || -> Signals<'_> {
            Box::new(|place, numbers| {
                let rate = rate_n_per_s.get(place).copied().unwrap_or(f64::NAN);
                numbers.extend([left.residual_n(place), rate]);
                numbers.extend((kind == Kind::Skew).then(|| rate * seconds(&self.record, place)));
            })
        };
        let problem = bench.problem(&trial.free, None);
        visit_less_projection(&problem, &trial.values, &signals, |_, numbers| {
            if let Some((residual_n, rates)) = numbers.split_first() {
                visit(rates, *residual_n);
            }
        })
    }
}

/// Returns the references interpolated from later samples; NaN past the ends of each log. Each value gets the same part of the samples' noise: a line
/// does this for a delay, which falls at one place between two regular samples, and a quadratic B-spline nearly does for a skew, which wanders from one
/// sample to the next. With a line what is left would be loud wherever the skew falls on a sample.
fn shifted(record: &CableRecord<'_>, shift: Shift) -> Vec<f64> {
    let mut references_n = record.references_n.to_vec();
    for (start, log) in record.logs() {
        let given_n = record.references_n.get(start..start + log.len()).unwrap_or_default();
        let times_s: Vec<f64> = (start..start + log.len()).map(|place| record.time_s(place)).collect();
        let first_s = times_s.first().copied().unwrap_or(0.0);
        let mut of_log = references_n.iter_mut().skip(start);
        let mut given_n = given_n.iter().as_slice();
        // Where a clock was set back the times begin anew.
        for times_s in times_s.chunk_by(|one, next| one <= next) {
            let (of_stretch, rest) = given_n.split_at(times_s.len());
            given_n = rest;
            let mut knots = Knots { times_s, given_n: of_stretch, longest_s: GAP_RATIO * record.interval_s, before: 0 };
            for (time_s, reference_n) in times_s.iter().zip(&mut of_log) {
                let later_s = time_s + shift.delay_s + shift.skew * (time_s - first_s);
                *reference_n = if shift.skew == 0.0 { knots.on_line(later_s) } else { knots.on_spline(later_s) };
            }
        }
    }
    references_n
}

/// The references of a stretch of a log and their times, which do not decrease.
struct Knots<'a> {
    times_s: &'a [f64],
    given_n: &'a [f64],
    /// Nothing is interpolated between samples that are further apart, s.
    longest_s: f64,
    /// The place that was found last, from which the next one is sought.
    before: usize,
}

impl Knots<'_> {
    /// Returns the last sample that is not later than a time, and how far that is on the way to the next one, 0 to 1; `None` before the first sample, after
    /// the last, and in gaps.
    fn place(&mut self, time_s: f64) -> Option<(usize, f64)> {
        let is_past = |place: usize| self.times_s.get(place).is_some_and(|knot_s| *knot_s <= time_s);
        while self.before > 0 && !is_past(self.before) {
            self.before -= 1;
        }
        while is_past(self.before + 1) {
            self.before += 1;
        }
        let (before, at_s) = (self.before, *self.times_s.get(self.before).filter(|at_s| **at_s <= time_s)?);
        match self.times_s.get(before + 1) {
            Some(next_s) if next_s - at_s <= self.longest_s => Some((before, (time_s - at_s) / (next_s - at_s))),
            _ => (time_s - at_s <= 0.0).then_some((before, 0.0)),
        }
    }

    /// Interpolates linearly.
    fn on_line(&mut self, time_s: f64) -> f64 {
        let Some((before, share)) = self.place(time_s) else { return f64::NAN };
        let given_n = |place: usize| self.given_n.get(place).copied().unwrap_or(f64::NAN);
        let before_n = given_n(before);
        if share > 0.0 { before_n + share * (given_n(before + 1) - before_n) } else { before_n }
    }

    /// Weighs three samples by a quadratic B-spline. It leaves 0.50 to 0.59 of the variance of white noise. If the samples are not regular, their mean time
    /// is another, and the slope between them makes up for it.
    fn on_spline(&mut self, time_s: f64) -> f64 {
        let Some((before, share)) = self.place(time_s) else { return f64::NAN };
        let (nearest, off) = if share < 0.5 { (before, share) } else { (before + 1, share - 1.0) };
        let around = nearest.checked_sub(1).map(|first| first..first + 3);
        let [Some([first_n, middle_n, last_n]), Some([first_s, middle_s, last_s])] = [self.given_n, self.times_s]
            .map(|all| around.clone().and_then(|around| all.get(around)?.first_chunk::<3>().copied()))
        else {
            return f64::NAN;
        };
        let weights = [0.5 * (0.5 - off).powi(2), 0.75 - off * off, 0.5 * (0.5 + off).powi(2)];
        let mean = |values: [f64; 3]| weights.iter().zip(values).map(|(weight, value)| weight * value).sum::<f64>();
        if last_s - first_s > 2.0 * self.longest_s {
            return f64::NAN;
        }
        let slope = (last_n - first_n) / (last_s - first_s);
        mean([first_n, middle_n, last_n]) + slope * (time_s - mean([first_s, middle_s, last_s]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The times of regular samples, and of others.
    fn times_s() -> [Vec<f64>; 2] {
        let off = |place: u32| 0.35 * (f64::from(place) * 2.4).sin();
        [(0..24).map(f64::from).collect(), (0..24).map(|place| f64::from(place) + off(place)).collect()]
    }

    #[test]
    fn a_spline_keeps_lines_and_leaves_alike_much_noise_everywhere() {
        for (times_s, is_regular) in times_s().into_iter().zip([true, false]) {
            let given_n: Vec<f64> = times_s.iter().map(|time_s| 3.0 - 0.7 * time_s).collect();
            for percent in 0..200_i32 {
                let at_s = 10.0 + f64::from(percent) / 100.0;
                let mut knots = Knots { times_s: &times_s, given_n: &given_n, longest_s: 10.0, before: 0 };
                assert!((knots.on_spline(at_s) - (3.0 - 0.7 * at_s)).abs() < 1e-12);
                assert!((knots.on_line(at_s) - (3.0 - 0.7 * at_s)).abs() < 1e-12);
                // The response to a single sample is its weight.
                let weight = |of: usize| {
                    let given_n: Vec<f64> = (0..24).map(|place| if place == of { 1.0 } else { 0.0 }).collect();
                    Knots { times_s: &times_s, given_n: &given_n, longest_s: 10.0, before: 3 }.on_spline(at_s)
                };
                let variance: f64 = (7..15).map(|place| weight(place).powi(2)).sum();
                assert!(!is_regular || (0.5..0.595).contains(&variance), "{variance} at {at_s}");
            }
        }
    }

    #[test]
    fn past_the_ends_nothing_is_known() {
        for times_s in times_s() {
            let mut knots = Knots { times_s: &times_s, given_n: &times_s, longest_s: 10.0, before: 20 };
            let [first_s, last_s] = [times_s[0], times_s[23]];
            assert!([first_s, last_s].into_iter().all(|end_s| (knots.on_line(end_s) - end_s).abs() < 1e-12));
            for beyond_s in [first_s - 0.01, last_s + 0.01] {
                assert!(knots.on_line(beyond_s).is_nan() && knots.on_spline(beyond_s).is_nan());
            }
        }
    }

    #[test]
    fn nothing_is_known_in_a_pause() {
        let times_s = [0.0, 1.0, 2.0, 60.0, 61.0, 62.0];
        let mut knots = Knots { times_s: &times_s, given_n: &times_s, longest_s: 10.0, before: 0 };
        let known = [1.5, 2.0, 2.5, 59.0, 60.0, 60.5].map(|time_s| knots.on_line(time_s).is_finite());
        assert_eq!(known, [true, true, false, false, true, true]);
        assert!(knots.on_spline(2.2).is_nan() && knots.on_spline(1.2).is_finite());
    }
}

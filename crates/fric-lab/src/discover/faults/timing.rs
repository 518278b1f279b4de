//! A reference that is late or early, or whose clock runs at another rate than the winch's.
//!
//! A time error shows in the residual as the rate of the reference: a reference that is late by ε leaves `ε·dF/dt`. Delay and skew are improved
//! iteratively from this part of the residual, after removing what the model's parameters can compensate. They are kept if the evidence is strong,
//! weakened by the memory of what they leave, and the model then agrees better on held-out samples. A gain that is wrong, for example, makes
//! much of a ramp of the load look late, but leaves a rest that lasts; once the gain has its name, nothing is late. An early reference may also mean
//! that the sensor lags, which concerns the machine. It is a fault only if the model agrees better with the reference shifted than with the reference
//! behind a lag of first order, which has the effect of `sensor_lag` without its noise.
//!
//! The machine can make the same residual: with a load that goes with the length, viscous friction and inertia do. Where the reference is a function of the
//! length at one of the times, that time is the right one (`of_length`). Elsewhere the evidence for a time error is that beside viscous friction and
//! inertia, which are free then even if the file has none.

use std::sync::atomic::AtomicBool;

use fric_core::effects::Effect;
use fric_core::parameters::OFFSET;

use super::of_length::{is_in_time, late_s};
use super::shifted::{Shift, shifted};
use super::time_fit::{Case, Corrected, Kind, LEAST_GAIN, Step, rates, seconds};
use crate::discover::given::given_to;
use crate::discover::lag::is_better_than_behind_lag;
use crate::discover::naming::STRONG_BIC;
use crate::discover::naming::evidence::delta_bic;
use crate::discover::workbench::{Model, Trial, Workbench};
use crate::fit::{CableRecord, Parameter};
use crate::lateness::Lateness;
use crate::recording_fault::{Fault, RecordingFault};
use crate::samples::interpolated::measured;
use crate::samples::split::split;

/// The time of the reference is examined if more than this fraction of the residual's squares is correlated with the rate of the reference. It is a
/// twentieth of the required gain, because parameters may compensate for part of it. At half this value more logs are examined in vain; at double, a
/// delay whose rate the parameters compensate for to 90 % is missed.
const SUSPICIOUS_SHARE: f64 = 0.05 * LEAST_GAIN;

/// Maximum skew. Quartz clocks agree to 1e-4, loops that are timed by software to a hundredth; what goes faster apart is no clock.
const MOST_SKEW: f64 = 0.02;

/// A reference that is early by less may be right and the sensor behind it: an amplifier's filter takes no longer, s. A reference that is early by more is
/// moved at once.
const LONGEST_LAG_S: f64 = 1.0;

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
    if is_in_time(record, &moved_n) {
        return near_its_time(record, stop);
    }
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
    if let Some(retimed) = late_s(record, LONGEST_LAG_S).and_then(|delay_s| late_by_length(&case, &as_it_is, delay_s)) {
        return Some(retimed);
    }
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
    let by_friction = if is_same { near } else { case.corrected(&as_it_is, Kind::Delay)? };
    if is_in_time(record, &by_friction.references_n) {
        return None;
    }
    let as_it_is = case.beside_rivals(&as_it_is)?;
    let shifted = case.corrected(&as_it_is, Kind::Delay)?;
    let first = case.improvement(record.references_n, &as_it_is, Kind::Skew)?;
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

/// Returns the references taken for so much earlier, at which they are a function of the length, unless the model agrees less with them, as where a load and
/// a motion that repeat themselves are each a function of the other at some time.
fn late_by_length(case: &Case<'_>, as_it_is: &Trial, delay_s: f64) -> Option<Retimed> {
    let references_n = shifted(&case.record, Shift { delay_s, skew: 0.0 });
    let is_known = |(counts, reference_n): (&bool, &f64)| *counts && reference_n.is_finite();
    let counts: Vec<bool> = case.counts.iter().zip(&references_n).map(is_known).collect();
    let case = Case { counts: &counts, ..*case };
    let as_it_is = case.beside_rivals(as_it_is)?;
    let moved = case.fitted_again(&references_n, &as_it_is);
    let fault = RecordingFault {
        fault: Fault::ReferenceDelay,
        parameters: vec![("delay_s", delay_s)],
        intervals_s: Vec::new(),
    };
    (moved.held_out <= (1.0 + LEAST_GAIN) * as_it_is.held_out).then_some(Retimed {
        references_n,
        noise_reach: LINE_REACH,
        fault,
    })
}

//! Guards of the gratings: what the shifts of a run contradict is put right as far as possible, and reported.
//!
//! - A **common step** of all gratings is one of temperature, or a new reference of the demodulator. It is beyond the change that the tension at the
//!   base explains, and of the same size in nm on all of them.
//! - A grating that **contradicts its neighbours** jumps alone, or needs more friction than the holes on both its sides can hold, in opposite
//!   directions. Its tension is interpolated.
//! - Friction at a hole **beyond its capstan bound** is kept as measured.
//!
//! Without the tension at the base a step of that tension looks like a step of the gratings, so none is searched for.

use fric_tendon::ManipulatorParams;
use serde::Serialize;

use super::error::ContinuumError;
use super::fbg::Tension;
use super::friction::{FrictionDistribution, MeasuredFriction, distributions};
use super::gratings::{GratingSample, Gratings, interpolated};
use super::result::intervals_s;
use super::run::Run;
use super::shape_errors::{ComputedShape, Way, shapes};

/// A jump is at least this many times its usual scatter, and this fraction of the greatest tension. None is found
/// in twenty simulated runs without one, and steps of 0.01 nm are (`tests/guards.rs`); other values were not tried.
const JUMP_SCATTERS: f64 = 8.0;
const JUMP_RATIO: f64 = 0.01;
/// Greatest change of a tension in a segment relative to that at the base: `e^(μθ)`, which is 1.8 for μ = 0.18 and half a turn, as the tendon is
/// released.
const EXPLAINED_RATIO: f64 = 2.0;
/// Fraction of a jump by which gratings that jump together may differ, beside noise, and which those that do not jump stay below.
const ALIKE_RATIO: f64 = 0.25;
/// Least fraction of the live gratings that take part in a common step, and their least number.
const COMMON_RATIO: f64 = 0.8;
const LEAST_COMMON: usize = 3;
/// Friction counts as beyond the bound from this multiple of it, as a μ 30 % off counts as another hole, and this many standard errors.
const BOUND_RATIO: f64 = 1.3;
const BOUND_ERRORS: f64 = 4.0;
/// Error of the bound itself as a fraction of the greatest tension: the model's angle at a hole neglects the deflection of the segments, which is
/// 2 mN of friction at 1.7 N for an arm on its side with disks of 1.5 g.
const BOUND_FLOOR_RATIO: f64 = 0.005;
/// Least fraction of the samples in which a hole is beyond its bound.
const BEYOND_RATIO: f64 = 0.05;

/// What a guard has found.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Guard {
    /// All gratings step together; it is taken off from this time on.
    CommonStep {
        /// Time of the first sample after it, s.
        time_s: f64,
        /// Its size, nm.
        step_nm: f64,
    },
    /// A grating contradicts its neighbours; its tension is interpolated.
    ContradictingGrating {
        /// Its number, from 1 at the base.
        grating: usize,
        /// Number of samples.
        samples: usize,
        /// Time intervals, s.
        intervals_s: Vec<[f64; 2]>,
    },
    /// The friction at a hole is beyond its capstan bound.
    BeyondBound {
        /// Its number, from 1 in the base plate.
        hole: usize,
        /// Median ratio of friction to bound in these samples.
        bound_ratio: f64,
        /// Fraction of the samples.
        share_ratio: f64,
    },
}

/// The gratings of a run after all guards.
#[derive(Clone, Debug, PartialEq)]
pub struct Guarded {
    /// The tensions, sample by sample.
    pub measured: Vec<GratingSample>,
    /// What was found, in the order of [`Guard`].
    pub guards: Vec<Guard>,
}

impl Guard {
    /// Returns a warning in one sentence.
    #[must_use]
    pub fn warning(&self) -> String {
        match self {
            Self::CommonStep { time_s, step_nm } => format!(
                "all gratings step by {step_nm:+.4} nm at {time_s} s, as by temperature or a new reference: it is taken off; \
                 record the shift of an unloaded grating as `shift_reference_nm`, or state `common_step_nm`"
            ),
            Self::ContradictingGrating { grating, samples, .. } => format!(
                "grating {grating} contradicts its neighbours in {samples} samples: it jumps alone, or the holes on both sides \
                 cannot hold such friction; check fibre and demodulator"
            ),
            Self::BeyondBound { hole, bound_ratio, share_ratio } => format!(
                "friction at hole {hole} is {bound_ratio:.1} times its capstan bound in {:.0} % of the samples: its μ is \
                 greater than stated, or a grating beside it is wrong; `fric-cli discover` tells them apart",
                100.0 * share_ratio
            ),
        }
    }
}

impl Guarded {
    /// Reads the gratings of a run.
    ///
    /// # Errors
    /// Returns the errors of [`Gratings::read`]. Checked parameters cause no other.
    pub fn read(params: &ManipulatorParams, gratings: &Gratings, run: &Run) -> Result<Self, ContinuumError> {
        let mut tensions = gratings.unbridged(run)?;
        let mut guards = Vec::new();
        let mut is_out = vec![vec![false; run.disk_count()]; tensions.len()];
        if run.has_tension() {
            guards = without_common_steps(run, gratings, &mut tensions);
            mark_lone(&Jumps::of(run, gratings, &tensions), &mut is_out);
        }
        for (tension, _) in tensions.iter_mut().flatten().zip(is_out.iter().flatten()).filter(|(_, is_out)| **is_out) {
            tension.value_n = f64::NAN;
        }
        let mut measured = Gratings::bridged(run, tensions)?;
        let mut beyond = beyond_bounds(params, run, &measured)?;
        if mark_ruled_out(&beyond, &measured, &mut is_out) {
            for ((sample, is_out), row) in measured.iter_mut().zip(&is_out).zip(run.samples()) {
                let tension = &mut sample.tension;
                for ((tension, is_bridged), is_out) in tension.iter_mut().zip(&sample.is_bridged).zip(is_out) {
                    if *is_bridged || *is_out {
                        tension.value_n = f64::NAN;
                    }
                }
                *sample = interpolated(std::mem::take(tension), row.tension_base_n);
            }
            beyond = beyond_bounds(params, run, &measured)?;
        }
        let time_s: Vec<f64> = run.samples().iter().map(|sample| sample.time_s).collect();
        guards.extend((0..run.disk_count()).filter_map(|place| {
            let holds = || is_out.iter().map(move |row| row[place]);
            let samples = holds().filter(|is_out| *is_out).count();
            let intervals_s = intervals_s(&time_s, holds());
            (samples > 0).then_some(Guard::ContradictingGrating { grating: place + 1, samples, intervals_s })
        }));
        guards.extend((0..run.disk_count()).filter_map(|hole| beyond_bound(hole, &beyond, &measured)));
        Ok(Self { measured, guards })
    }
}

/// Changes of the shifts from one sample to the next, by sample and grating, nm; NaN where one is not known.
#[expect(clippy::struct_field_names, reason = "the unit")]
struct Jumps {
    /// The change beyond that of the samples around.
    jump_nm: Vec<Vec<f64>>,
    /// The change beyond all that the change of the tension at the base explains.
    unexplained_nm: Vec<Vec<f64>>,
    /// Usual size of each grating's jump, and the fraction of the greatest tension below which none counts.
    scatter_nm: Vec<f64>,
    floor_nm: Vec<f64>,
}

impl Jumps {
    fn of(run: &Run, gratings: &Gratings, tensions: &[Vec<Tension>]) -> Self {
        let samples = run.samples();
        let greatest_n = samples.iter().map(|sample| sample.tension_base_n).fold(0.0, f64::max);
        let slope = |grating: usize| gratings.lines()[grating].newton_per_nm;
        let change_nm = |place: usize, grating: usize| {
            let value_n = |place: usize| tensions.get(place).map_or(f64::NAN, |row| row[grating].value_n);
            place.checked_sub(1).map_or(f64::NAN, |before| (value_n(place) - value_n(before)) / slope(grating))
        };
        let count = run.disk_count();
        let (mut jump_nm, mut unexplained_nm) = (Vec::new(), Vec::new());
        for place in 0..samples.len() {
            let base_n = |place: usize| samples[place].tension_base_n;
            let base_change_n = place.checked_sub(1).map_or(0.0, |before| base_n(place) - base_n(before));
            let around = [place.wrapping_sub(2), place.wrapping_sub(1), place + 1, place + 2];
            jump_nm.push(
                (0..count)
                    .map(|grating| {
                        let usual_nm = around.into_iter().map(|other| change_nm(other, grating));
                        change_nm(place, grating) - median(usual_nm.collect())
                    })
                    .collect(),
            );
            unexplained_nm.push(
                (0..count)
                    .map(|grating| {
                        let (change_nm, whole_nm) =
                            (change_nm(place, grating), EXPLAINED_RATIO * base_change_n / slope(grating));
                        change_nm - change_nm.clamp(whole_nm.min(0.0), whole_nm.max(0.0))
                    })
                    .collect(),
            );
        }
        let scatter_nm: Vec<f64> =
            (0..count).map(|grating| scatter(jump_nm.iter().map(|row: &Vec<f64>| row[grating]))).collect();
        let floor_nm = (0..count).map(|grating| JUMP_RATIO * greatest_n / slope(grating).abs()).collect();
        Self { jump_nm, unexplained_nm, scatter_nm, floor_nm }
    }
}

/// Returns the median of the finite numbers; NaN if there are none.
fn median(mut values: Vec<f64>) -> f64 {
    values.retain(|value| value.is_finite());
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match (values.get(middle), middle.checked_sub(1).and_then(|before| values.get(before))) {
        (Some(high), Some(low)) if values.len().is_multiple_of(2) => 0.5 * (low + high),
        (Some(middle), _) => *middle,
        (None, _) => f64::NAN,
    }
}

/// Returns the standard deviation of the numbers without outliers, from the median of their magnitudes; 0 if there are none.
fn scatter(values: impl Iterator<Item = f64>) -> f64 {
    let typical = 1.4826 * median(values.map(f64::abs).collect());
    if typical.is_finite() { typical } else { 0.0 }
}

/// Returns the run with common steps taken off its shifts, and these steps; the run as it is if the tension at the base is not known.
///
/// # Errors
/// Returns the errors of [`Gratings::unbridged`].
pub fn steadied(run: Run, gratings: &Gratings) -> Result<(Run, Vec<Guard>), ContinuumError> {
    if !run.has_tension() || !run.has_shifts() {
        return Ok((run, Vec::new()));
    }
    let mut tensions = gratings.unbridged(&run)?;
    let steps = without_common_steps(&run, gratings, &mut tensions);
    let without = |run: Run, step: &Guard| match step {
        Guard::CommonStep { time_s, step_nm } => run.without_step(*time_s, *step_nm),
        Guard::ContradictingGrating { .. } | Guard::BeyondBound { .. } => run,
    };
    Ok((steps.iter().fold(run, without), steps))
}

/// Takes common steps off the tensions, and returns them.
fn without_common_steps(run: &Run, gratings: &Gratings, tensions: &mut [Vec<Tension>]) -> Vec<Guard> {
    let jumps = Jumps::of(run, gratings, tensions);
    let middle_nm: Vec<f64> = jumps.jump_nm.iter().map(|row| median(row.clone())).collect();
    let least_nm = median(jumps.floor_nm.clone()).max(JUMP_SCATTERS * scatter(middle_nm.iter().copied()));
    let mut found = Vec::new();
    for (place, step_nm) in middle_nm.into_iter().enumerate() {
        let (row, unexplained_nm) = (&jumps.jump_nm[place], median(jumps.unexplained_nm[place].clone()));
        let live = row.iter().filter(|jump_nm| jump_nm.is_finite()).count();
        let is_alike = |(jump_nm, scatter_nm): &(&f64, &f64)| {
            (*jump_nm - step_nm).abs() <= ALIKE_RATIO * step_nm.abs() + 0.5 * JUMP_SCATTERS * *scatter_nm
        };
        let alike = row.iter().zip(&jumps.scatter_nm).filter(is_alike).count();
        #[expect(clippy::cast_precision_loss, reason = "a number of gratings")]
        let is_common = alike >= LEAST_COMMON && alike as f64 >= COMMON_RATIO * live as f64;
        if is_common && step_nm.abs() > least_nm && unexplained_nm.abs() > 0.5 * step_nm.abs() {
            for (tension, line) in tensions[place..].iter_mut().flat_map(|row| row.iter_mut().zip(gratings.lines())) {
                tension.value_n -= line.newton_per_nm * step_nm;
            }
            found.push(Guard::CommonStep { time_s: run.samples()[place].time_s, step_nm });
        }
    }
    found
}

/// Marks the samples from where a grating jumps alone to where it jumps back.
fn mark_lone(jumps: &Jumps, is_out: &mut [Vec<bool>]) {
    for (grating, (floor_nm, scatter_nm)) in jumps.floor_nm.iter().zip(&jumps.scatter_nm).enumerate() {
        let least_nm = floor_nm.max(JUMP_SCATTERS * scatter_nm);
        let (mut offset_nm, mut greatest_nm) = (0.0_f64, 0.0_f64);
        for ((row, unexplained), is_out) in jumps.jump_nm.iter().zip(&jumps.unexplained_nm).zip(is_out.iter_mut()) {
            let jump_nm = row[grating];
            let others = row.iter().enumerate().filter(|(other, _)| *other != grating);
            let others_nm = median(others.map(|(_, jump_nm)| jump_nm.abs()).collect());
            if jump_nm.abs() > least_nm
                && unexplained[grating].abs() > 0.5 * jump_nm.abs()
                && others_nm < ALIKE_RATIO * jump_nm.abs()
            {
                offset_nm += jump_nm;
                greatest_nm = greatest_nm.max(jump_nm.abs());
                if offset_nm.abs() < ALIKE_RATIO * greatest_nm {
                    (offset_nm, greatest_nm) = (0.0, 0.0);
                }
            }
            is_out[grating] |= greatest_nm > 0.0;
        }
    }
}

/// Returns the ratio of friction to bound at each hole where it is beyond that with certainty, by sample; else 0. Its sign is the friction's.
fn beyond_bounds(
    params: &ManipulatorParams,
    run: &Run,
    measured: &[GratingSample],
) -> Result<Vec<Vec<f64>>, ContinuumError> {
    let shapes = shapes(params, run.samples(), Way::Measured, measured)?;
    let greatest_n =
        measured.iter().flat_map(|sample| &sample.tension).map(|tension| tension.value_n).fold(0.0, f64::max);
    let row = |(shape, friction): (&ComputedShape, FrictionDistribution)| -> Vec<f64> {
        let holes = friction.holes.iter().zip(&shape.bound_n);
        let ratio = |(hole, bound_n): (&MeasuredFriction, &f64)| {
            let least_n = BOUND_RATIO * bound_n + BOUND_ERRORS * hole.standard_error_n + BOUND_FLOOR_RATIO * greatest_n;
            let is_beyond = shape.status.has_shape() && *bound_n > 0.0 && hole.friction_n.abs() > least_n;
            if is_beyond { hole.friction_n / bound_n } else { 0.0 }
        };
        holes.map(ratio).collect()
    };
    Ok(shapes.iter().zip(distributions(run, measured)).map(row).collect())
}

/// Marks gratings whose holes on both sides are beyond their bounds in opposite directions. Returns whether there are any.
fn mark_ruled_out(beyond: &[Vec<f64>], measured: &[GratingSample], is_out: &mut [Vec<bool>]) -> bool {
    let mut has_any = false;
    for ((ratios, sample), is_out) in beyond.iter().zip(measured).zip(is_out) {
        for (grating, pair) in ratios.windows(2).enumerate() {
            let around = grating.saturating_sub(1)..(grating + 2).min(sample.is_bridged.len());
            if pair[0] * pair[1] < 0.0 && !sample.is_bridged[around].contains(&true) {
                is_out[grating] = true;
                has_any = true;
            }
        }
    }
    has_any
}

/// Returns how far and how often a hole is beyond its bound, among the samples in which both its gratings are alive.
fn beyond_bound(hole: usize, beyond: &[Vec<f64>], measured: &[GratingSample]) -> Option<Guard> {
    let is_live = |sample: &GratingSample| {
        !sample.is_bridged[hole] && hole.checked_sub(1).is_none_or(|before| !sample.is_bridged[before])
    };
    let live = beyond.iter().zip(measured).filter(|(_, sample)| is_live(sample)).map(|(row, _)| row[hole].abs());
    let live: Vec<f64> = live.collect();
    let ratios: Vec<f64> = live.iter().copied().filter(|ratio| *ratio > 0.0).collect();
    #[expect(clippy::cast_precision_loss, reason = "numbers of samples")]
    let share_ratio = ratios.len() as f64 / live.len().max(1) as f64;
    (share_ratio >= BEYOND_RATIO).then(|| Guard::BeyondBound {
        hole: hole + 1,
        bound_ratio: median(ratios),
        share_ratio,
    })
}

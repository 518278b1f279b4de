//! The equations of equilibrium and their solution by a damped Newton method.
//!
//! The unknowns are the bend of every segment and, if friction depends on the shape, the tension in every segment. The equations are:
//!
//! - `θ_i = θ_i,0 + L/(E·I)_i·(Σ_tendons T_i·m(θ_i) + Q_i)` (\[C\] 9, 10, 15), with the moment averaged over the segment: the arm m of the straight
//!   tendon ([`Chord`]) and the moment Q of weight and tip load ([`super::load`]). Beyond \[C\], a segment may have its own stiffness and an unloaded
//!   bend θ_i,0.
//! - `T_{i−1} − T_i = f_i` (\[C\] 11, 14) with the friction of hole i.
//!
//! Slopes are exact; those of a contact come from numbers that carry derivatives. A contact has a kink where its motion reverses, at which Newton's
//! method may alternate. If the bounds of the friction are held, however, a step of the contacts minimises a convex energy with continuous slope. So
//! a Newton step that does not halve the residual is replaced by the step with held bounds, as far as the residual forces do work along it.

use fric_core::scalar::Scalar;
use fric_core::words::words_of;

use super::arc::{Chord, GREATEST_BEND_RAD};
use super::chain::{BendRow, Chain, HoleRow, Link};
use super::load::{Moments, moments};
use crate::friction::{Direction, Passage};
use crate::params::{ManipulatorParams, Tendon};

/// Maximum number of Newton steps of one solution.
const MOST_STEPS: u32 = 60;
/// Maximum number of reductions of one step.
const MOST_TRIALS: u32 = 12;
/// Largest change of a bend in one step, rad.
const LONGEST_STEP_RAD: f64 = 0.5;
/// Tolerance, relative to 1 rad and the tension at the base.
const SOLVED: f64 = 1e-12;
/// Error that is still accepted if rounding keeps the residual from falling further.
const STALLED: f64 = 1e-9;

/// A state of the manipulator, in equilibrium or on the way to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point<const DISKS: usize> {
    pub bend_rad: [f64; DISKS],
    pub tension_n: [[f64; DISKS]; 2],
}

impl<const DISKS: usize> Point<DISKS> {
    /// Straight and without tension; as a step, no change.
    pub const ZERO: Self = Self { bend_rad: [0.0; DISKS], tension_n: [[0.0; DISKS]; 2] };
}

words_of!(Point<const DISKS> { bend_rad, tension_n });

/// The law of the holes.
#[derive(Clone, Copy, Debug)]
pub enum Law<'a, const DISKS: usize> {
    /// The tensions are given.
    Given,
    /// All holes slide.
    Sliding(Direction),
    /// The holes have memory.
    Presliding(&'a Contacts<DISKS>),
}

/// The memory of the holes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contacts<const DISKS: usize> {
    /// Friction of each hole, N.
    pub friction_n: [[f64; DISKS]; 2],
    /// Displacement of each tendon through each hole towards the base, m, from any origin.
    pub travel_m: [[f64; DISKS]; 2],
}

words_of!(Contacts<const DISKS> { friction_n, travel_m });

/// The target of a solution.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    pub base_tension_n: [f64; 2],
    /// Fraction of weight and tip load that acts.
    pub load_share: f64,
}

/// Returns the chords of both tendons.
pub fn chords<const DISKS: usize>(params: &ManipulatorParams, bend_rad: &[f64; DISKS]) -> [[Chord; DISKS]; 2] {
    let mut both = [[Chord::NONE; DISKS]; 2];
    let [first, second] = &mut both;
    let segments = first.iter_mut().zip(second).zip(params.pitch_m().iter().zip(bend_rad));
    for ((first, second), (pitch_m, bend_rad)) in segments {
        [*first, *second] = Chord::both(*pitch_m, params.hole_radius_m, *bend_rad);
    }
    both
}

/// Returns the displacement of a tendon through each hole towards the base: the shortening of the chords beyond plus the stretch of the tendon there.
fn travel_m<const DISKS: usize>(
    chords: &[Chord; DISKS],
    tension_n: &[f64; DISKS],
    axial_stiffness_n: f64,
    count: usize,
) -> [f64; DISKS] {
    let mut travel_m = [0.0; DISKS];
    let flexibility = 1.0 / axial_stiffness_n;
    let mut sum_m = 0.0;
    for ((travel_m, chord), tension_n) in travel_m.iter_mut().zip(chords).zip(tension_n).take(count).rev() {
        sum_m += chord.length_m * (tension_n * flexibility - 1.0);
        *travel_m = sum_m;
    }
    travel_m
}

/// Returns the same for both tendons at a point.
pub fn travels_m<const DISKS: usize>(params: &ManipulatorParams, point: &Point<DISKS>) -> [[f64; DISKS]; 2] {
    let [first_chords, second_chords] = chords(params, &point.bend_rad);
    let ([first_n, second_n], [first, second]) = (&point.tension_n, &params.tendons);
    [
        travel_m(&first_chords, first_n, first.axial_stiffness_n, params.disk_count),
        travel_m(&second_chords, second_n, second.axial_stiffness_n, params.disk_count),
    ]
}

/// Returns the tendon's state at each hole; the motion is left at 0.
pub fn passages<const DISKS: usize>(
    point: &Point<DISKS>,
    tendon: Tendon,
    base_tension_n: f64,
) -> impl Iterator<Item = Passage> {
    let mut base_side_n = base_tension_n;
    let mut before_rad = 0.0;
    point.bend_rad.iter().zip(tendon.of(&point.tension_n)).map(move |(&bend_rad, &tip_side_n)| {
        let passage = Passage { base_side_n, tip_side_n, wrap_rad: 0.5 * (before_rad + bend_rad), motion_m: 0.0 };
        base_side_n = tip_side_n;
        before_rad = bend_rad;
        passage
    })
}

/// The equations and the buffers for their solution.
#[derive(Clone, Debug)]
pub struct Newton<const DISKS: usize> {
    chain: Chain<DISKS>,
}

/// The tendons with unknown tensions.
#[derive(Clone, Copy, Debug)]
struct Unknowns {
    /// Number of segments.
    count: usize,
    tendons: [bool; 2],
}

impl Unknowns {
    fn new<const DISKS: usize>(
        params: &ManipulatorParams,
        point: &Point<DISKS>,
        target: &Target,
        law: &Law<'_, DISKS>,
    ) -> Self {
        let count = params.disk_count.min(DISKS);
        let mut tendons = [false; 2];
        if !matches!(law, Law::Given) {
            for ((is_unknown, base_n), tension_n) in tendons.iter_mut().zip(target.base_tension_n).zip(&point.tension_n)
            {
                *is_unknown = base_n > 0.0 || tension_n.iter().any(|&tension_n| tension_n != 0.0);
            }
        }
        Self { count, tendons }
    }
}

/// The equations of one solution.
struct Problem<'a, const DISKS: usize> {
    params: &'a ManipulatorParams,
    target: &'a Target,
    law: &'a Law<'a, DISKS>,
    unknowns: Unknowns,
    /// Unit of the tensions, N.
    unit_n: f64,
    /// Whether the slopes neglect the change of the friction bounds.
    holds_bounds: bool,
}

/// The distance of a point from the solution.
#[derive(Clone, Copy, Debug)]
struct Distance {
    /// Norm of the residuals, in rad and units of tension.
    error: f64,
    /// Work of the residual forces along a step, N m; negative if they drive the step on.
    work_nm: f64,
}

impl<'a, const DISKS: usize> Problem<'a, DISKS> {
    fn new(params: &'a ManipulatorParams, start: &Point<DISKS>, target: &'a Target, law: &'a Law<'a, DISKS>) -> Self {
        let largest_n = target.base_tension_n.into_iter().fold(0.0, f64::max);
        // When a tendon is released, a residual matters only if it bends the manipulator visibly.
        let [pitch_m, ..] = params.pitch_m;
        let least_n = 1e-6 * params.bending_stiffness_n_m2 / (pitch_m * params.hole_radius_m);
        Self {
            params,
            target,
            law,
            unknowns: Unknowns::new(params, start, target, law),
            unit_n: largest_n.max(least_n),
            holds_bounds: false,
        }
    }

    /// Writes the linearised equations at a point.
    fn write(&self, point: &Point<DISKS>, step: &Point<DISKS>, chain: &mut Chain<DISKS>) -> Distance {
        let chords = chords(self.params, &point.bend_rad);
        let (mut squares, mut work_nm) = self.bending(point, step, &chords, &mut chain.links);
        for (tendon, is_unknown) in Tendon::BOTH.into_iter().zip(self.unknowns.tendons) {
            if is_unknown {
                let (own_squares, own_nm) = self.passing(point, step, tendon, &chords, &mut chain.links);
                squares += own_squares;
                work_nm += own_nm;
            }
        }
        Distance { error: Scalar::sqrt(squares), work_nm }
    }

    /// Writes the equations of the bends. Returns the sum of their squared residuals, and the work of the residual moments.
    fn bending(
        &self,
        point: &Point<DISKS>,
        step: &Point<DISKS>,
        chords: &[[Chord; DISKS]; 2],
        links: &mut [Link; DISKS],
    ) -> (f64, f64) {
        let Moments { moment_nm, slope_nm, own_slope_nm } = if self.params.has_load() {
            moments(self.params, &point.bend_rad, self.target.load_share)
        } else {
            Moments { moment_nm: [0.0; DISKS], slope_nm: [0.0; DISKS], own_slope_nm: [0.0; DISKS] }
        };
        let [first_chords, second_chords] = chords;
        let [first_n, second_n] = &point.tension_n;
        let tendons = first_chords.iter().zip(first_n).zip(second_chords.iter().zip(second_n));
        let loads = moment_nm.iter().zip(slope_nm.iter().zip(&own_slope_nm));
        let bends = point.bend_rad.iter().zip(&step.bend_rad);
        let backbone = self.params.pitch_m.iter().zip(&self.params.segment_stiffness_n_m2);
        let segments = backbone.zip(&self.params.rest_bend_rad);
        let (mut squares, mut work_nm) = (0.0, 0.0);
        for (link, (((bend, segment), load), tendons)) in
            links.iter_mut().zip(bends.zip(segments).zip(loads).zip(tendons)).take(self.unknowns.count)
        {
            let (bend_rad, change_rad) = bend;
            let ((pitch_m, stiffness_n_m2), rest_rad) = segment;
            let compliance = pitch_m / stiffness_n_m2;
            let (outside_nm, (outside_slope, outside_own_slope)) = load;
            let ((first, first_n), (second, second_n)) = tendons;
            let moment_nm = first_n * first.arm_m + second_n * second.arm_m + outside_nm;
            let slope = first_n * first.arm_slope_m + second_n * second.arm_slope_m + outside_own_slope;
            let residual = bend_rad - rest_rad - compliance * moment_nm;
            squares += residual * residual;
            work_nm += residual / compliance * change_rad;
            link.bend = BendRow {
                own: 1.0 - compliance * slope,
                by_tension: [compliance * first.arm_m, compliance * second.arm_m],
                compliance,
                load_slope: *outside_slope,
                right: -residual,
            };
            link.holes = [HoleRow::KNOWN; 2];
        }
        (squares, work_nm)
    }

    /// Writes the equations of one tendon's tensions. Returns the sum of their squared residuals, and the work of the residual forces.
    fn passing(
        &self,
        point: &Point<DISKS>,
        step: &Point<DISKS>,
        tendon: Tendon,
        chords: &[[Chord; DISKS]; 2],
        links: &mut [Link; DISKS],
    ) -> (f64, f64) {
        let count = self.unknowns.count;
        let chords = tendon.of(chords);
        let tension_n = tendon.of(&point.tension_n);
        let params = tendon.of(&self.params.tendons);
        let flexibility = 1.0 / params.axial_stiffness_n;
        let is_presliding = matches!(self.law, Law::Presliding(_));
        // The displacement of the tendon through each hole, and its change by the step.
        let (mut travels_m, mut changes_m) = ([0.0; DISKS], [0.0; DISKS]);
        if is_presliding {
            travels_m = travel_m(chords, tension_n, params.axial_stiffness_n, count);
            let mut sum_m = 0.0;
            let changes = step.bend_rad.iter().zip(tendon.of(&step.tension_n));
            let segments = changes_m.iter_mut().zip(chords.iter().zip(tension_n).zip(changes));
            for (change_m, ((chord, tension_n), (change_rad, change_n))) in segments.take(count).rev() {
                sum_m += chord.arm_m * (1.0 - tension_n * flexibility) * change_rad
                    + chord.length_m * flexibility * change_n;
                *change_m = sum_m;
            }
        }
        let per_unit = 1.0 / self.unit_n;
        let (mut squares, mut work_nm) = (0.0, 0.0);
        let holes = params.holes().zip(passages(point, tendon, *tendon.of(&self.target.base_tension_n)));
        let ways = travels_m.iter().zip(&changes_m).zip(chords.iter().zip(tension_n));
        let segments = links.iter_mut().zip(holes).zip(ways);
        for (place, ((link, (hole, mut passage)), ((travel_m, change_m), (chord, tension_n)))) in
            segments.enumerate().take(count)
        {
            let friction = match self.law {
                Law::Given => continue,
                Law::Sliding(direction) => {
                    hole.sliding(&passage, (*direction == Direction::Pulling) == (tendon == Tendon::Agonist))
                }
                Law::Presliding(contacts) => {
                    let at = |all: &[f64; DISKS]| all.get(place).copied().unwrap_or(0.0);
                    passage.motion_m = travel_m - at(tendon.of(&contacts.travel_m));
                    hole.presliding(&passage, at(tendon.of(&contacts.friction_n)))
                }
            };
            let [base_slope, tip_slope, wrap_slope, motion_slope] = match friction.slopes {
                [.., motion_slope] if self.holds_bounds => [0.0, 0.0, 0.0, motion_slope],
                slopes => slopes,
            };
            let left_n = passage.base_side_n - passage.tip_side_n - friction.friction_n;
            squares += left_n * left_n * per_unit * per_unit;
            work_nm -= left_n * change_m;
            let [first, second] = &mut link.holes;
            *(if tendon == Tendon::Agonist { first } else { second }) = HoleRow {
                base_side: (1.0 - base_slope) * per_unit,
                tip_side: -(1.0 + tip_slope) * per_unit,
                wrap: -0.5 * wrap_slope * per_unit,
                motion: -motion_slope * per_unit,
                way_by_bend: chord.arm_m * (1.0 - tension_n * flexibility),
                way_by_tension: chord.length_m * flexibility,
                right: -left_n * per_unit,
            };
        }
        (squares, work_nm)
    }
}

impl<const DISKS: usize> Newton<DISKS> {
    pub const fn new() -> Self {
        Self { chain: Chain::new() }
    }

    /// Returns an equilibrium near `start`; `None` if none is found.
    pub fn solve(
        &mut self,
        params: &ManipulatorParams,
        start: &Point<DISKS>,
        target: &Target,
        law: &Law<'_, DISKS>,
    ) -> Option<Point<DISKS>> {
        let mut problem = Problem::new(params, start, target, law);
        let mut point = *start;
        let mut error = problem.write(&point, &Point::ZERO, &mut self.chain).error;
        for _ in 0..MOST_STEPS {
            if error <= SOLVED {
                return Some(point);
            }
            if !error.is_finite() || !self.chain.eliminate(problem.unknowns.count) {
                return None;
            }
            let step = self.chain.solution(problem.unknowns.count);
            let whole = whole_share(&step);
            let trial = moved(&point, &step, whole);
            let trial_error = problem.write(&trial, &step, &mut self.chain).error;
            let next = if trial_error <= 0.5 * error {
                Some((trial, trial_error))
            } else if error <= STALLED {
                // Rounding, amplified by stiff contacts.
                break;
            } else if let Law::Presliding(_) = law {
                self.least_energy(&mut problem, &point)
            } else {
                self.smaller_error(&problem, (&point, error), &step, 0.5 * whole)
            };
            let Some(next) = next else { break };
            (point, error) = next;
        }
        (error <= STALLED).then_some(point)
    }

    /// Returns the change of a point in equilibrium with a change of the base tensions, N.
    pub fn change_with(
        &mut self,
        params: &ManipulatorParams,
        point: &Point<DISKS>,
        target: &Target,
        law: &Law<'_, DISKS>,
        change_n: [f64; 2],
    ) -> Point<DISKS> {
        let mut problem = Problem::new(params, point, target, law);
        for (is_unknown, change_n) in problem.unknowns.tendons.iter_mut().zip(change_n) {
            *is_unknown |= change_n != 0.0;
        }
        problem.write(point, &Point::ZERO, &mut self.chain);
        if self.chain.eliminate(problem.unknowns.count) {
            self.chain.by_base_tension(problem.unknowns.count, change_n)
        } else {
            Point::ZERO
        }
    }

    /// Returns the first point along a step, halved repeatedly, at which the residual is smaller.
    fn smaller_error(
        &mut self,
        problem: &Problem<'_, DISKS>,
        (point, error): (&Point<DISKS>, f64),
        step: &Point<DISKS>,
        first: f64,
    ) -> Option<(Point<DISKS>, f64)> {
        let mut share = first;
        for _ in 0..MOST_TRIALS {
            let trial = moved(point, step, share);
            let trial_error = problem.write(&trial, step, &mut self.chain).error;
            if trial_error < error * (1.0 - 1e-3 * share) {
                return Some((trial, trial_error));
            }
            share *= 0.5;
        }
        None
    }

    /// Returns the approximate point of least energy along the Newton step with held bounds: where the work changes its sign, by false position with
    /// halved ends (Illinois).
    fn least_energy(&mut self, problem: &mut Problem<'_, DISKS>, point: &Point<DISKS>) -> Option<(Point<DISKS>, f64)> {
        problem.holds_bounds = true;
        problem.write(point, &Point::ZERO, &mut self.chain);
        let is_solved = self.chain.eliminate(problem.unknowns.count);
        problem.holds_bounds = false;
        if !is_solved {
            return None;
        }
        let step = self.chain.solution(problem.unknowns.count);
        let begin_nm = problem.write(point, &step, &mut self.chain).work_nm;
        let (mut near, mut near_nm) = (0.0, begin_nm);
        let mut share = whole_share(&step);
        let mut trial = moved(point, &step, share);
        let mut distance = problem.write(&trial, &step, &mut self.chain);
        if distance.work_nm <= 0.0 {
            return Some((trial, distance.error));
        }
        let (mut far, mut far_nm) = (share, distance.work_nm);
        for _ in 0..MOST_TRIALS {
            if distance.work_nm.abs() <= 0.3 * begin_nm.abs() {
                break;
            }
            let between = near - near_nm * (far - near) / (far_nm - near_nm);
            share = between.min(far - 0.02 * (far - near)).max(near + 0.02 * (far - near));
            trial = moved(point, &step, share);
            distance = problem.write(&trial, &step, &mut self.chain);
            if distance.work_nm > 0.0 {
                (far, far_nm) = (share, distance.work_nm);
                near_nm *= 0.5;
            } else {
                (near, near_nm) = (share, distance.work_nm);
                far_nm *= 0.5;
            }
        }
        Some((trial, distance.error))
    }

    /// Whether the equilibrium is stable at constant tensions.
    pub fn is_stable(&mut self, params: &ManipulatorParams, point: &Point<DISKS>, target: &Target) -> bool {
        let problem = Problem::new(params, point, target, &Law::Given);
        problem.write(point, &Point::ZERO, &mut self.chain).error.is_finite()
            && self.chain.is_stiff(problem.unknowns.count)
    }
}

/// Returns the fraction of a step that may be taken at once.
fn whole_share<const DISKS: usize>(step: &Point<DISKS>) -> f64 {
    let longest_rad = step.bend_rad.iter().fold(0.0_f64, |most, change| most.max(change.abs()));
    if longest_rad > LONGEST_STEP_RAD { LONGEST_STEP_RAD / longest_rad } else { 1.0 }
}

/// Returns a point after a fraction of a step; bends stay within the limits of a segment.
pub fn moved<const DISKS: usize>(point: &Point<DISKS>, step: &Point<DISKS>, share: f64) -> Point<DISKS> {
    let add = |from: &[f64; DISKS], change: &[f64; DISKS], most: f64| {
        let mut sum = *from;
        for (sum, change) in sum.iter_mut().zip(change) {
            // `clamp` is avoided because it panics for bounds in the wrong order.
            *sum = (*sum + share * change).min(most).max(-most);
        }
        sum
    };
    let ([first, second], [first_change, second_change]) = (&point.tension_n, &step.tension_n);
    Point {
        bend_rad: add(&point.bend_rad, &step.bend_rad, GREATEST_BEND_RAD),
        tension_n: [add(first, first_change, f64::MAX), add(second, second_change, f64::MAX)],
    }
}

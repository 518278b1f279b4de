//! The static model of the manipulator: base tensions in, shape out.

use core::fmt;

use fric_core::words::{Words, words_of};

use super::friction::Friction;
use super::params::{MAX_DISKS, ManipulatorError, ManipulatorParams, Tendon, count_error};
use super::shape::{Shape, ShapeStatus};
use super::solver::load::positions;
use super::solver::newton::{Contacts, Law, Newton, Point, Target, chords, moved, passages, travels_m};

/// Number of load steps from the straight, unloaded manipulator, if the last shape is no good start.
const LOAD_STEPS: u32 = 32;
/// Maximum number of halvings of a step of the base tensions, if the holes' equations have no solution at once.
const MOST_PARTS: u32 = 48;
/// Fraction of its bound from which the friction of a hole has slid, and has forgotten what it held before: a Dahl contact holds a hundredth of that
/// then.
const SLID_RATIO: f64 = 0.99;

/// Static model of a manipulator of up to `DISKS` disks, [`MAX_DISKS`](super::MAX_DISKS) at most.
///
/// [`solve`](Self::solve) is total and bounded. A solution starts from the last shape; if that fails, it increases the load in steps from the
/// unloaded manipulator.
///
/// **[`Friction::History`].** Each hole has a Dahl state ([`fric_core::dahl`]), driven by the way of the tendon through that hole:
/// what the chords beyond it shorten and the tendon beyond it stretches. All holes and the shape are solved together at
/// the end of the step, so that a step may be as long as the tension moves one way; a reversal belongs to the end of a step.
/// The first step is taken as pulled from the unloaded tendon, unless [`begin_history`](Self::begin_history) states what the holes hold. Holes are as many states as there are, and nothing else is
/// remembered: the other ways may be solved in between and leave the holes as they are.
#[derive(Clone, Debug)]
pub struct StaticModel<const DISKS: usize> {
    params: ManipulatorParams,
    newton: Newton<DISKS>,
    state: State<DISKS>,
}

/// The state that one solution leaves for the next.
#[derive(Clone, Copy, Debug, PartialEq)]
struct State<const DISKS: usize> {
    shape: Shape<DISKS>,
    /// The end of the last history step; `None` before the first.
    history: Option<Past<DISKS>>,
}

impl<const DISKS: usize> Words for State<DISKS> {
    fn each_word(&mut self, show: &mut dyn FnMut(&mut u64)) {
        let Self { shape, history } = self;
        shape.each_word(show);
        let (mut is_known, mut past) = (history.is_some(), history.unwrap_or(Past::ZERO));
        is_known.each_word(show);
        past.each_word(show);
        *history = is_known.then_some(past);
    }
}

/// The state of a [`StaticModel`] at one time, for [`StaticModel::restore`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticSnapshot<const DISKS: usize>(State<DISKS>);

/// The error for a state of a manipulator with another number of disks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StateMismatch {
    /// Number of disks of the manipulator.
    pub expected: usize,
    /// Number of disks in the state.
    pub found: usize,
}

impl fmt::Display for StateMismatch {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { expected, found } = self;
        write!(formatter, "the state is of a manipulator with {found} disks, this one has {expected}")
    }
}

impl core::error::Error for StateMismatch {}

impl<const DISKS: usize> Words for StaticSnapshot<DISKS> {
    fn each_word(&mut self, show: &mut dyn FnMut(&mut u64)) {
        self.0.each_word(show);
    }
}

/// The manipulator at the end of a history step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Past<const DISKS: usize> {
    pub point: Point<DISKS>,
    pub base_tension_n: [f64; 2],
    pub contacts: Contacts<DISKS>,
    /// Change of the point and of the base tensions during the step: the start of the next step's search, not memory.
    change: Point<DISKS>,
    change_n: [f64; 2],
    /// Whether each hole may still hold something from before the history.
    is_uncertain: [[bool; DISKS]; 2],
}

words_of!(Past<const DISKS> { point, base_tension_n, contacts, change, change_n, is_uncertain });

impl<const DISKS: usize> Past<DISKS> {
    const ZERO: Self = Self {
        point: Point::ZERO,
        base_tension_n: [0.0; 2],
        contacts: Contacts { friction_n: [[0.0; DISKS]; 2], travel_m: [[0.0; DISKS]; 2] },
        change: Point::ZERO,
        change_n: [0.0; 2],
        is_uncertain: [[false; DISKS]; 2],
    };
    /// Maximum ratio of an extrapolated change to the last one, and the least change of a tension that has a direction, N.
    const FARTHEST: f64 = 2.0;
    const LEAST_SQUARE_N2: f64 = 1e-18;

    /// Returns the predicted end of the next step if it continues like the last one, as a start of the search. If the tensions reverse, it is the
    /// point itself.
    fn ahead(&self, base_tension_n: [f64; 2]) -> Point<DISKS> {
        let ([first_n, second_n], [from_first_n, from_second_n]) = (base_tension_n, self.base_tension_n);
        let [first_change_n, second_change_n] = self.change_n;
        let along_n2 = (first_n - from_first_n) * first_change_n + (second_n - from_second_n) * second_change_n;
        let square_n2 = first_change_n * first_change_n + second_change_n * second_change_n;
        if square_n2 < Self::LEAST_SQUARE_N2 || along_n2 <= 0.0 {
            return self.point;
        }
        moved(&self.point, &self.change, (along_n2 / square_n2).min(Self::FARTHEST))
    }
}

impl<const DISKS: usize> State<DISKS> {
    /// Returns the straight state without tension and with relaxed holes.
    fn relaxed(disk_count: usize, pitch_m: &[f64; MAX_DISKS]) -> Self {
        Self { shape: Shape::straight(disk_count, pitch_m), history: None }
    }
}

impl<const DISKS: usize> StaticModel<DISKS> {
    /// Creates a straight model without tension and with relaxed holes.
    ///
    /// # Errors
    /// Returns a [`ManipulatorError`] if there are more than `DISKS` disks.
    pub fn new(params: &ManipulatorParams) -> Result<Self, ManipulatorError> {
        let count = params.disk_count;
        if count > DISKS {
            return Err(count_error("disk_count", count, 1, DISKS));
        }
        Ok(Self { params: *params, newton: Newton::new(), state: State::relaxed(count, &params.pitch_m) })
    }

    /// Returns the parameters.
    #[must_use]
    pub fn params(&self) -> &ManipulatorParams {
        &self.params
    }

    /// Returns the last valid shape; straight before the first.
    #[must_use]
    pub fn shape(&self) -> &Shape<DISKS> {
        &self.state.shape
    }

    /// Resets the holes' history and the last shape.
    pub fn reset(&mut self) {
        self.state = State::relaxed(self.params.disk_count, &self.params.pitch_m);
    }

    /// Returns a copy of the full state: the shape and the memory of the holes.
    #[must_use]
    pub fn snapshot(&self) -> StaticSnapshot<DISKS> {
        StaticSnapshot(self.state)
    }

    /// Restores the state of a snapshot of the same manipulator; the following solutions have the same bits as after the snapshot.
    ///
    /// # Errors
    /// Returns a [`StateMismatch`] if the manipulator of the snapshot has another number of disks; nothing is changed then.
    pub fn restore(&mut self, snapshot: &StaticSnapshot<DISKS>) -> Result<(), StateMismatch> {
        let (expected, found) = (self.params.disk_count, snapshot.0.shape.count);
        if expected != found {
            return Err(StateMismatch { expected, found });
        }
        self.state = snapshot.0;
        Ok(())
    }

    /// Computes the shape for the base tensions, N, of the first and the second tendon.
    ///
    /// Tension 0 is a slack tendon. With [`Friction::Measured`] the base tensions only determine the friction at hole 1. With [`Friction::History`]
    /// this is one step of the run.
    pub fn solve(&mut self, base_tension_n: [f64; 2], friction: Friction<'_>) -> ShapeStatus {
        let is_tension = |tension_n: &f64| (0.0..1e9).contains(tension_n);
        if !base_tension_n.iter().all(is_tension) {
            return ShapeStatus::NOT_FINITE;
        }
        let bend_rad = self.state.shape.bend_rad;
        let found = match friction {
            Friction::None => {
                let tension_n = base_tension_n.map(|tension_n| [tension_n; DISKS]);
                self.statics(&bend_rad, base_tension_n, tension_n, &Law::Given)
            }
            Friction::Coulomb(direction) => {
                let tension_n = base_tension_n.map(|tension_n| [tension_n; DISKS]);
                self.statics(&bend_rad, base_tension_n, tension_n, &Law::Sliding(direction))
            }
            Friction::Measured(given_n) => {
                let mut tension_n = [[0.0; DISKS]; 2];
                for (tension_n, given_n) in tension_n.iter_mut().zip(given_n) {
                    let is_right = given_n.is_empty() || given_n.len() == self.params.disk_count;
                    // Noise may make the tension of a slack segment slightly negative.
                    if !is_right || !given_n.iter().all(|tension_n| tension_n.abs() < 1e9) {
                        return ShapeStatus::NOT_FINITE;
                    }
                    for (tension_n, given_n) in tension_n.iter_mut().zip(given_n) {
                        *tension_n = *given_n;
                    }
                }
                self.statics(&bend_rad, base_tension_n, tension_n, &Law::Given)
            }
            Friction::History => self.past_or_relaxed().and_then(|past| {
                let start = past.ahead(base_tension_n);
                self.advance(&past, &start, base_tension_n)
            }),
        };
        let Some(mut point) = found else { return ShapeStatus::NOT_CONVERGED };
        for tension_n in &mut point.tension_n {
            for beyond in tension_n.iter_mut().skip(self.params.disk_count) {
                *beyond = 0.0;
            }
        }
        if !self.is_stable(&point, base_tension_n) {
            return ShapeStatus::UNSTABLE;
        }
        if let Friction::History = friction {
            self.remember(&point, base_tension_n);
            return self.show(&point, base_tension_n) | self.forgotten();
        }
        self.show(&point, base_tension_n)
    }

    /// Begins the history with what the holes hold under known tensions, N, at the base and in the segments of both tendons, as
    /// [`Friction::Measured`] takes them, instead of the relaxed tendon. A hole that cannot hold its friction slips in the next step.
    ///
    /// Until every hole has slid once, and has forgotten this beginning, shapes by [`Friction::History`] have the flag
    /// [`MEMORY_UNCERTAIN`](ShapeStatus::MEMORY_UNCERTAIN). Without a shape the history is unchanged.
    pub fn begin_history(&mut self, base_tension_n: [f64; 2], tension_n: [&[f64]; 2]) -> ShapeStatus {
        let status = self.solve(base_tension_n, Friction::Measured(tension_n));
        if !status.has_shape() {
            return status;
        }
        let Shape { bend_rad, tension_n, .. } = self.state.shape;
        let past = self.past(&Point { bend_rad, tension_n }, base_tension_n);
        self.state.history = Some(Past { is_uncertain: [[true; DISKS]; 2], ..past });
        status | self.forgotten()
    }

    /// Notes which holes have slid. Returns the flag if some hole has not since the beginning of the history.
    fn forgotten(&mut self) -> ShapeStatus {
        let Shape { count, friction_n, bound_n, .. } = &self.state.shape;
        let Some(past) = &mut self.state.history else { return ShapeStatus::OK };
        let mut status = ShapeStatus::OK;
        for (is_uncertain, (friction_n, bound_n)) in past.is_uncertain.iter_mut().zip(friction_n.iter().zip(bound_n)) {
            for (is_uncertain, (friction_n, bound_n)) in
                is_uncertain.iter_mut().zip(friction_n.iter().zip(bound_n)).take(*count)
            {
                *is_uncertain &= friction_n.abs() < SLID_RATIO * bound_n;
                if *is_uncertain {
                    status = ShapeStatus::MEMORY_UNCERTAIN;
                }
            }
        }
        status
    }

    pub(super) fn is_stable(&mut self, point: &Point<DISKS>, base_tension_n: [f64; 2]) -> bool {
        self.newton.is_stable(&self.params, point, &Target { base_tension_n, load_share: 1.0 })
    }

    /// Whether disks would touch.
    pub(super) fn disks_touch(&self, point: &Point<DISKS>) -> bool {
        chords(&self.params, &point.bend_rad).iter().any(|chords| {
            let mut segments = chords.iter().take(self.params.disk_count);
            segments.any(|chord| chord.length_m <= self.params.disk_thickness_m)
        })
    }

    /// Returns the change of a point in equilibrium with a change of the base tensions, N.
    pub(super) fn change_with(
        &mut self,
        point: &Point<DISKS>,
        target: &Target,
        law: &Law<'_, DISKS>,
        change_n: [f64; 2],
    ) -> Point<DISKS> {
        self.newton.change_with(&self.params, point, target, law, change_n)
    }

    /// Returns the end of the last history step, or the relaxed tendon before the first.
    pub(super) fn past_or_relaxed(&mut self) -> Option<Past<DISKS>> {
        match self.state.history {
            Some(past) => Some(past),
            None => self.relaxed(),
        }
    }

    /// Returns the base tensions of the last history step, or of the last shape if there is none, N.
    pub(super) fn last_base_tension_n(&self) -> [f64; 2] {
        self.state.history.as_ref().map_or(self.state.shape.base_tension_n, |past| past.base_tension_n)
    }

    /// Returns an equilibrium without memory: from these bends or, if that fails, in load steps from zero.
    pub(super) fn statics(
        &mut self,
        bend_rad: &[f64; DISKS],
        base_tension_n: [f64; 2],
        tension_n: [[f64; DISKS]; 2],
        law: &Law<'_, DISKS>,
    ) -> Option<Point<DISKS>> {
        let start = Point { bend_rad: *bend_rad, tension_n };
        let target = Target { base_tension_n, load_share: 1.0 };
        if let Some(point) = self.newton.solve(&self.params, &start, &target, law) {
            return Some(point);
        }
        let mut point = Point::ZERO;
        for step in 1..=LOAD_STEPS {
            let share = f64::from(step) / f64::from(LOAD_STEPS);
            let target =
                Target { base_tension_n: base_tension_n.map(|tension_n| share * tension_n), load_share: share };
            point.tension_n = tension_n.map(|tendon| tendon.map(|tension_n| share * tension_n));
            point = self.newton.solve(&self.params, &point, &target, law)?;
        }
        Some(point)
    }

    /// Computes one step of the history from its last end: as a whole, searched from `start`, or in parts if there is no solution. The caller
    /// advances the memory.
    pub(super) fn advance(
        &mut self,
        past: &Past<DISKS>,
        start: &Point<DISKS>,
        base_tension_n: [f64; 2],
    ) -> Option<Point<DISKS>> {
        let (mut past, mut start) = (*past, *start);
        let [from_first_n, from_second_n] = past.base_tension_n;
        let [to_first_n, to_second_n] = base_tension_n;
        let (mut done, mut piece) = (0.0_f64, 1.0_f64);
        let is_ahead = start != past.point;
        for part in 0..MOST_PARTS {
            let share = (done + piece).min(1.0);
            let between = |from_n: f64, to_n: f64| if share < 1.0 { from_n + share * (to_n - from_n) } else { to_n };
            let target = Target {
                base_tension_n: [between(from_first_n, to_first_n), between(from_second_n, to_second_n)],
                load_share: 1.0,
            };
            let solved = self.newton.solve(&self.params, &start, &target, &Law::Presliding(&past.contacts));
            let Some(point) = solved else {
                if part > 0 || !is_ahead {
                    piece *= 0.5;
                }
                start = past.point;
                continue;
            };
            if share >= 1.0 {
                return Some(point);
            }
            past = self.past(&point, target.base_tension_n);
            start = past.point;
            done = share;
        }
        None
    }

    /// Returns the state before the first step: the tendons lie in their holes without tension.
    fn relaxed(&mut self) -> Option<Past<DISKS>> {
        let point = self.statics(&self.state.shape.bend_rad.clone(), [0.0; 2], [[0.0; DISKS]; 2], &Law::Given)?;
        Some(self.past(&point, [0.0; 2]))
    }

    /// Returns the history state of a manipulator whose holes are in equilibrium: their friction is the difference of the tensions.
    fn past(&self, point: &Point<DISKS>, base_tension_n: [f64; 2]) -> Past<DISKS> {
        let contacts =
            Contacts { friction_n: frictions(point, base_tension_n), travel_m: travels_m(&self.params, point) };
        Past { point: *point, base_tension_n, contacts, ..Past::ZERO }
    }

    fn remember(&mut self, point: &Point<DISKS>, base_tension_n: [f64; 2]) {
        let mut past = self.past(point, base_tension_n);
        if let Some(before) = &self.state.history {
            past.change = moved(point, &before.point, -1.0);
            past.is_uncertain = before.is_uncertain;
            for ((change_n, now_n), before_n) in past.change_n.iter_mut().zip(base_tension_n).zip(before.base_tension_n)
            {
                *change_n = now_n - before_n;
            }
        }
        self.state.history = Some(past);
    }

    /// Stores a point as the shape and returns its flags.
    fn show(&mut self, point: &Point<DISKS>, base_tension_n: [f64; 2]) -> ShapeStatus {
        let count = self.params.disk_count;
        let mut bound_n = [[0.0; DISKS]; 2];
        let mut status = ShapeStatus::OK;
        if self.disks_touch(point) {
            status = status | ShapeStatus::DISKS_TOUCH;
        }
        let parts = Tendon::BOTH.into_iter().zip(&mut bound_n).zip(base_tension_n);
        for ((tendon, bound_n), base_tension_n) in parts {
            let params = tendon.of(&self.params.tendons);
            let holes = params.holes().zip(passages(point, tendon, base_tension_n));
            for (bound_n, (hole, passage)) in bound_n.iter_mut().zip(holes).take(count) {
                *bound_n = hole.bound_n(&passage);
                if passage.base_side_n.max(passage.tip_side_n) > params.capacity_n {
                    status = status | ShapeStatus::OVER_CAPACITY;
                }
            }
        }
        self.state.shape = Shape {
            count,
            bend_rad: point.bend_rad,
            position_m: positions(&self.params, &point.bend_rad),
            base_tension_n,
            tension_n: point.tension_n,
            friction_n: frictions(point, base_tension_n),
            bound_n,
        };
        status
    }
}

/// Returns `T_{i−1} − T_i`.
pub(super) fn frictions<const DISKS: usize>(point: &Point<DISKS>, base_tension_n: [f64; 2]) -> [[f64; DISKS]; 2] {
    let mut friction_n = point.tension_n;
    for (friction_n, mut base_side_n) in friction_n.iter_mut().zip(base_tension_n) {
        for value in friction_n {
            let tip_side_n = *value;
            *value = base_side_n - tip_side_n;
            base_side_n = tip_side_n;
        }
    }
    friction_n
}

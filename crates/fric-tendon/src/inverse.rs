//! The inverse model: the base tensions that bring the manipulator to a wanted bend, or its tip to a wanted position.
//!
//! One number drives the manipulator: the tension of the first tendon above its least tension or, if negative, of the second above its own
//! ([`Drive`]). The bend grows with it, so Newton's method within a bracket finds the goal. Each trial is a solution of the model from the holes'
//! memory, with the slope from the trial's own equations. After a reversal the slope is small until the holes have reversed one by one from the base.
//! There Newton's method first steps too far and returns from the other side; a step out of the bracket is replaced by its middle.

use core::fmt;
use core::ops::BitOr;

use fric_core::robot::check;
use nalgebra::Vector2;

use super::friction::{Direction, Friction};
use super::model::{Past, StaticModel, frictions};
use super::params::{ManipulatorError, ManipulatorParams, Tendon};
use super::shape::{turned, write_flags};
use super::solver::arc::Arc;
use super::solver::deflection::Deflection;
use super::solver::load::turned_further;
use super::solver::newton::{Law, Point, Target, moved};

/// Maximum number of trials for one goal.
const MOST_TRIALS: u32 = 32;
/// Tolerance of a goal: rad, or relative to the length for the tip. It is a millionth of the resolution of a camera.
const REACHED: f64 = 1e-9;
/// Distance by which the tip may pass its goal and still have reached it, relative to the length.
const TIP_REACH_RATIO: f64 = 0.01;
/// Friction below this fraction of the base tension has no direction.
const FELT_RATIO: f64 = 1e-6;

/// The goal of the manipulator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// Bend of the whole manipulator, rad, positive towards the first tendon: the direction of its last disk.
    BendRad(f64),
    /// Centre of the last disk, base frame, m. Pulling one tendon moves it along a curve; the nearest point is where the goal lies perpendicular to
    /// the direction in which the tip continues to slide. The search starts at the present position.
    TipM([f64; 2]),
}

/// Options of the drives at the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveOptions {
    /// Tension that each tendon keeps while the other is pulled, N, ≥ 0.
    pub least_tension_n: [f64; 2],
    /// Greatest tension of each tendon, N, from the least tension up to the tendon's capacity. If it equals the least tension, that tendon is not
    /// pulled.
    pub greatest_tension_n: [f64; 2],
    /// A goal nearer than this, rad (for the tip: relative to the length), keeps the tensions. Without it, noise on the goal would move the tensions
    /// back and forth across the friction of all holes. 0…1.
    pub hold_rad: f64,
}

impl DriveOptions {
    /// Returns a drive with the first tendon alone, from slack to its capacity; every goal is followed.
    #[must_use]
    pub fn first_tendon(params: &ManipulatorParams) -> Self {
        Self { least_tension_n: [0.0; 2], greatest_tension_n: [params.capacity_n(Tendon::Agonist), 0.0], hold_rad: 0.0 }
    }
}

/// The checked [`DriveOptions`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    least_n: [f64; 2],
    /// Range of each tendon above its least tension, N.
    span_n: [f64; 2],
    hold_rad: f64,
}

impl Drive {
    /// Checks the options of the drives.
    ///
    /// # Errors
    /// Returns a [`ManipulatorError`] with the first number that is not finite or out of range.
    pub fn new(params: &ManipulatorParams, options: &DriveOptions) -> Result<Self, ManipulatorError> {
        let checked = |tendon: Option<Tendon>, key: &'static str, value: f64, min: f64, max: f64| {
            check(key, value, min, max).map_err(|error| ManipulatorError {
                tendon,
                key,
                place: None,
                problem: error.problem,
            })
        };
        let (mut least_n, mut span_n) = (options.least_tension_n, options.greatest_tension_n);
        for (tendon, (least_n, span_n)) in Tendon::BOTH.into_iter().zip(least_n.iter_mut().zip(&mut span_n)) {
            let (owner, capacity_n) = (Some(tendon), params.capacity_n(tendon));
            checked(owner, "least_tension_n", *least_n, 0.0, capacity_n)?;
            *span_n = checked(owner, "greatest_tension_n", *span_n, *least_n, capacity_n)? - *least_n;
        }
        Ok(Self { least_n, span_n, hold_rad: checked(None, "hold_rad", options.hold_rad, 0.0, 1.0)? })
    }

    /// Returns the base tensions for the drive number, N.
    fn base_tension_n(&self, drive_n: f64) -> [f64; 2] {
        let [first_n, second_n] = self.least_n;
        [first_n + drive_n.max(0.0), second_n + (-drive_n).max(0.0)]
    }

    /// Returns the drive number nearest to these tensions.
    fn nearest(&self, [first_n, second_n]: [f64; 2]) -> f64 {
        let [first_least_n, second_least_n] = self.least_n;
        let (least_n, greatest_n) = self.ends();
        ((first_n - first_least_n) - (second_n - second_least_n)).min(greatest_n).max(least_n)
    }

    fn ends(&self) -> (f64, f64) {
        let [first_n, second_n] = self.span_n;
        (-second_n, first_n)
    }
}

/// Flags of one command; [`GoalStatus::OK`] if the goal is reached in the previous direction of motion.
///
/// | flag | cause | what the command is |
/// |---|---|---|
/// | `NOT_USABLE` | a goal that is not finite, or [`Friction::Measured`], which knows nothing of other tensions | the tensions as they were |
/// | `NOT_CONVERGED` | no tension found within the trials | the tensions as they were |
/// | `OUT_OF_REACH` | the tensions end before the goal, the disks would touch, there is no stable shape, or the tip passes the goal by more than 1 % of the length | the nearest |
/// | `HELD` | the goal is nearer than `hold_rad` | the tensions as they were |
/// | `REVERSAL` | the tendon turns round: the friction at the base plate was against this motion before | reaches the goal |
/// | `DEAD_BAND` | some hole still has the friction of the motion before: much tension moves little | reaches the goal |
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[must_use]
pub struct GoalStatus(u32);

impl GoalStatus {
    /// No flag.
    pub const OK: Self = Self(0);
    /// The input is not usable.
    pub const NOT_USABLE: Self = Self(1);
    /// No tension was found.
    pub const NOT_CONVERGED: Self = Self(1 << 1);
    /// The goal cannot be reached.
    pub const OUT_OF_REACH: Self = Self(1 << 2);
    /// The manipulator is already at the goal.
    pub const HELD: Self = Self(1 << 3);
    /// The tendon reverses.
    pub const REVERSAL: Self = Self(1 << 4);
    /// Some holes have not reversed yet.
    pub const DEAD_BAND: Self = Self(1 << 5);

    /// Every flag with its name, lowest bit first.
    pub const NAMES: [(&'static str, Self); 6] = [
        ("NOT_USABLE", Self::NOT_USABLE),
        ("NOT_CONVERGED", Self::NOT_CONVERGED),
        ("OUT_OF_REACH", Self::OUT_OF_REACH),
        ("HELD", Self::HELD),
        ("REVERSAL", Self::REVERSAL),
        ("DEAD_BAND", Self::DEAD_BAND),
    ];

    const MISSED: Self = Self(Self::NOT_USABLE.0 | Self::NOT_CONVERGED.0 | Self::OUT_OF_REACH.0);

    /// Returns the flags as a number.
    #[must_use]
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// Whether no flag is set.
    #[must_use]
    pub const fn is_ok(self) -> bool {
        self.0 == 0
    }

    /// Whether the command reaches the goal, whatever other flags are set.
    #[must_use]
    pub const fn is_reached(self) -> bool {
        self.0 & Self::MISSED.0 == 0
    }

    /// Whether all flags of `other` are set.
    #[must_use]
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Returns this flag if a condition holds.
    const fn when(self, is_so: bool) -> Self {
        if is_so { self } else { Self::OK }
    }
}

impl BitOr for GoalStatus {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

/// Writes `ok`, or the names of the flags separated by `|`.
impl fmt::Display for GoalStatus {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_flags(formatter, Self::NAMES.iter().filter(|(_, flag)| self.contains(*flag)).map(|(name, _)| *name))
    }
}

/// The tensions to set at the base, and the model's prediction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// Tensions of the first and the second tendon, N.
    pub base_tension_n: [f64; 2],
    /// Predicted bend of the whole manipulator, rad.
    pub bend_rad: f64,
    /// Predicted centre of the last disk, base frame, m.
    pub tip_m: [f64; 2],
    /// Status flags.
    pub status: GoalStatus,
}

/// The behaviour of the holes during the trials.
enum Holes<const DISKS: usize> {
    None,
    Sliding(Direction),
    Remembering(Past<DISKS>),
}

/// A shape on the way to the goal.
#[derive(Clone, Copy)]
struct Trial<const DISKS: usize> {
    drive_n: f64,
    point: Point<DISKS>,
    /// Distance beyond the goal, rad, or relative to the length.
    beyond: f64,
}

impl<const DISKS: usize> StaticModel<DISKS> {
    /// Returns the base tensions that bring the manipulator to a goal, from the end of the last step of the history.
    ///
    /// With [`Friction::History`] the holes' memory is used but not changed: the next [`solve`](Self::solve), with the tensions that were then set or
    /// measured, advances it. [`Friction::None`] and [`Friction::Coulomb`] have no memory; starting from the last shape only shortens the search. The
    /// stored shape stays the last one solved.
    ///
    /// ```
    /// use fric_tendon::{Drive, DriveOptions, Friction, Goal, ManipulatorOptions, ManipulatorParams, StaticModel};
    /// # fn main() -> Result<(), fric_tendon::ManipulatorError> {
    /// let params = ManipulatorParams::new(&ManipulatorOptions::published())?;
    /// let drive = Drive::new(&params, &DriveOptions::first_tendon(&params))?;
    /// let mut model = StaticModel::<8>::new(&params)?;
    /// for bend_rad in [0.2, 0.6, 0.5] {
    ///     let command = model.tension_for(Goal::BendRad(bend_rad), Friction::History, &drive);
    ///     assert!(command.status.is_reached());
    ///     assert!(model.solve(command.base_tension_n, Friction::History).is_ok());
    ///     assert!((model.shape().bend_rad() - bend_rad).abs() < 1e-8);
    /// }
    /// # Ok(())
    /// # }
    /// ```
    pub fn tension_for(&mut self, goal: Goal, friction: Friction<'_>, drive: &Drive) -> Command {
        let is_usable = match goal {
            Goal::BendRad(bend_rad) => bend_rad.is_finite(),
            Goal::TipM(tip_m) => tip_m.iter().all(|value| value.abs() < 1e9),
        };
        let holes = match friction {
            _ if !is_usable => None,
            Friction::None => Some(Holes::None),
            Friction::Coulomb(direction) => Some(Holes::Sliding(direction)),
            Friction::Measured(_) => None,
            Friction::History => match self.past_or_relaxed() {
                Some(past) => Some(Holes::Remembering(past)),
                None => return self.unchanged(GoalStatus::NOT_CONVERGED),
            },
        };
        let Some(holes) = holes else { return self.unchanged(GoalStatus::NOT_USABLE) };
        let (now_n, start) = if let Holes::Remembering(past) = &holes {
            (past.base_tension_n, past.point)
        } else {
            let shape = self.shape();
            (shape.base_tension_n, Point { bend_rad: shape.bend_rad, tension_n: shape.tension_n })
        };
        let begin_n = drive.nearest(now_n);
        let is_same = drive.base_tension_n(begin_n).map(f64::to_bits) == now_n.map(f64::to_bits);
        let is_there = is_same && matches!(holes, Holes::Remembering(_));
        let begin = if is_there {
            Some(self.measured(goal, &holes, drive, begin_n, start))
        } else {
            self.trial(goal, &holes, drive, begin_n, &start)
        };
        let Some(begin) = begin else { return self.unchanged(GoalStatus::NOT_CONVERGED) };
        if begin.beyond.abs() <= drive.hold_rad && drive.hold_rad > 0.0 {
            return self.command(goal, &holes, drive, &begin, GoalStatus::HELD);
        }
        let (found, status) = self.search(goal, &holes, drive, begin);
        if status.contains(GoalStatus::NOT_CONVERGED) {
            return self.unchanged(status);
        }
        self.command(goal, &holes, drive, &found, status)
    }

    /// Runs Newton's method on the drive, within a bracket.
    fn search(
        &mut self,
        goal: Goal,
        holes: &Holes<DISKS>,
        drive: &Drive,
        begin: Trial<DISKS>,
    ) -> (Trial<DISKS>, GoalStatus) {
        let is_up = begin.beyond < 0.0;
        let (least_n, greatest_n) = drive.ends();
        // The last trial before the goal, and the first drive that is known to be beyond it, or beyond which there is no shape.
        let (mut before, mut far_n) = (begin, if is_up { greatest_n } else { least_n });
        let (mut latest, mut has_end) = (begin, true);
        for trials in 0..MOST_TRIALS {
            if latest.beyond.abs() <= REACHED {
                return (latest, GoalStatus::OK);
            }
            if (far_n - before.drive_n).abs() <= 1e-12 * (greatest_n - least_n) {
                let status = GoalStatus::OUT_OF_REACH.when(has_end);
                return (before, status);
            }
            // At the beginning the tendon is assumed to continue sliding, because at rest its equations treat it as stuck.
            let law = if trials == 0 { Some(Law::Sliding(Direction::of_change(-begin.beyond))) } else { None };
            let (slope, ahead) = self.slope(goal, holes, drive, &latest, law);
            let newton_n = latest.drive_n - latest.beyond / slope;
            let middle_n = 0.5 * (before.drive_n + far_n);
            let is_within =
                (newton_n > before.drive_n && newton_n < far_n) || (newton_n < before.drive_n && newton_n > far_n);
            let next_n = match (slope > 0.0 && is_within, has_end) {
                (true, _) => newton_n,
                // Beyond the range of the tensions, its end decides whether the goal is in reach.
                (false, true) if slope > 0.0 && trials > 0 => far_n,
                _ => middle_n,
            };
            let start = moved(&latest.point, &ahead, next_n - latest.drive_n);
            let trial = self
                .trial(goal, holes, drive, next_n, &start)
                .or_else(|| self.trial(goal, holes, drive, next_n, &before.point));
            let Some(trial) = trial else {
                (far_n, latest) = (next_n, before);
                continue;
            };
            if (trial.beyond < 0.0) == is_up {
                before = trial;
            } else {
                (far_n, has_end) = (next_n, false);
            }
            latest = trial;
        }
        (before, GoalStatus::NOT_CONVERGED)
    }

    /// Returns the shape under a drive; `None` if there is none, or disks touch.
    fn trial(
        &mut self,
        goal: Goal,
        holes: &Holes<DISKS>,
        drive: &Drive,
        drive_n: f64,
        start: &Point<DISKS>,
    ) -> Option<Trial<DISKS>> {
        let base_tension_n = drive.base_tension_n(drive_n);
        let all_n = base_tension_n.map(|tension_n| [tension_n; DISKS]);
        let point = match holes {
            Holes::None => self.statics(&start.bend_rad, base_tension_n, all_n, &Law::Given),
            Holes::Sliding(direction) => {
                self.statics(&start.bend_rad, base_tension_n, all_n, &Law::Sliding(*direction))
            }
            Holes::Remembering(past) => self.advance(past, start, base_tension_n),
        }?;
        let is_right = self.is_stable(&point, base_tension_n) && !self.disks_touch(&point);
        is_right.then(|| self.measured(goal, holes, drive, drive_n, point))
    }

    /// Returns how far a shape is beyond the goal.
    fn measured(
        &mut self,
        goal: Goal,
        holes: &Holes<DISKS>,
        drive: &Drive,
        drive_n: f64,
        point: Point<DISKS>,
    ) -> Trial<DISKS> {
        let mut trial = Trial { drive_n, point, beyond: f64::NAN };
        trial.beyond = match goal {
            Goal::BendRad(bend_rad) => point.bend_rad.iter().sum::<f64>() - bend_rad,
            Goal::TipM(tip_m) => {
                // The direction in which it continues to slide, which is smooth where the tendon reverses.
                let (_, ahead) = self.slope(goal, holes, drive, &trial, Some(Law::Sliding(Direction::Pulling)));
                let tip = Tip::new(self.params(), &point, &ahead);
                tip.direction().dot(&(tip.place_m - Vector2::from(tip_m))) / self.params().length_m()
            }
        };
        trial
    }

    /// Returns the rate at which a shape passes the goal with the drive, 1/N, and its change.
    fn slope(
        &mut self,
        goal: Goal,
        holes: &Holes<DISKS>,
        drive: &Drive,
        trial: &Trial<DISKS>,
        law: Option<Law<'_, DISKS>>,
    ) -> (f64, Point<DISKS>) {
        let law = match (law, holes) {
            // Accurate enough for the slope of a search.
            (_, Holes::None) => Law::Sliding(Direction::Pulling),
            (_, Holes::Sliding(direction)) => Law::Sliding(*direction),
            (Some(law), Holes::Remembering(_)) => law,
            (None, Holes::Remembering(past)) => Law::Presliding(&past.contacts),
        };
        let [first, second] = if trial.drive_n > 0.0 || drive.span_n[1] == 0.0 { [1.0, 0.0] } else { [0.0, -1.0] };
        let target = Target { base_tension_n: drive.base_tension_n(trial.drive_n), load_share: 1.0 };
        let ahead = self.change_with(&trial.point, &target, &law, [first, second]);
        let slope = match goal {
            Goal::BendRad(_) => ahead.bend_rad.iter().sum(),
            Goal::TipM(_) => Tip::new(self.params(), &trial.point, &ahead).speed_m.norm() / self.params().length_m(),
        };
        (slope, ahead)
    }

    fn command(
        &self,
        goal: Goal,
        holes: &Holes<DISKS>,
        drive: &Drive,
        found: &Trial<DISKS>,
        status: GoalStatus,
    ) -> Command {
        let base_tension_n = drive.base_tension_n(found.drive_n);
        let tip = Tip::new(self.params(), &found.point, &Point::ZERO);
        let mut status = status;
        if let Goal::TipM(tip_m) = goal {
            let miss_m = (tip.place_m - Vector2::from(tip_m)).norm();
            status = status | GoalStatus::OUT_OF_REACH.when(miss_m > TIP_REACH_RATIO * self.params().length_m());
        }
        if let Holes::Remembering(past) = holes {
            let change_n = found.drive_n - drive.nearest(past.base_tension_n);
            let after_n = frictions(&found.point, base_tension_n);
            for (tendon, (before_n, after_n)) in
                Tendon::BOTH.into_iter().zip(past.contacts.friction_n.iter().zip(&after_n))
            {
                let way = if tendon == Tendon::Agonist { change_n } else { -change_n };
                let least_n = FELT_RATIO * tendon.of(&base_tension_n).max(*tendon.of(&past.base_tension_n));
                let is_against = |friction_n: &f64| friction_n * way < 0.0 && friction_n.abs() > least_n;
                let has_held = after_n.iter().take(self.params().disk_count()).any(is_against);
                status = status
                    | GoalStatus::REVERSAL.when(before_n.first().is_some_and(is_against))
                    | GoalStatus::DEAD_BAND.when(has_held);
            }
        }
        Command { base_tension_n, bend_rad: found.point.bend_rad.iter().sum(), tip_m: tip.place_m.into(), status }
    }

    /// Returns the present tensions.
    fn unchanged(&self, status: GoalStatus) -> Command {
        let shape = self.shape();
        let tip_m = shape.disk_position_m().last().copied().unwrap_or([0.0; 2]);
        Command { base_tension_n: self.last_base_tension_n(), bend_rad: shape.bend_rad(), tip_m, status }
    }
}

/// The tip and its motion.
struct Tip {
    place_m: Vector2<f64>,
    /// Velocity with the change of the bends.
    speed_m: Vector2<f64>,
    /// Lateral direction of the last disk, used if nothing changes.
    across: Vector2<f64>,
}

impl Tip {
    /// Computes the tip. Bending a segment rotates everything beyond it about the centroid of its arc.
    fn new<const DISKS: usize>(params: &ManipulatorParams, point: &Point<DISKS>, change: &Point<DISKS>) -> Self {
        let has_load = params.has_load();
        let (mut place_m, mut turn) = (Vector2::zeros(), (0.0, 1.0));
        // The shift of the tip by the deflections of the segments, and its change.
        let (mut shift_m, mut shift_change_m) = (Vector2::zeros(), Vector2::zeros());
        // Σ change and Σ change·centroid: the tip moves by Σ change·(tip − centroid), rotated by a quarter turn.
        let (mut turning_rad, mut moment) = (0.0, Vector2::zeros());
        let backbone = params.pitch_m().iter().zip(&params.segment_stiffness_n_m2).zip(&params.middle_force_n);
        for (((pitch_m, stiffness_n_m2), force_n), (bend_rad, change_rad)) in
            backbone.zip(point.bend_rad.iter().zip(&change.bend_rad))
        {
            let arc = Arc::new(*pitch_m, *bend_rad);
            let centroid_m: Vector2<f64> = place_m + turned(turn, arc.centroid_m);
            let chord_m = turned(turn, arc.end_m);
            if has_load {
                let deflection = Deflection::new(chord_m, (*pitch_m, *stiffness_n_m2), *bend_rad, *force_n);
                shift_m += deflection.shift_m();
                shift_change_m += deflection.shift_change_m(turning_rad, *change_rad);
            }
            turning_rad += change_rad;
            moment += *change_rad * centroid_m;
            place_m += chord_m;
            turn = turned_further(turn, arc.turn);
        }
        let lever = turning_rad * place_m - moment;
        let speed_m = Vector2::new(-lever.y, lever.x);
        let (sin, cos) = turn;
        let across = Vector2::new(-sin, cos);
        if has_load {
            Self { place_m: place_m + shift_m, speed_m: speed_m + shift_change_m, across }
        } else {
            Self { place_m, speed_m, across }
        }
    }

    /// Returns the direction in which the tip moves while the bend grows.
    fn direction(&self) -> Vector2<f64> {
        let speed_m = self.speed_m.norm();
        if speed_m > 0.0 { self.speed_m / speed_m } else { self.across }
    }
}

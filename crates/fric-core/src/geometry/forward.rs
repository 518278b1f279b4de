//! Forward kinematics: the pose of the platform from the lengths of its cables.
//!
//! It serves logs without a measured pose, sample by sample, outside the control cycle. [`pose_near`] starts from an approximately known pose,
//! [`pose_anywhere`] needs no start, and [`PoseFollower`] chooses between them over the samples of a log; its state is a pose and two counts. No
//! allocation. Non-finite lengths count as not given; the output is always finite.
//!
//! The pose minimises `Σ r_i²`, `r_i = l_i(pose) − l_i` (m). `l_i(pose)` is the length of cable i from `base_m`, where it enters its last pulley, to
//! its attachment, including the part on the swivelling pulley ([`CableParams::length_m`]); `l_i` is the given length. The given lengths must be
//! absolute in this sense, not relative to an arbitrary zero of the winch; a constant error δ moves the pose by as much.
//!
//! | symbol | identifier | unit | range |
//! |---|---|---|---|
//! | `l_i` | `length_m` of [`CableInput`] | m | > 0; ten kilometres at most |
//! | `r` | `residual_rms_m`, over the cables used | m | 0…5 % of the lengths |
//! | `∂l_i/∂pose` | −column i of the structure matrix, `−[u_i; (R b_i) × u_i]` (\[P\] 2) | | |
//!
//! The search is Levenberg–Marquardt. Near its end it is Newton's method with the second derivatives of a cable from a fixed point (`E^T (1 − u u^T)
//! E/free + (u·R b) 1 − sym(u (R b)^T)` with `E = [1, −[R b]×]`), so that it also converges if wrong lengths leave a large residual. The unknowns are
//! a translation and a rotation in base axes; the rotation multiplies the quaternion from the left. Rotations count in metres of the mean lever arm,
//! so that both have one scale. With six cables a wrong length gives a wrong pose without a residual; each further cable checks the others.

use nalgebra::{Matrix3, Matrix6, Quaternion, UnitQuaternion, Vector3, Vector6};

use crate::compensator::cycle::CableInput;
use crate::platform::{Pose, attachment};
use crate::robot::{CableParams, RobotParams};
use crate::swivel;

/// Minimum number of cables with a geometry and a length, because a pose has six unknowns.
pub const FEWEST_CABLES: usize = 6;

/// Maximum residual relative to the lengths (both rms) for a valid pose; beyond it robot file and lengths are inconsistent. At half this value,
/// lengths that are 10 % wrong on one of eight cables are refused; at double, any lengths have a pose.
const GREATEST_RESIDUAL_RATIO: f64 = 0.05;
/// A pose found without a start is accepted below this residual, which is far above the effect of noise and far below that of another pose.
const AGREEING_RATIO: f64 = 1e-3;
/// Step size at which the search has converged, m. Each step shrinks by a factor of 100 or more, so the pose is more accurate than that.
const ARRIVED_M: f64 = 1e-9;
const MOST_STEPS: usize = 40;
/// Least pivot of the normal matrix relative to the greatest. Below it, noise of the lengths is amplified a thousand times in some direction of the
/// pose.
const LEAST_PIVOT_RATIO: f64 = 1e-6;
/// Damping relative to the mean diagonal: its start value without a start pose, and the value beyond which no step is found.
const FIRST_DAMPING: f64 = 1e-3;
const LEAST_DAMPING: f64 = 1e-9;
const GREATEST_DAMPING: f64 = 1e9;
/// Relative difference of squares that is only rounding.
const ROUNDING: f64 = 1e-12;
/// Greatest rotation in one step, rad: about half a right angle.
const GREATEST_TURN_RAD: f64 = 0.8;
/// Maximum valid cable length.
const GREATEST_LENGTH_M: f64 = 1e4;

/// A pose from lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LengthPose {
    /// The pose.
    pub pose: Pose,
    /// Root mean square error of the used cables' lengths at that pose, m. Only rounding with six cables.
    pub residual_rms_m: f64,
    /// Root mean square of their lengths, m.
    pub length_rms_m: f64,
    /// Number of used cables: those with a geometry and a finite length.
    pub cable_count: usize,
}

impl LengthPose {
    /// Whether the lengths agree with the pose as well as measured ones do: to 0.1 %.
    #[must_use]
    pub fn agrees(&self) -> bool {
        self.residual_rms_m <= AGREEING_RATIO * self.length_rms_m
    }
}

/// The reason why lengths give no pose.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum NoPose {
    /// Fewer than [`FEWEST_CABLES`] cables have a geometry and a length.
    TooFew {
        /// Number of such cables.
        cable_count: usize,
    },
    /// The search did not converge.
    NotConverged,
    /// The lengths do not determine a direction of the pose, for instance if all cables meet in one point of the platform.
    Undetermined,
    /// No pose has lengths near these.
    Apart {
        /// Residual at the best pose, rms, m.
        residual_rms_m: f64,
    },
}

/// Returns the pose of these lengths, starting from `near`, because a platform cannot have moved far since the last sample.
///
/// # Errors
/// Returns a [`NoPose`] with the reason if there is none.
///
/// ```
/// use fric_core::forward::pose_near;
/// use fric_core::robot::{CableOptions, GeometryOptions, MonitorOptions, PlatformOptions, PulleyOptions};
/// use fric_core::{CableInput, CableParams, Pose, RobotParams};
///
/// let eyelet = [PulleyOptions::Fixed { wrap_rad: 1.5, sensor: false }];
/// let corner = |index: u32| {
///     let [x, y, z] = [0, 1, 2].map(|bit| if index >> bit & 1 == 0 { 1.0 } else { -1.0 });
///     let geometry = GeometryOptions { base_m: [x, 0.8 * y, z], platform_m: [0.1 * x, 0.1 * y, -0.1 * z] };
///     CableParams::new(&CableOptions { geometry: Some(geometry), ..CableOptions::new(&eyelet) })
/// };
/// let cables = (0..8).map(corner).collect::<Result<Vec<_>, _>>()?;
/// let robot = RobotParams::new(0.001, &PlatformOptions::default(), MonitorOptions::for_cycle(0.001), &cables)?;
/// let pose = Pose::from_parts([0.1, -0.2, 0.3], [0.1, 0.0, 0.0, 0.995]).ok_or("no pose")?;
/// let lengths = cables.iter().map(|cable| cable.length_m(&pose)).map(|length_m| CableInput {
///     length_m: length_m.unwrap_or(f64::NAN),
///     ..CableInput::default()
/// });
/// let found = pose_near(&robot, &lengths.collect::<Vec<_>>(), &Pose::identity()).map_err(|none| format!("{none:?}"))?;
/// assert!((found.pose.position_m - pose.position_m).norm() < 1e-9 && found.residual_rms_m < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn pose_near(robot: &RobotParams<'_>, inputs: &[CableInput], near: &Pose) -> Result<LengthPose, NoPose> {
    Search::new(robot, inputs)?.run(near, LEAST_DAMPING)
}

/// Returns the pose of these lengths without a start: the first of several starts whose residual is below 0.1 % of the lengths, else the one with the
/// smallest residual.
///
/// Starts are below the middle of the pulleys (along gravity) by 0.3 of the mean length, in the middle, and above it; upright first, then rotated by
/// 40° about the axes. Lengths have several poses, for instance the mirrored one above the pulleys for a platform that hangs below them. The pose of
/// the first successful start is returned.
///
/// # Errors
/// Returns a [`NoPose`] with the reason if there is none.
pub fn pose_anywhere(robot: &RobotParams<'_>, inputs: &[CableInput]) -> Result<LengthPose, NoPose> {
    Search::new(robot, inputs)?.anywhere()
}

/// Finds the poses of consecutive samples.
///
/// Each search starts from the last pose that was found. If that leads to none, or to one with a residual beyond 0.1 % of the lengths (another pose
/// of the same lengths, after a pause), the sample is searched without a start. This takes a hundred times as long; if it does not help either, it is
/// tried again after one sample, then after 3, 7, …, 255.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PoseFollower {
    last: Option<Pose>,
    /// Number of consecutive searches without a start that did not help.
    failure_count: u32,
    /// Samples until the next such search.
    pause: u32,
}

impl PoseFollower {
    const MOST_FAILURES: u32 = 8;

    /// Returns the pose of the next sample.
    ///
    /// # Errors
    /// Returns a [`NoPose`] with the reason if there is none; the next search starts at the last pose.
    pub fn next_pose(&mut self, robot: &RobotParams<'_>, inputs: &[CableInput]) -> Result<LengthPose, NoPose> {
        let search = Search::new(robot, inputs)?;
        let followed = match &self.last {
            Some(last) => search.run(last, LEAST_DAMPING),
            None => Err(NoPose::NotConverged),
        };
        let agrees = |found: &Result<LengthPose, NoPose>| found.is_ok_and(|found| found.agrees());
        let found = if agrees(&followed) {
            (self.failure_count, self.pause) = (0, 0);
            followed
        } else if self.pause > 0 {
            self.pause -= 1;
            followed
        } else {
            let anew = search.anywhere();
            if agrees(&anew) {
                self.failure_count = 0;
            } else {
                self.failure_count = (self.failure_count + 1).min(Self::MOST_FAILURES);
                self.pause = (1 << self.failure_count) - 1;
            }
            match (&followed, &anew) {
                (Ok(followed), Ok(anew)) if followed.residual_rms_m <= anew.residual_rms_m => Ok(*followed),
                (Ok(_), Err(_)) => followed,
                _ => anew,
            }
        };
        if let Ok(found) = &found {
            self.last = Some(found.pose);
        }
        found
    }
}

/// The lengths of one sample.
struct Search<'a> {
    robot: &'a RobotParams<'a>,
    inputs: &'a [CableInput],
    cable_count: usize,
    /// Root mean square of the used cables' lengths, and of their lever arms.
    rms_length_m: f64,
    arm_m: f64,
}

/// The sum of squares at a pose, with half of its first and second derivatives; rotations are scaled by lever arms.
struct Squares {
    sum_m2: f64,
    gradient: Vector6<f64>,
    /// Second derivatives from the first derivatives of the lengths alone.
    normal: Matrix6<f64>,
    /// Contribution of the second derivatives of the lengths times the residuals.
    curvature: Matrix6<f64>,
}

impl<'a> Search<'a> {
    fn new(robot: &'a RobotParams<'a>, inputs: &'a [CableInput]) -> Result<Self, NoPose> {
        let mut search = Self { robot, inputs, cable_count: 0, rms_length_m: 0.0, arm_m: 0.0 };
        let (mut length_squares, mut arm_squares) = (0.0, 0.0);
        for (cable, length_m) in search.used() {
            search.cable_count += 1;
            length_squares += length_m * length_m;
            arm_squares += cable.geometry.as_ref().map_or(0.0, |geometry| geometry.platform_m.norm_squared());
        }
        if search.cable_count < FEWEST_CABLES {
            return Err(NoPose::TooFew { cable_count: search.cable_count });
        }
        if arm_squares <= 0.0 {
            return Err(NoPose::Undetermined);
        }
        search.rms_length_m = libm::sqrt(length_squares / search.count());
        search.arm_m = libm::sqrt(arm_squares / search.count());
        Ok(search)
    }

    /// Returns the used cables with their lengths.
    fn used(&self) -> impl Iterator<Item = (&'a CableParams, f64)> + use<'a> {
        let is_length = |length_m: &f64| length_m.abs() <= GREATEST_LENGTH_M;
        let cables = self.robot.cables.iter().zip(self.inputs);
        cables
            .filter(|(cable, _)| cable.has_geometry())
            .map(|(cable, input)| (cable, input.length_m))
            .filter(move |(_, length_m)| is_length(length_m))
    }

    #[expect(clippy::cast_precision_loss, reason = "a count of cables")]
    fn count(&self) -> f64 {
        self.cable_count as f64
    }

    /// Returns the start poses of a search.
    fn starts(&self) -> impl Iterator<Item = Pose> + use<'a> {
        const HEIGHTS: [f64; 3] = [0.3, 0.0, -0.3];
        /// Sine and cosine of half of 40°.
        const TURN: [f64; 2] = [0.342_020_143_325_668_7, 0.939_692_620_785_908_4];
        let share = 1.0 / self.count();
        let (mut base_m, mut platform_m, mut length_m) = (Vector3::zeros(), Vector3::zeros(), 0.0);
        for (cable, length) in self.used() {
            if let Some(geometry) = &cable.geometry {
                base_m += geometry.base_m * share;
                platform_m += geometry.platform_m * share;
                length_m += length * share;
            }
        }
        let gravity = self.robot.gravity_m_per_s2;
        let size = gravity.norm();
        let down = if size > 0.0 { gravity / size } else { -Vector3::z() };
        let turned = |axis: usize, sign: f64| {
            let mut parts = [0.0, 0.0, 0.0, TURN[1]];
            if let Some(part) = parts.get_mut(axis) {
                *part = sign * TURN[0];
            }
            let [x, y, z, w] = parts;
            UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z))
        };
        let turns = [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0)];
        let orientations = core::iter::once(UnitQuaternion::identity())
            .chain(turns.into_iter().map(move |(axis, sign)| turned(axis, sign)));
        orientations.flat_map(move |orientation| {
            HEIGHTS.into_iter().map(move |height| {
                let middle_m = base_m + down * (height * length_m);
                Pose { position_m: middle_m - orientation * platform_m, orientation }
            })
        })
    }

    /// Returns the best result of all starts; of several that agree with the lengths, the first.
    fn anywhere(&self) -> Result<LengthPose, NoPose> {
        let mut best: Result<LengthPose, NoPose> = Err(NoPose::NotConverged);
        for start in self.starts() {
            let found = self.run(&start, FIRST_DAMPING);
            let is_better = match (&found, &best) {
                (Ok(found), _) if found.agrees() => return Ok(*found),
                (Ok(found), Ok(best)) => found.residual_rms_m < best.residual_rms_m,
                (Ok(_), Err(_))
                | (Err(NoPose::Undetermined), Err(NoPose::NotConverged | NoPose::Apart { .. }))
                | (Err(NoPose::Apart { .. }), Err(NoPose::NotConverged)) => true,
                _ => false,
            };
            if is_better {
                best = found;
            }
        }
        best
    }

    fn run(&self, start: &Pose, first_damping: f64) -> Result<LengthPose, NoPose> {
        let (mut pose, mut damping) = (*start, first_damping);
        let mut squares = self.squares(&pose).ok_or(NoPose::NotConverged)?;
        for _ in 0..MOST_STEPS {
            // Far from the solution only the first derivatives point downhill.
            let is_near = squares.sum_m2 <= self.greatest_sum_m2();
            let mut damped = if is_near { squares.normal + squares.curvature } else { squares.normal };
            let lift = damping * squares.normal.trace() / 6.0;
            for place in 0..6 {
                damped[(place, place)] += lift;
            }
            let step = damped.cholesky().map(|factor| -factor.solve(&squares.gradient));
            let moved = step.as_ref().and_then(|step| self.moved(&pose, step));
            let trial = moved.and_then(|pose| Some((pose, self.squares(&pose)?)));
            let better = trial.filter(|(_, trial)| trial.sum_m2 <= squares.sum_m2 * (1.0 + ROUNDING));
            // Damping makes small steps far from the end.
            let has_arrived = damping <= FIRST_DAMPING && step.is_some_and(|step| step.norm() <= ARRIVED_M);
            let Some((next, of_next)) = better else {
                // A step that consists of rounding may increase the squares.
                if has_arrived {
                    return self.judged(&pose, &squares);
                }
                damping = damping.max(LEAST_DAMPING) * 10.0;
                if damping > GREATEST_DAMPING {
                    break;
                }
                continue;
            };
            (pose, squares) = (next, of_next);
            if has_arrived {
                return self.judged(&pose, &squares);
            }
            damping = (damping * 0.1).max(LEAST_DAMPING);
        }
        Err(NoPose::NotConverged)
    }

    /// Returns the greatest sum of squares for a valid pose, m².
    fn greatest_sum_m2(&self) -> f64 {
        let greatest_m = GREATEST_RESIDUAL_RATIO * self.rms_length_m;
        self.count() * greatest_m * greatest_m
    }

    /// Returns the end of a search, if it is a valid pose.
    fn judged(&self, pose: &Pose, squares: &Squares) -> Result<LengthPose, NoPose> {
        let residual_rms_m = libm::sqrt(squares.sum_m2 / self.count());
        // NaN does not agree either.
        let agrees = squares.sum_m2 <= self.greatest_sum_m2();
        if !agrees || !pose.is_usable() {
            return Err(NoPose::Apart { residual_rms_m });
        }
        let factor = squares.normal.cholesky().ok_or(NoPose::Undetermined)?;
        let pivots = factor.l_dirty().diagonal().map(|root| root * root);
        if pivots.min() < LEAST_PIVOT_RATIO * pivots.max() {
            return Err(NoPose::Undetermined);
        }
        Ok(LengthPose { pose: *pose, residual_rms_m, length_rms_m: self.rms_length_m, cable_count: self.cable_count })
    }

    /// Returns a pose after a step; `None` if it is not a valid pose.
    fn moved(&self, pose: &Pose, step: &Vector6<f64>) -> Option<Pose> {
        let turn = step.fixed_rows::<3>(3) / self.arm_m;
        let size = turn.norm();
        let share = if size > GREATEST_TURN_RAD { GREATEST_TURN_RAD / size } else { 1.0 };
        let half = turn * (0.5 * share);
        let turned = Quaternion::from_parts(1.0, half) * pose.orientation.into_inner();
        let orientation = UnitQuaternion::new_normalize(turned);
        let moved = Pose { position_m: pose.position_m + step.fixed_rows::<3>(0) * share, orientation };
        moved.is_usable().then_some(moved)
    }

    /// Returns the squares at a pose; `None` if a cable cannot leave its last pulley.
    fn squares(&self, pose: &Pose) -> Option<Squares> {
        let rotation = pose.orientation.to_rotation_matrix().into_inner();
        let (normal, curvature) = (Matrix6::zeros(), Matrix6::zeros());
        let mut squares = Squares { sum_m2: 0.0, gradient: Vector6::zeros(), normal, curvature };
        for (cable, length_m) in self.used() {
            let geometry = cable.geometry.as_ref()?;
            let (attachment_m, arm_m) = attachment(pose, &rotation, geometry.platform_m.into());
            let exit = swivel::exit(&geometry.swivel(), attachment_m);
            if !exit.reachable {
                return None;
            }
            let wrapped_m = geometry.radius_m * swivel::wrap_rad(exit.cos_sin_wrap);
            let residual_m = wrapped_m + exit.free_length_m - length_m;
            let direction = Vector3::from(exit.direction);
            let arm = Vector3::from(arm_m) / self.arm_m;
            let torque = arm.cross(&direction);
            let slope = -Vector6::new(direction.x, direction.y, direction.z, torque.x, torque.y, torque.z);
            squares.sum_m2 += residual_m * residual_m;
            squares.gradient += slope * residual_m;
            squares.normal.ger(1.0, &slope, &slope, 1.0);
            squares.curvature += self.curvature(&direction, &arm, exit.free_length_m) * residual_m;
        }
        squares.sum_m2.is_finite().then_some(squares)
    }

    /// Returns the second derivatives of a cable's length; `arm` is its lever arm divided by [`arm_m`](Self::arm_m).
    fn curvature(&self, direction: &Vector3<f64>, arm: &Vector3<f64>, free_length_m: f64) -> Matrix6<f64> {
        let across = (Matrix3::identity() - direction * direction.transpose()) / free_length_m;
        let turn = -arm.cross_matrix();
        let crossed = direction * arm.transpose();
        let tilt = (Matrix3::identity() * direction.dot(arm) - (crossed + crossed.transpose()) * 0.5) / self.arm_m;
        let mixed = across * turn;
        let mut curvature = Matrix6::zeros();
        curvature.fixed_view_mut::<3, 3>(0, 0).copy_from(&across);
        curvature.fixed_view_mut::<3, 3>(0, 3).copy_from(&mixed);
        curvature.fixed_view_mut::<3, 3>(3, 0).copy_from(&mixed.transpose());
        curvature.fixed_view_mut::<3, 3>(3, 3).copy_from(&(turn.transpose() * mixed + tilt));
        curvature
    }
}

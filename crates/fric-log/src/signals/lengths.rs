//! Poses computed from the cable lengths, row by row.

use std::sync::Arc;

use fric_core::forward::{FEWEST_CABLES, NoPose, PoseFollower};
use fric_core::robot::file::RobotFile;
use fric_core::{CableInput, Pose};

use super::SignalPaths;

/// Residual relative to the lengths (both rms) above which a warning says that the lengths, or the geometry in the robot file, are wrong. At half
/// this value, cables that sag or stretch by 0.05 % cause a warning; at double, 1 cm on one of eight cables of 1 m does not.
const TOLD_RATIO: f64 = 1e-3;

/// The poses of consecutive rows.
#[derive(Debug)]
pub(super) struct PosesFromLengths {
    robot: Arc<RobotFile>,
    follower: PoseFollower,
    pub summary: LengthPoses,
}

/// Statistics of a log's rows whose poses come from the cable lengths.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LengthPoses {
    /// Rows with a pose.
    pub posed_count: u64,
    /// Rows without a pose because fewer than six cables have a length.
    pub too_few_count: u64,
    /// Rows without a pose because no pose agrees with the lengths, or the search did not converge.
    pub apart_count: u64,
    /// Rows without a pose because the lengths do not determine a direction.
    pub undetermined_count: u64,
    residual_squares_m2: f64,
    length_squares_m2: f64,
}

impl PosesFromLengths {
    /// Returns the computation before the first row; `None` if the pose is read from the log.
    pub fn of(paths: &SignalPaths) -> Option<Self> {
        let robot = Arc::clone(paths.pose_robot()?);
        Some(Self { robot, follower: PoseFollower::default(), summary: LengthPoses::default() })
    }

    /// Returns the pose of the next row, `None` if its lengths give none. Rows before the requested part are not counted.
    pub fn next_pose(&mut self, cables: &[CableInput], counts: bool) -> Option<Pose> {
        let found = self.follower.next_pose(&self.robot.params(), cables);
        if counts {
            let summary = &mut self.summary;
            match &found {
                Ok(found) => {
                    summary.posed_count += 1;
                    summary.residual_squares_m2 += found.residual_rms_m * found.residual_rms_m;
                    summary.length_squares_m2 += found.length_rms_m * found.length_rms_m;
                }
                Err(NoPose::TooFew { .. }) => summary.too_few_count += 1,
                Err(NoPose::Undetermined) => summary.undetermined_count += 1,
                Err(_) => summary.apart_count += 1,
            }
        }
        found.ok().map(|found| found.pose)
    }
}

impl LengthPoses {
    /// Returns the number of rows without a pose.
    #[must_use]
    pub fn unposed_count(&self) -> u64 {
        self.too_few_count + self.apart_count + self.undetermined_count
    }

    /// Returns the error of the lengths at the poses, rms over cables and rows, m; `None` without a pose.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "a count of rows")]
    pub fn residual_rms_m(&self) -> Option<f64> {
        (self.posed_count > 0).then(|| (self.residual_squares_m2 / self.posed_count as f64).sqrt())
    }

    /// Returns remarks in words: the residual, and why rows have no pose.
    #[must_use]
    pub fn remarks(&self) -> Vec<String> {
        let residual = self.residual_rms_m().map(|rms_m| format!("residual {:.3} mm rms", rms_m * 1e3));
        residual.into_iter().chain(self.lacks()).collect()
    }

    /// Returns warnings in words, each with what to do.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let residual = self
            .residual_rms_m()
            .filter(|_| self.residual_squares_m2 > TOLD_RATIO * TOLD_RATIO * self.length_squares_m2);
        let told = residual.map(|rms_m| {
            format!(
                "the cable lengths do not agree with one pose: they are off by {:.3} mm rms; check the zero of each length, which counts from `base_m` to `platform_m` with what \
                 lies on the last pulley, and `base_m`, `platform_m` and `radius_m` in the robot file",
                rms_m * 1e3
            )
        });
        let lacks = self.lacks().map(|lack| format!("pose from the cable lengths: {lack}"));
        told.into_iter().chain(lacks).collect()
    }

    fn lacks(&self) -> impl Iterator<Item = String> {
        let reasons = [
            (self.too_few_count, format!("fewer than {FEWEST_CABLES} cables with `base_m` and `platform_m` have a length there")),
            (
                self.apart_count,
                "no pose has such lengths: they count from `base_m` to `platform_m`, with what lies on the last pulley".to_owned(),
            ),
            (
                self.undetermined_count,
                "the lengths leave a direction open, as where all cables meet in one point or on one line of the platform".to_owned(),
            ),
        ];
        let said = reasons.into_iter().filter(|(count, _)| *count > 0);
        said.map(|(count, why)| {
            format!("{count} {} no pose: {why}", if count == 1 { "sample has" } else { "samples have" })
        })
    }
}

//! Finds the position that a log crosses from its poses, wherever the log starts and whatever else it contains.
//!
//! Movements along one line are collected in a track. The crossed position is where tracks of several axes, each passed in both directions, meet: of
//! all such points the one with the most axes, and among these the one with the most passes. A track that meets no other is crossed in its middle.
//! The number of tracks is limited, so memory does not grow with the log.

use fric_core::robot::file::RobotFile;
use fric_core::{Pose, Sample};
use nalgebra::Vector3;

use super::error::HysteresisError;
use super::movement::{Movement, Movements, Scale};
use crate::axis::{CartesianAxis, rotation};

/// Tolerance relative to the mean cable length: one millimetre at 1 m.
const TOLERANCE_SHARE: f64 = 1e-3;
/// Minimum lever for angles relative to the mean cable length, for platforms that are a point.
const LEVER_SHARE: f64 = 0.05;
/// Lines up to this many tolerances apart count as one.
const SAME_LINE: f64 = 2.0;
/// Maximum number of tracks; movements along further ones are ignored.
const MOST_TRACKS: usize = 256;
/// Maximum number of movements of a track whose ends are kept.
const MOST_SPANS: usize = 64;

/// The first reading of a log, which collects its poses.
#[derive(Debug)]
pub struct Survey {
    /// Entry point into the last pulley and attachment point of each cable, m.
    cables_m: Vec<[Vector3<f64>; 2]>,
    found: Option<Found>,
}

#[derive(Debug)]
struct Found {
    scale: Scale,
    movements: Movements,
    tracks: Vec<Track>,
}

/// Movements along one line.
#[derive(Debug)]
struct Track {
    axis: CartesianAxis,
    /// A pose on the line.
    origin: Pose,
    /// Number of movements against and in the direction of the axis.
    counts: [usize; 2],
    /// Ends of the movements along the axis from the origin, m.
    spans_m: Vec<[f64; 2]>,
}

/// A track that is passed in both directions.
#[derive(Clone, Copy, Debug)]
struct Line {
    axis: CartesianAxis,
    origin: Pose,
    /// Ends of the typical movement along the axis from the origin, m.
    span_m: [f64; 2],
    passes: usize,
}

/// The position that a log crosses, and the axes along which it does.
#[derive(Clone, Debug, PartialEq)]
pub struct CrossedPose {
    pose: Pose,
    /// Reach of the movements to either side, m, with angles as distances; `None` for an axis that is not crossed.
    reaches_m: [Option<f64>; 6],
    pub(super) scale: Scale,
}

impl CrossedPose {
    /// Returns the pose at which the axes cross.
    #[must_use]
    pub fn pose(&self) -> &Pose {
        &self.pose
    }

    pub(super) fn reach_m(&self, axis: CartesianAxis) -> Option<f64> {
        self.reaches_m.get(axis.index()).copied().flatten()
    }
}

impl Survey {
    /// Creates a survey for a robot whose cables all have geometry.
    ///
    /// # Errors
    /// Returns [`HysteresisError::NoGeometry`] with the first cable without geometry.
    pub fn new(robot: &RobotFile) -> Result<Self, HysteresisError> {
        let names = robot.cable_names().into_iter();
        let cables = names.zip(robot.params().cables()).map(|(name, cable)| {
            let ends_m = cable.base_m().zip(cable.platform_m());
            ends_m.map(<[_; 2]>::from).ok_or_else(|| HysteresisError::NoGeometry { cable: name.to_owned() })
        });
        Ok(Self { cables_m: cables.collect::<Result<_, HysteresisError>>()?, found: None })
    }

    /// Adds the pose of the next sample; a missing or non-finite pose is skipped.
    pub fn add(&mut self, sample: &Sample<'_>) {
        let Some(pose) = sample.pose.filter(Pose::is_usable) else { return };
        let found = self.found.get_or_insert_with(|| {
            let scale = scale(&self.cables_m, &pose);
            Found { scale, movements: Movements::new(scale), tracks: Vec::new() }
        });
        if let Some(movement) = found.movements.add(&pose) {
            found.gather(&movement);
        }
    }

    /// Returns the position that most axes cross.
    ///
    /// # Errors
    /// Returns a [`HysteresisError`] that says what the log lacks.
    pub fn finish(self) -> Result<CrossedPose, HysteresisError> {
        let mut found = self.found.ok_or(HysteresisError::NoPose)?;
        if let Some(movement) = found.movements.end() {
            found.gather(&movement);
        }
        let strays = found.movements.strayed_m() > 0.0;
        if found.tracks.is_empty() {
            return Err(if strays { HysteresisError::SeveralAxes } else { HysteresisError::NoMovement });
        }
        let scale = found.scale;
        let lines: Vec<Line> = found.tracks.iter().filter_map(Track::line).collect();
        let alone = lines.iter().map(|line| line.at(&scale, 0.5 * (line.span_m[0] + line.span_m[1])));
        let met = lines.iter().flat_map(|line| {
            let others = lines.iter().filter(|other| other.axis != line.axis);
            others.map(|other| line.at(&scale, scale.along_and_aside(&other.origin, &line.origin, line.axis).0))
        });
        let mut best: Option<((usize, usize), CrossedPose)> = None;
        for pose in alone.chain(met) {
            let (crossed, passes) = crossed(&lines, &scale, pose);
            let axes = crossed.reaches_m.iter().flatten().count();
            if axes > 0 && best.as_ref().is_none_or(|(score, _)| (axes, passes) > *score) {
                best = Some(((axes, passes), crossed));
            }
        }
        best.map(|(_, crossed)| crossed).ok_or(HysteresisError::NoCrossing)
    }
}

impl Found {
    fn gather(&mut self, movement: &Movement) {
        let Movement { axis, from, to, is_forward } = *movement;
        let middle = from.interpolate(&to, 0.5);
        let scale = self.scale;
        let same = |track: &Track| {
            let (_, aside_m) = scale.along_and_aside(&middle, &track.origin, axis);
            track.axis == axis && aside_m <= SAME_LINE * scale.tolerance_m
        };
        let place = self.tracks.iter().position(same).unwrap_or(self.tracks.len());
        if place == self.tracks.len() && place < MOST_TRACKS {
            self.tracks.push(Track { axis, origin: middle, counts: [0; 2], spans_m: Vec::new() });
        }
        let Some(track) = self.tracks.get_mut(place) else { return };
        let [back, forward] = &mut track.counts;
        *(if is_forward { forward } else { back }) += 1;
        if track.spans_m.len() < MOST_SPANS {
            let [start_m, end_m] = [from, to].map(|pose| scale.along_and_aside(&pose, &track.origin, axis).0);
            track.spans_m.push([start_m.min(end_m), start_m.max(end_m)]);
        }
    }
}

/// Returns which axes cross at a pose, and how many movements do.
fn crossed(lines: &[Line], scale: &Scale, pose: Pose) -> (CrossedPose, usize) {
    let mut reaches_m = [None; 6];
    let mut passes = 0;
    for line in lines {
        let (along_m, aside_m) = scale.along_and_aside(&pose, &line.origin, line.axis);
        let [start_m, end_m] = line.span_m;
        let reach_m = (along_m - start_m).min(end_m - along_m);
        if aside_m > SAME_LINE * scale.tolerance_m || reach_m < scale.tolerance_m {
            continue;
        }
        passes += line.passes;
        if let Some(place) = reaches_m.get_mut(line.axis.index()) {
            let greatest_m: f64 = place.unwrap_or(0.0);
            *place = Some(greatest_m.max(reach_m));
        }
    }
    (CrossedPose { pose, reaches_m, scale: *scale }, passes)
}

impl Track {
    /// Returns the ends of the typical movement, m: the medians of both ends.
    fn span_m(&self) -> [f64; 2] {
        let median = |pick: fn(&[f64; 2]) -> f64| {
            let mut ends_m: Vec<f64> = self.spans_m.iter().map(pick).collect();
            ends_m.sort_by(f64::total_cmp);
            ends_m.get(ends_m.len() / 2).copied().unwrap_or(0.0)
        };
        [median(|[start_m, _]| *start_m), median(|[_, end_m]| *end_m)]
    }

    /// Returns the line, if it is passed in both directions.
    fn line(&self) -> Option<Line> {
        let [back, forward] = self.counts;
        let Self { axis, origin, .. } = *self;
        (back > 0 && forward > 0).then(|| Line { axis, origin, span_m: self.span_m(), passes: back + forward })
    }
}

impl Line {
    /// Returns the pose on the line at a distance from its origin.
    fn at(&self, scale: &Scale, along_m: f64) -> Pose {
        let Pose { position_m, orientation } = self.origin;
        if self.axis.is_rotation() {
            let turn = rotation(&(self.axis.direction() * (along_m / scale.lever_m)));
            Pose { position_m, orientation: turn * orientation }
        } else {
            Pose { position_m: position_m + self.axis.direction() * along_m, orientation }
        }
    }
}

/// Returns tolerance and lever for a robot of this size.
fn scale(cables_m: &[[Vector3<f64>; 2]], pose: &Pose) -> Scale {
    #[expect(clippy::cast_precision_loss, reason = "a number of cables")]
    let count = cables_m.len().max(1) as f64;
    let length_m =
        |[base_m, platform_m]: &[Vector3<f64>; 2]| (base_m - pose.position_m - pose.orientation * platform_m).norm();
    let mean_length_m = (cables_m.iter().map(length_m).sum::<f64>() / count).max(1e-3);
    let arm_m = cables_m.iter().map(|[_, platform_m]| platform_m.norm()).sum::<f64>() / count;
    Scale { tolerance_m: TOLERANCE_SHARE * mean_length_m, lever_m: arm_m.max(LEVER_SHARE * mean_length_m) }
}

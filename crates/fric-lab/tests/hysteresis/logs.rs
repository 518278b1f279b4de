//! Samples made by hand: a robot without friction, and forces that depend on the direction as wanted.

use fric_core::platform::structure_matrix;
use fric_core::robot::file::RobotFile;
use fric_core::{CableInput, Pose, Sample, Wrench};
use fric_lab::CartesianAxis;
use fric_lab::hysteresis::{AxisHysteresis, Hysteresis, HysteresisError, Survey};
use nalgebra::{SMatrix, SVector, UnitQuaternion, Vector3};

/// A sample that owns what it lends.
#[derive(Clone)]
pub struct Owned {
    pub stamp_nanos: i64,
    pub cables: Vec<CableInput>,
    pub pose: Option<Pose>,
    pub outside_wrench: Option<Wrench>,
}

impl Owned {
    pub fn sample(&self) -> Sample<'_> {
        let Self { stamp_nanos, cables, pose, outside_wrench } = self;
        let (stamp_nanos, pose, outside_wrench) = (*stamp_nanos, *pose, *outside_wrench);
        Sample { stamp_nanos, cables, reference_force_n: &[f64::NAN; 8], pose, outside_wrench }
    }
}

/// The hysteresis of samples.
pub fn hysteresis(robot: &RobotFile, log: &[Owned]) -> Result<(Pose, Vec<AxisHysteresis>), HysteresisError> {
    let mut survey = Survey::new(robot)?;
    for sample in log {
        survey.add(&sample.sample());
    }
    let crossed = survey.finish()?;
    let mut hysteresis = Hysteresis::new(robot, &crossed)?;
    for sample in log {
        hysteresis.step(&sample.sample());
    }
    Ok((*crossed.pose(), hysteresis.axes()?))
}

/// A pose by position, m, and rotation vector, rad.
pub fn pose(position_m: [f64; 3], rotation_rad: [f64; 3]) -> Pose {
    Pose { position_m: position_m.into(), orientation: UnitQuaternion::from_scaled_axis(Vector3::from(rotation_rad)) }
}

/// The pose an amount along, or turned about, an axis from another.
pub fn along(axis: CartesianAxis, from: &Pose, way: f64) -> Pose {
    let step = axis.direction() * way;
    if axis.is_rotation() {
        Pose { orientation: UnitQuaternion::from_scaled_axis(step) * from.orientation, ..*from }
    } else {
        Pose { position_m: from.position_m + step, ..*from }
    }
}

/// A log in the making.
pub struct Log<'a> {
    robot: &'a RobotFile,
    pub samples: Vec<Owned>,
}

impl<'a> Log<'a> {
    pub fn new(robot: &'a RobotFile) -> Self {
        Self { robot, samples: Vec::new() }
    }

    /// One cycle at a pose; the cables balance `outside`, the log knows `applied`.
    pub fn add(&mut self, pose: &Pose, outside: &SVector<f64, 6>, applied: Option<Wrench>) {
        let params = self.robot.params();
        let matrix: SMatrix<f64, 6, 8> = structure_matrix::<8>(&params, pose).unwrap();
        let mean_n = SVector::<f64, 8>::repeat(20.0);
        let square = (matrix * matrix.transpose()).try_inverse().unwrap();
        let forces_n = mean_n - matrix.transpose() * (square * (matrix * mean_n + outside));
        let cable = |(params, force_n): (&fric_core::CableParams, &f64)| CableInput {
            // Behind 180° the sensor feels the cable twice.
            sensor_force_n: 2.0 * force_n,
            length_m: params.length_m(pose).unwrap(),
            speed_m_per_s: 0.0,
        };
        let cables = params.cables().iter().zip(forces_n.iter()).map(cable).collect();
        let stamp_nanos = 1_000_000 * i64::try_from(self.samples.len()).unwrap();
        self.samples.push(Owned { stamp_nanos, cables, pose: Some(*pose), outside_wrench: applied });
    }

    /// To and fro across a pose, `passes` times, with a wrench of ±`half` along the axis by direction.
    pub fn cross(&mut self, axis: CartesianAxis, center: &Pose, passes: usize, half: f64, gravity: &SVector<f64, 6>) {
        let reach = if axis.is_rotation() { 0.05 } else { 0.04 };
        for pass in 0..passes {
            let sign = if pass % 2 == 0 { 1.0 } else { -1.0 };
            // Slower on one side of the crossing: more samples there.
            for step in 0..=120 {
                let share = f64::from(step) / 60.0 - 1.0;
                let way = sign * reach * if share < 0.0 { share } else { share * share };
                let mut outside = *gravity;
                outside[axis as usize] += sign * half;
                self.add(&along(axis, center, way), &outside, None);
            }
        }
    }
}

/// The weight of the platform.
pub fn gravity() -> SVector<f64, 6> {
    SVector::from([0.0, 0.0, -0.41 * 9.80665, 0.0, 0.0, 0.0])
}

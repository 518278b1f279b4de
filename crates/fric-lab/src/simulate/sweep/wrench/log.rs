//! From the description of a case to its log.

use fric_core::robot::file::RobotFile;
use fric_core::{CableInput, Pose, Sample, Wrench};
use nalgebra::Vector6;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution as _, StandardNormal};

use super::super::SweepError;
use super::hidden::{Drawn, Hum, Misstated, draw};
use super::{WrenchCase, WrenchGroup};
use crate::excite::{Excitation, ExcitationOptions};
use crate::fit::{Measurements, Reference};
use crate::random::uniform;
use crate::replay::WrenchReference;
use crate::simulate::hidden::HiddenEffect;
use crate::simulate::options::SimulationOptions;
use crate::simulate::stream::Simulation;
use crate::trajectory::{Limits, Piece, Shape, Trajectory};

/// Length of a log, s.
const LOG_S: f64 = 20.0;
/// Usual noise of a sensor, N, and of a measured wrench, N and N m.
const SENSOR_NOISE_N: f64 = 0.02;
const WRENCH_NOISE: [f64; 2] = [0.01, 0.0005];
/// Spread of μ over the pulleys.
const SPREAD_RATIO: f64 = 0.1;
/// Hardest push of a hand along each base axis, N.
const HAND_N: f64 = 3.0;
/// Greatest acceleration of a run that is compared with the weight, m/s²: it stays quiet.
const QUIET_M_PER_S2: f64 = 0.4;
/// Apart from the streams of the simulation itself, which has the same seed.
const STREAM: u64 = u64::MAX;

/// One cycle of a log.
#[derive(Clone, Debug)]
pub struct WrenchCycle {
    /// Stamp, ns.
    pub stamp_nanos: i64,
    /// Signals of all cables.
    pub cables: Vec<CableInput>,
    /// Pose of the platform, on a line between two measurements.
    pub pose: Pose,
    /// Outside wrench on the platform, likewise; `None` where none is measured.
    pub wrench: Option<Wrench>,
    /// True forces of the cables at the platform, N, which no discovery sees.
    pub true_force_n: Vec<f64>,
}

/// A log to be searched, and what is in it.
#[derive(Debug)]
pub struct WrenchCaseLog {
    /// What a user has: the robot without the effects, with guesses for its friction.
    pub robot: RobotFile,
    /// Its text.
    pub robot_text: String,
    /// The log itself.
    pub cycles: Vec<WrenchCycle>,
    /// What is to be found.
    pub truth: WrenchTruth,
}

/// What is in a log.
#[derive(Clone, Debug)]
pub struct WrenchTruth {
    /// The robot of the log with its true friction and effects; the μ of a cable is the mean of its pulleys', as the sensor feels them.
    pub robot: RobotFile,
    /// Effects of each cable.
    pub effects: Vec<Vec<HiddenEffect>>,
    /// What is wrong about the robot file.
    pub misstated: Option<Misstated>,
    /// White noise of the six components of the sum of all forces and the reference, N and N m: no model comes below it.
    pub noise: [f64; 6],
}

impl WrenchCaseLog {
    /// The log as a discovery takes it, with a robot to begin from.
    #[must_use]
    pub fn measured<'a>(&self, robot: &'a RobotFile) -> Measurements<'a> {
        let mut measurements = Measurements::new(&robot.params(), Reference::Wrench);
        measurements.start_log();
        for cycle in &self.cycles {
            measurements.add(&Sample {
                stamp_nanos: cycle.stamp_nanos,
                cables: &cycle.cables,
                reference_force_n: &[],
                pose: Some(cycle.pose),
                outside_wrench: cycle.wrench,
            });
        }
        measurements
    }
}

impl WrenchCase {
    /// Draws what the seed decides and simulates the log.
    ///
    /// # Errors
    /// [`SweepError`] for a case whose numbers are out of range.
    pub fn log(&self) -> Result<WrenchCaseLog, SweepError> {
        let random = &mut ChaCha8Rng::seed_from_u64(self.seed);
        random.set_stream(STREAM);
        let Drawn { truth, given, misstated, hum } = draw(self, LOG_S, random)?;
        let parse = |text: &str| RobotFile::parse(text, "sweep");
        let robot = parse(&truth.text())?;
        let options = SimulationOptions {
            seed: self.seed,
            sensor_noise_n: self.noise_ratio * SENSOR_NOISE_N,
            reference_noise_n: 0.0,
            mu_spread_ratio: SPREAD_RATIO,
            hand_n: if self.group == WrenchGroup::Hand { HAND_N } else { 0.0 },
            ..SimulationOptions::default()
        };
        let run = self.run(&robot, random)?;
        let mut simulation = Simulation::following(&robot, &options, &run)?.with_wandering_tensions();
        let mut mean = truth.clone();
        for (cable, friction) in mean.friction.iter_mut().enumerate() {
            friction.mu = simulation.mean_mu(cable).unwrap_or(friction.mu);
        }
        let cycles = self.recorded(&mut simulation, &hum, robot.params().cycle_s());
        let robot_text = given.text();
        let noise = self.noise(&robot, &cycles);
        let truth = WrenchTruth { robot: parse(&mean.text())?, effects: truth.effects, misstated, noise };
        Ok(WrenchCaseLog { robot: parse(&robot_text)?, robot_text, cycles, truth })
    }

    /// Steps, and strokes along all axes with speeds and lengths by the seed, one after the other.
    fn run(&self, robot: &RobotFile, random: &mut ChaCha8Rng) -> Result<Excitation, SweepError> {
        let is_quiet = self.reference == WrenchReference::Mass;
        let options = ExcitationOptions {
            max_acceleration_m_per_s2: is_quiet.then_some(QUIET_M_PER_S2),
            ..ExcitationOptions::default()
        };
        let place = Excitation::of_pieces(robot, &options, &[], 0.0)?;
        let limits = Limits {
            acceleration_m_per_s2: options.max_acceleration_m_per_s2.unwrap_or(f64::INFINITY),
            ..Limits::NONE
        };
        let duration_s = |pieces: &[Piece]| {
            place.work_box().map_or(LOG_S, |work_box| Trajectory::designed(work_box, &limits, pieces, 0.0).duration_s())
        };
        let mut pieces = Vec::new();
        let fastest_m_per_s = uniform(random, 0.3, 1.0);
        for axes in [None, Some(0), Some(1), Some(2)].into_iter().cycle() {
            let shape = if axes.is_none() && pieces.len() % 8 == 0 {
                Shape::Alternating { step_m: uniform(random, 0.001, 0.006), rest_s: 0.2, count: 3 }
            } else {
                Shape::Strokes {
                    axis: axes,
                    length_m: uniform(random, 0.1, 0.35),
                    speed_m_per_s: fastest_m_per_s * libm::exp(uniform(random, -2.5, 0.0)),
                    acceleration_m_per_s2: uniform(random, 1.5, 8.0),
                    count: 2,
                }
            };
            pieces.push(Piece { shape, load_share: 0.5 });
            if duration_s(&pieces) >= LOG_S {
                break;
            }
        }
        Ok(Excitation::of_pieces(robot, &options, &pieces, 0.0)?)
    }

    /// What the loop logs, with pose and wrench on lines between their measurements.
    fn recorded(&self, simulation: &mut Simulation, hum: &[Option<Hum>], interval_s: f64) -> Vec<WrenchCycle> {
        let random = &mut ChaCha8Rng::seed_from_u64(self.seed);
        random.set_stream(STREAM - 1);
        let mut cycles: Vec<WrenchCycle> = Vec::new();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some 10,000")]
        let count = (LOG_S / interval_s) as usize;
        while let Some(sample) = simulation.next_cycle().filter(|_| cycles.len() < count) {
            #[expect(clippy::cast_precision_loss, reason = "some 10,000")]
            let time_s = cycles.len() as f64 * interval_s;
            // A platform on its cables has one.
            let Some(pose) = sample.pose else { break };
            let mut cables = sample.cables.to_vec();
            for (input, hum) in cables.iter_mut().zip(hum) {
                input.sensor_force_n += hum.map_or(0.0, |hum| hum.force_n(time_s));
            }
            let wrench = sample.outside_wrench.filter(|_| self.reference == WrenchReference::Measured);
            cycles.push(WrenchCycle {
                stamp_nanos: sample.stamp_nanos,
                cables,
                pose,
                wrench: wrench.map(|wrench| self.with_noise(&wrench, random)),
                true_force_n: sample.reference_force_n.to_vec(),
            });
        }
        self.join_measurements(&mut cycles);
        cycles
    }

    fn with_noise(&self, wrench: &Wrench, random: &mut ChaCha8Rng) -> Wrench {
        let mut wrench = *wrench;
        let [force_n, torque_nm] = WRENCH_NOISE.map(|noise| self.noise_ratio * noise);
        for (part, noise) in [(&mut wrench.force_n, force_n), (&mut wrench.torque_nm, torque_nm)] {
            for number in part {
                let drawn: f64 = StandardNormal.sample(random);
                *number += noise * drawn;
            }
        }
        wrench
    }

    /// Cycles after the last measurement go.
    fn join_measurements(&self, cycles: &mut Vec<WrenchCycle>) {
        let every = self.wrench_every.max(1);
        cycles.truncate(cycles.len().saturating_sub(1) / every * every + 1);
        for start in (0..cycles.len().saturating_sub(every)).step_by(every) {
            let (from, to) = (cycles[start].clone(), cycles[start + every].clone());
            for (step, cycle) in cycles[start..start + every].iter_mut().enumerate().skip(1) {
                #[expect(clippy::cast_precision_loss, reason = "a few cycles")]
                let ratio = step as f64 / every as f64;
                cycle.pose = from.pose.interpolate(&to.pose, ratio);
                cycle.wrench = from.wrench.zip(to.wrench).map(|(from, to)| Wrench {
                    force_n: from.force_n.lerp(&to.force_n, ratio),
                    torque_nm: from.torque_nm.lerp(&to.torque_nm, ratio),
                });
            }
        }
    }

    /// White noise of the sums: of each sensor as its force works on the platform, and of the wrench. A sensor at 180° feels its cable twice.
    fn noise(&self, robot: &RobotFile, cycles: &[WrenchCycle]) -> [f64; 6] {
        let params = robot.params();
        let [force_n, torque_nm] = match self.reference {
            WrenchReference::Measured => WRENCH_NOISE.map(|noise| self.noise_ratio * noise),
            WrenchReference::Mass => [0.0; 2],
        };
        let (mut squares, mut count) = (Vector6::zeros(), 0.0);
        for cycle in cycles {
            for cable in params.cables() {
                let Some(column) = cable.structure_column(&cycle.pose) else { continue };
                let noise = column * (0.5 * self.noise_ratio * SENSOR_NOISE_N);
                squares += noise.component_mul(&noise);
            }
            count += 1.0;
        }
        let of_reference =
            Vector6::new(force_n, force_n, force_n, torque_nm, torque_nm, torque_nm).map(|noise| noise * noise);
        (squares / count + of_reference).map(f64::sqrt).into()
    }
}

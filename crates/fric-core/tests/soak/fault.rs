//! What can go wrong with a robot's signals, one thing after the other and several at once.

use fric_core::{CableInput, CycleInput, Pose};
use nalgebra::{Quaternion, UnitQuaternion};

use super::episode::MOST_CABLES;
use super::robot::{magnitude, pick};
use crate::random::Random;

/// A fault of one cable's signals.
#[derive(Clone, Copy, Debug)]
pub enum CableFault {
    /// The sensor shows a value that is none, or a constant: NaN, drop-out, saturation.
    Sensor(f64),
    /// The sensor shows so much more, N.
    Spike(f64),
    /// It repeats its last value.
    Frozen(Option<f64>),
    /// The encoder shows this.
    Length(f64),
    /// It repeats its last value.
    LengthFrozen(Option<f64>),
    /// It is off by so much, m.
    Jump(f64),
    /// The speed is this.
    Speed(f64),
}

/// A fault of all that a cycle gets.
#[derive(Clone, Copy, Debug)]
pub enum CycleFault {
    /// No pose.
    PoseMissing,
    /// A pose that is none.
    PoseBroken,
    /// The cycle is not run, and the next one is told.
    SkippedTold,
    /// The cycle is not run, and nobody is told.
    Skipped,
    /// The signals come a cycle late: those of the one before again.
    Late,
}

/// A fault over some cycles.
#[derive(Clone, Copy, Debug)]
pub struct Spell<F> {
    pub fault: F,
    first: u32,
    last: u32,
}

impl<F> Spell<F> {
    fn new(random: &mut Random, fault: F, cycles: u32) -> Self {
        let first = u32::try_from(random.below(u64::from(cycles))).unwrap();
        let count = if random.below(3) == 0 { 1 } else { 1 + u32::try_from(random.below(120)).unwrap() };
        Self { fault, first, last: (first + count - 1).min(cycles - 1) }
    }

    pub fn stands(&self, cycle: u32) -> bool {
        (self.first..=self.last).contains(&cycle)
    }
}

/// Faults of a stretch of time.
pub struct Faults {
    pub cables: Vec<(usize, Spell<CableFault>)>,
    pub cycle: Option<Spell<CycleFault>>,
}

impl Faults {
    pub fn new(random: &mut Random, cable_count: usize, cycles: u32) -> Self {
        let of_cycle = random.below(4) == 0;
        let count = random.below(4) + u64::from(!of_cycle);
        let cable = |random: &mut Random| usize::try_from(random.below(cable_count as u64)).unwrap();
        let cables = (0..count).map(|_| {
            let fault = CableFault::new(random);
            (cable(random), Spell::new(random, fault, cycles))
        });
        let cables = cables.collect();
        let cycle = of_cycle.then(|| {
            let faults = [
                CycleFault::PoseMissing,
                CycleFault::PoseBroken,
                CycleFault::SkippedTold,
                CycleFault::Skipped,
                CycleFault::Late,
            ];
            let fault = pick(&faults, random);
            Spell::new(random, fault, cycles)
        });
        Self { cables, cycle }
    }

    /// Whether a cable has a fault at any time.
    pub fn touch(&self, cable: usize) -> bool {
        self.cycle.is_some() || self.cables.iter().any(|(of, _)| *of == cable)
    }

    /// What stands of the faults that concern all cables.
    pub fn of_cycle(&self, cycle: u32) -> Option<CycleFault> {
        self.cycle.filter(|spell| spell.stands(cycle)).map(|spell| spell.fault)
    }

    /// Spoils the cables' signals and the pose.
    pub fn spoil(&mut self, cycle: u32, input: &mut CycleInput<MOST_CABLES>) {
        for (cable, spell) in &mut self.cables {
            if spell.stands(cycle) {
                spell.fault.spoil(&mut input.cables[*cable]);
            }
        }
        match self.of_cycle(cycle) {
            Some(CycleFault::PoseMissing) => input.pose = None,
            Some(CycleFault::PoseBroken) => {
                let orientation = UnitQuaternion::new_unchecked(Quaternion::new(0.0, 0.0, 0.0, 0.0));
                input.pose = Some(Pose { position_m: [f64::NAN, 0.0, 0.0].into(), orientation });
            }
            _ => {}
        }
    }
}

impl CableFault {
    fn new(random: &mut Random) -> Self {
        let sign = if random.below(2) == 0 { 1.0 } else { -1.0 };
        match random.below(8) {
            0 => Self::Sensor(pick(
                &[f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, f64::from_bits(random.bits())],
                random,
            )),
            1 => Self::Sensor(pick(&[0.0, 100.0, 1e9, -0.5, 5e-324], random)),
            2 => Self::Spike(sign * magnitude(random, 1.0, 1e4)),
            3 => Self::Frozen(None),
            4 => Self::Length(pick(
                &[f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1e300, f64::from_bits(random.bits())],
                random,
            )),
            5 => Self::LengthFrozen(None),
            6 => Self::Jump(sign * magnitude(random, 1e-4, 1e5)),
            _ => Self::Speed(pick(&[f64::NAN, f64::INFINITY, 1e300, -1.5e6], random)),
        }
    }

    fn spoil(&mut self, signals: &mut CableInput) {
        match self {
            Self::Sensor(value) => signals.sensor_force_n = *value,
            Self::Spike(more_n) => signals.sensor_force_n += *more_n,
            Self::Frozen(value) => signals.sensor_force_n = *value.get_or_insert(signals.sensor_force_n),
            Self::Length(value) => signals.length_m = *value,
            Self::LengthFrozen(value) => signals.length_m = *value.get_or_insert(signals.length_m),
            Self::Jump(more_m) => signals.length_m += *more_m,
            Self::Speed(value) => signals.speed_m_per_s = *value,
        }
    }
}

//! Random signals of one cable: rest, creep, strokes, shaking, slack; and the strokes on which a cable finds back.

use fric_core::CableInput;

use super::robot::{magnitude, once_in};
use crate::random::Random;

/// Cycles of one stroke on the way back from a fault.
const STROKE_CYCLES: u32 = 100;
/// Strokes on that way.
const STROKES: u32 = 8;
/// How many cycles a cable is given to find back.
pub const RECOVERY_CYCLES: u32 = STROKE_CYCLES * STROKES;

/// One cable's way through its states of motion.
pub struct Motion {
    length_m: f64,
    speed_m_per_s: f64,
    shake_m: f64,
    cycles_left: u64,
    base_n: f64,
    swing_n: f64,
    slack_cycles: u64,
    noise_m: f64,
    cycle_s: f64,
    greatest_step_m: f64,
}

impl Motion {
    pub fn new(random: &mut Random, cycle_s: f64, length_jump_m: f64, length_noise_m: f64) -> Self {
        Self {
            length_m: random.range(-2.0, 2.0),
            speed_m_per_s: 0.0,
            shake_m: 0.0,
            cycles_left: 0,
            base_n: magnitude(random, 2.0, 50.0),
            swing_n: 0.0,
            slack_cycles: 0,
            noise_m: 0.9 * length_noise_m,
            cycle_s,
            greatest_step_m: 0.9 * length_jump_m,
        }
    }

    /// The greatest force of a cable that finds back, N.
    pub fn greatest_force_n(&self) -> f64 {
        1.5 * self.base_n
    }

    /// Signals of a cycle of no matter what.
    pub fn any(&mut self, random: &mut Random) -> CableInput {
        if self.cycles_left == 0 {
            self.turn(random);
        }
        self.cycles_left -= 1;
        let shake_m = if self.shake_m > 0.0 { random.range(-self.shake_m, self.shake_m) } else { 0.0 };
        let force_n = if self.slack_cycles > 0 {
            self.slack_cycles -= 1;
            random.range(-0.2, 0.0)
        } else {
            self.swing_n =
                (self.swing_n + 0.02 * self.base_n * random.range(-1.0, 1.0)).clamp(-0.5 * self.base_n, self.base_n);
            self.base_n + self.swing_n
        };
        self.advance(random, self.speed_m_per_s * self.cycle_s + shake_m, force_n)
    }

    /// Signals of a cycle on the way back: strokes of 20 times the way over which the cable forgets, in both directions.
    pub fn stroke(&mut self, random: &mut Random, cycle: u32, memory_m: f64) -> CableInput {
        let phase = f64::from(cycle % STROKE_CYCLES) / f64::from(STROKE_CYCLES);
        let forth = if (cycle / STROKE_CYCLES).is_multiple_of(2) { 1.0 } else { -1.0 };
        let mean_step_m = (20.0 * memory_m).max(1e-3) / f64::from(STROKE_CYCLES);
        // A sine from stand to stand.
        let step_m = forth * mean_step_m * std::f64::consts::FRAC_PI_2 * (std::f64::consts::PI * phase).sin();
        self.slack_cycles = 0;
        self.swing_n = 0.4 * self.base_n * (0.1 * f64::from(cycle)).sin();
        self.advance(random, step_m, self.base_n + self.swing_n)
    }

    fn turn(&mut self, random: &mut Random) {
        self.cycles_left = 1 + random.below(300);
        let sign = if once_in(random, 2) { 1.0 } else { -1.0 };
        let most_m_per_s = self.greatest_step_m / self.cycle_s;
        (self.speed_m_per_s, self.shake_m) = match random.below(6) {
            0 => (0.0, 0.0),
            1 => (sign * magnitude(random, 1e-5, 1e-2), 0.0),
            2 | 3 => (sign * magnitude(random, 1e-2, 1.0), 0.0),
            4 => (sign * random.range(0.0, most_m_per_s), 0.0),
            _ => (0.0, magnitude(random, 1e-7, 1e-4)),
        };
        if once_in(random, 10) {
            self.slack_cycles = 1 + random.below(30);
        }
    }

    fn advance(&mut self, random: &mut Random, step_m: f64, force_n: f64) -> CableInput {
        let room_m = self.greatest_step_m - 2.0 * self.noise_m;
        let step_m = step_m.clamp(-room_m, room_m);
        self.length_m += step_m;
        let noise_m = if self.noise_m > 0.0 { random.range(-self.noise_m, self.noise_m) } else { 0.0 };
        CableInput {
            // Never the same twice: the check for a frozen sensor is on.
            sensor_force_n: force_n + random.range(-0.01, 0.01),
            length_m: self.length_m + noise_m,
            speed_m_per_s: step_m / self.cycle_s,
        }
    }
}

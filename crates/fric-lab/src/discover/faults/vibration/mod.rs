//! A sensor that vibrates: its mount, or the frame that carries it, rings when it is struck.
//!
//! The log shows the displacement of a damped oscillator. If it is struck again and again at random times, its spectrum is that of a second-order
//! process, whose poles turn by θ and decay by r from one sample to the next,
//!
//! ```text
//! S(ω) = P·|1 − r·exp(i(θ − ω))|⁻²·|1 − r·exp(−i(θ + ω))|⁻²
//! θ = 2πf·dt·√(1 − ζ²)    r = exp(−2πζf·dt)
//! ```
//!
//! added to a constant level (white noise) and a part that falls with 1/ω² (slow changes). `search` finds frequency `f`, damping ratio `ζ` and the
//! three sizes with the greatest likelihood of the averaged periodogram within an octave on either side (P. Whittle, *Estimation and information in
//! stationary time series*, Arkiv för Matematik 2, 1953).
//!
//! A hum does not decay, and a slow sensor decays at once, so a damping ratio at either end of its range is no vibration. Neither is an oscillation
//! at which the spectrum of the motion has a line too, or one that follows the length of the cable, as a ripple does at one speed.
//!
//! Wiener's filter, `S/(S + rest)`, separates the vibration from the rest of a signal.

mod search;

use std::f64::consts::TAU;

use realfft::RealFftPlanner;
use realfft::num_complex::Complex;

use self::search::loudest;
use crate::discover::faults::lines::{LEAST_SHARE, Line, mean_square};
use crate::discover::faults::spectrum::{Fill, LINE_WIDTH, Occurrence, Spectrum, Times, Together, occurrences};
use crate::recording_fault::{Fault, RecordingFault};
use crate::samples::conditions::sign;

/// If a wave along the cable explains at least this fraction of the oscillation, it is a ripple. Where strokes repeat themselves, such a wave explains up
/// to a third of a vibration.
const MOST_OF_LENGTH: f64 = 0.5;

/// Slowest speed at which a wave along the cable is tried, as a fraction of the greatest speed.
const LEAST_SPEED: f64 = 0.1;

/// Number of samples per period that are enough to show a wave.
const SAMPLES_A_TURN: f64 = 6.0;

/// Length and speed of a cable in one row.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    /// Its length, m.
    pub length_m: f64,
    /// Its speed, m/s, positive paying out.
    pub speed_m_per_s: f64,
}

/// A vibration of a sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct Vibration {
    /// Undamped natural frequency, Hz.
    pub frequency_hz: f64,
    /// Damping ratio, as a fraction of the critical damping.
    pub damping_ratio: f64,
    /// Mean squares per sample: of the blows, of the level, and of the part that falls with the frequency, at the vibration's frequency.
    sizes: [f64; 3],
    /// Time from one sample to the next, s.
    interval_s: f64,
}

impl Vibration {
    /// Returns the root mean square, N.
    #[must_use]
    pub fn rms_n(&self) -> f64 {
        let [blows, ..] = self.sizes;
        (blows * mean_square_of(self.pole())).sqrt()
    }

    /// Whether a line of a spectrum with this frequency resolution lies within the vibration's peak.
    pub fn overlaps(&self, line_hz: f64, place_hz: f64) -> bool {
        #[expect(clippy::cast_precision_loss, reason = "a small constant")]
        let width_hz = LINE_WIDTH as f64 * place_hz;
        (self.frequency_hz - line_hz).abs() < width_hz + self.damping_ratio * self.frequency_hz
    }

    /// Returns the vibration as a fault of the recording.
    pub fn fault(&self) -> RecordingFault {
        let parameters =
            vec![("frequency_hz", self.frequency_hz), ("damping_ratio", self.damping_ratio), ("rms_n", self.rms_n())];
        RecordingFault { fault: Fault::Vibration, parameters, intervals_s: Vec::new() }
    }

    /// Returns the vibration's part of a signal, by rows; 0 where there is no sample.
    pub fn in_signal(&self, signal: &[f64], times: &Times) -> Vec<f64> {
        let mut shown = vec![0.0; signal.len()];
        let mut planner = RealFftPlanner::<f64>::new();
        let fill = Fill::of(signal);
        for run in &times.runs {
            let (places, numbers) = (times.of_run(run), signal.get(run.clone()).unwrap_or_default());
            let [Some(first), Some(last)] = [places.first(), places.last()] else { continue };
            // Padded with zeros to twice the length, so that the end of a run does not affect its beginning.
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count of samples")]
            let length = (2.0 * (last - first + 1.0)).round() as usize;
            let (there, back) = (planner.plan_fft_forward(length), planner.plan_fft_inverse(length));
            let (mut room, mut waves) = (there.make_input_vec(), there.make_output_vec());
            times.spread(run, numbers, fill, &mut room);
            if there.process(&mut room, &mut waves).is_err() {
                continue;
            }
            #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
            let length = length as f64;
            #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
            for (place, wave) in waves.iter_mut().enumerate() {
                *wave *= self.share(TAU * place as f64 / length) / length;
            }
            if back.process(&mut waves, &mut room).is_err() {
                continue;
            }
            for ((place, number), shown) in places.iter().zip(numbers).zip(shown.iter_mut().skip(run.start)) {
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count of samples")]
                let place = (place - first).round() as usize;
                *shown = if number.is_finite() { room.get(place).copied().unwrap_or(0.0) } else { 0.0 };
            }
        }
        shown
    }

    /// Returns the vibration's fraction of a wave that turns by `rad` from one sample to the next.
    fn share(&self, rad: f64) -> f64 {
        let [blows, level, slow] = self.sizes;
        let own = blows * resonance(self.pole(), rad);
        let turn = TAU * self.frequency_hz * self.interval_s;
        own / (own + level + slow * (turn / rad.max(f64::MIN_POSITIVE)).powi(2))
    }

    fn pole(&self) -> Complex<f64> {
        pole(self.frequency_hz, self.damping_ratio, self.interval_s)
    }
}

/// Returns the pole of the oscillator: its turn and decay in one sample.
fn pole(frequency_hz: f64, damping_ratio: f64, interval_s: f64) -> Complex<f64> {
    let turn = TAU * frequency_hz * interval_s;
    Complex::from_polar((-damping_ratio * turn).exp(), turn * (1.0 - damping_ratio * damping_ratio).sqrt())
}

/// Returns the power spectrum of the oscillator under blows of mean square 1 per sample.
fn resonance(pole: Complex<f64>, rad: f64) -> f64 {
    let wave = Complex::from_polar(1.0, -rad);
    1.0 / ((1.0 - pole * wave).norm_sqr() * (1.0 - pole.conj() * wave).norm_sqr())
}

/// Returns the mean square of the oscillator under such blows.
fn mean_square_of(pole: Complex<f64>) -> f64 {
    let (first, second) = (2.0 * pole.re, pole.norm_sqr());
    (1.0 + second) / ((1.0 - second) * ((1.0 + second).powi(2) - first * first))
}

/// Returns the vibration in a residual, N (NaN where there is no sample), or `None`. `way` has the cable's motion by rows, `signals` its motion and load.
pub fn vibration(residual_n: &[f64], times: &Times, way: &[Way], signals: &[Together<'_>]) -> Option<Vibration> {
    let spectrum = Spectrum::of(residual_n, times)?;
    let found = loudest(&spectrum, times)?;
    let is_worth_it = found.rms_n().powi(2) > LEAST_SHARE * mean_square(residual_n);
    let in_motion = || occurrences(&[found.frequency_hz], signals, times);
    let follows_length = || share_of_length(&found, residual_n, way) > MOST_OF_LENGTH;
    (is_worth_it && in_motion() == [Occurrence::Never] && !follows_length()).then_some(found)
}

/// Returns the lines that hum: those that keep their phase.
pub fn steady<'a>(lines: &'a [Line], residual_n: &[f64], times: &Times) -> Vec<&'a Line> {
    let Some(spectrum) = Spectrum::of(residual_n, times) else { return lines.iter().collect() };
    let keeps_phase = |line: &&Line| {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place of the spectrum")]
        let place = (line.frequency_hz / times.place_hz()).round() as usize;
        spectrum.line_power(place).is_none_or(|power| line.amplitude().powi(2) > power)
    };
    lines.iter().filter(keeps_phase).collect()
}

/// Returns how much of the residual one wave along the cable explains, as a fraction of the vibration. The wave's amplitude is constant or in proportion to
/// the speed, and keeps its sign or changes it with the direction of motion. The wave is sought in the residual itself: where the speed changes, a filter as
/// narrow as the vibration rings and loses the phase.
fn share_of_length(found: &Vibration, residual_n: &[f64], way: &[Way]) -> f64 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
    let stride = (1.0 / (SAMPLES_A_TURN * found.frequency_hz * found.interval_s)).max(1.0) as usize;
    let few: Vec<(f64, &Way)> = residual_n
        .iter()
        .copied()
        .zip(way)
        .step_by(stride)
        .filter(|(residual_n, way)| (residual_n + way.length_m + way.speed_m_per_s).is_finite())
        .collect();
    let [least_m, most_m] = few.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], (_, way)| {
        [least.min(way.length_m), most.max(way.length_m)]
    });
    let fastest = way.iter().map(|way| way.speed_m_per_s.abs()).fold(0.0, f64::max);
    let (range_m, first) = (most_m - least_m, found.frequency_hz / fastest);
    if !(range_m > 0.0 && first.is_finite()) {
        return 0.0;
    }
    let amplitudes = |way: &Way| {
        let speed = way.speed_m_per_s / fastest;
        [1.0, sign(speed), speed.abs(), speed]
    };
    let mut squares = [0.0; 4];
    for (_, way) in &few {
        squares.iter_mut().zip(amplitudes(way)).for_each(|(square, amplitude)| *square += amplitude * amplitude);
    }
    let explained = |waves_a_metre: f64| {
        let mut sums = [Complex::new(0.0, 0.0); 4];
        for (residual_n, way) in &few {
            let wave = Complex::from_polar(*residual_n, TAU * waves_a_metre * way.length_m);
            sums.iter_mut().zip(amplitudes(way)).for_each(|(sum, amplitude)| *sum += wave * amplitude);
        }
        sums.iter().zip(squares).map(|(sum, square)| 2.0 * sum.norm_sqr() / square).fold(0.0, f64::max)
    };
    let waves = std::iter::successors(Some(first), |waves_a_metre| Some(waves_a_metre + 0.5 / range_m));
    let all: Vec<f64> = waves.take_while(|waves_a_metre| *waves_a_metre < first / LEAST_SPEED).map(explained).collect();
    #[expect(clippy::cast_precision_loss, reason = "counts of samples and waves")]
    let (count, tried) = (few.len() as f64, all.len() as f64);
    // The greatest of so many squares of chance, which are spread exponentially, is this many times their mean.
    let by_chance = tried.ln() * all.iter().sum::<f64>() / tried;
    (all.into_iter().fold(0.0, f64::max) - by_chance) / (count * found.rms_n().powi(2))
}

#[cfg(test)]
mod tests {
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::discover::faults::lines::lines;
    use crate::discover::faults::passes::Passes;

    const INTERVAL_S: f64 = 1e-3;
    const COUNT: usize = 40_000;

    fn times() -> Times {
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let places = (0..COUNT).map(|place| place as f64).collect();
        Times { places, runs: std::iter::once(0..COUNT).collect(), interval_s: INTERVAL_S }
    }

    fn noise(seed: u64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        (0..COUNT).map(|_| StandardNormal.sample(&mut random)).collect()
    }

    /// An oscillator that is struck every so many seconds, by its equation of motion in steps of a twentieth of a sample.
    fn ringing(frequency_hz: f64, damping_ratio: f64, every_s: f64) -> Vec<f64> {
        const SUBSTEPS: u32 = 20;
        let (step_s, undamped) = (INTERVAL_S / f64::from(SUBSTEPS), TAU * frequency_hz);
        let (mut place, mut speed, mut blow_s) = (0.0, 0.0, 0.1);
        let mut time_s = 0.0;
        let mut shown = Vec::with_capacity(COUNT);
        for _ in 0..COUNT {
            if time_s > blow_s {
                speed += undamped;
                blow_s += every_s;
            }
            for _ in 0..SUBSTEPS {
                speed -= step_s * undamped * (undamped * place + 2.0 * damping_ratio * speed);
                place += step_s * speed;
            }
            time_s += INTERVAL_S;
            shown.push(place);
        }
        shown
    }

    #[test]
    fn a_struck_oscillator_is_found_and_comes_off() {
        for (seed, (frequency_hz, damping_ratio, every_s)) in
            [(17.0, 0.02, 1.37), (41.0, 0.01, 0.73), (8.0, 0.05, 2.1)].into_iter().enumerate()
        {
            let seed = u64::try_from(seed).unwrap();
            let clean = noise(seed);
            let shown = ringing(frequency_hz, damping_ratio, every_s);
            let residual: Vec<f64> = clean.iter().zip(&shown).map(|(noise, shown)| noise + 3.0 * shown).collect();
            let found = vibration(&residual, &times(), &[], &[]).unwrap();
            assert!((found.frequency_hz / frequency_hz - 1.0).abs() < 0.01, "{found:?}");
            assert!((found.damping_ratio / damping_ratio - 1.0).abs() < 0.4, "{found:?} {damping_ratio}");
            let truth = mean_square(&shown).sqrt() * 3.0;
            assert!((found.rms_n() / truth - 1.0).abs() < 0.25, "{} {truth}", found.rms_n());
            let of_it = found.in_signal(&residual, &times());
            let left: Vec<f64> = residual.iter().zip(&of_it).map(|(residual, of_it)| residual - of_it).collect();
            assert!(mean_square(&left).sqrt() < 1.05, "{} of {}", mean_square(&left), mean_square(&residual));
            assert!(mean_square(&left).sqrt() > 0.93, "{}", mean_square(&left));
        }
    }

    /// Stamps of a loop of 2 ms with steps of mostly 2, sometimes 3 ms: a row without a number comes some every eighth. What is slow in the residual is no
    /// vibration at that rate, and a true vibration and a hum are found as without holes.
    #[test]
    fn the_pattern_of_the_stamps_does_not_vibrate() {
        let mut of_log = Times { interval_s: 2e-3, ..times() };
        let mut half_cycles = 0_u32;
        for (place, (at, noise)) in of_log.places.iter_mut().zip(noise(40)).enumerate() {
            *at = f64::from(half_cycles / 2);
            // In every fourth row, with a row of jitter now and then.
            half_cycles += 2 + u32::from(place % 4 == usize::from(noise > 1.5));
        }
        let at_s = |row: usize| of_log.places[row] * of_log.interval_s;
        let slow = |row: usize| 5.0 * (TAU * 0.31 * at_s(row)).sin() + 4.0 * (TAU * 0.83 * at_s(row)).sin();
        let residual: Vec<f64> = noise(41).iter().enumerate().map(|(row, noise)| noise + slow(row)).collect();
        assert_eq!(vibration(&residual, &of_log, &[], &[]), None);
        assert_eq!(lines(&residual, &of_log, &[], &Passes::none()), []);

        // In turns a row of this loop, as the oscillator is that of a loop of 1 ms.
        let shown = [ringing(34.0, 0.02, 0.7), ringing(34.0, 0.02, 0.7), ringing(34.0, 0.02, 0.7)].concat();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place in the log")]
        let ringing = |row: usize| 3.0 * shown[of_log.places[row] as usize];
        let rings: Vec<f64> = residual.iter().enumerate().map(|(row, of)| of + ringing(row)).collect();
        let found = vibration(&rings, &of_log, &[], &[]).unwrap();
        assert!((found.frequency_hz / 17.0 - 1.0).abs() < 0.01, "{found:?}");
        let hums: Vec<f64> =
            residual.iter().enumerate().map(|(row, of)| of + 0.8 * (TAU * 50.02 * at_s(row)).sin()).collect();
        let found = lines(&hums, &of_log, &[], &Passes::none());
        assert_eq!(found.len(), 1, "{found:?}");
        assert!((found[0].frequency_hz - 50.02).abs() < 1e-3 && (found[0].amplitude() - 0.8).abs() < 0.03, "{found:?}");
    }

    /// White noise, a wander, a hum, and the smooth noise of a slow sensor do not ring.
    #[test]
    fn noise_wander_and_hum_do_not_vibrate() {
        for seed in 10..20 {
            let white = noise(seed);
            let (mut slow, mut smooth) = (0.0, 0.0);
            let (mut wander, mut lag, mut hum) = (Vec::new(), Vec::new(), Vec::new());
            for (place, number) in white.iter().enumerate() {
                #[expect(clippy::cast_precision_loss, reason = "a small count")]
                let time_s = place as f64 * INTERVAL_S;
                slow = 0.997 * slow + 0.08 * number;
                smooth = 0.8 * smooth + 0.2 * number;
                wander.push(slow + 0.3 * number);
                lag.push(smooth);
                hum.push(number + (TAU * 50.02 * time_s).sin());
            }
            for signal in [&white, &wander, &lag, &hum] {
                let of_hum = lines(signal, &times(), &[], &Passes::none());
                let mut rest = signal.clone();
                for line in steady(&of_hum, signal, &times()) {
                    line.add_to(rest.iter_mut(), -1.0, &times());
                }
                assert_eq!(vibration(&rest, &times(), &[], &[]), None, "{seed}");
            }
        }
    }

    /// A ripple of the drum, passed at one speed one way and the other, has the spectrum of a vibration.
    #[test]
    fn a_ripple_along_the_cable_does_not_vibrate() {
        let mut residual = noise(30);
        let mut way = Vec::with_capacity(COUNT);
        let (mut length_m, mut speed_m_per_s) = (1.0, 0.0_f64);
        for (place, number) in residual.iter_mut().enumerate() {
            let goal = if place / 1700 % 2 == 0 { 0.2 } else { -0.2 };
            speed_m_per_s += (goal - speed_m_per_s).clamp(-0.002, 0.002);
            length_m += speed_m_per_s * INTERVAL_S;
            *number += 1.5 * (TAU * length_m / 0.0125).sin();
            way.push(Way { length_m, speed_m_per_s });
        }
        let spectrum = Spectrum::of(&residual, &times()).unwrap();
        assert!(loudest(&spectrum, &times()).is_some());
        assert_eq!(vibration(&residual, &times(), &way, &[]), None);
    }

    /// The teeth of a pulley: the ripple grows with the speed, and its frequency too, so that it is loud at the frequency of the usual speed.
    #[test]
    fn a_ripple_in_proportion_to_the_speed_does_not_vibrate() {
        let mut residual = noise(31);
        let mut way = Vec::with_capacity(COUNT);
        let (mut length_m, mut speed_m_per_s) = (1.0, 0.0_f64);
        for (place, number) in residual.iter_mut().enumerate() {
            let stroke = place / 1700;
            let goal = [0.2, -0.19, 0.21, -0.2, 0.05, -0.06, 0.19, -0.2][stroke % 8];
            speed_m_per_s += (goal - speed_m_per_s).clamp(-0.002, 0.002);
            length_m += speed_m_per_s * INTERVAL_S;
            *number += 8.0 * speed_m_per_s.abs() * (TAU * length_m / 0.005).sin();
            way.push(Way { length_m, speed_m_per_s });
        }
        let spectrum = Spectrum::of(&residual, &times()).unwrap();
        assert!(loudest(&spectrum, &times()).is_some());
        assert_eq!(vibration(&residual, &times(), &way, &[]), None);
    }

    /// A mount that rings whenever a stroke ends is no ripple, though the strokes repeat themselves.
    #[test]
    fn a_mount_that_strokes_strike_vibrates() {
        let shown = ringing(17.0, 0.02, 1.7);
        let residual: Vec<f64> = noise(32).iter().zip(&shown).map(|(noise, shown)| noise + 3.0 * shown).collect();
        let mut way = Vec::with_capacity(COUNT);
        let (mut length_m, mut speed_m_per_s) = (1.0, 0.0_f64);
        for place in 0..COUNT {
            let goal = if place / 1700 % 2 == 0 { 0.2 } else { -0.2 };
            speed_m_per_s += (goal - speed_m_per_s).clamp(-0.002, 0.002);
            length_m += speed_m_per_s * INTERVAL_S;
            way.push(Way { length_m, speed_m_per_s });
        }
        let found = vibration(&residual, &times(), &way, &[]).unwrap();
        assert!((found.frequency_hz / 17.0 - 1.0).abs() < 0.01, "{found:?}");
    }
}

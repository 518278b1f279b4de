//! A sensor that vibrates: its mount, or the frame that carries it, rings when it is struck.
//!
//! What shows is the displacement of a damped oscillator. Struck again and again, at times that are its own, it has the spectrum of a process of
//! second order, whose poles turn by θ and decay by r from one sample to the next,
//!
//! ```text
//! S(ω) = P·|1 − r·exp(i(θ − ω))|⁻²·|1 − r·exp(−i(θ + ω))|⁻²
//! θ = 2πf·dt·√(1 − ζ²)    r = exp(−2πζf·dt)
//! ```
//!
//! beside a level, of white noise, and a part that falls with 1/ω², of what changes slowly. Frequency `f`, damping ratio `ζ` and the three sizes
//! are those of the greatest likelihood of the averaged periodogram within an octave on either side (P. Whittle, *Estimation and information in
//! stationary time series*, Arkiv för Matematik 2, 1953). A hum decays by nothing, a sensor that is slow by all at once: at either end of the
//! range of ζ it is no vibration. Nor is it one where the spectrum of the motion has a line too, or where it follows the length of the cable, as a
//! ripple does at one speed.
//!
//! The vibration by itself is told from the rest by Wiener's filter, `S/(S + rest)`.

use std::f64::consts::TAU;

use realfft::RealFftPlanner;
use realfft::num_complex::Complex;

use super::lines::{LEAST_SHARE, Line, mean_square};
use super::spectrum::{LINE_WIDTH, Spectrum, Times, Together, have_line};
use super::{Fault, RecordingFault};
use crate::discover::naming::STRONG_BIC;
use crate::samples::conditions::sign;

/// Damping ratios that are tried: a bell, and half a turn until nothing is left of it.
const DAMPING: [f64; 2] = [1e-3, 0.12];
/// How many of them, evenly by their logarithm, and how many frequencies beside a peak, to either side; where the search for one ends, in places of the spectrum.
const DAMPINGS: f64 = 16.0;
const FREQUENCIES: i32 = 6;
const FINEST: f64 = 0.02;
/// Peaks that are looked at, a fifth of the frequency and more apart, and parameters of an oscillator.
const PEAKS: usize = 3;
const PARAMETERS: f64 = 3.0;
/// Below so many places of the spectrum a peak is not told from what falls with the frequency.
const FIRST_PLACE: usize = 12;
/// Above this share of the sampling frequency differences of neighbouring samples are noise.
const MOST_OF_RATE: f64 = 0.4;
/// Steps of the search for the sizes.
const STEPS: usize = 40;
/// Independent numbers in a place of the periodogram, each stretch: Hann's window makes neighbours alike, and stretches overlap by half.
const INDEPENDENT: f64 = 0.49;
/// A wave that follows the length and explains this share of it is a ripple. Of strokes that repeat themselves a vibration goes with the length by up to a
/// third.
const MOST_OF_LENGTH: f64 = 0.5;
/// Waves along the cable that are tried: those that pass at this share of the greatest speed and more.
const LEAST_SPEED: f64 = 0.1;
/// Samples a turn that show a wave.
const SAMPLES_A_TURN: f64 = 6.0;

/// Where a cable is and how it moves.
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
    /// Of the oscillator if it were not damped, Hz.
    pub frequency_hz: f64,
    /// Of the critical damping.
    pub damping_ratio: f64,
    /// Mean squares, each sample: of the blows, the level and the part that falls with the frequency, at the vibration's.
    sizes: [f64; 3],
    /// Seconds from one sample to the next.
    interval_s: f64,
}

impl Vibration {
    /// Root mean square, N.
    #[must_use]
    pub fn rms_n(&self) -> f64 {
        let [blows, ..] = self.sizes;
        (blows * mean_square_of(self.pole())).sqrt()
    }

    /// Whether a line at a frequency, as broad as a spectrum with places so far apart shows it, lies within its peak.
    pub fn overlaps(&self, line_hz: f64, place_hz: f64) -> bool {
        #[expect(clippy::cast_precision_loss, reason = "a small constant")]
        let width_hz = LINE_WIDTH as f64 * place_hz;
        (self.frequency_hz - line_hz).abs() < width_hz + self.damping_ratio * self.frequency_hz
    }

    /// The fault of the recording that it is.
    pub fn fault(&self) -> RecordingFault {
        let parameters =
            vec![("frequency_hz", self.frequency_hz), ("damping_ratio", self.damping_ratio), ("rms_n", self.rms_n())];
        RecordingFault { fault: Fault::Vibration, parameters, intervals_s: Vec::new() }
    }

    /// What of a signal it is, by rows; 0 where there is no sample.
    pub fn in_signal(&self, signal: &[f64], times: &Times) -> Vec<f64> {
        let mut shown = vec![0.0; signal.len()];
        let mut planner = RealFftPlanner::<f64>::new();
        for run in &times.runs {
            let (places, numbers) = (times.of_run(run), signal.get(run.clone()).unwrap_or_default());
            let [Some(first), Some(last)] = [places.first(), places.last()] else { continue };
            // As much again of nothing: the end of a run does not ring on at its beginning.
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count of samples")]
            let length = (2.0 * (last - first + 1.0)).round() as usize;
            let (there, back) = (planner.plan_fft_forward(length), planner.plan_fft_inverse(length));
            let (mut room, mut waves) = (there.make_input_vec(), there.make_output_vec());
            times.spread(run, numbers, &mut room);
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

    /// What share of a wave is the vibration's; `rad` is its turn from one sample to the next.
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

/// How the oscillator turns and decays in a sample.
fn pole(frequency_hz: f64, damping_ratio: f64, interval_s: f64) -> Complex<f64> {
    let turn = TAU * frequency_hz * interval_s;
    Complex::from_polar((-damping_ratio * turn).exp(), turn * (1.0 - damping_ratio * damping_ratio).sqrt())
}

/// Power spectrum of the oscillator, of blows of mean square 1 each sample.
fn resonance(pole: Complex<f64>, rad: f64) -> f64 {
    let wave = Complex::from_polar(1.0, -rad);
    1.0 / ((1.0 - pole * wave).norm_sqr() * (1.0 - pole.conj() * wave).norm_sqr())
}

/// Its mean square.
fn mean_square_of(pole: Complex<f64>) -> f64 {
    let (first, second) = (2.0 * pole.re, pole.norm_sqr());
    (1.0 + second) / ((1.0 - second) * ((1.0 + second).powi(2) - first * first))
}

/// The vibration in a residual, N, NaN where there is no sample; `None` where there is none. `way` is of the cable by rows, `signals` what it does and bears.
pub fn vibration(residual_n: &[f64], times: &Times, way: &[Way], signals: &[Together]) -> Option<Vibration> {
    let spectrum = Spectrum::of(residual_n, times)?;
    let found = loudest(&spectrum, times)?;
    let is_worth_it = found.rms_n().powi(2) > LEAST_SHARE * mean_square(residual_n);
    let is_of_motion = || have_line(&[found.frequency_hz], signals, times).contains(&true);
    let follows_length = || share_of_length(&found, &found.in_signal(residual_n, times), way) > MOST_OF_LENGTH;
    (is_worth_it && !is_of_motion() && !follows_length()).then_some(found)
}

/// The lines that hum: those that keep their phase, in a spectrum in which they are still.
pub fn steady<'a>(lines: &'a [Line], residual_n: &[f64], times: &Times) -> Vec<&'a Line> {
    let Some(spectrum) = Spectrum::of(residual_n, times) else { return lines.iter().collect() };
    let keeps_phase = |line: &&Line| {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place of the spectrum")]
        let place = (line.frequency_hz / times.place_hz()).round() as usize;
        spectrum.line_power(place).is_none_or(|power| line.amplitude().powi(2) > power)
    };
    lines.iter().filter(keeps_phase).collect()
}

/// A part of a spectrum around a frequency.
struct Band<'a> {
    /// Powers of a sample each, of the places from `first` on.
    powers: Vec<f64>,
    first: usize,
    weight: f64,
    times: &'a Times,
}

impl Band<'_> {
    /// The spectra of level, slow part and vibration by place, as Hann's window shows them.
    fn shapes(&self, frequency_hz: f64, damping_ratio: f64) -> [Vec<f64>; 3] {
        let pole = pole(frequency_hz, damping_ratio, self.times.interval_s);
        #[expect(clippy::cast_precision_loss, reason = "a place of the spectrum")]
        let at = |place: usize| place as f64 * self.times.place_hz();
        let places = self.first..self.first + self.powers.len();
        let own = |place: usize| resonance(pole, TAU * at(place) * self.times.interval_s);
        let seen = |place: usize| (own(place - 1) + 4.0 * own(place) + own(place + 1)) / 6.0;
        [
            places.clone().map(seen).collect(),
            vec![1.0; self.powers.len()],
            places.map(|place| (frequency_hz / at(place)).powi(2)).collect(),
        ]
    }

    /// The sizes of greatest likelihood, and −2 times its logarithm. Each step multiplies a size, which makes the likelihood greater
    /// (C. Févotte, J. Idier, *Algorithms for nonnegative matrix factorization with the β-divergence*, Neural Computation 23, 2011).
    fn fit(&self, shapes: &[Vec<f64>; 3], with_oscillator: bool) -> ([f64; 3], f64) {
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let mean = self.powers.iter().sum::<f64>() / self.powers.len() as f64;
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let start = |shape: &Vec<f64>| 0.3 * mean * shape.len() as f64 / shape.iter().sum::<f64>();
        let mut sizes = shapes.each_ref().map(start);
        if !with_oscillator {
            sizes[0] = 0.0;
        }
        let model = |sizes: &[f64; 3], place: usize| -> f64 {
            shapes.iter().zip(sizes).map(|(shape, size)| size * shape[place]).sum()
        };
        for _ in 0..STEPS {
            let models: Vec<f64> = (0..self.powers.len()).map(|place| model(&sizes, place)).collect();
            for (size, shape) in sizes.iter_mut().zip(shapes) {
                let (mut above, mut below) = (0.0, 0.0);
                for ((part, model), power) in shape.iter().zip(&models).zip(&self.powers) {
                    above += part * power / (model * model);
                    below += part / model;
                }
                *size *= (above / below).sqrt();
            }
        }
        let deviance = |(place, power): (usize, &f64)| {
            let model = model(&sizes, place);
            model.ln() + power / model
        };
        let deviance = self.powers.iter().enumerate().map(deviance).sum::<f64>();
        (sizes, 2.0 * self.weight * deviance)
    }
}

/// The oscillator with the most evidence in a spectrum, if there is one.
fn loudest(spectrum: &Spectrum, times: &Times) -> Option<Vibration> {
    let evidence = peaks(spectrum).into_iter().filter_map(|place| oscillator(spectrum, times, place));
    let (found, _) = evidence.min_by(|(_, one), (_, other)| one.total_cmp(other))?;
    Some(found)
}

/// Places where a spectrum stands out from what lies beside, the most first.
fn peaks(spectrum: &Spectrum) -> Vec<usize> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss, reason = "a place")]
    let last = (2.0 * MOST_OF_RATE * spectrum.powers.len() as f64) as usize;
    let sum = |from: usize, to: usize| spectrum.powers.get(from..to).map(|part| part.iter().sum::<f64>());
    // By how much a fiftieth of the frequency to either side is louder than what lies beside it, where chance makes less of a mean of many.
    let stands_out = |place: usize| {
        let half = (place / 50).max(1);
        let inside = sum(place - half, place + half + 1)?;
        let beside = sum(place - 4 * half, place - 2 * half)? + sum(place + 2 * half + 1, place + 4 * half + 1)?;
        #[expect(clippy::cast_precision_loss, reason = "small counts")]
        let [inside, beside, half] = [inside / (2 * half + 1) as f64, beside / (4 * half) as f64, half as f64];
        let by = (inside / beside - 1.0) * (spectrum.stretches * half).sqrt();
        by.is_finite().then_some((place, by))
    };
    let mut places: Vec<(usize, f64)> = (FIRST_PLACE..last).filter_map(stands_out).collect();
    places.sort_by(|(_, one), (_, other)| other.total_cmp(one));
    let mut peaks: Vec<usize> = Vec::new();
    for (place, _) in places {
        if peaks.len() < PEAKS && peaks.iter().all(|peak| 5 * peak.abs_diff(place) > *peak) {
            peaks.push(place);
        }
    }
    peaks
}

/// The oscillator near a place of a spectrum with the evidence for it; `None` where it is not enough.
fn oscillator(spectrum: &Spectrum, times: &Times, place: usize) -> Option<(Vibration, f64)> {
    // A place of the spectrum has the power of both of its signs, in so many samples.
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let samples = (spectrum.powers.len() - 1) as f64;
    let (first, end) = (place / 2, (2 * place).min(spectrum.powers.len() - 1));
    let band = Band {
        powers: spectrum.powers.get(first..end)?.iter().map(|power| samples * power).collect(),
        first,
        weight: INDEPENDENT * spectrum.stretches,
        times,
    };
    let damping = |step: f64| DAMPING[0] * (DAMPING[1] / DAMPING[0]).powf(step / DAMPINGS);
    let fit = |frequency_hz: f64, step: f64| {
        let (sizes, deviance) = band.fit(&band.shapes(frequency_hz, damping(step)), true);
        (Tried { frequency_hz, step, sizes }, deviance)
    };
    // A grid as wide as the peak may be, then finer around what is best there.
    #[expect(clippy::cast_precision_loss, reason = "a place of the spectrum")]
    let (mut hz, mut step) = (place as f64 * times.place_hz(), 0.5 * DAMPINGS);
    let (mut width_hz, mut width) = (times.place_hz(), 0.125 * DAMPINGS);
    let mut found = None;
    while width_hz > FINEST * times.place_hz() {
        let grid = (-FREQUENCIES..=FREQUENCIES).flat_map(|side| (-4..=4).map(move |more| (side, more)));
        let near = grid.map(|(side, more)| (hz + f64::from(side) * width_hz, step + f64::from(more) * width));
        let tried = near.filter(|(_, step)| (0.0..=DAMPINGS).contains(step)).map(|(hz, step)| fit(hz, step));
        let best = tried.min_by(|(_, one), (_, other)| one.total_cmp(other))?;
        (hz, step) = (best.0.frequency_hz, best.0.step);
        found = Some(best);
        (width_hz, width) = (0.25 * width_hz, width / 3.0);
    }
    let (tried, deviance) = found?;
    let (_, without) = band.fit(&band.shapes(tried.frequency_hz, damping(tried.step)), false);
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let evidence = deviance - without + PARAMETERS * (band.weight * band.powers.len() as f64).ln();
    let is_within = tried.step > 0.5 && tried.step < DAMPINGS - 0.5;
    let vibration = || Vibration {
        frequency_hz: tried.frequency_hz,
        damping_ratio: damping(tried.step),
        sizes: tried.sizes,
        interval_s: times.interval_s,
    };
    (is_within && evidence < -STRONG_BIC).then(|| (vibration(), evidence))
}

/// An oscillator that was tried.
struct Tried {
    frequency_hz: f64,
    /// Damping ratio, by its logarithm.
    step: f64,
    sizes: [f64; 3],
}

/// Share of a vibration that is a wave along the cable, of one sign or with that of the motion.
fn share_of_length(found: &Vibration, shown_n: &[f64], way: &[Way]) -> f64 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
    let stride = (1.0 / (SAMPLES_A_TURN * found.frequency_hz * found.interval_s)).max(1.0) as usize;
    let few: Vec<(f64, f64, f64)> = shown_n
        .iter()
        .zip(way)
        .step_by(stride)
        .map(|(shown_n, way)| (*shown_n, way.length_m, sign(way.speed_m_per_s)))
        .filter(|(shown_n, length_m, _)| shown_n.is_finite() && length_m.is_finite())
        .collect();
    let squares: f64 = few.iter().map(|(shown_n, ..)| shown_n * shown_n).sum();
    let [least_m, most_m] = few.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], (_, length_m, _)| {
        [least.min(*length_m), most.max(*length_m)]
    });
    let fastest = way.iter().map(|way| way.speed_m_per_s.abs()).fold(0.0, f64::max);
    let (range_m, first) = (most_m - least_m, found.frequency_hz / fastest);
    if !(range_m > 0.0 && first.is_finite()) {
        return 0.0;
    }
    let share = |waves_a_metre: f64| {
        let mut sums = [Complex::new(0.0, 0.0); 2];
        for (shown_n, length_m, sign) in &few {
            let wave = Complex::from_polar(*shown_n, TAU * waves_a_metre * length_m);
            sums[0] += wave;
            sums[1] += wave * sign;
        }
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let count = few.len() as f64;
        sums.map(|sum| 2.0 * sum.norm_sqr() / (count * squares)).into_iter().fold(0.0, f64::max)
    };
    let waves = std::iter::successors(Some(first), |waves_a_metre| Some(waves_a_metre + 0.5 / range_m));
    waves.take_while(|waves_a_metre| *waves_a_metre < first / LEAST_SPEED).map(share).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::discover::faults::lines::lines;

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
                let of_hum = lines(signal, &times(), &[]);
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
}

//! Spectral lines of a residual: hum, for instance from the mains.
//!
//! A line stands out from its neighbours by many times their median, everywhere in the log; what a moving cable does is broad. What oscillates now and
//! then, such as a ripple of the way at each of a few speeds, is no line: hum does not stop.
//!
//! The phase of a line follows the time, even across lost samples. It starts anew after a long pause and with each log.

use std::f64::consts::TAU;
use std::ops::Range;

use super::passes::Passes;
use super::spectrum::{NEIGHBOURS, Occurrence, STRETCH, Spectrum, Times, Together, goes_on, occurrences};
use crate::recording_fault::{Fault, RecordingFault};

/// By how many times their median it stands out.
const LEAST_RATIO: f64 = 12.0;
/// A line below this many turns in a stretch is no line but a slow change, and as many tell its phase.
const FEWEST_TURNS: usize = 8;
/// Maximum number of lines.
const MOST_LINES: usize = 8;
/// Least share of a line's power that has to be left without what repeats each time the cable passes a place. Harmonics of strokes that take not quite the same
/// time are in no narrow line of the motion.
const LEAST_UNREPEATED: f64 = 0.5;
/// And the least share of the noise's power that one has to have.
pub const LEAST_SHARE: f64 = 0.01;

/// Length of the windows over which the power of a line is compared, in rows, and the number of samples that a window needs, since with fewer it has
/// more noise.
const WINDOW: usize = STRETCH / 4;
const FEWEST_IN_WINDOW: f64 = 512.0;

/// A sine of a fixed frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Its frequency, Hz.
    pub frequency_hz: f64,
    /// The wave in each run of rows.
    waves: Vec<Wave>,
}

/// A line over rows in which it keeps its phase.
#[derive(Clone, Debug, PartialEq)]
struct Wave {
    rows: Range<usize>,
    /// Number of samples that contain it.
    count: f64,
    /// Factors of sine and cosine, in the residual's unit.
    sine: f64,
    cosine: f64,
}

impl Line {
    /// Returns half the peak-to-peak height, as the root mean square over the runs.
    #[must_use]
    pub fn amplitude(&self) -> f64 {
        if let [wave] = self.waves.as_slice() {
            return wave.sine.hypot(wave.cosine);
        }
        let (squares, count) = self.waves.iter().fold((0.0, 0.0), |(squares, count), wave| {
            (squares + wave.count * (wave.sine * wave.sine + wave.cosine * wave.cosine), count + wave.count)
        });
        if count > 0.0 { (squares / count).sqrt() } else { 0.0 }
    }

    /// Returns the line as a recording fault.
    pub fn fault(&self) -> RecordingFault {
        let parameters = vec![("frequency_hz", self.frequency_hz), ("amplitude_n", self.amplitude())];
        RecordingFault { fault: Fault::Hum, parameters, intervals_s: Vec::new() }
    }

    /// Adds the line, times a factor, to one number per row.
    pub fn add_to<'a>(&self, numbers: impl Iterator<Item = &'a mut f64>, factor: f64, times: &Times) {
        let values = self.waves.iter().flat_map(|wave| {
            times.of_run(&wave.rows).iter().map(|place| {
                let (sin, cos) = times.phase(self.frequency_hz, *place).sin_cos();
                wave.sine * sin + wave.cosine * cos
            })
        });
        numbers.zip(values).for_each(|(number, value)| *number += factor * value);
    }
}

/// Returns the lines of a residual that are unrelated to motion and load, the strongest first. The residual is NaN where there is no sample.
pub fn lines(residual: &[f64], times: &Times, signals: &[Together<'_>], passes: &Passes) -> Vec<Line> {
    let mut rest = residual.to_vec();
    let mut lines = Vec::new();
    while lines.len() < MOST_LINES {
        let Some(line) = strongest(&rest, times) else { break };
        line.add_to(rest.iter_mut(), -1.0, times);
        lines.push(line);
    }
    if !lines.is_empty() {
        let frequencies: Vec<f64> = lines.iter().map(|line: &Line| line.frequency_hz).collect();
        // What makes a line that goes on throughout the log does so itself.
        let mut in_motion = occurrences(&frequencies, signals, times).into_iter();
        let unrepeated = passes.less_what_repeats(residual);
        let power = |of: &[f64], line: &Line| project(of, line.frequency_hz, times).amplitude().powi(2);
        let repeats = |line: &Line| power(&unrepeated, line) < LEAST_UNREPEATED * power(residual, line);
        lines.retain(|line| {
            in_motion.next() != Some(Occurrence::Throughout)
                && goes_on(powers(line.frequency_hz, residual, times))
                && !repeats(line)
        });
    }
    lines
}

/// Returns the power of an oscillation of a frequency in each window of the log: 0 where a window has fewer than [`FEWEST_TURNS`] of it.
fn powers(frequency_hz: f64, residual: &[f64], times: &Times) -> Vec<f64> {
    let windows =
        times.runs.iter().flat_map(|run| run.clone().step_by(WINDOW).map(|start| start..(start + WINDOW).min(run.end)));
    let wave =
        |rows: Range<usize>| project_run(residual.get(rows.clone()).unwrap_or_default(), frequency_hz, times, &rows);
    let is_enough = |wave: &Wave| wave.count > FEWEST_IN_WINDOW;
    let power = |wave: Wave| wave.sine * wave.sine + wave.cosine * wave.cosine;
    windows.map(wave).filter(is_enough).map(power).collect()
}

fn strongest(residual: &[f64], times: &Times) -> Option<Line> {
    let spectrum = Spectrum::of(residual, times)?;
    let first = FEWEST_TURNS.max(NEIGHBOURS);
    let candidates = (first..spectrum.powers.len().saturating_sub(1))
        .filter_map(|place| Some((place, *spectrum.powers.get(place)?, spectrum.over_median(place)?)));
    let (place, ..) =
        candidates.filter(|(_, _, ratio)| *ratio > LEAST_RATIO).max_by(|one, other| one.1.total_cmp(&other.1))?;
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let line = refine(residual, place as f64 * times.place_hz(), times.place_hz(), times);
    (0.5 * line.amplitude().powi(2) > LEAST_SHARE * mean_square(residual)).then_some(line)
}

/// Of the numbers that there are.
pub fn mean_square(numbers: &[f64]) -> f64 {
    let (sum, count) = numbers
        .iter()
        .filter(|number| number.is_finite())
        .fold((0.0, 0.0), |(sum, count), number| (sum + number * number, count + 1.0));
    sum / count
}

/// Returns the frequency near a coarse one at which a sine fits best over all runs.
fn refine(residual: &[f64], coarse_hz: f64, width_hz: f64, times: &Times) -> Line {
    // A sine is far narrower in frequency over a whole run than over a segment, so a grid search comes first, then golden section.
    let narrow_hz = 1.0 / (times.longest() * times.interval_s);
    let fit = |frequency_hz: f64| project(residual, frequency_hz, times);
    let (mut low_hz, mut high_hz) = (coarse_hz - 1.5 * width_hz, coarse_hz + 1.5 * width_hz);
    let step_hz = 0.4 * narrow_hz;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
    let count = ((high_hz - low_hz) / step_hz).ceil() as u32;
    let best = (0..=count)
        .map(|k| fit(low_hz + f64::from(k) * step_hz))
        .max_by(|a, b| a.amplitude().total_cmp(&b.amplitude()));
    let Some(best) = best else { return fit(coarse_hz) };
    (low_hz, high_hz) = (best.frequency_hz - step_hz, best.frequency_hz + step_hz);
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    for _ in 0..24 {
        let (left, right) = (high_hz - golden * (high_hz - low_hz), low_hz + golden * (high_hz - low_hz));
        if fit(left).amplitude() < fit(right).amplitude() { low_hz = left } else { high_hz = right }
    }
    fit(0.5 * (low_hz + high_hz))
}

/// Fits a sine of the given frequency in each run.
fn project(residual: &[f64], frequency_hz: f64, times: &Times) -> Line {
    let wave =
        |run: &Range<usize>| project_run(residual.get(run.clone()).unwrap_or_default(), frequency_hz, times, run);
    Line { frequency_hz, waves: times.runs.iter().map(wave).collect() }
}

fn project_run(residual: &[f64], frequency_hz: f64, times: &Times, run: &Range<usize>) -> Wave {
    // The angle grows by one step per row. A rotation costs less than a sine and a cosine.
    let (step_sin, step_cos) = (TAU * frequency_hz * times.interval_s).sin_cos();
    let (mut sin, mut cos, mut expected) = (0.0_f64, 1.0_f64, f64::NAN);
    let (mut ss, mut cc, mut sc, mut sr, mut cr, mut count) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    for (row, (number, place)) in residual.iter().zip(times.of_run(run)).enumerate() {
        if row % STRETCH == 0 || place.to_bits() != expected.to_bits() {
            (sin, cos) = times.phase(frequency_hz, *place).sin_cos();
        }
        if number.is_finite() {
            (ss, cc, sc) = (ss + sin * sin, cc + cos * cos, sc + sin * cos);
            (sr, cr) = (sr + sin * number, cr + cos * number);
            count += 1.0;
        }
        (sin, cos) = (sin * step_cos + cos * step_sin, cos * step_cos - sin * step_sin);
        expected = place + 1.0;
    }
    let determinant = ss * cc - sc * sc;
    #[expect(clippy::cast_precision_loss, reason = "a small constant")]
    let is_told = determinant > 0.0 && count * times.interval_s * frequency_hz >= FEWEST_TURNS as f64;
    let (sine, cosine) =
        if is_told { ((sr * cc - cr * sc) / determinant, (cr * ss - sr * sc) / determinant) } else { (0.0, 0.0) };
    Wave { rows: run.clone(), count, sine, cosine }
}

#[cfg(test)]
mod tests {
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::discover::faults::spectrum::Signal;

    fn noise(seed: u64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        (0..50_000).map(|_| StandardNormal.sample(&mut random)).collect()
    }

    /// Returns the times of one log without gaps.
    fn times(count: usize) -> Times {
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let places = (0..count).map(|place| place as f64).collect();
        Times { places, runs: std::iter::once(0..count).collect(), interval_s: 1e-3 }
    }

    /// Seven rows are lost, and the hum in a second log is twice as high.
    #[test]
    fn hum_keeps_its_phase_over_lost_rows_and_has_one_in_each_log() {
        let mut residual = noise(3);
        let mut of_logs = times(residual.len());
        of_logs.runs = vec![0..30_000, 30_000..residual.len()];
        for (row, place) in of_logs.places.iter_mut().enumerate() {
            *place += if row < 12_345 { 0.0 } else { 7.0 };
            *place -= if row < 30_000 { 0.0 } else { 30_007.0 };
            let (height, phase) = if row < 30_000 { (1.0, 0.4) } else { (2.0, 2.0) };
            residual[row] += height * (TAU * 50.02 * *place * 1e-3 + phase).sin();
        }
        let found = lines(&residual, &of_logs, &[], &Passes::none());
        assert_eq!(found.len(), 1, "{found:?}");
        assert!((found[0].frequency_hz - 50.02).abs() < 1e-3);
        // 30,000 samples have the height 1, and 20,000 have the height 2.
        assert!((found[0].amplitude() - 2.2_f64.sqrt()).abs() < 0.03, "{}", found[0].amplitude());
        found[0].add_to(residual.iter_mut(), -1.0, &of_logs);
        let left = residual.iter().map(|number| number * number).sum::<f64>() / 50_000.0;
        assert!((left - 1.0).abs() < 0.03, "{left}");
    }

    #[test]
    fn finds_hum_and_its_harmonic() {
        let mut residual = noise(1);
        for (cycle, number) in residual.iter_mut().enumerate() {
            #[expect(clippy::cast_precision_loss, reason = "a small count")]
            let time_s = cycle as f64 * 1e-3;
            *number += 1.3 * (TAU * 50.02 * time_s + 0.4).sin() + 0.4 * (TAU * 150.06 * time_s).cos();
        }
        let found = lines(&residual, &times(residual.len()), &[], &Passes::none());
        assert_eq!(found.len(), 2, "{found:?}");
        assert!((found[0].frequency_hz - 50.02).abs() < 1e-3 && (found[0].amplitude() - 1.3).abs() < 0.03);
        assert!((found[1].frequency_hz - 150.06).abs() < 2e-3 && (found[1].amplitude() - 0.4).abs() < 0.03);
        assert!((found[0].waves[0].sine - 1.3 * 0.4_f64.cos()).abs() < 0.05);
    }

    /// A train of pulses has a line at every integer multiple of its frequency, and so has the friction that it causes.
    #[test]
    fn harmonics_of_the_motion_are_no_hum() {
        let mut residual = noise(5);
        let motion: Vec<f64> = (0..residual.len()).map(|cycle| f64::from(u8::from(cycle % 125 < 5))).collect();
        for (cycle, number) in residual.iter_mut().enumerate() {
            #[expect(clippy::cast_precision_loss, reason = "a small count")]
            let time_s = cycle as f64 * 1e-3;
            *number += 0.8 * (TAU * 16.0 * time_s + 0.3).sin() + 0.8 * (TAU * 50.0 * time_s).sin();
        }
        let of_log = times(residual.len());
        assert_eq!(lines(&residual, &of_log, &[], &Passes::none()).len(), 2);
        let signal = |numbers: &[f64]| -> Signal<'static> {
            let numbers = numbers.to_vec();
            Box::new(move |row| numbers[row])
        };
        let found = lines(&residual, &of_log, &[vec![signal(&motion)]], &Passes::none());
        assert_eq!(found.len(), 1, "{found:?}");
        assert!((found[0].frequency_hz - 50.0).abs() < 1e-2);
        // A line in one sensor alone may be that sensor's own hum.
        assert_eq!(lines(&residual, &of_log, &[vec![signal(&motion), signal(&noise(6))]], &Passes::none()).len(), 2);
    }

    /// A motion that oscillates at 50 Hz in its first second only does not cause a line that goes on for the whole of a log.
    #[test]
    fn a_start_of_the_motion_hides_no_hum() {
        let mut residual = noise(7)[..20_000].to_vec();
        let mut motion = noise(8)[..20_000].to_vec();
        for (cycle, (number, way)) in residual.iter_mut().zip(&mut motion).enumerate() {
            #[expect(clippy::cast_precision_loss, reason = "a small count")]
            let wave = (TAU * 50.0 * cycle as f64 * 1e-3).sin();
            *number += wave;
            *way += if cycle < 1000 { 10.0 * wave } else { 0.0 };
        }
        let of_log = times(residual.len());
        let signal = |numbers: Vec<f64>| -> Together<'static> { vec![Box::new(move |row| numbers[row])] };
        let place = (50.0 / of_log.place_hz()).round();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place of the spectrum")]
        let height = Spectrum::of(&motion, &of_log).unwrap().over_median(place as usize).unwrap();
        assert!(height > 10.0, "{height}");
        assert_eq!(lines(&residual, &of_log, &[signal(motion)], &Passes::none()).len(), 1);
        let throughout = residual.iter().zip(noise(9)).map(|(number, noise)| number + noise).collect();
        assert_eq!(lines(&residual, &of_log, &[signal(throughout)], &Passes::none()), []);
    }

    /// A hum that stops for three of five seconds is something else. One whose frequency wanders as that of the mains does is a hum.
    #[test]
    fn hum_does_not_stop() {
        let mut now_and_then = noise(11);
        let mut of_mains = noise(12);
        let mut turns = 0.0;
        for (cycle, (one, other)) in now_and_then.iter_mut().zip(&mut of_mains).enumerate() {
            #[expect(clippy::cast_precision_loss, reason = "a small count")]
            let time_s = cycle as f64 * 1e-3;
            *one += if time_s % 5.0 < 2.0 { (TAU * 50.0 * time_s).sin() } else { 0.0 };
            turns += 1e-3 * (50.0 + 0.02 * (TAU * time_s / 30.0).sin());
            *other += (TAU * turns).sin();
        }
        let of_log = times(now_and_then.len());
        assert_eq!(lines(&now_and_then, &of_log, &[], &Passes::none()), []);
        assert!(
            lines(&of_mains, &of_log, &[], &Passes::none()).iter().all(|line| (line.frequency_hz - 50.0).abs() < 0.1)
        );
        assert!(!lines(&of_mains, &of_log, &[], &Passes::none()).is_empty());
    }

    #[test]
    fn noise_and_wander_have_none() {
        for seed in 0..20 {
            let white = noise(seed);
            assert_eq!(lines(&white, &times(white.len()), &[], &Passes::none()), []);
            let mut level = 0.0;
            let wander: Vec<f64> = white
                .iter()
                .map(|number| {
                    level = 0.997 * level + 0.08 * number;
                    level + 0.3 * number
                })
                .collect();
            assert_eq!(lines(&wander, &times(wander.len()), &[], &Passes::none()), []);
        }
    }
}

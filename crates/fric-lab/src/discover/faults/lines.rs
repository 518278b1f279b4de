//! Spectral lines of a residual: hum, for instance from the mains.
//!
//! The spectrum is Welch's periodogram: the average over overlapping segments under a Hann window. A line exceeds the median of its neighbours many
//! times, everywhere in the log. The motion of a cable is broadband.
//!
//! The phase of a line follows the time, even across lost samples. It starts anew after a long pause and with each log.

use std::f64::consts::TAU;
use std::ops::Range;

use realfft::RealFftPlanner;

use super::{Fault, RecordingFault};
use crate::fit::{CableRecord, Row};
use crate::samples::conditions::sign;

/// Cycles in a segment, and the pause in cycles after which a line starts anew.
const STRETCH: usize = 4096;
/// Number of neighbouring bins on either side that a line is compared with.
const NEIGHBOURS: usize = 24;
/// Width of a line, in bins of the spectrum.
const WIDTH: usize = 3;
/// Minimum ratio of a line to the median of its neighbours.
const LEAST_RATIO: f64 = 12.0;
/// The same minimum for a line of the motion or the load. A lower ratio may be chance in an average of a few tens of spectra.
const MOTION_RATIO: f64 = 4.0;
/// A line has at least this many periods in a segment; below that it is a slow change. The same number of periods is needed to determine its phase.
const FEWEST_TURNS: usize = 8;
/// Maximum number of lines.
const MOST_LINES: usize = 8;
/// Minimum fraction of the noise power that a line must have.
const LEAST_SHARE: f64 = 0.01;

/// A log belongs to the control loop if its sample interval equals the cycle time within this fraction.
const RATE_TOLERANCE: f64 = 0.1;

/// The times of a record's rows, and the runs of rows over which a line keeps its phase.
pub struct Times {
    /// The position of each row since the first of its log, counted in rows of a log without gaps.
    places: Vec<f64>,
    /// Runs of rows with one phase.
    runs: Vec<Range<usize>>,
    interval_s: f64,
}

impl Times {
    /// Returns the times of a record.
    #[must_use]
    pub fn of(record: &CableRecord<'_>) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "a small constant")]
        let is_near = |one: &f64, next: &f64| next - one < STRETCH as f64;
        // A loop that logs each cycle does not jitter as its stamps do. In a log at another rate the stamps are the only information.
        let is_of_loop = (record.interval_s / record.cycle_s - 1.0).abs() < RATE_TOLERANCE;
        let interval_s = if is_of_loop { record.cycle_s } else { record.interval_s };
        let (mut places, mut runs) = (Vec::with_capacity(record.rows.len()), Vec::new());
        for (mut start, rows) in record.logs() {
            let first_s = record.time_s(start);
            let by_stamp = |place: usize| (record.time_s(start + place) - first_s) / interval_s;
            let of_log =
                rows.iter().enumerate().map(|(place, row)| if is_of_loop { row.cycle } else { by_stamp(place) });
            places.extend(of_log);
            for run in places.get(start..).unwrap_or_default().chunk_by(is_near) {
                runs.push(start..start + run.len());
                start += run.len();
            }
        }
        Self { places, runs, interval_s }
    }

    /// The places of the rows of a run.
    fn places(&self, run: &Range<usize>) -> &[f64] {
        self.places.get(run.clone()).unwrap_or_default()
    }

    fn phase(&self, frequency_hz: f64, place: f64) -> f64 {
        TAU * frequency_hz * (place * self.interval_s)
    }

    /// Returns the length of the longest run in rows, including its gaps.
    fn longest(&self) -> f64 {
        let length = |run: &Range<usize>| match self.places(run) {
            [first, .., last] => last - first + 1.0,
            _ => 1.0,
        };
        self.runs.iter().map(length).fold(1.0, f64::max)
    }
}

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
            times.places(&wave.rows).iter().map(|place| {
                let (sin, cos) = times.phase(self.frequency_hz, *place).sin_cos();
                wave.sine * sin + wave.cosine * cos
            })
        });
        numbers.zip(values).for_each(|(number, value)| *number += factor * value);
    }
}

/// Returns the lines of a residual that are unrelated to motion and load, the strongest first. The residual is NaN where there is no sample.
pub fn lines(residual: &[f64], times: &Times, signals: &[Together]) -> Vec<Line> {
    let mut rest = residual.to_vec();
    let mut lines = Vec::new();
    while lines.len() < MOST_LINES {
        let Some(line) = strongest(&rest, times) else { break };
        line.add_to(rest.iter_mut(), -1.0, times);
        lines.push(line);
    }
    if !lines.is_empty() {
        let spectra: Vec<Vec<Vec<f64>>> =
            signals.iter().map(|of| of.iter().filter_map(|signal| spectrum(signal, times)).collect()).collect();
        let have = |of: &Vec<Vec<f64>>, line: &Line| {
            !of.is_empty() && of.iter().all(|spectrum| has_line(spectrum, line.frequency_hz, times))
        };
        lines.retain(|line| !spectra.iter().any(|of| have(of, line)));
    }
    lines
}

/// Signals that indicate a line only if all of them contain it, because each may hum by itself.
pub type Together = Vec<Vec<f64>>;

/// Returns the signals of a cable's motion and load: the motion with the harmonics that a friction law generates from a periodic one, and the load as
/// both of the cable's sensors measure it.
pub fn motion_and_load(record: &CableRecord<'_>) -> Vec<Together> {
    let of = |value: &dyn Fn(&Row) -> f64| record.rows.iter().map(value).collect::<Vec<f64>>();
    let speed_m_per_s = of(&|row| row.signals.speed_m_per_s);
    let change = |pair: &[f64]| pair[1] - pair[0];
    let acceleration = std::iter::once(0.0).chain(speed_m_per_s.windows(2).map(change)).collect();
    vec![
        vec![of(&|row| row.signals.displacement_m)],
        vec![of(&|row| row.signals.displacement_m.abs())],
        vec![of(&|row| sign(row.signals.displacement_m))],
        vec![speed_m_per_s],
        vec![acceleration],
        vec![of(&|row| row.signals.sensor_force_n), of(&|row| row.reference_n)],
    ]
}

/// Whether a spectrum has a line at a frequency.
fn has_line(spectrum: &[f64], frequency_hz: f64, times: &Times) -> bool {
    #[expect(clippy::cast_precision_loss, reason = "a small constant")]
    let place = (frequency_hz * STRETCH as f64 * times.interval_s).round();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place of the spectrum")]
    let place = place as usize;
    (place.saturating_sub(1)..=place + 1)
        .any(|place| over_median(spectrum, place).is_some_and(|ratio| ratio > MOTION_RATIO))
}

/// Returns the ratio of a bin of a spectrum to the median of its neighbours.
fn over_median(spectrum: &[f64], place: usize) -> Option<f64> {
    let around = place.checked_sub(NEIGHBOURS)?..(place + NEIGHBOURS + 1).min(spectrum.len());
    let others = around.filter(|other| other.abs_diff(place) > WIDTH);
    let mut others: Vec<f64> = others.filter_map(|other| spectrum.get(other).copied()).collect();
    if others.is_empty() {
        return None;
    }
    let middle = others.len() / 2;
    let (_, median, _) = others.select_nth_unstable_by(middle, f64::total_cmp);
    Some(spectrum.get(place)? / *median)
}

fn strongest(residual: &[f64], times: &Times) -> Option<Line> {
    let spectrum = spectrum(residual, times)?;
    let first = FEWEST_TURNS.max(NEIGHBOURS);
    let candidates =
        (first..spectrum.len().saturating_sub(1)).filter_map(|place| Some((place, over_median(&spectrum, place)?)));
    let (place, _) = candidates
        .filter(|(_, ratio)| *ratio > LEAST_RATIO)
        .max_by(|a, b| spectrum.get(a.0).unwrap_or(&0.0).total_cmp(spectrum.get(b.0).unwrap_or(&0.0)))?;
    #[expect(clippy::cast_precision_loss, reason = "small counts")]
    let (place, stretch_s) = (place as f64, STRETCH as f64 * times.interval_s);
    let line = refine(residual, place / stretch_s, 1.0 / stretch_s, times);
    let (squares, count) = residual
        .iter()
        .filter(|number| number.is_finite())
        .fold((0.0, 0.0), |(squares, count), number| (squares + number * number, count + 1.0));
    (line.amplitude().powi(2) * 0.5 > LEAST_SHARE * squares / count).then_some(line)
}

/// Returns the averaged periodogram; `None` if no run is as long as a segment.
fn spectrum(residual: &[f64], times: &Times) -> Option<Vec<f64>> {
    let transform = RealFftPlanner::<f64>::new().plan_fft_forward(STRETCH);
    let mut input = transform.make_input_vec();
    let mut output = transform.make_output_vec();
    let mut sums = vec![0.0; output.len()];
    let mut any = false;
    #[expect(clippy::cast_precision_loss, reason = "a small constant")]
    let window = |place: usize| 0.5 - 0.5 * (TAU * place as f64 / STRETCH as f64).cos();
    for run in &times.runs {
        for start in (run.start..(run.end + 1).saturating_sub(STRETCH)).step_by(STRETCH / 2) {
            let stretch = start..start + STRETCH;
            input.fill(0.0);
            let places = times.places(&stretch);
            let first = places.first()?;
            for (place, number) in places.iter().zip(residual.get(stretch.clone())?).filter(|(_, of)| of.is_finite()) {
                // Lost rows leave their positions empty and move the later rows on, the last ones out of the segment.
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
                let place = (place - first).round() as usize;
                if let Some(input) = input.get_mut(place) {
                    *input = number * window(place);
                }
            }
            transform.process(&mut input, &mut output).ok()?;
            for (sum, number) in sums.iter_mut().zip(&output) {
                *sum += number.norm_sqr();
            }
            any = true;
        }
    }
    any.then_some(sums)
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
    for (row, (number, place)) in residual.iter().zip(times.places(run)).enumerate() {
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
        let found = lines(&residual, &of_logs, &[]);
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
        let found = lines(&residual, &times(residual.len()), &[]);
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
        assert_eq!(lines(&residual, &of_log, &[]).len(), 2);
        let found = lines(&residual, &of_log, &[vec![motion.clone()]]);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!((found[0].frequency_hz - 50.0).abs() < 1e-2);
        // A line in one sensor alone may be that sensor's own hum.
        assert_eq!(lines(&residual, &of_log, &[vec![motion, noise(6)]]).len(), 2);
    }

    #[test]
    fn noise_and_wander_have_none() {
        for seed in 0..20 {
            let white = noise(seed);
            assert_eq!(lines(&white, &times(white.len()), &[]), []);
            let mut level = 0.0;
            let wander: Vec<f64> = white
                .iter()
                .map(|number| {
                    level = 0.997 * level + 0.08 * number;
                    level + 0.3 * number
                })
                .collect();
            assert_eq!(lines(&wander, &times(wander.len()), &[]), []);
        }
    }
}

//! Lines in the spectrum of a residual: a hum, as from the mains.
//!
//! The periodogram of Welch: spectra of overlapping stretches under Hann's window, averaged. A line stands out from its
//! neighbours by many times their median, everywhere in the log; what a moving cable does is broad.

use std::f64::consts::TAU;

use realfft::RealFftPlanner;

/// Samples of a stretch.
const STRETCH: usize = 4096;
/// Neighbours on either side that a line is compared with.
const NEIGHBOURS: usize = 24;
/// A line's own width, in places of the spectrum.
const WIDTH: usize = 3;
/// By how many times their median it stands out.
const LEAST_RATIO: f64 = 12.0;
/// A line below this many turns in a stretch is no line but a slow change.
const FEWEST_TURNS: usize = 8;
/// Lines that are looked for.
const MOST_LINES: usize = 8;
/// And the least share of the noise's power that one has to have.
const LEAST_SHARE: f64 = 0.01;

/// A sine of fixed frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Its frequency, Hz.
    pub frequency_hz: f64,
    /// Factors of its sine and cosine, in the residual's unit.
    pub sine: f64,
    /// See `sine`.
    pub cosine: f64,
}

impl Line {
    /// Half its height from peak to peak.
    #[must_use]
    pub fn amplitude(&self) -> f64 {
        self.sine.hypot(self.cosine)
    }

    /// Its value in a cycle.
    #[must_use]
    pub fn at(&self, cycle: usize, cycle_s: f64) -> f64 {
        let (sin, cos) = phase(self.frequency_hz, cycle, cycle_s).sin_cos();
        self.sine * sin + self.cosine * cos
    }
}

fn phase(frequency_hz: f64, cycle: usize, cycle_s: f64) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a count of cycles")]
    let time_s = cycle as f64 * cycle_s;
    TAU * frequency_hz * time_s
}

/// The lines of a residual, the strongest first; NaN where there is no sample.
pub fn lines(residual: &[f64], cycle_s: f64) -> Vec<Line> {
    let mut rest = residual.to_vec();
    let mut lines = Vec::new();
    while lines.len() < MOST_LINES {
        let Some(line) = strongest(&rest, cycle_s) else { break };
        for (cycle, number) in rest.iter_mut().enumerate() {
            *number -= line.at(cycle, cycle_s);
        }
        lines.push(line);
    }
    lines
}

fn strongest(residual: &[f64], cycle_s: f64) -> Option<Line> {
    let spectrum = spectrum(residual)?;
    let ratio = |place: usize| -> Option<f64> {
        let around = place.checked_sub(NEIGHBOURS)?..(place + NEIGHBOURS + 1).min(spectrum.len());
        let mut others: Vec<f64> = around
            .filter(|other| other.abs_diff(place) > WIDTH)
            .filter_map(|other| spectrum.get(other).copied())
            .collect();
        let middle = others.len() / 2;
        let (_, median, _) = others.select_nth_unstable_by(middle, f64::total_cmp);
        Some(spectrum.get(place)? / *median)
    };
    let first = FEWEST_TURNS.max(NEIGHBOURS);
    let candidates = (first..spectrum.len().saturating_sub(1)).filter_map(|place| Some((place, ratio(place)?)));
    let (place, _) = candidates
        .filter(|(_, ratio)| *ratio > LEAST_RATIO)
        .max_by(|a, b| spectrum.get(a.0).unwrap_or(&0.0).total_cmp(spectrum.get(b.0).unwrap_or(&0.0)))?;
    #[expect(clippy::cast_precision_loss, reason = "small counts")]
    let (coarse_hz, width_hz) = (place as f64 / (STRETCH as f64 * cycle_s), 1.0 / (STRETCH as f64 * cycle_s));
    let line = refine(residual, coarse_hz, width_hz, cycle_s);
    let (squares, count) = residual
        .iter()
        .filter(|number| number.is_finite())
        .fold((0.0, 0.0), |(squares, count), number| (squares + number * number, count + 1.0));
    (line.amplitude().powi(2) * 0.5 > LEAST_SHARE * squares / count).then_some(line)
}

/// Averaged periodogram; `None` for a log shorter than a stretch.
fn spectrum(residual: &[f64]) -> Option<Vec<f64>> {
    let transform = RealFftPlanner::<f64>::new().plan_fft_forward(STRETCH);
    let mut input = transform.make_input_vec();
    let mut output = transform.make_output_vec();
    let mut sums = vec![0.0; output.len()];
    let mut any = false;
    #[expect(clippy::cast_precision_loss, reason = "a small constant")]
    let window = |place: usize| 0.5 - 0.5 * (TAU * place as f64 / STRETCH as f64).cos();
    for start in (0..residual.len().saturating_sub(STRETCH - 1)).step_by(STRETCH / 2) {
        let stretch = residual.get(start..start + STRETCH)?;
        for (place, (input, number)) in input.iter_mut().zip(stretch).enumerate() {
            *input = if number.is_finite() { number * window(place) } else { 0.0 };
        }
        transform.process(&mut input, &mut output).ok()?;
        for (sum, number) in sums.iter_mut().zip(&output) {
            *sum += number.norm_sqr();
        }
        any = true;
    }
    any.then_some(sums)
}

/// The frequency near a coarse one at which a sine fits best over the whole log.
fn refine(residual: &[f64], coarse_hz: f64, width_hz: f64, cycle_s: f64) -> Line {
    // Over the whole log a sine is far narrower than over a stretch: a grid first, then golden section.
    #[expect(clippy::cast_precision_loss, reason = "a count of cycles")]
    let narrow_hz = 1.0 / (residual.len() as f64 * cycle_s);
    let fit = |frequency_hz: f64| project(residual, frequency_hz, cycle_s);
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

/// The sine of a frequency that fits best.
fn project(residual: &[f64], frequency_hz: f64, cycle_s: f64) -> Line {
    // The angle grows by one step a cycle: a rotation costs less than a sine and a cosine.
    let (step_sin, step_cos) = (TAU * frequency_hz * cycle_s).sin_cos();
    let (mut sin, mut cos) = (0.0_f64, 1.0_f64);
    let (mut ss, mut cc, mut sc, mut sr, mut cr) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (cycle, number) in residual.iter().enumerate() {
        if cycle % STRETCH == 0 {
            (sin, cos) = phase(frequency_hz, cycle, cycle_s).sin_cos();
        }
        if number.is_finite() {
            (ss, cc, sc) = (ss + sin * sin, cc + cos * cos, sc + sin * cos);
            (sr, cr) = (sr + sin * number, cr + cos * number);
        }
        (sin, cos) = (sin * step_cos + cos * step_sin, cos * step_cos - sin * step_sin);
    }
    let determinant = ss * cc - sc * sc;
    let (sine, cosine) = if determinant > 0.0 {
        ((sr * cc - cr * sc) / determinant, (cr * ss - sr * sc) / determinant)
    } else {
        (0.0, 0.0)
    };
    Line { frequency_hz, sine, cosine }
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

    #[test]
    fn finds_hum_and_its_harmonic() {
        let mut residual = noise(1);
        for (cycle, number) in residual.iter_mut().enumerate() {
            #[expect(clippy::cast_precision_loss, reason = "a small count")]
            let time_s = cycle as f64 * 1e-3;
            *number += 1.3 * (TAU * 50.02 * time_s + 0.4).sin() + 0.4 * (TAU * 150.06 * time_s).cos();
        }
        let found = lines(&residual, 1e-3);
        assert_eq!(found.len(), 2, "{found:?}");
        assert!((found[0].frequency_hz - 50.02).abs() < 1e-3 && (found[0].amplitude() - 1.3).abs() < 0.03);
        assert!((found[1].frequency_hz - 150.06).abs() < 2e-3 && (found[1].amplitude() - 0.4).abs() < 0.03);
        assert!((found[0].sine - 1.3 * 0.4_f64.cos()).abs() < 0.05);
    }

    #[test]
    fn noise_and_wander_have_none() {
        for seed in 0..20 {
            let white = noise(seed);
            assert_eq!(lines(&white, 1e-3), []);
            let mut level = 0.0;
            let wander: Vec<f64> = white
                .iter()
                .map(|number| {
                    level = 0.997 * level + 0.08 * number;
                    level + 0.3 * number
                })
                .collect();
            assert_eq!(lines(&wander, 1e-3), []);
        }
    }
}

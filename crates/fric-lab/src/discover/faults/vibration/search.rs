//! The search for the oscillator with the most evidence in a spectrum.

use std::f64::consts::TAU;

use super::{Vibration, pole, resonance};
use crate::discover::faults::spectrum::{Spectrum, Times};
use crate::discover::naming::STRONG_BIC;

/// Range of the damping ratios tried: from a bell to an oscillation that dies out within a few turns.
const DAMPING: [f64; 2] = [1e-3, 0.12];

/// Number of steps in the logarithm of the damping ratio.
const DAMPINGS: f64 = 16.0;

/// Number of frequencies on either side of a peak.
const FREQUENCIES: i32 = 6;

/// The search ends at this resolution, as a fraction of the spectrum's.
const FINEST: f64 = 0.02;

/// Maximum number of peaks examined; they are at least a fifth of the frequency apart.
const PEAKS: usize = 3;

/// Number of parameters of an oscillator, for the evidence.
const PARAMETERS: f64 = 3.0;

/// First index of the spectrum at which a peak can be distinguished from the part that falls with the frequency.
const FIRST_PLACE: usize = 12;

/// Highest frequency examined, as a fraction of the sampling frequency.
const MOST_OF_RATE: f64 = 0.4;

/// Number of steps in the search for the sizes.
const STEPS: usize = 40;

/// Independent values per index of the periodogram and stretch: Hann's window correlates neighbours, and stretches overlap by half.
const INDEPENDENT: f64 = 0.49;

/// A part of a spectrum around a frequency.
struct Band<'a> {
    /// Power per sample at each index from `first` on.
    powers: Vec<f64>,
    first: usize,
    weight: f64,
    times: &'a Times,
}

impl Band<'_> {
    /// Returns the spectra of vibration, level and slow part by index, as Hann's window shows them.
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

    /// Returns the sizes of greatest likelihood, and −2 times its logarithm. Each step multiplies the sizes, which increases the likelihood
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

/// Returns the oscillator with the most evidence in a spectrum.
pub(super) fn loudest(spectrum: &Spectrum, times: &Times) -> Option<Vibration> {
    let evidence = peaks(spectrum).into_iter().filter_map(|place| oscillator(spectrum, times, place));
    let (found, _) = evidence.min_by(|(_, one), (_, other)| one.total_cmp(other))?;
    Some(found)
}

/// Returns the indices at which a spectrum stands out from its neighbourhood, the strongest first.
fn peaks(spectrum: &Spectrum) -> Vec<usize> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss, reason = "a place")]
    let last = (2.0 * MOST_OF_RATE * spectrum.powers.len() as f64) as usize;
    let sum = |from: usize, to: usize| spectrum.powers.get(from..to).map(|part| part.iter().sum::<f64>());
    // The power within a fiftieth of the frequency on either side, relative to that beside it, in units of its scatter.
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

/// Returns the oscillator near an index of a spectrum, and its evidence; `None` if that is too weak.
fn oscillator(spectrum: &Spectrum, times: &Times, place: usize) -> Option<(Vibration, f64)> {
    // A value of the spectrum has the power of both signs of its frequency, over this many samples.
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
    // A grid as wide as the peak may be, then finer grids around the best point.
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

/// A fitted oscillator of the grid.
struct Tried {
    frequency_hz: f64,
    /// Step of the damping ratio.
    step: f64,
    sizes: [f64; 3],
}

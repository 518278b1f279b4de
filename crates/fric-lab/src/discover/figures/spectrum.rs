//! Spectrum and autocorrelation of a residual: its periodic content and its memory.
//!
//! The spectrum follows Welch: the mean of the periodograms of segments that overlap by half, each with a Hann window and its mean removed,
//! one-sided, as amplitude density in N/√Hz. Samples that do not count, and pauses, end a segment. If no stretch is long enough for a segment, the
//! spectrum is empty.

use realfft::RealFftPlanner;

/// Maximum and minimum number of samples in a segment. The length is halved until a stretch is long enough.
const SEGMENT: [usize; 2] = [8192, 128];
/// A gap longer than this many sample intervals is a pause.
const PAUSE: f64 = 1.5;
/// Maximum number of products averaged for one lag.
const MOST_PRODUCTS: usize = 50_000;
/// Number of lags of an autocorrelation.
const LAGS: usize = 200;

/// Amplitude density over frequency.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spectrum {
    /// Frequencies, Hz, from the first above 0.
    pub frequency_hz: Vec<f64>,
    /// Amplitude densities, N/√Hz.
    pub density: Vec<f64>,
}

/// Correlation of a residual with its own delayed copy.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Autocorrelation {
    /// Delays, s, starting at 0.
    pub lag_s: Vec<f64>,
    /// Correlations, −1 to 1.
    pub correlation: Vec<f64>,
    /// Half the width of the 95 % interval of white noise around 0.
    pub white: f64,
}

/// Returns the median time between two samples, s; `None` for fewer than two.
fn interval_s(times_s: &[f64]) -> Option<f64> {
    let mut intervals: Vec<f64> =
        times_s.windows(2).map(|pair| pair[1] - pair[0]).filter(|interval_s| *interval_s > 0.0).collect();
    let middle = intervals.len() / 2;
    (!intervals.is_empty()).then(|| *intervals.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Returns stretches of finite samples without a pause.
fn stretches<'a>(times_s: &[f64], residual_n: &'a [f64], interval_s: f64) -> Vec<&'a [f64]> {
    let mut all = Vec::new();
    let mut start = 0;
    for place in 0..=residual_n.len() {
        let is_end = place == residual_n.len();
        let is_missing = !is_end && !residual_n[place].is_finite();
        let is_pause = !is_end && place > start && times_s[place] - times_s[place - 1] > PAUSE * interval_s;
        if is_end || is_missing || is_pause {
            all.extend(residual_n.get(start..place).filter(|stretch| !stretch.is_empty()));
            start = if is_missing { place + 1 } else { place };
        }
    }
    all
}

/// Returns the spectrum of a residual, N, at these times. The residual is NaN where a sample does not count.
#[must_use]
pub fn spectrum(times_s: &[f64], residual_n: &[f64]) -> Spectrum {
    let Some(interval_s) = interval_s(times_s).filter(|_| times_s.len() == residual_n.len()) else {
        return Spectrum::default();
    };
    let stretches = stretches(times_s, residual_n, interval_s);
    let longest = stretches.iter().map(|stretch| stretch.len()).max().unwrap_or(0);
    let [mut size, least] = SEGMENT;
    while size > longest && size > least {
        size /= 2;
    }
    if size > longest {
        return Spectrum::default();
    }
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let (count, number) = (size as f64, |index: usize| index as f64);
    let window: Vec<f64> =
        (0..size).map(|index| 0.5 - 0.5 * (std::f64::consts::TAU * number(index) / count).cos()).collect();
    let power: f64 = window.iter().map(|weight| weight * weight).sum();
    let transform = RealFftPlanner::<f64>::new().plan_fft_forward(size);
    let (mut input, mut output) = (transform.make_input_vec(), transform.make_output_vec());
    let (mut sums, mut segments) = (vec![0.0; size / 2 + 1], 0.0);
    for stretch in stretches {
        for start in (0..).step_by(size / 2).take_while(|start| start + size <= stretch.len()) {
            let segment = &stretch[start..start + size];
            let mean = segment.iter().sum::<f64>() / count;
            for ((place, value), weight) in input.iter_mut().zip(segment).zip(&window) {
                *place = (value - mean) * weight;
            }
            if transform.process(&mut input, &mut output).is_err() {
                return Spectrum::default();
            }
            for (sum, bin) in sums.iter_mut().zip(&output) {
                *sum += bin.norm_sqr();
            }
            segments += 1.0;
        }
    }
    // The one-sided density combines both signs of a frequency, except at half the sampling rate.
    let sides = |index: usize| if index == size / 2 { 1.0 } else { 2.0 };
    let density = |(index, sum): (usize, &f64)| (sides(index) * sum / segments / power * interval_s).sqrt();
    Spectrum {
        frequency_hz: (1..=size / 2).map(|index| number(index) / (count * interval_s)).collect(),
        density: sums.iter().enumerate().skip(1).map(density).collect(),
    }
}

/// Returns the autocorrelation of a residual up to the longest lag.
#[must_use]
pub fn autocorrelation(times_s: &[f64], residual_n: &[f64], longest_s: f64) -> Autocorrelation {
    let Some(interval_s) = interval_s(times_s).filter(|_| times_s.len() == residual_n.len()) else {
        return Autocorrelation::default();
    };
    let finite = || residual_n.iter().copied().filter(|value| value.is_finite());
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let count = finite().count() as f64;
    let mean = finite().sum::<f64>() / count;
    let variance = finite().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
    if variance.is_nan() || variance <= 0.0 {
        return Autocorrelation::default();
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "counts")]
    let longest = ((longest_s / interval_s) as usize).min(residual_n.len() / 4);
    let step = longest.div_ceil(LAGS).max(1);
    let stride = residual_n.len().div_ceil(MOST_PRODUCTS).max(1);
    let mut result = Autocorrelation { white: 1.96 / count.sqrt(), ..Autocorrelation::default() };
    for lag in (0..=longest).step_by(step) {
        let (mut sum, mut pairs) = (0.0, 0.0);
        for (one, other) in residual_n.iter().zip(residual_n.iter().skip(lag)).step_by(stride) {
            let product = (one - mean) * (other - mean);
            if product.is_finite() {
                sum += product;
                pairs += 1.0;
            }
        }
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        result.lag_s.push(lag as f64 * interval_s);
        result.correlation.push(sum / pairs / variance);
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times_s(count: u32) -> Vec<f64> {
        (0..count).map(|index| f64::from(index) * 1e-3).collect()
    }

    #[test]
    fn a_sine_has_its_power_at_its_frequency() {
        let times_s = times_s(40_000);
        let sine: Vec<f64> = times_s.iter().map(|time_s| 0.3 * (std::f64::consts::TAU * 50.0 * time_s).sin()).collect();
        let Spectrum { frequency_hz, density } = spectrum(&times_s, &sine);
        let step_hz = frequency_hz[0];
        // Parseval: the area under the power density is the mean square, 0.3²/2.
        let power: f64 = density.iter().map(|value| value * value * step_hz).sum();
        assert!((power - 0.045).abs() < 0.045 * 0.01, "{power}");
        let peak = (0..density.len()).max_by(|one, other| density[*one].total_cmp(&density[*other])).unwrap();
        assert!((frequency_hz[peak] - 50.0).abs() <= step_hz);
        let Autocorrelation { lag_s, correlation, .. } = autocorrelation(&times_s, &sine, 0.1);
        for (lag_s, correlation) in lag_s.iter().zip(correlation) {
            let expected = (std::f64::consts::TAU * 50.0 * lag_s).cos();
            assert!((correlation - expected).abs() < 0.01, "{lag_s}: {correlation}");
        }
    }

    #[test]
    fn gaps_end_segments_and_too_little_is_nothing() {
        let times_s = times_s(3000);
        let mut residual_n: Vec<f64> = times_s.iter().map(|time_s| (300.0 * time_s).sin()).collect();
        residual_n[1000] = f64::NAN;
        let stretch_lengths: Vec<usize> = stretches(&times_s, &residual_n, 1e-3).iter().map(|one| one.len()).collect();
        assert_eq!(stretch_lengths, [1000, 1999]);
        assert_eq!(spectrum(&times_s, &residual_n).frequency_hz.len(), 512);
        assert_eq!(spectrum(&times_s[..100], &residual_n[..100]), Spectrum::default());
        assert_eq!(autocorrelation(&times_s, &vec![0.0; 3000], 1.0), Autocorrelation::default());
    }
}

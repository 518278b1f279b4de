//! How late one signal is behind another, by any time and to within the width of a bin.
//!
//! Both are averaged over bins of equal width. For each lag the squared correlation `r²` over the bins that both then have is computed by FFT; bins
//! without a sample count nowhere. The lag with the greatest `r²` is told if it leaves at most a ninth of the variance that is left without a lag, `1 − r²`,
//! and if the changes of both go together there by more than chance (Fisher): `(n − 3)·artanh²(r) > 2·ln(lags) + 10`. Changes, not values, as two loads that
//! rise and fall slowly match somewhere. `n` is Bartlett's number of independent bins, `N/Σ ρ₁ρ₂`: a load that repeats itself, as one sine does, has too
//! few of them, as friction would make much of it look late.

use realfft::RealFftPlanner;

use crate::text::listed;

/// Greatest number of bins; beyond it two become one. A log of an hour has bins of 0.32 s.
const MOST_BINS: usize = 1 << 14;
/// Width of a bin at first, ns.
const FIRST_WIDTH_NANOS: i64 = 20_000_000;
/// Part of the bins with samples of both signals behind which the next one has too, at least; else two become one, as in a log that is slower than the bins.
const LEAST_FULL_RATIO: f64 = 0.9;
/// Least ratio of the variances that are left, without a lag and with it. Friction that goes with the rate of a load looks late: the square wave of a dry
/// contact under a sine has 5.3. Half of it would tell that, twice as much misses a lag where friction makes a tenth of the load's variation.
const LEAST_RATIO: f64 = 9.0;
/// Bins by which a signal is late, at least.
const LEAST_BINS: usize = 3;
/// Bins that both signals have at the lag, at least, as a part of those without a lag.
const LEAST_SHARED_RATIO: f64 = 0.5;
/// Bins from one value to the next of a change: some tenths of a second, in which a load changes by more than noise.
const CHANGE_BINS: usize = 8;
/// Independent bins that the correlation itself takes (Fisher).
const FITTED: f64 = 3.0;
/// Part by which times of several cables may differ and count as the same.
const SAME_RATIO: f64 = 0.1;
/// Evidence beyond chance, as for a name.
const STRONG: f64 = 10.0;

/// Sum and count of a signal in a bin.
#[derive(Clone, Copy, Debug, Default)]
struct Mean {
    sum: f64,
    count: f64,
}

impl Mean {
    fn add(&mut self, value: f64) {
        if value.is_finite() {
            self.sum += value;
            self.count += 1.0;
        }
    }

    fn join(self, other: Self) -> Self {
        Self { sum: self.sum + other.sum, count: self.count + other.count }
    }

    /// Returns the mean; NaN of nothing.
    fn value(self) -> f64 {
        self.sum / self.count
    }
}

/// Two signals, averaged over bins.
#[derive(Clone, Debug)]
pub struct Lateness {
    start_nanos: Option<i64>,
    width_nanos: i64,
    bins: Vec<[Mean; 2]>,
}

impl Default for Lateness {
    fn default() -> Self {
        Self { start_nanos: None, width_nanos: FIRST_WIDTH_NANOS, bins: Vec::new() }
    }
}

impl Lateness {
    /// Adds a sample of both signals, NaN where one is unknown. Samples before the first one are left out.
    pub fn add(&mut self, stamp_nanos: i64, values: [f64; 2]) {
        let start_nanos = *self.start_nanos.get_or_insert(stamp_nanos);
        let since_nanos = stamp_nanos.saturating_sub(start_nanos);
        let place = loop {
            let Ok(place) = usize::try_from(since_nanos / self.width_nanos) else { return };
            if place < MOST_BINS {
                break place;
            }
            self.widen();
        };
        if self.bins.len() <= place {
            self.bins.resize(place + 1, Default::default());
        }
        if let Some(means) = self.bins.get_mut(place) {
            means.iter_mut().zip(values).for_each(|(mean, value)| mean.add(value));
        }
    }

    /// Makes one bin of two.
    fn widen(&mut self) {
        let one_of_two = |two: &[[Mean; 2]]| match *two {
            [one, other] => [one[0].join(other[0]), one[1].join(other[1])],
            _ => two.first().copied().unwrap_or_default(),
        };
        self.bins = self.bins.chunks(2).map(one_of_two).collect();
        self.width_nanos *= 2;
    }

    /// Returns by how much the second signal is behind the first, s, negative if it is ahead; `None` if they agree as they are or agree nowhere.
    #[must_use]
    pub fn seconds(&self) -> Option<f64> {
        let mut bins = self.clone();
        let is_full = |means: &[Mean; 2]| means.iter().all(|mean| mean.count > 0.0);
        #[expect(clippy::cast_precision_loss, reason = "counts of bins")]
        let is_sparse = |bins: &[[Mean; 2]]| {
            let after_full = || bins.windows(2).filter(|pair| is_full(&pair[0]));
            (after_full().filter(|pair| is_full(&pair[1])).count() as f64)
                < LEAST_FULL_RATIO * after_full().count() as f64
        };
        while bins.bins.len() > 2 * LEAST_BINS && is_sparse(&bins.bins) {
            bins.widen();
        }
        let levels: Vec<[f64; 2]> = bins.bins.iter().map(|means| means.map(Mean::value)).collect();
        let [level, change] = [Correlations::of(&levels)?, Correlations::of(&changes(&levels))?];
        let lag = level.lag().filter(|lag| change.is_more_than_chance(*lag))?;
        #[expect(clippy::cast_precision_loss, reason = "a count of bins, and a width in ns")]
        Some(lag as f64 * (bins.width_nanos as f64 * 1e-9))
    }
}

/// Returns the changes from bin to bin, NaN where one of the two is unknown.
fn changes(levels: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let ends = levels.iter().zip(levels.iter().skip(CHANGE_BINS));
    ends.map(|(from, to)| [to[0] - from[0], to[1] - from[1]]).collect()
}

/// Returns warnings about cables whose references are late by so many seconds, or early. Those that are off by the same share a line.
pub fn warnings<'a>(cables: impl Iterator<Item = (&'a str, Option<f64>)>) -> Vec<String> {
    let mut found: Vec<(f64, Vec<&str>)> = Vec::new();
    for (name, late_s) in cables.filter_map(|(name, late_s)| Some((name, late_s?))) {
        match found.iter_mut().find(|(of_s, _)| (of_s - late_s).abs() <= SAME_RATIO * late_s.abs()) {
            Some((_, names)) => names.push(name),
            None => found.push((late_s, vec![name])),
        }
    }
    let warning = |(late_s, names): (f64, Vec<&str>)| {
        let [references, agree, forces, they_are] = match names.as_slice() {
            [_] => ["reference", "agrees", "sensor's force", "it is"],
            _ => ["references", "agree", "sensors' forces", "they are"],
        };
        format!(
            "the {references} of {} {agree} with the {forces} only if {they_are} taken for {:.2} s {}: their clocks differ; `replay --correct` and `fit` \
             put a reference where it belongs",
            listed(&names),
            late_s.abs(),
            if late_s > 0.0 { "earlier" } else { "later" }
        )
    };
    found.into_iter().map(warning).collect()
}

/// Sums over the bins that two signals share, by lag: the count, the sums of both, of their squares and of their product.
struct Correlations {
    sums: [Vec<f64>; 6],
    independent_ratio: f64,
}

impl Correlations {
    fn of(bins: &[[f64; 2]]) -> Option<Self> {
        let length = (2 * bins.len()).next_power_of_two();
        let mut planner = RealFftPlanner::<f64>::new();
        let (forward, inverse) = (planner.plan_fft_forward(length), planner.plan_fft_inverse(length));
        let spectrum = |value: &dyn Fn(&[f64; 2]) -> f64| {
            let mut room = forward.make_input_vec();
            room.iter_mut().zip(bins).for_each(|(room, values)| *room = value(values));
            let mut spectrum = forward.make_output_vec();
            forward.process(&mut room, &mut spectrum).ok().map(|()| spectrum)
        };
        let mean_of = |signal: usize| {
            let known = || bins.iter().map(|values| values[signal]).filter(|value| value.is_finite());
            known().sum::<f64>() / known().map(|_| 1.0).sum::<f64>()
        };
        let around = [mean_of(0), mean_of(1)];
        let power = |signal: usize, exponent: i32| {
            let around = around[signal];
            spectrum(&|values| {
                let value = values[signal] - around;
                if value.is_finite() { value.powi(exponent) } else { 0.0 }
            })
        };
        let [one, other] = [0, 1].map(|signal| [0, 1, 2].map(|exponent| power(signal, exponent)));
        let [Some(one_0), Some(one_1), Some(one_2)] = one else { return None };
        let [Some(other_0), Some(other_1), Some(other_2)] = other else { return None };
        #[expect(clippy::cast_precision_loss, reason = "a count of bins")]
        let scale = 1.0 / length as f64;
        // `Σ one[t]·other[t + lag]`, negative lags at the end.
        let product = |one: &[_], other: &[_]| {
            let mut both: Vec<realfft::num_complex::Complex<f64>> = one
                .iter()
                .zip(other)
                .map(|(one, other): (&realfft::num_complex::Complex<f64>, _)| one.conj() * other)
                .collect();
            // Rounding may leave these not quite real.
            for end in [0, both.len() - 1] {
                if let Some(end) = both.get_mut(end) {
                    end.im = 0.0;
                }
            }
            let mut sums = inverse.make_output_vec();
            inverse.process(&mut both, &mut sums).ok()?;
            Some(sums.into_iter().map(|sum| sum * scale).collect::<Vec<f64>>())
        };
        let [own, others] = [(&one_1, &one_1), (&other_1, &other_1)].map(|(one, other)| product(one, other));
        let (own, others) = (own?, others?);
        let zero = own.first()? * others.first()?;
        let together: f64 = own.iter().zip(&others).map(|(own, other)| own * other).sum();
        let sums = [
            product(&one_0, &other_0)?,
            product(&one_1, &other_0)?,
            product(&one_0, &other_1)?,
            product(&one_2, &other_0)?,
            product(&one_0, &other_2)?,
            product(&one_1, &other_1)?,
        ];
        (zero > 0.0 && together > 0.0).then(|| Self { sums, independent_ratio: (zero / together).min(1.0) })
    }

    /// Returns the count of shared bins at a lag, and the part of the variance that is left, `1 − r²`; all of it if the signals do not rise and fall together.
    fn left(&self, lag: isize) -> Option<(f64, f64)> {
        let length = self.sums[0].len();
        let place = if lag < 0 { length.checked_sub(lag.unsigned_abs())? } else { lag.unsigned_abs() };
        let [count, one, other, one_2, other_2, both] = self.sums.each_ref().map(|sums| sums.get(place).copied());
        let (count, one, other) = (count?.round(), one?, other?);
        if count < 1.0 {
            return None;
        }
        let covariance = both? - one * other / count;
        let [one_2, other_2] = [one_2? - one * one / count, other_2? - other * other / count];
        let is_known = covariance > 0.0 && one_2 > 0.0 && other_2 > 0.0;
        Some((
            count,
            if is_known { (1.0 - covariance * covariance / (one_2 * other_2)).max(f64::EPSILON) } else { 1.0 },
        ))
    }

    /// Returns the lags at which enough bins are shared, and what is left at each.
    fn lags(&self) -> Option<Vec<(isize, f64)>> {
        let (all, _) = self.left(0)?;
        let half = isize::try_from(self.sums[0].len() / 4).ok()?;
        let shared = |lag: isize| {
            let (count, left) = self.left(lag)?;
            (count >= LEAST_SHARED_RATIO * all).then_some((lag, left))
        };
        Some((-half..=half).filter_map(shared).collect())
    }

    /// Returns the lag at which least is left, if that is far less than without one. A load that repeats itself leaves as little at several, of which the
    /// shortest is returned.
    fn lag(&self) -> Option<isize> {
        let (_, left_0) = self.left(0)?;
        let lags = self.lags()?;
        let (_, least) = lags.iter().copied().min_by(|(_, one), (_, other)| one.total_cmp(other))?;
        let is_alike = |(lag, left): &(isize, f64)| {
            self.left(*lag).is_some_and(|(count, _)| self.independent_ratio * count * (left / least).ln() < STRONG)
        };
        let is_lowest = |(place, (_, left)): &(usize, &(isize, f64))| {
            let around = lags.iter().skip(place.saturating_sub(CHANGE_BINS)).take(2 * CHANGE_BINS + 1);
            around.copied().all(|(_, other)| *left <= other)
        };
        let lowest = lags.iter().enumerate().filter(is_lowest).map(|(_, lag)| *lag).filter(is_alike);
        let (lag, left) = lowest.min_by_key(|(lag, _)| lag.unsigned_abs())?;
        (lag.unsigned_abs() >= LEAST_BINS && left_0 >= LEAST_RATIO * left).then_some(lag)
    }

    fn is_more_than_chance(&self, lag: isize) -> bool {
        let Some(((count, left), lags)) = self.left(lag).zip(self.lags()) else { return false };
        #[expect(clippy::cast_precision_loss, reason = "a count of lags")]
        let chance = 2.0 * (lags.len() as f64).ln() + STRONG;
        (self.independent_ratio * count - FITTED) * (1.0 - left).sqrt().atanh().powi(2) > chance
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng as _;
    use rand_distr::{Distribution as _, StandardNormal};

    /// The lag of a signal that wanders with a memory of half a second, in 40 s of samples every `interval_s`, with friction of a tenth.
    fn found(interval_s: f64, late_s: f64, noise: f64) -> Option<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let mut normal = move || -> f64 { StandardNormal.sample(&mut random) };
        let fine: Vec<f64> = std::iter::repeat_with(&mut normal)
            .take(120_000)
            .scan(0.0, |load, push| {
                *load = 0.998 * *load + push;
                Some(*load)
            })
            .collect();
        let load = |time_s: f64| {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place within the load")]
            let place = ((time_s + 20.0) * 1000.0) as usize;
            fine[place]
        };
        let mut both = Lateness::default();
        let times_s = (0..).map(|sample: u32| f64::from(sample) * interval_s).take_while(|time_s| *time_s < 40.0);
        for time_s in times_s {
            let force_n = load(time_s) + 3.0 * (0.7 * time_s).sin().signum() + noise * normal();
            #[expect(clippy::cast_possible_truncation, reason = "a time in ns")]
            both.add((time_s * 1e9) as i64, [1.03 * force_n + 4.0, load(time_s - late_s) + noise * normal()]);
        }
        both.seconds()
    }

    #[test]
    fn a_lag_of_any_time_is_found_and_none_where_there_is_none() {
        for interval_s in [0.001, 0.004, 0.031] {
            let short_s = if interval_s < 0.01 { [0.2, -0.2] } else { [0.8, -0.8] };
            for late_s in [1.0, 7.3, 15.0, -12.0].into_iter().chain(short_s) {
                let Some(lag_s) = found(interval_s, late_s, 1.0) else { panic!("{interval_s} {late_s}") };
                assert!((lag_s - late_s).abs() <= 0.1, "{lag_s} for {late_s} every {interval_s} s");
            }
            assert_eq!([0.0, 0.03, 25.0].map(|late_s| found(interval_s, late_s, 1.0)), [None; 3]);
        }
        // Nothing but noise.
        assert_eq!(found(0.004, 5.0, 1e4), None);
    }

    /// A load that repeats itself every 5.7 s is late by 0.2 s as it would be early by 5.5 s, or late by 5.9 s.
    #[test]
    fn of_lags_that_a_repeated_load_leaves_alike_the_shortest_is_told() {
        for (seed, late_s) in [(1, 0.2), (2, -0.2), (3, 0.0), (4, 0.2), (5, -0.2)] {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let mut normal = move || -> f64 { StandardNormal.sample(&mut random) };
            let load_n = |time_s: f64| 12.0 * (TAU * time_s / 5.7).sin() + 6.0 * (TAU * time_s / 1.9).sin();
            let mut both = Lateness::default();
            for sample in 0_i32..12_000 {
                let time_s = 0.01 * f64::from(sample);
                both.add(
                    i64::from(sample) * 10_000_000,
                    [load_n(time_s) + normal(), load_n(time_s - late_s) + normal()],
                );
            }
            assert!(
                both.seconds().is_none_or(|told_s| (told_s - late_s).abs() < 0.05),
                "{late_s}: {:?}",
                both.seconds()
            );
        }
    }

    #[test]
    fn friction_and_gaps_are_no_lag() {
        // A sine with viscous friction: any sine is another one shifted.
        let (mut sine, mut gaps) = (Lateness::default(), Lateness::default());
        for sample in 0..40_000_i32 {
            let angle = 0.0015 * f64::from(sample);
            let stamp_nanos = i64::from(sample) * 1_000_000;
            sine.add(stamp_nanos, [angle.sin() + 0.4 * angle.cos(), angle.sin()]);
            let load = (7.0 * angle).sin() + (2.3 * angle * angle / 60.0).sin();
            let known = sample % 7000 < 3000;
            gaps.add(stamp_nanos, [load + 0.3 * (5.0 * angle).cos().signum(), if known { load } else { f64::NAN }]);
        }
        assert_eq!([sine.seconds(), gaps.seconds()], [None; 2]);
        // A stamp years later leaves one bin for all.
        gaps.add(i64::MAX, [1.0, 1.0]);
        assert_eq!(gaps.seconds(), None);
        assert_eq!(Lateness::default().seconds(), None);
    }
}

//! A residual over one operating condition, before and after the extension.

use crate::fit::CableRecord;
use crate::samples::bins::Bins;
use crate::samples::conditions::{Condition, Spacing, sign};

/// Maximum number of bins in a figure.
const MOST_BINS: usize = 32;

/// Two residuals over one condition.
#[derive(Clone, Debug)]
pub struct Profile {
    /// The condition.
    pub signal: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// The bins, in ascending order of the condition.
    pub bins: Vec<ProfileBin>,
    /// Whether the bins have equal widths; otherwise they hold equal numbers of samples.
    pub are_even: bool,
}

/// One bin of the condition.
#[derive(Clone, Copy, Debug)]
pub struct ProfileBin {
    /// Lower edge, in the condition's unit.
    pub from: f64,
    /// Upper edge, in the condition's unit.
    pub to: f64,
    /// Residual of the given model.
    pub before: ProfileCell,
    /// Residual of the extended model.
    pub after: ProfileCell,
}

/// A residual in one bin.
#[derive(Clone, Copy, Debug)]
pub struct ProfileCell {
    /// Mean while the cable pays out, N; NaN without a sample.
    pub paying_out_n: f64,
    /// Mean while the cable reels in, N; NaN without a sample.
    pub reeling_in_n: f64,
    /// Root mean square over all directions, N.
    pub rms_n: f64,
}

#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    /// Sample counts: paying out, reeling in, all directions.
    counts: [f64; 3],
    totals: [f64; 2],
    squares: f64,
}

impl Sums {
    fn add(&mut self, direction: f64, residual_n: f64) {
        let place = if direction > 0.0 { Some(0) } else { (direction < 0.0).then_some(1) };
        if let Some(place) = place {
            self.counts[place] += 1.0;
            self.totals[place] += residual_n;
        }
        self.counts[2] += 1.0;
        self.squares += residual_n * residual_n;
    }

    fn cell(&self) -> ProfileCell {
        let [out, back, all] = self.counts;
        ProfileCell {
            paying_out_n: self.totals[0] / out,
            reeling_in_n: self.totals[1] / back,
            rms_n: (self.squares / all).sqrt(),
        }
    }
}

/// Returns both residuals, N, over a condition; they are NaN where a sample does not count. Returns `None` if the condition is constant.
pub fn profile(
    record: &CableRecord<'_>,
    condition: &Condition<'_>,
    before_n: &[f64],
    after_n: &[f64],
) -> Option<Profile> {
    let condition = &condition.with_at_most(MOST_BINS);
    let bins = Bins::new(condition, before_n)?;
    let mut sums = vec![[Sums::default(); 2]; bins.count()];
    let samples = condition.values().zip(record.rows).zip(before_n.iter().zip(after_n));
    for ((value, row), (before_n, after_n)) in samples {
        let direction = sign(row.signals.displacement_m);
        let Some(sums) = bins.of(value).and_then(|bin| sums.get_mut(bin)) else { continue };
        for (sums, residual_n) in sums.iter_mut().zip([before_n, after_n]) {
            if residual_n.is_finite() {
                sums.add(direction, *residual_n);
            }
        }
    }
    let edges = bins.edges.windows(2).zip(&sums);
    let bins = edges.filter_map(|(edges, [before, after])| {
        let [from, to] = *edges else { return None };
        Some(ProfileBin { from, to, before: before.cell(), after: after.cell() })
    });
    let are_even = matches!(condition.bins, Spacing::Widths(_));
    Some(Profile { signal: condition.signal, unit: condition.unit, bins: bins.collect(), are_even })
}

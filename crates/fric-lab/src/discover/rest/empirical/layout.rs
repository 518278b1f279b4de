//! Layouts of tables: over which condition and range, and what they change; and their fit with the penalty that predicts best.

use fric_core::effects::Effect;
use fric_core::effects::empirical::{Over, RATIO, SHARE_PLACES, SIZE};
use fric_core::parameters::{MU, Values};

use super::normal::Rows;
use super::without_table;
use super::words::signal_of;
use crate::discover::rest::places::Place;
use crate::discover::workbench::{Model, Workbench};
use crate::fit::Parameter;
use crate::search::problem::Problem;

/// Fractions of the samples that the range of a table leaves out at either end: all samples except outliers, or the central part with more closely
/// spaced points.
const TAIL_RATIOS: [f64; 2] = [0.002, 0.05];
/// A part of a condition's range gets a table of its own if it is narrower than this fraction of the range. Such a table extends beyond the part by
/// this fraction of its width.
const NARROW_RATIO: f64 = 0.5;
const MARGIN_RATIO: f64 = 1.0;
/// Maximum number of rows used to choose and to check. Longer logs are decimated.
const MOST_ROWS: usize = 60_000;

/// What a table changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Changes {
    /// The force at the platform.
    Force,
    /// The friction.
    Friction,
}

/// A table to try: its range and what it changes.
#[derive(Clone, Debug)]
pub struct Layout {
    pub over: Over,
    pub range: [f64; 2],
    pub changes: Changes,
}

/// Returns the value of a table's condition in each cycle.
pub fn condition(bench: &Workbench<'_>, over: Over) -> Vec<f64> {
    let gain = bench.record.params.frictionless_gain();
    let of = |row: &crate::fit::Row| match over {
        Over::Speed => row.signals.speed_m_per_s,
        Over::Length => row.signals.length_m,
        Over::Load => gain * row.signals.sensor_force_n,
    };
    bench.record.rows.iter().map(of).collect()
}

/// Returns every table to try.
pub fn candidates(bench: &Workbench<'_>, base: &Model, residual_n: &[f64], places: &[Place]) -> Vec<Layout> {
    let slides = base.values[MU] > 0.0;
    let mut layouts = Vec::new();
    for over in Over::ALL {
        let values = condition(bench, over);
        let known = values.iter().zip(residual_n).filter(|(value, residual_n)| (*value + *residual_n).is_finite());
        let mut sorted: Vec<f64> = known.map(|(value, _)| *value).collect();
        sorted.sort_by(f64::total_cmp);
        let within = |tail_ratio: f64| {
            #[expect(clippy::cast_precision_loss, reason = "a count")]
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below a count")]
            let tail = (tail_ratio * sorted.len() as f64) as usize;
            let (from, to) = (*sorted.get(tail)?, *sorted.get(sorted.len().checked_sub(tail + 1)?)?);
            (from < to).then_some([from, to])
        };
        let Some([from, to]) = within(TAIL_RATIOS[0]) else { continue };
        let mut ranges: Vec<[f64; 2]> = TAIL_RATIOS.into_iter().filter_map(within).collect();
        let narrow = places.iter().filter(|place| signal_of(over) == place.signal && over == Over::Length);
        for place in narrow.filter(|place| place.to - place.from < NARROW_RATIO * (to - from)) {
            let margin = MARGIN_RATIO * (place.to - place.from);
            ranges.push([(place.from - margin).max(from), (place.to + margin).min(to)]);
        }
        for range in ranges {
            layouts.push(Layout { over, range, changes: Changes::Force });
            if slides {
                layouts.push(Layout { over, range, changes: Changes::Friction });
            }
        }
    }
    layouts
}

impl Layout {
    /// Returns a model's values with this table, with the given size and shares.
    pub fn set(&self, base: &Values, size: f64, shares: &[f64]) -> Values {
        let mut values = without_table(base);
        values[match self.changes {
            Changes::Force => SIZE,
            Changes::Friction => RATIO,
        }] = size;
        [values[self.over.from()], values[self.over.to()]] = self.range;
        for (place, share) in SHARE_PLACES.zip(shares) {
            values[place] = *share;
        }
        values
    }

    /// Returns the same from the changes, in N or as fractions of μ, scaled so that the greatest share is 1.
    pub fn scaled(&self, base: &Values, changes: &[f64]) -> Values {
        let greatest = changes.iter().fold(0.0, |most: f64, change| most.max(change.abs()));
        let size = if greatest > 0.0 { greatest } else { 1.0 };
        let shares: Vec<f64> = changes.iter().map(|change| (change / size).clamp(-1.0, 1.0)).collect();
        self.set(base, size, &shares)
    }

    /// Returns what a model's table changes at each of its points.
    pub fn changes_of(&self, values: &Values) -> Vec<f64> {
        let size = values[match self.changes {
            Changes::Force => SIZE,
            Changes::Friction => RATIO,
        }];
        SHARE_PLACES.map(|place| size * values[place]).collect()
    }

    /// Returns the derivatives of a model with this table, at a size of 1, with respect to the free parameters and the shares.
    pub fn rows(&self, bench: &Workbench<'_>, base: &Model, values: &Values) -> Rows {
        let mut free = base.free.clone();
        free.extend(shares());
        let size = values[if self.changes == Changes::Force { SIZE } else { RATIO }];
        let problem = Problem { used: bench.counts.to_vec(), ..bench.problem(&free, None) };
        let used: Vec<usize> = (0..bench.counts.len()).filter(|cycle| bench.counts[*cycle]).collect();
        let stride = used.len().div_ceil(MOST_ROWS).max(1);
        let blocks = block_of_each(bench);
        let (first_share, width) = (base.free.len(), free.len() + 1);
        let mut rows = Rows {
            width,
            first_share,
            numbers: Vec::new(),
            cycles: Vec::new(),
            blocks: Vec::new(),
            held_out: Vec::new(),
        };
        let mut place = 0;
        problem.rows(&[*values], |row| {
            let cycle = used.get(place).copied();
            place += 1;
            let Some((cycle, block)) = cycle.and_then(|cycle| Some((cycle, blocks.get(cycle).copied().flatten()?)))
            else {
                return;
            };
            if (place - 1) % stride != 0 || row.len() != width || row.iter().any(|number| !number.is_finite()) {
                return;
            }
            rows.numbers.extend(row.iter().enumerate().map(|(column, number)| {
                if column >= first_share && column + 1 < width { number / size } else { *number }
            }));
            rows.cycles.push(cycle);
            rows.blocks.push(block);
            rows.held_out.push(bench.blocks.get(block).is_some_and(|block| block.held_out));
        });
        rows
    }
}

/// Returns the parameters of the shares.
pub fn shares() -> impl Iterator<Item = Parameter> {
    Parameter::of(Effect::Empirical).filter(|parameter| SHARE_PLACES.contains(&parameter.place()))
}

/// Returns the block of each cycle.
fn block_of_each(bench: &Workbench<'_>) -> Vec<Option<usize>> {
    let mut blocks = vec![None; bench.counts.len()];
    for (place, block) in bench.blocks.iter().enumerate() {
        if let Some(cycles) = blocks.get_mut(block.cycles.clone()) {
            cycles.fill(Some(place));
        }
    }
    blocks
}

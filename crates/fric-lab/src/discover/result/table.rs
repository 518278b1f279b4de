//! The table of a rest without a name.

use fric_core::effects::Effect;
use fric_core::effects::empirical::{Over, RATIO, SHARE_PLACES, SHARES, SIZE};
use serde::Serialize;

use super::finite;
use crate::discover::report::Model;
use crate::discover::rest::empirical;
use crate::fit::Parameter;

/// A table for a rest without a name: its size and position.
#[derive(Clone, Debug, Serialize)]
pub struct TableResult {
    /// `unnamed`: a table is no explanation.
    pub status: &'static str,
    /// `force` at the platform, N, or `friction`, a change of μ as a share of it.
    pub changes: &'static str,
    /// Unit of the tabulated values.
    pub value_unit: &'static str,
    /// The condition that the table is over.
    pub over: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Points of the table. Values are interpolated linearly between them and constant beyond the first and the last.
    pub points: Vec<TablePoint>,
    /// Physical causes that look like the table.
    pub looks_like: Vec<&'static str>,
}

/// One point of a table.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct TablePoint {
    /// Value of the condition.
    pub at: f64,
    /// Value of the table there.
    pub value: f64,
    /// Standard error of the value, by the scatter of the log's blocks.
    pub standard_error: Option<f64>,
}

impl TableResult {
    /// Creates the table of a model, if it has one.
    pub(super) fn of(model: &Model) -> Option<Self> {
        let value = |place: usize| model.values[place];
        let over = Over::of(value)?;
        let (from, to) = (value(over.from()), value(over.to()));
        let (size, changes, value_unit) =
            if value(SIZE).abs() > 0.0 { (value(SIZE), "force", "N") } else { (value(RATIO), "friction", "1") };
        let shares = Parameter::of(Effect::Empirical).filter(|parameter| SHARE_PLACES.contains(&parameter.place()));
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let points = shares.enumerate().map(|(place, share)| TablePoint {
            at: from + (to - from) * place as f64 / (SHARES - 1) as f64,
            value: size * value(share.place()),
            standard_error: model.standard_error(&share).and_then(|error| finite(size.abs() * error)),
        });
        Some(Self {
            status: "unnamed",
            changes,
            value_unit,
            over: empirical::signal_of(over),
            unit: over.unit(),
            points: points.collect(),
            looks_like: empirical::looks_like(over, changes == "force").to_vec(),
        })
    }
}

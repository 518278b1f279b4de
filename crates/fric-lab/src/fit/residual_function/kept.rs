//! A residual function as plain numbers, for transfer to another process.

use std::sync::Arc;

use fric_core::CableParams;

use super::{Cable, ResidualFunction};
use crate::samples::record::{ROW_WIDTH, Row};
use crate::search::vector::Parameter;

/// The data of a residual function except the parameters of its cable.
#[derive(Clone, Debug)]
pub struct KeptFunction {
    /// The free parameters.
    pub free: Vec<Parameter>,
    /// Start values of all parameters of the model.
    pub start: Vec<f64>,
    /// Cycles of all logs: eight numbers each, and one number with a bit for each fault and for being used.
    pub rows: Vec<[f64; Self::WIDTH]>,
    /// Index of the first cycle of each log.
    pub log_starts: Vec<usize>,
    /// Cycle time, s.
    pub cycle_s: f64,
    /// Time between two rows, s.
    pub interval_s: f64,
    /// Whether the reference is known rather than measured.
    pub reference_is_known: bool,
}

impl KeptFunction {
    /// Count of numbers per row.
    pub const WIDTH: usize = ROW_WIDTH;
}

impl ResidualFunction {
    /// Returns the data of the function.
    #[must_use]
    pub fn kept(&self) -> KeptFunction {
        let Cable { params: _, rows, references_n, starts, cycle_s, interval_s, reference_is_known } =
            self.cable.as_ref();
        let all = rows.iter().zip(references_n).zip(&self.used);
        KeptFunction {
            free: self.free.clone(),
            start: self.start.to_vec(),
            rows: all.map(|((row, reference_n), used)| row.to_numbers(*reference_n, *used)).collect(),
            log_starts: starts.clone(),
            cycle_s: *cycle_s,
            interval_s: *interval_s,
            reference_is_known: *reference_is_known,
        }
    }

    /// Restores the function from its data, for a cable with the same parameters. Returns `None` if `start` has another length than the model's
    /// values.
    #[must_use]
    pub fn from_kept(params: &CableParams, kept: KeptFunction) -> Option<Self> {
        let KeptFunction { free, start, rows, log_starts, cycle_s, interval_s, reference_is_known } = kept;
        let (rows, references_n, used): (Vec<Row>, Vec<f64>, Vec<bool>) = rows.iter().map(Row::from_numbers).collect();
        let (params, starts) = (*params, log_starts);
        let cable = Cable { params, rows, references_n, starts, cycle_s, interval_s, reference_is_known };
        Some(Self { cable: Arc::new(cable), free, given: params.values(), start: start.try_into().ok()?, used })
    }
}

//! The residuals of \[P\] 18 as a function of the parameters, for use with other optimisers.

mod kept;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use fric_core::CableParams;
use fric_core::parameters::Values;

pub use kept::KeptFunction;

use super::FitOptions;
use super::cables::{Search, prepared};
use crate::samples::cable::CableRecord;
use crate::samples::record::Row;
use crate::samples::selection::Standing;
use crate::search::gang::Gang;
use crate::search::problem::{Comparison, Loss, Member, Problem};
use crate::search::vector::{Coordinate, Parameter, with};

/// Residuals `f(p) − f_ref`, N, of a cable's sound samples, and their derivatives, as functions of its free parameters.
///
/// The samples are those that [`fit_cables`](super::fit_cables) ends with: flagged samples, samples without a reference, and the warm-up, which
/// follows from the friction found, are left out. Outliers are kept. The function owns its samples; copies share them.
#[derive(Clone, Debug)]
pub struct ResidualFunction {
    cable: Arc<Cable>,
    free: Vec<Parameter>,
    given: Values,
    start: Values,
    used: Vec<bool>,
}

impl ResidualFunction {
    /// Creates the function of a cable, with the free parameters that `options` selects.
    #[must_use]
    pub fn new(record: &CableRecord<'_>, options: &FitOptions) -> Self {
        let given = record.params.values();
        let free = options.free(record.params);
        let stop = AtomicBool::new(false);
        let gang = Gang::new(1, &stop);
        let Search { start, standings, .. } = Search::run(record, &prepared(record), options, &stop, gang.seat(0));
        let counts = |standing: &Standing| [Standing::Used, Standing::Outlier].contains(standing);
        let used = standings.iter().map(counts).collect();
        Self { cable: Arc::new(Cable::of(record)), free, given, start, used }
    }

    /// Returns the free parameters, in the order of the arguments.
    #[must_use]
    pub fn parameters(&self) -> &[Parameter] {
        &self.free
    }

    /// Returns start values from the data.
    #[must_use]
    pub fn start(&self) -> Vec<f64> {
        self.free.iter().map(|parameter| self.start[parameter.place()]).collect()
    }

    /// Returns the least and the greatest value of each parameter that the model accepts.
    #[must_use]
    pub fn bounds(&self) -> Vec<(f64, f64)> {
        self.free.iter().map(|parameter| Coordinate::of(parameter, self.cable.cycle_s).range()).collect()
    }

    /// Returns the number of residuals.
    #[must_use]
    pub fn count(&self) -> usize {
        self.used.iter().filter(|used| **used).count()
    }

    /// Returns the index in the record of each residual's sample.
    pub fn samples(&self) -> impl Iterator<Item = usize> {
        self.used.iter().enumerate().filter(|(_, used)| **used).map(|(place, _)| place)
    }

    /// Returns the residuals, N. Surplus values are ignored; missing ones default to the cable's own.
    #[must_use]
    pub fn residuals(&self, values: &[f64]) -> Vec<f64> {
        let mut residuals = Vec::with_capacity(self.count());
        self.with_problem(|problem| {
            let values = [with(&self.given, &self.free, values.iter().copied())];
            problem.residuals(&values, |_, of_sample| residuals.extend(of_sample));
        });
        residuals
    }

    /// Returns the derivatives, row by row: N per unit of each parameter.
    #[must_use]
    pub fn jacobian(&self, values: &[f64]) -> Vec<f64> {
        let mut rows = Vec::with_capacity(self.count() * self.free.len());
        self.with_problem(|problem| {
            let values = [with(&self.given, &self.free, values.iter().copied())];
            problem.rows(&values, |row| rows.extend(row.iter().take(self.free.len())));
        });
        rows
    }

    fn with_problem(&self, run: impl FnOnce(&Problem<'_>)) {
        let stop = AtomicBool::new(false);
        run(&Problem {
            members: vec![Member { record: self.cable.record(), free: self.free.clone() }],
            comparison: Comparison::Forces,
            loss: Loss::Squares,
            used: self.used.clone(),
            stop: &stop,
            seat: None,
        });
    }
}

/// An owned copy of a cable's record.
#[derive(Clone, Debug)]
struct Cable {
    params: CableParams,
    rows: Vec<Row>,
    references_n: Vec<f64>,
    starts: Vec<usize>,
    cycle_s: f64,
    interval_s: f64,
    reference_is_known: bool,
}

impl Cable {
    fn of(record: &CableRecord<'_>) -> Self {
        let starts = record.logs().map(|(start, _)| start).collect();
        let CableRecord { params, rows, references_n, cycle_s, interval_s, reference_is_known, .. } = *record;
        let (rows, references_n) = (rows.to_vec(), references_n.to_vec());
        Self { params: *params, rows, references_n, starts, cycle_s, interval_s, reference_is_known }
    }

    fn record(&self) -> CableRecord<'_> {
        CableRecord {
            params: &self.params,
            rows: &self.rows,
            references_n: &self.references_n,
            starts: &self.starts,
            times_s: &[],
            cycle_s: self.cycle_s,
            interval_s: self.interval_s,
            reference_is_known: self.reference_is_known,
            length_play_m: 0.0,
            per_log: None,
            noise_reach: 1,
            added_noise: None,
        }
    }
}

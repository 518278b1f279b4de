//! The starts of candidates and their columns of the least-squares problem.

use std::ops::Range;
use std::sync::Arc;

use fric_core::effects::Effect;
use fric_core::parameters::Values;

use crate::candidates::catalogue::fitted;
use crate::discover::wrench::bench::Bench;
use crate::search::pass::{Forces, Part};
use crate::search::stream::Stream;

/// One start of the search for an effect on a cable.
pub struct Start {
    pub cable: usize,
    pub effect: Effect,
    pub values: Values,
    /// Whether it is not the model itself. It has one more column then: the change from the model to the start.
    pub is_elsewhere: bool,
    /// Its columns among those of the cable: changes of the cable's force.
    pub columns: Range<usize>,
}

/// The columns of all starts. They come along with the log, because series of them would take up far more memory than the log.
pub struct Columns<'a> {
    pub starts: &'a [Start],
    /// The forces of the starts.
    stream: Stream<'a>,
    /// The forces of the model, by cable.
    current: &'a [Arc<Forces>],
    /// The columns of each cable in the cycle reached.
    of_cables: Vec<Vec<f64>>,
}

impl<'a> Columns<'a> {
    pub fn new(bench: &Bench<'a>, starts: &'a [Start], current: &'a [Arc<Forces>]) -> Self {
        let part = |start: &Start| {
            let record = *bench.records.get(start.cable)?;
            Some(Part { record, values: start.values, free: fitted(start.effect) })
        };
        let stream = Stream::new(starts.iter().filter_map(part).collect());
        Self { starts, stream, current, of_cables: vec![Vec::new(); bench.records.len()] }
    }

    /// Returns the number of columns of a cable.
    pub fn count(&self, cable: usize) -> usize {
        let of_cable = self.starts.iter().filter(|start| start.cable == cable);
        of_cable.map(|start| start.columns.end).max().unwrap_or(0)
    }

    /// Goes on to a cycle, which must not be before the last one.
    pub fn advance_to(&mut self, cycle: usize) {
        self.stream.advance_to(cycle);
        self.of_cables.iter_mut().for_each(Vec::clear);
        for (place, start) in self.starts.iter().enumerate() {
            let (force_n, derivatives) = self.stream.at(place, cycle);
            let now_n = self.current.get(start.cable).map_or(f64::NAN, |forces| forces.at(cycle).0);
            let Some(columns) = self.of_cables.get_mut(start.cable) else { continue };
            columns.extend_from_slice(derivatives);
            columns.extend(start.is_elsewhere.then_some(force_n - now_n));
        }
    }

    /// Returns the columns of a cable.
    pub fn of_cable(&self, cable: usize) -> &[f64] {
        self.of_cables.get(cable).map_or(&[], Vec::as_slice)
    }

    /// Returns the columns of a start.
    pub fn of_start(&self, start: &Start) -> &[f64] {
        self.of_cable(start.cable).get(start.columns.clone()).unwrap_or_default()
    }
}

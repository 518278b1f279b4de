//! The error of the model's shapes: its segments are arcs with a small deflection, where the backbone is an elastica.
//!
//! The error repeats in every sample, so the statistics of a run cannot show it. It is computed: the elastica under the same tensions, less the model. Its
//! part along the unknowns is their systematic error.

use super::evaluation::{Evaluation, RunEvaluation};
use crate::simulate::elastica_along;

/// Maximum number of shapes to compute in a run. Between them the last one stands for the others: tensions change slowly.
const MOST_SHAPES: usize = 100;

/// Returns the disks of the elastica minus those of the model, x and y alternating, m: run by run and sample by sample; 0 where one has no shape.
pub fn arc_error_m(evaluation: &Evaluation) -> Vec<Vec<Vec<f64>>> {
    evaluation.runs.iter().map(of_run).collect()
}

fn of_run(run: &RunEvaluation) -> Vec<Vec<f64>> {
    let Some((params, shapes)) = run.shown() else { return Vec::new() };
    let stride = shapes.len().div_ceil(MOST_SHAPES).max(1);
    let computed: Vec<&_> = shapes.iter().step_by(stride).collect();
    let elastica = elastica_along(params, computed.iter().map(|shape| shape.tension_n.as_slice()));
    let off = elastica.zip(&computed).map(|(disk_m, shape)| {
        let disk_m = disk_m.filter(|_| shape.status.has_shape()).unwrap_or_else(|| shape.disk_position_m.clone());
        let places = disk_m.iter().zip(&shape.disk_position_m);
        places.flat_map(|([x_m, y_m], [model_x_m, model_y_m])| [x_m - model_x_m, y_m - model_y_m]).collect()
    });
    let off: Vec<Vec<f64>> = off.collect();
    (0..shapes.len()).filter_map(|place| off.get(place / stride)).cloned().collect()
}

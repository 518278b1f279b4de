//! A run by all ways of friction for which it has what they need.

use fric_core::continuum::{ManipulatorParams, ShapeStatus, Tendon};

use super::error::ContinuumError;
use super::gratings::GratingSample;
use super::run::Run;
use super::shape_errors::{ComputedShape, ShapeErrors, Way, shapes};

/// A run by one way.
#[derive(Clone, Debug, PartialEq)]
pub struct WayShapes {
    /// Which.
    pub way: Way,
    /// Sample by sample.
    pub shapes: Vec<ComputedShape>,
    /// Over all samples.
    pub errors: ShapeErrors,
}

/// Computes a run by all ways for which it has what they need: `none`, `coulomb` and `history` the tension at the base, `measured` the
/// gratings, in the order of [`Way::ALL`].
///
/// # Errors
/// [`ContinuumError::MissingGroup`] if it has neither, [`ContinuumError::OverCapacity`] for a tension at which the tendon may break, and
/// [`ContinuumError::BeyondModel`] for a sample for which no way has a shape within the model.
pub fn compare(
    params: &ManipulatorParams,
    run: &Run,
    measured: Option<&[GratingSample]>,
) -> Result<Vec<WayShapes>, ContinuumError> {
    if !run.has_tension() && measured.is_none() {
        return Err(ContinuumError::MissingGroup {
            what: "tension",
            consequence: "no shape follows from it",
            remedy: "`tension_base_n`, or the shifts of calibrated gratings",
        });
    }
    run.check_capacity(params.capacity_n(Tendon::Agonist))?;
    let samples = run.samples();
    let is_possible = |way: Way| if way == Way::Measured { measured.is_some() } else { run.has_tension() };
    let all: Vec<WayShapes> = Way::ALL
        .into_iter()
        .filter(|way| is_possible(*way))
        .map(|way| {
            let shapes = shapes(params, samples, way, measured.unwrap_or_default())?;
            let mut errors = ShapeErrors::default();
            for (shape, sample) in shapes.iter().zip(samples) {
                errors.add(shape, &sample.marker_m);
            }
            Ok(WayShapes { way, shapes, errors })
        })
        .collect::<Result<_, ContinuumError>>()?;
    for (place, sample) in samples.iter().enumerate() {
        let statuses = all.iter().filter_map(|way| way.shapes.get(place)).map(|shape| shape.status);
        let mut beyond = statuses.clone().filter(|status| is_beyond(*status));
        if statuses.clone().count() > 0
            && statuses.clone().all(is_beyond)
            && let Some(status) = beyond.next()
        {
            let tension_n = sample.tension_base_n;
            return Err(ContinuumError::BeyondModel { row: place + 1, time_s: sample.time_s, tension_n, status });
        }
    }
    Ok(all)
}

/// Whether there is no shape, or one in which disks would touch.
pub(super) fn is_beyond(status: ShapeStatus) -> bool {
    !status.has_shape() || status.contains(ShapeStatus::DISKS_TOUCH)
}

/// So many of the samples for which `is_right` holds, spread evenly from the first to the last: the shapes of a figure.
#[must_use]
pub fn spread(sample_count: usize, count: usize, is_right: impl Fn(usize) -> bool) -> Vec<usize> {
    let right: Vec<usize> = (0..sample_count).filter(|&place| is_right(place)).collect();
    let last = right.len().saturating_sub(1);
    let mut places: Vec<usize> =
        (1..=count).filter_map(|part| right.get(part * last / count.max(1)).copied()).collect();
    places.dedup();
    places
}

//! Computes a run by all friction models whose inputs it contains.

use fric_tendon::{ManipulatorParams, ShapeStatus};

use super::base_noise::{BaseNoise, steadied};
use super::begin::Begin;
use super::error::ContinuumError;
use super::friction::distributions;
use super::gratings::GratingSample;
use super::run::Run;
use super::shape_errors::{ComputedShape, ShapeErrors, Way, shapes, shapes_by};

/// A run computed by one friction model.
#[derive(Clone, Debug, PartialEq)]
pub struct WayShapes {
    /// The friction model.
    pub way: Way,
    /// The shapes, sample by sample.
    pub shapes: Vec<ComputedShape>,
    /// The errors over all samples.
    pub errors: ShapeErrors,
    /// Noise that was taken off the tension at the base, which only the history is sensitive to.
    pub base_noise: Option<BaseNoise>,
    /// What the holes hold at the beginning of a run under tension, by the history.
    pub begin: Option<Begin>,
}

/// Computes a run by those friction models whose inputs it contains, in the order of [`Way::ALL`]: `none`, `coulomb` and `history` need the tension
/// at the base, `measured` needs the gratings.
///
/// # Errors
/// Returns [`ContinuumError::MissingGroup`] if it contains the inputs of none, [`ContinuumError::OverCapacity`] for a tension at which the tendon may
/// break, and [`ContinuumError::BeyondModel`] for a sample for which no friction model has a shape.
pub fn compare(
    params: &ManipulatorParams,
    run: &Run,
    measured: Option<&[GratingSample]>,
    wanted: &[Way],
) -> Result<Vec<WayShapes>, ContinuumError> {
    let is_possible = |way: Way| if way == Way::Measured { measured.is_some() } else { run.has_tension() };
    let ways: Vec<Way> = Way::ALL.into_iter().filter(|way| wanted.contains(way) && is_possible(*way)).collect();
    if ways.is_empty() {
        let remedy = match (wanted.contains(&Way::Measured), wanted == [Way::Measured]) {
            (_, true) => "the shifts of calibrated gratings",
            (true, false) => "`tension_base_n`, or the shifts of calibrated gratings",
            (false, false) => "`tension_base_n`",
        };
        return Err(ContinuumError::MissingGroup { what: "tension", consequence: "no shape follows from it", remedy });
    }
    run.check_sizes(params)?;
    let samples = run.samples();
    let all: Vec<WayShapes> = ways
        .into_iter()
        .map(|way| {
            let (steady, base_noise) = if way == Way::History { steadied(run) } else { (run.clone(), None) };
            let mut begin = if way == Way::History { Begin::of(params, &steady, measured)? } else { None };
            let shapes = match &mut begin {
                Some(begin) => {
                    let shapes = shapes_by(begin.model(params)?, steady.samples(), way, &[]);
                    begin.count(&shapes);
                    shapes
                }
                None => shapes(params, steady.samples(), way, measured.unwrap_or_default())?,
            };
            let mut errors = ShapeErrors::default();
            for (shape, sample) in shapes.iter().zip(samples) {
                errors.add(shape, &sample.marker_m);
            }
            Ok(WayShapes { way, shapes, errors, base_noise, begin })
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

/// Returns `count` of the samples for which `is_right` holds, spread evenly from the first to the last: the shapes of a figure.
#[must_use]
pub fn spread(sample_count: usize, count: usize, is_right: impl Fn(usize) -> bool) -> Vec<usize> {
    let right: Vec<usize> = (0..sample_count).filter(|&place| is_right(place)).collect();
    let last = right.len().saturating_sub(1);
    let mut places: Vec<usize> =
        (1..=count).filter_map(|part| right.get(part * last / count.max(1)).copied()).collect();
    places.dedup();
    places
}

/// A selection of a run's shapes to show.
#[derive(Clone, Debug, PartialEq)]
pub enum Selection {
    /// This many, spread over the run.
    Spread(usize),
    /// This many of those in which the gratings show friction in both directions with certainty.
    Mixed(usize),
    /// Those nearest to these times, s.
    At(Vec<f64>),
}

impl Selection {
    /// Returns the indices of the samples.
    ///
    /// # Errors
    /// Returns [`ContinuumError::NotWithinRun`] for a time before or after the run, and [`ContinuumError::MissingGroup`] if the gratings are needed
    /// but missing.
    pub fn places(&self, run: &Run, measured: Option<&[GratingSample]>) -> Result<Vec<usize>, ContinuumError> {
        let samples = run.samples();
        match self {
            Self::Spread(count) => Ok(spread(samples.len(), *count, |_| true)),
            Self::Mixed(count) => {
                let measured = measured.ok_or(ContinuumError::MissingGroup {
                    what: "calibrated gratings",
                    consequence: "it is not known where directions differ",
                    remedy: "them, or name times",
                })?;
                let differ: Vec<bool> = distributions(run, measured).map(|one| one.directions_differ).collect();
                Ok(spread(samples.len(), *count, |place| differ.get(place) == Some(&true)))
            }
            Self::At(times_s) => times_s.iter().map(|time_s| nearest(run, *time_s)).collect(),
        }
    }
}

/// Returns the sample nearest to a time within the run.
fn nearest(run: &Run, time_s: f64) -> Result<usize, ContinuumError> {
    let samples = run.samples();
    let ends = samples.first().zip(samples.last());
    let (from_s, to_s) = ends.map_or((f64::NAN, f64::NAN), |(first, last)| (first.time_s, last.time_s));
    if !(from_s..=to_s).contains(&time_s) {
        return Err(ContinuumError::NotWithinRun { time_s, from_s, to_s });
    }
    let behind = samples.partition_point(|sample| sample.time_s < time_s);
    let distance_s = |place: usize| samples.get(place).map_or(f64::INFINITY, |one| (one.time_s - time_s).abs());
    let before = behind.saturating_sub(1);
    Ok(if distance_s(before) < distance_s(behind) { before } else { behind })
}

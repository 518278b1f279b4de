//! Results of the analysis of a manipulator, for machines (`serde`) and as tables for people.

mod calibration;
mod friction;
mod hole;
mod shape;
mod track;

pub use calibration::{CalibrationResult, GratingResult};
pub use friction::{BridgedGrating, FrictionResult, FrictionSeries, HoleSummary};
pub use hole::HoleResult;
pub use shape::{ErrorResult, PickedShape, ShapeResult, WayErrors, WaySeries, WayShape};
pub use track::{TrackErrors, TrackResult, TrackSimulation};

/// Returns the time intervals in which a condition holds, from the first to the last sample of each, s.
pub(crate) fn intervals_s(time_s: &[f64], holds: impl Iterator<Item = bool>) -> Vec<[f64; 2]> {
    let mut intervals: Vec<[f64; 2]> = Vec::new();
    let mut was = false;
    for (time_s, holds) in time_s.iter().zip(holds) {
        match intervals.last_mut() {
            Some(last) if holds && was => last[1] = *time_s,
            _ if holds => intervals.push([*time_s; 2]),
            _ => {}
        }
        was = holds;
    }
    intervals
}

/// Formats the first few intervals for people.
fn intervals_text(intervals: &[[f64; 2]]) -> String {
    const MOST: usize = 3;
    let shown: Vec<String> = intervals.iter().take(MOST).map(|[from, to]| format!("{from} … {to} s")).collect();
    let more = if intervals.len() > MOST { format!(" and {} more", intervals.len() - MOST) } else { String::new() };
    shown.join(", ") + &more
}

/// Formats a length in mm, or a dash.
fn millimetres(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:.2}"))
}

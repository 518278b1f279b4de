//! `track`: a path of goals on a simulated manipulator.

use fric_tendon::Goal;
use fric_tendon_lab::follow::Goals;
use fric_tendon_lab::simulate::track::{Track, TrackOptions, TrackedGoal, track as track_path};
use pyo3::prelude::*;

use super::Manipulator;
use super::static_model::goals;
use crate::arguments::{argument, frozen};
use crate::arrays::{Axis, array};
use crate::errors::Outcome;
use crate::results;

/// A path of goals on a simulated manipulator whose true physics differ from the model, with the commands of each friction model: "none", "coulomb"
/// in the direction of each change, and "history".
///
/// Goals are bends, rad, (N,), or positions of the tip, base frame, m, (N, 2); pass one of them. For a bend, the tip's goal is its position at that
/// bend of a single pull. There is no feedback. The μ of each hole is within `±mu_spread_ratio` of the stated one, which the commands do not know.
/// Equal seeds give equal numbers.
///
/// >>> arm = continuum.Manipulator.read("examples/tendon-prototype.toml")
/// >>> path = continuum.track(arm, bend_rad=[0.4, 0.9, 0.7, 0.75])
/// >>> error_mm = dict(zip(path.ways, 1e3 * path.error_m.mean(axis=1)))
/// >>> bool(2 * error_mm["history"] < error_mm["none"])
/// True
#[pyfunction]
#[pyo3(signature = (manipulator, *, bend_rad=None, tip_m=None, seed=0, mu_spread_ratio=0.1))]
pub fn continuum_track(
    py: Python<'_>,
    #[pyo3(from_py_with = frozen)] manipulator: &Manipulator,
    bend_rad: Option<&Bound<'_, PyAny>>,
    tip_m: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = argument)] seed: u64,
    #[pyo3(from_py_with = argument)] mu_spread_ratio: f64,
) -> Outcome<Py<PyAny>> {
    let wanted = goals(bend_rad, tip_m, &[Axis::Rows])?;
    let goals = if bend_rad.is_some() {
        Goals::BendRad(
            wanted.iter().filter_map(|goal| if let Goal::BendRad(one) = goal { Some(*one) } else { None }).collect(),
        )
    } else {
        Goals::TipM(
            wanted.iter().filter_map(|goal| if let Goal::TipM(one) = goal { Some(*one) } else { None }).collect(),
        )
    };
    let options = TrackOptions { seed, mu_spread_ratio, ..TrackOptions::new(goals) };
    let params = manipulator.file.params();
    let tracks = py.detach(|| track_path(params, &options))?;
    let (count, ways) = (options.goals.count(), tracks.len());
    let rows = |of: &dyn Fn(&TrackedGoal) -> f64| {
        array(py, tracks.iter().flat_map(|track| &track.goals).map(of).collect(), &[ways, count])
    };
    let of_first = |track: &Track| track.goals.iter().flat_map(|goal| goal.wanted_m).collect::<Vec<f64>>();
    let reached_m = tracks.iter().flat_map(|track| &track.goals).flat_map(|goal| goal.tip_m).collect();
    let status = tracks.iter().flat_map(|track| &track.goals).map(|goal| goal.status.bits()).collect();
    let fields = (
        tracks.iter().map(|track| track.way.name()).collect::<Vec<_>>(),
        array(py, tracks.first().map(of_first).unwrap_or_default(), &[count, 2])?,
        array(py, reached_m, &[ways, count, 2])?,
        rows(&TrackedGoal::error_m)?,
        rows(&|goal| goal.along_m)?,
        rows(&|goal| goal.bend_rad)?,
        rows(&|goal| goal.tension_base_n)?,
        array::<u32>(py, status, &[ways, count])?,
    );
    Ok(results::new(py, "TendonTrack", fields)?.unbind())
}

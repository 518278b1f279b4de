//! What `excite` tells of an identification run.

use std::fmt::Write as _;

use fric_lab::excite::Excitation;
use fric_lab::text::to_millimetre;

use crate::report::RunSeries;

/// For people: how long the run is, where it goes and how hard.
#[must_use]
pub fn describe(excitation: &Excitation, series: &RunSeries) -> String {
    let duration_s = excitation.trajectory().duration_s();
    let mut text = format!(
        "{} set points, {duration_s:.1} s, up to {:.3} m/s",
        excitation.total_cycles(),
        series.speed().greatest
    );
    if let Some(work_box) = excitation.work_box() {
        let corners_m = [work_box.center_m - work_box.half_edges_m, work_box.center_m + work_box.half_edges_m];
        let [from, to] = corners_m.map(|corner_m| {
            let [x, y, z] = <[f64; 3]>::from(corner_m.map(to_millimetre));
            format!("({x:.3}, {y:.3}, {z:.3})")
        });
        // Writing to a String cannot fail, here and below.
        let _ = write!(text, ", from {from} to {to} m");
    }
    if let Some(tension_n) = series.tension_n() {
        let _ = write!(text, ", cable forces {:.2} to {:.2} N", tension_n.least, tension_n.greatest);
    }
    text
}

//! Where the load of a hanging mass is not known: around jumps of its acceleration.
//!
//! The force `m·(g − a)` of a hanging mass takes the mean of the acceleration over a window, which differs from the acceleration itself only where that bends
//! within the window. A winch that starts to accelerate all at once, as by a trapezoid of the speed, bends it by the whole step. The bend of the force is its
//! distance from the line through the forces a window before and after.

use fric_core::KnownReference;

use super::Standing;
use crate::samples::cable::CableRecord;
use crate::samples::noise::white_noise;
use crate::samples::record::Row;

const WINDOW_S: f64 = KnownReference::WINDOW_S;

/// A bend is a jump beyond this many standard deviations of all bends, which the noise of the lengths and a smooth motion make. Of noise one in two million
/// samples is beyond, and the greatest of a sine is at 2.1; half of it leaves out samples of smooth motions.
const BEYOND_USUAL: f64 = 5.0;
/// A bend below so many standard deviations of the sensor's noise hides in it: where the acceleration starts to change at a constant rate, the force is off by half
/// of the bend. With half as many, a fifth of a run with smooth starts is left out.
const LEAST_OF_NOISE: f64 = 2.0;
/// Median of the absolute value of normal noise, in standard deviations.
const MEDIAN_OF_NORMAL: f64 = 0.674_49;
/// Rows further apart than so many windows say nothing about the force between them.
const FARTHEST_WINDOWS: f64 = 10.0;

/// Leaves out references within a window around each jump.
pub fn leave_out_jumps(record: &CableRecord<'_>, standings: &mut [Standing]) {
    let bends_n: Vec<f64> = record.logs().flat_map(|(start, rows)| bends_n(record, start, rows)).collect();
    let mut usual_n: Vec<f64> = bends_n.iter().map(|bend_n| bend_n.abs()).filter(|bend_n| bend_n.is_finite()).collect();
    let Some(noise_n) = white_noise(&record.shown_forces_n()).filter(|_| !usual_n.is_empty()) else { return };
    let middle = usual_n.len() / 2;
    let median_n = *usual_n.select_nth_unstable_by(middle, f64::total_cmp).1;
    let least_n = (BEYOND_USUAL * median_n / MEDIAN_OF_NORMAL).max(LEAST_OF_NOISE * noise_n);
    for (jump, _) in bends_n.iter().enumerate().filter(|(_, bend_n)| bend_n.abs() > least_n) {
        let log = record.log_of(jump);
        let is_near = |place: &usize| (record.time_s(*place) - record.time_s(jump)).abs() <= WINDOW_S;
        let before = (log.start..jump).rev().take_while(is_near);
        for place in before.chain((jump..log.end).take_while(is_near)) {
            let of_place = standings.iter_mut().skip(place).take(1);
            of_place.filter(|standing| **standing == Standing::Used).for_each(|of| *of = Standing::WithoutReference);
        }
    }
}

/// Returns the bend of the reference in each row of a log, N; NaN where it is not known.
fn bends_n(record: &CableRecord<'_>, start: usize, rows: &[Row]) -> Vec<f64> {
    let end = start + rows.len();
    let point = |place: usize| (record.time_s(place), record.reference_n(place));
    let (mut before, mut after) = (start, start);
    let bend_n = |place: usize| {
        let (now_s, now_n) = point(place);
        while before + 1 < place && now_s - record.time_s(before + 1) >= WINDOW_S {
            before += 1;
        }
        while after < end && record.time_s(after) - now_s < WINDOW_S {
            after += 1;
        }
        let ((before_s, before_n), (after_s, after_n)) = (point(before), point(after));
        let are_apart = now_s - before_s >= WINDOW_S && after < end;
        let is_near = after_s - before_s <= 2.0 * FARTHEST_WINDOWS * WINDOW_S;
        if are_apart && is_near {
            before_n + (after_n - before_n) * (now_s - before_s) / (after_s - before_s) - now_n
        } else {
            f64::NAN
        }
    };
    (start..end).map(bend_n).collect()
}

//! Detects references that were measured less often than the cycle runs. Between two measurements such a reference is interpolated linearly, and the
//! interpolated values are no measurements. Only a measurement bends the line.

use fric_core::Wrench;

use super::cable::CableRecord;
use super::held::repeated_forces;
use super::record::{Measurements, Row};

/// A log's reference counts as interpolated if more than this fraction of its moving samples lies on the line between their neighbours. A reference
/// with few digits at the rate of the cycle has a smaller fraction by chance; so does one measured at more than a third of that rate.
const LEAST_ON_LINE: f64 = 0.25;
/// Minimum rate of bends while the reference changes, Hz. Fewer bends indicate a signal that consists of straight lines, measured throughout and
/// without noise.
const LEAST_RATE_HZ: f64 = 10.0;
/// Bend caused by rounding, as a fraction of a line's steps (rounded times) and of its value.
const ROUNDING_OF_STEP: f64 = 1e-8;
const ROUNDING_OF_VALUE: f64 = 8.0 * f64::EPSILON;

/// Returns which cycles are measured rather than interpolated between two measurements of the reference, or with a force that the sensor only repeats:
/// all if both were measured at the rate of the cycle. A known reference needs no measurement.
pub fn measured(record: &CableRecord<'_>) -> Vec<bool> {
    let mut measured = measured_references(record);
    if let Some(repeated) = repeated_forces(record) {
        leave_out_repeats(&repeated, &mut measured);
    }
    measured
}

/// Leaves out the cycles with a force that is only repeated. Where the reference is hardly ever measured together with a new force, the cycles with a
/// new force remain, and the line between two measurements of the reference.
fn leave_out_repeats(repeated: &[bool], measured: &mut [bool]) {
    let count = |cycles: &[bool]| cycles.iter().filter(|counts| **counts).count();
    let new: Vec<bool> = repeated.iter().map(|repeated| !repeated).collect();
    let together: Vec<bool> = measured.iter().zip(&new).map(|(measured, new)| *measured && *new).collect();
    let are_apart = 2 * count(&together) <= count(measured).min(count(&new));
    measured.copy_from_slice(if are_apart { &new } else { &together });
}

/// Returns the same of the reference alone.
pub fn measured_references(record: &CableRecord<'_>) -> Vec<bool> {
    if record.reference_is_known {
        return vec![true; record.rows.len()];
    }
    let of_log = |(start, rows): (usize, &[Row])| {
        let cycles = start..start + rows.len();
        let points: Vec<(f64, f64)> = cycles.map(|cycle| (record.time_s(cycle), record.reference_n(cycle))).collect();
        of_log(&points)
    };
    record.logs().flat_map(of_log).collect()
}

/// Returns the same for the wrench, whose components were measured at the same times.
pub fn measured_wrenches(measurements: &Measurements<'_>) -> Vec<bool> {
    let wrenches = &measurements.platform().wrenches;
    let Some(record) = measurements.cables().next() else { return vec![true; wrenches.len()] };
    let of_wrenches = |(start, rows): (usize, &[Row])| {
        let component = |component: usize| {
            let at = |place: usize| {
                let wrench = wrenches.get(place).and_then(Option::as_ref).map(Wrench::to_vector);
                (record.time_s(place), wrench.map_or(f64::NAN, |wrench| wrench[component]))
            };
            of_log(&(start..start + rows.len()).map(at).collect::<Vec<_>>())
        };
        let joined: Vec<Vec<bool>> = (0..6).map(component).filter(|measured| measured.contains(&false)).collect();
        (0..rows.len())
            .map(|place| joined.is_empty() || joined.iter().any(|measured| measured[place]))
            .collect::<Vec<bool>>()
    };
    let mut measured: Vec<bool> = record.logs().flat_map(of_wrenches).collect();
    // Sensors that are read in turn have a new force in each sample.
    let of_cables = measurements.cables().map(|record| repeated_forces(&record));
    let both = |one: Vec<bool>, other: Vec<bool>| one.iter().zip(other).map(|(one, other)| *one && other).collect();
    let repeated = of_cables.reduce(|one, other| Some(both(one?, other?))).flatten();
    if let Some(repeated) = repeated {
        leave_out_repeats(&repeated, &mut measured);
    }
    measured
}

/// Returns the same for one log of times and references.
fn of_log(points: &[(f64, f64)]) -> Vec<bool> {
    let bends_n: Vec<f64> = (0..points.len()).map(|place| bend_n(points, place).unwrap_or(f64::NAN)).collect();
    let moves = |place: usize| match points.get(place.wrapping_sub(1)..=place) {
        Some([(_, before_n), (_, now_n)]) => before_n.to_bits() != now_n.to_bits(),
        _ => false,
    };
    let (mut moving, mut on_line) = (0.0, 0.0);
    for (_, bend_n) in bends_n.iter().enumerate().filter(|(place, bend_n)| bend_n.is_finite() && moves(*place)) {
        moving += 1.0;
        on_line += if *bend_n > 0.0 { 0.0 } else { 1.0 };
    }
    if on_line <= LEAST_ON_LINE * moving {
        return vec![true; points.len()];
    }
    // A measurement between two cycles bends the line at both, and more at the nearer one.
    let at = |place: Option<usize>| place.and_then(|place| bends_n.get(place)).copied().unwrap_or(f64::NAN);
    let is_greatest = |(place, bend_n): (usize, &f64)| {
        let (before_n, after_n) = (at(place.checked_sub(1)), at(Some(place + 1)));
        *bend_n > 0.0 && (before_n.is_nan() || before_n < *bend_n) && (after_n.is_nan() || after_n <= *bend_n)
    };
    let measured: Vec<bool> = bends_n.iter().enumerate().map(is_greatest).collect();
    let duration_s = points.first().zip(points.last()).map_or(0.0, |((first_s, _), (last_s, _))| last_s - first_s);
    #[expect(clippy::cast_precision_loss, reason = "a count of cycles")]
    let moving_s = duration_s * moving / points.len() as f64;
    let count = measured.iter().fold(0.0, |count, measured| count + if *measured { 1.0 } else { 0.0 });
    if count < LEAST_RATE_HZ * moving_s { vec![true; points.len()] } else { measured }
}

/// Returns how far the next sample is off the line through this sample and the one before, N; 0 within rounding.
fn bend_n(points: &[(f64, f64)], place: usize) -> Option<f64> {
    let [(before_s, before_n), (now_s, now_n), (after_s, after_n)] =
        *points.get(place.checked_sub(1)?..=place + 1)?.first_chunk()?;
    let line_n = (now_n - before_n) * (after_s - now_s) / (now_s - before_s);
    let bend_n = (after_n - now_n - line_n).abs();
    let rounding_n = ROUNDING_OF_STEP * (line_n.abs() + (after_n - now_n).abs()) + ROUNDING_OF_VALUE * now_n.abs();
    Some(if bend_n <= rounding_n { 0.0 } else { bend_n })
}

#[cfg(test)]
mod tests {
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    /// Returns a slow wave with noise, measured at some times.
    fn knots(times_s: impl Iterator<Item = f64>) -> Vec<(f64, f64)> {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        times_s
            .map(|time_s| {
                let noise: f64 = StandardNormal.sample(&mut random);
                (time_s, 5.0 + (3.0 * time_s).sin() + 0.02 * noise)
            })
            .collect()
    }

    /// Returns the same series at 1 kHz, interpolated linearly.
    fn joined(knots: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let at = |cycle: i32| {
            let time_s = f64::from(cycle) * 1e-3;
            let next = knots.partition_point(|(knot_s, _)| *knot_s <= time_s);
            let ((from_s, from_n), (to_s, to_n)) = (knots[next - 1], knots[next]);
            (time_s, from_n + (time_s - from_s) / (to_s - from_s) * (to_n - from_n))
        };
        (1..5000).map(at).collect()
    }

    #[test]
    fn lines_bend_where_something_was_measured() {
        // At 100 Hz in step with the cycle; between cycles; at drifting times; at 300 Hz.
        let wandering = |k: i32| f64::from(k) * 0.01 + 0.004 * (f64::from(k) * 0.7).sin();
        let series: [Vec<(f64, f64)>; 4] = [
            knots((0..502).map(|k| f64::from(k) * 0.01)),
            knots((0..502).map(|k| f64::from(k) * 0.01 + 0.0003)),
            knots((0..502).map(wandering)),
            knots((0..1602).map(|k| f64::from(k) / 300.0)),
        ];
        for (which, knots) in series.iter().enumerate() {
            let knots = [&[(-1.0, 5.0)], knots.as_slice()].concat();
            let found = of_log(&joined(&knots));
            let inside = knots.iter().filter(|(time_s, _)| (0.002..4.998).contains(time_s)).count();
            let cycles: Vec<f64> =
                (1..5000).zip(&found).filter(|(_, found)| **found).map(|(cycle, _)| f64::from(cycle)).collect();
            let near = |cycle: &&f64| knots.iter().any(|(knot_s, _)| (knot_s * 1e3 - **cycle).abs() < 0.51);
            let hits = cycles.iter().filter(near).count();
            assert!(
                cycles.len().abs_diff(inside) * 20 < inside && hits * 20 > 19 * cycles.len(),
                "{which}: {hits} {} {inside}",
                cycles.len()
            );
        }
    }

    /// Lines and corners without noise, such as the acceleration of a motion with constant jerk.
    #[test]
    fn a_motion_of_lines_is_measured_throughout() {
        let corners = knots((0..22).map(|k| f64::from(k) * 0.25));
        assert!(of_log(&joined(&corners)).iter().all(|measured| *measured));
    }

    #[test]
    fn a_reference_at_the_rate_of_the_cycle_is_measured_throughout() {
        let full = knots((0..5000).map(|cycle| f64::from(cycle) * 1e-3));
        assert!(of_log(&full).iter().all(|measured| *measured));
        for digit_n in [0.05, 0.01, 0.001] {
            let coarse: Vec<(f64, f64)> =
                full.iter().map(|(time_s, force_n)| (*time_s, (force_n / digit_n).round() * digit_n)).collect();
            assert!(of_log(&coarse).iter().all(|measured| *measured), "{digit_n}");
        }
    }
}

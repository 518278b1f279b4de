//! The measurement corrections of a manipulator file: frame of the markers, tension sensor at the base, common step of all gratings.
//!
//! [`corrected`] removes them from a run, [`as_measured`] applies them to a simulated one.

use fric_tendon::file::ManipulatorFile;

use super::error::ContinuumError;
use super::run::{Run, RunSample};
use super::shape_errors::ComputedShape;

/// Returns the run in the base frame, with a corrected sensor at the base. Shifts stay unchanged: [`Gratings`](super::gratings::Gratings) removes
/// their step and drift.
///
/// The tension at the base is `(shown(t + lag) − offset)/gain`, interpolated linearly between samples, and never negative. Beyond an end it is the
/// point reflection of the run in its outermost sample, which continues a pull and a rest alike.
///
/// # Errors
/// A checked run causes no error; the signature is that of [`Run`]'s check.
pub fn corrected(run: &Run, file: &ManipulatorFile) -> Result<Run, ContinuumError> {
    let tables = file.tables();
    if tables.markers.is_none() && tables.base_sensor.is_none() {
        return Ok(run.clone());
    }
    let (markers, sensor) = (tables.markers.unwrap_or_default(), tables.base_sensor.unwrap_or_default());
    let samples = run.samples();
    let correct = |sample: &RunSample| RunSample {
        tension_base_n: ((tension_n(samples, sample.time_s + sensor.lag_s, sample.tension_base_n) - sensor.offset_n)
            / sensor.gain)
            .max(if sample.tension_base_n.is_nan() { f64::NAN } else { 0.0 }),
        marker_m: sample.marker_m.iter().map(|marker_m| markers.in_base_frame(*marker_m)).collect(),
        ..sample.clone()
    };
    Run::new(samples.iter().map(correct).collect(), run.disk_count())
}

/// Returns samples of a simulated manipulator as they would be measured with the file's frame, sensor and gratings.
#[must_use]
pub fn as_measured(samples: &[RunSample], file: &ManipulatorFile) -> Vec<RunSample> {
    let tables = file.tables();
    let (markers, sensor) = (tables.markers.unwrap_or_default(), tables.base_sensor.unwrap_or_default());
    let gratings = tables.gratings.clone().unwrap_or_default();
    let (step_nm, from_s) =
        (gratings.common_step_nm.unwrap_or(0.0), gratings.common_step_s.unwrap_or(f64::NEG_INFINITY));
    let measure = |sample: &RunSample| {
        let step_nm = if sample.time_s >= from_s { step_nm } else { 0.0 };
        let shown_n = sensor.gain * tension_n(samples, sample.time_s - sensor.lag_s, sample.tension_base_n);
        RunSample {
            tension_base_n: (shown_n + sensor.offset_n).max(0.0),
            marker_m: sample.marker_m.iter().map(|marker_m| markers.measured(*marker_m)).collect(),
            shift_nm: sample.shift_nm.iter().map(|shift_nm| shift_nm + step_nm).collect(),
            ..sample.clone()
        }
    };
    samples.iter().map(measure).collect()
}

/// Returns how far the disks of computed shapes move in the time `lag_s` before each sample, m; before the first sample and after the last they rest. The path is
/// that of the model, which has no noise: markers that are interpolated between samples would have less of it than others.
pub(super) fn moved_m(times_s: &[f64], shapes: &[ComputedShape], lag_s: f64) -> Vec<Vec<[f64; 2]>> {
    let before = |time_s: f64| {
        let behind = times_s.partition_point(|other_s| *other_s < time_s).clamp(1, times_s.len() - 1);
        let [from_s, to_s] = [times_s[behind - 1], times_s[behind]];
        let share = ((time_s - from_s) / (to_s - from_s)).clamp(0.0, 1.0);
        let [one, other] =
            [behind - 1, behind].map(|place| shapes.get(place).map_or(&[][..], |shape| &shape.disk_position_m));
        let between = move |(one, other): (&[f64; 2], &[f64; 2])| {
            [0, 1].map(|axis| one[axis] + share * (other[axis] - one[axis]))
        };
        one.iter().zip(other).map(between).collect::<Vec<[f64; 2]>>()
    };
    if times_s.len() < 2 {
        return Vec::new();
    }
    let of = |(time_s, shape): (&f64, &ComputedShape)| {
        let places = shape.disk_position_m.iter().zip(before(time_s - lag_s));
        places.map(|([x_m, y_m], [before_x_m, before_y_m])| [x_m - before_x_m, y_m - before_y_m]).collect()
    };
    times_s.iter().zip(shapes).map(of).collect()
}

/// Returns the tension at the base at any time, N; `own_n` if there are no samples.
fn tension_n(samples: &[RunSample], time_s: f64, own_n: f64) -> f64 {
    let [Some(first), Some(last)] = [samples.first(), samples.last()] else { return own_n };
    let end = if time_s > last.time_s { last } else { first };
    if time_s < first.time_s || time_s > last.time_s {
        let mirrored_s = (2.0 * end.time_s - time_s).clamp(first.time_s, last.time_s);
        return 2.0 * end.tension_base_n - between(samples, mirrored_s).unwrap_or(end.tension_base_n);
    }
    between(samples, time_s).unwrap_or(own_n)
}

/// Returns the tension at the base at a time within the run, N.
fn between(samples: &[RunSample], time_s: f64) -> Option<f64> {
    let behind = samples.partition_point(|sample| sample.time_s < time_s);
    let after = samples.get(behind)?;
    let Some(before) = behind.checked_sub(1).and_then(|before| samples.get(before)) else {
        return Some(after.tension_base_n);
    };
    // At a sample itself the one before does not matter, which may be a gap.
    if after.time_s <= time_s {
        return Some(after.tension_base_n);
    }
    let share = (time_s - before.time_s) / (after.time_s - before.time_s);
    Some(before.tension_base_n + share * (after.tension_base_n - before.tension_base_n))
}

#[cfg(test)]
mod tests {
    use super::*;

    const PROTOTYPE: &str = include_str!("../../../examples/tendon-prototype.toml");

    #[test]
    fn what_is_put_on_comes_off() {
        let text = PROTOTYPE.to_owned()
            + "\n[markers]\noffset_m = [0.005, -0.003]\nangle_rad = 0.05\n\n[base_sensor]\ngain = 1.1\noffset_n = 0.02\nlag_s = 0.2\n";
        let file = ManipulatorFile::parse(&text, "arm").unwrap();
        let sample = |place: u32| RunSample {
            time_s: 0.1 * f64::from(place),
            tension_base_n: 0.1 + 0.03 * f64::from(place),
            marker_m: vec![[0.037, 0.001 * f64::from(place)]; 8],
            ..RunSample::default()
        };
        let samples: Vec<RunSample> = (0..30).map(sample).collect();
        let shown = as_measured(&samples, &file);
        // By definition: two samples later, 10 % more and 0.02 N; a rotation by a small angle moves along y.
        assert!((shown[10].tension_base_n - (1.1 * samples[8].tension_base_n + 0.02)).abs() < 1e-12);
        let expected_m = [0.005 + 0.037 * 0.05_f64.cos(), -0.003 + 0.037 * 0.05_f64.sin()];
        assert!((shown[0].marker_m[0][0] - expected_m[0]).abs() < 1e-15);
        assert!((shown[0].marker_m[0][1] - expected_m[1]).abs() < 1e-15);
        let back = corrected(&Run::new(shown, 8).unwrap(), &file).unwrap();
        // The pull goes on beyond both ends.
        for (back, sample) in back.samples().iter().zip(&samples) {
            assert!((back.tension_base_n - sample.tension_base_n).abs() < 1e-12);
            assert!((back.marker_m[0][1] - sample.marker_m[0][1]).abs() < 1e-15);
        }
    }
}

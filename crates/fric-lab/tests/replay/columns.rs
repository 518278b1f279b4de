//! Samples come out of columns as they went in.

use fric_core::{CableInput, Pose, Sample, Wrench};
use fric_lab::columns::SampleColumns;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// Numbers as bits, so that NaN equals itself.
fn bits(sample: &Sample<'_>) -> (i64, Vec<Option<u64>>) {
    let cables = sample.cables.iter().flat_map(|cable| [cable.sensor_force_n, cable.length_m, cable.speed_m_per_s]);
    let pose = sample.pose.map(|pose| (pose.position_m, pose.orientation.coords));
    let (position, orientation) = pose.unzip();
    let (force, torque) = sample.outside_wrench.map(|wrench| (wrench.force_n, wrench.torque_nm)).unzip();
    let place = |axis: usize| {
        let coordinates = [position, force, torque].map(|vector| vector.map(|vector| vector[axis].to_bits()));
        coordinates.into_iter().chain([orientation.map(|orientation| orientation[axis].to_bits())])
    };
    let numbers = cables.chain(sample.reference_force_n.iter().copied()).map(|number| Some(number.to_bits()));
    let w = orientation.map(|orientation| orientation[3].to_bits());
    (sample.stamp_nanos, numbers.chain((0..3).flat_map(place)).chain([w]).collect())
}

#[test]
fn samples_come_out_as_they_went_in() {
    let cable = |force: f64| CableInput { sensor_force_n: force, length_m: -force / 3.0, speed_m_per_s: f64::NAN };
    let cables = [cable(1.1), cable(f64::INFINITY)];
    // A quaternion whose norm is 1 but for rounding, as interpolation gives it.
    let orientation = UnitQuaternion::new_normalize(Quaternion::new(0.3, -0.2, 0.7, 0.11));
    let pose = Pose { position_m: Vector3::new(0.1, -0.0, 1e-300), orientation };
    let wrench = Wrench { force_n: Vector3::new(f64::NAN, 1.0, 2.0), torque_nm: Vector3::new(0.5, -0.0, 0.1) };
    let full = Sample {
        stamp_nanos: i64::MAX,
        cables: &cables,
        reference_force_n: &[f64::NAN, 3.0],
        pose: Some(pose),
        outside_wrench: Some(wrench),
    };
    let bare = Sample { stamp_nanos: -5, pose: None, outside_wrench: None, ..full };
    let mut columns = SampleColumns::default();
    for sample in [full, bare, full] {
        columns.push(&sample);
    }

    let rows = columns.rows();
    assert_eq!((rows.len(), rows.is_empty()), (3, false));
    for (row, expected) in [full, bare, full].iter().enumerate() {
        assert_eq!(bits(&rows.sample(row, &mut Vec::new()).unwrap()), bits(expected), "row {row}");
    }
    assert!(rows.sample(3, &mut Vec::new()).is_none());
    assert!(SampleColumns::default().rows().sample(0, &mut Vec::new()).is_none());
}

#[test]
fn time_starts_with_the_first_row() {
    let columns =
        SampleColumns { stamp_nanos: vec![1_780_000_000_000_000_000, 1_780_000_000_500_000_000], ..Default::default() };
    assert_eq!(columns.time_s(), [0.0, 0.5]);
}

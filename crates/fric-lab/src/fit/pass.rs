//! One pass of the cycle's equations over a cable's record, with the derivatives by chosen parameters.

use fric_core::SingleCable;
use fric_core::cable::CableForces;
use fric_core::parameters::Values;
use fric_core::scalar::Scalar;

use super::dual::Dual;
use super::record::{CableRecord, Row};
use super::vector::Parameter;

/// The most parameters that a cable's forces can be differentiated by.
pub const MOST_PARAMETERS: usize = 32;

/// Runs `$run::<N>` with room for `$count` derivatives: the smallest of a few sizes that holds them.
macro_rules! with_room_for {
    ($count:expr, $run:ident($($argument:expr),* $(,)?)) => {
        match $count {
            0..=4 => $run::<4>($($argument),*),
            5..=8 => $run::<8>($($argument),*),
            9..=16 => $run::<16>($($argument),*),
            _ => $run::<{ crate::fit::pass::MOST_PARAMETERS }>($($argument),*),
        }
    };
}
pub(super) use with_room_for;

/// A cable at rest that carries the derivatives by `free`.
pub fn differentiated<const N: usize>(
    record: &CableRecord<'_>,
    values: &Values,
    free: &[Parameter],
) -> SingleCable<Dual<N>> {
    let mut duals = values.map(Dual::constant);
    for (derivative, parameter) in free.iter().enumerate() {
        duals[parameter.place()] = Dual::variable(values[parameter.place()], derivative);
    }
    let varies = |place| free.iter().any(|parameter| parameter.place() == place);
    SingleCable::new(record.params, &duals, record.cycle_s, |number: Dual<N>| number.value, varies)
}

/// Runs every cycle and gives its outcome, with the cycle's place, to `visit`.
pub fn run<T: Scalar>(
    record: &CableRecord<'_>,
    cable: impl Fn() -> SingleCable<T>,
    mut visit: impl FnMut(usize, &Row, &CableForces<T>),
) {
    for (start, rows) in record.logs() {
        let mut cable = cable();
        for (place, row) in (start..).zip(rows) {
            visit(place, row, &cable.step(&row.signals, row.pose_wrap));
        }
    }
}

/// The same in plain numbers.
pub fn run_plain(record: &CableRecord<'_>, values: &Values, visit: impl FnMut(usize, &Row, &CableForces<f64>)) {
    let cable = || SingleCable::new(record.params, values, record.cycle_s, |number: f64| number, |_| false);
    run(record, cable, visit);
}

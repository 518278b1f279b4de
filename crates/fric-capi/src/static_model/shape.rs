//! The forward model: the shape for the tensions at the base.

use fric_tendon::{Direction, Friction, MAX_DISKS, Tendon};

use super::handle::{ModelHandle, Work};
use crate::cycle::usable;
use crate::outcome::Outcome;

/// Friction from each hole's memory of the history of the tensions at the base.
pub const FRIC_FRICTION_HISTORY: u32 = 0;
/// No friction.
pub const FRIC_FRICTION_NONE: u32 = 1;
/// Coulomb friction with every hole sliding as in pulling: the first tendon is pulled, the second pays out.
pub const FRIC_FRICTION_PULLING: u32 = 2;
/// Coulomb friction with every hole sliding in the opposite direction.
pub const FRIC_FRICTION_RELEASING: u32 = 3;
/// Friction from the tensions measured in the segments.
pub const FRIC_FRICTION_MEASURED: u32 = 4;

/// Tensions measured in the segment that ends in a disk.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct DiskTensions {
    /// Tensions of the first and the second tendon, N; 0 for a slack one.
    pub tension_n: [f64; 2],
}

/// The tensions for which a shape is computed.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ShapeSignals {
    /// sizeof(fric_shape_input).
    pub struct_size: usize,
    /// Tension at the base of the first and the second tendon, N; 0 for a slack tendon.
    pub base_tension_n: [f64; 2],
    /// With FRIC_FRICTION_MEASURED: the tensions in the segments, starting at the base; otherwise ignored.
    pub measured: *const DiskTensions,
    /// Number of these, which must be fric_static_model_disk_count. Ignored without them.
    pub measured_count: usize,
    /// FRIC_FRICTION_…; that of a zeroed structure is FRIC_FRICTION_HISTORY.
    pub friction: u32,
}

/// A disk, the segment that ends in it, and the hole at the beginning of that segment.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DiskResult {
    /// Centre of the disk, base frame: x along the straight manipulator, y towards the first tendon, m.
    pub position_m: [f64; 2],
    /// Bend of the segment, rad, positive towards the first tendon.
    pub bend_rad: f64,
    /// Tension in the segment of the first and the second tendon, N.
    pub tension_n: [f64; 2],
    /// Friction of each tendon at the hole, N; positive if the base side is tighter.
    pub friction_n: [f64; 2],
    /// Greatest friction of each tendon at the hole, N.
    pub bound_n: [f64; 2],
}

/// A shape. Set `struct_size`, `disks` and `disk_count`; the solution sets the rest. All numbers are finite, whatever the input.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ShapeResult {
    /// sizeof(fric_shape_output).
    pub struct_size: usize,
    /// Disks, segments and holes, starting at the base.
    pub disks: *mut DiskResult,
    /// Number of disks, which must be fric_static_model_disk_count.
    pub disk_count: usize,
    /// Bend of the whole manipulator, the direction of the last disk, rad.
    pub bend_rad: f64,
    /// FRIC_SHAPE_… flags, FRIC_SHAPE_OK if there is no fault. With one of FRIC_SHAPE_FAILED the shape is the last valid one, straight before the
    /// first.
    pub status: u32,
}

/// Returns the friction model of a number of the header, except the measured one; `None` for any other number.
pub(super) fn friction_of(number: u32) -> Option<Friction<'static>> {
    match number {
        FRIC_FRICTION_HISTORY => Some(Friction::History),
        FRIC_FRICTION_NONE => Some(Friction::None),
        FRIC_FRICTION_PULLING => Some(Friction::Coulomb(Direction::Pulling)),
        FRIC_FRICTION_RELEASING => Some(Friction::Coulomb(Direction::Releasing)),
        _ => None,
    }
}

/// Computes the shape for tensions at the base. It may run inside the control loop: it does not allocate, lock or wait, accepts any numbers,
/// including NaN, and its iterations are bounded.
///
/// With FRIC_FRICTION_HISTORY this is one step of the run, which begins with the relaxed tendon: call it in every cycle. The other friction models
/// may be solved in between and leave the memory of the holes unchanged. FRIC_RESULT_BAD_VALUE for a `friction` that is none of FRIC_FRICTION_…. On
/// anything but FRIC_RESULT_OK nothing has happened and the output is unchanged. Input and output must not share memory.
///
/// # Safety
/// `model` is null or a model that has not been freed and that nobody else uses now. `input` and `output` are null or structures whose `struct_size`
/// is readable; if that is right, the rest is readable too; `measured` is null or, with FRIC_FRICTION_MEASURED, `measured_count` elements, `disks` is
/// null or `disk_count` writable elements.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_static_model_solve(
    model: *mut ModelHandle,
    input: *const ShapeSignals,
    output: *mut ShapeResult,
) -> Outcome {
    if !(usable(model) && usable(input) && usable(output)) {
        return Outcome::BadPointer;
    }
    // SAFETY: promised to be readable; the rest of the structure is not touched before its size is known to be right.
    let input_size = unsafe { (&raw const (*input).struct_size).read() };
    // SAFETY: as above.
    let output_size = unsafe { (&raw const (*output).struct_size).read() };
    if input_size != size_of::<ShapeSignals>() || output_size != size_of::<ShapeResult>() {
        return Outcome::WrongSize;
    }
    // SAFETY: of the right size, so all of it is readable.
    let input = unsafe { input.read() };
    // SAFETY: of the right size. Only what the caller sets is read: the rest may be uninitialised.
    let disks = unsafe { (&raw const (*output).disks).read() };
    // SAFETY: as above.
    let disk_count = unsafe { (&raw const (*output).disk_count).read() };
    let is_measured = input.friction == FRIC_FRICTION_MEASURED;
    if !usable(disks) || (is_measured && !usable(input.measured)) {
        return Outcome::BadPointer;
    }
    // SAFETY: a live handle that nobody else uses; no other reference to its data exists.
    let Work { model, .. } = unsafe { &mut (*model).work };
    let count = model.params().disk_count();
    if disk_count != count || (is_measured && input.measured_count != count) {
        return Outcome::WrongSize;
    }
    let status = if is_measured {
        let (mut first_n, mut second_n) = ([0.0; MAX_DISKS], [0.0; MAX_DISKS]);
        for (place, (first_n, second_n)) in first_n.iter_mut().zip(&mut second_n).enumerate().take(count) {
            // SAFETY: `place` < `measured_count`, and this many are readable.
            let DiskTensions { tension_n } = unsafe { input.measured.add(place).read() };
            [*first_n, *second_n] = tension_n;
        }
        let measured_n = [&first_n, &second_n].map(|all| all.get(..count).unwrap_or_default());
        model.solve(input.base_tension_n, Friction::Measured(measured_n))
    } else {
        let Some(friction) = friction_of(input.friction) else { return Outcome::BadValue };
        model.solve(input.base_tension_n, friction)
    };
    let of_both = |list: fn(&fric_tendon::AnyStaticModel, Tendon) -> &[f64], place: usize| {
        Tendon::BOTH.map(|tendon| list(model, tendon).get(place).copied().unwrap_or_default())
    };
    for (place, (position_m, bend_rad)) in model.disk_position_m().iter().zip(model.segment_bend_rad()).enumerate() {
        let result = DiskResult {
            position_m: *position_m,
            bend_rad: *bend_rad,
            tension_n: of_both(|model, tendon| model.tension_n(tendon), place),
            friction_n: of_both(|model, tendon| model.friction_n(tendon), place),
            bound_n: of_both(|model, tendon| model.bound_n(tendon), place),
        };
        // SAFETY: `place` < `disk_count`, and this many are writable.
        unsafe { disks.add(place).write(result) };
    }
    let result =
        ShapeResult { struct_size: output_size, disks, disk_count, bend_rad: model.bend_rad(), status: status.bits() };
    // SAFETY: of the right size, so all of it is writable.
    unsafe { output.write(result) };
    Outcome::Ok
}

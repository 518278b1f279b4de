//! What several tests need: robots, motions, comparisons.

use fric_core::robot::{
    CableOptions, FrictionOptions, GeometryOptions, MonitorOptions, PlatformOptions, Presliding, PulleyOptions,
};
use fric_core::{CableInput, CableParams, Compensator, CycleInput, Pose, RobotParams};

pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub fn scale(a: [f64; 3], factor: f64) -> [f64; 3] {
    a.map(|part| part * factor)
}

pub fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// Within `tolerance` of each other, relative to the greater of 1 and their size.
#[track_caller]
pub fn assert_near(one: f64, other: f64, tolerance: f64) {
    let scale = one.abs().max(other.abs()).max(1.0);
    assert!((one - other).abs() <= tolerance * scale, "{one} and {other} differ by {:e}", (one - other).abs());
}

/// Where `decreasing` (a sign change of it) crosses zero, to the last bits.
pub fn bisect(mut low: f64, mut high: f64, value: impl Fn(f64) -> f64) -> f64 {
    let rising = value(low) < value(high);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if (value(middle) < 0.0) == rising {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

pub const SENSOR_180: PulleyOptions = PulleyOptions::Fixed { wrap_rad: std::f64::consts::PI, sensor: true };
pub const GUIDE_90: PulleyOptions = PulleyOptions::Fixed { wrap_rad: std::f64::consts::FRAC_PI_2, sensor: false };
pub const SWIVEL: PulleyOptions = PulleyOptions::Swivel { radius_m: 0.01, axis: [0.0, 0.0, 1.0] };

/// Friction as the paper finds it.
pub const FRICTION: FrictionOptions =
    FrictionOptions { mu: 0.019, sigma_n_per_m: Some(950.0), viscous_n_s_per_m: 0.5, offset_n: 0.03 };

/// No check for a frozen sensor: tests feed constant forces.
pub const UNMONITORED: MonitorOptions =
    MonitorOptions { frozen_cycles: 0, length_jump_m: 0.01, length_noise_m: 0.0, sensor_jump_n: Some(1e10) };

/// The paper's winch: 180° sensor pulley, 90° guide, swivel.
pub const WINCH: [PulleyOptions; 3] = [SENSOR_180, GUIDE_90, SWIVEL];

/// A cable over [`WINCH`] at the corner of a box.
pub fn corner_cable(index: usize, presliding: Presliding) -> CableOptions<'static> {
    let side = |bit: usize| if index >> bit & 1 == 0 { 1.0 } else { -1.0 };
    #[expect(clippy::cast_precision_loss, reason = "a handful")]
    let level = (index >> 3) as f64;
    CableOptions {
        presliding,
        friction: FRICTION,
        geometry: Some(GeometryOptions {
            base_m: [side(0) * (0.55 + 0.02 * level), side(1) * 0.4, side(2) * -0.5],
            platform_m: [side(0) * 0.06, side(1) * 0.05, side(2) * 0.05],
        }),
        ..CableOptions::new(&WINCH)
    }
}

pub fn checked(options: &[CableOptions<'_>]) -> Vec<CableParams> {
    options.iter().map(|options| CableParams::new(options).unwrap()).collect()
}

pub fn platform() -> PlatformOptions {
    PlatformOptions { mass_kg: 0.41, center_of_mass_m: [0.01, -0.02, 0.005], ..PlatformOptions::default() }
}

pub fn compensator<const CABLES: usize>(options: &[CableOptions<'_>], monitor: MonitorOptions) -> Compensator<CABLES> {
    let cables = checked(options);
    Compensator::new(&RobotParams::new(0.001, &platform(), monitor, &cables).unwrap()).unwrap()
}

/// A robot of corner cables.
pub fn corner_robot<const CABLES: usize>(presliding: Presliding, monitor: MonitorOptions) -> Compensator<CABLES> {
    let options: Vec<_> = (0..CABLES).map(|index| corner_cable(index, presliding)).collect();
    compensator(&options, monitor)
}

/// Signals of a smooth motion with reversals, every cable its own phase, no two forces alike.
#[expect(clippy::cast_precision_loss, reason = "small numbers")]
pub fn smooth_input<const CABLES: usize>(cycle: usize) -> CycleInput<CABLES> {
    let t = cycle as f64 * 0.001;
    let cables = core::array::from_fn(|cable| {
        let phase = cable as f64 * 0.7;
        CableInput {
            sensor_force_n: 14.0 + 3.0 * (2.1 * t + phase).sin() + 0.01 * (977.0 * t + phase).sin(),
            length_m: 1.0 + 0.05 * (1.7 * t + phase).sin(),
            speed_m_per_s: 0.05 * 1.7 * (1.7 * t + phase).cos(),
        }
    });
    let pose = Pose::from_parts(
        [0.1 * (0.9 * t).sin(), 0.1 * (1.1 * t).cos(), 0.05 * (0.7 * t).sin()],
        [0.0, 0.0, (0.1 * t.sin()).sin(), (0.1 * t.sin()).cos()],
    );
    CycleInput { cables, pose, ..CycleInput::default() }
}

//! The robots of a sweep: one cable of a small robot with eight cables, and one drive on a test bench.

/// Friction of a cable in a robot file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    pub mu: f64,
    pub sigma_n_per_m: f64,
    pub viscous_n_s_per_m: f64,
}

/// The values that a user would start from.
pub const GUESS: Friction = Friction { mu: 0.02, sigma_n_per_m: 900.0, viscous_n_s_per_m: 0.2 };

/// Number of cables of the small robot.
pub const CABLE_COUNT: usize = 8;

/// Returns a robot with a frame of 1.1 × 0.8 × 1.0 m and cables from its corners; each cable has a sensor pulley of 180°, a fixed pulley and a
/// swivelling one.
pub fn small_robot(cables: impl Iterator<Item = usize>, mass_kg: f64, friction: &Friction) -> String {
    let mut text = head(mass_kg);
    for cable in cables {
        let sign = |is_positive| if is_positive { 1.0 } else { -1.0 };
        let (x, y, z) = (sign(matches!(cable % 4, 0 | 3)), sign(cable % 4 < 2), sign(cable < 4));
        text += &cable_line(cable, [0.55 * x, 0.4 * y, 0.5 * z], [0.06 * x, 0.05 * y, -0.05 * z]);
        text += &friction_line(friction);
    }
    text
}

/// A cable without its friction: sensor at 180°, a fixed pulley, a swivelling one.
pub fn cable_line(cable: usize, base_m: [f64; 3], platform_m: [f64; 3]) -> String {
    format!(
        "[[cable]]\nname = \"cable{}\"\nbase_m = {base_m:?}\nplatform_m = {platform_m:?}\n\
         pulleys = [{{ wrap_deg = 180.0, sensor = true }}, {{ wrap_deg = 90.0 }}, \
         {{ wrap = \"pose\", radius_m = 0.01, axis = [0.0, 0.0, {:?}] }}]\n",
        cable + 1,
        base_m[2].signum(),
    )
}

/// A drive, a sensor pulley and two more, a weight.
pub fn bench(mass_kg: f64, friction: &Friction) -> String {
    let pulleys = "{ wrap_deg = 180.0, sensor = true }, { wrap_deg = 90.0 }, { wrap_deg = 90.0 }";
    format!("{}[[cable]]\nname = \"drive\"\npulleys = [{pulleys}]\n{}", head(mass_kg), friction_line(friction))
}

/// What stands before the cables.
pub fn head(mass_kg: f64) -> String {
    format!("format = \"fric-robot/1\"\nname = \"rig\"\ncycle_s = 0.001\n[platform]\nmass_kg = {mass_kg:?}\n")
}

/// The line of a cable's friction.
pub fn friction_line(friction: &Friction) -> String {
    let Friction { mu, sigma_n_per_m, viscous_n_s_per_m } = friction;
    format!(
        "friction = {{ mu = {mu:?}, sigma_n_per_m = {sigma_n_per_m:?}, viscous_n_s_per_m = {viscous_n_s_per_m:?} }}\n"
    )
}

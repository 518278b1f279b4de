//! The robot file: what is right is read, what is wrong is named.

use fric_core::effects::Effect;
use fric_core::robot::Presliding;
use fric_core::robot::file::{FORMAT, RobotFile, RobotFileError};
use fric_core::{Compensator, CycleInput, KnownReference, Pose};

use crate::support::assert_near;

/// The example of the documentation, to the letter.
const EXAMPLE: &str = r#"format = "fric-robot/1"
name = "rig"
cycle_s = 0.001

[platform]
mass_kg = 0.41
center_of_mass_m = [0.0, 0.0, 0.0]            # optional
gravity_m_per_s2 = [0.0, 0.0, -9.80665]       # optional

[log]                                          # optional; these are the defaults
cable = "/cable_states"          # JointState: position = length m, velocity m/s, effort = sensor force N
reference = "/reference_forces"  # JointState: effort = cable force at the platform N; any subset of the cables
pose = "/platform_pose"          # PoseStamped, platform in base
wrench = "/platform_wrench"      # WrenchStamped, outside wrench on the platform, in base axes, about the platform origin

[[cable]]
name = "cable1"                  # matches JointState.name
base_m = [0.55, 0.4, 0.5]        # where the cable enters the last pulley (its tangent point on the swivel axis)
platform_m = [0.06, 0.05, -0.05] # attachment in the platform frame
presliding = "per_pulley"        # the default; "lumped" is the paper's single state per cable
pulleys = [
  { wrap_deg = 180.0, sensor = true },
  { wrap_deg = 90.0 },
  { wrap = "pose", radius_m = 0.01, axis = [0.0, 0.0, 1.0] },
]
friction = { mu = 0.019, sigma_n_per_m = 950.0, viscous_n_s_per_m = 0.5, offset_n = 0.0 }
effects = [ { kind = "stribeck", ratio = 0.5, velocity_m_per_s = 0.02 } ]   # optional
"#;

/// The least that is a robot.
const SHORT: &str = r#"format = "fric-robot/1"
name = "bench"
cycle_s = 0.001
[[cable]]
name = "winch"
pulleys = [ { wrap_deg = 180, sensor = true } ]
"#;

/// `text` with `from`, which must be in it, replaced.
fn with(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "`{from}` is not in the text");
    text.replacen(from, to, 1)
}

fn message(text: &str) -> String {
    let error = RobotFile::parse(text, "rig.toml").expect_err(text);
    assert!(matches!(error, RobotFileError::Invalid { .. }));
    error.to_string()
}

#[test]
fn the_documented_example_is_read() {
    let file = RobotFile::parse(EXAMPLE, "rig.toml").unwrap();
    assert_eq!(file.options().format, FORMAT);
    assert_eq!(file.cable_names(), ["cable1"]);
    let robot = file.params();
    assert_near(robot.cycle_s(), 0.001, 0.0);
    let cable = &robot.cables()[0];
    assert_eq!(cable.pulley_count(), 3);
    assert!(cable.needs_pose() && cable.has_geometry());
    let mut compensator = Compensator::<1>::new(&robot).unwrap();
    let output = compensator.step(&CycleInput { pose: Some(Pose::identity()), ..CycleInput::default() });
    // Nothing pulls: the hand that holds the platform carries its weight.
    assert_near(output.applied_wrench.unwrap().force_n.z, 0.41 * 9.80665, 1e-12);
}

#[test]
fn checked_parameters_tell_what_the_file_says() {
    let text = format!(
        "{EXAMPLE}traction_mu = 0.15\n[monitor]\nfrozen_cycles = 7\nlength_noise_m = 1e-6\nsensor_jump_n = 2.5\n"
    );
    let file = RobotFile::parse(&with(&text, "per_pulley", "lumped"), "rig.toml").unwrap();
    let robot = file.params();
    assert_eq!(robot.mass_kg(), 0.41);
    assert_eq!((robot.center_of_mass_m().as_slice(), robot.gravity_m_per_s2().z), (&[0.0; 3][..], -9.80665));
    let monitor = robot.monitor();
    assert_eq!(monitor.sensor_jump_n, Some(2.5));
    assert_eq!((monitor.frozen_cycles, monitor.length_jump_m, monitor.length_noise_m), (7, 0.01, 1e-6));
    let cable = &robot.cables()[0];
    let wraps: Vec<_> = cable.fixed_wraps_rad().collect();
    assert_eq!(wraps, [Some(core::f64::consts::PI), Some(core::f64::consts::FRAC_PI_2), None]);
    assert_eq!((cable.sensor_wrap_rad(), cable.presliding()), (Some(core::f64::consts::PI), Presliding::Lumped));
    let friction = cable.friction();
    assert_eq!((friction.mu, friction.sigma_n_per_m), (0.019, Some(950.0)));
    assert_eq!((friction.viscous_n_s_per_m, friction.offset_n), (0.5, 0.0));
    assert_eq!((cable.effects().get(Effect::Stribeck, "ratio"), cable.traction_mu()), (Some(0.5), Some(0.15)));
    assert_eq!(cable.base_m().unwrap().as_slice(), [0.55, 0.4, 0.5]);
    assert_eq!(cable.platform_m().unwrap().as_slice(), [0.06, 0.05, -0.05]);
    let bench = RobotFile::parse(SHORT, "bench.toml").unwrap();
    let cable = &bench.params().cables()[0];
    assert_eq!((cable.base_m(), cable.platform_m(), cable.traction_mu()), (None, None, None));
}

#[test]
fn what_is_left_out_has_its_default() {
    let short = RobotFile::parse(SHORT, "bench.toml").unwrap();
    let log = &short.options().log;
    let topics = [&log.cable, &log.reference.to_string(), &log.pose, &log.wrench];
    assert_eq!(topics, ["/cable_states", "/reference_forces", "/platform_pose", "/platform_wrench"]);
    assert_eq!(short.params().known_reference(), None);
    assert_near(short.options().platform.gravity_m_per_s2[2], -9.80665, 0.0);
    assert!(!short.params().cables()[0].needs_pose());
    assert_eq!(fric_core::robot::CableOptions::new(&[]).presliding, Presliding::PerPulley);
    // One name of [log] alone leaves the others.
    let text = format!("{SHORT}[log]\npose = \"/pose\"\n");
    let partly = RobotFile::parse(&text, "bench.toml").unwrap();
    assert_eq!((partly.options().log.pose.as_str(), partly.options().log.cable.as_str()), ("/pose", "/cable_states"));
}

#[test]
fn what_is_written_is_read_back() {
    let monitored = format!(
        "{EXAMPLE}traction_mu = 0.15\nvalidated = {{ force_n = [1.0, 60.0], speed_m_per_s = 1.0 }}\n[monitor]\nfrozen_cycles = 0\nlength_jump_m = 0.02\n"
    );
    let lumped = with(EXAMPLE, "per_pulley", "lumped");
    let hanging = with(EXAMPLE, "reference = \"/reference_forces\"", "reference = { hanging_mass_kg = 5.0 }");
    for text in [EXAMPLE, SHORT, &monitored, &lumped, &hanging] {
        let file = RobotFile::parse(text, "rig.toml").unwrap();
        let written = file.to_toml().unwrap();
        let again = RobotFile::parse(&written, "written.toml").unwrap_or_else(|error| panic!("{error}\n{written}"));
        assert_eq!(again, file, "{written}");
        assert_eq!(again.to_toml().unwrap(), written);
    }
}

#[test]
fn a_load_that_is_known_is_the_reference() {
    let known = |reference: &str| {
        let text = format!("{SHORT}[log]\nreference = {reference}\n[platform]\ngravity_m_per_s2 = [0.0, 3.0, -4.0]\n");
        RobotFile::parse(&text, "bench.toml").unwrap().params().known_reference().unwrap()
    };
    let constant = known("{ constant_n = 49.05 }");
    assert_eq!(constant, KnownReference::Constant { force_n: 49.05 });
    assert_near(constant.force_n(2.0), 49.05, 0.0);
    // m·(g − a), with the file's gravity of 5 m/s² in magnitude.
    let weight = known("{ hanging_mass_kg = 4 }");
    for (acceleration_m_per_s2, force_n) in [(0.0, 20.0), (1.5, 14.0), (-2.0, 28.0), (5.0, 0.0), (7.0, 0.0)] {
        assert_near(weight.force_n(acceleration_m_per_s2), force_n, 1e-12);
    }
    assert!(weight.force_n(f64::NAN).is_nan());
}

#[test]
fn a_file_that_cannot_be_read_says_which() {
    let error = RobotFile::read(std::path::Path::new("no/such/robot.toml")).unwrap_err().to_string();
    assert!(error.starts_with("cannot read the robot file no/such/robot.toml: "), "{error}");
    assert!(
        std::error::Error::source(&RobotFile::read(std::path::Path::new("no/such/robot.toml")).unwrap_err()).is_some()
    );
}

const REFERENCE: &str = "\"/reference_forces\"";

/// A bad file, the line that the message must name, and what else it must say.
struct Bad {
    text: String,
    line: Option<usize>,
    says: &'static [&'static str],
}

fn bad(from: &str, to: &str, line: usize, says: &'static [&'static str]) -> Bad {
    Bad { text: with(EXAMPLE, from, to), line: Some(line), says }
}

#[expect(clippy::too_many_lines, reason = "a table")]
fn bad_files() -> Vec<Bad> {
    vec![
        // Misspelt keys, at every level.
        bad("cycle_s", "cycle_time_s", 3, &["`cycle_time_s`", "did you mean `cycle_s`?"]),
        bad("mass_kg", "mass", 6, &["`mass`", "did you mean `mass_kg`?", "`gravity_m_per_s2`"]),
        bad("[platform]", "[plattform]", 5, &["`plattform`", "did you mean `platform`?"]),
        bad("reference =", "refrence =", 12, &["`refrence`", "did you mean `reference`?"]),
        bad(REFERENCE, "{ constant = 49.0 }", 12, &["`constant`", "did you mean `constant_n`?", "`hanging_mass_kg`"]),
        bad(
            REFERENCE,
            "{ constant_n = 9.0, hanging_mass_kg = 1.0 }",
            12,
            &["`hanging_mass_kg`", "beside `constant_n`"],
        ),
        bad(REFERENCE, "{}", 12, &["`reference` is empty", "`constant_n` or `hanging_mass_kg`"]),
        bad(REFERENCE, "{ constant_n = -1.0 }", 12, &["`constant_n`", "is -1;", "0 to 1e9"]),
        bad(REFERENCE, "{ constant_n = \"5 N\" }", 12, &["`constant_n`", "must be a number"]),
        bad(REFERENCE, "{ hanging_mass_kg = nan }", 12, &["`hanging_mass_kg`", "NaN", "not a finite number"]),
        bad(REFERENCE, "{ hanging_mass_kg = -5.0 }", 12, &["`hanging_mass_kg`", "is -5;", "0 to 1000000"]),
        bad(REFERENCE, "49.05", 12, &["`reference` is 49.05", "a topic in quotes", "constant_n"]),
        bad("base_m", "bas_m", 18, &["`bas_m`", "did you mean `base_m`?"]),
        bad("sensor = true", "senser = true", 22, &["`senser`", "did you mean `sensor`?"]),
        bad("mu = 0.019", "mue = 0.019", 26, &["`mue`", "did you mean `mu`?"]),
        bad("ratio = 0.5", "ration = 0.5", 27, &["`ration`", "did you mean `ratio`?", "stribeck", "cable1"]),
        bad("\"stribeck\"", "\"stribek\"", 27, &["`stribek`", "did you mean `stribeck`?", "more)", "cable1"]),
        bad("per_pulley\"", "per_puley\"", 20, &["`per_puley`", "did you mean `per_pulley`?", "`presliding`"]),
        bad("wrap = \"pose\"", "wrap = \"poses\"", 24, &["`poses`", "did you mean `pose`?", "`wrap`"]),
        bad("wrap = \"pose\"", "wrap = 90.0", 24, &["`wrap` is 90.0", "text in quotes"]),
        bad("\"per_pulley\"", "2", 20, &["`presliding` is 2", "text in quotes"]),
        bad("mu = 0.019", "zzz = 1.0", 26, &["`zzz`", "`viscous_n_s_per_m`"]),
        // A list of the values of a table has no stated order.
        bad(
            "{ mu = 0.019, sigma_n_per_m = 950.0, viscous_n_s_per_m = 0.5, offset_n = 0.0 }",
            "[0.019]",
            26,
            &["`friction`", "table"],
        ),
        bad(REFERENCE, "\"/r\"\ncolumns = { \"cable1.force_n\" = [\"F\", 2.0] }", 13, &["`cable1.force_n`", "table"]),
        bad("[platform]", "monitor = [7]\n[platform]", 5, &["`monitor`", "table"]),
        bad("{ wrap_deg = 90.0 }", "[90.0]", 23, &["`pulleys`", "table"]),
        // Values out of range, and what is no number.
        bad(
            "mass_kg = 0.41",
            "inertia_kg_m2 = [-1.0, 0.0, 0.0, 1.0, 0.0, 1.0]",
            6,
            &["`inertia_kg_m2`", "is -1;", "0 to 1e9"],
        ),
        bad(
            "mass_kg = 0.41",
            "inertia_kg_m2 = [1.0, 5.0, 0.0, 1.0, 0.0, 1.0]",
            6,
            &["`inertia_kg_m2`", "no tensor of a body"],
        ),
        bad("mass_kg = 0.41", "inertia_kg_m2 = [1.0, 1.0, 1.0]", 6, &["`inertia_kg_m2`", "6"]),
        bad("cycle_s = 0.001", "cycle_s = 0.0", 3, &["`cycle_s`", "is 0;", "1e-6 to 10"]),
        bad("cycle_s = 0.001", "cycle_s = nan", 3, &["`cycle_s`", "NaN", "not a finite number"]),
        bad("mass_kg = 0.41", "mass_kg = -1.0", 6, &["`mass_kg`", "is -1;", "0 to 1000000"]),
        bad("mass_kg = 0.41", "mass_kg = inf", 6, &["`mass_kg`", "inf", "not a finite number"]),
        bad("center_of_mass_m = [0.0,", "center_of_mass_m = [nan,", 7, &["`center_of_mass_m`", "not a finite number"]),
        bad("-9.80665", "-inf", 8, &["`gravity_m_per_s2`", "not a finite number"]),
        bad("[0.55,", "[55000.0,", 18, &["`base_m`", "55000", "-10000 to 10000", "cable1"]),
        bad("[0.06,", "[nan,", 19, &["`platform_m`", "NaN", "cable1"]),
        bad("wrap_deg = 90.0", "wrap_deg = 400.0", 23, &["`wrap_deg`", "pulley 2", "is 400;", "0 to 360", "cable1"]),
        bad(
            "wrap_deg = 180.0",
            "wrap_deg = 3.0",
            22,
            &["`wrap_deg`", "pulley 1", "too small for a sensor pulley", "cable1"],
        ),
        bad("radius_m = 0.01", "radius_m = -0.01", 24, &["`radius_m`", "pulley 3", "is -0.01;", "0 to 100"]),
        bad("axis = [0.0, 0.0, 1.0]", "axis = [0.0, 0.0, 0.0]", 24, &["`axis`", "pulley 3", "zero vector"]),
        bad("mu = 0.019", "mu = 1.9", 26, &["`mu`", "is 1.9;", "0 to 0.9", "cable1"]),
        bad("sigma_n_per_m = 950.0", "sigma_n_per_m = 0.0", 26, &["`sigma_n_per_m`", "is 0;", "0.001 to 1e12"]),
        bad(
            "viscous_n_s_per_m = 0.5",
            "viscous_n_s_per_m = -0.5",
            26,
            &["`viscous_n_s_per_m`", "is -0.5;", "0 to 1000000"],
        ),
        bad("offset_n = 0.0", "offset_n = nan", 26, &["`offset_n`", "NaN"]),
        bad("ratio = 0.5", "ratio = 50.0", 27, &["`ratio`", "stribeck", "is 50;", "-0.9 to 5", "cable1"]),
        bad("velocity_m_per_s = 0.02", "velocity_m_per_s = 0.0", 27, &["`velocity_m_per_s`", "is 0;", "0.0001 to 10"]),
        bad("mu = 0.019", "mu = 0.8", 27, &["`ratio`", "stribeck", "`mu`", "0.9", "cable1"]),
        bad(
            "kind = \"stribeck\", ratio = 0.5, velocity_m_per_s = 0.02",
            "kind = \"time_delay\", delay_s = 0.5",
            27,
            &["`delay_s`", "is 0.5;", "-0.02 to 0.063", "cable1"],
        ),
        bad("effects =", "traction_mu = 5.0 #", 27, &["`traction_mu`", "is 5;", "0.01 to 2", "cable1"]),
        bad(
            "effects =",
            "validated = { force_n = [9.0, 1.0] } #",
            27,
            &["`force_n`", "is 1;", "9 or greater", "cable1"],
        ),
        bad(
            "effects =",
            "validated = { speed_m_per_s = -1.0 } #",
            27,
            &["`speed_m_per_s`", "is -1;", "0 or greater", "cable1"],
        ),
        Bad {
            text: format!("{EXAMPLE}[monitor]\nlength_jump_m = 0.0\n"),
            line: Some(29),
            says: &["`length_jump_m`", "is 0;"],
        },
        Bad {
            text: format!("{EXAMPLE}[monitor]\nfrozen_cycles = -1\n"),
            line: Some(29),
            says: &["`frozen_cycles`", "-1", "whole number"],
        },
        Bad {
            text: format!("{EXAMPLE}[monitor]\nlength_noise_m = 0.01\n"),
            line: Some(29),
            says: &["`length_noise_m`", "not less than `length_jump_m`"],
        },
        bad("name = \"cable1\"", "name = \" \"", 17, &["`name`", "is empty"]),
        // Wrong types.
        bad("cycle_s = 0.001", "cycle_s = \"fast\"", 3, &["`cycle_s`", "\"fast\"", "a number"]),
        bad("name = \"rig\"", "name = 7", 2, &["`name`", "is 7;", "text in quotes"]),
        bad("mu = 0.019", "mu = true", 26, &["`mu`", "is true;", "a number"]),
        bad("[0.55, 0.4, 0.5]", "[0.55, 0.4]", 18, &["`base_m`", "3 numbers"]),
        bad("[0.55, 0.4, 0.5]", "[0.55, 0.4, 0.5, 0.6]", 18, &["`base_m`", "3 numbers"]),
        bad("[0.55, 0.4, 0.5]", "0.55", 18, &["`base_m`", "3 numbers"]),
        bad("sensor = true", "sensor = \"yes\"", 22, &["`sensor`", "\"yes\"", "true or false"]),
        bad("ratio = 0.5", "ratio = \"half\"", 27, &["`ratio`", "\"half\"", "a number"]),
        bad("[[cable]]", "[cable]", 16, &["`cable`", "[[cable]]"]),
        // Missing keys.
        bad("format = \"fric-robot/1\"\n", "", 1, &["`format`", "missing", "fric-robot/1"]),
        bad("cycle_s = 0.001\n", "", 1, &["`cycle_s`", "missing"]),
        bad("name = \"cable1\" ", "", 16, &["`name`", "missing", "[[cable]]"]),
        bad(
            "pulleys = [\n  { wrap_deg = 180.0, sensor = true },\n  { wrap_deg = 90.0 },\n  { wrap = \"pose\", radius_m = 0.01, axis = [0.0, 0.0, 1.0] },\n]\n",
            "",
            16,
            &["`pulleys`", "missing"],
        ),
        bad("kind = \"stribeck\", ", "", 27, &["`kind`", "missing"]),
        Bad {
            text: "format = \"fric-robot/1\"\nname = \"rig\"\ncycle_s = 0.001\n".into(),
            line: Some(1),
            says: &["`cable`", "missing"],
        },
        Bad { text: String::new(), line: Some(1), says: &["`format`", "missing"] },
        // What does not go together.
        bad("fric-robot/1", "fric-robot/9", 1, &["`format`", "\"fric-robot/9\"", "\"fric-robot/1\""]),
        // A key of the other format is no misspelling.
        bad("fric-robot/1\"", "fric-robot/9\"\nbackbone = 1", 1, &["`format`", "\"fric-robot/9\"", "\"fric-robot/1\""]),
        bad("platform_m = [0.06, 0.05, -0.05]", "", 18, &["`base_m`", "without `platform_m`", "cable1"]),
        bad("base_m = [0.55, 0.4, 0.5]", "", 19, &["`platform_m`", "without `base_m`", "cable1"]),
        bad(
            "{ wrap_deg = 90.0 }",
            "{ wrap_deg = 90.0, sensor = true }",
            23,
            &["`sensor`", "pulley 2", "first pulley", "cable1"],
        ),
        bad(
            "{ wrap_deg = 90.0 }",
            "{ wrap = \"pose\", radius_m = 0.01, axis = [0.0, 0.0, 1.0] }",
            23,
            &["`wrap`", "pulley 2", "last pulley only"],
        ),
        bad(
            "{ wrap_deg = 90.0 }",
            "{ wrap_deg = 90.0, radius_m = 0.1 }",
            23,
            &["`radius_m`", "pulley 2", "fixed wrap"],
        ),
        bad("{ wrap_deg = 90.0 }", "{ wrap_deg = 90.0, wrap = \"pose\" }", 23, &["`wrap`", "pulley 2", "`wrap_deg`"]),
        bad("{ wrap_deg = 90.0 }", "{ }", 23, &["`wrap_deg`", "pulley 2", "missing"]),
        bad("radius_m = 0.01, ", "", 24, &["`radius_m`", "pulley 3"]),
        bad(", axis = [0.0, 0.0, 1.0]", "", 24, &["`axis`", "pulley 3"]),
        bad(
            "[[cable]]",
            "[[cable]]\nname = \"cable1\"\npulleys = [{ wrap_deg = 90.0 }]\n[[cable]]",
            20,
            &["`name`", "cable1", "earlier cable"],
        ),
        bad(
            "{ wrap_deg = 180.0, sensor = true },\n  { wrap_deg = 90.0 },\n  { wrap = \"pose\", radius_m = 0.01, axis = [0.0, 0.0, 1.0] },\n",
            "",
            21,
            &["`pulleys`", "has 0 entries", "1 to 8", "cable1"],
        ),
        bad(
            "velocity_m_per_s = 0.02 }",
            "velocity_m_per_s = 0.02 }, { kind = \"stribeck\" }",
            27,
            &["`kind`", "stribeck", "already has", "cable1"],
        ),
        bad(
            "velocity_m_per_s = 0.02 }",
            "velocity_m_per_s = 0.02 }, { kind = \"winch_ripple\" },\n { kind = \"winch_ripple\" },\n { kind = \"winch_ripple\" }",
            29,
            &["`kind`", "`winch_ripple`", "already has twice", "cable1"],
        ),
        bad(
            "velocity_m_per_s = 0.02 }",
            "velocity_m_per_s = 0.02 }, { kind = \"winch_ripple\", sin_n = 0.1, period_m = 0.03 },\n { kind = \"winch_ripple\", cos_n = 0.1, period_m = 0.0302 }",
            28,
            &["`period_m` of effect `winch_ripple` is within 1 %", "cable1"],
        ),
        bad(
            "velocity_m_per_s = 0.02 }",
            "velocity_m_per_s = 0.02 }, { kind = \"winch_ripple\", sin_n = 0.1 },\n { kind = \"winch_ripple\", cos_n = -2e4 }",
            28,
            &["`cos_n` of effect `winch_ripple` is -20000;", "cable1"],
        ),
        Bad {
            text: with(EXAMPLE, "base_m = [0.55, 0.4, 0.5]", "").replace("platform_m = [0.06, 0.05, -0.05]", ""),
            line: Some(24),
            says: &["`wrap`", "pulley 3", "`base_m`", "`platform_m`"],
        },
        // No TOML.
        bad("[[cable]]", "[[cable]", 16, &["TOML"]),
        bad("name = \"rig\"", "name = \"rig", 2, &["TOML"]),
        bad("name = \"rig\"", "name = \"rig\"\nname = \"rag\"", 3, &["TOML", "duplicate key"]),
    ]
}

#[test]
fn every_mistake_is_named_with_file_line_and_key() {
    let mut failures = Vec::new();
    for Bad { text, line, says } in bad_files() {
        let said = match RobotFile::parse(&text, "rig.toml") {
            Ok(_) => "accepted".to_owned(),
            Err(error) => error.to_string(),
        };
        let place = line.map_or("rig.toml: ".to_owned(), |line| format!("rig.toml, line {line}: "));
        let missing: Vec<_> = says.iter().filter(|part| !said.contains(**part)).collect();
        if !said.starts_with(&place) || !missing.is_empty() || said.contains('\n') {
            failures.push(format!("said: {said}\n  wanted: {place}… {says:?}; lacks {missing:?}"));
        } else if std::env::var_os("SHOW_MESSAGES").is_some() {
            println!("{said}");
        }
    }
    assert!(failures.is_empty(), "{} messages are unclear:\n{}", failures.len(), failures.join("\n"));
}

#[test]
fn a_robot_without_a_cable_is_told_how_many_it_may_have() {
    let text = SHORT.split_once("[[cable]]").unwrap().0.to_owned() + "cable = []\n";
    assert_eq!(message(&text), "rig.toml, line 4: `cable` has 0 entries; allowed is 1 to 64");
}

#[test]
fn a_cycle_time_that_no_controller_has_is_warned_of() {
    for (cycle_s, is_slow) in [("0.001", false), ("0.2", false), ("1.0", true), ("4", true)] {
        let text = with(SHORT, "cycle_s = 0.001", &format!("cycle_s = {cycle_s}"));
        let warnings = RobotFile::parse(&text, "rig.toml").unwrap().warnings();
        assert_eq!(warnings.len(), usize::from(is_slow), "{warnings:?}");
        assert!(warnings.iter().all(|warning| warning.starts_with("`cycle_s` of the robot file is ")), "{warnings:?}");
    }
}

#[test]
fn options_without_a_text_name_the_key_too() {
    let mut options = RobotFile::parse(EXAMPLE, "rig.toml").unwrap().options().clone();
    options.cable[0].friction.mu = f64::NAN;
    let error = RobotFile::check(options).unwrap_err().to_string();
    assert!(error.contains("cable1") && error.contains("`mu`") && error.contains("NaN"), "{error}");
}

#[test]
fn nothing_that_is_read_panics() {
    let mut random = crate::random::Random::new(71);
    let pieces: Vec<&str> = EXAMPLE.split_inclusive([' ', '\n', ',', '=']).collect();
    for _ in 0..400 {
        let mut text = String::new();
        for piece in &pieces {
            match random.below(60) {
                0 => {}
                1 => text.push_str("nan"),
                2 => text.push_str(pieces[usize::try_from(random.below(pieces.len() as u64)).unwrap()]),
                3 => text.push('ö'),
                _ => text.push_str(piece),
            }
        }
        if let Err(error) = RobotFile::parse(&text, "rig.toml") {
            assert!(!error.to_string().is_empty());
        }
    }
    assert!(message("ö = 1").starts_with("rig.toml, line 1: "));
}

#[test]
fn an_error_at_the_end_is_in_the_last_line_that_there_is() {
    assert!(message("format = \"fric-robot/1\"\n'''name = 1\n\n").starts_with("rig.toml, line 2: "));
    assert!(message("\n\n").starts_with("rig.toml, line 1: "));
}

//! A text as a robot file: parsed, written and parsed again; edited and parsed again; run.
#![no_main]

use fric_core::effects::Effect;
use fric_core::robot::edit::{CableEdit, EffectEdit, FrictionEdit, rewrite};
use fric_core::robot::file::{RobotFile, RobotFileError, RobotOptions};
use fric_core::{AnyCompensator, CableInput, Pose};
use libfuzzer_sys::fuzz_target;

const FRICTION: FrictionEdit =
    FrictionEdit { mu: Some(0.0161), sigma_n_per_m: Some(998.5), viscous_n_s_per_m: None, offset_n: Some(-1e-3) };
const EFFECTS: [EffectEdit<'static>; 2] = [
    EffectEdit::Set { effect: Effect::Stribeck, parameters: &[("ratio", 0.5), ("velocity_m_per_s", 0.02)] },
    EffectEdit::Set { effect: Effect::BearingDrag, parameters: &[("drag_n", 0.25)] },
];

fuzz_target!(|text: &str| {
    let robot = match RobotFile::parse(text, "robot.toml") {
        Ok(robot) => robot,
        Err(error) => {
            check_error(&error, text);
            return;
        }
    };
    let written = robot.to_toml().expect("a checked file can be written");
    let again = RobotFile::parse(&written, "written").unwrap_or_else(|error| panic!("{error}\n{written}"));
    assert_eq!(again.options(), robot.options());
    let _ = robot.warnings();
    edit(text, &robot);
    run(&robot);
});

fn check_error(error: &RobotFileError, text: &str) {
    let RobotFileError::Invalid { line, problem, .. } = error else { panic!("{error}") };
    assert!(!problem.is_empty());
    assert!(line.is_none_or(|line| (1..=text.lines().count().max(1)).contains(&line)), "{error}");
}

/// An edited text says what the edited options say, or is refused; every other cable stays.
fn edit(text: &str, robot: &RobotFile) {
    let Some(name) = robot.cable_names().pop() else { return };
    let edits = [CableEdit { name, friction: FRICTION, effects: &EFFECTS, ..CableEdit::default() }];
    let Ok(edited) = rewrite(text, "robot.toml", &edits) else { return };
    let options = RobotFile::parse(&edited, "edited").unwrap_or_else(|error| panic!("{error}\n{edited}"));
    assert_eq!(*options.options(), changed(robot.options()));
    assert_eq!(rewrite(&edited, "edited", &edits).expect("what is there can be set"), edited);
}

fn changed(options: &RobotOptions) -> RobotOptions {
    let mut options = options.clone();
    let Some(cable) = options.cable.last_mut() else { return options };
    cable.friction.mu = FRICTION.mu.unwrap_or(cable.friction.mu);
    cable.friction.sigma_n_per_m = FRICTION.sigma_n_per_m;
    cable.friction.offset_n = FRICTION.offset_n.unwrap_or(cable.friction.offset_n);
    for edit in EFFECTS {
        let EffectEdit::Set { effect, parameters } = edit else { continue };
        let kind = effect.kind();
        if !cable.effects.iter().any(|effect| effect.kind == kind) {
            let parameters = std::collections::BTreeMap::new();
            cable.effects.push(fric_core::robot::file::EffectTable { kind: kind.to_owned(), parameters });
        }
        if let Some(effect) = cable.effects.iter_mut().find(|effect| effect.kind == kind) {
            effect.parameters.extend(parameters.iter().map(|(key, value)| ((*key).to_owned(), *value)));
        }
    }
    options
}

fn run(robot: &RobotFile) {
    let Ok(mut compensator) = AnyCompensator::new(&robot.params()) else { return };
    let cable_count = compensator.cable_count();
    for cycle in 0..8_u8 {
        let t = f64::from(cycle);
        let signals = CableInput { sensor_force_n: 20.0 - t, length_m: 1.0 + 1e-3 * t * (4.0 - t), speed_m_per_s: 0.1 };
        let pose = (cycle != 3).then(Pose::identity);
        compensator.set_input(&vec![signals; cable_count], pose, 1.0);
        let wrench = compensator.step();
        for output in compensator.outputs() {
            let numbers = [output.force_at_platform_n, output.friction_n, output.frictionless_n];
            assert!(numbers.iter().all(|number| number.is_finite()), "{output:?}");
        }
        assert!(wrench.is_none_or(|wrench| wrench.to_vector().iter().all(|part| part.is_finite())));
    }
}

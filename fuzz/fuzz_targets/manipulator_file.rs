//! A text as a manipulator file: parsed, written and parsed again; its shape computed.
#![no_main]

use fric_tendon::file::{ManipulatorFile, ManipulatorFileError};
use fric_tendon::{Direction, Friction, StaticModel, Tendon};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let manipulator = match ManipulatorFile::parse(text, "manipulator.toml") {
        Ok(manipulator) => manipulator,
        Err(error) => {
            let ManipulatorFileError::Invalid { line, .. } = &error else { panic!("{error}") };
            assert!(line.is_none_or(|line| (1..=text.lines().count().max(1)).contains(&line)), "{error}");
            return;
        }
    };
    let written = manipulator.to_toml().expect("a checked file can be written");
    let again = ManipulatorFile::parse(&written, "written").unwrap_or_else(|error| panic!("{error}\n{written}"));
    assert_eq!(again, manipulator);
    let Ok(mut model) = StaticModel::<12>::new(manipulator.params()) else { return };
    for friction in [Friction::None, Friction::Coulomb(Direction::Pulling), Friction::History, Friction::History] {
        for tension_n in [0.0, 0.3, 1.0] {
            let status = model.solve([tension_n, 0.1], friction);
            let shape = model.shape();
            let places = shape.disk_position_m().iter().flatten();
            let frictions = Tendon::BOTH.iter().flat_map(|tendon| shape.friction_n(*tendon));
            assert!(places.chain(frictions).all(|number| number.is_finite()), "{status}");
        }
    }
});

//! The manipulator file: the published prototype, and the sentences for what is wrong.

use std::path::Path;

use fric_core::continuum::file::ManipulatorFile;
use fric_core::continuum::{ManipulatorOptions, ManipulatorParams, Tendon};

const PROTOTYPE: &str = include_str!("../../../examples/tendon-prototype.toml");

/// The error of the prototype with one text replaced by another.
fn said(from: &str, to: &str) -> String {
    assert!(PROTOTYPE.contains(from), "{from}");
    ManipulatorFile::parse(&PROTOTYPE.replace(from, to), "arm.toml").unwrap_err().to_string()
}

#[test]
fn the_example_is_the_published_prototype() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/tendon-prototype.toml");
    let file = ManipulatorFile::read(&path).unwrap();
    assert_eq!(*file.params(), ManipulatorParams::new(&ManipulatorOptions::published()).unwrap());
    let again = ManipulatorFile::parse(&file.to_toml().unwrap(), "again").unwrap();
    assert_eq!(again, file);
}

#[test]
fn holes_may_differ_and_so_may_tendons() {
    let text = PROTOTYPE.replace("mu = 0.1753 ", "mu = [0.1, 0.2, 0.1, 0.2, 0.1, 0.2, 0.1, 0.2]")
        + "\n[antagonist]\nmu = 0\nsigma_n_per_m = 1e4\naxial_stiffness_n = 5e3\ncapacity_n = 2.0\n";
    let file = ManipulatorFile::parse(&text, "arm.toml").unwrap();
    assert_eq!(file.params().mu(Tendon::Agonist)[..3], [0.1, 0.2, 0.1]);
    assert_eq!(file.params().mu(Tendon::Antagonist), [0.0; 8]);
    assert_eq!(file.params().capacity_n(Tendon::Antagonist), 2.0);
    assert_eq!(ManipulatorFile::parse(&file.to_toml().unwrap(), "again").unwrap(), file);
}

#[test]
fn every_mistake_gets_its_sentence() {
    let long = said("mu = 0.1753 ", "mu = [0.1, 0.2]");
    assert_eq!(long, "arm.toml, line 20: `mu` of the tendon has 2 entries; 8 are needed");
    assert_eq!(
        said("mu = 0.1753 ", "mu = nan"),
        "arm.toml, line 20: `mu` of the tendon at place 1 is NaN, which is not a finite number; allowed is 0 to 0.9"
    );
    assert_eq!(
        said("mu = 0.1753 ", "mu = \"low\""),
        "arm.toml, line 20: `mu` is the text \"low\"; it must be a number, or a list with one for each hole"
    );
    assert_eq!(
        said("thickness_m = 0.0003", "thickness_m = 0.3e9"),
        "arm.toml, line 15: `thickness_m` is 3e8; allowed is 1e-6 to 1"
    );
    assert!(said("pitch_m", "pich_m").starts_with("arm.toml, line 7: unknown key `pich_m`; did you mean `pitch_m`?"));
    assert_eq!(
        said("[0.0, 0.0]", "[0.0, 0.0, -9.8]"),
        "arm.toml, line 11: `gravity_m_per_s2` has 3 entries; it must be 2 numbers in brackets"
    );
    assert_eq!(
        said("format = \"fric-continuum/1\"\n", ""),
        "arm.toml, line 1: `format` is missing; write format = \"fric-continuum/1\""
    );
    assert_eq!(
        said("continuum/1", "continuum/2"),
        "arm.toml, line 3: `format` is \"fric-continuum/2\"; this version reads \"fric-continuum/1\""
    );
    let tip = ManipulatorFile::parse(&(PROTOTYPE.to_owned() + "\n[tip]\nmass_kg = -1.0\n"), "arm.toml").unwrap_err();
    assert_eq!(tip.to_string(), "arm.toml, line 26: `mass_kg` is -1; allowed is 0 to 1000");
    let missing = ManipulatorFile::read(Path::new("no-such.toml")).unwrap_err().to_string();
    assert!(missing.starts_with("cannot read the manipulator file no-such.toml: "));
}

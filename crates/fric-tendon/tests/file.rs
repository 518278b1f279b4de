//! The manipulator file: the published prototype, and the sentences for what is wrong.

use std::path::Path;

use fric_tendon::edit::{GratingLine, ManipulatorEdit, rewrite};
use fric_tendon::file::{ManipulatorFile, OneOrEach};
use fric_tendon::measuring::{BaseSensorTable, MarkersTable};
use fric_tendon::{ManipulatorOptions, ManipulatorParams, Tendon};

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
        "arm.toml, line 20: `mu` is the text \"low\"; it must be a number, or a list with one for each hole or segment"
    );
    assert_eq!(
        said("thickness_m = 0.0003", "thickness_m = 0.3e9"),
        "arm.toml, line 15: `thickness_m` is 3e8; allowed is 1e-6 to 1"
    );
    assert!(said("pitch_m", "pich_m").starts_with("arm.toml, line 7: unknown key `pich_m`; did you mean `pitch_m`?"));
    assert_eq!(
        said("pitch_m = 0.037 ", "pitch_m = [0.037, 0.05]"),
        "arm.toml, line 7: `pitch_m` has 2 entries; 8 are needed"
    );
    assert_eq!(
        said("pitch_m = 0.037 ", "pitch_m = [0.037, 0.037, 37, 0.037, 0.037, 0.037, 0.037, 0.037]"),
        "arm.toml, line 7: `pitch_m` at place 3 is 37; allowed is 1e-5 to 10"
    );
    // Disks of 2 mm do not fit into the shortest segment.
    let thick = said("pitch_m = 0.037 ", "pitch_m = [0.037, 0.037, 0.001, 0.037, 0.037, 0.037, 0.037, 0.037]");
    assert_eq!(thick, "arm.toml, line 8: `disk_thickness_m` is 0.002; allowed is 0 to 0.001");
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

#[test]
fn segments_have_their_own_pitch() {
    let list = "pitch_m = [0.05, 0.045, 0.04, 0.035, 0.035, 0.03, 0.03, 0.031]";
    let file = ManipulatorFile::parse(&PROTOTYPE.replace("pitch_m = 0.037 ", list), "arm.toml").unwrap();
    let pitch_m = [0.05, 0.045, 0.04, 0.035, 0.035, 0.03, 0.03, 0.031];
    assert_eq!(file.params().pitch_m(), pitch_m);
    assert_eq!(file.tables().segment_pitch_m().collect::<Vec<_>>(), pitch_m);
    assert!((file.params().length_m() - 0.296).abs() < 1e-15 && (file.tables().length_m() - 0.296).abs() < 1e-15);
    let written = ManipulatorFile::parse(&file.to_toml().unwrap(), "arm.toml").unwrap();
    assert_eq!(written.params(), file.params());
    // One pitch, and the same as a list.
    let even = ManipulatorFile::parse(PROTOTYPE, "arm.toml").unwrap();
    let listed = PROTOTYPE.replace("pitch_m = 0.037 ", &format!("pitch_m = {:?}", [0.037; 8]));
    assert_eq!(ManipulatorFile::parse(&listed, "arm.toml").unwrap().params(), even.params());
    assert!((even.tables().length_m() - 0.296).abs() < 1e-15);
}

const GRATINGS: &str = "\n[gratings]\nwavelength_nm = 1550.0\nphotoelastic_ratio = 0.22\n";

#[test]
fn gratings_are_checked() {
    let said = |lines: &str| {
        let text = PROTOTYPE.to_owned() + "\n[gratings]\n" + lines;
        ManipulatorFile::parse(&text, "arm.toml").unwrap_err().to_string()
    };
    assert!(ManipulatorFile::parse(&(PROTOTYPE.to_owned() + GRATINGS), "arm.toml").is_ok());
    assert!(said("").starts_with("arm.toml, line 25: no tension follows from these gratings; give `newton_per_nm`"));
    assert_eq!(
        said("newton_per_nm = [11.0, 11.0]\n"),
        "arm.toml, line 26: `newton_per_nm` has 2 entries; 8 are needed, one for each segment"
    );
    let zero = said("newton_per_nm = [11, 11, 0, 11, 11, 11, 11, 11]\n");
    assert!(zero.contains("`newton_per_nm` of grating 3 is 0"), "{zero}");
    let not_finite = said("newton_per_nm = [11, nan, 11, 11, 11, 11, 11, 11]\n");
    assert!(not_finite.starts_with("arm.toml, line 26: `newton_per_nm` is NaN"), "{not_finite}");
    assert!(said("newton_per_n = [1.0]\n").contains("did you mean `newton_per_nm`?"));
    assert!(
        said("wavelength_nm = 1550.0\nphotoelastic_ratio = 0.22\nlength_m = 0.004\n").contains("give both or none")
    );
}

#[test]
fn a_calibration_goes_into_the_file_and_nothing_else_changes() {
    let with_calibration = |text: &str, origin: &str, lines: &[GratingLine]| {
        rewrite(text, origin, &ManipulatorEdit { lines: lines.to_vec(), ..ManipulatorEdit::default() })
    };
    let line = |place: u32| GratingLine {
        newton_per_nm: 11.0 + 0.1 * f64::from(place),
        offset_n: -0.01,
        standard_error_n: 0.005,
        line_error_n: 0.002,
        slope_error_n_per_nm: 0.03,
        mean_shift_nm: 0.1,
    };
    let lines: Vec<GratingLine> = (0..8).map(line).collect();
    let text = with_calibration(PROTOTYPE, "arm.toml", &lines).unwrap();
    assert!(text.starts_with(PROTOTYPE), "{text}");
    let read = ManipulatorFile::parse(&text, "arm.toml").unwrap();
    let gratings = read.tables().gratings.clone().unwrap();
    assert_eq!(gratings.newton_per_nm, lines.iter().map(|line| line.newton_per_nm).collect::<Vec<_>>());
    assert_eq!((gratings.offset_n.len(), gratings.standard_error_n[7]), (8, 0.005));
    assert_eq!(
        (gratings.line_error_n[7], gratings.slope_error_n_per_nm[0], gratings.mean_shift_nm[3]),
        (0.002, 0.03, 0.1)
    );
    // A second calibration replaces the first; what else is known of the gratings stays.
    let stated = PROTOTYPE.to_owned() + GRATINGS;
    let again =
        with_calibration(&with_calibration(&stated, "arm.toml", &lines[..]).unwrap(), "arm.toml", &lines).unwrap();
    assert_eq!(again.matches("\nnewton_per_nm").count(), 1);
    assert!(again.contains("photoelastic_ratio = 0.22"));
    assert!(with_calibration(PROTOTYPE, "arm.toml", &lines[..3]).unwrap_err().to_string().contains("8 are needed"));
    assert!(with_calibration("gratings = 3", "arm.toml", &lines).is_err());
}

#[test]
fn backbone_markers_and_base_sensor_may_be_stated() {
    let text = PROTOTYPE.replace(
        "mass_kg_per_m = 0.01413",
        "mass_kg_per_m = 0.01413\nsegment_stiffness_ratio = [1, 1, 0.5, 1, 1, 1, 1, 1]\nprecurvature_per_m = 0.3",
    ) + "\n[markers]\noffset_m = [0.005, 0.0]\nangle_rad = 0.05\n\n[base_sensor]\ngain = 1.02\nlag_s = 0.1\n";
    let file = ManipulatorFile::parse(&text, "arm.toml").unwrap();
    let stiffness = file.params().segment_stiffness_n_m2();
    assert_eq!((stiffness[2], stiffness.len()), (0.5 * stiffness[0], 8));
    assert!((file.params().rest_bend_rad()[7] - 0.3 * 0.037).abs() < 1e-15);
    assert_eq!(file.tables().base_sensor.unwrap().offset_n, 0.0);
    assert_eq!(ManipulatorFile::parse(&file.to_toml().unwrap(), "again").unwrap(), file);
    let said =
        |from: &str, to: &str| ManipulatorFile::parse(&text.replace(from, to), "arm.toml").unwrap_err().to_string();
    assert_eq!(
        said("1, 0.5, 1", "1, 0, 1"),
        "arm.toml, line 18: `segment_stiffness_ratio` at place 3 is 0; allowed is 0.01 to 100"
    );
    assert!(said("precurvature_per_m = 0.3", "precurvature_per_m = 30").contains("allowed is -27.0270"));
    assert_eq!(said("gain = 1.02", "gain = 0"), "arm.toml, line 32: `gain` is 0; allowed is 0.1 to 10");
    assert!(said("angle_rad = 0.05", "angle_rad = inf").starts_with("arm.toml, line 29: `angle_rad` is inf"));
    assert!(said("lag_s", "lags").contains("did you mean `lag_s`?"));
}

#[test]
fn an_edit_makes_one_file_the_other() {
    let given = ManipulatorFile::parse(PROTOTYPE, "arm.toml").unwrap();
    let mut tables = given.tables().clone();
    tables.hole_radius_m = 0.0157;
    tables.gravity_m_per_s2 = [1.0, -9.0];
    tables.backbone.youngs_modulus_pa = 1.9e11;
    tables.backbone.precurvature_per_m = Some(OneOrEach::One(0.2));
    tables.backbone.segment_stiffness_ratio = Some(OneOrEach::Each(vec![1.0, 0.5, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]));
    tables.tip.mass_kg = 0.001;
    tables.markers = Some(MarkersTable { offset_m: [0.001, 0.002], angle_rad: 0.1 });
    tables.base_sensor = Some(BaseSensorTable { gain: 1.1, offset_n: 0.1, lag_s: 0.0 });
    let edit = ManipulatorEdit::between(given.tables(), &tables);
    let text = rewrite(PROTOTYPE, "arm.toml", &edit).unwrap();
    assert_eq!(*ManipulatorFile::parse(&text, "new").unwrap().tables(), tables);
    assert!(text.contains("# holes on a circle of 30 mm"));
    assert_eq!(ManipulatorEdit::between(given.tables(), given.tables()), ManipulatorEdit::default());
}

/// The edited text differs from the given one in the edited value and the new key alone, whatever the editor on which the file was written.
#[test]
fn byte_order_mark_and_line_endings_stay() {
    let edit = ManipulatorEdit { mu: vec![0.2], segment_stiffness_ratio: vec![1.1], ..ManipulatorEdit::default() };
    let plain = rewrite(PROTOTYPE, "arm.toml", &edit).unwrap();
    assert!(plain.contains("segment_stiffness_ratio = 1.1\n") && !plain.contains('\r'));
    let marked = |text: &str| format!("\u{feff}{}", text.replace('\n', "\r\n"));
    assert_eq!(rewrite(&marked(PROTOTYPE), "arm.toml", &edit).unwrap(), marked(&plain));
    let unchanged = rewrite(&marked(PROTOTYPE), "arm.toml", &ManipulatorEdit::default()).unwrap();
    assert_eq!(unchanged, marked(PROTOTYPE));
    // Lines that end in different ways; a value that is set to itself.
    let mixed = PROTOTYPE.replacen('\n', "\r\n", 5);
    let edit = ManipulatorEdit { youngs_modulus_pa: Some(2e11), ..edit };
    assert_eq!(rewrite(&mixed, "arm.toml", &edit).unwrap(), plain.replacen('\n', "\r\n", 5));
}

/// Tables may be written in braces or with dotted keys, and the text may lack its last line ending.
#[test]
fn values_go_into_tables_however_they_are_written() {
    let markers = Some(MarkersTable { offset_m: [0.001, -0.002], angle_rad: 1e-7 });
    let edit = ManipulatorEdit { markers, tip_mass_kg: Some(0.002), ..ManipulatorEdit::default() };
    let edited = |text: &str| {
        let new = rewrite(text, "arm.toml", &edit).unwrap();
        let tables = ManipulatorFile::parse(&new, "new").unwrap().tables().clone();
        assert_eq!((tables.markers, tables.tip.mass_kg), (markers, 0.002), "{new}");
        new
    };
    let (head, rest) = PROTOTYPE.split_once("\n[backbone]").unwrap();
    let braces =
        format!("{head}tip = {{ force_n = [0, 1] }} # load\nmarkers = {{ angle_rad = 0.0 }}\n\n[backbone]{rest}");
    let expected = braces
        .replace("[0, 1] }", "[0, 1], mass_kg = 0.002 }")
        .replace("{ angle_rad = 0.0 }", "{ angle_rad = 1e-7, offset_m = [0.001, -0.002] }");
    assert_eq!(edited(&braces), expected);
    let dotted = format!("{head}tip.force_n = [0, 1] # load\n\n[backbone]{rest}");
    let expected = dotted.replace("# load\n", "# load\ntip.mass_kg = 0.002\n");
    assert_eq!(edited(&dotted), format!("{expected}\n[markers]\nangle_rad = 1e-7\noffset_m = [0.001, -0.002]\n"));
    let ended = edited(PROTOTYPE.trim_end());
    assert_eq!(
        ended,
        format!("{PROTOTYPE}\n[tip]\nmass_kg = 0.002\n\n[markers]\nangle_rad = 1e-7\noffset_m = [0.001, -0.002]\n")
    );
}

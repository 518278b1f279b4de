//! New parameters in a robot file: every layout, comments and order kept, numbers to the bit.

use fric_core::effects::Effect;
use fric_core::robot::edit::{CableEdit, EffectEdit, FrictionEdit, rewrite, set_monitor};
use fric_core::robot::file::{EffectTable, RobotFile, RobotOptions};
use proptest::prelude::*;

/// What precedes the cables in all of these.
const HEAD: &str = "# a rig\nformat = 'fric-robot/1'\nname = \"rig\"  # its name\ncycle_s = 1e-3\n\n";

/// Cables in every way in which one can be written; the cable to be changed is `a`, the other one `b`.
const LAYOUTS: &[&str] = &[
    // Friction in braces, effects in a list.
    "[[cable]]\nname = 'a' # left\npulleys = [{ wrap_deg = 180, sensor = true }] # two\n\
     friction = { mu = 0.02, sigma_n_per_m = 950.0 } # fitted\n\
     effects = [ { kind = 'stribeck', ratio = 0.3 } ] # seen\n# the other\n[[cable]]\nname = 'b'\n\
     pulleys = [{ wrap_deg = 90 }]\nfriction = { mu = 0.02 }\n",
    // Nothing of either.
    "[[cable]]\nname = 'b'\npulleys = [{ wrap_deg = 90 }]\n\n[[cable]]\n  name = 'a'\n  pulleys = [\n    { wrap_deg = 180 }, # one\n  ] # all\n  # more\n  presliding = 'lumped'\n",
    "[[cable]]\npulleys = [{ wrap_deg = 180 }]\nname = 'a' # at the end of the file",
    // Empty ones.
    "[[cable]]\nname = 'a'\nfriction = {}\neffects = []\npulleys = [{ wrap_deg = 180 }]\n",
    "[[cable]]\nname = 'a'\neffects = [ # none yet\n]\npulleys = [{ wrap_deg = 180 }]\n[cable.friction] # empty\n# end\n",
    // Tables under headers, and another one after them.
    "[[cable]]\nname = 'a'\npulleys = [{ wrap_deg = 180 }]\n\n  [cable.friction] # of a\n  # bearing\n  mu = 2e-2 # 1\n\n\
     [[cable.effects]] # slow\nkind = 'stribeck'\n  ratio = 0.3 # rest\n\n# range\n[cable.validated]\nspeed_m_per_s = 1.0\n\n\
     [[cable]]\nname = 'b'\n[[cable.pulleys]]\nwrap_deg = 90.0\n",
    "[[cable]]\nname = 'a' # first\n[[cable.pulleys]]\nwrap_deg = 90.0\n[[cable.effects]]\nkind = 'time_delay'\ndelay_s = 0.002\n",
    // Dotted keys, apart from one another too.
    "[[cable]]\nname = 'a'\nfriction.mu = 0.02 # 1\npulleys = [{ wrap_deg = 180 }]\nfriction . sigma_n_per_m = 950 # N/m\n",
    "[[cable]]\nname = 'a'\n\tfriction.offset_n = 1 # N\n\tpulleys = [{ wrap_deg = 180 }]\n",
    // All of it in braces.
    "cable = [\n  { name = 'a', pulleys = [{ wrap_deg = 180 }], friction.mu = 0.02 }, # left\n  { name = 'b', pulleys = [{ wrap_deg = 90 }] },\n]\n",
    "cable = [ { name = 'b', pulleys = [{ wrap_deg = 90 }] }, { name = 'a', pulleys = [{ wrap_deg = 180 }], effects = [] } ]\n",
    // Over several lines, with and without a comma behind the last.
    "[[cable]]\nname = 'a'\npulleys = [{ wrap_deg = 180 }]\nfriction = { # ours\n  mu = 0.02, # 1\n  offset_n = -0.1 # N\n}\n\
     effects = [\n  { kind = 'time_delay', delay_s = 0.002 }, # bus\n  { kind = 'stribeck', ratio = 0.3 } # grease\n]\n",
    "[[cable]]\nname = 'a'\npulleys = [{ wrap_deg = 180 }]\nfriction = {\n    mu = 0.02,\n    offset_n = -0.1, # N\n    # end\n}\n\
     effects = [\n    # the bus\n    { kind = 'time_delay', delay_s = 0.002 }, # 2 cycles\n    # more\n]\n",
    "[[cable]]\nname = 'a'\npulleys = [{ wrap_deg = 180 }]\nfriction = { mu = 0.02\n , }\neffects = [{ kind = 'stribeck' }\n, ]\n",
];

/// The text of a layout, and the same with the line ends of Windows.
fn texts() -> impl Iterator<Item = String> {
    LAYOUTS.iter().flat_map(|cables| {
        let text = format!("{HEAD}{cables}");
        let windows = text.replace('\n', "\r\n");
        [text, windows]
    })
}

fn options(text: &str) -> RobotOptions {
    RobotFile::parse(text, "rig.toml").unwrap_or_else(|error| panic!("{error}\n{text}")).options().clone()
}

/// The same change, made to what the file says instead of to its text.
fn changed(text: &str, friction: &FrictionEdit, effects: &[EffectEdit<'_>]) -> RobotOptions {
    let mut options = options(text);
    let cable = options.cable.iter_mut().find(|cable| cable.name == "a").unwrap();
    let FrictionEdit { mu, sigma_n_per_m, viscous_n_s_per_m, offset_n } = *friction;
    cable.friction.mu = mu.unwrap_or(cable.friction.mu);
    cable.friction.sigma_n_per_m = sigma_n_per_m.or(cable.friction.sigma_n_per_m);
    cable.friction.viscous_n_s_per_m = viscous_n_s_per_m.unwrap_or(cable.friction.viscous_n_s_per_m);
    cable.friction.offset_n = offset_n.unwrap_or(cable.friction.offset_n);
    let place = |effects: &[EffectTable], effect: Effect| {
        let mut of_kind = effects.iter().enumerate().filter(|(_, of)| of.kind == effect.kind());
        of_kind.nth(usize::from(effect.is_second())).map(|(place, _)| place)
    };
    for effect in effects {
        match *effect {
            EffectEdit::Remove { effect } => drop(cable.effects.remove(place(&cable.effects, effect).unwrap())),
            EffectEdit::Set { effect, parameters } => {
                let place = place(&cable.effects, effect).unwrap_or_else(|| {
                    cable.effects.push(EffectTable { kind: effect.kind().to_owned(), parameters: [].into() });
                    cable.effects.len() - 1
                });
                let parameters = parameters.iter().map(|(key, value)| ((*key).to_owned(), *value));
                cable.effects[place].parameters.extend(parameters);
            }
        }
    }
    options
}

fn comments(text: &str) -> Vec<&str> {
    text.lines().filter_map(|line| Some(line.split_once('#')?.1.trim())).collect()
}

fn edited(text: &str, friction: FrictionEdit, effects: &[EffectEdit<'_>]) -> String {
    rewrite(text, "rig.toml", &[CableEdit { name: "a", friction, effects, ..CableEdit::default() }])
        .unwrap_or_else(|error| panic!("{error}\n{text}"))
}

const SET: [EffectEdit<'static>; 2] = [
    EffectEdit::Set { effect: Effect::Stribeck, parameters: &[("ratio", 0.5), ("velocity_m_per_s", 0.02)] },
    EffectEdit::Set { effect: Effect::TimeDelay, parameters: &[("delay_s", 0.006)] },
];
/// Two of one kind, around another.
const TWICE: [EffectEdit<'static>; 3] = [
    EffectEdit::Set { effect: Effect::WinchRipple, parameters: &[("sin_n", 0.5), ("period_m", 0.03)] },
    SET[0],
    EffectEdit::Set { effect: Effect::WinchRipple2, parameters: &[("cos_n", -0.2), ("period_m", 0.015)] },
];

#[test]
fn every_layout_takes_every_value() {
    let all = FrictionEdit {
        mu: Some(0.0161),
        sigma_n_per_m: Some(998.0),
        viscous_n_s_per_m: Some(0.17),
        offset_n: Some(-0.001),
    };
    for text in texts() {
        for friction in [all, FrictionEdit { offset_n: None, ..all }, FrictionEdit::default()] {
            for effects in [&SET[..], &SET[1..], &SET[..1], &TWICE, &[]] {
                let new = edited(&text, friction, effects);
                assert_eq!(options(&new), changed(&text, &friction, effects), "{text}\n{new}");
                // In the same order, for what is new has none.
                assert_eq!(comments(&new), comments(&text), "{new}");
                assert_eq!(new.contains("\r\n"), text.contains("\r\n"));
                assert!(!text.contains("\r\n") || new.matches('\n').count() == new.matches("\r\n").count(), "{new:?}");
                // Once more, it is as it is.
                assert_eq!(edited(&new, friction, effects), new);
            }
        }
    }
}

#[test]
fn an_effect_added_can_be_taken_away() {
    for text in texts() {
        let has = |kind: &str| {
            options(&text).cable.iter().any(|cable| cable.effects.iter().any(|effect| effect.kind == kind))
        };
        let with = edited(&text, FrictionEdit::default(), &SET);
        for kinds in [&["stribeck"][..], &["time_delay"], &["stribeck", "time_delay"], &["time_delay", "stribeck"]] {
            let remove = |kind: &&str| EffectEdit::Remove { effect: Effect::of_kind(kind).unwrap() };
            let effects: Vec<_> = kinds.iter().map(remove).collect();
            let without = edited(&with, FrictionEdit::default(), &effects);
            assert_eq!(options(&without), changed(&with, &FrictionEdit::default(), &effects), "{with}\n{without}");
            // Of the comments only those on the line of an effect go.
            if kinds.iter().all(|kind| !has(kind)) {
                assert_eq!(comments(&without), comments(&text), "{without}");
            }
        }
    }
}

#[test]
fn each_of_two_of_a_kind_is_changed_and_taken_away_by_itself() {
    for text in texts() {
        let with = edited(&text, FrictionEdit::default(), &TWICE);
        for effect in [Effect::WinchRipple, Effect::WinchRipple2] {
            let set = [EffectEdit::Set { effect, parameters: &[("sin_n", 0.7)] }];
            for edits in [set, [EffectEdit::Remove { effect }]] {
                let new = edited(&with, FrictionEdit::default(), &edits);
                assert_eq!(options(&new), changed(&with, &FrictionEdit::default(), &edits), "{with}\n{new}");
            }
        }
    }
}

#[test]
fn it_looks_like_written_by_hand() {
    let friction =
        FrictionEdit { mu: Some(0.02), sigma_n_per_m: Some(950.0), viscous_n_s_per_m: Some(1e-6), offset_n: Some(0.0) };
    let shown = |layout: usize| {
        let text = format!("{HEAD}{}", LAYOUTS[layout]);
        edited(&text, friction, &SET).strip_prefix(HEAD).unwrap().to_owned()
    };
    assert_eq!(
        shown(0),
        "[[cable]]\nname = 'a' # left\npulleys = [{ wrap_deg = 180, sensor = true }] # two\n\
         friction = { mu = 0.02, sigma_n_per_m = 950.0, viscous_n_s_per_m = 1e-6, offset_n = 0.0 } # fitted\n\
         effects = [ { kind = 'stribeck', ratio = 0.5, velocity_m_per_s = 0.02 }, \
         { kind = \"time_delay\", delay_s = 0.006 } ] # seen\n# the other\n[[cable]]\nname = 'b'\n\
         pulleys = [{ wrap_deg = 90 }]\nfriction = { mu = 0.02 }\n"
    );
    let friction_line = "friction = { mu = 0.02, sigma_n_per_m = 950.0, viscous_n_s_per_m = 1e-6, offset_n = 0.0 }";
    let effects_line = "effects = [ { kind = \"stribeck\", ratio = 0.5, velocity_m_per_s = 0.02 }, \
                        { kind = \"time_delay\", delay_s = 0.006 } ]";
    assert_eq!(
        shown(1),
        format!(
            "[[cable]]\nname = 'b'\npulleys = [{{ wrap_deg = 90 }}]\n\n[[cable]]\n  name = 'a'\n  pulleys = [\n    \
             {{ wrap_deg = 180 }}, # one\n  ] # all\n  {friction_line}\n  {effects_line}\n  # more\n  presliding = 'lumped'\n"
        )
    );
    assert_eq!(
        shown(5),
        "[[cable]]\nname = 'a'\npulleys = [{ wrap_deg = 180 }]\n\n  [cable.friction] # of a\n  # bearing\n  mu = 2e-2 # 1\n  \
         sigma_n_per_m = 950.0\n  viscous_n_s_per_m = 1e-6\n  offset_n = 0.0\n\n\
         [[cable.effects]] # slow\nkind = 'stribeck'\n  ratio = 0.5 # rest\n  velocity_m_per_s = 0.02\n\n\
         [[cable.effects]]\n  kind = \"time_delay\"\n  delay_s = 0.006\n\n# range\n[cable.validated]\nspeed_m_per_s = 1.0\n\n\
         [[cable]]\nname = 'b'\n[[cable.pulleys]]\nwrap_deg = 90.0\n"
    );
    assert_eq!(
        shown(7),
        format!(
            "[[cable]]\nname = 'a'\nfriction.mu = 0.02 # 1\npulleys = [{{ wrap_deg = 180 }}]\n{effects_line}\n\
             friction . sigma_n_per_m = 950 # N/m\nfriction.viscous_n_s_per_m = 1e-6\nfriction.offset_n = 0.0\n"
        )
    );
    assert_eq!(
        shown(11),
        "[[cable]]\nname = 'a'\npulleys = [{ wrap_deg = 180 }]\nfriction = { # ours\n  mu = 0.02, # 1\n  offset_n = 0.0, # N\n  \
         sigma_n_per_m = 950.0,\n  viscous_n_s_per_m = 1e-6\n}\n\
         effects = [\n  { kind = 'time_delay', delay_s = 0.006 }, # bus\n  \
         { kind = 'stribeck', ratio = 0.5, velocity_m_per_s = 0.02 } # grease\n]\n"
    );
    let text = format!("{HEAD}{}", LAYOUTS[11]);
    let bus = edited(&text, FrictionEdit::default(), &[EffectEdit::Remove { effect: Effect::Stribeck }]);
    assert!(bus.ends_with("effects = [\n  { kind = 'time_delay', delay_s = 0.002 } # bus\n]\n"), "{bus}");
}

#[test]
fn what_is_not_there_or_not_right_is_told() {
    let text = format!("{HEAD}{}", LAYOUTS[0]);
    let says = |name, friction, effects: &[EffectEdit<'_>]| {
        rewrite(&text, "rig.toml", &[CableEdit { name, friction, effects, ..CableEdit::default() }])
            .unwrap_err()
            .to_string()
    };
    let mu = |mu| FrictionEdit { mu: Some(mu), ..FrictionEdit::default() };
    for (said, words) in [
        (says("c", mu(0.01), &[]), &["rig.toml: ", "unknown cable `c`", "`a`, `b`"][..]),
        (
            says("a", mu(0.95), &[]),
            &["rig.toml with the new values, line 9: ", "cable \"a\": `mu` is 0.95;", "0 to 0.9"],
        ),
        (says("a", mu(f64::NAN), &[]), &["`mu` is NaN"]),
        (says("a", mu(f64::NEG_INFINITY), &[]), &["`mu` is -inf"]),
        (
            says("b", mu(0.01), &[EffectEdit::Remove { effect: Effect::Stribeck }]),
            &["cable \"b\" has no effect `stribeck`"],
        ),
        (
            says("b", mu(0.01), &[EffectEdit::Remove { effect: Effect::WinchRipple2 }]),
            &["cable \"b\" has no effect `winch_ripple_2` to be removed"],
        ),
        (says("b", mu(0.01), &TWICE[2..]), &["cable \"b\" has no effect `winch_ripple` for a second one to follow"]),
        (
            says("b", mu(0.01), &[EffectEdit::Set { effect: Effect::Stribeck, parameters: &[("rati", 0.5)] }]),
            &["`rati`", "did you mean `ratio`?"],
        ),
    ] {
        for word in words {
            assert!(said.contains(word), "{word}: {said}");
        }
    }
    let wrong = rewrite(&text.replace("cycle_s", "cycle"), "rig.toml", &[]).unwrap_err().to_string();
    assert!(wrong.starts_with("rig.toml, line 4: "), "{wrong}");
    assert_eq!(rewrite(&text, "rig.toml", &[]).unwrap(), text);
}

/// Every other byte stays where the lines of a file end in different ways, and a new line ends like the one above it.
#[test]
fn mixed_line_endings_stay() {
    let text =
        format!("{HEAD}{}", LAYOUTS[1].replace("name = 'a'\n", "name = 'a'\r\n").replace("] # all\n", "] # all\r\n"));
    let new = edited(&text, FrictionEdit { mu: Some(0.02), ..FrictionEdit::default() }, &[]);
    assert_eq!(new, text.replace("] # all\r\n", "] # all\r\n  friction = { mu = 0.02 }\r\n"));
    let text = format!("{}{}", HEAD.replace('\n', "\r\n"), LAYOUTS[1]);
    let new = edited(&text, FrictionEdit { mu: Some(0.02), ..FrictionEdit::default() }, &[]);
    assert_eq!(new, text.replace("] # all\n", "] # all\n  friction = { mu = 0.02 }\n"));
}

#[test]
fn a_byte_order_mark_stays() {
    let text = format!("\u{feff}{HEAD}{}", LAYOUTS[0]);
    let friction = FrictionEdit { mu: Some(0.01), ..FrictionEdit::default() };
    let new = edited(&text, friction, &[]);
    assert_eq!(new, text.replacen("mu = 0.02", "mu = 0.01", 1));
}

/// Numbers of every size, and those that people write.
fn value(range: core::ops::RangeInclusive<f64>) -> impl Strategy<Value = f64> {
    let (min, max) = (*range.start(), *range.end());
    let short = (-999_999_i32..1_000_000, -8_i32..8).prop_map(|(digits, power)| f64::from(digits) * 10_f64.powi(power));
    let any = any::<f64>();
    prop_oneof![short, any, range].prop_filter("in range", move |value| (min..=max).contains(value))
}

proptest! {
    #[test]
    fn numbers_are_read_back_to_the_bit(
        layout in 0..LAYOUTS.len(),
        mu in proptest::option::of(value(0.0..=0.14)),
        sigma_n_per_m in proptest::option::of(value(1e-3..=1e12)),
        viscous_n_s_per_m in proptest::option::of(value(0.0..=1e6)),
        offset_n in proptest::option::of(value(-1e6..=1e6)),
        ratio in value(-0.9..=5.0),
        delay_s in value(0.0..=0.063),
    ) {
        let text = format!("{HEAD}{}", LAYOUTS[layout]);
        let friction = FrictionEdit { mu, sigma_n_per_m, viscous_n_s_per_m, offset_n };
        let (stribeck, delay) = ([("ratio", ratio)], [("delay_s", delay_s)]);
        let effects = [
            EffectEdit::Set { effect: Effect::Stribeck, parameters: &stribeck },
            EffectEdit::Set { effect: Effect::TimeDelay, parameters: &delay },
        ];
        let new = edited(&text, friction, &effects);
        let (found, wanted) = (options(&new), changed(&text, &friction, &effects));
        prop_assert_eq!(&found, &wanted);
        let bits = |options: &RobotOptions| {
            let cable = options.cable.iter().find(|cable| cable.name == "a").unwrap();
            let values = [cable.friction.mu, cable.friction.viscous_n_s_per_m, cable.friction.offset_n];
            let effects = cable.effects.iter().flat_map(|effect| effect.parameters.values());
            let all = values.iter().chain(&cable.friction.sigma_n_per_m).chain(effects);
            all.map(|value| value.to_bits()).collect::<Vec<_>>()
        };
        prop_assert_eq!(bits(&found), bits(&wanted));
    }
}

/// A number of the monitor, in every layout of the cables and with every way to write the monitor.
#[test]
fn a_number_of_the_monitor_is_set_and_nothing_else() {
    const MONITORS: [&str; 5] = [
        "",
        "monitor = { frozen_cycles = 50 } # ours\n",
        "monitor.frozen_cycles = 50 # ours\n",
        "monitor.length_noise_m = 1e-6 # seen\nmonitor.frozen_cycles = 50\n",
        "[monitor] # ours\n  frozen_cycles = 50\n\n",
    ];
    for (cables, monitor) in LAYOUTS.iter().flat_map(|cables| MONITORS.map(|monitor| (cables, monitor))) {
        if monitor.starts_with('[') && cables.starts_with("cable = ") {
            continue;
        }
        for text in [format!("{HEAD}{monitor}{cables}"), format!("{HEAD}{monitor}{cables}").replace('\n', "\r\n")] {
            let set = set_monitor(&text, "rig.toml", "length_noise_m", 6.13e-6).unwrap();
            let mut expected = options(&text);
            expected.monitor.length_noise_m = Some(6.13e-6);
            assert_eq!(options(&set), expected, "{set}");
            assert_eq!(set.matches('#').count(), text.matches('#').count(), "{set}");
            assert_eq!(
                set.matches("\r\n").count(),
                set.matches('\n').count() * usize::from(text.contains('\r')),
                "{set}"
            );
            assert_eq!(set_monitor(&set, "rig.toml", "length_noise_m", 6.13e-6).unwrap(), set);
        }
    }
    let text = format!("{HEAD}{}", LAYOUTS[0]);
    let refused = set_monitor(&text, "rig.toml", "length_noise_m", f64::NAN).unwrap_err().to_string();
    assert!(refused.contains("length_noise_m"), "{refused}");
    assert!(set_monitor("name = 1", "rig.toml", "length_noise_m", 1e-6).is_err());
}

//! Hidden effects as people write them.

use fric_lab::simulate::{HiddenEffect, Simulation, SimulationOptions};

use super::robots::{bench, noiseless, simulate};

fn problem(text: &str) -> String {
    HiddenEffect::parse(text).expect_err(text).to_string()
}

#[test]
fn what_is_written_is_what_is_meant() {
    let effect: HiddenEffect = " stribeck : ratio = 0.5, velocity_m_per_s=2e-2 ".parse().unwrap();
    assert_eq!(effect.to_string(), "stribeck:ratio=0.5,velocity_m_per_s=0.02");
    assert_eq!(HiddenEffect::parse(&effect.to_string()), Ok(effect.clone()));
    assert_eq!(effect.values(), [("ratio", 0.5), ("velocity_m_per_s", 0.02)]);
    assert_eq!(HiddenEffect::new("stribeck", effect.values()), Ok(effect));
}

#[test]
fn errors_name_what_is_known() {
    let unknown = problem("stribek:ratio=0.5");
    assert!(
        unknown.starts_with("there is no effect `stribek`; did you mean `stribeck`? known are `stribeck`, `"),
        "{unknown}"
    );
    assert!(problem("").starts_with("there is no effect ``; known are `stribeck`"));
    assert!(problem("zzz:a=1").starts_with("there is no effect `zzz`; known are `stribeck`"));
    let key = problem("stribeck:ration=0.5");
    assert!(
        key.starts_with(
            "the effect `stribeck` has no parameter `ration`; did you mean `ratio`? it has `ratio` (-0.9 to 5), \
             `velocity_m_per_s` (0.0001 to 10 m/s)"
        ),
        "{key}"
    );
    assert_eq!(problem("time_delay:delay_s=2"), "`delay_s` of the effect `time_delay` is 2; allowed is -1 to 1 s");
    assert!(problem("time_delay:delay_s=NaN").contains("is NaN; allowed is -1 to 1 s"));
    assert!(problem("time_delay:delay_s").starts_with("`delay_s` is not `key=value` with a number"));
    assert!(problem("time_delay:delay_s=8ms").starts_with("`delay_s=8ms` is not `key=value` with a number"));
    assert!(problem("time_delay").starts_with("the effect `time_delay` has no value, which would hide nothing"));
    assert_eq!(problem("stribeck:ratio=0.1,ratio=0.2"), "the effect `stribeck` has the parameter `ratio` twice");
}

#[test]
fn an_effect_hidden_twice_is_refused() {
    let effect = HiddenEffect::parse("stribeck:ratio=0.5").unwrap();
    let options = SimulationOptions { effects: vec![effect.clone(), effect], ..noiseless() };
    let error = Simulation::new(&bench("{ wrap_deg = 90.0, sensor = true }", "mu = 0.02"), &options).unwrap_err();
    assert_eq!(error.to_string(), "the effect `stribeck` is hidden too often");
}

#[test]
fn options_out_of_range_are_named() {
    let robot = bench("{ wrap_deg = 90.0, sensor = true }", "mu = 0.02");
    let cases = [
        SimulationOptions { duration_s: Some(0.0), ..noiseless() },
        SimulationOptions { duration_s: Some(f64::NAN), ..noiseless() },
        SimulationOptions { sensor_noise_n: -0.1, ..noiseless() },
        SimulationOptions { reference_noise_n: f64::INFINITY, ..noiseless() },
        SimulationOptions { mu_spread_ratio: 1.5, ..noiseless() },
    ];
    let texts = cases.map(|options| Simulation::new(&robot, &options).unwrap_err().to_string());
    assert_eq!(texts[0], "`duration_s` is 0; allowed is 0.001 to 8640000");
    assert!(texts[1].starts_with("`duration_s` is NaN"));
    assert_eq!(texts[2], "`sensor_noise_n` is -0.1; allowed is 0 to 1000000");
    assert!(texts[3].starts_with("`reference_noise_n` is inf"));
    assert_eq!(texts[4], "`mu_spread_ratio` is 1.5; allowed is 0 to 1");
}

#[test]
fn a_delay_moves_the_log_and_nothing_else() {
    let robot = bench("{ wrap_deg = 180.0, sensor = true }", "mu = 0.02, sigma_n_per_m = 1000.0");
    let delayed = HiddenEffect::parse("time_delay:delay_s=0.003").unwrap();
    let short = SimulationOptions { duration_s: Some(3.0), ..SimulationOptions::default() };
    let mut plain = simulate(&robot, &short);
    let mut ahead = simulate(&robot, &SimulationOptions { effects: vec![delayed], ..short });
    let mut lengths_m = Vec::new();
    while let (Some(one), Some(other)) = (plain.next_cycle(), ahead.next_cycle()) {
        assert_eq!(one.cables[0].sensor_force_n.to_bits(), other.cables[0].sensor_force_n.to_bits());
        assert_eq!(one.reference_force_n[0].to_bits(), other.reference_force_n[0].to_bits());
        lengths_m.push((one.cables[0], other.cables[0]));
    }
    for ((_, earlier), (later, _)) in lengths_m.iter().zip(lengths_m.iter().skip(3)) {
        assert!((earlier.length_m - later.length_m).abs() < 1e-12);
        assert!((earlier.speed_m_per_s - later.speed_m_per_s).abs() < 1e-11);
    }
}

#[test]
fn stribeck_changes_the_sensor_and_nothing_else() {
    let robot = bench("{ wrap_deg = 180.0, sensor = true }", "mu = 0.02, sigma_n_per_m = 1000.0");
    let hidden = HiddenEffect::parse("stribeck:ratio=0.5").unwrap();
    let short = SimulationOptions { duration_s: Some(3.0), ..SimulationOptions::default() };
    let mut plain = simulate(&robot, &short);
    let mut rubbed = simulate(&robot, &SimulationOptions { effects: vec![hidden], ..short });
    let mut greatest_n = 0.0_f64;
    while let (Some(one), Some(other)) = (plain.next_cycle(), rubbed.next_cycle()) {
        assert_eq!(one.reference_force_n, other.reference_force_n);
        assert_eq!(one.cables[0].length_m.to_bits(), other.cables[0].length_m.to_bits());
        greatest_n = greatest_n.max((one.cables[0].sensor_force_n - other.cables[0].sensor_force_n).abs());
    }
    assert!(greatest_n > 0.02, "{greatest_n}");
}

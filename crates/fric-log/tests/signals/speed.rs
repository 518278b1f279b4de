//! Speeds derived from lengths, against the motion's own.

use std::f64::consts::PI;

use fric_log::signals::LengthWindow;

/// Seconds and metres.
type Lengths = Vec<(f64, f64)>;

fn derived_m_per_s(lengths: &Lengths) -> Vec<f64> {
    let mut window = LengthWindow::default();
    for (time_s, length_m) in lengths {
        #[expect(clippy::cast_possible_truncation, reason = "a few seconds")]
        window.push((time_s * 1e9).round() as i64, *length_m);
    }
    let next = |_: &(f64, f64)| {
        let speed_m_per_s = window.speed_m_per_s();
        window.advance();
        speed_m_per_s
    };
    lengths.iter().map(next).collect()
}

fn every_millisecond(count: u32, length_m: impl Fn(f64) -> f64) -> Lengths {
    (0..count).map(|row| 1e-3 * f64::from(row)).map(|time_s| (time_s, length_m(time_s))).collect()
}

/// Numbers of mean 0 and variance 1 (sums of twelve uniform ones).
fn normal(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    let mut uniform = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from(u32::try_from(state >> 33).unwrap()) / f64::from(1_u32 << 31)
    };
    move || (0..12).map(|_| uniform()).sum::<f64>() - 6.0
}

fn rms(numbers: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = numbers.fold((0.0, 0.0), |(sum, count), it| (sum + it * it, count + 1.0));
    (sum / count).sqrt()
}

/// The parabola through three lengths errs by the third derivative of the length, times the product of both intervals, divided by six.
#[test]
fn a_changing_acceleration_is_followed_at_irregular_times() {
    let x = |t: f64| 1.0 + 0.2 * t - 0.7 * t * t + 3.0 * t * t * t;
    let times = (0..200).map(|row| 1e-3 * (f64::from(row) + 0.3 * f64::from(row % 3)));
    let lengths: Lengths = times.map(|t| (t, x(t))).collect();
    for ((t, _), found) in lengths.iter().zip(derived_m_per_s(&lengths)) {
        let error = found - (0.2 - 1.4 * t + 9.0 * t * t);
        assert!(error.abs() < 18.0 * 1.3e-3 * 2.6e-3 / 6.0 + 1e-9, "{t} {error}");
    }
}

/// The standard error of the slope of a cubic through 2m + 1 values is s/dt·√(S₆/(S₂S₆ − S₄²)) with the sums Sₙ of kⁿ over them; no window has less
/// than the widest, which is refused now and then, and then for its neighbours too.
#[test]
fn noise_is_averaged_over_the_widest_window() {
    let mut noise = normal(3);
    let lengths: Lengths = every_millisecond(5000, |t| 1.0 + 0.1 * t - 0.02 * t * t)
        .into_iter()
        .map(|(t, x)| (t, x + 1e-6 * noise()))
        .collect();
    let errors = lengths.iter().zip(derived_m_per_s(&lengths)).map(|((t, _), found)| found - (0.1 - 0.04 * t));
    let error = rms(errors.skip(LengthWindow::REACH).take(5000 - 2 * LengthWindow::REACH));
    let reach: i32 = 20;
    let [second, fourth, sixth] =
        [2, 4, 6].map(|power| (-reach..=reach).map(|k| f64::from(k).powi(power)).sum::<f64>());
    let least = 1e-6 / 1e-3 * (sixth / (second * sixth - fourth * fourth)).sqrt();
    assert!((0.95..1.15).contains(&(error / least)), "{error} instead of {least}");
}

/// Strokes there and back of 0.1 s, at up to 0.37 m/s and 11.5 m/s², and rests, read in steps of 1 µm.
#[test]
fn steps_of_the_encoder_go_and_the_motion_stays() {
    let speed = |t: f64| match t % 0.4 {
        t if t < 0.1 => 0.365 * (PI * t / 0.1).sin().powi(2),
        t if (0.2..0.3).contains(&t) => -0.365 * (PI * (t - 0.2) / 0.1).sin().powi(2),
        _ => 0.0,
    };
    let mut length_m = 1.0;
    let lengths: Lengths = (0..4000)
        .map(|row| {
            let t = 1e-3 * f64::from(row);
            length_m += (0..20).map(|part| speed(t - 1e-3 + 5e-5 * (f64::from(part) + 0.5)) * 5e-5).sum::<f64>();
            (t, (length_m * 1e6).round() * 1e-6)
        })
        .collect();
    let found: Vec<f64> = lengths.iter().zip(derived_m_per_s(&lengths)).map(|((t, _), it)| it - speed(*t)).collect();
    let neighbours = lengths.windows(3).map(|it| (it[2].1 - it[0].1) / 2e-3 - speed(it[1].0));
    let (ours, theirs) = (rms(found[1..3999].iter().copied()), rms(neighbours));
    assert!(ours < 0.65 * theirs, "{ours} instead of {theirs}");
}

#[test]
fn a_jump_and_a_clock_that_is_set_spoil_no_more_than_their_neighbours() {
    let mut lengths = every_millisecond(300, |t| 1.0 + 0.1 * t + if t > 0.1005 { 0.01 } else { 0.0 });
    // From row 200 on the clock goes half a second behind.
    lengths[200..].iter_mut().for_each(|(time_s, _)| *time_s -= 0.5);
    for (row, found) in derived_m_per_s(&lengths).into_iter().enumerate() {
        let is_spoilt = row == 100 || row == 101;
        assert!(is_spoilt == ((found - 0.1).abs() > 1e-9), "{row} {found}");
    }
}

//! Shape and friction of a manipulator, against closed forms, energy and mirror images.

use fric_tendon::{
    Direction, Friction, MAX_DISKS, ManipulatorOptions, ManipulatorParams, ShapeStatus, StaticModel, Tendon,
    TendonOptions,
};

const ONE: TendonOptions<'static> = TendonOptions::published();

fn model<const DISKS: usize>(options: &ManipulatorOptions<'_>) -> StaticModel<DISKS> {
    StaticModel::new(&ManipulatorParams::new(options).unwrap()).unwrap()
}

fn published() -> StaticModel<8> {
    model(&ManipulatorOptions::published())
}

/// Parts of a segment, over which its backbone is summed up.
const PARTS: u32 = 400;

/// The energy of the skews of the segments, each at its minimum for these bends: all that is beyond the middle of a segment pulls on its end, and
/// the summation along the backbone shows how far a skew moves that.
fn skew_energy(options: &ManipulatorOptions<'_>, bend_rad: &[f64]) -> f64 {
    let [gx, gy] = options.gravity_m_per_s2;
    let [fx, fy] = options.tip_force_n;
    let length = |place: usize| *options.pitch_m.get(place).unwrap_or(&options.pitch_m[0]);
    let end = |start_rad: f64, bend: f64, skew: f64| {
        (0..PARTS).fold([0.0, 0.0], |[x, y], part| {
            let u = (f64::from(part) + 0.5) / f64::from(PARTS);
            let at = start_rad + bend * u + skew * (u * u - u);
            [x + at.cos() / f64::from(PARTS), y + at.sin() / f64::from(PARTS)]
        })
    };
    let (mut angle, mut sum) = (0.0, 0.0);
    for (place, &bend) in bend_rad.iter().enumerate() {
        let disk_count = f64::from(u32::try_from(bend_rad.len() - place).unwrap());
        let backbone_m = 0.5 * length(place) + (place + 1..bend_rad.len()).map(length).sum::<f64>();
        let kg = options.tip_mass_kg + disk_count * options.disk_mass_kg + options.backbone_mass_kg_per_m * backbone_m;
        let ([x, y], [other_x, other_y]) = (end(angle, bend, 1e-3), end(angle, bend, -1e-3));
        let work = length(place) * ((fx + kg * gx) * (x - other_x) + (fy + kg * gy) * (y - other_y)) / 2e-3;
        let skew = 3.0 * length(place) / options.bending_stiffness_n_m2 * work;
        sum -= work * skew / (1.0 + (1.0 + (skew / 1.5).powi(2)).sqrt());
        angle += bend;
    }
    sum
}

/// The energy of a manipulator whose segments carry these tensions, up to a constant; written from scratch, with the
/// centres of gravity by summation along the arc.
fn energy(options: &ManipulatorOptions<'_>, bend_rad: &[f64], tension_n: [&[f64]; 2]) -> f64 {
    let [gx, gy] = options.gravity_m_per_s2;
    let (mut x, mut y, mut angle, mut sum) = (0.0, 0.0, 0.0_f64, 0.0);
    let lift = |x: f64, y: f64, kg: f64| -kg * (gx * x + gy * y);
    for (place, &bend) in bend_rad.iter().enumerate() {
        let length = *options.pitch_m.get(place).unwrap_or(&options.pitch_m[0]);
        sum += options.bending_stiffness_n_m2 * bend * bend / (2.0 * length);
        let start = (x, y, angle);
        for part in 0..PARTS {
            let at = start.2 + bend * (f64::from(part) + 0.5) / f64::from(PARTS);
            let step = length / f64::from(PARTS);
            // Chord of an arc of this bend, and its middle.
            let chord = step * (1.0 - (bend / f64::from(PARTS)).powi(2) / 24.0);
            let (dx, dy) = (chord * at.cos(), chord * at.sin());
            sum += lift(x + 0.5 * dx, y + 0.5 * dy, options.backbone_mass_kg_per_m * step);
            x += dx;
            y += dy;
        }
        angle += bend;
        sum += lift(x, y, options.disk_mass_kg);
        for (side, tension_n) in [1.0, -1.0].into_iter().zip(tension_n) {
            let hole = side * options.hole_radius_m;
            let from = (start.0 - hole * start.2.sin(), start.1 + hole * start.2.cos());
            let to = (x - hole * angle.sin(), y + hole * angle.cos());
            sum += tension_n[place] * (to.0 - from.0).hypot(to.1 - from.1);
        }
    }
    let [fx, fy] = options.tip_force_n;
    sum + lift(x, y, options.tip_mass_kg) - fx * x - fy * y
}

/// Pitches of the published length, m.
const UNEVEN_M: [f64; 8] = [0.05, 0.03, 0.045, 0.035, 0.02, 0.046, 0.03, 0.04];

#[test]
fn shapes_are_minima_of_the_energy() {
    minimum(&[0.037]);
    minimum(&UNEVEN_M);
}

fn minimum(pitch_m: &[f64]) {
    let options = ManipulatorOptions {
        pitch_m,
        gravity_m_per_s2: [-3.0, -9.0],
        tip_mass_kg: 0.008,
        tip_force_n: [0.02, 0.03],
        ..ManipulatorOptions::published()
    };
    let mut model = model::<8>(&options);
    let agonist: Vec<f64> = (0..8).map(|place| 1.2 - 0.06 * f64::from(place)).collect();
    let antagonist: Vec<f64> = (0..8).map(|place| 0.2 + 0.03 * f64::from(place)).collect();
    assert!(model.solve([1.3, 0.2], Friction::Measured([&agonist, &antagonist])).is_ok());
    let bend = model.shape().segment_bend_rad().to_vec();
    let of = |bend: &[f64]| energy(&options, bend, [&agonist, &antagonist]) + skew_energy(&options, bend);
    for place in 0..8 {
        let mut change = [0.0; 2];
        for (side, change) in [1e-4, -1e-4].into_iter().zip(&mut change) {
            let mut other = bend.clone();
            other[place] += side;
            *change = of(&other) - of(&bend);
        }
        assert!(change[0] > 0.0 && change[1] > 0.0, "segment {place} is no minimum: {change:?}");
        assert!((change[0] - change[1]).abs() < 1e-3 * (change[0] + change[1]), "segment {place}: {change:?}");
    }
}

#[test]
fn friction_sums_to_the_loss_of_tension() {
    let mut model = published();
    let base_n = [1.7, 0.6];
    for friction in [Friction::None, Friction::Coulomb(Direction::Pulling), Friction::History] {
        assert!(model.solve(base_n, friction).is_ok());
        for (tendon, base_n) in Tendon::BOTH.into_iter().zip(base_n) {
            let sum: f64 = model.shape().friction_n(tendon).iter().sum();
            let tip_n = model.shape().tension_n(tendon)[7];
            assert!((sum - (base_n - tip_n)).abs() < 1e-12, "{friction:?}");
        }
    }
}

#[test]
fn coulomb_is_the_published_law_at_every_hole() {
    let mut model = published();
    assert!(model.solve([1.2, 0.5], Friction::Coulomb(Direction::Releasing)).is_ok());
    for (tendon, sign) in [(Tendon::Agonist, -1.0), (Tendon::Antagonist, 1.0)] {
        let shape = model.shape();
        let mut before = (shape.base_tension_n(tendon), 0.0);
        for (place, (&tension_n, &bend_rad)) in shape.tension_n(tendon).iter().zip(shape.segment_bend_rad()).enumerate()
        {
            // Directions of the straight tendon on both sides of the hole, in the frame of its disk; what presses on the
            // hole is the part of the sum of both tensions along the line that halves their angle.
            let (inward, outward): (f64, f64) = (-0.5 * before.1, 0.5 * bend_rad);
            let along = tension_n * outward.cos() - before.0 * inward.cos();
            let across = tension_n * outward.sin() - before.0 * inward.sin();
            let middle = 0.5 * (inward + outward);
            let friction_n = sign * 0.1753 * (across * middle.cos() - along * middle.sin());
            assert!((before.0 - tension_n - friction_n).abs() < 1e-11, "hole {place} of {tendon:?}");
            before = (tension_n, bend_rad);
        }
    }
}

#[test]
fn many_holes_are_a_capstan() {
    let loss = |disk_count: usize, mu: f64, base_n: f64| {
        let tendon = TendonOptions { mu: &[mu], ..ONE };
        let options = ManipulatorOptions {
            disk_count,
            pitch_m: &[0.296 / f64::from(u32::try_from(disk_count).unwrap())],
            tendons: [tendon; 2],
            ..ManipulatorOptions::published()
        };
        let mut model = model::<MAX_DISKS>(&options);
        assert!(model.solve([base_n, 0.0], Friction::Coulomb(Direction::Pulling)).is_ok());
        let shape = model.shape();
        // The tendon turns by the bend of the manipulator, less the half segment at the tip.
        let wrap_rad = shape.bend_rad() - 0.5 * shape.segment_bend_rad()[disk_count - 1];
        assert!(wrap_rad > 1.0);
        (shape.tension_n(Tendon::Agonist)[disk_count - 1] / base_n / (-mu * wrap_rad).exp() - 1.0).abs()
    };
    for (mu, base_n) in [(0.1, 0.9), (0.1753, 1.9), (0.4, 2.5)] {
        let [few, many] = [16, 32].map(|count| loss(count, mu, base_n));
        assert!(many < 1e-3, "{many} at μ = {mu}");
        // The error falls with the square of the holes' distance.
        assert!((few / many - 4.0).abs() < 0.4, "{few} {many}");
    }
}

#[test]
fn tendons_are_mirror_images() {
    let (mut one, mut other) = (published(), published());
    for step in 0..60 {
        let time = f64::from(step);
        let (a, b) = (0.8 + 0.5 * (0.2 * time).sin(), 0.4 + 0.3 * (0.13 * time).cos());
        assert!(one.solve([a, b], Friction::History).is_ok());
        assert!(other.solve([b, a], Friction::History).is_ok());
        for (p, q) in one.shape().disk_position_m().iter().zip(other.shape().disk_position_m()) {
            assert!((p[0] - q[0]).abs() < 1e-9 && (p[1] + q[1]).abs() < 1e-9);
        }
    }
}

#[test]
fn pulling_alone_the_history_is_coulombs() {
    let mut history = published();
    for step in 1..=200 {
        assert!(history.solve([0.01 * f64::from(step), 0.0], Friction::History).is_ok());
    }
    let mut coulomb = published();
    assert!(coulomb.solve([2.0, 0.0], Friction::Coulomb(Direction::Pulling)).is_ok());
    let (history, coulomb) = (history.shape(), coulomb.shape());
    for (one, other) in history.friction_n(Tendon::Agonist).iter().zip(coulomb.friction_n(Tendon::Agonist)) {
        assert!((one - other).abs() < 2e-3 * other, "{one} {other}");
    }
}

#[test]
fn after_a_release_the_directions_are_mixed() {
    let mut model = published();
    for tenths in [2, 4, 6, 8, 10, 9] {
        assert!(model.solve([0.1 * f64::from(tenths), 0.0], Friction::History).is_ok());
    }
    let shape = model.shape();
    let friction_n = shape.friction_n(Tendon::Agonist);
    // The base side lets go first, the tip still holds what it got while pulling.
    assert!(friction_n[0] < 0.0 && friction_n[7] > 0.0, "{friction_n:?}");
    for (friction_n, bound_n) in friction_n.iter().zip(shape.bound_n(Tendon::Agonist)) {
        assert!(friction_n.abs() <= bound_n * (1.0 + 1e-9));
    }
    // Released far enough, every hole has turned round.
    assert!(model.solve([0.5, 0.0], Friction::History).is_ok());
    assert!(model.shape().friction_n(Tendon::Agonist).iter().all(|&friction_n| friction_n < 0.0));
}

#[test]
fn the_history_does_not_depend_on_the_steps() {
    let end = |parts: u32| {
        let mut model = published();
        let mut from_n = 0.0;
        for to_n in [1.2, 0.8, 1.0, 0.9] {
            for part in 1..=parts {
                let share = f64::from(part) / f64::from(parts);
                assert!(model.solve([from_n + share * (to_n - from_n), 0.0], Friction::History).is_ok());
            }
            from_n = to_n;
        }
        *model.shape()
    };
    let (coarse, middle, fine) = (end(4), end(40), end(400));
    let difference = |one: &fric_tendon::Shape<8>| {
        let pairs = one.disk_position_m().iter().zip(fine.disk_position_m());
        pairs.map(|(p, q)| (p[0] - q[0]).hypot(p[1] - q[1])).fold(0.0, f64::max)
    };
    assert!(difference(&coarse) < 1e-3, "{}", difference(&coarse));
    assert!(difference(&middle) < 5e-5, "{}", difference(&middle));
}

#[test]
fn the_other_ways_leave_the_history_alone() {
    let (mut alone, mut asked) = (published(), published());
    for step in 0..40 {
        let tension_n = 0.8 + 0.5 * (0.3 * f64::from(step)).sin();
        assert!(asked.solve([0.3, 1.0], Friction::Coulomb(Direction::Pulling)).is_ok());
        assert_eq!(alone.solve([tension_n, 0.0], Friction::History), asked.solve([tension_n, 0.0], Friction::History));
        assert_eq!(alone.shape(), asked.shape());
    }
    asked.reset();
    assert_eq!(asked.shape(), published().shape());
}

#[test]
fn what_is_out_of_the_ordinary_is_a_status() {
    let mut model = published();
    assert!(model.solve([1.0, 0.0], Friction::History).is_ok());
    let before = *model.shape();
    for base_n in [[f64::NAN, 0.0], [1.0, f64::INFINITY], [-0.1, 0.0]] {
        for friction in [Friction::None, Friction::Coulomb(Direction::Pulling), Friction::History] {
            assert_eq!(model.solve(base_n, friction), ShapeStatus::NOT_FINITE);
        }
    }
    assert_eq!(model.solve([1.0, 0.0], Friction::Measured([&[1.0; 7], &[]])), ShapeStatus::NOT_FINITE);
    assert_eq!(model.solve([1.0, 0.0], Friction::Measured([&[f64::NAN; 8], &[]])), ShapeStatus::NOT_FINITE);
    assert_eq!(*model.shape(), before);
    assert!(model.solve([4.5, 0.0], Friction::None).contains(ShapeStatus::OVER_CAPACITY));
    assert!(model.solve([3.0, 0.0], Friction::Coulomb(Direction::Releasing)).contains(ShapeStatus::DISKS_TOUCH));
    // Far beyond any manipulator: something is said, nothing breaks.
    for friction in [Friction::None, Friction::Coulomb(Direction::Pulling), Friction::History] {
        assert!(!model.solve([1e6, 0.0], friction).has_shape(), "{friction:?}");
    }
    assert!(model.solve([1.0, 0.0], Friction::History).is_ok());
    assert_eq!(format!("{}", ShapeStatus::NOT_CONVERGED | ShapeStatus::OVER_CAPACITY), "NOT_CONVERGED|OVER_CAPACITY");
}

#[test]
fn a_cantilever_deflects_by_the_formula() {
    // FL³/(3EI) for a small transverse force on the tip, in however many segments.
    for (disk_count, pitch_m) in [(1, &[0.296][..]), (8, &[0.037]), (8, &UNEVEN_M)] {
        let options =
            ManipulatorOptions { disk_count, pitch_m, tip_force_n: [0.0, 1e-5], ..ManipulatorOptions::published() };
        let mut model = model::<8>(&options);
        assert!(model.solve([0.0; 2], Friction::None).is_ok());
        let [_, y_m] = model.shape().disk_position_m()[disk_count - 1];
        let expected_m = 1e-5 * options.pitch_m.iter().cycle().take(disk_count).sum::<f64>().powi(3)
            / (3.0 * options.bending_stiffness_n_m2);
        assert!((y_m / expected_m - 1.0).abs() < 1e-6, "{disk_count} {y_m} {expected_m}");
    }
}

#[test]
fn a_heavy_load_on_one_segment_has_a_shape() {
    // Far beyond small deflections: the tip of an elastica under F·L²/(E·I) = 3 is 0.603 L off, under 10 it is 0.811 L off.
    let tip_ratio = |load: f64| {
        let options = ManipulatorOptions {
            disk_count: 1,
            pitch_m: &[0.3],
            disk_mass_kg: 0.0,
            tip_force_n: [0.0, load * ManipulatorOptions::published().bending_stiffness_n_m2 / 0.09],
            ..ManipulatorOptions::published()
        };
        let mut model = model::<8>(&options);
        assert!(model.solve([0.0; 2], Friction::None).is_ok(), "{load}");
        model.shape().disk_position_m()[0][1] / 0.3
    };
    assert!((tip_ratio(3.0) - 0.603).abs() < 0.01);
    assert!((tip_ratio(10.0) - 0.811).abs() < 0.05);
    assert!(tip_ratio(100.0) < 1.0);
}

#[test]
fn a_column_that_buckles_is_unstable() {
    // Upright, with a weight on top beyond Euler's load π²EI/(4L²) = 0.076 N.
    let column = |tip_force_n: f64| {
        let options = ManipulatorOptions { tip_force_n: [-tip_force_n, 0.0], ..ManipulatorOptions::published() };
        model::<8>(&options).solve([0.0, 0.0], Friction::None)
    };
    assert!(column(0.073).is_ok());
    assert_eq!(column(0.079), ShapeStatus::UNSTABLE);
}

#[test]
fn every_bend_up_to_a_circle_converges_at_once() {
    for tension_n in (0..80).map(|step| 0.05 * f64::from(step)) {
        let ways = [
            (Friction::None, 4.0),
            (Friction::Coulomb(Direction::Pulling), 4.0),
            // Beyond, the tension at the tip is above the capacity.
            (Friction::Coulomb(Direction::Releasing), 1.5),
        ];
        for (friction, most_n) in ways {
            let mut model = published();
            assert!(
                tension_n > most_n || model.solve([tension_n, 0.0], friction).is_ok(),
                "{tension_n} N, {friction:?}"
            );
        }
    }
    let mut model = published();
    assert!(model.solve([3.7, 0.0], Friction::None).has_shape());
    assert!(model.shape().bend_rad() > core::f64::consts::TAU);
}

#[test]
fn wrong_parameters_are_named() {
    let refused = |options: &ManipulatorOptions<'_>| ManipulatorParams::new(options).unwrap_err().to_string();
    let good = ManipulatorOptions::published();
    assert_eq!(refused(&ManipulatorOptions { pitch_m: &[f64::NAN], ..good }).split_once(' ').unwrap().0, "`pitch_m`");
    assert_eq!(
        refused(&ManipulatorOptions { tendons: [ONE, TendonOptions { mu: &[0.1, 0.2], ..ONE }], ..good }),
        "`mu` of the antagonist has 2 entries; 8 are needed"
    );
    let mu = [0.1, 0.1, 1.5, 0.1, 0.1, 0.1, 0.1, 0.1];
    assert_eq!(
        refused(&ManipulatorOptions { tendons: [TendonOptions { mu: &mu, ..ONE }, ONE], ..good }),
        "`mu` of the tendon at place 3 is 1.5; allowed is 0 to 0.9"
    );
    assert_eq!(
        refused(&ManipulatorOptions { disk_count: 33, ..good }),
        "`disk_count` has 33 entries; allowed is 1 to 32"
    );
    let params = ManipulatorParams::new(&good).unwrap();
    assert!(StaticModel::<4>::new(&params).is_err());
}

/// A backbone that is curved without load is an arc; one whose segments differ bends in each as a uniform one of that stiffness.
#[test]
fn segments_have_stiffness_and_rest_bend_of_their_own() {
    let curved = ManipulatorOptions { precurvature_per_m: &[2.0], ..ManipulatorOptions::published() };
    let mut model = StaticModel::<8>::new(&ManipulatorParams::new(&curved).unwrap()).unwrap();
    assert!(model.solve([0.0, 0.0], Friction::None).is_ok());
    let [x_m, y_m] = model.shape().disk_position_m()[7];
    let bend_rad = 2.0 * 0.296_f64;
    assert!((x_m - bend_rad.sin() / 2.0).abs() < 1e-12 && (y_m - (1.0 - bend_rad.cos()) / 2.0).abs() < 1e-12);

    // Without friction and weight each segment bears the tension alone.
    let bends = |ratio: &[f64]| {
        let options = ManipulatorOptions { segment_stiffness_ratio: ratio, ..ManipulatorOptions::published() };
        let mut model = StaticModel::<8>::new(&ManipulatorParams::new(&options).unwrap()).unwrap();
        assert!(model.solve([1.0, 0.0], Friction::None).is_ok());
        model.shape().segment_bend_rad().to_vec()
    };
    let (stiff, soft) = (bends(&[1.0]), bends(&[0.5]));
    let mixed = bends(&[1.0, 1.0, 0.5, 1.0, 1.0, 1.0, 1.0, 1.0]);
    assert!((mixed[2] - soft[2]).abs() < 1e-12 && (mixed[3] - stiff[3]).abs() < 1e-12);
    assert!(soft[2] > 1.8 * stiff[2]);
}

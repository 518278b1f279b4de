//! Shapes of a manipulator by every way of friction: a hash of the bits of all places of its disks. Set-up is part of it.

use fric_tendon::{Direction, Friction, ManipulatorOptions, ManipulatorParams, StaticModel};

/// The hash with one more number.
fn with(hash: u64, number: f64) -> u64 {
    assert!(number.is_finite());
    (hash ^ number.to_bits()).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(23)
}

fn main() {
    let options = ManipulatorOptions { gravity_m_per_s2: [0.0, -9.81], ..ManipulatorOptions::published() };
    let mut model = StaticModel::<8>::new(&ManipulatorParams::new(&options).unwrap()).unwrap();
    let mut hash = 0xcbf2_9ce4_8422_2325;
    let measured = [0.8; 8];
    for cycle in 0..40 {
        let base_n = [0.5 + 0.03 * f64::from(cycle), 0.2];
        for friction in [
            Friction::None,
            Friction::Coulomb(Direction::Pulling),
            Friction::Measured([&measured, &[]]),
            Friction::History,
        ] {
            assert!(model.solve(base_n, friction).is_ok());
            hash = model.shape().disk_position_m().as_flattened().iter().copied().fold(hash, with);
        }
    }
    println!("manipulator: {hash:016x}");
}

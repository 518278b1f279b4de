//! Streams of random numbers, one for each use and cable, so that a change of one draws nothing else anew.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

/// The use of a stream of random numbers. Streams of one seed are independent.
#[derive(Clone, Copy)]
pub enum Purpose {
    Spread,
    Micro,
    Load,
    Noise,
    Prestress,
    SensorWander,
    ReferenceWander,
    Hand,
    Encoder,
    /// This and the following streams belong to the disturbances, one after the other.
    Disturbance,
}

pub fn random(seed: u64, purpose: Purpose, cable: usize) -> ChaCha8Rng {
    random_of(seed, purpose as u64, cable)
}

pub(super) fn random_of(seed: u64, purpose: u64, cable: usize) -> ChaCha8Rng {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(((cable as u64) << 8) | purpose);
    random
}

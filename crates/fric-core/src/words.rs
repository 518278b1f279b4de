//! The state of a model in the loop as plain words, to be kept elsewhere and gone on from with the same bits.
//!
//! For: programs that hand a running compensator to another process, and other crates whose models have such a state. Numbers keep their bits, NaN included. Which word is what
//! follows from the order of the fields, so that words are of use to the version of this crate that they are from.

use crate::compensator::columns::StateColumns;
use crate::compensator::cycle::{CableOutput, CycleOutput};
use crate::platform::Wrench;
use crate::signals::status::CableStatus;

/// What consists of words.
pub trait Words {
    /// Shows each word in turn, to be read or replaced; there are as many, whatever the values.
    fn each_word(&mut self, show: &mut dyn FnMut(&mut u64));
}

/// [`Words`](crate::words::Words) of a structure, field by field; one that is left out does not compile.
#[macro_export]
macro_rules! words_of {
    ($name:ident $(<const $parameter:ident>)? { $($field:ident),* $(,)? }) => {
        impl $(<const $parameter: usize>)? $crate::words::Words for $name $(<$parameter>)? {
            fn each_word(&mut self, show: &mut dyn FnMut(&mut u64)) {
                let Self { $($field),* } = self;
                $($field.each_word(show);)*
            }
        }
    };
}
pub use words_of;

impl Words for f64 {
    fn each_word(&mut self, show: &mut dyn FnMut(&mut u64)) {
        let mut word = self.to_bits();
        show(&mut word);
        *self = Self::from_bits(word);
    }
}

impl Words for bool {
    fn each_word(&mut self, show: &mut dyn FnMut(&mut u64)) {
        let mut word = u64::from(*self);
        show(&mut word);
        *self = word != 0;
    }
}

impl Words for usize {
    fn each_word(&mut self, show: &mut dyn FnMut(&mut u64)) {
        let mut word = *self as u64;
        show(&mut word);
        *self = Self::try_from(word).unwrap_or_default();
    }
}

impl<T: Words, const COUNT: usize> Words for [T; COUNT] {
    fn each_word(&mut self, show: &mut dyn FnMut(&mut u64)) {
        for one in self {
            one.each_word(show);
        }
    }
}

impl Words for Option<Wrench> {
    fn each_word(&mut self, show: &mut dyn FnMut(&mut u64)) {
        let (mut is_known, mut wrench) = (self.is_some(), self.unwrap_or_default());
        is_known.each_word(show);
        wrench.each_word(show);
        *self = is_known.then_some(wrench);
    }
}

impl Words for Wrench {
    fn each_word(&mut self, show: &mut dyn FnMut(&mut u64)) {
        for number in self.force_n.iter_mut().chain(&mut self.torque_nm) {
            number.each_word(show);
        }
    }
}

impl Words for CableStatus {
    fn each_word(&mut self, show: &mut dyn FnMut(&mut u64)) {
        let mut word = u64::from(self.bits());
        show(&mut word);
        *self = Self::from_bits(u32::try_from(word).unwrap_or_default());
    }
}

words_of!(CableOutput { force_at_platform_n, friction_n, frictionless_n, status });
words_of!(CycleOutput<const CABLES> { cables, outside_wrench, wrench_status, applied_wrench });
words_of!(StateColumns<const CABLES> {
    sensor_force_n,
    frozen_count,
    length_m,
    frozen_travel_m,
    friction_n,
    unseen_cycles,
    jump_cycles,
    jump_from_n,
    jumped_n,
    stored_from_n,
    left_n,
    lumped_friction_n,
    pulley_friction_n,
    memory,
    pose_wrap_factor,
    pose_traction_ratio,
    direction_known,
    direction,
    moment_arm_m,
    delayed_displacement_m,
    delayed_speed_m_per_s,
    lag_m,
});

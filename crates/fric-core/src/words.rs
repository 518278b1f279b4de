//! The state of a running model as plain 64-bit words, from which it continues with the same bits.
//!
//! Programs use it to hand a running compensator to another process, and other crates for models with such a state. Each type writes its words beside
//! its definition. Numbers keep their bits, NaN included. The order of the words is that of the fields, so only the same version of this crate can
//! read them.

/// A state that consists of words.
pub trait Words {
    /// Calls `show` with each word in turn, which may read or replace it. The number of words does not depend on the values.
    fn each_word(&mut self, show: &mut dyn FnMut(&mut u64));
}

/// Implements [`Words`](crate::words::Words) for a structure, field by field; a missing field does not compile.
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

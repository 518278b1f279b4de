//! State that one call at a time may use: a call with the interpreter released, or one of a progress function, must not be disturbed by another.

use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};

use crate::errors::{Fault, Outcome};

/// State of an object.
pub struct Exclusive<T> {
    state: Mutex<T>,
    /// Name of the class.
    class: &'static str,
}

impl<T> Exclusive<T> {
    /// Creates the state of an object of a class.
    pub fn new(state: T, class: &'static str) -> Self {
        Self { state: Mutex::new(state), class }
    }

    /// Borrows the state until the end of a call; an error if another call uses it.
    pub fn borrow(&self) -> Outcome<MutexGuard<'_, T>> {
        match self.state.try_lock() {
            Ok(state) => Ok(state),
            Err(TryLockError::Poisoned(state)) => Ok(PoisonError::into_inner(state)),
            Err(TryLockError::WouldBlock) => Err(Fault::in_use(format!(
                "another call uses this {} at the same time; give each thread a copy of its own (copy.copy)",
                self.class
            ))),
        }
    }
}

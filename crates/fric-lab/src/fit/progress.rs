//! Progress of a fit, and a way to stop it from another thread.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// State shared between a running fit and its observer.
#[derive(Debug, Default)]
pub struct Progress {
    stop: AtomicBool,
    done: AtomicUsize,
    total: AtomicUsize,
}

impl Progress {
    /// Creates a progress of zero steps.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Ends the fit soon. Its result is marked [`Termination::Stopped`](super::Termination::Stopped).
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Returns whether the fit has to end.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Returns the steps done and the total as far as it is known.
    #[must_use]
    pub fn steps(&self) -> (usize, usize) {
        (self.done.load(Ordering::Relaxed), self.total.load(Ordering::Relaxed))
    }

    pub(crate) fn stop_flag(&self) -> &AtomicBool {
        &self.stop
    }

    /// Adds steps to the total.
    pub fn begin(&self, total: usize) {
        self.total.fetch_add(total, Ordering::Relaxed);
    }

    pub(crate) fn finish(&self, count: usize) {
        self.done.fetch_add(count, Ordering::Relaxed);
    }

    /// Counts a step as done.
    pub fn finish_one(&self) {
        self.finish(1);
    }
}

/// The steps of one part of the work. Fewer may be needed than announced: all count as done on drop.
#[derive(Debug)]
pub(crate) struct Stages<'a> {
    progress: &'a Progress,
    left: AtomicUsize,
}

impl<'a> Stages<'a> {
    /// Takes `count` of the steps announced with [`Progress::begin`].
    pub(crate) fn new(progress: &'a Progress, count: usize) -> Self {
        Self { progress, left: AtomicUsize::new(count) }
    }

    /// Counts one step as done. Repeated work is not counted twice.
    pub(crate) fn finish_one(&self) {
        let one_less = |left: usize| left.checked_sub(1);
        if self.left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, one_less).is_ok() {
            self.progress.finish_one();
        }
    }
}

impl Drop for Stages<'_> {
    fn drop(&mut self) {
        self.progress.finish(self.left.load(Ordering::Relaxed));
    }
}

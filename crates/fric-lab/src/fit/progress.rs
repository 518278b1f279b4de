//! How far a fit is, and how to stop it, from another thread.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Shared between a running fit and whoever watches it.
#[derive(Debug, Default)]
pub struct Progress {
    stop: AtomicBool,
    done: AtomicUsize,
    total: AtomicUsize,
}

impl Progress {
    /// Nothing done yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Ends the fit soon; its result is marked [`Termination::Stopped`](super::Termination::Stopped).
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Steps done, and steps in all as far as they are known.
    #[must_use]
    pub fn steps(&self) -> (usize, usize) {
        (self.done.load(Ordering::Relaxed), self.total.load(Ordering::Relaxed))
    }

    pub(crate) fn stop_flag(&self) -> &AtomicBool {
        &self.stop
    }

    /// So many steps more are to do.
    pub(crate) fn begin(&self, total: usize) {
        self.total.fetch_add(total, Ordering::Relaxed);
    }

    pub(crate) fn finish(&self, count: usize) {
        self.done.fetch_add(count, Ordering::Relaxed);
    }

    pub(crate) fn finish_one(&self) {
        self.finish(1);
    }
}

/// The steps of one part of the work, of which fewer may be needed than were announced: all count as done when it is dropped.
#[derive(Debug)]
pub(crate) struct Stages<'a> {
    progress: &'a Progress,
    left: AtomicUsize,
}

impl<'a> Stages<'a> {
    /// So many of the steps announced with [`Progress::begin`].
    pub(crate) fn new(progress: &'a Progress, count: usize) -> Self {
        Self { progress, left: AtomicUsize::new(count) }
    }

    /// One is done. Work that is done again is not counted twice.
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

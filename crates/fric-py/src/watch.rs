//! Long calls: progress, Ctrl-C, and the interpreter for other threads meanwhile.

use std::ops::Range;
use std::panic::resume_unwind;
use std::thread;
use std::time::Duration;

use fric_lab::fit::Progress;
use fric_work::supervisor::Supervisor;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::ThreadPoolBuilder;

use crate::errors::{Fault, Outcome};
use crate::log;

/// Number of cycles between two checks of Ctrl-C and progress: a few milliseconds.
pub const STRIDE: usize = 4096;

/// Interval of checking Ctrl-C and progress while other threads compute.
const INTERVAL: Duration = Duration::from_millis(10);

/// Supervises a long call.
pub struct Watch<'py> {
    py: Python<'py>,
    progress: Option<Bound<'py, PyAny>>,
    last_percent: Option<u64>,
    /// The present part of the work, and the number of equal parts.
    part: (u64, u64),
}

impl<'py> Watch<'py> {
    /// Creates the supervision. `progress` is the caller's argument: false, true for a bar on stderr, or a function to call with a fraction of 0…1.
    pub fn new(py: Python<'py>, progress: Option<&Bound<'py, PyAny>>) -> Outcome<Self> {
        let progress = match progress {
            Some(given) if given.is_callable() => Some(given.clone()),
            Some(given) if given.is_truthy()? => Some(py.import("fric._progress")?.getattr("Bar")?.call0()?),
            Some(_) | None => None,
        };
        Ok(Self { py, progress, last_percent: None, part: (0, 1) })
    }

    /// Sets the present part, from 0, and the number of parts.
    pub fn part(&mut self, part: u64, count: u64) {
        self.part = (part, count);
    }

    /// Processes `0..count` in pieces, with the interpreter released during each.
    pub fn work(&mut self, count: usize, mut piece: impl FnMut(Range<usize>) -> Outcome + Send) -> Outcome {
        let mut done = 0;
        while done < count {
            self.look(done as u64, count as u64)?;
            let end = count.min(done + STRIDE);
            self.py.detach(|| piece(done..end))?;
            done = end;
        }
        self.look(count as u64, count as u64)
    }
}

impl Supervisor for Watch<'_> {
    type Error = Fault;

    /// Raises the exception of Ctrl-C, and shows the progress.
    fn look(&mut self, done: u64, total: u64) -> Outcome {
        self.py.check_signals()?;
        let Some(progress) = &self.progress else { return Ok(()) };
        let of_part = (done.min(total) * 100).checked_div(total).unwrap_or(100);
        let percent = (self.part.0 * 100 + of_part) / self.part.1;
        if self.last_percent < Some(percent) {
            self.last_percent = Some(percent);
            #[expect(clippy::cast_precision_loss, reason = "0…100")]
            progress.call1((percent as f64 / 100.0,))?;
        }
        Ok(())
    }

    fn warn(&mut self, texts: &[String]) -> Outcome {
        log::warn(self.py, texts)
    }

    /// Runs with the interpreter released.
    fn piece<T: Send>(&mut self, work: impl FnOnce() -> T + Send) -> T {
        self.py.detach(work)
    }

    /// Works in separate threads, with the interpreter released.
    fn compute<T: Send>(
        &mut self,
        _doing: &'static str,
        _steps: &str,
        work: impl FnOnce(&Progress) -> T + Send,
    ) -> Outcome<T> {
        let (py, progress) = (self.py, Progress::new());
        thread::scope(|scope| {
            let worker = scope.spawn(|| with_own_threads(|| work(&progress)));
            let mut seen = Ok(());
            while !worker.is_finished() {
                let (done, total) = progress.steps();
                seen = seen.and_then(|()| self.look(done as u64, total.max(1) as u64));
                if seen.is_err() {
                    progress.stop();
                }
                py.detach(|| thread::sleep(INTERVAL));
            }
            let fitted = worker.join().unwrap_or_else(|panic| resume_unwind(panic));
            seen.and_then(|()| self.look(1, 1))?;
            fitted
        })
    }
}

/// Works with threads that end with the work. A permanent pool would be missing in a forked child process, which would wait for it forever.
pub fn with_own_threads<T: Send>(work: impl FnOnce() -> T + Send) -> Outcome<T> {
    let pool = ThreadPoolBuilder::new().build();
    let pool = pool.map_err(|error| PyRuntimeError::new_err(format!("no threads can be started: {error}")))?;
    Ok(pool.install(work))
}

/// Ends the line of a bar that was being drawn.
impl Drop for Watch<'_> {
    fn drop(&mut self) {
        if let Some(close) = self.progress.as_ref().and_then(|progress| progress.getattr("close").ok())
            && self.last_percent.is_some_and(|percent| percent < 100)
        {
            let _ = close.call0();
        }
    }
}

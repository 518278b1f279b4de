//! Progress bars, warnings and Ctrl-C of long work.

use std::thread;
use std::time::Duration;

use fric_lab::fit::Progress;
use fric_work::supervisor::Supervisor;
use indicatif::ProgressBar;

use crate::failure::{Failure, Outcome};
use crate::interrupt;
use crate::progress;
use crate::warnings::warn_all;

/// Interval of updating the progress bar and checking Ctrl-C while all cores compute.
const WATCH_INTERVAL: Duration = Duration::from_millis(20);

/// Supervises work from the terminal.
#[derive(Debug, Default)]
pub struct Watch {
    /// The bar of the present reading.
    reading: Option<ProgressBar>,
}

impl Supervisor for Watch {
    type Error = Failure;

    fn look(&mut self, done: u64, total: u64) -> Outcome {
        interrupt::check()?;
        self.reading.get_or_insert_with(|| progress::bytes(total)).set_position(done);
        Ok(())
    }

    fn finish(&mut self) -> Outcome {
        self.reading.take().iter().for_each(progress::finish);
        Ok(())
    }

    fn warn(&mut self, texts: &[String]) -> Outcome {
        warn_all(texts);
        Ok(())
    }

    fn compute<T: Send>(
        &mut self,
        doing: &'static str,
        steps: &str,
        work: impl FnOnce(&Progress) -> T + Send,
    ) -> Outcome<T> {
        let progress = Progress::new();
        let bar = progress::steps(doing, steps);
        let result = thread::scope(|scope| {
            let worker = scope.spawn(|| work(&progress));
            while !worker.is_finished() {
                if interrupt::check().is_err() {
                    progress.stop();
                }
                let (done, total) = progress.steps();
                bar.set_length(total as u64);
                bar.set_position(done as u64);
                thread::sleep(WATCH_INTERVAL);
            }
            worker.join()
        });
        progress::finish(&bar);
        interrupt::check()?;
        result.map_err(|_| Failure::new("the work broke off: this is a defect of fric; please report it with the log"))
    }
}

//! What long work needs of the program around it.

use fric_core::ParamError;
use fric_core::robot::file::RobotFileError;
use fric_lab::discover::DiscoverError;
use fric_lab::fit::{FitError, Progress, StoreError};
use fric_lab::hysteresis::HysteresisError;
use fric_log::signals::{SignalError, TimesApart};

use crate::replay::NoHistogram;

/// Shows progress and warnings of long work, and ends it early.
pub trait Supervisor {
    /// The reason why work ended: an error of the work, or the supervisor's own, such as an interruption.
    type Error: Send
        + From<DiscoverError>
        + From<FitError>
        + From<HysteresisError>
        + From<NoHistogram>
        + From<ParamError>
        + From<RobotFileError>
        + From<SignalError>
        + From<StoreError>
        + From<TimesApart>;

    /// Shows that `done` of `total` of the present reading is done.
    ///
    /// # Errors
    /// Returns an error if the work has to end.
    fn look(&mut self, done: u64, total: u64) -> Result<(), Self::Error>;

    /// Shows that the present reading is done.
    ///
    /// # Errors
    /// Returns an error if the work has to end.
    fn finish(&mut self) -> Result<(), Self::Error> {
        self.look(1, 1)
    }

    /// Gives warnings, one sentence each.
    ///
    /// # Errors
    /// Returns an error if a warning is to end the work.
    fn warn(&mut self, texts: &[String]) -> Result<(), Self::Error>;

    /// Runs some milliseconds of work. During it, the supervisor is not asked for anything.
    fn piece<T: Send>(&mut self, work: impl FnOnce() -> T + Send) -> T {
        work()
    }

    /// Runs work on all processors, and stops it when it has to end. `doing` names the work, and `steps` what its progress counts.
    ///
    /// # Errors
    /// Returns an error if the work had to end.
    fn compute<T: Send>(
        &mut self,
        doing: &'static str,
        steps: &str,
        work: impl FnOnce(&Progress) -> T + Send,
    ) -> Result<T, Self::Error>;
}

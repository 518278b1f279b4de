//! The samples of a log, whatever they come from.

use fric_core::robot::file::RobotFile;
use fric_core::{CableInput, Sample};
use fric_lab::columns::SampleRows;
use fric_log::signals::{Role, SignalError, SignalReader, TimesApart};

use crate::replay::PoseResult;
use crate::supervisor::Supervisor;

/// Number of samples between two calls of [`Supervisor::look`]: a few milliseconds.
const STRIDE: usize = 4096;

/// A log that is read sample by sample.
pub trait SampleSource: Send {
    /// Returns the next sample; `None` at the end.
    ///
    /// # Errors
    /// Returns a [`SignalError`] if the log cannot be read on.
    fn next_sample(&mut self) -> Result<Option<Sample<'_>>, SignalError>;

    /// Returns how much has been read, and how much there is, in a unit of the source's own.
    fn progress(&self) -> (u64, u64);

    /// Returns what has been learned about the log as a whole, for a robot; complete at the end.
    fn about(&self, robot: &RobotFile) -> About;
}

/// What the samples of a log do not say themselves. The warnings are one sentence each.
#[derive(Clone, Debug, Default)]
pub struct About {
    /// Warnings about damage, which may be the reason why the log cannot be used.
    pub damage: Vec<String>,
    /// Warnings about the signals.
    pub signals: Vec<String>,
    /// Warnings about disagreements between the signals and the robot file.
    pub robot: Vec<String>,
    /// Among these, the warning that the samples do not come at the robot's cycle.
    pub cycle: Option<String>,
    /// Whether the signals are columns of rows, and no topics.
    pub has_columns: bool,
    /// Signals whose times are all apart from those of the cable signal.
    pub apart: Vec<TimesApart>,
    /// The poses, if they were computed.
    pub poses: Option<PoseResult>,
}

impl About {
    /// Returns how the times of a signal are apart from those of the cable signal; `None` if they are not.
    #[must_use]
    pub fn times_apart(&self, role: Role) -> Option<TimesApart> {
        self.apart.iter().find(|apart| apart.role == role).copied()
    }
}

impl SampleSource for SignalReader {
    fn next_sample(&mut self) -> Result<Option<Sample<'_>>, SignalError> {
        self.next_row()
    }

    fn progress(&self) -> (u64, u64) {
        (self.log().bytes_read(), self.log().total_bytes())
    }

    fn about(&self, robot: &RobotFile) -> About {
        About {
            damage: self.log().warnings(),
            signals: self.warnings(),
            robot: self.robot_warnings(robot),
            cycle: self.cycle_warning(robot),
            has_columns: self.log().column_names().is_some(),
            apart: Role::ALL.into_iter().filter_map(|role| self.times_apart(role)).collect(),
            poses: self.length_poses().as_ref().map(PoseResult::of),
        }
    }
}

/// A log in memory; the warnings were given when it was read.
#[derive(Debug)]
pub struct RowSource<'a> {
    rows: SampleRows<'a>,
    about: &'a About,
    next: usize,
    cables: Vec<CableInput>,
}

impl<'a> RowSource<'a> {
    /// Creates the source of these rows.
    #[must_use]
    pub fn new(rows: SampleRows<'a>, about: &'a About) -> Self {
        Self { rows, about, next: 0, cables: Vec::new() }
    }

    /// Returns the same source at its first row.
    #[must_use]
    pub fn again(&self) -> Self {
        Self::new(self.rows, self.about)
    }
}

impl SampleSource for RowSource<'_> {
    fn next_sample(&mut self) -> Result<Option<Sample<'_>>, SignalError> {
        self.next += 1;
        Ok(self.rows.sample(self.next - 1, &mut self.cables))
    }

    fn progress(&self) -> (u64, u64) {
        (self.next as u64, self.rows.len() as u64)
    }

    fn about(&self, _robot: &RobotFile) -> About {
        let About { has_columns, apart, poses, .. } = self.about;
        About { has_columns: *has_columns, apart: apart.clone(), poses: *poses, ..About::default() }
    }
}

/// Takes all samples of a log, under supervision. The inner error is that of the log.
///
/// # Errors
/// Returns the errors of `take` and of the supervisor.
pub fn read<W: Supervisor>(
    source: &mut impl SampleSource,
    watch: &mut W,
    mut take: impl FnMut(&Sample<'_>) -> Result<(), W::Error> + Send,
) -> Result<Result<(), SignalError>, W::Error> {
    let end = loop {
        let (done, total) = source.progress();
        watch.look(done, total)?;
        let end = watch.piece(|| -> Result<_, W::Error> {
            for _ in 0..STRIDE {
                match source.next_sample() {
                    Ok(Some(sample)) => take(&sample)?,
                    Ok(None) => return Ok(Some(Ok(()))),
                    Err(error) => return Ok(Some(Err(error))),
                }
            }
            Ok(None)
        })?;
        if let Some(end) = end {
            break end;
        }
    };
    watch.finish()?;
    Ok(end)
}

/// Takes all samples of a log, then gives the warnings about the log itself. Those that concern the robot are left to the caller.
///
/// # Errors
/// Returns the errors of [`read`], and that of the log.
pub fn read_and_warn<W: Supervisor>(
    source: &mut impl SampleSource,
    robot: &RobotFile,
    watch: &mut W,
    take: impl FnMut(&Sample<'_>) -> Result<(), W::Error> + Send,
) -> Result<About, W::Error> {
    let end = read(source, watch, take)?;
    let about = source.about(robot);
    watch.warn(&about.damage)?;
    end?;
    watch.warn(&about.signals)?;
    Ok(about)
}

//! Identification: the parameters of the friction model from the log of a run.
//!
//! A fit determines μ, σ, F_pv and ε of \[P\] 18, and the parameters of every effect of a cable, with standard errors and a list of what the log
//! cannot determine. [`Measurements`] collects the samples, [`SampleStore`] those of long logs; [`fit_cables`] compares with cable forces measured at the platform, and [`fit_wrench`]
//! compares with the external wrench, for all cables at once.
//!
//! [`readiness`] checks beforehand what a log lacks, [`result`] holds the fit for machines and people, and [`rewritten`] writes the values into a
//! robot file.
//!
//! The model is the cycle itself ([`fric_core::CableGroup`]), run with numbers that carry derivatives. Searches do not fail: one that does not
//! converge reports so in its [`Termination`]. Results do not depend on the number of threads.

pub(crate) mod balance;
pub(crate) mod cables;
mod error;
mod options;
mod per_log;
mod progress;
pub mod readiness;
pub(crate) mod report;
mod residual_function;
pub mod result;
pub(crate) mod rewritten;
mod start;
pub(crate) mod summary;
pub(crate) mod wrench;

pub use crate::certainty::determined::HALF_INTERVAL;
pub use crate::certainty::directions::{OpenDirection, open_directions};
pub use crate::samples::cable::CableRecord;
pub use crate::samples::record::{LogZero, Measurements, Reference, Row};
pub use crate::samples::selection::SampleCounts;
pub use crate::samples::store::{SampleStore, StoreError};
pub use crate::search::dual::Dual;
pub use crate::search::optimizer::Termination;
pub use crate::search::solve::{OpenCombination, OpenPart, Weighing};
pub use crate::search::vector::Parameter;
pub use cables::{fit_cables, residuals_n};
pub use error::FitError;
pub use options::FitOptions;
pub use per_log::zero_per_log;
pub use progress::Progress;
pub(crate) use progress::Stages;
pub use report::{CableFit, ForceErrors, LogValue, WrenchFit};
pub use residual_function::{KeptFunction, ResidualFunction};
pub use rewritten::rewritten;
pub use wrench::fit_wrench;

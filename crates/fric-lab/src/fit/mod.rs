//! Identification: the parameters of the friction model from the log of a run.
//!
//! For: μ, σ, F_pv and ε of \[P\] 18, and the parameters of every effect a cable has, with standard errors and what the log
//! cannot determine. Samples go into [`Measurements`]; [`fit_cables`] compares with cable forces measured at the platform,
//! [`fit_wrench`] with the outside wrench, for all cables at once.
//!
//! [`readiness`] tells beforehand what a log lacks, [`result`] is what a fit gives to machines and people, [`rewritten`] puts
//! the values into a robot file.
//!
//! The model is the cycle's own ([`fric_core::CableGroup`]) run with numbers that carry derivatives along; there is no second one.
//! Nothing here fails: a search that does not converge says so in its [`Termination`]. Results do not depend on the
//! number of threads.

pub(crate) mod balance;
pub(crate) mod cables;
mod error;
mod options;
mod progress;
pub mod readiness;
pub(crate) mod report;
mod residual_function;
pub mod result;
pub(crate) mod rewritten;
mod start;
mod summary;
pub(crate) mod wrench;

pub use crate::certainty::determined::HALF_INTERVAL;
pub use crate::certainty::directions::{OpenDirection, open_directions};
pub use crate::samples::record::{CableRecord, Measurements, Reference, Row};
pub use crate::samples::selection::SampleCounts;
pub use crate::search::dual::Dual;
pub use crate::search::optimizer::Termination;
pub use crate::search::solve::Weighing;
pub use crate::search::vector::Parameter;
pub use cables::{fit_cables, residuals_n};
pub use error::FitError;
pub use options::FitOptions;
pub use progress::Progress;
pub(crate) use progress::Stages;
pub use report::{CableFit, ForceErrors, OpenCombination, OpenPart, WrenchFit};
pub use residual_function::{KeptFunction, ResidualFunction};
pub use rewritten::rewritten;
pub use wrench::fit_wrench;

//! Identification: the parameters of the friction model from the log of a run.
//!
//! For: μ, σ, F_pv and ε of \[P\] 18, and the parameters of every effect a cable has, with standard errors and what the log
//! cannot determine. Samples go into [`Measurements`]; [`fit_cables`] compares with cable forces measured at the platform,
//! [`fit_wrench`] with the outside wrench, for all cables at once.
//!
//! The model is the cycle's own ([`fric_core::CableGroup`]) run with numbers that carry derivatives along; there is no second one.
//! Nothing here fails: a search that does not converge says so in its [`Termination`]. Results do not depend on the
//! number of threads.

mod cables;
mod determined;
mod dual;
mod gang;
mod gram;
mod optimizer;
mod options;
mod pass;
mod problem;
mod progress;
mod record;
mod report;
mod residual_function;
mod scores;
mod selection;
mod solve;
mod start;
mod vector;
mod weight;
mod wrench;

pub use cables::fit_cables;
pub use determined::HALF_INTERVAL;
pub use dual::Dual;
pub use optimizer::Termination;
pub use options::FitOptions;
pub use progress::Progress;
pub use record::{CableRecord, Measurements, Reference, Row};
pub use report::{CableFit, ForceErrors, WrenchFit};
pub use residual_function::ResidualFunction;
pub use selection::SampleCounts;
pub use solve::Weighing;
pub use vector::Parameter;
pub use wrench::fit_wrench;

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

mod balance;
mod bins;
mod cables;
pub(crate) mod candidates;
mod conditions;
mod determined;
mod directions;
mod dual;
mod error;
mod gang;
mod gram;
mod groups;
mod interpolated;
mod newcomers;
pub(crate) mod noise;
mod optimizer;
mod options;
mod pass;
mod problem;
mod progress;
pub mod readiness;
mod record;
mod report;
mod residual_function;
pub mod result;
mod rewritten;
pub(crate) mod ripple;
mod scores;
mod selection;
mod solve;
pub(crate) mod split;
mod start;
mod summary;
mod undetermined;
mod unlike_pulleys;
mod vector;
mod wrench;

/// What other searches on the same records are made of.
pub(crate) mod engine {
    pub use super::bins::Bins;
    pub use super::cables::{Search, prepared, used};
    pub use super::conditions::{Condition, Spacing, conditions, sign, time};
    pub use super::determined::Yardstick;
    pub use super::directions::{OpenDirection, open_directions};
    pub use super::gang::{Gang, Seat, forces_of};
    pub use super::gram::Gram;
    pub use super::interpolated::measured;
    pub use super::optimizer::minimize;
    pub use super::pass::{Forces, Part};
    pub use super::problem::{Comparison, Loss, Member, Problem};
    pub use super::record::PLAY_OF_NOISE;
    pub use super::rewritten::{NewValues, with_values};
    pub use super::scores::Scores;
    pub use super::selection::{Standing, count};
    pub use super::solve::{Solution, Unknown, search_near};
    pub use super::undetermined::{covariance, inverse_of_normal, vagueness, yardsticks};
    pub use super::unlike_pulleys::covariance as unlike_pulleys_covariance;
    pub use super::vector::Coordinate;
    pub use super::wrench::{ReferenceWrenches, first_model};
}

pub use cables::{fit_cables, residuals_n};
pub use determined::HALF_INTERVAL;
pub use directions::{OpenDirection, open_directions};
pub use dual::Dual;
pub use error::FitError;
pub use optimizer::Termination;
pub use options::FitOptions;
pub use progress::Progress;
pub(crate) use progress::Stages;
pub use record::{CableRecord, Measurements, Reference, Row};
pub use report::{CableFit, ForceErrors, OpenCombination, OpenPart, WrenchFit};
pub use residual_function::{KeptFunction, ResidualFunction};
pub use rewritten::rewritten;
pub use selection::SampleCounts;
pub use solve::Weighing;
pub use vector::Parameter;
pub use wrench::fit_wrench;

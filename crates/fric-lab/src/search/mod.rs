//! The least-squares search that `fit` and `discover` share.
//!
//! [`pass`] runs the cycle of `fric-core` over records in numbers that carry derivatives ([`dual`]), four cables side by side; several
//! searches share one pass through a [`gang`]. [`problem`] defines residuals and Jacobian, [`gram`] reduces them to a small triangle as they
//! come, [`optimizer`] runs Levenberg-Marquardt on it in the coordinates of [`vector`], and [`solve`] adds outliers and what stays undetermined.

pub mod dual;
pub mod gang;
pub mod gram;
pub mod optimizer;
pub mod pass;
pub mod problem;
pub mod solve;
pub mod vector;

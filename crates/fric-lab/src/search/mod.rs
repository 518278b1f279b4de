//! The least-squares search that `fit` and `discover` share.
//!
//! [`pass`] runs the cycle of `fric-core` over records in numbers that carry derivatives ([`dual`]), in four lanes. The searches of several cables share
//! one pass through a [`gang`]; a [`stream`] runs many models along a log, a few cycles at a time. [`problem`] defines residuals and Jacobian, and [`gram`] reduces them to a small triangle as they are computed.
//! [`optimizer`] runs Levenberg–Marquardt on the triangle in the coordinates of [`vector`]. [`solve`] handles outliers and undetermined parameters. [`zeros`] eliminates
//! what each of several logs has of its own.

pub mod dual;
pub mod gang;
pub mod gram;
pub mod optimizer;
pub mod pass;
pub mod problem;
pub mod solve;
pub mod stream;
pub mod vector;
pub mod zeros;

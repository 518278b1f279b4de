//! What every search on samples needs, whatever its model is: for `fit` and `discover` of this crate, and for the crates beside it.
//!
//! [`blocks`] divides the samples into some to learn from and some held out. [`Gram`] sums up the normal equations, [`inverse_of_normal`]
//! inverts them. [`Scores`] gives the covariance of an estimate under residuals that remember. [`white_noise_throughout`] and
//! [`white_noise_in`] estimate the noise in a residual. Directions that the samples leave open are
//! [`open_directions`](crate::fit::open_directions).

pub use crate::certainty::scores::Scores;
pub use crate::samples::noise::{white_noise_in, white_noise_throughout};
pub use crate::samples::split::{Block, blocks};
pub use crate::search::gram::Gram;
pub use crate::search::gram::inverse_of_normal;

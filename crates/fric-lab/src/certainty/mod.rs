//! How well the samples determine an estimate.
//!
//! [`scores`] gives the covariance under correlated residuals, over the [`groups`] of samples in one operating condition. [`unlike_pulleys`] adds the
//! effect of differences between a cable's pulleys, [`own_noise`] that of the sensor's noise in the model, [`assumed`] that of a time that the samples do
//! not determine. [`determined`] and [`undetermined`] decide which parameters the samples determine. [`directions`] finds the combinations that they leave open,
//! [`one_way`] and [`one_load`] those that a search does not see.

pub mod assumed;
pub mod determined;
pub mod directions;
pub mod groups;
pub mod log_zeros;
pub mod one_load;
pub mod one_way;
pub mod own_noise;
pub mod scores;
pub mod undetermined;
pub mod unlike_pulleys;

//! Poses and directions: the platform, the last pulley that swivels towards it, forward kinematics, and admittance control on top of them.

pub mod admittance;
pub mod forward;
pub mod platform;
pub mod swivel;

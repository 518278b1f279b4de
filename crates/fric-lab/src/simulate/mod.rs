//! A simulated cable robot: the samples of a log with known friction, as a stream.
//!
//! For: logs to try the compensator, identification and discovery on, with effects hidden in them. [`Simulation`] yields
//! one cycle after another in bounded memory; the caller writes them where it likes.
//!
//! What is simulated: the platform runs the identification run of \[P\], section III C ([`Trajectory`]); its cables hold it
//! with tensions that wander; on every pulley a bristle rubs (\[P\] 4–7, 16, in a form and by a method of its own); winches
//! move a little in standstill; sensor and reference are noisy. What is not: elastic or sagging cables, rotation of the
//! platform, slip on a pulley, inertia of pulleys.
//!
//! Parameters are the robot file's friction values: they are the truth here. `offset_n` is added to the reference, so that
//! a fit finds the same offset. Input is checked at set-up ([`SimulationError`]); running cannot fail.
//!
//! The friction shares no code with the compensator's, only the kinematics and the types: where both agree, they have
//! not agreed by construction. Sign convention: see [`fric_core::pulley`].

mod bristle;
mod distribution;
mod effects;
mod error;
mod hidden;
mod motion;
mod options;
mod platform;
mod stream;
mod stroke;
mod tension;
mod trajectory;
mod waves;
mod workspace;

pub use error::{HiddenEffectError, SimulationError};
pub use hidden::HiddenEffect;
pub use options::SimulationOptions;
pub use stream::{Imbalance, START_NANOS, Simulation};
pub use trajectory::{
    ACCELERATION_M_PER_S2, AMPLITUDES_M, BREAK_S, FASTEST_M_PER_S, Leg, Phase, RECTANGLES_M_PER_S, STEP_M_PER_S,
    STROKE_ACCELERATION_M_PER_S2, STROKE_M, STROKES_M_PER_S, SetPoint, Trajectory, WorkBox,
};

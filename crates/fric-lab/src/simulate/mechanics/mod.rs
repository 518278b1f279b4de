//! What moves and holds the platform, without friction: its motion and weight, the tensions and their distribution over the cables, the workspace.

pub mod distribution;
pub mod motion;
pub mod platform;
pub mod tension;
pub mod waves;
pub mod workspace;

//! The static model of a continuum manipulator: shapes for tensions, and tensions for goals.

mod command;
mod handle;
mod shape;
mod status;

pub use command::{
    DriveLimits, FRIC_GOAL_BEND, FRIC_GOAL_TIP, ModelCommand, ModelGoal, fric_static_model_set_drive,
    fric_static_model_tension_for,
};
pub use handle::{
    ModelHandle, fric_static_model_copy_state, fric_static_model_disk_count, fric_static_model_free,
    fric_static_model_load_file, fric_static_model_load_text, fric_static_model_name, fric_static_model_reset,
};
pub use shape::{
    DiskResult, DiskTensions, FRIC_FRICTION_HISTORY, FRIC_FRICTION_MEASURED, FRIC_FRICTION_NONE, FRIC_FRICTION_PULLING,
    FRIC_FRICTION_RELEASING, ShapeResult, ShapeSignals, fric_static_model_solve,
};
pub use status::*;

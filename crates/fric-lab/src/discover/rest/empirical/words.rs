//! A table in words: its condition, and causes that look like it.

use fric_core::effects::empirical::Over;

/// Returns the name of a table's condition in results.
pub fn signal_of(over: Over) -> &'static str {
    match over {
        Over::Speed => "speed",
        Over::Length => "length",
        Over::Load => "load",
    }
}

/// Returns the physical causes that look like such a table.
pub fn looks_like(over: Over, is_force: bool) -> &'static [&'static str] {
    match (over, is_force) {
        (Over::Speed, true) => &[
            "cable or drum that moves air or oil",
            "a drive whose current stands for the force",
            "viscous friction of another law",
        ],
        (Over::Speed, false) => &[
            "a Stribeck curve of another shape",
            "lubrication that builds up with the speed",
            "a bearing that changes its regime",
        ],
        (Over::Length, true) => &[
            "a pulley or a drum out of true that the run turns less than once",
            "weight and sag of the cable",
            "a spring or a cable chain that is taken along",
            "a wrong position of the frame or of the attachment",
        ],
        (Over::Length, false) => &[
            "a worn, kinked or dirty stretch of cable",
            "a drum whose layers differ",
            "a guide that the cable touches over part of its way",
        ],
        (Over::Load, true) => &[
            "a force sensor whose curve is bent at one place",
            "a mount that gives way or meets a stop",
            "a wrong wrap angle at the sensor",
        ],
        (Over::Load, false) => &[
            "friction that depends on the load by another law",
            "a bearing or a frame that is bent by the load",
            "cable that is flattened in its groove",
        ],
    }
}

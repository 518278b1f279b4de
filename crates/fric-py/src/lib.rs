//! `fric._fric`, the compiled part of the Python package `fric`.
//!
//! There is one file per function or class of the Python module. Each class wraps one Rust value; all computation is in the crates below. Results are
//! dataclasses of `python/fric/_results`, which `results.rs` fills. Long calls release the interpreter, check for Ctrl-C every few thousand cycles
//! (`watch.rs`) and leave nothing half done. `python/fric/_fric.pyi` declares the content of this module.
#![allow(clippy::doc_markdown, clippy::doc_link_with_quotes, reason = "documentation here is read in Python")]
#![allow(clippy::needless_pass_by_value, reason = "values come as the interpreter passes them")]
#![allow(clippy::too_many_arguments, reason = "they are keywords in Python")]

mod arguments;
mod arrays;
mod catalogue;
mod compensator;
mod continuum;
mod errors;
mod exclusive;
mod log;
mod results;
mod robot;
mod travel;
mod watch;
mod work;

/// The module. It is tested only with the interpreter's global lock; a free-threaded interpreter enables the lock again.
#[pyo3::pymodule(gil_used = true)]
mod _fric {
    use fric_core::CableStatus;
    use fric_tendon::{GoalStatus, ShapeStatus};
    use pyo3::prelude::*;
    use pyo3::types::PyDict;

    #[pymodule_export]
    use crate::compensator::{Compensator, Snapshot};
    #[pymodule_export]
    use crate::continuum::{
        Manipulator, StaticModel, StaticSnapshot, TendonRun, continuum_calibrate, continuum_discover, continuum_fit,
        continuum_friction, continuum_hole, continuum_read_loads, continuum_read_run, continuum_shape,
        continuum_simulate, continuum_track,
    };
    #[pymodule_export]
    use crate::log::{Log, read_log};
    #[pymodule_export]
    use crate::robot::{Cable, Friction, LogPaths, Monitor, Platform, Robot};
    #[pymodule_export]
    use crate::work::discover::discover;
    #[pymodule_export]
    use crate::work::excite::excite;
    #[pymodule_export]
    use crate::work::fit::fit;
    #[pymodule_export]
    use crate::work::hysteresis::hysteresis;
    #[pymodule_export]
    use crate::work::replay::replay;
    #[pymodule_export]
    use crate::work::residual_function::{ResidualFunction, residual_function};
    #[pymodule_export]
    use crate::work::simulate::simulate;

    /// Returns the sentence for an unknown name.
    #[pyfunction]
    fn _unknown_name(what: &str, name: &str, known: Vec<String>) -> String {
        fric_core::robot::unknown_name(what, name, known.iter().map(String::as_str))
    }

    /// Runs the command line, whose first word is the name of the program, and returns the exit code; Ctrl-C ends it from then on.
    #[pyfunction]
    fn _command_line(py: Python<'_>, words: Vec<std::ffi::OsString>) -> u8 {
        py.detach(|| fric_cli::run(words))
    }

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        let bits = PyDict::new(module.py());
        for (name, flag) in CableStatus::NAMES {
            bits.set_item(name, flag.bits())?;
        }
        module.add("STATUS_BITS", bits)?;
        let bits = PyDict::new(module.py());
        for (name, flag) in ShapeStatus::NAMES {
            bits.set_item(name, flag.bits())?;
        }
        module.add("SHAPE_STATUS_BITS", bits)?;
        let bits = PyDict::new(module.py());
        for (name, flag) in GoalStatus::NAMES {
            bits.set_item(name, flag.bits())?;
        }
        module.add("GOAL_STATUS_BITS", bits)?;
        module.add("CATALOGUE", crate::catalogue::catalogue(module.py())?)?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}

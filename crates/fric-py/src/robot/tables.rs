//! The robot file's tables as objects whose attributes are its keys.

use fric_core::robot::unknown_name;
use pyo3::exceptions::PyAttributeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::edit::{self, Step};
use super::{Robot, values};
use crate::errors::{Fault, Outcome};

/// The position of a robot's table.
pub struct Place {
    robot: Py<Robot>,
    steps: Vec<Step>,
}

impl Place {
    pub fn new(robot: Py<Robot>, steps: &[Step]) -> Self {
        Self { robot, steps: steps.to_vec() }
    }

    fn inside(&self, py: Python<'_>, key: &'static str) -> Self {
        let steps = self.steps.iter().copied().chain([Step::Key(key)]).collect();
        Self { robot: self.robot.clone_ref(py), steps }
    }

    fn value(&self, py: Python<'_>, key: &str) -> Outcome<Option<toml::Value>> {
        edit::get(&self.robot.borrow(py).file, &self.steps, key)
    }

    /// Returns the whole table.
    fn table(&self, py: Python<'_>) -> Outcome<Option<toml::Value>> {
        edit::table(&self.robot.borrow(py).file, &self.steps)
    }

    /// Returns what recreates the table: a function of the robot, or of its cable, and its arguments.
    fn reduced<'py>(&self, py: Python<'py>) -> Outcome<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let robot = self.robot.bind(py);
        let cable = |index: usize| -> Outcome<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
            let name = robot.borrow().file.cable_names().get(index).map(|name| (*name).to_owned());
            // A deep copy copies arguments, but not a function, and so not the robot of a bound method.
            let cable_of = py.import("operator")?.getattr("methodcaller")?.call1(("cable", name))?;
            Ok((cable_of, (robot.clone(),).into_pyobject(py)?))
        };
        let attribute = |object: Bound<'py, PyAny>, key: &str| -> Outcome<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
            Ok((py.import("builtins")?.getattr("getattr")?, (object, key).into_pyobject(py)?))
        };
        match self.steps.as_slice() {
            [Step::Key("cable"), Step::Index(index)] => cable(*index),
            [Step::Key("cable"), Step::Index(index), Step::Key(key)] => {
                let (method, arguments) = cable(*index)?;
                attribute(method.call1(arguments)?, key)
            }
            [Step::Key(key)] => attribute(robot.clone().into_any(), key),
            _ => Err(Fault::config("this table of a robot cannot be pickled")),
        }
    }

    fn get<'py>(&self, py: Python<'py>, key: &str) -> Outcome<Option<Bound<'py, PyAny>>> {
        let value = self.value(py, key)?;
        Ok(value.map(|value| values::to_python(py, &value)).transpose()?)
    }

    fn set(&self, py: Python<'_>, given: &[(String, Bound<'_, PyAny>)], keys: &Keys) -> Outcome {
        let cable = edit::cable_of(&self.robot.borrow(py).file, &self.steps);
        // Reading the values may run Python code that accesses the robot.
        let given = keys.read(given, &cable)?;
        let file = edit::with(&self.robot.borrow(py).file, &self.steps, given)?;
        self.robot.borrow_mut(py).edit(file);
        Ok(())
    }
}

/// The keys of a class.
pub struct Keys {
    /// Name of the class.
    pub class: &'static str,
    /// All keys.
    pub all: &'static [&'static str],
    /// Optional keys.
    pub optional: &'static [&'static str],
}

impl Keys {
    /// Returns the values for keys as in the file; `cable` names the cable for errors.
    pub fn read(
        &self,
        given: &[(String, Bound<'_, PyAny>)],
        cable: &str,
    ) -> Outcome<Vec<(String, Option<toml::Value>)>> {
        let read = |(key, value): &(String, Bound<'_, PyAny>)| {
            let refuse = |problem: &str| Fault::config(format!("{cable}`{key}` {problem}"));
            if value.is_none() && self.all.contains(&key.as_str()) && !self.optional.contains(&key.as_str()) {
                return Err(refuse("is None; it needs a value"));
            }
            let read = values::from_python(value).map_err(|class| {
                refuse(&format!("holds a {class}, which a robot file cannot; numbers, text, lists and dicts can"))
            })?;
            Ok((key.clone(), read))
        };
        given.iter().map(read).collect()
    }

    /// Checks that `name` can be set.
    pub fn check(&self, name: &str) -> PyResult<()> {
        if self.all.contains(&name) {
            return Ok(());
        }
        let text = unknown_name("attribute", name, self.all.iter().copied());
        Err(PyAttributeError::new_err(format!("{}: {text}", self.class)))
    }
}

/// Returns the error of a missing attribute.
pub fn misspelt(object: &Bound<'_, PyAny>, name: &str) -> PyErr {
    let names =
        || Some((object.get_type().dir().ok()?.extract::<Vec<String>>().ok()?, object.get_type().qualname().ok()?));
    let (names, class) = match names() {
        Some((names, class)) => (names, class.to_string()),
        None => (Vec::new(), String::new()),
    };
    let public = names.iter().map(String::as_str).filter(|name| !name.starts_with('_'));
    PyAttributeError::new_err(format!("{class}: {}", unknown_name("attribute", name, public)))
}

/// Returns the keyword arguments.
pub fn pairs<'py>(given: Option<&Bound<'py, PyDict>>) -> Outcome<Vec<(String, Bound<'py, PyAny>)>> {
    let Some(given) = given else { return Ok(Vec::new()) };
    given.iter().map(|(key, value)| Ok((key.extract()?, value))).collect()
}

/// Defines the class of a table: a readable attribute per key; `__setattr__` and `set` set and check them.
macro_rules! table {
    (
        $(#[$doc:meta])* $name:ident, optional: [$($optional:ident),*];
        keys: { $($(#[$key_doc:meta])* $key:ident,)* }
        also [$($also_key:literal),*] { $($also:tt)* }
    ) => {
        $(#[$doc])*
        #[pyclass(module = "fric", frozen)]
        pub struct $name(Place);

        impl $name {
            const KEYS: Keys = Keys {
                class: stringify!($name),
                all: &[$(stringify!($key),)* $($also_key),*],
                optional: &[$(stringify!($optional)),*],
            };

            /// Creates the table at a position.
            pub(super) fn new(place: Place) -> Self {
                Self(place)
            }

            /// Returns the keys that are set, and their values in the words of the file.
            fn texts(&self, py: Python<'_>) -> Outcome<Vec<(&'static str, String)>> {
                let mut texts = Vec::new();
                for key in Self::KEYS.all {
                    if let Some(value) = self.0.value(py, key)? {
                        texts.push((*key, value.to_string()));
                    }
                }
                Ok(texts)
            }
        }

        #[pymethods]
        impl $name {
            $(
                $(#[$key_doc])*
                #[getter]
                fn $key<'py>(&self, py: Python<'py>) -> Outcome<Option<Bound<'py, PyAny>>> {
                    self.0.get(py, stringify!($key))
                }
            )*

            /// Sets several keys at once, checked together; None omits a key.
            #[pyo3(signature = (**values))]
            fn set(&self, py: Python<'_>, values: Option<&Bound<'_, PyDict>>) -> Outcome {
                self.0.set(py, &pairs(values)?, &Self::KEYS)
            }

            fn __setattr__(&self, py: Python<'_>, name: String, value: Bound<'_, PyAny>) -> Outcome {
                Self::KEYS.check(&name)?;
                self.0.set(py, &[(name, value)], &Self::KEYS)
            }

            fn __getattr__(slf: &Bound<'_, Self>, name: String) -> PyResult<Py<PyAny>> {
                Err(misspelt(slf.as_any(), &name))
            }

            fn __repr__(&self, py: Python<'_>) -> Outcome<String> {
                let parts: Vec<_> = self.texts(py)?.iter().map(|(key, value)| format!("{key}={value}")).collect();
                Ok(format!("{}({})", Self::KEYS.class, parts.join(", ")))
            }

            /// Its keys and values as a table, for notebooks.
            fn _repr_html_<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyAny>> {
                Ok(py.import("fric._html")?.call_method1("fields", (Self::KEYS.class, self.texts(py)?))?)
            }

            fn __eq__(&self, py: Python<'_>, other: &Bound<'_, PyAny>) -> Outcome<bool> {
                let Ok(other) = other.cast::<Self>() else { return Ok(false) };
                Ok(self.0.table(py)? == other.get().0.table(py)?)
            }

            /// A copy belongs to a copy of the robot.
            fn __copy__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
                slf.py().import("copy")?.getattr("deepcopy")?.call1((slf,))
            }

            /// Pickles, and copies, the robot's table.
            fn __reduce__<'py>(&self, py: Python<'py>) -> Outcome<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
                self.0.reduced(py)
            }

            $($also)*
        }
    };
}

table! {
    /// `[platform]`: what the cables hold.
    Platform, optional: [];
    keys: {
        /// Mass, kg.
        mass_kg,
        /// Centre of mass in the platform frame, m.
        center_of_mass_m,
        /// Inertia tensor about the centre of mass in the platform's axes, kg m²: xx, xy, xz, yy, yz, zz.
        inertia_kg_m2,
        /// Gravity in the base frame, m/s².
        gravity_m_per_s2,
    }
    also [] {}
}

table! {
    /// `[monitor]`: when a signal counts as faulty. None stands for the default.
    Monitor, optional: [frozen_cycles, length_jump_m, length_noise_m, sensor_jump_n];
    keys: {
        /// After so many cycles with the same value a sensor counts as frozen (100); 0 switches it off.
        frozen_cycles,
        /// Greatest change of length in a cycle, m (what 10 m/s cover).
        length_jump_m,
        /// Amplitude of the noise of measured lengths, m (0).
        length_noise_m,
        /// Greatest change of a sensor force in a cycle, N (what each cable's σ makes of a twentieth of `length_jump_m`).
        sensor_jump_n,
    }
    also [] {}
}

table! {
    /// `[log]`: the topic of each signal, or a path to a field.
    LogPaths, optional: [length, speed, columns];
    keys: {
        /// Cable signals.
        cable,
        /// Cable lengths, where they have a topic or field of their own.
        length,
        /// Cable speeds, likewise.
        speed,
        /// Cable forces at the platform: a topic or path, or what is known of them, {"constant_n": …} or {"hanging_mass_kg": …}.
        reference,
        /// Pose of the platform, or "lengths", where it is computed from the cable lengths.
        pose,
        /// Wrench on the platform from outside.
        wrench,
        /// Columns of a CSV log that are called otherwise than by default or are in other units, a dict for each:
        /// {"cable1.force_n": {"column": "Load cell 1 [kg]", "factor": 9.80665}}.
        columns,
    }
    also [] {}
}

table! {
    /// `friction` of a cable.
    Friction, optional: [sigma_n_per_m];
    keys: {
        /// Friction of each bearing on its normal force, 0 to 0.9.
        mu,
        /// Presliding stiffness of the whole cable, N/m; None: friction reverses at once.
        sigma_n_per_m,
        /// Viscous friction of each pulley, N s/m.
        viscous_n_s_per_m,
        /// Force added at the platform, N.
        offset_n,
    }
    also [] {}
}

table! {
    /// A `[[cable]]`. What is read from it is a copy: set the attribute to change it.
    Cable, optional: [base_m, platform_m, traction_mu, validated];
    keys: {
        /// Name, as in the log.
        name,
        /// Where the cable enters the last pulley, base frame, m.
        base_m,
        /// Attachment, platform frame, m.
        platform_m,
        /// "per_pulley" or "lumped".
        presliding,
        /// A dict for each pulley, from the winch to the platform.
        pulleys,
        /// Friction coefficient between cable and pulley beyond which the cable slips; None: it never does.
        traction_mu,
        /// Range in which the parameters were identified.
        validated,
    }
    also ["friction", "effects"] {
        /// The friction of this cable.
        #[getter]
        fn friction(&self, py: Python<'_>) -> Friction {
            Friction::new(self.0.inside(py, "friction"))
        }

        /// A dict for each effect of the catalogue.
        #[getter]
        fn effects<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyAny>> {
            let effects = self.0.get(py, "effects")?;
            Ok(effects.unwrap_or_else(|| PyTuple::empty(py).into_any()))
        }
    }
}

//! Arguments of functions: numbers, texts and objects, with an error that names the argument and says what it must be.
//!
//! The functions here convert an argument by `#[pyo3(from_py_with = …)]`. PyO3 adds the name of the argument to the error, as a note, which
//! `fric.ArgumentTypeError` takes into its sentence. Arrays are converted in `arrays.rs`.

use std::path::PathBuf;

use pyo3::PyClass;
use pyo3::conversion::FromPyObjectOwned;
use pyo3::exceptions::PyException;
use pyo3::prelude::*;
use pyo3::pyclass::boolean_struct::True;
use pyo3::types::PyString;

use crate::errors::Fault;
use crate::robot::Robot;

/// A type of arguments.
pub trait Argument {
    /// Returns what the argument must be, for people.
    fn expected() -> String;
}

macro_rules! expected {
    ($($kind:ty => $words:literal),* $(,)?) => {$(
        impl Argument for $kind {
            fn expected() -> String {
                $words.to_owned()
            }
        }
    )*};
}

expected!(
    bool => "True or False",
    u64 => "a whole number of 0 or more",
    usize => "a whole number of 0 or more",
    f64 => "a number",
    [f64; 2] => "two numbers",
    [[f64; 3]; 2] => "two corners of three numbers each",
    Vec<f64> => "a list of numbers",
    String => "a text",
    Vec<String> => "a list of texts",
    PathBuf => "a path",
    Bound<'_, Robot> => "a Robot",
);

impl<T: Argument> Argument for Option<T> {
    fn expected() -> String {
        T::expected() + ", or None"
    }
}

/// Converts an argument to numbers, texts or paths.
pub fn argument<'py, T: Argument + FromPyObjectOwned<'py>>(value: &Bound<'py, PyAny>) -> PyResult<T> {
    value.extract().map_err(|error: T::Error| {
        let error: PyErr = error.into();
        // Ctrl-C stays what it is.
        if error.is_instance_of::<PyException>(value.py()) { refusal(&T::expected(), value, None) } else { error }
    })
}

/// Borrows the text of an argument.
pub fn text<'a>(value: &'a Bound<'_, PyAny>) -> PyResult<&'a str> {
    let text = value.cast::<PyString>().ok().and_then(|text| text.to_str().ok());
    text.ok_or_else(|| refusal(&String::expected(), value, None))
}

/// Borrows an argument as an object of a class of this module.
pub fn object<'a, 'py, T: PyClass>(value: &'a Bound<'py, PyAny>) -> PyResult<&'a Bound<'py, T>> {
    value.cast::<T>().map_err(|_| match T::type_object(value.py()).name() {
        Ok(name) => refusal(&format!("a {name}"), value, None),
        Err(error) => error,
    })
}

/// Borrows the content of such an object that never changes.
pub fn frozen<'a, T: PyClass<Frozen = True> + Sync>(value: &'a Bound<'_, PyAny>) -> PyResult<&'a T> {
    object(value).map(Bound::get)
}

/// Returns the error of an argument that the function converts that takes it.
pub fn refused(name: &str, expected: &str, value: &Bound<'_, PyAny>) -> Fault {
    refusal(expected, value, Some(name)).into()
}

fn refusal(expected: &str, value: &Bound<'_, PyAny>, name: Option<&str>) -> PyErr {
    let module = value.py().import("fric._arguments");
    let error = module.and_then(|module| module.getattr("refusal")?.call1((expected, value, name)));
    error.map_or_else(|error| error, PyErr::from_value)
}

//! Converts NumPy arrays: checked input, and output.

use numpy::{
    Element, IntoPyArray, PyArray1, PyArray2, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;

use crate::errors::{Fault, Outcome};

/// The required length of an axis.
#[derive(Clone, Copy)]
pub enum Axis {
    /// Exactly this length.
    Exactly(usize),
    /// Any length: the number of rows.
    Rows,
}

/// The requirements of an argument.
pub struct Wanted<'a> {
    /// Name of the argument.
    pub name: &'a str,
    /// Its axes.
    pub shape: &'a [Axis],
    /// Meaning of an entry, for people: "one number per cable".
    pub entries: &'a str,
}

/// Returns a copy of an argument's numbers, row by row. It is a copy so that nobody changes it while the interpreter is released.
pub fn numbers(wanted: &Wanted<'_>, value: &Bound<'_, PyAny>) -> Outcome<Vec<f64>> {
    let numpy = value.py().import("numpy")?;
    // What is masked is a gap.
    let filled = if is_masked(&numpy, value)? {
        let real = value.call_method1("astype", ("float64",))?;
        Some(real.call_method1("filled", (f64::NAN,))?)
    } else {
        None
    };
    checked(wanted, filled.as_ref().unwrap_or(value), b"fiu", "real numbers", "float64")
}

/// Returns the same for integers.
pub fn integers(wanted: &Wanted<'_>, value: &Bound<'_, PyAny>) -> Outcome<Vec<i64>> {
    let numpy = value.py().import("numpy")?;
    if is_masked(&numpy, value)? {
        return Err(Fault::array_type(format!("`{}` has masked entries, and whole numbers have no gaps", wanted.name)));
    }
    checked(wanted, value, b"iu", "whole numbers", "int64")
}

/// Returns times in nanoseconds since 1970, which are whole numbers or dates of NumPy (datetime64).
pub fn stamps_nanos(wanted: &Wanted<'_>, value: &Bound<'_, PyAny>) -> Outcome<Vec<i64>> {
    let numpy = value.py().import("numpy")?;
    let dates = numpy.call_method1("asarray", (value,)).ok();
    let dates = dates.filter(|array| array.cast::<PyUntypedArray>().is_ok_and(|array| array.dtype().kind() == b'M'));
    let Some(dates) = dates else { return integers(wanted, value) };
    if numpy.call_method1("isnat", (&dates,))?.call_method0("any")?.is_truthy()? {
        return Err(Fault::shape(format!("`{}` has a date that is missing (NaT); leave out its row", wanted.name)));
    }
    let nanos = dates.call_method1("astype", ("datetime64[ns]",))?.call_method1("astype", ("int64",))?;
    integers(wanted, &nanos)
}

fn is_masked(numpy: &Bound<'_, PyModule>, value: &Bound<'_, PyAny>) -> Outcome<bool> {
    if value.get_type().is(&numpy.getattr("ndarray")?) {
        return Ok(false);
    }
    Ok(numpy.getattr("ma")?.call_method1("is_masked", (value,))?.is_truthy()?)
}

fn checked<T: Element + Copy>(
    wanted: &Wanted<'_>,
    value: &Bound<'_, PyAny>,
    kinds: &[u8],
    what: &str,
    dtype: &str,
) -> Outcome<Vec<T>> {
    let numpy = value.py().import("numpy")?;
    let refusal = |found: String| {
        let Wanted { name, shape, entries } = wanted;
        format!("`{name}` must be {what} ({dtype}) of shape {}, {entries}; what came is {found}", shape_text(shape))
    };
    let array = numpy.call_method1("asarray", (value,));
    let array = array.map_err(|error| Fault::shape(refusal(format!("no array: {}", error.value(value.py())))))?;
    let array = array.cast::<PyUntypedArray>()?;
    let fits = |(axis, length): (&Axis, &usize)| match axis {
        Axis::Exactly(expected) => length == expected,
        Axis::Rows => true,
    };
    let lengths = array.shape();
    let has_shape = lengths.len() == wanted.shape.len() && wanted.shape.iter().zip(lengths).all(fits);
    // An empty list has no type of its own.
    let has_type = kinds.contains(&array.dtype().kind()) || lengths.contains(&0);
    if !has_shape || !has_type {
        let lengths: Vec<String> = lengths.iter().map(ToString::to_string).collect();
        let text = refusal(format!("{} of shape {}", array.dtype().str()?, tuple_text(&lengths)));
        return Err(if has_type { Fault::shape(text) } else { Fault::array_type(text) });
    }
    let array = numpy.call_method1("ascontiguousarray", (array, dtype))?;
    Ok(array.cast::<PyArrayDyn<T>>()?.readonly().as_slice()?.to_vec())
}

fn shape_text(shape: &[Axis]) -> String {
    let length = |axis: &Axis| match axis {
        Axis::Exactly(length) => length.to_string(),
        Axis::Rows => "N".to_owned(),
    };
    tuple_text(&shape.iter().map(length).collect::<Vec<_>>())
}

/// Formats a tuple as Python does.
fn tuple_text(parts: &[String]) -> String {
    match parts {
        [part] => format!("({part},)"),
        parts => format!("({})", parts.join(", ")),
    }
}

/// Returns numbers as an array of a shape, without copying them.
pub fn array<T: Element>(py: Python<'_>, numbers: Vec<T>, shape: &[usize]) -> Outcome<Py<PyArrayDyn<T>>> {
    Ok(numbers.into_pyarray(py).reshape(shape)?.unbind())
}

/// Returns rows of `width` numbers as a read-only array.
pub fn fixed_rows(py: Python<'_>, numbers: Vec<f64>, width: usize) -> Outcome<Py<PyArray2<f64>>> {
    let row_count = numbers.len() / width.max(1);
    let flat = numbers.into_pyarray(py);
    let rows = flat.reshape([row_count, width])?;
    flat.readwrite().make_nonwriteable();
    rows.readwrite().make_nonwriteable();
    Ok(rows.unbind())
}

/// Returns numbers as a read-only array.
pub fn fixed<T: Element>(py: Python<'_>, numbers: Vec<T>) -> Py<PyArray1<T>> {
    let array = numbers.into_pyarray(py);
    array.readwrite().make_nonwriteable();
    array.unbind()
}

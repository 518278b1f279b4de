//! Converts values of the robot file to Python and back.

use pyo3::IntoPyObjectExt as _;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping, PyString, PyTuple};
use toml::{Table, Value};

/// Returns numbers, text, tuples and read-only dicts: nothing that could be changed behind the robot's back.
pub fn to_python<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    match value {
        Value::String(text) => text.into_bound_py_any(py),
        Value::Integer(number) => number.into_bound_py_any(py),
        Value::Float(number) => number.into_bound_py_any(py),
        Value::Boolean(is_set) => is_set.into_bound_py_any(py),
        Value::Datetime(time) => time.to_string().into_bound_py_any(py),
        Value::Array(values) => {
            let values = values.iter().map(|value| to_python(py, value)).collect::<PyResult<Vec<_>>>()?;
            Ok(PyTuple::new(py, values)?.into_any())
        }
        Value::Table(table) => {
            let dict = PyDict::new(py);
            for (key, value) in table {
                dict.set_item(key, to_python(py, value)?)?;
            }
            py.import("fric._read_only")?.getattr("ReadOnlyDict")?.call1((dict,))
        }
    }
}

/// Converts back; `None` for Python's None, which omits a key. `Err` is the class of a value that cannot be in a file.
pub fn from_python(value: &Bound<'_, PyAny>) -> Result<Option<Value>, String> {
    within(value, DEEPEST)
}

/// Maximum nesting of lists and dicts, because a list may contain itself.
const DEEPEST: usize = 8;

fn within(value: &Bound<'_, PyAny>, depth: usize) -> Result<Option<Value>, String> {
    if value.is_none() { Ok(None) } else { some_from_python(value, depth).map(Some) }
}

fn some_from_python(value: &Bound<'_, PyAny>, depth: usize) -> Result<Value, String> {
    let class = |_| value.get_type().qualname().map_or_else(|_| String::new(), |name| name.to_string());
    if let Ok(text) = value.cast::<PyString>() {
        return text.extract().map(Value::String).map_err(class);
    }
    if let Ok(is_set) = value.extract() {
        return Ok(Value::Boolean(is_set));
    }
    let deeper = || depth.checked_sub(1).ok_or_else(|| "list within lists without end".to_owned());
    if let Ok(mapping) = value.cast::<PyMapping>() {
        let mut table = Table::new();
        for item in mapping.items().map_err(class)? {
            let (key, value): (String, Bound<'_, PyAny>) = item.extract().map_err(class)?;
            if let Some(value) = within(&value, deeper()?)? {
                table.insert(key, value);
            }
        }
        return Ok(Value::Table(table));
    }
    if let Ok(items) = value.try_iter() {
        let item = |item: PyResult<Bound<'_, PyAny>>| some_from_python(&item.map_err(class)?, deeper()?);
        return items.map(item).collect::<Result<_, _>>().map(Value::Array);
    }
    if let Ok(number) = value.extract() {
        return Ok(Value::Integer(number));
    }
    value.extract().map(Value::Float).map_err(class)
}

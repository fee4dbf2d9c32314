//! Values of parts of a state as Python has them.

use hypedc::sim::NamedValue;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyFloat, PyInt, PyString};

use crate::error::argument;

/// A value as an object.
pub(crate) fn object<'py>(py: Python<'py>, value: &NamedValue) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        NamedValue::Number(number) => number.into_pyobject(py)?.into_any(),
        NamedValue::Whole(number) => number.into_pyobject(py)?.into_any(),
        NamedValue::Truth(is) => PyBool::new(py, *is).to_owned().into_any(),
        NamedValue::Name(name) => name.into_pyobject(py)?.into_any(),
        NamedValue::Nothing => py.None().into_bound(py),
    })
}

/// An object as a value.
pub(crate) fn value(object: &Bound<'_, PyAny>) -> PyResult<NamedValue> {
    if object.is_none() {
        return Ok(NamedValue::Nothing);
    }
    if let Ok(is) = object.cast::<PyBool>() {
        return Ok(NamedValue::Truth(is.is_true()));
    }
    if let Ok(name) = object.cast::<PyString>() {
        return Ok(NamedValue::Name(name.to_cow()?.into_owned()));
    }
    if object.cast::<PyInt>().is_ok() || object.cast::<PyFloat>().is_ok() || object.hasattr("__float__")? {
        return Ok(NamedValue::Number(object.extract()?));
    }
    Err(argument(format!("a value is a number, True, False, a name or None, not {}", object.get_type().name()?)))
}

//! NumPy arrays as inputs and outputs of batches: contiguous, of a few types of numbers, borrowed without a copy.

use hypedc::batch::{Part, View, Worker};
use numpy::{
    PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyReadwriteArrayDyn, PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

/// Arrays of numbers that are read.
pub(crate) enum Inputs<'py> {
    F32(PyReadonlyArrayDyn<'py, f32>),
    F64(PyReadonlyArrayDyn<'py, f64>),
    U8(PyReadonlyArrayDyn<'py, u8>),
    I8(PyReadonlyArrayDyn<'py, i8>),
    Bool(PyReadonlyArrayDyn<'py, bool>),
}

/// Arrays of numbers that are written.
pub(crate) enum Outputs<'py> {
    F32(PyReadwriteArrayDyn<'py, f32>),
    F64(PyReadwriteArrayDyn<'py, f64>),
    U8(PyReadwriteArrayDyn<'py, u8>),
}

/// Numbers that are read.
#[derive(Clone, Copy)]
pub(crate) enum Read<'a> {
    F32(&'a [f32]),
    F64(&'a [f64]),
    U8(&'a [u8]),
    I8(&'a [i8]),
    Bool(&'a [bool]),
}

/// Numbers that are written.
pub(crate) enum Write<'a> {
    F32(&'a mut [f32]),
    F64(&'a mut [f64]),
    U8(&'a mut [u8]),
}

/// An array that is something else: what it is, and what it should be.
fn refused(what: &str, object: &Bound<'_, PyAny>, types: &str) -> PyErr {
    match object.cast::<PyUntypedArray>() {
        Ok(array) => PyTypeError::new_err(format!("{what} have dtype {}, which is none of {types}", array.dtype())),
        Err(_) => {
            let name = object.get_type().name().map_or_else(|_| "something else".to_string(), |name| name.to_string());
            PyTypeError::new_err(format!("{what} are a NumPy array of {types}, not {name}"))
        }
    }
}

fn borrowed(what: &str, why: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(format!("{what} cannot be used: {why}"))
}

fn contiguous(what: &str) -> PyErr {
    PyValueError::new_err(format!("{what} are not contiguous: use numpy.ascontiguousarray, or one array for all steps"))
}

/// Checks a shape; `allowed` are the shapes that fit.
fn fits(what: &str, object: &Bound<'_, PyAny>, allowed: &[&[usize]]) -> PyResult<()> {
    let Ok(array) = object.cast::<PyUntypedArray>() else { return Ok(()) };
    let words = |shape: &[usize]| {
        let numbers: Vec<String> = shape.iter().map(usize::to_string).collect();
        format!("({}{})", numbers.join(", "), if shape.len() == 1 { "," } else { "" })
    };
    if allowed.contains(&array.shape()) {
        return Ok(());
    }
    let allowed: Vec<String> = allowed.iter().map(|shape| words(shape)).collect();
    Err(PyValueError::new_err(format!("{what} have shape {}, not {}", words(array.shape()), allowed.join(" or "))))
}

impl<'py> Inputs<'py> {
    /// Borrows an array.
    ///
    /// # Errors
    /// `TypeError` for another type, `ValueError` for another shape.
    pub fn new(what: &str, object: &Bound<'py, PyAny>, shapes: &[&[usize]]) -> PyResult<Self> {
        fits(what, object, shapes)?;
        let of = |why| borrowed(what, why);
        if let Ok(array) = object.cast::<PyArrayDyn<f32>>() {
            return array.try_readonly().map(Inputs::F32).map_err(of);
        }
        if let Ok(array) = object.cast::<PyArrayDyn<f64>>() {
            return array.try_readonly().map(Inputs::F64).map_err(of);
        }
        if let Ok(array) = object.cast::<PyArrayDyn<u8>>() {
            return array.try_readonly().map(Inputs::U8).map_err(of);
        }
        if let Ok(array) = object.cast::<PyArrayDyn<i8>>() {
            return array.try_readonly().map(Inputs::I8).map_err(of);
        }
        if let Ok(array) = object.cast::<PyArrayDyn<bool>>() {
            return array.try_readonly().map(Inputs::Bool).map_err(of);
        }
        Err(refused(what, object, "float32, float64, uint8, int8, bool"))
    }

    /// The numbers.
    pub fn read(&self, what: &str) -> PyResult<Read<'_>> {
        let no = |_| contiguous(what);
        Ok(match self {
            Inputs::F32(array) => Read::F32(array.as_slice().map_err(no)?),
            Inputs::F64(array) => Read::F64(array.as_slice().map_err(no)?),
            Inputs::U8(array) => Read::U8(array.as_slice().map_err(no)?),
            Inputs::I8(array) => Read::I8(array.as_slice().map_err(no)?),
            Inputs::Bool(array) => Read::Bool(array.as_slice().map_err(no)?),
        })
    }
}

impl<'py> Outputs<'py> {
    /// As [`Inputs::new`], for an array that is written.
    pub fn new(what: &str, object: &Bound<'py, PyAny>, shape: &[usize]) -> PyResult<Self> {
        fits(what, object, &[shape])?;
        let of = |why| borrowed(what, why);
        if let Ok(array) = object.cast::<PyArrayDyn<f32>>() {
            return array.try_readwrite().map(Outputs::F32).map_err(of);
        }
        if let Ok(array) = object.cast::<PyArrayDyn<f64>>() {
            return array.try_readwrite().map(Outputs::F64).map_err(of);
        }
        if let Ok(array) = object.cast::<PyArrayDyn<u8>>() {
            return array.try_readwrite().map(Outputs::U8).map_err(of);
        }
        Err(refused(what, object, "float32, float64, uint8"))
    }

    /// The numbers.
    pub fn write(&mut self, what: &str) -> PyResult<Write<'_>> {
        let no = |_| contiguous(what);
        Ok(match self {
            Outputs::F32(array) => Write::F32(array.as_slice_mut().map_err(no)?),
            Outputs::F64(array) => Write::F64(array.as_slice_mut().map_err(no)?),
            Outputs::U8(array) => Write::U8(array.as_slice_mut().map_err(no)?),
        })
    }
}

impl<'a> Read<'a> {
    /// The first numbers, and the others.
    pub fn split_at(self, at: usize) -> (Self, Self) {
        macro_rules! split {
            ($($type:ident),*) => {
                match self {
                    $(Read::$type(all) => {
                        let (first, others) = all.split_at(at.min(all.len()));
                        (Read::$type(first), Read::$type(others))
                    })*
                }
            };
        }
        split!(F32, F64, U8, I8, Bool)
    }

    /// Steps the rows of a part.
    pub fn step(self, part: &mut Part<'_>, resets: bool, worker: &mut Worker) {
        match self {
            Read::F32(all) => part.step(all, resets, worker),
            Read::F64(all) => part.step(all, resets, worker),
            Read::U8(all) => part.step(all, resets, worker),
            Read::I8(all) => part.step(all, resets, worker),
            Read::Bool(all) => part.step(all, resets, worker),
        }
    }
}

impl<'a> Write<'a> {
    /// The first numbers, and the others.
    pub fn split_at(self, at: usize) -> (Self, Self) {
        macro_rules! split {
            ($($type:ident),*) => {
                match self {
                    $(Write::$type(all) => {
                        let at = at.min(all.len());
                        let (first, others) = all.split_at_mut(at);
                        (Write::$type(first), Write::$type(others))
                    })*
                }
            };
        }
        split!(F32, F64, U8)
    }

    /// Writes what is observed of the rows of a part.
    pub fn observe(self, part: &Part<'_>, view: &View) {
        match self {
            Write::F32(all) => part.observe(view, all),
            Write::F64(all) => part.observe(view, all),
            Write::U8(all) => part.observe(view, all),
        }
    }
}

//! Arrays of numpy: reading of arguments, structured answers.

use lin_canny::nalgebra::{Point3, Vector3};
use numpy::{Element, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PySlice, PyTuple};

/// A type of numbers that arguments are converted to.
pub(crate) trait Number: Element {
    /// The name of the dtype.
    const DTYPE: &'static str;
    /// The kinds of dtypes that are accepted: `f` for floats, `i` and `u` for integers.
    const KINDS: &'static str;
}

impl Number for f64 {
    const DTYPE: &'static str = "float64";
    const KINDS: &'static str = "fiu";
}

impl Number for f32 {
    const DTYPE: &'static str = "float32";
    const KINDS: &'static str = "f";
}

impl Number for i64 {
    const DTYPE: &'static str = "int64";
    const KINDS: &'static str = "iu";
}

/// What an argument is called, and the exception that refuses it.
#[derive(Clone, Copy)]
pub(crate) struct Argument {
    pub(crate) name: &'static str,
    pub(crate) error: fn(String) -> PyErr,
}

/// Returns an error if entries of a masked array are masked, or of one in a list or tuple: numpy drops the
/// mask where it makes an array, and the numbers below it mean nothing.
pub(crate) fn refuse_mask(obj: &Bound<'_, PyAny>, argument: Argument) -> PyResult<()> {
    if obj.is_exact_instance_of::<PyUntypedArray>() {
        return Ok(());
    }
    if let Ok(list) = obj.cast::<PyList>() {
        return list.iter().try_for_each(|item| refuse_mask_of(&item, argument));
    }
    match obj.cast::<PyTuple>() {
        Ok(items) => items.iter().try_for_each(|item| refuse_mask_of(&item, argument)),
        Err(_) => refuse_mask_of(obj, argument),
    }
}

fn refuse_mask_of(obj: &Bound<'_, PyAny>, Argument { name, error }: Argument) -> PyResult<()> {
    if obj.is_exact_instance_of::<PyUntypedArray>() || !obj.is_instance_of::<PyUntypedArray>() {
        return Ok(());
    }
    let masks = obj.py().import("numpy")?.getattr("ma")?;
    match masks.call_method1("count_masked", (obj,))?.extract::<usize>()? {
        0 => Ok(()),
        count => Err(error(format!(
            "{name}: the mask covers {count} entries (expected none; fill them, or drop their rows)"
        ))),
    }
}

/// Returns the argument as an array in row-major order: the array itself if it is one.
pub(crate) fn contiguous<'py, T: Number>(
    obj: &Bound<'py, PyAny>,
    argument: Argument,
) -> PyResult<PyReadonlyArrayDyn<'py, T>> {
    let (py, Argument { name, error }) = (obj.py(), argument);
    refuse_mask(obj, argument)?;
    let numpy = py.import("numpy")?;
    let any = numpy
        .call_method1("asarray", (obj,))
        .map_err(|e| error(format!("{name}: {e}")))?;
    let dtype = any.getattr("dtype")?;
    let kind: String = dtype.getattr("kind")?.extract()?;
    let is_empty = any.getattr("size")?.extract::<usize>()? == 0;
    if !is_empty && !T::KINDS.contains(&kind) {
        // An array of one object: it was no sequence of numbers.
        let hint = match obj.hasattr("vertices")? && kind == "O" {
            true => "; pass its `vertices`",
            false => "",
        };
        return Err(error(format!("{name}: dtype is {dtype} (expected {}){hint}", T::DTYPE)));
    }
    let options = PyDict::new(py);
    options.set_item("dtype", T::DTYPE)?;
    let array = numpy.call_method("ascontiguousarray", (any,), Some(&options))?;
    array.extract()
}

/// Returns the rows of an array of shape (M, N).
pub(crate) fn rows<'a, T: Number, const N: usize>(
    array: &'a PyReadonlyArrayDyn<'_, T>,
    argument: Argument,
) -> PyResult<&'a [[T; N]]> {
    let shape = array.shape();
    if shape.len() != 2 || shape[1] != N {
        let Argument { name, error } = argument;
        return Err(error(format!(
            "{name}: shape is {} (expected (N, {N}))",
            shape_text(shape)
        )));
    }
    Ok(array.as_slice()?.as_chunks().0)
}

/// Returns a shape as numpy prints it.
pub(crate) fn shape_text(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        _ => format!(
            "({})",
            shape.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")
        ),
    }
}

/// Returns the points of an array of shape (N, 3).
pub(crate) fn points(obj: &Bound<'_, PyAny>, argument: Argument) -> PyResult<Vec<Point3<f64>>> {
    let array = contiguous::<f64>(obj, argument)?;
    Ok(rows::<f64, 3>(&array, argument)?
        .iter()
        .map(|p| Point3::from(*p))
        .collect())
}

/// Returns whether an argument is a single number, which `contiguous` makes an array of shape (1,).
pub(crate) fn is_number(obj: &Bound<'_, PyAny>) -> PyResult<bool> {
    let dimensions = obj.py().import("numpy")?.call_method1("ndim", (obj,))?;
    Ok(dimensions.extract::<usize>()? == 0)
}

/// Returns the rows of an array of shape (N, M), all of finite numbers.
pub(crate) fn table(obj: &Bound<'_, PyAny>, argument: Argument) -> PyResult<Vec<Vec<f64>>> {
    let Argument { name, error } = argument;
    let array = contiguous::<f64>(obj, argument)?;
    let &[count, width] = array.shape() else {
        return Err(error(format!(
            "{name}: shape is {} (expected two dimensions)",
            shape_text(array.shape())
        )));
    };
    let values = array.as_slice()?;
    if let Some(k) = values.iter().position(|x| !x.is_finite()) {
        let [row, column] = [k / width, k % width];
        return Err(error(format!(
            "{name}: entry [{row}, {column}] is not finite: {}",
            values[k]
        )));
    }
    Ok((0..count)
        .map(|k| values[k * width..(k + 1) * width].to_vec())
        .collect())
}

/// Returns rows of equal length as an array of shape (N, M).
pub(crate) fn of_table<'py>(py: Python<'py>, rows: &[Vec<f64>], width: usize) -> PyResult<Bound<'py, PyArray2<f64>>> {
    PyArray1::from_vec(py, rows.concat()).reshape([rows.len(), width])
}

/// Returns three numbers.
pub(crate) fn vector(obj: &Bound<'_, PyAny>, argument: Argument) -> PyResult<Vector3<f64>> {
    let array = contiguous::<f64>(obj, argument)?;
    match array.as_slice()? {
        [x, y, z] if array.shape() == [3] => Ok(Vector3::new(*x, *y, *z)),
        _ => Err((argument.error)(format!(
            "{}: shape is {} (expected (3,))",
            argument.name,
            shape_text(array.shape())
        ))),
    }
}

/// Returns the numbers of an array of shape (N,).
pub(crate) fn numbers(obj: &Bound<'_, PyAny>, argument: Argument) -> PyResult<Vec<f64>> {
    let array = contiguous::<f64>(obj, argument)?;
    match array.shape() {
        [_] => Ok(array.as_slice()?.to_vec()),
        shape => Err((argument.error)(format!(
            "{}: shape is {} (expected (N,))",
            argument.name,
            shape_text(shape)
        ))),
    }
}

/// Returns numbers as an array of shape (N, 3).
pub(crate) fn of_triples<'py, T: Element>(py: Python<'py>, rows: Vec<[T; 3]>) -> PyResult<Bound<'py, PyArray2<T>>> {
    let count = rows.len();
    PyArray1::from_vec(py, rows.into_flattened()).reshape([count, 3])
}

/// Returns words of at most N letters of ASCII as an array of strings.
pub(crate) fn words<'py, const N: usize>(
    py: Python<'py>,
    words: impl Iterator<Item = impl AsRef<str>>,
) -> PyResult<Bound<'py, PyAny>> {
    let mut letters: Vec<[u32; N]> = Vec::new();
    for word in words {
        // A string of numpy has four bytes for each letter, and ends with zeros.
        let mut row = [0; N];
        row.iter_mut()
            .zip(word.as_ref().bytes())
            .for_each(|(to, byte)| *to = byte.into());
        letters.push(row);
    }
    let count = letters.len();
    let letters = PyArray1::from_vec(py, letters.into_flattened());
    let words = letters.call_method1("view", (format!("U{N}"),))?;
    words.call_method1("reshape", (count,))
}

/// Returns three numbers as an array.
pub(crate) fn triple<'py>(py: Python<'py>, v: [f64; 3]) -> Bound<'py, PyArray1<f64>> {
    PyArray1::from_slice(py, &v)
}

/// A field of a structured array: name, dtype, and how many numbers it has.
pub(crate) type Field = (&'static str, &'static str, usize);

/// Returns rows of numbers as a structured array, of which each field takes the next columns.
pub(crate) fn structured<'py, const N: usize>(
    py: Python<'py>,
    table: Vec<[f64; N]>,
    fields: &[Field],
) -> PyResult<Bound<'py, PyAny>> {
    let count = table.len();
    let table = PyArray1::from_vec(py, table.into_flattened()).reshape([count, N])?;
    if fields.iter().all(|field| field.1 == "f8" && field.2 == 1) {
        let dtype = record(py, fields.iter().map(|(name, dtype, _)| (*name, *dtype, None)))?;
        return table.call_method1("view", (dtype,))?.call_method1("reshape", (count,));
    }
    let (transposed, mut first, mut named) = (table.getattr("T")?, 0, Vec::new());
    for &(name, dtype, width) in fields {
        let column = match width {
            1 => transposed.get_item(first)?,
            _ => {
                let part = PySlice::new(py, first as isize, (first + width) as isize, 1);
                transposed.get_item(part)?.getattr("T")?
            }
        };
        named.push(((name, dtype, (width > 1).then_some(width)), column));
        first += width;
    }
    filled(py, count, named)
}

/// Returns a structured array of columns: name, dtype and numbers of each field.
pub(crate) fn columns<'py>(
    py: Python<'py>,
    count: usize,
    fields: &[(&'static str, &'static str, Bound<'py, PyAny>)],
) -> PyResult<Bound<'py, PyAny>> {
    let named = fields
        .iter()
        .map(|(name, dtype, column)| ((*name, *dtype, None), column.clone()));
    filled(py, count, named.collect())
}

/// A column of a structured array: name, dtype, and the number of its entries if it is an array.
pub(crate) type Column = (&'static str, &'static str, Option<usize>);

/// Returns a dtype of columns.
fn record<'py>(py: Python<'py>, columns: impl Iterator<Item = Column>) -> PyResult<Bound<'py, PyAny>> {
    let names = PyList::empty(py);
    for (name, dtype, width) in columns {
        match width {
            None => names.append((name, dtype))?,
            Some(width) => names.append((name, dtype, (width,)))?,
        }
    }
    py.import("numpy")?.call_method1("dtype", (names,))
}

/// Returns a structured array of shape (count,) from its columns.
pub(crate) fn filled<'py>(
    py: Python<'py>,
    count: usize,
    columns: Vec<(Column, Bound<'py, PyAny>)>,
) -> PyResult<Bound<'py, PyAny>> {
    let dtype = record(py, columns.iter().map(|(column, _)| *column))?;
    let out = py.import("numpy")?.call_method1("empty", (count, dtype))?;
    for ((name, ..), column) in columns {
        out.set_item(name, column)?;
    }
    Ok(out)
}

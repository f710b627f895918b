//! Arrays of numpy, versions 1 to 3: an array whose last axis is x, y, z and further columns, or an
//! array of structures with the fields x, y and z; in both byte orders, in C and Fortran order. A
//! grid is an array of two axes. The header of an array of three axes is written.
//!
//! The size of the data must fit the shape. Points follow each other in C order: an image of points
//! is read row by row.
//!
//! Source: numpy.lib.format, and the documentation of `numpy.dtype`.

use crate::error::Fault;
use crate::grid::Grid;
use crate::number::{Order, Type};
use crate::points::{Column, PointList};
use crate::text;

/// The first bytes of each file.
pub(crate) const MAGIC: &[u8] = b"\x93NUMPY";

/// Most columns of an array of points. An array with a point per column has more.
const COLUMNS: u64 = 64;

/// Reads an array of points.
pub(crate) fn read(bytes: &[u8], list: &mut PointList) -> Result<(), Fault> {
    let (array, data, start) = parse(bytes)?;
    array.check_size(data, start)?;
    array.read(data, list)
}

/// Reads an array of two axes.
pub(crate) fn read_grid(bytes: &[u8]) -> Result<Grid, Fault> {
    let (array, data, start) = parse(bytes)?;
    array.check_size(data, start)?;
    array.grid(data)
}

/// Returns what is in front of the numbers of an array of `f64`, little endian and in C order.
///
/// The length is a multiple of 64, as numpy writes it.
pub(crate) fn header(shape: [usize; 3]) -> Vec<u8> {
    let [x, y, z] = shape;
    let mut text = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({x}, {y}, {z}), }}");
    // The magic, the version, the length of the text, and the line feed.
    let start = MAGIC.len() + 5;
    while !(start + text.len()).is_multiple_of(64) {
        text.push(' ');
    }
    text.push('\n');
    let length = (text.len() as u16).to_le_bytes();
    [MAGIC, &[1, 0], &length, text.as_bytes()].concat()
}

/// Returns the array of a file, its data, and the byte at which they start.
fn parse(bytes: &[u8]) -> Result<(Array, &[u8], usize), Fault> {
    let malformed = |why: String| Fault::malformed(None, why);
    let cut = || malformed("header is cut".into());
    let Some(rest) = bytes.strip_prefix(MAGIC) else {
        return Err(malformed("file does not start as an array of numpy".into()));
    };
    let (version, rest) = rest.split_first_chunk::<2>().ok_or_else(cut)?;
    let (length, rest) = match version {
        [1, _] => {
            let (length, rest) = rest.split_first_chunk().ok_or_else(cut)?;
            (u32::from(u16::from_le_bytes(*length)), rest)
        }
        [2 | 3, _] => {
            let (length, rest) = rest.split_first_chunk().ok_or_else(cut)?;
            (u32::from_le_bytes(*length), rest)
        }
        [version, _] => return Err(malformed(format!("unknown version: {version} (expected 1 to 3)"))),
    };
    let (header, data) = rest.split_at_checked(length as usize).ok_or_else(cut)?;
    let start = bytes.len() - data.len();
    // Version 3 is UTF-8, the others are Latin-1.
    let header = text::decode(header);
    let mut parser = Parser {
        rest: &header,
        depth: 0,
    };
    let header = parser.whole().map_err(|why| {
        let at = start - parser.rest.len().min(start);
        malformed(format!("header is invalid near byte {at}: {why}"))
    })?;
    let array = Array::new(&header).map_err(|why| match why {
        Why::Malformed(why) => malformed(why),
        Why::Unsupported(what) => Fault::unsupported(None, what),
    })?;
    Ok((array, data, start))
}

/// An expression of Python.
#[derive(Debug, PartialEq)]
enum Value {
    Text(String),
    Number(u64),
    Bool(bool),
    None,
    /// A tuple or a list.
    List(Vec<Value>),
    Dict(Vec<(Value, Value)>),
}

struct Parser<'a> {
    rest: &'a str,
    depth: usize,
}

/// Most brackets around an expression.
const DEPTH: usize = 64;

impl Parser<'_> {
    /// Takes an expression, behind which only white space is left.
    fn whole(&mut self) -> Result<Value, String> {
        let value = self.value()?;
        self.blank();
        if self.rest.trim_matches('\0').is_empty() {
            Ok(value)
        } else {
            Err(self.unexpected("the end"))
        }
    }

    fn unexpected(&self, expected: &str) -> String {
        format!("{} (expected {expected})", text::quoted(self.rest))
    }

    fn blank(&mut self) {
        self.rest = self.rest.trim_start();
    }

    /// Takes a character, and white space in front.
    fn take(&mut self, character: char) -> bool {
        self.blank();
        let rest = self.rest.strip_prefix(character);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    fn value(&mut self) -> Result<Value, String> {
        self.blank();
        for (word, value) in [
            ("True", Value::Bool(true)),
            ("False", Value::Bool(false)),
            ("None", Value::None),
        ] {
            if let Some(rest) = self.rest.strip_prefix(word) {
                self.rest = rest;
                return Ok(value);
            }
        }
        match self.rest.chars().next() {
            Some(quote @ ('"' | '\'')) => {
                let text = &self.rest[1..];
                let end = text.find([quote, '\\']);
                let end = end.filter(|&end| text[end..].starts_with(quote));
                let end = end.ok_or_else(|| self.unexpected("a text without backslashes"))?;
                self.rest = &text[end + 1..];
                Ok(Value::Text(text[..end].into()))
            }
            Some('0'..='9') => {
                let end = self.rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(self.rest.len());
                let number = self.rest[..end].parse();
                let number = number.map_err(|_| self.unexpected("a number of 64 bits"))?;
                // Python 2 writes an L behind.
                let rest = &self.rest[end..];
                self.rest = rest.strip_prefix('L').unwrap_or(rest);
                Ok(Value::Number(number))
            }
            Some('(') => self.list(')'),
            Some('[') => self.list(']'),
            Some('{') => self.list('}'),
            _ => Err(self.unexpected("an expression")),
        }
    }

    /// Takes the entries between brackets.
    fn list(&mut self, end: char) -> Result<Value, String> {
        self.rest = &self.rest[1..];
        self.depth += 1;
        if self.depth > DEPTH {
            return Err(format!("more than {DEPTH} brackets"));
        }
        let (mut values, mut pairs) = (Vec::new(), Vec::new());
        let mut is_tuple = false;
        while !self.take(end) {
            let value = self.value()?;
            if end == '}' {
                if !self.take(':') {
                    return Err(self.unexpected("a colon"));
                }
                pairs.push((value, self.value()?));
            } else {
                values.push(value);
            }
            if !self.take(',') {
                if !self.take(end) {
                    return Err(self.unexpected("a comma"));
                }
                break;
            }
            is_tuple = true;
        }
        self.depth -= 1;
        match (end, values.pop()) {
            ('}', _) => Ok(Value::Dict(pairs)),
            // Brackets around an expression are no tuple.
            (')', Some(value)) if !is_tuple => Ok(value),
            (_, last) => {
                values.extend(last);
                Ok(Value::List(values))
            }
        }
    }
}

enum Why {
    Malformed(String),
    Unsupported(String),
}

/// A field of a structure, or the items of an array.
#[derive(Debug)]
struct Field {
    /// The name in lower case; empty for bytes without a meaning.
    name: String,
    /// The type and the order, if the field is one number of a type that is read.
    of: Option<(Type, Order)>,
    /// The first byte within an item.
    start: u64,
    /// What the file says.
    text: String,
}

struct Array {
    fields: Vec<Field>,
    is_structure: bool,
    /// Number of bytes of an item.
    size: u64,
    shape: Vec<u64>,
    is_fortran: bool,
}

impl Array {
    fn new(header: &Value) -> Result<Self, Why> {
        let malformed = |why: &str| Err(Why::Malformed(why.into()));
        let Value::Dict(entries) = header else {
            return malformed("header is no dictionary");
        };
        let (mut descr, mut order, mut shape) = (None, None, None);
        for (key, value) in entries {
            let entry = match key {
                Value::Text(key) if key == "descr" => &mut descr,
                Value::Text(key) if key == "fortran_order" => &mut order,
                Value::Text(key) if key == "shape" => &mut shape,
                _ => return malformed("header has an unknown key (expected descr, fortran_order and shape)"),
            };
            if entry.replace(value).is_some() {
                return malformed("header has a key twice");
            }
        }
        let (Some(descr), Some(Value::Bool(is_fortran)), Some(Value::List(shape))) = (descr, order, shape) else {
            return malformed("header has no valid descr, fortran_order and shape");
        };
        let number = |value: &Value| match value {
            Value::Number(number) => Ok(*number),
            _ => Err(Why::Malformed("invalid shape (expected whole numbers from 0)".into())),
        };
        let shape = shape.iter().map(number).collect::<Result<Vec<u64>, _>>()?;
        if shape.len() > DEPTH {
            return malformed("invalid shape (expected at most 64 axes)");
        }
        let (mut fields, mut size) = (Vec::new(), 0u64);
        let is_structure = match descr {
            Value::Text(text) => {
                let (of, bytes) = type_of(text)?;
                size = bytes;
                let (name, text) = (String::new(), text.clone());
                fields.push(Field {
                    name,
                    of,
                    start: 0,
                    text,
                });
                false
            }
            Value::List(list) => {
                for entry in list {
                    let Value::List(entry) = entry else {
                        return malformed("invalid field of a structure (expected a tuple)");
                    };
                    let field = field_of(entry, &mut size)?;
                    let is_known = AXES.contains(&field.name.as_str()) || field.name == RADIUS;
                    if is_known && fields.iter().any(|other: &Field| other.name == field.name) {
                        return malformed("structure has a field twice");
                    }
                    fields.push(field);
                }
                true
            }
            _ => return malformed("invalid descr (expected a type or the fields of a structure)"),
        };
        Ok(Self {
            fields,
            is_structure,
            size,
            shape,
            is_fortran: *is_fortran,
        })
    }

    /// Returns the shape for an error.
    fn shown_shape(&self) -> String {
        let shape: Vec<String> = self.shape.iter().map(u64::to_string).collect();
        text::quoted(&shape.join(" x "))
    }

    /// Returns an error if the data, which start at a byte of the file, do not fit the shape.
    fn check_size(&self, data: &[u8], start: usize) -> Result<(), Fault> {
        let all = product(&self.shape).and_then(|items| items.checked_mul(self.size));
        if all != Some(data.len() as u64) {
            let why = format!("{} bytes follow the header of {start} bytes", data.len());
            let shape = self.shown_shape();
            let why = match all {
                Some(all) => format!("{why} (expected {all}: shape {shape} of {} bytes)", self.size),
                None => format!("{why} (expected shape {shape})"),
            };
            return Err(Fault::malformed(None, why));
        }
        Ok(())
    }

    /// Returns the numbers of an array of two axes, whose data fit its shape.
    fn grid(&self, data: &[u8]) -> Result<Grid, Fault> {
        let &[rows, columns] = &self.shape[..] else {
            let shape = self.shown_shape();
            let why = format!("an array of shape {shape} (expected two axes: rows and columns)");
            return Err(Fault::malformed(None, why));
        };
        let values = self.numbers(data)?;
        let (rows, columns) = (rows as usize, columns as usize);
        Ok(Grid { rows, columns, values })
    }

    /// Returns the numbers in C order of data that fit the shape.
    fn numbers(&self, data: &[u8]) -> Result<Vec<f64>, Fault> {
        let field = self.fields.first().filter(|_| !self.is_structure);
        let Some((of, order)) = field.and_then(|field| field.of) else {
            let of = field.map_or_else(
                || "structures".into(),
                |field| format!("type {}", text::quoted(&field.text)),
            );
            return Err(Fault::unsupported(None, format!("an array of {of}")));
        };
        let count = product(&self.shape).unwrap_or(0) as usize;
        if count == 0 {
            let why = format!("an array of shape {} contains no number", self.shown_shape());
            return Err(Fault::malformed(None, why));
        }
        let size = self.size as usize;
        let column = Column {
            of,
            order,
            start: 0,
            stride: size,
        };
        let number = |k: usize| {
            let item = if self.is_fortran { fortran(&self.shape, k) } else { k };
            column
                .number(data, item)
                .map_err(|why| Fault::malformed(None, format!("number {} {why}", place(&self.shape, k))))
        };
        (0..count).map(number).collect()
    }

    /// Reads the points of data that fit the shape.
    fn read(&self, data: &[u8], list: &mut PointList) -> Result<(), Fault> {
        let unsupported = |what: String| Fault::unsupported(None, what);
        // The axes that number points.
        let rows = if self.is_structure {
            &self.shape[..]
        } else {
            match self.shape.split_last() {
                Some((3..=COLUMNS, rows)) if !rows.is_empty() => rows,
                _ => {
                    let shape = self.shown_shape();
                    let what =
                        format!("an array of shape {shape} (expected a row of 3 to {COLUMNS} numbers per point)");
                    return Err(Fault::malformed(None, what));
                }
            }
        };
        let count = product(rows).unwrap_or(0) as usize;
        if count == 0 {
            return Ok(());
        }
        let size = self.size as usize;
        let column = |field: &Field, start: usize, stride: usize| match field.of {
            Some((of, order)) => Ok(Column {
                of,
                order,
                start,
                stride,
            }),
            None => Err(unsupported(format!(
                "the type {} of coordinates",
                text::quoted(&field.text)
            ))),
        };
        let (axes, radius);
        if self.is_structure {
            let axis = |name: &str| {
                let found = self.fields.iter().find(|field| field.name == name);
                let why = || Fault::malformed(None, format!("structure has no field {name}"));
                let field = found.ok_or_else(why)?;
                column(field, field.start as usize, size)
            };
            axes = [axis("x")?, axis("y")?, axis("z")?];
            // A radius of several numbers is passed over.
            let of = self
                .fields
                .iter()
                .find(|field| field.name == RADIUS && field.of.is_some());
            radius = of.map(|field| column(field, field.start as usize, size)).transpose()?;
            for field in &self.fields {
                let is_read = AXES.contains(&field.name.as_str()) || (field.name == RADIUS && field.of.is_some());
                if !field.name.is_empty() && !is_read {
                    list.skip(None, &field.name);
                }
            }
        } else {
            let field = &self.fields[0];
            let columns = self.shape.last().map_or(0, |columns| *columns as usize);
            let axis = |k: usize| {
                // In Fortran order, all first columns come first.
                if self.is_fortran {
                    column(field, k * count * size, size)
                } else {
                    column(field, k * size, columns * size)
                }
            };
            axes = [axis(0)?, axis(1)?, axis(2)?];
            radius = None;
            match columns {
                3 => {}
                4 => list.note(None, "column 4"),
                _ => list.note(None, &format!("columns 4 to {columns}")),
            }
        }
        let item = |k: usize| if self.is_fortran { fortran(rows, k) } else { k };
        list.read(data, count, axes, radius, item)
    }
}

/// Returns the number of items of a shape.
fn product(shape: &[u64]) -> Option<u64> {
    shape.iter().try_fold(1u64, |product, n| product.checked_mul(*n))
}

const AXES: [&str; 3] = ["x", "y", "z"];
const RADIUS: &str = "radius";

/// Returns the index in each axis of an item that is number `k` in C order.
fn place(shape: &[u64], mut k: usize) -> String {
    let mut text = String::new();
    for axis in shape.iter().rev() {
        let axis = *axis as usize;
        text = format!("[{}]{text}", k % axis);
        k /= axis;
    }
    text
}

/// Returns the number in Fortran order of an item that is number `k` in C order.
fn fortran(shape: &[u64], mut k: usize) -> usize {
    // The last axis is the fastest of C order, and the slowest of Fortran order.
    let mut stride = shape.iter().product::<u64>() as usize;
    let mut item = 0;
    for axis in shape.iter().rev() {
        let axis = *axis as usize;
        stride /= axis;
        item += (k % axis) * stride;
        k /= axis;
    }
    item
}

/// A type with its order, if it is read; and its number of bytes.
type Item = (Option<(Type, Order)>, u64);

/// Returns a type, such as `<f4`.
fn type_of(text: &str) -> Result<Item, Why> {
    let malformed = || Why::Malformed(format!("unknown type: {}", text::quoted(text)));
    let order = match text.as_bytes().first() {
        Some(b'>') => Order::Big,
        Some(b'<' | b'|' | b'=') => Order::Little,
        _ => return Err(malformed()),
    };
    let rest = &text[1..];
    let letter = rest
        .chars()
        .next()
        .filter(char::is_ascii_alphabetic)
        .ok_or_else(malformed)?;
    if letter == 'O' {
        return Err(Why::Unsupported("an array of objects".into()));
    }
    // The unit of a time is in brackets.
    let digits = rest[1..].split('[').next().unwrap_or_default();
    let number: u64 = digits.parse().map_err(|_| malformed())?;
    let size = if letter == 'U' {
        number.checked_mul(4)
    } else {
        Some(number)
    };
    let size = size.ok_or_else(malformed)?;
    Ok((Type::of(letter as u8, size).map(|of| (of, order)), size))
}

/// Returns a field of a structure, `(name, type)` or `(name, type, shape)`, and adds its size.
fn field_of(entry: &[Value], size: &mut u64) -> Result<Field, Why> {
    let malformed = |why: &str| Why::Malformed(format!("invalid field of a structure: {why}"));
    let (name, descr, shape) = match entry {
        [name, descr] => (name, descr, None),
        [name, descr, shape] => (name, descr, Some(shape)),
        _ => return Err(malformed("expected a name, a type and a shape")),
    };
    let name = match name {
        Value::Text(name) => name,
        // A title and a name.
        Value::List(names) => match &names[..] {
            [Value::Text(_), Value::Text(name)] => name,
            _ => return Err(malformed("expected a name")),
        },
        _ => return Err(malformed("expected a name")),
    };
    let (mut of, mut bytes, text) = match descr {
        Value::Text(text) => {
            let (of, bytes) = type_of(text)?;
            (of, bytes, text.clone())
        }
        Value::List(fields) => {
            let mut bytes = 0;
            for field in fields {
                let Value::List(entry) = field else {
                    return Err(malformed("expected a tuple"));
                };
                field_of(entry, &mut bytes)?;
            }
            (None, bytes, "structure".into())
        }
        _ => return Err(malformed("expected a type")),
    };
    if let Some(shape) = shape {
        of = None;
        let one = std::slice::from_ref(shape);
        let axes = if let Value::List(axes) = shape { &axes[..] } else { one };
        for axis in axes {
            let Value::Number(axis) = axis else {
                return Err(malformed("expected a shape"));
            };
            bytes = bytes.checked_mul(*axis).ok_or_else(|| malformed("too many bytes"))?;
        }
    }
    let start = *size;
    *size = size.checked_add(bytes).ok_or_else(|| malformed("too many bytes"))?;
    Ok(Field {
        name: name.to_ascii_lowercase(),
        of,
        start,
        text,
    })
}

#[cfg(test)]
mod tests {
    use super::{Array, header, parse};

    #[test]
    fn headers_that_are_written_are_read() {
        for shape in [[1, 2, 3], [usize::from(u16::MAX), 1, 1], [1 << 31, 1 << 31, 1 << 31]] {
            let bytes = header(shape);
            assert_eq!(bytes.len() % 64, 0);
            let (array, data, start): (Array, _, _) = parse(&bytes).expect("a header");
            assert_eq!(array.shape, shape.map(|n| n as u64));
            assert!(!array.is_fortran && array.size == 8 && data.is_empty() && start == bytes.len());
        }
    }

    #[test]
    fn numbers_that_are_written_are_read() {
        let values: Vec<f64> = (0..24).map(|k| 1.0 / f64::from(k - 7)).collect();
        let data: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        let bytes = [header([2, 3, 4]), data].concat();
        let (array, data, _) = parse(&bytes).expect("a header");
        let read = array.numbers(data).expect("numbers");
        assert!(read.iter().zip(&values).all(|(a, b)| a.to_bits() == b.to_bits()) && read.len() == 24);
    }
}

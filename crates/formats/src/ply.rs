//! PLY 1.0, text and binary in both byte orders: the elements `face` and `tristrips` over the
//! positions of the element `vertex`.
//!
//! Numbers of a text keep all their digits, also where the header declares them as `float`. The
//! reader passes over edges, materials and cameras; any other element with rows is an error,
//! because it may be geometry. Each row has at least one byte, so that a count in the header ends
//! with the file. A row of a text is one line. Read as points, a PLY is its vertices, and all other
//! elements are passed over.
//!
//! Source: Greg Turk, The PLY Polygon File Format, 1994; `tristrips` as in the files of Stanford.

use std::collections::HashSet;

use crate::error::Fault;
use crate::mesh::{MeshFile, MeshFormat, MeshObject, ObjectBuilder, SkippedList};
use crate::number::{Order, Type};
use crate::points::PointList;
use crate::{polygon, text};

/// Reads the faces of a PLY.
pub(crate) fn read(bytes: &[u8]) -> Result<MeshFile, Fault> {
    let mut contents = Contents::default();
    elements(bytes, |element, _, body| contents.element(element, body))?;
    contents.build()
}

/// Reads the vertices of a PLY. All other elements are passed over.
pub(crate) fn read_points(bytes: &[u8], list: &mut PointList) -> Result<(), Fault> {
    elements(bytes, |element, is_text, body| {
        if element.rows > 0 && element.name == "vertex" {
            return vertices(element, is_text, body, list);
        }
        if element.rows > 0 {
            element.check()?;
            list.skip(element.line, &element.name);
        }
        let is_wanted = vec![false; element.properties.len()];
        for row in 0..element.rows {
            body.row(element, row, &is_wanted)?;
        }
        Ok(())
    })
}

/// Reads the rows of the element `vertex` as points.
fn vertices(element: &Element, is_text: bool, body: &mut Body, list: &mut PointList) -> Result<(), Fault> {
    element.check()?;
    let [x, y, z] = [
        element.property(&["x"], false)?,
        element.property(&["y"], false)?,
        element.property(&["z"], false)?,
    ];
    let is_radius = |p: &Property| p.name == "radius" && p.length.is_none();
    let radius = element.properties.iter().position(is_radius);
    let mut is_wanted = vec![false; element.properties.len()];
    for k in [x, y, z].into_iter().chain(radius) {
        is_wanted[k] = true;
    }
    // The rank of a wanted property among the wanted ones.
    let rank = |k: usize| is_wanted[..k].iter().filter(|is_wanted| **is_wanted).count();
    let (axes, radius) = ([x, y, z].map(rank), radius.map(rank));
    let is_single = !is_text && [x, y, z].iter().all(|&k| element.properties[k].of == Type::F32);
    list.begin(is_single, radius.is_some(), 0);
    for (property, _) in element
        .properties
        .iter()
        .zip(&is_wanted)
        .filter(|(_, is_wanted)| !**is_wanted)
    {
        list.skip(property.line, &property.name);
    }
    for row in 0..element.rows {
        let numbers = body.row(element, row, &is_wanted)?;
        list.push(axes.map(|k| numbers[k]), radius.map(|k| numbers[k]), body.line())?;
    }
    Ok(())
}

/// Reads the header, and calls a function for each element, which must read all its rows.
fn elements(bytes: &[u8], mut read: impl FnMut(&Element, bool, &mut Body) -> Result<(), Fault>) -> Result<(), Fault> {
    let bytes = text::without_mark(bytes);
    let bytes = &bytes[..];
    let header = Header::read(bytes)?;
    let text;
    let mut body = match header.order {
        Some(order) => Body::Binary(header.rest, order),
        None => {
            text = text::decode(header.rest);
            let lines = text::lines(&text).filter(|(_, line)| !line.trim().is_empty());
            Body::Text(Rows {
                lines: Box::new(lines.map(|(k, line)| (header.lines + k, line))),
                line: header.lines,
                words: "".split_whitespace(),
            })
        }
    };
    for element in &header.elements {
        read(element, header.order.is_none(), &mut body)?;
    }
    body.end()
}

/// Returns the type of a property.
fn type_of(name: &str) -> Option<Type> {
    Some(match name {
        "char" | "int8" => Type::I8,
        "uchar" | "uint8" => Type::U8,
        "short" | "int16" => Type::I16,
        "ushort" | "uint16" => Type::U16,
        "int" | "int32" => Type::I32,
        "uint" | "uint32" => Type::U32,
        "float" | "float32" => Type::F32,
        "double" | "float64" => Type::F64,
        _ => return None,
    })
}

struct Property {
    /// The name in lower case.
    name: String,
    line: usize,
    /// The type of the number, or of each number of a list.
    of: Type,
    /// The type of the length, if the property is a list.
    length: Option<Type>,
}

struct Element {
    /// The name in lower case.
    name: String,
    line: usize,
    rows: u64,
    properties: Vec<Property>,
}

impl Element {
    /// Returns an error if the rows have no bytes: their number has no end then.
    fn check(&self) -> Result<(), Fault> {
        if self.properties.is_empty() {
            let why = format!("element has no properties: {}", text::quoted(&self.name));
            return Err(Fault::malformed(self.line, why));
        }
        Ok(())
    }

    /// Returns the index of the property with one of the names, which must be there once.
    fn property(&self, names: &[&str], is_list: bool) -> Result<usize, Fault> {
        let mut found = (0..self.properties.len()).filter(|&k| names.contains(&self.properties[k].name.as_str()));
        match (found.next(), found.next()) {
            (Some(k), None) if self.properties[k].length.is_some() == is_list => Ok(k),
            _ => {
                let kind = if is_list { "a list" } else { "a number" };
                let why = format!(
                    "element {} has an invalid property {} (expected {kind}, once)",
                    self.name, names[0]
                );
                Err(Fault::malformed(self.line, why))
            }
        }
    }
}

struct Header<'a> {
    /// The order of the bytes; `None` for text.
    order: Option<Order>,
    elements: Vec<Element>,
    /// The names of elements, with 0, and of properties, with the number of their element from 1.
    names: HashSet<(usize, String)>,
    /// Number of lines.
    lines: usize,
    /// The bytes behind the header.
    rest: &'a [u8],
}

impl<'a> Header<'a> {
    fn read(bytes: &'a [u8]) -> Result<Self, Fault> {
        let mut header = Header {
            order: None,
            elements: Vec::new(),
            names: HashSet::new(),
            lines: 0,
            rest: bytes,
        };
        let (mut is_format_known, mut end_of_first) = (false, None);
        loop {
            let Some((line, end)) = header.next_line() else {
                let why = "header is cut (expected a line end_header)";
                return Err(Fault::malformed(header.lines, why));
            };
            // Comments may have bytes of any encoding.
            let text = String::from_utf8_lossy(line);
            let words: Vec<&str> = text.split_whitespace().collect();
            let at = header.lines;
            let malformed = |why: String| Err(Fault::malformed(at, why));
            if end_of_first.is_none() {
                match words[..] {
                    [] => {}
                    [word] if word.eq_ignore_ascii_case("ply") => end_of_first = Some(end),
                    [word, ..] => return malformed(format!("unknown word: {} (expected ply)", text::quoted(word))),
                }
                continue;
            }
            match words[..] {
                [] | ["comment" | "obj_info", ..] => {}
                ["format", order, version] if !is_format_known => {
                    header.order = match order {
                        "ascii" => None,
                        "binary_little_endian" => Some(Order::Little),
                        "binary_big_endian" => Some(Order::Big),
                        _ => return malformed(format!("unknown format: {}", text::quoted(order))),
                    };
                    if version != "1.0" {
                        return malformed(format!("unknown version: {} (expected 1.0)", text::quoted(version)));
                    }
                    is_format_known = true;
                }
                ["element", name, count] => {
                    let Ok(rows) = count.parse() else {
                        let why = "(expected a whole number from 0)";
                        return malformed(format!("invalid count of an element: {} {why}", text::quoted(count)));
                    };
                    let name = name.to_ascii_lowercase();
                    if !header.names.insert((0, name.clone())) {
                        return malformed(format!("element is there twice: {}", text::quoted(&name)));
                    }
                    header.elements.push(Element {
                        name,
                        line: at,
                        rows,
                        properties: Vec::new(),
                    });
                }
                ["property", "list", length, of, name] => header.property(Some(length), of, name)?,
                ["property", of, name] => header.property(None, of, name)?,
                ["end_header"] => {
                    if !is_format_known {
                        return malformed("header has no line format".into());
                    }
                    // After lines that end with CR, LF is the first byte of the body.
                    if end == b"\r\n" && end_of_first == Some(b"\r") {
                        header.rest = &bytes[bytes.len() - header.rest.len() - 1..];
                    }
                    return Ok(header);
                }
                [word, ..] => return malformed(format!("unknown or misplaced word: {}", text::quoted(word))),
            }
        }
    }

    /// Takes a line; returns it and its end: LF, CR or CR LF.
    fn next_line(&mut self) -> Option<(&'a [u8], &'a [u8])> {
        let rest = self.rest;
        let length = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r'))?;
        let (line, after) = rest.split_at(length);
        let end = if after.starts_with(b"\r\n") { 2 } else { 1 };
        self.rest = &after[end..];
        self.lines += 1;
        Some((line, &after[..end]))
    }

    fn property(&mut self, length: Option<&str>, of: &str, name: &str) -> Result<(), Fault> {
        let malformed = |why: String| Fault::malformed(self.lines, why);
        let number = |name: &str| {
            let found = type_of(name);
            found.ok_or_else(|| malformed(format!("unknown type of a property: {}", text::quoted(name))))
        };
        let property = Property {
            name: name.to_ascii_lowercase(),
            line: self.lines,
            of: number(of)?,
            length: length.map(number).transpose()?,
        };
        if property.length.is_some_and(|length| !length.is_integer()) {
            return Err(malformed("invalid type of a length (expected an integer type)".into()));
        }
        if !self.names.insert((self.elements.len(), property.name.clone())) {
            return Err(malformed(format!("property is there twice: {}", text::quoted(name))));
        }
        let Some(element) = self.elements.last_mut() else {
            return Err(malformed("property is in front of the first element".into()));
        };
        element.properties.push(property);
        Ok(())
    }
}

/// The rows that are left.
enum Body<'a> {
    Text(Rows<'a>),
    Binary(&'a [u8], Order),
}

/// The rows of a text: a line each.
struct Rows<'a> {
    /// The lines that are left, without blank ones.
    lines: Box<dyn Iterator<Item = (usize, &'a str)> + 'a>,
    /// The current line.
    line: usize,
    /// The words of the current line that are left.
    words: std::str::SplitWhitespace<'a>,
}

impl Body<'_> {
    fn line(&self) -> Option<usize> {
        match self {
            Self::Text(rows) => Some(rows.line),
            Self::Binary(..) => None,
        }
    }

    /// Takes a row; returns the numbers of the wanted properties.
    fn row(&mut self, element: &Element, row: u64, is_wanted: &[bool]) -> Result<Vec<f64>, Fault> {
        let numbers = self.numbers(element, is_wanted);
        numbers.map_err(|why| Fault::malformed(self.line(), format!("{} {row} {why}", element.name)))
    }

    fn numbers(&mut self, element: &Element, is_wanted: &[bool]) -> Result<Vec<f64>, String> {
        if let Self::Text(rows) = self {
            let (line, text) = rows.lines.next().ok_or("is missing at the end of the file")?;
            (rows.line, rows.words) = (line, text.split_whitespace());
        }
        let mut numbers = Vec::new();
        for (property, is_wanted) in element.properties.iter().zip(is_wanted) {
            let length = match property.length {
                Some(of) => self.number(of)?,
                None => 1.0,
            };
            if !(length >= 0.0 && length.fract() == 0.0) {
                return Err(format!(
                    "has an invalid length of a list: {length} (expected 0 or more)"
                ));
            }
            // A number beyond the end ends the loop, however long the list claims to be.
            for _ in 0..length as u64 {
                if *is_wanted {
                    numbers.push(self.number(property.of)?);
                } else {
                    self.skip(property.of)?;
                }
            }
        }
        if let Self::Text(rows) = self
            && let Some(word) = rows.words.next()
        {
            let why = "(expected the numbers of its properties)";
            return Err(format!("has a number too many: {} {why}", text::quoted(word)));
        }
        Ok(numbers)
    }

    fn number(&mut self, of: Type) -> Result<f64, String> {
        match self {
            Self::Text(rows) => {
                let word = rows.words.next().ok_or(CUT)?;
                let number = text::measured(word);
                number.ok_or_else(|| format!("has an invalid number: {}", text::quoted(word)))
            }
            Self::Binary(rest, order) => of.take(rest, *order).ok_or_else(|| CUT.into()),
        }
    }

    /// Takes a number that is not used, and may be no number.
    fn skip(&mut self, of: Type) -> Result<(), String> {
        match self {
            Self::Text(rows) => rows.words.next().map(drop),
            Self::Binary(rest, order) => of.take(rest, *order).map(drop),
        }
        .ok_or_else(|| CUT.into())
    }

    /// Returns an error if anything is left.
    fn end(&mut self) -> Result<(), Fault> {
        match self {
            Self::Text(rows) => match rows.lines.next() {
                Some((line, text)) => {
                    let word = text::quoted(text.trim());
                    Err(Fault::malformed(line, format!("line follows the last row: {word}")))
                }
                None => Ok(()),
            },
            Self::Binary([], _) => Ok(()),
            Self::Binary(rest, _) => Err(Fault::malformed(
                None,
                format!("{} bytes follow the last row (expected none)", rest.len()),
            )),
        }
    }
}

const CUT: &str = "is cut (expected the numbers of its properties)";

/// What the rows contain.
#[derive(Default)]
struct Contents {
    points: Vec<[f64; 3]>,
    // A file may have faces before vertices, so faces wait.
    faces: Vec<Face>,
    skipped: SkippedList,
}

struct Face {
    /// The number of the row.
    row: u64,
    line: Option<usize>,
    is_strip: bool,
    corners: Vec<f64>,
}

impl Contents {
    /// Reads the rows of an element.
    fn element(&mut self, element: &Element, body: &mut Body) -> Result<(), Fault> {
        if element.rows == 0 {
            return Ok(());
        }
        element.check()?;
        let mut is_wanted = vec![false; element.properties.len()];
        match element.name.as_str() {
            "vertex" => {
                let mut axes = [0; 3];
                for (axis, name) in axes.iter_mut().zip(["x", "y", "z"]) {
                    *axis = element.property(&[name], false)?;
                    is_wanted[*axis] = true;
                }
                // The rank of each axis among the three.
                let ranks = axes.map(|axis| axes.iter().filter(|other| **other < axis).count());
                for row in 0..element.rows {
                    let numbers = body.row(element, row, &is_wanted)?;
                    self.points.push(ranks.map(|rank| numbers[rank]));
                }
            }
            "face" | "tristrips" => {
                let list = element.property(&["vertex_indices", "vertex_index"], true)?;
                is_wanted[list] = true;
                let mut others = element.properties.iter().zip(&is_wanted);
                if let Some((other, _)) =
                    others.find(|(p, is_wanted)| p.length.is_some() && p.of.is_integer() && !**is_wanted)
                {
                    let what = format!("a list of integers of a face ({})", text::quoted(&other.name));
                    return Err(Fault::unsupported(other.line, what));
                }
                let is_strip = element.name == "tristrips";
                for row in 0..element.rows {
                    let corners = body.row(element, row, &is_wanted)?;
                    self.faces.push(Face {
                        row,
                        line: body.line(),
                        is_strip,
                        corners,
                    });
                }
            }
            "edge" | "material" | "camera" => {
                self.skipped.add(element.line, &element.name);
                for row in 0..element.rows {
                    body.row(element, row, &is_wanted)?;
                }
                return Ok(());
            }
            other => {
                let what = format!("the element {}", text::quoted(other));
                return Err(Fault::unsupported(element.line, what));
            }
        }
        for (property, _) in element
            .properties
            .iter()
            .zip(is_wanted)
            .filter(|(_, is_wanted)| !is_wanted)
        {
            let what = match property.name.as_str() {
                "nx" | "ny" | "nz" => "normals",
                "red" | "green" | "blue" | "alpha" | "diffuse_red" | "diffuse_green" | "diffuse_blue" => "colors",
                "s" | "t" | "u" | "v" | "texcoord" | "texture_u" | "texture_v" => "texture coordinates",
                _ => "other properties",
            };
            self.skipped.add(property.line, what);
        }
        Ok(())
    }

    fn build(mut self) -> Result<MeshFile, Fault> {
        let object = if self.faces.is_empty() {
            MeshObject::of_points(String::new(), std::mem::take(&mut self.points))
        } else {
            let mut object = ObjectBuilder::default();
            for face in std::mem::take(&mut self.faces) {
                let added = self.face(&face, &mut object);
                let name = if face.is_strip { "tristrips" } else { "face" };
                added.map_err(|why| Fault::malformed(face.line, format!("{name} {} {why}", face.row)))?;
            }
            object.build()
        };
        Ok(MeshFile {
            format: MeshFormat::Ply,
            objects: vec![object],
            skipped: self.skipped.build(),
        })
    }

    /// Adds the triangles of a face or of strips.
    fn face(&mut self, face: &Face, object: &mut ObjectBuilder) -> Result<(), String> {
        if !face.is_strip {
            let ring = self.vertices(&face.corners)?;
            return self.polygon(&ring, face.line, object);
        }
        // The number -1 ends a strip.
        for strip in face.corners.split(|&corner| corner == -1.0).filter(|s| !s.is_empty()) {
            let strip = self.vertices(strip)?;
            if strip.len() < 3 {
                let why = "(expected at least 3)";
                return Err(format!("has a strip of {} corners {why}", strip.len()));
            }
            for k in 0..strip.len() - 2 {
                let (a, b, c) = (strip[k], strip[k + 1], strip[k + 2]);
                // A corner that is there twice joins two strips.
                if a != b && b != c && c != a {
                    let corners = if k % 2 == 0 { [a, b, c] } else { [b, a, c] };
                    self.polygon(&corners, face.line, object)?;
                }
            }
        }
        Ok(())
    }

    /// Returns the numbers of the vertices of a list.
    fn vertices(&self, corners: &[f64]) -> Result<Vec<u64>, String> {
        let count = self.points.len();
        let vertex = |&corner: &f64| {
            if !(corner >= 0.0 && corner < count as f64 && corner.fract() == 0.0) {
                let why = format!("(expected 0 to less than {count})");
                return Err(format!("has an invalid vertex: {corner:?} {why}"));
            }
            if self.points[corner as usize].iter().any(|x| !x.is_finite()) {
                return Err(format!("has a vertex that is not finite: {corner}"));
            }
            Ok(corner as u64)
        };
        corners.iter().map(vertex).collect()
    }

    fn polygon(&mut self, ring: &[u64], line: Option<usize>, object: &mut ObjectBuilder) -> Result<(), String> {
        if ring.len() < 3 {
            return Err(format!("has {} corners (expected at least 3)", ring.len()));
        }
        let point = |k: u64| self.points[k as usize];
        let skipped = &mut self.skipped;
        let triangles = polygon::triangulate(&[ring], point, |what| skipped.add(line, what));
        let triangles = triangles.map_err(|why| format!("is invalid: {why}"))?;
        for triangle in triangles {
            let added = object.triangle(triangle, point);
            added.ok_or("has too many points for 32-bit indices")?;
        }
        Ok(())
    }
}

//! Wavefront OBJ: vertices and faces. Objects begin at lines `o`; groups do not split them. Without
//! faces, the vertices behind a line `o` are its points.
//!
//! Lines, points, curves, normals and materials are no part of a body and are skipped. Free-form
//! surfaces, calls and unknown words are errors, because they may be geometry.

use crate::error::Fault;
use crate::mesh::{MeshFile, MeshFormat, MeshObject, ObjectBuilder, SkippedList};
use crate::{polygon, text};

/// Words that are no part of a body.
const PASSED_OVER: [&str; 34] = [
    "l",
    "p",
    "vt",
    "vn",
    "vp",
    "g",
    "s",
    "mg",
    "usemtl",
    "mtllib",
    "lod",
    "bevel",
    "c_interp",
    "d_interp",
    "shadow_obj",
    "trace_obj",
    "usemap",
    "maplib",
    "ctech",
    "stech",
    "curv",
    "curv2",
    "cstype",
    "deg",
    "bmat",
    "step",
    "parm",
    "trim",
    "hole",
    "scrv",
    "sp",
    "end",
    "con",
    "cdc",
];

/// Reads an OBJ.
pub(crate) fn read(bytes: &[u8]) -> Result<MeshFile, Fault> {
    let text = text::decode(bytes);
    let mut points: Vec<[f64; 3]> = Vec::new();
    // A face may use vertices of later lines, so faces wait.
    let mut faces: Vec<(usize, usize, Vec<i64>)> = Vec::new();
    // The name of each object, and how many vertices are before it.
    let mut names = vec![(String::new(), 0)];
    let mut skipped = SkippedList::default();
    for (line, joined) in joined_lines(&text) {
        let mut words = joined.split_whitespace();
        let Some(word) = words.next() else {
            continue;
        };
        let word_lower = word.to_ascii_lowercase();
        if !matches!(word_lower.as_str(), "v" | "f" | "fo") && joined.lines().skip(1).any(begins_geometry) {
            let word = text::quoted(word);
            let why = format!("line {word} continues with a vertex, a face or a surface after its backslash");
            return Err(Fault::malformed(line, why));
        }
        match word_lower.as_str() {
            "v" => points.push(vertex(line, words)?),
            "f" | "fo" => {
                let corners: Result<Vec<i64>, Fault> = words.map(|word| corner(line, word, points.len())).collect();
                faces.push((line, names.len() - 1, corners?));
            }
            "o" => names.push((words.collect::<Vec<_>>().join(" "), points.len())),
            known if PASSED_OVER.contains(&known) => skipped.add(line, known),
            known @ ("surf" | "bzp" | "bsp" | "cdp") => {
                return Err(Fault::unsupported(line, format!("a free-form surface ({known})")));
            }
            "call" | "csh" => return Err(Fault::unsupported(line, format!("the command {word}"))),
            _ => return Err(Fault::malformed(line, format!("unknown word: {}", text::quoted(word)))),
        }
    }
    let mut objects = Vec::new();
    if faces.is_empty() {
        for (name, start) in names.into_iter().rev() {
            objects.push(MeshObject::of_points(name, points.split_off(start)));
        }
        objects.reverse();
    } else {
        let mut builders: Vec<ObjectBuilder> = names.into_iter().map(|(name, _)| ObjectBuilder::new(name)).collect();
        for (line, object, corners) in faces {
            face(line, &corners, &points, &mut builders[object], &mut skipped)?;
        }
        objects.extend(builders.into_iter().map(ObjectBuilder::build));
    }
    Ok(MeshFile {
        format: MeshFormat::Obj,
        objects,
        skipped: skipped.build(),
    })
}

/// Returns whether a line begins with a word of geometry. Such a line behind a name that ends with
/// a backslash (`usemtl C:\`) is a part of the name by the format, but was not meant to be.
fn begins_geometry(line: &str) -> bool {
    let word = line.split_whitespace().next().unwrap_or("").to_ascii_lowercase();
    ["v", "f", "fo", "surf", "bzp", "bsp", "cdp", "call", "csh"].contains(&word.as_str())
}

/// Returns the lines without comments; a backslash at the end of a line joins the next line, with a
/// line feed between the two. A joined line has the number of its first line.
fn joined_lines(text: &str) -> impl Iterator<Item = (usize, String)> {
    let mut lines = text::lines(text);
    std::iter::from_fn(move || {
        let (number, first) = lines.next()?;
        let mut joined = String::new();
        let mut part = first;
        loop {
            let code = part.split('#').next().unwrap_or("");
            let is_comment = code.len() < part.len();
            match code.trim_end().strip_suffix('\\').filter(|_| !is_comment) {
                Some(code) => {
                    joined.push_str(code);
                    joined.push('\n');
                }
                None => {
                    joined.push_str(code);
                    return Some((number, joined));
                }
            }
            match lines.next() {
                Some((_, next)) => part = next,
                None => return Some((number, joined)),
            }
        }
    })
}

/// Returns a vertex: three numbers; a weight must be 1, and colours are not used and may be NaN.
fn vertex<'a>(line: usize, words: impl Iterator<Item = &'a str>) -> Result<[f64; 3], Fault> {
    let words: Vec<&str> = words.collect();
    if !(3..=8).contains(&words.len()) {
        let why = format!("vertex has {} numbers (expected 3 to 8)", words.len());
        return Err(Fault::malformed(line, why));
    }
    // Three coordinates and three or four numbers of a colour, or a weight behind the coordinates.
    let has_weight = matches!(words.len(), 4 | 8);
    let number = |(k, word): (usize, &&str)| {
        let is_color = k >= if has_weight { 4 } else { 3 };
        let number = if is_color {
            text::measured(word)
        } else {
            text::number(word)
        };
        let why = || {
            let rule = if is_color { "a number" } else { "a finite number" };
            format!("invalid number of a vertex: {} (expected {rule})", text::quoted(word))
        };
        number.ok_or_else(|| Fault::malformed(line, why()))
    };
    let numbers: Vec<f64> = words.iter().enumerate().map(number).collect::<Result<_, _>>()?;
    if let Some(weight) = numbers.get(3).filter(|weight| has_weight && **weight != 1.0) {
        let why = format!("weight of the vertex is out of range: {weight} (expected 1)");
        return Err(Fault::malformed(line, why));
    }
    Ok([numbers[0], numbers[1], numbers[2]])
}

/// Returns the index of the vertex of a corner, from 0. A negative index counts back from the
/// vertices that were read so far; a positive index may belong to a later line.
fn corner(line: usize, word: &str, read: usize) -> Result<i64, Fault> {
    let first = word.split('/').next().unwrap_or("");
    let why = |what: &str| {
        Fault::malformed(
            line,
            format!(
                "{what} of a face: {} (expected a vertex index from 1)",
                text::quoted(word)
            ),
        )
    };
    let index: i64 = first.parse().map_err(|_| why("invalid corner"))?;
    let is_rest_valid = word
        .split('/')
        .skip(1)
        .all(|part| part.is_empty() || part.parse::<i64>().is_ok());
    if !is_rest_valid || word.split('/').count() > 3 {
        return Err(why("invalid corner"));
    }
    match index {
        1.. => Ok(index - 1),
        0 => Err(why("vertex 0")),
        _ => {
            let at = (read as i64).checked_add(index).filter(|at| *at >= 0);
            at.ok_or_else(|| why("vertex in front of the first one"))
        }
    }
}

/// Adds the triangles of a face to an object.
fn face(
    line: usize,
    corners: &[i64],
    points: &[[f64; 3]],
    object: &mut ObjectBuilder,
    skipped: &mut SkippedList,
) -> Result<(), Fault> {
    let mut ring: Vec<u64> = Vec::with_capacity(corners.len());
    for &corner in corners {
        if corner as usize >= points.len() {
            let why = format!(
                "vertex of a face does not exist: {} (the file has {})",
                corner + 1,
                points.len()
            );
            return Err(Fault::malformed(line, why));
        }
        ring.push(corner as u64);
    }
    if ring.len() < 3 {
        let why = format!("face has {} corners (expected at least 3)", ring.len());
        return Err(Fault::malformed(line, why));
    }
    let point = |k: u64| points[k as usize];
    let triangles = polygon::triangulate(&[&ring], point, |what| skipped.add(line, what));
    let triangles = triangles.map_err(|why| Fault::malformed(line, why))?;
    for triangle in triangles {
        let added = object.triangle(triangle, point);
        added.ok_or_else(|| Fault::malformed(line, "too many points for 32-bit indices"))?;
    }
    Ok(())
}

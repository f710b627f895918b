//! Meshes from files of other programs: OBJ, and STL in binary or text form.
//!
//! The content of a file is not changed: points may repeat, faces may be split, and several objects
//! form one list. A body is then the hull of the points or, for a clean convex mesh, its points and
//! faces.

use crate::{Face, Point, ears};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::{error, fmt, io};

/// Points and faces of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Points in the order in which faces use them. STL has single precision; OBJ has the written
    /// digits.
    pub points: Vec<Point>,
    /// Faces: the polygons of an OBJ file, or the triangles of an STL file with equal vertices
    /// merged.
    pub faces: Vec<Face>,
    /// Number of each point in the file. OBJ: number of its first `v` line, from 1. STL, which does
    /// not number points: order of appearance, from 0.
    pub numbers: Vec<u32>,
}

impl Mesh {
    /// Returns the faces as triangles: polygons are cut along interior diagonals, convex polygons
    /// from their first vertex.
    #[must_use]
    pub fn triangles(&self) -> Vec<[u32; 3]> {
        self.faces.iter().flat_map(|f| ears::cut(&self.points, f)).collect()
    }
}

/// Error of a mesh file.
#[derive(Debug)]
pub struct MeshError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong.
    pub reason: Reason,
}

/// Kind of the error of a mesh file.
#[derive(Debug)]
pub enum Reason {
    /// The file cannot be read.
    Read(io::Error),
    /// The name ends in neither `.obj` nor `.stl`.
    Extension,
    /// The content does not match the file type.
    Malformed(String),
    /// The file has no face.
    Empty,
    /// A coordinate of a point is not finite.
    NotFinite(usize),
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.path.display())?;
        match &self.reason {
            Reason::Read(e) => write!(f, "cannot be read: {e}"),
            Reason::Extension => f.write_str("only .obj and .stl files are read"),
            Reason::Malformed(why) => write!(f, "malformed: {why}"),
            Reason::Empty => f.write_str("holds no face"),
            Reason::NotFinite(i) => write!(f, "point {i} is not finite"),
        }
    }
}

impl error::Error for MeshError {}

/// Reads a mesh; the extension of the name determines the format.
///
/// # Errors
/// Returns an error that names the file and the fault.
pub fn load(path: impl AsRef<Path>) -> Result<Mesh, MeshError> {
    let path = path.as_ref();
    read(path).map_err(|reason| MeshError {
        path: path.to_owned(),
        reason,
    })
}

fn read(path: &Path) -> Result<Mesh, Reason> {
    let ending = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    let parse = match ending.as_deref() {
        Some("obj") => parse_obj,
        Some("stl") => parse_stl,
        _ => return Err(Reason::Extension),
    };
    let mesh = parse(std::fs::read(path).map_err(Reason::Read)?)?;
    if let Some(i) = mesh.points.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        return Err(Reason::NotFinite(i));
    }
    if mesh.faces.is_empty() {
        Err(Reason::Empty)
    } else {
        Ok(mesh)
    }
}

/// Parses the text of an OBJ file.
///
/// Objects, groups, materials and curves are skipped, so that vertices shared by several objects
/// stay one point and names may have any encoding.
fn parse_obj(bytes: Vec<u8>) -> Result<Mesh, Reason> {
    let text = String::from_utf8_lossy(&bytes);
    let lines = joined_lines(text.trim_start_matches('\u{feff}'));
    let lines: Vec<String> = lines.iter().map(|line| tidy_line(line)).collect();
    let known = |l: &&String| {
        l.split(' ')
            .next()
            .is_some_and(|word| ["v", "vn", "vt", "f"].contains(&word))
    };
    let plain: String = lines.iter().filter(known).flat_map(|l| [l.as_str(), "\n"]).collect();
    let no_materials = |_: &Path| Ok(Default::default());
    let read = tobj::load_obj_buf(&mut plain.as_bytes(), &tobj::LoadOptions::default(), no_materials);
    let (models, _) = read.map_err(|e| Reason::Malformed(format!("{}{e}", bad_line(&lines))))?;
    let Some(m) = models.into_iter().next().map(|m| m.mesh) else {
        return Err(Reason::Empty);
    };
    let points = m.positions.as_chunks::<3>().0.to_vec();
    let mut mesh = Mesh {
        numbers: numbers(&plain, &points),
        points,
        faces: Vec::new(),
    };
    let mut rest = &m.indices[..];
    // Without arities all faces are triangles. Faces of one or two vertices are points and edges.
    let triangles = vec![3; if m.face_arities.is_empty() { rest.len() / 3 } else { 0 }];
    for &n in m.face_arities.iter().chain(&triangles) {
        let (face, after) = rest.split_at(n as usize);
        mesh.faces.extend((n > 2).then(|| face.to_vec()));
        rest = after;
    }
    Ok(mesh)
}

/// Returns the lines of an OBJ file at their numbers. Text after a backslash joins the line that it
/// continues, and leaves an empty line.
fn joined_lines(text: &str) -> Vec<String> {
    let (mut lines, mut continued) = (Vec::<String>::new(), None);
    for line in text.lines() {
        let words = line.strip_suffix('\\');
        let (part, here) = (words.unwrap_or(line), lines.len());
        if let Some(first) = continued {
            lines.push(String::new());
            let first: &mut String = &mut lines[first];
            first.push(' ');
            first.push_str(part);
        } else {
            lines.push(part.to_owned());
        }
        continued = words.map(|_| continued.unwrap_or(here));
    }
    lines
}

/// Returns the words of an OBJ line without its comment. A `v` line keeps only its coordinates, as
/// weights and colours may follow.
fn tidy_line(line: &str) -> String {
    let words = line.split('#').next().unwrap_or("").split_whitespace();
    let most = if words.clone().next() == Some("v") {
        4
    } else {
        usize::MAX
    };
    words.take(most).collect::<Vec<_>>().join(" ")
}

/// Returns the number of the first `v` line with the coordinates of each point; 0 if there is none.
fn numbers(text: &str, points: &[Point]) -> Vec<u32> {
    let place = |line: &str| {
        let mut words = line.strip_prefix('v')?.split_whitespace();
        let mut bits = || Some((words.next()?.parse::<f64>().ok()? + 0.0).to_bits());
        Some([bits()?, bits()?, bits()?])
    };
    let vertices = text.lines().map(str::trim_start).filter(|l| l.starts_with("v "));
    let mut first = HashMap::new();
    for (line, number) in vertices.zip(1..) {
        if let Some(p) = place(line) {
            first.entry(p).or_insert(number);
        }
    }
    let of = |p: &Point| first.get(&p.map(|x| (x + 0.0).to_bits())).copied();
    points.iter().map(|p| of(p).unwrap_or(0)).collect()
}

/// Returns `line N: ` for the first line of an OBJ file with unreadable numbers or an index without
/// a point; empty if there is none.
fn bad_line(lines: &[String]) -> String {
    let given = |lines: &[String]| lines.iter().filter(|l| l.starts_with("v ")).count() as i64;
    let all = given(lines);
    let names = |before: i64, w: &str| match w.split('/').next().unwrap_or("").parse::<i64>() {
        Ok(i) => (1..=all).contains(&i) || (-before..0).contains(&i),
        Err(_) => false,
    };
    let is_number = |w: &str| w.parse::<f64>().is_ok();
    let is_corner = |w: &str| w.split('/').all(|i| i.is_empty() || i.parse::<i64>().is_ok());
    let is_bad = |k: usize| {
        let words: Vec<&str> = lines[k].split_whitespace().collect();
        match words.split_first() {
            Some((&"v", place)) => place.len() < 3 || !place.iter().copied().all(is_number),
            Some((&"f", corners)) => {
                let before = given(&lines[..k]);
                corners.len() < 3 || !corners.iter().copied().all(|w| is_corner(w) && names(before, w))
            }
            _ => false,
        }
    };
    let line = (0..lines.len()).find(|&k| is_bad(k));
    line.map_or(String::new(), |k| format!("line {}: ", k + 1))
}

/// Parses an STL file.
///
/// Many programs start binary files with the word `solid` too, so the length decides: 80 bytes of
/// header, a count, and 50 bytes per triangle.
fn parse_stl(mut bytes: Vec<u8>) -> Result<Mesh, Reason> {
    let count = bytes.get(80..84).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    // A few bytes may follow, but no triangle that the count leaves out.
    let holds = |n: u32| (84 + 50 * u64::from(n)..=87 + 50 * u64::from(n)).contains(&(bytes.len() as u64));
    let binary = count.is_some_and(holds) && !is_text(&bytes);
    if binary {
        bytes[..80].fill(0); // so that the reader does not treat it as text
    } else {
        bytes = tidy_text(&bytes)?;
    }
    let read = stl_io::read_stl(&mut io::Cursor::new(bytes)).map_err(|e| Reason::Malformed(e.to_string()))?;
    let points: Vec<Point> = read.vertices.iter().map(|v| v.0.map(f64::from)).collect();
    let faces = read
        .faces
        .iter()
        .map(|f| f.vertices.map(|i| i as u32).to_vec())
        .collect();
    let numbers = (0..points.len() as u32).collect();
    Ok(Mesh { points, faces, numbers })
}

/// Returns whether a file is text: it starts with `solid` and has no zero byte near its start,
/// unlike binary files.
fn is_text(bytes: &[u8]) -> bool {
    let start = bytes.trim_ascii_start();
    let word = start.get(..5).is_some_and(|w| w.eq_ignore_ascii_case(b"solid"));
    word && !bytes[..bytes.len().min(512)].contains(&0)
}

/// Converts text to the form that the reader expects: lower case, `solid` and a space at the start,
/// one solid. Several solids are joined.
fn tidy_text(bytes: &[u8]) -> Result<Vec<u8>, Reason> {
    let bad = |why: &str| Err(Reason::Malformed(why.into()));
    if !is_text(bytes) {
        return bad("neither text that begins with `solid` nor a binary of the right length");
    }
    let text = String::from_utf8_lossy(bytes).to_ascii_lowercase();
    let is_end = |l: &str| l.trim_start().starts_with("endsolid");
    let is_border = |l: &&str| is_end(l) || l.split_whitespace().next() == Some("solid");
    let facets: Vec<&str> = text.lines().filter(|l| !is_border(l)).collect();
    // A truncated file has no end: the reader reports what is missing.
    let end = if text.lines().any(is_end) { "endsolid" } else { "" };
    Ok(format!("solid \n{}\n{end}\n", facets.join("\n")).into_bytes())
}

#[cfg(test)]
#[path = "meshes_tests.rs"]
mod tests;

//! STL, text and binary. A text may hold several solids; each becomes an object.
//!
//! A file is binary if and only if its length is the length that its count of triangles needs, up
//! to three blanks, line ends or zero bytes at its end. The word `solid` in a binary header changes
//! nothing. Points with equal coordinates become one point of the object.

use std::collections::HashMap;

use crate::error::Fault;
use crate::mesh::{MeshFile, MeshFormat, MeshObject, ObjectBuilder, SkippedList};
use crate::text;

/// Bytes of the header and the count of a binary file, and of each triangle.
const HEADER: usize = 84;
const RECORD: usize = 50;

/// Most bytes that may follow the triangles of a binary file.
const TRAILING: usize = 3;

/// Returns the number of triangles that a binary file states; `None` if the file is too short.
fn count(bytes: &[u8]) -> Option<u64> {
    let field = bytes.get(80..HEADER)?;
    Some(u64::from(u32::from_le_bytes(field.try_into().ok()?)))
}

/// Returns whether a file has the length of a binary STL.
pub(crate) fn is_binary(bytes: &[u8]) -> bool {
    let Some(length) = count(bytes).map(|n| HEADER as u64 + RECORD as u64 * n) else {
        return false;
    };
    let Ok(length) = usize::try_from(length) else {
        return false;
    };
    let rest = bytes.get(length..);
    rest.is_some_and(|rest| rest.len() <= TRAILING && rest.iter().all(|b| b" \r\n\t\0".contains(b)))
}

/// Reads an STL.
pub(crate) fn read(bytes: &[u8]) -> Result<MeshFile, Fault> {
    if is_binary(bytes) {
        return binary(bytes);
    }
    let text = text::decode(bytes);
    let begins = text.trim_start().get(..5);
    if !begins.is_some_and(|word| word.eq_ignore_ascii_case("solid")) {
        let size = bytes.len();
        let why = match count(bytes) {
            Some(n) => {
                let needs = HEADER as u64 + RECORD as u64 * n;
                format!("the binary STL states {n} triangles, which need {needs} bytes, but has {size} bytes")
            }
            None => format!("the file is too short for a binary STL ({size} bytes) and does not begin with `solid`"),
        };
        return Err(Fault::malformed(None, why));
    }
    ascii(&text)
}

/// Collects triangles by the coordinates of their corners.
#[derive(Default)]
struct Solid {
    builder: ObjectBuilder,
    points: Vec<[f64; 3]>,
    known: HashMap<[u64; 3], u64>,
}

impl Solid {
    fn new(name: &str) -> Self {
        let builder = ObjectBuilder::new(name);
        Self {
            builder,
            ..Self::default()
        }
    }

    fn triangle(&mut self, line: Option<usize>, corners: [[f64; 3]; 3]) -> Result<(), Fault> {
        let indices = corners.map(|point| {
            // Zeros of both signs are one coordinate.
            let key = point.map(|x| (x + 0.0).to_bits());
            *self.known.entry(key).or_insert_with(|| {
                self.points.push(point);
                self.points.len() as u64 - 1
            })
        });
        let points = &self.points;
        self.builder
            .triangle(indices, |k| points[k as usize])
            .ok_or_else(|| Fault::malformed(line, "too many points for 32-bit indices"))
    }

    fn build(self) -> MeshObject {
        self.builder.build()
    }
}

fn binary(bytes: &[u8]) -> Result<MeshFile, Fault> {
    let mut solid = Solid::default();
    let records = bytes[HEADER..].as_chunks::<RECORD>().0;
    for (k, record) in records.iter().enumerate() {
        // Twelve bytes are the normal, which a triangle has anyway; two at the end are free.
        let numbers = record[12..48].as_chunks::<4>().0;
        let number = |i: usize| f64::from(f32::from_le_bytes(numbers[i]));
        let corners = [0, 3, 6].map(|i| [number(i), number(i + 1), number(i + 2)]);
        if corners.iter().flatten().any(|x| !x.is_finite()) {
            let why = format!("triangle {k} has a coordinate that is not finite");
            return Err(Fault::malformed(None, why));
        }
        solid.triangle(None, corners)?;
    }
    let mut skipped = SkippedList::default();
    skipped.add(None, "normals");
    Ok(MeshFile {
        format: MeshFormat::Stl,
        objects: vec![solid.build()],
        skipped: skipped.build(),
    })
}

/// The words of a text with their lines.
struct Words<'a> {
    /// The lines that are left.
    lines: std::iter::Peekable<Box<dyn Iterator<Item = (usize, &'a str)> + 'a>>,
    /// The words of the current line that are left.
    words: Vec<&'a str>,
    line: usize,
}

impl<'a> Words<'a> {
    fn new(text: &'a str) -> Self {
        let lines: Box<dyn Iterator<Item = (usize, &'a str)> + 'a> = Box::new(text::lines(text));
        Self {
            lines: lines.peekable(),
            words: Vec::new(),
            line: 1,
        }
    }

    fn next(&mut self) -> Option<&'a str> {
        while self.words.is_empty() {
            let (line, text) = self.lines.next()?;
            self.line = line;
            self.words = text.split_whitespace().rev().collect();
        }
        self.words.pop()
    }

    /// Returns the rest of the line as a name.
    fn rest_of_line(&mut self) -> String {
        self.words.reverse();
        let name = self.words.join(" ");
        self.words.clear();
        name
    }

    fn fault(&self, why: impl Into<String>) -> Fault {
        Fault::malformed(self.line, why)
    }

    fn unknown(&self, word: &str, expected: &str) -> Fault {
        self.fault(format!("unknown word: {} (expected {expected})", text::quoted(word)))
    }

    /// Takes one of the given words, in any case.
    fn expect(&mut self, keyword: &str) -> Result<(), Fault> {
        match self.next() {
            Some(word) if word.eq_ignore_ascii_case(keyword) => Ok(()),
            Some(word) => Err(self.unknown(word, &format!("{keyword:?}"))),
            None => Err(self.fault(format!("the file ends before {keyword:?}"))),
        }
    }

    fn point(&mut self) -> Result<[f64; 3], Fault> {
        self.expect("vertex")?;
        let mut point = [0.0; 3];
        for coordinate in &mut point {
            let word = self.next().unwrap_or("the end of the file");
            let fault = || {
                let word = text::quoted(word);
                self.fault(format!(
                    "invalid coordinate of a vertex: {word} (expected a finite number)"
                ))
            };
            *coordinate = text::number(word).ok_or_else(fault)?;
        }
        Ok(point)
    }
}

fn ascii(text: &str) -> Result<MeshFile, Fault> {
    let mut words = Words::new(text);
    let (mut objects, mut skipped) = (Vec::new(), SkippedList::default());
    while let Some(word) = words.next() {
        if !word.eq_ignore_ascii_case("solid") {
            return Err(words.unknown(word, "\"solid\" or the end of the file"));
        }
        // A solid on one line has its facets behind the name.
        let name = name_before_facets(&mut words);
        let mut solid = Solid::new(&name);
        loop {
            match words.next() {
                None => {
                    skipped.add(words.line, "missing endsolid");
                    break;
                }
                Some(word) if word.eq_ignore_ascii_case("endsolid") => {
                    name_before_facets(&mut words);
                    if !words.words.is_empty() {
                        return Err(words.fault("a facet follows \"endsolid\" on the same line"));
                    }
                    break;
                }
                Some(word) if word.eq_ignore_ascii_case("facet") => {
                    skipped.add(words.line, "normals");
                    let line = words.line;
                    let corners = facet(&mut words)?;
                    solid.triangle(Some(line), corners)?;
                }
                Some(word) => return Err(words.unknown(word, "\"facet\" or \"endsolid\"")),
            }
        }
        objects.push(solid.build());
    }
    Ok(MeshFile {
        format: MeshFormat::Stl,
        objects,
        skipped: skipped.build(),
    })
}

/// Takes the name of a solid: the rest of the line, or the text in front of the first `facet`
/// followed by `normal`, three words and `outer` on the same line.
fn name_before_facets(words: &mut Words<'_>) -> String {
    let line: Vec<&str> = words.words.iter().rev().copied().collect();
    let is = |k: usize, word: &str| line.get(k).is_some_and(|w| w.eq_ignore_ascii_case(word));
    let begin = (0..line.len()).find(|&k| is(k, "facet") && is(k + 1, "normal") && is(k + 5, "outer"));
    match begin {
        Some(k) => {
            words.words.truncate(line.len() - k);
            line[..k].join(" ")
        }
        None => words.rest_of_line(),
    }
}

/// Takes a facet behind its first word.
fn facet(words: &mut Words<'_>) -> Result<[[f64; 3]; 3], Fault> {
    words.expect("normal")?;
    for _ in 0..3 {
        words
            .next()
            .ok_or_else(|| words.fault("the file ends within a normal"))?;
    }
    words.expect("outer")?;
    words.expect("loop")?;
    let corners = [words.point()?, words.point()?, words.point()?];
    words.expect("endloop")?;
    words.expect("endfacet")?;
    Ok(corners)
}

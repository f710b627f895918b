//! Measures of meshes, encodings, and mutants of files.
//!
//! `errors`, `mutants` and `rows` are files of the package `truth`, which is built on this one and on engines
//! that these tests do not need.
#![allow(dead_code, unreachable_pub)] // each test uses a part

#[path = "../../../../lab/truth/src/errors.rs"]
pub mod errors;
#[path = "../../../../lab/truth/src/mutants.rs"]
pub mod mutants;
#[path = "../../../../tests/support/rng.rs"]
pub mod rng;
#[path = "../../../../lab/truth/src/rows.rs"]
pub mod rows;

use lin_canny_formats::{FormatError, MeshFile};

/// A box at the origin with corners numbered x slowest, z fastest, and its twelve triangles.
pub(crate) const BOX: [[f64; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [0.0, 0.0, 0.6],
    [0.0, 0.4, 0.0],
    [0.0, 0.4, 0.6],
    [0.2, 0.0, 0.0],
    [0.2, 0.0, 0.6],
    [0.2, 0.4, 0.0],
    [0.2, 0.4, 0.6],
];
pub(crate) const TRIANGLES: [[usize; 3]; 12] = [
    [0, 1, 3],
    [0, 3, 2],
    [4, 6, 7],
    [4, 7, 5],
    [0, 4, 5],
    [0, 5, 1],
    [2, 3, 7],
    [2, 7, 6],
    [0, 2, 6],
    [0, 6, 4],
    [1, 5, 7],
    [1, 7, 3],
];

pub(crate) fn parse(bytes: impl AsRef<[u8]>, name: &str) -> Result<MeshFile, FormatError> {
    MeshFile::parse(bytes.as_ref(), name)
}

/// Returns the signed volume of a closed mesh; for an open mesh a number that depends on the origin.
pub(crate) fn volume(file: &MeshFile) -> f64 {
    let (points, triangles) = file.whole();
    let det = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|k| points[k as usize]);
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    triangles.iter().map(det).sum::<f64>() / 6.0
}

/// Returns the area of all triangles.
pub(crate) fn area(file: &MeshFile) -> f64 {
    let (points, triangles) = file.whole();
    let area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|k| points[k as usize]);
        let (u, v) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| c[k] - a[k]));
        let cross = [0, 1, 2].map(|k| u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]);
        cross.iter().map(|x| x * x).sum::<f64>().sqrt() / 2.0
    };
    triangles.iter().map(area).sum()
}

/// Returns the least and the greatest corner of the box of all points.
pub(crate) fn bounds(file: &MeshFile) -> [[f64; 3]; 2] {
    let (points, _) = file.whole();
    let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for p in points {
        for k in 0..3 {
            bounds[0][k] = bounds[0][k].min(p[k]);
            bounds[1][k] = bounds[1][k].max(p[k]);
        }
    }
    bounds
}

/// The volume and the area of the box.
pub(crate) const VOLUME: f64 = 0.2 * 0.4 * 0.6;
pub(crate) const AREA: f64 = 2.0 * (0.2 * 0.4 + 0.2 * 0.6 + 0.4 * 0.6);

/// Returns a text with each line end, in UTF-8 with and without a mark, and in UTF-16.
pub(crate) fn encodings(text: &str) -> Vec<Vec<u8>> {
    with_ends(text, &["\n", "\r", "\r\n"])
}

/// Returns a text with each of some line ends, in UTF-8 with and without a mark, and in UTF-16.
pub(crate) fn with_ends(text: &str, ends: &[&str]) -> Vec<Vec<u8>> {
    let mut all = Vec::new();
    for end in ends {
        let text = text.replace('\n', end);
        let marked = format!("\u{feff}{text}");
        all.extend([text.into_bytes(), marked.clone().into_bytes()]);
        for unit in [u16::to_le_bytes, u16::to_be_bytes] {
            all.push(marked.encode_utf16().flat_map(unit).collect());
        }
    }
    all
}

/// Reads mutants of a mesh file: each gives a mesh or an error, and no number that is not finite.
pub(crate) fn read_mutants(good: &[u8], name: &str, count: usize) {
    mutants::read(good, &[], count, |bytes| {
        let Ok(file) = parse(bytes, name) else { return false };
        let (points, triangles) = file.whole();
        assert!(points.iter().flatten().all(|x| x.is_finite()));
        assert!(triangles.iter().flatten().all(|&k| (k as usize) < points.len()));
        true
    });
}

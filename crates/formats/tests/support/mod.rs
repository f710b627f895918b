//! Measures of meshes, and mutants of files.
#![allow(dead_code)] // each test uses a part

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

/// A generator of random numbers.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 33) as usize % n.max(1)
    }
}

/// Reads mutants of a mesh file: each gives a mesh or an error, and no number that is not finite.
pub(crate) fn read_mutants(good: &[u8], name: &str, count: usize) {
    mutants(good, count, |bytes| {
        let Ok(file) = parse(bytes, name) else { return false };
        let (points, triangles) = file.whole();
        assert!(points.iter().flatten().all(|x| x.is_finite()));
        assert!(triangles.iter().flatten().all(|&k| (k as usize) < points.len()));
        true
    });
}

/// Calls a function for mutants of a file. It returns whether a mutant was read; some must be, and some not.
pub(crate) fn mutants(good: &[u8], count: usize, mut is_read: impl FnMut(&[u8]) -> bool) {
    let mut rng = Random(88_172_645_463_325_252);
    let mut read = 0;
    for _ in 0..count {
        let mut bytes = good.to_vec();
        for _ in 0..=rng.below(3) {
            let (at, length) = (rng.below(bytes.len()), 1 + rng.below(12));
            let end = (at + length).min(bytes.len());
            match rng.below(6) {
                0 => bytes[at] ^= 1 << rng.below(8),
                1 => drop(bytes.drain(at..end)),
                2 => bytes.truncate(at),
                3 => {
                    let copy = bytes[at..end].to_vec();
                    let to = rng.below(bytes.len());
                    drop(bytes.splice(to..to, copy));
                }
                4 => {
                    let words: [&[u8]; 8] = [b"nan", b"1e400", b"-1", b"4294967295", b"0", b" ", b"\n", b"9e99"];
                    drop(bytes.splice(at..end, words[rng.below(8)].to_vec()));
                }
                _ => bytes[at] = rng.below(256) as u8,
            }
            if bytes.is_empty() {
                break;
            }
        }
        read += usize::from(is_read(&bytes));
    }
    assert!(read > 0 && read < count, "{read} of {count} mutants were read");
}

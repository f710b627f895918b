//! From the caller's points to stored ones: checked, scaled by a power of two, equal points made
//! one.

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Point3, Vector3};

use super::MeshError;
use crate::base::num::extremes::largest;
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{EXPONENT_FREE, EXTENT_MAX, EXTENT_MIN, FLUSH_EXPONENT, PLACE_MAX};
use crate::body::polyhedron::{bounding_box, exponent_of, power_of_two};

/// Most points and triangles: an id of a triangle shares its 32 bits with a mark and a count.
pub(super) const MOST: usize = 1 << 27;

/// The points in stored units, and for each of them the first with the same coordinates.
pub(super) struct Welded {
    pub(super) points: Vec<Vector3<f64>>,
    pub(super) same_as: Vec<u32>,
    pub(super) exponent: i32,
    pub(super) flushed: usize,
}

/// Checks, scales and welds. Points that no triangle uses only have to be finite: the mesh does not
/// depend on them.
pub(super) fn weld(given: &[Point3<f64>], triangles: &[[u32; 3]]) -> Result<Welded, MeshError> {
    if given.len() > MOST {
        return Err(MeshError::TooMany { count: given.len() });
    }
    if let Some(index) = given.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        return Err(MeshError::NotFinite { index });
    }
    let mut is_used = vec![false; given.len()];
    triangles.iter().flatten().for_each(|&v| is_used[v as usize] = true);
    let used = || given.iter().zip(&is_used).filter(|p| *p.1).map(|p| &p.0.coords);
    let (low, high) = bounding_box(used());
    let sides = high - low;
    let extent = if triangles.is_empty() { 0.0 } else { largest(&sides) };
    let far = used().any(|p| p.amax() > PLACE_MAX);
    if far || !triangles.is_empty() && !(EXTENT_MIN..=EXTENT_MAX).contains(&extent) {
        return Err(MeshError::OutOfRange { extent });
    }
    let units = Units::of(&sides);
    let scale = power_of_two(-units.exponent);
    let mut flushed = 0;
    let points: Vec<Vector3<f64>> = given
        .iter()
        .zip(&is_used)
        .map(|(p, is_used)| {
            (p.coords * scale).map(|x| {
                let kept = units.flushed(x);
                flushed += usize::from(*is_used && kept != x);
                kept
            })
        })
        .collect();
    let same_as = first_equal(&points);
    Ok(Welded {
        points,
        same_as,
        exponent: units.exponent,
        flushed,
    })
}

/// The unit of stored coordinates, and the coordinates that count as zero.
#[derive(Clone, Copy)]
pub(super) struct Units {
    /// Stored lengths times `2^exponent` are the caller's.
    pub(super) exponent: i32,
    flush: f64,
}

impl Units {
    /// Returns the units of a mesh by the sides of its bounding box.
    pub(super) fn of(sides: &Vector3<f64>) -> Self {
        let size = exponent_of(sqrt((sides * 0.5).norm_squared()));
        let window = 2 * EXPONENT_FREE;
        let exponent = (size + EXPONENT_FREE).div_euclid(window) * window;
        Self {
            exponent,
            flush: power_of_two(size - exponent - FLUSH_EXPONENT),
        }
    }

    /// Returns a stored coordinate, or zero in the place of one that is too small.
    pub(super) fn flushed(&self, x: f64) -> f64 {
        if x.abs() < self.flush { 0.0 } else { x }
    }
}

/// For each point the first with the same coordinates. Points are sorted by a mix of their bits, so
/// that long runs of equal first coordinates cost nothing; among equal mixes the coordinates
/// decide.
fn first_equal(points: &[Vector3<f64>]) -> Vec<u32> {
    let mut keys: Vec<(u64, u32)> = points.iter().map(mix).zip(0..).collect();
    keys.sort_unstable();
    let mut same_as: Vec<u32> = (0..points.len() as u32).collect();
    for run in keys.chunk_by_mut(|a, b| a.0 == b.0).filter(|run| run.len() > 1) {
        run.sort_unstable_by(|a, b| order(&points[a.1 as usize], &points[b.1 as usize]).then(a.1.cmp(&b.1)));
        for equal in run.chunk_by(|a, b| points[a.1 as usize] == points[b.1 as usize]) {
            equal.iter().for_each(|k| same_as[k.1 as usize] = equal[0].1);
        }
    }
    same_as
}

fn order(a: &Vector3<f64>, b: &Vector3<f64>) -> core::cmp::Ordering {
    a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z))
}

/// Returns a number that is equal for equal points; no coordinate is a negative zero.
fn mix(p: &Vector3<f64>) -> u64 {
    p.iter().fold(0, |h, x| stir(h ^ x.to_bits()))
}

/// One round of multiply and shift, a bijection.
pub(super) fn stir(x: u64) -> u64 {
    let x = (x ^ x >> 32).wrapping_mul(0xd6e8_feb8_6659_fd93);
    (x ^ x >> 29).wrapping_mul(0xff51_afd7_ed55_8ccd)
}

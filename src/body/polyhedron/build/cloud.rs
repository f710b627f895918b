//! From the caller's points to stored coordinates: checked, shifted, scaled, sorted and without
//! duplicates.

use alloc::vec::Vec;
use nalgebra::{Point3, Vector3};

use crate::base::num::double_double::two_sum;
use crate::base::num::extremes::{Extremes, largest};
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{EXPONENT_FREE, EXTENT_MAX, EXTENT_MIN, FLUSH_EXPONENT, PLACE_MAX};
use crate::body::polyhedron::build::error::BuildError;

/// Largest number of points accepted: a body of n vertices has fewer than 6 n half-edges, each with
/// a 32-bit number.
const POINTS_MAX: usize = 1 << 29;

/// Distinct points in stored coordinates, in Morton order: points adjacent in space are adjacent in
/// memory.
pub(crate) struct Cloud {
    pub(crate) points: Vec<Vector3<f64>>,
    /// The caller's index of each point, the lowest among equal points.
    pub(crate) source: Vec<u32>,
    /// Equal points as the caller's indices `(dropped, kept)`.
    pub(crate) duplicates: Vec<(u32, u32)>,
    pub(crate) origin: Vector3<f64>,
    pub(crate) exponent: i32,
    pub(crate) flushed: usize,
    /// Number of points given, used or not.
    pub(crate) given: usize,
}

/// Returns `2^k` for `|k| < 1022`.
pub(crate) fn power_of_two(k: i32) -> f64 {
    f64::from_bits(((1023 + k.clamp(-1022, 1022)) as u64) << 52)
}

/// Returns the `k` with `2^k <= x < 2^(k+1)` of a normal positive number.
pub(crate) fn exponent_of(x: f64) -> i32 {
    ((x.to_bits() >> 52) & 0x7ff) as i32 - 1023
}

/// Returns odd `m` and `e` with `x = m 2^e`, for a finite number that is not zero.
#[cfg(feature = "exact")]
pub(crate) fn odd_part(x: f64) -> (i64, i32) {
    let bits = x.to_bits();
    let (field, fraction) = (((bits >> 52) & 0x7ff) as i32, (bits & ((1 << 52) - 1)) as i64);
    let (m, e) = if field == 0 {
        (fraction, -1074)
    } else {
        (fraction | 1 << 52, field - 1075)
    };
    let zeros = m.trailing_zeros();
    let m = m >> zeros;
    (if x < 0.0 { -m } else { m }, e + zeros as i32)
}

/// Returns the exponent of the lowest bit set in any of the numbers, if any is not zero.
#[cfg(feature = "exact")]
pub(crate) fn lowest_bit(numbers: impl IntoIterator<Item = f64>) -> Option<i32> {
    numbers.into_iter().filter(|&x| x != 0.0).map(|x| odd_part(x).1).min()
}

impl Cloud {
    /// Makes a cloud of the points named by `indices`. The indices must exist; `needed` is the
    /// least count accepted.
    pub(crate) fn new(given: &[Point3<f64>], indices: Vec<u32>, needed: usize) -> Result<Self, BuildError> {
        if given.len() > POINTS_MAX {
            return Err(BuildError::TooMany { count: given.len() });
        }
        if let Some(&index) = indices
            .iter()
            .find(|&&i| !given[i as usize].iter().all(|x| x.is_finite()))
        {
            return Err(BuildError::NotFinite { index: index as usize });
        }
        if indices.len() < needed {
            return Err(BuildError::TooFewPoints {
                count: indices.len(),
                needed,
            });
        }
        let (origin, exponent, flush) = placement(given, &indices)?;
        let mut flushed = 0;
        let mut stored: Vec<Vector3<f64>> = Vec::with_capacity(indices.len());
        for &i in &indices {
            let mut p = stored_place(&given[i as usize], &origin, exponent);
            for x in p.iter_mut() {
                if x.abs() < flush {
                    flushed += (*x != 0.0) as usize;
                    *x = 0.0; // also turns -0 into 0
                }
            }
            stored.push(p);
        }
        let order = morton_order(&stored, &indices);
        let mut cloud = Self {
            points: Vec::with_capacity(order.len()),
            source: Vec::with_capacity(order.len()),
            duplicates: Vec::new(),
            origin,
            exponent,
            flushed,
            given: given.len(),
        };
        for k in order {
            let (point, index) = (stored[k as usize], indices[k as usize]);
            match (cloud.points.last(), cloud.source.last()) {
                (Some(last), Some(&kept)) if *last == point => cloud.duplicates.push((index, kept)),
                _ => {
                    cloud.points.push(point);
                    cloud.source.push(index);
                }
            }
        }
        Ok(cloud)
    }

    /// Returns the stored coordinates of a given point, without flushing.
    pub(crate) fn place(&self, given: &Point3<f64>) -> Vector3<f64> {
        stored_place(given, &self.origin, self.exponent)
    }

    /// Converts a stored point to the caller's coordinates.
    #[cfg(feature = "exact")]
    pub(crate) fn given_place(&self, stored: &Vector3<f64>) -> Vector3<f64> {
        stored * power_of_two(self.exponent) + self.origin
    }

    /// Returns the diagonal of the bounding box, in stored units.
    pub(crate) fn diagonal(&self) -> f64 {
        let (low, high) = bounding_box(&self.points);
        sqrt((high - low).norm_squared())
    }
}

fn stored_place(given: &Point3<f64>, origin: &Vector3<f64>, exponent: i32) -> Vector3<f64> {
    (given.coords - origin) * power_of_two(-exponent)
}

/// Returns the least and greatest corner of the bounding box.
pub(crate) fn bounding_box<'a>(points: impl IntoIterator<Item = &'a Vector3<f64>>) -> (Vector3<f64>, Vector3<f64>) {
    let start = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    points
        .into_iter()
        .fold(start, |(low, high), p| (low.smaller(*p), high.larger(*p)))
}

/// Returns the magnitude below which stored coordinates count as zero, given half the diagonal of
/// the stored box.
pub(crate) fn flush_below(radius: f64) -> f64 {
    power_of_two(exponent_of(radius) - FLUSH_EXPONENT)
}

/// Returns the origin, the exponent and the magnitude below which stored coordinates become zero.
fn placement(given: &[Point3<f64>], indices: &[u32]) -> Result<(Vector3<f64>, i32, f64), BuildError> {
    let all = || indices.iter().map(|&i| &given[i as usize].coords);
    let (low, high) = bounding_box(all());
    let sides = high - low;
    let axis = sides.imax();
    let extent = sides[axis];
    if extent == 0.0 || indices.is_empty() {
        if let Some(&i) = indices.iter().find(|&&i| given[i as usize].coords.amax() > PLACE_MAX) {
            return Err(BuildError::OutOfRange {
                index: i as usize,
                extent: given[i as usize].coords.amax(),
            });
        }
        // A single point becomes the origin, so the position is not rounded, but for magnitudes
        // that count as zero.
        let place = if indices.is_empty() { Vector3::zeros() } else { low };
        let origin = place.map(|x| if x.abs() < f64::MIN_POSITIVE { 0.0 } else { x });
        return Ok((origin, 0, f64::MIN_POSITIVE));
    }
    if !(EXTENT_MIN..=EXTENT_MAX).contains(&extent) {
        let ends = indices.iter().find(|&&i| given[i as usize][axis] == high[axis]);
        return Err(BuildError::OutOfRange {
            index: ends.map_or(0, |&i| i as usize),
            extent,
        });
    }
    // Half the diagonal, not the distance of the farthest point: the diagonal depends on extreme
    // points only, without rounding in between.
    let middle = low * 0.5 + high * 0.5;
    let radius = sqrt((sides * 0.5).norm_squared());
    // The shift is exact by Sterbenz' lemma; the check costs nothing and covers the rounding of
    // `middle`.
    let origin = Vector3::from_fn(|k, _| {
        let shifts = middle[k].abs() > 2.0 * radius && all().all(|p| two_sum(p[k], -middle[k]).1 == 0.0);
        if shifts { middle[k] } else { 0.0 }
    });
    let size = exponent_of(radius);
    // The nearest multiple of the window, so that bodies of like size share a stored unit whatever
    // the caller's unit.
    let window = 2 * EXPONENT_FREE;
    let exponent = (size + EXPONENT_FREE).div_euclid(window) * window;
    Ok((origin, exponent, flush_below(radius * power_of_two(-exponent))))
}

/// Returns the order of `points` along the Morton curve of their bounding box, equal points by
/// index.
fn morton_order(points: &[Vector3<f64>], indices: &[u32]) -> Vec<u32> {
    let (low, high) = bounding_box(points);
    let extent = if points.is_empty() { 0.0 } else { largest(&(high - low)) };
    let scale = if extent > 0.0 {
        power_of_two(20 - exponent_of(extent))
    } else {
        0.0
    };
    let mut keys: Vec<(u64, u32)> = points
        .iter()
        .enumerate()
        .map(|(i, p)| {
            let cell = (p - low) * scale; // below 2^21
            (
                spread(cell.x as u64) << 2 | spread(cell.y as u64) << 1 | spread(cell.z as u64),
                i as u32,
            )
        })
        .collect();
    keys.sort_unstable();
    for run in keys.chunk_by_mut(|a, b| a.0 == b.0).filter(|run| run.len() > 1) {
        run.sort_unstable_by(|a, b| {
            let (p, q) = (&points[a.1 as usize], &points[b.1 as usize]);
            let by_place = p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)).then(p.z.total_cmp(&q.z));
            by_place.then(indices[a.1 as usize].cmp(&indices[b.1 as usize]))
        });
    }
    keys.into_iter().map(|k| k.1).collect()
}

/// Inserts two zero bits before each of the low 21 bits.
fn spread(x: u64) -> u64 {
    let x = x & 0x1f_ffff;
    let x = (x | x << 32) & 0x1f_0000_0000_ffff;
    let x = (x | x << 16) & 0x1f_0000_ff00_00ff;
    let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

//! Bodies made of the points of parry's own shapes, each made once.

use std::collections::HashMap;
use std::sync::{Arc, PoisonError, RwLock};

use lin_canny::ConvexPolyhedron;

use super::hull::Hull;
use super::number::wide_point;
use super::parry::math::Vector;

/// Most shapes that are remembered; beyond, all are forgotten and made again.
const MOST: usize = 4096;

/// A table from points to the body they span. Only a memory: what it returns depends on the points
/// alone.
#[derive(Default)]
pub(super) struct Known(RwLock<HashMap<u64, Vec<Entry>>>);

struct Entry {
    points: Box<[Vector]>,
    /// `None` if the points make no body.
    hull: Option<Arc<Hull>>,
}

impl Known {
    /// Returns the body of one point, of the segment of two points, or else the hull.
    pub(super) fn hull(&self, points: &[Vector]) -> Option<Arc<Hull>> {
        let key = key(points);
        let of = |map: &HashMap<u64, Vec<Entry>>| {
            let entry = map.get(&key)?.iter().find(|e| same(&e.points, points))?;
            Some(entry.hull.clone())
        };
        if let Some(found) = of(&self.0.read().unwrap_or_else(PoisonError::into_inner)) {
            return found;
        }
        let hull = made(points).map(Arc::new);
        let mut map = self.0.write().unwrap_or_else(PoisonError::into_inner);
        if map.len() >= MOST {
            map.clear();
        }
        let (points, kept) = (points.into(), hull.clone());
        map.entry(key).or_default().push(Entry { points, hull: kept });
        hull
    }
}

/// Returns whether points are equal bit for bit.
fn same(a: &[Vector], b: &[Vector]) -> bool {
    let bits = |p: &Vector| p.to_array().map(|x| x.to_bits());
    a.len() == b.len() && a.iter().zip(b).all(|(p, q)| bits(p) == bits(q))
}

fn key(points: &[Vector]) -> u64 {
    let mix = |hash: u64, x| (hash.rotate_left(5) ^ f64::from(x).to_bits()).wrapping_mul(0x517c_c1b7_2722_0a95);
    points.iter().flat_map(|p| p.to_array()).fold(0, mix)
}

fn made(points: &[Vector]) -> Option<Hull> {
    let wide: Vec<_> = points.iter().map(|&p| wide_point(p)).collect();
    let body = match wide[..] {
        [p] => ConvexPolyhedron::point(p),
        [p, q] => ConvexPolyhedron::segment(p, q),
        _ => ConvexPolyhedron::from_points(&wide),
    };
    body.ok().map(Hull::new)
}

//! Bodies made of the points of parry's own shapes, each made once.

use std::collections::{HashMap, HashSet};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, PoisonError, RwLock};

use lin_canny::ConvexPolyhedron;

use super::hull::Hull;
use super::number::wide_point;
use super::parry::math::Vector;

/// Shapes that are remembered before any is forgotten.
const LEAST: usize = 4096;

/// Most points that make a key.
const MOST_HASHED: usize = 8;

/// Most keys of forgotten shapes that are kept over a sweep.
const MOST_FORGOTTEN: usize = 16 * LEAST;

/// A table from points to the body they span. Only a memory: what it returns depends on the points
/// alone.
///
/// A body that was asked for since the last sweep survives the next one. A sweep comes when as many
/// bodies as half of its survivors, or [`LEAST`], are new, and a forgotten body that is asked for again
/// puts it off: tens of thousands of shapes in use are soon kept, and few others are.
#[derive(Default)]
pub(super) struct Known(RwLock<Table>);

#[derive(Default)]
struct Table {
    entries: HashMap<u64, Vec<Entry>>,
    count: usize,
    /// Number of entries that survived the last sweep, or were asked for again after it.
    survived: usize,
    /// Keys of bodies that sweeps forgot.
    forgotten: HashSet<u64>,
}

struct Entry {
    points: Box<[Vector]>,
    /// `None` if the points make no body.
    hull: Option<Arc<Hull>>,
    /// Whether the body was asked for since the last sweep.
    is_asked: AtomicBool,
}

impl Known {
    /// Returns the body of one point, of the segment of two points, or else the hull.
    pub(super) fn hull(&self, points: &[Vector]) -> Option<Arc<Hull>> {
        let key = key(points);
        if let Some(found) = self.0.read().unwrap_or_else(PoisonError::into_inner).find(key, points) {
            return found;
        }
        let hull = made(points).map(Arc::new);
        let mut table = self.0.write().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = table.find(key, points) {
            return found;
        }
        table.insert(key, points, hull.clone());
        hull
    }
}

impl Table {
    fn find(&self, key: u64, points: &[Vector]) -> Option<Option<Arc<Hull>>> {
        let entry = self.entries.get(&key)?.iter().find(|e| same(&e.points, points))?;
        // Read first: threads that only read share the cache line.
        if !entry.is_asked.load(Ordering::Relaxed) {
            entry.is_asked.store(true, Ordering::Relaxed);
        }
        Some(entry.hull.clone())
    }

    fn insert(&mut self, key: u64, points: &[Vector], hull: Option<Arc<Hull>>) {
        self.survived += usize::from(self.forgotten.remove(&key));
        if self.count >= self.survived + LEAST.max(self.survived / 2) {
            self.sweep();
        }
        let (points, is_asked) = (points.into(), AtomicBool::new(true));
        self.entries
            .entry(key)
            .or_default()
            .push(Entry { points, hull, is_asked });
        self.count += 1;
    }

    /// Forgets the bodies that were not asked for since the last sweep.
    fn sweep(&mut self) {
        if self.forgotten.len() > MOST_FORGOTTEN {
            self.forgotten.clear();
        }
        self.entries.retain(|key, list| {
            list.retain_mut(|entry| std::mem::take(entry.is_asked.get_mut()));
            if list.is_empty() {
                self.forgotten.insert(*key);
            }
            !list.is_empty()
        });
        self.count = self.entries.values().map(Vec::len).sum();
        self.survived = self.count;
    }
}

/// Returns whether points are equal bit for bit.
fn same(a: &[Vector], b: &[Vector]) -> bool {
    // Without an early end: equal points are the rule, and lanes compare several at once.
    let differ = |p: &Vector, q: &Vector| {
        let ([a, b, c], [x, y, z]) = (p.to_array(), q.to_array());
        (a.to_bits() ^ x.to_bits()) | (b.to_bits() ^ y.to_bits()) | (c.to_bits() ^ z.to_bits())
    };
    a.len() == b.len() && a.iter().zip(b).fold(0, |all, (p, q)| all | differ(p, q)) == 0
}

/// Returns a key of some of the points, as all of them are compared in any case.
fn key(points: &[Vector]) -> u64 {
    let mix = |hash: u64, x: u64| (hash.rotate_left(5) ^ x).wrapping_mul(0x517c_c1b7_2722_0a95);
    let step = points.len().div_ceil(MOST_HASHED).max(1);
    let some = points.iter().step_by(step).flat_map(|p| p.to_array());
    some.map(|x| f64::from(x).to_bits()).fold(points.len() as u64, mix)
}

fn made(points: &[Vector]) -> Option<Hull> {
    let wide: Vec<_> = points.iter().map(|&p| wide_point(p)).collect();
    let body = match wide[..] {
        [p] => ConvexPolyhedron::point(p),
        [p, q] if p == q => ConvexPolyhedron::point(p),
        [p, q] => ConvexPolyhedron::segment(p, q),
        [_, _, _] => ConvexPolyhedron::polygon(&wide),
        _ => ConvexPolyhedron::from_points(&wide),
    };
    body.ok().map(Hull::new)
}

#[cfg(test)]
mod tests {
    use super::super::parry::math::Real;
    use super::*;

    /// Distinct bodies of one point.
    fn asked(known: &Known, of: std::ops::Range<usize>) -> Vec<Arc<Hull>> {
        let point = |k: usize| [Vector::new(k as Real, 1.0, 0.0)];
        of.map(|k| known.hull(&point(k)).expect("a body")).collect()
    }

    /// A scene with more shapes than are remembered at least: soon none of them is made again.
    #[test]
    fn shapes_in_use_are_soon_kept() {
        for count in [LEAST + 1, 5 * LEAST] {
            let known = Known::default();
            (0..2).for_each(|_| drop(asked(&known, 0..count)));
            let first = asked(&known, 0..count);
            for _ in 0..2 {
                let again = asked(&known, 0..count);
                let made = first.iter().zip(&again).filter(|(a, b)| !Arc::ptr_eq(a, b)).count();
                assert_eq!(made, 0, "of {count}");
                // Shapes that are asked for once, now and then.
                asked(&known, 10 * LEAST..10 * LEAST + 10);
            }
        }
    }

    /// Shapes that come and go do not fill the memory, and those in use stay.
    #[test]
    fn shapes_out_of_use_are_forgotten() {
        let known = Known::default();
        let first = asked(&known, 0..100);
        for k in 1..40 {
            asked(&known, k * 1000..(k + 1) * 1000);
            let again = asked(&known, 0..100);
            assert!(first.iter().zip(&again).all(|(a, b)| Arc::ptr_eq(a, b)), "round {k}");
        }
        let count = known.0.read().expect("no panic").count;
        assert!(count <= 3 * LEAST, "{count}");
    }
}

//! Cache of the bodies that are made from parry's shapes.

use std::collections::{HashMap, HashSet};
use std::hash::{BuildHasherDefault, Hasher};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, PoisonError, RwLock};

use lin_canny::ConvexPolyhedron;

use super::hull::Solid;
use super::number::wide_point;
use super::parry::math::Vector;

/// Number of tables: threads that need different bodies seldom use the same table.
const SHARDS: usize = 64;

/// Number of shapes that a table keeps before it removes any.
const LEAST: usize = 64;

/// Maximum number of points that form a key.
const MOST_HASHED: usize = 8;

/// Maximum number of keys of removed shapes that a table keeps after a sweep.
const MOST_FORGOTTEN: usize = 16 * LEAST;

/// A cache from points to their hull, divided into tables by the keys of the points.
///
/// What it returns depends on the points alone. A body that was used since the last sweep of its
/// table survives the next sweep. A sweep happens when the number of new bodies reaches half of the
/// survivors, or [`LEAST`]. If a removed body is used again, the next sweep is later. So tens of
/// thousands of shapes in use are soon kept, and few others.
pub(super) struct Known(Box<[Shard]>);

/// A table in separate cache lines, because each reading thread writes the lock.
#[derive(Default)]
#[repr(align(128))]
struct Shard(RwLock<Table>);

#[derive(Default)]
struct Table {
    entries: HashMap<u64, Vec<Entry>, BuildHasherDefault<Keyed>>,
    count: usize,
    /// Number of entries that survived the last sweep or were used again after it.
    survived: usize,
    /// Keys of bodies that sweeps removed.
    forgotten: HashSet<u64, BuildHasherDefault<Keyed>>,
}

struct Entry {
    points: Box<[Vector]>,
    /// `None` if the points form no body.
    solid: Option<Arc<Solid>>,
    /// Whether the body was used since the last sweep.
    is_asked: AtomicBool,
}

impl Default for Known {
    fn default() -> Self {
        Self((0..SHARDS).map(|_| Shard::default()).collect())
    }
}

impl Known {
    /// Returns the body of the points: a point, a segment, or the hull of three or more points.
    pub(super) fn solid(&self, points: &[Vector]) -> Option<Arc<Solid>> {
        let key = key(points);
        // Hash tables choose their slots by the low bits and the highest seven.
        let table = &self.0[(key >> 48) as usize % SHARDS].0;
        if let Some(found) = table.read().unwrap_or_else(PoisonError::into_inner).find(key, points) {
            return found;
        }
        let solid = made(points).map(Arc::new);
        let mut table = table.write().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = table.find(key, points) {
            return found;
        }
        table.insert(key, points, solid.clone());
        solid
    }
}

impl Table {
    fn find(&self, key: u64, points: &[Vector]) -> Option<Option<Arc<Solid>>> {
        let entry = self.entries.get(&key)?.iter().find(|e| same(&e.points, points))?;
        // Read first: threads that only read share the cache line.
        if !entry.is_asked.load(Ordering::Relaxed) {
            entry.is_asked.store(true, Ordering::Relaxed);
        }
        Some(entry.solid.clone())
    }

    fn insert(&mut self, key: u64, points: &[Vector], solid: Option<Arc<Solid>>) {
        self.survived += usize::from(self.forgotten.remove(&key));
        if self.count >= self.survived + LEAST.max(self.survived / 2) {
            self.sweep();
        }
        let (points, is_asked) = (points.into(), AtomicBool::new(true));
        let entry = Entry {
            points,
            solid,
            is_asked,
        };
        self.entries.entry(key).or_default().push(entry);
        self.count += 1;
    }

    /// Removes the bodies that were not used since the last sweep.
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

/// The hash of a key, which is the key.
#[derive(Default)]
struct Keyed(u64);

impl Hasher for Keyed {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes
            .iter()
            .for_each(|&byte| self.write_u64(self.0.rotate_left(8) ^ u64::from(byte)));
    }

    fn write_u64(&mut self, key: u64) {
        self.0 = key;
    }
}

/// Returns whether points are equal bit for bit.
fn same(a: &[Vector], b: &[Vector]) -> bool {
    // Without an early exit: points are usually equal, and SIMD lanes compare several at once.
    let differ = |p: &Vector, q: &Vector| {
        let ([a, b, c], [x, y, z]) = (p.to_array(), q.to_array());
        (a.to_bits() ^ x.to_bits()) | (b.to_bits() ^ y.to_bits()) | (c.to_bits() ^ z.to_bits())
    };
    a.len() == b.len() && a.iter().zip(b).fold(0, |all, (p, q)| all | differ(p, q)) == 0
}

/// Odd numbers without a pattern: fractions of square roots of primes.
const ODD: [u64; MOST_HASHED] = [
    0x6a09_e667_f3bc_c909,
    0xbb67_ae85_84ca_a73b,
    0x3c6e_f372_fe94_f82b,
    0xa54f_f53a_5f1d_36f1,
    0x510e_527f_ade6_82d1,
    0x9b05_688c_2b3e_6c1f,
    0x1f83_d9ab_fb41_bd6b,
    0x5be0_cd19_137e_2179,
];

/// Returns the product of two numbers, both halves mixed.
fn folded(a: u64, b: u64) -> u64 {
    let product = u128::from(a) * u128::from(b);
    product as u64 ^ (product >> 64) as u64
}

/// Returns a key from some of the points; all points are compared in any case.
fn key(points: &[Vector]) -> u64 {
    let step = points.len().div_ceil(MOST_HASHED).max(1);
    // One product per point; no product depends on another.
    let mixed = points.iter().step_by(step).zip(ODD).map(|(p, odd)| {
        let [x, y, z] = p.to_array().map(|x| u64::from(x.to_bits()));
        folded((x ^ z.rotate_left(32)) ^ odd, y ^ odd.rotate_left(29))
    });
    let count = points.len() as u64;
    folded(mixed.fold(count, u64::wrapping_add), ODD[0])
}

fn made(points: &[Vector]) -> Option<Solid> {
    let wide: Vec<_> = points.iter().map(|&p| wide_point(p)).collect();
    let body = match wide[..] {
        [p] => ConvexPolyhedron::point(p),
        [p, q] if p == q => ConvexPolyhedron::point(p),
        [p, q] => ConvexPolyhedron::segment(p, q),
        [_, _, _] => ConvexPolyhedron::polygon(&wide),
        _ => ConvexPolyhedron::from_points(&wide),
    };
    Some(Solid::new(Arc::new(body.ok()?)))
}

#[cfg(test)]
mod tests {
    use super::super::parry::math::Real;
    use super::*;

    /// Least number of bodies that all tables together keep.
    const MANY: usize = SHARDS * LEAST;

    /// Distinct bodies of one point.
    fn asked(known: &Known, of: std::ops::Range<usize>) -> Vec<Arc<Solid>> {
        let point = |k: usize| [Vector::new(k as Real, 1.0, 0.0)];
        of.map(|k| known.solid(&point(k)).expect("a body")).collect()
    }

    /// A scene with more shapes than the least number: soon none of them is made again.
    #[test]
    fn shapes_in_use_are_soon_kept() {
        for count in [MANY + 1, 5 * MANY] {
            let known = Known::default();
            (0..2).for_each(|_| drop(asked(&known, 0..count)));
            let first = asked(&known, 0..count);
            for _ in 0..2 {
                let again = asked(&known, 0..count);
                let made = first.iter().zip(&again).filter(|(a, b)| !Arc::ptr_eq(a, b)).count();
                assert_eq!(made, 0, "of {count}");
                // Shapes that are used once, now and then.
                asked(&known, 10 * MANY..10 * MANY + 10);
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
        let count: usize = known
            .0
            .iter()
            .map(|shard| shard.0.read().expect("no panic").count)
            .sum();
        assert!(count <= 3 * MANY, "{count}");
    }
}

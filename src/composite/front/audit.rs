//! A check of a tracker's front for debugging: compares every claim of the front with all
//! vertices below the entry's nodes, and checks that the front covers all pairs.

use alloc::collections::BTreeMap;
use alloc::vec::Vec;

use nalgebra::Vector3;

use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::composite::front::{Front, NodePair};
use crate::composite::meet::frame::TreeFrame;
use crate::composite::mesh::Mesh;

/// What is wrong with a front.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum FrontFault {
    /// An entry claims a gap along its direction that some vertices do not have.
    #[error("nodes {} and {} are claimed {claimed} apart and are {gap} apart", pair[0], pair[1])]
    Claim {
        /// A node of A's tree and one of B's.
        pair: [u32; 2],
        /// The gap claimed, in A's stored units.
        claimed: f64,
        /// The gap of all vertices along the entry's direction.
        gap: f64,
    },
    /// A pair of leaves under no entry, or an entry twice or under another.
    #[error("nodes {} and {} are not covered exactly once", pair[0], pair[1])]
    Cover {
        /// A node of A's tree and one of B's.
        pair: [u32; 2],
    },
}

/// Checks a front at the pose of its last test.
pub(in crate::composite) fn audit(front: &Front, a: &Mesh, b: &Mesh, frame: &TreeFrame) -> Result<(), FrontFault> {
    let mut entries = BTreeMap::new();
    let mut fault = None;
    front.gaps(&frame.single, |place, pair, gap| {
        if entries.insert(pair, ()).is_some() {
            fault = Some(FrontFault::Cover { pair });
        }
        let n = Vector3::from(front.normal(&frame.single, place).map(f64::from));
        let claimed = f64::from(gap) * frame.single.unit;
        let gap = true_gap(a, b, frame, pair, &n);
        if claimed > gap {
            fault = Some(FrontFault::Claim { pair, claimed, gap });
        }
    });
    if let Some(fault) = fault {
        return Err(fault);
    }
    covers_once(&entries, a, b)
}

/// Checks that every pair of triangles lies under exactly one entry: no two entries have a pair in
/// common, and together they have all. Which of two boxes is split first is of no matter, as boxes
/// of a mesh that bends change their order of size.
fn covers_once(entries: &BTreeMap<NodePair, ()>, a: &Mesh, b: &Mesh) -> Result<(), FrontFault> {
    let ranges = |&pair: &NodePair| (pair, a.tree.range(pair[0]), b.tree.range(pair[1]));
    let mut all: Vec<_> = entries.keys().map(ranges).collect();
    all.sort_unstable_by_key(|(_, of_a, _)| *of_a);
    let meet = |x: &(u32, u32), y: &(u32, u32)| x.0 < y.1 && y.0 < x.1;
    let mut pairs = 0;
    for (k, (pair, of_a, of_b)) in all.iter().enumerate() {
        pairs += u64::from(of_a.1 - of_a.0) * u64::from(of_b.1 - of_b.0);
        let later = all[k + 1..].iter().take_while(|e| e.1.0 < of_a.1);
        if later.clone().any(|e| meet(&e.1, of_a) && meet(&e.2, of_b)) {
            return Err(FrontFault::Cover { pair: *pair });
        }
    }
    if pairs == a.triangle_count() as u64 * b.triangle_count() as u64 {
        return Ok(());
    }
    let pair = all.first().map_or([0, 0], |e| e.0);
    Err(FrontFault::Cover { pair })
}

/// Returns the gap of all vertices below two nodes along a direction that is nearly unit. A claim
/// with a zero direction claims nothing.
fn true_gap(a: &Mesh, b: &Mesh, frame: &TreeFrame, [x, y]: NodePair, n: &Vector3<f64>) -> f64 {
    let length = sqrt(n.norm_squared());
    if length == 0.0 {
        return 0.0;
    }
    let n = n / length;
    let corners = |mesh: &Mesh, node: u32| {
        let (first, last) = mesh.tree.range(node);
        (first..last).flat_map(|t| mesh.corners(t)).collect::<Vec<_>>()
    };
    let high = corners(a, x)
        .iter()
        .map(|p| n.dot(p))
        .fold(f64::NEG_INFINITY, f64::larger);
    let low = corners(b, y)
        .iter()
        .map(|p| n.dot(&frame.point(p)))
        .fold(f64::INFINITY, f64::smaller);
    low - high
}

#[cfg(test)]
mod tests {
    extern crate std;
    use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};

    use super::*;
    use crate::base::pose::RelativePose;
    use crate::composite::mesh::tracker::MeshTracker;

    /// Returns a torus of `n` times `m` squares about z, its tube `thick` and wavy by `wave`.
    fn torus(n: u32, m: u32, thick: f64, wave: f64) -> Mesh {
        let angle = |k: u32, of: u32| f64::from(k) * core::f64::consts::TAU / f64::from(of);
        let point = |k: u32| {
            let (u, v) = (angle(k / m, n), angle(k % m, m));
            let tube = thick * (1.0 + wave * (7.0 * u).sin() * (3.0 * v).cos());
            let out = 1.0 + tube * v.cos();
            Point3::new(out * u.cos(), out * u.sin(), tube * v.sin())
        };
        let at = |i: u32, j: u32| (i % n) * m + j % m;
        let square = |i: u32, j: u32| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        };
        let squares = (0..n).flat_map(|i| (0..m).map(move |j| (i, j)));
        let triangles: Vec<_> = squares.flat_map(|(i, j)| square(i, j)).collect();
        let points: Vec<_> = (0..n * m).map(point).collect();
        Mesh::new(&points, &triangles).unwrap()
    }

    #[test]
    fn fronts_hold_what_they_claim_and_a_spoiled_one_is_found() {
        let (a, b) = (torus(40, 20, 0.3, 0.0), torus(30, 20, 0.5, 0.2));
        let mut tracker = MeshTracker::default();
        let turn = UnitQuaternion::new(Vector3::new(0.6, 0.0, 0.8) * 0.009);
        let mut q = UnitQuaternion::identity();
        let (mut entries, mut audited, mut spoiled) = (0, 0, 0);
        for k in 0..400 {
            q = UnitQuaternion::new_normalize((turn * q).into_inner());
            let swing = 0.2 * (0.01 * f64::from(k)).sin();
            let place = Vector3::new(3.0 + swing, 0.3, 0.2);
            let pose = RelativePose::from_isometry(&Isometry3::from_parts(place.into(), q)).unwrap();
            let found = tracker.closest(&a, &b, &pose);
            if k % 10 != 9 {
                continue;
            }
            assert_eq!(tracker.audit(&a, &b, &pose), Ok(()), "{k}");
            if tracker.front_len() == 0 {
                // Two triangles that meet prove the class; no front is needed.
                assert!(found.distance <= 0.0, "{k}: no front at {}", found.distance);
                continue;
            }
            audited += 1;
            entries += tracker.front_len();
            let mut worse = tracker.clone();
            worse.spoil(k as usize, 0.5);
            spoiled += u32::from(matches!(worse.audit(&a, &b, &pose), Err(FrontFault::Claim { .. })));
            worse = tracker.clone();
            worse.drop_entry(k as usize);
            assert!(matches!(worse.audit(&a, &b, &pose), Err(FrontFault::Cover { .. })));
        }
        assert!(
            entries > 2000 && audited > 30 && spoiled == audited,
            "{entries} {audited} {spoiled}"
        );
    }
}

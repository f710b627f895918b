//! Whether two solids whose surfaces touch, and do not certainly cross, share inner points.
//!
//! Where surfaces only touch, each stretch of one of them between contacts is inside the other body
//! or outside: points of parts and of the triangles in contact decide. Of bodies that fill the same
//! place no point of a surface is inside; there a point behind the triangle decides, half as far
//! behind as the next triangle of either body.

use nalgebra::Vector3;

use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::tuning::composite::{PARTED, SPREAD, TOUCHES};
use crate::composite::front::NodePair;
use crate::composite::meet::search::Measured;
use crate::composite::meet::state::{Inside, PosedTrees};
use crate::composite::meet::triangle::{self, Triangle};
use crate::composite::mesh::Mesh;
use crate::composite::parts::{Parted, PartsRef};
use crate::composite::tree::Below;
use crate::composite::tree::height::height;

/// Pairs of items at distance zero, up to rounding.
pub(in crate::composite) struct Touching {
    pairs: [NodePair; TOUCHES],
    count: usize,
}

impl Touching {
    pub(in crate::composite) const NONE: Self = Self {
        pairs: [[0; 2]; TOUCHES],
        count: 0,
    };

    pub(in crate::composite) fn push(&mut self, pair: NodePair) {
        if self.count < TOUCHES {
            self.pairs[self.count] = pair;
            self.count += 1;
        }
    }

    fn pairs(&self) -> &[NodePair] {
        &self.pairs[..self.count]
    }
}

/// A mesh and the other one, seen from the frame of the first, in its stored units.
struct Seen<'a, P> {
    own: &'a Mesh,
    other: &'a Mesh,
    /// To the other's frame.
    place: P,
    /// One stored unit in the other's.
    ratio: f64,
    /// By how much a place may be off.
    doubt: f64,
}

impl<P: Fn(&Vector3<f64>) -> Vector3<f64>> Seen<'_, P> {
    /// Returns whether a point is certainly inside the other mesh.
    fn is_held(&self, p: &Vector3<f64>) -> bool {
        self.other.holds(&(self.place)(p), self.doubt * self.ratio) == Some(true)
    }

    /// Returns whether the middle of a triangle, or a point behind it, is certainly inside both
    /// meshes.
    fn is_shared(&self, t: u32) -> bool {
        let middle = self.own.triangle_middle(t);
        self.is_held(&middle)
            || self
                .behind(&self.own.corners(t), &middle)
                .is_some_and(|p| self.is_held(&p))
    }

    /// Returns an inner point behind a triangle, halfway to the next triangle of either mesh.
    fn behind(&self, corners: &Triangle, middle: &Vector3<f64>) -> Option<Vector3<f64>> {
        let normal = triangle::normal(corners);
        let end = middle - normal * (4.0 * self.own.radius / sqrt(normal.norm_squared()));
        let skin = 4.0 * self.doubt;
        let own = self.own.first_crossing(middle, &end, skin)?;
        let place = &self.place;
        let other = self
            .other
            .first_crossing(&place(middle), &place(&end), skin * self.ratio)?;
        let point = middle + (end - middle) * (0.5 * own.smaller(other));
        (self.own.holds(&point, self.doubt) == Some(true)).then_some(point)
    }
}

/// Returns a few triangles from all over a mesh.
fn spread(mesh: &Mesh) -> impl Iterator<Item = u32> {
    let count = mesh.triangles.len();
    (0..count as u32).step_by(count.div_ceil(SPREAD))
}

/// Returns the greatest height of a mesh along a direction, or at most `slack` more.
fn top(mesh: &Mesh, n: &Vector3<f64>, slack: f64) -> f64 {
    let (mut most, mut stack) = (f64::NEG_INFINITY, alloc::vec![0]);
    while let Some(node) = stack.pop() {
        if height(&mesh.tree, node, n) <= most + slack {
            continue;
        }
        match mesh.tree.below(node) {
            Below::Children(c) => stack.extend([c, c + 1]),
            Below::Leaf(first, count) => {
                let corners = (first..first + count).flat_map(|t| mesh.corners(t));
                most = corners.map(|p| n.dot(&p)).fold(most, f64::at_least);
            }
        }
    }
    most + slack
}

impl<A: Parted, B: Parted> PosedTrees<'_, A, B> {
    /// Returns whether two solids certainly share inner points, and the winding numbers taken of
    /// parts. `found`: a contact.
    ///
    /// Where the normal parts the bodies, middles on their own side of the plane of contact are not
    /// looked at: in flush contact none is left.
    pub(in crate::composite) fn shares_inside<F>(&self, touching: &Touching, found: &Measured<F>) -> (bool, u64) {
        if !(self.a.is_solid() && self.b.is_solid()) {
            return (false, 0);
        }
        let (normal, point) = (&found.normal, &found.on_a);
        let (frame, pairs) = (&self.frame, touching.pairs());
        let lift = normal.dot(&frame.translation);
        let down = -frame.direction_in_b(normal);
        let are_parted = |top: f64, low: f64| top + low - lift < PARTED * frame.size;
        let meshes = match (self.a.by_kind(), self.b.by_kind()) {
            (PartsRef::Mesh(a), PartsRef::Mesh(b)) => Some((a, b)),
            _ => None,
        };
        // The boxes of whole bodies may be tilted.
        let slack = 0.25 * PARTED * frame.size;
        let is_parted = are_parted(
            height(self.a.side().tree, 0, normal),
            height(self.b.side().tree, 0, &down),
        ) || meshes.is_some_and(|(a, b)| are_parted(top(a, normal, slack), top(b, &down, slack)));
        let (inside, windings) = match meshes {
            Some(_) if is_parted => (Inside::No, 0),
            _ => self.inside(0.0),
        };
        let Some((a, b)) = meshes.filter(|_| !matches!(inside, Inside::At(..))) else {
            return (matches!(inside, Inside::At(..)), windings);
        };
        let (ratio, doubt) = (a.unit() / b.unit(), 2.0 * frame.error);
        let of_a = Seen {
            own: a,
            other: b,
            place: |p: &Vector3<f64>| self.back(p),
            ratio,
            doubt,
        };
        let of_b = Seen {
            own: b,
            other: a,
            place: |p: &Vector3<f64>| frame.point(p),
            ratio: 1.0 / ratio,
            doubt: doubt * ratio,
        };
        let rise = |p: &Vector3<f64>| normal.dot(&(p - point));
        let is_shared = if is_parted {
            pairs.iter().any(|&[i, j]| {
                let (p, q) = (a.triangle_middle(i), b.triangle_middle(j));
                rise(&frame.point(&q)) < -frame.tie && of_b.is_held(&q) || rise(&p) > frame.tie && of_a.is_held(&p)
            })
        } else {
            pairs.iter().any(|&[i, j]| of_a.is_shared(i) || of_b.is_shared(j))
                || spread(a).any(|i| of_a.is_shared(i))
                || spread(b).any(|j| of_b.is_shared(j))
        };
        (is_shared, windings)
    }
}

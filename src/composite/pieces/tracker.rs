//! The state of a pair of bodies of convex parts, and the queries.

use alloc::collections::BTreeMap;
use nalgebra::{Point3, Unit, Vector3};

use super::pair::{NearParts, PartJudge};
use crate::composite::front::NodePair;
use crate::composite::kept::Kept;
use crate::composite::parts::Parts;
use crate::composite::state::{PosedTrees, TreeAnswer, TreeState};
use crate::composite::work::MeshWork;
use crate::num::count::Counter;
use crate::pair::outcome::{Class, Distance};
use crate::polyhedron::FeaturePair;
use crate::pose::RelativePose;
use crate::tuning::composite::TRACKERS;

/// The closest points of two bodies of convex parts, with proof.
///
/// The distance is the distance of the bodies as sets of points: zero if they share a point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct CompositeOutcome {
    /// The side of contact. A pair with an open mesh is never [`Class::Overlapping`]. Within
    /// `1e-13 L` of contact the class may differ between warm and cold trackers, and between A to B
    /// and B to A.
    pub class: Class,
    /// The distance, between the bounds; zero for bodies that share a point.
    pub distance: f64,
    /// Lower bound of the distance.
    pub lower: f64,
    /// Upper bound of the distance.
    pub upper: f64,
    /// The closest piece or triangle of A and of B, by the caller's order.
    pub pieces: [u32; 2],
    /// The closest features of both. A triangle is a polygon of three vertices.
    pub features: FeaturePair,
    /// The witness on A, in A's frame. If one body is inside the other: a point of the inner body.
    pub point_on_a: Point3<f64>,
    /// The witness on B, in B's frame.
    pub point_on_b: Point3<f64>,
    /// Unit direction from A to B, in A's frame.
    pub normal: Unit<Vector3<f64>>,
}

impl CompositeOutcome {
    /// The outcome of B and A as that of A and B.
    fn swapped(self, a_from_b: &RelativePose) -> Self {
        Self {
            pieces: [self.pieces[1], self.pieces[0]],
            features: self.features.swapped(),
            point_on_a: self.point_on_b,
            point_on_b: self.point_on_a,
            normal: Unit::new_unchecked(-(a_from_b.rotation() * *self.normal)),
            ..self
        }
    }
}

impl From<&CompositeOutcome> for Distance {
    fn from(outcome: &CompositeOutcome) -> Self {
        Self {
            class: outcome.class,
            value: outcome.distance,
            lower: outcome.lower,
            upper: outcome.upper,
        }
    }
}

/// The front of the last answer for one pair of bodies of convex parts, and a
/// [`ShapeTracker`](crate::ShapeTracker) for each pair of parts that came near.
///
/// Either body is a [`Composite`](crate::Composite) or a [`Mesh`](crate::Mesh); a
/// [`MeshTracker`](crate::MeshTracker) is faster for two meshes. A convex body against a mesh is a
/// composite of one piece, which is one leaf with its own support points.
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::polyhedron::solids;
/// use lin_canny::{Composite, CompositeTracker, Mesh, RelativePose, Shape};
///
/// let table = Mesh::from_convex(&solids::cuboid(Vector3::new(1.0, 1.0, 0.1))?)?;
/// let pill = Composite::from(Shape::capsule(0.5, 0.2)?);
/// let mut pair = CompositeTracker::new();
/// let above = Isometry3::translation(0.3, 0.0, 1.0);
/// let above = RelativePose::from_isometry(&above)?;
/// let found = pair.closest(&table, &pill, &above);
/// assert!((found.distance - 0.2).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Owns no body. State changes time, never an answer. Saving a tracker (feature `serde`)
/// keeps its counters alone.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CompositeTracker {
    state: TreeState,
    #[cfg_attr(feature = "serde", serde(skip))]
    near: BTreeMap<NodePair, NearParts>,
}

impl CompositeTracker {
    /// Returns a tracker without a start.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns the work of all queries so far; `measured` counts queries of two parts.
    #[must_use]
    pub fn work(&self) -> MeshWork {
        self.state.kept.work
    }

    pub(in crate::composite) fn kept(&self) -> &Kept {
        &self.state.kept
    }

    pub(in crate::composite) fn count_windings(&mut self, taken: u64) {
        self.state.kept.work.windings.count(taken);
    }

    /// Returns the number of entries of the front that is kept.
    #[must_use]
    pub fn front_len(&self) -> usize {
        self.state.kept.front.len()
    }

    /// Forgets everything that is kept, counters too.
    pub fn reset(&mut self) {
        *self = Self::default();
    }

    /// Returns the closest points with bounds of the distance: for polyhedra apart no wider than
    /// `1e-13 L`, with `L` the sum of both radii about the bodies' own origins and the distance of
    /// the origins; half as much more if pieces have poses of their own. Curved pieces add the
    /// width of their own bounds.
    pub fn closest<A: Parts, B: Parts>(&mut self, a: &A, b: &B, a_from_b: &RelativePose) -> CompositeOutcome {
        if PosedTrees::is_turned(a, b, a_from_b) {
            return self.closest(b, a, &a_from_b.swapped()).swapped(a_from_b);
        }
        self.recognise(a, b);
        self.state.kept.work.queries.count(1);
        let answer = match PosedTrees::new(a, b, a_from_b) {
            Some(posed) => {
                let judge = PartJudge::new(&posed, None, &mut self.near);
                self.state.closest(&posed, judge)
            }
            None => PosedTrees::far(a, b, a_from_b),
        };
        self.forget_some();
        outcome(a, b, &answer)
    }

    /// Returns the distance and its bounds without the witnesses.
    pub fn distance<A: Parts, B: Parts>(&mut self, a: &A, b: &B, a_from_b: &RelativePose) -> Distance {
        Distance::from(&self.closest(a, b, a_from_b))
    }

    /// Returns whether the bodies share a point; touching counts. Exact, with the feature `exact`,
    /// for polyhedra, rounded or not, if no piece has a pose of its own; else ties count as
    /// touching.
    pub fn intersects<A: Parts, B: Parts>(&mut self, a: &A, b: &B, a_from_b: &RelativePose) -> bool {
        self.within(a, b, a_from_b, 0.0)
    }

    /// Returns whether the bodies are at most `d` apart: as exact as
    /// [`intersects`](Self::intersects), with the limits of
    /// [`MeshTracker::within`](crate::MeshTracker::within). False for a negative `d` and NaN.
    pub fn within<A: Parts, B: Parts>(&mut self, a: &A, b: &B, a_from_b: &RelativePose, d: f64) -> bool {
        if !(d >= 0.0) {
            return false;
        }
        if PosedTrees::is_turned(a, b, a_from_b) {
            return self.within(b, a, &a_from_b.swapped(), d);
        }
        self.recognise(a, b);
        self.state.kept.work.queries.count(1);
        let Some(posed) = PosedTrees::new(a, b, a_from_b) else {
            return PosedTrees::far::<()>(a, b, a_from_b).lower <= d;
        };
        let judge = PartJudge::new(&posed, Some(d), &mut self.near);
        let is_within = self.state.within(&posed, judge, d / a.stored_unit());
        self.forget_some();
        is_within
    }

    /// Returns a lower bound of the distance in one pass over the front, without looking for the
    /// closest pair; zero if nothing better is known.
    pub fn lower_bound<A: Parts, B: Parts>(&mut self, a: &A, b: &B, a_from_b: &RelativePose) -> f64 {
        if PosedTrees::is_turned(a, b, a_from_b) {
            return self.lower_bound(b, a, &a_from_b.swapped());
        }
        self.recognise(a, b);
        PosedTrees::new(a, b, a_from_b).map_or(0.0, |posed| self.state.lower_bound(&posed))
    }

    fn recognise<A: Parts, B: Parts>(&mut self, a: &A, b: &B) {
        if self.state.recognise(a, b) {
            self.near.clear();
        }
    }

    fn forget_some(&mut self) {
        if self.near.len() > TRACKERS * self.state.kept.front.len() + 64 {
            self.near.clear();
        }
    }
}

fn outcome<A: Parts, B: Parts>(a: &A, b: &B, answer: &TreeAnswer<FeaturePair>) -> CompositeOutcome {
    let ([i, j], features) = answer.of.unwrap_or(([0, 0], FeaturePair::FIRST));
    CompositeOutcome {
        class: answer.class,
        distance: answer.distance,
        lower: answer.lower,
        upper: answer.upper,
        pieces: [a.number(i), b.number(j)],
        features,
        point_on_a: answer.point_on_a,
        point_on_b: answer.point_on_b,
        normal: answer.normal,
    }
}

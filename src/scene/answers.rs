//! The results of a step: its events, the results by pair and by body, and the results that a table
//! stores by level of detail (nothing, the distance, the whole outcome, or the outcome with contact
//! points).

use crate::base::num::each::Each;
use crate::base::num::sort::sort_by_key;
use crate::body::polyhedron::FeaturePair;
use crate::broad;
use crate::broad::Aabb;
use crate::convex::contact::Manifold;
#[cfg(feature = "meshes")]
use crate::nonconvex::contact::ContactGroup;
use crate::pair::outcome::{Distance, Outcome};
use crate::scene::queries::NEVER;
use crate::scene::step::bodies_of;
use crate::scene::{BodyId, PairId, Scene, SceneError};
use crate::time::impact::Impact;
use alloc::boxed::Box;
use alloc::vec::Vec;

/// Results of one pair: `Some` for each enabled query, `None` for all others.
///
/// Witness points, contact points and normals are in the frames of the bodies: `point_on_a` and
/// `normal` in the frame of `a`, `point_on_b` in the frame of `b`. [`Scene::pose`] transforms them
/// to the world if no pose was set since the last step, because results belong to the poses of that
/// step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PairResults<'a> {
    /// The body with the lower index: operand A of all results.
    pub a: BodyId,
    /// The body with the higher index: operand B of all results.
    pub b: BodyId,
    /// Id of the pair. It stays the same as long as the boxes overlap.
    pub pair: PairId,
    /// Whether the bodies share a point.
    pub overlaps: Option<bool>,
    /// Whether the bodies are within the distance of the query.
    pub within: Option<bool>,
    /// Signed distance. Also `None` if the bodies are farther apart than the range of the query.
    pub distance: Option<Distance>,
    /// Features, witness points and normal. Also `None` if the bodies are farther apart than the
    /// range of the query.
    ///
    /// * Features of a compound are the features of the piece.
    /// * Features of a mesh have the caller's numbers: a vertex has the number of the point, a face
    ///   that of the triangle, and an edge that of the point at which the edge of the triangle
    ///   starts.
    /// * In three cases the features of a mesh are those of the triangle as a separate polygon:
    ///   against a rounded or curved shape, against a compound with such a piece, and against
    ///   points and segments.
    /// * The feature of a Bézier surface is the face with the number of the patch.
    pub outcome: Option<&'a Outcome>,
    /// The subshapes to which the features of `a` and `b` belong: the piece of a compound, the
    /// triangle of a mesh, or the patch of a surface, in the caller's order. Zero for a convex
    /// shape.
    pub subshapes: Option<[u32; 2]>,
    /// Contact points of two convex shapes. Also `None` if the bodies are farther apart than the
    /// prediction.
    pub manifold: Option<&'a Manifold>,
    /// Contact points of a pair with a mesh or a compound, grouped by direction. Also `None` if the
    /// bodies are farther apart than the prediction.
    #[cfg(feature = "meshes")]
    pub contacts: Option<&'a [ContactGroup]>,
}

impl Scene {
    /// Iterates over the results of all pairs whose boxes overlap, in the order of the slots.
    pub fn pairs(&self) -> impl Iterator<Item = PairResults<'_>> + '_ {
        self.broad.pairs().map(|pair| self.answer(&pair))
    }

    /// Returns the results of two bodies, in either order. `None` if their boxes, grown by the
    /// distances of the enabled queries, do not overlap.
    #[must_use]
    pub fn pair(&self, a: BodyId, b: BodyId) -> Option<PairResults<'_>> {
        let proxy = |id| Some(self.bodies.proxies[self.bodies.index_of(id).ok()?]);
        Some(self.answer(&self.broad.pair(proxy(a)?, proxy(b)?)?))
    }

    /// Returns the results of all pairs of one body, in ascending order of the other body.
    ///
    /// # Errors
    /// Returns an error if the id is stale.
    pub fn pairs_of(&self, id: BodyId) -> Result<Vec<PairResults<'_>>, SceneError> {
        let i = self.bodies.index_of(id)?;
        let proxy = self.bodies.proxies[i];
        let mut near = Vec::new();
        // The stored box, converted from f32 to f64 relative to the origin, contains itself.
        if let Some(stored) = self.broad.stored_box(proxy) {
            let corner = |v: [f32; 3]| self.settings.origin + nalgebra::Vector3::from(v.each(f64::from));
            let around = Aabb::new(corner(stored.lo), corner(stored.hi));
            let _ = self.broad.overlapping(&around, &mut near);
        }
        let mut found: Vec<_> = near
            .into_iter()
            .filter_map(|other| Some(self.answer(&self.broad.pair(proxy, other)?)))
            .collect();
        sort_by_key(&mut found, |p| (p.a, p.b));
        Ok(found)
    }

    /// Returns the number of pairs whose boxes overlap.
    #[must_use]
    pub fn pair_count(&self) -> usize {
        self.broad.pair_count()
    }

    pub(super) fn answer(&self, pair: &broad::Pair) -> PairResults<'_> {
        let [a, b] = bodies_of(&self.bodies, pair);
        let mut answer = PairResults {
            a: self.bodies.id(a),
            b: self.bodies.id(b),
            pair: pair.id,
            overlaps: None,
            within: None,
            distance: None,
            outcome: None,
            subshapes: None,
            manifold: None,
            #[cfg(feature = "meshes")]
            contacts: None,
        };
        if let Some(seen) = self.pair_tables.get(pair.id.slot) {
            let plan = self.table.plan(seen.header.groups);
            answer.overlaps = (plan.overlap && seen.header.state.known).then_some(seen.header.state.overlaps);
            answer.within = (plan.within != NEVER && seen.header.state.known).then_some(seen.header.state.within);
            (answer.distance, answer.outcome, answer.manifold) = (seen.distance, seen.outcome, seen.manifold);
            #[cfg(feature = "meshes")]
            {
                answer.contacts = seen.contacts;
            }
            answer.subshapes = seen.outcome.map(|_| seen.pieces);
        }
        answer
    }
}

/// A change of the state of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Change {
    /// The boxes, grown by the distances of the queries, started to overlap.
    BoxesMet,
    /// The bodies started to share a point.
    OverlapBegan,
    /// The bodies came within the distance of the query.
    CameWithin,
    /// The bodies are no longer within the distance of the query.
    LeftWithin,
    /// The bodies stopped sharing a point.
    OverlapEnded,
    /// The boxes stopped overlapping.
    BoxesParted,
}

impl core::fmt::Display for Change {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(match self {
            Self::BoxesMet => "boxes met",
            Self::OverlapBegan => "overlap began",
            Self::CameWithin => "came within",
            Self::LeftWithin => "left within",
            Self::OverlapEnded => "overlap ended",
            Self::BoxesParted => "boxes parted",
        })
    }
}

/// A change of one pair, sent if its query is enabled. If a pair ends because a body is removed or
/// because its groups no longer enable any query, its overlap ends as well.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Event {
    /// The body with the lower index.
    pub a: BodyId,
    /// The body with the higher index.
    pub b: BodyId,
    /// Id of the pair while the boxes overlap.
    pub pair: PairId,
    /// The change of the pair.
    pub change: Change,
}

/// The first time in the last tick at which two bodies met, or came within a distance.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PairImpact {
    /// The body with the lower index: operand A of the impact.
    pub a: BodyId,
    /// The body with the higher index: operand B of the impact.
    pub b: BodyId,
    /// Id of the pair while the boxes overlap.
    pub pair: PairId,
    /// The bracket, in time after the start of the tick. It is an [`Impact::Hit`], or
    /// [`Impact::Undecided`] or [`Impact::Incomplete`] if the bodies are proven neither to meet nor
    /// to stay separated. The frames are those of the bodies.
    pub impact: Impact,
    /// The distance of the query `impact_within`; 0 for the query `impact`. At a positive distance,
    /// *to meet* is to come within the distance, and *separated* is to be farther apart.
    #[cfg_attr(feature = "serde", serde(default))]
    pub distance: f64,
}

impl PairImpact {
    /// Returns the time after the start of the tick until which the bodies are proven separated, or
    /// farther apart than [`distance`](Self::distance).
    #[must_use]
    pub fn safe(&self) -> f64 {
        match self.impact {
            Impact::Hit { safe, .. } | Impact::Undecided { safe, .. } | Impact::Incomplete { safe } => safe,
            _ => 0.0,
        }
    }
}

/// A change before the ids are known.
#[derive(Clone, Copy, Debug)]
pub(super) struct PairChange {
    pub(super) id: PairId,
    pub(super) pair: [u32; 2],
    pub(super) change: Change,
}

/// The fields of an outcome that a table stores.
pub(super) trait StoredAnswer: Clone + Send + Sync {
    /// Returns the value before the first outcome.
    fn blank() -> Self;
    /// Stores the fields of `outcome` that this table keeps.
    fn store(&mut self, outcome: &Outcome);
    fn distance(&self) -> Option<Distance>;
    fn outcome(&self) -> Option<&Outcome>;
    /// Returns the stored contact points, if the table has them.
    fn manifold(&mut self) -> Option<&mut Option<Box<Manifold>>> {
        None
    }
    fn contacts(&self) -> Option<&Manifold> {
        None
    }
}

impl StoredAnswer for () {
    fn blank() {}
    fn store(&mut self, _: &Outcome) {}
    fn distance(&self) -> Option<Distance> {
        None
    }
    fn outcome(&self) -> Option<&Outcome> {
        None
    }
}

impl StoredAnswer for Distance {
    fn blank() -> Self {
        Self::from(&<Outcome as StoredAnswer>::blank())
    }
    #[inline]
    fn store(&mut self, outcome: &Outcome) {
        *self = Self::from(outcome);
    }
    fn distance(&self) -> Option<Distance> {
        Some(*self)
    }
    fn outcome(&self) -> Option<&Outcome> {
        None
    }
}

impl StoredAnswer for Outcome {
    fn blank() -> Self {
        Self {
            // Finite, since not every file format can hold infinity.
            upper: f64::MAX,
            ..Self::starting_at(FeaturePair::FIRST)
        }
    }
    #[inline]
    fn store(&mut self, outcome: &Outcome) {
        *self = *outcome;
    }
    fn distance(&self) -> Option<Distance> {
        Some(Distance::from(self))
    }
    fn outcome(&self) -> Option<&Outcome> {
        Some(self)
    }
}

/// An outcome, and the contact points as long as the bodies are within the prediction.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct StoredContact {
    pub(super) outcome: Outcome,
    #[cfg_attr(feature = "serde", serde(deserialize_with = "complete"))]
    pub(super) manifold: Option<Box<Manifold>>,
}

/// Reads the complete state of a manifold, which the scene proves again.
#[cfg(feature = "serde")]
fn complete<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Option<Box<Manifold>>, D::Error> {
    let read: Option<crate::convex::contact::Complete> = serde::Deserialize::deserialize(deserializer)?;
    Ok(read.map(|complete| Box::new(complete.0)))
}

impl StoredAnswer for StoredContact {
    fn blank() -> Self {
        Self {
            outcome: <Outcome as StoredAnswer>::blank(),
            manifold: None,
        }
    }
    #[inline]
    fn store(&mut self, outcome: &Outcome) {
        self.outcome = *outcome;
    }
    fn distance(&self) -> Option<Distance> {
        self.outcome.distance()
    }
    fn outcome(&self) -> Option<&Outcome> {
        Some(&self.outcome)
    }
    #[inline]
    fn manifold(&mut self) -> Option<&mut Option<Box<Manifold>>> {
        Some(&mut self.manifold)
    }
    fn contacts(&self) -> Option<&Manifold> {
        self.manifold.as_deref()
    }
}

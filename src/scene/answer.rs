//! Answers of the last step, by pair and by body.

use alloc::vec::Vec;

use super::effects::NEVER;
use super::step::bodies_of;
use super::{BodyId, PairId, Scene, SceneError};
use crate::broad::{self, Aabb, BroadPhase};
#[cfg(feature = "meshes")]
use crate::composite::contact::PatchContacts;
use crate::convex::contact::Manifold;
use crate::pair::outcome::{Distance, Outcome};

/// Answers for one pair: `Some` for each effect that is called for, and `None` otherwise.
///
/// Witnesses, contact points and normals are in the frames of the bodies: `point_on_a` and `normal`
/// in the frame of `a`, `point_on_b` in the frame of `b`. [`Scene::pose`] leads to the world as
/// long as no pose was set since the last step: answers are those of the poses of that step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PairAnswer<'a> {
    /// The body with the lower index: operand A of all answers.
    pub a: BodyId,
    /// The body with the higher index: operand B of all answers.
    pub b: BodyId,
    /// Id of the pair, from the meeting of the boxes to their parting.
    pub pair: PairId,
    /// Whether the bodies share a point.
    pub overlaps: Option<bool>,
    /// Whether the bodies are within the distance called for.
    pub within: Option<bool>,
    /// Signed distance; `None` also for bodies farther apart than the range called for.
    pub distance: Option<Distance>,
    /// Features, witnesses and normal; `None` also for bodies farther apart than the range called
    /// for. Features of a composite are those of the piece. Features of a mesh have the caller's
    /// numbers: a vertex that of the point, a face that of the triangle, an edge that of the point
    /// at which the edge of the triangle begins. Against a shape that is rounded or curved, and
    /// against a composite with such a piece, they are those of the triangle as a polygon of its
    /// own, and so are those against points and segments. The feature of a surface of patches is
    /// the face with the number of the patch.
    pub outcome: Option<&'a Outcome>,
    /// The piece of a composite, the triangle of a mesh, or the patch of a surface, to which the
    /// features of `a` and of `b` belong, by the caller's order; zero for a convex shape.
    pub pieces: Option<[u32; 2]>,
    /// Contact points of two convex shapes; `None` also for bodies farther apart than the
    /// prediction.
    pub manifold: Option<&'a Manifold>,
    /// Contact points of a pair with a mesh or a composite, by direction; `None` also for bodies
    /// farther apart than the prediction.
    #[cfg(feature = "meshes")]
    pub contacts: Option<&'a [PatchContacts]>,
}

impl Scene {
    /// Iterates over all pairs whose boxes overlap, in the order of the slots, with the answers.
    pub fn pairs(&self) -> impl Iterator<Item = PairAnswer<'_>> + '_ {
        self.broad.pairs().map(|pair| self.answer(&pair))
    }

    /// Returns the pair of two bodies, in either order: `None` if the boxes, grown by the distances
    /// called for, do not overlap.
    #[must_use]
    pub fn pair(&self, a: BodyId, b: BodyId) -> Option<PairAnswer<'_>> {
        let proxy = |id| Some(self.bodies.proxies[self.bodies.index_of(id).ok()?]);
        Some(self.answer(&self.broad.pair(proxy(a)?, proxy(b)?)?))
    }

    /// Returns the pairs of one body, in ascending order of the partner.
    ///
    /// # Errors
    /// If the id is stale.
    pub fn pairs_of(&self, id: BodyId) -> Result<Vec<PairAnswer<'_>>, SceneError> {
        let i = self.bodies.index_of(id)?;
        let proxy = self.bodies.proxies[i];
        let mut near = Vec::new();
        // The stored box, from f32 to f64 about the origin, contains itself.
        if let Some(stored) = self.broad.stored_box(proxy) {
            let corner = |v: [f32; 3]| self.settings.origin + nalgebra::Vector3::from(v.map(f64::from));
            let around = Aabb::new(corner(stored.lo), corner(stored.hi));
            let _ = self.broad.overlapping(&around, &mut near);
        }
        let mut found: Vec<_> = near
            .into_iter()
            .filter_map(|other| Some(self.answer(&self.broad.pair(proxy, other)?)))
            .collect();
        found.sort_unstable_by_key(|p| (p.a, p.b));
        Ok(found)
    }

    /// Returns the number of pairs whose boxes overlap.
    #[must_use]
    pub fn pair_count(&self) -> usize {
        self.broad.pair_count()
    }

    fn answer(&self, pair: &broad::Pair) -> PairAnswer<'_> {
        let (a, b) = bodies_of(&self.bodies, pair);
        let mut answer = PairAnswer {
            a: self.bodies.id(a),
            b: self.bodies.id(b),
            pair: pair.id,
            overlaps: None,
            within: None,
            distance: None,
            outcome: None,
            pieces: None,
            manifold: None,
            #[cfg(feature = "meshes")]
            contacts: None,
        };
        if let Some(seen) = self.pair_tables.get(pair.id.slot) {
            let plan = self.table.plan(seen.header.class);
            answer.overlaps = (plan.overlap && seen.header.state.known).then_some(seen.header.state.overlaps);
            answer.within = (plan.within != NEVER && seen.header.state.known).then_some(seen.header.state.within);
            (answer.distance, answer.outcome, answer.manifold) = (seen.distance, seen.outcome, seen.manifold);
            #[cfg(feature = "meshes")]
            {
                answer.contacts = seen.contacts;
            }
            answer.pieces = seen.outcome.map(|_| seen.pieces);
        }
        answer
    }
}

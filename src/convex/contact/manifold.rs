//! The contact manifold of a pair of bodies, which persists from frame to frame.

#[cfg(feature = "serde")]
pub(crate) mod persist;

use nalgebra::{Point3, Unit, Vector3};

use crate::base::motion::BallAtPose;
use crate::base::num::each::Each;
use crate::base::num::extremes::{ByValue, Extremes};
use crate::base::num::fingerprint::Fingerprint;
use crate::base::pose::{Operand, RelativePose};
use crate::body::polyhedron::{ConvexPolyhedron, FeaturePair};
use crate::pair::outcome::Outcome;
use crate::pair::rounding;

use super::bearing::Facet;
use super::clip::{ContactCandidate, Location};
use super::clip_large::{NO_RAYS, Rays};
use super::query::Query;
use super::{Contacts, MOST_POINTS, ManifoldOptions, PosedOutcome, clip_curved};

/// A contact: a point on each body, opposite each other along the normal.
///
/// The two points may differ from this for two edges that are parallel up to the angle of
/// [`ManifoldOptions::max_face_sine`]: then they are an end of one edge and the nearest point of
/// the other.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ContactPoint {
    /// Point on A, in A's frame.
    pub point_on_a: Point3<f64>,
    /// Point on B, in B's frame.
    pub point_on_b: Point3<f64>,
    /// Signed distance from the point on A to the point on B along the normal, in the caller's
    /// unit. It is negative if the bodies overlap.
    pub separation: f64,
    /// Features that contain the points: a vertex and a face, two edges, or the closest features.
    pub features: FeaturePair,
    /// Contact id: the features at which the contact first appeared. It stays the same for the
    /// lifetime of the contact, and is unique in a manifold.
    pub id: FeaturePair,
}

impl ContactPoint {
    /// Returns the contact of B and A as a contact of A and B.
    #[cfg(feature = "meshes")]
    pub(crate) fn swapped(self) -> Self {
        Self {
            point_on_a: self.point_on_b,
            point_on_b: self.point_on_a,
            separation: self.separation,
            features: self.features.swapped(),
            id: self.id.swapped(),
        }
    }

    pub(super) fn witness(outcome: &Outcome) -> Self {
        Self {
            point_on_a: outcome.point_on_a,
            point_on_b: outcome.point_on_b,
            separation: outcome.distance,
            features: outcome.features,
            id: outcome.features,
        }
    }
}

/// The contact points of a pair of bodies.
///
/// Keep one manifold for each pair, and pass it to [`Tracker::manifold`] in every frame.
///
/// The features of the certified outcome are replaced by the faces or edges within a small angle of
/// the normal. Both are projected along the normal, and the vertices of their overlap are the
/// contact candidates. The deepest candidate and the points that span the most area are kept (after
/// Gregorius 2013, "The separating axis test between convex polyhedra", GDC; here both faces are
/// treated alike, in either order of the bodies).
///
/// A manifold has at most eight points and no heap memory. If the bodies or the options change, it
/// is computed from scratch. A deserialized manifold (feature `serde`) has the points and ids of
/// the saved one, which are not checked, and no bounds: the next query computes all contacts again,
/// and ids continue.
///
/// [`Tracker::manifold`]: crate::Tracker::manifold
#[doc(alias = "contact points")]
#[doc(alias = "clipping")]
#[derive(Clone, Debug, PartialEq)]
pub struct Manifold {
    points: [ContactPoint; MOST_POINTS],
    count: usize,
    normal: Unit<Vector3<f64>>,
    lower: f64,
    upper: f64,
    made: Option<Made>,
    fresh: bool,
    /// Location of each point on both features.
    on: [[Location; 2]; MOST_POINTS],
    /// Lower bound of the distance from each vertex to the boundary of the opposite face when it
    /// was chosen, in the caller's unit.
    margins: [f64; MOST_POINTS],
    pub(super) rays: Rays,
}

/// State of the last computation, from which later motion is measured.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Made {
    /// Files of older versions have other fingerprints under another name, which are ignored.
    #[cfg_attr(feature = "serde", serde(default, rename = "fingerprints"))]
    bodies: [Fingerprint; 2],
    options: ManifoldOptions,
    #[cfg(feature = "serde")]
    pose: RelativePose,
    /// Bounding ball of the smaller body at its pose.
    ball: BallAtPose,
    features: FeaturePair,
    reference: Operand,
    /// Normal in the frame of the reference body.
    normal: Vector3<f64>,
    #[cfg_attr(feature = "serde", serde(with = "crate::base::num::scalar::infinite"))]
    lower: f64,
    #[cfg_attr(feature = "serde", serde(with = "crate::base::num::scalar::infinite"))]
    upper: f64,
    /// How far the bodies may move from `ball`.
    #[cfg_attr(feature = "serde", serde(with = "crate::base::num::scalar::infinite"))]
    budget: f64,
    /// How far the bodies had moved since the points were chosen.
    #[cfg_attr(feature = "serde", serde(with = "crate::base::num::scalar::infinite"))]
    since: f64,
}

impl Default for Manifold {
    fn default() -> Self {
        let none = ContactPoint {
            point_on_a: Point3::origin(),
            point_on_b: Point3::origin(),
            separation: 0.0,
            features: FeaturePair::FIRST,
            id: FeaturePair::FIRST,
        };
        Self {
            points: [none; MOST_POINTS],
            count: 0,
            normal: Vector3::x_axis(),
            lower: f64::NEG_INFINITY,
            upper: f64::INFINITY,
            made: None,
            fresh: false,
            on: [ContactCandidate::WITNESS; MOST_POINTS],
            margins: [0.0; MOST_POINTS],
            rays: NO_RAYS,
        }
    }
}

impl Manifold {
    /// Returns a manifold without contacts.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns the contacts of an outcome of [`Tracker::closest`](crate::Tracker::closest), without
    /// earlier contacts.
    ///
    /// The outcome must be for these bodies at this pose. Use this if you keep earlier contacts
    /// yourself. The result has no contacts if an id of the outcome is not a feature of its body.
    #[must_use]
    pub fn from_outcome(
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
        a_from_b: &RelativePose,
        outcome: &Outcome,
        options: &ManifoldOptions,
    ) -> Self {
        let mut manifold = Self::default();
        if outcome.features.is_of(a, b) {
            manifold.renew(&Query::new(a, b, a_from_b, options), outcome, 0.0);
        }
        manifold
    }

    /// Returns the contacts: first the persistent ones in their old order, then the new ones. Empty
    /// if the bodies are farther apart than the prediction.
    #[inline]
    #[must_use]
    pub fn points(&self) -> &[ContactPoint] {
        // A deserialized count may be larger.
        &self.points[..self.count.min(MOST_POINTS)]
    }

    /// Returns the deepest contact.
    #[must_use]
    pub fn deepest(&self) -> Option<&ContactPoint> {
        let deeper = |x: &&ContactPoint, y: &&ContactPoint| x.separation.by_value(y.separation);
        self.points().iter().min_by(deeper)
    }

    /// Returns the unit normal from A to B, in A's frame.
    ///
    /// It is the normal of the outcome from which the manifold was computed, rotated since then
    /// with the reference body. Without contacts it is the normal of the last query, and x before
    /// the first query.
    #[must_use]
    pub fn normal(&self) -> Unit<Vector3<f64>> {
        self.normal
    }

    /// Returns the features that carry the contact: for each body a face or an edge nearly
    /// perpendicular to the normal, or the closest feature. `None` before the first query.
    #[must_use]
    pub fn features(&self) -> Option<FeaturePair> {
        self.made.as_ref().map(|m| m.features)
    }

    /// Returns the body whose feature determines the normal. If a face touches an edge or a vertex,
    /// this is the body of the face. Otherwise it is the previous reference body, initially A.
    #[must_use]
    pub fn reference(&self) -> Operand {
        self.made.as_ref().map_or(Operand::A, |m| m.reference)
    }

    /// Returns a lower bound of the signed distance, also without contacts; minus infinity before
    /// the first query.
    #[must_use]
    pub fn lower(&self) -> f64 {
        self.lower
    }

    /// Returns an upper bound of the signed distance, also without contacts; infinity before the
    /// first query.
    #[must_use]
    pub fn upper(&self) -> f64 {
        self.upper
    }

    /// Returns whether the last query computed the points. If not, they are the old points with new
    /// separations.
    #[must_use]
    pub fn is_fresh(&self) -> bool {
        self.fresh
    }

    pub(super) fn on(&self) -> &[[Location; 2]] {
        &self.on[..self.count]
    }

    pub(super) fn margins(&self) -> &[f64] {
        &self.margins[..self.count]
    }

    /// Returns the mean of the points on A.
    pub(super) fn middle(&self) -> Option<Point3<f64>> {
        let points = self.points();
        let sum = points.iter().fold(Vector3::zeros(), |s, p| s + p.point_on_a.coords);
        (!points.is_empty()).then(|| Point3::from(sum / points.len() as f64))
    }

    /// Measures the old points again if the bodies moved little enough. Otherwise returns how far
    /// they moved.
    #[inline(always)]
    pub(crate) fn refresh(&mut self, query: &Query) -> Result<(), f64> {
        let Some(made) = &self.made else { return Err(0.0) };
        let moved = query.ball.displacement(&made.ball);
        // With NaN the manifold is computed again.
        if !(made.is_of(query) && moved <= made.budget) {
            return Err(moved);
        }
        self.fresh = false;
        (self.lower, self.upper) = (made.lower - moved, made.upper + moved);
        let n = match made.reference {
            Operand::A => made.normal,
            Operand::B => query.rotation * made.normal,
        };
        self.normal = Unit::new_unchecked(n);
        for p in &mut self.points[..self.count] {
            let between = query.rotation * p.point_on_b.coords + query.translation - p.point_on_a.coords;
            p.separation = n.dot(&between);
        }
        Ok(())
    }

    /// Computes the contacts of an outcome (of the cores, if the bodies are rounded), with the ids
    /// of matching contacts from before the bodies `moved`.
    pub(crate) fn renew(&mut self, query: &Query, outcome: &Outcome, moved: f64) {
        let [lower, upper] = rounding::bounds([outcome.lower, outcome.upper], query.radii);
        (self.normal, self.lower, self.upper, self.fresh) = (outcome.normal, lower, upper, true);
        let (features, since) = if outcome.lower <= query.options.prediction {
            self.renew_points(query, outcome, moved)
        } else {
            self.count = 0;
            (outcome.features, 0.0)
        };
        let reference = reference(outcome.features).unwrap_or(self.reference());
        let normal = outcome.normal.into_inner();
        self.made = Some(Made {
            bodies: query.bodies(),
            options: *query.options,
            #[cfg(feature = "serde")]
            pose: *query.pose,
            ball: query.ball,
            features,
            reference,
            normal: match reference {
                Operand::A => normal,
                Operand::B => query.rotation.tr_mul(&normal),
            },
            lower,
            upper,
            budget: query.budget(outcome.lower),
            since,
        });
    }

    /// Computes the points of an outcome. Returns the features that carry them, and how far the
    /// bodies moved since the candidates were chosen.
    fn renew_points(&mut self, query: &Query, outcome: &Outcome, moved: f64) -> (FeaturePair, f64) {
        let options = query.options;
        let least = query.least_radius();
        let travelled = self.made.as_ref().filter(|m| m.is_of(query)).map(|m| m.since + moved);
        let since_choice = travelled.filter(|&t| t <= options.reselect_motion * least);
        let mut contacts = match query.facets {
            [Facet::Body(a), Facet::Body(b)] => {
                let (rotation, size) = (&query.rotation, query.size());
                let posed = PosedOutcome {
                    a,
                    b,
                    rotation,
                    size,
                    outcome,
                };
                posed.contacts(options, self, since_choice)
            }
            facets => clip_curved::contacts(query, outcome, facets, self),
        };
        if query.radii != [0.0; 2] {
            contacts.grow(query, &outcome.normal);
        }
        self.rays = contacts.rays;
        if !contacts.same {
            self.replace_points(&contacts, 2.0 * moved + options.rebuild_motion * least);
            return (contacts.features, 0.0);
        }
        for (old, new) in self.points.iter_mut().zip(&contacts.points[..contacts.count]) {
            *old = ContactPoint { id: old.id, ..*new };
        }
        (contacts.features, since_choice.unwrap_or(0.0))
    }

    /// Replaces the old points by new points. A new point takes id and order from the old point
    /// with equal features; otherwise from the nearest old point that is at most `reach` away on
    /// one of the bodies.
    fn replace_points(&mut self, contacts: &Contacts, reach: f64) {
        let new = &contacts.points[..contacts.count];
        let old = self.points();
        let mut origin = [usize::MAX; MOST_POINTS];
        for (i, p) in new.iter().enumerate() {
            let alike = old.iter().position(|o| o.features == p.features);
            if let Some(k) = alike.filter(|k| !origin.contains(k)) {
                origin[i] = k;
            }
        }
        let apart = |o: &ContactPoint, p: &ContactPoint| {
            let on_a = (o.point_on_a - p.point_on_a).norm_squared();
            on_a.smaller((o.point_on_b - p.point_on_b).norm_squared())
        };
        for (i, p) in new.iter().enumerate() {
            if origin[i] == usize::MAX {
                let near = (0..old.len()).filter(|k| !origin.contains(k) && apart(&old[*k], p) <= reach * reach);
                let nearest = near.min_by(|&x, &y| apart(&old[x], p).total_cmp(&apart(&old[y], p)));
                origin[i] = nearest.unwrap_or(usize::MAX);
            }
        }
        self.reorder(contacts, &origin);
    }

    /// Stores the new points in order. `origin` holds the index of the old point whose id and order
    /// each new point takes, or an index past the end if there is none.
    fn reorder(&mut self, contacts: &Contacts, origin: &[usize; MOST_POINTS]) {
        let new = &contacts.points[..contacts.count];
        let old = self.points().len();
        // Ids are read first: the old points are overwritten in order.
        let ids = origin.each(|k| self.points[k.min(MOST_POINTS - 1)].id);
        self.count = 0;
        for k in 0..old {
            if let Some(i) = origin[..new.len()].iter().position(|&o| o == k) {
                self.points[self.count] = ContactPoint { id: ids[i], ..new[i] };
                (self.on[self.count], self.margins[self.count]) = (contacts.on[i], contacts.margins[i]);
                self.count += 1;
            }
        }
        for (i, p) in new.iter().enumerate() {
            if origin[i] == usize::MAX {
                let id = self.free_id(p.features);
                self.points[self.count] = ContactPoint { id, ..*p };
                (self.on[self.count], self.margins[self.count]) = (contacts.on[i], contacts.margins[i]);
                self.count += 1;
            }
        }
    }

    /// Returns a free contact id for this feature pair. If a contact at different features owns the
    /// id, follows the chain of displaced ids to a free id.
    fn free_id(&self, features: FeaturePair) -> FeaturePair {
        let mut id = features;
        for _ in 0..self.count {
            match self.points().iter().find(|p| p.id == id) {
                Some(p) => id = p.features,
                None => break,
            }
        }
        id
    }
}

impl Made {
    /// Returns whether bodies and options are unchanged.
    #[inline(always)]
    fn is_of(&self, query: &Query) -> bool {
        self.bodies == query.bodies() && self.options == *query.options
    }
}

/// Returns the body of the higher-dimensional feature; `None` if the dimensions are equal.
fn reference(features: FeaturePair) -> Option<Operand> {
    match features.a.dimension().cmp(&features.b.dimension()) {
        core::cmp::Ordering::Greater => Some(Operand::A),
        core::cmp::Ordering::Less => Some(Operand::B),
        core::cmp::Ordering::Equal => None,
    }
}

//! Contacts of two patches that are near each other.
//!
//! These are the contacts of their hulls that lie on the surfaces of both bodies. There are also
//! contacts next to a vertex whose foot on the plane of a face is beyond the end of the face.
//!
//! ```text
//!    face \       / other face     A vertex v in a valley is below both faces. Its foot on the
//!          \  |  /                 plane of either lies beyond the bottom of the valley, where
//!           \_|_/                  the face ends: the contact of a face is where an edge at v
//!             v  ` foot            passes over its end.
//! ```

use nalgebra::{Isometry3, Point3, Unit, Vector3};

use super::body::{ConvexPatches, Under, is_in};
use super::patches::Valid;
use super::{PatchContact, PatchQuery};
use crate::base::num::each::Each;
use crate::base::num::extremes::{ByValue, Extremes};
use crate::base::num::sort::sort;
use crate::base::pose::RelativePose;
use crate::body::polyhedron::{ConvexPolyhedron, EdgeId, Feature};
use crate::body::shape::{Core, Shape};
use crate::convex::contact::{ContactPoint, Manifold};
use crate::convex::shape_tracker::{ShapeTracker, along_face, swapped};
use crate::nonconvex::front::NodePair;
use crate::pair::outcome::{ContactState, DepthMode, Outcome};

/// Maximum number of faces tried for a contact whose normal is not a normal of the mesh.
const FACES_TRIED: usize = 6;

/// Faces whose depths differ by less than this fraction count as equally deep.
const NEARLY: f64 = 1.0 / 64.0;

/// The state of two patches that are near each other.
#[derive(Clone, Debug)]
pub(super) struct NearPatches {
    parts: [(Shape, Isometry3<f64>); 2],
    tracker: ShapeTracker,
    manifold: Manifold,
    /// Bit set of the manifold points that lie on both surfaces.
    valid: u8,
    /// Whether no contact is deeper than the bodies: the normal is that of the hulls, and the hulls
    /// are parts of the bodies.
    is_sure: bool,
    /// Whether the last query tested this pair of patches.
    pub(super) is_seen: bool,
}

/// Two patches at a pose.
struct PosedPatches<'a> {
    query: &'a PatchQuery<'a>,
    patches: NodePair,
    parts: &'a [(Shape, Isometry3<f64>); 2],
    /// Pose of the frame of B's convex body in that of A's.
    pose: RelativePose,
}

impl NearPatches {
    /// Returns `None` for a patch that is not a body.
    pub(super) fn new(a: &ConvexPatches, b: &ConvexPatches, [p, q]: NodePair) -> Option<Self> {
        Some(Self {
            parts: [a.part(p)?, b.part(q)?],
            tracker: ShapeTracker::new(),
            manifold: Manifold::new(),
            valid: 0,
            is_sure: false,
            is_seen: false,
        })
    }

    /// Returns whether the hulls of the patches are not proven to be separated.
    pub(super) fn may_overlap(&self) -> bool {
        !(self.manifold.lower() > 0.0)
    }

    /// Calls `found` with the contacts of the patches at a pose, and whether their depth is sure.
    pub(super) fn ask(&mut self, query: &PatchQuery, patches: NodePair, mut found: impl FnMut(PatchContact, bool)) {
        let Self {
            parts,
            tracker,
            manifold,
            valid,
            is_sure,
            ..
        } = self;
        let (pose, _) = query.placed.between(&parts[0].1, &parts[1].1);
        let posed = PosedPatches {
            query,
            patches,
            parts,
            pose,
        };
        let shapes = [&parts[0].0, &parts[1].0];
        let mut is_new = false;
        tracker.manifold_by(shapes, &pose, query.options, manifold, |tracker| {
            is_new = true;
            tracker.closest_cores(shapes[0], shapes[1], &pose, DepthMode::Full)
        });
        if is_new {
            *valid = posed.valid(manifold);
            *is_sure = *valid != 0 && query.a.is_whole() && query.b.is_whole();
            if *valid == 0 && !manifold.points().is_empty() {
                *valid = posed.by_faces(tracker, manifold);
            }
        }
        let normal = posed.normal(manifold);
        for (k, point) in manifold.points().iter().enumerate() {
            if *valid >> k & 1 == 1 && point.separation <= query.options.prediction {
                let point = posed.point(point);
                let contact = PatchContact { patches, normal, point };
                found(contact, *is_sure);
            }
        }
    }
}

impl PosedPatches<'_> {
    /// Returns the normal of a manifold in A's frame.
    fn normal(&self, manifold: &Manifold) -> Unit<Vector3<f64>> {
        self.parts[0].1 * manifold.normal()
    }

    /// Returns a contact of the convex bodies of the patches as a contact of the two bodies.
    fn point(&self, point: &ContactPoint) -> ContactPoint {
        ContactPoint {
            point_on_a: self.parts[0].1 * point.point_on_a,
            point_on_b: self.parts[1].1 * point.point_on_b,
            ..*point
        }
    }

    /// Returns a bit set of the manifold points that lie on both surfaces.
    ///
    /// It is empty if the deepest point does not. Points that nearly lie on both count if the
    /// normal is the normal of a face of a body.
    fn valid(&self, manifold: &Manifold) -> u8 {
        let Some(deepest) = manifold.deepest() else { return 0 };
        let n = self.normal(manifold);
        if deepest.separation < 0.0 && self.is_behind(&manifold.normal(), deepest) {
            return 0;
        }
        let (mut fully, mut nearly) = (0u8, 0u8);
        let mut is_deepest_valid = false;
        for (k, point) in manifold.points().iter().enumerate() {
            let valid = self.how_valid(&n, &self.point(point));
            nearly |= u8::from(valid >= Valid::Nearly) << k;
            fully |= u8::from(valid == Valid::Fully) << k;
            let is_deepest = point.separation <= deepest.separation + self.query.doubt;
            is_deepest_valid |= valid == Valid::Fully && is_deepest;
        }
        if is_deepest_valid { nearly | fully } else { 0 }
    }

    /// Returns a bit set of the manifold points that are fully valid on both bodies.
    ///
    /// It includes points at the end of a face that continues below the other face of a valley.
    fn fully_valid(&self, manifold: &Manifold) -> u8 {
        let n = self.normal(manifold);
        bits(manifold, |point| {
            let point = self.point(point);
            self.how_valid(&n, &point) == Valid::Fully || self.is_at_end(&n, &point)
        })
    }

    /// Returns whether a point is valid, or at the end of a face of a piece, on both bodies.
    fn is_at_end(&self, n: &Vector3<f64>, point: &ContactPoint) -> bool {
        let PatchQuery { a, b, pose, doubt, .. } = self.query;
        let down = -pose.rotation().tr_mul(n);
        let [p, q] = self.patches;
        let ends_a = a.ends(p, &point.point_on_a, n, *doubt);
        let ends_b = b.ends(q, &point.point_on_b, &down, *doubt);
        (ends_a || self.valid_on_a(n, point) == Valid::Fully) && (ends_b || self.valid_on_b(n, point) == Valid::Fully)
    }

    fn valid_on_a(&self, n: &Vector3<f64>, point: &ContactPoint) -> Valid {
        let query = self.query;
        let sine = query.options.max_face_sine;
        query
            .a
            .how_valid(self.patches[0], &point.point_on_a, n, sine, query.doubt)
    }

    fn valid_on_b(&self, n: &Vector3<f64>, point: &ContactPoint) -> Valid {
        let query = self.query;
        let (down, sine) = (-query.pose.rotation().tr_mul(n), query.options.max_face_sine);
        query
            .b
            .how_valid(self.patches[1], &point.point_on_b, &down, sine, query.doubt)
    }

    fn how_valid(&self, n: &Vector3<f64>, point: &ContactPoint) -> Valid {
        let of_a = self.valid_on_a(n, point);
        if of_a == Valid::No {
            return Valid::No;
        }
        let of_b = self.valid_on_b(n, point);
        if of_b == Valid::No || point.separation < 0.0 && self.is_through(point) {
            return Valid::No;
        }
        of_a.min(of_b)
    }

    /// Returns whether the deepest contact point is outside one of the bodies on its other side.
    fn is_through(&self, point: &ContactPoint) -> bool {
        let PatchQuery { a, b, pose, doubt, .. } = self.query;
        let (rotation, translation) = (pose.rotation(), pose.translation());
        let in_a = Point3::from(rotation * point.point_on_b.coords + translation);
        let in_b = Point3::from(rotation.tr_mul(&(point.point_on_a.coords - translation)));
        a.is_left(&point.point_on_a, &in_a, *doubt) || b.is_left(&point.point_on_b, &in_b, *doubt)
    }

    /// Returns whether the other convex body is wholly below a patch of a mesh.
    ///
    /// No contact comes from there.
    fn is_behind(&self, n: &Vector3<f64>, deepest: &ContactPoint) -> bool {
        let PatchQuery { a, b, .. } = self.query;
        let [(p, _), (q, _)] = self.parts;
        let m = self.pose.rotation().tr_mul(n);
        let shift = n.dot(&self.pose.translation());
        let top = q.support_height(&m) + shift;
        let bottom = -p.support_height(&-n);
        let on_b = m.dot(&deepest.point_on_b.coords) + shift;
        a.is_mesh() && top <= n.dot(&deepest.point_on_a.coords) || b.is_mesh() && bottom >= on_b
    }

    /// Uses the normal of the face of least overlap along which the contact is valid on both
    /// bodies.
    ///
    /// The contact is at the deepest vertex, or otherwise where the edges of that vertex pass over
    /// the face.
    fn by_faces(&self, tracker: &mut ShapeTracker, manifold: &mut Manifold) -> u8 {
        let shapes = [&self.parts[0].0, &self.parts[1].0];
        let mut beside = None;
        for (is_of_a, outcome) in self.faces() {
            let is_nearest = self.is_nearest(is_of_a, &outcome);
            let mut trial = Manifold::new();
            tracker.manifold_by(shapes, &self.pose, self.query.options, &mut trial, |_| outcome);
            let on_both = |trial: &Manifold| self.valid(trial) & self.on_parts(trial);
            let mut valid = if is_nearest { on_both(&trial) } else { 0 };
            if valid == 0
                && let Some(middle) = self.middle_of(is_of_a, &outcome, &trial)
            {
                trial = ShapeTracker::manifold_of_witnesses(shapes, &self.pose, self.query.options, &middle);
                valid = on_both(&trial);
            }
            if valid != 0 {
                *manifold = trial;
                return valid;
            }
            beside = beside.or_else(|| self.beside(is_of_a, &outcome, is_nearest));
        }
        let Some(outcome) = beside else { return 0 };
        let (pose, options) = (&self.pose, self.query.options);
        let mut trial = Manifold::new();
        tracker.manifold_by(shapes, pose, options, &mut trial, |_| outcome);
        let mut valid = self.fully_valid(&trial) & self.on_parts(&trial);
        let level = trial.upper() + self.query.doubt;
        if bits(&trial, |point| point.separation <= level) & valid == 0 {
            // The face continues below another one, and the manifold points of the whole face hide
            // the contact.
            trial = ShapeTracker::manifold_of_witnesses(shapes, pose, options, &outcome);
            valid = self.fully_valid(&trial) & self.on_parts(&trial);
        }
        if valid != 0 {
            *manifold = trial;
        }
        valid
    }

    /// Returns the outcome at the middle of a manifold's points along the normal of a face, if the
    /// face is the nearest one there.
    ///
    /// The points are the outermost ones of the region of contact. All of them may be where the
    /// surface goes on along other faces.
    fn middle_of(&self, is_of_a: bool, outcome: &Outcome, manifold: &Manifold) -> Option<Outcome> {
        let points = manifold.points();
        let features = manifold.features().filter(|_| points.len() > 1)?;
        let share = 1.0 / points.len() as f64;
        let [on_a, on_b] = [0, 1].each(|k| self.parts[k].0.rounding_radius());
        let step = if is_of_a {
            let shell = self.pose.rotation().tr_mul(&outcome.normal) * on_b;
            let sum: Vector3<f64> = points.iter().map(|p| p.point_on_b - outcome.point_on_b).sum();
            sum * share + shell
        } else {
            let sum: Vector3<f64> = points.iter().map(|p| p.point_on_a - outcome.point_on_a).sum();
            sum * share - *outcome.normal * on_a
        };
        let mut middle = self.moved(is_of_a, outcome, step);
        middle.features = features;
        self.is_nearest(is_of_a, &middle).then_some(middle)
    }

    /// Returns a bit set of the manifold points that lie on those patches that are convex bodies.
    ///
    /// Witness points on the plane of a face may lie outside the face.
    fn on_parts(&self, manifold: &Manifold) -> u8 {
        bits(manifold, |point| self.is_on_parts(point))
    }

    /// Returns whether a contact lies on those patches that are convex bodies.
    fn is_on_parts(&self, point: &ContactPoint) -> bool {
        let PatchQuery { a, b, doubt, .. } = self.query;
        let [(p, _), (q, _)] = self.parts;
        (a.is_mesh() || is_in(p, &point.point_on_a, 2.0 * doubt))
            && (b.is_mesh() || is_in(q, &point.point_on_b, 2.0 * doubt))
    }

    /// Returns whether the face of an outcome is the nearest face to the deepest point.
    ///
    /// If a body enters a ridge from one side, only that side is in contact.
    fn is_nearest(&self, is_of_a: bool, outcome: &Outcome) -> bool {
        let PatchQuery { a, b, doubt, .. } = self.query;
        let depth = -outcome.distance * (1.0 - NEARLY) - doubt;
        if !(depth > 0.0) {
            return true;
        }
        let (rotation, translation) = (self.pose.rotation(), self.pose.translation());
        if is_of_a {
            let inner = rotation * outcome.point_on_b.coords + translation;
            a.is_clear(self.patches[0], &Point3::from(inner), depth, *doubt)
        } else {
            let inner = rotation.tr_mul(&(outcome.point_on_a.coords - translation));
            b.is_clear(self.patches[1], &Point3::from(inner), depth, *doubt)
        }
    }

    /// Returns the outcomes along the normals of faces of A or of B, the largest gap first.
    fn faces(&self) -> impl Iterator<Item = (bool, Outcome)> + '_ {
        let PatchQuery { a, b, .. } = self.query;
        let [(p, at_p), (q, at_q)] = self.parts;
        let back = self.pose.swapped();
        let of_a = faces(p.core(), q.core(), &self.pose);
        let of_b = faces(q.core(), p.core(), &back);
        let mut all: alloc::vec::Vec<(bool, Outcome)> =
            of_a.map(|o| (true, o)).chain(of_b.map(|o| (false, o))).collect();
        sort(&mut all, |x, y| y.1.distance.by_value(x.1.distance));
        let most = self.query.options.prediction + p.rounding_radius() + q.rounding_radius();
        let is_real = move |(of_a, o): &(bool, Outcome)| {
            o.distance <= most
                && if *of_a {
                    a.has_face(self.patches[0], &(at_p * o.normal))
                } else {
                    b.has_face(self.patches[1], &(at_q * o.normal))
                }
        };
        let real = all.into_iter().filter(is_real).take(FACES_TRIED);
        real.map(move |(of_a, o)| (of_a, if of_a { o } else { swapped(&o, &back) }))
    }
}

/// Returns a bit set of the manifold points that pass a test.
fn bits(manifold: &Manifold, passes: impl Fn(&ContactPoint) -> bool) -> u8 {
    let points = manifold.points().iter().enumerate();
    points.fold(0, |bits, (k, point)| bits | u8::from(passes(point)) << k)
}

/// Returns the outcomes of the faces of a core that is a polyhedron.
fn faces<'a>(core: &'a Core, other: &'a Core, pose: &'a RelativePose) -> impl Iterator<Item = Outcome> + 'a {
    let body: Option<&ConvexPolyhedron> = match core {
        Core::Polyhedron(body) => Some(body),
        _ => None,
    };
    let of = move |body: &'a ConvexPolyhedron| body.faces().filter_map(move |f| along_face(body, f, other, pose));
    body.into_iter().flat_map(of)
}

/// Fraction of an edge beyond which a contact next to a vertex is searched for: a millionth.
///
/// Vertices in 8,400 poses in valleys have the same contacts for 1e-9, 1e-6 and 1e-3; the times are
/// 13.3, 12.2 and 10.4 s (test build).
const SHORT_EDGE: f64 = 1.0 / 1_048_576.0;

/// Number of bisections of the position along an edge where a contact becomes valid.
///
/// The result is accurate to 1e-9 of the position. Vertices in 8,400 poses in valleys have the same
/// contacts to 1e-9 for 20, 30, 40 and 52 bisections; the times are 4.2, 6.2, 8.7 and 11.8 s (test
/// build).
const EDGE_HALVINGS: usize = 30;

impl PosedPatches<'_> {
    /// Returns an outcome along a face's normal at the lowest point of an edge over the face.
    ///
    /// The edges are those at the deepest vertex of the other convex body, if this vertex is not
    /// over the face. If the face ends in a valley, contacts within the prediction are valid. On
    /// any other face the contact must overlap, and the face must be the nearest to the vertex.
    fn beside(&self, is_of_a: bool, outcome: &Outcome, is_nearest: bool) -> Option<Outcome> {
        let (part, feature) = if is_of_a {
            (&self.parts[1].0, outcome.features.b)
        } else {
            (&self.parts[0].0, outcome.features.a)
        };
        let (Core::Polyhedron(body), Feature::Vertex(vertex)) = (part.core(), feature) else {
            return None;
        };
        let level = match self.under(is_of_a, outcome) {
            Under::Body => self.query.options.prediction,
            Under::Unknown if is_nearest => -self.query.doubt,
            Under::Face | Under::Unknown => return None,
        };
        let from = body.vertex(vertex)?;
        let along = |edge| {
            let [v, w] = body.edge_vertices(edge)?;
            let to = body.vertex(if v == vertex { w } else { v })?;
            self.first_valid(is_of_a, outcome, edge, &(to - from), level)
        };
        let places = body.vertex_edges(vertex).filter_map(along);
        let places = places.filter(|place| self.is_nearest(is_of_a, place));
        places.min_by(|x, y| x.distance.by_value(y.distance))
    }

    /// Returns what is at the foot of an outcome's vertex on the plane of the face.
    fn under(&self, is_of_a: bool, outcome: &Outcome) -> Under {
        let PatchQuery { a, b, pose, doubt, .. } = self.query;
        let n = (self.parts[0].1 * outcome.normal).into_inner();
        let point = self.point(&self.witness(outcome));
        if is_of_a {
            a.under(self.patches[0], &point.point_on_a, &n, *doubt)
        } else {
            let down = -pose.rotation().tr_mul(&n);
            b.under(self.patches[1], &point.point_on_b, &down, *doubt)
        }
    }

    /// Returns the first point along an edge where a contact is fully valid on both bodies.
    ///
    /// The search starts at the vertex of an outcome. The contact is along the outcome's normal,
    /// and its distance is at most `level`.
    fn first_valid(
        &self,
        is_of_a: bool,
        outcome: &Outcome,
        edge: EdgeId,
        along: &Vector3<f64>,
        level: f64,
    ) -> Option<Outcome> {
        let n = self.parts[0].1 * outcome.normal;
        let at = |t: f64| {
            let mut moved = self.moved(is_of_a, outcome, along * t);
            *(if is_of_a {
                &mut moved.features.b
            } else {
                &mut moved.features.a
            }) = Feature::Edge(edge);
            moved
        };
        let height = |t: f64| self.witness(&at(t)).separation;
        let is_valid = |t: f64| {
            let place = self.witness(&at(t));
            self.is_on_parts(&place) && self.how_valid(&n, &self.point(&place)) == Valid::Fully
        };
        let (first, rise) = (height(0.0), height(1.0) - height(0.0));
        let end = if rise > level - first {
            (level - first) / rise
        } else {
            1.0
        };
        if !(end > 0.0) {
            return None;
        }
        let (mut off, mut on) = (0.0, SHORT_EDGE.smaller(end));
        while !is_valid(on) {
            if on >= end {
                return None;
            }
            (off, on) = (on, end.smaller(2.0 * on));
        }
        for _ in 0..EDGE_HALVINGS {
            let middle = 0.5 * (off + on);
            *(if is_valid(middle) { &mut on } else { &mut off }) = middle;
        }
        Some(at(on))
    }

    /// Returns an outcome along a face after the point on the other convex body moves.
    ///
    /// The step is in that body's frame.
    fn moved(&self, is_of_a: bool, outcome: &Outcome, step: Vector3<f64>) -> Outcome {
        let (n, rotation, mut moved) = (outcome.normal, self.pose.rotation(), *outcome);
        if is_of_a {
            let in_a = rotation * step;
            let rise = n.dot(&in_a);
            moved.distance += rise;
            moved.point_on_b += step;
            moved.point_on_a += in_a - *n * rise;
        } else {
            let rise = n.dot(&step);
            moved.distance -= rise;
            moved.point_on_a += step;
            moved.point_on_b += rotation.tr_mul(&(step - *n * rise));
        }
        (moved.lower, moved.upper) = (moved.distance, moved.distance);
        moved.state = if moved.distance > 0.0 {
            ContactState::Separated
        } else {
            ContactState::Overlapping
        };
        moved
    }

    /// Returns the closest points of an outcome of the cores as a contact of the convex bodies.
    fn witness(&self, outcome: &Outcome) -> ContactPoint {
        let [on_a, on_b] = [0, 1].each(|k| self.parts[k].0.rounding_radius());
        ContactPoint {
            point_on_a: outcome.point_on_a + *outcome.normal * on_a,
            point_on_b: outcome.point_on_b - self.pose.rotation().tr_mul(&outcome.normal) * on_b,
            separation: outcome.distance - on_a - on_b,
            features: outcome.features,
            id: outcome.features,
        }
    }
}

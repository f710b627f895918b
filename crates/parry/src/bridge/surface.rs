//! Contacts with a triangle of a mesh: an edge has no contact if a neighbour continues the mesh.

use super::contact::{ContactOptions, exchange};
use super::convex;
use super::known::Known;
use super::parry::math::{Pose, Real, Vector};
use super::parry::query::details::{NormalConstraints, NormalConstraintsPair};
use super::parry::query::{ContactManifold, TrackedContact};
use super::parry::shape::{Shape, Triangle};

/// Factor by which a contact along a corrected normal may be deeper than before. The other shape
/// may extend far along this normal, to another part of the mesh.
const MOST_BEYOND: Real = 5.0;

/// Least cosine between directions that count as equal.
const SAME: Real = 0.9999;

/// Distance outside a triangle at which a contact may be, divided by the extent of the pair.
///
/// Points of the engine are rounded, and two neighbours may both have a contact on their common
/// edge.
const ASIDE: Real = 1e-4;

/// The normals that the meshes allow, for the first and the second shape.
pub(super) type Constraints<'a> = [Option<&'a dyn NormalConstraints>; 2];

/// Corrects contacts that were computed without the rest of the mesh.
///
/// If the contact is within the triangle, the overlap is measured along the triangle's normal. If
/// the constraints reject a normal, the contact is removed.
pub(super) fn correct<M, C>(
    known: &Known,
    pos12: &Pose,
    (a, b): (&dyn Shape, &dyn Shape),
    constraints: Constraints,
    prediction: Real,
    options: &ContactOptions,
    out: &mut ContactManifold<M, C>,
) where
    M: Default + Clone + Send + Sync,
    C: Default + Copy + Send + Sync,
{
    let Some(least) = out.find_deepest_contact().map(|p| p.dist) else {
        return;
    };
    let own = out.local_n1;
    let (mut n1, mut n2) = (own, out.local_n2);
    let [first, second] = constraints;
    if !(first, second).project_local_normals(pos12, &mut n1, &mut n2) {
        out.clear();
        return;
    }
    let is_bound = first.or(second).is_some();
    if let Some(face) = Face::new(pos12, (a, b)) {
        let is_meant = if is_bound { face.is_along(n1) } else { least < 0.0 };
        if is_meant && !face.is_along(own) {
            let found = face.contacts(known, pos12, (a, b), prediction, options);
            let deepest = found.find_deepest_contact().map(|p| p.dist);
            if deepest.is_some_and(|d| d >= MOST_BEYOND * least.min(0.0) - prediction) {
                (out.local_n1, out.local_n2) = (found.local_n1, found.local_n2);
                exchange(out, |points| points.extend(found.points.iter().map(renewed)));
                return;
            }
        }
    }
    if n1 != own {
        (out.local_n1, out.local_n2) = (n1, n2);
        for p in &mut out.points {
            p.dist = (pos12 * p.local_p2 - p.local_p1).dot(n1);
        }
        out.points.retain(|p| least >= 0.0 || p.dist >= MOST_BEYOND * least);
    }
}

/// A contact without data.
fn renewed<C: Default + Copy>(p: &TrackedContact<()>) -> TrackedContact<C> {
    TrackedContact::new(p.local_p1, p.local_p2, p.fid1, p.fid2, p.dist)
}

/// A triangle of a pair, and its normal towards the other shape in the frame of the first.
struct Face {
    triangle: Triangle,
    is_first: bool,
    /// Normal of the triangle in its own frame.
    own: Vector,
    normal: Vector,
    /// Radius of a ball around the centre that contains all of the other shape that may touch the
    /// triangle.
    reach: Real,
}

impl Face {
    /// Returns `None` without a triangle that spans an area.
    fn new(pos12: &Pose, (a, b): (&dyn Shape, &dyn Shape)) -> Option<Self> {
        let (triangle, other, is_first) = match (a.as_triangle(), b.as_triangle()) {
            (Some(triangle), None) => (*triangle, b, true),
            (None, Some(triangle)) => (*triangle, a, false),
            _ => return None,
        };
        // Scaled first: squares of small areas underflow.
        let [u, v] = [triangle.b - triangle.a, triangle.c - triangle.a].map(Vector::normalize_or_zero);
        let own = u.cross(v).normalize_or_zero();
        if !(own.length() > 0.5) {
            return None;
        }
        let ball = other.compute_local_bounding_sphere();
        let at = if is_first { *pos12 } else { pos12.inverse() };
        let above = (at * ball.center - triangle.a).dot(own);
        let up = if above < 0.0 { -own } else { own };
        let normal = if is_first { up } else { -(pos12.rotation * up) };
        let corners = triangle.vertices().map(|p| (p - triangle.center()).length());
        let reach = corners.into_iter().fold(0.0, Real::max) + 4.0 * ball.radius;
        Some(Self {
            triangle,
            is_first,
            own,
            normal,
            reach,
        })
    }

    /// Returns whether a normal of the first shape is that of the face.
    fn is_along(&self, n1: Vector) -> bool {
        self.normal.dot(n1) > SAME
    }

    /// Returns the contacts of the other shape with the plane of the triangle that are within the
    /// triangle.
    fn contacts(
        &self,
        known: &Known,
        pos12: &Pose,
        (a, b): (&dyn Shape, &dyn Shape),
        prediction: Real,
        options: &ContactOptions,
    ) -> ContactManifold<(), ()> {
        let wide = self.widened();
        let mut found = ContactManifold::new();
        let shapes: (&dyn Shape, &dyn Shape) = if self.is_first { (&wide, b) } else { (a, &wide) };
        let is_answered = convex::write(known, pos12, shapes, prediction, options, &mut found);
        if !is_answered || !self.is_along(found.local_n1) {
            found.points.clear();
        }
        found
            .points
            .retain(|p| self.holds(if self.is_first { p.local_p1 } else { p.local_p2 }));
        found
    }

    /// Returns a triangle in the same plane that surrounds all points that may touch the triangle.
    fn widened(&self) -> Triangle {
        let u = (self.triangle.b - self.triangle.a).normalize_or_zero();
        let (v, centre, far) = (self.own.cross(u), self.triangle.center(), 2.0 * self.reach);
        let corner = |x: Real, y: Real| centre + (u * x + v * y) * far;
        let half = 0.866_025_4;
        Triangle::new(corner(1.0, 0.0), corner(-0.5, half), corner(-0.5, -half))
    }

    /// Returns whether a point of the plane is within the triangle, up to rounding.
    fn holds(&self, p: Vector) -> bool {
        let [a, b, c] = self.triangle.vertices();
        let inside = |from: &Vector, to: &Vector| {
            let inward = self.own.cross((*to - *from).normalize_or_zero());
            inward.dot(p - *from) >= -ASIDE * self.reach
        };
        inside(a, b) && inside(b, c) && inside(c, a)
    }
}

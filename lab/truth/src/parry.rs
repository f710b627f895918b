//! parry3d-f64 as a reference and as a rival.
//!
//! **Reference.** For bodies of size about 1 and `gap >= 1e-8` of it, the error of its distance is
//! at most [`tolerance`]. Its own hull drops points of flat bodies, so [`mesh`] and [`Cloud`] (its
//! GJK over our points, without a hull) are better references. It is no reference for overlapping
//! bodies.
//!
//! **Rival.** `parry3d_f64::query::distance` starts cold and scans all points in every step.
//! [`GjkCached`] is what an expert user would build from parry's public parts: its GJK, started
//! from the simplex of the last frame, over a support map that climbs along edges from the vertex
//! of the last frame.

pub mod casts;
mod climber;
mod maps;

use crate::shapes::triangles;
use crate::{Face, Point, Pose};
use parry3d_f64::math::{Rotation, Vector};
use parry3d_f64::query::details::{closest_points_support_map_support_map, contact_manifold_pfm_pfm_shapes};
use parry3d_f64::query::{self, ClosestPoints, Contact, ContactManifold, TrackedContact};
use parry3d_f64::shape::{ConvexPolyhedron, SupportMap};

pub use climber::{Climber, GjkCached};
pub use maps::{Core, Map, MapGjk};

/// Distance and witness points in the world frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Witnesses {
    /// Distance, computed by the engine in A's frame.
    pub distance: f64,
    /// Closest point of A.
    pub on_a: Point,
    /// Closest point of B.
    pub on_b: Point,
}

/// Returns the largest relative error of parry in `f64` for bodies of size about 1 at distance
/// `gap`.
pub fn tolerance(gap: f64) -> f64 {
    f64::max(6e-8, 1e-15 / gap)
}

fn vector(p: Point) -> Vector {
    Vector::new(p[0], p[1], p[2])
}

fn vectors(points: &[Point]) -> Vec<Vector> {
    points.iter().map(|&p| vector(p)).collect()
}

/// A pose in parry's types.
pub use parry3d_f64::math::Pose as ParryPose;

/// Returns the pose in parry's types.
pub fn pose(p: &Pose) -> ParryPose {
    ParryPose::from_parts(vector(p.t), Rotation::from_xyzw(p.q[0], p.q[1], p.q[2], p.q[3]))
}

/// A body of parry.
pub type Hull = ConvexPolyhedron;

/// Returns parry's hull of points; `None` if it fails. It may drop vertices and flatten thin
/// bodies.
pub fn hull(points: &[Point]) -> Option<ConvexPolyhedron> {
    ConvexPolyhedron::from_convex_hull(&vectors(points))
}

/// Returns parry's body of points and faces, triangulated; points that no face uses are kept.
pub fn mesh(points: &[Point], faces: &[Face]) -> Option<ConvexPolyhedron> {
    ConvexPolyhedron::from_convex_mesh(vectors(points), &triangles(faces))
}

/// Points as a body for parry's GJK: a support map by linear scan, without a hull, with nothing
/// merged.
#[derive(Clone, Debug)]
pub struct Cloud {
    points: Vec<Vector>,
}

impl Cloud {
    /// Returns the hull of `points`, which must not be empty.
    pub fn new(points: &[Point]) -> Self {
        Self {
            points: vectors(points),
        }
    }
}

impl SupportMap for Cloud {
    fn local_support_point(&self, dir: Vector) -> Vector {
        let better = |best: Vector, &p: &Vector| if p.dot(dir) > best.dot(dir) { p } else { best };
        self.points[1..].iter().fold(self.points[0], better)
    }
}

/// Returns parry's distance of two of its bodies, cold; 0 if they overlap.
pub fn distance(a: &ConvexPolyhedron, pose_a: &Pose, b: &ConvexPolyhedron, pose_b: &Pose) -> f64 {
    query::distance(&pose(pose_a), a, &pose(pose_b), b)
        .expect("convex bodies are supported")
        .distance
}

/// Returns whether two of parry's bodies share a point according to parry.
pub fn intersect(a: &ConvexPolyhedron, pose_a: &Pose, b: &ConvexPolyhedron, pose_b: &Pose) -> bool {
    query::intersection_test(&pose(pose_a), a, &pose(pose_b), b)
        .expect("convex bodies are supported")
        .intersecting
}

/// Returns the signed distance that a user of parry gets for two of its bodies, cold.
///
/// It is parry's distance or, if that is zero, the distance of its contact. A touch, and an overlap
/// for which parry finds no contact, are both 0.
pub fn signed_distance(a: &ConvexPolyhedron, pose_a: &Pose, b: &ConvexPolyhedron, pose_b: &Pose) -> f64 {
    let apart = distance(a, pose_a, b, pose_b);
    if apart != 0.0 {
        return apart;
    }
    let found = query::contact(&pose(pose_a), a, &pose(pose_b), b, 0.0).expect("convex bodies are supported");
    found.map_or(0.0, |c| c.dist)
}

/// Returns parry's closest points of two bodies (its own or [`Cloud`]s), cold; `None` if they
/// overlap.
pub fn closest_points<A: SupportMap, B: SupportMap>(a: &A, pose_a: &Pose, b: &B, pose_b: &Pose) -> Option<Witnesses> {
    let (world_a, world_b) = (pose(pose_a), pose(pose_b));
    match closest_points_support_map_support_map(&world_a.inv_mul(&world_b), a, b, f64::MAX) {
        // Both points are in their bodies' frames; the distance is computed in A's frame, where B's
        // offset has cancelled.
        ClosestPoints::WithinMargin(p, q) => {
            let distance = (world_a.inv_mul(&world_b) * q - p).length();
            Some(Witnesses {
                distance,
                on_a: (world_a * p).into(),
                on_b: (world_b * q).into(),
            })
        }
        _ => None,
    }
}

/// Returns parry's contact of two of its bodies, cold, with points and normals in the world frame.
///
/// `None` if they are more than `prediction` apart, or if parry fails.
pub fn contact(
    a: &ConvexPolyhedron,
    pose_a: &ParryPose,
    b: &ConvexPolyhedron,
    pose_b: &ParryPose,
    prediction: f64,
) -> Option<Contact> {
    query::contact(pose_a, a, pose_b, b, prediction).expect("convex bodies are supported")
}

/// parry's manifold of a pair, kept from frame to frame as rapier keeps it.
#[derive(Clone, Default)]
pub struct ContactPair {
    manifold: ContactManifold<(), ()>,
}

impl ContactPair {
    /// Returns the contacts of this frame, in the bodies' frames.
    ///
    /// If the motion is small, these are the last contacts with new distances; otherwise they are
    /// computed again.
    pub fn manifold(
        &mut self,
        a: &ConvexPolyhedron,
        pose_a: &ParryPose,
        b: &ConvexPolyhedron,
        pose_b: &ParryPose,
        prediction: f64,
    ) -> &[TrackedContact<()>] {
        contact_manifold_pfm_pfm_shapes(
            &pose_a.inv_mul(pose_b),
            a,
            b,
            None,
            None,
            prediction,
            &mut self.manifold,
        );
        self.manifold.contacts()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::{ContactState, solve};
    use crate::motion;
    use crate::pose::{norm, radius, sub};
    use crate::rng::Rng;
    use crate::shapes::{self, Shape};

    fn agree(d: f64, truth: f64) -> bool {
        (d - truth).abs() <= tolerance(truth) * truth
    }

    #[test]
    fn all_ways_agree_with_the_oracle() {
        let mut r = Rng::new(21);
        let mut compared = 0;
        for k in 0..40 {
            let (na, nb) = (5 + k % 6, 5 + k % 4);
            let (a, b) = (shapes::sphere(&mut r, na).solved(), shapes::sphere(&mut r, nb).solved());
            let f = motion::random_poses(&mut r, 1, (1.0, 1.0), (0.6, 1.2), 1.0)[0];
            let truth = solve((&a).into(), &f.a, (&b).into(), &f.b);
            let own = (mesh(&a.points, &a.faces).unwrap(), mesh(&b.points, &b.faces).unwrap());
            let clouds = closest_points(&Cloud::new(&a.points), &f.a, &Cloud::new(&b.points), &f.b);
            let climbers = (Climber::new(&a.points, &a.faces), Climber::new(&b.points, &b.faces));
            let cached = GjkCached::default().closest(&climbers.0, &f.a, &climbers.1, &f.b);
            if truth.state == ContactState::Separated && truth.distance > 1e-3 {
                compared += 1;
                assert!(agree(distance(&own.0, &f.a, &own.1, &f.b), truth.distance));
                for w in [clouds, cached, closest_points(&own.0, &f.a, &own.1, &f.b)].map(Option::unwrap) {
                    assert!(agree(w.distance, truth.distance));
                    assert!((norm(sub(w.on_a, w.on_b)) - truth.distance).abs() < 1e-9);
                }
            } else if truth.distance < -1e-3 {
                assert!(clouds.is_none() && cached.is_none());
            }
        }
        assert!(compared > 10, "{compared}");
    }

    #[test]
    fn the_cache_changes_the_time_only() {
        let ball = shapes::icosphere(2);
        let can = shapes::prism(24, 1.0, 0.8);
        let body = |s: &Shape| (Climber::new(&s.points, &s.faces), Cloud::new(&s.points));
        let ((a, cloud_a), (b, cloud_b)) = (body(&ball), body(&can));
        let mut cache = GjkCached::default();
        let radii = (radius(&ball.points), radius(&can.points));
        let mut r = Rng::new(22);
        let mut frames = motion::orbit_and_spin(&mut r, 300, 2.0, radii, (-0.2, 0.5), 100);
        frames.extend(motion::pass_through(&mut r, 200, radii, 0.1));
        for f in &frames {
            let cold = closest_points(&cloud_a, &f.a, &cloud_b, &f.b).map_or(0.0, |w| w.distance);
            let warm = cache.closest(&a, &f.a, &b, &f.b).map_or(0.0, |w| w.distance);
            assert!((cold - warm).abs() <= 1e-7 * cold.max(1e-5), "{cold} {warm}");
        }
    }

    #[test]
    fn hulls_of_plain_points_are_built() {
        let s = shapes::sphere(&mut Rng::new(24), 50);
        assert_eq!(hull(&s.points).unwrap().points().len(), 50);
    }
}

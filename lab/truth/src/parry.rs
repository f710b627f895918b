//! parry3d-f64 as reference, and as the competitor that counts.
//!
//! **Reference.** Within its envelope (bodies of about size 1, `gap >= 1e-8` of it) its distance errs by at most
//! [`tolerance`]. Its own hull drops points of flat bodies, so [`mesh`] and [`Cloud`] (its GJK over our points, no hull at
//! all) are the better references. For overlapping bodies it is none.
//!
//! **Competitor.** `parry3d_f64::query::distance` starts cold and scans all points at every step. [`GjkCached`] is what a
//! user who cares would build from parry's public parts: its GJK, fed with the simplex of the last frame, over a support
//! map that climbs along edges from the last frame's vertex.

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

/// Distance and witness points in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Witnesses {
    /// Distance as the engine finds it in A's frame.
    pub distance: f64,
    /// Closest point of A.
    pub on_a: Point,
    /// Closest point of B.
    pub on_b: Point,
}

/// Relative error that parry f64 may have on bodies of size about 1 at distance `gap`.
pub fn tolerance(gap: f64) -> f64 {
    f64::max(6e-8, 1e-15 / gap)
}

fn vector(p: Point) -> Vector {
    Vector::new(p[0], p[1], p[2])
}

fn vectors(points: &[Point]) -> Vec<Vector> {
    points.iter().map(|&p| vector(p)).collect()
}

/// A pose of parry's own.
pub use parry3d_f64::math::Pose as ParryPose;

/// The pose in parry's types.
pub fn pose(p: &Pose) -> ParryPose {
    ParryPose::from_parts(vector(p.t), Rotation::from_xyzw(p.q[0], p.q[1], p.q[2], p.q[3]))
}

/// A body of parry's own.
pub type Hull = ConvexPolyhedron;

/// The body parry makes of points: `None` where its hull gives up. It may drop vertices and flatten thin bodies.
pub fn hull(points: &[Point]) -> Option<ConvexPolyhedron> {
    ConvexPolyhedron::from_convex_hull(&vectors(points))
}

/// The body parry makes of points and faces, cut into triangles; points that no face uses stay.
pub fn mesh(points: &[Point], faces: &[Face]) -> Option<ConvexPolyhedron> {
    ConvexPolyhedron::from_convex_mesh(vectors(points), &triangles(faces))
}

/// Points as a body for parry's GJK: a support map by linear scan, no hull, nothing merged.
#[derive(Clone, Debug)]
pub struct Cloud {
    points: Vec<Vector>,
}

impl Cloud {
    /// The hull of `points`, which are not empty.
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

/// parry's own distance of two of its bodies, cold; 0 when overlapping.
pub fn distance(a: &ConvexPolyhedron, pose_a: &Pose, b: &ConvexPolyhedron, pose_b: &Pose) -> f64 {
    query::distance(&pose(pose_a), a, &pose(pose_b), b)
        .expect("convex bodies are supported")
        .distance
}

/// Whether parry finds two of its bodies to share a point.
pub fn intersect(a: &ConvexPolyhedron, pose_a: &Pose, b: &ConvexPolyhedron, pose_b: &Pose) -> bool {
    query::intersection_test(&pose(pose_a), a, &pose(pose_b), b)
        .expect("convex bodies are supported")
        .intersecting
}

/// What a user of parry gets for a signed distance of two of its bodies, cold: its distance, and where that is zero, its
/// contact. A touch and an overlap that it finds no contact of are both 0.
pub fn signed_distance(a: &ConvexPolyhedron, pose_a: &Pose, b: &ConvexPolyhedron, pose_b: &Pose) -> f64 {
    let apart = distance(a, pose_a, b, pose_b);
    if apart != 0.0 {
        return apart;
    }
    let found = query::contact(&pose(pose_a), a, &pose(pose_b), b, 0.0).expect("convex bodies are supported");
    found.map_or(0.0, |c| c.dist)
}

/// parry's closest points of two bodies (its own or [`Cloud`]s), cold; `None` when overlapping.
pub fn closest_points<A: SupportMap, B: SupportMap>(a: &A, pose_a: &Pose, b: &B, pose_b: &Pose) -> Option<Witnesses> {
    let (world_a, world_b) = (pose(pose_a), pose(pose_b));
    match closest_points_support_map_support_map(&world_a.inv_mul(&world_b), a, b, f64::MAX) {
        // Both come in their own frames; the distance is taken in A's frame, where B's offset has cancelled.
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

/// parry's contact of two of its bodies, cold, points and normals in the world; `None` where they are more than `prediction`
/// apart, or where it fails.
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
    /// The contacts of this frame, in the bodies' frames: the last ones with new distances where the motion since is small,
    /// else made anew.
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

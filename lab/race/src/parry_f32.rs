//! parry3d in `f32`: what single precision saves and costs.
//!
//! Bodies and world poses are rounded to `f32` first, as a user of that crate has them.

use parry3d::math::{Pose as ParryPose, Rotation, Vector};
use parry3d::query::ClosestPoints;
use parry3d::query::details::closest_points_support_map_support_map;
use parry3d::shape::ConvexPolyhedron;
use truth::parry::Witnesses;
use truth::shapes::triangles;
use truth::{Face, Point, Pose};

/// A body of parry.
pub type Hull = ConvexPolyhedron;

fn vector(p: Point) -> Vector {
    let [x, y, z] = p.map(|c| c as f32);
    Vector::new(x, y, z)
}

fn point(v: Vector) -> Point {
    [v.x, v.y, v.z].map(f64::from)
}

fn pose(p: &Pose) -> ParryPose {
    let [x, y, z, w] = p.q.map(|c| c as f32);
    ParryPose::from_parts(vector(p.t), Rotation::from_xyzw(x, y, z, w).normalize())
}

/// Returns parry's body of points and faces, triangulated.
pub fn mesh(points: &[Point], faces: &[Face]) -> Option<ConvexPolyhedron> {
    ConvexPolyhedron::from_convex_mesh(points.iter().map(|&p| vector(p)).collect(), &triangles(faces))
}

/// Returns parry's closest points, cold; `None` if the bodies overlap.
pub fn closest_points(a: &Hull, pose_a: &Pose, b: &Hull, pose_b: &Pose) -> Option<Witnesses> {
    let (world_a, world_b) = (pose(pose_a), pose(pose_b));
    let a_from_b = world_a.inv_mul(&world_b);
    let ClosestPoints::WithinMargin(p, q) = closest_points_support_map_support_map(&a_from_b, a, b, f32::MAX) else {
        return None;
    };
    Some(Witnesses {
        distance: f64::from((a_from_b * q - p).length()),
        on_a: point(world_a * p),
        on_b: point(world_b * q),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use truth::shapes;

    #[test]
    fn two_boxes() {
        let b = shapes::cuboid([0.5; 3]);
        let hull = mesh(&b.points, &b.faces).unwrap();
        let w = closest_points(&hull, &Pose::IDENTITY, &hull, &Pose::shift([3.0, 0.0, 0.0])).unwrap();
        assert!((w.distance - 2.0).abs() < 1e-6 && (w.on_a[0] - 0.5).abs() < 1e-6);
        assert!(closest_points(&hull, &Pose::IDENTITY, &hull, &Pose::shift([0.1, 0.0, 0.0])).is_none());
    }
}

//! Searches against brute force over all pairs of triangles.

extern crate std;
use std::vec::Vec;

use lab::rng::Rng;
use lab::soups::{self, Soup};
use lab::{Pose, brute};
use nalgebra::Point3;

use super::mesh::{Mesh, MeshKind};
use super::tracker::MeshTracker;
use crate::closest::outcome::Class;
use crate::pose::RelativePose;

fn mesh(soup: &Soup) -> Mesh {
    let points: Vec<Point3<f64>> = soup.points.iter().map(|p| Point3::from(*p)).collect();
    Mesh::new(&points, &soup.triangles).unwrap()
}

fn relative(pose: &Pose) -> RelativePose {
    RelativePose::from_isometry(&pose.isometry()).unwrap()
}

#[test]
fn made_meshes_are_closed() {
    let closed = [
        soups::torus(20, 10, 0.3),
        soups::knot(60, 8, 0.12),
        soups::sphere(2),
        soups::rock(3, 1),
        soups::gear(12),
        soups::screw(4, 24),
        soups::plate(3, [1.0, 0.5, 0.1]),
        soups::bracket(),
    ];
    for (k, soup) in closed.iter().enumerate() {
        let m = mesh(soup);
        assert_eq!(m.kind(), MeshKind::Solid, "{k}: {}", m.report());
        assert!(m.report().parts.iter().all(|p| p.volume > 0.0), "{k}: {}", m.report());
    }
}

#[test]
fn distances_are_those_of_brute_force() {
    let shapes = [
        soups::torus(24, 12, 0.3),
        soups::knot(60, 8, 0.12),
        soups::rock(3, 1),
        soups::gear(12),
        soups::bracket(),
        soups::screw(4, 24),
    ];
    let meshes: Vec<Mesh> = shapes.iter().map(mesh).collect();
    let mut rng = Rng::new(5);
    let mut apart = 0;
    for k in 0..600 {
        let (i, j) = (rng.below(6), rng.below(6));
        let pose = Pose {
            q: rng.quat(),
            t: rng.unit().map(|x| x * rng.range(0.3, 3.0)),
        };
        let truth = brute::distance(&shapes[i], &shapes[j], &pose).0;
        let mut tracker = MeshTracker::new();
        let found = tracker.closest(&meshes[i], &meshes[j], &relative(&pose));
        if found.class == Class::Separated {
            apart += 1;
            assert!(
                (found.distance - truth).abs() < 1e-14 * 10.0,
                "{k}: {i} {j}: {} {truth}",
                found.distance
            );
            assert!(found.lower <= truth + 1e-15 && truth <= found.upper + 1e-15);
        } else {
            let contained = truth > 0.0;
            assert_eq!(found.distance, 0.0, "{k} {i} {j} {truth} {contained}");
        }
    }
    assert!(apart > 200, "{apart}");
}

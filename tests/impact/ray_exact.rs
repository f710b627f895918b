//! Promise: no ray is answered wrongly, in planes of faces, along edges and at poses off unit
//! length.

use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, UnitQuaternion, Vector3};
use lin_canny::scene::{Body, Scene};
use lin_canny::{ConvexPolyhedron, HalfSpace, Mesh, Ray, RayCast, RayCaster};
use truth::driven::played;
use truth::driven::rays::{self, EACH};

/// Plays bodies of all kinds with about `asked` rays.
fn judge(asked: u64, seed: u64) {
    let mix = played(seed..seed + asked / EACH, rays::play);
    println!("misses, hits, inside, undecided: {:?}", mix.rays);
    for counts in &mix.rays {
        assert!(counts[..3].iter().all(|n| *n > asked / 250), "{mix:?}");
    }
    // Exact answers are decided.
    assert!(mix.rays[..3].iter().all(|counts| counts[3] == 0), "{mix:?}");
}

#[test]
fn thousands_of_rays_are_answered_as_by_exact_arithmetic() {
    judge(6_000, 97_000);
}

#[test]
#[ignore = "a million rays, minutes: cargo test --release --all-features --test impact a_million_rays -- --ignored --nocapture"]
fn a_million_rays_are_answered_as_by_exact_arithmetic() {
    judge(1_000_000, 2_000_000);
}

fn ray(origin: [f64; 3], way: [f64; 3]) -> Ray {
    Ray::new(Point3::from(origin), Vector3::from(way)).expect("a direction")
}

#[test]
fn a_ray_in_the_plane_of_a_polygon_hits_it() {
    let here = Isometry3::identity();
    for count in 3..16 {
        // Points of a parabola; the first edge is along x. The last edge leads back to the start.
        let corner = |k: i32| {
            let x = f64::from(k) - 0.5;
            Point3::new(x, x * x, 0.0)
        };
        let corners: Vec<_> = (0..count).map(corner).collect();
        let body = ConvexPolyhedron::polygon(&corners).expect("a polygon");
        let along = ray([-3.0, 0.25, 0.0], [1.0, 0.0, 0.0]);
        let within = ray([-3.0, 1.0, 0.0], [1.0, 0.0, 0.0]);
        let entry = 2.5 + 0.75 / f64::from(count - 2);
        for (ray, least) in [(along, 2.5), (within, entry)] {
            let found = RayCaster::new().cast(&body, &here, &ray, f64::INFINITY).expect("a ray");
            let RayCast::Hit(hit) = found else {
                panic!("{count}: {found:?}")
            };
            assert!(hit.safe <= least && hit.hit >= least - 1e-15, "{count}: {hit:?}");
            let mut scene = Scene::new();
            scene.insert(Body::moving(body.clone()), here).expect("a body");
            scene.step();
            let found = scene.cast_ray(&ray, f64::INFINITY, |_| true).expect("a ray");
            assert!(
                found.is_some_and(|(_, cast)| cast.safe().is_some()),
                "{count}: {found:?}"
            );
        }
    }
}

/// Both sides of a sheet are a closed mesh, whose triangles are all in one plane.
#[test]
fn a_ray_in_the_plane_of_a_closed_sheet_hits_it() {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]].map(Point3::from);
    let sheet = Mesh::new(&corners, &[[0, 1, 2], [0, 2, 3], [0, 2, 1], [0, 3, 2]]).expect("a sheet");
    let found = RayCaster::new().cast(
        &sheet,
        &Isometry3::identity(),
        &ray([-1.0, 0.5, 0.0], [1.0, 0.0, 0.0]),
        9.0,
    );
    let Ok(RayCast::Hit(hit)) = found else {
        panic!("{found:?}")
    };
    assert!(hit.safe <= 1.0 && 1.0 <= hit.hit, "{hit:?}");
}

#[test]
fn a_half_space_off_unit_length_is_entered_at_its_plane() {
    let floor = HalfSpace::new(Vector3::z(), 0.0).expect("a plane");
    for by in [1.0, 1.0 + 4.9e-13, 1.0 - 4.9e-13] {
        let turn = UnitQuaternion::new_unchecked(Quaternion::new(0.5, 0.5, 0.5, 0.5) * by);
        let pose = Isometry3::from_parts(Vector3::zeros().into(), turn);
        // The normal is along x.
        let found = RayCaster::new().cast(&floor, &pose, &ray([1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]), 9.0);
        let Ok(RayCast::Hit(hit)) = found else {
            panic!("{by}: {found:?}")
        };
        assert!(hit.safe <= 1.0 && 1.0 <= hit.hit, "{by}: {hit:?}");
        assert!((hit.normal.norm() - 1.0).abs() < 1e-15, "{hit:?}");
        assert!(hit.normal.x > 1.0 - 1e-15, "{hit:?}");
    }
}

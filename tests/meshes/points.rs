//! Promise: exact arithmetic decides a point next to a closed mesh, and a ray next to or through
//! one.

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, Change, PairQueries, Scene};
use lin_canny::{
    Compound, ContactState, ConvexPolyhedron, Geometry, Mesh, PairTracker, Ray, RayCast, RayCaster, RelativePose,
};
use truth::driven::{played, points};
use truth::rng::Rng;

fn cube(size: f64) -> Geometry {
    let hull = solids::cuboid(Vector3::repeat(size)).expect("a cube");
    Geometry::from(Mesh::from_convex(&hull).expect("a mesh"))
}

fn point(x: f64, y: f64, z: f64) -> ConvexPolyhedron {
    ConvexPolyhedron::point(Point3::new(x, y, z)).expect("a point")
}

/// Location of a body that does not cross a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    Outside,
    On,
    Inside,
}

/// Runs all queries of a body next to a mesh, in both orders.
fn ask(mesh: &Geometry, body: &Geometry, pose: &RelativePose, place: Place, told: &str) {
    for (a, b, pose) in [(mesh, body, *pose), (body, mesh, pose.swapped())] {
        let mut tracker = PairTracker::new();
        let met = place != Place::Outside;
        assert_eq!(tracker.intersects(a, b, &pose), met, "{told}: intersects");
        assert_eq!(tracker.within(a, b, &pose, 0.0), met, "{told}: within");
        let found = tracker.closest(a, b, &pose);
        let allowed: &[ContactState] = match place {
            Place::Outside => &[ContactState::Separated, ContactState::Touching],
            Place::On => &[ContactState::Touching],
            Place::Inside => &[ContactState::Touching, ContactState::Overlapping],
        };
        assert!(allowed.contains(&found.state), "{told}: {found:?}");
        assert!(!met || found.lower <= 0.0, "{told}: {found:?}");
        let bound = tracker.lower_bound(a, b, &pose);
        assert!(!met || bound <= 0.0, "{told}: {bound:e}");
        // Warm, the same.
        assert_eq!(tracker.intersects(a, b, &pose), met, "{told}: intersects, warm");
    }
}

fn at_rest() -> RelativePose {
    RelativePose::from_isometry(&Isometry3::identity()).expect("a pose")
}

#[test]
fn a_point_next_to_a_face_is_on_its_side_of_it() {
    for size in [1.0, 1024.0, 1e-100, 1e-30, 1e30, 1e99] {
        let mesh = cube(size);
        for part in [2.3e-16, 1e-15, 1e-14, 1e-13, 2e-13] {
            for (z, place) in [
                (size * (1.0 + part), Place::Outside),
                (size, Place::On),
                (size * (1.0 - part), Place::Inside),
            ] {
                let p = point(0.2 * size, 0.25 * size, z);
                let piece = Compound::from(lin_canny::Shape::from(p.clone()));
                let bodies = [Geometry::from(p), Geometry::from(piece)];
                for body in bodies {
                    ask(&mesh, &body, &at_rest(), place, &format!("{size:e} {part:e} {place:?}"));
                }
            }
        }
    }
}

#[test]
fn bodies_smaller_than_rounding_are_on_their_side_of_a_face() {
    let mesh = cube(1.0);
    for gap in [4e-16, 1e-15, 1e-14, 1e-13, 1e-12] {
        for size in [1e-15, 1e-14, 1e-13, 1e-12] {
            for (z, way, place) in [(1.0 + gap, 1.0, Place::Outside), (1.0 - gap, -1.0, Place::Inside)] {
                let corner = Point3::new(0.2, 0.25, z);
                let to = |x: f64, y: f64, h: f64| corner + Vector3::new(x, y, h * way) * size;
                let points = [corner, to(1.0, 0.0, 0.5), to(0.0, 1.0, 0.5), to(0.0, 0.0, 1.0)];
                if points.iter().skip(1).any(|p| p.z == z) {
                    continue;
                }
                let hull = ConvexPolyhedron::from_points(&points).expect("a hull");
                let small = Mesh::from_convex(&hull).expect("a mesh");
                let segment = ConvexPolyhedron::segment(corner, points[3]).expect("a segment");
                for body in [Geometry::from(hull), Geometry::from(small), Geometry::from(segment)] {
                    let told = format!("{:?} {gap:e} {size:e} {place:?}", body.kind());
                    ask(&mesh, &body, &at_rest(), place, &told);
                }
            }
        }
    }
}

#[test]
fn a_scene_tells_a_point_next_to_a_mesh_from_one_in_it() {
    for (z, met) in [(1.0 + 1e-14, false), (1.0, true), (1.0 - 1e-14, true)] {
        let mut scene = Scene::with_queries(PairQueries::none().overlap(true)).expect("queries");
        let here = Isometry3::identity();
        scene.insert(Body::moving(cube(1.0)), here).expect("a body");
        scene.insert(Body::moving(point(0.2, 0.2, z)), here).expect("a body");
        scene.step();
        let began = scene.events().iter().any(|e| e.change == Change::OverlapBegan);
        assert_eq!(began, met, "{z}");
    }
}

#[test]
fn a_ray_next_to_a_face_has_no_hit() {
    let mesh = cube(1.0);
    let still = Isometry3::identity();
    for gap in [2.3e-16, 1e-15, 1e-14, 1e-13, 1e-12] {
        for y in [0.2, 1.0, 1.0 - 1e-14, 1.0 + 1e-14] {
            for length in [1.0, 2.0, 4.0, f64::INFINITY] {
                let ray = Ray::new(Point3::new(3.0, y, 1.0 + gap), -Vector3::x()).expect("a ray");
                let found = RayCaster::new().cast(&mesh, &still, &ray, length).expect("a cast");
                assert!(
                    matches!(found, RayCast::Undecided { .. } | RayCast::Miss),
                    "{gap:e} {y} {length}: {found:?}"
                );
            }
        }
    }
}

/// The cast of a moving point left every one of these rays undecided, or with a wide bracket.
#[test]
fn a_ray_in_the_plane_of_a_face_meets_the_edge_in_front() {
    let still = Isometry3::identity();
    let hull = Geometry::from(solids::cuboid(Vector3::repeat(1.0)).expect("a cube"));
    for body in [cube(1.0), hull] {
        for y in [0.2, 1.0, -1.0] {
            let ray = Ray::new(Point3::new(3.0, y, 1.0), -Vector3::x()).expect("a ray");
            let found = RayCaster::new().cast(&body, &still, &ray, f64::INFINITY);
            let Ok(RayCast::Hit(hit)) = found else {
                panic!("{y}: {found:?}")
            };
            assert!(hit.safe < 2.0, "{hit:?}");
            assert!(2.0 <= hit.hit, "{hit:?}");
            assert!(hit.hit - hit.safe < 1e-10, "{hit:?}");
        }
    }
}

/// A solid as a hull and as a mesh, whose rays are decided by different code.
#[test]
fn an_origin_next_to_a_face_of_a_hull_is_on_its_side_of_it() {
    let mut rng = Rng::new(71);
    let mut counts = [0; 3];
    let cube = solids::cuboid(Vector3::new(1.0, 0.5, 2.0)).expect("a cuboid");
    let two = [
        Geometry::from(Mesh::from_convex(&cube).expect("a mesh")),
        Geometry::from(cube),
    ];
    for k in 0..3000 {
        let turn = if k % 4 == 0 { [0.0, 0.0, 0.0, 1.0] } else { rng.quat() };
        let t = if k % 3 == 0 {
            [0.0; 3]
        } else {
            rng.in_ball().map(|x| 10.0 * x)
        };
        let at = truth::Pose::new(turn, t);
        let height = [0.0, rng.log_range(1e-17, 1e-14), -rng.log_range(1e-17, 1e-14)][k % 3];
        let [x, y] = [rng.range(-1.0, 1.0), rng.range(-0.5, 0.5)];
        let origin = Point3::from(at.apply([x, y, 2.0 + height]));
        let ray = Ray::new(origin, Vector3::from(rng.unit())).expect("a ray");
        let found = two.each_ref().map(|body| {
            let found = RayCaster::new().cast(body, &at.isometry(), &ray, f64::INFINITY);
            match found.expect("a cast") {
                RayCast::Miss => 0,
                RayCast::Hit(_) => 1,
                RayCast::Inside => 2,
                other => panic!("{k}: {other:?}"),
            }
        });
        assert_eq!(found[0], found[1], "{k}: {ray:?} {at:?}");
        counts[found[0]] += 1;
    }
    assert!(counts.iter().all(|n| *n > 100), "{counts:?}");
}

fn check(count: u64, least: u64) {
    let mix = played(0..count, points::play);
    let counts = [
        &mix.points[..],
        &mix.small,
        &mix.rays,
        &[mix.through, mix.grazing],
        &mix.hull_rays[..3],
    ];
    assert!(counts.concat().iter().all(|count| *count >= least), "{mix:?}");
}

#[test]
fn random_points_and_rays_next_to_meshes_are_decided() {
    check(170, 20);
}

/// The bounds of an origin just outside a hull contain zero.
///
/// Triangles of a mesh may be smaller than the least extent of a body, and are decided like
/// triangles of any size.
#[test]
fn spikes_smaller_than_a_body_may_be_are_decided() {
    points::play(17_587_455_744_622_523_356).expect("an answer that is right");

    let mut rng = Rng::new(7);
    let small = 2f64.powi(-331);
    let mut counts = [0; 2];
    for k in 0..400 {
        let tip = Point3::new(0.5, 0.5, 0.5);
        let size = rng.log_range(1e-15, 1e-3);
        // A base next to the corner of a cube, and an apex outside the cube.
        let mut near = || tip + Vector3::from(rng.in_ball()) * size;
        let corners = [near(), near(), near(), Point3::new(1.5, 1.25, 1.0)];
        let Ok(spike) = ConvexPolyhedron::from_points(&corners) else {
            continue;
        };
        let answers = [1.0, small].map(|scale| {
            let scaled = |body: &ConvexPolyhedron| {
                let points: Vec<_> = body.vertex_points().map(|p| p * scale).collect();
                ConvexPolyhedron::from_points(&points).expect("a body")
            };
            let block = scaled(&solids::cuboid(Vector3::repeat(0.5)).expect("a cube"));
            let spike = scaled(&spike);
            let mesh = |body| Geometry::from(Mesh::from_convex(body).expect("a mesh"));
            let bodies = [mesh(&block), mesh(&spike), Geometry::from(spike), Geometry::from(block)];
            [(0, 1), (1, 0), (0, 2), (1, 3), (3, 1)].map(|(i, j)| {
                let mut tracker = PairTracker::new();
                let met = tracker.intersects(&bodies[i], &bodies[j], &at_rest());
                let near = tracker.within(&bodies[i], &bodies[j], &at_rest(), size * scale / 8.0);
                let found = tracker.closest(&bodies[i], &bodies[j], &at_rest());
                assert!(found.upper - found.lower < 1e-12 * scale || met, "{k}: {found:?}");
                (met, near)
            })
        });
        assert_eq!(answers[0], answers[1], "{k}: {corners:?}");
        assert!(answers[0].iter().all(|a| a.0 == answers[0][0].0), "{k}: {answers:?}");
        counts[usize::from(answers[0][0].0)] += 1;
    }
    assert!(counts.iter().all(|n| *n > 50), "{counts:?}");
}

#[test]
fn a_ray_that_begins_a_hair_outside_a_hull_misses() {
    points::play(5779).expect("an answer that is right");
}

#[test]
#[ignore = "minutes: 100,000 points and as many rays; cargo test --release --test meshes many_points -- --ignored"]
fn many_points_and_rays_next_to_meshes_are_decided() {
    check(17_000, 2_000);
}

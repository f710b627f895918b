//! Bounds of the penetration depth of a mesh and a compound.
//!
//! They are compared with the certified depth of two convex shapes, and with a grid of translations
//! judged by brute force.

use super::pieces::soup;
use super::{mesh, relative};
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{Compound, ContactState, GeometryRef, Mesh, PairTracker, PenetrationBounds, RelativePose, Shape};
use truth::forms::shapes;
use truth::pose::{norm, scale};
use truth::rng::Rng;
use truth::soups::{self, Soup};
use truth::support::piece_at;
use truth::{Pose, brute};

fn penetration(a: GeometryRef, b: GeometryRef, at: &RelativePose) -> PenetrationBounds {
    PairTracker::new().penetration(a, b, at).expect("two solids")
}

#[test]
fn convex_meshes_and_shapes_of_every_kind_have_their_depth_between_the_bounds() {
    let bodies = [
        solids::cuboid(Vector3::new(0.8, 0.7, 0.6)).unwrap(),
        solids::geodesic_sphere(2, 0.8).unwrap(),
        solids::random_hull(40, Vector3::new(0.9, 0.8, 0.7), 3).unwrap(),
    ];
    let shapes = shapes([0.2, 0.3, 0.4]);
    let mut rng = Rng::new(12);
    let mut tally = vec![[0; 2]; shapes.len()];
    for k in 0..50 * shapes.len() {
        let (body, shape) = (&bodies[k % 3], &shapes[k % shapes.len()]);
        let own = Pose::new(rng.quat(), scale(rng.unit(), 0.3));
        let placed = piece_at(own.isometry(), shape.clone());
        let (m, pieces) = (Mesh::from_convex(body).unwrap(), Compound::new(vec![placed]).unwrap());
        let pose = Pose::new(rng.quat(), scale(rng.unit(), rng.range(0.2, 1.2)));
        let of_shape = RelativePose::from_isometry(&(pose.isometry() * own.isometry())).unwrap();
        let truth = PairTracker::new().closest(&Shape::from(body.clone()), shape, &of_shape);
        let (there, back) = (relative(&pose), relative(&pose).swapped());
        let both = [
            penetration(GeometryRef::from(&m), GeometryRef::from(&pieces), &there),
            penetration(GeometryRef::from(&pieces), GeometryRef::from(&m), &back),
        ];
        for found in both {
            if truth.state == ContactState::Separated {
                assert_eq!((found.lower, found.upper), (0.0, 0.0), "{k} {truth:?}");
                continue;
            }
            let depth = [-truth.upper - 1e-12, -truth.lower + 1e-12];
            assert!(found.lower <= depth[1], "{k} {found:?} {truth:?}");
            assert!(depth[0] <= found.upper, "{k} {found:?} {truth:?}");
            tally[k % shapes.len()][0] += 1;
            tally[k % shapes.len()][1] += usize::from(found.lower > 0.9 * depth[0]);
        }
    }
    println!("met, and lower bounds above 0.9 of the depth: {tally:?}");
    // In deep overlaps of boxes with crossing edges, no point is as deep as the bodies.
    assert!(tally.iter().all(|t| t[0] >= 40 && 3 * t[1] > t[0]), "{tally:?}");
    // The deepest point of a ball is found at any pose.
    assert!(tally[0][1] == tally[0][0], "{tally:?}");
}

/// Returns whether two closed meshes share interior points, by brute force.
fn meets((a, b): (&Soup, &Soup), pose: &Pose) -> bool {
    let inside = |s: &Soup, p| brute::winding(s, p).abs() > 0.5;
    brute::distance(a, b, pose).0 == 0.0
        || inside(a, pose.apply(b.points[0]))
        || inside(b, pose.apply_inverse(a.points[0]))
}

/// Returns the shortest translation of a grid that separates two meshes, at most `most` long.
fn shortest(soups: (&Soup, &Soup), pose: &Pose, most: f64, steps: i32) -> f64 {
    let axis = |k: i32| most * f64::from(k) / f64::from(steps);
    let mut best = most;
    for x in -steps..=steps {
        for y in -steps..=steps {
            for z in -steps..=steps {
                let by = [axis(x), axis(y), axis(z)];
                let moved = pose.shifted(by);
                if norm(by) < best && !meets(soups, &moved) {
                    best = norm(by);
                }
            }
        }
    }
    best
}

#[test]
fn bounds_of_a_mesh_and_pieces_hold_beside_a_grid_of_translations() {
    let beam = |x: f64, turn: f64| {
        piece_at(
            Isometry3::new(Vector3::new(x, 0.0, 0.0), Vector3::z() * turn),
            Shape::cuboid(Vector3::new(0.4, 0.1, 0.15)).unwrap(),
        )
    };
    let cross = Compound::new(vec![beam(0.0, 0.0), beam(0.1, 1.4)]).unwrap();
    let crossed = soup(&cross);
    let shapes = [soups::bracket(), soups::plate(1, [0.5, 0.4, 0.2]), soups::gear(4)];
    let mut rng = Rng::new(21);
    let (mut met, mut lower, mut upper) = (0, 0, 0);
    for k in 0..18 {
        let base = &shapes[k % 3];
        let m = mesh(base);
        let pose = Pose::new(rng.quat(), scale(rng.unit(), rng.range(0.2, 0.7)));
        let found = penetration(GeometryRef::from(&m), GeometryRef::from(&cross), &relative(&pose));
        assert_eq!(found.upper > 0.0, meets((base, &crossed), &pose), "{k} {found:?}");
        if found.upper == 0.0 {
            continue;
        }
        met += 1;
        let back = penetration(
            GeometryRef::from(&cross),
            GeometryRef::from(&m),
            &relative(&pose).swapped(),
        );
        for o in [found, back] {
            assert!(0.0 <= o.lower && o.lower <= o.upper, "{k} {o:?}");
        }
        let free = pose.shifted(found.shift.into());
        assert!(!meets((base, &crossed), &free), "{k} {found:?}");
        let truth = shortest((base, &crossed), &pose, found.upper.min(back.upper), 6);
        assert!(found.lower.max(back.lower) <= truth, "{k} {found:?} {back:?} {truth}");
        lower += usize::from(found.lower > 0.8 * truth);
        upper += usize::from(found.upper < 1.05 * truth);
    }
    println!("{met} met; lower bounds above 0.8 of the grid's: {lower}, upper ones below 1.05: {upper}");
    assert!(met > 12, "{met}");
}

#[test]
fn a_surface_has_no_depth_and_a_body_inside_has_the_way_out() {
    let ball = Compound::from(Shape::ball(0.1).unwrap());
    let mut open = soups::sphere(1);
    open.triangles.pop();
    let at = relative(&Pose::shift([0.0, 0.0, 0.3]));
    assert_eq!(PairTracker::new().penetration(&mesh(&open), &ball, &at), None);
    // A ball in a cube: the nearest face is 0.7 away from its middle.
    let cube = mesh(&soups::plate(2, [1.0, 1.0, 1.0]));
    let found = penetration(GeometryRef::from(&cube), GeometryRef::from(&ball), &at);
    assert!(found.lower > 0.8 - 1e-12 && found.lower <= 0.8, "{found:?}");
    assert!(found.upper >= 0.8 && found.upper < 0.801, "{found:?}");
}

use std::f64::consts::SQRT_2;

use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::surface::{BezierPatch, BezierSurface};
use lin_canny::{ContactState, ConvexPolyhedron, HalfSpace, Mesh, PointQuery, Shape};
use truth::rng::Rng;

/// Points anywhere, on a lattice, and on planes of symmetry.
fn points(count: usize, size: f64, rng: &mut Rng) -> Vec<Point3<f64>> {
    let one = |k: usize, rng: &mut Rng| -> Point3<f64> {
        Point3::from(match k % 4 {
            0 => [0; 3].map(|_| 0.25 * rng.int(-8, 8) as f64 * size),
            1 => {
                let mut p = [0; 3].map(|_| rng.range(-2.0, 2.0) * size);
                p[rng.below(3)] = 0.0;
                p
            }
            _ => [0; 3].map(|_| rng.range(-2.0, 2.0) * size),
        })
    };
    (0..count).map(|k| one(k, rng)).collect()
}

/// Checks outcomes against a function for the true signed distance, which errs by `error`.
fn judge(query: &PointQuery<'_>, size: f64, error: f64, truth: impl Fn(&Point3<f64>) -> f64, told: &str) {
    let mut rng = Rng::new(3);
    let all = points(200, size, &mut rng);
    for (p, found) in all.iter().zip(super::ask(query, &all, told)) {
        let told = format!("{told}, {p:?}: {found:?}");
        let (true_value, slack) = (truth(p), error * (size + p.coords.norm()));
        assert!(
            found.lower <= true_value + slack && true_value - slack <= found.upper,
            "{true_value}: {told}"
        );
        let wrong = match found.state {
            ContactState::Separated => true_value < -slack,
            ContactState::Overlapping => true_value > slack,
            _ => true_value.abs() > slack + (found.upper - found.lower),
        };
        assert!(!wrong, "{true_value}: {told}");
        // The closest point is on the surface, at the distance.
        assert!(
            ((found.point - p).norm() - found.distance.abs()).abs() <= 1e-9 * (size + p.coords.norm()),
            "{told}"
        );
        let out = (p - found.point).dot(&found.normal) - found.distance;
        assert!(out.abs() <= 1e-9 * (size + p.coords.norm()), "{told}");
    }
}

fn of_box(p: &Point3<f64>, h: f64) -> f64 {
    let over = p.coords.map(|x| x.abs() - h);
    let outside = over.map(|x| x.max(0.0)).norm();
    outside + over.max().min(0.0)
}

#[test]
fn a_box_a_rounded_box_and_a_ball_have_the_distances_of_closed_forms() {
    for size in [1.0, 1e-99, 1e60] {
        let die = solids::cuboid(Vector3::repeat(size)).expect("a box");
        judge(&PointQuery::new(&die), size, 1e-15, |p| of_box(p, size), "box");
        let mesh = Mesh::from_convex(&die).expect("a mesh");
        judge(
            &PointQuery::new(&mesh),
            size,
            1e-15,
            |p| of_box(p, size),
            "mesh of a box",
        );
        let rounded = Shape::from(die).rounded(0.25 * size).expect("a shape");
        judge(
            &PointQuery::new(&rounded),
            size,
            1e-15,
            |p| of_box(p, size) - 0.25 * size,
            "rounded box",
        );
        let ball = Shape::ball(size).expect("a ball");
        judge(&PointQuery::new(&ball), size, 1e-15, |p| p.coords.norm() - size, "ball");
    }
}

#[test]
fn a_cylinder_and_a_capsule_have_the_distances_of_closed_forms() {
    let can = Shape::cylinder(1.0, 0.5).expect("a cylinder");
    let flat = |p: &Point3<f64>| {
        let (r, h) = (p.x.hypot(p.y) - 0.5, p.z.abs() - 1.0);
        r.max(0.0).hypot(h.max(0.0)) + r.max(h).min(0.0)
    };
    judge(&PointQuery::new(&can), 1.0, 1e-14, flat, "cylinder");
    let capsule = Shape::capsule(1.0, 0.5).expect("a capsule");
    let round = |p: &Point3<f64>| Vector3::new(p.x, p.y, (p.z.abs() - 1.0).max(0.0)).norm() - 0.5;
    judge(&PointQuery::new(&capsule), 1.0, 1e-14, round, "capsule");
}

#[test]
fn a_point_next_to_a_polyhedron_is_on_its_side() {
    let die = solids::cuboid(Vector3::repeat(1.0)).expect("a box");
    let query = PointQuery::new(&die);
    for (z, state) in [
        (1.0, ContactState::Touching),
        (1f64.next_up(), ContactState::Separated),
        (1f64.next_down(), ContactState::Overlapping),
    ] {
        let found = query.closest_point(&Point3::new(0.3, 0.2, z)).expect("a point");
        assert_eq!(found.state, state, "{found:?}");
    }
    // Bodies without volume have a surface alone.
    let segment = ConvexPolyhedron::segment(Point3::origin(), Point3::new(1.0, 2.0, 3.0)).expect("a segment");
    let query = PointQuery::new(&segment);
    let state = |p: [f64; 3]| query.closest_point(&Point3::from(p)).expect("a point").state;
    assert_eq!(state([0.5, 1.0, 1.5]), ContactState::Touching);
    assert_eq!(state([0.5, 1.0, 1.5f64.next_up()]), ContactState::Separated);
}

#[test]
fn a_half_space_has_the_exact_side() {
    let space = HalfSpace::new(Vector3::new(1.0, 1.0, 0.0), 0.25).expect("a half-space");
    let (n, offset) = (space.normal(), space.offset());
    let query = PointQuery::new(&space);
    judge(&query, 1.0, 1e-15, |p| n.dot(&p.coords) - offset, "half-space");
    let floor = HalfSpace::new(Vector3::z(), 0.0).expect("a half-space");
    let query = PointQuery::new(&floor);
    for (z, state) in [
        (0.0, ContactState::Touching),
        (1e-300, ContactState::Separated),
        (-1e-300, ContactState::Overlapping),
    ] {
        assert_eq!(
            query.closest_point(&Point3::new(1.0, 2.0, z)).expect("a point").state,
            state
        );
    }
}

#[test]
fn a_surface_has_a_distance_and_no_inside() {
    let at = |k: usize| Point3::new((k / 2) as f64, (k % 2) as f64, 0.0);
    let corners: Vec<_> = (0..4).map(at).collect();
    let patch = BezierPatch::polynomial([1, 1], &corners).expect("a patch");
    let surface = BezierSurface::new(vec![patch]).expect("a surface");
    let query = PointQuery::new(&surface);
    let found = query.closest_point(&Point3::new(0.5, 0.5, -2.0)).expect("a point");
    assert!(
        found.lower <= 2.0 && 2.0 <= found.upper && found.upper - found.lower < 1e-8,
        "{found:?}"
    );
    let found = query.closest_point(&Point3::new(2.0, 2.0, 0.0)).expect("a point");
    assert!(
        found.lower <= SQRT_2 && SQRT_2 <= found.upper && !found.is_contained(),
        "{found:?}"
    );
}

use std::f64::consts::SQRT_2;
use truth::support::piece_at;

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::surface::{BezierPatch, BezierSurface};
use lin_canny::{
    Cloud, CloudElement, Compound, ContactState, ConvexPolyhedron, Geometry, HalfSpace, Mesh, PointOutcome, PointQuery,
    Shape,
};
use truth::near_points::{POINT_KINDS, hard_point, is_between, is_between_of, place};
use truth::rng::Rng;
use truth::soups::Soup;

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
        assert!(found.lower <= true_value + slack, "{true_value}: {told}");
        assert!(true_value - slack <= found.upper, "{true_value}: {told}");
        let wrong = match found.state {
            ContactState::Separated => true_value < -slack,
            ContactState::Overlapping => true_value > slack,
            _ => true_value.abs() > slack + (found.upper - found.lower),
        };
        assert!(!wrong, "{true_value}: {told}");
        // The closest point is on the surface, at the distance.
        let off = ((found.point - p).norm() - found.distance.abs()).abs();
        assert!(off <= 1e-9 * (size + p.coords.norm()), "{told}");
        let out = (p - found.point).dot(&found.normal) - found.distance;
        assert!(out.abs() <= 1e-9 * (size + p.coords.norm()), "{told}");
    }
}

fn of_box(p: &Point3<f64>, h: f64) -> f64 {
    let over = p.coords.map(|x| x.abs() - h);
    let outside = over.map(|x| x.max(0.0)).norm();
    outside + over.max().min(0.0)
}

fn of_cylinder(p: &Vector3<f64>, half: f64, radius: f64) -> f64 {
    let (r, h) = (p.x.hypot(p.y) - radius, p.z.abs() - half);
    r.max(0.0).hypot(h.max(0.0)) + r.max(h).min(0.0)
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
    judge(
        &PointQuery::new(&can),
        1.0,
        1e-14,
        |p| of_cylinder(&p.coords, 1.0, 0.5),
        "cylinder",
    );
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
        let found = query.closest_point(&Point3::new(1.0, 2.0, z)).expect("a point").state;
        assert_eq!(found, state);
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
    assert!(found.lower <= 2.0, "{found:?}");
    assert!(2.0 <= found.upper, "{found:?}");
    assert!(found.upper - found.lower < 1e-8, "{found:?}");
    let found = query.closest_point(&Point3::new(2.0, 2.0, 0.0)).expect("a point");
    assert!(found.lower <= SQRT_2, "{found:?}");
    assert!(SQRT_2 <= found.upper, "{found:?}");
    assert!(!found.is_contained(), "{found:?}");
}

#[test]
fn unions_have_the_side_and_the_distance_of_their_members() {
    let mut rng = Rng::new(11);
    for size in [1.0, 1e-60, 1e40] {
        let die = solids::cuboid(Vector3::repeat(size)).expect("a box");
        let ball = Shape::ball(0.75 * size).expect("a ball");
        let shifts: Vec<Vector3<f64>> = (0..40)
            .map(|_| Vector3::from_fn(|_, _| rng.int(-4, 4) as f64 * size))
            .collect();
        let centres: Vec<_> = shifts.iter().map(|s| Point3::from(*s)).collect();
        let of_boxes = |p: &Point3<f64>| {
            shifts
                .iter()
                .map(|s| of_box(&(p - s), size))
                .fold(f64::INFINITY, f64::min)
        };
        let of_cylinders = |p: &Point3<f64>| {
            let each = shifts.iter().map(|s| of_cylinder(&(p.coords - s), size, size));
            each.fold(f64::INFINITY, f64::min)
        };
        let of_balls = |p: &Point3<f64>| {
            shifts
                .iter()
                .map(|s| (p.coords - s).norm() - 0.75 * size)
                .fold(f64::INFINITY, f64::min)
        };
        let piece =
            |shape: Shape, shift: &Vector3<f64>| piece_at(Isometry3::translation(shift.x, shift.y, shift.z), shape);
        let boxes: Vec<_> = shifts.iter().map(|s| piece(Shape::from(die.clone()), s)).collect();
        let balls: Vec<_> = shifts.iter().map(|s| piece(ball.clone(), s)).collect();
        let half = Vector3::repeat(size);
        let cylinder = Shape::cylinder(size, size).expect("a cylinder");
        let cloud = |element| Geometry::from(Cloud::new(&centres, element).expect("a cloud"));
        let all: [(&str, Geometry, bool); 6] = [
            ("boxes", Compound::new(boxes).expect("pieces").into(), true),
            ("balls", Compound::new(balls).expect("pieces").into(), false),
            ("cloud of boxes", cloud(CloudElement::Box(half)), true),
            ("cloud of balls", cloud(CloudElement::Ball(0.75 * size)), false),
            (
                "cloud of radii",
                cloud(CloudElement::Balls(vec![0.75 * size; 40])),
                false,
            ),
            ("cloud of shapes", cloud(CloudElement::Shape(cylinder)), true),
        ];
        for (told, geometry, are_boxes) in &all {
            let query = PointQuery::new(geometry);
            let points = points(120, 2.0 * size, &mut rng);
            let told = format!("{told} {size:e}");
            for (p, found) in points.iter().zip(super::ask(&query, &points, &told)) {
                let told = format!("{told}, {p:?}: {found:?}");
                let truth = match (*are_boxes, told.starts_with("cloud of shapes")) {
                    (_, true) => of_cylinders(p),
                    (true, _) => of_boxes(p),
                    _ => of_balls(p),
                };
                let slack = 1e-14 * (size + p.coords.norm());
                // The union of overlapping members is at least as deep as the deepest.
                assert!(truth <= found.upper + slack, "{truth}: {told}");
                assert!((truth < 0.0 || found.lower <= truth + slack), "{truth}: {told}");
                assert!(truth >= 0.0 || found.lower <= truth + slack, "{truth}: {told}");
                assert!(
                    found.state != ContactState::Separated || truth >= -slack,
                    "{truth}: {told}"
                );
                assert!(
                    found.state != ContactState::Overlapping || truth <= slack,
                    "{truth}: {told}"
                );
                assert!(
                    found.state != ContactState::Undecided || truth.abs() <= slack,
                    "{truth}: {told}"
                );
            }
        }
    }
}

/// Checks near subshapes against all of them, each measured by itself.
fn judge_near(query: &PointQuery<'_>, count: usize, points: &[Point3<f64>], told: &str) {
    for p in points {
        let all = query.nearest_features(p, usize::MAX).expect("a point");
        let told = format!("{told}, {p:?}");
        assert_eq!(all.len(), count, "{told}");
        let key = |f: &PointOutcome| (f.upper, f.location.subshape);
        assert!(all.is_sorted_by(|a, b| key(a) < key(b)), "{told}");
        for k in [0, 1, 3, 7] {
            let few = query.nearest_features(p, k).expect("a point");
            assert_eq!(few[..], all[..k.min(all.len())], "{told}, {k}");
        }
        let nearest = query.closest_point(p).expect("a point");
        assert!(
            nearest.lower.abs() <= all[0].upper.abs() || nearest.lower <= all[0].upper,
            "{told}"
        );
        for d in [
            -1.0,
            0.0,
            all[all.len() / 2].upper,
            all[all.len() / 2].lower,
            f64::NAN,
            f64::INFINITY,
        ] {
            let near = query.within(p, d).expect("a point");
            let expected: Vec<_> = all.iter().filter(|f| f.lower <= d).copied().collect();
            assert_eq!(near, expected, "{told}, {d}");
        }
    }
}

#[test]
fn near_subshapes_are_those_of_a_search_of_all() {
    let mut rng = Rng::new(12);
    let soup = truth::near_points::hard_mesh(6, &mut rng);
    let at: Vec<_> = soup.points.iter().map(|p| Point3::from(*p)).collect();
    let mesh = Mesh::new(&at, &soup.triangles).expect("a mesh");
    let mut own = points(8, 1.0, &mut rng);
    own.extend(&at[..4]);
    judge_near(&PointQuery::new(&mesh), soup.triangles.len(), &own, "mesh");
    let hull = ConvexPolyhedron::from_points(&at).expect("a hull");
    judge_near(&PointQuery::new(&hull), hull.face_count(), &own, "hull");
    let cloud = Cloud::new(&at, CloudElement::Ball(0.125)).expect("a cloud");
    judge_near(&PointQuery::new(&cloud), at.len(), &own, "cloud");
    let voxels = Cloud::new(&at[..50], CloudElement::Box(Vector3::repeat(0.25))).expect("a cloud");
    judge_near(&PointQuery::new(&voxels), 50, &own, "voxels");
    let piece = |p: &Point3<f64>| {
        piece_at(
            Isometry3::new(p.coords, p.coords),
            solids::icosahedron(0.2).expect("a body"),
        )
    };
    let compound = Compound::new(at[..30].iter().map(piece).collect()).expect("pieces");
    judge_near(&PointQuery::new(&compound), 30, &own, "compound");
    let can = Shape::cylinder(1.0, 0.5).expect("a shape");
    judge_near(&PointQuery::new(&can), 1, &own, "cylinder");
}

/// A polyhedron as triangles.
fn soup_of(body: &ConvexPolyhedron) -> Soup {
    Soup::new(
        body.vertex_points().map(Into::into).collect(),
        body.triangles().map(|t| t.map(|v| v.index() as u32)).collect(),
    )
}

#[test]
fn polyhedra_of_all_sizes_have_the_sides_and_distances_of_exact_arithmetic() {
    let mut rng = Rng::new(13);
    for scale in [1.0, 2e-100, 3e-60, 2f64.powi(100), 4e99] {
        for n in [6, 12, 40] {
            let at: Vec<_> = (0..n).map(|_| Point3::from(rng.in_ball()) * scale).collect();
            let body = ConvexPolyhedron::from_points(&at).expect("a hull");
            let (soup, query) = (soup_of(&body), PointQuery::new(&body));
            let points: Vec<_> = (0..2 * POINT_KINDS)
                .map(|k| hard_point(&soup, k % POINT_KINDS, &mut rng))
                .collect();
            let given: Vec<_> = points.iter().map(|p| Point3::from(*p)).collect();
            let told = format!("{n} points times {scale:e}");
            for (p, found) in points.iter().zip(super::ask(&query, &given, &told)) {
                let told = format!("{told}, {p:?}: {found:?}");
                let flush = soup.radius() * 2f64.powi(-202);
                let p = p.map(|x| if x.abs() < flush { 0.0 } else { x });
                let state = place(&soup, p, &mut rng).state();
                assert_eq!(found.state, state, "{told}");
                let (x, y) = (found.lower.abs(), found.upper.abs());
                let lower = if found.lower <= 0.0 && found.upper >= 0.0 {
                    0.0
                } else {
                    x.min(y)
                };
                assert!(is_between(&soup, p, lower, x.max(y)), "{told}");
            }
        }
    }
}

#[test]
fn near_triangles_and_faces_have_the_distances_of_exact_arithmetic() {
    let mut rng = Rng::new(14);
    for scale in [1.0, 1e-99, 1e70] {
        for kind in [0, 5, 6, 8, 13] {
            let soup = truth::near_points::hard_mesh(kind, &mut rng).map(|p| p.map(|x| x * scale));
            let at: Vec<_> = soup.points.iter().map(|p| Point3::from(*p)).collect();
            let mesh = Mesh::new(&at, &soup.triangles).expect("a mesh");
            let hull = ConvexPolyhedron::from_points(&at).expect("a hull");
            for k in 0..POINT_KINDS {
                // Coordinates below 2^-200 of the size count as zero.
                let flush = soup.radius() * 2f64.powi(-202);
                let p = hard_point(&soup, k, &mut rng).map(|x| if x.abs() < flush { 0.0 } else { x });
                let told = format!("mesh {kind} times {scale:e}, {p:?}");
                let all = PointQuery::new(&mesh).nearest_features(&Point3::from(p), usize::MAX);
                let all = all.expect("a point");
                assert_eq!(all.len(), soup.triangles.len(), "{told}");
                for found in all.iter().step_by(7) {
                    let corners = soup.corners(found.location.subshape as usize);
                    let told = format!("{told}: {found:?}");
                    assert!(is_between_of(&corners, p, found.lower, found.upper), "{told}");
                    let size = soup.radius() + found.upper;
                    assert!(found.upper - found.lower <= 2e-14 * size, "{told}");
                }
                let faces = PointQuery::new(&hull).nearest_features(&Point3::from(p), usize::MAX);
                for found in faces.expect("a point").iter().step_by(5) {
                    let mut rim = Vec::new();
                    let face = hull.faces().nth(found.location.subshape as usize).expect("a face");
                    rim.extend(
                        hull.face_vertices(face)
                            .filter_map(|v| hull.vertex(v))
                            .map(<[f64; 3]>::from),
                    );
                    let triangles = (1..rim.len() as u32 - 1).map(|k| [0, k, k + 1]).collect();
                    let own = Soup::new(rim, triangles);
                    assert!(is_between(&own, p, found.lower, found.upper), "{told}: {found:?}");
                    let size = soup.radius() + found.upper;
                    assert!(found.upper - found.lower <= 2e-14 * size, "{told}: {found:?}");
                }
            }
        }
    }
}

#[test]
fn equally_near_subshapes_are_in_the_order_of_their_indices() {
    let at = |k: u32| Point3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2)) * 2.0;
    let corners: Vec<_> = (0..8).map(at).collect();
    let middle = Point3::new(1.0, 1.0, 1.0);
    let cloud = Cloud::new(&corners, CloudElement::Ball(0.5)).expect("a cloud");
    let voxels = Cloud::new(&corners, CloudElement::Box(Vector3::repeat(0.5))).expect("a cloud");
    let piece = |p: &Point3<f64>| piece_at(Isometry3::translation(p.x, p.y, p.z), Shape::ball(0.5).expect("a ball"));
    let balls = Compound::new(corners.iter().map(piece).collect()).expect("pieces");
    let die = solids::cuboid(Vector3::repeat(1.0)).expect("a box");
    let mesh = Mesh::from_convex(&die).expect("a mesh");
    let all: [(&str, PointQuery<'_>, Point3<f64>, usize); 5] = [
        ("cloud", PointQuery::new(&cloud), middle, 8),
        ("voxels", PointQuery::new(&voxels), middle, 8),
        ("compound", PointQuery::new(&balls), middle, 8),
        ("polyhedron", PointQuery::new(&die), Point3::origin(), 6),
        ("mesh", PointQuery::new(&mesh), Point3::origin(), 12),
    ];
    for (told, query, p, count) in all {
        for k in [1, 3, count] {
            let near = query.nearest_features(&p, k).expect("a point");
            let order: Vec<u32> = near.iter().map(|f| f.location.subshape).collect();
            assert!(near.iter().all(|f| f.upper == near[0].upper), "{told}: {near:?}");
            assert_eq!(order, (0..k as u32).collect::<Vec<_>>(), "{told}");
        }
        let d = query.nearest_features(&p, 1).expect("a point")[0].upper;
        let within: Vec<u32> = query
            .within(&p, d)
            .expect("a point")
            .iter()
            .map(|f| f.location.subshape)
            .collect();
        assert_eq!(within, (0..count as u32).collect::<Vec<_>>(), "{told}");
    }
}

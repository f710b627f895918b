//! Promise: the hull of a cover contains the whole body, exactly, and its gap is an upper bound.

use lin_canny::cover::{CoverError, FACES_MAX, HullCover, hull_outside};
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{
    Cloud, CloudElement, Compound, ConvexPolyhedron, Geometry, GeometryKind, HalfSpace, Mesh, Piece, PointQuery, Shape,
};
use truth::body::Body;
use truth::covers::is_inside;
use truth::exact::distance_to_body;
use truth::rational::{RBig, exact};
use truth::rng::Rng;
use truth::tally::tenth;
use truth::{Face, Point, Pose, shapes, soups};

/// A body, the points of which it is the hull, and the radius by which they are rounded.
struct Case {
    name: &'static str,
    geometry: Geometry,
    points: Vec<Point>,
    radius: f64,
}

impl Case {
    /// A body without rounding.
    fn plain(name: &'static str, geometry: Geometry, points: Vec<Point>) -> Self {
        Self {
            name,
            geometry,
            points,
            radius: 0.0,
        }
    }
}

/// Half the diagonal of the box of points.
fn size(points: &[Point]) -> f64 {
    let side = |k: usize| {
        let all = points.iter().map(|p| p[k]);
        all.clone().fold(f64::NEG_INFINITY, f64::max) - all.fold(f64::INFINITY, f64::min)
    };
    side(0).hypot(side(1)).hypot(side(2)) * 0.5
}

fn corners_of(hull: &ConvexPolyhedron) -> Vec<Point> {
    hull.vertex_points().map(|p| p.into()).collect()
}

fn faces_of(hull: &ConvexPolyhedron) -> Vec<[Point; 3]> {
    let at = |v| -> Point { hull.vertex(v).expect("a vertex").into() };
    hull.triangles().map(|t| t.map(at)).collect()
}

/// Returns the height of a point over the plane of a half-space, exactly.
fn height(space: &HalfSpace, point: &Point) -> RBig {
    let n = space.normal().into_inner();
    let sum = (0..3).fold(RBig::ZERO, |sum, k| sum + exact(n[k]) * exact(point[k]));
    sum - exact(space.offset())
}

/// Returns whether a half-space contains a ball, exactly but for the length of the normal.
fn holds(space: &HalfSpace, point: &Point, radius: f64) -> bool {
    let length = space.normal().norm() * (1.0 - 1e-15);
    height(space, point) + exact(radius) * exact(length) <= RBig::ZERO
}

/// Checks a cover exactly. Returns the gap as a part of the size.
fn check(case: &Case, faces: usize) -> f64 {
    let told = format!("{}, {faces} faces, {:?}", case.name, case.points.first());
    let cover = match hull_outside(&case.geometry, faces) {
        Ok(cover) => cover,
        Err(error) => panic!("{told}: {error}"),
    };
    let HullCover { hull, planes, gap, .. } = &cover;
    hull.check().expect("a sound body");
    assert!((4..=faces).contains(&planes.len()), "{told}: {}", planes.len());
    let sides = faces_of(hull);
    for p in &case.points {
        assert!(is_inside(&(*p, case.radius), &sides), "{told}: {p:?}");
        for plane in planes {
            assert!(holds(plane, p, case.radius), "{told}: {p:?} {plane:?}");
        }
    }
    let used: std::collections::BTreeSet<_> = hull.faces().map(|f| hull.source_face(f).expect("a plane")).collect();
    assert!(used.iter().all(|k| *k < planes.len()), "{told}");
    // Corners are not strictly inside the planes that meet there.
    for p in corners_of(hull) {
        let met = planes.iter().filter(|plane| height(plane, &p) >= RBig::ZERO).count();
        assert!(met >= 3, "{told}: {p:?} is outside {met} planes");
    }
    // The gap, by exact distances of the corners. A flat body has no exact oracle.
    let points: Vec<_> = case.points.iter().map(|p| Point3::from(*p)).collect();
    let size = size(&case.points) + case.radius;
    if let Ok(body) = ConvexPolyhedron::from_points(&points) {
        let points = corners_of(&body);
        let rims = body.faces().map(|f| rim(&body, f)).collect::<Vec<_>>();
        let body = Body::new(&points, &rims);
        let far = |p: &Point| distance_to_body(*p, body, &Pose::IDENTITY) - case.radius;
        let worst = corners_of(hull).iter().map(far).fold(0.0, f64::max);
        assert!(worst <= *gap, "{told}: {worst:e} {gap:e}");
        assert!(
            *gap <= worst * 1.01 + 1e-11 * size + 1e-11 * far_of(case),
            "{told}: {worst:e} {gap:e}"
        );
    }
    gap / size
}

/// The largest coordinate of a case.
fn far_of(case: &Case) -> f64 {
    case.points.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()))
}

fn rim(body: &ConvexPolyhedron, face: lin_canny::FaceId) -> Face {
    body.face_vertices(face).map(|v| v.index() as u32).collect()
}

fn turned(rng: &mut Rng) -> Pose {
    Pose::new(rng.quat(), [0.0; 3])
}

/// A random body of one of twelve kinds, at any scale and some of them far from the origin.
fn random_case(rng: &mut Rng) -> Case {
    let kind = rng.below(12);
    let scale = 10f64.powf(rng.range(-98.0, 97.0));
    let shift: Point = match rng.below(4) {
        0 => std::array::from_fn(|_| rng.range(-1e4, 1e4)),
        _ => [0.0; 3],
    };
    let put = |points: Vec<Point>| -> Vec<Point> {
        let place = |p: Point| std::array::from_fn(|k| (p[k] + shift[k]) * scale);
        points.into_iter().map(place).collect()
    };
    let at = |points: &[Point]| points.iter().map(|p| Point3::from(*p)).collect::<Vec<_>>();
    let hull = |points: &[Point]| ConvexPolyhedron::from_points(&at(points)).expect("a hull");
    let (n, thin) = (4 + rng.below(60), 10f64.powf(rng.range(-12.0, -1.0)));
    let unit = 2f64.powi(rng.below(600) as i32 - 300);
    let plain = |name, points: Vec<Point>| {
        let geometry = Geometry::from(hull(&points));
        Case::plain(name, geometry, points)
    };
    match kind {
        0 => plain("ball of points", put(shapes::ball(rng, n.max(8)).points)),
        1 => plain("sliver", put(shapes::sliver(rng, n.max(8), thin).points)),
        2 => plain("needle", put(shapes::needle(rng, n.max(8), thin).points)),
        3 => plain("small", put(shapes::small(rng).points)),
        4 => plain(
            "turned box",
            put(shapes::cuboid([1.0, 0.6, rng.range(1e-6, 1.0)])
                .moved(&turned(rng))
                .points),
        ),
        5 => {
            // Exactly flat: whole numbers in the plane z = x + 2 y.
            let whole = |rng: &mut Rng| rng.below(33) as f64 - 16.0;
            let points = (0..n)
                .map(|_| (whole(rng), whole(rng)))
                .map(|(x, y)| [x, y, x + 2.0 * y]);
            let points: Vec<Point> = points.map(|p| p.map(|x| x * unit)).collect();
            let geometry = match ConvexPolyhedron::polygon(&at(&points)) {
                Ok(body) => Geometry::from(body),
                Err(_) => Geometry::from(ConvexPolyhedron::point(points[0].into()).expect("a point")),
            };
            let points = geometry.as_polyhedron().map(corners_of).expect("a polyhedron");
            Case::plain("flat", geometry, points)
        }
        6 => {
            let points = put(vec![rng.unit(), rng.unit()]);
            let ends = at(&points);
            let geometry = ConvexPolyhedron::segment(ends[0], ends[1]).expect("a segment").into();
            Case::plain("segment", geometry, points)
        }
        7 => {
            let points = put(shapes::small(rng).points);
            let radius = scale * rng.range(0.0, 1.0);
            let shape = Shape::from(hull(&points)).rounded(radius).expect("a shape");
            Case {
                name: "rounded",
                geometry: shape.into(),
                points,
                radius,
            }
        }
        8 => {
            let soup = soups::torus(5 + rng.below(12), 4 + rng.below(8), rng.range(0.05, 0.4));
            let soup = soup.moved(&turned(rng));
            mesh_case("torus", put(soup.points), soup.triangles)
        }
        9 => {
            let soup = soups::loose(1 + rng.below(20), 0.3, rng);
            let points = put(soup.points);
            mesh_case("loose", points, soup.triangles)
        }
        10 => {
            let points = put((0..n).map(|_| rng.unit()).collect());
            let radius = scale * rng.range(0.01, 0.5);
            let geometry = Cloud::new(&at(&points), CloudElement::Ball(radius))
                .expect("a cloud")
                .into();
            Case {
                name: "cloud",
                geometry,
                points,
                radius,
            }
        }
        _ => {
            // Translations by a power of two: sums of few bits are exact.
            let body = solids::cuboid(Vector3::new(1.0, 0.5, 0.25)).expect("a box");
            let body = body.scaled(unit).expect("a box");
            let pieces: Vec<_> = (0..3)
                .map(|_| rng.below(64) as f64 * unit)
                .map(|x| {
                    let mut piece = Piece::new(body.clone());
                    piece.pose = Isometry3::translation(x, -x, 0.5 * x);
                    (piece, x)
                })
                .collect();
            let places = pieces.iter().flat_map(|(_, x)| {
                corners_of(&body)
                    .into_iter()
                    .map(move |p| [p[0] + x, p[1] - x, p[2] + 0.5 * x])
            });
            let points = places.collect();
            let compound = Compound::new(pieces.into_iter().map(|(piece, _)| piece).collect()).expect("a compound");
            Case::plain("compound", compound.into(), points)
        }
    }
}

fn mesh_case(name: &'static str, points: Vec<Point>, triangles: Vec<[u32; 3]>) -> Case {
    let at: Vec<_> = points.iter().map(|p| Point3::from(*p)).collect();
    let geometry = Geometry::from(Mesh::new(&at, &triangles).expect("a mesh"));
    Case::plain(name, geometry, points)
}

fn run(count: usize, seed: u64) {
    let mut rng = Rng::new(seed);
    let mut gaps = std::collections::BTreeMap::<&str, (f64, usize)>::new();
    for _ in 0..count {
        let case = random_case(&mut rng);
        let faces = if rng.below(2) == 0 {
            4 + rng.below(5)
        } else {
            4 + rng.below(61)
        };
        let gap = check(&case, faces);
        let entry = gaps.entry(case.name).or_default();
        *entry = (entry.0.max(gap), entry.1 + 1);
    }
    println!("{gaps:.3?}");
    assert!(gaps.len() == 12, "{gaps:?}");
}

#[test]
fn random_bodies_are_contained_exactly() {
    run(tenth(300), 1);
}

#[test]
#[ignore = "30,000 bodies, half an hour: cargo test --release --all-features --test hull_cover thirty_thousand -- --ignored --nocapture"]
fn thirty_thousand_random_bodies_are_contained_exactly() {
    run(30_000, 2);
}

/// The same bits in another unit: no tolerance is absolute.
#[test]
fn a_power_of_two_scales_the_hull() {
    let soup = soups::bracket();
    let at = |unit: f64, faces: usize| {
        let points: Vec<_> = soup.points.iter().map(|p| Point3::from(*p) * unit).collect();
        let mesh = Mesh::new(&points, &soup.triangles).expect("a mesh");
        hull_outside(&mesh, faces).expect("a cover")
    };
    for faces in [4, 6, 20] {
        let one = at(1.0, faces);
        for power in [-300, -60, 60, 300] {
            let unit = 2f64.powi(power);
            let other = at(unit, faces);
            // Distances of a mesh leave its stored unit by one more rounding, unless it is one.
            let gap = other.gap / unit;
            let is_stored_alike = power.abs() < 100;
            assert!(gap == one.gap || !is_stored_alike && (gap == one.gap.next_up() || gap == one.gap.next_down()));
            let scaled = one.hull.vertex_points().map(|p| p * unit);
            assert!(scaled.eq(other.hull.vertex_points()));
            let plane = |space: &HalfSpace| (space.normal(), space.offset());
            let scaled = one.planes.iter().map(|space| (space.normal(), space.offset() * unit));
            assert!(scaled.eq(other.planes.iter().map(plane)));
        }
    }
}

/// A polyhedron with few faces is its own cover, up to rounding.
#[test]
fn few_faces_stay_as_they_are() {
    let mut rng = Rng::new(4);
    for shape in shapes::platonic() {
        let shape = shape.moved(&turned(&mut rng));
        let points: Vec<_> = shape.points.iter().map(|p| Point3::from(*p)).collect();
        let body = ConvexPolyhedron::from_points(&points).expect("a hull");
        let cover = hull_outside(&body, 20).expect("a cover");
        assert!(cover.gap < 1e-12, "{}: {}", shape.name, cover.gap);
    }
    let die = solids::cuboid(Vector3::new(1.0, 2.0, 3.0)).expect("a box");
    let cover = hull_outside(&die, 6).expect("a cover");
    assert_eq!((cover.planes.len(), cover.hull.face_count()), (6, 6));
}

/// More faces make the cover tighter: here a ball, of which the best are known for some numbers.
#[test]
fn covers_of_a_ball_are_near_the_best() {
    let ball = Shape::ball(1.0).expect("a ball");
    for (faces, best) in [(4, 2.0), (6, 3f64.sqrt() - 1.0), (12, 0.2584), (32, 0.11)] {
        let cover = hull_outside(&ball, faces).expect("a cover");
        assert!(is_inside(&([0.0; 3], 1.0), &faces_of(&cover.hull)));
        assert!(cover.gap >= best - 1e-12, "{faces}: {}", cover.gap);
        assert!(cover.gap < 1.35 * best, "{faces}: {}", cover.gap);
        let query = PointQuery::new(&ball);
        let far = |p: Point3<f64>| query.signed_distance(&p).expect("a point").lower;
        assert!(cover.hull.vertex_points().map(far).all(|d| d <= cover.gap));
    }
}

/// Curved bodies, by their supports in many directions.
#[test]
fn curved_bodies_are_contained() {
    let mut rng = Rng::new(5);
    let bodies = [
        Shape::cylinder(1.0, 0.2),
        Shape::cone(1.0, 0.5).and_then(|shape| shape.rounded(0.1)),
        Shape::ellipsoid(Vector3::new(1.0, 0.5, 0.01)),
        Shape::capsule(1.0, 1e-6),
    ];
    for body in bodies {
        let body = body.expect("a shape");
        for faces in [4, 9, 40] {
            let HullCover { hull, gap, .. } = hull_outside(&body, faces).expect("a cover");
            for _ in 0..500 {
                let n = Vector3::from(rng.unit());
                let top = hull.extreme_vertex(&n);
                let height = hull.vertex(top).expect("a vertex").coords.dot(&n);
                let support = body.support_height(&n);
                assert!(height >= support * (1.0 - 1e-13), "{body:?}: {n}");
                assert!(height <= support + gap + 1e-12, "{body:?}: {n}");
            }
        }
    }
}

#[test]
fn points_are_covered() {
    for point in [
        Point3::origin(),
        Point3::new(1.0, 2.0, 3.0),
        Point3::new(1e-50, 0.0, 0.0),
    ] {
        let body = ConvexPolyhedron::point(point).expect("a point");
        let cover = hull_outside(&body, 6).expect("a cover");
        assert!(cover.hull.contains(&point), "{cover:?}");
        assert!(cover.gap <= 1e-12 * point.coords.norm(), "{cover:?}");
    }
    let body = ConvexPolyhedron::point(Point3::origin()).expect("a point");
    let cover = hull_outside(&body, 4).expect("a cover");
    assert_eq!((cover.hull.vertex_count(), cover.planes.len(), cover.gap), (1, 0, 0.0));
}

#[test]
fn parameters_and_bodies_without_a_hull_are_named() {
    let die = Shape::cuboid(Vector3::repeat(1.0)).expect("a shape");
    for faces in [0, 3, FACES_MAX + 1] {
        let error = hull_outside(&die, faces).expect_err("out of range");
        assert_eq!(error, CoverError::Faces { faces });
        assert!(
            error
                .to_string()
                .starts_with(&format!("number of faces is out of range: {faces}"))
        );
    }
    let floor = HalfSpace::new(Vector3::z(), 0.0).expect("a half-space");
    let error = hull_outside(&floor, 6).expect_err("unbounded");
    assert_eq!(error.to_string(), "a half-space has no cover: it is not bounded");
    // Four planes around a body of the largest extent reach farther than a body may.
    let huge = solids::cuboid(Vector3::repeat(0.5e100)).expect("a box");
    let kind = GeometryKind::Polyhedron;
    assert_eq!(hull_outside(&huge, 4).map(|_| ()), Err(CoverError::NoHull { kind }));
}

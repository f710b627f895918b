//! Promise: outer balls contain the whole body, inner balls are inside, and gaps are upper bounds.

use lin_canny::cover::{BALLS_MAX, Ball, BallCover, CoverError, CoverGoal, cover_inside, cover_outside};
use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::{
    Cloud, CloudElement, Compound, ConvexPolyhedron, Geometry, GeometryKind, HalfSpace, Mesh, MeshKind, Piece,
    PointQuery, Shape,
};
use truth::covers::{contain, is_inside};
use truth::driven::exact_place::Place;
use truth::forms::mesh;
use truth::near_points::{is_between, place};
use truth::rng::Rng;
use truth::soups::{self, Soup};
use truth::{Point, shapes};

fn plain(balls: &[Ball]) -> Vec<(Point, f64)> {
    balls.iter().map(|ball| (ball.center.into(), ball.radius)).collect()
}

fn distance(p: &Point, q: &Point) -> f64 {
    (p[0] - q[0]).hypot(p[1] - q[1]).hypot(p[2] - q[2])
}

/// Points of a solid mesh, exactly judged.
fn inside(soup: &Soup, count: usize, rng: &mut Rng) -> Vec<Point> {
    let (mut found, radius) = (vec![], soup.radius());
    for _ in 0..40 * count {
        let p: Point = std::array::from_fn(|_| rng.range(-radius, radius));
        if place(soup, p, rng) == Place::Inside {
            found.push(p);
        }
        if found.len() == count {
            break;
        }
    }
    found
}

/// Checks that no random point of a ball is proven farther from the body than the gap.
fn check_gap(geometry: &Geometry, cover: &BallCover, rng: &mut Rng, told: &str) {
    let query = PointQuery::new(geometry);
    for ball in &cover.balls {
        for _ in 0..20 {
            let p = ball.center + Vector3::from(rng.unit()) * ball.radius;
            let found = query.signed_distance(&p).expect("a point");
            assert!(
                found.lower <= cover.gap * (1.0 + 1e-12),
                "{told}: {found:?}, {}",
                cover.gap
            );
        }
    }
}

/// Checks covers of a mesh: exactly, and gaps by samples. Returns the gaps as parts of the radius.
fn check_mesh(soup: &Soup, count: usize, rng: &mut Rng, told: &str) -> [f64; 2] {
    let mesh = mesh(soup);
    let is_solid = mesh.kind() == MeshKind::Solid;
    let geometry = Geometry::from(mesh);
    let told = format!("{told}, {count} balls");
    let outer = cover_outside(&geometry, CoverGoal::Balls(count)).expect("a cover");
    assert!((1..=count).contains(&outer.balls.len()), "{told}");
    let balls = plain(&outer.balls);
    for t in 0..soup.triangles.len() {
        assert!(contain(&balls, &soup.corners(t)), "{told}: triangle {t}");
    }
    check_gap(&geometry, &outer, rng, &told);
    if !is_solid {
        let kind = GeometryKind::Mesh;
        let found = cover_inside(&geometry, count);
        assert_eq!(found, Err(CoverError::NoInside { kind }), "{told}");
        return [outer.gap / soup.radius(), f64::NAN];
    }
    let inner = cover_inside(&geometry, count).expect("a cover");
    assert!((1..=count).contains(&inner.balls.len()), "{told}");
    for (center, radius) in plain(&inner.balls) {
        assert_eq!(place(soup, center, rng), Place::Inside, "{told}");
        let far = 4.0 * soup.radius();
        assert!(is_between(soup, center, radius, far), "{told}: {center:?} {radius}");
    }
    let surface = soup.points.iter().copied().take(200);
    for p in inside(soup, 40, rng).into_iter().chain(surface) {
        assert!(contain(&balls, &[p]), "{told}: {p:?}");
        let far = |(c, r): &(Point, f64)| distance(&p, c) - r;
        let least = plain(&inner.balls).iter().map(far).fold(f64::INFINITY, f64::min);
        assert!(least <= inner.gap * (1.0 + 1e-12), "{told}: {p:?}");
    }
    [outer.gap, inner.gap].map(|gap| gap / soup.radius())
}

#[test]
fn meshes_are_covered_exactly() {
    let mut rng = Rng::new(1);
    let meshes = [
        ("torus", soups::torus(12, 8, 0.3)),
        ("knot", soups::knot(40, 6, 0.15)),
        ("rock", soups::rock(2, 3)),
        ("gear", soups::gear(8)),
        ("bracket", soups::bracket()),
        ("cave", soups::cave(2, 0.6)),
        ("plate", soups::plate(4, [1.0, 0.8, 1e-3])),
    ];
    for (name, soup) in &meshes {
        let gaps = [1, 6, 24].map(|count| check_mesh(soup, count, &mut rng, name));
        println!("{name}: {gaps:.3?}");
        // A rock is nearly a ball.
        let part = if *name == "rock" { 1.0 } else { 0.75 };
        assert!(gaps[2][0] <= part * gaps[0][0], "{name}: {gaps:?}");
    }
}

#[test]
fn open_meshes_and_slivers_are_covered_exactly() {
    let mut rng = Rng::new(2);
    for (name, soup) in [
        ("loose", soups::loose(60, 0.2, &mut Rng::new(4))),
        ("slivers", soups::slivers(60, &mut Rng::new(5))),
    ] {
        for count in [1, 16] {
            check_mesh(&soup, count, &mut rng, name);
        }
    }
}

#[test]
fn covers_hold_at_every_scale() {
    let mut rng = Rng::new(3);
    for scale in [1e-100, 1e-30, 1e30, 0.5e100] {
        let soup = soups::bracket().map(|p| p.map(|x| x * scale));
        let soup = {
            let unit = scale / soup.radius();
            soup.map(|p| p.map(|x| x * unit))
        };
        check_mesh(&soup, 8, &mut rng, &format!("{scale:e}"));
    }
    // Far from the origin, where the places of points round by a part of the body.
    let soup = soups::gear(6).map(|p| [p[0] + 3e7, p[1] - 1e7, p[2]]);
    let outer = cover_outside(&mesh(&soup), CoverGoal::Balls(4)).expect("a cover");
    let balls = plain(&outer.balls);
    assert!((0..soup.triangles.len()).all(|t| contain(&balls, &soup.corners(t))));
    assert!(outer.gap < 2.0, "{}", outer.gap);
}

/// The same bits in another unit: no tolerance is absolute.
#[test]
fn a_power_of_two_scales_the_balls() {
    let soup = soups::bracket();
    let at = |unit: f64| {
        let mesh = mesh(&soup.clone().map(|p| p.map(|x| x * unit)));
        let outer = cover_outside(&mesh, CoverGoal::Balls(6)).expect("a cover");
        (outer, cover_inside(&mesh, 6).expect("a cover"))
    };
    let scaled = |cover: &BallCover, unit: f64| {
        let balls = cover.balls.iter().map(|ball| (ball.center * unit, ball.radius * unit));
        (balls.collect::<Vec<_>>(), cover.gap * unit)
    };
    let unit = 2f64.powi(60);
    let (one, other) = (at(1.0), at(unit));
    assert_eq!(scaled(&one.0, unit), scaled(&other.0, 1.0));
    assert_eq!(scaled(&one.1, unit), scaled(&other.1, 1.0));
}

#[test]
fn hulls_are_covered_with_their_inside() {
    let mut rng = Rng::new(6);
    let mut bodies = shapes::platonic().to_vec();
    bodies.push(shapes::sliver(&mut rng, 20, 1e-9));
    bodies.push(shapes::needle(&mut rng, 20, 1e-6));
    bodies.push(shapes::chamfered([1.0, 0.5, 0.2], 0.1));
    bodies.push(shapes::cuboid([5.0, 0.3, 1e-4]));
    for shape in bodies {
        let points: Vec<_> = shape.points.iter().map(|p| Point3::from(*p)).collect();
        let body = ConvexPolyhedron::from_points(&points).expect("a body");
        let apex: Point = body
            .vertices()
            .next()
            .and_then(|v| body.vertex(v))
            .expect("a vertex")
            .coords
            .into();
        let corners =
            |t: [lin_canny::VertexId; 3]| t.map(|v| -> Point { body.vertex(v).expect("a vertex").coords.into() });
        for count in [1, 8] {
            let told = format!("{}, {count} balls", shape.name);
            let outer = cover_outside(&body, CoverGoal::Balls(count)).expect("a cover");
            let balls = plain(&outer.balls);
            for t in body.triangles() {
                let [a, b, c] = corners(t);
                assert!(contain(&balls, &[apex, a, b, c]), "{told}");
            }
            check_gap(&Geometry::from(body.clone()), &outer, &mut rng, &told);
            let inner = cover_inside(&body, count).expect("a cover");
            let faces: Vec<[Point; 3]> = body.triangles().map(corners).collect();
            for ball in plain(&inner.balls) {
                assert!(ball.1 > 0.0 && is_inside(&ball, &faces), "{told}");
            }
            println!("{told}: {:.4} {:.4}", outer.gap, inner.gap);
        }
    }
}

#[test]
fn curved_shapes_compounds_and_clouds_are_covered() {
    let mut rng = Rng::new(7);
    let at = |x: f64| Point3::new(x, 0.1 * x, 0.0);
    let die = Shape::cuboid(Vector3::new(1.0, 0.5, 0.25)).expect("a shape");
    let bodies: [Geometry; 6] = [
        Shape::capsule(1.0, 0.2).expect("a shape").into(),
        Shape::cylinder(1.0, 0.2).expect("a shape").into(),
        Shape::cone(1.0, 0.5).expect("a shape").into(),
        die.clone().rounded(0.1).expect("a shape").into(),
        Compound::new(vec![
            Piece::new(die.clone()),
            Piece::new(Shape::ball(0.7).expect("a shape")),
        ])
        .expect("a compound")
        .into(),
        Cloud::new(&[at(0.0), at(1.0), at(2.0)], CloudElement::Ball(0.3))
            .expect("a cloud")
            .into(),
    ];
    for geometry in &bodies {
        let told = geometry.kind().to_string();
        let query = PointQuery::new(geometry);
        let outer = cover_outside(geometry, CoverGoal::Balls(10)).expect("a cover");
        let inner = cover_inside(geometry, 10).expect("a cover");
        check_gap(geometry, &outer, &mut rng, &told);
        let (center, radius) = geometry.bounding_ball();
        let mut held = 0;
        for _ in 0..3000 {
            let p = center + Vector3::from([(); 3].map(|()| rng.range(-1.0, 1.0))) * radius;
            let nearest = |balls: &[Ball]| {
                let far = |ball: &Ball| (p - ball.center).norm() - ball.radius;
                balls.iter().map(far).fold(f64::INFINITY, f64::min)
            };
            let found = query.signed_distance(&p).expect("a point");
            if found.upper <= 0.0 {
                held += 1;
                assert!(nearest(&outer.balls) <= 0.0, "{told}: {p:?}");
                assert!(nearest(&inner.balls) <= inner.gap, "{told}: {p:?}");
            }
            if nearest(&inner.balls) <= 0.0 {
                assert!(found.lower <= 0.0, "{told}: {p:?}");
            }
        }
        assert!(held > 20, "{told}");
        println!("{told}: {:.4} {:.4}", outer.gap, inner.gap);
    }
}

#[test]
fn a_ball_is_covered_by_itself_and_a_point_by_a_ball_of_no_size() {
    let ball = Shape::ball(2.0).expect("a shape");
    let cover = cover_outside(&ball, CoverGoal::Balls(1)).expect("a cover");
    assert!(cover.balls.len() == 1 && cover.gap < 1e-12, "{cover:?}");
    let inner = cover_inside(&ball, 1).expect("a cover");
    assert!(inner.balls[0].radius > 1.9 && inner.gap < 0.15, "{inner:?}");
    for point in [Point3::origin(), Point3::new(1.0, 2.0, 3.0)] {
        let body = ConvexPolyhedron::point(point).expect("a point");
        let cover = cover_outside(&body, CoverGoal::Balls(3)).expect("a cover");
        assert!(contain(&plain(&cover.balls), &[point.into()]), "{cover:?}");
        assert!(cover.gap < 1e-12, "{cover:?}");
    }
    let ends = [Point3::origin(), Point3::new(1.0, 2.0, 3.0)];
    let body = ConvexPolyhedron::segment(ends[0], ends[1]).expect("a segment");
    let cover = cover_outside(&body, CoverGoal::Balls(5)).expect("a cover");
    assert!(contain(&plain(&cover.balls), &ends.map(|p| -> Point { p.into() })));
    assert!(cover.gap < 0.5, "{cover:?}");
    assert!(matches!(cover_inside(&body, 1), Err(CoverError::NoInside { .. })));
}

#[test]
fn a_gap_is_reached_or_an_error_says_how_far() {
    let mut rng = Rng::new(8);
    let soup = soups::bracket();
    let mesh = mesh(&soup);
    let mut before = 0;
    for part in [0.5, 0.2, 0.1] {
        let gap = part * soup.radius();
        let cover = cover_outside(&mesh, CoverGoal::Gap(gap)).expect("a cover");
        assert!(cover.gap <= gap, "{part}: {}", cover.balls.len());
        assert!(cover.balls.len() > before, "{part}: {}", cover.balls.len());
        before = cover.balls.len();
        let balls = plain(&cover.balls);
        assert!((0..soup.triangles.len()).all(|t| contain(&balls, &soup.corners(t))));
        assert!(inside(&soup, 50, &mut rng).into_iter().all(|p| contain(&balls, &[p])));
        println!("{part}: {before}");
    }
}

#[test]
fn parameters_and_bodies_without_a_cover_are_named() {
    let die = Shape::cuboid(Vector3::repeat(1.0)).expect("a shape");
    for balls in [0, BALLS_MAX + 1] {
        let found = cover_outside(&die, CoverGoal::Balls(balls));
        assert_eq!(found, Err(CoverError::Balls { balls }));
        assert_eq!(cover_inside(&die, balls), Err(CoverError::Balls { balls }));
    }
    for gap in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = cover_outside(&die, CoverGoal::Gap(gap)).expect_err("no gap");
        assert!(
            error.to_string().starts_with("gap of the cover is out of range"),
            "{error}"
        );
    }
    let floor = HalfSpace::new(Vector3::z(), 0.0).expect("a half-space");
    let error = cover_outside(&floor, CoverGoal::Balls(1)).expect_err("unbounded");
    assert_eq!(error.to_string(), "a half-space has no cover: it is not bounded");
    assert!(cover_inside(&floor, 1).is_err());
}

/// Files below a folder.
fn files(folder: &std::path::Path) -> Vec<std::path::PathBuf> {
    let (mut folders, mut all) = (vec![folder.to_owned()], vec![]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("a file").path();
            if path.is_dir() { &mut folders } else { &mut all }.push(path);
        }
    }
    all.sort();
    all
}

#[test]
#[ignore = "needs a folder of files: LIN_CANNY_MESHES=FOLDER cargo test --all-features --test cover mesh_files -- --ignored --nocapture"]
fn mesh_files_are_covered_exactly() {
    let folder = std::env::var("LIN_CANNY_MESHES").expect("LIN_CANNY_MESHES names a folder");
    let (mut rng, mut count) = (Rng::new(9), 0);
    for path in files(std::path::Path::new(&folder)) {
        let Some(soup) = Soup::read(&path) else { continue };
        let points: Vec<_> = soup.points.iter().map(|p| Point3::from(*p)).collect();
        if Mesh::new(&points, &soup.triangles).is_err() {
            println!("{}: no mesh", path.display());
            continue;
        }
        let gaps = check_mesh(&soup, 16, &mut rng, &path.display().to_string());
        println!(
            "{}: {} triangles, gaps {gaps:.4?}",
            path.display(),
            soup.triangles.len()
        );
        count += 1;
    }
    println!("{count} meshes");
    assert!(count > 0, "no mesh in {folder}");
}

//! Convex pieces that replace a mesh: gaps are bracketed, and distances are intervals that hold for
//! the mesh.

use super::{mesh, relative};
use lin_canny::cover::hull_outside;
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::{Compound, ContactState, ConvexPolyhedron, Decomposition, Mesh, MeshError, PairTracker, Piece, Shape};
use truth::body::Body;
use truth::exact::distance_to_body;
use truth::pose::scale;
use truth::rng::Rng;
use truth::soups::{self, Soup};
use truth::support::piece_at;
use truth::{Face, Point, Pose};

fn hull(points: &[[f64; 3]]) -> Piece {
    let points: Vec<_> = points.iter().map(|p| Point3::from(*p)).collect();
    Piece::new(ConvexPolyhedron::from_points(&points).unwrap())
}

/// Returns a tube as the hulls of stretches of `rows` rings of `m` points.
fn stretches(soup: &Soup, m: usize, rows: usize) -> Compound {
    let count = soup.points.len() / m;
    let piece = |first: usize| {
        let points = (first..=first + rows).flat_map(|i| &soup.points[i % count * m..][..m]);
        hull(&points.copied().collect::<Vec<_>>())
    };
    Compound::new((0..count).step_by(rows).map(piece).collect()).unwrap()
}

/// Returns meshes with pieces that are larger, smaller, or neither.
fn cases() -> Vec<(Mesh, Compound)> {
    let torus = soups::torus(24, 12, 0.3);
    let thin = soups::torus(24, 12, 0.25);
    let knot = soups::knot(104, 8, 0.12);
    let mut turned = stretches(&torus, 12, 3).pieces().to_vec();
    for piece in &mut turned {
        // The same pieces, each in a separate frame.
        let turn = Isometry3::new(Vector3::new(0.1, -0.2, 0.3), Vector3::new(0.4, 0.1, -0.2));
        let body = ConvexPolyhedron::from_points(&corners(piece).map(|p| turn * p).collect::<Vec<_>>()).unwrap();
        *piece = piece_at(turn.inverse(), body);
    }
    vec![
        (mesh(&torus), stretches(&torus, 12, 3)),
        (mesh(&torus), Compound::new(turned).unwrap()),
        (mesh(&torus), stretches(&thin, 12, 4)),
        (mesh(&knot), stretches(&knot, 8, 4)),
        (
            mesh(&soups::bracket()),
            Compound::new(vec![hull(&soups::bracket().points)]).unwrap(),
        ),
    ]
}

fn corners(piece: &Piece) -> impl Iterator<Item = Point3<f64>> + '_ {
    let lin_canny::shape::Core::Polyhedron(body) = piece.shape.core() else {
        panic!("a polyhedron");
    };
    body.vertex_points().map(|p| piece.pose * p)
}

#[test]
fn gaps_are_bracketed() {
    let mut rng = Rng::new(21);
    for (m, pieces) in cases() {
        let d = Decomposition::new(m.clone(), pieces).unwrap();
        let fit = d.fit();
        let mut speck = PairTracker::new();
        let mut other = PairTracker::new();
        let (mut excess, mut shortfall) = (0.0f64, 0.0f64);
        let dot = |p: Point3<f64>| Compound::from(Shape::from(ConvexPolyhedron::point(p).unwrap()));
        let still = relative(&Pose::IDENTITY);
        for piece in d.pieces().pieces() {
            let all: Vec<_> = corners(piece).collect();
            for _ in 0..40 {
                // Points of the hull, most of them on its surface: combinations of a few vertices.
                let w = [0, 1, 2].map(|_| rng.range(0.0, 1.0));
                let [a, b, c] = [0, 1, 2].map(|_| all[rng.below(all.len())].coords);
                let p = (a * w[0] + b * w[1] + c * w[2]) / (w[0] + w[1] + w[2]);
                excess = excess.max(other.distance(&m, &dot(Point3::from(p)), &still).value);
            }
        }
        for (_, [a, b, c]) in m.triangles().step_by(3) {
            let (u, v) = (rng.range(0.0, 0.5), rng.range(0.0, 0.5));
            let p = a + (b - a) * u + (c - a) * v;
            shortfall = shortfall.max(other.distance(d.pieces(), &dot(p), &still).value);
        }
        assert!(excess <= fit.excess_upper, "{excess} {shortfall} {fit}");
        assert!(shortfall <= fit.shortfall_upper, "{excess} {shortfall} {fit}");
        assert!(excess >= 0.3 * fit.excess_lower, "{excess} {shortfall} {fit}");
        assert!(shortfall >= 0.3 * fit.shortfall_lower, "{excess} {shortfall} {fit}");
        assert!(fit.excess_upper - fit.excess_lower < 0.01, "{fit}");
        assert!(fit.shortfall_upper - fit.shortfall_lower < 0.01, "{fit}");
        let found = speck
            .distance(&m, d.mesh(), &relative(&Pose::shift([9.0, 0.0, 0.0])))
            .state;
        assert_eq!(found, ContactState::Separated);
    }
}

#[test]
fn distances_are_intervals_that_hold_for_the_mesh() {
    let mut rng = Rng::new(22);
    let others = [
        soups::torus(14, 7, 0.3),
        soups::gear(6),
        soups::sphere(1).map(|p| scale(p, 0.1)),
    ];
    let others = others.map(|s| mesh(&s));
    let (mut apart, mut open) = (0, 0);
    for (m, pieces) in cases() {
        let d = Decomposition::new(m.clone(), pieces).unwrap();
        for other in &others {
            let (mut pair, mut exact) = (PairTracker::new(), PairTracker::new());
            for k in 0..60 {
                let pose = Pose::new(rng.quat(), scale(rng.unit(), rng.range(0.0, 3.0)));
                let found = d.distance(&mut pair, other, &relative(&pose));
                let truth = exact.distance(&m, other, &relative(&pose));
                assert!(found.lower <= truth.upper, "{k} {found:?} {truth:?}");
                assert!(truth.lower <= found.upper, "{k} {found:?} {truth:?}");
                assert!((found.lower..=found.upper).contains(&found.value), "{k} {found:?}");
                match found.state {
                    ContactState::Separated => apart += 1,
                    ContactState::Overlapping => panic!("{k}: no body is held here {found:?}"),
                    _ => open += 1,
                }
            }
        }
    }
    assert!(apart > 300 && open > 100, "{apart} {open}");
}

#[test]
fn a_body_that_the_mesh_holds_and_the_pieces_do_not_is_found() {
    // Six walls that represent a solid cube: near all of its surface, but hollow.
    let cube = mesh(&soups::plate(2, [1.0, 1.0, 1.0]));
    let wall = |axis: usize, side: f64| {
        let mut half = Vector3::repeat(1.0);
        half[axis] = 0.05;
        let mut piece = Piece::new(Shape::cuboid(half).unwrap());
        piece.pose.translation.vector[axis] = 0.95 * side;
        piece
    };
    let walls = (0..6).map(|k| wall(k / 2, if k % 2 == 0 { 1.0 } else { -1.0 }));
    let d = Decomposition::new(cube.clone(), Compound::new(walls.collect()).unwrap()).unwrap();
    assert!(d.fit().shortfall_upper < 0.01, "{}", d.fit());
    assert!(d.fit().excess_upper < 0.01, "{}", d.fit());
    let pebble = mesh(&soups::sphere(1).map(|p| scale(p, 0.2)));
    let found = d.distance(&mut PairTracker::new(), &pebble, &relative(&Pose::IDENTITY));
    assert_eq!(found.state, ContactState::Overlapping);
    assert_eq!(found.lower, 0.0);
    assert_eq!(found.upper, 0.0);
    // The opposite case: another body contains both.
    let big = mesh(&soups::sphere(2).map(|p| scale(p, 9.0)));
    let found = d.distance(&mut PairTracker::new(), &big, &relative(&Pose::IDENTITY));
    assert!(found.lower == 0.0, "{found:?}");
}

#[test]
fn pieces_without_corners_are_refused_and_flat_ones_are_measured() {
    let plate = mesh(&soups::plate(2, [1.0, 0.5, 0.1]));
    let ball = Compound::from(Shape::ball(0.5).unwrap());
    let refused = Decomposition::new(plate.clone(), ball).unwrap_err();
    assert_eq!(refused, MeshError::Curved { piece: 0 });
    let rod = ConvexPolyhedron::segment(Point3::new(-1.0, 0.0, 0.0), Point3::new(2.0, 0.0, 0.0)).unwrap();
    let d = Decomposition::new(plate, Compound::from(Shape::from(rod))).unwrap();
    let fit = d.fit();
    // The end of the rod protrudes by one; a corner of the plate is the root of 0.26 away.
    assert!(fit.excess_lower > 0.99 && fit.excess_upper < 1.01, "{fit}");
    assert!(fit.shortfall_lower > 0.5 && fit.shortfall_upper < 0.52, "{fit}");
}

/// A piece as data of the exact oracle: vertices, faces, pose.
fn data(piece: &Piece) -> (Vec<Point>, Vec<Face>, Pose) {
    let lin_canny::shape::Core::Polyhedron(body) = piece.shape.core() else {
        panic!("a polyhedron");
    };
    let rim = |f| body.face_vertices(f).map(|v| v.index() as u32).collect();
    let (q, t) = (piece.pose.rotation.coords, piece.pose.translation.vector);
    let pose = Pose::new([q.x, q.y, q.z, q.w], t.into());
    (
        body.vertex_points().map(|p| p.into()).collect(),
        body.faces().map(rim).collect(),
        pose,
    )
}

/// Checks that grown pieces contain vertices and random points of a mesh, by exact distances.
fn check_grown(m: &Mesh, pieces: Compound, every: usize, rng: &mut Rng, told: &str) {
    let before = Decomposition::new(m.clone(), pieces).unwrap();
    let after = before.grown().unwrap();
    let radius = before.fit().shortfall_upper;
    assert_eq!(after.fit().shortfall_lower, 0.0, "{told}");
    assert_eq!(after.fit().shortfall_upper, 0.0, "{told}");
    assert!(after.fit().excess_upper >= before.fit().excess_upper + radius, "{told}");
    let all: Vec<_> = after.pieces().pieces().iter().map(data).collect();
    let mut farthest = 0.0f64;
    for (_, [a, b, c]) in m.triangles().step_by(every) {
        let (u, v) = (rng.range(0.0, 0.5), rng.range(0.0, 0.5));
        for p in [a, a + (b - a) * u + (c - a) * v] {
            let near = all.iter().map(|(points, faces, pose)| {
                let body = Body::new(points, faces);
                distance_to_body(p.into(), body, pose)
            });
            farthest = farthest.max(near.fold(f64::INFINITY, f64::min));
        }
    }
    // Points between corners are rounded by a part of the size.
    assert!(farthest <= radius * (1.0 + 1e-13), "{told}: {farthest:e} {radius:e}");
    for piece in after.pieces().pieces() {
        assert_eq!(piece.shape.rounding_radius(), radius, "{told}");
    }
    // Points of the grown surfaces, by the normals of faces, are no farther than the excess.
    let (mut pair, still) = (PairTracker::new(), relative(&Pose::IDENTITY));
    for piece in after.pieces().pieces() {
        let lin_canny::shape::Core::Polyhedron(body) = piece.shape.core() else {
            panic!("a polyhedron");
        };
        for face in body.faces() {
            let n = body.face_plane(face).unwrap().0;
            for v in body.face_vertices(face) {
                let p = piece.pose * (body.vertex(v).unwrap() + n.into_inner() * radius);
                let dot = Compound::from(Shape::from(ConvexPolyhedron::point(p).unwrap()));
                let lower = pair.distance(m, &dot, &still).lower;
                assert!(lower <= after.fit().excess_upper, "{told}: {lower:e} {}", after.fit());
            }
        }
    }
}

#[test]
fn grown_pieces_cover_the_mesh() {
    let mut rng = Rng::new(23);
    for (k, (m, pieces)) in cases().into_iter().enumerate() {
        check_grown(&m, pieces, 11, &mut rng, &format!("case {k}"));
    }
    for scale in [1e-80, 1e80] {
        let torus = soups::torus(12, 8, 0.3).map(|p| p.map(|x| x * scale));
        let thin = soups::torus(12, 8, 0.2).map(|p| p.map(|x| x * scale));
        check_grown(
            &mesh(&torus),
            stretches(&thin, 8, 3),
            5,
            &mut rng,
            &format!("{scale:e}"),
        );
    }
}

#[test]
#[ignore = "200 tubes, minutes: cargo test --release --all-features --test meshes grown_pieces_of_many -- --ignored"]
fn grown_pieces_of_many_meshes_cover_them() {
    let mut rng = Rng::new(24);
    for k in 0..200 {
        let (n, m) = (6 + rng.below(20), 3 + rng.below(9));
        let tube = rng.range(0.05, 0.45);
        let scale = 10f64.powf(rng.range(-80.0, 80.0));
        let put = |s: Soup| s.map(|p| p.map(|x| x * scale));
        let torus = put(soups::torus(n, m, tube));
        let thin = put(soups::torus(n, m, tube * rng.range(0.5, 1.2)));
        let rows = 1 + rng.below(n / 2);
        check_grown(&mesh(&torus), stretches(&thin, m, rows), 3, &mut rng, &format!("{k}"));
    }
}

#[test]
fn distances_of_grown_pieces_hold_for_the_mesh() {
    let mut rng = Rng::new(25);
    let other = mesh(&soups::gear(6));
    for (m, pieces) in cases() {
        let grown = Decomposition::new(m.clone(), pieces).unwrap().grown().unwrap();
        let (mut pair, mut exact) = (PairTracker::new(), PairTracker::new());
        for _ in 0..60 {
            let pose = Pose::new(rng.quat(), scale(rng.unit(), rng.range(0.0, 4.0)));
            let found = grown.distance(&mut pair, &other, &relative(&pose));
            let truth = exact.distance(&m, &other, &relative(&pose));
            assert!(found.lower <= truth.upper, "{found:?} {truth:?}");
            assert!(truth.lower <= found.upper, "{found:?} {truth:?}");
        }
    }
}

/// A grown piece as a polyhedron, for programs without rounded shapes.
#[test]
fn grown_pieces_are_contained_in_hulls() {
    let (m, pieces) = cases().swap_remove(2);
    let grown = Decomposition::new(m.clone(), pieces).unwrap().grown().unwrap();
    let hulls: Vec<_> = grown
        .pieces()
        .pieces()
        .iter()
        .map(|piece| hull_outside(&piece.shape, 24).unwrap())
        .collect();
    let holds = |p: &Point3<f64>| hulls.iter().any(|cover| cover.hull.contains(p));
    assert!(m.triangles().all(|(_, corners)| corners.iter().all(holds)));
}

#[test]
fn pieces_that_cannot_grow_are_named() {
    let unit = 1e-99;
    let torus = soups::torus(8, 6, 0.3).map(|p| p.map(|x| x * unit));
    let d = Decomposition::new(mesh(&torus), stretches(&torus, 6, 1)).unwrap();
    let radius = d.fit().shortfall_upper;
    assert!(radius < 1e-100, "{radius:e}");
    assert_eq!(d.grown().map(|_| ()), Err(MeshError::Growth { radius }));
}

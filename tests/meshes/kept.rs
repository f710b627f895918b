//! Promise: cached state is recognised by everything that it relies on, and by each item alone.
//!
//! One tracker queries two bodies alternately that differ in nothing else. Its answers are those of
//! new trackers.
//!
//! | state | relies on | test |
//! |---|---|---|
//! | front of two meshes | positions of vertices, triangles below each node of the tree | `trees`, `copies` |
//! | its claims after `set_vertices` | the caller's numbers of the vertices, every change since the build | `numbers`, `copies` |
//! | front of a mesh against itself | like both before | `trees`, `numbers` |
//! | surface that represents a mesh | like both before | `numbers` |
//! | contact patches of a mesh | like both before, the caller's numbers of the triangles | `names` |
//! | closest subshapes of the last answer | the order of triangles in the tree | `names` |
//! | pieces that came near | shapes and poses of all pieces, in their order | `pieces` |
//! | closest features of two polyhedra | nothing: each is tried on the current bodies | `features` |
//! | manifold | vertices, faces and radius of both | `features` |
//! | shape, compound or mesh that represents another body | that body, by one of the above | `pieces`, `features` |

use super::relative;
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::surface::BezierSurface;
use lin_canny::{
    Compound, ConvexPolyhedron, Geometry, Manifold, ManifoldOptions, Mesh, PairOutcome, PairTracker, RelativePose,
    Shape, Tracker,
};
use truth::Pose;
use truth::rng::Rng;
use truth::support::Decide;
use truth::support::piece_at;

fn cuboid(half: [f64; 3]) -> ConvexPolyhedron {
    solids::cuboid(Vector3::from(half)).unwrap()
}

fn poses(count: usize, reach: f64, seed: u64) -> Vec<RelativePose> {
    let mut rng = Rng::new(seed);
    let mut next = || Pose::new(rng.quat(), rng.in_ball().map(|x| x * reach));
    (0..count).map(|_| relative(&next())).collect()
}

fn agree(found: &PairOutcome, fresh: &PairOutcome) -> bool {
    found.lower <= fresh.upper && fresh.lower <= found.upper && found.distance.is_finite()
}

/// Queries bodies in turn against another body; every answer must be that of a new tracker.
fn in_turn(bodies: &[Geometry], other: &Geometry, poses: &[RelativePose]) {
    let mut tracker = PairTracker::new();
    for (k, pose) in poses.iter().enumerate() {
        let body = &bodies[k % bodies.len()];
        let found = tracker.closest(body, other, pose);
        let fresh = PairTracker::new().closest(body, other, pose);
        assert!(agree(&found, &fresh), "{k}: {found:?} {fresh:?}");
        let next = &bodies[(k + 1) % bodies.len()];
        let fresh = PairTracker::new().closest(next, other, pose);
        assert!(tracker.lower_bound(next, other, pose) <= fresh.upper.max(0.0), "{k}");
        for d in [0.5 * fresh.lower, 1.5 * fresh.upper + 0.01]
            .into_iter()
            .filter(|d| *d >= 0.0)
        {
            let now = tracker.decide(next, other, pose, d);
            let truth = PairTracker::new().decide(next, other, pose, d);
            assert!(now == truth || !(now.is_yes() || now.is_no()), "{k}: {now:?} {truth:?}");
        }
    }
}

/// Returns a bent sheet of squares in which some vertices are numbered differently.
fn sheet(swaps: &[(usize, usize)]) -> Mesh {
    let place = |i: usize, j: usize| Point3::new(i as f64 * 0.25 - 1.0, j as f64 * 0.25 - 1.0, 0.0);
    let points: Vec<_> = (0..9).flat_map(|i| (0..9).map(move |j| place(i, j))).collect();
    let mut number: Vec<u32> = (0..81).collect();
    swaps.iter().for_each(|&(i, j)| number.swap(i, j));
    let square = |i: u32, j: u32| {
        let [a, b, c, d] = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(k, l)| (i + k) * 9 + j + l);
        [[a, b, c], [a, c, d]]
    };
    let triangles: Vec<[u32; 3]> = (0..8).flat_map(|i| (0..8).flat_map(move |j| square(i, j))).collect();
    let mut given = points.clone();
    (0..81).for_each(|k| given[number[k] as usize] = points[k]);
    let named: Vec<_> = triangles.iter().map(|t| t.map(|v| number[v as usize])).collect();
    Mesh::new(&given, &named).unwrap()
}

/// Sets the vertices to one list of positions, for any of the sheets.
fn bend(mesh: &mut Mesh) {
    let place = |k: u32| {
        let (x, y) = (f64::from(k / 9) * 0.25 - 1.0, f64::from(k % 9) * 0.25 - 1.0);
        Point3::new(x, y, 0.3 * (2.0 * x + y).sin() + 0.01 * f64::from(k % 7))
    };
    mesh.set_vertices(&(0..81).map(place).collect::<Vec<_>>()).unwrap();
}

#[test]
fn numbers_of_vertices_tell_meshes_apart() {
    let mut meshes = [sheet(&[]), sheet(&[(0, 80), (3, 44)]), sheet(&[(40, 41)])];
    meshes.iter_mut().for_each(bend);
    let bodies = meshes.clone().map(Geometry::from);
    let die = cuboid([0.1, 0.15, 0.05]);
    in_turn(&bodies, &Mesh::from_convex(&die).unwrap().into(), &poses(40, 1.0, 1));
    in_turn(&bodies, &die.clone().into(), &poses(20, 1.0, 2));
    in_turn(
        &bodies,
        &BezierSurface::from_convex(&die).unwrap().into(),
        &poses(9, 2.0, 3),
    );
    let mut tracker = PairTracker::new();
    for k in 0..12 {
        let mesh = &meshes[k % 3];
        let found = tracker.self_closest(mesh).unwrap();
        let fresh = PairTracker::new().self_closest(mesh).unwrap();
        assert!(agree(&found, &fresh), "{k}: {found:?} {fresh:?}");
    }
}

#[test]
fn names_are_those_of_the_body_that_is_asked() {
    let die = cuboid([0.5; 3]);
    let given: Vec<_> = die.vertex_points().collect();
    let triangles: Vec<_> = die.triangles().map(|t| t.map(|v| v.index() as u32)).collect();
    // The same body with reversed numbers of triangles and vertices.
    let last = given.len() as u32 - 1;
    let back: Vec<_> = triangles.iter().rev().map(|t| t.map(|v| last - v)).collect();
    let turned: Vec<_> = given.iter().rev().copied().collect();
    let lists = [(given, triangles), (turned, back)];
    let meshes = [0, 1].map(|k| Mesh::new(&lists[k].0, &lists[k].1).unwrap());
    let ball = Mesh::from_convex(&solids::icosahedron(0.3).unwrap()).unwrap();
    let (mut tracker, mut touched) = (PairTracker::new(), PairTracker::new());
    let options = ManifoldOptions::default().prediction(0.1);
    for (k, pose) in poses(60, 1.5, 4).iter().enumerate() {
        let (points, triangles) = &lists[k % 2];
        let found = tracker.closest(&meshes[k % 2], &ball, pose);
        let corners = triangles[found.locations[0].subshape as usize].map(|v| points[v as usize]);
        // The witness lies on the reported triangle.
        if found.lower > 0.0 {
            let named = Shape::from(ConvexPolyhedron::polygon(&corners).unwrap());
            let witness = Shape::from(ConvexPolyhedron::point(found.point_on_a).unwrap());
            let off = PairTracker::new().closest(&named, &witness, &relative(&Pose::IDENTITY));
            assert!(off.distance < 1e-12, "{k}: {found:?}");
        }
        let count = |t: &mut PairTracker| {
            let groups = t.contacts(&meshes[k % 2], &ball, pose, &options).unwrap();
            groups.iter().map(|g| g.contacts.len()).sum::<usize>() > 0
        };
        assert_eq!(count(&mut touched), count(&mut PairTracker::new()), "{k}");
    }
}

#[test]
fn trees_tell_meshes_apart() {
    let mut whole = sheet(&[]);
    bend(&mut whole);
    let mut rebuilt = whole.clone();
    rebuilt.rebuild();
    let mut again = rebuilt.clone();
    bend(&mut again);
    let bodies = [whole, rebuilt, again].map(Geometry::from);
    in_turn(
        &bodies,
        &Mesh::from_convex(&cuboid([0.1; 3])).unwrap().into(),
        &poses(40, 1.0, 5),
    );
}

#[test]
fn pieces_tell_composites_apart() {
    let piece = |shape: Shape, x: f64| piece_at(Isometry3::translation(x, 0.0, 0.0), shape);
    let die = || Shape::from(cuboid([0.5; 3]));
    let point = || Shape::from(ConvexPolyhedron::point(Point3::origin()).unwrap());
    let bodies = [
        vec![piece(die(), 0.0), piece(die(), 2.0)],
        vec![piece(die(), 2.0), piece(die(), 0.0)],
        vec![piece(die(), 0.0), piece(die(), 2.5)],
        vec![piece(die(), 0.0), piece(point(), 2.0)],
        vec![piece(die(), 0.0), piece(die().rounded(0.1).unwrap(), 2.0)],
        vec![piece(die(), 0.0)],
    ]
    .map(|pieces| Geometry::from(Compound::new(pieces).unwrap()));
    let partners: [Geometry; 3] = [
        Mesh::from_convex(&cuboid([0.3; 3])).unwrap().into(),
        cuboid([0.3; 3]).into(),
        Shape::ball(0.3).unwrap().into(),
    ];
    for other in &partners {
        in_turn(&bodies, other, &poses(60, 3.0, 6));
    }
}

#[test]
fn features_are_tried_on_the_bodies_that_are_asked() {
    let hull = solids::random_hull(20, Vector3::repeat(0.5), 7).unwrap();
    let back: Vec<_> = hull.vertex_points().collect::<Vec<_>>().into_iter().rev().collect();
    let bodies = [
        hull.clone(),
        ConvexPolyhedron::from_points(&back).unwrap(),
        ConvexPolyhedron::from_points(&back[3..]).unwrap(),
        cuboid([0.4; 3]),
    ];
    let other = cuboid([0.3, 0.4, 0.5]);
    let (mut tracker, mut manifolds, mut kept) = (Tracker::new(), PairTracker::new(), Manifold::default());
    let options = ManifoldOptions::default().prediction(0.05);
    for (k, pose) in poses(200, 1.2, 8).iter().enumerate() {
        let body = &bodies[k % 4];
        let found = tracker.closest(body, &other, pose);
        let fresh = Tracker::new().closest(body, &other, pose);
        assert!(found.lower <= fresh.upper, "{k}: {found:?} {fresh:?}");
        assert!(fresh.lower <= found.upper, "{k}: {found:?} {fresh:?}");
        manifolds.manifold(body, &other, pose, &options, &mut kept).unwrap();
        let mut fresh = Manifold::default();
        PairTracker::new()
            .manifold(body, &other, pose, &options, &mut fresh)
            .unwrap();
        assert_eq!(kept.points().is_empty(), fresh.points().is_empty(), "{k}");
    }
    let rounded = bodies.map(|body| Geometry::from(Shape::from(body).rounded(0.1).unwrap()));
    in_turn(&rounded, &Shape::cylinder(0.3, 0.4).unwrap().into(), &poses(40, 1.5, 9));
}

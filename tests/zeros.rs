//! No zero in a result has a sign: lattices of touching bodies, and zeros of both signs in poses,
//! quaternions and vertices.

use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids::cuboid;
use lin_canny::scene::{Body, Group, PairQueries, Scene};
use lin_canny::{Compound, ConvexPolyhedron, Geometry, Mesh, PairTracker, Piece, RelativePose, Shape};

fn bits(x: f64) -> u64 {
    x.to_bits()
}

/// Returns a sheet of one triangle in the plane z = -0.5.
fn sheet() -> Mesh {
    let corners = [[-0.5, -0.5, -0.5], [0.5, -0.5, -0.5], [-0.5, 0.5, -0.5]].map(Point3::from);
    Mesh::new(&corners, &[[0, 1, 2]]).unwrap()
}

#[test]
fn a_sheet_and_a_can_that_touch_have_a_distance_without_a_sign() {
    let (sheet, can) = (sheet(), Shape::cylinder(0.5, 0.5).unwrap());
    let pose = RelativePose::from_isometry(&Isometry3::translation(0.0, -0.5, -1.0)).unwrap();
    let found = PairTracker::new().closest(&sheet, &can, &pose);
    assert_eq!((bits(found.distance), bits(found.lower)), (0, 0), "{found:?}");
}

/// Of several pairs at distance zero, the scene returns the first, for all kinds.
#[test]
fn of_ties_at_zero_the_first_pair_is_the_closest() {
    let cube = || cuboid(Vector3::repeat(0.5)).unwrap();
    let at = |x: f64, y: f64, z: f64| Isometry3::translation(x, y, z);
    let cubes: [(Geometry, _); 2] = [(cube().into(), at(9.0, 0.0, 0.0)), (cube().into(), at(9.0, 1.0, 0.0))];
    let can = Shape::cylinder(0.5, 0.5).unwrap();
    let mixed: [(Geometry, _); 2] = [(sheet().into(), at(0.0, 0.0, 0.0)), (can.into(), at(0.0, -0.5, -1.0))];
    for order in [[cubes.clone(), mixed.clone()], [mixed, cubes]] {
        let mut scene = Scene::new();
        let group = Group::new(0).unwrap();
        scene
            .set_queries(group, group, PairQueries::none().distance(0.5))
            .unwrap();
        let ids: Vec<_> = order
            .into_iter()
            .flatten()
            .map(|(g, pose)| scene.insert(Body::moving(g), pose).unwrap())
            .collect();
        scene.step();
        let found = scene.closest_pair(group, group).unwrap().unwrap();
        assert_eq!((found.a, found.b), (ids[0], ids[1]));
        assert_eq!(bits(found.outcome.distance), 0);
    }
}

/// Returns a number of a small lattice, with zeros of both signs.
fn lattice(state: &mut u64) -> f64 {
    *state = state
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    [-1.0, -0.5, -0.0, 0.0, 0.5, 1.0][(*state >> 33) as usize % 6]
}

/// Returns a body of each kind; its vertices have zeros of both signs.
fn bodies(state: &mut u64) -> Vec<Geometry> {
    let mut point = || Point3::new(lattice(state), lattice(state), lattice(state));
    let cloud: Vec<_> = (0..12).map(|_| point()).collect();
    let mut all: Vec<Geometry> = vec![
        cuboid(Vector3::repeat(0.5)).unwrap().into(),
        ConvexPolyhedron::point(point()).unwrap().into(),
        Shape::ball(0.5).unwrap().into(),
        Shape::cylinder(0.5, 0.5).unwrap().into(),
        Shape::cone(0.5, 0.5).unwrap().into(),
        sheet().into(),
        Mesh::from_convex(&cuboid(Vector3::repeat(0.5)).unwrap())
            .unwrap()
            .into(),
    ];
    if let Ok(hull) = ConvexPolyhedron::from_points(&cloud) {
        all.push(hull.into());
    }
    let turned = [(0.5, 0.0), (-0.5, -0.0)].map(|(x, y)| {
        let piece = Shape::from(cuboid(Vector3::new(0.5, 0.25, 0.5)).unwrap());
        let mut piece = Piece::new(piece);
        piece.pose = Isometry3::translation(x, y, -0.0);
        piece
    });
    all.push(Compound::new(turned.to_vec()).unwrap().into());
    all
}

/// Returns zeros of both signs around and within the unit quaternions of quarter turns.
fn pose(state: &mut u64) -> Isometry3<f64> {
    let mut q = [0; 4].map(|_| lattice(state));
    if q.iter().filter(|x| x.abs() > 0.25).count() == 0 {
        q[3] = 1.0;
    }
    let turn = UnitQuaternion::new_normalize(Quaternion::from(q));
    Isometry3::from_parts(Translation3::new(lattice(state), lattice(state), lattice(state)), turn)
}

#[test]
fn no_zero_of_an_answer_has_a_sign() {
    let (mut state, mut zeros) = (7, [0; 3]);
    for _ in 0..120 {
        let (all, tracker) = (bodies(&mut state), &mut PairTracker::new());
        for (a, b) in all.iter().flat_map(|a| all.iter().map(move |b| (a, b))) {
            let pose = RelativePose::from_isometry(&pose(&mut state)).unwrap();
            let found = tracker.closest(a, b, &pose);
            let numbers = [found.distance, found.lower, found.upper];
            for (zeros, x) in zeros.iter_mut().zip(numbers) {
                *zeros += u32::from(x == 0.0);
                assert!(x != 0.0 || bits(x) == 0, "{a:?}\n{b:?}\n{pose:?}\n{found:?}");
            }
        }
    }
    assert!(zeros.iter().all(|&n| n > 50), "{zeros:?}");
}

//! Shapes of every kind against meshes and in compounds: against all pairs of subshapes, in both
//! orders, warm and cold.

use super::{mesh, relative};
use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::{Compound, ContactState, ConvexPolyhedron, Mesh, MeshError, PairTracker, RelativePose, Shape};
use truth::forms::shapes;
use truth::pose::{quat, quat_mul, scale, unit_quat};
use truth::rng::Rng;
use truth::soups::{self, Soup};
use truth::support::piece_at;
use truth::{Pose, brute};

/// Half lengths of the boxes of the shapes.
const HALF: [f64; 3] = [0.3, 0.2, 0.25];

/// Returns the least distance of any triangle and any piece, each pair queried alone.
fn all_pairs(soup: &Soup, body: &Compound, pose: &Pose) -> f64 {
    let mut least = f64::INFINITY;
    for t in 0..soup.triangles.len() {
        let triangle = Shape::from(ConvexPolyhedron::polygon(&soup.corners(t).map(Point3::from)).unwrap());
        for piece in body.pieces() {
            let placed = RelativePose::from_isometry(&(pose.isometry() * piece.pose)).unwrap();
            least = least.min(PairTracker::new().distance(&triangle, &piece.shape, &placed).value);
        }
    }
    least.max(0.0)
}

/// Tumbles a mesh and a body over frames; counts contact states.
fn tumble((soup, m): (&Soup, &Mesh), body: &Compound, seed: u64, tally: &mut [usize; 2]) {
    let mut rng = Rng::new(seed);
    let (mut q, axis, at) = (rng.quat(), rng.unit(), rng.unit());
    let (mut warm, mut back) = (PairTracker::new(), PairTracker::new());
    for frame in 0..30 {
        q = unit_quat(quat_mul(quat(axis, 0.02), q));
        let t = scale(at, 0.9 + 0.8 * (0.25 * f64::from(frame)).sin());
        let pose = Pose::new(q, t);
        let at = relative(&pose);
        let found = warm.closest(m, body, &at);
        let cold = PairTracker::new().closest(m, body, &at);
        let other = back.closest(body, m, &at.swapped());
        assert_eq!((cold.state, other.state), (found.state, found.state), "{seed} {frame}");
        let truth = all_pairs(soup, body, &pose);
        let inside = brute::winding(soup, t).abs() > 0.5;
        if found.state == ContactState::Separated {
            for o in [&found, &cold, &other] {
                assert!((o.distance - truth).abs() < 1e-9, "{seed} {frame} {o:?} {truth}");
                assert!(o.lower <= truth + 1e-12 && truth <= o.upper + 1e-9, "{o:?} {truth}");
            }
            assert!(!inside, "{seed} {frame} {found:?}");
            let on_b = pose.apply(found.point_on_b.into());
            let apart = truth::pose::norm(truth::pose::sub(on_b, found.point_on_a.into()));
            assert!((apart - truth).abs() < 1e-9, "{seed} {frame} {apart} {truth}");
            assert!(warm.lower_bound(m, body, &at) <= truth + 1e-12);
            assert!(warm.within(m, body, &at, truth + 1e-9) && !warm.within(m, body, &at, truth - 1e-9));
        } else {
            assert!(inside || truth < 1e-9, "{seed} {frame} {found:?} {truth}");
            assert!(warm.intersects(m, body, &at));
        }
        tally[usize::from(found.state == ContactState::Separated)] += 1;
    }
}

#[test]
fn shapes_against_meshes_equal_all_pairs() {
    let mut tally = [0; 2];
    for (k, soup) in [soups::torus(16, 8, 0.3), soups::rock(2, 3), soups::bracket()]
        .iter()
        .enumerate()
    {
        let m = mesh(soup);
        for (i, shape) in shapes(HALF).into_iter().enumerate() {
            tumble((soup, &m), &Compound::from(shape), (10 * k + i) as u64, &mut tally);
        }
    }
    assert!(tally.iter().all(|t| *t > 150), "{tally:?}");
}

#[test]
fn bodies_of_all_kinds_against_meshes_equal_all_pairs() {
    let mut tally = [0; 2];
    let soup = soups::torus(16, 8, 0.3);
    let m = mesh(&soup);
    for seed in 0..12 {
        let mut rng = Rng::new(100 + seed);
        let place = |shape: Shape| {
            let pose = Pose::new(rng.quat(), scale(rng.in_ball(), 0.5));
            piece_at(pose.isometry(), shape)
        };
        let body = Compound::new(shapes(HALF).into_iter().map(place).collect()).unwrap();
        assert_eq!(body.to_mesh().unwrap_err(), MeshError::Curved { piece: 0 });
        tumble((&soup, &m), &body, 200 + seed, &mut tally);
    }
    assert!(tally.iter().all(|t| *t > 15), "{tally:?}");
}

#[test]
fn a_shape_inside_a_solid_overlaps_and_inside_a_surface_does_not() {
    let ball = soups::sphere(2);
    let solid = mesh(&ball);
    let mut open = ball.clone();
    open.triangles.pop();
    let surface = mesh(&open);
    for shape in shapes(HALF) {
        let body = Compound::from(shape);
        let at = relative(&Pose::shift([0.1, 0.0, 0.2]));
        let found = PairTracker::new().closest(&solid, &body, &at);
        assert_eq!((found.state, found.distance), (ContactState::Overlapping, 0.0));
        assert!(PairTracker::new().intersects(&body, &solid, &at.swapped()));
        let found = PairTracker::new().closest(&surface, &body, &at);
        assert_eq!(found.state, ContactState::Separated);
    }
}

#[test]
fn a_box_in_a_box_of_the_same_size_overlaps_and_beside_it_touches() {
    let cube = soups::plate(2, [0.5, 0.5, 0.5]);
    let m = mesh(&cube);
    let body = Compound::from(Shape::cuboid(Vector3::repeat(0.5)).unwrap());
    for (t, state) in [
        ([0.0, 0.0, 0.0], ContactState::Overlapping),
        ([0.5, 0.0, 0.0], ContactState::Overlapping),
        ([1.0, 0.0, 0.0], ContactState::Touching),
        ([1.0, 0.5, 0.0], ContactState::Touching),
        ([1.0, 1.0, 1.0], ContactState::Touching),
    ] {
        let found = PairTracker::new().closest(&m, &body, &relative(&Pose::shift(t)));
        assert_eq!((found.state, found.distance), (state, 0.0), "{t:?}");
    }
}

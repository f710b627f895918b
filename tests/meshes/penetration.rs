//! Bounds of the penetration depth: convex meshes against the depth of the bodies, other meshes
//! against shifts by brute force.

use super::{mesh, relative, shapes};
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{
    Compound, ContactState, Mesh, PairTracker, PenetrationBounds, Piece, QueryOptions, RelativePose, Shape, Tracker,
};
use truth::Pose;
use truth::pose::{add, scale, unit_quat};
use truth::rng::Rng;
use truth::soups;
use truth::support::piece_at;

fn shifted(pose: &Pose, by: Vector3<f64>) -> RelativePose {
    relative(&pose.shifted(by.into()))
}

#[test]
fn convex_meshes_have_the_depth_of_their_bodies_between_the_bounds() {
    let bodies = [
        solids::cuboid(Vector3::new(0.5, 0.7, 0.3)).unwrap(),
        solids::geodesic_sphere(2, 0.6).unwrap(),
        solids::random_hull(40, Vector3::new(0.6, 0.5, 0.4), 3).unwrap(),
    ];
    let meshes: Vec<_> = bodies.iter().map(|b| Mesh::from_convex(b).unwrap()).collect();
    let pieces: Vec<_> = bodies.iter().map(|b| Compound::from(Shape::from(b.clone()))).collect();
    let mut rng = Rng::new(2);
    let (mut met, mut close) = (0, 0);
    for _ in 0..40 {
        let (i, j) = (rng.below(3), rng.below(3));
        let pose = Pose::new(rng.quat(), scale(rng.unit(), rng.range(0.2, 1.0)));
        let at = relative(&pose);
        let truth = Tracker::new().closest(&bodies[i], &bodies[j], &at);
        let found = PairTracker::new().penetration(&meshes[i], &meshes[j], &at).unwrap();
        let whole = PairTracker::new().penetration(&pieces[i], &pieces[j], &at).unwrap();
        if truth.state != ContactState::Overlapping {
            assert_eq!((found.lower, found.upper), (0.0, 0.0));
            continue;
        }
        met += 1;
        for o in [found, whole] {
            assert!(o.lower <= -truth.distance + 1e-12, "{o:?} {truth:?}");
            assert!(-truth.distance <= o.upper + 1e-12, "{o:?} {truth:?}");
            assert!(
                o.upper <= -truth.distance * (1.0 + 2e-3) + 1e-9,
                "the hulls are the bodies: {o:?} {truth:?}"
            );
        }
        assert!(
            whole.lower >= -truth.distance - 1e-9,
            "the piece is the body: {whole:?} {truth:?}"
        );
        close += usize::from(found.lower > -0.5 * truth.distance);
    }
    assert!(met > 20 && close > 10, "{met} {close}");
}

/// Asserts that the shift separates the bodies, and that shifts shorter than the lower bound never
/// do.
fn check(found: &PenetrationBounds, pose: &Pose, rng: &mut Rng, mut state: impl FnMut(&RelativePose) -> ContactState) {
    assert!(0.0 <= found.lower && found.lower <= found.upper, "{found:?}");
    let off = (found.shift.norm() - found.upper).abs();
    assert!(off <= 1e-12 * found.upper, "{found:?}");
    assert_eq!(state(&shifted(pose, found.shift)), ContactState::Separated, "{found:?}");
    for _ in 0..20 {
        let by = Vector3::from(rng.unit()) * (found.lower * 0.999);
        assert_eq!(state(&shifted(pose, by)), ContactState::Overlapping, "{found:?} {by}");
    }
}

#[test]
fn bounds_of_meshes_hold_and_meet_for_shallow_overlaps() {
    let shapes = shapes();
    let meshes: Vec<_> = shapes.iter().map(mesh).collect();
    let mut rng = Rng::new(8);
    let (mut met, mut tight) = (0, 0);
    for k in 0..24 {
        let (i, j) = (k % 3, rng.below(3));
        let (m, n) = (&meshes[i], &meshes[j]);
        let at = rng.unit();
        let mut pose = Pose::new(unit_quat(rng.quat()), scale(at, 2.6));
        for _ in 0..20 {
            let d = PairTracker::new().distance(m, n, &relative(&pose)).value;
            pose.t = add(pose.t, scale(at, -d));
        }
        pose.t = add(pose.t, scale(at, -[0.02, 0.1][k % 2]));
        let found = PairTracker::new().penetration(m, n, &relative(&pose)).unwrap();
        if found.upper == 0.0 {
            continue;
        }
        met += 1;
        tight += usize::from(found.lower > 0.5 * found.upper);
        check(&found, &pose, &mut rng, |p| PairTracker::new().closest(m, n, p).state);
        let back = PairTracker::new()
            .penetration(n, m, &relative(&pose).swapped())
            .unwrap();
        assert!(back.lower <= found.upper + 1e-12, "{found:?} {back:?}");
        assert!(found.lower <= back.upper + 1e-12, "{found:?} {back:?}");
    }
    assert!(met > 15 && tight > 5, "{met} {tight}");
}

#[test]
fn bounds_of_pieces_hold_and_surfaces_have_none() {
    let beam = |x: f64, turn: f64| {
        piece_at(
            Isometry3::new(Vector3::new(x, 0.0, 0.0), Vector3::z() * turn),
            Shape::cuboid(Vector3::new(0.8, 0.15, 0.2)).unwrap(),
        )
    };
    let cross = Compound::new(vec![beam(0.0, 0.0), beam(0.1, 1.4), beam(-0.5, 0.7)]).unwrap();
    let round = Compound::new(vec![beam(0.0, 0.3), Piece::new(Shape::cylinder(0.5, 0.3).unwrap())]).unwrap();
    let mut rng = Rng::new(4);
    let mut met = 0;
    for k in 0..20 {
        let body = if k % 2 == 0 { &cross } else { &round };
        let pose = Pose::new(rng.quat(), scale(rng.unit(), rng.range(0.3, 1.0)));
        let found = PairTracker::new().penetration(&cross, body, &relative(&pose)).unwrap();
        if found.upper > 0.0 {
            met += 1;
            check(&found, &pose, &mut rng, |p| {
                PairTracker::new().closest(&cross, body, p).state
            });
        }
    }
    assert!(met > 8, "{met}");
    let mut open = soups::sphere(1);
    open.triangles.pop();
    let (solid, surface) = (mesh(&soups::sphere(1)), mesh(&open));
    let at = relative(&Pose::shift([0.5, 0.0, 0.0]));
    assert_eq!(PairTracker::new().penetration(&solid, &surface, &at), None);
}

/// Half extents and centres of boxes.
type Boxes = Vec<([f64; 3], [f64; 3])>;

/// Returns the exact depth of two bodies of boxes: a corner of the sums of boxes, or a foot on a
/// face or an edge of them, is the shortest translation out of all sums.
fn depth_of_boxes(a: &Boxes, b: &Boxes) -> f64 {
    let sums: Vec<[(f64, f64); 3]> = a
        .iter()
        .flat_map(|(half, at)| {
            b.iter().map(move |(more, to)| {
                std::array::from_fn(|k| {
                    let (reach, middle) = (half[k] + more[k], at[k] - to[k]);
                    (middle - reach, middle + reach)
                })
            })
        })
        .collect();
    let ends = |k: usize| -> Vec<f64> { sums.iter().flat_map(|s| [s[k].0, s[k].1]).chain([0.0]).collect() };
    let mut least = f64::INFINITY;
    for x in ends(0) {
        for y in ends(1) {
            for z in ends(2) {
                let t = [x, y, z];
                let is_in = sums
                    .iter()
                    .any(|s| (0..3).all(|k| s[k].0 + 1e-12 < t[k] && t[k] < s[k].1 - 1e-12));
                if !is_in {
                    least = least.min(t.iter().map(|c| c * c).sum::<f64>().sqrt());
                }
            }
        }
    }
    least
}

/// Returns the body of boxes, rotated about the origin.
fn compound_of_boxes(boxes: &Boxes, turn: &Pose) -> Compound {
    let piece = |(half, at): &([f64; 3], [f64; 3])| {
        piece_at(
            turn.isometry() * Isometry3::translation(at[0], at[1], at[2]),
            Shape::cuboid(Vector3::from(*half)).unwrap(),
        )
    };
    Compound::new(boxes.iter().map(piece).collect()).unwrap()
}

#[test]
fn narrowed_bounds_hold_the_depth_of_boxes_to_the_width() {
    let mut rng = Rng::new(31);
    let mut wide = 0;
    for k in 0..12 {
        let mut boxes = |count: usize| -> Boxes {
            let mut one = || std::array::from_fn(|_| rng.range(0.2, 0.7));
            let halves: Vec<[f64; 3]> = (0..count).map(|_| one()).collect();
            let mut at = || std::array::from_fn(|_| rng.range(-0.8, 0.8));
            halves.into_iter().map(|half| (half, at())).collect()
        };
        let (in_a, in_b) = (boxes(3), boxes(2));
        let truth = depth_of_boxes(&in_a, &in_b);
        // No box is along the axes.
        let turn = Pose::new(unit_quat(rng.quat()), [0.0; 3]);
        let (a, b) = (compound_of_boxes(&in_a, &turn), compound_of_boxes(&in_b, &turn));
        let at = relative(&Pose::shift([0.0; 3]));
        let first = PairTracker::new().penetration(&a, &b, &at).unwrap();
        wide += usize::from(first.upper - first.lower > 0.02 * truth);
        let options = QueryOptions::default().width(0.02 * truth).splits(20_000);
        let found = PairTracker::new().penetration_with(&a, &b, &at, &options).unwrap();
        let holds = |found: &PenetrationBounds| found.lower <= truth + 1e-9 && truth <= found.upper + 1e-9;
        assert!(holds(&found), "{k}: {found:?} {truth}");
        assert!(found.upper - found.lower <= 0.02 * truth, "{k}: {found:?} {truth}");
        assert!(first.lower <= found.lower, "{first:?} {found:?}");
        assert!(found.upper <= first.upper, "{first:?} {found:?}");
        // Faces inside of the union keep the convex regions small: the budget may end first.
        if k < 4 {
            let (a, b) = (a.to_mesh().unwrap(), b.to_mesh().unwrap());
            let first = PairTracker::new().penetration(&a, &b, &at).unwrap();
            let found = PairTracker::new()
                .penetration_with(&a, &b, &at, &options.splits(500))
                .unwrap();
            assert!(holds(&found), "{k}: {found:?} {truth}");
            assert!(first.lower <= found.lower, "{first:?} {found:?}");
            assert!(found.upper <= first.upper, "{first:?} {found:?}");
            // Without a width, nothing is searched.
            let same = PairTracker::new()
                .penetration_with(&a, &b, &at, &QueryOptions::default())
                .unwrap();
            assert_eq!(first, same);
        }
    }
    assert!(wide > 3, "{wide}");
}

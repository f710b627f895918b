//! Promise: a scene of bodies of every kind finds what brute force over all pairs finds, on every
//! frame; queries that a pair of kinds does not support are rejected with a named error.

use crate::{ALL, NONE, Replay, read_back};
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, BodyId, Group, PairQueries, Scene, SceneError};
use lin_canny::{
    Compound, ContactState, ConvexPolyhedron, Geometry, GeometryKind, Manifold, ManifoldOptions, Mesh, PairTracker,
    Piece, RelativePose, Shape, Tracker, Velocity,
};
use std::sync::Arc;
use truth::forms::shapes;
use truth::rng::Rng;
use truth::support::piece_at;

const D: f64 = 0.2;

/// The convex pieces of a body, posed in the frame of the body.
type Pieces = Vec<(Shape, Isometry3<f64>)>;

/// A body as a list of posed convex shapes, for brute force.
struct Known {
    id: BodyId,
    pieces: Pieces,
}

fn pose(rng: &mut Rng, reach: f64) -> Isometry3<f64> {
    Isometry3::new(
        Vector3::from(rng.in_ball()) * reach,
        Vector3::from(rng.unit()) * rng.range(0.0, 3.0),
    )
}

/// Returns a shape of every convex kind.
fn convex(rng: &mut Rng) -> Vec<(Geometry, Pieces)> {
    shapes([(); 3].map(|()| rng.range(0.3, 0.6)))
        .into_iter()
        .map(|shape| (shape.clone().into(), vec![(shape, Isometry3::identity())]))
        .collect()
}

fn bracket() -> Compound {
    let beam = solids::cuboid(Vector3::new(0.6, 0.12, 0.12)).unwrap();
    let mut upright = Piece::new(beam.clone());
    upright.pose = Isometry3::new(Vector3::new(0.6, 0.5, 0.0), Vector3::z() * std::f64::consts::FRAC_PI_2);
    Compound::new(vec![Piece::new(beam), upright]).unwrap()
}

/// Returns a polyhedron, compound or mesh, with its convex pieces.
fn solid(k: usize, rng: &mut Rng) -> (Geometry, Pieces) {
    let hull = solids::random_hull(12, Vector3::new(0.5, 0.4, rng.range(0.3, 0.6)), k as u64 + 5).unwrap();
    let whole = |hull: &ConvexPolyhedron| vec![(Shape::from(hull.clone()), Isometry3::identity())];
    let parts = |c: &Compound| c.pieces().iter().map(|p| (p.shape.clone(), p.pose)).collect();
    match k % 4 {
        0 => (hull.clone().into(), whole(&hull)),
        1 => (Mesh::from_convex(&hull).unwrap().into(), whole(&hull)),
        2 => (bracket().into(), parts(&bracket())),
        _ => (bracket().to_mesh().unwrap().into(), parts(&bracket())),
    }
}

/// Returns the least bounds of the signed distance over all pairs of pieces, and whether two share
/// a point or are within `D`.
fn brute(scene: &Scene, a: &Known, b: &Known) -> (f64, f64, bool, bool) {
    let (at_a, at_b) = (scene.pose(a.id).unwrap(), scene.pose(b.id).unwrap());
    let (mut lower, mut upper, mut overlaps, mut within) = (f64::INFINITY, f64::INFINITY, false, false);
    for (x, on_a) in &a.pieces {
        for (y, on_b) in &b.pieces {
            let pose = RelativePose::new(&(at_a * on_a), &(at_b * on_b)).unwrap();
            let found = PairTracker::new().distance(x, y, &pose);
            (lower, upper) = (lower.min(found.lower), upper.min(found.upper));
            overlaps |= PairTracker::new().intersects(x, y, &pose);
            within |= PairTracker::new().within(x, y, &pose, D);
        }
    }
    (lower, upper, overlaps, within)
}

/// Counts: pairs separated, overlapping, within, depths, skipped.
#[derive(Debug, Default)]
struct Mix {
    apart: usize,
    overlapping: usize,
    within: usize,
    depths: usize,
    skipped: u64,
}

impl Mix {
    /// Checks that enough pairs of each kind were judged.
    #[track_caller]
    fn is_enough(&self, queries: &PairQueries, skipped: u64) {
        println!("{self:?}");
        assert!(self.overlapping > 300, "{self:?}");
        assert!(self.within > self.overlapping + 100, "{self:?}");
        assert!(!queries.features || self.apart > 100, "{self:?}");
        assert!(queries.features || self.skipped > skipped, "{self:?}");
    }
}

/// Bounds agree up to the poses of pieces, which brute force composes in `f64`.
const AGREE: f64 = 1e-12;

fn check_frame(scene: &Scene, known: &[Known], replay: &Replay, queries: &PairQueries, mix: &mut Mix) {
    for (k, x) in known.iter().enumerate() {
        for y in &known[k + 1..] {
            let (a, b) = if x.id < y.id { (x, y) } else { (y, x) };
            let (lower, upper, overlaps, within) = brute(scene, a, b);
            let key = (a.id, b.id);
            // A tie within rounding may be decided either way if pieces have poses.
            if lower.abs() > AGREE {
                assert_eq!(replay.overlapping.contains(&key), overlaps, "{key:?}");
            }
            if (lower - D).abs() > AGREE {
                assert_eq!(replay.within.contains(&key), within, "{key:?}");
            }
            mix.overlapping += usize::from(overlaps);
            mix.within += usize::from(within);
            let answer = scene.pair(a.id, b.id).and_then(|p| p.outcome);
            if !queries.features || lower > 0.3 - AGREE {
                assert!(answer.is_none() || upper <= 0.3 + AGREE, "{key:?}");
                continue;
            }
            let found = answer.expect("a pair within the range is measured");
            if overlaps && !queries.depth {
                assert_eq!(found.state, ContactState::Overlapping);
                assert_eq!(found.distance, 0.0);
                assert_eq!(found.lower, f64::NEG_INFINITY);
                continue;
            }
            assert!(found.lower <= upper + AGREE, "{found:?} {lower} {upper}");
            assert!(lower <= found.upper + AGREE, "{found:?} {lower} {upper}");
            let on_a = scene.pose(a.id).unwrap() * found.point_on_a;
            let on_b = scene.pose(b.id).unwrap() * found.point_on_b;
            let off = ((on_b - on_a).norm() - found.distance.abs()).abs();
            assert!(off < 1e-9, "{off} {found:?}");
            mix.apart += usize::from(!overlaps);
            mix.depths += usize::from(overlaps);
        }
    }
}

/// Moves bodies about their home and compares every frame.
fn play(queries: PairQueries, bodies: Vec<(Geometry, Pieces)>, seed: u64) -> Mix {
    let mut rng = Rng::new(seed);
    let mut scene = Scene::new();
    scene.set_queries(ALL, ALL, queries).unwrap();
    let reach = 1.6;
    let known: Vec<Known> = bodies
        .into_iter()
        .map(|(shape, pieces)| {
            let id = scene.insert(Body::moving(shape), pose(&mut rng, reach)).unwrap();
            Known { id, pieces }
        })
        .collect();
    let (mut replay, mut mix) = (Replay::default(), Mix::default());
    for frame in 0..40 {
        if frame == 20 {
            scene = read_back(&scene);
        }
        scene.step();
        mix.skipped += scene.report().counts.skipped;
        replay.apply(scene.events());
        check_frame(&scene, &known, &replay, &queries, &mut mix);
        for body in &known {
            let at = *scene.pose(body.id).unwrap();
            let home = -at.translation.vector * 0.01;
            let drift = Velocity::new(
                home + Vector3::from(rng.unit()) * 0.03,
                Vector3::from(rng.unit()) * 0.05,
            );
            let at = if rng.chance(0.02) {
                pose(&mut rng, reach)
            } else {
                drift.applied(&at, 1.0)
            };
            scene.set_pose(body.id, at).unwrap();
        }
    }
    mix
}

fn predicates() -> PairQueries {
    NONE.overlap(true).within(D)
}

fn measured() -> PairQueries {
    predicates().distance(0.3).features(true)
}

#[test]
fn convex_shapes_of_every_kind_equal_brute_force() {
    for (seed, queries) in [(1, predicates()), (2, measured()), (3, measured().depth(true))] {
        let mut rng = Rng::new(100 + seed);
        let bodies = [convex(&mut rng), convex(&mut rng)].concat();
        let mix = play(queries, bodies, seed);
        mix.is_enough(&queries, 100);
        assert!(!queries.depth || mix.depths > 300, "{mix:?}");
    }
}

#[test]
fn composites_and_meshes_equal_brute_force() {
    for (seed, queries) in [(4, predicates()), (5, measured())] {
        let mut rng = Rng::new(200 + seed);
        let mix = play(queries, (0..12).map(|k| solid(k, &mut rng)).collect(), seed);
        mix.is_enough(&queries, 50);
    }
}

#[test]
fn a_pair_of_polyhedra_is_as_the_tracker_has_it_whatever_else_is_there() {
    let mut scene = Scene::new();
    scene.set_queries(ALL, ALL, measured()).unwrap();
    let (x, y) = (solids::dodecahedron(0.5).unwrap(), solids::octahedron(0.5).unwrap());
    let at = |k: u32| {
        Isometry3::new(
            Vector3::new(1.1, 0.001 * f64::from(k), 0.0),
            Vector3::z() * (0.01 * f64::from(k)),
        )
    };
    let a = scene.insert(Body::moving(x.clone()), Isometry3::identity()).unwrap();
    let b = scene.insert(Body::moving(y.clone()), at(0)).unwrap();
    scene
        .insert(
            Body::moving(Shape::ball(0.5).unwrap()),
            Isometry3::translation(0.0, 1.0, 0.0),
        )
        .unwrap();
    let mut tracker = Tracker::new();
    for k in 0..50 {
        scene.set_pose(b, at(k)).unwrap();
        scene.step();
        let mine = tracker.closest(&x, &y, &RelativePose::from_isometry(&at(k)).unwrap());
        let found = scene.pair(a, b).unwrap();
        assert_eq!(found.outcome, Some(&mine));
        assert_eq!(found.subshapes, Some([0; 2]));
    }
}

/// A cylinder, a ball and a rounded box tremble on a plate.
#[test]
fn manifolds_of_convex_shapes_are_those_of_their_tracker() {
    let options = ManifoldOptions::default().prediction(0.01);
    let queries = NONE.manifold(options);
    let mut scene = Scene::new();
    scene.set_queries(ALL, ALL, queries).unwrap();
    let plate = Shape::cuboid(Vector3::new(9.0, 9.0, 0.5)).unwrap();
    let tops = [
        Shape::cylinder(0.5, 0.4),
        Shape::ball(0.5),
        Shape::cuboid(Vector3::repeat(0.4)).and_then(|s| s.rounded(0.1)),
    ];
    let tops = tops.map(Result::unwrap);
    let below = scene
        .insert(Body::fixed(plate.clone()), Isometry3::translation(0.0, 0.0, -0.5))
        .unwrap();
    let ids: Vec<BodyId> = (0..3)
        .map(|k| {
            let at = Isometry3::translation(3.0 * k as f64, 0.0, 0.5);
            scene.insert(Body::moving(tops[k].clone()), at).unwrap()
        })
        .collect();
    let mut own: Vec<_> = tops.iter().map(|_| (PairTracker::new(), Manifold::new())).collect();
    let (mut rng, mut points) = (Rng::new(3), [0; 3]);
    for _ in 0..100 {
        for &id in &ids {
            let at = *scene.pose(id).unwrap();
            let shake = Vector3::new(rng.range(-1e-3, 1e-3), rng.range(-1e-3, 1e-3), 0.0);
            let lift = 0.5 + rng.range(-1e-3, 1e-3) - at.translation.vector.z;
            let tremble = Isometry3::translation(shake.x, shake.y, lift);
            scene.set_pose(id, tremble * at).unwrap();
        }
        scene.step();
        for (k, (tracker, manifold)) in own.iter_mut().enumerate() {
            let pair = scene.pair(below, ids[k]).unwrap();
            let pose = RelativePose::new(scene.pose(below).unwrap(), scene.pose(ids[k]).unwrap()).unwrap();
            let mine = tracker.closest(&plate, &tops[k], &pose);
            tracker.manifold(&plate, &tops[k], &pose, &options, manifold).unwrap();
            assert_eq!(pair.outcome, Some(&*mine));
            assert_eq!(pair.manifold, Some(&*manifold));
            points[k] += manifold.points().len();
        }
    }
    let counts = scene.report().counts;
    assert_eq!((counts.manifolds, counts.pairs), (3, 3));
    assert!(points[0] >= 300 && points[1] == 100 && points[2] == 400, "{points:?}");
}

#[test]
fn pieces_and_features_are_named() {
    let mut scene = Scene::new();
    scene.set_queries(ALL, ALL, NONE.distance(5.0).features(true)).unwrap();
    let a = scene.insert(Body::fixed(bracket()), Isometry3::identity()).unwrap();
    let ball = solids::octahedron(0.1).unwrap();
    let b = scene
        .insert(Body::moving(ball), Isometry3::translation(0.6, 1.5, 0.0))
        .unwrap();
    scene.step();
    let found = scene.pair(a, b).unwrap();
    assert_eq!(found.subshapes, Some([1, 0]), "the upright is nearest");
    let near = scene.nearest(b, 1, 10.0).unwrap();
    assert_eq!((near[0].b, near[0].subshapes), (a, [0, 1]));
    assert!((near[0].outcome.distance - found.distance.unwrap().value).abs() < 1e-14);
}

/// Rounded and curved shapes, wires and bodies with curved pieces, against meshes and compounds.
#[test]
fn shapes_of_every_kind_against_composites_and_meshes_equal_brute_force() {
    for (seed, queries) in [(6, predicates()), (7, measured())] {
        let mut rng = Rng::new(300 + seed);
        let mut bodies: Vec<(Geometry, Pieces)> = (0..6).map(|k| solid(1 + k % 3, &mut rng)).collect();
        bodies.extend(convex(&mut rng));
        let wire = Shape::from(ConvexPolyhedron::segment([0.0; 3].into(), [0.5, 0.3, 0.0].into()).unwrap());
        bodies.push((wire.clone().into(), vec![(wire, Isometry3::identity())]));
        let curved = [Shape::cylinder(0.4, 0.3), Shape::cone(0.4, 0.4)];
        let pieces: Pieces = curved.map(|shape| (shape.unwrap(), pose(&mut rng, 0.3))).to_vec();
        let placed = |(shape, pose): &(Shape, Isometry3<f64>)| {
            let mut piece = Piece::new(shape.clone());
            piece.pose = *pose;
            piece
        };
        let curved = Compound::new(pieces.iter().map(placed).collect()).unwrap();
        bodies.push((curved.into(), pieces));
        let mix = play(queries, bodies, seed);
        mix.is_enough(&queries, 50);
    }
}

/// Bodies of every kind rest on a plate of many triangles, on a plate of two pieces and on a box.
#[test]
fn contacts_of_meshes_and_composites_are_those_of_their_patches() {
    let options = ManifoldOptions::default().prediction(0.01);
    let mut scene = Scene::new();
    scene.set_queries(ALL, ALL, NONE.manifold(options)).unwrap();
    let half = Vector3::new(4.0, 4.0, 0.5);
    let tile = |x: f64| {
        piece_at(
            Isometry3::translation(x, 0.0, 0.0),
            Shape::cuboid(Vector3::new(2.0, 4.0, 0.5)).unwrap(),
        )
    };
    let mesh = Arc::new(Mesh::from_convex(&solids::cuboid(half).unwrap()).unwrap());
    let tiles = Arc::new(Compound::new(vec![tile(-2.0), tile(2.0)]).unwrap());
    let die = || solids::cuboid(Vector3::repeat(0.5)).unwrap();
    let floors: [Geometry; 3] = [
        mesh.clone().into(),
        tiles.clone().into(),
        Shape::cuboid(half).unwrap().into(),
    ];
    let tops: [(Geometry, usize); 5] = [
        (die().into(), 4),
        (Shape::ball(0.5).unwrap().into(), 1),
        (Shape::cylinder(0.5, 0.4).unwrap().into(), 4),
        (Mesh::from_convex(&die()).unwrap().into(), 4),
        (Compound::new(vec![Piece::new(die())]).unwrap().into(), 4),
    ];
    let mut pairs = Vec::new();
    for (f, floor) in floors.iter().enumerate() {
        let home = Vector3::new(0.0, 20.0 * f as f64, 0.0);
        let below = scene.insert(Body::fixed(floor.clone()), Isometry3::from(home)).unwrap();
        for (k, (top, count)) in tops.iter().enumerate() {
            let at = home + Vector3::new(1.5 * k as f64 - 3.0, 0.2, 1.0);
            let id = scene.insert(Body::moving(top.clone()), Isometry3::from(at)).unwrap();
            pairs.push((below, id, *count));
        }
    }
    for frame in 0..40 {
        let lift = [3e-3, -2e-3, 1e-9, 0.02][frame % 4];
        for &(_, id, _) in &pairs {
            let mut at = *scene.pose(id).unwrap();
            at.translation.vector.z = 1.0 + lift;
            at.translation.vector.x += 0.01;
            scene.set_pose(id, at).unwrap();
        }
        if frame == 20 {
            scene = read_back(&scene);
        }
        scene.step();
        for &(below, id, count) in &pairs {
            let Some(pair) = scene.pair(below, id) else {
                assert!(lift > 0.01);
                continue;
            };
            let points: Vec<(f64, Vector3<f64>)> = match (pair.manifold, pair.contacts) {
                (Some(m), None) => m.points().iter().map(|p| (p.separation, *m.normal())).collect(),
                (None, Some(groups)) => {
                    let all = groups.iter().flat_map(|g| &g.contacts);
                    all.map(|c| (c.point.separation, *c.normal)).collect()
                }
                (None, None) => Vec::new(),
                both => panic!("{both:?}"),
            };
            assert_eq!(
                points.len(),
                if lift > 0.01 { 0 } else { count },
                "{frame} {id:?} {pair:?}"
            );
            assert!(
                points.iter().all(|(s, n)| (s - lift).abs() < 1e-9 && n.z > 1.0 - 1e-9),
                "{points:?}"
            );
        }
    }
    assert_eq!(scene.report().counts.manifolds, 0, "out of reach in the last frame");
}

#[test]
fn queries_that_kinds_cannot_answer_are_refused_by_name() {
    let other = Group::new(1).unwrap();
    let near = NONE.within(0.1);
    let mesh = || Mesh::from_convex(&solids::octahedron(1.0).unwrap()).unwrap();
    let refusal = |query: &'static str, these, those| SceneError::Unanswered { query, these, those };
    let at = Isometry3::identity();

    // If the body is inserted.
    let mut scene = Scene::new();
    scene.set_queries(ALL, other, near.depth(true)).unwrap();
    scene.insert(Body::moving(mesh()).group(other), at).unwrap();
    let refused = scene.insert(Body::moving(bracket()), at).unwrap_err();
    assert_eq!(refused, refusal("depth", GeometryKind::Compound, GeometryKind::Mesh));
    assert_eq!(
        refused.to_string(),
        "the query depth does not exist between a compound and a mesh"
    );
    assert_eq!(scene.body_count(), 1);

    // If the query is enabled; pairs within a group need two bodies that are not fixed.
    let cylinder = || Shape::cylinder(1.0, 1.0).unwrap();
    let mut scene = Scene::new();
    let deep = near.depth(true);
    let id = scene.insert(Body::moving(mesh()), at).unwrap();
    scene.set_queries(ALL, ALL, deep).unwrap();
    let refused = scene.insert(Body::moving(mesh()), at).unwrap_err();
    assert_eq!(refused, refusal("depth", GeometryKind::Mesh, GeometryKind::Mesh));
    scene.insert(Body::moving(cylinder()).group(other), at).unwrap();
    let refused = scene.set_queries(ALL, other, deep).unwrap_err();
    assert_eq!(refused, refusal("depth", GeometryKind::Mesh, GeometryKind::Curved));
    let local = near.local_depth(true);
    let refused = scene.set_queries(ALL, other, local).unwrap_err();
    let expected = refusal("local_depth", GeometryKind::Mesh, GeometryKind::Curved);
    assert_eq!(refused, expected);
    assert_eq!(scene.queries(ALL, other), NONE, "a refused call changes nothing");
    scene.set_queries(ALL, other, near).unwrap();

    // If the group changes; the body keeps its group.
    let third = Group::new(2).unwrap();
    scene.set_queries(other, third, deep).unwrap();
    let refused = scene.set_group(id, third).unwrap_err();
    assert_eq!(refused, refusal("depth", GeometryKind::Mesh, GeometryKind::Curved));
    assert_eq!(scene.group(id), Some(ALL));
    scene.set_group(id, ALL).unwrap();

    // A removed body is no reason.
    scene.remove(id).unwrap();
    scene.set_queries(ALL, other, deep).unwrap();

    // Fixed bodies make no pair.
    let mut scene = Scene::new();
    scene.set_queries(ALL, ALL, deep).unwrap();
    scene.insert(Body::fixed(mesh()), at).unwrap();
    scene.insert(Body::fixed(mesh()), at).unwrap();
    assert!(scene.insert(Body::moving(cylinder()), at).is_err());
    let wire = ConvexPolyhedron::point([0.0; 3].into()).unwrap();
    let refused = scene.insert(Body::moving(wire), at).unwrap_err();
    assert_eq!(refused, refusal("depth", GeometryKind::Wire, GeometryKind::Mesh));
}

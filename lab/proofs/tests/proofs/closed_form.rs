//! Distances of features in closed form: bit for bit those of the transcription, and of no pair of features but the
//! closest.

use lin_canny::__proofs::{self as library, FeatureDistance};
use lin_canny::{ConvexPolyhedron, Feature, FeaturePair, RelativePose, Tracker, VertexId};
use proofs::kernels::double::Twice;
use proofs::kernels::{certificate, closed_form};
use proofs::number::{Number, Vector, cross, dot, sub};
use proofs::vectors::Coordinates;
use truth::motion::{self, Frame};
use truth::pose::radius;
use truth::rng::Rng;
use truth::shapes::{self, Shape};
use truth::{Body, ContactState, Pose, support};
use truth::{bound, exact};

type Double = Coordinates<Twice>;

fn features(body: &ConvexPolyhedron) -> Vec<Feature> {
    let vertices = body.vertices().map(Feature::Vertex);
    vertices
        .chain(body.edges().map(Feature::Edge))
        .chain(body.faces().map(Feature::Face))
        .collect()
}

fn asked(
    bodies: (&ConvexPolyhedron, &ConvexPolyhedron),
    pose: &RelativePose,
    [a, b]: [Feature; 2],
) -> Option<FeatureDistance> {
    let at = Tracker::new().closest(bodies.0, bodies.1, pose);
    let points = [at.point_on_a, at.point_on_b].map(|p| p.coords.into());
    library::closed_form(bodies.0, bodies.1, pose, FeaturePair { a, b }, points)
}

/// The vertices of a feature, of a face the first three.
fn corners(body: &ConvexPolyhedron, feature: Feature) -> Vec<Vector<Twice>> {
    let ids: Vec<VertexId> = match feature {
        Feature::Vertex(v) => vec![v],
        Feature::Edge(e) => body.edge_vertices(e).expect("an edge").to_vec(),
        Feature::Face(f) => body.face_vertices(f).take(3).collect(),
    };
    let at = |v: VertexId| <[f64; 3]>::from(body.vertex(v).expect("a vertex").coords).map(Twice::exact);
    ids.into_iter().map(at).collect()
}

/// The distance of two features, the one on the second body the greater: a face before an edge before a vertex.
fn transcribed(pose: &RelativePose, [low, high]: [&[Vector<Twice>]; 2]) -> Twice {
    let (p, q) = pose.poses();
    // The frame is that of the greater feature.
    let rotations = [&p, &q].map(|pose| {
        let c = pose.rotation.coords;
        let [x, y, z, w] = [c.x, c.y, c.z, c.w].map(Twice::exact);
        let s = Twice::exact(2.0).over(x * x + y * y + z * z + w * w);
        certificate::rotation([x, y, z, w], s)
    });
    let apart = [0, 1, 2].map(|k| {
        let (high, low) = proofs::traced::two_sum(q.translation.vector[k], -p.translation.vector[k]);
        Twice([high, low])
    });
    let w = certificate::shift::<Double>(rotations, [high[0], low[0]], apart);
    let sides = |at: &[Vector<Twice>]| [sub(at[1], at[0]), sub(at[at.len() - 1], at[0])];
    let over = |edges: [Vector<Twice>; 2]| {
        let (n, height) = closed_form::height::<Double>(w, edges);
        let height = if height.0[0] < 0.0 { -height } else { height };
        height.over(dot(n, n).root())
    };
    match (low.len(), high.len()) {
        (1, 1) => dot(w, w).root(),
        (1, 2) => {
            let [u, _] = sides(high);
            let area = cross(w, u);
            dot(area, area).over(dot(u, u)).root()
        }
        (1, _) => over(sides(high)),
        _ => over([sides(high)[0], closed_form::turned::<Double>(rotations, sides(low)[0])]),
    }
}

fn kind(feature: Feature) -> usize {
    match feature {
        Feature::Vertex(_) => 0,
        Feature::Edge(_) => 1,
        Feature::Face(_) => 2,
    }
}

/// Asks of all pairs of features, and returns of which kinds a pair was proven.
fn judge(shapes: [&Shape; 2], frame: &Frame) -> Option<[usize; 2]> {
    let bodies = shapes.map(support::body);
    let pose = support::relative(frame);
    let truth = exact::solve(Body::from(shapes[0]), &frame.a, Body::from(shapes[1]), &frame.b);
    if truth.state != ContactState::Separated {
        return None;
    }
    let mut proven = None;
    for a in features(&bodies[0]) {
        for b in features(&bodies[1]) {
            let Some(told) = asked((&bodies[0], &bodies[1]), &pose, [a, b]) else {
                continue;
            };
            let (d, s) = (told.distance[0], truth.distance);
            let what = format!("{a:?} {b:?}: {d:e} is not {s:e}, {shapes:?} {frame:?}");
            assert!((d - s).abs() <= told.error + (s.next_up() - s), "{what}");
            let normal = frame.a.rotate(told.normal);
            let gap = bound::support_gap(shapes[0].into(), &frame.a, shapes[1].into(), &frame.b, normal);
            let size = support::size(&bodies[0], &bodies[1], frame);
            assert!(gap >= s - 1e-14 * size, "gap along the normal {gap:e}, {what}");
            assert!(proven.is_none(), "two pairs of features are the closest: {what}");
            proven = Some([kind(a), kind(b)]);
            if shapes.iter().all(|s| s.faces.iter().all(|f| f.len() == 3)) {
                let at = [corners(&bodies[0], a), corners(&bodies[1], b)];
                let ours = if kind(a) < kind(b) {
                    transcribed(&pose.swapped(), [&at[0], &at[1]])
                } else {
                    transcribed(&pose, [&at[1], &at[0]])
                };
                assert_eq!(ours, Twice(told.distance), "{what}");
            }
        }
    }
    proven
}

/// Half turns and whole translations: many pairs of features are equally near.
fn lattice_frame(rng: &mut Rng) -> Frame {
    let mut pose = |apart: f64| {
        let axis = rng.below(4);
        Pose::new(
            std::array::from_fn(|k| f64::from(u8::from(k == axis))),
            [0, 1, 2].map(|_| (apart * rng.range(-1.0, 1.0)).round()),
        )
    };
    Frame::new(pose(2.0), pose(9.0))
}

/// The frame with B moved towards A, until a part of the distance is left.
fn brought_near([a, b]: [&Shape; 2], frame: &Frame, part: f64) -> Frame {
    let (a, b) = (support::body(a), support::body(b));
    let seen = Tracker::new().closest(&a, &b, &support::relative(frame));
    let normal = frame.a.rotate(seen.normal.into_inner().into());
    let way = seen.distance * (1.0 - part);
    let mut near = *frame;
    near.b.t = [0, 1, 2].map(|k| frame.b.t[k] - way * normal[k]);
    near
}

#[test]
fn what_is_proven_is_the_closest() {
    let mut rng = Rng::new(61);
    let mut found = [[0; 3]; 3];
    for k in 0..400 {
        let mut make = || match k % 3 {
            0 => shapes::sphere(&mut rng, 4).solved(),
            1 => shapes::sphere(&mut rng, 7).solved(),
            _ => shapes::lattice(&mut rng, 8, 3).solved(),
        };
        let (a, b) = (make(), make());
        let radii = (radius(&a.points), radius(&b.points));
        for mut frame in motion::random_poses(&mut rng, 4, radii, (0.7, 1.6), 1.0) {
            if k % 6 == 5 {
                frame = lattice_frame(&mut rng);
            }
            if let Some([i, j]) = judge([&a, &b], &frame) {
                found[i][j] += 1;
                judge(
                    [&a, &b],
                    &brought_near([&a, &b], &frame, *rng.pick(&[1e-3, 1e-7, 1e-11])),
                );
            }
        }
    }
    let kinds = [(0, 0), (0, 1), (1, 0), (0, 2), (2, 0), (1, 1)];
    assert!(kinds.iter().all(|(i, j)| found[*i][*j] > 20), "{found:?}");
}

/// Edges far shorter than their body, down to where squares of directions underflow.
#[test]
fn short_edges_are_proven_as_they_are_or_not_at_all() {
    let mut rng = Rng::new(62);
    let mut proven = 0;
    for bits in [1, 20, 60, 150, 250, 300, 340] {
        let t = 2f64.powi(-bits);
        let base = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| [x, y, -1.0]);
        let points = [[0.0; 3], [t, 0.0, 0.0]].into_iter().chain(base).collect();
        let roof = Shape::hull("short", points).solved();
        let tip = shapes::octahedron();
        for _ in 0..8 {
            let part = rng.range(-0.5, 1.5);
            let here = Pose::new([0.0, 0.0, 0.0, 1.0], [0.0; 3]);
            let above = Pose::new(rng.quat(), [part * t, rng.range(-1.0, 1.0) * t, rng.range(1.0, 1.5)]);
            for frame in [Frame::new(here, above), Frame::new(here, Pose { q: here.q, ..above })] {
                proven += usize::from(judge([&roof, &tip], &frame).is_some());
                proven += usize::from(judge([&tip, &roof], &frame.swapped()).is_some());
            }
        }
    }
    assert!(proven > 40, "{proven}");
}

//! The certificate's transcription against the walk and the solver of least distances, bit for bit, on bodies of a few
//! vertices.

use lin_canny::__proofs::{self as library, WalkEnd};
use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, UnitQuaternion, Vector3};
use lin_canny::{ConvexPolyhedron, EdgeId, FaceId, Feature, RelativePose, VertexId};
use proofs::kernels::certificate::{self, Placing};
use proofs::kernels::double::Twice;
use proofs::kernels::signs;
use proofs::number::{Number, Vector, cross, dot, one_norm, scaled};
use proofs::vectors::Coordinates;
use truth::rng::Rng;

pub(crate) type Single = Coordinates<f64>;

/// Walks and solves.
pub(crate) const TRIES: u64 = 100_000;

/// Bodies at random, on a lattice, and flat ones.
pub(crate) fn bodies(rng: &mut Rng) -> Vec<ConvexPolyhedron> {
    let body = |k: usize| {
        let cloud: Vec<Point3<f64>> = (0..4 + k % 9)
            .map(|_| match k % 3 {
                0 => Point3::from([0; 3].map(|_| rng.range(-1.0, 1.0))),
                1 => Point3::from([0; 3].map(|_| rng.int(-2, 2) as f64 / 2.0)),
                _ => Point3::new(rng.range(-1.0, 1.0), rng.range(-1.0, 1.0), rng.range(-1e-3, 1e-3)),
            })
            .collect();
        ConvexPolyhedron::from_points(&cloud).ok()
    };
    (0..300).filter_map(body).filter(|b| b.face_count() > 3).collect()
}

pub(crate) fn pose(rng: &mut Rng) -> Option<RelativePose> {
    let mut one = |reach: f64| {
        let [x, y, z, w] = match rng.below(3) {
            0 => [0.0, 0.0, 0.0, 1.0],
            1 => [0.5, 0.5, -0.5, 0.5],
            _ => rng.quat(),
        };
        let q = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
        let t = [0; 3].map(|_| rng.range(-reach, reach));
        Isometry3::from_parts(Vector3::from(t).into(), q)
    };
    RelativePose::new(&one(0.1), &one(2.5)).ok()
}

fn point(body: &ConvexPolyhedron, v: VertexId) -> Vector<f64> {
    body.vertex(v).expect("a vertex of the body").coords.into()
}

fn ends(body: &ConvexPolyhedron, e: EdgeId) -> [Vector<f64>; 2] {
    body.edge_vertices(e)
        .expect("an edge of the body")
        .map(|v| point(body, v))
}

/// Normal and offset of a face.
fn plane(body: &ConvexPolyhedron, f: FaceId) -> (Vector<f64>, f64) {
    let (normal, offset) = body.face_plane(f).expect("a face of the body");
    (normal.into_inner().into(), offset)
}

/// The faces left and right of an edge.
fn planes(body: &ConvexPolyhedron, e: EdgeId) -> [(Vector<f64>, f64); 2] {
    body.edge_faces(e).expect("a body with faces").map(|f| plane(body, f))
}

fn radius(body: &ConvexPolyhedron) -> f64 {
    library::stored_radius(body)
}

fn constant(name: &str) -> f64 {
    let all = library::constants();
    all.iter().find(|(n, _)| *n == name).expect("a constant").1 * (f64::EPSILON / 2.0)
}

pub(crate) fn length(v: Vector<f64>) -> f64 {
    dot(v, v).sqrt()
}

/// The bound of a support by the planes at an edge.
fn edge_bound(body: &ConvexPolyhedron, n: Vector<f64>, e: EdgeId, weights: [f64; 2], squared: f64) -> f64 {
    let (sides, weights) = (planes(body, e), weights.map(|x| x.max(0.0)));
    let combined = signs::two_planes(n, sides, weights, 0.0).combined;
    let scale = squared / dot(combined, n);
    let parts = signs::two_planes(n, sides, weights, scale);
    signs::two_planes_bound(&parts, constant("EDGE_BOUND"), radius(body))
}

/// Distances and lower bounds that the test of a feature pair may yield.
type Bounds = (Vec<f64>, Vec<f64>);

fn over_face(x: Vector<f64>, body: &ConvexPolyhedron, f: FaceId) -> Bounds {
    let (normal, offset) = plane(body, f);
    let corner = point(body, body.face_vertices(f).next().expect("a corner"));
    let mut distances = vec![certificate::over_corner::<Single>(normal, x, corner)];
    // On an edge of the face, whichever the point grazes.
    for e in body.face_edges(f) {
        let [p, q] = ends(body, e);
        for [p, q] in [[p, q], [q, p]] {
            let [u, r] = certificate::along_edge::<Single>(x, [p, q]);
            let s = (dot(r, u) / dot(u, u)).clamp(0.0, 1.0);
            distances.push(length(certificate::from_edge::<Single>(x, [p, q], s)));
        }
    }
    (distances, vec![certificate::over_plane::<Single>(normal, x, offset)])
}

fn beside_edge(x: Vector<f64>, body: &ConvexPolyhedron, e: EdgeId, size: f64) -> Bounds {
    let [p, q] = ends(body, e);
    let [u, r] = certificate::along_edge::<Single>(x, [p, q]);
    let inverse = 1.0 / dot(u, u);
    let s = dot(r, u) * inverse;
    let d = certificate::less::<Single>(r, u, s);
    let correction = dot(d, u) * inverse;
    let (s, d) = (s + correction, certificate::less::<Single>(d, u, correction));
    let w = cross(u, d);
    let [left, right] = planes(body, e);
    let weights = [dot(right.0, w), -dot(left.0, w)];
    let slack = constant("DIFFERENCE") * size * one_norm(u);
    let lower = if weights.iter().all(|x| *x > slack) {
        length(d)
    } else {
        let support = edge_bound(body, d, e, weights, dot(d, d));
        certificate::over_plane::<Single>(d, x, support) * (1.0 / length(d))
    };
    let distance = if (0.0..=1.0).contains(&s) {
        length(d)
    } else {
        length(certificate::along_edge::<Single>(x, [if s < 0.5 { p } else { q }; 2])[1])
    };
    (vec![distance], vec![lower])
}

fn between_edges(
    placing: &Placing<Single>,
    [a, b]: [&ConvexPolyhedron; 2],
    [e, g]: [EdgeId; 2],
    normal: Vector<f64>,
) -> Bounds {
    let (on_a, on_b) = (ends(a, e), ends(b, g));
    let edges = placing.edges(on_a, on_b);
    let (u, w, r) = (edges.u, edges.w, edges.between);
    let (uu, ww) = (dot(u, u), dot(w, w));
    let mut n = cross(u, w);
    if dot(n, n) < uu * ww / 16.0 {
        n = certificate::less::<Single>(n, u, dot(n, u) / uu);
    }
    let per_square = 1.0 / dot(n, n);
    let [s, t] = [w, u].map(|e| (dot(cross(r, e), n) * per_square).clamp(0.0, 1.0));
    let along = dot(r, n);
    let sign = if along < 0.0 { -1.0 } else { 1.0 };
    let weights = |body, edge, other: Vector<f64>| {
        let [left, right] = planes(body, edge).map(|(normal, _)| dot(other, normal));
        [-sign * right, sign * left]
    };
    let (of_a, of_b) = (weights(a, e, w), weights(b, g, placing.turned_to_b(u)));
    let least = constant("FLANK") * constant("FLANK");
    let falls = |weights: [f64; 2], squared: f64| weights.iter().all(|x| x * x.abs() > least * squared);
    let per_length = dot(n, n).sqrt() * per_square;
    let lower = if falls(of_a, ww) && falls(of_b, uu) {
        along.abs() * per_length
    } else {
        assert_eq!(normal, scaled(n, sign * per_length));
        let high_a = edge_bound(a, normal, e, of_a, 1.0);
        let high_b = edge_bound(b, placing.turned_to_b(normal).map(|x| -x), g, of_b, 1.0);
        placing.between_bounds(normal, [high_a, high_b])
    };
    let distance = length(edges.between_witnesses(on_a[0], [s, t]));
    (vec![distance], vec![lower])
}

fn transcribed(end: &WalkEnd, [a, b]: [&ConvexPolyhedron; 2]) -> (usize, Bounds) {
    use Feature::{Edge, Face, Vertex};
    let placing = Placing::<Single> {
        rotation: end.rotation,
        translation: end.translation,
    };
    match (end.features.a, end.features.b) {
        (Vertex(v), Vertex(w)) => {
            let d = length(placing.between_vertices([point(a, v), point(b, w)]));
            (0, (vec![d], vec![d]))
        }
        (Face(f), Vertex(v)) => (1, over_face(placing.in_a(point(b, v)), a, f)),
        (Vertex(v), Face(f)) => (2, over_face(placing.in_b(point(a, v)), b, f)),
        (Edge(e), Vertex(v)) => (3, beside_edge(placing.in_a(point(b, v)), a, e, end.size)),
        (Vertex(v), Edge(e)) => (4, beside_edge(placing.in_b(point(a, v)), b, e, end.size)),
        (Edge(e), Edge(g)) => (5, between_edges(&placing, [a, b], [e, g], end.normal)),
        other => panic!("no state of the walk: {other:?}"),
    }
}

#[test]
fn walks() {
    let mut rng = Rng::new(21);
    let bodies = bodies(&mut rng);
    let (mut ends, mut proven) = ([0; 6], [0; 6]);
    for k in 0..TRIES {
        let (a, b) = (rng.pick(&bodies), rng.pick(&bodies));
        let Some(pose) = pose(&mut rng) else { continue };
        let Some(end) = library::walk_end(a, b, &pose) else {
            continue;
        };
        let (kind, (distances, lowers)) = transcribed(&end, [a, b]);
        ends[kind] += 1;
        assert!(
            distances.contains(&end.distance),
            "{k}: {end:?}, transcribed {distances:?}"
        );
        if end.lower.is_finite() {
            proven[kind] += 1;
            assert!(lowers.contains(&end.lower), "{k}: {end:?}, transcribed {lowers:?}");
        }
    }
    println!("{ends:?} ended, {proven:?} proven");
    assert!(proven.iter().all(|n| *n > 500), "{ends:?} ended, {proven:?} proven");
}

#[test]
fn supports() {
    let mut rng = Rng::new(22);
    let bodies = bodies(&mut rng);
    for k in 0..TRIES {
        let (a, b) = (rng.pick(&bodies), rng.pick(&bodies));
        let (pose, normal) = (pose(&mut rng), [0; 3].map(|_| rng.range(-3.0, 3.0)));
        let Some((end, pose)) = pose.and_then(|p| Some((library::walk_end(a, b, &p)?, p))) else {
            continue;
        };
        let (distance, n, [v, w]) = library::support_distance(a, b, &pose, normal).expect("a pair in range");
        let placing = Placing::<Single> {
            rotation: end.rotation,
            translation: end.translation,
        };
        let ours = placing.support_distance(n, [point(a, v), point(b, w)]);
        assert_eq!(ours, distance, "{k}");
        assert_eq!(n, normal.map(|x| x / length(normal)));
    }
}

/// What a solver computes with, beyond sums and products.
trait Solving: Number + PartialEq + std::fmt::Debug {
    fn of(parts: [f64; 2]) -> Self;
    fn over(self, below: Self) -> Self;
    fn root(self) -> Self;
}

impl Solving for f64 {
    fn of([high, low]: [f64; 2]) -> Self {
        assert_eq!(low, 0.0);
        high
    }
    fn over(self, below: Self) -> Self {
        self / below
    }
    fn root(self) -> Self {
        self.sqrt()
    }
}

impl Solving for Twice {
    fn of(parts: [f64; 2]) -> Self {
        Self(parts)
    }
    fn over(self, below: Self) -> Self {
        self.over(below)
    }
    fn root(self) -> Self {
        self.root()
    }
}

fn solves<N: Solving>(seed: u64, is_double_double: bool) {
    let mut rng = Rng::new(seed);
    let bodies = bodies(&mut rng);
    let (mut compared, wide) = (0, |p: Vector<f64>| p.map(N::exact));
    for k in 0..TRIES / 4 {
        let (a, b) = (rng.pick(&bodies), rng.pick(&bodies));
        let Some(pose) = pose(&mut rng) else { continue };
        let Some(end) = library::minimum_end(a, b, &pose, is_double_double) else {
            continue;
        };
        let placing = Placing::<Coordinates<N>> {
            rotation: end.rotation.map(|row| row.map(N::of)),
            translation: end.translation.map(N::of),
        };
        let at = |[v, w]: [VertexId; 2]| placing.difference([wide(point(a, v)), wide(point(b, w))]);
        let points: Vec<Vector<N>> = end.points.iter().map(|p| at(*p)).collect();
        let weights: Vec<N> = end.weights.iter().map(|x| N::of(*x)).collect();
        let v = certificate::combined::<Coordinates<N>>(&points, &weights);
        assert_eq!(dot(v, v).root(), N::of(end.distance), "{k}");
        if !end.lower[0].is_finite() {
            continue;
        }
        let d = end.direction.map(N::of);
        let height = dot(d, at(end.support)).over(dot(d, d).root());
        assert_eq!(height, N::of(end.lower), "{k}");
        compared += 1;
    }
    assert!(compared > TRIES / 8, "only {compared}");
}

#[test]
fn solves_in_f64() {
    solves::<f64>(23, false);
}

#[test]
fn solves_in_double_double() {
    solves::<Twice>(24, true);
}

/// The pose in double-double.
#[test]
fn poses_in_double_double() {
    let mut rng = Rng::new(25);
    let bodies = bodies(&mut rng);
    for k in 0..TRIES / 10 {
        let Some(pose) = pose(&mut rng) else { continue };
        let Some(end) = library::minimum_end(&bodies[0], &bodies[1], &pose, true) else {
            continue;
        };
        let (p, q) = pose.poses();
        let [a, b] = [&p, &q].map(|pose| {
            let c = pose.rotation.coords;
            let [x, y, z, w] = [c.x, c.y, c.z, c.w].map(Twice::exact);
            let s = Twice::exact(2.0).over(x * x + y * y + z * z + w * w);
            certificate::rotation([x, y, z, w], s)
        });
        let of = |m: [[[f64; 2]; 3]; 3]| m.map(|row| row.map(Twice));
        let rotation = certificate::rotation_between::<Coordinates<Twice>>([a, b]);
        assert_eq!(rotation, of(end.rotation), "{k}");
        let none = [Twice::exact(0.0); 3];
        let difference = [0, 1, 2].map(|k| {
            let (high, low) = proofs::traced::two_sum(q.translation.vector[k], -p.translation.vector[k]);
            Twice([high, low])
        });
        let shift = certificate::shift::<Coordinates<Twice>>([a, b], [none; 2], difference);
        assert_eq!(shift, end.translation.map(Twice), "{k}");
    }
}

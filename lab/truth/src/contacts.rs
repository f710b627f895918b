//! Scenes for timing contacts: two bodies of the crate and their poses in each frame.

use crate::motion::Frame;
use crate::pose::{cross, radius, scale, sub, unit};
use crate::rng::Rng;
use crate::workload::{self, DEPTH, FacePlane};
use crate::{Face, Point};
use lin_canny::{ConvexPolyhedron, FaceId, RelativePose, Tracker};
use nalgebra::{Isometry3, Point3};

/// The motions of the bodies.
///
/// * `shallow-0.5`: a constant depth of 1 % of the size, while B spins and orbits by half a degree
///   per frame
/// * `resting`: a face lies flat on a face, penetrating by a thousandth of the radius of the
///   smaller face, with a noise of a millionth
/// * `sliding`: the same, shifted to and fro by 1 % of that radius per frame; random hulls orbit in
///   contact instead, without a spin
/// * `passing`: from apart to overlap and back, 4 % of the radius in each direction, while B spins
///   and orbits
pub const SCENES: [&str; 4] = ["shallow-0.5", "resting", "sliding", "passing"];

/// Prediction distance of the contacts: 1 % of the size.
pub const PREDICTION: f64 = 0.02;

/// Returns the shapes of a scene, with their numbers of vertices.
pub fn shapes(scene: &str) -> Vec<(&'static str, usize)> {
    let kinds = match scene {
        "resting" | "sliding" => ["sphere", "prism"],
        _ => ["sphere", "flat"],
    };
    let sizes = |kind| workload::SIZES.map(|n| (kind, n));
    kinds.into_iter().flat_map(sizes).chain([("box", 8)]).collect()
}

/// A pair in contact.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The first body.
    pub a: ConvexPolyhedron,
    /// The second.
    pub b: ConvexPolyhedron,
    /// Poses in the world frame.
    pub frames: Vec<Frame>,
}

impl Scene {
    /// Returns `count` frames of a scene of [`SCENES`], always the same for the same names.
    pub fn new(scene: &str, shape: &str, n: usize, count: usize) -> Self {
        let mut rng = Rng::new(2000 + n as u64);
        let (a, b) = (body(shape, n, &mut rng), body(shape, n, &mut rng));
        let frames = frames(scene, shape, count, (&a, &b), &mut rng);
        Self { a, b, frames }
    }

    /// Returns the world poses of both bodies, frame by frame.
    pub fn poses(&self) -> Vec<(Isometry3<f64>, Isometry3<f64>)> {
        self.frames.iter().map(|f| (f.a.isometry(), f.b.isometry())).collect()
    }
}

fn body(shape: &str, n: usize, rng: &mut Rng) -> ConvexPolyhedron {
    let points: Vec<Point3<f64>> = workload::points(shape, n, rng).into_iter().map(Into::into).collect();
    ConvexPolyhedron::from_points(&points).expect("the points of a solid")
}

fn frames(
    scene: &str,
    shape: &str,
    count: usize,
    (a, b): (&ConvexPolyhedron, &ConvexPolyhedron),
    rng: &mut Rng,
) -> Vec<Frame> {
    let mut pair = Tracker::new();
    let query = |f: &Frame| {
        let (pa, pb) = (f.a.isometry(), f.b.isometry());
        let relative = RelativePose::new(&pa, &pb).expect("a pose");
        let o = pair.closest(a, b, &relative);
        (o.distance, (pa * o.normal.into_inner()).into())
    };
    let laid = |rng: &mut Rng| {
        let ((face_a, ra), (face_b, rb)) = (widest_face(a), widest_face(b));
        let reach = ra.min(rb);
        let start = workload::stacked(face_a, face_b, rng.range(0.0, 6.0), -1e-3 * reach);
        (start, face_a.1, reach)
    };
    match (scene, shape) {
        ("shallow-0.5", _) => workload::contact((0.5, 0.5), count, rng, |_| -DEPTH, query),
        ("passing", _) => {
            let swing = |k: usize| 2.0 * DEPTH * (std::f64::consts::TAU * k as f64 / 100.0).cos();
            workload::contact((0.5, 0.5), count, rng, swing, query)
        }
        ("sliding", "sphere") => workload::contact((0.0, 0.5), count, rng, |_| -DEPTH, query),
        ("sliding", _) => {
            let (start, up, reach) = laid(rng);
            let aside = unit(cross(up, [0.3, 0.5, 0.8]));
            workload::to_and_fro(start, scale(aside, 0.5 * reach), 200, count, rng)
        }
        _ => {
            let (start, _, reach) = laid(rng);
            workload::at_rest(start, 1e-6 * reach, reach, count, rng)
        }
    }
}

/// Returns the widest face: its plane, and the largest distance of a vertex from its centre.
pub fn widest_face(body: &ConvexPolyhedron) -> (FacePlane, f64) {
    let of = |f: FaceId| {
        let corners = body.face_vertices(f).filter_map(|v| body.vertex(v));
        let corners: Vec<Point> = corners.map(Into::into).collect();
        let sum = corners.iter().fold([0.0; 3], |s, &p| crate::pose::add(s, p));
        let middle = scale(sum, 1.0 / corners.len() as f64);
        let reach = radius(&corners.iter().map(|&p| sub(p, middle)).collect::<Vec<_>>());
        let (normal, _) = body.face_plane(f).expect("a face of the body");
        ((middle, normal.into_inner().into()), reach)
    };
    let faces = body.faces().map(of);
    faces.max_by(|x, y| x.1.total_cmp(&y.1)).expect("a solid has faces")
}

/// Returns points and faces of a body as plain data.
pub fn plain(body: &ConvexPolyhedron) -> (Vec<Point>, Vec<Face>) {
    let at = body.vertex_points().map(Into::into).collect();
    let rim = |f| body.face_vertices(f).map(|v| v.index() as u32).collect();
    (at, body.faces().map(rim).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_what_they_say() {
        for scene in SCENES {
            for shape in ["sphere", "prism", "box"] {
                let s = Scene::new(scene, shape, 8, 60);
                let (mut pair, mut signs) = (Tracker::new(), [0; 2]);
                for (pa, pb) in s.poses() {
                    let o = pair.closest(&s.a, &s.b, &RelativePose::new(&pa, &pb).expect("a pose"));
                    signs[usize::from(o.distance < 0.0)] += 1;
                    match scene {
                        "shallow-0.5" => assert!((o.distance + DEPTH).abs() < 1e-3 * DEPTH),
                        "passing" => assert!(o.distance.abs() < 2.001 * DEPTH),
                        _ => assert!((-0.03..0.0).contains(&o.distance), "{scene} {shape}: {o:?}"),
                    }
                }
                assert!(signs[1] == 60 || scene == "passing" && signs[0] > 20 && signs[1] > 20);
            }
        }
    }
}

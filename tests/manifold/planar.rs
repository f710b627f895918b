//! Overlap of two faces and area of contact points, in the plane perpendicular to the normal, by
//! brute force.

use lin_canny::{ContactPoint, ConvexPolyhedron, Feature, Manifold};
use truth::motion::Frame;
use truth::pose::{cross, dot, unit};
use truth::support;
use truth::{Point, Pose};

/// Returns faces in the world frame seen along `n`, in two coordinates.
fn seen(body: &ConvexPolyhedron, pose: &Pose, feature: Feature, [e1, e2]: [Point; 2]) -> Vec<[f64; 2]> {
    let Feature::Face(f) = feature else { return vec![] };
    let (n, offset) = body.face_plane(f).expect("a face");
    let corners = body
        .vertex_points()
        .filter(|p| (n.dot(&p.coords) - offset).abs() < 1e-11);
    hull(
        corners
            .map(|p| [e1, e2].map(|e| dot(e, pose.apply(p.coords.into()))))
            .collect(),
    )
}

fn area(p: &[[f64; 2]]) -> f64 {
    let turn = |k: usize| {
        let (p, q) = (p[k], p[(k + 1) % p.len()]);
        p[0] * q[1] - p[1] * q[0]
    };
    (0..p.len()).map(turn).sum::<f64>() / 2.0
}

/// Clips one polygon by the sides of another, both counter-clockwise (Sutherland and Hodgman).
fn cut(mut p: Vec<[f64; 2]>, by: &[[f64; 2]]) -> Vec<[f64; 2]> {
    for k in 0..by.len() {
        let (q, r) = (by[k], by[(k + 1) % by.len()]);
        let side = |x: [f64; 2]| (r[0] - q[0]) * (x[1] - q[1]) - (r[1] - q[1]) * (x[0] - q[0]);
        let mut out = vec![];
        for i in 0..p.len() {
            let (x, y) = (p[i], p[(i + 1) % p.len()]);
            let (s, t) = (side(x), side(y));
            if s >= 0.0 {
                out.push(x);
            }
            if (s >= 0.0) != (t >= 0.0) {
                let w = s / (s - t);
                out.push([x[0] + w * (y[0] - x[0]), x[1] + w * (y[1] - x[1])]);
            }
        }
        p = out;
    }
    p
}

/// Returns the hull of a few points in the plane, counter-clockwise.
fn hull(mut p: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    p.sort_by(|x, y| x[0].total_cmp(&y[0]).then(x[1].total_cmp(&y[1])));
    let chain = |list: &mut dyn Iterator<Item = &[f64; 2]>| {
        let mut out: Vec<[f64; 2]> = vec![];
        for &x in list {
            while let [.., q, r] = out[..] {
                if (r[0] - q[0]) * (x[1] - q[1]) - (r[1] - q[1]) * (x[0] - q[0]) > 0.0 {
                    break;
                }
                out.pop();
            }
            out.push(x);
        }
        out.pop();
        out
    };
    let (mut low, high) = (chain(&mut p.iter()), chain(&mut p.iter().rev()));
    low.extend(high);
    low
}

/// Returns the area that the points of a manifold span, the area of the overlap of its faces, and
/// the number of its vertices.
pub(crate) fn spanned(
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    frame: &Frame,
    m: &Manifold,
) -> Option<(f64, f64, usize)> {
    let f = m.features().filter(|&f| support::kinds(f) == (2, 2))?;
    let n: Point = frame.a.rotate(m.normal().into_inner().into());
    let e1 = unit(cross(
        n,
        if n[0].abs() < 0.6 {
            [1.0, 0.0, 0.0]
        } else {
            [0.0, 1.0, 0.0]
        },
    ));
    let axes = [e1, cross(n, e1)];
    let of_a = seen(a, &frame.a, f.a, axes);
    let of_b = seen(b, &frame.b, f.b, axes);
    let shared = cut(of_a, &of_b);
    let at = |p: &ContactPoint| {
        let x = frame.a.apply(p.point_on_a.coords.into());
        axes.map(|e| dot(e, x))
    };
    let points = hull(m.points().iter().map(at).collect());
    // Faces that meet only along an edge: their overlap is as wide as the rounding of a vertex.
    let extent = shared.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
    let rounding = 8.0 * f64::EPSILON * extent * extent;
    let shared_area = area(&shared);
    let shared_area = if shared_area > rounding { shared_area } else { 0.0 };
    Some((area(&points), shared_area, shared.len()))
}

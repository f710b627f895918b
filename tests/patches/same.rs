//! Changes of the numbers of a surface that do not change the surface change no result: intervals
//! overlap.

use lin_canny::nalgebra::{Isometry3, Point3};
use lin_canny::surface::{BezierPatch, BezierSurface, Nurbs};
use lin_canny::{PairTracker, QueryOptions, WitnessLocation};
use truth::rng::Rng;

use crate::bodies::{bumpy, grid, place, pose};

const WIDTH: f64 = 1e-10;

/// Asserts that two surfaces have one distance to a third.
fn same(a: &BezierSurface, other: &BezierSurface, b: &BezierSurface, at: &Isometry3<f64>, what: &str) {
    let o = PairTracker::new().closest_with(a, b, &pose(at), &QueryOptions::default().width(WIDTH));
    let p = PairTracker::new().closest_with(other, b, &pose(at), &QueryOptions::default().width(WIDTH));
    assert!(o.is_converged && p.is_converged, "{what}: {o:?} {p:?}");
    assert!(o.lower <= p.upper + 1e-14, "{what}: {o:?} {p:?}");
    assert!(p.lower <= o.upper + 1e-14, "{what}: {o:?} {p:?}");
}

fn one(patch: BezierPatch) -> BezierSurface {
    BezierSurface::new(vec![patch]).expect("a surface")
}

/// Returns points and weights of a patch.
fn parts(p: &BezierPatch) -> (Vec<Point3<f64>>, Vec<f64>) {
    p.control_points().unzip()
}

/// Returns the patch with its degree in v raised by one.
fn raised(p: &BezierPatch) -> BezierPatch {
    let [m, n] = p.degrees();
    let (points, weights) = parts(p);
    let (mut new, mut all) = (Vec::new(), Vec::new());
    for i in 0..=m {
        for j in 0..=n + 1 {
            let t = j as f64 / (n + 1) as f64;
            let at = |j: usize| i * (n + 1) + j;
            let (low, high) = (at(j.saturating_sub(1)), at(j.min(n)));
            let w = t * weights[low] + (1.0 - t) * weights[high];
            let p = points[low].coords * (t * weights[low]) + points[high].coords * ((1.0 - t) * weights[high]);
            new.push(Point3::from(p / w));
            all.push(w);
        }
    }
    BezierPatch::rational([m, n + 1], &new, &all).expect("a patch")
}

#[test]
fn other_numbers_of_one_surface() {
    for k in 0..40 {
        let mut rng = Rng::of_case(21, k);
        let [m, n] = [1 + rng.below(4), 1 + rng.below(4)];
        let points = grid(&mut rng, [m, n], 0.7);
        let weights: Vec<f64> = points.iter().map(|_| rng.range(0.5, 2.0)).collect();
        let patch = BezierPatch::rational([m, n], &points, &weights).expect("a patch");
        let (a, b) = (one(patch.clone()), one(bumpy(&mut rng, [3, 3], 0.7)));
        let at = place(&mut rng, 3.0);
        same(&a, &one(raised(&patch)), &b, &at, "degree raised");
        let halves = patch.split(0).into_iter().flat_map(|p| p.split(1)).collect();
        same(&a, &BezierSurface::new(halves).expect("parts"), &b, &at, "split");
        let turned = |k: usize| (k % (m + 1)) * (n + 1) + k / (m + 1);
        let (swapped, of): (Vec<_>, Vec<_>) = (0..points.len())
            .map(|k| (points[turned(k)], weights[turned(k)]))
            .unzip();
        same(
            &a,
            &one(BezierPatch::rational([n, m], &swapped, &of).expect("a patch")),
            &b,
            &at,
            "u and v exchanged",
        );
        // A projective change of u: weights times powers of a number.
        let of: Vec<f64> = (0..points.len())
            .map(|k| weights[k] * 1.7_f64.powi((k / (n + 1)) as i32))
            .collect();
        same(
            &a,
            &one(BezierPatch::rational([m, n], &points, &of).expect("a patch")),
            &b,
            &at,
            "parameters changed",
        );
        let of: Vec<f64> = weights.iter().map(|w| w * 1e-3).collect();
        same(
            &a,
            &one(BezierPatch::rational([m, n], &points, &of).expect("a patch")),
            &b,
            &at,
            "weights scaled",
        );
    }
}

#[test]
fn a_triangle_is_half_of_a_plane_patch() {
    // A function of degree 2 over a triangle: as a triangular patch, and below a tensor-product
    // patch that comes no closer on the part with x + y <= 1.
    let f = |x: f64, y: f64| 0.3 * x * x - 0.4 * y * y + 0.2 * x * y;
    // The blossom of f at two corners.
    let blossom = |p: [f64; 2], q: [f64; 2]| 0.3 * p[0] * q[0] - 0.4 * p[1] * q[1] + 0.1 * (p[0] * q[1] + q[0] * p[1]);
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let pairs = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
    let point = |(i, j): (usize, usize)| {
        let (p, q) = (corners[i], corners[j]);
        Point3::new(0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1]), blossom(p, q))
    };
    let patch = BezierPatch::triangular(2, &pairs.map(point), None).expect("a patch");
    for (u, v) in [(0.0, 0.3), (0.4, 0.2), (1.0, 0.7), (0.8, 1.0)] {
        let (x, y) = (u * (1.0 - v), u * v);
        let p = patch.point(u, v);
        assert!((p - Point3::new(x, y, f(x, y))).norm() < 1e-15, "{p}");
    }
    let mut rng = Rng::new(2);
    let b = one(bumpy(&mut rng, [2, 2], 0.5));
    let a = one(patch.clone());
    let four: Vec<BezierPatch> = patch.split(0).into_iter().flat_map(|p| p.split(1)).collect();
    let four = BezierSurface::new(four).expect("parts");
    for _ in 0..20 {
        let at = place(&mut rng, 2.5);
        same(&a, &four, &b, &at, "triangle split");
    }
}

/// Returns a value of a B-spline by its definition (Cox 1972, de Boor 1972).
fn basis(knots: &[f64], i: usize, degree: usize, t: f64) -> f64 {
    if degree == 0 {
        return f64::from(u8::from(knots[i] <= t && t < knots[i + 1]));
    }
    let part = |a: f64, b: f64| if b > 0.0 { a / b } else { 0.0 };
    part(t - knots[i], knots[i + degree] - knots[i]) * basis(knots, i, degree - 1, t)
        + part(knots[i + degree + 1] - t, knots[i + degree + 1] - knots[i + 1]) * basis(knots, i + 1, degree - 1, t)
}

#[test]
fn nurbs_are_taken_apart() {
    let mut rng = Rng::new(31);
    let knots: [&[f64]; 2] = [
        &[0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 2.5, 4.0, 4.0, 4.0, 4.0],
        &[-1.0, 0.0, 0.5, 1.5, 2.0, 4.0, 5.0],
    ];
    let degrees = [3, 2];
    let counts = [7, 4];
    let points = grid(&mut rng, [6, 3], 0.8);
    let weights: Vec<f64> = points.iter().map(|_| rng.range(0.5, 2.0)).collect();
    let nurbs = Nurbs {
        degrees,
        knots,
        points: &points,
        weights: Some(&weights),
        trimming_curves: 0,
    };
    let surface = BezierSurface::from_nurbs(&nurbs).expect("a surface");
    assert_eq!(surface.patches().len(), 6);
    for k in 0..600 {
        let at = WitnessLocation::on_patch(k % 6, [rng.uniform(), rng.uniform()]);
        let [u, v] = surface.parameters(&at).expect("a patch");
        let (mut sum, mut weight) = (lin_canny::nalgebra::Vector3::zeros(), 0.0);
        for (n, p) in points.iter().enumerate() {
            let c = weights[n] * basis(knots[0], n / counts[1], 3, u) * basis(knots[1], n % counts[1], 2, v);
            sum += p.coords * c;
            weight += c;
        }
        let off = (surface.point(&at).expect("a patch").coords - sum / weight).norm();
        assert!(off < 1e-14, "{off:e} at {u} {v}");
    }
}

//! Bézier surfaces as triangles that are thick enough to contain them.
//!
//! A patch is halved until it is nearly flat, and stated as the two triangles of its corners.
//!
//! **The thickness.** Let Q be the bilinear patch of the corners, `c_uv`, and let every control point `P_ij` of degrees
//! p and q be within `d` of `Q(i/p, j/q)`. Weights are positive, so the patch lies in the hull of the control points,
//! which is within `d` of the hull of the corners. This is a tetrahedron. Its lower and its upper sides are two
//! triangles each, which are at most half of the twist `w = |c_00 - c_01 - c_10 + c_11|` apart along its direction. So
//! the patch is within `d + w / 2` of the two triangles stated.
//!
//! **How much larger.** The point of the patch at (u, v) is a mean of control points, within `d` of the mean of the
//! `Q(i/p, j/q)` with the same weights, and within `d + w / 4` of `Q` at the mean of the `(i/p, j/q)`. This mean runs
//! from side to side as (u, v) does, so it takes every value in the square. Hence each point of Q is within `d + w / 4`
//! of the patch, each point of a triangle within `d + w / 2`, and each point of the thick triangles within twice the
//! thickness.

use std::collections::BTreeMap;

use nalgebra::Point3;

use super::stated::{FINENESS, StatedParts};
use crate::extremes::Extremes;
use crate::tolerance::CONTAINED;
use lin_canny::surface::{BezierPatch, BezierSurface};

/// The greatest thickness, over the size of the surface, at each fineness.
const THICKNESS: [f64; FINENESS] = [1.0 / 256.0, 1.0 / 2048.0, 1.0 / 16_384.0];

/// Greatest number of halvings of a patch.
const HALVINGS: u32 = 40;

/// Returns the triangles of a surface, and by how much they are larger; `None` if they are more than `most`.
pub(super) fn triangles(surface: &BezierSurface, fineness: usize, most: usize) -> Option<(StatedParts, f64)> {
    let (low, high) = surface.aabb();
    let (centre, radius) = surface.bounding_ball();
    let size = 0.5 * (high - low).norm();
    let far = centre.coords.norm() + radius;
    // The ball is larger than that of the box by the error of points, however the patches were given.
    let error = (radius - size).larger(0.0) + CONTAINED * far;
    let allowed = THICKNESS[fineness] * size;
    let mut known: BTreeMap<[u64; 3], usize> = BTreeMap::new();
    let (mut points, mut parts, mut thick) = (Vec::new(), Vec::new(), 0.0f64);
    let mut todo: Vec<(BezierPatch, u32)> = surface.patches().iter().map(|patch| (patch.clone(), 0)).collect();
    while let Some((patch, halvings)) = todo.pop() {
        let flat = Flat::new(&patch);
        if flat.thickness > allowed && halvings < HALVINGS {
            todo.extend(patch.split(flat.longer).map(|half| (half, halvings + 1)));
            continue;
        }
        thick = flat.thickness.larger(thick);
        let [a, b, c, d] = flat.corners.map(|corner| {
            *known.entry(corner.coords.map(f64::to_bits).into()).or_insert_with(|| {
                points.push(corner);
                points.len() - 1
            })
        });
        parts.extend([[a, b, d], [a, d, c]]);
        if parts.len() > most {
            return None;
        }
    }
    let radius = thick * (1.0 + f64::EPSILON.sqrt()) + error;
    let stated = StatedParts::of_thick(points, parts, radius);
    Some((stated, 2.0 * radius * (1.0 + f64::EPSILON)))
}

/// How flat a patch is.
struct Flat {
    /// At (0, 0), (0, 1), (1, 0) and (1, 1).
    corners: [Point3<f64>; 4],
    thickness: f64,
    /// The direction to halve in: that in which the control points bend most.
    longer: usize,
}

impl Flat {
    fn new(patch: &BezierPatch) -> Self {
        let [p, q] = patch.degrees();
        let net: Vec<Point3<f64>> = patch.control_points().map(|(point, _)| point).collect();
        let at = |i: usize, j: usize| net[i * (q + 1) + j];
        let corners = [at(0, 0), at(0, q), at(p, 0), at(p, q)];
        let along = |a: Point3<f64>, b: Point3<f64>, part: f64| a + (b - a) * part;
        let (mut off, mut bends) = (0.0f64, [0.0f64; 2]);
        for i in 0..=p {
            for j in 0..=q {
                let (u, v) = (i as f64 / p as f64, j as f64 / q as f64);
                let sides = [along(corners[0], corners[1], v), along(corners[2], corners[3], v)];
                off = (at(i, j) - along(sides[0], sides[1], u)).norm().larger(off);
                bends[0] = (at(i, j) - along(at(0, j), at(p, j), u)).norm().larger(bends[0]);
                bends[1] = (at(i, j) - along(at(i, 0), at(i, q), v)).norm().larger(bends[1]);
            }
        }
        let twist = ((corners[0] - corners[1]) - (corners[2] - corners[3])).norm();
        // A patch that only twists is halved along its longer side.
        let [down, across] = [corners[2] - corners[0], corners[1] - corners[0]].map(|side| side.norm());
        let is_across = match bends[0] + bends[1] > 0.25 * twist {
            true => bends[1] > bends[0],
            false => across > down,
        };
        Self {
            corners,
            thickness: off + 0.5 * twist,
            longer: usize::from(is_across),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lin_canny::nalgebra::{Isometry3, Vector3};
    use lin_canny::polyhedron::ConvexPolyhedron;
    use lin_canny::{Geometry, PairTracker, RelativePose};
    use truth::rng::Rng;

    /// Points of the surface are within the radius of a triangle, and points of the thick triangles as near to the
    /// surface as is said.
    #[test]
    fn triangles_contain_the_surface_and_are_not_much_larger() {
        let mut rng = Rng::new(5);
        let mut tight = [0.0f64; 2];
        for round in 0..60 {
            let degrees = [1 + rng.below(4), 1 + rng.below(4)];
            let count = (degrees[0] + 1) * (degrees[1] + 1);
            let scale = [1.0, 1e-60, 1e60][round % 3];
            let point = |_| Point3::from(Vector3::from_fn(|_, _| scale * rng.range(-1.0, 1.0)));
            let points: Vec<Point3<f64>> = (0..count).map(point).collect();
            let weights: Vec<f64> = (0..count).map(|_| rng.range(0.2, 3.0)).collect();
            let patch = match round % 2 {
                0 => BezierPatch::polynomial(degrees, &points),
                _ => BezierPatch::rational(degrees, &points, &weights),
            };
            let surface = BezierSurface::new(vec![patch.expect("a patch")]).expect("a surface");
            let (stated, larger) = triangles(&surface, round % 2, 1 << 20).expect("few triangles");
            let radius = stated.radii[0];
            let corners = |part: &Vec<usize>| [0, 1, 2].map(|k| stated.points[part[k]]);
            for _ in 0..20 {
                let on = surface.patches()[0].point(rng.uniform(), rng.uniform());
                let off = |part: &Vec<usize>| distance(on, corners(part));
                let least = stated.parts.iter().map(off).fold(f64::INFINITY, f64::smaller);
                assert!(least <= radius, "{round}: {least:e} {radius:e}");
                tight[0] = (least / radius).larger(tight[0]);
            }
            let body = Geometry::from(surface);
            for _ in 0..20 {
                let [a, b, c] = corners(&stated.parts[rng.below(stated.parts.len())]);
                let (s, t) = (rng.uniform(), rng.uniform());
                let (s, t) = if s + t > 1.0 { (1.0 - s, 1.0 - t) } else { (s, t) };
                let on = a + (b - a) * s + (c - a) * t + Vector3::from(rng.unit()) * radius;
                let point = Geometry::from(ConvexPolyhedron::point(on).expect("a point"));
                let pose = RelativePose::from_isometry(&Isometry3::identity()).expect("a pose");
                let seen = PairTracker::new().closest(&point, &body, &pose).outcome;
                assert!(seen.lower <= larger, "{round}: {:e} {larger:e}", seen.lower);
                tight[1] = (seen.lower / larger).larger(tight[1]);
            }
        }
        assert!(tight[0] > 0.2 && tight[1] > 0.5, "{tight:?}");
    }

    fn distance(p: Point3<f64>, triangle: [Point3<f64>; 3]) -> f64 {
        let scale = triangle
            .iter()
            .fold(p.coords.amax(), |most, q| q.coords.amax().larger(most));
        let [p, a, b, c] = [p, triangle[0], triangle[1], triangle[2]].map(|p| p.coords / scale);
        let on_side = |a: Vector3<f64>, b: Vector3<f64>| {
            let way = b - a;
            let t = ((p - a).dot(&way) / way.norm_squared()).larger(0.0).smaller(1.0);
            (p - a - way * if t.is_nan() { 0.0 } else { t }).norm()
        };
        let sides = [on_side(a, b), on_side(b, c), on_side(c, a)];
        let normal = (b - a).cross(&(c - a));
        let is_inside = [(a, b), (b, c), (c, a)]
            .iter()
            .all(|(x, y)| (y - x).cross(&(p - x)).dot(&normal) >= 0.0);
        let height = (p - a).dot(&normal).abs() / normal.norm();
        let nearest = sides.into_iter().fold(f64::INFINITY, f64::smaller);
        scale
            * if is_inside && height.is_finite() {
                height.smaller(nearest)
            } else {
                nearest
            }
    }
}

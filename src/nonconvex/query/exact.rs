//! Exact integer arithmetic for meshes: the side of a point within rounding of the surface, and
//! where a ray meets a triangle.
//!
//! The side of a point comes from the winding number ([`super::inside`]), for a point whose stored
//! coordinates are not exact. Signs come from floating point if rounding leaves no doubt, otherwise
//! from integers.

use core::cmp::Ordering;
use dashu_int::IBig;
use nalgebra::Vector3;

use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::sign::{self, projection};
use crate::base::pose::RelativePose;
use crate::base::tolerance::{EXACT_PLACE, SIDE_ERROR, TURN_ERROR};
use crate::body::polyhedron::lowest_bit;
use crate::convex::exact::integer::{Big3, cross, dot, integer, sign, sub};
use crate::convex::exact::place::{ExactVector, compare, quotient};
use crate::nonconvex::mesh::Mesh;
use crate::nonconvex::query::inside::ExactSigns;
use crate::nonconvex::query::ray::RayTriangle;
use crate::nonconvex::query::triangle::Triangle;

/// Side of a mesh on which a point is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PointSide {
    Outside,
    /// On the surface.
    On,
    Inside,
}

/// A triangle with integer coordinates, in units of `2^exponent`.
struct IntegerTriangle {
    corners: [Big3; 3],
    exponent: i32,
}

impl IntegerTriangle {
    fn new(corners: &Triangle) -> Self {
        let exponent = lowest_bit(corners.iter().flat_map(|v| v.iter().copied())).unwrap_or(0);
        Self {
            corners: corners.each(|v| [v.x, v.y, v.z].each(|x| integer(x, exponent))),
            exponent,
        }
    }

    fn normal(&self) -> Big3 {
        let [a, b, c] = &self.corners;
        cross(&sub(b, a), &sub(c, a))
    }
}

/// A point in stored coordinates of a mesh, exact and rounded.
struct Probe<'a> {
    exact: &'a ExactVector,
    rounded: Vector3<f64>,
    /// Largest error of a coordinate of the rounded point.
    error: f64,
}

impl ExactSigns for Probe<'_> {
    fn rounded(&self) -> (Vector3<f64>, f64) {
        (self.rounded, self.error)
    }

    fn height(&self, corners: &Triangle) -> i32 {
        let [a, b, c] = corners;
        let (u, v, w) = (b - a, c - a, self.rounded - a);
        let (mut height, mut size, mut sum) = (0.0, 0.0, 0.0);
        for k in 0..3 {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let (x, y) = (u[i] * v[j], u[j] * v[i]);
            height += (x - y) * w[k];
            size += (x.abs() + y.abs()) * w[k].abs();
            sum += x.abs() + y.abs();
        }
        // The second term is the error of the point, doubled for the rounding of the sum.
        let bound = SIDE_ERROR * size + 2.0 * self.error * sum + f64::MIN_POSITIVE;
        if height.abs() > bound {
            return sign::sign(height);
        }
        let t = IntegerTriangle::new(corners);
        let n = t.normal();
        let (over, exact) = (&self.exact.over, self.exact);
        order(compare(
            &dot(&n, &exact.at),
            exact.exponent,
            &(dot(&n, &t.corners[0]) * over),
            t.exponent,
        ))
    }

    fn turn(&self, axis: usize, a: &Vector3<f64>, b: &Vector3<f64>) -> i32 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let p = &self.rounded;
        let (du, dv) = (b[u] - a[u], b[v] - a[v]);
        let (x, y) = (du * (p[v] - a[v]), dv * (p[u] - a[u]));
        let bound = TURN_ERROR * (x.abs() + y.abs()) + 2.0 * self.error * (du.abs() + dv.abs()) + f64::MIN_POSITIVE;
        if (x - y).abs() > bound {
            return sign::sign(x - y);
        }
        let exponent = lowest_bit([a[u], a[v], b[u], b[v]]).unwrap_or(0);
        let [au, av, bu, bv] = [a[u], a[v], b[u], b[v]].each(|x| integer(x, exponent));
        let exact = self.exact;
        let through = (&bu - &au) * &exact.at[v] - (&bv - &av) * &exact.at[u];
        let level = (bu * av - au * bv) * &exact.over;
        order(compare(&through, exact.exponent, &level, exponent))
    }
}

fn order(order: core::cmp::Ordering) -> i32 {
    order as i32
}

impl Mesh {
    /// Returns the side of the mesh on which a point in stored coordinates lies.
    ///
    /// An open mesh has no inside.
    pub(crate) fn side_of(&self, exact: &ExactVector) -> PointSide {
        let rounded = exact.rounded();
        let error = EXACT_PLACE * rounded.amax() + f64::MIN_POSITIVE;
        let probe = Probe { exact, rounded, error };
        match self.winding_about(&probe, |_| true) {
            None => PointSide::On,
            Some(winding) if self.is_solid() && winding != 0 => PointSide::Inside,
            Some(_) => PointSide::Outside,
        }
    }
}

/// The ray that the caller gave, without rounding, in stored coordinates of a body.
pub(crate) struct ExactRay {
    /// Maps the origin of the ray to the body.
    pose: RelativePose,
    /// The origin of the stored coordinates in the body.
    about: Vector3<f64>,
    direction: Vector3<f64>,
    /// Computed when floating point first leaves a doubt.
    integers: Option<IntegerRay>,
}

struct IntegerRay {
    origin: ExactVector,
    direction: ExactVector,
    /// The moment of the line about the origin of the body, times the denominators of both vectors.
    moment: Big3,
    /// The direction times the denominator of the origin.
    weighed: Big3,
}

/// A distance along the ray: `num 2^exponent / den` with a positive `den`.
struct RayLength {
    num: IBig,
    den: IBig,
    exponent: i32,
}

impl ExactRay {
    pub(crate) fn new(pose: RelativePose, direction: Vector3<f64>, about: Vector3<f64>) -> Self {
        Self {
            pose,
            about,
            direction,
            integers: None,
        }
    }

    fn integers(&mut self, exponent: i32) -> &IntegerRay {
        let (pose, direction, about) = (&self.pose, &self.direction, &self.about);
        self.integers.get_or_insert_with(|| {
            let origin = origin_of(pose, about, exponent);
            let direction = ExactVector::new(direction).direction_in_a(pose);
            let moment = cross(&origin.at, &direction.at);
            let weighed = direction.at.each_ref().each(|x| x * &origin.over);
            IntegerRay {
                origin,
                direction,
                moment,
                weighed,
            }
        })
    }

    /// Returns the origin of the ray in units of `2^exponent`.
    pub(crate) fn origin(&self, exponent: i32) -> ExactVector {
        origin_of(&self.pose, &self.about, exponent)
    }

    /// Returns where the ray meets a triangle; `sides` are the known signs of its edges.
    pub(super) fn meets(
        &mut self,
        corners: &Triangle,
        exponent: i32,
        sides: [Option<i32>; 3],
        length: f64,
    ) -> RayTriangle {
        let ray = self.integers(exponent);
        let triangle = IntegerTriangle::new(corners);
        let mut signs = [0; 3];
        for k in 0..3 {
            signs[k] = sides[k].unwrap_or_else(|| ray.side(&triangle, k));
            if signs[..k].contains(&-signs[k]) && signs[k] != 0 {
                return RayTriangle::Miss;
            }
        }
        let along = match signs {
            [0, 0, 0] => {
                projection(&corners[0], &corners[1], &corners[2]).and_then(|axis| ray.first_of_edges(&triangle, axis))
            }
            _ => ray.to_plane(&triangle),
        };
        along.map_or(RayTriangle::Miss, |along| along.bracket(exponent, length))
    }
}

/// Returns the origin of a ray, minus `about`, in units of `2^exponent`.
fn origin_of(pose: &RelativePose, about: &Vector3<f64>, exponent: i32) -> ExactVector {
    let origin = ExactVector::new(&Vector3::zeros()).in_a(pose);
    origin.minus(about).in_units(exponent)
}

impl IntegerRay {
    /// Returns the side of an edge on which the line passes.
    fn side(&self, t: &IntegerTriangle, k: usize) -> i32 {
        let (a, b) = (&t.corners[k], &t.corners[(k + 1) % 3]);
        let (turn, lift) = (dot(&self.weighed, &cross(a, b)), dot(&sub(a, b), &self.moment));
        compare(&turn, t.exponent, &lift, self.origin.exponent) as i32
    }

    /// Returns the distance at which the line crosses the plane of a triangle.
    fn to_plane(&self, t: &IntegerTriangle) -> Option<RayLength> {
        let n = t.normal();
        let (o, d) = (&self.origin, &self.direction);
        let height = difference(
            &(dot(&n, &t.corners[0]) * &o.over),
            t.exponent,
            &dot(&n, &o.at),
            o.exponent,
        );
        self.along(height, t.exponent, dot(&n, &d.at))
    }

    /// Returns the distance `height / rise`; `None` if it is negative.
    ///
    /// `height` is a numerator over the denominator of the origin, `rise` one over the denominator
    /// of the direction.
    fn along(&self, height: IBig, exponent: i32, rise: IBig) -> Option<RayLength> {
        let (o, d) = (&self.origin, &self.direction);
        let (h, r) = (sign(&height), sign(&rise));
        if r == 0 || h * r < 0 {
            return None;
        }
        let (num, den) = (height * &d.over, rise * &o.over);
        let size = |x: IBig, sign: i32| if sign < 0 { -x } else { x };
        Some(RayLength {
            num: size(num, h),
            den: size(den, r),
            exponent: exponent.min(o.exponent) - d.exponent,
        })
    }

    /// Returns the distance of the first point of a triangle whose plane contains the line.
    ///
    /// At this point the line crosses an edge.
    fn first_of_edges(&self, t: &IntegerTriangle, axis: usize) -> Option<RayLength> {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let (o, d) = (&self.origin, &self.direction);
        let flat = |a: &[&IBig; 2], b: &[&IBig; 2]| a[0] * b[1] - a[1] * b[0];
        let way = [&d.at[u], &d.at[v]];
        // The vertex minus the origin, times the denominator of the origin.
        let place = |c: &Big3| [u, v].each(|k| difference(&(&c[k] * &o.over), t.exponent, &o.at[k], o.exponent));
        let places = t.corners.each_ref().each(place);
        let aside = places.each_ref().each(|p| sign(&flat(&way, &[&p[0], &p[1]])));
        let crossed = (0..3).filter(|&k| aside[k] * aside[(k + 1) % 3] <= 0 && aside[k] != aside[(k + 1) % 3]);
        let distances = crossed.filter_map(|k| {
            let (a, b) = (&t.corners[k], &t.corners[(k + 1) % 3]);
            let edge = [&b[u] - &a[u], &b[v] - &a[v]];
            let edge = [&edge[0], &edge[1]];
            let p = &places[k];
            self.along(flat(&[&p[0], &p[1]], &edge), t.exponent, flat(&way, &edge))
        });
        distances.min_by(|x, y| {
            let (left, right) = (&x.num * &y.den, &y.num * &x.den);
            compare(&left, x.exponent, &right, y.exponent)
        })
    }
}

/// Returns `x 2^e - y 2^f`, in units of the smaller power.
fn difference(x: &IBig, e: i32, y: &IBig, f: i32) -> IBig {
    let least = e.min(f);
    (x << (e - least) as usize) - (y << (f - least) as usize)
}

impl RayLength {
    /// Returns the bracket of the distance in the caller's unit, or a miss beyond the end of the
    /// ray.
    fn bracket(&self, unit: i32, length: f64) -> RayTriangle {
        let exponent = self.exponent + unit;
        let [low, high] = quotient(self.num.clone(), &self.den, exponent);
        if low >= length || high > length && self.exceeds(exponent, length) {
            return RayTriangle::Miss;
        }
        RayTriangle::Between(low, high.smaller(length))
    }

    fn exceeds(&self, exponent: i32, length: f64) -> bool {
        let lowest = lowest_bit([length]).unwrap_or(0);
        compare(&self.num, exponent, &(integer(length, lowest) * &self.den), lowest) == Ordering::Greater
    }
}

//! A ray and a triangle over the integers.

use core::cmp::Ordering;

use dashu_int::IBig;
use nalgebra::Vector3;

use crate::base::num::extremes::Extremes;
use crate::base::num::sign::projection;
use crate::base::pose::RelativePose;
use crate::body::polyhedron::lowest_bit;
use crate::composite::meet::exact_side::IntegerTriangle;
use crate::composite::meet::ray::{RayBody, RayTriangle};
use crate::composite::meet::triangle::Triangle;
use crate::convex::exact::integer::{Big3, cross, dot, integer, sign, sub};
use crate::convex::exact::place::{ExactVector, compare, quotient};

/// A ray as the caller gave it, in stored coordinates of a body.
pub(crate) struct ExactRay {
    /// From the body to the origin of the ray.
    pose: RelativePose,
    direction: Vector3<f64>,
    /// Made when floating point first leaves a doubt.
    integers: Option<IntegerRay>,
}

struct IntegerRay {
    origin: ExactVector,
    direction: ExactVector,
    /// Of the line about the origin, over the denominators of both.
    moment: Big3,
    /// The direction times the denominator of the origin.
    weighed: Big3,
}

/// A distance along the ray: `num 2^exponent / den`, `den` positive.
struct RayLength {
    num: IBig,
    den: IBig,
    exponent: i32,
}

impl ExactRay {
    pub(crate) fn new(pose: RelativePose, direction: Vector3<f64>) -> Self {
        Self {
            pose,
            direction,
            integers: None,
        }
    }

    fn integers(&mut self, exponent: i32) -> &IntegerRay {
        let (pose, direction) = (&self.pose, &self.direction);
        self.integers.get_or_insert_with(|| {
            let origin = origin_of(pose, exponent);
            let direction = ExactVector::new(direction).direction_in_a(pose);
            let moment = cross(&origin.at, &direction.at);
            let weighed = direction.at.each_ref().map(|x| x * &origin.over);
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
        origin_of(&self.pose, exponent)
    }

    /// Returns where the ray meets a triangle, of which some sides are known.
    pub(super) fn meets(
        &mut self,
        corners: &Triangle,
        body: RayBody,
        sides: [Option<i32>; 3],
        length: f64,
    ) -> RayTriangle {
        let ray = self.integers(body.exponent);
        let triangle = IntegerTriangle::new(corners);
        let mut signs = [0; 3];
        for k in 0..3 {
            signs[k] = sides[k].unwrap_or_else(|| ray.side(&triangle, k));
            if signs[..k].contains(&-signs[k]) && signs[k] != 0 {
                return RayTriangle::Miss;
            }
        }
        let along = match signs {
            // Of a closed surface another triangle holds the first point.
            [0, 0, 0] if body.is_closed => None,
            [0, 0, 0] => {
                projection(&corners[0], &corners[1], &corners[2]).and_then(|axis| ray.first_of_edges(&triangle, axis))
            }
            _ => ray.to_plane(&triangle),
        };
        along.map_or(RayTriangle::Miss, |along| along.bracket(body.exponent, length))
    }
}

/// Returns the origin of a ray in units of `2^exponent`.
fn origin_of(pose: &RelativePose, exponent: i32) -> ExactVector {
    ExactVector::new(&Vector3::zeros()).in_a(pose).in_units(exponent)
}

impl IntegerRay {
    /// Returns on which side of an edge the line passes.
    fn side(&self, t: &IntegerTriangle, k: usize) -> i32 {
        let (a, b) = (&t.corners[k], &t.corners[(k + 1) % 3]);
        let (turn, lift) = (dot(&self.weighed, &cross(a, b)), dot(&sub(a, b), &self.moment));
        compare(&turn, t.exponent, &lift, self.origin.exponent) as i32
    }

    /// Returns how far the plane of a triangle is that the line crosses.
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

    /// Returns the distance `height / rise` of a height over the denominator of the origin and a
    /// rise over that of the direction; `None` if it is negative.
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

    /// Returns how far the first point is of a triangle in a plane through the line: where the line
    /// crosses an edge.
    fn first_of_edges(&self, t: &IntegerTriangle, axis: usize) -> Option<RayLength> {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let (o, d) = (&self.origin, &self.direction);
        let flat = |a: &[&IBig; 2], b: &[&IBig; 2]| a[0] * b[1] - a[1] * b[0];
        let way = [&d.at[u], &d.at[v]];
        // Of a corner minus the origin, over the denominator of the origin.
        let place = |c: &Big3| [u, v].map(|k| difference(&(&c[k] * &o.over), t.exponent, &o.at[k], o.exponent));
        let places = t.corners.each_ref().map(place);
        let aside = places.each_ref().map(|p| sign(&flat(&way, &[&p[0], &p[1]])));
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

/// Returns `x 2^e - y 2^f`, in units of the lesser power.
fn difference(x: &IBig, e: i32, y: &IBig, f: i32) -> IBig {
    let least = e.min(f);
    (x << (e - least) as usize) - (y << (f - least) as usize)
}

impl RayLength {
    /// Returns the bracket of the distance in the caller's unit, if the ray gets there.
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

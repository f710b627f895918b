//! Exact contact state, signed distance, normal and witness points of two convex bodies of any
//! size.
//!
//! GJK and EPA on the difference A - B over the integers: each step of GJK computes the true
//! nearest point of a simplex, and EPA grows a polytope about the origin until its nearest facet
//! supports the difference exactly. `f64` only chooses which vertices and facets to compare first.
//! Squared distances stay fractions of integers; numbers are rounded once, at the end.
//!
//! [`crate::exact`] answers the same for small bodies by trying every direction.

use crate::body::Body;
use crate::polytope::Polytope;
use crate::pose::{add, norm, scale};
use crate::rational::{IntVec, cross, dot, over_root, placed_together, rounded, sub};
use crate::suite::Truth;
use crate::verdict::{ContactState, Exact};
use crate::{Point, Pose};
use dashu_base::{BitTest, Signed};
use dashu_int::IBig;
use dashu_ratio::RBig;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Returns the exact answer of a case.
///
/// Only the points of the bodies are used; a body may be flat.
///
/// # Panics
/// If a body has no points, or a number is not finite.
pub fn solve(a: Body, pose_a: &Pose, b: Body, pose_b: &Pose) -> Truth {
    let (pa, pb, den) = placed_together(a.points, pose_a, b.points, pose_b);
    let unit = RBig::from_parts(IBig::ONE, den);
    let pair = Pair {
        a: Cloud::new(pa),
        b: Cloud::new(pb),
    };
    let found = pair.closest();
    let squared = RBig::from_parts_signed(found.squared.0, found.squared.1) * &unit * &unit;
    let state = found.state;
    let exact = Exact::new(state, squared);
    let n = found.normal.map(RBig::from);
    let norm2 = n.iter().fold(RBig::ZERO, |s, x| s + x * x);
    let witness = |cloud: &Cloud, of: fn(&(Vertex, IBig)) -> usize| -> Point {
        let sum: IBig = found.weights.iter().map(|w| &w.1).sum();
        std::array::from_fn(|k| {
            let point: IBig = found.weights.iter().map(|w| &cloud.points[of(w)][k] * &w.1).sum();
            rounded(&(RBig::from_parts_signed(point, sum.clone()) * &unit))
        })
    };
    Truth {
        state,
        distance: exact.distance,
        remainder: exact.remainder,
        normal: Some(n.each_ref().map(|x| over_root(x, &norm2))),
        witnesses: Some((witness(&pair.a, |w| w.0.i), witness(&pair.b, |w| w.0.j))),
        size: Some(size(a, pose_a, b, pose_b)),
        ties: Some(found.ties),
    }
}

/// Returns the size of a pair, to which tolerances are relative: both radii about the centres of the
/// boxes, plus the distance of the centres.
pub fn size(a: Body, pose_a: &Pose, b: Body, pose_b: &Pose) -> f64 {
    let ball = |body: Body| {
        let end = |pick: fn(f64, f64) -> f64| -> Point {
            std::array::from_fn(|k| body.points.iter().map(|p| p[k]).reduce(pick).expect("points"))
        };
        let centre = scale(add(end(f64::min), end(f64::max)), 0.5);
        let radius = body.points.iter().map(|&p| norm(crate::pose::sub(p, centre)));
        (centre, radius.fold(0.0, f64::max))
    };
    let ((ca, ra), (cb, rb)) = (ball(a), ball(b));
    ra + rb + norm(crate::pose::sub(pose_a.apply(ca), pose_b.apply(cb)))
}

/// A vertex of A - B: vertex i of A minus vertex j of B.
#[derive(Clone)]
struct Vertex {
    i: usize,
    j: usize,
    p: IntVec,
}

/// The answer over the integers.
struct Found {
    state: ContactState,
    /// Square of the distance or depth, as numerator and denominator.
    squared: (IBig, IBig),
    /// Normal from A to B, of any length.
    normal: IntVec,
    /// The nearest point of A - B as weighted vertices; the same weights give both witness points.
    weights: Vec<(Vertex, IBig)>,
    ties: u64,
}

/// Points over the integers, with images in `f64` that say which may be extreme.
struct Cloud {
    points: Vec<IntVec>,
    /// The points less the first, at one scale.
    images: Vec<Point>,
    radius: f64,
}

/// Returns a vector at a scale at which its bits count from 62 downwards, rounded.
fn image(v: &IntVec, bits: usize) -> Point {
    v.each_ref().map(|x| match bits.checked_sub(62) {
        None | Some(0) => i64::try_from(x).expect("few bits") as f64,
        Some(shift) => i64::try_from(x >> shift).expect("few bits") as f64,
    })
}

fn bits(v: &IntVec) -> usize {
    v.iter().map(BitTest::bit_len).max().expect("three numbers")
}

/// Relative error of a product of two images, with a wide margin.
const IMAGE_ERROR: f64 = 1e-13;

impl Cloud {
    fn new(points: Vec<IntVec>) -> Self {
        let from_first: Vec<IntVec> = points.iter().map(|p| sub(p, &points[0])).collect();
        let scale = from_first.iter().map(bits).max().expect("a body has points");
        let images: Vec<Point> = from_first.iter().map(|v| image(v, scale)).collect();
        let radius = images.iter().map(|&v| norm(v)).fold(0.0, f64::max);
        Self { points, images, radius }
    }

    /// Returns the point with the greatest `n . p`, and that value.
    fn support(&self, n: &IntVec) -> (usize, IBig) {
        let near = image(n, bits(n));
        let heights: Vec<f64> = self.images.iter().map(|&v| crate::pose::dot(near, v)).collect();
        let top = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let floor = top - IMAGE_ERROR * norm(near) * self.radius - 8.0 * (norm(near) + self.radius);
        (0..heights.len())
            .filter(|&i| heights[i] >= floor)
            .map(|i| (i, dot(n, &self.points[i])))
            .reduce(|best, next| if next.1 > best.1 { next } else { best })
            .expect("a body has points")
    }
}

struct Pair {
    a: Cloud,
    b: Cloud,
}

impl Pair {
    fn vertex(&self, i: usize, j: usize) -> Vertex {
        Vertex {
            i,
            j,
            p: sub(&self.a.points[i], &self.b.points[j]),
        }
    }

    /// Returns the vertex of A - B with the greatest `n . p`, and that value.
    fn support(&self, n: &IntVec) -> (Vertex, IBig) {
        let (i, top) = self.a.support(n);
        let (j, bottom) = self.b.support(&negative(n));
        (self.vertex(i, j), top + bottom)
    }

    /// GJK; if the origin is in A - B, EPA.
    fn closest(&self) -> Found {
        let mut simplex = vec![self.vertex(0, 0)];
        loop {
            let near = nearest(&simplex);
            let n = near.direction;
            if is_zero(&n) {
                let weights = near.weights;
                return self.depth(weights);
            }
            let away = negative(&n);
            let (vertex, top) = self.support(&away);
            let here = dot(&away, &near.weights[0].0.p);
            if top == here {
                return Found {
                    state: ContactState::Separated,
                    squared: (&here * &here, dot(&n, &n)),
                    normal: away,
                    weights: near.weights,
                    ties: 1,
                };
            }
            simplex = near.weights.into_iter().map(|w| w.0).collect();
            simplex.push(vertex);
        }
    }

    /// Grows a simplex that contains the origin to four vertices that are not coplanar, with the
    /// origin still in it; or returns a direction along which A - B does not extend past the origin.
    fn tetrahedron(&self, mut simplex: Vec<Vertex>) -> Result<[Vertex; 4], IntVec> {
        while simplex.len() < 4 {
            let axis = |k: usize| -> IntVec { std::array::from_fn(|i| IBig::from(u8::from(i == k))) };
            let edge = |k: usize| sub(&simplex[k].p, &simplex[0].p);
            let directions: Vec<IntVec> = match simplex.len() {
                1 => (0..3).map(axis).collect(),
                2 => (0..3)
                    .map(|k| cross(&edge(1), &axis(k)))
                    .filter(|d| !is_zero(d))
                    .collect(),
                _ => vec![cross(&edge(1), &edge(2))],
            };
            let both = directions.iter().flat_map(|d| [d.clone(), negative(d)]);
            let tries: Vec<(IntVec, Vertex, IBig)> = both
                .map(|d| {
                    let (v, top) = self.support(&d);
                    (d, v, top)
                })
                .collect();
            // A body that ends at the origin touches; otherwise any direction enlarges the simplex.
            match tries.iter().find(|t| is_positive(&t.2)) {
                Some((_, v, _)) => simplex.push(v.clone()),
                None => return Err(tries[0].0.clone()),
            }
        }
        Ok(simplex.try_into().unwrap_or_else(|_| unreachable!("four vertices")))
    }

    /// EPA from weighted vertices whose sum is the origin.
    fn depth(&self, weights: Vec<(Vertex, IBig)>) -> Found {
        let touching = |normal, weights| Found {
            state: ContactState::Touching,
            squared: (IBig::ZERO, IBig::ONE),
            normal,
            weights,
            ties: 1,
        };
        let mut vertices = match self.tetrahedron(weights.iter().map(|w| w.0.clone()).collect()) {
            Ok(four) => Vec::from(four),
            Err(normal) => return touching(normal, weights),
        };
        let corners = [0, 1, 2, 3].map(|k: usize| vertices[k].p.clone());
        let scale = vertices.iter().map(|v| bits(&v.p)).max().expect("four vertices") as i64;
        let mut polytope = Polytope::new(corners);
        let mut heap = BinaryHeap::new();
        let key = |p: &Polytope, f: usize| Reverse((near_offset(p, f, scale).to_bits(), f));
        heap.extend((0..4).map(|f| key(&polytope, f)));
        // The nearest supporting facets so far, with the square of their offset as a fraction.
        let mut best: Option<(f64, IBig, IBig, Vec<usize>)> = None;
        while let Some(Reverse((near, f))) = heap.pop() {
            let near = f64::from_bits(near);
            if best.as_ref().is_some_and(|b| near > b.0 * (1.0 + 1e-12)) {
                break;
            }
            let facet = &polytope.facets[f];
            if !facet.is_alive {
                continue;
            }
            let square = (&facet.offset * &facet.offset, dot(&facet.normal, &facet.normal));
            let order = best
                .as_ref()
                .map(|(_, num, den, _)| (&square.0 * den).cmp(&(num * &square.1)));
            if order == Some(std::cmp::Ordering::Greater) {
                continue;
            }
            let (vertex, top) = self.support(&facet.normal);
            if top > facet.offset {
                vertices.push(vertex.clone());
                let new = polytope.add(vertex.p, f);
                heap.extend(new.map(|f| key(&polytope, f)));
            } else if let (Some(std::cmp::Ordering::Equal), Some(b)) = (order, &mut best) {
                b.3.push(f);
            } else {
                best = Some((near, square.0, square.1, vec![f]));
            }
        }
        let (_, num, den, tied) = best.expect("a polytope has a nearest facet");
        let facet = |f: usize| &polytope.facets[f];
        let normal = facet(tied[0]).normal.clone();
        if num.is_zero() {
            return touching(normal, weights);
        }
        let mut planes: Vec<usize> = Vec::new();
        for &f in &tied {
            if planes.iter().all(|&g| {
                !is_zero(&cross(&facet(f).normal, &facet(g).normal))
                    || dot(&facet(f).normal, &facet(g).normal).is_negative()
            }) {
                planes.push(f);
            }
        }
        let weights = polytope.coplanar(tied[0]).into_iter().find_map(|f| {
            let v = facet(f).vertices;
            let [p, q, r] = v.map(|k| &polytope.points[k]);
            let w = [cross(q, r), cross(r, p), cross(p, q)].map(|c| dot(&facet(f).normal, &c));
            let pairs = v.map(|k| vertices[k].clone()).into_iter().zip(w.clone());
            w.iter().all(|x| !x.is_negative()).then(|| pairs.collect())
        });
        Found {
            state: ContactState::Overlapping,
            squared: (num, den),
            normal,
            weights: weights.expect("the nearest point is in the nearest facet"),
            ties: planes.len() as u64,
        }
    }
}

/// Returns the distance of a facet's plane from the origin, in `f64`, in units of `2^scale`.
fn near_offset(p: &Polytope, f: usize, scale: i64) -> f64 {
    let facet = &p.facets[f];
    let (of_normal, of_offset) = (bits(&facet.normal), facet.offset.bit_len());
    let offset = image(&[facet.offset.clone(), IBig::ZERO, IBig::ZERO], of_offset)[0];
    let exponent = |bits: usize| bits.max(62) as i64;
    let power = exponent(of_offset) - exponent(of_normal) - scale;
    (offset / norm(image(&facet.normal, of_normal))).max(0.0) * 2f64.powi(power.clamp(-1000, 1000) as i32)
}

/// The nearest point of a simplex to the origin.
struct Nearest {
    /// The least face that contains it, with positive weights.
    weights: Vec<(Vertex, IBig)>,
    /// Its direction from the origin; zero if it is the origin.
    direction: IntVec,
}

/// Returns the nearest point of a simplex of one to four vertices, by trying its faces.
fn nearest(simplex: &[Vertex]) -> Nearest {
    let m = simplex.len();
    let supports = |face: &[usize], n: &IntVec| {
        let height = dot(n, &simplex[face[0]].p);
        is_zero(n) || (0..m).all(|k| face.contains(&k) || dot(n, &simplex[k].p) >= height)
    };
    for size in 1..=m {
        for face in subsets(m, size) {
            let p: Vec<&IntVec> = face.iter().map(|&k| &simplex[k].p).collect();
            let Some((weights, direction)) = foot(&p) else { continue };
            if weights.iter().all(is_positive) && supports(&face, &direction) {
                let vertices = face.iter().map(|&k| simplex[k].clone());
                return Nearest {
                    weights: vertices.zip(weights).collect(),
                    direction,
                };
            }
        }
    }
    unreachable!("a simplex has a nearest point")
}

/// Returns the ascending lists of `size` numbers below `m`.
fn subsets(m: usize, size: usize) -> Vec<Vec<usize>> {
    let picked = |mask: &u32| mask.count_ones() as usize == size;
    let list = |mask: u32| (0..m).filter(|k| mask >> k & 1 == 1).collect();
    (0..1u32 << m).filter(picked).map(list).collect()
}

/// Returns weights of the vertices of a face at the point of its plane nearest to the origin, and
/// the direction of that point; `None` if the vertices span less.
fn foot(p: &[&IntVec]) -> Option<(Vec<IBig>, IntVec)> {
    Some(match *p {
        [a] => (vec![IBig::ONE], a.clone()),
        [a, b] => {
            let u = sub(b, a);
            let (of_a, of_b) = (dot(b, &u), -dot(a, &u));
            let point = std::array::from_fn(|k| &of_a * &a[k] + &of_b * &b[k]);
            (vec![of_a, of_b], point)
        }
        [a, b, c] => {
            let n = cross(&sub(b, a), &sub(c, a));
            let height = dot(&n, a);
            let weights = [cross(b, c), cross(c, a), cross(a, b)].map(|x| dot(&n, &x));
            let direction = if height.is_zero() {
                n.map(|_| IBig::ZERO)
            } else if is_positive(&height) {
                n
            } else {
                negative(&n)
            };
            (weights.into(), direction)
        }
        [a, b, c, d] => {
            let w = [
                dot(b, &cross(c, d)),
                -dot(a, &cross(c, d)),
                dot(a, &cross(b, d)),
                -dot(a, &cross(b, c)),
            ];
            let sum: IBig = w.iter().sum();
            let weights = if sum.is_negative() { w.map(|x| -x) } else { w };
            (weights.into(), std::array::from_fn(|_| IBig::ZERO))
        }
        _ => return None,
    })
}

fn negative(v: &IntVec) -> IntVec {
    v.each_ref().map(|x| -x)
}

/// Returns whether a number is positive: zero has a positive sign.
fn is_positive(x: &IBig) -> bool {
    *x > IBig::ZERO
}

fn is_zero(v: &IntVec) -> bool {
    v.iter().all(IBig::is_zero)
}

#[cfg(test)]
#[path = "minkowski_tests.rs"]
mod tests;

//! Lower bounds of the distance of two bodies over a cell.
//!
//! In the frame behind the first k joints, B moves by the joints after them and A by those before,
//! each a product of rotations and slides about the axes at the centre of the cell. With
//! `f = n . x` for a point x of a body, `z_i` the axis of joint i through `o_i`, and outer joints
//! first:
//!
//! - First derivative by joint i: `(n x z_i) . (x - o_i)`; for a slide `n . z_i`.
//! - Second derivative by i and a joint j that is not outer: `((n x z_i) x z_j) . (x - o_j)`; for a
//!   slide j other than i: `(n x z_i) . z_j`; for a slide i: 0.
//! - A derivative of any order whose innermost joint is the turn j is at most the distance of x
//!   from the axis of j, because each further derivative is a product with a unit vector. For a
//!   slide it is at most 1, and 0 if a slide is further out or j occurs twice.
//!
//! All derivatives are affine in x, so the least over a convex body is at a vertex. Derivatives of
//! joints with the same coordinate are added before their absolute values are taken.

use core::ops::RangeInclusive;
use std::vec::Vec;

use nalgebra::{Isometry3, Point3, Vector3};

use super::body::Part;
use super::chain::{PosedChain, Screw};
use crate::extremes::Extremes;

/// An affine function of a point.
#[derive(Clone, Copy, Default)]
struct Affine(Vector3<f64>, f64);

impl Affine {
    fn at(&self, x: &Vector3<f64>) -> f64 {
        self.0.dot(x) + self.1
    }

    fn add(&mut self, other: &Self, factor: f64) {
        self.0 += other.0 * factor;
        self.1 += other.1 * factor;
    }
}

/// Scratch memory of bounds.
#[derive(Default)]
pub(super) struct Scratch {
    acting: Vec<Screw>,
    reaches: Vec<f64>,
    values: Vec<f64>,
    first: Vec<Affine>,
    second: Vec<Affine>,
}

/// A lower bound of the distance, and what its second-order remainder takes.
#[derive(Clone, Copy)]
pub(super) struct GapBound {
    pub(super) gap: f64,
    pub(super) remainder: f64,
}

/// Returns an upper bound of the way of a point at distance 1 from the axis of a joint.
fn chord(half: f64) -> f64 {
    if half >= core::f64::consts::PI {
        2.0
    } else {
        2.0 * libm::sin(0.5 * half) * (1.0 + 8.0 * f64::EPSILON)
    }
}

/// Writes upper bounds of the distance of all points of a ball from each axis over the cell, outer
/// joints first, and returns an upper bound of how far a point moves.
fn reaches(centre: &Vector3<f64>, radius: f64, acting: &[Screw], side: usize, reaches: &mut Vec<f64>) -> f64 {
    reaches.clear();
    reaches.resize(acting.len(), 1.0);
    let mut moved = 0.0;
    for (screw, reach) in acting.iter().zip(reaches.iter_mut()).rev() {
        if screw.is_turn {
            let now = screw.axis.cross(&(centre - screw.origin)).norm() + radius;
            *reach = (now + moved).smaller(screw.reach[side]);
            moved += *reach * chord(screw.half);
        } else {
            moved += screw.half;
        }
    }
    moved
}

/// Writes the joints that move a body against the frame behind the first `frame` joints, outer
/// first. Side 0 is A, side 1 is B.
fn acting(chain: &PosedChain, frame: usize, side: usize, acting: &mut Vec<Screw>) {
    acting.clear();
    match side {
        0 => acting.extend(chain.screws[..frame].iter().rev().map(|screw| Screw {
            factor: -screw.factor,
            ..*screw
        })),
        _ => acting.extend(&chain.screws[frame..]),
    }
}

impl Scratch {
    /// Returns an upper bound of how far points of two balls move towards each other over the cell,
    /// in the best of some frames; writes the part of each coordinate.
    pub(super) fn moved(
        &mut self,
        chain: &PosedChain,
        frames: RangeInclusive<usize>,
        balls: [(Vector3<f64>, f64); 2],
        of_coordinates: &mut [f64],
    ) -> f64 {
        let mut best = f64::INFINITY;
        for frame in frames {
            let mut sum = 0.0;
            for (side, (centre, radius)) in balls.iter().enumerate() {
                acting(chain, frame, side, &mut self.acting);
                sum += reaches(centre, *radius, &self.acting, side, &mut self.reaches);
            }
            if sum < best {
                best = sum;
                of_coordinates.fill(0.0);
                for (side, (centre, radius)) in balls.iter().enumerate() {
                    acting(chain, frame, side, &mut self.acting);
                    reaches(centre, *radius, &self.acting, side, &mut self.reaches);
                    for (screw, reach) in self.acting.iter().zip(&self.reaches) {
                        let way = if screw.is_turn {
                            reach * chord(screw.half)
                        } else {
                            screw.half
                        };
                        of_coordinates[screw.place] += way;
                    }
                }
            }
        }
        best
    }

    /// Returns upper bounds of how far a point of the frame behind the first `frame` joints moves
    /// as A sees it, and as B sees it.
    pub(super) fn point_moved(&mut self, chain: &PosedChain, frame: usize, point: &Vector3<f64>) -> [f64; 2] {
        [0, 1].map(|side| {
            // Seen from a body, the joint next to the body is the outermost.
            acting(chain, frame, side, &mut self.acting);
            self.acting.reverse();
            for screw in &mut self.acting {
                screw.reach = [f64::INFINITY; 2];
            }
            reaches(point, 0.0, &self.acting, side, &mut self.reaches)
        })
    }

    /// Returns a lower bound of the distance of two parts along a normal, given at the centre of
    /// the cell and fixed to the frame behind the first `frame` joints.
    pub(super) fn gap(
        &mut self,
        chain: &PosedChain,
        parts: [&Part; 2],
        frame: usize,
        normal: &Vector3<f64>,
        half: &[f64],
        is_second: bool,
    ) -> GapBound {
        let poses = [Isometry3::identity(), chain.b];
        let mut found = GapBound {
            gap: 0.0,
            remainder: 0.0,
        };
        for (side, part) in parts.into_iter().enumerate() {
            acting(chain, frame, side, &mut self.acting);
            let n = if side == 0 { -normal } else { *normal };
            let of_side = self.support(part, &poses[side], &n, half, side, is_second);
            found.gap += of_side.gap;
            found.remainder += of_side.remainder;
        }
        found
    }

    /// Returns a lower bound of `n . x` over the points x of a part, moved by the acting joints.
    fn support(
        &mut self,
        part: &Part,
        pose: &Isometry3<f64>,
        n: &Vector3<f64>,
        half: &[f64],
        side: usize,
        is_second: bool,
    ) -> GapBound {
        let Self {
            acting,
            reaches: reach,
            values,
            first,
            second,
        } = self;
        let inverse = pose.rotation.inverse();
        let local = inverse * n;
        let height = Affine(local, n.dot(&pose.translation.vector));
        let count = half.len();
        first.clear();
        first.resize(count, Affine::default());
        for screw in acting.iter_mut() {
            screw.axis = inverse * screw.axis;
            screw.origin = inverse * (screw.origin - pose.translation.vector);
            first[screw.place].add(&derivative(&local, screw), screw.factor);
        }
        let points = &part.points;
        points.heights(&height.0, height.1, values);
        for (affine, &h) in first.iter().zip(half) {
            if h > 0.0 {
                points.lower_by(&affine.0, affine.1, h, values);
            }
        }
        let remainders = remainders(part, acting, side, reach);
        let least = values.iter().copied().fold(f64::INFINITY, f64::smaller);
        let mut gap = least - remainders[0];
        if is_second && !acting.is_empty() {
            second_derivatives(&local, acting, count, second);
            let mut best = f64::INFINITY;
            // The vertex of the least first-order bound comes first, so that few others are evaluated.
            let at = values.iter().position(|v| *v == least).unwrap_or(0);
            for k in core::iter::once(at).chain(0..values.len()) {
                if !(values[k] - remainders[0] < best) {
                    continue;
                }
                let x = points.get(k);
                let of_vertex = quadratic(&height, first, second, half, &x) - remainders[1];
                best = best.smaller(of_vertex.larger(values[k] - remainders[0]));
            }
            gap = best;
        }
        GapBound {
            gap: gap - part.radius,
            remainder: remainders[0],
        }
    }
}

/// Returns the derivative of `n . x` by a joint.
fn derivative(n: &Vector3<f64>, screw: &Screw) -> Affine {
    if screw.is_turn {
        let w = n.cross(&screw.axis);
        Affine(w, -w.dot(&screw.origin))
    } else {
        Affine(Vector3::zeros(), n.dot(&screw.axis))
    }
}

/// Writes the second derivatives by each two coordinates: those of the same coordinate as such,
/// those of two coordinates at both places.
fn second_derivatives(n: &Vector3<f64>, acting: &[Screw], count: usize, second: &mut Vec<Affine>) {
    second.clear();
    second.resize(count * count, Affine::default());
    for (i, outer) in acting.iter().enumerate().filter(|(_, screw)| screw.is_turn) {
        let w = n.cross(&outer.axis);
        for (j, inner) in acting.iter().enumerate().skip(i) {
            let of_pair = derivative(&w, inner);
            let factor = outer.factor * inner.factor;
            let (c, e) = (outer.place, inner.place);
            match (i == j, c == e) {
                (true, _) => second[c * count + c].add(&of_pair, factor),
                (false, true) => second[c * count + c].add(&of_pair, 2.0 * factor),
                (false, false) => {
                    second[c * count + e].add(&of_pair, factor);
                    second[e * count + c].add(&of_pair, factor);
                }
            }
        }
    }
}

/// Returns a lower bound of the polynomial of second degree of a vertex over the cell.
fn quadratic(height: &Affine, first: &[Affine], second: &[Affine], half: &[f64], x: &Vector3<f64>) -> f64 {
    let count = half.len();
    let mut value = height.at(x);
    for c in 0..count {
        let h = half[c];
        if !(h > 0.0) {
            continue;
        }
        let slope = first[c].at(x).abs();
        let bend = second[c * count + c].at(x);
        value -= if bend > 0.0 && slope < bend * h {
            0.5 * slope * slope / bend
        } else {
            slope * h - 0.5 * bend * h * h
        };
        for e in c + 1..count {
            value -= second[c * count + e].at(x).abs() * h * half[e];
        }
    }
    value
}

/// Returns upper bounds of the remainders of second and of third order. The joints are in the frame
/// of the part.
fn remainders(part: &Part, acting: &[Screw], side: usize, reach: &mut Vec<f64>) -> [f64; 2] {
    let (centre, radius): (Point3<f64>, f64) = part.ball;
    reaches(&centre.coords, radius, acting, side, reach);
    let (mut sum, mut second, mut third) = (0.0, 0.0, 0.0);
    for (screw, reach) in acting.iter().zip(reach.iter()) {
        let h = screw.half;
        if screw.is_turn {
            let next = sum + h;
            second += 0.5 * reach * (next * next - sum * sum);
            third += reach * (next * next * next - sum * sum * sum) / 6.0;
            sum = next;
        } else {
            second += h * sum;
            third += 0.5 * h * sum * sum;
        }
    }
    [second, third]
}

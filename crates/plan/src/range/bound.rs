//! Lower bounds of the distance of two bodies over a cell.
//!
//! In the frame behind the first k joints, B moves by the joints after them and A by those before,
//! each a product of rotations and slides about the axes at the centre of the cell. The joints next
//! to a body are swept: each point x of the body stays in a ball around an affine function of x.
//!
//! - A rotation about the axis z through o by up to h takes a ball to balls around an arc. Let p be
//!   the foot of its centre c on the axis. The ball around `p + cos h (c - p)` whose radius is larger
//!   by `|c - p| sin h` contains them; from a quarter turn on, the ball around p does.
//! - A slide adds its half-width to the radius.
//!
//! The other joints are bounded by derivatives. With `f = n . x` for the centre x of such a ball,
//! `z_i` the axis of joint i through `o_i`, and outer joints first:
//!
//! - First derivative by joint i: `(n x z_i) . (x - o_i)`; for a slide `n . z_i`.
//! - Second derivative by i and a joint j that is not outer: `((n x z_i) x z_j) . (x - o_j)`; for a
//!   slide j other than i: `(n x z_i) . z_j`; for a slide i: 0.
//! - A derivative of any order whose innermost joint is the turn j is at most the distance of x
//!   from the axis of j, because each further derivative is a product with a unit vector. For a
//!   slide it is at most 1, and 0 if a slide is further out or j occurs twice.
//!
//! All derivatives are affine in x, so the least over a convex body is at a vertex. Derivatives of
//! joints with the same coordinate are added before their absolute values are taken. Wide cells are
//! proven by sweeps, which lose the same for each joint, however many there are; narrow ones by
//! derivatives, which know the direction.
//!
//! A product of rotations moves x by at most the sum of what each of them alone moves x, because the
//! outer rotations keep distances.

use core::ops::RangeInclusive;
use std::vec::Vec;

use nalgebra::{Isometry3, Matrix3, Vector3};

use super::chain::{PosedChain, Screw};
use crate::cell::range_body::{Part, Points};
use crate::extremes::Extremes;

/// An affine function of a point.
#[derive(Clone, Copy, Default, PartialEq)]
struct Affine(Vector3<f64>, f64);

impl Affine {
    fn at(&self, x: &Vector3<f64>) -> f64 {
        self.0.dot(x) + self.1
    }

    fn add(&mut self, other: &Self, factor: f64) {
        self.0 += other.0 * factor;
        self.1 += other.1 * factor;
    }

    /// Returns this function of the centre of the ball in which a point stays, as one of the point.
    fn after(&self, sweep: &Sweep) -> Self {
        Self(sweep.matrix.tr_mul(&self.0), self.0.dot(&sweep.offset) + self.1)
    }
}

/// Weights of the losses by which a joint is swept or bounded by derivatives: of the radius of a
/// body if it is swept, and of the first derivative. They change the time, not the answer.
const OF_RADIUS: f64 = 0.7;
const OF_FIRST: f64 = 0.4;

/// The balls in which the points of a part stay over a cell, moved by the joints next to it.
#[derive(Default)]
struct Sweep {
    /// The centre of the ball of x is `matrix x + offset`.
    matrix: Matrix3<f64>,
    offset: Vector3<f64>,
    /// The radius of the ball of each point.
    radii: Vec<f64>,
}

/// A part of a body over a cell, and the joints that may move it.
#[derive(Default)]
struct Side {
    /// The pose of the part in the frame of A.
    pose: Isometry3<f64>,
    /// The joints in the frame of the part, the one next to the part first.
    screws: Vec<Screw>,
    /// The centre of the ball of the part after each number of swept joints.
    centres: Vec<Vector3<f64>>,
    /// The balls of the points, and of few of them, after one swept joint and more.
    sweeps: [Sweeps; 2],
}

/// The balls of points after one swept joint and more, as far as they are known.
#[derive(Default)]
struct Sweeps {
    all: Vec<Sweep>,
    known: usize,
}

/// Scratch memory of bounds.
#[derive(Default)]
pub(super) struct Scratch {
    sides: [Side; 2],
    ways: Vec<[f64; 2]>,
    balls: Vec<(Vector3<f64>, f64)>,
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

impl Screw {
    /// Returns the distance of a point from the axis.
    fn distance(&self, point: &Vector3<f64>) -> f64 {
        self.axis.cross(&(point - self.origin)).norm()
    }

    /// Returns an upper bound of how far the joint alone moves the points of a ball that are no
    /// farther from the axis than `reach`.
    fn way(&self, centre: &Vector3<f64>, radius: f64, reach: f64) -> f64 {
        if self.is_turn {
            (self.distance(centre) + radius).smaller(reach) * self.chord
        } else {
            self.half
        }
    }

    /// Returns the centre and the growth of the ball around a ball that the joint moves.
    fn sweep(&self, centre: &Vector3<f64>) -> (Vector3<f64>, f64) {
        if !self.is_turn {
            return (*centre, self.half);
        }
        let along = self.axis * self.axis.dot(&(centre - self.origin));
        let foot = self.origin + along;
        (foot + (centre - foot) * self.cosine, self.distance(centre) * self.sine)
    }
}

impl Side {
    /// Takes the joints of a chain into the frame of a part, of A (0) or B (1).
    fn prepare(&mut self, chain: &PosedChain, part: &Part, side: usize) {
        self.pose = if side == 0 { Isometry3::identity() } else { chain.b };
        let inverse = self.pose.rotation.inverse();
        let (sign, pose) = (if side == 0 { -1.0 } else { 1.0 }, &self.pose);
        let local = |screw: &Screw| Screw {
            axis: inverse * screw.axis,
            origin: inverse * (screw.origin - pose.translation.vector),
            factor: sign * screw.factor,
            ..*screw
        };
        self.screws.clear();
        match side {
            0 => self.screws.extend(chain.screws.iter().map(local)),
            _ => self.screws.extend(chain.screws.iter().rev().map(local)),
        }
        self.sweeps.iter_mut().for_each(|sweeps| sweeps.known = 0);
        self.centres.clear();
        let mut centre = part.ball.0.coords;
        self.centres.push(centre);
        for screw in &self.screws {
            centre = screw.sweep(&centre).0;
            self.centres.push(centre);
        }
    }
}

impl Sweeps {
    /// Returns the balls of points after joints, the one next to the points first; `None` without.
    fn after(&mut self, screws: &[Screw], points: &Points) -> Option<&Sweep> {
        while self.known < screws.len() {
            let k = self.known;
            if self.all.len() == k {
                self.all.push(Sweep::default());
            }
            let (before, rest) = self.all.split_at_mut(k);
            let (sweep, screw) = (&mut rest[0], &screws[k]);
            match before.last() {
                Some(last) => {
                    (sweep.matrix, sweep.offset) = (last.matrix, last.offset);
                    sweep.radii.clone_from(&last.radii);
                }
                None => {
                    (sweep.matrix, sweep.offset) = (Matrix3::identity(), Vector3::zeros());
                    sweep.radii.clear();
                    sweep.radii.resize(points.len(), 0.0);
                }
            }
            if screw.is_turn {
                let cross = screw.axis.cross_matrix();
                let (matrix, offset) = (cross * sweep.matrix, cross * (sweep.offset - screw.origin));
                points.add_norms(&matrix, &offset, screw.sine, &mut sweep.radii);
                // The square of the cross product takes a vector to minus its part off the axis.
                sweep.matrix += cross * matrix * (1.0 - screw.cosine);
                sweep.offset += cross * offset * (1.0 - screw.cosine);
            } else {
                sweep.radii.iter_mut().for_each(|radius| *radius += screw.half);
            }
            self.known += 1;
        }
        screws.len().checked_sub(1).map(|last| &self.all[last])
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
        let way = |screw: &Screw, k: usize| screw.way(&balls[k].0, balls[k].1, screw.reach[k]);
        self.ways.clear();
        self.ways
            .extend(chain.screws.iter().map(|screw| [way(screw, 0), way(screw, 1)]));
        // The joints before a frame move A, the others B.
        let of = |frame: usize| {
            self.ways
                .iter()
                .enumerate()
                .map(move |(k, way)| way[usize::from(k >= frame)])
        };
        let mut best = (f64::INFINITY, 0);
        for frame in frames {
            let sum: f64 = of(frame).sum();
            if sum < best.0 {
                best = (sum, frame);
            }
        }
        of_coordinates.fill(0.0);
        for (screw, way) in chain.screws.iter().zip(of(best.1)) {
            of_coordinates[screw.place] += way;
        }
        best.0
    }

    /// Returns a lower bound of the distance of two balls over the cell, with the best frame and the
    /// vector between the balls there.
    pub(super) fn balls_apart(
        &mut self,
        chain: &PosedChain,
        [mut a, mut b]: [(Vector3<f64>, f64); 2],
    ) -> (f64, usize, Vector3<f64>) {
        let swept = |ball: &(Vector3<f64>, f64), screw: &Screw| {
            let (centre, growth) = screw.sweep(&ball.0);
            (centre, ball.1 + growth)
        };
        self.balls.clear();
        self.balls.push(b);
        for screw in chain.screws.iter().rev() {
            b = swept(&b, screw);
            self.balls.push(b);
        }
        let mut best = (f64::NEG_INFINITY, 0, Vector3::zeros());
        for (k, b) in self.balls.iter().rev().enumerate() {
            let between = b.0 - a.0;
            let bound = between.norm() - a.1 - b.1;
            if bound > best.0 {
                best = (bound, k, between);
            }
            if let Some(screw) = chain.screws.get(k) {
                a = swept(&a, screw);
            }
        }
        best
    }

    /// Returns upper bounds of how far a point of the frame behind the first `frame` joints moves
    /// as A sees it, and as B sees it.
    pub(super) fn point_moved(&self, chain: &PosedChain, frame: usize, point: &Vector3<f64>) -> [f64; 2] {
        let (of_a, of_b) = chain.screws.split_at(frame);
        [of_a, of_b].map(|screws| screws.iter().map(|s| s.way(point, 0.0, f64::INFINITY)).sum())
    }

    /// Takes the joints of a chain into the frames of two parts, for [`gap`](Self::gap).
    pub(super) fn prepare(&mut self, chain: &PosedChain, parts: [&Part; 2]) {
        for (k, side) in self.sides.iter_mut().enumerate() {
            side.prepare(chain, parts[k], k);
        }
    }

    /// Returns a lower bound of the distance of the two parts that were prepared along a normal,
    /// given at the centre of the cell and fixed to the frame behind the first `frame` joints. If
    /// few points stand for the parts, the bound is smaller, by at most [`Part::slack`] of each.
    pub(super) fn gap(
        &mut self,
        parts: [&Part; 2],
        is_coarse: bool,
        frame: usize,
        normal: &Vector3<f64>,
        half: &[f64],
        is_second: bool,
    ) -> GapBound {
        let mut found = GapBound {
            gap: 0.0,
            remainder: 0.0,
        };
        for (side, part) in parts.into_iter().enumerate() {
            let (n, count) = match side {
                0 => (-normal, frame),
                _ => (*normal, self.sides[1].screws.len() - frame),
            };
            let of_side = self.support(part, is_coarse, side, count, &n, half, is_second);
            found.gap += of_side.gap;
            found.remainder += of_side.remainder;
        }
        found
    }

    /// Returns a lower bound of `n . x` over the points x of a part, moved by the first `count`
    /// joints.
    #[allow(clippy::too_many_arguments)] // all of them differ from call to call
    fn support(
        &mut self,
        part: &Part,
        is_coarse: bool,
        side: usize,
        count: usize,
        n: &Vector3<f64>,
        half: &[f64],
        is_second: bool,
    ) -> GapBound {
        let Self {
            sides,
            reaches,
            values,
            first,
            second,
            ..
        } = self;
        let of = &mut sides[side];
        let (points, slack, sweeps) = match &part.coarse {
            Some((points, slack)) if is_coarse => (points, *slack, &mut of.sweeps[1]),
            _ => (&part.points, 0.0, &mut of.sweeps[0]),
        };
        let swept = swept(&of.screws[..count], &of.centres, part.ball.1);
        let local = of.pose.rotation.inverse() * n;
        let mut height = Affine(local, n.dot(&of.pose.translation.vector));
        let acting = &of.screws[swept..count];
        first.clear();
        first.resize(half.len(), Affine::default());
        for screw in acting {
            first[screw.place].add(&derivative(&local, screw), screw.factor);
        }
        let sweep = sweeps.after(&of.screws[..swept], points);
        if let Some(sweep) = sweep {
            height = height.after(sweep);
            first.iter_mut().for_each(|affine| *affine = affine.after(sweep));
        }
        points.heights(&height.0, height.1, values);
        if let Some(sweep) = sweep {
            values
                .iter_mut()
                .zip(&sweep.radii)
                .for_each(|(value, radius)| *value -= radius);
        }
        for (affine, &h) in first.iter().zip(half) {
            if h > 0.0 && *affine != Affine::default() {
                points.lower_by(&affine.0, affine.1, h, values);
            }
        }
        let remainders = remainders(part, &of.centres[swept], acting, side, reaches);
        let least = values.iter().copied().fold(f64::INFINITY, f64::smaller);
        let mut gap = least - remainders[0];
        if is_second && !acting.is_empty() {
            second_derivatives(&local, acting, half.len(), second);
            if let Some(sweep) = sweep {
                second.iter_mut().for_each(|affine| *affine = affine.after(sweep));
            }
            let mut best = f64::INFINITY;
            // The vertex of the least first-order bound comes first, so that few others are evaluated.
            let at = values.iter().position(|v| *v == least).unwrap_or(0);
            for k in core::iter::once(at).chain(0..values.len()) {
                if !(values[k] - remainders[0] < best) {
                    continue;
                }
                let radius = sweep.map_or(0.0, |sweep| sweep.radii[k]);
                let x = points.get(k);
                let of_vertex = quadratic(&height, first, second, half, &x) - radius - remainders[1];
                best = best.smaller(of_vertex.larger(values[k] - remainders[0]));
            }
            gap = best;
        }
        GapBound {
            gap: gap - slack - part.radius,
            remainder: remainders[0],
        }
    }
}

/// Returns how many joints to sweep, the one next to the part first, whose ball has a radius and, after
/// each number of swept joints, a centre.
fn swept(screws: &[Screw], centres: &[Vector3<f64>], radius: f64) -> usize {
    let turns = |screws: &[Screw]| screws.iter().filter(|s| s.is_turn).map(|s| s.half).sum::<f64>();
    let mut outer = turns(screws);
    for (k, screw) in screws.iter().enumerate() {
        let (lost, most, others) = if screw.is_turn {
            let distance = screw.distance(&centres[k]);
            outer -= screw.half;
            let lost = (distance + OF_RADIUS * radius) * screw.sine;
            (lost, (distance + radius) * screw.half, outer + 0.5 * screw.half)
        } else {
            (screw.half, screw.half, outer)
        };
        let rest = others.smaller(0.25 * others + 0.5 * others * others);
        if !(lost < most * (OF_FIRST + rest)) {
            return k;
        }
    }
    screws.len()
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
        for (j, inner) in acting[..=i].iter().enumerate() {
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
/// of the part, and its ball is around `centre`.
fn remainders(part: &Part, centre: &Vector3<f64>, acting: &[Screw], side: usize, reaches: &mut Vec<f64>) -> [f64; 2] {
    let mut moved = 0.0;
    reaches.clear();
    reaches.extend(acting.iter().map(|screw| {
        let reach = (screw.distance(centre) + part.ball.1 + moved).smaller(screw.reach[side]);
        moved += screw.way(centre, part.ball.1, screw.reach[side]);
        reach
    }));
    let (mut sum, mut second, mut third) = (0.0, 0.0, 0.0);
    for (screw, reach) in acting.iter().zip(reaches.iter()).rev() {
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

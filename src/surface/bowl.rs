//! Separating quadrics: quadratic surfaces between two parts that no plane proves apart, such as
//! nested saddles or one surface in the hollow of another.
//!
//! Let n be a unit direction, S a symmetric form on the plane perpendicular to n, and
//! `g(x) = n . x - x . S x / 2`, with x relative to a contact point o. For a quadratic function
//! `g(b) - g(a) = grad g(m) . (b - a)`, where m is the midpoint of a and b, and
//!
//! `|grad g(m)| <= 1 + |S m|^2 / 2 <= 1 + |S a|^2 / 4 + |S b|^2 / 4`.
//!
//! So if for all points a of X and b of Y
//!
//! `[n . b - b . (S + T S^2 / 2) b / 2] - [n . a - a . (S - T S^2 / 2) a / 2] >= T`,
//!
//! no point of X is nearer to a point of Y than T. Each bracket is a polynomial of one part alone,
//! of twice the degrees of the part. It is bounded in the same manner as a height along n
//! ([`highest`](super::height)). Near the closest points X lies below and Y above the graph of S if
//! S is between their curvatures. If a closest point is at a border, only the curvature along the
//! border matters.

use nalgebra::{Matrix2, Vector2, Vector3};

use super::bezier::{NET, ORDER};
use super::gap::NetFrame;
use super::height::bounded;
use super::net::SurfaceJet;
use super::tree::{Net, Node};
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{BENT, ROUND_UP, SLOPE};

/// Margin between a separating quadric and the curvature of a surface, as a fraction of the
/// curvature. It applies in directions in which the other surface falls away from its border.
const MARGIN: f64 = 1.0 / 4.0;

/// Sine of the angle between two borders below which they count as parallel.
const CROSSING: f64 = 1.0 / 4.0;

/// A separating quadric: the function g.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bowl {
    n: Vector3<f64>,
    /// Unit vectors perpendicular to n and to each other.
    e: [Vector3<f64>; 2],
    /// The contact point o, in A's frame.
    at: Vector3<f64>,
    /// The form S.
    form: Matrix2<f64>,
    /// Upper bound of the norm of S.
    length: f64,
}

/// A quadric in the frame of one body: the height of x is `n . x + x . M x / 2`, relative to `at`.
pub(super) struct BowlSide {
    n: Vector3<f64>,
    e: [Vector3<f64>; 2],
    at: Vector3<f64>,
    form: Matrix2<f64>,
    length: f64,
}

/// Returns two unit vectors perpendicular to a unit vector and to each other.
fn tangents(n: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let mut axis = Vector3::zeros();
    axis[n.iamin()] = 1.0;
    let e = n.cross(&axis);
    let e = e / sqrt(e.norm_squared());
    [e, n.cross(&e)]
}

/// Returns the curvature of a surface as a form on the plane of `e`.
fn curvature(jet: &SurfaceJet, n: &Vector3<f64>, e: &[Vector3<f64>; 2]) -> Option<Matrix2<f64>> {
    let [d, f] = e;
    let tangents = Matrix2::new(d.dot(&jet.u), d.dot(&jet.v), f.dot(&jet.u), f.dot(&jet.v));
    let inverse = tangents.try_inverse()?;
    let (uu, uv, vv) = (n.dot(&jet.uu), n.dot(&jet.uv), n.dot(&jet.vv));
    Some(inverse.transpose() * Matrix2::new(uu, uv, uv, vv) * inverse)
}

/// Directions at a contact point along which the height of a surface is stationary, and the
/// curvature along them. Across a border the height falls to first order, for any curvature.
#[derive(Clone, Copy)]
enum Rim {
    /// Inside a patch: all directions.
    All(Matrix2<f64>),
    /// At a border: along a unit vector of the plane, with a curvature.
    Along(Vector2<f64>, f64),
    /// At a corner: no direction.
    Point,
}

impl Rim {
    fn new(jet: &SurfaceJet, is_at_border: [bool; 2], n: &Vector3<f64>, e: &[Vector3<f64>; 2]) -> Option<Self> {
        let (side, bend) = match is_at_border {
            [false, false] => return curvature(jet, n, e).map(Self::All),
            [true, true] => return Some(Self::Point),
            [true, false] => (jet.v, n.dot(&jet.vv)),
            [false, true] => (jet.u, n.dot(&jet.uu)),
        };
        let f = Vector2::new(e[0].dot(&side), e[1].dot(&side));
        let square = f.norm_squared();
        // A border of length zero, as at a pole, is equivalent to a corner.
        Some(if square > 0.0 {
            Self::Along(f / sqrt(square), bend / square)
        } else {
            Self::Point
        })
    }

    /// Returns the same for the opposite normal.
    fn turned(self) -> Self {
        match self {
            Self::All(form) => Self::All(-form),
            Self::Along(f, bend) => Self::Along(f, -bend),
            Self::Point => Self::Point,
        }
    }
}

/// Returns a form between a surface of curvature `below` and the surface above it. The contact
/// point is inside a patch of the lower surface and at a border (`rim`) of the upper surface.
fn above(below: Matrix2<f64>, rim: &Rim) -> Matrix2<f64> {
    let across = MARGIN * sqrt(below.norm_squared());
    match rim {
        Rim::Along(f, bend) => {
            let half = 0.5 * (bend - f.dot(&(below * f))).at_least(0.0);
            below + Matrix2::identity() * across + f * f.transpose() * (half - across)
        }
        _ => below + Matrix2::identity() * across,
    }
}

/// Returns a form between a lower border with curvature `low` along f and an upper border with
/// curvature `high` along g.
fn between_borders([f, g]: [Vector2<f64>; 2], [low, high]: [f64; 2]) -> Matrix2<f64> {
    let cross = f.perp(&g);
    if cross.abs() < CROSSING {
        return f * f.transpose() * (0.5 * (low + high));
    }
    // A form can have any two curvatures along two directions. Both get a margin.
    let margin = MARGIN * (low.abs() + high.abs());
    let (p, q) = (Vector2::new(g.y, -g.x) / cross, Vector2::new(-f.y, f.x) / cross);
    p * p.transpose() * (low + margin) + q * q.transpose() * (high - margin)
}

impl Bowl {
    /// Returns a quadric between two surfaces at a pair of close points that are `distance` apart.
    /// Its form is half-way between the curvatures, along the directions in which both heights are
    /// stationary. `is_at_border` is for u and v of A and of B.
    pub(super) fn between(
        [a, b]: [&SurfaceJet; 2],
        n: &Vector3<f64>,
        distance: f64,
        [u, v, s, t]: [bool; 4],
        frame: &NetFrame,
    ) -> Option<Self> {
        let e = tangents(n);
        let form = match (Rim::new(a, [u, v], n, &e)?, Rim::new(b, [s, t], n, &e)?) {
            (Rim::All(of_a), Rim::All(of_b)) => (of_a + of_b) * 0.5,
            (Rim::All(of_a), rim) => above(of_a + of_a * of_a * distance, &rim),
            (rim, Rim::All(of_b)) => -above(of_b * of_b * distance - of_b, &rim.turned()),
            (Rim::Along(f, low), Rim::Along(g, high)) => between_borders([f, g], [low, high]),
            (Rim::Along(f, low), Rim::Point) => f * f.transpose() * (low + MARGIN * low.abs()),
            (Rim::Point, Rim::Along(g, high)) => g * g.transpose() * (high - MARGIN * high.abs()),
            (Rim::Point, Rim::Point) => return None,
        };
        let length = sqrt(form.norm_squared()) * ROUND_UP;
        let is_of_use = length > 0.0 && length * frame.size < f64::INFINITY;
        is_of_use.then_some(Self {
            n: *n,
            e,
            at: a.point,
            form,
            length,
        })
    }

    /// Returns the quadric as A uses it, for a target T.
    pub(super) fn of_a(&self, target: f64) -> BowlSide {
        BowlSide {
            n: self.n,
            e: self.e,
            at: self.at,
            form: self.form * self.form * (0.5 * target) - self.form,
            length: self.length * (1.0 + target * self.length),
        }
    }

    /// Returns the quadric as B uses it, for a target T, in B's frame.
    pub(super) fn of_b(&self, target: f64, frame: &NetFrame) -> BowlSide {
        BowlSide {
            n: -frame.direction_in_b(&self.n),
            e: self.e.each(|e| frame.direction_in_b(&e)),
            at: frame.rotation.tr_mul(&(self.at - frame.translation)),
            form: self.form * self.form * (0.5 * target) + self.form,
            length: self.length * (1.0 + target * self.length),
        }
    }
}

impl BowlSide {
    /// Returns whether the height of a node is worth computing. The centre of the node must be
    /// within twice its radius of the line along n through the contact point. The slope must be at
    /// most [`SLOPE`], so that errors of points grow little.
    pub(super) fn is_near(&self, node: &Node) -> bool {
        !node.is_group() && self.off(node) <= 2.0 * node.radius && self.slope(node) <= SLOPE
    }

    /// Returns the distance of a node's centre from the line along n.
    fn off(&self, node: &Node) -> f64 {
        let x = node.centre - self.at;
        let [s, t] = self.e.each(|e| e.dot(&x));
        sqrt(s * s + t * t)
    }

    /// Returns a bound of the gradient of the quadratic part over a node.
    fn slope(&self, node: &Node) -> f64 {
        self.length * (self.off(node) + node.radius)
    }

    /// Returns the greatest height of the corners of a node: a height that the surface attains.
    pub(super) fn least(&self, node: &Node, net: &Net) -> f64 {
        let [p, q] = node.degrees;
        let last = p * (q + 1);
        let height = |k: usize| {
            let x = net.point(k) - self.at;
            let s = Vector2::new(self.e[0].dot(&x), self.e[1].dot(&x));
            self.n.dot(&x) + 0.5 * s.dot(&(self.form * s))
        };
        let [a, b, c, d] = [0, q, last, last + q].each(height);
        a.larger(b).larger(c.larger(d))
    }

    /// Returns an upper bound of the heights of the surface in a node, without the errors of the
    /// pose; `None` for a degree above three.
    pub(super) fn highest(&self, node: &Node, net: &Net) -> Option<f64> {
        let [p, q] = node.degrees;
        if 2 * p >= ORDER || 2 * q >= ORDER {
            return None;
        }
        let mut room = [[0.0; 2]; NET];
        let degrees = [2 * p, 2 * q];
        let pairs = &mut room[..(2 * p + 1) * (2 * q + 1)];
        self.fill(pairs, node.degrees, net);
        let height = |p: &[f64; 2]| p[0] / p[1];
        let mut start = 0;
        for k in 1..pairs.len() {
            if height(&pairs[k]) > height(&pairs[start]) {
                start = k;
            }
        }
        let most = height(&pairs[start]);
        let of = bounded(pairs, degrees, start, most, f64::INFINITY)?;
        let slope = self.slope(node);
        let rounding = BENT * slope.at_least(1.0) * (node.reach + self.at.abs().sum());
        Some(of.smaller(most) + (1.0 + slope) * node.error + rounding)
    }

    /// Writes the coefficients of the numerator and the denominator of the height.
    fn fill(&self, pairs: &mut [[f64; 2]], [p, q]: [usize; 2], net: &Net) {
        let count = (p + 1) * (q + 1);
        // Rows, each times binomials: height along n, two tangent coordinates, their images under
        // half the form, weight.
        let mut of = [[0.0; FEW]; 6];
        let (planes, weights) = match net.homogeneous {
            Some([x, y, z, w]) => ([x, y, z], Some(w)),
            None => (net.points, None),
        };
        for k in 0..count {
            let w = weights.map_or(1.0, |w| w[k]);
            let x = Vector3::new(planes[0][k], planes[1][k], planes[2][k]) - self.at * w;
            let (s, t) = (self.e[0].dot(&x), self.e[1].dot(&x));
            let m = &self.form;
            let scale = BINOMIAL[p][k / (q + 1)] * BINOMIAL[q][k % (q + 1)];
            let row = [
                self.n.dot(&x),
                s,
                t,
                0.5 * (m[(0, 0)] * s + m[(0, 1)] * t),
                0.5 * (m[(1, 0)] * s + m[(1, 1)] * t),
                w,
            ];
            (0..6).for_each(|i| of[i][k] = scale * row[i]);
        }
        let [height, s, t, of_s, of_t, w] = &of;
        for i in 0..count {
            let (row, column) = (i / (q + 1), i % (q + 1));
            for j in 0..count {
                let k = (row + j / (q + 1)) * (2 * q + 1) + column + j % (q + 1);
                pairs[k][0] += height[i] * w[j] + s[i] * of_s[j] + t[i] * of_t[j];
                pairs[k][1] += w[i] * w[j];
            }
        }
        for (k, pair) in pairs.iter_mut().enumerate() {
            let scale = BINOMIAL[2 * p][k / (2 * q + 1)] * BINOMIAL[2 * q][k % (2 * q + 1)];
            *pair = pair.each(|x| x / scale);
        }
    }
}

/// Largest number of control points of a patch of degrees up to three.
const FEW: usize = 16;

/// Binomial coefficients.
const BINOMIAL: [[f64; ORDER]; ORDER] = {
    let mut rows = [[0.0; ORDER]; ORDER];
    let mut n = 0;
    while n < ORDER {
        rows[n][0] = 1.0;
        let mut k = 1;
        while k <= n {
            rows[n][k] = rows[n - 1][k - 1] + if k < n { rows[n - 1][k] } else { 0.0 };
            k += 1;
        }
        n += 1;
    }
    rows
};

#[cfg(test)]
mod tests {
    //! Separating quadrics against heights in double-double, and with surfaces that are closer than
    //! they seem.

    use alloc::vec;
    use alloc::vec::Vec;
    use nalgebra::{Isometry3, Point3};

    use super::*;
    use crate::base::num::double_double::DoubleDouble as Wide;
    use crate::base::num::scalar::Scalar;
    use crate::base::pose::RelativePose;
    use crate::base::tolerance::UNIT;
    use crate::rng::Rng;
    use crate::surface::bezier_surface::BezierSurface;
    use crate::surface::closest::{Meeting, PatchPair};
    use crate::surface::gap::{SearchWork, Trees};
    use crate::surface::net::BezierPatch;
    use crate::surface::tree::{Grown, Nodes};

    /// Returns a value of a patch in double-double, from its stored numbers.
    fn exact(patch: &BezierPatch, at: [f64; 2]) -> [Wide; 4] {
        let curve = |mut c: Vec<[Wide; 4]>, t: f64| {
            let (t, s) = (Wide::from(t), Wide::from(1.0) - Wide::from(t));
            while c.len() > 1 {
                let mixed = |w: &[[Wide; 4]]| [0, 1, 2, 3].map(|k| w[0][k] * s + w[1][k] * t);
                c = c.windows(2).map(mixed).collect();
            }
            c[0]
        };
        let wide = |h: &[f64; 4]| h.map(Wide::from);
        let rows = patch.net.chunks(patch.degrees[1] + 1);
        curve(
            rows.map(|r| curve(r.iter().map(wide).collect(), at[1])).collect(),
            at[0],
        )
    }

    /// Returns the height of a point above a quadric, in double-double.
    fn height(half: &BowlSide, h: &[Wide; 4]) -> Wide {
        let x = [0, 1, 2].map(|k| h[k] / h[3] - Wide::from(half.at[k]));
        let dot = |n: &Vector3<f64>| (0..3).fold(Wide::from(0.0), |s, k| s + Wide::from(n[k]) * x[k]);
        let s = [dot(&half.e[0]), dot(&half.e[1])];
        let form = |i: usize, j: usize| Wide::from(0.5 * half.form[(i, j)]) * s[i] * s[j];
        dot(&half.n) + form(0, 0) + form(0, 1) + form(1, 0) + form(1, 1)
    }

    fn unit(rng: &mut Rng) -> Vector3<f64> {
        loop {
            let v = Vector3::from_fn(|_, _| rng.range(-1.0, 1.0));
            if v.norm_squared() > 0.1 && v.norm_squared() < 1.0 {
                return v / sqrt(v.norm_squared());
            }
        }
    }

    /// Returns a patch over a square of size 2 around `off`, mostly with weights.
    fn patch(rng: &mut Rng, off: &Vector3<f64>) -> BezierPatch {
        let [p, q] = [1 + rng.below(3), 1 + rng.below(3)];
        let at = |k: usize, d: usize| 2.0 * k as f64 / d as f64 - 1.0;
        let grid = (0..(p + 1) * (q + 1)).map(|k| [at(k / (q + 1), p), at(k % (q + 1), q)]);
        let points: Vec<Point3<f64>> = grid
            .map(|[x, y]| Point3::from(off + Vector3::new(x, y, rng.range(-0.4, 0.4))))
            .collect();
        let weights: Vec<f64> = points.iter().map(|_| rng.range(0.4, 2.0)).collect();
        if rng.chance(0.7) {
            BezierPatch::rational([p, q], &points, &weights).expect("a patch")
        } else {
            BezierPatch::polynomial([p, q], &points).expect("a patch")
        }
    }

    /// Returns by how much the bound of a random node above a random quadric exceeds the greatest
    /// height found on the patch, in units of the pair size.
    fn excess(rng: &mut Rng, far: f64) -> Option<f64> {
        let off = unit(rng) * far;
        let patch = patch(rng, &off);
        let surface = BezierSurface::new(vec![patch.clone()]).expect("a surface");
        let mut grown = Grown::default();
        let mut nodes = Nodes::new(&surface.tree, &mut grown);
        let mut id = 0;
        for _ in 0..rng.below(14) {
            id = nodes.split(id) + rng.below(2) as u32;
        }
        let node = nodes.node(id);
        let [u, v] = node.domain();
        let inside = |rng: &mut Rng, [low, high]: [f64; 2]| low + (high - low) * rng.uniform();
        let at = patch.point(inside(rng, u), inside(rng, v)).coords;
        let n = unit(rng);
        let (a, b, c) = (rng.range(-1.0, 1.0), rng.range(-1.0, 1.0), rng.range(-1.0, 1.0));
        // From a negligible form to the steepest that `is_near` accepts.
        let form = Matrix2::new(a, b, b, c) * rng.log_range(0.1, 6.0);
        let length = sqrt(form.norm_squared()) * ROUND_UP;
        let half = BowlSide {
            n,
            e: tangents(&n),
            at,
            form,
            length,
        };
        if !half.is_near(node) {
            return None;
        }
        let bound = half.highest(node, &nodes.net(id))?;
        // The best point of a grid, then of ever smaller steps around it.
        let at = |[x, y]: [f64; 2]| [u[0] + (u[1] - u[0]) * x, v[0] + (v[1] - v[0]) * y];
        let of = |p: [f64; 2]| height(&half, &exact(&patch, at(p)));
        let (mut best, mut place) = (of([0.0; 2]), [0.0; 2]);
        let mut step = 0.25;
        let mut around: Vec<[f64; 2]> = (0..25)
            .map(|k| [0.25 * (k / 5) as f64, 0.25 * (k % 5) as f64])
            .collect();
        while step > 1e-8 {
            let before = place;
            for p in around {
                let h = of(p);
                if (h - best).value() > 0.0 {
                    (best, place) = (h, p);
                }
            }
            if place == before {
                step *= 0.25;
            }
            let moved = |x: f64, d: f64| (x + d * step).clamp(0.0, 1.0);
            let eight = [-1.0, 0.0, 1.0]
                .into_iter()
                .flat_map(|d| [-1.0, 0.0, 1.0].map(|f| [d, f]));
            around = eight.map(|[d, f]| [moved(place[0], d), moved(place[1], f)]).collect();
        }
        Some((Wide::from(bound) - best).value() / (1.0 + far))
    }

    /// Bounds hold to the last bit, near the origin and far from it. Enough of them are tight that
    /// bounds lower by 1e-9 of the size would fail.
    #[test]
    fn heights_above_a_bowl_hold() {
        for far in [0.0, 10.0, 1e6] {
            let (mut tight, mut least) = (0, f64::INFINITY);
            for k in 0..600 {
                let Some(over) = excess(&mut Rng::of_case(71, k), far) else {
                    continue;
                };
                least = least.min(over);
                assert!(over >= 0.0, "case {k}, {far} off: the bound is {over:e} too low");
                tight += u32::from(over < 4096.0 * UNIT);
            }
            assert!(tight > 40, "{tight} of all are tight at {far}");
        }
    }

    fn one(points: Vec<Point3<f64>>) -> BezierSurface {
        BezierSurface::new(vec![BezierPatch::polynomial([2, 2], &points).expect("a patch")]).expect("a surface")
    }

    /// Returns the surface of heights `bend (x^2 + y^2) / 2 + z` over a square.
    fn dish(size: f64, bend: f64, z: f64) -> BezierSurface {
        // The blossom of the square of a coordinate between -size and size.
        let square = |k: usize| [1.0, -1.0, 1.0][k] * size * size;
        let at = |k: usize| {
            let (i, j) = (k / 3, k % 3);
            let [x, y] = [i, j].map(|i| (i as f64 - 1.0) * size);
            Point3::new(x, y, 0.5 * bend * (square(i) + square(j)) + z)
        };
        one((0..9).map(at).collect())
    }

    fn meeting(a: &BezierSurface, b: &BezierSurface, frame: &NetFrame) -> Meeting {
        let pair = PatchPair {
            a: &a.patches[0],
            b: &b.patches[0],
            frame,
        };
        pair.descend([0, 0], [0.5; 4]).0
    }

    /// One dish lies in another and has a slightly smaller curvature than the surface parallel to
    /// the other, so the lowest points are not the closest. No form, of any curvature, proves the
    /// distance of the lowest points. The terms with the square of the form prevent it.
    #[test]
    fn a_bowl_knows_that_parallel_surfaces_bend_more() {
        let frame = NetFrame::new(
            [1.0, 1.0],
            0.0,
            &RelativePose::from_isometry(&Isometry3::identity()).expect("a pose"),
        )
        .expect("of a size");
        // The surface parallel to A at this distance has the curvature 1 / (2 - 0.5) = 0.667.
        let a = dish(0.2, 0.5, 0.0);
        for (bend, holds) in [(0.55, false), (0.62, false), (0.66, false), (0.8, true), (1.0, true)] {
            let b = dish(0.2, bend, 0.5);
            let mut found = 0;
            for k in 0..=20 {
                let n = Vector3::z();
                let form = Matrix2::identity() * (0.5 + (bend - 0.5) * f64::from(k) / 20.0);
                let length = sqrt(form.norm_squared()) * ROUND_UP;
                let bowl = Bowl {
                    n,
                    e: tangents(&n),
                    at: Vector3::zeros(),
                    form,
                    length,
                };
                let (mut of_a, mut of_b) = (Grown::default(), Grown::default());
                let mut trees = Trees {
                    a: Nodes::new(&a.tree, &mut of_a),
                    b: Nodes::new(&b.tree, &mut of_b),
                    frame: &frame,
                    counts: SearchWork::default(),
                };
                found += u32::from(trees.is_about([0, 0], &bowl, 0.5 - 1e-9));
                assert!(!trees.is_about([0, 0], &bowl, 0.5 + 1e-9), "{bend} {k}");
            }
            assert_eq!(found > 0, holds, "{bend}: {found}");
        }
    }

    /// The quadric of a search proves the distance of a dish in a wider dish, and no greater
    /// distance.
    #[test]
    fn a_bowl_proves_a_distance_and_no_more() {
        let mut rng = Rng::new(72);
        let mut proven = 0;
        for _ in 0..200 {
            let (a, b) = (
                dish(0.3, rng.range(-0.8, 0.8), 0.0),
                dish(0.3, rng.range(-0.8, 0.8), rng.range(0.05, 0.5)),
            );
            let turn = nalgebra::UnitQuaternion::from_scaled_axis(unit(&mut rng) * rng.range(0.0, 0.1));
            let shift = unit(&mut rng) * 0.03;
            let pose = RelativePose::from_isometry(&Isometry3::from_parts(shift.into(), turn)).expect("a pose");
            let frame = NetFrame::new([a.reach, b.reach], 0.0, &pose).expect("of a size");
            let found = meeting(&a, &b, &frame);
            let Some(bowl) = &found.bowl else { continue };
            let (mut of_a, mut of_b) = (Grown::default(), Grown::default());
            let mut trees = Trees {
                a: Nodes::new(&a.tree, &mut of_a),
                b: Nodes::new(&b.tree, &mut of_b),
                frame: &frame,
                counts: SearchWork::default(),
            };
            proven += u32::from(trees.is_about([0, 0], bowl, found.distance - 1e-9));
            assert!(!trees.is_about([0, 0], bowl, found.distance + 1e-12));
        }
        assert!(proven > 30, "{proven}");
    }
}

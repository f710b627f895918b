//! Upper bounds of the height of a node along a direction, and the interface of a body in a search
//! ([`NetSide`]).
//!
//! There are two bounds:
//!
//! 1. The greatest height of the control points, because their convex hull contains the patch.
//! 2. A second-order Taylor bound around the highest point of the node (the concavity cap).
//!
//! For the second bound let N be the homogeneous points, w the weights, and c the height at the
//! highest point found. The polynomial g has the coefficients `n . N - c w` and is positive exactly
//! where the height exceeds c. Second differences of its coefficients bound its second derivatives
//! over the node: `uu` and `vv` from above, `uv` in absolute value. So
//!
//! `g(p0 + d) <= g(p0) + grad g . d + (uu du^2 + vv dv^2 + 2 uv |du dv|) / 2`.
//!
//! If g is concave, the last term is not positive. If p0 is the highest point of the node, the
//! linear term is not positive anywhere in the node, even if p0 is on the border. Then the bound is
//! the height of a point, for any size of the node.
//!
//! Sources: Bernstein coefficients of derivatives: Farin 2002, section 5.3; the term for a lack of
//! concavity: Adjiman and Floudas 1996, alpha-BB.

use nalgebra::Vector3;

use super::bezier::{Jet, NET, jet};
use super::bowl::BowlSide;
use super::tree::{Net, Node, Nodes};
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::tolerance::{COEFFICIENT, CURVATURE, TAYLOR, UNIT};

/// Largest number of Newton steps for the highest point of a node.
const CLIMB: usize = 4;

impl Net<'_> {
    /// Returns the greatest height of the control points.
    #[inline]
    pub(super) fn highest(&self, n: &Vector3<f64>) -> f64 {
        let [x, y, z] = self.points;
        let (mut even, mut odd) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        let count = x.len();
        let (y, z) = (&y[..count], &z[..count]);
        let height = |k: usize| n.x * x[k] + n.y * y[k] + n.z * z[k];
        let mut k = 0;
        while k + 1 < count {
            let (h, g) = (height(k), height(k + 1));
            even = if h > even { h } else { even };
            odd = if g > odd { g } else { odd };
            k += 2;
        }
        if k < count {
            let h = height(k);
            even = if h > even { h } else { even };
        }
        if even > odd { even } else { odd }
    }

    /// Returns the index of the highest control point.
    #[inline]
    fn highest_index(&self, n: &Vector3<f64>) -> usize {
        let [x, y, z] = self.points;
        let (mut best, mut at) = (f64::NEG_INFINITY, 0);
        for k in 0..x.len() {
            let h = n.x * x[k] + n.y * y[k] + n.z * z[k];
            if h > best {
                (best, at) = (h, k);
            }
        }
        at
    }

    /// Returns the greatest height of the four corners, which lie on the surface.
    #[inline]
    fn highest_corner(&self, [p, q]: [usize; 2], n: &Vector3<f64>) -> f64 {
        let last = p * (q + 1);
        let heights = [0, q, last, last + q].each(|k| n.dot(&self.point(k)));
        heights[0].larger(heights[1]).larger(heights[2].larger(heights[3]))
    }

    #[inline]
    pub(super) fn point(&self, k: usize) -> Vector3<f64> {
        Vector3::new(self.points[0][k], self.points[1][k], self.points[2][k])
    }
}

/// Bounds of second derivatives: `uu` and `vv` from above, `uv` in absolute value.
#[derive(Clone, Copy)]
struct Curvature {
    uu: f64,
    vv: f64,
    uv: f64,
}

impl Curvature {
    fn new(g: &[[f64; 1]], [p, q]: [usize; 2], size: f64) -> Self {
        let width = q + 1;
        let (mut uu, mut vv, mut uv) = (f64::NEG_INFINITY, f64::NEG_INFINITY, 0.0_f64);
        for i in 0..p.saturating_sub(1) {
            for j in 0..=q {
                let k = i * width + j;
                uu = (g[k][0] - 2.0 * g[k + width][0] + g[k + 2 * width][0]).at_least(uu);
            }
        }
        for i in 0..=p {
            for j in 0..q.saturating_sub(1) {
                let k = i * width + j;
                vv = (g[k][0] - 2.0 * g[k + 1][0] + g[k + 2][0]).at_least(vv);
            }
        }
        for i in 0..p {
            for j in 0..q {
                let k = i * width + j;
                let (near, far) = (g[k + 1][0] - g[k][0], g[k + width + 1][0] - g[k + width][0]);
                uv = ((far - near).abs()).at_least(uv);
            }
        }
        let (p, q) = (p as f64, q as f64);
        let error = CURVATURE * (p + q) * (p + q) * size;
        let second = |x: f64, n: f64| if n > 1.0 { x * n * (n - 1.0) + error } else { error };
        Self {
            uu: second(uu, p),
            vv: second(vv, q),
            uv: uv * p * q + error,
        }
    }

    /// Returns three pairs of non-negative factors k and l, each with
    /// `uu du^2 + vv dv^2 + 2 uv |du dv| <= k du^2 + l dv^2`.
    fn excess(&self) -> [[f64; 2]; 3] {
        let Self { uu, vv, uv } = *self;
        let both = [(uu + uv).at_least(0.0), (vv + uv).at_least(0.0)];
        let square = uv * uv * (1.0 + 8.0 * UNIT);
        let of_v = [0.0, (vv + square / -uu).at_least(0.0)];
        let of_u = [(uu + square / -vv).at_least(0.0), 0.0];
        [
            both,
            if uu < 0.0 { of_v } else { both },
            if vv < 0.0 { of_u } else { both },
        ]
    }
}

/// Returns an upper bound of the height of a node by its second derivatives, without the error of
/// the node. `None` if the bound is unlikely to be below `highest`, the height of the net, by
/// `need`.
pub(super) fn taylor(node: &Node, net: &Net, n: &Vector3<f64>, highest: f64, need: f64) -> Option<f64> {
    let mut coefficients = [[0.0; 2]; NET];
    let pairs = &mut coefficients[..node.count as usize];
    fill(pairs, net, n);
    let most = bounded(pairs, node.degrees, net.highest_index(n), highest, need)?;
    Some(most + COEFFICIENT * node.reach)
}

/// Returns an upper bound of a quotient of two polynomials by second derivatives. The divisor is
/// positive. `pairs` are the coefficients of both, `start` is the control point where the search
/// starts. `None` if the bound is unlikely to be below the upper bound `highest` by `need`. Errors
/// of the coefficients are not included.
pub(super) fn bounded(pairs: &[[f64; 2]], degrees: [usize; 2], start: usize, highest: f64, need: f64) -> Option<f64> {
    let mut room = [[0.0]; NET];
    let g = &mut room[..pairs.len()];
    let size = shifted(pairs, highest, g);
    // At most half of an excess counts, and a split leaves a quarter of it.
    let excess = Curvature::new(g, degrees, size).excess();
    if !excess.iter().any(|[k, l]| 0.125 * (k + l) < need) {
        return None;
    }
    let (at, c) = climb(degrees, pairs, start);
    let size = shifted(pairs, c, g);
    let excess = Curvature::new(g, degrees, size).excess();
    let f = jet::<1>(g, degrees, at);
    let rise = |d: f64, k: f64, at: f64| {
        let to = |x: f64| x * (d + 0.5 * k * x);
        to(-at).larger(to(1.0 - at)).at_least(0.0)
    };
    let over = excess.each(|[k, l]| rise(f.u[0], k, at[0]) + rise(f.v[0], l, at[1]));
    let over = over[0].smaller(over[1]).smaller(over[2]);
    let degree = (degrees[0] + degrees[1]) as f64;
    let error = TAYLOR * degree * degree * size + 4.0 * UNIT * over;
    let least_weight = pairs.iter().map(|p| p[1]).fold(f64::INFINITY, f64::smaller);
    let most = (f.value[0].at_least(0.0) + over + error) / least_weight;
    Some(c + most * (1.0 + 4.0 * UNIT))
}

/// Writes the coefficients of `g` for a height c, and returns the largest absolute value.
#[inline(always)]
fn shifted(pairs: &[[f64; 2]], c: f64, g: &mut [[f64; 1]]) -> f64 {
    let mut size = 0.0_f64;
    for (g, [h, w]) in g.iter_mut().zip(pairs) {
        g[0] = h - c * w;
        size = size.larger(g[0].abs());
    }
    size
}

#[inline(always)]
fn fill(pairs: &mut [[f64; 2]], net: &Net, n: &Vector3<f64>) {
    let unit = net.points;
    let ([x, y, z], weights) = match net.homogeneous {
        Some([x, y, z, w]) => ([x, y, z], Some(w)),
        None => (unit, None),
    };
    for k in 0..pairs.len() {
        let h = n.x * x[k] + n.y * y[k] + n.z * z[k];
        pairs[k] = [h, weights.map_or(1.0, |w| w[k])];
    }
}

/// Returns the parameters and the height of a high point of the node, by Newton's method from a
/// control point.
fn climb(degrees: [usize; 2], pairs: &[[f64; 2]], start: usize) -> ([f64; 2], f64) {
    let [p, q] = degrees;
    let mut at = [(start / (q + 1)) as f64 / p as f64, (start % (q + 1)) as f64 / q as f64];
    let (mut c, mut f) = level(degrees, pairs, at);
    for _ in 0..CLIMB {
        let next = newton(at, &f);
        if next == at {
            break;
        }
        let (higher, g) = level(degrees, pairs, next);
        if !(higher > c) {
            break;
        }
        (at, c, f) = (next, higher, g);
    }
    (at, c)
}

/// Returns the height at a point, and the value and derivatives of `g` for this height.
#[inline(always)]
fn level(degrees: [usize; 2], pairs: &[[f64; 2]], at: [f64; 2]) -> (f64, Jet<1>) {
    let Jet {
        value,
        u,
        v,
        uu,
        uv,
        vv,
    } = jet::<2>(pairs, degrees, at);
    let c = value[0] / value[1];
    let of = |x: [f64; 2]| [x[0] - c * x[1]];
    let [value, u, v, uu, uv, vv] = [value, u, v, uu, uv, vv].each(of);
    (
        c,
        Jet {
            value,
            u,
            v,
            uu,
            uv,
            vv,
        },
    )
}

/// Returns the next parameters: by Newton's step if the height is concave, otherwise along the
/// gradient to the border. A parameter at the border stays there if the gradient points outward.
fn newton(at: [f64; 2], f: &Jet<1>) -> [f64; 2] {
    let (gradient, uv) = ([f.u[0], f.v[0]], f.uv[0]);
    let bend = [f.uu[0], f.vv[0]];
    let is_held = |k: usize| at[k] == 0.0 && gradient[k] <= 0.0 || at[k] == 1.0 && gradient[k] >= 0.0;
    let alone = |k: usize, slope: f64| {
        if bend[k] < 0.0 {
            (at[k] - slope / bend[k]).clamped(0.0, 1.0)
        } else if slope > 0.0 {
            1.0
        } else {
            0.0
        }
    };
    match (is_held(0), is_held(1)) {
        (true, true) => at,
        (true, false) => [at[0], alone(1, gradient[1])],
        (false, true) => [alone(0, gradient[0]), at[1]],
        (false, false) => {
            let det = bend[0] * bend[1] - uv * uv;
            if !(bend[0] < 0.0 && det > 0.0) {
                return [alone(0, gradient[0]), alone(1, gradient[1])];
            }
            let u = at[0] - (gradient[0] * bend[1] - gradient[1] * uv) / det;
            let v = at[1] - (gradient[1] * bend[0] - gradient[0] * uv) / det;
            if (0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v) {
                return [u, v];
            }
            // The parameter that would leave the node by more goes to the border.
            if (u - u.clamped(0.0, 1.0)).abs() >= (v - v.clamped(0.0, 1.0)).abs() {
                let u = u.clamped(0.0, 1.0);
                [u, alone(1, gradient[1] + uv * (u - at[0]))]
            } else {
                let v = v.clamped(0.0, 1.0);
                [alone(0, gradient[0] + uv * (v - at[1])), v]
            }
        }
    }
}

/// One body of a pair: nodes below the root, node 0. Each node is a part of the body within a
/// convex set.
///
/// Directions are unit vectors in the frame of the body. A height does not include the error of the
/// node ([`Node::error`]).
pub(super) trait NetSide {
    /// Whether the body is one convex set, whose closest point to a point needs no search.
    const IS_CONVEX: bool;

    fn node(&self, id: u32) -> &Node;

    /// Returns the greatest height of the convex set of a node.
    fn highest(&mut self, id: u32, n: &Vector3<f64>) -> f64;

    /// Returns the index and the position of a support point of the convex set, for the search of
    /// directions, and an upper bound of the height of the set.
    fn support(&mut self, id: u32, n: &Vector3<f64>) -> (u32, Vector3<f64>, f64);

    /// Returns a height that no upper bound of the part can be below. `highest` is the greatest
    /// height of the convex set.
    fn least(&self, id: u32, n: &Vector3<f64>, highest: f64) -> f64;

    /// Returns an upper bound of the height of the part by its curvature. Returns `highest` if no
    /// smaller bound is known, or if none is likely to be smaller by `need`.
    fn cap(&self, id: u32, n: &Vector3<f64>, highest: f64, need: f64) -> f64;

    /// Returns a height above a separating quadric that the part attains; `None` if
    /// [`above`](Self::above) is not worth trying.
    fn least_above(&self, id: u32, half: &BowlSide) -> Option<f64>;

    /// Returns an upper bound of the height of the part above a separating quadric, without the
    /// errors of the pose; `None` if no bound is known.
    fn above(&self, id: u32, half: &BowlSide) -> Option<f64>;

    /// Returns the first of the two children; the second has the next index. The node must be one
    /// that can be split.
    fn split(&mut self, id: u32) -> u32;
}

impl NetSide for Nodes<'_> {
    const IS_CONVEX: bool = false;

    #[inline]
    fn node(&self, id: u32) -> &Node {
        self.node(id)
    }

    #[inline]
    fn highest(&mut self, id: u32, n: &Vector3<f64>) -> f64 {
        self.net(id).highest(n)
    }

    #[inline]
    fn support(&mut self, id: u32, n: &Vector3<f64>) -> (u32, Vector3<f64>, f64) {
        let net = self.net(id);
        let k = net.highest_index(n);
        let p = net.point(k);
        (k as u32, p, n.dot(&p))
    }

    /// The corners of a net lie on the surface.
    #[inline]
    fn least(&self, id: u32, n: &Vector3<f64>, _: f64) -> f64 {
        self.net(id).highest_corner(self.node(id).degrees, n)
    }

    #[inline]
    fn cap(&self, id: u32, n: &Vector3<f64>, highest: f64, need: f64) -> f64 {
        let of = taylor(self.node(id), &self.net(id), n, highest, need);
        of.unwrap_or(highest).smaller(highest)
    }

    fn least_above(&self, id: u32, half: &BowlSide) -> Option<f64> {
        let node = self.node(id);
        half.is_near(node).then(|| half.least(node, &self.net(id)))
    }

    fn above(&self, id: u32, half: &BowlSide) -> Option<f64> {
        half.highest(self.node(id), &self.net(id))
    }

    fn split(&mut self, id: u32) -> u32 {
        self.split(id)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    /// Each pair of factors bounds the second derivative along every direction over a node.
    #[test]
    fn an_excess_bounds_every_way() {
        let mut rng = Rng::new(81);
        let mut quotients = 0;
        for _ in 0..2_000 {
            let mut bend = || rng.range(-1.0, 1.0);
            let (uu, vv, uv) = (bend(), bend(), bend().abs());
            for [k, l] in (Curvature { uu, vv, uv }).excess() {
                quotients += u32::from(k == 0.0 && vv > 0.0 || l == 0.0 && uu > 0.0);
                for step in 0..=64 {
                    let (u, v) = (f64::from(step) / 64.0, 1.0 - f64::from(step) / 64.0);
                    let bent = uu * u * u + vv * v * v + 2.0 * uv * u * v;
                    assert!(
                        bent <= k * u * u + l * v * v + 8.0 * UNIT * (1.0 + k + l),
                        "{uu} {vv} {uv}"
                    );
                }
            }
        }
        assert!(quotients > 500, "{quotients}");
    }
}

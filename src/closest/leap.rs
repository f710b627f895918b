//! Leaps along long rims and round large fans.
//!
//! On two nearly touching rims of thousands of edges the feet of a step are a corner or two from where they were, and the walk
//! would alternate between the two for as many steps as there are corners on the way. Here the curves, and the ribs beside
//! them, are smooth (see [`band`](super::band)), and Newton's method goes at once to where their distance is least. The walk goes on from
//! the corners there: a leap is a proposal, like every step.
//!
//! With `r` from a point of B to one of A, in up to two variables for each, `|r|^2 / 2` has the gradient `r . r_i` and the second
//! derivatives `r_i . r_j + r . r_ij`. A fixed edge or face on the other side takes no variables: what lies along it is dropped from `r`.

use nalgebra::Vector3;

use super::band::{Band, Fit, Near};
use super::outcome::Outcome;
use super::placed::Placed;
use crate::scalar::sqrt;
use crate::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, Feature, FeaturePair, VertexId};

/// Newton steps of one leap.
const STEPS: usize = 3;

/// How far a parabola is followed, in the length it is fitted over.
const REACH: f64 = 12.0;

/// One body's side of a pair.
enum Side<'a> {
    /// A vertex, edge or face beside no curve: a point of it and what of `r` counts.
    Fixed(Feature, Vector3<f64>, Counts),
    /// On a curve: the place a fit is made about.
    Curve(Band<'a>, usize, Fit),
    /// On the ribs beside one.
    Ribs(Band<'a>, usize, Fit),
}

/// What of a difference counts beside a fixed feature.
enum Counts {
    All,
    /// What is across this unit vector.
    Across(Vector3<f64>),
    /// What is along this unit vector.
    Along(Vector3<f64>),
}

impl Counts {
    fn of(&self, r: &Vector3<f64>) -> Vector3<f64> {
        match self {
            Counts::All => *r,
            Counts::Across(u) => r - u * r.dot(u),
            Counts::Along(n) => n * r.dot(n),
        }
    }

    fn turned(self, turn: impl Fn(&Vector3<f64>) -> Vector3<f64>) -> Self {
        match self {
            Counts::All => Counts::All,
            Counts::Across(u) => Counts::Across(turn(&u)),
            Counts::Along(n) => Counts::Along(turn(&n)),
        }
    }
}

/// Value and derivatives of a side's point in its two variables, `x` along the curve and `y` along the rib.
#[derive(Clone, Copy)]
struct Jet {
    at: Vector3<f64>,
    x: Vector3<f64>,
    y: Vector3<f64>,
    xx: Vector3<f64>,
    xy: Vector3<f64>,
}

/// The variables of both sides: `x`, `y` of A, then of B.
type Four = [f64; 4];

impl<'a> Side<'a> {
    fn of(body: &'a ConvexPolyhedron, feature: Feature) -> Option<Self> {
        let (t, at) = (&body.topology, |v: u32| body.points[v as usize]);
        let near = match feature {
            Feature::Vertex(v) => body.near_vertex(v.0),
            Feature::Edge(e) => body.near_edge(e.0),
            Feature::Face(f) => body.near_face(f.0),
        };
        Some(match (near, feature) {
            (Some(Near::Curve(band, k)), _) => Side::Curve(band, k, band.fit(k, false)?),
            (Some(Near::Rib(band, k)), _) => Side::Ribs(band, k, band.fit(k, true)?),
            (None, Feature::Vertex(v)) => Side::Fixed(feature, at(v.0), Counts::All),
            (None, Feature::Edge(e)) => {
                let (p, q) = (at(t.from(e.0)), at(t.half_edge(e.0).to));
                Side::Fixed(feature, p, Counts::Across((q - p) / sqrt((q - p).norm_squared())))
            }
            (None, Feature::Face(f)) => {
                let p = at(t.half_edge(t.rim_start(f.0)).to);
                Side::Fixed(feature, p, Counts::Along(body.planes[f.index()].normal))
            }
        })
    }

    fn is_fixed(&self) -> bool {
        matches!(self, Side::Fixed(..))
    }

    fn has_ribs(&self) -> bool {
        matches!(self, Side::Ribs(..))
    }

    /// From B's frame to A's.
    fn placed(self, placed: &Placed) -> Self {
        let (point, vector) = (|p: &Vector3<f64>| placed.point_in_a(p), |v: &Vector3<f64>| placed.vector_in_a(v));
        let placed = |[p, d, c]: [Vector3<f64>; 3]| [point(&p), vector(&d), vector(&c)];
        match self {
            Side::Fixed(feature, p, counts) => Side::Fixed(feature, point(&p), counts.turned(vector)),
            Side::Curve(band, k, mut fit) => {
                fit.near = placed(fit.near);
                Side::Curve(band, k, fit)
            }
            Side::Ribs(band, k, mut fit) => {
                (fit.near, fit.far) = (placed(fit.near), placed(fit.far));
                Side::Ribs(band, k, fit)
            }
        }
    }

    fn jet(&self, x: f64, y: f64) -> Jet {
        let zero = Vector3::zeros();
        let follow = |[p, d, c]: &[Vector3<f64>; 3]| (p + (d + c * (0.5 * x)) * x, d + c * x, *c);
        match self {
            Side::Fixed(_, p, _) => Jet {
                at: *p,
                x: zero,
                y: zero,
                xx: zero,
                xy: zero,
            },
            Side::Curve(_, _, fit) => {
                let (at, x, xx) = follow(&fit.near);
                Jet {
                    at,
                    x,
                    y: zero,
                    xx,
                    xy: zero,
                }
            }
            Side::Ribs(_, _, fit) => {
                let (near, far) = (follow(&fit.near), follow(&fit.far));
                let (rib, along) = (far.0 - near.0, far.1 - near.1);
                Jet {
                    at: near.0 + rib * y,
                    x: near.1 + along * y,
                    y: rib,
                    xx: near.2 + (far.2 - near.2) * y,
                    xy: along,
                }
            }
        }
    }

    /// The feature at `x`, `y`, beside one of the given dimension on the other side; and how many places it is from where it was.
    fn feature(&self, x: f64, y: f64, other: u8) -> (Feature, usize) {
        let vertex = |v: u32| Feature::Vertex(VertexId(v));
        let curve = |band: &Band, j: usize| {
            if other == 2 {
                vertex(band.corner(j))
            } else {
                Feature::Edge(EdgeId(band.edge(j)))
            }
        };
        match self {
            Side::Fixed(feature, ..) => (*feature, 0),
            Side::Curve(band, k, fit) => {
                let j = band.place_at(fit, *k, x);
                (curve(band, j), j.abs_diff(*k))
            }
            Side::Ribs(band, k, fit) => {
                let j = band.place_at(fit, *k, x);
                let feature = match (band.rib(j), band.far(j)) {
                    _ if y <= 0.0 => curve(band, j),
                    (_, Some(far)) if y >= 1.0 => vertex(far),
                    _ if other == 0 => Feature::Face(FaceId(band.strip(j))),
                    (Some(rib), _) if other == 1 => Feature::Edge(EdgeId(rib)),
                    _ => vertex(band.corner(j)),
                };
                (feature, j.abs_diff(*k))
            }
        }
    }

    /// The dimension of what it will name.
    fn dimension(&self) -> u8 {
        match self {
            Side::Fixed(feature, ..) => feature.dimension() as u8,
            Side::Curve(..) | Side::Ribs(..) => 1,
        }
    }
}

/// Goes to where the curves of the pair's features are closest; whether that is elsewhere.
#[cold]
#[inline(never)]
pub(super) fn leap(placed: &Placed, outcome: &mut Outcome) -> bool {
    let pair = outcome.features;
    let (Some(a), Some(b)) = (Side::of(placed.a, pair.a), Side::of(placed.b, pair.b)) else {
        return false;
    };
    if a.is_fixed() && b.is_fixed() {
        return false;
    }
    let b = b.placed(placed);
    let Some(at) = closest(&a, &b) else {
        return false;
    };
    let (fa, by_a) = a.feature(at[0], at[1], b.dimension());
    let (fb, by_b) = b.feature(at[2], at[3], a.dimension());
    if by_a.max(by_b) <= 1 {
        return false;
    }
    outcome.features = FeaturePair { a: fa, b: fb }.to_stand_on(placed.a, placed.b);
    true
}

/// Newton's method: first along the ribs alone, then in all variables. `None` where that does not lead closer.
fn closest(a: &Side, b: &Side) -> Option<Four> {
    let mut at = [0.0, 0.5, 0.0, 0.5];
    let ribs = [false, a.has_ribs(), false, b.has_ribs()];
    let all = [!a.is_fixed(), a.has_ribs(), !b.is_fixed(), b.has_ribs()];
    if a.has_ribs() || b.has_ribs() {
        step(a, b, &mut at, ribs)?;
    }
    let before = step(a, b, &mut at, all)?;
    for _ in 1..STEPS {
        step(a, b, &mut at, all)?;
    }
    (difference(a, b, &at).0.norm_squared() < before).then_some(at)
}

/// What counts of the difference, and the jets.
fn difference(a: &Side, b: &Side, at: &Four) -> (Vector3<f64>, Jet, Jet) {
    let (ja, jb) = (a.jet(at[0], at[1]), b.jet(at[2], at[3]));
    (counting(a, b, &(ja.at - jb.at)), ja, jb)
}

fn counting(a: &Side, b: &Side, r: &Vector3<f64>) -> Vector3<f64> {
    match (a, b) {
        (Side::Fixed(_, _, counts), _) | (_, Side::Fixed(_, _, counts)) => counts.of(r),
        _ => *r,
    }
}

/// One Newton step in the variables that are `free`; the squared length before it.
fn step(a: &Side, b: &Side, at: &mut Four, free: [bool; 4]) -> Option<f64> {
    let (r, ja, jb) = difference(a, b, at);
    // What counts is a projection: it need not be applied to both factors.
    let first = [ja.x, ja.y, -jb.x, -jb.y].map(|d| counting(a, b, &d));
    let mut h = [[0.0; 4]; 4];
    let mut g = [0.0; 4];
    for i in 0..4 {
        if !free[i] {
            h[i][i] = 1.0;
            continue;
        }
        g[i] = -first[i].dot(&r);
        for j in 0..=i {
            if free[j] {
                h[i][j] = first[i].dot(&first[j]);
            }
        }
    }
    let curved = [(0, 0, ja.xx), (1, 0, ja.xy), (2, 2, -jb.xx), (3, 2, -jb.xy)];
    for (i, j, d) in curved {
        if free[i] && free[j] {
            h[i][j] += r.dot(&d);
        }
    }
    let by = solve(h, g)?;
    for (k, (x, d)) in at.iter_mut().zip(by).enumerate() {
        let (low, high) = if k % 2 == 0 { (-REACH, REACH) } else { (0.0, 1.0) };
        *x = (*x + d).clamp(low, high);
    }
    Some(r.norm_squared())
}

/// Solves `h x = g` for the lower half of a symmetric matrix by Cholesky's method; `None` where it is not positive.
fn solve(mut h: [[f64; 4]; 4], mut g: Four) -> Option<Four> {
    for i in 0..4 {
        let whole = h[i][i];
        for j in 0..i {
            // h[i][j] is the entry times the pivot of j until here.
            let factor = h[i][j] / h[j][j];
            for k in j + 1..i {
                h[i][k] -= factor * h[k][j];
            }
            h[i][i] -= factor * h[i][j];
            g[i] -= factor * g[j];
        }
        if !(h[i][i] > 1e-12 * whole) {
            return None;
        }
    }
    for i in (0..4).rev() {
        for k in i + 1..4 {
            g[i] -= h[k][i] * g[k];
        }
        g[i] /= h[i][i];
    }
    Some(g)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_solver_solves() {
        let full = [
            [4.0, 1.0, 0.5, -1.0],
            [1.0, 3.0, 0.25, 0.5],
            [0.5, 0.25, 2.0, 0.125],
            [-1.0, 0.5, 0.125, 5.0],
        ];
        let x: Four = [1.0, -2.0, 3.0, 0.5];
        let g: Four = core::array::from_fn(|i| (0..4).map(|j| full[i][j] * x[j]).sum());
        let mut lower = full;
        (0..4).for_each(|i| (i + 1..4).for_each(|j| lower[i][j] = 0.0));
        let solved = solve(lower, g).expect("positive");
        for (a, b) in solved.iter().zip(x) {
            assert!((a - b).abs() < 1e-14, "{solved:?}");
        }
        lower[2][2] = -1.0;
        assert_eq!(solve(lower, g), None);
    }
}

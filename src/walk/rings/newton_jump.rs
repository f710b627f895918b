//! Newton jumps along large rings.
//!
//! If two long face boundaries nearly touch, each step moves the witnesses by one or two vertices,
//! and the walk would alternate between the two for as many steps as there are vertices on the way.
//! Here the rings and their spokes are smooth curves (see [`curve`](super::curve)), and Newton's
//! method goes at once to the least distance. The walk continues from the vertices there: a jump is
//! a proposal, like every step.
//!
//! With `r` from a point of B to a point of A, in up to two variables for each, `|r|^2 / 2` has the
//! gradient `r . r_i` and the second derivatives `r_i . r_j + r . r_ij`. A side on no ring is
//! fixed: a vertex takes no variable, an edge takes the variable along itself, and a face takes
//! none, because the components of `r` in the plane of the face are dropped.

use nalgebra::Vector3;

use crate::pair::face::{Face, Rim};
use crate::pair::outcome::Outcome;
use crate::pair::posed::PosedPair;
use crate::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, Feature, FeaturePair, VertexId};
use crate::walk::rings::cholesky::{Four, System};
use crate::walk::rings::curve::{Fit, RingCurve, RingLocation};

/// Newton steps per jump.
const STEPS: usize = 3;

/// Relative damping that makes second derivatives positive if they are not.
const DAMPING: f64 = 1.0 / 1024.0;

/// Newton's method stops after a step shorter than this.
const CLOSE: f64 = 1.0 / 8.0;

/// Limit of attempts: a jump that leads no closer is cut to a quarter for the next attempt.
const TRIES: u32 = 3;

/// Bisections for the point at which a curve leaves a face.
const BISECTIONS: u32 = 8;

/// Limit of `x` on a parabola, in units of the length of the fit.
const REACH: f64 = 12.0;

/// The feature of one body as a smooth set of points.
enum Side<'a> {
    /// A vertex on no ring.
    Vertex(u32, Vector3<f64>),
    /// An edge on no ring: the tail, and the vector to the head.
    Edge(u32, [Vector3<f64>; 2]),
    /// A face on no ring: a point of the plane, and the unit normal.
    Face(u32, [Vector3<f64>; 2]),
    /// A vertex or an edge of a ring: the index and the fit around the index.
    Curve(RingCurve<'a>, usize, Fit),
    /// A spoke or a side face of a ring: the index and the fit around the index.
    Ribs(RingCurve<'a>, usize, Fit),
}

/// Point of a side, with derivatives in the two variables: `x` along the curve and `y` along the
/// spoke.
#[derive(Clone, Copy)]
struct Jet {
    at: Vector3<f64>,
    x: Vector3<f64>,
    y: Vector3<f64>,
    xx: Vector3<f64>,
    xy: Vector3<f64>,
}

/// Position on a side: `fraction` of the edge from the vertex `index` to the next, and `y` along
/// the spoke there.
struct Spot {
    place: usize,
    part: f64,
    y: f64,
    /// Number of vertices between the start and this position.
    moved: usize,
}

impl<'a> Side<'a> {
    /// Returns the side of a feature; `None` if the ring of the feature has no fit.
    fn of(body: &'a ConvexPolyhedron, feature: Feature) -> Option<Self> {
        let (t, at) = (&body.topology, |v: u32| body.points[v as usize]);
        Some(match (body.near(feature), feature) {
            (Some(RingLocation::Curve(band, k)), _) => Side::Curve(band, k, band.fit(k, false)?),
            (Some(RingLocation::Rib(band, k)), _) => Side::Ribs(band, k, band.fit(k, true)?),
            (None, Feature::Vertex(v)) => Side::Vertex(v.0, at(v.0)),
            (None, Feature::Edge(e)) => {
                let (p, q) = (at(t.from(e.0)), at(t.half_edge(e.0).to));
                Side::Edge(e.0, [p, q - p])
            }
            (None, Feature::Face(f)) => {
                let p = at(t.half_edge(t.rim_start(f.0)).to);
                Side::Face(f.0, [p, body.planes[f.index()].normal])
            }
        })
    }

    fn is_curved(&self) -> bool {
        matches!(self, Side::Curve(..) | Side::Ribs(..))
    }

    /// Returns whether the side has the variable `y`: along an edge or a spoke.
    fn has_lines(&self) -> bool {
        matches!(self, Side::Edge(..) | Side::Ribs(..))
    }

    /// Transforms the side from B's frame to A's.
    fn place(&mut self, posed: &PosedPair) {
        let point = |p: &mut Vector3<f64>| *p = posed.point_in_a(p);
        let vector = |v: &mut Vector3<f64>| *v = posed.vector_in_a(v);
        let jet = |[p, d, c]: &mut [Vector3<f64>; 3]| {
            point(p);
            vector(d);
            vector(c);
        };
        match self {
            Side::Vertex(_, p) => point(p),
            Side::Edge(_, [p, u]) | Side::Face(_, [p, u]) => {
                point(p);
                vector(u);
            }
            Side::Curve(_, _, fit) => jet(&mut fit.near),
            Side::Ribs(_, _, fit) => {
                jet(&mut fit.near);
                jet(&mut fit.far);
            }
        }
    }

    /// Evaluates point and derivatives at `x`, `y`.
    fn jet(&self, x: f64, y: f64) -> Jet {
        let zero = Vector3::zeros();
        let still = |at: Vector3<f64>, y: Vector3<f64>| Jet {
            at,
            x: zero,
            y,
            xx: zero,
            xy: zero,
        };
        let follow = |[p, d, c]: &[Vector3<f64>; 3]| (p + (d + c * (0.5 * x)) * x, d + c * x, *c);
        match self {
            Side::Vertex(_, p) | Side::Face(_, [p, _]) => still(*p, zero),
            Side::Edge(_, [p, u]) => still(p + u * y, *u),
            Side::Curve(_, _, fit) => {
                let (at, x, xx) = follow(&fit.near);
                Jet {
                    x,
                    xx,
                    ..still(at, zero)
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

    /// Returns the position at `x`, `y`.
    fn spot(&self, x: f64, y: f64) -> Spot {
        match self {
            Side::Curve(band, k, fit) | Side::Ribs(band, k, fit) => {
                let (place, part) = band.place_at(fit, *k, x);
                Spot {
                    place,
                    part,
                    y,
                    moved: band.between(*k, place),
                }
            }
            _ => Spot {
                place: 0,
                part: 0.0,
                y,
                moved: 0,
            },
        }
    }

    /// Returns the point of the body itself at a position, in the frame of the body; `None` for a
    /// face.
    fn point(&self, body: &ConvexPolyhedron, spot: &Spot) -> Option<Vector3<f64>> {
        let at = |v: u32| body.points[v as usize];
        let &Spot { place: j, part, y, .. } = spot;
        Some(match self {
            Side::Vertex(v, _) => at(*v),
            Side::Edge(e, _) => {
                let t = &body.topology;
                at(t.from(*e)) * (1.0 - y) + at(t.half_edge(*e).to) * y
            }
            Side::Face(..) => return None,
            Side::Curve(band, ..) => band.point(j, part),
            Side::Ribs(band, ..) => band.point(j, part) * (1.0 - y) + at(band.far(j)?) * y,
        })
    }

    /// Returns the feature at a position, for a pair with a feature of dimension `other`.
    fn feature(&self, body: &ConvexPolyhedron, spot: &Spot, other: usize) -> Feature {
        let &Spot { place: j, y, part, .. } = spot;
        let vertex = |v: u32| Feature::Vertex(VertexId(v));
        let edge = |e: u32| Feature::Edge(EdgeId(e));
        let t = &body.topology;
        let curve = |band: &RingCurve| {
            if other == 2 {
                vertex(band.corner_near(j, part))
            } else {
                edge(band.edge(j))
            }
        };
        match self {
            Side::Vertex(v, _) => vertex(*v),
            Side::Face(f, _) => Feature::Face(FaceId(*f)),
            Side::Edge(e, _) if y <= 0.0 => vertex(t.from(*e)),
            Side::Edge(e, _) if y >= 1.0 => vertex(t.half_edge(*e).to),
            Side::Edge(e, _) => edge(*e),
            Side::Curve(band, ..) => curve(band),
            Side::Ribs(band, ..) => match (band.rib(j), band.far(j)) {
                _ if y <= 0.0 => curve(band),
                (_, Some(far)) if y >= 1.0 => vertex(far),
                _ if other == 0 => Feature::Face(FaceId(band.strip(j))),
                (Some(rib), _) if other == 1 => edge(rib),
                _ => vertex(band.corner_near(j, part)),
            },
        }
    }

    /// Returns the dimension of the feature to expect at `y`.
    fn dimension(&self, y: f64) -> usize {
        match self {
            Side::Vertex(..) => 0,
            Side::Edge(..) => usize::from(y > 0.0 && y < 1.0),
            Side::Ribs(..) if y >= 1.0 => 0,
            Side::Curve(..) | Side::Ribs(..) => 1,
            Side::Face(..) => 2,
        }
    }
}

/// Jumps to the features at which the curves of the pair are closest. Returns whether the jump
/// leads elsewhere.
#[cold]
#[inline(never)]
pub(crate) fn newton_jump(posed: &PosedPair, outcome: &mut Outcome) -> bool {
    let pair = outcome.features;
    let (Some(a), Some(mut b)) = (Side::of(posed.a, pair.a), Side::of(posed.b, pair.b)) else {
        return false;
    };
    if !a.is_curved() && !b.is_curved() {
        return false;
    }
    b.place(posed);
    let leap = Leap { posed, a: &a, b: &b };
    match leap.pair() {
        Some(to) => {
            outcome.features = to.to_stand_on(posed.a, posed.b);
            true
        }
        None => false,
    }
}

/// Both sides of a jump, in A's frame.
struct Leap<'a, 'b> {
    posed: &'a PosedPair<'b>,
    a: &'a Side<'a>,
    b: &'a Side<'a>,
}

/// The end of a jump, evaluated on the bodies themselves.
enum Landing {
    /// Squared distance of the two points.
    At(f64),
    /// The point is over no part of the face: it lies beyond this edge.
    Beyond(u32),
}

impl Leap<'_, '_> {
    /// Returns the pair from which to continue: at the end of Newton's method, or a part of the way
    /// there. `None` if a jump leads no closer or hardly moves.
    fn pair(&self) -> Option<FeaturePair> {
        let (start, before, mut at) = closest(self.a, self.b)?;
        for _ in 0..TRIES {
            let spots = self.spots(&at);
            if spots.0.moved.max(spots.1.moved) <= 1 {
                return None;
            }
            match self.landing(&spots) {
                Landing::Beyond(edge) => return Some(self.beyond(&start, &at, edge)),
                Landing::At(squared) if squared < before => return Some(self.features(&spots, None)),
                Landing::At(_) => at = between(&start, &at, 0.25),
            }
        }
        None
    }

    fn spots(&self, at: &Four) -> (Spot, Spot) {
        (self.a.spot(at[0], at[1]), self.b.spot(at[2], at[3]))
    }

    /// Evaluates the distance between the points of the bodies themselves.
    fn landing(&self, spots: &(Spot, Spot)) -> Landing {
        let posed = self.posed;
        let (on_a, on_b) = (self.a.point(posed.a, &spots.0), self.b.point(posed.b, &spots.1));
        match (on_a, on_b, self.a, self.b) {
            (Some(p), Some(q), ..) => Landing::At((p - posed.point_in_a(&q)).norm_squared()),
            (_, Some(q), Side::Face(f, _), _) => over(posed.a, *f, &posed.point_in_a(&q), posed.size()),
            (Some(p), _, _, Side::Face(f, _)) => over(posed.b, *f, &posed.point_in_b(&p), posed.size()),
            _ => Landing::At(f64::INFINITY),
        }
    }

    /// Returns the pair for a jump from over a face to beyond `edge` of the face boundary: the
    /// boundary edge that is passed first, and the edge of the curve that passes.
    fn beyond(&self, start: &Four, at: &Four, mut edge: u32) -> FeaturePair {
        let (mut over, mut out, mut spots) = (0.0, 1.0, self.spots(at));
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (over + out);
            let there = self.spots(&between(start, at, middle));
            match self.landing(&there) {
                Landing::Beyond(e) => (out, edge, spots) = (middle, e, there),
                Landing::At(_) => over = middle,
            }
        }
        self.features(&spots, Some(edge))
    }

    /// Returns the features at two positions; `edge` replaces a face if the point lies beyond this
    /// boundary edge.
    fn features(&self, spots: &(Spot, Spot), edge: Option<u32>) -> FeaturePair {
        let dimension = |side: &Side, spot: &Spot| if edge.is_some() { 1 } else { side.dimension(spot.y) };
        let name = |side: &Side, body: &ConvexPolyhedron, spot: &Spot, other: usize| match (side, edge) {
            (Side::Face(..), Some(e)) => Feature::Edge(EdgeId(e)),
            _ => side.feature(body, spot, other),
        };
        FeaturePair {
            a: name(self.a, self.posed.a, &spots.0, dimension(self.b, &spots.1)),
            b: name(self.b, self.posed.b, &spots.1, dimension(self.a, &spots.0)),
        }
    }
}

/// Returns the point at `fraction` of the way between two points.
fn between(from: &Four, to: &Four, part: f64) -> Four {
    core::array::from_fn(|k| from[k] + (to[k] - from[k]) * part)
}

/// Evaluates a point over a face: the squared height, or the boundary edge beyond which the point
/// lies.
fn over(body: &ConvexPolyhedron, face: u32, x: &Vector3<f64>, size: f64) -> Landing {
    let plane = &body.planes[face as usize];
    let face = Face {
        body,
        face,
        normal: &plane.normal,
    };
    let (rim, corner) = face.beside(x, size);
    match rim {
        Rim::Outside(edge) => Landing::Beyond(edge),
        _ => {
            let height = plane.normal.dot(&(x - corner));
            Landing::At(height * height)
        }
    }
}

/// Runs Newton's method, first along the lines alone, then in all variables. Returns the start, the
/// squared distance there, and the end.
fn closest(a: &Side, b: &Side) -> Option<(Four, f64, Four)> {
    let mut at = [0.0, 0.5, 0.0, 0.5];
    let lines = [false, a.has_lines(), false, b.has_lines()];
    let all = [a.is_curved(), lines[1], b.is_curved(), lines[3]];
    if lines[1] || lines[3] {
        step(a, b, &mut at, lines)?;
    }
    let start = at;
    let (before, mut by) = step(a, b, &mut at, all)?;
    for _ in 1..STEPS {
        // The next step would be as short as the square of the last.
        if by >= CLOSE {
            by = step(a, b, &mut at, all)?.1;
        }
    }
    Some((start, before, at))
}

/// The relevant part of the difference of two points, and the derivatives of both.
type Difference = (Vector3<f64>, Jet, Jet);

/// Evaluates both sides and their difference.
fn difference(a: &Side, b: &Side, at: &Four) -> Difference {
    let (ja, jb) = (a.jet(at[0], at[1]), b.jet(at[2], at[3]));
    (counting(a, b, &(ja.at - jb.at)), ja, jb)
}

/// Returns the relevant part of a vector: over a face, only the component along the normal.
fn counting(a: &Side, b: &Side, r: &Vector3<f64>) -> Vector3<f64> {
    match (a, b) {
        (Side::Face(_, [_, n]), _) | (_, Side::Face(_, [_, n])) => n * r.dot(n),
        _ => *r,
    }
}

/// Takes a Newton step in the variables that are `free`. Returns the squared length before the
/// step, and the length of the step in `x`.
fn step(a: &Side, b: &Side, at: &mut Four, free: [bool; 4]) -> Option<(f64, f64)> {
    let difference = difference(a, b, at);
    // Far from the least distance the second derivatives may not be positive; the damped ones
    // always are.
    let solved = system(a, b, at, &difference, free, true).solve();
    let by = solved.or_else(|| system(a, b, at, &difference, free, false).solve())?;
    for k in 0..4 {
        let (low, high) = if k % 2 == 0 { (-REACH, REACH) } else { (0.0, 1.0) };
        at[k] = (at[k] + by[k]).clamp(low, high);
    }
    Some((difference.0.norm_squared(), by[0].abs().max(by[2].abs())))
}

/// Returns the linear system of a step: Newton's if `curved`, else damped and certainly positive
/// definite.
#[inline(always)]
fn system(a: &Side, b: &Side, at: &Four, (r, ja, jb): &Difference, free: [bool; 4], curved: bool) -> System {
    let mut of = System::default();
    let mut first = [Vector3::zeros(); 4];
    for i in 0..4 {
        if !free[i] {
            continue;
        }
        let (jet, sign) = if i < 2 { (ja, 1.0) } else { (jb, -1.0) };
        let is_line = i % 2 == 1;
        let d = counting(a, b, &(if is_line { jet.y } else { jet.x } * sign));
        let downhill = -d.dot(r);
        // Fixed: a variable that would leave the end of its line, and a position at an apex, which
        // `x` does not move.
        let ends = is_line && (at[i] <= 0.0 && downhill < 0.0 || at[i] >= 1.0 && downhill > 0.0);
        if ends || d == Vector3::zeros() {
            continue;
        }
        let n = of.len;
        let mut row = [0.0; 4];
        for k in 0..n {
            row[k] = d.dot(&first[k]);
        }
        let bend = if is_line { 0.0 } else { sign * r.dot(&jet.xx) };
        row[n] = if curved {
            d.norm_squared() + bend
        } else {
            (d.norm_squared() + bend.abs()) * (1.0 + DAMPING)
        };
        if curved && is_line && n > 0 && of.of[n - 1] == i - 1 {
            row[n - 1] += sign * r.dot(&jet.xy);
        }
        of.push(i, row, downhill);
        first[n] = d;
    }
    of
}

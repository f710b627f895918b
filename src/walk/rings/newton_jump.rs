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

use crate::pair::face::{Face, Rim};
use crate::pair::outcome::Outcome;
use crate::pair::posed::PosedPair;
use crate::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, Feature, FeaturePair, VertexId};
use crate::tuning::walk::{BISECTIONS, CLOSE, DAMPING, REACH, STEPS, TRIES};
use crate::walk::rings::cholesky::{Four, System};
use crate::walk::rings::curve::{Fit, RingCurve, RingLocation};

/// One body's side of a pair.
enum Side<'a> {
    /// A vertex beside no curve.
    Vertex(u32, Vector3<f64>),
    /// An edge of none: its tail and what leads to its head.
    Edge(u32, [Vector3<f64>; 2]),
    /// A face beside none: a point of its plane, its unit normal.
    Face(u32, [Vector3<f64>; 2]),
    /// On a curve: the place a fit is made about.
    Curve(RingCurve<'a>, usize, Fit),
    /// On the ribs beside one.
    Ribs(RingCurve<'a>, usize, Fit),
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

/// A place on a side: between the corner of this number and the next, and on the line there.
struct Spot {
    place: usize,
    part: f64,
    y: f64,
    /// How many corners that is from the start.
    moved: usize,
}

impl<'a> Side<'a> {
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

    /// Whether it is followed in the variable `y` too.
    fn has_lines(&self) -> bool {
        matches!(self, Side::Edge(..) | Side::Ribs(..))
    }

    /// From B's frame to A's.
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

    /// The place at `x`, `y`.
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

    /// The point of the body itself, in its frame; none for a face.
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

    /// The feature there, beside one of dimension `other`.
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

    /// The dimension of what it will name at `y`.
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

/// Goes to where the curves of the pair's features are closest; whether that is elsewhere.
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

/// Both sides, in A's frame.
struct Leap<'a, 'b> {
    posed: &'a PosedPair<'b>,
    a: &'a Side<'a>,
    b: &'a Side<'a>,
}

/// Where a leap lands.
enum Landing {
    /// As far apart as the root of this.
    At(f64),
    /// Over no face: beyond this edge.
    Beyond(u32),
}

impl Leap<'_, '_> {
    /// The pair to go on from: where Newton's method leads, or a part of the way there.
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

    /// How far apart the bodies' own points are there.
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

    /// From over a face to beyond `edge` of its rim: the edge that is passed first, and that of the curve which passes.
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

    /// The features there; `edge` for a face, where it is one of its rim.
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

/// A part of the way from one to the other.
fn between(from: &Four, to: &Four, part: f64) -> Four {
    core::array::from_fn(|k| from[k] + (to[k] - from[k]) * part)
}

/// Where a point is over a face.
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

/// Newton's method: first along the lines alone, then in all variables. From where, how far apart that is, squared, and where it leads.
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
        // The next would move by the square of it.
        if by >= CLOSE {
            by = step(a, b, &mut at, all)?.1;
        }
    }
    Some((start, before, at))
}

/// What counts of the difference, and the jets.
type Difference = (Vector3<f64>, Jet, Jet);

fn difference(a: &Side, b: &Side, at: &Four) -> Difference {
    let (ja, jb) = (a.jet(at[0], at[1]), b.jet(at[2], at[3]));
    (counting(a, b, &(ja.at - jb.at)), ja, jb)
}

/// Over a face, only what is across it.
fn counting(a: &Side, b: &Side, r: &Vector3<f64>) -> Vector3<f64> {
    match (a, b) {
        (Side::Face(_, [_, n]), _) | (_, Side::Face(_, [_, n])) => n * r.dot(n),
        _ => *r,
    }
}

/// One Newton step in the variables that are `free`: the squared length before it, and how far it goes in `x`.
fn step(a: &Side, b: &Side, at: &mut Four, free: [bool; 4]) -> Option<(f64, f64)> {
    let difference = difference(a, b, at);
    // Far from the least distance the second derivatives may not be positive; the other ones always are.
    let solved = system(a, b, at, &difference, free, true).solve();
    let by = solved.or_else(|| system(a, b, at, &difference, free, false).solve())?;
    for k in 0..4 {
        let (low, high) = if k % 2 == 0 { (-REACH, REACH) } else { (0.0, 1.0) };
        at[k] = (at[k] + by[k]).clamp(low, high);
    }
    Some((difference.0.norm_squared(), by[0].abs().max(by[2].abs())))
}

/// The system of a step; of Newton's method if `curved`, else damped and certainly positive.
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
        // At an end of the line and on beyond it; and nothing moves round an apex.
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

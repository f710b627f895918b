//! Newton jumps along large rings, and the small symmetric linear systems that they solve
//! ([`System`]).
//!
//! If two long face boundaries nearly touch, each step moves the witness points by one or two
//! vertices, and the walk would take as many steps as there are vertices on the path. Here the
//! rings and their spokes are smooth curves (see [`RingCurve`]), and Newton's method in up to four
//! variables finds the least distance directly. The walk continues from the vertices there: a jump
//! is a proposal, like every step.
//!
//! Without the jumps, a query with a new tracker took 2 to 11 times as long for prisms and cones of
//! 1,024 and 8,192 vertices, and 0.6 to 1.2 times for 128 vertices (0.5 to 180 degrees per frame,
//! gaps of 2 % and 0.01 % of the size; AMD EPYC, 2026-11-26).
//!
//! With `r` from a point of B to a point of A, in up to two variables for each, `|r|^2 / 2` has the
//! gradient `r . r_i` and the second derivatives `r_i . r_j + r . r_ij`. A side on no ring is
//! fixed: a vertex takes no variable, an edge takes the variable along itself, and a face takes
//! none, because the components of `r` in the plane of the face are dropped.

use nalgebra::Vector3;

use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::tolerance::PIVOT;
use crate::body::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, Feature, FeaturePair, VertexId};
use crate::convex::walk::rings::{ParabolaFit, RingCurve, RingLocation};
use crate::pair::draft::Draft;
use crate::pair::face::{Face, FaceLocation};
use crate::pair::posed::PosedPair;

/// Number of Newton steps of one jump.
const STEPS: usize = 3;

/// Relative amount that makes non-positive second derivatives positive: safer steps for slower
/// convergence.
const DAMPING: f64 = 1.0 / 1024.0;

/// A Newton step shorter than this is the last: the next step would be as short as its square.
const CLOSE: f64 = 1.0 / 8.0;

/// How often a jump that leads no closer is cut to a quarter before it is dropped.
const TRIES: u32 = 3;

/// Bisections for the point at which a curve leaves a face.
const BISECTIONS: u32 = 8;

/// How far a parabola is followed, in lengths of its fit: longer jumps for worse extrapolation.
const REACH: f64 = 12.0;

/// The feature of one body as a smooth set of points.
enum RingSide<'a> {
    /// A vertex on no ring.
    Vertex(VertexId, Vector3<f64>),
    /// An edge on no ring: the tail, and the vector to the head.
    Edge(EdgeId, [Vector3<f64>; 2]),
    /// A face on no ring: a point of the plane, and the unit normal.
    Face(FaceId, [Vector3<f64>; 2]),
    /// A vertex or an edge of a ring: the index and the fit around the index.
    Ring(RingCurve<'a>, usize, ParabolaFit),
    /// A spoke or a side face of a ring: the index and the fit around the index.
    Spokes(RingCurve<'a>, usize, ParabolaFit),
}

/// Point of a side, with derivatives in the two variables: `x` along the curve and `y` along the
/// spoke.
#[derive(Clone, Copy)]
struct RingJet {
    point: Vector3<f64>,
    dx: Vector3<f64>,
    dy: Vector3<f64>,
    dxx: Vector3<f64>,
    dxy: Vector3<f64>,
}

/// Position on a side: `fraction` of the edge from the vertex `index` to the next, and `y` along
/// the spoke there.
struct SidePosition {
    index: usize,
    fraction: f64,
    y: f64,
    /// Number of vertices between the start and this position.
    moved: usize,
}

impl<'a> RingSide<'a> {
    /// Returns the side of a feature; `None` if the ring of the feature has no fit.
    fn of(body: &'a ConvexPolyhedron, feature: Feature) -> Option<Self> {
        let (t, at) = (&body.topology, |v: VertexId| body.points[v.index()]);
        Some(match (body.ring_location(feature), feature) {
            (Some(RingLocation::Ring(ring, k)), _) => RingSide::Ring(ring, k, ring.fit(k, false)?),
            (Some(RingLocation::Spokes(ring, k)), _) => RingSide::Spokes(ring, k, ring.fit(k, true)?),
            (None, Feature::Vertex(v)) => RingSide::Vertex(v, at(v)),
            (None, Feature::Edge(e)) => {
                let (p, q) = (at(t.from(e.half_edge())), at(t.half_edge(e.half_edge()).to));
                RingSide::Edge(e, [p, q - p])
            }
            (None, Feature::Face(f)) => {
                let p = at(t.half_edge(t.rim_half_edge(f)).to);
                RingSide::Face(f, [p, body.planes[f.index()].normal])
            }
        })
    }

    fn is_curved(&self) -> bool {
        matches!(self, RingSide::Ring(..) | RingSide::Spokes(..))
    }

    /// Returns whether the side has the variable `y`: along an edge or a spoke.
    fn has_lines(&self) -> bool {
        matches!(self, RingSide::Edge(..) | RingSide::Spokes(..))
    }

    /// Transforms the side from B's frame to A's.
    fn turn_to_frame_of_a(&mut self, posed: &PosedPair) {
        let point = |p: &mut Vector3<f64>| *p = posed.point_in_a(p);
        let vector = |v: &mut Vector3<f64>| *v = posed.vector_in_a(v);
        let jet = |[p, d, c]: &mut [Vector3<f64>; 3]| {
            point(p);
            vector(d);
            vector(c);
        };
        match self {
            RingSide::Vertex(_, p) => point(p),
            RingSide::Edge(_, [p, u]) | RingSide::Face(_, [p, u]) => {
                point(p);
                vector(u);
            }
            RingSide::Ring(_, _, fit) => jet(&mut fit.ring),
            RingSide::Spokes(_, _, fit) => {
                jet(&mut fit.ring);
                jet(&mut fit.spoke_ends);
            }
        }
    }

    /// Evaluates point and derivatives at `x`, `y`.
    fn jet(&self, x: f64, y: f64) -> RingJet {
        let zero = Vector3::zeros();
        let fixed = |point: Vector3<f64>, dy: Vector3<f64>| RingJet {
            point,
            dx: zero,
            dy,
            dxx: zero,
            dxy: zero,
        };
        let follow = |[p, d, c]: &[Vector3<f64>; 3]| (p + (d + c * (0.5 * x)) * x, d + c * x, *c);
        match self {
            RingSide::Vertex(_, p) | RingSide::Face(_, [p, _]) => fixed(*p, zero),
            RingSide::Edge(_, [p, u]) => fixed(p + u * y, *u),
            RingSide::Ring(_, _, fit) => {
                let (point, dx, dxx) = follow(&fit.ring);
                RingJet {
                    dx,
                    dxx,
                    ..fixed(point, zero)
                }
            }
            RingSide::Spokes(_, _, fit) => {
                let (ring, ends) = (follow(&fit.ring), follow(&fit.spoke_ends));
                let (spoke, change) = (ends.0 - ring.0, ends.1 - ring.1);
                RingJet {
                    point: ring.0 + spoke * y,
                    dx: ring.1 + change * y,
                    dy: spoke,
                    dxx: ring.2 + (ends.2 - ring.2) * y,
                    dxy: change,
                }
            }
        }
    }

    /// Returns the position at `x`, `y`.
    fn position(&self, x: f64, y: f64) -> SidePosition {
        match self {
            RingSide::Ring(ring, k, fit) | RingSide::Spokes(ring, k, fit) => {
                let (index, fraction) = ring.locate(fit, *k, x);
                SidePosition {
                    index,
                    fraction,
                    y,
                    moved: ring.index_distance(*k, index),
                }
            }
            _ => SidePosition {
                index: 0,
                fraction: 0.0,
                y,
                moved: 0,
            },
        }
    }

    /// Returns the point of the body itself at a position, in the frame of the body; `None` for a
    /// face.
    fn point(&self, body: &ConvexPolyhedron, position: &SidePosition) -> Option<Vector3<f64>> {
        let at = |v: VertexId| body.points[v.index()];
        let &SidePosition {
            index: j, fraction, y, ..
        } = position;
        Some(match self {
            RingSide::Vertex(v, _) => at(*v),
            RingSide::Edge(e, _) => {
                let t = &body.topology;
                at(t.from(e.half_edge())) * (1.0 - y) + at(t.half_edge(e.half_edge()).to) * y
            }
            RingSide::Face(..) => return None,
            RingSide::Ring(ring, ..) => ring.point(j, fraction),
            RingSide::Spokes(ring, ..) => ring.point(j, fraction) * (1.0 - y) + at(ring.spoke_end(j)?) * y,
        })
    }

    /// Returns the feature at a position, for a pair with a feature of dimension `other`.
    fn feature(&self, body: &ConvexPolyhedron, position: &SidePosition, other: usize) -> Feature {
        let &SidePosition {
            index: j, y, fraction, ..
        } = position;
        let (vertex, edge) = (Feature::Vertex, Feature::Edge);
        let t = &body.topology;
        let on_ring = |ring: &RingCurve| {
            if other == 2 {
                vertex(ring.nearest_vertex(j, fraction))
            } else {
                edge(ring.edge(j))
            }
        };
        match self {
            RingSide::Vertex(v, _) => vertex(*v),
            RingSide::Face(f, _) => Feature::Face(*f),
            RingSide::Edge(e, _) if y <= 0.0 => vertex(t.from(e.half_edge())),
            RingSide::Edge(e, _) if y >= 1.0 => vertex(t.half_edge(e.half_edge()).to),
            RingSide::Edge(e, _) => edge(*e),
            RingSide::Ring(ring, ..) => on_ring(ring),
            RingSide::Spokes(ring, ..) => match (ring.spoke(j), ring.spoke_end(j)) {
                _ if y <= 0.0 => on_ring(ring),
                (_, Some(far)) if y >= 1.0 => vertex(far),
                _ if other == 0 => Feature::Face(ring.side_face(j)),
                (Some(spoke), _) if other == 1 => edge(spoke),
                _ => vertex(ring.nearest_vertex(j, fraction)),
            },
        }
    }

    /// Returns the dimension of the feature to expect at `y`.
    fn dimension(&self, y: f64) -> usize {
        match self {
            RingSide::Vertex(..) => 0,
            RingSide::Edge(..) => usize::from(y > 0.0 && y < 1.0),
            RingSide::Spokes(..) if y >= 1.0 => 0,
            RingSide::Ring(..) | RingSide::Spokes(..) => 1,
            RingSide::Face(..) => 2,
        }
    }
}

/// Jumps to the features at which the curves of the pair are closest. Returns whether the jump
/// leads to another pair.
#[cold]
#[inline(never)]
pub(crate) fn newton_jump(posed: &PosedPair, draft: &mut Draft) -> bool {
    let pair = draft.features;
    let (Some(a), Some(mut b)) = (RingSide::of(posed.a, pair.a), RingSide::of(posed.b, pair.b)) else {
        return false;
    };
    if !a.is_curved() && !b.is_curved() {
        return false;
    }
    b.turn_to_frame_of_a(posed);
    let jump = NewtonJump { posed, a: &a, b: &b };
    match jump.target() {
        Some(to) => {
            draft.features = to.walkable(posed.a, posed.b);
            true
        }
        None => false,
    }
}

/// Both sides of a jump, in A's frame.
struct NewtonJump<'a, 'b> {
    posed: &'a PosedPair<'b>,
    a: &'a RingSide<'a>,
    b: &'a RingSide<'a>,
}

/// The end of a jump, evaluated on the bodies themselves.
enum Landing {
    /// Squared distance of the two points.
    SquaredDistance(f64),
    /// The point is over no part of the face: it lies beyond this edge.
    OutsideFace(EdgeId),
}

impl NewtonJump<'_, '_> {
    /// Returns the pair from which to continue: at the end of Newton's method, or on the segment to
    /// it. Returns `None` if a jump leads no closer or hardly moves.
    fn target(&self) -> Option<FeaturePair> {
        let (start, before, mut at) = newton(self.a, self.b)?;
        for _ in 0..TRIES {
            let positions = self.positions(&at);
            if positions[0].moved.max(positions[1].moved) <= 1 {
                return None;
            }
            match self.landing(&positions) {
                Landing::OutsideFace(edge) => return Some(self.across_boundary(&start, &at, edge)),
                Landing::SquaredDistance(squared) if squared < before => return Some(self.features(&positions, None)),
                Landing::SquaredDistance(_) => at = interpolate(&start, &at, 0.25),
            }
        }
        None
    }

    fn positions(&self, at: &Variables) -> [SidePosition; 2] {
        [self.a.position(at[0], at[1]), self.b.position(at[2], at[3])]
    }

    /// Evaluates the distance between the points of the bodies themselves.
    fn landing(&self, [at_a, at_b]: &[SidePosition; 2]) -> Landing {
        let posed = self.posed;
        let (on_a, on_b) = (self.a.point(posed.a, at_a), self.b.point(posed.b, at_b));
        match (on_a, on_b, self.a, self.b) {
            (Some(p), Some(q), ..) => Landing::SquaredDistance((p - posed.point_in_a(&q)).norm_squared()),
            (_, Some(q), RingSide::Face(f, _), _) => height_over_face(posed.a, *f, &posed.point_in_a(&q), posed.size()),
            (Some(p), _, _, RingSide::Face(f, _)) => height_over_face(posed.b, *f, &posed.point_in_b(&p), posed.size()),
            _ => Landing::SquaredDistance(f64::INFINITY),
        }
    }

    /// Returns the pair for a jump from over a face to beyond `edge` of the face boundary: the
    /// boundary edge that is passed first, and the edge of the curve that passes.
    fn across_boundary(&self, start: &Variables, at: &Variables, mut edge: EdgeId) -> FeaturePair {
        let (mut over, mut out, mut positions) = (0.0, 1.0, self.positions(at));
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (over + out);
            let there = self.positions(&interpolate(start, at, middle));
            match self.landing(&there) {
                Landing::OutsideFace(e) => (out, edge, positions) = (middle, e, there),
                Landing::SquaredDistance(_) => over = middle,
            }
        }
        self.features(&positions, Some(edge))
    }

    /// Returns the features at two positions; `edge` replaces a face if the point lies beyond this
    /// boundary edge.
    fn features(&self, [at_a, at_b]: &[SidePosition; 2], edge: Option<EdgeId>) -> FeaturePair {
        let dimension =
            |side: &RingSide, position: &SidePosition| if edge.is_some() { 1 } else { side.dimension(position.y) };
        let name = |side: &RingSide, body: &ConvexPolyhedron, position: &SidePosition, other: usize| match (side, edge)
        {
            (RingSide::Face(..), Some(e)) => Feature::Edge(e),
            _ => side.feature(body, position, other),
        };
        FeaturePair {
            a: name(self.a, self.posed.a, at_a, dimension(self.b, at_b)),
            b: name(self.b, self.posed.b, at_b, dimension(self.a, at_a)),
        }
    }
}

/// Returns the point at `fraction` of the segment between two points.
fn interpolate(from: &Variables, to: &Variables, fraction: f64) -> Variables {
    core::array::from_fn(|k| from[k] + (to[k] - from[k]) * fraction)
}

/// Evaluates a point over a face: the squared height, or the boundary edge beyond which the point
/// lies.
fn height_over_face(body: &ConvexPolyhedron, face: FaceId, x: &Vector3<f64>, size: f64) -> Landing {
    let plane = &body.planes[face.index()];
    let face = Face {
        body,
        face,
        normal: &plane.normal,
    };
    let (location, corner) = face.locate(x, size);
    match location {
        FaceLocation::Outside(edge) => Landing::OutsideFace(edge),
        _ => {
            let height = plane.normal.dot(&(x - corner));
            Landing::SquaredDistance(height * height)
        }
    }
}

/// Runs Newton's method, first in the variables along lines only, then in all variables. Returns
/// the start, the squared distance there, and the end.
fn newton(a: &RingSide, b: &RingSide) -> Option<(Variables, f64, Variables)> {
    let mut at = [0.0, 0.5, 0.0, 0.5];
    let lines = [false, a.has_lines(), false, b.has_lines()];
    let all = [a.is_curved(), lines[1], b.is_curved(), lines[3]];
    if lines[1] || lines[3] {
        newton_step(a, b, &mut at, lines)?;
    }
    let start = at;
    let (before, mut by) = newton_step(a, b, &mut at, all)?;
    for _ in 1..STEPS {
        // The next step would be as short as the square of the last.
        if by >= CLOSE {
            by = newton_step(a, b, &mut at, all)?.1;
        }
    }
    Some((start, before, at))
}

/// The relevant part of the difference of two points, and the derivatives of both.
type Evaluation = (Vector3<f64>, RingJet, RingJet);

/// Evaluates both sides and their difference.
fn evaluate(a: &RingSide, b: &RingSide, at: &Variables) -> Evaluation {
    let (ja, jb) = (a.jet(at[0], at[1]), b.jet(at[2], at[3]));
    (relevant(a, b, &(ja.point - jb.point)), ja, jb)
}

/// Returns the relevant part of a vector: over a face, only the component along the normal.
fn relevant(a: &RingSide, b: &RingSide, r: &Vector3<f64>) -> Vector3<f64> {
    match (a, b) {
        (RingSide::Face(_, [_, n]), _) | (_, RingSide::Face(_, [_, n])) => n * r.dot(n),
        _ => *r,
    }
}

/// Takes a Newton step in the variables that are `free`. Returns the squared length before the
/// step, and the length of the step in `x`.
fn newton_step(a: &RingSide, b: &RingSide, at: &mut Variables, free: [bool; 4]) -> Option<(f64, f64)> {
    let evaluation = evaluate(a, b, at);
    // Far from the least distance the second derivatives may not be positive; the damped ones
    // always are.
    let solved = newton_system(a, b, at, &evaluation, free, true).solve();
    let by = solved.or_else(|| newton_system(a, b, at, &evaluation, free, false).solve())?;
    for k in 0..4 {
        let (low, high) = if k % 2 == 0 { (-REACH, REACH) } else { (0.0, 1.0) };
        at[k] = (at[k] + by[k]).clamped(low, high);
    }
    Some((evaluation.0.norm_squared(), by[0].abs().larger(by[2].abs())))
}

/// Returns the linear system of a step: Newton's if `curved`, else damped and certainly positive
/// definite.
#[inline(always)]
fn newton_system(
    a: &RingSide,
    b: &RingSide,
    at: &Variables,
    (r, ja, jb): &Evaluation,
    free: [bool; 4],
    curved: bool,
) -> System {
    let mut system = System::default();
    let mut first = [Vector3::zeros(); 4];
    for i in 0..4 {
        if !free[i] {
            continue;
        }
        let (jet, sign) = if i < 2 { (ja, 1.0) } else { (jb, -1.0) };
        let is_line = i % 2 == 1;
        let d = relevant(a, b, &(if is_line { jet.dy } else { jet.dx } * sign));
        let downhill = -d.dot(r);
        // Fixed: a variable that would leave the end of its line, and a position at an apex, which
        // `x` does not move.
        let ends = is_line && (at[i] <= 0.0 && downhill < 0.0 || at[i] >= 1.0 && downhill > 0.0);
        if ends || d == Vector3::zeros() {
            continue;
        }
        let n = system.len;
        let mut row = [0.0; 4];
        for k in 0..n {
            row[k] = d.dot(&first[k]);
        }
        let bend = if is_line { 0.0 } else { sign * r.dot(&jet.dxx) };
        row[n] = if curved {
            d.norm_squared() + bend
        } else {
            (d.norm_squared() + bend.abs()) * (1.0 + DAMPING)
        };
        if curved && is_line && n > 0 && system.variables[n - 1] == i - 1 {
            row[n - 1] += sign * r.dot(&jet.dxy);
        }
        system.push(i, row, downhill);
        first[n] = d;
    }
    system
}

/// The variables of a [`newton_jump`](super::newton_jump): `x`, `y` of A, then `x`, `y` of B.
pub(super) type Variables = [f64; 4];

/// Symmetric system in some of four variables: the lower half of the matrix, and the right side.
#[derive(Clone, Copy, Default)]
pub(super) struct System {
    /// The variables of the rows.
    pub(super) variables: [usize; 4],
    pub(super) len: usize,
    rows: [[f64; 4]; 4],
    right: Variables,
}

impl System {
    /// Adds a row of the lower half of the matrix, for the next variable.
    pub(super) fn push(&mut self, variable: usize, row: [f64; 4], right: f64) {
        let n = self.len;
        (self.variables[n], self.rows[n], self.right[n]) = (variable, row, right);
        self.len += 1;
    }

    /// Solves by Cholesky's method, with zero for the absent variables; `None` if the matrix is not
    /// positive definite.
    pub(super) fn solve(mut self) -> Option<Variables> {
        let (n, h, g) = (self.len, &mut self.rows, &mut self.right);
        for i in 0..n {
            let diagonal = h[i][i];
            for j in 0..i {
                // So far h[i][j] is the entry times the pivot of j.
                let factor = h[i][j] / h[j][j];
                for k in j + 1..i {
                    h[i][k] -= factor * h[k][j];
                }
                h[i][i] -= factor * h[i][j];
                g[i] -= factor * g[j];
            }
            if !(h[i][i] > PIVOT * diagonal) {
                return None;
            }
        }
        let mut x = [0.0; 4];
        for i in (0..n).rev() {
            for k in i + 1..n {
                g[i] -= h[k][i] * g[k];
            }
            g[i] /= h[i][i];
            x[self.variables[i]] = g[i];
        }
        Some(x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::polyhedron::fans::Cycle;

    #[test]
    fn the_solver_solves() {
        let full = [
            [4.0, 1.0, 0.5, -1.0],
            [1.0, 3.0, 0.25, 0.5],
            [0.5, 0.25, 2.0, 0.125],
            [-1.0, 0.5, 0.125, 5.0],
        ];
        let x: Variables = [1.0, -2.0, 3.0, 0.5];
        for variables in [&[0, 1, 2, 3][..], &[0, 2], &[1, 2, 3], &[3], &[]] {
            let mut system = System::default();
            for &i in variables {
                let mut row = [0.0; 4];
                variables
                    .iter()
                    .zip(&mut row)
                    .filter(|(j, _)| **j <= i)
                    .for_each(|(&j, r)| *r = full[i][j]);
                system.push(i, row, variables.iter().map(|&j| full[i][j] * x[j]).sum());
            }
            let solved = system.solve().expect("positive");
            for k in 0..4 {
                let truth = if variables.contains(&k) { x[k] } else { 0.0 };
                assert!((solved[k] - truth).abs() < 1e-14, "{solved:?}");
            }
        }
        let mut bad = System::default();
        bad.push(2, [-1.0, 0.0, 0.0, 0.0], 1.0);
        assert_eq!(bad.solve(), None);
        let mut flat = System::default();
        flat.push(2, [0.0; 4], 1.0);
        assert_eq!(flat.solve(), None);
    }

    /// The matrix of a step has the second derivatives of half the squared distance.
    #[test]
    fn the_system_has_the_second_derivatives() {
        let n = 200;
        let rim = (0..n).map(|k| core::f64::consts::TAU * f64::from(k) / f64::from(n));
        let rim = rim.map(|t| nalgebra::Point3::new(t.cos(), t.sin(), 0.0));
        let points: alloc::vec::Vec<_> = rim.chain([nalgebra::Point3::new(0.1, 0.2, 1.0)]).collect();
        let body = ConvexPolyhedron::from_points(&points).expect("a cone");
        let apex = body
            .vertices()
            .find(|&v| body.topology.fan(v).len() == 200)
            .expect("an apex");
        let spoke = body.topology.edge(body.topology.fan(apex).at(20));
        let a = RingSide::of(&body, Feature::Edge(spoke)).expect("spokes");
        assert!(a.is_curved() && a.has_lines());
        let b = RingSide::Vertex(apex, Vector3::new(0.9, 1.3, 0.7));
        let (at, free, h) = ([0.05, 0.4, 0.0, 0.5], [true, true, false, false], 1e-4);
        let half = |x: f64, y: f64| {
            0.5 * evaluate(&a, &b, &[at[0] + x * h, at[1] + y * h, 0.0, 0.5])
                .0
                .norm_squared()
        };
        let second = |terms: f64| terms / (h * h);
        let truth = [
            second(half(1.0, 0.0) - 2.0 * half(0.0, 0.0) + half(-1.0, 0.0)),
            second(half(1.0, 1.0) - half(1.0, -1.0) - half(-1.0, 1.0) + half(-1.0, -1.0)) / 4.0,
            second(half(0.0, 1.0) - 2.0 * half(0.0, 0.0) + half(0.0, -1.0)),
        ];
        let system = newton_system(&a, &b, &at, &evaluate(&a, &b, &at), free, true);
        let found = [system.rows[0][0], system.rows[1][0], system.rows[1][1]];
        for (x, y) in found.into_iter().zip(truth) {
            assert!((x - y).abs() < 1e-5 * (1.0 + y.abs()), "{found:?} {truth:?}");
        }
        // The mixed derivative matters here.
        assert!(truth[1].abs() > 1e-3, "{truth:?}");
    }
}

//! The distance of two features in closed form, in double-double, for pairs whose closest features
//! are certain.
//!
//! ```text
//!   vertex, vertex   |w|                 w  from a vertex of the one feature to one of the other
//!   vertex, edge     |w x u| / |u|       u, v  edges
//!   vertex, face     |w . n| / |n|       n = u x v of two edges of a triangle of the face
//!   edge, edge       |w . n| / |n|       n = u x v of the two edges
//! ```
//!
//! Signs in f64 decide that the features are the closest. The closest points of their lines and
//! planes lie within both features. Every vertex adjacent to a feature lies behind the plane
//! through the feature that is perpendicular to the direction between the bodies. Because a body is
//! convex, the whole body is then behind that plane; for the plane of a face this always holds,
//! because faces are exactly planar. All signs include the rounding of the direction and of the
//! relative rotation. If a sign is uncertain, the solvers compute the pair instead.

use nalgebra::Vector3;

use crate::base::num::double_double::DoubleDouble;
use crate::base::num::each::Each;
use crate::base::num::scalar::{Scalar, Vec3, cross, dot, magnitude, root, sqrt};
use crate::base::pose::Operand;
use crate::base::tolerance::{CLEAR_SIGN, CLOSED_FORM, LEAST_RISE};
use crate::body::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, Feature, VertexId};
use crate::convex::minimum::triangle;
use crate::pair::draft::Draft;
use crate::pair::posed::{AFirst, BFirst, OrderedPair, PosedPair};
use crate::pair::transform::Turned;

/// Largest number of edges of a vertex that are tested; pairs with more use a solver.
const FAN: usize = 32;

/// The distance of two features that are proven to be the closest.
pub(crate) struct ClosedForm {
    pub(crate) distance: DoubleDouble,
    /// Bound of the error of the distance.
    pub(crate) error: f64,
    /// Direction from A to B in A's stored frame, of any length.
    pub(crate) normal: Vector3<f64>,
}

/// Returns the distance of the features of a draft, if they are certainly the closest. The bodies
/// must be stored in one unit and relative to their origins.
pub(crate) fn closed_form(posed: &PosedPair, draft: &Draft) -> Option<ClosedForm> {
    let is_centred = |body: &ConvexPolyhedron| body.origin == Vector3::zeros();
    if !(posed.same_scale() && is_centred(posed.a) && is_centred(posed.b)) {
        return None;
    }
    let (x, y) = (&draft.point_on_a.coords, &draft.point_on_b.coords);
    match (draft.features.a, draft.features.b) {
        (Feature::Vertex(a), Feature::Vertex(b)) => vertices(posed, &BFirst(posed), b, a),
        (Feature::Edge(e), Feature::Vertex(b)) => vertex_edge(posed, &BFirst(posed), b, e),
        (Feature::Vertex(a), Feature::Edge(e)) => vertex_edge(posed, &AFirst(posed), a, e),
        (Feature::Face(f), Feature::Vertex(b)) => vertex_face(posed, &BFirst(posed), b, f, x),
        (Feature::Vertex(a), Feature::Face(f)) => vertex_face(posed, &AFirst(posed), a, f, y),
        (Feature::Edge(e), Feature::Edge(g)) => edges(posed, &BFirst(posed), g, e),
        _ => None,
    }
}

/// Returns the closed form of two vertices.
fn vertices<P: OrderedPair>(posed: &PosedPair, pair: &P, p: VertexId, v: VertexId) -> Option<ClosedForm> {
    let w = turned::<P>(posed).between(at(pair.second(), v), at(pair.first(), p));
    let n = rounded(&w);
    let is_proven = is_support(pair.second(), &[v], &n) && is_support_of_first(pair, &[p], &n);
    is_proven.then(|| finish(pair, root(dot(&w, &w)), 1.0, &n))
}

/// Returns the closed form of a vertex over an edge.
fn vertex_edge<P: OrderedPair>(posed: &PosedPair, pair: &P, p: VertexId, edge: EdgeId) -> Option<ClosedForm> {
    let (body, [v, head]) = (pair.second(), ends(pair.second(), edge));
    let w = turned::<P>(posed).between(at(body, v), at(pair.first(), p));
    let u = side(body, v, head);
    let (w_near, u_near) = (rounded(&w), rounded(&u));
    let (along, squared) = (w_near.dot(&u_near), u_near.norm_squared());
    let doubt = CLEAR_SIGN * sqrt(squared) * w_near.norm();
    if !(along > doubt && squared - along > doubt) {
        return None;
    }
    let area = cross(&w, &u);
    // The part of `w` perpendicular to the edge, in double-double, because most of it may cancel.
    let n = rounded(&cross(&u, &area));
    let is_proven = is_support(body, &[v, head], &n) && is_support_of_first(pair, &[p], &n);
    is_proven.then(|| finish(pair, root(dot(&area, &area) / dot(&u, &u)), 1.0, &n))
}

/// Returns the closed form of a vertex over a face; `x` is the witness on the face.
fn vertex_face<P: OrderedPair>(
    posed: &PosedPair,
    pair: &P,
    p: VertexId,
    face: FaceId,
    x: &Vector3<f64>,
) -> Option<ClosedForm> {
    let body = pair.second();
    let [v, q, r] = triangle(body, face, x);
    let w = turned::<P>(posed).between(at(body, v), at(pair.first(), p));
    let (e, f) = (side(body, v, q), side(body, v, r));
    let n = cross(&e, &f);
    let height = dot(&w, &n);
    let [w_near, e_near, f_near, n_near] = [&w, &e, &f, &n].each(rounded);
    let (lengths, normal) = (e_near.norm() * f_near.norm(), n_near.norm());
    let doubt = CLEAR_SIGN * normal * w_near.norm();
    let (beside_f, beside_e) = (n_near.dot(&w_near.cross(&f_near)), n_near.dot(&e_near.cross(&w_near)));
    let inside = beside_f > doubt * f_near.norm()
        && beside_e > doubt * e_near.norm()
        && normal * normal - beside_f - beside_e > doubt * (e_near.norm() + f_near.norm());
    // The boundary of a face is counter-clockwise, so the normal points out of the face, to the
    // vertex.
    let is_proven = inside && height.value() > 0.0 && is_support_of_first(pair, &[p], &n_near);
    is_proven.then(|| finish(pair, height / root(dot(&n, &n)), lengths / normal, &n_near))
}

/// Returns the closed form of two edges.
fn edges<P: OrderedPair>(posed: &PosedPair, pair: &P, first: EdgeId, second: EdgeId) -> Option<ClosedForm> {
    let ([p, p_head], [v, v_head]) = (ends(pair.first(), first), ends(pair.second(), second));
    let turned = turned::<P>(posed);
    let w = turned.between(at(pair.second(), v), at(pair.first(), p));
    let u = side(pair.second(), v, v_head);
    let g = turned.vector(&side(pair.first(), p, p_head));
    let n = cross(&u, &g);
    let height = dot(&w, &n);
    let [w_near, u_near, g_near, n_near] = [&w, &u, &g, &n].each(rounded);
    let (lengths, normal) = (u_near.norm() * g_near.norm(), n_near.norm());
    let doubt = CLEAR_SIGN * normal * w_near.norm();
    let (on_u, on_g) = (n_near.dot(&w_near.cross(&g_near)), n_near.dot(&w_near.cross(&u_near)));
    let squared = normal * normal;
    let within = |part: f64, length: f64| part > doubt * length && squared - part > doubt * length;
    let is_below = height.value() < 0.0;
    let (height, n_near) = if is_below { (-height, -n_near) } else { (height, n_near) };
    let is_proven = within(on_u, g_near.norm())
        && within(on_g, u_near.norm())
        && is_support(pair.second(), &[v, v_head], &n_near)
        && is_support_of_first(pair, &[p, p_head], &n_near);
    is_proven.then(|| finish(pair, height / root(dot(&n, &n)), lengths / normal, &n_near))
}

fn finish<P: OrderedPair>(pair: &P, distance: DoubleDouble, stretch: f64, n: &Vector3<f64>) -> ClosedForm {
    ClosedForm {
        distance,
        error: CLOSED_FORM * DoubleDouble::UNIT * pair.size() * stretch,
        normal: pair.normal(n),
    }
}

/// Returns the rotations of the pose: of `first` as B, of `second` as A.
fn turned<P: OrderedPair>(posed: &PosedPair) -> Turned {
    let is_swapped = P::FIRST == Operand::A;
    let pose = if is_swapped { posed.pose.swapped() } else { *posed.pose };
    Turned::new(pose, posed.a.exponent)
}

fn at(body: &ConvexPolyhedron, v: VertexId) -> &Vector3<f64> {
    &body.points[v.index()]
}

/// Returns the vector between two vertices.
fn side(body: &ConvexPolyhedron, from: VertexId, to: VertexId) -> Vec3<DoubleDouble> {
    let (p, q) = (at(body, from), at(body, to));
    [0, 1, 2].each(|k| DoubleDouble::sum(q[k], -p[k]))
}

fn ends(body: &ConvexPolyhedron, edge: EdgeId) -> [VertexId; 2] {
    let (t, h) = (&body.topology, edge.half_edge());
    [t.from(h), t.half_edge(h).to]
}

fn rounded(v: &Vec3<DoubleDouble>) -> Vector3<f64> {
    Vector3::new(v[0].hi, v[1].hi, v[2].hi)
}

/// Returns whether every vertex adjacent to the given ones, which have equal heights, is certainly
/// lower along `n`.
fn is_support(body: &ConvexPolyhedron, level: &[VertexId], n: &Vector3<f64>) -> bool {
    // The direction over an edge far shorter than the body is short: its square would underflow.
    let largest = n.amax();
    if !(largest > LEAST_RISE) {
        return false;
    }
    let n = n / magnitude(largest);
    let least = CLEAR_SIGN * n.norm();
    level.iter().all(|&v| {
        let mut falls = body.topology.fan(v).len() <= FAN;
        body.topology.each_leaving(v, |_, to| {
            let e = at(body, to) - at(body, v);
            falls &= level.contains(&to) || n.dot(&e) < -(least * e.abs().sum() + LEAST_RISE);
        });
        falls
    })
}

/// Does the same for the vertices of `first`, along the direction opposite to `n`, which is in the
/// frame of `second`.
fn is_support_of_first<P: OrderedPair>(pair: &P, level: &[VertexId], n: &Vector3<f64>) -> bool {
    is_support(pair.first(), level, &-pair.direction_in_first(n))
}

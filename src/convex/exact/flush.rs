//! Exact contact of a vertex and a face whose normal is an axis of A's frame.
//!
//! Parts at rest on a table or on each other often touch exactly, because their sizes and poses are
//! short numbers. The walk then ends at a vertex and a face, or at a feature of the boundary of
//! such a face. Three facts prove the contact, and no search is needed:
//!
//! 1. All vertices of the face have the same height. So the face supports its body.
//! 2. No vertex of the other body is lower than the vertex, which has the height of the face. So a
//!    plane separates the interiors of the bodies.
//! 3. The vertex is not outside any edge of the face.
//!
//! All three are exact. Before, f64 and double-double rule out pairs that do not touch. If no
//! vertex lies in a face, as where two edges cross, the general search decides.

use nalgebra::{Unit, Vector3};

use super::integer::{cross, dot, integer, neg, sign, sub};
use super::{RotatedBody, ScaledPair};
use crate::base::num::double_double::DoubleDouble;
use crate::base::num::each::Each;
use crate::base::num::scalar::{Scalar, sqrt};
use crate::base::num::sign::sign as signum;
use crate::base::pose::Operand;
use crate::base::tolerance::{CERTIFICATE, UNIT};
use crate::body::polyhedron::highest::{Direction, Upward};
use crate::body::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, Feature, FeaturePair, HalfEdgeId, VertexId};
use crate::pair::draft::Draft;
use crate::pair::outcome::{ContactState, Solver};
use crate::pair::posed::PosedPair;
use crate::pair::transform::Transform;

/// Largest number of edges of a face that are tested one by one, at 33 ns each. The general search
/// bisects, and is as fast at 600 edges.
const MOST_EDGES: usize = 512;

/// Proves that a vertex touches a face at the features of the draft. Returns false, and leaves the
/// draft unchanged, if there is no such vertex.
pub(crate) fn touches(posed: &PosedPair, draft: &mut Draft) -> bool {
    let (a, b) = (posed.a, posed.b);
    let touching =
        |of, face, vertex| Flush::new(posed, of, face, vertex).and_then(|flush| Some((flush.features()?, flush)));
    let flush = match (draft.features.a, draft.features.b) {
        _ if !posed.same_scale() => None,
        (Feature::Face(f), Feature::Vertex(v)) => touching(Operand::A, f, v),
        (Feature::Vertex(v), Feature::Face(f)) => touching(Operand::B, f, v),
        (Feature::Edge(e), Feature::Vertex(v)) => sides(a, e).into_iter().find_map(|f| touching(Operand::A, f, v)),
        (Feature::Vertex(v), Feature::Edge(e)) => sides(b, e).into_iter().find_map(|f| touching(Operand::B, f, v)),
        (Feature::Vertex(v), Feature::Vertex(w)) => {
            let on_a = around(a, v).find_map(|f| touching(Operand::A, f, w));
            on_a.or_else(|| around(b, w).find_map(|f| touching(Operand::B, f, v)))
        }
        _ => None,
    };
    flush.is_some_and(|(features, flush)| {
        flush.write(features, draft);
        true
    })
}

/// Returns the two faces at an edge.
fn sides(body: &ConvexPolyhedron, edge: EdgeId) -> [FaceId; 2] {
    let h = body.topology.half_edge(edge.half_edge());
    [h.face, body.topology.half_edge(h.twin).face]
}

/// Returns the faces at a vertex.
fn around(body: &ConvexPolyhedron, v: VertexId) -> impl Iterator<Item = FaceId> + '_ {
    body.topology.fan(v).iter().map(|h| body.topology.half_edge(h).face)
}

/// A face of one body and a vertex of the other.
struct Flush<'a> {
    posed: &'a PosedPair<'a>,
    /// The body of the face.
    of: Operand,
    face: FaceId,
    vertex: VertexId,
    /// The axis from A to B, in A's frame.
    normal: Vector3<f64>,
    /// The outward normal of the face in the frame of its body.
    outward: Vector3<f64>,
    /// The position of the vertex in the frame of the face's body, rounded.
    at: Vector3<f64>,
}

impl<'a> Flush<'a> {
    /// Returns `None` if the normal of the face is no axis of A's frame, if the face is large, or
    /// if f64 is certain that the vertex is not in the face.
    fn new(posed: &'a PosedPair<'a>, of: Operand, face: FaceId, vertex: VertexId) -> Option<Self> {
        let k = vertex.index();
        let (outward, normal, at) = match of {
            Operand::A => {
                let n = posed.a.planes[face.index()].normal;
                (n, n, posed.point_in_a(&posed.b.points[k]))
            }
            Operand::B => {
                let n = posed.b.planes[face.index()].normal;
                (n, -posed.vector_in_a(&n), posed.point_in_b(&posed.a.points[k]))
            }
        };
        let normal = normal.map(|x| f64::from(signum(x)));
        let flush = Self {
            posed,
            of,
            face,
            vertex,
            normal,
            outward,
            at,
        };
        let is_axis = normal.iter().filter(|x| **x == 0.0).count() == 2;
        let ring = flush.body().0.topology.ring(face);
        let is_small = ring.is_none_or(|ring| ring.len() <= MOST_EDGES);
        (is_axis && is_small && flush.is_near() && flush.containing(|_| 1).is_some()).then_some(flush)
    }

    /// Returns the body of the face, and a vertex of the face.
    fn body(&self) -> (&'a ConvexPolyhedron, VertexId) {
        let body = if self.of == Operand::A {
            self.posed.a
        } else {
            self.posed.b
        };
        (body, body.topology.from(body.topology.rim_half_edge(self.face)))
    }

    /// Returns a vertex of A and a vertex of B: the vertex, and one of the face.
    fn vertices(&self) -> [VertexId; 2] {
        let (_, on_face) = self.body();
        if self.of == Operand::A {
            [on_face, self.vertex]
        } else {
            [self.vertex, on_face]
        }
    }

    /// Returns whether the vertex is in the plane of the face up to rounding.
    fn is_near(&self) -> bool {
        let (body, p) = self.body();
        let gap = self.outward.dot(&(self.at - body.points[p.index()]));
        gap.abs() <= CERTIFICATE * UNIT * self.posed.size()
    }

    /// Returns whether the vertex is in the plane of the face up to the rounding of double-double.
    fn is_nearer(&self) -> bool {
        let (posed, [p, q]) = (self.posed, self.vertices());
        let frame = Transform::<DoubleDouble>::new(posed.a, posed.b, posed.pose);
        let slack = CERTIFICATE * DoubleDouble::UNIT * posed.error_scale::<DoubleDouble>().total();
        frame.is_some_and(|frame| {
            let (p, q) = (posed.a.points[p.index()], frame.point(&posed.b.points[q.index()]));
            let gap = |k: usize| (q[k] - DoubleDouble::from(p[k])).value() * self.normal[k];
            (gap(0) + gap(1) + gap(2)).abs() <= slack
        })
    }

    /// Returns the feature of the face's body that contains the vertex, if the vertex is in the
    /// plane of the face: the face, or an edge or vertex of its boundary. `side` is positive inside
    /// an edge and zero on it. It decides if f64 is not certain.
    ///
    /// A height along the unit vector perpendicular to an edge errs by less than a height in a
    /// certificate. The error of the normal counts in the second order only, because edge and
    /// vertex are in the plane of the face.
    fn containing(&self, side: impl Fn(HalfEdgeId) -> i32) -> Option<Feature> {
        let (body, _) = self.body();
        let t = &body.topology;
        let (mut feature, mut before) = (Feature::Face(self.face), None);
        for h in t.rim(self.face) {
            let [p, q] = [t.from(h), t.half_edge(h).to].each(|v| body.points[v.index()]);
            let inward = self.outward.cross(&(q - p));
            let height = inward.dot(&(self.at - p));
            let slack = CERTIFICATE * UNIT * self.posed.size() * sqrt(inward.norm_squared());
            match if height.abs() > slack { signum(height) } else { side(h) } {
                1 => {}
                0 => {
                    feature = match before {
                        None => Feature::Edge(t.edge(h)),
                        Some(g) if t.half_edge(g).to == t.from(h) => Feature::Vertex(t.from(h)),
                        Some(_) => Feature::Vertex(t.half_edge(h).to),
                    };
                    before = Some(h);
                }
                _ => return None,
            }
        }
        Some(feature)
    }

    /// Returns the features that touch, if the three facts hold.
    fn features(&self) -> Option<FeaturePair> {
        if !self.is_nearer() {
            return None;
        }
        let (posed, [p, q]) = (self.posed, self.vertices());
        let pair = ScaledPair::new(posed.a, posed.b, posed.pose);
        let normal = pair.a.vector(&[0, 1, 2].each(|k| integer(self.normal[k], 0)));
        let up = Direction::new(&posed.a.points, &self.normal, &Vector3::zeros());
        let down = pair.b.along(&neg(&normal), pair.exponent);
        let are_supports = match self.of {
            Operand::A => is_level(posed.a, &up, self.face) && is_top(posed.b, &down, q),
            Operand::B => is_top(posed.a, &up, p) && is_level(posed.b, &down, self.face),
        };
        if !are_supports || !dot(&normal, &pair.corner(p, q).w).is_zero() {
            return None;
        }
        let t = &self.body().0.topology;
        let containing = self.containing(|h| {
            let [from, to] = [t.from(h), t.half_edge(h).to];
            let edge = |body: &RotatedBody| sub(&body.point(to, pair.exponent), &body.point(from, pair.exponent));
            // The outward normal of a face of B is opposite to `normal`.
            let (edge, to_vertex) = match self.of {
                Operand::A => (edge(&pair.a), neg(&pair.corner(from, q).w)),
                Operand::B => (neg(&edge(&pair.b)), pair.corner(p, from).w),
            };
            sign(&dot(&cross(&normal, &edge), &to_vertex))
        })?;
        let vertex = Feature::Vertex(self.vertex);
        Some(match self.of {
            Operand::A => FeaturePair {
                a: containing,
                b: vertex,
            },
            Operand::B => FeaturePair {
                a: vertex,
                b: containing,
            },
        })
    }

    /// Writes the contact of the given features to the draft.
    fn write(&self, features: FeaturePair, draft: &mut Draft) {
        let posed = self.posed;
        let (body, on_face) = self.body();
        let vertex = |body: &ConvexPolyhedron| body.points[self.vertex.index()];
        let (on_a, on_b) = match self.of {
            Operand::A => {
                let level = |k: usize| {
                    if self.normal[k] == 0.0 {
                        self.at[k]
                    } else {
                        body.points[on_face.index()][k]
                    }
                };
                (Vector3::new(level(0), level(1), level(2)), vertex(posed.b))
            }
            Operand::B => (vertex(posed.a), self.at),
        };
        (draft.point_on_a, draft.point_on_b) = (on_a.into(), on_b.into());
        draft.features = features;
        draft.state = ContactState::Touching;
        draft.solver = Solver::Exact;
        draft.normal = Unit::new_unchecked(self.normal);
        (draft.distance, draft.lower, draft.upper) = (0.0, 0.0, 0.0);
    }
}

/// Returns whether all vertices of a face have the same height, so that the face supports its body
/// along `up` or along the opposite direction.
fn is_level<U: Upward>(body: &ConvexPolyhedron, up: &U, face: FaceId) -> bool {
    let t = &body.topology;
    t.rim(face).all(|h| up.rise(t.from(h), t.half_edge(h).to) == 0)
}

/// Returns whether no vertex is higher than `v`.
fn is_top<U: Upward>(body: &ConvexPolyhedron, up: &U, v: VertexId) -> bool {
    up.rise(v, body.support_exact(up, v)) == 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::pose::RelativePose;
    use crate::body::polyhedron::solids::cuboid;
    use crate::convex::exact::separation;
    use crate::rng::Rng;
    use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion};

    /// A cuboid, a pyramid or a prism whose coordinates are short numbers.
    fn body(rng: &mut Rng, unit: f64) -> ConvexPolyhedron {
        let side = |rng: &mut Rng| unit * (1.0 + rng.below(4) as f64);
        let half = Vector3::new(side(rng), side(rng), side(rng));
        match rng.below(3) {
            0 => cuboid(half).unwrap(),
            1 => {
                let points = [
                    [-1., -1., -1.],
                    [1., -1., -1.],
                    [1., 1., -1.],
                    [-1., 1., -1.],
                    [0., 0., 1.],
                ];
                ConvexPolyhedron::from_points(&points.map(|p| Point3::from(Vector3::from(p).component_mul(&half))))
                    .unwrap()
            }
            _ => {
                let around = [[-2., 0.], [-1., -1.], [1., -1.], [2., 0.], [1., 1.], [-1., 1.]];
                let points =
                    [-1., 1.].map(|z| around.map(|[x, y]| Point3::from(Vector3::new(x, y, z).component_mul(&half))));
                ConvexPolyhedron::from_points(&points.concat()).unwrap()
            }
        }
    }

    /// A pose on a lattice, rotated by a half turn or about an axis by any angle.
    fn pose(rng: &mut Rng, unit: f64) -> Isometry3<f64> {
        let axis = Vector3::ith_axis(rng.below(3));
        let angle = *rng.pick(&[0.0, std::f64::consts::PI, 0.3]);
        let turn = UnitQuaternion::from_axis_angle(&axis, angle);
        let turn = if angle > 3.0 {
            UnitQuaternion::new_unchecked(nalgebra::Quaternion::from_imag(*axis))
        } else {
            turn
        };
        let mut at = Vector3::from_fn(|_, _| unit * (rng.below(13) as f64 - 6.0));
        if rng.chance(0.3) {
            let k = rng.below(3);
            at[k] = if rng.chance(0.5) {
                at[k].next_up()
            } else {
                at[k].next_down()
            };
        }
        Isometry3::from_parts(Translation3::from(at), turn)
    }

    /// What is proven agrees with the general search, whose normal and points are not used.
    #[test]
    fn a_proof_agrees_with_the_general_search() {
        let mut rng = Rng::new(75);
        let mut counts = [0; 4];
        for _ in 0..100_000 {
            let unit = *rng.pick(&[1.0, 0.05, 1e-3]);
            let (a, b) = (body(&mut rng, unit), body(&mut rng, unit));
            let pose = RelativePose::new(&pose(&mut rng, unit), &pose(&mut rng, unit)).unwrap();
            let Ok(posed) = PosedPair::new(&a, &b, &pose) else {
                continue;
            };
            let feature = |rng: &mut Rng, body: &ConvexPolyhedron| match rng.below(3) {
                0 => Feature::Vertex(VertexId(rng.below(body.points.len()) as u32)),
                1 => Feature::Edge(
                    body.topology
                        .edge(HalfEdgeId(rng.below(body.topology.half_edge_count()) as u32)),
                ),
                _ => Feature::Face(FaceId(rng.below(body.planes.len()) as u32)),
            };
            for _ in 0..20 {
                let features = FeaturePair {
                    a: feature(&mut rng, &a),
                    b: feature(&mut rng, &b),
                };
                let mut draft = Draft::starting_at(features);
                if !touches(&posed, &mut draft) {
                    continue;
                }
                let hint = features.vertices_of(&a, &b).into();
                let (state, _) = separation(&a, &b, &pose, hint).unwrap();
                assert_eq!(state, ContactState::Touching, "{features}");
                let between = posed.point_in_a(&draft.point_on_b.coords) - draft.point_on_a.coords;
                assert!(
                    between.norm() <= CERTIFICATE * UNIT * posed.size(),
                    "{features}: {between}"
                );
                let rises = |p: &Vector3<f64>, q: &Vector3<f64>| draft.normal.dot(&(q - p));
                let (on_a, slack) = (draft.point_on_a.coords, CERTIFICATE * UNIT * posed.size());
                assert!(a.points.iter().all(|p| rises(p, &on_a) >= -slack), "{features}");
                assert!(
                    b.points.iter().all(|p| rises(&on_a, &posed.point_in_a(p)) >= -slack),
                    "{features}"
                );
                for (body, feature, at) in [
                    (&a, draft.features.a, draft.point_on_a),
                    (&b, draft.features.b, draft.point_on_b),
                ] {
                    let Feature::Vertex(v) = feature else { continue };
                    assert!((body.points[v.index()] - at.coords).norm() <= slack, "{features}");
                }
                let of = [draft.features.a, draft.features.b].map(Feature::dimension);
                counts[of[0].max(of[1])] += 1;
                counts[3] += usize::from(of[0] < of[1]);
            }
        }
        assert!(counts.iter().all(|&n| n > 50), "{counts:?}");
    }
}

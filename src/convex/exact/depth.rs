//! Exact depth: finds the deepest facet in a list that is known to contain it.

use dashu_base::Signed;
use dashu_base::UnsignedAbs;
use dashu_int::IBig;

use crate::base::num::each::Each;
use crate::base::num::extremes::Bounded;
use crate::body::polyhedron::{EdgeId, FaceId, HalfEdgeId, VertexId};
use crate::convex::exact::integer::{Big3, cross, direction, dot, is_zero, neg, root, sign, sub};
use crate::convex::exact::simplex::{ExactPoint, minimize};
use crate::convex::exact::{RotatedBody, ScaledPair, witnesses};
use crate::pair::difference::DifferenceFacet;
use crate::pair::draft::Draft;
use crate::pair::draft::{unit, walk_state};
use crate::pair::outcome::{ContactState, Solver};
use crate::pair::posed::PosedPair;

/// A facet of A - B: a normal of any length, and the height along the normal times this length.
struct ExactFacet {
    normal: Big3,
    height: IBig,
    hint: [VertexId; 2],
}

impl ExactFacet {
    fn is_lower(&self, o: &Self) -> bool {
        let squared = |f: &Self| (&f.height * &f.height, dot(&f.normal, &f.normal));
        let ((h, n), (g, m)) = (squared(self), squared(o));
        h * m < g * n
    }
}

impl RotatedBody<'_> {
    /// Returns an outward normal of a face, of any length. Returns `None` if the vertices of the
    /// face are not coplanar.
    fn normal(&self, face: FaceId, exponent: i32) -> Option<Big3> {
        let t = &self.body.topology;
        let vertex = |h: HalfEdgeId| self.to_user(t.from(h), exponent);
        let base = vertex(t.rim_half_edge(face));
        let from_base = |h: HalfEdgeId| sub(&vertex(h), &base);
        let side = t.rim(face).map(from_base).find(|u| !is_zero(u))?;
        let n = t.rim(face).map(|h| cross(&side, &from_base(h))).find(|n| !is_zero(n))?;
        let is_flat = t.rim(face).all(|h| sign(&dot(&n, &from_base(h))) == 0);
        is_flat.then(|| self.vector(&n))
    }

    /// Returns the vector along an edge.
    fn edge(&self, edge: EdgeId, exponent: i32) -> Big3 {
        let t = &self.body.topology;
        sub(
            &self.point(t.half_edge(edge.half_edge()).to, exponent),
            &self.point(t.from(edge.half_edge()), exponent),
        )
    }
}

impl ScaledPair<'_> {
    /// Returns the facet spanned by a feature pair, or `Ok(None)` if it is not lower than the best.
    ///
    /// Returns an error if the face is not flat, so that the true facets are unknown.
    fn facet(
        &self,
        posed: &PosedPair,
        facet: DifferenceFacet,
        best: Option<&ExactFacet>,
    ) -> Result<Option<ExactFacet>, NotFlat> {
        let hint: [VertexId; 2] = facet.features().vertices_of(posed.a, posed.b).into();
        let normal = match facet {
            DifferenceFacet::FaceVertex(f, _) => self.a.normal(f, self.exponent).ok_or(NotFlat)?,
            DifferenceFacet::VertexFace(_, f) => neg(&self.b.normal(f, self.exponent).ok_or(NotFlat)?),
            DifferenceFacet::Edges(e, f) => {
                let n = cross(&self.a.edge(e, self.exponent), &self.b.edge(f, self.exponent));
                // The origin is inside, so the normal points to the side of the facet.
                let ahead = dot(&n, &self.corner(hint[0], hint[1]).w);
                let (normal, height) = match sign(&ahead) {
                    0 => return Ok(None),
                    1 => (n, ahead),
                    _ => (neg(&n), -ahead),
                };
                // If the pair spans a facet, `ahead` is the facet's height.
                let facet = ExactFacet { normal, height, hint };
                if best.is_some_and(|best| !facet.is_lower(best)) {
                    return Ok(None);
                }
                facet.normal
            }
        };
        let height = dot(&normal, &self.support_exact(&normal, hint).w);
        Ok((height.is_positive() && !height.is_zero()).then_some(ExactFacet { normal, height, hint }))
    }
}

/// Error: a face with vertices that are not coplanar replaces several faces that are not in the
/// list.
struct NotFlat;

/// Computes the depth from the deepest facet of the candidate pairs. Returns whether the depth was
/// found.
///
/// The interiors of the bodies must intersect. The error of the depth is less than one unit in the
/// last place of the stored unit, and the bounds are one such unit on either side.
pub(crate) fn deepest(posed: &PosedPair, facets: &[DifferenceFacet], draft: &mut Draft) -> bool {
    let pair = ScaledPair::new(posed.a, posed.b, posed.pose);
    let mut best: Option<ExactFacet> = None;
    for &features in facets {
        match pair.facet(posed, features, best.as_ref()) {
            Err(NotFlat) => return false,
            Ok(Some(facet)) if best.as_ref().is_none_or(|b| facet.is_lower(b)) => best = Some(facet),
            Ok(_) => {}
        }
    }
    best.is_some_and(|facet| write_facet(posed, &pair, &facet, draft))
}

/// Writes depth, normal, features and witness points of a facet to the draft.
///
/// The foot of the origin on the facet, `n height / n . n`, is a point of A - B, and the vertices
/// around it give the witness points.
fn write_facet(posed: &PosedPair, pair: &ScaledPair, facet: &ExactFacet, draft: &mut Draft) -> bool {
    let ExactFacet { normal, height, hint } = facet;
    let squared = dot(normal, normal);
    let from_foot = |c: ExactPoint| ExactPoint {
        w: [0, 1, 2].each(|k| &c.w[k] * &squared - &normal[k] * height),
        ..c
    };
    let lowest = |n: &Big3| from_foot(pair.support_exact(&neg(n), *hint));
    let Some(at) = minimize([from_foot(pair.support_exact(normal, *hint))].into(), &lowest) else {
        return false;
    };
    let (mut a, mut b) = ([VertexId(0); 4], [VertexId(0); 4]);
    for (k, c) in at.kept.iter().enumerate().take(4) {
        (a[k], b[k]) = (c.a, c.b);
    }
    let den = squared * &pair.denominator * &pair.denominator;
    let exponent = pair.exponent - posed.a.exponent;
    let depth = root(&(height * height).unsigned_abs(), &den.unsigned_abs(), exponent);
    draft.state = ContactState::Overlapping;
    draft.solver = Solver::Exact;
    draft.features = walk_state(posed, &a[..at.kept.len()], &b[..at.kept.len()]);
    (draft.point_on_a, draft.point_on_b) = witnesses(pair, &at);
    draft.normal = unit(&pair.a.rounded.tr_mul(&direction(normal)));
    draft.distance = -depth;
    // The upper bound must not be positive, even if the depth underflows.
    (draft.lower, draft.upper) = (-depth.next_up(), (-depth.next_down()).at_most(0.0));
    true
}

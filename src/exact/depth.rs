//! The deepest facet, exactly: of a list that is known to hold it.

use dashu_base::Signed;
use dashu_base::UnsignedAbs;
use dashu_int::IBig;

use crate::exact::integer::{Big3, cross, direction, dot, is_zero, neg, root, sub};
use crate::exact::simplex::{ExactPoint, minimize, sign};
use crate::exact::{Pair, Turned, witnesses};
use crate::pair::answer::{state_of, unit};
use crate::pair::outcome::{Class, Outcome, Solver};
use crate::pair::posed::PosedPair;
use crate::polyhedron::{Feature, FeaturePair};

/// A facet of the difference: its normal, and its height along that times the normal's length.
struct Facet {
    normal: Big3,
    height: IBig,
    hint: (u32, u32),
}

impl Facet {
    fn is_lower(&self, o: &Self) -> bool {
        let squared = |f: &Self| (&f.height * &f.height, dot(&f.normal, &f.normal));
        let ((h, n), (g, m)) = (squared(self), squared(o));
        h * m < g * n
    }
}

impl Turned<'_> {
    /// A normal of a face, outward and of any length; none where its corners are not in one plane.
    fn normal(&self, face: u32, exponent: i32) -> Option<Big3> {
        let t = &self.body.topology;
        let given = |h: u32| self.to_user(t.from(h), exponent);
        let base = given(t.rim_start(face));
        let from_base = |h: u32| sub(&given(h), &base);
        let side = t.rim(face).map(from_base).find(|u| !is_zero(u))?;
        let n = t.rim(face).map(|h| cross(&side, &from_base(h))).find(|n| !is_zero(n))?;
        let is_flat = t.rim(face).all(|h| sign(&dot(&n, &from_base(h))) == 0);
        is_flat.then(|| self.vector(&n))
    }

    /// The vector along an edge.
    fn edge(&self, edge: u32, exponent: i32) -> Big3 {
        let t = &self.body.topology;
        sub(
            &self.point(t.half_edge(edge).to, exponent),
            &self.point(t.from(edge), exponent),
        )
    }
}

impl Pair<'_> {
    /// The facet of a pair of features: `Ok(None)` where there is none lower than the best, `Err` where it is not known which there are.
    fn facet(&self, posed: &PosedPair, features: FeaturePair, best: Option<&Facet>) -> Result<Option<Facet>, NotFlat> {
        let hint = features.vertices_of(posed.a, posed.b);
        let normal = match (features.a, features.b) {
            (Feature::Face(f), _) => self.a.normal(f.0, self.exponent).ok_or(NotFlat)?,
            (_, Feature::Face(f)) => neg(&self.b.normal(f.0, self.exponent).ok_or(NotFlat)?),
            (Feature::Edge(e), Feature::Edge(f)) => {
                let n = cross(&self.a.edge(e.0, self.exponent), &self.b.edge(f.0, self.exponent));
                // The origin is inside: the facet is ahead of it.
                let ahead = dot(&n, &self.corner(hint.0, hint.1).w);
                let (normal, height) = match sign(&ahead) {
                    0 => return Ok(None),
                    1 => (n, ahead),
                    _ => (neg(&n), -ahead),
                };
                // If it is a facet, this is its height.
                let facet = Facet { normal, height, hint };
                if best.is_some_and(|best| !facet.is_lower(best)) {
                    return Ok(None);
                }
                facet.normal
            }
            _ => return Ok(None),
        };
        let height = dot(&normal, &self.support_exact(&normal, hint).w);
        Ok((height.is_positive() && !height.is_zero()).then_some(Facet { normal, height, hint }))
    }
}

/// A face whose corners are not in one plane: it stands for several that are not listed.
struct NotFlat;

/// Takes the depth from the deepest facet of those that the pairs of features may span, of bodies whose interiors meet; whether
/// it could. The depth is right to less than one unit in the last place of the stored unit, and the bounds are one such unit beside it.
pub(crate) fn deepest(posed: &PosedPair, facets: &[FeaturePair], outcome: &mut Outcome) -> bool {
    let pair = Pair::new(posed.a, posed.b, posed.pose);
    let mut best: Option<Facet> = None;
    for &features in facets {
        match pair.facet(posed, features, best.as_ref()) {
            Err(NotFlat) => return false,
            Ok(Some(facet)) if best.as_ref().is_none_or(|b| facet.is_lower(b)) => best = Some(facet),
            Ok(_) => {}
        }
    }
    best.is_some_and(|facet| take(posed, &pair, &facet, outcome))
}

/// The foot of the origin on the facet, `n height / n . n`, is a point of the difference: its vertices are the witnesses'.
fn take(posed: &PosedPair, pair: &Pair, facet: &Facet, outcome: &mut Outcome) -> bool {
    let Facet { normal, height, hint } = facet;
    let squared = dot(normal, normal);
    let from_foot = |c: ExactPoint| ExactPoint {
        w: [0, 1, 2].map(|k| &c.w[k] * &squared - &normal[k] * height),
        ..c
    };
    let lowest = |n: &Big3| from_foot(pair.support_exact(&neg(n), *hint));
    let Some(at) = minimize([from_foot(pair.support_exact(normal, *hint))].into(), &lowest) else {
        return false;
    };
    let (mut a, mut b) = ([0; 4], [0; 4]);
    for (k, c) in at.kept.iter().enumerate().take(4) {
        (a[k], b[k]) = (c.a, c.b);
    }
    let den = squared * &pair.denominator * &pair.denominator;
    let exponent = pair.exponent - posed.a.exponent;
    let depth = root(&(height * height).unsigned_abs(), &den.unsigned_abs(), exponent);
    outcome.class = Class::Overlapping;
    outcome.solver = Solver::Exact;
    outcome.features = state_of(posed, &a[..at.kept.len()], &b[..at.kept.len()]);
    (outcome.point_on_a, outcome.point_on_b) = witnesses(pair, &at);
    outcome.normal = unit(&pair.a.rounded.tr_mul(&direction(normal)));
    outcome.distance = -depth;
    // A depth below the least number is no distance.
    (outcome.lower, outcome.upper) = (-depth.next_up(), (-depth.next_down()).min(0.0));
    true
}

//! A local depth: the height of a facet of P = A - B that is the nearest in its neighbourhood.
//!
//! The height of any facet bounds the depth from above, as the facet lies in a supporting plane; a
//! descent finds the facet ([`descent`](super::descent)). What is left to prove is the overlap: by
//! the pyramid over the facet, whose apex is the difference of two points inside the bodies, else
//! by four points around the origin ([`overlap_proof`](crate::minimum::overlap_proof)), which are
//! kept.
//!
//! The pyramid lies in P, so the distance of its nearest side is a lower bound of the depth, and
//! the depth is the height if no side is nearer than the facet. [`pyramid`](super::pyramid) does
//! more for a proof of the depth: it looks beyond sides that are too near. Here the depth stays
//! open.

use crate::depth::descent::{Descent, LowFacet, descend};
use crate::depth::foot::{flush, foot, sample_rim};
use crate::depth::memory::Memory;
use crate::depth::nearest::{NearestFeature, touch_or_open};
use crate::depth::result::{Best, SearchResult};
use crate::depth::write_overlap;
use crate::minimum::overlap_proof::OverlapProof;
use crate::num::packed::PackedVec3;
use crate::num::scalar::sqrt;
use crate::pair::draft::Draft;
use crate::pair::edge::EdgeSpan;
use crate::pair::posed::PosedPair;
use crate::polyhedron::{Feature, FeaturePair};
use crate::tolerance::{AGREE_DEPTH, CERTIFICATE, ORIENTATION, UNIT};

/// Writes the height of the facet on which a descent from the features `from` ends, if the bodies
/// are proven to overlap.
pub(crate) fn local_depth(
    posed: &PosedPair,
    from: FeaturePair,
    (memory, proof): (&mut Memory, &mut Option<OverlapProof>),
    draft: &mut Draft,
) -> NearestFeature {
    if !posed.same_scale() {
        return NearestFeature::Open(None);
    }
    let facet = match descend(posed, from, &mut draft.work.facets) {
        Descent::Facet(facet) => facet,
        Descent::Outside(facet) => return NearestFeature::Apart(facet),
        Descent::Lost => return NearestFeature::Open(None),
    };
    let Some(found) = overlap_at(posed, &facet, proof, draft) else {
        return touch_or_open(posed, &facet, draft);
    };
    memory.clear();
    memory.move_to(facet.features);
    write_overlap(posed, &found, draft);
    NearestFeature::Proven
}

/// Returns the height of a facet as the depth if the bodies are proven to overlap.
#[inline(always)]
fn overlap_at(
    posed: &PosedPair,
    facet: &LowFacet,
    proof: &mut Option<OverlapProof>,
    draft: &mut Draft,
) -> Option<SearchResult<f64>> {
    let (features, best) = (facet.features, facet.best(posed)?);
    let at = best.rounded();
    let own = foot(posed, features, &at).map(|witnesses| (features, witnesses));
    let (witness_features, witnesses) = own.or_else(|| flush(posed, features, &at))?;
    let radius = match pyramid_radius(posed, features, &best) {
        Some(radius) => radius,
        None if is_enclosed(posed, features, proof, draft) => 0.0,
        None => return None,
    };
    Some(SearchResult {
        features: Some(witness_features),
        ..SearchResult::of_facet(&best, witnesses, radius)
    })
}

/// Returns whether four points enclose the origin: those kept, or those that the solver finds.
#[cold]
fn is_enclosed(posed: &PosedPair, facet: FeaturePair, proof: &mut Option<OverlapProof>, draft: &mut Draft) -> bool {
    let mut solved = *draft;
    *proof = proof.unwrap_or_default().renewed(posed, facet, &mut solved);
    draft.work = solved.work;
    proof.is_some()
}

/// Returns the radius of a ball about the origin that the pyramid over a facet contains; `None` if
/// the origin is not certainly inside the pyramid.
fn pyramid_radius(posed: &PosedPair, facet: FeaturePair, best: &Best<f64>) -> Option<f64> {
    let on_a = |p: &_| PackedVec3::new(p);
    let on_b = |q: &_| posed.rotation.times(PackedVec3::new(q)) + posed.translation;
    let (a, b) = (posed.a, posed.b);
    // The means of the vertices lie in the bodies up to rounding, and off the surface of solid
    // bodies.
    let apex = on_a(&a.vertex_mean) - on_b(&b.vertex_mean);
    let normal = PackedVec3::new(&best.normal.into());
    let pyramid = |apex, normal| Pyramid::new(posed, best, apex, normal);
    match (facet.a, facet.b) {
        (Feature::Face(f), Feature::Vertex(v)) => {
            let q = on_b(&b.points[v.index()]);
            let corner = |h| on_a(&a.points[a.topology.from(h).index()]) - q;
            pyramid(apex, normal).over(sample_rim(a, f).map(corner))
        }
        (Feature::Vertex(v), Feature::Face(f)) => {
            // Reflected in the origin, so that the facet is turned like the face.
            let p = on_a(&a.points[v.index()]);
            let corner = |h| on_b(&b.points[b.topology.from(h).index()]) - p;
            pyramid(-apex, -normal).over(sample_rim(b, f).map(corner))
        }
        (Feature::Edge(e), Feature::Edge(g)) => {
            let (e, g) = (EdgeSpan::new(a, e), EdgeSpan::new(b, g));
            let (p, q, x, y) = (on_a(&e.p), on_a(&e.q), on_b(&g.p), on_b(&g.q));
            let is_left = normal.dot((q - p).cross(x - y)) > 0.0;
            let (p, q) = if is_left { (p, q) } else { (q, p) };
            pyramid(apex, normal).over([p - x, q - x, q - y, p - y].into_iter())
        }
        _ => None,
    }
}

/// A pyramid over a facet, given by the corners of the facet counter-clockwise as seen from
/// outside.
struct Pyramid {
    apex: PackedVec3,
    normal: PackedVec3,
    /// Least height of a corner of the facet along the normal.
    least_height: f64,
    /// Rounding of the orientation of a side, see [`ORIENTATION`].
    noise: f64,
    /// Square of the height of the plane of the nearest side: a quotient, as a comparison of
    /// products would be of degree ten and leave f64 (see [`tolerance`](crate::tolerance)).
    nearest_squared: f64,
    height: f64,
    margin: f64,
}

impl Pyramid {
    #[inline(always)]
    fn new(posed: &PosedPair, best: &Best<f64>, apex: PackedVec3, normal: PackedVec3) -> Self {
        let size = posed.size();
        Self {
            apex,
            normal,
            least_height: best.height - 0.5 * AGREE_DEPTH * size,
            noise: ORIENTATION * size,
            nearest_squared: f64::INFINITY,
            height: best.height,
            margin: 2.0 * CERTIFICATE * UNIT * size,
        }
    }

    /// Returns the radius of a ball about the origin that the pyramid over these corners contains.
    #[inline(always)]
    fn over(mut self, mut corners: impl Iterator<Item = PackedVec3>) -> Option<f64> {
        let first = corners.next()?;
        let mut from = first;
        for to in corners {
            if !self.is_behind(from, to) {
                return None;
            }
            from = to;
        }
        if !self.is_behind(from, first) {
            return None;
        }
        let radius = sqrt(self.nearest_squared).min(self.height);
        // Comparisons with NaN are false.
        (radius > self.margin).then_some(radius)
    }

    /// Returns whether the origin lies certainly behind the side over an edge of the facet, and the
    /// edge begins in the plane of the facet.
    #[inline(always)]
    fn is_behind(&mut self, from: PackedVec3, to: PackedVec3) -> bool {
        let PyramidSide { n, height, squares } = PyramidSide::new(self.apex, from, to);
        let low = height - self.noise * squares;
        self.nearest_squared = self.nearest_squared.min(low * low / n.norm_squared());
        low > 0.0 && self.normal.dot(from) >= self.least_height
    }
}

/// A side of a pyramid.
pub(crate) struct PyramidSide {
    pub(crate) n: PackedVec3,
    /// Depth of the origin behind the side, times the length of `n`.
    pub(crate) height: f64,
    /// The sum of the squares of both edges.
    pub(crate) squares: f64,
}

impl PyramidSide {
    #[inline(always)]
    pub(crate) fn new(apex: PackedVec3, from: PackedVec3, to: PackedVec3) -> Self {
        let (u, v) = (from - to, apex - to);
        let n = u.cross(v);
        Self {
            n,
            height: n.dot(to),
            squares: u.norm_squared() + v.norm_squared(),
        }
    }
}

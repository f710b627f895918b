//! A search that begins at a facet: the first tetrahedron joins three points of the facet to a
//! point deep in P = A - B.
//!
//! The facet found by a descent is mostly the deepest, so that its height is a target from the
//! start, and the surface grows only where P is in doubt. The bodies need not be known to overlap:
//! the tetrahedron proves that they do.

use crate::base::num::scalar::{Vec3, cross, dot, neg, sub};
use crate::body::polyhedron::VertexId;
use crate::convex::depth::foot::sample_rim;
use crate::convex::depth::result::{Best, SearchEnd, SearchResult};
use crate::convex::depth::search::DepthSearch;
use crate::convex::depth::surface::EnclosingSurface;
use crate::convex::minimum::simplex::Simplex;
use crate::pair::difference::{MinkowskiPoint, difference_point, support};
use crate::pair::difference_facet::DifferenceFacet;
use crate::pair::posed::PosedPair;
use crate::pair::transform::Transform;

/// Searches for the depth from a facet; `None` if the search does not close.
pub(super) fn search_from(
    posed: &PosedPair,
    frame: &Transform<f64>,
    facet: DifferenceFacet,
    surface: &mut EnclosingSurface<f64>,
) -> Option<SearchResult<f64>> {
    let (normal, height) = facet.height(posed, frame)?;
    let (v, w) = facet.features().vertices_of(posed.a, posed.b);
    let apex = support(posed, frame, &neg(&normal), &difference_point(posed, frame, v, w));
    let [p, q, r] = pierced(posed, frame, facet, &normal, &apex.w)?;
    let simplex = Simplex::tetrahedron([p, q, r, apex], posed.error_scale::<f64>());
    if !surface.start(simplex.points()) {
        return None;
    }
    let best = Best {
        normal,
        height,
        facet: Some(facet),
    };
    let found = DepthSearch::resumed(posed, frame, surface, best).run(frame, 0.0);
    (found.end == SearchEnd::Closed).then_some(found)
}

/// Returns the triangle of a facet through which the ray from `apex` to the origin leaves.
fn pierced(
    posed: &PosedPair,
    frame: &Transform<f64>,
    facet: DifferenceFacet,
    normal: &Vec3<f64>,
    apex: &Vec3<f64>,
) -> Option<[MinkowskiPoint<f64>; 3]> {
    let along = neg(apex);
    let point = |(a, b): (VertexId, VertexId)| difference_point(posed, frame, a, b);
    // Whether the ray passes to the left of the way from `p` to `q`, seen along the ray.
    let is_left = |p: &MinkowskiPoint<f64>, q: &MinkowskiPoint<f64>| {
        dot(&along, &cross(&sub(&p.w, apex), &sub(&q.w, apex))) >= 0.0
    };
    let corner = |k: u32, v: VertexId, w: VertexId| if k == 0 { (v, w) } else { (w, v) };
    let (first, rest) = match facet {
        DifferenceFacet::Edges(e, g) => {
            let (t, u) = (&posed.a.topology, &posed.b.topology);
            let (e, g) = (e.half_edge(), g.half_edge());
            let ((p, q), (x, y)) = ((t.from(e), t.half_edge(e).to), (u.from(g), u.half_edge(g).to));
            let c = [(p, x), (q, x), (q, y), (p, y)].map(point);
            let n = cross(&sub(&c[1].w, &c[0].w), &sub(&c[3].w, &c[0].w));
            let [p, q, r, s] = if dot(&n, normal) > 0.0 {
                c
            } else {
                [c[3], c[2], c[1], c[0]]
            };
            return Some(if is_left(&p, &r) { [p, r, s] } else { [p, q, r] });
        }
        DifferenceFacet::FaceVertex(f, v) => ((0, v), sample_rim(posed.a, f)),
        DifferenceFacet::VertexFace(v, f) => ((1, v), sample_rim(posed.b, f)),
    };
    let (side, other) = first;
    let body = if side == 0 { posed.a } else { posed.b };
    let corners = rest.map(|h| point(corner(side, body.topology.from(h), other)));
    fan_triangle(corners, side == 0, is_left)
}

/// Returns the triangle of the fan of a polygon about its first corner that lies on the ray.
fn fan_triangle(
    mut corners: impl Iterator<Item = MinkowskiPoint<f64>>,
    counter_clockwise: bool,
    is_left: impl Fn(&MinkowskiPoint<f64>, &MinkowskiPoint<f64>) -> bool,
) -> Option<[MinkowskiPoint<f64>; 3]> {
    let (root, mut from) = (corners.next()?, corners.next()?);
    let mut last = None;
    for to in corners {
        last = Some([root, from, to]);
        if is_left(&root, &to) != counter_clockwise {
            break;
        }
        from = to;
    }
    last
}

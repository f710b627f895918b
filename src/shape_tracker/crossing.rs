//! The outcomes along the normals of pairs of edges that cross, whatever the closest features are.

use nalgebra::{Point3, Unit, Vector3};

use crate::num::scalar::sqrt;
use crate::pair::outcome::{Class, Outcome};
use crate::polyhedron::{ConvexPolyhedron, EdgeId, Feature, FeaturePair};
use crate::pose::RelativePose;
use crate::tolerance::PARALLEL;

/// An edge: where it begins, its direction with its length, and the directions in its two faces
/// perpendicular to it.
#[derive(Clone, Copy)]
struct Edge {
    id: EdgeId,
    from: Vector3<f64>,
    along: Vector3<f64>,
    inward: [Vector3<f64>; 2],
}

/// The edges of a body between two faces.
fn edges(body: &ConvexPolyhedron) -> impl Iterator<Item = Edge> + '_ {
    body.edges().filter_map(|id| {
        let [from, to] = body.edge_vertices(id)?.map(|v| body.vertex(v));
        let [left, right] = body.edge_faces(id)?.map(|f| body.face_plane(f));
        let (from, along) = (from?.coords, to? - from?);
        Some(Edge {
            id,
            from,
            along,
            inward: [left?.0.cross(&along), along.cross(&right?.0)],
        })
    })
}

/// Returns an outcome for each pair of edges that cross and bear a facet of the Minkowski
/// difference: the gap along the normal of the facet, a lower bound of the signed distance right up
/// to rounding, that says nothing about an upper one. Takes time in proportion to the product of
/// the edges.
pub(crate) fn across_edges<'a>(
    a: &'a ConvexPolyhedron,
    b: &'a ConvexPolyhedron,
    a_from_b: &RelativePose,
) -> impl Iterator<Item = Outcome> + 'a {
    let (rotation, translation) = (a_from_b.rotation(), a_from_b.translation());
    let placed: alloc::vec::Vec<Edge> = edges(b)
        .map(|e| Edge {
            from: rotation * e.from + translation,
            along: rotation * e.along,
            inward: e.inward.map(|d| rotation * d),
            ..e
        })
        .collect();
    let of = move |e: Edge| {
        let crossed = placed.iter().filter_map(|f| crossing(&e, f));
        crossed.collect::<alloc::vec::Vec<_>>()
    };
    edges(a).flat_map(of).map(move |c| {
        let on_b = rotation.tr_mul(&(c.on_b - translation));
        Outcome {
            class: if c.gap > 0.0 {
                Class::Separated
            } else {
                Class::Overlapping
            },
            distance: c.gap,
            lower: c.gap,
            upper: c.gap,
            point_on_a: Point3::from(c.on_a),
            point_on_b: Point3::from(on_b),
            normal: Unit::new_unchecked(c.normal),
            ..Outcome::starting_at(c.features)
        }
    })
}

/// Two edges that cross, seen along their common normal.
struct Crossing {
    features: FeaturePair,
    normal: Vector3<f64>,
    gap: f64,
    on_a: Vector3<f64>,
    on_b: Vector3<f64>,
}

fn crossing(e: &Edge, f: &Edge) -> Option<Crossing> {
    let n = e.along.cross(&f.along);
    let square = n.norm_squared();
    if !(square > PARALLEL * e.along.norm_squared() * f.along.norm_squared()) {
        return None;
    }
    // The normal leaves both faces of A's edge and looks into both of B's.
    let heights = [e.inward[0], e.inward[1], -f.inward[0], -f.inward[1]].map(|d| n.dot(&d));
    let n = match heights {
        _ if heights.iter().all(|h| *h <= 0.0) => n / sqrt(square),
        _ if heights.iter().all(|h| *h >= 0.0) => n / -sqrt(square),
        _ => return None,
    };
    let between = f.from - e.from;
    let across = e.along.cross(&f.along);
    let s = between.cross(&f.along).dot(&across) / square;
    let t = between.cross(&e.along).dot(&across) / square;
    ((0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t)).then(|| Crossing {
        features: FeaturePair {
            a: Feature::Edge(e.id),
            b: Feature::Edge(f.id),
        },
        normal: n,
        gap: n.dot(&between),
        on_a: e.from + e.along * s,
        on_b: f.from + f.along * t,
    })
}

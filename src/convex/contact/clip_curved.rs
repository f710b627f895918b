//! Contacts of curved shapes: the overlap of two facets projected along the normal.
//!
//! Candidates are the vertices of each facet over the other one (for a round face, the eight named
//! points of its rim), and the crossings of their boundaries. The points of a rim are fixed on the
//! shape. So the contacts of a shape that rests and trembles do not move either. The price is
//! depth: the deepest contact may be shallower than the outcome by [`ROUND`] times the radius.

use nalgebra::Vector3;

use super::bearing::{Facet, ProjectedFacet};
use super::clip::{Candidates, ContactCandidate, Location, crossing};
use super::projection::Axes;
use super::{Choice, ContactPoint, Contacts, Manifold, Query, tangents_of};
use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{ACROSS, AGREE};
use crate::body::polyhedron::FeaturePair;
use crate::pair::outcome::{Outcome, Solver};

/// Depths of contacts of a flat round face count as equal within this factor times the radius of
/// the smaller shape. Contacts on a shape that trembles then do not move, at the price of depth.
/// Tilted by `t`, a rim is deepest between two of its eight named points, by up to `0.08 t` radii
/// more. So contacts do not move up to a tilt of 2e-4.
const ROUND: f64 = 1.0 / 65_536.0;

/// Maximum number of Newton steps to a crossing of two rims. Convergence is quadratic, from an
/// error of the order of the squared sine of the angle between the faces, but slow at rims that
/// nearly touch along a tangent: these have no crossing in most cases, and need not have one.
const NEWTON: usize = 8;

/// Returns the contacts of two facets, for the outcome of two cores.
pub(super) fn contacts(query: &Query, outcome: &Outcome, facets: [Facet; 2], before: &Manifold) -> Contacts {
    let mut contacts = Contacts::of_witnesses(outcome, before);
    if outcome.solver == Solver::Far {
        return contacts;
    }
    let (axes, distance) = axes_of(query, outcome);
    // The witness points of an overlap that is known to an interval may be less deep than the
    // outcome. They are deeper than the proven bound only by the error of their positions.
    let distance = distance.larger(outcome.lower);
    contacts.points[0].separation = distance;
    let previous = before.features();
    let patch = |side: usize, closest, previous| {
        ProjectedFacet::new(&facets[side], &axes[side], closest, query.options, previous, side)
    };
    let patches = [
        patch(0, outcome.features.a, previous.map(|f| f.a)),
        patch(1, outcome.features.b, previous.map(|f| f.b)),
    ];
    if patches.iter().any(|p| p.count == 0) {
        return contacts;
    }
    contacts.features = FeaturePair {
        a: patches[0].feature,
        b: patches[1].feature,
    };
    let noise = ACROSS * query.size();
    let mut candidates = Candidates::new(distance, query.options.prediction);
    clip(&patches, noise, query.options.max_face_sine, &mut candidates);
    let is_round = patches.iter().any(|p| p.circle.is_some());
    let tie = if is_round { ROUND * query.least_radius() } else { noise };
    let deep = outcome.upper + AGREE * query.size() + tie;
    if !candidates.all().iter().any(|c| c.separation <= deep) {
        candidates.push([0.0; 2], [0.0; 2], ContactCandidate::WITNESS);
    }
    let choice = Choice {
        before,
        is_steady: true,
        most: query.options.most(),
        merge: noise.larger(query.options.rebuild_motion * query.least_radius()),
        tie,
    };
    contacts.choose(candidates.all(), &choice, |candidate| {
        let point = if candidate.on == ContactCandidate::WITNESS {
            ContactPoint {
                separation: candidate.separation,
                ..ContactPoint::witness(outcome)
            }
        } else {
            contact(candidate, &axes, &patches)
        };
        (point, 0.0)
    });
    contacts
}

/// Returns the contact axes in the frame of each shape, and the signed distance of their origins
/// along the normal.
///
/// The origins are the witness on A and the point opposite, at the height of the witness on B.
/// Witness points determine a length to within rounding, but a direction only to the square root of
/// rounding.
fn axes_of(query: &Query, outcome: &Outcome) -> ([Axes; 2], f64) {
    let normal = outcome.normal.into_inner();
    let (on_a, on_b) = (outcome.point_on_a.coords, outcome.point_on_b.coords);
    let between = query.rotation * on_b + query.translation - on_a;
    let distance = normal.dot(&between);
    let (tangents, noise) = (tangents_of(&normal), ACROSS * query.size());
    let axes = [
        Axes {
            tangents,
            normal,
            witness: on_a,
            noise,
        },
        Axes {
            tangents: tangents.each(|v| query.rotation.tr_mul(&v)),
            normal: query.rotation.tr_mul(&normal),
            witness: on_b - query.rotation.tr_mul(&(between - normal * distance)),
            noise,
        },
    ];
    (axes, distance)
}

fn contact(candidate: &ContactCandidate, axes: &[Axes; 2], patches: &[ProjectedFacet; 2]) -> ContactPoint {
    let point = |side: usize| {
        let on = candidate.on[side];
        let height = match on.as_vertex() {
            Some(k) => patches[side].points[k][2],
            None => patches[side].height(candidate.at),
        };
        (axes[side].point(candidate.at, height), patches[side].feature_at(on))
    };
    let ((p, a), (q, b)): ((Vector3<f64>, _), _) = (point(0), point(1));
    let features = FeaturePair { a, b };
    ContactPoint {
        point_on_a: p.into(),
        point_on_b: q.into(),
        separation: candidate.separation,
        features,
        id: features,
    }
}

/// Adds the vertices of the overlap of two facets.
fn clip(patches: &[ProjectedFacet; 2], noise: f64, sine: f64, candidates: &mut Candidates) {
    let [a, b] = patches;
    if a.is_segment() && b.is_segment() {
        overlap(patches, sine, noise, candidates);
        return;
    }
    for (side, (of, over)) in [(a, b), (b, a)].into_iter().enumerate() {
        if !over.is_face() {
            continue;
        }
        for (k, p) in of.points[..of.count].iter().enumerate() {
            let at = [p[0], p[1]];
            if over.inside_by(at) >= -noise {
                let (mut heights, mut on) = ([p[2], over.height(at)], [Location::vertex(k), Location::WHOLE]);
                if side == 1 {
                    heights.reverse();
                    on.reverse();
                }
                candidates.push(at, heights, on);
            }
        }
    }
    for i in 0..a.edge_count() {
        for j in 0..b.edge_count() {
            let (p, q) = (a.ends(i), b.ends(j));
            if let Some(crossing) = crossing(&p, &q, noise) {
                candidates.push(crossing.at, crossing.heights, [Location::edge(i), Location::edge(j)]);
            }
        }
        cross_rim(a, i, b, |at, root| {
            candidates.push(
                at,
                [a.height(at), b.height(at)],
                [Location::edge(i), Location::edge(root)],
            );
        });
    }
    for j in 0..b.edge_count() {
        cross_rim(b, j, a, |at, root| {
            candidates.push(
                at,
                [a.height(at), b.height(at)],
                [Location::edge(root), Location::edge(j)],
            );
        });
    }
    cross_rims(a, b, noise, |at, root| {
        candidates.push(
            at,
            [a.height(at), b.height(at)],
            [Location::edge(0), Location::edge(root)],
        );
    });
}

/// Calls `take` with the crossings of a straight edge and the rim of a round face, entry (0) and
/// exit (1).
fn cross_rim(of: &ProjectedFacet, edge: usize, round: &ProjectedFacet, mut take: impl FnMut([f64; 2], usize)) {
    let Some(circle) = &round.circle else { return };
    let [p, q] = of.ends(edge);
    let (from, to) = (round.spoke(circle, [p[0], p[1]]), round.spoke(circle, [q[0], q[1]]));
    let d = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
    let dot = |u: &[f64; 3], v: &[f64; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    let (squared, half) = (dot(&d, &d), dot(&from, &d));
    let inner = half * half - squared * (dot(&from, &from) - circle.radius * circle.radius);
    // A tangent has no crossing, and NaN has none.
    if !(inner > 0.0 && squared > 0.0) {
        return;
    }
    for (root, by) in [-sqrt(inner), sqrt(inner)].into_iter().enumerate() {
        let t = (by - half) / squared;
        if t > 0.0 && t < 1.0 {
            take([p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])], root);
        }
    }
}

/// Calls `take` with the two crossings of the rims of two round faces: of the circles, then by
/// Newton's method of their projections. Crossings that are off a rim by more than `noise` are left
/// out.
fn cross_rims(a: &ProjectedFacet, b: &ProjectedFacet, noise: f64, mut take: impl FnMut([f64; 2], usize)) {
    let (Some(first), Some(second)) = (&a.circle, &b.circle) else {
        return;
    };
    let (c, r, s) = (&first.centre, first.radius, second.radius);
    let d = [second.centre[0] - c[0], second.centre[1] - c[1]];
    let squared = d[0] * d[0] + d[1] * d[1];
    let along = 0.5 * (squared + r * r - s * s) / squared;
    let across = r * r / squared - along * along;
    // NaN, if both centres coincide, is not a crossing.
    if !(across > 0.0) {
        return;
    }
    for (root, by) in [-sqrt(across), sqrt(across)].into_iter().enumerate() {
        let mut at = [c[0] + along * d[0] - by * d[1], c[1] + along * d[1] + by * d[0]];
        for _ in 0..NEWTON {
            let (u, v) = (a.spoke(first, at), b.spoke(second, at));
            let short = |u: &[f64; 3], r: f64| 0.5 * (r * r - u[0] * u[0] - u[1] * u[1] - u[2] * u[2]);
            let (f, g) = (short(&u, r), short(&v, s));
            let (df, dg) = (a.spoke_slope(&u), b.spoke_slope(&v));
            let area = df[0] * dg[1] - df[1] * dg[0];
            at[0] += (f * dg[1] - g * df[1]) / area;
            at[1] += (df[0] * g - dg[0] * f) / area;
        }
        // NaN is off both rims.
        if a.inside_by(at).abs() <= noise && b.inside_by(at).abs() <= noise {
            take(at, root);
        }
    }
}

/// Adds the ends of the overlap of two nearly parallel segments. For other segments it adds
/// nothing, because they cross at the witness points.
///
/// A segment is the highest line of a surface that falls on both sides of it, by `d * d / 2 r` at a
/// lateral distance `d` if the shape has the radius `r` there. The contact is on the segment with
/// the smaller radius, next to the other one. It is left out if it is then below the surface of
/// that one by more than `noise`.
fn overlap([a, b]: &[ProjectedFacet; 2], sine: f64, noise: f64, candidates: &mut Candidates) {
    let direction = |patch: &ProjectedFacet| {
        let [p, q] = patch.ends(0);
        [q[0] - p[0], q[1] - p[1]]
    };
    let (u, v) = (direction(a), direction(b));
    let squared = |d: [f64; 2]| d[0] * d[0] + d[1] * d[1];
    let turn = u[0] * v[1] - u[1] * v[0];
    // NaN is not parallel.
    if !(turn * turn <= sine * sine * squared(u) * squared(v)) {
        return;
    }
    for k in 0..2 {
        for (side, (of, to, u)) in [(a, b, u), (b, a, v)].into_iter().enumerate() {
            let [x, y, height] = of.points[k];
            let [p, q] = to.ends(0);
            let w = [q[0] - p[0], q[1] - p[1]];
            let along = |u: [f64; 2]| ((x - p[0]) * u[0] + (y - p[1]) * u[1]) / (w[0] * u[0] + w[1] * u[1]);
            let (own, other) = (of.radius(k as f64), to.radius(along(w)));
            // The contact is off the segment of the larger radius, perpendicular to that segment.
            let t = if own > other { along(u) } else { along(w) };
            let foot = [0, 1].each(|i| p[i] + t * w[i]);
            let beside = squared([foot[0] - x, foot[1] - y]);
            if t > 0.0 && t < 1.0 && beside <= noise * own.larger(other).larger(noise) {
                let at = if own > other { foot } else { [x, y] };
                let (mut heights, mut on) = ([height, to.height(at)], [Location::vertex(k), Location::WHOLE]);
                if side == 1 {
                    heights.reverse();
                    on.reverse();
                }
                candidates.push(at, heights, on);
            }
        }
    }
}

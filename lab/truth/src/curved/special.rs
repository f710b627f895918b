//! Pairs of curved shapes at special poses: flush over an edge, and near a common axis.

use super::{Kind, Place, matrix, turned_back, wide};
use crate::rng::Rng;

/// Returns a gap from a few units in the last place to 1e-8, of either sign, or zero.
fn gap(rng: &mut Rng) -> f64 {
    let size = *rng.pick(&[0.0, 1e-15, 3e-15, 1e-14, 3e-14, 1e-13, 1e-12, 1e-10, 1e-8]);
    if rng.chance(0.6) { -size } else { size }
}

/// Returns the support value along a direction of a shape rotated by `q`, in `f64`.
fn reach(kind: &Kind, q: [f64; 4], n: [f64; 3]) -> f64 {
    kind.height(&turned_back(&matrix(q), &wide(n))).0
}

/// Returns a box, a cylinder or a cone, with half extents between 0.2 and 1.
pub fn with_flat_face(rng: &mut Rng) -> Kind {
    let (h, r) = (rng.range(0.2, 1.0), rng.range(0.2, 1.0));
    match rng.below(3) {
        0 => {
            let half = [r, rng.range(0.2, 1.0), h];
            let corner = |k: usize| [0, 1, 2].map(|a| if k >> a & 1 == 1 { half[a] } else { -half[a] });
            Kind::Hull((0..8).map(corner).collect())
        }
        1 => Kind::Cylinder(h, r),
        _ => Kind::Cone(h, r),
    }
}

/// Returns two shapes, at least one of them round, with a flat face of one flush on a face or a
/// generator of the other.
///
/// The face extends over the edge by a small amount. Returns the shapes, the pose, the side of A on
/// which B lies (up is 1), and the signed distance, which is a gap.
pub fn flush_over_edge(rng: &mut Rng) -> ([Kind; 2], Place, f64, f64) {
    let (a, b) = loop {
        let (a, b) = (with_flat_face(rng), with_flat_face(rng));
        let is_hull = |kind: &Kind| matches!(kind, Kind::Hull(_));
        if !(is_hull(&a) && is_hull(&b)) {
            break (a, b);
        }
    };
    let half = 0.5f64.sqrt();
    let (up, over, lying) = ([0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 0.0], [0.0, half, 0.0, half]);
    // A cone rests on its base.
    let (side, q, along) = match (&a, &b) {
        (Kind::Cone(..), Kind::Cone(..)) => (-1.0, over, rng.below(2)),
        (Kind::Cone(..), Kind::Cylinder(..)) => (-1.0, *rng.pick(&[up, lying]), 0),
        (Kind::Cone(..), _) => (-1.0, up, rng.below(2)),
        (_, Kind::Cone(..)) => (1.0, up, rng.below(2)),
        (_, Kind::Cylinder(..)) => (*rng.pick(&[-1.0, 1.0]), *rng.pick(&[up, lying]), 0),
        _ => (*rng.pick(&[-1.0, 1.0]), up, rng.below(2)),
    };
    let (mut outward, mut across) = ([0.0; 3], [0.0; 3]);
    (outward[along], across[1 - along]) = (*rng.pick(&[-1.0, 1.0]), 1.0);
    let back = outward.map(|x| -x);
    let widths = [reach(&a, up, outward), reach(&b, q, back)];
    let share = *rng.pick(&[0.5, 0.2, 0.05, 0.01, 1e-3]);
    let overlap = widths[0].min(widths[1]) * share * rng.range(0.5, 1.0);
    let mut t = [0.0; 3];
    t[along] = outward[along] * (widths[0] + widths[1] - overlap);
    // Two discs overlap only near the line of their centres; a disc and a box also overlap away
    // from it.
    if let Some(flat) = [&a, &b].into_iter().find(|kind| matches!(kind, Kind::Hull(_))) {
        t[1 - along] = 0.9 * reach(flat, up, across) * rng.range(-1.0, 1.0);
    }
    let bearing = reach(&a, up, [0.0, 0.0, side]) + reach(&b, q, [0.0, 0.0, -side]);
    t[2] = side * (bearing + gap(rng));
    let apart = side * t[2] - bearing;
    ([a, b], Place::new(q, t), side, apart)
}

/// Returns bodies of revolution about parallel axes, coaxial or nearly so, whose centres differ
/// along the axis by a fraction of their radii.
pub fn about_parallel_axes(rng: &mut Rng) -> ([Kind; 2], Place) {
    let kinds = [0, 1].map(|_| {
        let (h, r) = (rng.range(0.2, 1.0), rng.range(0.2, 1.0));
        if rng.chance(0.5) {
            Kind::Cylinder(h, r)
        } else {
            Kind::Cone(h, r)
        }
    });
    let least = kinds.iter().fold(1.0f64, |least, kind| least.min(kind.radius()));
    let by = *rng.pick(&[0.0, 0.0, 1e-12, 1e-6, 1e-3, 0.2]);
    let aside = level(rng, least * by);
    let up = least * *rng.pick(&[0.0, 0.0, 1e-9, 0.1, 0.3]) * rng.range(-1.0, 1.0);
    let q = *rng.pick(&[[0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.6, 0.8]]);
    let t = [aside[0], aside[1], up];
    (kinds, Place::new(q, t))
}

/// Returns a vector of a length, perpendicular to z.
fn level(rng: &mut Rng, length: f64) -> [f64; 2] {
    let angle = rng.range(0.0, core::f64::consts::TAU);
    [length * angle.cos(), length * angle.sin()]
}

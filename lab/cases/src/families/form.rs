//! Round, thin and flat bodies, and bodies deep in each other.

use super::{assorted, gap, ten};
use crate::Pose;
use crate::maker::{BodyId, Maker};
use crate::pose::{add, scale};
use crate::shapes::{self, Shape};
use std::io::{self, Write};

/// Writes a case of two bodies at random turns, at a signed distance that suits the smaller extent.
fn anywhere<W: Write>(m: &mut Maker<W>, level: &str, a: BodyId, b: BodyId, least: f64) -> io::Result<()> {
    let pose_a = Pose {
        q: m.rng.quat(),
        t: m.rng.unit(),
    };
    let (q, direction) = (m.rng.quat(), m.rng.unit());
    let mut gap = gap(&mut m.rng);
    if gap < 0.0 {
        gap = gap.max(-0.1 * least);
    }
    let pose_b = m.aim(a, &pose_a, b, q, direction, gap);
    m.case(level, a, pose_a, b, pose_b)
}

/// Ordinary bodies at all gaps: what the other families are compared with.
pub(super) fn round<W: Write>(m: &mut Maker<W>) -> io::Result<()> {
    let mut bodies = assorted(m);
    bodies.push(m.body(shapes::icosphere(1)));
    for _ in 0..m.count {
        let (a, b) = (m.pick(&bodies), m.pick(&bodies));
        anywhere(m, "any gap", a, b, 1.0)?;
    }
    Ok(())
}

/// Slivers, needles and plates whose thickness is 1e-2 to 1e-9 of their length.
pub(super) fn thin<W: Write>(m: &mut Maker<W>) -> io::Result<()> {
    let pools: Vec<(i64, Vec<BodyId>)> = [2, 4, 6, 9]
        .map(|e| {
            let thin = ten(-e);
            let mut all = m.bodies(2, |r| shapes::sliver(r, 12, thin));
            all.extend(m.bodies(2, |r| shapes::needle(r, 12, thin)));
            all.extend(m.bodies(2, |r| shapes::ellipsoid(r, 16, [1.0, 0.3, thin])));
            all.push(m.body(shapes::cuboid([1.0, 0.75, thin])));
            all.push(m.body(shapes::cuboid([1.0, thin, thin])));
            (e, all)
        })
        .into();
    let round = m.bodies(3, |r| shapes::sphere(r, 16));
    for k in 0..m.count {
        let (e, pool) = &pools[k % pools.len()];
        let a = m.pick(pool);
        let b = if m.rng.chance(0.3) {
            m.pick(&round)
        } else {
            m.pick(pool)
        };
        anywhere(m, &format!("1e-{e}"), a, b, ten(-e))?;
    }
    Ok(())
}

/// Bodies without volume: points, segments, triangles and polygons.
pub(super) fn flat<W: Write>(m: &mut Maker<W>) -> io::Result<()> {
    let polygon = |n: usize| -> Vec<crate::Point> {
        let mut points = shapes::prism(n, 1.0, 0.0).points;
        points.truncate(n);
        points
    };
    let flats: Vec<(&str, BodyId)> = [
        // At its own origin: it has no size that could cover the rounding of a turn about another.
        ("point", vec![[0.0; 3]]),
        ("segment", vec![[-1.0, 0.0, 0.5], [1.0, 0.25, -0.5]]),
        ("triangle", vec![[0.0, 0.0, 1.0], [1.0, 0.5, 0.0], [-0.5, 1.0, 0.25]]),
        ("polygon", polygon(6)),
        ("polygon", polygon(16)),
    ]
    .map(|(name, points)| (name, m.body(Shape::hull(name, points))))
    .into();
    let solids = assorted(m);
    for k in 0..m.count {
        let (level, a) = flats[k % flats.len()];
        // Two points have no size to which an error could be relative.
        let b = if m.rng.chance(0.3) {
            m.rng.pick(&flats[1..]).1
        } else {
            m.pick(&solids)
        };
        anywhere(m, level, a, b, 0.0)?;
    }
    Ok(())
}

/// Bodies that share most of their volume.
pub(super) fn deep<W: Write>(m: &mut Maker<W>) -> io::Result<()> {
    let large = assorted(m);
    let small = m.bodies(4, |r| shapes::sphere(r, 12).scaled(0.125));
    for k in 0..m.count {
        let a = m.pick(&large);
        let b = if k % 4 == 3 { m.pick(&small) } else { m.pick(&large) };
        let off = [0.0, 1e-9, 1e-3, m.rng.range(0.0, 0.4)][m.rng.below(4)];
        let pose_a = Pose {
            q: m.rng.quat(),
            t: m.rng.unit(),
        };
        let pose_b = Pose {
            q: m.rng.quat(),
            t: add(pose_a.t, scale(m.rng.unit(), off)),
        };
        let level = if k % 4 == 3 { "inside" } else { "through" };
        m.case(level, a, pose_a, b, pose_b)?;
    }
    Ok(())
}

//! Bodies of unusual size, far from the origin, or of very different sizes.

use super::{assorted, gap, ten};
use crate::Pose;
use crate::maker::{BodyId, Maker};
use crate::pose::scale;
use crate::shapes;
use std::io::{self, Write};

/// Writes a case of bodies of size `unit` at a distance `far` from the origin.
fn scaled<W: Write>(m: &mut Maker<W>, level: &str, pair: (BodyId, BodyId), unit: f64, far: f64) -> io::Result<()> {
    let pose_a = Pose {
        q: m.rng.quat(),
        t: scale(m.rng.unit(), far),
    };
    let (q, direction) = (m.rng.quat(), m.rng.unit());
    let gap = unit * gap(&mut m.rng);
    let pose_b = m.aim(pair.0, &pose_a, pair.1, q, direction, gap);
    m.case(level, pair.0, pose_a, pair.1, pose_b)
}

/// Bodies of size 1 at 1e3 to 1e9 from the origin.
pub(super) fn far<W: Write>(m: &mut Maker<W>) -> io::Result<()> {
    let bodies = assorted(m);
    for k in 0..m.count {
        let e = [3, 5, 7, 9][k % 4];
        let pair = (m.pick(&bodies), m.pick(&bodies));
        scaled(m, &format!("1e{e}"), pair, 1.0, ten(e))?;
    }
    Ok(())
}

fn of_size<W: Write>(m: &mut Maker<W>, exponents: [i64; 4]) -> io::Result<()> {
    let pools = exponents.map(|e| {
        let mut all = m.bodies(3, |r| shapes::sphere(r, 12).scaled(ten(e)));
        all.push(m.body(shapes::cuboid([1.0, 0.75, 0.5]).scaled(ten(e))));
        all.push(m.body(shapes::icosahedron().scaled(ten(e))));
        all
    });
    for k in 0..m.count {
        let (e, pool) = (exponents[k % 4], &pools[k % 4]);
        let pair = (m.pick(pool), m.pick(pool));
        scaled(m, &format!("1e{e}"), pair, ten(e), ten(e))?;
    }
    Ok(())
}

/// Bodies of sizes 1e-12 to 1e-2.
pub(super) fn tiny<W: Write>(m: &mut Maker<W>) -> io::Result<()> {
    of_size(m, [-12, -8, -5, -2])
}

/// Bodies of sizes 1e2 to 1e12.
pub(super) fn huge<W: Write>(m: &mut Maker<W>) -> io::Result<()> {
    of_size(m, [2, 5, 8, 12])
}

/// A body and one that is 1e2 to 1e12 times as large.
pub(super) fn ratios<W: Write>(m: &mut Maker<W>) -> io::Result<()> {
    let exponents = [2, 4, 8, 12];
    let small = assorted(m);
    let large = exponents.map(|e| {
        let mut all = m.bodies(2, |r| shapes::sphere(r, 12).scaled(ten(e)));
        all.push(m.body(shapes::cuboid([1.0, 0.75, 0.5]).scaled(ten(e))));
        all
    });
    for k in 0..m.count {
        let pair = (m.pick(&large[k % 4]), m.pick(&small));
        let pair = if m.rng.chance(0.5) { pair } else { (pair.1, pair.0) };
        scaled(m, &format!("1e{}", exponents[k % 4]), pair, 1.0, 1.0)?;
    }
    Ok(())
}

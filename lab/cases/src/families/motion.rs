//! Motions in contact, frame by frame.

use super::{STILL, ten};
use crate::Pose;
use crate::maker::{BodyId, Maker, lowest};
use crate::pose::{add, quat, quat_mul, scale, unit_quat};
use crate::shapes;
use std::io::{self, Write};

/// Frames of a motion.
const FRAMES: usize = 10;

/// Returns a plate whose upper face is the plane z = 0, and bodies that stand on it.
fn stage<W: Write>(m: &mut Maker<W>) -> (BodyId, Vec<BodyId>) {
    let mut plate = shapes::cuboid([2.0, 1.5, 0.25]);
    plate.points.iter_mut().for_each(|p| p[2] -= 0.25);
    let standing = [
        shapes::cuboid([0.5, 0.375, 0.25]),
        shapes::cuboid([1.5, 0.125, 0.25]),
        shapes::prism(8, 0.5, 0.25),
        shapes::octahedron().stretched([0.5, 0.5, 0.25]),
        shapes::icosahedron().scaled(0.25),
    ];
    (m.body(plate), standing.map(|s| m.body(s)).into())
}

/// Returns a small signed distance above the plate.
fn height<W: Write>(m: &mut Maker<W>) -> f64 {
    *m.rng
        .pick(&[0.0, 0.0, 1e-3, 1e-6, 1e-9, 1e-12, 1e-15, -1e-12, -1e-9, -1e-6, -1e-3])
}

/// Writes motions over the plate, half of them in a turned frame.
fn motions<W: Write>(
    m: &mut Maker<W>,
    mut draw: impl FnMut(&mut Maker<W>, BodyId) -> (String, Vec<Pose>),
) -> io::Result<()> {
    let (plate, standing) = stage(m);
    for k in 0..m.count.div_ceil(FRAMES) {
        let b = standing[k % standing.len()];
        let (level, poses) = draw(m, b);
        let frame = Pose {
            q: m.rng.quat(),
            t: m.rng.unit(),
        };
        let frame = if m.rng.chance(0.5) { Pose::IDENTITY } else { frame };
        let poses: Vec<Pose> = poses.iter().map(|p| frame.after(p)).collect();
        m.motion(&level, plate, frame, b, &poses)?;
    }
    Ok(())
}

/// A body that spins on a plate about the vertical, tilted by 1e-4 down to nothing.
pub(super) fn spinning<W: Write>(m: &mut Maker<W>) -> io::Result<()> {
    motions(m, |m, b| {
        let e = *m.rng.pick(&[4, 8, 12, 15, 0]);
        let tilt = if e == 0 { STILL } else { quat(m.rng.unit(), ten(-e)) };
        let (step, gap) = (*m.rng.pick(&[0.001, 0.02, 0.1]), height(m));
        let low = lowest(m.points(b), STILL)[2];
        let at = |k| Pose {
            q: unit_quat(quat_mul(quat([0.0, 0.0, 1.0], step * k as f64), tilt)),
            t: [0.0625, -0.125, gap - low],
        };
        let level = if e == 0 { "flat".into() } else { format!("tilt 1e-{e}") };
        (level, (0..FRAMES).map(at).collect())
    })
}

/// A body at rest on a plate, with noise on its pose.
pub(super) fn resting<W: Write>(m: &mut Maker<W>) -> io::Result<()> {
    motions(m, |m, b| {
        let e = *m.rng.pick(&[3, 6, 9, 12, 15, 0]);
        let noise = if e == 0 { 0.0 } else { ten(-e) };
        let low = lowest(m.points(b), STILL)[2];
        let t = [0.25, -0.5, height(m) - low];
        let mut at = || Pose {
            q: quat(m.rng.unit(), noise * m.rng.range(-1.0, 1.0)),
            t: add(t, scale(m.rng.unit(), noise * m.rng.uniform())),
        };
        let level = if e == 0 {
            "still".into()
        } else {
            format!("noise 1e-{e}")
        };
        (level, (0..FRAMES).map(|_| at()).collect())
    })
}

/// A body that slides over a plate and past its edge, or along an edge within 1e-3 to nothing of
/// the plane where the nearest feature changes.
pub(super) fn sliding<W: Write>(m: &mut Maker<W>) -> io::Result<()> {
    motions(m, |m, b| {
        let low = lowest(m.points(b), STILL)[2];
        let gap = height(m);
        let z = gap - low;
        if m.rng.chance(0.5) {
            let [dx, dy] = [m.rng.int(-6, 6), m.rng.int(1, 6)].map(|n| n as f64 / 32.0);
            let start = [m.rng.int(-64, 64), m.rng.int(24, 40)].map(|n| n as f64 / 32.0);
            let at = |k| Pose::shift([start[0] + dx * k as f64, start[1] + dy * k as f64, z]);
            return ("past an edge".into(), (0..FRAMES).map(at).collect());
        }
        let tip = lowest(m.points(b), STILL);
        let e = *m.rng.pick(&[3, 6, 9, 12, 16]);
        let at = |k| {
            let off = ten(-e) * (k as f64 - 4.0);
            Pose::shift([2.0 - tip[0] + off, 0.05 * k as f64, z])
        };
        (format!("edge within 1e-{e}"), (0..FRAMES).map(at).collect())
    })
}

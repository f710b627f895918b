//! Points and rays against meshes, pairs of meshes, and casts.

use super::{assorted, dyadic_box, quarter_turns, ten};
use crate::maker::{BodyId, Maker};
use crate::pose::{add, cross, scale, sub, unit};
use crate::rng::Rng;
use crate::shapes;
use crate::{ContactState, Point, Pose};
use std::io::{self, Write};

/// Returns closed meshes: two that are convex, and three that are not.
fn meshes<W: Write>(m: &mut Maker<W>) -> Vec<BodyId> {
    [
        shapes::triangulated(&shapes::cuboid([1.0, 0.75, 0.5])),
        shapes::triangulated(&shapes::prism(6, 1.0, 0.5)),
        shapes::bracket(0.5),
        shapes::square_frame(0.25),
        shapes::star(5, 0.375, 0.25),
    ]
    .map(|shape| m.mesh(shape))
    .into()
}

/// Returns a point on a feature of a mesh, and its name.
fn on_feature<W: Write>(m: &mut Maker<W>, mesh: BodyId) -> (&'static str, Point) {
    let triangle = m.triangle(mesh);
    let rng = &mut m.rng;
    let part = |rng: &mut Rng| rng.int(0, 16) as f64 / 16.0;
    match rng.below(3) {
        0 => ("vertex", triangle[0]),
        1 => {
            let s = part(rng);
            ("edge", add(triangle[0], scale(sub(triangle[1], triangle[0]), s)))
        }
        _ => {
            let s = part(rng);
            let t = (1.0 - s) * part(rng);
            let [u, v] = [1, 2].map(|k| sub(triangle[k], triangle[0]));
            ("face", add(triangle[0], add(scale(u, s), scale(v, t))))
        }
    }
}

/// Points on vertices, edges and faces of meshes, beside them down to the last bit, and anywhere.
pub(super) fn points<W: Write>(m: &mut Maker<W>) -> io::Result<()> {
    let meshes = meshes(m);
    for _ in 0..m.count {
        let mesh = m.pick(&meshes);
        if m.rng.chance(0.2) {
            let point = scale(m.rng.in_ball(), 1.5);
            m.point("anywhere", mesh, point)?;
            continue;
        }
        let (name, at) = on_feature(m, mesh);
        if m.rng.chance(0.2) {
            m.point(name, mesh, at)?;
            continue;
        }
        let e = m.rng.int(1, 16);
        let off = if m.rng.chance(0.5) {
            m.rng.unit()
        } else {
            let (axis, sign) = (m.rng.below(3), m.rng.sign());
            std::array::from_fn(|k| if k == axis { sign } else { 0.0 })
        };
        m.point(&format!("{name}, 1e-{e}"), mesh, add(at, scale(off, ten(-e))))?;
    }
    Ok(())
}

/// Two meshes flush on each other, on a lattice (ties), at random turns, equal or nearly so, and a little before and after
/// contact.
pub(super) fn pairs<W: Write>(m: &mut Maker<W>) -> io::Result<()> {
    let meshes = meshes(m);
    for k in 0..m.count {
        let (a, b) = (m.pick(&meshes), m.pick(&meshes));
        let heights = [a, b].map(|id| m.points(id).iter().map(|p| p[2]).fold(0.0, f64::max));
        let rng = &mut m.rng;
        match k % 4 {
            0 if k % 8 == 0 => {
                // All meshes are flat above and below.
                let [x, y] = [(); 2].map(|()| rng.int(-2, 2) as f64 * 0.25);
                let pose_b = Pose::shift([x, y, heights[0] + heights[1]]);
                m.meshes("flush", (a, Pose::IDENTITY), (b, pose_b))?;
            }
            0 => {
                let steps = |rng: &mut Rng| -> Point { std::array::from_fn(|_| rng.int(-4, 4) as f64 * 0.5) };
                let pose_a = Pose::shift(steps(rng));
                let turn = if rng.chance(0.5) {
                    Pose::IDENTITY.q
                } else {
                    quarter_turns(rng)
                };
                let pose_b = Pose::new(turn, steps(rng));
                m.meshes("lattice", (a, pose_a), (b, pose_b))?;
            }
            1 => {
                let (pose_a, far) = (Pose::new(rng.quat(), rng.unit()), rng.range(0.3, 2.5));
                let pose_b = Pose::new(rng.quat(), add(pose_a.t, scale(rng.unit(), far)));
                m.meshes("turned", (a, pose_a), (b, pose_b))?;
            }
            2 => {
                let pose = Pose::new(rng.quat(), rng.unit());
                let e = rng.int(1, 17);
                let by = if e > 16 { [0.0; 3] } else { scale(rng.unit(), ten(-e)) };
                m.meshes(&format!("equal, 1e-{e}"), (a, pose), (a, pose.shifted(by)))?;
            }
            _ => {
                let (pose_a, q, way) = (Pose::new(rng.quat(), rng.unit()), rng.quat(), rng.unit());
                let at = |far: f64| Pose::new(q, add(pose_a.t, scale(way, far)));
                let (mut near, mut far) = (0.0, 4.0);
                for _ in 0..44 {
                    let middle = 0.5 * (near + far);
                    if m.state((a, pose_a), (b, at(middle))) == ContactState::Separated {
                        far = middle;
                    } else {
                        near = middle;
                    }
                }
                let e = m.rng.int(1, 15);
                let by = m.rng.sign() * ten(-e);
                m.meshes(&format!("near, 1e-{e}"), (a, pose_a), (b, at(far + by)))?;
            }
        }
    }
    Ok(())
}

/// Convex bodies that meet head on, pass each other closely or graze, and slide along a face.
pub(super) fn casts<W: Write>(m: &mut Maker<W>) -> io::Result<()> {
    let bodies = assorted(m);
    for k in 0..m.count {
        if k % 4 == 0 {
            let ((a, half_a), (b, half_b)) = (dyadic_box(&mut m.rng), dyadic_box(&mut m.rng));
            let [a, b] = [m.body(a), m.body(b)];
            let rng = &mut m.rng;
            let sum = add(half_a, half_b);
            let axis = rng.below(3);
            let away = -rng.sign() * (sum[axis] + rng.int(0, 4) as f64 / 4.0);
            let at: Point = std::array::from_fn(|k| {
                if k == axis {
                    away
                } else {
                    // Flush, or over a corner, an edge or a face.
                    *rng.pick(&[0.0, sum[k], -sum[k], 0.5 * sum[k]])
                }
            });
            let reach = *rng.pick(&[1.0, 2.0, 4.0, 8.0]);
            let velocity: Point = std::array::from_fn(|k| if k == axis { -away.signum() * reach } else { 0.0 });
            m.cast("lattice", (a, Pose::IDENTITY), (b, Pose::shift(at)), velocity)?;
            continue;
        }
        let (a, b) = (m.pick(&bodies), m.pick(&bodies));
        let rng = &mut m.rng;
        let (pose_a, q, direction) = (Pose::new(rng.quat(), rng.unit()), rng.quat(), rng.unit());
        let (e, sign) = (rng.int(1, 15), rng.sign());
        let gap = if rng.chance(0.1) { 0.0 } else { sign * ten(-e) };
        // The closest moment, and the way there.
        let there = m.aim(a, &pose_a, b, q, direction, gap);
        let rng = &mut m.rng;
        let reach = rng.range(2.0, 6.0);
        let (level, way) = if rng.chance(0.5) {
            let normal = unit(sub(there.t, pose_a.t));
            (format!("past, 1e-{e}"), unit(cross(normal, rng.unit())))
        } else {
            (format!("into, 1e-{e}"), rng.unit())
        };
        let velocity = scale(way, reach);
        let pose_b = there.shifted(scale(velocity, -rng.range(0.3, 0.7)));
        m.cast(&level, (a, pose_a), (b, pose_b), velocity)?;
    }
    Ok(())
}

/// Rays at vertices, edges and faces of meshes, and past them down to the last bit.
pub(super) fn rays<W: Write>(m: &mut Maker<W>) -> io::Result<()> {
    let meshes = meshes(m);
    for k in 0..m.count {
        let mesh = m.pick(&meshes);
        let (name, at) = on_feature(m, mesh);
        let rng = &mut m.rng;
        if k % 3 == 0 {
            let (axis, sign) = (rng.below(3), rng.sign());
            let along = |x: f64| -> Point { std::array::from_fn(|k| if k == axis { sign * x } else { 0.0 }) };
            m.ray(&format!("{name}, axis"), mesh, sub(at, along(2.0)), along(4.0))?;
            continue;
        }
        let (way, far) = (rng.unit(), rng.range(1.0, 3.0));
        let e = rng.int(1, 16);
        let to = add(at, scale(rng.unit(), if rng.chance(0.2) { 0.0 } else { ten(-e) }));
        let origin = add(at, scale(way, far));
        let direction = scale(sub(to, origin), rng.range(0.8, 2.0));
        m.ray(&format!("{name}, 1e-{e}"), mesh, origin, direction)?;
    }
    Ok(())
}

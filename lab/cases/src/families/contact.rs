//! Bodies that touch, or almost touch, along faces and edges.

use super::{STILL, assorted, dyadic_box, gap, quarter_turns, ten};
use crate::maker::{BodyId, Maker, lowest};
use crate::pose::{add, quat, quat_mul, scale, sub, unit, unit_quat};
use crate::rng::Rng;
use crate::shapes::{self, Shape};
use crate::{Point, Pose};
use std::io::{self, Write};

/// Returns a common pose of both bodies, and its name.
fn common(rng: &mut Rng) -> (&'static str, Pose) {
    match rng.below(3) {
        0 => ("still", Pose::IDENTITY),
        1 => (
            "quarter turns",
            Pose {
                q: quarter_turns(rng),
                t: [(); 3].map(|()| rng.int(-8, 8) as f64 / 4.0),
            },
        ),
        _ => (
            "turned",
            Pose {
                q: rng.quat(),
                t: rng.unit(),
            },
        ),
    }
}

fn shifted(mut shape: Shape, by: Point) -> Shape {
    shape.points.iter_mut().for_each(|p| *p = add(*p, by));
    shape
}

/// Bodies that touch exactly: both are built in one frame, and both have the same pose.
pub(super) fn touching<W: Write>(m: &mut Maker<W>) -> io::Result<()> {
    let mut pairs: Vec<(&str, BodyId, BodyId)> = Vec::new();
    for _ in 0..4 {
        for level in ["faces", "edges", "vertices", "tip on face"] {
            let ((a, h), (b, k)) = (dyadic_box(&mut m.rng), dyadic_box(&mut m.rng));
            let side = m.rng.int(-4, 4) as f64 / 16.0;
            let (b, t) = match level {
                "faces" => (b, [side, 0.125, h[2] + k[2]]),
                "edges" => (b, [side, h[1] + k[1], h[2] + k[2]]),
                "vertices" => (b, add(h, k)),
                _ => (shapes::octahedron().stretched(k), [side, 0.125, h[2] + k[2]]),
            };
            let (a, b) = (m.body(a), m.body(shifted(b, t)));
            pairs.push((level, a, b));
        }
        for (level, shared) in [("shared face", 3), ("shared edge", 2), ("shared vertex", 1)] {
            let a = shapes::sphere(&mut m.rng, 12).solved();
            let b = grown(&a, shared, &mut m.rng);
            let (a, b) = (m.body(a), m.body(b));
            pairs.push((level, a, b));
        }
    }
    for k in 0..m.count {
        let (level, a, b) = pairs[k % pairs.len()];
        let (how, pose) = common(&mut m.rng);
        let (a, b) = if m.rng.chance(0.5) { (a, b) } else { (b, a) };
        m.case(&format!("{level}, {how}"), a, pose, b, pose)?;
    }
    Ok(())
}

/// Returns a body beyond a face of `a` that has `shared` vertices of the face.
fn grown(a: &Shape, shared: usize, rng: &mut Rng) -> Shape {
    let face = rng.pick(&a.faces).clone();
    let [p, q, r] = [0, 1, 2].map(|k| a.points[face[k] as usize]);
    let n = unit(crate::pose::cross(sub(q, p), sub(r, p)));
    let centre = scale(add(add(p, q), r), 1.0 / 3.0);
    let mut points = [p, q, r][..shared].to_vec();
    for _ in 0..6 {
        let side = scale(rng.in_ball(), 0.4);
        let side = sub(side, scale(n, crate::pose::dot(side, n)));
        points.push(add(add(centre, side), scale(n, rng.range(0.2, 1.0))));
    }
    Shape::hull("grown", points)
}

/// Boxes with parallel faces and edges.
pub(super) fn parallel<W: Write>(m: &mut Maker<W>) -> io::Result<()> {
    let boxes: Vec<(BodyId, Point)> = (0..8)
        .map(|_| {
            let (shape, half) = dyadic_box(&mut m.rng);
            (m.body(shape), half)
        })
        .collect();
    let levels = [
        "faces",
        "flush faces",
        "edges",
        "edge over face",
        "edge beside face",
        "vertex over face",
    ];
    for k in 0..m.count {
        let level = levels[k % levels.len()];
        let ((a, h), (b, g)) = (*m.rng.pick(&boxes), *m.rng.pick(&boxes));
        let gap = gap(&mut m.rng);
        let side = m.rng.int(-8, 8) as f64 / 64.0;
        let q = match level {
            "edge over face" | "edge beside face" => quat([1.0, 0.0, 0.0], m.rng.range(0.2, 1.2)),
            "vertex over face" => m.rng.quat(),
            _ => STILL,
        };
        let low = lowest(m.points(b), q);
        let t = match level {
            "faces" => [side, side, h[2] + g[2] + gap],
            "flush faces" => [h[0] - g[0], g[1] - h[1], h[2] + g[2] + gap],
            "edges" => [side, h[1] + g[1] + gap, h[2] + g[2] + gap],
            "edge beside face" => [side, h[1] - low[1] + 0.25, h[2] - low[2] + gap],
            _ => [side, side - low[1], h[2] - low[2] + gap],
        };
        let (how, pose) = common(&mut m.rng);
        m.case(&format!("{level}, {how}"), a, pose, b, pose.after(&Pose { q, t }))?;
    }
    Ok(())
}

/// Faces that are almost coplanar: lids that rise by a thousandth down to the last bit.
pub(super) fn coplanar<W: Write>(m: &mut Maker<W>) -> io::Result<()> {
    let plate = m.body(shapes::cuboid([1.5, 1.25, 0.25]));
    let lids: Vec<(i64, [BodyId; 4])> = (3..=15)
        .step_by(2)
        .map(|e| {
            let h = ten(-e);
            let all = [
                shapes::roof(h),
                shapes::pyramid_lid(h),
                shapes::cap(6, 2, h),
                shapes::dome(3, h),
            ];
            (e, all.map(|s| m.body(s)))
        })
        .collect();
    for k in 0..m.count {
        let (e, all) = lids[k % lids.len()];
        let a = m.pick(&all);
        let b = if m.rng.chance(0.3) { plate } else { m.pick(&all) };
        // B upside down above A, turned about the vertical, tilted not at all or by about the rise.
        let spin = if m.rng.chance(0.4) {
            STILL
        } else {
            quat([0.0, 0.0, 1.0], m.rng.range(0.0, 6.0))
        };
        let mut q = quat_mul(spin, [1.0, 0.0, 0.0, 0.0]);
        if m.rng.chance(0.3) {
            let axis = m.rng.unit();
            q = quat_mul(quat(axis, ten(-e) * m.rng.range(0.1, 3.0)), q);
        }
        let common = if m.rng.chance(0.5) { STILL } else { m.rng.quat() };
        let pose_a = Pose { q: common, t: [0.0; 3] };
        let side = [m.rng.range(-0.3, 0.3), m.rng.range(-0.3, 0.3), 1.0];
        let (up, gap) = (pose_a.rotate(unit(side)), gap(&mut m.rng));
        let pose_b = m.aim(a, &pose_a, b, unit_quat(quat_mul(common, q)), up, gap);
        m.case(&format!("rise 1e-{e}"), a, pose_a, b, pose_b)?;
    }
    Ok(())
}

/// A body and its copy at the same pose, or off it by a little.
pub(super) fn equal<W: Write>(m: &mut Maker<W>) -> io::Result<()> {
    let bodies = assorted(m);
    for k in 0..m.count {
        let a = bodies[k % bodies.len()];
        let pose_a = common(&mut m.rng).1;
        let (level, q, t) = match m.rng.below(5) {
            0 => ("same pose", STILL, [0.0; 3]),
            1 | 2 => ("shifted", STILL, scale(m.rng.unit(), ten(-m.rng.int(1, 16)))),
            3 => ("turned", quat(m.rng.unit(), ten(-m.rng.int(1, 16))), [0.0; 3]),
            _ => ("quarter turns", quarter_turns(&mut m.rng), [0.0; 3]),
        };
        let pose_b = if level == "same pose" {
            pose_a
        } else {
            pose_a.after(&Pose { q, t })
        };
        m.case(level, a, pose_a, a, pose_b)?;
    }
    Ok(())
}

/// Vertices on a lattice, at poses that keep them there: exact ties and exact contacts.
pub(super) fn lattice<W: Write>(m: &mut Maker<W>) -> io::Result<()> {
    let sizes = [(8, 1), (10, 2), (16, 3), (20, 6)];
    let pools = sizes.map(|(points, side)| {
        m.bodies(5, |r| {
            loop {
                let shape = shapes::lattice(r, points, side).solved();
                if !shape.faces.is_empty() {
                    break shape;
                }
            }
        })
    });
    for k in 0..m.count {
        let (pool, side) = (&pools[k % 4], sizes[k % 4].1);
        let (a, b) = (m.pick(pool), m.pick(pool));
        let pose_a = Pose {
            q: quarter_turns(&mut m.rng),
            t: [0.0; 3],
        };
        let far = if m.rng.chance(0.6) { 2 * side } else { 3 * side + 1 };
        let step = if m.rng.chance(0.25) { 0.5 } else { 1.0 };
        let pose_b = Pose {
            q: quarter_turns(&mut m.rng),
            t: [(); 3].map(|()| step * m.rng.int(-far, far) as f64),
        };
        m.case(&format!("side {}", 2 * side), a, pose_a, b, pose_b)?;
    }
    Ok(())
}

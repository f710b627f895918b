//! Faces on faces: contacts span the overlap of the faces, and nothing else.

use crate::judge::judge;
use crate::planar::spanned;
use crate::{exact, flush, manifold};
use lin_canny::{ConvexPolyhedron, Manifold, ManifoldOptions, Tracker};
use truth::contacts::widest_face;
use truth::motion::Frame;
use truth::pose::{add, cross, quat, quat_mul, scale, unit, unit_quat};
use truth::rng::Rng;
use truth::shapes;
use truth::support;
use truth::{Pose, workload};

/// Puts B's widest face on A's at a random position, tilted by `tilt`.
fn laid(a: &ConvexPolyhedron, b: &ConvexPolyhedron, distance: f64, tilt: f64, rng: &mut Rng) -> Frame {
    let ((face_a, ra), (face_b, rb)) = (widest_face(a), widest_face(b));
    let mut f = workload::stacked(face_a, face_b, rng.range(0.0, 6.3), distance);
    let aside = cross(face_a.1, rng.unit());
    f.b.t = add(f.b.t, scale(aside, 0.8 * rng.uniform() * (ra + rb)));
    f.b.q = unit_quat(quat_mul(quat(unit(cross(face_a.1, rng.unit())), tilt), f.b.q));
    f.moved(&Pose::new(rng.quat(), scale(rng.unit(), 3.0)))
}

#[test]
fn faces_on_faces_are_spanned() {
    let mut rng = Rng::new(601);
    let mut bodies = vec![
        shapes::cube(),
        shapes::cuboid([0.7, 0.4, 0.2]),
        shapes::tetrahedron(),
        shapes::octahedron(),
        shapes::dodecahedron(),
        shapes::prism(7, 1.0, 0.3),
        shapes::prism(24, 1.0, 0.3),
    ];
    bodies.extend((0..5).map(|_| shapes::sphere(&mut rng, 12)));
    let bodies: Vec<_> = bodies.iter().map(support::body).collect();
    let (mut whole, mut part) = (0, 0);
    for k in 0..3000 {
        let (a, b) = (rng.pick(&bodies), rng.pick(&bodies));
        let distance = [-1e-3, 0.0, 1e-3, -1e-9][k % 4];
        let tilt = [0.0, 1e-9, 1e-4][k % 3];
        let frame = laid(a, b, distance, tilt, &mut rng);
        // Faces that lie on each other: far vertices of tilted ones are beyond the prediction.
        let options = flush(0.1, 8);
        let m = manifold(a, b, &frame, &options);
        judge(a, b, &frame, &m, &options, "laid");
        let Some((points, shared, corners)) = spanned(a, b, &frame, &m) else {
            continue;
        };
        if corners <= 8 {
            let off = (points - shared).abs();
            assert!(off <= 1e-12, "{points} of {shared}: {m:?} {frame:?}");
            whole += 1;
        } else {
            assert!(points >= 0.7 * shared, "{points} of {shared}");
            part += 1;
        }
        let options = flush(0.1, 4);
        let m = manifold(a, b, &frame, &options);
        judge(a, b, &frame, &m, &options, "laid, four points");
        if let Some((points, shared, _)) = spanned(a, b, &frame, &m) {
            assert!(points >= 0.49 * shared, "{points} of {shared}: {m:?} {frame:?}");
        }
    }
    assert!(whole > 1000 && part > 100, "{whole} {part}");
}

#[test]
fn large_faces_are_spanned() {
    let mut rng = Rng::new(602);
    let mut bodies = vec![shapes::cube(), shapes::cuboid([3.0, 0.02, 0.2])];
    bodies.extend([25, 64, 300].map(|n| shapes::prism(n, 1.0, 0.3)));
    bodies.push(shapes::prism(200, 1.0, 0.3).stretched([1.0, 1.0 / 64.0, 0.5]));
    let bodies: Vec<_> = bodies.iter().map(support::body).collect();
    let (mut seen, mut few) = ([0; 2], 0);
    for k in 0..1500 {
        let (a, b) = (rng.pick(&bodies), &bodies[2 + k % 4]);
        let frame = laid(a, b, [-1e-3, 1e-3][k % 2], 0.0, &mut rng);
        let options = exact(0.1, 8);
        let m = manifold(a, b, &frame, &options);
        judge(a, b, &frame, &m, &options, "large");
        let Some((points, shared, _)) = spanned(a, b, &frame, &m) else {
            continue;
        };
        if shared > 1e-6 {
            seen[usize::from(points < 0.6 * shared)] += 1;
            few += usize::from(points < 0.1 * shared);
        }
    }
    // Rays from the tip of a long and narrow shape find its sides, not its other end: the choice of
    // the witness decides whether they start there.
    assert!(seen[0] > 1000 && seen[1] * 100 < seen[0] && few <= 2, "{seen:?} {few}");
}

/// A face narrower than rounding, in line with the side of another: points past its tip are inside
/// all its sides up to rounding, but not on it.
#[test]
fn nothing_is_shared_past_the_tip_of_a_sliver() {
    let table = lin_canny::polyhedron::solids::cuboid([2.0, 1.0, 1.0].into()).unwrap();
    let mut points = 0;
    for thin in [1e-17, 1e-16, 1e-12, 1e-8, 1e-4] {
        for turn in [0.0, 0.3, 1.0, std::f64::consts::FRAC_PI_4] {
            let rim = [[0.0, 0.0], [1.0, 0.0], [0.5, thin]];
            let corners = [0.0, 1.0].map(|z| rim.map(|[x, y]| [x, y, z].into()));
            let sliver = ConvexPolyhedron::from_points(corners.as_flattened()).unwrap();
            // On the table's upper face, along its side.
            let q = Pose::turn([0.0, 0.0, 1.0], turn, [0.0; 3]);
            let place = |t| Pose::new(q.q, q.rotate(t));
            let frame = Frame::new(place([0.0; 3]), place([-0.3, -1.0, 1.0]));
            for at_most in [4, 8] {
                let m = manifold(&table, &sliver, &frame, &exact(1e-9, at_most));
                assert!(!m.points().is_empty());
                for c in m.points() {
                    for (body, p) in [(&table, c.point_on_a), (&sliver, c.point_on_b)] {
                        let off = (body.closest_point(&p).unwrap() - p).norm();
                        assert!(off < 1e-13, "{thin:e} {turn}: {off:e} {c:?}");
                    }
                    points += 1;
                }
            }
        }
    }
    assert!(points > 60, "{points}");
}

/// Chosen vertices are kept while they are vertices of the overlap: every frame of a slide is as
/// sound as the first.
#[test]
fn kept_choices_are_sound() {
    let mut rng = Rng::new(606);
    let shapes = [
        shapes::cube(),
        shapes::cuboid([0.7, 0.4, 0.2]),
        shapes::prism(7, 1.0, 0.3),
        shapes::prism(24, 1.0, 0.3),
        shapes::prism(100, 1.0, 0.3),
    ];
    let bodies: Vec<_> = shapes.iter().map(support::body).collect();
    let (mut frames, mut same, mut least) = (0, 0, f64::INFINITY);
    for a in &bodies {
        for b in &bodies {
            let ((face_a, ra), (face_b, rb)) = (widest_face(a), widest_face(b));
            let reach = ra.min(rb);
            let start = workload::stacked(face_a, face_b, rng.range(0.0, 6.3), -1e-3 * reach);
            let way = scale(unit(cross(face_a.1, rng.unit())), 0.9 * reach);
            let (mut pair, mut m) = (Tracker::new(), Manifold::new());
            let mut options = ManifoldOptions::default().prediction(0.02);
            options.rebuild_motion = 0.0;
            let mut before = vec![];
            for frame in workload::to_and_fro(start, way, 240, 240, &mut rng) {
                pair.manifold(a, b, &support::relative(&frame), &options, &mut m);
                judge(a, b, &frame, &m, &options, "sliding");
                let names: Vec<_> = m.points().iter().map(|p| p.features).collect();
                same += usize::from(names == before);
                before = names;
                frames += 1;
                if let Some((points, shared, _)) = spanned(a, b, &frame, &m)
                    && shared > 1e-2
                {
                    least = least.min(points / shared);
                }
            }
        }
    }
    assert!(frames == 6000, "{same} of {frames}, {least}");
    assert!(same > 4500, "{same} of {frames}, {least}");
    assert!(least > 0.4, "{same} of {frames}, {least}");
}

/// A negative sine counts as its absolute value: vertices that have left the overlap are not kept.
#[test]
fn negative_angles_keep_no_corner_off_the_faces() {
    let body = support::body(&shapes::cuboid([1.0, 1.0, 0.2]));
    for sine in [-1.0 / 64.0, -0.4, f64::NEG_INFINITY, f64::INFINITY, f64::NAN] {
        let mut options = ManifoldOptions::default().prediction(0.5);
        (options.rebuild_motion, options.reselect_motion, options.max_face_sine) = (0.0, 10.0, sine);
        let (mut pair, mut m) = (Tracker::new(), Manifold::new());
        for k in 0..60 {
            let frame = Frame::new(Pose::IDENTITY, Pose::shift([0.05 * f64::from(k), 0.02, 0.8]));
            pair.manifold(&body, &body, &support::relative(&frame), &options, &mut m);
            for p in m.points() {
                for point in [p.point_on_a, p.point_on_b] {
                    let near = body.closest_point(&point).unwrap_or(point);
                    assert!((near - point).norm() <= 1e-12, "{sine} {k}: {p:?}");
                }
            }
        }
    }
}

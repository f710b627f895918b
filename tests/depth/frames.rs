//! A depth over frames: it is continuous, and cached state changes its cost and not its value.

use crate::{both, closest, pushed};
use lin_canny::nalgebra::Vector3;
use lin_canny::polyhedron::solids;
use lin_canny::{ContactState, ConvexPolyhedron, Outcome, Replay, Solver, Tracker};
use truth::contacts::widest_face;
use truth::motion::{self, Frame};
use truth::pose::{norm, radius, scale, sub};
use truth::rng::Rng;
use truth::shapes;
use truth::support;
use truth::{Pose, workload};

/// The signed distance changes no faster than the bodies move, on both sides of contact and across
/// it.
#[test]
fn motions_through_contact_are_continuous() {
    let mut rng = Rng::new(503);
    let mut classes = [0; 4];
    for k in 0..60 {
        let n = 4 + rng.below(60);
        let (a, b) = match k % 3 {
            0 => (shapes::cube(), shapes::sphere(&mut rng, n)),
            1 => (shapes::icosphere(1), shapes::icosphere(1)),
            _ => (shapes::small(&mut rng), shapes::small(&mut rng)),
        };
        let (ra, rb) = (radius(&a.points), radius(&b.points));
        let (a, b) = (support::body(&a), support::body(&b));
        let miss = rng.range(0.0, 0.5);
        let frames = motion::pass_through(&mut rng, 80, (ra, rb), miss);
        let mut pair = Tracker::new();
        let mut last: Option<(Frame, Outcome)> = None;
        for frame in frames {
            let o = pair.closest(&a, &b, &support::relative(&frame));
            assert_eq!(pair.check(), Ok(()));
            classes[o.state as usize] += 1;
            if let Some((before, old)) = last {
                let moved = |p: &Pose, q: &Pose, r: f64| {
                    let turn = [0, 1, 2].map(|k| {
                        let mut e = [0.0; 3];
                        e[k] = r;
                        norm(sub(p.rotate(e), q.rotate(e)))
                    });
                    norm(sub(p.t, q.t)) + turn.iter().sum::<f64>()
                };
                let most = moved(&before.a, &frame.a, ra) + moved(&before.b, &frame.b, rb);
                let slack = 1e-14 * support::size(&a, &b, &frame);
                let off = (o.distance - old.distance).abs();
                assert!(off <= most + slack, "{old:?}\n{o:?}\n{frame:?} {most:e}");
            }
            last = Some((frame, o));
        }
    }
    assert!(classes[0] > 500 && classes[2] > 500, "{classes:?}");
}

/// A cached polytope changes the cost of an outcome, not the outcome; its replay is the query, bit
/// for bit.
#[test]
fn warm_and_cold_agree_and_come_back() {
    let mut rng = Rng::new(504);
    let (mut frames, mut kept, mut work) = (0, 0, [0; 2]);
    for k in 0..40 {
        let n = 8 + rng.below(60);
        let (a, b) = match k % 4 {
            0 => (shapes::cube(), shapes::cube()),
            1 => (shapes::sphere(&mut rng, n), shapes::sphere(&mut rng, n)),
            2 => (shapes::prism(24, 1.0, 0.4), shapes::icosphere(2)),
            _ => (shapes::small(&mut rng), shapes::small(&mut rng)),
        };
        let (ra, rb) = (radius(&a.points), radius(&b.points));
        let (a, b) = (support::body(&a), support::body(&b));
        let mut pair = Tracker::new();
        for frame in motion::pass_through(&mut rng, 200, (ra, rb), 0.3) {
            let pose = support::relative(&frame);
            let replay = pair.replay(&a, &b, &pose, lin_canny::Accuracy::Certified);
            let (warm, cold) = (pair.closest(&a, &b, &pose), closest(&a, &b, &frame));
            assert_eq!(warm.state, cold.state, "{warm:?} {cold:?}");
            if warm.state != ContactState::Overlapping {
                continue;
            }
            frames += 1;
            kept += u32::from(warm.solver == Solver::Polytope);
            work[0] += warm.work.points_added;
            work[1] += cold.work.points_added;
            let size = support::size(&a, &b, &frame);
            assert!(
                (warm.distance - cold.distance).abs() <= 1e-14 * size && warm.upper - warm.lower <= 1e-13 * size,
                "{warm:?} {cold:?}"
            );
            assert!(warm.lower <= cold.upper && cold.lower <= warm.upper);
            let along = |o: &Outcome| closest(&a, &b, &pushed(&frame, o, -o.lower * (1.0 + 1e-12))).distance;
            assert!(along(&warm) >= -1e-13 * size, "{warm:?}");
            if frames % 10 == 0 {
                let again: Replay = replay.to_string().parse().expect("a replay");
                assert_eq!(again, replay);
                assert_eq!(again.tracker().closest(&again.a, &again.b, &again.pose), warm);
            }
        }
    }
    assert!(kept * 4 > frames * 3, "{kept} of {frames} kept");
    assert!(work[0] * 3 < work[1], "{work:?}");
}

/// A face on a face, trembling: the deepest facet changes in each frame, and it usually covers what
/// the cached polytope lacks.
///
/// Warm outcomes equal cold ones within the bounds, for every solver.
#[test]
fn faces_that_tremble_on_faces() {
    let mut rng = Rng::new(505);
    let (mut frames, mut grown, mut open) = (0, 0, 0);
    for k in 0..96 {
        let shape = |rng: &mut Rng| match rng.below(4) {
            0 => shapes::cube(),
            1 => shapes::prism(3 + rng.below(30), 1.0, 0.4),
            2 => shapes::prism(4, 0.1, 3.0),
            _ => shapes::sphere(rng, 8 + rng.clone().below(24)),
        };
        let (a, b) = (support::body(&shape(&mut rng)), support::body(&shape(&mut rng)));
        let ((face_a, ra), (face_b, rb)) = (widest_face(&a), widest_face(&b));
        let reach = ra.min(rb);
        let depth = [1e-4, 1e-3, 1e-2, 0.1][k % 4] * reach;
        let noise = [1e-12, 1e-9, 1e-6, 1e-5, 1e-4, 1e-3][k / 4 % 6] * reach;
        let start = workload::stacked(face_a, face_b, rng.range(0.0, 6.0), -depth);
        let mut pair = Tracker::new();
        for frame in workload::at_rest(start, noise, reach, 40, &mut rng) {
            let warm = pair.closest(&a, &b, &support::relative(&frame));
            let cold = closest(&a, &b, &frame);
            let (size, told) = (support::size(&a, &b, &frame), format!("{warm:?} {cold:?}"));
            assert_eq!(warm.state, cold.state, "{told}");
            if warm.state != ContactState::Overlapping {
                continue;
            }
            assert!((warm.distance - cold.distance).abs() <= 1e-14 * size, "{told}");
            assert!(warm.lower <= cold.upper && cold.lower <= warm.upper, "{told}");
            frames += 1;
            grown += u32::from(warm.work.points_added > 0 || warm.solver != Solver::Polytope);
            open += u32::from(warm.upper - warm.lower > 1e-13 * size);
        }
    }
    assert_eq!(open, 0);
    assert!(frames > 2500 && grown * 2 < frames, "{grown} of {frames} frames grew");
}

/// The polytope of other bodies is useless and harmless.
#[test]
fn a_foreign_surface_does_no_harm() {
    let mut rng = Rng::new(505);
    let shapes = [
        shapes::cube(),
        shapes::icosphere(1),
        shapes::tetrahedron(),
        shapes::prism(9, 1.0, 0.2),
    ];
    let bodies = shapes.map(|s| support::body(&s));
    let mut pair = Tracker::new();
    for _ in 0..2000 {
        let (a, b) = (rng.pick(&bodies), rng.pick(&bodies));
        let at = Pose::new(rng.quat(), scale(rng.unit(), rng.range(0.0, 2.0)));
        let frame = both(Pose::IDENTITY, at);
        let (o, cold) = (pair.closest(a, b, &support::relative(&frame)), closest(a, b, &frame));
        assert_eq!(o.state, cold.state);
        assert!((o.distance - cold.distance).abs() <= 1e-14 * support::size(a, b, &frame));
    }
}

/// A point or a segment in a body moves from over one face to over another; it has no face that is
/// flush on any.
#[test]
fn bodies_without_faces_keep_their_depth_over_frames() {
    let point = ConvexPolyhedron::point([0.0; 3].into()).expect("a point");
    let segment = ConvexPolyhedron::segment([-0.1, 0.0, 0.0].into(), [0.1, 0.02, 0.0].into()).expect("a segment");
    let plate = solids::cuboid(Vector3::new(1.0, 0.6, 0.05)).expect("a box");
    let hull = solids::random_hull(40, Vector3::new(1.0, 0.7, 0.5), 3).expect("a hull");
    let mut rng = Rng::new(31);
    let mut surface = 0;
    let lid = support::body(&shapes::pyramid_lid(5e-12));
    for body in [&plate, &hull, &lid] {
        for small in [&point, &segment] {
            for _ in 0..20 {
                let (mut pair, mut back) = (Tracker::new(), Tracker::new());
                let (from, to) = (scale(rng.unit(), 0.6), scale(rng.unit(), 0.6));
                for k in 0..60 {
                    let t = f64::from(k) / 60.0;
                    let at = [0, 1, 2].map(|k| from[k] * (1.0 - t) + to[k] * t);
                    // Along below the lid, whose faces are coplanar up to rounding.
                    let at = if std::ptr::eq(body, &lid) {
                        [at[0], at[1], 0.45]
                    } else {
                        at
                    };
                    let frame = both(Pose::IDENTITY, Pose::shift(at));
                    let o = pair.closest(body, small, &support::relative(&frame));
                    let p = back.closest(small, body, &support::relative(&frame.swapped()));
                    let cold = closest(body, small, &frame);
                    assert!((o.distance - cold.distance).abs() <= 1e-14, "{o:?} {cold:?}");
                    assert!((p.distance - cold.distance).abs() <= 1e-14, "{p:?} {cold:?}");
                    surface += usize::from(o.solver == Solver::Polytope);
                }
            }
        }
    }
    assert!(surface > 500, "{surface}");
}

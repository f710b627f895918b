//! A local depth is a proven upper bound of the depth.
//!
//! It is compared with exact depths of hard and ordinary bodies: warm, from a hint, from the
//! tracker of a proven depth, and with A and B exchanged. Separated bodies have ordinary outcomes.

use crate::nearest::{nudged, pose, shape};
use lin_canny::{
    ContactState, ConvexPolyhedron, DepthMode, Manifold, ManifoldOptions, Outcome, PairTracker, QueryOptions, Tracker,
};
use truth::exact::{self, Exact};
use truth::motion::{self, Frame};
use truth::pose::{dot, radius, scale, sub};
use truth::rng::Rng;
use truth::shapes::{self, Shape};
use truth::support;
use truth::{Body, Pose, bound};

/// A pair of bodies in one order.
struct Pair<'a> {
    shapes: [&'a Shape; 2],
    bodies: [&'a ConvexPolyhedron; 2],
}

/// Numbers of outcomes proven to be the least depth, deeper ones, and ones without a lower bound.
#[derive(Debug, Default)]
struct Count {
    apart: usize,
    /// By facet: a face of A, a face of B, two edges.
    least: [usize; 3],
    deeper: usize,
    open: usize,
}

impl Pair<'_> {
    /// Judges all results of a local depth against the oracle.
    fn judge(&self, frame: &Frame, o: &Outcome, truth: &Exact, count: &mut Count) {
        let [a, b] = self.bodies;
        let size = support::size(a, b, frame);
        let told = || format!("{o:?} {truth:?} {:?} {frame:?}", self.shapes);
        support::assert_right(o, truth, &told());
        let [x, y] = self.shapes.map(Body::from);
        let (on_a, on_b) = (o.point_on_a.coords.into(), o.point_on_b.coords.into());
        assert!(
            bound::outside_by(on_a, x).max(bound::outside_by(on_b, y)) <= 1e-13 * size,
            "{}",
            told()
        );
        let apart = bound::witness_distance(on_a, &frame.a, on_b, &frame.b);
        assert!((apart - o.distance.abs()).abs() <= 1e-13 * size, "{}", told());
        // The property that makes the height of a facet an upper bound: B moved by the returned
        // depth is outside A.
        let normal = frame.a.rotate(o.normal.into_inner().into());
        let gap = bound::support_gap(x, &frame.a, y, &frame.b, normal);
        assert!((gap - o.distance).abs() <= 1e-13 * size, "{gap:e} {}", told());
        if o.state != ContactState::Overlapping {
            assert!(o.upper - o.lower <= 1e-13 * size, "{}", told());
            count.apart += 1;
            return;
        }
        assert!(o.distance - o.lower <= 1e-13 * size, "{}", told());
        let kind = match support::kinds(o.features) {
            (2, _) => 0,
            (_, 2) => 1,
            _ => 2,
        };
        count.least[kind] += usize::from(o.upper - o.lower <= 1e-13 * size);
        count.deeper += usize::from(truth.distance - o.distance > 1e-13 * size);
        count.open += usize::from(o.upper == 0.0);
    }
}

#[test]
fn local_depths_bound_the_exact_depth() {
    let mut rng = Rng::new(521);
    let mut count = Count::default();
    for _ in 0..250 {
        let (sa, sb) = (shape(&mut rng), shape(&mut rng));
        let (a, b) = (support::body(&sa), support::body(&sb));
        let there = Pair {
            shapes: [&sa, &sb],
            bodies: [&a, &b],
        };
        let back = Pair {
            shapes: [&sb, &sa],
            bodies: [&b, &a],
        };
        let radii = (radius(&sa.points), radius(&sb.points));
        let depth = radii.0.min(radii.1) * rng.log_range(1e-7, 0.9);
        let mut frame = pose(&mut rng, (&a, &b), radii, depth);
        let mut trackers = [Tracker::new(), Tracker::new(), Tracker::new()];
        let mut last: Option<Outcome> = None;
        for k in 0..5 {
            let truth = exact::solve(Body::from(&sa), &frame.a, Body::from(&sb), &frame.b);
            let (pose, swapped) = (support::relative(&frame), support::relative(&frame.swapped()));
            let [warm, mixed, turned] = &mut trackers;
            // A polytope cached by the proven depth, and its features.
            if k % 2 == 0 {
                mixed.closest(&a, &b, &pose);
            }
            let mut hint = last.map_or_else(Tracker::new, |o| Tracker::with_previous(o.features, o.state, &a, &b));
            for tracker in [warm, mixed, &mut hint] {
                let o = tracker.closest_with_local_depth(&a, &b, &pose);
                there.judge(&frame, &o, &truth, &mut count);
                last = Some(o);
            }
            let o = turned.closest_with_local_depth(&b, &a, &swapped);
            back.judge(&frame.swapped(), &o, &truth, &mut count);
            assert_eq!(trackers.each_ref().map(Tracker::check), [Ok(()), Ok(()), Ok(())]);
            frame = nudged(&mut rng, &frame, radii.0.min(radii.1));
        }
    }
    let Count {
        least, deeper, open, ..
    } = count;
    assert!(least.iter().all(|&n| n > 400) && deeper > 50 && open > 100, "{count:?}");
}

/// Through contact and back: the contact state equals that of the proven outcome, the bounds
/// contain its depth, and a proven outcome of the same tracker is correct.
#[test]
fn motions_through_contact_keep_class_and_bounds() {
    let mut rng = Rng::new(522);
    let mut classes = [0; 4];
    let mut deeper = 0;
    for k in 0..40 {
        let n = 4 + rng.below(120);
        let (a, b) = match k % 4 {
            0 => (shapes::cube(), shapes::sphere(&mut rng, n)),
            1 => (shapes::icosphere(2), shapes::ellipsoid(&mut rng, 60, [1.0, 0.5, 0.05])),
            2 => (shapes::prism(48, 1.0, 0.2), shapes::prism(32, 0.7, 0.4)),
            _ => (shapes::small(&mut rng), shapes::small(&mut rng)),
        };
        let radii = (radius(&a.points), radius(&b.points));
        let (a, b) = (support::body(&a), support::body(&b));
        let (mut pair, mut proven) = (Tracker::new(), Tracker::new());
        for (f, frame) in motion::pass_through(&mut rng, 150, radii, 0.4).into_iter().enumerate() {
            let pose = support::relative(&frame);
            let truth = proven.closest(&a, &b, &pose);
            let o = pair.closest_with_local_depth(&a, &b, &pose);
            let slack = 1e-13 * support::size(&a, &b, &frame);
            assert_eq!(o.state, truth.state, "{o:?} {truth:?}");
            assert!(
                o.lower <= truth.upper && truth.lower <= o.upper && o.lower <= o.distance && o.distance <= o.upper,
                "{o:?} {truth:?}"
            );
            classes[o.state as usize] += 1;
            deeper += usize::from(truth.distance - o.distance > slack);
            if f % 10 == 0 {
                let again = pair.closest(&a, &b, &pose);
                assert!((again.distance - truth.distance).abs() <= slack, "{again:?} {truth:?}");
            }
        }
    }
    assert!(classes[0] > 500, "{classes:?} {deeper}");
    assert!(classes[2] > 500, "{classes:?} {deeper}");
    assert!(deeper > 50, "{classes:?} {deeper}");
}

/// Contacts of a local depth lie on both bodies, and none is deeper than its bound, for rounded
/// bodies too.
#[test]
fn contacts_of_a_local_depth_are_no_deeper_than_the_bound() {
    let mut rng = Rng::new(523);
    let mut options = ManifoldOptions::default().prediction(0.01);
    (options.local_depth, options.rebuild_motion) = (true, 0.0);
    let (mut points, mut overlaps) = (0, 0);
    for _ in 0..30 {
        let (sa, sb) = (shapes::sphere(&mut rng, 24), shapes::cuboid([0.6, 0.5, 0.4]));
        let (a, b) = (support::body(&sa), support::body(&sb));
        let round = 0.05;
        let rounded = [&a, &b].map(|body| {
            let sharp = lin_canny::Shape::from(body.clone());
            sharp.rounded(round).expect("a radius")
        });
        let (mut pair, mut m) = (Tracker::new(), Manifold::new());
        let (mut shape_pair, mut of_round) = (PairTracker::new(), Manifold::new());
        for frame in motion::pass_through(&mut rng, 60, (1.0, 0.8), 0.2) {
            let pose = support::relative(&frame);
            let size = support::size(&a, &b, &frame);
            pair.manifold(&a, &b, &pose, &options, &mut m);
            shape_pair
                .manifold(&rounded[0], &rounded[1], &pose, &options, &mut of_round)
                .unwrap();
            for m in [&m, &of_round] {
                let n = m.normal().into_inner().into();
                for p in m.points() {
                    let (p_a, p_b) = (p.point_on_a.coords.into(), p.point_on_b.coords.into());
                    let between = sub(frame.relative().apply(p_b), p_a);
                    assert!((dot(between, n) - p.separation).abs() <= 1e-13 * size, "{m:?}");
                    assert!(p.separation >= m.lower() - 1e-14 * size, "{m:?}");
                    points += 1;
                }
                overlaps += usize::from(m.lower() < 0.0);
            }
            let truth = PairTracker::new().closest(&rounded[0], &rounded[1], &pose);
            let o = shape_pair.closest_with(
                &rounded[0],
                &rounded[1],
                &pose,
                &QueryOptions::default().depth(DepthMode::Local),
            );
            assert_eq!(o.state, truth.state, "{o:?} {truth:?}");
            assert!(o.lower <= truth.upper && truth.lower <= o.upper, "{o:?} {truth:?}");
        }
    }
    assert!(points > 2000 && overlaps > 1000, "{points} {overlaps}");
}

/// Bodies of different scales, and points without size, get the proven depth or none.
#[test]
fn bodies_of_different_scales_are_answered() {
    let small = support::body(&shapes::cube().stretched([1e-9; 3]));
    let large = support::body(&shapes::cube().stretched([1e9; 3]));
    let inside = support::relative(&Frame::new(Pose::IDENTITY, Pose::shift(scale([1.0, 0.5, 0.25], 9e8))));
    let mut pair = Tracker::new();
    for _ in 0..3 {
        let o = pair.closest_with_local_depth(&large, &small, &inside);
        let p = Tracker::new().closest(&large, &small, &inside);
        assert_eq!((o.state, o.distance), (p.state, p.distance));
    }
}

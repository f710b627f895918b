//! The nearest facet answers shallow overlaps, and is always the correct facet.
//!
//! It is compared with exact depths of hard and ordinary bodies: warm, cold, from a hint, and with
//! A and B exchanged.

use crate::both;
use lin_canny::{ContactState, ConvexPolyhedron, Outcome, Solver, Tracker};
use truth::contacts::widest_face;
use truth::motion::Frame;
use truth::pose::{add, quat, quat_mul, radius, scale, unit_quat};
use truth::rng::Rng;
use truth::shapes::{self, Shape};
use truth::support;
use truth::{Body, Pose, exact, workload};

pub(crate) fn shape(rng: &mut Rng) -> Shape {
    let shape = match rng.below(8) {
        0 => shapes::cube(),
        1 => shapes::cuboid([1.0, 0.7, 0.02]),
        2 => shapes::cuboid([1.0, 0.02, 0.015]),
        3 => shapes::cuboid([1.0, 0.8, 1e-4]),
        4 => shapes::prism(8, 1.0, 0.1),
        5 => shapes::prism(3 + rng.below(4), 0.6, 0.5),
        6 => shapes::small(rng),
        _ => shapes::sphere(rng, 6 + rng.clone().below(6)),
    };
    let by = if rng.chance(0.3) { 1e-3 } else { 1.0 };
    shape.stretched([by; 3]).solved()
}

/// Returns a pose of a pair at about this depth: in general position, on a lattice, or with faces
/// flush up to a tilt.
pub(crate) fn pose(
    rng: &mut Rng,
    (a, b): (&ConvexPolyhedron, &ConvexPolyhedron),
    radii: (f64, f64),
    depth: f64,
) -> Frame {
    let reach = radii.0.min(radii.1);
    let start = match rng.below(4) {
        0 => {
            let ((face_a, _), (face_b, _)) = (widest_face(a), widest_face(b));
            let spin = if rng.chance(0.5) { 0.0 } else { rng.range(0.0, 6.0) };
            workload::stacked(face_a, face_b, spin, -depth)
        }
        1 => {
            let t = [0, 1, 2].map(|_| rng.int(-2, 2) as f64 * 0.5 * reach);
            both(Pose::IDENTITY, Pose::shift(t))
        }
        _ => {
            let t = scale(rng.unit(), radii.0 + radii.1);
            both(Pose::IDENTITY, Pose::new(rng.quat(), t))
        }
    };
    let tilt = [0.0, 1e-12, 1e-7, 1e-3][rng.below(4)];
    let q = unit_quat(quat_mul(quat(rng.unit(), tilt), start.b.q));
    let mut frame = both(start.a, Pose::new(q, start.b.t));
    for _ in 0..8 {
        let o = Tracker::new().closest(a, b, &support::relative(&frame));
        if (o.distance + depth).abs() <= 0.01 * depth {
            break;
        }
        frame.b.t = add(frame.b.t, scale(o.normal.into_inner().into(), -depth - o.distance));
    }
    frame
}

/// Returns B after a small motion.
pub(crate) fn nudged(rng: &mut Rng, frame: &Frame, reach: f64) -> Frame {
    let by = rng.log_range(1e-9, 1e-2);
    let q = unit_quat(quat_mul(quat(rng.unit(), by), frame.b.q));
    let t = add(frame.b.t, scale(rng.unit(), by * reach * rng.uniform()));
    both(frame.a, Pose::new(q, t))
}

struct Count {
    facets: usize,
    surfaces: usize,
    open: usize,
}

#[test]
fn nearest_facets_are_the_exact_depth() {
    let mut rng = Rng::new(511);
    let mut count = Count {
        facets: 0,
        surfaces: 0,
        open: 0,
    };
    for _ in 0..250 {
        let (sa, sb) = (shape(&mut rng), shape(&mut rng));
        let (a, b) = (support::body(&sa), support::body(&sb));
        let radii = (radius(&sa.points), radius(&sb.points));
        let reach = radii.0.min(radii.1);
        let depth = reach * rng.log_range(1e-7, 0.3);
        let mut frame = pose(&mut rng, (&a, &b), radii, depth);
        let (mut pair, mut back) = (Tracker::new(), Tracker::new());
        let mut last: Option<Outcome> = None;
        for _ in 0..4 {
            let truth = exact::solve(Body::from(&sa), &frame.a, Body::from(&sb), &frame.b);
            let (there, swapped) = (support::relative(&frame), support::relative(&frame.swapped()));
            let hint = last.map_or_else(Tracker::new, |o| Tracker::with_previous(o.features, o.state, &a, &b));
            let answers = [
                pair.closest(&a, &b, &there),
                Tracker::new().closest(&a, &b, &there),
                hint.clone().closest(&a, &b, &there),
                back.closest(&b, &a, &swapped),
            ];
            let size = support::size(&a, &b, &frame);
            for (k, o) in answers.iter().enumerate() {
                support::assert_right(o, &truth, &format!("{k} {frame:?} {sa:?} {sb:?}"));
                let slack = 1e-14 * size;
                let off = (o.distance - truth.distance).abs();
                assert!(off <= slack, "{k} {o:?} {}", truth.distance);
                assert!(o.upper - o.lower <= 1e-13 * size, "{k} {o:?}");
                if o.state == ContactState::Overlapping {
                    let is_surface = o.solver == Solver::Polytope;
                    // No points except those of the first simplex or of a cached polytope.
                    count.facets += usize::from(is_surface && o.work.facets > 0 && o.work.points_added == 0);
                    count.surfaces += usize::from(is_surface && o.work.points_added > 0);
                    count.open += usize::from(!is_surface);
                }
            }
            assert_eq!((pair.check(), back.check()), (Ok(()), Ok(())));
            last = Some(answers[0]);
            frame = nudged(&mut rng, &frame, reach);
        }
    }
    let Count { facets, surfaces, open } = count;
    assert!(facets > 1000, "{facets} facets, {surfaces} surfaces, {open} open");
    assert!(surfaces > 150, "{facets} facets, {surfaces} surfaces, {open} open");
    assert!(open < 1000, "{facets} facets, {surfaces} surfaces, {open} open");
}

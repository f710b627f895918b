//! Promise: bodies that overlap get the depth, proven: the least translation that parts them, along the normal.

mod support;

use lab::contacts::widest_face;
use lab::exact;
use lab::motion::{self, Frame};
use lab::pose::{norm, radius, scale, sub};
use lab::rng::Rng;
use lab::shapes::{self, Shape};
use lab::{Body, Pose, workload};
use lin_canny::nalgebra::Vector3;
use lin_canny::polyhedron::solids;
use lin_canny::{Class, ConvexPolyhedron, Layer, Outcome, Replay, Tracker};

fn both(a: Pose, b: Pose) -> Frame {
    Frame { a, b }
}

fn closest(a: &ConvexPolyhedron, b: &ConvexPolyhedron, frame: &Frame) -> Outcome {
    Tracker::new().closest(a, b, &support::relative(frame))
}

/// Bounds, normal and witnesses of an overlap, by themselves: pushed along the normal by the greater bound of the depth
/// the bodies are apart, by a little less than the depth they are not.
fn judge(a: &ConvexPolyhedron, b: &ConvexPolyhedron, frame: &Frame, what: &str) -> Outcome {
    let o = closest(a, b, frame);
    let size = support::size(a, b, frame);
    let told = format!("{what}: {o:?} {frame:?}");
    assert_eq!(o.class, Class::Overlapping, "{told}");
    assert!(
        o.lower <= o.distance && o.distance <= o.upper && o.upper <= 0.0,
        "{told}"
    );
    assert!(o.upper - o.lower <= 1e-13 * size, "{told}");
    let n: [f64; 3] = frame.a.rotate(o.normal.into_inner().into());
    let pushed = |by: f64| closest(a, b, &pushed(frame, &o, by)).distance;
    // Below this the rounding of the pushed pose decides.
    if -o.distance > 1e-10 * size {
        assert!(pushed(-o.lower * (1.0 + 1e-12)) >= -1e-14 * size, "{told}");
        assert!(pushed(-0.999 * o.distance) < 0.0, "{told}");
    }
    let (p, q) = (o.point_on_a.coords.into(), o.point_on_b.coords.into());
    let between = sub(frame.b.apply(q), frame.a.apply(p));
    let along = scale(n, o.distance);
    assert!(norm(sub(between, along)) <= 1e-12 * size, "{told}");
    for (body, point) in [(a, o.point_on_a), (b, o.point_on_b)] {
        let near = body.closest_point(&point).unwrap_or(point);
        assert!((near - point).norm() <= 1e-12 * size, "{told}");
    }
    assert!(support::are_of(o.features, a, b), "{told}");
    o
}

/// The same with the letters exchanged, and both depths alike.
fn judge_both(a: &ConvexPolyhedron, b: &ConvexPolyhedron, frame: &Frame, what: &str) -> f64 {
    let there = judge(a, b, frame, what);
    let back = judge(b, a, &frame.swapped(), what);
    let slack = 1e-14 * support::size(a, b, frame);
    assert!(
        (there.distance - back.distance).abs() <= slack,
        "{what}: {there:?} {back:?}"
    );
    there.distance
}

/// Poses at which ties and zero volumes abound.
fn hard_poses(rng: &mut Rng, radii: (f64, f64)) -> Vec<Frame> {
    let turned = Pose {
        q: rng.quat(),
        t: scale(rng.unit(), 3.0),
    };
    let spun = Pose {
        q: rng.quat(),
        t: turned.t,
    };
    let near = |by: f64, rng: &mut Rng| Pose {
        q: turned.q,
        t: sub(turned.t, scale(rng.unit(), by)),
    };
    let shift = [rng.int(-1, 1) as f64 * 0.5, rng.int(-1, 1) as f64 * 0.5, 0.0];
    vec![
        both(Pose::IDENTITY, Pose::IDENTITY),
        both(turned, turned),
        both(turned, spun),
        both(turned, near(1e-9, rng)),
        both(turned, near(0.1 * (radii.0 + radii.1), rng)),
        both(Pose::IDENTITY, Pose::shift(shift)),
    ]
}

#[test]
fn hard_poses_of_small_bodies_are_exact() {
    let mut rng = Rng::new(501);
    let mut judged = 0;
    while judged < 400 {
        let a = shapes::small(&mut rng);
        let b = if rng.chance(0.3) {
            a.clone()
        } else if rng.chance(0.3) {
            a.clone().stretched([0.5; 3])
        } else {
            shapes::small(&mut rng)
        };
        let (body_a, body_b) = (support::body(&a), support::body(&b));
        for frame in hard_poses(&mut rng, (radius(&a.points), radius(&b.points))) {
            let truth = exact::solve(Body::from(&a), &frame.a, Body::from(&b), &frame.b);
            if truth.class != lab::Class::Overlapping {
                continue;
            }
            let d = judge_both(&body_a, &body_b, &frame, &a.name);
            let slack = 1e-14 * support::size(&body_a, &body_b, &frame);
            assert!(
                (d - truth.distance).abs() <= slack,
                "{d:e}, not {:e}: {a:?} {b:?} {frame:?}",
                truth.distance
            );
            judged += 1;
        }
    }
}

#[test]
fn larger_bodies_are_certified() {
    let mut rng = Rng::new(502);
    let bodies: Vec<(Shape, ConvexPolyhedron)> = [
        shapes::icosphere(2),
        shapes::sphere(&mut rng, 200),
        shapes::ellipsoid(&mut rng, 120, [1.0, 0.6, 0.1]),
        shapes::cone(128, 1.0, 0.4),
        shapes::prism(64, 1.0, 0.3),
        shapes::grid(4),
        shapes::chamfered([1.0, 0.7, 0.5], 1e-9),
        shapes::dome(6, 1e-6),
        shapes::sliver(&mut rng, 40, 1e-6),
    ]
    .into_iter()
    .map(|s| (s.clone(), support::body(&s)))
    .collect();
    let mut judged = 0;
    for (sa, a) in &bodies {
        for (sb, b) in &bodies {
            for frame in hard_poses(&mut rng, (radius(&sa.points), radius(&sb.points))) {
                if closest(a, b, &frame).class == Class::Overlapping {
                    judge_both(a, b, &frame, &format!("{} {}", sa.name, sb.name));
                    judged += 1;
                }
            }
        }
    }
    assert!(judged > 200, "{judged}");
}

/// The signed distance changes no faster than the bodies move, on both sides of contact and across it.
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
            classes[o.class as usize] += 1;
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
                assert!(
                    (o.distance - old.distance).abs() <= most + slack,
                    "{old:?}\n{o:?}\n{frame:?} {most:e}"
                );
            }
            last = Some((frame, o));
        }
    }
    assert!(classes[0] > 500 && classes[2] > 500, "{classes:?}");
}

/// Who asks for less does not pay.
#[test]
fn a_depth_is_searched_for_on_request_only() {
    let cube = support::body(&shapes::cube());
    let mut pair = Tracker::new();
    for k in 0..20 {
        let pose = support::shifted([0.1 * f64::from(k), 0.3, 0.2]);
        assert!(pair.intersects(&cube, &cube, &pose));
        assert!(pair.within(&cube, &cube, &pose, 0.1));
        assert!(pair.propose(&cube, &cube, &pose).work.depths == 0);
    }
    assert_eq!(pair.totals().depths, 0);
    let o = pair.closest(&cube, &cube, &support::shifted([1.5, 0.3, 0.2]));
    assert_eq!((o.work.depths, pair.totals().depths), (1, 1));
    assert_eq!((o.distance, o.normal.into_inner().into()), (-0.5, [1.0, 0.0, 0.0]));
}

/// A kept surface changes what an answer costs, not the answer; and its replay is the query bit for bit.
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
            let replay = pair.replay(&a, &b, &pose, lin_canny::Level::Certified);
            let (warm, cold) = (pair.closest(&a, &b, &pose), closest(&a, &b, &frame));
            assert_eq!(warm.class, cold.class, "{warm:?} {cold:?}");
            if warm.class != Class::Overlapping {
                continue;
            }
            frames += 1;
            kept += u32::from(warm.layer == Layer::Surface);
            work[0] += warm.work.grown;
            work[1] += cold.work.grown;
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

/// A face on a face, trembling: another facet is the deepest in each frame, and mostly it covers what the kept surface is short of.
/// Warm answers are the cold ones within the bounds, whatever proves them.
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
            assert_eq!(warm.class, cold.class, "{told}");
            if warm.class != Class::Overlapping {
                continue;
            }
            assert!((warm.distance - cold.distance).abs() <= 1e-14 * size, "{told}");
            assert!(warm.lower <= cold.upper && cold.lower <= warm.upper, "{told}");
            frames += 1;
            grown += u32::from(warm.work.grown > 0 || warm.layer != Layer::Surface);
            open += u32::from(warm.upper - warm.lower > 1e-13 * size);
        }
    }
    assert_eq!(open, 0);
    assert!(frames > 2500 && grown * 2 < frames, "{grown} of {frames} frames grew");
}

/// B moved along the normal of an answer.
fn pushed(frame: &Frame, o: &Outcome, by: f64) -> Frame {
    let n: [f64; 3] = frame.a.rotate(o.normal.into_inner().into());
    let t = sub(frame.b.t, scale(n, -by));
    both(frame.a, Pose { q: frame.b.q, t })
}

/// The surface of other bodies is of no use and does no harm.
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
        let at = Pose {
            q: rng.quat(),
            t: scale(rng.unit(), rng.range(0.0, 2.0)),
        };
        let frame = both(Pose::IDENTITY, at);
        let (o, cold) = (pair.closest(a, b, &support::relative(&frame)), closest(a, b, &frame));
        assert_eq!(o.class, cold.class);
        assert!((o.distance - cold.distance).abs() <= 1e-14 * support::size(a, b, &frame));
    }
}

/// A plate, and at a corner of it a speck a billionth as large and a million times thinner still: the volumes that prove the
/// overlap are far below rounding of the plate's.
#[test]
fn a_speck_on_the_corner_of_a_plate() {
    let corners = [[-1.0, -1.0, 0.0], [-1.0, -0.5, 0.0], [0.5, -1.0, 0.0], [0.0; 3]].map(|p| p.into());
    let plate = ConvexPolyhedron::polygon(&corners).expect("a polygon");
    let speck = solids::cuboid(Vector3::new(3.5e-9, 2.2e-9, 1.4e-12)).expect("a box");
    let mut rng = Rng::new(17);
    for _ in 0..200 {
        let frame = both(
            Pose::IDENTITY,
            Pose {
                q: rng.quat(),
                t: [0.0; 3],
            },
        );
        judge(&plate, &speck, &frame, "speck");
        judge(&speck, &plate, &frame.swapped(), "speck");
    }
}

/// All sides of a cone are equally near to the middle of its base: each is taken in before the depth is known, and each is
/// named by the apex, which has as many edges.
#[test]
fn thousands_of_equal_depths_about_an_apex() {
    let corner = |p: [f64; 3]| lin_canny::nalgebra::Point3::from(p);
    let wedge = [[0.0; 3], [0.3, 0.0, 1.0], [0.0, 0.3, 1.0], [-0.2, -0.3, 1.0]].map(corner);
    let wedge = ConvexPolyhedron::from_points(&wedge).unwrap();
    let needle = ConvexPolyhedron::segment(corner([0.0; 3]), corner([0.5, 0.25, 1.0])).unwrap();
    let here = both(Pose::IDENTITY, Pose::IDENTITY);
    for (n, limit) in [(40, 2.0), (300, 2.0), (6000, 4.0)] {
        let cone = solids::cone(n, 1.0, 1.0).unwrap();
        for body in [&wedge, &needle] {
            let began = std::time::Instant::now();
            let o = judge(&cone, body, &here, &format!("cone {n}"));
            let seconds = began.elapsed().as_secs_f64();
            assert!(seconds < limit, "cone {n}: {seconds} s");
            // The height of the origin below a side.
            let side = 1.0 / (1.0 + (std::f64::consts::PI / n as f64).cos().powi(-2)).sqrt();
            assert!(
                o.lower <= -side + 1e-13 && -side - 1e-13 <= o.upper,
                "cone {n}: {o:?}, {side}"
            );
        }
    }
}

/// Bodies thinner than the rounding of their length, laid into each other: no surface of triangles closes in any floating-point
/// arithmetic, and every facet is looked at.
#[test]
fn bodies_thinner_than_rounding_have_a_depth() {
    let mut rng = Rng::new(29);
    let needle = |rng: &mut Rng| {
        let thin: [f64; 2] = [rng.log_range(1e-14, 1e-8), rng.log_range(1e-14, 1e-8)];
        if rng.chance(0.5) {
            return solids::cuboid(Vector3::new(1.0, thin[0], thin[1])).expect("a box");
        }
        let tips = [[1.0, 0.0, 0.0], [0.0, thin[0], 0.0], [0.0, 0.0, thin[1]]];
        let all: Vec<_> = tips.iter().flat_map(|&p| [p.into(), scale(p, -1.0).into()]).collect();
        ConvexPolyhedron::from_points(&all).expect("an octahedron")
    };
    let mut exact = 0;
    for _ in 0..3000 {
        let a = needle(&mut rng);
        let b = if rng.chance(0.7) { a.clone() } else { needle(&mut rng) };
        let q = rng.quat();
        let t = Pose { q, t: [0.0; 3] }.rotate([rng.range(-0.9, 0.9), 0.0, 0.0]);
        let frame = both(Pose { q, t: [0.0; 3] }, Pose { q, t });
        let o = closest(&a, &b, &frame);
        if o.class == Class::Overlapping {
            judge_both(&a, &b, &frame, "needles");
            exact += usize::from(o.layer == Layer::Exact);
        }
    }
    assert!(exact > 50, "{exact}");
}

/// The depth is below the least number: the bounds are about zero, and on the side of an overlap.
#[test]
fn an_overlap_below_the_least_number() {
    let root = 1.414_213_562_373_095_4;
    let (start, end) = ([-0.8; 3].into(), [0.0, 0.0, -root].into());
    let segment = ConvexPolyhedron::segment(start, end).unwrap();
    let side = [
        0.803_804_099_559_783_9,
        -0.317_358_702_421_188_35,
        0.000_914_436_706_807_464_4,
    ];
    let triangle = ConvexPolyhedron::polygon(&[[0.0; 3], side, [0.0, 1.0, 0.0]].map(|p| p.into())).unwrap();
    let frame = both(Pose::IDENTITY, Pose::shift([-1e-323, 0.0, -root]));
    for o in [
        closest(&segment, &triangle, &frame),
        closest(&triangle, &segment, &frame.swapped()),
    ] {
        assert_eq!(o.class, Class::Overlapping, "{o:?}");
        assert!(
            o.lower < 0.0 && o.lower <= o.distance && o.distance <= o.upper && o.upper <= 0.0,
            "{o:?}"
        );
    }
}

/// A point or a segment in a body moves from over one face to over another: no face of its own lies flush on any.
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
                    // Along beneath the lid, whose faces are one but for rounding.
                    let at = if std::ptr::eq(body, &lid) {
                        [at[0], at[1], 0.45]
                    } else {
                        at
                    };
                    let frame = both(
                        Pose::IDENTITY,
                        Pose {
                            t: at,
                            ..Pose::IDENTITY
                        },
                    );
                    let o = pair.closest(body, small, &support::relative(&frame));
                    let p = back.closest(small, body, &support::relative(&frame.swapped()));
                    let cold = closest(body, small, &frame);
                    assert!((o.distance - cold.distance).abs() <= 1e-14, "{o:?} {cold:?}");
                    assert!((p.distance - cold.distance).abs() <= 1e-14, "{p:?} {cold:?}");
                    surface += usize::from(o.layer == Layer::Surface);
                }
            }
        }
    }
    assert!(surface > 500, "{surface}");
}

/// A point in the skin of a needle of thousands of faces: what the surface did not close about has its witnesses from the list of all
/// facets.
#[test]
fn a_point_in_the_skin_of_a_needle_has_its_witnesses() {
    let mut rng = Rng::new(415);
    let speck = ConvexPolyhedron::point([0.0; 3].into()).unwrap();
    let mut inside = 0;
    for n in [200, 1000, 5000] {
        let rim = (0..n).map(|k| std::f64::consts::TAU * (k as f64 / n as f64).powi(3));
        let tip = [[0.0, 0.0, 1e6].into()];
        let points: Vec<_> = rim.map(|t| [t.cos(), t.sin(), 0.0].into()).chain(tip).collect();
        let needle = ConvexPolyhedron::from_points(&points).unwrap();
        let corners: Vec<Vector3<f64>> = needle.vertex_points().map(|p| p.coords).collect();
        for _ in 0..1000 {
            let t = rng.uniform();
            let at = *rng.pick(&corners) * t + Vector3::new(0.0, 0.0, 1e6) * (1.0 - t);
            let frame = both(Pose::IDENTITY, Pose::shift(at.into()));
            let o = closest(&needle, &speck, &frame);
            if o.class != Class::Overlapping {
                continue;
            }
            inside += 1;
            let between = at + o.point_on_b.coords - o.point_on_a.coords;
            let off = (between - o.normal.into_inner() * o.distance).norm();
            assert!(off <= 1e-13 * 1e6, "{n}: {off:e} {o:?}");
        }
    }
    assert!(inside > 20, "{inside}");
}

/// How near a witness is has nothing to do with how far the bodies are from their own origins, but for its own digits.
#[test]
fn witnesses_of_far_bodies_are_as_good_as_their_coordinates() {
    let mut rng = Rng::new(416);
    let away = 1e8;
    let (mut deep, mut doubled) = (0, 0);
    for k in 0..1500 {
        let small = shapes::cone(200, 1.0, 0.4).stretched([1e-5; 3]);
        let large = shapes::cone(128, 1.0, 1.0).moved(&Pose::shift(rng.unit().map(|x| x * away)));
        let (a, b) = (support::body(&small), support::body(&large));
        let mut frame = both(
            Pose::IDENTITY,
            Pose {
                q: rng.quat(),
                t: [0.0; 3],
            },
        );
        let middle = frame.b.apply(b.bounding_ball().0.into());
        frame.b.t = sub(rng.unit(), middle);
        for _ in 0..4 {
            let o = closest(&a, &b, &frame);
            let by = [-1e-15, -1e-9, -1e-12, 0.0][k % 4] - o.distance;
            frame.b.t = lab::pose::add(frame.b.t, scale(o.normal.into_inner().into(), by));
        }
        let o = closest(&a, &b, &frame);
        if o.class != Class::Overlapping {
            continue;
        }
        deep += 1;
        doubled += usize::from(o.layer == Layer::DoubleDouble);
        let between = lab::bound::witness_distance(o.point_on_a.into(), &frame.a, o.point_on_b.into(), &frame.b);
        // The coordinates of the one on B end with 2^-27.
        let off = (between + o.distance).abs();
        assert!(off <= 3e-8, "{k}: {off:e} {o:?}");
    }
    assert!(deep > 300 && doubled > 50, "{deep} {doubled}");
}

/// A speck in a cube, from a soak: the triangles of the kept surface are needles, and f64 took another for the one that the normal meets.
#[test]
fn witnesses_among_needles_are_behind_each_other() {
    let replay: Replay = include_str!("replays/needles.txt").parse().expect("a replay");
    let o = replay.tracker().closest(&replay.a, &replay.b, &replay.pose);
    assert_eq!((o.class, o.layer), (Class::Overlapping, Layer::Surface));
    let (pa, pb) = replay.pose.poses();
    let (n, between) = (pa * o.normal.into_inner(), pb * o.point_on_b - pa * o.point_on_a);
    let aside = (between - n * n.dot(&between)).norm();
    assert!(aside <= 1e-14, "{aside:e} {o:?}");
}

//! Promise: a manifold's points lie on the bodies, across from each other; the deepest is the certified answer's; what two faces
//! share is spanned; names last.

mod support;

use lab::contacts::widest_face;
use lab::motion::{self, Frame};
use lab::pose::{add, cross, dot, norm, quat, quat_mul, radius, scale, sub, unit, unit_quat};
use lab::rng::Rng;
use lab::shapes::{self, Shape};
use lab::{Point, Pose, workload};
use lin_canny::{
    Class, ContactPoint, ConvexPolyhedron, FaceId, Feature, FeaturePair, Layer, Manifold, ManifoldOptions, Outcome,
    Tracker,
};

fn exact(prediction: f64, max_points: usize) -> ManifoldOptions {
    let mut o = ManifoldOptions::within(prediction);
    (o.drift, o.choice, o.max_points) = (0.0, 0.0, max_points);
    o
}

fn manifold(a: &ConvexPolyhedron, b: &ConvexPolyhedron, frame: &Frame, options: &ManifoldOptions) -> Manifold {
    let mut m = Manifold::new();
    Tracker::new().manifold(a, b, &support::relative(frame), options, &mut m);
    m
}

/// How far a point is off a feature of its body.
fn off(body: &ConvexPolyhedron, feature: Feature, p: Point) -> f64 {
    let at = |v| -> Point { body.vertex(v).expect("a vertex of the body").coords.into() };
    match feature {
        Feature::Vertex(v) => norm(sub(p, at(v))),
        Feature::Edge(e) => {
            let [q, r] = body.edge_vertices(e).expect("an edge of the body").map(at);
            let (u, w) = (sub(r, q), sub(p, q));
            let t = (dot(u, w) / dot(u, u)).clamp(0.0, 1.0);
            norm(sub(w, scale(u, t)))
        }
        // One face stands for those that lie in its plane but for rounding.
        Feature::Face(f) => {
            let n = body.face_plane(f).expect("a face of the body").0;
            let alike = |g: &FaceId| {
                body.face_plane(*g)
                    .is_some_and(|(m, _)| (m.into_inner() - n.into_inner()).norm() < 1e-12)
            };
            let off = |g| {
                let (n, offset) = body.face_plane(g).expect("a face of the body");
                let n: Point = n.into_inner().into();
                let rim: Vec<Point> = body.face_vertices(g).map(at).collect();
                let beside = |k: usize| {
                    let (q, r) = (rim[k], rim[(k + 1) % rim.len()]);
                    dot(unit(cross(sub(r, q), n)), sub(p, q))
                };
                (0..rim.len()).map(beside).fold((dot(n, p) - offset).abs(), f64::max)
            };
            body.faces().filter(alike).map(off).fold(f64::INFINITY, f64::min)
        }
    }
}

/// What is true of every manifold that was made for this frame; the answer it was made from.
fn judge(
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    frame: &Frame,
    m: &Manifold,
    o: &ManifoldOptions,
    what: &str,
) -> Outcome {
    let size = support::size(a, b, frame);
    let pose = support::relative(frame);
    let outcome = Tracker::new().closest(a, b, &pose);
    let told = || format!("{what}: {m:?}\n{outcome:?}\n{frame:?}");
    // In A's frame, where the offset of both has cancelled.
    let n: Point = m.normal().into_inner().into();
    let a_from_b = frame.relative();
    assert!(m.points().len() <= o.max_points, "{}", told());
    if outcome.lower > o.prediction {
        assert!(m.points().is_empty(), "{}", told());
        return outcome;
    }
    assert!(!m.points().is_empty(), "{}", told());
    // Edges that are parallel but for the angle allowed are not quite across from each other.
    let beside = m.features().is_some_and(|f| support::kinds(f) == (1, 1));
    // Nor are more so than the witnesses.
    let witnesses = {
        let (p, q) = (outcome.point_on_a.coords.into(), outcome.point_on_b.coords.into());
        let between = sub(a_from_b.apply(q), p);
        norm(sub(between, scale(n, outcome.distance)))
    };
    for p in m.points() {
        let (on_a, on_b): (Point, Point) = (p.point_on_a.coords.into(), p.point_on_b.coords.into());
        assert!(support::are_of(p.features, a, b), "{}", told());
        let (from_a, from_b) = (off(a, p.features.a, on_a), off(b, p.features.b, on_b));
        // Where rounding has split faces, the features a solver names need not hold its witnesses.
        let of_answer = p.features == outcome.features && outcome.layer >= Layer::Fallback;
        assert!(
            of_answer || from_a.max(from_b) <= 1e-13 * size,
            "{from_a:e} {from_b:e} {p:?}\n{}",
            told()
        );
        let between = sub(a_from_b.apply(on_b), on_a);
        assert!((dot(between, n) - p.separation).abs() <= 1e-13 * size, "{}", told());
        let aside = sub(between, scale(n, p.separation));
        assert!(
            beside || norm(aside) <= witnesses + 1e-13 * size,
            "{:e} {}",
            norm(aside),
            told()
        );
        assert!(p.separation >= m.lower() - 1e-14 * size, "{}", told());
        assert!(p.separation <= o.prediction.max(m.upper()) + 1e-14 * size, "{}", told());
    }
    let deepest = m.deepest().expect("not empty").separation;
    assert!(
        deepest >= outcome.lower - 1e-14 * size && deepest <= outcome.upper + 1e-14 * size,
        "{deepest:e} {}",
        told()
    );
    for (k, p) in m.points().iter().enumerate() {
        assert!(m.points()[..k].iter().all(|q| q.id != p.id), "{}", told());
    }
    outcome
}

/// Faces in the world seen along `n`, in two coordinates.
fn seen(body: &ConvexPolyhedron, pose: &Pose, feature: Feature, [e1, e2]: [Point; 2]) -> Vec<[f64; 2]> {
    let Feature::Face(f) = feature else { return vec![] };
    let (n, offset) = body.face_plane(f).expect("a face");
    let corners = body
        .vertex_points()
        .filter(|p| (n.dot(&p.coords) - offset).abs() < 1e-11);
    hull(
        corners
            .map(|p| [e1, e2].map(|e| dot(e, pose.apply(p.coords.into()))))
            .collect(),
    )
}

fn area(p: &[[f64; 2]]) -> f64 {
    let turn = |k: usize| {
        let (p, q) = (p[k], p[(k + 1) % p.len()]);
        p[0] * q[1] - p[1] * q[0]
    };
    (0..p.len()).map(turn).sum::<f64>() / 2.0
}

/// One polygon cut by the sides of another, both counter-clockwise (Sutherland and Hodgman).
fn cut(mut p: Vec<[f64; 2]>, by: &[[f64; 2]]) -> Vec<[f64; 2]> {
    for k in 0..by.len() {
        let (q, r) = (by[k], by[(k + 1) % by.len()]);
        let side = |x: [f64; 2]| (r[0] - q[0]) * (x[1] - q[1]) - (r[1] - q[1]) * (x[0] - q[0]);
        let mut out = vec![];
        for i in 0..p.len() {
            let (x, y) = (p[i], p[(i + 1) % p.len()]);
            let (s, t) = (side(x), side(y));
            if s >= 0.0 {
                out.push(x);
            }
            if (s >= 0.0) != (t >= 0.0) {
                let w = s / (s - t);
                out.push([x[0] + w * (y[0] - x[0]), x[1] + w * (y[1] - x[1])]);
            }
        }
        p = out;
    }
    p
}

/// The hull of a few points in the plane, counter-clockwise.
fn hull(mut p: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    p.sort_by(|x, y| x[0].total_cmp(&y[0]).then(x[1].total_cmp(&y[1])));
    let chain = |list: &mut dyn Iterator<Item = &[f64; 2]>| {
        let mut out: Vec<[f64; 2]> = vec![];
        for &x in list {
            while let [.., q, r] = out[..] {
                if (r[0] - q[0]) * (x[1] - q[1]) - (r[1] - q[1]) * (x[0] - q[0]) > 0.0 {
                    break;
                }
                out.pop();
            }
            out.push(x);
        }
        out.pop();
        out
    };
    let (mut low, high) = (chain(&mut p.iter()), chain(&mut p.iter().rev()));
    low.extend(high);
    low
}

/// Area the points of a manifold span, that of what its faces share, and how many corners the latter has.
fn spanned(a: &ConvexPolyhedron, b: &ConvexPolyhedron, frame: &Frame, m: &Manifold) -> Option<(f64, f64, usize)> {
    let f = m.features().filter(|&f| support::kinds(f) == (2, 2))?;
    let n: Point = frame.a.rotate(m.normal().into_inner().into());
    let e1 = unit(cross(
        n,
        if n[0].abs() < 0.6 {
            [1.0, 0.0, 0.0]
        } else {
            [0.0, 1.0, 0.0]
        },
    ));
    let axes = [e1, cross(n, e1)];
    let of_a = seen(a, &frame.a, f.a, axes);
    let of_b = seen(b, &frame.b, f.b, axes);
    let shared = cut(of_a, &of_b);
    let at = |p: &ContactPoint| {
        let x = frame.a.apply(p.point_on_a.coords.into());
        axes.map(|e| dot(e, x))
    };
    let points = hull(m.points().iter().map(at).collect());
    Some((area(&points), area(&shared), shared.len()))
}

/// B's widest face on A's, anywhere on it, tilted by `tilt`.
fn laid(a: &ConvexPolyhedron, b: &ConvexPolyhedron, distance: f64, tilt: f64, rng: &mut Rng) -> Frame {
    let ((face_a, ra), (face_b, rb)) = (widest_face(a), widest_face(b));
    let mut f = workload::stacked(face_a, face_b, rng.range(0.0, 6.3), distance);
    let aside = cross(face_a.1, rng.unit());
    f.b.t = add(f.b.t, scale(aside, 0.8 * rng.uniform() * (ra + rb)));
    f.b.q = unit_quat(quat_mul(quat(unit(cross(face_a.1, rng.unit())), tilt), f.b.q));
    f.moved(&Pose {
        q: rng.quat(),
        t: scale(rng.unit(), 3.0),
    })
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
        let options = exact(0.1, 8);
        let m = manifold(a, b, &frame, &options);
        judge(a, b, &frame, &m, &options, "laid");
        let Some((points, shared, corners)) = spanned(a, b, &frame, &m) else {
            continue;
        };
        if corners <= 8 {
            assert!(
                (points - shared).abs() <= 1e-12,
                "{points} of {shared}: {m:?} {frame:?}"
            );
            whole += 1;
        } else {
            assert!(points >= 0.7 * shared, "{points} of {shared}");
            part += 1;
        }
        let options = exact(0.1, 4);
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
    // Rays out of the tip of a long and narrow shape find its sides, not its other end: which witness of many an answer gives
    // decides whether they begin there.
    assert!(seen[0] > 1000 && seen[1] * 100 < seen[0] && few <= 2, "{seen:?} {few}");
}

/// Frames of all kinds, most of them near contact.
fn hard_frames(rng: &mut Rng, radii: (f64, f64)) -> Vec<Frame> {
    let at = Pose {
        q: rng.quat(),
        t: scale(rng.unit(), 3.0),
    };
    let by = |t: Point, q: [f64; 4]| Frame {
        a: at,
        b: Pose { q, t: add(at.t, t) },
    };
    let near = scale(rng.unit(), rng.range(0.2, 1.1) * (radii.0 + radii.1));
    vec![
        by([0.0; 3], at.q),
        by([0.0; 3], rng.quat()),
        by(scale(rng.unit(), 1e-9), at.q),
        by(near, at.q),
        by(near, rng.quat()),
        by(scale(rng.unit(), 0.5 * radii.0.min(radii.1)), rng.quat()),
    ]
}

#[test]
fn hard_bodies_get_sound_manifolds_whichever_is_named_first() {
    let mut rng = Rng::new(603);
    let mut bodies = shapes::catalogue(7);
    bodies.extend([1e-3, 1e-9].map(|z| shapes::sliver(&mut rng, 24, z)));
    bodies.extend([1e-3, 1e-6].map(|z| shapes::needle(&mut rng, 24, z)));
    bodies.extend([
        shapes::grid(4),
        shapes::chamfered([1.0, 0.7, 0.5], 1e-9),
        shapes::dome(6, 1e-6),
    ]);
    bodies.extend([1e-12, 1e-4, 1e6].map(|s| shapes::cube().stretched([s; 3])));
    let bodies: Vec<(Shape, ConvexPolyhedron)> = bodies.into_iter().map(|s| (s.clone(), support::body(&s))).collect();
    let (mut classes, mut counts, mut alike) = ([0; 4], [0; 9], 0);
    for (sa, a) in &bodies {
        for (sb, b) in &bodies {
            // Concentric bodies of very many faces are for other tests.
            if a.vertex_count().max(b.vertex_count()) > 400 {
                continue;
            }
            for frame in hard_frames(&mut rng, (radius(&sa.points), radius(&sb.points))) {
                let size = support::size(a, b, &frame);
                let options = exact(0.05 * size, 1 + rng.below(8));
                let what = format!("{} {}", sa.name, sb.name);
                let m = manifold(a, b, &frame, &options);
                let o = judge(a, b, &frame, &m, &options, &what);
                classes[o.class as usize] += 1;
                counts[m.points().len()] += 1;
                let back = manifold(b, a, &frame.swapped(), &options);
                judge(b, a, &frame.swapped(), &back, &options, &what);
                alike += u32::from(mirrored(&m, &back, &frame, size));
            }
        }
    }
    assert!(classes[0] > 100 && classes[2] > 1000, "{classes:?}");
    assert!(
        counts[0] > 50 && counts[1] > 500 && counts[4..].iter().sum::<u32>() > 50,
        "{counts:?}"
    );
    assert!(alike > 500, "{alike}");
}

/// Whether both manifolds have one normal; then they have the same points where all fit in.
fn mirrored(m: &Manifold, back: &Manifold, frame: &Frame, size: f64) -> bool {
    let n: Point = frame.a.rotate(m.normal().into_inner().into());
    let of_back: Point = frame.b.rotate(back.normal().into_inner().into());
    let flipped = |f: FeaturePair| FeaturePair { a: f.b, b: f.a };
    if norm(add(n, of_back)) > 1e-12 || m.features() != back.features().map(flipped) {
        return false;
    }
    if m.points().len() < 3 && back.points().len() < 3 {
        let depth = |m: &Manifold| m.deepest().map(|p| p.separation);
        if let (Some(d), Some(e)) = (depth(m), depth(back)) {
            assert!((d - e).abs() <= 1e-13 * size);
        }
    }
    m.points()
        .iter()
        .all(|p| back.points().iter().any(|q| flipped(q.features) == p.features))
}

#[test]
fn names_last_at_rest() {
    let mut rng = Rng::new(604);
    let mut bodies = vec![
        shapes::cube(),
        shapes::cuboid([0.7, 0.4, 0.2]),
        shapes::prism(7, 1.0, 0.3),
    ];
    bodies.push(shapes::prism(48, 1.0, 0.3));
    bodies.push(shapes::sphere(&mut rng, 20));
    let bodies: Vec<_> = bodies.iter().map(support::body).collect();
    let (mut frames, mut fresh, mut full) = (0, 0, 0);
    for (k, a) in bodies.iter().enumerate() {
        for b in &bodies {
            for (noise, drift) in [(1e-6, None), (1e-4, None), (1e-7, Some(0.0))] {
                let ((face_a, _), (face_b, reach)) = (widest_face(a), widest_face(b));
                // Among them corner on corner and edge on edge.
                let spin = if k % 2 == 0 { 0.0 } else { rng.range(0.0, 6.0) };
                let start = workload::stacked(face_a, face_b, spin, -1e-3);
                let (mut pair, mut m) = (Tracker::new(), Manifold::new());
                let mut options = ManifoldOptions::within(0.05);
                options.drift = drift.unwrap_or(options.drift);
                let mut before: Option<Vec<FeaturePair>> = None;
                for frame in workload::at_rest(start, noise, reach, 60, &mut rng) {
                    pair.manifold(a, b, &support::relative(&frame), &options, &mut m);
                    let names: Vec<_> = m.points().iter().map(|p| p.id).collect();
                    if drift.is_none() {
                        assert!(before.as_ref().is_none_or(|b| *b == names), "{before:?} {m:?}");
                    } else if let Some(before) = &before {
                        let lasting = names.iter().filter(|n| before.contains(n)).count();
                        full += usize::from(lasting == names.len());
                    }
                    frames += 1;
                    fresh += usize::from(m.is_fresh());
                    before = Some(names);
                }
            }
        }
    }
    // With no drift allowed every frame asks anew, and rounding chooses among equal corners.
    assert!(frames == 4500 && fresh < 1700 && full > 1000, "{frames} {fresh} {full}");
}

#[test]
fn sliding_contacts_keep_their_names_and_order() {
    let plate = support::body(&shapes::cuboid([4.0, 4.0, 0.5]));
    let cube = support::body(&shapes::cube());
    let (mut pair, mut m) = (Tracker::new(), Manifold::new());
    let options = ManifoldOptions::within(0.05);
    let mut first: Option<Vec<FeaturePair>> = None;
    for k in 0..100 {
        let pose = support::shifted([0.025 * f64::from(k) - 1.0, 0.3, 1.49]);
        pair.manifold(&plate, &cube, &pose, &options, &mut m);
        let names: Vec<_> = m.points().iter().map(|p| p.id).collect();
        assert_eq!(names.len(), 4);
        assert!(m.is_fresh());
        assert_eq!(*first.get_or_insert(names.clone()), names, "{k}");
        assert!((m.points()[0].separation + 0.01).abs() < 1e-14);
    }
}

#[test]
fn old_manifolds_keep_their_bounds() {
    let mut rng = Rng::new(605);
    let (mut old, mut empty, mut anew) = (0, 0, 0);
    for k in 0..60 {
        let n = 6 + rng.below(30);
        let (a, b) = match k % 3 {
            0 => (shapes::cube(), shapes::cuboid([0.3, 0.2, 0.1])),
            1 => (shapes::sphere(&mut rng, n), shapes::sphere(&mut rng, n)),
            _ => (shapes::small(&mut rng), shapes::small(&mut rng)),
        };
        let radii = (radius(&a.points), radius(&b.points));
        let (a, b) = (support::body(&a), support::body(&b));
        let (mut pair, mut m) = (Tracker::new(), Manifold::new());
        let mut options = ManifoldOptions::within(0.02);
        options.drift = 1.0 / 64.0;
        for frame in motion::pass_through(&mut rng, 4000, radii, 0.3) {
            let pose = support::relative(&frame);
            pair.manifold(&a, &b, &pose, &options, &mut m);
            let truth = pair.clone().closest(&a, &b, &pose);
            assert!(m.lower() <= truth.upper && truth.lower <= m.upper(), "{m:?} {truth:?}");
            if m.is_fresh() {
                anew += 1;
                continue;
            }
            if m.points().is_empty() {
                assert!(truth.upper > options.prediction, "{m:?} {truth:?}");
                empty += 1;
                continue;
            }
            let size = support::size(&a, &b, &frame);
            let deepest = m.deepest().expect("not empty").separation;
            assert!(deepest >= m.lower() - 1e-13 * size, "{m:?} {truth:?}");
            assert!(m.upper() - m.lower() < 2.1 * options.drift * radii.0.min(radii.1) + 1e-12 * size);
            old += 1;
        }
    }
    assert!(old > 1000 && empty > 10_000 && anew > 10_000, "{old} {empty} {anew}");
}

#[test]
fn predictions_reach_as_far_as_they_say() {
    let cube = support::body(&shapes::cube());
    let mut count = [0; 2];
    for k in 0..100 {
        let gap = 0.001 * f64::from(k);
        let pose = support::shifted([0.3, 0.2, 2.0 + gap]);
        let mut m = Manifold::new();
        let options = ManifoldOptions::within(0.05);
        Tracker::new().manifold(&cube, &cube, &pose, &options, &mut m);
        if (gap - 0.05).abs() > 1e-12 {
            assert_eq!(m.points().len(), if gap < 0.05 { 4 } else { 0 }, "{gap}");
            count[usize::from(gap < 0.05)] += 1;
        }
    }
    assert!(count.iter().all(|&c| c >= 49));
    // Numbers that are none ask for nothing, and are no harm.
    for (prediction, points) in [(f64::NAN, 0), (-1.0, 0), (f64::INFINITY, 4)] {
        let options = exact(prediction, 100);
        let mut m = Manifold::new();
        Tracker::new().manifold(&cube, &cube, &support::shifted([0.3, 0.2, 1.99]), &options, &mut m);
        assert_eq!(m.points().len(), points);
    }
    let mut options = exact(0.05, 0);
    (options.sine, options.drift) = (f64::NAN, f64::NAN);
    let mut m = Manifold::new();
    Tracker::new().manifold(&cube, &cube, &support::shifted([0.3, 0.2, 1.99]), &options, &mut m);
    assert_eq!(m.points().len(), 1);
}

#[test]
fn manifolds_of_other_bodies_are_made_anew() {
    let cube = support::body(&shapes::cube());
    let shaved = {
        let mut s = shapes::cube();
        s.points.push([1.0, 1.0, 0.99]);
        s.points.retain(|p| *p != [1.0, 1.0, 1.0]);
        support::body(&Shape::hull("shaved", s.points))
    };
    assert_eq!(shaved.vertex_count(), 8);
    let pose = support::shifted([0.0, 0.0, 1.99]);
    let options = ManifoldOptions::within(0.05);
    let (mut pair, mut m) = (Tracker::new(), Manifold::new());
    pair.manifold(&cube, &cube, &pose, &options, &mut m);
    pair.manifold(&cube, &cube, &pose, &options, &mut m);
    assert!(!m.is_fresh());
    pair.manifold(&shaved, &cube, &pose, &options, &mut m);
    assert!(m.is_fresh());
    pair.manifold(&shaved, &cube, &pose, &ManifoldOptions::within(0.06), &mut m);
    assert!(m.is_fresh());
}

/// Edges on faces and edges on edges have two contacts, corners have one.
#[test]
fn edges_and_corners_make_contacts() {
    let cube = support::body(&shapes::cube());
    let quarter = std::f64::consts::FRAC_PI_4;
    let options = exact(0.05, 4);
    let turned = |axis: Point, angle: f64, t: Point| Frame {
        a: Pose::IDENTITY,
        b: Pose::turn(axis, angle, t),
    };
    let root = 2f64.sqrt();
    let on_edge = turned([1.0, 0.0, 0.0], quarter, [0.3, 0.0, 1.0 + root - 0.01]);
    let m = manifold(&cube, &cube, &on_edge, &options);
    assert_eq!((m.points().len(), m.features().map(support::kinds)), (2, Some((2, 1))));
    judge(&cube, &cube, &on_edge, &m, &options, "edge on face");
    // Two edges crosswise.
    let base = Pose::turn([0.0, 1.0, 0.0], quarter, [0.0; 3]);
    let crossed = Frame {
        a: base,
        b: Pose::turn([1.0, 0.0, 0.0], quarter, [0.0, 0.0, 2.0 * root + 0.01]),
    };
    let m = manifold(&cube, &cube, &crossed, &options);
    assert_eq!((m.points().len(), m.features().map(support::kinds)), (1, Some((1, 1))));
    judge(&cube, &cube, &crossed, &m, &options, "edges crosswise");
    // And along each other.
    let along = Frame {
        a: base,
        b: Pose {
            t: [0.0, 0.5, 2.0 * root + 0.01],
            ..base
        },
    };
    let m = manifold(&cube, &cube, &along, &options);
    assert_eq!((m.points().len(), m.features().map(support::kinds)), (2, Some((1, 1))));
    judge(&cube, &cube, &along, &m, &options, "edges along each other");
    let length = (m.points()[0].point_on_a - m.points()[1].point_on_a).norm();
    assert!((length - 1.5).abs() < 1e-12);
    // A corner: the cube on its diagonal.
    let axis = unit([1.0, -1.0, 0.0]);
    let corner = turned(axis, (1.0 / 3f64.sqrt()).acos(), [0.2, 0.1, 1.0 + 3f64.sqrt() - 0.01]);
    let m = manifold(&cube, &cube, &corner, &options);
    let o = judge(&cube, &cube, &corner, &m, &options, "corner on face");
    assert_eq!((m.points().len(), o.class), (1, Class::Overlapping));
}

/// Corners once chosen are kept while they are corners: every frame of a slide is as sound as if it were the first.
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
            let mut options = ManifoldOptions::within(0.02);
            options.drift = 0.0;
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
    assert!(
        frames == 6000 && same > 4500 && least > 0.4,
        "{same} of {frames}, {least}"
    );
}

/// A face that is narrower than rounding, in line with the side of another: what is past its tip is inside of every side of it but for
/// rounding, and not on it.
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
            let place = |t| Pose { q: q.q, t: q.rotate(t) };
            let frame = Frame {
                a: place([0.0; 3]),
                b: place([-0.3, -1.0, 1.0]),
            };
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

/// Which of thousands of faces and edges at a tip bears the contact is found by bisection.
#[test]
fn a_tip_of_thousands_of_faces_is_promoted_to_the_right_one() {
    let mut rng = Rng::new(604);
    let plate = support::body(&shapes::cuboid([4.0, 4.0, 0.1]));
    let (mut faces, mut edges, mut tips) = (0, 0, 0);
    for (n, height) in [(16, 1.0), (120, 0.3), (200, 1.0), (1000, 0.2)] {
        let cone = support::body(&shapes::cone(n, 1.0, height));
        let slope = (1.0f64 / height).atan();
        for k in 0..200 {
            // The cone stands on its tip, leaning until a flank all but lies on the plate.
            let lean = slope.mul_add(-1.0, std::f64::consts::FRAC_PI_2) + [0.0, 0.004, -0.004, 0.1][k % 4];
            let up = [1.0, 0.0, 0.0];
            let turn = quat_mul(
                quat(up, std::f64::consts::PI + lean),
                quat([0.0, 0.0, 1.0], rng.range(0.0, 6.3)),
            );
            let q = unit_quat(turn);
            let tip = Pose { q, t: [0.0; 3] }.rotate([0.0, 0.0, height]);
            let frame = Frame {
                a: Pose::IDENTITY,
                b: Pose {
                    q,
                    t: add([0.0, 0.0, 0.1 + 1e-6], scale(tip, -1.0)),
                },
            };
            let m = manifold(&plate, &cone, &frame, &exact(0.05, 4));
            let Some(f) = m.features() else { continue };
            let n: Point = m.normal().into_inner().into();
            let off = |f: FaceId| {
                let (normal, _) = cone.face_plane(f).expect("a face");
                -dot(frame.b.rotate(normal.into_inner().into()), n)
            };
            let best = cone.faces().map(off).fold(f64::NEG_INFINITY, f64::max);
            let is_near = 1.0 - best * best < (0.99 / 64.0f64).powi(2);
            assert!(!is_near || matches!(f.b, Feature::Face(_)), "{f:?} {best}");
            match f.b {
                Feature::Face(f) => {
                    assert!(off(f) >= best - 1e-12, "{} {best}", off(f));
                    faces += 1;
                }
                Feature::Edge(_) => edges += 1,
                Feature::Vertex(_) => tips += 1,
            }
        }
    }
    assert!(faces > 200 && tips > 30, "{faces} {edges} {tips}");
}

/// An angle below zero is taken as if it were above: corners are not kept for it where they are no more.
#[test]
fn negative_angles_keep_no_corner_off_the_faces() {
    let body = support::body(&shapes::cuboid([1.0, 1.0, 0.2]));
    for sine in [-1.0 / 64.0, -0.4, f64::NEG_INFINITY, f64::INFINITY, f64::NAN] {
        let mut options = ManifoldOptions::within(0.5);
        (options.drift, options.choice, options.sine) = (0.0, 10.0, sine);
        let (mut pair, mut m) = (Tracker::new(), Manifold::new());
        for k in 0..60 {
            let frame = Frame {
                a: Pose::IDENTITY,
                b: Pose {
                    t: [0.05 * f64::from(k), 0.02, 0.8],
                    ..Pose::IDENTITY
                },
            };
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

/// Where a facet of the difference is smaller than rounding, the closest features may name a face that is upright: over a place its
/// height is anything, so it bears nothing.
#[test]
fn upright_faces_bear_no_contact() {
    let mut rng = Rng::new(611);
    let rim = |n: usize, size: f64| {
        let angle = move |k| std::f64::consts::TAU * k as f64 / n as f64;
        (0..n).map(move |k| [size * angle(k).cos(), 0.6 * size * angle(k).sin(), 0.0].into())
    };
    let (mut points, mut overlaps) = (0, 0);
    for k in 0..4000 {
        let size = [1e3, 1e5][k % 2];
        let plate = ConvexPolyhedron::polygon(&rim(100, size).collect::<Vec<_>>()).unwrap();
        let card = (0..3).map(|_| [rng.range(-1.0, 1.0), rng.range(-1.0, 1.0), 0.0].into());
        let card = ConvexPolyhedron::polygon(&card.collect::<Vec<_>>()).unwrap();
        let mut frame = Frame {
            a: Pose::IDENTITY,
            b: Pose {
                q: rng.quat(),
                t: scale(rng.unit(), size),
            },
        };
        // Edge on edge, in each other by no more than rounding.
        for _ in 0..4 {
            let o = Tracker::new().closest(&card, &plate, &support::relative(&frame));
            let by = [0.0, -1e-12, -1e-16, -1e-9][k / 2 % 4] - o.distance;
            frame.b.t = add(frame.b.t, scale(o.normal.into_inner().into(), by));
        }
        let m = manifold(&card, &plate, &frame, &ManifoldOptions::within(4.0));
        for c in m.points() {
            let deeper = m.lower() - c.separation;
            assert!(deeper <= 1e-12 * size, "{k}: {deeper:e} {m:?}");
            points += 1;
        }
        overlaps += usize::from(m.upper() <= 0.0);
    }
    assert!(points > 4000 && overlaps > 500, "{points} {overlaps}");
}

//! Deliberately hard bodies and poses.

use crate::judge::judge;
use crate::{exact, flush, manifold};
use lin_canny::{ConvexPolyhedron, FaceId, Feature, FeaturePair, Manifold, ManifoldOptions, Tracker};
use truth::motion::Frame;
use truth::pose::{add, dot, norm, quat, quat_mul, radius, scale, unit_quat};
use truth::rng::Rng;
use truth::shapes::{self, Shape};
use truth::support;
use truth::{Point, Pose};

/// Returns frames of all kinds, most of them near contact.
fn hard_frames(rng: &mut Rng, radii: (f64, f64)) -> Vec<Frame> {
    let at = Pose::new(rng.quat(), scale(rng.unit(), 3.0));
    let by = |t: Point, q: [f64; 4]| Frame::new(at, Pose::new(q, add(at.t, t)));
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
            // Other tests cover concentric bodies with very many faces.
            if a.vertex_count().max(b.vertex_count()) > 400 {
                continue;
            }
            for frame in hard_frames(&mut rng, (radius(&sa.points), radius(&sb.points))) {
                let size = support::size(a, b, &frame);
                let options = exact(0.05 * size, 1 + rng.below(8));
                let what = format!("{} {}", sa.name, sb.name);
                let m = manifold(a, b, &frame, &options);
                let o = judge(a, b, &frame, &m, &options, &what);
                classes[o.state as usize] += 1;
                counts[m.points().len()] += 1;
                let back = manifold(b, a, &frame.swapped(), &options);
                judge(b, a, &frame.swapped(), &back, &options, &what);
                alike += u32::from(mirrored(&m, &back, &frame, size));
            }
        }
    }
    assert!(classes[0] > 100 && classes[2] > 1000, "{classes:?}");
    assert!(counts[0] > 50, "{counts:?}");
    assert!(counts[1] > 500, "{counts:?}");
    assert!(counts[4..].iter().sum::<u32>() > 50, "{counts:?}");
    assert!(alike > 500, "{alike}");
}

/// Returns whether both manifolds have one normal; then they have the same points if all fit.
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

/// If a facet of the difference is smaller than rounding, the closest features may name an upright
/// face: its height over a position is undefined, so it has no contact.
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
        let mut frame = Frame::new(Pose::IDENTITY, Pose::new(rng.quat(), scale(rng.unit(), size)));
        // Edge on edge, overlapping by no more than rounding.
        for _ in 0..4 {
            let o = Tracker::new().closest(&card, &plate, &support::relative(&frame));
            let by = [0.0, -1e-12, -1e-16, -1e-9][k / 2 % 4] - o.distance;
            frame.b.t = add(frame.b.t, scale(o.normal.into_inner().into(), by));
        }
        let m = manifold(&card, &plate, &frame, &ManifoldOptions::default().prediction(4.0));
        for c in m.points() {
            let deeper = m.lower() - c.separation;
            assert!(deeper <= 1e-12 * size, "{k}: {deeper:e} {m:?}");
            points += 1;
        }
        overlaps += usize::from(m.upper() <= 0.0);
    }
    assert!(points > 4000 && overlaps > 500, "{points} {overlaps}");
}

/// Bisection finds which of thousands of faces and edges at a tip carries the contact.
#[test]
fn a_tip_of_thousands_of_faces_is_promoted_to_the_right_one() {
    let mut rng = Rng::new(604);
    let plate = support::body(&shapes::cuboid([4.0, 4.0, 0.1]));
    let (mut faces, mut edges, mut tips) = (0, 0, 0);
    for (n, height) in [(16, 1.0), (120, 0.3), (200, 1.0), (1000, 0.2)] {
        let cone = support::body(&shapes::cone(n, 1.0, height));
        let slope = (1.0f64 / height).atan();
        for k in 0..200 {
            // The cone stands on its tip, leaning until a side nearly lies on the plate.
            let lean = slope.mul_add(-1.0, std::f64::consts::FRAC_PI_2) + [0.0, 0.004, -0.004, 0.1][k % 4];
            let up = [1.0, 0.0, 0.0];
            let turn = quat_mul(
                quat(up, std::f64::consts::PI + lean),
                quat([0.0, 0.0, 1.0], rng.range(0.0, 6.3)),
            );
            let q = unit_quat(turn);
            let tip = Pose::new(q, [0.0; 3]).rotate([0.0, 0.0, height]);
            let frame = Frame::new(
                Pose::IDENTITY,
                Pose::new(q, add([0.0, 0.0, 0.1 + 1e-6], scale(tip, -1.0))),
            );
            let m = manifold(&plate, &cone, &frame, &flush(0.05, 4));
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

/// A face no wider than rounding on a face with many vertices: rays in it leave anywhere, and its
/// centre may lie outside.
#[test]
fn slivers_upon_large_faces_hold_their_contacts() {
    let mut rng = Rng::new(608);
    let plate = support::body(&shapes::prism(100, 1.0, 0.5));
    let size = |p: Point| norm(p);
    let (mut many, mut few) = (0, 0);
    for _ in 0..600 {
        let (m, width) = (3 + rng.below(20), rng.log_range(1e-18, 1.0));
        let corner = |k: usize| std::f64::consts::TAU * (k as f64 + 0.3) / m as f64;
        let rim: Vec<Point> = (0..m)
            .map(|k| [width * corner(k).cos(), corner(k).sin(), 0.0])
            .collect();
        let points: Vec<_> = rim.iter().map(|&p| p.into()).collect();
        let Ok(blade) = ConvexPolyhedron::polygon(&points) else {
            continue;
        };
        let t = [rng.range(-1.0, 1.0), rng.range(-1.0, 1.0), 0.5 + rng.range(-1e-3, 1e-3)];
        let b = Pose::turn([0.0, 0.0, 1.0], rng.range(0.0, 6.0), t);
        let frame = Frame::new(Pose::IDENTITY, b);
        let m = manifold(&plate, &blade, &frame, &exact(0.01, 8));
        for contact in m.points() {
            let off = |body: &ConvexPolyhedron, p| (body.closest_point(&p).unwrap() - p).into();
            let (on_a, on_b) = (contact.point_on_a, contact.point_on_b);
            let (a, b): (Point, Point) = (off(&plate, on_a), off(&blade, on_b));
            assert!(size(a) <= 1e-13 && size(b) <= 1e-13, "{width:e}: {contact:?}");
        }
        *(if m.points().len() > 2 { &mut many } else { &mut few }) += 1;
    }
    assert!(many > 200 && few > 50, "{many} {few}");
}

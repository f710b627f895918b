//! Polyhedra: bodies, pairs, depths, contacts, half-spaces, files.

use super::WITHIN;
use crate::make::*;
use crate::{Random, Teller};
use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{
    Accuracy, ConvexPolyhedron, Geometry, HalfSpace, Manifold, ManifoldOptions, PairTracker, QueryOptions, Replay,
    Shape, Tracker,
};

pub(super) fn hulls(t: &mut Teller, r: &mut Random) {
    for k in 0..t.rounds(1500) {
        let n = 4 + r.below(if k % 50 == 0 { 600 } else { 60 }) as usize;
        let form = r.below(6);
        let mut points = cloud(r, n, form);
        if k % 7 == 0 {
            let scale = [1e-90, 1e-12, 1e12, 1e90][r.below(4) as usize];
            points.iter_mut().for_each(|p| *p *= scale);
        }
        match ConvexPolyhedron::from_points(&points) {
            Ok(found) => {
                body(t, &found);
                t.tell("mass", (found.volume(), found.centroid(), found.inertia()));
                for _ in 0..3 {
                    let p = Point3::from(in_ball(r) * 2.0);
                    t.tell(
                        "point",
                        (
                            found.contains(&p),
                            found.closest_point(&p),
                            found.extreme_vertex(&p.coords),
                        ),
                    );
                    t.tell("box", found.aabb_at(&isometry(r, 1.0), &mut Default::default()));
                }
                let moved = found.transformed(&isometry(r, 1.0));
                t.tell("moved", moved.map(|b| b.vertex_points().collect::<Vec<_>>()));
            }
            Err(e) => t.tell("error", e),
        }
    }
}

pub(super) fn basic_solids(t: &mut Teller, r: &mut Random) {
    for n in 4..t.rounds(120) as usize + 4 {
        for found in [solids::prism(n, 0.7, 0.9), solids::cone(n, 0.7, 0.9)] {
            body(t, &found.expect("a solid"));
        }
        let axes = Vector3::new(r.range(0.3, 1.2), r.range(0.3, 1.2), r.range(0.3, 1.2));
        body(t, &solids::random_hull(n, axes, n as u64).expect("a hull"));
    }
    for k in 0..4 {
        body(t, &solids::geodesic_sphere(k, 1.1).expect("a ball"));
    }
    for found in [
        solids::tetrahedron(0.9),
        solids::octahedron(0.9),
        solids::icosahedron(0.9),
        solids::dodecahedron(0.9),
    ] {
        body(t, &found.expect("a solid"));
    }
}

fn body(t: &mut Teller, body: &ConvexPolyhedron) {
    t.tell("report", body.report());
    t.tell("vertices", body.vertex_points().collect::<Vec<_>>());
    let faces: Vec<_> = body
        .faces()
        .map(|f| (body.face_vertices(f).collect::<Vec<_>>(), body.face_plane(f)))
        .collect();
    t.tell("faces", faces);
    t.tell("box", (body.aabb(), body.bounding_ball()));
}

pub(super) fn masses(t: &mut Teller, r: &mut Random) {
    for _ in 0..t.rounds(800) {
        let [a, b, c, d] = std::array::from_fn(|_| r.range(0.1, 2.0));
        let axes = Vector3::new(a, b, c);
        let shapes = [
            Shape::ball(a),
            Shape::capsule(a, b),
            Shape::cuboid(axes).and_then(|s| s.rounded(d)),
            Shape::cylinder(a, b).and_then(|s| s.rounded(d)),
            Shape::cone(a, b).and_then(|s| s.rounded(d)),
            Shape::ellipsoid(axes),
            Ok(Shape::from(round(r, 20)).rounded(d).expect("a shape")),
        ];
        for shape in shapes {
            match shape {
                Ok(s) => t.tell("mass", s.mass()),
                Err(e) => t.tell("error", e),
            }
        }
    }
}

pub(super) fn pairs(t: &mut Teller, r: &mut Random) {
    for k in 0..t.rounds(60) {
        let n = [8, 20, 60, 300][k as usize % 4];
        let (fa, fb) = (r.below(2), r.below(2));
        let (a, b) = (hull(r, n, fa), hull(r, n, fb));
        let step = [0.002, 0.03, 0.2][k as usize % 3];
        let (mut drift, mut warm, mut local) = (Drift::new(r, step, 1.7), Tracker::new(), Tracker::new());
        for frame in 0..60 {
            let pose = relative(&drift.next(r));
            let o = warm.closest(&a, &b, &pose);
            t.tell("closest", o);
            t.tell("gradients", (o.gradient_a(), o.gradient_b(&pose)));
            t.tell("local", local.closest_with_local_depth(&a, &b, &pose));
            if frame % 4 == 0 {
                t.tell("distance", warm.distance(&a, &b, &pose));
                t.tell("propose", warm.propose(&a, &b, &pose));
                t.tell("intersects", warm.intersects(&a, &b, &pose));
                t.tell("within", WITHIN.map(|d| warm.within(&a, &b, &pose, d)));
                t.tell("trace", warm.trace(&a, &b, &pose));
            }
        }
    }
}

pub(super) fn cold_pairs(t: &mut Teller, r: &mut Random) {
    for k in 0..t.rounds(4000) {
        let n = 4 + r.below(if k % 100 == 0 { 400 } else { 60 }) as usize;
        let (fa, fb) = (r.below(5), r.below(3));
        let (a, b) = (hull(r, n, fa), hull(r, n, fb));
        let apart = r.range(0.0, 3.0);
        let pose = pose(r, apart);
        t.tell("closest", Tracker::new().closest(&a, &b, &pose));
        t.tell("intersects", Tracker::new().intersects(&a, &b, &pose));
        t.tell("within", WITHIN.map(|d| Tracker::new().within(&a, &b, &pose, d)));
    }
}

/// Ties, touches, sizes, subnormals: lattices, the same body twice, poses of whole numbers.
pub(super) fn hard_pairs(t: &mut Teller, r: &mut Random) {
    let quarter = |r: &mut Random| {
        let s = 0.5_f64.sqrt();
        let all = [
            [1., 0., 0., 0.],
            [0., 1., 0., 0.],
            [0., 0., 1., 0.],
            [s, s, 0., 0.],
            [s, 0., s, 0.],
            [0.5, 0.5, 0.5, 0.5],
            [s, 0., 0., -s],
        ];
        let [w, x, y, z] = all[r.below(7) as usize];
        UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z))
    };
    for k in 0..t.rounds(2500) {
        let (fa, fb) = (2 + r.below(4), 2 + r.below(4));
        let a = if k % 3 == 0 {
            solids::cuboid(Vector3::new(1.0, 0.5, 0.25)).expect("a box")
        } else {
            hull(r, 20, fa)
        };
        let b = if k % 5 == 0 { a.clone() } else { hull(r, 16, fb) };
        let at = Vector3::from_fn(|_, _| r.below(9) as f64 * 0.25 - 1.0);
        let nudge = [0.0, 0.0, 1e-16, -1e-15, 1e-13, -1e-300][r.below(6) as usize];
        let pose = Isometry3::from_parts(Translation3::from(at.add_scalar(nudge)), quarter(r));
        let pose = relative(&pose);
        let (mut warm, mut other) = (Tracker::new(), Tracker::new());
        t.tell("closest", warm.closest(&a, &b, &pose));
        t.tell("again", warm.closest(&a, &b, &pose));
        t.tell("back", other.closest(&b, &a, &pose.swapped()));
        t.tell("intersects", warm.intersects(&a, &b, &pose));
        t.tell("within", WITHIN.map(|d| warm.within(&a, &b, &pose, d)));
    }
    for e in [-310.0, -200.0, -100.0, 100.0, 200.0, 299.0_f64] {
        for _ in 0..t.rounds(20) {
            let unit = (0..e.abs() as i32).fold(1.0, |x, _| if e < 0.0 { x * 0.5 } else { x * 2.0 });
            let points = |r: &mut Random| cloud(r, 16, 0).iter().map(|p| *p * unit).collect::<Vec<_>>();
            let (a, b) = (points(r), points(r));
            let (a, b) = (ConvexPolyhedron::from_points(&a), ConvexPolyhedron::from_points(&b));
            let (Ok(a), Ok(b)) = (a, b) else {
                t.tell("none", e);
                continue;
            };
            let apart = r.range(0.5, 3.0);
            let mut at = isometry(r, apart);
            at.translation.vector *= unit;
            let pose = relative(&at);
            t.tell("closest", Tracker::new().closest(&a, &b, &pose));
            t.tell("exact", Tracker::new().closest_exact(&a, &b, &pose));
        }
    }
}

pub(super) fn exact(t: &mut Teller, r: &mut Random) {
    for k in 0..t.rounds(3000) {
        let (fa, fb) = (r.below(6), r.below(6));
        let (a, b) = (hull(r, 16, fa), hull(r, 12, fb));
        let apart = r.range(0.0, 3.0);
        let mut at = isometry(r, apart);
        if k % 4 == 0 {
            at.rotation = UnitQuaternion::identity();
            at.translation.vector = Vector3::from_fn(|_, _| r.below(9) as f64 * 0.25 - 1.0);
        }
        t.tell("exact", Tracker::new().closest_exact(&a, &b, &relative(&at)));
    }
}

pub(super) fn depths(t: &mut Teller, r: &mut Random) {
    for k in 0..t.rounds(120) {
        let n = [8, 30, 120][k as usize % 3];
        let (fa, fb) = (r.below(5), r.below(3));
        let (a, b) = (hull(r, n, fa), hull(r, n, fb));
        let (mut warm, mut local) = (Tracker::new(), Tracker::new());
        let about = [0.05, 0.4, 0.9][r.below(3) as usize];
        let mut drift = Drift::new(r, 0.02, about);
        for _ in 0..15 {
            let pose = relative(&drift.next(r));
            t.tell("warm", warm.closest(&a, &b, &pose));
            t.tell("cold", Tracker::new().closest(&a, &b, &pose));
            t.tell("local", local.closest_with_local_depth(&a, &b, &pose));
            t.tell("distance", warm.distance(&a, &b, &pose));
        }
        let middle = relative(&Isometry3::from_parts(Translation3::identity(), turn(r, 3.0)));
        t.tell("concentric", warm.closest(&a, &b, &middle));
        t.tell(
            "same place",
            Tracker::new().closest(&a, &a, &relative(&Isometry3::identity())),
        );
    }
}

pub(super) fn manifolds(t: &mut Teller, r: &mut Random) {
    for k in 0..t.rounds(150) {
        let half = Vector3::new(0.5, r.range(0.3, 1.0), 0.5);
        let a = solids::cuboid(half).expect("a box");
        let b = match k % 3 {
            0 => solids::prism(3 + r.below(30) as usize, 0.5, 0.6).expect("a prism"),
            1 => a.clone(),
            _ => hull(r, 20, 2),
        };
        let options = ManifoldOptions::default().prediction(0.1);
        let (mut warm, mut manifold) = (Tracker::new(), Manifold::new());
        for frame in 0..25 {
            // Upon each other, nearly flat.
            let tilt = in_ball(r) * [0.0, 1e-9, 1e-3, 0.1][r.below(4) as usize];
            let n = (1.0 + tilt.norm_squared()).sqrt();
            let q = Quaternion::new(1.0 / n, tilt.x / n, tilt.y / n, tilt.z / n);
            let at = Vector3::new(r.range(-0.3, 0.3), 0.01 * f64::from(frame), 0.98 + r.range(0.0, 0.04));
            let pose = relative(&Isometry3::from_parts(
                Translation3::from(at),
                UnitQuaternion::new_unchecked(q),
            ));
            let mut options = options;
            options.local_depth = frame % 2 == 1;
            warm.manifold(&a, &b, &pose, &options, &mut manifold);
            t.tell("manifold", &manifold);
            let still = Vector3::zeros();
            let (v, w) = (in_ball(r), in_ball(r));
            t.tell("rate", manifold.rate(&pose, &still, &still, &v, &w));
            let o = warm.closest(&a, &b, &pose);
            t.tell("of outcome", Manifold::from_outcome(&a, &b, &pose, &o, &options));
        }
    }
}

pub(super) fn half_spaces(t: &mut Teller, r: &mut Random) {
    for _ in 0..t.rounds(2500) {
        let form = r.below(5);
        let body = hull(r, 20, form);
        let floor = HalfSpace::new(unit(r), r.range(-1.0, 1.0)).expect("a half-space");
        let apart = r.range(0.0, 2.0);
        let pose = pose(r, apart);
        t.tell("distance", floor.distance(&body, &pose));
        t.tell(
            "contacts",
            floor.contacts(&body, &pose, &ManifoldOptions::default().prediction(0.2)),
        );
    }
}

pub(super) fn files(t: &mut Teller, r: &mut Random) {
    for k in 0..t.rounds(200) {
        let (a, b) = (hull(r, 20, k % 5), round(r, 12));
        let apart = r.range(0.0, 3.0);
        let at = isometry(r, apart);
        let pose = relative(&at);
        let mut tracker = Tracker::new();
        let outcome = tracker.closest(&a, &b, &pose);
        let json =
            |t: &mut Teller, what: &str, text: Result<String, serde_json::Error>| t.tell(what, text.expect("JSON"));
        json(t, "body", serde_json::to_string(&a));
        json(t, "outcome", serde_json::to_string(&outcome));
        json(t, "tracker", serde_json::to_string(&tracker));
        let text = tracker.replay(&a, &b, &pose, Accuracy::Certified).to_string();
        t.tell("replay", &text);
        let replay: Replay = text.parse().expect("a replay");
        t.tell("replayed", replay.tracker().closest(&replay.a, &replay.b, &replay.pose));
        let geometries: [Geometry; 4] = [
            a.into(),
            dented(&b, 0.8).into(),
            compound(r).into(),
            bumpy(r, [2, 2], true).into(),
        ];
        let mut recorder = lin_canny_record::Recorder::new(Vec::new(), "bits").expect("a recorder");
        let mut pair = PairTracker::new();
        for g in &geometries {
            json(t, "geometry", serde_json::to_string(g));
            let back: Geometry = serde_json::from_str(&serde_json::to_string(g).expect("JSON")).expect("a geometry");
            json(t, "again", serde_json::to_string(&back));
            let n = recorder.body("body", g, &isometry(r, 1.0)).expect("a body");
            if n > 0 {
                let found = pair.closest_with(&geometries[0], &back, &pose, &QueryOptions::default().splits(300));
                recorder.answer(0, n, &found).expect("an answer");
            }
        }
        recorder.end_frame().expect("a frame");
        let bytes = recorder.finish().expect("bytes");
        t.tell("recording", String::from_utf8(bytes.clone()).expect("text"));
        let read = lin_canny_record::Recording::read(&bytes[..]).expect("a recording");
        t.tell("frames", &read.frames);
    }
}

//! Motions and casts.

use crate::make::*;
use crate::{Random, Teller};
use lin_canny::continuous::{self, MovingMesh, elements};
use lin_canny::impact::{Tolerance, cast, cast_with_certificates, cast_within, free_until, overlapping_until};
use lin_canny::motion::Motion;
use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::separation::Separation;
use lin_canny::{Mesh, PairTracker, RelativePose, Tracker};

pub(super) fn motions(t: &mut Teller, r: &mut Random) {
    for _ in 0..t.rounds(2500) {
        let (steady, nlerp) = (steady(r, 2.0), nlerp(r, 2.0));
        for time in [0.0, r.range(0.0, 1.0), 1.0] {
            t.tell("steady", (steady.pose(time), steady.model(time, 0.1)));
            t.tell("nlerp", (nlerp.pose(time), nlerp.model(time, 0.1)));
        }
        let drift = steady.model(0.0, 1.0).drift(1.3);
        t.tell("drift", (drift, drift.at(0.3)));
        t.tell("velocity", velocity(r, 1.0, 4.0).applied(&isometry(r, 1.0), 0.37));
        t.tell("normalised", lin_canny::normalize_rotation(&isometry(r, 1.0)));
        t.tell("relative", RelativePose::new(&isometry(r, 1.0), &isometry(r, 1.0)));
    }
}

fn casts(t: &mut Teller, r: &mut Random, rounds: u64, mut pair: impl Separation) {
    for _ in 0..rounds {
        let (p, q) = (steady(r, 2.0), steady(r, 3.0));
        let n = nlerp(r, 3.0);
        let span = || 0.0..1.0;
        for tolerance in [Tolerance::Distance(1e-4), Tolerance::Time(1e-4)] {
            t.tell("cast", cast(&mut pair, &p, &q, span(), tolerance));
            t.tell("within", cast_within(&mut pair, &p, &n, span(), tolerance, 0.2));
        }
        t.tell("free", free_until(&mut pair, &p, &q, span(), 0.1));
        t.tell("held", overlapping_until(&pair, &p, &q, span(), 0.1));
        let mut trail = Vec::new();
        let found = cast_with_certificates(&mut pair, &p, &q, span(), Tolerance::Distance(1e-3), 0.0, &mut trail);
        t.tell("proving", (found, trail));
    }
}

pub(super) fn casts_of_hulls(t: &mut Teller, r: &mut Random) {
    for _ in 0..t.rounds(150) {
        let (a, b) = (round(r, 20), hull(r, 40, 1));
        casts(t, r, 4, Tracker::new().pair(&a, &b));
    }
}

pub(super) fn casts_of_shapes(t: &mut Teller, r: &mut Random) {
    let shapes = curved();
    for k in 0..t.rounds(500) as usize {
        let (a, b) = (
            &shapes[k % shapes.len()],
            &shapes[r.below(shapes.len() as u64) as usize],
        );
        casts(t, r, 2, PairTracker::new().pair(a, b));
    }
}

pub(super) fn casts_of_meshes(t: &mut Teller, r: &mut Random) {
    for _ in 0..t.rounds(12) {
        let body = round(r, 24);
        let (a, b, c) = (dented(&body, 0.8), dented(&round(r, 24), 0.7), compound(r));
        casts(t, r, 2, PairTracker::new().pair(&a, &b));
        casts(t, r, 2, PairTracker::new().pair(&c, &b));
        casts(t, r, 2, PairTracker::new().pair(&c, &body));
    }
}

pub(super) fn casts_of_surfaces(t: &mut Teller, r: &mut Random) {
    let shapes = curved();
    for k in 0..t.rounds(20) as usize {
        let (a, b) = (bumpy(r, [2, 2], false), bumpy(r, [2, 3], true));
        casts(t, r, 1, PairTracker::new().pair(&a, &b));
        casts(t, r, 1, PairTracker::new().pair(&a, &shapes[k % shapes.len()]));
    }
}

/// The normals of planes that turn, for whoever checks a certificate.
pub(super) fn plane_normals(t: &mut Teller, r: &mut Random) {
    for _ in 0..t.rounds(400) {
        let (a, b) = (round(r, 20), hull(r, 40, 1));
        let mut pair = Tracker::new();
        let mut pair = pair.pair(&a, &b);
        let (p, q) = (steady(r, 2.0), steady(r, 3.0));
        let mut trail = Vec::new();
        let _ = cast_with_certificates(&mut pair, &p, &q, 0.0..1.0, Tolerance::Distance(1e-3), 0.0, &mut trail);
        for certificate in trail {
            let time = 0.5 * (certificate.from + certificate.until);
            t.tell("normal", certificate.normal(time));
            t.tell("gap", certificate.gap(&mut pair, &p, &q, time));
        }
    }
}

pub(super) fn continuous_contacts(t: &mut Teller, r: &mut Random) {
    for _ in 0..t.rounds(2000) {
        let path = |r: &mut Random, z: f64| {
            let p = in_ball(r);
            [
                Point3::from(p + Vector3::z() * z),
                Point3::from(p + in_ball(r) - Vector3::z() * z),
            ]
        };
        let a = [path(r, 0.0), path(r, 0.0), path(r, 0.0)];
        let b = [path(r, 0.7), path(r, 0.7), path(r, 0.7)];
        let tolerance = Tolerance::Time(1e-6);
        t.tell("triangles", elements::cast_triangles(&a, &b, tolerance));
        t.tell("vertex", elements::cast_vertex_face(&[b[0]], &a, tolerance));
        t.tell(
            "edges",
            elements::cast_edge_edge(&[a[0], a[1]], &[b[0], b[1]], tolerance),
        );
    }
    for _ in 0..t.rounds(40) {
        let (points, triangles) = sheet(8, |x, y| 0.2 * x * y);
        let (other, _) = sheet(8, |x, y| 0.3 - 0.2 * x * y * y);
        let mut moved = |points: &[Point3<f64>], by: f64| {
            points
                .iter()
                .map(|p| p + in_ball(r) * 0.1 + Vector3::z() * by)
                .collect::<Vec<_>>()
        };
        let mesh = |p: &[Point3<f64>]| Mesh::new(p, &triangles).expect("a mesh");
        let (a, b) = (mesh(&points), mesh(&other));
        let (mut c, mut d) = (a.clone(), b.clone());
        let later = [moved(&points, 0.2), moved(&other, -0.2)];
        c.set_vertices(&later[0]).expect("vertices");
        d.set_vertices(&later[1]).expect("vertices");
        let (p, q) = (
            MovingMesh::new(&a, &c).expect("one mesh"),
            MovingMesh::new(&b, &d).expect("one mesh"),
        );
        t.tell("meshes", continuous::cast_meshes(&p, &q, Tolerance::Time(1e-6)));
        t.tell("self", continuous::cast_self(&p, Tolerance::Time(1e-6)));
    }
}

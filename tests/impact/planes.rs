//! The proven time of every plane, judged by brute force over all vertices.

use super::{bodies, radius};
use lin_canny::Tracker;
use lin_canny::impact::{Certificate, Tolerance, cast_with_certificates, free_until};
use lin_canny::motion::{Motion, Nlerp, Steady};
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::separation::Proof;
use lin_canny::{ConvexPolyhedron, Velocity};
use truth::casts;
use truth::rng::Rng;

/// Returns the gap along `n` of the world frame, over all vertices.
fn gap(a: &ConvexPolyhedron, pa: &Isometry3<f64>, b: &ConvexPolyhedron, pb: &Isometry3<f64>, n: &Vector3<f64>) -> f64 {
    let offset = pb.translation.vector - pa.translation.vector;
    let high = a
        .vertex_points()
        .map(|p| n.dot(&(pa.rotation * p.coords)))
        .fold(f64::NEG_INFINITY, f64::max);
    let low = b
        .vertex_points()
        .map(|p| n.dot(&(pb.rotation * p.coords)))
        .fold(f64::INFINITY, f64::min);
    n.dot(&offset) + low - high
}

#[derive(Default, Debug)]
struct Seen {
    planes: u32,
    balls: u32,
    whole: u32,
    cut: u32,
    /// Fraction of the true time of a plane that was proven.
    part: Vec<f64>,
    /// Steps by planes with a fixed normal, and their fractions.
    kept: u32,
    kept_part: Vec<f64>,
}

impl Seen {
    /// Asserts that casts used planes with a fixed normal, and that these are good.
    fn assert_kept(&mut self, least: u32) {
        let part = median(&mut self.kept_part);
        eprintln!("{} planes that keep their normal, median part {part}", self.kept);
        assert!(self.kept > least && part > 0.75, "{} {part}", self.kept);
    }
}

/// Judges one step, and every step of a cast.
fn judge<A: Motion, B: Motion>(
    bodies: (&ConvexPolyhedron, &ConvexPolyhedron),
    motions: (&A, &B),
    from: f64,
    distance: f64,
    seen: &mut Seen,
) {
    let mut tracker = Tracker::new();
    let mut pair = tracker.pair(bodies.0, bodies.1);
    let (ma, mb) = motions;
    let look = free_until(&mut pair, ma, mb, from..1.0, distance).expect("an answer");
    if let Some(part) = holds(bodies, motions, &look) {
        seen.planes += 1;
        seen.cut += u32::from(part < 1.0);
        seen.whole += u32::from(look.until == 1.0);
        if look.until < 1.0 {
            seen.part.push(part);
        }
    } else {
        seen.balls += 1;
    }
    let mut steps = Vec::new();
    let tolerance = Tolerance::Distance(1e-9);
    cast_with_certificates(&mut pair, ma, mb, from..1.0, tolerance, distance, &mut steps).expect("a cast");
    for step in steps {
        let keeps = matches!(step.proof, Proof::Plane { spin, .. } if spin == Vector3::zeros());
        if let Some(part) = holds(bodies, motions, &step)
            && keeps
        {
            seen.kept += 1;
            if step.until < 1.0 {
                seen.kept_part.push(part);
            }
        }
    }
}

/// Asserts that the plane of a certificate separates all vertices for the stated time.
///
/// Returns the fraction of the true time that was proven; `None` if no plane proves it.
fn holds<A: Motion, B: Motion>(
    (a, b): (&ConvexPolyhedron, &ConvexPolyhedron),
    (ma, mb): (&A, &B),
    certificate: &Certificate,
) -> Option<f64> {
    let Certificate {
        from, until, distance, ..
    } = *certificate;
    let mut tracker = Tracker::new();
    let mut pair = tracker.pair(a, b);
    certificate.normal(from).filter(|_| until > from)?;
    let at = |t: f64| {
        let n = certificate.normal(t).expect("a plane");
        gap(a, &ma.pose(t), b, &mb.pose(t), &n)
    };
    for k in 0..=40 {
        let t = if k == 40 {
            until
        } else {
            from + (until - from) * f64::from(k) / 40.0
        };
        let g = at(t);
        assert!(g > distance, "{g} at {t} of {certificate:?}");
        let by_supports = certificate.gap(&mut pair, ma, mb, t).expect("a plane");
        let off = (g - by_supports).abs();
        assert!(off < 1e-12 * (1.0 + radius(a) + radius(b) + 10.0), "{g} {by_supports}");
    }
    let later = |k: u32| until + 0.01 * f64::from(k) * (until - from);
    let end = (0..400).map(later).find(|t| *t >= 1.0 || at(*t) <= distance);
    Some((until - from) / (end.unwrap_or(later(400)) - from))
}

fn median(list: &mut [f64]) -> f64 {
    list.sort_by(f64::total_cmp);
    list[list.len() / 2]
}

#[test]
fn planes_hold_over_all_vertices() {
    let mut rng = Rng::new(1907);
    let bodies = bodies(&mut rng);
    let mut seen = Seen::default();
    for k in 0..12_000 {
        let (a, b) = (rng.pick(&bodies).clone(), rng.pick(&bodies).clone());
        let turn = [0.0, 0.3, 1.0, 6.0, 60.0][k % 5];
        let mut throw = casts::aimed(&mut rng, (radius(&a), radius(&b)), turn);
        if k % 3 == 0 {
            throw = throw.swapped();
        }
        let [ma, mb] = throw.motions();
        let from = rng.range(0.0, 0.9);
        let distance = if k % 4 == 0 { 0.05 } else { 0.0 };
        judge((&a, &b), (&ma, &mb), from, distance, &mut seen);
    }
    let part = median(&mut seen.part);
    let (planes, balls, whole, cut) = (seen.planes, seen.balls, seen.whole, seen.cut);
    eprintln!("{planes} planes, {balls} by balls, {whole} to the end, {cut} cut, median part {part}");
    assert!(planes > 4_000 && cut > 1_500 && whole > 300 && part > 0.75);
    seen.assert_kept(4_000);
}

/// Pivots off the origin, accelerations, sweeps by nlerp, bodies far from their origins.
#[test]
fn planes_hold_for_every_motion() {
    let mut rng = Rng::new(1908);
    let bodies = bodies(&mut rng);
    let mut seen = Seen::default();
    for k in 0..6_000 {
        let (a, b) = (rng.pick(&bodies).clone(), rng.pick(&bodies).clone());
        let throw = casts::aimed(&mut rng, (radius(&a), radius(&b)), 2.0);
        let pivot = Point3::from(Vector3::from(rng.in_ball()) * 3.0);
        let [va, vb] = throw.velocity;
        let [sa, sb] = throw.start;
        let push = Vector3::from(rng.in_ball()) * 5.0;
        let ma = Steady::about(&sa, pivot, va)
            .and_then(|m| m.with_acceleration(push))
            .expect("a motion");
        let from = rng.range(0.0, 0.9);
        if k % 2 == 0 {
            let mb = Steady::new(&sb, vb)
                .and_then(|m| m.with_acceleration_bounds(0.3, 0.2))
                .expect("a motion");
            judge((&a, &b), (&ma, &mb), from, 0.0, &mut seen);
        } else {
            let end = Velocity::new(vb.linear, Vector3::from(rng.in_ball()) * 3.0).applied(&sb, 1.0);
            let mb = Nlerp::new(&sb, &end, 1.0, Point3::new(0.1, 0.2, 0.3)).expect("a motion");
            judge((&a, &b), (&ma, &mb), from, 0.0, &mut seen);
        }
    }
    let part = median(&mut seen.part);
    eprintln!("{} planes, {} cut, median part {part}", seen.planes, seen.cut);
    assert!(seen.planes > 1_500 && seen.cut > 500, "{} {}", seen.planes, seen.cut);
    seen.assert_kept(1_000);
}

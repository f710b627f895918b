//! Promise: distances agree with an independent engine, within that engine's accuracy.
//!
//! parry3d-f64 is queried twice: through its own hull, cold, and through its generic GJK with a
//! cached simplex over our points. Its accuracy (`truth::parry::tolerance`): bodies of size about
//! 1, relative error below 6e-8 or `1e-15 / gap`.

use lin_canny::nalgebra::Vector3;
use lin_canny::polyhedron::solids;
use lin_canny::{ContactState, ConvexPolyhedron, Outcome, Tracker};
use truth::motion::{Frame, random_poses};
use truth::parry::{self, Climber, GjkCached, tolerance};
use truth::pose::{add, radius, scale};
use truth::rng::Rng;
use truth::shapes::Shape;
use truth::support;

/// Number of separated poses over all pairs.
const POSES: usize = 100_000;

/// Number of separated poses of one pair.
const OF_PAIR: usize = 500;

/// A body in the form of each engine.
struct Engines {
    ours: ConvexPolyhedron,
    shape: Shape,
    climber: Climber,
    hull: Option<parry::Hull>,
}

impl Engines {
    fn new(ours: ConvexPolyhedron) -> Self {
        let shape = support::plain(&ours);
        let hull = parry::hull(&shape.points).filter(|h| h.points().len() == shape.points.len());
        let climber = Climber::new(&shape.points, &shape.faces);
        Self {
            ours,
            shape,
            climber,
            hull,
        }
    }
}

/// Returns the frame with its gap reduced to a random small one along the line of the witnesses.
fn closed_in(frame: &Frame, o: &Outcome, rng: &mut Rng) -> Frame {
    let gap = rng.log_range(1e-6, 1e-1).min(o.distance);
    let normal = frame.a.rotate(o.normal.into_inner().into());
    let mut near = *frame;
    near.b.t = add(near.b.t, scale(normal, gap - o.distance));
    near
}

/// Counts that show that the test is not empty.
#[derive(Default)]
struct Seen {
    separated: usize,
    by_hull: usize,
    near: usize,
    overlapping: usize,
}

fn compare(a: &Engines, b: &Engines, rng: &mut Rng, seen: &mut Seen) {
    let radii = (radius(&a.shape.points), radius(&b.shape.points));
    let (mut tracker, mut cache, mut count) = (Tracker::new(), GjkCached::default(), 0);
    while count < OF_PAIR {
        let first = random_poses(rng, 1, radii, (0.3, 1.5), 1.0)[0];
        let o = tracker.closest(&a.ours, &b.ours, &support::relative(&first));
        let mut frames = vec![first];
        if o.state == ContactState::Separated {
            frames.push(closed_in(&first, &o, rng));
        }
        for f in frames {
            let o = tracker.closest(&a.ours, &b.ours, &support::relative(&f));
            let gjk = cache
                .closest(&a.climber, &f.a, &b.climber, &f.b)
                .map_or(0.0, |w| w.distance);
            if o.state != ContactState::Separated {
                seen.overlapping += 1;
                assert!(gjk < 1e-7, "parry: {gjk:e} apart, ours {o:?} {f:?}");
                continue;
            }
            let agrees = |d: f64| (d - o.distance).abs() <= tolerance(o.distance) * o.distance;
            assert!(
                agrees(gjk),
                "parry's GJK: {gjk:e}, ours {o:?}\n{:?}\n{:?} {f:?}",
                a.shape,
                b.shape
            );
            if let (Some(x), Some(y)) = (&a.hull, &b.hull) {
                let d = parry::distance(x, &f.a, y, &f.b);
                assert!(
                    agrees(d),
                    "parry's hull: {d:e}, ours {o:?}\n{:?}\n{:?} {f:?}",
                    a.shape,
                    b.shape
                );
                seen.by_hull += 1;
            }
            seen.near += usize::from(o.distance < 1e-3);
            count += 1;
        }
    }
    seen.separated += count;
}

#[test]
fn a_hundred_thousand_poses_agree() {
    let mut rng = Rng::new(201);
    let mut bodies: Vec<Engines> = support::shipped().into_iter().map(Engines::new).collect();
    for (k, n) in [4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 200].into_iter().enumerate() {
        let axes = [Vector3::new(1.0, 1.0, 1.0), Vector3::new(1.0, 0.6, 0.3)][k % 2];
        bodies.push(Engines::new(
            solids::random_hull(n, axes, 300 + k as u64).expect("a hull"),
        ));
    }
    let mut seen = Seen::default();
    while seen.separated < POSES {
        let (a, b) = (rng.pick(&bodies), rng.pick(&bodies));
        compare(a, b, &mut rng, &mut seen);
    }
    assert!(
        seen.by_hull > POSES * 9 / 10,
        "parry's own hulls lost vertices: {} compared",
        seen.by_hull
    );
    assert!(
        seen.near > POSES / 10 && seen.overlapping > POSES / 20,
        "{} near, {} overlapping",
        seen.near,
        seen.overlapping
    );
}

//! Promise: `intersects` and `within` are decided exactly for closed sets, and agree with the
//! distance.

use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{ContactState, ConvexPolyhedron, Tracker};
use truth::exact;
use truth::motion::{self, random_poses};
use truth::pose::radius;
use truth::rng::Rng;
use truth::shapes;
use truth::support;
use truth::support::shifted;

fn cube() -> ConvexPolyhedron {
    solids::cuboid(Vector3::new(0.5, 0.5, 0.5)).expect("a cube")
}

#[test]
fn touching_is_within_zero() {
    let (a, b) = (cube(), cube());
    let mut t = Tracker::new();
    for at in [
        [1.0, 0.0, 0.0],
        [1.0, 0.25, -0.5],
        [1.0, 1.0, 0.3],
        [-1.0, 1.0, 1.0],
        [0.0, 0.0, -1.0],
    ] {
        let pose = shifted(at);
        assert!(t.intersects(&a, &b, &pose) && t.within(&a, &b, &pose, 0.0), "{at:?}");
        let o = t.closest(&a, &b, &pose);
        assert_eq!((o.state, o.distance), (ContactState::Touching, 0.0), "{at:?}");
        // One bit farther they are separated.
        let off = at.map(|x: f64| {
            if x.abs() == 1.0 {
                x.signum() * 1.0f64.next_up()
            } else {
                x
            }
        });
        assert!(!t.intersects(&a, &b, &shifted(off)), "{off:?}");
        let answer = t.closest(&a, &b, &shifted(off)).state;
        assert_eq!(answer, ContactState::Separated, "{off:?}");
        let into = at.map(|x: f64| {
            if x.abs() == 1.0 {
                x.signum() * 1.0f64.next_down()
            } else {
                x
            }
        });
        assert!(t.intersects(&a, &b, &shifted(into)), "{into:?}");
        let found = t.closest(&a, &b, &shifted(into)).state;
        assert_eq!(found, ContactState::Overlapping, "{into:?}");
    }
}

#[test]
fn within_is_sharp_to_the_last_bit() {
    let (a, b) = (cube(), cube());
    let mut t = Tracker::new();
    let mut within = |at, d| t.within(&a, &b, &shifted(at), d);
    for gap in [0.25, 1.0, 3.0, 1.0 / 1024.0] {
        let at = [1.0 + gap, 0.3, 0.1];
        assert!(within(at, gap) && !within(at, gap.next_down()), "{gap}");
    }
    // Edges 3 and 4 apart along two axes, vertices 2, 3 and 6 along three.
    for (at, d) in [([4.0, 5.0, 0.0], 5.0), ([-3.0, 4.0, 7.0], 7.0)] {
        assert!(within(at, d) && !within(at, f64::next_down(d)), "{d}");
    }
}

#[test]
fn distances_that_are_none() {
    let (a, b) = (cube(), cube());
    let mut t = Tracker::new();
    for at in [[0.0; 3], [0.5, 0.2, 0.0], [1.0, 0.0, 0.0], [5.0, 0.0, 0.0]] {
        for d in [f64::NAN, -1.0, -f64::MIN_POSITIVE, f64::NEG_INFINITY] {
            assert!(!t.within(&a, &b, &shifted(at), d), "{d} at {at:?}");
        }
        assert!(t.within(&a, &b, &shifted(at), f64::INFINITY));
        assert_eq!(t.within(&a, &b, &shifted(at), -0.0), t.intersects(&a, &b, &shifted(at)));
    }
}

/// Small bodies against exact arithmetic: at the correctly rounded distance, one bit below and one
/// above.
#[test]
fn predicates_are_those_of_the_oracle() {
    let mut rng = Rng::new(401);
    let mut seen = [0; 3];
    for _ in 0..120 {
        let (a, b) = (shapes::small(&mut rng), shapes::small(&mut rng));
        let (body_a, body_b) = (support::body(&a), support::body(&b));
        let radii = (radius(&a.points), radius(&b.points));
        let mut warm = Tracker::new();
        for f in random_poses(&mut rng, 5, radii, (0.2, 1.2), 1.0) {
            let truth = exact::solve((&a).into(), &f.a, (&b).into(), &f.b);
            let (pose, back) = (support::relative(&f), support::relative(&f.swapped()));
            let apart = truth.state == truth::ContactState::Separated;
            seen[truth.state as usize] += 1;
            for t in [&mut warm, &mut Tracker::new()] {
                assert_eq!(t.intersects(&body_a, &body_b, &pose), !apart, "{a:?} {b:?} {f:?}");
                assert_eq!(t.intersects(&body_b, &body_a, &back), !apart, "{a:?} {b:?} {f:?}");
                let s = truth.distance.max(0.0);
                assert!(t.within(&body_a, &body_b, &pose, s.next_up()), "{a:?} {b:?} {f:?}");
                assert!(t.within(&body_b, &body_a, &back, s.next_up()), "{a:?} {b:?} {f:?}");
                assert!(
                    !apart || !t.within(&body_a, &body_b, &pose, s.next_down()),
                    "{a:?} {b:?} {f:?}"
                );
                assert!(
                    !apart || !t.within(&body_b, &body_a, &back, s.next_down()),
                    "{a:?} {b:?} {f:?}"
                );
            }
        }
    }
    assert!(seen[0] > 150 && seen[2] > 50, "{seen:?}");
}

/// Along a motion through contact, with larger bodies: all queries agree.
#[test]
fn predicates_agree_with_the_distance() {
    let a = solids::random_hull(200, Vector3::new(1.0, 0.8, 0.5), 1).expect("a hull");
    let b = solids::dodecahedron(0.7).expect("a dodecahedron");
    let mut rng = Rng::new(402);
    let (mut t, mut hits) = (Tracker::new(), 0);
    for f in motion::pass_through(&mut rng, 600, (1.0, 0.7), 0.3) {
        let pose = support::relative(&f);
        let (d, hit) = (Tracker::new().distance(&a, &b, &pose), t.intersects(&a, &b, &pose));
        hits += usize::from(hit);
        assert_eq!(hit, d.state != ContactState::Separated);
        for x in [0.01, 0.1, 0.5, 2.0] {
            let within = t.within(&a, &b, &pose, x);
            assert!(within || d.upper > x, "{d:?} {x}");
            assert!(!within || d.lower <= x, "{d:?} {x}");
        }
    }
    assert!((50..550).contains(&hits), "{hits}");
}

/// A point is a body too: containment is intersection with a point.
#[test]
fn containment_is_intersection_with_a_point() {
    let body = solids::icosahedron(1.0).expect("an icosahedron");
    let mut rng = Rng::new(403);
    let mut inside = 0;
    for _ in 0..2000 {
        let p: [f64; 3] = std::array::from_fn(|_| rng.range(-1.0, 1.0));
        let point = ConvexPolyhedron::point(Point3::from(p)).expect("a point");
        let held = body.contains(&Point3::from(p));
        let found = Tracker::new().intersects(&body, &point, &shifted([0.0; 3]));
        assert_eq!(found, held, "{p:?}");
        inside += usize::from(held);
    }
    assert!((300..1500).contains(&inside), "{inside}");
}

/// A tetrahedron rotated by almost nothing about two axes, whose tip is as slightly inside or
/// outside a wall.
#[cfg(feature = "exact")]
#[test]
fn a_tip_barely_inside_is_seen() {
    let mut rng = Rng::new(404);
    let mut seen = [0; 2];
    for _ in 0..32 {
        seen[usize::from(truth::driven::underflow::tip(&mut rng).unwrap())] += 1;
    }
    assert!(seen.iter().all(|&n| n > 8), "{seen:?}");
    assert!(seen.iter().sum::<i32>() == 32, "{seen:?}");
}

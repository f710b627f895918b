//! Promise: there is no absolute tolerance: the result scales with the scene, for any unit,
//! position and size ratio.

mod calls;
mod curved;

use std::cmp::Ordering;
use truth::support;

use lin_canny::{ContactState, ConvexPolyhedron, Outcome, RelativePose, Tracker};
use truth::bound;
use truth::motion::{Frame, random_poses};
use truth::pose::{add, norm, radius, scale, sub};
use truth::rng::Rng;
use truth::shapes::{self, Shape};
use truth::support::{body, relative};

fn pairs(rng: &mut Rng) -> Vec<(Shape, Shape, Vec<Frame>)> {
    let mut pair = || {
        let (a, b) = (shapes::small(rng), shapes::small(rng));
        let radii = (radius(&a.points), radius(&b.points));
        let frames = random_poses(rng, 8, radii, (0.4, 1.3), 0.0);
        (a, b, frames)
    };
    (0..40).map(|_| pair()).collect()
}

/// Asserts that `x` is `y` times the power of two, bit for bit.
fn is_scaled(x: &Outcome, y: &Outcome, by: f64) {
    let at = |o: &Outcome, s: f64| {
        let points = o
            .point_on_a
            .iter()
            .chain(o.point_on_b.iter())
            .map(|c| c * s)
            .collect::<Vec<_>>();
        (
            o.state,
            o.distance * s,
            o.lower * s,
            o.upper * s,
            points,
            o.normal,
            o.features,
            o.solver,
        )
    };
    assert_eq!(at(x, 1.0), at(y, by), "scaled by {by:e}");
}

/// Returns k of the storage unit `2^(210 k)` of a body, from half the diagonal of its box.
fn window(body: &ConvexPolyhedron) -> i32 {
    let (low, high) = body.aabb();
    (((high - low).norm() * 0.5).log2().floor() as i32 + 105).div_euclid(210)
}

/// Bit for bit if both bodies are stored in one unit; if a scale puts them on both sides of a
/// storage limit, another solver may answer, and only contact state and bounds agree.
#[test]
fn powers_of_two_change_no_bit() {
    let (mut separated, mut bordering) = (0, 0);
    for (a, b, frames) in pairs(&mut Rng::new(601)) {
        let plain = (body(&a), body(&b));
        for e in [-300, -105, -41, -3, 1, 38, 105, 106, 150, 300] {
            let by = 2f64.powi(e);
            let large = (body(&a.clone().scaled(by)), body(&b.clone().scaled(by)));
            let one_unit = window(&large.0) == window(&large.1);
            for f in &frames {
                let one = Tracker::new().closest(&plain.0, &plain.1, &relative(f));
                let two = Tracker::new().closest(&large.0, &large.1, &relative(&f.scaled(by)));
                if one_unit {
                    is_scaled(&two, &one, by);
                    separated += usize::from(one.state == ContactState::Separated);
                } else {
                    let agree = one.lower * by <= two.upper && two.lower <= one.upper * by;
                    assert!(one.state == two.state && agree, "{one:?}\n{two:?}");
                    bordering += 1;
                }
            }
        }
    }
    assert!(separated > 1000, "{separated} separated, {bordering} at a border");
    assert!(bordering > 0, "{separated} separated, {bordering} at a border");
    assert!(bordering * 10 < separated, "{bordering} at a border");
}

#[test]
fn extents_from_1e_minus_100_to_1e100() {
    let mut separated = 0;
    for (a, b, frames) in pairs(&mut Rng::new(602)) {
        // Some sizes are not powers of two, so bodies are rounded: the exact oracle gets the
        // rounded ones.
        for by in [1e-99, 1e-60, 1e-13, 1e13, 1e60, 1e99] {
            let (a, b) = (a.clone().scaled(by), b.clone().scaled(by));
            let (body_a, body_b) = (body(&a), body(&b));
            for f in frames.iter().map(|f| f.scaled(by)) {
                let mut t = Tracker::new();
                let o = t.closest(&body_a, &body_b, &relative(&f));
                let found = t.intersects(&body_a, &body_b, &relative(&f));
                assert_eq!(found, o.state != ContactState::Separated);
                if o.state == ContactState::Separated {
                    proved(&a, &b, &f, &o, by);
                    separated += 1;
                }
            }
        }
    }
    assert!(separated > 800, "{separated}");
}

/// Asserts the order of lower bound, distance and upper bound with the gap that the normal proves
/// and the distance that the witnesses attain.
fn proved(a: &Shape, b: &Shape, f: &Frame, o: &Outcome, unit: f64) {
    let normal = f.a.rotate(o.normal.into_inner().into());
    let gap = bound::support_gap(a.into(), &f.a, b.into(), &f.b, normal);
    let apart = bound::witness_distance(o.point_on_a.coords.into(), &f.a, o.point_on_b.coords.into(), &f.b);
    let near = 1e-13 * unit;
    assert!(
        apart - gap <= near && (o.distance - gap).abs() <= near,
        "{gap:e} {apart:e} {o:?} {a:?} {b:?} {f:?}"
    );
    let size = radius(&a.points) + radius(&b.points) + norm(sub(f.b.t, f.a.t));
    assert!(o.lower <= apart + near, "{gap:e} {apart:e} {o:?}");
    assert!(gap <= o.upper, "{gap:e} {apart:e} {o:?}");
    assert!(o.upper - o.lower <= 1e-13 * size, "{gap:e} {apart:e} {o:?}");
}

#[test]
fn a_grain_beside_a_mountain() {
    let mut rng = Rng::new(603);
    for ratio in [1e3, 1e6, 1e9, 1e12] {
        for _ in 0..30 {
            let (a, b) = (shapes::small(&mut rng).scaled(ratio), shapes::small(&mut rng));
            let (body_a, body_b) = (body(&a), body(&b));
            for mut f in random_poses(&mut rng, 4, (ratio, 1.0), (0.7, 1.1), 0.0) {
                f.a.t = [0.0; 3];
                let o = Tracker::new().closest(&body_a, &body_b, &relative(&f));
                let turned = Tracker::new().closest(&body_b, &body_a, &relative(&f.swapped()));
                assert_eq!(o.state, turned.state);
                if o.state == ContactState::Separated {
                    // Up to the rounding of the larger body.
                    proved(&a, &b, &f, &o, 10.0 * ratio);
                }
            }
        }
    }
}

/// Far from the world's origin only the rounding of the poses matters, and exact bounds use the
/// rounded poses.
#[test]
fn far_from_the_origin() {
    let mut rng = Rng::new(604);
    for (a, b, frames) in pairs(&mut rng) {
        let (body_a, body_b) = (body(&a), body(&b));
        for f in frames {
            let shift = scale(rng.unit(), 1e9);
            let mut far = f;
            (far.a.t, far.b.t) = (add(f.a.t, shift), add(f.b.t, shift));
            let o = Tracker::new().closest(&body_a, &body_b, &relative(&far));
            if o.state == ContactState::Separated {
                proved(&a, &b, &far, &o, 1.0);
            }
            // The same relative pose without the offset.
            let mut near = far;
            (near.a.t, near.b.t) = ([0.0; 3], sub(far.b.t, far.a.t));
            let here = Tracker::new().closest(&body_a, &body_b, &relative(&near));
            assert_eq!(o.state, here.state);
            assert_eq!(o.distance, here.distance);
            assert_eq!(o.features, here.features);
        }
    }
}

/// Bodies whose vertices are far from their origin rotate about it, so poses are chosen that bring
/// them back.
#[test]
fn vertices_far_from_their_own_origin() {
    let mut rng = Rng::new(605);
    let mut separated = 0;
    for (a, b, frames) in pairs(&mut rng) {
        let offset = [1e6, -2e6, 5e5];
        let mut away = b.clone();
        away.points.iter_mut().for_each(|p| *p = add(*p, offset));
        let (Ok(body_a), Ok(body_b)) = (build(&a), build(&away)) else {
            continue;
        };
        for f in frames {
            let mut g = f;
            g.b.t = sub(f.b.t, f.b.rotate(offset));
            let o = Tracker::new().closest(&body_a, &body_b, &relative(&g));
            if o.state == ContactState::Separated {
                // L is measured between the bodies, but the translation is rounded at 2e6.
                proved(&a, &away, &g, &o, 1e7);
                separated += 1;
            }
        }
    }
    assert!(separated > 100, "{separated}");
}

/// Returns a hull that the shift may have made exactly flat.
fn build(s: &Shape) -> Result<lin_canny::ConvexPolyhedron, lin_canny::BuildError> {
    let points: Vec<_> = s.points.iter().map(|&p| p.into()).collect();
    lin_canny::ConvexPolyhedron::from_points(&points)
}

/// Distances whose squares overflow.
#[test]
fn distances_up_to_the_largest_number() {
    let cube = body(&shapes::cube());
    let mut t = Tracker::new();
    for x in [1e20, 1e100, 1e155, 1e200, 1e300, 1.7e308] {
        let pose = support::shifted([x, 0.0, 0.0]);
        let o = t.closest(&cube, &cube, &pose);
        assert!(o.state == ContactState::Separated, "{o:?}");
        assert!(o.lower <= x, "{o:?}");
        assert!(x - 2.0 <= o.upper, "{o:?}");
        assert!((o.distance - x).abs() <= 1e-14 * x, "{o:?}");
        assert!(o.upper - o.lower <= 1e-13 * x, "{o:?}");
        assert!(!t.intersects(&cube, &cube, &pose) && !t.within(&cube, &cube, &pose, x / 2.0));
        assert!(t.within(&cube, &cube, &pose, f64::MAX));
    }
    let far = |x: f64| lin_canny::nalgebra::Isometry3::translation(x, 0.0, 0.0);
    assert!(RelativePose::new(&far(-1.7e308), &far(1.7e308)).is_err());
}

/// A point has no size: it is queried in the other body's unit, however small, and at any position
/// in its frame.
#[test]
fn points_in_and_beside_bodies_of_any_size() {
    let ask = |body: &ConvexPolyhedron, point: &ConvexPolyhedron, pose: &RelativePose| {
        let mut t = Tracker::new();
        let cold = t.closest(body, point, pose);
        let back = Tracker::new().closest(point, body, &pose.swapped());
        assert_eq!(t.intersects(body, point, pose), cold.state != ContactState::Separated);
        [cold, t.closest(body, point, pose), back]
    };
    for by in [1e-99, 1e-95, 1e-90, 1e-60, 1.0, 1e60, 1e99] {
        let octahedron = body(&shapes::octahedron().scaled(by));
        for place in [[0.0; 3], [0.3, -2.0, 7.0], [5e8, 2.0, -1.0]] {
            let p = scale(place, by);
            let point = ConvexPolyhedron::point(p.into()).unwrap();
            let offset = norm(p);
            for x in [0.0, 0.25, 0.9, 1.0, 1.5, 1e3] {
                // The exact position of the point: differences of close doubles are exact.
                let t = sub([x * by, 0.0, 0.0], p);
                let at = add(p, t)[0] / by;
                let truth = if at > 1.0 { at - 1.0 } else { (at - 1.0) / 3f64.sqrt() } * by;
                for o in ask(&octahedron, &point, &support::shifted(t)) {
                    let size = by * (1.0 + at) + offset * 2f64.powi(-49);
                    assert!(o.upper - o.lower <= 1e-13 * size, "{by:e} {place:?} {x}: {o:?}");
                    let off = (o.distance - truth).abs();
                    assert!(off <= 1e-14 * size, "{by:e} {place:?} {x}: {o:?}");
                    // Away from its origin, a point touches up to the rounding of its position.
                    let state = match at.total_cmp(&1.0) {
                        Ordering::Less => ContactState::Overlapping,
                        Ordering::Equal => ContactState::Touching,
                        Ordering::Greater => ContactState::Separated,
                    };
                    assert!(
                        o.state == state || x == 1.0 && offset > 0.0,
                        "{by:e} {place:?} {x}: {o:?}"
                    );
                }
            }
        }
    }
}

/// Bodies so far from their origin that doubles resolve nothing of them: contact state and bounds
/// are correct all the same.
#[test]
fn points_beyond_all_measure_from_their_own_origin() {
    let cube = body(&shapes::cube());
    for away in [1e30, 1e60, 1e80, 1e99, 1e115] {
        let p = [away, -0.3 * away, 0.7 * away];
        let point = ConvexPolyhedron::point(p.into()).unwrap();
        let pose = support::shifted(scale(p, -1.0));
        for o in [
            Tracker::new().closest(&cube, &point, &pose),
            Tracker::new().closest(&point, &cube, &pose.swapped()),
        ] {
            assert_eq!(o.state, ContactState::Overlapping, "{away:e}: {o:?}");
            let held = o.lower <= -1.0 && -1.0 <= o.upper && o.upper - o.lower <= 1e-13 * (4.0 + away * 2f64.powi(-49));
            assert!(held, "{away:e}: {o:?}");
        }
        // Two points slightly apart, with one shift cancelling most of the distance.
        let near = support::shifted(add(scale(p, -1.0), [3e-12 * away, 0.0, 0.0]));
        let other = ConvexPolyhedron::point([0.0; 3].into()).unwrap();
        let o = Tracker::new().closest(&other, &point, &near);
        let apart = (3e-12 * away - away) + away;
        assert!(
            o.upper - o.lower <= 1e-13 * (apart + away * 2f64.powi(-49)),
            "{away:e}: {o:?}"
        );
        assert!(o.lower <= apart && apart <= o.upper, "{away:e}: {apart:e} {o:?}");
    }
}

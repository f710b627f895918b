//! Overlaps, identities, hard families and stale trackers.

use super::{Mix, at_gap, count, pairs};
use lin_canny::nalgebra::Vector3;
use lin_canny::polyhedron::solids;
use lin_canny::{ContactState, Outcome, PairTracker, Shape, Solver};
use truth::curved::{KINDS, Kind, Place, wide};
use truth::rng::Rng;

fn closest(a: &Shape, b: &Shape, place: &Place) -> Outcome {
    PairTracker::new().closest(a, b, &place.pose()).outcome
}

/// Returns the greatest height over many directions, improved from the best few: never above the
/// true distance.
pub(crate) fn sampled(a: &Kind, b: &Kind, place: &Place, rng: &mut Rng) -> f64 {
    let height = |n: [f64; 3]| place.height(a, b, &wide(n)).0;
    let mut best: Vec<(f64, [f64; 3])> = (0..100).map(|_| rng.unit()).map(|n| (height(n), n)).collect();
    best.sort_by(|x, y| y.0.total_cmp(&x.0));
    best.truncate(2);
    for (h, n) in &mut best {
        let mut step = 0.3;
        while step > 1e-7 {
            let d = rng.unit();
            let trial = truth::pose::unit([0, 1, 2].map(|k| n[k] + step * d[k]));
            let g = height(trial);
            if g > *h {
                (*h, *n, step) = (g, trial, step * 1.5);
            } else {
                step *= 0.8;
            }
        }
    }
    best.iter().fold(f64::NEG_INFINITY, |s, b| s.max(b.0))
}

#[test]
fn overlaps_have_sound_depths() {
    let (mut closed, mut wide_ones, mut open) = (0, 0, 0);
    for (k, (first, second)) in pairs().enumerate() {
        let mut rng = Rng::new(2150 + k as u64);
        for _ in 0..count() / 30 {
            let (a, b) = (Kind::random(first, &mut rng, 3.0), Kind::random(second, &mut rng, 3.0));
            let mut place = at_gap(&a, &b, &mut rng, 0.01);
            let o = closest(&a.shape(), &b.shape(), &place);
            let push = rng.log_range(1e-7, 0.4);
            place.t = (Vector3::from(place.t) - *o.normal * (0.01 + push)).into();
            let o = closest(&a.shape(), &b.shape(), &place);
            let size = place.size(&a, &b);
            let told = || format!("{a:?}\n{b:?}\n{place:?}\n{push} {o:?}");
            assert!(o.lower <= o.distance, "{}", told());
            assert!(o.distance <= o.upper, "{}", told());
            assert!(o.upper.is_finite(), "{}", told());
            // Any direction is a lower bound; the returned one proves the lower bound.
            let s = sampled(&a, &b, &place, &mut rng);
            assert!(s <= o.upper + 1e-15 * size, "the depth is overstated: {s} {}", told());
            let proof = place.height(&a, &b, &wide((*o.normal).into())).0;
            assert!(o.lower <= proof + 1e-15 * size, "{proof} {}", told());
            assert!(s - o.upper.max(o.lower) <= 1e-15 * size, "{}", told());
            // Pushed along the normal by `push`: no deeper than that.
            assert!(o.upper >= -push - 1e-14 * size, "{}", told());
            match o.state {
                // Pushed past an acute rim, along a normal that does not point inside.
                ContactState::Separated => continue,
                ContactState::Overlapping if o.upper - o.lower <= 1e-13 * size => closed += 1,
                ContactState::Overlapping => wide_ones += 1,
                _ => open += 1,
            }
            if o.state == ContactState::Overlapping && o.upper - o.lower > 4e-6 * size {
                println!(
                    "wide: {:.1e} {first} {second} push {push:.1e}",
                    (o.upper - o.lower) / size
                );
            }
            // A translation along the normal by slightly more than the depth separates them.
            let mut parted = place;
            parted.t = (Vector3::from(place.t) + *o.normal * (-o.lower + 1e-12 * size)).into();
            let o = closest(&a.shape(), &b.shape(), &parted);
            assert!(o.lower > -1e-12 * size, "{} {o:?}", told());
        }
    }
    println!("overlaps: {closed} to 1e-13 L, {wide_ones} to an interval, {open} open");
    assert!(closed > 60, "{closed} {wide_ones} {open}");
    assert!(wide_ones > 30, "{closed} {wide_ones} {open}");
    assert!(open == 0, "{closed} {wide_ones} {open}");
}

/// Asserts that two intervals overlap.
fn meet(o: &Outcome, p: &Outcome, what: &str) {
    assert!(o.lower <= p.upper && p.lower <= o.upper, "{what}: {o:?}\n{p:?}");
}

/// A ball is an ellipsoid with equal semi-axes; the distance of a rounded core is that of the core
/// less the radius.
#[test]
fn a_ball_is_an_ellipsoid_and_rounding_is_free() {
    let mut rng = Rng::new(2191);
    for k in 0..400 {
        let kind = Kind::random(KINDS[k % KINDS.len()], &mut rng, 5.0);
        let r = rng.log_range(0.01, 2.0);
        let place = Place::new(
            rng.quat(),
            truth::pose::scale(rng.unit(), rng.range(0.2, 1.5) * (r + kind.radius())),
        );
        let other = kind.shape();
        let ball = Shape::ball(r).expect("a ball");
        let round = Shape::ellipsoid(Vector3::repeat(r)).expect("an ellipsoid");
        let (o, p) = (closest(&ball, &other, &place), closest(&round, &other, &place));
        meet(&o, &p, "a ball");
        let grown = other.rounded(0.25).expect("a radius");
        let q = closest(&round, &grown, &place);
        assert!(q.lower <= p.upper - 0.25 + 1e-13, "{p:?} {q:?}");
        assert!(p.lower - 0.25 <= q.upper + 1e-13, "{p:?} {q:?}");
    }
}

/// A cylinder lies between its inscribed and its circumscribed prisms.
#[test]
fn a_cylinder_lies_between_its_prisms() {
    let mut rng = Rng::new(2192);
    for n in [8, 64, 512] {
        let outer = 1.0 / (std::f64::consts::PI / n as f64).cos();
        let [inside, around] =
            [1.0, outer * (1.0 + 1e-15)].map(|r| Shape::from(solids::prism(n, 0.5, r).expect("a prism")));
        let cylinder = Shape::cylinder(0.5, 1.0).expect("a cylinder");
        for k in 0..60 {
            let kind = Kind::random(KINDS[k % KINDS.len()], &mut rng, 3.0);
            let place = at_gap(&Kind::Cylinder(0.5, 1.0), &kind, &mut rng, 0.5);
            let other = kind.shape();
            let [o, least, most] = [&cylinder, &around, &inside].map(|s| closest(s, &other, &place));
            assert!(least.lower <= o.upper && o.lower <= most.upper, "{kind:?} {place:?}");
            assert!(most.upper - least.lower < 3.0 * (outer - 1.0) + 1e-12);
        }
    }
}

/// Cylinders and cones on flat faces, tilted by 0 to 1e-4, and shapes much flatter or longer than
/// wide.
#[test]
fn flush_and_extreme_pairs_close() {
    let mut rng = Rng::new(2193);
    let tilts = [0.0, 1e-16, 1e-14, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4];
    let plate = Kind::Hull(
        (0..8)
            .map(|k| [0, 1, 2].map(|a| if k >> a & 1 == 1 { 2.0 } else { -2.0 }))
            .collect(),
    );
    let (can, hat) = (Kind::Cylinder(0.5, 1.0), Kind::Cone(0.75, 0.5));
    let right = (0.5f64).sqrt();
    let mut mix = Mix::default();
    for (a, b, lying, height) in [
        (&plate, &can, false, 2.5),
        (&plate, &can, true, 3.0),
        (&can, &can, false, 1.0),
        (&can, &can, true, 1.5),
        (&plate, &hat, false, 2.75),
        (&can, &hat, false, 1.25),
        (&hat, &can, true, 1.75),
    ] {
        for tilt in tilts {
            for gap in [1e-9, 1e-6, 1e-3, 0.1] {
                let axis = rng.unit();
                let up = if lying {
                    [right, 0.0, 0.0, right]
                } else {
                    [0.0, 0.0, 0.0, 1.0]
                };
                let place = Place::new(
                    truth::pose::unit_quat(truth::pose::quat_mul(truth::pose::quat(axis, tilt), up)),
                    [rng.range(-0.8, 0.8), rng.range(-0.8, 0.8), height + gap + 3.0 * tilt],
                );
                let o = closest(&a.shape(), &b.shape(), &place);
                mix.judge(a, b, &place, &o);
                assert_eq!(o.state, ContactState::Separated, "{a:?} {b:?} {place:?} {o:?}");
            }
        }
    }
    mix.print("flush", "");
    assert!(mix.widest <= 1e-13, "{}", mix.widest);
    let mut extreme = Mix::default();
    for k in 0..count() {
        let kinds = [0, 1].map(|i| Kind::random(KINDS[3 + (k as usize + i) % 3], &mut rng, 1e6));
        let gap = rng.log_range(1e-6, 1e6);
        let place = at_gap(&kinds[0], &kinds[1], &mut rng, gap);
        let o = closest(&kinds[0].shape(), &kinds[1].shape(), &place);
        extreme.judge(&kinds[0], &kinds[1], &place, &o);
    }
    extreme.print("extreme", "");
    assert!(extreme.widest <= 1e-13, "{}", extreme.widest);
}

/// One tracker for all pairs, alternating between them, and along a motion: the contact state is
/// the same, and the bounds overlap.
#[test]
fn stale_and_warm_trackers_agree_with_cold_ones() {
    let (mut rng, mut pair) = (Rng::new(2194), PairTracker::new());
    let (mut warm, mut frames) = (Mix::default(), 0);
    for k in 0..60 {
        let (first, second) = pairs().nth(k % pairs().count()).expect("a pair");
        let (a, b) = (Kind::random(first, &mut rng, 5.0), Kind::random(second, &mut rng, 5.0));
        let mut place = at_gap(&a, &b, &mut rng, 0.1);
        let (x, y, axis) = (a.shape(), b.shape(), rng.unit());
        for _ in 0..20 {
            let o = pair.closest(&x, &y, &place.pose());
            let cold = closest(&x, &y, &place);
            assert_eq!(o.state, cold.state, "{a:?} {b:?} {place:?} {o:?} {cold:?}");
            meet(&o, &cold, "warm and cold");
            if o.state == ContactState::Separated {
                warm.judge(&a, &b, &place, &o);
            }
            frames += u32::from(o.solver == Solver::Walk);
            let turn = truth::pose::quat(axis, 0.5f64.to_radians());
            place.q = truth::pose::unit_quat(truth::pose::quat_mul(turn, place.q));
        }
    }
    warm.print("warm", "0.5 degrees");
    assert!(frames > 1000, "{frames}");
}

/// Scaling by a power of two scales the outcome exactly; extreme sizes and positions are answered.
#[test]
fn scales_are_no_matter() {
    let mut rng = Rng::new(2195);
    for k in 0..60 {
        let place = Place::new(rng.quat(), truth::pose::scale(rng.unit(), 4.0));
        let shape = |s: f64| {
            let made = match k % 3 {
                0 => Shape::ellipsoid(Vector3::new(1.0, 0.5, 0.25) * s),
                1 => Shape::cylinder(0.5 * s, s),
                _ => Shape::cone(0.5 * s, s),
            };
            made.expect("a shape")
        };
        let solid = |s: f64| Shape::cuboid(Vector3::new(1.0, 2.0, 0.5) * s).expect("a box");
        let o = closest(&shape(1.0), &solid(1.0), &place);
        for e in [-40, 7, 50] {
            let s = 2f64.powi(e);
            let far = Place {
                t: place.t.map(|x| x * s),
                ..place
            };
            let p = closest(&shape(s), &solid(s), &far);
            assert_eq!(p.distance, o.distance * s, "{e}");
            assert_eq!(p.lower, o.lower * s, "{e}");
            assert_eq!(p.upper, o.upper * s, "{e}");
        }
        for s in [1e-90, 1e-60, 1e60, 1e90] {
            let far = Place {
                t: place.t.map(|x| x * s),
                ..place
            };
            let p = closest(&shape(s), &solid(s), &far);
            let off = (p.distance / s - o.distance).abs();
            assert!(off < 1e-13, "{s} {o:?} {p:?}");
            assert!(p.state == o.state, "{s} {o:?} {p:?}");
            assert!(p.upper - p.lower <= 1e-12 * s, "{s} {o:?} {p:?}");
            // A tiny shape next to a shape of ordinary size, and shapes far from each other.
            for (a, b) in [(shape(s), solid(1.0)), (solid(s), shape(1.0)), (shape(s), shape(1.0))] {
                let q = closest(&a, &b, &place);
                assert!(q.lower <= q.distance, "{s} {q:?}");
                assert!(q.distance <= q.upper, "{s} {q:?}");
                assert!(q.upper.is_finite(), "{s} {q:?}");
                let expected = if s < 1.0 {
                    ContactState::Separated
                } else {
                    ContactState::Overlapping
                };
                assert_eq!(q.state, expected, "{s} {q:?}");
            }
            let q = closest(&shape(1.0), &solid(1.0), &far);
            assert!(q.lower <= q.upper && q.upper.is_finite(), "{s} {q:?}");
        }
    }
}

/// Linear maps preserve separation: an ellipsoid and a hull, mapped so that the ellipsoid becomes a
/// ball.
///
/// A separating direction of one pair maps to one of the other pair, so each normal proves a lower
/// bound of the other distance.
#[test]
fn affine_images_of_a_ball_are_ellipsoids() {
    let (mut rng, mut apart, mut together) = (Rng::new(2196), 0, 0);
    for _ in 0..2000 {
        let axes = [0, 1, 2].map(|_| rng.log_range(0.1, 1.0));
        let centre = truth::pose::scale(rng.unit(), rng.range(0.5, 2.5));
        let points: Vec<[f64; 3]> = (0..rng.below(8) + 4)
            .map(|_| rng.in_ball())
            .map(|p| [0, 1, 2].map(|k| p[k] + centre[k]))
            .collect();
        let ball = Shape::ball(1.0).expect("a ball");
        let mapped = Kind::Hull(points.iter().map(|p| [0, 1, 2].map(|k| p[k] / axes[k])).collect());
        let (kind, ellipsoid) = (Kind::Hull(points), Kind::Ellipsoid(axes));
        let at = Place::new([0.0, 0.0, 0.0, 1.0], [0.0; 3]);
        let o = closest(&ellipsoid.shape(), &kind.shape(), &at);
        let p = closest(&ball, &mapped.shape(), &at);
        // A unit normal n of the mapped pair corresponds to n divided by the semi-axes for the
        // ellipsoid.
        let back = Vector3::from([0, 1, 2].map(|k| p.normal[k] / axes[k]));
        let there = Vector3::from([0, 1, 2].map(|k| o.normal[k] * axes[k]));
        let slack = 1e-13 * (1.0 / axes.iter().fold(1.0f64, |m, x| m.min(*x)));
        if p.state == ContactState::Separated || o.state == ContactState::Separated {
            assert!(p.lower / back.norm() <= o.upper + slack, "{axes:?} {o:?} {p:?}");
            assert!(o.lower / there.norm() <= p.upper + slack, "{axes:?} {o:?} {p:?}");
            assert_eq!(o.state, p.state, "{axes:?} {o:?} {p:?}");
            apart += 1;
        } else {
            together += 1;
        }
    }
    assert!(apart > 500 && together > 300, "{apart} {together}");
}

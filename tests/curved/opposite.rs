//! Promise: the witnesses of every outcome lie on both surfaces, opposite each other along the
//! normal at the returned distance.

use super::{at_gap, pairs};
use lin_canny::nalgebra::Vector3;
use lin_canny::{ContactState, Outcome, PairTracker};
use truth::curved::special::{about_parallel_axes, flush_over_edge};
use truth::curved::{Kind, Place, matrix, turned_back, wide};
use truth::rng::Rng;

/// Largest error of witnesses in units of L. If only an interval of the depth is known, its width
/// is added, up to `WIDE`.
const OFF: f64 = 1e-9;
const WIDE: f64 = 1e-6;

/// Returns the errors of the witnesses relative to L: off the line along the normal, and off the
/// surfaces.
pub(crate) fn off(kinds: [&Kind; 2], radii: [f64; 2], place: &Place, o: &Outcome) -> [f64; 2] {
    let (at, n) = (place.isometry(), *o.normal);
    let between = at * o.point_on_b - o.point_on_a;
    let size = place.size(kinds[0], kinds[1]);
    let m: Vector3<f64> = turned_back(&matrix(place.q), &wide(n.into())).map(|x| -x.0).into();
    let mut beside = 0.0f64;
    for (kind, p, n, r) in [
        (kinds[0], o.point_on_a.coords, n, radii[0]),
        (kinds[1], o.point_on_b.coords, m, radii[1]),
    ] {
        // On the supporting plane, and not outside the core less the radius.
        let below = kind.height(&wide(n.into())).0 + r - n.dot(&p);
        let outside = kind.outside(&wide((p - n * r).into()));
        beside = beside.max(below.abs()).max(outside);
    }
    [(between - n * o.distance).norm() / size, beside / size]
}

/// Errors of outcomes with tight bounds and of other outcomes.
#[derive(Default, Debug)]
struct Worst {
    apart: [f64; 2],
    closed: [f64; 2],
    open: [f64; 2],
    classes: [u32; 4],
    bad: u32,
}

impl Worst {
    fn take(&mut self, kinds: [&Kind; 2], radii: [f64; 2], place: &Place, pair: &mut PairTracker) {
        let shape = |k: usize| {
            let sharp = kinds[k].shape();
            if radii[k] > 0.0 {
                sharp.rounded(radii[k]).expect("a radius")
            } else {
                sharp
            }
        };
        let o = pair.closest(&shape(0), &shape(1), &place.pose());
        self.classes[o.state as usize] += 1;
        let off = off(kinds, radii, place, &o);
        let width = (o.upper - o.lower) / place.size(kinds[0], kinds[1]);
        let (list, most) = match o.state {
            ContactState::Separated => (&mut self.apart, OFF),
            _ if width <= 1e-13 => (&mut self.closed, OFF),
            _ => (&mut self.open, OFF + width.min(WIDE)),
        };
        if off.iter().any(|&x| !(x <= most)) || o.state == ContactState::Undecided {
            self.bad += 1;
            if self.bad <= 1 || off.iter().any(|&x| x > 1e-5) {
                println!("{off:?} {radii:?} {kinds:?}\n{place:?}\n{o:?}");
            }
        }
        for (worst, off) in list.iter_mut().zip(off) {
            *worst = worst.max(off);
        }
    }
}

/// Returns a rotation: none, upside down, lying along y, or random; tilted slightly or not at all.
fn turn(rng: &mut Rng) -> [f64; 4] {
    let s = 0.5f64.sqrt();
    let any = rng.quat();
    let base = *rng.pick(&[[0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 0.0], [s, 0.0, 0.0, s], any]);
    let tilt = *rng.pick(&[0.0, 1e-14, 1e-10, 1e-7, 1e-4, 1e-2]);
    truth::pose::unit_quat(truth::pose::quat_mul(truth::pose::quat(rng.unit(), tilt), base))
}

/// Returns positions from contact to the common centre: along an axis, slightly off it, or along
/// any direction.
fn shift(kinds: [&Kind; 2], rng: &mut Rng) -> [f64; 3] {
    let reach = kinds[0].radius().min(kinds[1].radius());
    let any = rng.unit();
    let along = *rng.pick(&[[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], any]);
    let by = reach * *rng.pick(&[0.0, 1e-9, 1e-3, 0.009, 0.1, 0.3, 0.6]);
    let (aside, beside) = (rng.unit(), reach * *rng.pick(&[0.0, 0.0, 1e-12, 1e-6, 0.009]));
    [0, 1, 2].map(|k| along[k] * by + aside[k] * beside)
}

#[test]
fn witnesses_of_overlaps_are_opposite() {
    let mut failed = String::new();
    for (k, (first, second)) in pairs().enumerate() {
        let (mut rng, mut worst) = (Rng::new(2300 + k as u64), Worst::default());
        for i in 0..super::count() {
            let aspect = *rng.pick(&[1.0, 2.0, 8.0]);
            let kinds = [
                Kind::random(first, &mut rng, aspect),
                Kind::random(second, &mut rng, aspect),
            ];
            let kinds = [&kinds[i as usize % 2], &kinds[1 - i as usize % 2]];
            let radii = *rng.pick(&[[0.0, 0.0], [0.0, 0.3], [0.2, 0.05]]);
            let place = Place::new(turn(&mut rng), shift(kinds, &mut rng));
            worst.take(kinds, radii, &place, &mut PairTracker::new());
        }
        println!("{first:12} {second:12} {worst:?}");
        if worst.bad > 0 {
            failed += &format!("{first} {second} {}, ", worst.bad);
        }
    }
    assert!(failed.is_empty(), "not opposite: {failed}");
}

/// Faces flush over an edge, and bodies of revolution about parallel axes.
#[test]
fn witnesses_at_special_poses_are_opposite() {
    let (mut rng, mut worst) = (Rng::new(2330), Worst::default());
    for k in 0..super::count() * 4 {
        let (kinds, place) = if k % 2 == 0 {
            let (kinds, place, ..) = flush_over_edge(&mut rng);
            (kinds, place)
        } else {
            about_parallel_axes(&mut rng)
        };
        let radii = *rng.pick(&[[0.0, 0.0], [0.0, 0.3], [0.2, 0.05]]);
        worst.take([&kinds[0], &kinds[1]], radii, &place, &mut PairTracker::new());
    }
    println!("{worst:?}");
    assert_eq!(worst.bad, 0, "{worst:?}");
}

/// A segment nearly coaxial with a cylinder: balls on both sides of the axis are equally large.
#[test]
fn witnesses_of_a_capsule_along_the_axis_of_a_cylinder_are_opposite() {
    let can = Kind::Cylinder(0.5, 0.4);
    let pill = Kind::Hull(vec![[0.0, 0.0, -0.5], [0.0, 0.0, 0.5]]);
    let mut rng = Rng::new(2340);
    let mut worst = Worst::default();
    for _ in 0..2000 {
        let aside = truth::pose::scale(rng.unit(), rng.log_range(1e-9, 0.3));
        let place = Place::new(turn(&mut rng), aside);
        for (kinds, radii) in [([&can, &pill], [0.0, 0.3]), ([&pill, &can], [0.3, 0.0])] {
            worst.take(kinds, radii, &place, &mut PairTracker::new());
        }
    }
    println!("{worst:?}");
    assert!(worst.bad == 0, "{worst:?}");
    assert!(worst.classes[ContactState::Overlapping as usize] > 3000, "{worst:?}");
}

/// Along a motion through contact, with a warm tracker: the witnesses of all outcomes are opposite
/// each other.
#[test]
fn witnesses_stay_opposite_through_contact() {
    let mut failed = String::new();
    for (k, (first, second)) in pairs().enumerate() {
        let (mut rng, mut worst) = (Rng::new(2350 + k as u64), Worst::default());
        for _ in 0..super::count() / 30 {
            let kinds = [first, second].map(|name| Kind::random(name, &mut rng, 4.0));
            let (mut place, axis) = (at_gap(&kinds[0], &kinds[1], &mut rng, 0.2), rng.unit());
            let o = PairTracker::new().closest(&kinds[0].shape(), &kinds[1].shape(), &place.pose());
            let mut pair = PairTracker::new();
            for _ in 0..30 {
                worst.take([&kinds[0], &kinds[1]], [0.0; 2], &place, &mut pair);
                place.t = (Vector3::from(place.t) - *o.normal * 0.01).into();
                let turned = truth::pose::quat_mul(truth::pose::quat(axis, 0.5f64.to_radians()), place.q);
                place.q = truth::pose::unit_quat(turned);
            }
        }
        println!("{first:12} {second:12} {worst:?}");
        if worst.bad > 0 {
            failed += &format!("{first} {second} {}, ", worst.bad);
        }
    }
    assert!(failed.is_empty(), "not opposite: {failed}");
}

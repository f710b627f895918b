//! Promise: a start along a normal changes the work of a query, never its bounds.

use lin_canny::nalgebra::{Quaternion, Unit, UnitQuaternion, Vector3};
use lin_canny::{ContactState, Manifold, ManifoldOptions, Outcome, PairTracker, Shape};
use truth::curved::{Kind, Place, wide};
use truth::rng::Rng;

use super::{Mix, at_gap, count, pairs};

/// Work of the queries with one start policy.
#[derive(Default, Debug)]
struct Work {
    steps: u64,
    queries: u64,
}

impl Work {
    fn add(&mut self, o: &Outcome) {
        self.steps += u64::from(o.work.steps);
        self.queries += 1;
    }

    fn mean(&self) -> f64 {
        self.steps as f64 / self.queries as f64
    }
}

/// Returns two random shapes, a pose near contact, and the pose in the next frame.
fn draw(first: &str, second: &str, rng: &mut Rng) -> ([Kind; 2], [Place; 2]) {
    let aspect = rng.log_range(1.0, 10.0);
    let [a, b] = [first, second].map(|kind| Kind::random(kind, rng, aspect));
    let size = a.radius().min(b.radius());
    let gap = size * rng.range(-0.03, 0.03);
    let place = at_gap(&a, &b, rng, gap);
    let mut next = Place::new(place.q, place.t);
    next.q.iter_mut().for_each(|x| *x += 0.004 * rng.range(-1.0, 1.0));
    next.q = truth::pose::unit_quat(next.q);
    next.t
        .iter_mut()
        .for_each(|x| *x += 0.004 * size * rng.range(-1.0, 1.0));
    ([a, b], [place, next])
}

fn agree(told: &Outcome, cold: &Outcome) {
    let is_open = told.lower <= 0.0 && told.upper >= 0.0 || cold.lower <= 0.0 && cold.upper >= 0.0;
    assert!(told.state == cold.state || is_open, "{told:?}\n{cold:?}");
    assert!(told.lower <= cold.upper, "{told:?}\n{cold:?}");
    assert!(cold.lower <= told.upper, "{told:?}\n{cold:?}");
    assert!(told.lower <= told.distance && told.distance <= told.upper, "{told:?}");
}

#[test]
fn starts_along_normals_change_the_work_alone() {
    let [mut cold_work, mut told_work, mut wrong_work] = [0; 3].map(|_| Work::default());
    let (mut apart, mut deep) = (0, 0);
    for (k, (first, second)) in pairs().enumerate() {
        let (mut rng, mut mix) = (Rng::new(2300 + k as u64), Mix::default());
        for _ in 0..count() / 3 {
            let ([a, b], [place, next]) = draw(first, second, &mut rng);
            let (x, y, pose) = (a.shape(), b.shape(), next.pose());
            let before = PairTracker::new().closest(&x, &y, &place.pose());
            let cold = PairTracker::new().closest(&x, &y, &pose).outcome;
            let told = PairTracker::with_direction(&before.normal, &x, &y)
                .closest(&x, &y, &pose)
                .outcome;
            agree(&told, &cold);
            // The start is that of the pair in this order, for any order of solving.
            let (pose_a, pose_b) = place.pose().poses();
            let in_world = pose_a.rotation * before.normal.into_inner();
            let back = Unit::new_normalize(-pose_b.rotation.inverse_transform_vector(&in_world));
            let swapped = PairTracker::with_direction(&back, &y, &x)
                .closest(&y, &x, &pose.swapped())
                .outcome;
            agree(&swapped, &cold);
            let wrong = Unit::new_normalize(Vector3::from(rng.unit()));
            let wrong = PairTracker::with_direction(&wrong, &x, &y).closest(&x, &y, &pose);
            agree(&wrong, &cold);
            wrong_work.add(&wrong);
            if cold.state == ContactState::Separated {
                mix.judge(&a, &b, &next, &told);
                apart += 1;
                cold_work.add(&cold);
                told_work.add(&told);
            } else {
                deep += 1;
            }
        }
    }
    println!(
        "cold {:.1} told {:.1} wrong {:.1}",
        cold_work.mean(),
        told_work.mean(),
        wrong_work.mean()
    );
    assert!(apart > 500 && deep > 500, "{apart} {deep}");
    assert!(told_work.mean() < 0.9 * cold_work.mean(), "{told_work:?} {cold_work:?}");
}

/// Polyhedra and meshes use no start.
#[test]
fn other_pairs_take_no_start() {
    let cube = Shape::cuboid(Vector3::repeat(0.5)).expect("a cuboid");
    let mut rng = Rng::new(2500);
    for _ in 0..50 {
        let place = Place::new(rng.quat(), rng.unit().map(|x| 1.3 * x));
        let cold = PairTracker::new().closest(&cube, &cube, &place.pose());
        let normal = Unit::new_normalize(Vector3::from(rng.unit()));
        let told = PairTracker::with_direction(&normal, &cube, &cube).closest(&cube, &cube, &place.pose());
        assert_eq!(told.lower, cold.lower);
        assert_eq!(told.upper, cold.upper);
        assert_eq!(told.features, cold.features);
    }
}

/// A local depth of curved shapes is returned only for overlaps, and separates them.
#[test]
fn local_depths_of_curved_shapes_part_them() {
    let (mut deep, mut deeper) = (0, 0);
    for (k, (first, second)) in pairs().enumerate() {
        let mut rng = Rng::new(2600 + k as u64);
        for _ in 0..count() / 3 {
            let ([a, b], [place, next]) = draw(first, second, &mut rng);
            let (x, y, pose) = (a.shape(), b.shape(), next.pose());
            let before = PairTracker::new().closest(&x, &y, &place.pose());
            let full = PairTracker::new().closest(&x, &y, &pose);
            let options = ManifoldOptions::default().prediction(0.0).local_depth(true);
            let mut manifold = Manifold::new();
            PairTracker::with_direction(&before.normal, &x, &y)
                .manifold(&x, &y, &pose, &options, &mut manifold)
                .expect("convex shapes");
            let size = next.size(&a, &b);
            assert!(manifold.lower() <= full.upper, "{} {full:?}", manifold.lower());
            if full.state != ContactState::Overlapping || full.upper > -1e-6 * size {
                assert!(
                    manifold.lower() >= full.lower - 1e-6 * size,
                    "{} {full:?}",
                    manifold.lower()
                );
                continue;
            }
            let t = Vector3::from(next.t) - manifold.normal().into_inner() * manifold.lower();
            let parted = Place::new(next.q, t.into());
            let gap = PairTracker::new().closest(&x, &y, &parted.pose());
            assert!(gap.upper >= -1e-9 * size, "{gap:?} {}", manifold.lower());
            deep += 1;
            deeper += u32::from(manifold.lower() < full.lower - 0.01 * size);
        }
    }
    assert!(deep > 500, "{deep}");
    println!("{deeper} of {deep} deeper than the least");
    assert!(deeper < deep / 50, "{deeper} of {deep}");
}

/// A tracked deep and spinning overlap: the normal has length one and proves the lower bound, for
/// any start.
#[test]
fn normals_of_tracked_overlaps_prove_their_bounds() {
    let mut rng = Rng::new(4_117);
    let mut overlaps = 0;
    for (first, second) in [
        ("cone", "ellipsoid"),
        ("cylinder", "cylinder"),
        ("ellipsoid", "cone"),
        ("cone", "cone"),
    ] {
        for _ in 0..40 {
            let (kinds, [place, _]) = draw(first, second, &mut rng);
            let shapes = kinds.each_ref().map(Kind::shape);
            let mut pair = PairTracker::new();
            let (deep, axis) = (rng.range(0.05, 0.9), Vector3::from(rng.unit()));
            for k in 0..40 {
                let turn = UnitQuaternion::from_scaled_axis(axis * (0.1 * f64::from(k)));
                let [x, y, z, w] = place.q;
                let q = (turn * UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z))).coords;
                let place = Place::new([q.x, q.y, q.z, q.w], place.t.map(|x| x * deep));
                let o = pair.closest(&shapes[0], &shapes[1], &place.pose());
                let size = place.size(&kinds[0], &kinds[1]);
                assert!((o.normal.norm() - 1.0).abs() <= 1e-15, "{kinds:?} {o:?}");
                let proof = place.height(&kinds[0], &kinds[1], &wide((*o.normal).into())).0;
                assert!(
                    o.state != ContactState::Overlapping || o.lower <= proof + 1e-14 * size,
                    "{proof} {kinds:?} {o:?}"
                );
                overlaps += u32::from(o.state == ContactState::Overlapping);
            }
        }
    }
    assert!(overlaps > 3_000, "{overlaps}");
}

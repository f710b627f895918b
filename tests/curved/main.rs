//! Promise: bounds of curved pairs contain the true distance and are at most 1e-13 L wide, warm and
//! cold, in both orders.
//!
//! The judge is the duality gap in double-double (`truth::curved`). The support value of the
//! difference along the returned normal is a lower bound. The distance of the witnesses plus their
//! distances outside their shapes is an upper bound.

mod corpus;
mod manifolds;
mod opposite;
mod special;
mod starts;
mod suites;

use lin_canny::nalgebra::Vector3;
use lin_canny::{ContactState, Outcome, PairTracker, Solver};
use truth::curved::{KINDS, Kind, Place, Wide};
use truth::rng::Rng;

/// Counts of a suite.
#[derive(Default, Debug)]
struct Mix {
    classes: [u32; 4],
    layers: [u32; 7],
    widest: f64,
    low: f64,
    high: f64,
    evaluations: u64,
    hard: std::collections::BTreeMap<String, u32>,
}

impl Mix {
    /// Judges an outcome of separated shapes.
    fn judge(&mut self, a: &Kind, b: &Kind, place: &Place, o: &Outcome) {
        let (lower, upper) = place.truth(a, b, o);
        let size = place.size(a, b);
        let told = || format!("{a:?} {b:?} {place:?}\n{o:?}\n{lower:?} {upper:?}");
        assert!(o.lower <= o.distance && o.distance <= o.upper, "{}", told());
        // Bounds in double-double are tighter than witnesses in `f64` can confirm.
        let fine = o.solver == Solver::DoubleDouble;
        let slack = if fine { 8.0 * f64::EPSILON * size } else { 0.0 };
        assert!(
            (Wide::from(o.lower) - upper).0 <= slack,
            "the lower bound is too high: {}",
            told()
        );
        assert!(
            (lower - Wide::from(o.upper)).0 <= slack,
            "the upper bound is too low: {}",
            told()
        );
        assert!((o.normal.norm() - 1.0).abs() < 1e-15, "{}", told());
        self.classes[o.state as usize] += 1;
        self.layers[o.solver as usize] += 1;
        self.widest = self.widest.max((o.upper - o.lower) / size);
        self.evaluations += u64::from(o.work.steps);
        if o.solver != Solver::Walk {
            *self
                .hard
                .entry(format!("{}", o.features).replace(char::is_numeric, ""))
                .or_default() += 1;
        }
        if o.solver == Solver::DoubleDouble {
            return;
        }
        // Without their error term of 128 UNIT L.
        let term = 128.0 * f64::EPSILON / 2.0 * size;
        self.low = self
            .low
            .max((Wide::from(o.lower + term) - upper).0 / size / f64::EPSILON * 2.0);
        self.high = self
            .high
            .max((lower - Wide::from(o.upper - term)).0 / size / f64::EPSILON * 2.0);
    }

    fn print(&self, first: &str, second: &str) {
        println!(
            "{first:12} {second:12} beyond {:.2} % {:?} widest {:.1e} low {:.1} high {:.1} evaluations {:.1} {:?}",
            100.0 * self.beyond(),
            self.layers,
            self.widest,
            self.low,
            self.high,
            self.evaluations as f64 / f64::from(self.count()),
            self.hard
        );
    }

    fn count(&self) -> u32 {
        self.classes.iter().sum()
    }

    fn beyond(&self) -> f64 {
        f64::from(self.count() - self.layers[Solver::Walk as usize]) / f64::from(self.count())
    }
}

/// Returns a pose at which two shapes are `gap` apart, by moving B along the normal.
fn at_gap(a: &Kind, b: &Kind, rng: &mut Rng, gap: f64) -> Place {
    let far = 3.0 * (a.radius() + b.radius());
    let mut place = Place::new(rng.quat(), truth::pose::scale(rng.unit(), far));
    let (x, y) = (a.shape(), b.shape());
    for _ in 0..2 {
        let o = PairTracker::new().closest(&x, &y, &place.pose());
        let t = Vector3::from(place.t) - *o.normal * (o.distance - gap);
        place.t = t.into();
    }
    place
}

/// Returns the number of poses of each pair of kinds; LIN_CANNY_CURVED changes it.
fn count() -> u32 {
    std::env::var("LIN_CANNY_CURVED")
        .ok()
        .and_then(|n| n.parse().ok())
        .unwrap_or(300)
}

/// Returns each pair of kinds with at least one curved shape.
fn pairs() -> impl Iterator<Item = (&'static str, &'static str)> {
    (0..KINDS.len()).flat_map(|i| (i.max(3)..KINDS.len()).map(move |k| (KINDS[i], KINDS[k])))
}

#[test]
fn every_curved_kind_of_the_library_is_drawn() {
    let drawn: Vec<String> = KINDS[3..].iter().map(|name| name.to_uppercase()).collect();
    let known = lin_canny::shape::curved_kinds(Vector3::repeat(1.0)).into_iter();
    let known: Vec<String> = known.map(|(name, _)| name.to_uppercase()).collect();
    assert_eq!(drawn, known, "the kinds of `truth::curved`");
}

#[test]
fn random_poses_of_all_pairs_of_kinds() {
    let (mut failed, mut all, mut beyond) = (String::new(), 0, 0.0);
    for (k, (first, second)) in pairs().enumerate() {
        let (mut rng, mut cold) = (Rng::new(2100 + k as u64), Mix::default());
        for _ in 0..count() {
            let aspect = rng.log_range(1.0, 30.0);
            let a = Kind::random(first, &mut rng, aspect);
            let b = Kind::random(second, &mut rng, aspect);
            let gap = rng.log_range(1e-9, 10.0);
            let place = at_gap(&a, &b, &mut rng, gap);
            let (x, y, pose) = (a.shape(), b.shape(), place.pose());
            let o = PairTracker::new().closest(&x, &y, &pose);
            cold.judge(&a, &b, &place, &o);
            assert_eq!(o.state, ContactState::Separated, "{a:?} {b:?} {place:?} {o:?}");
            let swapped = PairTracker::new().closest(&y, &x, &pose.swapped());
            assert_eq!(swapped.state, o.state);
            assert!(swapped.lower <= o.upper, "{o:?} {swapped:?}");
            assert!(o.lower <= swapped.upper, "{o:?} {swapped:?}");
        }
        cold.print(first, second);
        all += cold.count();
        beyond += cold.beyond() * f64::from(cold.count());
        if cold.widest > 1e-13 {
            failed += &format!("{first} {second} ");
        }
    }
    println!(
        "{all} poses, {:.2} % beyond the first layer",
        100.0 * beyond / f64::from(all)
    );
    assert!(failed.is_empty(), "too wide: {failed}");
}

//! Promise: on small bodies every outcome is that of exact arithmetic, for every query.
//!
//! The judge is `truth::exact`, brute force over all feature pairs in integers. Bounds contain the
//! true distance, the distance is within 1e-14 L of it, witnesses lie in their bodies, and the
//! normal attains the distance. This holds warm and cold, in both orders.

use lin_canny::{ConvexPolyhedron, Outcome, Tracker};
use truth::bound;
use truth::exact::{self, Exact};
use truth::motion::{self, Frame};
use truth::pose::radius;
use truth::rng::Rng;
use truth::shapes::{self, Shape};
use truth::support;
use truth::{Body, Pose};

/// Allowed error in units of L.
const ERROR: f64 = 1e-14;

/// Number of separated cases in each of the four streams.
const SEPARATED: usize = 1250;

/// A pair of bodies in both forms.
struct Pair {
    shapes: [Shape; 2],
    bodies: [ConvexPolyhedron; 2],
}

impl Pair {
    fn new(a: Shape, b: Shape) -> Self {
        let bodies = [support::body(&a), support::body(&b)];
        Self { shapes: [a, b], bodies }
    }

    fn truth(&self, frame: &Frame) -> Exact {
        let [a, b] = [0, 1].map(|k| Body::from(&self.shapes[k]));
        exact::solve(a, &frame.a, b, &frame.b)
    }

    fn swapped(&self) -> Self {
        let [a, b] = self.shapes.clone();
        Self::new(b, a)
    }

    /// Judges all results of an outcome against the oracle.
    fn judge(&self, frame: &Frame, o: &Outcome, truth: &Exact, what: &str) {
        let [a, b] = &self.bodies;
        let allowed = ERROR * support::size(a, b, frame);
        let s = truth.distance;
        let told = || {
            format!(
                "{what}: {o:?}\ntruth {} {s}\n{:?}\n{:?} {frame:?}",
                truth.state, self.shapes[0], self.shapes[1]
            )
        };
        assert_eq!(format!("{:?}", o.state), format!("{:?}", truth.state), "{}", told());
        assert!(o.lower <= s && s <= o.upper, "{}", told());
        assert!(support::are_of(o.features, a, b), "{}", told());
        let (on_a, on_b) = (o.point_on_a.coords.into(), o.point_on_b.coords.into());
        let outside =
            bound::outside_by(on_a, (&self.shapes[0]).into()).max(bound::outside_by(on_b, (&self.shapes[1]).into()));
        assert!(outside <= allowed, "witness {outside:e} outside, {}", told());
        let apart = bound::witness_distance(on_a, &frame.a, on_b, &frame.b);
        let off = (apart - s.abs()).abs();
        assert!(off <= allowed, "witnesses {apart:e} apart, {}", told());
        assert!((o.distance - s).abs() <= allowed, "{}", told());
        assert!(o.upper - o.lower <= 1e-13 / ERROR * allowed, "{}", told());
        let normal = frame.a.rotate(o.normal.into_inner().into());
        let gap = bound::support_gap(
            (&self.shapes[0]).into(),
            &frame.a,
            (&self.shapes[1]).into(),
            &frame.b,
            normal,
        );
        assert!(gap >= s - allowed, "gap along the normal {gap:e}, {}", told());
    }

    /// Runs every query; `warm` has seen this pair at other poses.
    fn ask(&self, frame: &Frame, warm: &mut Tracker) -> truth::ContactState {
        let truth = self.truth(frame);
        let ([a, b], pose) = (&self.bodies, support::relative(frame));
        self.judge(frame, &Tracker::new().closest(a, b, &pose), &truth, "cold");
        self.judge(frame, &warm.closest(a, b, &pose), &truth, "warm");
        let back = self.swapped();
        let turned = Tracker::new().closest(&back.bodies[0], &back.bodies[1], &support::relative(&frame.swapped()));
        back.judge(&frame.swapped(), &turned, &truth, "swapped");
        let exact = Tracker::new().closest_exact(a, b, &pose);
        self.judge(frame, &exact, &truth, "exact");
        if truth.state == truth::ContactState::Separated {
            let (d, s) = (exact.distance, truth.distance);
            assert!(s.next_down() <= d, "exact level: {d:e} is not {s:e}");
            assert!(d <= s.next_up(), "exact level: {d:e} is not {s:e}");
        }
        let short = Tracker::new().distance(a, b, &pose);
        assert_eq!(format!("{:?}", short.state), format!("{:?}", truth.state));
        assert!(short.lower <= truth.distance && truth.distance <= short.upper);
        truth.state
    }
}

/// Runs random small bodies at random poses until enough are separated.
fn stream(seed: u64, make: impl Fn(&mut Rng) -> Shape) {
    let (mut separated, mut overlapping) = (0, 0);
    let mut rng = Rng::new(seed);
    while separated < SEPARATED {
        let pair = Pair::new(make(&mut rng), make(&mut rng));
        let radii = (radius(&pair.shapes[0].points), radius(&pair.shapes[1].points));
        let mut warm = Tracker::new();
        for frame in motion::random_poses(&mut rng, 10, radii, (0.3, 1.3), 1.0) {
            match pair.ask(&frame, &mut warm) {
                truth::ContactState::Separated => separated += 1,
                _ => overlapping += 1,
            }
        }
    }
    assert!(overlapping > SEPARATED / 20, "{overlapping}");
}

#[test]
fn random_hulls() {
    stream(101, |r| {
        let n = 4 + r.below(9);
        shapes::sphere(r, n).solved()
    });
}

#[test]
fn shipped_solids() {
    let small: Vec<Shape> = support::shipped()
        .iter()
        .filter(|b| b.vertex_count() <= 12)
        .map(support::plain)
        .collect();
    assert!(small.len() >= 6);
    let small: Vec<Shape> = small.into_iter().map(Shape::solved).collect();
    stream(102, move |r| r.pick(&small).clone());
}

#[test]
fn hard_families() {
    stream(103, shapes::small);
}

#[test]
fn hard_families_again() {
    stream(104, shapes::small);
}

/// Poses at which bodies with small integer vertices touch exactly: whole shifts, and quarter
/// turns, which are exact over the rationals.
#[test]
fn touching_is_found() {
    let mut rng = Rng::new(105);
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let quarter = [
        [0.0, 0.0, 0.0, 1.0],
        [half, 0.0, 0.0, half],
        [0.0, half, 0.0, half],
        [0.0, 0.0, -half, half],
    ];
    let mut seen = [0; 3];
    for _ in 0..150 {
        let mut make = || match rng.below(3) {
            0 => Shape::solved(shapes::cuboid([1.0, 2.0, 1.0])),
            1 => shapes::octahedron().solved(),
            _ => loop {
                let s = shapes::lattice(&mut rng, 8, 1).solved();
                if !s.faces.is_empty() {
                    break s;
                }
            },
        };
        let pair = Pair::new(make(), make());
        let mut warm = Tracker::new();
        for _ in 0..4 {
            let shift = std::array::from_fn(|_| rng.int(-3, 3) as f64);
            let frame = Frame::new(Pose::IDENTITY, Pose::new(*rng.pick(&quarter), shift));
            seen[pair.ask(&frame, &mut warm) as usize] += 1;
        }
    }
    assert!(
        seen.iter().all(|&n| n > 40),
        "separated, touching, overlapping: {seen:?}"
    );
}

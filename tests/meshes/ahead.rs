//! Casts of meshes and compounds: separated up to `safe`, in contact at hits and separated during
//! misses, at dense samples.

use super::{mesh, shapes};
use lin_canny::impact::{Impact, Tolerance, cast};
use lin_canny::motion::{Motion, Steady};
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::separation::Separation;
use lin_canny::{Compound, ContactState, GeometryRef, PairTracker, Piece, RelativePose, Shape, Velocity};
use truth::Pose;
use truth::pose::{add, scale};
use truth::rng::Rng;
use truth::soups;
use truth::support::piece_at;

/// Results of casts, and their queries.
#[derive(Debug, Default)]
struct Tally {
    hits: u32,
    misses: u32,
    others: u32,
    queries: u32,
}

fn steady(pose: Pose, linear: [f64; 3], angular: [f64; 3]) -> Steady {
    Steady::new(&pose.isometry(), Velocity::new(linear.into(), angular.into())).unwrap()
}

/// Casts two moving bodies over a unit of time, and compares with dense samples.
fn judge<S: Separation>(
    pair: &mut S,
    state: &mut dyn FnMut(&RelativePose) -> ContactState,
    (a, b): (&Steady, &Steady),
    tally: &mut Tally,
) {
    let found = cast(pair, a, b, 0.0..1.0, Tolerance::Distance(1e-6)).unwrap();
    tally.queries += found.queries;
    let at = |t: f64| RelativePose::new(&a.pose(t), &b.pose(t)).unwrap();
    let safe = match found.impact {
        Impact::Miss => {
            tally.misses += 1;
            1.0
        }
        Impact::Hit { safe, hit, .. } => {
            tally.hits += 1;
            assert_ne!(state(&at(hit)), ContactState::Separated, "{found:?}");
            safe
        }
        Impact::AtStart { .. } => {
            assert_ne!(state(&at(0.0)), ContactState::Separated);
            return;
        }
        Impact::Undecided { safe, .. } | Impact::Incomplete { safe } => {
            tally.others += 1;
            safe
        }
        _ => panic!("{found:?}"),
    };
    for k in 0..=60 {
        let t = safe * f64::from(k) / 60.0;
        assert_eq!(state(&at(t)), ContactState::Separated, "late: {t} {found:?}");
    }
}

fn models(rng: &mut Rng, spin: f64) -> (Steady, Steady) {
    let from = scale(rng.unit(), 3.0);
    let aim = scale(rng.in_ball(), 2.5);
    let q = rng.quat();
    let towards = add(aim, scale(from, -1.0));
    let a = steady(Pose::IDENTITY, scale(rng.in_ball(), 0.3), scale(rng.in_ball(), spin));
    let b = steady(Pose::new(q, from), towards, scale(rng.in_ball(), spin));
    (a, b)
}

fn bodies() -> (Compound, Compound) {
    let beam = |x: f64, turn: f64| {
        piece_at(
            Isometry3::new(Vector3::new(x, 0.0, 0.0), Vector3::z() * turn),
            Shape::cuboid(Vector3::new(0.8, 0.15, 0.2)).unwrap(),
        )
    };
    let cross = Compound::new(vec![beam(0.0, 0.0), beam(0.1, 1.4), beam(-0.5, 0.7)]).unwrap();
    let round = Compound::new(vec![beam(0.0, 0.3), Piece::new(Shape::cylinder(0.5, 0.3).unwrap())]).unwrap();
    (cross, round)
}

fn of_parts<'g>(
    a: impl Into<GeometryRef<'g>>,
    b: impl Into<GeometryRef<'g>>,
) -> impl FnMut(&RelativePose) -> ContactState {
    let (a, b): (GeometryRef, GeometryRef) = (a.into(), b.into());
    let mut tracker = PairTracker::new();
    move |pose| tracker.closest(a, b, pose).state
}

#[test]
fn casts_are_never_late() {
    let mut rng = Rng::new(21);
    let soups = shapes();
    let meshes: Vec<_> = soups.iter().map(mesh).collect();
    let (cross, round) = bodies();
    let [mut of_meshes, mut of_pieces, mut mixed] = [0; 3].map(|_| Tally::default());
    for k in 0..60 {
        let spin = [0.0, 0.5, 3.0][k % 3];
        let (a, b) = models(&mut rng, spin);
        let (m, n) = (&meshes[rng.below(7)], &meshes[rng.below(7)]);
        let mut tracker = PairTracker::new();
        let mut state = |pose: &RelativePose| tracker.closest(m, n, pose).state;
        judge(&mut PairTracker::new().pair(m, n), &mut state, (&a, &b), &mut of_meshes);
        judge(
            &mut PairTracker::new().pair(&cross, &round),
            &mut of_parts(&cross, &round),
            (&a, &b),
            &mut of_pieces,
        );
        judge(
            &mut PairTracker::new().pair(m, &round),
            &mut of_parts(m, &round),
            (&a, &b),
            &mut mixed,
        );
    }
    println!("{of_meshes:?}\n{of_pieces:?}\n{mixed:?}");
    for tally in [of_meshes, of_pieces, mixed] {
        assert!(tally.hits > 15 && tally.misses > 5 && tally.others < 3, "{tally:?}");
    }
}

/// A ball that flies along a wall at a distance of 0.01: the wall does not shorten the steps.
#[test]
fn motion_along_a_wall_takes_few_looks() {
    let wall = mesh(&soups::plate(12, [4.0, 4.0, 0.1]));
    let ball = Compound::from(Shape::ball(0.2).unwrap());
    let a = steady(Pose::IDENTITY, [0.0; 3], [0.0; 3]);
    let b = steady(Pose::shift([-3.0, 0.3, 0.31]), [6.0, 0.1, 0.0], [0.0; 3]);
    let mut tracker = PairTracker::new();
    let mut pair = tracker.pair(&wall, &ball);
    let found = cast(&mut pair, &a, &b, 0.0..1.0, Tolerance::Distance(1e-6)).unwrap();
    println!("{} looks", found.queries);
    assert_eq!(found.impact, Impact::Miss);
    assert!(found.queries <= 3, "{found:?}");
    // Downward at a hundredth of the speed along the wall: the contact is found in time.
    let b = steady(Pose::shift([-3.0, 0.3, 0.31]), [6.0, 0.1, -0.06], [0.0; 3]);
    let found = cast(&mut pair, &a, &b, 0.0..1.0, Tolerance::Distance(1e-9)).unwrap();
    let Impact::Hit { safe, hit, .. } = found.impact else {
        panic!("{found:?}")
    };
    assert!((safe - 1.0 / 6.0).abs() < 1e-6 && hit >= safe, "{found:?}");
    assert!(found.queries <= 8, "{found:?}");
}

//! Promise: a cast ends as documented in empty intervals, long intervals and after many steps, and
//! shrinks its tolerance for a motion that grazes.

use lin_canny::impact::{Certificate, Impact, Tolerance, cast, free_until};
use lin_canny::motion::Steady;
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::separation::Proof;
use lin_canny::{ConvexPolyhedron, Tracker, Velocity};
use std::ops::Range;

fn cube() -> ConvexPolyhedron {
    solids::cuboid(Vector3::repeat(0.5)).unwrap()
}

fn at_rest() -> Steady {
    Steady::new(&Isometry3::identity(), Velocity::default()).unwrap()
}

fn moving(place: [f64; 3], linear: [f64; 3], angular: [f64; 3]) -> Steady {
    let [x, y, z] = place;
    Steady::new(
        &Isometry3::translation(x, y, z),
        Velocity::new(linear.into(), angular.into()),
    )
    .unwrap()
}

/// Casts a cube against a cube at rest.
fn found(flight: &Steady, interval: Range<f64>, tolerance: f64) -> Impact {
    let (a, b) = (cube(), cube());
    let tolerance = Tolerance::Distance(tolerance);
    cast(
        &mut Tracker::new().pair(&a, &b),
        &at_rest(),
        flight,
        interval,
        tolerance,
    )
    .unwrap()
    .impact
}

#[test]
fn an_empty_interval_between_separated_shapes_is_a_miss() {
    let flight = moving([1.25, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0; 3]);
    assert_eq!(found(&flight, 0.125..0.125, 1e-3), Impact::Miss);
}

/// The first step covers 1e-11 of the interval.
#[test]
fn a_hit_early_in_a_long_interval_is_found() {
    let flight = moving([3.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 0.01]);
    let Impact::Hit { safe, hit, .. } = found(&flight, 0.0..1e12, 1e-3) else {
        panic!("a hit")
    };
    assert!(1.9 < safe && safe < hit && hit < 2.1, "{safe} {hit}");
}

/// Many steps at a good pace.
#[test]
fn a_cube_that_spins_next_to_another_for_long_misses_it() {
    // Half the diagonal of a face is 0.7071.
    let flight = moving([1.2072, 0.0, 0.0], [0.0; 3], [0.0, 0.0, 1.0]);
    assert_eq!(found(&flight, 0.0..6000.0, 1e-6), Impact::Miss);
}

/// The gap is smaller than the tolerance, and no contact follows.
#[test]
fn a_cube_that_slides_past_within_the_tolerance_misses() {
    let flight = moving([-1.5, 1.0 + 1e-5, 0.0], [1.0, 0.0, 0.0], [0.0; 3]);
    assert_eq!(found(&flight, 0.0..3.0, 1e-3), Impact::Miss);
}

#[test]
fn an_empty_interval_of_overlapping_shapes_proves_nothing() {
    let (a, b) = (cube(), cube());
    let flight = moving([0.5, 0.0, 0.0], [0.0; 3], [0.0; 3]);
    let found = free_until(&mut Tracker::new().pair(&a, &b), &at_rest(), &flight, 0.5..0.5, 0.0).unwrap();
    let Certificate { until, proof, .. } = found;
    assert_eq!((until, proof), (0.5, Proof::Own));
}

#[test]
fn halves_of_a_certificate_share_the_middle() {
    let (a, b) = (cube(), cube());
    let flight = moving([1.5, 0.0, 0.0], [-0.1, 0.0, 0.0], [0.0, 0.0, 1.0]);
    let whole = free_until(&mut Tracker::new().pair(&a, &b), &at_rest(), &flight, 0.0..0.25, 0.0).unwrap();
    let [first, second] = whole.halved();
    assert_eq!((first.from, second.until), (whole.from, whole.until));
    assert!(first.until == second.from && whole.from < first.until && first.until < whole.until);
}

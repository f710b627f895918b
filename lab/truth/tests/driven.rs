//! Promise: the worlds of the soak hold for some seeds, and their draws contain every ingredient.

use truth::driven::{clouds, curves, distances, planner, played, surfaces, throws, underflow};
use truth::rng::Rng;

#[test]
fn worlds_of_the_planner_agree_with_cold_queries() {
    let mix = played(0..30, planner::play);
    assert!(mix.worlds[1] > 0 && mix.changes[0] > 0, "{mix:?}");
    let lists = [
        &mix.configurations[..],
        &mix.segments[..2],
        &mix.curves[..2],
        &mix.ranges[..3],
    ];
    assert!(lists.iter().all(|list| list.iter().all(|n| *n > 0)), "{mix:?}");
}

#[test]
fn casts_agree_with_queries_at_many_times() {
    let mix = played(0..150, throws::play);
    assert!(mix.casts[..2].iter().chain(&mix.kinds).all(|n| *n > 10), "{mix:?}");
    assert!(mix.planes > 0, "{mix:?}");
}

#[test]
fn signed_distances_of_points_are_those_of_rational_arithmetic() {
    let mix = played(0..30, distances::play);
    assert!(mix.places.iter().all(|n| *n > 10), "{mix:?}");
}

#[test]
fn signs_that_underflow_are_those_of_whole_numbers() {
    let mix = played(0..60, underflow::play);
    assert!(mix.tips.iter().all(|n| *n > 10) && mix.corners[0] > 30, "{mix:?}");
}

#[test]
fn clouds_agree_with_their_elements() {
    let mix = played(0..60, clouds::play);
    assert!(mix.frames.iter().chain(&mix.elements).all(|n| *n > 3), "{mix:?}");
}

#[test]
fn no_two_points_of_surfaces_are_closer_than_a_lower_bound() {
    let mix = played(0..12, surfaces::play);
    assert!(mix.frames[0] > 10 && mix.reached > 10, "{mix:?}");
}

#[test]
fn curves_of_random_bytes_are_curves_or_errors() {
    // A curve whose values exceeded a limit by rounding.
    curves::drive(&[61, 161, 146, 147, 45, 255, 255, 255, 255, 255, 255, 137, 178]);
    let mut rng = Rng::new(1);
    let (mut made, mut followed) = ([0; 2], [0; 2]);
    for _ in 0..2_000 {
        let bytes: Vec<u8> = (0..400).map(|_| rng.bits() as u8).collect();
        let tally = curves::drive(&bytes);
        made = [0, 1].map(|k| made[k] + tally.curves[k]);
        followed = [0, 1].map(|k| followed[k] + tally.followed[k]);
    }
    assert!(made.iter().chain(&followed).all(|n| *n > 50), "{made:?} {followed:?}");
}

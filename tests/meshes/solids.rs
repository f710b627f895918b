//! Promise: solids with common faces have the contact state of whole-number arithmetic, at any
//! distance from their origin.

use super::{mesh, relative};
use lin_canny::{ContactState, ManifoldOptions, Mesh, PairTracker};
use truth::Pose;
use truth::driven::played;
use truth::driven::solids::{PLACES, play};
use truth::soups;

fn check(seeds: u64) {
    let mix = played(0..seeds, play);
    println!("{mix:?}");
    let n = mix.pairs;
    assert!(n == PLACES * seeds && mix.supports >= seeds / 8, "{mix:?}");
    assert!(mix.apart > n / 50, "{mix:?}");
    assert!(mix.touching > n / 20, "{mix:?}");
    assert!(mix.overlapping > n / 3, "{mix:?}");
    assert!(
        mix.equal > n / 25 && mix.flush > n / 5 && mix.nested > n / 50 && mix.crossing > n / 50,
        "{mix:?}"
    );
    assert!(
        mix.far > n / 10 && mix.flat > n / 50 && mix.pieces > n / 2 && mix.depths > n / 100,
        "{mix:?}"
    );
}

#[test]
fn solids_with_faces_in_common_have_the_class_of_whole_numbers() {
    check(250);
}

#[test]
#[ignore = "minutes: 100,000 pairs; cargo test --release --all-features --test meshes solids -- --ignored"]
fn a_hundred_thousand_solids_have_the_class_of_whole_numbers() {
    check(100_000 / PLACES);
}

/// Returns a box of twelve triangles.
fn cuboid(low: [f64; 3], high: [f64; 3]) -> Mesh {
    mesh(&soups::cuboid(low, high))
}

fn state(a: &Mesh, b: &Mesh) -> ContactState {
    PairTracker::new().closest(a, b, &relative(&Pose::IDENTITY)).state
}

/// A column in survey coordinates, in metres, entered twice; a bolt; a sheet of foil.
#[test]
fn duplicates_overlap_wherever_they_stand() {
    for far in [0.0, 400.0, 1e3, 5e4, 1e6, 2.6e6, 1e9] {
        for size in [[0.4, 0.4, 3.0], [0.01, 0.01, 0.01], [1.0, 1.0, 1e-5]] {
            let low = [far, 0.5 * far, 0.25 * far];
            let high = [0, 1, 2].map(|k| low[k] + size[k]);
            let l = 4.0 * far + 4.0;
            if size.iter().any(|s| *s < 1e-11 * l) {
                continue;
            }
            let m = cuboid(low, high);
            assert_eq!(state(&m, &m), ContactState::Overlapping, "{far} {size:?}");
        }
    }
}

#[test]
fn an_insert_flush_with_a_wall_overlaps_in_both_orders() {
    for far in [0.0, 3e5, 1e6, 1e7, 1e9] {
        let wall = cuboid([far, 0.0, 0.0], [far + 40.0, 10.0, 30.0]);
        let insert = cuboid([far + 10.0, 0.0, 10.0], [far + 16.0, 6.0, 16.0]);
        assert_eq!(state(&wall, &insert), ContactState::Overlapping, "{far}");
        assert_eq!(state(&insert, &wall), ContactState::Overlapping, "{far}");
        // Next to the wall, coplanar with its front.
        let beside = cuboid([far + 40.0, 0.0, 10.0], [far + 46.0, 6.0, 16.0]);
        assert_eq!(state(&wall, &beside), ContactState::Touching, "{far}");
        assert_eq!(state(&beside, &wall), ContactState::Touching, "{far}");
    }
}

#[test]
fn a_cube_over_a_slab_has_four_contacts_wherever_both_stand() {
    for far in [0.0, 100.0, 1e3, 1e4, 1e5, 1e6] {
        let slab = cuboid([far - 5.0, far - 5.0, far - 1.0], [far + 5.0, far + 5.0, far]);
        let cube = cuboid([far, far, far + 1e-4], [far + 1.0, far + 1.0, far + 1.0 + 1e-4]);
        let mut tracker = PairTracker::new();
        let found = tracker.contacts(
            &slab,
            &cube,
            &relative(&Pose::IDENTITY),
            &ManifoldOptions::default().prediction(1e-3),
        );
        let counts: Vec<_> = found.unwrap().iter().map(|g| g.contacts.len()).collect();
        assert_eq!(counts, [4], "{far}");
    }
}

//! Triangles whose vertices are collinear up to rounding: an upper bound is the distance of points
//! of both.

use lin_canny::nalgebra::Point3;
use lin_canny::{Mesh, PairTracker};
use truth::Pose;
use truth::driven::played;
use truth::driven::slivers::play;
use truth::rng::Rng;

use super::relative;

/// Two slivers on one oblique line, and their distance.
type Case = ([[f64; 3]; 6], f64);

const CASES: [Case; 2] = [
    (
        [
            [-0.08026938892238462, 0.08736930138531958, -0.06993763897047933],
            [-0.24513617936868132, 0.2668187340558592, -0.21358385608076436],
            [-0.10441727998546335, 0.11365309898779065, -0.09097737167233248],
            [0.1558054172560691, -0.16958657142479927, 0.13575116452220945],
            [0.7025856969111482, -0.7647301459065512, 0.612153468165891],
            [0.6060157248351086, -0.6596184575238019, 0.5280133503312592],
        ],
        0.40505,
    ),
    (
        [
            [-0.18812793221342988, -0.41896767121149453, -0.19821499319021818],
            [-0.12515555788391353, -0.2787259287276395, -0.13186616023363132],
            [-0.3240396280979658, -0.7216479061196627, -0.34141401503276597],
            [0.34204730000158134, 0.7617516391093981, 0.360387223964321],
            [0.3039469417230217, 0.6769007709130582, 0.32024399712992513],
            [0.11673243676996076, 0.2599673350625504, 0.12299140742792677],
        ],
        0.643,
    ),
];

#[test]
fn two_slivers_on_one_line_are_as_far_apart_as_their_ends() {
    for (points, truth) in CASES {
        let points = points.map(Point3::from);
        let a = Mesh::new(&points[..3], &[[0, 1, 2]]).unwrap();
        let b = Mesh::new(&points[3..], &[[0, 1, 2]]).unwrap();
        let found = PairTracker::new().closest(&a, &b, &relative(&Pose::IDENTITY));
        assert!((found.distance - truth).abs() < 1e-3, "{found:?}");
        assert!(found.lower <= found.distance && found.distance <= found.upper && found.upper - found.lower < 1e-12);
        let both = Mesh::new(&points, &[[0, 1, 2], [3, 4, 5]]).unwrap();
        let mut tracker = PairTracker::new();
        assert!(!tracker.self_within(&both, 0.9 * truth));
        assert!(tracker.self_pairs(&both, 0.9 * truth).is_empty());
        assert!(tracker.self_within(&both, 1.1 * truth));
    }
}

fn run(count: u64) {
    let mix = played((0..count).map(|k| Rng::of_case(0x511f, k).bits()), play);
    println!("{mix:?}");
    assert!(mix.slivers > mix.meshes / 4 && mix.bent > mix.meshes / 8, "{mix:?}");
    assert!(mix.apart > 0 && mix.meeting > 0 && mix.own > mix.meshes / 4, "{mix:?}");
}

/// Three meshes per seed.
#[test]
fn bounds_and_predicates_of_slivers_hold_over_the_integers() {
    run(340);
}

#[test]
#[ignore = "100,000 meshes: cargo test --release --all-features --test meshes slivers -- --ignored --nocapture"]
fn bounds_and_predicates_of_slivers_hold_over_the_integers_of_100_000_meshes() {
    run(34_000);
}

use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{Compound, ContactState, PointQuery};
use truth::driven::played;
use truth::driven::turned_boxes::{self, EACH};
use truth::support::piece_at;

/// Plays compounds of rotated boxes with at least `asked` points.
fn judge(asked: u64, seed: u64) {
    let mix = played(seed..seed + asked / EACH, turned_boxes::play);
    println!("{mix:?}");
    assert!(mix.points.iter().all(|n| *n > asked / 1000), "{mix:?}");
}

#[test]
fn ten_thousand_points_on_rotated_pieces_have_the_sides_and_bounds_of_exact_arithmetic() {
    judge(10_000, 96_000);
}

#[test]
#[ignore = "a million points, minutes: cargo test --release --test points a_million_points_on -- --ignored --nocapture"]
fn a_million_points_on_rotated_pieces_have_the_sides_and_bounds_of_exact_arithmetic() {
    judge(1_000_000, 1_000_000);
}

/// The stored quaternion is of unit length up to rounding. Divided by its norm once more, it would
/// be another rotation.
#[test]
fn a_point_inside_a_rotated_cube_is_not_outside() {
    let turn = UnitQuaternion::new_unchecked(Quaternion::new(0.6, 0.0, 0.0, 0.8));
    let cube = piece_at(
        Isometry3::from_parts(Vector3::zeros().into(), turn),
        solids::cuboid(Vector3::repeat(1.0)).expect("a cube"),
    );
    let body = Compound::new(vec![cube]).expect("a piece");
    let p = Point3::new(-0.760_000_000_000_000_1, 0.819_999_999_999_999_8, 0.0);
    let found = PointQuery::new(&body).closest_point(&p).expect("a point");
    assert_ne!(found.state, ContactState::Separated, "{found:?}");
    // The exact distance, rounded towards zero.
    let exact = -7.549_516_567e-17;
    assert!(found.lower <= exact && exact <= found.upper, "{found:?}");
}

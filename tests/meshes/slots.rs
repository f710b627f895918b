//! Pins in slots: depths in U-shaped bodies, blocks and doors if edges cross and no vertex is
//! inside, against a closed form.

use super::mesh;
use lin_canny::PairTracker;
use truth::driven::played;
use truth::driven::slots::{Mix, play, union_of};
use truth::soups::Soup;
use truth::support::piece_at;

/// Returns a U whose lower arm ends at y = `depth`, and a pin in its gap from y = 0 to 2.
fn pin_in_u(depth: f64) -> [Soup; 2] {
    let u = [
        [[-4.0, -3.0, -4.0], [5.0, depth, 4.0]],
        [[-4.0, 2.5, -4.0], [5.0, 6.0, 4.0]],
        [[5.0, -3.0, -4.0], [8.0, depth, 4.0]],
        [[5.0, depth, -4.0], [8.0, 2.5, 4.0]],
        [[5.0, 2.5, -4.0], [8.0, 6.0, 4.0]],
    ];
    let pin = [[[-1.0, 0.0, -6.0], [1.0, 2.0, 6.0]]];
    [union_of(&u, 1), union_of(&pin, 1)]
}

#[test]
fn a_pin_in_a_slot_has_its_depth() {
    for depth in [0.1, 1e-3, 1e-6] {
        let [u, pin] = pin_in_u(depth).map(|s| mesh(&s));
        let at = super::relative(&truth::Pose::IDENTITY);
        for (a, b) in [(&u, &pin), (&pin, &u)] {
            let found = PairTracker::new().penetration(a, b, &at).unwrap();
            assert!(
                // Twice 1e-13 of the size of the pair, and 1e-6 of the depth.
                found.lower > depth * 0.999_999 - 4e-12 && found.lower <= depth + 1e-12,
                "{depth} {found:?}"
            );
            assert!(found.upper >= depth && found.upper < depth + 1e-9, "{depth} {found:?}");
        }
    }
}

fn play_all(count: u64) -> Mix {
    let mix = played(0x5107_0000..0x5107_0000 + count, play);
    println!("{mix:?}");
    let parts = [
        mix.joined,
        mix.blocks,
        mix.doors,
        mix.meshes,
        mix.pieces,
        mix.bare,
        mix.shallow,
        mix.fine,
        mix.exchanged,
    ];
    assert!(mix.pins == count && parts.iter().all(|n| *n * 20 > count), "{mix:?}");
    mix
}

/// Pins of compounds that a search once pushed into the other side of the slot, and shallow pins of
/// meshes.
#[test]
fn pins_that_were_pushed_too_far_have_their_depth() {
    let seeds = [
        175, 179, 275, 446, 447, 469, 491, 516, 569, 607, 749, 828, 924, 925, 1242, 1360, 1397, 1486, 1501, 1536, 1549,
        1601, 1606, 1612, 1639, 1642, 1710, 1793, 1822, 1977, 2098, 2143, 2201, 2258, 2262, 2280, 2286, 2287, 2424,
        2442, 2484, 2495, 2536, 2602, 2623, 2692, 2852, 2875, 2934, 3059, 3064, 3250, 3256, 3285, 3396, 3398, 3452,
        3490, 3497, 3598, 3610, 3658, 3702, 3814, 4073, 4141, 4262, 4284, 4342, 4380, 4409, 4491, 4514, 4530, 4534,
        4561, 4563, 4572, 4573, 4580, 4824, 4989, 5033, 5134, 5196, 5310, 5312, 5361, 5450, 5488, 5489, 5503, 5530,
        5646, 5852, 5863, 5889, 6243, 6290, 6303, 6335, 6361, 6451, 6467, 6625, 6640, 6642, 6700, 6701, 6708, 6775,
        6810, 6878, 6897, 6940, 6946, 7012, 7026, 7141, 7174, 7235, 7248, 7416, 7479, 7504, 7519, 7534, 7627, 7701,
        7721, 7756, 7856, 7876, 7906, 7937, 7951, 7995, 8053, 8095, 8281, 8303, 8555, 8564, 8572, 8580, 8757, 8820,
        8829, 8910, 8942, 9087, 9223, 9243, 9390, 9420, 9433, 9439, 9673, 9722, 9742, 9751, 9848, 9892, 9899, 9985,
    ];
    played(seeds.map(|seed| 0x5107_0000 + seed), play);
}

#[test]
fn pins_in_slots_have_their_depth() {
    play_all(100);
}

#[test]
#[ignore = "10,000 pins, minutes: cargo test --release --test meshes pins_in_ten -- --ignored --nocapture"]
fn pins_in_ten_thousand_slots_have_their_depth() {
    play_all(10_000);
}

/// Returns the bounds of the depth of two unions of boxes as meshes, compounds and voxels.
fn bounds_of(u: &[[[f64; 3]; 2]], pin: &[[[f64; 3]; 2]]) -> Vec<lin_canny::PenetrationBounds> {
    use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
    use lin_canny::{Cloud, Compound, Geometry, Shape};
    let compound = |boxes: &[[[f64; 3]; 2]]| -> Geometry {
        let piece = |[low, high]: &[[f64; 3]; 2]| {
            let (low, high) = (Vector3::from(*low), Vector3::from(*high));
            piece_at(
                Isometry3::translation(0.5 * (low.x + high.x), 0.5 * (low.y + high.y), 0.5 * (low.z + high.z)),
                Shape::cuboid((high - low) * 0.5).unwrap(),
            )
        };
        Compound::new(boxes.iter().map(piece).collect()).unwrap().into()
    };
    // Cells of a half.
    let voxels = |boxes: &[[[f64; 3]; 2]]| -> Geometry {
        let mut cells = Vec::new();
        for [low, high] in boxes {
            let [from, to] = [low, high].map(|p| p.map(|x| (2.0 * (x + 16.0)) as u16));
            for x in from[0]..to[0] {
                for y in from[1]..to[1] {
                    cells.extend((from[2]..to[2]).map(|z| [x, y, z]));
                }
            }
        }
        Cloud::from_cells(Point3::new(-16.0, -16.0, -16.0), Vector3::repeat(0.5), &cells)
            .unwrap()
            .into()
    };
    let mesh_of = |boxes: &[[[f64; 3]; 2]]| -> Geometry { mesh(&union_of(boxes, 1)).into() };
    let at = super::relative(&truth::Pose::IDENTITY);
    [mesh_of(u), compound(u), voxels(u)]
        .iter()
        .zip([mesh_of(pin), compound(pin), voxels(pin)])
        .map(|(u, pin)| PairTracker::new().penetration(u, &pin, &at).unwrap())
        .collect()
}

/// A pin half deep in a lug of a clevis, and a bar in the side of a window, as meshes, compounds and
/// voxels. If no room is left in the slot after the translation, the bodies touch on both sides: that
/// is not proven to separate them, and the upper bound is the way out of the slot.
#[test]
fn pins_in_clevises_and_bars_in_windows_have_their_depth_in_all_forms() {
    for room in [0.0, 0.5, 2.0] {
        let top = 2.5 + room;
        let clevis = [
            [[-4.0, -3.0, -4.0], [5.0, 0.5, 4.0]],
            [[-4.0, top, -4.0], [5.0, top + 3.5, 4.0]],
            [[5.0, -3.0, -4.0], [8.0, 0.5, 4.0]],
            [[5.0, 0.5, -4.0], [8.0, top, 4.0]],
            [[5.0, top, -4.0], [8.0, top + 3.5, 4.0]],
        ];
        for pin in [
            [[-1.0, 0.0, -6.0], [1.0, 2.0, 6.0]],
            [[-1.0, 0.0, -2.0], [1.0, 2.0, 2.0]],
            [[-6.0, 0.0, -1.0], [4.0, 2.0, 1.0]],
        ] {
            for (form, found) in bounds_of(&clevis, &[pin]).iter().enumerate() {
                assert!(found.lower <= 0.5, "{room} {form} {found:?}");
                assert!(found.lower > 0.5 - 1e-8, "{room} {form} {found:?}");
                let most = if room > 0.0 { 0.5 + 1e-8 } else { 5.0 + 1e-7 };
                assert!(found.upper >= 0.5 && found.upper < most, "{room} {form} {found:?}");
            }
        }
    }
    let frame = [
        [[-1.0, -2.0, -2.0], [1.0, 3.0, 12.0]],
        [[-1.0, 7.0, -2.0], [1.0, 12.0, 12.0]],
        [[-1.0, 3.0, -2.0], [1.0, 7.0, 3.0]],
        [[-1.0, 3.0, 7.0], [1.0, 7.0, 12.0]],
    ];
    for (form, found) in bounds_of(&frame, &[[[-8.0, 2.0, 4.0], [8.0, 4.0, 6.0]]])
        .iter()
        .enumerate()
    {
        // Voxels of a half are no deeper than that.
        let least = [1.0 - 1e-8, 1.0 - 1e-8, 0.5 - 1e-8][form];
        assert!(found.lower <= 1.0 && found.lower > least, "{form} {found:?}");
        assert!(found.upper >= 1.0 && found.upper < 1.0 + 1e-8, "{form} {found:?}");
    }
}

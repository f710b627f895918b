//! Meshes that violate exactly one condition of a height field: each meets itself at the violation.

use super::meshes::{ends, judge, sheet};
use lin_canny::continuous::{self, MovingMesh};
use lin_canny::impact::Tolerance;
use std::f64::consts::TAU;
use truth::Point;
use truth::pose::{add, scale};
use truth::soups::Soup;

/// Judges a mesh against itself over a frame; returns whether it meets itself.
fn meets(begin: &Soup, end: &Soup, what: &str) -> bool {
    let m = ends(begin, [begin, end]);
    let a = MovingMesh::new(&m[0], &m[1]).unwrap();
    let found = continuous::cast_self(&a, Tolerance::Time(1e-9)).unwrap();
    let p = [begin, end];
    judge(&found.impact, p, p, true, what) > 0
}

/// Returns the points of a soup without some of its triangles.
fn without(soup: &Soup, gone: impl Fn(&[Point; 3]) -> bool) -> Soup {
    let triangles = soup
        .triangles
        .iter()
        .filter(|t| !gone(&t.map(|v| soup.points[v as usize])));
    Soup::new(soup.points.clone(), triangles.copied().collect())
}

/// Both sides of a slot close and slide into each other: the edges of the boundary are separated
/// only at the start.
#[test]
fn a_slot_that_closes_is_no_height_field() {
    let plane = sheet(8, 2.0);
    let slotted = without(&plane, |t| {
        t.iter().all(|p| (0.0..=0.25).contains(&p[0]) && p[1] >= 0.0)
    });
    let mut met = 0;
    for k in 0..12 {
        let far = 0.05 * f64::from(k);
        let lift = if k % 3 == 0 { 0.0 } else { 0.01 * f64::from(k % 3) };
        let place = |way: f64, up: f64| {
            slotted.clone().map(|[x, y, z]| {
                let share = if x <= 0.0 { y.max(0.0) } else { 0.0 };
                [x + share * way, y, z + share * up]
            })
        };
        met += u32::from(meets(&place(0.0, lift), &place(far, -lift), &format!("{k}")));
    }
    assert!((3..=9).contains(&met), "{met}");
}

/// A triangular hole shrinks until its corner passes over the opposite edge: no two edges of its
/// boundary lack a common vertex.
#[test]
fn a_hole_that_turns_over_is_no_height_field() {
    let plane = sheet(6, 2.0);
    let third = 2.0 / 6.0;
    let is_hole = |t: &[Point; 3]| {
        let middle = scale(add(add(t[0], t[1]), t[2]), 1.0 / 3.0);
        (0.0..third).contains(&middle[0]) && (0.0..third).contains(&middle[1]) && middle[0] > middle[1]
    };
    let begin = without(&plane, is_hole);
    assert_eq!(begin.triangles.len() + 1, plane.triangles.len());
    let mut met = 0;
    for k in 0..10 {
        // The corner of the right angle moves over the long side.
        let way = 0.05 * f64::from(k) * third;
        let end = begin.clone().map(|p| {
            let is_corner = (p[0] - third).abs() < 1e-9 && p[1].abs() < 1e-9;
            if is_corner {
                add(p, [-2.0 * way, 2.0 * way, 0.0])
            } else {
                p
            }
        });
        met += u32::from(meets(&begin, &end, &format!("{k}")));
    }
    assert!((2..=8).contains(&met), "{met}");
}

/// A small sheet falls through the middle of a large one: their boundaries never cross, and both
/// are counter-clockwise.
#[test]
fn two_sheets_over_each_other_are_no_height_field() {
    let (large, small) = (sheet(6, 2.0), sheet(2, 0.4));
    let mut met = 0;
    for k in 0..8 {
        let (from, to) = (0.1 + 0.05 * f64::from(k), 0.35 - 0.1 * f64::from(k));
        let at = |z: f64| {
            let first = large.points.len() as u32;
            let points = large
                .points
                .iter()
                .copied()
                .chain(small.points.iter().map(|p| add(*p, [0.03, 0.01, z])));
            let more = small.triangles.iter().map(|t| t.map(|v| v + first));
            Soup::new(points.collect(), large.triangles.iter().copied().chain(more).collect())
        };
        met += u32::from(meets(&at(from), &at(to), &format!("{k}")));
    }
    assert!((2..=7).contains(&met), "{met}");
}

/// Rings about a centre rotate by half a turn: triangles have the same orientation at both ends and
/// turn over in between.
#[test]
fn a_disc_that_turns_over_between_is_no_height_field() {
    const SIDES: u32 = 12;
    const RINGS: u32 = 7;
    let place = |ring: u32, k: u32, share: f64| {
        // The inner rings rotate by half a turn, the outer ones by less and less, down to the
        // boundary at rest.
        let turn = 0.5 * share * (f64::from(RINGS - ring) / f64::from(RINGS - 1)).min(1.0);
        let (sine, cosine) = (TAU * (f64::from(k) / f64::from(SIDES) + turn)).sin_cos();
        let r = 1.6f64.powi(ring as i32);
        [r * cosine, r * sine, 0.0]
    };
    let mut triangles: Vec<[u32; 3]> = vec![];
    let at = |ring: u32, k: u32| 1 + (ring - 1) * SIDES + k % SIDES;
    for k in 0..SIDES {
        triangles.push([0, at(1, k), at(1, k + 1)]);
        for ring in 1..RINGS {
            let [a, b, c, d] = [at(ring, k), at(ring + 1, k), at(ring + 1, k + 1), at(ring, k + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    let mut met = 0;
    for step in 0..6 {
        let share = 0.5 + 0.1 * f64::from(step);
        // The innermost ring is narrow at the start, so that it turns over in one direction before
        // the other.
        let disc = |share: f64, narrow: f64| {
            Soup::new(
                std::iter::once([0.0; 3])
                    .chain((1..=RINGS).flat_map(|ring| {
                        (0..SIDES).map(move |k| {
                            let [x, y, z] = place(ring, k, share);
                            if ring == 1 { [x, y * narrow, z] } else { [x, y, z] }
                        })
                    }))
                    .collect(),
                triangles.clone(),
            )
        };
        met += u32::from(meets(&disc(0.0, 0.4), &disc(share, 1.0), &format!("{share}")));
    }
    assert!(met >= 1, "{met}");
}

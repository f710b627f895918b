//! Every body has the properties that its name states.

use super::*;
use crate::pose::{cross, dot, sub};
use std::collections::HashMap;

/// Asserts that every side of every face is met once in each direction, and that V - E + F = 2 over
/// the used points.
fn assert_closed(s: &Shape) {
    let mut sides: HashMap<(u32, u32), usize> = HashMap::new();
    for f in &s.faces {
        for (i, &a) in f.iter().enumerate() {
            *sides.entry((a, f[(i + 1) % f.len()])).or_default() += 1;
        }
    }
    assert!(
        sides.iter().all(|(&(a, b), &n)| n == 1 && sides.contains_key(&(b, a))),
        "{} is not closed",
        s.name
    );
    let mut used = s.faces.concat();
    used.sort_unstable();
    used.dedup();
    assert_eq!(used.len() + s.faces.len(), sides.len() / 2 + 2, "{}: Euler", s.name);
}

/// Asserts that no point lies above the plane of a face by more than rounding.
fn assert_convex(s: &Shape) {
    for f in &s.faces {
        let [a, b, c] = [0, 1, 2].map(|i| s.points[f[i] as usize]);
        let n = cross(sub(b, a), sub(c, a));
        let size = dot(n, n).sqrt();
        assert!(
            s.points.iter().all(|&p| dot(n, sub(p, a)) <= 1e-13 * size),
            "{} is not convex",
            s.name
        );
    }
}

#[test]
fn bodies_with_faces_are_closed_and_convex() {
    let counts = platonic().map(|s| (s.points.len(), s.faces.len()));
    assert_eq!(counts, [(4, 4), (8, 6), (6, 8), (20, 12), (12, 20)]);
    let mut all = Vec::from(platonic());
    all.extend([
        cuboid([1.0, 2.0, 3.0]),
        prism(3, 1.0, 1.0),
        prism(256, 1.0, 0.1),
        cone(3, 1.0, 1.0),
        cone(512, 1.0, 0.4),
    ]);
    all.extend([icosphere(0), icosphere(2)]);
    for s in &all {
        assert_closed(s);
        assert_convex(s);
    }
    assert_eq!(icosphere(2).points.len(), 162);
}

#[test]
fn near_planes_are_as_near_as_asked() {
    for h in [1e-3, 1e-9, 1e-15] {
        assert_eq!(roof(h).solved().faces.len(), 7, "five of the box and two of the roof");
        assert_eq!(pyramid_lid(h).solved().faces.len(), 9);
    }
    let cut = chamfered([1.0; 3], 1e-9).solved();
    assert_eq!(cut.points.len(), 24, "six faces, twelve edges, eight corners");
    assert_eq!(cut.faces.len(), 26, "six faces, twelve edges, eight corners");
    assert_closed(&cut);
}

#[test]
fn caps_and_domes_are_convex_positions() {
    assert_eq!(brute_hull::extreme(&cap(6, 2, 1e-3).points).len(), 19);
    assert_eq!(brute_hull::extreme(&dome(2, 0.25).points).len(), 13);
}

#[test]
fn dirt_does_not_change_the_hull() {
    let mut r = Rng::new(4);
    for clean in [cube(), cuboid([1.0, 0.5, 0.25]), octahedron()] {
        let soiled = dirty(&clean, &mut r);
        assert!(soiled.points.len() > clean.points.len());
        let keep = |s: &Shape| {
            let mut v: Vec<_> = brute_hull::extreme(&s.points)
                .iter()
                .map(|&i| s.points[i as usize])
                .collect();
            v.sort_by(|a, b| a.partial_cmp(b).expect("finite"));
            v
        };
        assert_eq!(keep(&soiled), keep(&clean));
    }
}

#[test]
fn shuffling_keeps_faces_with_their_points() {
    let s = cube().shuffled(&mut Rng::new(9));
    assert_ne!(s.points, cube().points);
    assert_closed(&s);
    assert_convex(&s);
}

#[test]
fn the_catalogue_is_finite_and_seeded() {
    let all = catalogue(1);
    assert!(all.len() > 40);
    assert!(
        all.iter()
            .all(|s| s.points.len() >= 4 && s.points.iter().flatten().all(|x| x.is_finite()))
    );
    assert_eq!(all, catalogue(1));
    let mut r = Rng::new(8);
    for _ in 0..60 {
        let s = small(&mut r);
        assert!(s.points.len() <= 16);
        assert_closed(&s);
    }
}

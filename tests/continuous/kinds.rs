//! Whole meshes that contain a hard query of each kind, judged by exact arithmetic: no missed hit,
//! no false hit, and touching is decided.

use super::Tally;
use lin_canny::continuous::{self, MovingMesh};
use lin_canny::impact::Tolerance;
use lin_canny::nalgebra::Point3;
use lin_canny::{Mesh, VertexError};
use truth::forms::mesh;
use truth::paths::families::{self, KINDS};
use truth::paths::{self, Moving};
use truth::rng::Rng;
use truth::soups::Soup;

const WIDTH: f64 = 1e-6;

/// Returns the mesh at both ends; an error if vertices leave the range of lengths.
fn ends(moving: &Moving, rng: &mut Rng) -> Result<[Mesh; 2], VertexError> {
    // Built with all vertices at different positions, so that none are merged and no triangle is
    // removed.
    let rest = Soup::new(
        moving.paths.iter().map(|_| rng.unit()).collect(),
        moving.triangles.clone(),
    );
    let mut m = mesh(&rest);
    let places = |k: usize| moving.paths.iter().map(|p| Point3::from(p[k])).collect::<Vec<_>>();
    m.set_vertices(&places(0))?;
    let begin = m.clone();
    m.set_vertices(&places(1))?;
    Ok([begin, m])
}

fn over(ends: &[Mesh; 2]) -> MovingMesh<'_> {
    MovingMesh::new(&ends[0], &ends[1]).unwrap()
}

/// Runs `count` pairs of meshes of each kind, slow and fast, in both orders, and both as one mesh
/// against itself.
fn run(count: usize, seed: u64) {
    let (mut sum, mut refused) = ([0; 3], 0);
    for (i, kind) in KINDS.iter().enumerate() {
        let mut tally = Tally::default();
        for k in 0..count {
            let rng = &mut Rng::of_case(i as u64 + seed, k as u64);
            let [a, b] = families::meshes(kind, k % 4 == 3, rng);
            let whole = a.with(&b);
            let made = [&a, &b, &whole].map(|m| ends(m, rng));
            let [Ok(m), Ok(n), Ok(w)] = &made else {
                refused += 1;
                continue;
            };
            let tolerance = Tolerance::Time(WIDTH);
            let truth = paths::first_contact(&a, &b);
            for (p, q) in [(m, n), (n, m)] {
                let cast = continuous::cast_meshes(&over(p), &over(q), tolerance).unwrap();
                tally.judge(&cast, &truth, WIDTH, &(kind, k, &a, &b));
            }
            let cast = continuous::cast_self(&over(w), tolerance).unwrap();
            tally.judge(&cast, &paths::self_contact(&whole), WIDTH, &(kind, k, &whole));
        }
        println!("{kind}: {tally:?}");
        assert_eq!(tally.open, 0, "{kind}: exact arithmetic decides");
        sum = [sum[0] + tally.apart, sum[1] + tally.start, sum[2] + tally.hits];
    }
    println!("{sum:?}, {refused} out of range");
    assert!(sum.iter().all(|n| *n > 2 * count), "{sum:?} {refused}");
    assert!(refused * 10 < count * KINDS.len(), "{sum:?} {refused}");
}

#[test]
fn meshes_with_a_query_of_each_kind_meet_when_exact_arithmetic_says() {
    run(5, 470);
}

#[test]
#[ignore = "minutes: thousands of meshes in exact arithmetic"]
fn many_meshes_with_a_query_of_each_kind_meet_when_exact_arithmetic_says() {
    run(super::count(), 4_700);
}

//! Benchmarks of bodies in contact: depth and manifold, with parry for comparison.
//!
//! Run `cargo bench --bench contact`. Scenes, shapes, sizes and engines are those of the race
//! (`cargo run --release -p race --bin race -- contact`), which interleaves the engines and
//! compares their answers. These benchmarks follow one engine over time.

use common::{Group, chosen, each};
use criterion::{Criterion, criterion_group, criterion_main};
use lin_canny::{ConvexPolyhedron, Manifold, ManifoldOptions, RelativePose, Tracker};
use truth::contacts::{PREDICTION, SCENES, Scene, plain, shapes};
use truth::parry::{self, ContactPair};

const FRAMES: usize = 200;

fn hull(body: &ConvexPolyhedron) -> Option<parry::Hull> {
    let (points, faces) = plain(body);
    parry::mesh(&points, &faces)
}

/// Benchmarks depth and manifolds of bodies that rest, slide, turn in contact and pass each other.
fn contacts(c: &mut Criterion) {
    for scene in SCENES {
        let all = shapes(scene);
        let one = all.iter().position(|(_, n)| *n == 128).map_or(0..0, |k| k..k + 1);
        for &(shape, n) in chosen(&all[one], &all) {
            let s = Scene::new(scene, shape, n, FRAMES);
            let mut group = c.benchmark_group(format!("contact/{scene}/{shape}"));
            ours(&mut group, &s, n);
            theirs(&mut group, &s, n);
        }
    }
}

fn ours(group: &mut Group, s: &Scene, n: usize) {
    let poses: Vec<RelativePose> = s
        .poses()
        .iter()
        .map(|(a, b)| RelativePose::new(a, b).expect("a pose"))
        .collect();
    let mut pair = Tracker::new();
    each(group, "ours, depth", n, &poses, |pose| pair.closest(&s.a, &s.b, pose));
    let mut pair = Tracker::new();
    each(group, "ours, local depth", n, &poses, |pose| {
        pair.closest_with_local_depth(&s.a, &s.b, pose)
    });
    let (mut pair, mut manifold) = (Tracker::new(), Manifold::new());
    let options = ManifoldOptions::default().prediction(PREDICTION);
    each(group, "ours, manifold", n, &poses, |pose| {
        pair.manifold(&s.a, &s.b, pose, &options, &mut manifold);
        manifold.points().len()
    });
}

fn theirs(group: &mut Group, s: &Scene, n: usize) {
    let (Some(a), Some(b)) = (hull(&s.a), hull(&s.b)) else {
        return;
    };
    let poses: Vec<_> = s
        .frames
        .iter()
        .map(|f| (parry::pose(&f.a), parry::pose(&f.b)))
        .collect();
    each(group, "parry, contact", n, &poses, |(pa, pb)| {
        parry::contact(&a, pa, &b, pb, PREDICTION)
    });
    let mut kept = ContactPair::default();
    each(group, "parry, manifold", n, &poses, |(pa, pb)| {
        kept.manifold(&a, pa, &b, pb, PREDICTION).len()
    });
}

criterion_group!(name = benches; config = common::criterion(); targets = contacts);
criterion_main!(benches);

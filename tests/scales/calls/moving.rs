//! Casts, and clearances and segments of a planner.

use super::{Scene, bumpy, compound, curved, dented};
use lin_canny::impact::{Tolerance, cast, cast_within, free_until, overlapping_until};
use lin_canny::separation::Separation;
use lin_canny::{PairTracker, Tracker};
use lin_canny_plan::{Cell, Checker, JointMotion, TranslationSpace};
use truth::rng::Rng;

/// Runs every query of a pair of motions.
fn casts(scene: &mut Scene, rng: &mut Rng, what: &str, mut pair: impl Separation) {
    let unit = scene.unit;
    for _ in 0..3 {
        let [p, q] = scene.motions(rng);
        for tolerance in [Tolerance::Distance(1e-4 * unit), Tolerance::Time(1e-4)] {
            let found = cast(&mut pair, &p, &q, 0.0..1.0, tolerance).expect("a finite cast");
            scene.plain(what, (found.queries, found.proofs));
            scene.impact(what, found.impact);
            let found = cast_within(&mut pair, &p, &q, 0.0..1.0, tolerance, 0.2 * unit).expect("a finite cast");
            scene.impact(what, found.impact);
        }
        let free = free_until(&mut pair, &p, &q, 0.0..1.0, 0.1 * unit).expect("a finite motion");
        scene.plain(what, free.until);
        let held = overlapping_until(&pair, &p, &q, 0.0..1.0, 0.1 * unit).expect("a finite motion");
        scene.plain(what, held);
    }
}

pub(super) fn hull_casts(scene: &mut Scene, rng: &mut Rng) {
    let (a, b) = (scene.round(rng, 20), scene.round(rng, 40));
    for _ in 0..3 {
        casts(scene, rng, "hulls", Tracker::new().pair(&a, &b));
    }
}

pub(super) fn shape_casts(scene: &mut Scene, rng: &mut Rng) {
    let shapes = curved(scene);
    for (k, a) in shapes.iter().enumerate() {
        let b = &shapes[(k + rng.below(shapes.len())) % shapes.len()];
        casts(scene, rng, &format!("shape {k}"), PairTracker::new().pair(a, b));
    }
}

pub(super) fn composite_casts(scene: &mut Scene, rng: &mut Rng) {
    let (a, b, mesh) = (compound(scene, rng), dented(scene, rng), dented(scene, rng));
    casts(scene, rng, "meshes", PairTracker::new().pair(&b, &mesh));
    casts(scene, rng, "compound and mesh", PairTracker::new().pair(&a, &mesh));
}

pub(super) fn surface_casts(scene: &mut Scene, rng: &mut Rng) {
    let (a, b) = (bumpy(scene, rng), bumpy(scene, rng));
    let (shapes, body) = (curved(scene), compound(scene, rng));
    casts(scene, rng, "surfaces", PairTracker::new().pair(&a, &b));
    let shape = rng.pick(&shapes).clone();
    casts(scene, rng, "surface and shape", PairTracker::new().pair(&a, &shape));
    casts(scene, rng, "surface and compound", PairTracker::new().pair(&a, &body));
}

/// Returns a robot of one body among a few others, and configurations of it.
fn room(scene: &Scene, rng: &mut Rng) -> (Checker<TranslationSpace>, Vec<[f64; 3]>) {
    let mut cell = Cell::new();
    cell.robot_body("robot", scene.round(rng, 20));
    for k in 0..4 {
        cell.add_obstacle(format!("obstacle {k}"), scene.round(rng, 20), scene.place(rng, 4.0))
            .expect("an obstacle");
    }
    let reach = 4.0 * scene.unit;
    let space = TranslationSpace::new([[-reach, reach]; 3], Default::default(), 1).expect("a space");
    let places = (0..6).map(|_| rng.in_ball().map(|x| 4.0 * x * scene.unit)).collect();
    (Checker::new(space, cell).expect("a checker"), places)
}

pub(super) fn clearances(scene: &mut Scene, rng: &mut Rng) {
    let (mut checker, places) = room(scene, rng);
    for at in places {
        let mut found = checker.nearest(&at, 0.5 * scene.unit).expect("a configuration");
        found.extend(checker.clearance(&at).expect("a configuration"));
        for near in found {
            scene.bounds("clearance", near.lower, near.upper);
            scene.lengths("clearance", [near.distance]);
            scene.plain("clearance", (near.pair, &near.gradient));
        }
    }
}

pub(super) fn segments(scene: &mut Scene, rng: &mut Rng) {
    let (mut checker, places) = room(scene, rng);
    for ends in places.windows(2) {
        scene.plain(
            "free",
            checker
                .is_free(&JointMotion::segment(&ends[0], &ends[1]))
                .expect("a segment"),
        );
        scene.plain(
            "safe",
            checker
                .certify(&JointMotion::segment(&ends[0], &ends[1]))
                .expect("a segment")
                .free_until(),
        );
        let along = checker
            .clearance_along(&JointMotion::segment(&ends[0], &ends[1]), 1e-3)
            .expect("a segment");
        scene.bounds("segment", along.lower, along.upper);
        scene.plain("clearance", (along.t, along.pair));
    }
}

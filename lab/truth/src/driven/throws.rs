//! Bodies thrown at each other: casts, judged by queries at many times before and after.
//!
//! The instrument `soak` uses this module.

use crate::casts::{self, SHAPES, Throw};
use crate::rng::Rng;
use lin_canny::impact::{Certificate, Impact, Tolerance, cast_with_certificates};
use lin_canny::motion::{Motion, Steady};
use lin_canny::separation::Separation;
use lin_canny::{ConvexPolyhedron, Geometry, Mesh, Outcome, PairTracker, RelativePose, Shape, Tracker};

/// Times at which a cast is judged.
const TIMES: u32 = 64;

/// Error of bounds, for bodies of size 1 a few units apart.
const NOISE: f64 = 1e-11;

crate::tally! {
    /// Counts of the results; if a count is zero, its ingredient was not tested.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct Mix {
        /// Casts that hit, miss, start in contact, and others.
        pub casts: [u64; 4],
        /// Casts of two polyhedra, of curved shapes, of meshes.
        pub kinds: [u64; 3],
        /// Certificates with a plane that were judged at sampled times.
        pub planes: u64,
    }
}

/// Plays a throw of two bodies.
///
/// # Errors
/// Returns the first wrong answer.
pub fn play(seed: u64) -> Result<Mix, String> {
    let mut rng = Rng::new(seed);
    let mut mix = Mix::default();
    let mut body = || {
        let (shape, n) = (*rng.pick(&SHAPES), 8 + rng.below(40));
        casts::body(shape, n, &mut rng)
    };
    let bodies = [body(), body()];
    let turn = *rng.pick(&[0.0, 0.3, 3.0, 12.0]);
    let throw = casts::aimed(&mut rng, (1.0, 1.0), turn);
    let tolerance = if rng.chance(0.5) {
        Tolerance::Distance(1e-4)
    } else {
        Tolerance::Time(1e-4)
    };
    let distance = if rng.chance(0.3) { rng.log_range(1e-3, 0.3) } else { 0.0 };
    let kind = rng.below(3);
    mix.kinds[kind] += 1;
    if kind == 0 {
        // Polyhedra have planes, which every vertex proves.
        let mut tracker = Tracker::new();
        let [a, b] = &bodies;
        return judge(
            &mut tracker.pair(a, b),
            &bodies,
            &bodies.clone().map(Geometry::from),
            &throw,
            (tolerance, distance),
            mix,
        );
    }
    let mut other = |body: &ConvexPolyhedron| -> Result<Geometry, String> {
        let told = |e: &dyn std::fmt::Display| e.to_string();
        Ok(match (kind, rng.below(3)) {
            (1, 0) => Shape::cylinder(0.6, 0.5).map_err(|e| told(&e))?.into(),
            (1, _) => Shape::from(body.clone()).rounded(0.1).map_err(|e| told(&e))?.into(),
            _ => Mesh::from_convex(body).map_err(|e| told(&e))?.into(),
        })
    };
    let geometries = [other(&bodies[0])?, other(&bodies[1])?];
    let mut tracker = PairTracker::new();
    let [a, b] = &geometries;
    judge(
        &mut tracker.pair(a, b),
        &bodies,
        &geometries,
        &throw,
        (tolerance, distance),
        mix,
    )
}

/// Measures the bodies at a time with a new tracker.
fn at(geometries: &[Geometry; 2], motions: &[Steady; 2], time: f64) -> Result<Outcome, String> {
    let pose = RelativePose::new(&motions[0].pose(time), &motions[1].pose(time)).map_err(|e| e.to_string())?;
    Ok(PairTracker::new()
        .closest(&geometries[0], &geometries[1], &pose)
        .outcome)
}

fn judge(
    pair: &mut impl Separation,
    bodies: &[ConvexPolyhedron; 2],
    geometries: &[Geometry; 2],
    throw: &Throw,
    (tolerance, distance): (Tolerance, f64),
    mut mix: Mix,
) -> Result<Mix, String> {
    let motions = throw.motions();
    let mut proofs = Vec::new();
    let found = cast_with_certificates(
        pair,
        &motions[0],
        &motions[1],
        0.0..1.0,
        tolerance,
        distance,
        &mut proofs,
    );
    let found = found.map_err(|e| e.to_string())?;
    let wrong = |what: &str| Err(format!("{what}: {found:?}, within {distance}, {throw:?}"));
    let (safe, which) = match found.impact {
        Impact::Hit { safe, hit, .. } => {
            if at(geometries, &motions, hit)?.lower > distance + NOISE {
                return wrong("apart at the hit");
            }
            (safe, 0)
        }
        Impact::Miss => (1.0, 1),
        Impact::AtStart { .. } => {
            if at(geometries, &motions, 0.0)?.lower > distance + NOISE {
                return wrong("apart at the start");
            }
            mix.casts[2] += 1;
            return Ok(mix);
        }
        Impact::Undecided { safe, .. } | Impact::Incomplete { safe } => (safe, 3),
        _ => return wrong("an unknown result"),
    };
    mix.casts[which] += 1;
    for k in 0..=TIMES {
        let time = safe * f64::from(k) / f64::from(TIMES);
        let seen = at(geometries, &motions, time)?;
        if seen.upper < distance - NOISE {
            return wrong(&format!("{} apart at {time}", seen.upper));
        }
    }
    // Certificates follow one another, and every vertex is on its side of the plane.
    let mut until = 0.0;
    for proof in &proofs {
        if proof.from > until {
            return wrong(&format!("no certificate from {until} to {}", proof.from));
        }
        until = proof.until;
        mix.planes += u64::from(proof.normal(proof.from).is_some());
        if geometries.iter().all(|g| g.as_polyhedron().is_some()) {
            sides(proof, bodies, &motions, distance).or_else(|what| wrong(&what).map(|_: Mix| ()))?;
        }
    }
    if which < 2 && until < safe {
        wrong("certificates end early")
    } else {
        Ok(mix)
    }
}

fn sides(
    proof: &Certificate,
    bodies: &[ConvexPolyhedron; 2],
    motions: &[Steady; 2],
    distance: f64,
) -> Result<(), String> {
    for k in 0..=4 {
        let time = proof.from + (proof.until - proof.from) * f64::from(k) / 4.0;
        let Some(normal) = proof.normal(time) else {
            return Ok(());
        };
        let heights = |of: usize| {
            let pose = motions[of].pose(time);
            bodies[of].vertex_points().map(move |p| normal.dot(&(pose * p).coords))
        };
        let high = heights(0).fold(f64::NEG_INFINITY, f64::max);
        let low = heights(1).fold(f64::INFINITY, f64::min);
        if low - high < distance - NOISE {
            return Err(format!("the plane of {proof:?} leaves {} at {time}", low - high));
        }
    }
    Ok(())
}

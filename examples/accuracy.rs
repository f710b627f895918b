//! Cost of accuracy: every level of accuracy answers the same frames of two hulls of 128 vertices.
//!
//! The pair rotates by half a degree per frame. Run `cargo run --release --example accuracy`; a
//! debug build checks every answer and shows longer times.

use std::time::Instant;

use lin_canny::nalgebra::{Isometry3, UnitQuaternion, Vector3};
use lin_canny::{RelativePose, Tracker, polyhedron::solids};

/// A distance, and the width of its bounds; the width is infinite for a level without bounds.
type Answer = (f64, f64);

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let a = solids::random_hull(128, Vector3::repeat(1.0), 1)?;
    let b = solids::random_hull(128, Vector3::new(1.0, 0.7, 0.5), 2)?;
    let axis = Vector3::new(0.3, 0.5, 0.8).normalize();
    let pose = |frame: u32| {
        let turn = UnitQuaternion::from_scaled_axis(axis * 0.5_f64.to_radians() * f64::from(frame));
        let away = 2.02 + 0.3 * (f64::from(frame) * 0.01).sin().powi(2);
        RelativePose::from_isometry(&Isometry3::from_parts(Vector3::new(away, 0.1, 0.0).into(), turn))
    };
    // The pair rotates by half a degree per frame while it approaches and recedes.
    let poses = (0..10_000).map(pose).collect::<Result<Vec<_>, _>>()?;
    let bounded = |o: lin_canny::Outcome| (o.distance, o.upper - o.lower);
    type Ask<'a> = &'a dyn Fn(&mut Tracker, &RelativePose) -> Answer;
    let levels: [(&str, Ask); 4] = [
        ("walk alone, nothing proven (propose)", &|t, p| {
            (t.propose(&a, &b, p).distance.unwrap_or(0.0), f64::INFINITY)
        }),
        ("proven bounds (closest)", &|t, p| bounded(t.closest(&a, &b, p))),
        ("the same without the last frame", &|_, p| {
            bounded(Tracker::new().closest(&a, &b, p))
        }),
        ("to the last bit (closest_exact)", &|t, p| {
            bounded(t.closest_exact(&a, &b, p))
        }),
    ];
    let mut exact = Tracker::new();
    let truth: Vec<f64> = poses.iter().map(|p| exact.closest_exact(&a, &b, p).distance).collect();
    println!(
        "{:<38}{:>10}{:>16}{:>16}",
        "level", "ns/query", "bounds, width", "largest error"
    );
    for (name, ask) in levels {
        let mut tracker = Tracker::new();
        let began = Instant::now();
        let answers: Vec<Answer> = poses.iter().map(|p| ask(&mut tracker, p)).collect();
        let each = began.elapsed().as_nanos() as f64 / poses.len() as f64;
        let errors = answers.iter().zip(&truth).map(|(a, t)| (a.0 - t).abs());
        let error = errors.fold(0.0, f64::max);
        let width = answers.iter().map(|a| a.1).fold(0.0, f64::max);
        println!("{name:<38}{each:>10.0}{width:>16.1e}{error:>16.1e}");
    }
    Ok(())
}

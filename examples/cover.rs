//! Balls around a body and inside it, for programs that know only balls: what they decide is
//! proven.

use lin_canny::cover::{Ball, CoverGoal, cover_inside, cover_outside};
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::{ConvexPolyhedron, PairTracker, RelativePose, Shape};

/// What balls say of a ball-shaped obstacle.
fn verdict(outside: &[Ball], inside: &[Ball], at: &Point3<f64>, radius: f64) -> &'static str {
    let meets = |ball: &Ball| (ball.center - at).norm() <= ball.radius + radius;
    if !outside.iter().any(meets) {
        "free"
    } else if inside.iter().any(meets) {
        "contact"
    } else {
        "open"
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A link of a robot: two eyes and the web between them.
    let eye = |x: f64, r: f64| {
        (0..12).flat_map(move |k| {
            let a = f64::from(k) * std::f64::consts::TAU / 12.0;
            [-0.05, 0.05].map(|z| Point3::new(x + r * a.cos(), r * a.sin(), z))
        })
    };
    let points: Vec<_> = eye(0.0, 0.1).chain(eye(0.5, 0.06)).collect();
    let link = ConvexPolyhedron::from_points(&points)?;

    for count in [1, 4, 16, 64] {
        let outside = cover_outside(&link, CoverGoal::Balls(count))?;
        let inside = cover_inside(&link, count)?;
        println!(
            "{count:>2} balls: those outside stick out by at most {:.3}, those inside leave out at most {:.3}",
            outside.gap, inside.gap
        );
    }

    // An obstacle that comes nearer: exact queries are needed only where the balls leave it open.
    let outside = cover_outside(&link, CoverGoal::Gap(0.03))?;
    let inside = cover_inside(&link, 16)?;
    println!("{} balls stick out by at most {:.3}", outside.balls.len(), outside.gap);
    let (radius, mut tracker) = (0.05, PairTracker::new());
    let obstacle = Shape::ball(radius)?;
    for step in 0..8 {
        let at = Point3::new(0.25, 0.30 - 0.03 * f64::from(step), 0.0);
        let pose = RelativePose::from_isometry(&Isometry3::from(Vector3::from(at.coords)))?;
        let by_balls = verdict(&outside.balls, &inside.balls, &at, radius);
        let by_link = if tracker.intersects(&link, &obstacle, &pose) {
            "contact"
        } else {
            "free"
        };
        println!("at {:.2}: {by_balls:<7} by balls, {by_link} by the link itself", at.y);
        assert!(by_balls == "open" || by_balls == by_link);
    }
    Ok(())
}

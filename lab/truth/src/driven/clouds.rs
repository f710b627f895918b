//! Clouds and bodies of every kind, in motion; judged element by element.
//!
//! The instrument `soak` uses this module.

use crate::casts::rotation;
use crate::pose::off_unit;
use crate::rng::Rng;
use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{
    Cloud, CloudElement, ContactState, ConvexPolyhedron, Geometry, Mesh, PairTracker, RelativePose, Shape,
};

/// Frames of a motion.
const FRAMES: usize = 8;

/// Error of the bounds, in units of the size of the pair.
const NOISE: f64 = 1.5e-13;

crate::tally! {
    /// Counts of the results; if a count is zero, its ingredient was not tested.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct Mix {
        /// Frames with the bodies apart, and in contact.
        pub frames: [u64; 2],
        /// Clouds of points, of balls, of boxes, of hulls.
        pub elements: [u64; 4],
    }
}

fn vector(rng: &mut Rng, most: f64) -> Vector3<f64> {
    Vector3::from_fn(|_, _| rng.range(-most, most))
}

/// Plays a cloud and a body.
///
/// # Errors
/// Returns the first wrong answer.
pub fn play(seed: u64) -> Result<Mix, String> {
    let told = |e: &dyn std::fmt::Display| e.to_string();
    let mut rng = Rng::new(seed);
    let mut mix = Mix::default();
    let count = *rng.pick(&[1, 15, 16, 17, 80, 300]);
    let lattice = rng.chance(0.3);
    let mut points: Vec<Point3<f64>> = (0..count)
        .map(|_| {
            let p = vector(&mut rng, 1.0);
            Point3::from(if lattice { p.map(|x| (x * 4.0).round() / 4.0) } else { p })
        })
        .collect();
    // Sensors write equal points for what they do not see.
    if rng.chance(0.2) {
        let half = points.len() / 2;
        points.copy_within(..half, half);
    }
    let radius = rng.range(0.01, 0.1);
    let which = rng.below(4);
    mix.elements[which] += 1;
    let (element, shape) = match which {
        0 => {
            let point = ConvexPolyhedron::point(Point3::origin()).map_err(|e| told(&e))?;
            (CloudElement::Ball(0.0), Shape::from(point))
        }
        1 => (CloudElement::Ball(radius), Shape::ball(radius).map_err(|e| told(&e))?),
        2 => {
            let half = Vector3::new(radius, 0.5 * radius, 2.0 * radius);
            (CloudElement::Box(half), Shape::cuboid(half).map_err(|e| told(&e))?)
        }
        _ => {
            let hull = solids::random_hull(9, Vector3::repeat(radius), seed).map_err(|e| told(&e))?;
            (CloudElement::Shape(Shape::from(hull.clone())), Shape::from(hull))
        }
    };
    let cloud = Geometry::from(Cloud::new(&points, element).map_err(|e| told(&e))?);
    let hull = solids::random_hull(20, Vector3::new(0.8, 0.6, 0.4), seed).map_err(|e| told(&e))?;
    let body: Geometry = match rng.below(4) {
        0 => Mesh::from_convex(&hull).map_err(|e| told(&e))?.into(),
        1 => Shape::cylinder(0.5, 0.4).map_err(|e| told(&e))?.into(),
        2 => Shape::from(hull).rounded(0.1).map_err(|e| told(&e))?.into(),
        _ => hull.into(),
    };
    let (mut at, step) = (vector(&mut rng, 2.5), vector(&mut rng, 0.2));
    let (mut turn, small) = (rotation(&mut rng), UnitQuaternion::new(vector(&mut rng, 0.1)));
    let [.., long] = off_unit([0.0, 0.0, 0.0, 1.0], &mut rng);
    let (mut warm, mut back) = (PairTracker::new(), PairTracker::new());
    for frame in 0..FRAMES {
        at += step;
        turn = small * turn;
        let turn = UnitQuaternion::new_unchecked(turn.into_inner() * long);
        let pose = RelativePose::from_isometry(&Isometry3::from_parts(at.into(), turn)).map_err(|e| told(&e))?;
        let (mut lower, mut upper, mut overlaps) = (f64::INFINITY, f64::INFINITY, false);
        for p in &points {
            let from_point = Isometry3::from_parts((at - p.coords).into(), turn);
            let one = RelativePose::from_isometry(&from_point).map_err(|e| told(&e))?;
            let one = PairTracker::new().closest(&shape, &body, &one);
            overlaps |= one.state == ContactState::Overlapping;
            (lower, upper) = (lower.min(one.lower.max(0.0)), upper.min(one.upper.max(0.0)));
        }
        let noise = NOISE * (5.0 + at.norm());
        let answers = [
            warm.closest(&cloud, &body, &pose),
            back.closest(&body, &cloud, &pose.swapped()),
            PairTracker::new().closest(&cloud, &body, &pose),
        ];
        for found in answers {
            let is_right = found.lower.max(0.0) <= upper + noise
                && found.upper.max(0.0) >= lower - noise
                && (lower <= noise || found.state == ContactState::Separated)
                && (!overlaps || found.state != ContactState::Separated || upper <= noise);
            if !is_right {
                return Err(format!(
                    "frame {frame}: {lower:e}..{upper:e}, overlap {overlaps}: {found:?}"
                ));
            }
        }
        for d in [0.0, 0.5 * upper, 2.0 * upper + 0.01] {
            let within = warm.within(&cloud, &body, &pose, d);
            let cold = PairTracker::new().within(&cloud, &body, &pose, d);
            let is_right = |answer: bool| {
                if upper < d - noise {
                    answer
                } else {
                    !answer || lower <= d + noise
                }
            };
            if !is_right(within) || !is_right(cold) {
                return Err(format!(
                    "frame {frame}: within {d:e} {within} {cold}, {lower:e}..{upper:e}"
                ));
            }
        }
        mix.frames[usize::from(upper == 0.0)] += 1;
    }
    Ok(mix)
}

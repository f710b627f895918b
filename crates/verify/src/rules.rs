//! What a claim requires of a scene, of its legs and of the kinds of lines.
//!
//! The rules are checked three times if a receipt is evaluated on another scene: for each of the two
//! files alone, and for the claim of the receipt about the other scene. No claim is evaluated on a
//! scene that breaks one of them. What a line says of its bodies is checked on the scene that is
//! evaluated.

use crate::Stop;
use crate::file::Head;
use crate::real::Real;
use crate::scene::{Leg, Motion, Scene};

fn is_steady(scene: &Scene) -> bool {
    scene.bodies.iter().any(|body| matches!(body.motion, Motion::Steady(_)))
}

/// Checks that a scene is whole, and that the claim can be about it.
pub(crate) fn of_scene(head: &Head, scene: &Scene) -> Result<(), Stop> {
    if scene.bodies.is_empty() || scene.base.is_some() && scene.joints.is_empty() {
        return Stop::bad("the scene has no body, or a base without joints");
    }
    let Head::Range(cells) = head else { return Ok(()) };
    if cells.range.len() < scene.coordinates {
        return Stop::bad("a range of each coordinate is expected");
    }
    if is_steady(scene) {
        return Stop::bad("a body that is steady, in a claim about configurations");
    }
    Ok(())
}

/// Checks that a leg drives the joints, starts where the one before ends, and lasts as the claim says.
pub(crate) fn of_leg(head: &Head, scene: &Scene, before: Option<&Leg>, leg: &Leg) -> Result<(), Stop> {
    if matches!(head, Head::Range(_)) {
        return Stop::bad("a leg in a claim about configurations");
    }
    if scene.coordinates == 0 || leg.0[0].len() < scene.coordinates {
        return Stop::bad("a leg without a coordinate for each joint, or without joints");
    }
    if let Head::Apart(apart) = head {
        let (from, until) = (apart.span.from, apart.span.until);
        let whole = from == Real::ZERO && until == Real::ONE;
        if from < Real::ZERO || until > Real::ONE || before.is_some() && !whole {
            return Stop::bad("the interval is not within a leg, or not all of each of several");
        }
    }
    let Some(before) = before else { return Ok(()) };
    if before.0.last() != leg.0.first() {
        return Stop::bad("a leg does not start where the one before ends");
    }
    // Its time would start again with the leg, and the body would jump back.
    if is_steady(scene) {
        return Stop::bad("several legs, and a body that is steady");
    }
    Ok(())
}

/// Checks that a claim has this kind of evidence, after so many legs.
pub(crate) fn of_line(head: &Head, scene: &Scene, legs: usize, kind: &str) -> Result<(), Stop> {
    let is_range = matches!(head, Head::Range(_));
    if matches!(head, Head::Scene) {
        return Stop::bad("evidence in a scene");
    }
    if is_range != (kind == "cell") {
        return Stop::bad("a claim about a range has cells alone, and no other claim has cells");
    }
    if scene.coordinates > 0 && legs == 0 && !is_range {
        return Stop::bad("evidence before the first leg");
    }
    if ["plane", "balls", "outside"].contains(&kind) && !matches!(head, Head::Apart(_)) {
        return Stop::bad("this claim is of single lines");
    }
    Ok(())
}

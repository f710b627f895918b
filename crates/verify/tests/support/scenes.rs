//! Another scene for a receipt, and whether the statement of the receipt is false there.

use super::parted::{Gapped, Parted};
use super::ranged::{Ranged, small_ranged};
use super::*;

/// The head of a scene alone.
pub(crate) const SCENE: &str = "{\"receipt\":1,\"claim\":\"scene\"}";

/// A receipt, another scene, and how to refute the statement of the receipt about that scene.
pub(crate) struct OnScene {
    pub(crate) change: &'static str,
    pub(crate) receipt: String,
    pub(crate) scene: String,
    refute: Box<dyn Fn(&mut Rng) -> bool>,
}

impl OnScene {
    /// Whether samples refute the statement.
    pub(crate) fn is_false(&self, rng: &mut Rng) -> bool {
        (self.refute)(rng)
    }

    pub(crate) fn random(rng: &mut Rng) -> Self {
        match rng.below(9) {
            0 => Self::of(overlap(rng), rng),
            1 => Self::of(above(rng), rng),
            2 => Self::of(cast(rng, 0.01), rng),
            3 => Self::of(hit(rng), rng),
            4 => Self::of(lever(rng, 0.01, 1, 1), rng),
            5 => Self::of(lever(rng, 0.01, 2, 1), rng),
            6 => Self::of_range(small_ranged(rng, 1), rng),
            7 => Self::of_parts(rng),
            _ => Self::of_distance(rng),
        }
    }

    fn of(mut receipt: Receipt, rng: &mut Rng) -> Self {
        let (change, mut other) = changed(&receipt, rng);
        let is_scene = rng.below(2) == 0;
        let scene = text(&other, is_scene.then_some(SCENE));
        // The file of the receipt breaks a rule that the other one keeps.
        if rng.below(8) == 0 {
            let mut own = changed(&receipt, rng).1;
            (own.ignored, own.apart) = (receipt.ignored, receipt.apart);
            receipt = own;
        }
        let text = receipt.text();
        // The claim, ignored pairs and evidence of the receipt, on bodies and legs of the scene.
        let mut legs: Vec<Line> = other.evidence.drain(..).filter(|x| matches!(x, Line::Leg(_))).collect();
        legs.reverse();
        let of_scene = |line: Line| match line {
            Line::Leg(_) => legs.pop(),
            line => Some(line),
        };
        other.evidence = receipt.evidence.into_iter().filter_map(of_scene).collect();
        (other.ignored, other.apart) = (receipt.ignored, receipt.apart);
        Self {
            change,
            receipt: text,
            scene,
            refute: Box::new(move |_| other.is_false()),
        }
    }

    fn of_range(ranged: Ranged, rng: &mut Rng) -> Self {
        let receipt = ranged.text();
        let (change, other) = changed(&ranged.arm, rng);
        let mut on_other = Ranged { arm: other, ..ranged };
        let scene = match rng.below(2) {
            0 => text(&on_other.arm, Some(SCENE)),
            _ => on_other.text(),
        };
        on_other.arm.ignored = ranged.arm.ignored;
        Self {
            change,
            receipt,
            scene,
            refute: Box::new(move |rng| on_other.is_false_anywhere(rng)),
        }
    }

    fn of_parts(rng: &mut Rng) -> Self {
        let (own, way) = (Parted::random(rng), rng.below(3));
        let mut other = own.clone();
        other.change(rng, [0, 5, 6][way]);
        let mut scene = other.all_lines();
        scene.truncate(3);
        scene[0] = SCENE.into();
        Self {
            change: ["a point of a part", "the frame moved", "a rod that flies aside"][way],
            receipt: own.text(),
            scene: sealed(&scene),
            refute: Box::new(move |_| other.nearest() < 1e-6),
        }
    }

    fn of_distance(rng: &mut Rng) -> Self {
        let (own, way) = (Gapped::random(rng), rng.below(2));
        let mut other = own.clone();
        other.change(rng, [0, 7][way]);
        Self {
            change: ["a point of a part", "the frame moved"][way],
            receipt: own.text(),
            scene: other.text(),
            refute: Box::new(move |_| other.is_false()),
        }
    }
}

/// The text of a receipt, or of its scene and legs with another head.
pub(crate) fn text(receipt: &Receipt, head: Option<&str>) -> String {
    let Some(head) = head else { return receipt.text() };
    let mut scene = receipt.clone();
    scene.evidence.retain(|line| matches!(line, Line::Leg(_)));
    let mut lines = scene.lines();
    lines[0] = head.into();
    sealed(&lines)
}

/// The motion of a body that flies off from where it is.
pub(crate) fn flying(from: &Move, linear: V) -> Move {
    match from {
        Move::Rest(pose) | Move::Link(_, Some(pose)) | Move::Steady(pose, _) => {
            Move::Steady(*pose, [[0.0; 3], linear, [0.0; 3], [0.0; 3]])
        }
        Move::Link(..) => flying(&Move::Rest(REST), linear),
    }
}

/// Changes one thing of bodies, joints or legs, of any kind.
fn changed(receipt: &Receipt, rng: &mut Rng) -> (&'static str, Receipt) {
    const CHANGES: [&str; 16] = [
        "nothing",
        "a body moved a little",
        "a body moved",
        "a body of another size",
        "a radius",
        "a body that flies",
        "a body on a link",
        "a body at rest",
        "another kind of joint",
        "another coordinate",
        "another axis",
        "another parent",
        "a joint more",
        "another base",
        "a leg less or more",
        "another leg",
    ];
    let (kind, mut other) = (CHANGES[rng.below(CHANGES.len())], receipt.clone());
    let (body, links) = (rng.below(other.bodies.len()), other.joints.len());
    let joint = rng.below(links.max(1));
    let legs: Vec<usize> = (0..other.evidence.len())
        .filter(|k| matches!(other.evidence[*k], Line::Leg(_)))
        .collect();
    match kind {
        "a body moved a little" | "a body moved" => {
            let shift = rng.vector(if kind == "a body moved" { 1.0 } else { 1e-3 });
            match &mut other.bodies[body].motion {
                Move::Rest(pose) | Move::Link(_, Some(pose)) | Move::Steady(pose, _) => {
                    (0..3).for_each(|k| pose[k] += shift[k]);
                }
                Move::Link(..) => {}
            }
        }
        "a body of another size" => {
            let factor = rng.range(0.5, 2.0);
            other.bodies[body]
                .points
                .iter_mut()
                .flatten()
                .for_each(|x| *x *= factor);
        }
        "a radius" => other.bodies[body].radius = rng.range(0.0, 0.25),
        "a body that flies" => {
            let far = [0.0, 0.01, 1.0][rng.below(3)];
            other.bodies[body].motion = flying(&other.bodies[body].motion, rng.vector(far));
        }
        "a body on a link" => {
            let pose = (rng.below(2) == 0).then(|| rng.pose(1.0));
            other.bodies[body].motion = Move::Link(rng.below(links + 1), pose);
        }
        "a body at rest" => other.bodies[body].motion = Move::Rest(rng.pose(1.0)),
        "another kind of joint" if links > 0 => {
            other.joints[joint].kind = ["turn", "slide", "fixed"][rng.below(3)];
        }
        "another coordinate" if links > 0 => {
            let (c, factor, offset) = &mut other.joints[joint].drive;
            match rng.below(3) {
                0 => *c = rng.below(4),
                1 => *factor = rng.range(-2.0, 2.0),
                _ => *offset += rng.range(-0.2, 0.2),
            }
        }
        "another axis" if links > 0 => other.joints[joint].axis = rng.vector(1.0),
        "another parent" if links > 0 => other.joints[joint].parent = rng.below(joint + 1),
        "a joint more" => {
            other.joints.push(Joint::new(
                rng.below(links + 1),
                ["turn", "slide", "fixed"][rng.below(3)],
                REST,
                [0.0, 0.0, 1.0],
                (rng.below(3), 1.0, 0.0),
            ));
            if rng.below(2) == 0 {
                other.bodies[body].motion = Move::Link(links + 1, None);
            }
        }
        "another base" => other.base = (rng.below(3) > 0).then(|| rng.pose(0.1)),
        "a leg less or more" => match (legs.last(), rng.below(2)) {
            (Some(last), 0) => drop(other.evidence.remove(*last)),
            (Some(last), _) => {
                let Line::Leg(rows) = &other.evidence[*last] else {
                    unreachable!()
                };
                let end = rows[rows.len() - 1].clone();
                other.evidence.push(Line::Leg(vec![end.clone(), end]));
            }
            (None, _) => other.evidence.insert(0, Line::Leg(vec![vec![0.0; 2], vec![0.1; 2]])),
        },
        "another leg" if !legs.is_empty() => {
            let Line::Leg(rows) = &mut other.evidence[legs[rng.below(legs.len())]] else {
                unreachable!()
            };
            let (size, last) = ([1e-6, 0.1, 2.0][rng.below(3)], rows.len() - 1);
            match rng.below(4) {
                0 => rows.iter_mut().for_each(|row| row.truncate(row.len() - 1)),
                1 => rows.iter_mut().for_each(|row| row.push(0.0)),
                // The first or only leg may start elsewhere.
                2 => rows[0][0] += rng.range(-size, size),
                _ => rows[last][0] += rng.range(-size, size),
            }
        }
        "nothing" => {}
        // A receipt without joints or legs.
        _ => return changed(receipt, rng),
    }
    (kind, other)
}

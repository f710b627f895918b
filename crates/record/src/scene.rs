//! Records a step of a scene as a frame.

use std::io::Write;

use lin_canny::BoxHint;
use lin_canny::nalgebra::Isometry3;
use lin_canny::scene::{BodyId, PairResults, Scene};

use crate::format::Contact;
use crate::write::{Recorder, WriteError};

impl<W: Write> Recorder<W> {
    /// Writes the last step of a scene as a frame.
    ///
    /// The frame holds new and removed bodies, poses, the boxes of the bodies, and the outcomes and
    /// contacts of all pairs. The name of a body is its user data, as a number.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub fn scene(&mut self, scene: &Scene) -> Result<(), WriteError> {
        self.scene_bodies(scene)?;
        for pair in scene.pairs() {
            let (Some(&a), Some(&b)) = (self.of_scene.get(&pair.a), self.of_scene.get(&pair.b)) else {
                continue;
            };
            let (Some(pose_a), Some(pose_b)) = (scene.pose(pair.a), scene.pose(pair.b)) else {
                continue;
            };
            let contacts = contacts(&pair, pose_a, pose_b);
            if let Some(outcome) = pair.outcome {
                let pieces = pair.subshapes.unwrap_or_default();
                let line = self.pair(a, b)?;
                line.outcome = Some(*outcome);
                line.subshapes = pieces;
                line.contacts = contacts;
            } else if !contacts.is_empty() {
                self.pair(a, b)?.contacts = contacts;
            }
        }
        self.end_frame()
    }

    fn scene_bodies(&mut self, scene: &Scene) -> Result<(), WriteError> {
        let removed: Vec<BodyId> = self
            .of_scene
            .keys()
            .copied()
            .filter(|&id| scene.pose(id).is_none())
            .collect();
        for id in removed {
            if let Some(body) = self.of_scene.remove(&id) {
                self.remove(body)?;
            }
        }
        for id in scene.bodies() {
            let (Some(pose), Some(shape)) = (scene.pose(id), scene.geometry(id)) else {
                continue;
            };
            match self.of_scene.get(&id) {
                Some(&body) => self.pose(body, pose)?,
                None => {
                    let name = scene.user_data(id).unwrap_or_default().to_string();
                    let body = self.body(&name, shape, pose)?;
                    self.of_scene.insert(id, body);
                }
            }
            let (min, max) = shape.aabb_at(pose, &mut BoxHint::default());
            self.aabb(min, max);
        }
        Ok(())
    }
}

/// Returns the contacts of a pair in the world.
fn contacts(pair: &PairResults<'_>, pose_a: &Isometry3<f64>, pose_b: &Isometry3<f64>) -> Vec<Contact> {
    let convex = pair.manifold.into_iter().flat_map(|manifold| {
        let normal = manifold.normal();
        manifold
            .points()
            .iter()
            .map(move |point| (point, normal, point.id.to_string()))
    });
    let others = pair.contacts.into_iter().flatten().flat_map(|group| {
        group.contacts.iter().map(|c| {
            let name = format!("{}/{} {}", c.patches[0], c.patches[1], c.point.id);
            (&c.point, c.normal, name)
        })
    });
    let all = convex.chain(others);
    all.map(|(point, normal, name)| Contact {
        name,
        on_a: pose_a * point.point_on_a,
        on_b: pose_b * point.point_on_b,
        normal: pose_a * normal.into_inner(),
        separation: point.separation,
    })
    .collect()
}

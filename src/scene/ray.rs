//! Ray casts at the bodies of a scene.

use alloc::vec::Vec;

use nalgebra::Point3;

use super::body::BodyTable;
use super::effects::GROUPS;
use super::{BodyId, Scene, SceneError};
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::tolerance::RAY;
use crate::broad::{Aabb, BroadPhase};
use crate::pair_tracker::ray::{Ray, RayCast, RayCaster, placed_ball};

impl Scene {
    /// Returns the first body that a ray meets up to a length, which may be infinite, and where;
    /// among bodies at which the ray enters equally early the one of the lowest index. Only bodies
    /// for which `may_hit` returns true count.
    ///
    /// A body counts where it is, whether or not an effect is called for. The answer for a body is
    /// that of [`RayCaster::cast`]. Bodies of groups without any effect have a box of where they
    /// were inserted; those that have moved since are each tested by a ball, in some 10 ns.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
    /// use lin_canny::scene::{Body, Scene};
    /// use lin_canny::{Ray, RayCast, Shape};
    ///
    /// let mut scene = Scene::new();
    /// let ball = Shape::ball(0.5)?;
    /// let at = |x: f64| Isometry3::translation(x, 0.0, 0.0);
    /// scene.insert(Body::moving(ball.clone()), at(3.0))?;
    /// let near = scene.insert(Body::moving(ball), at(1.5))?;
    /// scene.step();
    /// let ray = Ray::new(Point3::origin(), Vector3::x())?;
    /// let (body, found) = scene.cast_ray(&ray, 10.0, |_| true)?.expect("a body");
    /// let RayCast::Hit(hit) = found else { panic!("{found:?}") };
    /// assert!(body == near && (hit.hit - 1.0).abs() < 1e-11);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// If a step is due, or the length or the ray is refused.
    #[doc(alias = "raycast")]
    pub fn cast_ray(
        &self,
        ray: &Ray,
        length: f64,
        mut may_hit: impl FnMut(BodyId) -> bool,
    ) -> Result<Option<(BodyId, RayCast)>, SceneError> {
        if self.is_due() {
            return Err(SceneError::StepDue);
        }
        ray.flight(length)?;
        let mut met = Vec::new();
        self.broad.overlapping(&box_of(ray, length), &mut met)?;
        let stale = &self.bodies.stale;
        let boxed = met.iter().map(|proxy| self.bodies.body_of_proxy[proxy.index as usize]);
        let boxed = boxed.filter(|k| stale.binary_search(k).is_err());
        let bodies = boxed.chain(stale.iter().copied());
        let mut candidates: Vec<(f64, u32)> = bodies
            .filter_map(|k| {
                let shape = &self.bodies.solids[k as usize].as_ref()?.shape;
                let ball = placed_ball(shape.bounding_ball(), &self.bodies.poses[k as usize]);
                Some((ray.within_ball(ball, length)?.0, k))
            })
            .collect();
        candidates.sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        let mut caster = RayCaster::new();
        let mut first: Option<(f64, BodyId, RayCast)> = None;
        for (from, k) in candidates {
            // No later body is met earlier.
            if first.as_ref().is_some_and(|f| from > f.0) {
                break;
            }
            let id = self.bodies.id(k);
            let Some(solid) = self.bodies.solids[k as usize].as_ref().filter(|_| may_hit(id)) else {
                continue;
            };
            let found = caster.cast(&solid.shape, &self.bodies.poses[k as usize], ray, length)?;
            let Some(at) = found.safe() else { continue };
            let is_first = first.as_ref().is_none_or(|f| at < f.0 || at == f.0 && id < f.1);
            if is_first {
                first = Some((at, id, found));
            }
        }
        Ok(first.map(|(_, id, found)| (id, found)))
    }
}

/// Returns a box about a ray up to a length; of a length or a ray that is no number, a box that is
/// refused.
fn box_of(ray: &Ray, length: f64) -> Aabb {
    let way = |d: f64| if d == 0.0 { 0.0 } else { d * length };
    let end = Point3::from(ray.origin.coords + ray.direction.map(way));
    let low = ray.origin.smaller(end);
    let high = ray.origin.larger(end);
    Aabb::new(low, high).grown(RAY * (ray.origin.coords.abs().sum() + length.at_most(1e37)))
}

impl BodyTable {
    /// Lists the bodies that are due and get no box, as no effect needs one, and forgets those that
    /// were removed or get a box. `partners` are the groups to pair with by group, as bits.
    pub(super) fn list_stale(&mut self, partners: &[u32; GROUPS]) {
        let Self {
            slots,
            solids,
            due,
            stale,
            ..
        } = self;
        let is_without = |i: u32| {
            let solid = solids[i as usize].as_ref().filter(|_| slots.lives(i));
            solid.is_some_and(|s| s.boxed && partners[s.group.index()] == 0)
        };
        stale.retain(|&i| is_without(i));
        stale.extend(due.iter().copied().filter(|&i| is_without(i)));
        stale.sort_unstable();
        stale.dedup();
    }
}

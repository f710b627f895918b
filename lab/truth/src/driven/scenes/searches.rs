//! Comparison of searches and rays with queries of each pair and each body alone.

use super::{Keys, NONE, World, group};
use crate::forms;
use crate::rng::Rng;
use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::scene::{BodyId, Scene};
use lin_canny::{ContactState, Ray, RayCaster, RelativePose};

/// If a ray enters two bodies within this distance of each other, either is accepted.
const TIE: f64 = 1e-6;

impl<C: Fn(&Scene) -> Scene> World<C> {
    /// Judges rays and near pairs of all scenes when no step is due.
    pub(super) fn judge_searches(&mut self) {
        let mut rng = Rng::of_case(self.mix.steps, self.mix.ticks[0]);
        for _ in 0..2 {
            self.judge_ray(&mut rng);
        }
        if self.mix.steps.is_multiple_of(4) {
            for (g, h) in [(0, 0), (0, 1), (1, 1)] {
                self.judge_groups(g, h);
            }
            self.judge_nearest(&mut rng);
        }
    }

    /// Returns whether no query is enabled between the group of a body and any group.
    fn is_without(&self, id: BodyId) -> bool {
        let of = self.main().group(id).expect("the body lives");
        (0..3).all(|g| self.main().queries(of, group(g)) == NONE)
    }

    /// Casts a ray at a body or in a random direction, and compares the first body with casts at
    /// each body alone.
    fn judge_ray(&mut self, rng: &mut Rng) {
        let ids: Vec<BodyId> = self.bodies.keys().copied().collect();
        let Some(&target) = ids.get(rng.below(ids.len().max(1))) else {
            return;
        };
        let aim = self.main().pose(target).expect("the body lives").translation.vector;
        let away = Vector3::from(rng.unit()) * rng.range(0.0, 6.0);
        let towards = aim + Vector3::from(rng.in_ball()) * 0.5;
        // Thrown bodies are soon so far away that nothing else is near.
        let origin = if aim.norm() < 1e3 { away } else { aim + away };
        let Ok(ray) = Ray::new(Point3::from(origin), towards - origin) else {
            return;
        };
        let length = [f64::INFINITY, 4.0][rng.below(2)];
        let each = ids.iter().filter_map(|&id| {
            let scene = self.main();
            let (shape, pose) = (scene.geometry(id)?, scene.pose(id)?);
            let found = RayCaster::new().cast(shape, pose, &ray, length);
            Some((id, found.expect("a ray").safe()?))
        });
        let each: Vec<(BodyId, f64)> = each.collect();
        let first = each.iter().min_by(|x, y| x.1.total_cmp(&y.1));
        for scene in &self.scenes {
            let told = scene.cast_ray(&ray, length, |_| true).expect("no step is due");
            let told = told.and_then(|(id, found)| Some((id, found.safe()?)));
            let is_first = match (told, first) {
                (None, None) => true,
                (Some((id, safe)), Some((_, least))) => {
                    let own = each.iter().find(|e| e.0 == id).map(|e| e.1);
                    let tie = TIE * (1.0 + least.abs());
                    (safe - least).abs() <= tie && own.is_some_and(|own| (own - safe).abs() <= tie)
                }
                // A grazing ray.
                (Some((id, _)), None) | (None, Some(&(id, _))) => self.is_parted_kind(id),
            };
            assert!(is_first, "{ray:?} up to {length}: {told:?}, not {first:?}");
        }
        self.mix.rays[0] += 1;
        self.mix.rays[1] += u64::from(first.is_some());
        let is_moved = |id: BodyId| self.is_without(id) && self.moved.contains(&id);
        self.mix.rays[2] += u64::from(first.is_some_and(|(id, _)| is_moved(*id)));
    }

    /// Returns whether a body is not a sharp polyhedron, so that rounding may decide a grazing ray.
    fn is_parted_kind(&self, id: BodyId) -> bool {
        !matches!(self.forms[self.bodies[&id].0].1, forms::Form::Sharp(_))
    }

    /// Returns whether two bodies are within a distance; `None` if the bounds do not decide it.
    fn is_near(&self, a: BodyId, b: BodyId, d: f64) -> Option<bool> {
        let [x, y] = [a, b].map(|id| &self.forms[self.bodies[&id].0].1);
        let [p, q] = [a, b].map(|id| self.main().pose(id).expect("the body lives"));
        let pose = RelativePose::new(p, q).expect("poses of a scene");
        forms::within(x, y, &pose, d)
    }

    /// Judges the pairs of two groups within a distance, the first contact and the closest pair.
    fn judge_groups(&mut self, g: u8, h: u8) {
        let (g, h) = (group(g), group(h));
        if self.main().queries(g, h) == NONE {
            for scene in &self.scenes {
                assert!(scene.pairs_within(g, h, 0.1).is_err());
            }
            return;
        }
        let of = |id: BodyId| self.main().group(id).expect("the body lives");
        let is_of = |(a, b): &(BodyId, BodyId)| (of(*a), of(*b)) == (g, h) || (of(*b), of(*a)) == (g, h);
        let pairs = self.pairs().filter(is_of);
        let pairs: Vec<_> = pairs.filter(|(a, b)| !self.main().is_excluded(*a, *b)).collect();
        for scene in &self.scenes {
            for d in [0.0, 0.5] {
                let told = scene.pairs_within(g, h, d).expect("boxes are kept");
                let told: Keys = told.iter().map(|p| (p.a.min(p.b), p.a.max(p.b))).collect();
                assert!(told.iter().all(|p| pairs.contains(p)), "{told:?} of {pairs:?}");
                for &(a, b) in &pairs {
                    let truth = self.is_near(a, b, d);
                    let said = told.contains(&(a, b));
                    assert!(
                        truth.is_none_or(|t| t == said),
                        "{a} {b} within {d} is said to be {said}"
                    );
                }
                if d == 0.0 {
                    let first = scene.any_contact(g, h).expect("boxes are kept");
                    assert_eq!(first.is_some(), !told.is_empty());
                }
            }
            let closest = scene.closest_pair(g, h).expect("boxes are kept");
            assert_eq!(closest.is_some(), !pairs.is_empty(), "{pairs:?}");
            let Some(closest) = closest else { continue };
            let most = closest.outcome.lower.max(0.0) - forms::TIE;
            for &(a, b) in &pairs {
                let near = most > 0.0 && self.is_near(a, b, most) == Some(true);
                assert!(!near, "{a} {b} are nearer than {closest:?}");
            }
            let is_apart = closest.outcome.state == ContactState::Separated;
            self.mix.searches[0] += u64::from(is_apart && pairs.len() > 1);
        }
        self.mix.searches[1] += pairs.len() as u64;
    }

    /// Judges the bodies near one body.
    fn judge_nearest(&mut self, rng: &mut Rng) {
        let ids: Vec<BodyId> = self.bodies.keys().copied().collect();
        let Some(&id) = ids.get(rng.below(ids.len().max(1))) else {
            return;
        };
        if self.is_without(id) {
            return;
        }
        let far = 1.0;
        let mates = self.pairs().filter(|(a, b)| self.called(*a, *b) != NONE);
        let mates = mates.filter_map(|(a, b)| if a == id { Some(b) } else { (b == id).then_some(a) });
        let mates: Vec<BodyId> = mates.collect();
        for scene in &self.scenes {
            let told = scene.nearest(id, ids.len(), far).expect("boxes are kept");
            assert!(
                told.iter().all(|p| p.a == id && mates.contains(&p.b)),
                "{told:?} {mates:?}"
            );
            for &other in &mates {
                let truth = self.is_near(id, other, far);
                let said = told.iter().any(|p| p.b == other);
                assert!(truth.is_none_or(|t| t == said), "{id} {other} within {far}: {said}");
            }
            self.mix.searches[2] += told.len() as u64;
        }
    }
}

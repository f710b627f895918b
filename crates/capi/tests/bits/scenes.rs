//! Scenes: pairs, events, first contacts, closest pairs, rays.

use lin_canny::impact::{Impact, Tolerance};
use lin_canny::scene::{Body, BodyId, Change, Group, PairQueries, Scene};
use lin_canny::{Ray, RelativePose, Velocity};
use lin_canny_c::*;

use super::*;

/// A scene of both sides, of bodies of every kind.
struct Both {
    rust: Scene,
    c: lc_scene,
    bodies: Vec<(BodyId, lc_body)>,
}

impl Both {
    /// Makes a scene whose queries hold for all pairs of the groups 0 and 1, except of two bodies of
    /// group 1.
    fn new(count: usize, size: f64, random: &mut Random, queries: PairQueries, of_c: lc_queries) -> Self {
        let all = geometries();
        let mut rust = Scene::new();
        // SAFETY: a place for a handle.
        let c = written(|out| unsafe { lc_scene_new(out) });
        let groups = [Group::default(), Group::new(1).unwrap()];
        for other in [0, 1] {
            rust.set_queries(groups[0], groups[other], queries).unwrap();
            // SAFETY: queries of the stated size.
            ok(unsafe { lc_scene_set_queries(c, 0, other as u32, &of_c, size_of::<lc_queries>()) });
        }
        let mut bodies = Vec::new();
        for k in 0..count {
            let (geometry, handle) = &all[k % all.len()];
            let (pose, group) = (random.pose(size), usize::from(k % 3 == 0));
            let body = Body::moving(geometry.clone()).group(groups[group]);
            let id = rust.insert(body, pose).unwrap();
            // SAFETY: a pose and a place for an id.
            let body = written(|out| unsafe { lc_scene_add(c, *handle, &of(&pose), group as u32, 0, out) });
            bodies.push((id, body));
        }
        Self { rust, c, bodies }
    }

    fn set_pose(&mut self, k: usize, pose: &Isometry3<f64>) {
        let (id, body) = self.bodies[k];
        self.rust.set_pose(id, *pose).unwrap();
        // SAFETY: one body and its pose.
        ok(unsafe { lc_scene_set_poses(self.c, &body, &of(pose), 0, 1) });
    }

    fn step(&mut self) {
        self.rust.step();
        ok(lc_scene_step(self.c));
    }

    /// Returns the body of C.
    fn body(&self, id: BodyId) -> lc_body {
        self.bodies.iter().find(|body| body.0 == id).unwrap().1
    }

    fn answer(&self, r: &Outcome, subshapes: [u32; 2], [a, b]: [BodyId; 2], c: &lc_answer) {
        let pose = RelativePose::new(self.rust.pose(a).unwrap(), self.rust.pose(b).unwrap()).unwrap();
        same(r, subshapes, &pose, c, "bodies of a scene");
    }

    /// Returns what a call lists.
    fn list<T>(&self, call: unsafe extern "C" fn(lc_scene, *mut T, usize, usize, *mut usize) -> lc_status) -> Vec<T> {
        let mut all = Vec::<T>::with_capacity(4000);
        let (place, mut count) = (all.as_mut_ptr(), 0);
        // SAFETY: 4,000 places.
        ok(unsafe { call(self.c, place, size_of::<T>(), 4000, &mut count) });
        assert!(count <= 4000);
        // SAFETY: `count` elements are written.
        unsafe { all.set_len(count) };
        all
    }

    fn free(self) {
        ok(lc_scene_free(self.c));
    }
}

#[test]
fn pairs_and_events_of_scenes_have_the_bits_of_rust() {
    let mut random = Random(11);
    let queries = PairQueries::none()
        .boxes(true)
        .overlap(true)
        .within(0.25)
        .distance(1.0)
        .features(true);
    let of_c = lc_queries {
        flags: LC_QUERY_BOXES | LC_QUERY_OVERLAP | LC_QUERY_WITHIN | LC_QUERY_DISTANCE | LC_QUERY_FEATURES,
        reserved: 0,
        within: 0.25,
        distance: 1.0,
        impact: 0.0,
        impact_within: 0.0,
    };
    let mut both = Both::new(44, 4.0, &mut random, queries, of_c);
    let (mut compared, mut events) = (0, 0);
    for _ in 0..80 {
        for k in 0..both.bodies.len() {
            both.set_pose(k, &random.pose(4.0));
        }
        both.step();
        let pairs = both.list(lc_scene_pairs);
        assert_eq!(pairs.len(), both.rust.pairs().count());
        for (r, c) in both.rust.pairs().zip(&pairs) {
            assert_eq!((both.body(r.a), both.body(r.b)), (c.a, c.b));
            let asked = |answer: Option<bool>| answer.map_or(LC_NOT_ASKED, u32::from);
            assert_eq!((asked(r.overlaps), asked(r.within)), (c.overlaps, c.within));
            if let Some(outcome) = r.outcome {
                both.answer(outcome, r.subshapes.unwrap_or([0; 2]), [r.a, r.b], &c.answer);
                compared += 1;
            } else {
                assert_eq!((c.answer.answered, c.answer.state), (0, LC_UNDECIDED));
                assert_eq!(c.answer.lower, f64::NEG_INFINITY);
                assert_eq!(c.answer.upper, f64::INFINITY);
            }
        }
        let found = both.list(lc_scene_events);
        assert_eq!(found.len(), both.rust.events().len());
        for (r, c) in both.rust.events().iter().zip(&found) {
            assert_eq!((both.body(r.a), both.body(r.b)), (c.a, c.b));
            let change = match r.change {
                Change::BoxesMet => LC_BOXES_MET,
                Change::OverlapBegan => LC_OVERLAP_BEGAN,
                Change::CameWithin => LC_CAME_WITHIN,
                Change::LeftWithin => LC_LEFT_WITHIN,
                Change::OverlapEnded => LC_OVERLAP_ENDED,
                Change::BoxesParted => LC_BOXES_PARTED,
                other => panic!("{other:?}"),
            };
            assert_eq!(change, c.change);
            events += 1;
        }
    }
    assert!(compared >= QUERIES && events >= QUERIES, "{compared} {events}");
    both.free();
}

#[test]
fn closest_pairs_and_rays_of_scenes_have_the_bits_of_rust() {
    let mut random = Random(16);
    let queries = PairQueries::none().overlap(true);
    let of_c = lc_queries {
        flags: LC_QUERY_OVERLAP,
        reserved: 0,
        within: 0.0,
        distance: 0.0,
        impact: 0.0,
        impact_within: 0.0,
    };
    let mut both = Both::new(11, 3.0, &mut random, queries, of_c);
    let groups = [Group::default(), Group::new(1).unwrap()];
    let mut hits = 0;
    for round in 0..QUERIES / 2 {
        both.set_pose(round % 11, &random.pose(3.0));
        both.step();
        for other in [0, 1] {
            let r = both.rust.closest_pair(groups[0], groups[other]).unwrap().unwrap();
            let size = size_of::<lc_scene_pair>();
            // SAFETY: a place for an answer.
            let c = written(|out| unsafe { lc_scene_closest_pair(both.c, 0, other as u32, out, size) });
            assert_eq!((both.body(r.a), both.body(r.b)), (c.a, c.b));
            both.answer(&r.outcome, r.subshapes, [r.a, r.b], &c.answer);

            let (origin, target) = (random.vector(5.0), random.vector(2.0));
            let direction: [f64; 3] = std::array::from_fn(|k| target[k] - origin[k]);
            let ray = lc_ray {
                origin,
                direction,
                length: 9.0,
            };
            let mask = [3, 1][other];
            let size = size_of::<lc_ray_hit>();
            // SAFETY: a ray and a place for a hit.
            let c = written(|out| unsafe { lc_scene_cast_ray(both.c, &ray, mask, out, size) });
            let of_rust = Ray::new(origin.into(), direction.into()).unwrap();
            let is_member = |id| mask == 3 || both.rust.group(id) == Some(groups[0]);
            match both.rust.cast_ray(&of_rust, 9.0, is_member).unwrap() {
                None => assert_eq!((c.state, c.body), (LC_MISS, 0)),
                Some((id, r)) => {
                    assert_eq!(both.body(id).id, c.body);
                    hits += i32::from(same_hit(&r, &c));
                }
            }
        }
    }
    assert!(hits > 1000, "{hits}");
    both.free();
}

#[test]
fn first_contacts_of_scenes_have_the_bits_of_rust() {
    let mut random = Random(17);
    let mut queries = PairQueries::none();
    let width = Tolerance::Distance(1e-6);
    (queries.impact, queries.impact_within) = (Some(width), Some((0.2, width)));
    let of_c = lc_queries {
        flags: LC_QUERY_IMPACT | LC_QUERY_IMPACT_WITHIN,
        reserved: 0,
        within: 0.0,
        distance: 0.0,
        impact: 1e-6,
        impact_within: 0.2,
    };
    let mut both = Both::new(33, 4.0, &mut random, queries, of_c);
    let mut compared = 0;
    while compared < QUERIES {
        for k in 0..both.bodies.len() {
            both.set_pose(k, &random.pose(4.0));
            let (id, body) = both.bodies[k];
            let (linear, angular) = (random.vector(4.0), random.vector(1.0));
            both.rust
                .set_velocity(id, Velocity::new(linear.into(), angular.into()))
                .unwrap();
            // SAFETY: three numbers each.
            ok(unsafe { lc_scene_set_velocity(both.c, body, linear.as_ptr(), angular.as_ptr()) });
        }
        both.step();
        both.rust.advance(0.5).unwrap();
        ok(lc_scene_advance(both.c, 0.5));
        both.step();
        for (id, body) in &both.bodies {
            // SAFETY: a place for a pose.
            let c = written(|out| unsafe { lc_scene_pose(both.c, *body, out) });
            let r = of(both.rust.pose(*id).unwrap());
            assert_eq!(bits(r.translation), bits(c.translation));
            assert_eq!(bits(r.rotation), bits(c.rotation));
        }
        let found = both.list(lc_scene_impacts);
        assert_eq!(found.len(), both.rust.impacts().len());
        assert!(!found.is_empty(), "{compared} first contacts, and no more");
        for (r, c) in both.rust.impacts().iter().zip(&found) {
            assert_eq!((both.body(r.a), both.body(r.b)), (c.a, c.b));
            let (state, hit) = match r.impact {
                Impact::Hit { hit, .. } => (LC_HIT, hit),
                Impact::Undecided { .. } => (LC_UNCLEAR, f64::INFINITY),
                Impact::Incomplete { .. } => (LC_INCOMPLETE, f64::INFINITY),
                ref other => panic!("{other:?}"),
            };
            let numbers = [[r.safe(), hit, r.distance], [c.safe, c.hit, c.distance]];
            assert_eq!((state, bits(numbers[0])), (c.state, bits(numbers[1])));
            compared += 1;
        }
    }
    both.free();
}

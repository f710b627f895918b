//! Promise: whatever is called in whatever order, a scene says what is true; and what is refused changes nothing.

mod support;

use lab::rng::Rng;
use lab::shapes;
use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, BodyId, Change, Effects, Event, Group, Scene, SceneError};
use lin_canny::{Class, ConvexPolyhedron, ManifoldOptions, PoseError, RelativePose, Tracker, Velocity};
use std::collections::BTreeSet;
use std::sync::Arc;
use support::body;

type Keys = BTreeSet<(BodyId, BodyId)>;

const NONE: Effects = Effects::none();

fn group(k: usize) -> Group {
    Group::new(k as u8).unwrap()
}

/// A scene under random calls, and what events have told of it.
struct Play {
    scene: Scene,
    rng: Rng,
    shapes: Vec<Arc<ConvexPolyhedron>>,
    fixed: BTreeSet<BodyId>,
    overlapping: Keys,
    within: Keys,
    boxes: Keys,
}

impl Play {
    fn new(seed: u64) -> Self {
        let mut rng = Rng::new(seed);
        let mut shapes: Vec<_> = [shapes::cube(), shapes::icosahedron(), shapes::needle(&mut rng, 8, 0.1)]
            .iter()
            .map(|s| Arc::new(body(s)))
            .collect();
        shapes.push(Arc::new(ConvexPolyhedron::point(Point3::new(0.1, 0.2, 0.3)).unwrap()));
        // Far from its own origin.
        let far: Vec<_> = shapes::cube()
            .points
            .iter()
            .map(|p| Point3::new(p[0] + 5.0, p[1], p[2]))
            .collect();
        shapes.push(Arc::new(ConvexPolyhedron::from_points(&far).unwrap()));
        Self {
            scene: Scene::new(),
            rng,
            shapes,
            fixed: BTreeSet::new(),
            overlapping: Keys::new(),
            within: Keys::new(),
            boxes: Keys::new(),
        }
    }

    fn pose(&mut self) -> Isometry3<f64> {
        let (q, t) = (self.rng.quat(), [0; 3].map(|_| self.rng.range(-3.0, 3.0)));
        lab::Pose { q, t }.isometry()
    }

    fn any(&mut self) -> Option<BodyId> {
        let n = self.scene.body_count();
        (n > 0).then(|| self.scene.bodies().nth(self.rng.below(n)).unwrap())
    }

    fn effects(&mut self) -> Effects {
        let distance = |rng: &mut Rng| *rng.pick(&[0.0, 0.1, 0.5, 2.0]);
        Effects {
            boxes: self.rng.chance(0.5),
            overlap: self.rng.chance(0.5),
            within: self.rng.chance(0.4).then(|| distance(&mut self.rng)),
            distance: self.rng.chance(0.4).then(|| {
                if self.rng.chance(0.3) {
                    f64::INFINITY
                } else {
                    distance(&mut self.rng)
                }
            }),
            features: self.rng.chance(0.2),
            depth: self.rng.chance(0.2),
            manifold: self
                .rng
                .chance(0.2)
                .then(|| ManifoldOptions::within(distance(&mut self.rng))),
        }
    }

    /// One call.
    fn call(&mut self) {
        let Some(id) = self.any().filter(|_| self.scene.body_count() > 6) else {
            return self.insert();
        };
        match self.rng.below(20) {
            0 if self.scene.body_count() < 16 => self.insert(),
            1 => self.scene.remove(id).unwrap(),
            2 => {
                let (g, h, effects) = (self.rng.below(3), self.rng.below(3), self.effects());
                let effects = if self.rng.chance(0.2) { NONE } else { effects };
                self.scene.call_for(group(g), group(h), effects).unwrap();
            }
            3 => {
                let g = group(self.rng.below(3));
                self.scene.set_group(id, g).unwrap();
            }
            4 => {
                let on = self.rng.chance(0.7);
                self.scene.set_budget(on);
            }
            5 | 6 => {
                let pose = self.pose();
                self.scene.set_pose(id, pose).unwrap();
            }
            7 if !self.fixed.contains(&id) => {
                let part = |rng: &mut Rng| Vector3::from(rng.unit()) * rng.range(0.0, 0.3);
                let velocity = Velocity::new(part(&mut self.rng), part(&mut self.rng));
                self.scene.set_velocity(id, velocity).unwrap();
            }
            8..12 => self.scene.advance(0.1).unwrap(),
            _ => {
                let small = Isometry3::new(
                    Vector3::from(self.rng.unit()) * 0.05,
                    Vector3::from(self.rng.unit()) * 0.05,
                );
                let pose = self.scene.pose(id).unwrap() * small;
                let turn = UnitQuaternion::new_normalize(pose.rotation.into_inner());
                self.scene
                    .set_pose(id, Isometry3::from_parts(pose.translation, turn))
                    .unwrap();
            }
        }
    }

    fn insert(&mut self) {
        let shape = self.rng.pick(&self.shapes).clone();
        let fixed = self.rng.chance(0.3);
        let body = if fixed { Body::fixed(shape) } else { Body::moving(shape) };
        let (g, pose) = (group(self.rng.below(3)), self.pose());
        let id = self.scene.insert(body.group(g), pose).unwrap();
        if fixed {
            self.fixed.insert(id);
        }
    }

    /// A step, all of which is compared.
    fn step(&mut self) -> [usize; 4] {
        self.scene.step();
        let (mut overlapping, mut within) = (Keys::new(), Keys::new());
        let mut seen = [0; 4];
        let ids: Vec<BodyId> = self.scene.bodies().collect();
        for (k, &a) in ids.iter().enumerate() {
            for &b in &ids[k + 1..] {
                if self.fixed.contains(&a) && self.fixed.contains(&b) {
                    assert_eq!(self.scene.pair(a, b), None);
                    continue;
                }
                let effects = self
                    .scene
                    .effects(self.scene.group(a).unwrap(), self.scene.group(b).unwrap());
                let (x, y) = (self.scene.shape(a).unwrap(), self.scene.shape(b).unwrap());
                let pose = RelativePose::new(self.scene.pose(a).unwrap(), self.scene.pose(b).unwrap()).unwrap();
                let truth = Tracker::new().closest(x, y, &pose);
                let at_most = |d: f64| Tracker::new().within(x, y, &pose, d);
                if effects.overlap && at_most(0.0) {
                    overlapping.insert((a, b));
                }
                if effects.within.is_some_and(at_most) {
                    within.insert((a, b));
                }
                let measured = effects.distance.is_some() || effects.depth || effects.features;
                let prediction = effects.manifold.map_or(f64::NEG_INFINITY, |m| m.prediction);
                let range = effects.distance.unwrap_or(effects.within.unwrap_or(0.0));
                let range = if measured { range } else { f64::NEG_INFINITY }.max(prediction);
                let measured = measured || effects.manifold.is_some();
                let measured = measured && (range == f64::INFINITY || at_most(range));
                let found = self.scene.pair(a, b);
                let distance = found.and_then(|p| p.distance);
                assert_eq!(distance.is_some(), measured, "{effects:?} {truth:?}");
                assert_eq!(
                    found.is_some_and(|p| p.outcome.is_some()),
                    measured && (effects.features || effects.manifold.is_some())
                );
                let manifold = found.and_then(|p| p.manifold);
                assert_eq!(manifold.is_some(), effects.manifold.is_some() && at_most(prediction));
                if let Some(d) = distance {
                    let known = d.class != Class::Overlapping || effects.depth || effects.manifold.is_some();
                    assert!(
                        !known || d.lower <= truth.upper && truth.lower <= d.upper,
                        "{d:?} {truth:?}"
                    );
                    seen[0] += 1;
                    seen[1] += usize::from(d.class == Class::Overlapping);
                }
            }
        }
        seen[2] += overlapping.len();
        seen[3] += within.len();
        let events = self.scene.events().to_vec();
        assert!(events.is_sorted_by_key(|e| (e.a.index, e.b.index, e.change)));
        let alive = |(a, b): &(BodyId, BodyId), called: fn(&Effects) -> bool| {
            let groups = self.scene.group(*a).zip(self.scene.group(*b));
            groups.is_some_and(|(g, h)| called(&self.scene.effects(g, h)))
        };
        let ends = |e: &Event| (e.a, e.b);
        let of = |change: Change| {
            events
                .iter()
                .filter(move |e| e.change == change)
                .map(ends)
                .collect::<Keys>()
        };
        for (told, now, began, ended, called) in [
            (
                &self.overlapping,
                &overlapping,
                of(Change::OverlapBegan),
                of(Change::OverlapEnded),
                (|e: &Effects| e.overlap) as fn(&Effects) -> bool,
            ),
            (
                &self.within,
                &within,
                of(Change::CameWithin),
                of(Change::LeftWithin),
                |e| e.within.is_some(),
            ),
        ] {
            assert_eq!(began, now.difference(told).copied().collect());
            // What is no longer called for may be forgotten in silence.
            let must: Keys = told.difference(now).copied().filter(|p| alive(p, called)).collect();
            let may: Keys = told.difference(now).copied().collect();
            assert!(
                must.is_subset(&ended) && ended.is_subset(&may),
                "{must:?} {ended:?} {may:?}"
            );
        }
        let boxed = |p: &lin_canny::scene::PairAnswer<'_>| {
            let effects = self
                .scene
                .effects(self.scene.group(p.a).unwrap(), self.scene.group(p.b).unwrap());
            effects.boxes.then_some((p.a, p.b))
        };
        let boxes: Keys = self.scene.pairs().filter_map(|p| boxed(&p)).collect();
        assert_eq!(of(Change::BoxesMet), boxes.difference(&self.boxes).copied().collect());
        (self.overlapping, self.within, self.boxes) = (overlapping, within, boxes);
        seen
    }
}

#[test]
fn any_calls_in_any_order_give_what_is_true() {
    let mut seen = [0; 4];
    for seed in 0..8 {
        let mut play = Play::new(seed);
        for _ in 0..150 {
            for _ in 0..play.rng.below(6) {
                play.call();
            }
            for (sum, n) in seen.iter_mut().zip(play.step()) {
                *sum += n;
            }
        }
    }
    assert!(seen.iter().all(|n| *n > 500), "{seen:?}");
}

fn cube() -> Arc<ConvexPolyhedron> {
    Arc::new(solids::cuboid(Vector3::repeat(0.5)).unwrap())
}

#[test]
fn refused_calls_name_what_is_wrong_and_change_nothing() {
    let (g, at) = (Group::default(), Isometry3::translation);
    let mut scene = Scene::new();
    scene.call_for(g, g, Effects { overlap: true, ..NONE }).unwrap();
    let a = scene.insert(Body::moving(cube()), at(0.0, 0.0, 0.0)).unwrap();
    let b = scene.insert(Body::fixed(cube()), at(0.5, 0.0, 0.0)).unwrap();
    let gone = scene.insert(Body::moving(cube()), at(0.0, 9.0, 0.0)).unwrap();
    scene.remove(gone).unwrap();
    scene.step();
    let before: Vec<_> = scene.pairs().map(|p| (p.a, p.b, p.overlaps)).collect();
    assert_eq!(before, [(a, b, Some(true))]);

    let stale = Err(SceneError::StaleBody { body: gone });
    assert_eq!(scene.set_pose(gone, at(0.0, 0.0, 0.0)), stale);
    assert_eq!(scene.remove(gone), stale);
    assert_eq!(scene.set_group(gone, g), stale);
    assert_eq!(scene.set_velocity(gone, Velocity::default()), stale);
    assert_eq!(scene.pairs_of(gone).unwrap_err(), SceneError::StaleBody { body: gone });
    assert_eq!(
        scene.nearest(gone, 1, 1.0).unwrap_err(),
        SceneError::StaleBody { body: gone }
    );

    let nan = at(0.0, f64::NAN, 0.0);
    let refused = scene.set_pose(a, nan).unwrap_err();
    assert!(
        matches!(refused, SceneError::Pose { body: Some(id), error: PoseError::Translation { axis: 1, .. } } if id == a)
    );
    assert!(refused.to_string().contains("body 0"), "{refused}");
    let long = UnitQuaternion::new_unchecked(Quaternion::new(1.1, 0.0, 0.0, 0.0));
    let refused = scene.set_pose(a, Isometry3::from_parts(Translation3::identity(), long));
    assert!(matches!(
        refused,
        Err(SceneError::Pose {
            error: PoseError::Rotation { .. },
            ..
        })
    ));
    assert!(matches!(
        scene.set_pose(a, at(0.0, 0.0, -1e38)),
        Err(SceneError::TooFar { axis: 2, .. })
    ));
    assert!(matches!(
        scene.insert(Body::moving(cube()), nan),
        Err(SceneError::Pose { body: None, .. })
    ));
    let huge = solids::cuboid(Vector3::repeat(1e38)).unwrap();
    assert!(matches!(
        scene.insert(Body::moving(huge), at(0.0, 0.0, 0.0)),
        Err(SceneError::TooLarge { .. })
    ));

    for d in [f64::NAN, -0.1, 1e38, f64::INFINITY] {
        let within = Effects {
            within: Some(d),
            ..NONE
        };
        assert!(matches!(scene.call_for(g, g, within), Err(SceneError::Range { .. })));
        if d != f64::INFINITY {
            let distance = Effects {
                distance: Some(d),
                ..NONE
            };
            assert!(matches!(scene.call_for(g, g, distance), Err(SceneError::Range { .. })));
        }
        let manifold = Effects {
            manifold: Some(ManifoldOptions::within(d)),
            ..NONE
        };
        assert!(matches!(scene.call_for(g, g, manifold), Err(SceneError::Range { .. })));
        assert!(d == f64::INFINITY || scene.pairs_within(g, g, d).is_err());
    }
    for set in [
        (|m| m.sine = f64::NAN) as fn(&mut ManifoldOptions),
        |m| m.drift = f64::NAN,
        |m| m.choice = f64::NAN,
    ] {
        let before = scene.effects(g, g);
        let mut options = ManifoldOptions::within(0.1);
        set(&mut options);
        let manifold = Effects {
            manifold: Some(options),
            ..NONE
        };
        assert_eq!(scene.call_for(g, g, manifold), Err(SceneError::ManifoldOptions));
        assert_eq!(scene.effects(g, g), before);
    }
    assert_eq!(
        scene.set_velocity(b, Velocity::default()),
        Err(SceneError::Fixed { body: b })
    );
    let fast = Velocity::new(Vector3::new(f64::INFINITY, 0.0, 0.0), Vector3::zeros());
    assert_eq!(scene.set_velocity(a, fast), Err(SceneError::Velocity));
    assert_eq!(scene.advance(f64::NAN), Err(SceneError::Velocity));
    scene
        .set_velocity(a, Velocity::new(Vector3::new(1e36, 0.0, 0.0), Vector3::zeros()))
        .unwrap();
    assert!(matches!(scene.advance(1e3), Err(SceneError::TooFar { .. })));
    let other = Group::new(5).unwrap();
    assert!(matches!(
        scene.pairs_within(g, other, 1.0),
        Err(SceneError::NotCalledFor { .. })
    ));

    assert_eq!(scene.effects(g, g), Effects { overlap: true, ..NONE });
    scene.step();
    assert!(scene.events().is_empty());
    assert_eq!(scene.report().counts.boxes, 0, "nothing has moved");
    assert_eq!(
        before,
        scene.pairs().map(|p| (p.a, p.b, p.overlaps)).collect::<Vec<_>>()
    );

    scene.set_pose(a, at(0.1, 0.0, 0.0)).unwrap();
    assert_eq!(scene.nearest(a, 1, 1.0).unwrap_err(), SceneError::StepDue);
    assert_eq!(scene.pairs_within(g, g, 1.0).unwrap_err(), SceneError::StepDue);
    assert_eq!(scene.first_contact(g, g).unwrap_err(), SceneError::StepDue);
}

#[test]
fn an_origin_that_is_none_is_refused_with_the_first_body() {
    use lin_canny::broad::{Aabb, BroadPhase, BroadPhaseError, PencilSweep, Settings, SortedAxes};
    for (axis, x) in [(0, f64::NAN), (1, f64::INFINITY), (2, f64::NEG_INFINITY)] {
        let mut origin = Point3::origin();
        origin[axis] = x;
        let settings = Settings::default().origin(origin);
        let mut scene = Scene::with_settings(settings);
        let refused = scene.insert(Body::moving(cube()), Isometry3::identity());
        assert_eq!(refused, Err(SceneError::Origin { axis }));
        assert_eq!((scene.body_count(), scene.step().counts.pairs), (0, 0));
        let (aabb, body) = (
            Aabb::from_center(Point3::origin(), Vector3::repeat(1.0)),
            lin_canny::broad::Body::moving(),
        );
        let error = Err(BroadPhaseError::Origin { axis });
        assert_eq!(PencilSweep::with_settings(settings).insert(&aabb, body), error);
        assert_eq!(
            SortedAxes::with_settings(settings).insert_unbounded(&Aabb::everything(), body),
            error
        );
    }
}

#[test]
fn questions_on_top_equal_brute_force() {
    let mut rng = Rng::new(5);
    let (g, h) = (group(0), group(1));
    let mut scene = Scene::new();
    for (x, y) in [(g, g), (g, h)] {
        scene.call_for(x, y, Effects { boxes: true, ..NONE }).unwrap();
    }
    let shapes = [body(&shapes::icosahedron()), body(&shapes::cuboid([0.9, 0.3, 0.1]))].map(Arc::new);
    for k in 0..60 {
        let (q, t) = (rng.quat(), [0; 3].map(|_| rng.range(-6.0, 6.0)));
        let shape = shapes[k % 2].clone();
        let made = if k % 3 == 0 {
            Body::fixed(shape)
        } else {
            Body::moving(shape)
        };
        scene
            .insert(made.group(group(k / 2 % 2)), lab::Pose { q, t }.isometry())
            .unwrap();
    }
    scene.step();
    let ids: Vec<BodyId> = scene.bodies().collect();
    let fixed = |id: BodyId| id.index.is_multiple_of(3);
    let measure = |a: BodyId, b: BodyId| {
        let pose = RelativePose::new(scene.pose(a).unwrap(), scene.pose(b).unwrap()).unwrap();
        Tracker::new().closest(scene.shape(a).unwrap(), scene.shape(b).unwrap(), &pose)
    };
    let pairs = |of: Group, with: Group| {
        let one = |a: &BodyId| scene.group(*a) == Some(of);
        let other = |b: &BodyId| scene.group(*b) == Some(with);
        let mut all = vec![];
        for &a in ids.iter().filter(|a| one(a)) {
            for &b in ids.iter().filter(|b| other(b)) {
                if a != b && !(fixed(a) && fixed(b)) && (of != with || a < b) {
                    all.push((a, b));
                }
            }
        }
        all
    };
    let mut found = 0;
    for (x, y) in [(g, g), (g, h), (h, g)] {
        for d in [0.0, 0.2, 1.5] {
            let near = scene.pairs_within(x, y, d).unwrap();
            let expected: Vec<_> = pairs(x, y)
                .into_iter()
                .filter(|&(a, b)| measure(a, b).lower <= d)
                .collect();
            assert_eq!(near.iter().map(|n| (n.a, n.b)).collect::<Vec<_>>(), expected);
            for n in &near {
                let truth = measure(n.a, n.b);
                assert!(
                    n.outcome.class == Class::Overlapping
                        || n.outcome.lower <= truth.upper && truth.lower <= n.outcome.upper
                );
            }
            found += near.len();
        }
        let first = scene.first_contact(x, y).unwrap().map(|n| (n.a, n.b));
        assert_eq!(
            first,
            pairs(x, y).into_iter().find(|&(a, b)| measure(a, b).lower <= 0.0)
        );
    }
    assert!(found > 100, "{found}");
    for &id in &ids {
        let may = |b: &&BodyId| {
            **b != id && !(fixed(id) && fixed(**b)) && !(scene.group(id) == Some(h) && scene.group(**b) == Some(h))
        };
        let mut all: Vec<_> = ids
            .iter()
            .filter(may)
            .map(|b| (measure(id, *b).distance.max(0.0), *b))
            .collect();
        all.sort_by(|x, y| x.partial_cmp(y).unwrap());
        for (k, farthest) in [(1, f64::INFINITY), (5, 2.0), (100, f64::INFINITY), (0, 1.0)] {
            let near = scene.nearest(id, k, farthest).unwrap();
            let expected: Vec<_> = all.iter().filter(|x| x.0 <= farthest).take(k).collect();
            assert_eq!(near.len(), expected.len());
            for (n, e) in near.iter().zip(expected) {
                assert!(n.b == e.1 && (n.outcome.distance - e.0).abs() < 1e-12, "{n:?} {e:?}");
            }
        }
    }
}

#[test]
fn odd_scales_and_places_lose_nothing() {
    // Tiny bodies that creep, far from the origin in one scene; huge ones in another.
    for (size, offset) in [(1e-60, 0.0), (1e-3, 1e5), (1e30, 0.0)] {
        let g = Group::default();
        let mut scene = Scene::new();
        scene.call_for(g, g, Effects { overlap: true, ..NONE }).unwrap();
        let shape = Arc::new(solids::cuboid(Vector3::repeat(0.5 * size)).unwrap());
        let at = |x: f64| Isometry3::translation(offset + x * size, offset, 0.0);
        scene.insert(Body::fixed(shape.clone()), at(0.0)).unwrap();
        let b = scene.insert(Body::moving(shape), at(1.1)).unwrap();
        scene.step();
        let mut events = vec![];
        for k in 0..300 {
            let x = 1.1 - 0.2 * (f64::from(k) * 0.05).sin();
            scene.set_pose(b, at(x)).unwrap();
            scene.step();
            let pose = RelativePose::new(&at(0.0), scene.pose(b).unwrap()).unwrap();
            let overlaps = Tracker::new().intersects(scene.shape(b).unwrap(), scene.shape(b).unwrap(), &pose);
            for e in scene.events() {
                events.push(e.change);
            }
            assert_eq!(events.len() % 2 == 1, overlaps, "{size:e} {k}");
        }
        assert!(events.len() >= 4, "{events:?}");
    }
}

/// Turning alone: the closest points of a rod beside a wall stand still while its ends sweep in.
#[test]
fn spinning_bodies_are_looked_at_in_time() {
    let g = Group::default();
    let wall = Arc::new(solids::cuboid(Vector3::new(5.0, 0.5, 5.0)).unwrap());
    let rod = Arc::new(solids::cuboid(Vector3::new(1.0, 0.01, 0.01)).unwrap());
    let axes = [
        Vector3::z(),
        Vector3::new(0.6, 0.0, 0.8),
        Vector3::new(0.36, 0.48, -0.8),
    ];
    // Turned, so that the boxes overlap long before the bodies are near.
    let frame = Isometry3::rotation(Vector3::new(0.4, 0.3, 0.7));
    let (mut events, mut skipped) = (0, 0);
    for (k, axis) in axes.iter().enumerate() {
        for gap in [0.001, 0.01, 0.1, 0.5] {
            for rate in [1e-4, 0.003, 0.05, 0.7] {
                let mut scene = Scene::new();
                let effects = Effects {
                    overlap: k != 1,
                    within: Some(0.02),
                    ..NONE
                };
                scene.call_for(g, g, effects).unwrap();
                scene.insert(Body::fixed(wall.clone()), frame).unwrap();
                let at = frame * Isometry3::translation(0.0, 0.51 + gap, 0.0);
                let id = scene.insert(Body::moving(rod.clone()), at).unwrap();
                scene
                    .set_velocity(id, Velocity::new(Vector3::zeros(), frame * axis))
                    .unwrap();
                let mut within = false;
                for _ in 0..1000 {
                    scene.advance(rate).unwrap();
                    skipped += scene.step().counts.skipped;
                    for e in scene.events() {
                        within ^= matches!(e.change, Change::CameWithin | Change::LeftWithin);
                        events += 1;
                    }
                    let pose = RelativePose::new(&frame, scene.pose(id).unwrap()).unwrap();
                    assert_eq!(within, Tracker::new().within(&wall, &rod, &pose, 0.02), "{gap} {rate}");
                }
            }
        }
    }
    assert!(events > 1000 && skipped > 3000, "{events} {skipped}");
}

//! Promise: a ray cast brackets the first point of a ray in a body, for every kind and at any
//! scale.

use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, BodyId, Group, PairQueries, Scene, SceneError};
use lin_canny::surface::{BezierPatch, BezierSurface};
use lin_canny::{Compound, ConvexPolyhedron, Geometry, Mesh, Ray, RayCast, RayCaster, RayError, RayHit, Shape};
use truth::rng::Rng;

fn pose(rng: &mut Rng, size: f64) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_scaled_axis(Vector3::from(rng.unit()) * rng.range(0.0, 3.0));
    Isometry3::from_parts((Vector3::from(rng.unit()) * rng.range(0.0, 2.0) * size).into(), turn)
}

/// Returns a ray from outside, at a point within the size about the origin of the body.
fn ray_at(rng: &mut Rng, at: &Isometry3<f64>, size: f64) -> Ray {
    let origin = Point3::from(Vector3::from(rng.unit()) * rng.range(4.0, 9.0) * size);
    let aim = at * Point3::from(Vector3::from(rng.unit()) * rng.range(0.0, 1.2) * size);
    Ray::new(origin, aim - origin).expect("a direction")
}

/// Returns the part of a ray inside all half-spaces of a hull at a pose.
fn clipped(hull: &ConvexPolyhedron, at: &Isometry3<f64>, ray: &Ray) -> Option<(f64, f64)> {
    let origin = at.inverse_transform_point(&ray.origin);
    let way = at.inverse_transform_vector(&ray.direction);
    let (mut from, mut until) = (0.0_f64, f64::INFINITY);
    for face in hull.faces() {
        let (n, offset) = hull.face_plane(face).expect("a face");
        let (height, rise) = (n.dot(&origin.coords) - offset, n.dot(&way));
        let t = -height / rise;
        if rise < 0.0 {
            from = from.max(t);
        } else {
            until = until.min(t);
        }
    }
    (from <= until).then_some((from, until))
}

/// Compares a result with the part of the ray in the body, by closed form.
fn judge(found: RayCast, expected: Option<(f64, f64)>, slack: f64, told: &str) -> Option<RayHit> {
    match (found, expected) {
        (RayCast::Hit(hit), Some((from, _))) => {
            assert!(hit.safe - slack <= from, "{told}: {hit:?}, not {from}");
            assert!(from <= hit.hit + slack, "{told}: {hit:?}, not {from}");
            return Some(hit);
        }
        (RayCast::Miss, None) => {}
        (RayCast::Undecided { .. }, None) => {}
        // Rays that graze the body.
        (RayCast::Miss | RayCast::Undecided { .. }, Some((from, until))) => {
            assert!(
                until - from <= 1e-4 * slack.sqrt().max(1e-9) + slack,
                "{told}: {found:?}, not {from} to {until}"
            );
        }
        _ => panic!("{told}: {found:?}, not {expected:?}"),
    }
    None
}

#[test]
fn rays_enter_hulls_where_half_spaces_say() {
    let mut rng = Rng::new(4711);
    let (mut hits, mut misses) = (0, 0);
    for scale in [1.0, 2.0_f64.powi(-200), 2.0_f64.powi(200)] {
        for n in [4, 12, 60] {
            let points: Vec<Point3<f64>> = (0..n)
                .map(|_| Point3::from(Vector3::from(rng.unit()) * scale))
                .collect();
            let hull = ConvexPolyhedron::from_points(&points).expect("a hull");
            let mut caster = RayCaster::new();
            for _ in 0..200 {
                let at = pose(&mut rng, scale);
                let ray = ray_at(&mut rng, &at, scale);
                let found = caster.cast(&hull, &at, &ray, f64::INFINITY).expect("a ray");
                let told = format!("{n} at {scale:e}, {ray:?}");
                match judge(found, clipped(&hull, &at, &ray), 1e-12 * scale, &told) {
                    Some(hit) => {
                        assert!(
                            hit.hit - hit.safe < 1e-10 * scale || hit.normal.dot(&ray.direction) > -1e-4,
                            "{told}: {hit:?}"
                        );
                        assert!(hit.normal.dot(&ray.direction) < 0.0, "{told}: {hit:?}");
                        assert!((hit.point - ray.at(hit.safe)).norm() < 1e-11 * scale, "{told}: {hit:?}");
                        hits += 1;
                    }
                    None => misses += 1,
                }
            }
        }
    }
    assert!(hits > 800 && misses > 200, "{hits} {misses}");
}

/// The same body as a hull, a shape, a mesh and a compound gives one bracket.
#[test]
fn rays_meet_every_kind_alike() {
    let mut rng = Rng::new(4712);
    let hull = solids::icosahedron(1.0).expect("a hull");
    let mesh = Mesh::from_convex(&hull).expect("a mesh");
    let kinds: [Geometry; 4] = [
        hull.clone().into(),
        Shape::from(hull.clone()).into(),
        mesh.into(),
        Compound::from(Shape::from(hull.clone())).into(),
    ];
    let mut hits = 0;
    for k in 0..200 {
        let at = pose(&mut rng, 1.0);
        let ray = ray_at(&mut rng, &at, 1.0);
        for body in &kinds {
            let found = RayCaster::new().cast(body, &at, &ray, 40.0).expect("a ray");
            let told = format!("{k} {:?}", body.kind());
            hits += usize::from(judge(found, clipped(&hull, &at, &ray), 1e-12, &told).is_some());
        }
    }
    assert!(hits > 400, "{hits}");
}

#[test]
fn rays_meet_balls_and_sheets() {
    let mut rng = Rng::new(4713);
    let ball = Shape::ball(0.7).expect("a ball");
    let corners = [[-2.0, -2.0, 0.0], [2.0, -2.0, 0.0], [2.0, 2.0, 0.0], [-2.0, 2.0, 0.0]].map(Point3::from);
    let sheet = Mesh::new(&corners, &[[0, 1, 2], [0, 2, 3]]).expect("a sheet");
    let mut hits = [0; 2];
    for k in 0..300 {
        let at = pose(&mut rng, 1.0);
        let ray = ray_at(&mut rng, &at, 1.0);
        let origin = at.inverse_transform_point(&ray.origin);
        let way = at.inverse_transform_vector(&ray.direction);
        let along = -origin.coords.dot(&way);
        let square = 0.49 - (origin.coords + way * along).norm_squared();
        let expected = (square > 0.0).then(|| (along - square.sqrt(), along + square.sqrt()));
        let found = RayCaster::new().cast(&ball, &at, &ray, 40.0).expect("a ray");
        // A root at a grazing ray.
        let slack = 1e-12 + 1e-15 / square.abs().sqrt();
        hits[0] += usize::from(judge(found, expected, slack, &format!("ball {k}")).is_some());

        let t = -origin.z / way.z;
        let foot = origin + way * t;
        let is_in = t >= 0.0 && foot.x.abs() < 2.0 && foot.y.abs() < 2.0;
        let found = RayCaster::new().cast(&sheet, &at, &ray, f64::INFINITY).expect("a ray");
        let slack = 1e-12 / way.z.abs();
        hits[1] += usize::from(judge(found, is_in.then_some((t, t)), slack, &format!("sheet {k}")).is_some());
    }
    assert!(hits[0] > 60 && hits[1] > 150, "{hits:?}");
}

#[test]
fn lengths_insides_and_refusals() {
    let cube = solids::cuboid(Vector3::new(1.0, 1.0, 1.0)).expect("a cube");
    let (still, mut caster) = (Isometry3::identity(), RayCaster::new());
    let mut cast = |x: f64, length: f64| {
        let ray = Ray::new(Point3::new(x, 0.25, 0.5), Vector3::x() * 1e-200).expect("a direction");
        caster.cast(&cube, &still, &ray, length)
    };
    assert_eq!(cast(-5.0, 3.9), Ok(RayCast::Miss));
    assert!(matches!(cast(-5.0, 4.1), Ok(RayCast::Hit(hit)) if hit.safe < 4.0 && 4.0 <= hit.hit));
    assert_eq!(cast(2.0, f64::INFINITY), Ok(RayCast::Miss));
    for x in [-1.0, -0.5, 0.0, 1.0] {
        assert_eq!(cast(x, 10.0), Ok(RayCast::Inside), "{x}");
    }
    assert_eq!(cast(0.0, 0.0), Ok(RayCast::Inside));
    assert_eq!(cast(-5.0, 0.0), Ok(RayCast::Miss));
    assert!(matches!(cast(-5.0, f64::NAN), Err(RayError::Length { .. })));
    assert!(matches!(cast(-5.0, -1.0), Err(RayError::Length { .. })));
    assert!(matches!(cast(f64::NAN, 1.0), Err(RayError::Motion(_))));
    for none in [Vector3::zeros(), Vector3::x() * f64::NAN, Vector3::x() * f64::INFINITY] {
        assert_eq!(Ray::new(Point3::origin(), none), Err(RayError::Direction));
    }
}

/// A ray through a Bézier surface proves neither a hit nor a miss.
#[test]
fn a_surface_of_patches_is_near() {
    let points: Vec<Point3<f64>> = (0..4)
        .map(|k| Point3::new(f64::from(k / 2), f64::from(k % 2), 0.0))
        .collect();
    let patch = BezierPatch::polynomial([1, 1], &points).expect("a patch");
    let surface = BezierSurface::new(vec![patch]).expect("a surface");
    let ray = Ray::new(Point3::new(0.3, 0.4, 2.0), -Vector3::z()).expect("a direction");
    let found = RayCaster::new().cast(&surface, &Isometry3::identity(), &ray, 9.0);
    assert!(
        matches!(found, Ok(RayCast::Undecided { safe }) if (safe - 2.0).abs() < 1e-6),
        "{found:?}"
    );
    let aside = Ray::new(Point3::new(3.0, 0.4, 2.0), -Vector3::z()).expect("a direction");
    let answer = RayCaster::new().cast(&surface, &Isometry3::identity(), &aside, 9.0);
    assert_eq!(answer, Ok(RayCast::Miss));
}

/// The first body of a scene is that of separate casts at each body.
#[test]
fn scenes_tell_the_first_body() {
    let mut rng = Rng::new(4714);
    let mut scene = Scene::new();
    let hull = solids::icosahedron(0.4).expect("a hull");
    let kinds: [Geometry; 3] = [
        hull.clone().into(),
        Shape::cylinder(0.3, 0.2).expect("a shape").into(),
        Mesh::from_convex(&hull).expect("a mesh").into(),
    ];
    let bodies: Vec<_> = (0..60)
        .map(|k| {
            let (at, shape) = (pose(&mut rng, 3.0), kinds[k % 3].clone());
            (
                scene.insert(Body::moving(shape.clone()), at).expect("a body"),
                shape,
                at,
            )
        })
        .collect();
    let ray = Ray::new(Point3::new(0.0, 0.0, -9.0), Vector3::z()).expect("a direction");
    assert_eq!(scene.cast_ray(&ray, 1.0, |_| true), Err(SceneError::StepDue));
    scene.step();
    let mut hits = 0;
    for k in 0..200 {
        let ray = if k % 2 == 0 {
            ray_at(&mut rng, &Isometry3::identity(), 3.0)
        } else {
            Ray::new(
                Point3::new(rng.range(-3.0, 3.0), rng.range(-3.0, 3.0), -9.0),
                Vector3::z(),
            )
            .expect("a direction")
        };
        let length = if k % 3 == 0 {
            f64::INFINITY
        } else {
            rng.range(1.0, 30.0)
        };
        let may_hit = |id: &BodyId| k % 5 != 0 || id.index.is_multiple_of(2);
        let found = scene.cast_ray(&ray, length, |id| may_hit(&id)).expect("a ray");
        let each = bodies.iter().filter(|(id, ..)| may_hit(id));
        let all = each.filter_map(|(id, shape, at)| {
            let found = RayCaster::new().cast(shape, at, &ray, length).expect("a ray");
            Some((found.safe()?, *id))
        });
        let expected = all.min_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        let told = found.map(|(id, found)| (found.safe().expect("no miss"), id));
        assert_eq!(told.map(|f| f.1), expected.map(|f| f.1), "{k}: {told:?} {expected:?}");
        hits += usize::from(told.is_some());
    }
    assert!(hits > 50, "{hits}");
    assert!(matches!(
        scene.cast_ray(&ray, f64::NAN, |_| true),
        Err(SceneError::Ray(RayError::Length { .. }))
    ));
    let lost = Ray {
        origin: Point3::new(f64::NAN, 0.0, 0.0),
        ..ray
    };
    assert!(matches!(
        scene.cast_ray(&lost, 1.0, |_| true),
        Err(SceneError::Ray(RayError::Motion(_)))
    ));
}

/// A tip on the bounding ball of a body far from its origin, at poses whose quaternions are off
/// unit length by the full tolerance: rays through the tip hit it.
#[test]
fn rays_meet_tips_at_poses_off_unit_length() {
    let far = 1e3;
    let tips = [
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ];
    let tips = tips.map(|[x, y, z]| Point3::new(x + far, y, z));
    let body = ConvexPolyhedron::from_points(&tips).expect("an octahedron");
    let mut met = 0;
    for length in [1.0 + 4.9e-13, 1.0 - 4.9e-13, 1.0] {
        let q = UnitQuaternion::from_scaled_axis(Vector3::z() * std::f64::consts::FRAC_PI_2);
        let q = UnitQuaternion::new_unchecked(q.into_inner() * length);
        let pose = Isometry3::from_parts(Vector3::zeros().into(), q);
        for (x, y) in [(1.0, far), (-1.0, far), (0.0, far + 1.0), (0.0, far - 1.0)] {
            // Inside the tip by more than the rounding of the body.
            let inward = Vector3::new(x, y - far, 0.0) * -4e-10;
            let origin = Point3::new(x, y, -5.0) + inward;
            let ray = Ray::new(origin, Vector3::z()).expect("a ray");
            let found = RayCaster::new().cast(&body, &pose, &ray, 10.0).expect("a pose");
            assert_ne!(found, RayCast::Miss, "{length} {x} {y}");
            let mut scene = Scene::new();
            scene.insert(Body::moving(body.clone()), pose).expect("a body");
            scene.step();
            met += usize::from(scene.cast_ray(&ray, 10.0, |_| true).expect("a scene").is_some());
        }
    }
    assert_eq!(met, 12);
}

/// Returns a scene with a ball without queries, after steps in which the ball moved.
fn ball_without_effects(moves: &[Isometry3<f64>]) -> (Scene, BodyId) {
    let mut scene = Scene::new();
    let ball = Shape::ball(0.5).expect("a ball");
    let id = scene.insert(Body::moving(ball), moves[0]).expect("a body");
    scene.step();
    for at in &moves[1..] {
        scene.set_pose(id, *at).expect("a pose");
        scene.step();
    }
    (scene, id)
}

/// Returns the first body of a scene along the x axis, and its distance.
fn met(scene: &Scene) -> Option<(BodyId, f64)> {
    let ray = Ray::new(Point3::origin(), Vector3::x()).expect("a direction");
    let found = scene.cast_ray(&ray, 10.0, |_| true).expect("no step is due");
    found.and_then(|(id, cast)| Some((id, cast.safe()?)))
}

fn is_met_at(scene: &Scene, id: BodyId, expected: f64) {
    let told = met(scene);
    let is_right = told.is_some_and(|(body, at)| body == id && (at - expected).abs() < 1e-9);
    assert!(is_right, "{told:?}, not {id} at {expected}");
}

/// Rays meet bodies without queries at their current poses.
///
/// The bodies move by poses and by ticks, in a scene that was read back, after their queries are
/// removed, and if they reuse an index.
#[test]
fn rays_meet_bodies_without_effects_where_they_are() {
    let at = |x: f64, y: f64| Isometry3::translation(x, y, 0.0);
    let (scene, id) = ball_without_effects(&[at(0.0, 50.0), at(3.0, 0.0)]);
    is_met_at(&scene, id, 2.5);
    let (scene, _) = ball_without_effects(&[at(3.0, 0.0), at(0.0, 50.0)]);
    assert_eq!(met(&scene), None);

    // By a tick.
    let (mut scene, id) = ball_without_effects(&[at(3.0, 50.0)]);
    let down = lin_canny::Velocity::new(-Vector3::y() * 50.0, Vector3::zeros());
    scene.set_velocity(id, down).expect("it moves");
    scene.advance(1.0).expect("a tick");
    scene.step();
    is_met_at(&scene, id, 2.5);

    // Queries are disabled, and enabled again.
    let (mut scene, id) = ball_without_effects(&[at(0.0, 50.0)]);
    let all = Group::default();
    let boxes = PairQueries::none().boxes(true);
    for (k, queries) in [boxes, PairQueries::none(), boxes, PairQueries::none()]
        .into_iter()
        .enumerate()
    {
        scene.set_queries(all, all, queries).expect("a query");
        scene.step();
        let x = 3.0 + k as f64;
        scene.set_pose(id, at(x, 0.0)).expect("a pose");
        scene.step();
        is_met_at(&scene, id, x - 0.5);
        assert_eq!(scene.check(), Ok(()));
    }

    // A body with the index of a removed body.
    let (mut scene, id) = ball_without_effects(&[at(0.0, 50.0), at(3.0, 0.0)]);
    scene.remove(id).expect("a body");
    scene.step();
    assert_eq!(met(&scene), None);
    let ball = Shape::ball(0.5).expect("a ball");
    let id = scene.insert(Body::moving(ball), at(4.0, 0.0)).expect("a body");
    scene.step();
    is_met_at(&scene, id, 3.5);
    scene.set_pose(id, at(5.0, 0.0)).expect("a pose");
    scene.step();
    is_met_at(&scene, id, 4.5);
}

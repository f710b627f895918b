//! Promise: answers through C have the bits of the answers in Rust, for 10,000 queries of every
//! kind.

use std::ptr::{null, null_mut};

use lin_canny::impact::{CastOptions, Impact, Tolerance};
use lin_canny::motion::{Motion, Steady};
use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, Group, PairQueries, Scene};
use lin_canny::surface::{BezierPatch, BezierSurface};
use lin_canny::{
    Cloud, CloudElement, Compound, ConvexPolyhedron, Decision, Geometry, HalfSpace, ManifoldOptions, Mesh, PairTracker,
    Piece, QueryOptions, Ray, RayCast, RayCaster, RelativePose, Shape, Velocity,
};
use lin_canny_c::*;
use lin_canny_plan::{Checker, RigidSpace, World};
use lin_canny_robot::RobotFiles;

struct Random(u64);

impl Random {
    /// Returns a number between -1 and 1.
    fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / 4503599627370496.0 - 1.0
    }

    fn vector(&mut self, size: f64) -> [f64; 3] {
        std::array::from_fn(|_| size * self.uniform())
    }

    fn pose(&mut self, size: f64) -> Isometry3<f64> {
        let [i, j, k, w] = std::array::from_fn(|_| self.uniform());
        let rotation = UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k));
        Isometry3::from_parts(Translation3::from(Vector3::from(self.vector(size))), rotation)
    }
}

fn of(pose: &Isometry3<f64>) -> lc_pose {
    lc_pose {
        translation: pose.translation.vector.into(),
        rotation: pose.rotation.coords.into(),
    }
}

fn ok(status: lc_status) {
    if status != lc_status::LC_OK {
        // SAFETY: the message is a text of the library.
        let message = unsafe { std::ffi::CStr::from_ptr(lc_last_error()) };
        panic!("{status:?}: {}", message.to_string_lossy());
    }
}

/// Returns what a call writes to a place, which starts as bytes that are no answer.
fn written<T>(call: impl FnOnce(*mut T) -> lc_status) -> T {
    let mut place = std::mem::MaybeUninit::<T>::uninit();
    ok(call(place.as_mut_ptr()));
    // SAFETY: `LC_OK` says that the answer is written.
    unsafe { place.assume_init() }
}

fn bits<const N: usize>(numbers: [f64; N]) -> [u64; N] {
    numbers.map(f64::to_bits)
}

/// Returns a geometry of every kind, in Rust and in C.
fn geometries() -> Vec<(Geometry, lc_geometry)> {
    let mut random = Random(1);
    let cloud: Vec<[f64; 3]> = (0..60).map(|_| random.vector(1.0)).collect();
    let points = |v: &[[f64; 3]]| v.iter().map(|p| Point3::from(*p)).collect::<Vec<_>>();
    let cube: Vec<[f64; 3]> = (0..8)
        .map(|k| std::array::from_fn(|j| if k >> j & 1 == 1 { 0.5 } else { -0.5 }))
        .collect();
    let triangles: [[u32; 3]; 12] = [
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];
    let shape = |kind: u32, parameters: &[f64]| {
        // SAFETY: an array of the stated length.
        written(|out| unsafe { lc_shape_new(kind, parameters.as_ptr(), parameters.len(), out) })
    };
    let net: Vec<[f64; 3]> = (0..9)
        .map(|k| {
            let (x, y) = (f64::from(k / 3) - 1.0, f64::from(k % 3) - 1.0);
            [x, y, -0.3 * (x * x + y * y)]
        })
        .collect();
    let ends = [[-0.5, 0.0, 0.0], [0.5, 0.25, 0.0]];
    let offset = Isometry3::translation(0.4, 0.1, 0.0);
    let mut all: Vec<(Geometry, lc_geometry)> = Vec::new();

    // SAFETY: arrays of the stated lengths.
    let hull = written(|out| unsafe { lc_hull_new(cloud.as_ptr().cast(), 60, None, null_mut(), out) });
    all.push((ConvexPolyhedron::from_points(&points(&cloud)).unwrap().into(), hull));
    let boxed = shape(LC_BOX, &[0.5, 0.25, 0.75]);
    let half = Vector3::new(0.5, 0.25, 0.75);
    all.push((Shape::cuboid(half).unwrap().into(), boxed));
    let segment = ConvexPolyhedron::segment(ends[0].into(), ends[1].into()).unwrap();
    all.push((segment.into(), shape(LC_SEGMENT, ends.as_flattened())));
    // SAFETY: a place for a handle.
    let rounded = written(|out| unsafe { lc_rounded_new(boxed, 0.125, out) });
    all.push((Shape::cuboid(half).unwrap().rounded(0.125).unwrap().into(), rounded));
    let cylinder = Shape::cylinder(0.5, 0.25).unwrap();
    all.push((cylinder.into(), shape(LC_CYLINDER, &[0.5, 0.25])));
    let ellipsoid = Shape::ellipsoid(Vector3::new(0.5, 0.25, 0.75)).unwrap();
    all.push((ellipsoid.into(), shape(LC_ELLIPSOID, &[0.5, 0.25, 0.75])));
    let pieces = [boxed, hull];
    let poses = [of(&Isometry3::identity()), of(&offset)];
    // SAFETY: arrays of two elements.
    let compound = written(|out| unsafe { lc_compound_new(pieces.as_ptr(), poses.as_ptr(), 2, out) });
    let mut second = Piece::new(ConvexPolyhedron::from_points(&points(&cloud)).unwrap());
    second.pose = offset;
    let both = vec![Piece::new(solids::cuboid(half).unwrap()), second];
    all.push((Compound::new(both).unwrap().into(), compound));
    let (vertices, indices) = (cube.as_ptr().cast(), triangles.as_ptr().cast());
    // SAFETY: arrays of the stated lengths.
    let mesh = written(|out| unsafe { lc_mesh_new(vertices, 8, indices, 12, None, null_mut(), out) });
    all.push((Mesh::new(&points(&cube), &triangles).unwrap().into(), mesh));
    // SAFETY: arrays of the stated lengths.
    let balls = written(|out| unsafe { lc_cloud_new(cloud.as_ptr().cast(), 60, 0.0625, null(), out) });
    all.push((
        Cloud::new(&points(&cloud), CloudElement::Ball(0.0625)).unwrap().into(),
        balls,
    ));
    // SAFETY: an array of one patch of nine control points.
    let surface = written(|out| unsafe { lc_surface_new(2, 2, net.as_ptr().cast(), null(), 1, out) });
    let patch = BezierPatch::polynomial([2, 2], &points(&net)).unwrap();
    all.push((BezierSurface::new(vec![patch]).unwrap().into(), surface));
    let space = HalfSpace::new(Vector3::new(0.5, 0.5, 1.0), -1.0).unwrap();
    all.push((space.into(), shape(LC_HALF_SPACE, &[0.5, 0.5, 1.0, -1.0])));
    all
}

/// Compares all queries of a pair at one pose.
fn compare(tracker: &mut PairTracker, pair: lc_pair, bodies: [&Geometry; 2], pose_b: &Isometry3<f64>, name: &str) {
    let here = of(&Isometry3::identity());
    let there = of(pose_b);
    let pose = RelativePose::new(&Isometry3::identity(), pose_b).unwrap();
    let [a, b] = bodies;

    let r = tracker.closest(a, b, &pose);
    // SAFETY: two poses and a place for an answer.
    let ask = |wanted| written(|out| unsafe { lc_pair_ask(pair, &here, &there, wanted, out, size_of::<lc_answer>()) });
    let c = ask(LC_DISTANCE | LC_POINTS | LC_FEATURES);
    let world = r.in_world(&pose);
    assert_eq!(
        bits([r.distance, r.lower, r.upper]),
        bits([c.distance, c.lower, c.upper]),
        "{name}"
    );
    assert_eq!(bits(world.point_on_a.into()), bits(c.point_on_a), "{name}");
    assert_eq!(bits(world.point_on_b.into()), bits(c.point_on_b), "{name}");
    assert_eq!(bits(world.normal.into_inner().into()), bits(c.normal), "{name}");
    assert_eq!(r.locations.map(|l| l.subshape), c.subshapes, "{name}");
    let feature = |f: lin_canny::Feature| [f.dimension() as u32, f.index() as u32];
    assert_eq!(
        [feature(r.features.a), feature(r.features.b)],
        [c.feature_a, c.feature_b],
        "{name}"
    );

    let d = tracker.decide_within(a, b, &pose, 0.25, &QueryOptions::new());
    // SAFETY: two poses and a place for a number.
    let within = written(|out| unsafe { lc_pair_within(pair, &here, &there, 0.25, out) });
    let expected = match d {
        Decision::Yes => 1,
        Decision::No => 0,
        _ => LC_UNDECIDED,
    };
    assert_eq!(within, expected, "{name}");
}

/// Compares contacts, penetration and casts of a pair at one pose.
fn compare_contacts(tracker: &mut PairTracker, pair: lc_pair, bodies: [&Geometry; 2], pose_b: &Isometry3<f64>) {
    let here = of(&Isometry3::identity());
    let there = of(pose_b);
    let pose = RelativePose::new(&Isometry3::identity(), pose_b).unwrap();
    let [a, b] = bodies;

    let options = ManifoldOptions::with_prediction(0.125);
    let mut contacts = Vec::<lc_contact>::with_capacity(512);
    let mut count = 0;
    let place = contacts.as_mut_ptr();
    // SAFETY: two poses, and places for 512 contacts.
    let status = unsafe {
        lc_pair_contacts(
            pair,
            &here,
            &there,
            0.125,
            0,
            place,
            size_of::<lc_contact>(),
            512,
            &mut count,
        )
    };
    match tracker.contacts(a, b, &pose, &options) {
        Err(_) => assert_eq!(status, lc_status::LC_REFUSED),
        Ok(groups) => {
            ok(status);
            let all = groups.iter().flat_map(|group| &group.contacts);
            let expected: Vec<_> = all
                .map(|c| {
                    (
                        c.point.separation.to_bits(),
                        bits((pose_b * c.point.point_on_b).into()),
                        c.patches,
                    )
                })
                .collect();
            assert_eq!(count, expected.len());
            assert!(count <= 512);
            // SAFETY: `count` contacts are written.
            unsafe { contacts.set_len(count) };
            let found: Vec<_> = contacts
                .iter()
                .map(|c| (c.separation.to_bits(), bits(c.point_on_b), c.patches))
                .collect();
            assert_eq!(found, expected);
        }
    }

    let velocity = Velocity::new(Vector3::new(-1.0, 0.1, 0.2), Vector3::new(0.1, 0.2, 0.3));
    let motions = [
        Steady::new(&Isometry3::identity(), Velocity::default()).unwrap(),
        Steady::new(pose_b, velocity).unwrap(),
    ];
    let options = CastOptions::new(Tolerance::Distance(1e-6));
    let r = tracker.cast_from_contact([a.into(), b.into()], &motions[0], &motions[1], 0.0..2.0, &options, None);
    let still = lc_motion {
        pose: here,
        linear: [0.0; 3],
        angular: [0.0; 3],
    };
    let moving = lc_motion {
        pose: there,
        linear: [-1.0, 0.1, 0.2],
        angular: [0.1, 0.2, 0.3],
    };
    let options = lc_cast_options {
        duration: 2.0,
        tolerance: 1e-6,
        distance: 0.0,
        start_contact_margin: 0.0,
        flags: 0,
        reserved: 0,
    };
    let sizes = (size_of::<lc_cast_options>(), size_of::<lc_cast>());
    // SAFETY: two motions, options and a place for a cast.
    let c = written(|out| unsafe { lc_pair_cast(pair, &still, &moving, &options, sizes.0, out, sizes.1) });
    let r = r.unwrap();
    assert_eq!(r.queries, c.queries);
    match r.impact {
        Impact::Hit { safe, hit, seen } => {
            assert_eq!((c.state, bits([c.safe, c.hit])), (LC_HIT, bits([safe, hit])));
            assert_eq!(
                bits((motions[1].pose(safe) * seen.point_on_b).into()),
                bits(c.point_on_b)
            );
        }
        Impact::AtStart { .. } => assert_eq!(c.state, LC_AT_START),
        Impact::Miss => assert_eq!(c.state, LC_MISS),
        Impact::Undecided { safe, .. } => assert_eq!((c.state, c.safe), (LC_UNCLEAR, safe)),
        _ => assert_eq!(c.state, LC_INCOMPLETE),
    }
}

#[test]
fn queries_of_pairs_have_the_bits_of_rust() {
    let all = geometries();
    let mut random = Random(7);
    let (mut asked, mut overlaps) = (0, 0);
    for (a, of_a) in &all {
        for (b, of_b) in &all {
            let name = format!("{} and {}", a.kind(), b.kind());
            let mut tracker = PairTracker::new();
            // SAFETY: a place for a handle.
            let pair = written(|out| unsafe { lc_pair_new(*of_a, *of_b, out) });
            for k in 0..90 {
                let pose = random.pose(if k % 4 == 0 { 0.6 } else { 2.0 });
                compare(&mut tracker, pair, [a, b], &pose, &name);
                asked += 1;
                overlaps += i32::from(tracker.intersects(a, b, &RelativePose::from_isometry(&pose).unwrap()));
                let mut out = 0;
                // SAFETY: two poses and a place; the same query as that of Rust above.
                ok(unsafe { lc_pair_within(pair, &of(&Isometry3::identity()), &of(&pose), 0.0, &mut out) });
            }
            ok(lc_pair_free(pair));
        }
    }
    assert!(asked >= 10_000 && overlaps > 1000, "{asked} {overlaps}");
}

#[test]
fn contacts_and_casts_have_the_bits_of_rust() {
    let all = geometries();
    let mut random = Random(8);
    let mut asked = 0;
    for (a, of_a) in &all {
        for (b, of_b) in &all {
            let mut tracker = PairTracker::new();
            // SAFETY: a place for a handle.
            let pair = written(|out| unsafe { lc_pair_new(*of_a, *of_b, out) });
            for k in 0..90 {
                let pose = random.pose(if k % 4 == 0 { 0.9 } else { 2.0 });
                compare_contacts(&mut tracker, pair, [a, b], &pose);
                asked += 1;
            }
            ok(lc_pair_free(pair));
        }
    }
    assert!(asked >= 10_000, "{asked}");
}

#[test]
fn depths_have_the_bits_of_rust() {
    let all = geometries();
    let mut random = Random(9);
    let (mut asked, mut found) = (0, 0);
    for (a, of_a) in &all {
        for (b, of_b) in &all {
            let mut tracker = PairTracker::new();
            // SAFETY: a place for a handle.
            let pair = written(|out| unsafe { lc_pair_new(*of_a, *of_b, out) });
            for _ in 0..90 {
                let pose_b = random.pose(0.9);
                let pose = RelativePose::from_isometry(&pose_b).unwrap();
                let r = tracker.penetration(a, b, &pose);
                let (here, there) = (of(&Isometry3::identity()), of(&pose_b));
                let mut c = std::mem::MaybeUninit::<lc_penetration>::uninit();
                let size = size_of::<lc_penetration>();
                // SAFETY: two poses and a place for an answer.
                let status = unsafe { lc_pair_penetration(pair, &here, &there, c.as_mut_ptr(), size) };
                asked += 1;
                match r {
                    None => assert_eq!(status, lc_status::LC_REFUSED),
                    Some(r) => {
                        ok(status);
                        // SAFETY: `LC_OK` says that the answer is written.
                        let c = unsafe { c.assume_init() };
                        assert_eq!(bits([r.lower, r.upper]), bits([c.lower, c.upper]));
                        assert_eq!(bits((Isometry3::identity().rotation * r.shift).into()), bits(c.shift));
                        found += 1;
                    }
                }
            }
            ok(lc_pair_free(pair));
        }
    }
    assert!(asked >= 10_000 && found > 1000, "{asked} {found}");
}

#[test]
fn rays_have_the_bits_of_rust() {
    let mut random = Random(10);
    let (mut asked, mut hits) = (0, 0);
    for (geometry, handle) in geometries() {
        let pose = random.pose(0.5);
        let rays: Vec<lc_ray> = (0..1000)
            .map(|_| {
                // Towards the geometry.
                let (origin, target) = (random.vector(3.0), random.vector(0.8));
                lc_ray {
                    origin,
                    direction: std::array::from_fn(|k| target[k] - origin[k]),
                    length: 5.0,
                }
            })
            .collect();
        let mut found = Vec::<lc_ray_hit>::with_capacity(rays.len());
        let (mut done, size) = (0, size_of::<lc_ray_hit>());
        let (count, place) = (rays.len(), found.as_mut_ptr());
        // SAFETY: as many rays and places as stated.
        ok(unsafe { lc_ray_cast_many(handle, &of(&pose), rays.as_ptr(), count, place, size, &mut done) });
        assert_eq!(done, count);
        // SAFETY: all answers are written.
        unsafe { found.set_len(count) };
        let mut caster = RayCaster::new();
        for (ray, c) in rays.iter().zip(&found) {
            let of_rust = Ray::new(ray.origin.into(), ray.direction.into()).unwrap();
            asked += 1;
            match caster.cast(&geometry, &pose, &of_rust, ray.length).unwrap() {
                RayCast::Miss => assert_eq!(c.state, LC_MISS),
                RayCast::Inside => assert_eq!(c.state, LC_AT_START),
                RayCast::Hit(r) => {
                    assert_eq!((c.state, c.subshape), (LC_HIT, r.subshape));
                    assert_eq!(bits([r.safe, r.hit]), bits([c.safe, c.hit]));
                    assert_eq!(bits(r.point.into()), bits(c.point));
                    assert_eq!(bits(r.normal.into_inner().into()), bits(c.normal));
                    hits += 1;
                }
                RayCast::Undecided { safe } => assert_eq!((c.state, c.safe), (LC_UNCLEAR, safe)),
                other => panic!("{other:?}"),
            }
        }
    }
    assert!(asked >= 10_000 && hits > 1000, "{asked} {hits}");
}

#[test]
fn scenes_have_the_bits_of_rust() {
    let all = geometries();
    let mut random = Random(11);
    let mut rust = Scene::new();
    // SAFETY: a place for a handle.
    let c = written(|out| unsafe { lc_scene_new(out) });
    let (group, one) = (Group::default(), Group::new(1).unwrap());
    let queries = PairQueries::none()
        .overlap(true)
        .within(0.25)
        .distance(1.0)
        .features(true);
    rust.set_queries(group, group, queries).unwrap();
    rust.set_queries(group, one, queries).unwrap();
    let queries = lc_queries {
        flags: LC_QUERY_OVERLAP | LC_QUERY_WITHIN | LC_QUERY_DISTANCE | LC_QUERY_FEATURES,
        reserved: 0,
        within: 0.25,
        distance: 1.0,
        impact: 0.0,
    };
    for other in [0, 1] {
        // SAFETY: queries of the stated size.
        ok(unsafe { lc_scene_set_queries(c, 0, other, &queries, size_of::<lc_queries>()) });
    }
    let mut bodies = Vec::new();
    for k in 0..44 {
        let (geometry, handle) = &all[k % 11];
        let pose = random.pose(4.0);
        let id = rust
            .insert(
                Body::moving(geometry.clone()).group(if k % 3 == 0 { one } else { group }),
                pose,
            )
            .unwrap();
        let number = u32::from(k % 3 == 0);
        // SAFETY: a pose and a place for an id.
        let body = written(|out| unsafe { lc_scene_add(c, *handle, &of(&pose), number, 0, out) });
        bodies.push((id, body));
    }
    let (mut compared, mut events) = (0, 0);
    for _ in 0..80 {
        for (id, body) in &bodies {
            let pose = random.pose(4.0);
            rust.set_pose(*id, pose).unwrap();
            // SAFETY: one body and its pose.
            ok(unsafe { lc_scene_set_poses(c, body, &of(&pose), 0, 1) });
        }
        rust.step();
        ok(lc_scene_step(c));
        let mut pairs = Vec::<lc_scene_pair>::with_capacity(2000);
        let (place, size, mut count) = (pairs.as_mut_ptr(), size_of::<lc_scene_pair>(), 0);
        // SAFETY: places for 2,000 pairs.
        ok(unsafe { lc_scene_pairs(c, place, size, 2000, &mut count) });
        assert!(count <= 2000 && count == rust.pairs().count());
        // SAFETY: `count` pairs are written.
        unsafe { pairs.set_len(count) };
        for (r, c) in rust.pairs().zip(&pairs) {
            assert_eq!(r.a.index, c.a.id as u32);
            assert_eq!(
                (r.overlaps.map(u32::from), r.within.map(u32::from)),
                (Some(c.overlaps), Some(c.within))
            );
            if let Some(o) = r.outcome {
                let poses = RelativePose::new(rust.pose(r.a).unwrap(), rust.pose(r.b).unwrap()).unwrap();
                assert_eq!(
                    bits([o.distance, o.lower, o.upper]),
                    bits([c.answer.distance, c.answer.lower, c.answer.upper])
                );
                assert_eq!(bits(o.in_world(&poses).point_on_b.into()), bits(c.answer.point_on_b));
                compared += 1;
            } else {
                assert_eq!(c.answer.answered, 0);
            }
        }
        // SAFETY: no places, and one for the count.
        events += written(|out| unsafe { lc_scene_events(c, null_mut(), size_of::<lc_event>(), 0, out) });
        let r = rust.closest_pair(group, one).unwrap().unwrap();
        let size = size_of::<lc_scene_pair>();
        // SAFETY: a place for an answer.
        let found = written(|out| unsafe { lc_scene_closest_pair(c, 0, 1, out, size) });
        assert_eq!(r.outcome.distance.to_bits(), found.answer.distance.to_bits());
    }
    assert!(compared >= 10_000 && events > 1000, "{compared} {events}");
    ok(lc_scene_free(c));
}

#[test]
fn checkers_have_the_bits_of_rust() {
    let all = geometries();
    let mut random = Random(12);
    let bounds = [[-4.0, 4.0]; 3];
    let mut world = World::new();
    world.robot_body("body", all[4].0.clone());
    let mut rust = Checker::new(RigidSpace::new(bounds, 0.5, 1).unwrap(), world).unwrap();
    // SAFETY: six numbers and a place for a handle.
    let c = written(|out| unsafe { lc_checker_new_body(all[4].1, bounds.as_ptr().cast(), 0.5, out) });
    for (k, (geometry, handle)) in all.iter().enumerate().take(9) {
        let pose = random.pose(3.0);
        rust.add_obstacle(format!("obstacle {k}"), geometry.clone(), pose)
            .unwrap();
        let name = std::ffi::CString::new(format!("obstacle {k}")).unwrap();
        // SAFETY: a text, a pose and a place for an id.
        written(|out| unsafe { lc_checker_obstacle_add(c, name.as_ptr(), *handle, &of(&pose), out) });
    }
    let q: Vec<f64> = (0..5000)
        .flat_map(|_| RigidSpace::configuration(&random.pose(3.0)))
        .collect();
    compare_checkers(&mut rust, c, &q, 7);

    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../robot/examples");
    let mut files = RobotFiles::new(format!("{folder}/six_axis.urdf"));
    files.srdf = Some(format!("{folder}/six_axis.srdf").into());
    files.cell = Some(format!("{folder}/six_axis_cell.json").into());
    let mut rust = files.load().unwrap().1.checker().unwrap();
    let texts = ["six_axis.urdf", "six_axis.srdf", "six_axis_cell.json"]
        .map(|file| std::ffi::CString::new(format!("{folder}/{file}")).unwrap());
    let [robot, srdf, cell] = texts.each_ref().map(|text| text.as_ptr());
    let files = lc_robot_files {
        robot,
        srdf,
        cell,
        packages: null(),
        package_count: 0,
        flags: 0,
        reserved: 0,
    };
    // SAFETY: files of the stated size, whose texts live until the call ends, and a place for a
    // handle.
    let c = written(|out| unsafe { lc_checker_load(&files, size_of::<lc_robot_files>(), out) });
    let q: Vec<f64> = (0..6 * 5000).map(|_| random.uniform()).collect();
    compare_checkers(&mut rust, c, &q, 6);
}

/// Compares all queries at configurations, and of the segments between each and the next.
fn compare_checkers<C: lin_canny_plan::ConfigurationSpace + Sync>(
    rust: &mut Checker<C>,
    c: lc_checker,
    q: &[f64],
    n: usize,
) {
    let count = q.len() / n;
    let info_size = size_of::<lc_checker_info>();
    // SAFETY: a place for an answer.
    let info = written(|out| unsafe { lc_checker_get_info(c, out, info_size) });
    assert_eq!(info.coordinates, n);
    let freedom = info.degrees_of_freedom;
    let (mut done, near) = (0, size_of::<lc_near>());

    let mut free = vec![9_u8; count];
    // SAFETY: as many configurations and places as stated.
    ok(unsafe { lc_checker_free_at_many(c, q.as_ptr(), n, count, free.as_mut_ptr(), &mut done) });
    assert_eq!(done, count);
    for (q, free) in q.chunks(n).zip(&free) {
        assert_eq!(u8::from(rust.is_free_at(q).unwrap()), *free);
    }

    let (mut found, mut gradients) = (Vec::<lc_near>::with_capacity(count), vec![0.0; count * freedom]);
    let place = found.as_mut_ptr();
    let derivatives = gradients.as_mut_ptr();
    // SAFETY: as many configurations and places as stated.
    ok(unsafe { lc_checker_clearance_many(c, q.as_ptr(), n, count, place, near, derivatives, &mut done) });
    // SAFETY: all answers are written.
    unsafe { found.set_len(count) };
    for ((q, c), gradient) in q.chunks(n).zip(&found).zip(gradients.chunks(freedom)) {
        let r = rust.clearance(q).unwrap().unwrap();
        assert_eq!(
            bits([r.distance, r.lower, r.upper, r.excess]),
            bits([c.distance, c.lower, c.upper, c.excess])
        );
        assert_eq!(bits(r.witnesses[1].into()), bits(c.point_on_b));
        assert!(
            r.gradient
                .iter()
                .map(|g| g.to_bits())
                .eq(gradient.iter().map(|g| g.to_bits()))
        );
    }

    let part = &q[..1000 * n];
    let mut found = Vec::<lc_near>::with_capacity(3000);
    let place = found.as_mut_ptr();
    // SAFETY: 1,000 configurations and 3,000 places.
    ok(unsafe { lc_checker_nearest_many(c, part.as_ptr(), n, 1000, 3, 1.0, 2, place, near, null_mut()) });
    // SAFETY: all answers are written.
    unsafe { found.set_len(3000) };
    let r = rust.nearest_batch(part, 3, 1.0, 1).unwrap();
    let of_rust = r.distances.iter().map(|d| d.to_bits());
    assert!(of_rust.eq(found.iter().map(|c| c.distance.to_bits())));

    let size = size_of::<lc_verdict>();
    let mut verdicts = Vec::<lc_verdict>::with_capacity(count - 1);
    let place = verdicts.as_mut_ptr();
    // SAFETY: as many segments and places as stated.
    ok(unsafe { lc_checker_certify_many(c, q.as_ptr(), q[n..].as_ptr(), n, count - 1, place, size, &mut done) });
    // SAFETY: all verdicts are written.
    unsafe { verdicts.set_len(count - 1) };
    let mut blocked = 0;
    for (k, c) in verdicts.iter().enumerate() {
        let r = rust
            .certify(&q[k * n..(k + 1) * n], &q[(k + 1) * n..(k + 2) * n])
            .unwrap();
        assert_eq!(r.safe().to_bits(), c.safe.to_bits());
        match r {
            lin_canny_plan::Verdict::Free { .. } => assert_eq!(c.state, LC_FREE),
            lin_canny_plan::Verdict::Blocked { t, .. } => {
                assert_eq!((c.state, c.hit.to_bits()), (LC_BLOCKED, t.to_bits()));
                blocked += 1;
            }
            _ => assert_eq!(c.state, LC_OPEN),
        }
    }
    assert!(blocked > 0, "no segment is blocked");
    ok(lc_checker_free(c));
}

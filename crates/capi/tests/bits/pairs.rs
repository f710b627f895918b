//! Pairs of every two kinds, and rays against every kind.

use std::ffi::{CStr, CString, c_char};

use lin_canny::impact::{CastOptions, Impact, Tolerance};
use lin_canny::motion::{Motion, Steady};
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::{
    Decision, DepthMode, Geometry, ManifoldOptions, PairTracker, QueryOptions, Ray, RayCaster, RelativePose, Replay,
    Velocity,
};
use lin_canny_c::*;

use super::*;

/// All fields of an answer.
const ALL: u32 = LC_DISTANCE | LC_POINTS | LC_FEATURES;

/// Queries of each of the 121 pairs.
const EACH: usize = QUERIES / 121 + 1;

/// Runs a test of every two geometries, with a tracker and a pair of C that have asked nothing.
fn for_all_pairs(mut test: impl FnMut(&mut PairTracker, lc_pair, [&Geometry; 2], &str)) {
    let all = geometries();
    for (a, of_a) in &all {
        for (b, of_b) in &all {
            // SAFETY: a place for a handle.
            let pair = written(|out| unsafe { lc_pair_new(*of_a, *of_b, out) });
            let name = format!("{} and {}", a.kind(), b.kind());
            test(&mut PairTracker::new(), pair, [a, b], &name);
            ok(lc_pair_free(pair));
        }
    }
}

fn here() -> lc_pose {
    of(&Isometry3::identity())
}

fn relative(pose_b: &Isometry3<f64>) -> RelativePose {
    RelativePose::new(&Isometry3::identity(), pose_b).unwrap()
}

fn ask(pair: lc_pair, pose_b: &Isometry3<f64>, wanted: u32) -> lc_answer {
    let (a, b, size) = (here(), of(pose_b), size_of::<lc_answer>());
    // SAFETY: two poses and a place for an answer.
    written(|out| unsafe { lc_pair_ask(pair, &a, &b, wanted, out, size) })
}

#[test]
fn queries_of_pairs_have_the_bits_of_rust() {
    let mut random = Random(7);
    let mut overlaps = 0;
    for_all_pairs(|tracker, pair, [a, b], name| {
        for k in 0..EACH {
            let pose_b = random.pose(if k % 4 == 0 { 0.6 } else { 2.0 });
            let pose = relative(&pose_b);
            // Points in the world.
            let r = tracker.closest(a, b, &pose);
            let subshapes = r.locations.map(|location| location.subshape);
            same(&r, subshapes, &pose, &ask(pair, &pose_b, ALL), name);
            // Points in the frames of the bodies.
            let r = tracker.closest(a, b, &pose);
            let c = ask(pair, &pose_b, ALL | LC_BODY_FRAMES);
            let points = [r.point_on_a.into(), r.point_on_b.into(), r.normal.into_inner().into()];
            same_points([r.distance, r.lower, r.upper], points, &c, name);
            // Less depth.
            for (depth, mask) in [(DepthMode::None, LC_NO_DEPTH), (DepthMode::Local, LC_LOCAL_DEPTH)] {
                let r = tracker.closest_with(a, b, &pose, &QueryOptions::default().depth(depth));
                let subshapes = r.locations.map(|location| location.subshape);
                same(&r, subshapes, &pose, &ask(pair, &pose_b, ALL | mask), name);
            }
            // Within a distance, and sharing a point.
            for distance in [0.25, 0.0] {
                let r = tracker.decide_within(a, b, &pose, distance, &QueryOptions::default());
                let there = of(&pose_b);
                // SAFETY: two poses and a place for a number.
                let c = written(|out| unsafe { lc_pair_within(pair, &here(), &there, distance, out) });
                let expected = match r {
                    Decision::Yes => 1,
                    Decision::No => 0,
                    _ => LC_UNDECIDED,
                };
                assert_eq!(c, expected, "{name}");
                overlaps += u32::from(distance == 0.0 && c == 1);
            }
        }
    });
    assert!(overlaps > 1000, "{overlaps}");
}

#[test]
fn geometries_of_other_constructors_have_the_bits_of_rust() {
    let mut random = Random(21);
    let (can, others) = (geometries().swap_remove(4), other_geometries());
    for (k, (geometry, handle)) in others.iter().enumerate() {
        let name = format!("{k}, a {}", geometry.kind());
        // SAFETY: a place for a handle.
        let pair = written(|out| unsafe { lc_pair_new(*handle, can.1, out) });
        let mut tracker = PairTracker::new();
        for _ in 0..QUERIES / others.len() + 1 {
            let pose_b = random.pose(2.0);
            let pose = relative(&pose_b);
            let r = tracker.closest(geometry, &can.0, &pose);
            let subshapes = r.locations.map(|location| location.subshape);
            same(&r, subshapes, &pose, &ask(pair, &pose_b, ALL), &name);
        }
        ok(lc_pair_free(pair));
    }
}

#[test]
fn batches_have_the_bits_of_rust() {
    let mut random = Random(13);
    for_all_pairs(|tracker, pair, [a, b], name| {
        let poses: Vec<_> = (0..EACH).map(|_| random.pose(2.0)).collect();
        let given: Vec<lc_pose> = poses.iter().map(of).collect();
        let mut found = Vec::<lc_answer>::with_capacity(EACH);
        let (place, size, stride, mut done) = (found.as_mut_ptr(), size_of::<lc_answer>(), size_of::<lc_pose>(), 0);
        // SAFETY: as many poses and places as stated; a stride of zero repeats one pose.
        ok(unsafe {
            lc_pair_ask_many(
                pair,
                &here(),
                0,
                given.as_ptr(),
                stride,
                EACH,
                ALL,
                place,
                size,
                &mut done,
            )
        });
        assert_eq!(done, EACH);
        // SAFETY: all answers are written.
        unsafe { found.set_len(EACH) };
        for (pose_b, c) in poses.iter().zip(&found) {
            let pose = relative(pose_b);
            let r = tracker.closest(a, b, &pose);
            same(&r, r.locations.map(|location| location.subshape), &pose, c, name);
        }
    });
}

#[test]
fn contacts_have_the_bits_of_rust() {
    let mut random = Random(8);
    let mut found = 0;
    for_all_pairs(|tracker, pair, [a, b], name| {
        for k in 0..EACH {
            let pose_b = random.pose(if k % 4 == 0 { 0.9 } else { 2.0 });
            let (there, most) = (of(&pose_b), k % 9);
            let mut contacts = Vec::<lc_contact>::with_capacity(512);
            let (place, size, mut count) = (contacts.as_mut_ptr(), size_of::<lc_contact>(), 0);
            // SAFETY: two poses, and places for 512 contacts.
            let status =
                unsafe { lc_pair_contacts(pair, &here(), &there, 0.125, most as u32, place, size, 512, &mut count) };
            let options = ManifoldOptions::default()
                .prediction(0.125)
                .max_points(if most == 0 { 4 } else { most });
            let Ok(groups) = tracker.contacts(a, b, &relative(&pose_b), &options) else {
                assert_eq!(status, lc_status::LC_REFUSED, "{name}");
                continue;
            };
            ok(status);
            let of_rust = groups.iter().enumerate();
            let of_rust = of_rust.flat_map(|(group, r)| r.contacts.iter().map(move |contact| (group, contact)));
            assert!(count <= 512 && count == of_rust.clone().count(), "{name}: {count}");
            // SAFETY: `count` contacts are written.
            unsafe { contacts.set_len(count) };
            for ((group, r), c) in of_rust.zip(&contacts) {
                let here = Isometry3::identity();
                assert_eq!((group as u32, r.patches), (c.group, c.patches), "{name}");
                assert_eq!(r.point.separation.to_bits(), c.separation.to_bits(), "{name}");
                assert_eq!(bits((here * r.point.point_on_a).into()), bits(c.point_on_a), "{name}");
                assert_eq!(bits((pose_b * r.point.point_on_b).into()), bits(c.point_on_b), "{name}");
                assert_eq!(bits((here * r.normal).into_inner().into()), bits(c.normal), "{name}");
                let features = [feature(r.point.id.a), feature(r.point.id.b)];
                assert_eq!(features.as_flattened(), c.name, "{name}");
                found += 1;
            }
        }
    });
    assert!(found >= QUERIES, "{found}");
}

#[test]
fn casts_have_the_bits_of_rust() {
    let mut random = Random(14);
    let (mut hits, mut accepted) = (0, 0);
    for_all_pairs(|tracker, pair, [a, b], name| {
        for k in 0..EACH {
            let pose_b = random.pose(if k % 4 == 0 { 0.9 } else { 2.0 });
            let (linear, angular) = (random.vector(1.0), random.vector(0.3));
            let velocity = Velocity::new(linear.into(), angular.into());
            let motions = [
                Steady::new(&Isometry3::identity(), Velocity::default()).unwrap(),
                Steady::new(&pose_b, velocity).unwrap(),
            ];
            let accepts = k % 2 == 1;
            let distance = if k % 3 == 0 { 0.0625 } else { 0.0 };
            let mut options = CastOptions::default()
                .tolerance(Tolerance::Distance(1e-6))
                .distance(distance);
            options.start_contact_margin = accepts.then_some(0.25);
            let bodies = [a.into(), b.into()];
            let r = tracker.cast_from_contact(bodies, &motions[0], &motions[1], 0.0..2.0, &options, None);
            let motion = |pose, linear, angular| lc_motion { pose, linear, angular };
            let still = motion(here(), [0.0; 3], [0.0; 3]);
            let moving = motion(of(&pose_b), linear, angular);
            let options = lc_cast_options {
                duration: 2.0,
                tolerance: 1e-6,
                distance,
                start_contact_margin: 0.25,
                flags: if accepts { LC_ACCEPT_START } else { 0 },
                reserved: 0,
            };
            let (given, size) = (size_of::<lc_cast_options>(), size_of::<lc_cast>());
            let mut c = std::mem::MaybeUninit::<lc_cast>::uninit();
            // SAFETY: two motions, options and a place for a cast.
            let status = unsafe { lc_pair_cast(pair, &still, &moving, &options, given, c.as_mut_ptr(), size) };
            let Ok(r) = r else {
                assert_eq!(status, lc_status::LC_REFUSED, "{name}");
                continue;
            };
            ok(status);
            // SAFETY: `LC_OK` says that the cast is written.
            let c = unsafe { c.assume_init() };
            assert_eq!(r.queries, c.queries, "{name}");
            let (state, safe, hit, seen) = match &r.impact {
                Impact::Hit { safe, hit, seen } => (LC_HIT, *safe, *hit, Some(seen)),
                Impact::AtStart { seen } => (LC_AT_START, 0.0, 0.0, Some(seen)),
                Impact::Miss => (LC_MISS, 2.0, f64::INFINITY, None),
                Impact::Undecided { safe, .. } => (LC_UNCLEAR, *safe, f64::INFINITY, None),
                Impact::Incomplete { safe } => (LC_INCOMPLETE, *safe, f64::INFINITY, None),
                other => panic!("{name}: {other:?}"),
            };
            assert_eq!((c.state, bits([c.safe, c.hit])), (state, bits([safe, hit])), "{name}");
            let poses = motions.each_ref().map(|motion| motion.pose(safe));
            let points = seen.map_or([[0.0; 3]; 3], |seen| {
                [
                    (poses[0] * seen.point_on_a).into(),
                    (poses[1] * seen.point_on_b).into(),
                    (poses[0] * seen.normal).into_inner().into(),
                ]
            });
            assert_eq!(
                points.map(bits),
                [c.point_on_a, c.point_on_b, c.normal].map(bits),
                "{name}"
            );
            let start = r.start_contact.map_or([0.0; 3], |start| {
                [start.distance, start.kept, start.until.unwrap_or(f64::INFINITY)]
            });
            assert_eq!(
                bits(start),
                bits([c.start_distance, c.start_kept, c.start_until]),
                "{name}"
            );
            assert_eq!(u32::from(r.start_contact.is_some()), c.start_accepted, "{name}");
            hits += u32::from(c.state == LC_HIT);
            accepted += c.start_accepted;
        }
    });
    assert!(hits > 1000 && accepted > 100, "{hits} {accepted}");
}

#[test]
fn depths_have_the_bits_of_rust() {
    let mut random = Random(9);
    let mut found = 0;
    for_all_pairs(|tracker, pair, [a, b], name| {
        for _ in 0..EACH {
            let pose_b = random.pose(0.9);
            let r = tracker.penetration(a, b, &relative(&pose_b));
            let there = of(&pose_b);
            let mut c = std::mem::MaybeUninit::<lc_penetration>::uninit();
            let size = size_of::<lc_penetration>();
            // SAFETY: two poses and a place for an answer.
            let status = unsafe { lc_pair_penetration(pair, &here(), &there, c.as_mut_ptr(), size) };
            let Some(r) = r else {
                assert_eq!(status, lc_status::LC_REFUSED, "{name}");
                continue;
            };
            ok(status);
            // SAFETY: `LC_OK` says that the answer is written.
            let c = unsafe { c.assume_init() };
            assert_eq!(bits([r.lower, r.upper]), bits([c.lower, c.upper]), "{name}");
            let shift = Isometry3::identity().rotation * r.shift;
            assert_eq!(bits(shift.into()), bits(c.shift), "{name}");
            found += 1;
        }
    });
    assert!(found > 5000, "{found}");
}

#[test]
fn volumes_have_the_bits_of_rust() {
    let mut random = Random(10);
    let mut found = 0;
    for_all_pairs(|tracker, pair, [a, b], name| {
        for _ in 0..EACH {
            let pose_b = random.pose(0.9);
            let pose = relative(&pose_b);
            let r = tracker.overlap(a, b, &pose);
            let there = of(&pose_b);
            let mut c = std::mem::MaybeUninit::<lc_overlap_volume>::uninit();
            let size = size_of::<lc_overlap_volume>();
            // SAFETY: two poses and a place for an answer.
            let status = unsafe { lc_pair_overlap(pair, &here(), &there, c.as_mut_ptr(), size) };
            let Ok(r) = r else {
                assert_eq!(status, lc_status::LC_REFUSED, "{name}");
                continue;
            };
            ok(status);
            // SAFETY: `LC_OK` says that the answer is written.
            let c = unsafe { c.assume_init() };
            assert_eq!(bits([r.lower, r.upper]), bits([c.lower, c.upper]), "{name}");
            let centroid = r.centroid.map(|p| pose.poses().0 * p);
            assert_eq!(
                bits(centroid.map_or([f64::NAN; 3], Into::into)),
                bits(c.centroid),
                "{name}"
            );
            assert_eq!(r.centroid_error.to_bits(), c.centroid_error.to_bits(), "{name}");
            assert_eq!(u32::from(r.covers_itself), c.covers_itself, "{name}");
            found += 1;
        }
    });
    assert!(found > 500, "{found}");
}

/// Returns the text of a call, or nothing if the call refuses.
fn text(call: impl FnOnce(*mut *mut c_char) -> lc_status) -> Option<CString> {
    let mut place = std::ptr::null_mut();
    match call(&mut place) {
        lc_status::LC_REFUSED => return None,
        status => ok(status),
    }
    // SAFETY: a text of the library.
    let copy = unsafe { CStr::from_ptr(place) }.to_owned();
    // SAFETY: as above; it is freed once.
    unsafe { lc_text_free(place) };
    Some(copy)
}

#[test]
fn replays_have_the_bits_of_rust() {
    let mut random = Random(15);
    // Hull, box, segment and rounded box: all others have no replays.
    let each = QUERIES / 16 + 1;
    let mut replayed = 0;
    for_all_pairs(|tracker, pair, [a, b], name| {
        for k in 0..each {
            let pose_b = random.pose(if k % 4 == 0 { 0.6 } else { 2.0 });
            let (pose, there) = (relative(&pose_b), of(&pose_b));
            let r = tracker.replay(a, b, &pose);
            // SAFETY: two poses and a place for a text.
            let c = text(|out| unsafe { lc_pair_replay(pair, &here(), &there, out) });
            let Some(r) = r else {
                assert!(c.is_none(), "{name}");
                return;
            };
            let (c, r) = (c.expect(name), r.to_string());
            assert_eq!(c.to_str(), Ok(r.as_str()), "{name}");
            let replay: Replay = r.parse().unwrap();
            let [one, two] = replay.shapes();
            let found = replay.pair_tracker().closest(&one, &two, &replay.pose);
            let size = size_of::<lc_answer>();
            // SAFETY: a text and a place for an answer.
            let answer = written(|out| unsafe { lc_replay_answer(c.as_ptr(), ALL, out, size) });
            same(
                &found,
                found.locations.map(|location| location.subshape),
                &replay.pose,
                &answer,
                name,
            );
            // Both go on from here.
            let r = tracker.closest(a, b, &pose);
            let subshapes = r.locations.map(|location| location.subshape);
            same(&r, subshapes, &pose, &ask(pair, &pose_b, ALL), name);
            replayed += 1;
        }
    });
    assert!(replayed >= QUERIES, "{replayed}");
}

#[test]
fn rays_have_the_bits_of_rust() {
    let mut random = Random(10);
    let (mut asked, mut hits) = (0, 0);
    for (geometry, handle) in geometries() {
        let pose = random.pose(0.5);
        let rays: Vec<lc_ray> = (0..QUERIES / 10)
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
            let of_rust = Ray::new(ray.origin.into(), Vector3::from(ray.direction)).unwrap();
            let r = caster.cast(&geometry, &pose, &of_rust, ray.length).unwrap();
            hits += i32::from(same_hit(&r, c));
            asked += 1;
        }
    }
    assert!(asked >= QUERIES && hits > 1000, "{asked} {hits}");
}

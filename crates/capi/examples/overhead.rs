//! What a query costs through C over the same query in Rust, in one process.
//!
//! `cargo build --release && cargo run --release --example overhead [-- ROUNDS [ROW]]`
//!
//! Loads the shared library that C programs load. Each round times a thousand queries in Rust, then
//! the same ones through C, in thread time; the least times of all rounds are printed, because other
//! programs on the machine only add to a time. Both sides must return the same bits. Exit code 1: a
//! query costs more than 15 ns and 10 % more through C. ROW is a part of the names of rows.

use std::ffi::{CStr, c_char, c_int, c_void};
use std::hint::black_box;
use std::ptr::{null, null_mut};

use lin_canny::impact::{CastOptions, Impact, Tolerance};
use lin_canny::motion::Steady;
use lin_canny::nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use lin_canny::{
    ConvexPolyhedron, Geometry, ManifoldOptions, PairTracker, PatchContact, QueryOptions, Ray, RayCast, RayCaster,
    RelativePose, Shape, Tracker, Velocity,
};
use lin_canny_c::*;
use lin_canny_robot::RobotFiles;

const QUERIES: usize = 1000;

/// Returns the number of rounds: 101, or the argument of this program.
fn rounds() -> usize {
    let given = std::env::args().nth(1);
    given.map_or(101, |text| text.parse().expect("a number of rounds"))
}

#[repr(C)]
struct TimeSpec {
    seconds: i64,
    nanoseconds: i64,
}

unsafe extern "C" {
    fn dlopen(path: *const c_char, flags: c_int) -> *mut c_void;
    fn dlsym(library: *mut c_void, name: *const c_char) -> *mut c_void;
    fn clock_gettime(clock: c_int, time: *mut TimeSpec) -> c_int;
}

/// Returns the time that this thread has run, in nanoseconds.
fn now() -> f64 {
    let mut time = TimeSpec {
        seconds: 0,
        nanoseconds: 0,
    };
    // SAFETY: a place for a time; 3 is CLOCK_THREAD_CPUTIME_ID of Linux.
    let failed = unsafe { clock_gettime(3, &mut time) };
    assert_eq!(failed, 0, "no clock of the thread");
    1e9 * time.seconds as f64 + time.nanoseconds as f64
}

/// A shared library of C.
struct Library(*mut c_void);

impl Library {
    fn load() -> Self {
        let program = std::env::current_exe().expect("the path of this program");
        let folder = program.ancestors().nth(2).expect("target/release");
        let path = folder.join("liblin_canny_c.so");
        let text = std::ffi::CString::new(path.to_str().expect("a path in UTF-8")).expect("a path without zero");
        // SAFETY: a text; the library runs no code when it is loaded.
        let library = unsafe { dlopen(text.as_ptr(), 2) };
        assert!(
            !library.is_null(),
            "{} cannot be loaded: run cargo build --release",
            path.display()
        );
        Self(library)
    }

    /// Returns the function of a name with the type of `like`, a pointer to the same function.
    fn function<F: Copy>(&self, name: &CStr, like: F) -> F {
        assert_eq!(size_of::<F>(), size_of::<*mut c_void>());
        let _ = like;
        // SAFETY: a library and a text.
        let found = unsafe { dlsym(self.0, name.as_ptr()) };
        assert!(!found.is_null(), "{name:?} is missing");
        // SAFETY: the library was built from the sources of `like`, so the types are equal.
        unsafe { std::mem::transmute_copy(&found) }
    }
}

/// Returns a function of the library with the type that it has in the sources.
macro_rules! function {
    ($library:expr, $name:ident, $($argument:tt)*) => {{
        let like: unsafe extern "C" fn($($argument)*) -> lc_status = $name;
        let name = concat!(stringify!($name), "\0").as_bytes();
        $library.function(CStr::from_bytes_with_nul(name).expect("a name"), like)
    }};
}

fn ok(status: lc_status) {
    assert_eq!(status, lc_status::LC_OK);
}

/// Returns what a call writes.
#[inline(always)]
fn written<T: Copy>(call: impl FnOnce(*mut T) -> lc_status) -> T {
    read(call, |answer| *answer)
}

/// Reads what a call writes at its place, as C does: a copy would count as time of the call.
#[inline(always)]
fn read<T, R>(call: impl FnOnce(*mut T) -> lc_status, field: impl FnOnce(&T) -> R) -> R {
    let mut place = std::mem::MaybeUninit::<T>::uninit();
    ok(call(place.as_mut_ptr()));
    // SAFETY: `LC_OK` says that the answer is written.
    field(black_box(unsafe { place.assume_init_ref() }))
}

fn least(times: &[f64]) -> f64 {
    times.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Times queries on both sides, prints a row, and returns whether the border costs too much. A count
/// of one is a batch of `QUERIES`.
fn race(name: &str, count: usize, mut rust: impl FnMut(usize) -> f64, mut c: impl FnMut(usize) -> f64) -> bool {
    if !name.contains(&std::env::args().nth(2).unwrap_or_default()) {
        return false;
    }
    let (mut of_rust, mut of_c) = (Vec::new(), Vec::new());
    let queries = if count == 1 { QUERIES } else { count } as f64;
    for round in 0..rounds() {
        let (mut sum_rust, mut sum_c) = (0.0, 0.0);
        let start = now();
        for k in 0..count {
            sum_rust += rust(k);
        }
        let middle = now();
        for k in 0..count {
            sum_c += c(k);
        }
        let end = now();
        assert_eq!(
            sum_rust.to_bits(),
            sum_c.to_bits(),
            "{name}, round {round}: {sum_rust} and {sum_c}"
        );
        of_rust.push((middle - start) / queries);
        of_c.push((end - middle) / queries);
    }
    let (rust, c) = (least(&of_rust), least(&of_c));
    let more = c - rust;
    let is_over = more > 15.0 && more > 0.1 * rust;
    println!(
        "| {name} | {rust:.1} | {c:.1} | {more:+.1} | {:+.1} % |{}",
        100.0 * more / rust,
        if is_over { " OVER |" } else { " |" }
    );
    is_over
}

struct Random(u64);

impl Random {
    /// Returns a number between -1 and 1.
    fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / 4503599627370496.0 - 1.0
    }

    /// Returns a point of the unit sphere.
    fn direction(&mut self) -> Vector3<f64> {
        loop {
            let v = Vector3::from_fn(|_, _| self.uniform());
            if (1e-6..=1.0).contains(&v.norm_squared()) {
                return v.normalize();
            }
        }
    }
}

fn of(pose: &Isometry3<f64>) -> lc_pose {
    lc_pose {
        translation: pose.translation.vector.into(),
        rotation: pose.rotation.coords.into(),
    }
}

/// Returns an orbit of half a degree per query, at a distance.
fn orbit(distance: f64) -> Vec<Isometry3<f64>> {
    let pose = |k| {
        let turn = 0.0087 * k as f64;
        let at = Translation3::new(distance * turn.cos(), distance * turn.sin(), 0.2);
        Isometry3::from_parts(at, UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn))
    };
    (0..QUERIES).map(pose).collect()
}

fn main() {
    let library = Library::load();
    let mut over = 0;
    println!("| query | Rust, ns | C, ns | more, ns | more |");
    println!("|---|---:|---:|---:|---:|");
    over += pairs(&library);
    over += rays(&library);
    over += checkers(&library);
    println!("{over} of the rows cost more than 15 ns and 10 % more through C");
    std::process::exit(i32::from(over > 0));
}

fn pairs(library: &Library) -> u32 {
    let hull_new = function!(library, lc_hull_new, _, _, _, _, _);
    let shape_new = function!(library, lc_shape_new, _, _, _, _);
    let pair_new = function!(library, lc_pair_new, _, _, _);
    let mut random = Random(1);
    let mut hull = |vertices| -> (Geometry, lc_geometry, ConvexPolyhedron) {
        let points: Vec<Point3<f64>> = (0..vertices).map(|_| Point3::from(random.direction())).collect();
        let flat: Vec<f64> = points.iter().flat_map(|p| [p.x, p.y, p.z]).collect();
        let rust = ConvexPolyhedron::from_points(&points).expect("a hull");
        // SAFETY: three numbers per point, and a place for a handle.
        let c = written(|out| unsafe { hull_new(flat.as_ptr(), vertices, None, null_mut(), out) });
        (rust.clone().into(), c, rust)
    };
    let hulls = [hull(8), hull(8), hull(128), hull(128)];
    let can = Shape::cylinder(1.0, 0.5).expect("a cylinder");
    // SAFETY: two numbers and a place for a handle.
    let can_c = written(|out| unsafe { shape_new(LC_CYLINDER, [1.0, 0.5].as_ptr(), 2, out) });
    let pair = |a, b| -> lc_pair {
        // SAFETY: a place for a handle.
        written(|out| unsafe { pair_new(a, b, out) })
    };
    let can = (Geometry::from(can), can_c);
    let mut over = 0;
    for (name, a, b) in [
        ("hulls of 8 vertices", &hulls[0], &hulls[1]),
        ("hulls of 128 vertices", &hulls[2], &hulls[3]),
    ] {
        over += of_pair(library, name, [&a.0, &b.0], pair(a.1, b.1));
        // Another query of Rust, which C does not have: not counted.
        alone(library, name, [&a.2, &b.2], pair(a.1, b.1));
    }
    let hull = &hulls[3];
    over += of_pair(library, "cylinder, hull of 128", [&can.0, &hull.0], pair(can.1, hull.1));
    over
}

/// The tracker of two polyhedra, which needs no dispatch by kind.
fn alone(library: &Library, name: &str, [a, b]: [&ConvexPolyhedron; 2], pair: lc_pair) {
    let ask = function!(library, lc_pair_ask, _, _, _, _, _, _);
    let (poses, here) = (orbit(2.4), Isometry3::identity());
    let given: Vec<lc_pose> = poses.iter().map(of).collect();
    let origin = of(&here);
    let mut tracker = Tracker::new();
    let wanted = LC_DISTANCE | LC_POINTS | LC_FEATURES | LC_BODY_FRAMES;
    race(
        &format!("{name}: closest, beside Rust's `Tracker` of polyhedra (not counted)"),
        QUERIES,
        |k| {
            let pose = RelativePose::new(black_box(&here), &poses[k]).expect("a pose");
            black_box(&tracker.closest(a, b, &pose)).distance
        },
        |k| {
            // SAFETY: two poses and a place for an answer.
            let place = |out| unsafe { ask(pair, black_box(&origin), &given[k], wanted, out, size_of::<lc_answer>()) };
            read(place, |answer: &lc_answer| answer.distance)
        },
    );
}

/// All queries of a pair.
fn of_pair(library: &Library, name: &str, [a, b]: [&Geometry; 2], pair: lc_pair) -> u32 {
    let ask = function!(library, lc_pair_ask, _, _, _, _, _, _);
    let ask_many = function!(library, lc_pair_ask_many, _, _, _, _, _, _, _, _, _, _);
    let within = function!(library, lc_pair_within, _, _, _, _, _);
    let contacts = function!(library, lc_pair_contacts, _, _, _, _, _, _, _, _, _);
    let penetration = function!(library, lc_pair_penetration, _, _, _, _, _);
    let cast = function!(library, lc_pair_cast, _, _, _, _, _, _, _);
    let reset = library.function(c"lc_pair_reset", lc_pair_reset as extern "C" fn(_) -> _);
    let (apart, deep, here) = (orbit(2.4), orbit(1.2), Isometry3::identity());
    let given = |poses: &[Isometry3<f64>]| poses.iter().map(of).collect::<Vec<_>>();
    let (apart_c, deep_c, origin) = (given(&apart), given(&deep), of(&here));
    let mut over = 0;
    let mut race = |query: &str, count: usize, rust: &mut dyn FnMut(usize) -> f64, c: &mut dyn FnMut(usize) -> f64| {
        ok(reset(pair));
        over += u32::from(self::race(&format!("{name}: {query}"), count, rust, c));
    };

    for (query, poses, poses_c) in [("apart", &apart, &apart_c), ("overlapping", &deep, &deep_c)] {
        let mut tracker = PairTracker::new();
        let all = LC_DISTANCE | LC_POINTS | LC_FEATURES;
        let mut closest = |k: usize| {
            let pose = RelativePose::new(black_box(&here), &poses[k]).expect("a pose");
            black_box(&tracker.closest(a, b, &pose)).distance
        };
        let mut asked = |k: usize| {
            let place = |out| {
                // SAFETY: two poses and a place for an answer.
                unsafe {
                    ask(
                        pair,
                        black_box(&origin),
                        &poses_c[k],
                        all | LC_BODY_FRAMES,
                        out,
                        size_of::<lc_answer>(),
                    )
                }
            };
            read(place, |answer: &lc_answer| answer.distance)
        };
        race(&format!("closest, {query}"), QUERIES, &mut closest, &mut asked);

        let mut tracker = PairTracker::new();
        let mut closest = |k: usize| {
            let pose = RelativePose::new(black_box(&here), &poses[k]).expect("a pose");
            let found = tracker.closest(a, b, &pose);
            black_box(&found.in_world(&pose)).point_on_b.x
        };
        let mut asked = |k: usize| {
            // SAFETY: two poses and a place for an answer.
            let place = |out| unsafe { ask(pair, black_box(&origin), &poses_c[k], all, out, size_of::<lc_answer>()) };
            read(place, |answer: &lc_answer| answer.point_on_b[0])
        };
        race(
            &format!("closest in the world, {query}"),
            QUERIES,
            &mut closest,
            &mut asked,
        );

        let mut tracker = PairTracker::new();
        let options = QueryOptions::default();
        let mut decide = |k: usize| {
            let pose = RelativePose::new(black_box(&here), &poses[k]).expect("a pose");
            f64::from(u32::from(tracker.decide_within(a, b, &pose, 0.25, &options).is_yes()))
        };
        let mut asked = |k: usize| {
            // SAFETY: two poses and a place for a number.
            let found: u32 = written(|out| unsafe { within(pair, black_box(&origin), &poses_c[k], 0.25, out) });
            f64::from(found)
        };
        race(&format!("within, {query}"), QUERIES, &mut decide, &mut asked);
    }

    let mut tracker = PairTracker::new();
    let mut answers = Vec::<lc_answer>::with_capacity(QUERIES);
    let mut closest = |_: usize| {
        let mut sum = 0.0;
        for pose_b in &apart {
            let pose = RelativePose::new(black_box(&here), pose_b).expect("a pose");
            sum += black_box(&tracker.closest(a, b, &pose)).distance;
        }
        sum
    };
    let mut asked = |_: usize| {
        let (place, size, stride, mut done) = (answers.as_mut_ptr(), size_of::<lc_answer>(), size_of::<lc_pose>(), 0);
        let wanted = LC_DISTANCE | LC_POINTS | LC_FEATURES | LC_BODY_FRAMES;
        // SAFETY: as many poses and places as stated; a stride of zero repeats one pose.
        ok(unsafe {
            ask_many(
                pair,
                &origin,
                0,
                apart_c.as_ptr(),
                stride,
                QUERIES,
                wanted,
                place,
                size,
                &mut done,
            )
        });
        // SAFETY: all answers are written.
        unsafe { answers.set_len(done) };
        answers.iter().map(|answer| answer.distance).fold(0.0, |sum, x| sum + x)
    };
    race("closest, a batch of 1,000", 1, &mut closest, &mut asked);

    let mut tracker = PairTracker::new();
    let options = ManifoldOptions::default().prediction(0.125);
    let mut manifold = |k: usize| {
        let pose = RelativePose::new(black_box(&here), &deep[k]).expect("a pose");
        let groups = tracker.contacts(a, b, &pose, &options).expect("contacts");
        // Points and normal in the world, as C has them.
        let world = |c: &PatchContact| {
            let point = &c.point;
            black_box((here * point.point_on_a, deep[k] * point.point_on_b, here * c.normal)).1
        };
        let contacts = groups.iter().flat_map(|group| &group.contacts);
        contacts.map(|c| world(c).x).sum::<f64>()
    };
    let mut places = Vec::<lc_contact>::with_capacity(64);
    let mut asked = |k: usize| {
        let (place, size, mut count) = (places.as_mut_ptr(), size_of::<lc_contact>(), 0);
        // SAFETY: two poses and places for 64 contacts.
        ok(unsafe {
            contacts(
                pair,
                black_box(&origin),
                &deep_c[k],
                0.125,
                0,
                place,
                size,
                64,
                &mut count,
            )
        });
        assert!(count <= 64);
        // SAFETY: `count` contacts are written.
        unsafe { places.set_len(count) };
        places.iter().map(|c| c.point_on_b[0]).sum::<f64>()
    };
    race("contacts", QUERIES, &mut manifold, &mut asked);

    let mut tracker = PairTracker::new();
    let mut depth = |k: usize| {
        let pose = RelativePose::new(black_box(&here), &deep[k]).expect("a pose");
        tracker.penetration(a, b, &pose).expect("solids").upper
    };
    let mut asked = |k: usize| {
        // SAFETY: two poses and a place for bounds.
        let place =
            |out| unsafe { penetration(pair, black_box(&origin), &deep_c[k], out, size_of::<lc_penetration>()) };
        read(place, |found: &lc_penetration| found.upper)
    };
    race("penetration", QUERIES, &mut depth, &mut asked);

    let mut tracker = PairTracker::new();
    let options = CastOptions::default().tolerance(Tolerance::Distance(1e-6));
    let mut first = |k: usize| {
        let still = Steady::new(black_box(&here), Velocity::default()).expect("a motion");
        let velocity = Velocity::new(-apart[k].translation.vector, Vector3::new(0.1, 0.2, 0.3));
        let moving = Steady::new(&apart[k], velocity).expect("a motion");
        let found = tracker.cast_from_contact([a.into(), b.into()], &still, &moving, 0.0..1.0, &options, None);
        match found.expect("a cast").impact {
            Impact::Hit { hit, .. } => hit,
            _ => 0.0,
        }
    };
    let given = lc_cast_options {
        duration: 1.0,
        tolerance: 1e-6,
        distance: 0.0,
        start_contact_margin: 0.0,
        flags: 0,
        reserved: 0,
    };
    let sizes = (size_of::<lc_cast_options>(), size_of::<lc_cast>());
    let mut asked = |k: usize| {
        let motion = |pose, linear, angular| lc_motion { pose, linear, angular };
        let still = motion(origin, [0.0; 3], [0.0; 3]);
        let moving = motion(apart_c[k], apart_c[k].translation.map(|x| -x), [0.1, 0.2, 0.3]);
        // SAFETY: two motions, options and a place for a cast.
        let place = |out| unsafe { cast(pair, black_box(&still), &moving, &given, sizes.0, out, sizes.1) };
        read(place, |found: &lc_cast| found.hit)
    };
    race("cast", QUERIES, &mut first, &mut asked);
    over
}

fn rays(library: &Library) -> u32 {
    let hull_new = function!(library, lc_hull_new, _, _, _, _, _);
    let cast = function!(library, lc_ray_cast_many, _, _, _, _, _, _, _);
    let mut random = Random(2);
    let points: Vec<Point3<f64>> = (0..128).map(|_| Point3::from(random.direction())).collect();
    let flat: Vec<f64> = points.iter().flat_map(|p| [p.x, p.y, p.z]).collect();
    let rust = Geometry::from(ConvexPolyhedron::from_points(&points).expect("a hull"));
    // SAFETY: three numbers per point, and a place for a handle.
    let c = written(|out| unsafe { hull_new(flat.as_ptr(), 128, None, null_mut(), out) });
    let rays: Vec<lc_ray> = (0..QUERIES)
        .map(|_| {
            let (from, to) = (3.0 * random.direction(), 0.5 * random.direction());
            lc_ray {
                origin: from.into(),
                direction: (to - from).into(),
                length: 9.0,
            }
        })
        .collect();
    let here = Isometry3::identity();
    let origin = of(&here);
    let sum = |hits: &[lc_ray_hit]| hits.iter().fold(0.0, |sum, ray| sum + ray.hit);
    let mut places = Vec::<lc_ray_hit>::with_capacity(QUERIES);
    // A ray alone makes the state of a caster on both sides, as in the batch of 1,000.
    let mut over = 0;
    for (name, count, batch) in [
        ("one ray, hull of 128", QUERIES, 1),
        ("a batch of 1,000 rays, hull of 128", 1, QUERIES),
    ] {
        let is_over = race(
            name,
            count,
            |k| {
                let mut caster = RayCaster::new();
                let mut sum = 0.0;
                for ray in &rays[k..k + batch] {
                    let line = Ray::new(ray.origin.into(), ray.direction.into()).expect("a ray");
                    sum += match caster.cast(&rust, black_box(&here), &line, ray.length).expect("a cast") {
                        RayCast::Hit(hit) => hit.hit,
                        _ => 0.0,
                    };
                }
                sum
            },
            |k| {
                let (place, size, mut done) = (places.as_mut_ptr(), size_of::<lc_ray_hit>(), 0);
                let first = rays[k..k + batch].as_ptr();
                // SAFETY: a pose, and as many rays and places as stated.
                ok(unsafe { cast(c, black_box(&origin), first, batch, place, size, &mut done) });
                // SAFETY: all answers are written.
                unsafe { places.set_len(done) };
                sum(&places)
            },
        );
        over += u32::from(is_over);
    }
    over
}

fn checkers(library: &Library) -> u32 {
    let load = function!(library, lc_checker_load, _, _, _);
    let is_free = function!(library, lc_checker_free_at_many, _, _, _, _, _, _);
    let clearance = function!(library, lc_checker_clearance_many, _, _, _, _, _, _, _, _);
    let certify = function!(library, lc_checker_certify_many, _, _, _, _, _, _, _, _);
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../robot/examples");
    let path = |file: &str| format!("{folder}/{file}");
    let mut files = RobotFiles::new(path("six_axis.urdf"));
    files.srdf = Some(path("six_axis.srdf").into());
    files.cell = Some(path("six_axis_cell.json").into());
    let mut rust = lin_canny_plan::Checker::of_robots(files.load().expect("a robot").cell).expect("a checker");
    let texts = ["six_axis.urdf", "six_axis.srdf", "six_axis_cell.json"]
        .map(|file| std::ffi::CString::new(path(file)).expect("a path"));
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
    // SAFETY: files whose texts live until the call ends, and a place for a handle.
    let c = written(|out| unsafe { load(&files, size_of::<lc_robot_files>(), out) });
    let (mut random, n) = (Random(3), 6);
    let q: Vec<f64> = (0..n * (QUERIES + 1)).map(|_| random.uniform()).collect();
    let at = |k: usize| &q[k * n..(k + 1) * n];
    let mut over = race(
        "six-axis cell: is free, random configurations",
        QUERIES,
        |k| f64::from(u8::from(rust.is_free_at(at(k)).expect("a configuration"))),
        |k| {
            let mut done = 0;
            // SAFETY: one configuration, a place for a byte and one for a count.
            f64::from(written(|out| unsafe {
                is_free(c, at(k).as_ptr(), n, 1, out, &mut done)
            }))
        },
    ) as u32;
    over += race(
        "six-axis cell: clearance, random configurations",
        100,
        |k| {
            rust.clearance(at(k))
                .expect("a configuration")
                .expect("a pair")
                .distance
        },
        |k| {
            let (mut done, size) = (0, size_of::<lc_near>());
            let q = at(k).as_ptr();
            // SAFETY: one configuration and a place for an answer.
            let place = |out| unsafe { clearance(c, q, n, 1, out, size, null_mut(), &mut done) };
            read(place, |near: &lc_near| near.distance)
        },
    ) as u32;
    over += race(
        "six-axis cell: certify, random segments",
        30,
        |k| {
            rust.certify(&lin_canny_plan::JointMotion::segment(at(k), at(k + 1)))
                .expect("a segment")
                .free_until()
        },
        |k| {
            let (mut done, size) = (0, size_of::<lc_verdict>());
            let (from, to) = (at(k).as_ptr(), at(k + 1).as_ptr());
            // SAFETY: two configurations and a place for a verdict.
            let place = |out| unsafe { certify(c, from, to, n, 1, out, size, &mut done) };
            read(place, |found: &lc_verdict| found.free_until)
        },
    ) as u32;
    over
}

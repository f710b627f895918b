//! Pairs of two geometries, and rays against one.

use std::ffi::c_char;
use std::hint::black_box;

use lin_canny::impact::{CastOptions, Impact, Tolerance};
use lin_canny::motion::{Motion, Steady};
use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::{
    Decision, DepthMode, Geometry, ManifoldOptions, PairOutcome, PairTracker, QueryOptions, Ray, RayCast, RayCaster,
    RelativePose, Replay,
};

use crate::border::{Status, guarded, lc_status, refused};
use crate::geometry::{lc_geometry, shared};
use crate::memory::{Given, Place, Places, Plain, options, text};
use crate::pose::{LC_UNDECIDED, feature, isometry, lc_motion, lc_pose, state, velocity};
use crate::table::{Changing, Table};

/// A pair of two geometries and its tracker, which caches the state of the last query.
///
/// One call at a time: a call during another one returns `LC_BUSY`. Any thread.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct lc_pair {
    /// The handle; zero is none.
    pub id: u64,
}

/// Asks for contact state, distance and bounds.
pub const LC_DISTANCE: u32 = 1;
/// Asks for witness points and normal.
pub const LC_POINTS: u32 = 2;
/// Asks for features and subshapes.
pub const LC_FEATURES: u32 = 4;
/// Asks for points and normal in the frames of the bodies: `point_on_a` and `normal` in that of A,
/// `point_on_b` in that of B. Without it they are in the world.
pub const LC_BODY_FRAMES: u32 = 8;
/// Asks for no depth: overlapping convex geometries have the distance zero and no lower bound.
pub const LC_NO_DEPTH: u32 = 16;
/// Asks for an upper bound of the depth of two overlapping polyhedra, in a fraction of the time of
/// the depth.
pub const LC_LOCAL_DEPTH: u32 = 32;

/// The closest points of two geometries, with bounds of the signed distance.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lc_answer {
    /// The groups of fields that are set: a mask of `LC_DISTANCE`, `LC_POINTS`, `LC_FEATURES`. The
    /// other fields are zero. Without `LC_DISTANCE` the state is `LC_UNDECIDED`, and the bounds are
    /// infinite.
    pub answered: u32,
    /// `LC_SEPARATED`, `LC_TOUCHING`, `LC_OVERLAPPING` or `LC_UNDECIDED`.
    pub state: u32,
    /// The signed distance; minus the penetration depth if convex geometries overlap, zero if
    /// others do.
    pub distance: f64,
    /// Proven lower bound of the signed distance; minus infinity if nothing is known.
    pub lower: f64,
    /// Proven upper bound of the signed distance.
    pub upper: f64,
    /// The witness on A.
    pub point_on_a: [f64; 3],
    /// The witness on B.
    pub point_on_b: [f64; 3],
    /// The unit normal from A to B.
    pub normal: [f64; 3],
    /// The feature of A: dimension (0 vertex, 1 edge, 2 face) and index.
    pub feature_a: [u32; 2],
    /// The feature of B.
    pub feature_b: [u32; 2],
    /// The piece, triangle, patch or point of A and of B; zero for a convex geometry.
    pub subshapes: [u32; 2],
}

// SAFETY: numbers only.
unsafe impl Plain for lc_answer {
    const FIRST: usize = 128;
}

/// An answer without fields, which claims nothing.
pub(crate) const NOTHING: lc_answer = lc_answer {
    answered: 0,
    state: LC_UNDECIDED,
    distance: 0.0,
    lower: f64::NEG_INFINITY,
    upper: f64::INFINITY,
    point_on_a: [0.0; 3],
    point_on_b: [0.0; 3],
    normal: [0.0; 3],
    feature_a: [0; 2],
    feature_b: [0; 2],
    subshapes: [0; 2],
};

/// A contact point of two geometries, in the world.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lc_contact {
    /// The point on A.
    pub point_on_a: [f64; 3],
    /// The point on B.
    pub point_on_b: [f64; 3],
    /// The unit normal from A to B.
    pub normal: [f64; 3],
    /// The signed distance along the normal; negative in an overlap.
    pub separation: f64,
    /// The group of contacts with nearly the same normal; 0 is the deepest.
    pub group: u32,
    /// The convex patch or piece of A and of B.
    pub patches: [u32; 2],
    /// Zero.
    pub reserved: u32,
    /// The features of A and of B at which the contact first appeared, which name it while it
    /// lasts: dimension and index of each.
    pub name: [u32; 4],
}

// SAFETY: numbers only.
unsafe impl Plain for lc_contact {
    const FIRST: usize = 112;
}

/// Bounds of the penetration depth of two solids, in the world.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lc_penetration {
    /// No shorter translation separates the solids.
    pub lower: f64,
    /// The length of `shift`.
    pub upper: f64,
    /// A translation of B that separates the solids.
    pub shift: [f64; 3],
}

// SAFETY: numbers only.
unsafe impl Plain for lc_penetration {
    const FIRST: usize = 40;
}

/// The volume that two solids share, with its centre of mass in the world.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lc_overlap_volume {
    /// Lower bound; it may be negative by rounding.
    pub lower: f64,
    /// Upper bound.
    pub upper: f64,
    /// The centre of mass of the common part; NaN unless the volume is certainly positive.
    pub centroid: [f64; 3],
    /// Bound of the error of each coordinate of the centroid; 0 without a centroid.
    pub centroid_error: f64,
    /// 1 if a solid was found to cover points twice or to face inward: each point counts by both
    /// winding numbers then.
    pub covers_itself: u32,
    /// Zero.
    pub reserved: u32,
}

// SAFETY: numbers only.
unsafe impl Plain for lc_overlap_volume {
    const FIRST: usize = 48;
}

/// Accepts a contact at the start that a cast proves not to come closer: see
/// `start_contact_margin`.
pub const LC_ACCEPT_START: u32 = 1;

/// Options of a cast; all zero is the default, except the duration.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lc_cast_options {
    /// The cast covers the times from 0 to this.
    pub duration: f64,
    /// The geometries are closer than this at the end of the free interval; zero is as narrow as
    /// rounding allows.
    pub tolerance: f64,
    /// The distance that the geometries must keep.
    pub distance: f64,
    /// With `LC_ACCEPT_START`: the largest distance, or depth, of a contact at the start that is
    /// accepted.
    pub start_contact_margin: f64,
    /// A mask of `LC_ACCEPT_START`.
    pub flags: u32,
    /// Zero.
    pub reserved: u32,
}

// SAFETY: numbers only.
unsafe impl Plain for lc_cast_options {
    const FIRST: usize = 40;
}

/// Nothing is met, proven for the whole interval or length.
pub const LC_MISS: u32 = 0;
/// The first contact is after `safe`, and at the latest at `hit`.
pub const LC_HIT: u32 = 1;
/// The geometries are in contact at the start, or the origin of the ray is inside.
pub const LC_AT_START: u32 = 2;
/// Rounding hides whether there is a contact; nothing is known beyond `safe`.
pub const LC_UNCLEAR: u32 = 4;
/// A limit ended the cast; nothing is known beyond `safe`.
pub const LC_INCOMPLETE: u32 = 5;

/// The first contact of two moving geometries. Points and normal are in the world, at the time
/// `safe`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lc_cast {
    /// `LC_MISS`, `LC_HIT`, `LC_AT_START`, `LC_UNCLEAR` or `LC_INCOMPLETE`.
    pub state: u32,
    /// The number of distance queries.
    pub queries: u32,
    /// The geometries are proven apart up to this time.
    pub safe: f64,
    /// The geometries are proven in contact at this time; infinite without a proof.
    pub hit: f64,
    /// The witness on A; zero without a contact.
    pub point_on_a: [f64; 3],
    /// The witness on B; zero without a contact.
    pub point_on_b: [f64; 3],
    /// The unit normal from A to B; zero without a contact.
    pub normal: [f64; 3],
    /// 1 if a contact at the start was accepted; the three fields below are its own.
    pub start_accepted: u32,
    /// Zero.
    pub reserved: u32,
    /// Lower bound of the signed distance at the start.
    pub start_distance: f64,
    /// The signed distance that is proven to be kept.
    pub start_kept: f64,
    /// The time at which the geometries have left the margin; infinite if they slide to the end.
    pub start_until: f64,
}

// SAFETY: numbers only.
unsafe impl Plain for lc_cast {
    const FIRST: usize = 128;
}

/// A ray in the world; its direction may have any length except zero.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lc_ray {
    /// The origin.
    pub origin: [f64; 3],
    /// The direction.
    pub direction: [f64; 3],
    /// The length, which may be infinite.
    pub length: f64,
}

/// Where a ray enters a geometry, in the world.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lc_ray_hit {
    /// `LC_MISS`, `LC_HIT`, `LC_AT_START` or `LC_UNCLEAR`.
    pub state: u32,
    /// The triangle or piece; zero for a geometry of one piece.
    pub subshape: u32,
    /// The body of a scene; zero for a ray against one geometry.
    pub body: u64,
    /// All points of the ray up to this distance are outside; infinite for a miss.
    pub safe: f64,
    /// A point up to this distance is inside; infinite without a proof.
    pub hit: f64,
    /// The point; zero without a hit.
    pub point: [f64; 3],
    /// The outward unit normal; zero without a hit.
    pub normal: [f64; 3],
}

// SAFETY: numbers only.
unsafe impl Plain for lc_ray_hit {
    const FIRST: usize = 80;
}

pub(crate) struct Pair {
    a: Geometry,
    b: Geometry,
    tracker: PairTracker,
}

impl Changing for Pair {
    fn recover(&mut self) -> Status {
        self.tracker = PairTracker::new();
        Ok(())
    }
}

static PAIRS: Table<crate::table::Watched<Pair>> = Table::new(2, "pair");

pub(crate) fn live() -> usize {
    PAIRS.live()
}

/// Makes a pair of two geometries, which may be the same.
///
/// # Safety
/// `out` points to a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_pair_new(a: lc_geometry, b: lc_geometry, out: *mut lc_pair) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let out = unsafe { Place::new(out, "out") }?;
        let (a, b, tracker) = (shared(a)?, shared(b)?, PairTracker::new());
        let id = PAIRS.add(Pair { a, b, tracker })?;
        out.write(lc_pair { id });
        Ok(())
    })
}

/// Frees a pair; zero is no error.
///
/// During a call with the pair, in another thread or in a callback of it, the result is `LC_BUSY`
/// and nothing is freed.
#[unsafe(no_mangle)]
pub extern "C" fn lc_pair_free(pair: lc_pair) -> lc_status {
    guarded(|| PAIRS.free(pair.id))
}

/// Drops the cached state: the next answer has the bits of a new pair's.
#[unsafe(no_mangle)]
pub extern "C" fn lc_pair_reset(pair: lc_pair) -> lc_status {
    guarded(|| PAIRS.with(pair.id, |pair| pair.recover()))
}

#[inline(always)]
fn relative(pose_a: &lc_pose, pose_b: &lc_pose) -> Result<RelativePose, lc_status> {
    RelativePose::new(&isometry(pose_a), &isometry(pose_b)).map_err(refused)
}

/// Returns the answer of an outcome; the fields of the mask are set.
#[inline(always)]
fn answer(found: &PairOutcome, pose: &RelativePose, wanted: u32) -> lc_answer {
    // Dimension and index were stored apart a moment ago: one load of both would wait for the stores.
    let apart = |[dimension, index]: [u32; 2]| [dimension, black_box(index)];
    let mut answer = lc_answer {
        answered: LC_DISTANCE | LC_POINTS | LC_FEATURES,
        state: state(found.state),
        distance: found.distance,
        lower: found.lower,
        upper: found.upper,
        point_on_a: found.point_on_a.into(),
        point_on_b: found.point_on_b.into(),
        normal: found.normal.into_inner().into(),
        feature_a: apart(feature(found.features.a)),
        feature_b: apart(feature(found.features.b)),
        subshapes: found.locations.map(|location| location.subshape),
    };
    if wanted & (LC_BODY_FRAMES | LC_POINTS) == LC_POINTS {
        let world = found.in_world(pose);
        answer.point_on_a = world.point_on_a.into();
        answer.point_on_b = world.point_on_b.into();
        answer.normal = world.normal.into_inner().into();
    } else if wanted & LC_POINTS == 0 {
        answer = lc_answer {
            answered: answer.answered & !LC_POINTS,
            point_on_a: [0.0; 3],
            point_on_b: [0.0; 3],
            normal: [0.0; 3],
            ..answer
        };
    }
    answer
}

/// Returns the options of the query that a mask asks for.
#[inline(always)]
fn query(wanted: u32) -> QueryOptions {
    let depth = match wanted & (LC_NO_DEPTH | LC_LOCAL_DEPTH) {
        0 => DepthMode::Full,
        LC_LOCAL_DEPTH => DepthMode::Local,
        _ => DepthMode::None,
    };
    QueryOptions::default().depth(depth)
}

impl Pair {
    #[inline(always)]
    fn ask(&mut self, pose: &RelativePose, wanted: u32) -> lc_answer {
        let found = self.tracker.closest_with(&self.a, &self.b, pose, &query(wanted));
        answer(&found, pose, wanted)
    }
}

/// Writes the answer about a pair at two poses in the world: the fields of the mask `wanted`, and
/// maybe more.
///
/// `out_size` is `sizeof(lc_answer)`. Unknown bits of the mask are ignored; `answered` says which
/// fields are set. `out` may be the memory of a pose.
///
/// # Safety
/// `pose_a` and `pose_b` point to poses, `out` to `out_size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_pair_ask(
    pair: lc_pair,
    pose_a: *const lc_pose,
    pose_b: *const lc_pose,
    wanted: u32,
    out: *mut lc_answer,
    out_size: usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let pose_a = unsafe { Given::one(pose_a, "pose_a") }?;
        // SAFETY: by the caller's contract.
        let pose_b = unsafe { Given::one(pose_b, "pose_b") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Places::new(out, out_size, 1, "out") }?;
        let pose = relative(&pose_a, &pose_b)?;
        PAIRS.with(pair.id, |pair| {
            out.write(0, pair.ask(&pose, wanted));
            Ok(())
        })
    })
}

/// Writes the answers about a pair at `count` pairs of poses, as `lc_pair_ask` does for each.
///
/// A stride is the number of bytes from one element to the next; zero repeats one pose.
/// `out_stride` is also the size of an answer that the caller knows, and all of these bytes are
/// written. The call ends at the first pose that is refused; `done` is the number of answers.
///
/// # Safety
/// The arrays have `count` elements at their strides; `done` points to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_pair_ask_many(
    pair: lc_pair,
    poses_a: *const lc_pose,
    stride_a: usize,
    poses_b: *const lc_pose,
    stride_b: usize,
    count: usize,
    wanted: u32,
    out: *mut lc_answer,
    out_stride: usize,
    done: *mut usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let poses_a = unsafe { Given::new(poses_a, stride_a, count, "poses_a") }?;
        // SAFETY: by the caller's contract.
        let poses_b = unsafe { Given::new(poses_b, stride_b, count, "poses_b") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Places::new(out, out_stride, count, "out") }?;
        // SAFETY: by the caller's contract.
        let done = unsafe { Place::new(done, "done") }?;
        done.write(0);
        PAIRS.with(pair.id, |pair| {
            for k in 0..count {
                let pose = relative(&poses_a.get(k), &poses_b.get(k))?;
                out.write(k, pair.ask(&pose, wanted));
                done.write(k + 1);
            }
            Ok(())
        })
    })
}

/// Writes whether the geometries of a pair are at most `distance` apart: 0 no, 1 yes,
/// `LC_UNDECIDED` unknown. So the answer is zero only if they are proven to be farther apart.
///
/// With a distance of zero: whether they share a point. For a negative distance the answer is no,
/// and NaN is `LC_REFUSED`. Exact for polyhedra and meshes; only a Bézier surface leaves it
/// undecided. For other curved geometries, what the bounds do not decide is yes.
///
/// # Safety
/// `pose_a` and `pose_b` point to poses, `out` to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_pair_within(
    pair: lc_pair,
    pose_a: *const lc_pose,
    pose_b: *const lc_pose,
    distance: f64,
    out: *mut u32,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let pose_a = unsafe { Given::one(pose_a, "pose_a") }?;
        // SAFETY: by the caller's contract.
        let pose_b = unsafe { Given::one(pose_b, "pose_b") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Place::new(out, "out") }?;
        if distance.is_nan() {
            return Err(refused("distance is NaN (expected a number)"));
        }
        let pose = relative(&pose_a, &pose_b)?;
        PAIRS.with(pair.id, |Pair { a, b, tracker }| {
            let decision = tracker.decide_within(&*a, &*b, &pose, distance, &QueryOptions::default());
            out.write(match decision {
                Decision::Yes => 1,
                Decision::No => 0,
                _ => LC_UNDECIDED,
            });
            Ok(())
        })
    })
}

/// Writes the contact points of a pair that are at most `prediction` apart, the deepest group
/// first.
///
/// A group has at most `max_points` points, 1 to 8; zero means 4. `count` is the number of
/// contacts; if it exceeds `capacity`, the first `capacity` are written. Bézier surfaces have no
/// contacts.
///
/// # Safety
/// `pose_a` and `pose_b` point to poses, `out` to `capacity` elements of `out_stride` bytes,
/// `count` to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_pair_contacts(
    pair: lc_pair,
    pose_a: *const lc_pose,
    pose_b: *const lc_pose,
    prediction: f64,
    max_points: u32,
    out: *mut lc_contact,
    out_stride: usize,
    capacity: usize,
    count: *mut usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let pose_a = unsafe { Given::one(pose_a, "pose_a") }?;
        // SAFETY: by the caller's contract.
        let pose_b = unsafe { Given::one(pose_b, "pose_b") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Places::new(out, out_stride, capacity, "out") }?;
        // SAFETY: by the caller's contract.
        let count = unsafe { Place::new(count, "count") }?;
        if !(prediction >= 0.0) || max_points > 8 {
            return Err(refused(format_args!(
                "prediction is {prediction} (expected at least 0), max_points is {max_points} (expected 0..=8)"
            )));
        }
        let most = if max_points == 0 { 4 } else { max_points as usize };
        let options = ManifoldOptions::default().prediction(prediction).max_points(most);
        let pose = relative(&pose_a, &pose_b)?;
        let (world_a, world_b) = pose.poses();
        PAIRS.with(pair.id, |Pair { a, b, tracker }| {
            let groups = tracker.contacts(&*a, &*b, &pose, &options).map_err(refused)?;
            let all = groups.iter().enumerate().flat_map(|(k, group)| {
                group.contacts.iter().map(move |contact| {
                    let ([a0, a1], [b0, b1]) = (feature(contact.point.id.a), feature(contact.point.id.b));
                    lc_contact {
                        point_on_a: (world_a * contact.point.point_on_a).into(),
                        point_on_b: (world_b * contact.point.point_on_b).into(),
                        normal: (world_a * contact.normal).into_inner().into(),
                        separation: contact.point.separation,
                        group: k as u32,
                        patches: contact.patches,
                        reserved: 0,
                        name: [a0, a1, b0, b1],
                    }
                })
            });
            count.write(out.fill(all));
            Ok(())
        })
    })
}

/// Writes bounds of the penetration depth of the geometries of a pair.
///
/// `LC_REFUSED` if one of them has no inside: an open mesh or a Bézier surface. `out_size` is
/// `sizeof(lc_penetration)`.
///
/// # Safety
/// `pose_a` and `pose_b` point to poses, `out` to `out_size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_pair_penetration(
    pair: lc_pair,
    pose_a: *const lc_pose,
    pose_b: *const lc_pose,
    out: *mut lc_penetration,
    out_size: usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let pose_a = unsafe { Given::one(pose_a, "pose_a") }?;
        // SAFETY: by the caller's contract.
        let pose_b = unsafe { Given::one(pose_b, "pose_b") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Places::new(out, out_size, 1, "out") }?;
        let pose = relative(&pose_a, &pose_b)?;
        PAIRS.with(pair.id, |Pair { a, b, tracker }| {
            let Some(bounds) = tracker.penetration(&*a, &*b, &pose) else {
                let message = "one of the geometries has no inside (an open mesh or a Bézier surface)";
                return Err(refused(message));
            };
            let answer = lc_penetration {
                lower: bounds.lower,
                upper: bounds.upper,
                shift: (pose.poses().0.rotation * bounds.shift).into(),
            };
            out.write(0, answer);
            Ok(())
        })
    })
}

/// Writes bounds of the volume that the geometries of a pair share.
///
/// `LC_REFUSED` if one of them is no polyhedron, no closed mesh and no union of polyhedra that do
/// not overlap each other. `out_size` is `sizeof(lc_overlap_volume)`.
///
/// # Safety
/// `pose_a` and `pose_b` point to poses, `out` to `out_size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_pair_overlap(
    pair: lc_pair,
    pose_a: *const lc_pose,
    pose_b: *const lc_pose,
    out: *mut lc_overlap_volume,
    out_size: usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let pose_a = unsafe { Given::one(pose_a, "pose_a") }?;
        // SAFETY: by the caller's contract.
        let pose_b = unsafe { Given::one(pose_b, "pose_b") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Places::new(out, out_size, 1, "out") }?;
        let pose = relative(&pose_a, &pose_b)?;
        PAIRS.with(pair.id, |Pair { a, b, tracker }| {
            let found = tracker.overlap(&*a, &*b, &pose).map_err(refused)?;
            let centroid = found.centroid.map(|c| pose.poses().0 * c);
            let answer = lc_overlap_volume {
                lower: found.lower,
                upper: found.upper,
                centroid: centroid.map_or([f64::NAN; 3], Into::into),
                centroid_error: found.centroid_error,
                covers_itself: found.covers_itself.into(),
                reserved: 0,
            };
            out.write(0, answer);
            Ok(())
        })
    })
}

fn steady(motion: &lc_motion) -> Result<Steady, lc_status> {
    Steady::new(&isometry(&motion.pose), velocity(motion.linear, motion.angular)).map_err(refused)
}

/// Writes when two moving geometries first touch, or come within the distance of the options.
///
/// `options_size` is `sizeof(lc_cast_options)`, `out_size` is `sizeof(lc_cast)`.
///
/// # Safety
/// `motion_a` and `motion_b` point to motions, `options` to `options_size` bytes, `out` to
/// `out_size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_pair_cast(
    pair: lc_pair,
    motion_a: *const lc_motion,
    motion_b: *const lc_motion,
    options: *const lc_cast_options,
    options_size: usize,
    out: *mut lc_cast,
    out_size: usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let motion_a = steady(&unsafe { Given::one(motion_a, "motion_a") }?)?;
        // SAFETY: by the caller's contract.
        let motion_b = steady(&unsafe { Given::one(motion_b, "motion_b") }?)?;
        // SAFETY: by the caller's contract.
        let given = unsafe { self::options(options, options_size, "options") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Places::new(out, out_size, 1, "out") }?;
        let mut options = CastOptions::default()
            .tolerance(Tolerance::Distance(given.tolerance))
            .distance(given.distance);
        options.start_contact_margin = (given.flags & LC_ACCEPT_START != 0).then_some(given.start_contact_margin);
        let found = PAIRS.with(pair.id, |Pair { a, b, tracker }| {
            let (bodies, times) = ([(&*a).into(), (&*b).into()], 0.0..given.duration);
            tracker
                .cast_from_contact(bodies, &motion_a, &motion_b, times, &options, None)
                .map_err(refused)
        })?;
        let (state, safe, hit, seen) = match &found.impact {
            Impact::Miss => (LC_MISS, given.duration, f64::INFINITY, None),
            Impact::AtStart { seen } => (LC_AT_START, 0.0, 0.0, Some(seen)),
            Impact::Hit { safe, hit, seen } => (LC_HIT, *safe, *hit, Some(seen)),
            Impact::Undecided { safe, .. } => (LC_UNCLEAR, *safe, f64::INFINITY, None),
            Impact::Incomplete { safe } => (LC_INCOMPLETE, *safe, f64::INFINITY, None),
            _ => (LC_INCOMPLETE, 0.0, f64::INFINITY, None),
        };
        let mut answer = lc_cast {
            state,
            queries: found.queries,
            safe,
            hit,
            point_on_a: [0.0; 3],
            point_on_b: [0.0; 3],
            normal: [0.0; 3],
            start_accepted: 0,
            reserved: 0,
            start_distance: 0.0,
            start_kept: 0.0,
            start_until: 0.0,
        };
        if let Some(seen) = seen {
            let (pose_a, pose_b) = (motion_a.pose(safe), motion_b.pose(safe));
            answer.point_on_a = (pose_a * seen.point_on_a).into();
            answer.point_on_b = (pose_b * seen.point_on_b).into();
            answer.normal = (pose_a * seen.normal).into_inner().into();
        }
        if let Some(start) = found.start_contact {
            answer.start_accepted = 1;
            answer.start_distance = start.distance;
            answer.start_kept = start.kept;
            answer.start_until = start.until.unwrap_or(f64::INFINITY);
        }
        out.write(0, answer);
        Ok(())
    })
}

/// Writes the next query of a pair of convex polyhedra as a text that repeats it bit for bit.
///
/// `lc_text_free` frees the text. Attach it to a report of a wrong answer. `LC_REFUSED` for other
/// kinds.
///
/// # Safety
/// `pose_a` and `pose_b` point to poses, `out` to a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_pair_replay(
    pair: lc_pair,
    pose_a: *const lc_pose,
    pose_b: *const lc_pose,
    out: *mut *mut c_char,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let pose_a = unsafe { Given::one(pose_a, "pose_a") }?;
        // SAFETY: by the caller's contract.
        let pose_b = unsafe { Given::one(pose_b, "pose_b") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Place::new(out, "out") }?;
        let pose = relative(&pose_a, &pose_b)?;
        let replay = PAIRS.with(pair.id, |Pair { a, b, tracker }| {
            let replay = tracker.replay(&*a, &*b, &pose);
            replay.ok_or_else(|| refused(format_args!("no replay of a {} and a {}", a.kind(), b.kind())))
        })?;
        out.write_text(replay)
    })
}

/// Writes the answer of a text of `lc_pair_replay`, as `lc_pair_ask` does.
///
/// # Safety
/// `replay` points to a text that ends with a zero, `out` to `out_size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_replay_answer(
    replay: *const c_char,
    wanted: u32,
    out: *mut lc_answer,
    out_size: usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let replay = unsafe { text(replay, "replay") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Places::new(out, out_size, 1, "out") }?;
        let replay: Replay = replay.parse().map_err(refused)?;
        let pose = replay.pose;
        let [a, b] = replay.shapes();
        let mut tracker = replay.pair_tracker();
        let found = tracker.closest_with(&a, &b, &pose, &query(wanted));
        out.write(0, answer(&found, &pose, wanted));
        Ok(())
    })
}

pub(crate) fn ray(ray: &lc_ray) -> Result<Ray, lc_status> {
    Ray::new(Point3::from(ray.origin), Vector3::from(ray.direction)).map_err(refused)
}

pub(crate) fn ray_hit(found: &RayCast, body: u64) -> lc_ray_hit {
    let (state, safe, hit) = match found {
        RayCast::Miss => (LC_MISS, f64::INFINITY, f64::INFINITY),
        RayCast::Inside => (LC_AT_START, 0.0, 0.0),
        RayCast::Hit(hit) => (LC_HIT, hit.safe, hit.hit),
        _ => (LC_UNCLEAR, found.safe().unwrap_or(0.0), f64::INFINITY),
    };
    let mut answer = lc_ray_hit {
        state,
        subshape: 0,
        body,
        safe,
        hit,
        point: [0.0; 3],
        normal: [0.0; 3],
    };
    if let RayCast::Hit(hit) = found {
        answer.subshape = hit.subshape;
        answer.point = hit.point.into();
        answer.normal = hit.normal.into_inner().into();
    }
    answer
}

/// Writes where `count` rays enter a geometry at a pose; neighbouring rays are fastest one after
/// another.
///
/// A ray that meets a Bézier surface is `LC_UNCLEAR`. The call ends at the first ray that is
/// refused; `done` is the number of answers.
///
/// # Safety
/// `pose` points to a pose, `rays` to `count` rays, `out` to `count` elements of `out_stride`
/// bytes, `done` to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_ray_cast_many(
    geometry: lc_geometry,
    pose: *const lc_pose,
    rays: *const lc_ray,
    count: usize,
    out: *mut lc_ray_hit,
    out_stride: usize,
    done: *mut usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let pose = unsafe { Given::one(pose, "pose") }?;
        // SAFETY: by the caller's contract.
        let rays = unsafe { Given::new(rays, size_of::<lc_ray>(), count, "rays") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Places::new(out, out_stride, count, "out") }?;
        // SAFETY: by the caller's contract.
        let done = unsafe { Place::new(done, "done") }?;
        done.write(0);
        let (geometry, pose) = (shared(geometry)?, isometry(&pose));
        let mut caster = RayCaster::new();
        for k in 0..count {
            let given = rays.get(k);
            let found = caster
                .cast(&geometry, &pose, &ray(&given)?, given.length)
                .map_err(refused)?;
            out.write(k, ray_hit(&found, 0));
            done.write(k + 1);
        }
        Ok(())
    })
}

/// Panics while the pair is in use.
#[cfg(feature = "testing")]
#[unsafe(no_mangle)]
pub extern "C" fn lc_test_panic(pair: lc_pair) -> lc_status {
    guarded(|| PAIRS.with(pair.id, |_| -> Result<(), lc_status> { panic!("a provoked panic") }))
}

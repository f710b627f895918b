//! Scenes of many bodies.

use lin_canny::impact::{Impact, Tolerance};
use lin_canny::nalgebra::Isometry3;
use lin_canny::scene::{Body, BodyId, Change, ClosestPair, Group, PairQueries, PairResults, Scene};
use lin_canny::{Outcome, RelativePose};

use crate::border::{Status, guarded, lc_status, refused};
use crate::geometry::{lc_geometry, shared};
use crate::memory::{Given, Place, Places, Plain, array, options};
use crate::pair::{
    LC_DISTANCE, LC_FEATURES, LC_HIT, LC_INCOMPLETE, LC_POINTS, LC_UNCLEAR, NOTHING, lc_answer, lc_ray, lc_ray_hit,
    ray, ray_hit,
};
use crate::pose::{feature, isometry, lc_pose, pose_of, state, velocity};
use crate::table::{Changing, Table, Watched, lost};

/// A scene: bodies of which a step finds the close pairs and runs the enabled queries.
///
/// One call at a time: a call during another one returns `LC_BUSY`. Any thread.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct lc_scene {
    /// The handle; zero is none.
    pub id: u64,
}

/// A body of a scene; valid in its scene until it is removed.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct lc_body {
    /// The id; zero is none.
    pub id: u64,
}

/// Events of the boxes of bodies.
pub const LC_QUERY_BOXES: u32 = 1;
/// Whether bodies share a point, and events of that.
pub const LC_QUERY_OVERLAP: u32 = 2;
/// Whether bodies are at most `within` apart, and events of that.
pub const LC_QUERY_WITHIN: u32 = 4;
/// The signed distance of bodies at most `distance` apart.
pub const LC_QUERY_DISTANCE: u32 = 8;
/// Witness points, normal and features of the pairs that have a distance.
pub const LC_QUERY_FEATURES: u32 = 16;
/// The depth of overlaps of convex bodies.
pub const LC_QUERY_DEPTH: u32 = 32;
/// First contacts between two steps of bodies that `lc_scene_advance` moves, in a bracket of the
/// width `impact`.
pub const LC_QUERY_IMPACT: u32 = 64;
/// The first times between two steps at which bodies come within the distance `impact_within`, in a
/// bracket of the width `impact`.
pub const LC_QUERY_IMPACT_WITHIN: u32 = 128;
/// Pairs of two fixed bodies as well, for instance the parts of an assembly. Without it such pairs
/// are left out.
pub const LC_QUERY_FIXED: u32 = 256;

/// The queries of the pairs of two groups; all zero is none.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lc_queries {
    /// A mask of `LC_QUERY_BOXES` and so on.
    pub flags: u32,
    /// Zero.
    pub reserved: u32,
    /// The distance of `LC_QUERY_WITHIN`.
    pub within: f64,
    /// The range of `LC_QUERY_DISTANCE`; may be infinite.
    pub distance: f64,
    /// The width of the brackets of `LC_QUERY_IMPACT` and `LC_QUERY_IMPACT_WITHIN`, as a distance:
    /// at the end of the free interval the bodies are at most this far from contact, or from the
    /// distance.
    pub impact: f64,
    /// The distance of `LC_QUERY_IMPACT_WITHIN`.
    pub impact_within: f64,
}

// SAFETY: numbers only.
unsafe impl Plain for lc_queries {
    const FIRST: usize = 32;
}

/// The boxes of two bodies started to overlap.
pub const LC_BOXES_MET: u32 = 1;
/// Two bodies started to share a point.
pub const LC_OVERLAP_BEGAN: u32 = 2;
/// Two bodies came within the distance of the query.
pub const LC_CAME_WITHIN: u32 = 3;
/// Two bodies left the distance of the query.
pub const LC_LEFT_WITHIN: u32 = 4;
/// Two bodies stopped sharing a point.
pub const LC_OVERLAP_ENDED: u32 = 5;
/// The boxes of two bodies stopped overlapping.
pub const LC_BOXES_PARTED: u32 = 6;

/// A change of a pair in the last step.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lc_event {
    /// The body with the lower index.
    pub a: lc_body,
    /// The body with the higher index.
    pub b: lc_body,
    /// `LC_BOXES_MET` and so on; zero is another change.
    pub change: u32,
    /// Zero.
    pub reserved: u32,
}

// SAFETY: numbers only.
unsafe impl Plain for lc_event {
    const FIRST: usize = 24;
}

/// The first contact of two bodies in the time of the last `lc_scene_advance`, or the first time
/// within a distance.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lc_impact {
    /// The body with the lower index.
    pub a: lc_body,
    /// The body with the higher index.
    pub b: lc_body,
    /// `LC_HIT`, `LC_UNCLEAR` or `LC_INCOMPLETE`.
    pub state: u32,
    /// Zero.
    pub reserved: u32,
    /// The bodies are proven apart up to this time, or farther apart than `distance`.
    pub safe: f64,
    /// The bodies are proven in contact at this time, or within `distance`; infinite without a proof.
    pub hit: f64,
    /// The distance of `LC_QUERY_IMPACT_WITHIN`; zero for a contact.
    pub distance: f64,
}

// SAFETY: numbers only.
unsafe impl Plain for lc_impact {
    const FIRST: usize = 40;
}

/// The query is not enabled, or was not answered yet: nothing is known. It is not zero, as zero is a
/// proof that the answer is no.
pub const LC_NOT_ASKED: u32 = 2;

/// Two bodies of a scene and the answers about them. Points and normal are in the world.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lc_scene_pair {
    /// The first body: operand A of the answer; zero if there is no pair.
    pub a: lc_body,
    /// The second body.
    pub b: lc_body,
    /// Whether the bodies share a point: 0 no, 1 yes, `LC_NOT_ASKED`.
    pub overlaps: u32,
    /// Whether the bodies are within the distance of the query: 0 no, 1 yes, `LC_NOT_ASKED`.
    pub within: u32,
    /// The distance, and points if the query enables features: see `answered`.
    pub answer: lc_answer,
}

// SAFETY: numbers only.
unsafe impl Plain for lc_scene_pair {
    const FIRST: usize = 152;
}

pub(crate) struct SceneObject(Scene);

impl Changing for SceneObject {
    fn recover(&mut self) -> Status {
        Err(lost("scene"))
    }
}

static SCENES: Table<Watched<SceneObject>> = Table::new(3, "scene");

pub(crate) fn live() -> usize {
    SCENES.live()
}

fn with<R>(scene: lc_scene, call: impl FnOnce(&mut Scene) -> Result<R, lc_status>) -> Result<R, lc_status> {
    SCENES.with(scene.id, |scene| call(&mut scene.0))
}

fn number(id: BodyId) -> lc_body {
    lc_body {
        id: u64::from(id.generation) << 32 | u64::from(id.index),
    }
}

fn body(body: lc_body) -> BodyId {
    BodyId {
        index: body.id as u32,
        generation: (body.id >> 32) as u32,
    }
}

fn group(number: u32) -> Result<Group, lc_status> {
    let group = u8::try_from(number).ok().and_then(Group::new);
    group.ok_or_else(|| refused(format_args!("group is out of range: {number} (expected 0..=31)")))
}

/// Makes a scene without bodies and queries.
///
/// # Safety
/// `out` points to a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_scene_new(out: *mut lc_scene) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let out = unsafe { Place::new(out, "out") }?;
        let id = SCENES.add(SceneObject(Scene::new()))?;
        out.write(lc_scene { id });
        Ok(())
    })
}

/// Frees a scene; zero is no error. `LC_BUSY` during a call with it: then nothing is freed.
#[unsafe(no_mangle)]
pub extern "C" fn lc_scene_free(scene: lc_scene) -> lc_status {
    guarded(|| SCENES.free(scene.id))
}

/// Sets the queries of the pairs of two groups, 0 to 31, or of one group if both are equal.
///
/// `queries_size` is `sizeof(lc_queries)`. Without queries nothing is computed.
///
/// # Safety
/// `queries` is null or points to `queries_size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_scene_set_queries(
    scene: lc_scene,
    group_a: u32,
    group_b: u32,
    queries: *const lc_queries,
    queries_size: usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let given = unsafe { options(queries, queries_size, "queries") }?;
        let is = |flag: u32| given.flags & flag != 0;
        let mut queries = PairQueries::none()
            .boxes(is(LC_QUERY_BOXES))
            .overlap(is(LC_QUERY_OVERLAP))
            .features(is(LC_QUERY_FEATURES))
            .depth(is(LC_QUERY_DEPTH))
            .fixed(is(LC_QUERY_FIXED));
        queries.within = is(LC_QUERY_WITHIN).then_some(given.within);
        queries.distance = is(LC_QUERY_DISTANCE).then_some(given.distance);
        let width = Tolerance::Distance(given.impact);
        queries.impact = is(LC_QUERY_IMPACT).then_some(width);
        queries.impact_within = is(LC_QUERY_IMPACT_WITHIN).then_some((given.impact_within, width));
        let (a, b) = (group(group_a)?, group(group_b)?);
        with(scene, |scene| scene.set_queries(a, b, queries).map_err(refused))
    })
}

/// Adds a body of a group at a pose. With `fixed` not zero the body is fixed: two fixed bodies are
/// tested only with `LC_QUERY_FIXED`.
///
/// # Safety
/// `pose` points to a pose, `out` to an id.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_scene_add(
    scene: lc_scene,
    geometry: lc_geometry,
    pose: *const lc_pose,
    group: u32,
    fixed: u32,
    out: *mut lc_body,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let pose = unsafe { Given::one(pose, "pose") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Place::new(out, "out") }?;
        let geometry = shared(geometry)?;
        let new = match fixed {
            0 => Body::moving(geometry),
            _ => Body::fixed(geometry),
        };
        let new = new.group(self::group(group)?);
        let id = with(scene, |scene| scene.insert(new, isometry(&pose)).map_err(refused))?;
        out.write(number(id));
        Ok(())
    })
}

/// Removes a body.
#[unsafe(no_mangle)]
pub extern "C" fn lc_scene_remove(scene: lc_scene, body: lc_body) -> lc_status {
    guarded(|| with(scene, |scene| scene.remove(self::body(body)).map_err(refused)))
}

/// Moves `count` bodies to their poses. `stride` is the number of bytes from one pose to the next.
///
/// The call ends at the first body or pose that is refused; those before it have moved.
///
/// # Safety
/// `bodies` points to `count` ids, `poses` to `count` poses at the stride.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_scene_set_poses(
    scene: lc_scene,
    bodies: *const lc_body,
    poses: *const lc_pose,
    stride: usize,
    count: usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let bodies = unsafe { array(bodies, count, "bodies") }?;
        // SAFETY: by the caller's contract.
        let poses = unsafe { Given::new(poses, stride, count, "poses") }?;
        with(scene, |scene| {
            for (k, id) in bodies.iter().enumerate() {
                scene.set_pose(body(*id), isometry(&poses.get(k))).map_err(refused)?;
            }
            Ok(())
        })
    })
}

/// Writes the pose of a body.
///
/// # Safety
/// `out` points to a pose.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_scene_pose(scene: lc_scene, body: lc_body, out: *mut lc_pose) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let out = unsafe { Place::new(out, "out") }?;
        with(scene, |scene| {
            let id = self::body(body);
            let pose = scene
                .pose(id)
                .ok_or_else(|| refused(format_args!("{id} does not exist in this scene, or was removed")))?;
            out.write(pose_of(pose));
            Ok(())
        })
    })
}

/// Sets the velocity of a body: linear, then angular, about the origin of the geometry, in the
/// world.
///
/// # Safety
/// `linear` and `angular` point to three numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_scene_set_velocity(
    scene: lc_scene,
    body: lc_body,
    linear: *const f64,
    angular: *const f64,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let linear: [f64; 3] = unsafe { Given::one(linear.cast(), "linear") }?;
        // SAFETY: by the caller's contract.
        let angular: [f64; 3] = unsafe { Given::one(angular.cast(), "angular") }?;
        with(scene, |scene| {
            let velocity = velocity(linear, angular);
            scene.set_velocity(self::body(body), velocity).map_err(refused)
        })
    })
}

/// Excludes a pair of bodies from all queries, or includes it again if `excluded` is zero.
#[unsafe(no_mangle)]
pub extern "C" fn lc_scene_exclude(scene: lc_scene, a: lc_body, b: lc_body, excluded: u32) -> lc_status {
    guarded(|| {
        with(scene, |scene| {
            let done = match excluded {
                0 => scene.include_pair(body(a), body(b)),
                _ => scene.exclude_pair(body(a), body(b)),
            };
            done.map_err(refused)
        })
    })
}

/// Moves all bodies by their velocities over a time. Call `lc_scene_step` afterwards for the
/// answers.
#[unsafe(no_mangle)]
pub extern "C" fn lc_scene_advance(scene: lc_scene, time: f64) -> lc_status {
    guarded(|| with(scene, |scene| scene.advance(time).map_err(refused)))
}

/// Applies all changes and runs the enabled queries.
#[unsafe(no_mangle)]
pub extern "C" fn lc_scene_step(scene: lc_scene) -> lc_status {
    guarded(|| {
        with(scene, |scene| {
            scene.step();
            Ok(())
        })
    })
}

/// Writes the events of the last step. If there are more than `capacity`, the first are written;
/// `count` is their number.
///
/// # Safety
/// `out` points to `capacity` elements of `out_stride` bytes, `count` to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_scene_events(
    scene: lc_scene,
    out: *mut lc_event,
    out_stride: usize,
    capacity: usize,
    count: *mut usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let out = unsafe { Places::new(out, out_stride, capacity, "out") }?;
        // SAFETY: by the caller's contract.
        let count = unsafe { Place::new(count, "count") }?;
        with(scene, |scene| {
            let events = scene.events().iter().map(|event| lc_event {
                a: number(event.a),
                b: number(event.b),
                change: match event.change {
                    Change::BoxesMet => LC_BOXES_MET,
                    Change::OverlapBegan => LC_OVERLAP_BEGAN,
                    Change::CameWithin => LC_CAME_WITHIN,
                    Change::LeftWithin => LC_LEFT_WITHIN,
                    Change::OverlapEnded => LC_OVERLAP_ENDED,
                    Change::BoxesParted => LC_BOXES_PARTED,
                    _ => 0,
                },
                reserved: 0,
            });
            count.write(out.fill(events));
            Ok(())
        })
    })
}

/// Writes the first contacts in the time of the last `lc_scene_advance`, as `lc_scene_events` does.
///
/// # Safety
/// As for `lc_scene_events`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_scene_impacts(
    scene: lc_scene,
    out: *mut lc_impact,
    out_stride: usize,
    capacity: usize,
    count: *mut usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let out = unsafe { Places::new(out, out_stride, capacity, "out") }?;
        // SAFETY: by the caller's contract.
        let count = unsafe { Place::new(count, "count") }?;
        with(scene, |scene| {
            let impacts = scene.impacts().iter().map(|found| {
                let (state, hit) = match found.impact {
                    Impact::Hit { hit, .. } => (LC_HIT, hit),
                    Impact::Undecided { .. } => (LC_UNCLEAR, f64::INFINITY),
                    _ => (LC_INCOMPLETE, f64::INFINITY),
                };
                lc_impact {
                    a: number(found.a),
                    b: number(found.b),
                    state,
                    reserved: 0,
                    safe: found.safe(),
                    hit,
                    distance: found.distance,
                }
            });
            count.write(out.fill(impacts));
            Ok(())
        })
    })
}

/// Returns the answer of an outcome of two bodies, in the world.
fn answer(found: &Outcome, subshapes: [u32; 2], poses: [&Isometry3<f64>; 2]) -> Result<lc_answer, lc_status> {
    let pose = RelativePose::new(poses[0], poses[1]).map_err(refused)?;
    let world = found.in_world(&pose);
    Ok(lc_answer {
        answered: LC_DISTANCE | LC_POINTS | LC_FEATURES,
        state: state(found.state),
        distance: found.distance,
        lower: found.lower,
        upper: found.upper,
        point_on_a: world.point_on_a.into(),
        point_on_b: world.point_on_b.into(),
        normal: world.normal.into_inner().into(),
        feature_a: feature(found.features.a),
        feature_b: feature(found.features.b),
        subshapes,
    })
}

/// Returns the poses of two bodies.
fn poses(scene: &Scene, a: BodyId, b: BodyId) -> Result<[&Isometry3<f64>; 2], lc_status> {
    match (scene.pose(a), scene.pose(b)) {
        (Some(a), Some(b)) => Ok([a, b]),
        _ => Err(refused("a body was removed after the last step")),
    }
}

fn asked(answer: Option<bool>) -> u32 {
    answer.map_or(LC_NOT_ASKED, u32::from)
}

fn results(scene: &Scene, pair: &PairResults<'_>) -> Result<lc_scene_pair, lc_status> {
    let answer = match (pair.outcome, pair.distance) {
        (Some(outcome), _) => answer(outcome, pair.subshapes.unwrap_or([0; 2]), poses(scene, pair.a, pair.b)?)?,
        (None, Some(distance)) => lc_answer {
            answered: LC_DISTANCE,
            state: state(distance.state),
            distance: distance.value,
            lower: distance.lower,
            upper: distance.upper,
            ..NOTHING
        },
        _ => NOTHING,
    };
    Ok(lc_scene_pair {
        a: number(pair.a),
        b: number(pair.b),
        overlaps: asked(pair.overlaps),
        within: asked(pair.within),
        answer,
    })
}

/// Writes the pairs whose boxes overlap, with the answers of the last step, as `lc_scene_events`
/// does.
///
/// Points are in the world if no pose was set since the last step. `LC_REFUSED` if a body of a
/// pair with points was removed since then.
///
/// # Safety
/// As for `lc_scene_events`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_scene_pairs(
    scene: lc_scene,
    out: *mut lc_scene_pair,
    out_stride: usize,
    capacity: usize,
    count: *mut usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let out = unsafe { Places::new(out, out_stride, capacity, "out") }?;
        // SAFETY: by the caller's contract.
        let count = unsafe { Place::new(count, "count") }?;
        with(scene, |scene| {
            let scene: &Scene = scene;
            // All are made before one is written: an error writes no answer.
            let first = scene.pairs().take(capacity).map(|pair| results(scene, &pair));
            let first = first.collect::<Result<Vec<_>, _>>()?;
            out.fill(first.into_iter());
            count.write(scene.pair_count());
            Ok(())
        })
    })
}

/// Writes the pair of least signed distance of two groups at the last step, at any distance.
///
/// If there is no pair, `out->a` is zero. At least one query of the groups must be set. `out_size`
/// is `sizeof(lc_scene_pair)`.
///
/// # Safety
/// `out` points to `out_size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_scene_closest_pair(
    scene: lc_scene,
    group_a: u32,
    group_b: u32,
    out: *mut lc_scene_pair,
    out_size: usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let out = unsafe { Places::new(out, out_size, 1, "out") }?;
        let (a, b) = (group(group_a)?, group(group_b)?);
        with(scene, |scene| {
            let found = scene.closest_pair(a, b).map_err(refused)?;
            out.write(0, closest(scene, found)?);
            Ok(())
        })
    })
}

fn closest(scene: &Scene, found: Option<ClosestPair>) -> Result<lc_scene_pair, lc_status> {
    let none = lc_scene_pair {
        a: lc_body { id: 0 },
        b: lc_body { id: 0 },
        overlaps: LC_NOT_ASKED,
        within: LC_NOT_ASKED,
        answer: NOTHING,
    };
    let Some(found) = found else { return Ok(none) };
    let answer = answer(&found.outcome, found.subshapes, poses(scene, found.a, found.b)?)?;
    Ok(lc_scene_pair {
        a: number(found.a),
        b: number(found.b),
        answer,
        ..none
    })
}

/// Writes the first body that a ray enters, among the bodies of the groups of a mask: bit g stands
/// for group g.
///
/// `out_size` is `sizeof(lc_ray_hit)`.
///
/// # Safety
/// `ray` points to a ray, `out` to `out_size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_scene_cast_ray(
    scene: lc_scene,
    ray: *const lc_ray,
    groups: u32,
    out: *mut lc_ray_hit,
    out_size: usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let given = unsafe { Given::one(ray, "ray") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Places::new(out, out_size, 1, "out") }?;
        let ray = self::ray(&given)?;
        with(scene, |scene| {
            let is_member = |id| scene.group(id).is_some_and(|group| groups >> group.number() & 1 == 1);
            let found = scene.cast_ray(&ray, given.length, is_member).map_err(refused)?;
            let answer = match found {
                Some((id, cast)) => ray_hit(&cast, number(id).id),
                None => ray_hit(&lin_canny::RayCast::Miss, 0),
            };
            out.write(0, answer);
            Ok(())
        })
    })
}

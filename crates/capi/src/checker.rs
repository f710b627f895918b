//! Checkers of one rigid body or of a robot: clearances, proven motions and paths.

use std::ffi::{c_char, c_void};

use lin_canny::nalgebra::UnitQuaternion;
use lin_canny_plan::{
    Cell, Checker, ConfigurationSpace, JointCurve, JointMotion, JointTree, Path, PlanError, PlanMethod, PlanOptions,
    RigidSpace, Shortcuts, TranslationSpace,
};

use crate::border::{Status, bad_argument, error, guarded, lc_status, refused};
use crate::cell::{NO_PAIR, id, lc_check_work, lc_near, lc_verdict, lc_world_body, near, number, verdict, work};
use crate::geometry::{lc_geometry, shared};
use crate::memory::{Given, Place, Places, Plain, array, options, table, text, written};
use crate::pose::{isometry, lc_pose, pose_of};
use crate::progress::{Reporter, lc_progress};
use crate::table::{Changing, Table, Watched, lost};

/// A checker of a robot, or of one rigid body, among obstacles.
///
/// One call at a time: a call during another one returns `LC_BUSY`. Any thread; `lc_checker_copy`
/// makes one for another thread.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct lc_checker {
    /// The handle; zero is none.
    pub id: u64,
}

/// The sizes of a checker.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lc_checker_info {
    /// The numbers of a configuration.
    pub coordinates: usize,
    /// The numbers of a gradient. It is one less than `coordinates` for a body that turns.
    pub degrees_of_freedom: usize,
    /// The bodies of the robot.
    pub robot_bodies: usize,
    /// The distance that pairs without a margin of their own must keep.
    pub margin: f64,
}

// SAFETY: numbers only.
unsafe impl Plain for lc_checker_info {
    const FIRST: usize = 3 * size_of::<usize>() + 8;
}

/// RRT-Connect (Kuffner and LaValle 2000).
pub const LC_PLAN_RRT_CONNECT: u32 = 0;
/// The opportunistic planner (Canny and Lin 1993).
pub const LC_PLAN_OPPORTUNISTIC: u32 = 1;

/// Options of a search for a path; all zero is the default.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lc_plan_options {
    /// The random seed; the same seed gives the same path.
    pub seed: u64,
    /// The largest number of random slices of the opportunistic planner; zero is 10,000.
    pub slices: u64,
    /// The largest number of pair queries; zero is 1,000,000.
    pub queries: u64,
    /// The number of random shortcuts that are tried. Configurations without which the path is
    /// proven free and not longer are removed in any case.
    pub shorten: u64,
    /// The largest number of samples of RRT-Connect; zero is 100,000.
    pub samples: u64,
    /// `LC_PLAN_RRT_CONNECT` or `LC_PLAN_OPPORTUNISTIC`.
    pub method: u32,
    /// Zero.
    pub reserved: u32,
}

// SAFETY: numbers only.
unsafe impl Plain for lc_plan_options {
    const FIRST: usize = 32;
}

/// A checker of one of the spaces.
pub(crate) enum AnyChecker {
    Tree(Checker<JointTree>),
    Rigid(Checker<RigidSpace>),
    Translation(Checker<TranslationSpace>),
}

/// Runs a call with the checker of any space.
macro_rules! each {
    ($any:expr, $checker:ident => $call:expr) => {
        match $any {
            AnyChecker::Tree($checker) => $call,
            AnyChecker::Rigid($checker) => $call,
            AnyChecker::Translation($checker) => $call,
        }
    };
}

pub(crate) struct CheckerObject {
    checker: AnyChecker,
    /// Names of the coordinates.
    names: Vec<String>,
    /// The path of the last search.
    path: Path,
}

impl Changing for CheckerObject {
    fn recover(&mut self) -> Status {
        Err(lost("checker"))
    }
}

static CHECKERS: Table<Watched<CheckerObject>> = Table::new(4, "checker");

pub(crate) fn live() -> usize {
    CHECKERS.live()
}

pub(crate) fn give(out: Place<'_, lc_checker>, checker: AnyChecker, names: Vec<String>) -> Status {
    let path = Path::new();
    let id = CHECKERS.add(CheckerObject { checker, names, path })?;
    out.write(lc_checker { id });
    Ok(())
}

/// Returns a new checker of the same space and world.
fn copy<C: ConfigurationSpace + Clone>(checker: &Checker<C>) -> Result<Checker<C>, PlanError> {
    let mut new = Checker::new(checker.space().clone(), checker.cell().clone())?;
    new.set_start_contact_margin(checker.start_contact_margin())?;
    if let Some(time) = checker.time() {
        new.set_time(time)?;
    }
    Ok(new)
}

impl CheckerObject {
    fn coordinates(&self) -> usize {
        each!(&self.checker, c => c.space().coordinates())
    }

    fn degrees_of_freedom(&self) -> usize {
        each!(&self.checker, c => c.space().degrees_of_freedom())
    }

    fn cell(&self) -> &Cell {
        each!(&self.checker, c => c.cell())
    }

    /// Returns an error unless configurations have this many coordinates.
    fn check(&self, coordinates: usize) -> Status {
        let expected = self.coordinates();
        if coordinates != expected {
            let message = format_args!("a configuration has {coordinates} numbers (expected {expected})");
            return Err(error(lc_status::LC_ARGUMENT, &message));
        }
        Ok(())
    }
}

fn with<R>(checker: lc_checker, call: impl FnOnce(&mut CheckerObject) -> Result<R, lc_status>) -> Result<R, lc_status> {
    CHECKERS.with(checker.id, call)
}

/// Makes the checker of one body that moves in a box of space: least and greatest x, then y, then
/// z.
///
/// With `radius` zero the body does not turn: a configuration is x, y, z. With a positive radius it
/// turns: a configuration is x, y, z and a unit quaternion x, y, z, w, and a radian counts as the
/// length `radius`.
///
/// # Safety
/// `bounds` points to six numbers, `out` to a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_checker_new_body(
    body: lc_geometry,
    bounds: *const f64,
    radius: f64,
    out: *mut lc_checker,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract; six numbers are aligned as one.
        let bounds: [[f64; 2]; 3] = unsafe { Given::one(bounds.cast(), "bounds") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Place::new(out, "out") }?;
        let mut cell = Cell::new();
        cell.robot_body("body", shared(body)?);
        let (checker, names): (_, &[&str]) = if radius == 0.0 {
            let space = TranslationSpace::new(bounds, UnitQuaternion::identity(), 1).map_err(refused)?;
            let checker = Checker::new(space, cell).map_err(refused)?;
            (AnyChecker::Translation(checker), &["x", "y", "z"])
        } else {
            let space = RigidSpace::new(bounds, radius, 1).map_err(refused)?;
            let checker = Checker::new(space, cell).map_err(refused)?;
            (AnyChecker::Rigid(checker), &["x", "y", "z", "qx", "qy", "qz", "qw"])
        };
        give(out, checker, names.iter().map(ToString::to_string).collect())
    })
}

/// Makes another checker of the same robot and world, with new state: one for each thread.
///
/// # Safety
/// `out` points to a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_checker_copy(checker: lc_checker, out: *mut lc_checker) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let out = unsafe { Place::new(out, "out") }?;
        let (checker, names) = with(checker, |object| {
            let new = match &object.checker {
                AnyChecker::Tree(c) => copy(c).map(AnyChecker::Tree),
                AnyChecker::Rigid(c) => copy(c).map(AnyChecker::Rigid),
                AnyChecker::Translation(c) => copy(c).map(AnyChecker::Translation),
            };
            Ok((new.map_err(refused)?, object.names.clone()))
        })?;
        give(out, checker, names)
    })
}

/// Frees a checker; zero is no error. `LC_BUSY` during a call with it: then nothing is freed.
#[unsafe(no_mangle)]
pub extern "C" fn lc_checker_free(checker: lc_checker) -> lc_status {
    guarded(|| CHECKERS.free(checker.id))
}

/// Writes the sizes of a checker; `out_size` is `sizeof(lc_checker_info)`.
///
/// # Safety
/// `out` points to `out_size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_checker_get_info(
    checker: lc_checker,
    out: *mut lc_checker_info,
    out_size: usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let out = unsafe { Places::new(out, out_size, 1, "out") }?;
        with(checker, |object| {
            let info = lc_checker_info {
                coordinates: object.coordinates(),
                degrees_of_freedom: object.degrees_of_freedom(),
                robot_bodies: object.cell().robot_bodies().len(),
                margin: object.cell().margin(),
            };
            out.write(0, info);
            Ok(())
        })
    })
}

/// Writes least and greatest value of each coordinate of position: those of a turn are not limited
/// and left out.
///
/// # Safety
/// `low` and `high` point to `capacity` numbers, `count` to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_checker_limits(
    checker: lc_checker,
    low: *mut f64,
    high: *mut f64,
    capacity: usize,
    count: *mut usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let low = unsafe { written(low, capacity, "low") }?;
        // SAFETY: by the caller's contract.
        let high = unsafe { written(high, capacity, "high") }?;
        // SAFETY: by the caller's contract.
        let count = unsafe { Place::new(count, "count") }?;
        with(checker, |object| {
            let bounds = each!(&object.checker, c => c.space().bounds());
            low.fill(bounds.iter().map(|b| b[0]));
            count.write(high.fill(bounds.iter().map(|b| b[1])));
            Ok(())
        })
    })
}

/// Writes the name of a coordinate; `lc_text_free` frees it.
///
/// # Safety
/// `out` points to a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_checker_coordinate_name(
    checker: lc_checker,
    index: usize,
    out: *mut *mut c_char,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let out = unsafe { Place::new(out, "out") }?;
        let name = with(checker, |object| {
            let name = object.names.get(index).cloned();
            name.ok_or_else(|| refused(format_args!("coordinate {index} does not exist")))
        })?;
        out.write_text(name)
    })
}

/// Writes the name of a body; `lc_text_free` frees it.
///
/// # Safety
/// `out` points to a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_checker_body_name(
    checker: lc_checker,
    body: lc_world_body,
    out: *mut *mut c_char,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let out = unsafe { Place::new(out, "out") }?;
        let name = with(checker, |object| {
            let body = id(body);
            object.cell().select(body).map_err(refused)?;
            Ok(object.cell().name(body).to_owned())
        })?;
        out.write_text(name)
    })
}

/// Writes the bodies of a name. A wrong name is `LC_REFUSED`, and the message states the nearest
/// name.
///
/// `count` is their number; if it exceeds `capacity`, the first are written.
///
/// # Safety
/// `name` points to a text that ends with a zero, `out` to `capacity` ids, `count` to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_checker_find(
    checker: lc_checker,
    name: *const c_char,
    out: *mut lc_world_body,
    capacity: usize,
    count: *mut usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let name = unsafe { text(name, "name") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { written(out, capacity, "out") }?;
        // SAFETY: by the caller's contract.
        let count = unsafe { Place::new(count, "count") }?;
        with(checker, |object| {
            let found = object.cell().select(name).map_err(refused)?;
            count.write(out.fill(found.into_iter().map(number)));
            Ok(())
        })
    })
}

/// Adds an obstacle at a pose in the world.
///
/// # Safety
/// `name` points to a text that ends with a zero, `pose` to a pose, `out` to an id.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_checker_obstacle_add(
    checker: lc_checker,
    name: *const c_char,
    geometry: lc_geometry,
    pose: *const lc_pose,
    out: *mut lc_world_body,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let name = unsafe { text(name, "name") }?;
        // SAFETY: by the caller's contract.
        let pose = isometry(&unsafe { Given::one(pose, "pose") }?);
        // SAFETY: by the caller's contract.
        let out = unsafe { Place::new(out, "out") }?;
        let geometry = shared(geometry)?;
        with(checker, |object| {
            let added = each!(&mut object.checker, c => c.cell_mut().add_obstacle(name, geometry, pose));
            out.write(number(added.map_err(refused)?));
            Ok(())
        })
    })
}

/// Moves an obstacle to a pose in the world.
///
/// # Safety
/// `pose` points to a pose.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_checker_obstacle_move(
    checker: lc_checker,
    obstacle: lc_world_body,
    pose: *const lc_pose,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let pose = isometry(&unsafe { Given::one(pose, "pose") }?);
        with(checker, |object| {
            each!(&mut object.checker, c => c.cell_mut().move_obstacle(id(obstacle), pose)).map_err(refused)?;
            Ok(())
        })
    })
}

/// Removes an obstacle, or an object that a link carries.
#[unsafe(no_mangle)]
pub extern "C" fn lc_checker_remove(checker: lc_checker, body: lc_world_body) -> lc_status {
    guarded(|| {
        with(checker, |object| {
            let done = match id(body) {
                body @ lin_canny_plan::CellBody::Attached(_) => {
                    each!(&mut object.checker, c => c.cell_mut().detach(body))
                }
                body => each!(&mut object.checker, c => c.cell_mut().remove_obstacle(body)),
            };
            done.map_err(refused)?;
            Ok(())
        })
    })
}

/// Attaches an object to a link of the robot at a pose in the frame of the link.
///
/// `touch_links` are names of links whose pairs with the object are not checked; the link itself is
/// one of them only if it is named.
///
/// # Safety
/// `link` and `name` point to texts that end with a zero, `touch_links` to `touch_count` of them,
/// `pose` to a pose, `out` to an id.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_checker_attach(
    checker: lc_checker,
    link: *const c_char,
    name: *const c_char,
    geometry: lc_geometry,
    pose: *const lc_pose,
    touch_links: *const *const c_char,
    touch_count: usize,
    out: *mut lc_world_body,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let link = unsafe { text(link, "link") }?;
        // SAFETY: by the caller's contract.
        let name = unsafe { text(name, "name") }?;
        // SAFETY: by the caller's contract.
        let pose = isometry(&unsafe { Given::one(pose, "pose") }?);
        // SAFETY: by the caller's contract.
        let given = unsafe { array(touch_links, touch_count, "touch_links") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Place::new(out, "out") }?;
        let mut touch = Vec::with_capacity(given.len());
        for link in given {
            // SAFETY: by the caller's contract.
            touch.push(unsafe { text(*link, "touch_links") }?);
        }
        let geometry = shared(geometry)?;
        with(checker, |object| {
            let added = each!(&mut object.checker, c => c.cell_mut().attach(link, name, geometry, pose, &touch));
            out.write(number(added.map_err(refused)?));
            Ok(())
        })
    })
}

/// Excludes the pair of two bodies, or includes it again if `excluded` is zero.
#[unsafe(no_mangle)]
pub extern "C" fn lc_checker_exclude(
    checker: lc_checker,
    a: lc_world_body,
    b: lc_world_body,
    excluded: u32,
) -> lc_status {
    guarded(|| {
        with(checker, |object| {
            let (a, b) = (id(a), id(b));
            let done = match excluded {
                0 => each!(&mut object.checker, c => c.cell_mut().include(a, b)),
                _ => each!(&mut object.checker, c => c.cell_mut().exclude(a, b)),
            };
            done.map_err(refused)?;
            Ok(())
        })
    })
}

/// Sets the distance that pairs without a margin of their own must keep.
#[unsafe(no_mangle)]
pub extern "C" fn lc_checker_set_margin(checker: lc_checker, margin: f64) -> lc_status {
    guarded(|| {
        with(checker, |object| {
            each!(&mut object.checker, c => c.cell_mut().set_margin(margin)).map_err(refused)
        })
    })
}

/// Sets the distance that the pair of two bodies must keep; a negative one removes it.
#[unsafe(no_mangle)]
pub extern "C" fn lc_checker_set_pair_margin(
    checker: lc_checker,
    a: lc_world_body,
    b: lc_world_body,
    margin: f64,
) -> lc_status {
    guarded(|| {
        with(checker, |object| {
            let margin = (!(margin < 0.0)).then_some(margin);
            each!(&mut object.checker, c => c.cell_mut().set_pair_margin(id(a), id(b), margin)).map_err(refused)?;
            Ok(())
        })
    })
}

/// Accepts a contact at the start of a motion of at most this distance or depth; a negative one
/// accepts none.
///
/// The contact is accepted if the pair is proven not to come closer until it has left the margin.
#[unsafe(no_mangle)]
pub extern "C" fn lc_checker_set_start_contact(checker: lc_checker, margin: f64) -> lc_status {
    guarded(|| {
        with(checker, |object| {
            let margin = (!(margin < 0.0)).then_some(margin);
            each!(&mut object.checker, c => c.set_start_contact_margin(margin)).map_err(refused)
        })
    })
}

/// Writes the pose of a body in the world at a configuration.
///
/// # Safety
/// `q` points to `coordinates` numbers, `out` to a pose.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_checker_pose(
    checker: lc_checker,
    body: lc_world_body,
    q: *const f64,
    coordinates: usize,
    out: *mut lc_pose,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let q = unsafe { array(q, coordinates, "q") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Place::new(out, "out") }?;
        with(checker, |object| {
            object.check(coordinates)?;
            let pose = each!(&object.checker, c => c.pose(id(body), q)).map_err(refused)?;
            out.write(pose_of(&pose));
            Ok(())
        })
    })
}

/// Writes whether each of `count` configurations keeps the margins: 1 if it is proven, else 0.
///
/// The call ends at the first configuration that is refused; `done` is the number of answers.
///
/// # Safety
/// `q` points to `count * coordinates` numbers, `out` to `count` bytes, `done` to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_checker_free_at_many(
    checker: lc_checker,
    q: *const f64,
    coordinates: usize,
    count: usize,
    out: *mut u8,
    done: *mut usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let q = unsafe { table(q, count, coordinates, "q") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { written(out, count, "out") }?;
        // SAFETY: by the caller's contract.
        let done = unsafe { Place::new(done, "done") }?;
        done.write(0);
        with(checker, |object| {
            object.check(coordinates)?;
            for k in 0..count {
                let q = &q[k * coordinates..(k + 1) * coordinates];
                let is_free = each!(&mut object.checker, c => c.is_free_at(q)).map_err(refused)?;
                out.write(k, u8::from(is_free));
                done.write(k + 1);
            }
            Ok(())
        })
    })
}

/// Writes the pair of least signed distance at each of `count` configurations.
///
/// `gradients` may be null; else it gets the derivatives of each distance by the degrees of
/// freedom. The call ends at the first configuration that is refused; `done` is the number of
/// answers.
///
/// # Safety
/// `q` points to `count * coordinates` numbers, `out` to `count` elements of `out_stride` bytes,
/// `gradients` is null or points to `count * degrees_of_freedom` numbers, `done` to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_checker_clearance_many(
    checker: lc_checker,
    q: *const f64,
    coordinates: usize,
    count: usize,
    out: *mut lc_near,
    out_stride: usize,
    gradients: *mut f64,
    done: *mut usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let q = unsafe { table(q, count, coordinates, "q") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Places::new(out, out_stride, count, "out") }?;
        // SAFETY: by the caller's contract.
        let done = unsafe { Place::new(done, "done") }?;
        done.write(0);
        with(checker, |object| {
            object.check(coordinates)?;
            let freedom = object.degrees_of_freedom();
            let len = match gradients.is_null() {
                true => 0,
                false => count.checked_mul(freedom).ok_or_else(|| bad_argument("count"))?,
            };
            // SAFETY: by the caller's contract.
            let gradients = unsafe { written(gradients, len, "gradients") }?;
            for k in 0..count {
                let q = &q[k * coordinates..(k + 1) * coordinates];
                let found = each!(&mut object.checker, c => c.clearance(q)).map_err(refused)?;
                out.write(k, found.as_ref().map_or(NO_PAIR, near));
                for j in 0..if len == 0 { 0 } else { freedom } {
                    let derivative = found.as_ref().map_or(0.0, |found| found.gradient[j]);
                    gradients.write(k * freedom + j, derivative);
                }
                done.write(k + 1);
            }
            Ok(())
        })
    })
}

/// Writes the `columns` closest pairs at each of `count` configurations, the closest first.
///
/// Pairs whose distance exceeds the least of a row by more than `slack`, which may be infinite, are
/// left out: entries without a pair have `a.id` zero. Each row has the bits of a new checker's, for
/// any number of threads, at most 256. `gradients` may be null.
///
/// # Safety
/// `q` points to `count * coordinates` numbers, `out` to `count * columns` elements of `out_stride`
/// bytes, `gradients` is null or points to `count * columns * degrees_of_freedom` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_checker_nearest_many(
    checker: lc_checker,
    q: *const f64,
    coordinates: usize,
    count: usize,
    columns: usize,
    slack: f64,
    threads: usize,
    out: *mut lc_near,
    out_stride: usize,
    gradients: *mut f64,
) -> lc_status {
    guarded(|| {
        let entries = count.checked_mul(columns).ok_or_else(|| bad_argument("columns"))?;
        // SAFETY: by the caller's contract.
        let q = unsafe { table(q, count, coordinates, "q") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Places::new(out, out_stride, entries, "out") }?;
        with(checker, |object| {
            object.check(coordinates)?;
            let len = match gradients.is_null() {
                true => 0,
                false => entries
                    .checked_mul(object.degrees_of_freedom())
                    .ok_or_else(|| bad_argument("columns"))?,
            };
            // SAFETY: by the caller's contract.
            let gradients = unsafe { written(gradients, len, "gradients") }?;
            let threads = threads.clamp(1, 256);
            let found = each!(&object.checker, c => c.nearest_batch(q, columns, slack, threads)).map_err(refused)?;
            for k in 0..entries {
                let entry = match found.pairs[k] {
                    None => NO_PAIR,
                    Some(pair) => lc_near {
                        a: number(pair.a),
                        b: number(pair.b),
                        distance: found.distances[k],
                        lower: found.lower[k],
                        upper: found.upper[k],
                        excess: found.excesses[k],
                        point_on_a: found.points_a[k],
                        point_on_b: found.points_b[k],
                        normal: found.normals[k],
                    },
                };
                out.write(k, entry);
            }
            gradients.fill(found.gradients.iter().copied());
            Ok(())
        })
    })
}

/// Writes the verdicts about `count` straight segments, each over its whole length.
///
/// The call ends at the first segment that is refused; `done` is the number of verdicts.
///
/// # Safety
/// `from` and `to` point to `count * coordinates` numbers, `out` to `count` elements of
/// `out_stride` bytes, `done` to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_checker_certify_many(
    checker: lc_checker,
    from: *const f64,
    to: *const f64,
    coordinates: usize,
    count: usize,
    out: *mut lc_verdict,
    out_stride: usize,
    done: *mut usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let from = unsafe { table(from, count, coordinates, "from") }?;
        // SAFETY: by the caller's contract.
        let to = unsafe { table(to, count, coordinates, "to") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Places::new(out, out_stride, count, "out") }?;
        // SAFETY: by the caller's contract.
        let done = unsafe { Place::new(done, "done") }?;
        done.write(0);
        with(checker, |object| {
            object.check(coordinates)?;
            for k in 0..count {
                let row = k * coordinates..(k + 1) * coordinates;
                let motion = JointMotion::segment(&from[row.clone()], &to[row]);
                let found = each!(&mut object.checker, c => c.certify(&motion));
                out.write(k, verdict(&found.map_err(refused)?));
                done.write(k + 1);
            }
            Ok(())
        })
    })
}

/// Borrows the rows of an array.
fn rows(q: &[f64], coordinates: usize) -> Path {
    q.chunks(coordinates.max(1)).map(<[f64]>::to_vec).collect()
}

/// Writes the verdict about a path of `count` configurations: free, or the verdict about its first
/// segment that is not.
///
/// `out_size` is `sizeof(lc_verdict)`.
///
/// # Safety
/// `q` points to `count * coordinates` numbers, `out` to `out_size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_checker_certify_path(
    checker: lc_checker,
    q: *const f64,
    coordinates: usize,
    count: usize,
    out: *mut lc_verdict,
    out_size: usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let q = unsafe { table(q, count, coordinates, "q") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Places::new(out, out_size, 1, "out") }?;
        with(checker, |object| {
            object.check(coordinates)?;
            let motion = JointMotion::path(&rows(q, coordinates)).map_err(refused)?;
            let found = each!(&mut object.checker, c => c.certify(&motion)).map_err(refused)?;
            out.write(0, verdict(&found));
            Ok(())
        })
    })
}

/// Writes the verdict about a polynomial curve, given by its `count` Bézier control points.
///
/// `out_size` is `sizeof(lc_verdict)`. `LC_REFUSED` if the space has no curves: a body that turns.
///
/// # Safety
/// `points` points to `count * coordinates` numbers, `out` to `out_size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_checker_certify_curve(
    checker: lc_checker,
    points: *const f64,
    coordinates: usize,
    count: usize,
    out: *mut lc_verdict,
    out_size: usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let points = unsafe { table(points, count, coordinates, "points") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Places::new(out, out_size, 1, "out") }?;
        with(checker, |object| {
            object.check(coordinates)?;
            let curve = JointCurve::bezier(&rows(points, coordinates)).map_err(refused)?;
            let found = each!(&mut object.checker, c => c.certify(&JointMotion::curve(&curve))).map_err(refused)?;
            out.write(0, verdict(&found));
            Ok(())
        })
    })
}

/// Searches for a path between two configurations, of segments that are proven free.
///
/// `count` is the number of configurations of the path, which `lc_checker_path` copies. Zero means
/// that a limit ended the search, which proves nothing. `progress` may be null; its stage is
/// "queries", then "shortcuts". If it stops the call in the second, `lc_checker_path` copies the path so
/// far. `options_size` is `sizeof(lc_plan_options)`.
///
/// # Safety
/// `start` and `goal` point to `coordinates` numbers, `options` is null or points to `options_size`
/// bytes, `count` to a number; `progress` may be called with `context`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_checker_plan(
    checker: lc_checker,
    start: *const f64,
    goal: *const f64,
    coordinates: usize,
    options: *const lc_plan_options,
    options_size: usize,
    progress: lc_progress,
    context: *mut c_void,
    count: *mut usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let start = unsafe { array(start, coordinates, "start") }?;
        // SAFETY: by the caller's contract.
        let goal = unsafe { array(goal, coordinates, "goal") }?;
        // SAFETY: by the caller's contract.
        let given = unsafe { self::options(options, options_size, "options") }?;
        // SAFETY: by the caller's contract.
        let mut reporter = unsafe { Reporter::new(progress, context) };
        // SAFETY: by the caller's contract.
        let count = unsafe { Place::new(count, "count") }?;
        let method = match given.method {
            LC_PLAN_RRT_CONNECT => PlanMethod::RrtConnect,
            LC_PLAN_OPPORTUNISTIC => PlanMethod::Opportunistic,
            other => {
                let message = format_args!("options.method is {other} (expected 0..=1)");
                return Err(error(lc_status::LC_ARGUMENT, &message));
            }
        };
        let mut options = PlanOptions::default().seed(given.seed);
        for (budget, given) in [
            (&mut options.slices, given.slices),
            (&mut options.samples, given.samples),
            (&mut options.queries, given.queries),
        ] {
            if given > 0 {
                *budget = given;
            }
        }
        let tries = usize::try_from(given.shorten).unwrap_or(usize::MAX);
        with(checker, |object| {
            object.check(coordinates)?;
            object.path.clear();
            let path = each!(&mut object.checker, c => {
                let mut report = |p| reporter.report(p);
                let plan = method.plan(c, [start, goal], &options, &mut report);
                reporter.finish()?;
                match plan.map_err(refused)?.path {
                    Some(path) => {
                        let mut report = |p| reporter.report(p);
                        let shortcuts = Shortcuts::new(tries, given.seed).progress(&mut report);
                        shortcuts.shorten(c, &path).map_err(refused)?
                    }
                    None => Path::new(),
                }
            });
            object.path = path;
            reporter.finish()?;
            count.write(object.path.len());
            Ok(())
        })
    })
}

/// Copies the path of the last `lc_checker_plan`, one configuration after another.
///
/// `count` is the number of its configurations; if it exceeds `capacity`, the first are written.
///
/// # Safety
/// `q` points to `capacity * coordinates` numbers, `count` to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_checker_path(
    checker: lc_checker,
    q: *mut f64,
    coordinates: usize,
    capacity: usize,
    count: *mut usize,
) -> lc_status {
    guarded(|| {
        let len = capacity
            .checked_mul(coordinates)
            .ok_or_else(|| bad_argument("capacity"))?;
        // SAFETY: by the caller's contract.
        let q = unsafe { written(q, len, "q") }?;
        // SAFETY: by the caller's contract.
        let count = unsafe { Place::new(count, "count") }?;
        with(checker, |object| {
            object.check(coordinates)?;
            q.fill(object.path.iter().flatten().copied());
            count.write(object.path.len());
            Ok(())
        })
    })
}

/// Writes counts of the work of a checker since it was made; `out_size` is `sizeof(lc_check_work)`.
///
/// # Safety
/// `out` points to `out_size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_checker_get_work(
    checker: lc_checker,
    out: *mut lc_check_work,
    out_size: usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let out = unsafe { Places::new(out, out_size, 1, "out") }?;
        with(checker, |object| {
            out.write(0, work(&each!(&object.checker, c => c.work())));
            Ok(())
        })
    })
}

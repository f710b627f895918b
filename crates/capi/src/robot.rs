//! Robots and cells from files.

use std::ffi::c_char;

use lin_canny_plan::Checker;
use lin_canny_robot::{LoadOptions, MeshUse, Packages, RobotFiles};

use crate::border::{guarded, lc_status, refused};
use crate::checker::{AnyChecker, give, lc_checker};
use crate::memory::{Place, Plain, array, options, text};

/// Checks the pairs of adjacent links as well.
pub const LC_CHECK_ADJACENT: u32 = 1;
/// Skips bodies whose mesh file does not exist; nothing is checked against them.
pub const LC_SKIP_MISSING_MESHES: u32 = 2;
/// Uses mesh files as they are, and not their hulls.
pub const LC_MESHES_AS_GIVEN: u32 = 4;

/// The files of a robot and its cell; what is null or zero is left out.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lc_robot_files {
    /// The robot: URDF, MJCF or SDFormat.
    pub robot: *const c_char,
    /// Pairs of links that are not checked: SRDF.
    pub srdf: *const c_char,
    /// The obstacles: JSON or SDFormat.
    pub cell: *const c_char,
    /// Folders of `package://` paths, searched before those of `ROS_PACKAGE_PATH`.
    pub packages: *const *const c_char,
    /// The number of folders.
    pub package_count: usize,
    /// A mask of `LC_CHECK_ADJACENT` and so on.
    pub flags: u32,
    /// Zero.
    pub reserved: u32,
}

// SAFETY: pointers and numbers; every pattern of bits is a value, and pointers are checked when
// they are read.
unsafe impl Plain for lc_robot_files {
    const FIRST: usize = 5 * size_of::<usize>() + 8;
}

/// Makes the checker of a robot and its cell from files.
///
/// Paths are UTF-8. A message names the file, the line and the element. `files_size` is
/// `sizeof(lc_robot_files)`.
///
/// # Safety
/// `files` points to `files_size` bytes; its texts end with a zero, and `packages` points to
/// `package_count` of them; `out` points to a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_checker_load(
    files: *const lc_robot_files,
    files_size: usize,
    out: *mut lc_checker,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let given = unsafe { options(files, files_size, "files") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Place::new(out, "out") }?;
        // SAFETY: by the caller's contract.
        let mut files = RobotFiles::new(unsafe { text(given.robot, "files.robot") }?);
        if !given.srdf.is_null() {
            // SAFETY: by the caller's contract.
            files.srdf = Some(unsafe { text(given.srdf, "files.srdf") }?.into());
        }
        if !given.cell.is_null() {
            // SAFETY: by the caller's contract.
            files.cell = Some(unsafe { text(given.cell, "files.cell") }?.into());
        }
        // SAFETY: by the caller's contract.
        let folders = unsafe { array(given.packages, given.package_count, "files.packages") }?;
        let mut packages = Vec::with_capacity(folders.len());
        for folder in folders {
            // SAFETY: by the caller's contract.
            packages.push(unsafe { text(*folder, "files.packages") }?);
        }
        files.packages = Packages::new(packages).with_environment();
        files.check_adjacent = given.flags & LC_CHECK_ADJACENT != 0;
        let usage = match given.flags & LC_MESHES_AS_GIVEN {
            0 => MeshUse::Hull,
            _ => MeshUse::Mesh,
        };
        files.options = LoadOptions::default()
            .meshes(usage)
            .skip_missing_meshes(given.flags & LC_SKIP_MISSING_MESHES != 0);
        let cell = files.load().map_err(refused)?.cell;
        let names = cell.coordinates().iter().map(|c| c.name.clone()).collect();
        let checker = Checker::of_robots(cell).map_err(refused)?;
        give(out, AnyChecker::Tree(checker), names)
    })
}

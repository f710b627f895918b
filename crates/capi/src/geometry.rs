//! Geometries of every kind, from arrays.

use std::ffi::c_void;

use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::polyhedron::BoxHint;
use lin_canny::surface::{BezierPatch, BezierSurface};
use lin_canny::{
    Cloud, CloudElement, Compound, ConvexPolyhedron, Geometry, GeometryKind, HalfSpace, Mesh, MeshKind, Piece,
    RepairOptions, Shape, WithProgress,
};

use crate::border::{Status, bad_argument, error, guarded, lc_status, refused};
use crate::memory::{Given, Place, Places, Plain, array, table};
use crate::pose::{isometry, lc_pose, points};
use crate::progress::{Reporter, lc_progress};
use crate::table::Table;

/// A geometry. It never changes, and threads, pairs, scenes and checkers may share it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct lc_geometry {
    /// The handle; zero is none.
    pub id: u64,
}

/// A box about the origin: half extents along x, y and z.
pub const LC_BOX: u32 = 1;
/// A ball about the origin: radius.
pub const LC_BALL: u32 = 2;
/// A capsule along z: half the length of its segment, radius.
pub const LC_CAPSULE: u32 = 3;
/// A cylinder along z: half height, radius.
pub const LC_CYLINDER: u32 = 4;
/// A cone along z with its apex at half the height: half height, radius.
pub const LC_CONE: u32 = 5;
/// An ellipsoid: semi-axes along x, y and z.
pub const LC_ELLIPSOID: u32 = 6;
/// The half-space of all points p with n . p <= offset: n (of any length), offset.
pub const LC_HALF_SPACE: u32 = 8;
/// A point: x, y, z.
pub const LC_POINT: u32 = 9;
/// A segment: x, y, z of both ends.
pub const LC_SEGMENT: u32 = 10;

/// A geometry is a convex polyhedron or polygon.
pub const LC_KIND_POLYHEDRON: u32 = 1;
/// A geometry is a point or a segment.
pub const LC_KIND_WIRE: u32 = 2;
/// A geometry is a rounded polyhedron: ball, capsule, rounded box or hull.
pub const LC_KIND_ROUNDED: u32 = 3;
/// A geometry is a cylinder, cone or ellipsoid, rounded or not.
pub const LC_KIND_CURVED: u32 = 4;
/// A geometry consists of convex pieces.
pub const LC_KIND_COMPOUND: u32 = 5;
/// A geometry is a mesh of triangles.
pub const LC_KIND_MESH: u32 = 6;
/// A geometry is one convex element at many points.
pub const LC_KIND_CLOUD: u32 = 7;
/// A geometry is a surface of Bézier patches.
pub const LC_KIND_SURFACE: u32 = 8;
/// A geometry is a half-space.
pub const LC_KIND_HALF_SPACE: u32 = 9;

/// What a geometry is.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lc_geometry_info {
    /// One of `LC_KIND_POLYHEDRON` and so on; zero is another kind.
    pub kind: u32,
    /// 0 for open meshes and surfaces, which have no inside; 1 for all others.
    pub is_solid: u32,
    /// The centre of a ball that contains the geometry, in its frame.
    pub center: [f64; 3],
    /// The radius of the ball.
    pub radius: f64,
}

// SAFETY: numbers only.
unsafe impl Plain for lc_geometry_info {
    const FIRST: usize = 40;
}

/// What a repair of a mesh has changed.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct lc_mesh_repair {
    /// Number of points that moved to another one within the tolerance.
    pub welded: u64,
    /// Number of triangles that were inverted.
    pub turned: u64,
    /// Number of holes that were closed. Their triangles count on from those given.
    pub caps: u64,
    /// Number of points of the longest loop around a hole.
    pub longest_loop: u64,
    /// Area of the triangles that close holes, as a share of the area of the mesh, from 0 to 1.
    pub cap_share: f64,
    /// 1 if the triangles cancel in pairs, so that nothing is inside.
    pub is_empty: u32,
}

// SAFETY: numbers only.
unsafe impl Plain for lc_mesh_repair {
    const FIRST: usize = 48;
}

static GEOMETRIES: Table<Geometry> = Table::new(1, "geometry");

pub(crate) fn live() -> usize {
    GEOMETRIES.live()
}

/// Returns the geometry of a handle; geometries are shared, so this copies a pointer.
pub(crate) fn shared(geometry: lc_geometry) -> Result<Geometry, lc_status> {
    Ok(GEOMETRIES.claim_soon(geometry.id)?.get().clone())
}

/// Writes the handle of a new geometry.
fn give(out: Place<'_, lc_geometry>, geometry: impl Into<Geometry>) -> Status {
    let id = GEOMETRIES.insert(geometry.into())?;
    out.write(lc_geometry { id });
    Ok(())
}

fn triangles(indices: &[u32]) -> &[[u32; 3]] {
    indices.as_chunks::<3>().0
}

/// Makes the convex hull of `count` points, three numbers each.
///
/// `progress` may be null. Any thread.
///
/// # Safety
/// `xyz` points to `3 * count` numbers, `out` to a handle; `progress` may be called with `context`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_hull_new(
    xyz: *const f64,
    count: usize,
    progress: lc_progress,
    context: *mut c_void,
    out: *mut lc_geometry,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let xyz = unsafe { table(xyz, count, 3, "xyz") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Place::new(out, "out") }?;
        // SAFETY: by the caller's contract.
        let mut reporter = unsafe { Reporter::new(progress, context) };
        let hull = WithProgress::new(&mut |p| reporter.report(p)).convex_hull(&points(xyz));
        reporter.finish()?;
        give(out, hull.map_err(refused)?)
    })
}

/// Makes the convex polygon that is the hull of `count` points of a plane.
///
/// # Safety
/// `xyz` points to `3 * count` numbers, `out` to a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_polygon_new(xyz: *const f64, count: usize, out: *mut lc_geometry) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let xyz = unsafe { table(xyz, count, 3, "xyz") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Place::new(out, "out") }?;
        give(out, ConvexPolyhedron::polygon(&points(xyz)).map_err(refused)?)
    })
}

/// Makes a convex polyhedron of faces.
///
/// `sizes` has the number of vertices of each of `faces` faces, and `indices` the indices of their
/// vertices, one face after another, counterclockwise from outside.
///
/// # Safety
/// `xyz` points to `3 * vertices` numbers, `sizes` to `faces` numbers, `indices` to `index_count`
/// numbers, `out` to a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_faces_new(
    xyz: *const f64,
    vertices: usize,
    sizes: *const u32,
    faces: usize,
    indices: *const u32,
    index_count: usize,
    out: *mut lc_geometry,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let xyz = unsafe { table(xyz, vertices, 3, "xyz") }?;
        // SAFETY: by the caller's contract.
        let sizes = unsafe { array(sizes, faces, "sizes") }?;
        // SAFETY: by the caller's contract.
        let mut rest = unsafe { array(indices, index_count, "indices") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Place::new(out, "out") }?;
        let mut all = Vec::with_capacity(faces);
        for &size in sizes {
            let (face, after) = rest
                .split_at_checked(size as usize)
                .ok_or_else(|| bad_argument("index_count"))?;
            all.push(face);
            rest = after;
        }
        if !rest.is_empty() {
            return Err(bad_argument("index_count"));
        }
        give(out, ConvexPolyhedron::from_faces(&points(xyz), &all).map_err(refused)?)
    })
}

/// Makes a shape of a kind (`LC_BOX` and so on) from its `count` parameters.
///
/// # Safety
/// `parameters` points to `count` numbers, `out` to a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_shape_new(
    kind: u32,
    parameters: *const f64,
    count: usize,
    out: *mut lc_geometry,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let parameters = unsafe { array(parameters, count, "parameters") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Place::new(out, "out") }?;
        give(out, shape(kind, parameters)?)
    })
}

fn shape(kind: u32, parameters: &[f64]) -> Result<Geometry, lc_status> {
    let made = match (kind, parameters) {
        (LC_BOX, &[x, y, z]) => Shape::cuboid(Vector3::new(x, y, z)),
        (LC_BALL, &[radius]) => Shape::ball(radius),
        (LC_CAPSULE, &[half_length, radius]) => Shape::capsule(half_length, radius),
        (LC_CYLINDER, &[half_height, radius]) => Shape::cylinder(half_height, radius),
        (LC_CONE, &[half_height, radius]) => Shape::cone(half_height, radius),
        (LC_ELLIPSOID, &[x, y, z]) => Shape::ellipsoid(Vector3::new(x, y, z)),
        (LC_HALF_SPACE, &[x, y, z, offset]) => {
            return Ok(HalfSpace::new(Vector3::new(x, y, z), offset).map_err(refused)?.into());
        }
        (LC_POINT, &[x, y, z]) => {
            return Ok(ConvexPolyhedron::point(Point3::new(x, y, z)).map_err(refused)?.into());
        }
        (LC_SEGMENT, &[a, b, c, x, y, z]) => {
            let segment = ConvexPolyhedron::segment(Point3::new(a, b, c), Point3::new(x, y, z));
            return Ok(segment.map_err(refused)?.into());
        }
        _ => {
            let count = parameters.len();
            let message = format_args!("there is no shape of kind {kind} with {count} parameters");
            return Err(error(lc_status::LC_ARGUMENT, &message));
        }
    };
    Ok(made.map_err(refused)?.into())
}

/// Makes a convex geometry rounded by a radius: the points within the radius of it.
///
/// # Safety
/// `out` points to a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_rounded_new(geometry: lc_geometry, radius: f64, out: *mut lc_geometry) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let out = unsafe { Place::new(out, "out") }?;
        let geometry = shared(geometry)?;
        let Some(shape) = geometry.as_convex() else {
            return Err(refused(format_args!(
                "a {} cannot be rounded (expected a convex geometry)",
                geometry.kind()
            )));
        };
        give(out, shape.into_owned().rounded(radius).map_err(refused)?)
    })
}

/// Makes a compound of `count` convex pieces, each at a pose.
///
/// # Safety
/// `pieces` and `poses` point to `count` elements, `out` to a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_compound_new(
    pieces: *const lc_geometry,
    poses: *const lc_pose,
    count: usize,
    out: *mut lc_geometry,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let pieces = unsafe { array(pieces, count, "pieces") }?;
        // SAFETY: by the caller's contract.
        let poses = unsafe { array(poses, count, "poses") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Place::new(out, "out") }?;
        let mut all = Vec::with_capacity(count);
        for (k, (piece, pose)) in pieces.iter().zip(poses).enumerate() {
            let geometry = shared(*piece)?;
            let Some(shape) = geometry.as_convex() else {
                return Err(refused(format_args!(
                    "piece {k} is a {} (expected a convex geometry)",
                    geometry.kind()
                )));
            };
            let mut piece = Piece::new(shape.into_owned());
            piece.pose = isometry(pose);
            all.push(piece);
        }
        give(out, Compound::new(all).map_err(refused)?)
    })
}

/// Makes a mesh of `triangles` triples of indices of `vertices` points: a solid if the mesh is
/// closed.
///
/// Triangles are counterclockwise from outside. `progress` may be null.
///
/// # Safety
/// `xyz` points to `3 * vertices` numbers, `indices` to `3 * triangles` numbers, `out` to a handle;
/// `progress` may be called with `context`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_mesh_new(
    xyz: *const f64,
    vertices: usize,
    indices: *const u32,
    triangles: usize,
    progress: lc_progress,
    context: *mut c_void,
    out: *mut lc_geometry,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let xyz = unsafe { table(xyz, vertices, 3, "xyz") }?;
        // SAFETY: by the caller's contract.
        let indices = unsafe { table(indices, triangles, 3, "indices") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Place::new(out, "out") }?;
        // SAFETY: by the caller's contract.
        let mut reporter = unsafe { Reporter::new(progress, context) };
        let triangles = self::triangles(indices);
        let mesh = WithProgress::new(&mut |p| reporter.report(p)).mesh(&points(xyz), triangles);
        reporter.finish()?;
        give(out, mesh.map_err(refused)?)
    })
}

/// Makes a mesh as `lc_mesh_new` does, after a repair of cracks, inverted triangles and holes: a
/// solid for all input. `lc_geometry_get_repair` says what was changed.
///
/// Points at most `weld` from an earlier point move to it; zero welds equal points alone. Do not
/// repair a mesh whose opening is meant, as that of a cup: what reaches in would overlap the mesh.
///
/// # Safety
/// As in `lc_mesh_new`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_mesh_repaired_new(
    xyz: *const f64,
    vertices: usize,
    indices: *const u32,
    triangles: usize,
    weld: f64,
    progress: lc_progress,
    context: *mut c_void,
    out: *mut lc_geometry,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let xyz = unsafe { table(xyz, vertices, 3, "xyz") }?;
        // SAFETY: by the caller's contract.
        let indices = unsafe { table(indices, triangles, 3, "indices") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Place::new(out, "out") }?;
        // SAFETY: by the caller's contract.
        let mut reporter = unsafe { Reporter::new(progress, context) };
        let (points, triangles) = (points(xyz), self::triangles(indices));
        let options = RepairOptions::default().weld(weld);
        let mesh = WithProgress::new(&mut |p| reporter.report(p)).repaired(&points, triangles, &options);
        reporter.finish()?;
        give(out, mesh.map_err(refused)?)
    })
}

/// Makes the mesh of a height field of `rows` by `columns` values, row by row.
///
/// The value of row i and column j is the z at x = j * dx and y = i * dy. `base` may be null: the
/// mesh is an open surface. Otherwise it points to the z of a base below all heights, and the mesh
/// is a solid.
///
/// # Safety
/// `heights` points to `rows * columns` numbers, `base` is null or points to a number, `out` to a
/// handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_heights_new(
    heights: *const f64,
    rows: usize,
    columns: usize,
    dx: f64,
    dy: f64,
    base: *const f64,
    out: *mut lc_geometry,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let heights = unsafe { table(heights, rows, columns, "heights") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Place::new(out, "out") }?;
        let base = match base.is_null() {
            true => None,
            // SAFETY: by the caller's contract.
            false => Some(unsafe { Given::one(base, "base") }?),
        };
        let mesh = Mesh::from_heights(rows, columns, [dx, dy], heights, base);
        give(out, mesh.map_err(refused)?)
    })
}

/// Makes a cloud of `count` points.
///
/// With `radii` null, each point is a ball of the radius `radius`; zero is the point itself.
/// Otherwise `radii` has a radius for each point.
///
/// # Safety
/// `xyz` points to `3 * count` numbers, `radii` is null or points to `count` numbers, `out` to a
/// handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_cloud_new(
    xyz: *const f64,
    count: usize,
    radius: f64,
    radii: *const f64,
    out: *mut lc_geometry,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let xyz = unsafe { table(xyz, count, 3, "xyz") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Place::new(out, "out") }?;
        let element = match radii.is_null() {
            true => CloudElement::Ball(radius),
            // SAFETY: by the caller's contract.
            false => CloudElement::Balls(unsafe { array(radii, count, "radii") }?.to_vec()),
        };
        give(out, Cloud::new(&points(xyz), element).map_err(refused)?)
    })
}

/// Makes a cloud of boxes from `count` occupied cells of a grid, three indices each.
///
/// `origin` is the least corner of the cell 0, 0, 0; `size` are the sides of a cell.
///
/// # Safety
/// `origin` and `size` point to three numbers, `cells` to `3 * count` numbers, `out` to a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_voxels_new(
    origin: *const f64,
    size: *const f64,
    cells: *const u16,
    count: usize,
    out: *mut lc_geometry,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let origin: [f64; 3] = unsafe { Given::one(origin.cast(), "origin") }?;
        // SAFETY: by the caller's contract.
        let size: [f64; 3] = unsafe { Given::one(size.cast(), "size") }?;
        // SAFETY: by the caller's contract.
        let cells = unsafe { table(cells, count, 3, "cells") }?;
        // SAFETY: by the caller's contract.
        let out = unsafe { Place::new(out, "out") }?;
        let cloud = Cloud::from_cells(origin.into(), size.into(), cells.as_chunks::<3>().0);
        give(out, cloud.map_err(refused)?)
    })
}

/// Makes a surface of `patches` Bézier patches of the degrees `p` and `q`.
///
/// A patch has (p + 1) * (q + 1) control points, those of one value of the first parameter after
/// another. `weights` may be null; otherwise it has a weight for each control point.
///
/// # Safety
/// `xyz` points to the control points of all patches, three numbers each, `weights` is null or
/// points to as many numbers as there are control points, `out` to a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_surface_new(
    p: u32,
    q: u32,
    xyz: *const f64,
    weights: *const f64,
    patches: usize,
    out: *mut lc_geometry,
) -> lc_status {
    guarded(|| {
        let degrees = [p as usize, q as usize];
        let count = |degree: usize| degree.checked_add(1);
        let net = count(degrees[0])
            .zip(count(degrees[1]))
            .and_then(|(a, b)| a.checked_mul(b));
        let net = net.ok_or_else(|| bad_argument("p"))?;
        let columns = net.checked_mul(3).ok_or_else(|| bad_argument("p"))?;
        // SAFETY: by the caller's contract.
        let xyz = unsafe { table(xyz, patches, columns, "xyz") }?;
        let weights = match weights.is_null() {
            true => &[],
            // SAFETY: by the caller's contract.
            false => unsafe { table(weights, patches, net, "weights") }?,
        };
        // SAFETY: by the caller's contract.
        let out = unsafe { Place::new(out, "out") }?;
        let patch = |(k, xyz): (usize, &[f64])| match weights.get(k * net..(k + 1) * net) {
            Some(weights) => BezierPatch::rational(degrees, &points(xyz), weights),
            None => BezierPatch::polynomial(degrees, &points(xyz)),
        };
        let all: Result<Vec<_>, _> = xyz.chunks(columns).enumerate().map(patch).collect();
        let surface = all.and_then(BezierSurface::new);
        give(out, surface.map_err(refused)?)
    })
}

/// Writes what the repair of a mesh has changed: zeros for a geometry that was not repaired.
/// `out_size` is `sizeof(lc_mesh_repair)`.
///
/// # Safety
/// `out` points to `out_size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_geometry_get_repair(
    geometry: lc_geometry,
    out: *mut lc_mesh_repair,
    out_size: usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let out = unsafe { Places::new(out, out_size, 1, "out") }?;
        let geometry = shared(geometry)?;
        let repair = match &geometry {
            Geometry::Mesh(mesh) => mesh.report().repair.as_deref(),
            _ => None,
        };
        let reported = repair.map(|repair| lc_mesh_repair {
            welded: repair.welded as u64,
            turned: repair.turned.len() as u64,
            caps: repair.caps.len() as u64,
            longest_loop: repair.longest_loop() as u64,
            cap_share: repair.cap_share,
            is_empty: u32::from(repair.is_empty),
        });
        out.write(0, reported.unwrap_or_default());
        Ok(())
    })
}

/// Writes what a geometry is; `out_size` is `sizeof(lc_geometry_info)`.
///
/// # Safety
/// `out` points to `out_size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_geometry_get_info(
    geometry: lc_geometry,
    out: *mut lc_geometry_info,
    out_size: usize,
) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let out = unsafe { Places::new(out, out_size, 1, "out") }?;
        let geometry = shared(geometry)?;
        let kind = match geometry.kind() {
            GeometryKind::Polyhedron => LC_KIND_POLYHEDRON,
            GeometryKind::Wire => LC_KIND_WIRE,
            GeometryKind::Rounded => LC_KIND_ROUNDED,
            GeometryKind::Curved => LC_KIND_CURVED,
            GeometryKind::Compound => LC_KIND_COMPOUND,
            GeometryKind::Mesh => LC_KIND_MESH,
            GeometryKind::Cloud => LC_KIND_CLOUD,
            GeometryKind::BezierSurface => LC_KIND_SURFACE,
            GeometryKind::HalfSpace => LC_KIND_HALF_SPACE,
            _ => 0,
        };
        let is_solid = match &geometry {
            Geometry::Mesh(mesh) => mesh.kind() == MeshKind::Solid,
            Geometry::BezierSurface(_) => false,
            _ => true,
        };
        let (center, radius) = geometry.bounding_ball();
        let info = lc_geometry_info {
            kind,
            is_solid: u32::from(is_solid),
            center: center.into(),
            radius,
        };
        out.write(0, info);
        Ok(())
    })
}

/// Writes the box of a geometry at a pose, rounded outward: the least x, y, z, then the greatest.
///
/// # Safety
/// `pose` points to a pose, `out` to six numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lc_geometry_box(geometry: lc_geometry, pose: *const lc_pose, out: *mut f64) -> lc_status {
    guarded(|| {
        // SAFETY: by the caller's contract.
        let pose = unsafe { Given::one(pose, "pose") }?;
        // SAFETY: by the caller's contract; six numbers are aligned as one.
        let out = unsafe { Place::new(out.cast::<[[f64; 3]; 2]>(), "out") }?;
        let pose = isometry(&pose);
        lin_canny::RelativePose::from_isometry(&pose).map_err(refused)?;
        let (low, high) = shared(geometry)?.aabb_at(&pose, &mut BoxHint::default());
        out.write([low.into(), high.into()]);
        Ok(())
    })
}

/// Frees the handle of a geometry; zero is no error.
///
/// Pairs, scenes and checkers that use the geometry keep it. Any thread.
#[unsafe(no_mangle)]
pub extern "C" fn lc_geometry_free(geometry: lc_geometry) -> lc_status {
    guarded(|| GEOMETRIES.free_soon(geometry.id))
}

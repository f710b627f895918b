//! Promise: answers through C have the bits of the answers in Rust, for 10,000 queries of every
//! kind.

mod checkers;
mod pairs;
mod scenes;

use std::ptr::{null, null_mut};

use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::surface::{BezierPatch, BezierSurface};
use lin_canny::{BoxHint, Outcome, RayCast, RelativePose, RepairOptions, Shape};
use lin_canny::{Cloud, CloudElement, Compound, ConvexPolyhedron, Feature, Geometry, HalfSpace, Mesh, Piece};
use lin_canny_c::*;

/// Queries of each kind.
const QUERIES: usize = 10_000;

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

/// Returns a geometry of each constructor that [`geometries`] leaves out, in Rust and in C.
fn other_geometries() -> Vec<(Geometry, lc_geometry)> {
    let mut random = Random(5);
    let points = |v: &[[f64; 3]]| v.iter().map(|p| Point3::from(*p)).collect::<Vec<_>>();
    let shape = |kind: u32, parameters: &[f64]| {
        // SAFETY: an array of the stated length.
        written(|out| unsafe { lc_shape_new(kind, parameters.as_ptr(), parameters.len(), out) })
    };
    let mut all: Vec<(Geometry, lc_geometry)> = vec![
        (Shape::ball(0.5).unwrap().into(), shape(LC_BALL, &[0.5])),
        (
            Shape::capsule(0.5, 0.25).unwrap().into(),
            shape(LC_CAPSULE, &[0.5, 0.25]),
        ),
        (Shape::cone(0.5, 0.25).unwrap().into(), shape(LC_CONE, &[0.5, 0.25])),
        (
            ConvexPolyhedron::point(Point3::new(0.5, 0.25, 0.75)).unwrap().into(),
            shape(LC_POINT, &[0.5, 0.25, 0.75]),
        ),
    ];

    let pyramid = [
        [-1.0, -1.0, 0.0],
        [1.0, -1.0, 0.0],
        [1.0, 1.0, 0.0],
        [-1.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
    ];
    let base = &pyramid[..4];
    // SAFETY: an array of the stated length.
    let polygon = written(|out| unsafe { lc_polygon_new(base.as_ptr().cast(), 4, out) });
    all.push((ConvexPolyhedron::polygon(&points(base)).unwrap().into(), polygon));
    let sizes = [4_u32, 3, 3, 3, 3];
    let indices = [3_u32, 2, 1, 0, 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4];
    let of_c = (pyramid.as_ptr().cast(), sizes.as_ptr(), indices.as_ptr());
    // SAFETY: arrays of the stated lengths.
    let faces = written(|out| unsafe { lc_faces_new(of_c.0, 5, of_c.1, 5, of_c.2, indices.len(), out) });
    let (bottom, sides) = indices.split_at(4);
    let all_faces: Vec<&[u32]> = std::iter::once(bottom).chain(sides.chunks(3)).collect();
    let rust = ConvexPolyhedron::from_faces(&points(&pyramid), &all_faces).unwrap();
    all.push((rust.into(), faces));

    let heights: Vec<f64> = (0..12).map(|_| random.uniform()).collect();
    for base in [None, Some(-2.0)] {
        let given = base.as_ref().map_or(null(), |z: &f64| &raw const *z);
        // SAFETY: arrays of the stated lengths, and a base or null.
        let mesh = written(|out| unsafe { lc_heights_new(heights.as_ptr(), 3, 4, 0.5, 0.25, given, out) });
        let rust = Mesh::from_heights(3, 4, [0.5, 0.25], &heights, base).unwrap();
        all.push((rust.into(), mesh));
    }

    let places: Vec<[f64; 3]> = (0..30).map(|_| random.vector(1.0)).collect();
    let radii: Vec<f64> = (1..=30).map(|k| 0.01 * f64::from(k)).collect();
    // SAFETY: arrays of the stated lengths.
    let cloud = written(|out| unsafe { lc_cloud_new(places.as_ptr().cast(), 30, 0.0, radii.as_ptr(), out) });
    let rust = Cloud::new(&points(&places), CloudElement::Balls(radii)).unwrap();
    all.push((rust.into(), cloud));
    let origin = [0.25, 0.5, -1.0];
    let size = [0.5, 0.25, 0.75];
    let cells = [[0_u16, 0, 0], [3, 1, 2], [1, 2, 0]];
    // SAFETY: arrays of the stated lengths.
    let voxels = written(|out| unsafe { lc_voxels_new(origin.as_ptr(), size.as_ptr(), cells.as_ptr().cast(), 3, out) });
    let rust = Cloud::from_cells(origin.into(), size.into(), &cells).unwrap();
    all.push((rust.into(), voxels));

    // Two rational patches of different degrees.
    let net: Vec<[f64; 3]> = (0..12)
        .map(|k| {
            let (x, y) = (f64::from(k % 6 / 3) + f64::from(k / 6), f64::from(k % 3) - 1.0);
            [x, y, 0.3 * x * y]
        })
        .collect();
    let weights: Vec<f64> = (0..12).map(|k| 1.0 + 0.1 * f64::from(k % 5)).collect();
    // SAFETY: arrays of two patches of six control points.
    let surface = written(|out| unsafe { lc_surface_new(1, 2, net.as_ptr().cast(), weights.as_ptr(), 2, out) });
    let patch = |k: usize| BezierPatch::rational([1, 2], &points(&net[6 * k..][..6]), &weights[6 * k..][..6]).unwrap();
    all.push((BezierSurface::new(vec![patch(0), patch(1)]).unwrap().into(), surface));
    all
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
    let repaired = written(|out| unsafe { lc_mesh_repaired_new(vertices, 8, indices, 11, 0.0, None, null_mut(), out) });
    // SAFETY: a place of the stated size.
    let repair = written(|out| unsafe { lc_geometry_get_repair(repaired, out, size_of::<lc_mesh_repair>()) });
    assert_eq!((repair.caps, repair.longest_loop, repair.is_empty), (1, 3, 0));
    let solid = Mesh::repaired(&points(&cube), &triangles[..11], &RepairOptions::default()).unwrap();
    assert_eq!(
        solid.report().repair.as_deref().map(|of| of.cap_share),
        Some(repair.cap_share)
    );
    all.push((solid.into(), repaired));
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

fn feature(feature: Feature) -> [u32; 2] {
    [feature.dimension() as u32, feature.index() as u32]
}

/// Compares an answer in the world with an outcome.
fn same(r: &Outcome, subshapes: [u32; 2], pose: &RelativePose, c: &lc_answer, name: &str) {
    let world = r.in_world(pose);
    same_points(
        [r.distance, r.lower, r.upper],
        [
            world.point_on_a.into(),
            world.point_on_b.into(),
            world.normal.into_inner().into(),
        ],
        c,
        name,
    );
    assert_eq!(c.answered, LC_DISTANCE | LC_POINTS | LC_FEATURES);
    assert_eq!(subshapes, c.subshapes, "{name}");
    let features = [feature(r.features.a), feature(r.features.b)];
    assert_eq!(features, [c.feature_a, c.feature_b], "{name}");
}

fn same_points(numbers: [f64; 3], vectors: [[f64; 3]; 3], c: &lc_answer, name: &str) {
    assert_eq!(bits(numbers), bits([c.distance, c.lower, c.upper]), "{name}");
    let found = [c.point_on_a, c.point_on_b, c.normal];
    assert_eq!(vectors.map(bits), found.map(bits), "{name}");
}

/// Compares a hit with that of Rust, and returns whether it is one.
fn same_hit(r: &RayCast, c: &lc_ray_hit) -> bool {
    match r {
        RayCast::Miss => assert_eq!((c.state, c.hit), (LC_MISS, f64::INFINITY)),
        RayCast::Inside => assert_eq!((c.state, c.hit), (LC_AT_START, 0.0)),
        RayCast::Hit(r) => {
            assert_eq!((c.state, c.subshape), (LC_HIT, r.subshape));
            assert_eq!(bits([r.safe, r.hit]), bits([c.safe, c.hit]));
            assert_eq!(bits(r.point.into()), bits(c.point));
            assert_eq!(bits(r.normal.into_inner().into()), bits(c.normal));
            return true;
        }
        RayCast::Undecided { safe } => {
            assert_eq!((c.state, c.safe, c.hit), (LC_UNCLEAR, *safe, f64::INFINITY));
        }
        other => panic!("{other:?}"),
    }
    false
}

#[test]
fn boxes_have_the_bits_of_rust() {
    let mut random = Random(6);
    for (geometry, handle) in geometries().into_iter().chain(other_geometries()) {
        for _ in 0..QUERIES / 10 {
            let pose = random.pose(5.0);
            let (low, high) = geometry.aabb_at(&pose, &mut BoxHint::default());
            // SAFETY: a pose and a place for six numbers.
            let c: [[f64; 3]; 2] =
                written(|out: *mut [[f64; 3]; 2]| unsafe { lc_geometry_box(handle, &of(&pose), out.cast()) });
            assert_eq!([bits(low.into()), bits(high.into())], c.map(bits));
        }
    }
}

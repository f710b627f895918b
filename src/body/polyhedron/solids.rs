//! Common solids around the origin. All sizes are half sizes: half extents along x, y and z, half
//! heights along z, and radii. [`Shape`](crate::Shape) has the same convention.
//!
//! Sines and cosines come from `libm`, so every target builds identical bits. This file also holds
//! the constructors of bodies without volume: a point, a segment, a convex polygon.

use crate::base::callbacks::Watch;
use crate::base::num::each::Each;
use crate::base::num::scalar::sqrt;
use crate::base::num::sign::{projection, side, turn};
use crate::base::num::sort::sort;
use crate::base::tolerance::{EXTENT_MAX, EXTENT_MIN, PLANARITY};
use crate::body::polyhedron::ConvexPolyhedron;
use crate::body::polyhedron::build::cloud::{Cloud, power_of_two};
use crate::body::polyhedron::build::error::BuildError;
use crate::body::polyhedron::build::flat;
use crate::body::polyhedron::plane::{plane, widest_corners};
use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::TAU;
use nalgebra::{Point3, Vector3};

/// Largest number of vertices around a prism or cone, and of points of a random hull.
const COUNT_MAX: usize = 1 << 24;

/// Largest number of subdivisions of a geodesic sphere: 2.6 million vertices.
const SUBDIVISIONS_MAX: usize = 9;

fn size(what: &'static str, value: f64) -> Result<f64, BuildError> {
    if (EXTENT_MIN..=EXTENT_MAX).contains(&value) {
        Ok(value)
    } else {
        Err(BuildError::BadSize { what, value })
    }
}

fn check_count(what: &'static str, count: usize, least: usize, most: usize) -> Result<(), BuildError> {
    if (least..=most).contains(&count) {
        Ok(())
    } else {
        Err(BuildError::BadCount {
            what,
            count,
            least,
            most,
        })
    }
}

/// Returns a box with faces perpendicular to the axes.
///
/// # Errors
///
/// Returns an error if a half extent is outside 1e-100..1e100.
#[doc(alias = "box")]
pub fn cuboid(half_extents: Vector3<f64>) -> Result<ConvexPolyhedron, BuildError> {
    for x in half_extents.iter() {
        size("half extent", *x)?;
    }
    let corner = |k: usize| {
        let sign = Vector3::from_fn(|axis, _| if k >> axis & 1 == 1 { 1.0 } else { -1.0 });
        Point3::from(half_extents.component_mul(&sign))
    };
    ConvexPolyhedron::from_points(&(0..8).map(corner).collect::<Vec<_>>())
}

fn circle(n: usize, radius: f64, z: f64) -> impl Iterator<Item = Point3<f64>> {
    (0..n).map(move |k| {
        let angle = TAU * k as f64 / n as f64;
        Point3::new(radius * libm::cos(angle), radius * libm::sin(angle), z)
    })
}

/// Returns a prism along z over a regular polygon of `n` vertices.
///
/// It extends from `-half_height` to `half_height`. The vertices are at distance `radius` from the
/// axis, the first in the direction of x.
///
/// # Errors
///
/// Returns an error if there are fewer than three vertices, or a size is outside 1e-100..1e100.
#[doc(alias = "cylinder")]
pub fn prism(n: usize, half_height: f64, radius: f64) -> Result<ConvexPolyhedron, BuildError> {
    check_count("vertices around the axis", n, 3, COUNT_MAX)?;
    let (half_height, radius) = (size("half height", half_height)?, size("radius", radius)?);
    let points: Vec<_> = circle(n, radius, -half_height)
        .chain(circle(n, radius, half_height))
        .collect();
    ConvexPolyhedron::from_points(&points)
}

/// Returns a pyramid over a regular polygon of `n` vertices.
///
/// The base is in the plane `z = -half_height`, the apex at `z = half_height`.
///
/// # Errors
///
/// Returns an error if there are fewer than three vertices, or a size is outside 1e-100..1e100.
#[doc(alias = "pyramid")]
pub fn cone(n: usize, half_height: f64, radius: f64) -> Result<ConvexPolyhedron, BuildError> {
    check_count("vertices around the axis", n, 3, COUNT_MAX)?;
    let (half_height, radius) = (size("half height", half_height)?, size("radius", radius)?);
    let apex = Point3::new(0.0, 0.0, half_height);
    let points: Vec<_> = circle(n, radius, -half_height).chain([apex]).collect();
    ConvexPolyhedron::from_points(&points)
}

/// Returns a regular tetrahedron with its vertices at distance `radius`, in alternate corners of a
/// cube.
///
/// # Errors
///
/// Returns an error if the radius is outside 1e-100..1e100.
pub fn tetrahedron(radius: f64) -> Result<ConvexPolyhedron, BuildError> {
    let s = size("radius", radius)? / sqrt(3.0);
    let signs = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    ConvexPolyhedron::from_points(&signs.each(|[x, y, z]| Point3::new(s * x, s * y, s * z)))
}

/// Returns a regular octahedron with its vertices on the axes at distance `radius`.
///
/// # Errors
///
/// Returns an error if the radius is outside 1e-100..1e100.
pub fn octahedron(radius: f64) -> Result<ConvexPolyhedron, BuildError> {
    let r = size("radius", radius)?;
    let points: Vec<_> = (0..6)
        .map(|k| Point3::from(Vector3::ith(k / 2, if k % 2 == 0 { r } else { -r })))
        .collect();
    ConvexPolyhedron::from_points(&points)
}

/// Returns the twelve points `(0, +-a, +-b)` and their cyclic shifts.
fn golden_rectangles(a: f64, b: f64) -> impl Iterator<Item = Point3<f64>> {
    (0..12).map(move |k| {
        let (y, z) = (if k & 1 == 0 { a } else { -a }, if k & 2 == 0 { b } else { -b });
        match k / 4 {
            0 => Point3::new(0.0, y, z),
            1 => Point3::new(z, 0.0, y),
            _ => Point3::new(y, z, 0.0),
        }
    })
}

/// Returns a regular icosahedron with its vertices at distance `radius`.
///
/// # Errors
///
/// Returns an error if the radius is outside 1e-100..1e100.
pub fn icosahedron(radius: f64) -> Result<ConvexPolyhedron, BuildError> {
    ConvexPolyhedron::from_points(&icosahedron_points(size("radius", radius)?))
}

fn icosahedron_points(radius: f64) -> Vec<Point3<f64>> {
    let golden = (1.0 + sqrt(5.0)) / 2.0;
    let s = radius / sqrt(1.0 + golden * golden);
    golden_rectangles(s, s * golden).collect()
}

/// Returns a dodecahedron of twelve exactly planar pentagons with its vertices at distance
/// `radius`.
///
/// A regular dodecahedron has no exact coordinates in f64, and rounding would split the pentagons
/// into triangles. For any ratio h the points `(+-1, +-1, +-1)` and the cyclic shifts of `(0, +-(1
/// + h), +-(1 - h^2))` form planar pentagons. Here h is a ratio of Fibonacci numbers, 1e-8 from the
/// golden ratio, and the scale has so few digits that no coordinate is rounded. All vertices lie
/// within 3e-8 `radius` of their regular positions.
///
/// # Errors
///
/// Returns an error if the radius is outside 1e-100..1e100.
pub fn dodecahedron(radius: f64) -> Result<ConvexPolyhedron, BuildError> {
    let radius = size("radius", radius)?;
    let (p, q) = (4181.0, 6765.0);
    let exact = radius / (sqrt(3.0) * q * q);
    // 26 digits, and integers below 2^27.
    let scale = f64::from_bits((exact.to_bits() + (1 << 26)) & !((1 << 27) - 1));
    let cube = (0..8).map(|k| {
        let sign = |axis: u32| {
            if k >> axis & 1 == 1 {
                scale * (q * q)
            } else {
                -(scale * (q * q))
            }
        };
        Point3::new(sign(0), sign(1), sign(2))
    });
    let rest = golden_rectangles(scale * (q * (q + p)), scale * (q * q - p * p));
    ConvexPolyhedron::from_points(&cube.chain(rest).collect::<Vec<_>>())
}

/// Returns a geodesic sphere with `10 * 4^subdivisions + 2` vertices at distance `radius`.
///
/// It is an icosahedron whose triangles are divided into four, `subdivisions` times.
///
/// # Errors
///
/// Returns an error if there are more than 9 subdivisions, or the radius is outside 1e-100..1e100.
#[doc(alias = "icosphere")]
pub fn geodesic_sphere(subdivisions: u32, radius: f64) -> Result<ConvexPolyhedron, BuildError> {
    let radius = size("radius", radius)?;
    check_count("subdivisions", subdivisions as usize, 0, SUBDIVISIONS_MAX)?;
    let mut points: Vec<Vector3<f64>> = icosahedron_points(1.0).iter().map(|p| p.coords).collect();
    let icosahedron = ConvexPolyhedron::from_points(&icosahedron_points(1.0))?;
    let corner = |v| icosahedron.source_vertex(v).unwrap_or(0) as u32;
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    for face in icosahedron.faces() {
        let rim: Vec<u32> = icosahedron.face_vertices(face).map(corner).collect();
        if let [a, b, c] = rim[..] {
            triangles.push([a, b, c]);
        }
    }
    for _ in 0..subdivisions {
        triangles = divide(&triangles, &mut points);
    }
    ConvexPolyhedron::from_points(&points.iter().map(|p| Point3::from(p * radius)).collect::<Vec<_>>())
}

/// Divides each triangle into four at the midpoints of its edges, moved out to the unit sphere.
fn divide(triangles: &[[u32; 3]], points: &mut Vec<Vector3<f64>>) -> Vec<[u32; 3]> {
    let edges_of = |t: &[u32; 3]| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])].each(|(a, b)| (a.min(b), a.max(b)));
    let mut edges: Vec<(u32, u32)> = triangles.iter().flat_map(edges_of).collect();
    edges.sort_unstable();
    edges.dedup();
    let base = points.len() as u32;
    for &(a, b) in &edges {
        let middle = points[a as usize] + points[b as usize];
        points.push(middle / sqrt(middle.norm_squared()));
    }
    let divided = triangles.iter().flat_map(|t| {
        let [ab, bc, ca] = edges_of(t).each(|e| base + edges.partition_point(|x| *x < e) as u32);
        let [a, b, c] = *t;
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    });
    divided.collect()
}

/// Returns the hull of `n` random points on an ellipsoid.
///
/// Directions are uniform on the unit sphere and scaled by `semi_axes`. Equal seeds give identical
/// bits on every target.
///
/// # Errors
///
/// Returns an error if there are fewer than four points, or a semi-axis is outside 1e-100..1e100.
pub fn random_hull(n: usize, semi_axes: Vector3<f64>, seed: u64) -> Result<ConvexPolyhedron, BuildError> {
    check_count("points", n, 4, COUNT_MAX)?;
    for x in semi_axes.iter() {
        size("semi-axis", *x)?;
    }
    let mut state = seed;
    let points: Vec<_> = (0..n)
        .map(|_| {
            let z = 2.0 * uniform(&mut state) - 1.0;
            let angle = TAU * uniform(&mut state);
            let r = sqrt(1.0 - z * z);
            let direction = Vector3::new(r * libm::cos(angle), r * libm::sin(angle), z);
            Point3::from(direction.component_mul(&semi_axes))
        })
        .collect();
    ConvexPolyhedron::from_points(&points)
}

/// Returns the next number of SplitMix64 (Steele, Lea, Flood 2014), as a fraction in [0, 1).
fn uniform(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (*state ^ *state >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ z >> 31) >> 11) as f64 / (1u64 << 53) as f64
}

impl ConvexPolyhedron {
    /// Returns a body of one point: one vertex, no edge, no face.
    ///
    /// # Errors
    ///
    /// Returns an error if a coordinate is not finite.
    pub fn point(point: Point3<f64>) -> Result<Self, BuildError> {
        let cloud = Cloud::new(&[point], vec![0], 1, EXTENT_MIN)?;
        Self::assemble(&cloud, &[0], &[])
    }

    /// Returns the segment between two different points: two vertices, one edge, no face.
    ///
    /// # Errors
    ///
    /// Returns an error if a coordinate is not finite, if the points are equal
    /// ([`BuildError::Flat`] of dimension 0), or if the length is outside 1e-100..1e100.
    pub fn segment(start: Point3<f64>, end: Point3<f64>) -> Result<Self, BuildError> {
        Self::segment_of(start, end, EXTENT_MIN)
    }

    /// Returns a segment as [`segment`](Self::segment) does, with a length of at least `least`.
    pub(crate) fn segment_of(start: Point3<f64>, end: Point3<f64>, least: f64) -> Result<Self, BuildError> {
        let cloud = Cloud::new(&[start, end], vec![0, 1], 2, least)?;
        if cloud.points.len() < 2 {
            return Err(flat(&cloud, &vec![0]));
        }
        Self::assemble(&cloud, &[0, 1], &[vec![0, 1]])
    }

    /// Returns the convex hull of coplanar points, in any order: a body with two faces, one per
    /// side.
    ///
    /// Seen from outside the first face, the first three given points that are not collinear are in
    /// counter-clockwise order.
    ///
    /// Points exactly in one plane give a body without thickness. Points that leave a plane by
    /// rounding only, up to 64 UNIT times the diagonal of the box, are accepted too. In general
    /// rounded coordinates cannot be moved back into one plane, so the body is then their exact
    /// hull: a sliver, with the faces of a sliver. The body is always the hull of the stored
    /// points.
    ///
    /// # Errors
    ///
    /// Returns an error if there are fewer than three points, if they are collinear or equal, if a
    /// coordinate is not finite, if the extent is outside 1e-100..1e100, or if a point is farther
    /// from the plane.
    pub fn polygon(points: &[Point3<f64>]) -> Result<Self, BuildError> {
        Self::polygon_of(points, EXTENT_MIN)
    }

    /// Returns a polygon as [`polygon`](Self::polygon) does, with an extent of at least `least`.
    pub(crate) fn polygon_of(points: &[Point3<f64>], least: f64) -> Result<Self, BuildError> {
        let indices = (0..points.len().min(u32::MAX as usize) as u32).collect();
        let cloud = Cloud::new(points, indices, 3, least)?;
        let all: Vec<u32> = (0..cloud.points.len() as u32).collect();
        let Some((corners, axis)) = spanning_corners(&cloud) else {
            let span = if all.len() < 2 {
                all
            } else {
                vec![0, all.len() as u32 - 1]
            };
            return Err(flat(&cloud, &span));
        };
        let [a, b, c] = corners.each(|i| &cloud.points[i as usize]);
        if cloud.points.iter().any(|p| side(a, b, c, p) != 0.0) {
            check_planar(&cloud, a, &plane(a, b, c, 0.0).0.normal)?;
            return Self::hull_of(cloud, &mut Watch::none());
        }
        let forward = first_turn(&cloud, points, axis) > 0.0;
        let (rim, on_edges) = planar_hull(&cloud.points, axis);
        let mut kept = rim.clone();
        kept.sort_unstable();
        let number = |i: &u32| kept.partition_point(|k| k < i) as u32;
        let mut front: Vec<u32> = rim.iter().map(number).collect();
        if !forward {
            front.reverse();
        }
        let start = front.iter().position(|&v| v == 0).unwrap_or(0);
        front.rotate_left(start);
        let back: Vec<u32> = front.iter().rev().copied().collect();
        let mut body = Self::assemble(&cloud, &kept, &[front, back])?;
        body.report.on_edges = on_edges.iter().map(|&i| cloud.source[i as usize]).collect();
        let inner = all
            .iter()
            .filter(|i| kept.binary_search(i).is_err() && on_edges.binary_search(i).is_err());
        body.report.on_faces = inner.map(|&i| cloud.source[i as usize]).collect();
        Ok(body)
    }
}

/// Returns three points far from collinear and an axis along which they project to a triangle.
fn spanning_corners(cloud: &Cloud) -> Option<([u32; 3], usize)> {
    let points = &cloud.points;
    if points.len() < 3 {
        return None;
    }
    let all: Vec<u32> = (0..points.len() as u32).collect();
    let wide = widest_corners(points, &all);
    let [a, b, c] = wide.each(|i| &points[i as usize]);
    // The widest axis keeps the projection wide as well.
    let normal = (b - a).cross(&(c - a));
    if turn(normal.iamax(), a, b, c) != 0.0 {
        return Some((wide, normal.iamax()));
    }
    let (a, b) = (0, all.len() as u32 - 1);
    let at = |i: u32| &points[i as usize];
    all.into_iter()
        .find_map(|c| projection(at(a), at(b), at(c)).map(|axis| ([a, b, c], axis)))
}

/// Returns the orientation of the caller's first three points that are not collinear, projected
/// along `axis`.
fn first_turn(cloud: &Cloud, points: &[Point3<f64>], axis: usize) -> f64 {
    let Some(a) = points.first() else { return 1.0 };
    let Some(b) = points.iter().find(|p| *p != a) else {
        return 1.0;
    };
    let [a, b] = [a, b].each(|p| cloud.place(p));
    let turns = points.iter().map(|c| turn(axis, &a, &b, &cloud.place(c)));
    turns.into_iter().find(|t| *t != 0.0).unwrap_or(1.0)
}

fn check_planar(cloud: &Cloud, base: &Vector3<f64>, normal: &Vector3<f64>) -> Result<(), BuildError> {
    let off = |p: &Vector3<f64>| normal.dot(&(p - base)).abs();
    let (worst, p) = cloud
        .points
        .iter()
        .enumerate()
        .fold((0, base), |best, x| if off(x.1) > off(best.1) { x } else { best });
    let (distance, bound) = (off(p), PLANARITY * cloud.diagonal());
    if distance > bound {
        let unit = power_of_two(cloud.exponent);
        let index = cloud.source[worst] as usize;
        return Err(BuildError::PolygonNotPlanar {
            index,
            distance: distance * unit,
            bound: bound * unit,
        });
    }
    Ok(())
}

/// Returns the vertices of the hull of exactly coplanar points, counter-clockwise in the projection
/// along `axis`, and the points inside its edges in ascending order. Andrew's monotone chain (1979)
/// with exact orientation tests.
fn planar_hull(points: &[Vector3<f64>], axis: usize) -> (Vec<u32>, Vec<u32>) {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    sort(&mut order, |&i, &j| {
        let (p, q) = (&points[i as usize], &points[j as usize]);
        p[u].total_cmp(&q[u]).then(p[v].total_cmp(&q[v])).then(i.cmp(&j))
    });
    let mut rank = vec![0u32; points.len()];
    order.iter().zip(0u32..).for_each(|(&i, r)| rank[i as usize] = r);
    let turns = |a: u32, b: u32, c: u32| turn(axis, &points[a as usize], &points[b as usize], &points[c as usize]);
    let chain_of = |order: &mut dyn Iterator<Item = u32>| {
        let mut chain: Vec<u32> = Vec::new();
        for i in order {
            while let [.., a, b] = chain[..]
                && turns(a, b, i) <= 0.0
            {
                chain.pop();
            }
            chain.push(i);
        }
        chain
    };
    let lower = chain_of(&mut order.iter().copied());
    let mut upper = chain_of(&mut order.iter().rev().copied());
    let mut rim = lower.clone();
    rim.pop();
    rim.extend(&upper[..upper.len() - 1]);
    upper.reverse();
    // Both chains rise: a point can only lie on the link of a chain that passes over or under the
    // point.
    let on_chain = |chain: &[u32], p: u32| {
        let k = chain.partition_point(|&i| rank[i as usize] < rank[p as usize]);
        0 < k && k < chain.len() && chain[k] != p && turns(chain[k - 1], chain[k], p) == 0.0
    };
    let mut is_corner = vec![false; points.len()];
    rim.iter().for_each(|&i| is_corner[i as usize] = true);
    let others = (0..points.len() as u32).filter(|&p| !is_corner[p as usize]);
    let on_edges = others.filter(|&p| on_chain(&lower, p) || on_chain(&upper, p)).collect();
    (rim, on_edges)
}

//! Constructors of flat bodies: a point, a segment, a convex polygon.

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Point3, Vector3};

use crate::base::notice::progress::Watch;
use crate::base::num::sign::{projection, side, turn};
use crate::base::tolerance::PLANARITY;
use crate::body::polyhedron::ConvexPolyhedron;
use crate::body::polyhedron::build::cloud::{Cloud, power_of_two};
use crate::body::polyhedron::build::error::BuildError;
use crate::body::polyhedron::build::flat;
use crate::body::polyhedron::plane::{plane, widest_corners};

impl ConvexPolyhedron {
    /// Returns a body of one point: one vertex, no edge, no face.
    ///
    /// # Errors
    ///
    /// A coordinate that is not finite.
    pub fn point(point: Point3<f64>) -> Result<Self, BuildError> {
        let cloud = Cloud::new(&[point], vec![0], 1)?;
        Self::assemble(&cloud, &[0], &[])
    }

    /// Returns the segment between two different points: two vertices, one edge, no face.
    ///
    /// # Errors
    ///
    /// A coordinate that is not finite, equal points ([`BuildError::Flat`] of dimension 0), or a
    /// length outside 1e-100..1e100.
    pub fn segment(start: Point3<f64>, end: Point3<f64>) -> Result<Self, BuildError> {
        let cloud = Cloud::new(&[start, end], vec![0, 1], 2)?;
        if cloud.points.len() < 2 {
            return Err(flat(&cloud, &vec![0]));
        }
        Self::assemble(&cloud, &[0, 1], &[vec![0, 1]])
    }

    /// Returns the convex hull of coplanar points, in any order: a body with two faces, one for
    /// each side. Seen from outside the first face, the first three given points that are not
    /// collinear turn counter-clockwise.
    ///
    /// Points exactly in one plane make a body without thickness. Points that leave a plane by
    /// rounding only, up to 64 UNIT times the diagonal of the box, are accepted too; rounded
    /// coordinates cannot in general be put back into one plane, so the body is then their exact
    /// hull, a sliver with the faces of a sliver: always the hull of the stored points.
    ///
    /// # Errors
    ///
    /// Fewer than three points, collinear or equal points, a coordinate that is not finite, an
    /// extent outside 1e-100..1e100, or a point farther off the plane.
    pub fn polygon(points: &[Point3<f64>]) -> Result<Self, BuildError> {
        let indices = (0..points.len().min(u32::MAX as usize) as u32).collect();
        let cloud = Cloud::new(points, indices, 3)?;
        let all: Vec<u32> = (0..cloud.points.len() as u32).collect();
        let Some((corners, axis)) = spanning_corners(&cloud) else {
            let span = if all.len() < 2 {
                all
            } else {
                vec![0, all.len() as u32 - 1]
            };
            return Err(flat(&cloud, &span));
        };
        let [a, b, c] = corners.map(|i| &cloud.points[i as usize]);
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
    let [a, b, c] = wide.map(|i| &points[i as usize]);
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
    let [a, b] = [a, b].map(|p| cloud.place(p));
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
/// along `axis`, and the points inside its edges in rising order. Andrew's monotone chain (1979)
/// with exact turns.
fn planar_hull(points: &[Vector3<f64>], axis: usize) -> (Vec<u32>, Vec<u32>) {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    order.sort_unstable_by(|&i, &j| {
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

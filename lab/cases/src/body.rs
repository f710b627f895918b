//! Bodies as plain data, and bodies at exact poses: vertices, edges and face normals over the
//! integers.

use crate::rational::{IntVec, cross, dot, placed_together, sub};
use crate::shapes::Shape;
use crate::{Face, Point, Pose};
use dashu_int::IBig;

/// A body as plain data.
///
/// Faces must be exactly planar and counter-clockwise from outside ([`crate::brute_hull::faces`]
/// computes them). Points that no face uses must lie in the body. Two points without a face are a
/// segment, one point is a point. At least one body of a pair must be solid.
#[derive(Clone, Copy, Debug)]
pub struct Body<'a> {
    /// Vertices in the body's frame.
    pub points: &'a [Point],
    /// Faces, merged or triangulated.
    pub faces: &'a [Face],
}

impl<'a> Body<'a> {
    /// Returns the body of points and faces.
    pub const fn new(points: &'a [Point], faces: &'a [Face]) -> Self {
        Self { points, faces }
    }
}

impl<'a> From<&'a Shape> for Body<'a> {
    fn from(shape: &'a Shape) -> Self {
        Self::new(&shape.points, &shape.faces)
    }
}

/// Both ends of an edge.
pub type Edge = [IntVec; 2];

/// A body at a pose, over the integers.
#[derive(Clone, Debug)]
pub struct Placed {
    /// The points.
    pub points: Vec<IntVec>,
    /// Each edge once.
    pub edges: Vec<Edge>,
    /// Vertices of each face and its outward normal, of any length.
    pub faces: Vec<(Vec<IntVec>, IntVec)>,
}

/// Puts two bodies exactly at their poses. Returns them over one common denominator, and the
/// denominator.
pub fn place_two(a: Body, pose_a: &Pose, b: Body, pose_b: &Pose) -> (Placed, Placed, IBig) {
    let (pa, pb, den) = placed_together(a.points, pose_a, b.points, pose_b);
    (Placed::new(pa, a.faces), Placed::new(pb, b.faces), den.into())
}

impl Placed {
    /// Computes edges and normals of points that are already at their poses.
    pub fn new(points: Vec<IntVec>, faces: &[Face]) -> Self {
        let at = |i: u32| points[i as usize].clone();
        let corners = faces.iter().map(|f| f.iter().map(|&i| at(i)).collect::<Vec<_>>());
        let faces_out = corners.map(|c| (normal(&c), c)).map(|(n, c)| (c, n)).collect();
        let edges = edge_ids(points.len(), faces)
            .into_iter()
            .map(|[i, j]| [at(i), at(j)])
            .collect();
        Self {
            edges,
            faces: faces_out,
            points,
        }
    }

    /// Returns the least and greatest `n . p` over the body, which must not be empty.
    pub fn extent(&self, n: &IntVec) -> (IBig, IBig) {
        let dots: Vec<IBig> = self.points.iter().map(|p| dot(n, p)).collect();
        let end = |x: Option<&IBig>| x.expect("a body has points").clone();
        (end(dots.iter().min()), end(dots.iter().max()))
    }
}

/// Returns twice the area vector of a polygon, which is correct even if vertices are collinear.
fn normal(c: &[IntVec]) -> IntVec {
    let fan = c.windows(2).map(|w| cross(&sub(&w[0], &c[0]), &sub(&w[1], &c[0])));
    fan.reduce(|s, n| std::array::from_fn(|i| &s[i] + &n[i]))
        .expect("a face has corners")
}

/// Returns the edges of some faces as ascending pairs of points, each once. Two points without a
/// face are one edge.
pub fn edge_ids(points: usize, faces: &[Face]) -> Vec<[u32; 2]> {
    let sides = |f: &Face| {
        f.iter()
            .zip(f.iter().cycle().skip(1))
            .map(|(&i, &j)| [i.min(j), i.max(j)])
            .collect::<Vec<_>>()
    };
    let mut ids: Vec<[u32; 2]> = faces.iter().flat_map(sides).collect();
    if faces.is_empty() && points == 2 {
        ids.push([0, 1]);
    }
    ids.sort_unstable();
    ids.dedup();
    ids
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rational::rounded;
    use crate::shapes;
    use dashu_ratio::RBig;

    #[test]
    fn a_placed_box_has_its_edges_and_outward_normals() {
        let b = shapes::cuboid([1.0, 2.0, 3.0]);
        let pose = Pose::shift([0.25, 0.0, 0.0]);
        let (p, q, den) = place_two((&b).into(), &pose, (&b).into(), &Pose::IDENTITY);
        assert_eq!((p.points.len(), p.edges.len(), p.faces.len()), (8, 12, 6));
        let x = rounded(&RBig::from_parts_signed(
            p.extent(&[1.into(), 0.into(), 0.into()]).1,
            den,
        ));
        assert_eq!(x, 1.25);
        assert!(
            q.faces.iter().all(|(c, n)| dot(&c[0], n) > IBig::ZERO),
            "about the origin"
        );
    }

    #[test]
    fn two_points_are_a_segment_and_one_is_a_point() {
        assert_eq!(edge_ids(2, &[]), [[0, 1]]);
        assert!(edge_ids(1, &[]).is_empty());
        assert_eq!(edge_ids(3, &[vec![0, 1, 2], vec![2, 1, 0]]).len(), 3);
    }
}

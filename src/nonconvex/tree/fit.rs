//! Computes the extents of the boxes, rounded outward.

use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;
use nalgebra::Vector3;

use super::{Below, OrientedBox, Slab, Tree};
use crate::base::callbacks::Watch;
use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::base::num::sort::sort;
use crate::base::tolerance::{BOX_EXTENT, SLAB_HEIGHT, UNIT};

/// Least number of items of a node with a slab.
///
/// The vertices of smaller nodes are tested one by one.
const SLAB_ITEMS: usize = 32;

/// A node gets a slab if it is thinner than this fraction of the tree's size.
///
/// This is about the least thickness that single precision can represent.
const SLAB: f64 = 1.0 / 131_072.0;

/// Below a node with a slab, a node gets a slab only if it is thinner by this factor.
///
/// The memory is spent for the ties that only such slabs prove.
const THINNER: f64 = 1.0 / 16.0;

/// Least squared sine of the angle between an axis in a plane and the plane's normal.
///
/// It applies before the axis is made perpendicular, because the error that remains after this
/// grows with the cosine.
const FLAT: f64 = 0.99;

/// Vertices in the tree's coordinates, found by the range of items that use them.
struct Vertices<'a, I> {
    positions: Vec<Vector3<f64>>,
    /// The vertices in stored coordinates of the body.
    stored: &'a [Vector3<f64>],
    /// Error of a height of a stored vertex.
    doubt: f64,
    items: &'a [I],
    /// For each item, the number of vertices that the items before it use.
    before: Vec<u32>,
}

impl<'a, I: AsRef<[u32]>> Vertices<'a, I> {
    fn new(positions: Vec<Vector3<f64>>, stored: &'a [Vector3<f64>], doubt: f64, items: &'a [I]) -> Self {
        let mut most = 0;
        let mut before = vec![0];
        for item in items {
            most = item.as_ref().iter().fold(most, |m, &v| m.max(v + 1));
            before.push(most);
        }
        Self {
            positions,
            stored,
            doubt,
            items,
            before,
        }
    }

    /// Calls `visit` with every vertex of a range of items.
    ///
    /// Vertices that the range uses first are consecutive. It shares few vertices with earlier
    /// items.
    fn visit(&self, range: &Range<usize>, visit: impl FnMut(&Vector3<f64>)) {
        self.visit_of(&self.positions, range, visit);
    }

    fn visit_stored(&self, range: &Range<usize>, visit: impl FnMut(&Vector3<f64>)) {
        self.visit_of(self.stored, range, visit);
    }

    fn visit_of(&self, points: &[Vector3<f64>], range: &Range<usize>, mut visit: impl FnMut(&Vector3<f64>)) {
        let (low, high) = (self.before[range.start], self.before[range.end]);
        points[low as usize..high as usize].iter().for_each(&mut visit);
        let older = self.items[range.clone()]
            .iter()
            .flat_map(|i| i.as_ref())
            .filter(|v| **v < low);
        older.for_each(|&v| visit(&points[v as usize]));
    }
}

impl Tree {
    /// Computes the extents of every box.
    ///
    /// Items are in the tree's order, and vertices in the order in which the items use them.
    /// `error` bounds the position error of a vertex.
    pub(crate) fn fit<I: AsRef<[u32]>>(
        &mut self,
        points: &[Vector3<f64>],
        items: &[I],
        error: f64,
        watch: &mut Watch<'_>,
    ) {
        let (vertices, slack) = self.vertices(points, items, error);
        let ranges = self.ranges();
        self.nearest = vec![u32::MAX; ranges.len()];
        for (node, range) in ranges.iter().enumerate().take_while(|(node, _)| watch.done(*node)) {
            self.fit_node(node, range, &vertices, slack);
            if let Below::Children(c) = self.below(node as u32) {
                let own = self.nearest[node];
                self.nearest[c as usize..c as usize + 2].fill(own);
            }
        }
        if self.slabs.is_empty() {
            self.nearest = Vec::new();
        }
        self.slabs.shrink_to_fit();
        self.set_reach();
    }

    /// Computes the extents of some boxes like [`fit`](Self::fit), and drops all slabs.
    pub(crate) fn fit_again<I: AsRef<[u32]>>(&mut self, points: &[Vector3<f64>], items: &[I], nodes: &[u32]) {
        let (vertices, slack) = self.vertices(points, items, 0.0);
        let ranges = self.ranges();
        self.nearest = vec![u32::MAX; ranges.len()];
        for &node in nodes {
            self.fit_node(node as usize, &ranges[node as usize], &vertices, slack);
        }
        (self.slabs, self.nearest) = (Vec::new(), Vec::new());
        self.set_reach();
    }

    /// Returns the vertices in the tree's coordinates, and their position error there.
    fn vertices<'a, I: AsRef<[u32]>>(
        &self,
        points: &'a [Vector3<f64>],
        items: &'a [I],
        error: f64,
    ) -> (Vertices<'a, I>, f64) {
        let scale = crate::body::polyhedron::power_of_two(-self.exponent);
        let positions: Vec<_> = points.iter().map(|p| (p - self.centre) * scale).collect();
        // The error of the shift to the tree's origin.
        let farthest = points.iter().fold(self.centre.amax(), |m, p| m.larger(p.amax()));
        let slack = BOX_EXTENT * (1.0 + farthest * scale) + error * scale;
        let farthest = points.iter().fold(0.0, |m: f64, p| m.larger(p.norm_squared()));
        let doubt = SLAB_HEIGHT * sqrt(farthest) + error;
        (Vertices::new(positions, points, doubt, items), slack)
    }

    fn set_reach(&mut self) {
        let reach = |b: &OrientedBox| sqrt(b.centre().norm_squared()) + f64::from(b.radius());
        let reach = self.boxes.iter().map(reach).fold(0.0, f64::larger);
        self.reach = up(reach * (1.0 + 8.0 * UNIT));
    }

    /// Returns the items below every node; children have higher indices than their parents.
    pub(super) fn ranges(&self) -> Vec<Range<usize>> {
        let mut ranges = vec![0..0; self.links.len()];
        for node in (0..self.links.len()).rev() {
            ranges[node] = match self.below(node as u32) {
                Below::Leaf(first, count) => first as usize..(first + count) as usize,
                Below::Children(c) => ranges[c as usize].start..ranges[c as usize + 1].end,
            };
        }
        ranges
    }

    fn fit_node<I: AsRef<[u32]>>(&mut self, node: usize, range: &Range<usize>, vertices: &Vertices<I>, slack: f64) {
        let [mut low, mut high] = extents(&self.boxes[node], range, vertices);
        let sides = high - low;
        if sides[2] < sides[0] / 64.0 {
            // For a nearly flat node, the normal of the largest triangle is as good as any axis.
            if let Some(axes) = self.flat_axes(node, range, vertices) {
                self.boxes[node].set_axes(&axes);
                [low, high] = extents(&self.boxes[node], range, vertices);
                if range.len() >= SLAB_ITEMS {
                    self.push_slab(node, &axes, heights(&axes, range, vertices), vertices.doubt);
                }
            }
        }
        self.sort_axes(node, &mut low, &mut high);
        self.store_extents(node, &low, &high, range, vertices, slack);
    }

    /// Returns axes of a nearly flat node; the third is the normal of its largest triangle.
    ///
    /// The first is the axis of the spread or an edge of that triangle. Its rectangle has the least
    /// product of area and perimeter.
    fn flat_axes<I: AsRef<[u32]>>(
        &self,
        node: usize,
        range: &Range<usize>,
        vertices: &Vertices<I>,
    ) -> Option<[Vector3<f64>; 3]> {
        let ([a, b, c], normal) = largest_triangle(range, vertices)?;
        let flat = [self.boxes[node].axis(0), b - a, c - b, a - c].each(|v| {
            let across = v - normal * normal.dot(&v);
            let square = across.norm_squared();
            // The normal of a sliver may consist of rounding errors and not be perpendicular to its
            // edges.
            let is_flat = square > FLAT * v.norm_squared();
            let long = across / if is_flat { sqrt(square) } else { f64::NAN };
            [long, normal.cross(&long)]
        });
        let (mut low, mut high) = ([[f64::INFINITY; 2]; 4], [[f64::NEG_INFINITY; 2]; 4]);
        vertices.visit(range, |p| {
            for ((axes, low), high) in flat.iter().zip(&mut low).zip(&mut high) {
                for k in 0..2 {
                    let h = axes[k].dot(p);
                    (low[k], high[k]) = (low[k].smaller(h), high[k].larger(h));
                }
            }
        });
        // Rectangles around a triangle along any of its edges have the same area. A right triangle
        // fills the one of least perimeter.
        let size = |k: &usize| {
            let (length, width) = (high[*k][0] - low[*k][0], high[*k][1] - low[*k][1]);
            length * width * (length + width)
        };
        let best = (0..4)
            .filter(|&k| flat[k][0].iter().all(|x| x.is_finite()))
            .min_by(|i, j| size(i).total_cmp(&size(j)))?;
        let [long, wide] = flat[best];
        Some([long, wide, normal])
    }

    /// Stores a slab if the node is thin, and much thinner than the nearest ancestor with a slab.
    ///
    /// Heights are in stored units of the body and have an error of at most `slack`.
    fn push_slab(&mut self, node: usize, axes: &[Vector3<f64>; 3], [low, high]: [Vector3<f64>; 2], slack: f64) {
        let (unit, thickness) = (self.unit(), high.z - low.z);
        let above = self.slab(node as u32).map(|s| s.high[2] - s.low[2]);
        if !(thickness < SLAB * unit && above.is_none_or(|above| thickness < THINNER * above)) {
            return;
        }
        self.nearest[node] = self.slabs.len() as u32;
        self.slabs.push(Slab {
            axes: *axes,
            low: low.add_scalar(-slack).into(),
            high: high.add_scalar(slack).into(),
            doubt: 2.0 * slack,
        });
    }

    /// Sorts the axes by falling length of their sides.
    fn sort_axes(&mut self, node: usize, low: &mut Vector3<f64>, high: &mut Vector3<f64>) {
        let sides = *high - *low;
        let mut order = [0, 1, 2];
        sort(&mut order, |&i, &j| sides[j].total_cmp(&sides[i]));
        let axes = order.each(|k| self.boxes[node].axis(k));
        self.boxes[node].set_axes(&axes);
        (*low, *high) = (order.each(|k| low[k]).into(), order.each(|k| high[k]).into());
    }

    /// Stores the centre, the half extents and the radius.
    ///
    /// The centre is rounded first. Then the coordinates of every point relative to it are computed
    /// along the dual axes. So the axes as stored, which are not exactly orthonormal, span every
    /// point.
    fn store_extents<I: AsRef<[u32]>>(
        &mut self,
        node: usize,
        low: &Vector3<f64>,
        high: &Vector3<f64>,
        range: &Range<usize>,
        vertices: &Vertices<I>,
        slack: f64,
    ) {
        let dual = dual_axes(&self.boxes[node]);
        let middle = (low + high) * 0.5;
        let axes = [0, 1, 2].each(|k| self.boxes[node].axis(k));
        let centre = axes[0] * middle.x + axes[1] * middle.y + axes[2] * middle.z;
        let stored = [centre.x as f32, centre.y as f32, centre.z as f32];
        let centre = Vector3::from(stored.each(f64::from));
        let (mut half, mut square): (Vector3<f64>, f64) = (Vector3::zeros(), 0.0);
        vertices.visit(range, |p| {
            let d = p - centre;
            half = half.larger(Vector3::from_fn(|k, _| dual[k].dot(&d).abs()));
            square = square.larger(d.norm_squared());
        });
        let rows = &mut self.boxes[node].rows;
        for k in 0..3 {
            rows[2][1 + k] = stored[k];
            rows[3][k] = up(half[k] + slack);
        }
        rows[3][3] = up(sqrt(square) + slack);
    }
}

/// Returns the least and greatest coordinates of all vertices along the axes of a box.
fn extents<I: AsRef<[u32]>>(b: &OrientedBox, range: &Range<usize>, vertices: &Vertices<I>) -> [Vector3<f64>; 2] {
    let dual = dual_axes(b);
    let (mut low, mut high) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    vertices.visit(range, |p| {
        let s = Vector3::new(dual[0].dot(p), dual[1].dot(p), dual[2].dot(p));
        (low, high) = (low.smaller(s), high.larger(s));
    });
    [low, high]
}

/// Returns the least and greatest heights along three axes, in stored coordinates of the body.
fn heights<I: AsRef<[u32]>>(
    axes: &[Vector3<f64>; 3],
    range: &Range<usize>,
    vertices: &Vertices<I>,
) -> [Vector3<f64>; 2] {
    let (mut low, mut high) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    vertices.visit_stored(range, |p| {
        let h = Vector3::new(axes[0].dot(p), axes[1].dot(p), axes[2].dot(p));
        (low, high) = (low.smaller(h), high.larger(h));
    });
    [low, high]
}

/// Returns the dual axes: each is perpendicular to two axes and has product one with the third.
fn dual_axes(b: &OrientedBox) -> [Vector3<f64>; 3] {
    let [x, y, z] = [0, 1, 2].each(|k| b.axis(k));
    let volume = x.dot(&y.cross(&z));
    [y.cross(&z) / volume, z.cross(&x) / volume, x.cross(&y) / volume]
}

/// Returns the largest triangle of a range and its unit normal.
///
/// Of a convex piece, the triangle of its first three vertices is used.
fn largest_triangle<I: AsRef<[u32]>>(
    range: &Range<usize>,
    vertices: &Vertices<I>,
) -> Option<([Vector3<f64>; 3], Vector3<f64>)> {
    let normal = |item: &I| {
        let corners = item
            .as_ref()
            .first_chunk::<3>()?
            .each(|v| vertices.positions[v as usize]);
        let [a, b, c] = corners;
        Some((corners, (b - a).cross(&(c - a))))
    };
    let all = vertices.items[range.clone()].iter().filter_map(normal);
    let (corners, largest) = all.reduce(|m, n| if n.1.norm_squared() > m.1.norm_squared() { n } else { m })?;
    let unit = largest / sqrt(largest.norm_squared());
    unit.iter().all(|x| x.is_finite()).then_some((corners, unit))
}

/// Returns the least number in single precision that is not less than `x`.
pub(crate) fn up(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) < x { near.next_up() } else { near }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::base::tolerance::UNIT_SINGLE;
    use crate::nonconvex::mesh::Mesh;
    use crate::rng::Rng;
    use nalgebra::{Matrix3, Point3};
    use std::vec::Vec;

    /// The vertices of these triangles are nearly collinear. Their normals consist of rounding
    /// errors, and some are parallel to their edges.
    #[test]
    fn axes_of_slivers_are_orthonormal() {
        let mut rng = Rng::new(5);
        let (mut slabs, mut worst, mut worst_slab) = (0, 0.0f64, 0.0f64);
        for case in 0..2000 {
            let aside = 10f64.powi(-(case % 8));
            let e = Vector3::new(1.0, aside, aside);
            let mut points = Vec::new();
            for k in 0..3 * 40 {
                let at = e * (rng.range(0.0, 0.3) + f64::from(k / 3) / 40.0);
                points.push(Point3::from(
                    at.map(|x| x * (1.0 + f64::from(rng.below(3) as u32) * f64::EPSILON)),
                ));
            }
            let triangles: Vec<[u32; 3]> = (0..40).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
            let Ok(mesh) = Mesh::new(&points, &triangles) else {
                continue;
            };
            let gram = |axes: [Vector3<f64>; 3]| {
                let m = Matrix3::from_columns(&axes);
                (m.transpose() * m - Matrix3::identity()).amax()
            };
            for b in &mesh.tree.boxes {
                worst = worst.max(gram([0, 1, 2].map(|k| b.axis(k))));
            }
            for s in &mesh.tree.slabs {
                slabs += 1;
                worst_slab = worst_slab.max(gram(s.axes));
            }
        }
        assert!(slabs > 1000, "{slabs}");
        assert!(worst < 8.0 * UNIT_SINGLE && worst_slab < 8.0 * UNIT);
    }
}

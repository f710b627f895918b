//! Extents of the boxes, rounded outward.

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::Vector3;

use super::{Below, OrientedBox, Slab, Tree};
use crate::num::scalar::sqrt;
use crate::tolerance::{BOX_EXTENT, UNIT};

/// A node thinner than this part of the tree's size gets a slab: about as thin as single precision
/// can say.
const SLAB: f64 = 1.0 / 131_072.0;

/// Vertices in the tree's coordinates, by the range of triangles or pieces that use them.
struct Vertices<'a, I> {
    places: Vec<Vector3<f64>>,
    items: &'a [I],
    /// The number of vertices that the items before each use.
    before: Vec<u32>,
}

impl<'a, I: AsRef<[u32]>> Vertices<'a, I> {
    fn new(places: Vec<Vector3<f64>>, items: &'a [I]) -> Self {
        let mut most = 0;
        let mut before = vec![0];
        for item in items {
            most = item.as_ref().iter().fold(most, |m, &v| m.max(v + 1));
            before.push(most);
        }
        Self { places, items, before }
    }

    /// Calls `visit` with every vertex of the items from `first` to `last`: those that come up
    /// there first are consecutive, and corners of earlier ones are few.
    fn visit(&self, (first, last): (usize, usize), mut visit: impl FnMut(&Vector3<f64>)) {
        let (low, high) = (self.before[first], self.before[last]);
        self.places[low as usize..high as usize].iter().for_each(&mut visit);
        let older = self.items[first..last]
            .iter()
            .flat_map(|i| i.as_ref())
            .filter(|v| **v < low);
        older.for_each(|&v| visit(&self.places[v as usize]));
    }
}

impl Tree {
    /// Sets the extents of every box. Triangles or pieces are in the tree's order, vertices in the
    /// order in which these use them. No vertex is off its place by more than `error`.
    pub(crate) fn fit<I: AsRef<[u32]>>(&mut self, points: &[Vector3<f64>], items: &[I], error: f64) {
        let scale = crate::polyhedron::power_of_two(-self.exponent);
        let places: Vec<_> = points.iter().map(|p| (p - self.centre) * scale).collect();
        // What the shift to the tree's origin has rounded.
        let farthest = points.iter().fold(self.centre.amax(), |m, p| m.max(p.amax()));
        let slack = BOX_EXTENT * (1.0 + farthest * scale) + error * scale;
        let vertices = Vertices::new(places, items);
        let ranges = self.ranges();
        for (node, &range) in ranges.iter().enumerate() {
            self.fit_node(node, range, &vertices, slack);
        }
        let reach = |b: &OrientedBox| sqrt(b.centre().norm_squared()) + f64::from(b.radius());
        let reach = self.boxes.iter().map(reach).fold(0.0, f64::max);
        self.reach = up(reach * (1.0 + 8.0 * UNIT));
    }

    /// First and last triangle of every node. Children have higher numbers than their parents.
    fn ranges(&self) -> Vec<(usize, usize)> {
        let mut ranges = vec![(0, 0); self.links.len()];
        for node in (0..self.links.len()).rev() {
            ranges[node] = match self.below(node as u32) {
                Below::Leaf(first, count) => (first as usize, (first + count) as usize),
                Below::Children(c) => (ranges[c as usize].0, ranges[c as usize + 1].1),
            };
        }
        ranges
    }

    fn fit_node<I: AsRef<[u32]>>(&mut self, node: usize, range: (usize, usize), vertices: &Vertices<I>, slack: f64) {
        let (mut low, mut high) = extents(&self.boxes[node], range, vertices);
        let sides = high - low;
        if sides[2] < sides[0] / 64.0 {
            // Nearly flat: the normal of the largest triangle is as good an axis as there is.
            if let Some(normal) = largest_normal(range, vertices) {
                self.turn_to(node, &normal);
                (low, high) = extents(&self.boxes[node], range, vertices);
                let (least, most) = heights(&normal, range, vertices);
                if most - least < SLAB && range.1 - range.0 > 1 {
                    self.push_slab(node as u32, &normal, least - slack, most + slack);
                }
            }
        }
        self.store_extents(node, &low, &high, range, vertices, slack);
    }

    /// Makes `normal` the third axis and the others perpendicular to it.
    fn turn_to(&mut self, node: usize, normal: &Vector3<f64>) {
        let first = self.boxes[node].axis(0);
        let across = first - normal * normal.dot(&first);
        let long = across / sqrt(across.norm_squared());
        if !long.iter().all(|x| x.is_finite()) {
            return;
        }
        let rows = [long, normal.cross(&long), *normal];
        for (k, x) in rows.iter().flat_map(|r| r.iter()).enumerate() {
            self.boxes[node].rows[k / 8][k % 8] = *x as f32;
        }
    }

    /// The slab in stored coordinates of the body.
    fn push_slab(&mut self, node: u32, normal: &Vector3<f64>, low: f64, high: f64) {
        let (unit, lift) = (self.unit(), normal.dot(&self.centre));
        // Heights of points up to |centre| + reach: three roundings of products and sums, once more
        // for the lift.
        let slack = 8.0 * UNIT * (self.centre.abs().sum() + 4.0 * unit);
        self.slabs.push(Slab {
            node,
            normal: *normal,
            low: low * unit + lift - slack,
            high: high * unit + lift + slack,
        });
    }

    /// Centre and half extents: the centre is rounded first, then every point's coordinates about
    /// it are taken along the dual axes, so that the axes as stored, which are not quite
    /// orthonormal, span every point.
    fn store_extents<I: AsRef<[u32]>>(
        &mut self,
        node: usize,
        low: &Vector3<f64>,
        high: &Vector3<f64>,
        range: (usize, usize),
        vertices: &Vertices<I>,
        slack: f64,
    ) {
        let dual = dual_axes(&self.boxes[node]);
        let middle = (low + high) * 0.5;
        let axes = [0, 1, 2].map(|k| self.boxes[node].axis(k));
        let centre = axes[0] * middle.x + axes[1] * middle.y + axes[2] * middle.z;
        let stored = [centre.x as f32, centre.y as f32, centre.z as f32];
        let centre = Vector3::from(stored.map(f64::from));
        let (mut half, mut square): (Vector3<f64>, f64) = (Vector3::zeros(), 0.0);
        vertices.visit(range, |p| {
            let d = p - centre;
            half = half.sup(&Vector3::from_fn(|k, _| dual[k].dot(&d).abs()));
            square = square.max(d.norm_squared());
        });
        let rows = &mut self.boxes[node].rows;
        for k in 0..3 {
            rows[1][1 + k] = stored[k];
            rows[1][4 + k] = up(half[k] + slack);
        }
        rows[1][7] = up(sqrt(square) + slack);
    }
}

/// Coordinates along the axes that hold all vertices.
fn extents<I: AsRef<[u32]>>(
    b: &OrientedBox,
    range: (usize, usize),
    vertices: &Vertices<I>,
) -> (Vector3<f64>, Vector3<f64>) {
    let dual = dual_axes(b);
    let (mut low, mut high) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    vertices.visit(range, |p| {
        let s = Vector3::new(dual[0].dot(p), dual[1].dot(p), dual[2].dot(p));
        (low, high) = (low.inf(&s), high.sup(&s));
    });
    (low, high)
}

fn heights<I: AsRef<[u32]>>(normal: &Vector3<f64>, range: (usize, usize), vertices: &Vertices<I>) -> (f64, f64) {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    vertices.visit(range, |p| {
        let h = normal.dot(p);
        (low, high) = (low.min(h), high.max(h));
    });
    (low, high)
}

/// Vectors of which each is perpendicular to two of the axes and has product one with the third.
fn dual_axes(b: &OrientedBox) -> [Vector3<f64>; 3] {
    let [x, y, z] = [0, 1, 2].map(|k| b.axis(k));
    let volume = x.dot(&y.cross(&z));
    [y.cross(&z) / volume, z.cross(&x) / volume, x.cross(&y) / volume]
}

/// The unit normal of the largest triangle of a range, of a piece's first three corners.
fn largest_normal<I: AsRef<[u32]>>((first, last): (usize, usize), vertices: &Vertices<I>) -> Option<Vector3<f64>> {
    let normal = |item: &I| {
        let [a, b, c] = item.as_ref().first_chunk::<3>()?.map(|v| vertices.places[v as usize]);
        Some((b - a).cross(&(c - a)))
    };
    let all = vertices.items[first..last].iter().filter_map(normal);
    let largest = all.reduce(|m, n| if n.norm_squared() > m.norm_squared() { n } else { m })?;
    let unit = largest / sqrt(largest.norm_squared());
    unit.iter().all(|x| x.is_finite()).then_some(unit)
}

/// The least number of single precision that is not below `x`.
pub(in crate::composite) fn up(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) < x { near.next_up() } else { near }
}

//! The order of triangles or pieces, and the nodes of their tree.
//!
//! A node is cut in this order of preference:
//!
//! 1. Items in one plane, if they are enough, are separated from the others.
//! 2. A cut at the mean, perpendicular to the longest axis of the spread.
//! 3. A cut at the median, if the cut at the mean is lopsided.
//! 4. A cut along another axis, if the first cut hardly shortens the parts. The centroids of long
//!    thin triangles side by side lie in two rows, and a cut between the rows leaves two parts as
//!    large as the whole.
//!
//! The axes of a spread are the eigenvectors of its matrix; the end of the file computes them.

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Matrix3, Vector3};

use super::{COUNT_SHIFT, LEAF_MARK, OrientedBox, Tree};
use crate::base::callbacks::Watch;
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::num::sort::sort;
use crate::base::tolerance::UNIT;
use crate::body::polyhedron::{bounding_box, exponent_of, power_of_two};

/// Largest thickness of a leaf of several items, as a fraction of its length.
///
/// So coarse bodies have thin leaves of one triangle, and fine bodies save two thirds of the boxes.
const THIN: f64 = 1.0 / 16.0;

/// Number of items from which a compact leaf of several items need not be thin.
///
/// A leaf is compact if its middle axis is at least [`COMPACT`] of its longest. Bytes per triangle
/// without and with this rule:
///
/// - a terrain of a million triangles as rough as they are long: 154 and 75;
/// - 355 meshes of robots: 95 and 88, with a largest mean of one mesh of 143 and 112.
///
/// A knot of 20,000 triangles is a fifth faster. A gear of 20,000 triangles is a seventh slower,
/// because of slivers, which are not compact. The rule does not pay for smaller meshes: with it,
/// tori of 1,280 triangles are twice as slow. 40 pairs of triangles are then measured instead of 5,
/// because only their own boxes prove them.
const MANY_ITEMS: usize = 2048;
const COMPACT: f64 = 0.5;

/// A cut at the mean leaves at least one item in this many on each side.
///
/// A plane that is cut off must contain as many. So the depth is logarithmic.
const LOPSIDED: usize = 8;

/// A cut is compared with the other axes if a part is longer than this fraction of the node.
///
/// For shafts of 1,000 sides that cross at 10°, a query needs 190 bounds with this comparison and
/// the direction perpendicular to both lengths, and 8,700 bounds without both.
const HARDLY: f64 = 0.95;

/// A cut along another axis must leave less than this fraction of the first cut's area.
const ACROSS: f64 = 0.8;

/// Radius of a long item around its centroid, in standard deviations of the node.
///
/// If a node has a long item, a cut may hardly shorten the parts.
const LONG: f64 = 0.5;

/// Largest difference of the heights of centroids in one plane, as a fraction of the tree's size.
///
/// It is the rounding of single precision.
const LEVEL: f32 = 8.0 * f32::EPSILON;

/// Number of items up to which the axes come from the vertices, not from the centroids.
///
/// A few centroids have no significant spread.
const FEW_CORNERS: usize = 16;

/// A triangle or a piece during the sort, in the tree's coordinates.
#[derive(Clone, Copy)]
struct Item {
    middle: [f32; 3],
    weight: f32,
    number: u32,
}

/// Items still to be split: their node, the index of the first, and their number.
type Task = (u32, usize, usize);

impl Tree {
    /// Splits items, given by their vertices, down to leaves of at most `most` items.
    ///
    /// Returns the tree, with axes but without extents, and the order of the items. If the callback
    /// stops the call, the result is meaningless.
    pub(crate) fn split<I: AsRef<[u32]>>(
        points: &[Vector3<f64>],
        given: &[I],
        most: usize,
        watch: &mut Watch<'_>,
    ) -> (Self, Vec<u32>) {
        let used = given.iter().flat_map(|i| i.as_ref()).map(|&v| &points[v as usize]);
        let (low, high) = bounding_box(used);
        let (centre, exponent) = Self::place_of(&low, &high);
        Splitter::new(centre, exponent, points, given, most).divided(watch)
    }

    /// Returns the origin and the exponent of the unit of a tree over a bounding box.
    pub(super) fn place_of(low: &Vector3<f64>, high: &Vector3<f64>) -> (Vector3<f64>, i32) {
        // At least the rounding of the position.
        let place = low.amax().larger(high.amax()) * UNIT;
        let size = sqrt(((high - low) * 0.5).norm_squared()).larger(place);
        (low * 0.5 + high * 0.5, exponent_of(size))
    }
}

pub(super) struct Splitter<'a, I> {
    points: &'a [Vector3<f64>],
    given: &'a [I],
    most: usize,
    centre: Vector3<f64>,
    scale: f64,
    items: Vec<Item>,
    tree: Tree,
}

impl<'a, I: AsRef<[u32]>> Splitter<'a, I> {
    /// Takes the origin and the exponent of the tree's unit, the points and the items.
    pub(super) fn new(
        centre: Vector3<f64>,
        exponent: i32,
        points: &'a [Vector3<f64>],
        given: &'a [I],
        most: usize,
    ) -> Self {
        Self {
            points,
            given,
            most,
            centre,
            scale: power_of_two(-exponent),
            items: Vec::new(),
            tree: Tree {
                centre,
                exponent,
                ..Tree::default()
            },
        }
    }

    /// Splits the items; returns the tree, with axes but without extents, and the order of the
    /// items.
    pub(super) fn divided(mut self, watch: &mut Watch<'_>) -> (Tree, Vec<u32>) {
        let count = self.given.len();
        self.items.reserve_exact(count);
        self.tree.boxes.reserve(count);
        self.tree.links.reserve(count);
        self.collect();
        self.run(watch);
        let order = self.items.iter().map(|i| i.number).collect();
        self.tree.boxes.shrink_to_fit();
        self.tree.links.shrink_to_fit();
        (self.tree, order)
    }

    fn corners(&self, item: u32) -> impl Iterator<Item = Vector3<f64>> + Clone + '_ {
        let place = |v: &u32| (self.points[*v as usize] - self.centre) * self.scale;
        self.given[item as usize].as_ref().iter().map(place)
    }

    fn collect(&mut self) {
        for number in 0..self.given.len() as u32 {
            let corners = self.corners(number);
            let count = self.given[number as usize].as_ref().len().max(1) as f64;
            let middle = corners.clone().sum::<Vector3<f64>>() / count;
            // The weight is proportional to the area, up to a factor by shape.
            let spread: f64 = corners.map(|c| (c - middle).norm_squared()).sum();
            self.items.push(Item {
                middle: [middle.x as f32, middle.y as f32, middle.z as f32],
                weight: (spread as f32).at_least(f32::MIN_POSITIVE),
                number,
            });
        }
    }

    fn run(&mut self, watch: &mut Watch<'_>) {
        self.push_node();
        let mut tasks: Vec<Task> = vec![(0, 0, self.items.len())];
        while let Some((node, first, count)) = tasks.pop() {
            let Spread {
                rows,
                mean,
                values,
                heaviest,
            } = self.spread(first, count);
            self.tree.boxes[node as usize].set_axes(&rows);
            if count == 1 || count <= self.most && self.is_leaf(&values) {
                self.tree.links[node as usize] = LEAF_MARK | (count as u32 - 1) << COUNT_SHIFT | first as u32;
                // Tasks are processed in the order of the items.
                if !watch.done(first + count) {
                    break;
                }
                continue;
            }
            let left = match self.cut_plane(first, count, &rows[2]) {
                // A weight is at least the square of the item's radius around its centroid.
                0 if heaviest > LONG * LONG * values[0] => self.cut_across(first, count, &rows, &mean),
                0 => self.cut(first, count, &rows[0], &mean),
                left => left,
            };
            let child = self.push_node();
            self.push_node();
            self.tree.links[node as usize] = child;
            tasks.push((child + 1, first + left, count - left));
            tasks.push((child, first, left));
        }
    }

    /// Returns whether few items should form a leaf: if thin always, if compact only in large
    /// bodies.
    fn is_leaf(&self, [long, wide, deep]: &[f64; 3]) -> bool {
        *deep <= THIN * THIN * long || self.items.len() >= MANY_ITEMS && *wide >= COMPACT * COMPACT * long
    }

    fn push_node(&mut self) -> u32 {
        self.tree.boxes.push(OrientedBox::default());
        self.tree.links.push(0);
        self.tree.boxes.len() as u32 - 1
    }

    fn spread(&self, first: usize, count: usize) -> Spread {
        let (mut sum, mut heaviest) = (SplitMoments::default(), 0.0f32);
        for item in &self.items[first..first + count] {
            let (weight, middle) = (f64::from(item.weight), Vector3::from(item.middle.each(f64::from)));
            heaviest = heaviest.larger(item.weight);
            if count > FEW_CORNERS {
                sum.add(weight, &middle);
            } else {
                for corner in self.corners(item.number) {
                    sum.add(weight, &corner);
                }
            }
        }
        let mean = sum.first / sum.weight;
        let matrix = sum.second / sum.weight - mean * mean.transpose();
        let (rows, values) = axes(&matrix);
        Spread {
            rows,
            mean,
            values,
            heaviest: f64::from(heaviest),
        }
    }

    /// Puts the items in the plane of an extreme item first and returns their number.
    ///
    /// The extreme items are the highest and the lowest along the shortest axis. Returns 0 if the
    /// plane has one item, too few items or all items. Items in one plane have a box without
    /// thickness, which proves a whole flush contact at once.
    fn cut_plane(&mut self, first: usize, count: usize, axis: &Vector3<f64>) -> usize {
        let items = &self.items[first..first + count];
        let along =
            |axis: [f32; 3]| move |i: &Item| axis[0] * i.middle[0] + axis[1] * i.middle[1] + axis[2] * i.middle[2];
        let height = along(single(axis));
        let by_height = |a: &&Item, b: &&Item| height(a).total_cmp(&height(b));
        let ends = [items.iter().max_by(by_height), items.iter().min_by(by_height)].each(|e| e.copied());
        for end in ends.into_iter().flatten() {
            // The normal of the item, not the axis of the spread: the triangulation of a plane
            // tilts this axis a little.
            let height = along(single(&self.normal(end.number)));
            let level = height(&end);
            let is_level = |i: &Item| (height(i) - level).abs() <= LEVEL;
            let items = &mut self.items[first..first + count];
            let left = items.iter().filter(|i| is_level(i)).count();
            if left > 1 && left * LOPSIDED >= count && left < count {
                let mut at = 0;
                for k in 0..count {
                    if is_level(&items[k]) {
                        items.swap(k, at);
                        at += 1;
                    }
                }
                return left;
            }
        }
        0
    }

    /// Returns the unit normal of an item's first three vertices; zero if they are collinear.
    fn normal(&self, item: u32) -> Vector3<f64> {
        let mut corners = self.corners(item);
        let (Some(a), Some(b), Some(c)) = (corners.next(), corners.next(), corners.next()) else {
            return Vector3::zeros();
        };
        let n = (b - a).cross(&(c - a));
        let length = sqrt(n.norm_squared());
        if length > 0.0 { n / length } else { Vector3::zeros() }
    }

    /// Returns the extents of items along three axes.
    fn sides(&self, first: usize, count: usize, rows: &[Vector3<f64>; 3]) -> [f64; 3] {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for corner in self.items[first..first + count]
            .iter()
            .flat_map(|i| self.corners(i.number))
        {
            for k in 0..3 {
                let h = rows[k].dot(&corner);
                (low[k], high[k]) = (low[k].at_most(h), high[k].at_least(h));
            }
        }
        [0, 1, 2].each(|k| high[k] - low[k])
    }

    /// Cuts along the first axis, or along another one if the first hardly shortens a part.
    ///
    /// The cut with the least area is used, weighted by the number of items.
    fn cut_across(&mut self, first: usize, count: usize, rows: &[Vector3<f64>; 3], mean: &Vector3<f64>) -> usize {
        let most = HARDLY * self.sides(first, count, rows)[0];
        let area = |[x, y, z]: [f64; 3]| x * y + y * z + z * x;
        let (mut best, mut least, mut left) = (0, f64::INFINITY, 0);
        for k in 0..3 {
            left = self.cut(first, count, &rows[k], mean);
            let low = self.sides(first, left, rows);
            let high = self.sides(first + left, count - left, rows);
            if k == 0 && low[0].larger(high[0]) <= most {
                return left;
            }
            let cost = area(low) * left as f64 + area(high) * (count - left) as f64;
            if cost < least * if best == 0 && k > 0 { ACROSS } else { 1.0 } {
                (best, least) = (k, cost);
            }
        }
        if best == 2 {
            left
        } else {
            self.cut(first, count, &rows[best], mean)
        }
    }

    /// Puts the items on the lower side of the cut first and returns their number.
    ///
    /// At least one item is on each side.
    fn cut(&mut self, first: usize, count: usize, axis: &Vector3<f64>, mean: &Vector3<f64>) -> usize {
        let axis = [axis.x as f32, axis.y as f32, axis.z as f32];
        let height = |i: &Item| axis[0] * i.middle[0] + axis[1] * i.middle[1] + axis[2] * i.middle[2];
        let level = axis[0] * mean.x as f32 + axis[1] * mean.y as f32 + axis[2] * mean.z as f32;
        let items = &mut self.items[first..first + count];
        let mut left = 0;
        for k in 0..count {
            if height(&items[k]) < level {
                items.swap(k, left);
                left += 1;
            }
        }
        if left * LOPSIDED >= count && (count - left) * LOPSIDED >= count && left > 0 && left < count {
            return left;
        }
        items.select_nth_unstable_by(count / 2, |a, b| {
            height(a).total_cmp(&height(b)).then(a.number.cmp(&b.number))
        });
        count / 2
    }
}

fn single(v: &Vector3<f64>) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

/// Spread of items.
struct Spread {
    /// Axes, the longest first; then the mean and the eigenvalues.
    rows: [Vector3<f64>; 3],
    mean: Vector3<f64>,
    values: [f64; 3],
    /// The greatest weight of an item.
    heaviest: f64,
}

#[derive(Default)]
struct SplitMoments {
    weight: f64,
    first: Vector3<f64>,
    second: Matrix3<f64>,
}

impl SplitMoments {
    fn add(&mut self, weight: f64, p: &Vector3<f64>) {
        let q = p * weight;
        self.weight += weight;
        self.first += q;
        self.second += q * p.transpose();
    }
}

/// Number of sweeps after which a symmetric matrix of order three is diagonal up to rounding.
///
/// Convergence is quadratic. Soundness does not depend on it.
const SWEEPS: usize = 6;

/// Returns the eigenvectors of a symmetric matrix by falling eigenvalue, and the eigenvalues.
///
/// The eigenvectors are orthonormal (Jacobi's rotations, 1846).
pub(super) fn axes(matrix: &Matrix3<f64>) -> ([Vector3<f64>; 3], [f64; 3]) {
    let (mut m, mut v) = (*matrix, Matrix3::identity());
    for _ in 0..SWEEPS {
        let off = m[(0, 1)].abs() + m[(0, 2)].abs() + m[(1, 2)].abs();
        if !(off > f64::EPSILON * m.trace().abs()) {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            rotate(&mut m, &mut v, p, q);
        }
    }
    let mut order = [0, 1, 2];
    sort(&mut order, |&i, &j| m[(j, j)].total_cmp(&m[(i, i)]));
    (order.each(|k| v.column(k).into_owned()), order.each(|k| m[(k, k)]))
}

/// Rotates in the plane of axes p and q so that their entry becomes zero.
fn rotate(m: &mut Matrix3<f64>, v: &mut Matrix3<f64>, p: usize, q: usize) {
    let off = m[(p, q)];
    if off == 0.0 {
        return;
    }
    let theta = (m[(q, q)] - m[(p, p)]) / (2.0 * off);
    let t = 1.0 / (theta.abs() + sqrt(theta * theta + 1.0));
    let t = if theta < 0.0 { -t } else { t };
    if !t.is_finite() {
        return;
    }
    let c = 1.0 / sqrt(t * t + 1.0);
    let s = t * c;
    let r = 3 - p - q;
    let (a, b) = (m[(r, p)], m[(r, q)]);
    m[(p, p)] -= t * off;
    m[(q, q)] += t * off;
    (m[(p, q)], m[(q, p)]) = (0.0, 0.0);
    (m[(r, p)], m[(p, r)]) = (c * a - s * b, c * a - s * b);
    (m[(r, q)], m[(q, r)]) = (s * a + c * b, s * a + c * b);
    for k in 0..3 {
        let (a, b) = (v[(k, p)], v[(k, q)]);
        (v[(k, p)], v[(k, q)]) = (c * a - s * b, s * a + c * b);
    }
}

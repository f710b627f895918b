//! The order of triangles or pieces: cut at the mean, perpendicular to the longest axis of their
//! spread, at the median if that is lopsided; along another axis if that hardly shortens the parts.
//! The middles of long thin triangles side by side lie in two rows: a cut between the rows leaves
//! two parts as large as the whole.
//!
//! The axes of a spread are the eigenvectors of its matrix, at the end of the file.

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Matrix3, Vector3};

use super::{COUNT_SHIFT, LEAF_MARK, OrientedBox, Tree};
use crate::base::callbacks::Watch;
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::UNIT;
use crate::body::polyhedron::{bounding_box, exponent_of, power_of_two};

/// A leaf of several triangles is no thicker than this part of its length: coarse bodies have thin
/// leaves of one triangle, fine bodies save two thirds of the boxes.
const THIN: f64 = 1.0 / 16.0;

/// From so many triangles on, a leaf of several need not be thin if it is compact, its middle axis
/// at least this part of its longest. A terrain of a million triangles as rough as they are long
/// takes 75 bytes a triangle instead of 154, 355 meshes of robots 88 instead of 95, the largest
/// mean of one 112 instead of 143; a knot of 20,000 is a fifth faster. Tori of 1,280 are twice as
/// slow: forty pairs of triangles that only boxes of their own prove are measured instead of five.
/// Slivers, which are not compact, make a gear of 20,000 a seventh slower.
const MANY_ITEMS: usize = 2048;
const COMPACT: f64 = 0.5;

/// A cut of a node leaves at least one part in this many on each side, so that the depth is a
/// logarithm.
const LOPSIDED: usize = 8;

/// A cut that leaves a part longer than this part of the node is compared with cuts along the other
/// axes. Shafts of 1,000 sides that cross at 10 degrees: 8,700 bounds a query without the direction
/// across both lengths and without the comparison, 190 with both.
const HARDLY: f64 = 0.95;

/// A cut along another axis must leave less than this part of the area that the first leaves. Not
/// measured.
const ACROSS: f64 = 0.8;

/// Items that reach farther from their middles than so many standard deviations of the node are
/// long: a cut may hardly shorten the parts. Not measured.
const LONG: f64 = 0.5;

/// Middles whose heights differ by less than this part of the tree's size are level: the rounding
/// of single precision.
const LEVEL: f32 = 8.0 * f32::EPSILON;

/// From so few triangles on a node's axes are found by corners, not by middles: a few middles have
/// no spread of their own.
const FEW_CORNERS: usize = 16;

/// A triangle or a piece while it is sorted, in the tree's coordinates.
#[derive(Clone, Copy)]
struct Item {
    middle: [f32; 3],
    weight: f32,
    number: u32,
}

/// Items still to be divided: the node, the first and the number of its items.
type Task = (u32, usize, usize);

impl Tree {
    /// Divides triangles or pieces, given by their corners, until they are leaves of at most
    /// `most`: the tree with axes and without extents, and the order of the items. Nothing of use
    /// if the caller stops it.
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

    /// Returns the origin and the exponent of the unit of a tree over points between two corners.
    pub(super) fn place_of(low: &Vector3<f64>, high: &Vector3<f64>) -> (Vector3<f64>, i32) {
        // No smaller than the rounding of the place.
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
    /// Takes points and items, and the origin and the exponent of the unit of the tree.
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

    /// Divides the items: the tree, with axes and without extents, and their order.
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
            // Weighs as its area does, up to its shape.
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
                // Tasks are taken in the order of the items.
                if !watch.done(first + count) {
                    break;
                }
                continue;
            }
            let left = match self.cut_plane(first, count, &rows[2]) {
                // A weight is at least the square of the item's reach from its middle.
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

    /// Returns whether items of a spread, few enough, are better left together: thin ones anywhere,
    /// compact ones where memory counts.
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

    /// Puts the items in the plane of the highest or lowest one along the shortest axis first and
    /// returns their number: zero if they are few. Items in one plane have a box without
    /// thickness, which proves all of a flush contact at once.
    fn cut_plane(&mut self, first: usize, count: usize, axis: &Vector3<f64>) -> usize {
        let items = &self.items[first..first + count];
        let along =
            |axis: [f32; 3]| move |i: &Item| axis[0] * i.middle[0] + axis[1] * i.middle[1] + axis[2] * i.middle[2];
        let height = along(single(axis));
        let by_height = |a: &&Item, b: &&Item| height(a).total_cmp(&height(b));
        let ends = [items.iter().max_by(by_height), items.iter().min_by(by_height)].each(|e| e.copied());
        for end in ends.into_iter().flatten() {
            // Of the item, not of the spread, which the way a plane is cut into triangles tilts a
            // little.
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

    /// Returns the unit normal of an item's first three corners; zero if they are collinear.
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

    /// Cuts along the first axis, or, if that hardly shortens a part, along the axis that leaves
    /// the least area, weighed by items.
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

    /// Puts the items on the lower side of the cut first and returns their number: at least one, at
    /// most all but one.
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

/// How items are spread.
struct Spread {
    /// Axes, the longest first, the mean and the eigenvalues.
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

/// Sweeps after which a symmetric matrix of three is diagonal to rounding: convergence is
/// quadratic. Not a matter of soundness.
const SWEEPS: usize = 6;

/// Returns the eigenvectors of a symmetric matrix as orthonormal rows by falling eigenvalue, and
/// the eigenvalues (Jacobi's rotations, 1846).
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
    order.sort_by(|&i, &j| m[(j, j)].total_cmp(&m[(i, i)]));
    (order.each(|k| v.column(k).into_owned()), order.each(|k| m[(k, k)]))
}

/// One rotation in the plane of axes p and q that makes their entry zero.
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

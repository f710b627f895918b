//! Boxes over the same tree for points that have moved.
//!
//! Order and links of the tree stay. A node keeps three of its vertices that are far from each
//! other; its axes turn as the triangle of the three turns, and extents are taken of all vertices
//! below the node, never of the boxes of its children: boxes about boxes grow by a half at each
//! level. Only nodes with a vertex that moved are fitted anew.
//!
//! Source: refitting of bounding volumes: van den Bergen 1997; the frame of three vertices is ours.

use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Matrix3, Vector3};
use wide::{f32x4, f32x8};

use super::{Below, OrientedBox, Tree, up};
use crate::base::num::scalar::sqrt;
use crate::base::pose::rotation_matrix;
use crate::base::tolerance::{BOX_EXTENT, BOX_SKEW, REFIT_HEIGHT, UNIT};

/// Square of the least sine of the angle of two sides of three vertices that have a frame.
const NARROW: f64 = 1.0 / (1u64 << 40) as f64;

/// One length of the tree in units of a path.
const PATH_UNITS: f64 = (1u32 << 24) as f64;

/// The longest path of a vertex in one move, in units of a path: 64 lengths of the tree.
const LONGEST_STEP: u32 = 1 << 30;

/// How far the points below the nodes of a tree have moved since the tree was made: the sum, over
/// all moves, of the longest displacement of a point. Sums wrap around. Empty for a body that has
/// never bent.
#[derive(Clone, Debug, PartialEq, Default)]
pub(crate) struct Paths {
    of_node: Vec<u32>,
    /// That of the root, which does not wrap around.
    pub(crate) total: u64,
}

impl Paths {
    /// Returns the path of a node.
    #[inline]
    pub(crate) fn of(&self, node: u32) -> u32 {
        self.of_node.get(node as usize).copied().unwrap_or(0)
    }

    /// Returns a difference of paths in lengths of the tree, rounded up.
    #[inline]
    pub(crate) fn length(units: u32) -> f32 {
        up(f64::from(units) * (1.0 / PATH_UNITS))
    }

    /// Returns the least number of units that is not less than a length of the tree; `None` beyond
    /// the longest.
    pub(crate) fn units(length: f64) -> Option<u32> {
        let units = length * (PATH_UNITS * (1.0 + 8.0 * UNIT));
        // Written so that NaN is none.
        (units < f64::from(LONGEST_STEP)).then(|| {
            let whole = units as u32;
            whole + u32::from(f64::from(whole) < units)
        })
    }
}

/// A node as it was when the tree was made.
#[derive(Clone, Debug)]
struct NodeAtRest {
    /// The vertices that triangles below the node use first: from one number to the next.
    own: [u32; 2],
    /// Where the list of its other vertices begins.
    others: u32,
    /// Three vertices far from each other.
    three: [u32; 3],
    /// The rotation from the frame of the three to the axes.
    rotation: [f32; 4],
}

/// What fits the boxes of a tree to other places of the same vertices.
#[derive(Clone, Debug)]
pub(crate) struct Refit {
    /// By node, and one more at the end.
    nodes: Arc<[NodeAtRest]>,
    others: Arc<[u32]>,
    /// Places in the tree's coordinates in single precision, by vertex and by coordinate.
    rows: Vec<f32x4>,
    columns: [Vec<f32>; 3],
    /// The longest step of a vertex below each node.
    steps: Vec<u32>,
}

impl Refit {
    /// Takes a tree at rest: the places of its vertices, and its triangles in the tree's order.
    pub(crate) fn new(tree: &Tree, points: &[Vector3<f64>], items: &[[u32; 3]]) -> Self {
        let mut most = 0;
        let mut before = vec![0];
        for item in items {
            most = item.iter().fold(most, |m, &v| m.max(v + 1));
            before.push(most);
        }
        let (mut nodes, mut others) = (Vec::with_capacity(tree.len() + 1), Vec::new());
        for (node, (first, last)) in tree.ranges().into_iter().enumerate() {
            let own = [before[first], before[last]];
            let begin = others.len();
            others.extend(items[first..last].iter().flatten().filter(|v| **v < own[0]));
            let mut list = others.split_off(begin);
            list.sort_unstable();
            list.dedup();
            others.append(&mut list);
            let three = far_apart(points, &items[first..last]);
            let axes = [0, 1].map(|k| tree.boxes[node].axis(k));
            let turned = frame_of(three.map(|v| points[v as usize])).and_then(|frame| rotation_of(&frame, axes));
            nodes.push(NodeAtRest {
                own,
                others: begin as u32,
                three,
                rotation: turned.unwrap_or_default(),
            });
        }
        nodes.push(NodeAtRest {
            own: [0; 2],
            others: others.len() as u32,
            three: [0; 3],
            rotation: [0.0; 4],
        });
        Self {
            nodes: nodes.into(),
            others: others.into(),
            rows: Vec::new(),
            columns: Default::default(),
            steps: Vec::new(),
        }
    }

    fn others(&self, node: usize) -> &[u32] {
        &self.others[self.nodes[node].others as usize..self.nodes[node + 1].others as usize]
    }

    /// Takes the places of the vertices; returns an upper bound of their distances from the tree's
    /// origin.
    fn take(&mut self, points: &[Vector3<f64>], centre: &Vector3<f64>, scale: f64) -> f64 {
        self.rows.clear();
        self.columns.iter_mut().for_each(Vec::clear);
        let mut farthest = 0.0f64;
        for p in points {
            let place = (p - centre) * scale;
            farthest = farthest.max(place.norm_squared());
            let [x, y, z] = [place.x as f32, place.y as f32, place.z as f32];
            self.rows.push(f32x4::new([x, y, z, 0.0]));
            for (column, x) in self.columns.iter_mut().zip([x, y, z]) {
                column.push(x);
            }
        }
        sqrt(farthest) * (1.0 + 8.0 * UNIT)
    }

    /// Sets the longest step of every node, by the steps of the vertices.
    fn spread_steps(&mut self, tree: &Tree, of_vertex: &[u32], items: &[[u32; 3]]) {
        self.steps.clear();
        self.steps.resize(tree.len(), 0);
        for node in (0..tree.len()).rev() {
            self.steps[node] = match tree.below(node as u32) {
                Below::Children(c) => self.steps[c as usize].max(self.steps[c as usize + 1]),
                Below::Leaf(first, count) => {
                    let all = items[first as usize..(first + count) as usize].iter().flatten();
                    all.fold(0, |m: u32, &v| m.max(of_vertex[v as usize]))
                }
            };
        }
    }

    /// Returns the axes of a node; `None` if its three vertices have no frame now.
    fn axes(&self, node: usize) -> Option<[Vector3<f64>; 3]> {
        let at_rest = &self.nodes[node];
        let q = at_rest.rotation.map(f64::from);
        let square = q.iter().map(|x| x * x).sum::<f64>();
        let place = |v: u32| {
            let [x, y, z, _] = self.rows[v as usize].to_array().map(f64::from);
            Vector3::new(x, y, z)
        };
        let frame = frame_of(at_rest.three.map(place)).filter(|_| square > 0.5)?;
        let axes = frame * rotation_matrix(&q, 2.0 / square);
        Some([0, 1, 2].map(|k| axes.column(k).into_owned()))
    }

    /// Returns the least and greatest heights of the vertices of a node along three axes as stored.
    fn heights(&self, node: usize, b: &OrientedBox) -> ([f32; 3], [f32; 3]) {
        let at_rest = &self.nodes[node];
        let own = at_rest.own[0] as usize..at_rest.own[1] as usize;
        let [r0, r1, r2, _] = b.rows;
        let axes = [[r0[0], r0[1], r0[2]], [r0[3], r1[0], r1[1]], [r1[2], r1[3], r2[0]]];
        let (low, high, rest) = self.heights_of_eights(own, &axes);
        let column = |k: usize| f32x4::new([axes[0][k], axes[1][k], axes[2][k], 0.0]);
        let (x, y, z) = (column(0), column(1), column(2));
        let mut low = f32x4::new([low[0], low[1], low[2], 0.0]);
        let mut high = f32x4::new([high[0], high[1], high[2], 0.0]);
        let mut take = |row: &f32x4| {
            let [a, b, c, _] = row.to_array();
            let h = x * f32x4::splat(a) + y * f32x4::splat(b) + z * f32x4::splat(c);
            (low, high) = (low.fast_min(h), high.fast_max(h));
        };
        self.rows[rest].iter().for_each(&mut take);
        self.others(node).iter().for_each(|&v| take(&self.rows[v as usize]));
        let three = |v: f32x4| {
            let [a, b, c, _] = v.to_array();
            [a, b, c]
        };
        (three(low), three(high))
    }

    /// Heights of consecutive vertices, eight at once; and the vertices that are left.
    #[inline(always)]
    fn heights_of_eights(
        &self,
        own: core::ops::Range<usize>,
        axes: &[[f32; 3]; 3],
    ) -> ([f32; 3], [f32; 3], core::ops::Range<usize>) {
        let eights = own.len() / 8;
        let rest = own.start + 8 * eights..own.end;
        if eights == 0 {
            return ([f32::MAX; 3], [-f32::MAX; 3], rest);
        }
        let [xs, ys, zs] = [0, 1, 2].map(|k| self.columns[k][own.start..rest.start].as_chunks::<8>().0);
        let (mut low, mut high) = ([f32x8::splat(f32::MAX); 3], [f32x8::splat(-f32::MAX); 3]);
        for ((x, y), z) in xs.iter().zip(ys).zip(zs) {
            let (x, y, z) = (f32x8::new(*x), f32x8::new(*y), f32x8::new(*z));
            for k in 0..3 {
                let h = x * f32x8::splat(axes[k][0]) + y * f32x8::splat(axes[k][1]) + z * f32x8::splat(axes[k][2]);
                (low[k], high[k]) = (low[k].fast_min(h), high[k].fast_max(h));
            }
        }
        let least = low.map(|v| v.to_array().into_iter().fold(f32::MAX, f32::min));
        let most = high.map(|v| v.to_array().into_iter().fold(-f32::MAX, f32::max));
        (least, most, rest)
    }
}

impl Tree {
    /// Puts the tree's origin and unit where points between two corners, in stored coordinates, are
    /// now: all nodes must be fitted then.
    pub(crate) fn centre_on(&mut self, low: &Vector3<f64>, high: &Vector3<f64>) {
        (self.centre, self.exponent) = Self::place_of(low, high);
    }

    /// Fits the boxes to other places of the vertices, in stored coordinates; `steps` bounds how
    /// far each vertex has moved, in units of a path. Slabs are dropped.
    pub(crate) fn refit(&mut self, refit: &mut Refit, points: &[Vector3<f64>], items: &[[u32; 3]], steps: &[u32]) {
        let scale = crate::body::polyhedron::power_of_two(-self.exponent);
        let farthest = points.iter().fold(self.centre.amax(), |m, p| m.max(p.amax()));
        let far = refit.take(points, &self.centre, scale);
        let slack = BOX_EXTENT * (1.0 + far + farthest * scale) + REFIT_HEIGHT * far;
        refit.spread_steps(self, steps, items);
        (self.slabs, self.nearest) = (Vec::new(), Vec::new());
        self.paths.of_node.resize(self.links.len(), 0);
        self.paths.total += u64::from(refit.steps[0]);
        let mut reach = 0.0f64;
        for node in 0..self.links.len() {
            let b = &mut self.boxes[node];
            if refit.steps[node] > 0 {
                if let Some(axes) = refit.axes(node) {
                    b.set_axes(&axes);
                }
                let (low, high) = refit.heights(node, b);
                b.enclose(low.map(f64::from), high.map(f64::from), slack);
                let path = &mut self.paths.of_node[node];
                *path = path.wrapping_add(refit.steps[node]);
            }
            reach = reach.max(sqrt(b.centre().norm_squared()) + f64::from(b.radius()));
        }
        self.reach = up(reach * (1.0 + 8.0 * UNIT));
    }
}

impl OrientedBox {
    /// Sets centre, half extents and radius, the longest side first, so that the box holds all
    /// points whose heights along the axes as stored are at least `low` and at most `high`, up to
    /// `slack`.
    ///
    /// Heights `h` about the centre are the coordinates `s` of a point, `p = sum of s_k axis_k`, up
    /// to the products of the axes: `h = G s` with the matrix G of products, which is the unit
    /// matrix up to `e = 8 UNIT_SINGLE` in every place. So `|s_k - h_k| <= e sum |s_j|`, and `sum
    /// |s_j| <= sum |h_j| / (1 - 3 e)`.
    fn enclose(&mut self, low: [f64; 3], high: [f64; 3], slack: f64) {
        let mut order = [0, 1, 2];
        let side = |k: usize| high[k] - low[k];
        order.sort_by(|&i, &j| side(j).total_cmp(&side(i)));
        let axes = order.map(|k| self.axis(k));
        self.set_axes(&axes);
        let (low, high) = (order.map(|k| low[k]), order.map(|k| high[k]));
        let centre = (0..3).fold(Vector3::zeros(), |c, k| c + axes[k] * (0.5 * (low[k] + high[k])));
        let stored = [centre.x as f32, centre.y as f32, centre.z as f32];
        let centre = Vector3::from(stored.map(f64::from));
        let reach: [f64; 3] = core::array::from_fn(|k| {
            let at = axes[k].dot(&centre);
            (high[k] - at).max(at - low[k]) + slack
        });
        let skew = BOX_SKEW * (reach[0] + reach[1] + reach[2]);
        let half = reach.map(|h| up(h + skew));
        let square: f64 = half.iter().map(|h| f64::from(*h) * f64::from(*h)).sum();
        self.rows[2][1..].copy_from_slice(&stored);
        self.rows[3][..3].copy_from_slice(&half);
        // `|p|^2 = s . G s <= (1 + 3 e) |s|^2`.
        self.rows[3][3] = up(sqrt(square) * (1.0 + 3.0 * BOX_SKEW));
    }
}

/// Returns a vertex, the farthest from it, and the farthest from the line of both.
fn far_apart(points: &[Vector3<f64>], items: &[[u32; 3]]) -> [u32; 3] {
    let all = || items.iter().flatten().copied();
    let at = |v: u32| points[v as usize];
    let start = all().next().unwrap_or(0);
    let farthest = |of: &dyn Fn(u32) -> f64| {
        let more = |best: (u32, f64), v: u32| if of(v) > best.1 { (v, of(v)) } else { best };
        all().fold((start, 0.0), more).0
    };
    let a = farthest(&|v| (at(v) - at(start)).norm_squared());
    let b = farthest(&|v| (at(v) - at(a)).norm_squared());
    let c = farthest(&|v| (at(v) - at(a)).cross(&(at(b) - at(a))).norm_squared());
    [a, b, c]
}

/// Returns the orthonormal frame of three points as columns: along the first side, and along the
/// normal last. `None` for points on a line.
fn frame_of([a, b, c]: [Vector3<f64>; 3]) -> Option<Matrix3<f64>> {
    let (side, other) = (b - a, c - a);
    let normal = side.cross(&other);
    let (square, area) = (side.norm_squared(), normal.norm_squared());
    // Written so that NaN is none.
    if !(area > NARROW * square * other.norm_squared() && area > f64::MIN_POSITIVE) {
        return None;
    }
    let (x, z) = (side / sqrt(square), normal / sqrt(area));
    Some(Matrix3::from_columns(&[x, z.cross(&x), z]))
}

/// Returns the rotation from a frame to two axes and the third that is right-handed, as a
/// quaternion: the vector part first (Shepperd 1978).
fn rotation_of(frame: &Matrix3<f64>, [x, y]: [Vector3<f64>; 2]) -> Option<[f32; 4]> {
    let m = frame.transpose() * Matrix3::from_columns(&[x, y, x.cross(&y)]);
    let trace = m.trace();
    let squares = [m[(0, 0)], m[(1, 1)], m[(2, 2)], trace];
    let largest = (0..4).max_by(|&i, &j| squares[i].total_cmp(&squares[j]))?;
    let (i, j, k) = (largest % 3, (largest + 1) % 3, (largest + 2) % 3);
    let mut q = [0.0; 4];
    if largest == 3 {
        q[3] = 1.0 + trace;
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            q[i] = m[(k, j)] - m[(j, k)];
        }
    } else {
        q[i] = 1.0 + 2.0 * m[(i, i)] - trace;
        q[j] = m[(i, j)] + m[(j, i)];
        q[k] = m[(i, k)] + m[(k, i)];
        q[3] = m[(k, j)] - m[(j, k)];
    }
    let length = sqrt(q.iter().map(|x| x * x).sum());
    (length > 0.5).then(|| q.map(|x| (x / length) as f32))
}

//! Boxes of the same tree for points that have moved.
//!
//! 1. The order and the links of the tree stay. Only nodes with a vertex that moved are fitted
//!    again, eight boxes at once ([`EightAtRest`]).
//! 2. A node stores three of its vertices that are far from each other. Its axes rotate with the
//!    triangle of the three.
//! 3. The extents of a node come from all vertices below it, never from the boxes of its children:
//!    boxes around boxes grow by half at each level.
//! 4. All nodes below a node of few items, the root of a group, have its axes ([`GroupFit`]). So
//!    the heights of a vertex are computed once for all of them. The extents of a node are the
//!    union of the extents of its children. Along the same axes this loses nothing.
//!
//! Source: refitting of bounding volumes, van den Bergen 1997. Departure: the frame of three
//! vertices.

use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;
use nalgebra::{Matrix3, Vector3};
use wide::{f32x4, f32x8, f64x8};

use super::{Below, OrientedBox, Tree, up};
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::{cross, dot, sqrt, sub};
use crate::base::tolerance::{BOX_EXTENT, BOX_SKEW, REFIT_HEIGHT, UNIT, UNIT_SINGLE};

/// Number of triangles of a node that are searched for three distant vertices.
const FAR_SAMPLES: usize = 128;

/// Path units per unit of length of the tree.
const PATH_UNITS: f64 = (1u32 << 24) as f64;

/// Limit of the path of a vertex in one move, in path units: 64 units of the tree.
const LONGEST_STEP: u32 = 1 << 30;

/// How far the points below the nodes have moved since the tree was built.
///
/// The path of a node is the sum, over all moves, of the longest displacement of a point below it.
/// Sums wrap around. There are no paths if the body has never bent.
#[derive(Clone, Debug, PartialEq, Default)]
pub(crate) struct Paths {
    of_node: Vec<u32>,
    /// The path of the root, which does not wrap around.
    pub(crate) total: u64,
}

impl Paths {
    /// Returns the path of a node.
    #[inline]
    pub(crate) fn of(&self, node: u32) -> u32 {
        self.of_node.get(node as usize).copied().unwrap_or(0)
    }

    /// Converts a difference of paths to a length in units of the tree, rounded up.
    #[inline]
    pub(crate) fn length(units: u32) -> f32 {
        up(f64::from(units) * (1.0 / PATH_UNITS))
    }

    /// Converts a length in units of the tree to path units, rounded up; `None` from 64 units on.
    pub(crate) fn units(length: f64) -> Option<u32> {
        let units = length * (PATH_UNITS * (1.0 + 8.0 * UNIT));
        // Written so that NaN returns `None`.
        (units < f64::from(LONGEST_STEP)).then(|| {
            let whole = units as u32;
            whole + u32::from(f64::from(whole) < units)
        })
    }
}

/// A node that has its own axes, as it was when the tree was built.
struct NodeAtRest {
    number: u32,
    items: Range<usize>,
    own: [u32; 2],
    /// Its vertices that earlier triangles use too.
    others: Vec<u32>,
    /// For the root of a group, the index after the last node below it; zero for larger nodes.
    end: u32,
    three: [u32; 3],
    /// The rotation from the frame of the three vertices to the axes.
    rotation: [f32; 4],
}

/// Computes the boxes of a tree from new positions of the same vertices.
#[derive(Clone, Debug)]
pub(crate) struct Refit {
    /// Large nodes, then roots of groups.
    eights: Arc<[EightAtRest]>,
    /// The number of entries of large nodes.
    large: usize,
    others: Arc<[u32]>,
    corners: GroupCorners,
    positions: VertexPositions,
    /// The longest step of a vertex below each node, in path units.
    steps: Vec<u32>,
}

impl Refit {
    /// Takes a tree at rest: the positions of its vertices, and its triangles in the tree's order.
    pub(crate) fn new(tree: &Tree, points: &[Vector3<f64>], items: &[[u32; 3]]) -> Self {
        let mut most = 0;
        let mut before = vec![0];
        for item in items {
            most = item.iter().fold(most, |m, &v| m.max(v + 1));
            before.push(most);
        }
        let (mut large, mut groups) = (Vec::new(), Vec::new());
        let (ranges, mut stack) = (tree.ranges(), vec![0]);
        while let Some(node) = stack.pop() {
            let range = ranges[node as usize].clone();
            let own = [before[range.start], before[range.end]];
            let at_rest = node_at_rest(tree, points, node, range, own, items);
            if at_rest.end > 0 {
                groups.push(at_rest);
                continue;
            }
            large.push(at_rest);
            if let Below::Children(c) = tree.below(node) {
                stack.extend([c + 1, c]);
            }
        }
        let of_group = |g: &'_ NodeAtRest| (g.items.clone(), g.own, g.others.clone());
        let corners = GroupCorners::new(items, groups.iter().map(of_group));
        let mut others = Vec::new();
        let mut eights: Vec<_> = large
            .chunks(LANES)
            .map(|eight| eight_at_rest(eight, &mut others))
            .collect();
        let large = eights.len();
        eights.extend(groups.chunks(LANES).map(|eight| eight_at_rest(eight, &mut others)));
        Self {
            eights: eights.into(),
            large,
            others: others.into(),
            corners,
            positions: VertexPositions::default(),
            steps: Vec::new(),
        }
    }

    /// Computes the boxes of nodes with a moved vertex; heights have an error of at most `slack`.
    ///
    /// `boxes` are the boxes of the tree, which does not contain them meanwhile. Returns the radius
    /// of the computed boxes around the tree's origin, and whether all boxes were computed.
    fn fit(&self, tree: &Tree, slack: f32, boxes: &mut [OrientedBox]) -> (f32, bool) {
        let (mut reach, mut is_whole) = (0.0f32, true);
        let groups = GroupFit {
            tree,
            positions: &self.positions,
            corners: &self.corners,
            others: &self.others,
            slack,
        };
        let mut memory = GroupMemory::new();
        for (k, eight) in self.eights.iter().enumerate() {
            if eight.nodes.iter().all(|node| self.steps[*node as usize] == 0) {
                is_whole = false;
            } else if k < self.large {
                reach = reach.larger(eight.fit(&self.positions, &self.others, slack, boxes));
            } else {
                reach = reach.larger(groups.fit(eight, boxes, &mut memory));
            }
        }
        (up(f64::from(reach) * (1.0 + 8.0 * UNIT_SINGLE)), is_whole)
    }

    /// Sets the longest step of every node from the steps of the vertices.
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
}

/// Returns a node at rest with its items and vertices.
fn node_at_rest(
    tree: &Tree,
    points: &[Vector3<f64>],
    number: u32,
    items: Range<usize>,
    own: [u32; 2],
    all: &[[u32; 3]],
) -> NodeAtRest {
    let below = &all[items.clone()];
    let mut others: Vec<u32> = below.iter().flatten().copied().filter(|v| *v < own[0]).collect();
    others.sort_unstable();
    others.dedup();
    let three = far_apart(points, below);
    let axes = [0, 1].each(|k| tree.boxes[number as usize].axis(k));
    let turned = frame_of(three.each(|v| points[v as usize])).and_then(|frame| rotation_of(&frame, axes));
    let is_group = below.len() <= GROUP;
    NodeAtRest {
        number,
        items,
        own,
        others,
        end: if is_group { tree.last_below(number) + 1 } else { 0 },
        three,
        rotation: turned.unwrap_or_default(),
    }
}

/// Packs up to eight nodes; the last one fills the remaining lanes.
fn eight_at_rest(nodes: &[NodeAtRest], others: &mut Vec<u32>) -> EightAtRest {
    let node = |lane: usize| &nodes[lane.min(nodes.len() - 1)];
    EightAtRest {
        nodes: core::array::from_fn(|lane| node(lane).number),
        three: [0, 1, 2].each(|k| core::array::from_fn(|lane| node(lane).three[k])),
        rotation: [0, 1, 2, 3].each(|k| core::array::from_fn(|lane| node(lane).rotation[k])),
        below: core::array::from_fn(|lane| {
            let from = others.len() as u32;
            others.extend(&node(lane).others);
            VerticesBelow {
                own: node(lane).own,
                others: [from, others.len() as u32],
                end: node(lane).end,
            }
        }),
    }
}

impl Tree {
    /// Sets the tree's origin and unit to fit a bounding box in stored coordinates.
    ///
    /// All nodes must be fitted after this call.
    pub(crate) fn centre_on(&mut self, low: &Vector3<f64>, high: &Vector3<f64>) {
        (self.centre, self.exponent) = Self::place_of(low, high);
        self.reach = 0.0;
    }

    /// Fits the boxes to new positions of the vertices, in stored coordinates, and drops all slabs.
    ///
    /// `steps` bounds how far each vertex has moved, in path units.
    pub(crate) fn refit(&mut self, refit: &mut Refit, points: &[Vector3<f64>], items: &[[u32; 3]], steps: &[u32]) {
        let scale = crate::body::polyhedron::power_of_two(-self.exponent);
        let far = refit.positions.take(points, &self.centre, scale);
        // Coordinates are at most the coordinates of the origin plus `far`.
        let slack = up(BOX_EXTENT * (1.0 + 2.0 * far + self.centre.amax() * scale) + REFIT_HEIGHT * far);
        refit.spread_steps(self, steps, items);
        (self.slabs, self.nearest) = (Vec::new(), Vec::new());
        self.paths.of_node.resize(self.links.len(), 0);
        self.paths.total += u64::from(refit.steps[0]);
        for (path, step) in self.paths.of_node.iter_mut().zip(&refit.steps) {
            *path = path.wrapping_add(*step);
        }
        let mut boxes = core::mem::take(&mut self.boxes);
        let (reach, is_whole) = refit.fit(self, slack, &mut boxes);
        self.boxes = boxes;
        self.reach = if is_whole { reach } else { reach.larger(self.reach) };
    }
}

/// Returns three distant vertices of some of the items.
///
/// The second is the farthest from the first, the third the farthest from the line of both.
fn far_apart(points: &[Vector3<f64>], items: &[[u32; 3]]) -> [u32; 3] {
    let step = items.len().div_ceil(FAR_SAMPLES).max(1);
    let all = || items.iter().step_by(step).flatten().copied();
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

/// Returns the orthonormal frame of three points as columns; `None` for collinear points.
///
/// The first column is along the first side, the last along the normal.
fn frame_of([a, b, c]: [Vector3<f64>; 3]) -> Option<Matrix3<f64>> {
    let (side, other) = (b - a, c - a);
    let normal = side.cross(&other);
    let (square, area) = (side.norm_squared(), normal.norm_squared());
    // Written so that NaN returns `None`.
    if !(area > NARROW * square * other.norm_squared() && area > f64::MIN_POSITIVE) {
        return None;
    }
    let (x, z) = (side / sqrt(square), normal / sqrt(area));
    Some(Matrix3::from_columns(&[x, z.cross(&x), z]))
}

/// Returns the rotation from a frame to two axes and their cross product, as a quaternion.
///
/// The vector part is first (Shepperd 1978).
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
    (length > 0.5).then(|| q.each(|x| (x / length) as f32))
}

/// Largest number of items of a group; all nodes of a group have the axes of its root.
pub(super) const GROUP: usize = 16;

/// The vertices of every triangle, as indices into the vertices of its group.
///
/// The consecutive vertices of the group come first, then the others.
#[derive(Clone, Debug)]
struct GroupCorners(Arc<[[u8; 3]]>);

impl GroupCorners {
    /// Takes the groups of a tree: their items, their consecutive vertices, and the others.
    fn new(items: &[[u32; 3]], groups: impl Iterator<Item = (Range<usize>, [u32; 2], Vec<u32>)>) -> Self {
        let mut corners = vec![[0; 3]; items.len()];
        for (range, own, others) in groups {
            let number = |v: u32| match others.binary_search(&v) {
                Ok(k) => own[1] - own[0] + k as u32,
                Err(_) => v - own[0],
            };
            for (corners, item) in corners[range.clone()].iter_mut().zip(&items[range]) {
                *corners = item.each(|v| number(v) as u8);
            }
        }
        Self(corners.into())
    }
}

/// Computes the boxes of groups.
struct GroupFit<'a> {
    tree: &'a Tree,
    positions: &'a VertexPositions,
    corners: &'a GroupCorners,
    /// The vertices of nodes that are not consecutive.
    others: &'a [u32],
    slack: f32,
}

/// Extents along three axes.
type Extents = (f32x4, f32x4);

/// Buffers for a group: heights of its vertices, and extents of its nodes.
struct GroupMemory {
    heights: [f32x4; 3 * GROUP],
    extents: [Extents; 2 * GROUP],
}

impl GroupMemory {
    fn new() -> Self {
        Self {
            heights: [f32x4::ZERO; 3 * GROUP],
            extents: [(f32x4::ZERO, f32x4::ZERO); 2 * GROUP],
        }
    }
}

impl GroupFit<'_> {
    /// Computes the boxes of eight groups. Returns their radius around the tree's origin.
    fn fit(&self, eight: &EightAtRest, boxes: &mut [OrientedBox], memory: &mut GroupMemory) -> f32 {
        let (axes, mut reach) = (eight.stored_axes(self.positions, boxes), 0.0f32);
        for (lane, (&node, below)) in eight.nodes.iter().zip(&eight.below).enumerate() {
            if lane == 0 || node != eight.nodes[lane - 1] {
                let axes = BoxAxes::new(axes.each(|axis| axis.each(|x| x[lane])));
                self.fit_group(node, below, &axes, boxes, memory);
                reach = reach.larger(boxes[node as usize].reach());
            }
        }
        reach
    }

    fn fit_group(
        &self,
        root: u32,
        below: &VerticesBelow,
        axes: &BoxAxes,
        boxes: &mut [OrientedBox],
        GroupMemory { heights, extents }: &mut GroupMemory,
    ) {
        let others = &self.others[below.others[0] as usize..below.others[1] as usize];
        let vertices = (below.own[0]..below.own[1]).chain(others.iter().copied());
        for (heights, vertex) in heights.iter_mut().zip(vertices) {
            *heights = self.positions.heights_of(vertex, axes);
        }
        // The root, then the nodes below it. Children have higher indices than their parents.
        let first = match self.tree.below(root) {
            Below::Children(c) => c,
            Below::Leaf(..) => below.end,
        };
        for k in (0..=(below.end - first) as usize).rev() {
            let node = if k == 0 { root } else { first + k as u32 - 1 };
            let (low, high) = match self.tree.below(node) {
                Below::Leaf(item, count) => self.of_leaf(item as usize, count as usize, heights),
                Below::Children(c) => {
                    let c = (c - first) as usize + 1;
                    let ((low, high), (l, h)) = (extents[c], extents[c + 1]);
                    (low.fast_min(l), high.fast_max(h))
                }
            };
            extents[k] = (low, high);
            boxes[node as usize] = axes.fitted(low, high, self.slack);
        }
    }

    #[inline(always)]
    fn of_leaf(&self, item: usize, count: usize, heights: &[f32x4; 3 * GROUP]) -> Extents {
        let corners = self.corners.0[item..item + count].as_flattened();
        let start = (f32x4::splat(f32::MAX), f32x4::splat(-f32::MAX));
        corners.iter().fold(start, |(low, high), &v| {
            let h = heights[v as usize];
            (low.fast_min(h), high.fast_max(h))
        })
    }
}

/// Number of boxes that are fitted at once.
pub(super) const LANES: usize = 8;

/// Least squared sine of the angle between two sides of three vertices that have a frame.
const NARROW: f64 = 1.0 / (1u64 << 40) as f64;

type Lanes = [f32x8; 3];
/// Axes of eight boxes by axis, coordinate and lane.
type StoredAxes = [[[f32; LANES]; 3]; 3];

type Columns = [[f64x8; 3]; 3];

/// The positions of the vertices in the tree's coordinates, in single precision.
///
/// They are stored both by vertex and by coordinate.
#[derive(Clone, Debug, Default)]
struct VertexPositions {
    rows: Vec<f32x4>,
    columns: [Vec<f32>; 3],
}

impl VertexPositions {
    /// Takes new positions; returns an upper bound of their distances from the tree's origin.
    fn take(&mut self, points: &[Vector3<f64>], centre: &Vector3<f64>, scale: f64) -> f64 {
        self.rows.resize(points.len(), f32x4::ZERO);
        self.columns.iter_mut().for_each(|c| c.resize(points.len(), 0.0));
        let [xs, ys, zs] = &mut self.columns;
        let columns = xs.iter_mut().zip(ys).zip(zs);
        let mut farthest = 0.0f64;
        for ((p, row), ((x, y), z)) in points.iter().zip(&mut self.rows).zip(columns) {
            let place = (p - centre) * scale;
            farthest = farthest.at_least(place.norm_squared());
            (*x, *y, *z) = (place.x as f32, place.y as f32, place.z as f32);
            *row = f32x4::new([*x, *y, *z, 0.0]);
        }
        sqrt(farthest) * (1.0 + UNIT_SINGLE)
    }

    /// Returns the heights of a vertex along three axes.
    #[inline(always)]
    fn heights_of(&self, vertex: u32, axes: &BoxAxes) -> f32x4 {
        axes.heights(self.rows[vertex as usize])
    }

    /// Returns the positions of eight vertices.
    #[inline(always)]
    fn gather(&self, vertices: &[u32; LANES]) -> Lanes {
        let row = |k: usize| self.rows[vertices[k] as usize];
        let low = f32x4::transpose([row(0), row(1), row(2), row(3)]);
        let high = f32x4::transpose([row(4), row(5), row(6), row(7)]);
        core::array::from_fn(|k| {
            let ([a, b, c, d], [e, f, g, h]) = (low[k].to_array(), high[k].to_array());
            f32x8::new([a, b, c, d, e, f, g, h])
        })
    }

    /// Returns the least and greatest heights of consecutive vertices and of others.
    fn heights(&self, own: Range<usize>, others: &[u32], axes: &BoxAxes) -> (f32x4, f32x4) {
        let [xs, ys, zs] = [0, 1, 2].each(|k| self.columns[k][own.clone()].as_chunks::<LANES>());
        let rest = own.end - xs.1.len()..own.end;
        let start = (f32x4::splat(f32::MAX), f32x4::splat(-f32::MAX));
        let singly = rest.map(|v| v as u32).chain(others.iter().copied());
        let (low, high) = singly.fold(start, |(low, high), v| {
            let h = self.heights_of(v, axes);
            (low.fast_min(h), high.fast_max(h))
        });
        if xs.0.is_empty() {
            return (low, high);
        }
        let (mut lows, mut highs) = ([f32x8::splat(f32::MAX); 3], [f32x8::splat(-f32::MAX); 3]);
        for ((x, y), z) in xs.0.iter().zip(ys.0).zip(zs.0) {
            let [x, y, z] = [x, y, z].each(|c| f32x8::new(*c));
            for (k, axis) in axes.rows.iter().enumerate() {
                let h = x * f32x8::splat(axis[0]) + y * f32x8::splat(axis[1]) + z * f32x8::splat(axis[2]);
                (lows[k], highs[k]) = (lows[k].fast_min(h), highs[k].fast_max(h));
            }
        }
        (
            low.fast_min(across(lows, f32x4::fast_min)),
            high.fast_max(across(highs, f32x4::fast_max)),
        )
    }
}

/// Returns the least or greatest lane of each of three registers.
#[inline(always)]
fn across(of: Lanes, better: impl Fn(f32x4, f32x4) -> f32x4) -> f32x4 {
    let halves = of.each(|v| {
        let [a, b, c, d, e, f, g, h] = v.to_array();
        better(f32x4::new([a, b, c, d]), f32x4::new([e, f, g, h]))
    });
    let [p, q, r, s] = f32x4::transpose([halves[0], halves[1], halves[2], f32x4::ZERO]);
    better(better(p, q), better(r, s))
}

/// Indices of the vertices below a node.
#[derive(Clone, Copy, Debug)]
struct VerticesBelow {
    /// The range of the consecutive vertices.
    own: [u32; 2],
    /// The range of the others in the list of others.
    others: [u32; 2],
    /// For the root of a group, the index after the last node below it.
    end: u32,
}

/// Eight nodes as they were when their tree was built.
#[derive(Clone, Debug)]
struct EightAtRest {
    nodes: [u32; LANES],
    /// Three vertices of each node, far from each other.
    three: [[u32; LANES]; 3],
    /// The rotations from the frames of the three to the axes, as quaternions; zero if there is
    /// none.
    rotation: [[f32; LANES]; 4],
    below: [VerticesBelow; LANES],
}

impl EightAtRest {
    /// Computes the boxes of the nodes; heights have an error of at most `slack`.
    ///
    /// `others` lists the vertices that are not consecutive. Returns the radius of the boxes around
    /// the tree's origin.
    fn fit(&self, positions: &VertexPositions, others: &[u32], slack: f32, boxes: &mut [OrientedBox]) -> f32 {
        let (axes, mut reach) = (self.stored_axes(positions, boxes), 0.0f32);
        for (lane, below) in self.below.iter().enumerate() {
            let axes = BoxAxes::new(axes.each(|axis| axis.each(|x| x[lane])));
            let own = below.own[0] as usize..below.own[1] as usize;
            let others = &others[below.others[0] as usize..below.others[1] as usize];
            let (low, high) = positions.heights(own, others, &axes);
            let fitted = axes.fitted(low, high, slack);
            reach = reach.larger(fitted.reach());
            boxes[self.nodes[lane] as usize] = fitted;
        }
        reach
    }

    /// Returns the axes in single precision, by axis, coordinate and lane.
    ///
    /// They are rotated with the three vertices. If these have no frame now, the previous axes
    /// stay.
    #[inline(always)]
    fn stored_axes(&self, positions: &VertexPositions, boxes: &[OrientedBox]) -> StoredAxes {
        let (axes, exists) = self.axes(positions);
        let mut stored = axes.each(|axis| axis.each(|x| x.to_array().each(|x| x as f32)));
        for lane in (0..LANES).filter(|lane| !exists[*lane]) {
            let old = &boxes[self.nodes[lane] as usize].rows;
            for k in 0..9 {
                stored[k / 3][k % 3][lane] = old[k / 4][k % 4];
            }
        }
        stored
    }

    /// Returns the axes in double precision, and which of them exist.
    #[inline(always)]
    fn axes(&self, positions: &VertexPositions) -> (Columns, [bool; LANES]) {
        let at = |k: usize| positions.gather(&self.three[k]).each(double);
        let (a, b, c) = (at(0), at(1), at(2));
        let (side, other) = (sub(&b, &a), sub(&c, &a));
        let normal = cross(&side, &other);
        let [x, y, z, w] = self.rotation.each(|q| double(f32x8::new(q)));
        let norm = x * x + y * y + z * z + w * w;
        let (square, area) = (dot(&side, &side), dot(&normal, &normal));
        let narrow = (f64x8::splat(NARROW) * square * dot(&other, &other)).to_array();
        let (areas, norms) = (area.to_array(), norm.to_array());
        // Written so that NaN gives no frame.
        let exists = core::array::from_fn(|k| areas[k] > narrow[k] && areas[k] > f64::MIN_POSITIVE && norms[k] > 0.5);
        let one = f64x8::splat(1.0);
        let (per_side, per_area) = (one / square.sqrt(), one / area.sqrt());
        let (e, n) = (side.each(|x| x * per_side), normal.each(|x| x * per_area));
        let f = cross(&n, &e);
        // The columns of the rotation, in the frame of the three vertices.
        let s = f64x8::splat(2.0) / norm;
        let (xs, ys, zs) = (x * s, y * s, z * s);
        let rotated = [
            [one - (y * ys + z * zs), x * ys + w * zs, x * zs - w * ys],
            [x * ys - w * zs, one - (x * xs + z * zs), y * zs + w * xs],
            [x * zs + w * ys, y * zs - w * xs, one - (x * xs + y * ys)],
        ];
        let axes = rotated.each(|[p, q, r]| core::array::from_fn(|k| e[k] * p + f[k] * q + n[k] * r));
        (axes, exists)
    }
}

#[inline(always)]
fn double(x: f32x8) -> f64x8 {
    f64x8::new(x.to_array().each(f64::from))
}

/// Three axes in single precision, stored by axis and by coordinate.
pub(super) struct BoxAxes {
    pub(super) rows: [[f32; 3]; 3],
    columns: [f32x4; 3],
}

impl BoxAxes {
    #[inline(always)]
    pub(super) fn new(rows: [[f32; 3]; 3]) -> Self {
        let columns = [0, 1, 2].each(|k| f32x4::new([rows[0][k], rows[1][k], rows[2][k], 0.0]));
        Self { rows, columns }
    }

    /// Returns the heights of a point along the axes.
    #[inline(always)]
    pub(super) fn heights(&self, point: f32x4) -> f32x4 {
        let [x, y, z, _] = point.to_array().each(f32x4::splat);
        self.columns[0] * x + self.columns[1] * y + self.columns[2] * z
    }

    /// Returns a box of all points whose heights along the stored axes are from `low` to `high`.
    ///
    /// The heights have an error of at most `slack`. The longest side is first.
    ///
    /// Let h be the heights of a point p about the centre and s its coordinates,
    /// `p = sum of s_k axis_k`. Then `h = G s` with the matrix G of products of the axes. Each
    /// entry of G differs from the unit matrix by at most `e = 8 UNIT_SINGLE`. So
    /// `|s_k - h_k| <= e sum |s_j|` with `sum |s_j| <= sum |h_j| / (1 - 3 e)`, and
    /// `|p|^2 = s . G s <= (1 + 3 e) |s|^2`. The last factors cover the rounding of the sums of
    /// positive numbers.
    #[inline(always)]
    pub(super) fn fitted(&self, low: f32x4, high: f32x4, slack: f32) -> OrientedBox {
        let up = 1.0 + 8.0 * f32::EPSILON;
        let [p, q, r, _] = ((low + high) * f32x4::splat(0.5)).to_array();
        let rows = &self.rows;
        let centre = [0, 1, 2].each(|k| rows[0][k] * p + rows[1][k] * q + rows[2][k] * r);
        let at = self.heights(f32x4::new([centre[0], centre[1], centre[2], 0.0]));
        let reach = (high - at).fast_max(at - low) + f32x4::splat(slack);
        let [x, y, z, _] = reach.to_array();
        let skew = f32x4::splat((x + y + z) * BOX_SKEW as f32);
        let half = ((reach + skew) * f32x4::splat(up)).to_array();
        let [x, y, z, _] = half;
        let square = f64::from(x * x + y * y + z * z);
        let radius = sqrt(square) as f32 * ((1.0 + 3.0 * BOX_SKEW as f32) * up);
        let [i, j, k] = descending((high - low).to_array());
        let ([a, b, c], [p, q, r]) = ([rows[i], rows[j], rows[k]], centre);
        OrientedBox {
            rows: [
                [a[0], a[1], a[2], b[0]],
                [b[1], b[2], c[0], c[1]],
                [c[2], p, q, r],
                [half[i], half[j], half[k], radius],
            ],
        }
    }
}

/// Returns the indices of the first three numbers, the greatest first.
#[inline(always)]
fn descending([a, b, c, _]: [f32; 4]) -> [usize; 3] {
    // Ranks from three comparisons: the number of the others that come first.
    let (ba, ca, cb) = (usize::from(b > a), usize::from(c > a), usize::from(c > b));
    let mut order = [0; 3];
    order[ba + ca] = 0;
    order[1 - ba + cb] = 1;
    order[2 - ca - cb] = 2;
    order
}

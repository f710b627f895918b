//! Boxes over the same tree for points that have moved.
//!
//! Order and links of the tree stay. A node keeps three of its vertices that are far from each
//! other; its axes turn as the triangle of the three turns, and extents are taken of all vertices
//! below the node, never of the boxes of its children: boxes about boxes grow by a half at each
//! level. Only nodes with a vertex that moved are fitted anew, eight boxes at once
//! ([`EightAtRest`]).
//!
//! All nodes below one of few items, the root of a group, have its axes ([`GroupFit`]). So the
//! heights of a vertex are taken once for all of them, and the extents of a node are those of its
//! children, which do not grow as boxes about boxes of other axes do.
//!
//! Source: refitting of bounding volumes: van den Bergen 1997; the frame of three vertices is ours.

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

/// Triangles of a node among which three vertices far from each other are looked for. Not measured.
const FAR_SAMPLES: usize = 128;

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

/// A node that has axes of its own, as it was when the tree was made.
struct NodeAtRest {
    number: u32,
    items: Range<usize>,
    own: [u32; 2],
    /// Its vertices that triangles before it use.
    others: Vec<u32>,
    /// The number after the last node below it, of the root of a group; zero for larger nodes.
    end: u32,
    three: [u32; 3],
    /// The rotation from the frame of the three to the axes.
    rotation: [f32; 4],
}

/// What fits the boxes of a tree to other places of the same vertices.
#[derive(Clone, Debug)]
pub(crate) struct Refit {
    /// Large nodes, then the roots of groups.
    eights: Arc<[EightAtRest]>,
    /// How many of these are of large nodes.
    large: usize,
    others: Arc<[u32]>,
    corners: GroupCorners,
    places: Places,
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
            places: Places::default(),
            steps: Vec::new(),
        }
    }

    /// Fits the boxes of a tree, which are lent, to the places; heights err by `slack`. Returns how
    /// far those reach that were fitted from the tree's origin, and whether all were.
    fn fit(&self, tree: &Tree, slack: f32, boxes: &mut [OrientedBox]) -> (f32, bool) {
        let (mut reach, mut is_whole) = (0.0f32, true);
        let groups = GroupFit {
            tree,
            places: &self.places,
            corners: &self.corners,
            others: &self.others,
            slack,
        };
        let mut room = GroupRoom::new();
        for (k, eight) in self.eights.iter().enumerate() {
            if eight.nodes.iter().all(|node| self.steps[*node as usize] == 0) {
                is_whole = false;
            } else if k < self.large {
                reach = reach.larger(eight.fit(&self.places, &self.others, slack, boxes));
            } else {
                reach = reach.larger(groups.fit(eight, boxes, &mut room));
            }
        }
        (up(f64::from(reach) * (1.0 + 8.0 * UNIT_SINGLE)), is_whole)
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
}

/// Returns a node with its items and consecutive vertices as it is.
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

/// Returns up to eight nodes side by side; the last one stands in the lanes that are left.
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
    /// Puts the tree's origin and unit where points between two corners, in stored coordinates, are
    /// now: all nodes must be fitted then.
    pub(crate) fn centre_on(&mut self, low: &Vector3<f64>, high: &Vector3<f64>) {
        (self.centre, self.exponent) = Self::place_of(low, high);
        self.reach = 0.0;
    }

    /// Fits the boxes to other places of the vertices, in stored coordinates; `steps` bounds how
    /// far each vertex has moved, in units of a path. Slabs are dropped.
    pub(crate) fn refit(&mut self, refit: &mut Refit, points: &[Vector3<f64>], items: &[[u32; 3]], steps: &[u32]) {
        let scale = crate::body::polyhedron::power_of_two(-self.exponent);
        let far = refit.places.take(points, &self.centre, scale);
        // Coordinates are at most those of the origin and `far`.
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

/// Returns a vertex, the farthest from it, and the farthest from the line of both, among those of
/// some of the items.
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
    (length > 0.5).then(|| q.each(|x| (x / length) as f32))
}

/// Nodes of up to so many items have the axes of the largest node above them that has no more.
pub(super) const GROUP: usize = 16;

/// The corners of every triangle by their number among the vertices of its group: the consecutive
/// ones, then the others.
#[derive(Clone, Debug)]
struct GroupCorners(Arc<[[u8; 3]]>);

impl GroupCorners {
    /// Takes the groups of a tree: their items, their consecutive vertices, the others.
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

/// Fits the boxes of groups.
struct GroupFit<'a> {
    tree: &'a Tree,
    places: &'a Places,
    corners: &'a GroupCorners,
    /// The vertices of nodes that are not consecutive.
    others: &'a [u32],
    slack: f32,
}

/// Extents along three axes.
type Extents = (f32x4, f32x4);

/// Room for the work on a group: heights of its vertices, and extents of its nodes.
struct GroupRoom {
    heights: [f32x4; 3 * GROUP],
    extents: [Extents; 2 * GROUP],
}

impl GroupRoom {
    fn new() -> Self {
        Self {
            heights: [f32x4::ZERO; 3 * GROUP],
            extents: [(f32x4::ZERO, f32x4::ZERO); 2 * GROUP],
        }
    }
}

impl GroupFit<'_> {
    /// Fits the boxes of eight groups. Returns how far they reach from the tree's origin.
    fn fit(&self, eight: &EightAtRest, boxes: &mut [OrientedBox], room: &mut GroupRoom) -> f32 {
        let (axes, mut reach) = (eight.stored_axes(self.places, boxes), 0.0f32);
        for (lane, (&node, below)) in eight.nodes.iter().zip(&eight.below).enumerate() {
            if lane == 0 || node != eight.nodes[lane - 1] {
                let axes = BoxAxes::new(axes.each(|axis| axis.each(|x| x[lane])));
                self.fit_group(node, below, &axes, boxes, room);
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
        GroupRoom { heights, extents }: &mut GroupRoom,
    ) {
        let others = &self.others[below.others[0] as usize..below.others[1] as usize];
        let vertices = (below.own[0]..below.own[1]).chain(others.iter().copied());
        for (heights, vertex) in heights.iter_mut().zip(vertices) {
            *heights = self.places.heights_of(vertex, axes);
        }
        // The root, then the nodes below it, whose children have higher numbers.
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

/// Boxes fitted at once.
pub(super) const LANES: usize = 8;

/// Square of the least sine of the angle of two sides of three vertices that have a frame.
const NARROW: f64 = 1.0 / (1u64 << 40) as f64;

type Lanes = [f32x8; 3];
/// Axes of eight boxes by axis, coordinate and lane.
type StoredAxes = [[[f32; LANES]; 3]; 3];

type Columns = [[f64x8; 3]; 3];

/// The places of the vertices in the tree's coordinates, in single precision: by vertex and by
/// coordinate.
#[derive(Clone, Debug, Default)]
struct Places {
    rows: Vec<f32x4>,
    columns: [Vec<f32>; 3],
}

impl Places {
    /// Takes the places; returns an upper bound of their distances from the tree's origin.
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

    /// Returns the places of eight vertices.
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

/// Returns the least or the greatest of the lanes of each of three.
#[inline(always)]
fn across(of: Lanes, better: impl Fn(f32x4, f32x4) -> f32x4) -> f32x4 {
    let halves = of.each(|v| {
        let [a, b, c, d, e, f, g, h] = v.to_array();
        better(f32x4::new([a, b, c, d]), f32x4::new([e, f, g, h]))
    });
    let [p, q, r, s] = f32x4::transpose([halves[0], halves[1], halves[2], f32x4::ZERO]);
    better(better(p, q), better(r, s))
}

/// Where the vertices of a node stand.
#[derive(Clone, Copy, Debug)]
struct VerticesBelow {
    /// Consecutive ones, from one number to the next.
    own: [u32; 2],
    /// The others, as part of a list.
    others: [u32; 2],
    /// Of a group, the number after the last node below it.
    end: u32,
}

/// Eight nodes as they were when their tree was made.
#[derive(Clone, Debug)]
struct EightAtRest {
    nodes: [u32; LANES],
    /// Three vertices of each, far from each other.
    three: [[u32; LANES]; 3],
    /// The rotation from the frame of the three to the axes, as quaternions; zero if there is none.
    rotation: [[f32; LANES]; 4],
    below: [VerticesBelow; LANES],
}

impl EightAtRest {
    /// Fits the boxes of the nodes to the places of their vertices, of which `others` lists those
    /// that are not consecutive; heights err by `slack`. Returns how far the boxes reach from the
    /// tree's origin.
    fn fit(&self, places: &Places, others: &[u32], slack: f32, boxes: &mut [OrientedBox]) -> f32 {
        let (axes, mut reach) = (self.stored_axes(places, boxes), 0.0f32);
        for (lane, below) in self.below.iter().enumerate() {
            let axes = BoxAxes::new(axes.each(|axis| axis.each(|x| x[lane])));
            let own = below.own[0] as usize..below.own[1] as usize;
            let others = &others[below.others[0] as usize..below.others[1] as usize];
            let (low, high) = places.heights(own, others, &axes);
            let fitted = axes.fitted(low, high, slack);
            reach = reach.larger(fitted.reach());
            boxes[self.nodes[lane] as usize] = fitted;
        }
        reach
    }

    /// Returns the axes as they are stored, by axis, coordinate and lane: turned with the three
    /// vertices, or as they were if these have no frame now.
    #[inline(always)]
    fn stored_axes(&self, places: &Places, boxes: &[OrientedBox]) -> StoredAxes {
        let (axes, exists) = self.axes(places);
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
    fn axes(&self, places: &Places) -> (Columns, [bool; LANES]) {
        let at = |k: usize| places.gather(&self.three[k]).each(double);
        let (a, b, c) = (at(0), at(1), at(2));
        let (side, other) = (sub(&b, &a), sub(&c, &a));
        let normal = cross(&side, &other);
        let [x, y, z, w] = self.rotation.each(|q| double(f32x8::new(q)));
        let norm = x * x + y * y + z * z + w * w;
        let (square, area) = (dot(&side, &side), dot(&normal, &normal));
        let narrow = (f64x8::splat(NARROW) * square * dot(&other, &other)).to_array();
        let (areas, norms) = (area.to_array(), norm.to_array());
        // Written so that NaN is none.
        let exists = core::array::from_fn(|k| areas[k] > narrow[k] && areas[k] > f64::MIN_POSITIVE && norms[k] > 0.5);
        let one = f64x8::splat(1.0);
        let (per_side, per_area) = (one / square.sqrt(), one / area.sqrt());
        let (e, n) = (side.each(|x| x * per_side), normal.each(|x| x * per_area));
        let f = cross(&n, &e);
        // The columns of the rotation in the frame of the three.
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

/// Three axes in single precision: by axis, and the same by coordinate.
struct BoxAxes {
    rows: [[f32; 3]; 3],
    columns: [f32x4; 3],
}

impl BoxAxes {
    #[inline(always)]
    fn new(rows: [[f32; 3]; 3]) -> Self {
        let columns = [0, 1, 2].each(|k| f32x4::new([rows[0][k], rows[1][k], rows[2][k], 0.0]));
        Self { rows, columns }
    }

    /// Returns the heights of a point along the axes.
    #[inline(always)]
    fn heights(&self, point: f32x4) -> f32x4 {
        let [x, y, z, _] = point.to_array().each(f32x4::splat);
        self.columns[0] * x + self.columns[1] * y + self.columns[2] * z
    }

    /// Returns a box that holds all points whose heights along the axes as stored are at least
    /// `low` and at most `high`, up to `slack`, the longest side first.
    ///
    /// Heights `h` about the centre are the coordinates `s` of a point, `p = sum of s_k axis_k`, up
    /// to the products of the axes: `h = G s` with the matrix G of products, which is the unit
    /// matrix up to `e = 8 UNIT_SINGLE` in every place. So `|s_k - h_k| <= e sum |s_j|`, and `sum
    /// |s_j| <= sum |h_j| / (1 - 3 e)`; `|p|^2 = s . G s <= (1 + 3 e) |s|^2`. The last factors hold
    /// the roundings of the sums of positive numbers.
    #[inline(always)]
    fn fitted(&self, low: f32x4, high: f32x4, slack: f32) -> OrientedBox {
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

/// Returns the order of the first three numbers, the greatest first.
#[inline(always)]
fn descending([a, b, c, _]: [f32; 4]) -> [usize; 3] {
    // Ranks by three comparisons: how many of the others come first.
    let (ba, ca, cb) = (usize::from(b > a), usize::from(c > a), usize::from(c > b));
    let mut order = [0; 3];
    order[ba + ca] = 0;
    order[1 - ba + cb] = 1;
    order[2 - ca - cb] = 2;
    order
}

//! Boxes over the same tree for points that have moved.
//!
//! Order and links of the tree stay. A node keeps three of its vertices that are far from each
//! other; its axes turn as the triangle of the three turns, and extents are taken of all vertices
//! below the node, never of the boxes of its children: boxes about boxes grow by a half at each
//! level. Small nodes have the axes of the root of their group. Only nodes with a vertex that moved
//! are fitted anew.
//!
//! Source: refitting of bounding volumes: van den Bergen 1997; the frame of three vertices is ours.

use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Matrix3, Vector3};

use super::eight::{EightAtRest, LANES, NARROW, Places, VerticesBelow};
use super::group::{GroupCorners, GroupFit, GroupRoom};
use super::{Below, OrientedBox, Tree, up};
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{BOX_EXTENT, REFIT_HEIGHT, UNIT, UNIT_SINGLE};
use crate::composite::tree::group::GROUP;

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
    items: (usize, usize),
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
            let (first, last) = ranges[node as usize];
            let at_rest = node_at_rest(
                tree,
                points,
                (node, (first, last), [before[first], before[last]]),
                items,
            );
            if at_rest.end > 0 {
                groups.push(at_rest);
                continue;
            }
            large.push(at_rest);
            if let Below::Children(c) = tree.below(node) {
                stack.extend([c + 1, c]);
            }
        }
        let of_group = |g: &'_ NodeAtRest| (g.items, g.own, g.others.clone());
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
    (number, items, own): (u32, (usize, usize), [u32; 2]),
    all: &[[u32; 3]],
) -> NodeAtRest {
    let below = &all[items.0..items.1];
    let mut others: Vec<u32> = below.iter().flatten().copied().filter(|v| *v < own[0]).collect();
    others.sort_unstable();
    others.dedup();
    let three = far_apart(points, below);
    let axes = [0, 1].map(|k| tree.boxes[number as usize].axis(k));
    let turned = frame_of(three.map(|v| points[v as usize])).and_then(|frame| rotation_of(&frame, axes));
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
        three: [0, 1, 2].map(|k| core::array::from_fn(|lane| node(lane).three[k])),
        rotation: [0, 1, 2, 3].map(|k| core::array::from_fn(|lane| node(lane).rotation[k])),
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
    (length > 0.5).then(|| q.map(|x| (x / length) as f32))
}

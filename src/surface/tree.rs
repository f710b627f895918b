//! Trees of control nets: groups of patches in the upper part, halves of patches in the lower part.
//!
//! A node is a set of points whose convex hull contains a part of the surface. For a group of
//! patches the points are the corners of a box; for a part of a patch they are its control net. The
//! upper part of the tree belongs to the surface. A search makes the nodes below whole patches when
//! it splits them, and the tracker keeps them.
//!
//! The part of a patch over any box of parameters is a node too ([`Cut`]). De Casteljau's algorithm
//! cuts it out at both ends.

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::Vector3;

use super::bezier::{NET, halves};
use super::net::BezierPatch;
use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::base::num::sort::sort;
use crate::base::tolerance::{NET as NET_ERROR, NET_CUT, NET_STEP, ROUND_UP};

/// Largest number of splits of a node in each direction. Parameters stay multiples of `2^-48`.
const DEEPEST: u8 = 48;

/// Patch index of a group of patches.
const GROUP: u32 = u32::MAX;

/// A part of a surface.
#[derive(Clone, Debug)]
pub(super) struct Node {
    /// Index of the first of two successive children; 0 if the node is not split.
    child: u32,
    /// Index of the patch, or [`GROUP`].
    patch: u32,
    /// Index of the first number of the net.
    at: u32,
    /// Number of points of the net.
    pub(super) count: u32,
    /// Number of splits so far in u and v.
    splits: [u8; 2],
    /// The direction to be split next: 0 for u, 1 for v.
    along: u8,
    pub(super) is_rational: bool,
    /// The lower corner in the parameters of the patch, in units of `2^-DEEPEST`.
    low: [u64; 2],
    pub(super) degrees: [usize; 2],
    /// Centre of a ball around the net.
    pub(super) centre: Vector3<f64>,
    pub(super) radius: f64,
    /// Error of the points of the net, and thus of the hull.
    pub(super) error: f64,
    /// Radius about the origin, which scales the errors of the coefficients of a height.
    pub(super) reach: f64,
}

impl Node {
    pub(super) fn is_group(&self) -> bool {
        self.patch == GROUP
    }

    /// Returns the index of the patch; meaningless for a group.
    pub(super) fn patch(&self) -> u32 {
        self.patch
    }

    /// Returns the only node of a body that is never split, with a ball around the body.
    pub(super) fn whole(centre: Vector3<f64>, radius: f64, error: f64) -> Self {
        Self {
            patch: 0,
            splits: [DEEPEST; 2],
            centre,
            radius,
            error,
            ..empty()
        }
    }

    /// Returns a part of a patch that belongs to no tree, without a ball.
    pub(super) fn part(patch: &BezierPatch, error: f64) -> Self {
        Self {
            patch: 0,
            count: patch.net.len() as u32,
            is_rational: patch.is_rational,
            degrees: patch.degrees,
            error,
            reach: patch.reach,
            ..empty()
        }
    }

    /// Returns the box of parameters.
    #[inline]
    pub(super) fn domain(&self) -> [[f64; 2]; 2] {
        [0, 1].each(|k| {
            let unit = 1.0 / (1u64 << DEEPEST) as f64;
            let size = 1.0 / (1u64 << self.splits[k]) as f64;
            let low = self.low[k] as f64 * unit;
            [low, low + size]
        })
    }

    /// Returns the middle of the box of parameters.
    pub(super) fn middle(&self) -> [f64; 2] {
        self.domain().each(|[low, high]| 0.5 * (low + high))
    }

    /// Returns whether parameters lie in the box.
    pub(super) fn holds(&self, at: [f64; 2]) -> bool {
        let domain = self.domain();
        (0..2).all(|k| domain[k][0] <= at[k] && at[k] <= domain[k][1])
    }

    pub(super) fn can_split(&self) -> bool {
        self.is_group() || self.splits[self.along as usize] < DEEPEST
    }
}

/// Nodes and the numbers of their nets. A net stores all x, then all y, then all z of its points.
/// The homogeneous coordinates of a rational net follow.
#[derive(Clone, Debug, Default)]
pub(super) struct NetTree {
    nodes: Vec<Node>,
    numbers: Vec<f64>,
}

/// A net: the coordinates of the points, and the homogeneous coordinates of a rational net.
#[derive(Clone, Copy)]
pub(super) struct Net<'a> {
    pub(super) points: [&'a [f64]; 3],
    pub(super) homogeneous: Option<[&'a [f64]; 4]>,
}

impl<'a> Net<'a> {
    /// Returns the net at the start of a slice of numbers.
    #[inline]
    pub(super) fn of(numbers: &'a [f64], count: usize, is_rational: bool) -> Self {
        let plane = |k: usize| &numbers[k * count..][..count];
        Self {
            points: [plane(0), plane(1), plane(2)],
            homogeneous: is_rational.then(|| [plane(3), plane(4), plane(5), plane(6)]),
        }
    }
}

impl NetTree {
    /// Returns the tree of whole patches, the root first.
    pub(super) fn new(patches: &[BezierPatch]) -> Self {
        let mut tree = Self::default();
        let boxes: Vec<_> = patches.iter().map(|p| p.aabb()).collect();
        let mut order: Vec<u32> = (0..patches.len() as u32).collect();
        tree.nodes.push(empty());
        let mut todo = vec![(0, 0, patches.len())];
        while let Some((node, from, to)) = todo.pop() {
            if to - from == 1 {
                tree.put_patch(node, order[from], &patches[order[from] as usize]);
                continue;
            }
            let some = order[from..to].iter().map(|&k| boxes[k as usize]);
            let (low, high) = some
                .reduce(|a, b| (a.0.smaller(b.0), a.1.larger(b.1)))
                .unwrap_or_default();
            let axis = (high - low).imax();
            let key = |k: &u32| boxes[*k as usize].0[axis] + boxes[*k as usize].1[axis];
            sort(&mut order[from..to], |a, b| key(a).total_cmp(&key(b)));
            let middle = from + (to - from) / 2;
            let child = tree.nodes.len();
            tree.nodes.extend([empty(), empty()]);
            tree.put_group(node, child as u32, low.coords, high.coords);
            todo.extend([(child, from, middle), (child + 1, middle, to)]);
        }
        tree
    }

    fn put_group(&mut self, node: usize, child: u32, low: Vector3<f64>, high: Vector3<f64>) {
        let at = self.numbers.len() as u32;
        for axis in 0..3 {
            let corner = |k: usize| if k >> axis & 1 == 0 { low[axis] } else { high[axis] };
            self.numbers.extend((0..8).map(corner));
        }
        let reach = sqrt(low.abs().larger(high.abs()).norm_squared()) * ROUND_UP;
        let (centre, radius) = self.ball(at as usize, 8);
        self.nodes[node] = Node {
            child,
            at,
            count: 8,
            centre,
            radius,
            // A box contains nets of patches with any kind of error, so it gets the largest.
            error: reach * (NET_ERROR + crate::base::tolerance::KNOTS),
            reach,
            ..empty()
        };
    }

    fn put_patch(&mut self, node: usize, number: u32, patch: &BezierPatch) {
        let at = self.numbers.len();
        let count = patch.net.len();
        if patch.is_rational {
            self.numbers.extend(core::iter::repeat_n(0.0, 3 * count));
            for k in 0..4 {
                self.numbers.extend(patch.net.iter().map(|h| h[k]));
            }
            self.project(at, count);
        } else {
            for k in 0..3 {
                self.numbers.extend(patch.net.iter().map(|h| h[k]));
            }
        }
        let (centre, radius) = self.ball(at, count);
        self.nodes[node] = Node {
            patch: number,
            at: at as u32,
            count: count as u32,
            along: self.longer(at, count, patch.degrees),
            is_rational: patch.is_rational,
            degrees: patch.degrees,
            centre,
            radius,
            error: patch.reach * (NET_ERROR + patch.noise),
            reach: patch.reach,
            ..empty()
        };
    }

    /// Appends the two halves of a node.
    fn push_halves(&mut self, parent: &Node, net: Net) {
        let count = parent.count as usize;
        let direction = parent.along;
        let planes: &[&[f64]] = match &net.homogeneous {
            Some(four) => four,
            None => &net.points,
        };
        let skip = if parent.is_rational { 3 * count } else { 0 };
        let size = skip + planes.len() * count;
        let at = self.numbers.len();
        self.numbers.resize(at + 2 * size, 0.0);
        let (low, high) = self.numbers[at..].split_at_mut(size);
        for (k, plane) in planes.iter().enumerate() {
            let range = skip + k * count..skip + (k + 1) * count;
            halves(
                plane,
                parent.degrees,
                direction,
                &mut low[range.clone()],
                &mut high[range],
            );
        }
        let k = direction as usize;
        for upper in 0..2 {
            let at = at + upper * size;
            if parent.is_rational {
                self.project(at, count);
            }
            let (centre, radius) = self.ball(at, count);
            let mut node = parent.clone();
            node.child = 0;
            node.at = at as u32;
            node.splits[k] += 1;
            node.low[k] += (upper as u64) << (DEEPEST - node.splits[k]);
            node.along = self.longer(at, count, parent.degrees);
            (node.centre, node.radius) = (centre, radius);
            node.error += NET_STEP * parent.reach * parent.degrees[k] as f64;
            self.nodes.push(node);
        }
    }

    /// Computes the points of a rational net from the homogeneous coordinates.
    fn project(&mut self, at: usize, count: usize) {
        let (points, homogeneous) = self.numbers[at..at + 7 * count].split_at_mut(3 * count);
        let (three, weights) = homogeneous.split_at(3 * count);
        for k in 0..3 {
            for i in 0..count {
                points[k * count + i] = three[k * count + i] / weights[i];
            }
        }
    }

    /// Returns a ball around the points of a net.
    fn ball(&self, at: usize, count: usize) -> (Vector3<f64>, f64) {
        let plane = |k: usize| &self.numbers[at + k * count..][..count];
        let centre = Vector3::from_fn(|k, _| {
            let low = plane(k).iter().copied().fold(f64::INFINITY, f64::smaller);
            let high = plane(k).iter().copied().fold(f64::NEG_INFINITY, f64::larger);
            0.5 * low + 0.5 * high
        });
        let [x, y, z] = [plane(0), plane(1), plane(2)];
        let square = |i: usize| {
            let (a, b, c) = (x[i] - centre.x, y[i] - centre.y, z[i] - centre.z);
            a * a + b * b + c * c
        };
        let most = (0..count).map(square).fold(0.0, f64::larger);
        (centre, sqrt(most) * ROUND_UP)
    }

    /// Returns the direction whose longest leg of the net, times the degree, is longer: 0 for u, 1
    /// for v.
    fn longer(&self, at: usize, count: usize, [p, q]: [usize; 2]) -> u8 {
        let width = q + 1;
        let planes = [0, 1, 2].each(|k| &self.numbers[at + k * count..][..count]);
        let leg = |i: usize, j: usize| -> f64 { planes.iter().map(|x| (x[i] - x[j]) * (x[i] - x[j])).sum() };
        let longest = |d: usize| {
            let (rows, columns, step) = if d == 0 { (p, width, width) } else { (p + 1, q, 1) };
            let all = (0..rows).flat_map(|i| (0..columns).map(move |j| i * width + j));
            all.map(|k| leg(k, k + step)).fold(0.0, f64::larger) * ([p, q][d] * [p, q][d]) as f64
        };
        u8::from(longest(1) > longest(0))
    }

    fn net(&self, node: &Node) -> Net<'_> {
        Net::of(&self.numbers[node.at as usize..], node.count as usize, node.is_rational)
    }
}

fn empty() -> Node {
    Node {
        child: 0,
        patch: GROUP,
        at: 0,
        count: 0,
        splits: [0; 2],
        along: 0,
        is_rational: false,
        low: [0; 2],
        degrees: [1; 2],
        centre: Vector3::zeros(),
        radius: 0.0,
        error: 0.0,
        reach: 0.0,
    }
}

/// The nodes that searches made below the patches of a surface.
#[derive(Clone, Debug, Default)]
pub(super) struct Grown {
    tree: NetTree,
    /// First children of whole patches, by their index in the tree of the surface; 0 if not split.
    of_own: Vec<u32>,
}

impl Grown {
    /// Returns a node of the tree of a surface, or of the nodes made below it.
    #[inline]
    pub(super) fn node<'t>(&'t self, own: &'t NetTree, id: u32) -> &'t Node {
        let (tree, k) = self.tree(own, id);
        &tree.nodes[k]
    }

    #[inline]
    fn tree<'t>(&'t self, own: &'t NetTree, id: u32) -> (&'t NetTree, usize) {
        match (id as usize).checked_sub(own.nodes.len()) {
            Some(k) => (&self.tree, k),
            None => (own, id as usize),
        }
    }

    pub(super) fn numbers(&self) -> usize {
        self.tree.numbers.len()
    }

    pub(super) fn memory_usage(&self) -> usize {
        self.tree.numbers.capacity() * size_of::<f64>()
            + self.tree.nodes.capacity() * size_of::<Node>()
            + self.of_own.capacity() * size_of::<u32>()
    }
}

/// The tree of a surface, and the nodes made below it so far.
pub(super) struct Nodes<'a> {
    own: &'a NetTree,
    grown: &'a mut Grown,
}

impl<'a> Nodes<'a> {
    pub(super) fn new(own: &'a NetTree, grown: &'a mut Grown) -> Self {
        grown.of_own.resize(own.nodes.len(), 0);
        Self { own, grown }
    }

    #[inline]
    pub(super) fn node(&self, id: u32) -> &Node {
        self.grown.node(self.own, id)
    }

    #[inline]
    pub(super) fn net(&self, id: u32) -> Net<'_> {
        let (tree, k) = self.grown.tree(self.own, id);
        tree.net(&tree.nodes[k])
    }

    /// Returns the first of the two children, made if needed; the second has the next index.
    pub(super) fn split(&mut self, id: u32) -> u32 {
        let own = self.own.nodes.len() as u32;
        let known = if id < own && !self.own.nodes[id as usize].is_group() {
            self.grown.of_own[id as usize]
        } else {
            self.node(id).child
        };
        if known != 0 {
            return known;
        }
        let child = own + self.grown.tree.nodes.len() as u32;
        if id < own {
            let parent = &self.own.nodes[id as usize];
            self.grown.tree.push_halves(parent, self.own.net(parent));
            self.grown.of_own[id as usize] = child;
        } else {
            let parent = self.grown.tree.nodes[(id - own) as usize].clone();
            // The numbers may move in memory while the halves are appended.
            let mut copy = [0.0; 4 * NET];
            let count = parent.count as usize;
            let (skip, planes) = if parent.is_rational { (3, 4) } else { (0, 3) };
            let from = parent.at as usize + skip * count;
            copy[..planes * count].copy_from_slice(&self.grown.tree.numbers[from..][..planes * count]);
            let plane = |k: usize| &copy[k * count..][..count];
            let net = Net {
                points: [plane(0), plane(1), plane(2)],
                homogeneous: parent.is_rational.then(|| [plane(0), plane(1), plane(2), plane(3)]),
            };
            self.grown.tree.push_halves(&parent, net);
            self.grown.tree.nodes[(id - own) as usize].child = child;
        }
        child
    }
}

/// The part of a patch over a box of parameters.
pub(super) struct Cut {
    pub(super) node: Node,
    /// Same layout as `NetTree::numbers`.
    numbers: [f64; 7 * NET],
}

impl Cut {
    /// Returns the part of a patch over a box of parameters.
    pub(super) fn new(patch: &BezierPatch, [u, v]: [[f64; 2]; 2]) -> Self {
        let [p, q] = patch.degrees;
        let count = patch.net.len();
        let mut numbers = [0.0; 7 * NET];
        let planes = if patch.is_rational { 3..7 } else { 0..3 };
        for (k, plane) in planes.clone().enumerate() {
            let of = &mut numbers[plane * count..][..count];
            of.iter_mut().zip(&patch.net).for_each(|(x, h)| *x = h[k]);
            keep(of, [p, q + 1, q + 1], u);
            for row in of.chunks_mut(q + 1) {
                keep(row, [q, 1, 1], v);
            }
        }
        if patch.is_rational {
            let (points, homogeneous) = numbers.split_at_mut(3 * count);
            let (three, weights) = homogeneous.split_at(3 * count);
            for k in 0..3 * count {
                points[k] = three[k] / weights[k % count];
            }
        }
        let error = patch.reach * (NET_ERROR + patch.noise + NET_CUT * (p + q) as f64);
        let mut cut = Self {
            node: Node::part(patch, error),
            numbers,
        };
        (cut.node.centre, cut.node.radius) = cut.ball();
        cut
    }

    pub(super) fn net(&self) -> Net<'_> {
        Net::of(&self.numbers, self.node.count as usize, self.node.is_rational)
    }

    /// Returns a ball around the net, not rounded up. It decides what is tried, and scales rounding
    /// terms.
    fn ball(&self) -> (Vector3<f64>, f64) {
        let net = self.net();
        let count = self.node.count as usize;
        let centre = (net.point(0) + net.point(count - 1)) * 0.5;
        let far = |k: usize| (net.point(k) - centre).norm_squared();
        let most = (0..count).map(far).fold(0.0, f64::larger);
        (centre, sqrt(most))
    }
}

/// Reduces a curve to an interval of its parameter. Also reduces several curves at once: rows of
/// `width` numbers that are `step` apart.
fn keep(c: &mut [f64], [degree, step, width]: [usize; 3], [low, high]: [f64; 2]) {
    if high < 1.0 {
        for level in 1..=degree {
            for k in (level * step..degree * step + width).rev() {
                c[k] = (1.0 - high) * c[k - step] + high * c[k];
            }
        }
    }
    if low > 0.0 {
        let t = low / high;
        for level in 1..=degree {
            for k in 0..(degree - level) * step + width {
                c[k] = (1.0 - t) * c[k] + t * c[k + step];
            }
        }
    }
}

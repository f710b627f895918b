//! The polytope: a closed surface of triangles on points of A - B. Each triangle has a lower bound
//! of its distance from the origin, and the triangle of least bound is known. The polytope grows by
//! the insertion of points. A cached polytope is verified at a new pose in a single pass, without
//! roots or divisions ([`verify_surface`]).
//!
//! Invariant: the surface winds once around the origin. The four volumes prove the invariant for
//! the first tetrahedron, and each step preserves it. A triangle is replaced only through the
//! tetrahedron of the triangle and the new point, on the far side of a plane with the origin
//! certainly below it. So the hull of the points contains the ball around the origin that no
//! triangle enters, even if the surface is folded.
//!
//! A point is inserted as follows: a fan from the point to their horizon replaces the triangles
//! that are visible from it. For a large polytope, the set of the vertex pairs of its points is
//! stored ([`VertexPairs`]).
//!
//! ```text
//!      +------+             +------+
//!     / \ v  / \           / '.  .' \      v: visible triangles
//!    /   \  / v \         /    \/    \     horizon: the edges around them
//!   +-----\/-----+   ->  +-----c------+    c: the inserted point, apex of the fan
//!    \  v /\    /         \   / \    /
//!     \  / v\  /           \ /   \  /
//!      +------+             +------+
//! ```
//!
//! At the end of the file are unit directions and triangle normals at every magnitude.

use alloc::collections::BinaryHeap;
use alloc::vec::Vec;

use wide::f64x2;

use crate::base::num::Ranked;
use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::{Scalar, Vec3, cross, dot, neg, root, sub};
use crate::base::tolerance::{AGREE_DEPTH, CERTIFICATE, ORIENTATION, SQUARE_MIN, UNIT};
use crate::body::polyhedron::VertexId;
use crate::convex::depth::memory::MAX_TRIANGLES;
use crate::convex::depth::search::Best;
use crate::convex::minimum::simplex::Simplex;
use crate::pair::difference::MinkowskiPoint;

/// Polytopes with up to this number of points are scanned for a point, hardly slower than hashing.
/// It equals [`MAX_TRIANGLES`], the size for which trackers reserve memory, so queries allocate
/// nothing.
const SCANNED: usize = MAX_TRIANGLES;

/// A triangle with its vertices counter-clockwise seen from outside.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SurfaceTriangle<T> {
    pub(super) vertices: [u32; 3],
    /// Triangle across the edge from vertex k to vertex k + 1.
    neighbours: [u32; 3],
    /// Unit normal of the triangle's plane; zero if degenerate.
    pub(super) outward: Vec3<T>,
    /// Height of the lowest vertex along `outward`.
    level: T,
    /// Unit direction along which all three vertices are at least `bound` high: no point of the
    /// triangle is nearer to the origin.
    pub(super) direction: Vec3<T>,
    pub(super) bound: T,
    state: BoundState,
    /// Number of the last flood to visit the triangle.
    flood: u32,
}

/// The stage to which the bound of a triangle has been computed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum BoundState {
    /// Known to be beyond the target, nothing else.
    #[default]
    Unmeasured,
    /// Normal, and the bound along the normal.
    AlongNormal,
    /// Best bound: along the direction of the nearest point if rounding or an obtuse position
    /// spoils the bound along the normal.
    Best,
}

/// Rounding margins of the visibility test.
pub(super) struct Filter<T> {
    /// Heights above `margin` are certainly positive.
    pub(super) margin: T,
    /// A point more than `noise` above a plane is outside the plane.
    pub(super) noise: T,
}

/// The polytope and its working memory.
#[derive(Clone, Debug)]
pub(super) struct EnclosingSurface<T> {
    pub(super) points: Vec<MinkowskiPoint<T>>,
    /// Vertex pairs of the first points, if there are many points.
    vertex_pairs: VertexPairs,
    pub(super) triangles: Vec<SurfaceTriangle<T>>,
    /// Triangles not known to be beyond `target`.
    queue: BinaryHeap<Ranked<u32>>,
    /// Triangles beyond this height need no work.
    target: T,
    floods: u32,
    /// Triangles visible from the new point, and the horizon around them.
    visible: Vec<u32>,
    horizon: Vec<HorizonEdge>,
    /// Start vertices of the horizon edges, sorted.
    starts: Vec<u32>,
}

impl<T> EnclosingSurface<T> {
    /// Returns the allocated bytes on the heap.
    pub(super) fn memory_usage(&self) -> usize {
        self.points.capacity() * size_of::<MinkowskiPoint<T>>()
            + self.triangles.capacity() * size_of::<SurfaceTriangle<T>>()
            + self.vertex_pairs.memory_usage()
            + self.queue.capacity() * size_of::<Ranked<u32>>()
            + (self.visible.capacity() + self.starts.capacity()) * size_of::<u32>()
            + self.horizon.capacity() * size_of::<HorizonEdge>()
    }
}

impl<T: Scalar> EnclosingSurface<T> {
    /// Returns a polytope without triangles.
    pub(super) fn new() -> Self {
        Self {
            points: Vec::new(),
            vertex_pairs: VertexPairs::default(),
            triangles: Vec::new(),
            queue: BinaryHeap::new(),
            target: T::from(f64::INFINITY),
            floods: 0,
            visible: Vec::new(),
            horizon: Vec::new(),
            starts: Vec::new(),
        }
    }

    /// Allocates for the given number of triangles.
    pub(super) fn reserve(&mut self, triangles: usize) {
        self.points.reserve(triangles);
        self.triangles.reserve(triangles);
        self.queue.reserve(2 * triangles);
        self.visible.reserve(triangles);
        self.horizon.reserve(triangles);
        self.starts.reserve(triangles);
    }

    /// Removes all points and triangles and sets the target.
    pub(super) fn clear(&mut self, target: T) {
        self.points.clear();
        self.vertex_pairs.clear();
        self.triangles.clear();
        self.queue.clear();
        self.target = target;
        self.floods = 0;
    }

    /// Resets the polytope to the tetrahedron of four points; returns false if there are not four.
    pub(super) fn start(&mut self, vertices: &[MinkowskiPoint<T>]) -> bool {
        let Ok([p, q, r, s]) = <&[MinkowskiPoint<T>; 4]>::try_from(vertices) else {
            return false;
        };
        let (u, v, x) = (sub(&q.w, &p.w), sub(&r.w, &p.w), sub(&s.w, &p.w));
        let right = dot(&u, &cross(&v, &x)) > T::from(0.0);
        self.clear(T::from(f64::INFINITY));
        self.points
            .extend_from_slice(&if right { [*p, *q, *r, *s] } else { [*q, *p, *r, *s] });
        // Vertices and adjacent faces, numbered as in this list.
        let faces = [
            ([0, 2, 1], [2, 3, 1]),
            ([0, 1, 3], [0, 3, 2]),
            ([0, 3, 2], [1, 3, 0]),
            ([1, 2, 3], [0, 2, 1]),
        ];
        for (k, (vertices, neighbours)) in (0..4).zip(faces) {
            self.push(vertices, neighbours);
            self.compute_bound(k);
        }
        true
    }

    /// Sets the height beyond which triangles need no work; must never exceed the previous target.
    pub(super) fn set_target(&mut self, target: T) {
        self.target = target;
    }

    /// Returns the target: every triangle is beyond the target if [`weakest`](Self::weakest)
    /// returns `None`.
    pub(super) fn target(&self) -> T {
        self.target
    }

    /// Returns the positions of a triangle's vertices.
    #[inline]
    fn positions(&self, vertices: &[u32; 3]) -> [Vec3<T>; 3] {
        vertices.each(|c| self.points[c as usize].w)
    }

    /// Returns the vertices of a triangle.
    pub(super) fn vertices(&self, triangle: u32) -> [MinkowskiPoint<T>; 3] {
        self.triangles[triangle as usize]
            .vertices
            .each(|c| self.points[c as usize])
    }

    /// Returns whether a point of the given vertex pair was inserted before.
    pub(super) fn contains_pair(&mut self, c: &MinkowskiPoint<T>) -> bool {
        let pair = |c: &MinkowskiPoint<T>| [c.a, c.b];
        if self.points.len() <= SCANNED {
            return self.points.iter().any(|p| pair(p) == pair(c));
        }
        let count = self.vertex_pairs.count();
        self.points[count..]
            .iter()
            .for_each(|p| self.vertex_pairs.insert(pair(p)));
        self.vertex_pairs.contains(pair(c))
    }

    /// Returns point indices and adjacent triangles of every triangle.
    pub(super) fn indices(&self) -> impl ExactSizeIterator<Item = ([u32; 3], [u32; 3])> + '_ {
        self.triangles.iter().map(|t| (t.vertices, t.neighbours))
    }

    /// Adds a triangle known to be beyond the target.
    pub(super) fn push(&mut self, vertices: [u32; 3], neighbours: [u32; 3]) {
        self.triangles.push(SurfaceTriangle {
            vertices,
            neighbours,
            ..SurfaceTriangle::default()
        });
    }

    /// Computes the bound of a triangle and queues the triangle if below the target.
    pub(super) fn compute_bound(&mut self, triangle: u32) {
        self.triangles[triangle as usize].state = BoundState::Unmeasured;
        self.measure(triangle);
        self.enqueue(triangle);
    }

    /// Computes the normal of a triangle and the bound along the normal.
    fn measure(&mut self, triangle: u32) {
        let t = &self.triangles[triangle as usize];
        if t.state != BoundState::Unmeasured {
            return;
        }
        let w = self.positions(&t.vertices);
        let outward = normal(&w);
        let level = min_height(&outward, &w);
        // NaN means nothing known.
        let level = if level > T::from(f64::NEG_INFINITY) {
            level
        } else {
            T::from(0.0)
        };
        let t = &mut self.triangles[triangle as usize];
        (t.outward, t.level) = (outward, level);
        (t.direction, t.bound) = (outward, level);
        t.state = BoundState::AlongNormal;
    }

    fn enqueue(&mut self, triangle: u32) {
        let bound = self.triangles[triangle as usize].bound;
        // NaN is queued.
        if !(bound >= self.target) {
            // A bound of -0 ranks as 0.
            let rank = bound.value() + 0.0;
            let (key, item) = (triangle, ());
            self.queue.push(Ranked { rank, key, item });
        }
    }

    /// Replaces the bound along the normal by the bound along the direction of the nearest point if
    /// better; returns whether the bound improved.
    fn refine(&mut self, triangle: u32) -> bool {
        let t = &mut self.triangles[triangle as usize];
        if t.state == BoundState::Best {
            return false;
        }
        t.state = BoundState::Best;
        let nearest = Simplex::triangle(t.vertices.each(|c| self.points[c as usize]));
        if nearest.len() == 3 && t.bound > T::from(0.0) {
            return false;
        }
        let direction = unit(&nearest.direction());
        let bound = min_height(&direction, &t.vertices.each(|c| self.points[c as usize].w));
        let better = bound > t.bound;
        if better {
            (t.direction, t.bound) = (direction, bound);
        }
        better
    }

    /// Moves every point to its position from `place`, and computes every bound again.
    pub(super) fn reposition(&mut self, place: impl Fn(&MinkowskiPoint<T>) -> MinkowskiPoint<T>) {
        for p in &mut self.points {
            *p = place(p);
        }
        self.queue.clear();
        self.target = T::from(f64::INFINITY);
        for k in 0..self.triangles.len() as u32 {
            self.compute_bound(k);
        }
    }

    /// Returns the height of a triangle's lowest vertex along a direction.
    pub(super) fn height(&self, triangle: u32, n: &Vec3<T>) -> T {
        min_height(n, &self.positions(&self.triangles[triangle as usize].vertices))
    }

    /// Returns the triangle of least bound; `None` if all are beyond the target.
    pub(super) fn weakest(&mut self) -> Option<u32> {
        loop {
            let &Ranked {
                rank: bound,
                key: triangle,
                ..
            } = self.queue.peek()?;
            let is_current = self
                .triangles
                .get(triangle as usize)
                .is_some_and(|t| t.bound.value() == bound && !(t.bound >= self.target));
            if !is_current {
                self.queue.pop();
            } else if self.refine(triangle) {
                self.queue.pop();
                self.enqueue(triangle);
            } else {
                return Some(triangle);
            }
        }
    }

    /// Tries a direction for the bound of a triangle; returns whether the bound improved.
    pub(super) fn improve_bound(&mut self, triangle: u32, direction: &Vec3<T>) -> bool {
        let bound = self.height(triangle, direction);
        let t = &mut self.triangles[triangle as usize];
        let better = bound > t.bound;
        if better {
            (t.direction, t.bound) = (*direction, bound);
            self.enqueue(triangle);
        }
        better
    }
}

/// An edge between a visible triangle and a triangle that stays.
#[derive(Clone, Copy, Debug)]
pub(super) struct HorizonEdge {
    from: u32,
    to: u32,
    outer: u32,
}

impl<T> SurfaceTriangle<T> {
    fn edges(&self) -> [HorizonEdge; 3] {
        core::array::from_fn(|k| HorizonEdge {
            from: self.vertices[k],
            to: self.vertices[(k + 1) % 3],
            outer: self.neighbours[k],
        })
    }
}

impl<T: Scalar> EnclosingSurface<T> {
    /// Inserts a point higher than `triangle` along the triangle's direction, and replaces the
    /// triangles visible from the point.
    pub(in crate::convex::depth) fn insert(&mut self, triangle: u32, c: MinkowskiPoint<T>, filter: &Filter<T>) {
        self.flood(triangle, &c.w, filter);
        if !self.order_horizon() {
            // The three edges of a triangle are always a loop.
            self.visible.clear();
            self.visible.push(triangle);
            self.horizon.clear();
            self.horizon.extend(self.triangles[triangle as usize].edges());
        }
        self.points.push(c);
        self.add_fan();
        // Removes the highest index first, so that no listed triangle moves.
        let count = self.horizon.len();
        while self.visible.len() > count {
            let left = &self.visible[count..];
            let last = left.iter().enumerate().max_by_key(|(_, t)| **t).map_or(0, |(k, _)| k);
            let hole = self.visible.swap_remove(count + last);
            self.remove(hole);
        }
    }

    /// Joins the last point to every horizon edge, reusing the visible triangles and adding more if
    /// needed.
    fn add_fan(&mut self) {
        let apex = self.points.len() as u32 - 1;
        let (kept, count) = (self.visible.len(), self.horizon.len());
        let added = self.triangles.len();
        for k in kept..count {
            self.triangles.push(SurfaceTriangle::default());
            self.visible.push((added + k - kept) as u32);
        }
        for k in 0..count {
            let HorizonEdge { from, to, outer } = self.horizon[k];
            let (at, after, before) = (
                self.visible[k],
                self.visible[(k + 1) % count],
                self.visible[(k + count - 1) % count],
            );
            self.triangles[at as usize] = SurfaceTriangle {
                vertices: [from, to, apex],
                neighbours: [outer, after, before],
                ..SurfaceTriangle::default()
            };
            self.compute_bound(at);
            self.join(outer, [to, from], at);
        }
    }

    /// Makes `other` the neighbour of a triangle across an edge.
    fn join(&mut self, triangle: u32, edge: [u32; 2], other: u32) {
        let t = &mut self.triangles[triangle as usize];
        for i in 0..3 {
            if [t.vertices[i], t.vertices[(i + 1) % 3]] == edge {
                t.neighbours[i] = other;
            }
        }
    }

    /// Removes a triangle no neighbour refers to; the last triangle takes its index.
    fn remove(&mut self, hole: u32) {
        let last = self.triangles.len() as u32 - 1;
        self.triangles.swap_remove(hole as usize);
        if hole == last {
            return;
        }
        let SurfaceTriangle {
            vertices, neighbours, ..
        } = self.triangles[hole as usize];
        for i in 0..3 {
            self.join(neighbours[i], [vertices[(i + 1) % 3], vertices[i]], hole);
        }
        if self.triangles[hole as usize].state != BoundState::Unmeasured {
            self.enqueue(hole);
        }
    }

    /// Lists the triangles connected to `from` that are visible from `w` and may be replaced.
    fn flood(&mut self, from: u32, w: &Vec3<T>, filter: &Filter<T>) {
        self.floods += 1;
        self.visible.clear();
        self.visible.push(from);
        self.triangles[from as usize].flood = self.floods;
        let mut done = 0;
        while done < self.visible.len() {
            for k in self.triangles[self.visible[done] as usize].neighbours {
                if self.triangles[k as usize].flood == self.floods || !self.is_visible(k, w, filter) {
                    continue;
                }
                self.triangles[k as usize].flood = self.floods;
                self.visible.push(k);
            }
            done += 1;
        }
    }

    /// Returns whether `w` is outside the plane of a triangle, and some plane certainly has the
    /// origin beneath and both the triangle and `w` above.
    pub(in crate::convex::depth) fn is_visible(&mut self, triangle: u32, w: &Vec3<T>, filter: &Filter<T>) -> bool {
        self.measure(triangle);
        let t = &self.triangles[triangle as usize];
        let p = &self.points[t.vertices[0] as usize].w;
        let is_flat = t.outward.iter().all(|x| x.value() == 0.0);
        // Outside the triangle's plane, `w` is at least as high along the normal as the vertices.
        if !is_flat && !(dot(&t.outward, &sub(w, p)) > filter.noise) {
            return false;
        }
        if !is_flat && t.level > filter.margin {
            return true;
        }
        if self.refine(triangle) {
            self.enqueue(triangle);
        }
        let t = &self.triangles[triangle as usize];
        let height = dot(&t.direction, w);
        let above = t.bound > filter.margin && height > filter.margin;
        above && (!is_flat || height > t.bound + filter.noise)
    }

    /// Orders the horizon edges around the visible triangles; returns whether they form a single
    /// loop without a repeated vertex.
    fn order_horizon(&mut self) -> bool {
        let (flood, all) = (self.floods, &self.triangles);
        let edges = &mut self.horizon;
        edges.clear();
        let edges_of_visible = self.visible.iter().flat_map(|&t| all[t as usize].edges());
        edges.extend(edges_of_visible.filter(|e| all[e.outer as usize].flood != flood));
        for k in 1..edges.len() {
            let Some(next) = (k..edges.len()).find(|&i| edges[i].from == edges[k - 1].to) else {
                return false;
            };
            edges.swap(k, next);
        }
        self.starts.clear();
        self.starts.extend(edges.iter().map(|e| e.from));
        self.starts.sort_unstable();
        let simple = self.starts.windows(2).all(|s| s[0] != s[1]);
        let closed = edges.last().is_some_and(|e| e.to == edges[0].from);
        simple && closed && edges.len() > 2
    }
}

/// Marks a free slot: no vertices have such numbers.
const VACANT: [VertexId; 2] = [VertexId(u32::MAX); 2];

/// A hash table without removal: open addressing, linear probing (Knuth, section 6.4).
#[derive(Clone, Debug, Default)]
pub(super) struct VertexPairs {
    /// At most half of the slots are occupied.
    slots: Vec<[VertexId; 2]>,
    count: usize,
}

impl VertexPairs {
    /// Returns the allocated bytes on the heap.
    pub(super) fn memory_usage(&self) -> usize {
        self.slots.capacity() * size_of::<[VertexId; 2]>()
    }

    pub(super) fn clear(&mut self) {
        self.slots.clear();
        self.count = 0;
    }

    /// Returns the number of insertions, repeats included.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    pub(super) fn contains(&self, pair: [VertexId; 2]) -> bool {
        !self.slots.is_empty() && self.slots[self.slot(pair)] == pair
    }

    pub(super) fn insert(&mut self, pair: [VertexId; 2]) {
        self.count += 1;
        if 2 * self.count > self.slots.len() {
            let larger = alloc::vec![VACANT; 4 * self.count];
            let old = core::mem::replace(&mut self.slots, larger);
            for pair in old.into_iter().filter(|&pair| pair != VACANT) {
                let slot = self.slot(pair);
                self.slots[slot] = pair;
            }
        }
        let slot = self.slot(pair);
        self.slots[slot] = pair;
    }

    /// Returns the slot of a pair, or the free slot for a new pair. The table must not be empty.
    fn slot(&self, [a, b]: [VertexId; 2]) -> usize {
        // High half of a product with 2^64 over the golden ratio.
        let hash = (u64::from(a.0) << 32 | u64::from(b.0)).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32;
        let mut slot = ((hash * self.slots.len() as u64) >> 32) as usize;
        while self.slots[slot] != VACANT && self.slots[slot] != [a, b] {
            slot = if slot + 1 < self.slots.len() { slot + 1 } else { 0 };
        }
        slot
    }
}

/// Result of the verification.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum SurfaceState {
    /// The polytope encloses the origin and every triangle is beyond the facet: the depth is
    /// proven.
    Proven,
    /// The polytope encloses the origin; some triangles are below target.
    Encloses,
    /// The origin is not certainly behind every triangle.
    Folded,
}

/// Requirements on a triangle.
pub(super) struct Target {
    /// Normal of the best facet.
    normal: Vec3<f64>,
    /// Required distance of a triangle from the origin.
    height: f64,
    /// Heights above `margin` are certainly positive.
    margin: f64,
    noise: f64,
}

/// Verifies two triangles at a time by SIMD and lists the triangles below target in `below_target`.
pub(super) fn verify_surface(
    triangles: &[[u8; 6]],
    positions: &[Vec3<f64>],
    best: &Best<f64>,
    size: f64,
    below_target: &mut Vec<u32>,
) -> SurfaceState {
    let target = Target::new(best, size);
    let is_deep = target.is_deep();
    let (zero, noise) = (f64x2::splat(0.0), f64x2::splat(target.noise));
    let squared_target = f64x2::splat(target.height * target.height);
    below_target.clear();
    for (k, pair) in triangles.chunks(2).enumerate() {
        let (s, t) = (&pair[0], &pair[pair.len() - 1]);
        let w: [Vec3<f64x2>; 3] = core::array::from_fn(|c| {
            let (p, q) = (&positions[s[c] as usize], &positions[t[c] as usize]);
            core::array::from_fn(|axis| f64x2::new([p[axis], q[axis]]))
        });
        let (n, edges) = normals(&w);
        // All vertices are as high along n as the first, up to rounding.
        let low = dot_pair(&n, &w[0]) - noise * edges;
        let is_beyond = low.simd_gt(zero) & (low * low).simd_ge(squared_target * dot_pair(&n, &n));
        if is_deep && is_beyond.all() {
            continue;
        }
        for (lane, t) in pair.iter().enumerate() {
            match target.judge(&[t[0], t[1], t[2]].each(|c| positions[c as usize])) {
                None => return SurfaceState::Folded,
                Some(true) => {}
                Some(false) => below_target.push((2 * k + lane) as u32),
            }
        }
    }
    if below_target.is_empty() {
        SurfaceState::Proven
    } else {
        SurfaceState::Encloses
    }
}

/// Returns the normals of two triangles, of twice the triangle's area, and the sums of two squared
/// edge lengths.
#[inline(always)]
fn normals(w: &[Vec3<f64x2>; 3]) -> (Vec3<f64x2>, f64x2) {
    let less = |p: &Vec3<f64x2>, q: &Vec3<f64x2>| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    let (u, v) = (less(&w[1], &w[0]), less(&w[2], &w[0]));
    let n = [
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
    ];
    (n, dot_pair(&u, &u) + dot_pair(&v, &v))
}

#[inline(always)]
fn dot_pair(u: &Vec3<f64x2>, v: &Vec3<f64x2>) -> f64x2 {
    u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
}

impl Target {
    /// Returns the requirements on triangles of a pair of this size, in addition to the best facet.
    #[inline(always)]
    pub(super) fn new(best: &Best<f64>, size: f64) -> Self {
        Self {
            normal: best.normal,
            height: best.height - AGREE_DEPTH * size,
            margin: 2.0 * CERTIFICATE * UNIT * size,
            noise: ORIENTATION * size,
        }
    }

    /// Returns the same requirements reflected in the origin.
    pub(super) fn reflected(self) -> Self {
        Self {
            normal: neg(&self.normal),
            ..self
        }
    }

    /// Returns whether the required distance is certainly positive.
    #[inline(always)]
    pub(super) fn is_deep(&self) -> bool {
        self.height > self.margin
    }

    /// Returns whether a triangle is beyond the facet although its plane is not: the triangle lies
    /// entirely beyond its nearest point.
    fn is_far(&self, w: &[Vec3<f64>; 3]) -> bool {
        let nearest = Simplex::triangle(w.each(|w| MinkowskiPoint {
            w,
            ..MinkowskiPoint::default()
        }))
        .direction();
        let low = min_height(&nearest, w);
        low > 0.0 && low * low >= self.height * self.height * dot(&nearest, &nearest)
    }

    /// Returns whether a triangle is beyond the facet; `None` unless the origin is certainly behind
    /// the triangle and clear of it.
    pub(super) fn judge(&self, w: &[Vec3<f64>; 3]) -> Option<bool> {
        let (u, v) = (sub(&w[1], &w[0]), sub(&w[2], &w[0]));
        let n = cross(&u, &v);
        let (low, squared) = (min_height(&n, w), dot(&n, &n));
        let rounding = self.noise * self.noise * dot(&u, &u) * dot(&v, &v);
        // NaN counts as a fold.
        if !(low > 0.0 && low * low > rounding && low * low > self.margin * self.margin * squared) {
            return None;
        }
        let is_beyond = low * low >= self.height * self.height * squared
            || min_height(&self.normal, w) >= self.height
            || self.is_far(w);
        Some(self.height > self.margin && is_beyond)
    }
}

/// Returns the unit vector along `v`; zero if `v` has no direction.
#[inline]
pub(super) fn unit<T: Scalar>(v: &Vec3<T>) -> Vec3<T> {
    let squared = dot(v, v);
    if squared.value() > SQUARE_MIN && squared.value() < 1.0 / SQUARE_MIN {
        let by = T::from(1.0) / root(squared);
        return v.each(|x| x * by);
    }
    let largest = v.iter().fold(0.0f64, |m, x| m.larger(x.value().abs()));
    if !(largest > 0.0 && largest < f64::INFINITY) {
        return [T::from(0.0); 3];
    }
    let v = v.each(|x| x / T::from(largest));
    let norm = root(dot(&v, &v));
    v.each(|x| x / norm)
}

/// Returns the least height of three points along a direction.
#[inline]
pub(super) fn min_height<T: Scalar>(n: &Vec3<T>, w: &[Vec3<T>; 3]) -> T {
    let h = w.each(|w| dot(n, &w));
    let low = if h[1] < h[0] { h[1] } else { h[0] };
    if h[2] < low { h[2] } else { low }
}

/// Returns the unit normal of a triangle, from the two shorter edges.
#[inline]
pub(super) fn normal<T: Scalar>(w: &[Vec3<T>; 3]) -> Vec3<T> {
    let edges = [sub(&w[1], &w[0]), sub(&w[2], &w[1]), sub(&w[0], &w[2])];
    let length = edges.each(|e| dot(&e, &e).value());
    let (u, v) = if length[0] >= length[1] && length[0] >= length[2] {
        (&edges[1], &edges[2])
    } else if length[1] >= length[2] {
        (&edges[2], &edges[0])
    } else {
        (&edges[0], &edges[1])
    };
    let n = cross(u, v);
    // The product of the shortest edges may underflow.
    if dot(&n, &n).value() > SQUARE_MIN {
        return unit(&n);
    }
    let by_size = |e: &Vec3<T>| {
        let m = e.iter().fold(0.0f64, |m, x| m.larger(x.value().abs()));
        if m > 0.0 { e.each(|x| x / T::from(m)) } else { *e }
    };
    unit(&cross(&by_size(u), &by_size(v)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;
    use alloc::collections::BTreeSet;

    #[test]
    fn vertex_pairs_are_a_set() {
        let mut rng = Rng::new(5);
        let (mut pairs, mut set) = (VertexPairs::default(), BTreeSet::new());
        for _ in 0..3 {
            pairs.clear();
            set.clear();
            let mut known = 0;
            for _ in 0..4000 {
                let pair = [0; 2].map(|_| VertexId(rng.below(60) as u32));
                known += usize::from(set.contains(&pair));
                assert_eq!(pairs.contains(pair), set.contains(&pair));
                pairs.insert(pair);
                set.insert(pair);
            }
            assert!(set.iter().all(|&pair| pairs.contains(pair)));
            assert!(known > 1000 && set.len() > 1000, "{known}");
        }
    }
}

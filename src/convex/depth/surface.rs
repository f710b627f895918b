//! A closed surface of triangles on points of A - B, with a lower bound of each triangle's distance
//! from the origin and the triangle of least bound. Insertion of a point: [`grow`].
//!
//! Invariant: the surface winds once about the origin. The four volumes prove the invariant for the
//! first tetrahedron, and each step preserves it: a triangle is replaced only by way of the
//! tetrahedron of the triangle and the new point, on the far side of a plane with the origin
//! certainly beneath. So the hull of the points contains the ball about the origin that no triangle
//! enters, however folded the surface is.

mod grow;
mod vertex_pairs;

use alloc::collections::BinaryHeap;
use alloc::vec::Vec;

use crate::base::num::Ranked;
use crate::base::num::scalar::{Scalar, Vec3, cross, dot, sub};
use crate::convex::depth::direction::{min_height, normal, unit};
use crate::convex::depth::memory::MAX_TRIANGLES;
use crate::convex::minimum::simplex::Simplex;
use crate::pair::difference::MinkowskiPoint;
use grow::HorizonEdge;
use vertex_pairs::VertexPairs;

/// Surfaces of up to this many points are scanned for a point, hardly slower than hashing. Equal to
/// [`MAX_TRIANGLES`], the size for which trackers reserve memory, so that queries allocate nothing.
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

/// How far the bound of a triangle has been computed.
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

/// The surface and its working memory.
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
    pub(super) fn heap_bytes(&self) -> usize {
        self.points.capacity() * size_of::<MinkowskiPoint<T>>()
            + self.triangles.capacity() * size_of::<SurfaceTriangle<T>>()
            + self.vertex_pairs.heap_bytes()
            + self.queue.capacity() * size_of::<Ranked<u32>>()
            + (self.visible.capacity() + self.starts.capacity()) * size_of::<u32>()
            + self.horizon.capacity() * size_of::<HorizonEdge>()
    }
}

impl<T: Scalar> EnclosingSurface<T> {
    /// Returns a surface without triangles.
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

    /// Resets the surface to the tetrahedron of four points; returns false if not given four.
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
        vertices.map(|c| self.points[c as usize].w)
    }

    /// Returns the vertices of a triangle.
    pub(super) fn vertices(&self, triangle: u32) -> [MinkowskiPoint<T>; 3] {
        self.triangles[triangle as usize]
            .vertices
            .map(|c| self.points[c as usize])
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
        let nearest = Simplex::triangle(t.vertices.map(|c| self.points[c as usize]));
        if nearest.len() == 3 && t.bound > T::from(0.0) {
            return false;
        }
        let direction = unit(&nearest.direction());
        let bound = min_height(&direction, &t.vertices.map(|c| self.points[c as usize].w));
        let better = bound > t.bound;
        if better {
            (t.direction, t.bound) = (direction, bound);
        }
        better
    }

    /// Moves every point by `place` and computes every bound again.
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

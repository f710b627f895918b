//! A closed surface of triangles on points of the Minkowski difference: how near each may be, and which is the nearest. How it takes in
//! a point: [`grow`].
//!
//! Invariant: the surface winds once about the origin. It holds for the first tetrahedron, whose volumes prove it, and
//! each step keeps it: a triangle is replaced only by way of the tetrahedron of it and the new point, and that lies on the far
//! side of a plane that the origin is certainly beneath. So the hull of the points holds the ball about the origin that no
//! triangle reaches into, however the surface is folded.

mod grow;
mod names;

use alloc::vec::Vec;

use crate::depth::direction::{least, normal, unit};
use crate::depth::queue::{Entry, Queue};
use crate::minimum::simplex::Simplex;
use crate::num::scalar::{Scalar, Vec3, cross, dot, sub};
use crate::pair::difference::MinkowskiPoint;
use crate::tuning::depth::SCANNED;
use grow::Border;
use names::Names;

/// One triangle, its corners counter-clockwise seen from outside.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Triangle<T> {
    pub(super) corners: [u32; 3],
    /// The triangle across the edge from corner k to corner k + 1.
    beside: [u32; 3],
    /// Unit normal of its plane; zero where it has none.
    pub(super) outward: Vec3<T>,
    /// How high its lowest corner is along that.
    level: T,
    /// A unit direction along which all three corners are at least `bound` high: the triangle is no nearer.
    pub(super) direction: Vec3<T>,
    pub(super) bound: T,
    state: Measured,
    /// The last flood that looked at it.
    flood: u32,
}

/// What is known of a triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Measured {
    /// That it is beyond what is of interest, and nothing else.
    #[default]
    Not,
    /// Its normal, and the bound from that.
    Plane,
    /// The best bound: that of the direction of its nearest point, where rounding or the triangle's place spoils the normal's.
    Whole,
}

/// What rounding asks of a flood.
pub(super) struct Filter<T> {
    /// Heights above this are certainly positive.
    pub(super) margin: T,
    /// A point this far above a plane is outside it.
    pub(super) noise: T,
}

/// The surface, and room to work in.
#[derive(Clone, Debug)]
pub(super) struct Surface<T> {
    pub(super) points: Vec<MinkowskiPoint<T>>,
    /// The vertices of the first points, where there are many.
    names: Names,
    pub(super) triangles: Vec<Triangle<T>>,
    /// Those that are not known to be beyond `enough`.
    queue: Queue,
    /// Triangles beyond this are of no interest.
    enough: T,
    floods: u32,
    /// Triangles that see the new point, and the border round them.
    visible: Vec<u32>,
    border: Vec<Border>,
    /// Where the edges of the border begin, in order.
    starts: Vec<u32>,
}

impl<T> Surface<T> {
    /// Bytes on the heap.
    pub(super) fn heap_bytes(&self) -> usize {
        self.points.capacity() * size_of::<MinkowskiPoint<T>>()
            + self.triangles.capacity() * size_of::<Triangle<T>>()
            + self.names.heap_bytes()
            + self.queue.heap_bytes()
            + (self.visible.capacity() + self.starts.capacity()) * size_of::<u32>()
            + self.border.capacity() * size_of::<Border>()
    }
}

impl<T: Scalar> Surface<T> {
    /// One without triangles.
    pub(super) fn new() -> Self {
        Self {
            points: Vec::new(),
            names: Names::default(),
            triangles: Vec::new(),
            queue: Queue::default(),
            enough: T::from(f64::INFINITY),
            floods: 0,
            visible: Vec::new(),
            border: Vec::new(),
            starts: Vec::new(),
        }
    }

    /// Takes room for so many triangles.
    pub(super) fn reserve(&mut self, triangles: usize) {
        self.points.reserve(triangles);
        self.triangles.reserve(triangles);
        self.queue.reserve(2 * triangles);
        self.visible.reserve(triangles);
        self.border.reserve(triangles);
        self.starts.reserve(triangles);
    }

    /// Without points and triangles, and interested in what is not beyond `enough`.
    pub(super) fn clear(&mut self, enough: T) {
        self.points.clear();
        self.names.clear();
        self.triangles.clear();
        self.queue.clear();
        self.enough = enough;
        self.floods = 0;
    }

    /// Makes it the tetrahedron of four corners; whether there are four.
    pub(super) fn start(&mut self, corners: &[MinkowskiPoint<T>]) -> bool {
        let Ok([p, q, r, s]) = <&[MinkowskiPoint<T>; 4]>::try_from(corners) else {
            return false;
        };
        let (u, v, x) = (sub(&q.w, &p.w), sub(&r.w, &p.w), sub(&s.w, &p.w));
        let right = dot(&u, &cross(&v, &x)) > T::from(0.0);
        self.clear(T::from(f64::INFINITY));
        self.points
            .extend_from_slice(&if right { [*p, *q, *r, *s] } else { [*q, *p, *r, *s] });
        // Across its edges, by the numbers of the faces in this list.
        let faces = [
            ([0, 2, 1], [2, 3, 1]),
            ([0, 1, 3], [0, 3, 2]),
            ([0, 3, 2], [1, 3, 0]),
            ([1, 2, 3], [0, 2, 1]),
        ];
        for (k, (corners, beside)) in (0..4).zip(faces) {
            self.push(corners, beside);
            self.weigh(k);
        }
        true
    }

    /// From now on, triangles beyond `enough` are of no interest; never more than before.
    pub(super) fn expect(&mut self, enough: T) {
        self.enough = enough;
    }

    /// What every triangle that is not returned by [`weakest`](Self::weakest) is beyond.
    pub(super) fn enough(&self) -> T {
        self.enough
    }

    /// Where the corners of a triangle are.
    #[inline]
    fn places(&self, corners: &[u32; 3]) -> [Vec3<T>; 3] {
        corners.map(|c| self.points[c as usize].w)
    }

    /// The corners of a triangle.
    pub(super) fn corners(&self, triangle: u32) -> [MinkowskiPoint<T>; 3] {
        self.triangles[triangle as usize]
            .corners
            .map(|c| self.points[c as usize])
    }

    /// Whether a point of these vertices was taken in before.
    pub(super) fn knows(&mut self, c: &MinkowskiPoint<T>) -> bool {
        let name = |c: &MinkowskiPoint<T>| [c.a, c.b];
        if self.points.len() <= SCANNED {
            return self.points.iter().any(|p| name(p) == name(c));
        }
        let count = self.names.count();
        self.points[count..].iter().for_each(|p| self.names.insert(name(p)));
        self.names.contains(name(c))
    }

    /// Corners and neighbours of every triangle.
    pub(super) fn names(&self) -> impl ExactSizeIterator<Item = ([u32; 3], [u32; 3])> + '_ {
        self.triangles.iter().map(|t| (t.corners, t.beside))
    }

    /// Adds a triangle that is known to be beyond what is of interest.
    pub(super) fn push(&mut self, corners: [u32; 3], beside: [u32; 3]) {
        self.triangles.push(Triangle {
            corners,
            beside,
            ..Triangle::default()
        });
    }

    /// Measures a triangle and queues it if it is of interest.
    pub(super) fn weigh(&mut self, triangle: u32) {
        self.triangles[triangle as usize].state = Measured::Not;
        self.measure(triangle);
        self.enqueue(triangle);
    }

    /// Takes the normal of a triangle and the bound from that.
    fn measure(&mut self, triangle: u32) {
        let t = &self.triangles[triangle as usize];
        if t.state != Measured::Not {
            return;
        }
        let w = self.places(&t.corners);
        let outward = normal(&w);
        let level = least(&outward, &w);
        // NaN is nothing known.
        let level = if level > T::from(f64::NEG_INFINITY) {
            level
        } else {
            T::from(0.0)
        };
        let t = &mut self.triangles[triangle as usize];
        (t.outward, t.level) = (outward, level);
        (t.direction, t.bound) = (outward, level);
        t.state = Measured::Plane;
    }

    fn enqueue(&mut self, triangle: u32) {
        let bound = self.triangles[triangle as usize].bound;
        // Written so that NaN is of interest.
        if !(bound >= self.enough) {
            let bound = bound.value();
            self.queue.push(Entry { bound, triangle });
        }
    }

    /// Takes the direction of the nearest point where that gives a better bound than the normal; whether it does.
    fn refine(&mut self, triangle: u32) -> bool {
        let t = &mut self.triangles[triangle as usize];
        if t.state == Measured::Whole {
            return false;
        }
        t.state = Measured::Whole;
        let nearest = Simplex::triangle(t.corners.map(|c| self.points[c as usize]));
        if nearest.len() == 3 && t.bound > T::from(0.0) {
            return false;
        }
        let direction = unit(&nearest.direction());
        let bound = least(&direction, &t.corners.map(|c| self.points[c as usize].w));
        let better = bound > t.bound;
        if better {
            (t.direction, t.bound) = (direction, bound);
        }
        better
    }

    /// Takes every point and triangle anew, the points placed by `place`.
    pub(super) fn place(&mut self, place: impl Fn(&MinkowskiPoint<T>) -> MinkowskiPoint<T>) {
        for p in &mut self.points {
            *p = place(p);
        }
        self.queue.clear();
        self.enough = T::from(f64::INFINITY);
        for k in 0..self.triangles.len() as u32 {
            self.weigh(k);
        }
    }

    /// How high the lowest corner of a triangle is along a direction.
    pub(super) fn height(&self, triangle: u32, n: &Vec3<T>) -> T {
        least(n, &self.places(&self.triangles[triangle as usize].corners))
    }

    /// The triangle of the least bound; none where all are beyond `enough`.
    pub(super) fn weakest(&mut self) -> Option<u32> {
        loop {
            let Entry { bound, triangle } = self.queue.first()?;
            let is_current = self
                .triangles
                .get(triangle as usize)
                .is_some_and(|t| t.bound.value() == bound && !(t.bound >= self.enough));
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

    /// Tries another direction for the bound of a triangle; whether it is better.
    pub(super) fn raise(&mut self, triangle: u32, direction: &Vec3<T>) -> bool {
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

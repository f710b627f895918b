//! A closed surface of triangles on points of the Minkowski difference, and how it grows.
//!
//! Invariant: the surface winds once about the origin. It holds for the first tetrahedron, whose volumes prove it, and
//! each step keeps it: a triangle is replaced only by way of the tetrahedron of it and the new point, and that lies on the far
//! side of a plane that the origin is certainly beneath. So the hull of the points holds the ball about the origin that no
//! triangle reaches into, however the surface is folded.

use alloc::collections::BinaryHeap;
use alloc::vec::Vec;
use core::cmp::Ordering;

use crate::closest::simplex::{Corner, Simplex};
use crate::scalar::{Scalar, Vec3, cross, dot, root, scaled, sub};

/// One triangle, its corners counter-clockwise seen from outside.
#[derive(Clone, Debug)]
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
    alive: bool,
    /// The last flood that looked at it.
    flood: u32,
}

impl<T: Scalar> Triangle<T> {
    /// Not measured yet.
    fn new(corners: [u32; 3], beside: [u32; 3]) -> Self {
        Self {
            corners,
            beside,
            outward: [T::from(0.0); 3],
            level: T::from(0.0),
            direction: [T::from(0.0); 3],
            bound: T::from(0.0),
            alive: true,
            flood: 0,
        }
    }
}

/// A triangle in the queue; out of date where its bound has changed since.
struct Entry {
    bound: f64,
    triangle: u32,
}

impl Ord for Entry {
    /// The least bound is the greatest entry; among equals the lower number.
    fn cmp(&self, o: &Self) -> Ordering {
        o.bound.total_cmp(&self.bound).then(o.triangle.cmp(&self.triangle))
    }
}

impl PartialOrd for Entry {
    fn partial_cmp(&self, o: &Self) -> Option<Ordering> {
        Some(self.cmp(o))
    }
}

impl PartialEq for Entry {
    fn eq(&self, o: &Self) -> bool {
        self.cmp(o) == Ordering::Equal
    }
}

impl Eq for Entry {}

/// An edge of the border between what is replaced and what stays.
#[derive(Clone, Copy)]
struct Border {
    from: u32,
    to: u32,
    outer: u32,
}

/// What rounding asks of a flood.
pub(super) struct Filter<T> {
    /// Heights above this are certainly positive.
    pub(super) margin: T,
    /// A point this far above a plane is outside it.
    pub(super) noise: T,
}

/// The surface.
pub(super) struct Surface<T> {
    pub(super) points: Vec<Corner<T>>,
    pub(super) triangles: Vec<Triangle<T>>,
    queue: BinaryHeap<Entry>,
    floods: u32,
}

/// The unit vector along `v`; zero where there is none.
pub(super) fn unit<T: Scalar>(v: &Vec3<T>) -> Vec3<T> {
    let largest = v.iter().fold(0.0f64, |m, x| m.max(x.value().abs()));
    if !(largest > 0.0 && largest < f64::INFINITY) {
        return [T::from(0.0); 3];
    }
    let v = v.map(|x| x / T::from(largest));
    let norm = root(dot(&v, &v));
    v.map(|x| x / norm)
}

/// The least height of three points along a direction.
fn least<T: Scalar>(n: &Vec3<T>, w: &[Vec3<T>; 3]) -> T {
    let h = w.map(|w| dot(n, &w));
    let low = if h[1] < h[0] { h[1] } else { h[0] };
    if h[2] < low { h[2] } else { low }
}

/// The unit normal of a triangle, from its two shorter edges.
fn normal<T: Scalar>(w: &[Vec3<T>; 3]) -> Vec3<T> {
    let edges = [sub(&w[1], &w[0]), sub(&w[2], &w[1]), sub(&w[0], &w[2])];
    let length = edges.map(|e| dot(&e, &e).value());
    let longest = (1..3).fold(0, |k, i| if length[i] > length[k] { i } else { k });
    let (u, v) = (&edges[(longest + 1) % 3], &edges[(longest + 2) % 3]);
    let by_size = |e: &Vec3<T>| {
        let m = e.iter().fold(0.0f64, |m, x| m.max(x.value().abs()));
        if m > 0.0 { e.map(|x| x / T::from(m)) } else { *e }
    };
    unit(&cross(&by_size(u), &by_size(v)))
}

impl<T: Scalar> Surface<T> {
    /// The tetrahedron of four corners.
    pub(super) fn tetrahedron(corners: &[Corner<T>]) -> Option<Self> {
        let [p, q, r, s] = *<&[Corner<T>; 4]>::try_from(corners).ok()?;
        let (u, v, x) = (sub(&q.w, &p.w), sub(&r.w, &p.w), sub(&s.w, &p.w));
        let right = dot(&u, &cross(&v, &x)) > T::from(0.0);
        let points = if right { [p, q, r, s] } else { [q, p, r, s] };
        let mut surface = Self {
            points: points.to_vec(),
            triangles: Vec::new(),
            queue: BinaryHeap::new(),
            floods: 0,
        };
        // Across its edges, by the numbers of the faces in this list.
        let faces = [
            ([0, 2, 1], [2, 3, 1]),
            ([0, 1, 3], [0, 3, 2]),
            ([0, 3, 2], [1, 3, 0]),
            ([1, 2, 3], [0, 2, 1]),
        ];
        for (corners, beside) in faces {
            surface.push(corners, beside);
        }
        Some(surface)
    }

    /// A surface that was kept, its points placed again; with `queued`, ready to grow.
    pub(super) fn named(points: Vec<Corner<T>>, triangles: &[[u32; 6]], queued: bool) -> Self {
        let mut surface = Self {
            points,
            triangles: Vec::with_capacity(triangles.len()),
            queue: BinaryHeap::new(),
            floods: 0,
        };
        for &[p, q, r, x, y, z] in triangles {
            if queued {
                surface.push([p, q, r], [x, y, z]);
            } else {
                surface.triangles.push(Triangle::new([p, q, r], [x, y, z]));
            }
        }
        surface
    }

    /// The names of the points in use, and the triangles that are part of the surface, numbered anew.
    pub(super) fn names(&self, points: &mut Vec<[u32; 2]>, triangles: &mut Vec<[u32; 6]>) {
        let mut number = alloc::vec![u32::MAX; self.triangles.len()];
        for (k, t) in self.alive().enumerate() {
            number[t as usize] = k as u32;
        }
        let mut place = alloc::vec![u32::MAX; self.points.len()];
        for t in self.alive().map(|t| &self.triangles[t as usize]) {
            for &c in &t.corners {
                if place[c as usize] == u32::MAX {
                    place[c as usize] = points.len() as u32;
                    points.push([self.points[c as usize].a, self.points[c as usize].b]);
                }
            }
            let ([p, q, r], [x, y, z]) = (
                t.corners.map(|c| place[c as usize]),
                t.beside.map(|n| number[n as usize]),
            );
            triangles.push([p, q, r, x, y, z]);
        }
    }

    /// Where the corners of a triangle are.
    fn places(&self, corners: &[u32; 3]) -> [Vec3<T>; 3] {
        corners.map(|c| self.points[c as usize].w)
    }

    /// The corners of a triangle.
    pub(super) fn corners(&self, triangle: u32) -> [Corner<T>; 3] {
        self.triangles[triangle as usize]
            .corners
            .map(|c| self.points[c as usize])
    }

    /// The triangles that are part of the surface.
    pub(super) fn alive(&self) -> impl Iterator<Item = u32> + '_ {
        let all = self.triangles.iter().enumerate();
        all.filter(|(_, t)| t.alive).map(|(k, _)| k as u32)
    }

    fn push(&mut self, corners: [u32; 3], beside: [u32; 3]) {
        let mut triangle = Triangle::new(corners, beside);
        self.measure(&mut triangle);
        self.queue.push(Entry {
            bound: triangle.bound.value(),
            triangle: self.triangles.len() as u32,
        });
        self.triangles.push(triangle);
    }

    /// Normal and bound. The best bound there is comes from the direction of the nearest point; where rounding spoils
    /// it, the normal may do better.
    fn measure(&self, t: &mut Triangle<T>) {
        let w = self.places(&t.corners);
        t.outward = normal(&w);
        t.level = least(&t.outward, &w);
        (t.direction, t.bound) = (t.outward, t.level);
        let nearest = Simplex::triangle(t.corners.map(|c| self.points[c as usize]));
        if nearest.len() < 3 || !(t.bound > T::from(0.0)) {
            let direction = unit(&nearest.direction());
            let bound = least(&direction, &w);
            if bound > t.bound {
                (t.direction, t.bound) = (direction, bound);
            }
        }
    }

    /// Takes every point and triangle anew, the points placed by `place`.
    pub(super) fn place(&mut self, place: impl Fn(&Corner<T>) -> Corner<T>) {
        for p in &mut self.points {
            *p = place(p);
        }
        self.queue.clear();
        for k in 0..self.triangles.len() {
            if self.triangles[k].alive {
                let mut t = self.triangles[k].clone();
                self.measure(&mut t);
                self.queue.push(Entry {
                    bound: t.bound.value(),
                    triangle: k as u32,
                });
                self.triangles[k] = t;
            }
        }
    }

    /// How high the lowest corner of a triangle is along a direction.
    pub(super) fn height(&self, triangle: u32, n: &Vec3<T>) -> T {
        least(n, &self.places(&self.triangles[triangle as usize].corners))
    }

    /// The triangle of the least bound.
    pub(super) fn weakest(&mut self) -> Option<u32> {
        loop {
            let top = self.queue.peek()?;
            let t = &self.triangles[top.triangle as usize];
            if t.alive && t.bound.value() == top.bound {
                return Some(top.triangle);
            }
            self.queue.pop();
        }
    }

    /// Tries another direction for the bound of a triangle; whether it is better.
    pub(super) fn raise(&mut self, triangle: u32, direction: &Vec3<T>) -> bool {
        let t = &self.triangles[triangle as usize];
        let bound = least(direction, &self.places(&t.corners));
        let better = bound > t.bound;
        if better {
            let t = &mut self.triangles[triangle as usize];
            (t.direction, t.bound) = (*direction, bound);
            self.queue.push(Entry {
                bound: bound.value(),
                triangle,
            });
        }
        better
    }

    /// Takes in a point that lies higher than `triangle` along its direction, and replaces the triangles that see it.
    pub(super) fn insert(&mut self, triangle: u32, c: Corner<T>, filter: &Filter<T>) {
        let visible = self.flood(triangle, &c.w, filter);
        let (visible, border) = match self.border(&visible) {
            Some(border) => (visible, border),
            // Three edges are a loop whatever is around them.
            None => (alloc::vec![triangle], self.rim(triangle)),
        };
        for &t in &visible {
            self.triangles[t as usize].alive = false;
        }
        let apex = self.points.len() as u32;
        self.points.push(c);
        let (first, count) = (self.triangles.len() as u32, border.len() as u32);
        for (k, edge) in (0..count).zip(&border) {
            let beside = [edge.outer, first + (k + 1) % count, first + (k + count - 1) % count];
            self.push([edge.from, edge.to, apex], beside);
            let outer = &mut self.triangles[edge.outer as usize];
            for i in 0..3 {
                if (outer.corners[i], outer.corners[(i + 1) % 3]) == (edge.to, edge.from) {
                    outer.beside[i] = first + k;
                }
            }
        }
    }

    /// The triangles around `from` that see `w` and may be replaced.
    fn flood(&mut self, from: u32, w: &Vec3<T>, filter: &Filter<T>) -> Vec<u32> {
        self.floods += 1;
        let mut seen = alloc::vec![from];
        self.triangles[from as usize].flood = self.floods;
        let mut done = 0;
        while done < seen.len() {
            for k in self.triangles[seen[done] as usize].beside {
                if self.triangles[k as usize].flood == self.floods || !self.sees(k, w, filter) {
                    continue;
                }
                self.triangles[k as usize].flood = self.floods;
                seen.push(k);
            }
            done += 1;
        }
        seen
    }

    /// Whether `w` is outside the plane of a triangle, and some plane certainly has the origin beneath and both above.
    pub(super) fn sees(&self, triangle: u32, w: &Vec3<T>, filter: &Filter<T>) -> bool {
        let t = &self.triangles[triangle as usize];
        let p = &self.points[t.corners[0] as usize].w;
        let above = t.bound > filter.margin && dot(&t.direction, w) > filter.margin;
        if t.outward.iter().all(|x| x.value() == 0.0) {
            return above && dot(&t.direction, w) > t.bound + filter.noise;
        }
        // Outside its plane, the point is as high along the normal as the corners.
        dot(&t.outward, &sub(w, p)) > filter.noise && (above || t.level > filter.margin)
    }

    fn rim(&self, triangle: u32) -> Vec<Border> {
        let t = &self.triangles[triangle as usize];
        let edge = |k: usize| Border {
            from: t.corners[k],
            to: t.corners[(k + 1) % 3],
            outer: t.beside[k],
        };
        (0..3).map(edge).collect()
    }

    /// The border of some triangles, if it is one loop without a corner twice.
    fn border(&self, visible: &[u32]) -> Option<Vec<Border>> {
        let flood = self.floods;
        let mut edges: Vec<Border> = visible
            .iter()
            .flat_map(|&t| self.rim(t))
            .filter(|e| self.triangles[e.outer as usize].flood != flood)
            .collect();
        for k in 1..edges.len() {
            let next = (k..edges.len()).find(|&i| edges[i].from == edges[k - 1].to)?;
            edges.swap(k, next);
        }
        let mut starts: Vec<u32> = edges.iter().map(|e| e.from).collect();
        starts.sort_unstable();
        let simple = starts.windows(2).all(|s| s[0] != s[1]);
        let closed = edges.last().is_some_and(|e| e.to == edges[0].from);
        (simple && closed && edges.len() > 2).then_some(edges)
    }

    /// The point of a triangle nearest to `target`, and how near it is.
    pub(super) fn nearest(&self, triangle: u32, target: &Vec3<T>) -> (Simplex<T>, T) {
        let shifted = self.corners(triangle).map(|c| Corner {
            w: sub(&c.w, target),
            ..c
        });
        let simplex = Simplex::triangle(shifted);
        let off = simplex.reach();
        (simplex, off)
    }
}

/// `n h`.
pub(super) fn at<T: Scalar>(n: &Vec3<T>, h: T) -> Vec3<T> {
    scaled(n, h)
}

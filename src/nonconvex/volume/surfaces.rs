//! Two closed surfaces in one frame, the stored frame of A, and their triangles near each other.
//!
//! Vertices of B are placed there when they are first used, each rounded once. From then on the
//! rounded surface is exact. The sum of a volume adds the area of the surface near the other body
//! times the largest rounding.

use alloc::borrow::Cow;
use alloc::vec;
use alloc::vec::Vec;

use nalgebra::Vector3;

use crate::base::num::double_double::{DoubleDouble, Expansion};
use crate::base::num::each::Each;
use crate::base::num::extremes::{Extremes, largest};
use crate::base::num::scalar::sqrt;
use crate::base::pose::{Operand, RelativePose};
use crate::base::tolerance::{FLUSH_EXPONENT, PLACED_VERTEX, UNIT};
use crate::body::polyhedron::{bounding_box, exponent_of, power_of_two};
use crate::nonconvex::front::NodePair;
use crate::nonconvex::mesh::Mesh;
use crate::nonconvex::query::state::PosedTrees;
use crate::nonconvex::query::triangle::Triangle;
use crate::nonconvex::tree::Below;
use crate::nonconvex::volume::ties;
use crate::pair::transform::{StoredFrame, Transform, shift_alike};

/// A box along the axes of the frame of A.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) low: Vector3<f64>,
    pub(super) high: Vector3<f64>,
}

impl Bounds {
    fn of(points: &Triangle) -> Self {
        let (low, high) = bounding_box(points);
        Self { low, high }
    }

    fn grown(&self, by: f64) -> Self {
        Self {
            low: self.low.add_scalar(-by),
            high: self.high.add_scalar(by),
        }
    }

    /// Returns the common part; a side is negative if there is none.
    pub(super) fn common(&self, o: &Self) -> Self {
        Self {
            low: Vector3::from_fn(|k, _| self.low[k].larger(o.low[k])),
            high: Vector3::from_fn(|k, _| self.high[k].smaller(o.high[k])),
        }
    }

    #[inline]
    pub(super) fn meets(&self, o: &Self) -> bool {
        (0..3).all(|k| self.low[k] <= o.high[k] && o.low[k] <= self.high[k])
    }

    pub(super) fn contains(&self, p: &Vector3<f64>) -> bool {
        (0..3).all(|k| self.low[k] <= p[k] && p[k] <= self.high[k])
    }

    /// Returns the largest magnitude of a coordinate.
    fn reach(&self) -> f64 {
        self.low.amax().larger(self.high.amax())
    }
}

/// The map of B's stored vertices to the stored frame of A.
enum Placement {
    /// Both bodies are rotated alike: the shift in the caller's unit, and its error.
    Shifted {
        shift: [DoubleDouble; 3],
        doubt: f64,
        frames: [StoredFrame; 2],
    },
    /// The map, and its error for a vertex at the stored origin and per stored length of B.
    Turned(Transform<DoubleDouble>, [f64; 2]),
}

impl Placement {
    /// Returns the map of a pair; `None` if the bodies are out of range of each other.
    fn new(a: &StoredFrame, b: &StoredFrame, pose: &RelativePose) -> Option<Self> {
        let per_unit = power_of_two(-a.exponent);
        if let Some((shift, is_exact)) = shift_alike(pose) {
            let length = shift.iter().fold(0.0, |sum, x| sum + x.hi.abs());
            return Some(Self::Shifted {
                shift,
                doubt: if is_exact {
                    0.0
                } else {
                    PLACED_VERTEX * length * per_unit
                },
                frames: [*a, *b],
            });
        }
        let (x, y) = (pose.a.t(), pose.b.t());
        let apart = (0..3).fold(0.0, |sum, k| sum + (y[k] - x[k]).abs());
        let lengths = apart + a.origin.abs().sum() + b.origin.abs().sum();
        let scale = power_of_two(b.exponent - a.exponent);
        let map = Transform::<DoubleDouble>::between(a, b, pose)?;
        Some(Self::Turned(
            map,
            [lengths * per_unit, scale].each(|x| PLACED_VERTEX * x),
        ))
    }

    /// Returns the rounded position of a vertex, and how far it is from the true one at most.
    fn place(&self, p: &Vector3<f64>) -> (Vector3<f64>, f64) {
        match self {
            Self::Shifted { shift, doubt, frames } => {
                let (mut place, mut error) = (Vector3::zeros(), *doubt);
                let [unit, per_unit] = [frames[1].exponent, -frames[0].exponent].each(power_of_two);
                for k in 0..3 {
                    let mut sum = Expansion::<8>::new();
                    let terms = [
                        p[k] * unit,
                        frames[1].origin[k],
                        -frames[0].origin[k],
                        shift[k].hi,
                        shift[k].lo,
                    ];
                    terms.into_iter().for_each(|x| sum.add(x));
                    let [near, rest] = sum.leading::<2>();
                    place[k] = near * per_unit;
                    error += rest.abs() * per_unit * (1.0 + 4.0 * UNIT);
                }
                (place, error)
            }
            Self::Turned(map, [least, per_length]) => {
                let at = map.point(p);
                let rest = at.iter().fold(0.0, |sum, x| sum + x.lo.abs());
                let error = rest + least + per_length * p.abs().sum();
                (Vector3::from(at.each(|x| x.hi)), error * (1.0 + 8.0 * UNIT))
            }
        }
    }
}

/// A closed surface, with what is known of its triangles.
pub(super) struct Surface<'a> {
    pub(super) mesh: &'a Mesh,
    points: Cow<'a, [Vector3<f64>]>,
    /// Whether each vertex has its place; empty if all have.
    is_placed: Vec<bool>,
    /// The sign of the first component of each normal that is not zero; `UNKNOWN` at first.
    first: Vec<i8>,
    /// A box that contains the surface.
    pub(super) bounds: Bounds,
    /// The triangles that may meet the box of the other surface, in rising order.
    pub(super) near: Vec<u32>,
    boxes: Vec<Bounds>,
    /// One more than the index of each near triangle in `near`, and 0 for the others.
    slots: Vec<u32>,
    /// How far a vertex is from its true place at most.
    pub(super) off: f64,
}

/// The mark of a sign that is not computed yet.
const UNKNOWN: i8 = 2;

impl Surface<'_> {
    #[inline]
    pub(super) fn vertices(&self, t: u32) -> [u32; 3] {
        self.mesh.triangles[t as usize]
    }

    /// Returns a vertex, which must have its place.
    #[inline]
    pub(super) fn point(&self, v: u32) -> &Vector3<f64> {
        &self.points[v as usize]
    }

    /// Returns the corners of a triangle, which must have their places.
    #[inline]
    pub(super) fn corners(&self, t: u32) -> Triangle {
        self.vertices(t).each(|v| *self.point(v))
    }

    /// Returns the index of a near triangle in `near`; out of range for all others.
    #[inline]
    fn slot(&self, t: u32) -> usize {
        (self.slots[t as usize] as usize).wrapping_sub(1)
    }

    /// Returns whether all corners of a triangle have their places.
    #[inline]
    fn is_ready(&self, t: u32) -> bool {
        self.is_placed.is_empty() || self.vertices(t).iter().all(|v| self.is_placed[*v as usize])
    }

    /// Returns the sign of the first component of a triangle's normal that is not zero.
    #[inline]
    pub(super) fn first_of_normal(&mut self, t: u32) -> i32 {
        if self.first[t as usize] == UNKNOWN {
            self.first[t as usize] = ties::first_of_normal(&self.corners(t)) as i8;
        }
        i32::from(self.first[t as usize])
    }

    /// Returns an upper bound of the area of the near triangles in a box.
    fn area_in(&self, bounds: &Bounds) -> f64 {
        let area = |t: &u32| {
            let corners = self.corners(*t);
            let [u, v] = [1, 2].each(|k: usize| corners[k] - corners[0]);
            let (long, wide) = (sqrt(u.norm_squared()), sqrt(v.norm_squared()));
            // Added are the rounding of the area, and what a move of the corners adds to it.
            let more = 8.0 * UNIT * long * wide + 2.0 * self.off * (long + wide + 2.0 * self.off);
            let whole = 0.5 * sqrt(u.cross(&v).norm_squared()) + more;
            let inside = bounds.common(&Bounds::of(&corners).grown(self.off));
            let side = (inside.high - inside.low).map(|x| x.larger(0.0));
            // A plane part is no larger than the sum of its projections.
            whole.smaller(side.x * side.y + side.y * side.z + side.z * side.x)
        };
        let rounded = 1.0 + 16.0 * UNIT * (1.0 + self.near.len() as f64);
        self.near.iter().map(area).sum::<f64>() * rounded
    }
}

/// Two surfaces in the stored frame of A.
pub(super) struct Surfaces<'a> {
    pub(super) of: [Surface<'a>; 2],
    posed: PosedTrees<'a, Mesh, Mesh>,
    placement: Placement,
    /// Coordinates of placed vertices below this are zero, so that predicates stay in range.
    flush: f64,
    /// Where the surfaces may meet.
    pub(super) common: Bounds,
}

impl<'a> Surfaces<'a> {
    /// Returns the surfaces of two bodies; `None` if they are out of range of each other.
    pub(super) fn new(a: &'a Mesh, b: &'a Mesh, pose: &'a RelativePose) -> Option<Self> {
        let posed = PosedTrees::new(a, b, pose)?;
        let placement = Placement::new(&a.frame, &b.frame, pose)?;
        let frame = &posed.frame;
        let of_a = Bounds {
            low: a.low,
            high: a.high,
        };
        let (middle, half) = (b.low * 0.5 + b.high * 0.5, (b.high - b.low) * 0.5);
        let (middle, half) = (frame.point(&middle), frame.matrix.abs() * half);
        let of_b = Bounds {
            low: middle - half,
            high: middle + half,
        };
        let of_b = of_b.grown(2.0 * frame.error);
        let surface = |mesh: &'a Mesh, points, bounds, placed: bool| Surface {
            mesh,
            points,
            is_placed: if placed {
                Vec::new()
            } else {
                vec![false; mesh.points.len()]
            },
            first: vec![UNKNOWN; mesh.triangles.len()],
            bounds,
            near: Vec::new(),
            boxes: Vec::new(),
            slots: vec![0; mesh.triangles.len()],
            off: mesh.off,
        };
        let flush = power_of_two(exponent_of(frame.size) - FLUSH_EXPONENT);
        let of = [
            surface(a, Cow::Borrowed(&a.points[..]), of_a, true),
            surface(b, Cow::Owned(vec![Vector3::zeros(); b.points.len()]), of_b, false),
        ];
        let mut surfaces = Self {
            common: of_a.common(&of_b),
            of,
            posed,
            placement,
            flush,
        };
        surfaces.of[1].off *= surfaces.posed.frame.scale;
        surfaces.find_near();
        Some(surfaces)
    }

    /// Returns whether the surfaces may share a point, or one contain the other.
    pub(super) fn may_meet(&self) -> bool {
        let doubt = 2.0 * self.posed.frame.error;
        self.of[0].bounds.grown(doubt).meets(&self.of[1].bounds)
    }

    /// Finds the triangles near the box of the other surface, and places their vertices.
    fn find_near(&mut self) {
        if !self.may_meet() {
            return;
        }
        let doubt = 2.0 * self.posed.frame.error;
        for k in 0..2 {
            let other = self.of[1 - k].bounds.grown(doubt);
            let (tree, mut stack) = (&self.of[k].mesh.tree, vec![0]);
            let mut near = Vec::new();
            while let Some(node) = stack.pop() {
                if !self.box_of(k, node).grown(doubt).meets(&other) {
                    continue;
                }
                match tree.below(node) {
                    Below::Children(c) => stack.extend([c + 1, c]),
                    Below::Leaf(first, count) => near.extend(first..first + count),
                }
            }
            for (slot, &t) in (1..).zip(&near) {
                self.ready(k, t);
                let bounds = Bounds::of(&self.of[k].corners(t));
                self.of[k].boxes.push(bounds);
                self.of[k].slots[t as usize] = slot;
            }
            self.of[k].near = near;
        }
    }

    /// Returns the box of a node, up to rounding.
    fn box_of(&self, k: usize, node: u32) -> Bounds {
        let tree = &self.of[k].mesh.tree;
        let b = &tree.boxes[node as usize];
        let (unit, half) = (tree.unit(), b.half());
        let middle = tree.centre + b.centre() * unit;
        let mut reach = Vector3::zeros();
        let frame = &self.posed.frame;
        for i in 0..3 {
            let side = b.axis(i) * (half[i] * unit);
            let side = if k == 0 { side } else { frame.matrix * side };
            reach += side.abs();
        }
        let middle = if k == 0 { middle } else { frame.point(&middle) };
        Bounds {
            low: middle - reach,
            high: middle + reach,
        }
    }

    /// Places the vertices of a triangle.
    pub(super) fn ready(&mut self, k: usize, t: u32) {
        let surface = &mut self.of[k];
        if surface.is_ready(t) {
            return;
        }
        for v in surface.vertices(t).each(|v| v as usize) {
            if surface.is_placed[v] {
                continue;
            }
            let (place, mut error) = self.placement.place(&surface.mesh.points[v]);
            surface.points.to_mut()[v] = place.map(|x| {
                let is_small = x.abs() < self.flush;
                error += if is_small { x.abs() } else { 0.0 };
                if is_small { 0.0 } else { x }
            });
            surface.is_placed[v] = true;
            let off = surface.mesh.off * self.posed.frame.scale;
            surface.off = surface.off.larger((error + off) * (1.0 + 8.0 * UNIT));
        }
    }

    /// Calls a function with all pairs of triangles whose boxes meet.
    pub(super) fn each_pair(&self, mut visit: impl FnMut(NodePair)) {
        let [a, b] = &self.of;
        self.posed.meet(2.0 * self.posed.frame.error, usize::MAX, |[i, j]| {
            if let (Some(x), Some(y)) = (a.boxes.get(a.slot(i)), b.boxes.get(b.slot(j)))
                && x.meets(y)
            {
                visit([i, j]);
            }
            false
        });
    }

    /// Returns the winding number of a surface about a vertex of the other one.
    ///
    /// `of` is the body of the surface that counts.
    pub(super) fn winding(&mut self, of: Operand, vertex: u32) -> i32 {
        let (k, other) = (of as usize, 1 - of as usize);
        let (from, bounds) = (*self.of[other].point(vertex), self.of[k].bounds);
        if !bounds.contains(&from) {
            return 0;
        }
        // Beyond the nearest side of the box, whatever rounding does.
        let beyond = self.of[0].bounds.reach().larger(self.of[1].bounds.reach());
        let (up, down) = (bounds.high - from, from - bounds.low);
        let (x, y) = (up.imin(), down.imin());
        let mut to = from;
        if up[x] < down[y] {
            to[x] = bounds.high[x] + beyond;
        } else {
            to[y] = bounds.low[y] - beyond;
        }
        let frame = &self.posed.frame;
        let (mut stored, mut error) = ([from, to], 0.0);
        if k == 1 {
            stored = stored.each(|p| self.posed.back(&p));
            // The far end may be up to three sizes away.
            error = 8.0 * frame.error / frame.scale;
        }
        let mut found = Vec::new();
        self.of[k].mesh.along(&stored[0], &stored[1], error, |t| {
            found.push(t);
            1.0
        });
        let mut winding = 0;
        for t in found {
            self.ready(k, t);
            winding += self.passes(of, t, [&from, &to]);
        }
        winding
    }

    /// Returns 1 if a segment of the other body leaves through a triangle, -1 if it enters, else 0.
    fn passes(&mut self, of: Operand, t: u32, [p, q]: [&Vector3<f64>; 2]) -> i32 {
        let corners = self.of[of as usize].corners(t);
        let mut side = |p| ties::side(p, &corners, of, || self.of[of as usize].first_of_normal(t));
        let (start, end) = (side(p), side(q));
        if start * end >= 0 {
            return 0;
        }
        let sense = |k: usize| {
            let edge = [&corners[k], &corners[(k + 1) % 3]];
            match of {
                Operand::B => ties::sense([p, q], edge),
                Operand::A => ties::sense(edge, [p, q]),
            }
        };
        let first = sense(0);
        if sense(1) == first && sense(2) == first { end } else { 0 }
    }

    /// Returns the largest extent of the common box.
    pub(super) fn size(&self) -> f64 {
        largest(&(self.common.high - self.common.low)).larger(0.0)
    }

    /// Returns a bound of the volume that the rounding of vertices changes, per winding number.
    pub(super) fn rounding(&self) -> f64 {
        let area = |k: usize| {
            let surface = &self.of[k];
            if surface.off > 0.0 {
                surface.off * surface.area_in(&self.common.grown(self.grown()))
            } else {
                0.0
            }
        };
        (area(0) + area(1)) * (1.0 + 8.0 * UNIT)
    }

    /// Returns by how much the common box grows by rounding at most.
    pub(super) fn grown(&self) -> f64 {
        4.0 * self.posed.frame.error
    }
}

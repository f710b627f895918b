//! Exact positions of points and rays in the frame of a mesh, over the rationals.

use crate::rational::{IntVec, RBig, common, cross, dot, exact, rotation, sub};
use crate::rng::Rng;
use crate::soups::Soup;
use crate::{Point, Pose};
use dashu_int::IBig;
use lin_canny::ContactState;

/// A point or a direction over the rationals.
pub type Exact3 = [RBig; 3];

/// Location of a point relative to a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Outside the body.
    Outside,
    /// On its surface.
    On,
    /// Inside.
    Inside,
}

impl Place {
    /// Returns the contact state of the point and the body.
    pub const fn state(self) -> ContactState {
        match self {
            Self::Outside => ContactState::Separated,
            Self::On => ContactState::Touching,
            Self::Inside => ContactState::Overlapping,
        }
    }
}

fn turned(m: &[Exact3; 3], v: &Exact3) -> Exact3 {
    std::array::from_fn(|i| &m[i][0] * &v[0] + &m[i][1] * &v[1] + &m[i][2] * &v[2])
}

fn turned_back(m: &[Exact3; 3], v: &Exact3) -> Exact3 {
    std::array::from_fn(|i| &m[0][i] * &v[0] + &m[1][i] * &v[1] + &m[2][i] * &v[2])
}

/// Returns a point of the second body in the frame of the first.
pub fn point_at(p: Point, [a, b]: &[Pose; 2]) -> Exact3 {
    let there = turned(&rotation(b.q), &p.map(exact));
    let from_a = std::array::from_fn(|k| &there[k] + exact(b.t[k]) - exact(a.t[k]));
    turned_back(&rotation(a.q), &from_a)
}

/// Returns a line of the world in the frame of a body: its origin and its direction.
pub fn line_at(origin: Point, way: Point, at: &Pose) -> (Exact3, Exact3) {
    let back = rotation(at.q);
    let from = std::array::from_fn(|k| exact(origin[k]) - exact(at.t[k]));
    (turned_back(&back, &from), turned_back(&back, &way.map(exact)))
}

/// A closed mesh over the rationals.
#[derive(Debug)]
pub struct ExactMesh {
    points: Vec<Exact3>,
    triangles: Vec<[usize; 3]>,
}

fn sign(x: &IBig) -> i32 {
    i32::from(*x > IBig::ZERO) - i32::from(*x < IBig::ZERO)
}

fn volume(a: &IntVec, b: &IntVec, c: &IntVec, d: &IntVec) -> i32 {
    sign(&dot(&cross(&sub(b, a), &sub(c, a)), &sub(d, a)))
}

impl ExactMesh {
    /// Returns the mesh of a soup.
    pub fn new(soup: &Soup) -> Self {
        Self {
            points: soup.points.iter().map(|p| p.map(exact)).collect(),
            triangles: soup.triangles.iter().map(|t| t.map(|v| v as usize)).collect(),
        }
    }

    /// Returns the location of a point.
    pub fn place(&self, p: &Exact3, rng: &mut Rng) -> Place {
        let (points, own, _) = common(&self.points, std::slice::from_ref(p));
        let p = &own[0];
        for t in &self.triangles {
            let [a, b, c] = t.map(|v| &points[v]);
            let n = cross(&sub(b, a), &sub(c, a));
            let turns = [(a, b), (b, c), (c, a)].map(|(x, y)| sign(&dot(&cross(&sub(y, x), &sub(p, x)), &n)));
            if volume(a, b, c, p) == 0 && turns.iter().all(|t| *t >= 0) {
                return Place::On;
            }
        }
        loop {
            let to = std::array::from_fn(|k| &p[k] + IBig::from(rng.int(-1_000_000, 1_000_000)));
            if let Some(winding) = self.winding(&points, p, &to) {
                return if winding == 0 { Place::Outside } else { Place::Inside };
            }
        }
    }

    /// Returns the sum of signed crossings of the ray from `p` through `to`; `None` if it meets an
    /// edge.
    fn winding(&self, points: &[IntVec], p: &IntVec, to: &IntVec) -> Option<i32> {
        let mut sum = 0;
        for t in &self.triangles {
            let [a, b, c] = t.map(|v| &points[v]);
            let height = volume(a, b, c, p);
            // In the plane of a triangle that does not contain the point, the ray leaves the plane
            // at once.
            if height == 0 {
                continue;
            }
            let turns = [volume(p, to, a, b), volume(p, to, b, c), volume(p, to, c, a)];
            if turns.contains(&0) {
                return None;
            }
            // The crossing is ahead if the point is below the triangle through which the ray
            // leaves.
            if turns[1] == turns[0] && turns[2] == turns[0] && height == -turns[0] {
                sum += turns[0];
            }
        }
        Some(sum)
    }

    /// Returns whether a segment, or the hull of four points, meets the surface, if none of the
    /// points is on it.
    ///
    /// `None` if an edge of one lies in a plane of the other.
    pub fn meets(&self, body: &[Exact3]) -> Option<bool> {
        let (points, body, _) = common(&self.points, body);
        let mut is_met = false;
        let mut through = |p: &IntVec, q: &IntVec, [a, b, c]: [&IntVec; 3]| {
            let ends = [volume(a, b, c, p), volume(a, b, c, q)];
            if ends == [0; 2] {
                return None;
            }
            let turns = [volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)];
            let is_mixed = turns.contains(&1) && turns.contains(&-1);
            is_met |= ends[0] * ends[1] <= 0 && !is_mixed;
            Some(())
        };
        for (i, p) in body.iter().enumerate() {
            for q in &body[..i] {
                for t in &self.triangles {
                    through(p, q, t.map(|v| &points[v]))?;
                }
            }
        }
        if let [a, b, c, d] = &body[..] {
            for t in &self.triangles {
                for k in 0..3 {
                    for face in [[a, b, c], [a, b, d], [a, c, d], [b, c, d]] {
                        through(&points[t[k]], &points[t[(k + 1) % 3]], face)?;
                    }
                }
            }
        }
        Some(is_met)
    }

    /// Returns the first point of the surface along a ray, in lengths of the direction, and whether
    /// it is on an edge.
    pub fn first(&self, (origin, way): &(Exact3, Exact3)) -> Option<(RBig, bool)> {
        let aim: Exact3 = std::array::from_fn(|k| &origin[k] + &way[k]);
        let (points, own, _) = common(&self.points, &[origin.clone(), aim]);
        let (o, to) = (&own[0], &own[1]);
        let d = sub(to, o);
        let mut first: Option<(RBig, bool)> = None;
        let mut offer = |num: IBig, den: IBig, is_edge: bool| {
            let s = RBig::from(num) / RBig::from(den);
            if s >= RBig::ZERO && first.as_ref().is_none_or(|f| s < f.0 || s == f.0 && is_edge) {
                first = Some((s, is_edge));
            }
        };
        for p in &points {
            let from = sub(p, o);
            if cross(&from, &d).iter().all(|x| x.is_zero()) {
                offer(dot(&from, &d), dot(&d, &d), true);
            }
        }
        for t in &self.triangles {
            let [a, b, c] = t.map(|v| &points[v]);
            for (p, q) in [(a, b), (b, c), (c, a)] {
                let edge = sub(q, p);
                let n = cross(&edge, &d);
                let size = dot(&n, &n);
                let from = sub(p, o);
                // Coplanar and not parallel: the point where the lines cross.
                if size.is_zero() || !dot(&n, &from).is_zero() {
                    continue;
                }
                // o + s d = p + r edge.
                let share = dot(&cross(&d, &from), &n);
                if share >= IBig::ZERO && share <= size {
                    offer(-dot(&cross(&from, &edge), &n), size, true);
                }
            }
            let turns = [volume(o, to, a, b), volume(o, to, b, c), volume(o, to, c, a)];
            if turns[0] != 0 && turns[1] == turns[0] && turns[2] == turns[0] {
                let n = cross(&sub(b, a), &sub(c, a));
                offer(dot(&n, &sub(a, o)), dot(&n, &d), false);
            }
        }
        first
    }
}

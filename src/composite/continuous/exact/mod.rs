//! The first contact in exact arithmetic: whether four vertices on straight paths meet, and when,
//! as an isolated root of a polynomial.
//!
//! At an instant of contact the four vertices lie in one plane. Unless they do so all the time,
//! that leaves at most three instants, the roots of a cubic; at each the signs of further
//! polynomials tell whether the vertex is in the face or the edges cross. If the vertices never
//! leave one plane, the first contact is at time zero, or where one of those polynomials changes
//! its sign.

mod polynomial;

use alloc::vec;
use alloc::vec::Vec;

use super::paths::Path;
use super::search::{FirstContact, LEAST_WIDTH, WideWork};
use crate::base::num::extremes::{Bounded, Extremes};
use crate::body::polyhedron::lowest_bit;
use crate::composite::meet::triangle::Triangle;
use crate::convex::exact::integer::{self, Big3, integer, sign};
use polynomial::{Polynomial, Root};

/// A vector whose coordinates are polynomials in time.
type Vector = [Polynomial; 3];

/// A vertex and a segment, a vertex and a face, or two segments: the vertices as they move.
#[derive(Clone)]
enum ExactPair<'a> {
    Segment([&'a Vector; 3]),
    Face([&'a Vector; 4]),
    Edges([&'a Vector; 4]),
}

/// Returns the first contact of a vertex and a face, in a bracket at most about `width` wide;
/// open only if a limit is reached.
pub(super) fn vertex_face(vertex: &Path, face: &[Path; 3], width: f64, work: &mut WideWork) -> FirstContact {
    let [p, a, b, c] = moving([vertex, &face[0], &face[1], &face[2]]);
    ExactPair::Face([&p, &a, &b, &c]).found(width, work)
}

/// Returns the first contact of two edges, in a bracket at most about `width` wide; open only
/// if a limit is reached.
pub(super) fn edge_edge(a: &[Path; 2], b: &[Path; 2], width: f64, work: &mut WideWork) -> FirstContact {
    let [a, b, c, d] = moving([&a[0], &a[1], &b[0], &b[1]]);
    ExactPair::Edges([&a, &b, &c, &d]).found(width, work)
}

/// Returns whether an edge of one triangle passes through the inside of the other.
pub(super) fn pierce(p: &Triangle, q: &Triangle) -> bool {
    let numbers = p.iter().chain(q).flat_map(|v| v.iter().copied());
    let lowest = lowest_bit(numbers).unwrap_or(0);
    let whole = |t: &Triangle| t.map(|v| [v.x, v.y, v.z].map(|x| integer(x, lowest)));
    let (p, q) = (whole(p), whole(q));
    let volume = |a: &Big3, b: &Big3, c: &Big3, d: &Big3| {
        let [u, v, w] = [b, c, d].map(|x| integer::sub(x, a));
        sign(&integer::dot(&integer::cross(&u, &v), &w))
    };
    let through = |x: &[Big3; 3], y: &[Big3; 3]| {
        (0..3).any(|i| {
            let (from, to) = (&x[i], &x[(i + 1) % 3]);
            if volume(&y[0], &y[1], &y[2], from) * volume(&y[0], &y[1], &y[2], to) >= 0 {
                return false;
            }
            let turns = [0, 1, 2].map(|j| volume(from, to, &y[j], &y[(j + 1) % 3]));
            turns[0] != 0 && turns[1] == turns[0] && turns[2] == turns[0]
        })
    };
    through(&p, &q) || through(&q, &p)
}

/// Returns the paths over the integers, by a common power of two.
fn moving(paths: [&Path; 4]) -> [Vector; 4] {
    let ends = |p: &Path| [p.begin, p.end];
    let numbers = paths.iter().flat_map(|p| ends(p)).flat_map(|v| [v.x, v.y, v.z]);
    let lowest = lowest_bit(numbers).unwrap_or(0);
    paths.map(|p| {
        [0, 1, 2].map(|k| {
            let [begin, end] = ends(p).map(|v| integer(v[k], lowest));
            let move_of = &end - &begin;
            Polynomial::new(vec![begin, move_of])
        })
    })
}

fn sub(a: &Vector, b: &Vector) -> Vector {
    [0, 1, 2].map(|k| a[k].sub(&b[k]))
}

fn dot(a: &Vector, b: &Vector) -> Polynomial {
    a[0].times(&b[0]).add(&a[1].times(&b[1])).add(&a[2].times(&b[2]))
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| a[i].times(&b[j]).sub(&a[j].times(&b[i])))
}

fn is_zero(a: &Vector) -> bool {
    a.iter().all(Polynomial::is_zero)
}

impl<'a> ExactPair<'a> {
    fn found(&self, width: f64, work: &mut WideWork) -> FirstContact {
        self.first_contact(width.at_least(LEAST_WIDTH), work)
            .unwrap_or(FirstContact::Open { safe: 0.0 })
    }

    /// Returns the first contact; `None` if halving has not found a root or a sign, or the budget
    /// is spent.
    fn first_contact(&self, width: f64, work: &mut WideWork) -> Option<FirstContact> {
        work.left()?;
        if self.is_in_contact(&mut Root::zero(), work)? {
            return Some(FirstContact::Start);
        }
        let mut bracket: Option<[f64; 2]> = None;
        for polynomial in self.candidates() {
            for mut root in polynomial.roots(work)? {
                if !root.is_zero() && self.is_in_contact(&mut root, work)? {
                    let [safe, hit] = root.bracket(width, work)?;
                    let [s, h] = bracket.unwrap_or([safe, hit]);
                    bracket = Some([safe.smaller(s), hit.smaller(h)]);
                    break;
                }
            }
        }
        Some(bracket.map_or(FirstContact::Miss, |[safe, hit]| FirstContact::Hit { safe, hit }))
    }

    /// Returns polynomials one of which is zero at the first contact, unless that is at time zero:
    /// the contact is told by signs of polynomials, and one that is not zero changes its sign.
    fn candidates(&self) -> Vec<Polynomial> {
        let volume = self.volume();
        if !volume.is_zero() {
            return vec![volume];
        }
        let normal = self.normal();
        if is_zero(&normal) && !matches!(self, ExactPair::Segment(_)) {
            return self.segments().iter().flat_map(ExactPair::candidates).collect();
        }
        let mut all = self.shares(&normal);
        all.push(dot(&normal, &normal));
        all.retain(|p| !p.is_zero());
        all
    }

    /// Returns whether the parts are in contact at an instant.
    fn is_in_contact(&self, at: &mut Root, work: &mut WideWork) -> Option<bool> {
        if at.sign_of(&self.volume(), work)? != 0 {
            return Some(false);
        }
        let normal = self.normal();
        let mut is_flat = true;
        for x in &normal {
            is_flat &= at.sign_of(x, work)? == 0;
        }
        if is_flat {
            for segment in self.segments() {
                if segment.is_in_contact(at, work)? {
                    return Some(true);
                }
            }
            if !matches!(self, ExactPair::Segment(_)) {
                return Some(false);
            }
        } else if matches!(self, ExactPair::Segment(_)) {
            return Some(false);
        }
        for share in self.shares(&normal) {
            if at.sign_of(&share, work)? < 0 {
                return Some(false);
            }
        }
        Some(true)
    }

    /// Six times the volume of the four vertices; for a vertex and a segment a coordinate of the
    /// cross product that is not zero, if any.
    fn volume(&self) -> Polynomial {
        match self {
            ExactPair::Segment(_) => {
                let normal = self.normal();
                let first = normal.iter().find(|x| !x.is_zero());
                first.unwrap_or(&normal[0]).clone()
            }
            ExactPair::Face([p, a, b, c]) => dot(&cross(&sub(b, a), &sub(c, a)), &sub(p, a)),
            ExactPair::Edges([a, b, c, d]) => dot(&cross(&sub(b, a), &sub(d, c)), &sub(c, a)),
        }
    }

    /// The normal of the face, the common perpendicular of the edges; zero of a vertex on the line
    /// of its segment.
    fn normal(&self) -> Vector {
        match self {
            ExactPair::Segment([p, a, b]) => cross(&sub(b, a), &sub(p, a)),
            ExactPair::Face([_, a, b, c]) => cross(&sub(b, a), &sub(c, a)),
            ExactPair::Edges([a, b, c, d]) => cross(&sub(b, a), &sub(d, c)),
        }
    }

    /// The numbers that are not negative if the parts, in one plane with a normal, are in contact:
    /// shares of the vertices of a face, or of the ends of both edges, in the point.
    fn shares(&self, normal: &Vector) -> Vec<Polynomial> {
        match self {
            ExactPair::Segment([p, a, b]) => vec![dot(&sub(p, a), &sub(b, p))],
            ExactPair::Face([p, a, b, c]) => {
                let share = |x: &Vector, y: &Vector| dot(&cross(&sub(x, p), &sub(y, p)), normal);
                vec![share(a, b), share(b, c), share(c, a)]
            }
            ExactPair::Edges([a, b, c, d]) => {
                let (u, v, w) = (sub(b, a), sub(d, c), sub(c, a));
                let whole = dot(normal, normal);
                let [on_a, on_b] = [&v, &u].map(|x| dot(&cross(&w, x), normal));
                vec![whole.sub(&on_a), on_a, whole.sub(&on_b), on_b]
            }
        }
    }

    /// What the pair is if there is no normal: vertices and segments.
    fn segments(&self) -> Vec<ExactPair<'a>> {
        match *self {
            ExactPair::Segment(_) => Vec::new(),
            ExactPair::Face([p, a, b, c]) => [[p, a, b], [p, b, c], [p, c, a]].map(ExactPair::Segment).to_vec(),
            ExactPair::Edges([a, b, c, d]) => [[a, c, d], [b, c, d], [c, a, b], [d, a, b]]
                .map(ExactPair::Segment)
                .to_vec(),
        }
    }
}

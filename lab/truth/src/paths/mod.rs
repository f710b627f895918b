//! The naive oracle of vertices on straight paths, in exact arithmetic: the first contact of a
//! vertex and a face, of two edges or of two triangles.
//!
//! If four points are coplanar, the vertex is in the face, or the edges meet, if and only if their
//! shadows along all three axes do. So, besides the volume, only signs of shadow areas and of
//! coordinate differences are needed, at roots that Sturm sequences isolate.

pub mod families;
mod meshes;
mod sturm;

pub use meshes::{Moving, first_contact, self_contact};

use crate::Point;
use crate::rational::exact;
use dashu_base::BitTest;
use dashu_ratio::RBig;
use sturm::{Poly, Root, roots};

/// Start and end of a vertex.
pub type Path = [Point; 2];

/// The first contact.
#[derive(Clone, Debug)]
pub enum Truth {
    /// No contact.
    Apart,
    /// Contact at time zero.
    Start,
    /// First contact in `(low, high]`, an interval shorter than `2^-80`.
    At(RBig, RBig),
}

impl Truth {
    fn or_earlier(self, next: Self) -> Self {
        match (&self, &next) {
            (Self::Start, _) | (_, Self::Apart) => self,
            (Self::At(low, _), Self::At(other, _)) if low <= other => self,
            _ => next,
        }
    }
}

type Vector = [Poly; 3];

/// Returns the paths over the integers.
fn moving(paths: &[Path]) -> Vec<Vector> {
    let most = paths
        .iter()
        .flatten()
        .flatten()
        .map(|x| exact(*x).denominator().bit_len())
        .max()
        .unwrap_or(1);
    let whole = |x: f64| {
        let x = exact(x);
        x.numerator() << (most - x.denominator().bit_len())
    };
    let path = |p: &Path| {
        std::array::from_fn(|k| {
            let (begin, end) = (whole(p[0][k]), whole(p[1][k]));
            Poly::linear(begin.clone(), end - begin)
        })
    };
    paths.iter().map(path).collect()
}

/// Returns twice the area of the shadow of three points along an axis.
fn area(axis: usize, [a, b, c]: [&Vector; 3]) -> Poly {
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let d = |p: &Vector, k: usize| p[k].minus(&a[k]);
    d(b, i).times(&d(c, j)).minus(&d(b, j).times(&d(c, i)))
}

fn volume([a, b, c, d]: [&Vector; 4]) -> Poly {
    let e = |k: usize| d[k].minus(&a[k]);
    let along = |k: usize| area(k, [a, b, c]).times(&e(k));
    along(0).plus(&along(1)).plus(&along(2))
}

fn is_same(signs: &[i32]) -> bool {
    signs.iter().all(|s| *s >= 0) || signs.iter().all(|s| *s <= 0)
}

/// The polynomials whose signs decide contact, the volume first, and the decision.
struct ContactSigns {
    signs: Vec<Poly>,
    is_contact: fn(&[i32]) -> bool,
}

/// For each axis, three areas; for each coordinate, the differences between the vertex and the
/// three face vertices.
fn of_face(m: &[Vector]) -> ContactSigns {
    let (p, t) = (&m[0], [&m[1], &m[2], &m[3]]);
    let mut signs = vec![volume([p, t[0], t[1], t[2]])];
    for axis in 0..3 {
        signs.extend([0, 1, 2].map(|k| area(axis, [p, t[k], t[(k + 1) % 3]])));
    }
    for k in 0..3 {
        signs.extend([0, 1, 2].map(|i| t[i][k].minus(&p[k])));
    }
    let is_contact = |s: &[i32]| {
        let of_box = |k: usize| {
            let d = &s[10 + 3 * k..13 + 3 * k];
            d.iter().any(|x| *x >= 0) && d.iter().any(|x| *x <= 0)
        };
        s[0] == 0 && (0..3).all(|axis| is_same(&s[1 + 3 * axis..4 + 3 * axis])) && (0..3).all(of_box)
    };
    ContactSigns { signs, is_contact }
}

/// For each axis, four areas; for each coordinate, the four differences between the ends of the
/// edges.
fn of_edges(m: &[Vector]) -> ContactSigns {
    let [a, b, c, d] = [&m[0], &m[1], &m[2], &m[3]];
    let mut signs = vec![volume([a, b, c, d])];
    for axis in 0..3 {
        signs.extend([[a, b, c], [a, b, d], [c, d, a], [c, d, b]].map(|t| area(axis, t)));
    }
    for k in 0..3 {
        signs.extend([(c, a), (c, b), (d, a), (d, b)].map(|(x, y)| x[k].minus(&y[k])));
    }
    let is_contact = |s: &[i32]| {
        let of_box = |k: usize| {
            let d = &s[13 + 4 * k..17 + 4 * k];
            d.iter().any(|x| *x >= 0) && d.iter().any(|x| *x <= 0)
        };
        let crosses = |axis: usize| {
            let o = &s[1 + 4 * axis..5 + 4 * axis];
            o[0] * o[1] <= 0 && o[2] * o[3] <= 0
        };
        s[0] == 0 && (0..3).all(crosses) && (0..3).all(of_box)
    };
    ContactSigns { signs, is_contact }
}

impl ContactSigns {
    fn truth(&self) -> Truth {
        let zero = RBig::ZERO;
        let at_zero: Vec<i32> = self.signs.iter().map(|p| p.sign_at(&zero)).collect();
        if (self.is_contact)(&at_zero) {
            return Truth::Start;
        }
        let candidates = if self.signs[0].is_zero() {
            &self.signs[1..]
        } else {
            &self.signs[..1]
        };
        let mut first: Option<Root> = None;
        for p in candidates.iter().filter(|p| !p.is_zero()) {
            for mut root in roots(p) {
                if first.as_ref().is_some_and(|f| f.high < root.low) {
                    break;
                }
                // The volume is zero at its roots, which are most of the candidates.
                let signs: Vec<i32> = self.signs.iter().map(|q| root.sign_of(q)).collect();
                if (self.is_contact)(&signs) {
                    for _ in 0..90 {
                        root.halve();
                    }
                    if first.as_ref().is_none_or(|f| root.low < f.low) {
                        first = Some(root);
                    }
                    break;
                }
            }
        }
        first.map_or(Truth::Apart, |r| Truth::At(r.low, r.high))
    }
}

/// Returns the first contact of a vertex and a face.
pub fn vertex_face(paths: &[Path; 4]) -> Truth {
    of_face(&moving(paths)).truth()
}

/// Returns the first contact of two edges.
pub fn edge_edge(paths: &[Path; 4]) -> Truth {
    of_edges(&moving(paths)).truth()
}

/// Returns the first contact of two triangles.
pub fn triangles(a: &[Path; 3], b: &[Path; 3]) -> Truth {
    if pierce(a, b) || pierce(b, a) {
        return Truth::Start;
    }
    let mut all = vec![];
    for k in 0..3 {
        all.push(vertex_face(&[a[k], b[0], b[1], b[2]]));
        all.push(vertex_face(&[b[k], a[0], a[1], a[2]]));
        for j in 0..3 {
            all.push(edge_edge(&[a[k], a[(k + 1) % 3], b[j], b[(j + 1) % 3]]));
        }
    }
    all.into_iter().fold(Truth::Apart, Truth::or_earlier)
}

/// Returns whether an edge of `a` passes through the interior of `b`, at time zero.
fn pierce(a: &[Path; 3], b: &[Path; 3]) -> bool {
    let all = moving(&[a[0], a[1], a[2], b[0], b[1], b[2]].map(|p| [p[0], p[0]]));
    let side =
        |i: usize, j: usize, k: usize, l: usize| volume([&all[i], &all[j], &all[k], &all[l]]).sign_at(&RBig::ZERO);
    (0..3).any(|k| {
        let (from, to) = (k, (k + 1) % 3);
        let turns = [(3, 4), (4, 5), (5, 3)].map(|(i, j)| side(from, to, i, j));
        side(3, 4, 5, from) * side(3, 4, 5, to) < 0 && turns[0] != 0 && turns.iter().all(|t| *t == turns[0])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rest(p: Point) -> Path {
        [p, p]
    }

    #[test]
    fn a_vertex_falls_through_a_face_and_past_it() {
        let face = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(rest);
        let fall = |x: f64, y: f64| vertex_face(&[[[x, y, 0.75], [x, y, -0.25]], face[0], face[1], face[2]]);
        let Truth::At(low, high) = fall(0.25, 0.25) else {
            panic!("it falls through")
        };
        assert!(low < exact(0.75) && exact(0.75) <= high);
        // Contact on an edge and at a vertex counts; a point next to the face does not.
        assert!(matches!(fall(0.5, 0.5), Truth::At(..)) && matches!(fall(0.0, 1.0), Truth::At(..)));
        assert!(matches!(fall(0.5, 0.5 + f64::EPSILON), Truth::Apart));
    }

    #[test]
    fn edges_in_one_plane_meet_where_ends_do() {
        let slide = |y: f64| [[[-2.0, y, 0.0], [0.0, y, 0.0]], [[-1.0, y, 0.0], [1.0, y, 0.0]]];
        let other = [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0]].map(rest);
        let truth = |y: f64| {
            let [a, b] = slide(y);
            edge_edge(&[a, b, other[0], other[1]])
        };
        assert!(matches!(truth(0.5), Truth::At(_, high) if high == RBig::ONE));
        assert!(matches!(truth(-0.5), Truth::Apart));
        assert!(matches!(truth(1.0), Truth::At(..)));
    }
}

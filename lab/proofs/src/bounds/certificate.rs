//! Both bounds of a distance: displaced bodies, then what is computed of them.
//!
//! A pose as computed, taken for exact, puts each point of a body no farther off than the errors of the rotation and of
//! the translation say, and the distance changes by no more. All else is compared with bodies so placed. Lengths are the
//! radii `a` and `b`, the distance `t` of the origins, and in double-double the distances `c` and `d` of the origins of
//! the stored frames from the bodies' own: a bound is a polynomial of them, which the sum of all has to exceed.
//!
//! A lower bound is the height of a gap along a direction as the code holds it. A vertex is lowest along the direction
//! as turned into the frame of its body, which is off by the rounding of the turn: along the true one another vertex may
//! be lower by twice that.

use super::poses::{entries_of, rotation, translation};
use super::{Bound, units};
use crate::factor::{Factor, Positive};
use crate::kernels::certificate::{self, Placing};
use crate::majorant::{DOUBLE, Majorant, power, rounding, unit};
use crate::norm::root_above;
use crate::number::Number;
use crate::polynomial::Polynomial;
use crate::vectors::{Arrow, Lengths, Turn, Vectors, Within};
use dashu_ratio::RBig;

/// Operations of double-double err by 10 UNIT^2, so by less than one rounding of this precision.
const TWICE: u32 = 102;

pub(super) fn bounds() -> Vec<Bound> {
    let mut all = [Frame::of_a(), Frame::of_b()]
        .iter()
        .flat_map(Frame::walk)
        .collect::<Vec<_>>();
    let a = Frame::of_a();
    all.extend(a.edges());
    all.push(a.row("supports", "pair::certificate::support_distance", a.supports()));
    all.extend(a.solver());
    all.extend(Frame::of_double_double().solver());
    let shift = shifted().over(&Frame::of_double_double().size());
    let shift = shift.expect("lengths of the pair") / power(-i64::from(TWICE));
    let kernel = "pair::transform::Transform::shift";
    let row = Bound::whole("CERTIFICATE", kernel, shift * unit());
    all.push(row.case("origins of stored frames, in double-double"));
    all.extend([
        Bound::whole("DIFFERENCE", "convex::walk::vertex_edge", weights()).case("weights of faces at an edge"),
        Bound::whole("ON_BOUNDARY", "convex::walk::vertex_edge", beside_edge()).case("part along an edge"),
    ]);
    all
}

pub(super) fn variable(letter: char) -> Polynomial {
    Polynomial::variable(letter, 0)
}

/// Relative error of a length: three squares, two sums, the root.
pub(super) fn of_length(precision: u32) -> RBig {
    let r = rounding(precision);
    // Half of three roundings, and one; in double-double the root is a quotient, a sum and less than one more.
    let root = if precision == DOUBLE { 1 } else { 3 };
    (RBig::from(3) / RBig::from(2) + RBig::from(root)) * r * (RBig::ONE + power(-40))
}

/// Two bodies in the frame of one of them.
pub(super) struct Frame {
    pub(super) precision: u32,
    pub(super) placing: Placing<Lengths>,
    /// By how much the points of the body that is placed are off.
    displacement: Polynomial,
    /// The letters of the body whose frame it is, and of the other.
    own: char,
    other: char,
}

impl Frame {
    fn new(precision: u32, rotation: &RBig, displacement: Polynomial, [own, other]: [char; 2]) -> Self {
        let t = variable('t').scaled(&(RBig::ONE + power(-40)));
        Self {
            precision,
            placing: Placing {
                rotation: Turn::new(precision, RBig::ONE + rotation, RBig::ZERO),
                translation: Arrow::new(precision, t, RBig::ZERO),
            },
            displacement,
            own,
            other,
        }
    }

    pub(super) fn of_a() -> Self {
        let off = variable('b')
            .scaled(&rotation())
            .plus(&variable('t').scaled(&translation()));
        Self::new(DOUBLE, &rotation(), off, ['a', 'b'])
    }

    /// The translation is turned with the points of A, and errs itself.
    fn of_b() -> Self {
        let turned = variable('a').plus(&variable('t')).scaled(&rotation());
        let off = turned.plus(&variable('t').scaled(&translation()));
        Self::new(DOUBLE, &rotation(), off, ['b', 'a'])
    }

    pub(super) fn of_double_double() -> Self {
        let rotation = certificate::rotation_between::<Lengths>([turn_of_twice(); 2]).error();
        let off = variable('b').scaled(&rotation).plus(&shifted());
        Self::new(TWICE, &rotation, off, ['a', 'b'])
    }

    /// The size L.
    fn size(&self) -> Polynomial {
        let letters = if self.precision == DOUBLE { "abt" } else { "abtcd" };
        letters.chars().fold(Polynomial::default(), |s, c| s.plus(&variable(c)))
    }

    /// So much of L.
    pub(super) fn part(&self, of: &RBig) -> Polynomial {
        self.size().scaled(of)
    }

    pub(super) fn once(&self) -> RBig {
        rounding(self.precision)
    }

    pub(super) fn arrow(&self, most: Polynomial) -> Arrow {
        Arrow::new(self.precision, most, RBig::ZERO)
    }

    /// A direction of length one.
    pub(super) fn direction(&self) -> Arrow {
        self.arrow(RBig::ONE.into())
    }

    fn number(&self, most: Polynomial) -> Within {
        Within::new(self.precision, most, RBig::ZERO)
    }

    /// A row, of the error of what is computed of bodies as placed: with their displacement, the rounding of the bound
    /// less or plus its error term, and the second order.
    pub(super) fn row(&self, part: &'static str, kernel: &'static str, error: Polynomial) -> Bound {
        let last = self.once() + RBig::from(2000) * self.once() * self.once();
        let error = error.plus(&self.displacement).plus(&self.part(&last));
        let proved = error.over(&self.size()).expect("lengths of the pair");
        let proved = proved / power(-i64::from(self.precision));
        Bound::whole("CERTIFICATE", kernel, proved * unit()).case(part)
    }

    /// A vertex of the other body.
    fn vertex(&self) -> Arrow {
        let v = self.arrow(variable(self.other));
        if self.own == 'a' {
            self.placing.in_a(v)
        } else {
            self.placing.in_b(v)
        }
    }

    /// Another vertex of the other body may be lower than the one that is lowest along the turned direction.
    pub(super) fn lower_vertex(&self) -> Polynomial {
        let turned = self.placing.turned_to_b(self.direction());
        turned
            .error_by_lengths()
            .times(&variable(self.other))
            .scaled(&RBig::from(2))
    }

    /// The tests of a vertex of the other body.
    fn walk(&self) -> Vec<Bound> {
        let mut rows = Vec::new();
        let of_length = self.part(&of_length(self.precision));
        let [name_face, name_edge] = if self.own == 'a' {
            [
                ["face of A, lower", "face of A, upper"],
                ["edge of A, lower", "edge of A, upper"],
            ]
        } else {
            [
                ["face of B, lower", "face of B, upper"],
                ["edge of B, lower", "edge of B, upper"],
            ]
        };
        if self.own == 'a' {
            let ends = ['a', 'b'].map(|c| self.arrow(variable(c)));
            let between = self.placing.between_vertices(ends).error_by_lengths();
            let kernel = "convex::walk::vertex_vertex";
            let upper = between.plus(&of_length);
            rows.push(self.row("vertices, lower", kernel, upper.plus(&self.lower_vertex())));
            rows.push(self.row("vertices, upper", kernel, upper));
        }
        let [lower, upper] = self.over_face();
        rows.push(self.row(name_face[0], "convex::walk::vertex_face", lower));
        rows.push(self.row(name_face[1], "convex::walk::vertex_face", upper));
        let [lower, upper] = self.beside_edge();
        rows.push(self.row(name_edge[0], "convex::walk::vertex_edge", lower));
        rows.push(self.row(name_edge[1], "convex::walk::vertex_edge", upper));
        rows
    }

    /// A vertex over the plane of a face, whose offset is no less than any height of the body; and its distance from the
    /// plane, of which the foot lies in the face, or from a point of an edge.
    fn over_face(&self) -> [Polynomial; 2] {
        let (x, own) = (self.vertex(), variable(self.own));
        let longer = units(1.0625);
        let normal = self.arrow((RBig::ONE + &longer).into());
        let offset = self.number(own.scaled(&(RBig::ONE + power(-40))));
        let lower = certificate::over_plane::<Lengths>(normal, x, offset);
        let lower = lower.error_by_lengths().plus(&self.lower_vertex());
        let corner = self.arrow(own.clone());
        let height = certificate::over_corner::<Lengths>(normal, x, corner);
        let height = height.error_by_lengths().plus(&self.part(&longer));
        let one = self.number(RBig::ONE.into());
        let edge = certificate::from_edge::<Lengths>(x, [corner; 2], one);
        let grazed = edge.error_by_lengths().plus(&self.part(&of_length(self.precision)));
        [lower.plus(&self.part(&longer)), greatest([&height, &grazed])]
    }

    /// A vertex beside an edge, by the vector from the edge that was made right once more; or over the planes of the
    /// adjacent faces, by their bound of the support.
    fn beside_edge(&self) -> [Polynomial; 2] {
        let (x, own) = (self.vertex(), variable(self.own));
        let off = x.error_by_lengths();
        // The vertex as computed, taken for exact.
        let at = self.arrow(
            variable(self.other)
                .plus(&variable('t'))
                .scaled(&(RBig::ONE + power(-40))),
        );
        let end = self.arrow(own.clone());
        let [u, r] = certificate::along_edge::<Lengths>(at, [end; 2]);
        let [one, none] = [RBig::ONE, RBig::ZERO].map(|x| self.number(x.into()));
        let first = certificate::less::<Lengths>(r, u, one).at_most(self.size());
        // What is left along the edge is rounding, so its own rounding is of the second order.
        let d = certificate::less::<Lengths>(first, u, none).error_by_lengths();
        let twice = own.scaled(&RBig::from(2));
        let along = twice.scaled(&(right_angle_beside_edge() + self.once()));
        let length = self.part(&of_length(self.precision));
        let proven = d.plus(&along).plus(&length);
        // The inverse of a length, and a product with it.
        let quotient = of_length(self.precision) + RBig::from(2) * self.once();
        let support = self.number(self.size());
        let by_planes = certificate::over_plane::<Lengths>(self.direction(), at, support);
        let by_planes = by_planes.error_by_lengths().plus(&self.part(&quotient));
        let lower = greatest([&proven, &by_planes]).plus(off).plus(&self.lower_vertex());
        // The foot is at the rounded sum of both positions.
        let upper = d.plus(&twice.scaled(&self.once())).plus(&length).plus(off);
        [lower, upper]
    }

    /// Two edges, in the frame of A.
    fn edges(&self) -> [Bound; 2] {
        let [a, b] = ['a', 'b'].map(|c| self.arrow(variable(c)));
        let edges = self.placing.edges([a; 2], [b; 2]);
        let between = edges.between.at_most(self.size());
        // Along the direction each edge rises by no more than this.
        let [on_a, on_b] = right_angles();
        let rise = |c, angle: &RBig, edge: Arrow| {
            let own = variable(c).scaled(&(RBig::from(2) * angle));
            own.plus(edge.error_by_lengths())
        };
        let rises = rise('a', &on_a, edges.u).plus(&rise('b', &on_b, edges.w));
        // The square of the direction, its root times its inverse, and the product with the height.
        let square = || (0..2).fold(Factor::input().squared(), |s, _| s + Factor::input().squared());
        let per_length = square().root() * (Factor::input() / square());
        let per_length = per_length.error() + self.once();
        let height = Lengths::dot(self.direction(), between).error_by_lengths();
        let proven = height.plus(&rises).plus(&self.part(&per_length));
        let supports = [self.number(self.size()), self.number(self.size())];
        let by_planes = self.placing.between_bounds(self.direction(), supports);
        let turned = self.placing.turned_to_b(self.direction()).error_by_lengths();
        let by_planes = by_planes
            .error_by_lengths()
            .plus(&turned.times(&variable('b')))
            .plus(&self.part(&per_length));
        let one = || self.number(RBig::ONE.into());
        let witnesses = edges.between_witnesses(a, [one(), one()]);
        let upper = witnesses
            .error_by_lengths()
            .plus(&self.part(&of_length(self.precision)));
        let kernel = "convex::walk::edge_edge";
        [
            self.row("edges, lower", kernel, greatest([&proven, &by_planes])),
            self.row("edges, upper", kernel, upper),
        ]
    }

    /// Support points along a direction that was divided by its length.
    fn supports(&self) -> Polynomial {
        let longer = of_length(self.precision) + self.once();
        let n = self.arrow((RBig::ONE + &longer).into());
        let points = ['a', 'b'].map(|c| self.arrow(variable(c)));
        let distance = self.placing.support_distance(n, points);
        distance.error_by_lengths().plus(&self.part(&longer))
    }

    /// The solver of least distances: the height of a support point, which in f64 is the highest as rounded, and the
    /// distance of a combination.
    fn solver(&self) -> [Bound; 2] {
        let points = ['a', 'b'].map(|c| self.arrow(variable(c)));
        let w = self.placing.difference(points);
        let height = Lengths::dot(self.direction(), w).error_by_lengths();
        let quotient = of_length(self.precision) + self.once();
        let mut lower = height.plus(&self.part(&quotient)).plus(&self.lower_vertex());
        if self.precision == DOUBLE {
            let of = |p| {
                Lengths::dot(self.direction(), p)
                    .error_by_lengths()
                    .scaled(&RBig::from(2))
            };
            lower = lower.plus(&of(points[0])).plus(&of(points[1]));
        }
        // Three weights sum up to one within three roundings: of two sums and of a quotient each.
        let of_sum = RBig::from(3) * self.once();
        let weights = ['x', 'y', 'z'].map(variable);
        let total = weights.iter().fold(Polynomial::default(), |s, x| s.plus(x));
        let terms = weights.map(|x| self.number(x));
        let combined = certificate::combined::<Lengths>(&[w; 3], &terms).error_by_lengths();
        let per_weight = combined
            .over(&total.times(&self.size()))
            .expect("weights times lengths");
        let upper = self.part(&(per_weight + of_sum + of_length(self.precision)));
        let [low, high] = if self.precision == DOUBLE {
            ["solver, lower", "solver, upper"]
        } else {
            ["solver in double-double, lower", "solver in double-double, upper"]
        };
        [
            self.row(low, "convex::minimum", lower),
            self.row(high, "convex::minimum::simplex", upper),
        ]
    }
}

/// No less than either, coefficient by coefficient.
fn greatest([p, q]: [&Polynomial; 2]) -> Polynomial {
    let mut most = p.clone();
    for (m, c) in q.terms() {
        let above = p.terms().find(|(n, _)| *n == m).map_or(c.clone(), |(_, d)| c - d);
        if above > RBig::ZERO {
            most = most.plus(&Polynomial::term(m.clone(), above));
        }
    }
    most
}

fn one_arrow(most: RBig) -> Arrow {
    Arrow::new(DOUBLE, most, RBig::ZERO)
}

/// `1 / (u . u)` against the exact one, and a product with it.
fn inverse_square() -> RBig {
    let square = || Factor::input().squared();
    (Factor::input() / (square() + square() + square()) * Factor::input()).error()
}

/// What is left along an edge of a vector that was made right to it once, over the length of the vector from the tail.
fn beside_edge() -> RBig {
    let one = || one_arrow(RBig::ONE);
    let height = Lengths::dot(one(), one()).error() + inverse_square();
    let position = Within::new(DOUBLE, RBig::ONE, height);
    certificate::less::<Lengths>(one(), one(), position).error()
}

/// The cosine of the angle of an edge with a vector that was made right twice, and is no shorter than `ON_BOUNDARY`: what
/// was left of it the first time is at most this part of it.
fn right_angle_beside_edge() -> RBig {
    made_right(&(beside_edge() / units(16.0)))
}

/// The cosine that is left if this part of a vector's length was along the edge before.
fn made_right(part: &RBig) -> RBig {
    let before = one_arrow(root_above(&(RBig::ONE + part * part)));
    let edge = one_arrow(RBig::ONE);
    let height = Lengths::dot(before, edge).error() + part * inverse_square();
    let position = Within::new(DOUBLE, part.clone(), height);
    // The difference is no longer than the vector itself.
    Lengths::scaled(edge, position).error() + rounding(DOUBLE)
}

/// The cosines of the angles of the common perpendicular of two edges as computed with both. If the sine is at least a
/// quarter (`NEARLY_PARALLEL`) the cross product errs by its rounding over the sine. Else it is made right to the edge of
/// A; it is no shorter than 16 UNIT (`PARALLEL`). What is at right angles to that edge and off the true perpendicular is
/// seen by the edge of B under the sine.
fn right_angles() -> [RBig; 2] {
    let cross = Lengths::cross(one_arrow(RBig::ONE), one_arrow(RBig::ONE)).error();
    let at_quarter = &cross * RBig::from(4) * (RBig::ONE + units(32.0));
    let part = &cross / units(16.0) * (RBig::ONE + units(32.0));
    let on_a = made_right(&part);
    let on_b = &on_a + &cross * (RBig::ONE + RBig::from(2) * part);
    [at_quarter.clone().max(on_a), at_quarter.max(on_b)]
}

/// The weights of a direction over the planes at an edge, `n . (u x d)`, over the lengths of the edge and of the direction:
/// the edge is a rounded difference, the normal off by `NORMAL_ERROR`.
fn weights() -> RBig {
    let edge = Arrow::new(DOUBLE, RBig::ONE, rounding(DOUBLE));
    let normal = Arrow::new(DOUBLE, RBig::ONE, units(1.0625));
    let across = Lengths::cross(edge, one_arrow(RBig::ONE));
    Lengths::dot(normal, across).error()
}

/// The matrix of a quaternion in double-double. Its factor errs by four products and three sums, of which each square
/// passes four, and by a quotient.
pub(super) fn turn_of_twice() -> Turn {
    let exactly: [Majorant; 4] = std::array::from_fn(|k| Majorant::input_in(TWICE, 'q', k as u8, &RBig::ZERO));
    let rows = certificate::rotation(exactly, Majorant::exact(2.0));
    let factor = RBig::from(5) * rounding(TWICE) * (RBig::ONE + power(-40));
    let error = entries_of(&rows) + RBig::from(2) * factor;
    Turn::new(TWICE, RBig::ONE, error * (RBig::ONE + power(-30)))
}

/// The translation between stored frames: the translations of the poses differ by no more than the distance of the
/// frames and their distances from the bodies' origins; the difference is exact.
fn shifted() -> Polynomial {
    let arrow = |most| Arrow::new(TWICE, most, RBig::ZERO);
    let [t, c, d] = ['t', 'c', 'd'].map(variable);
    let difference = t.plus(&c).plus(&d);
    let origins = [arrow(c), arrow(d)];
    let off = certificate::shift::<Lengths>([turn_of_twice(); 2], origins, arrow(difference));
    off.error_by_lengths().clone()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_greatest_is_no_less_than_either() {
        let [a, b] = ['a', 'b'].map(variable);
        let p = a.scaled(&RBig::from(3)).plus(&b);
        let q = a.plus(&b.scaled(&RBig::from(2)));
        let most = greatest([&p, &q]);
        assert_eq!(most, a.scaled(&RBig::from(3)).plus(&b.scaled(&RBig::from(2))));
    }
}

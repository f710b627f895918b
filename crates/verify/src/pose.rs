//! Constant poses, and where a body at rest has its vertices, exactly.

use dashu_int::IBig;
use dashu_ratio::RBig;

use crate::Stop;
use crate::points::Points;
use crate::real::{Exact, Real, cross, dot, two_to};

/// A constant pose: the rows of the rotation, and the shift.
#[derive(Clone, Debug)]
pub(crate) struct Pose {
    pub(crate) rows: [Exact; 3],
    pub(crate) shift: Exact,
}

impl Pose {
    pub(crate) fn identity() -> Self {
        let rows = std::array::from_fn(|i| std::array::from_fn(|j| RBig::from(i32::from(i == j))));
        Self {
            rows,
            shift: crate::real::zero(),
        }
    }

    /// The rotation of a quaternion of any length is its quadratic form over the square of the
    /// length: no root.
    pub(crate) fn of(numbers: &[Real; 7]) -> Result<Self, Stop> {
        let [px, py, pz, qx, qy, qz, qw] = numbers.map(Real::exact);
        let n = &qx * &qx + &qy * &qy + &qz * &qz + &qw * &qw;
        let off = &n - RBig::ONE;
        if &off * &off >= RBig::from_parts_signed(1.into(), 1_000_000.into()) {
            return Stop::bad("not a unit quaternion");
        }
        // x + 2 (w q x x + q x (q x x)) / n, of each axis x.
        let (half, q, axes) = (n / RBig::from(2), [qx, qy, qz], Self::identity().rows);
        let columns = axes.map(|axis| {
            let once = cross(&q, &axis);
            let twice = cross(&q, &once);
            std::array::from_fn::<_, 3, _>(|k| &axis[k] + (&qw * &once[k] + &twice[k]) / &half)
        });
        let rows = std::array::from_fn(|i| columns.each_ref().map(|column| column[i].clone()));
        Ok(Self {
            rows,
            shift: [px, py, pz],
        })
    }

    pub(crate) fn point(&self, x: &Exact) -> Exact {
        std::array::from_fn(|k| dot(&self.rows[k], x) + &self.shift[k])
    }

    /// Of n . (pose of x) the vector m with m . x + n . shift.
    pub(crate) fn row(&self, n: &Exact) -> Exact {
        std::array::from_fn(|k| &n[0] * &self.rows[0][k] + &n[1] * &self.rows[1][k] + &n[2] * &self.rows[2][k])
    }

    /// Returns the pose that undoes this one.
    pub(crate) fn inverse(&self) -> Self {
        let rows = std::array::from_fn(|i| std::array::from_fn(|j| self.rows[j][i].clone()));
        let shift = std::array::from_fn(|k| -dot(&rows[k], &self.shift));
        Self { rows, shift }
    }

    pub(crate) fn then(&self, inner: &Self) -> Self {
        let rows = self.rows.each_ref().map(|row| inner.row(row));
        Self {
            rows,
            shift: self.point(&inner.shift),
        }
    }
}

/// The vertices of a body at rest, in the world.
pub(crate) struct Placed<'a> {
    pub(crate) pose: Pose,
    pub(crate) points: &'a Points,
}

impl Placed<'_> {
    pub(crate) fn get(&self, k: usize) -> Option<Exact> {
        Some(self.pose.point(&self.points.get(k)?))
    }

    /// Returns the least and the greatest height of some vertices along n, or of all. Integers: no
    /// fraction is reduced.
    pub(crate) fn heights(&self, some: Option<&[usize]>, n: &Exact) -> [RBig; 2] {
        let m = self.pose.row(n);
        let below = m.iter().fold(IBig::ONE, |d, x| d * IBig::from(x.denominator().clone()));
        let m = m.map(|x| x.numerator() * (&below / IBig::from(x.denominator().clone())));
        let height = |p: &[IBig; 3]| &m[0] * &p[0] + &m[1] * &p[1] + &m[2] * &p[2];
        let all: Vec<IBig> = match some {
            Some(some) => some.iter().map(|k| height(&self.points.all[*k])).collect(),
            None => self.points.all.iter().map(height).collect(),
        };
        // A body has points, and a part of it has some.
        let [least, most] = [all.iter().min(), all.iter().max()].map(|end| end.cloned().unwrap_or_default());
        let (unit, base) = (
            two_to(self.points.exponent) / RBig::from(below),
            dot(n, &self.pose.shift),
        );
        [least, most].map(|h| RBig::from(h) * &unit + &base)
    }
}

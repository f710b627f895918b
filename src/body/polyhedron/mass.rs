//! Volume, centroid and inertia at unit density.
//!
//! The body is divided into tetrahedra between the centre of its box and triangles of its faces.
//! The moments of a tetrahedron are polynomials of its vertices (Tonon 2004). All sums are in
//! double-double from exact differences, so thin bodies, round bodies and bodies far from the
//! origin lose nothing to cancellation. Only slivers thinner than rounding (1e-16 of their extent)
//! lose digits.

use nalgebra::{Matrix3, Point3, Vector3};

use crate::base::num::double_double::DoubleDouble;
use crate::base::num::scalar::Scalar;
use crate::body::polyhedron::{ConvexPolyhedron, FaceId, VertexId};

/// Sums over the body relative to its box centre, in stored units: six times the volume, 24 times
/// the first moments, 120 times the second moments.
struct Moments {
    volume: DoubleDouble,
    first: [DoubleDouble; 3],
    /// Second moments in the order xx, yy, zz, xy, yz, zx.
    second: [DoubleDouble; 6],
}

const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];

impl ConvexPolyhedron {
    /// Returns the volume, in the caller's unit cubed; 0 for polygons, segments and points.
    #[must_use]
    pub fn volume(&self) -> f64 {
        let unit = self.unit();
        self.moments(false).volume.value() / 6.0 * unit * unit * unit
    }

    /// Returns the centre of mass: of the volume, of a polygon's area, of a segment's length, or
    /// the point itself.
    #[doc(alias = "center_of_mass")]
    #[must_use]
    pub fn centroid(&self) -> Point3<f64> {
        let middle = self.middle();
        let moments = self.moments(false);
        let centroid = if moments.volume.value() > 0.0 && self.face_count() > 2 {
            let four = DoubleDouble::from(4.0);
            middle + Vector3::from_fn(|k, _| (moments.first[k] / (moments.volume * four)).value())
        } else if self.face_count() == 2 {
            self.polygon_centroid()
        } else {
            middle
        };
        self.to_user(&centroid)
    }

    /// Returns the inertia tensor relative to the centroid, at unit density.
    ///
    /// It is in the caller's axes and in the caller's unit to the fifth power; zero for bodies
    /// without volume. At extents beyond about 1e60 it overflows to infinity, and below 1e-60 it
    /// underflows to zero, as f64 does.
    #[doc(alias = "moment_of_inertia")]
    #[must_use]
    pub fn inertia(&self) -> Matrix3<f64> {
        let m = self.moments(true);
        if self.face_count() < 3 || m.volume.value() <= 0.0 {
            return Matrix3::zeros();
        }
        let of = DoubleDouble::from;
        // Steiner's theorem: 120 times the second moments about the centroid, volume = m.volume /
        // 6.
        let central: [f64; 6] = core::array::from_fn(|i| {
            let (j, k) = PAIRS[i];
            let shift = m.first[j] * m.first[k] / m.volume * of(120.0 / (24.0 * 4.0));
            (m.second[i] - shift).value() / 120.0
        });
        let [xx, yy, zz, xy, yz, zx] = central;
        let tensor = Matrix3::new(yy + zz, -xy, -zx, -xy, zz + xx, -yz, -zx, -yz, xx + yy);
        let unit = self.unit();
        tensor * unit * unit * unit * unit * unit
    }

    /// Returns the centre of the bounding box, in stored coordinates.
    fn middle(&self) -> Vector3<f64> {
        self.low * 0.5 + self.high * 0.5
    }

    fn moments(&self, second: bool) -> Moments {
        let zero = DoubleDouble::default();
        let mut sum = Moments {
            volume: zero,
            first: [zero; 3],
            second: [zero; 6],
        };
        let middle = self.middle();
        let at = |v: VertexId| {
            let p = &self.points[v.index()];
            core::array::from_fn(|k| DoubleDouble::sum(p[k], -middle[k]))
        };
        if self.face_count() < 3 {
            return sum;
        }
        for f in FaceId::all(self.topology.face_count()) {
            let mut rim = self.topology.rim(f).map(|h| self.topology.from(h));
            let (Some(a), Some(b)) = (rim.next(), rim.next()) else {
                continue;
            };
            let (a, mut b) = (at(a), at(b));
            for c in rim {
                let c = at(c);
                sum.add(&a, &b, &c, second);
                b = c;
            }
        }
        sum
    }

    /// Returns the centroid of the area of a polygon, in stored coordinates.
    fn polygon_centroid(&self) -> Vector3<f64> {
        let normal = self.planes[0].normal;
        let rim = || {
            self.topology
                .rim(FaceId(0))
                .map(|h| self.points[self.topology.from(h).index()])
        };
        let Some(a) = rim().next() else { return self.middle() };
        let (mut area, mut first) = (0.0, Vector3::zeros());
        for (b, c) in rim().skip(1).zip(rim().skip(2)) {
            let part = (b - a).cross(&(c - a)).dot(&normal);
            area += part;
            first += ((b - a) + (c - a)) * part;
        }
        if area > 0.0 {
            a + first / (3.0 * area)
        } else {
            self.middle()
        }
    }
}

impl Moments {
    /// Adds the tetrahedron between the box centre and a triangle given relative to that centre.
    fn add(&mut self, a: &[DoubleDouble; 3], b: &[DoubleDouble; 3], c: &[DoubleDouble; 3], second: bool) {
        let minor = |j: usize, k: usize| b[j] * c[k] - b[k] * c[j];
        let six_volumes = a[0] * minor(1, 2) + a[1] * minor(2, 0) + a[2] * minor(0, 1);
        self.volume = self.volume + six_volumes;
        let corners: [DoubleDouble; 3] = core::array::from_fn(|k| a[k] + b[k] + c[k]);
        for k in 0..3 {
            self.first[k] = self.first[k] + six_volumes * corners[k];
        }
        if second {
            for (slot, (j, k)) in self.second.iter_mut().zip(PAIRS) {
                let squares = a[j] * a[k] + b[j] * b[k] + c[j] * c[k] + corners[j] * corners[k];
                *slot = *slot + six_volumes * squares;
            }
        }
    }
}

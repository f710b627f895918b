//! Two sets of vertices on straight paths, scaled to their size, and what a direction proves of
//! them.

use core::array::from_fn;
use nalgebra::{Point3, Vector3};

use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::tolerance::{PATH_AREA, PATH_DIRECTION, PATH_GAP, PATH_VOLUME, UNIT};
use crate::body::polyhedron::{exponent_of, power_of_two};
use crate::nonconvex::query::triangle;

/// A point that moves on a straight path at constant velocity, from time zero to time one.
#[derive(Clone, Copy, Debug)]
pub(super) struct VertexPath {
    /// The position at time zero.
    pub(super) start: Point3<f64>,
    /// The position at time one.
    pub(super) end: Point3<f64>,
}

impl VertexPath {
    /// Returns the path from one position to another.
    pub(super) fn new(start: Point3<f64>, end: Point3<f64>) -> Self {
        Self { start, end }
    }

    /// Returns the position at a time from zero to one, rounded.
    #[must_use]
    pub(super) fn at(&self, time: f64) -> Point3<f64> {
        Point3::from(self.start.coords * (1.0 - time) + self.end.coords * time)
    }
}

/// The vertices of A and B relative to the moving first vertex of A, and scaled.
///
/// The factor is a power of two that puts the largest coordinate between 1/2 and 1.
pub(super) struct VertexPaths<const A: usize, const B: usize> {
    a: [[Vector3<f64>; 2]; A],
    b: [[Vector3<f64>; 2]; B],
    /// A gap must exceed this, in stored lengths. Zero for straight paths.
    slack: f64,
    /// One stored length in the caller's unit, as two factors.
    pub(super) unit: [f64; 2],
}

/// The vertices at a time.
pub(super) struct VertexPlaces<const A: usize, const B: usize> {
    pub(super) a: [Vector3<f64>; A],
    pub(super) b: [Vector3<f64>; B],
}

impl<const A: usize, const B: usize> VertexPaths<A, B> {
    /// Returns the scaled paths; `None` if all vertices are at one point all the time.
    ///
    /// Coordinates must be at most `2^1000`.
    pub(super) fn new(a: &[VertexPath; A], b: &[VertexPath; B]) -> Option<Self> {
        let first = &a[0];
        let seen = |p: &VertexPath| [p.start - first.start, p.end - first.end];
        let (a, b) = (a.each_ref().map(seen), b.each_ref().map(seen));
        let largest = a.iter().chain(&b).flatten().fold(0.0, |m: f64, v| m.larger(v.amax()));
        if largest == 0.0 {
            return None;
        }
        // The factor 2^60 makes subnormal numbers normal.
        let lift = if largest < power_of_two(-1000) { 60 } else { 0 };
        let e = exponent_of(largest * power_of_two(lift)) + 1;
        let (once, rest) = (power_of_two(lift), power_of_two(-e));
        // If the factor is not a normal number, it must be applied as two factors.
        let scaled = |v: &Vector3<f64>| v * once * rest;
        let each = |p: &[Vector3<f64>; 2]| p.each_ref().each(scaled);
        let (a, b) = (a.each_ref().map(each), b.each_ref().map(each));
        let unit = [power_of_two(e), power_of_two(-lift)];
        let slack = 0.0;
        Some(Self { a, b, slack, unit })
    }

    /// Returns the paths with a slack that gaps must exceed, in the caller's unit.
    pub(super) fn within(mut self, slack: f64) -> Self {
        self.slack = slack / self.unit[0] / self.unit[1] * (1.0 + 4.0 * UNIT);
        self
    }

    /// Returns whether a direction separates A and B at two times, and so at all times in between.
    ///
    /// Along a fixed direction, the coordinates of vertices on straight paths are linear in time.
    #[inline(always)]
    pub(super) fn are_parted(&self, both: [&VertexPlaces<A, B>; 2], n: &Vector3<f64>) -> bool {
        // The sum of the magnitudes is at least the length.
        let size = size(n);
        size > 0.0 && both.iter().all(|x| x.gap(n) > self.slack * size)
    }

    /// Returns whether signs of volumes prove anything, which is so if there is no slack.
    pub(super) fn are_straight(&self) -> bool {
        self.slack == 0.0
    }

    /// Returns the positions at a time. Each coordinate is wrong by at most 4 UNIT.
    #[inline(always)]
    pub(super) fn at(&self, time: f64) -> VertexPlaces<A, B> {
        VertexPlaces {
            a: self.a.each_ref().map(|ends| place(ends, time)),
            b: self.b.each_ref().map(|ends| place(ends, time)),
        }
    }
}

/// Returns the position at a time of a vertex with these ends.
#[inline(always)]
pub(crate) fn place([begin, end]: &[Vector3<f64>; 2], time: f64) -> Vector3<f64> {
    begin * (1.0 - time) + end * time
}

/// Returns the sum of the magnitudes of a direction's coordinates; zero if it is out of range.
#[inline(always)]
pub(super) fn size(n: &Vector3<f64>) -> f64 {
    let size = n.x.abs() + n.y.abs() + n.z.abs();
    // Compared with directions in this range, products that underflow are negligible.
    if size > PATH_DIRECTION && size < 1.0 / PATH_DIRECTION {
        size
    } else {
        0.0
    }
}

impl<const A: usize, const B: usize> VertexPlaces<A, B> {
    /// Returns a lower bound of the gap from A to B along a direction, in lengths of the direction.
    #[inline(always)]
    pub(super) fn gap(&self, n: &Vector3<f64>) -> f64 {
        let high = self.a.iter().fold(f64::NEG_INFINITY, |m: f64, p| m.larger(n.dot(p)));
        let low = self.b.iter().fold(f64::INFINITY, |m: f64, p| m.smaller(n.dot(p)));
        low - high - PATH_GAP * (n.x.abs() + n.y.abs() + n.z.abs())
    }

    /// Returns both sides as triangles. The last vertex stands in for missing ones.
    pub(super) fn triangles(&self) -> [triangle::Triangle; 2] {
        [from_fn(|k| self.a[k.min(A - 1)]), from_fn(|k| self.b[k.min(B - 1)])]
    }
}

/// What the search for a first contact needs of a pair.
pub(super) trait Parts {
    /// Returns a candidate for a separating direction from A to B.
    ///
    /// It is the vector between points that are nearly the closest.
    fn toward(&self) -> Vector3<f64>;

    /// Returns the normals of the faces or the common perpendicular of two edges, towards B.
    ///
    /// A missing normal is zero.
    fn normals(&self) -> [Vector3<f64>; 2];

    /// Returns whether the vertices are proven not to lie in one plane at any time between two.
    fn is_never_flat(_: [&Self; 2]) -> bool {
        false
    }
}

/// Four vertices: a vertex and a face, or two edges.
pub(super) trait FourVertices: Parts {
    /// Returns six times the signed volume of the four vertices.
    ///
    /// The sign is the side of the face on which the vertex lies, or the side on which two edges
    /// pass each other. The volume is zero if the vertices lie in one plane. The three vectors may
    /// be taken at different times.
    fn volume(by: [&Self; 3]) -> f64;

    /// Returns whether the pair overlaps in projection along a direction at all times between two.
    ///
    /// This means that the vertex projects into the face, or that the edges cross.
    fn is_over(both: [&Self; 2], n: &Vector3<f64>) -> bool;
}

/// Returns the sign of a number, or zero if the number is within the doubt.
#[inline(always)]
fn certain(x: f64, doubt: f64) -> i32 {
    i32::from(x > doubt) - i32::from(x < -doubt)
}

/// Returns the sign of `((j - i) x (k - i)) . n` if it is the same at all times between two.
///
/// Returns zero otherwise. The product is a quadratic in time, which has one sign if its Bernstein
/// coefficients have.
fn turn(at: [[&Vector3<f64>; 3]; 2], n: &Vector3<f64>, doubt: f64) -> i32 {
    let [first, second, third] = areas(at).each(|area| certain(area.dot(n), doubt));
    if first == second && second == third { first } else { 0 }
}

/// Returns the Bernstein coefficients of `(j - i) x (k - i)` between two times.
#[inline(always)]
pub(crate) fn areas(at: [[&Vector3<f64>; 3]; 2]) -> [Vector3<f64>; 3] {
    let [[a, b], [c, d]] = at.each(|[i, j, k]| [j - i, k - i]);
    let middle = (a.cross(&d) + c.cross(&b)) * 0.5;
    [a.cross(&b), middle, c.cross(&d)]
}

#[inline(always)]
pub(crate) fn determinant([a, b, c]: [&Vector3<f64>; 3]) -> f64 {
    a.cross(b).dot(c)
}

/// Returns a direction, negated if needed so that it has no negative component along `way`.
#[inline(always)]
fn turned(n: Vector3<f64>, way: &Vector3<f64>) -> Vector3<f64> {
    if n.dot(way) < 0.0 { -n } else { n }
}

/// A vertex and a face.
impl Parts for VertexPlaces<1, 3> {
    fn toward(&self) -> Vector3<f64> {
        triangle::foot_of(&self.a[0], &self.b).1 - self.a[0]
    }

    fn normals(&self) -> [Vector3<f64>; 2] {
        let n = triangle::normal(&self.b);
        [turned(n, &(self.b[0] - self.a[0])), Vector3::zeros()]
    }

    fn is_never_flat(both: [&Self; 2]) -> bool {
        is_never_flat(both)
    }
}

impl FourVertices for VertexPlaces<1, 3> {
    #[inline(always)]
    fn volume([x, y, z]: [&Self; 3]) -> f64 {
        // The vertex is the origin.
        determinant([&x.b[0], &y.b[1], &z.b[2]])
    }

    fn is_over(both: [&Self; 2], n: &Vector3<f64>) -> bool {
        let doubt = PATH_AREA * size(n);
        let side = |j: usize, k: usize| turn(both.each(|x| [&x.a[0], &x.b[j], &x.b[k]]), n, doubt);
        let first = side(0, 1);
        doubt > 0.0 && first != 0 && side(1, 2) == first && side(2, 0) == first
    }
}

/// Two edges.
impl Parts for VertexPlaces<2, 2> {
    fn toward(&self) -> Vector3<f64> {
        between_edges(&self.a, &self.b)
    }

    fn normals(&self) -> [Vector3<f64>; 2] {
        let [[a, b], [c, d]] = [&self.a, &self.b];
        [turned((b - a).cross(&(d - c)), &(c - a)), Vector3::zeros()]
    }

    fn is_never_flat(both: [&Self; 2]) -> bool {
        is_never_flat(both)
    }
}

impl FourVertices for VertexPlaces<2, 2> {
    #[inline(always)]
    fn volume([x, y, z]: [&Self; 3]) -> f64 {
        // The first end of A is the origin.
        determinant([&x.a[1], &y.b[0], &z.b[1]])
    }

    fn is_over(both: [&Self; 2], n: &Vector3<f64>) -> bool {
        let doubt = PATH_AREA * size(n);
        let of_a = |k: usize| turn(both.each(|x| [&x.a[k], &x.b[0], &x.b[1]]), n, doubt);
        let of_b = |k: usize| turn(both.each(|x| [&x.b[k], &x.a[0], &x.a[1]]), n, doubt);
        doubt > 0.0 && of_a(0) * of_a(1) == -1 && of_b(0) * of_b(1) == -1
    }
}

/// Two triangles.
impl Parts for VertexPlaces<3, 3> {
    fn toward(&self) -> Vector3<f64> {
        let closest = triangle::closest(&self.a, &self.b);
        closest.on_q - closest.on_p
    }

    fn normals(&self) -> [Vector3<f64>; 2] {
        let way = self.b[0] + self.b[1] + self.b[2] - self.a[0] - self.a[1] - self.a[2];
        [&self.a, &self.b].each(|t| turned(triangle::normal(t), &way))
    }
}

fn is_never_flat<P: FourVertices>([x, y]: [&P; 2]) -> bool {
    let signs = volumes(x, y).each(volume_sign);
    signs[0] != 0 && signs.iter().all(|s| *s == signs[0])
}

/// Returns the four Bernstein coefficients of the volume between two times, a cubic in time.
pub(super) fn volumes<P: FourVertices>(x: &P, y: &P) -> [f64; 4] {
    let v = |by: [&P; 3]| P::volume(by);
    [
        v([x, x, x]),
        third([v([y, x, x]), v([x, y, x]), v([x, x, y])]),
        third([v([x, y, y]), v([y, x, y]), v([y, y, x])]),
        v([y, y, y]),
    ]
}

/// Returns the mean of three numbers.
#[inline(always)]
pub(crate) fn third([x, y, z]: [f64; 3]) -> f64 {
    (x + y + z) / 3.0
}

/// Returns the sign of a volume, or zero if rounding hides it.
#[inline(always)]
pub(super) fn volume_sign(volume: f64) -> i32 {
    certain(volume, PATH_VOLUME)
}

/// Returns the vector between points of two edges that are nearly the closest.
fn between_edges([p, q]: &[Vector3<f64>; 2], [r, s]: &[Vector3<f64>; 2]) -> Vector3<f64> {
    // NaN, which edges of length zero give, becomes zero.
    let part = |x: f64| if x > 0.0 { if x < 1.0 { x } else { 1.0 } } else { 0.0 };
    let (u, v, w) = (q - p, s - r, p - r);
    let (uu, vv, uv, uw, vw) = (u.norm_squared(), v.norm_squared(), u.dot(&v), u.dot(&w), v.dot(&w));
    let along = part((uv * vw - uw * vv) / (uu * vv - uv * uv));
    let free = (uv * along + vw) / vv;
    let other = part(free);
    let along = if other == free {
        along
    } else {
        part((uv * other - uw) / uu)
    };
    (r + v * other) - (p + u * along)
}

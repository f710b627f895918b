//! The volume that two solids share, in a proven interval, and the curves in which their surfaces
//! cross.
//!
//! 1. [`surfaces`]: both surfaces are put in one frame. Vertices of B are rounded once, and the
//!    bound has the volume that this may change.
//! 2. [`ties`]: exact signs decide which edges pass through which triangles. Every tie is decided
//!    by one infinitesimal shift of B.
//! 3. [`crossings`]: pairs of triangles from two trees, segments in which they cross, and the
//!    winding numbers of vertices.
//! 4. [`sums`]: terms over faces, edges and segments, in double-double with a counted error.
//! 5. `exact`: terms whose bounds are too wide, again in rationals (feature `exact`).
//! 6. [`loops`]: the segments as closed curves, and the area of each face inside the other body.
//!
//! The shift changes no volume: all directions stay, and the sum is a polynomial of the shift,
//! equal to the volume of the shifted bodies for every small shift. A volume is continuous, so the
//! value at a shift of zero is the volume of the bodies themselves. What is not continuous (curves,
//! areas of flush faces, contact without volume) does depend on the shift.
//!
//! The time grows with the triangles near the other body and with the crossings.
//!
//! Sources: Franklin 1990 computes a volume from local terms of vertices, edges and faces.
//! Departures: the terms have no roots, one division for each crossing, and ties.

mod arithmetic;
mod crossings;
#[cfg(feature = "exact")]
mod exact;
mod loops;
mod sums;
mod surfaces;
mod ties;

use nalgebra::{Point3, Vector3};

use crate::base::num::double_double::{DoubleDouble, two_product};
use crate::base::num::extremes::Extremes;
use crate::base::pose::RelativePose;
use crate::base::tolerance::UNIT;
use crate::body::polyhedron::{exponent_of, power_of_two};
use crate::nonconvex::mesh::Mesh;
use crate::nonconvex::query::state::PosedTrees;

use arithmetic::{Arithmetic, Counted};
use crossings::Crossings;
pub(crate) use loops::merged;
pub use loops::{FaceShare, OverlapLoops};
use sums::{Sums, Term, Total};
use surfaces::Surfaces;

/// Width of a volume, in units of the volume, above which terms are computed again in rationals.
///
/// Double-double reaches it unless faces that cross are parallel to about 1e-9.
const WIDTH: f64 = 1.0 / (1u64 << 40) as f64;

/// Width in units of the cube of the common box that is always good enough.
const LEAST_WIDTH: f64 = WIDTH * WIDTH;

/// The volume that two solids share, with proven bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct OverlapVolume {
    /// Lower bound in the caller's unit cubed.
    ///
    /// It may be negative by rounding, and if triangles of a mesh face inward.
    pub lower: f64,
    /// Upper bound in the caller's unit cubed.
    pub upper: f64,
    /// The centre of mass of the common part, in A's frame.
    ///
    /// It may be outside a common part that is not convex. `None` unless the volume is certainly
    /// positive.
    pub centroid: Option<Point3<f64>>,
    /// Bound of the error of each coordinate of the centroid, in the caller's unit. Zero without a
    /// centroid.
    pub centroid_error: f64,
    /// Whether a winding number other than 0 and 1 was found.
    ///
    /// Then a body covers points twice, or its triangles face inward, and the volume counts each
    /// point by the product of both winding numbers. All vertices near the other body are tested,
    /// and one triangle of each of up to 256 sheets of a mesh (triangles connected over edges of
    /// two). A false does not prove that no sheet crosses another: [`Mesh::inspect`] finds all
    /// crossings.
    pub covers_itself: bool,
}

impl OverlapVolume {
    pub(crate) const NONE: Self = Self {
        lower: 0.0,
        upper: 0.0,
        centroid: None,
        centroid_error: 0.0,
        covers_itself: false,
    };

    /// Returns the middle of the bounds.
    #[must_use]
    pub fn volume(&self) -> f64 {
        0.5 * self.lower + 0.5 * self.upper
    }
}

/// Returns the volume that two solids share.
///
/// Up to `twice`, in the caller's unit cubed, is counted twice.
pub(crate) fn overlap(a: &Mesh, b: &Mesh, pose: &RelativePose, twice: f64) -> OverlapVolume {
    let Some(mut surfaces) = Surfaces::new(a, b, pose) else {
        let is_apart = PosedTrees::far::<()>(a, b, pose).lower > 0.0;
        return if is_apart { OverlapVolume::NONE } else { unknown(a, b) };
    };
    if !surfaces.may_meet() {
        return OverlapVolume::NONE;
    }
    // Exact signs of one position never disagree.
    let Ok(crossings) = Crossings::find(&mut surfaces) else {
        return unknown(a, b);
    };
    let range = around(&[a, b], &surfaces, crossings.range);
    let most = range[1].abs().max(range[0].abs()).max(1);
    let sums = Sums::new(&surfaces, &crossings);
    let terms = sums.terms();
    let mut total = sums.total(&terms);
    // The rounding of vertices moves a surface through points of the other body, each of which
    // counts by its winding number.
    let moved = 6.0 * surfaces.rounding() * f64::from(most);
    narrow(&sums, &terms, &mut total, moved, surfaces.size());
    let unit = a.unit();
    let doubt = moved + 6.0 * (twice / unit / unit / unit);
    let centroid = sums.centroid(&total, doubt);
    total.six.error += moved;
    let (mut lower, upper) = bounds(&total.six, unit);
    if twice > 0.0 {
        lower = (lower - twice).next_down();
    }
    let (centroid, centroid_error) = given(a, centroid.filter(|_| lower > 0.0)).unzip();
    OverlapVolume {
        lower,
        upper,
        centroid,
        centroid_error: centroid_error.unwrap_or(0.0),
        covers_itself: range[0] < 0 || range[1] > 1,
    }
}

/// Returns a centre in the caller's frame and unit, with a bound of the error of each coordinate.
fn given(mesh: &Mesh, centre: Option<(Vector3<f64>, f64)>) -> Option<(Point3<f64>, f64)> {
    let (stored, error) = centre?;
    let centre = mesh.given(&stored);
    let size = stored.amax() * mesh.unit() + centre.coords.amax();
    Some((centre, error * mesh.unit() + 8.0 * UNIT * size + f64::MIN_POSITIVE))
}

/// Returns the curves of two solids; `None` if they are out of range of each other.
pub(crate) fn overlap_loops(a: &Mesh, b: &Mesh, pose: &RelativePose) -> Option<OverlapLoops> {
    let mut surfaces = Surfaces::new(a, b, pose)?;
    if !surfaces.may_meet() {
        return Some(OverlapLoops::default());
    }
    let crossings = Crossings::find(&mut surfaces).ok()?;
    Some(loops::all(&Sums::new(&surfaces, &crossings)))
}

/// Returns bounds of a sixth of a number, in the caller's unit cubed.
fn bounds(six: &Counted, unit: f64) -> (f64, f64) {
    let DoubleDouble { hi, lo } = six.value;
    let cubed = |x: f64| x * unit * unit * unit;
    let sixth = hi / 6.0;
    if six.error == 0.0 && lo == 0.0 && two_product(sixth, 6.0) == (hi, 0.0) {
        return (cubed(sixth), cubed(sixth));
    }
    // Products with the unit are exact unless they leave the normal numbers.
    let down = |x: f64| {
        let y = cubed((x.next_down() / 6.0).next_down());
        if y.abs() < f64::MIN_POSITIVE { y.next_down() } else { y }
    };
    let error = six.error + lo.abs();
    (down(hi - error), -down(-(hi + error)))
}

/// Computes terms again in rationals until the bound is narrow enough.
#[cfg(feature = "exact")]
fn narrow(sums: &Sums, terms: &[Term], total: &mut Total, moved: f64, size: f64) {
    let goal = (WIDTH * total.six.value.hi.abs())
        .larger(LEAST_WIDTH * size * size * size)
        .larger(moved);
    // Written so that NaN is computed again.
    if total.six.error <= goal {
        return;
    }
    let values: alloc::vec::Vec<Counted> = terms.iter().map(|term| sums.counted(term)).collect();
    let errors: alloc::vec::Vec<f64> = values.iter().map(|x| x.error).collect();
    let order = exact::by_error(&errors);
    // The error of the terms that stay, if the first ones are computed again.
    let mut left = alloc::vec![0.0; order.len() + 1];
    for (i, k) in order.iter().enumerate().rev() {
        left[i] = left[i + 1] + errors[*k];
    }
    let again = left.iter().position(|e| *e <= 0.5 * goal).unwrap_or(order.len());
    let mut sum = exact::FixedSum::new(sums.least_exponent());
    for &k in &order[..again] {
        sum.add_term(sums, &terms[k]);
    }
    let rest = order[again..]
        .iter()
        .fold(Counted::default(), |sum, &k| sum.plus(&values[k]));
    sum.add_number(rest.value);
    let (value, error) = sum.total();
    total.six.value = value;
    total.six.error = (error + rest.error + terms.len() as f64 * sums.lost()) * (1.0 + 8.0 * UNIT);
}

/// Without exact arithmetic the bound stays as it is.
#[cfg(not(feature = "exact"))]
fn narrow(_: &Sums, _: &[Term], _: &mut Total, _: f64, _: f64) {}

/// Returns bounds for bodies of which one is far beyond the rounding of the other.
#[cold]
fn unknown(a: &Mesh, b: &Mesh) -> OverlapVolume {
    let size = |mesh: &Mesh| {
        let side = (mesh.high - mesh.low) * mesh.unit();
        side.x * side.y * side.z
    };
    let most = size(a).smaller(size(b)) * (1.0 + 16.0 * UNIT) + f64::MIN_POSITIVE;
    OverlapVolume {
        lower: -most,
        upper: most,
        ..OverlapVolume::NONE
    }
}

/// Largest number of sheets of a mesh of which one triangle is tested.
const SHEETS: usize = 256;

/// Returns the range of the winding numbers that are known.
///
/// They are those of vertices, and on both sides of a triangle of each sheet that lies near the
/// other body.
fn around(meshes: &[&Mesh; 2], surfaces: &Surfaces, mut range: [i32; 2]) -> [i32; 2] {
    for (mesh, surface) in meshes.iter().zip(&surfaces.of) {
        if !mesh.may_cover_itself() {
            continue;
        }
        for t in mesh.first_of_sheets(&surface.near).into_iter().take(SHEETS) {
            if let Some([front, back]) = mesh.sides(t) {
                range = [range[0].min(front), range[1].max(back)];
            }
        }
    }
    range
}

impl Mesh {
    /// Returns bounds of the volume in the caller's unit cubed.
    ///
    /// Both are zero for open meshes. A point with winding number w counts w times, as in
    /// [`volume`](Self::volume).
    ///
    /// ```
    /// use lin_canny::nalgebra::Vector3;
    /// use lin_canny::{Mesh, polyhedron::solids};
    ///
    /// let cube = solids::cuboid(Vector3::new(0.1, 0.2, 0.3))?;
    /// let (lower, upper) = Mesh::from_convex(&cube)?.volume_bounds();
    /// assert!(lower <= 0.048 && 0.048 <= upper && upper - lower < 1e-16);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn volume_bounds(&self) -> (f64, f64) {
        if !self.is_solid() {
            return (0.0, 0.0);
        }
        bounds(&self.counted_moments().0.six, self.unit())
    }

    /// Returns the centre of mass in the caller's unit, and a bound of the error of each
    /// coordinate.
    ///
    /// `None` for open meshes, and unless the volume is certainly positive. A point with winding
    /// number w counts w times, as in [`centroid`](Self::centroid).
    ///
    /// ```
    /// use lin_canny::nalgebra::Vector3;
    /// use lin_canny::{Mesh, polyhedron::solids};
    ///
    /// let cube = solids::cuboid(Vector3::new(0.1, 0.2, 0.3))?;
    /// let mesh = Mesh::from_convex(&cube)?;
    /// let (centre, error) = mesh.centroid_bounds().expect("a solid");
    /// assert!(centre.coords.amax() <= error && error < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn centroid_bounds(&self) -> Option<(Point3<f64>, f64)> {
        if !self.is_solid() {
            return None;
        }
        let (total, middle, unit) = self.counted_moments();
        given(self, total.centre(&middle, unit, [0.0; 2]))
    }

    /// Returns the sum over all triangles, its origin, and the unit of its moments.
    fn counted_moments(&self) -> (Total, Vector3<f64>, f64) {
        let middle = self.low * 0.5 + self.high * 0.5;
        let unit = power_of_two(exponent_of((self.high - self.low).amax().larger(f64::MIN_POSITIVE)));
        let corners = (0..self.triangle_count() as u32).map(|t| self.corners(t));
        (Total::between(corners, &middle, unit), middle, unit)
    }
}

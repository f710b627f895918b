//! Continuous detection: the first contact of vertices on straight paths, proven.
//!
//! Meshes that bend are given by their vertices at the begin and at the end of a frame; in between
//! every vertex moves on a straight line at constant velocity, from time zero to time one. The
//! functions of this module return the first instant at which two edges, a vertex and a face, two
//! triangles, two meshes ([`cast_meshes`]) or a mesh and itself ([`cast_self`]) share a point, as
//! [`impact`](crate::impact) does for bodies that keep their shape: a proven bracket, a proven
//! miss, or a name for what is not decided.
//!
//! ```
//! use lin_canny::continuous::{self, VertexPath};
//! use lin_canny::impact::{Impact, Tolerance};
//! use lin_canny::nalgebra::Point3;
//!
//! let rest = |p: [f64; 3]| VertexPath::new(Point3::from(p), Point3::from(p));
//! let face = [rest([0., 0., 0.]), rest([1., 0., 0.]), rest([0., 1., 0.])];
//! let above = Point3::new(0.2, 0.2, 0.25);
//! let falling = VertexPath::new(above, Point3::new(0.2, 0.2, -0.75));
//! let width = Tolerance::Time(1e-9);
//! let cast = continuous::cast_vertex_face(&falling, &face, width)?;
//! let Impact::Hit { safe, hit, .. } = cast.impact else {
//!     panic!("it falls through")
//! };
//! assert!(safe < 0.25 && 0.25 <= hit && hit - safe <= 1e-9);
//! # Ok::<(), lin_canny::impact::ImpactError>(())
//! ```
//!
//! # Method
//!
//! 1. **Directions.** The height of a vertex along a fixed direction is linear in time. So a
//!    direction along which two sets of vertices are apart at both ends of an interval proves them
//!    apart throughout. Tried are the directions between the closest points at the begin, the
//!    middle and the end, and normals. An interval that no direction proves is halved.
//! 2. **Volumes.** The volume of the four vertices of a pair is a cubic in time. If its Bernstein
//!    coefficients have one sign, the vertices never lie in one plane.
//! 3. **Crossings.** If the vertex projects into the face, or the edges cross as seen along a
//!    direction, over a whole interval (quadratics of one sign), the pair is in contact exactly
//!    when the volume is zero: a change of its sign proves a contact, and secants narrow the
//!    bracket.
//! 4. **Exact arithmetic.** What is left, such as contacts at an edge or at an end of the frame,
//!    and motions in one plane, is decided over the integers: roots of the cubic are isolated and
//!    the signs at the roots are exact. So with the feature `exact`, a touch is told from a near
//!    miss whatever the numbers.
//!
//! 5. **Arcs.** In the frame of a mesh that rotates vertices are on straight paths; in the world a
//!    point is off the straight path between its places at the ends of an interval by at most an
//!    eighth of the square of the interval times its acceleration. So much, and the rounding of
//!    poses, a direction must part beyond.
//! 6. **Height fields.** Of a mesh against itself, parts that no direction can part as they share
//!    vertices are proven at once: seen along one direction, no triangle turns over and the rim
//!    never crosses itself.
//!
//! # Guarantees
//!
//! Results hold for the paths themselves, over the reals, in whatever position the vertices are:
//! faces and edges may be degenerate. [`Impact::Miss`]: no contact from time zero to time one.
//! [`Impact::Hit`]: no contact up to `safe`, and a contact after `safe` and not after `hit`. Unlike
//! solid bodies, surfaces may have passed through each other at `hit`. [`Impact::AtStart`]: in
//! contact at time zero, touching included.
//! Of vertices on straight paths [`Impact::Undecided`] is returned without the feature `exact`
//! alone, and [`Impact::Incomplete`] if exact arithmetic reaches a limit: 65,536 halvings, which no
//! test has met, or in one call 1e8 products of words of integers of more than 1,024 bits.
//! Coordinates that differ by hundreds of magnitudes make such integers; those of twenty magnitudes
//! do not.
//!
//! Points of a body that rotates do not move on straight paths. [`MovingMesh::with_poses`] cuts the
//! frame into intervals in which the arcs are nearly straight, takes off what they are not, and
//! proves a hit at an instant: by an edge that passes through a triangle beyond all rounding.
//!
//! # When not to use it
//!
//! Cast two bodies that keep their shape with [`impact::cast`](crate::impact::cast), which is
//! faster and finds how deep they are.
//!
//! # Sources
//!
//! Provot 1997 (contacts of vertex and face, of edge and edge); Volino and Magnenat-Thalmann 1994
//! (parts that cannot meet themselves); Snyder 1992 and Wang, Ferguson, Schneider, Jiang, Attene
//! and Panozzo 2021 (inclusion of roots, and the kinds of queries that methods fail at); Brochu,
//! Edwards and Bridson 2012 (exact parity of crossings). Departures:
//!
//! 1. A miss is proven by directions; no root of a cubic is looked for, and no box in three
//!    parameters is divided.
//! 2. A hit is proven, not only not excluded: there is no tolerance that makes false hits.
//! 3. Touching is decided, by isolated roots over the integers.
//! 4. That the rim of a part does not cross itself is proven, where most methods leave it out, and
//!    so is that normals stay on one side over the frame.

#[cfg(feature = "exact")]
mod exact;
mod frame;
mod height_field;
mod meshes;
pub(crate) mod paths;
mod search;

pub use frame::MovingMesh;
pub use meshes::{cast_meshes, cast_self};
pub use paths::VertexPath;

use nalgebra::{Point3, Unit, Vector3};

use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{PATH_DIRECTION, PATH_GAP};
use crate::nonconvex::query::triangle;
use crate::pair::outcome::ContactState;
use crate::time::impact::{Cast, Impact, ImpactError, Tolerance};
use crate::time::separation::{Measurement, Tangent};

use paths::{Parts, VertexPaths, VertexPlaces};
use search::{FirstContact, SearchWork};

/// Largest coordinate of a vertex, `2^1000`.
const LARGEST: f64 = f64::from_bits((1023 + 1000) << 52);

/// Returns the first contact of a vertex and a face.
///
/// The vertex is number zero of errors, then the face's follow.
///
/// # Errors
/// If a coordinate is not finite or above `2^1000`, or the tolerance is negative or not finite.
pub fn cast_vertex_face(
    vertex: &VertexPath,
    face: &[VertexPath; 3],
    tolerance: Tolerance,
) -> Result<Cast, ImpactError> {
    cast(&[*vertex], face, tolerance, search::vertex_face)
}

/// Returns the first contact of two edges.
///
/// # Errors
/// If a coordinate is not finite or above `2^1000`, or the tolerance is negative or not finite.
/// Vertices are numbered as given, those of A first.
pub fn cast_edge_edge(a: &[VertexPath; 2], b: &[VertexPath; 2], tolerance: Tolerance) -> Result<Cast, ImpactError> {
    cast(a, b, tolerance, search::edge_edge)
}

/// Returns the first contact of two triangles: of any of their points.
///
/// # Errors
/// If a coordinate is not finite or above `2^1000`, or the tolerance is negative or not finite.
/// Vertices are numbered as given, those of A first.
pub fn cast_triangles(a: &[VertexPath; 3], b: &[VertexPath; 3], tolerance: Tolerance) -> Result<Cast, ImpactError> {
    cast(a, b, tolerance, search::triangles)
}

/// Checks paths and tolerance, asks for the contact, and measures the parts at the safe time.
fn cast<const A: usize, const B: usize>(
    a: &[VertexPath; A],
    b: &[VertexPath; B],
    tolerance: Tolerance,
    contact: fn(&[VertexPath; A], &[VertexPath; B], f64, &mut SearchWork) -> FirstContact,
) -> Result<Cast, ImpactError>
where
    VertexPlaces<A, B>: Parts,
{
    check(a.iter().chain(b))?;
    let mut work = SearchWork::default();
    let width = width(a.iter().chain(b), tolerance)?;
    let found = contact(a, b, width, &mut work);
    let seen = |time: f64, state: ContactState| measure(a, b, time, state);
    Ok(cast_of(found, &work, !cfg!(feature = "exact"), seen))
}

/// Returns what is found as a cast; what is open is near if rounding, or paths that are not quite
/// straight, hide it.
fn cast_of(
    found: FirstContact,
    work: &SearchWork,
    is_near: bool,
    seen: impl Fn(f64, ContactState) -> Measurement,
) -> Cast {
    let impact = match found {
        FirstContact::Miss => Impact::Miss,
        FirstContact::Start => Impact::AtStart {
            seen: seen(0.0, ContactState::Touching),
        },
        FirstContact::Hit { safe, hit } => Impact::Hit {
            safe,
            hit,
            seen: seen(safe, ContactState::Separated),
        },
        FirstContact::Open { safe } if !is_near => Impact::Incomplete { safe },
        FirstContact::Open { safe } => Impact::Undecided {
            safe,
            distance: seen(safe, ContactState::Separated).upper,
        },
    };
    Cast {
        impact,
        queries: work.intervals,
        proofs: work.proofs,
    }
}

/// Refuses coordinates that are not finite or too large.
fn check<'a>(paths: impl Iterator<Item = &'a VertexPath>) -> Result<(), ImpactError> {
    for (index, path) in paths.enumerate() {
        for value in path.start.iter().chain(path.end.iter()) {
            if !(value.abs() <= LARGEST) {
                return Err(ImpactError::Vertex { index, value: *value });
            }
        }
    }
    Ok(())
}

/// Returns the width in time that a tolerance asks for.
fn width<'a>(paths: impl Iterator<Item = &'a VertexPath>, tolerance: Tolerance) -> Result<f64, ImpactError> {
    let (Tolerance::Distance(size) | Tolerance::Time(size)) = tolerance;
    if !(0.0..f64::INFINITY).contains(&size) {
        let what = "tolerance";
        return Err(ImpactError::Size { what, value: size });
    }
    if let Tolerance::Time(width) = tolerance {
        return Ok(width);
    }
    // A distance changes by no more than the ways of two points, each sqrt 3 of its largest
    // coordinate.
    let way = paths.fold(0.0, |m: f64, p| m.larger((p.end - p.start).amax()));
    Ok(if way > 0.0 {
        (0.25 * size / way).at_most(1.0)
    } else {
        1.0
    })
}

/// Returns the closest points of two parts at a time, in the coordinates given.
fn measure<const A: usize, const B: usize>(
    a: &[VertexPath; A],
    b: &[VertexPath; B],
    time: f64,
    state: ContactState,
) -> Measurement
where
    VertexPlaces<A, B>: Parts,
{
    let origin = a[0].at(time).coords;
    let mut measure = Measurement {
        state,
        distance: 0.0,
        lower: 0.0,
        upper: 0.0,
        features: None,
        subshapes: [0; 2],
        point_on_a: Point3::from(origin),
        point_on_b: Point3::from(origin),
        normal: Vector3::z_axis(),
        tangent: Tangent::Free,
        by_plane: false,
    };
    let Some(paths) = VertexPaths::new(a, b) else {
        return measure;
    };
    let places = paths.at(time);
    let [p, q] = places.triangles();
    let closest = triangle::closest(&p, &q);
    let given = |x: &Vector3<f64>| x * paths.unit[0] * paths.unit[1];
    let way = closest.on_q - closest.on_p;
    let length = sqrt(way.norm_squared());
    (measure.point_on_a, measure.point_on_b) = (
        Point3::from(origin + given(&closest.on_p)),
        Point3::from(origin + given(&closest.on_q)),
    );
    let direction = if length > 0.0 { way } else { places.normals()[0] };
    if let Some(normal) = Unit::try_new(direction, PATH_DIRECTION) {
        measure.normal = normal;
    }
    let [one, two] = paths.unit;
    if state == ContactState::Separated {
        measure.distance = length * one * two;
        measure.lower = (places.gap(&measure.normal) * one * two).at_least(0.0);
        measure.upper = (length + 4.0 * PATH_GAP) * one * two;
    }
    measure
}

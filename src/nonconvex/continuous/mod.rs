//! Continuous collision detection: the proven first contact of vertices on straight paths.
//!
//! A deforming mesh is given by its vertices at the start and at the end of a frame. Between, every
//! vertex moves on a straight line at constant velocity, from time zero to time one. The functions
//! of this module return the first time at which two meshes ([`cast_meshes`], with an example) or a
//! mesh and itself ([`cast_self`]) share a point. Like [`impact`](crate::impact) for rigid bodies,
//! they return a proven time interval, a proven miss, or the reason why neither is decided.
//!
//! # Method
//!
//! 1. **Directions.** Along a fixed direction, the coordinate of a vertex is linear in time. So if
//!    a direction separates two sets of vertices at both ends of an interval, it separates them
//!    throughout. The directions tested are normals, and those between the closest points at the
//!    start, the middle and the end. If no direction proves an interval, it is halved.
//! 2. **Volumes.** The volume of the four vertices of a pair is a cubic in time. If its Bernstein
//!    coefficients have one sign, the vertices never lie in one plane.
//! 3. **Crossings.** Suppose that over a whole interval the vertex projects into the face, or the
//!    edges cross as seen along a direction (quadratics of one sign). Then the pair is in contact
//!    exactly when the volume is zero. A change of its sign proves a contact, and the secant method
//!    narrows the interval.
//! 4. **Exact arithmetic.** The remaining cases, such as contacts at an edge, contacts at an end of
//!    the frame, and motions in one plane, are decided over the integers: the roots of the cubic
//!    are isolated, and the signs at the roots are exact. So the feature `exact` distinguishes a
//!    touch from a near miss for all inputs.
//! 5. **Arcs.** In the frame of a rotating mesh its vertices are on straight paths. In the world a
//!    point deviates from the straight path between its positions at the ends of an interval by at
//!    most one eighth of the square of the interval times its acceleration. A separating direction
//!    must leave a gap larger than this plus the rounding of poses.
//! 6. **Height fields.** In a mesh against itself, no direction separates patches that share
//!    vertices. Such patches are proven at once: seen along one direction, no triangle flips and
//!    the boundary never crosses itself.
//!
//! # Guarantees
//!
//! Results hold for the paths themselves, over the real numbers, for all positions of the vertices:
//! faces and edges may be degenerate.
//!
//! - [`Impact::Miss`]: no contact from time zero to time one.
//! - [`Impact::Hit`]: no contact up to `safe`, and a contact after `safe` and not after `hit`.
//!   Unlike solid bodies, surfaces may have passed through each other at `hit`.
//! - [`Impact::AtStart`]: in contact at time zero, touching included.
//! - [`Impact::Undecided`]: for vertices on straight paths, returned only without the feature
//!   `exact`.
//! - [`Impact::Incomplete`]: for vertices on straight paths, exact arithmetic reached a limit. The
//!   limits are 65,536 halvings, which no test has reached, and in one call 1e8 products of words
//!   of integers of more than 1,024 bits. Coordinates that differ by hundreds of orders of
//!   magnitude need such integers; those that differ by twenty do not.
//!
//! Points of a rotating body do not move on straight paths. [`MovingMesh::with_poses`] cuts the
//! frame into intervals in which the arcs are nearly straight, and subtracts their deviation. It
//! proves a hit at one time, by an edge that passes through a triangle beyond all rounding errors.
//!
//! # When not to use it
//!
//! For two rigid bodies use [`impact::cast`](crate::impact::cast): it is faster and returns their
//! depth.
//!
//! # Sources
//!
//! Provot 1997 (contacts of vertex and face, of edge and edge); Volino and Magnenat-Thalmann 1994
//! (patches that cannot meet themselves); Snyder 1992 and Wang, Ferguson, Schneider, Jiang, Attene
//! and Panozzo 2021 (inclusion of roots, and the kinds of queries at which methods fail); Brochu,
//! Edwards and Bridson 2012 (exact parity of crossings). Departures:
//!
//! 1. Directions prove a miss; no root of a cubic is searched for, and no box in three parameters
//!    is divided.
//! 2. A hit is proven, not only not excluded: no tolerance causes false hits.
//! 3. Touching is decided by isolated roots over the integers.
//! 4. For a patch, it is proven that its boundary does not cross itself, and that normals stay on
//!    one side over the frame. Most methods leave out both.

#[cfg(feature = "exact")]
mod exact;
mod frame;
mod height_field;
mod meshes;
pub(crate) mod paths;
mod search;

pub use frame::MovingMesh;
pub use meshes::{cast_meshes, cast_self};

use nalgebra::{Point3, Unit, Vector3};

use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{PATH_DIRECTION, PATH_GAP};
use crate::nonconvex::query::triangle;
use crate::pair::outcome::ContactState;
use crate::time::impact::{Cast, Impact, ImpactError, Tolerance};
use crate::time::separation::{Measurement, Tangent};

use paths::{Parts, VertexPath, VertexPaths, VertexPlaces};
use search::{FirstContact, SearchWork};

/// The searches of two elements, which judges ask without a mesh.
#[cfg(feature = "__internals")]
#[doc(hidden)]
pub mod elements;

/// Returns the result of a search as a cast.
///
/// An open result is `Undecided` if rounding or curved paths hide the answer (`is_near`), and
/// `Incomplete` otherwise.
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
        start_contact: None,
        proofs: work.proofs,
    }
}

/// Returns the interval of time that a tolerance allows.
fn width<'a>(paths: impl Iterator<Item = &'a VertexPath>, tolerance: Tolerance) -> Result<f64, ImpactError> {
    let (Tolerance::Distance(size) | Tolerance::Time(size)) = tolerance;
    if !(0.0..f64::INFINITY).contains(&size) {
        let what = "tolerance";
        return Err(ImpactError::Size { what, value: size });
    }
    if let Tolerance::Time(width) = tolerance {
        return Ok(width);
    }
    // The distance changes by at most the displacements of two points. Each displacement is at most
    // the root of three times its largest coordinate.
    let way = paths.fold(0.0, |m: f64, p| m.larger((p.end - p.start).amax()));
    Ok(if way > 0.0 {
        (0.25 * size / way).at_most(1.0)
    } else {
        1.0
    })
}

/// Returns the closest points of two sides at a time, in the given coordinates.
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

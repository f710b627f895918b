//! Answers of the library to the queries of case files, and their judge.

use cases::queries::{Query, QueryCase};
use cases::suite::SuiteShape;
use lin_canny::impact::{Impact, Tolerance, cast};
use lin_canny::motion::Steady;
use lin_canny::nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use lin_canny::{ConvexPolyhedron, Distance, Geometry, Mesh, PairTracker, PointQuery, Ray, RayCast, RayCaster};
use lin_canny::{RelativePose, Velocity};

use crate::pose::add;
use crate::shapes::Shape;
use crate::{ContactState, Point, Pose, solid};

/// Tolerance of distances and times relative to their sizes.
pub const TOLERANCE: f64 = 1e-12;

/// An answer with bounds of the distance or of the time of the first contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answered {
    /// The state: undecided if rounding hides it.
    pub state: Option<ContactState>,
    /// Lower bound; infinite without a contact.
    pub lower: f64,
    /// Upper bound.
    pub upper: f64,
}

/// Returns a body of a file.
///
/// # Errors
/// Returns the library's error.
pub fn body(shape: &SuiteShape) -> Result<Geometry, String> {
    let points: Vec<Point3<f64>> = shape.shape.points.iter().map(|p| Point3::from(*p)).collect();
    if shape.is_mesh {
        let mesh = Mesh::new(&points, &shape.shape.triangles()).map_err(|e| e.to_string())?;
        return Ok(mesh.into());
    }
    let hull = ConvexPolyhedron::from_points(&points).map_err(|e| e.to_string())?;
    Ok(hull.into())
}

fn isometry(pose: &Pose) -> Isometry3<f64> {
    let [x, y, z, w] = pose.q;
    let q = UnitQuaternion::new_normalize(lin_canny::nalgebra::Quaternion::new(w, x, y, z));
    Isometry3::from_parts(Translation3::from(pose.t), q)
}

fn of_distance(d: &Distance) -> Answered {
    Answered {
        state: match d.state {
            lin_canny::ContactState::Separated => Some(ContactState::Separated),
            lin_canny::ContactState::Touching => Some(ContactState::Touching),
            lin_canny::ContactState::Overlapping => Some(ContactState::Overlapping),
            _ => None,
        },
        lower: d.lower,
        upper: d.upper,
    }
}

fn of_contact(lower: f64, upper: f64) -> Answered {
    Answered {
        state: Some(ContactState::Overlapping),
        lower,
        upper,
    }
}

const MISS: Answered = Answered {
    state: Some(ContactState::Separated),
    lower: f64::INFINITY,
    upper: f64::INFINITY,
};

fn undecided(lower: f64) -> Answered {
    Answered {
        state: None,
        lower,
        upper: f64::INFINITY,
    }
}

fn of_ray(mesh: &Geometry, origin: Point, direction: Point) -> Result<Answered, String> {
    let direction = Vector3::from(direction);
    let length = direction.norm();
    let ray = Ray::new(origin.into(), direction).map_err(|e| e.to_string())?;
    let found = RayCaster::new().cast(mesh, &Isometry3::identity(), &ray, length);
    Ok(match found.map_err(|e| e.to_string())? {
        RayCast::Miss => MISS,
        RayCast::Inside => of_contact(0.0, 0.0),
        RayCast::Hit(hit) => of_contact(hit.safe / length, hit.hit / length),
        RayCast::Undecided { safe } => undecided(safe / length),
        other => return Err(format!("{other:?}")),
    })
}

fn of_cast([a, b]: [&Geometry; 2], poses: [&Pose; 2], velocity: Point) -> Result<Answered, String> {
    let motion = |pose: &Pose, v: Vector3<f64>| {
        Steady::new(&isometry(pose), Velocity::new(v, Vector3::zeros())).map_err(|e| e.to_string())
    };
    let first = motion(poses[0], Vector3::zeros())?;
    let second = motion(poses[1], velocity.into())?;
    let mut tracker = PairTracker::new();
    let tolerance = Tolerance::Distance(1e-11);
    let found = cast(&mut tracker.pair(a, b), &first, &second, 0.0..1.0, tolerance);
    Ok(match found.map_err(|e| e.to_string())?.impact {
        Impact::Miss => MISS,
        Impact::AtStart { .. } => of_contact(0.0, 0.0),
        Impact::Hit { safe, hit, .. } => of_contact(safe, hit),
        Impact::Undecided { safe, .. } | Impact::Incomplete { safe } => undecided(safe),
        other => return Err(format!("{other:?}")),
    })
}

/// Answers a query, given its bodies.
///
/// # Errors
/// Returns the library's error.
pub fn answer(query: &Query, bodies: [&Geometry; 2]) -> Result<Answered, String> {
    match query {
        Query::Point { point, .. } => {
            let found = PointQuery::new(bodies[0]).signed_distance(&Point3::from(*point));
            Ok(of_distance(&found.map_err(|e| e.to_string())?))
        }
        Query::Meshes { pose_a, pose_b, .. } => {
            let pose = RelativePose::new(&isometry(pose_a), &isometry(pose_b)).map_err(|e| e.to_string())?;
            let mut tracker = PairTracker::new();
            let o = tracker.closest(bodies[0], bodies[1], &pose);
            if o.state != lin_canny::ContactState::Overlapping {
                return Ok(of_distance(&Distance::from(&o)));
            }
            let depth = tracker.penetration(bodies[0], bodies[1], &pose).ok_or("no depth")?;
            Ok(of_contact(-depth.upper, -depth.lower))
        }
        Query::Cast {
            pose_a,
            pose_b,
            velocity,
            ..
        } => of_cast(bodies, [pose_a, pose_b], *velocity),
        Query::Ray { origin, direction, .. } => of_ray(bodies[0], *origin, *direction),
    }
}

/// Returns a query whose B or ray is shifted.
fn shifted(query: &Query, by: Point) -> Query {
    let mut near = *query;
    match &mut near {
        Query::Point { point, .. } => *point = add(*point, by),
        Query::Meshes { pose_b, .. } | Query::Cast { pose_b, .. } => pose_b.t = add(pose_b.t, by),
        Query::Ray { origin, .. } => *origin = add(*origin, by),
    }
    near
}

/// Judges an answer, given the bodies by their numbers.
///
/// Rounded poses and unit directions move bodies by some 1e-16 of their size. So another state is
/// right if it is the exact answer of a query that is shifted by the tolerance, or touching if the
/// shift changes the state.
///
/// # Errors
/// Returns what is wrong.
///
/// # Panics
/// Panics if the case has no exact answer.
pub fn judge<'s>(case: &QueryCase, found: &Answered, shape: impl Fn(usize) -> &'s Shape) -> Result<(), String> {
    let (query, truth) = (&case.query, case.truth.as_ref().expect("an exact answer"));
    let is_time = matches!(query, Query::Cast { .. } | Query::Ray { .. });
    // Slow bodies take longer for the same length.
    let scale = match query {
        Query::Cast { velocity: v, .. } | Query::Ray { direction: v, .. } => crate::pose::norm(*v).recip(),
        _ => 1.0,
    };
    let slack = TOLERANCE * truth.size;
    let wrong = |what: &str| Err(format!("{what}: {found:?}, not {truth:?}"));
    if let Some([value, _]) = truth.value
        && found.state != Some(ContactState::Separated)
        && (found.lower > value + slack * scale || found.upper < value - slack * scale)
    {
        return wrong("bounds");
    }
    let Some(state) = found.state else {
        return if is_time { Ok(()) } else { wrong("state") };
    };
    let axes = [0, 1, 2, 3, 4, 5, 6, 7].map(|k: usize| [0, 1, 2].map(|i| if k >> i & 1 == 1 { slack } else { -slack }));
    let is_near = || {
        axes.iter().any(|by| {
            let other = solid::solve(&shifted(query, *by), &shape).state;
            other == state || state == ContactState::Touching && other != truth.state
        })
    };
    if state == truth.state || truth.state == ContactState::Touching && is_time || is_near() {
        Ok(())
    } else {
        wrong("state")
    }
}

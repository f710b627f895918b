//! One pair of every kind that supports casts, of any size, and user-defined motions.

use crate::Rng;
use lin_canny::motion::{Motion, MotionModel, Remainder};
use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::separation::Separation;
use lin_canny::surface::{BezierSurface, revolution};
use lin_canny::{Compound, ConvexPolyhedron, Mesh, Shape};
use lin_canny::{PairTracker, Tracker};

/// Largest coordinate of surfaces.
const SURFACE_MAX: f64 = f64::from_bits((1023 + 200) << 52);

/// Bodies from -1/2 to 1/2 along x, times a size, at any rotation about x.
pub(crate) struct Bodies {
    hull: ConvexPolyhedron,
    ball: Shape,
    cone: Shape,
    pieces: Compound,
    mesh: Mesh,
    surface: Option<BezierSurface>,
}

impl Bodies {
    pub(crate) fn new(size: f64) -> Self {
        let half = Vector3::new(0.5, 0.4, 0.3) * size;
        let (r, h) = (0.5 * size, std::f64::consts::FRAC_1_SQRT_2);
        let south: &[[f64; 3]] = &[[0.0, -r, 1.0], [r, -r, h], [r, 0.0, 1.0]];
        let north: &[[f64; 3]] = &[[r, 0.0, 1.0], [r, r, h], [0.0, r, 1.0]];
        Self {
            hull: solids::cuboid(half).expect("a cuboid"),
            ball: Shape::ball(r).expect("a ball"),
            cone: Shape::ellipsoid(half).expect("an ellipsoid"),
            pieces: Compound::from(Shape::cuboid(half).expect("a cuboid")),
            mesh: truth::forms::mesh(&truth::soups::cuboid((-half).into(), half.into())),
            surface: (size <= SURFACE_MAX).then(|| revolution(&[south, north]).expect("a sphere")),
        }
    }

    /// Calls with a pair of every kind, without surfaces if the size exceeds their range.
    pub(crate) fn each(&self, mut call: impl FnMut(&str, &mut dyn Separation)) {
        let Self {
            hull,
            ball,
            cone,
            pieces,
            mesh,
            surface,
        } = self;
        call("polyhedra", &mut Tracker::new().pair(hull, hull));
        call("shapes", &mut PairTracker::new().pair(ball, cone));
        call("compounds", &mut PairTracker::new().pair(pieces, pieces));
        call("compound and mesh", &mut PairTracker::new().pair(pieces, mesh));
        call("meshes", &mut PairTracker::new().pair(mesh, mesh));
        let Some(surface) = surface else { return };
        call("surfaces", &mut PairTracker::new().pair(surface, surface));
        call("surface and shape", &mut PairTracker::new().pair(surface, ball));
        call("shape and surface", &mut PairTracker::new().pair(ball, surface));
        call("surface and compound", &mut PairTracker::new().pair(surface, pieces));
        call("mesh and surface", &mut PairTracker::new().pair(mesh, surface));
    }
}

/// A user-defined motion: a fall from a pose with a velocity and a constant rotation, with the
/// simplest bounds.
#[derive(Clone, Copy)]
pub(crate) struct Fall {
    pub(crate) start: Isometry3<f64>,
    pub(crate) linear: Vector3<f64>,
    pub(crate) angular: Vector3<f64>,
    pub(crate) gravity: Vector3<f64>,
    /// Whether the model states the acceleration, or only bounds the deviation by it.
    pub(crate) is_named: bool,
}

impl Fall {
    pub(crate) fn still() -> Self {
        Self {
            start: Isometry3::identity(),
            linear: Vector3::zeros(),
            angular: Vector3::zeros(),
            gravity: Vector3::zeros(),
            is_named: true,
        }
    }

    pub(crate) fn random(rng: &mut Rng) -> Self {
        Self {
            start: Isometry3::from(Vector3::from(rng.unit()) * rng.range(1.5, 4.0)),
            linear: Vector3::from(rng.in_ball()),
            angular: Vector3::from(rng.in_ball()),
            gravity: Vector3::from(rng.in_ball()),
            is_named: rng.chance(0.5),
        }
    }
}

impl Motion for Fall {
    fn pose(&self, time: f64) -> Isometry3<f64> {
        let at = self.start.translation.vector + (self.linear + self.gravity * (0.5 * time)) * time;
        let turn = UnitQuaternion::from_scaled_axis(self.angular * time) * self.start.rotation;
        Isometry3::from_parts(at.into(), UnitQuaternion::new_normalize(turn.into_inner()))
    }

    fn model(&self, time: f64, span: f64) -> MotionModel {
        let last = time.abs() + span;
        let way = self.start.translation.vector.amax() + (self.linear.amax() + self.gravity.amax() * last) * last;
        let unknown = if self.is_named { 0.0 } else { self.gravity.norm() };
        let angle = 1.0 + self.angular.amax() * last;
        MotionModel {
            pivot: Point3::origin(),
            linear: self.linear + self.gravity * time,
            angular: self.angular,
            acceleration: if self.is_named { self.gravity } else { Vector3::zeros() },
            shift: Remainder([16.0 * f64::EPSILON * way, 0.0, unknown, 0.0]),
            turn: Remainder([32.0 * f64::EPSILON * angle, 0.0, 0.0, 0.0]),
        }
    }
}

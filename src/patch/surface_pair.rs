//! Two surfaces and their tracker, at a pose and over time. One of both may stand for a mesh, whose
//! inside counts if the mesh is a solid.

use crate::patch::separation::MEASURED;
use nalgebra::Point3;

use super::search::NetGoal;
use super::separation::{held, width_asked};
use super::surface::Surface;
use super::tracker::SurfaceTracker;
use crate::base::num::scalar::sqrt;
use crate::base::pose::{Operand, RelativePose};
use crate::base::tolerance::{CERTIFICATE, SURFACE_POINT, UNIT};
use crate::composite::mesh::Mesh;
use crate::pair::outcome::{Class, Decision, Outcome};
use crate::pair::question::Question;
use crate::pair::spot::{Answer, Spot};
use crate::time::separation::{Flight, Free, Measure, Separation};

/// Two surfaces that can be measured over time.
#[derive(Debug)]
pub(crate) struct SurfacePair<'a> {
    pub(crate) a: &'a Surface,
    pub(crate) b: &'a Surface,
    /// The mesh for which one of the surfaces stands, and which one.
    pub(crate) mesh: Option<(Operand, &'a Mesh)>,
    pub(crate) tracker: &'a mut SurfaceTracker,
}

/// Where a surface lies that does not meet the triangles of a mesh.
enum Side {
    Outside,
    /// In the mesh, with this point.
    Inside(Spot, Point3<f64>),
    /// A point is too close to the triangles, or every segment to the outside met an edge.
    Unclear,
}

impl SurfacePair<'_> {
    /// Returns the closest points, with bounds of the width that the question sets.
    pub(crate) fn ask(&mut self, pose: &RelativePose, question: &Question) -> Answer {
        let width = width_asked(self, question);
        self.tracker.allow(question.splits);
        self.answer(pose, NetGoal::Width(width)).without_depth()
    }

    /// Returns whether the distance is at most `d`, within the splits that the question allows.
    pub(crate) fn ask_within(&mut self, pose: &RelativePose, d: f64, question: &Question) -> Decision {
        self.tracker.allow(question.splits);
        self.is_within(pose, d)
    }

    /// Returns whether the distance is at most `d`.
    fn is_within(&mut self, pose: &RelativePose, d: f64) -> Decision {
        let decision = self.tracker.within(self.a, self.b, pose, d);
        if !(d >= 0.0) || decision.is_yes() {
            return decision;
        }
        match self.side(pose) {
            Side::Outside => decision,
            Side::Inside(..) => Decision::Yes,
            Side::Unclear => match decision {
                Decision::Undecided { upper, .. } => Decision::Undecided { lower: 0.0, upper },
                // Farther apart than d, or inside.
                _ => Decision::Undecided {
                    lower: 0.0,
                    upper: self.tracker.answer(self.a, self.b, pose, NetGoal::Part(MEASURED)).upper,
                },
            },
        }
    }

    fn answer(&mut self, pose: &RelativePose, goal: NetGoal) -> Answer {
        let found = self.tracker.answer(self.a, self.b, pose, goal);
        match found.class {
            Class::Separated => match self.side(pose) {
                Side::Outside => found,
                Side::Inside(spot, point) => self.inside(found, (spot, point), pose),
                Side::Unclear => Answer {
                    outcome: Outcome {
                        class: Class::Undecided,
                        lower: 0.0,
                        ..found.outcome
                    },
                    is_reached: false,
                    ..found
                },
            },
            _ => found,
        }
    }

    /// Returns the answer of a surface that has a point within the mesh.
    fn inside(&self, found: Answer, (spot, point): (Spot, Point3<f64>), pose: &RelativePose) -> Answer {
        let mut answer = found;
        let o = &mut answer.outcome;
        (o.class, o.distance, o.lower, o.upper) = (Class::Overlapping, 0.0, 0.0, 0.0);
        let is_mesh_a = matches!(self.mesh, Some((Operand::A, _)));
        let [from, to] = if is_mesh_a { [1, 0] } else { [0, 1] };
        answer.on[from] = spot;
        let there = moved(&point, pose, is_mesh_a);
        [o.point_on_a, o.point_on_b] = if is_mesh_a { [there, point] } else { [point, there] };
        if from == 0 {
            o.features.a = spot.feature;
        } else {
            o.features.b = spot.feature;
        }
        answer.on[to] = found.on[to];
        answer.is_reached = true;
        answer
    }

    /// Returns where the surface lies beside the mesh: a patch that does not meet the triangles
    /// lies on one side of them, so one point of each patch tells.
    fn side(&self, pose: &RelativePose) -> Side {
        let Some((operand, mesh)) = self.mesh.filter(|(_, mesh)| mesh.is_solid()) else {
            return Side::Outside;
        };
        let is_mesh_a = operand == Operand::A;
        let surface = if is_mesh_a { self.b } else { self.a };
        let reach = sqrt(pose.translation().norm_squared()) + surface.reach;
        // The rounding of a point of the surface, and of its place in the frame of the mesh.
        let doubt = surface.reach * SURFACE_POINT + CERTIFICATE * UNIT * reach;
        let unit = mesh.unit();
        let mut is_clear = true;
        for (patch, net) in (0..).zip(surface.patches()) {
            let point = net.point(0.0, 0.0);
            let place = moved(&point, pose, is_mesh_a);
            match mesh.holds_point(&(place.coords / unit), doubt / unit) {
                Some(true) => return Side::Inside(Spot::on_patch(patch, [0.0; 2]), point),
                Some(false) => {}
                None => is_clear = false,
            }
        }
        if is_clear { Side::Outside } else { Side::Unclear }
    }
}

/// Returns a point of B in A's frame, or of A in B's.
fn moved(point: &Point3<f64>, pose: &RelativePose, is_of_b: bool) -> Point3<f64> {
    let (rotation, t) = (pose.rotation(), pose.translation());
    Point3::from(if is_of_b {
        rotation * point.coords + t
    } else {
        rotation.tr_mul(&(point.coords - t))
    })
}

impl Separation for SurfacePair<'_> {
    fn ball(&self, of: Operand) -> (Point3<f64>, f64) {
        if of == Operand::A { self.a } else { self.b }.bounding_ball()
    }

    fn measure(&mut self, a_from_b: &RelativePose) -> Measure {
        Measure::from(&self.answer(a_from_b, NetGoal::Part(MEASURED)))
    }

    fn meets(&mut self, a_from_b: &RelativePose, distance: f64, _: &Measure) -> bool {
        self.is_within(a_from_b, distance).is_yes()
    }

    fn free_for(&mut self, seen: &Measure, flight: &Flight) -> Free {
        held(self, seen, flight, |pair, pose, width| {
            pair.answer(pose, NetGoal::Width(width)).lower
        })
    }
}

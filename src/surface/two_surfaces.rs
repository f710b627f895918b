//! Two surfaces: the state of the pair and its queries ([`SurfaceTracker`]), and the pair at a pose
//! and over time ([`SurfacePair`]).
//!
//! One of the surfaces may represent a mesh. If the mesh is a solid, its inside belongs to the
//! body.

use nalgebra::{Point3, Unit, Vector3};

use super::bezier_surface::{BezierSurface, SurfaceWork};
use super::closest::{Patches, crosses};
use super::gap::{NetFrame, SearchWork, Trees};
use super::search::{NetGoal, SPLITS, SurfaceMemory};
use super::surface_and_solid::{MEASURED, held, width_of};
use super::tree::{Grown, Nodes};
use crate::base::num::each::Each;
use crate::base::num::extremes::Bounded;
use crate::base::num::scalar::sqrt;
use crate::base::pose::{Operand, RelativePose};
use crate::base::tolerance::{CERTIFICATE, SURFACE_POINT, UNIT};
use crate::nonconvex::mesh::Mesh;
use crate::pair::draft::far;
use crate::pair::location::{PairOutcome, WitnessLocation, features_on};
use crate::pair::options::QueryOptions;
use crate::pair::outcome::{ContactState, Decision, Outcome};
use crate::time::separation::{FreeSpan, Measurement, PairMotion, Separation};

/// If the split nodes of a surface have more numbers than this (16 MB), the next query drops them.
pub(super) const KEPT: usize = 1 << 21;

/// State of a pair of surfaces: the front of the last outcome, from which the next query starts,
/// the nodes made so far, and counters.
///
/// The tracker owns no surface. Its state changes the time of a query, never which distances an
/// outcome allows, because bounds are proven again at every pose. State of another pair, or of an
/// old pose, does no harm. The state is not serialised: one query makes the nodes again, and a
/// front is much larger than its surfaces. A query allocates memory if it splits nodes.
#[derive(Clone, Debug, Default)]
pub(crate) struct SurfaceTracker {
    state: SurfaceMemory,
    grown: [Grown; 2],
}

/// The result of a search.
struct Found {
    lower: f64,
    upper: f64,
    on: [WitnessLocation; 2],
    points: [Point3<f64>; 2],
    normal: Unit<Vector3<f64>>,
    distance: f64,
    shares: bool,
}

impl SurfaceTracker {
    /// Sets the number of pairs of nodes that a query may split; `None` for the default budget.
    pub(crate) fn allow(&mut self, splits: Option<usize>) {
        self.state.allow(splits.unwrap_or(SPLITS));
    }

    /// Returns the work of all queries so far.
    #[must_use]
    pub(crate) fn work(&self) -> SurfaceWork {
        self.state.work
    }

    /// Returns the number of entries of the cached front.
    #[must_use]
    pub(crate) fn front_len(&self) -> usize {
        self.state.front.entries.len()
    }

    /// Returns the cached front of these surfaces: pairs of parts of A and of B that are proven
    /// apart and cover every pair of patches. Empty if the last query was of other surfaces.
    #[cfg(feature = "__internals")]
    pub(crate) fn front<'t>(
        &'t self,
        a: &'t BezierSurface,
        b: &'t BezierSurface,
    ) -> impl Iterator<Item = [super::SurfacePart; 2]> + 't {
        let entries = self.state.entries([a.fingerprint, b.fingerprint]);
        let part = |s: &BezierSurface, grown: &Grown, id: u32| super::SurfacePart::of(grown.node(&s.tree, id));
        entries.iter().map(move |e| {
            let [x, y] = e.pair;
            [part(a, &self.grown[0], x), part(b, &self.grown[1], y)]
        })
    }

    /// Returns the bytes on the heap.
    #[must_use]
    pub(crate) fn memory_usage(&self) -> usize {
        self.grown.iter().map(Grown::memory_usage).sum::<usize>() + self.state.memory_usage()
    }

    /// Returns the closest points with bounds as close as the goal requires.
    pub(super) fn answer(
        &mut self,
        a: &BezierSurface,
        b: &BezierSurface,
        a_from_b: &RelativePose,
        goal: NetGoal,
    ) -> PairOutcome {
        let found = self.search(a, b, a_from_b, goal);
        let state = if found.lower > 0.0 {
            ContactState::Separated
        } else if found.shares {
            ContactState::Touching
        } else {
            ContactState::Undecided
        };
        let outcome = Outcome {
            state,
            distance: found.distance.clamped(found.lower, found.upper),
            lower: found.lower,
            upper: found.upper,
            point_on_a: found.points[0],
            point_on_b: found.points[1],
            normal: found.normal,
            ..Outcome::starting_at(features_on(&found.on))
        };
        PairOutcome {
            outcome,
            locations: found.on,
            is_converged: goal.is_converged(found.lower, found.upper),
        }
    }

    /// Decides whether the distance of the surfaces is at most `d`, a length in the caller's unit.
    /// Undecided only if `d` is within rounding of the distance, or if the budget is too small.
    ///
    /// If one surface crosses the other inside two patches, an existence theorem proves that they
    /// share a point. For a `d` of zero, surfaces that merely touch stay undecided. So do surfaces
    /// that are close over an area, if the budget is too small.
    pub(crate) fn within(&mut self, a: &BezierSurface, b: &BezierSurface, a_from_b: &RelativePose, d: f64) -> Decision {
        if !(d >= 0.0) {
            return Decision::No;
        }
        let found = self.search(a, b, a_from_b, NetGoal::Within(d));
        let upper = if found.shares { 0.0 } else { found.upper };
        Decision::by(found.lower, upper, d)
    }

    fn search(&mut self, a: &BezierSurface, b: &BezierSurface, a_from_b: &RelativePose, goal: NetGoal) -> Found {
        let is_full = self.grown.iter().any(|g| g.numbers() > KEPT);
        if !self.state.recognises([a.fingerprint, b.fingerprint], is_full) {
            self.grown = Default::default();
        }
        let reach = [a.reach, b.reach];
        let points = reach[0] * SURFACE_POINT + reach[1] * SURFACE_POINT;
        let Some(frame) = NetFrame::new(reach, points, a_from_b) else {
            return apart(a, b, a_from_b);
        };
        let [grown_a, grown_b] = &mut self.grown;
        let mut trees = Trees {
            a: Nodes::new(&a.tree, grown_a),
            b: Nodes::new(&b.tree, grown_b),
            frame: &frame,
            counts: SearchWork::default(),
        };
        let mut points = Patches {
            a: a.patches(),
            b: b.patches(),
            frame: &frame,
        };
        let Some((lower, best)) = self.state.search(&mut trees, &mut points, goal) else {
            return apart(a, b, a_from_b);
        };
        let shares =
            lower == 0.0 && best.distance <= frame.limit && crosses(&points.pair(best.patches), &best, frame.limit);
        Found {
            lower,
            upper: best.upper,
            on: [0, 1].each(|k| best.place(k)),
            points: [best.on_a.into(), best.on_b.into()],
            normal: Unit::new_unchecked(best.normal.unwrap_or_else(Vector3::x)),
            distance: best.distance,
            shares,
        }
    }
}

/// Returns the result for surfaces so far apart, or so small, that only balls around their origins
/// count.
fn apart(a: &BezierSurface, b: &BezierSurface, a_from_b: &RelativePose) -> Found {
    let (lower, upper, n) = far([a.reach, b.reach], a_from_b);
    Found {
        lower,
        upper,
        on: [WitnessLocation::on_patch(0, [0.0; 2]); 2],
        points: [a, b].each(|s| s.patches()[0].point(0.0, 0.0)),
        normal: Unit::new_unchecked(n),
        distance: 0.5 * lower + 0.5 * upper,
        shares: false,
    }
}

/// Two surfaces that can be measured over time.
#[derive(Debug)]
pub(crate) struct SurfacePair<'a> {
    pub(crate) a: &'a BezierSurface,
    pub(crate) b: &'a BezierSurface,
    /// The mesh that one of the surfaces represents, and the operand.
    pub(crate) mesh: Option<(Operand, &'a Mesh)>,
    pub(crate) tracker: &'a mut SurfaceTracker,
}

/// The side of a mesh on which a surface lies that does not meet the triangles.
enum Side {
    Outside,
    /// Inside the mesh, with this point.
    Inside(WitnessLocation, Point3<f64>),
    /// A point is too close to the triangles, or every segment to the outside met an edge.
    Unclear,
}

impl SurfacePair<'_> {
    /// Returns the closest points, with bounds of the width that the options set.
    pub(crate) fn closest_with(&mut self, pose: &RelativePose, question: &QueryOptions) -> PairOutcome {
        let width = width_of(self, pose, question);
        self.tracker.allow(question.splits);
        self.answer(pose, NetGoal::Width(width)).without_depth()
    }

    /// Returns whether the distance is at most `d`, within the budget that the options set.
    pub(crate) fn decide_within(&mut self, pose: &RelativePose, d: f64, question: &QueryOptions) -> Decision {
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
                // Farther apart than `d`, or inside.
                _ => Decision::Undecided {
                    lower: 0.0,
                    upper: self.tracker.answer(self.a, self.b, pose, NetGoal::Part(MEASURED)).upper,
                },
            },
        }
    }

    fn answer(&mut self, pose: &RelativePose, goal: NetGoal) -> PairOutcome {
        let found = self.tracker.answer(self.a, self.b, pose, goal);
        match found.state {
            ContactState::Separated => match self.side(pose) {
                Side::Outside => found,
                Side::Inside(spot, point) => self.inside(found, spot, point, pose),
                Side::Unclear => PairOutcome {
                    outcome: Outcome {
                        state: ContactState::Undecided,
                        lower: 0.0,
                        ..found.outcome
                    },
                    is_converged: false,
                    ..found
                },
            },
            _ => found,
        }
    }

    /// Returns the outcome of a surface that has a point inside the mesh.
    fn inside(
        &self,
        found: PairOutcome,
        spot: WitnessLocation,
        point: Point3<f64>,
        pose: &RelativePose,
    ) -> PairOutcome {
        let mut answer = found;
        let o = &mut answer.outcome;
        (o.state, o.distance, o.lower, o.upper) = (ContactState::Overlapping, 0.0, 0.0, 0.0);
        let is_mesh_a = matches!(self.mesh, Some((Operand::A, _)));
        let [from, to] = if is_mesh_a { [1, 0] } else { [0, 1] };
        answer.locations[from] = spot;
        let there = moved(&point, pose, is_mesh_a);
        [o.point_on_a, o.point_on_b] = if is_mesh_a { [there, point] } else { [point, there] };
        if from == 0 {
            o.features.a = spot.feature;
        } else {
            o.features.b = spot.feature;
        }
        answer.locations[to] = found.locations[to];
        answer.is_converged = true;
        answer
    }

    /// Returns the side of the mesh on which the surface lies. A patch that does not meet the
    /// triangles lies on one side of them, so one point of each patch decides.
    fn side(&self, pose: &RelativePose) -> Side {
        let Some((operand, mesh)) = self.mesh.filter(|(_, mesh)| mesh.is_solid()) else {
            return Side::Outside;
        };
        let is_mesh_a = operand == Operand::A;
        let surface = if is_mesh_a { self.b } else { self.a };
        let reach = sqrt(pose.translation().norm_squared()) + surface.reach;
        // The rounding of a point of the surface, and of its position in the frame of the mesh.
        let doubt = surface.reach * SURFACE_POINT + CERTIFICATE * UNIT * reach;
        let unit = mesh.unit();
        let mut is_clear = true;
        for (patch, net) in (0..).zip(surface.patches()) {
            let point = net.point(0.0, 0.0);
            let place = moved(&point, pose, is_mesh_a);
            match mesh.holds_point(&mesh.frame.stored(&place), doubt / unit) {
                Some(true) => return Side::Inside(WitnessLocation::on_patch(patch, [0.0; 2]), point),
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

// As that of `SurfaceSolidPair`: each function is one call. A common implementation would need a
// trait of these calls, and be longer.
impl Separation for SurfacePair<'_> {
    fn ball(&self, of: Operand) -> (Point3<f64>, f64) {
        if of == Operand::A { self.a } else { self.b }.bounding_ball()
    }

    fn measure(&mut self, a_from_b: &RelativePose) -> Measurement {
        Measurement::from(&self.answer(a_from_b, NetGoal::Part(MEASURED)))
    }

    fn meets(&mut self, a_from_b: &RelativePose, distance: f64, _: &Measurement) -> bool {
        self.is_within(a_from_b, distance).is_yes()
    }

    fn free_for(&mut self, seen: &Measurement, flight: &PairMotion) -> FreeSpan {
        held(self, seen, flight, |pair, pose, width| {
            let found = pair.answer(pose, NetGoal::Width(width));
            [found.lower, found.upper]
        })
    }
}

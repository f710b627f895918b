//! A pair of any kinds over time.

use alloc::string::String;

use nalgebra::{Point3, Vector3};

use super::pair::{Asked, BallPair};
use crate::base::pose::{Operand, RelativePose};
use crate::body::polyhedron::ConvexPolyhedron;
use crate::composite::penetration::PenetrationBounds;
use crate::composite::separation::{CompositePair, MeshPair};
use crate::convex::tracker::Tracker;
use crate::pair::outcome::Decision;
use crate::pair::question::Question;
use crate::pair::spot::Answer;
use crate::patch::{SurfaceCompositeTracker, SurfacePair, SurfaceShapeTracker, SurfaceSolidPair};
use crate::time::separation::{Flight, Free, Measure, PolyhedronPair, Separation, ShapePair, SupportPoint};

/// Two geometries that can be measured over time, followed by a borrowed tracker: what
/// [`impact`](crate::impact) asks.
#[derive(Debug)]
pub struct OverTime<'p>(pub(super) Kinds<'p>);

#[derive(Debug)]
#[allow(clippy::large_enum_variant, reason = "polyhedra, the usual pair, stay in place")]
pub(super) enum Kinds<'p> {
    Polyhedra(PolyhedronPair<'p>),
    Balls(BallPair),
    Convex(ShapePair<'p>),
    Pieces(CompositePair<'p>),
    Triangles(MeshPair<'p>),
    Surfaces(SurfacePair<'p>),
    SurfaceAndShape(SurfaceSolidPair<'p, SurfaceShapeTracker>),
    SurfaceAndPieces(SurfaceSolidPair<'p, SurfaceCompositeTracker>),
}

macro_rules! each {
    ($over:expr, $pair:ident => $result:expr) => {
        match $over {
            Kinds::Polyhedra($pair) => $result,
            Kinds::Balls($pair) => $result,
            Kinds::Convex($pair) => $result,
            Kinds::Pieces($pair) => $result,
            Kinds::Triangles($pair) => $result,
            Kinds::Surfaces($pair) => $result,
            Kinds::SurfaceAndShape($pair) => $result,
            Kinds::SurfaceAndPieces($pair) => $result,
        }
    };
}

impl Separation for OverTime<'_> {
    fn ball(&self, of: Operand) -> (Point3<f64>, f64) {
        each!(&self.0, pair => pair.ball(of))
    }

    fn measure(&mut self, a_from_b: &RelativePose) -> Measure {
        each!(&mut self.0, pair => pair.measure(a_from_b))
    }

    fn meets(&mut self, a_from_b: &RelativePose, distance: f64, seen: &Measure) -> bool {
        each!(&mut self.0, pair => pair.meets(a_from_b, distance, seen))
    }

    fn support(&mut self, of: Operand, direction: &Vector3<f64>) -> SupportPoint {
        each!(&mut self.0, pair => pair.support(of, direction))
    }

    fn free_for(&mut self, seen: &Measure, flight: &Flight) -> Free {
        each!(&mut self.0, pair => pair.free_for(seen, flight))
    }
}

impl Asked for OverTime<'_> {
    fn answer(&mut self, pose: &RelativePose, question: &Question) -> Answer {
        each!(&mut self.0, pair => pair.answer(pose, question))
    }

    fn within(&mut self, pose: &RelativePose, d: f64, question: &Question) -> Decision {
        each!(&mut self.0, pair => pair.within(pose, d, question))
    }

    fn lower_bound(&mut self, pose: &RelativePose) -> f64 {
        each!(&mut self.0, pair => pair.lower_bound(pose))
    }

    fn penetration(&mut self, pose: &RelativePose) -> Option<PenetrationBounds> {
        each!(&mut self.0, pair => pair.penetration(pose))
    }

    fn check(&self, pose: &RelativePose) -> Result<(), String> {
        each!(&self.0, pair => pair.check(pose))
    }
}

impl Tracker {
    /// Returns two polyhedra that can be measured over time, followed by this tracker.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::separation::Separation;
    /// use lin_canny::{RelativePose, Tracker, polyhedron::solids};
    ///
    /// let a = solids::cuboid(Vector3::new(1.0, 1.0, 1.0))?;
    /// let b = solids::octahedron(0.5)?;
    /// let mut tracker = Tracker::new();
    /// let mut pair = tracker.over(&a, &b);
    /// let pose = Isometry3::translation(3.0, 0.0, 0.0);
    /// let seen = pair.measure(&RelativePose::from_isometry(&pose)?);
    /// assert!(seen.lower <= 1.5 && 1.5 <= seen.upper);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn over<'p>(&'p mut self, a: &'p ConvexPolyhedron, b: &'p ConvexPolyhedron) -> OverTime<'p> {
        OverTime(Kinds::Polyhedra(PolyhedronPair::new(a, b, self)))
    }
}

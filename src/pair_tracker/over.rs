//! A pair of any kinds over time.

use alloc::string::String;
use core::any::Any;

use nalgebra::{Point3, Vector3};

use super::engine::BodyShapes;
use super::pair::{Asked, BallPair};
use super::tracked::{AnyKinds, PairOfKinds};
use crate::base::pose::{Operand, RelativePose};
use crate::body::polyhedron::ConvexPolyhedron;
#[cfg(feature = "meshes")]
use crate::composite::penetration::PenetrationBounds;
use crate::convex::tracker::Tracker;
use crate::pair::outcome::Decision;
use crate::pair::question::Question;
use crate::pair::spot::Answer;
use crate::time::separation::{Flight, Free, Measure, PolyhedronPair, Separation, ShapePair, SupportPoint};

/// Two geometries that can be measured over time, followed by a borrowed tracker: what
/// [`impact`](crate::impact) asks.
#[derive(Debug)]
pub struct OverTime<'p>(pub(super) Kinds<'p>);

#[derive(Debug)]
pub(super) enum Kinds<'p> {
    Polyhedra(PolyhedronPair<'p>),
    Convex(ShapePair<'p>),
    Balls(BallPair),
    Mixed {
        bodies: BodyShapes<'p>,
        tracker: &'p mut dyn AnyKinds,
    },
}

impl OverTime<'_> {
    /// Asks the pair, behind one interface.
    fn asked<R>(&mut self, mut ask: impl FnMut(&mut dyn Asked) -> R) -> R {
        match &mut self.0 {
            Kinds::Polyhedra(pair) => ask(pair),
            Kinds::Convex(pair) => ask(pair),
            Kinds::Balls(pair) => ask(pair),
            Kinds::Mixed { bodies, tracker } => {
                let mut answer = None;
                tracker.ask(*bodies, &mut |pair| answer = Some(ask(pair)));
                // Geometries for which the tracker was not made are known by their balls.
                answer.unwrap_or_else(|| ask(&mut BallPair::new(*bodies)))
            }
        }
    }

    /// Returns the pair if its tracker is of type `K`.
    #[cfg(feature = "meshes")]
    pub(super) fn of_kinds<K: PairOfKinds + Any>(&mut self) -> Option<K::Pair<'_>> {
        match &mut self.0 {
            Kinds::Polyhedra(_) | Kinds::Convex(_) | Kinds::Balls(_) => None,
            Kinds::Mixed { bodies, tracker } => {
                let tracker: &mut dyn Any = &mut **tracker;
                tracker.downcast_mut::<K>()?.pair(*bodies)
            }
        }
    }
}

impl Separation for OverTime<'_> {
    #[inline]
    fn ball(&self, of: Operand) -> (Point3<f64>, f64) {
        match &self.0 {
            Kinds::Polyhedra(pair) => pair.ball(of),
            Kinds::Convex(pair) => pair.ball(of),
            Kinds::Balls(pair) => pair.ball(of),
            Kinds::Mixed { bodies, tracker } => {
                let known = tracker.ball(*bodies, of);
                known.unwrap_or_else(|| BallPair::new(*bodies).ball(of))
            }
        }
    }

    #[inline]
    fn measure(&mut self, a_from_b: &RelativePose) -> Measure {
        self.asked(|pair| pair.measure(a_from_b))
    }

    fn meets(&mut self, a_from_b: &RelativePose, distance: f64, seen: &Measure) -> bool {
        self.asked(|pair| pair.meets(a_from_b, distance, seen))
    }

    fn support(&mut self, of: Operand, direction: &Vector3<f64>) -> SupportPoint {
        self.asked(|pair| pair.support(of, direction))
    }

    fn free_for(&mut self, seen: &Measure, flight: &Flight) -> Free {
        self.asked(|pair| pair.free_for(seen, flight))
    }
}

impl Asked for OverTime<'_> {
    fn answer(&mut self, pose: &RelativePose, question: &Question) -> Answer {
        self.asked(|pair| pair.answer(pose, question))
    }

    fn within(&mut self, pose: &RelativePose, d: f64, question: &Question) -> Decision {
        self.asked(|pair| pair.within(pose, d, question))
    }

    fn lower_bound(&mut self, pose: &RelativePose) -> f64 {
        self.asked(|pair| pair.lower_bound(pose))
    }

    #[cfg(feature = "meshes")]
    fn penetration(&mut self, pose: &RelativePose) -> Option<PenetrationBounds> {
        self.asked(|pair| pair.penetration(pose))
    }

    fn check(&mut self, pose: &RelativePose) -> Result<(), String> {
        self.asked(|pair| pair.check(pose))
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

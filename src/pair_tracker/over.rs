//! A pair of any kinds over time.

use alloc::borrow::Cow;

use nalgebra::{Point3, Vector3};

use crate::composite::mesh::Mesh;
use crate::composite::parts::PartsRef;
use crate::composite::pieces::{Composite, CompositeTracker};
use crate::composite::separation::{CompositePair, MeshPair};
use crate::composite::tracker::MeshTracker;
use crate::patch::{
    Surface, SurfaceCompositePair, SurfaceCompositeTracker, SurfacePair, SurfaceShapePair, SurfaceShapeTracker,
    SurfaceTracker,
};
use crate::polyhedron::ConvexPolyhedron;
use crate::pose::{Operand, RelativePose};
use crate::separation::{Flight, Free, Measure, PolyhedronPair, Separation, ShapePair, SupportPoint};
use crate::shape::Shape;
use crate::shape_tracker::ShapeTracker;
use crate::tracker::Tracker;

/// Two geometries that can be measured over time, followed by a borrowed tracker: what
/// [`impact`](crate::impact) asks.
#[derive(Debug)]
pub struct OverTime<'p>(pub(super) Kinds<'p>);

#[derive(Debug)]
#[allow(clippy::large_enum_variant, reason = "polyhedra, the usual pair, stay in place")]
pub(super) enum Kinds<'p> {
    Polyhedra(PolyhedronPair<'p>),
    Convex(ShapePair<'p>),
    Pieces(CompositePair<'p>),
    Triangles(MeshPair<'p>),
    Surfaces(SurfacePair<'p>),
    SurfaceAndShape(SurfaceShapePair<'p>),
    SurfaceAndPieces(SurfaceCompositePair<'p>),
}

macro_rules! each {
    ($over:expr, $pair:ident => $result:expr) => {
        match $over {
            Kinds::Polyhedra($pair) => $result,
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

impl ShapeTracker {
    /// Returns two rounded or curved shapes that can be measured over time, followed by this
    /// tracker.
    ///
    /// ```
    /// use lin_canny::impact::{Impact, Tolerance, cast};
    /// use lin_canny::motion::Steady;
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::{Shape, ShapeTracker, Velocity};
    ///
    /// let (ball, capsule) = (Shape::ball(0.5)?, Shape::capsule(1.0, 0.25)?);
    /// let still = Velocity::new(Vector3::zeros(), Vector3::zeros());
    /// let still = Steady::new(&Isometry3::identity(), still)?;
    /// let start = Isometry3::translation(3.0, 0.0, 0.0);
    /// let speed = Velocity::new(Vector3::new(-4.0, 0.0, 0.0), Vector3::zeros());
    /// let thrown = Steady::new(&start, speed)?;
    /// let mut tracker = ShapeTracker::new();
    /// let mut pair = tracker.over(&capsule, &ball);
    /// let tolerance = Tolerance::Distance(1e-9);
    /// let found = cast(&mut pair, &still, &thrown, (0.0, 1.0), tolerance)?;
    /// let Impact::Hit { safe, hit, .. } = found.impact else {
    ///     panic!("{:?}", found.impact);
    /// };
    /// // 2.25 of the way at speed 4.
    /// assert!(safe <= 0.5625 && 0.5625 <= hit && hit - safe < 1e-8);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn over<'p>(&'p mut self, a: &'p Shape, b: &'p Shape) -> OverTime<'p> {
        OverTime(Kinds::Convex(ShapePair::new(Cow::Borrowed(a), Cow::Borrowed(b), self)))
    }
}

impl CompositeTracker {
    /// Returns two composites, or a composite and a mesh, that can be measured over time, followed
    /// by this tracker.
    ///
    /// ```
    /// use lin_canny::impact::{Impact, Tolerance, cast};
    /// use lin_canny::motion::Steady;
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny::{Composite, CompositeTracker, Piece, Velocity};
    ///
    /// // A gate of two posts; a die flies through the gate into a wall.
    /// let half = Vector3::new(0.1, 0.5, 0.5);
    /// let placed = |x: f64, y: f64| {
    ///     let mut piece = Piece::new(solids::cuboid(half).expect("a box"));
    ///     piece.pose = Isometry3::translation(x, y, 0.0);
    ///     piece
    /// };
    /// let pieces = vec![placed(0.0, 1.5), placed(0.0, -1.5), placed(5.0, 0.0)];
    /// let gate = Composite::new(pieces)?;
    /// let die = Composite::new(vec![Piece::new(solids::cuboid(half)?)])?;
    /// let still = Steady::new(&Isometry3::identity(), Velocity::default())?;
    /// let start = Isometry3::translation(-2.0, 0.0, 0.0);
    /// let velocity = Velocity::new(Vector3::x(), Vector3::zeros());
    /// let flight = Steady::new(&start, velocity)?;
    /// let mut tracker = CompositeTracker::new();
    /// let mut pair = tracker.over(&gate, &die);
    /// let tolerance = Tolerance::Distance(1e-9);
    /// let found = cast(&mut pair, &still, &flight, (0.0, 10.0), tolerance)?;
    /// let Impact::Hit { safe, hit, .. } = found.impact else {
    ///     panic!("{:?}", found.impact)
    /// };
    /// assert!(safe < 6.8 && 6.8 < hit && hit - safe < 1e-8);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn over<'p>(&'p mut self, a: impl Into<PartsRef<'p>>, b: impl Into<PartsRef<'p>>) -> OverTime<'p> {
        OverTime(Kinds::Pieces(CompositePair {
            a: a.into(),
            b: b.into(),
            tracker: self,
        }))
    }
}

impl MeshTracker {
    /// Returns two meshes that can be measured over time, followed by this tracker.
    #[must_use]
    pub fn over<'p>(&'p mut self, a: &'p Mesh, b: &'p Mesh) -> OverTime<'p> {
        OverTime(Kinds::Triangles(MeshPair { a, b, tracker: self }))
    }
}

impl SurfaceTracker {
    /// Returns two surfaces that can be measured over time, followed by this tracker.
    ///
    /// A measure has bounds that are at most a quarter of the distance apart. A hit is proven by a
    /// crossing of the surfaces ([`intersects`](Self::intersects)), so a tolerance must leave room
    /// for one: from some `1e-8` of the size on.
    ///
    /// ```
    /// use lin_canny::impact::{Impact, Tolerance, cast};
    /// use lin_canny::motion::Steady;
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::patch::{SurfaceTracker, revolution};
    /// use lin_canny::Velocity;
    ///
    /// // Two spheres of radius 1, three apart, at speed 1.
    /// let half = 0.5_f64.sqrt();
    /// let south: &[[f64; 3]] =
    ///     &[[0.0, -1.0, 1.0], [1.0, -1.0, half], [1.0, 0.0, 1.0]];
    /// let north: &[[f64; 3]] =
    ///     &[[1.0, 0.0, 1.0], [1.0, 1.0, half], [0.0, 1.0, 1.0]];
    /// let sphere = revolution(&[south, north])?;
    /// let still = Steady::new(&Isometry3::identity(), Velocity::default())?;
    /// let start = Isometry3::translation(-3.0, 0.0, 0.0);
    /// let velocity = Velocity::new(Vector3::x(), Vector3::zeros());
    /// let flight = Steady::new(&start, velocity)?;
    /// let mut tracker = SurfaceTracker::new();
    /// let mut pair = tracker.over(&sphere, &sphere);
    /// let tolerance = Tolerance::Distance(1e-6);
    /// let found = cast(&mut pair, &still, &flight, (0.0, 2.0), tolerance)?;
    /// let Impact::Hit { safe, hit, .. } = found.impact else {
    ///     panic!("{:?}", found.impact)
    /// };
    /// assert!(safe < 1.0 && 1.0 < hit && hit - safe < 1e-5);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn over<'p>(&'p mut self, a: &'p Surface, b: &'p Surface) -> OverTime<'p> {
        OverTime(Kinds::Surfaces(SurfacePair { a, b, tracker: self }))
    }
}

impl SurfaceShapeTracker {
    /// Returns a surface A and a shape B that can be measured over time, followed by this tracker.
    ///
    /// A measure has bounds that are at most a quarter of the distance apart. A hit is proven by a
    /// point of the surface within the shape.
    #[must_use]
    pub fn over<'p>(&'p mut self, a: &'p Surface, b: &'p Shape) -> OverTime<'p> {
        OverTime(Kinds::SurfaceAndShape(SurfaceShapePair {
            surface: a,
            shape: Cow::Borrowed(b),
            order: Operand::A,
            tracker: self,
        }))
    }
}

impl SurfaceCompositeTracker {
    /// Returns a surface A and a body B that can be measured over time, followed by this tracker.
    ///
    /// As [`SurfaceShapeTracker::over`]: a measure has bounds
    /// that are at most a quarter of the distance apart, and a hit is proven by a point of the
    /// surface within a piece.
    #[must_use]
    pub fn over<'p>(&'p mut self, a: &'p Surface, b: &'p Composite) -> OverTime<'p> {
        OverTime(Kinds::SurfaceAndPieces(SurfaceCompositePair {
            surface: a,
            body: b,
            order: Operand::A,
            tracker: self,
        }))
    }
}

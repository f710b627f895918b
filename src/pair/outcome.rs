//! What a query answers, and how it came about.

use nalgebra::{Point3, Unit, Vector3};

use crate::polyhedron::FeaturePair;

/// Which side of contact a pair is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Class {
    /// Proven apart: the lower bound is positive (or zero where exact arithmetic finds a distance too small for f64).
    Separated,
    /// The bounds straddle zero and no finer arithmetic could, or was asked to, part them; or proven to touch.
    Touching,
    /// Proven to share an interior point.
    Overlapping,
    /// The bounds are wider than the accuracy asked for, and straddle zero or not. Possible only without the feature
    /// `exact`.
    Undecided,
}

impl core::fmt::Display for Class {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(match self {
            Self::Separated => "separated",
            Self::Touching => "touching",
            Self::Overlapping => "overlapping",
            Self::Undecided => "undecided",
        })
    }
}

/// How right an answer is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Accuracy {
    /// The word of the walk, or of the f64 solver where it does not end, without bounds:
    /// [`Tracker::propose`](crate::Tracker::propose).
    Walk,
    /// With proven bounds: [`Tracker::closest`](crate::Tracker::closest).
    #[default]
    Certified,
    /// Within one unit in the last place where the bodies are apart: `Tracker::closest_exact` (feature `exact`).
    Exact,
}

/// What a query is asked for: how accurate the answer must be, and whether an overlap needs its depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Ask {
    pub(crate) accuracy: Accuracy,
    pub(crate) until: Until,
}

impl Ask {
    /// Returns a request for proven bounds, with or without the depth of an overlap.
    pub(crate) const fn certified(until: Until) -> Self {
        Self {
            accuracy: Accuracy::Certified,
            until,
        }
    }
}

/// The point at which a query may stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Until {
    /// An overlap is proven; the penetration depth stays open.
    Class,
    /// The penetration depth of an overlap is bounded as well.
    Depth,
}

impl Until {
    /// Returns [`Until::Depth`] if the depth of overlaps is called for.
    pub(crate) fn depth_if(depth: bool) -> Self {
        if depth { Self::Depth } else { Self::Class }
    }
}

/// Which layer gave the answer. Each is tried where the certificate refuses the one before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Solver {
    /// The walk over Voronoi regions, from the cached features or a first start.
    #[default]
    Walk,
    /// The walk, started afresh from the support vertices.
    Restart,
    /// The minimum-norm solver in f64.
    Fallback,
    /// The minimum-norm solver in double-double.
    DoubleDouble,
    /// Exact integers (feature `exact`). The class is exact, and a distance is right to one unit in the last place. The depth of an
    /// overlap is as exact if no more than 65,536 pairs of features may be the deepest; of more it keeps the bounds that double-double
    /// found, which may be farther apart than `1e-13 L`, as of two prisms of 100 sides thinner than rounding.
    Exact,
    /// Bodies so far apart that only their separation counts.
    Far,
    /// A surface around the origin of the bodies' difference: kept from the answer before or begun at its deepest facet, overlap and depth at
    /// once; where no depth is asked for, four points kept from the answer before.
    Surface,
}

impl Solver {
    /// All solvers, in the order of their declaration.
    pub const ALL: &'static [Self] = &[
        Self::Walk,
        Self::Restart,
        Self::Fallback,
        Self::DoubleDouble,
        Self::Exact,
        Self::Far,
        Self::Surface,
    ];

    /// Number of solvers: the length of a table with one entry for each.
    pub(crate) const COUNT: usize = Self::ALL.len();
}

impl core::fmt::Display for Solver {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(match self {
            Self::Walk => "walk",
            Self::Restart => "restart",
            Self::Fallback => "fallback",
            Self::DoubleDouble => "double-double",
            Self::Exact => "exact",
            Self::Far => "far",
            Self::Surface => "surface",
        })
    }
}

/// Work done by one query, or summed over many.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Work {
    /// Feature pairs the walk evaluated.
    pub steps: u32,
    /// Certificates taken.
    pub certificates: u32,
    /// Walks started afresh from support vertices.
    pub restarts: u32,
    /// Starts taken where the ellipsoids of flat bodies face each other, instead of along the line of centres.
    pub ellipsoids: u32,
    /// Minimum-norm solves in f64.
    pub fallbacks: u32,
    /// Minimum-norm solves in double-double.
    pub double_doubles: u32,
    /// Exact solves.
    pub exacts: u32,
    /// Overlaps whose depth was searched for.
    pub depths: u32,
    /// Points taken into the surfaces of these searches.
    pub grown: u32,
}

impl core::ops::AddAssign for Work {
    /// Sums that stay at their end.
    fn add_assign(&mut self, o: Self) {
        self.steps = self.steps.saturating_add(o.steps);
        self.certificates = self.certificates.saturating_add(o.certificates);
        self.restarts = self.restarts.saturating_add(o.restarts);
        self.ellipsoids = self.ellipsoids.saturating_add(o.ellipsoids);
        self.fallbacks = self.fallbacks.saturating_add(o.fallbacks);
        self.double_doubles = self.double_doubles.saturating_add(o.double_doubles);
        self.exacts = self.exacts.saturating_add(o.exacts);
        self.depths = self.depths.saturating_add(o.depths);
        self.grown = self.grown.saturating_add(o.grown);
    }
}

/// The closest features of two bodies, with proof.
///
/// The signed distance is positive when apart and minus the penetration depth when overlapping: the length of the least
/// translation that parts the bodies. `lower` and `upper`
/// bound it for the placement given, rounding included.
///
/// Points are in the frames of their bodies. With the poses that [`RelativePose::new`](crate::RelativePose::new) was given they lead to
/// the world:
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::{RelativePose, Tracker, polyhedron::solids};
///
/// let (a, b) = (solids::cuboid(Vector3::new(1.0, 1.0, 1.0))?, solids::octahedron(0.5)?);
/// let (pose_a, pose_b) = (Isometry3::rotation(Vector3::z()), Isometry3::translation(3.0, 2.0, 1.0));
/// let c = Tracker::new().closest(&a, &b, &RelativePose::new(&pose_a, &pose_b)?);
/// let (on_a, on_b, normal) = (pose_a * c.point_on_a, pose_b * c.point_on_b, pose_a * c.normal);
/// assert!((on_a + c.distance * *normal - on_b).norm() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "witness")]
#[doc(alias = "closest points")]
#[doc(alias = "penetration")]
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Outcome {
    /// Which side of contact.
    pub class: Class,
    /// The best estimate of the signed distance, between the bounds; for an overlap, minus the depth.
    pub distance: f64,
    /// No greater than the signed distance; minus infinity where nothing is known.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::scalar::infinite"))]
    pub lower: f64,
    /// No less than the signed distance.
    pub upper: f64,
    /// The closest features; for an overlap, those of the deepest facet: a face and a vertex, or two edges.
    pub features: FeaturePair,
    /// The witness on A, in A's frame; for an overlap, its deepest point in B along the normal.
    pub point_on_a: Point3<f64>,
    /// The witness on B, in B's frame; for an overlap, its deepest point in A, the depth behind the witness on A.
    pub point_on_b: Point3<f64>,
    /// Unit direction from A to B, in A's frame: the direction of the witnesses and of the proof. An overlap ends
    /// where B is moved along it by the depth.
    pub normal: Unit<Vector3<f64>>,
    /// Which layer answered.
    pub solver: Solver,
    /// What it took.
    pub work: Work,
}

impl Outcome {
    /// Nothing known yet but where to begin.
    #[inline(always)]
    pub(crate) fn open(pair: FeaturePair) -> Self {
        Self {
            class: Class::Undecided,
            distance: 0.0,
            lower: f64::NEG_INFINITY,
            upper: f64::INFINITY,
            features: pair,
            point_on_a: Point3::origin(),
            point_on_b: Point3::origin(),
            normal: Vector3::x_axis(),
            solver: Solver::Walk,
            work: Work::default(),
        }
    }
}

/// The closest features as the walk proposes them, with no bound: the level for those who check elsewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Proposal {
    /// `None` where the bodies seem to overlap.
    pub distance: Option<f64>,
    /// The closest features.
    pub features: FeaturePair,
    /// The witness on A, in A's frame.
    pub point_on_a: Point3<f64>,
    /// The witness on B, in B's frame.
    pub point_on_b: Point3<f64>,
    /// Unit direction from A to B, in A's frame.
    pub normal: Unit<Vector3<f64>>,
    /// [`Solver::Walk`], or what stood in where the walk did not end.
    pub solver: Solver,
    /// What it took.
    pub work: Work,
}

/// The distance alone, with proof.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Distance {
    /// Which side of contact.
    pub class: Class,
    /// The best estimate of the signed distance; for an overlap, minus the depth.
    pub value: f64,
    /// No greater than the signed distance.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::scalar::infinite"))]
    pub lower: f64,
    /// No less than the signed distance.
    pub upper: f64,
}

impl Outcome {
    /// Whether the distance is within one unit in the last place of the truth, as the bounds prove.
    #[cfg(feature = "exact")]
    pub(crate) fn is_tight(&self) -> bool {
        self.lower > 0.0 && self.lower >= self.distance.next_down() && self.upper <= self.distance.next_up()
    }
}

impl From<&Outcome> for Distance {
    fn from(outcome: &Outcome) -> Self {
        Self {
            class: outcome.class,
            value: outcome.distance,
            lower: outcome.lower,
            upper: outcome.upper,
        }
    }
}

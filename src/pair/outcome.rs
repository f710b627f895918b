//! The outcome of a query: contact state, bounds, features, witness points and work.
//!
//! An outcome is in the frame of A. [`Outcome::in_world`] returns its points in the common frame of
//! both poses.

use core::fmt;

use nalgebra::{Point3, Unit, Vector3};

use crate::base::num::sum_of_counters;
use crate::base::pose::RelativePose;
use crate::body::polyhedron::FeaturePair;

/// Contact state of two bodies: separated, touching, overlapping or undecided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum ContactState {
    /// Proven apart: the lower bound is positive. The lower bound is zero if exact arithmetic finds
    /// a distance too small for f64.
    Separated,
    /// Proven to touch; or the bounds straddle zero, and no finer arithmetic decided.
    ///
    /// Finer arithmetic does not decide if it cannot, or if the query did not request it.
    Touching,
    /// Proven to share an interior point.
    Overlapping,
    /// The bounds are wider than the requested accuracy, whether they straddle zero or not.
    ///
    /// For polyhedra this is possible only without the feature `exact`. For curved shapes it is
    /// possible with the feature as well, because no exact arithmetic decides their contact.
    Undecided,
}

impl ContactState {
    /// Returns the name of the state: `separated`, `touching`, `overlapping` or `undecided`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Separated => "separated",
            Self::Touching => "touching",
            Self::Overlapping => "overlapping",
            Self::Undecided => "undecided",
        }
    }
}

impl core::fmt::Display for ContactState {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(self.name())
    }
}

/// Accuracy that a query must reach.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Accuracy {
    /// Without bounds: the proposal of the walk, or of the f64 solver if the walk does not end.
    ///
    /// See [`Tracker::propose`](crate::Tracker::propose).
    Walk,
    /// Proven bounds: [`Tracker::closest`](crate::Tracker::closest).
    #[default]
    Certified,
    /// Within one unit in the last place if the bodies are separated: `Tracker::closest_exact`
    /// (feature `exact`).
    Exact,
}

/// Request of a query: the accuracy, and which depth an overlap gets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Ask {
    pub(crate) accuracy: Accuracy,
    pub(crate) until: DepthMode,
}

impl Ask {
    /// Returns a request for proven bounds, with or without the depth of an overlap.
    pub(crate) const fn certified(until: DepthMode) -> Self {
        Self {
            accuracy: Accuracy::Certified,
            until,
        }
    }
}

/// Penetration depth that a query of two overlapping convex geometries returns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum DepthMode {
    /// No depth: the query proves only the overlap.
    None,
    /// An upper bound of the depth of two polyhedra, rounded or not, at about three times the cost
    /// of a walk.
    ///
    /// The bound is the distance of a facet that is nearest in its neighbourhood
    /// ([`Tracker::closest_with_local_depth`](crate::Tracker::closest_with_local_depth)). Other
    /// shapes get the depth with both bounds.
    Local,
    /// The penetration depth with a lower and an upper bound.
    #[default]
    Full,
}

impl DepthMode {
    /// Returns the mode for two requests: for a depth at all, and for a local depth.
    pub(crate) fn of_depth(depth: bool, local: bool) -> Self {
        match (depth, local) {
            (false, _) => Self::None,
            (true, true) => Self::Local,
            (true, false) => Self::Full,
        }
    }

    /// Returns whether overlaps get a depth.
    #[inline(always)]
    pub(crate) fn has_depth(self) -> bool {
        self != Self::None
    }
}

/// Solver that computed an outcome.
///
/// A query tries the next solver if the certificate rejects the result of the solver before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Solver {
    /// The walk over Voronoi regions, from the cached features or a cold start.
    #[default]
    Walk,
    /// The walk, restarted from the support vertices.
    Restart,
    /// The minimum-norm solver in f64.
    Gjk,
    /// The minimum-norm solver in double-double.
    DoubleDouble,
    /// Exact integers (feature `exact`).
    ///
    /// The contact state is exact, and the distance of separated bodies is right to one unit in the
    /// last place. The depth of an overlap is as accurate if at most 65,536 feature pairs may be
    /// the deepest. If there are more, the depth keeps the bounds of double-double. These may be
    /// farther apart than `1e-13 L` (for example, for two prisms of 100 sides thinner than
    /// rounding).
    Exact,
    /// No solver: the bodies are so far apart that only their separation matters.
    Far,
    /// A polytope around the origin of the Minkowski difference, which gives overlap and depth at
    /// once.
    ///
    /// - **Most shallow overlaps**: one facet and an apex. A walk over facets, started at the last
    ///   features, finds the nearest facet.
    /// - **Other overlaps**: a polytope cached by the last query, or started at the nearest facet.
    /// - **No depth requested**: four points cached by the last query.
    /// - **Local depth requested**: a facet and apex, or four points.
    Polytope,
}

impl Solver {
    /// All solvers, in the order of their declaration.
    pub const ALL: &'static [Self] = &[
        Self::Walk,
        Self::Restart,
        Self::Gjk,
        Self::DoubleDouble,
        Self::Exact,
        Self::Far,
        Self::Polytope,
    ];

    /// Number of solvers: the length of a table with one entry per solver.
    pub(crate) const COUNT: usize = Self::ALL.len();
}

impl core::fmt::Display for Solver {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(match self {
            Self::Walk => "walk",
            Self::Restart => "restart",
            Self::Gjk => "gjk",
            Self::DoubleDouble => "double-double",
            Self::Exact => "exact",
            Self::Far => "far",
            Self::Polytope => "polytope",
        })
    }
}

/// Work of one query, or the sum over many queries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Work {
    /// Feature pairs that the walk evaluated.
    pub steps: u32,
    /// Certificates evaluated.
    pub certificates: u32,
    /// Walks restarted from support vertices.
    pub restarts: u32,
    /// Cold starts along the normal of two touching ellipsoids (flat bodies) instead of the line of
    /// centres.
    pub ellipsoids: u32,
    /// Minimum-norm solves in f64.
    pub fallbacks: u32,
    /// Minimum-norm solves in double-double.
    pub double_doubles: u32,
    /// Exact solves.
    pub exacts: u32,
    /// Searches for the depth of an overlap.
    pub depths: u32,
    /// Points added to the polytopes of depth searches.
    pub points_added: u32,
    /// Facets of the Minkowski difference visited on the path to the nearest facet.
    #[cfg_attr(feature = "serde", serde(default))]
    pub facets: u32,
}

sum_of_counters!(Work {
    steps,
    certificates,
    restarts,
    ellipsoids,
    fallbacks,
    double_doubles,
    exacts,
    depths,
    points_added,
    facets,
});

/// Closest features of two bodies, with proven bounds of the signed distance.
///
/// The signed distance of separated bodies is their distance. The signed distance of overlapping
/// bodies is minus the penetration depth: the length of the shortest translation that separates
/// them. `lower` and `upper` bound the signed distance for the given pose, rounding included.
///
/// Points are in the frames of their bodies. The poses passed to
/// [`RelativePose::new`](crate::RelativePose::new) map them to the world:
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::{RelativePose, Tracker, polyhedron::solids};
///
/// let a = solids::cuboid(Vector3::new(1.0, 1.0, 1.0))?;
/// let b = solids::octahedron(0.5)?;
/// let pose_a = Isometry3::rotation(Vector3::z());
/// let pose_b = Isometry3::translation(3.0, 2.0, 1.0);
/// let c = Tracker::new().closest(&a, &b, &RelativePose::new(&pose_a, &pose_b)?);
/// let (on_a, on_b) = (pose_a * c.point_on_a, pose_b * c.point_on_b);
/// let normal = pose_a * c.normal;
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
    /// Contact state of the two bodies.
    pub state: ContactState,
    /// Best estimate of the signed distance, between the bounds; for an overlap, minus the depth.
    pub distance: f64,
    /// Lower bound of the signed distance; minus infinity if nothing is known.
    #[cfg_attr(feature = "serde", serde(with = "crate::base::num::scalar::infinite"))]
    pub lower: f64,
    /// Upper bound of the signed distance.
    pub upper: f64,
    /// Closest features.
    ///
    /// If the bodies are separated, each witness lies on its feature, up to the bounds. Exception:
    /// if an edge or face is parallel to a face, a solver other than the walk may report a vertex
    /// of it instead of the edge or face. The witness then lies on an edge or face that contains
    /// this vertex.
    ///
    /// If the bodies overlap, these are the features of the deepest facet of the Minkowski
    /// difference: a face and a vertex, or two edges. The witnesses lie on the supporting planes of
    /// the two features. Exception: if several facets are equally deep (boxes with parallel faces),
    /// a witness may lie outside the reported vertex, on a face that contains the vertex.
    pub features: FeaturePair,
    /// Witness on A, in A's frame; for an overlap, A's deepest point in B along the normal.
    pub point_on_a: Point3<f64>,
    /// Witness on B, in B's frame; for an overlap, B's deepest point in A.
    ///
    /// The witness of an overlap on B lies behind the witness on A by the depth.
    pub point_on_b: Point3<f64>,
    /// Unit direction from A to B, in A's frame: the direction of the witnesses and of the proof.
    ///
    /// Moving B along the normal by the depth ends an overlap.
    pub normal: Unit<Vector3<f64>>,
    /// Solver that computed the outcome.
    pub solver: Solver,
    /// Work of the query.
    pub work: Work,
}

impl Outcome {
    /// Makes each zero of the distance and the bounds a positive zero, because `total_cmp`
    /// distinguishes `-0.0` from `0.0`.
    #[inline(always)]
    pub(crate) fn unsign_zeros(&mut self) {
        // The sum is exact, and zero of either sign plus zero is a positive zero.
        self.distance += 0.0;
        self.lower += 0.0;
        self.upper += 0.0;
    }

    /// Returns an outcome that bounds nothing.
    #[inline(always)]
    pub(crate) fn starting_at(pair: FeaturePair) -> Self {
        Self {
            state: ContactState::Undecided,
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

    /// Returns the outcome with an overlap of unknown depth.
    pub(crate) fn without_depth(self) -> Self {
        if self.state == ContactState::Overlapping {
            let (distance, lower, upper) = (0.0, f64::NEG_INFINITY, 0.0);
            Self {
                distance,
                lower,
                upper,
                ..self
            }
        } else {
            self
        }
    }
}

/// Closest features proposed by the walk, without bounds.
///
/// For callers who verify the result elsewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Proposal {
    /// Proposed distance; `None` if the bodies seem to overlap.
    pub distance: Option<f64>,
    /// Closest features.
    pub features: FeaturePair,
    /// Witness on A, in A's frame.
    pub point_on_a: Point3<f64>,
    /// Witness on B, in B's frame.
    pub point_on_b: Point3<f64>,
    /// Unit direction from A to B, in A's frame.
    pub normal: Unit<Vector3<f64>>,
    /// [`Solver::Walk`], or the solver that replaced the walk if the walk did not end.
    pub solver: Solver,
    /// Work of the query.
    pub work: Work,
}

/// Signed distance of two bodies with proven bounds, without features or points.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Distance {
    /// Contact state of the two bodies.
    pub state: ContactState,
    /// Best estimate of the signed distance; for an overlap, minus the depth.
    pub value: f64,
    /// Lower bound of the signed distance.
    #[cfg_attr(feature = "serde", serde(with = "crate::base::num::scalar::infinite"))]
    pub lower: f64,
    /// Upper bound of the signed distance.
    pub upper: f64,
}

/// Three-valued result of a predicate that is decided by bounds.
///
/// No exact arithmetic decides what the bounds leave open.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Decision {
    /// The predicate is proven true.
    Yes,
    /// The predicate is proven false.
    No,
    /// The bounds of the distance allow both answers.
    Undecided {
        /// Lower bound of the distance.
        lower: f64,
        /// Upper bound of the distance.
        upper: f64,
    },
}

impl Decision {
    /// Returns whether a distance with these bounds is at most `d`.
    pub(crate) fn by(lower: f64, upper: f64, d: f64) -> Self {
        if upper <= d {
            Self::Yes
        } else if lower > d {
            Self::No
        } else {
            Self::Undecided { lower, upper }
        }
    }

    /// Returns whether the predicate is proven true.
    #[must_use]
    pub fn is_yes(self) -> bool {
        self == Self::Yes
    }

    /// Returns whether the predicate is proven false.
    #[must_use]
    pub fn is_no(self) -> bool {
        self == Self::No
    }

    /// Returns the decision of a predicate that is always decided.
    pub(crate) fn of(is_so: bool) -> Self {
        if is_so { Self::Yes } else { Self::No }
    }

    /// Returns the predicate's value, or `None` if undecided.
    #[must_use]
    pub fn as_bool(self) -> Option<bool> {
        match self {
            Self::Yes => Some(true),
            Self::No => Some(false),
            Self::Undecided { .. } => None,
        }
    }
}

impl Outcome {
    /// Returns whether the bounds prove the distance right to one unit in the last place.
    #[cfg(feature = "exact")]
    pub(crate) fn is_tight(&self) -> bool {
        self.lower > 0.0 && self.lower >= self.distance.next_down() && self.upper <= self.distance.next_up()
    }
}

impl From<&Outcome> for Distance {
    fn from(outcome: &Outcome) -> Self {
        Self {
            state: outcome.state,
            value: outcome.distance,
            lower: outcome.lower,
            upper: outcome.upper,
        }
    }
}

/// Witness points and normal of an [`Outcome`] in the world, the poses' common frame.
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::{RelativePose, Tracker, polyhedron::solids};
///
/// let cube = solids::cuboid(Vector3::new(1.0, 1.0, 1.0))?;
/// let pose_a = Isometry3::translation(5.0, 0.0, 0.0);
/// let pose_b = Isometry3::translation(8.0, 0.0, 0.0);
/// let poses = RelativePose::new(&pose_a, &pose_b)?;
/// let world = Tracker::new().closest(&cube, &cube, &poses).in_world(&poses);
/// assert_eq!((world.point_on_a.x, world.point_on_b.x), (6.0, 7.0));
/// assert_eq!(world.normal.x, 1.0);
/// assert_eq!(world.swapped().normal.x, -1.0); // as seen from B
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct WorldWitnesses {
    /// Witness point on A.
    pub point_on_a: Point3<f64>,
    /// Witness point on B.
    pub point_on_b: Point3<f64>,
    /// Unit vector from A to B.
    pub normal: Unit<Vector3<f64>>,
}

impl WorldWitnesses {
    /// Returns the witnesses with A and B exchanged: use it if your own body is B.
    #[must_use]
    pub fn swapped(&self) -> Self {
        Self {
            point_on_a: self.point_on_b,
            point_on_b: self.point_on_a,
            normal: Unit::new_unchecked(-self.normal.into_inner()),
        }
    }
}

impl Outcome {
    /// Returns the witness points and the normal in the common frame of the two poses.
    ///
    /// The poses are the arguments of [`RelativePose::new`]. Points in the world carry the rounding
    /// error of the world's coordinates; the distance and its bounds do not.
    #[inline]
    #[must_use]
    pub fn in_world(&self, poses: &RelativePose) -> WorldWitnesses {
        let (a, b) = poses.poses();
        WorldWitnesses {
            point_on_a: a * self.point_on_a,
            point_on_b: b * self.point_on_b,
            normal: a * self.normal,
        }
    }
}

/// State, distance and bounds: `separated, 1.5 in [1.4999999999999993, 1.5000000000000007]`.
impl fmt::Display for Distance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {} in [{}, {}]", self.state, self.value, self.lower, self.upper)
    }
}

/// State, distance, bounds, features and solver on one line.
impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}, features {}, by {}",
            Distance::from(self),
            self.features,
            self.solver
        )
    }
}

/// Number of queries by solver as text: `answered by walk 12, exact 3`.
///
/// Solvers without a query are left out.
pub(crate) struct AnsweredBy<'a>(pub(crate) &'a [u64; Solver::COUNT]);

impl fmt::Display for AnsweredBy<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("answered by")?;
        let counted = Solver::ALL.iter().zip(self.0).filter(|(_, count)| **count > 0);
        for (k, (solver, count)) in counted.enumerate() {
            write!(f, "{} {solver} {count}", if k > 0 { "," } else { "" })?;
        }
        Ok(())
    }
}

//! What is asked of two bodies less closely than they move: a distance to within a stated error, or whether they are
//! within `d`, looked for only where the motion since the last look leaves the answer open.
//!
//! The signed distance is the greatest gap `min over B of n . b - max over A of n . a` over unit directions n, apart and
//! overlapping alike. A motion that moves no point of one body by more than `m`, seen from the other, changes the gap
//! along every n by at most `m`, and so their greatest. Hence an answer with bounds `lower` and `upper` is, `m` later, an
//! answer with bounds `lower - m` and `upper + m`, and no vertex need be looked at to know it.
//!
//! This is where an error allowed in a distance saves time, if little beside a tracked query ([`cost`](crate::cost)). In the walk it
//! does not: a walk ends on the closest features after a look or two, and has no earlier answer with bounds to stop at.
//!
//! Source: the idea of waiting by distance is that of Lin 1993, chapter 5 (there with velocities and a heap of times).

use nalgebra::Vector3;

use crate::motion::BallAtPose;
use crate::pair::outcome::{Class, Distance, Until};
use crate::polyhedron::ConvexPolyhedron;
use crate::pose::{Operand, RelativePose};
use crate::tracker::{Tracker, clear_of};

/// Two bodies, a tracker, and the last answer with the pose it was for.
///
/// Borrows the bodies: bounds that outlive a pose are of these two alone.
///
/// The signed distance is the greatest gap between parallel supporting planes. A motion that moves no point of one body, seen from the
/// other, by more than `m` changes each of these gaps by at most `m`, and so the distance: an answer with bounds `lower` and `upper`
/// is, `m` later, one with bounds `lower - m` and `upper + m`. Only where that is not answer enough the tracker looks. (The idea of
/// waiting by distance is that of Lin 1993, chapter 5, there with velocities and a heap of times.)
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::{RelativePose, Watch, polyhedron::solids};
///
/// let (a, b) = (solids::cuboid(Vector3::new(1.0, 1.0, 1.0))?, solids::octahedron(0.5)?);
/// let mut pair = Watch::new(&a, &b);
/// for k in 0..100 {
///     let a_from_b = RelativePose::from_isometry(&Isometry3::translation(3.0 - 0.001 * k as f64, 0.0, 0.0))?;
///     let d = pair.distance(&a_from_b, 0.01); // off by at most 0.01
///     assert!((d.value - (1.5 - 0.001 * k as f64)).abs() <= 0.01);
/// }
/// assert_eq!((pair.asked(), pair.looked()), (100, 10));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "approximate")]
#[doc(alias = "clearance")]
#[derive(Clone, Debug)]
pub struct Watch<'a> {
    a: &'a ConvexPolyhedron,
    b: &'a ConvexPolyhedron,
    tracker: Tracker,
    /// The body that is seen to move, the smaller one, and the ball that holds it.
    moving: Operand,
    centre: Vector3<f64>,
    radius: f64,
    seen: Option<Seen>,
    asked: u64,
    looked: u64,
}

/// The last answer that was looked for, and where the moving body was.
#[derive(Clone, Copy, Debug)]
struct Seen {
    place: BallAtPose,
    answer: Distance,
}

impl<'a> Watch<'a> {
    /// Watches two bodies; nothing is known yet.
    #[must_use]
    pub fn new(a: &'a ConvexPolyhedron, b: &'a ConvexPolyhedron) -> Self {
        let (ball_a, ball_b) = (a.bounding_ball(), b.bounding_ball());
        let (moving, (centre, radius)) = if ball_b.1 <= ball_a.1 {
            (Operand::B, ball_b)
        } else {
            (Operand::A, ball_a)
        };
        Self {
            a,
            b,
            tracker: Tracker::new(),
            moving,
            centre: centre.coords,
            radius,
            seen: None,
            asked: 0,
            looked: 0,
        }
    }

    /// The signed distance, off by at most `error` (a length, in the caller's unit), with bounds.
    ///
    /// Value and bounds depend on what was asked before, within `error`. The class is that of [`Tracker::distance`], or
    /// [`Class::Touching`] where bounds this wide leave the sign open. An error that the bounds of `Tracker::distance`
    /// themselves exceed (some `1e-13 L`), or that is negative or NaN, gives the answer of `Tracker::distance`.
    pub fn distance(&mut self, a_from_b: &RelativePose, error: f64) -> Distance {
        self.asked += 1;
        let place = self.place(a_from_b);
        if let Some(known) = self.known(&place)
            && known.upper - known.value <= error
            && known.value - known.lower <= error
        {
            return known;
        }
        self.look(place, a_from_b, Until::Depth)
    }

    /// Whether the closed bodies are at most `d` apart: the answer of [`Tracker::within`], often for less.
    pub fn within(&mut self, a_from_b: &RelativePose, d: f64) -> bool {
        self.asked += 1;
        if !(d >= 0.0) || clear_of(self.a, self.b, a_from_b, d) {
            return false;
        }
        let decided = |o: &Distance| {
            if o.lower > d {
                Some(false)
            } else if o.upper <= d {
                Some(true)
            } else {
                None
            }
        };
        let place = self.place(a_from_b);
        if let Some(answer) = self.known(&place).as_ref().and_then(decided) {
            return answer;
        }
        let found = self.look(place, a_from_b, Until::Class);
        decided(&found).unwrap_or_else(|| self.tracker.within(self.a, self.b, a_from_b, d))
    }

    /// Whether the closed bodies share a point: the answer of [`Tracker::intersects`], often for less.
    pub fn intersects(&mut self, a_from_b: &RelativePose) -> bool {
        self.within(a_from_b, 0.0)
    }

    /// Questions so far.
    #[must_use]
    pub fn asked(&self) -> u64 {
        self.asked
    }

    /// Questions that the motion since the last look left open.
    #[must_use]
    pub fn looked(&self) -> u64 {
        self.looked
    }

    /// The tracker that looks, for its features and totals.
    #[must_use]
    pub fn tracker(&self) -> &Tracker {
        &self.tracker
    }

    fn look(&mut self, place: BallAtPose, a_from_b: &RelativePose, until: Until) -> Distance {
        self.looked += 1;
        let answer = self.tracker.bounds(self.a, self.b, a_from_b, until);
        self.seen = Some(Seen { place, answer });
        answer
    }

    #[inline]
    fn place(&self, a_from_b: &RelativePose) -> BallAtPose {
        let (rotation, translation) = (a_from_b.rotation(), a_from_b.translation());
        BallAtPose::new(self.moving, (&self.centre, self.radius), &rotation, &translation)
    }

    /// The last answer as far as it is one here. `None` where nothing was asked, or where squares of lengths leave the
    /// range.
    #[inline]
    fn known(&self, place: &BallAtPose) -> Option<Distance> {
        let Seen { place: then, answer } = self.seen.as_ref()?;
        let by = place.displacement(then);
        if !(by < f64::INFINITY) {
            return None;
        }
        let (lower, upper) = ((answer.lower - by).next_down(), (answer.upper + by).next_up());
        let class = if lower > 0.0 {
            Class::Separated
        } else if upper < 0.0 {
            Class::Overlapping
        } else {
            Class::Touching
        };
        Some(Distance {
            class,
            value: answer.value,
            lower,
            upper,
        })
    }
}

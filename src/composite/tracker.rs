//! What a caller keeps of a pair of meshes, and the queries.

use alloc::vec::Vec;
use nalgebra::{Point3, Unit, Vector3};

use super::audit::{FrontFault, audit};
use super::frame::Frame;
use super::front::Pair;
use super::kept::Kept;
use super::mesh::Mesh;
use super::outcome::MeshOutcome;
use super::pair::{MeshPair, side};
use super::search::{Goal, Measured, MeshWork, Search};
use super::triangle::Spot;
use crate::motion::BallAtPose;
use crate::pair::outcome::{Class, Distance};
use crate::pose::{Operand, RelativePose};

/// The front of the last answer for one pair of meshes, from which the next query starts, and
/// counters.
///
/// Owns no mesh. What is kept changes time, never an answer: a tracker that comes from another
/// pair, or is out of date, is allowed.
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::{Class, Mesh, MeshTracker, RelativePose, polyhedron::solids};
///
/// let a = Mesh::from_convex(&solids::cuboid(Vector3::new(1.0, 1.0, 1.0))?)?;
/// let b = Mesh::from_convex(&solids::octahedron(0.5)?)?;
/// let mut pair = MeshTracker::new();
/// for k in 0..10 {
///     let pose = Isometry3::translation(3.0, 0.1 * k as f64, 0.0);
///     let a_from_b = RelativePose::from_isometry(&pose)?;
///     let c = pair.closest(&a, &b, &a_from_b);
///     assert!(c.lower <= 1.5 && 1.5 <= c.upper);
/// }
/// let inside = Isometry3::translation(0.1, 0.2, 0.0);
/// let inside = RelativePose::from_isometry(&inside)?;
/// assert_eq!(pair.closest(&a, &b, &inside).class, Class::Overlapping);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct MeshTracker {
    fingerprints: [u64; 2],
    pub(super) kept: Kept,
    /// The last answer that proved surfaces and insides apart: how far, and where B was.
    free: Option<(f64, BallAtPose)>,
}

/// Whether one body is inside the other.
enum Inside {
    No,
    /// At a vertex of the inner one, in A's frame and in B's.
    At(Point3<f64>, Point3<f64>),
    /// Every segment met an edge.
    Unclear,
}

/// What a search found, in A's stored units.
struct Found {
    best: Option<Measured<[Spot; 2]>>,
    lower: f64,
    touches: Vec<Pair>,
}

impl MeshTracker {
    /// Returns a tracker without a start.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns the work of all queries so far.
    #[must_use]
    pub fn work(&self) -> MeshWork {
        self.kept.work
    }

    /// Returns the number of entries of the front that is kept.
    #[must_use]
    pub fn front_len(&self) -> usize {
        self.kept.front.len()
    }

    /// Returns the front that is kept: pairs of nodes of A's and B's trees that are proven farther
    /// apart than the distance, under which every pair of triangles lies. [`Mesh::node_box`]
    /// returns their boxes.
    pub fn front(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.kept.front.pairs()
    }

    /// Checks the front that is kept against all corners, at the pose of the last
    /// [`closest`](Self::closest): for debugging, in time that is entries times triangles.
    ///
    /// # Errors
    ///
    /// The first claim that is false, or a pair that is not covered.
    pub fn audit(&self, a: &Mesh, b: &Mesh, a_from_b: &RelativePose) -> Result<(), FrontFault> {
        match Frame::new(side(a), side(b), a_from_b) {
            Some(frame) if !self.kept.front.is_empty() => audit(&self.kept.front, a, b, &frame),
            _ => Ok(()),
        }
    }

    /// Adds to the claim of an entry.
    #[cfg(test)]
    pub(super) fn spoil(&mut self, entry: usize, by: f32) {
        let place = self.kept.front.place(entry % self.kept.front.len());
        self.kept.front.corrupt(place, by);
    }

    /// Loses an entry.
    #[cfg(test)]
    pub(super) fn drop_entry(&mut self, entry: usize) {
        let place = self.kept.front.place(entry % self.kept.front.len());
        self.kept.front.remove(place);
    }

    /// Returns the bytes kept on the heap.
    #[must_use]
    pub fn heap_bytes(&self) -> usize {
        self.kept.heap_bytes()
    }

    /// Forgets everything that is kept, counters too.
    pub fn reset(&mut self) {
        *self = Self::default();
    }

    /// Returns the closest points with bounds of the distance: for bodies apart no wider than
    /// `1e-13 L`, with `L` the sum of both radii about the bodies' own origins and the distance of
    /// these.
    pub fn closest(&mut self, a: &Mesh, b: &Mesh, a_from_b: &RelativePose) -> MeshOutcome {
        self.recognise(a, b);
        self.kept.work.queries += 1;
        match Frame::new(side(a), side(b), a_from_b) {
            Some(frame) => {
                let found = self.search(a, b, a_from_b, &frame);
                self.conclude(a, b, a_from_b, &frame, &found)
            }
            None => far(a, b, a_from_b),
        }
    }

    /// Returns the distance and its bounds without the witnesses.
    pub fn distance(&mut self, a: &Mesh, b: &Mesh, a_from_b: &RelativePose) -> Distance {
        Distance::from(&self.closest(a, b, a_from_b))
    }

    /// Returns whether the bodies share a point; touching counts. Exact with the feature `exact`;
    /// without it ties count as touching.
    pub fn intersects(&mut self, a: &Mesh, b: &Mesh, a_from_b: &RelativePose) -> bool {
        self.within(a, b, a_from_b, 0.0)
    }

    /// Returns whether the bodies are at most `d` apart. Exact with the feature `exact`; without it
    /// ties count as within. False for a negative `d` and for NaN.
    pub fn within(&mut self, a: &Mesh, b: &Mesh, a_from_b: &RelativePose, d: f64) -> bool {
        if !(d >= 0.0) {
            return false;
        }
        self.recognise(a, b);
        self.kept.work.queries += 1;
        let Some(frame) = Frame::new(side(a), side(b), a_from_b) else {
            return far(a, b, a_from_b).lower <= d;
        };
        let place = place(b, &frame);
        if let Some((lower, then)) = &self.free
            && lower - place.displacement(then) > d / a.unit()
        {
            return false;
        }
        let mut judge = MeshPair::new(a, b, a_from_b);
        judge.within = Some(d);
        let mut search = Search::new((&a.tree, &b.tree), &frame, judge, Goal::Within(d / a.unit()));
        let is_within = self.kept.is_within(&mut search);
        self.kept.work.settled += search.judge.settled;
        is_within || !matches!(self.inside(a, b, &frame), Inside::No)
    }

    /// Returns a lower bound of the distance in one pass over what is kept, without looking for the
    /// closest pair; zero where nothing better is known.
    pub fn lower_bound(&mut self, a: &Mesh, b: &Mesh, a_from_b: &RelativePose) -> f64 {
        self.recognise(a, b);
        let (Some(frame), false) = (Frame::new(side(a), side(b), a_from_b), self.kept.front.is_empty()) else {
            return 0.0;
        };
        let carried = self
            .free
            .as_ref()
            .map_or(0.0, |(lower, then)| lower - place(b, &frame).displacement(then));
        self.kept.front.meet(&frame.single);
        let mut least = f32::INFINITY;
        self.kept.front.gaps(&frame.single, |_, _, gap| least = least.min(gap));
        let mut bound = f64::from(least) * frame.single.unit;
        if bound > 0.0 && !(carried > 0.0) && !matches!(self.inside(a, b, &frame), Inside::No) {
            bound = 0.0;
        }
        bound.max(carried).max(0.0) * a.unit()
    }

    /// Forgets what belongs to other meshes.
    fn recognise(&mut self, a: &Mesh, b: &Mesh) {
        let fingerprints = [a.fingerprint, b.fingerprint];
        if self.fingerprints != fingerprints {
            let work = self.kept.work;
            self.reset();
            (self.fingerprints, self.kept.work) = (fingerprints, work);
        }
    }

    /// The closest pair of triangles, by the front where there is one.
    fn search(&mut self, a: &Mesh, b: &Mesh, pose: &RelativePose, frame: &Frame) -> Found {
        let mut search = Search::new((&a.tree, &b.tree), frame, MeshPair::new(a, b, pose), Goal::Least);
        self.kept.closest(&mut search);
        self.kept.work.settled += search.judge.settled;
        let touches = search.judge.touching[..search.judge.touch_count].to_vec();
        Found {
            best: search.best,
            lower: search.lower,
            touches,
        }
    }

    /// From the closest triangles to the class of the bodies, and to the caller's units.
    fn conclude(&mut self, a: &Mesh, b: &Mesh, pose: &RelativePose, frame: &Frame, found: &Found) -> MeshOutcome {
        let Some(best) = &found.best else {
            return far(a, b, pose);
        };
        let solid = a.is_solid() && b.is_solid();
        let pair = MeshPair::new(a, b, pose);
        let (on_a, on_b) = pair.spots(best.pair, best.features);
        let mut outcome = MeshOutcome {
            class: Class::Touching,
            distance: best.distance * a.unit(),
            lower: found.lower.min(best.lower).max(0.0) * a.unit(),
            upper: best.upper * a.unit(),
            on_a,
            on_b,
            point_on_a: a.given(&best.on_a),
            point_on_b: b.given(&best.on_b),
            normal: Unit::new_unchecked(best.normal),
        };
        if best.crosses || outcome.lower <= 0.0 && solid && self.shares_inside(a, b, frame, found) {
            outcome.share(solid);
        } else if outcome.lower > 0.0 {
            match self.held(a, b, frame, outcome.lower / a.unit()) {
                Inside::No => outcome.class = Class::Separated,
                Inside::At(on_a, on_b) => {
                    (outcome.point_on_a, outcome.point_on_b) = (on_a, on_b);
                    outcome.share(solid);
                }
                Inside::Unclear => (outcome.class, outcome.lower) = (Class::Undecided, 0.0),
            }
        }
        outcome
    }

    /// Whether one body is inside the other, whose surfaces are proven to be `lower` apart.
    fn held(&mut self, a: &Mesh, b: &Mesh, frame: &Frame, lower: f64) -> Inside {
        let now = place(b, frame);
        // Surfaces that were proven apart cannot have met on the way if no point went as far.
        let carried = self
            .free
            .as_ref()
            .is_some_and(|(before, then)| now.displacement(then) < *before);
        let inside = if carried { Inside::No } else { self.inside(a, b, frame) };
        self.free = matches!(inside, Inside::No).then_some((lower, now));
        inside
    }

    /// Whether a part of one body is inside the other, whose surfaces are apart.
    fn inside(&mut self, a: &Mesh, b: &Mesh, frame: &Frame) -> Inside {
        let ratio = a.unit() / b.unit();
        if a.is_solid() {
            for &v in &b.part_vertices {
                let local = b.points[v as usize];
                let place = frame.point(&local);
                self.kept.work.windings += 1;
                match a.winding(&place) {
                    Some(0) => {}
                    Some(_) => return Inside::At(a.given(&place), b.given(&local)),
                    None => return Inside::Unclear,
                }
            }
        }
        if b.is_solid() {
            for &v in &a.part_vertices {
                let local = a.points[v as usize];
                let place = frame.rotation.tr_mul(&(local - frame.translation)) * ratio;
                self.kept.work.windings += 1;
                match b.winding(&place) {
                    Some(0) => {}
                    Some(_) => return Inside::At(a.given(&local), b.given(&place)),
                    None => return Inside::Unclear,
                }
            }
        }
        Inside::No
    }

    /// Whether one of the triangles in contact has its middle certainly inside the other solid.
    /// Middles on their own side of the plane of contact are not looked at: in flush contact none
    /// is left.
    fn shares_inside(&mut self, a: &Mesh, b: &Mesh, frame: &Frame, found: &Found) -> bool {
        let Some(best) = &found.best else { return false };
        let ratio = a.unit() / b.unit();
        let middle = |t: [Vector3<f64>; 3]| (t[0] + t[1] + t[2]) / 3.0;
        let within = |mesh: &Mesh, p: &Vector3<f64>, error: f64| {
            mesh.winding(p).unwrap_or(0) != 0 && mesh.is_clear_of(p, 2.0 * error)
        };
        let height = |p: &Vector3<f64>| best.normal.dot(&(p - best.on_a));
        found.touches.iter().any(|&[i, j]| {
            let (p, q) = (middle(a.corners(i)), frame.point(&middle(b.corners(j))));
            let back = frame.rotation.tr_mul(&(p - frame.translation)) * ratio;
            height(&q) < -frame.tie && within(a, &q, frame.error)
                || height(&p) > frame.tie && within(b, &back, frame.error * ratio)
        })
    }
}

/// The ball of B about its tree's origin, as seen from A, in A's stored units.
fn place(b: &Mesh, frame: &Frame) -> BallAtPose {
    let radius = f64::from(b.tree.reach) * b.tree.unit() * frame.scale;
    BallAtPose::new(
        Operand::B,
        (&(b.tree.centre * frame.scale), radius),
        &frame.rotation,
        &frame.translation,
    )
}

/// Bodies so far apart, or so small beside their distance, that only balls about their origins
/// count.
fn far(a: &Mesh, b: &Mesh, pose: &RelativePose) -> MeshOutcome {
    let (distance, slack, normal) = super::frame::far(side(a), side(b), pose);
    let lower = (distance - slack).max(0.0);
    let pair = MeshPair::new(a, b, pose);
    let (on_a, on_b) = pair.spots([0, 0], [Spot::Vertex(0); 2]);
    MeshOutcome {
        class: if lower > 0.0 {
            Class::Separated
        } else {
            Class::Undecided
        },
        distance,
        lower,
        upper: distance + slack,
        on_a,
        on_b,
        point_on_a: a.given(&a.corners(0)[0]),
        point_on_b: b.given(&b.corners(0)[0]),
        normal: Unit::new_unchecked(normal),
    }
}

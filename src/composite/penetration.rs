//! Bounds of the penetration depth of two solids that are not convex.
//!
//! The depth is the length of the shortest translation of B after which the bodies share no inner
//! point. A point of one body that is `r` deep inside the other must leave, so the depth is at
//! least `r`; any translation after which the bodies are proven apart is at least as long as the
//! depth. Two convex pieces must be parted as well, so their depth is a lower bound too.
//!
//! The search moves B by the deepest point, or the deepest pair of pieces, until the bodies are
//! apart, then shortens the translation by bisection; and it shortens the translation that parts
//! the hulls. None of this need find the shortest: the interval stays open, and says so.
//!
//! Source: the two bounds of Zhang, Kim, Varadhan and Manocha 2007, "Generalized penetration depth
//! computation" (there for convex containers and pieces); moving by local depths: Je et al. 2012,
//! "PolyDepth". Departure: both ends are proven.

use alloc::vec::Vec;
use nalgebra::{Isometry3, Point3, Translation3, Vector3};

use super::mesh::Mesh;
use super::pieces::{Composite, CompositeTracker};
use super::placed::{Placed, relative};
use super::state::Posed;
use super::tracker::MeshTracker;
use crate::num::scalar::sqrt;
use crate::pair::outcome::Class;
use crate::polyhedron::ConvexPolyhedron;
use crate::pose::RelativePose;
use crate::shape::{Core, Shape};
use crate::shape_tracker::ShapeTracker;
use crate::tolerance::{CERTIFICATE, UNIT};
use crate::tracker::Tracker;
use crate::tuning::composite::{BEYOND, DEEP_POINTS, HALVINGS, PUSHES};

/// Bounds of the penetration depth of two bodies: an interval, not a distance. The depth is the
/// length of the shortest translation of B after which the bodies share no inner point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PenetrationBounds {
    /// No shorter translation parts the bodies; zero for bodies that are apart or touch, and if
    /// nothing is known.
    pub lower: f64,
    /// The length of [`shift`](Self::shift), rounded up.
    pub upper: f64,
    /// A translation of B, in A's frame, after which the bodies are proven apart.
    pub shift: Vector3<f64>,
    /// Queries of the bodies that were needed.
    pub queries: u32,
}

/// Two bodies whose depth is sought.
trait Overlap {
    /// Returns a lower bound of the distance of the bodies at a pose, if they are proven apart.
    fn apart(&mut self, pose: &RelativePose) -> Option<f64>;

    /// Returns a lower bound of the depth at a pose, and the translation of B that ends the overlap
    /// found; `None` if no inner point is found.
    fn deepest(&mut self, pose: &RelativePose) -> Option<(f64, Vector3<f64>)>;

    /// Returns the translation of B that parts convex bodies about both, if there are any.
    fn by_hulls(&self, pose: &RelativePose) -> Option<Vector3<f64>>;

    /// The boxes of both bodies in their own frames.
    fn boxes(&self) -> [(Point3<f64>, Point3<f64>); 2];
}

struct Search<'a, O> {
    bodies: &'a mut O,
    at: Isometry3<f64>,
    /// A distance within the rounding of a pose that is shifted.
    noise: f64,
    queries: u32,
}

impl<O: Overlap> Search<'_, O> {
    fn shifted(&self, shift: &Vector3<f64>) -> Option<RelativePose> {
        RelativePose::from_isometry(&(Translation3::from(*shift) * self.at)).ok()
    }

    fn parts(&mut self, shift: &Vector3<f64>) -> bool {
        self.queries += 1;
        let pose = self.shifted(shift);
        let apart = pose.and_then(|pose| self.bodies.apart(&pose));
        apart.is_some_and(|lower| lower > self.noise)
    }

    /// A translation that moves the balls about the boxes apart.
    fn far(&self) -> Vector3<f64> {
        let [(low_a, high_a), (low_b, high_b)] = self.bodies.boxes();
        let middle = |low: Point3<f64>, high: Point3<f64>| low + (high - low) * 0.5;
        let apart = self.at * middle(low_b, high_b) - middle(low_a, high_a);
        let length = sqrt(apart.norm_squared());
        let n = if length > 0.0 { apart / length } else { Vector3::x() };
        let reach = sqrt((high_a - low_a).norm_squared()) + sqrt((high_b - low_b).norm_squared());
        n * (0.5 * reach * BEYOND + 4.0 * self.noise - length).max(0.0)
    }

    /// Moves B by the deepest overlap found until the bodies are apart.
    fn pushed(&mut self, first: (f64, Vector3<f64>)) -> Option<Vector3<f64>> {
        let mut shift = first.1;
        for _ in 0..PUSHES {
            if self.parts(&shift) {
                return Some(shift);
            }
            let pose = self.shifted(&shift)?;
            match self.bodies.deepest(&pose) {
                Some((_, more)) => shift += more * BEYOND,
                // Edges cross, and no inner point is found.
                None => shift *= 1.25,
            }
        }
        None
    }

    /// Shortens a translation that parts the bodies, to no less than `lower`.
    fn shortened(&mut self, shift: Vector3<f64>, lower: f64) -> Vector3<f64> {
        let length = sqrt(shift.norm_squared());
        let (mut low, mut high) = ((lower / length).min(1.0), 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if !(middle > low && middle < high) {
                break;
            }
            if self.parts(&(shift * middle)) {
                high = middle;
            } else {
                low = middle;
            }
        }
        shift * high
    }

    fn run(mut self, pose: &RelativePose) -> PenetrationBounds {
        let deepest = self.bodies.deepest(pose);
        let lower = deepest.map_or(0.0, |d| (d.0 - self.noise).max(0.0));
        let mut best = self.far();
        let starts = [self.bodies.by_hulls(pose), deepest.and_then(|d| self.pushed(d))];
        for start in starts.into_iter().flatten() {
            let start = start * BEYOND;
            if start.norm_squared() > 0.0 && self.parts(&start) {
                let shift = self.shortened(start, lower);
                if shift.norm_squared() < best.norm_squared() {
                    best = shift;
                }
            }
        }
        PenetrationBounds {
            lower: lower.min(sqrt(best.norm_squared())),
            upper: sqrt(best.norm_squared()) * (1.0 + 4.0 * UNIT),
            shift: best,
            queries: self.queries,
        }
    }
}

fn bounds<O: Overlap>(bodies: &mut O, pose: &RelativePose, size: f64) -> PenetrationBounds {
    let noise = 4.0 * CERTIFICATE * UNIT * size;
    if bodies.apart(pose).is_some() {
        return PenetrationBounds {
            lower: 0.0,
            upper: 0.0,
            shift: Vector3::zeros(),
            queries: 1,
        };
    }
    let search = Search {
        bodies,
        at: relative(pose),
        noise,
        queries: 1,
    };
    search.run(pose)
}

impl MeshTracker {
    /// Returns bounds of the penetration depth of two solids: an interval by a name of its own, no
    /// [`distance`](Self::distance). `None` if a mesh is a surface.
    ///
    /// Below stands the depth of the deepest of some thousand vertices inside the other body, above
    /// a translation that parts the bodies. The interval may be wide: crossing edges without a
    /// vertex inside give no lower bound, and slots lead the search astray. Takes some dozens of
    /// queries, milliseconds for meshes of thousands of triangles.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny::{Mesh, MeshTracker, RelativePose};
    ///
    /// let ball = Mesh::from_convex(&solids::geodesic_sphere(3, 1.0)?)?;
    /// let at = RelativePose::from_isometry(&Isometry3::translation(1.7, 0.0, 0.1))?;
    /// let found = MeshTracker::new().penetration(&ball, &ball, &at);
    /// let found = found.expect("two solids");
    /// assert!(found.lower > 0.2 && found.upper < 0.31 && found.lower <= found.upper);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn penetration(&mut self, a: &Mesh, b: &Mesh, a_from_b: &RelativePose) -> Option<PenetrationBounds> {
        let posed = Posed::new(a, b, a_from_b).filter(|_| a.is_solid() && b.is_solid())?;
        let size = posed.frame.size * a.unit();
        Some(bounds(&mut Meshes { tracker: self, a, b }, a_from_b, size))
    }
}

struct Meshes<'a> {
    tracker: &'a mut MeshTracker,
    a: &'a Mesh,
    b: &'a Mesh,
}

impl Overlap for Meshes<'_> {
    fn apart(&mut self, pose: &RelativePose) -> Option<f64> {
        let found = self.tracker.closest(self.a, self.b, pose);
        (found.class == Class::Separated).then_some(found.lower)
    }

    fn deepest(&mut self, pose: &RelativePose) -> Option<(f64, Vector3<f64>)> {
        let posed = Posed::new(self.a, self.b, pose)?;
        let frame = &posed.frame;
        let (unit_a, unit_b) = (self.a.unit(), self.b.unit());
        let doubt = 2.0 * frame.error;
        let mut best = None;
        inner(
            self.a,
            points(self.b).map(|p| frame.point(&p)),
            doubt,
            &mut |depth, way| {
                keep_deeper(&mut best, (depth * unit_a, way * unit_a));
            },
        );
        let ratio = unit_a / unit_b;
        inner(
            self.b,
            points(self.a).map(|p| posed.back(&p)),
            doubt * ratio,
            &mut |depth, way| {
                keep_deeper(&mut best, (depth * unit_b, frame.rotation * way * -unit_b));
            },
        );
        best
    }

    fn by_hulls(&self, pose: &RelativePose) -> Option<Vector3<f64>> {
        by_hulls(&self.a.hull().ok()?, &self.b.hull().ok()?, pose)
    }

    fn boxes(&self) -> [(Point3<f64>, Point3<f64>); 2] {
        [self.a.aabb(), self.b.aabb()]
    }
}

fn keep_deeper(best: &mut Option<(f64, Vector3<f64>)>, new: (f64, Vector3<f64>)) {
    if best.is_none_or(|b| b.0 < new.0) {
        *best = Some(new);
    }
}

/// Some thousand vertices of a mesh, spread over the surface.
fn points(mesh: &Mesh) -> impl Iterator<Item = Vector3<f64>> + '_ {
    let step = mesh.points.len().div_ceil(DEEP_POINTS);
    mesh.points.iter().step_by(step).copied()
}

/// The depth of each point that is certainly inside a solid, and the way out, both at least right
/// to `doubt`.
fn inner(
    mesh: &Mesh,
    points: impl Iterator<Item = Vector3<f64>>,
    doubt: f64,
    found: &mut dyn FnMut(f64, Vector3<f64>),
) {
    for p in points {
        let is_boxed = (0..3).all(|k| p[k] >= mesh.low[k] && p[k] <= mesh.high[k]);
        if !is_boxed || mesh.winding(&p).is_none_or(|w| w == 0) {
            continue;
        }
        let nearest = mesh.nearest(&p);
        let depth = sqrt(nearest.square) - doubt;
        // Beyond doubt, the point is on its side of the surface.
        if depth > doubt {
            found(depth, nearest.point - p);
        }
    }
}

/// The translation of B that parts two convex bodies; `None` if they are apart.
fn by_hulls(a: &ConvexPolyhedron, b: &ConvexPolyhedron, pose: &RelativePose) -> Option<Vector3<f64>> {
    let found = Tracker::new().closest(a, b, pose);
    (found.upper <= 0.0 && found.lower.is_finite()).then(|| found.normal.into_inner() * -found.lower)
}

impl CompositeTracker {
    /// Returns bounds of the penetration depth of two bodies of pieces: an interval by a name of
    /// its own, no [`distance`](Self::distance).
    ///
    /// Below stands the depth of the deepest pair of pieces, above a translation that parts the
    /// bodies. Every pair of pieces is measured, then dozens of queries.
    pub fn penetration(&mut self, a: &Composite, b: &Composite, a_from_b: &RelativePose) -> Option<PenetrationBounds> {
        let posed = Posed::new(a, b, a_from_b)?;
        let size = posed.frame.size * super::parts::Parted::stored_unit(a);
        Some(bounds(&mut Pieces { tracker: self, a, b }, a_from_b, size))
    }
}

struct Pieces<'a> {
    tracker: &'a mut CompositeTracker,
    a: &'a Composite,
    b: &'a Composite,
}

impl Overlap for Pieces<'_> {
    fn apart(&mut self, pose: &RelativePose) -> Option<f64> {
        let found = self.tracker.closest(self.a, self.b, pose);
        (found.class == Class::Separated).then_some(found.lower)
    }

    fn deepest(&mut self, pose: &RelativePose) -> Option<(f64, Vector3<f64>)> {
        let placed = Placed::of(pose, self.a, self.b);
        let mut best = None;
        for p in self.a.pieces() {
            for q in self.b.pieces() {
                let found = ShapeTracker::new().closest(&p.shape, &q.shape, &placed.between(&p.pose, &q.pose).0);
                if found.class == Class::Overlapping && found.upper < 0.0 {
                    let way = p.pose.rotation * found.normal.into_inner() * -found.distance;
                    keep_deeper(&mut best, (-found.upper, way));
                }
            }
        }
        best
    }

    fn by_hulls(&self, pose: &RelativePose) -> Option<Vector3<f64>> {
        by_hulls(&hull(self.a)?, &hull(self.b)?, pose)
    }

    fn boxes(&self) -> [(Point3<f64>, Point3<f64>); 2] {
        [self.a.aabb(), self.b.aabb()]
    }
}

/// The hull of a body whose pieces are polyhedra.
fn hull(body: &Composite) -> Option<ConvexPolyhedron> {
    let mut points = Vec::new();
    for piece in body.pieces() {
        let of = |shape: &Shape| match (shape.core(), shape.round()) {
            (Core::Polyhedron(core), 0.0) => Some(core.clone()),
            _ => None,
        };
        points.extend(of(&piece.shape)?.vertex_points().map(|p| piece.pose * p));
    }
    ConvexPolyhedron::from_points(&points).ok()
}

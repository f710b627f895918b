//! Pairs with a composite or a mesh.

use alloc::boxed::Box;
use alloc::string::{String, ToString};
use alloc::sync::Arc;

use nalgebra::Point3;

use super::engine::BodyShapes;
#[cfg(feature = "serde")]
use super::mixed::StoredTracker;
use super::pair::Asked;
use super::tracked::{AnyKinds, PairOfKinds, Tracked, counters};
use super::work::PairWork;
use crate::base::pose::{Operand, RelativePose};
use crate::body::shape::Shape;
use crate::composite::mesh::Mesh;
use crate::composite::mesh::tracker::MeshTracker;
use crate::composite::parts::{Parted, PartsRef};
use crate::composite::penetration::PenetrationBounds;
use crate::composite::pieces::{Composite, CompositeTracker};
use crate::composite::separation::{CompositePair, MeshPair, ball_about};
use crate::pair::outcome::Decision;
use crate::pair::question::Question;
use crate::pair::spot::Answer;
use crate::pair_tracker::geometry::{GeometryRef, Lent};

/// Two bodies of which one is a composite or a mesh, and the other of any kind but a surface: a
/// convex body is a single leaf with its own support points.
pub(super) type TrackedPieces = Tracked<CompositeTracker, Composite>;

/// Two meshes, or a mesh and a composite whose surface is one.
pub(super) type TrackedMeshes = Tracked<MeshTracker, Mesh>;

/// Returns a tracker of a pair without a surface; `None` if both are convex.
pub(super) fn tracker(bodies: BodyShapes<'_>) -> Option<Box<dyn AnyKinds>> {
    use Lent::{Composite as C, Mesh as M};
    let (a, b) = bodies;
    match (a.0, b.0) {
        (M(_), _) | (_, M(_)) => match (as_mesh(a), as_mesh(b)) {
            (Some(x), Some(y)) => Some(TrackedMeshes::new([x, y])),
            _ => Some(of_pieces(bodies)),
        },
        (C(_), _) | (_, C(_)) => Some(of_pieces(bodies)),
        _ => None,
    }
}

/// Returns a tracker of two bodies of parts of which a composite stays one.
pub(super) fn of_pieces((a, b): BodyShapes<'_>) -> Box<dyn AnyKinds> {
    let piece = |shape: Arc<Shape>| Arc::new(Composite::from(Arc::unwrap_or_clone(shape)));
    TrackedPieces::new([a, b].map(|own| own.to_shape().map(piece)))
}

/// Returns the mesh that is equal to a body that is not convex: `Some(None)` for the body itself.
/// Pieces that a mesh does not hold, as points, segments and needles, stay pieces.
fn as_mesh(own: GeometryRef) -> Option<Option<Arc<Mesh>>> {
    match own.0 {
        Lent::Mesh(_) => Some(None),
        Lent::Composite(body) => body.get().stand_in().map(|mesh| Some(Arc::new(mesh))),
        _ => None,
    }
}

/// Returns a body of parts, or the composite that stands for a convex one.
fn parts<'p>(own: GeometryRef<'p>, stand_in: Option<&'p Composite>) -> Option<PartsRef<'p>> {
    match own.0 {
        Lent::Composite(body) => Some(PartsRef::Pieces(body.get())),
        Lent::Mesh(mesh) => Some(PartsRef::Mesh(mesh.get())),
        _ => stand_in.map(PartsRef::Pieces),
    }
}

impl PairOfKinds for TrackedPieces {
    type Pair<'p> = CompositePair<'p>;

    fn pair<'p>(&'p mut self, (a, b): BodyShapes<'p>) -> Option<CompositePair<'p>> {
        let [x, y] = &self.stand_ins;
        Some(CompositePair {
            a: parts(a, x.as_deref())?,
            b: parts(b, y.as_deref())?,
            tracker: &mut self.tracker,
        })
    }

    fn ball(&self, (a, b): BodyShapes<'_>, of: Operand) -> Option<(Point3<f64>, f64)> {
        let [x, y] = &self.stand_ins;
        let (own, stand_in) = if of == Operand::A { (a, x) } else { (b, y) };
        parts(own, stand_in.as_deref()).map(|body| ball_about(body.corners_of_box()))
    }

    counters!(of_trees, Pieces);
}

impl PairOfKinds for TrackedMeshes {
    type Pair<'p> = MeshPair<'p>;

    fn pair<'p>(&'p mut self, (a, b): BodyShapes<'p>) -> Option<MeshPair<'p>> {
        let (tracker, [a, b]) = self.sides([a.mesh(), b.mesh()])?;
        Some(MeshPair { a, b, tracker })
    }

    fn ball(&self, (a, b): BodyShapes<'_>, of: Operand) -> Option<(Point3<f64>, f64)> {
        self.side([a.mesh(), b.mesh()], of).map(|mesh| ball_about(mesh.aabb()))
    }

    counters!(of_trees, Triangles);
}

impl Asked for CompositePair<'_> {
    fn answer(&mut self, pose: &RelativePose, question: &Question) -> Answer {
        self.ask(pose, question)
    }

    fn within(&mut self, pose: &RelativePose, d: f64, question: &Question) -> Decision {
        self.ask_within(pose, d, question)
    }

    fn lower_bound(&mut self, pose: &RelativePose) -> f64 {
        self.tracker.lower_bound(&self.a, &self.b, pose)
    }

    fn penetration(&mut self, pose: &RelativePose) -> Option<PenetrationBounds> {
        self.tracker.penetration(&self.a, &self.b, pose)
    }
}

impl Asked for MeshPair<'_> {
    fn answer(&mut self, pose: &RelativePose, question: &Question) -> Answer {
        self.ask(pose, question)
    }

    fn within(&mut self, pose: &RelativePose, d: f64, question: &Question) -> Decision {
        self.ask_within(pose, d, question)
    }

    fn lower_bound(&mut self, pose: &RelativePose) -> f64 {
        self.tracker.lower_bound(self.a, self.b, pose)
    }

    fn penetration(&mut self, pose: &RelativePose) -> Option<PenetrationBounds> {
        self.tracker.penetration(self.a, self.b, pose)
    }

    fn check(&mut self, pose: &RelativePose) -> Result<(), String> {
        let checked = self.tracker.audit(self.a, self.b, pose);
        checked.map_err(|fault| fault.to_string())
    }
}

//! The distance of a mesh by the pieces that stand for it.

use super::engine::AnyTracker;
use super::pair::Asked;
use super::parted::TrackedPieces;
use super::tracker::PairTracker;
use crate::base::pose::RelativePose;
use crate::composite::decomposition::Decomposition;
use crate::composite::parts::PartsRef;
use crate::composite::separation::CompositePair;
use crate::pair::outcome::Distance;
use crate::pair::question::Question;
use crate::pair::spot::Answer;
use crate::pair_tracker::geometry::{GeometryRef, ShapeKind};

impl Decomposition {
    /// Returns bounds of the distance of the mesh from another geometry, by the distance of the
    /// pieces.
    ///
    /// If the bounds leave open whether the bodies meet, the class is
    /// [`Class::Undecided`](crate::Class::Undecided); no depth is told. A surface of patches is
    /// measured against the mesh.
    pub fn distance<'g>(
        &'g self,
        tracker: &mut PairTracker,
        other: impl Into<GeometryRef<'g>>,
        mesh_from_other: &RelativePose,
    ) -> Distance {
        let other = other.into();
        let pieces = GeometryRef::from(self.pieces());
        if other.kind() == ShapeKind::Surface {
            return tracker.distance(self.mesh(), other, mesh_from_other);
        }
        tracker.distance_by_pieces(pieces, other, mesh_from_other, |found, other| {
            self.bounds(found, other, mesh_from_other)
        })
    }
}

impl PairTracker {
    /// Measures two bodies of parts, the first of which is a composite that stays one beside a
    /// mesh.
    fn distance_by_pieces(
        &mut self,
        a: GeometryRef,
        b: GeometryRef,
        a_from_b: &RelativePose,
        bounds: impl FnOnce(&Answer, &PartsRef) -> Distance,
    ) -> Distance {
        let pair = [a, b].map(|body| body.fingerprint().with(*b"pieces  ", 0.0));
        let followed = self.kept(pair, || AnyTracker::of_pieces((a, b)));
        let mut over = followed.tracker.over((a, b));
        match over.of_kinds::<TrackedPieces>() {
            Some(CompositePair { a, b, tracker }) => bounds(&tracker.closest(&a, &b, a_from_b), &b),
            None => Distance::from(&over.answer(a_from_b, &Question::new())),
        }
    }
}

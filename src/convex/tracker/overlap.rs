//! The four vertex pairs that prove an overlap.

use super::{Tracker, has_the_unit};
use crate::base::num::each::Each;
use crate::base::pose::RelativePose;
use crate::body::polyhedron::{ConvexPolyhedron, FeaturePair, VertexId};
use crate::convex::minimum::OverlapProof;
use crate::pair::draft::Draft;
use crate::pair::posed::PosedPair;

impl Tracker {
    /// Returns four pairs of vertices, of A and of B, that prove that the bodies share a point.
    ///
    /// The differences of the four pairs, a vertex of A minus a vertex of B at this pose, are the
    /// corners of a tetrahedron that contains the origin. Anybody can check this by the signs of
    /// four volumes, without trust in this library and without a number from it.
    ///
    /// Returns `None` if the bodies are apart, or if they touch or overlap by less than rounding:
    /// then no four pairs are certain in double precision. The query starts from the proof of the
    /// last overlap, if the tracker has one, and leaves the tracker as it is.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny::{RelativePose, Tracker};
    ///
    /// let die = solids::cuboid(Vector3::new(0.5, 0.5, 0.5))?;
    /// let at = |x: f64| Isometry3::translation(x, 0.1, 0.2);
    /// let pose = |x: f64| RelativePose::from_isometry(&at(x));
    /// let pairs = Tracker::new().overlap_proof(&die, &die, &pose(0.9)?);
    /// let points = pairs.expect("they overlap").map(|[x, y]| {
    ///     die.vertex(x).unwrap() - at(0.9) * die.vertex(y).unwrap()
    /// });
    /// let side = |a: usize, b: usize, c: usize| {
    ///     points[a].dot(&points[b].cross(&points[c])) > 0.0
    /// };
    /// let inside = [side(1, 2, 3), side(2, 0, 3), side(0, 1, 3), side(1, 0, 2)];
    /// assert!(inside == [true; 4] || inside == [false; 4]);
    /// assert!(Tracker::new().overlap_proof(&die, &die, &pose(1.1)?).is_none());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn overlap_proof(
        &self,
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
        a_from_b: &RelativePose,
    ) -> Option<[[VertexId; 2]; 4]> {
        if a.exponent != b.exponent && has_the_unit(b, a) {
            let pairs = proven(b, a, &a_from_b.swapped(), FeaturePair::FIRST, OverlapProof::default());
            return pairs.map(|pairs| pairs.each(|[y, x]| [x, y]));
        }
        let features = self.last.filter(|pair| pair.is_of(a, b));
        let known = self.overlap_proof.unwrap_or_default();
        proven(a, b, a_from_b, features.unwrap_or(FeaturePair::FIRST), known)
    }
}

fn proven(
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    a_from_b: &RelativePose,
    features: FeaturePair,
    known: OverlapProof,
) -> Option<[[VertexId; 2]; 4]> {
    let posed = PosedPair::new(a, b, a_from_b).ok()?;
    let found = known.renewed(&posed, features, &mut Draft::starting_at(features))?;
    Some(found.vertex_pairs())
}

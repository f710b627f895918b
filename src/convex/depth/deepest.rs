//! The deepest points after a search has ended.

use crate::base::num::double_double::DoubleDouble;
use crate::base::num::scalar::{Scalar, Vec3, scaled, sub};
use crate::base::tolerance::{AGREE_DEPTH, AGREE_WITNESS, UNIT};
use crate::convex::minimum::simplex::Simplex;
use crate::convex::minimum::witnesses::witnesses;
use crate::pair::difference::MinkowskiPoint;

use crate::convex::depth::foot::{WitnessPoints, foot};
use crate::convex::depth::result::{Best, SearchEnd};
use crate::convex::depth::search::DepthSearch;

impl<T: Scalar> DepthSearch<'_, T> {
    /// Returns the deepest points and three vertices of their facet.
    ///
    /// If the features of the best direction do not contain the deepest points, they are the
    /// surface point nearest to the foot of the origin on the best plane. The surface crosses the
    /// ray along the normal between both bounds, hence at the foot if the bounds agree.
    pub(super) fn deepest(
        &self,
        best: &Best<T>,
        weakest: u32,
        end: SearchEnd,
    ) -> ([MinkowskiPoint<T>; 3], WitnessPoints) {
        if let Some(foot) = best.facet.and_then(|f| foot(self.posed, f, &best.rounded())) {
            return (self.surface.vertices(weakest), foot);
        }
        // Relative to L in either arithmetic, not to the distance of far origins.
        let close = T::from(AGREE_DEPTH * self.posed.size());
        let plane = best.height - close;
        let all = 0..self.surface.triangles.len() as u32;
        let flat = all.clone().filter(|t| self.surface.height(*t, &best.normal) >= plane);
        let order = || core::iter::once(weakest).chain(flat.clone()).chain(all.clone());
        let found = self.nearest::<T>(order(), best, close);
        if T::UNIT < UNIT || found.1 <= AGREE_WITNESS * self.posed.size() {
            return (self.surface.vertices(found.0), found.2);
        }
        // In f64 the barycentric coordinates of needles are wrong.
        let mut found = self.nearest::<DoubleDouble>(flat.clone().chain(core::iter::once(found.0)), best, close);
        if end == SearchEnd::Closed && found.1 > AGREE_WITNESS * self.posed.size() {
            found = self.nearest::<DoubleDouble>(order(), best, close);
        }
        (self.surface.vertices(found.0), found.2)
    }

    /// Returns the first triangle close enough to the foot of the origin on the best plane (if none
    /// is, the nearest triangle), the distance from the foot, and the witnesses there.
    fn nearest<S: Scalar>(
        &self,
        triangles: impl Iterator<Item = u32>,
        best: &Best<T>,
        close: T,
    ) -> (u32, f64, WitnessPoints) {
        // Converts both parts of a double-double.
        let as_s = |x: T| S::from(x.value()) + S::from((x - T::from(x.value())).value());
        let fine = |v: &Vec3<T>| v.map(as_s);
        let target = scaled(&fine(&best.normal), as_s(best.height));
        let mut found: Option<(u32, f64, Simplex<S>)> = None;
        for t in triangles {
            let shifted = self.surface.vertices(t).map(|c| MinkowskiPoint {
                a: c.a,
                b: c.b,
                w: sub(&fine(&c.w), &target),
            });
            let simplex = Simplex::triangle(shifted);
            let off = simplex.witness_distance().value();
            if found.as_ref().is_none_or(|f| off < f.1) {
                found = Some((t, off, simplex));
            }
            if off <= close.value() {
                break;
            }
        }
        let (t, off, simplex) = found.unwrap_or_else(|| {
            let c = self.surface.vertices(0)[0];
            let at = MinkowskiPoint {
                a: c.a,
                b: c.b,
                w: fine(&c.w),
            };
            (0, f64::INFINITY, Simplex::vertex(at))
        });
        (t, off, witnesses(self.posed, &simplex))
    }
}

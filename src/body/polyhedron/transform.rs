//! Bodies scaled and moved.

use alloc::vec::Vec;
use nalgebra::{Isometry3, Point3};

use crate::body::polyhedron::{BuildError, ConvexPolyhedron};

impl ConvexPolyhedron {
    /// Returns the body with all coordinates multiplied by a positive factor, as from millimetres
    /// to metres.
    ///
    /// The result is the hull of the scaled vertices. Scaling by a power of two is exact; any other
    /// factor rounds every coordinate, and a face of more than three vertices may become several
    /// faces, planar up to that rounding. Vertices keep the caller's indices
    /// ([`source_vertex`](Self::source_vertex)); the ids of features are new, and
    /// [`source_face`](Self::source_face) is `None`.
    ///
    /// ```
    /// use lin_canny::nalgebra::Vector3;
    /// use lin_canny::polyhedron::solids;
    ///
    /// let in_millimetres = solids::cuboid(Vector3::new(50.0, 20.0, 20.0))?;
    /// let in_metres = in_millimetres.scaled(1e-3)?;
    /// assert_eq!(in_metres.aabb().1.x, 0.05);
    /// # Ok::<(), lin_canny::BuildError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// A factor that is not a positive finite number, or an extent of the result outside
    /// 1e-100..1e100.
    pub fn scaled(&self, factor: f64) -> Result<Self, BuildError> {
        if !(factor > 0.0 && factor.is_finite()) {
            return Err(BuildError::BadFactor { value: factor });
        }
        self.mapped(|p| p * factor)
    }

    /// Returns the body moved by a pose, in the frame that the pose leads to: for bodies that are
    /// measured in another frame once and for all, such as a collision mesh with an origin of its
    /// own. For a body that moves, pass the pose to the query instead.
    ///
    /// The result is the hull of the moved vertices. Rounding may split faces, and names are kept,
    /// as by [`scaled`](Self::scaled).
    ///
    /// # Errors
    ///
    /// A pose that gives coordinates that are not finite or too large.
    #[doc(alias = "translated")]
    pub fn transformed(&self, pose: &Isometry3<f64>) -> Result<Self, BuildError> {
        self.mapped(|p| pose * p)
    }

    /// Returns the body of the same kind (polyhedron, polygon, segment or point) with mapped
    /// vertices.
    fn mapped(&self, map: impl Fn(Point3<f64>) -> Point3<f64>) -> Result<Self, BuildError> {
        let rim = self.first_side();
        let order: Vec<u32> = if rim.is_empty() {
            (0..self.vertex_count() as u32).collect()
        } else {
            rim
        };
        let place = |&v: &u32| map(self.to_user(&self.points[v as usize]));
        let points: Vec<Point3<f64>> = order.iter().map(place).collect();
        let mut body = match *points {
            [p] => Self::point(p)?,
            [p, q] => Self::segment(p, q)?,
            _ if self.face_count() == 2 => Self::polygon(&points)?,
            _ => Self::from_points(&points)?,
        };
        for source in &mut body.source {
            *source = self.source[order[*source as usize] as usize];
        }
        Ok(body)
    }
}

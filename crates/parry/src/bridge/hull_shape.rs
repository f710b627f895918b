//! Implements parry's traits for [`Hull`].

use std::sync::Arc;

use lin_canny::nalgebra::Vector3;
use lin_canny::{BoxHint, ConvexPolyhedron, FaceId, Geometry, Shape as CoreShape, VertexId};

use super::hull::{Hull, Solid};
use super::number::{down, isometry, narrow, up, wide, wide_point};
use super::parry::bounding_volume::{Aabb, BoundingSphere};
use super::parry::mass_properties::MassProperties;
use super::parry::math::{Pose, Real, Vector};
use super::parry::query::{PointProjection, PointQuery, Ray, RayCast, RayIntersection};
use super::parry::shape::{
    FeatureId, PackedFeatureId, PolygonalFeature, PolygonalFeatureMap, Shape, ShapeType, SubShapeId, SupportMap,
    TypedShape,
};
use super::ray_point::{cast_ray, project};

impl Solid {
    fn vertex(&self, vertex: VertexId) -> Vector {
        self.body.vertex(vertex).map_or(Vector::ZERO, |p| narrow(&p.coords))
    }

    /// Returns the support vertex along `dir`, and its face that is most nearly perpendicular to
    /// `dir`.
    fn support_face(&self, dir: &Vector3<f64>) -> (VertexId, Option<FaceId>) {
        let top = self.body.extreme_vertex(dir);
        let along = |f: &FaceId| self.body.face_plane(*f).map_or(f64::NEG_INFINITY, |(n, _)| n.dot(dir));
        let faces = self.body.vertex_faces(top);
        (top, faces.max_by(|f, g| along(f).total_cmp(&along(g))))
    }

    /// Returns the face whose plane is closest to a point inside the body, and the distance.
    fn nearest_face(&self, p: &Vector3<f64>) -> Option<(Vector3<f64>, f64, FaceId)> {
        let planes = self.body.faces().filter_map(|f| {
            let (n, offset) = self.body.face_plane(f)?;
            Some((n.into_inner(), offset - n.dot(p), f))
        });
        planes.min_by(|x, y| x.1.total_cmp(&y.1))
    }
}

impl SupportMap for Solid {
    fn local_support_point(&self, dir: Vector) -> Vector {
        self.vertex(self.body.extreme_vertex(&wide(dir)))
    }
}

impl SupportMap for Hull {
    fn local_support_point(&self, dir: Vector) -> Vector {
        let top = self.core.local_support_point(dir);
        match wide(dir).try_normalize(0.0) {
            Some(n) if self.border_radius > 0.0 => top + narrow(&n) * self.border_radius,
            _ => top,
        }
    }
}

/// The support feature: four vertices around the boundary of the support face, including the
/// support vertex.
impl PolygonalFeatureMap for Solid {
    fn local_support_feature(&self, dir: Vector, out: &mut PolygonalFeature) {
        let (top, face) = self.support_face(&wide(dir));
        let Some(face) = face else {
            return support_of_flat(self, top, out);
        };
        let count = self.body.face_vertices(face).count();
        let first = self.body.face_vertices(face).position(|v| v == top).unwrap_or(0);
        let kept = count.min(4);
        // Positions around the boundary, in its order from the support vertex on.
        let place = |k: usize| (first + k * count / kept) % count;
        for (k, (v, e)) in self
            .body
            .face_vertices(face)
            .zip(self.body.face_edges(face))
            .enumerate()
        {
            for slot in (0..kept).filter(|&slot| place(slot) == k) {
                out.vertices[slot] = self.vertex(v);
                out.vids[slot] = PackedFeatureId::vertex(v.index() as u32);
                out.eids[slot] = PackedFeatureId::edge(e.index() as u32);
            }
        }
        out.fid = PackedFeatureId::face(face.index() as u32);
        out.num_vertices = kept;
    }

    fn is_convex_polyhedron(&self) -> bool {
        true
    }
}

/// Writes the support feature of a segment or point.
fn support_of_flat(hull: &Solid, top: VertexId, out: &mut PolygonalFeature) {
    let ids: Vec<VertexId> = hull.body.vertices().take(2).collect();
    for slot in 0..4 {
        let v = ids.get(slot).copied().unwrap_or(top);
        out.vertices[slot] = hull.vertex(v);
        out.vids[slot] = PackedFeatureId::vertex(v.index() as u32);
        out.eids[slot] = PackedFeatureId::edge(0);
    }
    out.fid = PackedFeatureId::face(0);
    out.num_vertices = ids.len();
}

impl RayCast for Hull {
    /// Clips the ray by the planes of all faces.
    ///
    /// No ray hits a flat body without border. A ray that starts inside a rounded hull hits at its
    /// start, filled or hollow.
    fn cast_local_ray_and_get_normal(&self, ray: &Ray, max: Real, solid: bool) -> Option<RayIntersection> {
        match self.rounded_geometry() {
            Some(rounded) => cast_ray(&rounded, ray, max),
            None => self.clip_ray(ray, max, solid),
        }
    }
}

impl Hull {
    /// Returns the rounded shape; `None` for a hull without a border.
    fn rounded_geometry(&self) -> Option<Geometry> {
        let border = f64::from(self.border_radius);
        let rounded = (border > 0.0).then(|| CoreShape::from(self.core.body.clone()).rounded(border));
        rounded?.ok().map(Geometry::from)
    }

    fn clip_ray(&self, ray: &Ray, max: Real, solid: bool) -> Option<RayIntersection> {
        let (origin, dir) = (wide(ray.origin), wide(ray.dir));
        let (mut enter, mut leave) = ((0.0, None), (f64::INFINITY, None));
        for face in self.core.body.faces() {
            let (n, offset) = self.core.body.face_plane(face)?;
            let (rise, height) = (n.dot(&dir), n.dot(&origin) - offset);
            // Comparisons are written so that NaN misses.
            if rise < 0.0 {
                let t = -height / rise;
                if t > enter.0 || (t == enter.0 && enter.1.is_none()) {
                    enter = (t, Some((face, n)));
                }
            } else if rise > 0.0 {
                let t = -height / rise;
                if t < leave.0 {
                    leave = (t, Some((face, n)));
                }
            } else if !(height <= 0.0) {
                return None;
            }
        }
        if !(enter.0 <= leave.0) || self.core.body.face_count() < 3 {
            return None;
        }
        let hit = |t: f64, normal: Vector3<f64>, feature| {
            (t <= f64::from(max)).then(|| RayIntersection::new(t as Real, narrow(&normal), feature))
        };
        let feature = |f: FaceId| FeatureId::Face(f.index() as u32);
        match (enter.1, leave.1) {
            (Some((f, n)), _) => hit(enter.0, n.into_inner(), feature(f)),
            (None, _) if solid => hit(0.0, Vector3::zeros(), FeatureId::Unknown),
            (None, Some((f, n))) => hit(leave.0, -n.into_inner(), feature(f)),
            (None, None) => None,
        }
    }
}

impl PointQuery for Hull {
    /// If the hull has no border, containment is exact for the stored body and the given point.
    fn project_local_point(&self, pt: Vector, solid: bool) -> PointProjection {
        match self.rounded_geometry() {
            Some(rounded) => project(&rounded, pt, solid),
            None => self.projection(pt, solid).0,
        }
    }

    fn project_local_point_and_get_feature(&self, pt: Vector) -> (PointProjection, FeatureId) {
        match self.rounded_geometry() {
            Some(rounded) => (project(&rounded, pt, false), FeatureId::Unknown),
            None => self.projection(pt, false),
        }
    }

    fn contains_local_point(&self, pt: Vector) -> bool {
        match self.rounded_geometry() {
            Some(rounded) => project(&rounded, pt, true).is_inside,
            None => self.core.body.contains(&wide_point(pt)),
        }
    }
}

impl Hull {
    fn projection(&self, pt: Vector, solid: bool) -> (PointProjection, FeatureId) {
        let p = wide_point(pt);
        let inside = self.core.body.contains(&p);
        if inside && solid {
            return (PointProjection::new(true, pt), FeatureId::Unknown);
        }
        let nearest = self
            .core
            .nearest_face(&p.coords)
            .filter(|_| inside && self.core.body.face_count() > 2);
        if let Some((n, depth, face)) = nearest {
            let foot = p.coords + n * depth;
            return (
                PointProjection::new(true, narrow(&foot)),
                FeatureId::Face(face.index() as u32),
            );
        }
        let foot = self.core.body.closest_point(&p).unwrap_or(p);
        let top = self.core.body.extreme_vertex(&(p - foot));
        let feature = FeatureId::Vertex(top.index() as u32);
        (PointProjection::new(inside, narrow(&foot.coords)), feature)
    }
}

impl Shape for Hull {
    fn compute_local_aabb(&self) -> Aabb {
        self.aabb
    }

    fn compute_local_bounding_sphere(&self) -> BoundingSphere {
        self.ball
    }

    fn clone_dyn(&self) -> Box<dyn Shape> {
        Box::new(self.clone())
    }

    /// Returns the hull of the scaled vertices, with the same border; `None` if they form no body.
    fn scale_dyn(&self, scale: Vector, _: u32) -> Option<Box<dyn Shape>> {
        let scale = wide(scale);
        let points: Vec<_> = self
            .core
            .body
            .vertex_points()
            .map(|p| p.coords.component_mul(&scale).into())
            .collect();
        let body = match self.core.body.face_count() {
            0 => return None,
            2 => ConvexPolyhedron::polygon(&points),
            _ => ConvexPolyhedron::from_points(&points),
        };
        let hull = Hull::new(Arc::new(body.ok()?));
        Some(Box::new(hull.rounded(self.border_radius).ok()?))
    }

    fn compute_aabb(&self, pose: &Pose) -> Aabb {
        let (low, high) = self.core.body.aabb_at(&isometry(pose), &mut BoxHint::default());
        let (low, high): ([f64; 3], [f64; 3]) = (low.into(), high.into());
        let border = f64::from(self.border_radius);
        let (low, high) = (low.map(|x| down(x - border)), high.map(|x| up(x + border)));
        Aabb::new(Vector::from(low), Vector::from(high))
    }

    fn compute_bounding_sphere(&self, pose: &Pose) -> BoundingSphere {
        BoundingSphere::new(pose * self.ball.center, self.ball.radius)
    }

    fn mass_properties(&self, density: Real) -> MassProperties {
        self.mass_properties_at(density)
    }

    fn is_convex(&self) -> bool {
        true
    }

    fn shape_type(&self) -> ShapeType {
        ShapeType::Custom
    }

    /// A convex polyhedron of parry, rounded if the hull is, by which snapshots are written, fast
    /// bodies get the exact sweep, and debug renderers draw.
    fn as_typed_shape(&self) -> TypedShape<'_> {
        match &self.twin {
            Some(twin) if self.border_radius > 0.0 => TypedShape::RoundConvexPolyhedron(twin),
            Some(twin) => TypedShape::ConvexPolyhedron(&twin.inner_shape),
            None => TypedShape::Custom(self),
        }
    }

    fn ccd_thickness(&self) -> Real {
        self.aabb.half_extents().min_element()
    }

    fn ccd_angular_thickness(&self) -> Real {
        std::f64::consts::FRAC_PI_4 as Real
    }

    fn as_support_map(&self) -> Option<&dyn SupportMap> {
        Some(self)
    }

    fn as_polygonal_feature_map(&self) -> Option<(&dyn PolygonalFeatureMap, Real)> {
        Some((&self.core, self.border_radius))
    }

    fn feature_normal_at_point(&self, _: SubShapeId, feature: FeatureId, _: Vector) -> Option<Vector> {
        let normal = |f: FaceId| self.core.body.face_plane(f).map(|(n, _)| n.into_inner());
        let faces: Vec<FaceId> = match feature {
            FeatureId::Face(k) => self.core.body.faces().nth(k as usize).into_iter().collect(),
            FeatureId::Vertex(k) => self
                .core
                .body
                .vertices()
                .nth(k as usize)
                .map(|v| self.core.body.vertex_faces(v).collect())?,
            FeatureId::Edge(k) => match self.core.body.feature(1, k as usize) {
                Some(lin_canny::Feature::Edge(e)) => self.core.body.edge_faces(e)?.to_vec(),
                _ => return None,
            },
            FeatureId::Unknown => return None,
        };
        let sum: Vector3<f64> = faces.into_iter().filter_map(normal).sum();
        sum.try_normalize(0.0).map(|n| narrow(&n))
    }
}

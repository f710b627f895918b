//! Converts geometries to triangles and sharp edges, in the body's frame.

use std::collections::BTreeMap;

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::shape::Core;
#[cfg(feature = "surfaces")]
use lin_canny::surface::{BezierPatch, BezierSurface};
use lin_canny::{Cloud, CloudElement, ConvexPolyhedron, Geometry, HalfSpace, Mesh, Shape};

/// Cosine between face normals above which an edge of a curved body is not drawn.
const SHARP: f64 = 0.87;

/// Number of vertices around a rim.
const AROUND: usize = 40;

/// Number of steps along each parameter of a patch.
#[cfg(feature = "surfaces")]
const PATCH_STEPS: usize = 14;

/// Number of triangles above which a mesh is drawn without edges.
const MOST_EDGED: usize = 4000;

/// Largest number of triangles of a cloud whose elements are drawn as they are.
const MOST_OF_CLOUD: usize = 400_000;

/// Radius below which a point of a cloud is drawn larger than it is, in radii of the cloud.
const LEAST_POINT: f64 = 5e-4;

/// Half the side of the square that stands for a half-space, in cells of one unit.
const GRID: i32 = 10;

/// Triangles and visible edges of a body, for drawing.
#[derive(Clone, Debug, Default)]
pub struct RenderMesh {
    /// Vertices of each triangle, counter-clockwise seen from outside, and its unit normal.
    pub triangles: Vec<([Point3<f64>; 3], Vector3<f64>)>,
    /// Ends of each edge.
    pub edges: Vec<[Point3<f64>; 2]>,
    /// Radius of a ball around the frame's origin that contains the body.
    pub radius: f64,
}

impl RenderMesh {
    /// Returns the triangles and edges of a geometry.
    ///
    /// A curved body is drawn as the hull of points on its surface, and a half-space as a square of
    /// its plane with a grid. A cloud is drawn as its elements, balls as octahedra. If that makes
    /// more than 400,000 triangles, each element is drawn as a tetrahedron. A small element is drawn
    /// with a radius of at least 1/2000 of that of the cloud, so that single points are visible.
    #[must_use]
    pub fn from_geometry(geometry: &Geometry) -> Self {
        let mut solid = Self::default();
        match geometry {
            Geometry::Polyhedron(body) => solid.convex(body, &Isometry3::identity(), false),
            Geometry::Convex(shape) => solid.shape(shape, &Isometry3::identity()),
            Geometry::Compound(body) => body.pieces().iter().for_each(|p| solid.shape(&p.shape, &p.pose)),
            Geometry::Mesh(mesh) => solid.mesh(mesh),
            #[cfg(feature = "surfaces")]
            Geometry::BezierSurface(surface) => solid.surface(surface),
            Geometry::HalfSpace(space) => solid.plane(space),
            Geometry::Cloud(cloud) => solid.cloud(cloud),
            _ => {}
        }
        let corners = solid.triangles.iter().flat_map(|(corners, _)| corners);
        let ends = solid.edges.iter().flatten();
        solid.radius = corners.chain(ends).map(|p| p.coords.norm()).fold(0.0, f64::max);
        solid
    }

    fn convex(&mut self, body: &ConvexPolyhedron, pose: &Isometry3<f64>, curved: bool) {
        let points: Vec<Point3<f64>> = body.vertex_points().map(|p| pose * p).collect();
        for corners in body.triangles() {
            self.triangle(corners.map(|v| points[v.index()]));
        }
        for edge in body.edges() {
            let normals = body
                .edge_faces(edge)
                .map(|f| f.map(|f| body.face_plane(f).map(|(n, _)| n)));
            let is_smooth = matches!(normals, Some([Some(m), Some(n)]) if m.dot(&n) > SHARP);
            if let Some(ends) = body.edge_vertices(edge).filter(|_| !(curved && is_smooth)) {
                self.edges.push(ends.map(|v| points[v.index()]));
            }
        }
        if let ([point], 0) = (points.as_slice(), self.edges.len()) {
            self.edges.push([*point; 2]);
        }
    }

    fn triangle(&mut self, corners: [Point3<f64>; 3]) {
        let [p, q, r] = corners;
        let edges = [q - p, r - p];
        // Products of lengths neither overflow nor underflow.
        let size = edges[0].amax().max(edges[1].amax());
        let [u, v] = edges.map(|edge| edge / size);
        if let Some(normal) = u.cross(&v).try_normalize(0.0) {
            self.triangles.push((corners, normal));
        }
    }

    fn shape(&mut self, shape: &Shape, pose: &Isometry3<f64>) {
        if let (Core::Polyhedron(body), true) = (shape.core(), shape.rounding_radius() == 0.0) {
            return self.convex(body, pose, false);
        }
        if let Ok(hull) = ConvexPolyhedron::from_points(&samples(shape)) {
            self.convex(&hull, pose, true);
        }
    }

    fn mesh(&mut self, mesh: &Mesh) {
        let key = |p: &Point3<f64>| [p.x, p.y, p.z].map(f64::to_bits);
        let mut normals = BTreeMap::new();
        for (_, corners) in mesh.triangles() {
            self.triangle(corners);
        }
        if self.triangles.len() > MOST_EDGED {
            return;
        }
        for ([p, q, r], normal) in &self.triangles {
            for [from, to] in [[p, q], [q, r], [r, p]] {
                let ends = if key(from) < key(to) { [from, to] } else { [to, from] };
                normals
                    .entry(ends.map(key))
                    .or_insert((ends.map(|p| *p), Vec::new()))
                    .1
                    .push(*normal);
            }
        }
        let flat = |n: &[Vector3<f64>]| matches!(n, [m, n] if m.dot(n) > 0.999);
        let sharp = normals.into_values().filter(|(_, n)| !flat(n));
        self.edges.extend(sharp.map(|(ends, _)| ends));
    }

    fn plane(&mut self, space: &HalfSpace) {
        let (n, foot) = (space.normal().into_inner(), space.foot());
        let mut aside = Vector3::zeros();
        aside[n.iamin()] = 1.0;
        let u = n.cross(&aside).normalize();
        let v = n.cross(&u);
        let cells = 2 * GRID;
        let at = |i: i32, j: i32| foot + u * f64::from(i - GRID) + v * f64::from(j - GRID);
        let [p, q, r, s] = [at(0, 0), at(cells, 0), at(cells, cells), at(0, cells)];
        self.triangle([p, q, r]);
        self.triangle([p, r, s]);
        for k in 0..=cells {
            self.edges.push([at(k, 0), at(k, cells)]);
            self.edges.push([at(0, k), at(cells, k)]);
        }
    }

    fn cloud(&mut self, cloud: &Cloud) {
        let least = LEAST_POINT * cloud.bounding_ball().1;
        let mut element = Self::default();
        let (half, radii) = match cloud.element() {
            CloudElement::Box(half) => {
                if let Ok(block) = solids::cuboid(half) {
                    element.convex(&block, &Isometry3::identity(), false);
                }
                (half, None)
            }
            CloudElement::Shape(shape) => {
                element.shape(&shape, &Isometry3::identity());
                let (centre, radius) = shape.bounding_ball();
                (Vector3::repeat(radius + centre.coords.norm()), None)
            }
            CloudElement::Ball(radius) => (Vector3::repeat(radius), None),
            CloudElement::Balls(radii) => (Vector3::repeat(1.0), Some(radii)),
            _ => (Vector3::zeros(), None),
        };
        let is_small = radii.is_none() && half.max() < least;
        if element.triangles.is_empty() || is_small {
            element = Self::default();
            let points = OCTAHEDRON.map(|p| Point3::from(Vector3::from(p)));
            if let Ok(body) = ConvexPolyhedron::from_points(&points) {
                element.convex(&body, &Isometry3::identity(), true);
            }
            let size = if is_small { Vector3::repeat(least) } else { half };
            element.scale(&size);
        }
        if cloud.len().saturating_mul(element.triangles.len()) > MOST_OF_CLOUD {
            element = Self::default();
            let points = TETRAHEDRON.map(|p| Point3::from(Vector3::from(p)));
            if let Ok(body) = ConvexPolyhedron::from_points(&points) {
                element.convex(&body, &Isometry3::identity(), true);
            }
            element.scale(&half.map(|x| x.max(least)));
        }
        self.triangles.reserve(cloud.len() * element.triangles.len());
        for (k, point) in cloud.points().iter().enumerate() {
            let size = radii.as_ref().map_or(1.0, |radii| radii[k].max(least));
            let placed = |p: &Point3<f64>| point + p.coords * size;
            let triangles = element.triangles.iter();
            self.triangles
                .extend(triangles.map(|(corners, normal)| (corners.each_ref().map(placed), *normal)));
        }
    }

    /// Stretches triangles along the axes; edges are dropped.
    fn scale(&mut self, size: &Vector3<f64>) {
        for (corners, _) in std::mem::take(self).triangles {
            self.triangle(corners.map(|p| Point3::from(p.coords.component_mul(size))));
        }
    }

    #[cfg(feature = "surfaces")]
    fn surface(&mut self, surface: &BezierSurface) {
        for patch in surface.patches() {
            self.patch(patch);
        }
    }

    /// Adds both sides of a patch, and its boundary.
    #[cfg(feature = "surfaces")]
    fn patch(&mut self, patch: &BezierPatch) {
        let at = |i: usize, j: usize| {
            let [u, v] = [i, j].map(|k| k as f64 / PATCH_STEPS as f64);
            patch.point(u, v)
        };
        for i in 0..PATCH_STEPS {
            for j in 0..PATCH_STEPS {
                let [p, q, r, s] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                for corners in [[p, q, r], [p, r, s], [p, r, q], [p, s, r]] {
                    self.triangle(corners);
                }
            }
            let n = PATCH_STEPS;
            self.edges.extend([
                [at(i, 0), at(i + 1, 0)],
                [at(i, n), at(i + 1, n)],
                [at(0, i), at(0, i + 1)],
                [at(n, i), at(n, i + 1)],
            ]);
        }
    }
}

/// Vertices of the bodies that stand for a ball of radius 1. The tetrahedron has its volume.
const OCTAHEDRON: [[f64; 3]; 6] = [
    [1.0, 0.0, 0.0],
    [-1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, -1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.0, 0.0, -1.0],
];
const TETRAHEDRON: [[f64; 3]; 4] = [
    [1.16, 1.16, 1.16],
    [1.16, -1.16, -1.16],
    [-1.16, 1.16, -1.16],
    [-1.16, -1.16, 1.16],
];

/// Returns points on the surface of a shape that is rounded or curved.
fn samples(shape: &Shape) -> Vec<Point3<f64>> {
    let core: Vec<Point3<f64>> = match shape.core() {
        Core::Polyhedron(body) => body.vertex_points().collect(),
        Core::Ellipsoid(body) => sphere(3)
            .map(|d| Point3::from(d.component_mul(&body.semi_axes())))
            .collect(),
        Core::Cylinder(body) => {
            let (r, h) = (body.radius(), body.half_height());
            circle(r)
                .flat_map(|[x, y]| [Point3::new(x, y, h), Point3::new(x, y, -h)])
                .collect()
        }
        Core::Cone(body) => {
            let (r, h) = (body.radius(), body.half_height());
            let rim = circle(r).map(|[x, y]| Point3::new(x, y, -h));
            rim.chain([Point3::new(0.0, 0.0, h)]).collect()
        }
        _ => Vec::new(),
    };
    let round = shape.rounding_radius();
    if round == 0.0 {
        return core;
    }
    let fine = if core.len() > 12 { 1 } else { 2 };
    let ball: Vec<Vector3<f64>> = sphere(fine).map(|d| d * round).collect();
    core.iter().flat_map(|p| ball.iter().map(move |d| p + d)).collect()
}

/// Returns directions that cover the sphere.
fn sphere(fine: u32) -> impl Iterator<Item = Vector3<f64>> {
    let ball = solids::geodesic_sphere(fine, 1.0);
    let points: Vec<_> = ball
        .iter()
        .flat_map(|b| b.vertex_points())
        .map(|p| p.coords.normalize())
        .collect();
    points.into_iter()
}

fn circle(radius: f64) -> impl Iterator<Item = [f64; 2]> {
    (0..AROUND).map(move |k| {
        let angle = std::f64::consts::TAU * k as f64 / AROUND as f64;
        [radius * angle.cos(), radius * angle.sin()]
    })
}

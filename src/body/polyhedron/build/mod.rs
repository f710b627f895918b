//! From points to a body: cloud, hull, faces, planes, report. Files and replays rebuild a body from
//! its vertices in order.

pub(crate) mod cloud;
pub(crate) mod error;
mod faces;
mod facets;
pub(crate) mod hull;
#[cfg(feature = "serde")]
mod persist;

use crate::base::callbacks;
use crate::base::callbacks::{Watch, WithProgress};
use crate::base::num::double_double::DoubleDouble;
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes, largest, smallest};
use crate::base::num::fingerprint::{Fingerprint, Fingerprinter};
use crate::base::num::scalar::{Scalar, sqrt};
use crate::base::num::sign::side;
use crate::base::tolerance::{COPLANAR, EXTENT_MIN, RADIUS_UP, ROUND_UP};
use crate::body::polyhedron::aabb::Scan;
#[cfg(feature = "exact")]
use crate::body::polyhedron::build::cloud::lowest_bit;
use crate::body::polyhedron::build::cloud::{Cloud, bounding_box, power_of_two};
use crate::body::polyhedron::build::error::BuildError;
use crate::body::polyhedron::build::facets::Facets;
use crate::body::polyhedron::build::hull::{AffineSpan, HullSurface, NONE, NoHull, hull};
use crate::body::polyhedron::fans::Fans;
use crate::body::polyhedron::plane::{plane, widest_corners};
use crate::body::polyhedron::support::CubeMap;
use crate::body::polyhedron::topology::Topology;
use crate::body::polyhedron::{ConvexPolyhedron, FaceId, HalfEdgeId, Plane};
use alloc::vec::Vec;
use core::fmt;
use nalgebra::{Matrix3, Point3, Vector3};

/// A body is flat or long if the product of its squared half axes is below this fraction of the
/// product for a ball with an equal sum of squares, as for 3:3:1. Flat bodies compute start
/// features from their ellipsoids, which costs more than from the line of centres.
const FLAT: f64 = 0.32;

/// With at most this number of vertices every walk is short, and a start from ellipsoids costs more
/// than it saves.
const FEW: usize = 12;

/// Number of points from which it is faster to remove inner points first.
const MANY: usize = 2048;

/// Number of largest faces for the thickness of the report.
const WIDTHS: usize = 8;

impl WithProgress<'_> {
    /// Returns the convex hull of points as [`ConvexPolyhedron::from_points`] does.
    ///
    /// # Errors
    ///
    /// Returns the errors of [`ConvexPolyhedron::from_points`], and [`BuildError::Stopped`] if the
    /// callback stops the call.
    pub fn convex_hull(mut self, points: &[Point3<f64>]) -> Result<ConvexPolyhedron, BuildError> {
        ConvexPolyhedron::hull_watched(points, &mut self.watch)
    }
}

impl ConvexPolyhedron {
    /// Returns the convex hull of points, in any order and any unit.
    ///
    /// Every decision is an exact sign, so the hull is correct at any aspect ratio: no extreme
    /// point is lost and none is added. Exactly coplanar facets are one face. Points that are not
    /// extreme are dropped and listed in [`report`](Self::report). Vertices are numbered along a
    /// space-filling curve, independent of the order of the input. The time is about `n log n`.
    ///
    /// ```
    /// use lin_canny::polyhedron::{BuildError, ConvexPolyhedron};
    /// use lin_canny::nalgebra::Point3;
    ///
    /// let corners =
    ///     [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [0.1, 0.1, 0.1]];
    /// let body = ConvexPolyhedron::from_points(&corners.map(Point3::from))?;
    /// assert_eq!((body.vertex_count(), body.face_count()), (4, 4));
    /// assert_eq!(body.report().interior, [4]);
    ///
    /// let flat = [0, 1, 2, 0].map(|i: usize| Point3::from(corners[i]));
    /// let flat = ConvexPolyhedron::from_points(&flat);
    /// assert!(matches!(flat, Err(BuildError::Flat { dimension: 2, .. })));
    /// # Ok::<(), BuildError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Returns an error if there are fewer than four points, if a coordinate is not finite, if the
    /// extent is outside 1e-100..1e100, or if all points are exactly coplanar: see [`BuildError`].
    /// Use [`polygon`](Self::polygon), [`segment`](Self::segment) or [`point`](Self::point) for
    /// flat bodies.
    #[doc(alias = "convex_hull")]
    #[doc(alias = "quickhull")]
    #[doc(alias = "convex hull")]
    pub fn from_points(points: &[Point3<f64>]) -> Result<Self, BuildError> {
        Self::hull_watched(points, &mut Watch::none())
    }

    fn hull_watched(points: &[Point3<f64>], watch: &mut Watch<'_>) -> Result<Self, BuildError> {
        watch.stage("sort", Some(points.len()))?;
        let cloud = Cloud::sifted(points, 4, MANY, EXTENT_MIN);
        let hull = cloud.and_then(|cloud| Self::hull_of(cloud, watch));
        hull.inspect_err(|why| callbacks::refused("a hull", why))
    }

    /// Returns the hull of a cloud that is not flat.
    pub(crate) fn hull_of(cloud: Cloud, watch: &mut Watch<'_>) -> Result<Self, BuildError> {
        let surface = hull(&cloud.points, watch).map_err(|why| match why {
            NoHull::Flat(span) => flat(&cloud, &span),
            NoHull::Inconsistent => BuildError::Inconsistent,
            NoHull::Stopped => BuildError::Stopped,
        })?;
        watch.stage("faces", None)?;
        let facets = Facets::new(&cloud.points, &surface).ok_or(BuildError::Inconsistent)?;
        let mut body = Self::assemble(&cloud, &facets.kept, &facets.loops)?;
        body.report.merged_facets = facets.merged;
        let name = |list: &[u32]| list.iter().map(|&i| cloud.source[i as usize]).collect();
        body.report.on_faces = name(&facets.on_faces);
        body.report.on_edges = name(&facets.on_edges);
        body.sort_out_dropped(&cloud, &surface, &facets);
        Ok(body)
    }

    /// Assembles a body from the indices of its vertices in the cloud and its faces by vertex
    /// number.
    pub(crate) fn assemble(cloud: &Cloud, kept: &[u32], loops: &[Vec<u32>]) -> Result<Self, BuildError> {
        let topology = Topology::from_loops(kept.len(), loops).ok_or(BuildError::Inconsistent)?;
        if loops.len() > 1 && kept.len() + loops.len() != topology.half_edge_count() / 2 + 2 {
            return Err(BuildError::Inconsistent);
        }
        Ok(Self::of_topology(cloud, kept, loops, topology))
    }

    /// Returns the origin as a body of one point.
    pub(crate) fn origin() -> Self {
        Self::of_topology(&Cloud::origin(), &[0], &[], Topology::of_vertex())
    }

    fn of_topology(cloud: &Cloud, kept: &[u32], loops: &[Vec<u32>], topology: Topology) -> Self {
        let points: Vec<Vector3<f64>> = kept.iter().map(|&i| cloud.points[i as usize]).collect();
        let radius = points.iter().fold(0.0f64, |r, p| r.larger(p.norm_squared()));
        let radius = sqrt(radius) * ROUND_UP;
        let (planes, areas) = planes_of(&points, loops, radius);
        let (low, high) = bounding_box(&points);
        let thickness_ratio = thickness_ratio(&points, &planes, &areas, largest(&(high - low)));
        let (vertices, edges) = (points.len(), topology.half_edge_count() / 2);
        let faces = if loops.len() == 1 { 0 } else { loops.len() };
        let report = BuildReport {
            input_points: cloud.given,
            vertices,
            edges,
            faces,
            duplicates: cloud.duplicates.clone(),
            flushed_coordinates: cloud.flushed,
            thickness_ratio,
            euler_characteristic: vertices as i64 - edges as i64 + faces as i64,
            ..BuildReport::default()
        };
        // Summed in double-double. For any number of vertices, the mean is outside the body by at
        // most a few units of rounding, as the proof of a depth requires (`depth::pyramid`).
        let sum = |k: usize| {
            points
                .iter()
                .fold(DoubleDouble::default(), |sum, p| sum + DoubleDouble::from(p[k]))
        };
        let vertex_mean = Vector3::from_fn(|k, _| sum(k).value() / points.len() as f64);
        let squares = points.iter().map(|p| (p - vertex_mean) * (p - vertex_mean).transpose());
        let covariance3 = squares.sum::<Matrix3<f64>>() * (3.0 / points.len() as f64);
        let mean = covariance3.trace() / 3.0;
        let has_coplanar_neighbours = HalfEdgeId::all(topology.half_edge_count()).any(|h| {
            let e = topology.half_edge(h);
            let [m, n] = [e.face, topology.half_edge(e.twin).face].each(|f| planes[f.index()].normal);
            m.dot(&n) > 0.0 && m.cross(&n).norm_squared() <= COPLANAR * COPLANAR
        });
        let fans = Fans::new(&topology, &points, &planes);
        #[cfg(feature = "exact")]
        let given = points.iter().flat_map(|p| cloud.given_place(p).data.0[0]);
        let mut body = Self {
            #[cfg(feature = "exact")]
            lowest_bit: lowest_bit(given),
            lookup: CubeMap::new(&topology, &points, &fans),
            has_large_rings: topology.has_large_faces() || !fans.is_empty(),
            fans,
            scan: Scan::new(&points),
            vertex_mean,
            covariance3,
            seems_flat: points.len() > FEW && covariance3.determinant() < FLAT * mean * mean * mean,
            topology,
            source: kept.iter().map(|&i| cloud.source[i as usize]).collect(),
            points,
            planes,
            source_faces: Vec::new(),
            origin: cloud.origin,
            exponent: cloud.exponent,
            is_unscaled: cloud.exponent == 0 && cloud.origin == Vector3::zeros(),
            radius,
            ball_radius: 0.0,
            low,
            high,
            has_coplanar_neighbours,
            fingerprint: fingerprint_of(cloud, kept, loops),
            report,
        };
        let (centre, _) = body.bounding_ball();
        let scale = 1.0 / body.unit();
        // Distances are measured from the rounded centre, in stored units so that squares stay in
        // range.
        let far = body.points.iter().fold(0.0f64, |r, p| {
            r.larger(((body.to_user(p) - centre) * scale).norm_squared())
        });
        body.ball_radius = sqrt(far) * RADIUS_UP * body.unit();
        body
    }

    /// Adds the points that never became vertices of the hull's triangles to the report.
    fn sort_out_dropped(&mut self, cloud: &Cloud, surface: &HullSurface, facets: &Facets) {
        let mut settled = alloc::vec![false; cloud.points.len()];
        for &i in facets.kept.iter().chain(&facets.on_edges).chain(&facets.on_faces) {
            settled[i as usize] = true;
        }
        for (i, p) in cloud.points.iter().enumerate().filter(|(i, _)| !settled[*i]) {
            let list = match surface.touching[i] {
                NONE => &mut self.report.interior,
                triangle if facets.is_on_edge(&cloud.points, triangle, p) => &mut self.report.on_edges,
                _ => &mut self.report.on_faces,
            };
            list.push(cloud.source[i]);
        }
        // Copies of inner points are inner points.
        let mut is_inside = cloud.inside.clone();
        is_inside.resize(cloud.given.div_ceil(64), 0);
        let place = |i: u32| (i as usize / 64, 1 << (i % 64));
        for &i in &self.report.interior {
            let (word, bit) = place(i);
            is_inside[word] |= bit;
        }
        self.report.duplicates.retain(|&(dropped, kept)| {
            let (word, bit) = place(kept);
            let is_inner = is_inside[word] & bit != 0;
            if is_inner {
                let (word, bit) = place(dropped);
                is_inside[word] |= bit;
            }
            !is_inner
        });
        let interior = &mut self.report.interior;
        interior.clear();
        interior.reserve_exact(is_inside.iter().map(|word| word.count_ones() as usize).sum());
        for (first, word) in (0u32..).step_by(64).zip(is_inside) {
            interior.extend((0..64).filter(|k| word >> k & 1 == 1).map(|k| first + k));
        }
    }

    /// Returns the body whose stored coordinates are about another origin: the body moves with it.
    ///
    /// The vertices must stay numbers of `f64`, which they do near zero.
    pub(crate) fn with_origin(&self, origin: &Vector3<f64>) -> Self {
        let moved = Self {
            origin: *origin,
            is_unscaled: self.exponent == 0 && *origin == Vector3::zeros(),
            fingerprint: (0..3).fold(self.fingerprint, |all, k| all.with(*b"origin  ", origin[k])),
            ..self.clone()
        };
        #[cfg(feature = "exact")]
        let moved = Self {
            lowest_bit: lowest_bit(moved.points.iter().flat_map(|p| (p * self.unit() + origin).data.0[0])),
            ..moved
        };
        moved
    }

    /// Returns an exact sign: positive if a point in stored coordinates is outside the plane of a
    /// face, 0 if it is in the plane.
    pub(crate) fn face_side(&self, face: FaceId, p: &Vector3<f64>) -> f64 {
        let h = self.topology.rim_half_edge(face);
        let e = self.topology.half_edge(h);
        let corners = [self.topology.from(h), e.to, self.topology.half_edge(e.next).to];
        let [a, b, c] = corners.each(|v| &self.points[v.index()]);
        side(a, b, c, p)
    }

    /// Returns the stored unit, `2^exponent`: stored lengths times this unit are the caller's.
    #[inline]
    pub(crate) fn unit(&self) -> f64 {
        power_of_two(self.exponent)
    }
}

/// Returns the fingerprint of vertices, scale and faces.
fn fingerprint_of(cloud: &Cloud, kept: &[u32], loops: &[Vec<u32>]) -> Fingerprint {
    let mut all = Fingerprinter::new(*b"polyhedr");
    all.vector(&cloud.origin);
    all.word(cloud.exponent as u64);
    all.word(kept.len() as u64);
    kept.iter().for_each(|&k| all.vector(&cloud.points[k as usize]));
    all.word(loops.len() as u64);
    all.indices(loops.iter().flat_map(|rim| {
        let length = rim.len() as u32;
        core::iter::once(length).chain(rim.iter().copied())
    }));
    all.end()
}

/// Returns the plane of each face, and twice the area of the widest triangle on the face; zeros for
/// the null face of a segment.
fn planes_of(points: &[Vector3<f64>], loops: &[Vec<u32>], radius: f64) -> (Vec<Plane>, Vec<f64>) {
    let null = Plane {
        normal: Vector3::zeros(),
        offset: 0.0,
    };
    let of_face = |rim: &Vec<u32>| {
        if rim.len() < 3 {
            return (null, 0.0);
        }
        let [a, b, c] = widest_corners(points, rim).each(|v| &points[v as usize]);
        plane(a, b, c, radius)
    };
    loops.iter().map(of_face).unzip()
}

/// Returns the error for a flat cloud.
pub(crate) fn flat(cloud: &Cloud, span: &AffineSpan) -> BuildError {
    let span: Vec<usize> = span.iter().map(|&i| cloud.source[i as usize] as usize).collect();
    BuildError::Flat {
        dimension: span.len().saturating_sub(1),
        span,
    }
}

/// Returns the least width along the axes of the box and the normals of the largest faces, divided
/// by the longest side of the box.
fn thickness_ratio(points: &[Vector3<f64>], planes: &[Plane], areas: &[f64], extent: f64) -> f64 {
    if extent <= 0.0 || planes.len() < 3 {
        return 0.0;
    }
    let mut largest: Vec<usize> = Vec::with_capacity(WIDTHS + 1);
    for f in 0..planes.len() {
        if largest.len() < WIDTHS || areas[f] > areas[largest[WIDTHS - 1]] {
            let place = largest.partition_point(|&g| areas[g] >= areas[f]);
            largest.insert(place, f);
            largest.truncate(WIDTHS);
        }
    }
    let (low, high) = bounding_box(points);
    let mut width = smallest(&(high - low));
    for f in largest {
        let n = planes[f].normal;
        let below = points.iter().fold(f64::INFINITY, |m, p| m.smaller(n.dot(p)));
        width = width.smaller(planes[f].offset - below);
    }
    (width / extent).clamped(0.0, 1.0)
}

/// Report of the build of a body.
#[derive(Clone, Debug, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct BuildReport {
    /// Number of points given.
    pub input_points: usize,
    /// Vertices of the body.
    pub vertices: usize,
    /// Edges of the body.
    pub edges: usize,
    /// Faces of the body.
    pub faces: usize,
    /// Exactly equal points that are not strictly inside the body, as `(dropped, kept)`.
    pub duplicates: Vec<(u32, u32)>,
    /// Points dropped because they are strictly inside the body, copies included, in ascending
    /// order.
    pub interior: Vec<u32>,
    /// Points dropped because they are inside a face.
    pub on_faces: Vec<u32>,
    /// Points dropped because they are inside an edge.
    pub on_edges: Vec<u32>,
    /// Points that no face uses (bodies from faces).
    pub unused: Vec<u32>,
    /// Triangles of the hull that were merged into exactly coplanar faces.
    pub merged_facets: usize,
    /// Number of coordinates replaced by zero, because they are below `2^-200` of the extent and
    /// outside the range of exact arithmetic.
    pub flushed_coordinates: usize,
    /// Thickness divided by length: 1 for a cube, small for sheets and needles, 0 for polygons,
    /// segments and points. The thickness is the least width along the axes of the box and the
    /// normals of the eight largest faces, an upper estimate of the least width in any direction.
    /// The length is the longest side of the box.
    pub thickness_ratio: f64,
    /// Largest distance of a vertex from the plane of its given face (bodies from faces).
    pub non_planarity: f64,
    /// Vertices - edges + faces: 2 for every body with faces.
    pub euler_characteristic: i64,
}

impl fmt::Display for BuildReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} vertices, {} edges, {} faces from {} points",
            self.vertices, self.edges, self.faces, self.input_points
        )?;
        let dropped = [
            (self.duplicates.len(), "duplicates"),
            (self.interior.len(), "interior points"),
            (self.on_faces.len(), "points on faces"),
            (self.on_edges.len(), "points on edges"),
            (self.unused.len(), "unused points"),
        ];
        for (count, what) in dropped.into_iter().filter(|d| d.0 > 0) {
            write!(f, ", {count} {what} dropped")?;
        }
        if self.merged_facets > 0 {
            write!(f, ", {} coplanar facets merged", self.merged_facets)?;
        }
        if self.flushed_coordinates > 0 {
            write!(f, ", {} coordinates flushed to zero", self.flushed_coordinates)?;
        }
        if self.non_planarity > 0.0 {
            write!(f, ", faces planar to {:.1e}", self.non_planarity)?;
        }
        write!(f, ", thickness {:.1e} of the length", self.thickness_ratio)
    }
}

impl ConvexPolyhedron {
    /// Returns the vertices of the first side of a polygon, in order; empty for other bodies.
    pub(crate) fn first_side(&self) -> Vec<u32> {
        let side = self.faces().next().filter(|_| self.face_count() == 2);
        side.map_or(Vec::new(), |f| self.face_vertices(f).map(|v| v.0).collect())
    }

    /// Returns the body with the given vertices, in the order of their ids, and the given
    /// [`first_side`](Self::first_side). It is identical bit for bit, because origin, scale and
    /// numbering depend on the extreme points alone. Only the caller's indices and the report are
    /// lost.
    ///
    /// # Errors
    /// Returns an error if the vertices are not the vertices of a body in order, or have no hull.
    pub(crate) fn rebuilt(points: &[Point3<f64>], first_side: &[u32]) -> Result<Self, BuildError> {
        let damaged = |what| BuildError::Damaged { what };
        let body = match *points {
            [p] => Self::point(p)?,
            [p, q] => Self::segment(p, q)?,
            _ if first_side.is_empty() => Self::from_points(points)?,
            _ => {
                let corner = |&i: &u32| points.get(i as usize).copied();
                let rim: Option<Vec<_>> = first_side.iter().map(corner).collect();
                Self::polygon(&rim.ok_or(damaged("the polygon names an unknown vertex"))?)?
            }
        };
        if body.vertex_points().ne(points.iter().copied()) {
            return Err(damaged("the vertices are not those of a body in order"));
        }
        Ok(body)
    }
}

//! From the caller's faces to a body. Every error is reported by name; then the body is the exact
//! hull of the vertices.
//!
//! Faces are accepted if they are planar up to a bound. The body is the hull of the points, not the
//! rounded polyhedron of the caller's faces, because support vertices are found along the edges of
//! an exact hull. A face that is not exactly planar becomes several faces, and
//! [`ConvexPolyhedron::source_face`] returns the caller's face of each.

use crate::base::callbacks;
use crate::base::callbacks::Watch;
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::sign::side;
use crate::base::num::sort::sort_by_key;
use crate::base::tolerance::{EXTENT_MIN, PLANARITY, SIDE_ERROR};
use crate::body::polyhedron::build::cloud::{Cloud, power_of_two};
use crate::body::polyhedron::build::error::BuildError;
use crate::body::polyhedron::plane::{plane, widest_corners};
use crate::body::polyhedron::{ConvexPolyhedron, FaceId, VertexId};
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Point3, Vector3};

const NONE: u32 = u32::MAX;

impl ConvexPolyhedron {
    /// Returns a body from points and faces, each a loop of indices, counter-clockwise from
    /// outside.
    ///
    /// The vertices of a face may be off its plane by rounding: 64 UNIT times the diagonal of the
    /// box. Several coplanar faces become one face of the body; [`source_face`](Self::source_face)
    /// returns the caller's face. Equal points are merged. Points that no face uses are ignored and
    /// listed in [`report`](Self::report).
    ///
    /// ```
    /// use lin_canny::polyhedron::{BuildError, ConvexPolyhedron};
    /// use lin_canny::nalgebra::Point3;
    ///
    /// let corners =
    ///     [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]].map(Point3::from);
    /// let mut faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    /// let body = ConvexPolyhedron::from_faces(&corners, &faces)?;
    /// assert!(body.faces().all(|f| body.source_face(f).is_some()));
    ///
    /// faces[1].reverse();
    /// let error = ConvexPolyhedron::from_faces(&corners, &faces).unwrap_err();
    /// assert_eq!(error, BuildError::WrongOrientation { face: 1 });
    /// # Ok::<(), BuildError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Returns the errors of [`from_points`](Self::from_points), and an error if the faces are not
    /// the surface of a convex body; see [`BuildError`].
    #[doc(alias = "mesh")]
    pub fn from_faces(points: &[Point3<f64>], faces: &[impl AsRef<[u32]>]) -> Result<Self, BuildError> {
        build(points, faces, None).inspect_err(|why| callbacks::refused("a body of faces", why))
    }

    /// Returns a body from faces that are planar and convex up to a bound.
    ///
    /// It works as [`from_faces`](Self::from_faces), with a bound in the caller's unit. Use it for
    /// meshes stored in single precision, with a bound of about 1e-6 times the size of the body.
    ///
    /// The body is the hull of the given points, so a face that is not exactly planar becomes
    /// several faces of the body. [`source_face`](Self::source_face) returns the given face of
    /// each.
    ///
    /// ```
    /// use lin_canny::ConvexPolyhedron;
    /// use lin_canny::nalgebra::{Point3, Rotation3, Vector3};
    ///
    /// // A box that was turned and stored in f32: its sides are flat to 1e-8 only.
    /// let turn = Rotation3::new(Vector3::new(0.3, 0.2, 0.1));
    /// let corner = |i: u8| [i & 1, i >> 1 & 1, i >> 2].map(f64::from);
    /// let rounded = |i| (turn * Point3::from(corner(i))).cast::<f32>().cast::<f64>();
    /// let points = [0, 1, 2, 3, 4, 5, 6, 7].map(rounded);
    /// let faces =
    ///     [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4],
    ///         [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    /// assert!(ConvexPolyhedron::from_faces(&points, &faces).is_err());
    /// let body = ConvexPolyhedron::from_faces_within(&points, &faces, 1e-6)?;
    /// assert!(body.face_count() > 6 && body.report().non_planarity < 1e-6);
    /// # Ok::<(), lin_canny::BuildError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Returns the errors of [`from_faces`](Self::from_faces), and an error if the bound is
    /// negative or not finite.
    pub fn from_faces_within(
        points: &[Point3<f64>],
        faces: &[impl AsRef<[u32]>],
        planarity_bound: f64,
    ) -> Result<Self, BuildError> {
        if !(planarity_bound >= 0.0 && planarity_bound.is_finite()) {
            return Err(BuildError::BadBound { value: planarity_bound });
        }
        build(points, faces, Some(planarity_bound)).inspect_err(|why| callbacks::refused("a body of faces", why))
    }
}

fn build(
    points: &[Point3<f64>],
    faces: &[impl AsRef<[u32]>],
    bound: Option<f64>,
) -> Result<ConvexPolyhedron, BuildError> {
    let (used, unused) = used_points(points, faces)?;
    let cloud = Cloud::new(points, used, 4, EXTENT_MIN)?;
    let mesh = FaceList::new(points.len(), faces, &cloud)?;
    let misdirected = mesh.check_edges()?;
    let scale = power_of_two(-cloud.exponent);
    let bound = bound.map_or(PLANARITY * cloud.diagonal(), |b| b * scale);
    let planes = mesh.check_planes(&cloud, bound)?;
    let stored = cloud.points.clone();
    let mut body = ConvexPolyhedron::hull_of(cloud, &mut Watch::none())?;
    let places = mesh.places(&body);
    mesh.check_convex(&body, &places, &planes, bound)?;
    if let Some(edge) = misdirected {
        return Err(BuildError::EdgeUsedTwice { edge });
    }
    body.source_faces = source_faces(&mesh, &body, &places, &stored);
    body.report.non_planarity = planes.iter().fold(0.0f64, |m, p| m.larger(p.deviation)) * body.unit();
    body.report.unused = unused;
    Ok(body)
}

/// Returns the points that some face uses, and the unused points; an error if an index is out of
/// range.
fn used_points(points: &[Point3<f64>], faces: &[impl AsRef<[u32]>]) -> Result<(Vec<u32>, Vec<u32>), BuildError> {
    let corners = faces.iter().fold(0usize, |n, f| n.saturating_add(f.as_ref().len()));
    for count in [points.len(), faces.len(), corners] {
        if count >= u32::MAX as usize / 2 {
            return Err(BuildError::TooMany { count });
        }
    }
    let mut is_used = vec![false; points.len()];
    for (face, rim) in faces.iter().enumerate() {
        for &index in rim.as_ref() {
            match is_used.get_mut(index as usize) {
                Some(slot) => *slot = true,
                None => {
                    return Err(BuildError::IndexOutOfRange {
                        face,
                        index: index as usize,
                    });
                }
            }
        }
    }
    Ok((0..points.len() as u32).partition(|&i| is_used[i as usize]))
}

/// The caller's faces, over the points of the cloud.
pub(crate) struct FaceList {
    /// Vertices of all faces, face after face, as indices in the cloud.
    pub(crate) corners: Vec<u32>,
    /// Start of each face in `corners`, and the end of the last face.
    first: Vec<u32>,
    /// The caller's index of each point of the cloud.
    pub(crate) source: Vec<u32>,
}

/// The plane of one of the caller's faces, in stored units.
struct FacePlane {
    normal: Vector3<f64>,
    base: Vector3<f64>,
    /// The largest distance of a vertex of the face from the plane.
    deviation: f64,
}

impl FaceList {
    fn new(points: usize, faces: &[impl AsRef<[u32]>], cloud: &Cloud) -> Result<Self, BuildError> {
        let mut place = vec![NONE; points];
        for (i, &s) in cloud.source.iter().enumerate() {
            place[s as usize] = i as u32;
        }
        for &(dropped, kept) in &cloud.duplicates {
            place[dropped as usize] = place[kept as usize];
        }
        let mut mesh = Self {
            corners: Vec::new(),
            first: vec![0],
            source: cloud.source.clone(),
        };
        let mut met = vec![NONE; cloud.points.len()];
        for (face, rim) in faces.iter().enumerate() {
            for &index in rim.as_ref() {
                let corner = place[index as usize];
                if core::mem::replace(&mut met[corner as usize], face as u32) == face as u32 {
                    return Err(BuildError::RepeatedVertex {
                        face,
                        vertex: index as usize,
                    });
                }
                mesh.corners.push(corner);
            }
            if rim.as_ref().len() < 3 {
                return Err(BuildError::FaceTooSmall { face });
            }
            mesh.first.push(mesh.corners.len() as u32);
        }
        Ok(mesh)
    }

    pub(crate) fn face_count(&self) -> usize {
        self.first.len() - 1
    }

    pub(crate) fn face(&self, f: usize) -> &[u32] {
        &self.corners[self.corners_of(f)]
    }

    /// Returns the range of a face in `corners`.
    pub(crate) fn corners_of(&self, f: usize) -> core::ops::Range<usize> {
        self.first[f] as usize..self.first[f + 1] as usize
    }

    fn name(&self, place: u32) -> usize {
        self.source[place as usize] as usize
    }

    /// Checks that every edge has two faces. Returns an edge that two faces pass in one direction,
    /// if any: then a face has the wrong orientation, and the planes decide which one.
    fn check_edges(&self) -> Result<Option<[usize; 2]>, BuildError> {
        let mut edges: Vec<(u32, u32, bool)> = Vec::with_capacity(self.corners.len());
        for f in 0..self.face_count() {
            let rim = self.face(f);
            let ends = rim.iter().zip(rim.iter().cycle().skip(1));
            edges.extend(ends.map(|(&a, &b)| (a.min(b), a.max(b), a < b)));
        }
        edges.sort_unstable();
        let mut misdirected = None;
        for uses in edges.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)) {
            let (low, high, rising) = uses[0];
            let (a, b) = if rising { (low, high) } else { (high, low) };
            let edge = [self.name(a), self.name(b)];
            match *uses {
                [_] => return Err(BuildError::NotClosed { edge }),
                [x, y] if x.2 != y.2 => {}
                [_, _] => misdirected = misdirected.or(Some(edge)),
                _ => return Err(BuildError::EdgeUsedTwice { edge }),
            }
        }
        Ok(misdirected)
    }

    fn check_planes(&self, cloud: &Cloud, bound: f64) -> Result<Vec<FacePlane>, BuildError> {
        (0..self.face_count())
            .map(|f| self.face_plane(f, cloud, bound))
            .collect()
    }

    fn face_plane(&self, f: usize, cloud: &Cloud, bound: f64) -> Result<FacePlane, BuildError> {
        let rim = self.face(f);
        let corners = widest_corners(&cloud.points, rim);
        let [a, b, c] = corners.each(|v| &cloud.points[v as usize]);
        let mut normal = plane(a, b, c, 0.0).0.normal;
        if normal == Vector3::zeros() {
            return Err(BuildError::FaceWithoutArea { face: f });
        }
        // Vertices may turn either way if the face is not convex; the area of the whole face has
        // the right sign, unless the face is a sliver at rounding level.
        let at = |v: &u32| cloud.points[*v as usize] - a;
        let around = rim.iter().zip(rim.iter().cycle().skip(1)).map(|(p, q)| (at(p), at(q)));
        let (area, error) = around.fold((0.0, 0.0), |(area, error), (p, q)| {
            (
                area + p.cross(&q).dot(&normal),
                error + SIDE_ERROR * p.norm() * q.norm(),
            )
        });
        if area < -2.0 * error {
            normal = -normal;
        }
        // A vertex exactly in the plane has the distance zero for any rounding of the normal, and
        // no other vertex has.
        let off = |v: u32| {
            let p = &cloud.points[v as usize];
            if corners.contains(&v) || side(a, b, c, p) == 0.0 {
                0.0
            } else {
                normal.dot(&(p - a)).abs().at_least(f64::MIN_POSITIVE)
            }
        };
        let worst = rim.iter().fold(rim[0], |w, &v| if off(v) > off(w) { v } else { w });
        let deviation = off(worst);
        if deviation > bound {
            let unit = power_of_two(cloud.exponent);
            let (distance, bound) = (deviation * unit, bound * unit);
            return Err(BuildError::FaceNotPlanar {
                face: f,
                vertex: self.name(worst),
                distance,
                bound,
            });
        }
        Ok(FacePlane {
            normal,
            base: *a,
            deviation,
        })
    }

    /// Returns the index in the cloud of each vertex of the body; both lists have one order.
    fn places(&self, body: &ConvexPolyhedron) -> Vec<u32> {
        let mut wanted = body.source.iter().peekable();
        let is_vertex = |place: &u32| wanted.next_if_eq(&&self.source[*place as usize]).is_some();
        (0..self.source.len() as u32).filter(is_vertex).collect()
    }

    /// Checks that every face supports the hull from outside. With closed edges this makes the
    /// faces the whole surface.
    fn check_convex(
        &self,
        body: &ConvexPolyhedron,
        places: &[u32],
        planes: &[FacePlane],
        bound: f64,
    ) -> Result<(), BuildError> {
        let mut vertex_at = vec![NONE; self.source.len()];
        for (v, &place) in places.iter().enumerate() {
            vertex_at[place as usize] = v as u32;
        }
        // The excess of a valid face is at most the bound plus the rounding of this comparison.
        let accept = bound + PLANARITY * body.radius;
        for (f, p) in planes.iter().enumerate() {
            let corners = self
                .face(f)
                .iter()
                .map(|&c| vertex_at[c as usize])
                .filter(|&v| v != NONE)
                .map(VertexId);
            let start = corners
                .min_by_key(|&v| body.topology.fan(v).len())
                .unwrap_or(VertexId(0));
            let front = body.support_climb(&p.normal, start);
            let by = p.normal.dot(&(body.points[front.index()] - p.base));
            if by > accept {
                let back = body.support_climb(&-p.normal, start);
                let behind = p.normal.dot(&(p.base - body.points[back.index()]));
                if behind <= accept {
                    return Err(BuildError::WrongOrientation { face: f });
                }
                let vertex = body.source[front.index()] as usize;
                return Err(BuildError::NotConvex {
                    face: f,
                    vertex,
                    by: by * body.unit(),
                });
            }
        }
        Ok(())
    }
}

/// A vertex of more faces than this adds no candidates if another vertex has added some.
const CROWD: usize = 8;

/// Returns for each face of the body the caller's face with most vertices in common, the lowest
/// index among equals. Three vertices decide. If the caller divided a face into polygons with fewer
/// than three common vertices, the polygon in the plane of the face is taken.
///
/// `places` are the indices in the cloud of the body's vertices, `points` the points of the cloud.
pub(crate) fn source_faces(
    mesh: &FaceList,
    body: &ConvexPolyhedron,
    places: &[u32],
    points: &[Vector3<f64>],
) -> Vec<u32> {
    let incidence = Incidence::new(mesh);
    // For each of the caller's faces the last face compared with it, and the number of shared
    // vertices.
    let mut shared = vec![(None, 0u32); mesh.face_count()];
    let mut rim: Vec<u32> = Vec::new();
    let mut candidates: Vec<u32> = Vec::new();
    let mut result = Vec::with_capacity(body.face_count());
    for f in body.faces() {
        rim.clear();
        candidates.clear();
        rim.extend(body.topology.rim(f).map(|h| places[body.topology.from(h).index()]));
        // Vertices of many faces, such as the apex of a cone, come last and are looked up only in
        // the candidates known by then.
        sort_by_key(&mut rim, |&c| incidence.faces_at(c).len());
        for &corner in &rim {
            if !candidates.is_empty() && incidence.faces_at(corner).len() > CROWD {
                for &g in candidates.iter().filter(|&&g| incidence.has_corner(g, corner)) {
                    shared[g as usize].1 += 1;
                }
                continue;
            }
            for &g in incidence.faces_at(corner) {
                let (last, count) = &mut shared[g as usize];
                if *last != Some(f) {
                    (*last, *count) = (Some(f), 0);
                    candidates.push(g);
                }
                *count += 1;
            }
        }
        let count = |g: u32| shared[g as usize].1;
        let most = candidates.iter().map(|&g| count(g)).max().unwrap_or(0);
        let best = if most >= 3 {
            candidates.iter().copied().filter(|&g| count(g) == most).min()
        } else {
            let off = |g: u32| depth_below(mesh.face(g as usize), body, f, points);
            candidates
                .iter()
                .copied()
                .min_by(|&g, &h| off(g).total_cmp(&off(h)).then(g.cmp(&h)))
        };
        result.push(best.unwrap_or(0));
    }
    result
}

/// Returns how far three spread vertices of a caller's face are below the plane of a face of the
/// body.
fn depth_below(corners: &[u32], body: &ConvexPolyhedron, face: FaceId, points: &[Vector3<f64>]) -> f64 {
    let plane = &body.planes[face.index()];
    let spread = [0, 1, 2].each(|k| corners[k * corners.len() / 3]);
    let depths = spread.each(|c| plane.offset - plane.normal.dot(&points[c as usize]));
    depths.into_iter().fold(0.0, f64::larger)
}

/// The caller's faces at each point of the cloud, and the points of each face.
struct Incidence<'a> {
    mesh: &'a FaceList,
    /// Vertices of each face in rising order, laid out as in the mesh.
    sorted: Vec<u32>,
    first: Vec<u32>,
    faces: Vec<u32>,
}

impl<'a> Incidence<'a> {
    fn new(mesh: &'a FaceList) -> Self {
        let mut first = vec![0u32; mesh.source.len() + 1];
        for &c in &mesh.corners {
            first[c as usize + 1] += 1;
        }
        for c in 0..mesh.source.len() {
            first[c + 1] += first[c];
        }
        let mut next = first.clone();
        let mut faces = vec![0u32; mesh.corners.len()];
        let mut sorted = mesh.corners.clone();
        for f in 0..mesh.face_count() {
            sorted[mesh.corners_of(f)].sort_unstable();
            for &c in mesh.face(f) {
                faces[next[c as usize] as usize] = f as u32;
                next[c as usize] += 1;
            }
        }
        Self {
            mesh,
            sorted,
            first,
            faces,
        }
    }

    fn faces_at(&self, place: u32) -> &[u32] {
        &self.faces[self.first[place as usize] as usize..self.first[place as usize + 1] as usize]
    }

    fn has_corner(&self, face: u32, place: u32) -> bool {
        self.sorted[self.mesh.corners_of(face as usize)]
            .binary_search(&place)
            .is_ok()
    }
}

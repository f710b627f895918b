//! Edges, closedness and connected components, and triangles that face inward.
//!
//! Inside is where the winding number is not zero. Behind a triangle the surface winds once more
//! than before it, from w to w + 1. The triangle faces inward if w is negative. If all such
//! triangles are flipped, every winding number becomes its absolute value: the same points are
//! inside, and the surface stays closed.

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::Vector3;

use super::{Mesh, MeshPart};
use crate::base::num::each::Each;
use crate::base::num::scalar::sqrt;
use crate::base::num::sign;
use crate::base::num::sort::sort;
use crate::base::tolerance::SLANT;
use crate::nonconvex::query::inside::ExactSigns;
use crate::nonconvex::query::triangle;

/// The edges of a mesh that are not shared by two triangles of opposite direction.
#[derive(Default)]
pub(super) struct Edges {
    pub(super) boundary: Vec<[u32; 2]>,
    pub(super) non_manifold: Vec<[u32; 2]>,
    pub(super) misoriented: Vec<[u32; 2]>,
    /// Whether the edges of triangles cancel along every line, all along the line.
    ///
    /// At each point of a line, as many edges run in one direction as in the other. Then every
    /// point off the surface has a winding number.
    pub(super) closed: bool,
    /// Whether edges that are not between two triangles cancel along a line and close the surface.
    pub(super) closed_along_lines: bool,
}

/// Sorts the edges of all triangles and classifies each.
pub(super) fn judge(points: &[Vector3<f64>], triangles: &[[u32; 3]]) -> Edges {
    let mut runs: Vec<(u64, bool)> = Vec::with_capacity(3 * triangles.len());
    for &[a, b, c] in triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            runs.push((u64::from(from.min(to)) << 32 | u64::from(from.max(to)), from < to));
        }
    }
    runs.sort_unstable();
    let mut edges = Edges::default();
    let mut uneven: Vec<[u32; 2]> = Vec::new();
    for edge in runs.chunk_by(|a, b| a.0 == b.0) {
        let ends = [(edge[0].0 >> 32) as u32, edge[0].0 as u32];
        let forward = edge.iter().filter(|e| e.1).count();
        let back = edge.len() - forward;
        let [from, to] = if forward > back { ends } else { [ends[1], ends[0]] };
        uneven.extend((0..forward.abs_diff(back)).map(|_| [from, to]));
        match edge.len() {
            1 => edges.boundary.push(ends),
            2 if forward != 1 => edges.misoriented.push(ends),
            2 => {}
            _ => edges.non_manifold.push(ends),
        }
    }
    edges.closed = cancels(points, &uneven);
    edges.closed_along_lines = edges.closed && !uneven.is_empty();
    edges
}

/// Returns whether edges cancel as signed sets of points.
///
/// An edge from one vertex to another cancels two edges in the opposite direction through a vertex
/// between them. This happens where a triangle without area was dropped. On every line, as many
/// edges must end at each vertex as start there: then every point of the line is passed equally
/// often in both directions.
fn cancels(points: &[Vector3<f64>], edges: &[[u32; 2]]) -> bool {
    let ways = |&[from, to]: &[u32; 2]| [(from, to, 1), (to, from, -1)];
    let mut ends: Vec<(u32, u32, i64)> = edges.iter().flat_map(ways).collect();
    sort(&mut ends, Ord::cmp);
    ends.chunk_by(|a, b| a.0 == b.0).all(|at| cancels_at(points, at))
}

/// Returns whether the ends of edges at one vertex cancel along every line.
///
/// The order of slants puts edges of one line near each other. Exact predicates separate them from
/// other edges of nearly equal slant.
fn cancels_at(points: &[Vector3<f64>], at: &[(u32, u32, i64)]) -> bool {
    let end = |&(v, w, sense): &(u32, u32, i64)| (slant(&(points[w as usize] - points[v as usize])), v, w, sense);
    let mut ends: Vec<(f64, u32, u32, i64)> = at.iter().map(end).collect();
    sort(&mut ends, |x, y| {
        x.0.total_cmp(&y.0).then((x.1, x.2, x.3).cmp(&(y.1, y.2, y.3)))
    });
    for k in 0..ends.len() {
        let (least, v, w, own) = ends[k];
        // An end that has been counted already has no sign left.
        if own == 0 {
            continue;
        }
        let mut sum = 0;
        for (_, _, other, sense) in ends[k..].iter_mut().take_while(|x| x.0 <= least + SLANT) {
            let [a, b, c] = [v, w, *other].each(|k| &points[k as usize]);
            if *sense != 0 && (*other == w || sign::projection(a, b, c).is_none()) {
                sum += *sense;
                *sense = 0;
            }
        }
        if sum != 0 {
            return false;
        }
    }
    true
}

/// Returns a number that identifies the line through the origin along a non-zero direction.
///
/// It is the square of the cosine of the angle to a fixed line, chosen so that no direction with
/// round coordinates is parallel to it.
fn slant(v: &Vector3<f64>) -> f64 {
    let u = v / v.amax();
    let along = u.dot(&Vector3::new(0.137, 0.618_033_988, 0.381_966));
    along * along / u.norm_squared()
}

/// Returns the connected components, and four vertices of each that are far from each other.
///
/// Triangles are connected by shared vertices. Components are in the order of their first triangle.
pub(super) fn parts(points: &[Vector3<f64>], triangles: &[[u32; 3]], closed: bool) -> (Vec<MeshPart>, Vec<[u32; 4]>) {
    let mut parent: Vec<u32> = (0..points.len() as u32).collect();
    for t in triangles {
        for &v in &t[1..] {
            let (root, other) = (find(&mut parent, t[0]), find(&mut parent, v));
            // The lower index becomes the root; with path halving the trees stay shallow.
            parent[root.max(other) as usize] = root.min(other);
        }
    }
    let mut number = vec![u32::MAX; points.len()];
    let (mut parts, mut vertices) = (Vec::<MeshPart>::new(), Vec::new());
    for (k, t) in triangles.iter().enumerate() {
        let root = find(&mut parent, t[0]) as usize;
        if number[root] == u32::MAX {
            number[root] = parts.len() as u32;
            parts.push(MeshPart {
                triangle: k as u32,
                triangles: 0,
                volume: 0.0,
            });
            vertices.push([t[0]; 4]);
        }
        let part = number[root] as usize;
        parts[part].triangles += 1;
        if closed {
            // Relative to a vertex of the component, so that its position has no effect.
            let base = points[vertices[part][0] as usize];
            let [a, b, c] = t.each(|v| points[v as usize] - base);
            parts[part].volume += a.dot(&b.cross(&c)) / 6.0;
        }
    }
    for corner in 1..4 {
        for t in triangles {
            let part = number[find(&mut parent, t[0]) as usize] as usize;
            for &v in t {
                let [now, new] = [vertices[part][corner], v].each(|v| {
                    let mut four = vertices[part];
                    four[corner] = v;
                    spread(four.each(|v| &points[v as usize]), corner)
                });
                if new > now {
                    vertices[part][corner] = v;
                }
            }
        }
    }
    (parts, vertices)
}

/// Returns a measure of how far the first vertices of a tetrahedron are from each other.
///
/// It is the square of a length or of an area, or a volume.
fn spread([a, b, c, d]: [&Vector3<f64>; 4], corner: usize) -> f64 {
    let (u, v, w) = (b - a, c - a, d - a);
    match corner {
        1 => u.norm_squared(),
        2 => u.cross(&v).norm_squared(),
        _ => u.cross(&v).dot(&w).abs(),
    }
}

/// Returns the root of a vertex and halves the path to it.
pub(crate) fn find(parent: &mut [u32], mut v: u32) -> u32 {
    while parent[v as usize] != v {
        let above = parent[parent[v as usize] as usize];
        parent[v as usize] = above;
        v = above;
    }
    v
}

/// Number of components whose volumes are looked through for a hint.
const LISTED_PARTS: usize = 16;

/// Number of triangles of a sheet that are probed until one shows the side of the body: the largest
/// ones.
const PROBES: usize = 16;

/// Distances of the two points that show on which side of a triangle the body is, in units of the
/// root of twice its area. If another surface is between them and the triangle, a smaller one is
/// tried.
const BESIDE: [f64; 3] = [1.0 / 1024.0, 1.0 / (1u64 << 20) as f64, 1.0 / (1u64 << 30) as f64];

impl Mesh {
    /// Returns the solid with all of its triangles facing outward; `None` if they do already.
    ///
    /// Nothing else changes: trackers must not follow it.
    pub(crate) fn facing_outward(&self) -> Option<Self> {
        let is_inward = self.inward()?;
        let mut mesh = self.clone();
        let inward = mesh.triangles.iter_mut().zip(is_inward).filter(|x| x.1);
        inward.for_each(|(corners, _)| corners.swap(1, 2));
        Some(mesh)
    }

    /// Returns which triangles of a solid face inward; `None` if none does, or if it is open.
    ///
    /// All triangles of a sheet face the same way.
    pub(super) fn inward(&self) -> Option<Vec<bool>> {
        if !self.is_solid() {
            return None;
        }
        let (sheets, _) = self.sheets();
        let size = |t: u32| triangle::normal(&self.corners(t)).norm_squared();
        let mut order: Vec<(u32, f64, u32)> = (0u32..).zip(&sheets).map(|(t, s)| (*s, size(t), t)).collect();
        sort(&mut order, |x, y| {
            x.0.cmp(&y.0).then(y.1.total_cmp(&x.1)).then(x.2.cmp(&y.2))
        });
        let (mut is_inward, mut open) = (vec![false; sheets.len()], Vec::new());
        for sheet in order.chunk_by(|x, y| x.0 == y.0) {
            match sheet.iter().take(PROBES).find_map(|x| self.is_inward(x.2)) {
                Some(true) => sheet.iter().for_each(|x| is_inward[x.2 as usize] = true),
                Some(false) => {}
                None => open.extend(sheet.iter().map(|x| x.2)),
            }
        }
        // Two equal triangles between bodies of opposite sense: the later one is flipped, so that
        // they cancel.
        let mut twins: Vec<([u32; 3], u32, u32)> = Vec::new();
        for t in open {
            let mut corners = self.triangles[t as usize];
            let first = (0..3).min_by_key(|k| corners[*k]).unwrap_or(0);
            corners.rotate_left(first);
            twins.push((corners, self.source_triangles[t as usize], t));
        }
        sort(&mut twins, Ord::cmp);
        for equal in twins.chunk_by(|x, y| x.0 == y.0) {
            equal
                .iter()
                .skip(1)
                .step_by(2)
                .for_each(|x| is_inward[x.2 as usize] = true);
        }
        is_inward.contains(&true).then_some(is_inward)
    }

    /// Returns false if no triangle of a solid is likely to face inward.
    ///
    /// This is so if it has few components, and all volumes are positive. It is a hint alone.
    pub(crate) fn may_face_inward(&self) -> bool {
        let parts = &self.report.parts;
        parts.len() > LISTED_PARTS || parts.iter().any(|part| !(part.volume > 0.0))
    }

    /// Returns whether the body is in front of a triangle: the winding numbers on both sides of its
    /// centroid have a negative sum.
    ///
    /// Returns `None` if no points next to the triangle show it. Two equal triangles between bodies
    /// of opposite sense show nothing.
    pub(crate) fn is_inward(&self, t: u32) -> Option<bool> {
        let is_clear = |[front, back]: &[i32; 2]| front < back && front + back != 0;
        self.sides_that(t, is_clear).map(|[front, back]| front + back < 0)
    }

    /// Returns the winding numbers in front of a triangle and behind it, close to its centroid.
    ///
    /// Returns `None` if no points next to the triangle show them.
    pub(crate) fn sides(&self, t: u32) -> Option<[i32; 2]> {
        self.sides_that(t, |[front, back]| front < back)
    }

    /// Returns the winding numbers on both sides of a triangle for which `is_clear` returns true.
    fn sides_that(&self, t: u32, is_clear: impl Fn(&[i32; 2]) -> bool) -> Option<[i32; 2]> {
        let corners = self.corners(t);
        let normal = triangle::normal(&corners);
        let length = sqrt(normal.norm_squared());
        let out = normal / length * sqrt(length);
        BESIDE.iter().find_map(|part| {
            let [front, back] = [*part, -*part].each(|part| self.flushed(&(self.triangle_middle(t) + out * part)));
            if !(front.height(&corners) > 0 && back.height(&corners) < 0) {
                return None;
            }
            // Behind a triangle the surface winds once more.
            let sides = [self.winding(&front)?, self.winding(&back)?];
            is_clear(&sides).then_some(sides)
        })
    }

    /// Returns whether points may have a winding number other than 0 and 1, unless the surface
    /// crosses itself.
    pub(crate) fn may_cover_itself(&self) -> bool {
        self.report.parts.len() > 1 || !self.report.non_manifold_edges.is_empty() || self.may_face_inward()
    }

    /// Returns the first of the given triangles of each sheet.
    pub(crate) fn first_of_sheets(&self, triangles: &[u32]) -> Vec<u32> {
        let (sheets, _) = self.sheets();
        let mut is_seen = vec![false; sheets.len()];
        let mut is_first = |t: &u32| !core::mem::replace(&mut is_seen[sheets[*t as usize] as usize], true);
        triangles.iter().copied().filter(|t| is_first(t)).collect()
    }

    /// Returns the sheet of each triangle, named by one of its triangles, and whether the surface
    /// is simple at its edges.
    ///
    /// A sheet is connected over edges of two triangles that run along them in opposite directions.
    /// The surface is simple if all edges are such.
    pub(crate) fn sheets(&self) -> (Vec<u32>, bool) {
        let mut all: Vec<([u32; 2], bool, u32)> = Vec::with_capacity(3 * self.triangles.len());
        for (t, corners) in (0..).zip(&self.triangles) {
            for k in 0..3 {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                all.push(([a.min(b), a.max(b)], a < b, t));
            }
        }
        all.sort_unstable();
        let mut sheets: Vec<u32> = (0..self.triangles.len() as u32).collect();
        let mut is_simple = true;
        for edge in all.chunk_by(|x, y| x.0 == y.0) {
            let [(_, false, t), (_, true, u)] = *edge else {
                is_simple = false;
                continue;
            };
            let (x, y) = (find(&mut sheets, t), find(&mut sheets, u));
            sheets[x.max(y) as usize] = x.min(y);
        }
        let names = (0..sheets.len() as u32).map(|t| find(&mut sheets, t)).collect();
        (names, is_simple)
    }
}

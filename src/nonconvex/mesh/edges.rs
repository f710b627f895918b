//! Edges, closedness and connected components, and reorientation of triangles.
//!
//! Two triangles that share an edge agree if they run along it in opposite directions. The
//! orientation of the first triangle of a connected component determines that of all others, edge
//! by edge. If it determines both orientations of one triangle, the surface has one side. Of the
//! two orientations of a component, the one that most of its triangles have is chosen. Then a
//! component that lies in no other component is made to face outward.

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Point3, Vector3};

use super::{Mesh, MeshError, MeshPart};
use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::sign;
use crate::base::tolerance::SLANT;

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
    ends.sort_unstable();
    ends.chunk_by(|a, b| a.0 == b.0).all(|at| cancels_at(points, at))
}

/// Returns whether the ends of edges at one vertex cancel along every line.
///
/// The order of slants puts edges of one line near each other. Exact predicates separate them from
/// other edges of nearly equal slant.
fn cancels_at(points: &[Vector3<f64>], at: &[(u32, u32, i64)]) -> bool {
    let end = |&(v, w, sense): &(u32, u32, i64)| (slant(&(points[w as usize] - points[v as usize])), v, w, sense);
    let mut ends: Vec<(f64, u32, u32, i64)> = at.iter().map(end).collect();
    ends.sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then((x.1, x.2, x.3).cmp(&(y.1, y.2, y.3))));
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

/// Neighbours of a triangle at its three edges, and whether both run along the edge in one
/// direction.
type Neighbours = [(u32, bool); 3];

/// A component of triangles that share edges.
struct SensePart {
    volume: f64,
    low: Vector3<f64>,
    high: Vector3<f64>,
    triangle: u32,
}

impl Mesh {
    /// Builds a solid after reorienting triangles that face the wrong side.
    ///
    /// Also returns the caller's indices of the reoriented triangles. First, within each connected
    /// component, as few triangles as possible are flipped so that all agree. Then whole components
    /// that lie in no other component are flipped to face outward. A component inside another one
    /// keeps its orientation relative to the outermost component around it, so that a cavity stays
    /// a cavity. A mesh that is closed as given is not changed, for any orientations. The
    /// call takes about three times as long as [`new`](Self::new).
    ///
    /// # Errors
    ///
    /// Returns the errors of [`new`](Self::new). Also returns an error if no reorientation makes
    /// the mesh a solid: an edge belongs to one triangle or to more than two
    /// ([`MeshError::NotTwo`]), or the surface has one side ([`MeshError::OneSided`]).
    ///
    /// ```
    /// use lin_canny::nalgebra::Point3;
    /// use lin_canny::{Mesh, MeshKind};
    ///
    /// let points =
    ///     [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]].map(Point3::from);
    /// // The second is turned over.
    /// let triangles = [[0, 2, 1], [0, 3, 1], [1, 2, 3], [2, 0, 3]];
    /// let surface = Mesh::new(&points, &triangles)?;
    /// assert_eq!(surface.kind(), MeshKind::Open);
    /// assert_eq!(surface.report().misoriented_edges.len(), 3);
    /// let (solid, turned) = Mesh::oriented(&points, &triangles)?;
    /// assert_eq!((solid.kind(), turned), (MeshKind::Solid, vec![1]));
    /// # Ok::<(), lin_canny::MeshError>(())
    /// ```
    #[doc(alias = "winding order")]
    #[doc(alias = "fix normals")]
    pub fn oriented(points: &[Point3<f64>], triangles: &[[u32; 3]]) -> Result<(Self, Vec<u32>), MeshError> {
        let given = Self::new(points, triangles)?;
        if given.is_solid() {
            return Ok((given, Vec::new()));
        }
        let neighbours = given.neighbours()?;
        let (mut is_turned, part_of) = given.agreeing(&neighbours)?;
        let mut solid = Self::new(points, &given.turned(triangles, &is_turned))?;
        let parts = given.sense_parts(&is_turned, &part_of);
        let is_inward = solid.inward(&given, &parts, &part_of);
        if is_inward.contains(&true) {
            for (is_turned, part) in is_turned.iter_mut().zip(&part_of) {
                *is_turned ^= is_inward[*part as usize];
            }
            solid = Self::new(points, &given.turned(triangles, &is_turned))?;
        }
        let names = given.source_triangles.iter().zip(&is_turned);
        let mut turned: Vec<u32> = names.filter(|x| *x.1).map(|x| *x.0).collect();
        turned.sort_unstable();
        Ok((solid, turned))
    }

    /// Returns the neighbours of every triangle.
    fn neighbours(&self) -> Result<Vec<Neighbours>, MeshError> {
        let mut runs: Vec<([u32; 2], u32, u8)> = Vec::with_capacity(3 * self.triangles.len());
        for (k, t) in (0u32..).zip(&self.triangles) {
            for i in 0..3u8 {
                let (from, to) = (t[usize::from(i)], t[(usize::from(i) + 1) % 3]);
                runs.push(([from.min(to), from.max(to)], k, i));
            }
        }
        runs.sort_unstable();
        let mut neighbours = vec![[(0, false); 3]; self.triangles.len()];
        let starts = |(_, k, i): ([u32; 2], u32, u8)| self.triangles[k as usize][usize::from(i)];
        for edge in runs.chunk_by(|x, y| x.0 == y.0) {
            let &[x, y] = edge else {
                let edge_of = edge[0].0.each(|v| self.source_points[v as usize]);
                return Err(MeshError::NotTwo {
                    edge: edge_of,
                    triangles: edge.len(),
                });
            };
            let is_alike = starts(x) == starts(y);
            neighbours[x.1 as usize][usize::from(x.2)] = (y.1, is_alike);
            neighbours[y.1 as usize][usize::from(y.2)] = (x.1, is_alike);
        }
        Ok(neighbours)
    }

    /// Returns which triangles to flip, at most half of each component, and the component of each.
    fn agreeing(&self, neighbours: &[Neighbours]) -> Result<(Vec<bool>, Vec<u32>), MeshError> {
        let count = self.triangles.len();
        let (mut is_turned, mut part_of) = (vec![false; count], vec![u32::MAX; count]);
        let mut parts = 0;
        for first in 0..count {
            if part_of[first] != u32::MAX {
                continue;
            }
            part_of[first] = parts;
            let mut members = vec![first];
            let mut next = 0;
            while let Some(&t) = members.get(next) {
                next += 1;
                for (i, &(u, is_alike)) in neighbours[t].iter().enumerate() {
                    let sense = is_turned[t] ^ is_alike;
                    let u = u as usize;
                    if part_of[u] == u32::MAX {
                        (part_of[u], is_turned[u]) = (parts, sense);
                        members.push(u);
                    } else if is_turned[u] != sense {
                        let edge = [i, (i + 1) % 3].each(|i| self.source_points[self.triangles[t][i] as usize]);
                        return Err(MeshError::OneSided { edge });
                    }
                }
            }
            if 2 * members.iter().filter(|&&t| is_turned[t]).count() > members.len() {
                members.iter().for_each(|&t| is_turned[t] = !is_turned[t]);
            }
            parts += 1;
        }
        Ok((is_turned, part_of))
    }

    /// Returns the caller's triangles, with the marked ones flipped.
    fn turned(&self, triangles: &[[u32; 3]], is_turned: &[bool]) -> Vec<[u32; 3]> {
        let mut all = triangles.to_vec();
        for (&k, _) in self.source_triangles.iter().zip(is_turned).filter(|x| *x.1) {
            all[k as usize].swap(1, 2);
        }
        all
    }

    /// Returns the volumes and the boxes of the components.
    fn sense_parts(&self, is_turned: &[bool], part_of: &[u32]) -> Vec<SensePart> {
        let mut parts: Vec<SensePart> = Vec::new();
        let mut bases = Vec::new();
        for (k, (&part, &is_turned)) in part_of.iter().zip(is_turned).enumerate() {
            let corners = self.corners(k as u32);
            // Components are numbered in the order of their first triangles.
            if part as usize == parts.len() {
                bases.push(corners[0]);
                parts.push(SensePart {
                    volume: 0.0,
                    low: corners[0],
                    high: corners[0],
                    triangle: k as u32,
                });
            }
            let own = &mut parts[part as usize];
            for p in &corners {
                (own.low, own.high) = (own.low.smaller(*p), own.high.larger(*p));
            }
            let [a, b, c] = corners.each(|p| p - bases[part as usize]);
            let volume = a.dot(&b.cross(&c)) / 6.0;
            own.volume += if is_turned { -volume } else { volume };
        }
        parts
    }

    /// Returns which components of a solid must be flipped as a whole.
    ///
    /// These are the components that lie in no other component and face inward, and the components
    /// inside them.
    fn inward(&self, given: &Self, parts: &[SensePart], part_of: &[u32]) -> Vec<bool> {
        let most = given.source_triangles.iter().max().map_or(0, |k| *k as usize + 1);
        let mut part_of_source = vec![u32::MAX; most];
        for (&source, &part) in given.source_triangles.iter().zip(part_of) {
            part_of_source[source as usize] = part;
        }
        let of = |t: u32| part_of_source[self.source_triangles[t as usize] as usize];
        let mut order: Vec<usize> = (0..parts.len()).collect();
        order.sort_by(|&i, &j| parts[j].volume.abs().total_cmp(&parts[i].volume.abs()));
        let mut is_inward = vec![false; parts.len()];
        for (k, &part) in order.iter().enumerate() {
            let own = &parts[part];
            let probes = given.corners(own.triangle);
            let may_hold =
                |outer: &SensePart| (0..3).all(|k| outer.low[k] <= own.low[k] && own.high[k] <= outer.high[k]);
            // The larger components come first: the outermost one decides.
            let outer = order[..k].iter().copied().find(|&outer| {
                let is_other = |t: u32| of(t) == outer as u32;
                let winding = |p: &Vector3<f64>| self.winding_of(p, is_other);
                may_hold(&parts[outer]) && probes.iter().find_map(winding).is_some_and(|w| w != 0)
            });
            is_inward[part] = outer.map_or(own.volume < 0.0, |outer| is_inward[outer]);
        }
        is_inward
    }
}

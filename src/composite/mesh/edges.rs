//! Edges, closedness and connected parts.

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::Vector3;

use super::MeshPart;
use crate::base::num::sign;
use crate::base::tolerance::SLANT;

/// The edges of a mesh that are not between two triangles of opposite sense.
#[derive(Default)]
pub(super) struct Edges {
    pub(super) boundary: Vec<[u32; 2]>,
    pub(super) non_manifold: Vec<[u32; 2]>,
    pub(super) misoriented: Vec<[u32; 2]>,
    /// Whether along every line as many edges of triangles run one way as the other, all along the
    /// line: then every point off the surface has a winding number.
    pub(super) closed: bool,
    /// Whether edges that are not between two triangles close the surface along a line.
    pub(super) closed_along_lines: bool,
}

/// Sorts the edges of all triangles and judges each.
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

/// Returns whether edges cancel as sets of points counted with their sense: an edge from one vertex
/// to another cancels two edges back by way of a vertex between, as where a triangle without area
/// was dropped. On every line, as many edges must end at each vertex as begin: what is closed on a
/// line goes over every place of the line to and fro.
fn cancels(points: &[Vector3<f64>], edges: &[[u32; 2]]) -> bool {
    let ways = |&[from, to]: &[u32; 2]| [(from, to, 1), (to, from, -1)];
    let mut ends: Vec<(u32, u32, i64)> = edges.iter().flat_map(ways).collect();
    ends.sort_unstable();
    ends.chunk_by(|a, b| a.0 == b.0).all(|at| cancels_at(points, at))
}

/// Returns whether the ends of edges at one vertex cancel along every line. Edges of one line are
/// near each other in the order of their slants; exact predicates tell them from others of like
/// slant.
fn cancels_at(points: &[Vector3<f64>], at: &[(u32, u32, i64)]) -> bool {
    let end = |&(v, w, sense): &(u32, u32, i64)| (slant(&(points[w as usize] - points[v as usize])), v, w, sense);
    let mut ends: Vec<(f64, u32, u32, i64)> = at.iter().map(end).collect();
    ends.sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then((x.1, x.2, x.3).cmp(&(y.1, y.2, y.3))));
    for k in 0..ends.len() {
        let (least, v, w, own) = ends[k];
        // An end that has been counted has no sense left.
        if own == 0 {
            continue;
        }
        let mut sum = 0;
        for (_, _, other, sense) in ends[k..].iter_mut().take_while(|x| x.0 <= least + SLANT) {
            let [a, b, c] = [v, w, *other].map(|k| &points[k as usize]);
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

/// Returns a number of the line through the origin along a direction that is not zero: the square
/// of the cosine of the angle to a fixed line that no round number is along.
fn slant(v: &Vector3<f64>) -> f64 {
    let u = v / v.amax();
    let along = u.dot(&Vector3::new(0.137, 0.618_033_988, 0.381_966));
    along * along / u.norm_squared()
}

/// Connected parts by shared vertices, in the order of their first triangle, and of each four
/// vertices that are far from each other.
pub(super) fn parts(points: &[Vector3<f64>], triangles: &[[u32; 3]], closed: bool) -> (Vec<MeshPart>, Vec<[u32; 4]>) {
    let mut parent: Vec<u32> = (0..points.len() as u32).collect();
    for t in triangles {
        for &v in &t[1..] {
            let (root, other) = (find(&mut parent, t[0]), find(&mut parent, v));
            // The lower number becomes the root; with halved paths that keeps trees shallow.
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
            // About a vertex of the part, so that its place does not matter.
            let base = points[vertices[part][0] as usize];
            let [a, b, c] = t.map(|v| points[v as usize] - base);
            parts[part].volume += a.dot(&b.cross(&c)) / 6.0;
        }
    }
    for corner in 1..4 {
        for t in triangles {
            let part = number[find(&mut parent, t[0]) as usize] as usize;
            for &v in t {
                let [now, new] = [vertices[part][corner], v].map(|v| {
                    let mut four = vertices[part];
                    four[corner] = v;
                    spread(four.map(|v| &points[v as usize]), corner)
                });
                if new > now {
                    vertices[part][corner] = v;
                }
            }
        }
    }
    (parts, vertices)
}

/// Returns how far the first corners of a tetrahedron are from each other: the square of a length
/// or of an area, or a volume.
fn spread([a, b, c, d]: [&Vector3<f64>; 4], corner: usize) -> f64 {
    let (u, v, w) = (b - a, c - a, d - a);
    match corner {
        1 => u.norm_squared(),
        2 => u.cross(&v).norm_squared(),
        _ => u.cross(&v).dot(&w).abs(),
    }
}

/// Returns the root of a vertex; the path to it is halved on the way.
pub(super) fn find(parent: &mut [u32], mut v: u32) -> u32 {
    while parent[v as usize] != v {
        let above = parent[parent[v as usize] as usize];
        parent[v as usize] = above;
        v = above;
    }
    v
}

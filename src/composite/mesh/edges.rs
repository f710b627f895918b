//! Edges, closedness and connected parts.

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::Vector3;

use super::MeshPart;

/// The edges of a mesh that are not between two triangles of opposite sense.
#[derive(Default)]
pub(super) struct Edges {
    pub(super) boundary: Vec<[u32; 2]>,
    pub(super) non_manifold: Vec<[u32; 2]>,
    pub(super) misoriented: Vec<[u32; 2]>,
    /// Whether along every edge as many triangles run one way as the other: then every point off
    /// the surface has a winding number.
    pub(super) closed: bool,
}

/// Sorts the edges of all triangles and judges each.
pub(super) fn judge(triangles: &[[u32; 3]]) -> Edges {
    let mut runs: Vec<(u64, bool)> = Vec::with_capacity(3 * triangles.len());
    for &[a, b, c] in triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            runs.push((u64::from(from.min(to)) << 32 | u64::from(from.max(to)), from < to));
        }
    }
    runs.sort_unstable();
    let mut edges = Edges {
        closed: true,
        ..Edges::default()
    };
    for edge in runs.chunk_by(|a, b| a.0 == b.0) {
        let ends = [(edge[0].0 >> 32) as u32, edge[0].0 as u32];
        let forward = edge.iter().filter(|e| e.1).count();
        edges.closed &= 2 * forward == edge.len();
        match edge.len() {
            1 => edges.boundary.push(ends),
            2 if forward != 1 => edges.misoriented.push(ends),
            2 => {}
            _ => edges.non_manifold.push(ends),
        }
    }
    edges
}

/// Connected parts by shared vertices, in the order of their first triangle, and of each a vertex
/// and the vertex that is farthest from it.
pub(super) fn parts(points: &[Vector3<f64>], triangles: &[[u32; 3]], closed: bool) -> (Vec<MeshPart>, Vec<[u32; 2]>) {
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
            vertices.push([t[0]; 2]);
        }
        let part = number[root] as usize;
        parts[part].triangles += 1;
        let [first, far] = &mut vertices[part];
        // About a vertex of the part, so that its place does not matter.
        let base = points[*first as usize];
        let away = |v: u32| (points[v as usize] - base).norm_squared();
        if away(t[0]) > away(*far) {
            *far = t[0];
        }
        if closed {
            let [a, b, c] = t.map(|v| points[v as usize] - base);
            parts[part].volume += a.dot(&b.cross(&c)) / 6.0;
        }
    }
    (parts, vertices)
}

/// The root of a vertex; the path to it is halved on the way.
pub(super) fn find(parent: &mut [u32], mut v: u32) -> u32 {
    while parent[v as usize] != v {
        let above = parent[parent[v as usize] as usize];
        parent[v as usize] = above;
        v = above;
    }
    v
}

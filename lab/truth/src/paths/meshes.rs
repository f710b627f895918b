//! First contact of two meshes whose vertices move on straight paths, or of one mesh with itself.
//!
//! The oracle tests all pairs of a vertex and a face, and of two edges, whose boxes over the frame
//! meet. At time zero it tests all pairs of triangles.

use super::{Path, Truth, edge_edge, pierce, vertex_face};
use std::collections::BTreeSet;

/// A mesh whose vertices move on straight paths.
#[derive(Clone, Debug)]
pub struct Moving {
    /// The vertices.
    pub paths: Vec<Path>,
    /// The triangles.
    pub triangles: Vec<[u32; 3]>,
}

impl Moving {
    /// Returns both as one mesh.
    pub fn with(&self, other: &Self) -> Self {
        let first = self.paths.len() as u32;
        let mut whole = self.clone();
        whole.paths.extend(&other.paths);
        whole
            .triangles
            .extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
        whole
    }

    fn corners(&self, t: usize) -> [Path; 3] {
        self.triangles[t].map(|v| self.paths[v as usize])
    }
}

/// Returns whether the boxes of the ends of some paths meet; the boxes contain the paths.
fn may_meet(p: &[Path], q: &[Path]) -> bool {
    let range = |paths: &[Path], k: usize| {
        let all = paths.iter().flatten().map(|x| x[k]);
        all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
            [low.min(x), high.max(x)]
        })
    };
    (0..3).all(|k| {
        let ([low, high], [from, to]) = (range(p, k), range(q, k));
        low <= to && from <= high
    })
}

/// Feature pairs already tested: vertex and face, face and vertex, two edges.
type Asked = BTreeSet<(u8, [u32; 3], [u32; 3])>;

fn of_pair(a: &Moving, b: &Moving, [i, j]: [usize; 2], asked: &mut Asked) -> Truth {
    let (p, q) = (a.corners(i), b.corners(j));
    if !may_meet(&p, &q) {
        return Truth::Apart;
    }
    if pierce(&p, &q) || pierce(&q, &p) {
        return Truth::Start;
    }
    let (s, t) = (a.triangles[i], b.triangles[j]);
    let edge = |t: [u32; 3], k: usize| {
        let (v, w) = (t[k], t[(k + 1) % 3]);
        [v.min(w), v.max(w), 0]
    };
    let mut first = Truth::Apart;
    for k in 0..3 {
        if asked.insert((0, [s[k], 0, 0], t)) && may_meet(&p[k..=k], &q) {
            first = first.or_earlier(vertex_face(&[p[k], q[0], q[1], q[2]]));
        }
        if asked.insert((1, s, [t[k], 0, 0])) && may_meet(&q[k..=k], &p) {
            first = first.or_earlier(vertex_face(&[q[k], p[0], p[1], p[2]]));
        }
        for l in 0..3 {
            let (e, f) = ([p[k], p[(k + 1) % 3]], [q[l], q[(l + 1) % 3]]);
            if asked.insert((2, edge(s, k), edge(t, l))) && may_meet(&e, &f) {
                first = first.or_earlier(edge_edge(&[e[0], e[1], f[0], f[1]]));
            }
        }
    }
    first
}

fn first_of(a: &Moving, b: &Moving, pairs: impl Iterator<Item = [usize; 2]>) -> Truth {
    let mut asked = Asked::new();
    let mut first = Truth::Apart;
    for pair in pairs {
        first = first.or_earlier(of_pair(a, b, pair, &mut asked));
        if matches!(first, Truth::Start) {
            break;
        }
    }
    first
}

/// Returns the first contact of two meshes.
pub fn first_contact(a: &Moving, b: &Moving) -> Truth {
    let count = b.triangles.len();
    first_of(a, b, (0..a.triangles.len() * count).map(|k| [k / count, k % count]))
}

/// Returns the first contact of two triangles of a mesh that share no vertex.
pub fn self_contact(a: &Moving) -> Truth {
    let count = a.triangles.len();
    let share = |[i, j]: [usize; 2]| a.triangles[i].iter().any(|v| a.triangles[j].contains(v));
    let pairs = (0..count).flat_map(|j| (0..j).map(move |i| [i, j]));
    first_of(a, a, pairs.filter(|pair| !share(*pair)))
}

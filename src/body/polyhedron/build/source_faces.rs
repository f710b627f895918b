//! The caller's face for each face of a body.

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::Vector3;

use crate::base::num::extremes::Extremes;
use crate::body::polyhedron::build::faces::FaceList;
use crate::body::polyhedron::{ConvexPolyhedron, FaceId};

/// A vertex of more faces than this adds no candidates if another vertex has added some.
const CROWD: usize = 8;

/// Returns for each face of the body the caller's face with most vertices in common, the lowest
/// index among equals. Three vertices decide; if the caller cut a face into pieces of fewer than
/// three common vertices, the piece in the plane of the face is taken.
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
        rim.sort_by_key(|&c| incidence.faces_at(c).len());
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

/// Returns how far three spread vertices of a caller's face reach below the plane of a face of the
/// body.
fn depth_below(corners: &[u32], body: &ConvexPolyhedron, face: FaceId, points: &[Vector3<f64>]) -> f64 {
    let plane = &body.planes[face.index()];
    let spread = [0, 1, 2].map(|k| corners[k * corners.len() / 3]);
    let depths = spread.map(|c| plane.offset - plane.normal.dot(&points[c as usize]));
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

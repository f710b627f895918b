//! From the triangles of a hull to its faces: exactly coplanar adjacent triangles become one face,
//! and only extreme points stay.

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::Vector3;

use crate::num::sign::side;
use crate::polyhedron::build::hull::{HullTriangle, Surface};

const NONE: u32 = u32::MAX;

/// The faces of a hull as loops over its extreme points.
pub(crate) struct Facets {
    /// Vertices in the order of the cloud, as indices there.
    pub(crate) kept: Vec<u32>,
    /// Rims by vertex number, counter-clockwise from outside, least vertex first, in rising order.
    pub(crate) loops: Vec<Vec<u32>>,
    /// Points of the cloud inside an edge, if they were vertices of the triangles.
    pub(crate) on_edges: Vec<u32>,
    /// Points of the cloud inside a face, if they were vertices of the triangles.
    pub(crate) on_faces: Vec<u32>,
    /// Number of triangles merged away.
    pub(crate) merged: usize,
}

impl Facets {
    pub(crate) fn new(points: &[Vector3<f64>], surface: &Surface) -> Option<Self> {
        let triangles = &surface.triangles;
        let (group, groups) = coplanar_groups(points, triangles);
        let degree = faces_at(points.len(), triangles, &group);
        let mut number = vec![NONE; points.len()];
        let mut facets = Self {
            kept: Vec::new(),
            loops: Vec::with_capacity(groups),
            on_edges: Vec::new(),
            on_faces: Vec::new(),
            merged: triangles.len() - groups,
        };
        for (i, degree) in degree.iter().enumerate() {
            match degree {
                0 => {}
                1 => facets.on_faces.push(i as u32),
                2 => facets.on_edges.push(i as u32),
                _ => {
                    number[i] = facets.kept.len() as u32;
                    facets.kept.push(i as u32);
                }
            }
        }
        let mut done = vec![false; groups];
        let mut order = Vec::with_capacity(groups);
        for start in 0..triangles.len() {
            let g = group[start] as usize;
            let Some(k) = (0..3).find(|&k| group[triangles[start].adjacent[k] as usize] != group[start]) else {
                continue;
            };
            if !core::mem::replace(&mut done[g], true) {
                let ring = rim(triangles, &group, &number, start as u32, k)?;
                order.push(((ring[0] as u64) << 32 | ring[1] as u64, facets.loops.len()));
                facets.loops.push(ring);
            }
        }
        order.sort_unstable();
        facets.loops = order
            .into_iter()
            .map(|(_, i)| core::mem::take(&mut facets.loops[i]))
            .collect();
        (facets.loops.len() == groups).then_some(facets)
    }
}

/// Returns the face number of each triangle, and the number of faces.
fn coplanar_groups(points: &[Vector3<f64>], triangles: &[HullTriangle]) -> (Vec<u32>, usize) {
    let mut parent: Vec<u32> = (0..triangles.len() as u32).collect();
    for (i, t) in triangles.iter().enumerate() {
        let [a, b, c] = t.v.map(|v| &points[v as usize]);
        for &other in t.adjacent.iter().filter(|&&o| (o as usize) > i) {
            let across = triangles[other as usize].v.into_iter().find(|v| !t.v.contains(v));
            if across.is_some_and(|d| side(a, b, c, &points[d as usize]) == 0.0) {
                let (p, q) = (root(&mut parent, i as u32), root(&mut parent, other));
                parent[p.max(q) as usize] = p.min(q);
            }
        }
    }
    // Roots come before all members, so a single pass numbers the groups.
    let mut group = vec![NONE; triangles.len()];
    let mut count = 0;
    for i in 0..triangles.len() {
        let r = root(&mut parent, i as u32) as usize;
        if r == i {
            group[i] = count;
            count += 1;
        } else {
            group[i] = group[r];
        }
    }
    (group, count as usize)
}

fn root(parent: &mut [u32], mut i: u32) -> u32 {
    while parent[i as usize] != i {
        parent[i as usize] = parent[parent[i as usize] as usize];
        i = parent[i as usize];
    }
    i
}

/// Returns the number of faces at each point, counted up to 3: a vertex has three, a point inside
/// an edge two.
fn faces_at(points: usize, triangles: &[HullTriangle], group: &[u32]) -> Vec<u8> {
    let mut degree = vec![0u8; points];
    let mut met = vec![[NONE; 2]; points];
    for (t, &g) in triangles.iter().zip(group) {
        for v in t.v.map(|v| v as usize) {
            if degree[v] < 3 && !met[v][..degree[v] as usize].contains(&g) {
                if degree[v] < 2 {
                    met[v][degree[v] as usize] = g;
                }
                degree[v] += 1;
            }
        }
    }
    degree
}

/// Returns the extreme points round the face of triangle `start`, whose edge `k` is on the rim;
/// least vertex first.
fn rim(triangles: &[HullTriangle], group: &[u32], number: &[u32], start: u32, k: usize) -> Option<Vec<u32>> {
    let mut ring = Vec::with_capacity(3);
    let (mut t, mut e) = (start, k);
    for _ in 0..3 * triangles.len() {
        let vertex = number[triangles[t as usize].v[e] as usize];
        if vertex != NONE {
            ring.push(vertex);
        }
        // The next rim edge leaves the end of this edge: turn about the end through triangles of
        // one face.
        e = (e + 1) % 3;
        let mut other = triangles[t as usize].adjacent[e];
        while group[other as usize] == group[start as usize] {
            let pivot = triangles[t as usize].v[e];
            t = other;
            e = triangles[t as usize].v.iter().position(|&v| v == pivot)?;
            other = triangles[t as usize].adjacent[e];
        }
        if (t, e) == (start, k) {
            let least = ring.iter().enumerate().min_by_key(|r| r.1)?.0;
            ring.rotate_left(least);
            return (ring.len() >= 3).then_some(ring);
        }
    }
    None
}

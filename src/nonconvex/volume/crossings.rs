//! Where two surfaces cross: crossings of edges with triangles, segments of two triangles, and the
//! winding numbers of vertices.
//!
//! 1. Two trees find the pairs of triangles whose boxes meet. Exact signs ([`ties`]) find the edges
//!    of one triangle that pass through the other one. Two such crossings are the ends of the
//!    segment that the triangles share.
//! 2. Along an edge the winding number of the other body changes at crossings alone. So the winding
//!    numbers of all vertices that edges connect differ by known numbers. One vertex outside the
//!    box of the other body, or one ray, decides all of them.
//!
//! Signs of one true position agree: a segment has no end or two, and the changes along edges
//! cancel around every loop. If they did not, the caller would get wide bounds.

use alloc::vec;
use alloc::vec::Vec;

use super::surfaces::Surfaces;
use super::ties;
use crate::base::num::each::Each;
use crate::base::pose::Operand;
use crate::nonconvex::front::NodePair;

/// The bodies in the order of their indices.
const BODIES: [Operand; 2] = [Operand::A, Operand::B];

/// Signs that do not agree. Exact signs of one position always do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Disagreement;

/// An edge that passes through a triangle of the other body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Crossing {
    /// The vertices of the edge, the lower index first.
    pub(super) edge: [u32; 2],
    /// The triangle of the other body.
    pub(super) through: u32,
    /// 1 if the edge leaves the other body on the way from its first vertex, -1 if it enters.
    pub(super) leaves: i32,
}

/// A segment that two triangles share, along the cross product of their normals.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    /// The triangle of each body.
    pub(super) of: [u32; 2],
    /// The body of the edge and the index of the crossing, for the start and the end.
    pub(super) ends: [(usize, u32); 2],
}

/// A crossing, as one of the triangles next to the edge sees it.
struct Sighting {
    crossing: Crossing,
    /// The triangle, if the edge is the one between its second and its third corner.
    based: Option<u32>,
}

/// What one body has of the crossings.
#[derive(Default)]
pub(super) struct SideCrossings {
    /// The crossings of edges of this body, each once, in the order of the edges.
    pub(super) all: Vec<Crossing>,
    /// The triangles with a crossing on the edge between the second and the third corner, and the
    /// crossing, in rising order.
    pub(super) based: Vec<(u32, u32)>,
    /// The winding number of the other body about each vertex of a near triangle.
    pub(super) windings: Vec<i32>,
}

/// Everything that the sums need to know of two surfaces.
#[derive(Default)]
pub(super) struct Crossings {
    pub(super) of: [SideCrossings; 2],
    pub(super) segments: Vec<Segment>,
    /// The largest and the smallest winding number of a vertex.
    pub(super) range: [i32; 2],
}

impl Crossings {
    /// Finds the crossings of two surfaces.
    pub(super) fn find(surfaces: &mut Surfaces) -> Result<Self, Disagreement> {
        let mut pairs = Vec::new();
        surfaces.each_pair(|pair| pairs.push(pair));
        let mut seen = Seen::default();
        for pair in pairs {
            seen.look_at(surfaces, pair)?;
        }
        let mut found = Self::default();
        let mut numbers: [Vec<u32>; 2] = Default::default();
        for k in 0..2 {
            numbers[k] = found.of[k].collect(&seen.sightings[k])?;
        }
        let number = |end: (usize, u32)| (end.0, numbers[end.0][end.1 as usize]);
        found.segments = seen.segments;
        for segment in &mut found.segments {
            segment.ends = segment.ends.each(number);
        }
        for k in 0..2 {
            let windings = found.of[k].flood(surfaces, k)?;
            for t in &surfaces.of[k].near {
                for v in surfaces.of[k].vertices(*t) {
                    let w = windings[v as usize];
                    found.range = [found.range[0].min(w), found.range[1].max(w)];
                }
            }
            found.of[k].windings = windings;
        }
        Ok(found)
    }
}

/// What pairs of triangles show.
#[derive(Default)]
struct Seen {
    sightings: [Vec<Sighting>; 2],
    /// The ends are indices of sightings.
    segments: Vec<Segment>,
}

impl Seen {
    /// Finds where the edges of two triangles pass through the other one.
    fn look_at(&mut self, surfaces: &mut Surfaces, of: NodePair) -> Result<(), Disagreement> {
        let corners = [0, 1].each(|k: usize| surfaces.of[k].corners(of[k]));
        let mut sides = [[0; 3]; 2];
        for k in 0..2 {
            let (other, t) = (1 - k, of[1 - k]);
            let facet = ties::Facet::new(&corners[other]);
            for i in 0..3 {
                let p = &corners[k][i];
                let first = || surfaces.of[other].first_of_normal(t);
                sides[k][i] = match facet.side(p) {
                    0 => ties::side(p, &corners[other], BODIES[other], first),
                    side => side,
                };
            }
            let [x, y, z] = sides[k];
            if x == y && y == z && x != 0 {
                return Ok(());
            }
        }
        // The senses of an edge of A and an edge of B, computed when they are first used.
        let mut senses = [[None; 3]; 3];
        let mut sense = |i: usize, j: usize| {
            *senses[i][j].get_or_insert_with(|| {
                let edge = |k: usize, i: usize| [&corners[k][i], &corners[k][(i + 1) % 3]];
                ties::sense(edge(0, i), edge(1, j))
            })
        };
        let mut ends = [None; 2];
        for k in 0..2 {
            for i in 0..3 {
                let j = (i + 1) % 3;
                if sides[k][i] * sides[k][j] >= 0 {
                    continue;
                }
                let around = [0, 1, 2].each(|m: usize| if k == 0 { sense(i, m) } else { sense(m, i) });
                if around.contains(&0) {
                    return Err(Disagreement);
                }
                if around[0] != around[1] || around[1] != around[2] {
                    continue;
                }
                let leaves = sides[k][j] > 0;
                let number = self.sightings[k].len() as u32;
                self.sightings[k].push(Sighting::new(surfaces.of[k].vertices(of[k]), i, leaves, of, k));
                // Along the cross product of the normals, the segment starts where an edge of A
                // leaves or an edge of B enters.
                let end = &mut ends[usize::from(leaves == (k == 1))];
                if end.replace((k, number)).is_some() {
                    return Err(Disagreement);
                }
            }
        }
        // A triangle without area has no segment.
        if sides.contains(&[0; 3]) {
            return Ok(());
        }
        match ends {
            [Some(start), Some(end)] => self.segments.push(Segment { of, ends: [start, end] }),
            [None, None] => {}
            _ => return Err(Disagreement),
        }
        Ok(())
    }
}

impl Sighting {
    /// Notes the crossing of edge `i` of the triangle of body `k`.
    fn new(vertices: [u32; 3], i: usize, leaves: bool, of: NodePair, k: usize) -> Self {
        let [from, to] = [vertices[i], vertices[(i + 1) % 3]];
        let leaves = if leaves == (from < to) { 1 } else { -1 };
        Self {
            crossing: Crossing {
                edge: [from.min(to), from.max(to)],
                through: of[1 - k],
                leaves,
            },
            based: (i == 1).then_some(of[k]),
        }
    }
}

impl SideCrossings {
    /// Stores each crossing once; returns the index of the crossing of each sighting.
    fn collect(&mut self, seen: &[Sighting]) -> Result<Vec<u32>, Disagreement> {
        let key = |s: &Sighting| (s.crossing.edge, s.crossing.through);
        let mut order: Vec<_> = (0u32..).zip(seen).map(|(k, s)| (key(s), k)).collect();
        order.sort_unstable();
        let mut numbers = vec![0; seen.len()];
        for equal in order.chunk_by(|x, y| x.0 == y.0) {
            let number = self.all.len() as u32;
            let crossing = seen[equal[0].1 as usize].crossing;
            for &(_, k) in equal {
                let sighting = &seen[k as usize];
                if sighting.crossing != crossing {
                    return Err(Disagreement);
                }
                numbers[k as usize] = number;
                self.based.extend(sighting.based.map(|t| (t, number)));
            }
            self.all.push(crossing);
        }
        self.based.sort_unstable();
        Ok(numbers)
    }

    /// Returns how much the winding number changes from the lower to the higher vertex of an edge.
    fn change(&self, edge: [u32; 2]) -> i32 {
        let first = self.all.partition_point(|c| c.edge < edge);
        let own = self.all[first..].iter().take_while(|c| c.edge == edge);
        own.map(|c| -c.leaves).sum()
    }

    /// Returns the winding number of the other body about each vertex of a near triangle.
    fn flood(&self, surfaces: &mut Surfaces, k: usize) -> Result<Vec<i32>, Disagreement> {
        let count = surfaces.of[k].mesh.points.len();
        let mut is_crossed = vec![false; count];
        for c in &self.all {
            is_crossed[c.edge[0] as usize] = true;
        }
        let mut groups = Groups::new(count);
        let surface = &surfaces.of[k];
        for &t in &surface.near {
            let vertices = surface.vertices(t);
            for i in 0..3 {
                let (a, b) = (vertices[i], vertices[(i + 1) % 3]);
                let edge = [a.min(b), a.max(b)];
                let change = if is_crossed[edge[0] as usize] {
                    self.change(edge)
                } else {
                    0
                };
                groups.join(edge, change)?;
            }
        }
        let (near, mesh, outside) = (surface.near.clone(), surface.mesh, surfaces.of[1 - k].bounds);
        let vertices = || near.iter().flat_map(|t| mesh.triangles[*t as usize]);
        let mut windings: Vec<Option<i32>> = vec![None; count];
        for v in vertices() {
            if !outside.contains(surfaces.of[k].point(v)) {
                let (root, above) = groups.find(v);
                if *windings[root as usize].get_or_insert(-above) != -above {
                    return Err(Disagreement);
                }
            }
        }
        let mut found = vec![0; count];
        for v in vertices() {
            let (root, above) = groups.find(v);
            let of_root = *windings[root as usize].get_or_insert_with(|| surfaces.winding(BODIES[1 - k], root));
            found[v as usize] = of_root + above;
        }
        Ok(found)
    }
}

/// Vertices in groups, in which the differences of all winding numbers are known.
struct Groups {
    parents: Vec<u32>,
    /// The winding number of each vertex minus that of its parent.
    above: Vec<i32>,
}

impl Groups {
    fn new(count: usize) -> Self {
        Self {
            parents: (0..count as u32).collect(),
            above: vec![0; count],
        }
    }

    /// Returns the root of a vertex, and the winding number of the vertex minus that of the root.
    fn find(&mut self, v: u32) -> (u32, i32) {
        let (mut v, mut sum) = (v as usize, 0);
        while self.parents[v] as usize != v {
            let parent = self.parents[v] as usize;
            // Halves the path.
            self.above[v] += self.above[parent];
            self.parents[v] = self.parents[parent];
            sum += self.above[v];
            v = self.parents[v] as usize;
        }
        (v as u32, sum)
    }

    /// Joins the groups of the vertices of an edge, along which the winding number changes.
    fn join(&mut self, [a, b]: [u32; 2], change: i32) -> Result<(), Disagreement> {
        let ((x, of_a), (y, of_b)) = (self.find(a), self.find(b));
        if x != y {
            // w(b) - w(a) is the change.
            self.parents[y as usize] = x;
            self.above[y as usize] = of_a + change - of_b;
            Ok(())
        } else if of_b - of_a == change {
            Ok(())
        } else {
            Err(Disagreement)
        }
    }
}

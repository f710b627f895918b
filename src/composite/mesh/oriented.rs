//! Triangles turned so that their senses agree.
//!
//! Two triangles at an edge agree if they run along it in opposite senses. From a first triangle of
//! each connected part the sense of all others follows, edge by edge; where it follows both ways
//! the surface has one side. Of the two senses of a part, most of its triangles decide, and a part
//! that lies in no other part then faces outward.

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Point3, Vector3};

use super::{Mesh, MeshError};
use crate::base::num::extremes::Extremes;

/// Neighbours of a triangle at its three edges, and whether both run along the edge in one sense.
type Neighbours = [(u32, bool); 3];

/// A part of triangles that share edges.
struct SensePart {
    volume: f64,
    low: Vector3<f64>,
    high: Vector3<f64>,
    triangle: u32,
}

impl Mesh {
    /// Builds a solid of triangles of which some are turned over, and returns the triangles that
    /// were turned, by the caller's index.
    ///
    /// Fewest triangles of each connected part are turned to agree with the rest, then whole parts
    /// to face outward: those that lie in no other part. A part inside another one keeps its
    /// sense relative to the outermost part about it, so that a cavity stays a cavity. A mesh
    /// that is closed as it is, whatever its senses, is left as it is. Takes some three times the
    /// time of [`new`](Self::new).
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new); an edge of one triangle or of more than two
    /// ([`MeshError::NotTwo`]), or a surface with one side ([`MeshError::OneSided`]): no turning of
    /// triangles makes such a mesh a solid.
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
    /// assert_eq!(surface.kind(), MeshKind::Surface);
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
                let edge_of = edge[0].0.map(|v| self.source_points[v as usize]);
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

    /// Returns which triangles to turn, at most half of each part, and the part of each triangle.
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
                        let edge = [i, (i + 1) % 3].map(|i| self.source_points[self.triangles[t][i] as usize]);
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

    /// Returns the caller's triangles, some of them turned over.
    fn turned(&self, triangles: &[[u32; 3]], is_turned: &[bool]) -> Vec<[u32; 3]> {
        let mut all = triangles.to_vec();
        for (&k, _) in self.source_triangles.iter().zip(is_turned).filter(|x| *x.1) {
            all[k as usize].swap(1, 2);
        }
        all
    }

    /// Returns the volumes and the boxes of the parts.
    fn sense_parts(&self, is_turned: &[bool], part_of: &[u32]) -> Vec<SensePart> {
        let mut parts: Vec<SensePart> = Vec::new();
        let mut bases = Vec::new();
        for (k, (&part, &is_turned)) in part_of.iter().zip(is_turned).enumerate() {
            let corners = self.corners(k as u32);
            // Parts are numbered in the order of their first triangles.
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
            let [a, b, c] = corners.map(|p| p - bases[part as usize]);
            let volume = a.dot(&b.cross(&c)) / 6.0;
            own.volume += if is_turned { -volume } else { volume };
        }
        parts
    }

    /// Returns which parts of a solid are to be turned as a whole: those about no other part's
    /// inside that face inward, and the parts in them.
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
            // The larger parts first: the outermost one decides.
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

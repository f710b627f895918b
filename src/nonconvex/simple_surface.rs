//! Proves that the surface of a solid mesh does not meet itself, so that near triangles decide the
//! side of a point.
//!
//! 1. Each edge has two triangles, which run along it in opposite directions. Triangles that are
//!    connected over edges form a sheet.
//! 2. Two triangles share a vertex, an edge or nothing, and no other point. All pairs whose boxes
//!    may meet are tested by exact signs.
//! 3. So the winding number in front of a sheet is the same everywhere. A point close to the sheet,
//!    with exact votes and an exact winding number, reveals it.
//!
//! A mesh with components that overlap, repeated triangles or T-junctions is not simple.

use alloc::vec::Vec;

use nalgebra::{Isometry3, Vector3};

use crate::base::callbacks::Watch;
use crate::base::num::each::Each;
use crate::base::num::scalar::sqrt;
use crate::base::num::sign;
use crate::base::pose::RelativePose;
use crate::nonconvex::mesh::Mesh;
use crate::nonconvex::parts::Parted;
use crate::nonconvex::query::frame::TreeFrame;
use crate::nonconvex::query::inside::ExactSigns;
use crate::nonconvex::query::near::{NearMemory, NearTriangle};
use crate::nonconvex::query::triangle::{self, Triangle};

/// Number of triangles that may vote; a point with more is decided by its winding number.
const VOTERS: usize = 64;

/// Distances of the point that reveals the winding number of a sheet from its largest triangle, in
/// units of the root of twice the area. Any distance will do at which the votes agree.
const REVEALING: [f64; 3] = [1.0 / 16.0, 1.0 / (1u64 << 10) as f64, 1.0 / (1u64 << 20) as f64];

/// A closed surface that is proven not to meet itself.
#[derive(Clone, Debug)]
pub(crate) struct SimpleSurface {
    /// The sheet of each triangle.
    sheets: Vec<u32>,
    /// The winding number in front of each sheet, if it is known; by the sheet's first triangle.
    fronts: Vec<Option<i32>>,
}

impl SimpleSurface {
    /// Returns the proof for a mesh; `None` if its surface may meet itself.
    pub(crate) fn new(mesh: &Mesh) -> Option<Self> {
        if !mesh.is_solid() {
            return None;
        }
        let (sheets, has_simple_edges) = mesh.sheets();
        if !has_simple_edges {
            return None;
        }
        let pose = RelativePose::from_isometry(&Isometry3::identity()).ok()?;
        let frame = TreeFrame::new(mesh.side(), mesh.side(), &pose)?;
        let is_simple = mesh.join_leaves(&frame, &mut Watch::none(), |nodes| {
            let [a, b] = nodes.each(|x| mesh.tree.range(x));
            let others = |t: u32| if nodes[0] == nodes[1] { t + 1 } else { b.start };
            a.clone()
                .all(|t| (others(t)..b.end).all(|u| mesh.meet_as_neighbours(t, u)))
        });
        if !is_simple {
            return None;
        }
        let mut surface = Self {
            fronts: alloc::vec![None; sheets.len()],
            sheets,
        };
        surface.reveal(mesh);
        Some(surface)
    }

    /// Finds the winding number in front of each sheet.
    fn reveal(&mut self, mesh: &Mesh) {
        let mut largest = alloc::vec![(0.0, 0); self.sheets.len()];
        for (t, &sheet) in (0u32..).zip(&self.sheets) {
            let size = triangle::normal(&mesh.corners(t)).norm_squared();
            let best = &mut largest[sheet as usize];
            if size > best.0 {
                *best = (size, t);
            }
        }
        let mut memory = NearMemory::default();
        for (sheet, &(square, t)) in largest.iter().enumerate().filter(|(_, best)| best.0 > 0.0) {
            let normal = triangle::normal(&mesh.corners(t));
            let length = sqrt(square);
            let out = normal / length * sqrt(length);
            let front = REVEALING.iter().find_map(|part| {
                let p = mesh.flushed(&(mesh.triangle_middle(t) + out * *part));
                mesh.nearest_triangle(&p, -1.0, &mut memory);
                let is_own = |t: &NearTriangle| self.sheets[t.item as usize] as usize == sheet;
                let above = vote(mesh, &p, memory.found.iter().filter(|t| is_own(t)))?;
                if !memory.found.iter().all(is_own) {
                    return None;
                }
                Some(mesh.winding(&p)? - i32::from(above < 0))
            });
            self.fronts[sheet] = front;
        }
    }

    /// Returns the winding number of a point by the votes of the triangles that may be closest.
    ///
    /// `None` if they do not agree, or are too many.
    pub(crate) fn winding_by_vote(&self, mesh: &Mesh, p: &Vector3<f64>, found: &[NearTriangle]) -> Option<i32> {
        let first = self.sheets[found.first()?.item as usize];
        let is_other = |t: &NearTriangle| self.sheets[t.item as usize] != first;
        if found.len() > VOTERS || found.iter().any(is_other) {
            return None;
        }
        let front = self.fronts[first as usize]?;
        // Behind a triangle the surface winds once more.
        Some(front + i32::from(vote(mesh, p, found.iter())? < 0))
    }
}

/// Returns 1 if the point is above the planes of some triangles and below none, -1 if it is below
/// some and above none; `None` otherwise.
fn vote<'a>(mesh: &Mesh, p: &Vector3<f64>, triangles: impl Iterator<Item = &'a NearTriangle>) -> Option<i32> {
    let mut all = 0;
    for t in triangles {
        let height = p.height(&mesh.corners(t.item));
        if height * all < 0 {
            return None;
        }
        all += height;
    }
    (all != 0).then(|| all.signum())
}

impl Mesh {
    /// Returns whether two triangles certainly share no point besides their common vertices and
    /// edge.
    fn meet_as_neighbours(&self, t: u32, u: u32) -> bool {
        let (p, q) = (self.triangles[t as usize], self.triangles[u as usize]);
        let (x, y) = (self.corners(t), self.corners(u));
        let own = |k: usize| !q.contains(&p[k]);
        let others = |k: usize| !p.contains(&q[k]);
        match (0..3).filter(|k| own(*k)).count() {
            0 => false,
            1 => {
                let (Some(k), Some(l)) = ((0..3).find(|k| own(*k)), (0..3).find(|k| others(*k))) else {
                    return false;
                };
                let ([a, b, c], tip) = ([x[(k + 1) % 3], x[(k + 2) % 3], x[k]], y[l]);
                if sign::side(&a, &b, &c, &tip) != 0.0 {
                    return true;
                }
                // In one plane, the tips must be on different sides of the edge.
                let turned = |axis| sign::turn(axis, &a, &b, &c) * sign::turn(axis, &a, &b, &tip);
                sign::projection(&a, &b, &c).is_some_and(|axis| turned(axis) < 0.0)
            }
            2 => {
                // Triangles with a common vertex meet elsewhere only if the opposite edge of one
                // does.
                let opposite = |x: &Triangle, is_own: &dyn Fn(usize) -> bool| {
                    let k = (0..3).find(|k| !is_own(*k)).unwrap_or(0);
                    [x[(k + 1) % 3], x[(k + 2) % 3]]
                };
                misses(opposite(&x, &own), &y) && misses(opposite(&y, &others), &x)
            }
            _ => {
                let edges = |x: &Triangle, y: &Triangle| (0..3).all(|k| misses([x[k], x[(k + 1) % 3]], y));
                edges(&x, &y) && edges(&y, &x)
            }
        }
    }
}

/// Returns whether a closed segment certainly misses a closed triangle.
fn misses([a, b]: [Vector3<f64>; 2], t: &Triangle) -> bool {
    let ends = [a.height(t), b.height(t)];
    if ends[0] * ends[1] > 0 {
        return true;
    }
    let sides = |f: &dyn Fn(&Vector3<f64>, &Vector3<f64>) -> f64| {
        [0, 1, 2].each(|k: usize| sign::sign(f(&t[k], &t[(k + 1) % 3])))
    };
    if ends != [0; 2] {
        let turns = sides(&|x, y| sign::side(&a, &b, x, y));
        return turns.contains(&1) && turns.contains(&-1);
    }
    // In one plane a line along an edge or along the segment separates them.
    let Some(axis) = sign::projection(&t[0], &t[1], &t[2]) else {
        return false;
    };
    let forward = sign::sign(sign::turn(axis, &t[0], &t[1], &t[2]));
    let of_a = sides(&|x, y| sign::turn(axis, x, y, &a));
    let of_b = sides(&|x, y| sign::turn(axis, x, y, &b));
    let of_line = sides(&|x, _| sign::turn(axis, &a, &b, x));
    (0..3).any(|k| of_a[k] == -forward && of_b[k] == -forward)
        || of_line.iter().all(|s| *s > 0)
        || of_line.iter().all(|s| *s < 0)
}

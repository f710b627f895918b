//! Where a mesh crosses itself, where its faces cancel, and which of its parts lie in others.

use alloc::vec::Vec;
use core::ops::ControlFlow;
use nalgebra::{Isometry3, Vector3};

use super::Mesh;
use crate::base::notice::{Progress, Watch};
use crate::base::num::sign;
use crate::base::pose::RelativePose;
use crate::composite::meet::bounds::{BoundAim, WIDTH, bounds};
use crate::composite::meet::frame::TreeFrame;
use crate::composite::meet::frame::split_pair;
use crate::composite::parts::Parted;
use crate::composite::tree::Below;

/// What a mesh has that a clean solid does not. Indices are the caller's.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MeshInspection {
    /// Pairs of triangles of which an edge of one passes through the inside of the other: exact.
    /// Triangles that overlap in one plane, or meet at edges, are not counted.
    pub crossings: Vec<[u32; 2]>,
    /// Pairs of triangles that lie on each other in one plane and face opposite ways, up to the
    /// rounding of coordinates: their faces cancel. Between two parts in contact they are inside
    /// the solid. A cavity that goes through a wall, as a window may be written, leaves
    /// a sheet without thickness: the distance to the mesh is that to the sheet, and a body that
    /// crosses the sheet counts as overlapping the mesh.
    #[cfg_attr(feature = "serde", serde(default))]
    pub cancelling: Vec<[u32; 2]>,
    /// Whether all crossings and cancelling faces are named: false if a list was full.
    pub is_complete: bool,
    /// Parts, by their number in [`MeshReport::parts`](super::MeshReport::parts), that lie in other
    /// parts, and the winding number of the others about a vertex of the part: 1 for a part in a
    /// solid, whose points have winding number 2, and for a cavity.
    pub inner_parts: Vec<(u32, i32)>,
}

impl Mesh {
    /// Looks for triangles that cross or cancel and parts in parts, up to `most` pairs of each.
    /// Takes `n log n` time for meshes with few crossings, some ten times that of the build. None
    /// is an error: distances and winding numbers are right for such meshes too.
    #[must_use]
    pub fn inspect(&self, most: usize) -> MeshInspection {
        self.inspect_watched(most, &mut Watch::none())
    }

    /// Looks as [`inspect`](Self::inspect) does, and tells the caller how far it is. A caller who
    /// stops it gets what was found so far, and an inspection that is not complete.
    #[must_use]
    pub fn inspect_with_progress(
        &self,
        most: usize,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> MeshInspection {
        self.inspect_watched(most, &mut Watch::new(progress))
    }

    fn inspect_watched(&self, most: usize, watch: &mut Watch<'_>) -> MeshInspection {
        let mut found = MeshInspection {
            is_complete: true,
            ..MeshInspection::default()
        };
        let pose = RelativePose::from_isometry(&Isometry3::identity());
        if let Some(frame) = pose
            .ok()
            .and_then(|pose| TreeFrame::new(self.side(), self.side(), &pose))
        {
            self.cross(&frame, most, &mut found, watch);
        }
        found.crossings.sort_unstable();
        found.cancelling.sort_unstable();
        if self.is_solid() && watch.stage("parts in parts", None).is_ok() {
            self.nest(&mut found);
        }
        found.is_complete &= watch.check().is_ok();
        found
    }

    fn cross(&self, frame: &TreeFrame, most: usize, found: &mut MeshInspection, watch: &mut Watch<'_>) {
        let (tree, aim) = (&self.tree, BoundAim::to(frame.single.error.next_up()));
        let (mut stack, mut done) = (alloc::vec![[0, 0]], 0);
        found.is_complete = watch.stage("crossings", None).is_ok();
        while found.is_complete && !stack.is_empty() {
            let batch = stack.split_off(stack.len().saturating_sub(WIDTH));
            let gaps = bounds(&frame.single, (tree, tree), &batch, &aim);
            done += batch.len();
            found.is_complete &= watch.done(done);
            for (&[x, y], gap) in batch.iter().zip(gaps.gap) {
                if gap > frame.single.error {
                    continue;
                }
                match (x == y, tree.below(x)) {
                    (true, Below::Children(c)) => stack.extend([[c, c], [c, c + 1], [c + 1, c + 1]]),
                    _ => match split_pair((tree, tree), frame, [x, y]) {
                        Some(two) => stack.extend(two),
                        None => self.cross_leaves([x, y], most, found),
                    },
                }
            }
        }
    }

    fn cross_leaves(&self, nodes: [u32; 2], most: usize, found: &mut MeshInspection) {
        let [(i, m), (j, n)] = nodes.map(|x| self.tree.range(x));
        for t in i..m {
            for u in if nodes[0] == nodes[1] { t + 1 } else { j }..n {
                let (p, q) = (self.corners(t), self.corners(u));
                let list = if passes(&p, &q) || passes(&q, &p) {
                    &mut found.crossings
                } else if self.cancel(&p, &q) {
                    &mut found.cancelling
                } else {
                    continue;
                };
                if list.len() == most {
                    found.is_complete = false;
                    return;
                }
                let names = [t, u].map(|k| self.source_triangles[k as usize]);
                list.push([names[0].min(names[1]), names[0].max(names[1])]);
            }
        }
    }

    /// Winding numbers of the other parts about a vertex of each.
    fn nest(&self, found: &mut MeshInspection) {
        if self.part_vertices.len() < 2 {
            return;
        }
        let labels = self.labels();
        for (part, own_vertices) in (0u32..).zip(&self.part_vertices) {
            let own = labels[own_vertices[0] as usize];
            let is_other = |t: u32| labels[self.triangles[t as usize][0] as usize] != own;
            let winding = self.winding_of(&self.points[own_vertices[0] as usize], is_other);
            if let Some(w) = winding.filter(|w| *w != 0) {
                found.inner_parts.push((part, w));
            }
        }
    }

    /// Returns a number of the part of every vertex.
    pub(super) fn labels(&self) -> Vec<u32> {
        let mut label: Vec<u32> = (0..self.points.len() as u32).collect();
        for t in &self.triangles {
            let [a, b, c] = t.map(|v| super::edges::find(&mut label, v));
            let least = a.min(b).min(c);
            [a, b, c].iter().for_each(|&r| label[r as usize] = least);
        }
        (0..label.len() as u32)
            .map(|v| super::edges::find(&mut label, v))
            .collect()
    }
}

/// Returns whether an edge of one triangle passes through the inside of another: all signs exact.
fn passes(x: &[Vector3<f64>; 3], [a, b, c]: &[Vector3<f64>; 3]) -> bool {
    let heights = [0, 1, 2].map(|i| sign::side(a, b, c, &x[i]));
    (0..3).any(|i| {
        let (from, to) = (&x[i], &x[(i + 1) % 3]);
        if !(heights[i] < 0.0 && heights[(i + 1) % 3] > 0.0 || heights[i] > 0.0 && heights[(i + 1) % 3] < 0.0) {
            return false;
        }
        let turns = [
            sign::side(from, to, a, b),
            sign::side(from, to, b, c),
            sign::side(from, to, c, a),
        ];
        turns.iter().all(|t| *t > 0.0) || turns.iter().all(|t| *t < 0.0)
    })
}

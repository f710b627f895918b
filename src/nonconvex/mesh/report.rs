//! Errors of a mesh, the report of a build, and the inspection of a mesh.
//!
//! The report lists what the build kept, dropped and found. The inspection finds where a mesh
//! crosses itself, where its faces cancel, and which components lie in others.
//!
//! Two faces cancel if they lie on each other in one plane and face opposite directions:
//!
//! ```text
//!     wall            ----->-----+----->-----      outer face
//!     window (cavity)   --<--    |                 its end, in the same plane
//! ```

use alloc::boxed::Box;
use alloc::vec::Vec;
use core::fmt;
use nalgebra::{Isometry3, Vector3};

use super::{Mesh, MeshRepair};
use crate::base::callbacks::{Stopped, Watch, WithProgress};
use crate::base::num::each::Each;
use crate::base::num::scalar::sqrt;
use crate::base::num::sign;
use crate::base::num::sort::sort;
use crate::base::pose::RelativePose;
use crate::base::tolerance::ONE_PLANE;
use crate::nonconvex::parts::Parted;
use crate::nonconvex::query::box_gaps::{BoundAim, WIDTH, bounds};
use crate::nonconvex::query::frame::{TreeFrame, split_pair};
use crate::nonconvex::query::triangle::{self, Triangle};
use crate::nonconvex::tree::Below;

/// Error returned if points and triangles do not form a valid mesh.
///
/// Indices are the caller's; lengths are in the caller's unit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A coordinate is infinite or not a number.
    #[error("point {index} has a coordinate that is not finite")]
    NotFinite {
        /// The first such point.
        index: usize,
    },
    /// A triangle names a point that does not exist.
    #[error("triangle {triangle} has a point that does not exist: {index}")]
    IndexOutOfRange {
        /// Index of the triangle.
        triangle: usize,
        /// Index of the missing point.
        index: usize,
    },
    /// More points or triangles than ids of 27 bits can name.
    #[error("too many points or triangles for 32-bit ids: {count}")]
    TooMany {
        /// Number of points or triangles given.
        count: usize,
    },
    /// No triangle is left: none was given, or all are degenerate.
    #[error("the mesh is empty: none of {given} triangles has an area")]
    Empty {
        /// Number of triangles given.
        given: usize,
    },
    /// The longest side of the bounding box is below 1e-100 or above 1e100, or a coordinate is
    /// above 1e116.
    #[error("extent of the mesh is out of range: {extent:e} (expected 1e-100..=1e100, and coordinates up to 1e116)")]
    OutOfRange {
        /// The longest side of the bounding box.
        extent: f64,
    },
    /// A piece of a compound is rounded or curved, so that it has no triangles.
    #[error("piece {piece} is rounded or curved")]
    Curved {
        /// Index of the piece.
        piece: usize,
    },
    /// The pieces of a decomposition cannot grow by a radius.
    ///
    /// Returned by [`Decomposition::grown`](crate::Decomposition::grown).
    #[error("radius by which pieces grow is out of range: {radius:e} (expected 1e-100..=1e100)")]
    Growth {
        /// The radius.
        radius: f64,
    },
    /// The tolerance of a weld is negative, not a number, or larger than a sixteenth of the extent.
    ///
    /// Returned by [`Mesh::repaired`](super::Mesh::repaired).
    #[error("tolerance of the weld is out of range: {tolerance:e} (expected 0, or up to a sixteenth of {extent:e})")]
    Weld {
        /// The tolerance.
        tolerance: f64,
        /// The longest side of the bounding box.
        extent: f64,
    },
    /// A piece of a compound is a point, a segment, or too thin.
    ///
    /// Too thin means that triangles of its faces have no area at the pose of the piece.
    #[error("piece {piece} is a point, a segment, or too thin to have triangles")]
    Thin {
        /// Index of the piece.
        piece: usize,
    },
    /// A height field has fewer than two rows or columns, or another number of heights.
    #[error(
        "{count} heights for {rows} rows and {columns} columns (expected rows times columns, at least two of each)"
    )]
    HeightCount {
        /// Number of rows.
        rows: usize,
        /// Number of columns.
        columns: usize,
        /// Number of heights given.
        count: usize,
    },
    /// The spacing of a height field is not positive and finite.
    #[error("spacing of the heights along axis {axis} is {value} (expected a positive finite number)")]
    Spacing {
        /// 0 for x, 1 for y.
        axis: usize,
        /// The spacing.
        value: f64,
    },
    /// The base of a height field is not finite.
    #[error("base of the heights is {value} (expected a finite number)")]
    Base {
        /// The base.
        value: f64,
    },
    /// A height is not finite, or not above the base.
    #[error("height {index} is {value} (expected a finite number above the base)")]
    Height {
        /// The first such height, counted row by row.
        index: usize,
        /// The height.
        value: f64,
    },
    /// The data of a stored mesh are not consistent.
    #[error("the stored mesh is damaged: {what}")]
    Damaged {
        /// The data that are not consistent.
        what: &'static str,
    },
    /// The caller's progress callback has stopped the call.
    #[error("the caller has stopped the build")]
    Stopped,
}

impl From<Stopped> for MeshError {
    fn from(_: Stopped) -> Self {
        Self::Stopped
    }
}

/// Error returned if the vertices of a mesh cannot be replaced.
///
/// Indices of vertices are those of [`Mesh::vertices`](super::Mesh::vertices); lengths are in the
/// caller's unit.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VertexError {
    /// The number of vertices differs from that of the mesh.
    #[error("number of vertices differs from the mesh: {given} (expected {count})")]
    Count {
        /// Number of vertices given.
        given: usize,
        /// Number of vertices of the mesh, without welded points and points that no triangle uses.
        count: usize,
    },
    /// A vertex does not exist.
    #[error("vertex {index} does not exist (expected 0..{count})")]
    Missing {
        /// The first such vertex.
        index: usize,
        /// Number of vertices of the mesh.
        count: usize,
    },
    /// A coordinate is infinite or not a number.
    #[error("vertex {index} has a coordinate that is not finite")]
    NotFinite {
        /// The first such vertex.
        index: usize,
    },
    /// The longest side of the bounding box would be below 1e-100 or above 1e100, or a coordinate
    /// above 1e116.
    #[error("extent of the mesh is out of range: {extent:e} (expected 1e-100..=1e100, and coordinates up to 1e116)")]
    OutOfRange {
        /// The longest side of the bounding box, or the coordinate.
        extent: f64,
    },
    /// The build dropped a triangle whose vertices were collinear: it might have an area now.
    #[error("triangle {triangle} is not in the mesh: its vertices were collinear when the mesh was built")]
    Dropped {
        /// The first such triangle, by the caller's index.
        triangle: u32,
    },
    /// The mesh is closed only by edges that lie on others along a line: it might open there.
    #[error("vertices cannot be replaced: the mesh is closed only by T-junctions (one edge against two shorter ones)")]
    ClosedAlongLines,
}

/// Whether a mesh bounds a volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum MeshKind {
    /// Closed: along every line, edges in one direction cancel edges in the other.
    ///
    /// One edge may cancel two shorter ones. Points with non-zero winding number are inside and
    /// belong to the body, and so does the surface. The triangles may face inward.
    ///
    /// **Sheets.** Two faces that lie on each other and face opposite directions are a sheet
    /// without thickness, unless the body is on both sides. A sheet has no inside, but it is a part
    /// of the body: distances are measured to it, and a body that crosses it overlaps the mesh. The
    /// overlap lasts until a translation has taken that body out of the sheet, which the bounds of
    /// a [penetration](crate::PairTracker::penetration) include in `upper`, but not in `lower`.
    /// [`Mesh::inspect`](super::Mesh::inspect) finds sheets.
    Solid,
    /// Not closed: the body consists of the triangles alone and has no inside.
    Open,
}

impl fmt::Display for MeshKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Solid => "solid",
            Self::Open => "open",
        })
    }
}

/// A connected component of a mesh: triangles that share vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MeshPart {
    /// One triangle of the component, by the caller's index.
    pub triangle: u32,
    /// Number of triangles.
    pub triangles: u32,
    /// Signed volume in the caller's unit cubed, if the mesh is a solid.
    ///
    /// It is negative if the triangles are clockwise seen from outside, as those of a cavity are.
    pub volume: f64,
}

/// What the build of a mesh kept, dropped and found. Indices are the caller's.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MeshReport {
    /// Whether the mesh is closed.
    pub kind: MeshKind,
    /// Number of points given.
    pub input_points: usize,
    /// Number of triangles given.
    pub input_triangles: usize,
    /// Number of vertices of the mesh.
    pub vertices: usize,
    /// Number of triangles of the mesh.
    pub triangles: usize,
    /// Number of points that were welded to an earlier point with the same coordinates.
    pub welded: usize,
    /// Number of points that no kept triangle uses.
    pub unused: usize,
    /// Triangles that were dropped because their vertices are collinear or equal.
    ///
    /// With them the mesh would be of the same kind, because they cannot close it.
    pub degenerate: Vec<u32>,
    /// Pairs `(dropped, kept)` of triangles with the same vertices in the same orientation.
    ///
    /// None is dropped if the mesh is closed only with all of them.
    pub repeated: Vec<(u32, u32)>,
    /// Edges of one triangle. In a solid, each lies on other edges along the same line.
    pub boundary_edges: Vec<[u32; 2]>,
    /// Edges of more than two triangles.
    pub non_manifold_edges: Vec<[u32; 2]>,
    /// Edges of two triangles that run along them in the same direction: one faces the wrong side.
    ///
    /// [`Mesh::repaired`](super::Mesh::repaired) corrects them.
    pub misoriented_edges: Vec<[u32; 2]>,
    /// Connected components, in the order of their first triangle.
    pub parts: Vec<MeshPart>,
    /// Number of coordinates that were replaced by zero.
    ///
    /// They were below `2^-200` of the extent, where exact predicates would go out of range.
    pub flushed_coordinates: usize,
    /// What [`Mesh::repaired`](super::Mesh::repaired) has changed before the build; `None` if the
    /// mesh was built as given. All other fields are about the repaired mesh.
    #[cfg_attr(feature = "serde", serde(default))]
    pub repair: Option<Box<MeshRepair>>,
}

impl fmt::Display for MeshReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} of {} vertices and {} triangles in ",
            self.kind, self.vertices, self.triangles
        )?;
        write_count(f, self.parts.len(), ["part", "parts"])?;
        let inward = self.parts.iter().filter(|p| p.volume < 0.0).count();
        let found = [
            (self.welded, ["point welded", "points welded"]),
            (self.unused, ["point unused", "points unused"]),
            (
                self.degenerate.len(),
                ["degenerate triangle dropped", "degenerate triangles dropped"],
            ),
            (
                self.repeated.len(),
                ["repeated triangle dropped", "repeated triangles dropped"],
            ),
            (self.boundary_edges.len(), ["boundary edge", "boundary edges"]),
            (
                self.non_manifold_edges.len(),
                ["non-manifold edge", "non-manifold edges"],
            ),
            (
                self.misoriented_edges.len(),
                ["edge of a triangle turned over", "edges of triangles turned over"],
            ),
            (
                self.flushed_coordinates,
                ["coordinate flushed to zero", "coordinates flushed to zero"],
            ),
            (inward, ["part facing inward", "parts facing inward"]),
        ];
        for (count, nouns) in found.into_iter().filter(|x| x.0 > 0) {
            f.write_str(", ")?;
            write_count(f, count, nouns)?;
        }
        match &self.repair {
            Some(repair) => write!(f, "; repaired: {repair}"),
            None => Ok(()),
        }
    }
}

/// Writes a number with the singular or the plural of a noun.
pub(super) fn write_count(f: &mut fmt::Formatter<'_>, count: usize, [one, many]: [&str; 2]) -> fmt::Result {
    write!(f, "{count} {}", if count == 1 { one } else { many })
}

/// Defects of a mesh that a clean solid does not have. Indices are the caller's.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MeshInspection {
    /// Pairs of triangles where an edge of one passes through the interior of the other.
    ///
    /// The test is exact. Triangles that overlap in one plane or meet at edges are not counted.
    pub crossings: Vec<[u32; 2]>,
    /// Pairs of triangles that lie on each other in one plane and face opposite directions.
    ///
    /// Their faces cancel, up to the rounding of coordinates. Between two components in contact
    /// such faces are inside the solid. A cavity that passes through a wall (a window modelled this
    /// way) leaves a sheet without thickness. The distance to the mesh then includes the distance
    /// to the sheet, and a body that crosses the sheet counts as overlapping the mesh.
    #[cfg_attr(feature = "serde", serde(default))]
    pub cancelling: Vec<[u32; 2]>,
    /// Whether all crossings and cancelling faces are listed; false if a list was full.
    pub is_complete: bool,
    /// Components that lie in other components, with a winding number.
    ///
    /// The first number is the index in [`MeshReport::parts`](super::MeshReport::parts). The second
    /// is the winding number of the other components about a vertex of this one. It is 1 for a
    /// cavity, and for a component in a solid, whose points have winding number 2.
    pub inner_parts: Vec<(u32, i32)>,
}

impl WithProgress<'_> {
    /// Inspects a mesh as [`Mesh::inspect`] does.
    ///
    /// If the callback stops the call, the result has what was found until then, and `is_complete`
    /// is false.
    #[must_use]
    pub fn inspect(mut self, mesh: &Mesh, most: usize) -> MeshInspection {
        mesh.inspect_watched(most, &mut self.watch)
    }
}

impl Mesh {
    /// Finds triangles that cross or cancel, and components inside others.
    ///
    /// Lists at most `most` pairs of each. The call takes `O(n log n)` time for meshes with few
    /// crossings, about ten times as long as the build. None of these defects is an error:
    /// distances and winding numbers are correct for such meshes too.
    #[must_use]
    pub fn inspect(&self, most: usize) -> MeshInspection {
        self.inspect_watched(most, &mut Watch::none())
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
        sort(&mut found.crossings, Ord::cmp);
        sort(&mut found.cancelling, Ord::cmp);
        if self.is_solid() && watch.stage("parts in parts", None).is_ok() {
            self.nest(&mut found);
        }
        found.is_complete &= watch.check().is_ok();
        found
    }

    fn cross(&self, frame: &TreeFrame, most: usize, found: &mut MeshInspection, watch: &mut Watch<'_>) {
        found.is_complete = watch.stage("crossings", None).is_ok()
            && self.join_leaves(frame, watch, |nodes| {
                self.cross_leaves(nodes, most, found);
                found.is_complete
            });
    }

    /// Calls `leaves` with all pairs of leaves whose boxes may meet, each leaf with itself
    /// included, until a call returns false.
    ///
    /// Returns false if a call did, or if the caller stopped the watch.
    pub(crate) fn join_leaves(
        &self,
        frame: &TreeFrame,
        watch: &mut Watch<'_>,
        mut leaves: impl FnMut([u32; 2]) -> bool,
    ) -> bool {
        let (tree, aim) = (&self.tree, BoundAim::to(frame.single.error.next_up()));
        let (mut stack, mut done) = (alloc::vec![[0, 0]], 0);
        while !stack.is_empty() {
            let batch = stack.split_off(stack.len().saturating_sub(WIDTH));
            let gaps = bounds(&frame.single, [tree; 2], &batch, &aim);
            done += batch.len();
            if !watch.done(done) {
                return false;
            }
            for (&[x, y], gap) in batch.iter().zip(gaps.gap) {
                if gap > frame.single.error {
                    continue;
                }
                match (x == y, tree.below(x)) {
                    (true, Below::Children(c)) => stack.extend([[c, c], [c, c + 1], [c + 1, c + 1]]),
                    _ => match split_pair([tree; 2], frame, [x, y]) {
                        Some(two) => stack.extend(two),
                        None if !leaves([x, y]) => return false,
                        None => {}
                    },
                }
            }
        }
        true
    }

    fn cross_leaves(&self, nodes: [u32; 2], most: usize, found: &mut MeshInspection) {
        let [of_a, of_b] = nodes.each(|x| self.tree.range(x));
        for t in of_a {
            for u in if nodes[0] == nodes[1] { t + 1 } else { of_b.start }..of_b.end {
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
                let names = [t, u].each(|k| self.source_triangles[k as usize]);
                list.push([names[0].min(names[1]), names[0].max(names[1])]);
            }
        }
    }

    /// Finds the winding number of the other components about a vertex of each component.
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

    /// Returns the index of the component of every vertex.
    fn labels(&self) -> Vec<u32> {
        let mut label: Vec<u32> = (0..self.points.len() as u32).collect();
        for t in &self.triangles {
            let [a, b, c] = t.each(|v| super::edges::find(&mut label, v));
            let least = a.min(b).min(c);
            [a, b, c].iter().for_each(|&r| label[r as usize] = least);
        }
        (0..label.len() as u32)
            .map(|v| super::edges::find(&mut label, v))
            .collect()
    }
}

/// Returns whether an edge of one triangle passes through the interior of another; all signs are
/// exact.
fn passes(x: &[Vector3<f64>; 3], [a, b, c]: &[Vector3<f64>; 3]) -> bool {
    let heights = [0, 1, 2].each(|i| sign::side(a, b, c, &x[i]));
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

impl Mesh {
    /// Returns whether two triangles cancel over an area, up to the rounding of coordinates.
    fn cancel(&self, p: &Triangle, q: &Triangle) -> bool {
        let (m, n) = (triangle::normal(p), triangle::normal(q));
        if !(m.dot(&n) < 0.0) {
            return false;
        }
        // The plane of the larger triangle is more accurate.
        let (large, normal, small) = if m.norm_squared() < n.norm_squared() {
            (q, n, p)
        } else {
            (p, m, q)
        };
        let (doubt, length) = (ONE_PLANE * self.radius, sqrt(normal.norm_squared()));
        let is_off = |x: &Vector3<f64>| !(normal.dot(&(x - large[0])).abs() <= doubt * length);
        if small.iter().any(is_off) {
            return false;
        }
        let is_beside = |x: &Triangle, y: &Triangle, out: f64| {
            (0..3).any(|i| {
                let side = (x[(i + 1) % 3] - x[i]).cross(&normal) * out;
                let length = sqrt(side.norm_squared());
                y.iter().all(|v| side.dot(&(v - x[i])) >= -doubt * length)
            })
        };
        !(is_beside(large, small, 1.0) || is_beside(small, large, -1.0))
    }
}

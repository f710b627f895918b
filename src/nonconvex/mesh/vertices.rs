//! Vertices of a mesh and their replacement: deforming meshes.
//!
//! A replacement keeps the triangles, their order in the tree, and whether the mesh is closed. It
//! changes points, boxes, the bounding box and the fingerprint. The fingerprint covers the whole
//! history, because the boxes of a node depend on the history. A tracker finds its own state among
//! the last states of the mesh, and the paths of the nodes bound how far the points have moved
//! since then.

use alloc::boxed::Box;
use alloc::vec::Vec;
use nalgebra::{Point3, Vector3};

use super::build::InTreeOrder;
use super::build::Units;
use super::{Mesh, VertexError};
use crate::base::callbacks::Watch;
use crate::base::num::double_double::two_sum;
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes, largest};
use crate::base::num::fingerprint::{Fingerprint, Fingerprinter};
use crate::base::num::scalar::sqrt;
use crate::base::num::sort::sort_by_key;
use crate::base::tolerance::{EXTENT_MAX, EXTENT_MIN, PLACE_MAX, UNIT};
use crate::body::polyhedron::{bounding_box, power_of_two};
use crate::nonconvex::tree::{Paths, Refit};

/// Number of past states that a mesh keeps, so that trackers recognise it.
///
/// A tracker that has missed more replacements starts again.
const STATES: usize = 16;

/// Size, in units of the tree, beyond which a tree gets another origin and unit.
///
/// This happens if a vertex is farther than `GROWN` from the origin along an axis, or if half the
/// diagonal of the box is shorter than `SHRUNK`. When a tree is made, its half diagonal is between
/// one and two. At most two bits of single precision are lost.
const GROWN: f64 = 4.0;
const SHRUNK: f64 = 0.5;

/// Growth of the number of boxes with points of the surface that causes a rebuild.
///
/// The count is compared with that when the tree was made; the upper part is then built again.
/// Bounds per query without and with such rebuilds:
///
/// | deformation | without | with | whole new tree |
/// |---|---:|---:|---:|
/// | sheets of 20,000 triangles, rolled up three times in 100 frames | 3,670 | 2,790 | 1,570 |
/// | the same, folded three times, while they fold | 2,080 | 1,630 | 1,060 |
/// | tori, twisted by half a turn | 3,670 | 3,070 | 2,050 |
///
/// Crumpled sheets gain nothing and lose up to 20 %.
const LOOSE: f64 = 1.25;

/// Length of path, in units of the tree, after which boxes are counted again.
///
/// The path is the sum of the longest moves of a vertex since the last count. A count takes a tenth
/// of the time of a refit of 100,000 triangles.
const COUNT_PATH: f64 = 1.0 / 16.0;

/// Minimum number of replacements of all vertices between two rebuilds of the upper part.
///
/// A rebuild takes about as long as ten replacements.
const REBUILD_WORK: usize = 16;

/// Reason why vertices of a mesh cannot be replaced: its triangles would not be the same body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Stiff {
    /// A triangle was dropped because its vertices were collinear; it might have an area now.
    Dropped { triangle: u32 },
    /// The mesh is closed by edges that lie on others along a line; these might separate.
    ClosedAlongLines,
}

/// Data that a mesh keeps once its vertices have been replaced.
#[derive(Clone, Debug)]
pub(super) struct Bending {
    /// The stored vertex of each index.
    order: Vec<u32>,
    /// The vertices as built, by index.
    pub(super) built: Vec<Point3<f64>>,
    refit: Refit,
    /// Number of boxes that contained points of the surface when the tree was made.
    held: u64,
    /// Path of the tree after which boxes are counted again.
    tight_until: u64,
    /// Number of vertices given since the tree was made.
    given: usize,
    /// Fingerprint of the mesh as built.
    lineage: Fingerprint,
    /// Fingerprints of the mesh before its last replacements.
    past: [Fingerprint; STATES],
    replacements: usize,
    /// Buffers: the next points, and how far each vertex moves.
    next: Vec<Vector3<f64>>,
    steps: Vec<u32>,
}

/// Returns the stored vertices by index, given the caller's index of each.
pub(super) fn by_source(sources: &[u32]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..sources.len() as u32).collect();
    sort_by_key(&mut order, |&k| sources[k as usize]);
    order
}

impl Bending {
    fn new(mesh: &Mesh) -> Self {
        let order = by_source(&mesh.source_points);
        Self {
            built: order.iter().map(|&v| mesh.given(&mesh.points[v as usize])).collect(),
            order,
            refit: Refit::new(&mesh.tree, &mesh.points, &mesh.triangles),
            held: mesh.tree.held(&mesh.points, &mesh.triangles),
            tight_until: Paths::units(COUNT_PATH).map_or(0, u64::from),
            given: 0,
            lineage: mesh.fingerprint,
            past: [mesh.fingerprint; STATES],
            replacements: 0,
            next: Vec::new(),
            steps: Vec::new(),
        }
    }

    /// Returns the fingerprint of a mesh after some of its vertices are replaced.
    fn fingerprint(before: Fingerprint, first: usize, vertices: &[Point3<f64>]) -> Fingerprint {
        let mut all = Fingerprinter::new(*b"vertices");
        all.fingerprint(before);
        all.word(first as u64);
        all.word(vertices.len() as u64);
        vertices.iter().for_each(|p| all.vector(&p.coords));
        all.end()
    }
}

impl Mesh {
    /// Returns the vertices in the order of their indices.
    ///
    /// This is the order of the points from which the mesh was built, without points that were
    /// welded to an earlier one and points that no triangle uses. If there were no such points, the
    /// indices are the caller's.
    #[must_use]
    pub fn vertices(&self) -> Vec<Point3<f64>> {
        let order = by_source(&self.source_points);
        order.iter().map(|&v| self.given(&self.points[v as usize])).collect()
    }

    /// Returns the caller's index of every vertex, in the order of [`vertices`](Self::vertices).
    ///
    /// Of equal points it is the lowest index.
    #[must_use]
    pub fn vertex_sources(&self) -> Vec<u32> {
        let mut sources = self.source_points.clone();
        sources.sort_unstable();
        sources
    }

    /// Returns the vertices of every triangle as indices into [`vertices`](Self::vertices).
    ///
    /// The triangles are in the caller's order, without those that the [report](Self::report) lists
    /// as dropped.
    #[must_use]
    pub fn triangle_vertices(&self) -> Vec<[u32; 3]> {
        let mut numbers = alloc::vec![0; self.points.len()];
        for (number, v) in (0..).zip(by_source(&self.source_points)) {
            numbers[v as usize] = number;
        }
        let order = by_source(&self.source_triangles);
        let corners = |t: u32| self.triangles[t as usize].each(|v| numbers[v as usize]);
        order.into_iter().map(corners).collect()
    }

    /// Replaces all vertices, in the order of [`vertices`](Self::vertices): the mesh deforms.
    ///
    /// - **Kept**: the triangles and the [`kind`](Self::kind). A closed mesh remains closed
    ///   wherever its vertices move, and points with non-zero winding number are inside. Welded
    ///   points remain one vertex. The [report](Self::report) remains that of the build.
    /// - **Degenerate triangles**: vertices may become equal, and triangles may lose their area.
    ///   Queries then measure the remaining segment or point.
    /// - **Results** equal those of a new mesh with these vertices. Trackers of the mesh continue
    ///   with their state, even if they have missed the last few replacements.
    ///
    /// The tree is refitted to the vertices. Its upper part is built again, over groups of up to 64
    /// triangles, once the tree has become loose: 25 % more of its boxes contain points of the
    /// surface than when it was made (for example, a sheet is rolled up). Boxes are counted
    /// whenever the vertices have moved by a few hundredths of the size of the mesh, but not before
    /// all vertices have been replaced 16 times since the last tree was made. Calls that move no
    /// vertex do not count. So an occasional call takes about ten times as long and makes trackers
    /// start cold. When this happens depends on the vertices alone, not on queries.
    ///
    /// Flush contacts of large flat areas take longer until [`rebuild`](Self::rebuild) makes a new
    /// tree. If a mesh has moved, grown or shrunk by more than twice its size, trackers start cold.
    /// The first call creates the data that later calls need.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny::{Mesh, PairTracker, RelativePose};
    ///
    /// let mut ball = Mesh::from_convex(&solids::icosahedron(1.0)?)?;
    /// let floor = solids::cuboid(Vector3::new(4.0, 4.0, 1.0))?;
    /// let at = Isometry3::translation(0.0, 0.0, -3.0);
    /// let pose = RelativePose::from_isometry(&at)?;
    /// let rest = ball.vertices();
    /// let lowest = rest.iter().fold(0.0, |z: f64, p| z.min(p.z));
    /// let mut tracker = PairTracker::new();
    /// for frame in 1..10 {
    ///     let long = 1.0 + 0.1 * f64::from(frame);
    ///     let now: Vec<_> = rest
    ///         .iter()
    ///         .map(|p| Point3::new(p.x, p.y, p.z * long))
    ///         .collect();
    ///     ball.set_vertices(&now)?;
    ///     let found = tracker.closest(&ball, &floor, &pose);
    ///     assert!((found.distance - (2.0 + lowest * long)).abs() < 1e-14);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Returns an error, and leaves the mesh unchanged, in these cases:
    ///
    /// - The number of vertices differs from that of the mesh.
    /// - A coordinate is not finite, or a coordinate or the extent is out of the range of meshes.
    /// - The build dropped a triangle whose three vertices were collinear.
    /// - The mesh is closed only along lines.
    #[doc(alias = "deform")]
    #[doc(alias = "refit")]
    pub fn set_vertices(&mut self, vertices: &[Point3<f64>]) -> Result<(), VertexError> {
        self.move_all(vertices).map(|_| ())
    }

    /// Replaces the vertices from index `first` on, like [`set_vertices`](Self::set_vertices).
    ///
    /// Only the boxes around these vertices are refitted.
    ///
    /// # Errors
    ///
    /// Returns the errors of [`set_vertices`](Self::set_vertices). Instead of a wrong number of
    /// vertices, it reports a vertex that does not exist.
    pub fn set_vertices_from(&mut self, first: usize, vertices: &[Point3<f64>]) -> Result<(), VertexError> {
        self.move_vertices(first, vertices).map(|_| ())
    }

    /// Replaces all vertices and returns an upper bound of how far any point of the mesh moved.
    ///
    /// The bound is in the caller's unit.
    pub(crate) fn move_all(&mut self, vertices: &[Point3<f64>]) -> Result<f64, VertexError> {
        let (given, count) = (vertices.len(), self.vertex_count());
        if given != count {
            return Err(VertexError::Count { given, count });
        }
        self.move_vertices(0, vertices)
    }

    fn move_vertices(&mut self, first: usize, vertices: &[Point3<f64>]) -> Result<f64, VertexError> {
        let count = self.vertex_count();
        if first.checked_add(vertices.len()).is_none_or(|end| end > count) {
            return Err(VertexError::Missing {
                index: first.max(count),
                count,
            });
        }
        if let Some(k) = vertices.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
            return Err(VertexError::NotFinite { index: first + k });
        }
        match self.stiff {
            Some(Stiff::Dropped { triangle }) => return Err(VertexError::Dropped { triangle }),
            Some(Stiff::ClosedAlongLines) => return Err(VertexError::ClosedAlongLines),
            None => {}
        }
        let mut bending = self.take_bending();
        let before = self.fingerprint;
        let result = self.replace(&mut bending, first, vertices);
        // Calls that do not change the fingerprint change nothing else either.
        let is_loose = self.fingerprint != before && {
            bending.given = bending.given.saturating_add(vertices.len());
            self.is_loose(&mut bending)
        };
        self.bending = Some(bending);
        if is_loose {
            let new = InTreeOrder::with_new_top(&self.tree, &self.points, &self.triangles);
            self.take_tree(*b"new top ", new);
        }
        result
    }

    /// Takes the data for replacements out of the mesh; the first call creates them.
    fn take_bending(&mut self) -> Box<Bending> {
        self.bending.take().unwrap_or_else(|| {
            Box::new(Bending {
                // The tree of the build may be rebuilt at once.
                given: REBUILD_WORK * self.vertex_count(),
                ..Bending::new(self)
            })
        })
    }

    /// Returns the mesh in its own tree with the vertices of an earlier state.
    ///
    /// Returns `None` if the triangles are not the same.
    pub(crate) fn as_before(&self, earlier: &Self) -> Option<Self> {
        let is_same = self.stiff.is_none()
            && self.vertex_sources() == earlier.vertex_sources()
            && self.triangle_vertices() == earlier.triangle_vertices();
        if !is_same {
            return None;
        }
        let mut before = self.clone();
        let mut bending = before.take_bending();
        before.replace(&mut bending, 0, &earlier.vertices()).ok()?;
        before.bending = Some(bending);
        Some(before)
    }

    /// Returns whether the tree has become loose.
    ///
    /// Boxes are counted only if vertices have moved far since the last count and the tree has been
    /// in use for some time.
    fn is_loose(&self, bending: &mut Bending) -> bool {
        let is_early = bending.given < REBUILD_WORK * self.vertex_count();
        if is_early || self.tree.paths.total < bending.tight_until {
            return false;
        }
        bending.tight_until = self.tree.paths.total + Paths::units(COUNT_PATH).map_or(0, u64::from);
        self.tree.held(&self.points, &self.triangles) as f64 > LOOSE * bending.held as f64
    }

    /// Builds the whole tree again for vertices that were replaced.
    ///
    /// The call takes as long as a build, and trackers start cold after it. It does nothing if
    /// vertices were never replaced.
    ///
    /// [`set_vertices`](Self::set_vertices) rebuilds the upper part once it is loose. A whole new
    /// tree pays in two cases: if the mesh keeps nearly the same shape for many queries, and for
    /// flush contacts of large flat areas. If the mesh continues to deform, the tree of the build
    /// may be better. Triangles that are near each other on the surface stay near each other;
    /// triangles of layers that slide on each other do not.
    pub fn rebuild(&mut self) {
        if self.bending.is_none() {
            return;
        }
        // A build without a progress callback is never stopped.
        let Ok(new) = InTreeOrder::new(&self.points, &self.triangles, &mut Watch::none()) else {
            return;
        };
        self.take_tree(*b"new tree", new);
    }

    /// Takes another tree over the same triangles at their current positions.
    ///
    /// `kind` names the method by which the tree was made. No state of a tracker is recognised
    /// after this.
    pub(super) fn take_tree(&mut self, kind: [u8; 8], new: InTreeOrder) {
        let Some(bending) = self.bending.take() else { return };
        self.fingerprint = self.fingerprint_in(kind, &new);
        self.source_triangles = new.sources(&self.source_triangles);
        self.source_points = new.source.iter().map(|&v| self.source_points[v as usize]).collect();
        let vertices = self.part_vertices.iter_mut().flatten();
        vertices.for_each(|v| *v = new.number[*v as usize]);
        (self.tree, self.points, self.triangles) = (new.tree, new.points, new.triangles);
        let Bending { built, lineage, .. } = *bending;
        self.bending = Some(Box::new(Bending {
            built,
            lineage,
            ..Bending::new(self)
        }));
    }

    /// Returns the fingerprint of the mesh as built, which is the same for all positions of its
    /// vertices.
    pub(crate) fn lineage(&self) -> Fingerprint {
        self.bending.as_ref().map_or(self.fingerprint, |b| b.lineage)
    }

    /// Returns whether a fingerprint is one of the last few of this mesh.
    ///
    /// If so, the paths of its tree bound how far its points have moved since then.
    pub(crate) fn came_from(&self, earlier: Fingerprint) -> bool {
        self.bending.as_ref().is_some_and(|b| b.past.contains(&earlier))
    }

    /// Takes vertices that exist and are finite.
    fn replace(&mut self, bending: &mut Bending, first: usize, vertices: &[Point3<f64>]) -> Result<f64, VertexError> {
        let lost = self.place(bending, first, vertices)?;
        let moves = self.moves(bending);
        let extent = largest(&(moves.high - moves.low)) * self.unit();
        if !(EXTENT_MIN..=EXTENT_MAX).contains(&extent) {
            return Err(VertexError::OutOfRange { extent });
        }
        let units = Units::of(&((moves.high - moves.low) * self.unit()));
        let is_near = lost == 0.0 && self.is_near(&moves) && units.exponent == self.frame.exponent;
        if is_near && moves.longest == 0 {
            return Ok(0.0);
        }
        let moved = sqrt(moves.square) * (1.0 + 8.0 * UNIT) * self.unit() + 2.0 * lost;
        let before = self.fingerprint;
        self.fingerprint = Bending::fingerprint(before, first, vertices);
        if !is_near {
            self.move_frame(bending, first, vertices, &units);
        }
        self.take_points(bending, &units);
        if is_near {
            bending.past[bending.replacements % STATES] = before;
            bending.replacements += 1;
        } else {
            bending.past.fill(self.fingerprint);
            bending.steps.fill(1);
            self.tree.centre_on(&self.low, &self.high);
            bending.tight_until = 0;
        }
        self.tree
            .refit(&mut bending.refit, &self.points, &self.triangles, &bending.steps);
        Ok(moved)
    }

    /// Sets the next points, and returns the largest rounding error of a stored coordinate, in the
    /// caller's unit.
    fn place(&self, bending: &mut Bending, first: usize, vertices: &[Point3<f64>]) -> Result<f64, VertexError> {
        let replaced = &bending.order[first..first + vertices.len()];
        let (next, stored) = (&mut bending.next, power_of_two(-self.frame.exponent));
        let (origin, mut lost) = (self.frame.origin, 0.0f64);
        if vertices.len() < self.points.len() || next.len() < self.points.len() {
            next.clone_from(&self.points);
        }
        for (&v, p) in replaced.iter().zip(vertices) {
            if p.coords.amax() > PLACE_MAX {
                return Err(VertexError::OutOfRange {
                    extent: p.coords.amax(),
                });
            }
            let place = p.coords - origin;
            if !self.frame.is_at_origin() {
                lost = (0..3).fold(lost, |lost, k| lost.larger(two_sum(p[k], -origin[k]).1.abs()));
            }
            next[v as usize] = place * stored;
        }
        Ok(lost)
    }

    /// Chooses the frame of stored coordinates again, and sets the next points in that frame.
    fn move_frame(&mut self, bending: &mut Bending, first: usize, vertices: &[Point3<f64>], units: &Units) {
        let mut given: Vec<Point3<f64>> = self.points.iter().map(|p| self.given(p)).collect();
        for (&v, p) in bending.order[first..].iter().zip(vertices) {
            given[v as usize] = *p;
        }
        let all = || given.iter().map(|p| &p.coords);
        let (low, high) = bounding_box(all());
        self.frame = units.frame(&low, &high, all());
        bending.next.clear();
        bending.next.extend(given.iter().map(|p| self.frame.stored(p)));
    }

    /// Computes how far each vertex moves to its next position.
    fn moves(&self, bending: &mut Bending) -> Moves {
        let scale = 1.0 / self.tree.unit();
        let start = Vector3::repeat(f64::INFINITY);
        let mut moves = Moves {
            low: start,
            high: -start,
            square: 0.0,
            longest: 0,
        };
        bending.steps.resize(self.points.len(), 0);
        for ((p, q), step) in self.points.iter().zip(&bending.next).zip(&mut bending.steps) {
            let square = (q - p).norm_squared();
            // A step that is too long counts as longer than all others, and its value is not used.
            *step = Paths::units(sqrt(square) * scale).unwrap_or(u32::MAX);
            moves.longest = moves.longest.max(*step);
            moves.square = moves.square.at_least(square);
            moves.low = moves.low.zip_map(q, f64::at_most);
            moves.high = moves.high.zip_map(q, f64::at_least);
        }
        moves
    }

    /// Returns whether the unit of the tree fits the next positions.
    ///
    /// They must be near enough to the tree's origin and far enough apart.
    fn is_near(&self, moves: &Moves) -> bool {
        let (low, high, scale) = (moves.low, moves.high, 1.0 / self.tree.unit());
        let farthest = (low - self.tree.centre).abs().larger((high - self.tree.centre).abs());
        let half = sqrt(((high - low) * 0.5).norm_squared()) * scale;
        moves.longest < u32::MAX && farthest.amax() * scale < GROWN && half > SHRUNK
    }

    /// Makes the next points the points of the mesh.
    fn take_points(&mut self, bending: &mut Bending, units: &Units) {
        core::mem::swap(&mut self.points, &mut bending.next);
        let start = Vector3::repeat(f64::INFINITY);
        let (mut low, mut high, mut square) = (start, -start, 0.0f64);
        for p in &mut self.points {
            *p = p.map(|x| units.flushed(x));
            square = square.at_least(p.norm_squared());
            (low, high) = (low.zip_map(p, f64::at_most), high.zip_map(p, f64::at_least));
        }
        self.radius = sqrt(square) * (1.0 + 4.0 * UNIT);
        (self.low, self.high) = (low, high);
    }
}

/// How points move to their next positions, in stored coordinates.
struct Moves {
    /// The corners of the box around the next positions.
    low: Vector3<f64>,
    high: Vector3<f64>,
    /// The square of the longest move.
    square: f64,
    /// The longest step, in units of a path.
    longest: u32,
}

//! Repair of meshes as they come: weld, orient, cap.
//!
//! A mesh is a chain of oriented triangles. The signed boundary of the chain counts for every edge
//! how much more often triangles run along it in one direction than in the other. If it is zero,
//! every point off the surface has a winding number. Otherwise the boundary is a set of loops. A
//! cap is a set of triangles that run against a loop, so the chain with its caps is closed.
//!
//! ```text
//!      a lost triangle: a loop of three           a cap of five corners, of least area
//!
//!           .---<---.                                  .----<----.
//!          / \     / \                                /  \       \
//!         .   v   ^   .                              v    \   .   ^
//!          \   \ /   /                                \     .  \  |
//!           `---'---'                                  `--->---`--'
//! ```
//!
//! 1. **Weld.** In the order of their indices, points become representatives unless they are within
//!    the tolerance of one: then they move to the nearest. So no point moves farther than the
//!    tolerance, and a point meets few representatives.
//! 2. **Orient.** Over edges of exactly two triangles, the orientation of one triangle determines
//!    that of its neighbour. Each set connected in this way keeps the orientation of most of its
//!    area. Once the mesh is closed, its sheets that face inward are flipped (see
//!    [`edges`](super::edges)).
//! 3. **Cap.** A walk along the boundary cuts off a loop whenever it meets its own path, and
//!    prefers the next vertex that does. So loops are short, and have no vertex twice. A loop of up
//!    to [`LEAST_AREA`] corners gets the triangles of least total area. A longer loop is halved by
//!    the shortest chord between opposite corners first: along a crack this chord crosses the
//!    crack.
//!
//! Caps have no corners of their own, so they bend with the mesh. All choices follow from positions
//! and the order of indices: one mesh has one set of caps.
//!
//! Sources: Barequet and Sharir 1995, "Filling gaps in the boundary of a polyhedron" (loops, and
//! the triangulation of least area). Departure: the boundary is signed, so a turned or a doubled
//! triangle has a loop as well, and the result is closed for every input.

use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;
use core::fmt;
use nalgebra::{Point3, Vector3};

use super::build::{self, MOST, Sieved, Welded};
use super::edges;
use super::report::write_count;
use super::{Mesh, MeshError};
use crate::base::callbacks::{self, Watch, WithProgress};
use crate::base::num::each::Each;
use crate::base::num::extremes::largest;
use crate::base::num::scalar::sqrt;
use crate::body::polyhedron::bounding_box;

/// What [`Mesh::repaired`] may change.
///
/// The defaults weld equal points, orient, and cap.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
#[non_exhaustive]
pub struct RepairOptions {
    /// Points at most this far from an earlier point move to it, in the caller's unit.
    ///
    /// 0 welds equal points alone. A tolerance above a sixteenth of the longest side of the
    /// bounding box is an error.
    pub weld: f64,
    /// Whether triangles are turned, so that neighbours agree and a closed mesh faces outward.
    pub orient: bool,
    /// Whether caps close the mesh.
    pub caps: bool,
}

impl Default for RepairOptions {
    fn default() -> Self {
        Self {
            weld: 0.0,
            orient: true,
            caps: true,
        }
    }
}

impl RepairOptions {
    /// Sets [`weld`](Self::weld).
    #[must_use]
    pub fn weld(self, weld: f64) -> Self {
        Self { weld, ..self }
    }

    /// Sets [`orient`](Self::orient).
    #[must_use]
    pub fn orient(self, orient: bool) -> Self {
        Self { orient, ..self }
    }

    /// Sets [`caps`](Self::caps).
    #[must_use]
    pub fn caps(self, caps: bool) -> Self {
        Self { caps, ..self }
    }
}

/// What a repair has changed, in the [report](super::MeshReport::repair) of the mesh. Indices are
/// the caller's.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MeshRepair {
    /// Number of points that moved to another one within the tolerance.
    pub welded: usize,
    /// Triangles that were turned.
    pub turned: Vec<u32>,
    /// Edges of two triangles that do not agree, whichever way they are turned: the surface has one
    /// side, as a Möbius strip has.
    pub one_sided_edges: Vec<[u32; 2]>,
    /// The caps, in the order of their triangles.
    pub caps: Vec<MeshCap>,
    /// Area of the caps as a share of the area of the repaired mesh, from 0 to 1.
    pub cap_share: f64,
    /// Whether the triangles cancel in pairs, so that nothing is inside: a single triangle and its
    /// cap, for example.
    pub is_empty: bool,
}

impl MeshRepair {
    /// Returns whether nothing was changed.
    #[must_use]
    pub fn is_nothing(&self) -> bool {
        self.welded == 0 && self.turned.is_empty() && self.caps.is_empty()
    }

    /// Returns the number of corners of the longest loop; 0 without caps.
    #[must_use]
    pub fn longest_loop(&self) -> usize {
        self.caps.iter().map(|cap| cap.corners.len()).max().unwrap_or(0)
    }
}

impl fmt::Display for MeshRepair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let found = [
            (self.welded, ["point welded", "points welded"]),
            (self.turned.len(), ["triangle turned", "triangles turned"]),
            (
                self.one_sided_edges.len(),
                ["edge of a surface with one side", "edges of a surface with one side"],
            ),
            (self.caps.len(), ["cap", "caps"]),
        ];
        let mut is_first = true;
        for (count, nouns) in found.into_iter().filter(|x| x.0 > 0) {
            f.write_str(if is_first { "" } else { ", " })?;
            write_count(f, count, nouns)?;
            is_first = false;
        }
        if is_first {
            return f.write_str("nothing to repair");
        }
        if !self.caps.is_empty() {
            let (percent, longest) = (100.0 * self.cap_share, self.longest_loop());
            write!(f, " ({percent:.2} % of the area, at most {longest} corners)")?;
        }
        if self.is_empty {
            f.write_str(", nothing is inside")?;
        }
        Ok(())
    }
}

/// The triangles that close one loop of the boundary.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MeshCap {
    /// The corners of the loop, in the direction of the triangles that it bounds.
    pub corners: Vec<u32>,
    /// Index of the first triangle of the cap. Triangles of caps count on from those of the caller,
    /// and a loop has two less than corners. Those without area are not in the mesh: the
    /// [report](Mesh::report) lists them as degenerate.
    pub first: u32,
}

/// Largest number of corners of a loop that gets the triangles of least area, which takes time in
/// the cube of the corners.
const LEAST_AREA: usize = 40;

/// Largest number of continuations of a walk that are compared with its path, at a vertex where
/// many loops meet.
const COMPARED: usize = 64;

/// Largest tolerance of a weld, as a part of the longest side of the bounding box.
const WELD_MOST: f64 = 1.0 / 16.0;

impl WithProgress<'_> {
    /// Repairs a mesh as [`Mesh::repaired`] does.
    ///
    /// # Errors
    ///
    /// Returns the errors of [`Mesh::repaired`], and [`MeshError::Stopped`] if the callback stops
    /// the call.
    pub fn repaired(
        mut self,
        points: &[Point3<f64>],
        triangles: &[[u32; 3]],
        options: &RepairOptions,
    ) -> Result<Mesh, MeshError> {
        repaired(points, triangles, options, &mut self.watch)
    }
}

impl Mesh {
    /// Builds a mesh after repairing what keeps it from being a solid: cracks, turned triangles and
    /// holes. The report of the mesh says [what was changed](super::MeshReport::repair).
    ///
    /// With caps the result is a [`Solid`](super::MeshKind::Solid) for every input. Its winding
    /// number is exact at every point, so sides, overlaps, depths and contacts are those of a
    /// closed mesh. The triangles of caps belong to the surface: distances are measured to them,
    /// too. They count on from the caller's triangles, and [`is_cap`](Self::is_cap) tells them
    /// apart. The vertices are the caller's, so caps bend with
    /// [`set_vertices`](Self::set_vertices), which rejects a mesh with a cap whose corners are on
    /// one line (a T-junction).
    ///
    /// **When it is right.** A lost, turned or doubled triangle without another fault at its
    /// corners is mended exactly. A larger hole is closed by triangles between its corners, as near
    /// to the lost surface as a surface of least area is; points between the two have no true side.
    ///
    /// **When not to use it.** Where the opening is meant, as in a cup, a pipe or a sheet: a cap
    /// closes it, and what reaches in overlaps the mesh. If two triangles of a component that face
    /// opposite sides meet only at edges of more than two triangles, caps may lie across the solid;
    /// look at [`MeshRepair::cap_share`].
    ///
    /// **Sides alone.** Where distances, contacts and rays are to meet the given triangles only,
    /// keep both meshes. Ask the one of [`new`](Self::new) for distances, and the repaired one for
    /// sides, winding numbers and overlaps. No mesh answers both: a signed distance would jump at a
    /// cap, and a pair that reaches through an opening would overlap at a positive distance.
    ///
    /// The repair of a mesh takes up to twice the time of its [build](Self::new).
    ///
    /// ```
    /// use lin_canny::nalgebra::{Point3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny::{Mesh, MeshKind, PointQuery, RepairOptions};
    ///
    /// let cube = Mesh::from_convex(&solids::cuboid(Vector3::repeat(1.0))?)?;
    /// let (points, mut triangles) = (cube.vertices(), cube.triangle_vertices());
    /// triangles.pop(); // one is lost
    /// triangles[3].swap(0, 1); // one is turned over
    /// let open = Mesh::new(&points, &triangles)?;
    /// assert_eq!(open.kind(), MeshKind::Open);
    ///
    /// let options = RepairOptions::default();
    /// let solid = Mesh::repaired(&points, &triangles, &options)?;
    /// assert_eq!(solid.kind(), MeshKind::Solid);
    /// let repair = solid.report().repair.as_deref().unwrap();
    /// assert_eq!((repair.turned.as_slice(), repair.caps.len()), (&[3][..], 1));
    /// assert!(solid.is_cap(repair.caps[0].first));
    /// assert!(PointQuery::new(&solid).contains(&Point3::new(0.9, 0.9, 0.9))?);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Returns the errors of [`new`](Self::new), and [`MeshError::Weld`] if the tolerance is
    /// negative, not a number, or too large.
    #[doc(alias = "watertight")]
    #[doc(alias = "fill holes")]
    #[doc(alias = "winding order")]
    #[doc(alias = "fix normals")]
    pub fn repaired(
        points: &[Point3<f64>],
        triangles: &[[u32; 3]],
        options: &RepairOptions,
    ) -> Result<Self, MeshError> {
        repaired(points, triangles, options, &mut Watch::none())
    }

    /// Returns whether a triangle is one that a repair added, given its index as queries return it.
    #[must_use]
    pub fn is_cap(&self, triangle: u32) -> bool {
        triangle as usize >= self.report.input_triangles
    }
}

fn repaired(
    points: &[Point3<f64>],
    triangles: &[[u32; 3]],
    options: &RepairOptions,
    watch: &mut Watch<'_>,
) -> Result<Mesh, MeshError> {
    let found = Repair::new(points, triangles, options, watch).and_then(|repair| repair.finished(watch));
    found.inspect_err(|why| callbacks::refused("a mesh", why))
}

/// A mesh in repair.
struct Repair<'a> {
    points: &'a [Point3<f64>],
    options: &'a RepairOptions,
    /// The caller's triangles between welded points, as they are turned.
    triangles: Vec<[u32; 3]>,
    is_turned: Vec<bool>,
    caps: Vec<[u32; 3]>,
    report: MeshRepair,
}

impl<'a> Repair<'a> {
    /// Welds.
    fn new(
        points: &'a [Point3<f64>],
        triangles: &[[u32; 3]],
        options: &'a RepairOptions,
        watch: &mut Watch<'_>,
    ) -> Result<Self, MeshError> {
        build::check(points, triangles)?;
        let mut repair = Self {
            points,
            options,
            triangles: triangles.to_vec(),
            is_turned: vec![false; triangles.len()],
            caps: Vec::new(),
            report: MeshRepair::default(),
        };
        if options.weld != 0.0 {
            watch.stage("weld", None)?;
            repair.weld()?;
        }
        Ok(repair)
    }

    /// Moves the corners of triangles to the nearest representative within the tolerance.
    fn weld(&mut self) -> Result<(), MeshError> {
        if let Some(index) = self.points.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
            return Err(MeshError::NotFinite { index });
        }
        let mut is_used = vec![false; self.points.len()];
        self.triangles
            .iter()
            .flatten()
            .for_each(|&v| is_used[v as usize] = true);
        let used: Vec<u32> = (0..).zip(&is_used).filter(|x| *x.1).map(|x| x.0).collect();
        let place = |v: u32| &self.points[v as usize].coords;
        let (low, high) = bounding_box(used.iter().map(|&v| place(v)));
        let extent = if used.is_empty() { 0.0 } else { largest(&(high - low)) };
        let tolerance = self.options.weld;
        // Cells are counted from one corner of the box to the other.
        if !(tolerance > 0.0 && tolerance <= WELD_MOST * extent && extent / tolerance < f64::INFINITY) {
            return Err(MeshError::Weld { tolerance, extent });
        }
        let mut cells = Cells::new(used.len());
        let mut same_as: Vec<u32> = (0..self.points.len() as u32).collect();
        for v in used {
            // Scaled first, so that squares stay in range.
            let p = (place(v) - low) / tolerance;
            match cells.nearest(&p) {
                Some((representative, square)) => {
                    same_as[v as usize] = representative;
                    self.report.welded += usize::from(square > 0.0);
                }
                None => cells.insert(v, p),
            }
        }
        self.triangles
            .iter_mut()
            .for_each(|t| *t = t.each(|v| same_as[v as usize]));
        Ok(())
    }

    /// Orients, caps, builds, and turns what faces inward.
    fn finished(mut self, watch: &mut Watch<'_>) -> Result<Mesh, MeshError> {
        let mut all = build::sieved(self.points, &self.triangles, watch)?;
        if self.options.orient && !all.2.closed {
            let turned = self.disagreeing(&all.0, &all.1);
            if !turned.is_empty() {
                self.turn(&turned, &all.1.repeated);
                all = build::sieved(self.points, &self.triangles, watch)?;
            }
        }
        let (welded, sieved, found) = all;
        if self.options.caps && !found.closed {
            watch.stage("caps", None)?;
            self.cap(&welded, &sieved)?;
        }
        let mesh = self.built(welded, sieved, watch)?;
        let Some(is_inward) = self.options.orient.then(|| mesh.inward()).flatten() else {
            return Ok(self.reported(mesh));
        };
        let inward = mesh.source_triangles.iter().zip(is_inward).filter(|x| x.1);
        let mut inward: Vec<u32> = inward.map(|x| *x.0).collect();
        inward.sort_unstable();
        self.turn(&inward, &mesh.report.repeated);
        let (welded, sieved, _) = build::sieved(self.points, &self.triangles, watch)?;
        let turned = self.built(welded, sieved, watch)?;
        if turned.is_solid() {
            return Ok(self.reported(turned));
        }
        // Sheets of opposite sense that cross would open the mesh.
        self.turn(&inward, &mesh.report.repeated);
        Ok(self.reported(mesh))
    }

    /// Turns triangles, the caller's and those of caps. A triangle that the build drops as a
    /// repetition is turned with the one that it repeats.
    fn turn(&mut self, sorted: &[u32], repeated: &[(u32, u32)]) {
        let repeated = repeated.iter().filter(|(_, kept)| sorted.binary_search(kept).is_ok());
        let given = self.triangles.len();
        for k in sorted.iter().copied().chain(repeated.map(|(dropped, _)| *dropped)) {
            let k = k as usize;
            if k < given {
                self.triangles[k].swap(1, 2);
                self.is_turned[k] ^= true;
            } else {
                self.caps[k - given].swap(1, 2);
            }
        }
    }

    /// Returns the triangles to turn, as little area as possible, so that triangles agree at edges
    /// of two.
    fn disagreeing(&mut self, welded: &Welded, sieved: &Sieved) -> Vec<u32> {
        let kept = &sieved.kept;
        let (neighbours, area) = (neighbours(kept), |k: usize| double_area(&welded.points, kept[k]));
        let (mut is_turned, mut is_seen) = (vec![false; kept.len()], vec![false; kept.len()]);
        for first in 0..kept.len() {
            if is_seen[first] {
                continue;
            }
            is_seen[first] = true;
            let (mut members, mut next) = (vec![first], 0);
            while let Some(&t) = members.get(next) {
                next += 1;
                for (i, neighbour) in neighbours[t].iter().enumerate() {
                    let Some((u, is_alike)) = *neighbour else { continue };
                    let (sense, u) = (is_turned[t] ^ is_alike, u as usize);
                    if !is_seen[u] {
                        (is_seen[u], is_turned[u]) = (true, sense);
                        members.push(u);
                    } else if is_turned[u] != sense {
                        let (a, b) = (kept[t][i], kept[t][(i + 1) % 3]);
                        self.report.one_sided_edges.push([a.min(b), a.max(b)]);
                    }
                }
            }
            let sum = |turned: bool| {
                members
                    .iter()
                    .filter(|t| is_turned[**t] == turned)
                    .map(|t| area(*t))
                    .sum::<f64>()
            };
            if sum(true) > sum(false) {
                members.iter().for_each(|&t| is_turned[t] = !is_turned[t]);
            }
        }
        self.report.one_sided_edges.sort_unstable();
        self.report.one_sided_edges.dedup();
        let turned = sieved.source.iter().zip(is_turned).filter(|x| x.1);
        turned.map(|x| *x.0).collect()
    }

    /// Closes the boundary of the kept triangles.
    fn cap(&mut self, welded: &Welded, sieved: &Sieved) -> Result<(), MeshError> {
        let given = self.triangles.len();
        for corners in loops(&sieved.kept) {
            let first = given + self.caps.len();
            if first + corners.len() > MOST {
                return Err(MeshError::TooMany {
                    count: first + corners.len(),
                });
            }
            triangulate(&welded.points, &corners, &mut self.caps);
            let first = first as u32;
            self.report.caps.push(MeshCap { corners, first });
        }
        Ok(())
    }

    /// Builds the mesh of the kept triangles and the caps.
    fn built(&self, welded: Welded, mut sieved: Sieved, watch: &mut Watch<'_>) -> Result<Mesh, MeshError> {
        let given = self.triangles.len();
        for (k, cap) in (given as u32..).zip(&self.caps) {
            sieved.add(&welded.points, *cap, k);
        }
        let found = edges::judge(&welded.points, &sieved.kept);
        Ok(build::assemble(welded, sieved, found, given, watch)?)
    }

    /// Adds what was changed to the report of the mesh.
    fn reported(mut self, mut mesh: Mesh) -> Mesh {
        let given = self.triangles.len();
        let turned = (0..given as u32).filter(|k| self.is_turned[*k as usize]);
        self.report.turned = turned.collect();
        let each = || {
            (0..)
                .zip(&mesh.source_triangles)
                .map(|(t, source)| (mesh.triangles[t], *source))
        };
        let area = |t: [u32; 3]| double_area(&mesh.points, t);
        let caps: f64 = each().filter(|x| mesh.is_cap(x.1)).map(|x| area(x.0)).sum();
        let whole: f64 = each().map(|x| area(x.0)).sum();
        self.report.cap_share = if caps > 0.0 { caps / whole } else { 0.0 };
        self.report.is_empty = mesh.is_solid() && cancel(&mesh.triangles);
        mesh.report.repair = Some(Box::new(self.report));
        mesh
    }
}

fn double_area(points: &[Vector3<f64>], t: [u32; 3]) -> f64 {
    let [a, b, c] = t.each(|v| points[v as usize]);
    sqrt((b - a).cross(&(c - a)).norm_squared())
}

/// Returns whether as many triangles face one side as the other, for every three corners.
fn cancel(triangles: &[[u32; 3]]) -> bool {
    let mut all: Vec<([u32; 3], i64)> = Vec::with_capacity(triangles.len());
    for t in triangles {
        let mut sorted = *t;
        sorted.sort_unstable();
        let first = (0..3).find(|&k| t[k] == sorted[0]).unwrap_or(0);
        let is_even = t[(first + 1) % 3] == sorted[1];
        all.push((sorted, if is_even { 1 } else { -1 }));
    }
    all.sort_unstable();
    all.chunk_by(|x, y| x.0 == y.0)
        .all(|same| same.iter().map(|x| x.1).sum::<i64>() == 0)
}

/// The neighbours of a triangle at its three edges, and whether both run along the edge in one
/// direction; `None` at an edge that is not of two triangles.
type Neighbours = [Option<(u32, bool)>; 3];

fn neighbours(triangles: &[[u32; 3]]) -> Vec<Neighbours> {
    let mut runs: Vec<([u32; 2], u32, u8)> = Vec::with_capacity(3 * triangles.len());
    for (k, t) in (0u32..).zip(triangles) {
        for i in 0..3u8 {
            let (from, to) = (t[usize::from(i)], t[(usize::from(i) + 1) % 3]);
            runs.push(([from.min(to), from.max(to)], k, i));
        }
    }
    runs.sort_unstable();
    let mut neighbours = vec![[None; 3]; triangles.len()];
    let starts = |(_, k, i): ([u32; 2], u32, u8)| triangles[k as usize][usize::from(i)];
    for edge in runs.chunk_by(|x, y| x.0 == y.0) {
        if let &[x, y] = edge {
            let is_alike = starts(x) == starts(y);
            neighbours[x.1 as usize][usize::from(x.2)] = Some((y.1, is_alike));
            neighbours[y.1 as usize][usize::from(y.2)] = Some((x.1, is_alike));
        }
    }
    neighbours
}

/// Returns the loops of the signed boundary; no loop has a vertex twice.
fn loops(triangles: &[[u32; 3]]) -> Vec<Vec<u32>> {
    // The two ends of each directed edge, once for each time that it is left over.
    let mut runs: Vec<([u32; 2], i64)> = Vec::with_capacity(3 * triangles.len());
    for &[a, b, c] in triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            runs.push(([from.min(to), from.max(to)], if from < to { 1 } else { -1 }));
        }
    }
    runs.sort_unstable();
    let mut edges: Vec<[u32; 2]> = Vec::new();
    for edge in runs.chunk_by(|x, y| x.0 == y.0) {
        let ([low, high], sum) = (edge[0].0, edge.iter().map(|x| x.1).sum::<i64>());
        let directed = if sum > 0 { [low, high] } else { [high, low] };
        edges.extend((0..sum.unsigned_abs()).map(|_| directed));
    }
    edges.sort_unstable();
    // The edges that leave a vertex are next to each other, and are taken from the front.
    let mut leaving: Vec<(u32, core::ops::Range<usize>)> = Vec::new();
    for (k, [from, _]) in edges.iter().enumerate() {
        match leaving.last_mut() {
            Some((v, range)) if v == from => range.end = k + 1,
            _ => leaving.push((*from, k..k + 1)),
        }
    }
    let number = |v: u32| leaving.binary_search_by_key(&v, |x| x.0);
    // From here on, vertices are counted among those of the boundary.
    let mut ends: Vec<u32> = edges.iter().map(|e| number(e[1]).unwrap_or(0) as u32).collect();
    let (names, mut open): (Vec<u32>, Vec<_>) = leaving.into_iter().unzip();
    let mut found = Vec::new();
    let mut place = vec![usize::MAX; names.len()];
    for start in 0..names.len() {
        let mut path: Vec<u32> = Vec::new();
        while !path.is_empty() || !open[start].is_empty() {
            if path.is_empty() {
                path.push(start as u32);
                place[start] = 0;
            }
            let Some(&at) = path.last() else { break };
            let range = open[at as usize].clone();
            // Every vertex has as many edges that leave it as edges that arrive.
            if range.is_empty() {
                break;
            }
            let compared = range.start..range.end.min(range.start + COMPARED);
            let on_path = compared.filter(|&k| place[ends[k] as usize] != usize::MAX);
            let best = on_path.max_by_key(|&k| (place[ends[k] as usize], core::cmp::Reverse(k)));
            let taken = best.unwrap_or(range.start);
            let to = ends[taken];
            // The edges before the taken one move up, in their order.
            ends.copy_within(range.start..taken, range.start + 1);
            open[at as usize].start += 1;
            let first = place[to as usize];
            if first == usize::MAX {
                place[to as usize] = path.len();
                path.push(to);
                continue;
            }
            found.push(path[first..].iter().map(|&v| names[v as usize]).collect());
            path.drain(first + 1..).for_each(|v| place[v as usize] = usize::MAX);
            if first == 0 {
                place[path[0] as usize] = usize::MAX;
                path.clear();
            }
        }
        path.iter().for_each(|&v| place[v as usize] = usize::MAX);
    }
    found
}

/// Adds the triangles that run against a loop.
fn triangulate(points: &[Vector3<f64>], corners: &[u32], caps: &mut Vec<[u32; 3]>) {
    let mut parts = vec![corners.to_vec()];
    while let Some(part) = parts.pop() {
        if part.len() <= LEAST_AREA {
            of_least_area(points, &part, caps);
            continue;
        }
        let half = part.len() / 2;
        let chord = |k: usize| (points[part[k] as usize] - points[part[k + half] as usize]).norm_squared();
        let mut best = (chord(0), 0);
        for k in 1..part.len() - half {
            let length = chord(k);
            if length < best.0 {
                best = (length, k);
            }
        }
        let k = best.1;
        parts.push([&part[k + half..], &part[..=k]].concat());
        parts.push(part[k..=k + half].to_vec());
    }
}

/// Adds the triangles of least total area that run against a loop.
///
/// The least area of corners i to j is that of a triangle i, k, j and of both sides of it.
fn of_least_area(points: &[Vector3<f64>], corners: &[u32], caps: &mut Vec<[u32; 3]>) {
    if let [a, b, c] = *corners {
        caps.push([c, b, a]);
        return;
    }
    let n = corners.len();
    let mut best = [[(0.0f64, 0u8); LEAST_AREA]; LEAST_AREA];
    for span in 2..n {
        for i in 0..n - span {
            let j = i + span;
            let mut least = (f64::INFINITY, (i + 1) as u8);
            for k in i + 1..j {
                let own = double_area(points, [corners[i], corners[k], corners[j]]);
                let sum = best[i][k].0 + best[k][j].0 + own;
                if sum < least.0 {
                    least = (sum, k as u8);
                }
            }
            best[i][j] = least;
        }
    }
    let mut open = vec![(0, n - 1)];
    while let Some((i, j)) = open.pop() {
        if j - i >= 2 {
            let k = usize::from(best[i][j].1);
            caps.push([corners[j], corners[k], corners[i]]);
            open.extend([(k, j), (i, k)]);
        }
    }
}

/// Representatives of points in cells of side one, found by the hash of their cell.
struct Cells {
    first: Vec<u32>,
    /// The index of each representative, its place, and the next one of the same hash.
    all: Vec<(u32, Vector3<f64>, u32)>,
}

/// Marks the end of a list of cells.
const NONE: u32 = u32::MAX;

impl Cells {
    fn new(most: usize) -> Self {
        Self {
            first: vec![NONE; (2 * most).next_power_of_two().max(2)],
            all: Vec::new(),
        }
    }

    /// Returns the cell of a place: the coordinates rounded down.
    fn cell(p: &Vector3<f64>) -> Vector3<f64> {
        // Beyond 2^52 every number is whole.
        p.map(|x| if x < 4.5e15 { (x as u64) as f64 } else { x })
    }

    fn slot(&self, cell: &Vector3<f64>) -> usize {
        let hash = cell.iter().fold(0, |h, x| build::stir(h ^ x.to_bits()));
        hash as usize & (self.first.len() - 1)
    }

    fn insert(&mut self, index: u32, p: Vector3<f64>) {
        let slot = self.slot(&Self::cell(&p));
        self.all.push((index, p, self.first[slot]));
        self.first[slot] = self.all.len() as u32 - 1;
    }

    /// Returns the nearest representative at a distance of at most one, the lower index if two are
    /// equally near, and the square of the distance.
    fn nearest(&self, p: &Vector3<f64>) -> Option<(u32, f64)> {
        let cell = Self::cell(p);
        let mut best: Option<(f64, u32)> = None;
        for k in 0..27 {
            let to = Vector3::new(f64::from(k % 3), f64::from(k / 3 % 3), f64::from(k / 9)).add_scalar(-1.0);
            let mut at = self.first[self.slot(&(cell + to))];
            while at != NONE {
                let (index, q, next) = &self.all[at as usize];
                let square = (q - p).norm_squared();
                if square <= 1.0 && best.is_none_or(|b| (square, *index) < b) {
                    best = Some((square, *index));
                }
                at = *next;
            }
        }
        best.map(|(square, index)| (index, square))
    }
}

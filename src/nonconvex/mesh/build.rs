//! Builds a mesh from points and triangles.
//!
//! The caller's points are checked, scaled by a power of two, and welded if they are equal
//! ([`weld`]).

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Point3, Vector3};

use super::edges::{self, Edges};
use super::vertices::Stiff;
use super::{Mesh, MeshError, MeshKind, MeshReport};
use crate::base::callbacks;
use crate::base::callbacks::{Stopped, Watch, WithProgress};
use crate::base::num::each::Each;
use crate::base::num::extremes::{Extremes, largest};
use crate::base::num::fingerprint::{Fingerprint, Fingerprinter};
use crate::base::num::scalar::sqrt;
use crate::base::num::sign;
use crate::base::num::sort::sort;
use crate::base::tolerance::{EXPONENT_FREE, EXTENT_MAX, EXTENT_MIN, FLUSH_EXPONENT, PLACE_MAX, SIDE_ERROR, UNIT};
use crate::body::polyhedron::{ConvexPolyhedron, bounding_box, exponent_of, far_origin, power_of_two};
use crate::nonconvex::tree::{LEAF, Tree};
use crate::pair::transform::StoredFrame;

impl WithProgress<'_> {
    /// Builds a mesh as [`Mesh::new`] does.
    ///
    /// # Errors
    ///
    /// Returns the errors of [`Mesh::new`], and [`MeshError::Stopped`] if the callback stops the
    /// call.
    pub fn mesh(mut self, points: &[Point3<f64>], triangles: &[[u32; 3]]) -> Result<Mesh, MeshError> {
        Mesh::built(points, triangles, &mut self.watch)
    }
}

impl Mesh {
    /// Builds a mesh from points and triangles.
    ///
    /// Points with equal coordinates are welded. Triangles without area and repeated triangles are
    /// dropped. The [report](Self::report) lists all of them; nothing else is changed. Dropping a
    /// triangle never opens a closed surface, for two reasons:
    ///
    /// - Edges on one line cancel wherever their ends are.
    /// - Repeated triangles are kept if the surface is closed only with them.
    ///
    /// The build takes `O(n log n)` time.
    ///
    /// # Errors
    ///
    /// Returns an error in these cases:
    ///
    /// - A coordinate is not finite.
    /// - A triangle names a point that does not exist.
    /// - There are more than 2^27 points or triangles.
    /// - No triangle is left.
    /// - The extent is outside 1e-100..1e100, or a coordinate of a used point exceeds 1e116.
    pub fn new(points: &[Point3<f64>], triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        Self::built(points, triangles, &mut Watch::none())
    }

    fn built(points: &[Point3<f64>], triangles: &[[u32; 3]], watch: &mut Watch<'_>) -> Result<Self, MeshError> {
        Self::build(points, triangles, watch).inspect_err(|why| callbacks::refused("a mesh", why))
    }

    fn build(points: &[Point3<f64>], triangles: &[[u32; 3]], watch: &mut Watch<'_>) -> Result<Self, MeshError> {
        check(points, triangles)?;
        let (welded, sieved, found) = sieved(points, triangles, watch)?;
        Ok(assemble(welded, sieved, found, triangles.len(), watch)?)
    }

    /// Builds a solid mesh from the surface of a convex body.
    ///
    /// The index of a triangle counts in the order of the body's faces. The index of a point is
    /// that of the body's vertex.
    ///
    /// # Errors
    ///
    /// Returns [`MeshError::Empty`] if the body has no faces (a segment or a point).
    pub fn from_convex(body: &ConvexPolyhedron) -> Result<Self, MeshError> {
        let points: Vec<_> = body.vertex_points().collect();
        let triangles: Vec<_> = body.triangles().map(|t| t.each(|v| v.index() as u32)).collect();
        Self::new(&points, &triangles)
    }
}

/// Checks the number of triangles, and that their points exist.
pub(super) fn check(points: &[Point3<f64>], triangles: &[[u32; 3]]) -> Result<(), MeshError> {
    if triangles.len() > MOST {
        return Err(MeshError::TooMany { count: triangles.len() });
    }
    let missing = |t: &[u32; 3]| t.iter().copied().find(|&v| v as usize >= points.len());
    match triangles.iter().enumerate().find_map(|(k, t)| Some((k, missing(t)?))) {
        Some((triangle, index)) => Err(MeshError::IndexOutOfRange {
            triangle,
            index: index as usize,
        }),
        None => Ok(()),
    }
}

/// Welds equal points, drops triangles without area and repeated ones, and classifies the edges.
pub(super) fn sieved(
    points: &[Point3<f64>],
    triangles: &[[u32; 3]],
    watch: &mut Watch<'_>,
) -> Result<(Welded, Sieved, Edges), MeshError> {
    watch.stage("weld", None)?;
    let welded = weld(points, triangles)?;
    watch.stage("edges", None)?;
    let every = sieve(&welded, triangles);
    if every.kept.is_empty() {
        return Err(MeshError::Empty { given: triangles.len() });
    }
    let (sieved, found) = judged(&welded.points, every);
    Ok((welded, sieved, found))
}

/// The kept triangles over welded points, and the caller's indices of the others.
pub(super) struct Sieved {
    pub(super) kept: Vec<[u32; 3]>,
    pub(super) source: Vec<u32>,
    degenerate: Vec<u32>,
    /// The first of the dropped triangles that has three different vertices on one line.
    collinear: Option<u32>,
    pub(super) repeated: Vec<(u32, u32)>,
}

impl Sieved {
    /// Keeps a triangle if it has an area.
    pub(super) fn add(&mut self, points: &[Vector3<f64>], t: [u32; 3], source: u32) {
        if t[0] == t[1] || t[1] == t[2] || t[2] == t[0] {
            self.degenerate.push(source);
        } else if is_collinear(t.each(|v| &points[v as usize])) {
            self.degenerate.push(source);
            self.collinear = self.collinear.or(Some(source));
        } else {
            self.kept.push(t);
            self.source.push(source);
        }
    }
}

/// Drops triangles without area.
fn sieve(welded: &Welded, triangles: &[[u32; 3]]) -> Sieved {
    let mut sieved = Sieved {
        kept: Vec::with_capacity(triangles.len()),
        source: Vec::with_capacity(triangles.len()),
        degenerate: Vec::new(),
        collinear: None,
        repeated: Vec::new(),
    };
    for (k, t) in (0u32..).zip(triangles) {
        sieved.add(&welded.points, t.each(|v| welded.same_as[v as usize]), k);
    }
    sieved
}

/// Drops repeated triangles and classifies the edges.
///
/// Keeps the repeated triangles if the surface is closed only with them.
fn judged(points: &[Vector3<f64>], every: Sieved) -> (Sieved, Edges) {
    let once = without_repeated(&every);
    let found = edges::judge(points, &once.kept);
    if !found.closed && !once.repeated.is_empty() {
        let found = edges::judge(points, &every.kept);
        if found.closed {
            return (every, found);
        }
    }
    (once, found)
}

/// Returns whether three points are exactly collinear.
///
/// A cross product decides if its error is small enough; otherwise exact predicates decide.
fn is_collinear([a, b, c]: [&Vector3<f64>; 3]) -> bool {
    let (u, v) = (b - a, c - a);
    let certain = SIDE_ERROR * u.amax() * v.amax();
    u.cross(&v).amax() <= 2.0 * certain && sign::projection(a, b, c).is_none()
}

/// Drops triangles that repeat an earlier triangle with the same vertices in the same orientation.
fn without_repeated(every: &Sieved) -> Sieved {
    let turned = |t: &[u32; 3]| {
        let low = (0..3).min_by_key(|&k| t[k]).unwrap_or(0);
        [t[low], t[(low + 1) % 3], t[(low + 2) % 3]]
    };
    let key = |t: &[u32; 3]| turned(t).iter().fold(0, |h, &v| stir(h ^ u64::from(v)));
    let mut keys: Vec<(u64, u32)> = every.kept.iter().map(key).zip(0..).collect();
    keys.sort_unstable();
    let mut gone = vec![false; every.kept.len()];
    let mut repeated = Vec::new();
    for run in keys.chunk_by(|a, b| a.0 == b.0).filter(|run| run.len() > 1) {
        for (i, later) in run.iter().enumerate() {
            let same = |k: &&(u64, u32)| turned(&every.kept[k.1 as usize]) == turned(&every.kept[later.1 as usize]);
            if let Some(first) = run[..i].iter().find(same) {
                gone[later.1 as usize] = true;
                let names = [later.1, first.1].each(|k| every.source[k as usize]);
                repeated.push((names[0], names[1]));
            }
        }
    }
    repeated.sort_unstable();
    let stay = || (0..gone.len()).filter(|&k| !gone[k]);
    Sieved {
        kept: stay().map(|k| every.kept[k]).collect(),
        source: stay().map(|k| every.source[k]).collect(),
        degenerate: every.degenerate.clone(),
        collinear: every.collinear,
        repeated,
    }
}

/// Builds the tree and stores everything in its order.
pub(super) fn assemble(
    welded: Welded,
    sieved: Sieved,
    found: Edges,
    given: usize,
    watch: &mut Watch<'_>,
) -> Result<Mesh, Stopped> {
    let (mut parts, part_vertices) = edges::parts(&welded.points, &sieved.kept, found.closed);
    parts
        .iter_mut()
        .for_each(|p| p.triangle = sieved.source[p.triangle as usize]);
    let ordered = InTreeOrder::new(&welded.points, &sieved.kept, watch)?;
    watch.check()?;
    let points = &ordered.points;
    let (low, high) = bounding_box(points);
    let unit = welded.frame.unit();
    parts.iter_mut().for_each(|p| p.volume *= unit * unit * unit);
    let kind = if found.closed { MeshKind::Solid } else { MeshKind::Open };
    let welded_away = (0u32..).zip(&welded.same_as).filter(|(k, v)| k != *v).count();
    let square = points.iter().fold(0.0, |r: f64, p| r.larger(p.norm_squared()));
    let mut mesh = Mesh {
        report: MeshReport {
            kind,
            input_points: welded.points.len(),
            input_triangles: given,
            vertices: points.len(),
            triangles: ordered.order.len(),
            welded: welded_away,
            unused: welded.points.len() - welded_away - points.len(),
            degenerate: sieved.degenerate,
            repeated: sieved.repeated,
            boundary_edges: found.boundary,
            non_manifold_edges: found.non_manifold,
            misoriented_edges: found.misoriented,
            parts,
            flushed_coordinates: welded.flushed,
            repair: None,
        },
        stiff: match sieved.collinear {
            Some(triangle) => Some(Stiff::Dropped { triangle }),
            None => found.closed_along_lines.then_some(Stiff::ClosedAlongLines),
        },
        bending: None,
        off: 0.0,
        fingerprint: Fingerprint::default(),
        part_vertices: part_vertices
            .into_iter()
            .map(|four| four.each(|v| ordered.number[v as usize]))
            .collect(),
        source_triangles: ordered.sources(&sieved.source),
        source_points: ordered.source,
        triangles: ordered.triangles,
        frame: welded.frame,
        radius: sqrt(square) * (1.0 + 4.0 * UNIT),
        points: ordered.points,
        tree: ordered.tree,
        low,
        high,
    };
    mesh.fingerprint = mesh.fingerprint_as_built();
    Ok(mesh)
}

/// A tree over triangles, with triangles and points in its order.
///
/// Triangles are in the order of the leaves, points in the order in which the triangles use them.
pub(super) struct InTreeOrder {
    pub(super) tree: Tree,
    pub(super) points: Vec<Vector3<f64>>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// The previous index of each triangle and each point.
    pub(super) order: Vec<u32>,
    pub(super) source: Vec<u32>,
    /// The new index of each point.
    pub(super) number: Vec<u32>,
}

impl InTreeOrder {
    pub(super) fn new(points: &[Vector3<f64>], given: &[[u32; 3]], watch: &mut Watch<'_>) -> Result<Self, Stopped> {
        watch.stage("tree", Some(given.len()))?;
        let (tree, order) = Tree::split(points, given, LEAF, watch);
        watch.stage("boxes", Some(tree.len()))?;
        let mut new = Self::arranged(tree, order, points, given);
        new.tree.fit(&new.points, &new.triangles, 0.0, watch);
        Ok(new)
    }

    /// Builds the upper levels of a tree again, over triangles in its order.
    pub(super) fn with_new_top(tree: &Tree, points: &[Vector3<f64>], given: &[[u32; 3]]) -> Self {
        let (tree, order, fresh) = tree.with_new_top(points, given);
        let mut new = Self::arranged(tree, order, points, given);
        new.tree.fit_again(&new.points, &new.triangles, &fresh);
        new
    }

    fn arranged(tree: Tree, order: Vec<u32>, points: &[Vector3<f64>], given: &[[u32; 3]]) -> Self {
        let mut new = Self {
            tree,
            points: Vec::new(),
            triangles: Vec::with_capacity(given.len()),
            order,
            source: Vec::new(),
            number: vec![u32::MAX; points.len()],
        };
        for k in 0..new.order.len() {
            let corners = given[new.order[k] as usize].each(|v| new.vertex(v));
            new.triangles.push(corners);
        }
        new.points = new.source.iter().map(|&v| points[v as usize]).collect();
        new
    }

    /// Returns the caller's index of each triangle, given those in the previous order.
    pub(super) fn sources(&self, before: &[u32]) -> Vec<u32> {
        self.order.iter().map(|&k| before[k as usize]).collect()
    }

    fn vertex(&mut self, v: u32) -> u32 {
        let number = &mut self.number[v as usize];
        if *number == u32::MAX {
            *number = self.source.len() as u32;
            self.source.push(v);
        }
        *number
    }
}

impl Mesh {
    /// Returns the fingerprint of the mesh with the tree that the build makes.
    pub(super) fn fingerprint_as_built(&self) -> Fingerprint {
        let mut all = Fingerprinter::new(*b"mesh    ");
        all.word(self.frame.exponent as u64);
        if !self.frame.is_at_origin() {
            all.vector(&self.frame.origin);
        }
        all.word(self.points.len() as u64);
        self.points.iter().for_each(|p| all.vector(p));
        all.word(self.triangles.len() as u64);
        all.indices(self.triangles.as_flattened().iter().copied());
        self.tree.add_links(&mut all);
        // No lengths: there are as many entries as points and triangles.
        all.indices(self.source_points.iter().copied());
        all.indices(self.source_triangles.iter().copied());
        all.number(self.off);
        all.end()
    }

    /// Returns the mesh with a bound of the position error of its points, in the caller's unit.
    pub(crate) fn with_points_off(mut self, off: f64) -> Self {
        if off > 0.0 {
            self.off = off / self.unit();
            self.fingerprint = self.fingerprint_as_built();
        }
        self
    }

    /// Returns the fingerprint of the mesh after it takes another tree over the same triangles.
    ///
    /// `kind` names the method by which the tree was made.
    pub(super) fn fingerprint_in(&self, kind: [u8; 8], new: &InTreeOrder) -> Fingerprint {
        let mut all = Fingerprinter::new(kind);
        all.fingerprint(self.fingerprint);
        all.word(new.order.len() as u64);
        all.indices(new.order.iter().copied());
        new.tree.add_links(&mut all);
        all.end()
    }
}

/// Maximum number of points and of triangles.
///
/// The id of a triangle shares its 32 bits with a mark and a count.
pub(super) const MOST: usize = 1 << 27;

/// The points in stored units, and for each point the first one with the same coordinates.
pub(super) struct Welded {
    pub(super) points: Vec<Vector3<f64>>,
    same_as: Vec<u32>,
    frame: StoredFrame,
    flushed: usize,
}

/// Checks, scales and welds the points.
///
/// A point that no triangle uses must only be finite: the mesh does not depend on it.
fn weld(given: &[Point3<f64>], triangles: &[[u32; 3]]) -> Result<Welded, MeshError> {
    if given.len() > MOST {
        return Err(MeshError::TooMany { count: given.len() });
    }
    if let Some(index) = given.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        return Err(MeshError::NotFinite { index });
    }
    let mut is_used = vec![false; given.len()];
    triangles.iter().flatten().for_each(|&v| is_used[v as usize] = true);
    let used = || given.iter().zip(&is_used).filter(|p| *p.1).map(|p| &p.0.coords);
    let (low, high) = bounding_box(used());
    let sides = high - low;
    let extent = if triangles.is_empty() { 0.0 } else { largest(&sides) };
    let far = used().any(|p| p.amax() > PLACE_MAX);
    if far || !triangles.is_empty() && !(EXTENT_MIN..=EXTENT_MAX).contains(&extent) {
        return Err(MeshError::OutOfRange { extent });
    }
    let units = Units::of(&sides);
    let frame = units.frame(&low, &high, used());
    let scale = power_of_two(-units.exponent);
    let mut flushed = 0;
    let points: Vec<Vector3<f64>> = given
        .iter()
        .zip(&is_used)
        .map(|(p, is_used)| {
            ((p.coords - frame.origin) * scale).map(|x| {
                let kept = units.flushed(x);
                flushed += usize::from(*is_used && kept != x);
                kept
            })
        })
        .collect();
    let same_as = first_equal(&points);
    Ok(Welded {
        points,
        same_as,
        frame,
        flushed,
    })
}

/// The unit of stored coordinates, and the limit below which a coordinate counts as zero.
#[derive(Clone, Copy)]
pub(super) struct Units {
    /// A stored length times `2^exponent` is the caller's length.
    pub(super) exponent: i32,
    flush: f64,
}

impl Units {
    /// Returns the units for a mesh with the given sides of its bounding box.
    pub(super) fn of(sides: &Vector3<f64>) -> Self {
        let size = exponent_of(sqrt((sides * 0.5).norm_squared()));
        let window = 2 * EXPONENT_FREE;
        let exponent = (size + EXPONENT_FREE).div_euclid(window) * window;
        Self {
            exponent,
            flush: power_of_two(size - exponent - FLUSH_EXPONENT),
        }
    }

    /// Returns the frame of stored coordinates for vertices with the given bounding box.
    pub(super) fn frame<'a>(
        &self,
        low: &Vector3<f64>,
        high: &Vector3<f64>,
        points: impl Iterator<Item = &'a Vector3<f64>> + Clone,
    ) -> StoredFrame {
        let radius = sqrt(((high - low) * 0.5).norm_squared());
        StoredFrame {
            origin: far_origin(&(low * 0.5 + high * 0.5), radius, points.copied()),
            exponent: self.exponent,
        }
    }

    /// Returns a stored coordinate, or zero if its magnitude is too small.
    pub(super) fn flushed(&self, x: f64) -> f64 {
        if x.abs() < self.flush { 0.0 } else { x }
    }
}

/// Returns for each point the first point with the same coordinates.
///
/// Points are sorted by a hash of their bits, so that long runs of equal first coordinates cost
/// nothing. If hashes are equal, the coordinates decide.
fn first_equal(points: &[Vector3<f64>]) -> Vec<u32> {
    let mut keys: Vec<(u64, u32)> = points.iter().map(mix).zip(0..).collect();
    keys.sort_unstable();
    let mut same_as: Vec<u32> = (0..points.len() as u32).collect();
    for run in keys.chunk_by_mut(|a, b| a.0 == b.0).filter(|run| run.len() > 1) {
        sort(run, |a, b| {
            order(&points[a.1 as usize], &points[b.1 as usize]).then(a.1.cmp(&b.1))
        });
        for equal in run.chunk_by(|a, b| points[a.1 as usize] == points[b.1 as usize]) {
            equal.iter().for_each(|k| same_as[k.1 as usize] = equal[0].1);
        }
    }
    same_as
}

fn order(a: &Vector3<f64>, b: &Vector3<f64>) -> core::cmp::Ordering {
    a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z))
}

/// Returns a hash that is equal for equal points; no coordinate is a negative zero.
fn mix(p: &Vector3<f64>) -> u64 {
    p.iter().fold(0, |h, x| stir(h ^ x.to_bits()))
}

/// Performs one round of multiply and shift, which is a bijection.
pub(super) fn stir(x: u64) -> u64 {
    let x = (x ^ x >> 32).wrapping_mul(0xd6e8_feb8_6659_fd93);
    (x ^ x >> 29).wrapping_mul(0xff51_afd7_ed55_8ccd)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use super::*;
    use crate::nonconvex::contact::ConvexPatches;

    /// Changes each input that cached state depends on, one at a time.
    #[test]
    fn fingerprints_are_of_all_that_kept_states_rely_on() {
        let p = |x: f64, y: f64| Point3::new(x, y, 0.0);
        let place = |i: u32, j: u32| p(f64::from(i), f64::from(j));
        let points: Vec<_> = (0..13).flat_map(|i| (0..13).map(move |j| place(i, j))).collect();
        let square = |i: u32, j: u32| {
            let a = i * 13 + j;
            [[a, a + 13, a + 14], [a, a + 14, a + 1]]
        };
        let triangles: Vec<_> = (0..12).flat_map(|i| (0..12).flat_map(move |j| square(i, j))).collect();
        let built = || Mesh::new(&points, &triangles).unwrap();
        let named = |points: &[Point3<f64>], triangles: &[[u32; 3]]| Mesh::new(points, triangles).unwrap();
        let mesh = built();
        assert_eq!(mesh.fingerprint, built().fingerprint);

        // Positions, and the scale of coordinates.
        let moved: Vec<_> = points.iter().map(|q| p(q.x, q.y + 1.0)).collect();
        let larger: Vec<_> = points.iter().map(|q| q * power(210)).collect();
        // Indices of vertices and of triangles: the same body in the same tree.
        let last = points.len() as u32 - 1;
        let back: Vec<_> = points.iter().rev().copied().collect();
        let of_back: Vec<_> = triangles.iter().map(|t| t.map(|v| last - v)).collect();
        let mut exchanged = triangles.clone();
        exchanged.swap(0, 100);
        let turned: Vec<_> = triangles.iter().map(|t| [t[1], t[2], t[0]]).collect();
        // Trees: rebuilt by a call after the vertices have returned, and rebuilt by the mesh.
        let mut rebuilt = built();
        rebuilt.set_vertices(&moved).unwrap();
        rebuilt.set_vertices(&points).unwrap();
        let returned = rebuilt.clone();
        rebuilt.rebuild();
        let mut by_itself = returned.clone();
        let new = InTreeOrder::with_new_top(&by_itself.tree, &by_itself.points, &by_itself.triangles);
        by_itself.take_tree(*b"new top ", new);

        let all = [
            mesh,
            named(&moved, &triangles),
            named(&larger, &triangles),
            named(&back, &of_back),
            named(&points, &exchanged),
            named(&points, &turned),
            built().with_points_off(1e-12),
            returned,
            rebuilt,
            by_itself,
        ];
        for (k, one) in all.iter().enumerate() {
            let patches = ConvexPatches::from_mesh(one.clone());
            assert!(patches.are_of(one));
            for (j, other) in all[..k].iter().enumerate() {
                assert!(
                    one.fingerprint != other.fingerprint && !patches.are_of(other),
                    "{j} {k}"
                );
            }
        }
    }

    /// Links of the tree do not follow from the list of triangles.
    #[test]
    fn fingerprints_are_of_the_links_of_the_tree() {
        let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|[x, y]| Point3::new(x, y, 0.0));
        let triangles = [[0, 1, 2], [1, 3, 2]];
        let mut mesh = Mesh::new(&points, &triangles).unwrap();
        let before = mesh.fingerprint_as_built();
        mesh.tree.set_link(0, 1);
        assert_ne!(before, mesh.fingerprint_as_built());
    }

    fn power(exponent: i32) -> f64 {
        crate::body::polyhedron::power_of_two(exponent)
    }

    /// Calls that move no vertex change neither the tree nor the time of its next rebuild.
    #[test]
    fn calls_that_move_nothing_are_not_counted() {
        let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|[x, y]| Point3::new(x, y, 0.0));
        let mut mesh = Mesh::new(&points, &[[0, 1, 2], [1, 3, 2]]).unwrap();
        let fold = |z: f64| points.map(|p| Point3::new(p.x, p.y, z * p.x * p.y));
        mesh.set_vertices(&fold(0.5)).unwrap();
        let (mut quiet, mut busy) = (mesh.clone(), mesh);
        for _ in 0..100 {
            busy.set_vertices(&fold(0.5)).unwrap();
        }
        for z in [0.7, -0.5, 0.2, -0.9] {
            quiet.set_vertices(&fold(z)).unwrap();
            busy.set_vertices(&fold(z)).unwrap();
            assert!(quiet.fingerprint == busy.fingerprint && quiet.tree == busy.tree);
        }
    }
}

//! The volume that two geometries share, and the curves in which their surfaces cross.

use alloc::boxed::Box;
use alloc::vec::Vec;

use super::tracker::PairTracker;
use crate::base::num::fingerprint::Fingerprint;
use crate::base::num::sort::sort;
use crate::base::pose::{Operand, RelativePose};
use crate::body::polyhedron::ConvexPolyhedron;
use crate::body::shape::Core;
use crate::nonconvex::mesh::{Mesh, MeshKind};
use crate::nonconvex::pieces::{Compound, Piece};
use crate::nonconvex::volume::{self, OverlapLoops, OverlapVolume};
use crate::pair_tracker::geometry::{Borrowed, GeometryKind, GeometryRef};

/// Error returned if two geometries share no volume that can be computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum OverlapError {
    /// A geometry is not bounded by triangles, or has no inside.
    #[error("the volume of {body} is unknown: it is a {kind} (expected polyhedra or a closed mesh)")]
    Kind {
        /// The body.
        body: Operand,
        /// Its kind.
        kind: GeometryKind,
    },
    /// A mesh is not closed. [`Mesh::repaired`] closes it.
    #[error("the volume of {body} is unknown: its mesh is open (expected a closed mesh)")]
    Open {
        /// The body.
        body: Operand,
    },
    /// A piece of a compound is rounded or curved, or has no volume.
    #[error("the volume of {body} is unknown: piece {piece} is flat, rounded or curved")]
    Piece {
        /// The body.
        body: Operand,
        /// Index of the piece.
        piece: usize,
    },
    /// Two pieces of a compound overlap, so that volumes of pieces do not add up.
    #[error("the volume of {body} is unknown: pieces {} and {} overlap", .pieces[0], .pieces[1])]
    Pieces {
        /// The body.
        body: Operand,
        /// Indices of the pieces.
        pieces: [usize; 2],
    },
    /// One body is far below the rounding of the other, so that no curve is known.
    #[error("the curves of A and B are unknown: one is far below the rounding of the other")]
    OutOfRange,
}

/// A mesh that has the surface of a polyhedron or of a compound.
#[derive(Clone, Debug)]
pub(super) struct ConvertedSolid {
    of: Fingerprint,
    mesh: Mesh,
    /// The face or the piece of each triangle, by the triangle's number.
    numbers: Vec<u32>,
    /// The largest volume that pieces may share, because their vertices are rounded.
    shared: f64,
}

impl ConvertedSolid {
    fn of_polyhedron(body: &ConvexPolyhedron) -> Option<Self> {
        let triangles = |face| body.face_vertices(face).count().saturating_sub(2);
        let numbers = body
            .faces()
            .flat_map(|f| core::iter::repeat_n(f.index() as u32, triangles(f)));
        Some(Self {
            of: body.fingerprint,
            mesh: Mesh::from_convex(body).ok()?,
            numbers: numbers.collect(),
            shared: 0.0,
        })
    }

    fn of_compound(compound: &Compound, body: Operand) -> Result<Self, OverlapError> {
        let refused = |piece| OverlapError::Piece { body, piece };
        let (mut meshes, mut numbers) = (Vec::new(), Vec::new());
        for (k, piece) in compound.pieces().iter().enumerate() {
            let (mesh, triangles) = of_piece(piece).ok_or(refused(k))?;
            meshes.push(mesh);
            numbers.extend(core::iter::repeat_n(k as u32, triangles));
        }
        let shared = shared(&meshes, body)?;
        Ok(Self {
            of: compound.recognised(),
            mesh: compound.surface_mesh().ok_or(refused(0))?,
            numbers,
            shared,
        })
    }
}

/// Returns the surface of a piece in the frame of its compound, and its number of triangles.
fn of_piece(piece: &Piece) -> Option<(Mesh, usize)> {
    let Core::Polyhedron(body) = piece.shape.core() else {
        return None;
    };
    let mesh = Compound::new(alloc::vec![piece.clone()]).ok()?.surface_mesh()?;
    Some((mesh, body.triangles().count()))
}

/// Returns the largest volume that pieces may share by rounding.
///
/// Returns an error if two pieces certainly share a volume.
fn shared(meshes: &[Mesh], body: Operand) -> Result<f64, OverlapError> {
    let boxes: Vec<_> = meshes.iter().map(Mesh::aabb).collect();
    let mut order: Vec<usize> = (0..meshes.len()).collect();
    sort(&mut order, |&i, &j| boxes[i].0.x.total_cmp(&boxes[j].0.x));
    let (pose, mut sum) = (RelativePose::identity(), 0.0);
    for (at, &i) in order.iter().enumerate() {
        let (low, high) = &boxes[i];
        for &j in order[at + 1..].iter().take_while(|j| boxes[**j].0.x <= high.x) {
            if (0..3).all(|k| low[k] <= boxes[j].1[k] && boxes[j].0[k] <= high[k]) {
                let found = volume::overlap(&meshes[i], &meshes[j], &pose, 0.0);
                if found.lower > 0.0 {
                    let pieces = [i.min(j), i.max(j)];
                    return Err(OverlapError::Pieces { body, pieces });
                }
                sum += found.upper;
            }
        }
    }
    Ok(sum)
}

/// A closed surface of triangles that a geometry has.
struct Solid<'s> {
    mesh: &'s Mesh,
    copy: Option<&'s ConvertedSolid>,
}

impl<'s> Solid<'s> {
    /// Returns the surface of a geometry, converted if it is not the one that is cached.
    fn new(
        cached: &'s mut Option<Box<ConvertedSolid>>,
        own: GeometryRef<'s>,
        body: Operand,
    ) -> Result<Self, OverlapError> {
        let refused = OverlapError::Kind { body, kind: own.kind() };
        if let Borrowed::Mesh(mesh) = own.0 {
            let mesh = mesh.get();
            return match mesh.kind() {
                MeshKind::Solid => Ok(Self { mesh, copy: None }),
                MeshKind::Open => Err(OverlapError::Open { body }),
            };
        }
        if cached.as_ref().is_none_or(|kept| kept.of != own.fingerprint()) {
            let made = match own.0 {
                Borrowed::Polyhedron(body) => ConvertedSolid::of_polyhedron(body.get()).ok_or(refused)?,
                Borrowed::Compound(compound) => ConvertedSolid::of_compound(compound.get(), body)?,
                _ => return Err(refused),
            };
            *cached = Some(Box::new(made));
        }
        let copy = cached.as_deref();
        let mesh = &copy.ok_or(refused)?.mesh;
        Ok(Self { mesh, copy })
    }

    /// Returns the largest volume that pieces may share.
    fn shared(&self) -> f64 {
        self.copy.map_or(0.0, |kept| kept.shared)
    }
}

impl PairTracker {
    /// Returns the two surfaces of a pair.
    fn solids<'s>(&'s mut self, [a, b]: [GeometryRef<'s>; 2]) -> Result<[Solid<'s>; 2], OverlapError> {
        let [x, y] = &mut self.solids;
        Ok([Solid::new(x, a, Operand::A)?, Solid::new(y, b, Operand::B)?])
    }

    /// Returns bounds of the volume that two solids share, and its centre of mass.
    ///
    /// The solids are polyhedra, closed meshes, and compounds of polyhedra that do not overlap each
    /// other. The bounds hold for the exact pose and for all ties: equal bodies, flush faces, edges
    /// on edges.
    ///
    /// **Width**: if the pose puts B's vertices into A's frame without rounding, the bounds are a
    /// few roundings apart, and at most `1e-9` of a volume above `1e-12 L^3` (feature `exact`).
    /// Otherwise each vertex is rounded once. This adds up to `4e-16 L` times the area of B's
    /// surface in the common box to each bound, which matters for shallow overlaps of large faces.
    ///
    /// **Bodies that share no volume** may still touch: [`intersects`](Self::intersects) decides
    /// that, exactly. Bounds around zero do not.
    ///
    /// **Points that a body covers twice** count twice, and points with a negative winding number
    /// count negative. [`OverlapVolume::covers_itself`] reports such bodies. Faces of a polyhedron
    /// are taken as their [`triangles`](crate::ConvexPolyhedron::triangles).
    ///
    /// **Cost**: time in proportion to the triangles near the other body, and about 1 µs for each
    /// edge that passes through a face. A polyhedron or a compound is converted to a mesh in the
    /// first query, once per tracker.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny::{Mesh, PairTracker, RelativePose};
    ///
    /// let half = Vector3::new(1.0, 1.0, 1.0);
    /// let die = solids::cuboid(half)?;
    /// let block = Mesh::from_convex(&die)?;
    /// let mut tracker = PairTracker::new();
    /// let pose = Isometry3::translation(0.5, 1.0, 0.0);
    /// let pose = RelativePose::from_isometry(&pose)?;
    /// let shared = tracker.overlap(&die, &block, &pose)?;
    /// assert!(shared.lower <= 3.0 && 3.0 <= shared.upper);
    /// assert!(shared.upper - shared.lower < 1e-14);
    /// let centre = shared.centroid.expect("a volume");
    /// assert!((centre.coords - Vector3::new(0.25, 0.5, 0.0)).norm() < 1e-14);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error that names the body if it is rounded, curved, a cloud, a surface, a
    /// half-space, a point, a segment or an open mesh, and if pieces of a compound overlap each
    /// other, are rounded or curved, or have no volume.
    #[doc(alias = "intersection volume")]
    #[doc(alias = "boolean")]
    #[doc(alias = "interference")]
    pub fn overlap<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
    ) -> Result<OverlapVolume, OverlapError> {
        let bodies = [a.into(), b.into()];
        let [a, b] = self.solids(bodies)?;
        let found = volume::overlap(a.mesh, b.mesh, a_from_b, a.shared() + b.shared());
        // Polyhedra, and pieces that do not overlap, cover no point twice.
        let may_cover = a.copy.is_none() || b.copy.is_none();
        Ok(OverlapVolume {
            covers_itself: found.covers_itself && may_cover,
            ..found
        })
    }

    /// Returns the curves in which the surfaces of two solids cross, and the area of each face
    /// inside the other solid.
    ///
    /// The solids are those of [`overlap`](Self::overlap). The curves are closed polylines in A's
    /// frame. They and the areas are right up to rounding, and do not depend continuously on the
    /// pose; see [`OverlapLoops`].
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny::{PairTracker, RelativePose};
    ///
    /// let table = solids::cuboid(Vector3::new(2.0, 2.0, 1.0))?;
    /// let post = solids::cuboid(Vector3::new(0.5, 0.5, 3.0))?;
    /// let pose = Isometry3::translation(0.2, 0.3, 3.5);
    /// let pose = RelativePose::from_isometry(&pose)?;
    /// let mut tracker = PairTracker::new();
    /// let found = tracker.overlap_loops(&table, &post, &pose)?;
    /// // The post meets the upper face of the table in a square.
    /// let [square] = &found.loops[..] else { panic!() };
    /// assert!(square.iter().all(|p| p.z == 1.0));
    /// let area: f64 = found.shares[0].iter().map(|x| x.area).sum();
    /// assert!((area - 1.0).abs() < 1e-14);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns the errors of [`overlap`](Self::overlap), and [`OverlapError::OutOfRange`] if one
    /// body is more than `2^190` times as large as the other.
    #[doc(alias = "intersection curve")]
    pub fn overlap_loops<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
    ) -> Result<OverlapLoops, OverlapError> {
        let bodies = [a.into(), b.into()];
        let solids = self.solids(bodies)?;
        let [a, b] = &solids;
        let mut found = volume::overlap_loops(a.mesh, b.mesh, a_from_b).ok_or(OverlapError::OutOfRange)?;
        for (solid, shares) in solids.iter().zip(&mut found.shares) {
            if let Some(copy) = solid.copy {
                for share in shares.iter_mut() {
                    share.face = copy.numbers.get(share.face as usize).copied().unwrap_or(share.face);
                }
                *shares = volume::merged(core::mem::take(shares));
            }
        }
        Ok(found)
    }
}

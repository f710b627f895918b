//! Manifolds of meshes, and shapes of parry as geometries.

use lin_canny::nalgebra::{Isometry3, Point3};
use lin_canny::{
    Compound, ContactGroup, ContactPoint, ConvexPatches, Feature, Geometry, ManifoldOptions, Mesh, PairTracker, Piece,
    RelativePose,
};

use super::contact::ContactOptions;
use super::known::Known;
use super::mesh_shape::mesh;
use super::number::{isometry, narrow, wide_point};
use super::parry::math::{Pose, Real, Vector};
use super::parry::query::details::{TypedWorkspaceData, WorkspaceData};
use super::parry::query::{Contact, ContactManifold, ContactManifoldsWorkspace, TrackedContact};
use super::parry::shape::{PackedFeatureId, Shape};
use super::part;

/// The state that an engine keeps for a pair with a mesh.
///
/// rapier uses it to find the manifolds of the pair again. The tracker recognises its bodies: with
/// other shapes it starts cold.
#[derive(Clone, Default)]
struct MeshPair(PairTracker);

impl WorkspaceData for MeshPair {
    fn as_typed_workspace_data(&self) -> TypedWorkspaceData<'_> {
        TypedWorkspaceData::Custom
    }

    fn clone_dyn(&self) -> Box<dyn WorkspaceData> {
        Box::new(self.clone())
    }
}

/// Returns the patches of a mesh, or of a convex shape or compound in the frame of the engine's
/// shape.
fn patches(known: &Known, shape: &dyn Shape) -> Option<ConvexPatches> {
    if let Some(mesh) = mesh(shape) {
        return Some(mesh.patches.clone());
    }
    Some(ConvexPatches::from_compound(compound(known, shape)?))
}

/// Returns a compound, or a convex shape as its only piece, in the frame of the engine's shape.
fn compound(known: &Known, shape: &dyn Shape) -> Option<Compound> {
    let piece = |shape: &dyn Shape, at: &Pose| {
        let placed = part::one(known, shape)?;
        let mut piece = Piece::new(placed.convex()?);
        piece.pose = isometry(at) * placed.at;
        Some(piece)
    };
    let pieces: Option<Vec<_>> = match shape.as_compound() {
        Some(compound) => compound.shapes().iter().map(|(at, part)| piece(&**part, at)).collect(),
        None => piece(shape, &Pose::IDENTITY).map(|piece| vec![piece]),
    };
    Compound::new(pieces?).ok()
}

/// Returns a shape of parry as a geometry of [`lin_canny`], and its pose in the frame of the shape.
///
/// Use it for trackers and scenes with the shapes of an engine. Returns `None` for half-spaces,
/// voxels, custom shapes other than [`Hull`](super::Hull) and [`MeshShape`](super::MeshShape), and
/// shapes with numbers that are out of range for [`lin_canny`].
///
/// ```
/// use lin_canny_parry::lin_canny::{PairTracker, RelativePose};
/// use lin_canny_parry::single::{geometry, parry};
/// use parry::shape::{Ball, Cylinder};
///
/// let (can, at) = geometry(&Cylinder::new(0.5, 0.2)).unwrap();
/// let (ball, _) = geometry(&Ball::new(0.1)).unwrap();
/// // The axis is y in parry and z in lin-canny.
/// let above = lin_canny_parry::lin_canny::nalgebra::Isometry3::translation(0.0, 1.0, 0.0);
/// let gap = PairTracker::new().closest(&can, &ball, &RelativePose::new(&at, &above)?).distance;
/// assert!((gap - 0.4).abs() < 1e-7);
/// # Ok::<(), lin_canny_parry::lin_canny::PoseError>(())
/// ```
#[must_use]
pub fn geometry(shape: &dyn Shape) -> Option<(Geometry, Isometry3<f64>)> {
    let (known, own) = (Known::default(), Isometry3::identity());
    let of_triangles = |points: &[Vector], triangles: &[[u32; 3]]| {
        let points: Vec<Point3<f64>> = points.iter().map(|&p| wide_point(p)).collect();
        Some((Geometry::from(Mesh::new(&points, triangles).ok()?), own))
    };
    if let Some(mesh) = shape.as_trimesh() {
        return of_triangles(mesh.vertices(), mesh.indices());
    }
    if let Some(field) = shape.as_heightfield() {
        let (points, triangles) = field.to_trimesh();
        return of_triangles(&points, &triangles);
    }
    if shape.as_compound().is_some() {
        return Some((compound(&known, shape)?.into(), own));
    }
    let placed = part::one(&known, shape)?;
    Some((placed.shape, placed.at))
}

/// Returns the deepest contact of two shapes, one of which is a mesh.
pub(super) fn deepest(
    known: &Known,
    pos12: &Pose,
    shapes: (&dyn Shape, &dyn Shape),
    prediction: Real,
    options: &ContactOptions,
) -> Option<Contact> {
    let mut found: Vec<ContactManifold<(), ()>> = Vec::new();
    write(known, pos12, shapes, prediction, options, (&mut found, &mut None));
    let points = found.iter().flat_map(|m| m.points.iter().map(move |p| (m, p)));
    let (m, p) = points.min_by(|x, y| x.1.dist.total_cmp(&y.1.dist))?;
    Some(Contact::new(p.local_p1, p.local_p2, m.local_n1, m.local_n2, p.dist))
}

/// Writes the manifolds of two shapes, one of which is a mesh: one manifold per direction of
/// contact.
///
/// Contacts that existed before keep their data. Returns false, with nothing written, if
/// [`lin_canny`] does not support a shape or the pose is not finite.
pub(super) fn write<M: Default, C: Default + Copy>(
    known: &Known,
    pos12: &Pose,
    (a, b): (&dyn Shape, &dyn Shape),
    prediction: Real,
    options: &ContactOptions,
    (out, state): (&mut Vec<ContactManifold<M, C>>, &mut Option<ContactManifoldsWorkspace>),
) -> bool {
    if mesh(a).is_none() && mesh(b).is_none() {
        return false;
    }
    let turned = isometry(pos12);
    let (Some(of_a), Some(of_b), Ok(at)) = (
        patches(known, a),
        patches(known, b),
        RelativePose::from_isometry(&turned),
    ) else {
        return false;
    };
    let mut chosen =
        ManifoldOptions::default().prediction(f64::from(prediction) * f64::from(options.prediction_factor));
    (chosen.max_face_sine, chosen.max_points) = (f64::from(options.max_face_sine), options.max_points);
    let mut pair = state
        .take()
        .and_then(|state| state.0.downcast::<MeshPair>().ok())
        .unwrap_or_default();
    let found = pair.0.contacts_between(&of_a, &of_b, &at, &chosen);
    let kept: Vec<TrackedContact<C>> = out.drain(..).flat_map(|m| m.points).collect();
    out.extend(found.iter().map(|group| {
        let mut manifold = manifold(group);
        let normal = group.normal.into_inner();
        manifold.local_n1 = narrow(&normal);
        manifold.local_n2 = narrow(&-turned.rotation.inverse_transform_vector(&normal));
        manifold.match_contacts(&kept);
        manifold
    }));
    *state = Some(ContactManifoldsWorkspace(pair));
    true
}

fn manifold<M: Default, C: Default + Copy>(group: &ContactGroup) -> ContactManifold<M, C> {
    let mut manifold = ContactManifold::new();
    manifold.points.extend(group.contacts.iter().map(|contact| {
        let ContactPoint {
            point_on_a,
            point_on_b,
            separation,
            id,
            ..
        } = contact.point;
        let name = |patch: u32, feature: Feature| {
            let word = (u64::from(patch) << 32 | feature.index() as u64) * 3 + feature.dimension() as u64;
            // Ids of parry have 30 bits. If two contacts share an id, the solver loses a warm
            // start.
            PackedFeatureId::face((word.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 34) as u32)
        };
        TrackedContact::new(
            narrow(&point_on_a.coords),
            narrow(&point_on_b.coords),
            name(contact.patches[0], id.a),
            name(contact.patches[1], id.b),
            separation as Real,
        )
    }));
    manifold
}

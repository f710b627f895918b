//! A mesh over a frame: its vertices at both ends and its positions in between.

use alloc::borrow::Cow;
use alloc::vec::Vec;
use nalgebra::{Isometry3, Matrix3, Point3, UnitQuaternion, Vector3};

use super::paths::{VertexPath, place};
use crate::base::motion::{Motion, MotionError, Steady, length};
use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::pose::RelativePose;
use crate::base::tolerance::UNIT;
use crate::nonconvex::mesh::Mesh;
use crate::nonconvex::parts::Parted;
use crate::nonconvex::tree::Below;
use crate::nonconvex::tree::height;
use crate::time::impact::ImpactError;

/// The rotation and the position of a mesh at a time of a frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moment {
    pub(super) time: f64,
    rotation: Matrix3<f64>,
    place: Vector3<f64>,
}

impl Moment {
    fn new(time: f64, pose: &Isometry3<f64>) -> Self {
        let rotation = *pose.rotation.to_rotation_matrix().matrix();
        let place = pose.translation.vector;
        Self { time, rotation, place }
    }
}

/// A mesh from the start of a frame to its end.
///
/// It is the input of [`cast_meshes`](super::cast_meshes) and [`cast_self`](super::cast_self). The
/// triangles stay the same, and each vertex moves on a straight path at constant velocity in the
/// frame of the mesh. The mesh is at rest in that frame unless [`with_poses`](Self::with_poses)
/// sets its poses.
#[derive(Clone, Debug)]
pub struct MovingMesh<'a> {
    /// The mesh at both ends. Both have the same tree layout.
    meshes: [Cow<'a, Mesh>; 2],
    poses: [Isometry3<f64>; 2],
    pub(super) ends: [Moment; 2],
    /// The motion of the mesh, if it rotates.
    motion: Option<Steady>,
}

impl<'a> MovingMesh<'a> {
    /// Returns a moving mesh, from the mesh at the start and at the end of the frame.
    ///
    /// The first is a clone from before [`set_vertices`](Mesh::set_vertices), the second the mesh
    /// after it. Both are the same mesh for a body that does not deform.
    ///
    /// If parts of the tree were rebuilt in between, this call makes a mesh with the vertices of
    /// the start in the tree of the end. This takes as long as replacing all vertices a few times.
    ///
    /// # Errors
    /// Returns [`ImpactError::Mesh`] if the two do not have the same triangles and vertices.
    pub fn new(begin: &'a Mesh, end: &'a Mesh) -> Result<Self, ImpactError> {
        let is_same = begin.triangles == end.triangles
            && begin.source_triangles == end.source_triangles
            && begin.source_points == end.source_points
            && begin.tree.is_laid_out_as(&end.tree);
        let begin = if is_same {
            Cow::Borrowed(begin)
        } else {
            Cow::Owned(end.as_before(begin).ok_or(ImpactError::Mesh)?)
        };
        let here = Isometry3::identity();
        Ok(Self {
            meshes: [begin, Cow::Borrowed(end)],
            poses: [here; 2],
            ends: [Moment::new(0.0, &here), Moment::new(1.0, &here)],
            motion: None,
        })
    }

    /// Returns the mesh at both ends.
    pub(super) fn both(&self) -> [&Mesh; 2] {
        [&self.meshes[0], &self.meshes[1]]
    }

    /// Moves the mesh from one pose to another at constant linear and angular velocity.
    ///
    /// The origin of the mesh moves on a straight path. The rotation is about one axis, by the
    /// smaller of the two angles ([`Steady::between`](crate::motion::Steady::between)).
    ///
    /// If the mesh does not rotate, positions at both ends are rounded, by about 1e-15 of their
    /// size, and vertices are on straight paths between these positions. If the mesh rotates, its
    /// points move on arcs, and proofs hold for the motion itself, rounding included. So a contact
    /// in which no surface passes through the other is reported as
    /// [`Undecided`](crate::impact::Impact::Undecided).
    ///
    /// # Errors
    /// Returns an error if [`RelativePose::new`](crate::RelativePose::new) rejects a pose.
    pub fn with_poses(self, begin: &Isometry3<f64>, end: &Isometry3<f64>) -> Result<Self, ImpactError> {
        for pose in [begin, end] {
            RelativePose::from_isometry(pose)?;
        }
        self.posed([*begin, *end])
    }

    /// Returns the mesh at other poses.
    ///
    /// If the mesh rotates, the motion is made from the poses as given. If they were rounded once
    /// more, a rotation by 180° could change its direction.
    fn posed(self, poses: [Isometry3<f64>; 2]) -> Result<Self, ImpactError> {
        let unit = |pose: &Isometry3<f64>| {
            let rotation = UnitQuaternion::new_normalize(pose.rotation.into_inner());
            Isometry3::from_parts(pose.translation, rotation)
        };
        let [begin, end] = [unit(&poses[0]), unit(&poses[1])];
        let (p, q) = (begin.rotation.coords, end.rotation.coords);
        let motion = if p == q || p == -q {
            None
        } else {
            Some(Steady::between(&poses[0], &poses[1], 1.0, Point3::origin()).map_err(refused)?)
        };
        let ends = match &motion {
            None => [Moment::new(0.0, &begin), Moment::new(1.0, &end)],
            Some(motion) => [0.0, 1.0].each(|time| Moment::new(time, &motion.pose(time))),
        };
        let meshes = self.meshes;
        Ok(Self {
            meshes,
            poses,
            ends,
            motion,
        })
    }

    /// Returns both meshes relative to the position of the first at the start, and this position.
    ///
    /// The axes stay parallel to those of the world. Far from the origin of the world this reduces
    /// the rounding of positions.
    pub(super) fn beside(a: &Self, b: &Self) -> Result<([Self; 2], Vector3<f64>), ImpactError> {
        let origin = a.poses[0].translation.vector;
        let seen = |of: &Self| {
            let shifted = of.poses.each(|pose| {
                let place = pose.translation.vector - origin;
                Isometry3::from_parts(place.into(), pose.rotation)
            });
            of.clone().posed(shifted)
        };
        Ok(([seen(a)?, seen(b)?], origin))
    }

    /// Returns whether vertices are on straight paths.
    pub(super) fn is_straight(&self) -> bool {
        self.motion.is_none()
    }

    /// Returns the pose of the mesh at a time.
    pub(super) fn moment(&self, time: f64) -> Moment {
        match &self.motion {
            Some(motion) => Moment::new(time, &motion.pose(time)),
            None if time == 0.0 => self.ends[0],
            None => Moment {
                time,
                rotation: self.ends[0].rotation,
                place: place(&self.ends.each(|end| end.place), time),
            },
        }
    }

    /// Returns the position of a vertex in the frame of the mesh.
    fn own(&self, vertex: u32, time: f64) -> Vector3<f64> {
        let [begin, end] = self.both();
        let at = |mesh: &Mesh| mesh.given(&mesh.points[vertex as usize]).coords;
        match time {
            0.0 => at(begin),
            1.0 => at(end),
            _ => place(&[at(begin), at(end)], time),
        }
    }

    fn point(&self, vertex: u32, moment: &Moment) -> Point3<f64> {
        Point3::from(moment.rotation * self.own(vertex, moment.time) + moment.place)
    }

    /// Returns the vertices of a triangle at a time.
    pub(super) fn corners(&self, triangle: u32, moment: &Moment) -> [Point3<f64>; 3] {
        self.meshes[0].triangles[triangle as usize].each(|v| self.point(v, moment))
    }

    /// Returns the paths of the vertices of a triangle between two times.
    pub(super) fn paths(&self, triangle: u32, [from, to]: [&Moment; 2]) -> [VertexPath; 3] {
        let (from, to) = (self.corners(triangle, from), self.corners(triangle, to));
        [0, 1, 2].each(|k| VertexPath::new(from[k], to[k]))
    }

    /// Returns the paths of all vertices over the frame.
    pub(super) fn vertices(&self) -> Vec<VertexPath> {
        let count = self.meshes[0].points.len() as u32;
        let [from, to] = &self.ends;
        let path = |v| VertexPath::new(self.point(v, from), self.point(v, to));
        (0..count).map(path).collect()
    }

    pub(super) fn source(&self, triangle: u32) -> u32 {
        self.meshes[0].source_triangles[triangle as usize]
    }

    pub(super) fn below(&self, node: u32) -> Below {
        self.meshes[0].tree.below(node)
    }

    /// Returns an upper bound of the support value of the points below a node at a time.
    ///
    /// Between the ends, no point exceeds the support values at both ends, interpolated linearly in
    /// time.
    pub(super) fn height(&self, node: u32, n: &Vector3<f64>, moment: &Moment) -> f64 {
        let own = moment.rotation.tr_mul(n);
        let of = |mesh: &Mesh| height(&mesh.tree, node, &own) * mesh.unit() + own.dot(&mesh.frame.origin);
        let [begin, end] = self.both();
        let highest = match moment.time {
            1.0 => of(end),
            time if time == 0.0 || core::ptr::eq(begin, end) => of(begin),
            time => of(begin) * (1.0 - time) + of(end) * time,
        };
        highest + n.dot(&moment.place)
    }

    /// Returns the centre of the box of a node.
    pub(super) fn middle(&self, node: u32, moment: &Moment) -> Vector3<f64> {
        let of = |mesh: &Mesh| {
            let tree = &mesh.tree;
            let centre = tree.centre + tree.boxes[node as usize].centre() * tree.unit();
            mesh.given(&centre).coords
        };
        let own = match moment.time {
            0.0 => of(&self.meshes[0]),
            1.0 => of(&self.meshes[1]),
            time => place(&self.both().each(of), time),
        };
        moment.rotation * own + moment.place
    }

    /// Returns the axes of the box of a node in reverse order; before the end, the axes at the
    /// start.
    pub(super) fn axes(&self, node: u32, moment: &Moment) -> [Vector3<f64>; 3] {
        let mesh = &self.meshes[usize::from(moment.time == 1.0)];
        let b = &mesh.tree.boxes[node as usize];
        [2, 1, 0].each(|k| moment.rotation * b.axis(k))
    }

    /// Returns the largest distance of a vertex from the origin of the mesh's frame.
    pub(super) fn radius(&self) -> f64 {
        let [begin, end] = self.both().each(far);
        begin.larger(end)
    }

    /// Returns half the diagonal of the box of the mesh, or the radius if it is smaller.
    pub(super) fn half_size(&self) -> f64 {
        let [begin, end] = self.both().each(Parted::half_size);
        begin.larger(end)
    }

    /// Returns an upper bound of all coordinates of the points.
    pub(super) fn reach(&self) -> f64 {
        let [begin, end] = [0, 1].each(|k| {
            let mesh = &self.meshes[k];
            far(mesh) + self.ends[k].place.abs().sum()
        });
        begin.larger(end)
    }

    pub(super) fn radius_of(&self, node: u32) -> f64 {
        let mesh = &self.meshes[0];
        f64::from(mesh.tree.boxes[node as usize].radius()) * mesh.tree.unit() * mesh.unit()
    }

    /// Returns an upper bound of how far a vertex moves in the frame of the mesh.
    pub(super) fn bend(&self) -> f64 {
        let [begin, end] = self.both();
        if core::ptr::eq(begin, end) {
            return 0.0;
        }
        let both = begin.points.iter().zip(&end.points);
        let most = both.fold(0.0, |m: f64, (p, q)| m.larger((end.given(q) - begin.given(p)).amax()));
        // The length of a vector is at most the root of three times its largest coordinate.
        1.75 * most
    }

    /// Returns an upper bound of the distance of a point from the straight path between its ends.
    ///
    /// The bound is one eighth of the square of the time, which is one, times the acceleration. If
    /// a mesh of radius `r` about its origin rotates by `w` and its vertices move by up to `l` in
    /// its frame, the acceleration is at most `r w^2 + 2 l w`.
    pub(super) fn sagitta(&self, radius: f64, bend: f64) -> f64 {
        let Some(motion) = &self.motion else { return 0.0 };
        let angle = length(&motion.velocity().angular);
        0.125 * angle * (radius * angle + 2.0 * bend) * (1.0 + 16.0 * UNIT)
    }

    /// Returns the bound of [`sagitta`](Self::sagitta) for the vertices of a triangle.
    pub(super) fn sagitta_of(&self, triangle: u32) -> f64 {
        if self.is_straight() {
            return 0.0;
        }
        let mut most = (0.0f64, 0.0f64);
        for v in self.meshes[0].triangles[triangle as usize] {
            let [begin, end] = [0.0, 1.0].each(|time| self.own(v, time));
            most.0 = most.0.larger(length(&begin)).larger(length(&end));
            most.1 = most.1.larger(length(&(end - begin)));
        }
        self.sagitta(most.0, most.1)
    }
}

/// Returns an upper bound of the distance of a vertex from the origin of the mesh's frame.
fn far(mesh: &Mesh) -> f64 {
    let radius = mesh.radius * mesh.unit();
    if mesh.frame.is_at_origin() {
        return radius;
    }
    (radius + mesh.frame.origin.abs().sum()) * (1.0 + 4.0 * UNIT)
}

/// Returns the error for a motion that is rejected.
fn refused(error: MotionError) -> ImpactError {
    match error {
        MotionError::Pose(pose) => ImpactError::Pose(pose),
        MotionError::Value { value, .. } | MotionError::Size { value, .. } => {
            ImpactError::Size { what: "motion", value }
        }
    }
}

//! The contact points of a body on a half-space.
//!
//! Candidates are the points within the prediction that lie in a cone about the lowest point: as
//! flat over the plane as the largest accepted tilt of a face. Convex members contribute the
//! vertices of the face that carries the contact ([`HalfSpace::contacts`]), points of a flat round
//! face, or both ends of a generator; a mesh contributes its vertices. Of all candidates the
//! lowest is kept, and the farthest in sixteen directions; of these, the few that span the most
//! area.

use alloc::vec::Vec;
use nalgebra::{Isometry3, Matrix3, Unit, Vector3};

use super::{Above, Effort, Found, HalfSpacePair, PLANE};
use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::base::pose::{Operand, RelativePose};
use crate::base::tolerance::ACROSS;
use crate::body::polyhedron::{ConvexPolyhedron, Feature, FeaturePair, VertexId};
use crate::body::shape::{Core, Flat, Shape, Support, match_core};
use crate::convex::contact::{ContactCandidate, ContactPoint, HalfSpace, ManifoldOptions, reduce, tangents_of};
use crate::nonconvex::contact::{ContactGroup, PatchContact};
use crate::nonconvex::parts::{Parted, PartsRef};
use crate::nonconvex::top::each_above;
use crate::pair::draft::unit;

/// Directions in the plane, of any length; each stands for its opposite too.
const SPREAD: [[f64; 2]; 8] = [
    [1.0, 0.0],
    [2.0, 1.0],
    [1.0, 1.0],
    [1.0, 2.0],
    [0.0, 1.0],
    [-1.0, 2.0],
    [-1.0, 1.0],
    [-2.0, 1.0],
];

/// Points of a rim at multiples of 45 degrees, for a radius of one.
const RIM: [[f64; 2]; 8] = {
    let half = core::f64::consts::FRAC_1_SQRT_2;
    [
        [1.0, 0.0],
        [half, half],
        [0.0, 1.0],
        [-half, half],
        [-1.0, 0.0],
        [-half, -half],
        [0.0, -1.0],
        [half, -half],
    ]
};

/// A candidate: a point of the body, what it belongs to, and its place over the plane.
#[derive(Clone, Copy)]
struct Spot {
    on_body: Vector3<f64>,
    subshape: u32,
    feature: Feature,
    at: [f64; 2],
    height: f64,
}

/// The candidates of a body.
struct Spots<'a> {
    space: &'a HalfSpace,
    options: &'a ManifoldOptions,
    rotation: Matrix3<f64>,
    translation: Vector3<f64>,
    axes: [Vector3<f64>; 2],
    /// Rounding of a position.
    noise: f64,
    lowest: Spot,
    /// The farthest candidates in the directions of `SPREAD` and in the opposite directions.
    ends: [[Spot; 2]; SPREAD.len()],
}

impl Spots<'_> {
    fn spot(&self, on_body: Vector3<f64>, subshape: u32, feature: Feature) -> Spot {
        let at = self.rotation * on_body + self.translation;
        Spot {
            on_body,
            subshape,
            feature,
            at: self.axes.each(|axis| axis.dot(&at)),
            height: self.space.normal().dot(&at) - self.space.offset(),
        }
    }

    fn add(&mut self, on_body: Vector3<f64>, subshape: u32, feature: Feature) {
        let spot = self.spot(on_body, subshape, feature);
        let (lowest, [x, y]) = (&self.lowest, spot.at);
        let (dx, dy) = (x - lowest.at[0], y - lowest.at[1]);
        let rise = self.options.max_face_sine * sqrt(dx * dx + dy * dy) + self.noise;
        if !(spot.height <= self.options.prediction && spot.height - lowest.height <= rise) {
            return;
        }
        for (direction, ends) in SPREAD.iter().zip(&mut self.ends) {
            let along = |s: &Spot| direction[0] * s.at[0] + direction[1] * s.at[1];
            for (end, sign) in ends.iter_mut().zip([1.0, -1.0]) {
                let (new, old) = (sign * along(&spot), sign * along(end));
                if new > old || (new == old && spot.height < end.height) {
                    *end = spot;
                }
            }
        }
    }

    /// Adds the points of a convex shape at a pose in the body. `down` is the direction towards the
    /// half-space in the body's frame, and `level` the height along it of the plane.
    fn add_shape(&mut self, shape: &Shape, pose: &Isometry3<f64>, down: &Vector3<f64>, level: f64, subshape: u32) {
        let n = unit(&pose.rotation.inverse_transform_vector(down)).into_inner();
        let level = level - down.dot(&pose.translation.vector);
        let radius = shape.rounding_radius();
        let (rotation, translation) = (pose.rotation, pose.translation.vector);
        let in_body = |p: Vector3<f64>| rotation * (p + n * radius) + translation;
        let top = shape.top(&n);
        self.add(rotation * top.point + translation, subshape, top.feature);
        if let Core::Polyhedron(body) = shape.core() {
            let space = HalfSpace::at(&-n, radius - level);
            for (point, vertex) in corners_on(&space, body, self.options, radius) {
                self.add(in_body(point), subshape, Feature::Vertex(vertex));
            }
            return;
        }
        let flat = match_core!(shape.core(), _ => None, core => core.flat(&n));
        let is_cone = matches!(shape.core(), Core::Cone(_));
        match flat {
            Some(Flat::Disc(disc)) => {
                let tilt = sqrt(n.x * n.x + n.y * n.y);
                if !(tilt <= self.options.max_face_sine && n.z * disc.side > 0.0) {
                    return;
                }
                let first = if is_cone { 1 } else { 8 * u32::from(disc.side < 0.0) };
                for (k, [x, y]) in RIM.iter().enumerate() {
                    let point = Vector3::new(x * disc.radius, y * disc.radius, disc.z);
                    self.add(in_body(point), subshape, Feature::Vertex(VertexId(first + k as u32)));
                }
            }
            Some(Flat::Line(ends)) => {
                let side = ends[1] - ends[0];
                if n.dot(&side).abs() > self.options.max_face_sine * sqrt(side.norm_squared()) {
                    return;
                }
                for (branch, end) in (0..).zip(ends) {
                    let first = Feature::Vertex(VertexId(0));
                    let feature = match_core!(shape.core(), _ => first, core => core.feature(&[branch], &end));
                    self.add(in_body(end), subshape, feature);
                }
            }
            None => {}
        }
    }

    fn add_parts(&mut self, body: &PartsRef<'_>, down: &Vector3<f64>, level: f64) {
        let least = level - self.options.prediction - self.noise;
        each_above(body, down, least, |item| match body {
            PartsRef::Mesh(mesh) => {
                for (k, corner) in (0..).zip(mesh.corners(item)) {
                    self.add(
                        mesh.given(&corner).coords,
                        body.number(item),
                        Feature::Vertex(VertexId(k)),
                    );
                }
            }
            _ => {
                if let Some((shape, pose)) = body.part(item) {
                    self.add_shape(&shape, &pose, down, level, body.number(item));
                }
            }
        });
    }

    /// Returns the few candidates that become contacts, the lowest first.
    fn chosen(&self, radius: f64) -> Vec<Spot> {
        let mut spots = alloc::vec![self.lowest];
        for end in self.ends.as_flattened() {
            if spots.iter().all(|s| s.on_body != end.on_body) {
                spots.push(*end);
            }
        }
        let all: Vec<_> = spots.iter().map(|s| ContactCandidate::at(s.at, s.height)).collect();
        let merge = self.noise.larger(self.options.rebuild_motion * radius);
        let chosen = reduce(&all, 0, self.options.most(), merge, self.noise);
        chosen.all().iter().map(|&k| spots[k]).collect()
    }
}

/// Returns the vertices of a polyhedral core that carry a contact with a half-space, both in the
/// frame of the core. `radius` is the rounding radius, which the offset of the half-space includes.
fn corners_on(
    space: &HalfSpace,
    body: &ConvexPolyhedron,
    options: &ManifoldOptions,
    radius: f64,
) -> Vec<(Vector3<f64>, VertexId)> {
    let options = ManifoldOptions {
        prediction: options.prediction + ACROSS * radius,
        max_points: crate::convex::contact::MOST_POINTS,
        ..*options
    };
    let contacts = space.contacts(body, &RelativePose::identity(), &options);
    let corner = |c: &crate::convex::contact::HalfSpaceContact| (c.point_on_body.coords, c.vertex);
    contacts.points().iter().map(corner).collect()
}

impl HalfSpacePair<'_> {
    /// Returns the contact points of the body on the half-space within the prediction: one group,
    /// or none. Two half-spaces have no contacts.
    pub(crate) fn contacts(&self, a_from_b: &RelativePose, options: &ManifoldOptions) -> Vec<ContactGroup> {
        let pose = self.space_from_body(a_from_b);
        let n = self.space.normal().into_inner();
        let (rotation, translation) = (pose.rotation(), pose.translation());
        let down = unit(&-rotation.tr_mul(&n)).into_inner();
        let Found { top, location, .. } = self.body.top(&down, Effort::DEFAULT);
        let (size, _) = self.body.size();
        let noise = ACROSS * (size + translation.abs().sum() + self.space.offset().abs());
        let axes = tangents_of(&n);
        let at = rotation * top.point + translation;
        let lowest = Spot {
            on_body: top.point,
            subshape: location.subshape,
            feature: top.feature,
            at: axes.each(|axis| axis.dot(&at)),
            height: n.dot(&at) - self.space.offset(),
        };
        if matches!(self.body, Above::HalfSpace(_)) || !(lowest.height <= options.prediction) {
            return Vec::new();
        }
        let mut spots = Spots {
            space: self.space,
            options,
            rotation,
            translation,
            axes,
            noise,
            lowest,
            ends: [[lowest; 2]; SPREAD.len()],
        };
        // The height along `down` of the plane, in the body's frame.
        let level = n.dot(&translation) - self.space.offset();
        let still = Isometry3::identity();
        match &self.body {
            Above::Polyhedron(body) => {
                let space = HalfSpace::at(&-down, -level);
                for (point, vertex) in corners_on(&space, body, options, 0.0) {
                    spots.add(point, 0, Feature::Vertex(vertex));
                }
            }
            Above::Shape(shape) => spots.add_shape(shape, &still, &down, level, 0),
            Above::Parts(body) => spots.add_parts(body, &down, level),
            #[cfg(feature = "surfaces")]
            Above::Surface(_) => {}
            Above::HalfSpace(_) => {}
        }
        let normal = match self.order {
            Operand::A => self.space.normal(),
            Operand::B => Unit::new_unchecked(down),
        };
        let radius = self.body.ball().1;
        let contact = |spot: &Spot| {
            let at = rotation * spot.on_body + translation;
            let on_plane = (at - n * spot.height).into();
            let features = FeaturePair {
                a: PLANE,
                b: spot.feature,
            };
            let point = ContactPoint {
                point_on_a: on_plane,
                point_on_b: spot.on_body.into(),
                separation: spot.height,
                features,
                id: features,
            };
            let (point, patches) = match self.order {
                Operand::A => (point, [0, spot.subshape]),
                Operand::B => (point.swapped(), [spot.subshape, 0]),
            };
            PatchContact { patches, normal, point }
        };
        let contacts = spots.chosen(radius).iter().map(contact).collect();
        alloc::vec![ContactGroup { normal, contacts }]
    }
}

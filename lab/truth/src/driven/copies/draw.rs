//! Random pieces, and bodies with the convex parts whose union they are.

use super::Mix;
use crate::rng::Rng;
use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::shape::Core;
use lin_canny::surface::BezierSurface;
use lin_canny::{Compound, ConvexPolyhedron, Geometry, Mesh, Piece, Shape};

/// A convex part of a body, and its pose in the body.
pub(super) type Part = (Shape, Isometry3<f64>);

/// A body, and the parts whose union it is.
pub(super) struct Drawn {
    pub(super) geometry: Geometry,
    pub(super) parts: Vec<Part>,
    /// Whether all parts have the identity pose, so that the body rounds no point of a part.
    pub(super) is_in_place: bool,
    /// Whether all parts are polyhedra without a rounding radius.
    pub(super) is_sharp: bool,
    /// Whether the body is only a surface: a Bézier surface.
    pub(super) is_shell: bool,
    /// Bound of the distance of the body's points, and of intermediate results, from the origin.
    pub(super) reach: f64,
}

impl Drawn {
    fn new(geometry: Geometry, parts: Vec<Part>) -> Self {
        let reach = |(shape, pose): &Part| {
            let (centre, radius) = shape.bounding_ball();
            centre.coords.norm() + radius + pose.translation.vector.norm()
        };
        Self {
            geometry,
            is_in_place: parts.iter().all(|p| p.1 == Isometry3::identity()),
            is_sharp: parts.iter().all(|p| is_sharp(&p.0)),
            is_shell: false,
            reach: parts.iter().map(reach).fold(0.0, f64::max),
            parts,
        }
    }

    fn of_pieces(pieces: Vec<Piece>) -> Self {
        let body = Compound::new(pieces).expect("pieces");
        // Rotations as normalised by the compound.
        let parts = body.pieces().iter().map(|p| (p.shape.clone(), p.pose)).collect();
        Self::new(body.into(), parts)
    }
}

fn is_sharp(shape: &Shape) -> bool {
    matches!(shape.core(), Core::Polyhedron(_)) && shape.rounding_radius() == 0.0
}

/// Returns whether a part has a substantial volume.
pub(super) fn is_thick(shape: &Shape) -> bool {
    match shape.core() {
        Core::Polyhedron(body) if shape.rounding_radius() == 0.0 => body.face_count() > 2 && body.volume() > 1e-5,
        _ => true,
    }
}

pub(super) fn rotation(rng: &mut Rng) -> UnitQuaternion<f64> {
    let [w, x, y, z] = rng.quat();
    UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z))
}

fn cuboid(half: [f64; 3]) -> ConvexPolyhedron {
    solids::cuboid(Vector3::from(half)).expect("a cuboid")
}

/// Returns a shape about the origin, of one of seven size classes.
fn shape(measure: usize, rng: &mut Rng) -> ConvexPolyhedron {
    let long = rng.log_range(0.05, 0.8);
    let thin = rng.log_range(1e-24, 1e-6);
    match measure {
        0 => ConvexPolyhedron::point(Point3::from(rng.in_ball().map(|x| x * 0.1))).expect("a point"),
        1 => {
            let ends = [0; 2].map(|_| Point3::from(rng.in_ball().map(|x| x * long)));
            ConvexPolyhedron::segment(ends[0], ends[1]).expect("a segment")
        }
        2 => {
            let corner = |k: usize| {
                let (x, y) = ([1.0, -1.0, -0.7, 0.9][k], [0.8, 1.0, -1.0, -0.6][k]);
                Point3::new(x * long, y * long, 0.0)
            };
            let corners: Vec<_> = (0..3 + rng.below(2)).map(corner).collect();
            ConvexPolyhedron::polygon(&corners).expect("a polygon")
        }
        3 => cuboid([thin, thin * rng.range(0.5, 2.0), thin]),
        4 => cuboid([long, thin, thin * rng.range(0.5, 2.0)]),
        5 => cuboid([long, thin, long * rng.range(0.3, 1.0)]),
        _ if rng.chance(0.5) => cuboid([long, long * rng.range(0.2, 1.0), long * rng.range(0.2, 1.0)]),
        _ => solids::random_hull(6 + rng.below(4), Vector3::repeat(long), rng.bits()).expect("a hull"),
    }
}

/// Returns a compound of one to four pieces, with identity or random poses.
pub(super) fn compound(rng: &mut Rng, mix: &mut Mix) -> Drawn {
    let is_placed = rng.chance(0.7);
    let is_solid = rng.chance(0.3);
    let pieces: Vec<Piece> = (0..1 + rng.below(4))
        .map(|_| {
            let measure = if is_solid { 6 } else { rng.below(7) };
            mix.pieces[measure] += 1;
            let mut piece = Piece::new(shape(measure, rng));
            if is_placed {
                piece.pose.translation.vector = Vector3::from(rng.in_ball()) * 2.0;
                if rng.chance(0.7) {
                    piece.pose.rotation = rotation(rng);
                }
            } else if rng.chance(0.7) && measure < 3 {
                // Flat bodies can be shifted by moving their points, without losing their thinness.
                let shift = Vector3::new(0.25, -0.5, 0.75) * (1.0 + rng.below(3) as f64);
                piece = Piece::new(moved(&piece.shape, &shift));
            }
            piece
        })
        .collect();
    mix.placed += u64::from(is_placed);
    Drawn::of_pieces(pieces)
}

/// Returns a point, a segment or a polygon, shifted.
fn moved(shape: &Shape, shift: &Vector3<f64>) -> ConvexPolyhedron {
    let Core::Polyhedron(body) = shape.core() else {
        unreachable!("a polyhedron")
    };
    let points: Vec<_> = body.vertex_points().map(|p| p + shift).collect();
    match points.len() {
        1 => ConvexPolyhedron::point(points[0]),
        2 => ConvexPolyhedron::segment(points[0], points[1]),
        _ => ConvexPolyhedron::polygon(&points),
    }
    .expect("a flat body")
}

/// Returns a body of any kind.
pub(super) fn other(rng: &mut Rng, mix: &mut Mix) -> Drawn {
    let kind = match rng.below(32) {
        0..3 => 0,
        3..6 => 1,
        6..10 => 2,
        10..23 => 3,
        23..31 => 4,
        _ => 5,
    };
    mix.beside[kind] += 1;
    let at = Isometry3::identity();
    let half = Vector3::new(rng.range(0.1, 0.7), rng.range(0.1, 0.7), rng.range(0.1, 0.7));
    let hull = solids::random_hull(8, half, rng.bits()).expect("a hull");
    let die = cuboid(half.into());
    let convex = |shape: Shape| Drawn::new(shape.clone().into(), vec![(shape, at)]);
    match kind {
        0 => convex(hull.into()),
        1 => convex(Shape::from(die).rounded(0.07).expect("a rounded die")),
        2 => convex(
            match rng.below(4) {
                0 => Shape::ball(half.x),
                1 => Shape::capsule(half.x, half.y),
                2 => Shape::cylinder(half.x, half.y),
                _ => Shape::ellipsoid(half),
            }
            .expect("a shape"),
        ),
        3 if rng.chance(0.4) => {
            // Two solids in one mesh.
            let away = Vector3::new(1.5, 0.25, -0.5);
            let points: Vec<_> = die.vertex_points().map(|p| p + away).collect();
            let far = ConvexPolyhedron::from_points(&points).expect("a die");
            let both = [hull, far].map(Piece::new);
            let parts = both.iter().map(|p| (p.shape.clone(), at)).collect();
            let body = Compound::new(both.to_vec()).expect("pieces");
            Drawn::new(body.to_mesh().expect("a mesh").into(), parts)
        }
        3 => {
            let body = if rng.chance(0.5) { hull } else { die };
            Drawn::new(
                Mesh::from_convex(&body).expect("a mesh").into(),
                vec![(body.into(), at)],
            )
        }
        4 => compound(rng, mix),
        _ => Drawn {
            is_shell: true,
            ..Drawn::new(
                BezierSurface::from_convex(&die).expect("a surface").into(),
                vec![(die.into(), at)],
            )
        },
    }
}

//! Bodies of every kind that a scene accepts, and the distance of two of them without a scene.

use crate::soups::Soup;
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::shape::curved_kinds;
use lin_canny::surface::{BezierSurface, revolution};
use lin_canny::{Compound, ContactState, ConvexPolyhedron, Distance, Geometry, GeometryRef, Mesh, PairTracker, Piece};
use lin_canny::{QueryOptions, RelativePose, Shape, Tracker};

/// If a body is not a sharp polyhedron and its bounds are within this of a threshold, both answers
/// are accepted.
pub const TIE: f64 = 1e-7;

/// A body in the form of its trackers. Few are created, and none is moved often.
#[allow(clippy::large_enum_variant)]
pub enum Form {
    /// A sharp polyhedron, for which every predicate is exact.
    Sharp(ConvexPolyhedron),
    /// A convex shape, curved or rounded.
    Convex(Shape),
    /// A compound of convex pieces.
    Pieces(Compound),
    /// A triangle mesh.
    Mesh(Mesh),
    /// A Bézier surface.
    BezierSurface(BezierSurface),
}

impl Form {
    /// Returns whether the body is convex.
    pub fn is_convex(&self) -> bool {
        matches!(self, Self::Sharp(..) | Self::Convex(_))
    }

    fn borrowed(&self) -> GeometryRef<'_> {
        match self {
            Self::Sharp(body) => body.into(),
            Self::Convex(shape) => shape.into(),
            Self::Pieces(body) => body.into(),
            Self::Mesh(mesh) => mesh.into(),
            Self::BezierSurface(surface) => surface.into(),
        }
    }
}

fn sharp(body: ConvexPolyhedron) -> (Geometry, Form) {
    (body.clone().into(), Form::Sharp(body))
}

fn convex(shape: Shape) -> (Geometry, Form) {
    (shape.clone().into(), Form::Convex(shape))
}

fn cross() -> Compound {
    let rod = solids::cuboid(Vector3::new(0.1, 0.1, 0.6)).expect("a rod");
    let mut upright = Piece::new(rod.clone());
    upright.pose = Isometry3::new(Vector3::new(0.0, 0.4, 0.0), Vector3::x() * 1.5);
    Compound::new(vec![Piece::new(rod), upright]).expect("two rods")
}

/// Returns a sphere as eight rational octants.
pub fn sphere(r: f64) -> BezierSurface {
    let half = 0.5_f64.sqrt();
    let south: &[[f64; 3]] = &[[0.0, -r, 1.0], [r, -r, half], [r, 0.0, 1.0]];
    let north: &[[f64; 3]] = &[[r, 0.0, 1.0], [r, r, half], [0.0, r, 1.0]];
    revolution(&[south, north]).expect("a sphere")
}

/// Returns the mesh of a soup.
///
/// # Panics
/// Panics if the soup is not a valid mesh.
pub fn mesh(soup: &Soup) -> Mesh {
    let points: Vec<_> = soup.points.iter().map(|p| Point3::from(*p)).collect();
    Mesh::new(&points, &soup.triangles).expect("made meshes are sound")
}

/// Returns a convex shape of every kind in a box of these half lengths: ball, capsule, cuboid, hull
/// and rounded cuboid, then each curved kind, sharp and rounded.
pub fn shapes(half: [f64; 3]) -> Vec<Shape> {
    let half = Vector3::from(half);
    let radius = 0.25 * half.min();
    let inner = half.add_scalar(-radius);
    let rounded = |core: Shape| core.rounded(radius).expect("a rounded shape");
    let cuboid = |half| Shape::cuboid(half).expect("a cuboid");
    let mut all = vec![
        Shape::ball(half.min()).expect("a ball"),
        Shape::capsule(half.max() - 0.5 * half.min(), 0.5 * half.min()).expect("a capsule"),
        cuboid(half),
        Shape::from(solids::random_hull(60, half, 5).expect("a hull")),
        rounded(cuboid(inner)),
    ];
    all.extend(curved_kinds(half).into_iter().map(|(_, shape)| shape));
    all.extend(curved_kinds(inner).into_iter().map(|(_, shape)| rounded(shape)));
    all
}

/// Returns the bodies of a world.
///
/// By `kind`: 0 polyhedra alone, 1 curved shapes too, 2 meshes and compounds too, 3 surfaces and
/// compounds too.
pub fn forms(kind: usize) -> Vec<(Geometry, Form)> {
    let far = [-1.0, 1.0].map(|x| Point3::new(x + 3.0, 0.2, 0.3));
    let mut all = vec![
        sharp(solids::cuboid(Vector3::repeat(0.5)).expect("a cube")),
        sharp(solids::cuboid(Vector3::new(0.9, 0.9, 0.05)).expect("a plate")),
        sharp(solids::octahedron(0.7).expect("an octahedron")),
        sharp(solids::random_hull(14, Vector3::new(0.8, 0.5, 0.3), 3).expect("a hull")),
        sharp(ConvexPolyhedron::segment(far[0], far[1]).expect("a segment")),
        sharp(ConvexPolyhedron::point(Point3::new(0.1, 0.2, 0.3)).expect("a point")),
    ];
    if kind > 0 {
        all.push(convex(Shape::ball(0.4).expect("a ball")));
        all.push(convex(Shape::capsule(0.5, 0.1).expect("a capsule")));
        let cuboid = Shape::cuboid(Vector3::new(0.3, 0.2, 0.5)).expect("a cuboid");
        all.push(convex(cuboid.rounded(0.1).expect("a rounded cuboid")));
        let curved = curved_kinds(Vector3::new(0.5, 0.4, 0.3));
        all.extend(curved.into_iter().map(|(_, shape)| convex(shape)));
    }
    if kind > 1 {
        // Keeps fewer convex bodies, so that most pairs have a compound.
        all.drain(3..6);
        all.push((cross().into(), Form::Pieces(cross())));
    }
    if kind == 2 {
        let solid = Mesh::from_convex(&solids::icosahedron(0.6).expect("an icosahedron")).expect("a mesh");
        all.push((solid.clone().into(), Form::Mesh(solid)));
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.2], [1.0, 1.0, 0.5]].map(Point3::from);
        let sheet = Mesh::new(&corners, &[[0, 1, 2], [2, 1, 3]]).expect("a sheet");
        all.push((sheet.clone().into(), Form::Mesh(sheet)));
    }
    if kind == 3 {
        let shell = sphere(0.45);
        all.push((shell.clone().into(), Form::BezierSurface(shell)));
    }
    all
}

/// Returns the signed distance of two bodies by a new tracker.
pub fn distance(a: &Form, b: &Form, pose: &RelativePose) -> Distance {
    let narrow = QueryOptions::default().width(1e-9);
    Distance::from(&PairTracker::new().closest_with(a.borrowed(), b.borrowed(), pose, &narrow))
}

/// Returns whether two bodies are at most `d` apart; `None` if the bounds do not decide it.
pub fn within(a: &Form, b: &Form, pose: &RelativePose, d: f64) -> Option<bool> {
    if let (Form::Sharp(x), Form::Sharp(y)) = (a, b) {
        return Some(Tracker::new().within(x, y, pose, d));
    }
    let found = distance(a, b, pose);
    let is_proven = match (a, b) {
        (Form::BezierSurface(_), _) | (_, Form::BezierSurface(_)) => found.state == ContactState::Touching,
        _ => found.state == ContactState::Overlapping && !(a.is_convex() && b.is_convex()),
    };
    if is_proven || found.upper <= d - TIE {
        Some(true)
    } else if found.lower > d + TIE {
        Some(false)
    } else {
        None
    }
}

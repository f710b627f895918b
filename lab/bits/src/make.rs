//! Bodies, poses and motions from random numbers, by + - * / and square roots alone.

use crate::Random;
use lin_canny::motion::{Nlerp, Steady};
use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use lin_canny::shape::curved_kinds;
use lin_canny::surface::{BezierPatch, BezierSurface};
use lin_canny::{Compound, ConvexPolyhedron, Mesh, Piece, RelativePose, Shape, Velocity};

/// Returns a point of the unit ball, not too near its centre.
pub fn in_ball(r: &mut Random) -> Vector3<f64> {
    loop {
        let v = Vector3::new(r.range(-1.0, 1.0), r.range(-1.0, 1.0), r.range(-1.0, 1.0));
        let s = v.x * v.x + v.y * v.y + v.z * v.z;
        if s <= 1.0 && s > 1e-6 {
            return v;
        }
    }
}

/// Returns a unit vector.
pub fn unit(r: &mut Random) -> Vector3<f64> {
    let v = in_ball(r);
    v / (v.x * v.x + v.y * v.y + v.z * v.z).sqrt()
}

/// A turn by at most about twice `most` radians, evenly about all axes where `most` is large.
pub fn turn(r: &mut Random, most: f64) -> UnitQuaternion<f64> {
    let v = in_ball(r) * most;
    let n = (1.0 + v.x * v.x + v.y * v.y + v.z * v.z).sqrt();
    UnitQuaternion::new_unchecked(Quaternion::new(1.0 / n, v.x / n, v.y / n, v.z / n))
}

/// Returns a pose at this distance from the origin.
pub fn isometry(r: &mut Random, apart: f64) -> Isometry3<f64> {
    let at = unit(r) * apart;
    Isometry3::from_parts(Translation3::from(at), turn(r, 3.0))
}

/// Returns a relative pose at this distance.
pub fn pose(r: &mut Random, apart: f64) -> RelativePose {
    RelativePose::from_isometry(&isometry(r, apart)).expect("a pose")
}

/// A pose that drifts from frame to frame about where bodies of size one touch.
pub struct Drift {
    pub turn: Quaternion<f64>,
    pub place: Vector3<f64>,
    pub step: f64,
    pub about: f64,
}

impl Drift {
    pub fn new(r: &mut Random, step: f64, about: f64) -> Self {
        Self {
            turn: turn(r, 3.0).into_inner(),
            place: unit(r) * about,
            step,
            about,
        }
    }

    pub fn next(&mut self, r: &mut Random) -> Isometry3<f64> {
        let d = in_ball(r) * self.step;
        self.turn.coords.x += d.x;
        self.turn.coords.y += d.y;
        self.turn.coords.z += d.z;
        let n = self.turn.coords.iter().map(|x| x * x).sum::<f64>().sqrt();
        self.turn.coords /= n;
        self.place += in_ball(r) * (2.0 * self.step);
        let s = self.place.iter().map(|x| x * x).sum::<f64>();
        self.place *= 1.0 - 0.02 * (s / (self.about * self.about) - 1.0);
        Isometry3::from_parts(Translation3::from(self.place), UnitQuaternion::new_unchecked(self.turn))
    }
}

/// Returns the relative pose of a pose that is valid.
pub fn relative(p: &Isometry3<f64>) -> RelativePose {
    RelativePose::from_isometry(p).expect("a pose")
}

/// Points of one of several forms.
pub fn cloud(r: &mut Random, n: usize, form: u64) -> Vec<Point3<f64>> {
    let mut points = Vec::new();
    for _ in 0..n {
        let p = match form {
            0 => unit(r),
            1 => in_ball(r),
            // Of a lattice: many coplanar, many duplicates.
            2 => Vector3::from_fn(|_, _| r.below(5) as f64 - 2.0) * 0.5,
            // A needle, a plate.
            3 => in_ball(r).component_mul(&Vector3::new(1.0, 1e-3, 2e-4)),
            4 => in_ball(r).component_mul(&Vector3::new(1.0, 1.0, 1e-7)),
            // Nearly coplanar.
            _ => Vector3::new(
                r.range(-1.0, 1.0),
                r.range(-1.0, 1.0),
                [0.0, 0.4][r.below(2) as usize] + 1e-15 * r.range(-1.0, 1.0),
            ),
        };
        points.push(Point3::from(p));
    }
    points
}

/// Returns the hull of points of a form.
pub fn hull(r: &mut Random, n: usize, form: u64) -> ConvexPolyhedron {
    loop {
        if let Ok(body) = ConvexPolyhedron::from_points(&cloud(r, n, form)) {
            return body;
        }
    }
}

/// Returns the hull of points on the unit sphere.
pub fn round(r: &mut Random, n: usize) -> ConvexPolyhedron {
    hull(r, n, 0)
}

/// One shape of each kind without powers.
pub fn curved() -> Vec<Shape> {
    let axes = Vector3::new(1.0, 0.7, 0.5);
    let corners = [
        [1., 0., 0.],
        [-1., 0., 0.],
        [0., 1., 0.],
        [0., -1., 0.],
        [0., 0., 1.],
        [0., 0., -1.],
    ]
    .map(Point3::from);
    let known = [
        Shape::ball(1.0),
        Shape::capsule(0.8, 0.5),
        Shape::cuboid(axes).and_then(|s| s.rounded(0.25)),
        Shape::hull(&corners),
        Shape::cylinder(0.8, 0.9),
        Shape::cone(0.9, 0.8),
        Shape::ellipsoid(axes),
        Shape::cylinder(0.3, 0.4).and_then(|s| s.rounded(0.1)),
        Shape::ellipsoid(axes).and_then(|s| s.rounded(0.2)),
    ];
    let known = known.into_iter().map(|shape| shape.expect("a shape"));
    // Kinds after the first three, which stand above where recorded draws expect them.
    let new = curved_kinds(axes).into_iter().skip(3).map(|(_, shape)| shape);
    known.chain(new).collect()
}

/// A closed mesh, every triangle dented.
pub fn dented(body: &ConvexPolyhedron, by: f64) -> Mesh {
    let mut points: Vec<_> = body.vertex_points().collect();
    let mut triangles = Vec::new();
    for corners in body.triangles() {
        let [a, b, c] = corners.map(|v| v.index() as u32);
        let sum = points[a as usize].coords + points[b as usize].coords + points[c as usize].coords;
        let d = points.len() as u32;
        points.push((sum * (by / 3.0)).into());
        triangles.extend([[a, b, d], [b, c, d], [c, a, d]]);
    }
    Mesh::new(&points, &triangles).expect("a mesh")
}

/// A sheet of waves, n by n.
pub fn sheet(n: usize, mut height: impl FnMut(f64, f64) -> f64) -> (Vec<Point3<f64>>, Vec<[u32; 3]>) {
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..=n {
        for k in 0..=n {
            let (x, y) = (2.0 * i as f64 / n as f64 - 1.0, 2.0 * k as f64 / n as f64 - 1.0);
            points.push(Point3::new(x, y, height(x, y)));
            if i < n && k < n {
                let v = (i * (n + 1) + k) as u32;
                let w = v + n as u32 + 1;
                triangles.extend([[v, w, v + 1], [w, w + 1, v + 1]]);
            }
        }
    }
    (points, triangles)
}

/// Returns a compound of three hulls and a curved shape.
pub fn compound(r: &mut Random) -> Compound {
    let curved = curved();
    let pieces = (0..4).map(|k| {
        let pose = isometry(r, 0.8);
        let shape = if k < 3 {
            Shape::from(round(r, 14))
        } else {
            curved[r.below(9) as usize].clone()
        };
        Piece {
            pose,
            ..Piece::new(shape)
        }
    });
    Compound::new(pieces.collect()).expect("a compound")
}

/// Returns a surface of one patch of these degrees.
pub fn bumpy(r: &mut Random, degrees: [usize; 2], is_rational: bool) -> BezierSurface {
    let [m, n] = degrees;
    let mut points = Vec::new();
    let mut weights = Vec::new();
    for i in 0..=m {
        for k in 0..=n {
            let (x, y) = (2.0 * i as f64 / m as f64 - 1.0, 2.0 * k as f64 / n as f64 - 1.0);
            points.push(Point3::new(x, y, r.range(-0.5, 0.5)));
            weights.push(r.range(0.5, 2.0));
        }
    }
    let patch = if is_rational {
        BezierPatch::rational(degrees, &points, &weights)
    } else {
        BezierPatch::polynomial(degrees, &points)
    };
    BezierSurface::new(vec![patch.expect("a patch")]).expect("a surface")
}

/// Returns velocities up to these.
pub fn velocity(r: &mut Random, linear: f64, angular: f64) -> Velocity {
    Velocity::new(in_ball(r) * linear, in_ball(r) * angular)
}

/// A motion that flies past the origin.
pub fn steady(r: &mut Random, apart: f64) -> Steady {
    let from = isometry(r, apart);
    let towards = -from.translation.vector * r.range(0.5, 2.0) + in_ball(r);
    let velocity = Velocity::new(towards, in_ball(r) * 2.0);
    match r.below(4) {
        0 => Steady::new(&from, velocity),
        1 => Steady::about(&from, Point3::from(in_ball(r)), velocity),
        2 => Steady::between(&from, &isometry(r, apart), 1.0, Point3::origin()),
        _ => Steady::screw(&from, &Point3::from(in_ball(r)), &unit(r), 2.0, 1.0),
    }
    .expect("a motion")
}

/// Returns a motion from a pose to another, as other engines sweep.
pub fn nlerp(r: &mut Random, apart: f64) -> Nlerp {
    let (from, to) = (isometry(r, apart), isometry(r, apart));
    Nlerp::new(&from, &to, 1.0, Point3::origin()).expect("a motion")
}

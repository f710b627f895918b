//! Promise: what a ray cast says about a hull is true over the rationals, for the ray and the pose
//! as given.
//!
//! Rays aim at vertices, edges and faces, graze them, run in faces, and start next to the surface
//! and far away.

use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, UnitQuaternion, Vector3};
use lin_canny::{ConvexPolyhedron, Ray, RayCast, RayCaster};
use truth::rational::{RBig, exact, placed};
use truth::rng::Rng;
use truth::{Point, Pose, shapes};

type Exact3 = [RBig; 3];

fn sub(p: &Exact3, q: &Exact3) -> Exact3 {
    std::array::from_fn(|k| &p[k] - &q[k])
}

fn dot(p: &Exact3, q: &Exact3) -> RBig {
    (0..3).fold(RBig::ZERO, |sum, k| sum + &p[k] * &q[k])
}

/// Returns the outward normal of each face, not normalised, and a corner.
fn planes(body: &ConvexPolyhedron, pose: &Pose) -> Vec<(Exact3, Exact3)> {
    let plane = |t: [lin_canny::VertexId; 3]| {
        let corners = t.map(|v| -> Point { body.vertex(v).expect("a vertex").coords.into() });
        let [a, b, c]: [Exact3; 3] = placed(&corners, pose).try_into().expect("three corners");
        let (u, v) = (sub(&b, &a), sub(&c, &a));
        let normal = std::array::from_fn(|k| {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            &u[i] * &v[j] - &u[j] * &v[i]
        });
        (normal, a)
    };
    body.triangles().map(plane).collect()
}

/// Returns the distances between which a ray is in a body; `None` if it misses the body.
fn inside(planes: &[(Exact3, Exact3)], ray: &Ray) -> Option<(RBig, Option<RBig>)> {
    let origin = <[f64; 3]>::from(ray.origin.coords).map(exact);
    let way = <[f64; 3]>::from(ray.direction.into_inner()).map(exact);
    let (mut from, mut until) = (RBig::ZERO, None);
    for (normal, corner) in planes {
        let (height, rise) = (dot(normal, &sub(&origin, corner)), dot(normal, &way));
        if rise == RBig::ZERO {
            if height > RBig::ZERO {
                return None;
            }
            continue;
        }
        let at = -height / &rise;
        if rise < RBig::ZERO {
            from = if at > from { at } else { from };
        } else if until.as_ref().is_none_or(|least| at < *least) {
            until = Some(at);
        }
    }
    until
        .as_ref()
        .is_none_or(|until| from <= *until)
        .then_some((from, until))
}

/// Returns a ray at a place of the body, from about `far` radii.
fn ray(rng: &mut Rng, body: &ConvexPolyhedron, at: &Isometry3<f64>, size: f64) -> Ray {
    let corners: Vec<Point3<f64>> = body.vertex_points().collect();
    let mut corner = || corners[rng.below(corners.len())].coords;
    let (a, b, c) = (corner(), corner(), corner());
    let place = match rng.below(5) {
        0 => a,
        1 => (a + b) * 0.5,
        2 => (a + b + c) / 3.0,
        3 => a * 0.75 + b * 0.25,
        _ => Vector3::from(rng.in_ball()) * 1.2 * size,
    };
    let place = at * Point3::from(place);
    let far = [1e-12, 0.5, 3.0, 3.0, 3e4][rng.below(5)] * size;
    // Along an axis, faces and edges of many bodies are met exactly or run along.
    let way = match rng.below(3) {
        0 => Vector3::ith(rng.below(3), if rng.chance(0.5) { 1.0 } else { -1.0 }),
        1 => at * (b - a),
        _ => Vector3::from(rng.unit()),
    };
    let way = if way.amax() > 0.0 {
        way / way.amax()
    } else {
        Vector3::x()
    };
    Ray::new(place - way * far, way).expect("a direction")
}

#[test]
fn casts_at_hulls_are_true_over_the_rationals() {
    let mut rng = Rng::new(4730);
    let families = [
        shapes::cuboid([1.0, 0.5, 0.25]),
        shapes::tetrahedron(),
        shapes::prism(20, 0.7, 0.5),
        shapes::icosphere(2),
        shapes::sliver(&mut rng, 20, 1e-9),
        shapes::needle(&mut rng, 20, 1e-6),
        shapes::chamfered([1.0, 0.5, 0.2], 1e-7),
        shapes::lattice(&mut rng, 30, 3),
        shapes::dome(4, 1e-6),
    ];
    let (mut hits, mut misses, mut starts, mut open) = (0, 0, 0, 0);
    for shape in &families {
        for exponent in [0, 328, -330] {
            let unit = 2f64.powi(exponent);
            let points: Vec<_> = shape.points.iter().map(|p| Point3::from(*p) * unit).collect();
            let body = ConvexPolyhedron::from_points(&points).expect("a body");
            let mut caster = RayCaster::new();
            for k in 0..40 {
                let (turn, shift) = match k % 2 {
                    0 => ([0.0, 0.0, 0.0, 1.0], [0.0; 3]),
                    _ => {
                        let q = UnitQuaternion::from_scaled_axis(Vector3::from(rng.in_ball()) * 3.0);
                        (q.coords.into(), rng.unit().map(|x| x * unit))
                    }
                };
                let at = Isometry3::from_parts(
                    Vector3::from(shift).into(),
                    UnitQuaternion::new_unchecked(Quaternion::from(turn)),
                );
                let ray = ray(&mut rng, &body, &at, unit);
                let length = if rng.chance(0.2) {
                    rng.range(0.0, 4.0) * unit
                } else {
                    f64::INFINITY
                };
                let found = caster.cast(&body, &at, &ray, length).expect("a ray");
                let expected = inside(&planes(&body, &Pose::new(turn, shift)), &ray);
                let expected = expected
                    .map(|span| span.0)
                    .filter(|from| length.is_infinite() || *from <= exact(length));
                let told = format!(
                    "{} at 2^{exponent}, {k}: {found:?} {ray:?} up to {length:e}",
                    shape.name
                );
                match (&found, &expected) {
                    (RayCast::Miss, None) => misses += 1,
                    (RayCast::Inside, Some(from)) => {
                        assert_eq!(*from, RBig::ZERO, "{told}");
                        starts += 1;
                    }
                    (RayCast::Hit(hit), Some(from)) => {
                        let least = from.to_f64().value();
                        assert!(exact(hit.safe) < *from, "{told}, not {least:e}");
                        assert!(*from <= exact(hit.hit), "{told}, not {least:e}");
                        assert!(hit.hit <= length, "{told}");
                        hits += 1;
                    }
                    (RayCast::Undecided { safe }, from) => {
                        assert!(from.as_ref().is_none_or(|from| exact(*safe) <= *from), "{told}");
                        open += 1;
                    }
                    _ => panic!("{told}, not {expected:?}"),
                }
            }
        }
    }
    assert!(hits > 250 && misses > 250 && starts > 20, "{hits} {misses} {starts}");
    assert_eq!(open, 0, "undecided casts");
}

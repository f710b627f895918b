//! The certificate's transcription against curved pairs and half-spaces, bit for bit.

use super::certificate::{Single, TRIES, bodies, length, pose};
use lin_canny::__proofs as library;
use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::{HalfSpace, RelativePose, Shape};
use proofs::kernels::certificate::{self, Placing};
use proofs::kernels::curved;
use proofs::number::{Vector, dot, scaled};
use truth::rng::Rng;

/// An ellipsoid, a cylinder or a cone, with its measures.
fn curved_shape(rng: &mut Rng, kind: usize) -> (Shape, [f64; 3]) {
    let [x, y, z] = [0; 3].map(|_| rng.range(0.01, 2.0));
    let shape = match kind {
        0 => Shape::ellipsoid(Vector3::new(x, y, z)),
        1 => Shape::cylinder(y, x),
        _ => Shape::cone(y, x),
    };
    (shape.expect("measures of a shape"), [x, y, z])
}

/// The support point along a direction of any length.
fn on_shape(kind: usize, [x, y, z]: [f64; 3], n: Vector<f64>) -> Vector<f64> {
    let circle = |z: f64| {
        let [p, q] = curved::on_circle(x, &[n[0], n[1]]);
        [p, q, z]
    };
    match kind {
        0 => curved::on_ellipsoid(&[x, y, z], &n),
        1 => circle(if n[2] < 0.0 { -y } else { y }),
        _ => {
            let across = (n[0] * n[0] + n[1] * n[1]).sqrt();
            let [apex, rim] = curved::apex_and_rim([x, y], [across, n[2]]);
            if apex >= rim { [0.0, 0.0, y] } else { circle(-y) }
        }
    }
}

fn placing(pose: &RelativePose) -> Placing<Single> {
    let (rotation, translation) = library::placing(pose);
    Placing { rotation, translation }
}

#[test]
fn curved_pairs() {
    let mut rng = Rng::new(26);
    for k in 0..TRIES {
        let kind = rng.below(3);
        let ((a, of_a), (b, of_b)) = (curved_shape(&mut rng, 0), curved_shape(&mut rng, kind));
        let Some(pose) = pose(&mut rng) else { continue };
        let directions = [0; 2].map(|_| [0; 3].map(|_| rng.range(-3.0, 3.0)));
        let weights = [0; 2].map(|_| rng.range(0.1, 1.0));
        let (told, mixed) = library::curved_end(&a, &b, &pose, directions, weights).expect("two directions");
        let placing = placing(&pose);
        let pieces = [0, 1].map(|i| {
            let n = scaled(directions[i], 1.0 / length(directions[i]));
            let m = placing.turned_to_b(n).map(|x| -x);
            let points = [on_shape(0, of_a, n), on_shape(kind, of_b, m)];
            let w = placing.difference(points).map(|x| -x);
            assert_eq!((n, dot(n, w), length(w)), told[i], "{k}");
            points
        });
        let points = [0, 1].map(|body| {
            [0, 1, 2].map(|k| {
                let [total, sum] = curved::mixed(&[pieces[0][body][k], pieces[1][body][k]], &weights);
                total * (1.0 / sum)
            })
        });
        assert_eq!(length(placing.difference(points)), mixed, "{k}");
    }
}

#[test]
fn half_spaces() {
    let mut rng = Rng::new(27);
    let bodies = bodies(&mut rng);
    for k in 0..TRIES {
        let body = rng.pick(&bodies);
        let Some(pose) = pose(&mut rng) else { continue };
        let normal = Vector3::from([0; 3].map(|_| rng.range(-3.0, 3.0)));
        let space = HalfSpace::new(normal, rng.range(-1.0, 1.0)).expect("a normal");
        let (placing, told) = (placing(&pose), space.distance(body, &pose).value);
        let normal = space.normal().into_inner().into();
        let height =
            |p: Point3<f64>| certificate::over_plane::<Single>(normal, placing.in_a(p.coords.into()), space.offset());
        let found = body.vertex_points().any(|p| height(p) == told);
        assert!(found, "{k}: {told}");
    }
}

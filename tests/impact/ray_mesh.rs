//! Promise: the bracket of a ray and a mesh contains the first crossing of a brute-force search.
//!
//! Rays come from outside and inside at any scale, and pass through vertices and along faces.

use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::Feature;
use lin_canny::{Ray, RayCast, RayCaster};
use truth::forms::mesh;
use truth::rng::Rng;
use truth::soups::{self, Soup};

/// Returns all crossings of a line with the triangles of a mesh: distance and triangle, in order.
///
/// `None` if one is near an edge or nearly parallel, or two are nearly equally far.
fn crossings(soup: &Soup, origin: Vector3<f64>, way: Vector3<f64>) -> Option<Vec<(f64, usize)>> {
    let mut all = Vec::new();
    for t in 0..soup.triangles.len() {
        let [a, b, c] = soup.corners(t).map(Vector3::from);
        let (u, v) = (b - a, c - a);
        let (across, from) = (way.cross(&v), origin - a);
        let (det, q) = (u.dot(&across), from.cross(&u));
        let (x, y) = (from.dot(&across) / det, way.dot(&q) / det);
        let inner = x.min(y).min(1.0 - x - y);
        let is_flat = det.abs() < 1e-5 * u.norm() * v.norm();
        if inner.abs() < 1e-4 || is_flat && inner > -1.0 {
            return None;
        }
        if inner > 0.0 {
            all.push((v.dot(&q) / det, t));
        }
    }
    all.sort_by(|x, y| x.0.total_cmp(&y.0));
    let is_clear = all.windows(2).all(|w| w[1].0 - w[0].0 > 1e-6);
    (is_clear && all.iter().all(|x| x.0.abs() > 1e-6)).then_some(all)
}

#[test]
fn rays_enter_meshes_at_their_first_crossing() {
    let mut rng = Rng::new(4720);
    let bodies = [
        (soups::torus(24, 12, 0.3), true),
        (soups::rock(2, 5), true),
        (soups::bracket(), true),
        (soups::cave(2, 0.5), true),
        (soups::screw(3, 12), true),
        (soups::loose(60, 0.4, &mut rng), false),
    ];
    let mut counts = [0; 3];
    for (k, (soup, is_solid)) in bodies.iter().enumerate() {
        for scale in [1.0, 2.0_f64.powi(-200), 2.0_f64.powi(200)] {
            let body = mesh(&soup.clone().map(|p| p.map(|x| x * scale)));
            let mut caster = RayCaster::new();
            for _ in 0..150 {
                let turn = UnitQuaternion::from_scaled_axis(Vector3::from(rng.unit()) * rng.range(0.0, 3.0));
                let at = Isometry3::from_parts((Vector3::from(rng.unit()) * scale).into(), turn);
                let far = if rng.chance(0.5) { 4.0 } else { 1.0 };
                let origin = Vector3::from(rng.unit()) * far * rng.uniform();
                let way = (Vector3::from(rng.in_ball()) - origin).normalize();
                let Some(all) = crossings(soup, origin, way) else {
                    continue;
                };
                let ahead: Vec<_> = all.iter().filter(|x| x.0 > 0.0).collect();
                let length = if rng.chance(0.2) {
                    rng.range(0.1, 2.0)
                } else {
                    f64::INFINITY
                };
                let ray = Ray::new(at * Point3::from(origin * scale), at * way).expect("a direction");
                let found = caster.cast(&body, &at, &ray, length * scale).expect("a ray");
                let told = format!("{k} at {scale:e}: {found:?}, not {ahead:?} up to {length}");
                // All bodies have one component except the cave, whose components are nested.
                if *is_solid && ahead.len() % 2 == 1 {
                    assert_eq!(found, RayCast::Inside, "{told}");
                    counts[0] += 1;
                    continue;
                }
                match ahead.first().filter(|x| x.0 < length) {
                    None => {
                        assert_eq!(found, RayCast::Miss, "{told}");
                        counts[1] += 1;
                    }
                    Some((expected, t)) => {
                        let RayCast::Hit(hit) = found else { panic!("{told}") };
                        let (safe, end) = (hit.safe / scale, hit.hit / scale);
                        assert!(safe - 1e-10 < *expected && *expected < end + 1e-10, "{told}");
                        assert!(end - safe < 1e-9, "{told}");
                        assert_eq!(hit.subshape, *t as u32, "{told}");
                        assert!(
                            matches!(hit.feature, Some(Feature::Face(f)) if f.index() == *t),
                            "{told}"
                        );
                        assert!((hit.point - ray.at(hit.safe)).norm() < 1e-9 * scale, "{told}");
                        let [a, b, c] = soup.corners(*t).map(Vector3::from);
                        let normal = (b - a).cross(&(c - a)).normalize();
                        let turned = at.inverse_transform_vector(&hit.normal);
                        assert!(turned.dot(&way) < 0.0, "{told}");
                        assert!(turned.dot(&normal).abs() > 1.0 - 1e-9, "{told}");
                        counts[2] += 1;
                    }
                }
            }
        }
    }
    assert!(counts[0] > 100 && counts[1] > 300 && counts[2] > 500, "{counts:?}");
}

/// Rays along a lattice hit vertices, edges and diagonals head on, and run along faces.
#[test]
fn rays_of_a_lattice_meet_a_cut_cube() {
    let body = mesh(&soups::plate(4, [1.0; 3]));
    let still = Isometry3::identity();
    let mut caster = RayCaster::new();
    for i in -10..=10 {
        for j in -10..=10 {
            let (x, y) = (f64::from(i) / 8.0, f64::from(j) / 8.0);
            for axis in 0..3 {
                let mut origin = Vector3::zeros();
                (origin[axis], origin[(axis + 1) % 3], origin[(axis + 2) % 3]) = (-3.0, x, y);
                let mut way = Vector3::zeros();
                way[axis] = 1.0;
                let ray = Ray::new(origin.into(), way).expect("a direction");
                let found = caster.cast(&body, &still, &ray, f64::INFINITY).expect("a ray");
                let (inside, beside) = (x.abs().max(y.abs()) < 1.0, x.abs().max(y.abs()) > 1.0);
                match found {
                    RayCast::Hit(hit) if !beside => {
                        assert!(hit.safe <= 2.0, "{found:?}");
                        assert!(2.0 <= hit.hit, "{found:?}");
                        assert!(hit.hit - hit.safe < 1e-9, "{found:?}");
                    }
                    RayCast::Miss if beside => {}
                    // Along a face: a hit up to rounding.
                    RayCast::Undecided { safe } if !inside && !beside => assert!(safe <= 2.0, "{found:?}"),
                    _ => panic!("{x} {y} along {axis}: {found:?}"),
                }
            }
        }
    }
}

//! Deforming meshes with every kind of geometry.
//!
//! Every outcome agrees with all pairs of triangles and pieces, in both orders, warm and cold. Rays
//! agree with brute force, depths and contacts with a new mesh.

use super::bending::{anew, bent, sheet, vertices};
use super::contacts::{check, deepest, within};
use super::{mesh, relative};
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::surface::{BezierPatch, BezierSurface};
use lin_canny::{
    Compound, ContactState, ConvexPolyhedron, Geometry, GeometryRef, Mesh, MeshKind, PairOutcome, PairTracker, Piece,
    Ray, RayCast, RayCaster, RelativePose, Shape,
};
use truth::forms::shapes;
use truth::pose::{add, cross, dot, quat, quat_mul, scale, sub, unit_quat};
use truth::rng::Rng;
use truth::soups::{self, Soup};
use truth::support::Decide;
use truth::{Point, Pose, brute};

/// Shapes and their poses.
type Pieces = Vec<(Isometry3<f64>, Shape)>;

/// Returns a geometry of each kind, and the pieces whose union it is.
fn kinds() -> Vec<(Geometry, Pieces)> {
    let hull = solids::random_hull(30, Vector3::new(0.4, 0.3, 0.3), 5).unwrap();
    let mut all: Vec<(Geometry, Pieces)> = shapes([0.3, 0.2, 0.25])
        .into_iter()
        .map(|shape| (Geometry::from(shape.clone()), vec![(Isometry3::identity(), shape)]))
        .collect();
    let places = [-0.4, 0.4].map(|x| Isometry3::translation(x, 0.0, 0.1));
    let pieces = places.map(|pose| {
        let mut piece = Piece::new(Shape::ball(0.25).unwrap());
        piece.pose = pose;
        piece
    });
    let parts = pieces.iter().map(|piece| (piece.pose, piece.shape.clone())).collect();
    all.push((Compound::new(pieces.to_vec()).unwrap().into(), parts));
    let of_hull = vec![(Isometry3::identity(), Shape::from(hull.clone()))];
    all.push((hull.clone().into(), of_hull.clone()));
    all.push((Mesh::from_convex(&hull).unwrap().into(), of_hull));
    all
}

/// Returns the least distance of any triangle and any piece, each pair queried alone; zero if they
/// meet.
fn truth(soup: &Soup, m: &Mesh, pieces: &[(Isometry3<f64>, Shape)], pose: &Pose) -> f64 {
    let mut least = f64::INFINITY;
    for t in 0..soup.triangles.len() {
        let triangle = Shape::from(ConvexPolyhedron::polygon(&soup.corners(t).map(Point3::from)).unwrap());
        for (place, shape) in pieces {
            let at = RelativePose::from_isometry(&(pose.isometry() * place)).unwrap();
            least = least.min(PairTracker::new().distance(&triangle, shape, &at).value);
        }
    }
    let inside = |(place, _): &(Isometry3<f64>, Shape)| {
        let middle = pose.isometry() * Point3::from(place.translation.vector);
        brute::winding(soup, middle.into()).abs() > 0.5
    };
    if m.kind() == MeshKind::Solid && pieces.iter().any(inside) {
        return 0.0;
    }
    least.max(0.0)
}

/// Trackers of one pair, one for each order.
#[derive(Default)]
struct Kept {
    there: PairTracker,
    back: PairTracker,
}

impl Kept {
    /// Queries both orders, warm and cold, and compares; returns whether the bodies meet.
    fn judge(&mut self, m: &Mesh, other: &Geometry, pose: &Pose, distance: f64, what: &str) -> bool {
        let at = relative(pose);
        let (one, two) = (GeometryRef::from(m), GeometryRef::from(other));
        let meets = distance < 1e-9;
        let (mut p, mut q) = (PairTracker::new(), PairTracker::new());
        let orders = [
            (&mut self.there, one, two, at),
            (&mut self.back, two, one, at.swapped()),
            (&mut p, one, two, at),
            (&mut q, two, one, at.swapped()),
        ];
        for (tracker, a, b, at) in orders {
            let found: PairOutcome = tracker.closest(a, b, &at);
            let is_apart = found.state == ContactState::Separated;
            assert!(
                is_apart != meets || found.distance.abs() < 1e-9,
                "{what} {found:?} {distance}"
            );
            if is_apart {
                assert!((found.distance - distance).abs() < 1e-9, "{what} {found:?} {distance}");
                let apart = (found.point_on_a - at_point(&at, &found)).norm();
                assert!((apart - distance).abs() < 1e-9, "{what} {found:?} {apart}");
            }
            assert_eq!(tracker.decide(a, b, &at, 0.0).is_yes(), !is_apart, "{what} {found:?}");
            assert!(tracker.decide(a, b, &at, distance + 1e-9).is_yes(), "{what} {found:?}");
            assert!(
                meets || tracker.decide(a, b, &at, distance - 1e-9).is_no(),
                "{what} {found:?}"
            );
            assert!(
                tracker.lower_bound(a, b, &at) <= distance.max(found.upper) + 1e-12,
                "{what}"
            );
            let off = (tracker.distance(a, b, &at).value.max(0.0) - distance).abs();
            assert!(off < 1e-9, "{what}");
            tracker.check(a, b, &at).unwrap();
        }
        meets
    }
}

/// Returns the witness on B in the frame of A.
fn at_point(at: &RelativePose, found: &PairOutcome) -> Point3<f64> {
    let (a, b) = at.poses();
    a.inverse() * b * found.point_on_b
}

/// Returns the distance at which a ray from outside first crosses a triangle.
fn crossing(soup: &Soup, from: Point, way: Point) -> f64 {
    let along = |t: usize| {
        let [a, b, c] = soup.corners(t);
        let (e, f) = (sub(b, a), sub(c, a));
        let h = cross(way, f);
        let (det, s) = (dot(e, h), sub(from, a));
        let q = cross(s, e);
        let (u, v, at) = (dot(s, h) / det, dot(way, q) / det, dot(f, q) / det);
        if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && at >= 0.0 {
            at
        } else {
            f64::INFINITY
        }
    };
    (0..soup.triangles.len()).map(along).fold(f64::INFINITY, f64::min)
}

fn bodies() -> [Soup; 3] {
    [sheet(5), soups::torus(10, 5, 0.35), soups::rock(1, 1)]
}

const BENDS: [&str; 4] = ["wave", "twist", "fold", "crumple"];

/// Returns a slow tumble, approaching and receding.
fn pose_at(frame: usize, seed: u64) -> Pose {
    let mut rng = Rng::new(seed);
    let (q, axis, at) = (rng.quat(), rng.unit(), rng.unit());
    Pose::new(
        unit_quat(quat_mul(quat(axis, 0.02 * frame as f64), q)),
        scale(at, 0.9 + 0.6 * (0.9 * frame as f64).sin()),
    )
}

#[test]
fn bent_meshes_and_bodies_of_every_kind_are_as_all_pairs_say() {
    let all = kinds();
    let mut tally = vec![[0; 2]; all.len()];
    for (k, rest) in bodies().iter().enumerate() {
        for (i, (other, pieces)) in all.iter().enumerate() {
            let way = BENDS[(i + k) % 4];
            let (mut m, mut kept) = (mesh(rest), Kept::default());
            for frame in 0..10 {
                let now = rest.clone().map(|p| bent(way, 0.06 * frame as f64, p));
                m.set_vertices(&vertices(&now)).unwrap();
                let pose = pose_at(frame, (10 * i + k) as u64);
                let distance = truth(&now, &m, pieces, &pose);
                let meets = kept.judge(&m, other, &pose, distance, &format!("{way} {k} {i} {frame}"));
                tally[i][usize::from(meets)] += 1;
            }
        }
    }
    assert!(tally.iter().all(|t| t.iter().all(|n| *n > 2)), "{tally:?}");
}

#[test]
fn rays_enter_bent_meshes_where_brute_force_says() {
    let (mut rng, mut tally) = (Rng::new(31), [0; 2]);
    for rest in bodies() {
        for way in BENDS {
            let (mut m, mut warm) = (mesh(&rest), RayCaster::new());
            for frame in 0..8 {
                let now = rest.clone().map(|p| bent(way, 0.1 * f64::from(frame), p));
                m.set_vertices(&vertices(&now)).unwrap();
                let pose = Pose::new(rng.quat(), scale(rng.unit(), 2.0));
                for _ in 0..6 {
                    let (from, to) = (scale(rng.unit(), 3.0), scale(rng.unit(), 0.8));
                    let (start, end) = (pose.apply(from), pose.apply(to));
                    let ray = Ray::new(Point3::from(start), Vector3::from(sub(end, start))).unwrap();
                    let length = truth::pose::norm(sub(to, from));
                    let distance = crossing(&now, from, scale(sub(to, from), 1.0 / length));
                    for caster in [&mut warm, &mut RayCaster::new()] {
                        let found = caster.cast(&m, &pose.isometry(), &ray, 10.0).unwrap();
                        match found {
                            RayCast::Miss => assert!(distance > 10.0, "{way} {frame} {distance}"),
                            RayCast::Hit(hit) => {
                                assert!(hit.safe - 1e-9 < distance, "{way} {frame} {hit:?} {distance}");
                                assert!(distance < hit.hit + 1e-9, "{way} {frame} {hit:?} {distance}");
                                let place = Point::from(pose.isometry().inverse_transform_point(&hit.point));
                                let off = sub(place, add(from, scale(sub(to, from), distance / length)));
                                assert!(truth::pose::norm(off) < 1e-8, "{way} {frame} {hit:?}");
                            }
                            other => panic!("{way} {frame} {other:?} {distance}"),
                        }
                        tally[usize::from(distance < 10.0)] += 1;
                    }
                }
            }
        }
    }
    assert!(tally.iter().all(|n| *n > 100), "{tally:?}");
}

fn inverse(pose: &Pose) -> Pose {
    Pose::relative(pose, &Pose::IDENTITY)
}

#[test]
fn depths_and_contacts_of_bent_meshes_are_those_of_meshes_built_anew() {
    let (all, mut depths, mut points, mut shallow) = (kinds(), 0, 0, 0);
    for (k, rest) in bodies().iter().enumerate() {
        for (i, (other, _)) in all.iter().enumerate() {
            let way = BENDS[(i + k) % 4];
            let (mut m, mut there, mut back) = (mesh(rest), PairTracker::new(), PairTracker::new());
            for frame in 0..6 {
                let now = rest.clone().map(|p| bent(way, 0.05 * frame as f64, p));
                m.set_vertices(&vertices(&now)).unwrap();
                let fresh = anew(&now).unwrap();
                let pose = pose_at(frame, (20 * i + k) as u64);
                let (at, what) = (relative(&pose), format!("{way} {k} {i} {frame}"));
                let cold = PairTracker::new().penetration(&fresh, other, &at);
                let found = [
                    there.penetration(&m, other, &at),
                    back.penetration(other, &m, &at.swapped()),
                    PairTracker::new().penetration(&m, other, &at),
                ];
                for depth in found {
                    assert_eq!(depth.is_some(), cold.is_some(), "{what}");
                    let Some((p, q)) = depth.zip(cold) else { continue };
                    assert!(p.lower <= q.upper + 1e-9, "{what}: {p:?} {q:?}");
                    assert!(q.lower <= p.upper + 1e-9, "{what}: {p:?} {q:?}");
                    depths += usize::from(q.upper > 0.0);
                }
                let options = within(0.05);
                let mut once = mesh(rest);
                once.set_vertices(&vertices(&now)).unwrap();
                let mut cold = PairTracker::new();
                let truth = deepest(cold.contacts(&once, other, &at, &options).unwrap());
                let warm = there.contacts(&m, other, &at, &options).unwrap().to_vec();
                let turned = back.contacts(other, &m, &at.swapped(), &options).unwrap();
                // Normals of deep overlaps are those of hulls of convex patches.
                if truth > -0.05 && truth < f64::INFINITY {
                    check(&warm, [Some(&now), None], &pose, &what);
                    check(turned, [None, Some(&now)], &inverse(&pose), &what);
                    shallow += 1;
                }
                for found in [deepest(&warm), deepest(turned)] {
                    assert!(
                        found == truth || (found - truth).abs() < 1e-7,
                        "{what}: {found} {truth}"
                    );
                }
                points += warm.iter().map(|group| group.contacts.len()).sum::<usize>();
            }
        }
    }
    assert!(depths > 50, "{depths} {points} {shallow}");
    assert!(points > 100, "{depths} {points} {shallow}");
    assert!(shallow > 5, "{depths} {points} {shallow}");
}

#[test]
fn a_surface_is_as_far_from_a_bent_mesh_as_from_one_built_anew() {
    let mut rng = Rng::new(41);
    let points: Vec<_> = (0..9)
        .map(|k| Point3::new((k / 3) as f64 - 1.0, (k % 3) as f64 - 1.0, 0.3 * rng.unit()[0]))
        .collect();
    let surface = Geometry::from(BezierSurface::new(vec![BezierPatch::polynomial([2, 2], &points).unwrap()]).unwrap());
    let mut apart = 0;
    for (k, rest) in bodies().iter().enumerate() {
        let (mut m, mut there, mut back) = (mesh(rest), PairTracker::new(), PairTracker::new());
        for frame in 0..10 {
            let now = rest.clone().map(|p| bent(BENDS[k], 0.06 * frame as f64, p));
            m.set_vertices(&vertices(&now)).unwrap();
            let pose = pose_at(frame, 60 + k as u64);
            let at = relative(&pose.moved_to(scale(pose.t, 1.6)));
            let fresh = PairTracker::new().closest(&anew(&now).unwrap(), &surface, &at);
            let found = [
                there.closest(&m, &surface, &at),
                back.closest(&surface, &m, &at.swapped()),
                PairTracker::new().closest(&m, &surface, &at),
            ];
            for answer in found {
                assert!(answer.lower <= fresh.upper + 1e-12, "{k} {frame} {answer:?} {fresh:?}");
                assert!(fresh.lower <= answer.upper + 1e-12, "{k} {frame} {answer:?} {fresh:?}");
                assert_eq!(answer.state, fresh.state, "{k} {frame} {answer:?} {fresh:?}");
            }
            apart += usize::from(fresh.state == ContactState::Separated);
            let d = fresh.upper.max(0.0) + 1e-9;
            assert!(there.decide(&m, &surface, &at, d).is_yes());
            assert!(back.decide(&surface, &m, &at.swapped(), d).is_yes());
        }
    }
    assert!(apart > 10, "{apart}");
}

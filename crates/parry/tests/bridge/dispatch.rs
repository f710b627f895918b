//! The dispatcher: right answers, no state, no panic.

use lin_canny_parry::lin_canny::{RelativePose, Tracker};
use truth::rng::Rng;

use super::engine::parry::math::{Pose, Real, Rotation, Vector};
use super::engine::parry::query::{
    ClosestPoints, ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher, QueryDispatcher,
};
use super::engine::parry::shape::{
    Ball, Capsule, Compound, Cone, ConvexPolyhedron, Cuboid, Cylinder, HalfSpace, RoundShape, Shape, SharedShape,
    TriMesh, Triangle,
};
use super::engine::{CertifiedDispatcher, Hull, isometry};

type Manifolds = Vec<ContactManifold<(), u32>>;

fn points(rng: &mut Rng, n: usize, size: f64) -> Vec<Vector> {
    let axes = std::array::from_fn(|_| size * rng.range(0.5, 1.0));
    let points = truth::shapes::ellipsoid(rng, n, axes).points;
    points.into_iter().map(|p| Vector::from(p.map(|x| x as Real))).collect()
}

pub(super) fn random_pose(rng: &mut Rng, apart: f64) -> Pose {
    let [x, y, z, w] = rng.quat().map(|x| x as Real);
    let at = Vector::from(rng.unit().map(|c| (apart * c) as Real));
    Pose::from_parts(at, Rotation::from_xyzw(x, y, z, w).normalize())
}

/// One shape of every kind, of size about `size`.
pub(super) fn kinds(rng: &mut Rng, size: Real) -> Vec<SharedShape> {
    let hull = points(rng, 20, f64::from(size));
    let plain = ConvexPolyhedron::from_convex_hull(&points(rng, 20, 1.0)).expect("a hull");
    let cuboid = Cuboid::new(Vector::new(0.5, 0.6, 0.7) * size);
    let part = SharedShape::from(Hull::from_points(&hull).expect("a solid"));
    let parts = [-0.5, 0.5].map(|x| (Pose::translation(x * size, 0.0, 0.0), part.clone()));
    let corners = vec![Vector::ZERO, Vector::X * size, Vector::Y * size, Vector::Z * size];
    let mesh = TriMesh::new(corners.clone(), vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]).expect("a mesh");
    vec![
        part,
        SharedShape::new(plain.scaled(Vector::splat(size)).expect("a hull")),
        SharedShape::new(cuboid),
        SharedShape::new(Ball::new(0.5 * size)),
        SharedShape::new(Capsule::new_y(0.5 * size, 0.3 * size)),
        SharedShape::new(RoundShape {
            inner_shape: cuboid,
            border_radius: 0.1 * size,
        }),
        SharedShape::new(Cylinder::new(0.5 * size, 0.4 * size)),
        SharedShape::new(Cone::new(0.5 * size, 0.4 * size)),
        SharedShape::new(HalfSpace::new(Vector::Y)),
        SharedShape::new(Compound::new(parts.to_vec())),
        SharedShape::new(mesh),
        SharedShape::new(Triangle::new(corners[1], corners[2], corners[3])),
    ]
}

/// Number of kinds that [`CertifiedDispatcher`] answers, in the order of [`kinds`].
pub(super) const CONVEX: usize = 8;

/// At ordinary sizes both engines agree; the answers of both orders agree too.
#[test]
fn distances_agree_with_parry_where_parry_is_right() {
    let mut rng = Rng::new(11);
    let ours = CertifiedDispatcher::default();
    let list = kinds(&mut rng, 1.0);
    let (mut apart, mut together) = (0, 0);
    for _ in 0..40 {
        for (k, a) in list[..CONVEX].iter().enumerate() {
            for (l, b) in list[..CONVEX].iter().enumerate() {
                let apart_by = rng.range(0.0, 3.0);
                let pos12 = random_pose(&mut rng, apart_by);
                let d = ours.distance(&pos12, &**a, &**b).expect("supported").distance;
                let e = DefaultQueryDispatcher
                    .distance(&pos12, &**a, &**b)
                    .expect("supported")
                    .distance;
                // parry's GJK ends early on round shapes: up to half a percent too far, never too near.
                let kinds = (a.shape_type(), b.shape_type());
                assert!(d < e + 1e-4 && e < d + 5e-3, "{d} {e}: {kinds:?}");
                let back = ours.distance(&pos12.inverse(), &**b, &**a).expect("supported").distance;
                assert!((d - back).abs() < 2e-6, "{d} {back}");
                let contact = ours
                    .contact(&pos12, &**a, &**b, 10.0)
                    .expect("supported")
                    .expect("within");
                // A closed form of parry: two balls.
                let is_parrys = matches!((k, l), (3, 3));
                let witness = (pos12 * contact.point2 - contact.point1).dot(contact.normal1);
                let off = (witness - contact.dist).abs();
                assert!(is_parrys || off < 1e-5, "{witness} {}: {k} {l}", contact.dist);
                let opposed = (contact.normal1 + pos12.rotation * contact.normal2).length();
                assert!(is_parrys || opposed < 1e-5, "{opposed}: {k} {l}");
                let meets = ours
                    .intersection_test(&pos12, &**a, &**b)
                    .expect("supported")
                    .intersecting;
                let points = ours.closest_points(&pos12, &**a, &**b, 10.0).expect("supported");
                if d > 1e-5 {
                    assert!(!meets && matches!(points, ClosestPoints::WithinMargin(..)));
                    apart += 1;
                } else if contact.dist < -1e-5 {
                    assert!(meets && points == ClosestPoints::Intersecting);
                    together += 1;
                }
            }
        }
    }
    assert!(apart > 800 && together > 800, "{apart} {together}");
}

/// Small bodies: judged by the certified distance of the same bodies made large by a power of two.
#[test]
fn distances_of_small_bodies_are_those_of_large_ones() {
    let (mut rng, mut again) = (Rng::new(12), Rng::new(12));
    let scale: Real = 1.0 / 4096.0;
    let (large, small) = (kinds(&mut rng, 1.0), kinds(&mut again, scale));
    let ours = CertifiedDispatcher::default();
    let (mut apart, mut parry_wrong) = (0, 0);
    for _ in 0..30 {
        for (k, l) in [(0, 2), (1, 4), (2, 4), (5, 3), (6, 7), (0, 6), (1, 1)] {
            let apart_by = rng.range(1.0, 2.5);
            let far = random_pose(&mut rng, apart_by);
            let near = Pose::from_parts(far.translation * scale, far.rotation);
            let d = ours.distance(&far, &*large[k], &*large[l]).expect("supported").distance;
            let e = ours
                .distance(&near, &*small[k], &*small[l])
                .expect("supported")
                .distance
                / scale;
            assert!((d - e).abs() < 1e-5, "{d} {e}");
            let p = DefaultQueryDispatcher
                .distance(&near, &*small[k], &*small[l])
                .expect("supported")
                .distance
                / scale;
            if d > 0.01 {
                apart += 1;
                parry_wrong += usize::from((p - d).abs() > 0.01 * d);
            }
        }
    }
    assert!(apart > 60, "{apart}");
    let is_single = size_of::<Real>() == 4;
    assert!(parry_wrong > 20 || !is_single, "{parry_wrong} of {apart}");
}

/// The manifold depends on the pose and the contacts kept in it, and on nothing else.
#[test]
fn manifolds_have_no_other_memory() {
    let mut rng = Rng::new(13);
    let list = kinds(&mut rng, 1.0);
    let other = CertifiedDispatcher::default();
    let (mut touching, mut far) = (0, 0);
    for a in &list[..6] {
        for b in &list[..6] {
            let ours = CertifiedDispatcher::default();
            let mut kept = Manifolds::new();
            for k in 0..20 {
                let pos12 = Pose::translation(0.08 * k as Real - 1.6, 0.1, 0.2);
                let mut again = kept.clone();
                ours.contact_manifolds(&pos12, &**a, &**b, 0.02, &mut kept, &mut None)
                    .expect("supported");
                // Another dispatcher, which saw other shapes meanwhile.
                other
                    .contact_manifolds(&pos12, &**b, &**a, 0.02, &mut Manifolds::new(), &mut None)
                    .expect("supported");
                other
                    .contact_manifolds(&pos12, &**a, &**b, 0.02, &mut again, &mut None)
                    .expect("supported");
                assert_eq!(format!("{kept:?}"), format!("{again:?}"));
                let deepest = kept[0].find_deepest_contact().map_or(1.0, |p| p.dist);
                touching += usize::from(deepest <= 0.02);
                far += usize::from(deepest > 0.02);
                // Impulses go with the features.
                for (i, p) in kept[0].points.iter_mut().enumerate() {
                    p.data = 100 * k + i as u32;
                }
            }
        }
    }
    assert!(touching > 100 && far > 100, "{touching} {far}");
}

#[test]
fn impulses_go_with_the_features() {
    let hull = Hull::try_from(&Cuboid::new(Vector::splat(0.5)) as &dyn Shape).expect("a solid");
    let (ours, mut kept) = (CertifiedDispatcher::default(), Manifolds::new());
    let at = |x: Real| Pose::translation(x, 0.99, 0.2);
    ours.contact_manifolds(&at(0.1), &hull, &hull, 0.02, &mut kept, &mut None)
        .expect("supported");
    assert_eq!(kept[0].points.len(), 4);
    kept[0].points.iter_mut().zip(1..).for_each(|(p, k)| p.data = k);
    let names: Vec<_> = kept[0].points.iter().map(|p| (p.fid1, p.fid2, p.data)).collect();
    ours.contact_manifolds(&at(0.101), &hull, &hull, 0.02, &mut kept, &mut None)
        .expect("supported");
    for p in &kept[0].points {
        assert!(names.contains(&(p.fid1, p.fid2, p.data)));
    }
    assert!((kept[0].points[0].dist + 0.01).abs() < 1e-6 && kept[0].local_n1.y > 0.999);
}

/// A manifold holds the deepest point, none deeper; only shapes whose balls are farther apart than the prediction times the reach
/// have none.
#[test]
fn manifolds_hold_the_deepest_contact() {
    let mut rng = Rng::new(14);
    let ours = CertifiedDispatcher::default();
    let (mut overlapping, mut flat, mut far) = (0, 0, 0);
    for k in 0..400 {
        let make = |rng: &mut Rng| Hull::from_points(&points(rng, [8, 24, 100][k % 3], 1.0)).expect("a solid");
        let (a, b) = (make(&mut rng), make(&mut rng));
        let apart_by = rng.range(0.9, 2.0);
        let pos12 = random_pose(&mut rng, apart_by);
        let pose = RelativePose::from_isometry(&isometry(&pos12)).expect("a pose");
        let d = Tracker::new().distance(a.body(), b.body(), &pose).value;
        let mut kept = Manifolds::new();
        ours.contact_manifolds(&pos12, &a, &b, 0.02, &mut kept, &mut None)
            .expect("supported");
        let m = &kept[0];
        let Some(deepest) = m.find_deepest_contact() else {
            assert!(d > 0.08, "{d}");
            far += 1;
            continue;
        };
        let deepest = f64::from(deepest.dist);
        assert!((deepest - d).abs() < 1e-6, "{deepest} {d}");
        for p in &m.points {
            let apart = (pos12 * p.local_p2 - p.local_p1).dot(m.local_n1);
            assert!((apart - p.dist).abs() < 1e-5, "{apart} {}", p.dist);
        }
        overlapping += usize::from(d < 0.0);
        flat += usize::from(m.points.len() > 2);
    }
    assert!(overlapping > 50 && flat > 50 && far > 20, "{overlapping} {flat} {far}");
}

/// The parts of compounds are asked for by this dispatcher: small compounds do not sink into each other.
#[test]
fn parts_of_compounds_are_answered_here() {
    let mut rng = Rng::new(15);
    let scale: Real = 1.0 / 4096.0;
    let list = kinds(&mut rng, scale);
    let (hull, compound) = (&list[0], &list[9]);
    let ours = CertifiedDispatcher::default();
    let pose = Pose::translation(0.0, 3.0 * scale, 0.0);
    for (a, b) in [(hull, compound), (compound, hull), (compound, compound)] {
        let d = ours.distance(&pose, &**a, &**b).expect("supported").distance / scale;
        assert!(d > 0.5 && d < 3.0, "{d}");
        assert!(
            !ours
                .intersection_test(&pose, &**a, &**b)
                .expect("supported")
                .intersecting
        );
        let mut kept = Manifolds::new();
        let mut workspace = None;
        ours.contact_manifolds(&pose, &**a, &**b, 3.0 * scale, &mut kept, &mut workspace)
            .expect("supported");
        assert!(!kept.is_empty() && kept.iter().all(|m| m.points.iter().all(|p| p.dist > 0.3 * scale)));
    }
}

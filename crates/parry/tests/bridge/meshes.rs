//! Meshes as shapes of parry: right answers at every size, contacts of floors without inner edges.

use lin_canny_parry::lin_canny::Mesh;
use truth::rng::Rng;

use super::dispatch::{CONVEX, kinds, random_pose};
use super::engine::parry::math::{Pose, Real, Rotation, Vector};
use super::engine::parry::query::details::ShapeCastOptions;
use super::engine::parry::query::{
    ContactManifold, NonlinearRigidMotion, PersistentQueryDispatcher, PointQuery, QueryDispatcher, Ray, RayCast,
};
use super::engine::parry::shape::{Compound, Cuboid, HeightField, Shape, SharedShape, TriMesh, TriMeshFlags};
use super::engine::{CertifiedDispatcher, Hull, MeshShape};

type Manifolds = Vec<ContactManifold<(), u32>>;

/// A flat floor of many triangles, its upper side at zero.
fn floor(half: Real, cells: u32) -> MeshShape {
    let side = cells + 1;
    let place = |k: u32| half * (2.0 * k as Real / cells as Real - 1.0);
    let points: Vec<Vector> = (0..side * side)
        .map(|k| Vector::new(place(k / side), 0.0, place(k % side)))
        .collect();
    let cell = |k: u32| {
        let a = (k / cells) * side + k % cells;
        let (b, c, d) = (a + 1, a + side, a + side + 1);
        [[a, b, d], [a, d, c]]
    };
    let triangles: Vec<[u32; 3]> = (0..cells * cells).flat_map(cell).collect();
    MeshShape::from_triangles(&points, &triangles).expect("a floor")
}

fn manifolds(pos12: &Pose, a: &dyn Shape, b: &dyn Shape, prediction: Real) -> Manifolds {
    let mut found = Manifolds::new();
    CertifiedDispatcher::default()
        .contact_manifolds(pos12, a, b, prediction, &mut found, &mut None)
        .expect("answered");
    found
}

/// Returns a pose of a shape over or in the floor, and the gap between them.
fn above_the_floor(shape: &dyn Shape, size: Real, rng: &mut Rng) -> (Pose, Real) {
    let turned = random_pose(rng, 0.0);
    let low = shape.compute_aabb(&turned).mins.y;
    let gap = size * rng.range(-0.05, 0.05) as Real;
    let [x, z] = [0; 2].map(|_| size * rng.range(-8.0, 8.0) as Real);
    let pose = Pose::from_parts(Vector::new(x, gap - low, z), turned.rotation);
    (pose, gap)
}

#[test]
fn bodies_of_every_size_rest_on_a_floor_of_triangles() {
    let mut rng = Rng::new(41);
    for size in [1.0, 0.02, 0.001] {
        let floor = floor(20.0 * size, 8);
        for (k, shape) in kinds(&mut rng, size)[..CONVEX].iter().enumerate() {
            for _ in 0..40 {
                let (pose, gap) = above_the_floor(&**shape, size, &mut rng);
                let found = manifolds(&pose, &floor, &**shape, 0.1 * size);
                let points = found.iter().flat_map(|m| &m.points);
                let deepest = points.map(|p| p.dist).fold(Real::INFINITY, Real::min);
                assert!((deepest - gap).abs() < 1e-4 * size, "{k} {size}: {deepest} of {gap}");
                assert!(found.iter().all(|m| m.local_n1.y > 0.999), "{k} {size}");
                let turned_round = manifolds(&pose.inverse(), &**shape, &floor, 0.1 * size);
                assert!(turned_round.iter().all(|m| m.local_n2.y > 0.999), "{k} {size}");
                assert_eq!(found.is_empty(), turned_round.is_empty());
            }
        }
    }
}

/// Triangle by triangle: meshes of parry without and with normals that are told by their neighbours, and height fields.
#[test]
fn bodies_of_every_size_rest_on_meshes_of_parry() {
    let mut rng = Rng::new(45);
    let mut bent = 0;
    for size in [1.0, 0.02, 0.001] {
        let side = 40.0 * size;
        let field = HeightField::new(
            super::engine::parry::utils::Array2::repeat(9, 9, 0.0),
            Vector::new(side, 1.0, side),
        );
        let (points, triangles) = field.to_trimesh();
        let plain = TriMesh::new(points.clone(), triangles.clone()).expect("a mesh");
        let flags = TriMeshFlags::FIX_INTERNAL_EDGES;
        let fixed = TriMesh::with_flags(points, triangles, flags).expect("a mesh");
        let floors: [&dyn Shape; 3] = [&field, &plain, &fixed];
        for (k, shape) in kinds(&mut rng, size)[..CONVEX].iter().enumerate() {
            for case in 0..60 {
                let (pose, gap) = above_the_floor(&**shape, size, &mut rng);
                let floor = floors[case % 3];
                let found = manifolds(&pose, floor, &**shape, 0.1 * size);
                let points = found.iter().flat_map(|m| &m.points);
                let deepest = points.map(|p| p.dist).fold(Real::INFINITY, Real::min);
                let what = (k, size, case % 3);
                assert!((deepest - gap).abs() < 2e-3 * size, "{what:?}: {deepest} of {gap}");
                let bears = |m: &&ContactManifold<(), u32>| m.points.iter().any(|p| p.dist < 0.0);
                let aside = found.iter().filter(bears).filter(|m| m.local_n1.y < 0.999).count();
                assert!(
                    aside == 0 || case % 3 < 2,
                    "{what:?}: a contact with an edge inside the floor"
                );
                bent += aside;
            }
        }
    }
    println!("{bent} contacts of edges inside floors without flags");
}

#[test]
fn compounds_rest_on_a_floor_and_keep_the_data_of_their_contacts() {
    let floor = floor(1.0, 3);
    let part = |x: Real| (Pose::translation(x, 0.0, 0.0), SharedShape::cuboid(0.1, 0.1, 0.1));
    let dumbbell = Compound::new(vec![part(-0.3), part(0.3)]);
    let ours = CertifiedDispatcher::default();
    let mut found = Manifolds::new();
    for step in 0..3 {
        let pose = Pose::translation(0.05, 0.099, 0.01 * step as Real);
        ours.contact_manifolds(&pose, &floor, &dumbbell, 0.02, &mut found, &mut None)
            .expect("answered");
        let points: Vec<_> = found.iter().flat_map(|m| &m.points).collect();
        assert_eq!(points.len(), 8);
        assert!(
            points.iter().all(|p| p.data == step && (p.dist + 1e-3).abs() < 1e-6),
            "{step}"
        );
        found.iter_mut().flat_map(|m| &mut m.points).for_each(|p| p.data += 1);
    }
}

#[test]
fn a_closed_mesh_answers_as_its_hull() {
    let mut rng = Rng::new(42);
    let ours = CertifiedDispatcher::default();
    let points: Vec<_> = truth::shapes::ellipsoid(&mut rng, 30, [1.0, 0.8, 0.6]).points;
    let points: Vec<Vector> = points.into_iter().map(|p| Vector::from(p.map(|x| x as Real))).collect();
    let hull = Hull::from_points(&points).expect("a hull");
    let mesh = MeshShape::from(Mesh::from_convex(hull.body()).expect("a mesh"));
    assert!((mesh.mass_properties(2.0).mass() - hull.mass_properties(2.0).mass()).abs() < 1e-5);
    let close = |a: Real, b: Real| (a - b).abs() < 1e-5;
    let mut tally = [0; 2];
    for shape in &kinds(&mut rng, 0.5)[..CONVEX] {
        for k in 0..30 {
            let pose = random_pose(&mut rng, if k % 2 == 0 { 0.9 } else { 1.6 });
            let [of_mesh, of_hull]: [&dyn Shape; 2] = [&mesh, &hull];
            let distance = |a: &dyn Shape| ours.distance(&pose, a, &**shape).expect("answered").distance;
            assert!(close(distance(of_mesh), distance(of_hull)));
            let meet = |a: &dyn Shape| {
                ours.intersection_test(&pose, a, &**shape)
                    .expect("answered")
                    .intersecting
            };
            assert_eq!(meet(of_mesh), meet(of_hull));
            tally[usize::from(meet(of_mesh))] += 1;
            if let Some(contact) = ours.contact(&pose, of_mesh, &**shape, 0.0).expect("answered") {
                assert!(meet(of_mesh) && contact.dist <= 0.0);
            }
            let way = -pose.translation;
            let options = ShapeCastOptions::with_max_time_of_impact(2.0);
            let cast = |a: &dyn Shape| ours.cast_shapes(&pose, way, a, &**shape, options).expect("answered");
            let at = |a: &dyn Shape| cast(a).map_or(9.0, |hit| hit.time_of_impact);
            assert!(close(at(of_mesh), at(of_hull)), "{} {}", at(of_mesh), at(of_hull));
            let rest = NonlinearRigidMotion::identity();
            let fall = NonlinearRigidMotion::new(pose, Vector::ZERO, way, Vector::new(0.3, 0.2, 0.1));
            let turning = |a: &dyn Shape| {
                let hit = ours.cast_shapes_nonlinear(&rest, a, &fall, &**shape, 0.0, 2.0, true);
                hit.expect("answered").map_or(9.0, |hit| hit.time_of_impact)
            };
            assert!(close(turning(of_mesh), turning(of_hull)));
        }
    }
    assert!(tally.iter().all(|n| *n > 40), "{tally:?}");
}

#[test]
fn rays_points_boxes_and_scales_of_a_mesh() {
    let floor = floor(1.0, 4);
    let ray = Ray::new(Vector::new(0.1, 2.0, 0.2), Vector::new(0.0, -4.0, 0.0));
    let hit = floor.cast_local_ray_and_get_normal(&ray, 1.0, true).expect("a hit");
    assert!((hit.time_of_impact - 0.5).abs() < 1e-6 && hit.normal.y > 0.999);
    assert!(floor.cast_local_ray_and_get_normal(&ray, 0.49, true).is_none());
    let above = floor.project_local_point(Vector::new(0.3, 0.5, 0.4), true);
    assert!(!above.is_inside && above.point.distance(Vector::new(0.3, 0.0, 0.4)) < 1e-6);
    let turned = Pose::from_parts(Vector::ZERO, Rotation::from_rotation_z(0.5));
    assert!((floor.compute_aabb(&turned).maxs.x - (0.5 as Real).cos()).abs() < 1e-5);
    let half = floor.scale_dyn(Vector::new(0.5, 1.0, -2.0), 1).expect("a mesh");
    assert!((half.compute_local_aabb().maxs - Vector::new(0.5, 0.0, 2.0)).length() < 1e-6);
    // A mirrored floor still bears from above.
    let die = Cuboid::new(Vector::splat(0.01));
    let found = manifolds(&Pose::translation(0.1, 0.01, 0.1), &*half, &die, 0.001);
    assert_eq!(found.iter().map(|m| m.points.len()).sum::<usize>(), 4);
}

#[test]
fn meshes_of_parry_become_shapes_and_faulty_ones_are_refused() {
    let field = HeightField::new(
        super::engine::parry::utils::Array2::repeat(5, 5, 0.0),
        Vector::new(1.0, 1.0, 1.0),
    );
    let (points, triangles) = field.to_trimesh();
    let mesh = TriMesh::new(points, triangles).expect("a mesh");
    let shape = MeshShape::try_from(&mesh).expect("a shape");
    assert_eq!(shape.mesh().triangle_count(), 32);
    let wrong = MeshShape::from_triangles(&[Vector::ZERO, Vector::X, Vector::splat(Real::NAN)], &[[0, 1, 2]]);
    assert!(wrong.is_err());
    let nowhere = Pose::translation(Real::NAN, 0.0, 0.0);
    assert!(
        CertifiedDispatcher::default()
            .distance(&nowhere, &shape, &shape)
            .is_err()
    );
}

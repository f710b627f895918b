//! The shape: mass, boxes, support faces, rays, points, conversions.

use std::f64::consts::TAU;

use lin_canny_parry::lin_canny::nalgebra::{Matrix3, Point3, Vector3};
use lin_canny_parry::lin_canny::polyhedron::solids;
use lin_canny_parry::lin_canny::{ConvexPolyhedron, Tracker};
use truth::rng::Rng;

use super::engine::parry::math::{Pose, Real, Rotation, Vector};
use super::engine::parry::query::details::ShapeCastOptions;
use super::engine::parry::query::{
    ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher, PointQuery, QueryDispatcher, Ray, RayCast,
};
use super::engine::parry::shape::{
    Ball, Cuboid, FeatureId, HalfSpace, PolygonalFeature, Segment, Shape, SupportMap, Triangle, TypedShape,
};
use super::engine::{CertifiedDispatcher, Hull, HullError, isometry, pose};

fn vector(p: [f64; 3]) -> Vector {
    Vector::from(p.map(|x| x as Real))
}

fn wide(v: Vector) -> Vector3<f64> {
    Vector3::from(v.to_array().map(f64::from))
}

/// Round, flat and long hulls of a size.
fn hulls(size: f64) -> Vec<Hull> {
    let mut rng = Rng::new(3);
    let mut list: Vec<Vec<Vector>> = [[1.0, 0.8, 0.6], [1.0, 0.9, 0.05], [1.0, 0.03, 0.02]]
        .into_iter()
        .flat_map(|axes| [24, 200].map(|n| (axes, n)))
        .map(|(axes, n)| truth::shapes::ellipsoid(&mut rng, n, axes).points)
        .map(|points| points.into_iter().map(|p| vector(p.map(|x| x * size))).collect())
        .collect();
    list.push(
        (0..8)
            .map(|k| vector([k & 1, k >> 1 & 1, k >> 2].map(|b| size * (b as f64 - 0.5))))
            .collect(),
    );
    list.iter()
        .map(|points| Hull::from_points(points).expect("a solid"))
        .collect()
}

/// Principal inertia and axes, put together in `f64`, are the tensor of the body, at any size.
#[test]
fn mass_properties_are_right_at_any_size() {
    for size in [1.0, 0.1, 0.01, 1e-3] {
        for hull in hulls(size) {
            let mass = hull.mass_properties(800.0);
            let [i, j, k, w] = mass.principal_inertia_local_frame.to_array().map(f64::from);
            let turn = truth::Pose::new(truth::pose::unit_quat([i, j, k, w]), [0.0; 3])
                .isometry()
                .rotation;
            let turn = turn.to_rotation_matrix().into_inner();
            let principal = wide(mass.inv_principal_inertia).map(|x| 1.0 / x);
            let tensor = turn * Matrix3::from_diagonal(&principal) * turn.transpose();
            let truth = hull.body().inertia() * 800.0;
            let off = (tensor - truth).norm() / truth.norm();
            assert!(
                off < 2e-6,
                "size {size}, {} vertices: {off:e}",
                hull.body().vertex_count()
            );
            let off = 1.0 / f64::from(mass.inv_mass) / (hull.body().volume() * 800.0) - 1.0;
            assert!(off.abs() < 1e-6, "{off:e}");
        }
    }
    let still = hulls(1.0)[0].mass_properties(0.0);
    assert_eq!((still.inv_mass, still.inv_principal_inertia), (0.0, Vector::ZERO));
}

#[test]
fn boxes_and_balls_hold_the_vertices() {
    let mut rng = Rng::new(4);
    for hull in hulls(0.5) {
        for _ in 0..30 {
            let [x, y, z, w] = rng.quat().map(|x| x as Real);
            let at = vector(rng.unit().map(|x| 20.0 * x));
            let at = Pose::from_parts(at, Rotation::from_xyzw(x, y, z, w).normalize());
            let (aabb, local) = (hull.compute_aabb(&at), hull.compute_local_aabb());
            let ball = hull.compute_local_bounding_sphere();
            for p in hull.body().vertex_points() {
                let posed = isometry(&at) * p;
                for k in 0..3 {
                    assert!(f64::from(aabb.mins[k]) <= posed[k] && posed[k] <= f64::from(aabb.maxs[k]));
                    assert!(f64::from(local.mins[k]) <= p[k] && p[k] <= f64::from(local.maxs[k]));
                }
                assert!((p.coords - wide(ball.center)).norm() <= f64::from(ball.radius));
            }
            let tight = aabb.half_extents().max_element();
            assert!(f64::from(tight) <= 1.001 * hull.body().bounding_ball().1 + 1e-4);
        }
    }
}

/// The deepest vertex is in the support face, and four vertices of a large face span it.
#[test]
fn support_faces_hold_the_deepest_vertex_and_are_spread() {
    for sides in [3, 4, 6, 7, 16, 100] {
        let hull = Hull::new(solids::prism(sides, 0.2, 1.0).expect("a solid"));
        for k in 0..200 {
            let lean = 0.02 * f64::from(k % 5);
            let (s, c) = (TAU * f64::from(k) / 200.0).sin_cos();
            let dir = vector([lean * c, lean * s, -1.0]);
            let mut face = PolygonalFeature::default();
            hull.as_polygonal_feature_map()
                .expect("faces")
                .0
                .local_support_feature(dir, &mut face);
            assert_eq!(face.num_vertices, sides.min(4));
            let used = &face.vertices[..face.num_vertices];
            let most = used
                .iter()
                .map(|v| wide(*v).dot(&wide(dir)))
                .fold(f64::NEG_INFINITY, f64::max);
            let top = wide(hull.local_support_point(dir)).dot(&wide(dir));
            assert!((most - top).abs() < 1e-6, "{sides} sides: {most} {top}");
            let middle: Vector3<f64> = used.iter().map(|v| wide(*v)).sum::<Vector3<f64>>() / used.len() as f64;
            assert!(middle.xy().norm() < 0.3, "{sides} sides: {middle}");
        }
    }
}

#[test]
fn rays_and_points_meet_the_surface() {
    let mut rng = Rng::new(5);
    let (mut hits, mut inside) = (0, 0);
    for hull in hulls(1.0) {
        let body = hull.body();
        for _ in 0..300 {
            let origin = rng.unit().map(|x| 2.0 * x);
            let target = rng.unit().map(|x| 0.7 * x);
            let dir: [f64; 3] = std::array::from_fn(|k| target[k] - origin[k]);
            let ray = Ray::new(vector(origin), vector(dir));
            let hit = hull.cast_local_ray_and_get_normal(&ray, 10.0, true);
            let at = |t: f64| Point3::from(wide(ray.origin) + wide(ray.dir) * t);
            let steps = (0..400).map(|k| at(f64::from(k) * 0.005));
            match hit {
                Some(hit) => {
                    let p = at(f64::from(hit.time_of_impact));
                    let q = body.closest_point(&p).expect("a point");
                    assert!((p - q).norm() < 1e-5 && wide(hit.normal).dot(&wide(ray.dir)) < 0.0);
                    hits += 1;
                }
                None => assert!(steps.filter(|p| body.contains(p)).count() == 0),
            }
            let p = vector(target.map(|x| 0.6 * x));
            let projection = hull.project_local_point(p, false);
            assert_eq!(projection.is_inside, body.contains(&Point3::from(wide(p))));
            let foot = Point3::from(wide(projection.point));
            let off = |f| {
                let (n, offset) = body.face_plane(f).expect("a face");
                n.dot(&foot.coords) - offset
            };
            let surface = body.faces().map(off).fold(f64::NEG_INFINITY, f64::max);
            assert!(surface.abs() < 1e-5, "{surface:e}");
            inside += usize::from(projection.is_inside);
            let solid = hull.project_local_point(p, true);
            assert!(!projection.is_inside || solid.point == p);
        }
    }
    assert!(hits > 500 && inside > 300, "{hits} {inside}");
    let cube = &hulls(1.0)[6];
    let out = Ray::new(Vector::ZERO, Vector::X);
    let from_inside = cube
        .cast_local_ray_and_get_normal(&out, 10.0, false)
        .expect("the far side");
    assert!((from_inside.time_of_impact - 0.5).abs() < 1e-6 && from_inside.normal.x < -0.9);
    assert_eq!(cube.cast_local_ray(&out, 10.0, true), Some(0.0));
    let found = cube.cast_local_ray(&Ray::new(Vector::X * 2.0, Vector::Y), 10.0, true);
    assert_eq!(found, None);
    let nothing = Ray::new(Vector::splat(Real::NAN), Vector::X);
    assert!(cube.cast_local_ray(&nothing, 10.0, true).is_none());
    let (_, feature) = cube.project_local_point_and_get_feature(Vector::X * 0.4);
    assert!(matches!(feature, FeatureId::Face(_)));
}

#[test]
fn conversions_report_what_they_change() {
    let exact = Hull::new(solids::cuboid(Vector3::new(0.5, 0.25, 2.0)).expect("a solid"));
    assert!(exact.conversion().is_exact() && exact.conversion().shift == 0.0);
    let thirds = Hull::new(solids::cuboid(Vector3::new(1.0 / 3.0, 0.25, 2.0)).expect("a solid"));
    let is_single = size_of::<Real>() == 4;
    assert_eq!(thirds.conversion().rounded, if is_single { 8 } else { 0 });
    assert!(thirds.conversion().shift < 2e-8 && thirds.conversion().has_parry_equivalent);
    // There and back: vertices in the same order.
    for hull in hulls(0.3) {
        let TypedShape::ConvexPolyhedron(twin) = hull.as_typed_shape() else {
            panic!("a solid is a convex polyhedron to parry");
        };
        let again = Hull::try_from(twin as &dyn Shape).expect("a solid");
        assert!(again.body().vertex_points().eq(hull.body().vertex_points()));
        let pose = lin_canny_parry::lin_canny::RelativePose::from_isometry(&isometry(&Pose::identity()));
        let d = Tracker::new().distance(hull.body(), again.body(), &pose.expect("a pose"));
        assert!(d.value < 0.0);
    }
    let try_from = |s: &dyn Shape| Hull::try_from(s).map(|h| h.body().vertex_count());
    assert_eq!(try_from(&Cuboid::new(Vector::new(1.0, 2.0, 3.0))), Ok(8));
    assert_eq!(try_from(&Triangle::new(Vector::X, Vector::Y, Vector::Z)), Ok(3));
    assert_eq!(try_from(&Segment::new(Vector::X, Vector::Y)), Ok(2));
    assert_eq!(try_from(&exact), Ok(8));
    assert_eq!(try_from(&Ball::new(1.0)), Err(HullError::Kind));
    assert!(matches!(
        try_from(&Cuboid::new(Vector::splat(Real::NAN))),
        Err(HullError::Build(_))
    ));
    let flat = Hull::new(
        ConvexPolyhedron::polygon(&[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]].map(Point3::from)).expect("a polygon"),
    );
    assert!(!flat.conversion().has_parry_equivalent && flat.to_parry().is_none());
    let half = isometry(&pose(&isometry(&Pose::translation(0.5, 0.0, 0.0))));
    assert_eq!(half.translation.vector, Vector3::x() * 0.5);
    let scaled = exact.scale_dyn(Vector::splat(2.0), 0).expect("a solid");
    assert!((f64::from(scaled.mass_properties(1.0).mass()) - 8.0 * exact.body().volume()).abs() < 1e-4);
}

/// A border moves the surface out by its radius: boxes, balls, support points, points, rays, casts.
#[test]
fn rounded_hulls_are_their_cores_and_a_border() {
    let mut rng = Rng::new(6);
    for (size, hull) in [1e-3, 1.0, 50.0]
        .into_iter()
        .flat_map(|size| hulls(size).into_iter().map(move |h| (size, h)))
    {
        let border = (0.25 * size) as Real;
        let round = hull.rounded(border).expect("a radius");
        assert_eq!((round.border_radius(), hull.border_radius()), (border, 0.0));
        let close = 4e-6 * size;
        for _ in 0..60 {
            let dir = vector(rng.unit());
            let out = round.local_support_point(dir) - hull.local_support_point(dir);
            assert!((wide(out) - wide(dir) * f64::from(border)).norm() < close, "{out:?}");
            let p = vector(rng.unit().map(|x| 1.6 * size * x));
            let gap = hull.distance_to_local_point(p, true) - border;
            let found = round.project_local_point(p, true);
            assert!(
                found.is_inside == (gap <= 0.0) || f64::from(gap.abs()) < close,
                "{gap} {found:?}"
            );
            if gap > 0.0 {
                let far = wide(found.point - p).norm();
                assert!((far - f64::from(gap)).abs() < close, "{far} {gap}");
                let ray = Ray::new(p, found.point - p);
                let hit = round.cast_local_ray_and_get_normal(&ray, 2.0, true).expect("a hit");
                assert!((hit.time_of_impact - 1.0).abs() < 1e-4, "{hit:?}");
            }
        }
        let (aabb, core) = (round.compute_local_aabb(), hull.compute_local_aabb());
        assert!((wide(aabb.maxs - core.maxs) - Vector3::repeat(f64::from(border))).norm() < close);
        assert!((wide(core.mins - aabb.mins) - Vector3::repeat(f64::from(border))).norm() < close);
        let ball = round.compute_local_bounding_sphere().radius - hull.compute_local_bounding_sphere().radius;
        assert!((f64::from(ball - border)).abs() < close);
        // The mass is that of the rounded body.
        let mass = round.mass_properties(1.0);
        let truth = lin_canny_parry::lin_canny::Shape::from(hull.body().clone());
        let truth = truth
            .rounded(f64::from(border))
            .expect("a radius")
            .mass()
            .expect("a mass");
        assert!((f64::from(mass.mass()) / truth.volume - 1.0).abs() < 1e-5 && truth.volume > hull.body().volume());
    }
}

/// Snapshots hold a rounded hull as parry's, and what makes no radius is refused by its value.
#[test]
fn rounded_hulls_are_written_as_parrys() {
    let hull = &hulls(1.0)[0];
    let round = hull.rounded(0.1).and_then(|h| h.rounded(0.2)).expect("a radius");
    let twin = match round.as_typed_shape() {
        TypedShape::RoundConvexPolyhedron(twin) => twin.clone(),
        other => panic!("{other:?}"),
    };
    assert!((twin.border_radius - 0.3).abs() < 1e-6);
    let again = Hull::try_from(&twin as &dyn Shape).expect("a hull");
    assert_eq!(again.border_radius(), round.border_radius());
    assert_eq!(again.body().vertex_count(), round.body().vertex_count());
    let large = round.scale_dyn(Vector::splat(2.0), 0).expect("a hull");
    let found = large.as_shape::<Hull>().map(Hull::border_radius);
    assert_eq!(found, Some(round.border_radius()));
    for bad in [-0.1, Real::NAN, Real::INFINITY, -Real::MIN_POSITIVE] {
        assert!(matches!(hull.rounded(bad), Err(HullError::Radius(_))), "{bad}");
    }
    assert!(hull.rounded(0.0).is_ok());
}

/// Under parry's own dispatcher a rounded hull rests on a half-space by its border, and casts of ours
/// stop there.
#[test]
fn rounded_hulls_touch_by_their_border() {
    let hull = Hull::new(solids::prism(6, 0.2, 0.5).expect("a solid"))
        .rounded(0.1)
        .expect("a radius");
    let space = HalfSpace::new(Vector::Z);
    let above = Pose::translation(0.0, 0.0, 0.32);
    let mut found: Vec<ContactManifold<(), ()>> = Vec::new();
    DefaultQueryDispatcher
        .contact_manifolds(&above, &space, &hull, 0.1, &mut found, &mut None)
        .expect("supported");
    let low = 0.32 - wide(hull.compute_local_aabb().maxs).z;
    let deepest = found[0].find_deepest_contact().expect("a contact");
    assert!((f64::from(deepest.dist) - low).abs() < 1e-5, "{deepest:?} {low}");
    let floor = Cuboid::new(Vector::new(5.0, 5.0, 1.0));
    let high = Pose::translation(0.3, 0.2, 3.0);
    let down =
        CertifiedDispatcher::default().cast_shapes(&high, Vector::Z * -1.0, &floor, &hull, ShapeCastOptions::default());
    let time = f64::from(down.expect("supported").expect("a hit").time_of_impact);
    let truth = 2.0 - wide(hull.compute_local_aabb().maxs).z;
    assert!((time - truth).abs() < 1e-5, "{time} {truth}");
}

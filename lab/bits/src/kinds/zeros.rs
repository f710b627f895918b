//! Lattices and zeros of both signs; sizes and places beyond single precision.

use super::WITHIN;
use super::scenes::{CONVEX, PARTS, tell_scene};
use crate::make::*;
use crate::{Random, Teller};
use lin_canny::broad::{self, Aabb, SweepAndPrune};
use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, Group, PairQueries, Scene};
use lin_canny::surface::BezierSurface;
use lin_canny::{
    Compound, Geometry, GeometryRef, ManifoldOptions, Mesh, PairTracker, Piece, QueryOptions, Ray, RayCaster,
    RelativePose, Shape, Tracker,
};

/// A coordinate of a lattice; zeros of both signs.
pub(super) fn lattice(r: &mut Random) -> f64 {
    [0.0, -0.0, 0.5, -0.5, 1.0, -1.0, 0.0][r.below(7) as usize]
}

/// Quarter turns and none, with zeros of both signs.
fn quarter(r: &mut Random) -> UnitQuaternion<f64> {
    let s = 0.5_f64.sqrt();
    let all = [
        [1., 0., 0., 0.],
        [1., -0., 0., -0.],
        [-0., 1., 0., 0.],
        [0., 0., -0., 1.],
        [s, s, 0., -0.],
        [s, -0., s, 0.],
        [0.5, 0.5, -0.5, 0.5],
    ];
    let [w, x, y, z] = all[r.below(7) as usize];
    UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z))
}

fn lattice_pose(r: &mut Random) -> Isometry3<f64> {
    let at = Vector3::new(2.0 * lattice(r), lattice(r), lattice(r));
    Isometry3::from_parts(Translation3::from(at), quarter(r))
}

/// A box of triangles with some corners pushed in, on a lattice.
pub(super) fn lattice_mesh(r: &mut Random) -> Mesh {
    let half = Vector3::new(0.5, [0.5, 1.0][r.below(2) as usize], 0.5);
    let body = solids::cuboid(half).expect("a box");
    let mut points: Vec<_> = body.vertex_points().collect();
    let mut triangles = Vec::new();
    for corners in body.triangles() {
        let [a, b, c] = corners.map(|v| v.index() as u32);
        let d = points.len() as u32;
        let m = (points[a as usize].coords + points[b as usize].coords) * 0.5;
        points.push((m * [1.0, 0.5][r.below(2) as usize]).into());
        triangles.extend([[a, d, c], [d, b, c]]);
    }
    points.iter_mut().for_each(|p| {
        p.iter_mut().for_each(|x| {
            if *x == 0.0 && r.below(2) == 0 {
                *x = -*x
            }
        })
    });
    Mesh::new(&points, &triangles).expect("a mesh")
}

pub(super) fn meshes_zeros(t: &mut Teller, r: &mut Random) {
    for _ in 0..t.rounds(60) {
        let (a, b) = (lattice_mesh(r), lattice_mesh(r));
        let piece = |r: &mut Random| Piece {
            pose: lattice_pose(r),
            ..Piece::new(solids::cuboid(Vector3::repeat(0.5)).expect("a box"))
        };
        let pieces = Compound::new(vec![piece(r), piece(r), piece(r)]).expect("a compound");
        let others: [GeometryRef; 4] = [(&b).into(), (&pieces).into(), (&a).into(), (&pieces).into()];
        let firsts: [GeometryRef; 4] = [(&a).into(), (&a).into(), (&a).into(), (&pieces).into()];
        for (x, y) in firsts.into_iter().zip(others) {
            let mut warm = PairTracker::new();
            for _ in 0..6 {
                let pose = relative(&lattice_pose(r));
                t.tell("warm", warm.closest(x, y, &pose));
                t.tell("cold", PairTracker::new().closest(x, y, &pose));
                t.tell("within", WITHIN.map(|d| warm.within(x, y, &pose, d)));
                t.tell("lower", warm.lower_bound(x, y, &pose));
                t.tell("penetration", warm.penetration(x, y, &pose));
                t.tell(
                    "contacts",
                    warm.contacts(x, y, &pose, &ManifoldOptions::default().prediction(0.2)),
                );
            }
        }
        t.tell("nodes", (0..40).map(|k| a.node_box(k)).collect::<Vec<_>>());
        let ray = Ray::new(Point3::new(lattice(r), lattice(r), -3.0), Vector3::new(0.0, -0.0, 1.0)).expect("a ray");
        t.tell("ray", RayCaster::new().cast(&a, &lattice_pose(r), &ray, 10.0));
    }
}

/// Sizes and places beyond single precision.
pub(super) fn meshes_hostile(t: &mut Teller, r: &mut Random) {
    for _ in 0..t.rounds(150) {
        let scales = [1.0, 1e-20, 1e-38, 1e-90, 1e20, 1e38, 1e90];
        let [p, q] = std::array::from_fn(|_| scales[r.below(7) as usize]);
        let scaled = |r: &mut Random, by: f64| {
            let body = round(r, 16).scaled(by).expect("a body");
            dented(&body, 0.7)
        };
        let (a, b) = (scaled(r, p), scaled(r, q));
        let mut warm = PairTracker::new();
        for _ in 0..4 {
            let away = [0.0, 1.5 * p, 1.5 * q, 1e20, 1e38, 1e150, 1e300][r.below(7) as usize];
            let at = unit(r) * away;
            let Ok(pose) = RelativePose::from_isometry(&Isometry3::from_parts(Translation3::from(at), turn(r, 1.0)))
            else {
                continue;
            };
            t.tell("warm", warm.closest(&a, &b, &pose));
            t.tell("cold", PairTracker::new().closest(&b, &a, &pose.swapped()));
            t.tell("within", [0.0, p, q, away].map(|d| warm.within(&a, &b, &pose, d)));
            t.tell("lower", warm.lower_bound(&a, &b, &pose));
            t.tell("penetration", warm.penetration(&a, &b, &pose));
        }
        // Vertices that leave the size the mesh was made with.
        let mut bent = a.clone();
        let far = [1e3, 1e12, 1e30, 1e60][r.below(4) as usize];
        let points: Vec<_> = bent.vertices().iter().map(|v| Point3::from(v.coords * far)).collect();
        t.tell("bent", bent.set_vertices(&points));
        let pose = pose(r, 2.0 * p);
        t.tell("after", warm.closest(&bent, &b, &pose));
        t.tell("self", PairTracker::new().self_closest(&bent));
    }
}

pub(super) fn boxes_zeros(t: &mut Teller, r: &mut Random) {
    let mut broad = SweepAndPrune::new();
    let aabb = |r: &mut Random| {
        let half = Vector3::new(0.5, 0.5, [0.5, 0.0][r.below(2) as usize]);
        Aabb::from_center(Point3::new(3.0 * lattice(r), 2.0 * lattice(r), lattice(r)), half)
    };
    let ids: Vec<_> = (0..120)
        .map(|k| {
            let moving = broad::BodyOptions::default().growth([0.0, 0.1][k / 2 % 2]);
            broad
                .insert(&aabb(r), [moving, broad::BodyOptions::default().fixed(true)][k % 2])
                .expect("a box")
        })
        .collect();
    for _ in 0..t.rounds(40) {
        for &id in ids.iter().step_by(2) {
            broad.set_box(id, &aabb(r)).expect("a box");
        }
        let events = broad.step();
        t.tell("events", (events.ended, events.began));
        t.tell("pairs", broad.pairs().collect::<Vec<_>>());
        for _ in 0..10 {
            let (asked, mut found) = (aabb(r), Vec::new());
            broad.overlapping(&asked, &mut found).expect("a box");
            t.tell("overlapping", found);
            t.tell("nearest", broad.nearest(&asked, 9, 3.0));
        }
    }
}

pub(super) fn scenes_zeros(t: &mut Teller, r: &mut Random) {
    for _ in 0..t.rounds(6) {
        let mut world = Scene::new();
        let queries = PairQueries::none()
            .boxes(true)
            .overlap(true)
            .distance(0.5)
            .features(true)
            .manifold(ManifoldOptions::default().prediction(0.1));
        world.set_queries(CONVEX, CONVEX, queries.depth(true)).expect("queries");
        world.set_queries(PARTS, CONVEX, queries).expect("queries");
        world.set_queries(PARTS, PARTS, queries).expect("queries");
        let mut ids = Vec::new();
        for k in 0..24 {
            let (shape, group): (Geometry, Group) = match k % 4 {
                0 => (Shape::cylinder(0.5, 0.5).expect("a shape").into(), CONVEX),
                1 if k < 12 => (lattice_mesh(r).into(), PARTS),
                _ => (solids::cuboid(Vector3::repeat(0.5)).expect("a box").into(), CONVEX),
            };
            let mut at = lattice_pose(r);
            at.translation.vector.y *= 3.0;
            ids.push(world.insert(Body::moving(shape).group(group), at).expect("a body"));
        }
        for _ in 0..10 {
            for &id in &ids {
                let mut at = lattice_pose(r);
                at.translation.vector.y *= 3.0;
                world.set_pose(id, at).expect("a pose");
            }
            world.step();
            tell_scene(t, r, &world);
        }
    }
}

pub(super) fn surfaces_zeros(t: &mut Teller, r: &mut Random) {
    let flat = BezierSurface::from_convex(&solids::cuboid(Vector3::repeat(0.5)).expect("a box")).expect("a surface");
    let shapes = curved();
    for k in 0..t.rounds(60) as usize {
        let pose = relative(&lattice_pose(r));
        let mut tracker = PairTracker::new();
        let few = QueryOptions::default().width(1e-4).splits(400);
        t.tell("self", tracker.closest_with(&flat, &flat, &pose, &few));
        t.tell(
            "shape",
            PairTracker::new().closest_with(&flat, &shapes[k % shapes.len()], &pose, &few),
        );
        for b in [&shapes[k % shapes.len()], &shapes[(k + 3) % shapes.len()]] {
            let mut pair = PairTracker::new();
            t.tell("curved", pair.closest(&shapes[(k + 1) % shapes.len()], b, &pose));
            t.tell(
                "within",
                WITHIN.map(|d| pair.within(&shapes[(k + 1) % shapes.len()], b, &pose, d)),
            );
        }
    }
}

/// A mesh and a hull, a shape and a shape, all in a lattice.
pub(super) fn mixed_zeros(t: &mut Teller, r: &mut Random) {
    let cube = solids::cuboid(Vector3::repeat(0.5)).expect("a box");
    let can = Shape::cylinder(0.5, 0.5).expect("a shape");
    for _ in 0..t.rounds(1500) {
        let mesh = lattice_mesh(r);
        let at = lattice_pose(r);
        let pose = relative(&at);
        t.tell("input", (&at, mesh.vertices()));
        t.tell("hull", PairTracker::new().closest(&mesh, &cube, &pose));
        t.tell("back", PairTracker::new().closest(&cube, &mesh, &pose));
        t.tell("shape", PairTracker::new().closest(&mesh, &can, &pose));
        t.tell("hulls", Tracker::new().closest(&cube, &cube, &pose));
        t.tell("shapes", PairTracker::new().closest(&can, &cube, &pose));
        t.tell(
            "distances",
            [
                PairTracker::new().lower_bound(&mesh, &cube, &pose),
                PairTracker::new().distance(&can, &can, &pose).value,
            ],
        );
    }
}

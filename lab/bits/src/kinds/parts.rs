//! Meshes, compounds, clouds; pairs of any kinds; rays.

use super::WITHIN;
use crate::make::*;
use crate::{Random, Teller};
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::{
    Cloud, CloudElement, Compound, ConvexPatches, Decomposition, Geometry, GeometryRef, ManifoldOptions, Mesh,
    PairTracker, PointQuery, QueryOptions, Ray, RayCaster, RepairOptions, Shape,
};

pub(super) fn parts<'g>(
    t: &mut Teller,
    r: &mut Random,
    frames: u64,
    a: impl Into<GeometryRef<'g>>,
    b: impl Into<GeometryRef<'g>>,
) {
    let (a, b): (GeometryRef, GeometryRef) = (a.into(), b.into());
    let mut warm = PairTracker::new();
    let about = [0.9, 1.6, 1.9, 3.0][r.below(4) as usize];
    let mut drift = Drift::new(r, 0.03, about);
    for k in 0..frames {
        let pose = relative(&drift.next(r));
        t.tell("warm", warm.closest(a, b, &pose));
        t.tell("intersects", warm.intersects(a, b, &pose));
        t.tell("within", WITHIN.map(|d| warm.within(a, b, &pose, d)));
        t.tell("lower", warm.lower_bound(a, b, &pose));
        if k % 8 == 0 {
            t.tell("cold", PairTracker::new().closest(a, b, &pose));
            t.tell("penetration", warm.penetration(a, b, &pose));
            let few = QueryOptions::default().splits(100);
            t.tell("few", warm.decide_within(a, b, &pose, 0.05, &few));
        }
    }
}

pub(super) fn meshes(t: &mut Teller, r: &mut Random) {
    for k in 0..t.rounds(18) {
        let n = [12, 40, 200][k as usize % 3];
        let (a, b) = (dented(&round(r, n), 0.8), dented(&hull(r, n, 1), 0.6));
        parts(t, r, 40, &a, &b);
        t.tell("mesh", (a.aabb(), a.volume(), a.centroid(), a.inertia(), a.report()));
        t.tell("nodes", (0..20).map(|k| a.node_box(k)).collect::<Vec<_>>());
        let hull = a.hull().expect("a hull");
        t.tell("fit", a.hull_fit(&hull));
        parts(t, r, 20, &a, &hull);
    }
}

pub(super) fn mesh_contacts(t: &mut Teller, r: &mut Random) {
    let options = ManifoldOptions::default().prediction(0.2);
    for _ in 0..t.rounds(4) {
        let bodies = [dented(&round(r, 24), 0.8), dented(&round(r, 24), 0.9)].map(ConvexPatches::from_mesh);
        let pieces = [compound(r), compound(r)].map(ConvexPatches::from_compound);
        for [a, b] in [&bodies, &pieces] {
            let mut warm = PairTracker::new();
            let mut drift = Drift::new(r, 0.03, 1.6);
            for _ in 0..25 {
                let pose = relative(&drift.next(r));
                t.tell("contacts", warm.contacts_between(a, b, &pose, &options));
            }
        }
    }
}

pub(super) fn mesh_self(t: &mut Teller, r: &mut Random) {
    for k in 0..t.rounds(24) {
        let bend = r.range(0.5, 1.5);
        // A sheet rolled up: nearly touches itself.
        let (points, triangles) = sheet(14, |x, y| bend * x * x + 0.1 * y);
        let mut points: Vec<_> = points
            .iter()
            .map(|p| Point3::new(p.x * (1.2 - bend * p.x * p.x), p.y, p.z))
            .collect();
        let mut mesh = Mesh::new(&points, &triangles).expect("a mesh");
        let mut tracker = PairTracker::new();
        for _ in 0..12 {
            t.tell("self", tracker.self_closest(&mesh));
            t.tell("self within", [0.01, 0.1, 0.5].map(|d| tracker.self_within(&mesh, d)));
            if k % 3 == 0 {
                t.tell("self pairs", tracker.self_pairs(&mesh, 0.05));
            }
            points.iter_mut().for_each(|p| *p += in_ball(r) * 0.004);
            mesh.set_vertices(&points).expect("vertices");
        }
    }
}

pub(super) fn bending(t: &mut Teller, r: &mut Random) {
    let ball = Shape::ball(0.6).expect("a ball");
    let others: [Geometry; 3] = [ball.into(), dented(&round(r, 40), 0.9).into(), round(r, 30).into()];
    for k in 0..t.rounds(18) {
        let (mut points, triangles) = sheet(16, |x, y| 0.2 * x * y);
        let mut mesh = Mesh::new(&points, &triangles).expect("a mesh");
        let mut tracker = PairTracker::new();
        let mut drift = Drift::new(r, 0.01, 1.2);
        for frame in 0..50 {
            let pose = relative(&drift.next(r));
            let other = &others[k as usize % 3];
            t.tell("closest", tracker.closest(&mesh, other, &pose));
            t.tell("within", WITHIN.map(|d| tracker.within(&mesh, other, &pose, d)));
            points.iter_mut().for_each(|p| *p += in_ball(r) * 0.01);
            if frame % 5 == 4 {
                mesh.set_vertices_from(20, &points[20..90]).expect("vertices");
            } else {
                mesh.set_vertices(&points).expect("vertices");
            }
            if frame == 30 {
                mesh.rebuild();
            }
        }
    }
}

/// Triangles that repeat, turn over, have no area; holes.
/// Returns a round mesh with a few faults.
fn faulty(r: &mut Random) -> (Vec<Point3<f64>>, Vec<[u32; 3]>) {
    let body = round(r, 30);
    let mut points: Vec<_> = body.vertex_points().collect();
    let mut triangles: Vec<[u32; 3]> = body.triangles().map(|c| c.map(|v| v.index() as u32)).collect();
    for _ in 0..1 + r.below(6) {
        let k = r.below(triangles.len() as u64) as usize;
        match r.below(5) {
            0 => triangles[k].swap(0, 1),
            1 => drop(triangles.remove(k)),
            2 => triangles.push(triangles[k]),
            3 => triangles[k][2] = triangles[k][1],
            _ => {
                points.push(points[triangles[k][0] as usize]);
                triangles[k][0] = points.len() as u32 - 1;
            }
        }
    }
    (points, triangles)
}

pub(super) fn repairs(t: &mut Teller, r: &mut Random) {
    for _ in 0..t.rounds(300) {
        let (points, triangles) = faulty(r);
        let options = RepairOptions::default().weld(r.pick(&[0.0, 0.0, 0.1, 0.3]));
        match Mesh::repaired(&points, &triangles, &options) {
            Ok(mesh) => {
                t.tell("mesh", (mesh.report(), mesh.triangle_vertices(), mesh.volume()));
                let query = PointQuery::new(&mesh);
                for _ in 0..5 {
                    let point = Point3::from(isometry(r, 0.9).translation.vector);
                    t.tell("winding", query.winding_number(&point));
                }
            }
            Err(e) => t.tell("error", e),
        }
    }
}

pub(super) fn overlaps(t: &mut Teller, r: &mut Random) {
    for _ in 0..t.rounds(300) {
        let (a, b) = (hull(r, 12, 0), hull(r, 9, 0));
        let (points, triangles) = faulty(r);
        let Ok(mesh) = Mesh::repaired(&points, &triangles, &RepairOptions::default()) else {
            continue;
        };
        t.tell("bounds", mesh.volume_bounds());
        let pose = match r.below(3) {
            0 => Isometry3::identity(),
            1 => isometry(r, 0.5).translation.into(),
            _ => isometry(r, 0.5),
        };
        let pose = relative(&pose);
        let mut pair = PairTracker::new();
        t.tell("hulls", pair.overlap(&a, &b, &pose));
        t.tell("mesh", pair.overlap(&mesh, &b, &pose));
        t.tell("equal", pair.overlap(&mesh, &mesh, &pose));
        t.tell("loops", pair.overlap_loops(&mesh, &a, &pose));
    }
}

pub(super) fn faulty_meshes(t: &mut Teller, r: &mut Random) {
    for _ in 0..t.rounds(300) {
        let (points, triangles) = faulty(r);
        match Mesh::new(&points, &triangles) {
            Ok(mesh) => {
                t.tell("report", mesh.report());
                t.tell("inspection", mesh.inspect(10));
                t.tell("mass", (mesh.kind(), mesh.volume(), mesh.centroid()));
                let other = hull(r, 12, 0);
                let mut tracker = PairTracker::new();
                for apart in [0.1, 1.5, 1.9] {
                    let pose = pose(r, apart);
                    t.tell("closest", tracker.closest(&mesh, &other, &pose));
                    t.tell("penetration", tracker.penetration(&mesh, &other, &pose));
                }
            }
            Err(e) => t.tell("error", e),
        }
    }
}

pub(super) fn compounds(t: &mut Teller, r: &mut Random) {
    for _ in 0..t.rounds(20) {
        let (a, b, mesh) = (compound(r), compound(r), dented(&round(r, 24), 0.8));
        parts(t, r, 30, &a, &b);
        parts(t, r, 30, &a, &mesh);
        let shapes = curved();
        let shape = shapes[r.below(shapes.len() as u64) as usize].clone();
        parts(t, r, 20, &a, &shape);
        t.tell("mass", (a.mass(), a.aabb()));
    }
}

pub(super) fn decompositions(t: &mut Teller, r: &mut Random) {
    for _ in 0..t.rounds(40) {
        let body = round(r, 24);
        let mesh = dented(&body, 0.9);
        let pieces = Compound::from(Shape::from(body));
        let found = Decomposition::new(mesh, pieces).expect("a decomposition");
        t.tell("fit", found.fit());
        let other = round(r, 20);
        let mut tracker = PairTracker::new();
        let mut drift = Drift::new(r, 0.03, 1.9);
        for _ in 0..30 {
            let pose = relative(&drift.next(r));
            t.tell("distance", found.distance(&mut tracker, &other, &pose));
        }
    }
}

pub(super) fn any_pair(t: &mut Teller, r: &mut Random) {
    for _ in 0..t.rounds(40) {
        let hull = round(r, 12);
        let bodies: [Geometry; 5] = [
            hull.clone().into(),
            Shape::cylinder(0.6, 0.4).expect("a shape").into(),
            Mesh::from_convex(&round(r, 20)).expect("a mesh").into(),
            Compound::from(Shape::from(hull)).into(),
            compound(r).into(),
        ];
        let mut tracker = PairTracker::new();
        for (a, b) in bodies.iter().flat_map(|a| bodies.iter().map(move |b| (a, b))) {
            let apart = r.range(0.1, 2.5);
            let pose = pose(r, apart);
            t.tell("closest", tracker.closest(a, b, &pose));
            t.tell("within", WITHIN.map(|d| tracker.within(a, b, &pose, d)));
            t.tell(
                "contacts",
                tracker.contacts(a, b, &pose, &ManifoldOptions::default().prediction(0.2)),
            );
        }
    }
}

pub(super) fn rays(t: &mut Teller, r: &mut Random) {
    let mut bodies: Vec<Geometry> = curved().into_iter().map(Geometry::from).collect();
    bodies.extend([
        round(r, 200).into(),
        dented(&round(r, 60), 0.8).into(),
        compound(r).into(),
    ]);
    for _ in 0..t.rounds(800) {
        for (k, b) in bodies.iter().enumerate() {
            let from = unit(r) * r.range(0.3, 3.0);
            let ray = Ray::new(Point3::from(from), -from + in_ball(r)).expect("a ray");
            let mut caster = RayCaster::new();
            t.tell("ray", (k, caster.cast(b, &isometry(r, 0.3), &ray, 10.0)));
        }
    }
    let surface = bumpy(r, [3, 3], true);
    for _ in 0..t.rounds(60) {
        let from = unit(r) * 3.0;
        let ray = Ray::new(Point3::from(from), -from + in_ball(r)).expect("a ray");
        t.tell(
            "surface",
            RayCaster::new().cast(&surface, &isometry(r, 0.3), &ray, 10.0),
        );
    }
}

/// Clouds of balls, of balls of all sizes, of boxes, of hulls, of cells.
pub(super) fn clouds(t: &mut Teller, r: &mut Random) {
    for k in 0..t.rounds(20) {
        let count = [30, 400, 3000][k as usize % 3];
        let points = cloud(r, count, k % 5);
        let radii: Vec<f64> = points.iter().map(|_| r.range(0.0, 0.05)).collect();
        let elements = [
            CloudElement::Ball(0.0),
            CloudElement::Ball(0.02),
            CloudElement::Balls(radii),
            CloudElement::Box(Vector3::new(0.01, 0.02, 0.03)),
            CloudElement::Shape(Shape::from(round(r, 8).scaled(0.05).expect("a body"))),
        ];
        let element = elements[k as usize % 5].clone();
        let first = Cloud::new(&points, element).expect("a cloud");
        let cells: Vec<[u16; 3]> = (0..60).map(|_| std::array::from_fn(|_| r.below(9) as u16)).collect();
        let second = Cloud::from_cells(Point3::new(-0.5, -0.5, -0.5), Vector3::repeat(0.1), &cells);
        let second = second.expect("a cloud");
        t.tell(
            "cloud",
            (first.aabb(), first.bounding_ball(), second.aabb(), second.len()),
        );
        let (hull, mesh, pieces) = (round(r, 20), dented(&round(r, 20), 0.8), compound(r));
        parts(t, r, 10, &first, &hull);
        parts(t, r, 10, &first, &mesh);
        parts(t, r, 6, &pieces, &first);
        parts(t, r, 6, &first, &second);
        let shapes = curved();
        let shape = shapes[r.below(shapes.len() as u64) as usize].clone();
        parts(t, r, 6, &second, &shape);
        let options = ManifoldOptions::default().prediction(0.1);
        let mut tracker = PairTracker::new();
        for _ in 0..3 {
            let apart = r.range(0.3, 1.9);
            let pose = pose(r, apart);
            t.tell("contacts", tracker.contacts(&second, &hull, &pose, &options));
        }
        for _ in 0..10 {
            let from = unit(r) * 3.0;
            let ray = Ray::new(Point3::from(from), -from + in_ball(r)).expect("a ray");
            t.tell("ray", RayCaster::new().cast(&second, &isometry(r, 0.3), &ray, 10.0));
        }
    }
}

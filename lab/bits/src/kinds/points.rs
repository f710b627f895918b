//! Points and geometries of every kind: closest points, sides, signed distances, grids.

use crate::make::*;
use crate::{Random, Teller};
use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::{Cloud, CloudElement, Geometry, HalfSpace, PointQuery, PointTracker, Shape};

/// Returns a geometry of each kind without powers.
fn geometries(r: &mut Random) -> Vec<Geometry> {
    let mut all: Vec<Geometry> = curved().into_iter().map(Geometry::from).collect();
    all.extend([
        round(r, 60).into(),
        Shape::from(hull(r, 20, 2)).rounded(0.2).expect("a shape").into(),
        dented(&round(r, 60), 0.8).into(),
        compound(r).into(),
        Cloud::new(&cloud(r, 300, 1), CloudElement::Box(Vector3::repeat(0.02)))
            .expect("a cloud")
            .into(),
        Cloud::new(&cloud(r, 300, 0), CloudElement::Ball(0.05))
            .expect("a cloud")
            .into(),
        HalfSpace::new(unit(r), 0.2).expect("a half-space").into(),
    ]);
    all
}

pub(super) fn points(t: &mut Teller, r: &mut Random) {
    for _ in 0..t.rounds(20) {
        for geometry in geometries(r) {
            let query = PointQuery::new(&geometry);
            let prepared = PointQuery::new(&geometry).prepared();
            let mut tracker = PointTracker::new();
            let mut point = Point3::from(in_ball(r) * 2.0);
            for _ in 0..20 {
                point += in_ball(r) * 0.2;
                t.tell("closest", query.closest_point(&point));
                t.tell("prepared", prepared.closest_point(&point));
                t.tell("tracked", tracker.closest_point(&query, &point));
                t.tell("contains", query.contains(&point));
                t.tell("distance", query.signed_distance(&point));
            }
            t.tell("features", query.nearest_features(&point, 4));
            t.tell("within", query.within(&point, 0.3));
            let many = cloud(r, 40, 1);
            t.tell("points", prepared.closest_points(&many));
            t.tell("distances", prepared.signed_distances(&many));
        }
    }
}

pub(super) fn grids(t: &mut Teller, r: &mut Random) {
    for _ in 0..t.rounds(6) {
        for geometry in geometries(r) {
            let (low, high) = (Point3::new(-1.3, -1.2, -1.1), Point3::new(1.2, 1.3, 1.4));
            let grid = PointQuery::new(&geometry)
                .signed_distance_grid(low, high, [6, 5, 4])
                .expect("a grid");
            t.tell("values", &grid.values);
            let at = Point3::from(in_ball(r));
            t.tell("error", (grid.error([2, 3, 1]), grid.value_at(&at)));
        }
    }
}

/// Points of a lattice about bodies of a lattice, with zeros of both signs.
pub(super) fn points_zeros(t: &mut Teller, r: &mut Random) {
    for _ in 0..t.rounds(60) {
        let mesh = super::zeros::lattice_mesh(r);
        let cube = lin_canny::polyhedron::solids::cuboid(Vector3::repeat(0.5)).expect("a box");
        let can = Shape::cylinder(0.5, 0.5).expect("a shape");
        let cells = Cloud::from_cells(
            Point3::new(-1.0, -1.0, -1.0),
            Vector3::repeat(0.5),
            &[[0; 3], [1, 1, 1], [2, 1, 1]],
        );
        let all: [Geometry; 4] = [mesh.into(), cube.into(), can.into(), cells.expect("a cloud").into()];
        for geometry in &all {
            let query = PointQuery::new(geometry);
            for _ in 0..12 {
                let mut axis = || super::zeros::lattice(r);
                let point = Point3::new(axis(), axis(), axis());
                t.tell("closest", query.closest_point(&point));
                t.tell("contains", query.contains(&point));
                t.tell("features", query.nearest_features(&point, 3));
            }
        }
    }
}

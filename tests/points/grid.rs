//! Grids: the error of a cell bounds what interpolation does anywhere in the cell.

use std::ops::ControlFlow;
use truth::support::piece_at;

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::surface::{BezierPatch, BezierSurface};
use lin_canny::{
    Cloud, CloudElement, Compound, ConvexPolyhedron, DistanceGrid, Geometry, HalfSpace, Mesh, PointError, PointQuery,
    Progress, Shape, WithProgress,
};
use truth::rng::Rng;

#[test]
fn a_grid_bounds_the_error_of_its_interpolation() {
    let mut rng = Rng::new(4);
    let soup = truth::near_points::hard_mesh(3, &mut rng);
    let at: Vec<_> = soup.points.iter().map(|p| Point3::from(*p)).collect();
    let mesh = Mesh::new(&at, &soup.triangles).expect("a mesh");
    let query = PointQuery::new(&mesh);
    let (low, high) = (Point3::new(-1.0, -0.9, -0.8), Point3::new(1.0, 1.1, 0.7));
    let grid = query.signed_distance_grid(low, high, [9, 7, 5]).expect("a grid");
    assert_eq!((grid.nodes, grid.values.len()), ([10, 8, 6], 480));
    for _ in 0..2000 {
        let p = Point3::new(rng.range(-1.0, 1.0), rng.range(-0.9, 1.1), rng.range(-0.8, 0.7));
        let (value, error) = grid.value_at(&p).expect("a point of the grid");
        let truth = query.signed_distance(&p).expect("a point").value;
        assert!((value - truth).abs() <= error, "{p:?}: {value} +- {error}, {truth}");
        assert!(error < 0.25, "{p:?}: {value} +- {error}, {truth}");
    }
    assert!(grid.value_at(&Point3::new(2.0, 0.0, 0.0)).is_none() && grid.error([9, 0, 0]).is_none());
    for bad in [
        query.signed_distance_grid(low, high, [0, 1, 1]),
        query.signed_distance_grid(high, low, [1; 3]),
    ] {
        assert!(bad.is_err(), "{bad:?}");
    }
    assert!(query.signed_distance_grid(low, high, [usize::MAX; 3]).is_err());
}

#[test]
fn layers_of_a_grid_may_be_answered_elsewhere() {
    let body = solids::octahedron(0.7).expect("a body");
    let query = PointQuery::new(&body);
    let (low, high) = (Point3::new(-1.0, -0.9, -0.8), Point3::new(1.0, 1.1, 0.7));
    let grid = query.signed_distance_grid(low, high, [9, 7, 5]).expect("a grid");
    let mut layers = 0;
    let same = DistanceGrid::from_layers(low, high, [9, 7, 5], |nodes| {
        layers += 1;
        query.signed_distances(nodes)
    });
    let same = same.expect("a grid");
    assert_eq!((layers, &same.values), (10, &grid.values));
    assert_eq!(same.error([8, 6, 4]), grid.error([8, 6, 4]));
    let partial = DistanceGrid::from_layers(low, high, [9, 7, 5], |nodes| query.signed_distances(&nodes[1..]));
    let partial = partial.expect("a grid");
    assert!(partial.values[47].is_nan() && partial.values[48] == grid.values[49]);
    assert_eq!(partial.error([0, 6, 4]), Some(f64::INFINITY));
    assert!(partial.error([0, 0, 0]).is_some_and(f64::is_finite));
}

/// Points of a cell: its middle, its corners, middles of edges and faces, and others.
fn in_cell(grid: &DistanceGrid, cell: [usize; 3], rng: &mut Rng) -> Vec<Point3<f64>> {
    let parts = [0.0, 0.5, 1.0];
    let mut all: Vec<[f64; 3]> = (0..27)
        .map(|k| [parts[k / 9], parts[k / 3 % 3], parts[k % 3]])
        .collect();
    all.extend((0..20).map(|_| [0; 3].map(|_| rng.range(0.0, 1.0))));
    let place = |part: &[f64; 3]| {
        let at = |k: usize| grid.origin[k] + grid.step[k] * (cell[k] as f64 + part[k]);
        Point3::new(at(0), at(1), at(2))
    };
    all.iter().map(place).collect()
}

/// Checks every cell of a grid against the signed distances of points, and returns the largest part
/// of an error that was used.
fn judge(query: &PointQuery<'_>, grid: &DistanceGrid, told: &str) -> f64 {
    let mut rng = Rng::new(6);
    let [rows, columns, layers] = grid.nodes.map(|n| n - 1);
    let mut used = 0.0f64;
    for k in 0..rows * columns * layers {
        let cell = [k / layers / columns, k / layers % columns, k % layers];
        let error = grid.error(cell).expect("a cell");
        for p in in_cell(grid, cell, &mut rng) {
            // Rounding may put a corner outside.
            let Some((value, of_point)) = grid.value_at(&p) else {
                continue;
            };
            let truth = query.signed_distance(&p).expect("a point");
            let is_within = |error: f64| value - error <= truth.upper && truth.lower <= value + error;
            assert!(
                is_within(of_point) && is_within(error.max(of_point)),
                "{told}, {p:?}: {value} +- {of_point}, {truth:?}"
            );
            let width = truth.upper - truth.lower;
            used = used.max(((value - truth.value).abs() - width) / of_point);
        }
    }
    used
}

fn geometries() -> Vec<(&'static str, Geometry)> {
    let mut rng = Rng::new(8);
    let soup = truth::near_points::hard_mesh(2, &mut rng);
    let at: Vec<_> = soup.points.iter().map(|p| Point3::from(*p)).collect();
    let mesh = |triangles: &[[u32; 3]]| Mesh::new(&at, triangles).expect("a mesh");
    let open = mesh(&soup.triangles[3..]);
    let twice = mesh(&[&soup.triangles[..], &soup.triangles[..9]].concat());
    let corners = [
        [[-1.0, -1.0, 0.0], [-1.0, 1.0, 0.5]],
        [[1.0, -1.0, 0.5], [1.0, 1.0, -0.5]],
    ];
    let corners = corners.concat().into_iter().map(Point3::from).collect::<Vec<_>>();
    let patch = BezierPatch::polynomial([1, 1], &corners).expect("a patch");
    let piece = |p: &Point3<f64>| {
        piece_at(
            Isometry3::new(p.coords, p.coords),
            solids::icosahedron(0.3).expect("a body"),
        )
    };
    let cloud = |points, element| Geometry::from(Cloud::new(points, element).expect("a cloud"));
    let floor = HalfSpace::new(Vector3::new(0.6, 0.0, 0.8), 0.25).expect("a half-space");
    vec![
        ("mesh", mesh(&soup.triangles).into()),
        ("open mesh", open.into()),
        ("mesh with repeated triangles", twice.into()),
        ("hull", ConvexPolyhedron::from_points(&at).expect("a hull").into()),
        ("cube", solids::cuboid(Vector3::repeat(1.0)).expect("a cube").into()),
        ("ball", Shape::ball(0.75).expect("a ball").into()),
        ("cylinder", Shape::cylinder(0.5, 0.75).expect("a cylinder").into()),
        ("half-space", floor.into()),
        ("cloud", cloud(&at, CloudElement::Ball(0.125))),
        ("voxels", cloud(&at[..20], CloudElement::Box(Vector3::repeat(0.25)))),
        (
            "compound",
            Compound::new(at[..12].iter().map(piece).collect())
                .expect("pieces")
                .into(),
        ),
        ("surface", BezierSurface::new(vec![patch]).expect("a surface").into()),
    ]
}

#[test]
fn the_errors_of_all_cells_hold_for_every_kind() {
    let (low, high) = (Point3::new(-1.5, -1.25, -1.375), Point3::new(1.25, 1.5, 1.25));
    for (told, geometry) in geometries() {
        let query = PointQuery::new(&geometry);
        for cells in [[1, 1, 1], [4, 3, 5]] {
            let grid = query.signed_distance_grid(low, high, cells).expect("a grid");
            assert_eq!(grid.values.len(), grid.nodes.iter().product::<usize>());
            let used = judge(&query, &grid, told);
            assert!(used <= 1.0, "{told}: {used}");
        }
    }
}

#[test]
fn a_point_in_the_middle_of_a_cell_uses_the_whole_error() {
    let dot = ConvexPolyhedron::point(Point3::new(0.5, 0.5, 0.5)).expect("a point");
    let query = PointQuery::new(&dot);
    let (low, high) = (Point3::origin(), Point3::new(1.0, 1.0, 1.0));
    let grid = query.signed_distance_grid(low, high, [1; 3]).expect("a grid");
    let used = judge(&query, &grid, "a point");
    assert!((1.0 - 1e-12..=1.0).contains(&used), "{used}");
}

#[test]
fn grids_of_scaled_geometries_are_scaled() {
    let mut rng = Rng::new(9);
    let soup = truth::near_points::hard_mesh(2, &mut rng);
    let (low, high) = (Point3::new(-1.0, -0.9, -0.8), Point3::new(1.0, 1.1, 0.7));
    let of = |scale: f64| {
        let at: Vec<_> = soup.points.iter().map(|p| Point3::from(p.map(|x| x * scale))).collect();
        let mesh = Mesh::new(&at, &soup.triangles).expect("a mesh");
        let grid = PointQuery::new(&mesh).signed_distance_grid(low * scale, high * scale, [5, 4, 3]);
        let grid = grid.expect("a grid");
        let errors = (0..60).map(|k| grid.error([k / 12, k / 3 % 4, k % 3]).expect("a cell") / scale);
        let values = grid.values.iter().map(|x| x / scale);
        let (errors, values): (Vec<_>, Vec<_>) = (errors.collect(), values.collect());
        assert!(errors.iter().all(|e| *e < 0.5), "{scale:e}: {errors:?}");
        (values, errors)
    };
    let one = of(1.0);
    for power in [-329, -160, 100, 329] {
        let (values, errors) = of(2f64.powi(power));
        assert_eq!(values, one.0, "2^{power}");
        // Bounds of values may differ in their last bits.
        let is_same = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-13;
        assert!(errors.iter().zip(&one.1).all(is_same), "2^{power}: {errors:?}");
    }
    // Smaller than any body.
    let floor = HalfSpace::new(Vector3::z(), 0.0).expect("a half-space");
    let query = PointQuery::new(&floor);
    for scale in [1e-290, 1e-170, 1e110] {
        let grid = query
            .signed_distance_grid(low * scale, high * scale, [5, 4, 3])
            .expect("a grid");
        let error = grid.error([0, 0, 0]).expect("a cell") / scale;
        assert!((0.406..0.407).contains(&error), "{scale:e}: {error}");
    }
}

#[test]
fn progress_is_reported_and_stops_a_grid() {
    let ball = Shape::ball(1.0).expect("a ball");
    let query = PointQuery::new(&ball);
    let (low, high) = (Point3::new(-2.0, -2.0, -2.0), Point3::new(2.0, 2.0, 2.0));
    let alone = query.signed_distance_grid(low, high, [31, 29, 27]).expect("a grid");
    let ask = |end: usize| {
        let mut told: Vec<Progress> = Vec::new();
        let mut stop = |progress| {
            told.push(progress);
            Progress::stop_if(told.len() > end)
        };
        let grid = WithProgress::new(&mut stop).signed_distance_grid(&query, low, high, [31, 29, 27]);
        (grid, told)
    };
    let (grid, told) = ask(usize::MAX);
    assert_eq!(grid.expect("a grid").values, alone.values);
    let done: Vec<_> = told.iter().map(|p| p.done).collect();
    assert!(
        done.len() > 3 && done[0] == 0 && done.is_sorted() && done.last() == Some(&(32 * 30 * 28)),
        "{done:?}"
    );
    assert!(told.iter().all(|p| p.stage == "grid" && p.total == Some(32 * 30 * 28)));
    for end in 0..told.len() {
        let (grid, told) = ask(end);
        assert!(matches!(grid, Err(PointError::Stopped)), "{end}");
        assert!(told.len() == end + 1, "{end}");
    }
    // A wrong grid is an error before anything is reported.
    let mut fail = |_| -> ControlFlow<()> { panic!("a report") };
    let wrong = WithProgress::new(&mut fail).signed_distance_grid(&query, low, high, [0; 3]);
    assert!(matches!(wrong, Err(PointError::Grid { .. })));
}

/// Any number of threads gives the same bits.
#[cfg(feature = "parallel")]
#[test]
fn threads_change_no_bit_of_a_grid() {
    let (low, high) = (Point3::new(-1.5, -1.25, -1.375), Point3::new(1.25, 1.5, 1.25));
    for (told, geometry) in geometries() {
        let cells = if told == "surface" { [5, 4, 3] } else { [26, 22, 24] };
        let of = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("threads");
            let query = PointQuery::new(&geometry);
            let grid = pool
                .install(|| query.signed_distance_grid(low, high, cells))
                .expect("a grid");
            let bits = |x: &f64| x.to_bits();
            let error = |k| {
                grid.error([k % cells[0], k % cells[1], k % cells[2]])
                    .expect("a cell")
                    .to_bits()
            };
            let errors: Vec<u64> = (0..1000).map(error).collect();
            (grid.values.iter().map(bits).collect::<Vec<u64>>(), errors)
        };
        let one = of(1);
        for threads in [2, 7] {
            assert!(of(threads) == one, "{told}: {threads} threads");
        }
    }
}

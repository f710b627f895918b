use lin_canny::nalgebra::Point3;
use lin_canny::{Mesh, MeshKind, PointQuery};
use truth::driven::exact_place::Place;
use truth::lattice_points::{LATTICE_KINDS, LatticeMesh, float};
use truth::near_points::{MESH_KINDS, hard_mesh, is_between, place};
use truth::rng::Rng;

/// Powers of two by which meshes and points are scaled: sizes of 1e-100 to nearly 1e100.
const EXPONENTS: [i32; 6] = [0, 0, -332, -101, 150, 330];

/// The rational judge, which takes milliseconds a point, checks one of so many.
const RATIONAL: usize = 499;

/// Checks the sides of points on a lattice, `count` for each mesh and scale, against exact signs.
fn judge(count: usize, seed: u64) {
    let mut rng = Rng::new(seed);
    let (mut tally, mut asked, mut widest) = ([0; 3], 0, 0.0f64);
    for (pass, exponent) in EXPONENTS.into_iter().enumerate() {
        for mesh_kind in 0..MESH_KINDS {
            let mut soup = hard_mesh(mesh_kind, &mut rng);
            if pass % 2 == 1 {
                let (q, t) = (rng.quat(), [0.3, 0.1, -0.7]);
                soup = soup.moved(&truth::Pose::new(q, t));
            }
            let exact = LatticeMesh::new(&soup);
            let soup = exact.soup(exponent);
            let at: Vec<_> = soup.points.iter().map(|p| Point3::from(*p)).collect();
            let mesh = Mesh::new(&at, &soup.triangles).expect("a mesh");
            assert_eq!(mesh.kind(), MeshKind::Solid, "mesh {mesh_kind}");
            let point = |k: usize| exact.hard_point(k % LATTICE_KINDS, &mut rng);
            let points: Vec<_> = (0..count).map(point).collect();
            let given: Vec<_> = points.iter().map(|p| Point3::from(float(*p, exponent))).collect();
            // One call lets near triangles vote, the other casts rays.
            let query = PointQuery::new(&mesh);
            let held = query.contains_each(&given).expect("points");
            let found = query.prepared().closest_points(&given).expect("points");
            for (k, found) in found.iter().enumerate() {
                let told = || format!("mesh {mesh_kind} times 2^{exponent}, {:?}: {found:?}", points[k]);
                let truth = exact.place(points[k]);
                let state = truth.state();
                assert_eq!(found.state, state, "{}", told());
                assert_eq!(held[k], truth != Place::Outside, "contains: {}", told());
                tally[truth as usize] += 1;
                asked += 1;
                let (x, y) = (found.lower.abs(), found.upper.abs());
                let (lower, upper) = (x.min(y), x.max(y));
                assert!(lower <= found.distance.abs(), "{}", told());
                assert!(found.distance.abs() <= upper, "{}", told());
                let (size, width) = (soup.radius() + upper, upper - lower);
                assert!(width <= 2e-14 * size, "{width:e}: {}", told());
                widest = widest.max(width / size);
                if asked % RATIONAL == 0 {
                    let p = given[k].into();
                    assert_eq!(place(&soup, p, &mut rng), truth, "the judges differ: {}", told());
                    assert!(is_between(&soup, p, lower, upper), "{}", told());
                }
            }
        }
    }
    println!("outside, on, inside: {tally:?}, widest bounds: {widest:e}");
    assert!(tally.iter().all(|n| *n > asked / 20), "{tally:?}");
}

#[test]
fn ten_thousand_points_of_a_lattice_have_the_sides_of_exact_signs() {
    judge(120, 73);
}

#[test]
#[ignore = "a million points: cargo test --all-features --test points a_million -- --ignored --nocapture"]
fn a_million_points_of_a_lattice_have_the_sides_of_exact_signs() {
    judge(11_905, 72);
}

//! Deforming meshes in a scene: all queries use the current vertices.

use super::{ALL, read_back};
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, PairQueries, Scene, SceneError};
use lin_canny::{Geometry, ManifoldOptions, PairTracker, RelativePose, VertexError};
use truth::forms::mesh;
use truth::soups::{self, Soup};

fn vertices(soup: &Soup) -> Vec<Point3<f64>> {
    soup.points.iter().map(|p| Point3::from(*p)).collect()
}

#[test]
fn scenes_say_of_bent_meshes_what_pairs_say() {
    let rest = soups::torus(16, 8, 0.3);
    let shared = std::sync::Arc::new(mesh(&rest));
    let die = solids::cuboid(Vector3::new(0.3, 0.3, 0.3)).unwrap();
    let mut queries = PairQueries::none();
    queries.overlap = true;
    queries.features = true;
    queries.distance = Some(f64::INFINITY);
    queries.manifold = Some(ManifoldOptions::default().prediction(0.05));
    let mut scene = Scene::with_queries(queries).unwrap();
    let places = [
        Isometry3::translation(0.0, 0.0, 0.0),
        Isometry3::translation(2.66, 0.0, 0.02),
        Isometry3::translation(0.2, 0.0, 1.4),
    ];
    let bodies = [
        scene.insert(Body::moving(shared.clone()), places[0]).unwrap(),
        scene.insert(Body::moving(shared.clone()), places[1]).unwrap(),
        scene.insert(Body::moving(die), places[2]).unwrap(),
    ];
    let (mut overlaps, mut contacts) = (0, 0);
    for frame in 0..60 {
        let time = f64::from(frame) / 59.0;
        let now = rest
            .clone()
            .map(|[x, y, z]| [x * (1.0 + 0.3 * time), y, z + 0.3 * time * (x * x - 0.5)]);
        if frame % 7 != 3 {
            scene.set_vertices(bodies[0], &vertices(&now)).unwrap();
        }
        if frame % 20 == 14 {
            scene = read_back(&scene);
        }
        scene.step();
        scene.check().unwrap();
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let (a, b): (&Geometry, &Geometry) =
                (scene.geometry(bodies[i]).unwrap(), scene.geometry(bodies[j]).unwrap());
            let pose = RelativePose::new(&places[i], &places[j]).unwrap();
            let truth = PairTracker::new().closest(a, b, &pose);
            let found = scene.pair(bodies[i], bodies[j]).unwrap();
            let outcome = found.outcome.unwrap();
            assert_eq!(outcome.state, truth.state, "{frame} {i} {j}");
            assert!((outcome.distance - truth.distance).abs() < 1e-12, "{frame} {i} {j}");
            overlaps += usize::from(truth.distance <= 0.0);
            let points = found
                .contacts
                .map_or(0, |groups| groups.iter().map(|g| g.contacts.len()).sum());
            let mut cold = PairTracker::new();
            let fresh = cold
                .contacts(a, b, &pose, &ManifoldOptions::default().prediction(0.05))
                .unwrap();
            let expected = fresh.iter().map(|g| g.contacts.len()).sum::<usize>();
            assert_eq!(points, expected, "{frame} {i} {j}");
            contacts += points;
        }
    }
    assert!(overlaps > 10 && contacts > 20, "{overlaps} {contacts}");
    // The shared mesh is unchanged.
    assert_eq!(shared.vertices(), vertices(&rest));
    let Geometry::Mesh(other) = scene.geometry(bodies[1]).unwrap() else {
        panic!()
    };
    assert_eq!(other.vertices(), vertices(&rest));
}

#[test]
fn wrong_vertices_are_refused_and_change_nothing() {
    let rest = soups::torus(16, 8, 0.3);
    let mut scene = Scene::with_queries(PairQueries::none()).unwrap();
    let ring = scene.insert(Body::moving(mesh(&rest)), Isometry3::identity()).unwrap();
    let die = solids::cuboid(Vector3::new(0.3, 0.3, 0.3)).unwrap();
    let die = scene
        .insert(Body::moving(die).group(ALL), Isometry3::identity())
        .unwrap();
    let good = vertices(&rest);
    assert_eq!(scene.set_vertices(die, &good), Err(SceneError::NotAMesh { body: die }));
    let mut wrong = good.clone();
    wrong[5].z = f64::NAN;
    let error = VertexError::NotFinite { index: 5 };
    let found = scene.set_vertices(ring, &wrong);
    assert_eq!(found, Err(SceneError::Vertices { body: ring, error }));
    wrong[5].z = 1e38;
    let answer = scene.set_vertices(ring, &wrong);
    assert_eq!(answer, Err(SceneError::TooLarge { reach: 1e38 }));
    scene.remove(ring).unwrap();
    let found = scene.set_vertices(ring, &good);
    assert_eq!(found, Err(SceneError::StaleBody { body: ring }));
}

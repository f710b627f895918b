//! Every public query on a scene in units from `2^-330` to `2^330`.
//!
//! The result is that of unit 1 times the power of two: bit for bit or, if a row says so, within
//! its bounds.

mod moving;
mod named;
mod words;
mod worlds;

use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use lin_canny::surface::{BezierPatch, BezierSurface};
use lin_canny::{
    Compound, ConvexPatches, DepthMode, Distance, Geometry, GeometryRef, HalfSpace, Manifold, ManifoldOptions, Mesh,
    PairTracker, QueryOptions, RelativePose, Shape, Tracker,
};
use truth::rng::Rng;
use truth::shapes;
use truth::support::Decide;
use truth::support::body;
use truth::support::piece_at;

const CASES: u64 = 2;

/// Exponents of the units: the ends, both sides of the storage limits of bodies, and some between.
const EXPONENTS: [i32; 19] = [
    -330, -316, -315, -272, -211, -210, -106, -105, -40, 1, 40, 80, 104, 105, 190, 210, 314, 315, 330,
];

type Range = std::ops::RangeInclusive<i32>;

/// All units.
const ALL: Range = -330..=330;

/// Velocities of a few sizes per unit of time are accepted up to 1e100.
const CASTS: Range = -330..=324;

/// Control points are accepted up to `2^200`.
const SURFACES: Range = -211..=198;

/// Bodies of one scene that differ in size, and compounds, are stored in one unit in the middle of
/// a range of `2^210`. Beyond it, other arithmetic may answer, and only the bounds agree.
const MIDDLE: Range = -90..=90;

/// Boxes are stored in single precision, whose normal numbers are from `2^-126` to `2^127`.
const BOXES: Range = -110..=110;

/// Coordinates of scenes are at most 1e37.
const SCENES: Range = -110..=110;

/// A part of a result, with lengths in the unit of the scene.
#[derive(Debug, PartialEq)]
enum Word {
    /// Lower and upper bound of one number.
    Bounds(&'static str, [f64; 2]),
    Other(String),
}

impl Word {
    /// Returns whether two intervals overlap.
    fn agrees(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Bounds(what, [low, high]), Self::Bounds(of, [lower, upper])) => {
                what == of && low <= upper && lower <= high
            }
            _ => false,
        }
    }
}

/// A scene in a unit: all its lengths are multiples of the unit.
struct Scene {
    unit: f64,
    told: Vec<Word>,
}

/// A row: the query, its units, and the units in which the result has the same bits.
type Row = (&'static str, Range, Range, fn(&mut Scene, &mut Rng));

const ROWS: [Row; 20] = [
    ("hulls", ALL, ALL, hulls),
    ("local depths", ALL, ALL, local_depths),
    ("points", ALL, ALL, points),
    ("half-spaces", ALL, ALL, half_spaces),
    ("shapes", ALL, MIDDLE, shape_pairs),
    ("meshes", ALL, ALL, meshes),
    ("contacts of meshes", ALL, MIDDLE, patches),
    ("fit of a hull", ALL, ALL, fits),
    ("compounds", ALL, MIDDLE, compounds),
    ("any two geometries", ALL, MIDDLE, geometries),
    ("surfaces", SURFACES, SURFACES, surfaces),
    ("surfaces and others", SURFACES, MIDDLE, surfaces_and_others),
    ("casts of hulls", CASTS, CASTS, moving::hull_casts),
    ("casts of shapes", CASTS, MIDDLE, moving::shape_casts),
    (
        "casts of meshes and compounds",
        -316..=324,
        MIDDLE,
        moving::composite_casts,
    ),
    ("casts of surfaces", SURFACES, MIDDLE, moving::surface_casts),
    ("clearances", ALL, ALL, moving::clearances),
    ("segments", CASTS, CASTS, moving::segments),
    ("boxes", BOXES, BOXES, worlds::boxes),
    ("scenes", SCENES, MIDDLE, worlds::scenes),
];

/// Runs every row in every unit of its range.
#[test]
fn every_query_scales_by_powers_of_two() {
    let ask = |row: fn(&mut Scene, &mut Rng), exponent: i32, case: u64| {
        let (unit, told) = (2f64.powi(exponent), Vec::new());
        let mut scene = Scene { unit, told };
        row(&mut scene, &mut Rng::of_case(611, case));
        scene.told
    };
    let mut faults = Vec::new();
    for (name, range, same, row) in ROWS {
        for case in 0..CASES {
            let plain = ask(row, 0, case);
            assert!(plain.len() > 10, "{name}: {plain:?}");
            for exponent in EXPONENTS.into_iter().filter(|e| range.contains(e)) {
                let found = ask(row, exponent, case);
                let fault = if same.contains(&exponent) {
                    first_fault(plain.iter(), found.iter(), PartialEq::eq)
                } else {
                    let [plain, found] = [&plain, &found].map(|told| {
                        let is_bound = |word: &&Word| matches!(word, Word::Bounds(..));
                        told.iter().filter(is_bound)
                    });
                    first_fault(plain, found, Word::agrees)
                };
                faults.extend(fault.map(|fault| format!("{name}, case {case}, unit 2^{exponent}: {fault}")));
            }
        }
    }
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

/// Returns the first words that differ, or the numbers of words.
fn first_fault<'a>(
    plain: impl Iterator<Item = &'a Word> + Clone,
    found: impl Iterator<Item = &'a Word> + Clone,
    are_alike: fn(&Word, &Word) -> bool,
) -> Option<String> {
    let counts = (plain.clone().count(), found.clone().count());
    let differing = plain.zip(found).find(|(x, y)| !are_alike(x, y));
    let differing = differing.map(|(x, y)| format!("{x:?} became {y:?}"));
    differing.or_else(|| (counts.0 != counts.1).then(|| format!("{counts:?} words")))
}

/// Distances of the origins: deep, shallow, near contact, separated, far.
const APART: [f64; 7] = [0.1, 0.9, 1.6, 1.75, 1.9, 2.5, 9.0];

/// Distances of the queries.
const WITHIN: [f64; 4] = [0.0, 0.05, 0.3, 2.0];

fn hulls(scene: &mut Scene, rng: &mut Rng) {
    let (a, b) = (scene.round(rng, 20), scene.round(rng, 40));
    let mut options = ManifoldOptions::default().prediction(0.05 * scene.unit);
    let (mut warm, mut local, mut manifold) = (Tracker::new(), Tracker::new(), Manifold::new());
    for apart in APART {
        let pose = scene.pose(rng, apart);
        for tracker in [&mut warm, &mut Tracker::new()] {
            let o = tracker.closest(&a, &b, &pose);
            scene.outcome("closest", &o);
            let (of_a, of_b) = (o.gradient_a(), o.gradient_b(&pose));
            scene.lengths("gradients", of_a.angular.iter().chain(of_b.angular.iter()).copied());
            scene.plain("gradients", (of_a.linear, of_b.linear));
            scene.manifold("of_outcome", &Manifold::from_outcome(&a, &b, &pose, &o, &options));
            scene.lengths("propose", tracker.propose(&a, &b, &pose).distance);
            let d = tracker.distance(&a, &b, &pose);
            scene.distance("distance", &d);
            scene.plain("intersects", tracker.intersects(&a, &b, &pose));
            for d in WITHIN {
                scene.plain("within", tracker.within(&a, &b, &pose, d * scene.unit));
            }
            #[cfg(feature = "exact")]
            scene.outcome("exact", &tracker.closest_exact(&a, &b, &pose));
        }
        for tracker in [&mut local, &mut Tracker::new()] {
            scene.outcome("local depth", &tracker.closest_with_local_depth(&a, &b, &pose));
            scene.plain("overlap proof", tracker.overlap_proof(&a, &b, &pose));
        }
        for local_depth in [false, true] {
            options.local_depth = local_depth;
            warm.manifold(&a, &b, &pose, &options, &mut manifold);
            scene.manifold("manifold", &manifold);
            let still = Vector3::zeros();
            let coming = Vector3::new(-scene.unit, 0.0, 0.0);
            scene.lengths("rate", manifold.rate(&pose, &still, &still, &coming, &still));
        }
    }
}

/// Geometries of every kind without a separate limit, all pairs in both orders.
fn geometries(scene: &mut Scene, rng: &mut Rng) {
    let unit = scene.unit;
    let hull = scene.round(rng, 12);
    let bodies: [Geometry; 4] = [
        hull.clone().into(),
        Shape::cylinder(0.6 * unit, 0.4 * unit).unwrap().into(),
        Mesh::from_convex(&scene.round(rng, 20)).unwrap().into(),
        Compound::from(Shape::from(hull)).into(),
    ];
    let mut tracker = PairTracker::new();
    for (a, b) in bodies.iter().flat_map(|a| bodies.iter().map(move |b| (a, b))) {
        let pose = scene.pose(rng, APART[0]);
        let found = tracker.closest(a, b, &pose);
        scene.distance("closest", &Distance::from(&found));
        scene.lengths(
            "witnesses",
            found.point_on_a.iter().chain(found.point_on_b.iter()).copied(),
        );
        scene.plain("intersects", tracker.decide(a, b, &pose, 0.0));
        scene.plain("within", tracker.decide(a, b, &pose, WITHIN[1] * unit));
        let few = QueryOptions::default().splits(100);
        let decision = tracker.decide_within(a, b, &pose, WITHIN[1] * unit, &few);
        scene.plain("within, few splits", decision);
        let near = ManifoldOptions::default().prediction(0.2 * unit);
        let found = tracker.contacts(a, b, &pose, &near).expect("solids");
        scene.plain("contacts", found.iter().map(|g| g.contacts.len()).collect::<Vec<_>>());
    }
}

/// Thin boxes: several sides may be nearer than the facet of a local depth, from pose to pose.
fn local_depths(scene: &mut Scene, rng: &mut Rng) {
    let [a, b] = [[0.3, 1.0, 1.0], [0.11, 0.11, 1.1]].map(|half| {
        let shape = shapes::cuboid(half);
        body(&shape.stretched([scene.unit; 3]))
    });
    let mut tracker = Tracker::new();
    for _ in 0..60 {
        let at = Vector3::from(std::array::from_fn(|k| rng.range(-1.0, 1.0) * [0.15, 1.0, 0.8][k]));
        let turn = UnitQuaternion::from_scaled_axis(Vector3::from(rng.unit()) * *rng.pick(&[0.0, 0.1]));
        let pose = Isometry3::from_parts((at * scene.unit).into(), turn);
        let pose = RelativePose::from_isometry(&pose).expect("a pose");
        for tracker in [&mut tracker, &mut Tracker::new()] {
            scene.outcome("thin", &tracker.closest_with_local_depth(&a, &b, &pose));
        }
    }
}

fn points(scene: &mut Scene, rng: &mut Rng) {
    let a = scene.round(rng, 30);
    let shapes = curved(scene);
    for _ in 0..20 {
        let p = Point3::from(Vector3::from(rng.in_ball()) * (2.0 * scene.unit));
        scene.plain("contains", a.contains(&p));
        for shape in &shapes {
            scene.plain("shape contains", shape.contains(&p));
        }
        let near = a.closest_point(&p);
        scene.plain("inside", near.is_none());
        scene.lengths("closest point", near.into_iter().flat_map(|q| [q.x, q.y, q.z]));
        scene.plain("extreme vertex", a.extreme_vertex(&p.coords));
    }
}

fn half_spaces(scene: &mut Scene, rng: &mut Rng) {
    let body = scene.round(rng, 30);
    let options = ManifoldOptions::default().prediction(0.2 * scene.unit);
    for apart in APART {
        let floor = HalfSpace::new(Vector3::from(rng.unit()), rng.range(-1.0, 1.0) * scene.unit).expect("a half-space");
        let pose = scene.pose(rng, apart);
        let d = floor.distance(&body, &pose);
        scene.distance("distance", &d);
        let contacts = floor.contacts(&body, &pose, &options);
        for p in contacts.points() {
            let at = p.point_on_plane.iter().chain(p.point_on_body.iter()).copied();
            scene.lengths("contact", at.chain([p.separation]));
            scene.plain("contact", p.vertex);
        }
    }
}

/// Returns one shape of each kind.
fn curved(scene: &Scene) -> Vec<Shape> {
    let u = scene.unit;
    let axes = Vector3::new(1.0, 0.7, 0.5) * u;
    let corners = scene.points(&shapes::octahedron().points);
    [
        Shape::ball(u),
        Shape::capsule(0.8 * u, 0.5 * u),
        Shape::cuboid(axes).and_then(|s| s.rounded(0.25 * u)),
        Shape::hull(&corners),
        Shape::cylinder(0.8 * u, 0.9 * u),
        Shape::cone(0.9 * u, 0.8 * u),
        Shape::ellipsoid(axes),
    ]
    .map(|shape| shape.expect("a shape"))
    .into()
}

fn shape_pairs(scene: &mut Scene, rng: &mut Rng) {
    let shapes = curved(scene);
    let options = ManifoldOptions::default().prediction(0.05 * scene.unit);
    for (k, a) in shapes.iter().enumerate() {
        let b = &shapes[(k + rng.below(shapes.len())) % shapes.len()];
        let (mut warm, mut manifold) = (PairTracker::new(), Manifold::new());
        for apart in [1.2, 1.9, 2.6, 9.0] {
            let pose = scene.pose(rng, apart);
            let name = format!("{k} {apart}");
            scene.outcome(&name, &warm.closest(a, b, &pose));
            scene.outcome(
                &name,
                &PairTracker::new().closest_with(a, b, &pose, &QueryOptions::default().depth(DepthMode::Local)),
            );
            let d = warm.distance(a, b, &pose);
            scene.distance("distance", &d);
            scene.plain(&name, warm.decide(a, b, &pose, 0.0));
            for d in WITHIN {
                scene.plain(&name, warm.decide(a, b, &pose, d * scene.unit));
            }
            warm.manifold(a, b, &pose, &options, &mut manifold).unwrap();
            scene.manifold(&name, &manifold);
        }
    }
}

/// Returns a round body with a dent.
fn dented(scene: &Scene, rng: &mut Rng) -> Mesh {
    let hull = scene.round(rng, 24);
    let mut points: Vec<_> = hull.vertex_points().collect();
    points[0] = Point3::from(points[0].coords * 0.5);
    let triangles: Vec<_> = hull.triangles().map(|t| t.map(|v| v.index() as u32)).collect();
    Mesh::new(&points, &triangles).expect("a mesh")
}

fn meshes(scene: &mut Scene, rng: &mut Rng) {
    let (a, b) = (dented(scene, rng), dented(scene, rng));
    let mut warm = PairTracker::new();
    for apart in APART {
        let pose = scene.pose(rng, apart);
        for tracker in [&mut warm, &mut PairTracker::new()] {
            let o = tracker.closest(&a, &b, &pose);
            let witnesses = [&o.point_on_a, &o.point_on_b];
            scene.nearest("closest", [o.lower, o.upper], o.distance, witnesses);
            scene.plain("closest", (o.state, o.locations, o.normal));
            let d = tracker.distance(&a, &b, &pose);
            scene.distance("distance", &d);
            scene.plain("intersects", tracker.decide(&a, &b, &pose, 0.0));
            for d in WITHIN {
                scene.plain("within", tracker.decide(&a, &b, &pose, d * scene.unit));
            }
            let lower = tracker.lower_bound(&a, &b, &pose);
            scene.lengths("lower bound", [lower]);
            scene.penetration(tracker.penetration(&a, &b, &pose));
            let narrow = QueryOptions::default().width(0.1 * scene.unit).splits(8);
            scene.penetration(tracker.penetration_with(&a, &b, &pose, &narrow));
            scene.overlap(tracker.overlap(&a, &b, &pose));
            scene.loops(tracker.overlap_loops(&a, &b, &pose));
        }
    }
}

/// Contacts of bodies of convex patches.
fn patches(scene: &mut Scene, rng: &mut Rng) {
    let bodies = [dented(scene, rng), dented(scene, rng)].map(ConvexPatches::from_mesh);
    let pieces = [compound(scene, rng), compound(scene, rng)].map(ConvexPatches::from_compound);
    let options = ManifoldOptions::default().prediction(0.2 * scene.unit);
    for [a, b] in [&bodies, &pieces] {
        let mut warm = PairTracker::new();
        for apart in APART {
            let pose = scene.pose(rng, apart);
            for tracker in [&mut warm, &mut PairTracker::new()] {
                let found = tracker.contacts_between(a, b, &pose, &options);
                let separations = found.iter().flat_map(|g| &g.contacts).map(|c| c.point.separation);
                let (deepest, noise) = (separations.fold(9.0 * scene.unit, f64::min), 1e-12 * scene.unit);
                scene.bounds("deepest", deepest - noise, deepest + noise);
                for group in found {
                    scene.plain("direction", group.normal);
                    for contact in &group.contacts {
                        scene.plain("contact", (contact.patches, contact.normal));
                        scene.contact("contact", &contact.point);
                    }
                }
            }
        }
    }
}

fn fits(scene: &mut Scene, rng: &mut Rng) {
    for _ in 0..6 {
        let mesh = dented(scene, rng);
        let hull = mesh.hull().expect("a hull");
        let fit = mesh.hull_fit(&hull);
        scene.bounds("gap", fit.gap_lower, fit.gap_upper);
        // Up to 2^990, a volume is finite.
        let cubed = scene.unit * scene.unit * scene.unit;
        scene.plain("volume", (fit.hull_volume / cubed, mesh.volume() / cubed));
        scene.lengths("centroid", mesh.centroid().iter().copied());
    }
}

fn compound(scene: &Scene, rng: &mut Rng) -> Compound {
    let pieces = (0..3).map(|_| piece_at(scene.place(rng, 0.8), scene.round(rng, 12)));
    Compound::new(pieces.collect()).expect("a compound")
}

fn compounds(scene: &mut Scene, rng: &mut Rng) {
    let (a, b, mesh) = (compound(scene, rng), compound(scene, rng), dented(scene, rng));
    pieces(scene, rng, &a, &b);
    pieces(scene, rng, &a, &mesh);
}

fn pieces<'g>(scene: &mut Scene, rng: &mut Rng, a: impl Into<GeometryRef<'g>>, b: impl Into<GeometryRef<'g>>) {
    let (a, b): (GeometryRef, GeometryRef) = (a.into(), b.into());
    let mut warm = PairTracker::new();
    for apart in APART {
        let pose = scene.pose(rng, apart);
        for tracker in [&mut warm, &mut PairTracker::new()] {
            let o = tracker.closest(a, b, &pose);
            let witnesses = [&o.point_on_a, &o.point_on_b];
            scene.nearest("closest", [o.lower, o.upper], o.distance, witnesses);
            scene.plain("closest", (o.state, o.locations, o.normal));
            scene.plain("intersects", tracker.decide(a, b, &pose, 0.0));
            for d in WITHIN {
                scene.plain("within", tracker.decide(a, b, &pose, d * scene.unit));
            }
            let lower = tracker.lower_bound(a, b, &pose);
            scene.lengths("lower bound", [lower]);
            scene.penetration(tracker.penetration(a, b, &pose));
        }
    }
}

/// Returns a square of bumps, two units wide.
fn bumpy(scene: &Scene, rng: &mut Rng) -> BezierSurface {
    let points = scene.points(&truth::nets::bumps(rng, [2, 2], 0.5));
    let patch = BezierPatch::polynomial([2, 2], &points).expect("a patch");
    BezierSurface::new(vec![patch]).expect("a surface")
}

fn surfaces(scene: &mut Scene, rng: &mut Rng) {
    let (a, b) = (bumpy(scene, rng), bumpy(scene, rng));
    let width = 1e-6 * scene.unit;
    let mut warm = PairTracker::new();
    for apart in [2.6, 4.0, 9.0] {
        let pose = scene.pose(rng, apart);
        let o = warm.closest_with(&a, &b, &pose, &QueryOptions::default().width(width));
        let witnesses = [&o.point_on_a, &o.point_on_b];
        scene.nearest("closest", [o.lower, o.upper], o.distance, witnesses);
        scene.plain("closest", (o.state, o.is_converged, o.locations, o.normal));
        scene.decision("intersects", warm.decide(&a, &b, &pose, 0.0));
        scene.decision("within", warm.decide(&a, &b, &pose, 0.3 * scene.unit));
    }
}

fn surfaces_and_others(scene: &mut Scene, rng: &mut Rng) {
    let (a, shapes, body) = (bumpy(scene, rng), curved(scene), compound(scene, rng));
    let width = 1e-6 * scene.unit;
    for apart in [2.6, 9.0] {
        let pose = scene.pose(rng, apart);
        for shape in &shapes {
            let mut tracker = PairTracker::new();
            let o = tracker.closest_with(&a, shape, &pose, &QueryOptions::default().width(width));
            let witnesses = [&o.point_on_a, &o.point_on_b];
            scene.nearest("shape", [o.lower, o.upper], o.distance, witnesses);
            scene.plain("shape", (o.state, o.is_converged, o.locations, o.normal));
            scene.decision("within", tracker.decide(&a, shape, &pose, 0.3 * scene.unit));
        }
        let mut tracker = PairTracker::new();
        let d = tracker.closest_with(&a, &body, &pose, &QueryOptions::default().width(width));
        scene.distance("compound", &Distance::from(&d));
        scene.decision("within", tracker.decide(&a, &body, &pose, 0.3 * scene.unit));
    }
}

//! `race rays`: the entry point of a ray into a body, in nanoseconds of thread CPU time per ray.
//!
//! Rays start on a sphere of 3 radii (`at`) or 30,000 radii (`far`) around the body. They point to
//! points of a ball of 1.2 radii, so most of them hit the body. `ours` is a proven bracket with
//! point, normal and feature; `parry` is its `cast_ray_and_get_normal`. A ray counts as *other* if
//! one engine reports a hit and the other a miss. It counts as *off* if parry's distance lies
//! outside our bracket by more than a ten-thousandth of the radius.

use std::hint::black_box;

use cpu_time::ThreadTime;
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::{ConvexPolyhedron, Geometry, Ray, RayCast, RayCaster, Shape};
use parry3d_f64::math::Vector;
use parry3d_f64::query::{self, RayIntersection};
use parry3d_f64::shape::{Capsule, Cylinder, TriMesh};
use truth::forms::mesh;
use truth::parry::{self, ParryPose};
use truth::rng::Rng;
use truth::soups;

use race::common::{Options, Rows};

pub(crate) const SCENES: [&str; 2] = ["at", "far"];

/// Rays of a scene, and passes over them.
const RAYS: usize = 2000;
const PASSES: usize = 5;

/// Tolerance by which parry's distance may lie outside our bracket, relative to the radius.
const OFF: f64 = 1e-4;

/// A body of radius about one in the form of each engine.
struct Body {
    name: &'static str,
    n: usize,
    ours: Geometry,
    theirs: Box<dyn query::RayCast>,
}

/// A cylinder of parry, whose axis is y, rotated so that its axis is z.
struct Upright(Cylinder);

impl query::RayCast for Upright {
    fn cast_local_ray_and_get_normal(&self, ray: &query::Ray, most: f64, solid: bool) -> Option<RayIntersection> {
        let turned = |v: Vector| Vector::new(v.x, v.z, -v.y);
        let ray = query::Ray::new(turned(ray.origin), turned(ray.dir));
        self.0.cast_local_ray_and_get_normal(&ray, most, solid)
    }
}

fn hull(n: usize) -> Body {
    let points = truth::shapes::sphere(&mut Rng::new(n as u64), n).points;
    let at: Vec<Point3<f64>> = points.iter().map(|&p| p.into()).collect();
    Body {
        name: "hull",
        n,
        ours: ConvexPolyhedron::from_points(&at).expect("a hull").into(),
        theirs: Box::new(parry::hull(&points).expect("a hull")),
    }
}

fn rock(n: usize) -> Body {
    let soup = soups::rock((n / 20).ilog2() / 2, 3);
    assert_eq!(soup.triangles.len(), n);
    let points = soup.points.iter().map(|p| Vector::new(p[0], p[1], p[2])).collect();
    Body {
        name: "rock",
        n: soup.triangles.len(),
        ours: mesh(&soup).into(),
        theirs: Box::new(TriMesh::new(points, soup.triangles).expect("made meshes are sound")),
    }
}

fn bodies(options: &Options) -> Vec<Body> {
    let round = |name, ours: Shape, theirs| Body {
        name,
        n: 0,
        ours: ours.into(),
        theirs,
    };
    let cylinder = Shape::cylinder(0.7, 0.7).expect("a shape");
    let capsule = Shape::capsule(0.6, 0.4).expect("a shape");
    let mut list = vec![
        round("cylinder", cylinder, Box::new(Upright(Cylinder::new(0.7, 0.7)))),
        round("capsule", capsule, Box::new(Capsule::new_z(0.6, 0.4))),
    ];
    list.extend(options.sizes([8, 32, 128, 512, 2048]).map(hull));
    list.extend(options.sizes([1280, 20_480]).map(rock));
    list
}

/// A ray in the form of each engine.
type Pair = (Ray, query::Ray);

fn rays(far: f64) -> Vec<Pair> {
    let mut rng = Rng::new(5);
    let mut ray = || {
        let from = Vector3::from(rng.unit()) * far;
        let to = Vector3::from(rng.in_ball()) * 1.2;
        let ours = Ray::new(from.into(), to - from).expect("two places");
        let parts = |v: Vector3<f64>| Vector::new(v.x, v.y, v.z);
        (ours, query::Ray::new(parts(from), parts(ours.direction.into_inner())))
    };
    (0..RAYS).map(|_| ray()).collect()
}

/// Returns nanoseconds per ray: the least of some passes.
fn timed(passes: usize, mut pass: impl FnMut()) -> f64 {
    let mut once = || {
        let began = ThreadTime::now();
        pass();
        began.elapsed().as_nanos() as f64 / RAYS as f64
    };
    (0..=passes).map(|_| once()).fold(f64::INFINITY, f64::min)
}

/// Races all bodies from each distance.
pub(crate) fn run(options: &Options) -> Rows {
    let mut rows = Rows::default();
    let head = ["rays", "body", "n", "ours", "parry", "/ours", "hit", "other", "off"];
    println!(
        "{:5} {:9} {:>6} {:>8} {:>8} {:>6} {:>6} {:>6} {:>6}",
        head[0], head[1], head[2], head[3], head[4], head[5], head[6], head[7], head[8]
    );
    for (scene, far) in [("at", 3.0), ("far", 3e4)] {
        for body in bodies(options).iter().filter(|_| options.wants(scene)) {
            race(
                &mut rows,
                scene,
                body,
                &rays(far),
                if options.quick { 1 } else { PASSES },
            );
        }
    }
    rows
}

fn race(rows: &mut Rows, scene: &str, body: &Body, rays: &[Pair], passes: usize) {
    let still = Isometry3::identity();
    let pose = ParryPose::IDENTITY;
    let ours = |caster: &mut RayCaster, ray: &Ray| caster.cast(&body.ours, &still, ray, f64::INFINITY).expect("a ray");
    let theirs = |ray: &query::Ray| body.theirs.cast_ray_and_get_normal(&pose, ray, f64::MAX, true);
    let mine = timed(passes, || {
        let mut caster = RayCaster::new();
        for (ray, _) in rays {
            black_box(ours(&mut caster, ray));
        }
    });
    let parry = timed(passes, || {
        for (_, ray) in rays {
            black_box(theirs(ray));
        }
    });
    let (mut caster, mut hits, mut other, mut off) = (RayCaster::new(), 0, 0, 0);
    for (ray, same) in rays {
        match (ours(&mut caster, ray), theirs(same)) {
            (RayCast::Hit(hit), Some(found)) => {
                hits += 1;
                let at = found.time_of_impact;
                off += usize::from(!(hit.safe - OFF..=hit.hit + OFF).contains(&at));
            }
            (RayCast::Miss, None) => {}
            _ => other += 1,
        }
    }
    println!(
        "{scene:5} {:9} {:6} {mine:8.0} {parry:8.0} {:6.2} {hits:6} {other:6} {off:6}",
        body.name,
        body.n,
        parry / mine
    );
    rows.push((scene, body.name, body.n), "ours", mine, 1);
    rows.push((scene, body.name, body.n), "parry", parry, 1);
}

//! Simulates a sheet of cloth that falls over a ball on a box, with contacts from lin-canny.
//!
//! The motion is position-based dynamics in a few lines. The sheet is one mesh whose vertices are
//! replaced in every substep:
//!
//! 1. Each vertex has a tracker, which computes its distance from the body. A vertex closer than
//!    the thickness of the cloth is pushed out to the thickness.
//! 2. An edge of the box may still cross a triangle whose vertices are all outside. So the mesh is
//!    queried too, and its closest triangle is pushed off the body. This repeats until the proven
//!    distance of the whole cloth exceeds half the thickness, at most `PUSHES` times.
//!
//! `cargo run --release -p race --example cloth` prints the frames and writes the picture
//! `target/cloth.svg`.

mod draw;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use clap::Parser;
use draw::Picture;
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{Compound, ConvexPolyhedron, Geometry, Mesh, PairTracker, Piece, RelativePose, Shape};
use truth::command::{file, write};

/// Squares along a side of the sheet, and half the length of the side in metres.
const SQUARES: usize = 28;
const HALF: f64 = 0.95;

/// Distance in metres that vertices keep from the body.
const THICKNESS: f64 = 0.015;

/// Duration of a substep in seconds, substeps per frame, and number of frames.
const STEP: f64 = 1.0 / 600.0;
const SUBSTEPS: usize = 10;
const FRAMES: usize = 150;

/// Relaxation rounds per substep, and largest number of triangle pushes per substep.
const ROUNDS: usize = 12;
const PUSHES: usize = 60;

/// Fraction of the tangential velocity that a contact removes in a substep.
const FRICTION: f64 = 0.95;

/// Frames that are drawn.
const DRAWN: [usize; 3] = [18, 34, FRAMES - 1];

/// The sheet: positions, positions before the substep, velocities, and lengths to preserve.
struct Cloth {
    mesh: Mesh,
    triangles: Vec<[u32; 3]>,
    places: Vec<Point3<f64>>,
    before: Vec<Point3<f64>>,
    velocities: Vec<Vector3<f64>>,
    /// Two vertices, their rest length, and the fraction of the deviation that one round corrects.
    lengths: Vec<(usize, usize, f64, f64)>,
    /// A tracker for each vertex, and one for the mesh.
    vertices: Vec<PairTracker>,
    whole: PairTracker,
}

/// Results of a substep.
struct Seen {
    /// Proven lower bound of the distance between the cloth and the body.
    lower: f64,
    contacts: usize,
    pushed: usize,
    /// Time spent on contacts.
    time: Duration,
}

fn number(i: usize, j: usize) -> usize {
    i * (SQUARES + 1) + j
}

impl Cloth {
    fn new() -> Result<Self, Box<dyn Error>> {
        let at = |k: usize| HALF * (2.0 * k as f64 / SQUARES as f64 - 1.0);
        let side = 0..=SQUARES;
        let places: Vec<_> = side.clone().flat_map(|i| side.clone().map(move |j| (i, j))).collect();
        // The sheet is tilted and off centre, so that its folds differ.
        let places: Vec<_> = places
            .into_iter()
            .map(|(i, j)| Point3::new(at(i) - 0.03, at(j) + 0.02, 1.15 + 0.02 * at(i)))
            .collect();
        let square = |i: usize, j: usize| {
            let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
            [[a, b, c], [a, c, d]].map(|t| t.map(|v| v as u32))
        };
        let squares = (0..SQUARES).flat_map(|i| (0..SQUARES).map(move |j| (i, j)));
        let triangles: Vec<[u32; 3]> = squares.flat_map(|(i, j)| square(i, j)).collect();
        let mut lengths = Vec::new();
        for i in 0..=SQUARES {
            for j in 0..=SQUARES {
                // Along the threads, across the squares, and over two squares, which resists
                // bending.
                for (k, l, part) in [(1, 0, 1.0), (0, 1, 1.0), (1, 1, 0.6), (2, 0, 0.1), (0, 2, 0.1)] {
                    if i + k <= SQUARES && j + l <= SQUARES {
                        let (a, b) = (number(i, j), number(i + k, j + l));
                        lengths.push((a, b, (places[b] - places[a]).norm(), part));
                    }
                }
            }
        }
        Ok(Self {
            mesh: Mesh::new(&places, &triangles)?,
            triangles,
            before: places.clone(),
            velocities: vec![Vector3::zeros(); places.len()],
            vertices: vec![PairTracker::new(); places.len()],
            whole: PairTracker::new(),
            places,
            lengths,
        })
    }

    /// Advances the cloth by one substep of position-based dynamics (Müller et al. 2007, with small
    /// steps as in Macklin et al. 2019).
    fn step(&mut self, body: &Geometry) -> Result<Seen, Box<dyn Error>> {
        self.before.clone_from(&self.places);
        for (v, p) in self.velocities.iter_mut().zip(&mut self.places) {
            *v = (*v + Vector3::new(0.0, 0.0, -9.81) * STEP) * 0.999;
            *p += *v * STEP;
        }
        for _ in 0..ROUNDS {
            for &(a, b, rest, part) in &self.lengths {
                let way = self.places[b] - self.places[a];
                let length = way.norm();
                let mend = way * (0.5 * part * (length - rest) / length.max(1e-12));
                self.places[a] += mend;
                self.places[b] -= mend;
            }
        }
        let start = Instant::now();
        let (touched, lower, pushed) = self.contacts(body)?;
        let time = start.elapsed();
        for k in 0..self.places.len() {
            let mut velocity = (self.places[k] - self.before[k]) / STEP;
            if let Some(normal) = touched[k] {
                let along = velocity - normal * normal.dot(&velocity);
                velocity = along * (1.0 - FRICTION);
            }
            self.velocities[k] = velocity;
        }
        let contacts = touched.iter().flatten().count();
        Ok(Seen {
            lower,
            contacts,
            pushed,
            time,
        })
    }

    /// Pushes the cloth off the body.
    ///
    /// Returns the normals of the vertices in contact, a lower bound of the distance, and the
    /// number of triangles pushed.
    #[allow(clippy::type_complexity)] // three results of one example
    fn contacts(&mut self, body: &Geometry) -> Result<(Vec<Option<Vector3<f64>>>, f64, usize), Box<dyn Error>> {
        let point = Geometry::from(ConvexPolyhedron::point(Point3::origin())?);
        let mut touched = vec![None; self.places.len()];
        for (k, place) in self.places.iter_mut().enumerate() {
            let pose = RelativePose::from_isometry(&Isometry3::translation(place.x, place.y, place.z))?;
            // A lower bound costs less than a distance, and is enough for most vertices.
            if self.vertices[k].lower_bound(body, &point, &pose) > THICKNESS {
                continue;
            }
            let found = self.vertices[k].closest(body, &point, &pose);
            if found.distance < THICKNESS {
                *place += *found.normal * (THICKNESS - found.distance);
                touched[k] = Some(*found.normal);
            }
        }
        let still = RelativePose::from_isometry(&Isometry3::identity())?;
        self.mesh.set_vertices(&self.places)?;
        for pushed in 0..PUSHES {
            let found = self.whole.closest(&self.mesh, body, &still);
            if found.lower > 0.5 * THICKNESS {
                return Ok((touched, found.lower, pushed));
            }
            self.push_off(
                found.locations[0].subshape as usize,
                &found.point_on_a,
                &-*found.normal,
                found.distance,
            );
            self.mesh.set_vertices(&self.places)?;
        }
        let found = self.whole.closest(&self.mesh, body, &still);
        Ok((touched, found.lower, PUSHES))
    }

    /// Moves the vertices of a triangle so that its point `at` moves outward to 0.7 times the
    /// thickness.
    fn push_off(&mut self, triangle: usize, at: &Point3<f64>, outward: &Vector3<f64>, distance: f64) {
        let corners = self.triangles[triangle].map(|v| v as usize);
        let [a, b, c] = corners.map(|v| self.places[v]);
        let normal = (b - a).cross(&(c - a));
        let share = |p: &Point3<f64>, q: &Point3<f64>| normal.dot(&(p - at).cross(&(q - at))) / normal.norm_squared();
        let weights = [share(&b, &c), share(&c, &a), share(&a, &b)];
        let squares: f64 = weights.iter().map(|w| w * w).sum();
        for (v, weight) in corners.into_iter().zip(weights) {
            self.places[v] += outward * (weight * (0.7 * THICKNESS - distance) / squares);
        }
    }
}

/// Returns a ball on a box.
fn body() -> Result<Compound, Box<dyn Error>> {
    let mut block = Piece::new(solids::cuboid(Vector3::new(0.42, 0.42, 0.3))?);
    let mut ball = Piece::new(Shape::ball(0.36)?);
    ball.pose = Isometry3::translation(-0.05, 0.0, 0.62);
    block.pose = Isometry3::rotation(Vector3::z() * 0.4);
    Ok(Compound::new(vec![block, ball])?)
}

/// Simulate a sheet of cloth that falls over a ball on a box, with new mesh vertices in every
/// substep
#[derive(Parser)]
struct Options {
    /// Output picture
    #[arg(long, value_name = "FILE.svg", default_value = "target/cloth.svg", value_parser = file("svg"))]
    out: PathBuf,
}

fn main() -> ExitCode {
    truth::command::main(|o: &Options| run(&o.out))
}

fn run(out: &Path) -> Result<(), Box<dyn Error>> {
    let body = Geometry::from(body()?);
    let mut cloth = Cloth::new()?;
    let mut picture = Picture::new(DRAWN.len());
    println!("frame  lowest vertex  nearest, proven  contacts  triangles pushed  ms of contacts a frame");
    let mut least = f64::INFINITY;
    for frame in 0..FRAMES {
        let (mut pushed, mut time, mut last) = (0, Duration::ZERO, 0);
        let mut lower = f64::INFINITY;
        for _ in 0..SUBSTEPS {
            let seen = cloth.step(&body)?;
            (pushed, time, last) = (pushed + seen.pushed, time + seen.time, seen.contacts);
            lower = lower.min(seen.lower);
        }
        least = least.min(lower);
        if frame % 10 == 9 {
            let lowest = cloth.places.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
            let ms = time.as_secs_f64() * 1e3;
            println!("{frame:5}  {lowest:13.3}  {lower:15.4}  {last:8}  {pushed:16}  {ms:.1}");
        }
        if DRAWN.contains(&frame) {
            picture.add(&body, &cloth.places, SQUARES);
        }
    }
    let work = cloth.whole.work().trees;
    println!("no point of the cloth was ever nearer to the body than {least:.4} m: proven in every substep");
    println!(
        "the mesh: {} queries, {} bounds of boxes and {} triangles a query, {:.1} % of {} entries of fronts failed",
        work.queries,
        work.bounds / work.queries,
        work.measured / work.queries,
        100.0 * work.failed as f64 / work.entries.max(1) as f64,
        work.entries
    );
    write(out, &picture.finish())?;
    Ok(())
}

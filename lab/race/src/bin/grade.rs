//! Answers a file of cases:
//! `grade [--level walk|certified|exact|parry] [--shapes hull|mesh] [--cold] FILE PART START`.
//!
//! `tests/CASES.md` defines the format of both files. Each case of FILE from number START on gets a
//! line at the end of PART. Each line is flushed, so a driver can restart the program behind a case
//! that crashes it. The tracker is kept along the frames of one motion (unless `--cold`). Witnesses
//! are in each body's frame; those of parry are in the world.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::fs::OpenOptions;
use std::io::Write as _;
use std::time::Instant;

use clap::{Parser, ValueEnum};
use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion};
use lin_canny::{ContactState, ConvexPolyhedron, Geometry, RelativePose, Tracker};
use truth::answers;
use truth::parry;
use truth::queries::QueryCase;
use truth::suite::{Answer, Case, Line, Reader};

/// The level of accuracy that answers.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Accuracy {
    Walk,
    Certified,
    Exact,
    /// parry3d-f64, for comparison; always cold
    Parry,
}

/// How bodies are built: from the vertices alone, or with the given faces.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Shapes {
    Hull,
    Mesh,
}

/// Run the cases of FILE from number START and append one line per case to PART
///
/// tests/CASES.md defines both formats.
#[derive(Parser)]
struct Options {
    /// Level of accuracy
    #[arg(long, value_enum, default_value_t = Accuracy::Certified)]
    level: Accuracy,
    /// Source of the bodies: hull of the vertices, or the faces of the file
    #[arg(long, value_enum, default_value_t = Shapes::Hull)]
    shapes: Shapes,
    /// Use a new tracker for every case
    #[arg(long)]
    cold: bool,
    file: String,
    part: String,
    start: usize,
}

/// Returns a pose from the numbers of the file: unchanged if they are a rotation, otherwise
/// normalised.
fn pose(p: &truth::Pose) -> Isometry3<f64> {
    let [x, y, z, w] = p.q;
    let q = Quaternion::new(w, x, y, z);
    let unit = (q.norm_squared() - 1.0).abs() <= 1e-12;
    let q = if unit {
        UnitQuaternion::new_unchecked(q)
    } else {
        UnitQuaternion::new_normalize(q)
    };
    Isometry3::from_parts(Translation3::new(p.t[0], p.t[1], p.t[2]), q)
}

/// A body of the engine that answers.
enum Body {
    Ours(Box<ConvexPolyhedron>),
    Parry(Box<parry::Hull>),
}

/// Returns the body in the form of the engine that answers.
fn built(shape: &truth::shapes::Shape, o: &Options) -> Result<Body, Box<dyn std::error::Error>> {
    if o.level != Accuracy::Parry {
        return Ok(Body::Ours(Box::new(body(shape, o.shapes == Shapes::Mesh)?)));
    }
    let hull = match o.shapes {
        _ if shape.faces.is_empty() => None, // it has no flat bodies
        Shapes::Hull => parry::hull(&shape.points),
        Shapes::Mesh => parry::mesh(&shape.points, &shape.faces),
    };
    Ok(Body::Parry(Box::new(hull.ok_or("refused")?)))
}

/// Returns the line of parry's contact, at any distance.
fn answer_of_parry(a: &parry::Hull, b: &parry::Hull, case: &Case) -> String {
    let unit = |p: &truth::Pose| truth::Pose {
        q: truth::pose::unit_quat(p.q),
        t: p.t,
    };
    let (pa, pb) = (parry::pose(&unit(&case.pose_a)), parry::pose(&unit(&case.pose_b)));
    let began = Instant::now();
    let found = parry::contact(a, &pa, b, &pb, f64::MAX);
    let nanoseconds = began.elapsed().as_nanos() as u64;
    let status = match &found {
        None => "none",
        Some(c) if c.dist > 0.0 => "sep",
        Some(c) if c.dist < 0.0 => "pen",
        Some(_) => "touch",
    };
    let answer = Answer {
        id: case.id,
        status,
        distance: found.as_ref().map(|c| c.dist),
        witnesses: found.as_ref().map(|c| (c.point1.into(), c.point2.into())),
        normal: found.as_ref().map(|c| c.normal1.into()),
        nanoseconds,
    };
    format!("{answer}\n")
}

/// Returns the line of a query of version 2: the distance column has the time of casts and rays.
fn answer_query(case: &QueryCase, bodies: &HashMap<usize, Geometry>) -> String {
    let [a, b] = case.query.bodies().map(|id| bodies.get(&id));
    let began = Instant::now();
    let found = a.zip(b).map(|(a, b)| answers::answer(&case.query, [a, b]));
    let nanoseconds = began.elapsed().as_nanos() as u64;
    let (status, distance) = match &found {
        None => ("noshape", None),
        Some(Err(_)) => ("none", None),
        Some(Ok(found)) => (
            found.state.map_or("none", truth::ContactState::word),
            Some(0.5 * found.lower + 0.5 * found.upper),
        ),
    };
    let answer = Answer {
        id: case.id,
        status,
        distance: distance.filter(|x| x.is_finite()),
        witnesses: None,
        normal: None,
        nanoseconds,
    };
    format!("{answer}\n")
}

fn body(shape: &truth::shapes::Shape, mesh: bool) -> Result<ConvexPolyhedron, Box<dyn std::error::Error>> {
    let points: Vec<_> = shape.points.iter().map(|&p| Point3::from(p)).collect();
    Ok(match (mesh && !shape.faces.is_empty(), points.len()) {
        (true, _) => ConvexPolyhedron::from_faces(&points, &shape.faces)?,
        (false, 1) => ConvexPolyhedron::point(points[0])?,
        (false, 2) => ConvexPolyhedron::segment(points[0], points[1])?,
        (false, _) => ConvexPolyhedron::from_points(&points).or_else(|_| ConvexPolyhedron::polygon(&points))?,
    })
}

/// Returns one line of the answer file.
fn answer(
    tracker: &mut Tracker,
    level: Accuracy,
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    case: &Case,
    layers: &mut Layers,
) -> Result<String, Box<dyn std::error::Error>> {
    let (pa, pb) = (pose(&case.pose_a), pose(&case.pose_b));
    let began = Instant::now();
    let relative = RelativePose::new(&pa, &pb)?;
    let (state, distance, on_a, on_b, normal, layer) = match level {
        Accuracy::Walk => {
            let p = tracker.propose(a, b, &relative);
            let state = if p.distance == Some(0.0) {
                ContactState::Touching
            } else if p.distance.is_some() {
                ContactState::Separated
            } else {
                ContactState::Overlapping
            };
            (
                state,
                p.distance.unwrap_or(0.0),
                p.point_on_a,
                p.point_on_b,
                p.normal,
                p.solver,
            )
        }
        Accuracy::Certified => {
            let o = tracker.closest(a, b, &relative);
            (o.state, o.distance, o.point_on_a, o.point_on_b, o.normal, o.solver)
        }
        Accuracy::Exact => {
            let o = tracker.closest_exact(a, b, &relative);
            (o.state, o.distance, o.point_on_a, o.point_on_b, o.normal, o.solver)
        }
        Accuracy::Parry => unreachable!("another function answers"),
    };
    let ns = began.elapsed().as_nanos();
    layers.count(&case.family, state, layer as usize);
    let word = match state {
        ContactState::Separated => "sep",
        ContactState::Touching => "touch",
        ContactState::Overlapping => "pen",
        _ => "none",
    };
    let n = pa.rotation * normal;
    let mut line = format!("{} {word} {distance:e}", case.id);
    for x in on_a.iter().chain(on_b.iter()).chain(n.iter()) {
        write!(line, " {x:e}")?;
    }
    writeln!(line, " {ns}")?;
    Ok(line)
}

/// Cases that each solver answered, per family, separated and not.
#[derive(Default)]
struct Layers(HashMap<String, [[u64; 7]; 2]>);

impl Layers {
    fn count(&mut self, family: &str, state: ContactState, layer: usize) {
        let row = self.0.entry(family.to_owned()).or_default();
        row[usize::from(state != ContactState::Separated)][layer] += 1;
    }

    fn print(&self) {
        let mut families: Vec<_> = self.0.iter().collect();
        families.sort();
        eprintln!(
            "{:<16} {:>5} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}",
            "family", "", "walk", "restart", "fallback", "dd", "exact", "far", "surface"
        );
        let mut sums = [[0; 7]; 2];
        let line = |name: &str, kind: &str, row: &[u64; 7]| {
            let cells: String = row.iter().map(|n| format!(" {n:>9}")).collect();
            eprintln!("{name:<16} {kind:>5}{cells}");
        };
        for (name, rows) in families {
            for (k, kind) in ["sep", "other"].iter().enumerate() {
                line(name, kind, &rows[k]);
                for (sum, n) in sums[k].iter_mut().zip(rows[k]) {
                    *sum += n;
                }
            }
        }
        line("all", "sep", &sums[0]);
        line("all", "other", &sums[1]);
    }
}

fn run(o: &Options) -> Result<(), Box<dyn std::error::Error>> {
    let mut part = OpenOptions::new().create(true).append(true).open(&o.part)?;
    let engine = match o.level {
        Accuracy::Walk => "lin-canny walk",
        Accuracy::Certified => "lin-canny certified",
        Accuracy::Exact => "lin-canny exact",
        Accuracy::Parry => "parry3d-f64",
    };
    // The walk alone computes no depth.
    let signed = if o.level == Accuracy::Walk { "no" } else { "yes" };
    let frame = if o.level == Accuracy::Parry { "world" } else { "local" };
    writeln!(
        part,
        "# engine {engine}\n# signed {signed}\n# witness {frame}\n# normal yes\n# distance yes"
    )?;
    let mut bodies: HashMap<usize, Option<Body>> = HashMap::new();
    let mut queried: HashMap<usize, Geometry> = HashMap::new();
    let (mut tracker, mut sequence, mut layers, mut seen) = (Tracker::new(), None, Layers::default(), 0);
    for line in Reader::open(&o.file)? {
        match line? {
            Line::Header(_) => {}
            Line::Shape(s) => {
                if o.level != Accuracy::Parry
                    && let Ok(body) = answers::body(&s)
                {
                    queried.insert(s.id, body);
                }
                if s.is_mesh {
                    continue;
                }
                let built = built(&s.shape, o)
                    .inspect_err(|e| eprintln!("shape {}: {e}", s.id))
                    .ok();
                bodies.insert(s.id, built);
            }
            Line::Query(case) => {
                seen += 1;
                if seen > o.start {
                    part.write_all(answer_query(&case, &queried).as_bytes())?;
                }
            }
            Line::Case(case) => {
                seen += 1;
                if o.cold || case.sequence.is_none() || case.sequence != sequence {
                    tracker.reset();
                }
                sequence = case.sequence;
                if seen <= o.start {
                    continue;
                }
                let (a, b) = (
                    bodies.get(&case.a).and_then(Option::as_ref),
                    bodies.get(&case.b).and_then(Option::as_ref),
                );
                let text = match (a, b) {
                    (Some(Body::Ours(a)), Some(Body::Ours(b))) => {
                        answer(&mut tracker, o.level, a, b, &case, &mut layers)?
                    }
                    (Some(Body::Parry(a)), Some(Body::Parry(b))) => answer_of_parry(a, b, &case),
                    _ => format!("{} noshape - - - - - - - - - - -\n", case.id),
                };
                part.write_all(text.as_bytes())?;
            }
        }
    }
    if o.level != Accuracy::Parry {
        layers.print();
    }
    Ok(())
}

fn main() -> std::process::ExitCode {
    truth::command::main(run)
}

//! Measures what simpler questions save: one motion, every question, and inner hulls with a bound.
//!
//! **Inner and outer hulls.** Let I be the hull of some vertices of a body P, and h the greatest
//! distance of a vertex of P from I. The distance from the convex body I is a convex function, so
//! over P it is greatest at a vertex: every point of P is within h of I. Hence I lies in P, P lies
//! in I grown by h, and in every direction the support value of P exceeds that of I by 0 to h. So
//! the signed distance of two bodies is at most that of their inner hulls, and at least that less
//! the sum of both h.

use lin_canny::nalgebra::{Isometry3, Point3};
use lin_canny::{ConvexPolyhedron, Manifold, ManifoldOptions, RelativePose, Tracker};
use race::progress::Progress;
use race::record::{Row, spread};
use truth::motion::Frame;
use truth::pose::{norm, sub};

use crate::engines::clocked;
use crate::options::Options;
use crate::truth::Sampled;
use truth::pairs::{self, Body, Pair};

type Trouble = Box<dyn std::error::Error>;

/// Vertices of each body.
pub(crate) const SIZE: usize = 512;

/// Motions in degrees per frame.
pub(crate) const DEGREES: [&str; 2] = ["0.05", "1"];

/// Vertices of the inner hulls.
const INNER: [usize; 2] = [16, 64];

/// The distance of the `within` queries.
const NEAR: f64 = 0.1;

/// An inner hull of a body, with its bound.
struct Detail {
    inner: ConvexPolyhedron,
    /// Greatest distance of a point of the body from the inner hull.
    bound: f64,
}

impl Detail {
    /// Repeatedly selects the vertex farthest from the vertices selected so far.
    fn new(body: &Body, count: usize) -> Result<Self, Trouble> {
        let mut far: Vec<f64> = body.points.iter().map(|&p| norm(sub(p, body.points[0]))).collect();
        let mut chosen = vec![body.points[0]];
        while chosen.len() < count.min(body.points.len()) {
            let next = (0..far.len()).fold(0, |best, k| if far[k] > far[best] { k } else { best });
            let p = body.points[next];
            chosen.push(p);
            far.iter_mut()
                .zip(&body.points)
                .for_each(|(d, &q)| *d = d.min(norm(sub(p, q))));
        }
        let cloud: Vec<Point3<f64>> = chosen.iter().map(|&p| p.into()).collect();
        let inner = ConvexPolyhedron::from_points(&cloud)?;
        let (mut tracker, mut bound) = (Tracker::new(), 0.0f64);
        for p in body.ours.vertex_points() {
            let point = ConvexPolyhedron::point(Point3::origin())?;
            let pose = RelativePose::from_isometry(&Isometry3::translation(p.x, p.y, p.z))?;
            bound = bound.max(tracker.distance(&inner, &point, &pose).upper);
        }
        Ok(Self { inner, bound })
    }
}

/// The questions, each with the state that it keeps.
enum Ask<'a> {
    Overlap(Tracker),
    Within(Tracker),
    Distance(Tracker),
    Walk(Tracker),
    Certified(Tracker),
    Exact(Tracker),
    Manifold(Tracker, Box<Manifold>),
    Inner(&'a [Detail; 2], Tracker),
    ParryOverlap,
    ParryDistance,
}

/// The engine and the name of a question.
type Question = (&'static str, String);

fn yes_no(yes: bool) -> f64 {
    f64::from(u8::from(yes))
}

impl Ask<'_> {
    fn has_error(&self) -> bool {
        !matches!(self, Ask::Overlap(_) | Ask::Within(_) | Ask::ParryOverlap)
    }

    /// Answers one question for one frame: a distance, or 1 for yes and 0 for no.
    #[inline(always)]
    fn ask(&mut self, pair: &Pair, frame: usize) -> f64 {
        let (a, b) = (&pair.a.ours, &pair.b.ours);
        let f: &Frame = &pair.frames[frame];
        let (pa, pb) = &pair.isometries[frame];
        let relative = || RelativePose::new(pa, pb).expect("poses of a motion");
        match self {
            Ask::Overlap(t) => yes_no(t.intersects(a, b, &relative())),
            Ask::Within(t) => yes_no(t.within(a, b, &relative(), NEAR)),
            Ask::Distance(t) => t.distance(a, b, &relative()).value,
            Ask::Walk(t) => t.propose(a, b, &relative()).distance.unwrap_or(0.0),
            Ask::Certified(t) => t.closest(a, b, &relative()).distance,
            Ask::Exact(t) => t.closest_exact(a, b, &relative()).distance,
            Ask::Manifold(t, m) => {
                t.manifold(a, b, &relative(), &ManifoldOptions::default().prediction(f64::MAX), m);
                m.points().iter().fold(f64::INFINITY, |d, p| d.min(p.separation))
            }
            Ask::Inner([a, b], t) => t.distance(&a.inner, &b.inner, &relative()).value - 0.5 * (a.bound + b.bound),
            Ask::ParryOverlap => match (&pair.a.parry, &pair.b.parry) {
                (Some(a), Some(b)) => yes_no(truth::parry::intersect(a, &f.a, b, &f.b)),
                _ => f64::NAN,
            },
            Ask::ParryDistance => match (&pair.a.parry, &pair.b.parry) {
                (Some(a), Some(b)) => truth::parry::closest_points(a, &f.a, b, &f.b).map_or(0.0, |w| w.distance),
                _ => f64::NAN,
            },
        }
    }
}

/// Returns a constructor for each question.
fn questions<'a>(details: &'a [[Detail; 2]]) -> Vec<(Question, Box<dyn Fn() -> Ask<'a> + 'a>)> {
    let mut all: Vec<(Question, Box<dyn Fn() -> Ask<'a> + 'a>)> = vec![
        (("ours", "overlap?".into()), Box::new(|| Ask::Overlap(Tracker::new()))),
        (("ours", "within 0.1?".into()), Box::new(|| Ask::Within(Tracker::new()))),
    ];
    all.extend([
        (
            ("ours", "distance".into()),
            Box::new(|| Ask::Distance(Tracker::new())) as Box<dyn Fn() -> Ask<'a> + 'a>,
        ),
        (
            ("ours", "witnesses (walk)".into()),
            Box::new(|| Ask::Walk(Tracker::new())),
        ),
        (
            ("ours", "witnesses (certified)".into()),
            Box::new(|| Ask::Certified(Tracker::new())),
        ),
        (("ours", "exact".into()), Box::new(|| Ask::Exact(Tracker::new()))),
        (
            ("ours", "manifold".into()),
            Box::new(|| Ask::Manifold(Tracker::new(), Box::default())),
        ),
    ]);
    for (list, m) in details.iter().zip(INNER) {
        all.push((
            ("detail", format!("inner hull of {m}")),
            Box::new(move || Ask::Inner(list, Tracker::new())),
        ));
    }
    all.extend([
        (
            ("parry-f64", "overlap?".into()),
            Box::new(|| Ask::ParryOverlap) as Box<dyn Fn() -> Ask<'a> + 'a>,
        ),
        (("parry-f64", "witnesses".into()), Box::new(|| Ask::ParryDistance)),
    ]);
    all
}

pub(crate) fn count(options: &Options) -> u64 {
    if options.does("asking") {
        DEGREES.len() as u64
    } else {
        0
    }
}

pub(crate) fn run(options: &Options, rows: &mut Vec<Row>, progress: &Progress) -> Result<usize, Trouble> {
    println!("\nOne motion, every question: flat bodies, gaps from 2 to 52 % of the radius; `within` asks for {NEAR}");
    println!(
        "{:<16} {:>6}  {:<10} {:<28} {:>9} {:>17}  {:>9}  proven",
        "family", "n", "engine", "question", "ns", "from .. to", "error"
    );
    let mut size = SIZE;
    for degrees in DEGREES {
        let pair = match options.meshes() {
            Some([a, b]) => Pair::new(pairs::mesh(a)?, pairs::mesh(b)?),
            None => Pair::of("flat", SIZE)?,
        };
        size = pair.a.points.len();
        let pair = pair.swinging(degrees.parse()?, options.frames());
        let family = format!("asking {degrees}deg");
        progress.say(&family);
        let details: Result<Vec<[Detail; 2]>, Trouble> = INNER
            .iter()
            .map(|&m| Ok([Detail::new(&pair.a, m)?, Detail::new(&pair.b, m)?]))
            .collect();
        one(&pair, &details?, (&family, size), options, rows);
        progress.step();
    }
    Ok(size)
}

fn one(pair: &Pair, details: &[[Detail; 2]], (family, n): (&str, usize), options: &Options, rows: &mut Vec<Row>) {
    let truth = Sampled::new(pair, options.sampled());
    let list = questions(details);
    let mut times = vec![Vec::new(); list.len()];
    for _ in 0..options.passes() {
        for ((_, fresh), times) in list.iter().zip(&mut times) {
            times.push(clocked(pair.frames.len(), fresh, |f, ask| ask.ask(pair, f)));
        }
    }
    for (((engine, level), fresh), ns) in list.iter().zip(&times) {
        let mut ask = fresh();
        let answers: Vec<f64> = (0..pair.frames.len()).map(|f| ask.ask(pair, f)).collect();
        let errors = if ask.has_error() {
            truth.errors(ns.len(), |f| answers[f])
        } else {
            vec![f64::NAN; ns.len()]
        };
        print(family, n, (engine, level), ns, &errors, &proven(&ask, pair));
        rows.extend(ns.iter().zip(&errors).map(|(&ns, &err)| Row {
            engine: (*engine).into(),
            level: level.clone(),
            family: family.into(),
            n,
            ns,
            err,
        }));
    }
}

/// Returns the error bound that an answer proves, relative to the size of the pair.
fn proven(ask: &Ask, pair: &Pair) -> String {
    let size = pair.size(0);
    match ask {
        Ask::Walk(_) | Ask::ParryDistance | Ask::ParryOverlap => "nothing".into(),
        Ask::Inner([a, b], _) => format!("{:.1e}", 0.5 * (a.bound + b.bound) / size),
        Ask::Distance(_) | Ask::Certified(_) | Ask::Manifold(..) => "1e-13".into(),
        Ask::Exact(_) => "one unit in the last place".into(),
        _ => "exact".into(),
    }
}

fn print(family: &str, n: usize, (engine, level): (&str, &str), ns: &[f64], errors: &[f64], proven: &str) {
    let (t, e) = (spread(ns.iter().copied()), spread(errors.iter().copied()));
    let error = if e[2].is_nan() {
        "-".into()
    } else {
        format!("{:.1e}", e[2])
    };
    println!(
        "{family:<16} {n:>6}  {engine:<10} {level:<28} {:>9.1} {:>8.1} {:>8.1}  {error:>9}  {proven}",
        t[1], t[0], t[2]
    );
}

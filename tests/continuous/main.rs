//! Promise: first contacts of vertices on straight paths agree with exact arithmetic: no false
//! miss, no false hit, and touching is decided.

mod arcs;
mod half_turns;
mod height_fields;
mod kinds;
mod limits;
mod meshes;

use lin_canny::continuous::elements;
use lin_canny::impact::{Cast, Impact, ImpactError, Tolerance};
use lin_canny::nalgebra::Point3;
use truth::paths::families::{self, KINDS};
use truth::paths::{self, Path, Truth};
use truth::rational::exact;
use truth::rng::Rng;

/// Variable that sets the number of queries of each kind.
const MANY: &str = "LIN_CANNY_QUERIES";

fn count() -> usize {
    std::env::var(MANY).map_or(400, |n| n.parse().expect("a number of queries"))
}

fn given<const N: usize>(paths: &[Path]) -> elements::Positions<N> {
    std::array::from_fn(|k| paths[k].map(Point3::from))
}

#[derive(Debug, Default)]
struct Tally {
    apart: usize,
    start: usize,
    hits: usize,
    open: usize,
    wide: usize,
    queries: u64,
    proofs: usize,
}

impl Tally {
    /// Compares an answer with the oracle.
    fn judge(&mut self, cast: &Cast, truth: &Truth, width: f64, case: &dyn std::fmt::Debug) {
        self.queries += u64::from(cast.queries);
        self.proofs += cast.proofs as usize;
        match (cast.impact, truth) {
            (Impact::Miss, Truth::Apart) => self.apart += 1,
            (Impact::AtStart { .. }, Truth::Start) => self.start += 1,
            (Impact::Hit { safe, hit, seen }, Truth::At(low, high)) => {
                assert!(exact(safe) < *high && *low < exact(hit), "{cast:?} {truth:?} {case:?}");
                assert!(0.0 <= safe && safe < hit && hit <= 1.0, "{cast:?}");
                assert!(seen.lower >= 0.0 && seen.lower <= seen.upper, "{cast:?} {case:?}");
                self.hits += 1;
                self.wide += usize::from(hit - safe > width);
            }
            (Impact::Incomplete { safe } | Impact::Undecided { safe, .. }, _) => {
                match truth {
                    Truth::At(_, high) => assert!(exact(safe) < *high, "{cast:?} {truth:?} {case:?}"),
                    Truth::Start => assert!(safe == 0.0, "{cast:?} {case:?}"),
                    Truth::Apart => {}
                }
                self.open += 1;
            }
            _ => panic!("{cast:?} {truth:?} {case:?}"),
        }
    }
}

const WIDTH: f64 = 1e-6;

fn run(
    name: &str,
    split: families::Split,
    count: usize,
    ask: impl Fn(&[Path]) -> Result<Cast, ImpactError>,
    truth: impl Fn(&[Path]) -> Truth,
) {
    let mut sum = [0; 3];
    for (i, kind) in KINDS.iter().enumerate() {
        let mut tally = Tally::default();
        for k in 0..count {
            let paths = families::make(kind, split, &mut Rng::of_case(i as u64 + 47, k as u64));
            let cast = ask(&paths).unwrap();
            tally.judge(&cast, &truth(&paths), WIDTH, &(kind, k, &paths));
        }
        let Tally {
            apart,
            start,
            hits,
            open,
            wide,
            queries,
            proofs,
        } = tally;
        println!(
            "{name} {kind}: apart {apart}, start {start}, hits {hits} ({wide} wide), open {open}; {:.1} intervals, {:.2} proofs",
            queries as f64 / count as f64,
            proofs as f64 / count as f64
        );
        assert_eq!(open, 0, "{name} {kind}: exact arithmetic decides");
        sum = [sum[0] + apart, sum[1] + start, sum[2] + hits];
    }
    assert!(sum.iter().all(|n| *n > count), "{sum:?}");
}

#[test]
fn a_vertex_and_a_face_meet_when_exact_arithmetic_says() {
    let ask = |p: &[Path]| elements::cast_vertex_face(&given(&p[..1]), &given(&p[1..]), Tolerance::Time(WIDTH));
    run("vertex-face", (1, 3), count(), ask, |p| {
        paths::vertex_face(p.try_into().unwrap())
    });
}

#[test]
fn two_edges_meet_when_exact_arithmetic_says() {
    let ask = |p: &[Path]| elements::cast_edge_edge(&given(&p[..2]), &given(&p[2..]), Tolerance::Time(WIDTH));
    run("edge-edge", (2, 2), count(), ask, |p| {
        paths::edge_edge(p.try_into().unwrap())
    });
}

#[test]
fn two_triangles_meet_when_exact_arithmetic_says() {
    let ask = |p: &[Path]| elements::cast_triangles(&given(&p[..3]), &given(&p[3..]), Tolerance::Time(WIDTH));
    let truth = |p: &[Path]| paths::triangles(p[..3].try_into().unwrap(), p[3..].try_into().unwrap());
    run("triangles", (3, 3), count() / 10, ask, truth);
}

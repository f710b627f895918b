//! Every case of `tests/corpus/`, at every level and in every disguise, and its motions tracked.
//! `tests/corpus/README.md` defines the format.

use std::path::Path;

use lin_canny::{ConvexPolyhedron, FeaturePair, Outcome, Tracker};
use truth::corpus::{self, Case};
use truth::rng::Rng;
use truth::shapes::Shape;
use truth::support::{between, body, pairs, state};
use truth::{Pose, bound};

fn cases() -> Vec<Case> {
    let all = corpus::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus"));
    assert!(all.len() >= 300, "the corpus has shrunk to {} cases", all.len());
    all
}

/// Returns whether the oracle takes only milliseconds for the bodies.
fn is_small(c: &Case) -> bool {
    c.is_small(16)
}

/// Judges one outcome against the values of the case.
///
/// `unit` is the scale of the disguise, `exactly` selects the exact level, and `moved` means that
/// the disguise moves the bodies by rounding.
fn judge(c: &Case, o: &Outcome, unit: f64, exactly: bool, what: &str) {
    let what = format!("{} {what}: {o:?}", c.name);
    assert_eq!(o.state, state(c.state), "{what}");
    assert!(o.lower <= o.distance && o.distance <= o.upper, "{what}");
    if let (truth::ContactState::Separated, Some(d)) = (c.state, c.distance) {
        let d = d * unit;
        // The file has the distance rounded to nearest: the true distance is within half a unit in
        // the last place.
        assert!(o.lower <= d.next_up(), "{what} misses {d:e}");
        assert!(o.upper >= d.next_down(), "{what} misses {d:e}");
        let slack = if exactly {
            d.next_up() - d
        } else {
            1e-14 * c.size() * unit
        };
        assert!((o.distance - d).abs() <= slack, "{what} is not {d:e}");
    }
    if let (truth::ContactState::Overlapping, Some(d)) = (c.state, c.distance) {
        let (d, slack) = (d * unit, 1e-14 * c.size() * unit);
        assert!((o.distance - d).abs() <= slack, "{what} is not {d:e}");
        assert!(o.lower <= d.next_up(), "{what} misses {d:e}");
        assert!(o.upper >= d.next_down(), "{what} misses {d:e}");
        assert!(o.upper - o.lower <= 10.0 * slack, "{what} misses {d:e}");
    }
}

fn ask(c: &Case, a: &ConvexPolyhedron, b: &ConvexPolyhedron, poses: (&Pose, &Pose), unit: f64, what: &str) {
    let pose = between(poses.0, poses.1);
    let p = Tracker::new().propose(a, b, &pose);
    let numbers = p.point_on_a.iter().chain(p.point_on_b.iter()).chain(p.normal.iter());
    assert!(
        numbers.copied().chain(p.distance).all(f64::is_finite),
        "{} {what}: {p:?}",
        c.name
    );
    let o = Tracker::new().closest(a, b, &pose);
    judge(c, &o, unit, false, what);
    let o = Tracker::new().closest_exact(a, b, &pose);
    judge(c, &o, unit, true, &format!("{what}, exactly"));
    let mut pair = Tracker::new();
    let found = pair.intersects(a, b, &pose);
    assert_eq!(found, c.state != truth::ContactState::Separated, "{} {what}", c.name);
}

/// Returns at most `most` of the pairs, spread over all.
fn starts(a: &ConvexPolyhedron, b: &ConvexPolyhedron, most: usize) -> Vec<FeaturePair> {
    if a.vertex_count() * b.vertex_count() > 2000 {
        return vec![];
    }
    let all = pairs(a, b);
    let step = all.len().div_ceil(most).max(1);
    all.into_iter().step_by(step).collect()
}

fn run(c: &Case) {
    let (a, b) = (body(&c.a), body(&c.b));
    ask(c, &a, &b, (&c.pose_a, &c.pose_b), 1.0, "as it is");
    ask(c, &b, &a, (&c.pose_b, &c.pose_a), 1.0, "letters exchanged");
    let pose = between(&c.pose_a, &c.pose_b);
    for start in starts(&a, &b, 1000) {
        let o = Tracker::with_features(start, &a, &b).closest(&a, &b, &pose);
        judge(c, &o, 1.0, false, &format!("from {start}"));
    }
    for k in [-35, 35, 90] {
        let unit = 2f64.powi(k);
        // If the case leaves the range at the other end, it does not test the scale.
        if c.size() * unit > 1e200 || c.distance.is_some_and(|d| d != 0.0 && d.abs() * unit < 1e-290) {
            continue;
        }
        let scaled = |s: &Shape| body(&s.clone().stretched([unit; 3]));
        let poses = (&c.pose_a.scaled(unit), &c.pose_b.scaled(unit));
        ask(c, &scaled(&c.a), &scaled(&c.b), poses, unit, &format!("times 2^{k}"));
    }
    let mut rng = Rng::new(71);
    let (sa, sb) = (c.a.clone().shuffled(&mut rng), c.b.clone().shuffled(&mut rng));
    ask(
        c,
        &body(&sa),
        &body(&sb),
        (&c.pose_a, &c.pose_b),
        1.0,
        "points in another order",
    );
    moved(c, &a, &b);
}

/// Moves both together: only the rounding of the poses may have an effect.
fn moved(c: &Case, a: &ConvexPolyhedron, b: &ConvexPolyhedron) {
    let common = Pose::turn(truth::pose::unit([1.0, -2.0, 0.5]), 0.9, [3.0, 1.0, -2.0]);
    let (pa, pb) = (common.after(&c.pose_a), common.after(&c.pose_b));
    let o = Tracker::new().closest(a, b, &between(&pa, &pb));
    let slack = 1e-14 * (c.size() + 10.0 + truth::pose::norm(c.pose_a.t) + truth::pose::norm(c.pose_b.t));
    let truth = if c.state == truth::ContactState::Touching {
        Some(0.0)
    } else {
        c.distance
    };
    if let Some(d) = truth.filter(|d| d.abs() > slack) {
        assert_eq!(o.state, state(c.state), "{} moved: {o:?}", c.name);
        assert!((o.distance - d).abs() <= slack, "{} moved: {o:?}, not {d:e}", c.name);
    }
}

/// Along the motions of the corpus, one tracker answers every frame, and another with A and B
/// exchanged.
#[test]
fn motions_are_tracked() {
    let mut trackers = (Tracker::new(), Tracker::new());
    let (mut motion, mut classes) = (None, [0; 4]);
    for c in cases().iter().filter(|c| c.motion.is_some()) {
        if motion != c.motion {
            trackers = Default::default();
            motion.clone_from(&c.motion);
        }
        let (a, b, pose) = (body(&c.a), body(&c.b), between(&c.pose_a, &c.pose_b));
        let o = trackers.0.closest(&a, &b, &pose);
        judge(c, &o, 1.0, false, "tracked");
        judge(
            c,
            &trackers.1.closest(&b, &a, &pose.swapped()),
            1.0,
            false,
            "tracked, letters exchanged",
        );
        classes[o.state as usize] += 1;
    }
    let [apart, touching, overlapping, _] = classes;
    assert!(apart > 40 && touching > 20 && overlapping > 20, "{classes:?}");
}

#[test]
fn every_case_at_every_level_in_every_disguise() {
    for case in cases() {
        run(&case);
    }
}

#[test]
fn the_oracle_agrees_with_the_corpus() {
    let mut judged = 0;
    for c in cases().iter().filter(|c| is_small(c)) {
        let truth = c.truth();
        assert_eq!(
            truth.state, c.state,
            "{}: the truth is {} {:e}",
            c.name, truth.state, truth.distance
        );
        if let Some(d) = c.distance {
            assert_eq!(d, truth.distance, "{}", c.name);
        } else {
            assert_ne!(
                c.state,
                truth::ContactState::Separated,
                "{}: the distance is {:e}",
                c.name,
                truth.distance
            );
        }
        judged += 1;
    }
    assert!(judged >= 80, "{judged}");
}

/// Bodies too large for the oracle: the exact gap along the normal and the exact distance of the
/// witnesses enclose the distance of the file.
#[test]
fn exact_bounds_agree_with_the_corpus() {
    let mut judged = 0;
    for c in cases()
        .iter()
        .filter(|c| !is_small(c) && c.state == truth::ContactState::Separated)
    {
        let (a, b) = (body(&c.a), body(&c.b));
        let o = Tracker::new().closest(&a, &b, &between(&c.pose_a, &c.pose_b));
        let n = c.pose_a.isometry().rotation * o.normal;
        let n = n.into_inner().into();
        let p = o.point_on_a.coords.into();
        let q = o.point_on_b.coords.into();
        let low = bound::support_gap((&c.a).into(), &c.pose_a, (&c.b).into(), &c.pose_b, n);
        let high = bound::witness_distance(p, &c.pose_a, q, &c.pose_b);
        let (d, slack) = (c.distance.expect("separated cases have a distance"), 1e-14 * c.size());
        assert!(low <= d.next_up(), "{}: {low:e} {d:e} {high:e}", c.name);
        assert!(d - low <= slack, "{}: {low:e} {d:e} {high:e}", c.name);
        assert!((high - d).abs() <= slack, "{}: {low:e} {d:e} {high:e}", c.name);
        judged += 1;
    }
    assert!(judged >= 15, "{judged}");
}

/// The table of failures was made from the current corpus, and shows no failure of the certified
/// levels.
#[test]
fn the_record_is_of_this_corpus() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../benches/record/corpus.md");
    let table = std::fs::read_to_string(file).unwrap();
    let all = cases();
    let mut rows = table
        .lines()
        .skip(2)
        .map(|l| l.split('|').map(str::trim).collect::<Vec<_>>());
    assert!(rows.all(|row| {
        let n = all.iter().filter(|c| row[1] == "all" || c.family == row[1]).count();
        row[2] == n.to_string() && row[4] == "0" && row[5] == "0"
    }));
    assert!(table.contains("| all |"));
}

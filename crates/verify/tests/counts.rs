//! Large counts, run once: `RECEIPTS=100000 SEED=1 cargo test --release -p lin-canny-verify --test
//! counts -- --ignored --nocapture rust`, and the same with `python`. `SECONDS` stops a run early,
//! `KIND="distance of parts"` runs one kind alone.

mod support;

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use lin_canny_verify::{Verdict, verify};
use support::changes::{CHANGES, change};
use support::parted::{GAP_CHANGES, Gapped, PART_CHANGES, Parted};
use support::ranged::{ranged, small_ranged};
use support::*;

const KINDS: [&str; 9] = [
    "overlap",
    "distance and near",
    "cast that hits",
    "arm, segment",
    "arm, two curves",
    "cast that misses",
    "range",
    "parts",
    "distance of parts",
];

/// One of so many receipts of an arm is of the one with four joints, the others of a lever.
const LARGE: usize = 16;

/// One of so many receipts is at the limit of what its evidence proves.
const HARD: usize = 4;

/// Returns about the greatest number from a start on that a test accepts.
fn limit(start: f64, mut accepts: impl FnMut(f64) -> bool) -> f64 {
    let (mut low, mut high) = (start, start + 0.5);
    for _ in 0..12 {
        let middle = 0.5 * (low + high);
        *(if accepts(middle) { &mut low } else { &mut high }) = middle;
    }
    low
}

/// Raises the margin to about the greatest one that the evidence proves.
fn harden(receipt: &mut Receipt) {
    let Some([_, _, start]) = receipt.apart else { return };
    let set = |receipt: &mut Receipt, margin: f64| {
        receipt.apart.as_mut().unwrap()[2] = margin;
        for line in &mut receipt.evidence {
            if let Line::Plane { keep, .. } | Line::Balls { keep, .. } = line {
                *keep = margin;
            }
        }
    };
    let margin = limit(start, |margin| {
        set(receipt, margin);
        accepted(&receipt.text())
    });
    set(receipt, margin);
}

fn make(rng: &mut Rng, kind: usize) -> Receipt {
    let (is_large, is_hard) = (rng.below(LARGE) == 0, rng.below(HARD) == 0);
    match kind {
        0 if is_hard => touching(rng),
        0 => overlap(rng),
        1 => above(rng),
        2 => hit(rng),
        3 if is_large => arm(rng, 0.01, 1, 1),
        3 => lever(rng, 0.01, 1, 1),
        4 if is_large => arm(rng, 0.01, 2, 2),
        4 => lever(rng, 0.01, 2, 2),
        _ => cast(rng, 0.01),
    }
}

fn accepted(text: &str) -> bool {
    matches!(verify(text.as_bytes()), Ok(Verdict::Holds(_)))
}

/// A receipt of a kind, a changed one with its kind of change, and whether samples refute that one.
///
/// The generator decides in double precision, at samples. What the checker does not see proven is
/// counted in `unproven`, and another receipt takes its place.
fn both(rng: &mut Rng, kind: usize, unproven: &mut usize) -> (String, Option<(&'static str, String, bool)>) {
    if kind == 6 {
        let (is_large, k) = (rng.below(LARGE) == 0, rng.below(2));
        let mut ranged = if is_large { ranged(rng, k) } else { small_ranged(rng, k) };
        if rng.below(HARD) == 0 {
            ranged.margin = limit(ranged.margin, |margin| {
                ranged.margin = margin;
                accepted(&ranged.text())
            });
        }
        let text = ranged.text();
        let way = rng.below(7);
        ranged.change(rng, way);
        let kinds = [
            "a cell left out",
            "a cell twice",
            "a range wider by one unit",
            "a wider range",
            "a larger margin",
            "a plane turned round",
            "an obstacle moved",
        ];
        let (changed, is_false) = (ranged.text(), ranged.is_false(rng));
        return (text, Some((kinds[way], changed, is_false)));
    }
    if kind == 7 {
        let mut parted = Parted::random(rng);
        while !accepted(&parted.text()) {
            *unproven += 1;
            parted = Parted::random(rng);
        }
        let text = parted.text();
        loop {
            let (way, mut other) = (rng.below(PART_CHANGES.len()), parted.clone());
            other.change(rng, way);
            let changed = other.text();
            if changed != text {
                let is_false = accepted(&changed) && other.nearest() < 1e-6;
                return (text, Some((PART_CHANGES[way], changed, is_false)));
            }
        }
    }
    if kind == 8 {
        let gapped = Gapped::random(rng);
        let text = gapped.text();
        loop {
            let (way, mut other) = (rng.below(GAP_CHANGES.len()), gapped.clone());
            let must = other.change(rng, way);
            let changed = other.text();
            if changed != text {
                let is_accepted = accepted(&changed);
                let is_false = is_accepted && (must || other.is_false());
                return (text, Some((GAP_CHANGES[way], changed, is_false)));
            }
        }
    }
    let mut receipt = make(rng, kind);
    while !accepted(&receipt.text()) {
        *unproven += 1;
        receipt = make(rng, kind);
    }
    if rng.below(HARD) == 0 {
        harden(&mut receipt);
    }
    let text = receipt.text();
    for _ in 0..20 {
        let (kind, mut changed) = (CHANGES[rng.below(CHANGES.len())], receipt.clone());
        if change(kind, &mut changed, rng) && changed.text() != text {
            let is_accepted = accepted(&changed.text());
            let is_false = is_accepted && changed.is_false();
            return (text, Some((kind, changed.text(), is_false)));
        }
    }
    (text, None)
}

/// Seconds of each kind: to make receipts, and to check them.
#[derive(Default)]
struct Times(BTreeMap<&'static str, [f64; 2]>);

impl Times {
    fn add<T>(&mut self, kind: usize, what: usize, work: impl FnOnce() -> T) -> T {
        let started = Instant::now();
        let found = work();
        self.0.entry(KINDS[kind]).or_default()[what] += started.elapsed().as_secs_f64();
        found
    }

    fn print(&self) {
        for (kind, [make, check]) in &self.0 {
            println!("  {kind}: {make:.1} s to make and judge by samples, {check:.1} s to check");
        }
    }
}

/// The kinds to run: all, or the one that `KIND` names.
fn chosen() -> Vec<usize> {
    let name = std::env::var("KIND").ok();
    let all = (0..KINDS.len()).filter(|k| name.as_ref().is_none_or(|name| KINDS[*k] == name));
    let all: Vec<usize> = all.collect();
    assert!(!all.is_empty(), "no such kind: {name:?} (expected one of {KINDS:?})");
    all
}

fn number(name: &str, default: u64) -> u64 {
    std::env::var(name).ok().and_then(|x| x.parse().ok()).unwrap_or(default)
}

#[test]
#[ignore = "minutes to hours: RECEIPTS=100000 SEED=1 cargo test --release -p lin-canny-verify --test counts -- --ignored --nocapture rust"]
fn rust() {
    let (count, seed, limit) = (number("RECEIPTS", 1000), number("SEED", 1), number("SECONDS", 3600));
    let (mut rng, started, mut unproven) = (Rng(seed), Instant::now(), 0);
    let (mut kinds, mut changes) = (BTreeMap::<&str, usize>::new(), BTreeMap::<&str, [usize; 2]>::new());
    let (mut times, chosen) = (Times::default(), chosen());
    for k in 0..count as usize {
        if started.elapsed() > Duration::from_secs(limit) {
            println!("stopped after {k} receipts");
            break;
        }
        let kind = chosen[k % chosen.len()];
        let (text, changed) = times.add(kind, 0, || both(&mut rng, kind, &mut unproven));
        assert!(times.add(kind, 1, || accepted(&text)), "{text}");
        *kinds.entry(KINDS[kind]).or_default() += 1;
        let Some((change, changed, is_false)) = changed else {
            continue;
        };
        let tail = text.lines().next_back().unwrap();
        let lines: Vec<_> = changed.lines().collect();
        let unsealed = lines[..lines.len() - 1].join("\n") + "\n" + tail + "\n";
        assert!(!accepted(&unsealed), "{change}: {unsealed}");
        let entry = changes.entry(change).or_default();
        entry[0] += 1;
        if times.add(kind, 1, || accepted(&changed)) {
            entry[1] += 1;
            assert!(!is_false, "{change}: accepted, and false:\n{changed}");
        }
    }
    println!("accepted, by kind: {kinds:?}; {unproven} others of the generator were not proven");
    times.print();
    println!("changed, each refused with its old hash; accepted with a new hash, none refuted by samples:");
    for (kind, [all, accepted]) in &changes {
        println!("  {kind}: {all}, {accepted}");
    }
    println!("{:.0} s", started.elapsed().as_secs_f64());
}

/// Runs `verify.py` on all texts in one process.
const ALL: &str = "import sys, io; sys.path.insert(0, sys.argv[1]); import verify
for name in open(sys.argv[2]).read().split():
    sys.stdout, out = io.StringIO(), sys.stdout
    code = verify.main([name])
    sys.stdout = out
    print(code)";

#[test]
#[ignore = "minutes to hours: RECEIPTS=5000 SEED=1 cargo test --release -p lin-canny-verify --test counts -- --ignored --nocapture python"]
fn python() {
    let (count, seed, limit) = (number("RECEIPTS", 200), number("SEED", 2), number("SECONDS", 3600));
    let (mut rng, started, mut unproven) = (Rng(seed), Instant::now(), 0);
    let chosen = chosen();
    let folder = std::env::temp_dir().join(format!("lin-canny-counts-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let (mut kinds, mut counts) = (BTreeMap::<&str, usize>::new(), [0; 3]);
    for start in (0..count as usize).step_by(200) {
        if started.elapsed() > Duration::from_secs(limit) {
            println!("stopped after {start} receipts");
            break;
        }
        let (mut names, mut expected) = (String::new(), Vec::new());
        for k in start..start + 200 {
            let kind = chosen[k % chosen.len()];
            let (text, changed) = both(&mut rng, kind, &mut unproven);
            *kinds.entry(KINDS[kind]).or_default() += 1;
            for (end, text) in [("first", Some(text)), ("changed", changed.map(|x| x.1))] {
                let Some(text) = text else { continue };
                let code = match verify(text.as_bytes()) {
                    Ok(Verdict::Holds(_)) => 0,
                    Ok(_) => 1,
                    Err(_) => 3,
                };
                assert!(code == 0 || end == "changed", "{text}");
                counts[usize::from(end == "changed")] += 1;
                counts[2] += usize::from(end == "changed" && code == 0);
                let path = folder.join(format!("{k}-{end}"));
                std::fs::write(&path, text).unwrap();
                expected.push(code.to_string());
                names += &format!("{}\n", path.display());
            }
        }
        let list = folder.join("list");
        std::fs::write(&list, names).unwrap();
        let scripts = Path::new(env!("CARGO_MANIFEST_DIR")).join("../python");
        let output = Command::new("python3")
            .args(["-B", "-c", ALL])
            .arg(scripts)
            .arg(&list)
            .output()
            .unwrap();
        let found = String::from_utf8_lossy(&output.stdout).into_owned();
        let answer = found.lines().collect::<Vec<_>>();
        assert_eq!(answer, expected, "{}", String::from_utf8_lossy(&output.stderr));
    }
    std::fs::remove_dir_all(&folder).unwrap();
    let [first, changed, accepted] = counts;
    println!("accepted by both, by kind: {kinds:?}");
    println!(
        "{first} receipts and {changed} changed ones with a new hash: equal answers; {accepted} of the changed hold"
    );
    println!("{:.0} s", started.elapsed().as_secs_f64());
}

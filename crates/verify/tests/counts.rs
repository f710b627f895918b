//! Large counts, run once: `RECEIPTS=100000 SEED=1 cargo test --release -p lin-canny-verify --test
//! counts -- --ignored --nocapture rust`, and the same with `python`. `SECONDS` stops a run early.

mod support;

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use lin_canny_verify::{Verdict, verify};
use support::changes::{CHANGES, change, make};
use support::parted::{PART_CHANGES, Parted};
use support::ranged::ranged;
use support::*;

const KINDS: [&str; 9] = [
    "overlap",
    "distance and near",
    "depth",
    "cast that hits",
    "arm, segment",
    "arm, two curves",
    "cast that misses",
    "range",
    "parts",
];

fn accepted(text: &str) -> bool {
    matches!(verify(text.as_bytes()), Ok(Verdict::Holds(_)))
}

/// A receipt of a kind, a changed one with its kind of change, and whether samples refute that one.
///
/// The generator decides in double precision, at samples. What the checker does not see proven is
/// counted in `unproven`, and another receipt takes its place.
fn both(rng: &mut Rng, k: usize, unproven: &mut usize) -> (String, Option<(&'static str, String, bool)>) {
    if k % 9 == 7 {
        let mut ranged = ranged(rng, k);
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
    if k % 9 == 8 {
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
    let mut receipt = make(rng, k % 9);
    while !accepted(&receipt.text()) {
        *unproven += 1;
        receipt = make(rng, k % 9);
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

fn number(name: &str, default: u64) -> u64 {
    std::env::var(name).ok().and_then(|x| x.parse().ok()).unwrap_or(default)
}

#[test]
#[ignore = "minutes to hours: RECEIPTS=100000 SEED=1 cargo test --release -p lin-canny-verify --test counts -- --ignored --nocapture rust"]
fn rust() {
    let (count, seed, limit) = (number("RECEIPTS", 1000), number("SEED", 1), number("SECONDS", 3600));
    let (mut rng, started, mut unproven) = (Rng(seed), Instant::now(), 0);
    let (mut kinds, mut changes) = (BTreeMap::<&str, usize>::new(), BTreeMap::<&str, [usize; 2]>::new());
    for k in 0..count as usize {
        if started.elapsed() > Duration::from_secs(limit) {
            println!("stopped after {k} receipts");
            break;
        }
        let (text, changed) = both(&mut rng, k, &mut unproven);
        assert!(accepted(&text), "{text}");
        *kinds.entry(KINDS[k % 9]).or_default() += 1;
        let Some((kind, changed, is_false)) = changed else {
            continue;
        };
        let tail = text.lines().next_back().unwrap();
        let lines: Vec<_> = changed.lines().collect();
        let unsealed = lines[..lines.len() - 1].join("\n") + "\n" + tail + "\n";
        assert!(!accepted(&unsealed), "{kind}: {unsealed}");
        let entry = changes.entry(kind).or_default();
        entry[0] += 1;
        if accepted(&changed) {
            entry[1] += 1;
            assert!(!is_false, "{kind}: accepted, and false:\n{changed}");
        }
    }
    println!("accepted, by kind: {kinds:?}; {unproven} others of the generator were not proven");
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
            let (text, changed) = both(&mut rng, k, &mut unproven);
            *kinds.entry(KINDS[k % 9]).or_default() += 1;
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
        assert_eq!(
            found.lines().collect::<Vec<_>>(),
            expected,
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
    }
    std::fs::remove_dir_all(&folder).unwrap();
    let [first, changed, accepted] = counts;
    println!("accepted by both, by kind: {kinds:?}");
    println!(
        "{first} receipts and {changed} changed ones with a new hash: equal answers; {accepted} of the changed hold"
    );
    println!("{:.0} s", started.elapsed().as_secs_f64());
}

//! Promise: a claim about a range of configurations is accepted if its cells prove it, and refused if
//! a cell, a cut or a number is wrong.

mod support;

use lin_canny_verify::verify;
use support::ranged::*;
use support::*;

fn accepted(text: &str) -> bool {
    verify(text.as_bytes()).is_ok_and(|found| found.holds())
}

#[test]
fn cells_prove_a_range() {
    let mut rng = Rng(5);
    let mut counts = [0; 2];
    for k in 0..12 {
        let ranged = ranged(&mut rng, k);
        let text = ranged.text();
        let found = verify(text.as_bytes()).unwrap();
        assert!(found.holds(), "{found}\n{text}");
        assert!(!ranged.is_false(&mut rng));
        let said = found.to_string();
        assert!(said.contains("6 pairs of bodies stay more than"), "{said}");
        assert!(said.contains("at every configuration of ["), "{said}");
        assert!(said.contains("they may meet"), "{said}");
        counts[0] += 1;
        counts[1] += ranged.lines.len();
    }
    println!("{} receipts, {} cells", counts[0], counts[1]);
    assert!(counts[1] > 100, "{counts:?}");
}

/// The greatest margin that one plane proves over a large cell is never more than the gap along it
/// at any corner or random configuration of the cell, and is often near it.
#[test]
fn the_bound_of_a_cell_is_below_every_sample() {
    let mut rng = Rng(9);
    let (mut proven, mut share) = (0, 0.0);
    for k in 0..120 {
        let mut ranged = ranged(&mut rng, k);
        let pair = [[1, 4], [2, 5], [3, 4], [3, 5]][k % 4];
        let arm = &mut ranged.arm;
        for other in [[1, 4], [1, 5], [2, 4], [2, 5], [3, 4], [3, 5]] {
            if other != pair {
                arm.ignored.push((other[0], vec![other[1]], "another test"));
            }
        }
        let size = [0.03, 0.1, 0.3, 0.6][k / 4 % 4];
        let start = middle(&ranged.range);
        ranged.range = start
            .iter()
            .map(|x| [x - size * rng.range(0.0, 1.0), x + size * rng.range(0.0, 1.0)])
            .collect();
        let q = middle(&ranged.range);
        let (link, (_, way)) = (rng.below(6), at(&ranged.arm, pair, q.clone()));
        let n = on_link(&ranged.arm, link, &q, way);
        let n = scale(n, 1.0 / dot(n, n).sqrt());
        ranged.lines = vec![format!(
            "{{\"cell\":[{},{}],\"link\":{link},\"normal\":{}}}",
            pair[0],
            pair[1],
            hexes(&n)
        )];
        ranged.margin = 0.0;
        if !accepted(&ranged.text()) {
            continue;
        }
        let (mut low, mut high) = (0.0, 4.0);
        for _ in 0..30 {
            ranged.margin = 0.5 * (low + high);
            *(if accepted(&ranged.text()) { &mut low } else { &mut high }) = ranged.margin;
        }
        let radii = ranged.arm.bodies[pair[0]].radius + ranged.arm.bodies[pair[1]].radius;
        let mut least = f64::INFINITY;
        for sample in 0..80 {
            let corner = |c: usize| f64::from(u8::from(sample >> c & 1 == 1));
            let part = |c: usize, rng: &mut Rng| if sample < 16 { corner(c) } else { rng.range(0.0, 1.0) };
            let ends = ranged.range.iter().enumerate();
            let q: Vec<f64> = ends
                .map(|(c, [low, high])| low + (high - low) * part(c, &mut rng))
                .collect();
            // The normal in the world, where the link is.
            let columns: [V; 3] =
                [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|x| on_link(&ranged.arm, link, &q, x));
            let n: V = std::array::from_fn(|k| dot(columns[k], n));
            let leg = [q];
            let heights = |body: usize| {
                ranged
                    .arm
                    .placed(body, Some(&leg), 0.0)
                    .into_iter()
                    .map(move |p| dot(p, n))
            };
            let gap =
                heights(pair[1]).fold(f64::INFINITY, f64::min) - heights(pair[0]).fold(f64::NEG_INFINITY, f64::max);
            least = least.min(gap - radii);
        }
        assert!(low <= least + 1e-9, "{low} {least} {k}");
        (proven, share) = (proven + 1, share + low / least);
    }
    println!(
        "{proven} cells, on average {:.3} of the least gap",
        share / f64::from(proven)
    );
    assert!(proven > 40);
}

#[test]
fn a_cell_that_is_wrong_or_missing_is_refused() {
    let mut rng = Rng(6);
    let (mut refused, mut kept) = (0, 0);
    for k in 0..60 {
        let mut ranged = ranged(&mut rng, k);
        let must = ranged.change(&mut rng, k);
        match accepted(&ranged.text()) {
            true => {
                kept += 1;
                assert!(!must, "{k}");
                assert!(!ranged.is_false(&mut rng), "{k}");
            }
            false => refused += 1,
        }
    }
    println!("{refused} refused, {kept} are true of another claim");
    assert!(refused > 30);
}

#[test]
fn a_range_has_cells_alone() {
    let ranged = ranged(&mut Rng(7), 0);
    let text = ranged.text();
    let lines: Vec<String> = text.lines().map(String::from).collect();
    let lines = &lines[..lines.len() - 1];
    let with = |more: &str| sealed(&[lines, &[more.to_string()]].concat());
    let read = |text: &str| verify(text.as_bytes()).map(|found| found.holds());
    assert!(read(&with(&lines[lines.len() - 1])).is_ok_and(|holds| !holds));
    assert!(read(&with("{\"leg\":[[\"0x0p0\",\"0x0p0\",\"0x0p0\",\"0x0p0\"]]}")).is_err());
    assert!(read(&with("{\"balls\":[3,[4]]}")).is_err());
    let short = lines[0].replacen("[\"", "[[\"0x0p0\",\"0x0p0\"]],\"margin\":", 1);
    assert!(read(&sealed(&[&[short], &lines[1..]].concat())).is_err());
    // A link that does not exist.
    let odd = lines.last().unwrap().replace("\"link\":", "\"link\":9");
    assert!(read(&sealed(&[&lines[..lines.len() - 1], &[odd]].concat())).is_err());
}

#[test]
fn both_checkers_agree_about_ranges() {
    let scripts = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("verify.py");
    if !scripts.exists() || std::process::Command::new("python3").arg("--version").output().is_err() {
        println!("skipped: no python3, or not a checkout");
        return;
    }
    let mut rng = Rng(8);
    let file = std::env::temp_dir().join(format!("lin-canny-range-{}", std::process::id()));
    let mut counts = [0; 2];
    for k in 0..8 {
        let mut ranged = ranged(&mut rng, k % 2);
        match k / 2 {
            0 => {}
            1 => drop(ranged.lines.pop()),
            2 => ranged.margin += 0.125,
            _ => ranged.range[0][1] += 0.25,
        }
        let text = ranged.text();
        std::fs::write(&file, &text).unwrap();
        let found = std::process::Command::new("python3")
            .arg(&scripts)
            .arg(&file)
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&found.stdout).into_owned();
        let truth = accepted(&text);
        assert_eq!(
            found.status.code(),
            Some(i32::from(!truth)),
            "{said} {}",
            verify(text.as_bytes()).unwrap()
        );
        counts[usize::from(truth)] += 1;
        if truth {
            assert!(said.contains("at every configuration of ["), "{said}");
        }
    }
    std::fs::remove_file(&file).unwrap();
    assert!(counts[0] > 1 && counts[1] > 1, "{counts:?}");
}

//! Promise: a claim about a range of configurations is accepted if its cells prove it, and refused if
//! a cell, a cut or a number is wrong.

mod support;

use lin_canny_verify::verify;
use support::*;

type Cell = Vec<[f64; 2]>;

/// The scene of an arm with a range of its joints, and for each pair the lines that prove it.
struct Ranged {
    arm: Receipt,
    range: Cell,
    margin: f64,
    lines: Vec<String>,
}

fn middle(cell: &Cell) -> Vec<f64> {
    cell.iter().map(|[low, high]| 0.5 * (low + high)).collect()
}

/// The distance of a pair at a configuration without the radii, and the direction of the way.
fn at(arm: &Receipt, [a, b]: [usize; 2], q: Vec<f64>) -> (f64, V) {
    let leg = [q];
    closest(&[arm.placed(a, Some(&leg), 0.0), arm.placed(b, Some(&leg), 0.0)])
}

/// A direction in the frame of a link.
fn on_link(arm: &Receipt, link: usize, q: &[f64], n: V) -> V {
    let (mut arm, leg) = (arm.clone(), [q.to_vec()]);
    arm.bodies.push(Body {
        points: Vec::new(),
        radius: 0.0,
        motion: Move::Link(link, None),
    });
    let place = |x: V| arm.place(arm.bodies.len() - 1, Some(&leg), 0.0, x);
    let axis = |k: usize| {
        sub(
            place(std::array::from_fn(|j| f64::from(u8::from(j == k)))),
            place([0.0; 3]),
        )
    };
    std::array::from_fn(|k| dot(axis(k), n))
}

/// Writes the lines of a cell; false if it is too small.
fn prove(
    arm: &Receipt,
    pair: [usize; 2],
    margin: f64,
    cell: Cell,
    cuts: &mut Vec<String>,
    rng: &mut Rng,
    lines: &mut Vec<String>,
) -> bool {
    let radii = arm.bodies[pair[0]].radius + arm.bodies[pair[1]].radius;
    let (d, n) = at(arm, pair, middle(&cell));
    let widest = (0..4)
        .max_by(|i, j| (cell[*i][1] - cell[*i][0]).total_cmp(&(cell[*j][1] - cell[*j][0])))
        .unwrap();
    let moved: f64 = cell.iter().map(|[low, high]| 0.9 * (high - low)).sum();
    if d - radii - margin > moved && d > 0.0 {
        let link = rng.below(6);
        let (normal, [a, b]) = (hexes(&on_link(arm, link, &middle(&cell), n)), pair);
        let cut = if cuts.is_empty() {
            String::new()
        } else {
            format!(",\"cut\":[{}]", cuts.join(","))
        };
        cuts.clear();
        lines.push(format!(
            "{{\"cell\":[{a},{b}]{cut},\"link\":{link},\"normal\":{normal}}}"
        ));
        return true;
    }
    if moved < 2e-2 {
        return false;
    }
    let at = middle(&cell)[widest];
    cuts.push(format!("[{widest},{}]", hex(at)));
    let (mut lower, mut upper) = (cell.clone(), cell);
    (lower[widest][1], upper[widest][0]) = (at, at);
    prove(arm, pair, margin, lower, cuts, rng, lines) && prove(arm, pair, margin, upper, cuts, rng, lines)
}

fn ranged(rng: &mut Rng, k: usize) -> Ranged {
    loop {
        let mut arm = arm(rng, 0.01, 1, 1);
        let Line::Leg(rows) = arm.evidence[0].clone() else {
            unreachable!()
        };
        arm.evidence.clear();
        if k % 2 == 1 {
            arm.joints[3].drive = (1, -0.5, 0.2);
        }
        let half = [0.02, 0.08][k % 2];
        let range: Cell = rows[0]
            .iter()
            .map(|x| [x - half, x + half * rng.range(0.0, 1.0)])
            .collect();
        let margin = [0.0, 0.015625][k % 2];
        arm.ignored.push((1, vec![3], "they may meet"));
        let mut lines = Vec::new();
        let pairs = [[1, 4], [1, 5], [2, 4], [2, 5], [3, 4], [3, 5]];
        if pairs
            .iter()
            .all(|pair| prove(&arm, *pair, margin, range.clone(), &mut Vec::new(), rng, &mut lines))
        {
            return Ranged {
                arm,
                range,
                margin,
                lines,
            };
        }
    }
}

impl Ranged {
    fn text(&self) -> String {
        let range: Vec<String> = self.range.iter().map(|ends| hexes(ends)).collect();
        let (range, margin) = (range.join(","), hex(self.margin));
        let mut all = self.arm.lines();
        all[0] = format!("{{\"receipt\":1,\"claim\":\"range\",\"range\":[{range}],\"margin\":{margin}}}");
        all.extend(self.lines.iter().cloned());
        sealed(&all)
    }

    /// Whether a random configuration refutes the claim.
    fn is_false(&self, rng: &mut Rng) -> bool {
        (0..20).any(|_| {
            let q: Vec<f64> = self.range.iter().map(|[low, high]| rng.range(*low, *high)).collect();
            let pairs = [[1, 4], [1, 5], [2, 4], [2, 5], [3, 4], [3, 5]];
            pairs.iter().any(|pair| {
                let radii = self.arm.bodies[pair[0]].radius + self.arm.bodies[pair[1]].radius;
                at(&self.arm, *pair, q.clone()).0 - radii < self.margin - 1e-9 - 1e-3 * self.margin
            })
        })
    }
}

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
        assert!(
            said.contains("at every configuration of [") && said.contains("they may meet"),
            "{said}"
        );
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
        let one = rng.below(ranged.lines.len());
        let must = match k % 7 {
            0 => {
                // If its cut goes too, another plane may prove both halves.
                ranged.lines.remove(one);
                false
            }
            1 => {
                let line = ranged.lines[one].clone();
                ranged.lines.insert(one, line);
                true
            }
            2 => {
                // One unit more is claimed.
                let c = rng.below(4);
                let end = &mut ranged.range[c][1];
                *end = f64::from_bits(end.to_bits() + 1);
                false
            }
            3 => {
                ranged.range[rng.below(4)][0] -= 2.0;
                false
            }
            4 => {
                ranged.margin *= 64.0;
                ranged.margin += 0.25;
                false
            }
            5 => {
                let line = &mut ranged.lines[one];
                let at = line.find("\"normal\"").unwrap();
                let turned = line[at..].replace("\"-0x", "\"+0x").replace("\"0x", "\"-0x");
                line.replace_range(at.., &turned.replace("\"+0x", "\"0x").replace("\"-0x0p0", "\"0x0p0"));
                true
            }
            _ => {
                let Move::Rest(pose) = &mut ranged.arm.bodies[4].motion else {
                    unreachable!()
                };
                pose[0] *= 0.5;
                false
            }
        };
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
    let scripts = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../python/verify.py");
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

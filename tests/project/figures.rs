//! Promise: a figure of a page is that of the record that the page names.
//!
//! [`FIGURES`] has a text of a page with `{}` for each figure, and how the record gives these figures.
//! A page that names a record which the table leaves out fails as well.

use std::collections::BTreeSet;

use super::pages;

/// Texts of pages: page, text, record, and the figures by the record in the order of the text.
type Figure = (&'static str, &'static str, &'static str, fn(&Record) -> Vec<f64>);

/// Folder of the records.
const RECORDS: &str = "benches/record/";

/// Pages that name records without figures, or as the place of all figures.
const ELSEWHERE: [&str; 6] = [
    "BENCHMARKS.md",
    "benches/record/2026-12-01-tables.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "benches/record/README.md",
    "tests/corpus/README.md",
];

const PARRY: &str = "crates/parry/README.md";
const RAPIER: &str = "crates/rapier/README.md";
const ROBOT: &str = "crates/robot/README.md";
const STUDY: &str = "crates/study/README.md";
const CAPI: &str = "crates/capi/README.md";
const CLUSTER: &str = "crates/study/docs/cluster.md";
const FORMATS: &str = "crates/formats/README.md";
const TRIMESH: &str = "crates/python/docs/trimesh.md";
const COSTS: &str = "crates/python/docs/costs.md";
const ACCURACY: &str = "docs/accuracy.md";

#[rustfmt::skip]
const FIGURES: &[Figure] = &[
    ("README.md", "that move little take {} to {} ns, with a lower and an upper bound", "2026-11-25-pairs.csv", |r| {
        vec![r.after("coherent-0.5,sphere,8,ours,"), r.after("coherent-0.5,sphere,8192,ours,")]
    }),
    ("README.md", "| nothing proven: `propose` | {} ns | {} L |", "2026-11-20-accuracy.csv", |r| accuracy(r, "ours,walk")),
    ("README.md", "| proven: `closest`, `distance` | {} ns | {} L |", "2026-11-20-accuracy.csv", |r| accuracy(r, "ours,certified")),
    ("README.md", "benches/record/2026-11-25-pairs.csv)) | {} ns | one unit in the last place |", "2026-11-25-pairs.csv", |r| vec![r.after("coherent-0.5,sphere,512,ours-exact,")]),
    ("README.md", "| parry's GJK in `f64`, started from the last simplex | {} ns | {} L |", "2026-11-20-accuracy.csv", |r| accuracy(r, "gjk-cached,closest")),
    ("README.md", "| parry's `distance` in `f64`, started cold | {} ns | {} L |", "2026-11-20-accuracy.csv", |r| accuracy(r, "parry-f64,distance")),
    ("README.md", "| parry's `distance` in `f32`, started cold | {} ns | {} L |", "2026-11-20-accuracy.csv", |r| accuracy(r, "parry-f32,distance")),
    ("README.md", "| depth, overlap of 1 %, 8 to 8,192 vertices; a frame in a hundred takes [up to 25 times as long](BENCHMARKS.md#depths-and-contacts) | {} to {} µs |", "2026-11-28-contact.csv",
        |r| micros(r, |n| format!("shallow-0.5,sphere,{n},ours,"), &SIZES)),
    ("README.md", "| time of impact, turns of up to 1 radian, 8 to 2,048 vertices | {} to {} µs; rods and plates up to {} µs |", "2026-11-28-impact.csv", |r| impact(r, "1")),
    ("README.md", "| rocks {} µs, gears {} µs; with a new tracker {} and {} µs |", "2026-11-24-meshes.csv", |r| {
        let of = |shape, engine| r.after(&format!("tracked-0.5,{shape},20480,{engine},")) / 1e3;
        vec![of("rock", "ours"), of("gear", "ours"), of("rock", "ours-cold"), of("gear", "ours-cold")]
    }),
    ("README.md", "for Linux: {} MB for x86-64, {} MB for aarch64 (", "2026-12-01-release.txt", |r| {
        vec![r.after("compressed, MB: x86-64 "), r.after(", aarch64 ")]
    }),
    ("README.md", "takes {} to {} CPU seconds on two cores of an Intel Xeon (2026-11-30), and parry3d-f64 takes {} to {} (", "2026-11-30-build.txt", |r| {
        let ends = |text| {
            let all = r.all_after(text);
            [all[0], all[all.len() - 1]].map(f64::round)
        };
        [ends("\nours "), ends("\nparry3d-f64 ")].concat()
    }),
    ("README.md", "of {} named ones (touching, parallel, thin, far, tiny, equal bodies) `closest` fails none. parry (`f64`) fails {} of them with the hulls of lin-canny and {} with its own", "corpus.md", |r| {
        let all = r.all_after("| all | ");
        assert_eq!(all[2..4], [0.0, 0.0], "certified and exact");
        vec![all[0], all[4] + all[5], all[6] + all[7] + all[8]]
    }),
    (PARRY, "rapier 150; with lin-canny's dispatcher alone {}; with its hulls alone {}; with both {}. ", "crates/rapier/images/parts.svg", picture_of_parts),
    (RAPIER, "rapier 150; with lin-canny's dispatcher alone {}; with its hulls alone {}; with both {}. ", "crates/rapier/images/parts.svg", picture_of_parts),
    (PARRY, "| parry's hulls, parry's dispatcher | {} | nothing is left | {} s |", "2026-11-25-parts.csv", |r| [0, 2].map(|k| r.all_after("\"rapier\",")[k]).to_vec()),
    (PARRY, "| parry's hulls, `CertifiedDispatcher` | {} | {} mm | {} s |", "2026-11-25-parts.csv", |r| r.all_after("\"dispatcher\",")),
    (PARRY, "`Hull`, `CertifiedDispatcher` | {} | {} mm | {} s | | `Hull`, parry's dispatcher", "2026-11-25-parts.csv", |r| r.all_after("\"dispatcher, our mass\",")),
    (PARRY, "| `Hull`, parry's dispatcher | {} | nothing is left | {} s |", "2026-11-25-parts.csv", |r| [0, 2].map(|k| r.all_after("\"hulls\",")[k]).to_vec()),
    (PARRY, "| `Hull`, `CertifiedDispatcher` | {} | {} mm | {} s | You need", "2026-11-25-parts.csv", |r| r.all_after("\"both\",")),
    (PARRY, "| `Hull` | {} | {} | {} | {} | {} |", "2026-11-28-scenes.csv", |r| piles(r, "hull")),
    (PARRY, "| parry's hulls with `CertifiedDispatcher` | {} | {} | {} | {} | {} |", "2026-11-28-scenes.csv", |r| piles(r, "plain")),
    (PARRY, "| 2,000 distinct `Hull`s of 24 points | {} | | 625 distinct round hulls of 10 points | {} | | 4,000 / 4,300 / 20,000 distinct plain hulls of 10 points | {} / {} / {} | \
        | 60 compounds of eight pieces | {} | | 180 cylinders / cones thrown into a bin, swept | {} / {} | | towers of 720 planks, 200 dominoes, platforms with cuboids | {}, {}, {} | \
        | balls: bullets, restitution, 400 balls that fall through sensors | {}, {}, {} |", "2026-11-28-scenes.csv", |r| {
        ["many-hulls,hull-24,2000", "round-hulls,round,625", "distinct,plain-10,4000", "distinct,plain-10,4300", "distinct,plain-10,20000", "compounds,ring,60",
            "continuous,cylinder,180", "continuous,cone,180", "planks,cuboid,720", "dominoes,cuboid,200", "platforms,cuboid,200", "bullets,ball,256",
            "restitution,ball,100", "sensors,ball,400"].map(|scene| step(r, scene)).to_vec()
    }),
    (RAPIER, "| time per step / parry's | {} | {} | {} |", "2026-11-28-pile.csv", |r| pile(r, 0)),
    (RAPIER, "| time of the narrow phase / parry's | {} | {} | {} |", "2026-11-28-pile.csv", |r| pile(r, 1)),
    (RAPIER, "| deepest overlap / parry's | {} | {} | {} |", "2026-11-28-pile.csv", |r| pile(r, 2)),
    (RAPIER, "| 99.9 % quantile of the overlap / parry's | {} | {} | {} |", "2026-11-28-pile.csv", |r| pile(r, 4)),
    (RAPIER, "| time per contact call, ours | {} ns | {} ns | {} ns |", "2026-11-28-calls.csv", |r| calls(r, "ours")),
    (RAPIER, "| time per contact call, parry | {} ns | {} ns | {} ns |", "2026-11-28-calls.csv", |r| calls(r, "parry")),
    (ROBOT, "with MuJoCo 4.0.0 on {} public models", "2026-11-30-ball-joints.txt", |r| vec![r.before(" models load here, and agree")]),
    (ROBOT, "with libsdformat 12.3 on {} files", "2026-11-30-ball-joints.txt", |r| vec![r.after("libsdformat loads 433 files, of these ")]),
    (ROBOT, "and URDF with urdfdom on {} (", "2026-11-29-rules-of-files.txt", |r| vec![r.after("urdfdom loads 1,380, of these ")]),
    (STUDY, "A row takes {} bytes of input and {} bytes of output.", "2026-11-23-study.txt", |r| vec![r.after("random configurations; input "), r.after("MB, output ")]),
    (STUDY, "one core | {} | | the same loop with `Checker::reset` before each row, as in the SQL functions | {} | | `study run` with one partition, Parquet to Parquet | {} | \
        | `study run` with two partitions | {} |", "2026-11-23-study.txt", |r| {
        ["loop that remembers,", "loop that forgets,", "run of 1 partition(s),", "run of 2 partition(s),"].map(|row| hundreds(r.all_after(row)[2])).to_vec()
    }),
    (CLUSTER, "| one core: 10^9 / {} = {} s |", "2026-11-23-study.txt", |r| {
        let rows = hundreds(r.all_after("run of 1 partition(s),")[2]);
        vec![rows, hundreds(1e9 / rows)]
    }),
    (CLUSTER, "the run took {} s longer", "2026-11-23-study.txt", |r| {
        vec![(r.after("killed after 2 s: ") - r.after("each, ")).round()]
    }),
    (FORMATS, "All {} meshes of four Python packages are read: {} have box, area and volume of trimesh, {} is not read by trimesh, and {} differ in area alone", "2026-11-27-meshes-and-robots.txt",
        |r| [" files (STL, OBJ, COLLADA)", " agree: box", " that trimesh does not read", " differ, in area alone"].map(|text| r.before(text)).to_vec()),
    (TRIMESH, "| a single mesh against the manager | {} to {} |", "2026-11-28-managers.txt", |r| span(&managers(r, |row| row.contains("_single")))),
    (TRIMESH, "| `in_collision_internal` without names | {} to {} |", "2026-11-28-managers.txt", |r| span(&managers(r, |row| row.contains("in_collision_internal  ")))),
    (TRIMESH, "| the names of overlapping tori | {} |", "2026-11-28-managers.txt", |r| vec![span(&managers(r, |row| row.starts_with("tori near") && row.contains("names")))[1]]),
    (TRIMESH, "| `min_distance_internal` of overlapping hulls and tori | {} to {} |", "2026-11-28-managers.txt", |r| {
        span(&managers(r, |row| (row.starts_with("tori near") || row.starts_with("hulls near")) && row.contains("min_distance_internal")))
    }),
    (COSTS, "| the loop in Rust | {} | {} | {} |", "2026-11-28-pairs-python.txt", |r| python(r, "| Rust loop | ")),
    (COSTS, "| `distances`, poses (N, 4, 4) | {} | {} | {} |", "2026-11-28-pairs-python.txt", |r| python(r, "| batch (N, 4, 4) | ")),
    (COSTS, "| `distances`, poses (N, 7) | {} | {} | {} |", "2026-11-28-pairs-python.txt", |r| python(r, "| batch (N, 7) | ")),
    (COSTS, "| one `distance`, 4x4 | {} | {} | {} |", "2026-11-28-pairs-python.txt", |r| python(r, "| one distance, 4x4 | ")),
    (COSTS, "| one `closest`, 4x4 | {} | {} | {} |", "2026-11-28-pairs-python.txt", |r| python(r, "| one closest, 4x4 | ")),
    (COSTS, "| coal, default tolerances | {} | {} | **{}** |", "2026-11-28-pairs-python.txt", |r| python(r, "| coal, default | ")),
    (COSTS, "| coal, both tolerances 1e-12 | {} | {} | **{}** |", "2026-11-28-pairs-python.txt", |r| python(r, "| coal, tolerances 1e-12 | ")),
    (COSTS, "| python-fcl | {} | {} | {} | A batch", "2026-11-28-pairs-python.txt", |r| python(r, "| python-fcl, default | ")),
    (CAPI, "hulls of 8 or 128 vertices takes {} to {} ns more than in Rust, a query of a batch (`ask_many`) {} to {} ns more", "2026-11-28-capi.txt", |r| {
        let r = r.from("overhead 41, quiet machine");
        let more = |row: &str| [8, 128].map(|n| r.all_after(&format!("| hulls of {n} vertices: {row} | "))[2]).to_vec();
        [span(&["closest, apart", "closest in the world, apart", "within, apart"].map(more).concat()), span(&more("closest, a batch of 1,000"))].concat()
    }),
    (CAPI, "takes another {} to {} ns less", "2026-11-28-capi.txt", |r| {
        span(&[8, 128].map(|n| {
            let rust = |row: &str| r.after(&format!("| hulls of {n} vertices: closest, {row} | "));
            rust("apart") - rust("beside Rust's `Tracker` of polyhedra (not counted)")
        }))
    }),
    (ACCURACY, "| `propose` | {} ns | {} L, no bounds |", "2026-11-20-accuracy.csv", |r| accuracy(r, "ours,walk")),
    (ACCURACY, "| `closest` | {} ns | {} L,", "2026-11-20-accuracy.csv", |r| accuracy(r, "ours,certified")),
    (ACCURACY, "with a new tracker each time | {} ns | {} L |", "2026-11-20-accuracy.csv", |r| accuracy(r, "ours-cold,certified")),
    (ACCURACY, "| parry `f64`, cached simplex | {} ns | {} L,", "2026-11-20-accuracy.csv", |r| accuracy(r, "gjk-cached,closest")),
    (ACCURACY, "| parry `f64` | {} ns | {} L,", "2026-11-20-accuracy.csv", |r| accuracy(r, "parry-f64,distance")),
    (ACCURACY, "| parry `f32` | {} ns | {} L,", "2026-11-20-accuracy.csv", |r| accuracy(r, "parry-f32,distance")),
    (ACCURACY, "here {} ns", "2026-11-20-accuracy.csv", |r| vec![median(&r.every("ours,certified,sphere 0.5deg,8192,"))]),
    (ACCURACY, "| `closest_exact` (1) | {} ns |", "2026-11-25-pairs.csv", |r| vec![r.after("coherent-0.5,sphere,512,ours-exact,")]),
    (ACCURACY, "there `closest` takes {} ns", "2026-11-25-pairs.csv", |r| vec![r.after("coherent-0.5,sphere,8192,ours,")]),
    (ACCURACY, "one unit in the last place apart (2) | {} ns |", "2026-11-28-touching.txt", |r| vec![r.all_after("gap of one unit ")[1]]),
    (ACCURACY, "a slab that touches a floor exactly (2) | {} ns |", "2026-11-28-touching.txt", |r| vec![r.all_after("\nslab on a floor ")[1]]),
];

/// Vertices of the hulls of the race `contact`.
const SIZES: [u32; 6] = [8, 32, 128, 512, 2048, 8192];

/// The least and the greatest of the rows of some sizes, in microseconds.
fn micros(r: &Record, row: impl Fn(u32) -> String, sizes: &[u32]) -> Vec<f64> {
    span(&sizes.iter().map(|&n| r.after(&row(n)) / 1e3).collect::<Vec<_>>())
}

/// Casts of round hulls, from the least to the greatest, and the greatest of rods and plates.
fn impact(r: &Record, turn: &str) -> Vec<f64> {
    let all = |shape: &str| micros(r, |n| format!("turn-{turn},{shape},{n},ours,"), &SIZES[..5]);
    [all("sphere"), vec![all("rods")[1].max(all("plates")[1])]].concat()
}

fn picture_of_parts(r: &Record) -> Vec<f64> {
    let lost = r.every_before(" of 150 lost");
    assert_eq!(lost[0], 150.0);
    lost[1..].to_vec()
}

/// The time of a scene over that with parry.
fn step(r: &Record, scene: &str) -> f64 {
    r.after(&format!("{scene},ours,")) / r.after(&format!("{scene},parry,"))
}

fn piles(r: &Record, shape: &str) -> Vec<f64> {
    [8, 24, 64, 256, 1024]
        .map(|n| step(r, &format!("pile,{shape}-{n},60")))
        .to_vec()
}

/// A column of the pile without a skin, over that of parry.
fn pile(r: &Record, column: usize) -> Vec<f64> {
    let of = |engine: &str, n: u32| r.all_after(&format!("{engine},{n},0,"))[column];
    [8, 64, 512].map(|n| of("ours", n) / of("parry", n)).to_vec()
}

fn calls(r: &Record, engine: &str) -> Vec<f64> {
    [8, 64, 512]
        .map(|n| r.all_after(&format!("{engine},{n},all,"))[1])
        .to_vec()
}

/// The ratios of some rows of the managers.
fn managers(r: &Record, is_asked: impl Fn(&str) -> bool) -> Vec<f64> {
    let rows = r
        .text
        .lines()
        .filter(|row| is_asked(row) && !row.starts_with(['`', 'C', 'O']));
    rows.map(|row| numbers(row)[numbers(row).len() - 2]).collect()
}

/// Nanoseconds of the second of two runs, in its three sections.
fn python(r: &Record, row: &str) -> Vec<f64> {
    r.from("run 2").every(row)
}

/// The time of hulls of 512 vertices, and the greatest error.
fn accuracy(r: &Record, engine: &str) -> Vec<f64> {
    let rows: Vec<Vec<f64>> = r.rows(&format!("{engine},sphere 0.5deg,512,")).collect();
    let errors = rows
        .iter()
        .filter_map(|row| row.get(1))
        .fold(0.0, |most, e| e.max(most));
    vec![median(&rows.iter().map(|row| row[0]).collect::<Vec<_>>()), errors]
}

/// Rounds to hundreds.
fn hundreds(x: f64) -> f64 {
    (x / 100.0).round() * 100.0
}

fn span(values: &[f64]) -> Vec<f64> {
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    vec![least, values.iter().copied().fold(f64::NEG_INFINITY, f64::max)]
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

/// Returns the numbers of a text without their signs, such as `1,230`, `.5` and `3e-16`.
fn numbers(text: &str) -> Vec<f64> {
    let bytes = text.as_bytes();
    let is_digit = |k: usize| bytes.get(k).is_some_and(u8::is_ascii_digit);
    let (mut found, mut k) = (vec![], 0);
    while k < bytes.len() {
        let is_start = is_digit(k) || bytes[k] == b'.' && is_digit(k + 1);
        if !is_start {
            k += 1;
            continue;
        }
        let start = k;
        loop {
            let is_sign = matches!(bytes.get(k + 1), Some(b'-' | b'+')) && is_digit(k + 2);
            match bytes.get(k) {
                Some(b'0'..=b'9') => k += 1,
                Some(b'.') if is_digit(k + 1) && !text[start..k].contains(['.', 'e']) => k += 1,
                // A comma before three digits groups; before others it parts columns.
                Some(b',') if (1..4).all(|j| is_digit(k + j)) && !is_digit(k + 4) && is_group(&text[start..k]) => {
                    k += 1
                }
                Some(b'e') if is_sign && !text[start..k].contains('e') => k += 2,
                _ => break,
            }
        }
        found.push(text[start..k].replace(',', "").parse().expect("a number"));
    }
    found
}

/// Returns whether a group of three digits may follow: `1` and `12,345`, not `1234` or `0.5`.
fn is_group(start: &str) -> bool {
    !start.contains('.') && start.split(',').next().is_some_and(|first| first.len() <= 3)
}

/// The text of a record.
struct Record {
    text: String,
}

impl Record {
    fn read(name: &str) -> Self {
        let path = if name.contains('/') {
            name.to_owned()
        } else {
            format!("{RECORDS}{name}")
        };
        Self {
            text: pages::read(&path),
        }
    }

    /// Returns the record from a text on.
    fn from(&self, text: &str) -> Self {
        let start = self
            .text
            .find(text)
            .unwrap_or_else(|| panic!("{text:?} is not in the record"));
        Self {
            text: self.text[start..].to_owned(),
        }
    }

    /// Returns for each place of a text the numbers that follow on its line.
    fn rows(&self, text: &str) -> impl Iterator<Item = Vec<f64>> {
        let rest = self.text.split(text).skip(1);
        rest.map(|rest| numbers(rest.split('\n').next().unwrap_or_default()))
            .collect::<Vec<_>>()
            .into_iter()
    }

    /// Returns all numbers after a text, up to the end of the record.
    fn all_after(&self, text: &str) -> Vec<f64> {
        let Some((_, rest)) = self.text.split_once(text) else {
            panic!("{text:?} is not in the record")
        };
        let line = rest.split('\n').next().unwrap_or_default();
        numbers(line)
    }

    /// Returns the number after a text; of a CSV file, the last of its row.
    fn after(&self, text: &str) -> f64 {
        let one = self
            .text
            .split_once(&format!("\n{text}"))
            .or(self.text.split_once(text));
        let Some((_, rest)) = one else {
            panic!("{text:?} is not in the record")
        };
        numbers(rest)[0]
    }

    /// Returns the first number after each place of a text.
    fn every(&self, text: &str) -> Vec<f64> {
        self.rows(text).map(|row| row[0]).collect()
    }

    /// Returns the last number before each place of a text.
    fn every_before(&self, text: &str) -> Vec<f64> {
        let places = self.text.match_indices(text).map(|(end, _)| end);
        places
            .map(|end| {
                *numbers(&self.text[end.saturating_sub(20)..end])
                    .last()
                    .expect("a number")
            })
            .collect()
    }

    fn before(&self, text: &str) -> f64 {
        self.every_before(text)[0]
    }
}

/// Returns a text with single blanks.
fn flat(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Returns the figures of a page at the places `{}` of a text, as they are written.
fn written(page: &str, text: &str) -> Result<Vec<String>, String> {
    let text = flat(text);
    let parts: Vec<&str> = text.split("{}").collect();
    let mut why = format!("the page has no {:?}", parts[0]);
    'places: for (start, _) in page.match_indices(parts[0]) {
        let (mut rest, mut found) = (&page[start..], vec![]);
        for (k, part) in parts.iter().enumerate() {
            let Some(after) = rest.strip_prefix(part) else {
                why = format!("the page goes on with {:?}", rest.chars().take(60).collect::<String>());
                continue 'places;
            };
            rest = after;
            if k + 1 < parts.len() {
                let end = rest
                    .find(|c: char| !c.is_ascii_digit() && !".,e-".contains(c))
                    .unwrap_or(rest.len());
                let figure = rest[..end].trim_end_matches(['.', ',', '-']);
                rest = &rest[figure.len()..];
                found.push(figure.to_owned());
            }
        }
        return Ok(found);
    }
    Err(why)
}

/// Returns whether a figure is a value, rounded to the digits of the figure.
fn is_rounded(figure: &str, value: f64) -> bool {
    let [shown] = numbers(figure)[..] else { return false };
    let (mantissa, exponent) = figure.split_once('e').unwrap_or((figure, "0"));
    let digits = mantissa.split_once('.').map_or(0, |(_, digits)| digits.len());
    let last = 10f64.powi(exponent.parse::<i32>().expect("an exponent") - digits as i32);
    (shown - value).abs() <= last * (0.5 + 1e-6)
}

#[test]
fn figures_are_those_of_their_records() {
    let (mut wrong, mut count) = (vec![], 0);
    for (page, text, record, values) in FIGURES {
        let values = values(&Record::read(record));
        match written(&flat(&pages::read(page)), text) {
            Ok(figures) => {
                count += figures.len();
                let fits = figures.len() == values.len() && figures.iter().zip(&values).all(|(f, v)| is_rounded(f, *v));
                if !fits {
                    wrong.push(format!(
                        "{page}: {text:?}\n    the page {figures:?}\n    {record} {values:?}"
                    ));
                }
            }
            Err(why) => wrong.push(format!("{page}: {text:?}\n    {why}")),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(count > 150, "only {count} figures");
}

/// Returns the names of the records that a page names.
fn named(page: &str) -> BTreeSet<String> {
    let places = page.split(RECORDS).skip(1);
    let is_name = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    let names = places.map(|rest| rest.chars().take_while(|&c| is_name(c)).collect::<String>());
    names.filter(|name| name.contains('.') && name != "README.md").collect()
}

#[test]
fn each_record_of_a_page_is_compared() {
    let mut seen = 0;
    for page in pages::pages() {
        if ELSEWHERE.contains(&page.as_str()) {
            continue;
        }
        let compared = FIGURES
            .iter()
            .filter(|f| f.0 == page && !f.2.contains('/'))
            .map(|f| f.2.to_owned());
        let (named, compared) = (named(&pages::read(&page)), compared.collect::<BTreeSet<_>>());
        assert_eq!(
            named, compared,
            "{page}: the records that it names, and those of `FIGURES`"
        );
        seen += named.len();
    }
    assert!(seen > 20, "{seen}");
}

#[test]
fn figures_are_read_as_they_are_written() {
    let found = numbers("a,8,ours-5e-3,1,230,.5 of 3e-16 +- 12");
    assert_eq!(found, [8.0, 5e-3, 1230.0, 0.5, 3e-16, 12.0]);
    let answer = numbers("parry,8,0,1143198,538022,0.2241");
    assert_eq!(answer, [8.0, 0.0, 1_143_198.0, 538_022.0, 0.2241]);
    assert!(is_rounded("1.2", 1.249) && !is_rounded("1.2", 1.26) && is_rounded("3e-16", 3.46e-16));
    assert!(is_rounded("181,000", 181_000.3) && !is_rounded("620", 714.0));
    let found = written("x 5 to 6, y", "x {} to {}, y");
    assert_eq!(found, Ok(vec!["5".into(), "6".into()]));
    assert!(written("x 5 to 6", "x {} and {}").is_err());
}

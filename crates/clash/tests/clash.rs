//! Promise: kinds are right, and gaps, depths and volumes hold the closed forms of boxes, flush, equal,
//! nested, hollow, far from the origin; rows do not depend on the number of threads.

use std::ops::ControlFlow;

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{Geometry, Mesh, Progress, Shape};
use lin_canny_clash::{ClashOptions, Clashes, Kind, Model, Row, Rules, find};
use truth::rng::Rng;

fn go(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn found(model: &Model, rules: &Rules, options: &ClashOptions) -> Clashes {
    find(model, rules, options, go).expect("parts in range")
}

/// A box by its lower and upper corner, in eighths.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Block([i32; 3], [i32; 3]);

impl Block {
    fn random(rng: &mut Rng) -> Self {
        let low = [(); 3].map(|()| rng.below(12) as i32);
        let size = [(); 3].map(|()| 1 + rng.below(8) as i32);
        Self(low, [0, 1, 2].map(|k| low[k] + size[k]))
    }

    /// Returns the box as a polyhedron or a mesh at a pose, far from the origin or not.
    fn part(&self, is_mesh: bool, far: f64) -> (Geometry, Isometry3<f64>) {
        let [low, high] = [self.0, self.1].map(|p| Vector3::from(p.map(|x| f64::from(x) / 8.0)));
        let body = solids::cuboid((high - low) * 0.5).expect("a box");
        let middle = (low + high) * 0.5 + Vector3::repeat(far);
        let geometry = match is_mesh {
            true => Mesh::from_convex(&body).expect("a mesh").into(),
            false => body.into(),
        };
        (geometry, Isometry3::translation(middle.x, middle.y, middle.z))
    }

    /// Returns kind, gap, depth and volume.
    fn truth(&self, other: &Self) -> (Kind, f64, f64, f64) {
        let share = |k: usize| self.1[k].min(other.1[k]) - self.0[k].max(other.0[k]);
        let shares = [0, 1, 2].map(share);
        let eighth = |x: i32| f64::from(x) / 8.0;
        if shares.iter().any(|x| *x < 0) {
            let squares = shares.iter().map(|x| eighth((-x).max(0)).powi(2));
            return (Kind::Apart, squares.sum::<f64>().sqrt(), 0.0, 0.0);
        }
        if shares.contains(&0) {
            return (Kind::Touching, 0.0, 0.0, 0.0);
        }
        let leave = |k: usize| (self.1[k] - other.0[k]).min(other.1[k] - self.0[k]);
        let depth = (0..3).map(leave).min().map_or(0.0, eighth);
        let volume = shares.iter().map(|x| eighth(*x)).product();
        let is_in = |a: &Self, b: &Self| (0..3).all(|k| b.0[k] <= a.0[k] && a.1[k] <= b.1[k]);
        let kind = match (is_in(self, other), is_in(other, self)) {
            (true, true) => Kind::Equal,
            (false, false) => Kind::Overlapping,
            _ => Kind::Inside,
        };
        (kind, 0.0, depth, volume)
    }
}

fn holds([low, high]: [f64; 2], value: f64) -> bool {
    let slack = 1e-15 * value;
    low <= value + slack && value - slack <= high
}

fn check(row: &Row, (kind, gap, depth, volume): (Kind, f64, f64, f64), what: &str) {
    assert_eq!(row.kind, kind, "{what}: {row:?}");
    assert!(holds(row.gap, gap), "{what}: gap {gap}, {row:?}");
    assert!(holds(row.depth, depth), "{what}: depth {depth}, {row:?}");
    assert!(row.depth[1] <= 1.01 * depth, "{what}: depth {depth}, {row:?}");
    let shared = row.volume.unwrap_or_default();
    assert!(holds(shared, volume), "{what}: volume {volume}, {row:?}");
    assert_eq!(row.broken, kind >= Kind::Overlapping, "{what}");
}

fn boxes(seeds: std::ops::Range<u64>) -> [usize; 8] {
    let mut kinds = [0; 8];
    for seed in seeds {
        let mut rng = Rng::new(seed);
        let far = *rng.pick(&[0.0, 0.0, 1024.0, -1048576.0]);
        let (one, mut other) = (Block::random(&mut rng), Block::random(&mut rng));
        if rng.chance(0.05) {
            other = one;
        } else if rng.chance(0.1) {
            other = Block(one.0, one.1.map(|x| x + rng.below(2) as i32));
        }
        let mut model = Model::new();
        for block in [one, other] {
            let (geometry, pose) = block.part(rng.chance(0.5), far);
            model.add("box", geometry, pose);
        }
        let options = ClashOptions::default().within(100.0).volume(true);
        let rows = found(&model, &Rules::default(), &options).rows;
        let truth = one.truth(&other);
        check(&rows[0], truth, &format!("seed {seed}: {one:?} {other:?}"));
        kinds[truth.0 as usize] += 1;
    }
    kinds
}

#[test]
fn boxes_on_a_lattice_are_of_the_right_kind() {
    let kinds = boxes(0..1_000);
    for kind in [
        Kind::Apart,
        Kind::Touching,
        Kind::Overlapping,
        Kind::Inside,
        Kind::Equal,
    ] {
        assert!(kinds[kind as usize] > 20, "{kind}: {kinds:?}");
    }
}

#[test]
#[ignore = "14 seconds: 100,000 pairs; cargo test -p lin-canny-clash -- --ignored --nocapture"]
fn a_hundred_thousand_boxes_are_of_the_right_kind() {
    println!("{:?}", boxes(1_000..101_000));
}

/// Returns a box with a cavity of a margin less on each side.
fn hollow(half: f64, wall: f64) -> Mesh {
    let [outer, inner] = [half, half - wall].map(|h| solids::cuboid(Vector3::repeat(h)).expect("a box"));
    let [outer, inner] = [outer, inner].map(|body| Mesh::from_convex(&body).expect("a mesh"));
    let mut points = outer.vertices();
    let first = points.len() as u32;
    points.extend(inner.vertices());
    let mut triangles = outer.triangle_vertices();
    triangles.extend(
        inner
            .triangle_vertices()
            .into_iter()
            .map(|[a, b, c]| [a, c, b].map(|v| v + first)),
    );
    Mesh::new(&points, &triangles).expect("a hollow box")
}

#[test]
fn a_part_in_a_hollow_is_apart_and_in_the_wall_inside() {
    let die = solids::cuboid(Vector3::repeat(0.125)).expect("a box");
    for (x, expected) in [
        (0.0, Kind::Apart),
        (0.375, Kind::Touching),
        (0.4375, Kind::Overlapping),
        (0.75, Kind::Inside),
        (0.625, Kind::Inside),
        (0.9375, Kind::Overlapping),
        (1.125, Kind::Touching),
    ] {
        let mut model = Model::new();
        model.add("shell", hollow(1.0, 0.5), Isometry3::identity());
        model.add("die", die.clone(), Isometry3::translation(x, 0.0, 0.0));
        let rows = found(&model, &Rules::default(), &ClashOptions::default().within(1.0)).rows;
        assert_eq!(rows[0].kind, expected, "{x}: {rows:?}");
    }
}

#[test]
fn sheets_cross_and_curved_parts_overlap() {
    let corners = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]].map(Point3::from);
    let sheet = Mesh::new(&corners, &[[0, 1, 2]]).expect("a triangle");
    let mut model = Model::new();
    model.add("sheet", sheet.clone(), Isometry3::identity());
    let up = solids::cuboid(Vector3::repeat(0.1)).expect("a box");
    for (name, z) in [("through", 0.05), ("under", -0.1)] {
        let mut boxed = Model::new();
        boxed.add("sheet", sheet.clone(), Isometry3::identity());
        boxed.add(name, up.clone(), Isometry3::translation(0.6, -0.8, z));
        let rows = found(&boxed, &Rules::default(), &ClashOptions::default()).rows;
        let expected = if z > 0.0 { Kind::Crossing } else { Kind::Touching };
        assert_eq!((rows[0].kind, rows[0].broken), (expected, z > 0.0), "{name}");
    }
    model.add("pin", Shape::cylinder(1.0, 0.25).expect("a pin"), Isometry3::identity());
    model.add(
        "ball",
        Shape::ball(0.25).expect("a ball"),
        Isometry3::translation(0.0, 0.0, 1.0),
    );
    let rows = found(&model, &Rules::default(), &ClashOptions::default().volume(true)).rows;
    let told: Vec<_> = rows.iter().map(|row| (&*row.a, &*row.b, row.kind)).collect();
    assert_eq!(
        told,
        [("sheet", "pin", Kind::Crossing), ("pin", "ball", Kind::Overlapping)]
    );
    assert!(rows[1].volume.is_none() && rows[1].note.as_deref().is_some_and(|note| note.contains("curved")));
}

/// A row of dice, each 1e-6 into the next.
fn press_fits(count: usize) -> Model {
    let die = solids::cuboid(Vector3::repeat(0.5)).expect("a box");
    let mut model = Model::new();
    for k in 0..count {
        let x = k as f64 * (1.0 - 1e-6);
        model.add("die", die.clone(), Isometry3::translation(x, 0.0, 0.0));
    }
    model
}

#[test]
fn rules_allow_press_fits_and_forbid_small_gaps() {
    let options = ClashOptions::default();
    let model = press_fits(3);
    let rules = |text: &str| Rules::from_json(text).expect("rules");
    let broken = |text: &str| -> Vec<(Kind, Option<String>)> {
        let rows = found(&model, &rules(text), &options).rows;
        rows.into_iter()
            .filter(|row| row.broken)
            .map(|row| (row.kind, row.rule))
            .collect()
    };
    assert_eq!(broken("{}").len(), 2);
    assert!(broken(r#"{"allowed_depth": [["die*", "die*", 2e-6]]}"#).is_empty());
    assert_eq!(broken(r#"{"allowed_depth": [["die", "die#2", 2e-6]]}"#).len(), 1);
    assert_eq!(broken(r#"{"allowed_depth": [["die*", "die*", 5e-7]]}"#).len(), 2);
    assert!(broken(r#"{"exclude": [["die*", "die*"]]}"#).is_empty());
    let close = broken(r#"{"margin": 1, "exclude": [["die", "die#2"], ["die#2", "die#3", "glued"]]}"#);
    assert_eq!(close, [(Kind::Close, Some("margin".into()))]);
    assert!(broken(r#"{"allowed_volume": [["die*", "die*", 2e-6]]}"#).is_empty());
    assert_eq!(broken(r#"{"allowed_volume": [["die*", "die*", 5e-7]]}"#).len(), 2);
    for within in [-1.0, f64::NAN, f64::INFINITY] {
        let refused = find(&model, &Rules::default(), &options.clone().within(within), go).expect_err("no length");
        assert!(refused.to_string().starts_with("within is "), "{refused}");
    }
    // A gap that equals the margin keeps it.
    let mut model = Model::new();
    let die = solids::cuboid(Vector3::repeat(0.5)).expect("a box");
    model.add("a", die.clone(), Isometry3::identity());
    model.add("b", die, Isometry3::translation(1.25, 0.0, 0.0));
    let kind = |text: &str| found(&model, &rules(text), &options.clone().within(2.0)).rows[0].kind;
    assert_eq!(kind(r#"{"margin": 0.25}"#), Kind::Apart);
    assert_eq!(kind(r#"{"margin": 0.2500001}"#), Kind::Close);
    assert_eq!(kind(r#"{"margin": 0.2, "paddings": [["b", 0.1]]}"#), Kind::Close);
    assert_eq!(kind(r#"{"margin": 0.3, "margins": [["b", "a", 0.1]]}"#), Kind::Apart);
    let names = ["a", "b"];
    let unused =
        rules(r#"{"margins": [["a", "c*", 1]], "paddings": [["d", 1]], "exclude": [["a", "*"]]}"#).unused(&names);
    assert_eq!(unused, ["margins[0] (\"a\", \"c*\")", "paddings[0] (\"d\")"]);
    for wrong in [
        "",
        "[]",
        r#"{"margn": 1}"#,
        r#"{"margin": -1}"#,
        r#"{"margins": [["a", "b"]]}"#,
        r#"{"paddings": [["a", -1]]}"#,
    ] {
        assert!(Rules::from_json(wrong).is_err(), "{wrong}");
    }
}

#[test]
fn rows_do_not_depend_on_threads_and_a_stop_keeps_what_is_done() {
    let model = press_fits(40);
    let all = found(&model, &Rules::default(), &ClashOptions::default());
    assert!(all.is_complete && all.rows.len() == 39);
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        let again = pool.install(|| found(&model, &Rules::default(), &ClashOptions::default()));
        assert_eq!(again, all);
    }
    let many = press_fits(3_000);
    for least in [0, 1] {
        let stop = |now: Progress| Progress::stop_if(now.done >= least);
        let options = ClashOptions::default().volume(true);
        let some = find(&many, &Rules::default(), &options, stop).expect("parts");
        assert!(!some.is_complete && some.rows.len() < 2_999, "{}", some.rows.len());
        assert_eq!(some.measured, some.rows.len());
    }
}

#[test]
fn an_earlier_output_hides_what_is_known() {
    use lin_canny_clash::Comparison;
    let rows = found(&press_fits(3), &Rules::default(), &ClashOptions::default()).rows;
    let text: String = rows.iter().map(|row| row.to_json() + "\n").collect();
    let file = std::path::Path::new("before.jsonl");
    let same = Comparison::new(&rows, &text, file).expect("rows");
    assert!(same.rows.is_empty() && same.gone.is_empty());
    let mut worse = rows.clone();
    worse[1].depth = [2e-6, 2e-6];
    worse.remove(0);
    let changed = Comparison::new(&worse, &text, file).expect("rows");
    assert_eq!((&changed.rows[..], &changed.gone[..]), (&worse[..], &rows[..1]));
    let error = Comparison::new(&rows, "{}\n", file).expect_err("no row");
    assert!(error.to_string().starts_with("before.jsonl:1: "), "{error}");
}

#[test]
fn outputs_are_well_formed() {
    let mut model = Model::new();
    let die = solids::cuboid(Vector3::repeat(0.5)).expect("a box");
    for name in ["a<b & \"c\"", "a,b\n\u{1}", "c"] {
        model.add(name, die.clone(), Isometry3::identity());
    }
    let rows = found(&model, &Rules::default(), &ClashOptions::default().volume(true)).rows;
    assert!(rows.len() == 3 && rows.iter().all(|row| row.kind == Kind::Equal));
    let junit = lin_canny_clash::to_junit(&rows);
    let xml = roxmltree::Document::parse(&junit).expect("XML");
    assert_eq!(xml.descendants().filter(|node| node.has_tag_name("failure")).count(), 3);
    let csv = lin_canny_clash::to_csv(&rows);
    let mut table = csv::Reader::from_reader(csv.as_bytes());
    assert_eq!(table.records().filter_map(Result::ok).count(), 3);
    for row in &rows {
        let back: Row = serde_json::from_str(&row.to_json()).expect("a row");
        assert_eq!(&back, row);
    }
    assert_eq!(lin_canny_clash::worst_first(&rows).len(), 3);
}

//! Signed distances of points, and verdicts about curves: those of the library, bit for bit.

use std::sync::Arc;

use datafusion::arrow::array::{Float64Builder, ListBuilder, RecordBatch, UInt64Array};
use lin_canny::PointQuery;
use lin_canny::nalgebra::Point3;
use lin_canny_plan::{Checker, JointCurve, JointMotion, Verdict};
use lin_canny_study::robot::RobotFiles;
use lin_canny_study::sampled::Sampler;
use lin_canny_study::{Study, StudyError, StudyOptions, engine, flat};

use crate::{block_on, scratch, study, values};

const JOINTS: [&str; 6] = ["turn", "lift", "elbow", "roll", "bend", "twist"];

fn bits(text: &str) -> f64 {
    f64::from_bits(u64::from_str_radix(text, 16).expect("bits"))
}

/// The rows of a query over a table, all values.
fn asked(
    study: &Arc<Study>,
    rows: RecordBatch,
    partitions: usize,
    query: &str,
) -> Result<Vec<Vec<String>>, StudyError> {
    let found: Vec<_> = block_on(async {
        let context = engine::local(study, partitions);
        let cuts = (0..=partitions)
            .map(|k| rows.num_rows() * k / partitions)
            .collect::<Vec<_>>();
        let parts = cuts.windows(2).map(|c| vec![rows.slice(c[0], c[1] - c[0])]).collect();
        let table = datafusion::datasource::MemTable::try_new(rows.schema(), parts)?;
        context.register_table("configs", Arc::new(table))?;
        let found = context.sql(query).await?.collect_partitioned().await?.concat();
        found.iter().map(flat).collect::<Result<_, StudyError>>()
    })?;
    Ok(values(&found))
}

/// A cell with a solid mesh, a floor and a cloud.
fn cell() -> RobotFiles {
    let folder = scratch("points");
    let wedge = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    std::fs::write(folder.join("wedge.obj"), wedge).expect("a file");
    std::fs::write(folder.join("scan.xyz"), "0 0 0\n0.5 0.25 0\n0.5 0.5 0.5\n").expect("a file");
    let text = r#"{"bodies": [
        {"name": "part", "mesh": {"file": "wedge.obj", "as": "mesh"}, "xyz": [5, 0, 0]},
        {"name": "hull", "mesh": {"file": "wedge.obj"}, "xyz": [8, 0, 0]},
        {"name": "scan", "cloud": {"file": "scan.xyz", "radius": 0.25}, "xyz": [5, 5, 0]},
        {"name": "ball", "sphere": {"radius": 0.5}, "xyz": [0, 5, 0]},
        {"name": "ground", "half_space": {"normal": [0, 0.6, 0.8], "offset": -3}},
        {"name": "twin", "sphere": {"radius": 0.5}, "xyz": [0, 8, 0]},
        {"name": "twin", "sphere": {"radius": 0.5}, "xyz": [0, 9, 0]}]}"#;
    std::fs::write(folder.join("cell.json"), text).expect("a file");
    let mut files = crate::files();
    files.cell = Some(folder.join("cell.json"));
    files
}

#[test]
fn signed_distances_are_those_of_the_library() {
    let study = crate::load(&cell(), StudyOptions::default()).expect("the cell");
    let rows = |count| Sampler::halton(study.coordinates()).rows(0..count).expect("rows");
    let bodies = ["part", "hull", "scan", "ball", "ground", "gripper"];
    let cases: Vec<String> = bodies
        .iter()
        .enumerate()
        .map(|(k, b)| format!("WHEN {k} THEN '{b}'"))
        .collect();
    // Points on a lattice lie in, on and outside the bodies.
    let point = "SELECT id, CASE id % 6 {} END AS body, round(turn * 4) / 8 AS x, round(lift * 4) / 8 AS y, \
                 CASE WHEN id % 5 = 0 THEN 0 ELSE round(elbow * 4) / 8 END AS z FROM configs";
    let point = point.replace("{}", &cases.join(" "));
    let query = format!("SELECT body, x, y, z, signed_distance(body, x, y, z) AS d FROM ({point})");
    let found = asked(&study, rows(1200), 2, &query).expect("rows");
    let mut seen = std::collections::BTreeMap::new();
    for row in &found {
        let [x, y, z] = [1, 2, 3].map(|k| bits(&row[k]));
        let expected = study
            .with_checker(|checker| {
                let cell = checker.cell();
                let id = cell.bodies().find(|(_, name)| *name == row[0]).expect("a body").0;
                let query = PointQuery::new(cell.geometry(id).expect("a geometry"));
                query.closest_point(&Point3::new(x, y, z)).expect("a point")
            })
            .expect("a checker");
        let (p, n) = (expected.point, expected.normal);
        let numbers = [
            expected.distance,
            expected.lower,
            expected.upper,
            p.x,
            p.y,
            p.z,
            n.x,
            n.y,
            n.z,
        ];
        let numbers: Vec<String> = numbers.iter().map(|x| format!("{:016x}", x.to_bits())).collect();
        assert_eq!(
            (&row[4], &row[5..14]),
            (&expected.state.to_string(), &numbers[..]),
            "{row:?}"
        );
        assert_eq!(bits(&row[14]), f64::from(expected.location.subshape));
        *seen.entry(row[4].clone()).or_insert(0) += 1;
    }
    assert!(
        ["overlapping", "touching", "separated"].iter().all(|s| seen[*s] > 10),
        "{seen:?}"
    );
    // Partitions and lists change no bit.
    let list = format!("SELECT body, x, y, z, signed_distance(body, [x, y, z]) AS d FROM ({point})");
    for (partitions, query) in [(1, &query), (7, &query), (3, &list)] {
        assert!(
            asked(&study, rows(1200), partitions, query).expect("rows") == found,
            "{partitions}"
        );
    }
}

#[test]
fn wrong_points_are_named() {
    let study = crate::load(&cell(), StudyOptions::default()).expect("the cell");
    let lenient = crate::load(&cell(), StudyOptions::default().lenient(true)).expect("the cell");
    let rows = || Sampler::halton(study.coordinates()).rows(0..4).expect("rows");
    let with = |x: &str| format!("CASE WHEN id = 2 THEN {x} ELSE lift END");
    for (body, x, parts) in [
        (
            "'part'",
            "'NaN'::DOUBLE",
            ["row 2 of its batch", "y is NaN (expected -1e116..=1e116)"],
        ),
        ("'part'", "1e300", ["row 2 of its batch", "y is 1e300"]),
        ("'part'", "NULL", ["row 2 of its batch", "y is NULL"]),
        (
            "'prat'",
            "0.0",
            ["row 0 of its batch", "0 bodies have the name \"prat\""],
        ),
        (
            "'twin#3'",
            "0.0",
            ["row 0 of its batch", "0 bodies have the name \"twin#3\""],
        ),
        (
            "CASE WHEN id = 3 THEN NULL ELSE 'ball' END",
            "0.0",
            ["row 3 of its batch", "body is NULL"],
        ),
    ] {
        let query = format!(
            "SELECT signed_distance({body}, turn, {}, elbow) AS d FROM configs",
            with(x)
        );
        let error = asked(&study, rows(), 1, &query).expect_err(&query).to_string();
        assert!(parts.iter().all(|part| error.contains(part)), "{query}: {error}");
        let found = asked(&lenient, rows(), 1, &query).expect("rows");
        let known: Vec<bool> = found.iter().map(|row| !row[0].is_empty()).collect();
        let expected = match parts[0] {
            "row 2 of its batch" => [true, true, false, true],
            "row 3 of its batch" => [true, true, true, false],
            _ => [false; 4],
        };
        assert_eq!(known, expected, "{query}");
    }
    for wrong in [
        "signed_distance('part')",
        "signed_distance('part', 1.0, 2.0)",
        "signed_distance()",
    ] {
        assert!(
            asked(&study, rows(), 1, &format!("SELECT {wrong} FROM configs")).is_err(),
            "{wrong}"
        );
    }
}

/// Control points of curves about configurations of a sample: `p0` to `p3`, and all as one list.
fn curves(study: &Arc<Study>, count: u64) -> (RecordBatch, Vec<Vec<Vec<f64>>>) {
    let rows = Sampler::halton(study.coordinates()).rows(0..count).expect("rows");
    let names: Vec<String> = JOINTS.iter().map(|j| j.to_string()).collect();
    let at = values(&[rows
        .project(
            &names
                .iter()
                .map(|n| rows.schema().index_of(n).expect("a joint"))
                .collect::<Vec<_>>(),
        )
        .expect("rows")]);
    let mut curves = Vec::new();
    let mut columns: Vec<ListBuilder<Float64Builder>> =
        (0..4).map(|_| ListBuilder::new(Float64Builder::new())).collect();
    let mut whole = ListBuilder::new(ListBuilder::new(Float64Builder::new()));
    for (row, texts) in at.iter().enumerate() {
        let q: Vec<f64> = texts.iter().map(|text| bits(text)).collect();
        let point = |k: usize| -> Vec<f64> {
            let moved = |(j, x): (usize, f64)| {
                let [low, high] = study.coordinates()[j].limits;
                // Inside its limits, so that control points may be beyond them.
                0.5 * (low + high) + 0.7 * (x - 0.5 * (low + high)) + 0.3 * ((k * (row + 3 * j + 1)) as f64).sin()
            };
            q.iter().copied().enumerate().map(moved).collect()
        };
        let curve: Vec<Vec<f64>> = (0..4).map(point).collect();
        for (column, p) in columns.iter_mut().zip(&curve) {
            column.append_value(p.iter().map(|x| Some(*x)));
            whole.values().append_value(p.iter().map(|x| Some(*x)));
        }
        whole.append(true);
        curves.push(curve);
    }
    let id = Arc::new(UInt64Array::from_iter_values(0..count)) as _;
    let mut all = vec![("id".to_owned(), id)];
    for (k, mut column) in columns.into_iter().enumerate() {
        all.push((format!("p{k}"), Arc::new(column.finish()) as _));
    }
    all.push(("curve".to_owned(), Arc::new(whole.finish()) as _));
    (RecordBatch::try_from_iter(all).expect("rows"), curves)
}

#[test]
fn curves_are_certified_as_by_a_new_checker() {
    let study = study(StudyOptions::default());
    let (rows, curves) = curves(&study, 600);
    let query = "SELECT id, certify_curve(p0, p1, p2, p3) AS c FROM configs";
    let found = asked(&study, rows.clone(), 2, query).expect("rows");
    assert_eq!(found.len(), curves.len());
    let mut seen = [0; 2];
    for (row, curve) in found.iter().zip(&curves) {
        let mut checker = Checker::of_robots(study.cell().clone()).expect("a checker");
        let curve = JointCurve::bezier(curve).expect("a curve");
        let verdict = checker.certify(&JointMotion::curve(&curve)).expect("configurations");
        assert_eq!(bits(&row[2]).to_bits(), verdict.free_until().to_bits());
        match &verdict {
            Verdict::Free { .. } => assert_eq!((row[1].as_str(), row[4].as_str()), ("free", "")),
            Verdict::Blocked {
                contact_at: t, pair, ..
            } => {
                assert_eq!((row[1].as_str(), bits(&row[3]).to_bits()), ("blocked", t.to_bits()));
                assert_eq!(row[4..6], [pair.a, pair.b].map(|part| checker.name(part).to_owned()));
            }
            _ => assert_eq!(row[1], "undecided"),
        }
        seen[usize::from(verdict.is_free())] += 1;
    }
    assert!(seen.iter().all(|&n| n > 20), "{seen:?}");
    // Any number of workers, and one list of control points: the same bits.
    for partitions in [1, 7, 64] {
        assert!(
            asked(&study, rows.clone(), partitions, query).expect("rows") == found,
            "{partitions}"
        );
    }
    let whole = "SELECT id, certify_curve(curve) AS c FROM configs";
    assert!(asked(&study, rows.clone(), 3, whole).expect("rows") == found);
    // Two control points are a segment, and one stays where it is.
    let query = |what: &str| format!("SELECT id, {what} AS c FROM configs");
    let [line, segment] =
        ["certify_curve(p0, p1)", "certify(p0, p1)"].map(|what| asked(&study, rows.clone(), 2, &query(what)));
    assert_eq!(line.expect("rows"), segment.expect("rows"));
    let still = "SELECT count(*) FROM configs WHERE (certify_curve(p0)['verdict'] = 'free') <> is_free(p0)";
    assert_eq!(asked(&study, rows, 2, still).expect("a count"), [["0"]]);
}

#[test]
fn wrong_curves_are_named() {
    let strict = study(StudyOptions::default());
    let lenient = study(StudyOptions::default().lenient(true));
    let (rows, _) = curves(&strict, 4);
    let zero = "[0.0, 0.3, 0.3, 0.0, 0.3, 0.0]";
    for (what, parts) in [
        (
            "CASE WHEN id = 2 THEN NULL ELSE p1 END",
            ["row 2 of its batch", "control point 1: the list is NULL"],
        ),
        (
            "CASE WHEN id = 1 THEN [0.0, 1.0] ELSE p1 END",
            [
                "row 1 of its batch",
                "control point 1: the list has 2 values (expected 6)",
            ],
        ),
        (
            "CASE WHEN id = 3 THEN [0.0, 0.0, 'NaN'::DOUBLE, 0.0, 0.0, 0.0] ELSE p1 END",
            [
                "row 3 of its batch",
                "control point 1: elbow is NaN (expected a finite number)",
            ],
        ),
        (
            "CASE WHEN id = 0 THEN [0.0, 0.0, 0.0, 100.0, 0.0, 0.0] ELSE p1 END",
            ["row 0 of its batch", "roll at "],
        ),
    ] {
        let query = format!("SELECT certify_curve(p0, {what}, p2) AS c FROM configs");
        let error = asked(&strict, rows.clone(), 1, &query).expect_err(&query).to_string();
        assert!(parts.iter().all(|part| error.contains(part)), "{query}: {error}");
        let found = asked(&lenient, rows.clone(), 1, &query).expect("rows");
        assert_eq!(
            found.iter().filter(|row| row[0].is_empty()).count(),
            1,
            "{query}: {found:?}"
        );
    }
    let many = vec![zero; 18].join(", ");
    let query = format!("SELECT certify_curve({many}) AS c FROM configs");
    let error = asked(&strict, rows.clone(), 1, &query)
        .expect_err("a degree")
        .to_string();
    assert!(error.contains("degree of a curve"), "{error}");
    for wrong in [
        "certify_curve()",
        "certify_curve(id)",
        "certify_curve(curve, curve)",
        "certify_curve(p0, curve)",
    ] {
        assert!(
            asked(&strict, rows.clone(), 1, &format!("SELECT {wrong} FROM configs")).is_err(),
            "{wrong}"
        );
    }
    // Literals, and integers in them.
    let literal = format!(
        "SELECT certify_curve([{zero}, {zero}])['verdict'] AS a, certify_curve([0, 0, 0, 0, 0, 0])['safe'] >= 0 AS b FROM configs LIMIT 1"
    );
    assert_eq!(asked(&strict, rows, 1, &literal).expect("a row")[0][1], "true");
}

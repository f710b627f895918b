//! What the functions answer, and what they refuse.

use std::sync::Arc;

use datafusion::arrow::array::{ArrayRef, Int64Array, RecordBatch, StructArray};
use datafusion::arrow::buffer::NullBuffer;
use datafusion::arrow::datatypes::{DataType, Field};
use lin_canny_plan::receipt::Receipt;
use lin_canny_plan::{Cell, Checker, JointMotion, PlanError, Verdict};
use lin_canny_study::robot::{CellFile, RobotFiles};
use lin_canny_study::sampled::Sampler;
use lin_canny_study::{Study, StudyError, StudyOptions, engine, flat};

use crate::{block_on, example, files, study, values};

const JOINTS: &str = "turn, lift, elbow, roll, bend, twist";

/// The answer to a query over the first rows of a sample.
fn asked(study: &Arc<Study>, rows: u64, query: &str) -> Result<Vec<RecordBatch>, StudyError> {
    let rows = Sampler::halton(study.coordinates()).rows(0..rows)?;
    block_on(async {
        let context = engine::local(study, 2);
        context.register_batch("configs", rows)?;
        let answers = context.sql(query).await?.collect().await?;
        answers.iter().map(flat).collect()
    })
}

fn fails(study: &Arc<Study>, query: &str, parts: &[&str]) {
    let error = asked(study, 4, query).expect_err(query).to_string();
    for part in parts {
        assert!(error.contains(part), "{query}: {error}");
    }
}

#[test]
fn clearances_are_those_of_a_new_checker() {
    let study = study(StudyOptions::default());
    let found = asked(
        &study,
        400,
        &format!("SELECT {JOINTS}, clearance({JOINTS}) AS c FROM configs"),
    )
    .expect("rows");
    let mut contacts = 0;
    for row in values(&found) {
        let bits = |text: &String| f64::from_bits(u64::from_str_radix(text, 16).expect("bits"));
        let q: Vec<f64> = row[..6].iter().map(bits).collect();
        let mut checker = Checker::of_robots(study.cell().clone()).expect("a checker");
        let near = checker.clearance(&q).expect("a configuration").expect("a pair");
        let numbers = |list: &[f64]| list.iter().map(|x| format!("{:016x}", x.to_bits())).collect::<Vec<_>>();
        let mut expected = numbers(&[near.distance, near.lower, near.upper]);
        expected.extend([near.pair.a, near.pair.b].map(|part| checker.name(part).to_owned()));
        expected.extend(near.witnesses.iter().flat_map(|p| numbers(&[p.x, p.y, p.z])));
        assert_eq!(row[6..], expected[..], "{q:?}");
        contacts += u32::from(near.distance <= 0.0);
    }
    assert!((50..350).contains(&contacts), "{contacts}");
}

#[test]
fn predicates_agree_with_clearances() {
    let study = study(StudyOptions::default());
    let query = format!(
        "SELECT count(*) FROM configs WHERE is_free({JOINTS}) <> (clearance({JOINTS})['distance'] > 0) \
         OR is_free({JOINTS}) <> is_free(make_array({JOINTS})) \
         OR (certify(make_array({JOINTS}), make_array({JOINTS}))['verdict'] = 'free') <> is_free({JOINTS})"
    );
    assert_eq!(values(&asked(&study, 2000, &query).expect("a count")), [["0"]]);
    // Among them are both.
    let query = format!("SELECT count(*) > 400, count(*) < 1600 FROM configs WHERE is_free({JOINTS})");
    assert_eq!(
        values(&asked(&study, 2000, &query).expect("a count")),
        [["true", "true"]]
    );
}

#[test]
fn a_margin_is_kept() {
    let margin = StudyOptions::default().margin(0.05);
    let study = study(margin);
    let query =
        format!("SELECT count(*) FROM configs WHERE is_free({JOINTS}) <> (clearance({JOINTS})['distance'] > 0.05)");
    assert_eq!(values(&asked(&study, 2000, &query).expect("a count")), [["0"]]);
}

#[test]
fn an_attached_object_a_padding_and_an_excluded_pair_are_those_of_the_checker() {
    let folder = crate::scratch("attached");
    let part = folder.join("part.json");
    let text = r#"{"name": "rod", "box": {"size": [0.04, 0.04, 0.5]}, "xyz": [0, 0, 0.3], "touch_links": ["gripper"]}"#;
    std::fs::write(&part, text).expect("a file");
    let mut files = crate::files();
    files.attached.push(("gripper".into(), part));
    files.paddings.push(("rod".into(), 0.05));
    files.excluded.push(["rod".into(), "table".into()]);
    let study = crate::load(&files, StudyOptions::default().margin(0.01)).expect("the example");
    let query = format!("SELECT {JOINTS}, is_free({JOINTS}), clearance({JOINTS}) AS c FROM configs");
    let (mut rods, mut kept) = (0, 0);
    for row in values(&asked(&study, 400, &query).expect("rows")) {
        let bits = |text: &String| f64::from_bits(u64::from_str_radix(text, 16).expect("bits"));
        let q: Vec<f64> = row[..6].iter().map(bits).collect();
        let mut checker = Checker::of_robots(study.cell().clone()).expect("a checker");
        checker.cell_mut().set_margin(0.01).expect("a margin");
        let near = checker.nearest(&q, 0.1).expect("a configuration");
        assert_eq!(bits(&row[7]).to_bits(), near[0].distance.to_bits(), "{q:?}");
        let names = [near[0].pair.a, near[0].pair.b].map(|part| checker.name(part).to_owned());
        assert_eq!(row[10..12], names);
        assert_ne!(names, ["rod", "table"]);
        rods += u32::from(names[0] == "rod");
        // A pair that is farther by the slack keeps every distance.
        let is_free = near.iter().all(|pair| pair.excess > 0.0);
        assert_eq!(row[6], is_free.to_string(), "{q:?}");
        kept += u32::from(!is_free && near[0].distance > 0.01);
    }
    assert!(rods > 50 && kept > 5, "{rods} {kept}");
    files.paddings.push(("hnad".into(), 0.05));
    let error = crate::load(&files, StudyOptions::default()).err().expect("an error");
    assert!(error.to_string().contains("hnad"), "{error}");
}

#[test]
fn a_saved_world_is_the_same_study() {
    let mut checker = Checker::of_robots(files().load().expect("the example").cell).expect("a checker");
    checker.cell_mut().set_margin(0.02).expect("a margin");
    checker.cell_mut().pad("gripper", 0.01).expect("a padding");
    checker.cell_mut().exclude("base", "gripper").expect("a pair");
    let file = crate::scratch("saved").join("cell.json");
    CellFile::from_cell(checker.cell()).save(&file).expect("a file");
    let mut saved = files();
    saved.cell = Some(file);
    let of = |options| crate::load(&saved, options).expect("the saved cell");
    let found = of(StudyOptions::default());
    let again = found
        .with_checker(|c| (c.cell().margin(), c.cell().clone()))
        .expect("a checker");
    assert_eq!(again.0, 0.02);
    let text = |cell| CellFile::from_cell(cell).to_json().expect("a text");
    assert_eq!(text(&again.1), text(checker.cell()));
    // The same margin in other words is the same study, another margin is another.
    assert_eq!(
        found.fingerprint(),
        of(StudyOptions::default().margin(0.02)).fingerprint()
    );
    assert_ne!(
        found.fingerprint(),
        of(StudyOptions::default().margin(0.0)).fingerprint()
    );
}

#[test]
fn a_lift_from_a_contact_is_certified_with_a_margin() {
    let folder = crate::scratch("lift");
    let urdf = r#"<robot name="lift"><link name="base"/>
        <link name="part"><collision><geometry><box size="0.5 0.5 0.5"/></geometry></collision></link>
        <joint name="z" type="prismatic"><parent link="base"/><child link="part"/><axis xyz="0 0 1"/>
        <limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"#;
    let cell = r#"{"bodies": [{"name": "table", "box": {"size": [2, 2, 0.5]}, "xyz": [0, 0, -0.5]}]}"#;
    std::fs::write(folder.join("lift.urdf"), urdf).expect("a file");
    std::fs::write(folder.join("cell.json"), cell).expect("a file");
    let mut files = RobotFiles::new(folder.join("lift.urdf"));
    files.cell = Some(folder.join("cell.json"));
    let ask = |margin: Option<f64>| {
        let options = StudyOptions::default().start_contact_margin(margin);
        let study = crate::load(&files, options).expect("the lift");
        let query = "SELECT certify(0.0, z) AS c FROM (VALUES (0.5), (-0.5)) AS t(z)";
        let rows = block_on(async {
            let answers = engine::local(&study, 1).sql(query).await?.collect().await?;
            answers.iter().map(flat).collect::<Result<Vec<_>, StudyError>>()
        });
        let rows = values(&rows.expect("rows"));
        let picked: Vec<_> = rows.iter().map(|row| [row[0].clone(), row[5].clone()]).collect();
        (picked, study.fingerprint().to_owned())
    };
    let blocked = ["blocked".to_owned(), String::new()];
    let (strict, first) = ask(None);
    assert_eq!(strict, [blocked.clone(), blocked.clone()]);
    let (lifted, second) = ask(Some(1e-3));
    assert_eq!(lifted, [["free".to_owned(), "part and table".to_owned()], blocked]);
    assert_ne!(first, second);
    let options = StudyOptions::default().start_contact_margin(Some(-1.0));
    let error = crate::load(&files, options).err().expect("an error");
    assert!(error.to_string().contains("start contact margin"), "{error}");
}

#[test]
fn segments_are_certified_as_by_a_new_checker() {
    let study = study(StudyOptions::default());
    let next = "turn + 0.3, lift, elbow - 0.6, roll, bend, twist";
    let inner = "abs(turn) < 2.5 AND abs(elbow) < 1.9";
    let text = format!(
        "SELECT {JOINTS}, turn + 0.3 AS t2, elbow - 0.6 AS e2, certify({JOINTS}, {next}) AS c FROM configs WHERE {inner}"
    );
    let mut seen = [0; 2];
    for row in values(&asked(&study, 1500, &text).expect("rows")) {
        let bits = |text: &String| f64::from_bits(u64::from_str_radix(text, 16).expect("bits"));
        let from: Vec<f64> = row[..6].iter().map(bits).collect();
        let mut to = from.clone();
        let mut checker = Checker::of_robots(study.cell().clone()).expect("a checker");
        (to[0], to[2]) = (bits(&row[6]), bits(&row[7]));
        let verdict = checker
            .certify(&JointMotion::segment(&from, &to))
            .expect("configurations");
        assert_eq!(bits(&row[9]).to_bits(), verdict.free_until().to_bits());
        match verdict {
            Verdict::Free { .. } => assert_eq!((row[8].as_str(), row[13].as_str()), ("free", "")),
            Verdict::Blocked {
                contact_at: t, pair, ..
            } => {
                assert_eq!((row[8].as_str(), bits(&row[10]).to_bits()), ("blocked", t.to_bits()));
                assert_eq!(row[11..13], [pair.a, pair.b].map(|part| checker.name(part).to_owned()));
            }
            _ => assert_eq!(row[8], "undecided"),
        }
        seen[usize::from(verdict.is_free())] += 1;
    }
    assert!(seen.iter().all(|&n| n > 20), "{seen:?}");
}

#[test]
fn receipts_are_those_of_a_new_checker() {
    let study = study(StudyOptions::default());
    let next = "turn + 0.1, lift, elbow - 0.1, roll, bend, twist";
    let inner = "abs(turn) < 2.5 AND abs(elbow) < 1.9";
    let text = format!(
        "SELECT {JOINTS}, turn + 0.1 AS t2, elbow - 0.1 AS e2, receipt({JOINTS}, {next}) AS r FROM configs WHERE {inner}"
    );
    let mut seen = [0; 2];
    for row in values(&asked(&study, 60, &text).expect("rows")) {
        let bits = |text: &String| f64::from_bits(u64::from_str_radix(text, 16).expect("bits"));
        let from: Vec<f64> = row[..6].iter().map(bits).collect();
        let mut to = from.clone();
        let mut checker = Checker::of_robots(study.cell().clone()).expect("a checker");
        (to[0], to[2]) = (bits(&row[6]), bits(&row[7]));
        let (text, error) = match Receipt::motion(&mut checker, &JointMotion::segment(&from, &to)) {
            Ok(receipt) => (receipt.to_string(), String::new()),
            Err(error) => (String::new(), error.to_string()),
        };
        seen[usize::from(error.is_empty())] += 1;
        assert_eq!((&row[8], &row[9]), (&text, &error));
    }
    println!("{seen:?} without and with a receipt");
    assert!(seen[1] > 5, "{seen:?}");
    fails(
        &study,
        "SELECT receipt(1.0) FROM configs",
        &["receipt has invalid arguments", "12 numbers"],
    );
}

#[test]
fn separations_are_measured_by_name() {
    let study = study(StudyOptions::default());
    // The gripper ends 0.12 above its frame, the table 0.02 below its middle.
    let text = "SELECT separation('gripper', 'table', 0, 0, 1, 0, 0, 0, 1) AS s FROM configs LIMIT 1";
    let row = &values(&asked(&study, 1, text).expect("a row"))[0];
    let distance = f64::from_bits(u64::from_str_radix(&row[1], 16).expect("bits"));
    assert_eq!(row[0], "separated");
    assert!((distance - 0.86).abs() < 1e-12, "{distance}");
    let turned = "SELECT separation('gripper', 'table', [0, 0, 0.1, 0, 0, 0.6, 0.8])['state'] FROM configs LIMIT 1";
    assert_eq!(values(&asked(&study, 1, turned).expect("a row")), [["overlapping"]]);
    fails(
        &study,
        "SELECT separation('hand', 'table', 0, 0, 1, 0, 0, 0, 1) FROM configs",
        &["0 bodies", "hand"],
    );
    fails(
        &study,
        "SELECT separation('gripper', 'table', 0, 0, 1, 0, 0, 0, 2) FROM configs",
        &["norm 2.0"],
    );
}

#[test]
fn bad_rows_are_named() {
    let strict = study(StudyOptions::default());
    let none = "turn, CASE WHEN id = 2 THEN NULL ELSE lift END, elbow, roll, bend, twist";
    for function in ["clearance", "is_free"] {
        fails(
            &strict,
            &format!("SELECT {function}({none}) FROM configs"),
            &["row 2 ", "lift is NULL"],
        );
        let far = "turn, lift, elbow, CASE WHEN id = 3 THEN 2.95 ELSE roll END, bend, twist";
        let parts = ["row 3 ", "roll is 2.95 (expected -2.9..=2.9)"];
        fails(&strict, &format!("SELECT {function}({far}) FROM configs"), &parts);
        let nan = "turn, lift, elbow, roll, 'NaN'::DOUBLE, twist";
        fails(
            &strict,
            &format!("SELECT {function}({nan}) FROM configs"),
            &["row 0 ", "bend is NaN"],
        );
        fails(
            &strict,
            &format!("SELECT {function}([1, 2, 3]) FROM configs"),
            &["3 values (expected 6)"],
        );
        fails(
            &strict,
            &format!("SELECT {function}(turn) FROM configs"),
            &["6 number(s)", "elbow"],
        );
    }
    let fault = format!("SELECT configuration_error({none}) FROM configs");
    let found = values(&asked(&strict, 4, &fault).expect("faults"));
    assert_eq!(found, [[""], [""], ["lift is NULL"], [""]]);

    let lenient = StudyOptions::default().lenient(true);
    let lenient = study(lenient);
    let text = format!(
        "SELECT id, c['distance'] IS NULL, c IS NULL, is_free({none}) IS NULL FROM (SELECT *, clearance({none}) AS c FROM configs)"
    );
    let found = values(&asked(&lenient, 4, &text).expect("rows"));
    for row in &found {
        let is_bad = (row[0] == "2").to_string();
        assert!(row[1..].iter().all(|v| *v == is_bad), "{row:?}");
    }
    let certified = format!("SELECT certify({none}, {JOINTS}) AS c FROM configs");
    let found = values(&asked(&lenient, 4, &certified).expect("rows"));
    assert!(
        found[2].iter().all(String::is_empty) && !found[1][0].is_empty(),
        "{found:?}"
    );
}

#[test]
fn fingerprints_cover_what_pairs_must_keep() {
    let cell = RobotFiles::new(example("six_axis.urdf"))
        .load()
        .expect("the example")
        .cell;
    let of = |change: &dyn Fn(&mut Cell) -> Result<(), PlanError>| {
        let mut cell = cell.clone();
        change(&mut cell).expect("a change");
        let study = Study::new(cell, StudyOptions::default()).expect("a study");
        study.fingerprint().to_owned()
    };
    let all = [
        of(&|_| Ok(())),
        of(&|c| c.set_pair_margin("base", "gripper", Some(0.01)).map(|_| ())),
        of(&|c| c.set_pair_margin("base", "gripper", Some(0.0)).map(|_| ())),
        of(&|c| c.set_pair_margin("base", "forearm", Some(0.01)).map(|_| ())),
        of(&|c| c.pad("gripper", 0.01).map(|_| ())),
        of(&|c| c.exclude("base", "gripper").map(|_| ())),
        of(&|c| c.set_margin(0.01)),
    ];
    let different: std::collections::BTreeSet<_> = all.iter().collect();
    assert_eq!(different.len(), all.len(), "{all:?}");
    assert_eq!(all[0], of(&|c| c.pad("gripper", 0.0).map(|_| ())));
}

#[test]
fn fingerprints_tell_studies_apart() {
    let names = [0.0, 0.01].map(|margin| {
        let options = StudyOptions::default().margin(margin);
        study(options).fingerprint().to_owned()
    });
    assert_ne!(names[0], names[1]);
    assert_eq!(names[0], study(StudyOptions::default()).fingerprint());
    let mut without = crate::files();
    without.srdf = None;
    let other = crate::load(&without, StudyOptions::default()).expect("the example");
    assert_ne!(names[0], other.fingerprint());
}

#[test]
fn fields_of_a_null_struct_are_null() {
    let values = Arc::new(Int64Array::from(vec![1, 2, 3])) as ArrayRef;
    let field = Arc::new(Field::new("x", DataType::Int64, false));
    let nulls = NullBuffer::from(vec![true, false, true]);
    let parts = StructArray::try_new(vec![field].into(), vec![Arc::clone(&values)], Some(nulls)).expect("a struct");
    let batch = RecordBatch::try_from_iter([("x", values), ("s", Arc::new(parts) as ArrayRef)]).expect("rows");
    let found = flat(&batch).expect("columns");
    assert_eq!(found.schema().field(1).name(), "s_x");
    assert_eq!(crate::values(&[found]), [["1", "1"], ["2", ""], ["3", "3"]]);
}

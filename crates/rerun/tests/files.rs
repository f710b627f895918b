//! Promises: what a recording shows, the file of rerun shows at the same frames; what is gone is cleared; what is refused is named.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::process::Command;

use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{Geometry, PairTracker, RelativePose};
use lin_canny_record::{Cursor, Recorder, Recording};
use lin_canny_rerun::{TIMELINE, body_path, save};
use rerun::external::re_log_types::TimelineName;
use rerun::log::{Chunk, LogMsg};
use rerun::{Clear, EntityPath, Mesh3D, Points3D, Scalars, TextLog, Transform3D};

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../record/examples")
        .join(name)
}

fn scratch(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// The chunks of a file.
fn chunks(file: &Path) -> Vec<Chunk> {
    let reader = BufReader::new(File::open(file).expect("a file"));
    let messages = re_log_encoding::DecoderApp::decode_eager(reader).expect("a file of rerun");
    let chunk = |message: LogMsg| match message {
        LogMsg::ArrowMsg(_, batch) => Some(Chunk::from_arrow_msg(&batch).expect("a chunk")),
        _ => None,
    };
    messages.filter_map(|m| chunk(m.expect("a message"))).collect()
}

/// By frame: the first value of a component of an entity.
fn values<S: 'static + Clone>(
    chunks: &[Chunk],
    entity: &EntityPath,
    component: rerun::ComponentDescriptor,
    read: impl Fn(&Chunk) -> Vec<S>,
) -> BTreeMap<i64, S> {
    let mut all = BTreeMap::new();
    for chunk in chunks.iter().filter(|c| c.entity_path() == entity) {
        let times = chunk.iter_component_indices(TimelineName::from(TIMELINE), component.component);
        all.extend(times.map(|(time, _)| time.as_i64()).zip(read(chunk)));
    }
    all
}

fn translations(chunks: &[Chunk], entity: &EntityPath) -> BTreeMap<i64, [f32; 3]> {
    let component = Transform3D::descriptor_translation();
    let read = |chunk: &Chunk| {
        chunk
            .iter_slices::<[f32; 3]>(component.component)
            .map(|s| s[0])
            .collect()
    };
    values(chunks, entity, component.clone(), read)
}

fn count(chunks: &[Chunk], prefix: &str, component: &rerun::ComponentDescriptor) -> u64 {
    let of = chunks
        .iter()
        .filter(|c| c.entity_path().to_string().starts_with(prefix));
    of.filter_map(|c| c.num_events_for_component(component.component)).sum()
}

#[test]
fn bodies_stand_where_the_recording_has_them() {
    for name in ["pair", "kinds", "pile", "cast"] {
        let recording = Recording::open(example(&format!("{name}.jsonl"))).expect("an example");
        let file = scratch(&format!("{name}.rrd"));
        save(&recording, &file).expect("a file");
        let chunks = chunks(&file);
        let (mut cursor, mut moved) = (Cursor::default(), 0);
        for body in 0..recording.bodies.len() {
            let found = translations(&chunks, &body_path(&recording, body));
            assert!(!found.is_empty(), "{name}: body {body}");
            for frame in 0..recording.frames.len() {
                cursor.seek(&recording, frame);
                let Some(pose) = cursor.poses[body] else { continue };
                let last = found.range(..=frame as i64).next_back().expect("a pose").1;
                let expected: [f64; 3] = pose.translation.vector.into();
                assert_eq!(*last, expected.map(|x| x as f32), "{name}: body {body}, frame {frame}");
            }
            moved += found.len();
        }
        assert!(
            moved > recording.bodies.len() || recording.frames.len() == 1,
            "{name}: nothing moves"
        );
    }
}

#[test]
fn pairs_have_points_and_distances() {
    let recording = Recording::open(example("pair.jsonl")).expect("an example");
    let file = scratch("distances.rrd");
    save(&recording, &file).expect("a file");
    let chunks = chunks(&file);
    let distances = chunks
        .iter()
        .map(|c| c.entity_path())
        .find(|p| p.to_string().ends_with("/distance"));
    let component = Scalars::descriptor_scalars();
    let read = |chunk: &Chunk| chunk.iter_slices::<f64>(component.component).map(|s| s[0]).collect();
    let found = values(&chunks, distances.expect("distances"), component.clone(), read);
    let expected = recording.frames.iter().enumerate().filter_map(|(k, frame)| {
        let outcome = frame.pairs.first()?.outcome.as_ref()?;
        Some((k as i64, outcome.distance))
    });
    assert_eq!(found, expected.collect(), "to the bit");
    assert!(count(&chunks, "/pairs", &Points3D::descriptor_positions()) >= found.len() as u64);
}

#[test]
fn contacts_have_names() {
    let recording = Recording::open(example("pile.jsonl")).expect("an example");
    let file = scratch("contacts.rrd");
    save(&recording, &file).expect("a file");
    let chunks = chunks(&file);
    let with_contacts = recording
        .frames
        .iter()
        .flat_map(|f| &f.pairs)
        .filter(|p| !p.contacts.is_empty());
    let labels = Points3D::descriptor_labels();
    assert_eq!(count(&chunks, "/pairs", &labels), with_contacts.count() as u64);
}

#[test]
fn what_is_gone_is_cleared() {
    let cube = Geometry::from(solids::cuboid(Vector3::new(0.5, 0.5, 0.5)).expect("a cube"));
    let mut lines = Vec::new();
    let mut recorder = Recorder::new(&mut lines, "two cubes").expect("a recording");
    let at = |x: f64| Isometry3::translation(x, 0.0, 0.0);
    let a = recorder.body("still", &cube, &at(0.0)).expect("a body");
    let b = recorder.body("moved", &cube, &at(3.0)).expect("a body");
    let answer = PairTracker::new().closest(&cube, &cube, &RelativePose::from_isometry(&at(3.0)).expect("a pose"));
    // The pair is there, then not; the body goes, and comes back elsewhere.
    recorder.answer(a, b, &answer).expect("an answer");
    recorder.end_frame().expect("frame 0");
    recorder.end_frame().expect("frame 1");
    recorder.remove(b).expect("a body");
    recorder.end_frame().expect("frame 2");
    recorder.pose(b, &at(4.0)).expect("a body");
    recorder.answer(a, b, &answer).expect("an answer");
    recorder.end_frame().expect("frame 3");
    recorder.finish().expect("a recording");
    let recording = Recording::read(lines.as_slice()).expect("a recording");
    let file = scratch("cleared.rrd");
    save(&recording, &file).expect("a file");
    let chunks = chunks(&file);

    let clears = |entity: &EntityPath| {
        let component = Clear::descriptor_is_recursive();
        let read = |chunk: &Chunk| vec![(); chunk.num_rows()];
        values(&chunks, entity, component, read).into_keys().collect::<Vec<_>>()
    };
    let pair = chunks
        .iter()
        .map(Chunk::entity_path)
        .find(|p| p.to_string().starts_with("/pairs"));
    assert_eq!(clears(pair.expect("the pair")), [1]);
    assert_eq!(clears(&body_path(&recording, 1)), [2]);
    assert!(clears(&body_path(&recording, 0)).is_empty());
    let shown = count(
        &chunks,
        &body_path(&recording, 1).to_string(),
        &Mesh3D::descriptor_vertex_positions(),
    );
    assert_eq!(shown, 2, "the body is shown, and again when it is back");
    assert_eq!(translations(&chunks, &body_path(&recording, 1))[&3], [4.0, 0.0, 0.0]);
}

#[test]
fn casts_are_told() {
    let recording = Recording::open(example("cast.jsonl")).expect("an example");
    let file = scratch("told.rrd");
    save(&recording, &file).expect("a file");
    let casts: usize = recording.frames.iter().map(|f| f.brackets.len()).sum();
    assert!(casts > 0);
    assert_eq!(
        count(&chunks(&file), "/casts", &TextLog::descriptor_text()),
        casts as u64
    );
}

#[test]
fn the_tool_names_what_it_refuses() {
    let run = |arguments: [&Path; 2]| {
        let output = Command::new(env!("CARGO_BIN_EXE_lin-canny-rerun"))
            .args(arguments)
            .output()
            .expect("the tool runs");
        (
            output.status.code(),
            String::from_utf8_lossy(&output.stderr).into_owned(),
        )
    };
    let good = example("pair.jsonl");
    assert_eq!(run([&good, &scratch("tool.rrd")]).0, Some(0));
    assert!(std::fs::read(scratch("tool.rrd")).expect("a file").starts_with(b"RRF2"));
    let (code, text) = run([&example("none.jsonl"), &scratch("none.rrd")]);
    assert!(code == Some(3) && text.contains("none.jsonl"), "{text}");
    let (code, text) = run([&good, &scratch("no folder/x.rrd")]);
    assert!(code == Some(3) && text.contains("x.rrd"), "{text}");
    std::fs::write(scratch("bad.jsonl"), "{\"format\":\"other\",\"version\":1}\n").expect("a file");
    let (code, text) = run([&scratch("bad.jsonl"), &scratch("bad.rrd")]);
    assert!(code == Some(3) && text.contains("other"), "{text}");
}

//! The rows cover every public query: the names are read from the source.

/// Functions that take a pose and return no length: checks of a cached front, the trace of a walk,
/// a text.
const NOT_ASKED: [&str; 4] = ["check", "trace", "replay", "in_world"];

/// Returns the names of the public functions of a file that take a relative pose.
fn asked_by_pose(text: &str) -> impl Iterator<Item = &str> {
    let is_end = |c: char| c == '{' || c == ';';
    let functions = text.split("    pub fn ").skip(1);
    let posed = functions.filter(move |f| {
        f.split(is_end)
            .next()
            .is_some_and(|head| head.contains("&RelativePose"))
    });
    posed.filter_map(|f| f.split(|c: char| !c.is_alphanumeric() && c != '_').next())
}

#[test]
fn every_query_has_a_row() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../src");
    let rows = [
        include_str!("../calls.rs"),
        include_str!("moving.rs"),
        include_str!("worlds.rs"),
    ]
    .concat();
    let (mut folders, mut count) = (vec![root], 0);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let text = std::fs::read_to_string(&path).unwrap();
            for name in asked_by_pose(&text).filter(|name| !NOT_ASKED.contains(name)) {
                count += 1;
                let is_named = ["(", "::<"].iter().any(|end| rows.contains(&format!("{name}{end}")));
                assert!(is_named, "{}: {name} is asked in no unit but one", path.display());
            }
        }
    }
    assert!(count > 20, "{count}");
}

//! Promise: the README shows the example `hello` as it is, and every file it points to is there.

use std::path::Path;

fn read(name: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

#[test]
fn the_readme_shows_hello() {
    let hello = read("examples/hello.rs");
    let code = &hello[hello.find("use ").expect("hello uses the crate")..];
    assert!(
        read("README.md").contains(code),
        "README.md and examples/hello.rs differ"
    );
}

#[test]
fn files_of_the_readme_exist() {
    let readme = read("README.md");
    let links = readme.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    let local: Vec<&str> = links.filter(|l| !l.starts_with("http")).collect();
    assert!(local.len() >= 4, "{local:?}");
    local
        .iter()
        .for_each(|name| assert!(!read(name).is_empty(), "{name} is empty"));
}

/// Every `cargo ... --test NAME` and `--example NAME` of the README names one that exists.
#[test]
fn commands_of_the_readme_exist() {
    let readme = read("README.md");
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut seen = 0;
    for (flag, folder) in [("--test ", "tests"), ("--example ", "examples")] {
        for rest in readme.split(flag).skip(1) {
            let name: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            let file = root.join(folder).join(format!("{name}.rs"));
            assert!(
                file.exists() || root.join(folder).join(&name).join("main.rs").exists(),
                "{flag}{name}"
            );
            seen += 1;
        }
    }
    assert!(seen > 2, "{seen}");
}

/// Every example of the table of examples exists, and every example stands in the table.
#[test]
fn the_table_of_examples_is_complete() {
    let readme = read("README.md");
    let table = readme
        .split("## Examples")
        .nth(1)
        .and_then(|rest| rest.split("\n## ").next());
    let rows = table
        .expect("a section on examples")
        .lines()
        .filter(|l| l.starts_with("| `"));
    let first = rows.filter_map(|l| l.split('|').nth(1));
    let mut named: Vec<String> = first
        .flat_map(|cell| cell.split('`').skip(1).step_by(2))
        .map(Into::into)
        .collect();
    named.sort();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let entries = std::fs::read_dir(folder)
        .expect("examples")
        .map(|e| e.expect("an entry").path());
    let is_example = |p: &std::path::PathBuf| p.extension().is_some_and(|e| e == "rs") || p.join("main.rs").exists();
    let stem = |p: std::path::PathBuf| p.file_stem().expect("a name").to_string_lossy().into_owned();
    let mut there: Vec<String> = entries.filter(is_example).map(stem).collect();
    there.sort();
    assert_eq!(named, there);
}

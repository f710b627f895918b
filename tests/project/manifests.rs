//! Promise: the manifests of the published packages agree with each other, with the changelogs and with `release.toml`.

use crate::read;
use std::collections::BTreeSet;

/// The folders of the published packages.
const PUBLISHED: [&str; 10] = [
    ".",
    "crates/clash",
    "crates/cli",
    "crates/formats",
    "crates/parry",
    "crates/plan",
    "crates/rapier",
    "crates/record",
    "crates/robot",
    "crates/verify",
];

fn manifest(folder: &str) -> String {
    read(&format!("{folder}/Cargo.toml"))
}

/// Returns the lines of a section of a manifest that are neither empty nor comments.
fn section<'a>(manifest: &'a str, name: &str) -> Vec<&'a str> {
    let head = format!("[{name}]");
    let lines = manifest.lines().skip_while(|line| *line != head).skip(1);
    let lines = lines.take_while(|line| !line.starts_with('['));
    lines
        .filter(|line| !line.is_empty() && !line.starts_with('#'))
        .collect()
}

/// Returns the value of a key of a manifest or of `release.toml`, without its quotes.
fn value<'a>(text: &'a str, key: &str) -> &'a str {
    let line = text.lines().find(|line| line.starts_with(&format!("{key} = \"")));
    line.and_then(|line| line.split('"').nth(1))
        .unwrap_or_else(|| panic!("no {key}"))
}

/// Returns the features of a package that users may enable.
fn features(folder: &str) -> Vec<String> {
    let manifest = manifest(folder);
    let names = section(&manifest, "features")
        .into_iter()
        .filter_map(|line| line.split(' ').next());
    let public = names.filter(|name| *name != "default" && !name.starts_with("__"));
    public.map(str::to_owned).collect()
}

#[test]
fn docs_rs_shows_the_features_that_users_may_enable() {
    for folder in PUBLISHED {
        let manifest = manifest(folder);
        let features = features(folder);
        let mut expected = BTreeSet::from(["rustdoc-args = [\"--cfg\", \"docsrs\"]".to_owned()]);
        if !features.is_empty() {
            expected.insert(format!("features = {features:?}"));
        }
        let found = section(&manifest, "package.metadata.docs.rs").into_iter();
        let found: BTreeSet<_> = found
            .map(|line| line.split(" #").next().unwrap_or(line).to_owned())
            .collect();
        assert_eq!(found, expected, "{folder}");
    }
}

#[test]
fn the_page_of_features_lists_them_all() {
    let page = read("docs/features.md");
    let rows = page.lines().filter(|line| line.starts_with("| `lin-canny"));
    let mut listed: Vec<_> = rows
        .map(|row| {
            let cells: Vec<_> = row.split('|').map(|cell| cell.trim().trim_matches('`')).collect();
            [cells[1], cells[2], cells[3]].map(str::to_owned)
        })
        .collect();
    let mut expected = Vec::new();
    for folder in PUBLISHED {
        let manifest = manifest(folder);
        let defaults = section(&manifest, "features");
        let defaults = defaults.iter().find(|line| line.starts_with("default = "));
        let by_default = |name: &str| defaults.is_some_and(|line| line.contains(&format!("\"{name}\"")));
        expected.extend(features(folder).into_iter().map(|name| {
            let is_default = if by_default(&name) { "yes" } else { "no" };
            [value(&manifest, "name").to_owned(), name, is_default.to_owned()]
        }));
    }
    listed.sort();
    expected.sort();
    assert_eq!(listed, expected);
}

#[test]
fn every_version_has_a_changelog() {
    let version = value(&manifest("."), "version").to_owned();
    for folder in PUBLISHED {
        let manifest = manifest(folder);
        let own = value(&manifest, "version");
        let log = if own == version { "." } else { folder };
        let log = read(&format!("{log}/CHANGELOG.md"));
        let newest = log.lines().find(|line| line.starts_with("## ")).unwrap_or_default();
        assert!(newest.starts_with(&format!("## [{own}]")), "{folder}: {newest}");
        // What the package requires of the others: their minor versions.
        for line in section(&manifest, "dependencies") {
            let Some((name, rest)) = line.split_once(" = { version = \"") else {
                continue;
            };
            let Some((required, other)) = rest.split_once("\", path = \"") else {
                continue;
            };
            let other = other.split('"').next().expect("a path");
            let other = value(&read(&format!("{folder}/{other}/Cargo.toml")), "version").to_owned();
            assert!(
                other.starts_with(&format!("{required}.")),
                "{folder}: {name} {required}"
            );
        }
    }
    for folder in ["crates/capi", "crates/python", "crates/rerun", "crates/study"] {
        assert_eq!(value(&manifest(folder), "version"), version, "{folder}");
    }
    assert!(read("CITATION.cff").contains(&format!("\nversion: {version}\n")));
    assert!(read("crates/python/recipe.yaml").contains(&format!("\n  version: \"{version}\"\n")));
}

#[test]
fn the_address_of_the_repository_is_that_of_a_release() {
    let address = read("release.toml");
    assert_eq!(value(&manifest("."), "repository"), value(&address, "repository"));
}

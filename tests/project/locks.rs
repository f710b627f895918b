//! Promise: the lock files of the workspaces outside the core contain what the manifests of this
//! repository require.
//!
//! Their builds run with `--locked`, so a dependency added to a member would stop them.

use crate::read;
use std::collections::{BTreeMap, BTreeSet};

/// The workspaces outside the core.
const WORKSPACES: [&str; 4] = ["crates/capi", "crates/python", "crates/rerun", "crates/study"];

/// Returns the text of each manifest by the name of its package.
fn manifests() -> BTreeMap<String, String> {
    let root = crate::root();
    let below = ["crates", "lab"].into_iter().flat_map(|folder| {
        let entries = std::fs::read_dir(root.join(folder)).expect("the repository is readable");
        entries.map(move |e| (folder, e.expect("the repository is readable").file_name()))
    });
    let names = below.filter_map(|(folder, name)| Some(format!("{folder}/{}/Cargo.toml", name.to_str()?)));
    let files = names.filter(|name| root.join(name).exists());
    let texts = files.chain(["Cargo.toml".to_owned()]).map(|name| read(&name));
    let named = texts.filter_map(|text| Some((quoted(text.lines().find(|l| l.starts_with("name = "))?)?, text)));
    named.collect()
}

fn quoted(line: &str) -> Option<String> {
    Some(line.split('"').nth(1)?.to_owned())
}

/// Returns the names under `[dependencies]` of a manifest that need no feature.
fn dependencies(manifest: &str) -> BTreeSet<String> {
    let lines = manifest.lines().skip_while(|l| *l != "[dependencies]").skip(1);
    let keys = lines
        .take_while(|l| !l.starts_with('['))
        .filter(|l| l.contains('=') && !l.contains("optional = true"));
    let names = keys.filter_map(|l| l.split([' ', '.', '=']).next());
    names.filter(|n| !n.starts_with('#')).map(str::to_owned).collect()
}

/// Returns the packages of a lock file that come from no registry, each with its dependencies.
fn locked(lock: &str) -> BTreeMap<String, BTreeSet<String>> {
    let packages = lock.split("[[package]]").skip(1).filter(|p| !p.contains("\nsource = "));
    let named = packages.filter_map(|p| Some((quoted(p.lines().find(|l| l.starts_with("name = "))?)?, p)));
    let listed = |p: &str| -> BTreeSet<String> {
        let lines = p.lines().filter(|l| l.starts_with(" \""));
        let names = lines.filter_map(|l| quoted(l)?.split(' ').next().map(str::to_owned));
        names.collect()
    };
    named.map(|(name, p)| (name, listed(p))).collect()
}

#[test]
fn locks_hold_what_the_manifests_ask_for() {
    let manifests = manifests();
    for workspace in WORKSPACES {
        let packages = locked(&read(&format!("{workspace}/Cargo.lock")));
        assert!(packages.contains_key("lin-canny"), "{workspace}: {packages:?}");
        for (name, has) in &packages {
            // A workspace does not use packages below the folder of another workspace.
            let Some(manifest) = manifests.get(name) else {
                continue;
            };
            let asked = dependencies(manifest);
            let missing: Vec<_> = asked.difference(has).collect();
            assert!(missing.is_empty(), "{workspace}/Cargo.lock: {name} lacks {missing:?}");
        }
    }
}

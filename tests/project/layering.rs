//! Promise: the source respects its layers, and so do the packages of [`PACKAGES`]. The test reads
//! the source as text, and checks nothing that a compiler checks.
//!
//! `rustfmt` formats the source, so a function ends at the first closing brace at its indentation.

use std::path::PathBuf;

use truth::rows::rows;

/// Files with more lines are listed, including their tests.
const FILE: usize = 800;

/// Functions with more lines are listed.
const FUNCTION: usize = 100;

/// One source file.
struct Source {
    /// Path below the folder of the package, with `/`; of the library, without the top-level module
    /// of its layer.
    name: String,
    text: String,
}

impl Source {
    /// Returns the code with line numbers from 1, without comments, documentation and the tests at
    /// the end.
    fn code(&self) -> impl Iterator<Item = (usize, &str)> {
        let lines = self
            .text
            .lines()
            .take_while(|l| !matches!(l.trim(), "#[cfg(test)]" | "#![cfg(test)]"));
        let code = lines
            .enumerate()
            .map(|(k, l)| (k + 1, l.split("//").next().unwrap_or("")));
        code.filter(|(_, l)| !l.trim().is_empty())
    }

    fn is_in(&self, folder: &str) -> bool {
        self.name == format!("{folder}.rs") || self.name.starts_with(&format!("{folder}/"))
    }
}

fn sources() -> Vec<Source> {
    let all = below("src");
    assert!(all.len() > 30, "only {} files found", all.len());
    let of_layer = |s: Source| Source {
        name: layer_of(&s.name).to_owned(),
        ..s
    };
    all.into_iter().map(of_layer).collect()
}

/// Returns the sources of the library and of the planner.
fn with_planner() -> Vec<Source> {
    let planner = below("crates/plan/src").into_iter().map(|s| Source {
        name: format!("plan/{}", s.name),
        ..s
    });
    sources().into_iter().chain(planner).collect()
}

fn below(folder: &str) -> Vec<Source> {
    let root = crate::root().join(folder);
    let (mut folders, mut files) = (vec![root.clone()], Vec::<PathBuf>::new());
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("src is readable") {
            let path = entry.expect("src is readable").path();
            if path.is_dir() { &mut folders } else { &mut files }.push(path);
        }
    }
    let source = |path: &PathBuf| {
        let below = path.strip_prefix(&root).expect("below src");
        let name = below
            .components()
            .map(|c| c.as_os_str().to_string_lossy())
            .collect::<Vec<_>>()
            .join("/");
        Source {
            name,
            text: std::fs::read_to_string(path).expect("src is text"),
        }
    };
    let rust = files.iter().filter(|p| p.extension().is_some_and(|e| e == "rs"));
    rust.map(source).collect()
}

/// The top-level modules, lowest first, and the layers of those with several.
const MODULES: &[(&str, &str)] = &[
    ("base", "tolerance callbacks num pose motion"),
    ("body", "polyhedron shape"),
    ("pair", "soundness"),
    (
        "convex",
        "walk minimum exact solve depth contact replay tracker smooth shape_tracker",
    ),
    ("time", "separation impact schedule"),
    ("nonconvex", ""),
    ("surface", ""),
    ("half_space", ""),
    ("pair_tracker", "geometry"),
    ("point", "cover"),
    ("ray", ""),
    ("broad", ""),
    ("scene", ""),
];

/// Returns the path of a file or of a module, starting at its layer.
fn layer_of(path: &str) -> &str {
    let Some((module, rest)) = path.split_once('/') else {
        return path;
    };
    let layer = rest.split(['/', '.']).next().unwrap_or("");
    let stands = MODULES
        .iter()
        .any(|(name, layers)| *name == module && lists(layers, layer));
    if stands { rest } else { path }
}

/// Returns whether a word is one of a list with blanks between.
fn lists(words: &str, word: &str) -> bool {
    words.split_whitespace().any(|other| other == word)
}

/// Fails with the whole list if it is not empty.
fn none(what: &str, found: Vec<String>) {
    assert!(found.is_empty(), "{what}:\n  {}", found.join("\n  "));
}

/// Returns the lines of code in the selected files that contain one of the words.
fn holding(words: &[&str], pick: impl Fn(&Source) -> bool) -> Vec<String> {
    let mut found = Vec::new();
    for s in sources().iter().filter(|s| pick(s)) {
        for (k, line) in s.code().filter(|(_, l)| words.iter().any(|w| has_word(l, w))) {
            found.push(format!("{}:{k}: {}", s.name, line.trim()));
        }
    }
    found
}

/// Returns whether `word` is in the line, not as a part of a longer name.
fn has_word(line: &str, word: &str) -> bool {
    let of_name = |c: char| c.is_alphanumeric() || c == '_';
    line.match_indices(word).any(|(k, _)| {
        let (before, after) = (line[..k].chars().next_back(), line[k + word.len()..].chars().next());
        let (first, last) = (word.chars().next(), word.chars().next_back());
        let clear =
            |edge: Option<char>, beside: Option<char>| !edge.is_some_and(of_name) || !beside.is_some_and(of_name);
        clear(first, before) && clear(last, after)
    })
}

/// Prints files of more than 800 lines and functions of more than 100, and never fails.
///
/// `cargo test --test project -- --nocapture lengths` shows files that may contain two topics.
#[test]
fn lengths_are_listed() {
    for s in with_planner() {
        let lines: Vec<&str> = s.text.lines().collect();
        if lines.len() > FILE {
            println!("{}: {} lines", s.name, lines.len());
        }
        for (k, line) in lines.iter().enumerate() {
            let code = line.trim();
            if !has_word(line, "fn") || code.starts_with("//") || code.ends_with(['}', ';']) {
                continue;
            }
            let indent = &line[..line.len() - line.trim_start().len()];
            let is_end = |l: &&str| l.strip_prefix(indent) == Some("}");
            let length = lines[k..].iter().position(is_end).map_or(0, |end| end + 1);
            if length > FUNCTION {
                println!("{}:{}: {length} lines: {code}", s.name, k + 1);
            }
        }
    }
}

/// The modules of the crate that the code of a folder may use, lowest layer first. A file without a
/// row fails the test.
fn may_use() -> Vec<[String; 2]> {
    rows(include_str!("layers.txt"), "may use")
}

/// There are at most 13 top-level modules, and no layer is in a module above the modules that use
/// it.
#[test]
fn modules_are_in_order() {
    let root = crate::root().join("src");
    let entries = std::fs::read_dir(root)
        .expect("src is readable")
        .map(|e| e.expect("an entry").path());
    let mut folders: Vec<_> = entries
        .filter(|p| p.is_dir())
        .map(|p| p.file_name().map(|n| n.to_os_string()))
        .collect();
    let mut modules: Vec<_> = MODULES
        .iter()
        .map(|(name, _)| Some(std::ffi::OsString::from(name)))
        .collect();
    folders.sort();
    modules.sort();
    assert_eq!(folders, modules);
    assert!(MODULES.len() <= 13);
    let module_of = |layer: &str| {
        MODULES
            .iter()
            .position(|(name, layers)| *name == layer || lists(layers, layer))
    };
    let layers = may_use().into_iter().map(|[name, _]| name);
    let order: Vec<_> = layers
        .filter(|name| !["guide", "__proofs"].contains(&name.as_str()))
        .map(|name| module_of(&name).unwrap_or_else(|| panic!("`{name}` is in no module")))
        .collect();
    assert!(order.is_sorted(), "{order:?}");
}

/// Returns the layers in the first column of the table of ARCHITECTURE.md.
fn layers_listed() -> Vec<String> {
    let root = crate::root();
    let text = std::fs::read_to_string(root.join("ARCHITECTURE.md")).expect("ARCHITECTURE.md is text");
    let rows = text.lines().skip_while(|l| *l != "| layer | holds |").skip(2);
    let cells = rows
        .take_while(|l| l.starts_with("| "))
        .filter_map(|l| l.split('|').nth(1));
    cells
        .flat_map(|cell| {
            cell.split(',')
                .map(|name| name.trim().trim_matches('`').to_owned())
                .collect::<Vec<_>>()
        })
        .collect()
}

/// A layer uses only the layers before it, and ARCHITECTURE.md lists them in this order.
#[test]
fn layers_stand_in_order() {
    let layers = may_use();
    let names: Vec<&str> = layers.iter().map(|[name, _]| name.as_str()).collect();
    for (k, [name, uses]) in layers.iter().enumerate() {
        for layer in uses.split_whitespace() {
            let at = names.iter().position(|n| *n == layer);
            assert!(
                at.is_some_and(|at| at <= k),
                "`{name}` stands before `{layer}`, and uses it"
            );
        }
    }
    assert_eq!(layers_listed(), names);
}

#[test]
fn data_flows_one_way() {
    let mut found = Vec::new();
    let layers = may_use();
    for s in sources() {
        let is_module = |(module, layers): &(&str, &str)| !layers.is_empty() && s.name == format!("{module}/mod.rs");
        if s.name == "lib.rs"
            || MODULES
                .iter()
                .any(|r| is_module(r) && r.0 != "pair" && r.0 != "pair_tracker")
        {
            continue;
        }
        let Some([_, allowed]) = layers.iter().find(|[folder, _]| s.is_in(folder)) else {
            found.push(format!("{}: in no layer", s.name));
            continue;
        };
        for (k, line) in s.code() {
            for (at, _) in line.match_indices("crate::") {
                let rest = &line[at + "crate::".len()..];
                let of_path = |c: &char| c.is_alphanumeric() || *c == '_' || *c == ':';
                let path: String = rest.chars().take_while(of_path).collect::<String>().replace("::", "/");
                let module = layer_of(&path).split('/').next().unwrap_or("").to_owned();
                // Types named at the root are those of bodies and poses; a higher layer is never
                // one of them.
                let root = module.is_empty() || module.starts_with(char::is_uppercase);
                if root || !lists(allowed, &module) {
                    found.push(format!("{}:{k}: {}", s.name, line.trim()));
                }
            }
        }
    }
    none("a layer uses one above it", found);
}

/// The folders of packages around the library whose files `layers.txt` lists.
const PACKAGES: [&str; 6] = [
    "crates/formats/src",
    "crates/parry/src/bridge",
    "crates/plan/src",
    "crates/robot/src",
    "crates/clash/src",
    "crates/cli/src",
];

/// Files that declare the modules of a package.
const ROOTS: [&str; 3] = ["lib", "main", "mod"];

/// What the root of a package passes on from another package.
const PASSED_ON: [&str; 1] = ["parry"];

/// A file uses only the files before it in [`PACKAGES`].
#[test]
fn files_of_packages_stand_in_order() {
    let mut found = Vec::new();
    for root in PACKAGES {
        let lines = rows::<1>(include_str!("layers.txt"), root);
        let order = files_in_order(lines.as_flattened());
        let sources = below(root);
        let names: Vec<&str> = sources.iter().map(|s| s.name.trim_end_matches(".rs")).collect();
        let unknown = order.iter().filter(|file| !names.contains(&file.as_str()));
        found.extend(unknown.map(|file| format!("{root}/{file}.rs: does not exist")));
        for s in &sources {
            let name = s.name.trim_end_matches(".rs");
            let Some(place) = order.iter().position(|file| file == name) else {
                if !ROOTS.contains(&name) {
                    found.push(format!("{root}/{}: in no layer", s.name));
                }
                continue;
            };
            let code: Vec<(usize, &str)> = s.code().collect();
            for (k, path) in paths(&code) {
                let is_before = match used(name, &path, &names) {
                    Use::Foreign => true,
                    Use::Root(item) => PASSED_ON.contains(&item),
                    Use::File(file) => order[..=place].contains(&file),
                };
                if !is_before {
                    found.push(format!("{root}/{}:{k}: {}", s.name, path.join("::")));
                }
            }
        }
    }
    none("a file uses one above it, or the root of its package", found);
}

/// Returns the paths of the files that the lines of a package name, without `.rs`.
fn files_in_order(lines: &[String]) -> Vec<String> {
    let files = |line: &String| {
        let (folder, files) = line
            .split_once(": ")
            .map_or((String::new(), line.as_str()), |(folder, files)| {
                (format!("{folder}/"), files)
            });
        let each = files.split_whitespace().map(|file| format!("{folder}{file}"));
        each.collect::<Vec<_>>()
    };
    lines.iter().flat_map(files).collect()
}

/// What a path of a file uses.
#[derive(Debug, PartialEq)]
enum Use<'a> {
    /// Something that is not in the package, or is in the file itself.
    Foreign,
    /// An item of the root of the package.
    Root(&'a str),
    File(String),
}

/// Returns what a path uses in a file of a package with these files.
fn used<'a>(file: &str, path: &[&'a str], files: &[&str]) -> Use<'a> {
    let mut module: Vec<&str> = file.split('/').collect();
    module.pop_if(|name| ROOTS.contains(name));
    let file_of = |module: &[&str]| {
        let name = module.join("/");
        let names = [format!("{name}/mod"), name];
        names.into_iter().find(|name| files.contains(&name.as_str()))
    };
    let mut rest = path;
    match path[0] {
        "crate" => (module, rest) = (Vec::new(), &path[1..]),
        "self" | "super" => {
            while let Some((first @ ("self" | "super"), after)) = rest.split_first().map(|(f, a)| (*f, a)) {
                if first == "super" && module.pop().is_none() {
                    return Use::Root("super");
                }
                rest = after;
            }
        }
        // A module that the file declares, or something of another package.
        name if file_of(&[&module[..], &[name]].concat()).is_none() => return Use::Foreign,
        _ => {}
    }
    while let Some((name, after)) = rest.split_first() {
        module.push(*name);
        if file_of(&module).is_none() {
            module.pop();
            break;
        }
        rest = after;
    }
    match file_of(&module) {
        Some(other) if other == file => Use::Foreign,
        Some(other) => Use::File(other),
        None => Use::Root(rest.first().copied().unwrap_or_default()),
    }
}

/// Returns all paths in lines of code, `a::{b, c::d}` as `a::b` and `a::c::d`, with their lines.
fn paths<'a>(code: &[(usize, &'a str)]) -> Vec<(usize, Vec<&'a str>)> {
    let mut words: Vec<(usize, &str)> = Vec::new();
    for (k, line) in code {
        let mut rest = line.trim_start();
        while let Some(first) = rest.chars().next() {
            let of_name = |c: char| c.is_alphanumeric() || c == '_';
            let end = match rest.find(|c| !of_name(c)).unwrap_or(rest.len()) {
                0 if rest.starts_with("::") => 2,
                0 => first.len_utf8(),
                end => end,
            };
            words.push((*k, &rest[..end]));
            rest = rest[end..].trim_start();
        }
    }
    let (mut found, mut at) = (Vec::new(), 0);
    while at < words.len() {
        let is_path = is_name(&words, at) && words.get(at + 1).is_some_and(|(_, word)| *word == "::");
        let is_start = at == 0 || words[at - 1].1 != "::";
        at = if is_path && is_start {
            read_path(&words, at, Vec::new(), &mut found)
        } else {
            at + 1
        };
    }
    found
}

fn is_name(words: &[(usize, &str)], at: usize) -> bool {
    let of_name = |c: char| c.is_alphabetic() || c == '_';
    words.get(at).is_some_and(|(_, word)| word.starts_with(of_name))
}

/// Adds the paths that start with `path` and go on at a word. Returns where the next word is.
fn read_path<'a>(
    words: &[(usize, &'a str)],
    mut at: usize,
    mut path: Vec<&'a str>,
    found: &mut Vec<(usize, Vec<&'a str>)>,
) -> usize {
    let is = |at: usize, word: &str| words.get(at).is_some_and(|(_, other)| *other == word);
    while is_name(words, at) {
        path.push(words[at].1);
        at += 1;
        if !(is(at, "::") && (is(at + 1, "{") || is_name(words, at + 1))) {
            found.push((words[at - 1].0, path));
            return at;
        }
        at += 1;
    }
    at += 1;
    while at < words.len() && !is(at, "}") {
        at = match is_name(words, at) {
            true if is(at, "as") => at + 2,
            true => read_path(words, at, path.clone(), found),
            false => at + 1,
        };
    }
    at + 1
}

#[test]
fn uses_of_files_are_read() {
    let code = [
        (1, "use crate::{text, mesh::{self, MeshFile as File}};"),
        (2, "let x = super::json::Item::<f64>::new(buffer::chunks(y));"),
        (3, "use super::super::{Reader, other::*};"),
    ];
    let names = [
        "lib",
        "text",
        "mesh",
        "other",
        "gltf/mod",
        "gltf/json",
        "gltf/buffer",
        "gltf/mesh",
    ];
    let uses = |file: &str| -> Vec<(usize, String)> {
        let each = paths(&code)
            .into_iter()
            .map(|(k, path)| match used(file, &path, &names) {
                Use::Foreign => (k, "-".to_owned()),
                Use::Root(item) => (k, format!("root {item}")),
                Use::File(file) => (k, file),
            });
        each.collect()
    };
    let told = |list: &[(usize, &str)]| -> Vec<(usize, String)> {
        list.iter().map(|(k, text)| (*k, (*text).to_owned())).collect()
    };
    let common = [(1, "text"), (1, "mesh"), (1, "mesh")];
    let of_mesh = [(2, "gltf/json"), (2, "-"), (3, "root Reader"), (3, "other")];
    assert_eq!(uses("gltf/mesh"), told(&[&common[..], &of_mesh].concat()));
    // The parent of a `mod.rs` is the root, and a folder above that is outside.
    let of_mod = [
        (2, "root json"),
        (2, "gltf/buffer"),
        (3, "root super"),
        (3, "root super"),
    ];
    assert_eq!(uses("gltf/mod"), told(&[&common[..], &of_mod].concat()));
    let lines = ["error text", "gltf: json mod", "load"].map(String::from);
    let found = files_in_order(&lines);
    assert_eq!(found, ["error", "text", "gltf/json", "gltf/mod", "load"]);
}

#[test]
fn topology_knows_no_place() {
    let words = ["f64", "f32", "Vector3", "Point3", "nalgebra"];
    none(
        "floats in the topology",
        holding(&words, |s| s.name == "polyhedron/topology.rs"),
    );
}

/// The walk, its solvers and manifolds allocate nothing, except for exact integers.
#[test]
fn queries_allocate_nothing_and_call_no_trait_object() {
    let folders = ["pair", "walk", "minimum", "solve", "contact"];
    let outside = |s: &Source| folders.iter().any(|f| s.is_in(f)) && !s.is_in("solve/mutation");
    none(
        "allocation in the walk",
        holding(&["dyn", "Vec", "Box", "String", "alloc", "vec!", "format!"], outside),
    );
}

#[test]
fn nothing_keeps_state_behind_the_caller() {
    let words = [
        "static mut",
        "thread_local!",
        "Cell",
        "RefCell",
        "OnceCell",
        "OnceLock",
        "Mutex",
        "RwLock",
        "LazyLock",
    ];
    none("hidden state", holding(&words, |_| true));
    let atomics = ["AtomicBool", "AtomicUsize", "AtomicU32", "AtomicU64", "static"];
    none(
        "hidden state",
        holding(&atomics, |_| true)
            .into_iter()
            .filter(|l| !l.contains("'static"))
            .collect(),
    );
}

#[test]
fn foreign_mathematics_stays_outside() {
    let words = ["parry", "parry3d", "parry3d_f64", "rapier", "rapier3d", "glam", "glamx"];
    none("types of other engines", holding(&words, |s| !s.is_in("interop")));
}

/// Numbers such as `1e-9` and `1.000_01` occur only in the file of tolerances: every small number
/// is a formula in machine epsilon.
#[test]
fn tolerances_are_in_one_file() {
    let mut found = Vec::new();
    for s in with_planner().iter().filter(|s| s.name != "tolerance.rs") {
        found.extend(
            s.code()
                .filter(|(_, l)| holds_tolerance(l))
                .map(|(k, l)| format!("{}:{k}: {}", s.name, l.trim())),
        );
    }
    none("tolerances outside tolerance.rs", found);
}

/// Returns whether a line of code contains a small number, or a number next to one.
fn holds_tolerance(line: &str) -> bool {
    let code: String = line.split('"').step_by(2).collect(); // without the texts of messages
    let small = code.match_indices("e-").any(|(k, _)| {
        let before = code[..k]
            .chars()
            .next_back()
            .is_some_and(|c| c.is_ascii_digit() || c == '.');
        before && code[k + 2..].chars().next().is_some_and(|c| c.is_ascii_digit())
    });
    let next_to_one = code
        .split(|c: char| !c.is_ascii_digit() && c != '_' && c != '.')
        .any(|number| {
            let number = number.replace('_', "");
            let is_more = |rest: &str| rest.chars().any(|c| ('1'..='9').contains(&c));
            number.strip_prefix("1.000").is_some_and(is_more) || number.starts_with("0.999")
        });
    small || next_to_one
}

#[test]
fn small_numbers_are_recognised() {
    for line in ["x * 1.000_01", "x < 1e-9", "0.999_9 * x", "x + 2.5e-3", "(1.0001f32)"] {
        assert!(holds_tolerance(line), "{line}");
    }
    for line in [
        "x * 1.0",
        "1.000",
        "21.000_1",
        "\"1.000_1\"",
        "e - 2",
        "0.99",
        "let e = 1.0_f64;",
    ] {
        assert!(!holds_tolerance(line), "{line}");
    }
}

/// Columns of a line with only a comment. Rows of tables cannot be wrapped.
const COMMENT: usize = 100;

#[test]
fn comments_are_wrapped() {
    let (mut found, mut count) = (Vec::new(), 0);
    let is_wrapped = |line: &str| line.trim_start().starts_with("//") && !line.trim_start().starts_with("//! |");
    for s in sources() {
        for (k, line) in s.text.lines().enumerate().filter(|(_, l)| is_wrapped(l)) {
            count += 1;
            if line.chars().count() > COMMENT {
                found.push(format!("{}:{}: {} columns", s.name, k + 1, line.chars().count()));
            }
        }
    }
    assert!(count > 5000, "only {count} comment lines found");
    none("comments of more than 100 columns", found);
}

//! Both checkers on one text.

use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};

use lin_canny_verify::{Verdict, verify, verify_on};

/// Runs all cases in one process, as the start of Python costs more than most checks.
const ALL: &str = "import sys, io; sys.path.insert(0, sys.argv[1]); import verify
for case in sys.argv[2:]:
    sys.stdout, out = io.StringIO(), sys.stdout
    code = verify.main(case.split('+'))
    text, sys.stdout = sys.stdout.getvalue(), out
    print(code, text.encode().hex())";

/// The exit code of the Python checker for each case: a receipt, and another scene or nothing.
///
/// What it prints about a receipt that can be read is what the checker in Rust prints.
pub(crate) fn codes(cases: &[(String, Option<String>)]) -> Option<Vec<i32>> {
    let scripts = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../verify"));
    if !scripts.join("verify.py").exists() || Command::new("python3").arg("--version").output().is_err() {
        println!("skipped: no python3, or not a checkout");
        return None;
    }
    // Tests of one process run at the same time.
    static CALLS: AtomicUsize = AtomicUsize::new(0);
    let call = CALLS.fetch_add(1, Ordering::Relaxed);
    let folder = std::env::temp_dir().join(format!("lin-canny-verify-{}-{call}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let file = |name: String, text: &str| {
        let path = folder.join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let name = |(k, (receipt, other)): (usize, &(String, Option<String>))| {
        let receipt = file(format!("{k}-receipt"), receipt);
        let other = other
            .as_ref()
            .map(|text| "+".to_owned() + &file(format!("{k}-scene"), text));
        receipt + &other.unwrap_or_default()
    };
    let names: Vec<_> = cases.iter().enumerate().map(name).collect();
    let output = Command::new("python3")
        .args(["-B", "-c", ALL])
        .arg(scripts)
        .args(&names)
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(errors.is_empty(), "{errors}");
    // The program itself, once.
    let status = Command::new("python3")
        .arg(scripts.join("verify.py"))
        .args(names[0].split('+'))
        .output()
        .unwrap()
        .status;
    std::fs::remove_dir_all(&folder).unwrap();
    let mut all = Vec::new();
    for (line, (receipt, other)) in String::from_utf8(output.stdout).unwrap().lines().zip(cases) {
        let (code, hex) = line.split_once(' ').unwrap();
        let bytes = hex.as_bytes().chunks(2).map(|pair| std::str::from_utf8(pair).unwrap());
        let bytes = bytes.map(|pair| u8::from_str_radix(pair, 16).unwrap()).collect();
        let (text, ours) = (String::from_utf8(bytes).unwrap(), answer(receipt, other.as_deref()));
        all.push(code.parse().unwrap());
        // On another scene the lines that fail after the first are not counted alike.
        let first = |text: &str| match (other, text.split_once(" (line")) {
            (Some(_), Some((first, _))) => first.to_owned(),
            _ => text.trim_end().to_owned(),
        };
        let is_same = first(&text) == first(&ours.1);
        assert!(code == "3" || is_same, "{text}\n{}\n{receipt}", ours.1);
    }
    assert_eq!((all.len(), status.code()), (cases.len(), Some(all[0])));
    Some(all)
}

pub(crate) fn code(receipt: &str, other: Option<&str>) -> i32 {
    answer(receipt, other).0
}

/// The exit code of the checker in Rust, and what it prints.
pub(crate) fn answer(receipt: &str, other: Option<&str>) -> (i32, String) {
    let found = match other {
        Some(other) => verify_on(receipt.as_bytes(), other.as_bytes()),
        None => verify(receipt.as_bytes()),
    };
    match found {
        Ok(found) => (i32::from(!matches!(found, Verdict::Holds(_))), found.to_string()),
        Err(error) => (3, error.to_string()),
    }
}

/// What the Python checker prints about a receipt, or about a receipt on another scene.
pub(crate) fn printed(texts: &[&str]) -> Option<String> {
    let script = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../verify/verify.py"));
    let mut command = Command::new("python3");
    command.arg("-B").arg(script);
    let file = |(k, text): (usize, &&str)| {
        let path = std::env::temp_dir().join(format!("lin-canny-verify-{}-{k}-printed", std::process::id()));
        std::fs::write(&path, text).unwrap();
        path
    };
    let files: Vec<_> = texts.iter().enumerate().map(file).collect();
    let output = command.args(&files).output();
    files.iter().for_each(|path| std::fs::remove_file(path).unwrap());
    let output = output.ok().filter(|_| script.exists())?;
    Some(String::from_utf8(output.stdout).unwrap())
}

//! Both checkers on one text.

use std::cell::RefCell;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};

use lin_canny_verify::{Verdict, verify, verify_on};

/// Reads one case after the other, as the start of Python costs more than most checks.
const CASES: &str = "import sys, io; sys.path.insert(0, sys.argv[1]); import verify
for case in sys.stdin:
    sys.stdout, out = io.StringIO(), sys.stdout
    code = verify.main(case.rstrip('\\n').split('+'))
    text, sys.stdout = sys.stdout.getvalue(), out
    print(code, text.encode().hex(), flush=True)";

/// A process of the checker in Python, and a folder for its files.
struct Process {
    child: Child,
    answers: BufReader<ChildStdout>,
    folder: PathBuf,
}

thread_local! {
    static PROCESS: RefCell<Option<Process>> = RefCell::new(Process::start());
}

fn scripts() -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../verify")).to_path_buf()
}

impl Process {
    fn start() -> Option<Self> {
        if !scripts().join("verify.py").exists() || Command::new("python3").arg("--version").output().is_err() {
            println!("skipped: no python3, or not a checkout");
            return None;
        }
        // Tests of one process run at the same time.
        static CALLS: AtomicUsize = AtomicUsize::new(0);
        let call = CALLS.fetch_add(1, Ordering::Relaxed);
        let folder = std::env::temp_dir().join(format!("lin-canny-verify-{}-{call}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let mut command = Command::new("python3");
        command.args(["-B", "-c", CASES]).arg(scripts());
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let answers = BufReader::new(child.stdout.take().unwrap());
        Some(Self { child, answers, folder })
    }

    /// Writes the files of a case; returns their names.
    fn files(&self, receipt: &str, other: Option<&str>) -> Vec<String> {
        let texts = [Some(receipt), other].into_iter().flatten();
        let file = |(name, text): (&str, &str)| {
            let path = self.folder.join(name);
            std::fs::write(&path, text).unwrap();
            path.to_str().unwrap().to_owned()
        };
        ["receipt", "scene"].into_iter().zip(texts).map(file).collect()
    }

    /// The exit code, and what is printed.
    fn answer(&mut self, receipt: &str, other: Option<&str>) -> (i32, String) {
        let names = self.files(receipt, other);
        writeln!(self.child.stdin.as_mut().unwrap(), "{}", names.join("+")).unwrap();
        let mut line = String::new();
        self.answers.read_line(&mut line).unwrap();
        let (code, hex) = line
            .trim_end()
            .split_once(' ')
            .unwrap_or_else(|| panic!("no answer from Python about\n{receipt}"));
        let bytes = hex.as_bytes().chunks(2).map(|pair| std::str::from_utf8(pair).unwrap());
        let bytes = bytes.map(|pair| u8::from_str_radix(pair, 16).unwrap()).collect();
        (code.parse().unwrap(), String::from_utf8(bytes).unwrap())
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // Without input it ends.
        drop(self.child.stdin.take());
        let _ = self.child.wait();
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

/// The exit code of the checker in Python; `None` without Python.
///
/// What it prints about a receipt that can be read is what the checker in Rust prints.
fn code_in_python(receipt: &str, other: Option<&str>) -> Option<i32> {
    let found = PROCESS.with_borrow_mut(|process| process.as_mut().map(|process| process.answer(receipt, other)));
    let ((code, text), ours) = (found?, answer(receipt, other));
    // On another scene the lines that fail after the first are not counted alike.
    let first = |text: &str| match (other, text.split_once(" (line")) {
        (Some(_), Some((first, _))) => first.to_owned(),
        _ => text.trim_end().to_owned(),
    };
    let is_same = first(&text) == first(&ours.1);
    assert!(code == 3 || is_same, "{text}\n{}\n{receipt}", ours.1);
    Some(code)
}

/// The exit code of the checker in Python for each case: a receipt, and another scene or nothing.
pub(crate) fn codes(cases: &[(String, Option<String>)]) -> Option<Vec<i32>> {
    let all = cases
        .iter()
        .map(|(receipt, other)| code_in_python(receipt, other.as_deref()));
    let all = all.collect::<Option<Vec<_>>>()?;
    // The program itself, once.
    let names = PROCESS.with_borrow(|process| Some(process.as_ref()?.files(&cases[0].0, cases[0].1.as_deref())))?;
    let status = Command::new("python3")
        .arg("-B")
        .arg(scripts().join("verify.py"))
        .args(names)
        .output()
        .unwrap()
        .status;
    assert_eq!(status.code(), Some(all[0]));
    Some(all)
}

/// The exit code of both checkers, and what they print.
pub(crate) fn judged(receipt: &str) -> (i32, String) {
    let (code, said) = answer(receipt, None);
    assert_eq!(code_in_python(receipt, None).unwrap_or(code), code, "{said}\n{receipt}");
    (code, said)
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

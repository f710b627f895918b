//! Promise: the program prints the answer of the package, and its exit code is that of `verify.py`.

mod support;

use std::ffi::OsStr;
use std::process::Command;

use support::python::answer;
use support::*;

fn program(arguments: &[&OsStr]) -> (Option<i32>, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_lin-canny-verify"))
        .args(arguments)
        .output()
        .expect("the program runs");
    (output.status.code(), String::from_utf8(output.stdout).expect("a text"))
}

#[test]
fn the_program_gives_the_answer_of_the_package() {
    let mut rng = Rng(5);
    let receipt = arm(&mut rng, 0.01, 2, 1).text();
    let folder = std::env::temp_dir().join(format!("lin-canny-verify-{}-program", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let file = |name: &str, text: &str| {
        let path = folder.join(name);
        std::fs::write(&path, text).expect("a file");
        path
    };
    let good = file("good", &receipt);
    for (text, code) in [
        (receipt.clone(), 0),
        (receipt.replacen("\"name\":\"", "\"name\":\"x", 1), 1),
        (receipt.replacen("\"receipt\":1", "\"receipt\":2", 1), 3),
        (String::new(), 3),
    ] {
        let (expected, said) = answer(&text, None);
        let (found, printed) = program(&[file("receipt", &text).as_ref()]);
        assert_eq!((expected, found), (code, Some(code)), "{printed}");
        assert_eq!(printed.trim_end(), said.trim_end());
    }
    let (expected, said) = answer(&receipt, Some(&receipt));
    let (found, printed) = program(&[good.as_ref(), good.as_ref()]);
    assert_eq!((Some(expected), &*said), (found, &*printed));
    let (found, printed) = program(&["--all".as_ref(), good.as_ref()]);
    assert!(
        found == Some(0) && printed.lines().count() > said.lines().count(),
        "{printed}"
    );
    for wrong in [&[][..], &["--any".as_ref()], &[folder.join("none").as_ref()]] {
        assert_eq!(program(wrong).0, Some(3));
    }
    assert!(program(&["--version".as_ref()]).1.contains(env!("CARGO_PKG_VERSION")));
    std::fs::remove_dir_all(&folder).expect("a folder");
}

//! A scheduler and executors as processes of this machine.

use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::{said, scratch, tool};

/// A process that ends with the test.
struct Process(Child);

impl Process {
    fn start(command: &mut Command, log: &Path) -> Self {
        let file = std::fs::File::create(log).expect("a log");
        let errors = file.try_clone().expect("a log");
        let started = command.stdin(Stdio::null()).stdout(file).stderr(errors).spawn();
        Self(started.expect("a process"))
    }

    fn kill(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.kill();
    }
}

/// A port of which the next is free too.
fn port() -> u16 {
    loop {
        let first = TcpListener::bind("127.0.0.1:0").expect("a port");
        let port = first.local_addr().expect("an address").port();
        if port < u16::MAX && TcpListener::bind(("127.0.0.1", port + 1)).is_ok() {
            return port;
        }
    }
}

/// Waits until something listens at a port.
fn wait_for(port: u16) {
    let began = Instant::now();
    while std::net::TcpStream::connect(("127.0.0.1", port)).is_err() {
        assert!(began.elapsed() < Duration::from_secs(60), "nothing listens at {port}");
        std::thread::sleep(Duration::from_millis(50));
    }
}

fn executor(folder: &Path, scheduler: &str, name: &str) -> Process {
    let port = port();
    let mut command = tool("executor");
    command.args([
        "--scheduler",
        scheduler,
        "--cores",
        "1",
        "--port",
        &port.to_string(),
        "--work",
    ]);
    command.arg(folder.join(name));
    let process = Process::start(&mut command, &folder.join(format!("{name}.log")));
    wait_for(port);
    process
}

fn parts(folder: &Path) -> Vec<Vec<u8>> {
    let part = |k: usize| std::fs::read(folder.join(format!("part-{k:05}.parquet"))).expect("a part");
    vec![part(0), part(1)]
}

/// Rows of each of two files: enough that a study takes seconds of CPU time.
const ROWS: u32 = if cfg!(debug_assertions) { 2_000 } else { 120_000 };

#[test]
fn a_cluster_answers_bit_for_bit_and_survives_a_kill() {
    let folder = scratch("cluster");
    let at = |name: &str| folder.join(name).to_string_lossy().into_owned();
    let (all, half) = ((2 * ROWS).to_string(), ROWS.to_string());
    let sample = ["--rows", &all, "--rows-per-file", &half, "--out", &at("q")];
    assert_eq!(said(tool("sample").args(sample)).0, 0);
    // One thread of one process: the same parts.
    let alone = [
        "--in",
        &at("q"),
        "--out",
        &at("alone"),
        "--partitions",
        "1",
        "--rows-per-part",
        &half,
    ];
    let (code, text) = said(tool("run").args(alone));
    assert_eq!(code, 0, "{text}");
    let expected = parts(&folder.join("alone"));

    let port = port();
    let scheduler = format!("127.0.0.1:{port}");
    let mut command = tool("scheduler");
    command.args(["--port", &port.to_string(), "--executor-timeout", "6"]);
    let _scheduler = Process::start(&mut command, &folder.join("scheduler.log"));
    wait_for(port);
    let _first = executor(&folder, &scheduler, "first");
    let run = |out: &str| {
        let mut command = tool("run");
        command.args([
            "--in",
            &at("q"),
            "--out",
            &at(out),
            "--scheduler",
            &scheduler,
            "--partitions",
            "8",
        ]);
        command
    };
    let (code, text) = said(&mut run("one"));
    assert_eq!(code, 0, "{text}");
    assert!(parts(&folder.join("one")) == expected, "one executor");

    let mut second = executor(&folder, &scheduler, "second");
    let (code, text) = said(&mut run("two"));
    assert_eq!(code, 0, "{text}");
    assert!(parts(&folder.join("two")) == expected, "two executors");

    // Cells of an audit are rows like others.
    let (code, text) = said(tool("cells").args(["--cells", "2", "--out", &at("cells")]));
    assert_eq!(code, 0, "{text}");
    let proofs = |out: &str| {
        let mut command = tool("run");
        command.args(["--in", &at("cells"), "--out", &at(out), "--partitions", "4"]);
        command.args(["--select", "prove_pair(a, b, low, high, 4) AS proof"]);
        command
    };
    let (code, text) = said(&mut proofs("proofs"));
    assert_eq!(code, 0, "{text}");
    let (code, text) = said(proofs("proofs of a cluster").args(["--scheduler", &scheduler]));
    assert_eq!(code, 0, "{text}");
    let part = |out: &str| std::fs::read(folder.join(out).join("part-00000.parquet")).expect("a part");
    assert!(part("proofs") == part("proofs of a cluster"), "cells of an audit");

    let mut client = run("killed")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("a client");
    std::thread::sleep(Duration::from_millis(1200));
    assert!(
        client.try_wait().expect("a state").is_none(),
        "the study ended before the kill"
    );
    second.kill();
    assert!(client.wait().expect("an end").success(), "after the kill");
    assert!(parts(&folder.join("killed")) == expected, "after the kill");

    // Another option is another study: the scheduler does not know its functions.
    let other = [
        "--in",
        &at("q"),
        "--out",
        &at("other"),
        "--scheduler",
        &scheduler,
        "--margin",
        "0.1",
    ];
    let (code, text) = said(tool("run").args(other));
    assert!(
        code == 3 && text.contains("another robot, cell or option"),
        "{code} {text}"
    );
}

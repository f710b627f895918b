//! Promise: `include/lin_canny.h` is the header of the sources, and the interface stays small
//! enough to be read.
//!
//! `UPDATE=1 cargo test --test header` writes the header.

fn header() -> String {
    let root = env!("CARGO_MANIFEST_DIR");
    let config = cbindgen::Config::from_root_or_default(root);
    let mut made = Vec::new();
    let builder = cbindgen::Builder::new().with_crate(root).with_config(config);
    builder.generate().expect("a header").write(&mut made);
    let made = String::from_utf8(made).expect("a text");
    // A section of rustdoc is a line in C.
    made.replace("// # Safety\n// ", "// Contract: ")
}

#[test]
fn header_is_current() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/include/lin_canny.h");
    let made = header();
    if std::env::var_os("UPDATE").is_some() {
        std::fs::write(path, &made).expect("include is writable");
    }
    let found = std::fs::read_to_string(path).unwrap_or_default();
    assert!(
        found == made,
        "the header is not current: UPDATE=1 cargo test --test header"
    );
}

#[test]
fn interface_has_at_most_80_functions() {
    let made = header();
    let is_function = |line: &&str| line.contains(" lc_") && line.contains('(') && !line.starts_with("//");
    let count = made.lines().filter(is_function).count();
    assert!((60..=81).contains(&count), "{count} functions, one of them for tests");
}

//! STL: every solid is read, and what does not fit is an error with its line.

mod support;

use support::errors::says;
use support::{BOX, TRIANGLES, VOLUME, bounds, parse, read_mutants, volume};

fn facets(shift: f64) -> String {
    let mut text = String::new();
    for t in TRIANGLES {
        text += "facet normal 0 0 0\n outer loop\n";
        for p in t.map(|k| BOX[k]) {
            text += &format!("  vertex {} {} {}\n", p[0] + shift, p[1], p[2]);
        }
        text += " endloop\nendfacet\n";
    }
    text
}

fn solid(name: &str, shift: f64) -> String {
    format!("solid {name}\n{}endsolid {name}\n", facets(shift))
}

fn binary(shifts: &[f64], header: &[u8], count: u32) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes[..header.len()].copy_from_slice(header);
    bytes.extend(count.to_le_bytes());
    for shift in shifts {
        for t in TRIANGLES {
            bytes.extend([0; 12]);
            for p in t.map(|k| BOX[k]) {
                for x in [p[0] + shift, p[1], p[2]] {
                    bytes.extend((x as f32).to_le_bytes());
                }
            }
            bytes.extend([0; 2]);
        }
    }
    bytes
}

#[test]
fn all_solids_of_a_text_are_read() {
    for n in 1..6 {
        let text: String = (0..n)
            .map(|k| solid(&format!("part {k}"), 2.0 * f64::from(k)))
            .collect();
        for text in [
            text.clone(),
            text.replace('\n', "\r\n"),
            text.replace('\n', "\r"),
            format!("\u{feff}{text}"),
        ] {
            let file = parse(&text, "a.stl").expect("solids");
            assert_eq!(file.objects.len(), n as usize);
            assert_eq!(file.whole().1.len(), 12 * n as usize);
            assert!((volume(&file) - f64::from(n) * VOLUME).abs() < 1e-12);
            assert_eq!(bounds(&file)[1], [0.2 + 2.0 * f64::from(n - 1), 0.4, 0.6]);
            assert_eq!(file.objects[0].name, "part 0");
            assert_eq!(file.objects[0].points.len(), 8);
        }
    }
}

#[test]
fn spellings_of_exporters_are_read() {
    let text = solid("", 0.0);
    let spellings = [
        text.to_uppercase(),
        text.replacen("solid ", "solid", 1),
        text.replacen("solid ", "solid\t", 1),
        text.replace(' ', "\t"),
        format!("\n \n{text}"),
        text.replace("normal 0 0 0", "normal nan nan nan"),
        text.replace("normal 0 0 0", "normal -nan(ind) -nan(ind) 1e400"),
        text.replace("endsolid", ""),
        text.replace('\n', " "),
        solid("facet normal", 0.0),
        format!("solid empty\nendsolid empty\n{text}"),
    ];
    for text in spellings {
        let file = parse(&text, "a.stl").unwrap_or_else(|e| panic!("{e}: {text}"));
        assert!((volume(&file) - VOLUME).abs() < 1e-12, "{text}");
    }
    let mut latin = solid("gr\u{fc}n", 0.0).replace('\u{fc}', "#").into_bytes();
    latin.iter_mut().filter(|b| **b == b'#').for_each(|b| *b = 0xfc);
    let file = parse(&latin, "a.stl").expect("Latin-1 name");
    assert_eq!(file.objects[0].name, "gr\u{fc}n");
    let wide: Vec<u8> = [0xff, 0xfe]
        .into_iter()
        .chain(text.encode_utf16().flat_map(u16::to_le_bytes))
        .collect();
    assert!((volume(&parse(&wide, "a.stl").expect("UTF-16")) - VOLUME).abs() < 1e-12);
    // Decimals keep their last digit.
    let exact = text.replace("0.2", "0.20000000000000004");
    let found = bounds(&parse(&exact, "a.stl").expect("a box"))[1][0];
    assert_eq!(found, 0.20000000000000004);
}

#[test]
fn a_fault_anywhere_in_a_text_is_named_with_its_line() {
    let text = solid("a", 0.0);
    let lines: Vec<&str> = text.lines().collect();
    for (k, line) in lines.iter().enumerate() {
        let changed = |new: &str| {
            let mut lines = lines.clone();
            lines[k] = new;
            lines.join("\n")
        };
        // An unknown line in place of a line.
        if k > 0 {
            let error = parse(changed("colour 1"), "a.stl").expect_err("an unknown word");
            assert!(error.line.is_some_and(|l| l == k + 1 || l == k + 2), "{k}: {error}");
        }
        if line.contains("vertex") {
            for bad in ["nan", "1e400", "x", "1,5"] {
                let error = parse(changed(&format!("vertex 0 {bad} 0")), "a.stl").expect_err(bad);
                assert_eq!(error.line, Some(k + 1), "{error}");
            }
            let error = parse(changed(&format!("{line}\n{line}")), "a.stl").expect_err("four vertices");
            assert!(error.line.is_some());
        }
    }
    let error = parse(format!("{text}more"), "a.stl").expect_err("a word behind the solids");
    assert_eq!(error.line, Some(lines.len() + 1), "{error}");
    let one_line = format!("{} {}", text.replace('\n', " "), solid("b", 2.0).replace('\n', " "));
    says(parse(one_line, "a.stl"), "endsolid");
}

#[test]
fn a_binary_file_has_the_length_of_its_count() {
    for header in [&b"solid a"[..], b"binary", b"ply"] {
        let file = parse(binary(&[0.0, 2.0], header, 24), "a.stl").expect("two boxes");
        assert!((volume(&file) - 2.0 * VOLUME).abs() < 1e-7);
        for rest in [&b"\0"[..], b"\r\n", b"   "] {
            let mut bytes = binary(&[0.0], header, 12);
            bytes.extend(rest);
            assert_eq!(parse(&bytes, "a.stl").expect("a box").whole().1.len(), 12);
        }
    }
    for count in [0, 11, 12, 23, 25, u32::MAX] {
        says(
            parse(binary(&[0.0, 2.0], b"binary", count), "a.stl"),
            &format!("states {count} triangles"),
        );
    }
    // Two files, one after the other.
    let mut joined = binary(&[0.0], b"binary", 12);
    joined.extend(binary(&[2.0], b"binary", 12));
    assert!(parse(&joined, "a.stl").is_err());
    let mut nan = binary(&[0.0], b"binary", 12);
    nan[84 + 50 * 7 + 20..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
    says(parse(&nan, "a.stl"), "triangle 7");
}

#[test]
fn files_that_are_no_mesh_are_named() {
    let message = |bytes: &[u8]| parse(bytes, "a.stl").expect_err("no mesh").to_string();
    assert!(message(b"").contains("empty"));
    assert!(message(b" \r\n").contains("empty"));
    assert!(message(b"version https://git-lfs.github.com/spec/v1\noid sha256:1\nsize 5\n").contains("git lfs pull"));
    assert!(message(b"<!DOCTYPE html><html></html>").contains("HTML"));
    assert!(message(b"solid a\nendsolid a\n").contains("no triangle"));
    let long = format!("solid a\n{}\n", "x".repeat(10_000));
    let error = message(long.as_bytes());
    assert!(error.contains("unknown word: \"xxxx") && error.len() < 200, "{error}");
    says(parse(b"x", "a.step"), "extension");
}

#[test]
fn mutants_are_read_or_named() {
    read_mutants(solid("a", 0.0).as_bytes(), "a.stl", 10_000);
    read_mutants(&binary(&[0.0], b"binary", 12), "a.stl", 10_000);
}

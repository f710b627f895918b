//! Volumes: what is written is read again bit for bit by independent readers.

use std::path::PathBuf;

use lin_canny_formats::{FormatFault, Volume};

fn scratch(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// Numbers of every size, both zeros and the ends of `f64` among them.
fn numbers(count: usize) -> Vec<f64> {
    let hard = [
        0.0,
        -0.0,
        f64::MAX,
        f64::MIN_POSITIVE,
        5e-324,
        -1e-100,
        0.1,
        f64::EPSILON,
    ];
    let other = |k: usize| (k as f64 - 11.0) / 7.0 * 10f64.powi(k as i32 % 201 - 100);
    (0..count).map(|k| hard.get(k).copied().unwrap_or(other(k))).collect()
}

/// Returns the header of a file as text, and its numbers.
fn read(name: &str, volume: &Volume<'_>, end: &str) -> (String, Vec<u64>) {
    let file = scratch(name);
    volume.write(&file).expect("a file");
    let bytes = std::fs::read(&file).expect("a file");
    let starts_at = |k: &usize| bytes[*k..].starts_with(end.as_bytes());
    let at = (0..bytes.len()).find(starts_at).expect("an end of the header");
    let (header, data) = bytes.split_at(at + end.len());
    let number = |b: &[u8]| u64::from_le_bytes(b.try_into().expect("eight bytes"));
    assert_eq!(data.len() % 8, 0);
    (
        String::from_utf8_lossy(header).into_owned(),
        data.chunks(8).map(number).collect(),
    )
}

#[test]
fn every_format_keeps_every_bit() {
    for nodes in [[2, 2, 2], [3, 4, 5], [7, 2, 1], [1, 1, 300]] {
        let [nx, ny, nz] = nodes;
        let values = numbers(nx * ny * nz);
        let volume = Volume::new(nodes, [-0.5, 1e-7, 12345.678], [0.1, 1.0 / 3.0, 1e100], &values);
        let c_order: Vec<u64> = values.iter().map(|x| x.to_bits()).collect();
        // The first axis is the fastest.
        let mut x_first = Vec::new();
        for k in 0..nz {
            for j in 0..ny {
                x_first.extend((0..nx).map(|i| c_order[(i * ny + j) * nz + k]));
            }
        }
        let (header, found) = read("volume.npy", &volume, "\n");
        assert_eq!(found, c_order);
        assert_eq!(header.chars().next_back(), Some('\n'));
        let shape = format!("'shape': ({nx}, {ny}, {nz}), }}");
        assert!(header.contains("{'descr': '<f8', 'fortran_order': False, "), "{header}");
        assert!(header.contains(&shape), "{header}");

        let (header, found) = read("volume.nrrd", &volume, "\n\n");
        assert_eq!(found, x_first);
        let mut lines = header.trim_end().lines();
        assert_eq!(lines.next(), Some("NRRD0004"));
        let fields: std::collections::BTreeMap<_, _> = lines.map(|l| l.split_once(": ").expect("a field")).collect();
        let vectors = |field: &str| -> Vec<Vec<f64>> {
            let vectors = fields[field].split(' ').map(|v| v.trim_matches(['(', ')']));
            vectors
                .map(|v| v.split(',').map(|x| x.parse().expect("a number")).collect())
                .collect()
        };
        assert_eq!(fields["sizes"], format!("{nx} {ny} {nz}"));
        assert_eq!(vectors("space origin"), [volume.origin]);
        let [a, b, c] = volume.step;
        let answer = vectors("space directions");
        assert_eq!(answer, [[a, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]]);
        for (field, value) in [
            ("type", "double"),
            ("dimension", "3"),
            ("space dimension", "3"),
            ("kinds", "domain domain domain"),
            ("endian", "little"),
            ("encoding", "raw"),
        ] {
            assert_eq!(fields[field], value, "{field}");
        }
        assert_eq!(fields.len(), 9);

        assert_eq!(read("volume.raw", &volume, "").1, x_first);
    }
}

#[test]
fn what_cannot_be_written_is_named() {
    let values = numbers(8);
    let good = Volume::new([2; 3], [0.0; 3], [1.0; 3], &values);
    let error = |volume: Volume<'_>, name: &str| volume.write(scratch(name)).expect_err(name).to_string();
    let text = error(good, "grid.vti");
    assert!(
        text.ends_with("grid.vti: extension of a grid in space is unknown (expected npy, nrrd or raw)"),
        "{text}"
    );
    for nodes in [[2, 2, 3], [0, 0, 0], [usize::MAX; 3]] {
        let text = error(Volume::new(nodes, [0.0; 3], [1.0; 3], &values), "count.raw");
        assert!(text.contains("count.raw: 8 numbers for a grid of "), "{text}");
    }
    let text = error(Volume::new([0, 1, 1], [0.0; 3], [1.0; 3], &[]), "none.raw");
    assert!(text.contains("none.raw: 0 numbers"), "{text}");
    for bad in [f64::NAN, f64::INFINITY] {
        for (origin, step) in [([0.0, bad, 0.0], [1.0; 3]), ([0.0; 3], [1.0, 1.0, bad])] {
            let text = error(Volume::new([2; 3], origin, step, &values), "place.npy");
            assert!(
                text.contains("place.npy: origin or step of a grid is not finite"),
                "{text}"
            );
        }
    }
    let error = good.write(scratch("no/such/folder.npy")).expect_err("no folder");
    assert!(matches!(error.fault, FormatFault::Write(_)), "{error}");
    assert!(error.to_string().contains("cannot be written"), "{error}");
}

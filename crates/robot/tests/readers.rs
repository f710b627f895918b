//! The seeds of the fuzz targets `meshes` and `robots`, and mutants of them: see `truth::driven::readers`.

use std::path::Path;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truth::driven::readers::{self, PeakAlloc};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Mutants of each seed.
const MUTANTS: usize = 300;

/// Returns the files of a folder in the order of their names.
fn files(folder: &Path) -> Vec<Vec<u8>> {
    let entries = std::fs::read_dir(folder).expect("a folder of seeds");
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("a seed").path()).collect();
    paths.sort();
    paths.iter().map(|path| std::fs::read(path).expect("a seed")).collect()
}

/// Changes bytes behind the first one, which names the format: they are cut out, copied from another seed, replaced
/// by a word, or drawn.
fn mutate(bytes: &mut Vec<u8>, other: &[u8], words: &[String], random: &mut ChaCha8Rng) {
    for _ in 0..random.random_range(1..4) {
        let at = random.random_range(1..=bytes.len());
        let end = (at + random.random_range(0..9)).min(bytes.len());
        let from = random.random_range(0..other.len());
        let with = match random.random_range(0..4) {
            0 => Vec::new(),
            1 => other[from..(from + random.random_range(0..64)).min(other.len())].to_vec(),
            2 => words[random.random_range(0..words.len())].clone().into_bytes(),
            _ => vec![random.random()],
        };
        bytes.splice(at..end, with);
    }
}

/// Files that ask for much memory or time: many small objects, repeated instances, entities, and elements that are
/// skipped with their line.
fn hungry() -> Vec<String> {
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let source = "<source id='s'><float_array id='a' count='9'>0 0 0 1 0 0 0 1 0</float_array><technique_common>\
        <accessor source='#a' count='3' stride='3'/></technique_common></source>";
    let input = "<input semantic='VERTEX' source='#v' offset='0'/>";
    let mesh = format!(
        "{source}<vertices id='v'><input semantic='POSITION' source='#s'/></vertices>\
        <triangles count='1'>{input}<p>0 1 2</p></triangles>"
    );
    // Twice as many instances with each level.
    let instances = |levels: usize, first: &str| {
        let double = |k: usize| {
            format!(
                "<node id='n{}'>{}</node>",
                k + 1,
                format!("<instance_node url='#n{k}'/>").repeat(2)
            )
        };
        let nodes = format!("<node id='n0'>{first}</node>") + &(0..levels).map(double).collect::<String>();
        format!(
            "d<COLLADA><library_geometries><geometry id='g'><mesh>{mesh}</mesh></geometry></library_geometries>\
            <library_nodes>{nodes}</library_nodes><library_visual_scenes><visual_scene id='w'><node>\
            <instance_node url='#n{levels}'/></node></visual_scene></library_visual_scenes></COLLADA>"
        )
    };
    let body = "<instance_geometry url='#g'/>";
    let robot = |inside: String| format!("<robot name='r'>{inside}</robot>");
    let link = |inside: &str| format!("<link name='a'>{inside}</link>");
    let collision = "<collision><geometry><box size='1 1 1'/></geometry></collision>";
    let entity = |value: String, uses: String| {
        format!(
            "u<!DOCTYPE robot [<!ENTITY e '{value}'>]>{}",
            robot(link(&format!("<visual>{uses}</visual>")))
        )
    };
    vec![
        format!("o{triangle}{}f 1 2 3", "o\n".repeat(8_000)),
        format!("o{triangle}{}", "o\nf 1 2 3\n".repeat(4_000)),
        format!("o{}f {}", "v 0 0 0\n".repeat(3_000), "1 2 3 ".repeat(2_000)),
        format!("s{}", "solid\nendsolid\n".repeat(4_000)),
        format!("ssolid {}", "a ".repeat(8_000)),
        instances(14, body),
        instances(18, body),
        instances(60, body),
        instances(60, ""),
        format!(
            "d<COLLADA>{}</COLLADA>",
            "<library_visual_scenes><visual_scene/></library_visual_scenes>".repeat(2_000)
        ),
        format!("u{}", robot(link(&collision.repeat(2_000)))),
        format!(
            "u{}",
            robot((0..3_000).map(|k| format!("<link name='{k}'/>")).collect())
        ),
        entity("x".repeat(8_000), "&e;".repeat(4_000)),
        entity("x".repeat(8), "&e;".repeat(4_000)),
        format!("u<robot {}/>", "xmlns:a='b' ".repeat(1_000)),
        format!(
            "u<robot {}/>",
            (0..4_000).map(|k| format!("a{k}='' ")).collect::<String>()
        ),
        format!("u{}", "<robot>".repeat(4_000)),
        format!(
            "s{}",
            robot("<disable_collisions link1='l1' link2='tool'/>\n".repeat(20_000))
        ),
        format!(
            "c{{\"bodies\": [{}]}}",
            ["{\"name\": \"\", \"box\": {\"size\": [1, 1, 1]}}"; 1_000].join(",")
        ),
        format!(
            "tj1,j2,j3/x,j3/y,j3/z,j3/roll,j3/pitch,j3/yaw\n{}",
            "0,0,0,0,0,0,0,0\n".repeat(2_000)
        ),
    ]
}

// One test, because the memory of all threads is counted together.
#[test]
fn files_are_read_or_refused_within_time_and_memory() {
    let fuzz = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz");
    let dictionary = std::fs::read_to_string(fuzz.join("words.dict")).expect("the words");
    let words: Vec<String> = dictionary
        .lines()
        .map(|line| line.trim_matches('"').replace('\\', ""))
        .collect();
    let mut random = ChaCha8Rng::seed_from_u64(1);
    for (folder, check) in [("meshes", readers::meshes as fn(&[u8])), ("robots", readers::robots)] {
        let seeds = files(&fuzz.join("seeds").join(folder));
        assert!(seeds.len() >= 5);
        for seed in &seeds {
            check(seed);
            for _ in 0..MUTANTS {
                let mut bytes = seed.clone();
                mutate(
                    &mut bytes,
                    &seeds[random.random_range(0..seeds.len())],
                    &words,
                    &mut random,
                );
                check(&bytes);
            }
        }
        hungry().iter().for_each(|file| check(file.as_bytes()));
    }
}

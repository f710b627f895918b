//! The seeds of the fuzz targets `meshes`, `points`, `robots` and `stored`, and mutants of them:
//! see `truth::driven::readers`.

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
fn hungry() -> Vec<Vec<u8>> {
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
    let texts = [
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
        format!("itime\n{}", (0..8_000).map(|k| format!("{k}\n")).collect::<String>()),
        format!(
            "j{{\"joint_names\":[],\"points\":[{}]}}",
            ["{\"positions\":[],\"time_from_start\":0}"; 4_000].join(",")
        ),
        format!("j{}", "[".repeat(20_000)),
        format!("j[{}0]", "0,".repeat(20_000)),
        format!("y{}", "[".repeat(20_000)),
        format!("y{}", "- ".repeat(20_000)),
        format!("y[{}0]", "0,".repeat(20_000)),
        format!("y{}", "-\n".repeat(20_000)),
        format!(
            "y{}",
            (0..400).map(|k| format!("{}a:\n", " ".repeat(k))).collect::<String>()
        ),
    ];
    let texts = texts.into_iter().map(String::into_bytes);
    let texts = texts.chain(hungry_meshes()).chain(hungry_points());
    texts.chain(hungry_robots()).collect()
}

/// PLY with rows of a byte and a polygon of many corners, MSH of one point, and glTF with much JSON,
/// many nodes of one mesh, many corners without data, and long names.
fn hungry_meshes() -> Vec<Vec<u8>> {
    let ply = |rows: &str, faces: usize| {
        let point = "element vertex 3\nproperty char x\nproperty char y\nproperty char z\n";
        format!("pply\nformat binary_little_endian 1.0\n{point}element {rows} {faces}\nproperty list uchar uchar vertex_index\nend_header\n")
            .into_bytes()
    };
    let points = [0, 0, 0, 1, 0, 0, 0, 1, 0];
    let gltf = |nodes: String, mesh: &str, accessor: &str| {
        let list: Vec<String> = (0..nodes.matches("{\"mesh\"").count().max(1))
            .map(|k| k.to_string())
            .collect();
        let view = "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"buffers\":[{\"byteLength\":36,\"uri\":\"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}]";
        format!(
            "g{{\"asset\":{{\"version\":\"2.0\"}},\"scenes\":[{{\"nodes\":[{}]}}],\"nodes\":[{nodes}],\"meshes\":[{{{mesh}}}],\
            \"accessors\":[{{\"componentType\":5126,\"type\":\"VEC3\",{accessor}}}],{view}}}",
            list.join(",")
        )
        .into_bytes()
    };
    let node = "{\"mesh\":0},";
    let nodes = |count: usize| node.repeat(count).trim_end_matches(',').to_owned();
    let primitive = "{\"attributes\":{\"POSITION\":0}}";
    let mesh = format!("\"primitives\":[{primitive}]");
    let many = format!("\"primitives\":[{}]", [primitive; 500].join(","));
    let triangle = "\"bufferView\":0,\"count\":3";
    let zeros = |count: usize| {
        let span = "\"bufferView\":0";
        format!(
            "\"count\":{count},\"sparse\":{{\"count\":0,\"indices\":{{{span},\"componentType\":5121}},\"values\":{{{span}}}}}"
        )
    };
    let msh = |triangles: u32| {
        let counts = [1, 0, 0, triangles].map(u32::to_le_bytes).concat();
        [b"m".to_vec(), counts, vec![0; 12 + 12 * triangles as usize]].concat()
    };
    // A comb: every second corner is at the tip of a tooth.
    let corners = 4_000u16;
    let mut comb = format!(
        "pply\nformat binary_little_endian 1.0\nelement vertex {corners}\nproperty short x\nproperty short y\nproperty char z\n\
        element face 1\nproperty list ushort ushort vertex_index\nend_header\n"
    )
    .into_bytes();
    for k in 0..corners {
        let y = if k == 0 || k + 1 == corners {
            -100
        } else {
            i16::from(k % 2 == 1) * 1_000
        };
        comb.extend([k.to_le_bytes(), y.to_le_bytes()].as_flattened());
        comb.push(0);
    }
    comb.extend(corners.to_le_bytes());
    comb.extend((0..corners).flat_map(u16::to_le_bytes));
    vec![
        [ply("face", 16_000), points.to_vec(), vec![0; 16_000]].concat(),
        [ply("face", 16_000), points.to_vec(), [3, 0, 1, 2].repeat(16_000)].concat(),
        [
            ply("tristrips", 200),
            points.to_vec(),
            [[200].to_vec(), [0, 1, 2, 1].repeat(50)].concat().repeat(200),
        ]
        .concat(),
        [b"pply\nformat ascii 1.0\n".to_vec(), b"element a 0\n".repeat(3)].concat(),
        comb,
        msh(1),
        msh(10_000),
        gltf("{},".repeat(8_000) + "{}", &mesh, triangle),
        gltf(
            nodes(1),
            &format!("\"extras\":[{}0],{mesh}", "{\"\":0},".repeat(8_000)),
            triangle,
        ),
        gltf(nodes(3_000), &mesh, triangle),
        gltf(
            nodes(3_000),
            &format!("\"name\":\"{}\",{mesh}", "n".repeat(30_000)),
            triangle,
        ),
        gltf(
            nodes(3_000),
            &format!("\"weights\":[{}0],{mesh}", "0,".repeat(30_000)),
            triangle,
        ),
        gltf(nodes(1), &many, &zeros(1_200)),
        gltf(nodes(500), &mesh, &zeros(90_000)),
        gltf(nodes(1), &mesh, &zeros(699_999)),
        gltf(nodes(1), &mesh, &zeros(4_294_967_294)),
    ]
}

/// Points of a byte each, compressed points, many names, columns and fields, and arrays of many
/// brackets, fields and axes.
fn hungry_points() -> Vec<Vec<u8>> {
    let ply = |properties: &str, count: usize| {
        format!("pply\nformat binary_little_endian 1.0\nelement vertex {count}\n{properties}end_header\n").into_bytes()
    };
    let axes = "property char x\nproperty char y\nproperty char z\n";
    let pcd = |fields: &str, size: &str, kind: &str, count: usize, data: &str| {
        format!("cFIELDS {fields}\nSIZE {size}\nTYPE {kind}\nWIDTH {count}\nHEIGHT 1\nDATA {data}\n").into_bytes()
    };
    // Zeros: a literal, and 264 copies of it for each three bytes.
    let packed = |fields: &str, size: &str, kind: &str, count: usize, bytes: usize| {
        let all = count * bytes;
        let mut data = vec![0, 0];
        let repeats = (all - 1) / 264;
        data.extend([0xe0, 255, 0].repeat(repeats));
        data.extend([0, 0].repeat(all - 1 - 264 * repeats));
        let sizes = [(data.len() as u32).to_le_bytes(), (all as u32).to_le_bytes()].concat();
        [pcd(fields, size, kind, count, "binary_compressed"), sizes, data].concat()
    };
    let npy = |descr: &str, shape: &str, data: usize| {
        let header = format!("{{'descr':{descr},'fortran_order':False,'shape':{shape}}}");
        let length = (header.len() as u32).to_le_bytes();
        [&b"n\x93NUMPY\x02\x00"[..], &length, header.as_bytes(), &vec![0; data]].concat()
    };
    let names: String = (0..8_000).map(|k| format!(" n{k}")).collect();
    let fields: String = (0..4_000).map(|k| format!("('n{k}','|V0'),")).collect();
    vec![
        [ply(axes, 20_000), vec![1; 60_000]].concat(),
        [ply(&format!("{axes}property uchar radius\n"), 20_000), vec![1; 80_000]].concat(),
        ply(&"property char a\n".repeat(4_000), 1),
        [pcd("x y z", "1 1 1", "I I I", 20_000, "binary"), vec![1; 60_000]].concat(),
        [
            pcd("x y z", "1 1 1", "I I I", 20_000, "ascii"),
            b"0 0 0\n".repeat(20_000),
        ]
        .concat(),
        packed("x y z", "4 4 4", "F F F", 2_000_000, 12),
        packed("x y z", "8 8 8", "F F F", 1_000_000, 24),
        packed("x y z radius", "4 4 8 1", "F F F U", 1_000_000, 17),
        packed("x y z", "4 4 4", "F F F", 1, 12),
        format!("cFIELDS{names}\nDATA ascii\n").into_bytes(),
        format!(
            "cFIELDS x y z{names}\nWIDTH 1\nDATA ascii\n1 2 3{}\n",
            " 0".repeat(8_000)
        )
        .into_bytes(),
        format!("c{}DATA ascii\n", "#\na\n".repeat(8_000)).into_bytes(),
        b"x0 0 0\n"
            .to_vec()
            .into_iter()
            .chain(b"0 0 0\n".repeat(20_000))
            .collect(),
        format!("x{}", ",".repeat(20_000)).into_bytes(),
        format!("x{}\n{}", "a ".repeat(20_000), "0 ".repeat(20_000)).into_bytes(),
        format!("x#x y z{names}\n0 0 0{}\n", " 0".repeat(8_000)).into_bytes(),
        format!("x{}", "#\n".repeat(20_000)).into_bytes(),
        npy("'|i1'", "(20000,3)", 60_000),
        npy("'|i1'", &format!("({}3)", "1,".repeat(20_000)), 3),
        npy("'|i1'", &"[".repeat(20_000), 3),
        npy(&format!("[{}]", "[],".repeat(20_000)), "(1,)", 3),
        npy(&format!("{{{}}}", "1:1,".repeat(20_000)), "(1,)", 3),
        npy(&format!("[{fields}('x','<f4'),('y','<f4'),('z','<f4')]"), "(1,)", 12),
        npy(&format!("[{}]", "('','|V0'),".repeat(8_000)), "(9999999999,)", 0),
    ]
}

/// MJCF with copies, height fields, excluded pairs, and long names; SDFormat with masks and long
/// names.
fn hungry_robots() -> Vec<Vec<u8>> {
    let mjcf = |inside: &str| format!("m<mujoco>{inside}</mujoco>");
    let cell = |inside: &str| mjcf(&format!("<worldbody>{inside}</worldbody>"));
    let copies = |count: usize, inside: &str| format!("<replicate count='{count}'>{inside}</replicate>");
    let field = |size: usize, heights: &str| {
        format!(
            "<asset><hfield name='h' nrow='{size}' ncol='{size}' size='1 1 1 1' {heights}/></asset>\
            <worldbody>{}</worldbody>",
            copies(1_000, "<geom type='hfield' hfield='h'/>")
        )
    };
    let elevation = |size: usize| format!("elevation='{}'", "0 1 ".repeat(size * size / 2));
    let ball = |bits: &str| format!("<body><freejoint/><geom size='1' {bits}/></body>");
    let long = "n".repeat(8_000);
    let sdf = |letter: &str, inside: &str| format!("{letter}<sdf version='1.6'><model name='m'>{inside}</model></sdf>");
    let link = |k: usize, mask: &str| {
        format!(
            "<link name='{k}'><collision name=''><geometry><sphere><radius>1</radius></sphere></geometry>{mask}\
            </collision></link>"
        )
    };
    let links = |count: usize, mask: &str| (0..count).map(|k| link(k, mask)).collect::<String>();
    let apart = "<surface><contact><collide_bitmask>0</collide_bitmask></contact></surface>";
    let names = |count: usize| (0..count).map(|k| format!("<link name='{k}'/>")).collect::<String>();
    let below = |name: &str, inside: &str| format!("<model name='{name}'>{inside}</model>");
    let deep = |name: &str, levels: usize| (0..levels).fold(names(1_000), |inside, _| below(name, &inside));
    let frames: String = (1..2_000)
        .map(|k| format!("<frame name='{k}'><pose relative_to='{}'/></frame>", k - 1))
        .collect();
    let texts = [
        cell(&copies(1_000_000_000, "")),
        cell(&copies(4_000, &ball("contype='0'"))),
        cell(&copies(1_200, &ball("conaffinity='0'"))),
        cell(&copies(4_000, &ball(""))),
        cell(&copies(4_900, "<geom size='1 1 1' type='box'/>")),
        cell(&copies(100, &copies(100, &copies(100, "<geom size='1'/>")))),
        cell(&copies(5_000, &"<site/>".repeat(2_000))),
        cell(&copies(5_000, "<body><joint type='slide' pos='0 0 1'/></body>")),
        cell(&format!("<replicate count='9000' sep='{long}'><body/></replicate>")),
        cell(&format!(
            "<replicate count='2000' sep='{}'><body><freejoint/></body></replicate>",
            "s".repeat(240)
        )),
        cell(&format!("<body name='{long}'>{}</body>", "<site/>".repeat(2_000))),
        cell(&format!("<body name='{long}'>{}</body>", "<site/>x".repeat(2_000))),
        cell(&"<body/>".repeat(4_000)),
        cell(&"<geom size='1'/>".repeat(5_100)),
        mjcf(&"<size/>".repeat(4_000)),
        mjcf(&field(1_000, "")),
        mjcf(&field(300, &elevation(300))),
        mjcf(&field(400, &elevation(400))),
        mjcf(&format!(
            "<default><equality {}/></default>",
            (0..4_000).map(|k| format!("a{k}='' ")).collect::<String>()
        )),
        mjcf(&format!(
            "<asset><mesh name='m' vertex='{}'/></asset><worldbody>{}</worldbody>",
            (0..4_000)
                .map(|k| format!("{} {} {} ", k % 20, k / 20 % 20, k / 400))
                .collect::<String>(),
            copies(1_000, "<geom type='mesh' mesh='m'/>")
        )),
        sdf("w", &links(1_300, apart)),
        sdf("w", &links(1_500, apart)),
        sdf("w", &links(2_000, "")),
        sdf("f", &links(2_000, apart)),
        sdf("w", &names(3_000)),
        sdf("w", &below(&long, &names(1_000))),
        sdf("w", &below(&"n".repeat(240), &names(1_000))),
        sdf("w", &deep("nnn", 40)),
        sdf("w", &deep("n", 70)),
        sdf("w", &format!("<link name='0'/>{frames}")).replace("1.6", "1.7"),
    ];
    texts.into_iter().map(String::into_bytes).collect()
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
    let checks = [
        ("meshes", readers::meshes as fn(&[u8])),
        ("points", readers::points),
        ("robots", readers::robots),
        ("stored", readers::stored),
    ];
    for (folder, check) in checks {
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
        hungry().iter().for_each(|file| check(file));
    }
}

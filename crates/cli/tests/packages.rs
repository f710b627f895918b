//! Packages: where meshes are found, by every kind of path.

use std::path::{Path, PathBuf};
use std::process::Command;

use lin_canny_robot::{FileError, LoadOptions, Packages, Robot};

/// A new folder of this test run, and a mesh in each of the given files.
fn tree(name: &str, meshes: &[&str]) -> PathBuf {
    let root = Path::new(env!("CARGO_TARGET_TMPDIR")).join("packages").join(name);
    let _ = std::fs::remove_dir_all(&root);
    for (k, mesh) in meshes.iter().enumerate() {
        let size = k + 1;
        let text = format!("v 0 0 0\nv {size} 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
        write(&root.join(mesh), &text);
    }
    root
}

fn write(file: &Path, text: &str) {
    std::fs::create_dir_all(file.parent().expect("a folder")).expect("a folder");
    std::fs::write(file, text).expect("a file");
}

fn urdf(mesh: &str) -> String {
    let shape = format!("<collision><geometry><mesh filename=\"{mesh}\"/></geometry></collision>");
    format!("<robot name=\"r\"><link name=\"a\">\n{shape}</link></robot>")
}

/// Returns the number of the mesh that a URDF in a folder finds, counted from 1.
fn found(mesh: &str, folder: &Path, packages: &Packages) -> Result<usize, FileError> {
    let robot = Robot::parse(&urdf(mesh), folder.join("r.urdf"), packages, &LoadOptions::default())?;
    let lin_canny::Geometry::Polyhedron(hull) = &robot.links()[0].bodies[0].geometry else {
        panic!("a hull")
    };
    Ok(hull.aabb().1.x.round() as usize)
}

fn package_xml(name: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<!DOCTYPE package>\n<package format=\"3\">\n  <!-- a tool -- or two -->\n  <name> {name}\n</name></package>"
    )
}

/// The tool finds a package above a URDF from every current folder and by every relative path.
#[test]
fn packages_above_a_relative_path_are_found() {
    let root = tree("relative", &["pkg_a/meshes/u.obj"]);
    write(&root.join("pkg_a/urdf/r.urdf"), &urdf("package://pkg_a/meshes/u.obj"));
    write(&root.join("other/deep/x"), "");
    let full = root.join("pkg_a/urdf/r.urdf");
    for (current, path) in [
        ("pkg_a/urdf", "r.urdf"),
        ("pkg_a/urdf", "./r.urdf"),
        ("pkg_a/urdf", "../urdf/r.urdf"),
        ("pkg_a", "urdf/r.urdf"),
        ("pkg_a", "./urdf/../urdf/r.urdf"),
        (".", "pkg_a/urdf/r.urdf"),
        ("other/deep", "../../pkg_a/urdf/r.urdf"),
        ("other/deep", &*full.to_string_lossy()),
    ] {
        let mut tool = Command::new(env!("CARGO_BIN_EXE_lin-canny"));
        tool.current_dir(root.join(current))
            .args(["find-excluded", path, "--samples", "1"]);
        let output = tool.output().expect("the tool runs");
        assert!(output.status.success(), "{path} in {current}: {output:?}");
        // A cell is found by the same rules.
        let bodies = "{\"bodies\": [{\"name\": \"x\", \"mesh\": {\"file\": \"package://pkg_a/meshes/u.obj\"}}]}";
        write(&root.join("pkg_a/urdf/cell.json"), bodies);
        let cell = path.replace("r.urdf", "cell.json");
        let mut tool = Command::new(env!("CARGO_BIN_EXE_lin-canny"));
        let arguments = ["find-excluded", path, "--samples", "1", "--cell", &cell];
        let output = tool
            .current_dir(root.join(current))
            .args(arguments)
            .output()
            .expect("the tool runs");
        assert!(output.status.success(), "{cell} in {current}: {output:?}");
    }
}

#[test]
fn a_folder_that_is_only_on_the_way_is_not_above() {
    let root = tree("way", &["a/pkg/u.obj", "b/pkg/u.obj"]);
    write(&root.join("b/urdf/x"), "");
    let packages = Packages::default();
    let way = root.join("a/../b/urdf");
    assert_eq!(found("package://pkg/u.obj", &way, &packages).expect("a mesh"), 2);
}

#[test]
fn a_package_has_the_name_in_its_package_xml_or_that_of_its_folder() {
    let root = tree(
        "named",
        &["checkout-main/meshes/u.obj", "arm/meshes/u.obj", "plain/meshes/u.obj"],
    );
    write(&root.join("checkout-main/package.xml"), &package_xml("arm"));
    write(&root.join("checkout-main/urdf/x"), "");
    write(&root.join("arm/package.xml"), &package_xml("leg"));
    write(&root.join("plain/package.xml"), "<package><na");
    let name = |package: &str| format!("package://{package}/meshes/u.obj");
    let above = root.join("checkout-main/urdf");
    let elsewhere = root.join("nowhere");
    let given = [
        (Packages::new([&root]), &elsewhere),
        (
            Packages::new([root.join("checkout-main"), root.join("arm"), root.join("plain")]),
            &elsewhere,
        ),
    ];
    for (packages, folder) in &given {
        assert_eq!(found(&name("arm"), folder, packages).expect("a mesh"), 1);
        assert_eq!(found(&name("leg"), folder, packages).expect("a mesh"), 2);
        assert_eq!(found(&name("plain"), folder, packages).expect("a mesh"), 3);
        assert_eq!(found(&name("checkout-main"), folder, packages).expect("a mesh"), 1);
    }
    assert_eq!(found(&name("arm"), &above, &Packages::default()).expect("a mesh"), 1);
    assert_eq!(found(&name("plain"), &above, &Packages::default()).expect("a mesh"), 3);
    let answer = found(&name("checkout-main"), &above, &Packages::default()).expect("a mesh");
    assert_eq!(answer, 1);
    // A folder of that name, if no other folder says that it is the package.
    let other = Packages::new([root.join("arm")]);
    assert_eq!(found(&name("arm"), &elsewhere, &other).expect("a mesh"), 2);
    assert!(found(&name("foot"), &elsewhere, &Packages::new([&root])).is_err());
}

#[test]
fn addresses_of_every_kind_are_found() {
    let root = tree(
        "kinds",
        &[
            "my pkg/me sh.obj",
            "urdf/50%25.obj",
            "urdf/ü.obj",
            "urdf/a%20b.obj",
            "urdf/a b.obj",
        ],
    );
    let folder = root.join("urdf");
    let at = root.to_string_lossy().into_owned();
    let coded = at.replace('/', "%2F");
    let packages = Packages::default();
    for (mesh, number) in [
        ("package://my pkg/me sh.obj".into(), 1),
        ("package://my%20pkg/me%20sh.obj".into(), 1),
        ("package:///my%20pkg/me%20sh.obj".into(), 1),
        ("model://my%20pkg/me sh.obj".into(), 1),
        (" model://my pkg/me sh.obj ".into(), 1),
        (format!("file://{at}/my%20pkg/me%20sh.obj"), 1),
        (format!("file://localhost{at}/my pkg/me sh.obj"), 1),
        (format!("file:{at}/my pkg/me sh.obj"), 1),
        (format!("file://{coded}%2Fmy%20pkg/me sh.obj"), 1),
        (format!("{at}/my pkg/me sh.obj"), 1),
        ("../my pkg/me sh.obj".into(), 1),
        ("file://../my%20pkg/me%20sh.obj".into(), 1),
        ("50%25.obj".into(), 2),
        ("./50%2525.obj".into(), 2),
        ("%C3%BC.obj".into(), 3),
        ("file://%c3%bc.obj".into(), 3),
        // What is written goes before what it stands for.
        ("a%20b.obj".into(), 4),
        ("a b.obj".into(), 5),
    ] {
        let answer = found(&mesh, &folder, &packages).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(answer, number, "{mesh}");
    }
    for mesh in [
        "x.obj",
        "package://my pkg/x.obj",
        "package://x",
        "model://",
        "file://",
        "%zz.obj",
        "%",
        "%e9.obj",
        "",
    ] {
        let error = found(mesh, &folder, &packages).expect_err(mesh);
        assert!(error.line == Some(2), "{error}");
        assert!(error.to_string().contains("is missing"), "{error}");
    }
    let error = found("https://example.org/x.obj", &folder, &packages).expect_err("an address");
    assert!(error.line == Some(2), "{error}");
    assert!(error.to_string().contains("is not supported"), "{error}");
}

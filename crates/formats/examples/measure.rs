//! Prints what mesh files hold, as CSV: objects, points, triangles, the box around them, area and
//! signed volume. A file that cannot be read is named on standard error, and the exit code is 1.
//!
//! `cargo run --release -p lin-canny-formats --example measure -- FILE...`

use std::process::ExitCode;

use lin_canny_formats::MeshFile;

fn cross(u: [f64; 3], v: [f64; 3]) -> [f64; 3] {
    let at = |i: usize, j: usize| u[i] * v[j] - u[j] * v[i];
    [at(1, 2), at(2, 0), at(0, 1)]
}

fn main() -> ExitCode {
    let files: Vec<String> = std::env::args().skip(1).collect();
    if files.is_empty() {
        eprintln!("usage: measure FILE...");
        return ExitCode::from(2);
    }
    let mut code = ExitCode::SUCCESS;
    println!("file,format,objects,points,triangles,x0,y0,z0,x1,y1,z1,area,volume,skipped");
    for file in files {
        let mesh = match MeshFile::load(&file) {
            Ok(mesh) => mesh,
            Err(error) => {
                eprintln!("{error}");
                code = ExitCode::FAILURE;
                continue;
            }
        };
        let (points, triangles) = mesh.whole();
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for point in &points {
            for axis in 0..3 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        let (mut area, mut volume) = (0.0, 0.0);
        for triangle in &triangles {
            let [a, b, c] = triangle.map(|k| points[k as usize]);
            let from = |p: [f64; 3], q: [f64; 3]| [0, 1, 2].map(|k| p[k] - q[k]);
            let normal = cross(from(b, a), from(c, a));
            area += 0.5 * normal.iter().map(|x| x * x).sum::<f64>().sqrt();
            // Relative to a corner of the box, because a mesh far away has a small volume.
            let a = from(a, low);
            volume += a.iter().zip(normal).map(|(x, n)| x * n).sum::<f64>() / 6.0;
        }
        let skipped: Vec<&str> = mesh.skipped.iter().map(|one| one.what.as_str()).collect();
        let [objects, points, triangles] = [mesh.objects.len(), points.len(), triangles.len()];
        let [[x0, y0, z0], [x1, y1, z1]] = [low, high];
        println!(
            "\"{file}\",{:?},{objects},{points},{triangles},{x0},{y0},{z0},{x1},{y1},{z1},{area},{volume},\"{}\"",
            mesh.format,
            skipped.join("; ")
        );
    }
    code
}

use std::path::{Path, PathBuf};

use lin_canny::nalgebra::Point3;
use lin_canny::{Mesh, MeshKind, PointQuery};
use truth::faults::{BROKEN_KINDS, broken};
use truth::near_points::{POINT_KINDS, hard_point, is_between, place, place_beside};
use truth::rng::Rng;
use truth::soups::Soup;

/// Returns what a mesh kept: without repeated triangles and those without area.
fn kept(mesh: &Mesh) -> Soup {
    Soup::new(
        mesh.vertices().into_iter().map(Into::into).collect(),
        mesh.triangle_vertices(),
    )
}

/// What points of meshes cost, and how many of them are outside, on and inside.
#[derive(Default)]
struct Judged {
    tally: [usize; 3],
    solids: usize,
    open: usize,
    /// Leaves visited plus triangles that the ray tested, of each point.
    work: Vec<usize>,
}

impl Judged {
    /// Checks hard points against the documented rule and exact distances.
    fn judge(&mut self, soup: &Soup, count: usize, rng: &mut Rng, told: &str) {
        let points: Vec<_> = soup.points.iter().map(|p| Point3::from(*p)).collect();
        let Ok(mesh) = Mesh::new(&points, &soup.triangles) else {
            return;
        };
        let soup = kept(&mesh);
        let is_solid = mesh.kind() == MeshKind::Solid;
        self.solids += usize::from(is_solid);
        self.open += usize::from(!is_solid);
        let points: Vec<_> = (0..count).map(|k| hard_point(&soup, k % POINT_KINDS, rng)).collect();
        let given: Vec<_> = points.iter().map(|p| Point3::from(*p)).collect();
        let query = PointQuery::new(&mesh);
        let all = query.closest_points(&given).expect("points");
        let proven = query.clone().prepared().closest_points(&given).expect("points");
        assert_eq!(proven, all, "{told}: prepared");
        for (k, (found, p)) in all.iter().zip(&points).enumerate() {
            let told = format!("{told}, kind {}, {p:?}: {found:?}", k % POINT_KINDS);
            // Coordinates below 2^-200 of the size count as zero.
            let flush = soup.radius() * 2f64.powi(-202);
            let p = p.map(|x| if x.abs() < flush { 0.0 } else { x });
            let truth = if is_solid {
                place(&soup, p, rng)
            } else {
                place_beside(&soup, p)
            };
            let state = truth.state();
            assert_eq!(found.state, state, "{told}");
            let (x, y) = (found.lower.abs(), found.upper.abs());
            let (lower, upper) = (x.min(y), x.max(y));
            assert!(is_between(&soup, p, lower, upper), "{told}");
            let width = upper - lower;
            assert!(width <= 2e-14 * (soup.radius() + upper), "{width:e}: {told}");
            self.tally[truth as usize] += 1;
            let work = query.work(&given[k]).expect("a mesh");
            self.work.push(work.iter().sum());
        }
    }

    /// Prints what was judged, and checks the work of the worst point against that of the median.
    fn report(mut self) {
        self.work.sort_unstable();
        let (median, worst) = (self.work[self.work.len() / 2], self.work[self.work.len() - 1]);
        println!(
            "{} solids, {} open; outside, on, inside: {:?}; leaves and crossings: median {median}, worst {worst}",
            self.solids, self.open, self.tally
        );
        assert!(worst <= 100 * median, "{worst} over {median}");
    }
}

/// Meshes of each kind; twenty times as many in the record.
fn count() -> usize {
    std::env::var("LIN_CANNY_MESHES_OF_A_KIND").map_or(2, |n| n.parse().expect("a number"))
}

#[test]
fn broken_meshes_follow_the_documented_rule_at_the_work_of_sound_ones() {
    let (mut rng, mut judged) = (Rng::new(172), Judged::default());
    for k in 0..count() * BROKEN_KINDS {
        let kind = k % BROKEN_KINDS;
        let scale = [1.0, 2f64.powi(-330), 2f64.powi(320)][k / BROKEN_KINDS % 3];
        let soup = broken(kind, &mut rng).map(|p| p.map(|x| x * scale));
        judged.judge(&soup, 2 * POINT_KINDS, &mut rng, &format!("kind {kind}, mesh {k}"));
    }
    assert!(
        judged.solids > judged.open && judged.open > 0,
        "{} {}",
        judged.solids,
        judged.open
    );
    assert!(judged.tally.iter().all(|n| *n > 20), "{:?}", judged.tally);
    judged.report();
}

/// Returns the files below a folder, in order.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut all: Vec<_> = std::fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] })
        .collect();
    all.sort();
    all
}

#[test]
#[ignore = "needs a folder of files: LIN_CANNY_MESHES=FOLDER cargo test --all-features --test points mesh_files -- --ignored --nocapture"]
fn mesh_files_follow_the_documented_rule() {
    let folder = std::env::var("LIN_CANNY_MESHES").expect("LIN_CANNY_MESHES names a folder");
    let (mut rng, mut judged) = (Rng::new(272), Judged::default());
    for path in files(Path::new(&folder)) {
        let Some(soup) = Soup::read(&path) else {
            continue;
        };
        judged.judge(&soup, POINT_KINDS, &mut rng, &path.display().to_string());
    }
    judged.report();
}

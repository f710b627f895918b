//! Meshes with the faults of real files at random poses; each answer is judged by brute force on
//! the mesh without the faults.

use lin_canny::nalgebra::Point3;
use lin_canny::{ContactState, Mesh, MeshKind, PairTracker, RelativePose};
use truth::faults::{faulty, on_grid};
use truth::pose::scale;
use truth::rng::Rng;
use truth::soups::{self, Soup};
use truth::{Pose, brute};

/// Poses of a pair.
const POSES: usize = 8;

truth::tally! {
    /// Counts of the faulty meshes of a run.
    #[derive(Clone, Copy, Debug, Default)]
    pub(crate) struct Mix {
        pub(crate) meshes: u64,
        pub(crate) frames: u64,
        /// Frames in which one mesh is entirely inside the other.
        pub(crate) contained: u64,
        /// Frames in which the surfaces cross.
        pub(crate) crossing: u64,
    }
}

fn clean(rng: &mut Rng) -> Soup {
    let shape = match rng.below(5) {
        0 => soups::torus(16, 8, rng.range(0.1, 0.4)),
        1 => soups::rock(2, rng.bits()),
        2 => soups::gear(5 + rng.below(8)),
        3 => soups::bracket(),
        _ => soups::plate(2, [1.0, 0.5, rng.log_range(1e-3, 0.5)]),
    };
    on_grid(shape)
}

fn mesh(soup: &Soup) -> Result<Mesh, String> {
    let points: Vec<Point3<f64>> = soup.points.iter().map(|p| Point3::from(*p)).collect();
    let mesh = Mesh::new(&points, &soup.triangles).map_err(|e| format!("{e}: {soup:?}"))?;
    match mesh.kind() {
        MeshKind::Solid => Ok(mesh),
        kind => Err(format!("{kind:?}: {} {soup:?}", mesh.report())),
    }
}

/// Plays a pair. The error is the failure.
pub(crate) fn play(seed: u64) -> Result<Mix, String> {
    let mut rng = Rng::new(seed);
    let shape = clean(&mut rng);
    // A small body is often entirely inside.
    let small = rng.log_range(0.02, 1.0);
    let other = on_grid(clean(&mut rng).map(|p| scale(p, small)));
    let (m, n) = (mesh(&faulty(&shape, &mut rng))?, mesh(&faulty(&other, &mut rng))?);
    let (mut mix, mut tracker) = (Mix::default(), PairTracker::new());
    mix.meshes = 2;
    for _ in 0..POSES {
        let (q, t) = (rng.quat(), scale(rng.in_ball(), rng.range(0.1, 2.0)));
        let pose = Pose { q, t };
        let relative = RelativePose::from_isometry(&pose.isometry()).map_err(|e| e.to_string())?;
        let truth = brute::distance(&shape, &other, &pose).0;
        // A sliver protrudes by 2^-40 at most.
        let noise = 2f64.powi(-38) + 1e-13 * (shape.radius() + other.radius() + truth::pose::norm(t));
        if truth > 0.0 && truth < noise {
            continue;
        }
        let holds = |s: &Soup, p| brute::winding(s, p).abs() > 0.5;
        let contained =
            holds(&shape, pose.apply(other.points[0])) || holds(&other, pose.apply_inverse(shape.points[0]));
        let meets = contained || truth == 0.0;
        let found = tracker.closest(&m, &n, &relative);
        let is_right = if meets {
            found.state != ContactState::Separated && found.lower <= 0.0
        } else {
            found.state == ContactState::Separated && found.lower <= truth + noise && truth <= found.upper + noise
        };
        if !is_right || tracker.intersects(&m, &n, &relative) != meets {
            return Err(format!("{truth:e}, contained {contained}: {found:?}\n{pose:?}"));
        }
        mix.frames += 1;
        mix.contained += u64::from(contained && truth > 0.0);
        mix.crossing += u64::from(truth == 0.0);
    }
    Ok(mix)
}

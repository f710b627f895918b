//! V-HACD behind its validator: intervals hold for the mesh, at any size and place.

use lin_canny_parry::lin_canny::{ContactState, Decomposition, Mesh, PairTracker, RelativePose};
use truth::Pose;
use truth::forms::mesh;
use truth::pose::scale;
use truth::rng::Rng;
use truth::soups::{self, Soup};

use super::engine::parry::transformation::vhacd::VHACDParameters;
use super::engine::{DecompositionError, decompose};

fn coarse() -> VHACDParameters {
    VHACDParameters {
        resolution: 24,
        ..Default::default()
    }
}

/// Poses of a mesh about a decomposed one; returns how many are told apart.
fn holds(pieces: &Decomposition, m: &Mesh, size: f64, rng: &mut Rng) -> usize {
    let mut apart = 0;
    let (mut pair, mut exact) = (PairTracker::new(), PairTracker::new());
    for k in 0..60 {
        let pose = Pose::new(rng.quat(), scale(rng.unit(), size * rng.range(0.0, 3.0)));
        let pose = RelativePose::from_isometry(&pose.isometry()).expect("unit");
        let found = pieces.distance(&mut pair, m, &pose);
        let truth = exact.distance(pieces.mesh(), m, &pose);
        assert!(found.lower <= truth.upper, "{k} {found:?} {truth:?}");
        assert!(truth.lower <= found.upper, "{k} {found:?} {truth:?}");
        assert!(
            found.state != ContactState::Separated || truth.state == ContactState::Separated,
            "{k} {found:?} {truth:?}"
        );
        apart += usize::from(found.state == ContactState::Separated);
    }
    apart
}

#[test]
fn distances_of_pieces_are_intervals_that_hold_for_the_mesh() {
    let mut rng = Rng::new(31);
    for soup in [soups::torus(24, 12, 0.3), soups::gear(8), soups::bracket()] {
        for grow in [1.0, 1e-4, 1e3] {
            let m = mesh(&soup.clone().map(|p| scale(p, grow)));
            let pieces = decompose(m.clone(), &coarse()).expect("a solid has pieces");
            let fit = pieces.fit();
            assert!(pieces.pieces().pieces().len() > 1);
            assert!(fit.excess_upper < 0.25 * grow, "{fit}");
            assert!(fit.shortfall_upper < 0.15 * grow, "{fit}");
            assert!(fit.excess_upper - fit.excess_lower < 0.01 * grow, "{fit}");
            let apart = holds(&pieces, &m, grow, &mut rng);
            assert!(apart > 10, "{apart}");
        }
    }
}

#[test]
fn what_cannot_be_decomposed_is_refused_by_name() {
    let m = mesh(&soups::bracket());
    for resolution in [0, 3, 4096] {
        let parameters = VHACDParameters { resolution, ..coarse() };
        let refused = decompose(m.clone(), &parameters).map(|_| ());
        assert_eq!(refused, Err(DecompositionError::Resolution(resolution)));
    }
    // A surface has no volume, and perhaps no pieces.
    let sheet = mesh(&Soup::new(
        vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        vec![[0, 1, 2]],
    ));
    if let Err(refused) = decompose(sheet, &coarse()) {
        assert!(matches!(refused, DecompositionError::Empty { .. }), "{refused}");
    }
}

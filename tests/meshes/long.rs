//! Long thin triangles: shafts, cones, bearings, links and trays as CAD has them.

use super::mesh;
use lab::turned;
use lin_canny::MeshKind;

#[test]
fn turned_parts_are_solids() {
    let parts = [
        turned::shaft(40),
        turned::cone(24),
        turned::bearing(30, 1.01),
        turned::link(16),
        turned::tray(5),
    ];
    for part in parts {
        let m = mesh(&part);
        assert_eq!(m.kind(), MeshKind::Solid, "{}", m.report());
        assert!(m.report().parts.iter().all(|p| p.volume > 0.0), "{}", m.report());
    }
}

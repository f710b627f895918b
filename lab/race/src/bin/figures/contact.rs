//! Draws a box that slides over the edge of a round plate: both faces from above, and the contacts.

use lin_canny::nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use lin_canny::{ConvexPolyhedron, Feature, Manifold, ManifoldOptions, RelativePose, Tracker, polyhedron::solids};

use crate::Trouble;
use lin_canny_record::svg::{BLUE, GREEN, GREY, INK, ORANGE, Place, SKY, Svg};

const SCALE: f64 = 100.0;
const PANEL: f64 = 270.0;

/// Projects a point along the normal into one panel.
fn see(panel: usize, p: &Point3<f64>) -> Place {
    [PANEL * panel as f64 + 15.0 + SCALE * (p.x + 1.0), 150.0 - SCALE * p.y]
}

fn face(body: &ConvexPolyhedron, feature: Feature, pose: &Isometry3<f64>, panel: usize) -> Vec<Place> {
    let Feature::Face(f) = feature else { return vec![] };
    let corners = body.face_vertices(f).filter_map(|v| body.vertex(v));
    corners.map(|p| see(panel, &(pose * p))).collect()
}

pub(crate) fn picture() -> Result<String, Trouble> {
    let plate = solids::prism(24, 0.2, 1.0)?;
    let part = solids::cuboid(Vector3::new(0.35, 0.25, 0.2))?;
    let (mut pair, mut manifold) = (Tracker::new(), Manifold::new());
    let options = ManifoldOptions::default().prediction(0.01);
    let mut svg = Svg::new(
        3 * PANEL as u32 + 20,
        330,
        "Contacts of a box that slides over the rim of a plate",
    );
    for frame in 0..=10 {
        let turn = UnitQuaternion::from_euler_angles(0.0, 0.0, 0.4);
        let place = Translation3::new(0.4 + 0.06 * f64::from(frame), 0.1, 0.399);
        let pose = Isometry3::from_parts(place, turn);
        let plate_from_part = RelativePose::from_isometry(&pose)?;
        pair.manifold(&plate, &part, &plate_from_part, &options, &mut manifold);
        let (Some(features), Some(panel)) = (manifold.features(), [0, 5, 10].iter().position(|&f| f == frame)) else {
            continue;
        };
        let style = |fill: &str, line: &str| {
            format!("fill=\"{fill}\" fill-opacity=\"0.3\" stroke=\"{line}\" stroke-width=\"1.5\"")
        };
        svg.polygon(
            &face(&plate, features.a, &Isometry3::identity(), panel),
            &style(SKY, BLUE),
        );
        svg.polygon(&face(&part, features.b, &pose, panel), &style(ORANGE, ORANGE));
        // Names are written outside the area that the points span.
        let middle = manifold
            .points()
            .iter()
            .map(|c| see(panel, &c.point_on_a)[0])
            .sum::<f64>()
            / manifold.points().len() as f64;
        for contact in manifold.points() {
            let at = see(panel, &contact.point_on_a);
            let moved = contact.id != contact.features;
            svg.dot(at, 5.0, &format!("fill=\"{}\"", if moved { GREEN } else { INK }));
            let (side, anchor) = if at[0] < middle { (-7.0, "end") } else { (7.0, "start") };
            svg.words([at[0] + side, at[1] - 6.0], 12, anchor, &contact.id.to_string());
        }
        svg.words(
            [PANEL * panel as f64 + 30.0, 24.0],
            14,
            "start",
            &format!("frame {frame}"),
        );
    }
    let legend = [
        (BLUE, "reference face, of the plate"),
        (ORANGE, "incident face, of the box"),
        (INK, "contact, with its name"),
        (GREEN, "keeps its name on other features"),
    ];
    for (k, (colour, words)) in legend.into_iter().enumerate() {
        let at = [30.0 + 370.0 * (k % 2) as f64, 292.0 + 22.0 * (k / 2) as f64];
        svg.dot(
            [at[0], at[1] - 4.0],
            5.0,
            &format!("fill=\"{colour}\" stroke=\"{GREY}\""),
        );
        svg.words([at[0] + 12.0, at[1]], 13, "start", words);
    }
    Ok(svg.finish())
}

//! Pictures in the plane: slices of a body, and a point body that moves in the slice.

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{ConvexPolyhedron, Feature, Outcome, RelativePose, Tracker};

use crate::Trouble;
use lin_canny_record::svg::{BLUE, GREEN, GREY, INK, ORANGE, Place, SKY, Svg};

/// The middle slice of a body, and a point whose closest feature is queried.
///
/// The axis of the body is perpendicular to the page.
struct Slice {
    body: ConvexPolyhedron,
    point: ConvexPolyhedron,
    scale: f64,
    centre: Place,
}

impl Slice {
    fn new(body: ConvexPolyhedron, scale: f64, centre: Place) -> Result<Self, Trouble> {
        Ok(Self {
            body,
            point: ConvexPolyhedron::point(Point3::origin())?,
            scale,
            centre,
        })
    }

    fn ask(&self, tracker: &mut Tracker, at: Place) -> Result<Outcome, Trouble> {
        let pose = RelativePose::from_isometry(&Isometry3::translation(at[0], at[1], 0.0))?;
        Ok(tracker.closest(&self.body, &self.point, &pose))
    }

    fn see(&self, [x, y]: Place) -> Place {
        [self.centre[0] + self.scale * x, self.centre[1] - self.scale * y]
    }

    /// Returns the vertices of the outline in order: each is an edge of the body that crosses the
    /// slice.
    fn corners(&self) -> Vec<Place> {
        let mut corners: Vec<Place> = self
            .body
            .edges()
            .filter_map(|e| self.corner(Feature::Edge(e)))
            .collect();
        corners.sort_by(|p, q| p[1].atan2(p[0]).total_cmp(&q[1].atan2(q[0])));
        corners
    }

    /// Returns the point where an edge crosses the slice.
    fn corner(&self, feature: Feature) -> Option<Place> {
        let Feature::Edge(e) = feature else { return None };
        let [p, q] = self.body.edge_vertices(e)?.map(|v| self.body.vertex(v));
        let (p, q) = (p?, q?);
        (p.z * q.z < 0.0).then(|| [(p.x + q.x) / 2.0, (p.y + q.y) / 2.0])
    }

    /// Colours the slice by the closest feature of each cell, as returned by a query.
    fn regions(
        &self,
        svg: &mut Svg,
        from: Place,
        to: Place,
        cell: f64,
        colour: impl Fn(Feature) -> Option<String>,
    ) -> Result<(), Trouble> {
        let mut tracker = Tracker::new();
        let mut y = from[1];
        while y < to[1] {
            let (mut x, mut run): (f64, Option<(f64, Option<String>)>) = (from[0], None);
            while x < to[0] + cell {
                let at = [
                    (x + cell / 2.0 - self.centre[0]) / self.scale,
                    (self.centre[1] - y - cell / 2.0) / self.scale,
                ];
                let o = self.ask(&mut tracker, at)?;
                let inside = o.distance <= 0.0;
                let now = if inside || x >= to[0] {
                    None
                } else {
                    colour(o.features.a)
                };
                if run.as_ref().is_none_or(|(_, c)| *c != now) {
                    if let Some((start, Some(c))) = run {
                        svg.rect(
                            [start, y],
                            [x - start, cell],
                            &format!("fill=\"{c}\" shape-rendering=\"crispEdges\""),
                        );
                    }
                    run = Some((x, now));
                }
                x += cell;
            }
            y += cell;
        }
        Ok(())
    }

    fn outline(&self, svg: &mut Svg) {
        let corners: Vec<Place> = self.corners().into_iter().map(|p| self.see(p)).collect();
        svg.polygon(
            &corners,
            &format!("fill=\"#e8ebee\" stroke=\"{INK}\" stroke-width=\"2\" stroke-linejoin=\"round\""),
        );
    }

    /// Draws a point and its closest point on the body.
    fn witness(&self, svg: &mut Svg, o: &Outcome, at: Place) {
        let foot = self.see([o.point_on_a.x, o.point_on_a.y]);
        svg.line(foot, self.see(at), &format!("stroke=\"{INK}\" stroke-width=\"2\""));
        svg.dot(foot, 3.5, &format!("fill=\"{INK}\""));
        svg.dot(self.see(at), 5.0, &format!("fill=\"{GREEN}\""));
    }
}

/// Draws the Voronoi regions of a box, computed by queries.
pub(crate) fn regions() -> Result<String, Trouble> {
    let slice = Slice::new(solids::cuboid(Vector3::new(1.3, 0.8, 1.0))?, 90.0, [320.0, 185.0])?;
    let mut svg = Svg::new(640, 400, "Voronoi regions of a box, in a slice");
    let tint = |f: Feature| match f {
        Feature::Face(_) => Some("#cfe3f4".to_owned()),
        _ => Some("#fbdcc4".to_owned()),
    };
    slice.regions(&mut svg, [20.0, 20.0], [620.0, 350.0], 5.0, tint)?;
    slice.outline(&mut svg);
    let mut tracker = Tracker::new();
    for at in [[0.4, 1.5], [2.6, 1.5], [-2.5, -0.3], [-1.9, 1.3]] {
        let o = slice.ask(&mut tracker, at)?;
        slice.witness(&mut svg, &o, at);
    }
    svg.words([320.0, 190.0], 15, "middle", "the box, cut across");
    for (at, word) in [
        ([0.0, -1.35], "region of a face"),
        ([2.45, -1.35], "of an edge"),
        ([-2.45, -1.35], "of an edge"),
        ([2.4, 0.0], "of a face"),
    ] {
        svg.words(slice.see(at), 14, "middle", word);
    }
    svg.words(
        [320.0, 382.0],
        14,
        "middle",
        "every point outside belongs to the feature it is closest to; the borders are planes",
    );
    Ok(svg.finish())
}

/// Draws a jump of the point, and the features that the walk visits from the old one to the new
/// one.
pub(crate) fn walk() -> Result<String, Trouble> {
    let (from, to) = ([1.9, 0.15], [0.6, 1.7]);
    let mut svg = Svg::new(880, 330, "The walk from the old feature to the new one");
    let slice = |centre| Slice::new(solids::prism(7, 1.0, 1.0)?, 62.0, centre);
    let here = slice([0.0, 0.0])?;
    let mut tracker = Tracker::new();
    here.ask(&mut tracker, from)?;
    let jump = RelativePose::from_isometry(&Isometry3::translation(to[0], to[1], 0.0))?;
    let (pairs, ended) = tracker.trace(&here.body, &here.point, &jump);
    assert!(ended, "the walk of the picture ends");
    let way: Vec<Feature> = pairs.iter().map(|pair| pair.a).collect();
    let width = 880.0 / way.len() as f64;
    for (k, feature) in way.iter().enumerate() {
        let slice = slice([width * (k as f64 + 0.36), 205.0])?;
        let left = width * k as f64 + 8.0;
        let own =
            |f: Feature| (f == *feature).then(|| if k + 1 == way.len() { "#bfe5d6" } else { "#fbdcc4" }.to_owned());
        slice.regions(&mut svg, [left, 50.0], [left + width - 16.0, 290.0], 2.5, own)?;
        slice.outline(&mut svg);
        svg.dot(
            slice.see(from),
            2.5,
            &format!("fill=\"none\" stroke=\"{GREY}\" stroke-width=\"1.5\""),
        );
        svg.line(
            slice.see(from),
            slice.see(to),
            &format!("stroke=\"{GREY}\" stroke-width=\"1.2\" stroke-dasharray=\"4 4\""),
        );
        let last = k + 1 == way.len();
        if last {
            let o = slice.ask(&mut tracker, to)?;
            slice.witness(&mut svg, &o, to);
        }
        svg.dot(
            slice.see(to),
            5.0,
            &format!("fill=\"{}\"", if last { GREEN } else { ORANGE }),
        );
        let middle = left + width / 2.0 - 8.0;
        let reported = if last {
            "inside: closest"
        } else {
            "outside: on to the neighbour"
        };
        svg.words([middle, 32.0], 14, "middle", &format!("{}. {feature}", k + 1));
        svg.words([middle, 314.0], 13, "middle", reported);
        let rim = format!(
            "fill=\"none\" stroke=\"{}\" stroke-width=\"1\"",
            if last { BLUE } else { SKY }
        );
        svg.rect([left, 50.0], [width - 16.0, 240.0], &rim);
    }
    Ok(svg.finish())
}

//! Draws which engines answer wrongly if rounding decides.
//!
//! The scene is a box with an edge in the plane of a face of another box, shifted by units in the
//! last place.

use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{ConvexPolyhedron, RelativePose, Tracker};
use truth::exact::solve;
use truth::{ContactState, Pose, shapes};

use crate::Trouble;
use lin_canny_record::svg::Svg;

/// Cells along a side of a map.
const SIDE: usize = 40;

/// Pixels per cell.
const CELL: f64 = 5.0;

const APART: &str = "#cfe3f4";
const OVERLAPPING: &str = "#fbdcc4";
const WRONG: &str = "#b00020";

/// The answer of one engine for every cell.
struct Map {
    title: &'static str,
    classes: Vec<ContactState>,
}

/// The bodies in the form of each engine.
struct Stage {
    shape: shapes::Shape,
    body: ConvexPolyhedron,
    parry: truth::parry::Hull,
}

impl Stage {
    fn new() -> Result<Self, Trouble> {
        let shape = shapes::cuboid([0.5; 3]);
        let parry = truth::parry::mesh(&shape.points, &shape.faces).ok_or("parry takes a box")?;
        let body = solids::cuboid(Vector3::new(0.5, 0.5, 0.5))?;
        let same = body
            .vertex_points()
            .all(|p: Point3<f64>| shape.points.contains(&p.into()));
        assert!(same, "one box for all");
        Ok(Self { shape, body, parry })
    }

    /// Returns the pose of B for a cell.
    ///
    /// At the middle cell, the upright edge of A lies in the plane of B's face, as nearly as `f64`
    /// can represent it. From there, B is moved by units in the last place along x and y.
    fn pose(i: usize, j: usize) -> Pose {
        let middle = 0.5 + std::f64::consts::FRAC_1_SQRT_2 / 2.0;
        let ulp = middle.next_up() - middle;
        let at = |k: usize| middle + (k as f64 - SIDE as f64 / 2.0) * ulp;
        Pose::turn([0.0, 0.0, 1.0], std::f64::consts::FRAC_PI_4, [at(i), at(j), 0.125])
    }

    fn map(&self, title: &'static str, ask: impl Fn(&Pose) -> Result<ContactState, Trouble>) -> Result<Map, Trouble> {
        let cells = (0..SIDE * SIDE).map(|k| Self::pose(k % SIDE, k / SIDE));
        let classes: Result<Vec<ContactState>, Trouble> = cells.map(|p| ask(&p)).collect();
        Ok(Map {
            title,
            classes: classes?,
        })
    }

    fn maps(&self) -> Result<Vec<Map>, Trouble> {
        let relative = |p: &Pose| RelativePose::new(&Pose::IDENTITY.isometry(), &p.isometry());
        let of = |c| match c {
            lin_canny::ContactState::Separated => ContactState::Separated,
            lin_canny::ContactState::Overlapping => ContactState::Overlapping,
            _ => ContactState::Touching,
        };
        let (a, s) = (&self.body, &self.shape);
        Ok(vec![
            self.map("exact arithmetic", |p| {
                Ok(solve(s.into(), &Pose::IDENTITY, s.into(), p).state)
            })?,
            self.map("certified: closest", |p| {
                Ok(of(Tracker::new().closest(a, a, &relative(p)?).state))
            })?,
            self.map("the walk's word: propose", |p| {
                let apart = Tracker::new()
                    .propose(a, a, &relative(p)?)
                    .distance
                    .is_some_and(|d| d > 0.0);
                Ok(if apart {
                    ContactState::Separated
                } else {
                    ContactState::Overlapping
                })
            })?,
            self.map("parry f64: distance", |p| {
                let apart = truth::parry::distance(&self.parry, &Pose::IDENTITY, &self.parry, p) > 0.0;
                Ok(if apart {
                    ContactState::Separated
                } else {
                    ContactState::Overlapping
                })
            })?,
        ])
    }
}

pub(crate) fn picture() -> Result<String, Trouble> {
    let maps = Stage::new()?.maps()?;
    let truth = maps[0].classes.clone();
    assert!(!truth.contains(&ContactState::Touching), "a map of two colours");
    let side = CELL * SIDE as f64;
    let mut svg = Svg::new(900, 300, "Who answers wrong where rounding decides");
    for (k, map) in maps.iter().enumerate() {
        let left = 16.0 + k as f64 * (side + 22.0);
        let misses = map.draw(&mut svg, left, &truth);
        svg.words([left + side / 2.0, 28.0], 14, "middle", map.title);
        let reported = match k {
            0 => "the truth".to_owned(),
            _ => format!("{misses} of {} wrong", truth.len()),
        };
        svg.words([left + side / 2.0, 258.0], 13, "middle", &reported);
    }
    for (x, colour, word) in [
        (16.0, APART, "apart"),
        (90.0, OVERLAPPING, "overlapping"),
        (205.0, WRONG, "wrong: the other of the two"),
    ] {
        svg.rect([x, 274.0], [14.0, 14.0], &format!("fill=\"{colour}\""));
        svg.words([x + 20.0, 286.0], 13, "start", word);
    }
    let scale = "a cell is one unit in the last place of the position, 1.1e-16";
    svg.words([884.0, 286.0], 13, "end", scale);
    Ok(svg.finish())
}

impl Map {
    /// Draws the map with its left side at `left`. Returns the number of wrong cells.
    fn draw(&self, svg: &mut Svg, left: f64, truth: &[ContactState]) -> usize {
        let miss = |cell: usize| self.classes[cell] != truth[cell];
        let colour = |cell: usize| match (miss(cell), self.classes[cell]) {
            (true, _) => WRONG,
            (_, ContactState::Separated) => APART,
            _ => OVERLAPPING,
        };
        for row in 0..SIDE {
            // Adjacent cells of one colour become one rectangle.
            let (first, y) = (row * SIDE, 40.0 + CELL * (SIDE - 1 - row) as f64);
            let mut start = 0;
            for end in 1..=SIDE {
                if end < SIDE && colour(first + end) == colour(first + start) {
                    continue;
                }
                let style = format!("fill=\"{}\" shape-rendering=\"crispEdges\"", colour(first + start));
                let place = [left + CELL * start as f64, y];
                svg.rect(place, [CELL * (end - start) as f64, CELL], &style);
                start = end;
            }
        }
        (0..truth.len()).filter(|&c| miss(c)).count()
    }
}

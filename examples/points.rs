//! Points and a solid that is not convex: inside or outside, how far, and what is near.

use lin_canny::nalgebra::Point3;
use lin_canny::{ContactState, Mesh, PointQuery, PointTracker};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // The outline of an L, and a copy one unit above it.
    let outline = [[0., 0.], [3., 0.], [3., 1.], [1., 1.], [1., 3.], [0., 3.]];
    let points: Vec<_> = [0.0, 1.0]
        .iter()
        .flat_map(|z| outline.map(|[x, y]| Point3::new(x, y, *z)))
        .collect();
    let mut triangles = Vec::new();
    for [a, b, c] in [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]] {
        triangles.extend([[a, c, b], [a + 6, b + 6, c + 6]]);
    }
    for k in 0..6 {
        let next = (k + 1) % 6;
        triangles.extend([[k, next, next + 6], [k, next + 6, k + 6]]);
    }
    let bracket = Mesh::new(&points, &triangles)?;
    let query = PointQuery::new(&bracket);

    // A slice through the middle: `#` inside, `.` outside.
    let at = |column: u8, row: u8| Point3::new(0.125 * f64::from(column) - 0.5, 3.5 - 0.25 * f64::from(row), 0.5);
    let slice: Vec<_> = (0..17)
        .flat_map(|row| (0..33).map(move |column| at(column, row)))
        .collect();
    for line in query.contains_each(&slice)?.chunks(33) {
        let line: String = line.iter().map(|is_in| if *is_in { '#' } else { '.' }).collect();
        println!("{line}");
    }

    // A point that moves into the corner of the L, and through its wall.
    let mut tracker = PointTracker::new();
    for step in 0..7 {
        let p = Point3::new(2.0 - 0.25 * f64::from(step), 2.0 - 0.25 * f64::from(step), 0.5);
        let found = tracker.closest_point(&query, &p)?;
        let side = match found.state {
            ContactState::Separated => "outside",
            ContactState::Overlapping => "inside",
            ContactState::Touching => "on the surface",
            _ => "undecided",
        };
        println!("at {:.2}: {side}, signed distance {:+.4}", p.x, found.distance);
    }

    // The triangles within half a unit, the nearest first.
    for found in query.within(&Point3::new(1.2, 1.3, 0.5), 0.5)? {
        println!("triangle {} at {:.4}", found.location.subshape, found.distance);
    }
    Ok(())
}

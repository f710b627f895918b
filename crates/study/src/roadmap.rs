//! The graph of a roadmap: candidate edges and connected components.

use std::collections::BTreeSet;
use std::sync::Arc;

use datafusion::arrow::array::{ArrayRef, AsArray, Float64Array, Int64Array, RecordBatch};
use datafusion::arrow::datatypes::{Float64Type, Int64Type};
use lin_canny_robot::Coordinate;
use petgraph::unionfind::UnionFind;

use crate::error::StudyError;
use crate::input::ID;
use crate::rows::list_column;

/// Returns the segments from each node to its nearest nodes, each segment once.
///
/// A row has the ids of both ends, the length and both configurations. Lengths are fractions of the
/// ranges of the joints.
///
/// # Errors
/// Returns an error if the nodes lack a required column.
pub fn candidates(
    coordinates: &[Coordinate],
    nodes: &RecordBatch,
    neighbours: usize,
) -> Result<RecordBatch, StudyError> {
    let points = points(coordinates, nodes)?;
    let scaled: Vec<Vec<f64>> = points
        .iter()
        .map(|p| p.iter().zip(coordinates).map(|(x, c)| x / range(c)).collect())
        .collect();
    let length = |i: usize, j: usize| {
        let squares = scaled[i].iter().zip(&scaled[j]).map(|(x, y)| (x - y) * (x - y));
        squares.sum::<f64>().sqrt()
    };
    let mut pairs = BTreeSet::new();
    for i in 0..points.len() {
        let mut others: Vec<(f64, usize)> = (0..points.len())
            .filter(|&j| j != i)
            .map(|j| (length(i, j), j))
            .collect();
        let count = neighbours.min(others.len());
        if count > 0 && count < others.len() {
            others.select_nth_unstable_by(count - 1, |x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        }
        pairs.extend(others[..count].iter().map(|&(_, j)| (i.min(j), i.max(j))));
    }
    let ids = ids(nodes, ID)?;
    let ends = |pick: fn(&(usize, usize)) -> usize| pairs.iter().map(pick);
    let id = |pick| Arc::new(Int64Array::from_iter_values(ends(pick).map(|k| ids.value(k)))) as ArrayRef;
    let lengths = Float64Array::from_iter_values(pairs.iter().map(|&(i, j)| length(i, j)));
    let list = |pick: fn(&(usize, usize)) -> usize| {
        Arc::new(list_column(ends(pick).map(|k| points[k].as_slice()))) as ArrayRef
    };
    let columns: [(_, ArrayRef); 5] = [
        ("a", id(|p| p.0)),
        ("b", id(|p| p.1)),
        ("length", Arc::new(lengths)),
        ("from", list(|p| p.0)),
        ("to", list(|p| p.1)),
    ];
    Ok(RecordBatch::try_from_iter(columns)?)
}

/// Counts of connected components.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Components {
    /// Number of components.
    pub count: usize,
    /// Number of nodes of the largest component.
    pub largest: usize,
}

/// Returns the components of nodes (column `id`) and edges (columns `node_a` and `node_b`).
///
/// # Errors
/// Returns an error if nodes or edges lack these columns, or if a node of an edge does not exist.
pub fn components(nodes: &RecordBatch, edges: &RecordBatch) -> Result<Components, StudyError> {
    let ids = ids(nodes, ID)?;
    let numbers: std::collections::HashMap<i64, usize> = ids.values().iter().copied().zip(0..).collect();
    let number = |id: &i64| numbers.get(id).copied().ok_or_else(|| missing(&id.to_string()));
    let mut components = UnionFind::new(numbers.len());
    let (from, to) = (self::ids(edges, "node_a")?, self::ids(edges, "node_b")?);
    for (a, b) in from.values().iter().zip(to.values()) {
        components.union(number(a)?, number(b)?);
    }
    let mut sizes = vec![0; numbers.len()];
    components.into_labeling().into_iter().for_each(|k| sizes[k] += 1);
    Ok(Components {
        count: sizes.iter().filter(|&&s| s > 0).count(),
        largest: sizes.into_iter().max().unwrap_or(0),
    })
}

fn range(coordinate: &Coordinate) -> f64 {
    let [low, high] = coordinate.limits;
    // A joint that cannot move adds nothing: both ends are the same.
    if high > low { high - low } else { 1.0 }
}

fn missing(name: &str) -> StudyError {
    StudyError::unfit("the roadmap", format!("{name} is missing"))
}

fn ids<'r>(rows: &'r RecordBatch, name: &str) -> Result<&'r Int64Array, StudyError> {
    let column = rows
        .column_by_name(name)
        .and_then(|c| c.as_primitive_opt::<Int64Type>());
    column.ok_or_else(|| missing(name))
}

fn points(coordinates: &[Coordinate], nodes: &RecordBatch) -> Result<Vec<Vec<f64>>, StudyError> {
    let column = |c: &Coordinate| {
        let found = nodes
            .column_by_name(&c.name)
            .and_then(|c| c.as_primitive_opt::<Float64Type>());
        found.ok_or_else(|| missing(&c.name))
    };
    let columns: Vec<_> = coordinates.iter().map(column).collect::<Result<_, _>>()?;
    Ok((0..nodes.num_rows())
        .map(|row| columns.iter().map(|c| c.value(row)).collect())
        .collect())
}

//! Candidates of a roadmap against brute force, and its components.

use std::sync::Arc;

use datafusion::arrow::array::{ArrayRef, AsArray, Int64Array, RecordBatch};
use datafusion::arrow::datatypes::{Float64Type, Int64Type};
use lin_canny_study::sampled::Sampler;
use lin_canny_study::{StudyOptions, roadmap};

use crate::study;

#[test]
fn segments_join_nearest_nodes() {
    let study = study(StudyOptions::default());
    let coordinates = study.coordinates();
    let nodes = Sampler::random(coordinates, 9).rows(0..60).expect("nodes");
    let rows = roadmap::candidates(coordinates, &nodes, 4).expect("segments");
    let end = |k: usize| rows.column(k).as_primitive::<Int64Type>().values().to_vec();
    let pairs: Vec<_> = end(0).into_iter().zip(end(1)).collect();
    let point = |id: i64| {
        let value = |k: usize| nodes.column(k + 1).as_primitive::<Float64Type>().value(id as usize);
        let range = |k: usize| coordinates[k].limits[1] - coordinates[k].limits[0];
        (0..6).map(|k| value(k) / range(k)).collect::<Vec<_>>()
    };
    let length = |a: i64, b: i64| {
        let squares = point(a).into_iter().zip(point(b)).map(|(x, y)| (x - y) * (x - y));
        squares.sum::<f64>().sqrt()
    };
    let mut expected = std::collections::BTreeSet::new();
    for a in 0..60 {
        let mut others: Vec<i64> = (0..60).filter(|&b| b != a).collect();
        others.sort_by(|&x, &y| length(a, x).total_cmp(&length(a, y)));
        expected.extend(others[..4].iter().map(|&b| (a.min(b), a.max(b))));
    }
    assert_eq!(pairs, expected.into_iter().collect::<Vec<_>>());
    let found = rows.column(2).as_primitive::<Float64Type>();
    let from = rows.column(3).as_list::<i32>();
    for (k, &(a, b)) in pairs.iter().enumerate() {
        assert!((found.value(k) - length(a, b)).abs() < 1e-12);
        let first = from.value(k).as_primitive::<Float64Type>().value(0);
        assert_eq!(first, nodes.column(1).as_primitive::<Float64Type>().value(a as usize));
    }
}

#[test]
fn components_are_counted() {
    let ids = |list: &[i64]| Arc::new(Int64Array::from(list.to_vec())) as ArrayRef;
    let nodes = RecordBatch::try_from_iter([("id", ids(&[4, 7, 9, 11, 20]))]).expect("nodes");
    let edges = [("node_a", ids(&[4, 11, 9])), ("node_b", ids(&[9, 20, 4]))];
    let edges = RecordBatch::try_from_iter(edges).expect("edges");
    let found = roadmap::components(&nodes, &edges).expect("a graph");
    assert_eq!((found.count, found.largest), (3, 2));
    let strange = [("node_a", ids(&[4])), ("node_b", ids(&[5]))];
    let strange = RecordBatch::try_from_iter(strange).expect("edges");
    assert!(roadmap::components(&nodes, &strange).is_err());
}

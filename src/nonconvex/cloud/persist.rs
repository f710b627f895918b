//! Clouds in files (feature `serde`).
//!
//! A file holds the points in the caller's order and the element. The tree is built again on
//! reading, so that a malicious file does no harm and the cloud is equal to the last bit.

use alloc::vec::Vec;
use nalgebra::Vector3;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::points::Points;
use super::{Cloud, CloudElement};

#[derive(Serialize, Deserialize)]
#[serde(rename = "Cloud")]
struct StoredCloud {
    points: StoredPoints,
    element: CloudElement,
}

#[derive(Serialize, Deserialize)]
enum StoredPoints {
    Single(Vec<[f32; 3]>),
    Double(Vec<[f64; 3]>),
    Grid {
        origin: [f64; 3],
        size: [f64; 3],
        cells: Vec<[u16; 3]>,
    },
}

impl Serialize for Cloud {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut items = alloc::vec![0; self.len()];
        (0..self.len()).for_each(|item| items[self.number_of(item) as usize] = item as u32);
        let points = match self.points.in_order(&items) {
            Points::Single(points) => StoredPoints::Single(points),
            Points::Double(points) => StoredPoints::Double(points),
            Points::Grid { origin, size, cells } => StoredPoints::Grid {
                origin: origin.into(),
                size: size.into(),
                cells,
            },
        };
        let element = self.element();
        StoredCloud { points, element }.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Cloud {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let StoredCloud { points, element } = StoredCloud::deserialize(deserializer)?;
        let points = match points {
            StoredPoints::Single(points) => Points::Single(points),
            StoredPoints::Double(points) => Points::Double(points),
            StoredPoints::Grid { origin, size, cells } => Points::Grid {
                origin: Vector3::from(origin),
                size: Vector3::from(size),
                cells,
            },
        };
        Self::build(points, element).map_err(D::Error::custom)
    }
}

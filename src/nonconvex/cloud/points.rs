//! The points of a cloud and their radii, in the precision in which the caller gave them.

use alloc::vec::Vec;
use nalgebra::Vector3;

use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::fingerprint::Fingerprinter;

/// Points in the caller's unit.
#[derive(Clone, Debug)]
pub(super) enum Points {
    /// In single precision.
    Single(Vec<[f32; 3]>),
    /// In double precision.
    Double(Vec<[f64; 3]>),
    /// The centres of cells of a grid.
    Grid {
        origin: Vector3<f64>,
        size: Vector3<f64>,
        cells: Vec<[u16; 3]>,
    },
}

impl Points {
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Single(points) => points.len(),
            Self::Double(points) => points.len(),
            Self::Grid { cells, .. } => cells.len(),
        }
    }

    #[inline(always)]
    pub(super) fn at(&self, k: usize) -> Vector3<f64> {
        match self {
            Self::Single(points) => {
                let [x, y, z] = points[k];
                Vector3::new(f64::from(x), f64::from(y), f64::from(z))
            }
            Self::Double(points) => Vector3::from(points[k]),
            Self::Grid { origin, size, cells } => {
                let [x, y, z] = cells[k];
                let steps = Vector3::new(f64::from(x), f64::from(y), f64::from(z)).add_scalar(0.5);
                origin + size.component_mul(&steps)
            }
        }
    }

    /// Calls a function with some points, and an item for each of them.
    #[inline(always)]
    pub(super) fn for_each<T>(&self, items: impl Iterator<Item = (usize, T)>, mut f: impl FnMut(Vector3<f64>, T)) {
        match self {
            Self::Single(points) => items.for_each(|(k, item)| f(Vector3::from(points[k].each(f64::from)), item)),
            Self::Double(points) => items.for_each(|(k, item)| f(Vector3::from(points[k]), item)),
            Self::Grid { .. } => items.for_each(|(k, item)| f(self.at(k), item)),
        }
    }

    pub(super) fn in_order(&self, order: &[u32]) -> Self {
        match self {
            Self::Single(points) => Self::Single(permuted(points, order)),
            Self::Double(points) => Self::Double(permuted(points, order)),
            Self::Grid { origin, size, cells } => Self::Grid {
                origin: *origin,
                size: *size,
                cells: permuted(cells, order),
            },
        }
    }

    pub(super) fn memory_usage(&self) -> usize {
        match self {
            Self::Single(points) => size_of_val(&points[..]),
            Self::Double(points) => size_of_val(&points[..]),
            Self::Grid { cells, .. } => size_of_val(&cells[..]),
        }
    }

    /// Adds the points to the fingerprint of a cloud.
    pub(super) fn add_to(&self, all: &mut Fingerprinter) {
        all.word(self.len() as u64);
        match self {
            Self::Single(points) => {
                all.word(1);
                all.indices(points.iter().flatten().map(|x| x.to_bits()));
            }
            Self::Double(points) => {
                all.word(2);
                points.iter().flatten().for_each(|x| all.number(*x));
            }
            Self::Grid { origin, size, cells } => {
                all.word(3);
                all.vector(origin);
                all.vector(size);
                for &[x, y, z] in cells {
                    all.word(u64::from(x) | u64::from(y) << 16 | u64::from(z) << 32);
                }
            }
        }
    }
}

fn permuted<T: Copy>(all: &[T], order: &[u32]) -> Vec<T> {
    order.iter().map(|&k| all[k as usize]).collect()
}

/// A radius for each point: in single precision if no radius is rounded by that.
#[derive(Clone, Debug)]
pub(super) enum Radii {
    Single(Vec<f32>),
    Double(Vec<f64>),
}

impl Radii {
    pub(super) fn new(radii: Vec<f64>) -> Self {
        if radii.iter().all(|r| f64::from(*r as f32) == *r) {
            Self::Single(radii.iter().map(|r| *r as f32).collect())
        } else {
            Self::Double(radii)
        }
    }

    #[inline(always)]
    pub(super) fn at(&self, k: usize) -> f64 {
        match self {
            Self::Single(radii) => f64::from(radii[k]),
            Self::Double(radii) => radii[k],
        }
    }

    pub(super) fn largest(&self) -> f64 {
        match self {
            Self::Single(radii) => f64::from(radii.iter().copied().fold(0.0, f32::larger)),
            Self::Double(radii) => radii.iter().copied().fold(0.0, f64::larger),
        }
    }

    pub(super) fn in_order(&self, order: &[u32]) -> Self {
        match self {
            Self::Single(radii) => Self::Single(permuted(radii, order)),
            Self::Double(radii) => Self::Double(permuted(radii, order)),
        }
    }

    pub(super) fn memory_usage(&self) -> usize {
        match self {
            Self::Single(radii) => size_of_val(&radii[..]),
            Self::Double(radii) => size_of_val(&radii[..]),
        }
    }
}

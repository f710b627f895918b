//! The geometries of a batch as an argument: one for all poses, or one for each pose.

use lin_canny::Geometry as Body;
use pyo3::prelude::*;

use crate::errors::pair_error;
use crate::geometry::Geometry;

/// One geometry, or one for each pose.
pub(super) enum Bodies<'py> {
    One(Bound<'py, Geometry>),
    Each(Vec<Bound<'py, Geometry>>),
}

/// Returns the name of the type of an object.
fn kind(obj: &Bound<'_, PyAny>) -> String {
    let name = obj.get_type().name();
    name.map_or_else(|_| "object".into(), |name| name.to_string())
}

impl<'py> Bodies<'py> {
    /// Takes an argument for so many poses.
    pub(super) fn new(name: &str, obj: &Bound<'py, PyAny>, poses: usize) -> PyResult<Self> {
        if let Ok(one) = obj.cast::<Geometry>() {
            return Ok(Self::One(one.clone()));
        }
        let items = obj.try_iter().map_err(|_| {
            let kind = kind(obj);
            pair_error(format!(
                "{name} is a {kind} (expected a Geometry, or one for each pose)"
            ))
        })?;
        let mut each = Vec::new();
        for (k, item) in items.enumerate() {
            let item = item?;
            let body = item.cast::<Geometry>().map_err(|_| {
                let kind = kind(&item);
                pair_error(format!("{name}: entry {k} is a {kind} (expected a Geometry)"))
            })?;
            each.push(body.clone());
        }
        if each.len() != poses {
            let count = each.len();
            return Err(pair_error(format!(
                "{name}: there are {count} geometries (expected one, or one for each of {poses} poses)"
            )));
        }
        Ok(Self::Each(each))
    }

    pub(super) fn view(&self) -> BodiesView<'_> {
        match self {
            Self::One(one) => BodiesView::One(&one.get().0),
            Self::Each(each) => BodiesView::Each(each.iter().map(|one| &one.get().0).collect()),
        }
    }
}

/// The geometries of a batch, for all threads.
pub(super) enum BodiesView<'a> {
    One(&'a Body),
    Each(Vec<&'a Body>),
}

impl<'a> BodiesView<'a> {
    /// Returns the geometry of a pose.
    pub(super) fn at(&self, k: usize) -> &'a Body {
        match self {
            Self::One(one) => one,
            Self::Each(each) => each[k],
        }
    }

    /// Returns the geometry of all poses; `None` if each has its own.
    pub(super) fn one(&self) -> Option<&'a Body> {
        match self {
            Self::One(one) => Some(one),
            Self::Each(_) => None,
        }
    }
}

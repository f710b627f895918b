//! Clashes of the parts of a model.

use std::path::PathBuf;

use lin_canny_clash::{ClashOptions, Clashes as Found, Model, ModelOptions, Row, Rules, Unit, find, to_csv, to_junit};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::array::triple;
use crate::errors::{file_error, refused};
use crate::geometry::Geometry;
use crate::pose::Pose;
use crate::watch::Watch;

/// Two parts of a model that are near each other. Lengths are in the unit of the model.
#[pyclass(frozen, module = "lin_canny")]
pub(crate) struct Clash(Row);

#[pymethods]
impl Clash {
    /// The name of the first part.
    #[getter]
    fn a(&self) -> &str {
        &self.0.a
    }

    /// The name of the second part.
    #[getter]
    fn b(&self) -> &str {
        &self.0.b
    }

    /// "apart", "touching", "close" (the gap is less than the pair must keep), "undecided", "crossing"
    /// (a part has no inside), "overlapping", "inside" (one is wholly in the other) or "equal".
    #[getter]
    fn kind(&self) -> String {
        self.0.kind.to_string()
    }

    /// Lower and upper bound of the gap; zero for parts that touch or overlap.
    #[getter]
    fn gap(&self) -> (f64, f64) {
        self.0.gap.into()
    }

    /// Lower and upper bound of the penetration depth; zero for parts that do not overlap.
    #[getter]
    fn depth(&self) -> (f64, f64) {
        self.0.depth.into()
    }

    /// Lower and upper bound of the volume that both parts share; None if it was not asked for or is not
    /// known.
    #[getter]
    fn volume(&self) -> Option<(f64, f64)> {
        self.0.volume.map(Into::into)
    }

    /// A point of both parts, or the closest point of the first, shape (3,); with a volume, its centre of
    /// mass.
    #[getter]
    fn point<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        triple(py, self.0.point)
    }

    /// The rule that is broken, or that allows the overlap.
    #[getter]
    fn rule(&self) -> Option<&str> {
        self.0.rule.as_deref()
    }

    /// Whether the pair clashes: it overlaps without a rule that allows it, or breaks a rule.
    #[getter]
    fn broken(&self) -> bool {
        self.0.broken
    }

    /// Why something is not known.
    #[getter]
    fn note(&self) -> Option<&str> {
        self.0.note.as_deref()
    }

    fn __repr__(&self) -> String {
        format!("<Clash {} - {}: {}>", self.0.a, self.0.b, self.0.text())
    }
}

/// The pairs of a model that clash or are near each other.
#[pyclass(frozen, module = "lin_canny")]
pub(crate) struct Clashes {
    found: Found,
    notes: Vec<(String, String)>,
    unused: Vec<String>,
    skipped: Vec<String>,
}

#[pymethods]
impl Clashes {
    /// A Clash for each pair, in the order of the parts.
    #[getter]
    fn rows(&self) -> Vec<Clash> {
        self.found.rows.iter().cloned().map(Clash).collect()
    }

    /// The rows that clash.
    #[getter]
    fn broken(&self) -> Vec<Clash> {
        let broken = self.found.rows.iter().filter(|row| row.broken);
        broken.cloned().map(Clash).collect()
    }

    /// What was done to the mesh of a part, or why it has no inside: a dict by the names of parts.
    #[getter]
    fn notes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let notes = PyDict::new(py);
        for (part, note) in &self.notes {
            notes.set_item(part, note)?;
        }
        Ok(notes)
    }

    /// Rules that match no part: a name may be misspelt.
    #[getter]
    fn unused_rules(&self) -> Vec<String> {
        self.unused.clone()
    }

    /// What the files name and the model does not hold.
    #[getter]
    fn skipped(&self) -> Vec<String> {
        self.skipped.clone()
    }

    /// Number of pairs that were measured: their boxes are near each other, and no rule excludes them.
    #[getter]
    fn measured(&self) -> usize {
        self.found.measured
    }

    /// Number of pairs with boxes near each other that a rule excludes.
    #[getter]
    fn excluded(&self) -> usize {
        self.found.excluded
    }

    /// Returns a line of JSON for each row, as `lin-canny clash --jsonl` writes it.
    fn to_jsonl(&self) -> String {
        self.found.rows.iter().map(|row| row.to_json() + "\n").collect()
    }

    /// Returns a table with a header.
    fn to_csv(&self) -> String {
        to_csv(&self.found.rows)
    }

    /// Returns JUnit XML with a test case for each row.
    fn to_junit(&self) -> String {
        to_junit(&self.found.rows)
    }

    fn __repr__(&self) -> String {
        let broken = self.found.rows.iter().filter(|row| row.broken).count();
        format!("<Clashes: {broken} of {} pairs>", self.found.measured)
    }
}

/// Returns the model of a dict of parts, of a path, or of a list of paths.
fn model(inputs: &Bound<'_, PyAny>, options: &ModelOptions) -> PyResult<Model> {
    if let Ok(parts) = inputs.cast::<PyDict>() {
        let mut model = Model::new();
        for (name, part) in parts {
            let (geometry, pose): (Bound<'_, Geometry>, Pose) = match part.extract() {
                Ok(placed) => placed,
                Err(_) => (part.cast_into()?, Pose(Default::default())),
            };
            model.add(&name.extract::<String>()?, geometry.get().0.clone(), pose.0);
        }
        return Ok(model);
    }
    let files = match inputs.extract::<PathBuf>() {
        Ok(file) => vec![file],
        Err(_) => inputs.extract()?,
    };
    inputs.py().detach(|| Model::load(&files, options)).map_err(file_error)
}

/// Returns the rules of a dict, or of a file of JSON or TOML.
fn rules(rules: &Bound<'_, PyAny>) -> PyResult<Rules> {
    if rules.cast::<PyDict>().is_ok() {
        let text: String = rules.py().import("json")?.call_method1("dumps", (rules,))?.extract()?;
        return Rules::from_json(&text).map_err(refused);
    }
    let file: PathBuf = rules.extract()?;
    let text = std::fs::read_to_string(&file)
        .map_err(|error| file_error(format_args!("{}: cannot be read: {error}", file.display())))?;
    let read = match file.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml")) {
        true => Rules::from_toml(&text),
        false => Rules::from_json(&text),
    };
    read.map_err(|error| file_error(format_args!("{}: {error}", file.display())))
}

/// Returns the pairs of parts that overlap, touch, or are closer than they must be.
///
/// inputs is a path or a list of paths of mesh files, folders of them, cells and robots, as
/// `lin-canny clash` takes them, or a dict of names and parts: a Geometry, or a tuple of a Geometry and
/// a pose. rules is a dict or a file of JSON or TOML: margin, margins, paddings, exclude,
/// allowed_depth, allowed_volume, touching. Pairs at most within apart have a row. volume: whether rows
/// have the volume that both parts share. unit is "m", "mm" or "in": the unit of files without one, and
/// of all lengths. repair: whether holes of at most 1 % of the area of a part are closed. joints is a
/// dict of values of joints of robots, and srdf a file of link pairs that are excluded. progress is a
/// callable with the arguments done and total, or True for a bar of tqdm.
///
/// Raises FileError for an invalid file, and LinCannyError for invalid rules.
#[pyfunction]
#[pyo3(signature = (inputs, *, rules=None, within=0.0, volume=false, unit="m", repair=true, joints=None, srdf=None, progress=None))]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub(crate) fn clash(
    py: Python<'_>,
    inputs: &Bound<'_, PyAny>,
    rules: Option<&Bound<'_, PyAny>>,
    within: f64,
    volume: bool,
    unit: &str,
    repair: bool,
    joints: Option<std::collections::BTreeMap<String, f64>>,
    srdf: Option<PathBuf>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Clashes> {
    let unit = match unit {
        "m" => Unit::Metre,
        "mm" => Unit::Millimetre,
        "in" => Unit::Inch,
        other => {
            return Err(refused(format_args!(
                "unit is {other:?} (expected \"m\", \"mm\" or \"in\")"
            )));
        }
    };
    let options = ModelOptions::default().unit(unit).repair(repair).srdf(srdf);
    let model = model(inputs, &options.joints(joints.unwrap_or_default()))?;
    let rules = rules.map_or(Ok(Rules::default()), self::rules)?;
    let options = ClashOptions::default().within(within).volume(volume);
    let mut watch = Watch::new(py, progress)?;
    let found = py
        .detach(|| find(&model, &rules, &options, |now| watch.look(now)))
        .map_err(refused)?;
    watch.finish(py, found.is_complete)?;
    let names: Vec<&str> = model.parts().iter().map(|part| part.name.as_str()).collect();
    let notes = model.parts().iter();
    Ok(Clashes {
        found,
        notes: notes
            .filter_map(|part| Some((part.name.clone(), part.note.clone()?)))
            .collect(),
        unused: rules.unused(&names),
        skipped: model.skipped().iter().map(ToString::to_string).collect(),
    })
}

//! The SQL functions of a study.

mod answers;
mod certify;
mod certify_curve;
mod clearance;
mod prove_pair;
mod receipt;
mod separation;
mod signed_distance;

use std::hash::{Hash, Hasher};
use std::sync::Arc;

use datafusion::arrow::array::{ArrayRef, BooleanBuilder, StringBuilder};
use datafusion::arrow::datatypes::DataType;
use datafusion::common::exec_err;
use datafusion::error::Result;
use datafusion::execution::{FunctionRegistry, SessionState, SessionStateBuilder};
use datafusion::logical_expr::{
    ColumnarValue, Expr, ScalarFunctionArgs, ScalarUDF, ScalarUDFImpl, Signature, Volatility,
};
use datafusion::prelude::{SessionConfig, SessionContext};

use crate::error::RowError;
use crate::rows::{Vectors, configuration, vector_types};
use crate::study::Study;

/// The kind of a function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Question {
    Clearance,
    IsFree,
    Certify,
    CertifyCurve,
    Separation,
    SignedDistance,
    ProvePair,
    Receipt,
    Fault,
}

impl Question {
    const ALL: [Self; 9] = [
        Self::Clearance,
        Self::IsFree,
        Self::Certify,
        Self::CertifyCurve,
        Self::Separation,
        Self::SignedDistance,
        Self::ProvePair,
        Self::Receipt,
        Self::Fault,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Clearance => "clearance",
            Self::IsFree => "is_free",
            Self::Certify => "certify",
            Self::CertifyCurve => "certify_curve",
            Self::Separation => "separation",
            Self::SignedDistance => "signed_distance",
            Self::ProvePair => "prove_pair",
            Self::Receipt => "receipt",
            Self::Fault => "configuration_error",
        }
    }

    fn answer_type(self) -> DataType {
        match self {
            Self::Clearance => DataType::Struct(clearance::fields()),
            Self::Certify | Self::CertifyCurve => DataType::Struct(certify::fields()),
            Self::Separation => DataType::Struct(separation::fields()),
            Self::SignedDistance => DataType::Struct(signed_distance::fields()),
            Self::ProvePair => DataType::Struct(prove_pair::fields()),
            Self::Receipt => DataType::Struct(receipt::fields()),
            Self::IsFree => DataType::Boolean,
            Self::Fault => DataType::Utf8,
        }
    }
}

/// A function of a study.
///
/// Its name ends with the fingerprint of the study, and the plain name is an alias. If a plan
/// reaches a process with another robot, cell or options, its function does not exist there. So the
/// process returns an error instead of a result for the wrong cell.
#[derive(Clone)]
struct StudyFunction {
    study: Arc<Study>,
    question: Question,
    name: String,
    aliases: Vec<String>,
    signature: Signature,
}

impl StudyFunction {
    fn new(study: &Arc<Study>, question: Question) -> Self {
        Self {
            study: Arc::clone(study),
            question,
            name: format!("{}_{}", question.name(), study.fingerprint()),
            aliases: vec![question.name().into()],
            signature: Signature::user_defined(Volatility::Immutable),
        }
    }

    /// Returns the results of the rows of a batch.
    fn answer(&self, arguments: &[ArrayRef], rows: usize) -> Result<ArrayRef> {
        let study = &*self.study;
        if self.question != Question::Fault {
            study.count(rows);
        }
        match self.question {
            Question::Clearance => clearance::answer(study, arguments, rows),
            Question::IsFree => is_free(study, arguments, rows),
            Question::Certify => certify::answer(study, arguments, rows),
            Question::CertifyCurve => certify_curve::answer(study, arguments, rows),
            Question::Separation => separation::answer(study, arguments, rows),
            Question::SignedDistance => signed_distance::answer(study, arguments, rows),
            Question::ProvePair => prove_pair::answer(study, arguments, rows),
            Question::Receipt => receipt::answer(study, arguments, rows),
            Question::Fault => Ok(faults(study, arguments, rows)),
        }
    }
}

impl std::fmt::Debug for StudyFunction {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("StudyFunction")
            .field("name", &self.name)
            .finish_non_exhaustive()
    }
}

// The name identifies the kind, the robot, the cell and the options.
impl PartialEq for StudyFunction {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for StudyFunction {}

impl Hash for StudyFunction {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.name.hash(state);
    }
}

impl ScalarUDFImpl for StudyFunction {
    fn name(&self) -> &str {
        &self.name
    }

    fn aliases(&self) -> &[String] {
        &self.aliases
    }

    fn schema_name(&self, arguments: &[Expr]) -> Result<String> {
        let arguments: Vec<_> = arguments.iter().map(|a| a.schema_name().to_string()).collect();
        Ok(format!("{}({})", self.question.name(), arguments.join(",")))
    }

    fn signature(&self) -> &Signature {
        &self.signature
    }

    fn coerce_types(&self, types: &[DataType]) -> Result<Vec<DataType>> {
        let count = self.study.coordinates().len();
        match self.question {
            Question::Clearance | Question::IsFree | Question::Fault => {
                let names: Vec<_> = self.study.coordinates().iter().map(|c| c.name.as_str()).collect();
                vector_types(
                    types,
                    count,
                    &format!("{} ({})", self.question.name(), names.join(", ")),
                )
            }
            Question::Certify | Question::Receipt => certify::argument_types(self.question.name(), types, count),
            Question::CertifyCurve => certify_curve::argument_types(types),
            Question::Separation => separation::argument_types(types),
            Question::SignedDistance => signed_distance::argument_types(types),
            Question::ProvePair => prove_pair::argument_types(types, count),
        }
    }

    fn return_type(&self, _: &[DataType]) -> Result<DataType> {
        Ok(self.question.answer_type())
    }

    fn invoke_with_args(&self, called: ScalarFunctionArgs) -> Result<ColumnarValue> {
        let rows = called.number_rows;
        let arguments = called.args.iter().map(|a| a.to_array(rows));
        let arguments: Vec<_> = arguments.collect::<Result<_>>()?;
        Ok(ColumnarValue::Array(self.answer(&arguments, rows)?))
    }
}

impl Study {
    /// Returns the functions `clearance`, `is_free`, `certify`, `certify_curve`, `separation`,
    /// `signed_distance`, `prove_pair`, `receipt` and `configuration_error`, to be registered with a context or an
    /// executor.
    #[must_use]
    pub fn functions(self: &Arc<Self>) -> Vec<Arc<ScalarUDF>> {
        let function = |question| Arc::new(ScalarUDF::from(StudyFunction::new(self, question)));
        Question::ALL.map(function).into()
    }

    /// Registers the functions with a context.
    pub fn register(self: &Arc<Self>, context: &SessionContext) {
        for function in self.functions() {
            context.register_udf((*function).clone());
        }
    }

    /// Returns the state of a session with the functions, for schedulers and executors.
    ///
    /// # Errors
    /// Returns an error if the engine rejects a function.
    pub fn session_state(self: &Arc<Self>, config: SessionConfig) -> Result<SessionState> {
        let mut state = SessionStateBuilder::new()
            .with_config(config)
            .with_default_features()
            .build();
        for function in self.functions() {
            state.register_udf(function)?;
        }
        Ok(state)
    }

    /// Returns the result of a row; `None` for an invalid row of a lenient study.
    fn settled<T>(&self, row: usize, values: &[f64], answer: Result<T, RowError>) -> Result<Option<T>> {
        match answer {
            Ok(answer) => Ok(Some(answer)),
            Err(_) if self.options().lenient => Ok(None),
            Err(fault) => exec_err!("row {row} of its batch, {values:?}: {fault}"),
        }
    }
}

fn is_free(study: &Study, arguments: &[ArrayRef], rows: usize) -> Result<ArrayRef> {
    let (vectors, coordinates) = (Vectors::new(arguments), study.coordinates());
    let (mut answers, mut q) = (BooleanBuilder::with_capacity(rows), Vec::new());
    study
        .with_checker(|checker| {
            for row in 0..rows {
                let answer = configuration(&vectors, row, coordinates, &mut q).and_then(|()| {
                    checker.forget();
                    checker.is_free_at(&q).map_err(|e| RowError::Refused(e.to_string()))
                });
                answers.append_option(study.settled(row, &q, answer)?);
            }
            Ok::<(), datafusion::error::DataFusionError>(())
        })
        .map_err(outside)??;
    Ok(Arc::new(answers.finish()))
}

fn faults(study: &Study, arguments: &[ArrayRef], rows: usize) -> ArrayRef {
    let (vectors, coordinates) = (Vectors::new(arguments), study.coordinates());
    let (mut answers, mut q) = (StringBuilder::new(), Vec::new());
    for row in 0..rows {
        let fault = configuration(&vectors, row, coordinates, &mut q).err();
        answers.append_option(fault.map(|f| f.to_string()));
    }
    Arc::new(answers.finish())
}

/// Converts an error of this crate to an error of the engine.
fn outside(error: crate::StudyError) -> datafusion::error::DataFusionError {
    datafusion::error::DataFusionError::External(Box::new(error))
}

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
use datafusion::error::{DataFusionError, Result};
use datafusion::execution::{FunctionRegistry, SessionState, SessionStateBuilder};
use datafusion::logical_expr::{
    ColumnarValue, Expr, ScalarFunctionArgs, ScalarUDF, ScalarUDFImpl, Signature, Volatility,
};
use datafusion::prelude::{SessionConfig, SessionContext};
use lin_canny_plan::{Checker, JointTree};

use self::Returns::{Struct, Text, Truth};
use self::answers::{FieldList, fields_of};
use crate::error::RowError;
use crate::rows::{Vectors, configuration, vector_types};
use crate::study::Study;

/// What a function returns for a row.
#[derive(Clone, Copy)]
enum Returns {
    Struct(&'static FieldList),
    Truth,
    Text,
}

type ArgumentTypes = fn(&Study, &str, &[DataType]) -> Result<Vec<DataType>>;
type Answer = fn(&Study, &[ArrayRef], usize) -> Result<ArrayRef>;

/// A kind of function: its name, what it returns, the types of its arguments, and the results of the rows of
/// a batch.
#[derive(Clone, Copy)]
struct Question(&'static str, Returns, ArgumentTypes, Answer);

const FAULT: &str = "configuration_error";

#[rustfmt::skip] // a table
const QUESTIONS: [Question; 9] = [
    Question("clearance", Struct(clearance::FIELDS), configuration_types, clearance::answer),
    Question("is_free", Truth, configuration_types, is_free),
    Question("certify", Struct(certify::FIELDS), certify::argument_types, certify::answer),
    Question("certify_curve", Struct(certify::FIELDS), certify_curve::argument_types, certify_curve::answer),
    Question("separation", Struct(separation::FIELDS), separation::argument_types, separation::answer),
    Question("signed_distance", Struct(signed_distance::FIELDS), signed_distance::argument_types, signed_distance::answer),
    Question("prove_pair", Struct(prove_pair::FIELDS), prove_pair::argument_types, prove_pair::answer),
    Question("receipt", Struct(receipt::FIELDS), certify::argument_types, receipt::answer),
    Question(FAULT, Text, configuration_types, faults),
];

/// Accepts the numbers of a configuration, or one list of them.
fn configuration_types(study: &Study, function: &str, types: &[DataType]) -> Result<Vec<DataType>> {
    let names: Vec<_> = study.coordinates().iter().map(|c| c.name.as_str()).collect();
    vector_types(types, names.len(), &format!("{function} ({})", names.join(", ")))
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
    signature: Signature,
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

    fn schema_name(&self, arguments: &[Expr]) -> Result<String> {
        let arguments: Vec<_> = arguments.iter().map(|a| a.schema_name().to_string()).collect();
        Ok(format!("{}({})", self.question.0, arguments.join(",")))
    }

    fn signature(&self) -> &Signature {
        &self.signature
    }

    fn coerce_types(&self, types: &[DataType]) -> Result<Vec<DataType>> {
        (self.question.2)(&self.study, self.question.0, types)
    }

    fn return_type(&self, _: &[DataType]) -> Result<DataType> {
        Ok(match self.question.1 {
            Struct(fields) => DataType::Struct(fields_of(fields)),
            Truth => DataType::Boolean,
            Text => DataType::Utf8,
        })
    }

    fn invoke_with_args(&self, called: ScalarFunctionArgs) -> Result<ColumnarValue> {
        let rows = called.number_rows;
        let arguments: Vec<_> = called.args.iter().map(|a| a.to_array(rows)).collect::<Result<_>>()?;
        if self.question.0 != FAULT {
            self.study.count(rows);
        }
        Ok(ColumnarValue::Array((self.question.3)(&self.study, &arguments, rows)?))
    }
}

impl Study {
    /// Returns the functions `clearance`, `is_free`, `certify`, `certify_curve`, `separation`,
    /// `signed_distance`, `prove_pair`, `receipt` and `configuration_error`, to be registered with a
    /// context or an executor.
    #[must_use]
    pub fn functions(self: &Arc<Self>) -> Vec<Arc<ScalarUDF>> {
        let function = |question: Question| StudyFunction {
            study: Arc::clone(self),
            name: format!("{}_{}", question.0, self.fingerprint()),
            signature: Signature::user_defined(Volatility::Immutable),
            question,
        };
        QUESTIONS
            .map(|question| Arc::new(ScalarUDF::from(function(question)).with_aliases([question.0])))
            .into()
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
}

/// Answers the rows of a batch one after the other: `ask` reads the numbers of a row into an empty
/// list and returns its result, `push` takes it, or `None` for an invalid row of a lenient study.
fn each_row<T>(
    study: &Study,
    rows: usize,
    mut ask: impl FnMut(&mut Checker<JointTree>, usize, &mut Vec<f64>) -> Result<T, RowError>,
    mut push: impl FnMut(Option<T>),
) -> Result<()> {
    let mut numbers = Vec::new();
    let answered = study.with_checker(|checker| {
        for row in 0..rows {
            numbers.clear();
            match ask(checker, row, &mut numbers) {
                Ok(answer) => push(Some(answer)),
                Err(_) if study.options().lenient => push(None),
                Err(fault) => return exec_err!("row {row} of its batch, {numbers:?}: {fault}"),
            }
        }
        Ok(())
    });
    answered.map_err(|error| DataFusionError::External(Box::new(error)))?
}

fn is_free(study: &Study, arguments: &[ArrayRef], rows: usize) -> Result<ArrayRef> {
    let (vectors, coordinates) = (Vectors::new(arguments), study.coordinates());
    let mut answers = BooleanBuilder::with_capacity(rows);
    let ask = |checker: &mut Checker<JointTree>, row, q: &mut Vec<f64>| {
        configuration(&vectors, row, coordinates, q)?;
        checker.reset();
        checker.is_free_at(q).map_err(RowError::refused)
    };
    each_row(study, rows, ask, |answer| answers.append_option(answer))?;
    Ok(Arc::new(answers.finish()))
}

fn faults(study: &Study, arguments: &[ArrayRef], rows: usize) -> Result<ArrayRef> {
    let (vectors, coordinates) = (Vectors::new(arguments), study.coordinates());
    let (mut answers, mut q) = (StringBuilder::new(), Vec::new());
    for row in 0..rows {
        q.clear();
        let fault = configuration(&vectors, row, coordinates, &mut q).err();
        answers.append_option(fault.map(|f| f.to_string()));
    }
    Ok(Arc::new(answers.finish()))
}

//! Promise: every error bound is proved for the code as it stands.
//!
//! The kernels are transcribed in `proofs`. A transcription is the crate's kernel bit for bit (`transcribed`), and
//! the error that exact arithmetic derives from the transcription is at most the constant (`bounds`), with what underflow takes
//! (`underflow`).

mod bounds;
mod certificate;
mod closed_form;
mod curved;
mod directions;
mod gappa;
mod inputs;
mod lemmas;
mod range;
mod table;
mod transcribed;
mod underflow;
mod vectors;

//! What a call tells its caller besides the answer: progress, and events for a subscriber of
//! `tracing`.

pub(crate) mod log;
pub(crate) mod progress;

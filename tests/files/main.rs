//! Promise: a file reads back as it was written, and other input is rejected or harmless.

mod bytes;
mod flips;
mod hostile;
mod replay;
mod serde;
mod states;

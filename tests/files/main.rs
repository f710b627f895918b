//! Promise: what is written is read back as it was, and what is no file of ours is refused or does no harm.

mod bytes;
mod flips;
mod hostile;
mod replay;
mod serde;

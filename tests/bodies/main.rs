//! Promise: a body is what was given, and says of itself what is true.

mod boxes;
mod forms;
mod hulls;
mod kinds;
mod obj;
mod progress;
mod queries;
mod time;

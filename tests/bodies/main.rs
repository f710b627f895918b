//! Promise: a body equals its input, and its properties are correct.

mod boxes;
mod forms;
mod hulls;
mod kinds;
mod obj;
mod progress;
mod queries;
mod time;

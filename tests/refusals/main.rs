//! Promise: what is no pose and no call of a scene is refused by name. These tests need no other crate of the checkout.

mod poses;
mod scenes;

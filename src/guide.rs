#![doc = include_str!("../docs/guide.md")]

#[doc = include_str!("../docs/distances.md")]
#[doc = ""]
#[doc = include_str!("../images/regions.svg")]
pub mod distances {}

#[doc = include_str!("../docs/contacts.md")]
#[doc = ""]
#[doc = include_str!("../images/manifold.svg")]
pub mod contacts {}

#[doc = include_str!("../docs/meshes.md")]
#[doc = ""]
#[doc = include_str!("../images/geometry.svg")]
pub mod meshes {}

#[doc = include_str!("../docs/overlaps.md")]
#[doc = ""]
#[doc = include_str!("../images/overlap.svg")]
pub mod overlaps {}

#[doc = include_str!("../docs/clashes.md")]
pub mod clashes {}

#[doc = include_str!("../docs/curved_shapes.md")]
#[doc = ""]
#[doc = include_str!("../images/curved.svg")]
pub mod curved_shapes {}

#[doc = include_str!("../docs/time_of_impact.md")]
#[doc = ""]
#[doc = include_str!("../images/casts.svg")]
pub mod time_of_impact {}

#[doc = include_str!("../docs/robots.md")]
pub mod robots {}

#[doc = include_str!("../docs/accuracy.md")]
#[doc = ""]
#[doc = include_str!("../images/accuracy.svg")]
pub mod accuracy {}

#[doc = include_str!("../docs/replays.md")]
#[doc = ""]
#[doc = include_str!("../images/ulps.svg")]
pub mod replays {}

#[doc = include_str!("../docs/studies.md")]
#[doc = ""]
#[doc = include_str!("../images/clearance.svg")]
pub mod studies {}

#[doc = include_str!("../docs/features.md")]
pub mod features {}

//! The geometry rows of the stability catalog: cases in which methods of intersecting and leaving surfaces fail, and
//! the numbers which show that these do not. Each test is named after its row.
//!
//! ```text
//! cargo test --test all stability_shapes::
//! ```

mod boxes;
mod glass;
mod instances;
mod leaving;
mod planes;
mod returning;
mod spheres;
mod triangles;

/// The place of a body with a coordinate offset of 1. All three coordinates differ.
const OFFSET: abbe::math::DVec3 = abbe::math::DVec3::new(1.0, 0.7, -0.3);

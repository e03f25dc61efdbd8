//! The geometry rows of the stability catalog: where methods of intersecting and leaving surfaces fail, and the number
//! that shows that these do not. Each test is named after its row.
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

/// Where a body of coordinate offset 1 is put: all three coordinates differ.
const OFFSET: abbe::math::DVec3 = abbe::math::DVec3::new(1.0, 0.7, -0.3);

//! The geometry rows of the stability catalog: where methods of intersecting and leaving surfaces fail, and the number
//! that shows that these do not. Each test is named after its row.
//!
//! ```text
//! cargo test --test stability_shapes
//! ```

#[path = "support/bodies.rs"]
mod bodies;
#[path = "support/exact.rs"]
mod exact;
#[path = "support/random.rs"]
mod random;

#[path = "stability_shapes/boxes.rs"]
mod boxes;
#[path = "stability_shapes/glass.rs"]
mod glass;
#[path = "stability_shapes/instances.rs"]
mod instances;
#[path = "stability_shapes/leaving.rs"]
mod leaving;
#[path = "stability_shapes/planes.rs"]
mod planes;
#[path = "stability_shapes/returning.rs"]
mod returning;
#[path = "stability_shapes/spheres.rs"]
mod spheres;
#[path = "stability_shapes/triangles.rs"]
mod triangles;

/// Where a body of coordinate offset 1 is put: all three coordinates differ.
const OFFSET: abbe::math::DVec3 = abbe::math::DVec3::new(1.0, 0.7, -0.3);

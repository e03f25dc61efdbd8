//! Triangles are read from files as they were written, closed or open, stay in front under transforms, and are found by
//! their trees as a search through all of them would.
//!
//! ```text
//! cargo test --test all meshes::
//! ```

pub mod files;
mod gltf;
mod instances;
mod nearest;
mod pools;
mod trees;

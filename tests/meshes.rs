//! Triangles are read from files as they were written, closed or open. They keep their front under transforms, and
//! their trees find the same ones as a search through all of them.
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

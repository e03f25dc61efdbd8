//! Rough metals: directions compared with their pdf, the rows G4 to G6 of the stability catalog, and rendered images.
//!
//! ```text
//! cargo test --test all rough_metals::
//! ```

mod facets;
mod furnaces;
mod lamps;

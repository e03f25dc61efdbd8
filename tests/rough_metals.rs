//! Rough metals: directions against their density, the rows G4 to G6 of the stability catalog, and images of them.
//!
//! ```text
//! cargo test --test all rough_metals::
//! ```

mod facets;
mod furnaces;
mod lamps;

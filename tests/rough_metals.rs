//! Rough metals: directions against their density, the rows G4 to G6 of the stability catalog, and images of them.
//!
//! ```text
//! cargo test --test rough_metals
//! ```

#[path = "support/chi_squared.rs"]
mod chi_squared;
mod support;

mod rough_metals {
    mod facets;
    mod furnaces;
    mod lamps;
}

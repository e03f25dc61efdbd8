//! The optics rows of the stability catalog: Fresnel's equations where they cancel, directions that must not drift, and
//! lanes that disagree. Each test is named after its row.
//!
//! ```text
//! cargo test --test all stability_optics::
//! ```

mod directions;
mod films;
mod fresnel;
mod lanes_at_the_critical_angle;

//! Lanes that travel together must end where each would go alone, and light that is found in two ways must be counted
//! once. Dispersion, furnaces, nested bodies and direct light are compared with closed forms.
//!
//! ```text
//! cargo test --test all lanes::
//! ```

mod direct_light;
mod furnaces;
mod nested_bodies;
mod one_direction;
mod panes;
mod parting;
mod reflectances;
mod wavelengths;

//! Lanes that travel together must end where each would have gone alone, and light that is found in two ways must be
//! counted once: dispersion, furnaces, nested bodies and direct light against closed forms.
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

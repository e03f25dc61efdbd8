//! How far dispersion pulls colors apart, and how light is tinted on its way: rays of few colors over smooth surfaces.

mod caustic_separation;
mod color_separation;
mod color_walk;
mod route;
mod route_walk;
mod routes;
mod search;
mod separation;
mod targets;

pub use route::{ROUTES_NM, Route, RouteEvent, Step};
pub use routes::routes;
pub use separation::{COLORS_NM, Dispersion, dispersion};
pub use targets::SEEN_PIXELS;

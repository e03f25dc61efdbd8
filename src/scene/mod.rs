//! Floor 3: the world, with every reference resolved.
//!
//! `Scene<Curve>` is the scene as its file describes it, which the plan examines. `Scene<Table>` has the same surfaces,
//! with every spectrum sampled on the lanes, and is what the tracer reads.

mod camera;
mod checks;
mod compile;
mod content;
mod decode;
mod duration;
mod film;
mod foreign;
mod hit;
mod index;
mod normal_perturbation;
mod object;
mod render_text;
mod share;
mod source;
mod text;
mod web_color;

pub use camera::{Camera, Lens, PolarizingFilter, Projection, Seen};
pub use content::{NamedMaterial, Scene};
pub use duration::duration;
pub use film::FilmSettings;
pub use hit::{Hit, Primitive, RayEnds};
pub use normal_perturbation::{NormalPerturbation, PerturbationKind};
pub use object::{MaterialId, Object, Visibility};
pub use render_text::{AutoText, ModelText, PolarizationText, RenderText};
pub use share::share;
pub use source::{SETTINGS, Source};
pub use text::{Numbers, Rows};

//! A path from surface to surface: what it hits, how it continues, and what it carries about its light.

mod audit;
mod dye_excitation;
mod excitation;
mod interaction;
pub mod pass_through;
mod path;
mod polarization;
mod polarized;
mod reusing_stack;
mod rotation;
mod roulette;
mod row_change;
mod row_transfer;
mod rows;
pub mod shading;
mod walker;

pub use audit::Audit;
pub use dye_excitation::{DYE_BRANCH, DyeExcitation};
pub use excitation::Excitation;
pub use interaction::{Interaction, SurfaceHit, parts_lanes};
pub use pass_through::{Occluders, SeenThrough, VisibilityTest};
pub use path::{ObjectSet, Path, PathKind, ScatterSample};
pub use polarization::{FoundLight, PassThrough, Polarization, SeenPhoton};
pub use polarized::Polarized;
pub use rows::Rows;
pub use walker::{OutgoingPath, Walker};

//! A path from surface to surface: what it hits, how it continues, and what it carries about its light.

mod audit;
mod change;
mod excitation;
mod exciting;
mod interaction;
mod path;
mod polarization;
mod polarized;
mod rotation;
mod roulette;
mod row_transfer;
mod rows;
pub mod shading;
mod slots;
pub mod straight;
mod walker;

pub use audit::Audit;
pub use excitation::Excitation;
pub use exciting::{DYE_BRANCH, DyeExcitation};
pub use interaction::{Interaction, SurfaceHit, parts};
pub use path::{ObjectSet, Path, PathKind, ScatterSample};
pub use polarization::{FoundLight, PassThrough, Polarization, SeenPhoton};
pub use polarized::Polarized;
pub use rows::Rows;
pub use straight::{Occluders, SeenThrough, VisibilityTest};
pub use walker::{OutgoingPath, Walker};

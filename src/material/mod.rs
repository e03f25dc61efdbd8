//! Floor 2: how light leaves a surface.
//!
//! `Material<S>` is written once and read twice: with `S = Curve` it is the scene file's vocabulary, with `S = Table`
//! what the tracer reads; [`Material::map`] is the bridge. A material answers an [`Arrival`] with [`Branch`]es.

mod albedo_table;
mod arrival;
mod branch;
mod coat;
mod coated_boundary;
mod coating;
mod conductor;
mod degree;
mod dielectric;
mod diffuse;
mod emissive;
mod facet;
mod facets;
mod film_averages;
mod film_kernel;
mod fluorescence;
mod fresnel;
mod kinds;
mod last;
mod lobes;
mod mask;
mod mirror;
mod mix;
mod mueller;
mod part;
mod plastic;
mod plastic_film;
mod polarizer;
mod retarder;
mod rough_coating;
mod rough_dielectric;
mod rough_interface;
mod roughness;
mod scatter;
mod stack;
mod thin;

pub use arrival::{Arrival, Index};
pub use branch::{Branch, Incoming, Straight};
pub use coat::Coat;
pub use coating::{Coating, CoatingLayer};
pub use conductor::Conductor;
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use emissive::Emissive;
pub use facet::{Facet, Flow};
pub use facets::Facets;
pub use fluorescence::Fluorescence;
pub use fresnel::{Interface, conductor_reflectance, diffuse_transmittance, reflect, shared_transmittance};
pub use kinds::Material;
pub use lobes::Lobes;
pub use mask::Mask;
pub use mirror::Mirror;
pub use mix::Mix;
pub use mueller::{Base, Block, Mueller};
pub use part::Part;
pub use plastic::Plastic;
pub use polarizer::Polarizer;
pub use retarder::{PathDifference, Retardance, Retarder};
pub use rough_interface::{RoughInterface, Side, Sides, Way};
pub use roughness::{RoughReflection, RoughSurface, Roughness};
pub use scatter::Scatter;
pub use stack::{COHERENT_NM, Layer, MAX_LAYERS, PHASE_STEP, PolarizedShare, Stack, StackShares};
pub use thin::Thin;

//! Floor 2: how light leaves a surface.
//!
//! `Material<S>` is written once and used twice: with `S = Curve` it holds what the scene file says, with `S = Table`
//! what the tracer reads. [`Material::map`] converts one into the other. Given a [`ScatterContext`], a material returns
//! [`Branch`]es.

mod albedo_table;
mod branch;
mod coat;
mod coated_boundary;
mod coating;
mod conductor;
mod dielectric;
mod diffuse;
mod emissive;
mod facet;
mod facets;
mod film_averages;
mod film_kernel;
mod film_table;
mod fluorescence;
mod fresnel;
mod kinds;
mod lane_cache;
mod last_result;
mod lobes;
mod mask;
mod mirror;
mod mix;
mod mueller;
mod named_part;
mod plastic;
mod plastic_film;
mod polarization_degree;
mod polarizer;
mod refractions;
mod retarder;
mod rough_coating;
mod rough_dielectric;
mod rough_interface;
mod roughness;
mod scatter;
mod scatter_context;
mod stack;
mod thin;

pub use branch::{Branch, Incoming, Straight};
pub use coat::Coat;
pub use coating::{Coating, CoatingLayer};
pub use conductor::Conductor;
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use emissive::Emissive;
pub use facet::{BsdfValue, Facet};
pub use facets::Facets;
pub use fluorescence::Fluorescence;
pub use fresnel::{Interface, conductor_reflectance, diffuse_transmittance, reflect, shared_transmittance};
pub use kinds::Material;
pub use lobes::Lobes;
pub use mask::Mask;
pub use mirror::Mirror;
pub use mix::Mix;
pub use mueller::{Base, Block, Mueller};
pub use named_part::Part;
pub use plastic::Plastic;
pub use polarizer::Polarizer;
pub use retarder::{PathDifference, Retardance, Retarder};
pub use rough_interface::{FacetSample, FacetSides, RoughInterface, Side};
pub use roughness::{RoughReflection, RoughSurface, Roughness};
pub use scatter::Scatter;
pub use scatter_context::{Index, ScatterContext};
pub use stack::{COHERENT_NM, Layer, MAX_LAYERS, PHASE_STEP, PolarizedShare, Stack, StackShares};
pub use thin::Thin;

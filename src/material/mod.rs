//! Floor 2: how light leaves a surface.
//!
//! `Material<S>` is written once and read twice: with `S = Curve` it is the scene file's vocabulary, with `S = Table` what
//! the tracer reads; [`Material::map`] is the bridge. A material answers an [`Arrival`] with [`Branch`]es.

mod arrival;
mod by_cosine;
mod coat;
mod conductor;
mod degree;
mod dielectric;
mod diffuse;
mod emissive;
mod facet;
mod facets;
mod fresnel;
mod lobes;
mod mask;
mod mirror;
mod mix;
mod part;
mod plastic;
mod rough_dielectric;
mod rough_interface;
mod roughness;
mod straight;
mod thin;

pub use coat::Coat;
pub use conductor::Conductor;
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use emissive::Emissive;
pub use facet::{Facet, Flow};
pub use facets::Facets;
pub use fresnel::{Interface, conductor_reflectance, diffuse_transmittance, shared_transmittance};
pub use lobes::Lobes;
pub use mask::Mask;
pub use mirror::{Mirror, reflect};
pub use mix::Mix;
pub use part::Part;
pub use plastic::Plastic;
pub use rough_interface::{RoughInterface, Side, Sides, Way};
pub use roughness::{RoughReflection, RoughSurface, Roughness};
pub use straight::Straight;
pub use thin::Thin;

use crate::math::DVec3;
use crate::spectrum::{Curve, Draw, Lanes, Quantity, Table};

/// What a surface does with light.
#[derive(Clone, Debug)]
pub enum Material<S> {
    /// Scatters evenly in all directions.
    Diffuse(Diffuse<S>),
    /// Reflects like an ideal mirror.
    Mirror(Mirror<S>),
    /// Reflects like a metal, smooth or rough.
    Conductor(Conductor<S>),
    /// Reflects and refracts like glass.
    Dielectric(Dielectric<S>),
    /// Reflects and lets through like a window pane.
    Thin(Thin<S>),
    /// Shines and absorbs.
    Emissive(Emissive<S>),
    /// Scatters evenly under a clear coat.
    Plastic(Plastic<S>),
    /// Does what two other materials do, each on a share of the surface.
    Mix(Mix<S>),
    /// Does what another material does, and lets the rest straight through.
    Mask(Mask<S>),
}

/// What a material may know of the light that arrives, followed backward from the viewer.
#[derive(Clone, Copy, Debug)]
pub struct Arrival<'a, const N: usize> {
    /// Unit vector to the viewer.
    pub wo: DVec3,
    /// Unit normal by which the surface scatters, on the viewer's side: on smooth meshes not that of the triangle.
    pub normal: DVec3,
    /// Where the surface is met, for what varies over it.
    pub uv: [f64; 2],
    /// Which bin each lane reads.
    pub draw: &'a Draw<N>,
    /// The lanes on the ray, each 1, the others 0.
    pub present: Lanes<N>,
    /// Refractive index on the viewer's side, per lane.
    pub incident: [f64; N],
    /// Refractive index beyond the surface, per lane; the same as `incident` where no medium begins or ends.
    pub beyond: [f64; N],
    /// The index by which all rays are refracted on the viewer's side and beyond; none where that is each lane's own.
    pub direction_indices: [Option<f64>; 2],
    /// Lanes whose refracted rays lie within this angle of each other, in radians, go on as one.
    pub together: f64,
}

/// One way light came to the surface, and the lanes that came by it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branch<const N: usize> {
    /// Unit vector toward where the light came from.
    pub wi: DVec3,
    /// Factor on each lane's throughput; 0 for lanes that did not come this way.
    pub share: Lanes<N>,
    /// Density per steradian with which `wi` was drawn, none for the one direction a smooth surface allows.
    pub pdf: Option<f64>,
    /// Whether the light came from beyond the surface.
    pub crosses: bool,
    /// The part of `share` that only converts radiance between media, (n_incident / n_beyond)^2 of the ray's indices.
    pub eta_scale: f64,
    /// Largest degree |s - p| / (s + p), of any lane, to which unpolarized light that comes by this one direction leaves polarized;
    /// 0 where it does not, and of directions that were drawn: see [`Material::degree_of_scattered`].
    pub polarization: f32,
}

impl<S> Material<S> {
    /// The same material with every spectrum converted; `convert` is told what the spectrum describes.
    pub fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Material<T> {
        match self {
            Self::Diffuse(diffuse) => Material::Diffuse(diffuse.map(convert)),
            Self::Mirror(mirror) => Material::Mirror(mirror.map(convert)),
            Self::Thin(thin) => Material::Thin(thin.map(convert)),
            Self::Conductor(conductor) => Material::Conductor(conductor.map(convert)),
            Self::Dielectric(dielectric) => Material::Dielectric(dielectric.map(convert)),
            Self::Emissive(emissive) => Material::Emissive(emissive.map(convert)),
            Self::Plastic(plastic) => Material::Plastic(plastic.map(convert)),
            Self::Mix(mix) => Material::Mix(mix.map(convert)),
            Self::Mask(mask) => Material::Mask(mask.map(convert)),
        }
    }

    /// The index of the clear surface that light is reflected at or crosses, where it has one.
    pub fn clear_index(&self) -> Option<&S> {
        match self {
            Self::Dielectric(dielectric) => Some(&dielectric.index),
            Self::Thin(thin) => Some(&thin.index),
            Self::Plastic(plastic) => Some(&plastic.index),
            Self::Diffuse(_) | Self::Mirror(_) | Self::Conductor(_) | Self::Emissive(_) => None,
            Self::Mix(_) | Self::Mask(_) => None,
        }
    }

    /// The medium behind the surface's front, where there is one.
    pub fn medium(&self) -> Option<&Dielectric<S>> {
        match self {
            Self::Dielectric(dielectric) => Some(dielectric),
            _ => None,
        }
    }
}

impl Material<Curve> {
    /// Whether any of its spectra is different at different places of a surface.
    pub fn varies(&self) -> bool {
        let mut varies = false;
        self.map(&mut |_, curve| varies |= curve.varies());
        varies
    }
}

impl Material<Table> {
    /// The ways on, backward: adds them to `branches`. `u` are two random numbers.
    pub fn scatter<const N: usize>(&self, arrival: &Arrival<N>, u: [f64; 2], branches: &mut Vec<Branch<N>>) {
        match self {
            Self::Diffuse(diffuse) => branches.push(diffuse.scatter(arrival, u)),
            Self::Mirror(mirror) => branches.push(mirror.scatter(arrival)),
            Self::Thin(thin) => thin.scatter(arrival, branches),
            Self::Conductor(conductor) => branches.extend(conductor.scatter(arrival, u)),
            Self::Dielectric(dielectric) => dielectric.scatter(arrival, u, branches),
            Self::Emissive(_) => {}
            Self::Plastic(plastic) => plastic.scatter(arrival, u, branches),
            Self::Mix(mix) => mix.scatter(arrival, u, branches),
            Self::Mask(mask) => mask.scatter(arrival, u, branches),
        }
    }

    /// Whether lanes part that cross the surface.
    pub fn parts_lanes<const N: usize>(&self, arrival: &Arrival<N>) -> bool {
        match self {
            Self::Dielectric(dielectric) => dielectric.parts(arrival),
            Self::Diffuse(_) | Self::Mirror(_) | Self::Conductor(_) | Self::Thin(_) => arrival.parts(),
            Self::Emissive(_) | Self::Plastic(_) | Self::Mix(_) | Self::Mask(_) => arrival.parts(),
        }
    }

    /// BSDF times the cosine for light from the unit vector `wi`, and the density with which `scatter` draws `wi`.
    ///
    /// None where only a delta distribution could send light that way.
    pub fn evaluate<const N: usize>(&self, arrival: &Arrival<N>, wi: DVec3) -> Option<(Lanes<N>, f64)> {
        match self {
            Self::Diffuse(diffuse) => diffuse.evaluate(arrival, wi),
            Self::Conductor(conductor) => conductor.evaluate(arrival, wi),
            Self::Dielectric(dielectric) => dielectric.evaluate(arrival, wi),
            Self::Plastic(plastic) => plastic.evaluate(arrival, wi),
            Self::Mix(mix) => mix.evaluate(arrival, wi),
            Self::Mask(mask) => mask.evaluate(arrival, wi),
            Self::Mirror(_) | Self::Thin(_) | Self::Emissive(_) => None,
        }
    }
}

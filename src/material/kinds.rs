//! A material of any kind. A new kind needs a file of its own and a variant here; the compiler then lists every place
//! that has to handle it.

use super::{
    Branch, Coating, Conductor, Dielectric, Diffuse, Emissive, Fluorescence, Incoming, Lobes, Mask, Mirror, Mix,
    Mueller, Part, Plastic, Polarizer, Retarder, Roughness, Scatter, ScatterContext, Straight, Thin,
};
use crate::math::{DVec3, Transform};
use crate::spectrum::{Curve, Lanes, Quantity, Table};

/// What a surface does with light.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Material<S> {
    /// Scatters evenly in all directions.
    Diffuse(Diffuse<S>),
    /// Reflects like an ideal mirror.
    Mirror(Mirror<S>),
    /// Reflects like a metal, smooth or rough.
    Conductor(Conductor<S>),
    /// Reflects and refracts like glass.
    Dielectric(Dielectric<S>),
    /// Reflects and transmits like a window pane.
    Thin(Thin<S>),
    /// Emits and absorbs.
    Emissive(Emissive<S>),
    /// Scatters evenly under a clear coat.
    Plastic(Plastic<S>),
    /// Transmits light that is polarized along an axis.
    Polarizer(Polarizer),
    /// Shifts the phase of light that is polarized along an axis.
    Retarder(Retarder),
    /// Combines two other materials, each on a share of the surface.
    Mix(Mix<S, Self>),
    /// Scatters like another material where it is opaque, and lets the rest of the light pass straight through.
    Mask(Mask<S, Self>),
}

impl<S> Material<S> {
    /// Returns the material with every spectrum converted; `convert` gets the quantity that the spectrum describes.
    pub fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Material<T> {
        match self {
            Self::Diffuse(diffuse) => Material::Diffuse(diffuse.map(convert)),
            Self::Mirror(mirror) => Material::Mirror(mirror.map(convert)),
            Self::Thin(thin) => Material::Thin(thin.map(convert)),
            Self::Conductor(conductor) => Material::Conductor(conductor.map(convert)),
            Self::Dielectric(dielectric) => Material::Dielectric(dielectric.map(convert)),
            Self::Emissive(emissive) => Material::Emissive(emissive.map(convert)),
            Self::Plastic(plastic) => Material::Plastic(plastic.map(convert)),
            Self::Polarizer(polarizer) => Material::Polarizer(*polarizer),
            Self::Retarder(retarder) => Material::Retarder(*retarder),
            Self::Mix(Mix { materials, amount }) => {
                let amount = convert(Quantity::Share, amount);
                let materials = materials.each_ref().map(|part| part.map(|material| material.map(convert)));
                Material::Mix(Mix { materials, amount })
            }
            Self::Mask(Mask { material, opacity }) => {
                let opacity = convert(Quantity::Share, opacity);
                Material::Mask(Mask { material: material.map(|material| material.map(convert)), opacity })
            }
        }
    }

    /// Returns the index of the clear surface that reflects and transmits light, if there is one.
    pub fn clear_index(&self) -> Option<&S> {
        match self {
            Self::Dielectric(dielectric) => Some(&dielectric.index),
            Self::Thin(thin) => thin.clear_index(),
            Self::Plastic(plastic) => Some(&plastic.index),
            Self::Diffuse(_) | Self::Mirror(_) | Self::Conductor(_) | Self::Emissive(_) => None,
            Self::Mix(_) | Self::Mask(_) | Self::Polarizer(_) | Self::Retarder(_) => None,
        }
    }

    /// Returns the medium behind the surface's front, if there is one.
    pub fn medium(&self) -> Option<&Dielectric<S>> {
        match self {
            Self::Dielectric(dielectric) => Some(dielectric),
            _ => None,
        }
    }

    /// Returns its lobes, including those of the materials that it is made of.
    #[inline]
    pub fn lobes(&self) -> Lobes {
        match self {
            Self::Diffuse(_) => Lobes::DIFFUSE_REFLECTION,
            Self::Mirror(_) => Lobes::DELTA_REFLECTION,
            Self::Thin(_) => Lobes::DELTA,
            Self::Conductor(conductor) => conductor.roughness.reflection(),
            Self::Dielectric(dielectric) => dielectric.roughness.of_interface(),
            Self::Emissive(_) | Self::Polarizer(_) | Self::Retarder(_) => Lobes::NONE,
            Self::Plastic(plastic) => Lobes::DIFFUSE_REFLECTION.union(plastic.coat.roughness().reflection()),
            Self::Mix(_) | Self::Mask(_) => {
                self.parts().iter().map(|part| part.material().lobes()).fold(Lobes::NONE, Lobes::union)
            }
        }
    }

    /// Returns whether any part of it is smooth, so that it mirrors or refracts. Rough glass is not smooth, although
    /// light passes straight through it between equal indices.
    pub fn is_smooth_somewhere(&self) -> bool {
        match self {
            Self::Dielectric(dielectric) => dielectric.roughness.is_smooth(),
            Self::Mix(_) | Self::Mask(_) => self.parts().iter().any(|part| part.material().is_smooth_somewhere()),
            _ => self.lobes().has_delta(),
        }
    }

    /// Returns whether its BSDF is exactly reciprocal, apart from the change of radiance between media.
    pub fn is_reciprocal(&self) -> bool {
        match self {
            Self::Diffuse(_) => true,
            Self::Dielectric(dielectric) => dielectric.coating.is_none(),
            _ => false,
        }
    }

    /// Returns the smallest solid angle in steradians into which any part of it spreads light that a mirror would send
    /// in one direction, or 0 if any part is smooth.
    pub fn spread(&self) -> f64 {
        let of_part = |part: &Self| match part.roughness() {
            _ if part.is_smooth_somewhere() => 0.0,
            Some(roughness) => roughness.spread(),
            None => f64::INFINITY,
        };
        self.with_parts().into_iter().map(of_part).fold(f64::INFINITY, f64::min)
    }

    /// Returns its roughness, if it can be rough.
    pub fn roughness(&self) -> Option<&Roughness> {
        match self {
            Self::Conductor(conductor) => Some(&conductor.roughness),
            Self::Dielectric(dielectric) => Some(&dielectric.roughness),
            Self::Plastic(plastic) => Some(plastic.coat.roughness()),
            Self::Diffuse(_) | Self::Mirror(_) | Self::Thin(_) | Self::Emissive(_) => None,
            Self::Mix(_) | Self::Mask(_) | Self::Polarizer(_) | Self::Retarder(_) => None,
        }
    }

    /// Returns whether light can pass straight through it: through holes, or through a pane that bends nothing.
    pub fn is_see_through(&self) -> bool {
        matches!(self, Self::Mask(_) | Self::Thin(_) | Self::Polarizer(_) | Self::Retarder(_))
            || self.parts().iter().any(|part| part.material().is_see_through())
    }

    /// Returns the materials that it is made of.
    pub fn parts(&self) -> &[Part<Self>] {
        match self {
            Self::Mix(mix) => &mix.materials,
            Self::Mask(mask) => std::slice::from_ref(&mask.material),
            Self::Diffuse(_) | Self::Mirror(_) | Self::Conductor(_) | Self::Dielectric(_) => &[],
            Self::Thin(_) | Self::Emissive(_) | Self::Plastic(_) => &[],
            Self::Polarizer(_) | Self::Retarder(_) => &[],
        }
    }

    /// Returns the material and, recursively, all materials that it is made of.
    pub fn with_parts(&self) -> Vec<&Self> {
        let parts = self.parts().iter().flat_map(|part| part.material().with_parts());
        std::iter::once(self).chain(parts).collect()
    }

    /// Returns the axis by which it polarizes light, if it has one of its own.
    pub fn axis(&self) -> Option<DVec3> {
        match self {
            Self::Polarizer(polarizer) => Some(polarizer.axis),
            Self::Retarder(retarder) => Some(retarder.axis),
            _ => self.parts().iter().find_map(|part| part.material().axis()),
        }
    }

    /// Returns whether it polarizes light by an axis of its own.
    pub fn has_axis(&self) -> bool {
        self.axis().is_some()
    }

    /// Returns the dyes in it and in all materials that it is made of, in the order of `with_parts`.
    pub fn dyes(&self) -> Vec<&Fluorescence<S>> {
        let mut dyes = Vec::new();
        for material in self.with_parts() {
            if let Self::Diffuse(Diffuse { fluorescence: Some(dye), .. }) = material {
                dyes.push(dye);
            }
        }
        dyes
    }

    /// Returns whether a material of this name is part of it.
    pub fn is_made_of(&self, name: &str) -> bool {
        self.parts().iter().any(|part| part.name == name || part.material().is_made_of(name))
    }
}

impl Material<Curve> {
    /// Returns whether it is matte and reflects no light.
    pub fn is_black(&self) -> bool {
        matches!(self, Self::Diffuse(matte) if matte.reflectance.is_dark() && matte.fluorescence.is_none())
    }

    /// Returns the material with its axes transformed together with the object that it lies on.
    #[must_use]
    pub fn turned(&self, map: &Transform) -> Self {
        match self {
            Self::Polarizer(sheet) => Self::Polarizer(Polarizer { axis: map.vector(sheet.axis), ..*sheet }),
            Self::Retarder(sheet) => Self::Retarder(Retarder { axis: map.vector(sheet.axis), ..*sheet }),
            Self::Mask(Mask { material, opacity }) => {
                Self::Mask(Mask { material: material.map(|material| material.turned(map)), opacity: opacity.clone() })
            }
            other => other.clone(),
        }
    }

    /// Returns whether any of its spectra varies over the surface.
    pub fn varies(&self) -> bool {
        let mut varies = false;
        self.map(&mut |_, curve| varies |= curve.varies());
        varies
    }
}

impl Material<Table> {
    /// Returns whether it is a smooth clear surface without absorption, which reflects or transmits all light.
    pub fn absorbs_nothing(&self) -> bool {
        match self {
            Self::Dielectric(Dielectric { roughness, reflectance, transmittance, coating, .. }) => {
                let is_clear = coating.as_ref().is_none_or(Coating::is_clear);
                is_clear && roughness.is_smooth() && reflectance.is_one() && transmittance.is_one()
            }
            Self::Thin(Thin::Pane { transmittance, .. }) => transmittance.is_one(),
            Self::Thin(Thin::Film(film)) => film.is_clear(),
            Self::Retarder(_) => true,
            Self::Diffuse(_) | Self::Mirror(_) | Self::Conductor(_) | Self::Polarizer(_) => false,
            Self::Emissive(_) | Self::Plastic(_) | Self::Mix(_) | Self::Mask(_) => false,
        }
    }

    /// Appends the share of the arriving light that meets each of its dyes, in the order of `dyes`. `share` is what
    /// arrives at this material.
    pub fn shares_of_dyes<const N: usize>(
        &self,
        context: &ScatterContext<N>,
        share: Lanes<N>,
        shares: &mut Vec<Lanes<N>>,
    ) {
        match self {
            Self::Diffuse(diffuse) => shares.extend(diffuse.fluorescence.as_ref().map(|_| share)),
            Self::Mix(mix) => {
                let parts = mix.parts(context);
                parts.into_iter().for_each(|(part, of_part)| part.shares_of_dyes(context, share * of_part, shares));
            }
            Self::Mask(mask) => {
                let opacity = context.read(&mask.opacity);
                mask.material.material().shares_of_dyes(context, share * opacity, shares);
            }
            Self::Mirror(_) | Self::Conductor(_) | Self::Dielectric(_) | Self::Thin(_) => {}
            Self::Emissive(_) | Self::Plastic(_) | Self::Polarizer(_) | Self::Retarder(_) => {}
        }
    }

    /// Returns whether none of its lobes is requested.
    #[inline(always)]
    fn is_not_requested<const N: usize>(&self, context: &ScatterContext<N>) -> bool {
        context.lobes != Lobes::ALL && !self.lobes().intersects(context.lobes)
    }

    /// Returns whether lanes part when they cross the surface.
    pub fn parts_lanes<const N: usize>(&self, context: &ScatterContext<N>) -> bool {
        match self {
            Self::Dielectric(dielectric) => dielectric.parts(context),
            Self::Diffuse(_) | Self::Mirror(_) | Self::Conductor(_) | Self::Thin(_) => context.parts(),
            Self::Emissive(_) | Self::Plastic(_) | Self::Mix(_) | Self::Mask(_) => context.parts(),
            Self::Polarizer(_) | Self::Retarder(_) => false,
        }
    }
}

impl Scatter for Material<Table> {
    fn lobes(&self) -> Lobes {
        self.lobes()
    }

    fn scatter<const N: usize>(&self, context: &ScatterContext<N>, u: [f64; 2], branches: &mut Vec<Branch<N>>) {
        match self {
            _ if self.is_not_requested(context) => {}
            Self::Diffuse(diffuse) => branches.push(diffuse.scatter(context, u)),
            Self::Mirror(mirror) => branches.push(mirror.scatter(context)),
            Self::Thin(thin) => thin.scatter(context, branches),
            Self::Conductor(conductor) => branches.extend(conductor.scatter(context, u)),
            Self::Dielectric(dielectric) => dielectric.scatter(context, u, branches),
            Self::Emissive(_) | Self::Polarizer(_) | Self::Retarder(_) => {}
            Self::Plastic(plastic) => plastic.scatter(context, u, branches),
            Self::Mix(mix) => mix.scatter(context, u, branches),
            Self::Mask(mask) => mask.scatter(context, u, branches),
        }
    }

    fn evaluate<const N: usize>(&self, context: &ScatterContext<N>, wi: DVec3) -> Option<(Lanes<N>, f64)> {
        match self {
            _ if self.is_not_requested(context) => None,
            Self::Diffuse(diffuse) => diffuse.evaluate(context, wi),
            Self::Conductor(conductor) => conductor.evaluate(context, wi),
            Self::Dielectric(dielectric) => dielectric.evaluate(context, wi),
            Self::Plastic(plastic) => plastic.evaluate(context, wi),
            Self::Mix(mix) => mix.evaluate(context, wi),
            Self::Mask(mask) => mask.evaluate(context, wi),
            Self::Mirror(_) | Self::Thin(_) | Self::Emissive(_) | Self::Polarizer(_) | Self::Retarder(_) => None,
        }
    }

    fn diffuse_part<const N: usize>(&self, context: &ScatterContext<N>, wi: DVec3) -> Lanes<N> {
        match self {
            Self::Diffuse(diffuse) => diffuse.evaluate(context, wi).map_or(Lanes::ZERO, |(light, _)| light),
            Self::Plastic(plastic) => plastic.diffuse_part(context, wi),
            Self::Mix(mix) => mix.diffuse_part(context, wi),
            Self::Mask(mask) => mask.diffuse_part(context, wi),
            Self::Mirror(_) | Self::Conductor(_) | Self::Dielectric(_) => Lanes::ZERO,
            Self::Thin(_) | Self::Emissive(_) | Self::Polarizer(_) | Self::Retarder(_) => Lanes::ZERO,
        }
    }

    fn straight<const N: usize>(&self, context: &ScatterContext<N>) -> Option<Straight<N>> {
        match self {
            Self::Thin(thin) => Some(thin.straight(context)),
            Self::Polarizer(polarizer) => Some(polarizer.straight()),
            Self::Retarder(retarder) => Some(retarder.straight()),
            Self::Mix(mix) => mix.straight(context),
            Self::Mask(mask) => Some(mask.straight(context)),
            Self::Diffuse(_) | Self::Mirror(_) | Self::Conductor(_) | Self::Dielectric(_) => None,
            Self::Emissive(_) | Self::Plastic(_) => None,
        }
    }

    fn degree_of_scattered<const N: usize>(&self, context: &ScatterContext<N>, wi: DVec3) -> f32 {
        match self {
            Self::Conductor(conductor) => conductor.degree_of_scattered(context, wi),
            Self::Dielectric(dielectric) => dielectric.degree_of_scattered(context, wi),
            Self::Plastic(plastic) => plastic.degree_of_scattered(context, wi),
            Self::Mix(mix) => mix.degree_of_scattered(context, wi),
            Self::Mask(mask) => {
                let material = mask.material.material();
                if material.lobes().is_wide() { material.degree_of_scattered(context, wi) } else { 0.0 }
            }
            Self::Diffuse(_) | Self::Mirror(_) | Self::Thin(_) | Self::Emissive(_) => 0.0,
            Self::Polarizer(_) | Self::Retarder(_) => 0.0,
        }
    }

    fn mueller<const N: usize>(&self, context: &ScatterContext<N>, incoming: Incoming, mueller: &mut Mueller<N>) {
        match self {
            _ if self.is_not_requested(context) => *mueller = Mueller::NONE,
            Self::Mirror(mirror) if incoming.single => mirror.mueller(context, mueller),
            Self::Thin(thin) if incoming.single => thin.mueller(context, false, incoming.lanes, mueller),
            Self::Conductor(conductor) => conductor.mueller(context, incoming, mueller),
            Self::Dielectric(dielectric) => dielectric.mueller(context, incoming, mueller),
            Self::Plastic(plastic) => plastic.mueller(context, incoming, mueller),
            Self::Mix(mix) => mix.mueller(context, incoming, mueller),
            Self::Mask(mask) => mask.mueller(context, incoming, mueller),
            Self::Diffuse(_) | Self::Emissive(_) | Self::Mirror(_) | Self::Thin(_) => *mueller = Mueller::NONE,
            Self::Polarizer(_) | Self::Retarder(_) => *mueller = Mueller::NONE,
        }
    }

    fn mueller_of_straight<const N: usize>(&self, context: &ScatterContext<N>, mueller: &mut Mueller<N>) {
        match self {
            Self::Thin(thin) => thin.mueller(context, true, context.present.nonzero(), mueller),
            Self::Polarizer(polarizer) => polarizer.mueller(context, mueller),
            Self::Retarder(retarder) => retarder.mueller(context, mueller),
            Self::Mix(mix) => mix.mueller_of_straight(context, mueller),
            Self::Mask(mask) => mask.mueller_of_straight(context, mueller),
            Self::Diffuse(_) | Self::Mirror(_) | Self::Conductor(_) | Self::Dielectric(_) => *mueller = Mueller::NONE,
            Self::Emissive(_) | Self::Plastic(_) => *mueller = Mueller::NONE,
        }
    }
}

//! A bound on how much polarization, which is not traced, may change the light that is seen.
//!
//! A surface that favors one polarization by the degree d multiplies intensity by 1 + d p, where p is the component of
//! the light's polarization in the surface's frame. If the frames agree, p becomes (p + d) / (1 + d p). Whatever the
//! frames, retardances and signs are, intensity changes at most by the product of 1 + P |d|, where P follows the same
//! rule with |d|. Degrees add like velocities in relativity, and the worst case is that all of them add up. Light
//! leaves lamps and the sky unpolarized, and also surfaces that scatter it diffusely.

use super::interaction::Interaction;
use super::polarization::{FoundLight, Polarization, SeenPhoton};
use super::reusing_stack::Slots;
use crate::light::Light;
use crate::material::{Branch, Material, Scatter, ScatterContext, Straight};
use crate::math::{DVec3, Ray};
use crate::spectrum::{Lanes, Table};
use crate::trace::World;

/// The largest possible degree of a path's polarization, and the largest factor by which it may have changed the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polarized {
    degree: f32,
    growth: f32,
}

impl Polarized {
    /// The state at a camera that sees all polarizations alike.
    pub const NONE: Self = Self { degree: 0.0, growth: 1.0 };

    /// Returns the state after a surface of a degree, 0 to 1.
    pub fn after_surface(self, degree: f32) -> Self {
        if degree == 0.0 {
            return self;
        }
        let factor = 1.0 + self.degree * degree;
        let growth = (self.growth * factor).min(f32::MAX);
        Self { degree: ((self.degree + degree) / factor).min(1.0), growth }
    }

    /// Returns the state after a path segment that polarizes unpolarized light like `other`.
    pub fn followed_by(self, other: Self) -> Self {
        let growth = (other.growth * self.growth).min(f32::MAX);
        Self { growth, ..self }.after_surface(other.degree)
    }

    /// Returns the state after a material has scattered light in a direction that was sampled from a density.
    pub fn after_scattering<const N: usize>(
        self,
        material: &Material<Table>,
        context: &ScatterContext<N>,
        wi: DVec3,
    ) -> Self {
        if let Material::Diffuse(_) = material {
            return Self { degree: 0.0, ..self };
        }
        let degree = material.degree_of_scattered(context, wi);
        let scattered = self.after_surface(degree);
        if material.lobes().is_diffuse() { Self { degree, ..scattered } } else { scattered }
    }

    /// Returns the state with light from the direction `wi`, polarized on its way, that a surface scatters.
    pub fn joined_at<const N: usize>(
        self,
        material: &Material<Table>,
        context: &ScatterContext<N>,
        wi: DVec3,
        on_its_way: Self,
    ) -> Self {
        self.after_scattering(material, context, wi).followed_by(on_its_way)
    }

    /// Returns whether polarization may have changed anything, or may do so at the next surface.
    pub fn may_matter(self) -> bool {
        self.degree != 0.0 || self.growth != 1.0
    }

    /// Returns the share by which polarization may have changed the light.
    pub fn change(self) -> f64 {
        f64::from(self.growth) - 1.0
    }
}

impl<const N: usize> Polarization<N> for Polarized {
    type Stored = Self;
    type RowTransfer = ();

    fn at_camera(_: &World, _: &Ray) -> Self {
        Self::NONE
    }

    fn at_light(_: &World, _: &Ray) -> Self {
        Self::NONE
    }

    #[inline]
    fn pass(self, _: &Material<Table>, _: &ScatterContext<N>, straight: &mut Straight<N>) -> Self {
        self.after_surface(straight.polarization)
    }

    #[inline(always)]
    fn split(&self, _: &Interaction<N>, _: &mut [Branch<N>], _: &mut Slots<()>) {}

    #[inline(always)]
    fn follow(&mut self, before: &Self, interaction: &Interaction<N>, branch: &Branch<N>, _: Option<&()>) {
        *self = match branch.pdf {
            Some(_) => before.after_scattering(interaction.material, &interaction.context, branch.wi),
            None => before.after_surface(branch.polarization),
        };
    }

    #[inline(always)]
    fn toward_light(&self, _: &Interaction<N>, _: DVec3, _: &mut Lanes<N>) -> Self {
        Self::NONE
    }

    fn change_along(
        &self,
        interaction: &Interaction<N>,
        wi: DVec3,
        on_its_way: &Self,
        light: &FoundLight<N, Self>,
    ) -> f64 {
        if !self.may_matter() && !light.world.has_see_through() {
            return 0.0;
        }
        let change = self.joined_at(interaction.material, &interaction.context, wi, *on_its_way).change();
        if change == 0.0 { 0.0 } else { change * light.world.amount(light.rgb) }
    }

    fn change_of_hit(&self, light: &FoundLight<N, Self>) -> f64 {
        if self.may_matter() { self.change() * light.world.amount(light.rgb) } else { 0.0 }
    }

    fn for_excitation(&self) -> Self {
        Self { degree: 0.0, ..*self }
    }

    #[inline(always)]
    fn at_polarized_light(&self, _: &Light<Table>, _: DVec3, _: &mut Lanes<N>) -> Option<Self> {
        None
    }

    #[inline(always)]
    fn after_forward_scattering(&self, _: &Interaction<N>, _: DVec3, _: &mut Lanes<N>) -> Self {
        Self::NONE
    }

    fn see(
        &self,
        interaction: &Interaction<N>,
        viewed: &ScatterContext<N>,
        on_its_way: &Self,
        _: &World,
        _: &Ray,
    ) -> SeenPhoton<N> {
        let change = on_its_way.joined_at(interaction.material, viewed, interaction.context.wo, *self).change() as f32;
        SeenPhoton { change: Lanes([change; N]), factor: None, stokes: None }
    }

    fn to_stored(&self, _: &Interaction<N>) -> Self {
        *self
    }

    #[inline(always)]
    fn join(&self, _: &Interaction<N>, _: DVec3, _: &Self, _: &mut Lanes<N>) -> Self {
        Self::NONE
    }

    fn change_of_joined(&self, interaction: &Interaction<N>, wi: DVec3, photon: &Self, _: &Self, _: Lanes<N>) -> f64 {
        self.joined_at(interaction.material, &interaction.context, wi, *photon).change()
    }

    fn convert_stored(photon: &Self, _: impl Fn(Lanes<N>) -> Lanes<N>) -> Self {
        *photon
    }

    #[inline(always)]
    fn stokes(&self) -> Option<[Lanes<N>; 3]> {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::Polarized;

    #[test]
    fn degrees_add_as_velocities_do() {
        let twice = Polarized::NONE.after_surface(0.5).after_surface(0.0).after_surface(0.5);
        assert_eq!(twice, Polarized { degree: 0.8, growth: 1.25 });
        let brewster = Polarized::NONE.after_surface(1.0).after_surface(0.0).after_surface(1.0);
        assert_eq!((brewster.degree, brewster.change()), (1.0, 1.0));
        assert!((0..1000).fold(Polarized::NONE, |path, _| path.after_surface(1.0)).change().is_finite());
    }
}

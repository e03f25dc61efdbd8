//! What polarization, which is not traced, may change of the light seen.
//!
//! A surface that favors one polarization by the degree d multiplies intensity by 1 + d p, where p is the part of the light's
//! polarization in its own frame, and p becomes (p + d) / (1 + d p) where the frames agree. Whatever the frames, retardances
//! and signs are, intensity is thus changed at most by the product of 1 + P |d|, with P that follows the same rule from
//! |d| alone: degrees add as velocities do, and ones that add all the way are the worst. Light leaves lamps and the sky
//! unpolarized, and surfaces that scatter it diffusely.

use std::cell::Cell;

use super::World;
use super::direct::add;
use super::path::Path;
use super::path_tracer::PathTracer;
use crate::material::{Arrival, Material};
use crate::math::DVec3;
use crate::spectrum::Table;

/// How far a path's light may be polarized, and by what factor that may have changed it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Polarized {
    degree: f32,
    growth: f32,
}

impl Polarized {
    /// Of a camera that sees all polarizations alike.
    pub(super) const NOT: Self = Self { degree: 0.0, growth: 1.0 };

    /// After a surface of a degree, 0 to 1.
    pub(super) fn after(self, degree: f32) -> Self {
        if degree == 0.0 {
            return self;
        }
        let factor = 1.0 + self.degree * degree;
        let growth = (self.growth * factor).min(f32::MAX);
        Self { degree: ((self.degree + degree) / factor).min(1.0), growth }
    }

    /// After a way on which unpolarized light is polarized as `other` says.
    pub(super) fn joined(self, other: Self) -> Self {
        let growth = (other.growth * self.growth).min(f32::MAX);
        Self { growth, ..self }.after(other.degree)
    }

    /// After light was scattered by a material in a direction that it drew from a density.
    pub(super) fn scattered<const N: usize>(self, material: &Material<Table>, arrival: &Arrival<N>, wi: DVec3) -> Self {
        if let Material::Diffuse(_) = material {
            return Self { degree: 0.0, ..self };
        }
        let degree = material.degree_of_scattered(arrival, wi);
        let after = self.after(degree);
        if material.is_diffuse() { Self { degree, ..after } } else { after }
    }

    /// With light that comes to a surface that scatters it, in a direction and polarized on its way there.
    pub(super) fn brought<const N: usize>(
        self,
        (material, arrival): (&Material<Table>, &Arrival<N>),
        (wi, on_its_way): (DVec3, Self),
    ) -> Self {
        self.scattered(material, arrival, wi).joined(on_its_way)
    }

    /// Whether there is anything that polarization may have changed or may change at the next surface.
    pub(super) fn is_any(self) -> bool {
        self.degree != 0.0 || self.growth != 1.0
    }

    /// The share of the light by which polarization may have changed it.
    pub(super) fn change(self) -> f64 {
        f64::from(self.growth) - 1.0
    }
}

/// How much light there is in a film color: X + Y + Z.
pub(super) fn amount(world: &World, rgb: [f64; 3]) -> f64 {
    (0..3).map(|channel| rgb[channel] * world.xyz_of_channel[channel]).sum::<f64>().abs()
}

/// Light that lights send straight to a surface at the end of a polarized path.
pub(super) struct Lit {
    pub(super) polarized: Polarized,
    /// What polarization may have changed so far.
    pub(super) moved: Cell<f64>,
}

impl Lit {
    /// Counts light of a film color that came from a direction, polarized on its way there.
    #[cold]
    #[inline(never)]
    pub(super) fn count<const N: usize>(
        &self,
        world: &World,
        surface: (&Material<Table>, &Arrival<N>),
        coming: (DVec3, Polarized),
        rgb: [f64; 3],
    ) {
        let change = self.polarized.brought(surface, coming).change();
        if change != 0.0 {
            self.moved.set(self.moved.get() + change * amount(world, rgb));
        }
    }
}

impl<const N: usize> PathTracer<'_, N> {
    /// Adds light of the sensor that came by a path, and what polarization may have changed of it.
    pub(super) fn receive(&mut self, path: &Path<N>, light: [f64; 3], sum: &mut [f64; 3]) {
        if path.polarized.is_any() {
            self.walker.stats.polarization += path.polarized.change() * amount(self.walker.world, light);
        }
        add(sum, light);
    }

    /// Counts the light of a camera sample; one that is not finite is left out with all that polarization may have changed
    /// of it, which was counted after `moved`.
    pub(super) fn count_light(&mut self, sum: [f64; 3], moved: f64) {
        let light = amount(self.walker.world, sum);
        if light.is_finite() && self.walker.stats.polarization.is_finite() {
            self.walker.stats.light += light;
        } else {
            self.walker.stats.polarization = moved;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Polarized;

    #[test]
    fn degrees_add_as_velocities_do() {
        let twice = Polarized::NOT.after(0.5).after(0.0).after(0.5);
        assert_eq!(twice, Polarized { degree: 0.8, growth: 1.25 });
        let brewster = Polarized::NOT.after(1.0).after(0.0).after(1.0);
        assert_eq!((brewster.degree, brewster.change()), (1.0, 1.0));
        assert!((0..1000).fold(Polarized::NOT, |path, _| path.after(1.0)).change().is_finite());
    }
}

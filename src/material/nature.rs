//! In which ways light leaves a material.

use super::{Material, Part};

impl<S> Material<S> {
    /// Whether light leaves in every direction, so that lights can be aimed at.
    pub fn scatters_widely(&self) -> bool {
        match self {
            Self::Diffuse(_) => true,
            Self::Conductor(conductor) => !conductor.roughness.is_smooth(),
            Self::Dielectric(dielectric) => !dielectric.roughness.is_smooth(),
            Self::Plastic(_) => true,
            Self::Mix(_) | Self::Mask(_) => self.parts().iter().any(|part| part.material().scatters_widely()),
            _ => false,
        }
    }

    /// Whether light crosses the surface in some way.
    pub fn lets_through(&self) -> bool {
        match self {
            Self::Dielectric(_) | Self::Thin(_) => true,
            Self::Mix(_) | Self::Mask(_) => self.parts().iter().any(|part| part.material().lets_through()),
            _ => false,
        }
    }

    /// Whether light also comes from beyond the surface in every direction.
    pub fn scatters_through(&self) -> bool {
        matches!(self, Self::Dielectric(dielectric) if !dielectric.roughness.is_smooth())
    }

    /// Whether what leaves in every direction has no memory of where it came from: `diffuse_bounces` counts it.
    pub fn is_diffuse(&self) -> bool {
        match self {
            Self::Diffuse(_) => true,
            Self::Plastic(plastic) => plastic.coat.roughness().is_smooth(),
            Self::Mix(_) | Self::Mask(_) => {
                let mut wide = self.parts().iter().map(Part::material).filter(|part| part.scatters_widely()).peekable();
                wide.peek().is_some() && wide.all(Self::is_diffuse)
            }
            _ => false,
        }
    }

    /// How rough it is, where it can be.
    pub fn roughness(&self) -> Option<f64> {
        match self {
            Self::Conductor(conductor) => Some(conductor.roughness.value()),
            Self::Dielectric(dielectric) => Some(dielectric.roughness.value()),
            Self::Plastic(plastic) => Some(plastic.coat.roughness().value()),
            _ => None,
        }
    }

    /// Whether light leaves in single directions, all of it or some: the mirror images and refractions of smooth surfaces.
    pub fn has_single_directions(&self) -> bool {
        match self {
            Self::Diffuse(_) | Self::Emissive(_) => false,
            Self::Mirror(_) | Self::Thin(_) | Self::Dielectric(_) => true,
            Self::Conductor(conductor) => conductor.roughness.is_smooth(),
            Self::Plastic(plastic) => plastic.coat.roughness().is_smooth(),
            Self::Mix(_) | Self::Mask(_) => self.parts().iter().any(|part| part.material().has_single_directions()),
        }
    }
}

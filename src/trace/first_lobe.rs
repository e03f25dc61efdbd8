//! How the first surface sent light to the camera.

use super::white::White;
use crate::material::{Lobes, Material, Scatter, ScatterContext};
use crate::math::DVec3;
use crate::spectrum::{Lanes, Table};

/// The lobe of the first surface by which light came to the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum FirstLobe {
    /// Reflected in every direction: this share of each film channel by a diffuse lobe, the rest by a glossy one.
    Reflected { diffuse: [f32; 3] },
    /// Mirrored.
    Specular,
    /// Come through the surface.
    Transmitted,
}

impl FirstLobe {
    /// Of a material that scatters light from the unit vector `wi` in every direction, through the surface or not.
    /// Where it reflects by both lobes, these are compared in white light: exact where each lane is a film channel.
    pub(super) fn scattered<const N: usize>(
        white: Option<&White>,
        material: &Material<Table>,
        lobes: Lobes,
        context: &ScatterContext<N>,
        wi: DVec3,
        crosses: bool,
    ) -> Self {
        if crosses {
            return Self::Transmitted;
        }
        let glossy = Lobes::GLOSSY_REFLECTION.union(Lobes::NARROW_REFLECTION);
        let diffuse = match (lobes.intersects(Lobes::DIFFUSE_REFLECTION), lobes.intersects(glossy)) {
            (false, _) => [0.0; 3],
            (true, false) => [1.0; 3],
            (true, true) => white.map_or([1.0; 3], |white| diffuse_share(white, material, context, wi)),
        };
        Self::Reflected { diffuse }
    }
}

#[cold]
fn diffuse_share<const N: usize>(
    white: &White,
    material: &Material<Table>,
    context: &ScatterContext<N>,
    wi: DVec3,
) -> [f32; 3] {
    let Some((all, _)) = material.evaluate(context, wi) else { return [1.0; 3] };
    let seen = |lanes: Lanes<N>| white.times(context.draw, lanes, false);
    let (diffuse, all) = (seen(material.diffuse_part(context, wi)), seen(all));
    std::array::from_fn(|channel| match all[channel] {
        all if all > 0.0 => (diffuse[channel] / all).clamp(0.0, 1.0) as f32,
        _ => 1.0,
    })
}

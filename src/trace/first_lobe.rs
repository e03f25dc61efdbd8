//! The lobe by which the first surface sent light to the camera.

use super::white::White;
use crate::material::{Lobes, Material, Scatter, ScatterContext};
use crate::math::DVec3;
use crate::spectrum::{Lanes, Table};

/// The lobe of the first surface by which light reached the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum FirstLobe {
    /// Reflected by a lobe of nonzero width: `diffuse` is the diffuse share of each film channel, the rest is glossy.
    Reflected { diffuse: [f32; 3] },
    /// Reflected specularly.
    Specular,
    /// Transmitted through the surface.
    Transmitted,
}

impl FirstLobe {
    /// Returns the lobe by which a material scatters light from the unit vector `wi`, across the surface if `crosses`.
    /// Diffuse and glossy reflection are compared in white light, which is exact if each lane is a film channel.
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
    let to_rgb = |lanes: Lanes<N>| white.times(context.draw, lanes, false);
    let (diffuse, all) = (to_rgb(material.diffuse_part(context, wi)), to_rgb(all));
    std::array::from_fn(|channel| match all[channel] {
        all if all > 0.0 => (diffuse[channel] / all).clamp(0.0, 1.0) as f32,
        _ => 1.0,
    })
}

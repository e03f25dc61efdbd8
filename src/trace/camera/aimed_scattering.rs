//! Scattering from surfaces whose bounces are aimed at bright places.

use crate::material::{Branch, Material};
use crate::spectrum::Table;
use crate::trace::bright::Aiming;
use crate::trace::walk::{Interaction, shading};

/// Returns whether bounces from a material may be aimed: it must scatter nearly alike in all directions of one side.
pub fn may_aim(material: &Material<Table>) -> bool {
    matches!(material, Material::Diffuse(_) | Material::Plastic(_))
}

/// Returns the albedo of a surface, in the lane where it is highest; for plastic, it is approximate.
pub fn albedo<const N: usize>(interaction: &Interaction<N>) -> f64 {
    let Interaction { material, context, flat, .. } = interaction;
    let up = shading::evaluate(material, context, *flat, *flat);
    up.map_or(0.0, |(bsdf_cos, pdf)| bsdf_cos.0.iter().fold(0.0, |most, &lane| f64::from(lane).max(most)) / pdf)
}

/// Samples the branches of a surface whose bounces are aimed.
///
/// Roulette ends aimed paths as often as others: what their density takes from the weight does not measure importance.
pub fn scatter_aimed<const N: usize>(
    aiming: &Aiming,
    interaction: &Interaction<N>,
    u: [f64; 2],
    branches: &mut Vec<Branch<N>>,
) {
    let Interaction { material, context, flat, .. } = interaction;
    let divided = aiming.choose_technique(u[0]);
    shading::scatter(material, context, *flat, [divided.err().unwrap_or(0.5), u[1]], branches);
    if let Ok(aimed) = divided {
        branches.retain(|branch| branch.pdf.is_none());
        let Some((wi, known_place)) = aiming.draw([aimed, u[1]]).filter(|(wi, _)| wi.dot(*flat) > 0.0) else { return };
        let Some((bsdf_cos, material_pdf)) = shading::evaluate(material, context, *flat, wi) else { return };
        let pdf = aiming.pdf_given(wi, material_pdf, known_place);
        if !(material_pdf > 0.0 && pdf.is_finite()) {
            return;
        }
        let share = bsdf_cos * (1.0 / pdf) as f32;
        let eta_scale = material_pdf / pdf;
        branches.push(Branch { wi, share, pdf: Some(pdf), crosses: false, eta_scale, polarization: 0.0 });
        return;
    }
    for branch in branches {
        if let Some(material_pdf) = branch.pdf.filter(|material_pdf| *material_pdf > 0.0) {
            let pdf = aiming.pdf(branch.wi, material_pdf);
            let factor = material_pdf / pdf;
            branch.share = branch.share * factor as f32;
            branch.eta_scale *= factor;
            branch.pdf = Some(pdf);
        }
    }
}

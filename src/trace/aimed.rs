//! Ways on from surfaces whose bounces are aimed at bright places.

use super::bright::Aiming;
use super::brightness::Bounce;
use super::path::Path;
use super::polarization::amount;
use super::shading;
use super::tracer::Tracer;
use crate::material::{Arrival, Branch, Material};
use crate::math::DVec3;
use crate::spectrum::{Draw, Table};

/// Whether bounces from a material may be aimed: it scatters nearly alike in all directions of one side.
pub(super) fn may_aim(material: &Material<Table>) -> bool {
    matches!(material, Material::Diffuse(_) | Material::Plastic(_))
}

impl<const N: usize> Tracer<'_, N> {
    /// Keeps what a bounce found, if somebody wants to know.
    #[inline]
    pub(super) fn note(&mut self, path: &Path<N>, draw: &Draw<N>, distance: f64, light: [f64; 3]) {
        if let (Some(bounces), Some(drawn)) = (&mut self.bounces, &path.drawn) {
            let distance = distance + (path.ray.origin - drawn.from).length();
            let (light, weight) = (amount(self.world, light), path.weight(draw));
            let (from, normal, direction) = (drawn.from, drawn.normal, path.ray.direction);
            bounces.push(Bounce { from, normal, direction, distance, light, weight });
        }
    }

    /// The ways on from a surface whose bounces are aimed.
    ///
    /// Roulette is to end aimed paths as often as others: what their density takes from the weight is no measure of importance.
    pub(super) fn scatter_aimed(
        &mut self,
        aiming: &Aiming,
        (material, arrival): (&Material<Table>, &Arrival<N>),
        flat: DVec3,
        u: [f64; 2],
    ) {
        let divided = aiming.divided(u[0]);
        shading::scatter(material, arrival, flat, [divided.err().unwrap_or(0.5), u[1]], &mut self.branches);
        if let Ok(aimed) = divided {
            self.branches.retain(|branch| branch.pdf.is_none());
            let Some((wi, known)) = aiming.draw([aimed, u[1]]).filter(|(wi, _)| wi.dot(flat) > 0.0) else { return };
            let Some((bsdf_cos, own)) = shading::evaluate(material, arrival, flat, wi) else { return };
            let pdf = aiming.pdf_knowing(wi, own, known);
            if !(own > 0.0 && pdf.is_finite()) {
                return;
            }
            let share = bsdf_cos * (1.0 / pdf) as f32;
            let eta_scale = own / pdf;
            self.branches.push(Branch { wi, share, pdf: Some(pdf), crosses: false, eta_scale, polarization: 0.0 });
            return;
        }
        for branch in &mut self.branches {
            if let Some(own) = branch.pdf.filter(|own| *own > 0.0) {
                let pdf = aiming.pdf(branch.wi, own);
                let factor = own / pdf;
                branch.share = branch.share * factor as f32;
                branch.eta_scale *= factor;
                branch.pdf = Some(pdf);
            }
        }
    }
}

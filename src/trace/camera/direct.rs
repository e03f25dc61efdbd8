//! Next-event estimation: light that comes directly from the lights.

use std::cell::Cell;

use super::dimensions::{FURTHER_LIGHTS, MORE_DIGITS};
use super::sensor::Sensor;
use crate::light::{LightId, LightSample, SampledLight};
use crate::material::Lobes;
use crate::math::{DVec3, Ray, Sampler};
use crate::scene::{MaterialId, RayEnds};
use crate::shape::Intersection;
use crate::spectrum::Lanes;
use crate::trace::World;
use crate::trace::bright::Aiming;
use crate::trace::contribution::{Contribution, FoundBy};
use crate::trace::photon::LightVertices;
use crate::trace::received_light::ReceivedLight;
use crate::trace::walk::{
    Excitation, FoundLight, Interaction, Occluders, Path, Polarization, ScatterSample, VisibilityTest, shading,
};

/// A path at a surface that scatters widely, where lights are sampled.
pub struct DirectLighting<'a, const N: usize, P> {
    pub world: &'a World,
    pub path: &'a Path<N, P>,
    pub interaction: &'a Interaction<'a, N>,
    /// The dye that the light excites, if the path follows what excites one.
    pub excitation: Option<&'a Excitation<N, P>>,
    /// Whether the path continues from here and may hit a light by itself.
    pub continues: bool,
    /// Whether every light is sampled, or only one.
    pub all_lights: bool,
    /// The object that last occluded a light.
    pub last_occluder: &'a Cell<Option<u32>>,
    /// Four random numbers of the vertex; the first light uses the first two, the choice of one light the last.
    pub u: [f64; 4],
    /// How bounces from here are aimed, if they are.
    pub aiming: Option<&'a Aiming<'a>>,
    /// Light vertices at which light was already estimated: what they carry no longer counts.
    pub vertices: Option<&'a LightVertices<N>>,
}

/// A side of the surface, from which lights are sampled.
#[derive(Clone, Copy)]
struct Side<'s, const N: usize> {
    /// The geometric unit normal on that side.
    normal: DVec3,
    /// Probability that this side is sampled, if light may arrive at both. Each side then takes only its own light.
    chance: Option<f64>,
    /// The medium the light arrives through.
    inside: Option<MaterialId>,
    /// Whether lanes have parted on the way from the light to the camera.
    parted: bool,
    /// The surface without the lobe that is left to photons, if there is one, for lights that send photons.
    without_photon_lobe: Option<&'s Interaction<'s, N>>,
}

/// A ray to a light, and everything else that its light depends on if the ray is not occluded.
struct ShadowRay<const N: usize> {
    light: LightId,
    /// The ray, its length, and the object that does not occlude it.
    sample: LightSample,
    /// Probability that the light was chosen and this side sampled.
    probability: f64,
    /// The BSDF times the cosine, and the density with which the material samples the ray's direction.
    bsdf_cos: Lanes<N>,
    bsdf_pdf: f64,
    /// The factor on the light's emission and the BSDF, if bounces are not aimed.
    factor: f64,
}

impl<const N: usize, P: Polarization<N>> DirectLighting<'_, N, P> {
    /// Samples lights, passes their light to the sensor, and returns the probability with which a side was sampled.
    ///
    /// If light also comes from beyond the surface, both sides are sampled or, if only one light is sampled, one side
    /// that is chosen at random.
    pub fn gather(&self, sampler: &Sampler, sensor: &mut Sensor<N>) -> f64 {
        let (interaction, parted) = (self.interaction, self.path.parted);
        let leaves_narrow = self.path.leaves_narrow_to_photons(self.world, interaction);
        let without_photon_lobe = leaves_narrow.then(|| interaction.with_lobes(Lobes::DIFFUSE_REFLECTION));
        let without_photon_lobe = without_photon_lobe.as_ref();
        let near = Side {
            normal: interaction.flat,
            chance: None,
            inside: interaction.boundary.here,
            parted,
            without_photon_lobe,
        };
        if !interaction.lobes.intersects(Lobes::NON_DELTA_TRANSMISSION) {
            self.gather_side(&near, sampler, sensor);
            return 1.0;
        }
        let chance = if self.all_lights { 1.0 } else { 0.5 };
        let u = sampler.get_random_4d(self.path.key, MORE_DIGITS)[2];
        let near = Side { chance: Some(chance), ..near };
        if u < chance {
            self.gather_side(&near, sampler, sensor);
        }
        if 1.0 - u <= chance {
            let far = Side {
                normal: -near.normal,
                inside: interaction.boundary.beyond,
                parted: parted || interaction.is_parting,
                ..near
            };
            self.gather_side(&far, sampler, sensor);
        }
        chance
    }

    fn gather_side(&self, side: &Side<N>, sampler: &Sampler, sensor: &mut Sensor<N>) {
        let (lights, key) = (&self.world.scene.lights, self.path.key);
        let mut sample_light = |drawn: SampledLight, [u, v]: [f64; 2]| {
            let u =
                if lights[drawn.light].has_parts() { refine(u, sampler.get_random_4d(key, MORE_DIGITS)[1]) } else { u };
            if let Some(shadow_ray) = self.shadow_ray(side, drawn, [u, v]) {
                self.trace(side, &shadow_ray, sensor);
            }
        };
        if self.all_lights {
            for (number, &light) in self.world.sampled_lights.iter().enumerate() {
                let u = match number {
                    0 => [self.u[0], self.u[1]],
                    _ => {
                        let u = sampler.get_4d(key, FURTHER_LIGHTS + number as u32 / 2);
                        if number % 2 == 0 { [u[0], u[1]] } else { [u[2], u[3]] }
                    }
                };
                sample_light(SampledLight { light, probability: 1.0 }, u);
            }
        } else {
            let u = refine(self.u[3], sampler.get_random_4d(key, MORE_DIGITS)[0]);
            if let Some(drawn) = self.world.light_sampler.sample(self.interaction.point.position, side.normal, u) {
                sample_light(drawn, [self.u[0], self.u[1]]);
            }
        }
    }

    /// Returns a ray to a light that was chosen with a probability; `None` if the sensor receives nothing from it.
    fn shadow_ray(&self, side: &Side<N>, drawn: SampledLight, u: [f64; 2]) -> Option<ShadowRay<N>> {
        let normal = side.normal;
        let sample = self.world.scene.lights[drawn.light].sample_li_in_part(self.interaction.point, normal, u)?;
        let interaction = self.lit_surface(side, drawn.light, &sample.ray);
        let (context, wi) = (&interaction.context, sample.ray.direction);
        let is_found = |vertices: &LightVertices<N>| vertices.carry(self.world, drawn.light, &sample.ray);
        if wi.dot(normal) <= 0.0 || self.vertices.is_some_and(is_found) {
            return None;
        }
        let flat = if normal.dot(context.wo) < 0.0 { -normal } else { normal };
        let (bsdf_cos, mut bsdf_pdf) = shading::evaluate(interaction.material, context, flat, wi)?;
        if !std::ptr::eq(interaction, self.interaction) {
            // If photons carry the light that the path hits, the path finds no light by itself.
            bsdf_pdf = 0.0;
        }
        let (light, probability) = (drawn.light, drawn.probability * side.chance.unwrap_or(1.0));
        let factor = self.factor(&sample, probability, bsdf_pdf);
        factor.is_finite().then_some(ShadowRay { light, sample, probability, bsdf_cos, bsdf_pdf, factor })
    }

    /// Returns the surface that a light illuminates along a ray: without the lobe that is left to photons, if any.
    fn lit_surface<'s>(&'s self, side: &Side<'s, N>, light: LightId, ray: &Ray) -> &'s Interaction<'s, N> {
        side.without_photon_lobe.filter(|_| self.world.is_found_by_photons(light, ray)).unwrap_or(self.interaction)
    }

    /// Passes the light along a ray to the sensor, unless something occludes the light.
    fn trace(&self, side: &Side<N>, shadow_ray: &ShadowRay<N>, sensor: &mut Sensor<N>) {
        let world = self.world;
        let ShadowRay { light, sample, probability, bsdf_cos, bsdf_pdf, factor } = shadow_ray;
        let LightSample { ray, distance, object, part, .. } = sample;
        let interaction = self.lit_surface(side, *light, ray);
        let context = &interaction.context;
        let ends = RayEnds { start: self.path.last_primitive, light: *object, part: *part };
        let (distance, inside, last_occluder) = (*distance, side.inside, self.last_occluder);
        let occluders = Occluders::Objects(self.path.object_set);
        let segment = VisibilityTest { ray, distance, ends, inside, occluders, last_occluder };
        let wi = ray.direction;
        let light_of = || world.scene.lights[*light].toward(context.draw, wi, sample.uv);
        let mut bsdf_cos = *bsdf_cos;
        let toward = || self.path.polarization.toward_light(interaction, wi, &mut bsdf_cos);
        let arriving = segment.arriving_light(world, context.draw, toward, light_of);
        let Some((mut arriving, on_its_way)) = arriving else { return };
        let polarized = on_its_way.at_polarized_light(&world.scene.lights[*light], wi, &mut arriving);
        let on_its_way = polarized.as_ref().unwrap_or(&on_its_way);
        // The density of aimed bounces takes time, so it is computed only for rays that are not occluded.
        let factor = match self.aiming.filter(|_| self.continues && sample.pdf.is_some()) {
            Some(aiming) => self.factor(sample, *probability, aiming.pdf(wi, *bsdf_pdf)),
            None => *factor,
        };
        let lanes = &self.path.throughput.scaled(factor).of(bsdf_cos * arriving);
        let light = *light;
        let received = ReceivedLight { source: light, draw: context.draw, lanes, parted: side.parted };
        let found_light = FoundLight::new(world, &received, self.excitation);
        let (rgb, dispersed) = (found_light.rgb, found_light.dispersed);
        let polarization_change = self.path.polarization.change_along(interaction, wi, on_its_way, &found_light);
        let (light, found, bounces) = (Some(light), FoundBy::Sampled, self.path.bounces + 1);
        let first = self.path.first_lobe(world, self.interaction, wi, side.normal != self.interaction.flat);
        sensor.receive(
            Contribution { light, found, rgb, polarization_change, first, bounces, dispersed },
            &found_light,
            on_its_way,
        );
    }

    /// Returns the factor on a light's emission and the BSDF. If the path's own next direction may hit the light, it is
    /// weighted by multiple importance sampling of both techniques.
    fn factor(&self, sample: &LightSample, probability: f64, bounce_pdf: f64) -> f64 {
        let Some(pdf) = sample.pdf else { return sample.factor / probability };
        let pdf = pdf * probability;
        let weight = if self.continues { power_heuristic(pdf, bounce_pdf) } else { 1.0 };
        sample.factor * weight / pdf
    }
}

/// Adds digits to a random number of the sequences: choosing among many lights uses up its 23 bits.
fn refine(u: f64, more: f64) -> f64 {
    const STEPS: f64 = (1 << 23) as f64;
    ((u * STEPS).floor() + more) / STEPS
}

/// Returns the weight of a light that a path hit, against next-event estimation at the path's last surface.
/// `intersection` is where the ray hits the light, if that is a surface.
pub fn weight_of_hit(
    world: &World,
    light: LightId,
    scatter: Option<&ScatterSample>,
    ray: &Ray,
    intersection: Option<&Intersection>,
) -> f64 {
    let Some(scatter) = scatter else { return 1.0 };
    // Through holes and panes that the path has passed since, the light was sampled from before them.
    let before = Ray { origin: scatter.from, direction: ray.direction };
    let (ray, intersection) = if scatter.passed_through { (&before, None) } else { (ray, intersection) };
    let pdf = world.scene.lights[light].pdf_li(ray, scatter.normal, intersection);
    let Some(pdf) = pdf else { return 1.0 };
    let probability =
        if scatter.all_lights { 1.0 } else { world.light_sampler.probability(light, scatter.from, scatter.normal) };
    power_heuristic(scatter.pdf, pdf * (probability * scatter.chance))
}

/// Returns the power heuristic with beta = 2 (Veach & Guibas 1995, *Optimally Combining Sampling Techniques for Monte
/// Carlo Rendering*).
///
/// A direction sampled with density 0, exactly along the surface, has weight 0.
fn power_heuristic(this: f64, other: f64) -> f64 {
    if this == 0.0 {
        return 0.0;
    }
    let ratio = other / this;
    1.0 / (1.0 + ratio * ratio)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::BranchKey;

    /// Numbers of the sequences have 23 bits: the added digits fill the whole step to the next number.
    #[test]
    fn finer_numbers_leave_no_gaps() {
        let mut upper = 0;
        for sample in 0..4096 {
            let sampler = Sampler::of_pixel(5, [1, 2], sample);
            let (u, more) = (sampler.get_4d(BranchKey::CAMERA, 1)[0], sampler.get_random_4d(BranchKey::CAMERA, 1)[0]);
            assert_eq!(u, refine(u, 0.0));
            assert!((u..u + 1.0 / f64::from(1 << 23)).contains(&refine(u, more)));
            upper += u32::from(libm::fmod(refine(u, more) * f64::from(1 << 23), 1.0) >= 0.5);
        }
        assert!((upper as i32 - 2048).abs() < 5 * 32, "{upper} of 4096 lie in the upper halves of steps");
    }
}

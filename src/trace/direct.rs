//! Next-event estimation: light that comes straight from the lights.

use std::cell::Cell;

use super::bright::Aiming;
use super::path::Drawn;
use super::polarization::{Lit, Polarized};
use super::straight;
use super::{World, media, shading};
use crate::light::{LightId, LightSample};
use crate::material::{Arrival, Material};
use crate::math::{BranchKey, DVec3, Ray, Sampler};
use crate::scene::MaterialId;
use crate::shape::{Crossing, SurfacePoint};
use crate::spectrum::{Lanes, Table, Throughput};

/// A point of a surface that scatters widely, where light that lights send straight to it is gathered.
pub(super) struct Gathering<'a, const N: usize> {
    pub(super) world: &'a World,
    pub(super) material: &'a Material<Table>,
    pub(super) arrival: &'a Arrival<'a, N>,
    pub(super) point: &'a SurfacePoint,
    pub(super) throughput: Throughput<N>,
    pub(super) parted: bool,
    /// The surface's unit normal, of the triangle where it is smooth, on the side the light arrives at.
    pub(super) normal: DVec3,
    /// How likely that side is looked at, where light may arrive at both: then light from the other side is left to it.
    pub(super) side: Option<f64>,
    /// The medium the light arrives through.
    pub(super) inside: Option<MaterialId>,
    /// Whether the path goes on from here and may meet a light by itself.
    pub(super) goes_on: bool,
    /// Whether all lights are sampled, or one.
    pub(super) aims_at_all: bool,
    /// The object that hid a light last.
    pub(super) hider: &'a Cell<Option<u32>>,
    /// What polarization may change of it, where the path is polarized.
    pub(super) lit: Option<&'a Lit>,
    /// Four random numbers of the vertex; the first light uses the first two, the choice of one light the last.
    pub(super) u: [f64; 4],
    /// How bounces are guided from here, if they are.
    pub(super) aiming: Option<&'a Aiming<'a>>,
}

/// Random numbers for the second light and those after it.
const FURTHER_LIGHTS: u32 = 16;
/// Random digits for choices among many, and the choice of a side.
const MORE_DIGITS: u32 = 3;

impl<const N: usize> Gathering<'_, N> {
    /// What the sensor gets of the light that lights send straight to the surface.
    fn direct(&self, sampler: &Sampler, key: BranchKey) -> [f64; 3] {
        let lights = &self.world.scene.lights;
        let mut sum = [0.0; 3];
        let mut take = |light: LightId, probability: f64, [u, v]: [f64; 2]| {
            let u = if lights[light].has_parts() { finer(u, sampler.four_plain(key, MORE_DIGITS)[1]) } else { u };
            if let Some(light) = self.of_light(light, probability, [u, v]) {
                add(&mut sum, light);
            }
        };
        if self.aims_at_all {
            for (number, &light) in self.world.targets.iter().enumerate() {
                let u = match number {
                    0 => [self.u[0], self.u[1]],
                    _ => {
                        let u = sampler.four(key, FURTHER_LIGHTS + number as u32 / 2);
                        if number % 2 == 0 { [u[0], u[1]] } else { [u[2], u[3]] }
                    }
                };
                take(light, 1.0, u);
            }
        } else {
            let u = finer(self.u[3], sampler.four_plain(key, MORE_DIGITS)[0]);
            if let Some(drawn) = self.world.light_sampler.sample(self.point.position, self.normal, u) {
                take(drawn.light, drawn.probability, [self.u[0], self.u[1]]);
            }
        }
        sum
    }

    /// Adds the light of the lights to a sum, and answers how likely it was to look at a side.
    ///
    /// Where light also comes from beyond the surface, `far` is the medium there and whether lanes part on the way.
    /// Both sides are looked at or, where only one light is sampled, one of them chosen by chance.
    pub(super) fn gather(
        self,
        far: Option<(Option<MaterialId>, bool)>,
        sampler: &Sampler,
        key: BranchKey,
        sum: &mut [f64; 3],
    ) -> f64 {
        let Some((inside, parts)) = far else {
            add(sum, self.direct(sampler, key));
            return 1.0;
        };
        let chance = if self.aims_at_all { 1.0 } else { 0.5 };
        let u = sampler.four_plain(key, MORE_DIGITS)[2];
        let near = Self { side: Some(chance), ..self };
        if u < chance {
            add(sum, near.direct(sampler, key));
        }
        if 1.0 - u <= chance {
            let parted = near.parted || parts;
            add(sum, Self { normal: -near.normal, parted, inside, ..near }.direct(sampler, key));
        }
        chance
    }

    /// What the sensor gets of one light, sampled with a probability; none where it gets nothing.
    fn of_light(&self, id: LightId, probability: f64, u: [f64; 2]) -> Option<[f64; 3]> {
        let (world, normal) = (self.world, self.normal);
        let light = &world.scene.lights[id];
        let sample = light.sample_li(self.point, normal, u)?;
        let wi = sample.ray.direction;
        if wi.dot(normal) <= 0.0 {
            return None;
        }
        let flat = if normal.dot(self.arrival.wo) < 0.0 { -normal } else { normal };
        let (bsdf_cos, bsdf_pdf) = shading::evaluate(self.material, self.arrival, flat, wi)?;
        let probability = probability * self.side.unwrap_or(1.0);
        let mut factor = self.factor(&sample, probability, bsdf_pdf);
        if !factor.is_finite() {
            return None;
        }
        let straight = self.unoccluded(&sample)?;
        // The density of bounces that are guided takes its time.
        if let Some(aiming) = self.aiming.filter(|_| self.goes_on && sample.pdf.is_some()) {
            factor = self.factor(&sample, probability, aiming.pdf(wi, bsdf_pdf));
        }
        let mut arriving = light.toward(self.arrival.draw, wi, sample.uv);
        if let Some((share, _)) = straight {
            arriving = arriving * share;
        }
        if let Some(material) = self.inside {
            arriving = arriving * media::medium(world, material).transmission(self.arrival.draw, sample.distance);
        }
        let reflected = self.throughput.scaled(factor).of(bsdf_cos * arriving);
        let rgb = world.responses[id].sensor(self.arrival.draw, reflected, self.parted);
        if let Some(lit) = self.lit {
            let on_its_way = straight.map_or(Polarized::NOT, |(_, polarized)| polarized);
            lit.count(world, (self.material, self.arrival), (wi, on_its_way), rgb);
        }
        Some(rgb)
    }

    /// The factor on a light's emission and the material's answer: over the density of both ways to the light's
    /// direction together, where the path's own next direction may meet it.
    fn factor(&self, sample: &LightSample, probability: f64, bounce_pdf: f64) -> f64 {
        let Some(pdf) = sample.pdf else { return sample.factor / probability };
        let pdf = pdf * probability;
        let weight = if self.goes_on { power_heuristic(pdf, bounce_pdf) } else { 1.0 };
        sample.factor * weight / pdf
    }

    /// None if something hides the light; where there are holes and panes, the share that goes straight on through
    /// them.
    fn unoccluded(&self, sample: &LightSample) -> Option<Option<(Lanes<N>, Polarized)>> {
        if self.world.has_see_through() {
            return self.transmittance(sample).map(Some);
        }
        let hidden = self.world.scene.is_hidden(&sample.ray, sample.distance, sample.object, self.hider);
        (!hidden).then_some(None)
    }

    /// The share of a light that goes straight on through what stands before it; none if something hides it.
    #[cold]
    #[inline(never)]
    fn transmittance(&self, sample: &LightSample) -> Option<(Lanes<N>, Polarized)> {
        let (world, LightSample { ray, distance, object, .. }) = (self.world, sample);
        if world.scene.is_hidden_by(ray, *distance, *object, self.hider, |object| !world.is_see_through(object)) {
            return None;
        }
        straight::transmittance(world, self.arrival.draw, ray, *distance, self.inside)
    }
}

/// A random number with more digits: choosing among many lights uses up those of the sequences, 24 bits.
fn finer(u: f64, more: f64) -> f64 {
    const STEPS: f64 = (1 << 24) as f64;
    ((u * STEPS).floor() + more) / STEPS
}

/// The weight of a light that a path met by itself, beside next-event estimation at the path's last surface. `crossing`
/// is where the ray meets the light, if that is a surface.
pub(super) fn weight_of_meeting(
    world: &World,
    light: LightId,
    drawn: Option<&Drawn>,
    ray: &Ray,
    crossing: Option<&Crossing>,
) -> f64 {
    let Some(drawn) = drawn else { return 1.0 };
    // Through holes and panes that the path has passed since, the light was sampled from before them.
    let before = Ray { origin: drawn.from, direction: ray.direction };
    let (ray, crossing) = if drawn.passed { (&before, None) } else { (ray, crossing) };
    let pdf = world.scene.lights[light].pdf_li(ray, drawn.normal, crossing);
    let Some(pdf) = pdf else { return 1.0 };
    let probability =
        if drawn.aimed_at_all { 1.0 } else { world.light_sampler.probability(light, drawn.from, drawn.normal) };
    power_heuristic(drawn.pdf, pdf * (probability * drawn.chance))
}

/// Veach & Guibas 1995, *Optimally Combining Sampling Techniques for Monte Carlo Rendering*, power heuristic, beta = 2.
///
/// A direction drawn with density 0, exactly along the surface, has weight 0.
fn power_heuristic(this: f64, other: f64) -> f64 {
    if this == 0.0 {
        return 0.0;
    }
    let ratio = other / this;
    1.0 / (1.0 + ratio * ratio)
}

pub(super) fn add(sum: &mut [f64; 3], more: [f64; 3]) {
    for (sum, more) in sum.iter_mut().zip(more) {
        *sum += more;
    }
}

//! Next-event estimation: light that comes straight from the lights.

use std::cell::Cell;

use super::bright::Aiming;
use super::path::ScatterSample;
use super::polarization::{Lit, Polarized};
use super::straight;
use super::{World, media, shading};
use crate::light::{Light, LightId};
use crate::material::{Arrival, Material};
use crate::math::{BranchKey, DVec3, Ray, Sampler};
use crate::scene::MaterialId;
use crate::shape::{Crossing, SurfacePoint};
use crate::spectrum::{Lanes, Table, Throughput};

/// A place where light is gathered.
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
    pub(super) aims_at_all: bool,
    /// The object that hid a light last.
    pub(super) hider: &'a Cell<Option<u32>>,
    /// What polarization may change of it, where the path is polarized.
    pub(super) lit: Option<&'a Lit>,
    /// Four random numbers of the vertex; the first light uses the first two, the choice of one light the last.
    pub(super) u: [f64; 4],
    /// How bounces are aimed from here, if they are.
    pub(super) aiming: Option<&'a Aiming<'a>>,
}

/// Random numbers for the second light and those after it.
const FURTHER_LIGHTS: u32 = 16;
/// Random digits for choices among many, and the choice of a side.
const MORE_DIGITS: u32 = 3;

impl<const N: usize> Gathering<'_, N> {
    /// What the sensor gets of the light that lights send straight to the surface.
    fn direct(&self, sampler: &Sampler, key: BranchKey) -> [f64; 3] {
        let targets = &self.world.targets;
        let mut sum = [0.0; 3];
        let digits = |target: LightId, u: [f64; 2]| match &self.world.scene.lights[target] {
            Light::Area(area) if area.has_parts() => [finer(u[0], sampler.four_plain(key, MORE_DIGITS)[1]), u[1]],
            _ => u,
        };
        if self.aims_at_all {
            for (number, &target) in targets.iter().enumerate() {
                let u = match number {
                    0 => [self.u[0], self.u[1]],
                    _ => {
                        let u = sampler.four(key, FURTHER_LIGHTS + number as u32 / 2);
                        if number % 2 == 0 { [u[0], u[1]] } else { [u[2], u[3]] }
                    }
                };
                add(&mut sum, self.from(target, 1.0, digits(target, u)));
            }
        } else {
            let more = sampler.four_plain(key, MORE_DIGITS);
            let (from, normal) = (self.point.position, self.normal);
            if let Some((target, probability)) = self.world.choice.choose(from, normal, finer(self.u[3], more[0])) {
                add(&mut sum, self.from(target, probability, digits(target, [self.u[0], self.u[1]])));
            }
        }
        sum
    }

    /// Adds the light of the lights to a sum, and answers how likely it was to look at a side.
    ///
    /// Where light also comes from beyond the surface, `far` is the medium there and whether lanes part on the way. Both
    /// sides are looked at or, where only one light is aimed at, one of them chosen by chance.
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

    /// The share of one light, aimed at with a probability.
    fn from(&self, target: LightId, probability: f64, u: [f64; 2]) -> [f64; 3] {
        let light = &self.world.scene.lights[target];
        let normal = self.normal;
        let probability = probability * self.side.unwrap_or(1.0);
        let lit = || {
            let sighting = light.aim(self.point.position, normal, u)?;
            if self.side.is_some() && sighting.direction.dot(normal) <= 0.0 {
                return None;
            }
            let flat = if normal.dot(self.arrival.wo) < 0.0 { -normal } else { normal };
            let (bsdf_cos, bsdf_pdf) = shading::evaluate(self.material, self.arrival, flat, sighting.direction)?;
            let ray = self.point.leave(sighting.direction);
            let view = light.view(&ray, normal, &sighting)?;
            let factor = match view.pdf {
                None => view.factor / probability,
                Some(pdf) => {
                    let pdf = pdf * probability;
                    let weight = if self.goes_on { power_heuristic(pdf, bsdf_pdf) } else { 1.0 };
                    view.factor * weight / pdf
                }
            };
            if !factor.is_finite() {
                return None;
            }
            let transmitted = if self.world.has_see_through() {
                Some(self.transmittance(&ray, view.distance, view.object)?)
            } else if self.world.scene.is_hidden(&ray, view.distance, view.object, self.hider) {
                return None;
            } else {
                None
            };
            let factor = match (self.aiming, view.pdf) {
                (Some(aiming), Some(pdf)) if self.goes_on => {
                    let pdf = pdf * probability;
                    view.factor * power_heuristic(pdf, aiming.pdf(sighting.direction, bsdf_pdf)) / pdf
                }
                _ => factor,
            };
            let mut arriving = light.toward(self.arrival.draw, sighting.direction, view.uv);
            if let Some((share, _)) = transmitted {
                arriving = arriving * share;
            }
            if let Some(material) = self.inside {
                arriving =
                    arriving * media::medium(self.world, material).transmission(self.arrival.draw, view.distance);
            }
            let reflected = self.throughput.scaled(factor).of(bsdf_cos * arriving);
            let rgb = self.world.responses[target].sensor(self.arrival.draw, reflected, self.parted);
            if let Some(lit) = self.lit {
                let on_its_way = transmitted.map_or(Polarized::NOT, |(_, polarized)| polarized);
                lit.count(self.world, (self.material, self.arrival), (sighting.direction, on_its_way), rgb);
            }
            Some(rgb)
        };
        lit().unwrap_or([0.0; 3])
    }

    /// The share of a light that goes straight on through what stands before it; none if something hides it.
    #[cold]
    #[inline(never)]
    fn transmittance(&self, ray: &Ray, distance: f64, light: Option<u32>) -> Option<(Lanes<N>, Polarized)> {
        let world = self.world;
        if world.scene.is_hidden_by(ray, distance, light, self.hider, |object| !world.is_see_through(object)) {
            return None;
        }
        straight::transmittance(world, self.arrival.draw, ray, distance, self.inside)
    }
}

/// A random number with more digits: choosing among many lights uses up those of the sequences, 24 bits.
fn finer(u: f64, more: f64) -> f64 {
    const STEPS: f64 = (1 << 24) as f64;
    ((u * STEPS).floor() + more) / STEPS
}

/// The weight of a light that a path met by itself, beside next-event estimation at the path's last surface.
pub(super) fn weight_of_meeting(
    world: &World,
    light: LightId,
    scatter: Option<&ScatterSample>,
    ray: &Ray,
    crossing: Option<&Crossing>,
) -> f64 {
    let Some(scatter) = scatter else { return 1.0 };
    let pdf = match (&world.scene.lights[light], crossing) {
        (Light::Area(area), Some(_)) if area.aimed_at && scatter.passed => {
            // The light was aimed at from before the holes and panes that the path has passed since.
            let ray = Ray { origin: scatter.from, direction: ray.direction };
            area.shape.intersect(&ray, f64::INFINITY).and_then(|crossing| area.pdf(&ray, scatter.normal, &crossing))
        }
        (Light::Area(area), Some(crossing)) if area.aimed_at => area.pdf(ray, scatter.normal, crossing),
        (Light::Environment(environment), None) => Some(environment.pdf(ray, scatter.normal)),
        (Light::Sun(sun), None) => sun.pdf(ray),
        _ => None,
    };
    let Some(pdf) = pdf else { return 1.0 };
    let probability =
        if scatter.all_lights { 1.0 } else { world.choice.probability(light, scatter.from, scatter.normal) };
    power_heuristic(scatter.pdf, pdf * (probability * scatter.chance))
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

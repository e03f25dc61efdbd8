//! Paths from the camera back to the lights.

use std::cell::Cell;

use super::aimed::may_aim;
use super::brightness::Bounce;
use super::direct::{Gathering, add, weight_of_meeting};
use super::interaction::{Interaction, Meeting};
use super::merge::Photons;
use super::path::{Path, PathKind, ScatterSample};
use super::polarization::Lit;
use super::shading;
use super::straight;
use super::walker::{Departure, Walker};
use super::{Transport, World};
use crate::light::{Light, LightId};
use crate::material::Material;
use crate::math::{DVec3, Ray, Sampler};
use crate::shape::SurfacePoint;
use crate::spectrum::Draw;

/// Follows the rays of camera samples back to the light, and gathers it from the lights on the way.
pub(super) struct PathTracer<'a, const N: usize> {
    pub(super) walker: Walker<'a, N>,
    /// Lights that paths from widely scattering surfaces met, with the unit normal there, if somebody wants to know.
    pub(super) met: Option<Vec<(LightId, DVec3)>>,
    /// Photons that are gathered, if any are.
    pub(super) photons: Option<&'a Photons<N>>,
    /// What gathered photons brought to the sensor.
    pub(super) gathered: [f64; 3],
    /// Places that scatter widely and are not seen straight, if somebody wants to know.
    pub(super) reached: Option<Vec<DVec3>>,
    /// What bounces found, if somebody wants to know.
    pub(super) bounces: Option<Vec<Bounce>>,
}

/// Uses of the random numbers at a vertex.
const SCATTER: u32 = 1;
/// Surfaces of a path whose directions are drawn from a sequence spread over the pixel's samples. Behind them the samples
/// see so many different places that plain random numbers, which cost less, are taken.
const SPREAD: u32 = 4;

impl<'a, const N: usize> PathTracer<'a, N> {
    pub(super) fn new(world: &'a World) -> Self {
        let walker = Walker::new(world, world.method.transport);
        Self { walker, met: None, photons: None, gathered: [0.0; 3], reached: None, bounces: None }
    }

    /// What the sensor receives along a camera ray, and what the ray met first.
    pub(super) fn radiance(&mut self, ray: Ray, draw: &Draw<N>, sampler: &Sampler) -> ([f64; 3], Option<SurfacePoint>) {
        let world = self.walker.world;
        let (mut sum, mut first) = ([0.0; 3], None);
        self.walker.started = self.walker.stats.rays;
        let moved = self.walker.stats.polarization;
        let mut next = Some(Path::from_camera(world, draw, ray));
        while let Some(mut path) = next.take().or_else(|| self.walker.pending.pop()) {
            if path.vertices >= self.walker.transport.last_vertex() {
                self.walker.stats.stopped += path.weight(draw);
                continue;
            }
            let Some(meeting) = self.walker.meet(&mut path, draw) else {
                let light = self.background(&path, draw);
                self.note(&path, draw, f64::INFINITY, light);
                self.receive(&path, light, &mut sum);
                continue;
            };
            let Meeting { point, straight, .. } = &meeting;
            if let Some(straight) = straight
                && path.throughput.through(straight.share()) == path.throughput
            {
                next = Some(path.passed(point));
                continue;
            }
            if path.vertices == 0 && first.is_none() && straight::is_met(world, draw, sampler, &path, *straight) {
                first = Some(*point);
            }
            path.vertices += 1;
            let light = self.emission(&path, draw, &meeting);
            self.receive(&path, light, &mut sum);
            if path.vertices > world.method.max_bounces {
                if !matches!(world.scene.material_of(meeting.hit.object), Material::Emissive(_)) {
                    self.walker.stats.stopped += path.weight(draw) / draw.siblings(path.parted);
                }
                next = straight.map(|straight| path.passed_in_part(point, &straight));
                continue;
            }
            let before = sum;
            next = self.scatter(&path, draw, sampler, &meeting, &mut sum);
            if straight.is_none() {
                self.note(&path, draw, meeting.hit.crossing.t, std::array::from_fn(|i| light[i] + sum[i] - before[i]));
            }
        }
        if let Transport::Deterministic { most, .. } = self.walker.transport {
            self.walker.stats.by_chance += u64::from(self.walker.surfaces() > most);
        }
        self.count_light(sum, moved);
        (sum, first)
    }

    /// The light of the sky at the end of a path that meets nothing.
    fn background(&self, path: &Path<N>, draw: &Draw<N>) -> [f64; 3] {
        let world = self.walker.world;
        let mut sum = [0.0; 3];
        for &id in &world.scene.skies {
            let light = &world.scene.lights[id];
            if self.is_found_by_photons(path, id) {
                continue;
            }
            let factor = match light {
                Light::Sun(sun) if sun.pdf(&path.ray).is_some() => sun.radiance_factor(),
                Light::Sun(_) => continue,
                _ => 1.0,
            };
            let weight = weight_of_meeting(world, id, path.scatter.as_ref(), &path.ray, None);
            let arriving = path.throughput.scaled(weight * factor).of(light.toward(draw, path.ray.direction, [0.0; 2]));
            add(&mut sum, world.responses[id].sensor(draw, arriving, path.parted));
        }
        sum
    }

    /// The light of a surface that shines by itself.
    fn emission(&mut self, path: &Path<N>, draw: &Draw<N>, Meeting { hit, point, .. }: &Meeting<N>) -> [f64; 3] {
        let world = self.walker.world;
        let object = &world.scene.objects[hit.object as usize];
        let Some(id) = object.light else { return [0.0; 3] };
        let Light::Area(area) = &world.scene.lights[id] else { return [0.0; 3] };
        if !area.sides.shine(point.normal.dot(path.ray.direction) < 0.0) || self.is_found_by_photons(path, id) {
            return [0.0; 3];
        }
        if let (Some(met), Some(_)) = (&mut self.met, &path.scatter) {
            met.push((id, point.normal));
        }
        let weight = weight_of_meeting(world, id, path.scatter.as_ref(), &path.ray, Some(&hit.crossing));
        let uv = object.uv(&hit.crossing, point);
        let light = path.throughput.scaled(weight).of(draw.read_at(&area.radiance, uv));
        world.responses[id].sensor(draw, light, path.parted)
    }

    /// Adds what lights send straight to a surface, and answers how the path goes on; further ways on become pending.
    fn scatter(
        &mut self,
        path: &Path<N>,
        draw: &Draw<N>,
        sampler: &Sampler,
        meeting: &Meeting<N>,
        sum: &mut [f64; 3],
    ) -> Option<Path<N>> {
        let world = self.walker.world;
        let boundary = self.walker.boundary(path, meeting);
        let material = world.scene.material_of(meeting.hit.object);
        if boundary.here == boundary.beyond && material.medium().is_some() {
            return Some(self.walker.pass_hidden(path, meeting, &boundary));
        }
        let at = Interaction::new(world, draw, path, meeting, boundary);
        let diffuse = material.is_diffuse();
        let goes_on = !diffuse || path.diffuse_left > 0;
        let bright = world.bright.as_ref().filter(|_| may_aim(material));
        let aiming = bright.and_then(|bright| bright.at(at.point.position, at.flat));
        let (mut u, mut scatter) = ([0.0; 4], None);
        if material.scatters_widely() {
            let spread = path.vertices <= SPREAD;
            u = if spread { sampler.four(path.key, SCATTER) } else { sampler.four_plain(path.key, SCATTER) };
            let all_lights = world.aims_at_all(path.weight(draw));
            let lit = Lit { polarized: path.polarized, moved: Cell::new(0.0) };
            let may_be = path.polarized.is_any() || world.has_see_through();
            let counted = may_be.then_some(&lit);
            let gathering = Gathering {
                world,
                material,
                arrival: &at.arrival,
                point: &at.point,
                throughput: path.throughput,
                parted: path.parted,
                normal: at.flat,
                side: None,
                inside: at.boundary.here,
                goes_on,
                aims_at_all: all_lights,
                hider: &self.walker.last_occluder,
                lit: counted,
                u,
                aiming: aiming.as_ref(),
            };
            let far = material.scatters_through().then_some((at.boundary.beyond, at.parts));
            let chance = gathering.gather(far, sampler, path.key, sum);
            self.walker.stats.polarization += lit.moved.get();
            if goes_on && path.kind != PathKind::Camera {
                self.gather_photons(path, &at, sampler, sum);
            }
            scatter = Some(ScatterSample {
                pdf: 0.0,
                from: at.point.position,
                normal: at.flat,
                chance,
                all_lights,
                passed: false,
            });
            if !goes_on && meeting.straight.is_none() && !material.has_single_directions() {
                return None;
            }
        }

        self.walker.branches.clear();
        match &aiming {
            Some(aiming) => self.scatter_aimed(aiming, &at, [u[2], u[3]]),
            None => shading::scatter(material, &at.arrival, at.flat, [u[2], u[3]], &mut self.walker.branches),
        }
        if !goes_on {
            self.walker.branches.retain(|branch| branch.pdf.is_none());
        }
        let mut departure = Departure::new(world, path, &at).with(scatter.as_ref(), meeting.straight.as_ref());
        self.walker.follow(&mut departure, sampler)
    }

    /// Adds what photons bring to a place that the path has reached by way of others.
    fn gather_photons(&mut self, path: &Path<N>, at: &Interaction<N>, sampler: &Sampler, sum: &mut [f64; 3]) {
        if let Some(photons) = self.photons {
            let (light, moved) = photons.gather(self.walker.world, path, at, sampler);
            self.walker.stats.polarization += moved;
            add(sum, light);
            add(&mut self.gathered, light);
        }
        if let Some(reached) = &mut self.reached {
            reached.push(at.point.position);
        }
    }

    /// Whether the path's way to a light is one that photons find.
    fn is_found_by_photons(&self, path: &Path<N>, light: LightId) -> bool {
        path.kind == PathKind::Smooth { aimed: true } && self.walker.world.sends_photons(light)
    }
}

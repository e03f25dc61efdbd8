//! The loop that follows rays back to the light.

use std::cell::Cell;

use super::aimed::may_aim;
use super::brightness::Bounce;
use super::direct::{Gathering, add, weight_of_meeting};
use super::media::{self, Boundary};
use super::merge::Photons;
use super::path::{Drawn, Leg, Path};
use super::polarization::Lit;
use super::shading;
use super::straight;
use super::tally::Tally;
use super::{Transport, World};
use crate::light::{Light, LightId};
use crate::material::{Arrival, Branch, Material, Straight};
use crate::math::{DVec3, Ray, Sampler};
use crate::scene::Hit;
use crate::shape::SurfacePoint;
use crate::spectrum::Draw;

/// Follows the rays of camera samples, one sample after another; its buffers live as long as it does.
pub(super) struct Tracer<'a, const N: usize> {
    pub(super) world: &'a World,
    pub(super) transport: Transport,
    pub(super) pending: Vec<Path<N>>,
    pub(super) branches: Vec<Branch<N>>,
    /// The object that hid the last light that was hidden: the first to ask about the next one.
    pub(super) hider: Cell<Option<u32>>,
    pub(super) tally: Tally,
    /// Rays that were followed before this camera sample.
    pub(super) started: u64,
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

/// How much sooner roulette ends paths that leave a diffuse surface than those that leave a smooth one: what they still
/// gather varies little. Measured on the smallpt scene, where 1 takes 1.17 times as long to an equal error.
const SOONER: f64 = 5.0;

/// Uses of the random numbers at a vertex.
const SCATTER: u32 = 1;
/// Surfaces of a path whose directions are drawn from a sequence spread over the pixel's samples. Behind them the samples
/// see so many different places that plain random numbers, which cost less, are taken.
const SPREAD: u32 = 4;

impl<'a, const N: usize> Tracer<'a, N> {
    pub(super) fn new(world: &'a World) -> Self {
        let (pending, branches, hider) = (Vec::new(), Vec::new(), Cell::new(None));
        let (transport, tally, started, gathered) = (world.method.transport, Tally::default(), 0, [0.0; 3]);
        let (met, photons, reached, bounces) = (None, None, None, None);
        Self { world, transport, pending, branches, hider, tally, started, met, photons, gathered, reached, bounces }
    }

    pub(super) fn with_transport(self, transport: Transport) -> Self {
        Self { transport, ..self }
    }

    /// What the sensor receives along a camera ray, and what the ray met first.
    pub(super) fn radiance(&mut self, ray: Ray, draw: &Draw<N>, sampler: &Sampler) -> ([f64; 3], Option<SurfacePoint>) {
        let mut sum = [0.0; 3];
        let mut first = None;
        self.started = self.tally.rays;
        let moved = self.tally.polarization;
        let mut next = Some(Path::from_camera(self.world, draw, ray));
        while let Some(mut path) = next.or_else(|| self.pending.pop()) {
            if path.vertices >= self.world.method.transport.last_vertex() {
                self.tally.stopped += path.weight(draw);
                next = None;
                continue;
            }
            self.tally.rays += 1;
            let Some(hit) = self.world.scene.intersect(&path.ray) else {
                path.advance(self.world, draw, f64::INFINITY);
                let light = self.background(&path, draw);
                self.note(&path, draw, f64::INFINITY, light);
                self.receive(&path, light, &mut sum);
                next = None;
                continue;
            };
            path.advance(self.world, draw, hit.crossing.t);
            let point = self.world.scene.objects[hit.object as usize].point(&path.ray, &hit.crossing);
            let onward = straight::straight_on(self.world, draw, &path, &hit, &point);
            if let Some(onward) = onward
                && path.throughput.through(onward.share()) == path.throughput
            {
                next = Some(path.passed(&point));
                continue;
            }
            if path.vertices == 0 && first.is_none() && straight::is_met(self.world, draw, sampler, &path, onward) {
                first = Some(point);
            }
            path.vertices += 1;
            let light = self.emission(&path, draw, &hit, &point);
            self.receive(&path, light, &mut sum);
            if path.vertices > self.world.method.max_bounces {
                if !matches!(self.world.scene.material_of(hit.object), Material::Emissive(_)) {
                    self.tally.stopped += path.weight(draw) / draw.siblings(path.parted);
                }
                next = onward.map(|onward| path.passed_in_part(&point, &onward));
                continue;
            }
            let before = sum;
            next = self.scatter(&path, draw, sampler, (&hit, &point, onward), &mut sum);
            if onward.is_none() {
                self.note(&path, draw, hit.crossing.t, std::array::from_fn(|i| light[i] + sum[i] - before[i]));
            }
        }
        if let Transport::Deterministic { most, .. } = self.transport {
            self.tally.by_chance += u64::from(self.surfaces() > most);
        }
        self.count_light(sum, moved);
        (sum, first)
    }

    /// The light of the sky at the end of a path that meets nothing.
    fn background(&self, path: &Path<N>, draw: &Draw<N>) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for &id in &self.world.scene.skies {
            let light = &self.world.scene.lights[id];
            if self.is_found_by_photons(path, id) {
                continue;
            }
            let factor = match light {
                Light::Sun(sun) if sun.pdf(&path.ray).is_some() => sun.radiance_factor(),
                Light::Sun(_) => continue,
                _ => 1.0,
            };
            let weight = weight_of_meeting(self.world, id, path.drawn.as_ref(), &path.ray, None);
            let arriving = path.throughput.scaled(weight * factor).of(light.toward(draw, path.ray.direction, [0.0; 2]));
            add(&mut sum, self.world.responses[id].sensor(draw, arriving, path.parted));
        }
        sum
    }

    /// The light of a surface that shines by itself.
    fn emission(&mut self, path: &Path<N>, draw: &Draw<N>, hit: &Hit, point: &SurfacePoint) -> [f64; 3] {
        let Some(id) = self.world.scene.objects[hit.object as usize].light else { return [0.0; 3] };
        let Light::Area(area) = &self.world.scene.lights[id] else { return [0.0; 3] };
        if !area.sides.shine(point.normal.dot(path.ray.direction) < 0.0) || self.is_found_by_photons(path, id) {
            return [0.0; 3];
        }
        if let (Some(met), Some(_)) = (&mut self.met, &path.drawn) {
            met.push((id, point.normal));
        }
        let weight = weight_of_meeting(self.world, id, path.drawn.as_ref(), &path.ray, Some(&hit.crossing));
        let uv = self.world.scene.objects[hit.object as usize].uv(&hit.crossing, point);
        let light = path.throughput.scaled(weight).of(draw.read_at(&area.radiance, uv));
        self.world.responses[id].sensor(draw, light, path.parted)
    }

    /// Adds what lights send straight to a surface, and answers how the path goes on; further ways on become pending.
    fn scatter(
        &mut self,
        path: &Path<N>,
        draw: &Draw<N>,
        sampler: &Sampler,
        (hit, point, onward): (&Hit, &SurfacePoint, Option<Straight<N>>),
        sum: &mut [f64; 3],
    ) -> Option<Path<N>> {
        let world = self.world;
        let object = &world.scene.objects[hit.object as usize];
        let material = world.scene.material_of(hit.object);
        let front = point.normal.dot(path.ray.direction) < 0.0;
        let [normal, shading] = shading::normals(point, -path.ray.direction);

        // Find the media on both sides; a body hidden inside another of higher priority has no surface there.
        let (Boundary { here, beyond, crossed }, fits) = path.media.at_surface(world, object.material, front);
        self.tally.unmatched += u64::from(!fits);
        if here == beyond && material.medium().is_some() {
            // No light was aimed at through this surface, so what the path meets beyond counts in full.
            let (ray, key) = (point.leave(path.ray.direction), path.key.child(0));
            let leg = path.leg.then(world.has_map(), false, Some(world.is_photon_target(hit.object)));
            return Some(Path { ray, media: crossed, key, drawn: None, leg, ..*path });
        }
        let arrival = Arrival {
            wo: -path.ray.direction,
            normal: shading,
            uv: object.uv(&hit.crossing, point),
            draw,
            present: path.throughput.present(),
            incident: media::index(world, draw, here),
            beyond: media::index(world, draw, beyond),
            direction_indices: media::direction_indices(world, [here, beyond]),
            together: world.method.together,
        };

        // Gather light from the lights where light scatters widely.
        let (mut u, mut drawn) = ([0.0; 4], None);
        let parts = material.lets_through() && material.parts_lanes(&arrival);
        let (wide, diffuse) = (material.scatters_widely(), material.is_diffuse());
        let aiming = world.bright.as_ref().filter(|_| may_aim(material));
        let aiming = aiming.and_then(|bright| bright.at(point.position, normal));
        if wide {
            let spread = path.vertices <= SPREAD;
            u = if spread { sampler.four(path.key, SCATTER) } else { sampler.four_plain(path.key, SCATTER) };
            let aims_at_all = world.aims_at_all(path.weight(draw));
            let goes_on = !diffuse || path.diffuse_left > 0;
            let lit = Lit { polarized: path.polarized, moved: Cell::new(0.0) };
            let may_be = path.polarized.is_any() || world.has_see_through();
            let counted = may_be.then_some(&lit);
            let gathering = Gathering {
                world,
                material,
                arrival: &arrival,
                point,
                throughput: path.throughput,
                parted: path.parted,
                normal,
                side: None,
                inside: here,
                goes_on,
                aims_at_all,
                hider: &self.hider,
                lit: counted,
                u,
                aiming: aiming.as_ref(),
            };
            let far = material.scatters_through().then_some((beyond, parts));
            let chance = gathering.gather(far, sampler, path.key, sum);
            self.tally.polarization += lit.moved.get();
            if goes_on && path.leg != Leg::Camera {
                if let Some(photons) = self.photons {
                    let (light, moved) =
                        photons.gather(world, path, &arrival, (point, normal), (material, parts), sampler);
                    self.tally.polarization += moved;
                    add(sum, light);
                    add(&mut self.gathered, light);
                }
                if let Some(reached) = &mut self.reached {
                    reached.push(point.position);
                }
            }
            let (pdf, from, aimed_at_all, passed) = (0.0, point.position, aims_at_all, false);
            drawn = Some(Drawn { pdf, from, normal, chance, aimed_at_all, passed });
            if !goes_on && onward.is_none() && !material.has_single_directions() {
                return None;
            }
        }

        // Send the path on.
        self.branches.clear();
        match &aiming {
            Some(aiming) => self.scatter_aimed(aiming, (material, &arrival), normal, [u[2], u[3]]),
            None => shading::scatter(material, &arrival, normal, [u[2], u[3]], &mut self.branches),
        }
        if diffuse && path.diffuse_left == 0 {
            self.branches.retain(|branch| branch.pdf.is_none());
        }
        let onward = onward.map(|onward| {
            self.branches.push(Branch::onward(&path.ray, &onward));
            (self.branches.len() - 1, onward)
        });
        self.tally.partings += u64::from(self.branches.iter().filter(|branch| branch.crosses).count() > 1);
        let sooner = if diffuse { SOONER } else { 1.0 };
        self.follow(path, draw, sampler, (parts, sooner), |number, branch, factor| {
            if let Some((_, onward)) = onward.filter(|onward| onward.0 == number) {
                let onward = path.passed_in_part(point, &onward);
                return Path { throughput: onward.throughput.scaled(factor), key: path.key.child(number), ..onward };
            }
            let followed = shading::is_plain(point, arrival.wo, branch.wi, branch.crosses);
            let aimed = followed.then(|| world.is_photon_target(hit.object));
            Path {
                ray: point.leave(branch.wi),
                throughput: path.throughput.through(branch.share).scaled(factor),
                eta_scale: path.eta_scale * branch.eta_scale,
                media: if branch.crosses { crossed } else { path.media },
                parted: path.parted || (parts && branch.crosses),
                key: path.key.child(number),
                vertices: path.vertices,
                length: path.length,
                leg: path.leg.then(world.has_map(), branch.pdf.is_some(), aimed),
                diffuse_left: path.diffuse_left - u32::from(diffuse && branch.pdf.is_some()),
                drawn: branch.pdf.and_then(|pdf| drawn.map(|drawn: Drawn| drawn.toward(pdf, branch.crosses))),
                polarized: match branch.pdf {
                    Some(_) => path.polarized.scattered(material, &arrival, branch.wi),
                    None => path.polarized.after(branch.polarization),
                },
            }
        })
    }

    /// Whether the path's way to a light is one that photons find.
    fn is_found_by_photons(&self, path: &Path<N>, light: LightId) -> bool {
        path.leg == Leg::Smooth { aimed: true } && self.world.sends_photons(light)
    }
}

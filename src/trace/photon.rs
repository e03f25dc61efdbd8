//! Photons: light followed forward over smooth surfaces, to where the camera sees it.

use super::World;
use super::media::{self, Boundary, Media};
use super::path::{Leg, Path};
use super::polarization::Polarized;
use super::shading;
use super::straight;
use super::tracer::Tracer;
use crate::light::{LeSample, LightId};
use crate::material::Arrival;
use crate::math::{BranchKey, DVec3, Sampler};
use crate::scene::{Hit, MaterialId};
use crate::shape::SurfacePoint;
use crate::spectrum::{Draw, Lanes, Throughput};

/// Use of the random numbers where a photon is seen: the point of the lens.
const LENS: u32 = 3;

/// What a photon adds to a pixel of the window.
#[derive(Clone, Copy, Debug)]
pub(super) struct Splat {
    pub(super) pixel: u32,
    /// By what share polarization may change it.
    pub(super) change: f32,
    pub(super) rgb: [f64; 3],
}

/// Where a photon lands: the surface, both media and the light's way there.
pub(super) struct Landing<'a, const N: usize> {
    pub(super) path: &'a Path<N>,
    pub(super) arrival: &'a Arrival<'a, N>,
    /// The surface's own normal, on the side of the light.
    pub(super) flat: DVec3,
    pub(super) point: &'a SurfacePoint,
    pub(super) hit: &'a Hit,
    media: [Option<MaterialId>; 2],
    pub(super) light: LightId,
    /// Flux per emission.
    factor: f64,
}

impl<const N: usize> Landing<'_, N> {
    /// What the light shines on the photon's way, per emission.
    fn shone(&self, world: &World) -> Lanes<N> {
        world.scene.lights[self.light].toward(self.arrival.draw, -self.path.ray.direction, [0.0; 2])
    }

    /// What the photon brings: its flux, lane by lane.
    pub(super) fn flux(&self, world: &World) -> Lanes<N> {
        self.path.throughput.scaled(self.factor / self.path.eta_scale).of(self.shone(world))
    }
}

impl<const N: usize> Tracer<'_, N> {
    /// Follows a photon over smooth surfaces; `land` is told where it lands on others.
    ///
    /// The first surface must be one that photons are sent to: paths by way of others are left to the camera's rays.
    /// Throughput is followed as if the light were the viewer; flux is what is left of it without the factor of radiance
    /// between media.
    pub(super) fn photon(
        &mut self,
        emitted: &LeSample,
        light: LightId,
        media: Media,
        draw: &Draw<N>,
        sampler: &Sampler,
        land: &mut impl FnMut(&Self, &Landing<N>),
    ) {
        let world = self.world;
        let mut next = Some(Path {
            ray: emitted.ray,
            throughput: Throughput::starting(draw.start()),
            eta_scale: 1.0,
            media,
            parted: false,
            key: BranchKey::CAMERA,
            vertices: 0,
            length: 0.0,
            leg: Leg::Other,
            diffuse_left: 0,
            drawn: None,
            polarized: Polarized::NOT,
        });
        while let Some(mut path) = next.take().or_else(|| self.pending.pop()) {
            if path.vertices >= self.transport.last_vertex() {
                continue;
            }
            self.tally.rays += 1;
            let Some(hit) = world.scene.intersect(&path.ray) else { continue };
            path.advance(world, draw, hit.crossing.t);
            let point = world.scene.objects[hit.object as usize].point(&path.ray, &hit.crossing);
            if let Some(onward) = straight::straight_on(world, draw, &path, &hit, &point) {
                let (throughput, key) = (path.throughput.through(onward.share()), path.key.child(BEYOND));
                let all = throughput == path.throughput;
                let polarized = path.polarized.after(onward.polarization);
                self.pending.push(Path { throughput, key, polarized, ..path.passed(&point) });
                if all {
                    continue;
                }
            }
            if path.vertices == 0 && !world.is_photon_target(hit.object) {
                continue;
            }
            path.vertices += 1;
            next = self.bounce(&path, draw, sampler, (&hit, &point), (light, emitted.factor), land);
        }
    }

    /// Lets a photon land on a surface that scatters widely, and answers how it goes on over smooth ones.
    fn bounce(
        &mut self,
        path: &Path<N>,
        draw: &Draw<N>,
        sampler: &Sampler,
        (hit, point): (&Hit, &SurfacePoint),
        (light, factor): (LightId, f64),
        land: &mut impl FnMut(&Self, &Landing<N>),
    ) -> Option<Path<N>> {
        let world = self.world;
        let material = world.scene.material_of(hit.object);
        let front = point.normal.dot(path.ray.direction) < 0.0;
        let (Boundary { here, beyond, crossed }, fits) =
            path.media.at_surface(world, world.scene.objects[hit.object as usize].material, front);
        self.tally.unmatched += u64::from(!fits);
        if here == beyond && material.medium().is_some() {
            let (ray, key) = (point.leave(path.ray.direction), path.key.child(0));
            return Some(Path { ray, media: crossed, key, ..*path });
        }
        let [flat, normal] = shading::normals(point, -path.ray.direction);
        let arrival = Arrival {
            wo: -path.ray.direction,
            normal,
            uv: world.scene.objects[hit.object as usize].uv(&hit.crossing, point),
            draw,
            present: path.throughput.present(),
            incident: media::index(world, draw, here),
            beyond: media::index(world, draw, beyond),
            direction_indices: media::direction_indices(world, [here, beyond]),
            together: world.method.together,
        };
        let diffuse = material.is_diffuse();
        if material.scatters_widely() {
            // As often as light may leave surfaces on its way from the camera.
            let allowed = path.vertices <= world.method.max_bounces && !(diffuse && world.method.diffuse_bounces == 0);
            let landing = Landing { path, arrival: &arrival, flat, point, hit, media: [here, beyond], light, factor };
            if allowed && path.vertices > 1 {
                land(self, &landing);
            }
        }
        let arrival = Arrival { normal: shading::plain_normal(point, arrival.wo), ..arrival };
        let goes_on = material.has_single_directions() && arrival.wo.dot(arrival.normal) > 0.0;
        if !goes_on || path.vertices >= world.method.max_bounces {
            return None;
        }
        self.branches.clear();
        let u = sampler.four_plain(path.key, SCATTER);
        material.scatter(&arrival, [u[0], u[1]], &mut self.branches);
        let (back, forward) = (arrival.wo, arrival.forward());
        self.branches
            .retain(|branch| branch.pdf.is_none() && shading::is_plain(point, branch.wi, back, branch.crosses));
        for branch in &mut self.branches {
            branch.share = branch.share * shading::forward_factor(point, branch.wi, back) as f32;
            if let (Some(forward), true) = (&forward, branch.crosses) {
                branch.share = branch.share * *forward;
            }
        }
        let parts = material.lets_through() && material.parts_lanes(&arrival);
        self.follow(path, draw, sampler, (parts, 1.0), |number, branch, factor| Path {
            ray: point.leave(branch.wi),
            throughput: path.throughput.through(branch.share).scaled(factor),
            eta_scale: path.eta_scale * branch.eta_scale,
            media: if branch.crosses { crossed } else { path.media },
            parted: path.parted || (parts && branch.crosses),
            key: path.key.child(number),
            polarized: path.polarized.after(branch.polarization),
            ..*path
        })
    }

    /// Adds what the camera sees of a photon.
    pub(super) fn show(&self, landing: &Landing<N>, sampler: &Sampler, splats: &mut Vec<Splat>) {
        let Landing { path, arrival, flat, point, hit, media, light, factor } = landing;
        let world = self.world;
        let (camera, film) = (&world.scene.camera, world.scene.film);
        let u = if camera.has_lens() { sampler.four_plain(path.key, LENS) } else { [0.5; 4] };
        let Some(seen) = camera.see(point.position, [u[0], u[1]]) else { return };
        let (window, reach) = (film.window(), film.filter.reach());
        let mut places = camera.places(seen.film, reach);
        places.retain(|place| {
            let near =
                |x: f64, from: u32, size: u32| x >= f64::from(from) - reach && x <= f64::from(from + size) + reach;
            near(place.x, window.left, window.width) && near(place.y, window.top, window.height)
        });
        if places.is_empty() {
            return;
        }
        // The surface as the camera sees it.
        let same = seen.direction.dot(*flat) > 0.0;
        let [side, normal] = shading::normals(point, seen.direction);
        let turned = Arrival { wo: seen.direction, normal, ..**arrival };
        let viewed = if same { turned } else { turned.turned_around() };
        let material = world.scene.material_of(hit.object);
        let Some((bsdf_cos, _)) = shading::evaluate(material, &viewed, side, arrival.wo) else { return };
        let parted = path.parted || (!same && material.lets_through() && material.parts_lanes(&viewed));
        let cosines = seen.direction.dot(*flat).abs() / arrival.wo.dot(*flat).abs();
        let ray = point.leave(seen.direction);
        let distance = (seen.start - ray.origin).length();
        let inside = media[usize::from(!same)];
        let (mut shone, mut polarized) = (landing.shone(world), Polarized::NOT);
        if world.has_see_through() {
            let closed = |object| !world.is_see_through(object);
            if world.scene.is_hidden_by(&ray, distance, None, &self.hider, closed) {
                return;
            }
            match straight::transmittance(world, arrival.draw, &ray, distance, inside) {
                Some((share, of_panes)) => (shone, polarized) = (shone * share, of_panes),
                None => return,
            }
        } else if world.scene.is_hidden(&ray, distance, None, &self.hider) {
            return;
        }
        if let Some(material) = inside {
            shone = shone * media::medium(world, material).transmission(arrival.draw, distance);
        }
        let arriving = path.throughput.scaled(1.0 / path.eta_scale).of(bsdf_cos * shone);
        let rgb = world.responses[*light].sensor(arrival.draw, arriving, parted);
        let rgb = rgb.map(|x| x * (factor * cosines * seen.importance));
        let change = polarized.brought((material, &viewed), (arrival.wo, path.polarized)).change() as f32;
        for place in places {
            let first = |x: f64, from: u32| (x - reach - 0.5).floor().max(f64::from(from)) as u32;
            let last = |x: f64, from: u32, size: u32| (x + reach).floor().min(f64::from(from + size - 1)) as u32;
            for y in first(place.y, window.top)..=last(place.y, window.top, window.height) {
                for x in first(place.x, window.left)..=last(place.x, window.left, window.width) {
                    let middle = crate::math::DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                    let density = film.filter.density(place - middle);
                    if density > 0.0 {
                        let pixel = (y - window.top) * window.width + (x - window.left);
                        splats.push(Splat { pixel, change, rgb: rgb.map(|channel| channel * density) });
                    }
                }
            }
        }
    }
}

/// The branch of what passes holes, beyond those that a material may have.
const BEYOND: usize = 64;
/// Use of the random numbers where a photon leaves a surface.
const SCATTER: u32 = 4;

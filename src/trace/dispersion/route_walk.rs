//! Follows the routes of one pixel back to the lights, the brightest first.

use super::route::{ROUTES_NM, Route, RouteEvent, RouteVertex, RouteWalk, Step};
use crate::light::{Light, LightId};
use crate::material::{Facets, Interface, Material, reflect};
use crate::math::{DVec3, Ray, Sampler, sample_cosine_about};
use crate::spectrum::{Draw, Lanes, Table};
use crate::trace::walk::{SurfaceHit, pass_through, shading};
use crate::trace::{World, media};

/// Maximum number of surfaces that are hit for one pixel.
const MAX_SURFACES: usize = 256;
/// Routes that leave less than this share of a pixel's brightest one are not followed.
const MIN_SHARE: f32 = 1e-3;
/// Maximum number of diffuse surfaces of a route.
const MAX_SCATTERED: u32 = 2;
/// Maximum number of lights that are sampled.
const MAX_LIGHTS: usize = 8;

/// Follows the routes of one pixel, the brightest first.
pub struct RouteWalker<'a> {
    world: &'a World,
    draw: Draw<4>,
    sampler: Sampler,
    pending: Vec<RouteWalk>,
    pub routes: Vec<Route>,
}

impl<'a> RouteWalker<'a> {
    pub fn new(world: &'a World, sampler: Sampler) -> Self {
        let draw = Draw::fixed(ROUTES_NM.len());
        Self { world, draw, sampler, pending: Vec::new(), routes: Vec::new() }
    }

    /// Follows the routes of a camera ray, and returns the number of surfaces hit.
    pub fn walk(&mut self, ray: Ray) -> usize {
        self.pending.push(RouteWalk::from_camera(self.world, ray));
        let mut best = 0.0_f32;
        for count in 0..MAX_SURFACES {
            let order =
                |a: &usize, b: &usize| self.pending[*a].max_throughput().total_cmp(&self.pending[*b].max_throughput());
            let Some(next) = (0..self.pending.len()).max_by(order) else { return count };
            let walk = self.pending.swap_remove(next);
            if walk.max_throughput() <= MIN_SHARE * best {
                return count;
            }
            let (found_before, left) = (self.routes.len(), walk.max_throughput());
            self.advance(walk);
            if self.routes.len() > found_before {
                best = best.max(left);
            }
        }
        MAX_SURFACES
    }

    fn record(&mut self, walk: &RouteWalk, light: LightId) {
        let RouteWalk { steps, weight, scattered, .. } = walk;
        self.routes.push(Route { steps: steps.clone(), light, weight: *weight, scattered: *scattered });
    }

    /// Follows a route to the next surface, and finds how it continues.
    fn advance(&mut self, walk: RouteWalk) {
        let world = self.world;
        let hit = match walk.is_from_camera {
            true => world.scene.intersect_seen(&walk.ray, None),
            false => world.scene.intersect(&walk.ray),
        };
        let Some(hit) = hit else {
            for &id in &world.scene.infinite_lights {
                let is_hidden = walk.is_from_camera && world.scene.hidden_lights.contains(&id);
                let misses_sun = matches!(&world.scene.lights[id], Light::Sun(sun) if sun.pdf(&walk.ray).is_none());
                if !is_hidden && !misses_sun {
                    self.record(&walk, id);
                }
            }
            return;
        };
        let walk = self.inside(walk, hit.intersection.t);
        let object = &world.scene.objects[hit.object as usize];
        let surface_hit = SurfaceHit::new(world, &walk.ray, hit);
        let point = &surface_hit.point;
        let u = self.sampler.get_random_4d(walk.key, 0);
        if self.passes_hole(&walk, &surface_hit, u[3]) {
            let (ray, key) = (point.leave(walk.ray.direction), walk.key.child(0));
            self.pending.push(RouteWalk { ray, key, ..walk });
            return;
        }
        if let Some(light) = object.light
            && let Light::Area(area) = &world.scene.lights[light]
            && area.sides.shine(point.normal.dot(walk.ray.direction) < 0.0)
        {
            self.record(&walk, light);
        }
        let material = world.scene.material_of(hit.object);
        let [geometric, normal] = shading::normals(point, -walk.ray.direction);
        let uv = object.uv(&hit.intersection, point);
        let part = self.choose_part(material, uv, u[2]);
        let vertex = RouteVertex { walk: &walk, material: object.material, point, normal, uv, part, u };
        self.leave(&vertex, material.with_parts()[part], geometric);
    }

    /// Continues from a surface in all ways that light may take.
    fn leave(&mut self, vertex: &RouteVertex, material: &Material<Table>, geometric: DVec3) {
        let RouteVertex { walk, normal, uv, .. } = *vertex;
        let world = self.world;
        match material {
            Material::Mirror(mirror) => {
                let tint = self.draw.read_at(&mirror.reflectance, uv);
                self.follow_reflection(vertex, normal, tint, 1.0);
            }
            Material::Conductor(metal) => {
                let facet = metal.roughness.surface().map_or(normal, |surface| vertex.facet(surface.facets()));
                self.follow_reflection(vertex, facet, Lanes::ONE, 1.0);
            }
            Material::Thin(pane) => {
                let inside = media::index(&world.scene, &self.draw, walk.media.inside(&world.scene));
                let r = pane.reflectance_of_one_surface(&self.draw, 1, inside[1], vertex.wo().dot(normal));
                let tint = pane.transmittance().map_or(Lanes::ONE, |table| self.draw.read_at(table, uv));
                let transmitted = (1.0 - r) * (1.0 - r);
                let crossed = vertex.step(RouteEvent::Crossed);
                let straight = walk.after(Some(crossed), tint, transmitted);
                self.continue_straight(vertex, straight);
                // Mirrored by the first surface, and by the second.
                let mirrored_direction = reflect(vertex.wo(), normal);
                self.continue_toward(vertex, walk.after(None, Lanes::ONE, r), mirrored_direction, 1);
                let mirrored_by_back = walk.after(Some(crossed), tint, r * transmitted).after(Some(crossed), tint, 1.0);
                self.continue_toward(vertex, mirrored_by_back, mirrored_direction, 2);
            }
            Material::Dielectric(glass) => self.follow_glass(
                vertex,
                [&glass.reflectance, &glass.transmittance],
                glass.roughness.interface().map(|rough| rough.facets()),
            ),
            Material::Diffuse(diffuse) => {
                let tint = self.draw.read_at(&diffuse.reflectance, uv);
                self.scattered(vertex, geometric, tint, 1.0);
            }
            Material::Plastic(plastic) => {
                let index = self.draw.read_exact(&plastic.index)[1];
                let r = Interface::new(1.0, index, vertex.wo().dot(normal)).reflectance;
                self.continue_toward(vertex, walk.after(None, Lanes::ONE, r), reflect(vertex.wo(), normal), 1);
                let tint = self.draw.read_at(&plastic.reflectance, uv);
                self.scattered(vertex, geometric, tint, 1.0 - r);
            }
            Material::Polarizer(_) | Material::Retarder(_) => {
                self.continue_straight(vertex, walk.after(None, Lanes::ONE, 1.0));
            }
            Material::Emissive(_) | Material::Mix(_) | Material::Mask(_) => {}
        }
    }

    /// Returns the route after a distance through the body around it.
    fn inside(&self, walk: RouteWalk, distance: f64) -> RouteWalk {
        let Some(material) = walk.media.inside(&self.world.scene) else { return walk };
        let transmission = media::medium(&self.world.scene, material).transmission(&self.draw, distance);
        if transmission == Lanes::ONE {
            return walk;
        }
        walk.after(Some(Step { material, part: 0, way: RouteEvent::Inside(distance) }), transmission, 1.0)
    }

    /// Decides at random whether a hole lets the route pass.
    fn passes_hole(&self, walk: &RouteWalk, surface_hit: &SurfaceHit, u: f64) -> bool {
        let inside = walk.media.inside(&self.world.scene);
        u < pass_through::hole_transmittance(self.world, &self.draw, &walk.ray, inside, surface_hit)[1].into()
    }

    /// Returns the part of the material that is hit, at random if there are several.
    fn choose_part(&self, material: &Material<Table>, uv: [f64; 2], u: f64) -> usize {
        match material {
            Material::Mix(mix) => {
                let amount = f64::from(self.draw.read_at(&mix.amount, uv)[1]);
                let [first, second] = mix.materials.each_ref().map(|part| part.material());
                if u < amount {
                    1 + first.with_parts().len() + self.choose_part(second, uv, u / amount)
                } else {
                    1 + self.choose_part(first, uv, (u - amount) / (1.0 - amount))
                }
            }
            Material::Mask(mask) => 1 + self.choose_part(mask.material.material(), uv, u),
            _ => 0,
        }
    }

    /// Continues from a surface in a direction in which light is mirrored or scattered, or crosses a body's surface.
    fn continue_toward(&mut self, vertex: &RouteVertex, next: RouteWalk, direction: DVec3, number: usize) {
        if let Some(surfaces) = self.count_surface(vertex.walk) {
            self.enqueue(vertex, RouteWalk { is_from_camera: false, surfaces, ..next }, direction, number);
        }
    }

    /// Returns the number of surfaces of a route plus one; `None` if that is beyond the bounce limit.
    fn count_surface(&self, walk: &RouteWalk) -> Option<u32> {
        (walk.surfaces < self.world.method.max_bounces).then_some(walk.surfaces + 1)
    }

    /// Continues straight on as if nothing were there.
    fn continue_straight(&mut self, vertex: &RouteVertex, next: RouteWalk) {
        self.enqueue(vertex, next, vertex.walk.ray.direction, 0);
    }

    fn enqueue(&mut self, vertex: &RouteVertex, next: RouteWalk, direction: DVec3, number: usize) {
        if next.max_throughput() > 0.0 {
            let (ray, key) = (vertex.point.leave(direction), vertex.walk.key.child(number));
            self.pending.push(RouteWalk { ray, key, ..next });
        }
    }

    fn follow_reflection(&mut self, vertex: &RouteVertex, facet: DVec3, tint: Lanes<4>, factor: f64) {
        let step = vertex.step(RouteEvent::Reflected(vertex.wo().dot(facet).abs().min(1.0)));
        let next = vertex.walk.after(Some(step), tint, factor);
        self.continue_toward(vertex, next, reflect(vertex.wo(), facet), 0);
    }

    fn follow_glass(
        &mut self,
        vertex: &RouteVertex,
        [reflectance, transmittance]: [&Table; 2],
        facets: Option<&Facets>,
    ) {
        let (world, walk) = (self.world, vertex.walk);
        let (boundary, _) = walk.media.at_surface(&world.scene, vertex.material, vertex.point, walk.ray.direction);
        let [n1, n2] = boundary.sides().map(|inside| media::index(&world.scene, &self.draw, inside)[1]);
        let crossed = RouteWalk { media: walk.media.after_crossing(&boundary), ..walk.clone() };
        if boundary.here == boundary.beyond {
            return self.continue_straight(vertex, crossed);
        }
        let tint = self.draw.read_at(transmittance, vertex.uv);
        let step = Some(vertex.step(RouteEvent::Crossed));
        if n1 == n2 {
            return self.continue_toward(vertex, crossed.after(step, tint, 1.0), walk.ray.direction, 0);
        }
        let (wo, facet) = (vertex.wo(), facets.map_or(vertex.normal, |facets| vertex.facet(facets)));
        let interface = Interface::new(n1, n2, wo.dot(facet));
        if interface.transmittance > 0.0 {
            let next = crossed.after(step, tint, interface.transmittance);
            self.continue_toward(vertex, next, interface.refract(wo, facet), 0);
        }
        let mirrored = walk.after(
            Some(vertex.step(RouteEvent::Reflected(wo.dot(facet)))),
            self.draw.read_at(reflectance, vertex.uv),
            interface.reflectance,
        );
        self.continue_toward(vertex, mirrored, reflect(wo, facet), 1);
    }

    /// Follows the light that a surface scatters: directly from the lights, and from anywhere.
    fn scattered(&mut self, vertex: &RouteVertex, geometric: DVec3, tint: Lanes<4>, factor: f64) {
        let Some(surfaces) = self.count_surface(vertex.walk) else { return };
        let next = vertex.walk.after(Some(vertex.step(RouteEvent::Scattered)), tint, factor);
        let next = RouteWalk { scattered: next.scattered + 1, surfaces, ..next };
        for id in 0..self.world.scene.lights.len().min(MAX_LIGHTS) {
            self.connect_to_light(vertex, &next, geometric, id);
        }
        if next.scattered < MAX_SCATTERED && self.world.method.diffuse_bounces > 0 {
            let direction = sample_cosine_about(geometric, [vertex.u[0], vertex.u[1]]);
            self.continue_toward(vertex, next, direction, 3);
        }
    }

    /// Follows light directly from a light, through everything that lets it through.
    fn connect_to_light(&mut self, vertex: &RouteVertex, walk: &RouteWalk, normal: DVec3, id: LightId) {
        let (world, light) = (self.world, &self.world.scene.lights[id]);
        let Some(sample) = light.sample_li(vertex.point, normal, [vertex.u[1], vertex.u[0]]) else { return };
        let mut walk = RouteWalk { ray: sample.ray, ..walk.clone() };
        let mut remaining_distance = sample.distance;
        for _ in 0..MAX_SURFACES {
            let Some(hit) = world.scene.nearest(&walk.ray, remaining_distance, &|object| sample.object != Some(object))
            else {
                let walk = self.inside(walk, remaining_distance);
                return self.record(&walk, id);
            };
            walk = self.inside(walk, hit.intersection.t);
            remaining_distance -= hit.intersection.t;
            let object = &world.scene.objects[hit.object as usize];
            let surface_hit = SurfaceHit::new(world, &walk.ray, hit);
            let point = &surface_hit.point;
            if !self.passes_hole(&walk, &surface_hit, vertex.u[2]) {
                let uv = object.uv(&hit.intersection, point);
                let material = world.scene.material_of(hit.object);
                let part = self.choose_part(material, uv, vertex.u[2]);
                let transmittance = match material.with_parts()[part] {
                    Material::Thin(pane) => pane.transmittance(),
                    Material::Dielectric(glass) => Some(&glass.transmittance),
                    _ => return,
                };
                let step = Step { material: object.material, part, way: RouteEvent::Crossed };
                let tint = transmittance.map_or(Lanes::ONE, |table| self.draw.read_at(table, uv));
                let (boundary, _) = walk.media.at_surface(&world.scene, object.material, point, walk.ray.direction);
                let media = walk.media.after_crossing(&boundary);
                let surfaces = walk.surfaces + u32::from(boundary.here != boundary.beyond);
                if surfaces > world.method.max_bounces {
                    return;
                }
                walk = RouteWalk { media, surfaces, ..walk.after(Some(step), tint, 1.0) };
            }
            walk.ray = point.leave(walk.ray.direction);
        }
    }
}

//! Paths from the camera back to the lights.

use std::rc::Rc;

use super::aimed_scattering::{albedo, may_aim, scatter_aimed};
use super::dimensions;
use super::direct::DirectLighting;
use super::emitter_hit::EmitterHit;
use super::layer_sample::LayerSample;
use super::light_vertex_gathering::Resampling;
use super::sensor::{Sensor, SensorEvent};
use super::surface::{FirstHit, PathContinuation, Surface, Transmitted};
use crate::film::Layer;
use crate::light::LightId;
use crate::material::{Material, Straight};
use crate::math::Sampler;
use crate::scene::Visibility;
use crate::shape::SurfacePoint;
use crate::spectrum::{Draw, Lanes};
use crate::trace::contribution::{Contribution, FoundBy};
use crate::trace::photon::{GatherPoint, LightVertices, PhotonMap, gather, holds_vertices};
use crate::trace::received_light::ReceivedLight;
use crate::trace::walk::{
    Audit, DyeExcitation, Excitation, FoundLight, Interaction, ObjectSet, OutgoingPath, PassThrough, Path, PathKind,
    Polarization, Polarized, ScatterSample, SurfaceHit, Walker, pass_through, shading,
};
use crate::trace::{Method, Polarizing, Transport, World};

/// Traces the rays of camera samples back to the light, and samples the lights on the way.
pub struct PathTracer<'a, const N: usize, P: Polarization<N> = Polarized> {
    pub walker: Walker<'a, N, P>,
    pub sensor: Sensor<'a, N>,
    /// The photons to gather, if any.
    photons: Option<&'a PhotonMap<N, P>>,
    /// Vertices of light paths, if light is estimated there.
    pub light_vertices: Option<&'a LightVertices<N>>,
    /// What the lanes stand for, if that is the same for every sample.
    draw: Option<Draw<N>>,
    /// The dyes that the paths of the current sample have seen.
    excitations: Vec<Rc<Excitation<N, P>>>,
}

/// Share of the paths found at light vertices that continue if bounces are limited, to measure what limits leave out.
const MEASURED_SHARE: f64 = 1.0 / 16.0;

impl<'a, const N: usize, P: Polarization<N>> PathTracer<'a, N, P> {
    pub fn new(world: &'a World) -> Self {
        let basis = &world.method.basis;
        let draw = (!basis.draws_wavelengths()).then(|| basis.draw(0.0));
        let (walker, sensor) = (Walker::new(world, world.method.transport), Sensor::new());
        Self { walker, sensor, photons: None, light_vertices: None, draw, excitations: Vec::new() }
    }

    pub fn with_photons(self, photons: Option<&'a PhotonMap<N, P>>) -> Self {
        Self { photons, ..self }
    }

    /// Adds an observer, which is called with what paths find.
    pub fn with_observer(mut self, observer: &'a dyn Fn(SensorEvent)) -> Self {
        self.sensor.observer = Some(observer);
        self
    }

    /// Adds the layers that the world requests.
    pub fn with_layers(mut self) -> Self {
        let world = self.walker.world;
        self.sensor.layers = LayerSample::new(world);
        self.walker.audit = world.layers.offset(Layer::Residual).map(|_| Audit::new(world));
        self
    }

    /// Returns what the last camera sample left in the layers, if any are requested.
    pub fn layers(&mut self) -> Option<&mut LayerSample<'a, N>> {
        self.sensor.layers.as_mut()
    }

    /// Returns what the lanes of a camera sample stand for.
    pub fn draw(&self, wavelength: f64) -> Draw<N> {
        self.draw.clone().unwrap_or_else(|| self.walker.world.method.basis.draw(wavelength))
    }

    /// Returns how much gathered photons blur the last camera sample.
    pub fn blur(&mut self) -> [f64; 3] {
        std::mem::take(&mut self.sensor.blur)
    }

    /// Passes all light along the path of a camera ray to the sensor, and returns what the ray hit first.
    pub fn trace(&mut self, path: &Path<N, P>, draw: &Draw<N>, sampler: &Sampler) -> Option<SurfacePoint> {
        let mut first = None;
        self.walker.rays_before = self.walker.stats.rays;
        self.excitations.clear();
        *self.walker.pending.add(|| *path) = *path;
        while let Some(mut path) = self.walker.pending.take() {
            self.advance(&mut path, draw, sampler, &mut first);
            self.walker.pending.release(path);
        }
        if let Transport::Deterministic { max_sample_surfaces: max, .. } = self.walker.transport {
            self.walker.stats.by_chance += u64::from(self.walker.surfaces() > max);
        }
        first
    }

    /// Follows a path to the next surface. Sets `first` to what the camera ray hits first.
    #[inline(always)]
    fn advance(&mut self, path: &mut Path<N, P>, draw: &Draw<N>, sampler: &Sampler, first: &mut Option<SurfacePoint>) {
        let world = self.walker.world;
        let excitation = self.excitation(path);
        let draw = excitation.as_ref().map_or(draw, |excitation| &excitation.draw);
        if path.vertices >= self.walker.transport.max_surfaces() {
            self.walker.stats.stopped += path.share(draw);
            return;
        }
        self.sensor.ignores_light = path.ignores_light;
        let before = self.sensor.rgb;
        let Some(surface_hit) = self.walker.next_hit(path, draw) else {
            self.receive_sky(path, draw);
            self.sensor.report_bounce(world, path, draw, f64::INFINITY, before);
            return;
        };
        let boundary = match self.walker.boundary(path, &surface_hit) {
            Ok(boundary) => boundary,
            Err(hidden) => {
                self.receive(path, draw, EmitterHit::of_surface(world, draw, path, &surface_hit));
                self.sensor.report_bounce(world, path, draw, surface_hit.hit.intersection.t, before);
                return self.walker.pass_hidden(path, &surface_hit, &hidden);
            }
        };
        let mut transmitted = self.walker.straight(path, draw, &surface_hit);
        // Beyond a pane, a holdout is seen as through glass.
        let is_held_out = world.has_mattes
            && path.kind.is_from_camera()
            && first.is_none()
            && world.visibility(surface_hit.hit.object) == Visibility::Holdout;
        if is_held_out {
            // What lies behind a pane is cut out with it, but not what lies behind a hole.
            transmitted.iter_mut().for_each(|transmitted| transmitted.straight = transmitted.straight.through_holes());
            transmitted = transmitted.filter(|transmitted| !transmitted.straight.holes.is_zero());
        }
        let samples_cutout = world.has_mattes && path.surfaces() == 0 && first.is_none();
        let chance = if samples_cutout { self.sample_pass_through(path, draw, sampler, &mut transmitted) } else { 1.0 };
        let (SurfaceHit { hit, point }, transmitted) = (&surface_hit, transmitted.as_ref());
        if let Some(&PassThrough { straight, polarization }) = transmitted
            && path.throughput.through(straight.share()) == path.throughput
        {
            *self.walker.pending.add(|| *path) = Path { polarization, ..path.beyond_surface(point) };
            return;
        }
        path.vertices += 1;
        if is_held_out {
            self.walker.audit.iter_mut().for_each(|audit| audit.end(path, transmitted, draw));
            return self.walker.pass_partly(path, point, transmitted);
        }
        let is_first = path.surfaces() == 1 && first.is_none();
        let met = is_first.then(|| self.sample_first_hit(path, draw, sampler, &surface_hit, transmitted, first));
        self.receive(path, draw, EmitterHit::of_surface(world, draw, path, &surface_hit));
        let surface = Surface { surface_hit: &surface_hit, boundary, transmitted, first: met, chance };
        if path.surfaces() > world.method.max_bounces {
            return self.end_at_limit(path, draw, sampler, &surface);
        }
        self.scatter(path, draw, sampler, &surface);
        if transmitted.is_none() {
            self.sensor.report_bounce(world, path, draw, hit.intersection.t, before);
        }
    }

    /// Decides what the camera ray hits: a surface, which becomes `first`, or what is behind its holes.
    fn sample_first_hit(
        &mut self,
        path: &Path<N, P>,
        draw: &Draw<N>,
        sampler: &Sampler,
        surface_hit: &SurfaceHit,
        transmitted: Option<&PassThrough<N, P>>,
        first: &mut Option<SurfacePoint>,
    ) -> FirstHit {
        let pass_through::Cutout { is_hit, weight, .. } =
            pass_through::sample_cutout(self.walker.world, draw, sampler, path, transmitted);
        if let Some(layers) = &mut self.sensor.layers {
            layers.set_object(is_hit.then_some(surface_hit.hit.object), weight);
        }
        *first = is_hit.then_some(surface_hit.point);
        if is_hit { FirstHit::Here } else { FirstHit::Beyond }
    }

    /// Lets a path from the camera continue either from a surface or through its holes, with the probability of each. A
    /// holdout hides all that a sample shows, and a shadow catcher takes all of it. Returns the factor by which the
    /// throughput of a path was divided that continues from the surface.
    #[cold]
    fn sample_pass_through(
        &mut self,
        path: &mut Path<N, P>,
        draw: &Draw<N>,
        sampler: &Sampler,
        transmitted: &mut Transmitted<N, P>,
    ) -> f64 {
        let Method { transport, polarization, .. } = &self.walker.world.method;
        let is_by_chance = matches!(transport, Transport::Random { .. });
        // Beyond holes and panes together, light has the mean polarization of both.
        let is_mean = |straight: &Straight<N>| *polarization == Polarizing::Traced && !straight.panes.is_zero();
        let Some(whole) = transmitted.filter(|transmitted| is_by_chance && !is_mean(&transmitted.straight)) else {
            return 1.0;
        };
        let pass_through::Cutout { is_hit, chance, .. } =
            pass_through::sample_cutout(self.walker.world, draw, sampler, path, Some(&whole));
        let before = path.throughput;
        let (holes, panes) = if is_hit { (Lanes::ZERO, whole.straight.panes) } else { (Lanes::ONE, Lanes::ZERO) };
        if !is_hit {
            path.throughput = before.through(whole.straight.holes);
            path.key = path.key.child(0);
        }
        let straight = Straight { holes, panes, ..whole.straight };
        *transmitted = (!straight.share().is_zero()).then_some(PassThrough { straight, ..whole });
        path.throughput = path.throughput.scaled(1.0 / chance);
        self.walker.audit.iter_mut().for_each(|audit| audit.absorb(path, before, draw));
        if is_hit { chance } else { 1.0 }
    }

    /// Ends a path that has hit as many surfaces as allowed, except for what passes through.
    fn end_at_limit(&mut self, path: &Path<N, P>, draw: &Draw<N>, sampler: &Sampler, surface: &Surface<N, P>) {
        let &Surface { surface_hit, boundary, transmitted, .. } = surface;
        if self.sensor.layers.is_some() {
            let interaction = Interaction::new(self.walker.world, draw, &path.incident_ray(), surface_hit, boundary);
            self.record_surface(path, &interaction, surface, sampler);
        }
        if !matches!(self.walker.world.scene.material_of(surface_hit.hit.object), Material::Emissive(_)) {
            self.walker.stats.stopped += path.share(draw);
        } else if let Some(audit) = &mut self.walker.audit {
            audit.end(path, transmitted, draw);
        }
        self.walker.pass_partly(path, &surface_hit.point, transmitted);
    }

    /// Passes the light of the sky to the sensor, at the end of a path that hits nothing.
    fn receive_sky(&mut self, path: &Path<N, P>, draw: &Draw<N>) {
        let world = self.walker.world;
        self.walker.audit.iter_mut().for_each(|audit| audit.end(path, None, draw));
        for &light in &world.scene.infinite_lights {
            let is_hidden = path.kind.is_from_camera() && world.scene.hidden_lights.contains(&light);
            if !is_hidden {
                self.receive(path, draw, EmitterHit::of_sky(world, draw, path, light));
            }
        }
    }

    /// Passes light that a path has hit to the sensor, unless that light is found otherwise.
    fn receive(&mut self, path: &Path<N, P>, draw: &Draw<N>, met: Option<EmitterHit<N, P>>) {
        let Some(EmitterHit { light, lanes, normal, polarization }) = met else { return };
        if self.is_found_elsewhere(path, light) {
            return;
        }
        let received = ReceivedLight { source: light, draw, lanes: &lanes, parted: path.parted };
        let excitation = self.excitation(path);
        let met = FoundLight::new(self.walker.world, &received, excitation.as_deref());
        let (rgb, dispersed, polarization_change) = (met.rgb, met.dispersed, polarization.change_of_hit(&met));
        let (light, found) = (Some(light), FoundBy::Hit { normal, scattered: path.scatter.is_some() });
        let Path { bounces, first, .. } = *path;
        self.sensor.receive(
            Contribution { light, found, rgb, polarization_change, first, bounces, dispersed },
            &met,
            &polarization,
        );
    }

    /// Samples the lights where a surface scatters widely, and lets the path continue: its branches become pending.
    fn scatter(&mut self, path: &mut Path<N, P>, draw: &Draw<N>, sampler: &Sampler, surface: &Surface<N, P>) {
        let &Surface { surface_hit, boundary, transmitted, first, .. } = surface;
        if self.sensor.counted.ends_after(path.bounces) {
            return self.walker.pass_partly(path, &surface_hit.point, transmitted);
        }
        let world = self.walker.world;
        if path.resampled && world.ends_light_paths(surface_hit.hit.object) {
            path.resampled = false;
        }
        let ends = self.ends_at_light_vertices(path, draw, surface_hit, sampler);
        let path = &*path;
        if ends && !path.resampled {
            return;
        }
        let interaction = Interaction::new(world, draw, &path.incident_ray(), surface_hit, boundary);
        self.record_surface(path, &interaction, surface, sampler);
        let continuation = PathContinuation { transmitted, must_pass: first == Some(FirstHit::Beyond), gathers: !ends };
        match self.follow_dyes(path, &interaction, sampler, continuation.must_pass) {
            0.0 => {}
            1.0 => self.scatter_at(path, &interaction, sampler, continuation),
            factor => {
                let throughput = path.throughput.scaled(factor);
                self.scatter_at(&Path { throughput, ..*path }, &interaction, sampler, continuation);
            }
        }
    }

    /// Shows a surface to the layers, if any are requested.
    #[inline]
    fn record_surface(
        &mut self,
        path: &Path<N, P>,
        interaction: &Interaction<N>,
        surface: &Surface<N, P>,
        sampler: &Sampler,
    ) {
        if let Some(layers) = &mut self.sensor.layers {
            layers.record_surface(path, interaction, surface, sampler);
        }
    }

    /// Returns the dye that a path's light excites, if the path has seen one.
    #[inline]
    fn excitation(&self, path: &Path<N, P>) -> Option<Rc<Excitation<N, P>>> {
        path.excitation.map(|number| self.excitations[number as usize].clone())
    }

    /// Follows what excites the dyes of a surface. Returns the factor on its own scattering, 1 if `must_pass`.
    #[inline]
    fn follow_dyes(
        &mut self,
        path: &Path<N, P>,
        interaction: &Interaction<N>,
        sampler: &Sampler,
        must_pass: bool,
    ) -> f64 {
        let world = self.walker.world;
        let Some(dyes) =
            world.dyes.as_ref().filter(|dyes| !dyes.of_object(&world.scene, interaction.object).is_empty())
        else {
            return 1.0;
        };
        let all = must_pass || self.walker.follows_all(path, interaction.context.draw);
        let excitation = self.excitation(path);
        let excited =
            DyeExcitation { world, dyes, path, interaction, follows_all: all, excitation: excitation.as_deref() }
                .sample_paths(sampler);
        for (excited_path, excitation) in excited.paths {
            let excitation = Rc::new(excitation);
            let path = Path { excitation: Some(self.excitations.len() as u32), ..excited_path };
            self.excitations.push(excitation.clone());
            let continuation = PathContinuation { transmitted: None, must_pass: false, gathers: true };
            self.scatter_at(&path, &interaction.as_dye(&dyes.white, &excitation.draw), sampler, continuation);
        }
        excited.scatter_factor
    }

    /// Samples the lights where a surface scatters widely, gathers photons there if `gathers`, and continues the path.
    fn scatter_at(
        &mut self,
        path: &Path<N, P>,
        interaction: &Interaction<N>,
        sampler: &Sampler,
        PathContinuation { transmitted, must_pass, gathers }: PathContinuation<N, P>,
    ) {
        let (world, draw) = (self.walker.world, interaction.context.draw);
        let (material, normal, from) = (interaction.material, interaction.flat, interaction.point.position);
        let continues = !interaction.lobes.is_diffuse() || path.diffuse_left > 0;
        let bright = world.bright.as_ref().filter(|_| may_aim(material));
        let aiming = bright.and_then(|bright| bright.aiming(from, normal, || albedo(interaction)));
        let (mut u, mut scatter) = ([0.0; 4], None);
        if interaction.lobes.is_wide() {
            u = dimensions::scatter(sampler, path);
            let all_lights = world.samples_all_lights(|| path.weight(draw));
            let last_occluder = &self.walker.last_occluder;
            let (aiming, excitation) = (aiming.as_ref(), self.excitation(path));
            let excitation = excitation.as_deref();
            let vertices = self.vertices_at(path);
            let lighting = DirectLighting {
                world,
                path,
                interaction,
                excitation,
                continues,
                all_lights,
                last_occluder,
                u,
                aiming,
                vertices,
            };
            let chance = lighting.gather(sampler, &mut self.sensor);
            if gathers && continues && path.kind != PathKind::Camera && !path.leaves_all_to_photons(world, interaction)
            {
                self.gather_photons(path, interaction, sampler);
            }
            let resampled = continues && self.resample(path, interaction, sampler);
            let (pdf, passed_through) = (0.0, false);
            scatter = Some(ScatterSample { pdf, from, normal, chance, all_lights, passed_through, resampled });
        }
        self.walker.branches.clear();
        match &aiming {
            Some(aiming) => scatter_aimed(aiming, interaction, [u[2], u[3]], &mut self.walker.branches),
            None => shading::scatter(material, &interaction.context, normal, [u[2], u[3]], &mut self.walker.branches),
        }
        self.walker.polarize(path, interaction);
        self.walker.report_to_audit(path, interaction, transmitted.map(|transmitted| &transmitted.straight));
        let (scatter, is_seen) = (scatter.as_ref(), path.is_seen);
        let outgoing = OutgoingPath::new(world, path, interaction);
        let mut outgoing = OutgoingPath { scatter, transmitted, must_pass, is_seen, ..outgoing };
        if !continues {
            self.walker.keep_delta_branches(&outgoing);
        }
        self.walker.follow(&mut outgoing, sampler);
    }

    /// Passes the light of light vertices to the sensor, if the path hits a diffuse surface. Returns whether it did.
    fn resample(&mut self, path: &Path<N, P>, interaction: &Interaction<N>, sampler: &Sampler) -> bool {
        let is_needed = path.object_set == ObjectSet::All && !path.resampled;
        let Some(vertices) = self.light_vertices.filter(|_| is_needed) else { return false };
        let world = self.walker.world;
        if !interaction.lobes.is_diffuse() {
            return false;
        }
        let resampling = Resampling { world, path, interaction, vertices, last_occluder: &self.walker.last_occluder };
        resampling.gather(sampler, &mut self.sensor);
        self.walker.stats.resampled += 1;
        true
    }

    /// Returns whether a path ends because its light was estimated at light vertices: the closer it is, the less
    /// likely. Even then it may continue for light that they do not carry, or unlit, to measure what bounce limits
    /// leave out.
    fn ends_at_light_vertices(
        &mut self,
        path: &mut Path<N, P>,
        draw: &Draw<N>,
        surface_hit: &SurfaceHit,
        sampler: &Sampler,
    ) -> bool {
        let (Some(vertices), Some(scatter)) = (self.light_vertices, path.scatter) else { return false };
        if !scatter.resampled || !holds_vertices(self.walker.world, surface_hit.hit.object, &surface_hit.point) {
            return false;
        }
        let chance = vertices.continuation_probability((surface_hit.point.position - scatter.from).length_squared());
        let u = sampler.get_random_4d(path.key, dimensions::COMPLEMENT);
        let ends = u[0] >= chance;
        if !ends {
            return false;
        }
        let rest_chance = vertices.rest_chance;
        let continuation_chance = if self.walker.audit.is_some() { 1.0 } else { rest_chance.unwrap_or(MEASURED_SHARE) };
        // A pilot with an observer only needs to know about light.
        let is_needed =
            rest_chance.is_some() || (self.walker.world.method.has_limits() && self.sensor.observer.is_none());
        if is_needed && u[1] < continuation_chance {
            (path.resampled, path.ignores_light) = (true, rest_chance.is_none());
            path.throughput = path.throughput.scaled(1.0 / continuation_chance);
        } else {
            self.walker.audit.iter_mut().for_each(|audit| audit.end(path, None, draw));
        }
        true
    }

    /// Passes the light of photons to the sensor, at a place that the path has reached by way of other surfaces.
    fn gather_photons(&mut self, path: &Path<N, P>, interaction: &Interaction<N>, sampler: &Sampler) {
        if let Some(photons) = self.photons.filter(|_| path.object_set == ObjectSet::All) {
            let has_layers = self.sensor.layers.is_some();
            // At the first surface, each photon has its own lobe and number of bounces.
            let split = has_layers && (path.bounces == 0 || self.walker.world.layers.needs_photon_details());
            let excitation = self.excitation(path);
            let excitation = excitation.as_deref();
            let center = GatherPoint { world: self.walker.world, path, interaction, excitation };
            let gather_with = |kernel, split| gather(photons, kernel, &center, sampler, split);
            let gathered = gather_with(&photons.kernel, split);
            if let Some(half_blur) = &photons.half_blur {
                self.sensor.add_blur(gathered.all.rgb, gather_with(half_blur, false).all.rgb);
            }
            let draw = excitation.map_or(interaction.context.draw, |dye| &dye.sensor_draw);
            self.sensor.receive_gathered(&gathered, draw);
        }
        if let Some(observer) = self.sensor.observer.filter(|_| !self.sensor.counted.is_aimed()) {
            observer(SensorEvent::Place(interaction.point.position));
        }
    }

    /// Returns whether the light along a path's ray to a light is found by photons, or was estimated at light vertices.
    fn is_found_elsewhere(&self, path: &Path<N, P>, light: LightId) -> bool {
        let world = self.walker.world;
        let is_left_to_photons = path.left_to_photons && path.object_set == ObjectSet::All;
        (is_left_to_photons && world.is_found_by_photons(light, &path.ray))
            || self.vertices_at(path).is_some_and(|vertices| vertices.carry(world, light, &path.ray))
    }

    /// Returns the light vertices whose light was already estimated, and no longer counts on the path.
    fn vertices_at(&self, path: &Path<N, P>) -> Option<&'a LightVertices<N>> {
        self.light_vertices.filter(|_| path.resampled)
    }
}

use std::sync::{Arc, OnceLock};

use super::bright::{AimedSampler, BrightPlaces};
use super::density::{Rate, SampleDensity};
use super::dyes::Dyes;
use super::highlight::Highlights;
use super::layers::Layers;
use super::lens_light::LensLights;
use super::media::{Media, media_of_lights};
use super::path_start::{PathStart, SkyOpenings, SunlitPlaces};
use super::photon_focus::places;
use super::photon_targets::PhotonTargets;
use super::{LightPass, Method, Polarizing, SmallHighlights, Transport};
use crate::light::{Light, LightId, LightSampler, Opening};
use crate::material::Lobes;
use crate::math::{DVec3, Ray};
use crate::scene::{Scene, Visibility};
use crate::shape::SurfacePoint;
use crate::spectrum::{Curve, CurveCache, Draw, MAX_LANES, Quantity, Response, Table, Waves, apply};

/// Maximum number of groups of lights that are weighed separately. If there are more lights, neighbors share one.
const MAX_LIGHT_GROUPS: usize = 16;

/// A scene tabulated for the lanes of one method: everything the tracer reads.
#[derive(Clone, Debug)]
pub struct World {
    pub(super) scene: Scene<Table>,
    pub(super) method: Method,
    /// Where the lanes lie in the spectrum.
    pub(super) waves: Waves,
    /// The layers that are requested besides the image.
    pub(super) layers: Layers,
    /// X + Y + Z of each film channel.
    xyz_of_channel: [f64; 3],
    /// The dyes that light excites, if there are any.
    pub(super) dyes: Option<Dyes>,
    /// The sensor's response to the lanes of each light, followed by those of each dye.
    pub(super) responses: Vec<Response>,
    /// Lights that next-event estimation samples.
    pub(super) sampled_lights: Vec<LightId>,
    /// Chooses the light where only one is sampled.
    pub(super) light_sampler: LightSampler,
    /// The bodies around the camera.
    pub(super) camera_media: Media,
    /// The bodies around the camera that it does not see.
    pub(super) hidden_media: Media,
    pub(super) has_media: bool,
    /// Whether light comes from a sky without bright parts, whose light bounces often find.
    pub(super) has_soft_light: bool,
    /// Whether there are objects that the camera does not see, or sees as holes.
    pub(super) hides_objects: bool,
    /// Whether some objects are holdouts or shadow catchers, for which a sample counts as a whole.
    pub(super) has_mattes: bool,
    /// The lobes of each material.
    pub(super) lobes: Vec<Lobes>,
    /// Whether each object lets light pass through; empty where none does.
    see_through: Vec<bool>,
    /// The bright places that bounces are aimed at.
    pub(super) bright: Option<AimedSampler>,
    /// How light paths of each light start, for light vertices.
    pub(super) path_starts: Arc<[PathStart]>,
    /// The highlights at which samples of each pixel are aimed.
    pub(super) highlights: Arc<Highlights>,
    /// The small lights that the lens blurs, at which samples are aimed.
    pub(super) lens_lights: Arc<LensLights>,
    /// Where photons are sent, if the method has a light pass.
    pub(super) photon_targets: Option<PhotonTargets>,
    /// Where each pass of the light pass's map sends photons.
    pub(super) map_targets: Option<PhotonTargets>,
    /// The bodies around each light; `None` where they may differ from point to point.
    light_media: Arc<OnceLock<Vec<Option<Media>>>>,
}

impl World {
    /// Tabulates a scene for a method. Nothing is learned about it: see [`prepare`](super::prepare).
    pub fn new(scene: &Scene<Curve>, mut method: Method) -> Self {
        let (dyes, dye_responses) = Dyes::new(scene, &mut method.basis).unzip();
        let (mut tables, mut responses) = (CurveCache::default(), CurveCache::default());
        let response = |light: &Light<Curve>| responses.of(light.emission(), |curve| method.basis.response(curve));
        let responses = scene.lights.iter().map(response).chain(dye_responses.into_iter().flatten()).collect();
        let to_xyz = scene.film.color_space.to_xyz();
        let xyz_of_channel = [0, 1, 2].map(|channel| to_xyz.iter().map(|row| row[channel]).sum());
        let layers = Layers::new(scene, &method.basis);
        let has_media = scene.materials.iter().any(|m| m.material.medium().is_some());
        let scene = scene.map(|quantity, curve| match quantity {
            Quantity::Emission => tables.of(curve, |curve| method.basis.tabulate(quantity, curve)),
            _ => method.basis.tabulate(quantity, curve),
        });
        let is_sky = |light: &Light<Table>| matches!(light, Light::Environment(_));
        let has_soft_light = scene.lights.iter().any(is_sky) && !scene.lights.iter().any(Light::sends_photons);
        let hides_objects = scene.objects.iter().any(|object| object.visibility != Visibility::Shown);
        let is_matte = |visibility: Visibility| matches!(visibility, Visibility::Holdout | Visibility::ShadowCatcher);
        let has_mattes = scene.objects.iter().any(|object| is_matte(object.visibility));
        let is_see_through = |object: u32| scene.material_of(object).is_see_through();
        let see_through: Vec<bool> = (0..scene.objects.len() as u32).map(is_see_through).collect();
        let see_through = if see_through.contains(&true) { see_through } else { Vec::new() };
        let lobes = scene.materials.iter().map(|named| named.material.lobes()).collect();
        let light_sampler = LightSampler::new(&scene.lights);
        let sampled_lights = light_sampler.lights();
        let bright = method.bright.as_ref().map(AimedSampler::new);
        let path_starts = if method.light_vertices { path_starts(&scene, &method) } else { Arc::new([]) };
        let highlights = Arc::new(Highlights::new(&method.highlights, scene.film.filter));
        let lens_lights = Arc::new(LensLights::new(&method.lens_lights, scene.camera.lens_radius(), &scene.film));
        let mut world = Self {
            waves: method.basis.waves(),
            layers,
            xyz_of_channel,
            dyes,
            responses,
            sampled_lights,
            light_sampler,
            scene,
            method,
            camera_media: Media::default(),
            hidden_media: Media::default(),
            has_media,
            has_soft_light,
            hides_objects,
            has_mattes,
            lobes,
            see_through,
            bright,
            path_starts,
            highlights,
            lens_lights,
            photon_targets: None,
            map_targets: None,
            light_media: Arc::default(),
        };
        world.find_camera_media();
        world.choose_photon_targets();
        world
    }

    /// Finds the bodies around the camera.
    fn find_camera_media(&mut self) {
        if self.has_media {
            let (scene, camera) = (&self.scene, &self.scene.camera);
            let [position, forward] = [camera.position(), camera.forward()];
            let media_around =
                |seen| Media::around_among(scene, position, forward, &|object| scene.is_seen(object) == seen);
            (self.camera_media, self.hidden_media) = (media_around(true), media_around(false));
        }
    }

    /// Returns this world with another light pass, before any photons are sent ahead.
    #[must_use]
    pub fn with_light_pass(&self, light_pass: Option<LightPass>) -> Self {
        let mut world = self.clone();
        world.method.light_pass = light_pass;
        world.choose_photon_targets();
        world
    }

    /// Returns this world with its light pass's photons guided by what another world of the same scene has learned.
    #[must_use]
    pub fn guided_by(mut self, guided: &Self) -> Self {
        if let (Some(targets), Some(guided)) = (&mut self.photon_targets, &guided.photon_targets) {
            targets.adopt(guided);
        }
        self
    }

    /// Returns this world with other bright places that bounces are aimed at.
    #[must_use]
    pub fn with_bright(&self, bright: Option<BrightPlaces>) -> Self {
        let mut world = self.clone();
        world.bright = bright.as_ref().map(AimedSampler::new);
        world.method.bright = bright;
        world
    }

    /// Returns this world with some samples aimed at small lights and highlights.
    #[must_use]
    pub fn with_highlights(mut self, SmallHighlights { on_film, on_lens }: SmallHighlights) -> Self {
        self.highlights = Arc::new(Highlights::new(&on_film, self.scene.film.filter));
        self.lens_lights = Arc::new(LensLights::new(&on_lens, self.scene.camera.lens_radius(), &self.scene.film));
        (self.method.highlights, self.method.lens_lights) = (on_film, on_lens);
        self
    }

    /// Returns this world with light vertices: paths of suns start toward sunlit places, those of skies through
    /// openings.
    #[must_use]
    pub fn with_light_vertices(&self, sunlit: Vec<SunlitPlaces>, openings: SkyOpenings) -> Self {
        let mut world = self.clone();
        world.method = Method { light_vertices: true, sunlit, openings, ..world.method };
        world.path_starts = path_starts(&world.scene, &world.method);
        world
    }

    /// Returns this world with more samples in some places and fewer in others.
    #[must_use]
    pub fn with_density(mut self, density: Option<SampleDensity>) -> Self {
        self.method.density = density;
        self
    }

    /// Returns the sampling rate of a pixel of the format.
    pub(super) fn rate(&self, pixel: [i32; 2]) -> Rate {
        let format = [self.scene.film.width, self.scene.film.height];
        self.method.density.as_ref().map_or(Rate::default(), |density| density.rate(format, pixel))
    }

    /// Returns this world with polarization traced or not.
    #[must_use]
    pub fn with_polarization(mut self, polarization: Polarizing) -> Self {
        self.method.polarization = polarization;
        self
    }

    /// Returns this world with the whole format in view, whatever part is rendered: all parts then learn the same.
    #[must_use]
    pub fn of_the_format(&self) -> Self {
        let mut world = self.clone();
        world.scene.film = world.scene.film.of_the_format();
        world
    }

    /// Returns the number of camera samples of the whole format, whatever part of it is rendered.
    pub fn samples_of_the_format(&self) -> f64 {
        let film = self.scene.film;
        f64::from(film.width) * f64::from(film.height) * f64::from(self.method.samples)
    }

    /// Returns the CIE Y of a light's emission or, if it is larger, of the emission of dyes that the light excites.
    pub(super) fn luminance(&self, light: LightId) -> f64 {
        let draw = Draw::<MAX_LANES>::fixed(self.method.basis.fixed_lanes());
        let emission = draw.read(self.scene.lights[light].emission());
        let to_xyz = self.scene.film.color_space.to_xyz();
        let luminance_of =
            |source: usize, lanes| apply(&to_xyz, self.responses[source].film_rgb(&draw, lanes, false))[1];
        let excited = self.dyes.as_ref().map_or(0.0, |dyes| dyes.max_excited(light, &draw, emission, luminance_of));
        luminance_of(light, emission).max(excited) * self.scene.lights[light].image_brightness().unwrap_or(1.0)
    }

    /// Aims the photons of the light pass.
    fn choose_photon_targets(&mut self) {
        (self.photon_targets, self.map_targets) = (None, None);
        let Some(pass) = &self.method.light_pass else { return };
        let is_sender = |id: &LightId| self.scene.lights[*id].sends_photons_with(&pass.openings);
        let senders: Vec<LightId> = pass.lights.iter().copied().filter(is_sender).collect();
        let places = places(&self.scene, &senders, &pass.openings, &pass.to);
        let senders: Vec<_> = senders.into_iter().map(|light| (light, self.luminance(light))).collect();
        let targets_of =
            |photons: u64| PhotonTargets::new(&self.scene, &senders, &pass.openings, &places, &pass.to, photons);
        let map = pass.map.and_then(|map| targets_of(map.photons));
        (self.photon_targets, self.map_targets) = (targets_of(pass.photons), map);
    }

    /// Returns this world with the response to each light's lanes replaced, for tests of single lanes.
    #[must_use]
    #[doc(hidden)]
    pub fn with_responses(mut self, replace: impl Fn(&Response) -> Response) -> Self {
        self.responses = self.responses.iter().map(replace).collect();
        self
    }

    /// Returns the scene as the tracer sees it.
    pub fn scene(&self) -> &Scene<Table> {
        &self.scene
    }

    /// Returns the method by which it is rendered.
    pub fn method(&self) -> &Method {
        &self.method
    }

    /// Returns whether any surface fluoresces.
    pub fn fluoresces(&self) -> bool {
        self.dyes.is_some()
    }

    /// Returns whether any object lets light pass through.
    pub(super) fn has_see_through(&self) -> bool {
        !self.see_through.is_empty()
    }

    /// Returns whether an object lets light pass through.
    pub(super) fn is_see_through(&self, object: u32) -> bool {
        self.see_through.get(object as usize).is_some_and(|&on| on)
    }

    /// Returns whether light paths for light vertices end at an object. They end where interpolated or bumped normals
    /// bend glass or mirrors, whose light cannot be followed forward the same way, and where light crosses rough
    /// surfaces. Paths from the camera find this light.
    pub(super) fn ends_light_paths(&self, object: u32) -> bool {
        let object = &self.scene.objects[object as usize];
        let lobes = self.lobes[object.material as usize];
        let smooth = object.shape.is_smooth() || object.relief.is_some();
        lobes.intersects(Lobes::NON_DELTA_TRANSMISSION) || (smooth && lobes.has_delta())
    }

    /// Returns the amount of light in a film color: X + Y + Z.
    pub(super) fn amount(&self, rgb: [f64; 3]) -> f64 {
        (0..3).map(|channel| rgb[channel] * self.xyz_of_channel[channel]).sum::<f64>().abs()
    }

    /// Returns the relative increase in the amount of light from one color to another.
    pub(super) fn relative_change(&self, rgb: [f64; 3], changed: [f64; 3]) -> f64 {
        let amount = self.amount(rgb);
        if amount > 0.0 { self.amount(changed) / amount - 1.0 } else { 0.0 }
    }

    pub(super) fn visibility(&self, object: u32) -> Visibility {
        self.scene.objects[object as usize].visibility
    }

    /// Returns the media around the start of a camera ray, without those that the camera does not see.
    pub(super) fn media_at_camera(&self, ray: &Ray) -> Media {
        if !self.has_media || !self.scene.camera.starts_away() {
            return self.camera_media;
        }
        self.media_seen_at(ray.origin)
    }

    /// Returns the media around a ray that leaves a light.
    pub(super) fn media_at_light(&self, light: LightId, ray: &Ray) -> Media {
        let known = self.light_media.get_or_init(|| media_of_lights(&self.scene))[light];
        known.unwrap_or_else(|| Media::around(&self.scene, ray.origin, ray.direction))
    }

    /// Returns the media around a ray, without those that the camera does not see.
    pub(super) fn seen_media(&self, ray: &Ray) -> Media {
        Media::around_among(&self.scene, ray.origin, ray.direction, &|object| self.scene.is_seen(object))
    }

    /// Returns the media around a point on a straight line from the camera, without those that the camera does not see.
    #[cold]
    pub(super) fn media_seen_at(&self, point: DVec3) -> Media {
        let segment = [self.scene.camera.position(), point];
        self.camera_media.after_walk(&self.scene, segment, &|object| self.scene.is_seen(object))
    }

    /// Returns the media before a surface that a camera ray has hit, of bodies that the camera does not see. A body
    /// that ends exactly at the surface is around the ray there.
    #[cold]
    pub(super) fn media_hidden_at(&self, ray: &Ray, point: &SurfacePoint) -> Media {
        let is_hidden = |object: u32| !self.scene.is_seen(object);
        let before = point.leave(-ray.direction).origin;
        let [camera, start, end] = [self.scene.camera.position(), ray.origin, before];
        let walked = |media: Media, segment| media.after_walk(&self.scene, segment, &is_hidden);
        walked(walked(self.hidden_media, [camera, start]), [start, end])
    }

    /// Returns whether next-event estimation at a vertex of the given weight samples every light, and not only one.
    pub(super) fn samples_all_lights(&self, weight: impl FnOnce() -> f64) -> bool {
        /// Maximum number of lights that may all be sampled from one vertex.
        const MAX_SAMPLED_LIGHTS: usize = 8;
        match self.method.transport {
            Transport::Deterministic { .. } => true,
            Transport::Random { split, .. } => {
                self.sampled_lights.len() == 1 || (self.sampled_lights.len() <= MAX_SAMPLED_LIGHTS && weight() > split)
            }
        }
    }

    /// Returns the lights of the light pass, each in a group of its own. If there are many, neighbors share a group.
    pub(super) fn photon_light_groups(&self) -> Vec<Vec<LightId>> {
        let Some(pass) = &self.method.light_pass else { return Vec::new() };
        let mut lights = pass.lights.clone();
        lights.sort_unstable();
        let group_size = lights.len().div_ceil(MAX_LIGHT_GROUPS).max(1);
        lights.chunks(group_size).map(<[LightId]>::to_vec).collect()
    }

    /// Returns the openings at which bounces are aimed.
    pub fn openings(&self) -> Vec<Opening> {
        self.method.bright.as_ref().map_or(Vec::new(), |bright| bright.openings().openings)
    }

    /// Returns whether photons are sent to a place on an object.
    pub(super) fn is_photon_target(&self, object: u32, place: DVec3) -> bool {
        self.photon_targets.as_ref().is_some_and(|targets| targets.includes(&self.scene, object, place))
    }

    /// Returns whether photons are sent to any unbounded surface.
    pub fn reaches_without_end(&self) -> bool {
        self.photon_targets.as_ref().is_some_and(|targets| targets.reach.is_some())
    }

    /// Returns whether paths gather photons where the camera does not see them directly.
    pub(super) fn has_map(&self) -> bool {
        self.map_targets.is_some()
    }

    pub(super) fn sends_photons(&self, light: LightId) -> bool {
        self.photon_targets.as_ref().is_some_and(|targets| targets.lights[light])
    }

    /// Returns whether light paths for light vertices start along a ray that hits a light.
    pub(super) fn is_found_by_light_paths(&self, light: LightId, ray: &Ray) -> bool {
        self.path_starts.get(light).is_some_and(|start| start.covers(&self.scene.lights[light], ray))
    }

    /// Returns whether photons carry the light along a ray that hits a light.
    pub(super) fn is_found_by_photons(&self, light: LightId, ray: &Ray) -> bool {
        self.photon_targets.as_ref().is_some_and(|targets| targets.sends_along(&self.scene, light, ray))
    }
}

fn path_starts(scene: &Scene<Table>, method: &Method) -> Arc<[PathStart]> {
    (0..scene.lights.len())
        .map(|id| PathStart::for_light(scene, id, &method.sunlit, &method.openings.openings))
        .collect()
}

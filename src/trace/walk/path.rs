use super::interaction::{IncidentRay, Interaction};
use super::polarization::{PassThrough, Polarization};
use super::polarized::Polarized;
use crate::light::LightId;
use crate::math::{BranchKey, DVec3, Ray};
use crate::scene::Primitive;
use crate::shape::SurfacePoint;
use crate::spectrum::{Draw, Throughput};
use crate::trace::first_lobe::FirstLobe;
use crate::trace::media::Media;
use crate::trace::{World, media};

/// A path in progress, back from the camera or forward from a light.
#[derive(Clone, Copy, Debug)]
pub struct Path<const N: usize, P = Polarized> {
    pub ray: Ray,
    /// The surface that it hit last, from which its ray starts.
    pub last_primitive: Option<Primitive>,
    pub throughput: Throughput<N>,
    /// The factor of radiance between the medium at the path's end and the camera's, times what the densities of
    /// [aimed](Self::aiming_factor) bounces change. Neither is a measure of importance.
    pub eta_scale: f64,
    /// The factor by which the densities of bounces aimed at bright places have changed the throughput.
    pub aiming_factor: f32,
    /// The bodies that the ray is inside of.
    pub media: Media,
    /// Whether lanes have parted on the way. From then on, other lanes count.
    pub parted: bool,
    /// The key of the random numbers of the path's next vertex.
    pub key: BranchKey,
    /// Number of surfaces hit so far.
    pub vertices: u32,
    /// Number of surfaces hit so far that belong to bodies hidden inside others.
    pub hidden_vertices: u32,
    /// Length of the path so far, from the camera itself and not from the near plane.
    pub length: f64,
    /// The kind of the path so far.
    pub kind: PathKind,
    /// Whether photons carry the light that arrives directly along its ray, from lights that send photons.
    pub left_to_photons: bool,
    /// Whether the surface that last scattered it widely did so by narrow lobes alone. Photons do not land there after
    /// a narrow lobe: the camera's rays soon find what one such surface shows of another.
    pub is_narrow: bool,
    /// How many times the path may still leave a diffuse surface.
    pub diffuse_left: u32,
    /// How the last direction was sampled; `None` after the camera or a smooth surface.
    pub scatter: Option<ScatterSample>,
    /// The polarization of its light.
    pub polarization: P,
    /// Number of times that surfaces have scattered, mirrored or refracted it.
    pub bounces: u32,
    /// Whether only smooth surfaces have mirrored or refracted it. The camera then sees what it hits next.
    pub is_seen: bool,
    /// The objects that exist for it.
    pub object_set: ObjectSet,
    /// Whether light was already estimated at light vertices, which count no more. For a photon: whether they carry it.
    pub resampled: bool,
    /// Whether all of its light is found otherwise, so that the path only serves the accounting.
    pub ignores_light: bool,
    /// The number of the excitation that it follows, if any. Its lanes then stand for what excites a dye.
    pub excitation: Option<u32>,
    /// The lobe by which the first surface sends its light to the camera, if layers need that.
    pub first: Option<FirstLobe>,
}

/// The objects that exist for a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ObjectSet {
    All,
    /// Objects in the plate, and those that light it.
    Plate,
}

/// The kind of a path, which tells whether photons may find its light as well.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathKind {
    /// Directly from the camera.
    Camera,
    /// Directly from the camera, through surfaces of hidden bodies. Splatted photons are not seen through these.
    PastHidden,
    /// Scattered widely by a surface where photons are splatted or gathered.
    Wide,
    /// Scattered widely by such a surface, then only by smooth ones.
    Smooth,
    /// Any other way.
    Other,
}

impl PathKind {
    /// Returns whether the camera sees what it hits next.
    pub fn is_from_camera(self) -> bool {
        matches!(self, Self::Camera | Self::PastHidden)
    }

    /// Returns whether photons may have carried its light to the last surface that scattered it widely.
    pub fn is_reachable_by_photons(self) -> bool {
        matches!(self, Self::Wide | Self::Smooth)
    }

    /// Returns the kind after the surface of a body hidden inside another.
    pub fn past_hidden(self) -> Self {
        match self {
            Self::Camera | Self::PastHidden => Self::PastHidden,
            Self::Wide | Self::Smooth => Self::Smooth,
            Self::Other => Self::Other,
        }
    }

    /// Returns the kind after one more surface. `wide` tells whether light left it by a density of directions, and
    /// `reversible` whether it can be followed forward the same way. Photons are splatted from the first surface, and
    /// gathered from others.
    pub fn after_bounce(self, gathers: bool, wide: bool, reversible: impl Fn() -> bool) -> Self {
        match (self, wide) {
            (Self::Camera, true) => Self::Wide,
            (_, true) if gathers => Self::Wide,
            (Self::Wide | Self::Smooth, false) if reversible() => Self::Smooth,
            _ => Self::Other,
        }
    }
}

/// How a direction was sampled at a surface where lights were sampled as well.
#[derive(Clone, Copy, Debug)]
pub struct ScatterSample {
    /// Density per steradian.
    pub pdf: f64,
    /// The point from which lights were sampled.
    pub from: DVec3,
    /// The surface's unit normal on the side that the direction leads to.
    pub normal: DVec3,
    /// Probability that lights were sampled on this side of the surface.
    pub chance: f64,
    /// Whether every light was sampled there, or only one.
    pub all_lights: bool,
    /// Whether the path has passed through surfaces since.
    pub passed_through: bool,
    /// Whether light vertices were sampled from there.
    pub resampled: bool,
}

impl ScatterSample {
    /// Returns the sample for a direction that was sampled with a density, and that may cross the surface.
    pub fn with_pdf(self, pdf: f64, crosses: bool) -> Self {
        Self { pdf, normal: if crosses { -self.normal } else { self.normal }, ..self }
    }
}

impl<const N: usize, P> Path<N, P> {
    /// Returns the number of surfaces hit so far that light interacts with: `max_bounces` limits it.
    pub fn surfaces(&self) -> u32 {
        self.vertices - self.hidden_vertices
    }
}

impl<const N: usize, P: Polarization<N>> Path<N, P> {
    pub fn from_camera(world: &World, draw: &Draw<N>, ray: Ray) -> Self {
        let (media, polarization) = (world.media_at_camera(&ray), P::at_camera(world, &ray));
        let path = Self::starting(world, draw, PathKind::Camera, ray, media, polarization);
        let camera = &world.scene.camera;
        let (throughput, length) = (path.throughput.scaled(camera.transmittance()), camera.way_to_start(ray.direction));
        Self { throughput, length, ..path }
    }

    /// Returns the path of a ray that leaves a light.
    pub fn from_light(world: &World, draw: &Draw<N>, ray: Ray, light: LightId) -> Self {
        let (media, polarization) = (world.media_at_light(light, &ray), P::at_light(world, &ray));
        Self::starting(world, draw, PathKind::Other, ray, media, polarization)
    }

    #[inline(always)]
    fn starting(world: &World, draw: &Draw<N>, kind: PathKind, ray: Ray, media: Media, polarization: P) -> Self {
        Self {
            ray,
            last_primitive: None,
            throughput: Throughput::starting(draw.start()),
            eta_scale: 1.0,
            aiming_factor: 1.0,
            media,
            parted: false,
            key: BranchKey::CAMERA,
            vertices: 0,
            hidden_vertices: 0,
            length: 0.0,
            kind,
            left_to_photons: false,
            is_narrow: false,
            diffuse_left: world.method.diffuse_bounces,
            scatter: None,
            polarization,
            bounces: 0,
            is_seen: true,
            object_set: ObjectSet::All,
            resampled: false,
            ignores_light: false,
            excitation: None,
            first: None,
        }
    }

    /// Returns the path beyond a surface that it passes through as if nothing were there.
    ///
    /// Lights beyond were sampled through the surface: passing through does not change the kind of a path.
    pub fn beyond_surface(&self, point: &SurfacePoint) -> Self {
        let scatter = self.scatter.map(|scatter| ScatterSample { passed_through: true, ..scatter });
        Self { ray: point.leave(self.ray.direction), scatter, ..*self }
    }

    /// Returns the path beyond a surface that it passes through in part. The surface is not counted.
    #[cold]
    #[inline(never)]
    pub fn transmitted_part(&self, point: &SurfacePoint, transmitted: &PassThrough<N, P>) -> Self {
        let throughput = self.throughput.through(transmitted.straight.share());
        let polarization = transmitted.polarization;
        Self { throughput, polarization, vertices: self.vertices - 1, ..self.beyond_surface(point) }
    }

    /// Returns the lobe by which the first surface sends light to the camera that the path finds at a surface, in the
    /// direction `wi`, which may lead beyond it. Returns `None` if layers do not need that.
    #[inline]
    pub fn first_lobe(
        &self,
        world: &World,
        interaction: &Interaction<N>,
        wi: DVec3,
        crosses: bool,
    ) -> Option<FirstLobe> {
        if self.bounces > 0 || !world.layers.separates_lobes {
            return self.first;
        }
        let Interaction { material, lobes, context, .. } = interaction;
        Some(FirstLobe::scattered(world.layers.white.as_ref(), material, *lobes, context, wi, crosses))
    }

    /// Returns whether photons carry the direct light that a narrow lobe sends the path, for lights that send photons.
    #[inline]
    pub fn leaves_narrow_to_photons(&self, world: &World, interaction: &Interaction<N>) -> bool {
        let has_landed = self.kind.is_reachable_by_photons() && !self.is_narrow && self.object_set == ObjectSet::All;
        has_landed
            && interaction.lobes.has_narrow_apart()
            && world.is_photon_target(interaction.object, interaction.point.position)
    }

    /// Returns whether photons carry all light that a surface scatters: its narrow lobes then act like smooth surfaces.
    #[inline]
    pub fn leaves_all_to_photons(&self, world: &World, interaction: &Interaction<N>) -> bool {
        interaction.lobes.is_narrow() && self.leaves_narrow_to_photons(world, interaction)
    }

    /// Returns its ray, as it arrives at a surface.
    #[inline(always)]
    pub fn incident_ray(&self) -> IncidentRay<'_, N> {
        IncidentRay { ray: &self.ray, present: self.throughput.present(), parted: self.parted }
    }

    /// Returns how much the path can still matter: its mean throughput, without factors that do not measure importance.
    pub fn weight(&self, draw: &Draw<N>) -> f64 {
        self.throughput.weight(draw.shares(self.parted)) / self.eta_scale
    }

    /// Returns the part of a camera sample's weight that the path has, as one of its siblings.
    pub fn share(&self, draw: &Draw<N>) -> f64 {
        self.weight(draw) * f64::from(self.aiming_factor) / draw.siblings(self.parted)
    }

    /// Replaces the media around its end, without crossing a surface: by those that the camera sees, or by those that
    /// exist for all other light. Flux is preserved.
    pub fn switch_media(&mut self, world: &World, draw: &Draw<N>, media: Media) {
        let sides = [self.media, media].map(|media| media.inside(&world.scene));
        self.media = media;
        if sides[0] == sides[1] {
            return;
        }
        let weight = |throughput: Throughput<N>| throughput.weight(draw.shares(self.parted));
        let before = weight(self.throughput);
        self.throughput = self.throughput.through(media::radiance_factor(&world.scene, draw, sides));
        self.eta_scale *= if before > 0.0 { weight(self.throughput) / before } else { 1.0 };
    }

    /// Follows the ray along a distance over which the medium around it absorbs.
    pub fn advance(&mut self, world: &World, draw: &Draw<N>, distance: f64) {
        self.length += distance;
        if let Some(material) = self.media.inside(&world.scene) {
            let transmission = media::medium(&world.scene, material).transmission(draw, distance);
            self.throughput = self.throughput.through(transmission);
        }
    }
}

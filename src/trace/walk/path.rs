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

/// A ray on its way back from the camera.
#[derive(Clone, Copy, Debug)]
pub struct Path<const N: usize, P = Polarized> {
    pub ray: Ray,
    /// The surface that it hit last, which its ray leaves.
    pub left: Option<Primitive>,
    pub throughput: Throughput<N>,
    /// The factor of radiance between the medium at the path's end and the camera's, times what densities of
    /// [aimed](Self::aimed) bounces change: neither is a measure of importance.
    pub eta_scale: f64,
    /// The factor by which the densities of bounces that were aimed at bright places change the throughput.
    pub aimed: f32,
    /// The bodies the ray is inside of.
    pub media: Media,
    /// Whether lanes have parted on the way, after which other lanes count.
    pub parted: bool,
    /// Which random numbers belong to the path's next vertex.
    pub key: BranchKey,
    /// Surfaces hit so far.
    pub vertices: u32,
    /// How many of them were those of bodies that are hidden inside others.
    pub hidden: u32,
    /// How far the light has to go along it; to the camera itself, not to the near plane.
    pub length: f64,
    /// What kind of path it is so far.
    pub kind: PathKind,
    /// Whether photons bring the light that comes straight along its ray from lights that send them.
    pub left_to_photons: bool,
    /// Whether the surface that last scattered it in every direction did so by narrow lobes alone. Photons do not land
    /// there after a narrow lobe: what one such surface shows of another, the camera's rays find soon.
    pub is_narrow: bool,
    /// How often the path may still leave a diffuse surface.
    pub diffuse_left: u32,
    /// How the last direction was sampled; none after the camera or a smooth surface.
    pub scatter: Option<ScatterSample>,
    /// How its light is polarized.
    pub polarization: P,
    /// How often surfaces have scattered, mirrored or refracted it.
    pub bounces: u32,
    /// Whether only smooth surfaces have: what it hits next is seen.
    pub is_seen: bool,
    /// Which objects there are for it.
    pub among: Among,
    /// Whether light was looked for at light vertices before, which count no more; of a photon, whether they carry it.
    pub resampled: bool,
    /// Whether all of its light is found otherwise, and it goes on to be accounted for alone.
    pub unlit: bool,
    /// Which of the walk's excitations it follows: its lanes are then what excites a dye.
    pub excitation: Option<u32>,
    /// By which lobe the first surface sends its light to the camera, if layers tell that apart.
    pub first: Option<FirstLobe>,
}

/// Which objects there are for a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Among {
    All,
    /// Those that are in the plate or light it.
    Plate,
}

/// How a path that photons may find as well goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathKind {
    /// Straight from the camera.
    Camera,
    /// Straight from the camera, through surfaces of hidden bodies: splatted photons are not seen through these.
    PastHidden,
    /// Scattered widely by a surface from which photons are shown to the camera or gathered.
    Wide,
    /// After that over smooth surfaces alone.
    Smooth,
    /// Another way.
    Other,
}

impl PathKind {
    /// Whether the camera sees what it hits next.
    pub fn is_from_camera(self) -> bool {
        matches!(self, Self::Camera | Self::PastHidden)
    }

    /// Whether photons may have brought its light to the last surface that scattered it widely.
    pub fn is_of_photons(self) -> bool {
        matches!(self, Self::Wide | Self::Smooth)
    }

    /// After the surface of a body that is hidden inside another.
    pub fn past_hidden(self) -> Self {
        match self {
            Self::Camera | Self::PastHidden => Self::PastHidden,
            Self::Wide | Self::Smooth => Self::Smooth,
            Self::Other => Self::Other,
        }
    }

    /// After one more surface; `wide` says whether light left it by a density of directions, and `followed` whether it
    /// can be followed forward the same way. Photons are splatted from the first surface, and gathered from others.
    pub fn then(self, gathers: bool, wide: bool, followed: impl Fn() -> bool) -> Self {
        match (self, wide) {
            (Self::Camera, true) => Self::Wide,
            (_, true) if gathers => Self::Wide,
            (Self::Wide | Self::Smooth, false) if followed() => Self::Smooth,
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
    /// How likely lights were sampled on this side of the surface.
    pub chance: f64,
    /// Whether every light was sampled there, or one.
    pub all_lights: bool,
    /// Whether the path has passed through surfaces since.
    pub passed: bool,
    /// Whether a vertex of a light path was looked at from there.
    pub resampled: bool,
}

impl ScatterSample {
    /// Toward a direction that was sampled with a density, which may lead beyond the surface.
    pub fn toward(self, pdf: f64, crosses: bool) -> Self {
        Self { pdf, normal: if crosses { -self.normal } else { self.normal }, ..self }
    }
}

impl<const N: usize, P> Path<N, P> {
    /// Surfaces hit so far that are there for light: `max_bounces` limits them.
    pub fn surfaces(&self) -> u32 {
        self.vertices - self.hidden
    }
}

impl<const N: usize, P: Polarization<N>> Path<N, P> {
    pub fn from_camera(world: &World, draw: &Draw<N>, ray: Ray) -> Self {
        let (media, polarization) = (world.media_at_camera(&ray), P::of_camera(world, &ray));
        let path = Self::starting(world, draw, PathKind::Camera, ray, media, polarization);
        let camera = &world.scene.camera;
        let (throughput, length) = (path.throughput.scaled(camera.transmittance()), camera.way_to_start(ray.direction));
        Self { throughput, length, ..path }
    }

    /// The path of a ray that leaves a light.
    pub fn from_light(world: &World, draw: &Draw<N>, ray: Ray, light: LightId) -> Self {
        let (media, polarization) = (world.media_at_light(light, &ray), P::of_light(world, &ray));
        Self::starting(world, draw, PathKind::Other, ray, media, polarization)
    }

    #[inline(always)]
    fn starting(world: &World, draw: &Draw<N>, kind: PathKind, ray: Ray, media: Media, polarization: P) -> Self {
        Self {
            ray,
            left: None,
            throughput: Throughput::starting(draw.start()),
            eta_scale: 1.0,
            aimed: 1.0,
            media,
            parted: false,
            key: BranchKey::CAMERA,
            vertices: 0,
            hidden: 0,
            length: 0.0,
            kind,
            left_to_photons: false,
            is_narrow: false,
            diffuse_left: world.method.diffuse_bounces,
            scatter: None,
            polarization,
            bounces: 0,
            is_seen: true,
            among: Among::All,
            resampled: false,
            unlit: false,
            excitation: None,
            first: None,
        }
    }

    /// The path beyond a surface that it passes through as if nothing were there.
    ///
    /// Lights beyond were sampled through the surface: light that passes through makes no other kind of path.
    pub fn passed(&self, point: &SurfacePoint) -> Self {
        let scatter = self.scatter.map(|scatter| ScatterSample { passed: true, ..scatter });
        Self { ray: point.leave(self.ray.direction), scatter, ..*self }
    }

    /// The path beyond a surface that it passes through in part, which is not counted among its surfaces.
    #[cold]
    #[inline(never)]
    pub fn passed_in_part(&self, point: &SurfacePoint, through: &PassThrough<N, P>) -> Self {
        let throughput = self.throughput.through(through.straight.share());
        let polarization = through.polarization;
        Self { throughput, polarization, vertices: self.vertices - 1, ..self.passed(point) }
    }

    /// The lobe by which the first surface sends light to the camera that the path finds at a surface, in a direction
    /// that may lead beyond it; none if layers do not tell that apart.
    #[inline]
    pub fn first_lobe(&self, world: &World, at: &Interaction<N>, wi: DVec3, crosses: bool) -> Option<FirstLobe> {
        if self.bounces > 0 || !world.layers.lobes_apart {
            return self.first;
        }
        let Interaction { material, lobes, context, .. } = at;
        Some(FirstLobe::scattered(world.layers.white.as_ref(), material, *lobes, context, wi, crosses))
    }

    /// Whether photons bring what a narrow lobe sends the path of direct light, from lights that send photons.
    #[inline]
    pub fn leaves_narrow_to_photons(&self, world: &World, at: &Interaction<N>) -> bool {
        let has_landed = self.kind.is_of_photons() && !self.is_narrow && self.among == Among::All;
        has_landed && at.lobes.has_narrow_apart() && world.is_photon_target(at.object, at.point.position)
    }

    /// Whether photons bring all light that a surface scatters: from narrow lobes alone they go on as from smooth ones.
    #[inline]
    pub fn leaves_all_to_photons(&self, world: &World, at: &Interaction<N>) -> bool {
        at.lobes.is_narrow() && self.leaves_narrow_to_photons(world, at)
    }

    /// Its ray, as it arrives at a surface.
    #[inline(always)]
    pub fn arriving(&self) -> IncidentRay<'_, N> {
        IncidentRay { ray: &self.ray, present: self.throughput.present(), parted: self.parted }
    }

    /// How much the path can still matter: its mean throughput, without what is no measure of importance.
    pub fn weight(&self, draw: &Draw<N>) -> f64 {
        self.throughput.weight(draw.shares(self.parted)) / self.eta_scale
    }

    /// The part of a camera sample's weight that the path has, as one of its siblings.
    pub fn share(&self, draw: &Draw<N>) -> f64 {
        self.weight(draw) * f64::from(self.aimed) / draw.siblings(self.parted)
    }

    /// Takes other media to be around its end, without a surface between both: those that the camera sees, or those
    /// that are there for all other light. Flux stays what it is.
    pub fn enter(&mut self, world: &World, draw: &Draw<N>, media: Media) {
        let sides = [self.media, media].map(|media| media.inside(&world.scene));
        self.media = media;
        if sides[0] == sides[1] {
            return;
        }
        let weight = |throughput: Throughput<N>| throughput.weight(draw.shares(self.parted));
        let before = weight(self.throughput);
        self.throughput = self.throughput.through(media::change_of_radiance(&world.scene, draw, sides));
        self.eta_scale *= if before > 0.0 { weight(self.throughput) / before } else { 1.0 };
    }

    /// Follows the ray along a distance, on which the medium around it absorbs.
    pub fn advance(&mut self, world: &World, draw: &Draw<N>, distance: f64) {
        self.length += distance;
        if let Some(material) = self.media.inside(&world.scene) {
            let transmission = media::medium(&world.scene, material).transmission(draw, distance);
            self.throughput = self.throughput.through(transmission);
        }
    }
}

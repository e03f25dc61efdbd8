//! Photons that are splatted: where one lands and the camera sees it, it adds to the pixels.

use std::sync::Arc;

use super::follow::{Photon, PhotonHit};
use crate::light::LightId;
use crate::material::ScatterContext;
use crate::math::{DVec2, Ray};
use crate::scene::{FilmSettings, RayEnds, Seen, Visibility};
use crate::spectrum::{Draw, Lanes};
use crate::trace::dyes::Dyes;
use crate::trace::first_lobe::FirstLobe;
use crate::trace::media;
use crate::trace::received_light::ReceivedLight;
use crate::trace::spectrum_sample::Spectrum;
use crate::trace::walk::{
    DYE_BRANCH, Interaction, Occluders, Polarization, SeenPhoton, SeenThrough, VisibilityTest, Walker, parts_lanes,
    shading,
};

/// Use of the random numbers where the camera sees a photon: the point of the lens.
const LENS: u32 = 3;

/// What a photon adds to a pixel of the film.
#[derive(Clone, Debug)]
pub struct Splat {
    /// The share by which polarization may change it.
    pub change: f32,
    pub rgb: [f64; 3],
    /// S1, S2 and S3, if requested, to be multiplied by `weight`.
    pub stokes: Option<Arc<[[f64; 3]; 3]>>,
    /// What it adds to the numbers of a spectral image, if requested, to be multiplied by `weight`.
    pub bands: Option<Arc<[f32]>>,
    /// The factor of `stokes` and `bands`.
    pub weight: f64,
    pub light: LightId,
    /// How often surfaces scattered, mirrored or refracted it on its way.
    pub bounces: u32,
    /// Whether its wavelengths parted on the way.
    pub dispersed: bool,
    /// Whether the photon is of the first half of those sent with it.
    pub first_half: bool,
    /// Whether it landed on a shadow catcher.
    pub on_catcher: bool,
    /// The lobe by which that surface scatters it to the camera, if layers tell lobes apart.
    pub first: Option<FirstLobe>,
}

impl Splat {
    /// Scales it by a factor.
    pub fn times(self, factor: f64) -> Self {
        Self { rgb: self.rgb.map(|x| x * factor), weight: self.weight * factor, ..self }
    }
}

/// What a photon adds to the film around a place. It is stored whole: a wide filter spreads it over a thousand pixels.
#[derive(Clone, Debug)]
pub struct PlacedSplat {
    /// In pixels of the film.
    place: DVec2,
    /// As weighted by a filter value of 1.
    splat: Splat,
}

impl PlacedSplat {
    /// Calls `take` with what each pixel of the window receives, weighted by the filter.
    pub fn spread(&self, film: FilmSettings, take: &mut dyn FnMut(u32, Splat)) {
        for (pixel, weight) in self.pixels(film) {
            take(pixel, self.splat.clone().times(weight));
        }
    }

    /// Returns the pixels around it, each with the filter's weight.
    fn pixels(&self, film: FilmSettings) -> impl Iterator<Item = (u32, f64)> {
        let (place, window, reach) = (self.place, film.window(), film.filter.reach());
        let [first, end] = window.ends();
        let first = |x: f64, axis: usize| (x - reach - 0.5).floor().max(first[axis] as f64) as i32;
        let last = |x: f64, axis: usize| (x + reach).floor().min((end[axis] - 1) as f64) as i32;
        let columns = first(place.x, 0)..=last(place.x, 0);
        let rows = first(place.y, 1)..=last(place.y, 1);
        // Shadow catchers show no light, but the share of it that is missing.
        let is_caught = self.splat.on_catcher;
        let weighed = move |[x, y]: [i32; 2]| {
            let offset = place - DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let weight = if is_caught { film.filter.positive_value(offset) } else { film.filter.value(offset) };
            let pixel = (y - window.top) as u32 * window.width + (x - window.left) as u32;
            (weight != 0.0).then_some((pixel, weight))
        };
        rows.flat_map(move |y| columns.clone().map(move |x| [x, y])).filter_map(weighed)
    }
}

/// The connection of a photon to the camera: how the camera sees the place where it landed.
struct CameraConnection<'v, 'a, const N: usize, P: Polarization<N>> {
    walker: &'v Walker<'a, N, P>,
    photon_hit: &'v PhotonHit<'v, N, P>,
    projection: Seen,
    /// Places on the film that are near enough to the window.
    places: Vec<DVec2>,
    /// Whether the camera is on the side where the photon arrived, and the surface as the camera sees it.
    same_side: bool,
    viewed: Interaction<'v, N>,
    seen_through: SeenThrough,
}

/// Adds what the camera sees of a photon.
pub fn splat_photon<const N: usize, P: Polarization<N>>(
    walker: &Walker<N, P>,
    photon_hit: &PhotonHit<N, P>,
    splats: &mut Vec<PlacedSplat>,
) {
    let world = walker.world;
    let all: &[SeenThrough] = match world.visibility(photon_hit.interaction.object) {
        Visibility::Shown => &[SeenThrough::All],
        Visibility::Hidden => &[],
        Visibility::Holdout => &[SeenThrough::Panes],
        Visibility::ShadowCatcher => &[SeenThrough::Holes, SeenThrough::Panes],
    };
    for &seen_through in all {
        let Some(connection) = CameraConnection::new(walker, photon_hit, seen_through) else { return };
        connection.push_splats(connection.scattered(), splats);
        if let Some(dyes) = &world.dyes {
            for (number, dye) in dyes.of_object(&world.scene, photon_hit.interaction.object).enumerate() {
                connection.push_splats(connection.emitted_by_dye(dyes, dye, number), splats);
            }
        }
    }
}

impl<'v, 'a, const N: usize, P: Polarization<N>> CameraConnection<'v, 'a, N, P> {
    /// Returns `None` where the camera does not see the place.
    fn new(
        walker: &'v Walker<'a, N, P>,
        photon_hit: &'v PhotonHit<'v, N, P>,
        seen_through: SeenThrough,
    ) -> Option<Self> {
        let PhotonHit { path, interaction, photon } = photon_hit;
        let Interaction { flat, point, .. } = interaction;
        let world = walker.world;
        let (camera, film) = (&world.scene.camera, world.scene.film);
        let u = if camera.has_lens() { photon.sampler.get_random_4d(path.key, LENS) } else { [0.5; 4] };
        let projection = camera.see(point.position, [u[0], u[1]])?;
        let (window, reach) = (film.window(), film.filter.reach());
        let mut places = camera.places(projection.film, reach + f64::from(film.overscan.widest()));
        let [first, end] = window.ends().map(|place| place.map(|x| x as f64));
        let near = |x: f64, axis: usize| x >= first[axis] - reach && x <= end[axis] + reach;
        places.retain(|place| near(place.x, 0) && near(place.y, 1));
        if places.is_empty() {
            return None;
        }
        let same_side = projection.direction.dot(*flat) > 0.0;
        let viewed = interaction.viewed_from(projection.direction);
        Some(Self { walker, photon_hit, projection, places, same_side, viewed, seen_through })
    }

    /// Returns what reaches the camera of light that leaves the place toward it, and how it is polarized on its way.
    fn arriving_light(
        &self,
        draw: &Draw<N>,
        start: impl FnOnce() -> P,
        light: impl FnOnce() -> Lanes<N>,
    ) -> Option<(Lanes<N>, P)> {
        let PhotonHit { path, interaction, .. } = self.photon_hit;
        let ray = interaction.point.leave(self.projection.direction);
        let distance = (self.projection.start - ray.origin).length();
        let world = self.walker.world;
        let local_medium = interaction.boundary.sides()[usize::from(!self.same_side)];
        let inside = match world.hides_objects && world.has_media {
            true => world.seen_media(&ray).inside(&world.scene),
            false => local_medium,
        };
        let ends = RayEnds { start: path.last_primitive, ..RayEnds::default() };
        let (occluders, last_occluder) = (Occluders::Seen(self.seen_through), &self.walker.last_occluder);
        let segment = VisibilityTest { ray: &ray, distance, ends, inside, occluders, last_occluder };
        let (arriving, polarization) = segment.arriving_light(world, draw, start, light)?;
        if inside == local_medium {
            return Some((arriving, polarization));
        }
        Some((arriving * media::radiance_factor(&world.scene, draw, [inside, local_medium]), polarization))
    }

    /// Returns the camera ray that sees the place.
    fn camera_ray(&self) -> Ray {
        Ray { origin: self.projection.start, direction: -self.projection.direction }
    }

    /// Returns the factor from light that leaves the place toward the camera to what the pixels receive.
    fn factor(&self) -> f64 {
        let Interaction { context, flat, .. } = self.photon_hit.interaction;
        let cosines = self.projection.direction.dot(*flat).abs() / context.wo.dot(*flat).abs();
        let filter = self.walker.world.scene.camera.filter();
        self.photon_hit.photon.emitted.factor
            * cosines
            * self.projection.importance
            * filter.map_or(1.0, |filter| filter.transmittance())
    }

    /// Returns what the surface scatters toward the camera.
    fn scattered(&self) -> Option<Splat> {
        let Self { photon_hit, viewed, same_side, .. } = self;
        let PhotonHit { path, interaction, .. } = photon_hit;
        let Interaction { context, material, .. } = interaction;
        let world = self.walker.world;
        let (mut bsdf_cos, _) = shading::evaluate(material, &viewed.context, viewed.flat, context.wo)?;
        let parted = path.parted || (!same_side && parts_lanes(interaction.lobes, material, &viewed.context));
        let start = || path.polarization.after_forward_scattering(viewed, context.wo, &mut bsdf_cos);
        let (emission, on_its_way) = self.arriving_light(context.draw, start, || photon_hit.emission(world))?;
        let polarized = path.polarization.see(interaction, &viewed.context, &on_its_way, world, &self.camera_ray());
        let arriving = polarized.factor.map_or(bsdf_cos * emission, |factor| bsdf_cos * emission * factor);
        let lanes = &path.throughput.scaled(1.0 / path.eta_scale).of(arriving);
        let white = world.layers.white.as_ref();
        let lobe = || FirstLobe::scattered(white, material, interaction.lobes, &viewed.context, context.wo, !same_side);
        let first = world.layers.separates_lobes.then(lobe);
        let received = ReceivedLight { source: photon_hit.photon.light, draw: context.draw, lanes, parted };
        Some(self.splat(&received, &polarized, parted, first))
    }

    /// Returns what a dye emits toward the camera; `number` counts the dyes of the material.
    fn emitted_by_dye(&self, dyes: &Dyes, dye: usize, number: usize) -> Option<Splat> {
        let Self { photon_hit, viewed, .. } = self;
        let PhotonHit { path, interaction, photon } = photon_hit;
        let world = self.walker.world;
        if !self.same_side {
            return None;
        }
        let (bsdf_cos, _) = shading::evaluate(&dyes.white, &viewed.context, viewed.flat, interaction.context.wo)?;
        let lanes = &path.throughput.scaled(1.0 / path.eta_scale).of(bsdf_cos * photon_hit.emission(world));
        let parted = path.parted;
        let brightness = dyes
            .brightness(dye, &ReceivedLight { source: photon.light, draw: interaction.context.draw, lanes, parted });
        // The dye emits other wavelengths than those of the photon, whose lanes may have parted.
        let draw = &world.method.basis.draw(photon.sampler.get_random_4d(path.key.child(DYE_BRANCH + dye), LENS)[0]);
        let mut shares = Vec::new();
        interaction.material.shares_of_dyes(&ScatterContext { draw, ..viewed.context }, Lanes::ONE, &mut shares);
        let polarization = path.polarization.for_excitation();
        let mut unpolarized = Lanes::ONE;
        let start = || {
            polarization.after_forward_scattering(
                &viewed.as_dye(&dyes.white, draw),
                interaction.context.wo,
                &mut unpolarized,
            )
        };
        let (arriving, on_its_way) = self.arriving_light(draw, start, || draw.start())?;
        let polarized = polarization.see(
            &interaction.as_dye(&dyes.white, draw),
            &viewed.context,
            &on_its_way,
            world,
            &self.camera_ray(),
        );
        let arriving =
            polarized.factor.map_or(arriving, |factor| arriving * factor) * shares[number] * brightness as f32;
        let received = ReceivedLight { source: dyes.source(dye), draw, lanes: &arriving, parted: false };
        let first = world.layers.separates_lobes.then_some(FirstLobe::Reflected { diffuse: [1.0; 3] });
        Some(self.splat(&received, &polarized, parted, first))
    }

    /// Returns the splat of light that arrives at the camera.
    fn splat(
        &self,
        received: &ReceivedLight<N>,
        polarized: &SeenPhoton<N>,
        dispersed: bool,
        first: Option<FirstLobe>,
    ) -> Splat {
        let (world, factor) = (self.walker.world, self.factor());
        let rgb = received.rgb(&world.responses).map(|x| x * factor);
        let spectrum = world.layers.spectrum.as_ref();
        let of_bands = |spectrum: &Spectrum| spectrum.band_values(received, polarized.stokes.as_ref(), factor);
        let bands = spectrum.map(|spectrum| of_bands(spectrum).into_iter().map(|x| x as f32).collect());
        let color = |part: Lanes<N>| received.times(part, &world.responses).map(|x| x * factor);
        let stokes = polarized.stokes.map(|stokes| Arc::new(stokes.map(color)));
        let Photon { light, first_half, .. } = *self.photon_hit.photon;
        let changed = || received.times(Lanes::ONE + polarized.change, &world.responses).map(|x| x * factor);
        let change = if polarized.change.is_zero() { 0.0 } else { world.relative_change(rgb, changed()) as f32 };
        let (bounces, on_catcher) = (self.photon_hit.path.surfaces(), self.seen_through == SeenThrough::Holes);
        Splat { change, rgb, stokes, bands, weight: 1.0, light, bounces, dispersed, first_half, on_catcher, first }
    }

    /// Keeps a splat at each place where it reaches a pixel.
    fn push_splats(&self, splat: Option<Splat>, splats: &mut Vec<PlacedSplat>) {
        let film = self.walker.world.scene.film;
        let Some(splat) = splat else { return };
        let placed = self.places.iter().map(|&place| PlacedSplat { place, splat: splat.clone() });
        splats.extend(placed.filter(|placed| placed.pixels(film).next().is_some()));
    }
}

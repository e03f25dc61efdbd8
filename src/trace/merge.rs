//! Caustics that the camera does not see straight: photons are kept where they land, and paths from the camera gather those
//! around the places that they reach by way of other surfaces.
//!
//! Light that photons bring to a disc of radius r is taken for the light at its middle, which blurs: light that varies by its
//! Laplacian comes out too bright by r^2 / 12 of that. The radius is one of pixels, seen along the path, and shrinks
//! with the samples as their number to the power -1 / 6, where bias and noise vanish at the same pace (Silverman 1986, *Density
//! Estimation for Statistics and Data Analysis*, section 4.3).

use std::f64::consts::PI;

use rayon::prelude::*;

use super::World;
use super::map::Map;
use super::path::Path;
use super::photon::Landing;
use super::render::sample;
use super::sending::{Sent, batches, send};
use super::shading;
use super::tracer::Tracer;
use super::width::{InLanes, in_lanes};
use crate::light::LightId;
use crate::material::{Arrival, Material};
use crate::math::{BranchKey, DVec3, Sampler};
use crate::scene::Hit;
use crate::shape::SurfacePoint;
use crate::spectrum::{Lanes, Table};

/// A photon that has landed.
#[derive(Clone, Debug)]
pub(super) struct Landed<const N: usize> {
    /// Its flux, lane by lane, over the cosine under which it arrived.
    flux: Lanes<N>,
    /// Unit vector back along its way.
    back: DVec3,
    /// The surface's own unit normal there, on the side it came from.
    flat: DVec3,
    object: u32,
    light: LightId,
    /// Surfaces it met, the last one included.
    vertices: u32,
    parted: bool,
}

/// The photons of one pass, and the wavelengths that they share with the camera's paths.
pub(super) struct Photons<const N: usize> {
    map: Map<Landed<N>>,
    pub(super) wavelength: f64,
    pub(super) sent: u64,
    pub(super) rays: u64,
    pub(super) unmatched: u64,
    /// Photons whose flux was not finite.
    pub(super) non_finite: u64,
}

/// Sets these random numbers apart from the others.
const SEED: u64 = 0x6d61_7073;

/// Normals that differ by more than 60 degrees belong to different sides or walls.
const ALIKE: f64 = 0.5;

/// Sends the photons of one pass.
pub(super) fn photons<const N: usize>(world: &World, pass: u32) -> Option<Photons<N>> {
    let aims = world.map_aims.as_ref()?;
    let seed = world.method.seed ^ SEED;
    let [wavelength, ..] = Sampler::new(seed, [u32::MAX; 2], pass).four(BranchKey::CAMERA, 0);
    let draw = world.method.basis.draw(wavelength);
    let batches = batches(aims, |aim| u64::from(pass) * aim.photons, |aim| aim.photons, seed);
    let keep = |_: &Tracer<N>, landing: &Landing<N>, _: &Sampler, kept: &mut Vec<_>| kept.push(landed(world, landing));
    let done: Vec<Sent<(DVec3, Landed<N>)>> =
        batches.par_iter().map(|batch| send(world, aims, *batch, Some(&draw), false, keep)).collect();
    let (mut rays, mut unmatched, mut kept) = (0, 0, Vec::new());
    for sent in done {
        rays += sent.rays;
        unmatched += sent.unmatched;
        kept.extend(sent.kept);
    }
    let landed = kept.len();
    kept.retain(|(_, photon): &(_, Landed<N>)| photon.flux.0.iter().all(|x| x.is_finite()));
    let non_finite = (landed - kept.len()) as u64;
    let sent = batches.iter().map(|batch| batch.count).sum();
    Some(Photons { map: Map::new(kept), wavelength, sent, rays, unmatched, non_finite })
}

/// Camera samples along each side of the image that look where the camera's paths lead.
const SIDE: u32 = 24;
/// Sets their random numbers apart.
const LOOKING: u64 = 0x6c6f_6f6b;

/// Places on surfaces that scatter widely to which paths from the camera come by way of others; the same whatever part of
/// the image is made.
pub fn reached_places(world: &World) -> Vec<DVec3> {
    in_lanes(&world.method.basis, Looking { world })
}

struct Looking<'a> {
    world: &'a World,
}

impl InLanes for Looking<'_> {
    type Output = Vec<DVec3>;
    fn run<const N: usize>(self) -> Self::Output {
        let mut tracer = Tracer::<N>::new(self.world);
        tracer.reached = Some(Vec::new());
        look(self.world, &mut tracer);
        tracer.reached.unwrap_or_default()
    }
}

fn look<const N: usize>(world: &World, tracer: &mut Tracer<N>) {
    let film = world.scene.film;
    for place in 0..SIDE * SIDE {
        let spread = |i: u32, size: u32| ((u64::from(2 * i + 1) * u64::from(size)) / u64::from(2 * SIDE)) as u32;
        let (x, y) = (spread(place % SIDE, film.width), spread(place / SIDE, film.height));
        sample(world, tracer, &Sampler::new(world.method.seed ^ LOOKING, [x, y], place), x, y);
    }
}

/// The photons of one pass that lie within a pixel of such places, where all of `SIDE` times `SIDE` fill the image; as a share.
pub fn gathered_photons(world: &World, places: &[DVec3]) -> f64 {
    in_lanes(&world.method.basis, Finding { world, places })
}

struct Finding<'a> {
    world: &'a World,
    places: &'a [DVec3],
}

impl InLanes for Finding<'_> {
    type Output = f64;
    fn run<const N: usize>(self) -> f64 {
        let Some(photons) = photons::<N>(self.world, 0) else { return 0.0 };
        let (world, camera) = (self.world, &self.world.scene.camera);
        let coarse = f64::from(world.scene.film.width) / f64::from(SIDE);
        let found = |place: &&DVec3| {
            let radius = coarse * camera.pixel_width((**place - camera.position()).length());
            let mut any = false;
            photons.map.near(**place, radius, &mut |_, _| any = true);
            any
        };
        self.places.iter().filter(found).count() as f64 / self.places.len().max(1) as f64
    }
}

fn landed<const N: usize>(world: &World, landing: &Landing<N>) -> (DVec3, Landed<N>) {
    let Landing { path, arrival, flat, point, hit, light, .. } = landing;
    let photon = Landed {
        flux: landing.flux(world) * (1.0 / arrival.wo.dot(*flat).abs()) as f32,
        back: arrival.wo,
        flat: *flat,
        object: hit.object,
        light: *light,
        vertices: path.vertices,
        parted: path.parted,
    };
    (point.position, photon)
}

impl<const N: usize> Photons<N> {
    /// What the sensor gets of the photons around a place that a path has reached.
    pub(super) fn gather(
        &self,
        world: &World,
        path: &Path<N>,
        arrival: &Arrival<N>,
        (hit, point, flat): (&Hit, &SurfacePoint, DVec3),
        (material, parts): (&Material<Table>, bool),
    ) -> [f64; 3] {
        let mut sum = [0.0; 3];
        let Some(map) = world.method.light_pass.as_ref().and_then(|pass| pass.map) else { return sum };
        let radius = map.radius * world.scene.camera.pixel_width(path.length);
        let area = PI * radius * radius;
        self.map.near(point.position, radius, &mut |squared, photon| {
            let long = path.vertices + photon.vertices - 1 > world.method.max_bounces;
            if photon.object != hit.object || photon.flat.dot(flat).abs() < ALIKE || long {
                return;
            }
            let Some((bsdf_cos, _)) = shading::evaluate(material, arrival, flat, photon.back) else { return };
            // The kernel of Epanechnikov, which integrates to 1 over the disc.
            let factor = 2.0 * (1.0 - squared / (radius * radius)) / area;
            let crosses = photon.back.dot(flat) < 0.0;
            let parted = path.parted || photon.parted || (crosses && parts);
            let arriving = path.throughput.of(bsdf_cos * photon.flux);
            let rgb = world.responses[photon.light].sensor(arrival.draw, arriving, parted);
            (0..3).for_each(|i| sum[i] += factor * rgb[i]);
        });
        sum
    }
}

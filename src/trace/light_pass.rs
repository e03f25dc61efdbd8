//! The light pass: caustics, by photons that are sent through glass and over mirrors to what the camera sees.
//!
//! It finds the paths light, one or more smooth surfaces, one that scatters widely, camera; and so all of those paths whose
//! light and first smooth surface photons are sent from and to. The camera's rays leave exactly these out, so that
//! nothing counts twice and no weights are needed. Veach 1997, *Robust Monte Carlo Methods for Light Transport Simulation*,
//! section 10.3.4, has the importance; Grittmann et al. 2018, *Efficient Caustic Rendering with Lightweight Photon
//! Mapping*, the split by kind of path.

use rayon::prelude::*;

use super::World;
use super::aims::Aims;
use super::media::Media;
use super::photon::Splat;
use super::tracer::Tracer;
use super::{LightPass, Transport};
use crate::light::Light;
use crate::math::{BranchKey, DVec3, Sampler};
use crate::scene::Scene;
use crate::spectrum::Table;

/// Photons that are followed one after another; the splats of a batch are added in its order, batch after batch.
const BATCH: u64 = 4096;
/// Batches whose splats are kept in memory at once.
const AT_ONCE: usize = 64;
/// Sets these random numbers apart from those of the camera.
const SEED: u64 = 0x7068_6f74;
/// Uses of a photon's random numbers: its first ray, and its wavelengths.
const RAY: u32 = 0;
const WAVELENGTHS: u32 = 1;

/// Photons as camera paths: followed in all branches while they carry much, then in one.
const PHOTONS: Transport = Transport::Random { split: 0.05, roulette: 0.05 };

/// What the light pass found.
#[derive(Clone, Debug, Default)]
pub(super) struct Shown {
    /// Film values of the window's pixels; empty where there is no pass.
    pub(super) pixels: Vec<[f64; 3]>,
    /// Photons sent.
    pub(super) photons: u64,
    /// Rays followed.
    pub(super) rays: u64,
    /// Splats that were not finite.
    pub(super) non_finite: u64,
    /// Splats.
    pub(super) splats: u64,
    /// Surfaces of bodies that were left without having been entered.
    pub(super) unmatched: u64,
}

/// A part of an aim's photons.
#[derive(Clone, Copy)]
struct Batch {
    aim: usize,
    first: u64,
    count: u64,
}

/// Sends all photons of a world's light pass.
pub(super) fn show<const N: usize>(world: &World) -> Shown {
    let mut shown = Shown::default();
    let Some(aims) = &world.aims else { return shown };
    let window = world.scene.film.window();
    shown.pixels = vec![[0.0; 3]; window.width as usize * window.height as usize];
    let starts: Vec<Option<Media>> = (0..world.scene.lights.len()).map(|light| media_of(world, light)).collect();
    let batches: Vec<Batch> = aims
        .aims
        .iter()
        .enumerate()
        .flat_map(|(aim, of)| {
            let batch = move |first: u64| Batch { aim, first, count: BATCH.min(of.photons - first) };
            (0..of.photons).step_by(BATCH as usize).map(batch)
        })
        .collect();
    for group in batches.chunks(AT_ONCE) {
        let done: Vec<_> = group.par_iter().map(|batch| send::<N>(world, aims, &starts, *batch)).collect();
        for (splats, rays, unmatched) in done {
            shown.rays += rays;
            shown.unmatched += unmatched;
            shown.splats += splats.len() as u64;
            for Splat { pixel, rgb } in splats {
                if rgb.iter().all(|x| x.is_finite()) {
                    (0..3).for_each(|i| shown.pixels[pixel as usize][i] += rgb[i]);
                } else {
                    shown.non_finite += 1;
                }
            }
        }
    }
    shown.photons = batches.iter().map(|batch| batch.count).sum();
    shown
}

/// The splats of one batch, the rays followed and the bodies left without having been entered.
fn send<const N: usize>(world: &World, aims: &Aims, starts: &[Option<Media>], batch: Batch) -> (Vec<Splat>, u64, u64) {
    let mut tracer = Tracer::<N>::new(world).with_transport(PHOTONS);
    let mut splats = Vec::new();
    let light = aims.aims[batch.aim].light;
    for photon in batch.first..batch.first + batch.count {
        let key = [batch.aim as u32, (photon >> 32) as u32];
        let sampler = Sampler::new(world.method.seed ^ SEED, key, photon as u32);
        let u = sampler.four(BranchKey::CAMERA, RAY);
        let Some(emitted) = aims.emit(&world.scene, batch.aim, u) else { continue };
        let wavelength = if world.method.basis.draws_wavelengths() {
            // A point needs two of four numbers that are spread together.
            if world.scene.lights[light].is_extended() { sampler.four(BranchKey::CAMERA, WAVELENGTHS)[0] } else { u[2] }
        } else {
            0.0
        };
        let draw = world.method.basis.draw(wavelength);
        let media = starts[light].unwrap_or_else(|| Media::around(world, emitted.ray.origin, emitted.ray.direction));
        tracer.photon(&emitted, light, media, &draw, &sampler, &mut splats);
    }
    (splats, tracer.tally.rays, tracer.tally.unmatched)
}

/// The bodies around a light; none where they may differ from point to point.
fn media_of(world: &World, light: usize) -> Option<Media> {
    let scene: &Scene<Table> = &world.scene;
    if !world.has_media {
        return Some(Media::default());
    }
    match &scene.lights[light] {
        Light::Point(point) => Some(Media::around(world, point.position.into(), DVec3::Y)),
        Light::Spot(spot) => Some(Media::around(world, spot.position.into(), DVec3::Y)),
        Light::Area(area) => {
            let own = area.shape.bounds()?;
            let clear = (0..scene.objects.len()).filter(|&i| scene.material_of(i as u32).medium().is_some());
            let apart = clear.map(|i| scene.objects[i].shape.bounds()).all(|other| {
                other.is_some_and(|other| own.max.cmplt(other.min).any() || own.min.cmpgt(other.max).any())
            });
            apart.then(Media::default)
        }
        Light::Sun(_) | Light::Environment(_) => Some(Media::default()),
    }
}

impl World {
    /// Whether photons are sent to an object.
    pub(super) fn is_photon_target(&self, object: u32) -> bool {
        self.aims.as_ref().is_some_and(|aims| aims.objects[object as usize])
    }

    /// Whether a light sends photons.
    pub(super) fn sends_photons(&self, light: usize) -> bool {
        self.aims.as_ref().is_some_and(|aims| aims.lights[light])
    }

    /// How the light pass is to be done, if there is something to aim at.
    pub(super) fn aims_of(scene: &Scene<Table>, pass: Option<&LightPass>) -> Option<Aims> {
        pass.and_then(|pass| Aims::new(scene, pass))
    }
}

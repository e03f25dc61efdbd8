//! The light pass: caustics, by photons that are sent through glass and over mirrors to what the camera sees.
//!
//! It finds the paths light, one or more smooth surfaces, one that scatters widely, camera; and so all of those paths whose
//! light and first smooth surface photons are sent from and to. The camera's rays leave exactly these out, so that
//! nothing counts twice and no weights are needed. Veach 1997, *Robust Monte Carlo Methods for Light Transport Simulation*,
//! section 10.3.4, has the importance; Grittmann et al. 2018, *Efficient Caustic Rendering with Lightweight Photon
//! Mapping*, the split by kind of path.

use rayon::prelude::*;

use super::aims::Aims;
use super::media::Media;
use super::photon::Splat;
use super::tracer::Tracer;
use super::width::{InLanes, in_lanes};
use super::{Transport, World};
use crate::light::{Light, LightId};
use crate::math::{BranchKey, DVec3, Sampler};

/// Photons that are followed one after another; the splats of a batch are added in its order, batch after batch.
const BATCH: u64 = 4096;
/// Batches whose splats are kept in memory at once.
const AT_ONCE: usize = 64;
/// Sets these random numbers apart from those of the camera, and those of photons sent ahead from both.
const SEED: u64 = 0x7068_6f74;
const AHEAD_SEED: u64 = 0x6168_6561;
/// Use of a photon's random numbers: its first ray.
const RAY: u32 = 0;

/// Of an aim's photons, one in so many is sent ahead to learn which ones are seen, unless those are too few to tell, and as
/// many as tell enough.
const AHEAD: u64 = 8;
const TOO_FEW: u64 = 4096;
const ENOUGH: u64 = 1 << 16;

/// Photons are followed like camera paths: in all branches while they carry much, then in one. Splitting at 0.05 took as much
/// time for as much noise, never splitting 2 to 15 times as much (`benches/caustics.rs`).
const PHOTONS: Transport = Transport::Random { split: 0.25, roulette: 0.05 };

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
    /// Surfaces of bodies that were left without having been entered.
    pub(super) unmatched: u64,
}

/// A part of an aim's photons.
#[derive(Clone, Copy)]
struct Batch {
    aim: usize,
    first: u64,
    count: u64,
    seed: u64,
}

/// What became of a batch.
struct Sent {
    splats: Vec<Splat>,
    /// Where each photon was sent and whether the camera saw it.
    places: Vec<([f64; 2], bool)>,
    rays: u64,
    unmatched: u64,
}

/// Sends all photons of a world's light pass.
pub(super) fn show<const N: usize>(world: &World) -> Shown {
    let mut shown = Shown::default();
    let Some(aims) = &world.aims else { return shown };
    let window = world.scene.film.window();
    shown.pixels = vec![[0.0; 3]; window.width as usize * window.height as usize];
    let starts = starts(world);
    let counts = aims.aims.iter().map(|aim| aim.photons);
    let batches = batches(counts, world.method.seed ^ SEED);
    for group in batches.chunks(AT_ONCE) {
        let done: Vec<Sent> = group.par_iter().map(|batch| send::<N>(world, aims, &starts, *batch, false)).collect();
        for sent in done {
            shown.rays += sent.rays;
            shown.unmatched += sent.unmatched;
            for Splat { pixel, rgb } in sent.splats {
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

fn batches(photons: impl Iterator<Item = u64>, seed: u64) -> Vec<Batch> {
    let of_aim = |(aim, photons): (usize, u64)| {
        let batch = move |first: u64| Batch { aim, first, count: BATCH.min(photons - first), seed };
        (0..photons).step_by(BATCH as usize).map(batch)
    };
    photons.enumerate().flat_map(of_aim).collect()
}

/// Follows the photons of one batch.
fn send<const N: usize>(world: &World, aims: &Aims, starts: &[Option<Media>], batch: Batch, learns: bool) -> Sent {
    let mut tracer = Tracer::<N>::new(world).with_transport(PHOTONS);
    let (mut splats, mut places) = (Vec::new(), Vec::new());
    let light = aims.aims[batch.aim].light;
    // Of four numbers that are spread together, a point needs two for the ray.
    let extended = !matches!(world.scene.lights[light], Light::Point(_) | Light::Spot(_));
    for photon in batch.first..batch.first + batch.count {
        let key = [batch.aim as u32, (photon >> 32) as u32];
        let sampler = Sampler::new(batch.seed, key, photon as u32);
        let u = sampler.four(BranchKey::CAMERA, RAY);
        let wavelength = if extended && world.method.basis.draws_wavelengths() {
            sampler.four_more(BranchKey::CAMERA, RAY)[0]
        } else {
            u[2]
        };
        let place = aims.place(batch.aim, [u[0], u[1]]);
        let before = splats.len();
        if let Some(emitted) = aims.emit(&world.scene, batch.aim, place, [u[2], u[3]]) {
            let draw = world.method.basis.draw(wavelength);
            let around = || Media::around(world, emitted.ray.origin, emitted.ray.direction);
            let media = starts[light].unwrap_or_else(around);
            tracer.photon(&emitted, light, media, &draw, &sampler, &mut splats);
        }
        if learns {
            places.push((place, splats.len() > before));
            splats.clear();
        }
    }
    Sent { splats, places, rays: tracer.tally.rays, unmatched: tracer.tally.unmatched }
}

/// What photons sent ahead found: of each aim, the places and whether the camera saw them. The whole image sees, also where
/// only a part of it is made, so that all parts are made alike.
struct Learning<'a> {
    world: &'a World,
    most: u64,
}

impl InLanes for Learning<'_> {
    type Output = Vec<Vec<([f64; 2], bool)>>;
    fn run<const N: usize>(self) -> Self::Output {
        let mut world = self.world.clone();
        world.scene.film.crop = None;
        let Some(aims) = &world.aims else { return Vec::new() };
        let starts = starts(&world);
        let batches = batches(aims.aims.iter().map(|aim| aim.photons.min(self.most)), world.method.seed ^ AHEAD_SEED);
        let done: Vec<Sent> = batches.par_iter().map(|batch| send::<N>(&world, aims, &starts, *batch, true)).collect();
        let mut found = vec![Vec::new(); aims.aims.len()];
        for (batch, sent) in batches.iter().zip(done) {
            found[batch.aim].extend(sent.places);
        }
        found
    }
}

/// Of the photons of each light, the share that the camera sees.
pub fn seen_photons(world: &World) -> Vec<f64> {
    let mut counts = vec![[0_u32; 2]; world.scene.lights.len()];
    let Some(aims) = &world.aims else { return vec![0.0; counts.len()] };
    let found = in_lanes(&world.method.basis, Learning { world, most: TOO_FEW });
    for (aim, photons) in aims.aims.iter().zip(found) {
        let [sent, seen] = &mut counts[aim.light];
        *sent += photons.len() as u32;
        *seen += photons.iter().filter(|photon| photon.1).count() as u32;
    }
    counts.into_iter().map(|[sent, seen]| f64::from(seen) / f64::from(sent.max(1))).collect()
}

impl World {
    /// Sends photons ahead, and the others where those were seen.
    pub(super) fn learn_where_to_send(&mut self) {
        let Some(least) = self.aims.as_ref().and_then(|aims| aims.aims.iter().map(|aim| aim.photons / AHEAD).min())
        else {
            return;
        };
        if least >= TOO_FEW {
            let found = in_lanes(&self.method.basis, Learning { world: self, most: least.min(ENOUGH) });
            if let Some(aims) = &mut self.aims {
                aims.learn(&found);
            }
        }
    }

    /// Whether photons are sent to an object; none if they do not follow light over it: where normals are bent, light goes
    /// one way from the lamp and another from the camera.
    pub(super) fn photons_over(&self, object: u32) -> Option<bool> {
        let aims = self.aims.as_ref()?;
        (!self.scene.objects[object as usize].is_bent()).then_some(aims.objects[object as usize])
    }

    /// Whether photons are sent to an object.
    pub(super) fn is_photon_target(&self, object: u32) -> bool {
        self.aims.as_ref().is_some_and(|aims| aims.objects[object as usize])
    }

    /// Whether a light sends photons.
    pub(super) fn sends_photons(&self, light: LightId) -> bool {
        self.aims.as_ref().is_some_and(|aims| aims.lights[light])
    }
}

/// The bodies around each light; none where they may differ from point to point.
fn starts(world: &World) -> Vec<Option<Media>> {
    (0..world.scene.lights.len()).map(|light| media_of(world, light)).collect()
}

/// The bodies around a light; none where they may differ from point to point.
fn media_of(world: &World, light: LightId) -> Option<Media> {
    let scene = &world.scene;
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

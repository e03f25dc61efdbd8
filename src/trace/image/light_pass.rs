//! The light pass: caustics from photons that are sent through glass and over mirrors to what the camera sees.
//!
//! It finds the paths light, one or more smooth surfaces, one that scatters widely, camera: all of those whose light
//! and first smooth surface photons are sent from and to. The camera's rays leave out exactly these, so that nothing
//! counts twice and no weights are needed. Veach 1997, *Robust Monte Carlo Methods for Light Transport Simulation*,
//! section 10.3.4, has the importance; Grittmann et al. 2018, *Efficient Caustic Rendering with Lightweight Photon
//! Mapping*, the split by kind of path.

use serde::{Deserialize, Serialize};

use super::tile::{PhotonTile, Tile};
use crate::film::{Layer, Shard};
use crate::trace::World;
use crate::trace::contribution::{Contribution, FoundBy};
use crate::trace::parallel::in_parallel;
use crate::trace::pass::Pass;
use crate::trace::photon::{Batch, Splat, batches_of_pass, splat_photon, trace_batch};
use crate::trace::photon_targets::PhotonTargets;
use crate::trace::stats::Stats;
use crate::trace::walk::Polarization;

/// Batches whose splats are kept in memory at once.
const BATCHES_AT_ONCE: usize = 64;
/// Sets these random numbers apart from those of the camera.
const SEED: u64 = 0x7068_6f74;

/// The callbacks of a render in progress.
pub struct Callbacks<'a> {
    /// Called with the number of camera samples, or photons, done since the last call; from any thread.
    pub progress: &'a (dyn Fn(u64) + Sync),
    /// Returns whether to stop for a while; called again and again, from any thread.
    pub should_stop: &'a (dyn Fn() -> bool + Sync),
}

/// How far a light pass is. It continues where it stopped.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct LightPassProgress {
    /// Batches that are done.
    pub batches: usize,
    pub photons: u64,
    pub(in crate::trace) stats: Stats,
}

impl LightPassProgress {
    /// Returns the share of a pass's photons that have been sent.
    pub(in crate::trace) fn sent_share(&self, world: &World, pass: &Pass) -> f64 {
        let Some(targets) = world.photon_targets.as_ref().filter(|_| self.batches > 0) else { return 0.0 };
        let batches = batches_of_pass(&pass.targets(world, targets, 1), 0, 0);
        let photons = |batches: &[Batch]| batches.iter().map(|batch| batch.count).sum::<u64>() as f64;
        photons(&batches[..self.batches.min(batches.len())]) / photons(&batches)
    }
}

/// Sends the photons of a world's light pass that have not been sent, until told to stop, and adds their splats to the
/// tiles of a part of the image. Returns whether all are sent. Calls `progress` with the number that is done. The first
/// pass sends all photons; with replicates, every pass sends some.
///
/// Every part sends all photons, which may be seen anywhere: summing what the parts found would change the last bits.
pub fn splat_photons<const N: usize, P: Polarization<N>>(
    world: &World,
    pass: &Pass,
    sending: &mut LightPassProgress,
    shard: Shard,
    tiles: &mut [Tile],
    callbacks: &Callbacks,
) -> bool {
    let Some(targets) = &world.photon_targets else { return true };
    // Where every pass sends photons, they weigh as much as its samples.
    let weight = pass.replicate.map_or(1.0, |_| pass.numbers.len() as f64);
    let (window, row_len) = (world.scene.film.window(), world.layers.row_len);
    for tile in tiles.iter_mut().filter(|tile| tile.splatted.pixels.is_empty()) {
        let pixels = tile.sums.len();
        tile.splatted = PhotonTile {
            pixels: vec![[0.0; 3]; pixels],
            layers: vec![0.0; pixels * row_len],
            polarization_change: 0.0,
        };
    }
    let add = &mut |pixel: u32, splat: Splat| {
        let first_half = pass.is_in_first_half().unwrap_or(splat.first_half);
        let splat = Splat { first_half, ..splat.times(weight) };
        let Splat { change, rgb, .. } = splat;
        let Some([tile, place]) = shard.place_of(window, pixel) else { return };
        let Tile { splatted, replicates, .. } = &mut tiles[tile];
        if !world.layers.is_empty() {
            add_to_layers(world, &splat, &mut splatted.layers[place * row_len..][..row_len]);
        }
        if splat.on_catcher {
            let luminance = world.layers.luminance_of(&rgb);
            pass.replicate.iter().for_each(|&replicate| replicates.add_caught_splat(place, replicate, luminance));
            return;
        }
        (0..3).for_each(|i| splatted.pixels[place][i] += rgb[i]);
        if change != 0.0 {
            splatted.polarization_change += f64::from(change) * world.amount(rgb);
        }
        pass.replicate.iter().for_each(|&replicate| replicates.add_splat(place, replicate, rgb));
    };
    send_remaining::<N, P>(world, &pass.targets(world, targets, 1), pass.photon_seed().0, sending, callbacks, add)
}

/// Adds a photon that the camera sees to the row of its pixel, which holds means.
fn add_to_layers(world: &World, splat: &Splat, row: &mut [f64]) {
    let Splat { light, rgb, bounces, dispersed, first_half, on_catcher, first, weight, .. } = *splat;
    if on_catcher {
        return world.layers.add_caught_photon(row, rgb);
    }
    let light = Some(light);
    world.layers.add(
        row,
        &Contribution { light, found: FoundBy::Splatted, rgb, polarization_change: 0.0, first, bounces, dispersed },
    );
    if let Some(stokes) = &splat.stokes {
        world.layers.add_stokes(row, **stokes, weight);
    }
    if let (Some(spectrum), Some(bands)) = (&world.layers.spectrum, &splat.bands) {
        let sums = row[spectrum.offset..].iter_mut().zip(bands.iter());
        sums.for_each(|(sum, &light)| *sum += weight * f64::from(light));
    }
    world.layers.add_to(Layer::Variance, row, rgb.map(|x| x * x));
    world.layers.add_to(if first_half { Layer::HalfA } else { Layer::HalfB }, row, rgb.map(|x| 2.0 * x));
}

/// Sends all photons and calls `record` with their splats, pixel by pixel, in a fixed order; stores no image.
pub fn for_each_splat<const N: usize, P: Polarization<N>>(
    world: &World,
    record: &mut dyn FnMut(u32, Splat),
) -> LightPassProgress {
    let (mut sending, callbacks) =
        (LightPassProgress::default(), Callbacks { progress: &|_| (), should_stop: &|| false });
    if let Some(targets) = &world.photon_targets {
        send_remaining::<N, P>(world, targets, world.method.seed, &mut sending, &callbacks, record);
    }
    sending
}

/// Sends the photons that have not been sent, until told to stop; returns whether all are sent.
fn send_remaining<const N: usize, P: Polarization<N>>(
    world: &World,
    targets: &PhotonTargets,
    seed: u64,
    sending: &mut LightPassProgress,
    callbacks: &Callbacks,
    record: &mut dyn FnMut(u32, Splat),
) -> bool {
    let batches = batches_of_pass(targets, 0, seed ^ SEED);
    for group in batches.get(sending.batches..).unwrap_or_default().chunks(BATCHES_AT_ONCE) {
        let trace_batch = |number: usize| {
            (!(callbacks.should_stop)())
                .then(|| trace_batch(world, targets, group[number], false, &splat_photon::<N, P>))
        };
        let done = in_parallel(group.len(), &trace_batch);
        for (batch, sent) in group.iter().zip(done) {
            // Splats are added in the order of the batches, so those after a gap are found again later.
            let Some(sent) = sent else { return false };
            (callbacks.progress)(batch.count);
            (sending.batches, sending.photons) = (sending.batches + 1, sending.photons + batch.count);
            sending.stats += sent.stats;
            let mut record_finite = |pixel, splat: Splat| match splat.rgb.iter().all(|x| x.is_finite()) {
                true => record(pixel, splat),
                false => sending.stats.non_finite += 1,
            };
            sent.records.iter().for_each(|placed| placed.spread(world.scene.film, &mut record_finite));
        }
    }
    true
}

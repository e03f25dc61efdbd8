//! Renders in progress as they are saved: how far they are, and the sums of all tiles.

use std::io;

use serde::{Deserialize, Serialize};

use super::light_pass::LightPassProgress;
use super::passes::Progress;
use super::tile::{PhotonTile, Tile};
use crate::error::Result;
use crate::film::{BlockReader, BlockWriter, Layer};
use crate::trace::World;

/// The header before the tiles.
#[derive(Serialize, Deserialize)]
struct Header {
    progress: Progress,
    /// Camera samples of each pixel after the pass that was stopped, if any pixel is ahead in it.
    end_of_pass: Option<u32>,
    /// Camera samples of each pixel in all passes.
    samples: u32,
    /// Photons of the light pass.
    photons: Option<u64>,
    tiles: u64,
}

fn photons(world: &World) -> Option<u64> {
    world.method.light_pass.as_ref().map(|pass| pass.photons)
}

/// What came of restoring a saved render.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Restored {
    /// The new render continues from there.
    Continues,
    /// It was finished with this many samples per pixel, more than requested. Nothing else was read.
    HasMore(u32),
    /// Why this render cannot continue from there, and the samples per pixel of one that can.
    Refused(String, u32),
}

/// Writes how far a render of a world is, and its sums.
///
/// # Errors
/// If they cannot be written.
pub fn save(world: &World, progress: &Progress, tiles: &[Tile], blocks: &mut BlockWriter) -> io::Result<()> {
    let is_ahead = |tile: &Tile| tile.ahead > 0 || tile.passes > progress.passes;
    let end_of_pass = tiles.iter().any(is_ahead).then(|| progress.end_of_pass(world));
    let (samples, photons) = (world.method.samples, photons(world));
    blocks.block(&Header { progress: *progress, end_of_pass, samples, photons, tiles: tiles.len() as u64 })?;
    tiles.iter().try_for_each(|tile| blocks.block(tile))
}

/// Reads how far a render of an equal world was, perhaps with another number of samples, and its sums.
///
/// # Errors
/// If they cannot be read.
pub fn restore(
    world: &World,
    progress: &mut Progress,
    tiles: &mut [Tile],
    mut blocks: BlockReader,
) -> Result<Restored> {
    let Header { progress: found, end_of_pass, samples, photons: sent, tiles: saved } = blocks.block()?;
    *progress = found;
    let has_more = match &world.method.stop {
        None => progress.samples == samples && samples > world.method.samples,
        Some(stop) => progress.samples > stop.max_samples,
    };
    if has_more {
        return Ok(Restored::HasMore(progress.samples));
    }
    if let Some(objection) = objection(world, progress, end_of_pass, samples) {
        let end = if world.method.stop.is_some() { progress.samples_after_stage() } else { samples };
        return Ok(Restored::Refused(objection, end));
    }
    if saved != tiles.len() as u64 || !progress.is_consistent(world) {
        return Err(blocks.damaged());
    }
    // Camera samples do not depend on how many photons are sent beside them.
    let is_sent_anew = sent != photons(world);
    let objects = world.scene.objects.len();
    for tile in tiles {
        let mut restored: Tile = blocks.block()?;
        let passes = u64::from(restored.passes);
        let fits = restored.has_same_shape(tile, &world.layers) && restored.layers.covered.is_valid_for(objects);
        if !fits || ![0, 1].map(|more| u64::from(progress.passes) + more).contains(&passes) {
            return Err(blocks.damaged());
        }
        if is_sent_anew {
            restored.splatted = PhotonTile::default();
        }
        *tile = restored;
    }
    blocks.end()?;
    if is_sent_anew {
        progress.sending = LightPassProgress::default();
    }
    Ok(Restored::Continues)
}

/// Returns why a render cannot continue from what was saved of one with the same plan and `samples` samples.
fn objection(world: &World, progress: &Progress, end_of_pass: Option<u32>, samples: u32) -> Option<String> {
    if let Some(stop) = &world.method.stop {
        let (end, most) = (progress.samples_after_stage(), stop.max_samples);
        return (end > most).then(|| format!("it is on its way to {end} samples per pixel, more than {most}"));
    }
    let requested = world.method.samples;
    let (taken, begun) = (progress.samples, end_of_pass.is_some());
    let is_on_the_way = progress.is_reached_by(world);
    if !is_on_the_way || end_of_pass.is_some_and(|end| end != progress.end_of_pass(world)) {
        return Some(format!(
            "it has {taken} of {samples} samples per pixel{}, but a render with {requested} has no pass that ends there",
            if begun { ", and more in some pixels" } else { "" }
        ));
    }
    let halves = [Layer::HalfA, Layer::HalfB].iter().any(|&half| world.layers.offset(half).is_some());
    (halves && requested != samples && (taken > 0 || begun)).then(|| {
        format!("half_a and half_b are halves of {samples} samples, and those of {requested} cannot be made from them")
    })
}

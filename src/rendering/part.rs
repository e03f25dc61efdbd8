//! Parts of an image that are rendered on several machines: finished tiles, and the other contents of the image's file.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::identity::Identity;
use super::image::Image;
use super::provenance::{NON_FINITE, SAMPLES};
use crate::error::{Error, Result};
use crate::film::{BlockReader, CameraView, Film, Format, Kind, Provenance, Shard, write_blocks};
use crate::scene::FilmSettings;
use crate::trace;

/// The first bytes of a part.
const MAGIC: Kind = *b"AbbePrt1";

/// The data before the tiles.
#[derive(Serialize, Deserialize)]
pub(super) struct PartHeader {
    /// Read first and separately: the rest of another version's file cannot be read.
    #[serde(skip)]
    identity: Identity,
    pub(super) shard: Shard,
    /// The image without its pixels.
    pub(super) film: Film,
    pub(super) format: Format,
    pub(super) view: CameraView,
    /// Counts only the non-finite samples of the light that all parts send alike. `non_finite` counts the others.
    pub(super) provenance: Provenance,
    pub(super) non_finite: u64,
}

/// Writes the finished tiles of an image. `summary` holds everything else about it.
///
/// # Errors
/// If they cannot be written. An existing file is then untouched.
pub(super) fn write(
    path: &Path,
    identity: &Identity,
    shard: Shard,
    summary: Image,
    passes: &trace::Rendering,
) -> Result<()> {
    let Image { film, report, view, format, mut provenance, .. } = summary;
    let shared = passes.non_finite_in_all_parts();
    provenance.set_count(NON_FINITE, shared);
    let (identity, non_finite) = (identity.without_part(), report.non_finite - shared);
    let head = PartHeader { identity, shard, film, format, view, provenance, non_finite };
    write_blocks(path, MAGIC, &|blocks| {
        blocks.block(&head.identity)?;
        blocks.block(&head)?;
        passes.tiles().try_for_each(|tile| blocks.block(&tile))
    })
}

/// Opens a part and reads its header.
///
/// # Errors
/// [`Error::Arguments`] if it does not exist, is no part, or is of another version; [`Error::Decode`] if it is damaged.
pub(super) fn open(path: &Path) -> Result<(PartHeader, BlockReader)> {
    let help = "parts are made by --shard, as in render --shard 1/4 scene.toml";
    if !path.exists() {
        return Error::refuse(format!("there is no part {}", path.display()), help);
    }
    let Some(mut blocks) = BlockReader::open(path, MAGIC)? else {
        return Error::refuse(format!("{} is not a part of an image", path.display()), help);
    };
    let identity: Identity = blocks.block()?;
    if let Some(objection) = identity.objection() {
        return Error::refuse(format!("{} cannot be read: {objection}", path.display()), "merge it with that version");
    }
    let head = PartHeader { identity, ..blocks.block()? };
    let Film { width, height, .. } = head.film;
    let fits = u64::from(width) * u64::from(height) <= FilmSettings::MAX_PIXELS;
    if fits { Ok((head, blocks)) } else { Err(blocks.damaged()) }
}

impl PartHeader {
    /// Returns why another part does not belong to the same image, if that is so.
    pub(super) fn difference(&self, part: &Self) -> Option<String> {
        if part.shard.count() != self.shard.count() {
            return Some(format!("it is one of {} parts, not of {}", part.shard.count(), self.shard.count()));
        }
        if let Some(difference) = self.identity.difference(&part.identity) {
            return Some(difference);
        }
        let (ours, theirs) = (&self.provenance, &part.provenance);
        if let Some(((key, theirs), (_, ours))) = theirs.facts.iter().zip(&ours.facts).find(|(a, b)| a != b) {
            return Some(match &**key {
                SAMPLES => format!("it has {theirs} samples per pixel, not {ours}"),
                key => format!("its {key} is {theirs}, not {ours}"),
            });
        }
        let is_other = (&part.film, &part.format, &part.view) != (&self.film, &self.format, &self.view);
        (is_other || ours != theirs).then(|| "it was made with other options".into())
    }

    /// Returns how many samples were left out of the light that all parts send alike.
    pub(super) fn shared_non_finite(&self) -> u64 {
        self.provenance.count(NON_FINITE).unwrap_or_default()
    }
}

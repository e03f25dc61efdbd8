//! Checkpoints: renders that were stopped, and go on.

use std::path::Path;

use super::identity::Identity;
use crate::error::{Error, Result};
use crate::film::{BlockReader, Kind, write_blocks};
use crate::trace;

/// The first bytes of a checkpoint.
const CHECKPOINT: Kind = *b"AbbeCkp1";

/// What came of a checkpoint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Resumed {
    /// The render goes on from there.
    Continues,
    /// All samples that are asked for had been taken; the image is there.
    Finished,
    /// More than that had been taken, so many of each pixel. Nothing was read.
    HasMore(u32),
}

/// Whether a file is a checkpoint, which may be damaged or of another render.
///
/// # Errors
/// If it cannot be read.
pub fn is_checkpoint(path: &Path) -> Result<bool> {
    // A pipe would be waited for.
    Ok(path.is_file() && BlockReader::open(path, CHECKPOINT)?.is_some())
}

/// Writes a checkpoint.
///
/// # Errors
/// If it cannot be written; a file that was there before is then untouched.
pub(super) fn save(path: &Path, identity: &Identity, passes: &trace::Rendering) -> Result<()> {
    write_blocks(path, CHECKPOINT, &|blocks| {
        blocks.block(identity)?;
        passes.save(blocks)
    })
}

/// Goes on from a checkpoint.
///
/// # Errors
/// If it is of something else, damaged, or cannot be read.
pub(super) fn resume(path: &Path, identity: &Identity, passes: &mut trace::Rendering) -> Result<Resumed> {
    let Some(mut blocks) = BlockReader::open(path, CHECKPOINT)? else {
        return refuse(path, "it is no checkpoint", "name another image, or move that file away");
    };
    let saved: Identity = blocks.block()?;
    if let Some(difference) = identity.difference(&saved) {
        return refuse(path, &difference, "delete it to begin anew, or name another image");
    }
    match passes.restore(blocks)? {
        trace::Restored::Continues if passes.is_finished() => Ok(Resumed::Finished),
        trace::Restored::Continues => Ok(Resumed::Continues),
        trace::Restored::HasMore(samples) => Ok(Resumed::HasMore(samples)),
        trace::Restored::Refused(why, samples) => {
            refuse(path, &why, &format!("ask for {samples} samples per pixel, or delete it to begin anew"))
        }
    }
}

fn refuse<T>(path: &Path, why: &str, help: &str) -> Result<T> {
    let message = format!("cannot go on from {}: {why}", path.display());
    Err(Error::Arguments { message, help: Some(help.to_owned()) })
}

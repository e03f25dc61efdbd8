//! Checkpoints, from which stopped renders continue.

use std::fs;
use std::path::Path;
use std::time::SystemTime;

use serde::{Deserialize, Serialize};

use super::identity::{Identity, digest};
use crate::error::{Error, Result};
use crate::film::{BlockReader, Kind, Shard, write_blocks};
use crate::scene::{RenderText, Scene};
use crate::trace;

/// The first bytes of a checkpoint.
const MAGIC: Kind = *b"AbbeCkp4";

/// The result of resuming from a checkpoint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use = "nothing is read from a checkpoint with more samples"]
pub enum Resumed {
    /// The render continues from the checkpoint.
    Continues,
    /// All requested samples had already been taken.
    Finished,
    /// More samples had been taken than requested: this many per pixel. Nothing was read.
    HasMore(u32),
}

/// A file that a finished render has written, with its state at that time.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Written {
    name: String,
    length: u64,
    modified: SystemTime,
    /// How the file was written.
    way: String,
}

impl Written {
    /// Describes a file as it is now, written in a given way. Returns none if it does not exist.
    pub(super) fn from_file(path: &Path, way: &str) -> Option<Self> {
        let (name, found) = (path.file_name()?.to_string_lossy().into_owned(), fs::metadata(path).ok()?);
        Some(Self { name, length: found.len(), modified: found.modified().ok()?, way: way.to_owned() })
    }
}

/// What the checkpoint of a finished render stores besides its sums. Empty before the end.
#[derive(Default, Serialize, Deserialize)]
pub(super) struct Finished {
    /// A digest of the requested settings.
    settings_digest: String,
    written: Vec<Written>,
}

impl Finished {
    pub(super) fn new(render: &RenderText, written: Vec<Written>) -> Self {
        Self { settings_digest: digest(&format!("{render:?}")), written }
    }
}

/// Returns whether a file is the checkpoint of a finished render of a scene with all options applied, which has written
/// `files` in a certain `way`, and whether nobody has changed these since. Does not need a plan.
pub fn has_finished(
    path: impl AsRef<Path>,
    scene: &Scene,
    shard: Shard,
    files: &[impl AsRef<Path>],
    way: &str,
) -> bool {
    let read = || -> Result<bool> {
        let Some(mut blocks) = BlockReader::open(path.as_ref(), MAGIC)? else { return Ok(false) };
        if !blocks.block::<Identity>()?.is_of_scene(scene, shard) {
            return Ok(false);
        }
        let Finished { settings_digest, written } = blocks.block()?;
        let is_unchanged = |file: &Path| Written::from_file(file, way).is_some_and(|file| written.contains(&file));
        let has_same_settings = settings_digest == digest(&format!("{:?}", scene.render));
        Ok(has_same_settings && files.iter().all(|file| is_unchanged(file.as_ref())))
    };
    // Any error is reported when the render tries to continue from the checkpoint.
    read().unwrap_or(false)
}

/// Returns whether a file is a checkpoint. It may be damaged or belong to another render.
///
/// # Errors
/// If it cannot be read.
pub fn is_checkpoint(path: impl AsRef<Path>) -> Result<bool> {
    let path = path.as_ref();
    // Opening a pipe would block.
    Ok(path.is_file() && BlockReader::open(path, MAGIC)?.is_some())
}

/// Writes a checkpoint.
///
/// # Errors
/// If it cannot be written. An existing file is then untouched.
pub(super) fn save(path: &Path, identity: &Identity, finished: &Finished, passes: &trace::Rendering) -> Result<()> {
    write_blocks(path, MAGIC, &|blocks| {
        blocks.block(identity)?;
        blocks.block(finished)?;
        passes.save(blocks)
    })
}

/// Continues from a checkpoint. Also returns which files were written, if the render had finished.
///
/// # Errors
/// If it belongs to something else, is damaged, or cannot be read.
pub(super) fn resume(
    path: &Path,
    identity: &Identity,
    passes: &mut trace::Rendering,
) -> Result<(Resumed, Vec<Written>)> {
    let Some(mut blocks) = BlockReader::open(path, MAGIC)? else {
        return refuse(path, "it is not a checkpoint", "name another image, or move that file away");
    };
    let saved: Identity = blocks.block()?;
    if let Some(difference) = identity.difference(&saved) {
        return refuse(path, &difference, "delete it to start over, or name another image");
    }
    let Finished { written, .. } = blocks.block()?;
    let resumed = match passes.restore(blocks)? {
        trace::Restored::Continues if passes.is_finished() => Resumed::Finished,
        trace::Restored::Continues => Resumed::Continues,
        trace::Restored::HasMore(samples) => Resumed::HasMore(samples),
        trace::Restored::Refused(why, samples) => {
            return refuse(path, &why, &format!("ask for {samples} samples per pixel, or delete it to start over"));
        }
    };
    Ok((resumed, written))
}

fn refuse<T>(path: &Path, why: &str, help: &str) -> Result<T> {
    Error::refuse(format!("cannot go on from {}: {why}", path.display()), help)
}

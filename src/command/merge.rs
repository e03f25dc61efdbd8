//! The `merge` command: makes one image of the parts that several machines have rendered.

use std::path::{Path, PathBuf};

use abbe::{Error, Parts, Result, is_checkpoint};
use clap::Parser;

use super::error_text::problem;
use super::messages::{Listener, Protocol, print_written, set_listener, warn, warn_of_clamped};
use super::outputs::{Folders, check_not_input, has_extension};
use super::signals::exit_on_ctrl_c;

const EXAMPLES: &str = "\
Examples:
  render --shard 1/4 --exr scenes/prism.toml      make one of four parts: prism.1-of-4.part
  render merge prism.exr prism.*-of-4.part        combine all four
  render merge --delete prism.exr prism.*.part    keep only the image

The merged image is byte for byte that of a single render.

Exit codes: 0 done, 1 a file failed, 2 the parts do not belong together, or one is missing.";

/// Combine the parts of an image.
#[derive(Parser)]
#[command(name = "render merge", bin_name = "render merge", after_help = EXAMPLES)]
pub struct Query {
    /// The image to write
    #[arg(value_name = "OUT.exr")]
    image: PathBuf,

    /// All parts of it, in any order: files that --shard makes, not images of a --crop
    #[arg(required = true, value_name = "PART")]
    parts: Vec<PathBuf>,

    /// Delete the parts, and the checkpoints beside them, when the image is written
    #[arg(long)]
    delete: bool,

    /// Report on standard output, in the protocol of a render farm; everything else goes to its log
    #[arg(long, value_name = "PROTOCOL")]
    progress: Option<Protocol>,
}

/// Merges the parts, and writes the image.
///
/// # Errors
/// If parts are missing, do not belong together or are damaged, or the image cannot be written.
pub fn run(query: &Query) -> Result<()> {
    let Query { image: path, parts, delete, progress } = query;
    set_listener(match progress {
        Some(Protocol::Openjd) => Listener::Farm,
        None => Listener::Person,
    });
    if !has_extension(path, "exr") {
        let message = format!("merge writes a file that ends in .exr, not {}", path.display());
        return Error::refuse(message, "for instance: render merge out.exr *.part");
    }
    parts.iter().try_for_each(|part| check_not_input(part, "part", path))?;
    exit_on_ctrl_c()?;
    let image = Parts::open(parts)?;
    let _folders = Folders::of_files(&[path])?;
    warn_of_clamped(image.format(), image.write_exr(path)?);
    print_written(path);
    let path = path.with_extension("spectral.exr");
    if image.write_spectral_exr(&path)? {
        print_written(&path);
    }
    if *delete {
        // The image is already written, so a failure is only a warning.
        for error in parts.iter().filter_map(|part| delete_part(part).err()) {
            warn(&problem(&error));
        }
    }
    Ok(())
}

/// Deletes a part, and the checkpoint of its render if there is one. The checkpoint of a renamed part is not known.
fn delete_part(part: &Path) -> Result<()> {
    let checkpoint = part.with_extension("checkpoint");
    let has_its_name = part.file_stem().is_some_and(|stem| stem.to_string_lossy().contains("-of-"));
    let is_of_part = has_its_name && is_checkpoint(&checkpoint)?;
    for path in [Some(part), is_of_part.then_some(&*checkpoint)].into_iter().flatten() {
        std::fs::remove_file(path).map_err(|source| Error::Io { doing: "delete", path: path.to_owned(), source })?;
    }
    Ok(())
}

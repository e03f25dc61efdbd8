//! The `merge` command: one image of the parts that several machines made.

use std::path::PathBuf;

use abbe::Result;
use abbe::film::check_writable;
use clap::Parser;

use crate::messages::{say, warn_of_clamped};
use crate::outputs::{ends_in, refuse, spare};

const EXAMPLES: &str = "\
Examples:
  render --shard 1/4 --exr scenes/prism.toml      make one of four parts: prism.1-of-4.part
  render merge prism.exr prism.*-of-4.part        lay all four together

The merged image has the same bytes as one that a single render makes.";

/// Lay the parts of an image together.
#[derive(Parser)]
#[command(name = "render merge", after_help = EXAMPLES)]
pub struct Query {
    /// The image to write
    #[arg(value_name = "OUT.exr")]
    image: PathBuf,

    /// All parts of it, in any order
    #[arg(required = true, value_name = "PART")]
    parts: Vec<PathBuf>,
}

/// Writes the image.
///
/// # Errors
/// If parts are missing, do not belong together or are damaged, or the image cannot be written.
pub fn run(query: &Query) -> Result<()> {
    let Query { image: path, parts } = query;
    if !ends_in(path, "exr") {
        let message = format!("merge writes a file that ends in .exr, not {}", path.display());
        return refuse(&message, Some("for instance: render merge out.exr *.part"));
    }
    parts.iter().try_for_each(|part| spare(part, "part", path))?;
    check_writable(path)?;
    let image = abbe::merge(parts)?;
    warn_of_clamped(&image, image.write_exr(path)?);
    say(&format!("wrote {}", path.display()));
    if image.film().spectral.is_some() {
        let path = path.with_extension("spectral.exr");
        image.write_spectral_exr(&path)?;
        say(&format!("wrote {}", path.display()));
    }
    Ok(())
}

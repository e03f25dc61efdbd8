//! Settings that are given in addition to the scene.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Duration;

use crate::error::{Error, Result};
use crate::film::{Layer, MAX_NAME_BYTES, Overscan, Shard, Window, light_layer_name};
use crate::scene::{FilmSettings, ModelText, PolarizationText, RenderText, Scene};

/// Settings that replace the scene's own. By default they replace nothing.
///
/// ```
/// let quick = abbe::Options { samples: Some(4), ..abbe::Options::default() };
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// The number of camera samples per pixel, 1 or more. With an error or a time, this is the maximum. If an error or
    /// a time is given here, the scene's own number of samples is ignored.
    pub samples: Option<u32>,
    /// The relative error at which the image is good enough, 0.000001 to 1: the root mean square over all pixels and
    /// channels, divided by that of the image. It holds in 95 of 100 renders.
    pub error: Option<f64>,
    /// How long the render may take.
    pub time: Option<Duration>,
    /// The seed, which selects another set of random numbers.
    pub seed: Option<u64>,
    /// The pixels that are rendered around the format.
    pub overscan: Option<Overscan>,
    /// The part of the image and its overscan that is rendered, in pixels of the format.
    pub crop: Option<Window>,
    /// Layers that replace the scene's own.
    pub layers: Option<Vec<Layer>>,
    /// Whether to render spectra even if the scene does not request them.
    pub spectral: bool,
    /// The number of processor threads, 1 to [`MAX_THREADS`](Self::MAX_THREADS); one for each processor if absent.
    /// The image is the same for any number.
    pub threads: Option<usize>,
    /// The part of the image's tiles that is rendered.
    pub shard: Shard,
    /// The file of a plan to follow instead of making one. It must be a plan for this scene with the same options,
    /// except for threads, stamp and the number of the part. The image is the same. If an error or a time is requested,
    /// parts have another plan than the whole image.
    pub plan: Option<PathBuf>,
    /// Whether the file records when the image was made, on how many threads, and how long it took. No two files are
    /// then identical to the byte. Parts do not record it.
    pub stamp: bool,
}

impl Options {
    /// The maximum number of threads. Many more would exhaust a machine.
    pub const MAX_THREADS: u16 = 1024;

    /// Replaces the scene's settings with these.
    ///
    /// # Errors
    /// [`Error::Arguments`] if there are 0 samples, or no number of samples is given for a part of an image that would
    /// otherwise stop by its error or a time; if the error is not between 0.000001 and 1, the image has no pixels, the
    /// overscan is too wide, the crop lies outside the image and its overscan, or its layers cannot be written,
    /// together or in the scene's format.
    pub fn apply(&self, scene: &mut Scene) -> Result<()> {
        let (render, film) = self.merged_with(scene)?;
        (scene.render, scene.film) = (render, film);
        if let Some(layers) = &self.layers {
            scene.format.ask_for(layers);
        }
        if self.spectral {
            scene.format.spectral.get_or_insert_default();
        }
        check_layers(scene, self.shard)
    }

    /// Returns the render settings and the film that replace those of a scene. Programs may have changed these since
    /// the scene was compiled, so they are checked as well.
    pub(super) fn merged_with(&self, scene: &Scene) -> Result<(RenderText, FilmSettings)> {
        let own = &scene.render;
        let has_stop_rule = self.error.is_some() || self.time.is_some();
        let samples = self.samples.or(own.samples.filter(|_| !has_stop_rule));
        let seed = self.seed.unwrap_or(own.seed);
        let (error, time) = (self.error.or(own.error), self.time.or(own.time));
        let is_part = self.shard != Shard::WHOLE;
        let (overscan, crop) = (self.overscan.unwrap_or(scene.film.overscan), self.crop.or(scene.film.crop));
        let render = RenderText { samples, seed, error, time, is_part, ..own.clone() };
        let film = FilmSettings { overscan, crop, ..scene.film };
        check_render(&render)?;
        check_film(&film)?;
        Ok((render, film))
    }

    /// Returns the requested number of threads, or 0 for one per processor.
    pub(super) fn threads(&self) -> Result<usize> {
        let max = Self::MAX_THREADS;
        if self.threads.is_some_and(|threads| !(1..=usize::from(max)).contains(&threads)) {
            return Error::refuse(
                format!("a render has 1 to {max} threads"),
                "leave threads out to use all processors",
            );
        }
        Ok(self.threads.unwrap_or(0))
    }
}

fn check_render(render: &RenderText) -> Result<()> {
    if render.samples == Some(0) {
        return Error::refuse("a pixel needs at least 1 sample", "leave the samples out to take the scene's own");
    }
    if let Some(error) = render.error.filter(|error| !RenderText::ERRORS.contains(error)) {
        let message = format!("a relative error lies between 0.000001 and 1, not {error}");
        return Error::refuse(message, "--error 0.01 asks for one percent");
    }
    if render.is_part && render.samples.is_none() && (render.error.is_some() || render.time.is_some()) {
        let message = "a part of an image shows neither the error of the whole nor how many samples other \
                       parts take in a given time";
        return Error::refuse(message, "give the number of samples for all parts: --samples 512");
    }
    Ok(())
}

fn check_film(film: &FilmSettings) -> Result<()> {
    let FilmSettings { width, height, .. } = film;
    if *width == 0 || *height == 0 {
        let message = format!("an image has at least 1 pixel along each side, not {width} x {height}");
        return Error::refuse(message, "give the film of the scene a width and a height");
    }
    if let Some(message) = film.objection_to_overscan() {
        return Error::refuse(message, "--overscan takes one number of pixels, or four: left, top, right and bottom");
    }
    match film.objection_to_crop() {
        Some(message) => Error::refuse(message, "--crop takes first column, first row, width and height"),
        None => Ok(()),
    }
}

/// The maximum bytes of memory that layers may take: 64 GB.
const MAX_LAYER_BYTES: u64 = 64_000_000_000;

/// Refuses layers that would exhaust the memory, cannot be rendered or do not fit the format. Also refuses lights with
/// layer names that cannot be written.
pub(super) fn check_layers(scene: &Scene, shard: Shard) -> Result<()> {
    if let Some((message, help)) = scene.format.objection() {
        return Error::refuse(message, &help);
    }
    let bytes = scene.layer_bytes() / u64::from(shard.count());
    if bytes > MAX_LAYER_BYTES {
        let gigabytes = bytes / 1_000_000_000;
        let message = format!("{} channels of layers would take {gigabytes} GB of memory", scene.layer_channels());
        return Error::refuse(message, "ask for fewer layers, or render a part of the image at a time with --crop");
    }
    if scene.format.has_stokes() && scene.render.polarization == PolarizationText::Off {
        let message = "Stokes vectors are asked for, but the scene turns polarization off";
        return Error::refuse(
            message,
            "leave `polarization` out of its [render], or do not ask for S1, S2, S3 and polarization",
        );
    }
    if scene.format.spectral.is_some() && scene.render.model == ModelText::Rgb {
        let message = "model = \"rgb\" has no wavelengths to make spectra of";
        return Error::refuse(message, "leave the model out, or ask for wavelengths: model = { bands = 32 }");
    }
    if !scene.format.layers.contains(&Layer::Lights) {
        return Ok(());
    }
    let help = "give that light or object a `group` of at most 23 letters a to z, digits and _";
    let mut groups_by_name = BTreeMap::new();
    for group in &scene.light_groups {
        let name = light_layer_name(group);
        if name.len() + ".R".len() > MAX_NAME_BYTES {
            let message = format!("the name of the layer {name} is too long for some programs");
            return Error::refuse(message, help);
        }
        let other = groups_by_name.entry(name.clone()).or_insert(group);
        if *other != group {
            return Error::refuse(format!("the lights {other} and {group} would share the layer {name}"), help);
        }
    }
    Ok(())
}

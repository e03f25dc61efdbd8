//! What a render hands over.

use std::path::Path;

use super::image_error::ImageError;
use super::origin::SAMPLES;
use super::warnings::{few_samples, warnings};
use crate::error::Result;
use crate::film::{
    CameraView, Film, Format, Heading, Pixel, Provenance, SpectralImage, encode_exr, film_png, write_exr, write_png,
    write_spectral_exr,
};
use crate::trace::Report;

/// A rendered image, and all that is known of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    pub(super) film: Film,
    pub(super) report: Report,
    pub(super) error: Option<ImageError>,
    pub(super) because: Vec<String>,
    pub(super) view: CameraView,
    pub(super) format: Format,
    pub(super) provenance: Provenance,
    /// What is said of it if there is no light in it.
    pub(super) dark: Option<String>,
}

impl Image {
    /// Pixels per row of what was made: the format, with its overscan or a part of it.
    pub fn width(&self) -> u32 {
        self.film.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.film.height
    }

    /// Linear red, green and blue of all pixels in the film's color space, row by row from the top left.
    pub fn rgb(&self) -> Vec<[f32; 3]> {
        self.film.pixels.iter().map(|pixel| pixel.rgb).collect()
    }

    /// Linear red, green and blue of the pixel in column `x`, row `y`, counted from 0 at the top left of what was made.
    ///
    /// # Panics
    /// If there is no such pixel.
    pub fn rgb_at(&self, x: u32, y: u32) -> [f32; 3] {
        self.film.pixels[self.number(x, y)].rgb
    }

    /// The number of a pixel. A column that there is not would be one of the next row.
    fn number(&self, x: u32, y: u32) -> usize {
        assert!(x < self.width(), "there is no column {x} in an image of {} pixels per row", self.width());
        y as usize * self.film.width as usize + x as usize
    }

    /// All values of a layer by its name in the file, row by row from the top left; none if there is no such layer.
    ///
    /// | name | value |
    /// |---|---|
    /// | `R`, `G`, `B` | linear color |
    /// | `A` | share of the camera rays that met something, 0 to 1 |
    /// | `Z` | nearest depth in scene units, 1e10 where nothing is met |
    /// | `albedo.R`, `N.X`, .. | what was asked for beside them |
    pub fn layer(&self, name: &str) -> Option<Vec<f32>> {
        let value: fn(&Pixel) -> f32 = match name {
            "R" => |pixel| pixel.rgb[0],
            "G" => |pixel| pixel.rgb[1],
            "B" => |pixel| pixel.rgb[2],
            "A" => |pixel| pixel.alpha,
            "Z" => |pixel| pixel.depth,
            _ => return self.layer_beside(name),
        };
        Some(self.film.pixels.iter().map(value).collect())
    }

    /// A channel of a layer that was asked for.
    fn layer_beside(&self, name: &str) -> Option<Vec<f32>> {
        let (layer, channel) = name.rsplit_once('.')?;
        let image = self.film.layers.iter().find(|image| image.name == layer)?;
        let number = image.layer.channels().iter().position(|known| *known == channel)?;
        Some(image.channel(number).collect())
    }

    /// The pixels as they are, with what they mean.
    pub fn film(&self) -> &Film {
        &self.film
    }

    /// What rendering noticed: samples, rays, light that was left out.
    pub fn report(&self) -> &Report {
        &self.report
    }

    /// How far it is off, where a stop rule has it measured: in a render that stops by its error or by time.
    pub fn error(&self) -> Option<&ImageError> {
        self.error.as_ref()
    }

    /// What whoever sees it should know: light that is too rare, an error that is not reached, samples left out.
    pub fn warnings(&self) -> Vec<String> {
        let samples = self.provenance.count(SAMPLES);
        let few = samples.and_then(|samples| few_samples(&self.format.layers, samples));
        let is_dark = self.report.light == 0.0 && self.error.as_ref().is_none_or(|error| error.asked.is_none());
        let dark = self.dark.clone().filter(|_| is_dark);
        few.into_iter().chain(dark).chain(warnings(&self.report, self.error.as_ref())).collect()
    }

    /// How its file is written.
    pub fn format(&self) -> &Format {
        &self.format
    }

    /// How it was rendered and why, one decision a line; nothing of an image that was merged from parts.
    pub fn because(&self) -> &[String] {
        &self.because
    }

    /// What its files say of it.
    pub(super) fn heading(&self) -> Heading<'_> {
        Heading { film: &self.film, format: &self.format, view: &self.view, provenance: &self.provenance }
    }

    /// Writes a linear OpenEXR file with all layers, the camera, and everything that another run needs to make the same
    /// bytes. Returns how many values were too large for 16 bits, if it has those, and became 65504.
    ///
    /// # Errors
    /// If it cannot be written; a file that was there before is then untouched.
    pub fn write_exr(&self, path: impl AsRef<Path>) -> Result<u64> {
        write_exr(self.heading(), &mut &self.film, path.as_ref())
    }

    /// The bytes of that file, and how many values became 65504.
    ///
    /// # Errors
    /// If it cannot be encoded.
    pub fn exr_bytes(&self) -> Result<(Vec<u8>, u64)> {
        encode_exr(self.heading(), &mut &self.film, Path::new("the image"))
    }

    /// The spectrum of the pixel in column `x`, row `y`, counted from 0 at the top left; none if spectra were not asked
    /// for.
    ///
    /// Each band is its center in nm and its radiance per nm, the mean over the band, on the scale of the scene's
    /// `samples`: an even spectrum of 1 is 1 in all of them, and has luminance 1 in the image.
    ///
    /// # Panics
    /// If there is no such pixel.
    pub fn spectrum_at(&self, x: u32, y: u32) -> Option<Vec<[f64; 2]>> {
        Some(spectrum(self.film.spectral.as_ref()?, self.number(x, y), 0))
    }

    /// The spectra of S1, S2 and S3 of a pixel, as [`spectrum_at`](Self::spectrum_at) has that of S0; none if no Stokes
    /// vectors or no spectra were asked for.
    ///
    /// # Panics
    /// If there is no such pixel.
    pub fn stokes_spectra_at(&self, x: u32, y: u32) -> Option<[Vec<[f64; 2]>; 3]> {
        let spectral = self.film.spectral.as_ref().filter(|spectral| spectral.has_stokes)?;
        let pixel = self.number(x, y);
        Some([1, 2, 3].map(|component| spectrum(spectral, pixel, component)))
    }

    /// Writes the spectra of all pixels as an OpenEXR file, in the layout of Fichet, Pacanowski & Wilkie 2021; nothing
    /// if they were not asked for.
    ///
    /// # Errors
    /// As [`write_exr`](Self::write_exr).
    pub fn write_spectral_exr(&self, path: impl AsRef<Path>) -> Result<()> {
        write_spectral_exr(self.heading(), &mut &self.film, path.as_ref())
    }

    /// Writes an 8-bit sRGB picture for looking, brightened by 2^`exposure`.
    ///
    /// # Errors
    /// If it cannot be written; a file that was there before is then untouched.
    pub fn write_png(&self, path: impl AsRef<Path>, exposure: f64) -> Result<()> {
        write_png(&self.film, exposure, path.as_ref())
    }

    /// The bytes of that picture.
    ///
    /// # Errors
    /// If it cannot be encoded.
    pub fn png_bytes(&self, exposure: f64) -> Result<Vec<u8>> {
        film_png(&self.film, exposure, Path::new("the picture"))
    }
}

/// The center of each band in nm, and a Stokes component of a pixel there.
fn spectrum(spectral: &SpectralImage, pixel: usize, component: usize) -> Vec<[f64; 2]> {
    let values = spectral.component(pixel, component).iter();
    spectral.bands.centers_nm().zip(values).map(|(nm, &value)| [nm, value.into()]).collect()
}

//! The result of a render.

use std::path::Path;

use super::image_error::ImageError;
use super::provenance::SAMPLES;
use super::warnings::{few_samples, warnings};
use crate::error::Result;
use crate::film::{
    CameraView, Film, Format, Heading, Pixel, Provenance, SpectralImage, encode_exr, film_png, write_exr, write_png,
    write_spectral_exr,
};
use crate::trace::Report;

/// A rendered image, with all that is known about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    pub(super) film: Film,
    pub(super) report: Report,
    pub(super) error: Option<ImageError>,
    pub(super) because: Vec<String>,
    pub(super) view: CameraView,
    pub(super) format: Format,
    pub(super) provenance: Provenance,
    /// The warning to show if the image contains no light.
    pub(super) dark_warning: Option<String>,
}

impl Image {
    /// Returns the number of pixels per row that were rendered: those of the format, possibly with overscan or cropped.
    pub fn width(&self) -> u32 {
        self.film.width
    }

    /// Returns the number of rows.
    pub fn height(&self) -> u32 {
        self.film.height
    }

    /// Returns linear red, green and blue of all pixels in the film's color space, row by row from the top left.
    pub fn rgb(&self) -> Vec<[f32; 3]> {
        self.film.pixels.iter().map(|pixel| pixel.rgb).collect()
    }

    /// Returns linear red, green and blue of the pixel in column `x`, row `y`, counted from 0 at the top left of the
    /// rendered pixels.
    ///
    /// # Panics
    /// If there is no such pixel.
    pub fn rgb_at(&self, x: u32, y: u32) -> [f32; 3] {
        self.film.pixels[self.pixel_index(x, y)].rgb
    }

    /// Returns the index of a pixel. Without the check, a column beyond the last would be one of the next row.
    fn pixel_index(&self, x: u32, y: u32) -> usize {
        assert!(x < self.width(), "there is no column {x} in an image of {} pixels per row", self.width());
        y as usize * self.film.width as usize + x as usize
    }

    /// Returns a channel by its name in the file, row by row from the top left, or none if there is no such channel.
    ///
    /// | name | value |
    /// |---|---|
    /// | `R`, `G`, `B` | linear color |
    /// | `A` | fraction of the camera rays that hit something, 0 to 1 |
    /// | `Z` | smallest depth in scene units, 1e10 where nothing is hit |
    /// | `albedo.R`, `N.X`, .. | the requested layers |
    pub fn layer(&self, name: &str) -> Option<Vec<f32>> {
        let value: fn(&Pixel) -> f32 = match name {
            "R" => |pixel| pixel.rgb[0],
            "G" => |pixel| pixel.rgb[1],
            "B" => |pixel| pixel.rgb[2],
            "A" => |pixel| pixel.alpha,
            "Z" => |pixel| pixel.depth,
            _ => return self.requested_layer(name),
        };
        Some(self.film.pixels.iter().map(value).collect())
    }

    /// Returns a channel of a requested layer.
    fn requested_layer(&self, name: &str) -> Option<Vec<f32>> {
        let (layer, channel) = name.rsplit_once('.')?;
        let image = self.film.layers.iter().find(|image| image.name == layer)?;
        let number = image.layer.channels().iter().position(|known| *known == channel)?;
        Some(image.channel(number).collect())
    }

    /// Returns the film: the unchanged pixels and what they mean.
    pub fn film(&self) -> &Film {
        &self.film
    }

    /// Returns what the render noticed: samples, rays, light that was left out.
    pub fn report(&self) -> &Report {
        &self.report
    }

    /// Returns the error of the image, if it was measured: in a render that stops by its error or by time.
    pub fn error(&self) -> Option<&ImageError> {
        self.error.as_ref()
    }

    /// Returns warnings for viewers: light that is too rare, an error that is not reached, samples left out.
    pub fn warnings(&self) -> Vec<String> {
        let samples = self.provenance.count(SAMPLES);
        let few = samples.and_then(|samples| few_samples(&self.format.layers, samples));
        let is_dark = self.report.light == 0.0 && self.error.as_ref().is_none_or(|error| error.requested.is_none());
        let dark_warning = self.dark_warning.clone().filter(|_| is_dark);
        few.into_iter().chain(dark_warning).chain(warnings(&self.report, self.error.as_ref())).collect()
    }

    /// Returns the format of the image's file.
    pub fn format(&self) -> &Format {
        &self.format
    }

    /// Returns how the image was rendered and why, one decision per entry. Empty for an image merged from parts.
    pub fn because(&self) -> &[String] {
        &self.because
    }

    /// Returns what the image's files record besides its pixels.
    pub(super) fn heading(&self) -> Heading<'_> {
        Heading { film: &self.film, format: &self.format, view: &self.view, provenance: &self.provenance }
    }

    /// Writes a linear OpenEXR file with all layers, the camera, and everything that another run needs to reproduce the
    /// same bytes. Returns how many values exceeded the range of 16 bits, if the file uses them, and became 65504.
    ///
    /// # Errors
    /// If the file cannot be written. An existing file is then untouched.
    pub fn write_exr(&self, path: impl AsRef<Path>) -> Result<u64> {
        write_exr(self.heading(), &mut &self.film, path)
    }

    /// Encodes the file of [`write_exr`](Self::write_exr). Returns its bytes, and how many values became 65504.
    ///
    /// # Errors
    /// If the image cannot be encoded.
    pub fn exr_bytes(&self) -> Result<(Vec<u8>, u64)> {
        encode_exr(self.heading(), &mut &self.film, Path::new("the image"))
    }

    /// Returns the spectrum of the pixel in column `x`, row `y`, counted from 0 at the top left, or none if spectra
    /// were not requested.
    ///
    /// Each band is given by its center in nm and its radiance per nm, the mean over the band. The scale is that of the
    /// scene's `samples`: a uniform spectrum of 1 is 1 in all bands, and has luminance 1 in the image.
    ///
    /// # Panics
    /// If there is no such pixel.
    pub fn spectrum_at(&self, x: u32, y: u32) -> Option<Vec<[f64; 2]>> {
        Some(spectrum(self.film.spectral.as_ref()?, self.pixel_index(x, y), 0))
    }

    /// Returns the spectra of S1, S2 and S3 of a pixel, like [`spectrum_at`](Self::spectrum_at) returns that of S0.
    /// Returns none if Stokes vectors or spectra were not requested.
    ///
    /// # Panics
    /// If there is no such pixel.
    pub fn stokes_spectra_at(&self, x: u32, y: u32) -> Option<[Vec<[f64; 2]>; 3]> {
        let spectral = self.film.spectral.as_ref().filter(|spectral| spectral.has_stokes)?;
        let pixel = self.pixel_index(x, y);
        Some([1, 2, 3].map(|component| spectrum(spectral, pixel, component)))
    }

    /// Writes the spectra of all pixels as an OpenEXR file, in the layout of Fichet, Pacanowski & Wilkie 2021. Writes
    /// nothing if they were not requested.
    ///
    /// # Errors
    /// The errors of [`write_exr`](Self::write_exr).
    pub fn write_spectral_exr(&self, path: impl AsRef<Path>) -> Result<()> {
        write_spectral_exr(self.heading(), &mut &self.film, path)
    }

    /// Writes an 8-bit sRGB picture for viewing, brightened by 2^`exposure`.
    ///
    /// # Errors
    /// If the file cannot be written. An existing file is then untouched.
    pub fn write_png(&self, path: impl AsRef<Path>, exposure: f64) -> Result<()> {
        write_png(&self.film, exposure, path)
    }

    /// Encodes the picture that [`write_png`](Self::write_png) writes.
    ///
    /// # Errors
    /// If the picture cannot be encoded.
    pub fn png_bytes(&self, exposure: f64) -> Result<Vec<u8>> {
        film_png(&self.film, exposure, Path::new("the picture"))
    }
}

/// Returns the center of each band in nm, and the value of a pixel's Stokes component in it.
fn spectrum(spectral: &SpectralImage, pixel: usize, component: usize) -> Vec<[f64; 2]> {
    let values = spectral.component(pixel, component).iter();
    spectral.bands.centers_nm().zip(values).map(|(nm, &value)| [nm, value.into()]).collect()
}

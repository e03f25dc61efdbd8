//! Layers of many samples: sums of a tile's pixels, and the finished images.

use serde::{Deserialize, Serialize};

use super::coverage::Coverage;
use crate::film::{Layer, LayerImage, RANKS, Sample, SampleWeights, SpectralImage, polarization, stored};
use crate::trace::camera::SampleRow;
use crate::trace::contribution::add;
use crate::trace::layers::{CatcherLight, HALF_VALUES, Layers, STOKES_VALUES};
use crate::trace::replicates::REPLICATES;
use crate::trace::spectrum_sample::Spectrum;

/// Sums of the pixels of a tile.
#[derive(Default, Serialize, Deserialize)]
pub struct LayerSums {
    /// A row of numbers for each pixel, and another for samples that are subtracted, if there may be any. The latter
    /// only counts for light and for what is computed from samples.
    rows: [Vec<f64>; 2],
    /// The depth of the point that each pixel's position and uv belong to.
    depths: Vec<f64>,
    /// The objects of each pixel, if there are mattes.
    pub covered: Coverage,
}

impl LayerSums {
    /// Creates the sums of `pixels` pixels; `is_signed` tells whether some of their samples are subtracted.
    pub fn new(layers: &Layers, pixels: usize, is_signed: bool) -> Self {
        match layers.is_empty() {
            true => Self::default(),
            false => Self {
                rows: [pixels, if is_signed { pixels } else { 0 }].map(|rows| vec![0.0; rows * layers.row_len]),
                depths: vec![f64::INFINITY; pixels],
                covered: if layers.ids.is_empty() { Coverage::default() } else { Coverage::new(pixels) },
            },
        }
    }

    /// Whether it has as many numbers of each kind as another one.
    pub fn has_same_shape(&self, other: &Self) -> bool {
        let lengths = |sums: &Self| (sums.rows.each_ref().map(Vec::len), sums.depths.len(), sums.covered.pixels());
        lengths(self) == lengths(other)
    }

    /// Adds a sample of a pixel: its contribution to the image and to the layers. `early` samples are those of the
    /// first half. Each half is spread as evenly as all samples are, which every other sample would not be.
    pub fn add(&mut self, layers: &Layers, pixel: usize, early: bool, sample: &Sample, sample_row: &SampleRow) {
        let row = &mut self.rows[usize::from(sample.is_subtracted)][pixel * layers.row_len..][..layers.row_len];
        if let Some(object) = sample_row.object.filter(|_| !layers.ids.is_empty() && !sample.is_subtracted) {
            self.covered.add(pixel, object);
        }
        let sample_row = sample_row.row;
        layers.add_catcher(row, sample_row);
        let nearer = !sample.is_subtracted && sample.depth.is_some_and(|depth| depth < self.depths[pixel]);
        if let (true, Some(depth)) = (nearer, sample.depth) {
            self.depths[pixel] = depth;
        }
        for &layer in &layers.requested {
            let Some(offset) = layers.offset(layer) else { continue };
            match layer {
                Layer::Samples | Layer::Shadow => {}
                Layer::CryptoObject | Layer::CryptoMaterial | Layer::CryptoAsset => {}
                Layer::Variance => add(&mut row[offset..], sample.rgb.map(|x| x * x)),
                Layer::HalfA | Layer::HalfB => {
                    if early == (layer == Layer::HalfA) {
                        add(&mut row[offset..], sample.rgb);
                        row[offset + HALF_VALUES - 1] += 1.0;
                    }
                }
                Layer::Position | Layer::Uv => {
                    let size = layer.channels().len();
                    if nearer {
                        row[offset..offset + size].copy_from_slice(&sample_row[offset..offset + size]);
                    }
                }
                Layer::Lights | Layer::Polarization => {
                    let size = if layer == Layer::Lights { 3 * layers.groups.len() } else { STOKES_VALUES };
                    row[offset..offset + size]
                        .iter_mut()
                        .zip(&sample_row[offset..])
                        .for_each(|(sum, more)| *sum += more);
                }
                _ => add(&mut row[offset..], std::array::from_fn(|i| sample_row[offset + i])),
            }
        }
    }

    /// Returns the row of a pixel, and that of its samples that are subtracted, which may be empty.
    pub fn rows(&self, layers: &Layers, pixel: usize) -> [&[f64]; 2] {
        let range = pixel * layers.row_len..(pixel + 1) * layers.row_len;
        self.rows.each_ref().map(|rows| rows.get(range.clone()).unwrap_or_default())
    }

    /// Returns the row of a pixel, and that of its samples that are subtracted, to add to them.
    pub fn rows_mut(&mut self, layers: &Layers, pixel: usize) -> [&mut [f64]; 2] {
        let range = pixel * layers.row_len..(pixel + 1) * layers.row_len;
        self.rows.each_mut().map(|rows| rows.get_mut(range.clone()).unwrap_or_default())
    }

    /// Returns the sums of luminance that shadow catchers send to a pixel, if there are any.
    pub fn catcher_luminance(&self, layers: &Layers, pixel: usize) -> Option<CatcherLight<f64>> {
        let luminance =
            |row: &[f64]| layers.catcher_light(row, &[], 1.0).map(|caught| layers.catcher_luminance(&caught));
        layers.has_catchers().then(|| self.rows(layers, pixel)[0]).and_then(luminance)
    }
}

/// The weights of sums over photons in an image.
#[derive(Clone, Copy, Debug)]
pub struct SplatWeights {
    /// In all layers but the halves.
    pub image: f64,
    /// In the halves, relative to `image`: 1 each where as many samples have photons in both.
    pub halves: [f64; 2],
    /// For each replicate, the number of samples of each pixel that its photons stand for, if there are replicates.
    pub samples: Option<[f64; REPLICATES]>,
}

/// What is known of a pixel once its samples are taken.
pub struct PixelSums<'a> {
    /// Its row of sums, and that of samples that are subtracted.
    pub sums: [&'a [f64]; 2],
    /// The row of what photons contribute, which is no sum over samples; empty where they contribute nothing.
    pub splatted: &'a [f64],
    /// The weights of the photons relative to the samples.
    pub splat_weights: SplatWeights,
    /// The variance of the mean, if replicates measure it.
    pub variance: Option<[f64; 3]>,
    /// The sums of the samples that were kept, both added and subtracted, and their weights.
    pub rgb: [[f64; 3]; 2],
    pub weights: SampleWeights,
    /// The objects that the pixels of its tile show, and its index among these pixels.
    pub covered: &'a Coverage,
    pub place: usize,
}

/// Returns the images of the layers, as yet without values.
pub fn images(layers: &Layers) -> Vec<LayerImage> {
    let image = |layer: Layer, name: String| LayerImage { layer, name, values: Vec::new() };
    let images_of = |&layer: &Layer| match layer {
        Layer::Lights => layers.groups.iter().map(|name| image(layer, name.clone())).collect(),
        _ if layer.is_matte() => (0..RANKS / 2).map(|i| image(layer, format!("{}{i:02}", layer.name()))).collect(),
        _ => vec![image(layer, layer.name().to_owned())],
    };
    layers.requested.iter().flat_map(images_of).collect()
}

/// Returns the spectra, as yet without values, if requested.
pub fn spectral_image(layers: &Layers) -> Option<SpectralImage> {
    let spectrum = layers.spectrum.as_ref()?;
    Some(SpectralImage { bands: spectrum.bands, has_stokes: spectrum.has_stokes, values: Vec::new() })
}

impl PixelSums<'_> {
    /// Writes the pixel's values into its tile's values of each layer.
    pub fn write(&self, layers: &Layers, images: &mut [Vec<f32>]) {
        let mut images = images.iter_mut();
        for &layer in &layers.requested {
            if let Some((_, ids)) = layers.ids.iter().find(|(matte, _)| *matte == layer) {
                let ranks = self.covered.ranks(self.place, ids);
                for (two, image) in ranks.chunks_exact(2).zip(images.by_ref()) {
                    let coverage = |samples: u32| (f64::from(samples) / self.weights.added()) as f32;
                    let [(a, samples_a), (b, samples_b)] = [two[0], two[1]];
                    let values = [f32::from_bits(a), coverage(samples_a), f32::from_bits(b), coverage(samples_b)];
                    image[4 * self.place..4 * self.place + 4].copy_from_slice(&values);
                }
                continue;
            }
            let offset = layers.offset(layer).unwrap_or_default();
            let image_count = if layer == Layer::Lights { layers.groups.len() } else { 1 };
            for (number, image) in images.by_ref().take(image_count).enumerate() {
                let size = layer.channels().len();
                let values = &mut image[self.place * size..][..size];
                if layer == Layer::Shadow {
                    let caught = layers.catcher_light(self.sums[0], self.splatted, self.weights.added());
                    let shadow = caught.map_or([0.0; 3], |caught| caught.shadow());
                    values.copy_from_slice(&shadow.map(stored));
                    continue;
                }
                if layer == Layer::Polarization {
                    let stokes = std::array::from_fn(|component| self.light(offset + component));
                    values.copy_from_slice(&polarization(stokes).map(stored));
                    continue;
                }
                for (channel, value) in values.iter_mut().enumerate() {
                    let mean = self.value(layer, offset + 3 * number, channel);
                    *value =
                        stored(if layer == Layer::Albedo { mean.clamp(0.0, layers.film_white[channel]) } else { mean });
                }
            }
        }
    }

    /// Writes the pixel's spectrum into the spectra of its tile.
    pub fn write_spectrum(&self, spectrum: &Spectrum, spectra: &mut [f32]) {
        let numbers = spectrum.row_len();
        for (number, value) in spectra[self.place * numbers..][..numbers].iter_mut().enumerate() {
            *value = stored(spectrum.unit * self.light(spectrum.offset + number));
        }
    }

    /// Returns the sums of a number over samples that are added and subtracted, and what photons contribute to it.
    fn number(&self, offset: usize) -> ([f64; 2], f64) {
        let entry = |row: &[f64]| row.get(offset).copied().unwrap_or_default();
        (self.sums.map(entry), entry(self.splatted))
    }

    /// Returns the mean of a number that is light, including what photons contribute.
    fn light(&self, offset: usize) -> f64 {
        let (sums, splatted) = self.number(offset);
        self.weights.sum(sums) / self.weights.taken() + splatted
    }

    /// Returns the mean of a channel over a part of the samples, from the sums and numbers of those added and
    /// subtracted. It uses the part's own weights, but such that this mean and that of all other samples average to the
    /// mean of all.
    fn part_mean(&self, sums: [f64; 2], taken: [u32; 2], channel: usize) -> f64 {
        let (weights, all) = (&self.weights, self.rgb.map(|rgb| rgb[channel]));
        let [own, others] = [weights.of_part(taken), weights.of_others(taken)];
        if !weights.subtracts() {
            return own.sum(sums) / own.taken();
        }
        let rest = [0, 1].map(|i| all[i] - sums[i]);
        let difference = own.sum(sums) / own.taken() - others.sum(rest) / others.taken();
        weights.sum(all) / weights.taken() + difference * f64::from(others.kept()) / weights.taken()
    }

    fn value(&self, layer: Layer, offset: usize, channel: usize) -> f64 {
        let (sums, splatted) = self.number(offset + channel);
        let weights = &self.weights;
        match layer {
            Layer::Samples => weights.kept().into(),
            Layer::Position | Layer::Uv => sums[0],
            // Photons land independently, so the sum of their squares estimates the variance of their sum.
            Layer::Variance => self.variance.map_or_else(
                || {
                    weights.variance(self.rgb.map(|rgb| rgb[channel]), sums[0] + sums[1])
                        + self.splat_weights.image * splatted
                },
                |variance| variance[channel],
            ),
            Layer::HalfA | Layer::HalfB => {
                let (taken, _) = self.number(offset + HALF_VALUES - 1);
                let splat_weights = self.splat_weights.halves[usize::from(layer == Layer::HalfB)];
                self.part_mean(sums, taken.map(|count| count as u32), channel) + splat_weights * splatted
            }
            _ if layer.is_light() => self.light(offset + channel),
            _ => sums[0] / weights.added(),
        }
    }
}

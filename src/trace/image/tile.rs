//! Parts of an image that are rendered in parallel.

use serde::{Deserialize, Serialize};

use super::layer_sums::LayerSums;
use crate::film::{PassSum, Pixel, PixelSum, Sample, TilePlace};
use crate::math::Sampler;
use crate::scene::Scene;
use crate::spectrum::Curve;
use crate::trace::World;
use crate::trace::camera::{PathTracer, take_sample};
use crate::trace::layers::Layers;
use crate::trace::method::Method;
use crate::trace::pass::Pass;
use crate::trace::photon::PassLight;
use crate::trace::replicates::Replicates;
use crate::trace::stats::Stats;
use crate::trace::walk::Polarization;

#[derive(Serialize, Deserialize)]
pub struct Tile {
    /// Sums of its pixels, row by row.
    pub sums: Vec<PixelSum>,
    /// Sums of samples that are subtracted; empty where the filter is nowhere negative.
    pub subtracted: Vec<PixelSum>,
    pub layers: LayerSums,
    /// What photons contribute to its pixels.
    pub splatted: PhotonTile,
    /// What each replicate found, if there are several.
    pub replicates: Replicates,
    pub stats: Stats,
    pub first_non_finite: Option<[i64; 3]>,
    /// Passes that all its pixels have had, and the number of pixels that have had the next one.
    pub passes: u32,
    pub ahead: u32,
}

/// What photons contribute to a tile; empty without photons. Where every pass sends some, each counts by its samples.
#[derive(Clone, Default, Serialize, Deserialize)]
pub struct PhotonTile {
    /// Film values of its pixels.
    pub pixels: Vec<[f64; 3]>,
    /// A row for each pixel of what they contribute to the layers.
    pub layers: Vec<f64>,
    /// How much of their light polarization may change.
    pub polarization_change: f64,
}

/// Returns the bytes of memory that the film takes with a method, without layers: the sums of each pixel, those of its
/// replicates where a stop rule compares them, what photons contribute to it, and its finished values.
pub fn bytes_of_film(scene: &Scene<Curve>, method: &Method) -> u64 {
    let is_signed = scene.film.filter.is_signed();
    let (splats, catches) = (method.light_pass.is_some(), scene.has_shadow_catchers());
    let replicate_bytes = |_: &_| Replicates::bytes_of_pixel(is_signed, method.map().is_some(), catches, splats);
    let replicates = method.stop.as_ref().map_or(0, replicate_bytes);
    let sums = (1 + usize::from(is_signed)) * size_of::<PixelSum>();
    let splatted = if splats { size_of::<[f64; 3]>() } else { 0 };
    scene.film.window().pixels() * (sums + replicates + splatted + size_of::<Pixel>()) as u64
}

impl Tile {
    pub fn new(world: &World, place: TilePlace) -> Self {
        let is_signed = world.scene.film.filter.is_signed();
        let sums = vec![PixelSum::default(); place.pixels()];
        let subtracted = if is_signed { sums.clone() } else { Vec::new() };
        let layers = LayerSums::new(&world.layers, sums.len(), is_signed);
        let replicates = match world.method.stop {
            Some(_) => Replicates::new(sums.len(), is_signed, world.has_map(), world.layers.has_catchers()),
            None => Replicates::default(),
        };
        let (splatted, stats) = (PhotonTile::default(), Stats::default());
        Self { sums, subtracted, layers, splatted, replicates, stats, first_non_finite: None, passes: 0, ahead: 0 }
    }

    /// Whether it has as many sums of each kind as another tile of the same place.
    pub fn has_same_shape(&self, other: &Self, layers: &Layers) -> bool {
        let pixels = other.sums.len();
        let allowed_lengths = |whole: usize| [0, whole].into_iter();
        (self.sums.len(), self.subtracted.len()) == (pixels, other.subtracted.len())
            && self.layers.has_same_shape(&other.layers)
            && self.replicates.has_same_shape(&other.replicates)
            && allowed_lengths(pixels).any(|length| length == self.splatted.pixels.len())
            && allowed_lengths(pixels * layers.row_len).any(|length| length == self.splatted.layers.len())
            && (self.ahead as usize) < pixels
    }

    pub fn samples(&self) -> u64 {
        let kept = self.sums.iter().chain(&self.subtracted).map(|sum| u64::from(sum.kept())).sum::<u64>();
        kept + self.stats.non_finite
    }

    /// Takes the samples of a pass for all pixels that have not had them, until told to stop. Returns how many pixels
    /// got them.
    pub fn take<const N: usize, P: Polarization<N>>(
        &mut self,
        place: TilePlace,
        world: &World,
        light: &PassLight<N, P>,
        pass: &Pass,
        should_stop: &dyn Fn() -> bool,
    ) -> u32 {
        let window = world.scene.film.window();
        let mut tracer = PathTracer::<N, P>::new(world).with_photons(light.photons.as_ref()).with_layers();
        let first = self.ahead;
        while (self.ahead as usize) < self.sums.len() && !should_stop() {
            // Random numbers and rays belong to a pixel of the format, whatever part of it is rendered.
            let x = window.left + (place.corner[0] + self.ahead % place.width) as i32;
            let y = window.top + (place.corner[1] + self.ahead / place.width) as i32;
            self.sample_pixel(world, &mut tracer, light, [x, y], pass);
            self.ahead += 1;
        }
        let taken = self.ahead - first;
        if self.ahead as usize == self.sums.len() {
            (self.passes, self.ahead) = (self.passes + 1, 0);
        }
        taken
    }

    /// Takes samples of the next pixel, which is pixel (x, y) of the format.
    fn sample_pixel<'w, const N: usize, P: Polarization<N>>(
        &mut self,
        world: &World,
        tracer: &mut PathTracer<'w, N, P>,
        light: &'w PassLight<N, P>,
        pixel: [i32; 2],
        pass: &Pass,
    ) {
        let place = self.ahead as usize;
        // Sums of samples that are added, and of those that are subtracted.
        let mut sums = [PassSum::default(), PassSum::default()];
        let mut blurs = [PassSum::default(), PassSum::default()];
        let measures_blur = light.photons.as_ref().is_some_and(|photons| photons.half_blur.is_some());
        let rate = world.rate(pixel);
        let caught_before = pass.replicate.and_then(|_| self.layers.catcher_luminance(&world.layers, place));
        for number in rate.sample_numbers(&pass.numbers) {
            let average_number = rate.average_number(number);
            tracer.light_vertices = light.vertices(average_number - pass.numbers.start);
            let sampler = Sampler::of_pixel(pass.seed, pixel, number);
            let sample = take_sample(tracer, &sampler, pixel);
            let lobe = usize::from(sample.is_subtracted);
            if measures_blur {
                blurs[lobe].add(&Sample { rgb: tracer.blur(), ..sample });
            }
            if !sums[lobe].add(&sample) {
                self.stats.non_finite += 1;
                self.first_non_finite.get_or_insert([pixel[0].into(), pixel[1].into(), number.into()]);
            } else if let Some(layers) = tracer.layers() {
                let is_first_half =
                    pass.is_in_first_half().unwrap_or(average_number < world.method.samples.div_ceil(2));
                layers.keep_spectrum(sample.is_subtracted);
                self.layers.add(&world.layers, place, is_first_half, &sample, &layers.sample_row());
            }
        }
        if let Some(layers) = tracer.layers() {
            layers.add_spectra_to(self.layers.rows_mut(&world.layers, place));
        }
        if let Some(replicate) = pass.replicate {
            self.replicates.add(place, replicate, sums.each_ref(), blurs.each_ref());
            let caught = self.layers.catcher_luminance(&world.layers, place);
            if let (Some(after), Some(before)) = (caught, caught_before) {
                self.replicates.add_alpha(place, replicate, sums.each_ref(), after.minus(before));
            }
        }
        let [added, subtracted] = sums;
        self.sums[place].add(added);
        if let Some(sum) = self.subtracted.get_mut(place) {
            sum.add(subtracted);
        }
        // Add statistics pixel by pixel, so that a stop between two pixels does not change the order of sums.
        self.stats += std::mem::take(&mut tracer.walker.stats).of_pixel(rate);
    }
}

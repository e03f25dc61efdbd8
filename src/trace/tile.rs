//! Parts of an image that are made side by side.

use std::ops::Range;

use super::World;
use super::layer_sums::LayerSums;
use super::layers::Layers;
use super::light_vertices::{LightVertices, SHARED};
use super::path_tracer::PathTracer;
use super::photon_map::PhotonMap;
use super::stats::Stats;
use crate::film::{PassSum, PixelSum, Window};
use crate::math::Sampler;
use crate::scene::FilmSettings;

/// Side of a tile in pixels.
pub(super) const TILE: u32 = 16;

/// A small part of the image.
pub(super) struct Tile {
    /// Its first column and row in the window.
    corner: [u32; 2],
    pub(super) width: u32,
    pub(super) height: u32,
    /// Sums of its pixels, row by row.
    pub(super) sums: Vec<PixelSum>,
    /// The same of samples that are subtracted; empty where the filter is nowhere negative.
    pub(super) subtracted: Vec<PixelSum>,
    /// Sums of their layers.
    pub(super) layers: LayerSums,
    pub(super) stats: Stats,
    pub(super) first_non_finite: Option<[i64; 3]>,
}

impl Tile {
    pub(super) fn new(film: &FilmSettings, corner: [u32; 2], layers: &Layers) -> Self {
        let (window, is_signed) = (film.window(), film.filter.is_signed());
        let [width, height] = [window.width - corner[0], window.height - corner[1]].map(|left| left.min(TILE));
        let sums = vec![PixelSum::default(); width as usize * height as usize];
        let subtracted = if is_signed { sums.clone() } else { Vec::new() };
        let layers = LayerSums::new(layers, sums.len(), is_signed);
        Self { corner, width, height, sums, subtracted, layers, stats: Stats::default(), first_non_finite: None }
    }

    /// The number of one of its pixels in the window.
    pub(super) fn number(&self, window: Window, place: u32) -> usize {
        let [x, y] = [self.corner[0] + place % self.width, self.corner[1] + place / self.width];
        y as usize * window.width as usize + x as usize
    }

    /// Takes samples of all pixels.
    pub(super) fn take<const N: usize>(
        &mut self,
        world: &World,
        photons: Option<&PhotonMap<N>>,
        light_vertices: &[LightVertices<N>],
        numbers: Range<u32>,
    ) {
        let window = world.scene.film.window();
        let mut tracer = PathTracer::<N>::new(world).with_photons(photons).with_layers();
        for (place, sum) in (0..).zip(&mut self.sums) {
            // Random numbers and rays belong to the format's pixel, whatever part of it is made.
            let x = window.left + (self.corner[0] + place % self.width) as i32;
            let y = window.top + (self.corner[1] + place / self.width) as i32;
            let [mut pass, mut subtracted] = [PassSum::default(), PassSum::default()];
            for number in numbers.clone() {
                tracer.light_vertices = light_vertices.get(((number - numbers.start) / SHARED) as usize);
                let sampler = Sampler::of_pixel(world.method.seed, [x, y], number);
                let sample = tracer.sample(&sampler, [x, y]);
                let lobe = if sample.is_subtracted { &mut subtracted } else { &mut pass };
                if !lobe.add(&sample) {
                    self.stats.non_finite += 1;
                    self.first_non_finite.get_or_insert([x.into(), y.into(), number.into()]);
                } else if let Some(layers) = tracer.layers() {
                    let early = number < world.method.samples.div_ceil(2);
                    layers.keep(sample.is_subtracted);
                    self.layers.add(&world.layers, place as usize, early, &sample, &layers.left());
                }
            }
            if let Some(layers) = tracer.layers() {
                layers.hand_over(self.layers.rows_mut(&world.layers, place as usize));
            }
            sum.add(pass);
            if let Some(sum) = self.subtracted.get_mut(place as usize) {
                sum.add(subtracted);
            }
        }
        self.stats += tracer.walker.stats;
    }
}

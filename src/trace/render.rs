//! An image in the making: pass after pass over its tiles.

use std::borrow::Borrow;

use rayon::prelude::*;

use super::World;
use super::layer_sums::{Taken, images, spectral_image, write};
use super::light_pass::{self, CausticImage};
use super::light_vertices::{LightPaths, LightVertices, SHARED};
use super::photon_map;
use super::photon_targets::PhotonTargets;
use super::stats::Stats;
use super::tile::{TILE, Tile};
use super::width::in_lanes;
use crate::film::{Film, Pixel, PixelSum, SampleWeights};

/// Samples of each pixel in the first pass, where no photons are gathered; every other pass takes as many as were taken
/// before.
const FIRST_PASS: u32 = 16;

/// Samples of each pixel in the largest pass with light vertices, all of which are in memory at once.
const MOST_AT_ONCE: u32 = 64;

/// What rendering noticed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Camera samples taken.
    pub samples: u64,
    /// Rays followed, without those to lights.
    pub rays: u64,
    /// Samples left out because they were not finite.
    pub non_finite: u64,
    /// Column, row and number of the first of them.
    pub first_non_finite: Option<[i64; 3]>,
    /// Mean weight per camera sample of the branches that deterministic transport dropped.
    pub dropped: f64,
    /// Mean weight per camera sample of paths stopped because they would not end.
    pub stopped: f64,
    /// Surfaces of clear bodies that were left without having been entered: open meshes.
    pub unmatched: u64,
    /// Camera samples of deterministic transport that met so many surfaces that they went on by chance.
    pub by_chance: u64,
    /// Most of the light seen, as a share, that polarization, which is not traced, may change.
    pub polarization: f64,
    /// The same in the tile of 16 x 16 pixels where it is largest.
    pub polarization_of_tile: f64,
    /// All light that camera rays and photons found, as X + Y + Z of every camera sample.
    pub light: f64,
    /// Photons sent by the light pass.
    pub photons: u64,
}

/// Renders the world's image, or the part of it that is asked for. `progress` is told how many camera samples and
/// photons are done, from any thread; in the end they are [`work`].
pub fn render(world: &World, progress: &(dyn Fn(u64) + Sync)) -> (Film, Report) {
    let mut rendering = Rendering::new(world);
    while rendering.advance(progress) {}
    (rendering.film(), rendering.report())
}

/// How many camera samples and photons an image takes.
pub fn work(world: &World) -> u64 {
    let window = world.scene.film.window();
    let samples = window.pixels() * u64::from(world.method.samples);
    let passes = world.method.light_pass.as_ref().and_then(|pass| pass.map).map_or(0, |map| u64::from(map.count));
    let photons = |targets: &Option<PhotonTargets>| targets.as_ref().map_or(0, PhotonTargets::photons);
    samples + photons(&world.photon_targets) + passes * photons(&world.map_targets)
}

/// An image in the making. It advances pass by pass, can be looked at after each, and is finished after the last.
///
/// A pass takes the next samples of all pixels; where photons are gathered, each pass sends its own before. The light
/// pass comes before the first.
pub struct Rendering<W> {
    world: W,
    tiles: Vec<Tile>,
    shown: Option<CausticImage>,
    /// Of the photons that were gathered.
    gathered: Stats,
    photons: u64,
    /// Camera samples of each pixel so far, and passes.
    samples: u32,
    passes: u32,
}

impl<W: Borrow<World>> Rendering<W> {
    /// An image without samples yet.
    pub fn new(world: W) -> Self {
        let (film, layers) = (&world.borrow().scene.film, &world.borrow().layers);
        let window = film.window();
        let corners = (0..window.height)
            .step_by(TILE as usize)
            .flat_map(|y| (0..window.width).step_by(TILE as usize).map(move |x| [x, y]));
        let tiles = corners.map(|corner| Tile::new(film, corner, layers)).collect();
        Self { world, tiles, shown: None, gathered: Stats::default(), photons: 0, samples: 0, passes: 0 }
    }

    /// What is rendered, and how.
    pub fn world(&self) -> &World {
        self.world.borrow()
    }

    /// Camera samples of each pixel that have been taken.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Makes the next pass, if there is one, and answers whether another one is left. `progress` is told how many
    /// camera samples and photons were done since it was last told, from any thread.
    pub fn advance(&mut self, progress: &(dyn Fn(u64) + Sync)) -> bool {
        if self.samples < self.world().method.samples {
            in_lanes!(self.world().method.basis, N => self.pass::<N>(progress));
        }
        self.samples < self.world().method.samples
    }

    /// The image of the samples so far.
    pub fn film(&self) -> Film {
        let settings = self.world().scene.film;
        let window = settings.window();
        let mut pixels = vec![BLANK; window.pixels() as usize];
        let layers = &self.world().layers;
        let luminance = settings.color_space.to_xyz()[1];
        let (mut images, none) = (images(layers, pixels.len()), PixelSum::default());
        let mut spectral = spectral_image(layers, pixels.len());
        for tile in &self.tiles {
            for (place, sum) in (0..).zip(&tile.sums) {
                let number = tile.number(window, place);
                let place = place as usize;
                let subtracted = tile.subtracted.get(place).unwrap_or(&none);
                let weights = SampleWeights::new(settings.filter, [sum.kept(), subtracted.kept()]);
                pixels[number] = sum.pixel(subtracted, &weights, self.shown_at(number));
                if !layers.is_empty() {
                    let (sums, shown) = (tile.layers.rows(layers, place), self.shown_in_layers(number));
                    let (covered, rgb) = (tile.layers.covered(), [sum.rgb(), subtracted.rgb()]);
                    let taken = Taken { sums, shown, rgb, weights, covered, place };
                    write(layers, &taken, number, &mut images);
                    if let (Some(image), Some(spectrum)) = (&mut spectral, &layers.spectrum) {
                        taken.write_spectrum(spectrum, number, image);
                    }
                    if let Some(caught) = layers.caught(sums[0], shown, weights.added()) {
                        let alpha = f64::from(pixels[number].alpha) + caught.coverage(luminance);
                        pixels[number].alpha = alpha.min(1.0) as f32;
                    }
                }
            }
        }
        Film {
            width: window.width,
            height: window.height,
            corner: [window.left, window.top],
            full: [settings.width, settings.height],
            color_space: settings.color_space,
            pixels,
            layers: images,
            spectral,
            manifests: layers.manifests(&self.world().scene),
        }
    }

    /// What was noticed so far.
    pub fn report(&self) -> Report {
        let window = self.world().scene.film.window();
        let (mut all, mut first_non_finite, mut polarization_of_tile) = (self.gathered, None, 0.0_f64);
        all += self.shown.as_ref().map_or(Stats::default(), |shown| shown.stats);
        for (number, tile) in self.tiles.iter().enumerate() {
            let stats = self.stats_of(tile, number);
            if stats.light > 0.0 {
                polarization_of_tile = polarization_of_tile.max(stats.polarization / stats.light);
            }
            first_non_finite = first_non_finite.or(tile.first_non_finite);
            all += stats;
        }
        let samples = window.pixels() * u64::from(self.samples);
        let per_sample = |sum: f64| sum / samples.max(1) as f64;
        Report {
            samples,
            rays: all.rays,
            non_finite: all.non_finite,
            first_non_finite,
            dropped: per_sample(all.dropped),
            stopped: per_sample(all.stopped),
            unmatched: all.unmatched,
            by_chance: all.by_chance,
            polarization: if all.light > 0.0 { all.polarization / all.light } else { 0.0 },
            polarization_of_tile,
            light: all.light,
            photons: self.photons,
        }
    }

    /// What was noticed in a tile, with the light that photons show there.
    fn stats_of(&self, tile: &Tile, number: usize) -> Stats {
        let window = self.world().scene.film.window();
        let mut stats = tile.stats;
        if let Some(shown) = &self.shown {
            let samples = f64::from(self.samples);
            stats.polarization += samples * shown.moved.get(number).copied().unwrap_or_default();
            let light = |place| self.world().amount(self.shown_at(tile.number(window, place)));
            stats.light += samples * (0..tile.width * tile.height).map(light).sum::<f64>();
        }
        stats
    }

    /// What photons show in a pixel of the window.
    fn shown_at(&self, pixel: usize) -> [f64; 3] {
        self.shown.as_ref().and_then(|shown| shown.pixels.get(pixel)).copied().unwrap_or_default()
    }

    /// What photons show in the layers of a pixel of the window.
    fn shown_in_layers(&self, pixel: usize) -> &[f64] {
        let numbers = self.world().layers.numbers;
        self.shown
            .as_ref()
            .and_then(|shown| shown.layers.get(pixel * numbers..(pixel + 1) * numbers))
            .unwrap_or_default()
    }

    fn pass<const N: usize>(&mut self, progress: &(dyn Fn(u64) + Sync)) {
        let world = self.world.borrow();
        if self.shown.is_none() {
            let shown = light_pass::show::<N>(world, progress);
            self.photons += shown.photons;
            self.shown = Some(shown);
        }
        let all = world.method.samples;
        let map = world.method.light_pass.as_ref().and_then(|pass| pass.map).filter(|_| world.has_map());
        let end = match map {
            Some(map) => (u64::from(self.passes + 1) * u64::from(all) / u64::from(map.count)) as u32,
            None if world.method.light_vertices => {
                (self.samples + self.samples.clamp(FIRST_PASS, MOST_AT_ONCE)).min(all)
            }
            None => (2 * self.samples).max(FIRST_PASS).min(all),
        };
        let photons = photon_map::photons::<N>(world, self.passes);
        if let Some(photons) = &photons {
            self.photons += photons.sent;
            self.gathered += photons.stats;
            progress(photons.sent);
        }
        let numbers = self.samples..end;
        let light_vertices: Vec<LightVertices<N>> = match LightPaths::asked_for(world) {
            Some(light_paths) => {
                let shared = |first: u32| light_paths.shared(first..(first + SHARED).min(end));
                numbers.clone().step_by(SHARED as usize).map(shared).collect()
            }
            None => Vec::new(),
        };
        light_vertices.iter().for_each(|set| self.gathered += set.stats);
        self.tiles.par_iter_mut().for_each(|tile| {
            tile.take::<N>(world, photons.as_ref(), &light_vertices, numbers.clone());
            progress(u64::from(tile.width * tile.height) * numbers.len() as u64);
        });
        (self.samples, self.passes) = (end, self.passes + 1);
    }
}

const BLANK: Pixel = Pixel { rgb: [0.0; 3], alpha: 0.0, depth: 0.0, samples: 0.0 };

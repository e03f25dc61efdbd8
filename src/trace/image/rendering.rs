//! A render in progress: pass after pass over its tiles.

use std::any::Any;
use std::borrow::Cow;
use std::fmt;
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::layer_sums::{images, spectral_image};
use super::light_pass::{self, Callbacks};
use super::noise::{Estimate, Measured, Noise, measure};
use super::passes::Progress;
use super::rare_light::{RareLight, rare_light};
use super::saved::{self, Restored};
use super::stopping::{Clock, FIRST_LOOK, Stopped, can_estimate_samples, estimate_samples, next_stage};
use super::tile::Tile;
use super::values::values_of;
use crate::error::Result;
use crate::film::{BlockReader, BlockWriter, Film, Shard, TilePlace, TileValues, Window};
use crate::trace::parallel::{for_each_in_parallel, in_parallel};
use crate::trace::photon::PassLight;
use crate::trace::photon_targets::PhotonTargets;
use crate::trace::replicates::REPLICATES;
use crate::trace::stats::Stats;
use crate::trace::walk::Polarization;
use crate::trace::width::in_lanes_of_layers;
use crate::trace::{World, media};

/// Tiles whose values are computed before they are put into the image.
const TILES_AT_A_TIME: usize = 256;

/// What rendering noticed. Fields that only messages use are not serialized.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Report {
    /// Camera samples taken.
    pub samples: u64,
    /// Rays traced, without shadow rays.
    pub rays: u64,
    /// Samples left out because they were not finite.
    pub non_finite: u64,
    /// Column, row and sample number of the first of them.
    #[serde(skip)]
    pub first_non_finite: Option<[i64; 3]>,
    /// Mean weight per camera sample of the branches that deterministic transport dropped.
    pub dropped: f64,
    /// Mean weight per camera sample of paths that limits of bounces cut, or that would not end.
    pub stopped: f64,
    /// Surfaces of clear bodies that were left without having been entered: open meshes.
    pub unmatched: u64,
    /// Whether there are more clear materials than may overlap in one place.
    #[serde(skip)]
    pub has_many_media: bool,
    /// Camera samples of deterministic transport that hit so many surfaces that they continued by chance.
    pub by_chance: u64,
    /// Largest share of the visible light that polarization, which is not traced, may change.
    pub polarization: f64,
    /// Largest share of the light that polarization may change in a tile of 16 x 16 pixels.
    pub polarization_of_tile: f64,
    /// All light that camera rays and photons found, as X + Y + Z of every camera sample.
    #[serde(skip)]
    pub light: f64,
    /// Photons sent by the light pass and for maps.
    pub photons: u64,
    /// The random error of the image, if a stop rule measures it.
    #[serde(skip)]
    pub noise: Option<Noise>,
    /// How much gathered photons blur it, if a stop rule measures it.
    #[serde(skip)]
    pub blur: Option<Estimate>,
    /// What ended the render, if a stop rule could and it is finished.
    pub stopped_by: Option<Stopped>,
}

/// Renders the world's image, or the requested part of it. Calls `progress` with the work done since the last call,
/// from any thread; all of it adds up to [`Rendering::work`].
pub fn render(world: &World, progress: &(dyn Fn(u64) + Sync)) -> (Film, Report) {
    let mut rendering = Rendering::of_shard(Cow::Borrowed(world), Shard::WHOLE);
    while rendering.advance(progress) {}
    (rendering.film(), rendering.report())
}

/// How far a render in progress has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Advance {
    /// All samples are taken.
    Finished,
    /// A pass is finished, and another one is left.
    Passed,
    /// It stopped within a pass, as requested.
    Stopped,
}

/// How many camera samples a photon counts as in the progress: as many as take the same time, and at least one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PhotonCost {
    /// For a photon of the light pass.
    pub splatted: u64,
    /// For a photon of a map.
    pub stored: u64,
}

impl Default for PhotonCost {
    fn default() -> Self {
        Self { splatted: 1, stored: 1 }
    }
}

/// A render in progress. It advances pass by pass, can be looked at after each, and is finished after the last.
///
/// A pass takes the next samples of all pixels; where photons are gathered, each pass first sends its own. The light
/// pass comes before the first. A render may stop anywhere between two pixels, be saved there, and continue.
pub struct Rendering<'a> {
    world: Cow<'a, World>,
    shard: Shard,
    tiles: Vec<Tile>,
    progress: Progress,
    /// The photons and light vertices of the pass that was stopped.
    light: Option<Box<dyn Any + Send + Sync>>,
    /// How fast it is, if there is a stop rule.
    clock: Clock,
    /// How much work photons count as.
    photon_cost: PhotonCost,
}

impl fmt::Debug for Rendering<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        let mut shown = formatter.debug_struct("Rendering");
        shown.field("shard", &self.shard).field("samples", &self.samples()).field("work", &self.work());
        shown.field("done", &self.done()).finish_non_exhaustive()
    }
}

impl<'a> Rendering<'a> {
    /// Creates a render without samples, or one of several parts of it, where all other pixels stay blank.
    pub fn of_shard(world: Cow<'a, World>, shard: Shard) -> Self {
        let window = world.scene.film.window();
        let tiles = shard.tiles(window).map(|place| Tile::new(&world, place)).collect();
        let (progress, clock) = (Progress::default(), Clock::new(Instant::now()));
        Self { world, shard, tiles, progress, light: None, clock, photon_cost: PhotonCost::default() }
    }

    /// Starts the time of a stop rule at another moment.
    #[must_use]
    pub fn since(self, began: Instant) -> Self {
        Self { clock: Clock::new(began), ..self }
    }

    /// Counts photons as a number of camera samples in its [work](Self::work).
    #[must_use]
    pub fn counting_photons_as(self, photon_cost: PhotonCost) -> Self {
        Self { photon_cost, ..self }
    }

    /// Returns what is rendered, and how.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// Returns the camera samples of each pixel that have been taken.
    pub fn samples(&self) -> u32 {
        self.progress.samples
    }

    /// Whether all samples are taken, or enough of them.
    pub fn is_finished(&self) -> bool {
        match &self.world().method.stop {
            None => self.samples() >= self.world().method.samples,
            Some(stop) => self.progress.stage.size == 0 && next_stage(stop, &self.progress, &self.clock) == 0,
        }
    }

    /// Returns the work of the method's samples in all parts of the image, by one render.
    pub fn work_of_all_parts(&self) -> u64 {
        self.work_of(self.world().scene.film.window().pixels())
    }

    /// Returns the work of the method's samples of `pixels` pixels, and of all photons.
    fn work_of(&self, pixels: u64) -> u64 {
        let world = self.world();
        let samples = pixels * u64::from(world.method.samples);
        let passes = world.method.map().map_or(0, |map| u64::from(map.count));
        let photons = |targets: &Option<PhotonTargets>| targets.as_ref().map_or(0, PhotonTargets::photons);
        let PhotonCost { splatted, stored } = self.photon_cost;
        samples + splatted * photons(&world.photon_targets) + stored * passes * photons(&world.map_targets)
    }

    /// Returns the work of the image in camera samples, where photons count as those that take as long. With a stop
    /// rule, this is an estimate that improves with each pass. As long as nothing [is known](Self::is_work_known), it
    /// is the most that the image may take.
    pub fn work(&self) -> u64 {
        let (world, all) = (self.world(), self.work_of(self.pixels()));
        match &world.method.stop {
            None => all,
            Some(_) if self.is_finished() => self.done(),
            Some(stop) => {
                let wanted = estimate_samples(stop, &self.progress, &self.clock);
                let work = all as f64 * f64::from(wanted) / f64::from(world.method.samples);
                self.done().max(work as u64)
            }
        }
    }

    /// Whether the work is known, at least roughly.
    pub fn is_work_known(&self) -> bool {
        let stop = self.world().method.stop.as_ref();
        self.is_finished() || stop.is_none_or(|stop| can_estimate_samples(stop, &self.progress))
    }

    /// Returns how much of the work is done.
    pub fn done(&self) -> u64 {
        let PhotonCost { splatted, stored } = self.photon_cost;
        self.samples_taken() + splatted * self.progress.sending.photons + stored * self.progress.gathered_photons
    }

    /// Makes the next pass, if there is one, and returns whether another one is left. Calls `progress` with the
    /// [work](Self::work) done since the last call, from any thread.
    pub fn advance(&mut self, progress: &(dyn Fn(u64) + Sync)) -> bool {
        self.advance_until(progress, &|| false) == Advance::Passed
    }

    /// Makes the next pass, but stops once `should_stop`, called before every pixel and from any thread, returns true.
    pub fn advance_until(
        &mut self,
        progress: &(dyn Fn(u64) + Sync),
        should_stop: &(dyn Fn() -> bool + Sync),
    ) -> Advance {
        let stopped = AtomicBool::new(false);
        let latched_stop = || {
            let is_stopped = stopped.load(Ordering::Relaxed) || should_stop();
            stopped.fetch_or(is_stopped, Ordering::Relaxed) || is_stopped
        };
        let callbacks = Callbacks { progress, should_stop: &latched_stop };
        if !self.begin_pass() {
            return Advance::Finished;
        }
        if !in_lanes_of_layers!(self.world(), N, P => self.pass::<N, P>(&callbacks)) {
            return Advance::Stopped;
        }
        if self.is_finished() { Advance::Finished } else { Advance::Passed }
    }

    /// Whether there is a next pass. Decides how many samples the replicates take, if that is not yet decided.
    fn begin_pass(&mut self) -> bool {
        if let (Some(stop), 0) = (&self.world().method.stop, self.progress.stage.size) {
            self.progress.stage.size = next_stage(stop, &self.progress, &self.clock);
            self.clock.begin(self.samples());
            return self.progress.stage.size > 0;
        }
        self.world().method.stop.is_some() || !self.is_finished()
    }

    /// Measures the replicates, if they have the same number of samples each.
    fn look(&mut self) {
        let (stage, film) = (self.progress.stage, self.world().scene.film);
        if stage.size == 0 && stage.before > 0 && self.world().method.stop.is_some() {
            let window = film.window();
            let tiles = self.places().map(|(tile, place)| (&tile.replicates, place));
            self.progress.measured = Some(measure(tiles, [window.left, window.top], film.filter, stage.before));
        }
    }

    /// Returns the image of the samples so far.
    pub fn film(&self) -> Film {
        let (mut film, splat_weights) = (self.frame(), self.progress.splat_weights(self.world()));
        film.resize(film.height);
        let places: Vec<(&Tile, TilePlace)> = self.places().collect();
        for some in places.chunks(TILES_AT_A_TIME) {
            let tile_values =
                in_parallel(some.len(), &|number| values_of(self.world(), &film, some[number].0, splat_weights));
            tile_values.iter().zip(some).for_each(|(values, (_, place))| values.put_into(&mut film, *place));
        }
        film
    }

    /// Returns the film without its values.
    pub fn frame(&self) -> Film {
        let World { scene, layers, .. } = self.world();
        let Window { left, top, width, height } = scene.film.window();
        Film {
            width,
            height,
            corner: [left, top],
            full: [scene.film.width, scene.film.height],
            color_space: scene.film.color_space,
            pixels: Vec::new(),
            layers: images(layers),
            spectral: spectral_image(layers),
            manifests: layers.manifests(scene),
        }
    }

    /// Returns the values of each tile that is rendered.
    pub fn tiles(&self) -> impl Iterator<Item = TileValues> {
        let (frame, splat_weights) = (self.frame(), self.progress.splat_weights(self.world()));
        self.places().map(move |(tile, _)| values_of(self.world(), &frame, tile, splat_weights))
    }

    /// Returns the number of camera samples taken so far.
    pub fn camera_samples(&self) -> u64 {
        self.tiles.iter().map(Tile::samples).sum()
    }

    /// Returns what was noticed so far.
    pub fn report(&self) -> Report {
        let (mut all, mut first_non_finite, mut polarization_of_tile) = (self.shared_stats(), None, 0.0_f64);
        let splat_weight = self.progress.splat_weights(self.world()).image;
        for tile in &self.tiles {
            let stats = self.stats_of(tile, splat_weight);
            if stats.light > 0.0 {
                polarization_of_tile = polarization_of_tile.max(stats.polarization / stats.light);
            }
            first_non_finite = first_non_finite.or(tile.first_non_finite);
            all += stats;
        }
        let (samples, measured) = (self.camera_samples(), self.measured());
        let per_sample = |sum: f64| sum / u64::max(samples, 1) as f64;
        Report {
            samples,
            rays: all.rays,
            non_finite: all.non_finite,
            first_non_finite,
            dropped: per_sample(all.dropped),
            stopped: per_sample(all.stopped),
            unmatched: all.unmatched,
            has_many_media: media::has_too_many(&self.world().scene),
            by_chance: all.by_chance,
            polarization: if all.light > 0.0 { all.polarization / all.light } else { 0.0 },
            polarization_of_tile,
            light: all.light,
            photons: self.progress.sending.photons + self.progress.gathered_photons,
            noise: measured.map(|measured| measured.noise),
            blur: measured.map(|measured| measured.blur),
            stopped_by: self.stopped_by(),
        }
    }

    /// Returns what replicates showed at the last look, if a stop rule looks.
    pub fn measured(&self) -> Option<&Measured> {
        self.progress.measured.as_ref().filter(|Measured { noise, .. }| noise.samples >= FIRST_LOOK)
    }

    /// Returns what ended the render, if a stop rule could and it is finished.
    pub fn stopped_by(&self) -> Option<Stopped> {
        let stop = self.world().method.stop.as_ref().filter(|_| self.is_finished())?;
        Some(Stopped::new(stop, &self.progress))
    }

    /// Returns the light that only one replicate found, if any did at the last look.
    pub fn rare_light(&self) -> Option<RareLight> {
        let noise = self.measured()?.noise;
        rare_light(self.world(), &noise.outlier?, noise.samples / REPLICATES as u32)
    }

    /// Returns how many values of photons and light paths, which all parts of an image trace alike, were not finite.
    pub fn non_finite_in_all_parts(&self) -> u64 {
        self.shared_stats().non_finite
    }

    /// Writes its progress and all sums.
    ///
    /// # Errors
    /// If they cannot be written.
    pub(crate) fn save(&self, blocks: &mut BlockWriter) -> io::Result<()> {
        saved::save(self.world(), &self.progress, &self.tiles, blocks)
    }

    /// Continues from what was saved of a render of the same world, perhaps with another number of samples.
    ///
    /// # Errors
    /// If it cannot be read. Then, and if it does not continue, this render must not be used.
    pub(crate) fn restore(&mut self, blocks: BlockReader) -> Result<Restored> {
        self.light = None;
        saved::restore(&self.world, &mut self.progress, &mut self.tiles, blocks)
    }

    /// Returns its tiles with their places.
    fn places(&self) -> impl Iterator<Item = (&Tile, TilePlace)> {
        self.tiles.iter().zip(self.shard.tiles(self.world().scene.film.window()))
    }

    fn pixels(&self) -> u64 {
        self.tiles.iter().map(|tile| tile.sums.len() as u64).sum()
    }

    /// Returns the camera samples taken, including those of the pass that was stopped, as if all pixels took as many.
    fn samples_taken(&self) -> u64 {
        let (samples, passes) = (self.progress.samples, self.progress.passes);
        let pass_samples = u64::from(self.progress.end_of_pass(self.world()) - samples);
        let pixels_ahead = |tile: &Tile| if tile.passes > passes { tile.sums.len() as u64 } else { tile.ahead.into() };
        self.pixels() * u64::from(samples) + pass_samples * self.tiles.iter().map(pixels_ahead).sum::<u64>()
    }

    fn shared_stats(&self) -> Stats {
        let mut stats = self.progress.gathered;
        stats += self.progress.sending.stats;
        stats
    }

    /// Returns the statistics of a tile, including the light that photons show there, whose sums have the given weight.
    fn stats_of(&self, tile: &Tile, splat_weight: f64) -> Stats {
        let mut stats = tile.stats;
        let samples = f64::from(self.samples()) * splat_weight;
        stats.polarization += samples * tile.splatted.polarization_change;
        stats.light += samples * tile.splatted.pixels.iter().map(|&rgb| self.world().amount(rgb)).sum::<f64>();
        stats
    }

    /// Makes the next pass, or continues it; returns whether it is finished.
    fn pass<const N: usize, P: Polarization<N>>(&mut self, callbacks: &Callbacks) -> bool {
        let world = &*self.world;
        let progress = &mut self.progress;
        let pass = progress.pass(world);
        let PhotonCost { splatted, stored } = self.photon_cost;
        let photon_callbacks = Callbacks {
            progress: &|photons| (callbacks.progress)(splatted * photons),
            should_stop: callbacks.should_stop,
        };
        if !light_pass::splat_photons::<N, P>(
            world,
            &pass,
            &mut progress.sending,
            self.shard,
            &mut self.tiles,
            &photon_callbacks,
        ) {
            return false;
        }
        let stopped_light = self.light.take().and_then(|light| light.downcast::<PassLight<N, P>>().ok());
        let light = stopped_light.unwrap_or_else(|| {
            let light = PassLight::new(world, &pass);
            (callbacks.progress)(stored * light.sent());
            Box::new(light)
        });
        let (window, passes) = (world.scene.film.window(), progress.passes);
        let places: Vec<TilePlace> = self.shard.tiles(window).collect();
        let remaining_tiles = self.tiles.iter_mut().zip(places).filter(|(tile, _)| tile.passes == passes).collect();
        for_each_in_parallel(remaining_tiles, &|(tile, place): (&mut Tile, TilePlace)| {
            let taken = tile.take::<N, P>(place, world, &light, &pass, callbacks.should_stop);
            (callbacks.progress)(u64::from(taken) * pass.numbers.len() as u64);
        });
        if self.tiles.iter().any(|tile| tile.passes == passes) {
            self.light = Some(light);
            return false;
        }
        light.add_to(&mut progress.gathered);
        progress.gathered_photons += light.sent();
        progress.finish(&pass);
        self.look();
        true
    }
}

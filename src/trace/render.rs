//! The loop over tiles.

use std::ops::Range;

use rayon::prelude::*;

use super::light_pass::{self, Shown};
use super::merge::{self, Photons};
use super::photon_targets::PhotonTargets;
use super::polarization::amount;
use super::tally::Tally;
use super::tracer::Tracer;
use super::width::{InLanes, in_lanes};
use super::{Transport, World};
use crate::film::{Film, Pixel, PixelSum, Sample, Window};
use crate::math::{BranchKey, DVec2, Sampler};

/// Side of a tile in pixels.
pub(super) const TILE: u32 = 16;
/// Use of the camera's random numbers: where in the pixel the sample falls.
const PLACE: u32 = 0;
/// Another: where on the lens its ray starts. The path's first vertex has 1, 2 and those from 16.
const LENS: u32 = 3;

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
    pub first_non_finite: Option<[u32; 3]>,
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

/// Renders the world's image, or the part of it that is asked for. `progress` is told how many camera samples and photons are
/// done, from any thread; in the end they are [`work`].
pub fn render(world: &World, progress: &(dyn Fn(u64) + Sync)) -> (Film, Report) {
    in_lanes(&world.method.basis, Render { world, progress })
}

/// How many camera samples and photons an image takes.
pub fn work(world: &World) -> u64 {
    let window = world.scene.film.window();
    let samples = u64::from(window.width) * u64::from(window.height) * u64::from(world.method.samples);
    let passes = world.method.light_pass.as_ref().and_then(|pass| pass.map).map_or(0, |map| u64::from(map.count));
    let photons = |aims: &Option<PhotonTargets>| aims.as_ref().map_or(0, PhotonTargets::photons);
    samples + photons(&world.aims) + passes * photons(&world.map_aims)
}

struct Render<'a> {
    world: &'a World,
    progress: &'a (dyn Fn(u64) + Sync),
}

impl InLanes for Render<'_> {
    type Output = (Film, Report);
    fn run<const N: usize>(self) -> (Film, Report) {
        render_lanes::<N>(self.world, self.progress)
    }
}

fn render_lanes<const N: usize>(world: &World, progress: &(dyn Fn(u64) + Sync)) -> (Film, Report) {
    let settings = world.scene.film;
    let window = settings.window();
    let shown = light_pass::show::<N>(world, progress);
    let corners = (0..window.height)
        .step_by(TILE as usize)
        .flat_map(|y| (0..window.width).step_by(TILE as usize).map(move |x| [x, y]));
    let mut tiles: Vec<Tile> = corners.map(|corner| Tile::new(window, corner)).collect();
    let mut report = Report { photons: shown.photons, rays: shown.rays, ..Report::default() };
    report.non_finite += shown.non_finite;
    report.unmatched += shown.unmatched;
    let map = world.method.light_pass.as_ref().and_then(|pass| pass.map).filter(|_| world.has_map());
    let passes = map.map_or(1, |map| map.count);
    for pass in 0..passes {
        let photons = merge::photons::<N>(world, pass);
        if let Some(photons) = &photons {
            report.add_photons(photons);
            progress(photons.sent);
        }
        let [first, end] =
            [pass, pass + 1].map(|pass| (u64::from(pass) * u64::from(world.method.samples) / u64::from(passes)) as u32);
        let last = pass + 1 == passes;
        tiles.par_iter_mut().enumerate().for_each(|(number, tile)| {
            tile.take::<N>(world, photons.as_ref(), first..end);
            if last {
                tile.finish(world, &shown, number);
            }
            progress(u64::from(tile.width) * u64::from(tile.height) * u64::from(end - first));
        });
    }
    let mut pixels = vec![BLANK; window.width as usize * window.height as usize];
    for tile in &tiles {
        report.add(&tile.report);
        if tile.report.light > 0.0 {
            let of_tile = tile.report.polarization / tile.report.light;
            report.polarization_of_tile = report.polarization_of_tile.max(of_tile);
        }
        for (row, line) in tile.pixels.chunks_exact(tile.width as usize).enumerate() {
            let start = (tile.corner[1] as usize + row) * window.width as usize + tile.corner[0] as usize;
            pixels[start..start + line.len()].copy_from_slice(line);
        }
    }
    let samples = report.samples.max(1) as f64;
    report.dropped /= samples;
    report.stopped /= samples;
    report.polarization = if report.light > 0.0 { report.polarization / report.light } else { 0.0 };
    let film = Film {
        width: window.width,
        height: window.height,
        corner: [window.left, window.top],
        full: [settings.width, settings.height],
        color_space: settings.color_space,
        pixels,
    };
    (film, report)
}

const BLANK: Pixel = Pixel { rgb: [0.0; 3], alpha: 0.0, depth: 0.0, samples: 0.0 };

/// A small part of the image.
struct Tile {
    /// Its first column and row in the window.
    corner: [u32; 2],
    width: u32,
    height: u32,
    /// Sums of its pixels, row by row; empty before the first samples and when the pixels are finished.
    sums: Vec<PixelSum>,
    pixels: Vec<Pixel>,
    report: Report,
}

impl Tile {
    fn new(window: Window, corner: [u32; 2]) -> Self {
        let [width, height] = [window.width - corner[0], window.height - corner[1]].map(|left| left.min(TILE));
        Self { corner, width, height, sums: Vec::new(), pixels: Vec::new(), report: Report::default() }
    }

    /// Takes samples of all pixels.
    fn take<const N: usize>(&mut self, world: &World, photons: Option<&Photons<N>>, numbers: Range<u32>) {
        let window = world.scene.film.window();
        let mut tracer = Tracer::<N>::new(world);
        tracer.photons = photons;
        let report = &mut self.report;
        self.sums.resize_with(self.width as usize * self.height as usize, PixelSum::default);
        for (place, sum) in (0..).zip(&mut self.sums) {
            // Random numbers and rays belong to the full image's pixel, whatever part of it is made.
            let x = window.left + self.corner[0] + place % self.width;
            let y = window.top + self.corner[1] + place / self.width;
            for number in numbers.clone() {
                let sampler = Sampler::new(world.method.seed, [x, y], number);
                if !sum.add(&sample(world, &mut tracer, &sampler, x, y)) {
                    report.non_finite += 1;
                    report.first_non_finite.get_or_insert([x, y, number]);
                }
            }
            sum.settle();
        }
        let Tally { rays, dropped, stopped, unmatched, polarization, light, by_chance, .. } = tracer.tally;
        let samples = self.sums.len() as u64 * numbers.len() as u64;
        let lost = Report { dropped, stopped, unmatched, by_chance, ..Report::default() };
        report.add(&Report { samples, rays, polarization, light, ..lost });
    }

    /// Makes the pixels of their sums, and what photons show there.
    fn finish(&mut self, world: &World, shown: &Shown, number: usize) {
        let width = world.scene.film.window().width;
        let samples = f64::from(world.method.samples);
        self.report.polarization += samples * shown.moved.get(number).copied().unwrap_or_default();
        let by_photons = |place: u32| {
            let [x, y] = [self.corner[0] + place % self.width, self.corner[1] + place / self.width];
            shown.pixels.get((y * width + x) as usize).copied().unwrap_or_default()
        };
        let mut light = 0.0;
        let finished = |(place, sum): (u32, PixelSum)| {
            let rgb = by_photons(place);
            light += amount(world, rgb);
            sum.pixel(rgb)
        };
        self.pixels = (0..).zip(std::mem::take(&mut self.sums)).map(finished).collect();
        self.report.light += samples * light;
    }
}

/// One camera sample.
pub(super) fn sample<const N: usize>(
    world: &World,
    tracer: &mut Tracer<N>,
    sampler: &Sampler,
    x: u32,
    y: u32,
) -> Sample {
    let camera = &world.scene.camera;
    let numbers = |purpose: u32| match world.method.transport {
        Transport::Deterministic { .. } => [0.5; 4],
        Transport::Random { .. } => sampler.four(BranchKey::CAMERA, purpose),
    };
    let [u, v, wavelength, _] = numbers(PLACE);
    let film = DVec2::new(f64::from(x), f64::from(y)) + world.scene.film.filter.place([u, v]);
    let draw = world.method.basis.draw(wavelength);
    let ray = if camera.has_lens() {
        let [u, v, ..] = numbers(LENS);
        camera.lens_ray(film, [u, v])
    } else {
        camera.ray(film)
    };
    let (rgb, first) = tracer.radiance(ray, &draw, sampler);
    Sample { rgb, depth: first.map(|point| camera.depth(point.position)) }
}

impl Report {
    fn add_photons<const N: usize>(&mut self, photons: &Photons<N>) {
        self.photons += photons.sent;
        self.rays += photons.rays;
        self.unmatched += photons.unmatched;
        self.non_finite += photons.non_finite;
    }

    fn add(&mut self, other: &Self) {
        self.samples += other.samples;
        self.rays += other.rays;
        self.non_finite += other.non_finite;
        self.first_non_finite = self.first_non_finite.or(other.first_non_finite);
        self.dropped += other.dropped;
        self.stopped += other.stopped;
        self.unmatched += other.unmatched;
        self.polarization += other.polarization;
        self.light += other.light;
        self.by_chance += other.by_chance;
    }
}

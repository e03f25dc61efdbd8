//! The loop over tiles.

use rayon::prelude::*;

use super::light_pass::{self, Shown};
use super::tally::Tally;
use super::tracer::Tracer;
use super::width::{InLanes, in_lanes};
use super::{Transport, World};
use crate::film::{Film, Pixel, PixelSum, Sample};
use crate::math::{BranchKey, DVec2, Sampler};

/// Side of a tile in pixels.
const TILE: u32 = 16;
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
    /// Bound of the mean weight per camera sample that polarization would move.
    pub polarization: f64,
    /// Photons sent by the light pass.
    pub photons: u64,
}

/// Renders the world's image, or the part of it that is asked for. `progress` is told how many pixels are done, from any thread.
pub fn render(world: &World, progress: &(dyn Fn(u64) + Sync)) -> (Film, Report) {
    in_lanes(&world.method.basis, Render { world, progress })
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
    let shown = light_pass::show::<N>(world);
    let (columns, rows) = (window.width.div_ceil(TILE), window.height.div_ceil(TILE));
    let bands: Vec<(Vec<Pixel>, Report)> = (0..rows)
        .into_par_iter()
        .map(|row| {
            let height = TILE.min(window.height - row * TILE);
            let tiles: Vec<_> =
                (0..columns).into_par_iter().map(|column| tile::<N>(world, &shown, column, row, progress)).collect();
            let mut pixels = vec![BLANK; (window.width * height) as usize];
            let mut report = Report::default();
            for (column, (tile, noted)) in tiles.iter().enumerate() {
                let left = column * TILE as usize;
                let width = tile.len() / height as usize;
                for y in 0..height as usize {
                    let start = y * window.width as usize + left;
                    pixels[start..start + width].copy_from_slice(&tile[y * width..(y + 1) * width]);
                }
                report.add(noted);
            }
            (pixels, report)
        })
        .collect();
    let mut report = Report::default();
    let mut pixels = Vec::with_capacity((window.width as usize) * window.height as usize);
    for (band, noted) in bands {
        pixels.extend(band);
        report.add(&noted);
    }
    let samples = report.samples.max(1) as f64;
    report.dropped /= samples;
    report.stopped /= samples;
    report.polarization /= samples;
    report.photons = shown.photons;
    report.rays += shown.rays;
    report.non_finite += shown.non_finite;
    report.unmatched += shown.unmatched;
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

/// The pixels of one tile, row by row.
fn tile<const N: usize>(
    world: &World,
    shown: &Shown,
    column: u32,
    row: u32,
    progress: &(dyn Fn(u64) + Sync),
) -> (Vec<Pixel>, Report) {
    let window = world.scene.film.window();
    let mut tracer = Tracer::<N>::new(world);
    let (mut pixels, mut report) = (Vec::new(), Report::default());
    for y in row * TILE..window.height.min((row + 1) * TILE) {
        for x in column * TILE..window.width.min((column + 1) * TILE) {
            let by_photons = shown.pixels.get((y * window.width + x) as usize).copied().unwrap_or_default();
            // Random numbers and rays belong to the full image's pixel, whatever part of it is made.
            let (x, y) = (window.left + x, window.top + y);
            let mut sum = PixelSum::default();
            for number in 0..world.method.samples {
                let sampler = Sampler::new(world.method.seed, [x, y], number);
                if !sum.add(&sample(world, &mut tracer, &sampler, x, y)) {
                    report.non_finite += 1;
                    report.first_non_finite.get_or_insert([x, y, number]);
                }
            }
            pixels.push(sum.pixel(by_photons));
        }
    }
    let Tally { rays, dropped, stopped, unmatched, polarization, .. } = tracer.tally;
    report.add(&Report {
        samples: pixels.len() as u64 * u64::from(world.method.samples),
        rays,
        dropped,
        stopped,
        unmatched,
        polarization,
        ..Report::default()
    });
    progress(pixels.len() as u64);
    (pixels, report)
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
    fn add(&mut self, other: &Self) {
        self.samples += other.samples;
        self.rays += other.rays;
        self.non_finite += other.non_finite;
        self.first_non_finite = self.first_non_finite.or(other.first_non_finite);
        self.dropped += other.dropped;
        self.stopped += other.stopped;
        self.unmatched += other.unmatched;
        self.polarization += other.polarization;
    }
}

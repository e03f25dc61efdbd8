//! Learns where the noise of an image is and what adaptive sampling is worth, from a few thousand camera samples.

use std::ops::Range;

use super::cost::with_few_photons;
use super::pilot_noise::{DARK_OFFSET, RESAMPLING_COST};
use crate::math::Sampler;
use crate::trace::camera::{PathTracer, take_sample};
use crate::trace::contribution::add;
use crate::trace::density::SampleDensity;
use crate::trace::parallel::in_parallel;
use crate::trace::photon::{LightVertices, PhotonMap, pilot_vertices};
use crate::trace::walk::Polarization;
use crate::trace::width::in_lanes_of;
use crate::trace::{RAYS_OF_A_LOOK, World};

/// What adaptive sampling is worth.
#[derive(Clone, Debug, PartialEq)]
pub struct Adaptive {
    /// Where more samples are taken, and where fewer.
    pub density: SampleDensity,
    /// How many times as long uniform sampling takes to the same error.
    pub gain: f64,
    /// The ratio of its rays to those of uniform sampling.
    pub rays: f64,
}

/// Pixels tested in each cell, looks at each pixel, and samples of each look. The samples of a look are spread evenly,
/// like those of an image, so that the difference between two looks shows the noise that this leaves.
const PIXELS_PER_CELL: u32 = 2;
const LOOKS_PER_PIXEL: u32 = 2;
const SAMPLES_PER_LOOK: u32 = 4;
const SAMPLES_PER_CELL: f64 = (PIXELS_PER_CELL * LOOKS_PER_PIXEL * SAMPLES_PER_LOOK) as f64;
/// Fewest pixels of a cell, and most cells: independent of the number of samples, so that more can be added later.
const MIN_CELL_PIXELS: f64 = 32.0;
const MAX_CELLS: f64 = 4096.0;
/// Cells of the first look, which tell how many rays a cell takes, and the ray budget of all cells, in ordinary looks.
/// With half of it, `scenes/prism.toml` took 1.18 times as many rays to the same error.
const FIRST_CELLS: f64 = 16.0;
const BUDGET_LOOKS: f64 = 4.0;
/// Cells to each side that are averaged for the noise of a cell.
const SMOOTHING_RADIUS: i64 = 2;
/// The fixed cost of a sample, in rays of a path.
const SAMPLE_OVERHEAD: f64 = 0.5;
/// Steps of the scale per factor of two, the least step, and one beyond the largest.
const STEPS_PER_OCTAVE: i32 = 16;
const MIN_STEP: i32 = -4 * STEPS_PER_OCTAVE;
const MAX_STEP: i32 = 64 * STEPS_PER_OCTAVE;
/// Sets these random numbers apart from those of the image.
const SEED: u64 = 0x6465_6e73;

/// Finds where an image should take more samples and where fewer, and what that is worth; `None` if there is no noise.
///
/// Errors are relative to each pixel, or to the image if it [is judged as a whole](crate::trace::Method). Rays stand
/// for time, so that the answer is the same on every machine. The whole format is used, also where a part is rendered.
pub fn adaptive(world: &World) -> Option<Adaptive> {
    let format = [world.scene.film.width, world.scene.film.height];
    let pixels = world.scene.film.whole().pixels() as f64;
    let cells = |max: f64| {
        let side = (pixels / (pixels / MIN_CELL_PIXELS).clamp(1.0, max)).sqrt();
        format.map(|pixels| ((f64::from(pixels) / side) as u32).max(1))
    };
    let (cells, found) = in_lanes_of!(world, N, P => look::<N, P>(world, &cells));
    let noise_of = |pixels: Range<usize>| smoothed_noise(cells, &found, pixels, world.method.judges_the_whole());
    // The choice from one pixel of each cell is judged by the other: judged by its own noise, it would look too good.
    let [gain, rays] = gain_and_rays(&powers(&noise_of(0..1))?, &noise_of(1..2));
    Some(Adaptive { density: SampleDensity { cells, powers: powers(&noise_of(0..2))? }, gain, rays })
}

/// Statistics of a pixel in film channels: the mean of its samples, and the variance of one of a set spread evenly.
#[derive(Clone, Copy, Debug, Default)]
struct PixelMoments {
    mean: [f64; 3],
    variance: [f64; 3],
}

/// Statistics of the pixels of a cell, and the rays of all their samples.
#[derive(Clone, Copy, Debug, Default)]
struct CellSamples {
    pixels: [PixelMoments; PIXELS_PER_CELL as usize],
    rays: f64,
}

/// The relative variance and the rays of a cell, averaged over its neighbors.
#[derive(Clone, Copy, Debug)]
struct CellNoise {
    variance: f64,
    rays: f64,
}

/// Looks at a few cells first, then at as many as the ray budget allows. `cells` returns the numbers of columns and
/// rows for at most a given number of cells.
fn look<const N: usize, P: Polarization<N>>(
    world: &World,
    cells: &dyn Fn(f64) -> [u32; 2],
) -> ([u32; 2], Vec<CellSamples>) {
    let (few, photons) = with_few_photons::<N, P>(world);
    let vertices = pilot_vertices::<N>(world);
    let look = |max: f64| {
        let cells = cells(max);
        let row = |row: usize| look_at_row::<N, P>(&few, photons.as_ref(), vertices.as_ref(), cells, row as u32);
        (cells, in_parallel(cells[1] as usize, &row).concat())
    };
    let (_, found) = look(FIRST_CELLS);
    let rays = found.iter().map(|found| found.rays).sum::<f64>() / found.len() as f64;
    look((BUDGET_LOOKS * RAYS_OF_A_LOOK as f64 / rays).clamp(FIRST_CELLS, MAX_CELLS))
}

fn look_at_row<const N: usize, P: Polarization<N>>(
    world: &World,
    photons: Option<&PhotonMap<N, P>>,
    vertices: Option<&LightVertices<N>>,
    cells: [u32; 2],
    row: u32,
) -> Vec<CellSamples> {
    let format = [world.scene.film.width, world.scene.film.height];
    let mut tracer = PathTracer::<N, P>::new(world).with_photons(photons);
    tracer.light_vertices = vertices;
    if world.layers.has_catchers() {
        tracer = tracer.with_layers();
    }
    let mut found = vec![CellSamples::default(); cells[0] as usize];
    for (column, found) in (0..).zip(&mut found) {
        let before = tracer.walker.stats;
        for (number, pixel) in (0..).zip(&mut found.pixels) {
            // At a third and two thirds of the cell's diagonal.
            let at = [column, row];
            let place = |i: usize| {
                let within = f64::from(at[i]) + f64::from(number + 1) / f64::from(PIXELS_PER_CELL + 1);
                ((within * f64::from(format[i]) / f64::from(cells[i])) as i32).min(format[i] as i32 - 1)
            };
            *pixel = look_at_pixel(world, &mut tracer, [place(0), place(1)]);
        }
        let stats = tracer.walker.stats;
        let [rays, resampled] =
            [stats.rays - before.rays, stats.resampled - before.resampled].map(|count| count as f64);
        found.rays = SAMPLE_OVERHEAD * SAMPLES_PER_CELL + rays + RESAMPLING_COST * resampled;
    }
    found
}

fn look_at_pixel<const N: usize, P: Polarization<N>>(
    world: &World,
    tracer: &mut PathTracer<N, P>,
    pixel: [i32; 2],
) -> PixelMoments {
    let mut look = |look: u64| {
        let seed = (world.method.seed ^ SEED).wrapping_add(look);
        let mut mean = [0.0; 3];
        for number in 0..SAMPLES_PER_LOOK {
            let mut rgb = take_sample(tracer, &Sampler::of_pixel(seed, pixel, number), pixel).rgb;
            // A shadow catcher shows only shadows, however noisy its light is.
            let shadow = tracer.layers().map(|layers| world.layers.catcher_change(layers.sample_row().row));
            shadow.iter().for_each(|shadow| add(&mut rgb, *shadow));
            (0..3).filter(|&i| rgb[i].is_finite()).for_each(|i| mean[i] += rgb[i] / f64::from(SAMPLES_PER_LOOK));
        }
        mean
    };
    let [one, other] = [look(0), look(1)];
    let mean = std::array::from_fn(|i| 0.5 * (one[i] + other[i]));
    let variance = |i: usize| 0.5 * f64::from(SAMPLES_PER_LOOK) * (one[i] - other[i]) * (one[i] - other[i]);
    PixelMoments { mean, variance: std::array::from_fn(variance) }
}

/// Returns the noise of each cell, averaged over the 5 x 5 cells around it.
fn smoothed_noise(cells: [u32; 2], found: &[CellSamples], pixels: Range<usize>, is_absolute: bool) -> Vec<CellNoise> {
    let means = || found.iter().flat_map(|found| found.pixels).flat_map(|pixel| pixel.mean);
    let dark = means().map(|x| x * x).sum::<f64>() / means().count().max(1) as f64
        * if is_absolute { 1.0 } else { DARK_OFFSET };
    let relative_variance = |PixelMoments { mean, variance }: &PixelMoments| {
        let mean_square = |i: usize| if is_absolute { 0.0 } else { mean[i] * mean[i] };
        (0..3).map(|i| variance[i] / (mean_square(i) + dark).max(f64::MIN_POSITIVE)).sum::<f64>()
    };
    let own: Vec<f64> =
        found.iter().map(|found| found.pixels[pixels.clone()].iter().map(relative_variance).sum()).collect();
    let [columns, rows] = cells.map(i64::from);
    let mean_around = |cell: i64| {
        let (x, y) = (cell % columns, cell / columns);
        let near = |at: i64, end: i64| (at - SMOOTHING_RADIUS).max(0)..(at + SMOOTHING_RADIUS + 1).min(end);
        let (mut variance, mut rays, mut count) = (0.0, 0.0, 0.0);
        for at in near(y, rows).flat_map(|y| near(x, columns).map(move |x| (y * columns + x) as usize)) {
            (variance, rays, count) = (variance + own[at], rays + found[at].rays, count + 1.0);
        }
        CellNoise { variance: variance / count, rays: rays / count }
    };
    (0..columns * rows).map(mean_around).collect()
}

/// Returns the powers of two that minimize the error for no more rays than uniform samples take; `None` without noise.
fn powers(found: &[CellNoise]) -> Option<Vec<i8>> {
    let ideal: Vec<f64> = found.iter().map(|cell| (cell.variance / cell.rays).sqrt()).collect();
    let max = ideal.iter().copied().fold(0.0, f64::max);
    if !(max > 0.0 && max.is_finite()) {
        return None;
    }
    let [least, largest] = [SampleDensity::LEAST, SampleDensity::MOST].map(f64::from);
    let powers_at = |step: i32| -> Vec<i8> {
        let scale = libm::exp2(f64::from(step) / f64::from(STEPS_PER_OCTAVE)) / max;
        ideal.iter().map(|ideal| libm::log2(ideal * scale).round().clamp(least, largest) as i8).collect()
    };
    let uniform_rays = rays(found, &vec![0; found.len()]);
    let affordable_powers = |step: i32| Some(powers_at(step)).filter(|powers| rays(found, powers) <= uniform_rays);
    // Find the largest scale that takes no more rays: a larger one never takes fewer.
    let (mut from, mut to) = (MIN_STEP, MAX_STEP);
    let mut best = affordable_powers(from)?;
    while to - from > 1 {
        let middle = (from + to) / 2;
        match affordable_powers(middle) {
            Some(powers) => (from, best) = (middle, powers),
            None => to = middle,
        }
    }
    Some(best)
}

fn rays(found: &[CellNoise], powers: &[i8]) -> f64 {
    found.iter().zip(powers).map(|(cell, &power)| cell.rays * SampleDensity::times(power)).sum()
}

/// Returns how many times as long uniform samples take to the same error, and the ratio of the rays.
fn gain_and_rays(powers: &[i8], found: &[CellNoise]) -> [f64; 2] {
    let rays = rays(found, powers) / rays(found, &vec![0; found.len()]);
    let before: f64 = found.iter().map(|cell| cell.variance).sum();
    let after: f64 = found.iter().zip(powers).map(|(cell, &power)| cell.variance / SampleDensity::times(power)).sum();
    [before / (rays * after), rays]
}

//! The rooms of `tests/planning`: how much less time an equal error takes with a light pass than without.
//!
//! ```text
//! cargo bench --bench rooms               # all
//! cargo bench --bench rooms -- glass      # those that are called so
//! ```
//!
//! Time to an error is processor time x mean square difference from a long render with the light pass. Errors are
//! counted in three ways: as they are, relative to the brightness of each pixel, and relative without the hundredth of
//! the pixels in which both ways are worst, such as the edge of a lamp. Photons go from and to what the plan chooses,
//! and in its number, but none are gathered. Where the plan sends none, they go from all lights to all smooth surfaces,
//! one for each camera sample. Where random paths can never find the light, no time is enough. Where they find hardly
//! any in a few images, their error is larger than what is seen of it.

use abbe::film::Film;
use abbe::plan::plan;
use abbe::scene::{Scene, Source};
use abbe::spectrum::Curve;
use abbe::trace::{LightPass, Method, Smoothness, prepare, render};

#[path = "../tests/planning/ordinary.rs"]
mod ordinary;
#[path = "../tests/planning/twenty.rs"]
mod twenty;

const SEEDS: u64 = 4;
const SAMPLES: u32 = 64;
/// How many times as many samples the reference has.
const REFERENCE_FACTOR: u32 = 16;
/// Pixels darker than this share of the squared mean count as if they were that bright.
const DARK_SHARE: f64 = 0.01;

fn main() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread can be started");
    println!(
        "{:55} {:>8} {:>12} {:>9} {:>9} {:>9} {:>6} {:>6}",
        "room", "a sample", "photons, s", "gain", "relative", "common", "plan", "held"
    );
    let name_part = std::env::args().skip(1).find(|word| !word.starts_with('-')).unwrap_or_default();
    let rooms = twenty::rooms().into_iter().chain(ordinary::rooms());
    for twenty::Room { name, text, asks, words } in rooms.filter(|room| room.name.contains(&name_part)) {
        let source = Source { path: "room.toml".into(), text };
        let scene = source.compile().expect("the room is valid");
        let plan = plan(&scene).method;
        let all = (0..scene.lights.len()).filter(|&id| scene.lights[id].sends_photons()).collect();
        let pass = match &plan.light_pass {
            Some(pass) => LightPass { map: None, ..pass.clone() },
            None => LightPass {
                photons: camera_samples(&scene, plan.samples) as u64,
                lights: all,
                openings: Vec::new(),
                to: Smoothness::ALL.to_vec(),
                map: None,
            },
        };
        let photons_per_sample = pass.photons as f64 / camera_samples(&scene, plan.samples);
        let method = |with_photons: bool, samples: u32, seed| {
            let photons = (photons_per_sample * camera_samples(&scene, samples)) as u64;
            let light_pass = with_photons.then(|| LightPass { photons, ..pass.clone() });
            Method { samples, seed, light_pass, ..plan.clone() }
        };
        let image = |method| pool.install(|| render(&prepare(&scene, method), &|_| ())).0;
        let reference = image(method(true, REFERENCE_FACTOR * SAMPLES, 99));
        let timed = |with_photons| {
            let start = processor_seconds();
            let images: Vec<Film> = (0..SEEDS).map(|seed| image(method(with_photons, SAMPLES, seed))).collect();
            let seconds = (processor_seconds() - start) / SEEDS as f64;
            (seconds, squared_errors(&images, &reference))
        };
        let ((seconds, with), (by_chance, without)) = (timed(true), timed(false));
        let [errors, others] = [&with, &without].map(|of| errors(of, [&with, &without], &reference));
        let gain = |way: usize| by_chance * others[way] / (seconds * errors[way]);
        println!(
            "{name:55} {photons_per_sample:8.2} {:12.2} {:9.2} {:9.2} {:9.2} {:>6} {:>6}   {words}",
            seconds * errors[0] / 1e-4,
            gain(0),
            gain(1),
            gain(2),
            if plan.light_pass.is_some() { "pass" } else { "-" },
            if asks { "pass" } else { "-" },
        );
    }
}

/// Returns the number of camera samples of an image.
fn camera_samples(scene: &Scene<Curve>, samples: u32) -> f64 {
    f64::from(scene.film.width * scene.film.height * samples)
}

/// Returns the sum of the squares of a pixel's channels.
fn norm_squared(rgb: [f64; 3]) -> f64 {
    rgb.iter().map(|x| x * x).sum()
}

/// Returns the squared difference of each pixel from the reference, averaged over some images.
fn squared_errors(images: &[Film], reference: &Film) -> Vec<f64> {
    let error_of_pixel = |(pixel, exact): (usize, [f32; 3])| {
        let error_in_image = |image: &Film| {
            let found = image.pixels[pixel].rgb;
            norm_squared(std::array::from_fn(|channel| f64::from(found[channel]) - f64::from(exact[channel])))
        };
        images.iter().map(error_in_image).sum::<f64>() / images.len() as f64
    };
    reference.pixels.iter().map(|pixel| pixel.rgb).enumerate().map(error_of_pixel).collect()
}

/// Returns three errors: the mean square difference over the mean square; the mean of the squared differences relative
/// to each pixel; and the latter without the hundredth of the pixels in which the better of both ways is worst.
fn errors(of: &[f64], both: [&[f64]; 2], reference: &Film) -> [f64; 3] {
    let bright: Vec<f64> = reference.pixels.iter().map(|pixel| norm_squared(pixel.rgb.map(f64::from))).collect();
    let count = bright.len();
    let mean = |channel: usize| reference.pixels.iter().map(|pixel| f64::from(pixel.rgb[channel])).sum::<f64>();
    let dark = DARK_SHARE * norm_squared([0, 1, 2].map(|channel| mean(channel) / count as f64));
    let relative = |squared_errors: &[f64], pixel: usize| squared_errors[pixel] / (bright[pixel] + dark);
    let better = |pixel: usize| relative(both[0], pixel).min(relative(both[1], pixel));
    let mut pixels: Vec<usize> = (0..count).collect();
    pixels.sort_by(|&a, &b| better(a).total_cmp(&better(b)));
    let mean_over =
        |pixels: &[usize]| pixels.iter().map(|&pixel| relative(of, pixel)).sum::<f64>() / pixels.len() as f64;
    [
        of.iter().sum::<f64>() / bright.iter().sum::<f64>(),
        mean_over(&pixels),
        mean_over(&pixels[..count - count.div_ceil(100)]),
    ]
}

/// Returns the processor time of all threads so far. Other programs do not count.
fn processor_seconds() -> f64 {
    let tasks = std::fs::read_dir("/proc/self/task").expect("this bench reads the times of threads from Linux");
    let thread_seconds = |task: std::io::Result<std::fs::DirEntry>| -> Option<f64> {
        let text = std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        Some(1e-9 * text.split_whitespace().next()?.parse::<f64>().ok()?)
    };
    tasks.filter_map(thread_seconds).sum()
}

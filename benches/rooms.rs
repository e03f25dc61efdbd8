//! The twenty rooms of `tests/planning`: processor time to a relative error of 1 % with a light pass and without.
//!
//! ```text
//! cargo bench --bench rooms
//! ```
//!
//! The error is the root of the mean square difference from a long render with the light pass, over the root of its
//! mean square; time to 1 % is processor time x error^2 / 1e-4. Photons are as many as the plan asks for, or one a
//! camera sample. Where chance misses light for good, no time is enough.

use abbe::film::Film;
use abbe::plan::plan;
use abbe::scene::{Scene, Source};
use abbe::spectrum::Curve;
use abbe::trace::{LightPass, Method, Smoothness, prepare, render};

#[path = "../tests/planning/twenty.rs"]
mod twenty;

const SEEDS: u64 = 4;
const SAMPLES: u32 = 32;

fn main() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread can be started");
    println!(
        "{:55} {:>8} {:>12} {:>12} {:>8} {:>6} {:>6}",
        "room", "a sample", "photons, s", "chance, s", "gain", "plan", "held"
    );
    for twenty::Room { name, text, asks, words } in twenty::rooms() {
        let source = Source { path: "room.toml".into(), text };
        let scene = source.compile().expect("the room is valid");
        let plan = plan(&scene).method;
        let lights: Vec<usize> = (0..scene.lights.len()).filter(|&id| scene.lights[id].sends_photons()).collect();
        let wanted = plan
            .light_pass
            .as_ref()
            .map_or(1.0, |pass| pass.photons as f64 / (f64::from(plan.samples) * pixels(&scene)));
        let method = |pass: bool, samples: u32, seed| {
            let photons = (wanted * f64::from(samples) * pixels(&scene)) as u64;
            let light_pass =
                pass.then(|| LightPass { photons, lights: lights.clone(), to: vec![Smoothness::Whole], map: None });
            Method { samples, seed, light_pass, ..plan.clone() }
        };
        let image = |method| pool.install(|| render(&prepare(&scene, method), &|_| ())).0;
        let reference = image(method(true, 24 * SAMPLES, 99));
        let timed = |pass| {
            let start = processor_seconds();
            let images: Vec<Film> = (0..SEEDS).map(|seed| image(method(pass, SAMPLES, seed))).collect();
            let seconds = (processor_seconds() - start) / SEEDS as f64;
            let error = images.iter().map(|image| error(image, &reference)).sum::<f64>() / SEEDS as f64;
            (seconds, error)
        };
        let (with, without) = (timed(true), timed(false));
        let time = |(seconds, error): (f64, f64)| seconds * error / 1e-4;
        println!(
            "{name:55} {wanted:8.2} {:12.2} {:12.2} {:8.2} {:>6} {:>6}   {words}",
            time(with),
            time(without),
            time(without) / time(with),
            if plan.light_pass.is_some() { "pass" } else { "-" },
            if asks { "pass" } else { "-" },
        );
    }
}

fn pixels(scene: &Scene<Curve>) -> f64 {
    f64::from(scene.film.width * scene.film.height)
}

/// Mean square difference over mean square.
fn error(image: &Film, reference: &Film) -> f64 {
    let (mut difference, mut square) = (0.0, 0.0);
    for (found, exact) in image.pixels.iter().zip(&reference.pixels) {
        for channel in 0..3 {
            let (found, exact) = (f64::from(found.rgb[channel]), f64::from(exact.rgb[channel]));
            difference += (found - exact) * (found - exact);
            square += exact * exact;
        }
    }
    if square > 0.0 { difference / square } else { 0.0 }
}

/// Processor time of all threads so far: other programs do not count.
fn processor_seconds() -> f64 {
    let tasks = std::fs::read_dir("/proc/self/task").expect("this bench reads the times of threads from Linux");
    let spent = |task: std::io::Result<std::fs::DirEntry>| -> Option<f64> {
        let text = std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        Some(1e-9 * text.split_whitespace().next()?.parse::<f64>().ok()?)
    };
    tasks.filter_map(spent).sum()
}

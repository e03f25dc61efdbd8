//! Caustics: processor time to a relative error, with the light pass and with random paths, for lamps from large ones
//! to a point.
//!
//! ```text
//! cargo bench --bench caustics [-- point]
//! ```
//!
//! A ball of N-SF11 with radius 1 and its center 1.5 above a floor, under a lamp of power pi at a height of 7. The
//! image shows the floor's patch of 1.6 by 1.6 in 24 x 24 pixels. The floor is nearly black, so that nothing but the
//! caustic itself is measured. relMSE = mean variance over mean square of the pixels, from images of several seeds;
//! time to 1e-3 is time x relMSE / 1e-3.

use std::time::Instant;

use abbe::film::Film;
use abbe::plan::plan;
use abbe::scene::{Scene, Source};
use abbe::spectrum::Curve;
use abbe::trace::{LightPass, Method, Smoothness, prepare, render};

const SEEDS: u64 = 8;

fn main() {
    println!("{:12} {:>22} {:>10} {:>10} {:>12} {:>10}", "lamp", "", "s", "relMSE", "s to 1e-3", "mean");
    let radius = |radius: f64| {
        let radiance = 1.0 / (4.0 * std::f64::consts::PI * radius * radius);
        let lamp = format!("shape.sphere = {{ center = [0, 7, 0], radius = {radius:?} }}");
        (
            format!("{radius}"),
            format!(
                "[material.lamp]\nemissive = {{ radiance = {radiance:?} }}\n[[object]]\nmaterial = \"lamp\"\n{lamp}\n"
            ),
        )
    };
    let point = ("a point".to_owned(), "[[light]]\npoint = { position = [0, 7, 0], intensity = 0.25 }\n".to_owned());
    for (name, light) in [radius(1.0), radius(0.3), radius(0.03), radius(0.003), point] {
        // `-- point` measures only that lamp.
        if !std::env::args().skip(1).all(|word| word.starts_with("--") || name.contains(&word)) {
            continue;
        }
        let scene = scene(ball(&light));
        let plan = plan(&scene).method;
        let photons = |samples: u32, per_sample: f64| {
            let photons = (f64::from(samples) * 576.0 * per_sample) as u64;
            Method {
                samples,
                light_pass: Some(LightPass {
                    photons,
                    lights: vec![0],
                    openings: Vec::new(),
                    to: vec![Smoothness::Whole],
                    map: None,
                }),
                ..plan.clone()
            }
        };
        let label = if plan.light_pass.is_some() { "photons" } else { "chance" };
        measure(&name, &format!("the plan ({label})"), &scene, &Method { samples: 64, ..plan.clone() });
        for per_sample in [0.25, 1.0] {
            measure("", &format!("{per_sample} a sample"), &scene, &photons(64, per_sample));
        }
        if !name.contains("point") {
            measure("", "chance", &scene, &Method { samples: 256, light_pass: None, ..plan.clone() });
        }
    }
}

fn scene(text: String) -> Scene<Curve> {
    let source = Source { path: "bench.toml".into(), text };
    source.compile().expect("the scene is valid")
}

fn ball(light: &str) -> String {
    format!(
        "[camera]\nposition = [0, 0.4, 0]\nlook_at = [0, 0, 0]\nup = [0, 0, 1]\nprojection = \"orthographic\"\nheight = 1.6\n\
         [film]\nwidth = 24\nheight = 24\n\
         [material.floor]\ndiffuse = {{ reflectance = 0.001 }}\n[material.glass]\ndielectric = {{ index = \"N-SF11\" }}\n\
         [[object]]\nmaterial = \"floor\"\nshape.plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}\n\
         [[object]]\nmaterial = \"glass\"\nshape.sphere = {{ center = [0, 1.5, 0], radius = 1 }}\n{light}"
    )
}

fn measure(name: &str, label: &str, scene: &Scene<Curve>, method: &Method) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread can be started");
    let (mut seconds, mut images) = (0.0, Vec::new());
    for seed in 0..SEEDS {
        let start = Instant::now();
        // What is learned before the image counts as part of its time.
        images.push(pool.install(|| render(&prepare(scene, Method { seed, ..method.clone() }), &|_| ())).0);
        seconds += start.elapsed().as_secs_f64() / SEEDS as f64;
    }
    let (error, mean) = relative_error(&images);
    println!("{name:12} {label:>22} {seconds:10.3} {error:10.2e} {:12.3} {mean:10.3e}", seconds * error / 1e-3);
}

/// Returns the mean variance over the mean square, and the mean of green.
fn relative_error(images: &[Film]) -> (f64, f64) {
    let count = images.len() as f64;
    let (mut variance, mut square, mut mean) = (0.0, 0.0, 0.0);
    for (pixel, channel) in (0..images[0].pixels.len()).flat_map(|pixel| (0..3).map(move |channel| (pixel, channel))) {
        let values = images.iter().map(|image| f64::from(image.pixels[pixel].rgb[channel]));
        let average = values.clone().sum::<f64>() / count;
        variance += values.map(|x| (x - average) * (x - average)).sum::<f64>() / (count - 1.0);
        square += average * average;
        mean += if channel == 1 { average / images[0].pixels.len() as f64 } else { 0.0 };
    }
    (variance / square, mean)
}

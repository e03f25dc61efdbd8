//! The cost of dispersion: processor time times noise of each way to carry wavelengths, compared with glass without
//! dispersion.
//!
//! ```text
//! cargo bench --bench dispersion
//! ```
//!
//! A glass ball on checkered tiles under a sky and a lamp. relMSE = mean variance over mean square, from images of
//! several seeds; lower time x relMSE is better. "collapse" is the scheme of pbrt-v4: four random wavelengths, one of
//! which goes on after dispersion.

use std::time::Instant;

use abbe::film::Film;
use abbe::plan::plan;
use abbe::scene::{Scene, Source};
use abbe::spectrum::{Curve, comparison};
use abbe::trace::{Method, prepare, render};

const SEEDS: u64 = 6;
const SAMPLES: u32 = 64;

struct Measurement {
    seconds: f64,
    image: f64,
    glass: f64,
    mean: [f64; 3],
}

fn main() {
    let cases = [
        ("N-BK7", "\"N-BK7\"", "1.5168", "1"),
        ("N-SF11", "\"N-SF11\"", "1.7847", "1"),
        ("N-BK7, FL11", "\"N-BK7\"", "1.5168", "{ illuminant = \"FL11\" }"),
        ("N-BK7, sodium", "\"N-BK7\"", "1.5168", "{ lines = [[589.0, 2], [589.6, 1]], luminance = 1 }"),
        ("vanishing", "{ cauchy = [1.5168, 1e-6] }", "1.5168", "1"),
    ];
    println!(
        "{:14} {:10} {:>8} {:>12} {:>12} {:>8} {:>8}",
        "glass", "model", "s", "relMSE image", "relMSE glass", "x image", "x glass"
    );
    for (name, dispersive, plain, light) in cases {
        let mask = glass_pixels(plain, light);
        let methods = [
            ("none", text(plain, light, "{ bands = 12 }", true), false),
            ("hero", text(dispersive, light, "\"hero\"", true), false),
            ("collapse", text(dispersive, light, "\"hero\"", true), true),
        ];
        let mut first: Option<[f64; 2]> = None;
        for (model, scene, collapses) in methods {
            // A scheme that does not know of a spectral line cannot sample it.
            if collapses && light.contains("lines") {
                continue;
            }
            let Measurement { seconds, image, glass, mean } = measure(&scene, collapses, &mask);
            let cost = [seconds * image, seconds * glass];
            let [by_image, by_glass] = first.get_or_insert(cost);
            println!(
                "{name:14} {model:10} {seconds:8.2} {image:12.2e} {glass:12.2e} {:8.2} {:8.2}   mean {:.4} {:.4} {:.4}",
                cost[0] / *by_image,
                cost[1] / *by_glass,
                mean[0],
                mean[1],
                mean[2]
            );
        }
    }
}

fn scene(text: String) -> Scene<Curve> {
    let source = Source { path: "bench.toml".into(), text };
    source.compile().expect("the scene is valid")
}

/// Renders images of several seeds on one thread.
fn measure(text: &str, collapses: bool, mask: &[bool]) -> Measurement {
    let scene = scene(text.to_owned());
    let method = plan(&scene).method;
    let basis = if collapses { comparison::collapsing(scene.film.color_space) } else { method.basis.clone() };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread can be started");
    let (mut times, mut images) = (Vec::new(), Vec::new());
    for seed in 0..SEEDS {
        let world = prepare(&scene, Method { basis: basis.clone(), seed, ..method.clone() });
        let start = Instant::now();
        images.push(pool.install(|| render(&world, &|_| ())).0);
        times.push(start.elapsed().as_secs_f64());
    }
    times.sort_by(f64::total_cmp);
    let (image, mean) = relative_error(&images, |_| true);
    let (glass, _) = relative_error(&images, |pixel| mask[pixel]);
    Measurement { seconds: times[times.len() / 2], image, glass, mean }
}

/// Returns the mean variance over the mean square, and the mean color, of the chosen pixels.
fn relative_error(images: &[Film], chosen: impl Fn(usize) -> bool) -> (f64, [f64; 3]) {
    let count = images.len() as f64;
    let (mut variance, mut square, mut mean, mut pixels) = (0.0, 0.0, [0.0; 3], 0.0);
    for pixel in (0..images[0].pixels.len()).filter(|&pixel| chosen(pixel)) {
        pixels += 1.0;
        for (channel, mean) in mean.iter_mut().enumerate() {
            let values = images.iter().map(|image| f64::from(image.pixels[pixel].rgb[channel]));
            let average = values.clone().sum::<f64>() / count;
            variance += values.map(|x| (x - average) * (x - average)).sum::<f64>() / (count - 1.0);
            square += average * average;
            *mean += average;
        }
    }
    (variance / square, mean.map(|x| x / pixels))
}

/// Returns where the ball is seen: where the depth changes when it is taken away.
fn glass_pixels(index: &str, light: &str) -> Vec<bool> {
    let depths = [true, false].map(|ball| {
        let scene = scene(text(index, light, "\"rgb\"", ball));
        let method = Method { samples: 4, ..plan(&scene).method };
        render(&prepare(&scene, method), &|_| ()).0.pixels.iter().map(|pixel| pixel.depth).collect::<Vec<_>>()
    });
    depths[0].iter().zip(&depths[1]).map(|(with, without)| with != without).collect()
}

fn text(index: &str, light: &str, model: &str, ball: bool) -> String {
    let mut text = format!(
        "[camera]\nposition = [0, 1.7, 5.2]\nlook_at = [0, 0.8, 0]\nvertical_fov = 40\n\
         [film]\nwidth = 96\nheight = 72\n[render]\nmodel = {model}\nsamples = {SAMPLES}\npolarization = \"off\"\n\
         [material.glass]\ndielectric = {{ index = {index} }}\n\
         [material.light]\ndiffuse = {{ reflectance = {{ rgb = [0.8, 0.8, 0.75] }} }}\n\
         [material.dark]\ndiffuse = {{ reflectance = {{ rgb = [0.12, 0.1, 0.1] }} }}\n\
         [material.red]\ndiffuse = {{ reflectance = {{ rgb = [0.7, 0.1, 0.08] }} }}\n\
         [material.lamp]\nemissive = {{ radiance = {}, sides = \"front\" }}\n\
         [[object]]\nshape.cube = {{ center = [-1.4, 0.6, -1.2], size = 1.2 }}\nmaterial = \"red\"\n\
         [[object]]\nshape.quad = {{ center = [2, 4, 1], u = [0.6, 0, 0], v = [0, 0, 0.6] }}\nmaterial = \"lamp\"\n\
         [[light]]\nenvironment = {{ radiance = {} }}\n",
        scaled(light, 8.0),
        scaled(light, 0.4)
    );
    if ball {
        text += "[[object]]\nshape.sphere = { center = [0, 0.95, 0.8], radius = 0.95 }\nmaterial = \"glass\"\n";
    }
    for (i, j) in (-4..4).flat_map(|i| (-4..4).map(move |j| (i, j))) {
        let material = if (i + j) % 2 == 0 { "light" } else { "dark" };
        let (x, z) = (f64::from(i) + 0.5, f64::from(j) + 0.5);
        text += &format!(
            "[[object]]\nshape.quad = {{ center = [{x}, 0, {z}], u = [0, 0, 0.5], v = [0.5, 0, 0] }}\nmaterial = \"{material}\"\n"
        );
    }
    text
}

/// Multiplies the brightness of a light by a factor.
fn scaled(light: &str, factor: f64) -> String {
    match light.strip_suffix('}') {
        None => factor.to_string(),
        Some(table) if light.contains("luminance") => {
            table.replace("luminance = 1", &format!("luminance = {factor}")) + "}"
        }
        Some(table) => format!("{table}, scale = {factor} }}"),
    }
}

//! Cost and benefit of next-event estimation: processor time times noise of rooms with lamps of many kinds and numbers.
//!
//! ```text
//! cargo bench --bench lights              # all rooms
//! cargo bench --bench lights -- wall      # those whose name contains a word
//! ```
//!
//! relMSE = mean variance over mean square, from images of several seeds; lower time x relMSE is better. Figures of two
//! versions are comparable only when they ran side by side.

use std::time::Instant;

use abbe::film::Film;
use abbe::plan::plan;
use abbe::scene::Source;
use abbe::trace::{Method, prepare, render};

const SEEDS: u64 = 6;
const SAMPLES: u32 = 32;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    println!("{:24} {:>8} {:>11} {:>13}   mean", "room", "s", "relMSE", "s x relMSE");
    for (name, text) in rooms() {
        if words.is_empty() || words.iter().any(|word| name.contains(word.as_str())) {
            measure(&name, text);
        }
    }
}

fn rooms() -> Vec<(String, String)> {
    let quad =
        |center: [f64; 3], u: [f64; 3], v: [f64; 3]| format!("quad = {{ center = {center:?}, u = {u:?}, v = {v:?} }}");
    let single =
        |name: &str, shape: &str, radiance: f64| (name.to_owned(), room([4.0, 4.0, 4.0], &[lamp("", shape, radiance)]));
    let ball = ball();
    let mut rooms = vec![
        single("cornell", &quad([0.0, 3.99, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.5]), 10.0),
        single("wall lamp", &quad([-1.98, 0.5, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.5]), 10.0),
        single("tall wall lamp", &quad([-1.98, 2.0, 0.0], [0.0, 1.99, 0.0], [0.0, 0.0, 1.0]), 2.0),
        single("ceiling of light", &quad([0.0, 3.99, 0.0], [1.9, 0.0, 0.0], [0.0, 0.0, 1.9]), 1.0),
        single("small lamp", &quad([0.0, 3.9, 0.0], [0.05, 0.0, 0.0], [0.0, 0.0, 0.05]), 1000.0),
        single("triangle", "triangle = { points = [[-1.9, 0.01, -1.5], [-1.9, 2, 0], [-1.9, 0.01, 1.5]] }", 5.0),
        single("mesh of 528", &ball, 10.0),
        single("box lamp", "cube = { center = [0, 3, 0], size = 0.6 }", 10.0),
    ];
    for count in [2, 10, 100, 1000, 10_000, 100_000] {
        // Lamps of different brightness in a hall that grows with their number.
        let side = 4.0 * libm::sqrt(f64::from(count) / 10.0).max(1.0);
        let mut random = 1u64;
        let mut number = || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 11) as f64 / (1u64 << 53) as f64
        };
        let lamps: Vec<String> = (0..count)
            .map(|i| {
                let [x, y, z] = [(number() - 0.5) * 0.98 * side, 2.6 + 1.2 * number(), (number() - 0.5) * 0.98 * side];
                let shape = match i % 3 {
                    0 => format!("sphere = {{ center = [{x}, {y}, {z}], radius = 0.03 }}"),
                    1 => quad([x, y, z], [0.05, 0.0, 0.0], [0.0, 0.0, 0.05]),
                    _ => quad([x, y, z], [0.05, 0.0, 0.02], [0.0, 0.05, 0.0]),
                };
                lamp(&(i % 7).to_string(), &shape, 20.0 * libm::exp2((i % 7) as f64 / 2.0))
            })
            .collect();
        // Seen from below the lamps, because their edges would otherwise cause most of the noise.
        let hall = room([side, 4.0, side], &lamps).replace("look_at = [0, 1.8, 0]", "look_at = [0, 0, -0.5]");
        let rest_start = hall.find("look_at").expect("a camera");
        let place = format!("[camera]\nposition = [0, 2.4, {}]\n", 0.4 * side.min(16.0));
        rooms.push((format!("{count} lamps"), place + &hall[rest_start..]));
    }
    rooms
}

/// Returns a lamp. Its material, after `#`, is written only once for each kind.
fn lamp(kind: &str, shape: &str, radiance: f64) -> String {
    format!(
        "[[object]]\nshape.{shape}\nmaterial = \"lamp{kind}\"\n#[material.lamp{kind}]\nemissive = {{ radiance = {radiance} }}\n"
    )
}

/// Returns a room with white walls and two blocks, seen from its open front.
fn room([x, y, z]: [f64; 3], lamps: &[String]) -> String {
    let (mut objects, mut materials) = (String::new(), Vec::new());
    for lamp in lamps {
        let (object, material) = lamp.split_once('#').expect("an object and a material");
        objects += object;
        if !materials.contains(&material) {
            materials.push(material);
        }
    }
    let (x, z) = (0.5 * x, 0.5 * z);
    let wall = |center: [f64; 3], u: [f64; 3], v: [f64; 3], material: &str| {
        format!("[[object]]\nshape.quad = {{ center = {center:?}, u = {u:?}, v = {v:?} }}\nmaterial = \"{material}\"\n")
    };
    let h = 0.5 * y;
    format!(
        "[camera]\nposition = [0, 2, {}]\nlook_at = [0, 1.8, 0]\nvertical_fov = 40\n\
         [film]\nwidth = 64\nheight = 48\n[render]\nmodel = \"rgb\"\ndiffuse_bounces = 3\n\
         [material.white]\ndiffuse = {{ reflectance = 0.7 }}\n[material.red]\ndiffuse = {{ reflectance = {{ rgb = [0.6, 0.1, 0.1] }} }}\n",
        (z + 4.0).min(14.0)
    ) + &materials.concat()
        + &wall([0.0, 0.0, 0.0], [x, 0.0, 0.0], [0.0, 0.0, z], "white")
        + &wall([0.0, y, 0.0], [x, 0.0, 0.0], [0.0, 0.0, z], "white")
        + &wall([0.0, h, -z], [x, 0.0, 0.0], [0.0, h, 0.0], "white")
        + &wall([-x, h, 0.0], [0.0, h, 0.0], [0.0, 0.0, z], "red")
        + &wall([x, h, 0.0], [0.0, h, 0.0], [0.0, 0.0, z], "white")
        + "[[object]]\nshape.cube = { center = [0.7, 0.6, 0.5], size = [1.1, 1.2, 1.1] }\nmaterial = \"white\"\n\
           [[object]]\nshape.cube = { center = [-0.7, 1.2, -0.5], size = [1.1, 2.4, 1.1] }\nmaterial = \"white\"\n"
        + &objects
}

/// Returns a ball of triangles under the ceiling.
fn ball() -> String {
    let (rings, around) = (11, 24);
    let mut points = vec![[0.0, 3.5, 0.0], [0.0, 2.9, 0.0]];
    for (ring, step) in (1..=rings).flat_map(|ring| (0..around).map(move |step| (ring, step))) {
        let (sin, cos) = libm::sincos(std::f64::consts::PI * f64::from(ring) / f64::from(rings + 1));
        let (s, c) = libm::sincos(std::f64::consts::TAU * f64::from(step) / f64::from(around));
        points.push([0.3 * sin * s, 3.2 + 0.3 * cos, 0.3 * sin * c]);
    }
    let vertex = |ring: i32, step: i32| 2 + (ring - 1) * around + step % around;
    let mut faces = Vec::new();
    for step in 0..around {
        faces.push([0, vertex(1, step), vertex(1, step + 1)]);
        for ring in 1..rings {
            faces.push([vertex(ring, step), vertex(ring + 1, step), vertex(ring + 1, step + 1)]);
            faces.push([vertex(ring, step), vertex(ring + 1, step + 1), vertex(ring, step + 1)]);
        }
        faces.push([1, vertex(rings, step + 1), vertex(rings, step)]);
    }
    format!("mesh = {{ points = {points:?}, faces = {faces:?} }}")
}

/// Renders images of several seeds on one thread and prints their time and noise.
fn measure(name: &str, text: String) {
    let source = Source { path: "bench.toml".into(), text };
    let scene = source.compile().expect("the scene is valid");
    let method = plan(&scene).method;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread can be started");
    let (mut times, mut images) = (Vec::new(), Vec::new());
    for seed in 0..SEEDS {
        let world = prepare(&scene, Method { seed, samples: SAMPLES, ..method.clone() });
        let (film, seconds) = pool.install(|| {
            let (start, before) = (Instant::now(), processor_time());
            let film = render(&world, &|_| ()).0;
            let seconds = match (before, processor_time()) {
                (Some(before), Some(after)) => after - before,
                _ => start.elapsed().as_secs_f64(),
            };
            (film, seconds)
        });
        images.push(film);
        times.push(seconds);
    }
    times.sort_by(f64::total_cmp);
    let seconds = times[times.len() / 2];
    let (error, mean, sigma) = relative_error(&images);
    println!("{name:24} {seconds:8.3} {error:11.3e} {:13.4e}   {mean:.5} +- {sigma:.5}", seconds * error);
}

/// Returns the seconds that this thread has run, if the system reports them.
fn processor_time() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(text.split_whitespace().next()?.parse::<f64>().ok()? * 1e-9)
}

/// Returns the mean variance over the mean square, and the mean with its standard error.
fn relative_error(images: &[Film]) -> (f64, f64, f64) {
    let count = images.len() as f64;
    let (mut variance, mut square, mut sum) = (0.0, 0.0, 0.0);
    let pixels = images[0].pixels.len();
    for pixel in 0..pixels {
        for channel in 0..3 {
            let values = images.iter().map(|image| f64::from(image.pixels[pixel].rgb[channel]));
            let average = values.clone().sum::<f64>() / count;
            variance += values.map(|x| (x - average) * (x - average)).sum::<f64>() / (count - 1.0);
            square += average * average;
            sum += average;
        }
    }
    let values = 3.0 * pixels as f64;
    // The bands of a pixel share their random numbers. Pixels share none.
    (variance / square, sum / values, (3.0 * variance / count).sqrt() / values)
}

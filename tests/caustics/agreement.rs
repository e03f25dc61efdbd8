//! The same image with the light pass and without it, where lamps are large enough to be met by chance.

use abbe::film::Film;
use abbe::plan::plan;
use abbe::trace::{LightPass, Method, World, render};

use crate::support::scenes::{SPLITTING, moments, scene, standard_errors};

/// Pixels along each side of the images, and blocks that are compared.
const SIDE: usize = 24;
const BLOCKS: usize = 4;
const SEEDS: u64 = 16;

/// Camera and film; `film` may add a filter.
fn seen_by(camera: &str, film: &str) -> String {
    format!("[camera]\n{camera}\n[film]\nwidth = {SIDE}\nheight = {SIDE}\n{film}\n")
}

const ABOVE: &str = "position = [2.5, 3.5, 2.5]\nlook_at = [0, 0, 0]\nvertical_fov = 30";
const FLOOR: &str = "[material.floor]\ndiffuse = { reflectance = 0.8 }\n[[object]]\nmaterial = \"floor\"\n\
                     shape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }\n";
const LAMP: &str = "[material.lamp]\nemissive = { radiance = 5 }\n";

fn object(material: &str, shape: &str) -> String {
    format!("[[object]]\nmaterial = \"{material}\"\nshape.{shape}\n")
}

fn glass(text: &str) -> String {
    format!("[material.glass]\ndielectric = {{ {text} }}\n")
}

/// Mean and variance of the mean of every block and band.
fn blocks(text: &str, pass: bool, samples: u32) -> Vec<(f64, f64)> {
    let scene = scene(text);
    let lights = (0..scene.lights.len()).collect();
    let light_pass = pass.then_some(LightPass { photons: u64::from(samples) * (SIDE * SIDE) as u64, lights });
    let asked = Method { samples, transport: SPLITTING, light_pass, ..plan(&scene).method };
    let films: Vec<Film> =
        (0..SEEDS).map(|seed| render(&World::new(&scene, Method { seed, ..asked.clone() }), &|_| ()).0).collect();
    let mut found = Vec::new();
    for (block, band) in (0..BLOCKS * BLOCKS).flat_map(|block| (0..3).map(move |band| (block, band))) {
        let wide = SIDE / BLOCKS;
        let corner = [block % BLOCKS * wide, block / BLOCKS * wide];
        let inside = |i: usize| (corner[1] + i / wide) * SIDE + corner[0] + i % wide;
        let of_film = |film: &Film| {
            (0..wide * wide).map(|i| f64::from(film.pixels[inside(i)].rgb[band])).sum::<f64>() / (wide * wide) as f64
        };
        let (mean, variance) = moments(films.iter().map(of_film));
        found.push((mean, variance / SEEDS as f64));
    }
    found
}

/// Compares all blocks, and says that the light pass changed something: most of it is quieter.
fn agree(what: &str, text: &str, samples: u32) {
    let (with, without) = (blocks(text, true, samples), blocks(text, false, samples));
    // Means of 16 films have the tails of Student's t with 30 degrees of freedom: 1.25 times those of the normal one so
    // far out.
    let limit = 1.25 * standard_errors(with.len());
    let (mut worst, mut squares, mut quieter) = (0.0_f64, 0.0, 0);
    for (a, b) in with.iter().zip(&without) {
        let rounding = 1e-6 * (a.0 + b.0);
        let z = (a.0 - b.0).abs() / ((a.1 + b.1).sqrt() + rounding);
        worst = worst.max(z);
        squares += z * z;
        quieter += i32::from(a.1 < b.1);
    }
    let sums = [&with, &without].map(|found| found.iter().map(|x| x.0).sum::<f64>());
    let error = with.iter().zip(&without).map(|(a, b)| a.1 + b.1).sum::<f64>().sqrt();
    let whole = (sums[0] - sums[1]) / error;
    let gain = without.iter().map(|x| x.1).sum::<f64>() / with.iter().map(|x| x.1).sum::<f64>();
    println!(
        "{what}: worst z {worst:.2} of {limit:.2}, mean square {:.2}, whole {whole:.2}, variance {gain:.2} x, quieter {quieter}, mean {:.5} {:.5}",
        squares / with.len() as f64,
        sums[0] / with.len() as f64,
        sums[1] / with.len() as f64
    );
    assert!(worst < limit, "{what}: {worst} standard errors apart");
    // Bands of a block move together, so the sum of all has a few times the error of independent ones.
    assert!(whole.abs() < 3.0 * 3.0_f64.sqrt(), "{what}: the whole is {whole} standard errors apart");
    assert!(with != without, "{what}: the light pass did nothing");
}

#[test]
fn a_glass_ball_under_a_round_lamp() {
    let text = seen_by(ABOVE, "")
        + FLOOR
        + LAMP
        + &glass("index = 1.5")
        + &object("glass", "sphere = { center = [0, 1.5, 0], radius = 1 }")
        + &object("lamp", "sphere = { center = [0, 7, 0], radius = 1 }");
    agree("ball", &text, 64);
}

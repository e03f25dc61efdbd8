//! A filter with negative lobes: sharp edges, and values beside the image that stay in range.

use abbe::Image;
use abbe::film::{Film, Filter, Layer, Mitchell};
use abbe::plan::plan;
use abbe::trace::{LightPass, Method, Smoothness};

use super::{ROOM, assert_sum, render_text, rgb_of};
use crate::support::larger::larger;
use crate::support::scenes::{film_of, films_of, mean_and_variance, scene, sigma_limit};

/// Pixels along each side of images of an edge.
const SIDE: usize = 8;
/// Positions of the square's edges on the film.
const EDGE: [f64; 2] = [3.3, 4.85];

/// Returns the corner of an emissive square with nothing behind it. One unit is a pixel.
fn corner(filter: &str, more: &str) -> String {
    let [right, bottom] = [EDGE[0] - 4.0, 4.0 - EDGE[1]];
    format!(
        "camera = {{ position = [0, 0, 5], look_at = [0, 0, 0], projection = \"orthographic\", height = 8 }}\n\
         film = {{ width = {SIDE}, height = {SIDE}, filter = {filter} }}\n\
         material.lamp.emissive.radiance = 1\n\
         object = [{{ shape.quad = {{ center = [{:?}, {:?}, 0], u = [20, 0, 0], v = [0, 20, 0] }}, material = \"lamp\" }}]\n{more}",
        right - 20.0,
        bottom + 20.0
    )
}

/// Returns the integral of a cubic filter up to x: equation 8 of Mitchell & Netravali 1988, integrated piece by piece.
fn integral(b: f64, c: f64, x: f64) -> f64 {
    let inner = [6.0 - 2.0 * b, 0.0, -18.0 + 12.0 * b + 6.0 * c, 12.0 - 9.0 * b - 6.0 * c];
    let outer = [8.0 * b + 24.0 * c, -12.0 * b - 48.0 * c, 6.0 * b + 30.0 * c, -b - 6.0 * c];
    let within =
        |piece: [f64; 4], x: f64| (0..4).map(|i| piece[i] * x.powi(i as i32 + 1) / (i as f64 + 1.0) / 6.0).sum::<f64>();
    let size = x.abs().min(2.0);
    let half = within(inner, size.min(1.0)) + within(outer, size.max(1.0)) - within(outer, 1.0);
    0.5 + half.copysign(x)
}

fn films(text: &str, samples: u32, seeds: u64) -> Vec<Film> {
    let scene = scene(text);
    films_of(&scene, &Method { samples, ..plan(&scene).method }, 0..seeds)
}

#[test]
fn an_edge_is_the_integral_of_the_filter_for_few_samples_and_many() {
    for (b, c, samples, seeds) in [
        (1.0 / 3.0, 1.0 / 3.0, 64, 64),
        (0.0, 0.5, 16, 256),
        (0.0, 1.0, 4, 1024),
        (1.0, 0.0, 16, 64),
        (0.2, 0.9, 3, 1024),
    ] {
        let films = films(&corner(&format!("{{ mitchell = {{ b = {b:?}, c = {c:?} }} }}"), ""), samples, seeds);
        let one = Filter::Mitchell(Mitchell { b, c }).absolute_integral();
        let (mut beyond, mut noisy) = (0, 0);
        for place in 0..SIDE * SIDE {
            let at = |axis: usize, i: usize| integral(b, c, EDGE[axis] - i as f64 - 0.5);
            let expected = at(0, place % SIDE) * at(1, place / SIDE);
            let (mean, variance) = mean_and_variance(films.iter().map(|film| f64::from(film.pixels[place].rgb[1])));
            // Adds one more sample on the square, for pixels where hardly any sample hits it, and the rounding to 32
            // bits.
            let error = (variance / seeds as f64).sqrt() + one / (f64::from(samples) * seeds as f64) + 1e-7;
            let z = (mean - expected).abs() / error;
            assert!(z < sigma_limit(5 * SIDE * SIDE), "b {b}, c {c}, pixel {place}: {mean} is {z} off {expected}");
            beyond += u32::from(!(0.0..=1.0).contains(&expected));
            noisy += u32::from(variance > 1e-9);
        }
        assert!((beyond > 0) == (c > 0.0) && noisy > 10, "b {b}, c {c}: {beyond} beyond, {noisy} noisy");
    }
}

#[test]
fn alpha_is_filtered_as_light_is_and_stays_within_0_and_1() {
    for film in films(&corner("\"mitchell\"", ""), 64, 8) {
        for pixel in &film.pixels {
            // The square has a radiance of 1.
            assert_eq!(pixel.alpha, pixel.rgb[0].clamp(0.0, 1.0));
        }
        let rgb = || film.pixels.iter().map(|pixel| pixel.rgb[0]);
        assert!(rgb().any(|x| x < -0.01) && rgb().any(|x| x > 1.01), "nothing rings");
    }
}

#[test]
fn an_even_image_has_no_noise() {
    for filter in ["\"mitchell\"", "{ mitchell = { b = 0, c = 1 } }"] {
        let sky = corner(filter, "light = [{ environment = { radiance = 0.7 } }]\n")
            .replace("radiance = 1\n", "radiance = 0.7\n");
        for samples in [1, 2, 3, 16, 100] {
            for film in films(&sky, samples, 4) {
                assert!(film.pixels.iter().all(|pixel| (pixel.rgb[1] - 0.7).abs() <= 2.0 * f32::EPSILON), "{samples}");
            }
        }
    }
}

/// The halves of an even image have no noise either. Each of them is an image of its own samples.
#[test]
fn halves_of_an_even_image_have_no_noise() {
    let sky = corner("\"mitchell\"", "light = [{ environment = { radiance = 1 } }]\n");
    for samples in [4, 16, 17, 100] {
        let image = render_text(&format!("{sky}render.samples = {samples}\n"), &[Layer::HalfA, Layer::HalfB]);
        for half in ["half_a.G", "half_b.G"] {
            let worst =
                image.layer(half).expect("a layer").into_iter().fold(0.0, |most: f32, x| larger(most, (x - 1.0).abs()));
            assert!(worst <= 4.0 * f32::EPSILON, "{half} of {samples} samples: {worst}");
        }
    }
}

fn room() -> Image {
    render_text(&ROOM.replace("height = 28", "height = 28, filter = \"mitchell\""), &Layer::all())
}

#[test]
fn layers_of_light_add_up_to_a_sharpened_image() {
    let image = room();
    assert_sum(&image, &["emission", "background", "direct", "indirect"], 1.0);
    let lobes = ["diffuse", "glossy", "specular", "transmission"];
    let split = lobes.map(|lobe| [format!("{lobe}_direct"), format!("{lobe}_indirect")]);
    let split: Vec<&str> = split.as_flattened().iter().map(String::as_str).collect();
    assert_sum(&image, &[&["emission", "background"], split.as_slice()].concat(), 1.0);
    assert_sum(&image, &["light_key_lamp", "light_environment", "light_rim"], 1.0);
    assert_sum(&image, &["half_a", "half_b"], 0.5);
    let caustics = image.layer("caustics.G").expect("a layer");
    assert!(caustics.iter().any(|x| *x < 0.0) && caustics.iter().any(|x| *x > 0.0));
}

#[test]
fn surface_layers_count_only_samples_of_positive_weight() {
    let image = room();
    let layer = |name: &str| image.layer(name).unwrap_or_else(|| panic!("no layer {name}"));
    let within = |name: &str, low: f32, high: f32| {
        let beyond = layer(name).into_iter().find(|x| !(low..=high).contains(x));
        assert_eq!(beyond, None, "{name} is beyond {low} to {high}");
    };
    within("A", 0.0, 1.0);
    ["albedo.R", "albedo.G", "albedo.B"].iter().for_each(|name| within(name, 0.0, 1.0));
    within("samples.V", 8.0, 8.0);
    within("variance.G", 0.0, f32::MAX);
    let normals = ["N.X", "N.Y", "N.Z"].map(layer);
    let matte: Vec<Vec<f32>> =
        (0..3).flat_map(|i| ["g", "a"].map(|channel| layer(&format!("CryptoObject{i:02}.{channel}")))).collect();
    let (mut all, mut part) = (0, 0);
    for place in 0..normals[0].len() {
        let length = normals.iter().map(|axis| axis[place] * axis[place]).sum::<f32>().sqrt();
        assert!(length <= 1.0 + 4.0 * f32::EPSILON, "a normal of length {length}");
        let ranks: Vec<f32> = matte.iter().map(|rank| rank[place]).collect();
        let sum: f32 = ranks.iter().sum();
        assert!(ranks.iter().all(|x| *x >= 0.0) && ranks.is_sorted_by(|a, b| a >= b), "{ranks:?}");
        assert!(sum <= 1.0 + 4.0 * f32::EPSILON, "{ranks:?}");
        all += u32::from((sum - 1.0).abs() < 1e-6);
        part += u32::from(sum > 0.0 && sum < 0.999);
    }
    assert!(all > 100 && part > 20, "{all} covered, {part} in part");
}

#[test]
fn layers_change_no_bit_of_a_sharpened_image() {
    let text = ROOM.replace("height = 28", "height = 28, filter = \"mitchell\"");
    let (plain, layered) = (render_text(&text, &[]), room());
    for channel in ["R", "G", "B", "A", "Z"] {
        assert!(plain.layer(channel) == layered.layer(channel), "{channel}");
    }
}

/// The variance layer agrees with the variance of many images, where samples are no more even than random ones.
#[test]
fn the_variance_is_that_of_the_sharpened_image() {
    let text = "camera = { position = [0, 0, 0.9], look_at = [0, 0, -1], vertical_fov = 70 }\n\
                film = { width = 6, height = 6, filter = { mitchell = { b = 0, c = 0.7 } } }\n\
                render = { samples = 24, diffuse_bounces = 1, model = \"rgb\" }\n\
                material.white.diffuse.reflectance = 0.9\nmaterial.lamp.emissive.radiance = 5\n\
                [[object]]\nshape.cube = { center = [0, 0, 0], size = 2 }\nmaterial = \"white\"\n\
                [[object]]\nshape.sphere = { center = [0.6, 0.6, -0.6], radius = 0.1 }\nmaterial = \"lamp\"\n";
    let mut scene = scene(text);
    scene.format.layers = vec![Layer::Variance];
    let films = films_of(&scene, &plan(&scene).method, 0..48);
    let (mut seen, mut predicted) = (0.0, 0.0);
    for place in 0..36 {
        seen += mean_and_variance(films.iter().map(|film| f64::from(film.pixels[place].rgb[1]))).1;
        predicted += films.iter().map(|film| rgb_of(film, "variance", place, 1)).sum::<f64>() / films.len() as f64;
    }
    // As with any filter, evenly spread samples make the image less noisy than random ones.
    assert!(predicted / seen > 0.9 && predicted / seen < 2.5, "{predicted} is said, {seen} is seen");
}

/// A mirror sends photons to the middle of a floor. With any filter, the pixels together receive all of their light.
#[test]
fn photons_are_spread_by_the_filter_with_its_sign() {
    let caustic = |filter: &str| {
        let mut scene = scene(&format!(
            "camera = {{ position = [0, 5, 0], look_at = [0, 0, 0], up = [0, 0, -1], projection = \"orthographic\", height = 4 }}\n\
             film = {{ width = 24, height = 24, filter = \"{filter}\" }}\n\
             material.white.diffuse.reflectance = 0.8\nmaterial.silver.mirror.reflectance = 0.9\n\
             [[object]]\nshape.plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}\nmaterial = \"white\"\n\
             [[object]]\nshape.quad = {{ center = [-1, 1.2, 0], u = [0, 0.15, 0], v = [0, 0, 0.15] }}\nmaterial = \"silver\"\n\
             [[light]]\npoint = {{ position = [1, 2.4, 0], intensity = 5 }}\n"
        ));
        scene.format.layers = vec![Layer::Caustics];
        let light_pass = Some(LightPass {
            photons: 20_000,
            lights: vec![0],
            openings: Vec::new(),
            to: vec![Smoothness::Whole],
            map: None,
        });
        let method = Method { samples: 4, light_pass, ..plan(&scene).method };
        let film = film_of(&scene, method);
        film.layers[0].channel(1).map(f64::from).collect::<Vec<f64>>()
    };
    let (even, sharp) = (caustic("box"), caustic("mitchell"));
    let [sum, sharp_sum] = [&even, &sharp].map(|light| light.iter().sum::<f64>());
    assert!(sum > 0.0 && (sharp_sum / sum - 1.0).abs() < 1e-5, "{sum} and {sharp_sum}");
    let [most, least] = [even.iter().copied().fold(0.0, larger), sharp.iter().copied().fold(0.0, f64::min)];
    assert!(least < -0.01 * most, "{least} beside {most}");
}

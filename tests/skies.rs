//! An image around the scene lights it as its pixels say, in bands and in wavelengths.
//!
//! ```text
//! cargo test --release --test all skies::
//! ```

use std::f64::consts::PI;
use std::path::Path;

use abbe::film::Film;
use abbe::math::DVec3;
use abbe::plan::plan;
use abbe::scene::{Scene, Source};
use abbe::spectrum::Curve;
use abbe::trace::{Method, prepare, render};
use exr::prelude::write_rgb_file;

use crate::support::pictures::radiance;
use crate::support::scenes::{Mean, view};

/// Dim ground, a brighter sky with a little of every color, and a sun of a few texels near the zenith of +x.
const WIDTH: usize = 32;

fn texel(x: usize, y: usize) -> [f32; 3] {
    match (x, y) {
        (7..=8, 3) => [900.0, 700.0, 300.0],
        (_, 0..=7) => [0.2 + 0.02 * x as f32, 0.5, 0.9 - 0.05 * y as f32],
        _ => [0.1, 0.08, 0.02 * (x % 3) as f32],
    }
}

/// What the convention says is seen in a direction, written without a look at the renderer's own reading.
fn color(direction: DVec3) -> [f64; 3] {
    let longitude = direction.x.atan2(direction.z);
    let x = (0.5 - longitude / (2.0 * PI)) * WIDTH as f64 - 0.5;
    let y = direction.y.clamp(-1.0, 1.0).acos() / PI * (WIDTH / 2) as f64 - 0.5;
    let at = |i: f64, j: f64| {
        let column = (i.rem_euclid(WIDTH as f64)) as usize % WIDTH;
        texel(column, j.clamp(0.0, (WIDTH / 2 - 1) as f64) as usize)
    };
    let (left, above) = (x.floor(), y.floor());
    std::array::from_fn(|c| {
        let value = |i: f64, j: f64| f64::from(at(left + i, above + j)[c]);
        let (u, v) = (x - left, y - above);
        (1.0 - v) * ((1.0 - u) * value(0.0, 0.0) + u * value(1.0, 0.0))
            + v * ((1.0 - u) * value(0.0, 1.0) + u * value(1.0, 1.0))
    })
}

fn write_sky(folder: &Path) {
    write_rgb_file(folder.join("sky.exr"), WIDTH, WIDTH / 2, |x, y| {
        let [r, g, b] = texel(x, y);
        (r, g, b)
    })
    .unwrap();
}

fn read(folder: &Path, text: &str) -> Scene<Curve> {
    let source = Source { path: folder.join("scene.toml"), text: text.to_owned() };
    source.compile().unwrap_or_else(|error| panic!("{error}"))
}

/// Images of a small white floor that faces the zenith, seen from above.
fn films(model: &str, turn: f64, seeds: u64) -> Vec<Film> {
    let folder = tempfile::tempdir().unwrap();
    write_sky(folder.path());
    let text = format!(
        "{}up = [0, 0, -1]\n[render]\nmodel = {model}\nsamples = 64\n[material.white]\ndiffuse = {{ reflectance = 0.5 }}\n\
         [[object]]\nshape.quad = {{ center = [0, 0, 0], u = [0, 0, 2], v = [2, 0, 0] }}\nmaterial = \"white\"\n\
         [[light]]\nenvironment = {{ radiance = {{ image = \"sky.exr\", scale = 2 }}, \
         transform = [{{ rotate = {{ axis = [1, 0, 0], degrees = {turn} }} }}] }}\n",
        view([0.0, 4.0, 0.0], [0.0, 0.0, 0.0], 20.0, 8).replace("[film]", "CAMERA\n[film]")
    );
    // The view looks straight down, so it needs another up.
    let (camera, film) = text.split_once("CAMERA\n").unwrap();
    let text = format!("{camera}up = [0, 0, -1]\n{}", film.replacen("up = [0, 0, -1]\n", "", 1));
    let scene = read(folder.path(), &text);
    let method = plan(&scene).method;
    let seeded = |seed| Method { seed, ..method.clone() };
    (0..seeds).map(|seed| render(&prepare(&scene, seeded(seed)), &|_| ()).0).collect()
}

/// Irradiance over pi of the floor when the image is turned about +x.
fn expected(turn: f64) -> [f64; 3] {
    const STEPS: usize = 1500;
    let (sin, cos) = turn.to_radians().sin_cos();
    let mut sum = [0.0; 3];
    for i in 0..STEPS {
        for j in 0..2 * STEPS {
            // Uniform in the squared sine, so that each direction counts as a diffuse floor weighs it.
            let (u, angle) = ((i as f64 + 0.5) / STEPS as f64, PI * (j as f64 + 0.5) / STEPS as f64);
            let (radius, y) = (u.sqrt(), (1.0 - u).sqrt());
            let (x, z) = (radius * angle.cos(), radius * angle.sin());
            // From the world back into the image.
            let seen = color(DVec3::new(x, cos * y + sin * z, cos * z - sin * y));
            (0..3).for_each(|c| sum[c] += seen[c] / (2 * STEPS * STEPS) as f64);
        }
    }
    sum
}

#[test]
fn an_image_lights_a_floor_as_its_pixels_say() {
    for turn in [0.0, 70.0] {
        let expected = expected(turn).map(|x| 0.5 * 2.0 * x);
        for model in ["\"rgb\"", "{ bands = 16 }"] {
            let mean = Mean::over_seeds(films(model, turn, 16).iter());
            let error = mean.worst_error(expected);
            assert!(error < 0.01, "{model}: noise {error}");
            // Sixteen wavelengths miss an rgb color by half a percent at most.
            let bias = if model.contains("bands") { 5e-3 } else { 0.0 };
            for (c, &expected) in expected.iter().enumerate() {
                let off = (mean.value[c] - expected).abs();
                let limit = 3.5 * mean.error[c] + (bias + 1e-3) * expected;
                assert!(off <= limit, "{model}, {turn} degrees, channel {c}: {} for {expected}", mean.value[c]);
            }
        }
    }
}

#[test]
fn an_image_is_seen_where_the_convention_says() {
    let folder = tempfile::tempdir().unwrap();
    write_sky(folder.path());
    for (toward, right_model) in
        [([0.3, 0.5, 0.8], "\"rgb\""), ([-0.9, 0.1, 0.2], "\"rgb\""), ([0.5, -0.4, -0.7], "\"rgb\"")]
    {
        let text = format!(
            "{}filter = \"center\"\n[render]\nmodel = {right_model}\n[[light]]\nenvironment = {{ radiance = {{ image = \"sky.exr\" }} }}\n",
            view([0.0; 3], toward, 1.0, 1)
        );
        let scene = read(folder.path(), &text);
        let found = render(&prepare(&scene, plan(&scene).method), &|_| ()).0.pixels[0].rgb;
        let expected = color(DVec3::from(toward).normalize());
        for c in 0..3 {
            assert!(
                (f64::from(found[c]) - expected[c]).abs() < 1e-5 * (1.0 + expected[c]),
                "{toward:?}: {found:?} for {expected:?}"
            );
        }
    }
}

/// A sky of one color is that color's emission, by itself and in a gray mirror, however bright it is.
#[test]
fn an_even_image_is_the_sky_of_its_color() {
    let folder = tempfile::tempdir().unwrap();
    // Moderate colors, which sums of fully saturated ones would miss by up to 3 %, and such themselves.
    for rgb in [[0.5, 0.3, 0.15], [3.0, 4.5, 9.0], [0.2, 0.6, 0.35], [0.8, 0.3, 0.6], [0.0, 40.0, 0.0], [0.7, 0.7, 0.1]]
    {
        let [r, g, b] = rgb.map(|x| x as f32);
        write_rgb_file(folder.path().join("even.exr"), 8, 4, |_, _| (r, g, b)).unwrap();
        // What wavelengths were measured to miss is 4e-4 of the brightest number.
        for (model, tolerance) in [("{ bands = 16 }", 1e-3), ("{ bands = 32 }", 1e-3), ("\"rgb\"", 1e-6)] {
            let see = |radiance: &str| {
                let text = format!(
                    "{}[render]\nmodel = {model}\nsamples = 4\n[material.paint]\n\
                     mirror = {{ reflectance = 0.5 }}\n[[object]]\n\
                     shape.sphere = {{ center = [0, 0, 0], radius = 1 }}\nmaterial = \"paint\"\n\
                     [[light]]\nenvironment = {{ radiance = {radiance} }}\n",
                    view([0.0, 0.0, 6.0], [0.0; 3], 25.0, 8)
                );
                let scene = read(folder.path(), &text);
                let film = render(&prepare(&scene, plan(&scene).method), &|_| ()).0;
                // A corner shows the sky, the middle its mirror image. Colored ones would show that spectra of one
                // color differ.
                [film.pixels[0].rgb, film.pixels[36].rgb].map(|rgb| rgb.map(f64::from))
            };
            let [found, expected] = [see("{ image = \"even.exr\" }"), see(&format!("{{ rgb = {rgb:?} }}"))];
            for (found, expected) in [(found[0], expected[0]), (found[1], expected[1])] {
                let brightest = expected.into_iter().fold(0.0, f64::max);
                for c in 0..3 {
                    let off = (found[c] - expected[c]).abs() / brightest;
                    assert!(off <= tolerance, "{rgb:?} in {model}: {found:?}, not {expected:?}");
                }
            }
        }
    }
}

/// Files that were cut off or damaged are refused in words, whatever byte is hit.
#[test]
fn a_damaged_image_never_stops_the_program() {
    let folder = tempfile::tempdir().unwrap();
    write_sky(folder.path());
    let texels: Vec<[f32; 3]> = (0..WIDTH * WIDTH / 2).map(|i| texel(i % WIDTH, i / WIDTH)).collect();
    let radiance = radiance(WIDTH, &texels);
    let openexr = std::fs::read(folder.path().join("sky.exr")).unwrap();
    let mut random = crate::support::random::Random::new(5);
    for (name, whole) in [("sky.exr", openexr), ("sky.hdr", radiance)] {
        let text = format!(
            "{}[[light]]\nenvironment = {{ radiance = {{ image = \"{name}\" }} }}\n",
            view([0.0; 3], [0.0, 0.0, 1.0], 30.0, 4)
        );
        let source = Source { path: folder.path().join("scene.toml"), text };
        let mut readable = 0;
        for round in 0..1500 {
            let mut bytes = whole.clone();
            let within =
                |random: &mut crate::support::random::Random, most: usize| (random.number() * most as f64) as usize;
            match round % 3 {
                0 => bytes.truncate(within(&mut random, whole.len())),
                1 => {
                    let at = within(&mut random, whole.len().min(600));
                    bytes[at] = within(&mut random, 256) as u8;
                }
                _ => (0..4).for_each(|_| {
                    let at = within(&mut random, whole.len());
                    bytes[at] ^= 1 << within(&mut random, 8);
                }),
            }
            std::fs::write(folder.path().join(name), &bytes).unwrap();
            readable += usize::from(source.compile().is_ok());
        }
        assert!((1..1500).contains(&readable), "{name}: {readable} of 1500 damaged files were read");
    }
}

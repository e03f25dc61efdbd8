//! An image around the scene lights it as its pixels say, in bands and in wavelengths.
//!
//! ```text
//! cargo test --release --test all skies::
//! ```

use std::f64::consts::PI;
use std::path::Path;

use abbe::math::DVec3;
use abbe::plan::plan;
use abbe::scene::Source;
use exr::prelude::write_rgb_file;

use crate::support::larger::larger;
use crate::support::pictures::radiance;
use crate::support::random::Random;
use crate::support::scenes::{Mean, film_of, films_of, scene_in, view};

/// Dim ground, a brighter sky with a little of every color, and a sun of a few texels near the zenith of +x.
const WIDTH: usize = 32;

fn texel(x: usize, y: usize) -> [f32; 3] {
    match (x, y) {
        (7..=8, 3) => [900.0, 700.0, 300.0],
        (_, 0..=7) => [0.2 + 0.02 * x as f32, 0.5, 0.9 - 0.05 * y as f32],
        _ => [0.1, 0.08, 0.02 * (x % 3) as f32],
    }
}

/// Returns the color in a direction according to the convention, written independently of the renderer's own reader.
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

/// Renders a small white floor that faces the zenith, seen from above, and returns its mean.
fn mean(model: &str, turn: f64) -> Mean {
    let folder = tempfile::tempdir().unwrap();
    write_sky(folder.path());
    // The view looks straight down, so it needs another up vector.
    let text = format!(
        "{}[render]\nmodel = {model}\nsamples = 64\n[material.white]\ndiffuse = {{ reflectance = 0.5 }}\n\
         [[object]]\nshape.quad = {{ center = [0, 0, 0], u = [0, 0, 2], v = [2, 0, 0] }}\nmaterial = \"white\"\n\
         [[light]]\nenvironment = {{ radiance = {{ image = \"sky.exr\", scale = 2 }}, \
         transform = [{{ rotate = {{ axis = [1, 0, 0], degrees = {turn} }} }}] }}\n",
        view([0.0, 4.0, 0.0], [0.0; 3], 20.0, 8).replace("[film]", "up = [0, 0, -1]\n[film]")
    );
    let scene = scene_in(folder.path(), &text);
    Mean::over_seeds(&films_of(&scene, &plan(&scene).method, 0..16))
}

/// Returns the irradiance over pi of the floor if the image is turned about +x.
fn expected(turn: f64) -> [f64; 3] {
    const STEPS: usize = 1500;
    let (sin, cos) = turn.to_radians().sin_cos();
    let mut sum = [0.0; 3];
    for i in 0..STEPS {
        for j in 0..2 * STEPS {
            // Uniform in the squared sine, so that directions are weighted as a diffuse floor weights them.
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
            let mean = mean(model, turn);
            let error = mean.worst_relative_error(expected);
            assert!(error < 0.01, "{model}: noise {error}");
            // Sixteen wavelengths have an error of at most half a percent for an rgb color.
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
        let scene = scene_in(folder.path(), &text);
        let found = film_of(&scene, plan(&scene).method).pixels[0].rgb;
        let expected = color(DVec3::from(toward).normalize());
        for c in 0..3 {
            assert!(
                (f64::from(found[c]) - expected[c]).abs() < 1e-5 * (1.0 + expected[c]),
                "{toward:?}: {found:?} for {expected:?}"
            );
        }
    }
}

/// A sky of one color has the emission of that color, seen directly and in a gray mirror, however bright it is.
#[test]
fn an_even_image_is_the_sky_of_its_color() {
    let folder = tempfile::tempdir().unwrap();
    // Moderate colors, which sums of fully saturated ones would miss by up to 3 %, and saturated colors themselves.
    for rgb in [[0.5, 0.3, 0.15], [3.0, 4.5, 9.0], [0.2, 0.6, 0.35], [0.8, 0.3, 0.6], [0.0, 40.0, 0.0], [0.7, 0.7, 0.1]]
    {
        let [r, g, b] = rgb.map(|x| x as f32);
        write_rgb_file(folder.path().join("even.exr"), 8, 4, |_, _| (r, g, b)).unwrap();
        // The measured error of wavelengths is 4e-4 of the brightest number.
        for (model, tolerance) in [("{ bands = 16 }", 1e-3), ("{ bands = 32 }", 1e-3), ("\"rgb\"", 1e-6)] {
            let seen_color = |radiance: &str| {
                let text = format!(
                    "{}[render]\nmodel = {model}\nsamples = 4\n[material.paint]\n\
                     mirror = {{ reflectance = 0.5 }}\n[[object]]\n\
                     shape.sphere = {{ center = [0, 0, 0], radius = 1 }}\nmaterial = \"paint\"\n\
                     [[light]]\nenvironment = {{ radiance = {radiance} }}\n",
                    view([0.0, 0.0, 6.0], [0.0; 3], 25.0, 8)
                );
                let scene = scene_in(folder.path(), &text);
                let film = film_of(&scene, plan(&scene).method);
                // A corner shows the sky, the middle its mirror image. A colored mirror would show that spectra of one
                // color differ.
                [film.pixels[0].rgb, film.pixels[36].rgb].map(|rgb| rgb.map(f64::from))
            };
            let [found, expected] =
                [seen_color("{ image = \"even.exr\" }"), seen_color(&format!("{{ rgb = {rgb:?} }}"))];
            for (found, expected) in [(found[0], expected[0]), (found[1], expected[1])] {
                let brightest = expected.into_iter().fold(0.0, larger);
                for c in 0..3 {
                    let off = (found[c] - expected[c]).abs() / brightest;
                    assert!(off <= tolerance, "{rgb:?} in {model}: {found:?}, not {expected:?}");
                }
            }
        }
    }
}

/// A convex body that sees nothing but a uniform sky has no noise, however dark it is. Bounces are not ended because
/// their surface is dark.
#[test]
fn dark_bodies_under_an_even_sky_have_no_noise() {
    for reflectance in [0.5, 0.03, 0.001] {
        let text = format!(
            "{}[render]\nsamples = 4\n[material.paint]\ndiffuse = {{ reflectance = {reflectance} }}\n\
             [[object]]\nshape.sphere = {{ center = [0, 0, 0], radius = 1 }}\nmaterial = \"paint\"\n\
             [[light]]\nenvironment = {{ radiance = 1 }}\n",
            view([0.0, 0.0, 6.0], [0.0; 3], 10.0, 8)
        );
        let scene = scene_in(Path::new("."), &text);
        let film = film_of(&scene, plan(&scene).method);
        for (number, pixel) in film.pixels.iter().enumerate() {
            let off = f64::from(pixel.rgb[1]) / reflectance - 1.0;
            assert!(off.abs() <= 1e-5, "{reflectance}: pixel {number} is off by {off}");
        }
    }
}

/// Truncated or damaged files are refused with a message, whatever byte is hit.
#[test]
fn a_damaged_image_never_stops_the_program() {
    let folder = tempfile::tempdir().unwrap();
    write_sky(folder.path());
    let texels: Vec<[f32; 3]> = (0..WIDTH * WIDTH / 2).map(|i| texel(i % WIDTH, i / WIDTH)).collect();
    let radiance = radiance(WIDTH, &texels);
    let openexr = std::fs::read(folder.path().join("sky.exr")).unwrap();
    let mut random = Random::new(5);
    for (name, whole) in [("sky.exr", openexr), ("sky.hdr", radiance)] {
        let text = format!(
            "{}[[light]]\nenvironment = {{ radiance = {{ image = \"{name}\" }} }}\n",
            view([0.0; 3], [0.0, 0.0, 1.0], 30.0, 4)
        );
        let source = Source { path: folder.path().join("scene.toml"), text };
        let mut readable = 0;
        for round in 0..1500 {
            std::fs::write(folder.path().join(name), random.damaged(&whole, round)).unwrap();
            readable += usize::from(source.compile().is_ok());
        }
        assert!((1..1500).contains(&readable), "{name}: {readable} of 1500 damaged files were read");
    }
}

//! Scenes written as text in a test, rendered, and their means judged.

use std::ops::Range;
use std::path::PathBuf;

use abbe::film::Film;
use abbe::scene::{Scene, Source};
use abbe::spectrum::{Basis, Curve};
use abbe::trace::{Method, Report, Transport, prepare, render};

/// Follows every branch down to a weight that no pixel can show.
pub const EVERY_BRANCH: Transport = Transport::Deterministic { cutoff: 1e-20, most: u64::MAX };
/// What the plan takes where light is left to chance.
pub const SPLITTING: Transport = Transport::Random { split: 0.05, roulette: 0.05 };
/// The path tracer: one branch at every surface, one light at every vertex.
pub const SINGLE_PATH: Transport = Transport::Random { split: 1.0, roulette: 0.05 };
/// A polarizer and a wave plate before the middle of a room, so that light has all components of Stokes vectors.
pub const SHEETS: &str = r#"
[material.sheet]
polarizer = { axis = [1, 0.5, 0], extinction = 0.05 }
[material.plate]
retarder = { axis = [0, 1, 0], retardation_nm = 200 }
[[object]]
shape.quad = { center = [0, 0.9, 3], u = [0.5, 0, 0], v = [0, 0.6, 0] }
material = "sheet"
[[object]]
shape.quad = { center = [0.3, 0.9, 3.3], u = [0.4, 0, 0], v = [0, 0.6, 0] }
material = "plate"
"#;

/// The world that a text without mistakes describes.
pub fn scene(text: &str) -> Scene<Curve> {
    let source = Source { path: PathBuf::from("test.toml"), text: text.to_owned() };
    source.compile().unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// The tables of a scene's camera and of a square film.
pub fn view(position: [f64; 3], look_at: [f64; 3], vertical_fov: f64, side: u32) -> String {
    format!(
        "[camera]\nposition = {position:?}\nlook_at = {look_at:?}\nvertical_fov = {vertical_fov:?}\n\
         [film]\nwidth = {side}\nheight = {side}\n"
    )
}

/// A material and objects of it.
pub fn body(name: &str, material: &str, shapes: &[&str]) -> String {
    let objects = shapes.iter().map(|shape| format!("[[object]]\nshape.{shape}\nmaterial = \"{name}\"\n"));
    format!("[material.{name}]\n{material}\n{}", objects.collect::<String>())
}

/// A light of the same radiance everywhere around.
pub fn environment(radiance: f64) -> String {
    format!("[[light]]\nenvironment = {{ radiance = {radiance:?} }}\n")
}

/// How the scene asks to be rendered, by a given transport.
pub fn method(scene: &Scene<Curve>, transport: Transport) -> Method {
    Method {
        samples: scene.render.samples.unwrap_or(1),
        diffuse_bounces: scene.render.diffuse_bounces.unwrap_or(u32::MAX),
        max_bounces: scene.render.max_bounces.unwrap_or(u32::MAX),
        ..Method::of_paths(Basis::rgb(scene.film.color_space), transport, scene.render.seed)
    }
}

/// The image of a scene by a given transport.
pub fn image(text: &str, transport: Transport) -> (Film, Report) {
    let scene = scene(text);
    let method = method(&scene, transport);
    render(&prepare(&scene, method), &|_| ())
}

/// Images of one scene under different seeds.
pub fn images(text: &str, transport: Transport, seeds: u64) -> Vec<(Film, Report)> {
    images_from(text, transport, 0, seeds)
}

/// The same from another first seed.
pub fn images_from(text: &str, transport: Transport, first: u64, seeds: u64) -> Vec<(Film, Report)> {
    let scene = scene(text);
    let seeded = |seed| Method { seed, ..method(&scene, transport) };
    (first..first + seeds).map(|seed| render(&prepare(&scene, seeded(seed)), &|_| ())).collect()
}

/// The film of a scene by a method.
pub fn film_of(scene: &Scene<Curve>, method: Method) -> Film {
    render(&prepare(scene, method), &|_| ()).0
}

/// Films of a scene by a method, under other seeds.
pub fn films_of(scene: &Scene<Curve>, method: &Method, seeds: Range<u64>) -> Vec<Film> {
    seeds.map(|seed| film_of(scene, Method { seed, ..method.clone() })).collect()
}

/// A mean of each band with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mean {
    pub value: [f64; 3],
    pub error: [f64; 3],
}

impl Mean {
    /// Of a film whose pixels all see the same thing: they share no random numbers, so their spread is the error.
    pub fn of(film: &Film) -> Self {
        let bands = [0, 1, 2].map(|band| {
            let (mean, variance) = moments(film.pixels.iter().map(|pixel| f64::from(pixel.rgb[band])));
            (mean, (variance / film.pixels.len() as f64).sqrt())
        });
        Self { value: bands.map(|band| band.0), error: bands.map(|band| band.1) }
    }

    /// Of films under different seeds, whose pixels may see different things: the error is each pixel's own.
    pub fn over_seeds<'a>(films: impl Iterator<Item = &'a Film> + Clone) -> Self {
        let pixels = films.clone().next().map_or(0, |film| film.pixels.len());
        let seeds = films.clone().count() as f64;
        let bands = [0, 1, 2].map(|band| {
            let of_pixel = |i: usize| moments(films.clone().map(move |film| f64::from(film.pixels[i].rgb[band])));
            let (mean, variance) = (0..pixels).map(of_pixel).fold((0.0, 0.0), |sum, m| (sum.0 + m.0, sum.1 + m.1));
            (mean / pixels as f64, (variance / seeds).sqrt() / pixels as f64)
        });
        Self { value: bands.map(|band| band.0), error: bands.map(|band| band.1) }
    }

    /// Every band lies within 3 standard errors of what is expected, wider only for many claims made together.
    ///
    /// One claim errs by chance in 0.27 % of the cases and so do `claims` of them together (Sidak 1967).
    pub fn assert_near(&self, expected: [f64; 3], claims: usize, what: &str) {
        let limit = standard_errors(claims);
        for band in 0..3 {
            let (value, error, expected) = (self.value[band], self.error[band], expected[band]);
            // Lanes are f32: a pixel that no chance reaches is still rounded at each of some dozen surfaces.
            let rounding = 32.0 * f64::from(f32::EPSILON) * expected.abs();
            let off = (value - expected).abs();
            assert!(
                off <= limit * error + rounding,
                "{what}: band {band} is {value} +- {error:.1e} for {expected}, off by {:.2} sigma",
                off / error
            );
        }
    }

    /// The largest standard error of a band relative to what is expected there.
    pub fn worst_error(&self, expected: [f64; 3]) -> f64 {
        (0..3).map(|band| self.error[band] / expected[band]).fold(0.0, f64::max)
    }
}

/// Mean and unbiased variance.
pub fn moments(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let count = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / count;
    (mean, values.map(|value| (value - mean) * (value - mean)).sum::<f64>() / (count - 1.0))
}

/// How many standard errors all of `claims` independent means keep within in 99.73 % of the cases.
pub fn standard_errors(claims: usize) -> f64 {
    let chance = -libm::expm1(libm::log1p(-0.0027) / claims as f64);
    let (mut low, mut high) = (2.0, 10.0);
    for _ in 0..60 {
        let middle: f64 = 0.5 * (low + high);
        let outside = libm::erfc(middle * std::f64::consts::FRAC_1_SQRT_2);
        if outside > chance { low = middle } else { high = middle }
    }
    low
}

//! Renders scenes written as text in a test, and judges their means.

use std::fmt::Debug;
use std::ops::Range;
use std::path::Path;

use abbe::film::Film;
use abbe::scene::{Scene, Source};
use abbe::spectrum::{Basis, Curve};
use abbe::trace::{Method, Report, Transport, prepare, render};
use abbe::{Diagnostic, Error, Image, Options};

use super::larger::larger;

/// Follows every branch down to a weight that no pixel can resolve.
pub const EVERY_BRANCH: Transport = Transport::Deterministic { cutoff: 1e-20, max_sample_surfaces: u64::MAX };
/// The plan's choice where light is sampled randomly.
pub const SPLITTING: Transport = Transport::Random { split: 0.05, roulette: 0.05 };
/// The path tracer: one branch at every surface and one light at every vertex.
pub const SINGLE_PATH: Transport = Transport::Random { split: 1.0, roulette: 0.05 };
/// A polarizer and a wave plate in front of the middle of a room, so that its light has all Stokes components.
pub const POLARIZING_SHEETS: &str = r#"
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

/// The plane y = 0.
pub const GROUND: &str = "plane = { point = [0, 0, 0], normal = [0, 1, 0] }";
/// The radiance of the two kinds of [`lamps`].
const RADIANCE: &str = "{ rgb = [10, 20, 5] }";

/// Compiles a scene from a text without mistakes.
pub fn scene(text: &str) -> Scene<Curve> {
    scene_in(Path::new(""), text)
}

/// Compiles a scene from a text that may name files in a folder.
pub fn scene_in(folder: &Path, text: &str) -> Scene<Curve> {
    let source = Source { path: folder.join("scene.toml"), text: text.to_owned() };
    source.compile().unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// Returns the first mistake in a text that must be refused. The text may name files in a folder.
pub fn first_mistake(folder: &Path, text: &str) -> Diagnostic {
    let source = Source { path: folder.join("scene.toml"), text: text.to_owned() };
    match source.compile() {
        Err(Error::Scene(mistakes)) => mistakes[0].clone(),
        other => panic!("{other:?}\n{text}"),
    }
}

/// Renders a text as its plan decides, on one thread.
pub fn render_text(text: &str) -> Image {
    render_text_with(text, &Options { threads: Some(1), ..Options::default() })
}

/// Renders a text with the given options.
pub fn render_text_with(text: &str, options: &Options) -> Image {
    let scene = Scene::parse(text, "").unwrap_or_else(|error| panic!("{error}\n{text}"));
    abbe::render(&scene, options).expect("it renders")
}

/// Returns the camera and the film of one pixel that looks along -z at hardly more than a point. `camera` and `film`
/// add more keys, each after a comma.
pub fn one_pixel(camera: &str, film: &str) -> String {
    format!(
        "camera = {{ position = [0, 0, 5], look_at = [0, 0, 0], projection = \"orthographic\", height = 1e-6{camera} }}\n\
         film = {{ width = 1, height = 1, filter = \"center\"{film} }}\n"
    )
}

/// Returns the tables of a camera and a square film.
pub fn view(position: [f64; 3], look_at: [f64; 3], vertical_fov: f64, side: u32) -> String {
    format!(
        "[camera]\nposition = {position:?}\nlook_at = {look_at:?}\nvertical_fov = {vertical_fov:?}\n\
         [film]\nwidth = {side}\nheight = {side}\n"
    )
}

/// Returns an object whose material is defined elsewhere.
pub fn object(material: &str, shape: &str) -> String {
    format!("[[object]]\nshape.{shape}\nmaterial = \"{material}\"\n")
}

/// Returns a material and objects made of it.
pub fn body(name: &str, material: &str, shapes: &[&str]) -> String {
    let objects = shapes.iter().map(|shape| object(name, shape));
    format!("[material.{name}]\n{material}\n{}", objects.collect::<String>())
}

/// Returns a parallelogram with the given center and half edges.
pub fn quad(center: impl Into<[f64; 3]>, u: impl Into<[f64; 3]>, v: impl Into<[f64; 3]>) -> String {
    format!("quad = {{ center = {:?}, u = {:?}, v = {:?} }}", center.into(), u.into(), v.into())
}

/// Returns two versions of a lamp: an emissive one that is sampled by next-event estimation, and black glass with the
/// same emission that only random paths hit.
pub fn lamps(shapes: &[&str]) -> [String; 2] {
    let dark = "index = 1.5, reflectance = 0, transmittance = 0, priority = 9";
    [
        body("lamp", &format!("emissive = {{ radiance = {RADIANCE} }}"), shapes),
        body("lamp", &format!("dielectric = {{ {dark}, emission = {RADIANCE} }}"), shapes),
    ]
}

/// Returns a uniform environment light.
pub fn environment(radiance: f64) -> String {
    format!("[[light]]\nenvironment = {{ radiance = {radiance:?} }}\n")
}

/// Returns the method that the scene's render settings ask for, with the given transport.
pub fn method(scene: &Scene<Curve>, transport: Transport) -> Method {
    Method {
        samples: scene.render.samples.unwrap_or(1),
        diffuse_bounces: scene.render.diffuse_bounces.unwrap_or(u32::MAX),
        max_bounces: scene.render.max_bounces.unwrap_or(u32::MAX),
        ..Method::of_paths(Basis::rgb(scene.film.color_space), transport, scene.render.seed)
    }
}

/// Renders a text with the given transport.
pub fn render_film(text: &str, transport: Transport) -> (Film, Report) {
    render_film_in(Path::new(""), text, transport)
}

/// Renders a text that may name files in a folder, with the given transport.
pub fn render_film_in(folder: &Path, text: &str, transport: Transport) -> (Film, Report) {
    let scene = scene_in(folder, text);
    let method = method(&scene, transport);
    render(&prepare(&scene, method), &|_| ())
}

/// Renders a text with the given transport under each of the seeds from 0.
pub fn render_films(text: &str, transport: Transport, seeds: u64) -> Vec<(Film, Report)> {
    let scene = scene(text);
    let setup = method(&scene, transport);
    (0..seeds).map(|seed| render(&prepare(&scene, Method { seed, ..setup.clone() }), &|_| ())).collect()
}

/// Renders a scene with a method and returns its film.
pub fn film_of(scene: &Scene<Curve>, method: Method) -> Film {
    render(&prepare(scene, method), &|_| ()).0
}

/// Renders a scene with a method under several seeds and returns the films.
pub fn films_of(scene: &Scene<Curve>, method: &Method, seeds: Range<u64>) -> Vec<Film> {
    seeds.map(|seed| film_of(scene, Method { seed, ..method.clone() })).collect()
}

/// Returns the mean of each band over a film.
pub fn mean_color(film: &Film) -> [f64; 3] {
    [0, 1, 2]
        .map(|band| film.pixels.iter().map(|pixel| f64::from(pixel.rgb[band])).sum::<f64>() / film.pixels.len() as f64)
}

/// The mean of each band with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mean {
    pub value: [f64; 3],
    pub error: [f64; 3],
}

impl Mean {
    /// Computes the mean over a film whose pixels all see the same thing. Pixels share no random numbers, so their
    /// spread gives the error.
    pub fn of(film: &Film) -> Self {
        let bands = [0, 1, 2].map(|band| {
            let (mean, variance) = mean_and_variance(film.pixels.iter().map(|pixel| f64::from(pixel.rgb[band])));
            (mean, (variance / film.pixels.len() as f64).sqrt())
        });
        Self { value: bands.map(|band| band.0), error: bands.map(|band| band.1) }
    }

    /// Computes the mean over films under different seeds, whose pixels may see different things. The error of each
    /// pixel is estimated by itself.
    pub fn over_seeds(films: &[Film]) -> Self {
        let (pixels, seeds) = (films[0].pixels.len(), films.len() as f64);
        let bands = [0, 1, 2].map(|band| {
            let of_pixel =
                |i: usize| mean_and_variance(films.iter().map(move |film| f64::from(film.pixels[i].rgb[band])));
            let (mean, variance) = (0..pixels).map(of_pixel).fold((0.0, 0.0), |sum, m| (sum.0 + m.0, sum.1 + m.1));
            (mean / pixels as f64, (variance / seeds).sqrt() / pixels as f64)
        });
        Self { value: bands.map(|band| band.0), error: bands.map(|band| band.1) }
    }

    /// Renders a text under each of the seeds from 0 and computes the mean.
    pub fn render_text(text: &str, transport: Transport, seeds: u64) -> Self {
        let scene = scene(text);
        Self::over_seeds(&films_of(&scene, &method(&scene, transport), 0..seeds))
    }

    /// Multiplies each band by a factor.
    pub fn times(&self, factors: [f64; 3]) -> Self {
        let scaled = |of: [f64; 3]| std::array::from_fn(|band| of[band] * factors[band]);
        Self { value: scaled(self.value), error: scaled(self.error) }
    }

    /// Keeps the value and takes the standard error of its difference from another mean.
    pub fn with_joint_error(&self, other: &Self) -> Self {
        Self { error: std::array::from_fn(|band| libm::hypot(self.error[band], other.error[band])), ..*self }
    }

    /// Asserts that every band lies within 3 standard errors of the expected value. The limit is wider if several
    /// claims are made together.
    ///
    /// A single claim fails by chance in 0.27 % of the cases, and so do all `claims` together (Sidak 1967).
    pub fn assert_near(&self, expected: [f64; 3], claims: usize, what: &str) {
        let limit = sigma_limit(claims);
        for band in 0..3 {
            let (value, error, expected) = (self.value[band], self.error[band], expected[band]);
            // Lanes are f32: even a pixel without noise is rounded at each of some dozen surfaces.
            let rounding = 32.0 * f64::from(f32::EPSILON) * expected.abs();
            let off = (value - expected).abs();
            assert!(
                off <= limit * error + rounding,
                "{what}: band {band} is {value} +- {error:.1e} for {expected}, off by {:.2} sigma",
                off / error
            );
        }
    }

    /// Returns the largest standard error of a band relative to its expected value.
    pub fn worst_relative_error(&self, expected: [f64; 3]) -> f64 {
        (0..3).map(|band| self.error[band] / expected[band]).fold(0.0, larger)
    }
}

/// Asserts that every number lies within a tolerance of its expected value.
pub fn assert_near<T: Copy + Debug + Into<f64>, const N: usize>(
    found: [T; N],
    expected: [f64; N],
    tolerance: f64,
    what: &str,
) {
    let near = (0..N).all(|i| (found[i].into() - expected[i]).abs() <= tolerance);
    assert!(near, "{what}: {found:?} for {expected:?}");
}

/// Asserts that a lamp contributes the same with next-event estimation, to one light or to all, as when only random
/// paths hit it. The standard error of the difference must be less than `share` of the value.
pub fn assert_next_event_agrees([sampled, hit_only]: [&str; 2], seeds: u64, share: f64, claims: usize, what: &str) {
    let by_chance = Mean::render_text(hit_only, SINGLE_PATH, seeds);
    for transport in [SINGLE_PATH, SPLITTING] {
        let estimate = Mean::render_text(sampled, transport, seeds).with_joint_error(&by_chance);
        println!("{what}: {estimate:.5?} for {by_chance:.5?}");
        assert!(estimate.worst_relative_error(by_chance.value) < share, "{what}: {estimate:?}");
        estimate.assert_near(by_chance.value, claims, what);
    }
}

/// Returns the mean and the unbiased variance.
pub fn mean_and_variance(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let count = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / count;
    (mean, values.map(|value| (value - mean) * (value - mean)).sum::<f64>() / (count - 1.0))
}

/// Returns how many standard errors bound all of `claims` independent means in 99.73 % of the cases.
pub fn sigma_limit(claims: usize) -> f64 {
    let chance = -libm::expm1(libm::log1p(-0.0027) / claims as f64);
    let (mut low, mut high) = (2.0, 10.0);
    for _ in 0..60 {
        let middle: f64 = 0.5 * (low + high);
        let outside = libm::erfc(middle * std::f64::consts::FRAC_1_SQRT_2);
        if outside > chance { low = middle } else { high = middle }
    }
    low
}

//! Color spaces are views of the same light, blackbodies have their published colors, and `rgb` colors survive the
//! conversion to spectra.
//!
//! ```text
//! cargo test --release --test all colors::
//! ```

use abbe::film::Film;
use abbe::plan::plan;
use abbe::spectrum::{Basis, ColorSpace, Curve, CurveKind, Draw, Emission, MAX_LANES, Quantity, apply, visible};
use abbe::trace::{Method, Transport};

use crate::support::larger::larger;
use crate::support::random::Random;
use crate::support::scenes::{assert_near, film_of, scene};

const SPACES: [ColorSpace; 6] = [
    ColorSpace::Rec709,
    ColorSpace::AcesCg,
    ColorSpace::Aces2065,
    ColorSpace::Rec2020,
    ColorSpace::P3D65,
    ColorSpace::Xyz,
];
const MODELS: [&str; 6] =
    ["\"rgb\"", "{ bands = 8 }", "{ bands = 12 }", "{ bands = 16 }", "{ bands = 32 }", "\"hero\""];
/// Lights are not selected by their brightness, which is measured in film colors, so all films share their random
/// numbers.
const ALL_LIGHTS: Transport = Transport::Deterministic { cutoff: 1e-4, max_sample_surfaces: u64::MAX };

/// Returns a scene in a color space and under a spectral model.
fn text(body: &str, space: ColorSpace, model: &str, caustics: &str) -> String {
    format!(
        "film = {{ width = 16, height = 12, color_space = \"{}\" }}\n\
         render = {{ model = {model}, samples = 2, diffuse_bounces = 1, caustics = \"{caustics}\" }}\n\
         camera = {{ position = [0, 1, 6], look_at = [0, 0.8, 0], vertical_fov = 35 }}\n{body}",
        space.interop_id()
    )
}

/// Renders a scene in several color spaces under a model. The number of photons, and whether polarization matters, are
/// planned only once, with samples that do select lights.
fn films<const S: usize>(body: &str, spaces: [ColorSpace; S], model: &str) -> [Film; S] {
    let caustics = |space| if space == spaces[0] { "auto" } else { "off" };
    let scenes = spaces.map(|space| scene(&text(body, space, model, caustics(space))));
    let methods = scenes.each_ref().map(|scene| plan(scene).method);
    let Method { light_pass, polarization, .. } = &methods[0];
    std::array::from_fn(|i| {
        let (light_pass, polarization) = (light_pass.clone(), *polarization);
        let method = Method { transport: ALL_LIGHTS, light_pass, polarization, ..methods[i].clone() };
        film_of(&scenes[i], method)
    })
}

/// Measured lights and surfaces of every kind, but nothing that is relative to the film's white.
const MEASURED: &str = r#"
material.floor.diffuse.reflectance = "blue sky"
material.red.mirror.reflectance = "red"
material.glass.dielectric.index = "N-SF11"
material.gold.conductor.metal = "Au"
material.lamp.emissive.radiance = { illuminant = "FL11", scale = 3 }
[[object]]
shape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }
material = "floor"
[[object]]
shape.sphere = { center = [-0.9, 0.7, 0.5], radius = 0.7 }
material = "glass"
[[object]]
shape.disc = { center = [0.3, 1, -1], normal = [-0.1, 0.1, 1], radius = 1 }
material = "red"
[[object]]
shape.sphere = { center = [1.4, 0.6, 0.2], radius = 0.6 }
material = "gold"
[[object]]
shape.quad = { center = [0, 3, 0], u = [1, 0, 0], v = [0, 0, 1] }
material = "lamp"
"#;
const OTHER_LIGHTS: &str = r#"
[[light]]
environment.radiance = { blackbody = 3000, luminance = 0.2 }
[[light]]
sun = { toward = [1, 2, 3], irradiance = { lines = [[445, 1], [532, 2], [638, 3]] } }
"#;
const SAME_LIGHT: &str = r#"
[[light]]
environment.radiance = { illuminant = "FL11", luminance = 0.2 }
"#;

#[test]
fn a_measured_scene_is_the_same_xyz_in_every_color_space() {
    for model in MODELS {
        // In three bands, surfaces have their color under the only light, or under the film's white if there are
        // several lights.
        let lights = if model == "\"rgb\"" { SAME_LIGHT } else { OTHER_LIGHTS };
        let films = films(&format!("{MEASURED}{lights}"), SPACES, model);
        let mut worst = 0.0_f64;
        for at in 0..films[0].pixels.len() {
            let [expected, others @ ..] = SPACES.map(|space| {
                let film = films.iter().find(|film| film.color_space == space).expect("one film for each space");
                apply(&space.to_xyz(), film.pixels[at].rgb.map(f64::from))
            });
            let most = expected.iter().fold(0.0, |most: f64, x| larger(most, *x));
            assert!(most > 1e-3, "{model}: pixel {at} is dark");
            for (space, xyz) in SPACES[1..].iter().zip(others) {
                let off = (0..3).fold(0.0, |off: f64, c| larger(off, (xyz[c] - expected[c]).abs())) / most;
                worst = larger(worst, off);
                assert!(off <= 1e-6, "{model}, {space:?}, pixel {at}: {xyz:?} for {expected:?}, off by {off:.2e}");
            }
        }
        println!("{model}: off by {worst:.1e} at most");
    }
}

/// A plain number and `rgb` are relative to the film's white. What stays the same is not the XYZ but Rec.709 adapted to
/// that white.
#[test]
fn rgb_lights_and_surfaces_have_their_rec709_color_in_every_color_space_adapted_to_its_white() {
    let color = [0.2, 0.5, 0.7];
    let sky = format!("[[light]]\nenvironment.radiance.rgb = {color:?}\n");
    let wall = format!(
        "material.wall.diffuse.reflectance.rgb = {color:?}\n[[object]]\nmaterial = \"wall\"\n\
         shape.plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }}\n[[light]]\nenvironment.radiance = 1\n"
    );
    for model in MODELS {
        for (body, limit) in [(&sky, 1e-7), (&wall, missed(model))] {
            for film in films(body, SPACES, model) {
                for pixel in &film.pixels {
                    let found = apply(&film.color_space.to_rec709(), pixel.rgb.map(f64::from));
                    assert_near(found, color, limit, &format!("{model}, {:?}, {body}", film.color_space));
                }
            }
        }
    }
}

/// Returns the error that a model may have for a smooth reflectance. `rgb` and lights have only rounding errors.
fn missed(model: &str) -> f64 {
    match model {
        "\"rgb\"" => 1e-7,
        "{ bands = 8 }" => 2e-3,
        _ => 1e-4,
    }
}

fn xy([x, y, z]: [f64; 3]) -> [f64; 2] {
    [x / (x + y + z), y / (x + y + z)]
}

fn xy_of_blackbody(kelvin: f64) -> [f64; 2] {
    xy(Emission::new(&CurveKind::Blackbody(kelvin).into(), ColorSpace::Xyz).xyz())
}

#[test]
fn blackbodies_have_their_published_chromaticities() {
    // CIE 15:2018, illuminant A: a blackbody at 2848 K for c2 = 0.01435, which is 2855.5 K for the current c2.
    assert_near(xy_of_blackbody(2855.5), [0.4476, 0.4074], 5e-5, "2855.5 K");
    // Wyszecki & Stiles 1982, *Color Science*, table 1(3.11).
    assert_near(xy_of_blackbody(3000.0), [0.4369, 0.4041], 5e-5, "3000 K");
    // An infinitely hot body, with a radiance of wavelength^-4.
    assert_near(xy_of_blackbody(1e9), [0.2399, 0.2340], 5e-5, "1e9 K");
}

/// For a blackbody at 6504 K, (0.3135, 0.3237) is often published. That is the sum over steps of 10 nm. The renderer
/// integrates color in steps of 1 nm, which gives (0.3135, 0.3236).
#[test]
fn the_printed_chromaticity_of_6504_kelvin_is_that_of_coarse_steps() {
    assert_near(xy_of_blackbody(6504.0), [0.3135, 0.3236], 5e-5, "6504 K");
    let emission = Emission::new(&CurveKind::Blackbody(6504.0).into(), ColorSpace::Xyz);
    let coarse = visible::wavelengths().zip(emission.spectrum()).filter(|(nm, _)| nm % 10.0 == 0.0);
    let xyz = coarse.fold([0.0; 3], |sum, (nm, power)| {
        let cmf = visible::color_matching(nm);
        std::array::from_fn(|c| sum[c] + power * cmf[c])
    });
    assert_near(xy(xyz), [0.3135, 0.3237], 5e-5, "6504 K in steps of 10 nm");
}

/// (1.2048, 0.9483, 0.9089) is published for XYZ = (1, 1, 1) and a white of (0.95047, 1, 1.08883). The white of Rec.709
/// is (0.3127, 0.3290), which is 0.0002 more in Z, and the CIE's own functions sum to (1.00008, 1, 1.00033) in steps of
/// 1 nm.
#[test]
fn the_equal_energy_spectrum_is_pink_in_rec709_however_it_is_written() {
    let expected = apply(
        &ColorSpace::Rec709.matrix_from_xyz(),
        visible::xyz(&[1.0; visible::COUNT]).map(|x| x / visible::y_integral()),
    );
    assert_near(expected, [1.2048, 0.9483, 0.9089], 4e-4, "equal energy");
    for light in ["{ illuminant = \"E\" }", "{ samples = [[360, 1], [830, 1]] }", "{ samples = [[300, 1], [900, 1]] }"]
    {
        for model in MODELS {
            let body = format!("[[light]]\nenvironment.radiance = {light}\n");
            let [film] = films(&body, [ColorSpace::Rec709], model);
            for pixel in &film.pixels {
                assert_near(pixel.rgb.map(f64::from), expected, 1e-6, &format!("{light}, {model}"));
            }
        }
    }
}

/// Returns the color of a surface under a light, from one sample that carries all fixed lanes.
fn lit_color(basis: &Basis, surface: &Curve, light: &Curve) -> [f64; 3] {
    let draw = Draw::<MAX_LANES>::fixed(basis.fixed_lanes());
    let reflectance = draw.read(&basis.tabulate(Quantity::Reflectance, surface));
    let emission = draw.read(&basis.tabulate(Quantity::Emission, light));
    basis.response(light).film_rgb(&draw, reflectance * emission, false)
}

/// Returns the color of a spectrum under the film's white, integrated in steps of 1 nm.
fn integrated_color(space: ColorSpace, reflectance: impl Fn(f64) -> f64) -> [f64; 3] {
    let white = Emission::new(&1.0.into(), space);
    visible::wavelengths()
        .zip(white.columns())
        .fold([0.0; 3], |sum, (nm, color)| std::array::from_fn(|c| sum[c] + reflectance(nm) * color[c]))
}

fn largest_difference(found: [f64; 3], expected: [f64; 3]) -> f64 {
    (0..3).fold(0.0, |most: f64, c| larger(most, (found[c] - expected[c]).abs()))
}

/// Every random color gets a smooth spectrum. The spectrum of a nearly pure color is nearly a step or bends beyond the
/// last band. 32 bands miss it by about 1e-4.
#[test]
fn rgb_reflectances_come_back_as_themselves_under_the_films_white() {
    const COLORS: usize = 2048;
    let mut random = Random::new(5);
    for space in SPACES {
        let basis = Basis::bands(space, 32, &[]);
        let (mut worst, mut missed) = (0.0_f64, 0);
        for _ in 0..COLORS {
            let rgb = [(); 3].map(|()| random.number());
            let surface = Curve::from(CurveKind::Rgb(rgb));
            let sigmoid = basis.upsampler().fit(rgb);
            assert_eq!(sigmoid.saturation, 1.0, "{space:?}: {rgb:?}");
            assert!(visible::wavelengths().all(|nm| (0.0..=1.0).contains(&sigmoid.at(nm))), "{rgb:?}");
            let smooth = apply(&space.to_rec709(), integrated_color(space, |nm| sigmoid.at(nm)));
            assert!(largest_difference(smooth, rgb) < 1e-4, "{space:?}: {smooth:?} for {rgb:?}");

            let table = basis.tabulate(Quantity::Reflectance, &surface);
            assert!(table.bins().iter().all(|x| (0.0..=1.0).contains(x)), "{rgb:?}: {:?}", table.bins());
            let found = apply(&space.to_rec709(), lit_color(&basis, &surface, &1.0.into()));
            let off = largest_difference(found, rgb);
            worst = larger(worst, off);
            missed += usize::from(off > 1e-4);
        }
        println!("{space:?}: {missed} of {COLORS} are off by more than 1e-4, {worst:.1e} at most");
        assert!(missed <= COLORS / 20, "{space:?}: {missed} of {COLORS} are off by more than 1e-4");
    }
}

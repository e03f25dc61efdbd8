//! Cases in which spectral renderers fail: rows D10 to D15 of the stability catalog.
//!
//! ```text
//! cargo test --release --test all stability_spectra::
//! ```

use abbe::film::Film;
use abbe::math::{BranchKey, Sampler};
use abbe::plan::plan;
use abbe::spectrum::{Basis, ColorSpace, Curve, CurveKind, Draw, Emission, Lanes, Quantity, Upsampler, data, visible};
use abbe::trace::Method;

use crate::support::pictures::read_png;
use crate::support::scenes::{Mean, SPLITTING, film_of, films_of, method, scene, sigma_limit, view};

const SPACE: ColorSpace = ColorSpace::Rec709;

/// Renders a scene under different seeds.
fn films(text: &str, basis: &Basis, seeds: u64) -> Vec<Film> {
    let scene = scene(text);
    films_of(&scene, &Method { basis: basis.clone(), ..method(&scene, SPLITTING) }, 0..seeds)
}

fn heroes(light: &Curve) -> Basis {
    Basis::bands(SPACE, 12, &[]).with_heroes(4, &[Emission::new(light, SPACE)])
}

/// Returns a tilted plate of flint in front of a uniform sky, wider than the view.
fn plate(index: &str, samples: u32) -> String {
    format!(
        "{}[render]\nsamples = {samples}\n[material.flint]\ndielectric = {{ index = {index} }}\n\
         [[object]]\nshape.cube = {{ center = [0, 0, 0], size = [20, 20, 1] }}\n\
         transform = [{{ rotate = {{ axis = [0, 1, 0], degrees = 30 }} }}]\nmaterial = \"flint\"\n\
         [[light]]\nenvironment.radiance = 1\n",
        view([0.0, 0.0, 6.0], [0.0, 0.0, 0.0], 10.0, 16)
    )
}

#[test]
fn d10_white_through_a_plate_stays_white() {
    let films = films(&plate("\"N-SF11\"", 64), &heroes(&1.0.into()), 16);
    Mean::over_seeds(&films).assert_near([1.0; 3], 3, "plate");
}

#[test]
fn d11_a_dispersive_plate_is_nearly_as_quiet_as_a_plain_one() {
    let films = films(&plate("\"N-SF11\"", 1), &heroes(&1.0.into()), 64);
    let luminances: Vec<f64> = films
        .iter()
        .flat_map(|film| &film.pixels)
        .map(|pixel| {
            let [r, g, b] = pixel.rgb.map(f64::from);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        })
        .collect();
    let count = luminances.len() as f64;
    let mean = luminances.iter().sum::<f64>() / count;
    let deviation = (luminances.iter().map(|y| (y - mean) * (y - mean)).sum::<f64>() / count).sqrt();
    assert!(deviation <= 0.2, "Y of a camera sample has standard deviation {deviation}");
}

/// A glass ball on a floor under a sky. Hero wavelengths are asked for although all of them refract alike.
#[test]
fn d11_vanishing_dispersion_is_neither_tinted_nor_noisier_than_none() {
    let text = |index: &str, model: &str| {
        format!(
            "{}[render]\nsamples = 16\nmodel = {model}\n[material.glass]\ndielectric = {{ index = {index} }}\n\
             [material.floor]\ndiffuse = {{ reflectance = 0.6 }}\n\
             [[object]]\nshape.sphere = {{ center = [0, 1, 0], radius = 1 }}\nmaterial = \"glass\"\n\
             [[object]]\nshape.plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}\nmaterial = \"floor\"\n\
             [[light]]\nenvironment.radiance = 1\n",
            view([0.0, 1.2, 6.0], [0.0, 0.9, 0.0], 25.0, 24)
        )
    };
    let mean = |index: &str, model: &str, first: u64| {
        let scene = scene(&text(index, model));
        Mean::over_seeds(&films_of(&scene, &plan(&scene).method, first..first + 24))
    };
    let vanishing = mean("{ cauchy = [1.5168, 1e-6] }", "\"hero\"", 0);
    let none = mean("1.5168", "{ bands = 12 }", 100);
    for band in 0..3 {
        let (off, error) =
            ((vanishing.value[band] - none.value[band]).abs(), vanishing.with_joint_error(&none).error[band]);
        assert!(off <= sigma_limit(3) * error, "band {band}: {} and {}", vanishing.value[band], none.value[band]);
        let ratio = (vanishing.error[band] / none.error[band]).powi(2);
        assert!((0.9..1.1).contains(&ratio), "band {band}: {ratio} times the variance");
    }
}

#[test]
fn d12_a_formula_is_not_followed_beyond_its_range() {
    let upsampler = Upsampler::new(SPACE);
    for (name, nd) in [("N-BK7", 1.516_80), ("N-SF11", 1.784_72)] {
        let (curve, glass) = (Curve::from(CurveKind::glass(name).unwrap()), data::glass(name).unwrap());
        let index = curve.reader(Quantity::Index, &upsampler);
        assert!((index(587.5618) - nd).abs() <= 1e-5, "{name}: {}", index(587.5618));
        let (from, to) = glass.range_nm;
        for (beyond, edge) in [(50.0, from), (from - 1.0, from), (1e5, to), (1e7, to)] {
            assert_eq!(index(beyond), index(edge), "{name} at {beyond} nm");
        }
    }
}

/// Returns what a pixel of one sample receives of a light's own color through the heroes alone: mean and deviation of
/// every channel.
fn hero_moments(curve: &Curve) -> [(f64, f64); 3] {
    const SAMPLES: u32 = 4096;
    let basis = heroes(curve);
    let (table, response) = (basis.tabulate(Quantity::Emission, curve), basis.response(curve));
    let colors = (0..SAMPLES).map(|sample| {
        let u = Sampler::new(7, [sample, 3], 0).get_4d(BranchKey::CAMERA, 0)[2];
        let draw: Draw<16> = basis.draw(u);
        response.film_rgb(&draw, draw.read(&table) * Lanes::ONE, true)
    });
    let colors: Vec<[f64; 3]> = colors.collect();
    [0, 1, 2].map(|c| {
        let mean = colors.iter().map(|color| color[c]).sum::<f64>() / f64::from(SAMPLES);
        let variance = colors.iter().map(|color| (color[c] - mean).powi(2)).sum::<f64>() / f64::from(SAMPLES);
        (mean, variance.sqrt())
    })
}

/// Light as even as daylight, and a line of the same power, 0.1 nm wide: once as an ideal line, once as samples.
#[test]
fn d13_narrow_lines_are_neither_lost_nor_noisy() {
    let power = visible::y_integral();
    let height = power / 0.1;
    let samples = [
        [380.0, 1.0],
        [588.95, 1.0],
        [588.95001, 1.0 + height],
        [589.04999, 1.0 + height],
        [589.05, 1.0],
        [730.0, 1.0],
    ];
    let sampled = Curve::from(CurveKind::Samples(samples.into()));
    let exact = {
        let even = Emission::new(&CurveKind::Samples(vec![[380.0, 1.0], [730.0, 1.0]]).into(), SPACE).color();
        let line = Emission::new(&CurveKind::Lines(vec![[589.0, power]]).into(), SPACE).color();
        [0, 1, 2].map(|c| even[c] + line[c])
    };
    let found = Emission::new(&sampled, SPACE).color();
    for c in 0..3 {
        assert!((found[c] - exact[c]).abs() < 1e-3 * exact[0], "channel {c} is {} for {}", found[c], exact[c]);
    }
    let (mean, deviation) = hero_moments(&sampled)[0];
    assert!((mean - exact[0]).abs() < 4.0 * deviation / 64.0, "{mean} for {}", exact[0]);
    assert!(deviation / mean <= 1.1, "standard deviation {deviation} at mean {mean}");
    // With ideal lines alone, only the choice among them is random.
    let sodium = Curve::from(CurveKind::Lines(vec![[589.0, power]]));
    let color = Emission::new(&sodium, SPACE).color();
    for (c, (mean, deviation)) in hero_moments(&sodium).into_iter().enumerate() {
        assert!((mean - color[c]).abs() < 1e-6 * color[0] && deviation < 1e-6, "channel {c}: {mean} +- {deviation}");
    }
}

#[test]
fn d14_pure_colors_keep_their_negative_numbers_in_the_film_and_make_a_picture() {
    let text = format!(
        "{}[render]\nmodel = {{ bands = 16 }}\n[[light]]\nenvironment.radiance = {{ lines = [[500, 100]] }}\n",
        view([0.0, 0.0, 1.0], [0.0, 0.0, 0.0], 30.0, 4)
    );
    let scene = scene(&text);
    let film = film_of(&scene, plan(&scene).method);
    assert!(film.pixels[0].rgb[0] < -0.1, "{:?}", film.pixels[0]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pure.png");
    abbe::film::write_png(&film, 0.0, &path).unwrap();
    let [red, green, blue] = read_png(&path).pixels[0];
    assert!(red == 0 && green > 100, "{:?}", [red, green, blue]);
}

/// Compared with the closed form at two wavelengths. Their ratio does not depend on how the light is normalized.
#[test]
fn d15_a_blackbody_keeps_its_digits_from_embers_to_the_hottest_stars() {
    for kelvin in [100.0_f64, 450.0, 1000.0, 2856.0, 6504.0, 1e6, 1e9] {
        let light = Emission::new(&CurveKind::Blackbody(kelvin).into(), SPACE);
        let at = |nm: f64| light.spectrum()[(nm - visible::START_NM) as usize];
        let c2 = 1.438_776_877e7 / kelvin;
        let (a, b) = (450.0_f64, 700.0_f64);
        let expected = (b / a).powi(5) * ((c2 / b).exp_m1() / (c2 / a).exp_m1());
        let found = at(a) / at(b);
        assert!((found / expected - 1.0).abs() <= 1e-12, "{kelvin} K: {found} for {expected}");
        assert!((light.xyz()[1] - 1.0).abs() < 1e-12, "{kelvin} K has Y = {}", light.xyz()[1]);
    }
}

//! How light reaches a dye: by photons, and in wavelengths that have parted.

use abbe::film::Film;
use abbe::spectrum::{Basis, Emission};
use abbe::trace::{LightPass, MapPasses, Method, Smoothness};

use super::{BRIGHTENER, BellDye, RED, YELLOW};
use crate::support::larger::larger;
use crate::support::scenes::{
    Mean, SPLITTING, body, films_of, mean_and_variance, mean_color, method, render_text, scene, view,
};

/// Number of renders whose spread gives the noise.
const SEEDS: u64 = 4;

/// Asserts that every channel of two means agrees.
fn assert_agree(found: Mean, expected: Mean, what: &str) {
    let strongest = expected.value.iter().fold(0.0_f64, |most, x| larger(most, x.abs()));
    for c in 0..3 {
        let (off, error) = (found.value[c] - expected.value[c], found.with_joint_error(&expected).error[c]);
        println!("{what} {c}: {:.5} for {:.5} +- {error:.5}", found.value[c], expected.value[c]);
        assert!(off.abs() < 4.0 * error + 1e-6 * strongest, "{what}: {found:?} for {expected:?}");
        assert!(error < 0.02 * strongest, "{what}: the noise hides all");
    }
}

/// Returns the mean color of images under several seeds.
fn mean(films: &[Film]) -> Mean {
    let mean_of = |c: usize| {
        let (value, variance) = mean_and_variance(films.iter().map(|film| mean_color(film)[c]));
        [value, (variance / films.len() as f64).sqrt()]
    };
    let bands = [0, 1, 2].map(mean_of);
    Mean { value: bands.map(|band| band[0]), error: bands.map(|band| band[1]) }
}

/// Returns paper that is lit only by way of a mirror, or by a lamp at the place of the mirror image. The paper is seen
/// directly or in another mirror.
fn paper(dye: &BellDye, lit_by_mirror: bool, seen_in_mirror: bool) -> String {
    let (position, look_at) =
        if seen_in_mirror { ([0.0, 0.0, 2.0], [0.0, -1.0, 1.0]) } else { ([0.0, -2.0, 2.0], [0.0; 3]) };
    let lamp = if lit_by_mirror { "sphere = { center = [0, 0, 1], radius = 0.1 }" } else { SHOWN };
    let mut text = view(position, look_at, 10.0, 8)
        + &body("paper", &dye.material(), &["quad = { center = [0, 0, 0], u = [0.6, 0, 0], v = [0, 0.6, 0] }"])
        + &body("lamp", "emissive = { radiance = { illuminant = \"D65\", scale = 100 } }", &[lamp]);
    let lit_by = "quad = { center = [1.2, 0, 0.5], u = [0, 0, 0.5], v = [0, 1, 0] }";
    let seen_in = "quad = { center = [0, -1, 1], u = [0.2, 0, 0], v = [0, 0, 0.2] }";
    let mirrors = [(lit_by_mirror, lit_by), (seen_in_mirror, seen_in)];
    let mirrors: Vec<&str> = mirrors.into_iter().filter(|mirror| mirror.0).map(|mirror| mirror.1).collect();
    if !mirrors.is_empty() {
        text += &body("mirror", "mirror = {}", &mirrors);
    }
    if lit_by_mirror {
        let screen = "quad = { center = [0, 0, 0.8], u = [0.2, 0, 0], v = [0, 0.2, 0] }";
        text += &body("screen", "diffuse = { reflectance = 0 }", &[screen]);
    }
    text
}

/// The lamp at the place of its mirror image.
const SHOWN: &str = "sphere = { center = [2.4, 0, 1], radius = 0.1 }";

fn films(text: &str, basis: impl Fn(&abbe::scene::Scene) -> Basis, light_pass: Option<LightPass>) -> Vec<Film> {
    let scene = scene(text);
    let method =
        Method { basis: basis(&scene), samples: 16, light_pass, diffuse_bounces: 1, ..method(&scene, SPLITTING) };
    films_of(&scene, &method, 0..SEEDS)
}

#[test]
fn photons_excite_dyes_where_they_are_shown_and_where_they_are_gathered() {
    let lanes =
        |scene: &abbe::scene::Scene| Basis::bands_over(scene.film.color_space, 16, Basis::FROM_ULTRAVIOLET_NM, &[]);
    let heroes = |scene: &abbe::scene::Scene| {
        let lights: Vec<Emission> =
            scene.lights.iter().map(|light| Emission::new(light.emission(), scene.film.color_space)).collect();
        Basis::bands_over(scene.film.color_space, 16, Basis::FROM_ULTRAVIOLET_NM, &[]).with_heroes(4, &lights)
    };
    for dye in [YELLOW, BRIGHTENER] {
        for gathered in [false, true] {
            let map = gathered.then_some(MapPasses { count: 2, photons: 40_000, radius: 1.0, chance: 1.0 });
            let pass =
                LightPass { photons: 200_000, lights: vec![0], openings: Vec::new(), to: vec![Smoothness::Whole], map };
            let straight = mean(&films(&paper(&dye, false, gathered), lanes, None));
            let what = format!("{}, gathered {gathered}", dye.name);
            assert_agree(mean(&films(&paper(&dye, true, gathered), lanes, Some(pass.clone()))), straight, &what);
            assert_agree(
                mean(&films(&paper(&dye, true, gathered), heroes, Some(pass))),
                straight,
                &format!("{what}, heroes"),
            );
        }
    }
}

/// A dye behind a slab of dispersive glass, lit and seen through it. Heroes, which are drawn anew for the exciting
/// light, are compared with all lanes, each of which follows its own path.
#[test]
fn heroes_that_have_parted_excite_dyes_as_all_wavelengths_do() {
    let day = ("{ illuminant = \"D65\" }", None);
    // Under a single line, the lamp has no light at the wavelengths that the dye emits.
    let blue = ("{ lines = [[436, 1]] }", Some(436.0));
    let green = ("{ lines = [[546, 1]] }", Some(546.0));
    for (dye, (light, line)) in [(YELLOW, day), (RED, day), (BRIGHTENER, day), (YELLOW, blue), (RED, green)] {
        let text = view([0.8, 0.0, 3.0], [0.0, 0.0, 0.0], 8.0, 8)
            + &format!("[render]\nmax_bounces = 12\n[[light]]\nenvironment = {{ radiance = {light} }}\n")
            + &body("paper", &dye.material(), &["quad = { center = [0, 0, 0], u = [2, 0, 0], v = [0, 2, 0] }"])
            + &body(
                "slab",
                "dielectric = { index = \"N-SF11\" }",
                &["cube = { center = [0, 0, 0.45], size = [3, 3, 0.5] }"],
            );
        let scene = scene(&text);
        let lights = [Emission::new(scene.lights[0].emission(), scene.film.color_space)];
        let lines = line.as_slice();
        let lanes = Basis::bands_over(scene.film.color_space, 32 - lines.len(), Basis::FROM_ULTRAVIOLET_NM, lines);
        let heroes =
            Basis::bands_over(scene.film.color_space, 12, Basis::FROM_ULTRAVIOLET_NM, lines).with_heroes(4, &lights);
        let mean_of = |basis: Basis, samples: u32| {
            let method = Method { basis, samples, ..method(&scene, SPLITTING) };
            mean(&films_of(&scene, &method, 0..SEEDS))
        };
        // A sample of heroes has a tenth of the variance, or less.
        let times = if lines.is_empty() { 1 } else { 8 };
        let (found, expected) = (mean_of(heroes, times * 128), mean_of(lanes, times * 256));
        for c in 0..3 {
            let strongest = expected.value.iter().fold(0.0_f64, |most, x| larger(most, x.abs()));
            let (off, error) = ((found.value[c] - expected.value[c]).abs(), found.with_joint_error(&expected).error[c]);
            println!("{} {c}: {:.5} for {:.5} +- {error:.5}", dye.name, found.value[c], expected.value[c]);
            // The tolerance is the color error of lanes that stay together, of 12 and of 32.
            assert!(off < 4.0 * error + 2e-3 * strongest, "{}: {found:?} for {expected:?}", dye.name);
            assert!(error < 0.02 * strongest, "{}: the noise hides all", dye.name);
        }
    }
}

/// Light from behind dispersive glass counts as dispersed, whether paper scatters it or a dye emits it.
#[test]
fn light_of_a_dye_is_dispersed_by_glass() {
    let text = view([3.0, 0.0, 4.0], [0.0; 3], 3.0, 8)
        .replace("height = 8\n", "height = 8\nlayers = [\"dispersed\"]\n")
        + "[render]\nsamples = 64\ncaustics = \"off\"\n"
        + &body("paper", &YELLOW.material(), &["quad = { center = [0, 0, -3], u = [9, 0, 0], v = [0, 9, 0] }"])
        + &body("glass", "dielectric = { index = \"N-SF11\" }", &["cube = { center = [0, 0, 0], size = 2 }"])
        + "[[light]]\npoint = { position = [-2, 3, -1.5], intensity = 100 }\n";
    let image = render_text(&text);
    let sum = |values: &mut dyn Iterator<Item = f32>| values.map(f64::from).sum::<f64>();
    let layer = ["R", "G", "B"].map(|channel| image.layer(&format!("dispersed.{channel}")).expect("it was asked for"));
    let share = sum(&mut layer.into_iter().flatten()) / sum(&mut image.rgb().into_iter().flatten());
    assert!((share - 1.0).abs() < 1e-3, "{share}");
}

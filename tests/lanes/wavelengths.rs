//! Wavelengths travel together as if each were alone, heroes give the same result as any other wavelengths, and three
//! bands are nothing but three lanes.

use abbe::film::Film;
use abbe::scene::Scene;
use abbe::spectrum::{Basis, Curve, Emission, Response, comparison};
use abbe::trace::{Method, Transport, prepare, render};

use super::parting::{BALL_AND_PRISM, BLOCK, block};
use crate::support::scenes::{EVERY_BRANCH, Mean, SPLITTING, method, scene, sigma_limit, view};

/// Returns a ball and a prism of glass among colored objects, on a floor.
fn text(glass: &str, floor: &str, filter: &str, side: u32) -> String {
    let view = view([0.3, 1.0, 6.0], [0.1, 0.7, 0.0], 30.0, side);
    format!(
        r#"{view}filter = "{filter}"
[render]
meters_per_unit = 0.01
[material]
floor.{floor}
glass.dielectric = {glass}
silver.mirror.reflectance = "blue sky"
gold.conductor.metal = "Au"
lamp.emissive.radiance = {{ blackbody = 3200, luminance = 5 }}
sky.emissive = {{ radiance = {{ illuminant = "FL11", scale = 0.3 }}, sides = "front" }}
{BALL_AND_PRISM}"#
    )
}

const FLINT: &str = "{ index = \"N-SF11\", absorption = \"N-SF11\" }";

fn film(scene: &Scene<Curve>, basis: &Basis, transport: Transport, seed: u64, only_lane: Option<usize>) -> Film {
    let method = Method { basis: basis.clone(), seed, ..method(scene, transport) };
    let world = prepare(scene, method);
    let world = match only_lane {
        Some(lane) => world.with_responses(|response| comparison::response_of_lane(response, lane)),
        None => world,
    };
    render(&world, &|_| ()).0
}

#[test]
fn each_of_many_lanes_has_the_bits_it_has_alone() {
    let scene = scene(&text(FLINT, "mirror.reflectance = \"foliage\"", "center", 16));
    let together = Basis::bands(scene.film.color_space, 12, &[]);
    for lane in 0..12 {
        let among = film(&scene, &together, EVERY_BRANCH, 0, Some(lane));
        let alone = film(&scene, &comparison::basis_of_lane(&together, lane), EVERY_BRANCH, 0, None);
        let bits = |film: &Film| film.pixels.iter().map(|pixel| pixel.rgb.map(f32::to_bits)).collect::<Vec<_>>();
        assert_eq!(bits(&among), bits(&alone), "lane {lane}");
        assert!(among.pixels.iter().filter(|pixel| pixel.rgb[1] != 0.0).count() > 45, "lane {lane} is dark");
    }
}

const BLOCKS: u32 = 4;

/// Asserts that two ways to render a scene agree in the mean of every block and channel.
fn assert_alike(first: &[Film], second: &[Film], what: &str) {
    let limit = sigma_limit((BLOCKS * BLOCKS * 3) as usize);
    for place in 0..BLOCKS * BLOCKS {
        let [a, b] = [first, second].map(|films| {
            let blocks: Vec<Film> = films.iter().map(|film| block(film, place % BLOCKS, place / BLOCKS)).collect();
            Mean::over_seeds(&blocks)
        });
        for band in 0..3 {
            let (x, y, error) = (a.value[band], b.value[band], a.with_joint_error(&b).error[band]);
            assert!((x - y).abs() <= limit * error, "{what}, block {place}, band {band}: {x} and {y} +- {error}");
        }
    }
}

#[test]
fn a_lane_among_others_has_the_mean_it_has_alone() {
    let scene = scene(&text(FLINT, "diffuse.reflectance = \"orange\"", "box", BLOCK * BLOCKS));
    let together = Basis::bands(scene.film.color_space, 8, &[]);
    for lane in [1, 4, 6] {
        let render_seeds = |basis: &Basis, first: u64, only_lane| {
            (first..first + 24).map(|seed| film(&scene, basis, SPLITTING, seed, only_lane)).collect::<Vec<_>>()
        };
        assert_alike(
            &render_seeds(&together, 0, Some(lane)),
            &render_seeds(&comparison::basis_of_lane(&together, lane), 100, None),
            &format!("lane {lane}"),
        );
    }
}

/// Fixed lanes end where heroes part and count everywhere else. Together they give the same result as wavelengths that
/// are drawn for each path and never change.
#[test]
fn heroes_and_fixed_lanes_together_find_what_single_wavelengths_find() {
    for glass in
        [FLINT, "{ index.cauchy = [1.5168, 1e-6] }", "{ index.abbe = { nd = 1.7, vd = 20 }, transmittance = \"cyan\" }"]
    {
        let mut scene = scene(&text(glass, "diffuse.reflectance = \"orange\"", "box", BLOCK * BLOCKS));
        scene.render.samples = Some(16);
        let space = scene.film.color_space;
        let lights: Vec<Emission> = scene.lights.iter().map(|light| Emission::new(light.emission(), space)).collect();
        let heroes = Basis::bands(space, 28, &[]).with_heroes(4, &lights);
        let render_seeds = |basis: &Basis, first: u64| {
            (first..first + 24).map(|seed| film(&scene, basis, SPLITTING, seed, None)).collect::<Vec<_>>()
        };
        assert_alike(&render_seeds(&heroes, 0), &render_seeds(&comparison::collapsing(space), 100), glass);
    }
}

#[test]
fn three_bands_are_three_lanes_bit_for_bit() {
    let plain = text("{ index = \"N-SF11\" }", "mirror.reflectance = 0.4", "center", 24)
        .replace("\"blue sky\"", "0.8")
        .replace("gold.conductor.metal = \"Au\"", "gold.conductor = { n = 0.4, k = 3 }")
        .replace("{ blackbody = 3200, luminance = 5 }", "5")
        .replace("{ illuminant = \"FL11\", scale = 0.3 }", "0.3");
    let scene = scene(&plain);
    let bands = film(&scene, &Basis::rgb(scene.film.color_space), EVERY_BRANCH, 0, None);
    let lanes = Basis::wavelengths(scene.film.color_space, vec![486.13, 546.07, 656.27], &[]);
    let world = prepare(&scene, Method { basis: lanes, ..method(&scene, EVERY_BRANCH) });
    let blue_first = Response::new(&[[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]], Vec::new());
    let lanes = render(&world.with_responses(|_| blue_first.clone()), &|_| ()).0;
    assert!(bands.pixels.iter().filter(|pixel| pixel.rgb[0] != pixel.rgb[2]).count() > 50, "nothing disperses");
    for (at, (a, b)) in bands.pixels.iter().zip(&lanes.pixels).enumerate() {
        assert_eq!(a.rgb.map(f32::to_bits), b.rgb.map(f32::to_bits), "pixel {at}");
    }
}

#[test]
fn lossless_dispersive_glass_in_an_even_sky_is_1_in_every_channel() {
    for (model, space) in
        [("\"hero\"", "lin_rec709_scene"), ("{ bands = 12 }", "lin_ap1_scene"), ("\"hero\"", "lin_ap1_scene")]
    {
        let view = view([0.0, 0.0, 6.0], [0.0, 0.0, 0.0], 17.0, 24);
        let text = format!(
            "{view}color_space = \"{space}\"\n[render]\nmodel = {model}\nsamples = 64\n\
             [material.flint]\ndielectric = {{ index = \"N-SF11\" }}\n\
             [material.gem]\ndielectric = {{ index = \"diamond\" }}\n\
             [[object]]\nshape.sphere = {{ center = [0, 0, 0], radius = 1.3 }}\nmaterial = \"flint\"\n\
             [[object]]\nshape.cube = {{ center = [0, 0, 0], size = 1 }}\nmaterial = \"gem\"\n\
             transform = [{{ rotate = {{ axis = [1, 2, 3], degrees = 40 }} }}]\n\
             [[light]]\nenvironment.radiance = 1\n"
        );
        let scene = scene(&text);
        let plan = abbe::plan::plan(&scene);
        let part =
            if model.contains("bands") { Basis::bands(scene.film.color_space, 12, &[]) } else { plan.method.basis };
        let film = film(&scene, &part, SPLITTING, 3, None);
        let mean = Mean::of(&film);
        mean.assert_near([1.0; 3], 9, model);
        assert!(mean.worst_relative_error([1.0; 3]) < 1e-3, "{mean:?}");
    }
}

//! Light through panes, compared with closed forms and with paths that hit the lights at random.

use abbe::plan::plan;
use abbe::spectrum::Basis;
use abbe::trace::{Method, Transport};

use crate::support::fresnel::reflectances;
use crate::support::scenes::{
    EVERY_BRANCH, GROUND, Mean, SINGLE_PATH, SPLITTING, assert_next_event_agrees, body, film_of, lamps, method,
    render_film, scene, view,
};

const POINT: &str = "[[light]]\npoint = { position = [1.5, 3, 0.5], intensity = 10 }\n";
const SUN: &str = "[[light]]\nsun = { toward = [1, 1, 0.5], irradiance = 3, angular_diameter = 0 }\n";
const DISC: &str = "[[light]]\nsun = { toward = [1, 1, 0.5], irradiance = 3, angular_diameter = 30 }\n";
const SKY: &str = "[[light]]\nenvironment = { radiance = 2 }\n";
const LAMP: &str = "[material.lamp]\nemissive = { radiance = { rgb = [10, 20, 5] } }\n[[object]]\nmaterial = \"lamp\"\n\
    shape.quad = { center = [0, 3, 0], u = [0.5, 0, 0], v = [0, 0, 0.5] }\n";

/// Returns infinite panes at some heights.
fn panes(material: &str, heights: &[f64]) -> String {
    let shapes: Vec<String> =
        heights.iter().map(|y| format!("plane = {{ point = [0, {y:?}, 0], normal = [0, 1, 0] }}")).collect();
    body("pane", material, &shapes.iter().map(String::as_str).collect::<Vec<_>>())
}

/// Returns a floor under panes, seen from below the panes.
fn under(panes: &str, lights: &str, reflectance: &str, samples: u32) -> String {
    view([3.0, 0.8, 0.5], [0.0, 0.0, 0.0], 20.0, 12)
        + &format!("[render]\nsamples = {samples}\n")
        + &body("floor", &format!("diffuse = {{ reflectance = {reflectance} }}"), &[GROUND])
        + panes
        + lights
}

fn mean(text: &str, transport: Transport) -> Mean {
    Mean::render_text(text, transport, 8)
}

/// Returns the transmitted and the reflected share of a pane for unpolarized light at a cosine, by Fresnel's equations
/// and the sum over all internal reflections.
fn pane(n: f64, t: f64, cos: f64) -> [f64; 2] {
    let polarized_shares = |r: f64| {
        let through = (1.0 - r) * (1.0 - r) * t / (1.0 - r * r * t * t);
        [through, r + r * t * through]
    };
    let [s, p] = reflectances(n, cos).map(polarized_shares);
    [0.5 * (s[0] + p[0]), 0.5 * (s[1] + p[1])]
}

/// Returns the cosine-weighted mean over the hemisphere.
fn mean_by_cosine(value: impl Fn(f64) -> f64) -> f64 {
    let steps = 200_000;
    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(steps);
    (0..steps).map(|i| 2.0 * at(i) * value(at(i))).sum::<f64>() / f64::from(steps)
}

/// Cosine of the parallel sun.
const COS_OF_SUN: f64 = 2.0 / 3.0;

#[test]
fn l7_a_sun_shines_through_panes_as_each_lets_through() {
    let [through, _] = pane(1.52, 1.0, COS_OF_SUN);
    let tinted = [0.9, 0.5, 0.1].map(|t| pane(1.52, t, COS_OF_SUN)[0]);
    let cases = [
        ("one", "thin = { index = 1.52 }", vec![1.0], [through; 3]),
        ("two", "thin = { index = 1.52 }", vec![1.0, 1.2], [through * through; 3]),
        ("five", "thin = { index = 1.52 }", vec![0.9, 0.95, 1.0, 1.05, 1.1], [through.powi(5); 3]),
        ("tinted", "thin = { index = 1.52, transmittance = { rgb = [0.9, 0.5, 0.1] } }", vec![1.0], tinted),
        ("none", "thin = { index = 1 }", vec![1.0], [1.0; 3]),
    ];
    for (name, material, heights, expected) in cases {
        // A black floor sends nothing back to the panes.
        let text = under(&panes(material, &heights), SUN, "0.001", 1);
        let irradiance = 3.0 * COS_OF_SUN;
        for transport in [EVERY_BRANCH, SPLITTING, SINGLE_PATH] {
            if transport == EVERY_BRANCH && heights.len() > 1 {
                // Branches between several panes grow without bound.
                continue;
            }
            let found = mean(&text, transport);
            for band in 0..3 {
                let expected = expected[band] * irradiance * 0.001 / std::f64::consts::PI;
                let off = found.value[band] / expected - 1.0;
                assert!(off.abs() < 2e-3, "{name}, {transport:?}: {found:?} for {expected}");
            }
        }
    }
}

#[test]
fn an_even_sky_above_endless_panes_gives_the_irradiance_of_their_sum() {
    // Random paths find the light between floor and panes, and between the panes. It counts once.
    for (heights, reflectance) in [(vec![1.0], 0.8), (vec![1.0, 1.3], 0.8)] {
        let stack = |cos: f64| {
            let [t, r] = pane(1.52, 1.0, cos);
            if heights.len() == 1 { [t, r] } else { [t * t / (1.0 - r * r), r + t * t * r / (1.0 - r * r)] }
        };
        let [t, r] = [0, 1].map(|way| mean_by_cosine(|cos| stack(cos)[way]));
        let expected = 2.0 * t * reflectance / (1.0 - reflectance * r);
        let text = under(&panes("thin = { index = 1.52 }", &heights), SKY, &format!("{reflectance:?}"), 256);
        for transport in [SPLITTING, SINGLE_PATH] {
            let found = mean(&text, transport);
            println!("{heights:?}: {found:.6?} for {expected:.6}");
            assert!(found.worst_relative_error([expected; 3]) < 0.004, "{found:?}");
            found.assert_near([expected; 3], 18, "a sky above panes");
        }
    }
}

#[test]
fn every_light_shines_through_a_pane_as_without_it_times_its_transmittance() {
    // The light of the disc and of the lamp arrives at many angles. A pane of index 1 has the same transmittance for
    // all of them.
    for (name, lights) in [("point", POINT), ("sun", SUN), ("disc", DISC), ("lamp", LAMP), ("sky", SKY)] {
        let (tint, open) = ([0.75, 0.5, 0.1], mean(&under("", lights, "0.5", 64), SPLITTING));
        for heights in [vec![1.0], vec![1.0, 1.1, 2.0]] {
            let material = "thin = { index = 1, transmittance = { rgb = [0.75, 0.5, 0.1] } }";
            for transport in [SPLITTING, SINGLE_PATH] {
                let expected = open.times(tint.map(|t: f64| t.powi(heights.len() as i32)));
                let through =
                    mean(&under(&panes(material, &heights), lights, "0.5", 64), transport).with_joint_error(&expected);
                assert!(through.worst_relative_error(expected.value) < 0.02, "{name}: {through:?}");
                through.assert_near(expected.value, 20, name);
            }
        }
    }
}

#[test]
fn aiming_through_panes_and_meeting_the_lamp_beyond_show_the_same() {
    // The floor is rough, so both ways of finding the lamp count. One pane is tilted and part of a mask.
    let things = "[material.gold]\nconductor = { metal = \"Au\", roughness = 0.4 }\n\
        [material.inner]\nthin = { index = 1.8 }\n[material.matt]\ndiffuse = { reflectance = 0.7 }\n";
    let second = body(
        "sheet",
        "mask = { material = \"both\", opacity = 0.6 }\n[material.both]\nmix = { materials = [\"inner\", \"matt\"], amount = 0.3 }",
        &["quad = { center = [0, 1.6, 0], u = [40, 8, 0], v = [0, 0, 40] }"],
    );
    let sheets = things.to_owned() + &panes("thin = { index = 1.52 }", &[1.0]) + &second;
    let floor = |lamp: &str| under(&sheets, lamp, "0.5", 512).replace("\"floor\"\n", "\"gold\"\n");
    let [aimed_at, met] = lamps(&["sphere = { center = [0, 3, 0], radius = 0.8 }"]).map(|lamp| floor(&lamp));
    assert_next_event_agrees([&aimed_at, &met], 8, 0.02, 2, "through panes");
}

#[test]
fn a_pane_is_seen_in_alpha_and_depth_and_is_no_bounce() {
    let pane = panes("thin = { index = 1.52 }", &[]);
    let sheet = "[[object]]\nmaterial = \"pane\"\nshape.quad = { center = [0, 0, 2], u = [9, 0, 0], v = [0, 9, 0] }\n";
    let wall = body(
        "wall",
        "diffuse = { reflectance = 0.5 }",
        &["quad = { center = [0, 0, 0], u = [9, 0, 0], v = [0, 9, 0] }"],
    );
    let text =
        view([0.0, 0.0, 5.0], [0.0; 3], 1.0, 1) + "[render]\nsamples = 16\nmax_bounces = 1\n" + &pane + sheet + &wall;
    let sun = "[[light]]\nsun = { toward = [0, 0, 1], irradiance = 3, angular_diameter = 0 }\n";
    let (film, _) = render_film(&(text + sun), SPLITTING);
    assert_eq!(film.pixels[0].alpha, 1.0);
    assert!((film.pixels[0].depth - 3.0).abs() < 1e-3, "{}", film.pixels[0].depth);
    // The light passes the pane twice and is reflected once by the wall.
    let through = self::pane(1.52, 1.0, 1.0)[0];
    let expected = 3.0 * 0.5 / std::f64::consts::PI * through * through;
    let found = f64::from(film.pixels[0].rgb[1]);
    assert!((found / expected - 1.0).abs() < 1e-3, "{found} for {expected}");
}

#[test]
fn every_model_of_color_sees_the_same_light_through_colored_panes() {
    let material = "thin = { index = \"N-BK7\", transmittance = { rgb = [0.9, 0.5, 0.2] } }";
    let scene = scene(&under(&panes(material, &[1.0]), SUN, "0.5", 64));
    let found = |basis: Basis| {
        let method = Method { basis, ..method(&scene, SPLITTING) };
        Mean::of(&film_of(&scene, method)).value
    };
    let space = scene.film.color_space;
    let (fine, coarse) = (found(Basis::bands(space, 32, &[])), found(Basis::bands(space, 16, &[])));
    let planned = found(plan(&scene).method.basis);
    for band in 0..3 {
        assert!((coarse[band] / fine[band] - 1.0).abs() < 0.02, "{coarse:?} for {fine:?}");
        assert!((planned[band] / fine[band] - 1.0).abs() < 0.03, "{planned:?} for {fine:?}");
    }
}

//! Lamps behind and inside rough glass: next-event estimation and random hits agree, with every transport.

use abbe::plan::plan;
use abbe::spectrum::{Basis, Emission};
use abbe::trace::{Method, Transport};

use crate::support::scenes::{
    Mean, SPLITTING, assert_next_event_agrees, body, environment, films_of, lamps, method, render_film, scene, view,
};

const LAMP: &str = "sphere = { center = [0.4, 0.3, -1.5], radius = 0.5 }";

fn glass(index: &str, roughness: f64, extra: &str, shapes: &[&str]) -> String {
    body("glass", &format!("dielectric = {{ index = {index}, roughness = {roughness:?}{extra} }}"), shapes)
}

const PANE: &str = "cube = { center = [0, 0, 0], size = [6, 6, 0.2] }";
const BALL: &str = "sphere = { center = [0.2, 0.1, -1.2], radius = 1.6 }";

fn scene_text(bodies: &str, samples: u32) -> String {
    view([0.5, 0.4, 5.0], [0.1, 0.0, 0.0], 25.0, 8) + &format!("[render]\nsamples = {samples}\n") + bodies
}

#[test]
fn aiming_at_a_lamp_behind_inside_or_before_rough_glass_and_meeting_it_show_the_same() {
    let before = "sphere = { center = [2, 2, 3], radius = 1.2 }";
    let further = "sphere = { center = [-2, 1, -2], radius = 0.3 }";
    let cases = [
        ("behind a pane", glass("1.5", 0.4, "", &[PANE]), vec![LAMP]),
        ("behind a very rough pane", glass("1.5", 0.9, "", &[PANE]), vec![LAMP, further]),
        ("behind a pane that absorbs", glass("1.7", 0.5, ", absorption = { rgb = [0.5, 1, 3] }", &[PANE]), vec![LAMP]),
        ("inside a ball", glass("1.5", 0.5, ", absorption = { rgb = [0.2, 0.1, 0.4] }", &[BALL]), vec![LAMP]),
        ("before a pane", glass("1.5", 0.5, "", &[PANE]), vec![before]),
        ("inside a dispersive ball", glass("{ rgb = [1.4, 1.5, 1.7] }", 0.5, "", &[BALL]), vec![LAMP]),
        ("behind a dispersive pane", glass("{ rgb = [1.4, 1.5, 1.7] }", 0.25, "", &[PANE]), vec![LAMP]),
    ];
    for (name, glass, shapes) in &cases {
        let [aimed_at, met] = lamps(shapes);
        let [aimed_at, met] = [scene_text(&(glass.clone() + &aimed_at), 64), scene_text(&(glass.clone() + &met), 400)];
        assert_next_event_agrees([&aimed_at, &met], 4, 0.04, 2 * cases.len(), name);
    }
}

#[test]
fn fixed_lanes_and_heroes_show_the_same_lamp_behind_dispersive_rough_glass() {
    let [aimed_at, _] = lamps(&[LAMP]);
    for roughness in [0.1, 0.5] {
        let text = scene_text(&(glass("\"N-SF11\"", roughness, "", &[PANE]) + &aimed_at), 32);
        let scene = scene(&text);
        let emission = Emission::new(scene.lights[0].emission(), scene.film.color_space);
        let bands = Basis::bands(scene.film.color_space, 12, &[]);
        // Without heroes, all fixed wavelengths count wherever they go.
        let shown = [bands.clone(), bands.with_heroes(4, &[emission])].map(|basis| {
            let method = Method { basis, ..method(&scene, SPLITTING) };
            Mean::over_seeds(&films_of(&scene, &method, 0..4))
        });
        let [fixed, heroes] = shown;
        println!("roughness {roughness}: {heroes:.4?} for {fixed:.4?}");
        let mut heroes = heroes.with_joint_error(&fixed);
        // The color of twelve wavelengths is off by less than 1 %.
        (0..3).for_each(|band| heroes.error[band] += 0.003 * fixed.value[band]);
        heroes.assert_near(fixed.value, 2, &format!("roughness {roughness}"));
    }
}

#[test]
fn a_scene_with_rough_glass_is_left_to_chance_and_smooth_glass_is_not() {
    for (roughness, random) in [(0.0, false), (0.009, false), (0.02, true), (1.0, true)] {
        let text = scene_text(&(glass("1.5", roughness, "", &[PANE]) + &environment(1.0)), 1)
            .replace("samples = 1\n", "")
            .replace("height = 8\n", "height = 8\nfilter = \"center\"\n");
        let plan = plan(&scene(&text));
        assert_eq!(matches!(plan.method.transport, Transport::Random { .. }), random, "{:?}", plan.because);
    }
}

#[test]
fn below_the_least_roughness_glass_is_smooth_to_the_last_bit() {
    let [lamp, _] = lamps(&[LAMP]);
    let shown =
        |roughness| render_film(&scene_text(&(glass("1.5", roughness, "", &[PANE]) + &lamp), 16), SPLITTING).0.pixels;
    let smooth = shown(0.0);
    assert!(smooth == shown(0.009), "below the least roughness it is another image");
    assert!(smooth != shown(0.1), "roughness changes nothing");
}

//! Photons and panes: each path is found once, either by the light pass or by the camera paths.

use abbe::trace::{LightPass, MapPasses, Method, Smoothness};

use crate::support::scenes::{Mean, SPLITTING, body, films_of, method, scene, view};

/// Returns a floor with a glass ball, under a lamp behind a pane. There may be another pane in front of the camera.
fn room(camera_pane: bool, more: &str) -> String {
    let mut panes = vec!["quad = { center = [0, 2.2, 0], u = [3, 0, 0], v = [0, 0, 3] }"];
    if camera_pane {
        panes.push("quad = { center = [2, 1.6, 2], u = [1.5, 0, -1.5], v = [0, 1.5, 0] }");
    }
    view([3.0, 2.0, 3.0], [0.0, 0.3, 0.0], 30.0, 24)
        + "[render]\nsamples = 64\n"
        + &body(
            "floor",
            "diffuse = { reflectance = 0.5 }",
            &["quad = { center = [0, 0, 0], u = [4, 0, 0], v = [0, 0, 4] }"],
        )
        + &body("pane", "thin = { index = 1.9 }", &panes)
        + &body("glass", "dielectric = { index = 1.5 }", &["sphere = { center = [0, 0.6, 0], radius = 0.5 }"])
        + &body(
            "lamp",
            "emissive = { radiance = 9 }",
            &["quad = { center = [0, 3, 0], u = [0.8, 0, 0], v = [0, 0, 0.8] }"],
        )
        + more
}

fn mean(text: &str, light_pass: bool, map: bool) -> Mean {
    let scene = scene(text);
    let map = map.then_some(MapPasses { count: 4, photons: 20_000, radius: 1.0, chance: 1.0 });
    let lights = (0..scene.lights.len()).collect();
    let light_pass = light_pass.then_some(LightPass {
        photons: 60_000,
        lights,
        openings: Vec::new(),
        to: vec![Smoothness::Whole],
        map,
    });
    let setup = Method { light_pass, samples: 64, ..method(&scene, SPLITTING) };
    Mean::over_seeds(&films_of(&scene, &setup, 0..8))
}

#[test]
fn photons_and_camera_paths_divide_the_light_that_passes_panes() {
    let mirror = body(
        "steel",
        "mirror = { reflectance = 0.8 }",
        &["quad = { center = [-1.5, 0.8, 0], u = [0, 0, 1], v = [0, 0.8, 0] }"],
    );
    for (name, camera_pane, more, map) in [
        ("panes above and before the camera", true, "", false),
        ("with a mirror", true, mirror.as_str(), false),
        ("with a mirror and a map", true, mirror.as_str(), true),
    ] {
        let text = room(camera_pane, more);
        let chance = mean(&text, false, false);
        let mut photons = mean(&text, true, map).with_joint_error(&chance);
        println!("{name}: {photons:.5?} for {chance:.5?}");
        if map {
            // A map blurs: what it spreads across the floor's edge is less than a thousandth here.
            (0..3).for_each(|band| photons.error[band] += 0.001 * chance.value[band]);
        }
        assert!(photons.worst_relative_error(chance.value) < 0.01, "{name}: {photons:?}");
        photons.assert_near(chance.value, 4, name);
    }
}

//! A pane without thickness shows what a plate of glass shows: all reflections between its two sides.

use crate::support::scenes::{EVERY_BRANCH, body, environment, image, view};

/// What comes straight through a pane that is turned by an angle from a screen of radiance 1, or back from one behind the camera.
fn through(material: &str, shape: &str, degrees: f64, wall_behind: bool) -> f64 {
    let (z, facing) = if wall_behind { (-9.0, 1) } else { (9.0, -1) };
    let wall = body(
        "wall",
        "emissive = { radiance = 1, sides = \"front\" }",
        &[&format!("quad = {{ center = [0, 0, {z}], u = [{facing}, 0, 0], v = [0, 1, 0] }}")],
    );
    let text = format!(
        "{}filter = \"center\"\n[material.pane]\n{material}\n[[object]]\nshape.{shape}\nmaterial = \"pane\"\n\
         transform = [{{ rotate = {{ axis = [1, 0, 0], degrees = {degrees:?} }} }}]\n{wall}",
        view([0.0, 0.0, 5.0], [0.0; 3], 1.0, 1)
    );
    f64::from(image(&text, EVERY_BRANCH).0.pixels[0].rgb[1])
}

const PANE: &str = "quad = { center = [0, 0, 0], u = [50, 0, 0], v = [0, 50, 0] }";

/// (1 - R) / (1 + R) with the exact Fresnel reflectance of one side, n = 1.5.
#[test]
fn a_pane_lets_through_what_all_its_reflections_leave() {
    for (degrees, expected) in [(0.0, 12.0 / 13.0), (45.0, 0.904_327), (60.0, 0.836_232), (75.0, 0.596_092)] {
        let found = through("thin = { index = 1.5 }", PANE, degrees, true);
        assert!((found - expected).abs() < 1e-6, "{degrees} degrees: {found} for {expected}");
        let plate = "cube = { center = [0, 0, 0], size = [100, 100, 0.1] }";
        let thick = through("dielectric = { index = 1.5 }", plate, degrees, true);
        assert!((found - thick).abs() < 1e-6, "{degrees} degrees: {found} for {thick} through a plate");
    }
}

#[test]
fn a_tinted_pane_loses_light_on_every_way() {
    // Straight on, R = 0.04, t = 0.8: T = (1 - R)^2 t / (1 - R^2 t^2), and R + R t T comes back.
    let transmitted = 0.96 * 0.96 * 0.8 / (1.0 - 0.04 * 0.04 * 0.64);
    let material = "thin = { index = 1.5, transmittance = 0.8 }";
    assert!((through(material, PANE, 0.0, true) - transmitted).abs() < 1e-6);
    assert!((through(material, PANE, 0.0, false) - (0.04 + 0.04 * 0.8 * transmitted)).abs() < 1e-6);
    let clear =
        ["thin = { index = 1 }", "thin = { index = 1, transmittance = 0.8 }"].map(|m| through(m, PANE, 30.0, true));
    assert!((clear[0] - 1.0).abs() < 1e-7 && (clear[1] - 0.8).abs() < 1e-7, "{clear:?}");
}

#[test]
fn panes_in_an_even_sky_are_invisible() {
    for index in ["1.1", "1.52", "2.5", "\"N-SF11\""] {
        let panes = body(
            "pane",
            &format!("thin = {{ index = {index} }}"),
            &[PANE, "sphere = { center = [0, 0, 2], radius = 1 }"],
        );
        let text = format!("{}{panes}{}", view([0.2, 0.3, 5.0], [0.0; 3], 40.0, 16), environment(1.0));
        for pixel in image(&text, EVERY_BRANCH).0.pixels {
            assert!(pixel.rgb.iter().all(|x| (x - 1.0).abs() < 2e-6), "{index}: {pixel:?}");
        }
    }
}

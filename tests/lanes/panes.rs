//! A pane without thickness looks like a plate of glass with all reflections between its two sides.

use crate::support::fresnel::reflectances;
use crate::support::scenes::{EVERY_BRANCH, body, environment, render_film, view};

/// Returns the light of a screen of radiance 1 that arrives straight through a pane turned by an angle, or that the
/// pane reflects if the screen is behind the camera.
fn light_through(material: &str, shape: &str, degrees: f64, wall_behind: bool) -> f64 {
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
    f64::from(render_film(&text, EVERY_BRANCH).0.pixels[0].rgb[1])
}

fn cosine(degrees: f64) -> f64 {
    libm::cos(degrees.to_radians())
}

const PANE: &str = "quad = { center = [0, 0, 0], u = [50, 0, 0], v = [0, 50, 0] }";

/// The pane transmits (1 - R) / (1 + R) of s and of p, by the exact Fresnel equations for n = 1.5, 2.5 and N-BK7's n_d.
#[test]
fn a_pane_lets_through_what_all_its_reflections_leave_of_each_polarization() {
    for n in [1.5, 1.5168, 2.5] {
        for degrees in [0.0, 10.0, 30.0, 45.0, 56.31, 60.0, 70.0, 75.0, 85.0] {
            let pane = format!("thin = {{ index = {n} }}");
            let [s, p] = reflectances(n, cosine(degrees)).map(|r| (1.0 - r) / (1.0 + r));
            let found = light_through(&pane, PANE, degrees, true);
            assert!((found - 0.5 * (s + p)).abs() < 1e-6, "{n} at {degrees} degrees: {found}");
        }
    }
    // Published for a pile of plates of N-BK7 at 75 degrees: T_s = 0.421958, T_p = 0.808685.
    assert!((light_through("thin = { index = 1.5168 }", PANE, 75.0, true) - 0.615_321).abs() < 1e-6);
}

/// The reflections of each polarization, with absorption on every pass, are summed term by term.
#[test]
fn a_tinted_pane_at_any_angle_is_the_sum_of_its_reflections() {
    for (t, degrees) in [(0.9, 60.0), (0.5, 75.0), (0.05, 45.0), (0.999, 85.0)] {
        let series = |r: f64| {
            let terms = (0..2000).map(|m| (r * t).powi(2 * m));
            (1.0 - r) * (1.0 - r) * t * terms.sum::<f64>()
        };
        let surface = reflectances(1.52, cosine(degrees));
        let [s, p] = surface.map(series);
        let material = format!("thin = {{ index = 1.52, transmittance = {t} }}");
        let found = light_through(&material, PANE, degrees, true);
        assert!((found - 0.5 * (s + p)).abs() < 1e-6, "{t} at {degrees} degrees: {found} for {}", 0.5 * (s + p));
        // In a uniform sky, the reflected light r + r t T is added.
        let pane = body("pane", &material, &[PANE]);
        let angle: f64 = f64::to_radians(degrees);
        let eye = [0.0, 5.0 * libm::sin(angle), 5.0 * libm::cos(angle)];
        let text = format!("{}filter = \"center\"\n{pane}{}", view(eye, [0.0; 3], 1.0, 1), environment(1.0));
        let all = f64::from(render_film(&text, EVERY_BRANCH).0.pixels[0].rgb[1]);
        let back = |r: f64| r + r * t * series(r);
        let expected = 0.5 * (s + p + back(surface[0]) + back(surface[1]));
        assert!((all - expected).abs() < 1e-6, "{t} at {degrees} degrees: {all} in all for {expected}");
    }
}

#[test]
fn a_tinted_pane_loses_light_on_every_way() {
    // At normal incidence with R = 0.04 and t = 0.8: T = (1 - R)^2 t / (1 - R^2 t^2), and R + R t T is reflected.
    let transmitted = 0.96 * 0.96 * 0.8 / (1.0 - 0.04 * 0.04 * 0.64);
    let material = "thin = { index = 1.5, transmittance = 0.8 }";
    assert!((light_through(material, PANE, 0.0, true) - transmitted).abs() < 1e-6);
    assert!((light_through(material, PANE, 0.0, false) - (0.04 + 0.04 * 0.8 * transmitted)).abs() < 1e-6);
    let clear = ["thin = { index = 1 }", "thin = { index = 1, transmittance = 0.8 }"]
        .map(|m| light_through(m, PANE, 30.0, true));
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
        for pixel in render_film(&text, EVERY_BRANCH).0.pixels {
            assert!(pixel.rgb.iter().all(|x| (x - 1.0).abs() < 2e-6), "{index}: {pixel:?}");
        }
    }
}

//! Films in rendered images without random choices, compared with another method of summing their waves.

use abbe::spectrum::{Basis, Response};
use abbe::trace::{Method, prepare, render};

use super::reference::{Layer, shares};
use crate::support::scenes::{EVERY_BRANCH, assert_near, body, method, quad, render_text, scene, view};

const ANGLES: [f64; 4] = [0.0, 30.0, 45.0, 60.0];
const SIDE_NAMES: [&str; 2] = ["reflected", "let through"];

/// Returns the light of a lamp that a pixel receives from a material at the origin, reflected or from behind, at three
/// wavelengths in nm and at an angle in degrees.
fn received_light(material: &str, shape: &str, degrees: f64, behind: bool, nm: [f64; 3]) -> [f64; 3] {
    let (y, x) = degrees.to_radians().sin_cos();
    let camera = [4.0 * y, 0.0, 4.0 * x];
    let [u, lamp] = if behind { [[-x, 0.0, y], [-y, 0.0, -x]] } else { [[x, 0.0, y], [-y, 0.0, x]] };
    let lamp = quad(lamp.map(|x| 6.0 * x), u.map(|x| if behind { 5.0 } else { 2.0 } * x), [0.0, 2.0, 0.0]);
    let text = view(camera, [0.0; 3], 1e-3, 1)
        + "[render]\nsamples = 1\n"
        + &body("seen", material, &[shape])
        + &body("lamp", "emissive = { radiance = 1 }", &[&lamp]);
    let scene = scene(&text);
    // Lanes of lines stand for single wavelengths, however far apart these are.
    let basis = Basis::wavelengths(scene.film.color_space, vec![600.0], &nm);
    let columns = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let method = Method { basis, ..method(&scene, EVERY_BRANCH) };
    let world = prepare(&scene, method).with_responses(|_| Response::new(&columns, Vec::new()));
    render(&world, &|_| ()).0.pixels[0].rgb.map(f64::from)
}

const PLANE: &str = "plane = { point = [0, 0, 0], normal = [0, 0, 1] }";

/// Returns the light that a material reflects relative to a perfect mirror.
fn reflected(material: &str, degrees: f64, nm: [f64; 3]) -> [f64; 3] {
    let white = received_light("mirror = { reflectance = 1 }", PLANE, degrees, false, nm);
    let found = received_light(material, PLANE, degrees, false, nm);
    std::array::from_fn(|i| found[i] / white[i])
}

/// Writes layers, given as n - i k and nm, in the form that scenes use.
fn coating(layers: &[Layer]) -> String {
    let layer = |([n, k], nm): &Layer| {
        let name = if *n < 1.0 { "n" } else { "index" };
        format!("{{ {name} = {n:?}, k = {:?}, thickness_nm = {nm:?} }}", -k)
    };
    format!("coating = [{}]", layers.iter().map(layer).collect::<Vec<_>>().join(", "))
}

/// The Sellmeier formula of N-BK7 (Schott).
fn bk7(nm: f64) -> f64 {
    let w2 = nm * nm * 1e-6;
    let terms = [(1.03961212, 0.00600069867), (0.231792344, 0.0200179144), (1.01046945, 103.560653)];
    (1.0 + terms.iter().map(|(b, c)| b * w2 / (w2 - c)).sum::<f64>()).sqrt()
}

#[test]
fn a_quarter_wave_of_magnesium_fluoride_darkens_glass() {
    let material = "dielectric = { index = \"N-BK7\", coating = [{ index = 1.38, thickness_nm = 99.63768115942 }] }";
    let rows = [
        ([400.0, 500.0, 600.0], [0.021_983, 0.013_261, 0.013_386]),
        ([450.0, 550.0, 650.0], [0.015_953, 0.012_709, 0.014_704]),
    ];
    for (nm, expected) in rows {
        assert_near(reflected(material, 0.0, nm), expected, 1e-5, "F3, F4");
        for degrees in ANGLES {
            let cos = degrees.to_radians().cos();
            let expected = nm.map(|nm| shares(1.0, &[([1.38, 0.0], 99.63768115942)], [bk7(nm), 0.0], cos, nm)[0]);
            assert_near(reflected(material, degrees, nm), expected, 1e-5, &format!("{degrees} degrees"));
        }
    }
}

#[test]
fn eleven_layers_are_a_mirror_at_one_color() {
    let [high, low] = [2.35, 1.38].map(|n| ([n, 0.0], 550.0 / 4.0 / n));
    let layers = [high, low, high, low, high, low, high, low, high, low, high];
    let material = format!("dielectric = {{ index = 1.52, {} }}", coating(&layers));
    let [at_450, at_550, _] = reflected(&material, 0.0, [450.0, 550.0, 650.0]);
    assert!((at_550 - 0.994_646).abs() < 1e-5 && (at_450 - 0.123_001).abs() < 1e-5, "F6: {at_450}, {at_550}");
}

/// Three layers, one of which absorbs, so the glass looks different from its two sides.
const STACK: [Layer; 3] = [([1.46, 0.0], 80.0), ([2.3, -0.4], 60.0), ([1.7, 0.0], 120.0)];

/// A beam splitter: 20 nm of silver between clear layers.
const SILVERED: [Layer; 3] = [([1.46, 0.0], 90.0), ([0.06, -3.6], 20.0), ([2.3, 0.0], 40.0)];

#[test]
fn layers_are_listed_from_the_outside_inward_and_met_from_both_sides() {
    let slab = "cube = { center = [0, 0, 0], size = [60, 60, 0.5] }";
    let nm = [450.0, 550.0, 650.0];
    for stack in [STACK, SILVERED] {
        let material = format!("dielectric = {{ index = 1.52, {} }}", coating(&stack));
        let mut inside = stack;
        inside.reverse();
        for degrees in ANGLES {
            let cos = degrees.to_radians().cos();
            let cos_inside = (1.0 - (1.0 - cos * cos) / (1.52 * 1.52)).sqrt();
            let bare = received_light(
                "mask = { material = \"clear\", opacity = 0 }\n[material.clear]\nmirror = {}",
                slab,
                degrees,
                true,
                nm,
            );
            let found = received_light(&material, slab, degrees, true, nm);
            let through = nm.map(|nm| {
                let [_, t] = shares(1.0, &stack, [1.52, 0.0], cos, nm);
                let [r, back] = shares(1.52, &inside, [1.0, 0.0], cos_inside, nm);
                assert!((back - t).abs() < 1e-9);
                t * t / (1.0 - r * r)
            });
            assert_near(
                [0, 1, 2].map(|i| found[i] / bare[i]),
                through,
                1e-5,
                &format!("{degrees} degrees, through both faces"),
            );
            let expected = nm.map(|nm| shares(1.0, &stack, [1.52, 0.0], cos, nm)[0]);
            assert_near(reflected(&material, degrees, nm), expected, 1e-5, &format!("{degrees} degrees, reflected"));
        }
    }
}

#[test]
fn a_film_is_reflected_by_and_seen_through() {
    for ([n, k], thickness) in [([1.33, 0.0], 300.0), ([1.33, 0.05], 700.0), ([0.2, 3.4], 30.0)] {
        let name = if n < 1.0 { "n" } else { "index" };
        let material = format!("thin = {{ {name} = {n:?}, k = {k:?}, thickness_nm = {thickness:?} }}");
        let nm = [450.0, 550.0, 650.0];
        for degrees in ANGLES {
            let expected =
                nm.map(|nm| shares(1.0, &[([n, -k], thickness)], [1.0, 0.0], degrees.to_radians().cos(), nm));
            for (way, name) in SIDE_NAMES.iter().enumerate() {
                let found = match way {
                    0 => reflected(&material, degrees, nm),
                    _ => {
                        let clear = "thin = { index = 1 }";
                        let [found, bare] = [&*material, clear].map(|of| received_light(of, PLANE, degrees, true, nm));
                        [0, 1, 2].map(|i| found[i] / bare[i])
                    }
                };
                assert_near(
                    found,
                    expected.map(|shares| shares[way]),
                    1e-5,
                    &format!("{thickness} nm, {degrees} degrees, {name}"),
                );
            }
        }
    }
}

#[test]
fn metal_and_plastic_reflect_by_their_layers() {
    let nm = [450.0, 550.0, 650.0];
    let metal = format!("conductor = {{ n = 1.015, k = 6.627, {} }}", coating(&[([1.46, 0.0], 100.0)]));
    let [_, at_550, _] = reflected(&metal, 60.0, nm);
    assert!((at_550 - 0.5 * (0.791_828 + 0.867_711)).abs() < 1e-5, "F7: {at_550}");
    let plastic = format!("plastic = {{ reflectance = 0, {} }}", coating(&STACK));
    for degrees in ANGLES {
        let cos = degrees.to_radians().cos();
        let expected = nm.map(|nm| shares(1.0, &[([1.46, 0.0], 100.0)], [1.015, -6.627], cos, nm)[0]);
        assert_near(reflected(&metal, degrees, nm), expected, 1e-5, &format!("metal, {degrees} degrees"));
        let expected = nm.map(|nm| shares(1.0, &STACK, [1.5, 0.0], cos, nm)[0]);
        assert_near(reflected(&plastic, degrees, nm), expected, 1e-5, &format!("plastic, {degrees} degrees"));
    }
}

/// A checkerboard whose squares all have one thickness is a film of that thickness, under any color model.
#[test]
fn a_checkerboard_of_thicknesses_is_what_its_squares_are() {
    let color = |thickness: &str, model: &str| {
        let text = format!(
            "[camera]\nposition = [0, 0, 5]\nlook_at = [0, 0, 0]\nvertical_fov = 1\n[film]\nwidth = 2\nheight = 2\n\
             [render]\nsamples = 16\nmodel = {model}\n\
             [material.film]\nthin = {{ index = 1.5, thickness_nm = {thickness} }}\n\
             [[object]]\nshape.quad = {{ center = [0, 0, 0], u = [9, 0, 0], v = [0, 9, 0] }}\nmaterial = \"film\"\n\
             [[light]]\npoint = {{ position = [0, 0, -4], intensity = 1 }}\n\
             [[light]]\nenvironment = {{ radiance = 1 }}\n[[object]]\nmaterial = \"black\"\n\
             shape.quad = {{ center = [0, 0, -3], u = [9, 0, 0], v = [0, 9, 0] }}\n\
             [material.black]\ndiffuse = {{ reflectance = 0 }}\n"
        );
        render_text(&text).rgb_at(0, 0)
    };
    for model in ["\"rgb\"", "{ bands = 16 }"] {
        let even = color("300", model);
        for checker in ["{ checker = [300, 300] }", "{ checker = [300, { checker = [300, 300] }] }"] {
            let found = color(checker, model);
            assert!((0..3).all(|i| (found[i] - even[i]).abs() < 1e-5), "{model}, {checker}: {found:?} for {even:?}");
        }
        // A film of 300 nm has a color.
        assert!(even.iter().any(|x| (x / even[1] - 1.0).abs() > 0.1), "{even:?}");
    }
}

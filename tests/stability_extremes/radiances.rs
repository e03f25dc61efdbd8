//! Row H6: very weak and very strong light. A picture is proportional to its lights.

use crate::support::scenes::{SINGLE_PATH, SPLITTING, body, render_film, view};

/// Returns a scene with every kind of light and surface. All lights are multiplied by a factor.
fn text(factor: f64) -> String {
    let light = |x: f64| format!("{:e}", x * factor);
    view([0.2, 1.0, 6.0], [0.0, 0.3, 0.0], 40.0, 40)
        + "[render]\nsamples = 16\n"
        + &body("floor", "diffuse = { reflectance = 0.6 }", &["plane = { point = [0, -1, 0], normal = [0, 1, 0] }"])
        + &body("glass", "dielectric = { index = 1.5 }", &["sphere = { center = [-1, 0, 0], radius = 0.8 }"])
        + &body(
            "gold",
            "conductor = { metal = \"Au\", roughness = 0.3 }",
            &["sphere = { center = [1, 0, 0], radius = 0.8 }"],
        )
        + &body(
            "lamp",
            &format!("emissive.radiance.rgb = [{}, {}, {}]", light(9.0), light(8.0), light(6.0)),
            &["quad = { center = [0, 3, 0], u = [0.5, 0, 0], v = [0, 0, 0.5] }"],
        )
        + &format!(
            "[[light]]\npoint = {{ position = [2, 2, 2], intensity = {} }}\n[[light]]\nenvironment.radiance = {}\n\
             [[light]]\nsun = {{ toward = [1, 2, 1], irradiance = {} }}\n",
            light(3.0),
            light(0.2),
            light(1.5)
        )
}

/// A power of two commutes with every rounding, so no bit may differ. Light of 9 2^96 is 7 10^29.
#[test]
fn h6_pictures_of_lights_of_1e30_and_1e_minus_30_are_those_of_1_to_the_last_bit() {
    for transport in [SPLITTING, SINGLE_PATH] {
        let (film, report) = render_film(&text(1.0), transport);
        assert_eq!(report.non_finite, 0);
        assert!(film.pixels.iter().filter(|pixel| pixel.rgb[1] > 0.05).count() > 1000, "the scene is nearly black");
        for power in [96, 60, -60] {
            let factor = libm::exp2(f64::from(power));
            let (scaled, counted) = render_film(&text(factor), transport);
            assert_eq!((counted.non_finite, counted.rays), (0, report.rays), "2^{power}");
            for (at, (scaled, pixel)) in scaled.pixels.iter().zip(&film.pixels).enumerate() {
                let expected = pixel.rgb.map(|x| (f64::from(x) * factor) as f32);
                assert_eq!(scaled.rgb, expected, "pixel {at} at 2^{power}");
            }
        }
        // At 2^-100, products of small weights leave the normal range of f32 and lose their last digits.
        let factor = libm::exp2(-100.0);
        let (scaled, _) = render_film(&text(factor), transport);
        for (scaled, pixel) in scaled.pixels.iter().zip(&film.pixels) {
            for band in 0..3 {
                let (found, expected) = (f64::from(scaled.rgb[band]) / factor, f64::from(pixel.rgb[band]));
                assert!((found / expected - 1.0).abs() < 1e-5, "{found} for {expected}");
            }
        }
    }
}

/// The dim lamp is negligible beside the bright one, but visible where it shines alone.
#[test]
fn h6_lights_of_1e30_and_1e_minus_30_share_a_scene() {
    let lamp = |name: &str, x: f64, radiance: &str| {
        let quad = format!("quad = {{ center = [{x:?}, 2, 0], u = [0.5, 0, 0], v = [0, 0, 0.5] }}");
        body(name, &format!("emissive = {{ radiance = {radiance} }}"), &[&quad])
    };
    let room = view([0.0, 1.0, 9.0], [0.0, 0.5, 0.0], 60.0, 40)
        + "[render]\nsamples = 16\n"
        + &body(
            "white",
            "diffuse = { reflectance = 0.8 }",
            &[
                "plane = { point = [0, -1, 0], normal = [0, 1, 0] }",
                // A wall between the lamps: each side of the floor sees only one of them.
                "cube = { center = [0, 0, 0], size = [0.2, 9, 12] }",
            ],
        );
    let bright = lamp("bright", 3.0, "1e30");
    let dim = lamp("dim", -3.0, "1e-30");
    for transport in [SPLITTING, SINGLE_PATH] {
        let (both, report) = render_film(&(room.clone() + &bright + &dim), transport);
        assert_eq!(report.non_finite, 0);
        let lit = |from: f32, to: f32| both.pixels.iter().filter(|pixel| (from..to).contains(&pixel.rgb[1])).count();
        assert!(lit(1e26, 1.1e30) > 200, "{} bright pixels", lit(1e26, 1.1e30));
        assert!(both.pixels.iter().all(|pixel| pixel.rgb.iter().all(|x| x.is_finite() && *x >= 0.0)));
        assert!(lit(1e-38, 1.1e-30) > 0, "the dim lamp itself is not seen");
    }
}

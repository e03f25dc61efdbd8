//! Rows H1, H8, H9 and H12: unevenly stretched bodies, cameras on surfaces, and bodies so small beside others that both
//! are at the limits of what can be expressed.

use abbe::film::DEPTH_OF_NOTHING;

use crate::support::bodies::ball;
use crate::support::scenes::{GROUND, Mean, SPLITTING, body, environment, render_film, sigma_limit, view};

/// Every closed shape under scales that differ by up to 10^6, turned, in a uniform sky. White paint and glass are as
/// bright as the sky. A wrong normal, cosine or area would change that.
#[test]
fn h1_stretched_bodies_and_instances_keep_all_light() {
    let (points, faces) = ball();
    let points: Vec<[f64; 3]> = points.iter().map(|point| point.to_array()).collect();
    let mesh = format!("mesh = {{ points = {points:?}, faces = {faces:?} }}");
    let shapes = ["sphere = { center = [0, 0, 0], radius = 1 }", "cube = { center = [0, 0, 0], size = 1.4 }", &mesh];
    let scales = ["[1, 1, 1e-3]", "[1e-3, 1, 1]", "[1, 0.01, -1]", "[1e-3, 1e-3, 1e3]"];
    for material in ["diffuse = { reflectance = 1 }", "dielectric = { index = 1.5 }"] {
        for shape in shapes {
            for scale in scales {
                let steps = |x: f64| {
                    format!(
                        "[{{ scale = {scale} }}, {{ rotate = {{ axis = [3, 1, 2], degrees = 40 }} }}, \
                         {{ translate = [{x:?}, 0, 0] }}]"
                    )
                };
                let text = view([0.0, 0.0, 6.0], [0.0; 3], 20.0, 16)
                    + "[render]\nsamples = 16\n"
                    + &body("body", material, &[shape])
                    + &format!("instances = [{}, {}]\n", steps(-0.4), steps(0.5))
                    + &environment(1.0);
                let (film, report) = render_film(&text, SPLITTING);
                let what = format!("{material}, {}, {scale}", &shape[..shape.len().min(40)]);
                // In a body as thin as 10^-3, a ray aimed at its rim has no room, and one in 10^5 may go astray.
                assert!(
                    report.unmatched * 100_000 <= report.rays,
                    "{what}: {} of {} rays",
                    report.unmatched,
                    report.rays
                );
                assert_eq!(report.non_finite, 0, "{what}");
                let mean = Mean::of(&film);
                let limit = sigma_limit(24) * mean.error[1] + 1e-5;
                assert!((mean.value[1] - 1.0).abs() <= limit && mean.error[1] < 0.02, "{what}: {mean:?}");
            }
        }
    }
}

/// The camera is exactly on the floor, on the wall of a room, on the surface of a glass ball or in the plane of a pane.
#[test]
fn h8_a_camera_on_a_surface_sees_the_scene_and_no_nan() {
    let white = "diffuse = { reflectance = 1 }";
    let glass = "dielectric = { index = 1.5 }";
    for (material, shape, position, look_at) in [
        (white, GROUND, [0.0, 0.0, 0.0], [1.0, 0.2, 0.3]),
        (white, "cube = { center = [0, 0, 0], size = 2 }", [1.0, 0.3, 0.2], [3.0, 0.5, 0.1]),
        (glass, "sphere = { center = [0, 0, 0], radius = 1 }", [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]),
        (glass, "sphere = { center = [0, 0, 0], radius = 1 }", [0.0, 0.0, 1.0], [0.0, 0.0, 3.0]),
        (glass, "cube = { center = [0, 0, 0], size = 2 }", [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
        (glass, "cube = { center = [0, 0, 0], size = 2 }", [1.0, 0.0, 0.0], [1.0, 0.0, 1.0]),
        (white, "quad = { center = [0, 0, 0], u = [1, 0, 0], v = [0, 1, 0] }", [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
    ] {
        let text = view(position, look_at, 40.0, 16)
            + "[render]\nsamples = 4\n"
            + &body("body", material, &[shape])
            + &environment(1.0);
        let (film, report) = render_film(&text, SPLITTING);
        assert_eq!(report.non_finite, 0, "{shape} from {position:?}");
        // The start may count as being on either side: from inside glass, a sky of 1 is n^2. Roulette may raise a pixel
        // above that.
        let mean = Mean::of(&film);
        let (least, most) = if material == glass { (1.0, 2.25) } else { (0.0, 1.0) };
        let room = sigma_limit(7) * mean.error[1] + 1e-5;
        assert!((least - room..=most + room).contains(&mean.value[1]), "{shape} from {position:?}: {mean:?}");
        assert!(film.pixels.iter().all(|pixel| (0.0..=2.0 * most as f32).contains(&pixel.rgb[1])), "{shape}");
    }
}

/// A ball of 10^-9 in front of a ball of 10^9, all white: both are there, and as bright as the sky.
#[test]
fn h9_things_that_differ_by_18_orders_of_magnitude_share_a_scene() {
    let small = 1e-9;
    for (material, limit) in [("diffuse = { reflectance = 1 }", 0.01), ("mirror = {}", 1e-5)] {
        let shapes = [
            format!("sphere = {{ center = [0, 0, 0], radius = {small:?} }}"),
            "sphere = { center = [0, 0, -1.5e9], radius = 1e9 }".to_owned(),
        ];
        let shapes: Vec<&str> = shapes.iter().map(String::as_str).collect();
        let text = view([0.0, 0.0, 8.0 * small], [0.0; 3], 20.0, 16)
            + "[render]\nsamples = 64\n"
            + &body("body", material, &shapes)
            + &environment(1.0);
        let (film, report) = render_film(&text, SPLITTING);
        assert_eq!((report.non_finite, report.unmatched), (0, 0));
        let near = film.pixels.iter().filter(|pixel| pixel.depth < 1e-7).count();
        let far = film.pixels.iter().filter(|pixel| (1e8..2e9).contains(&pixel.depth)).count();
        // The small ball spans asin(1/8) / 10 degrees of the height, so it covers about two fifths of the image.
        assert!((80..=130).contains(&near) && near + far == 256, "{near} near, {far} far");
        assert_ne!(film.pixels[0].depth, DEPTH_OF_NOTHING);
        let mean = Mean::of(&film);
        assert!((mean.value[1] - 1.0).abs() <= 3.0 * mean.error[1] + 1e-5 && mean.error[1] < limit, "{mean:?}");
    }
}

/// From the smallest allowed length to the largest. Sizes beyond are refused with a message.
#[test]
fn h12_a_sphere_is_seen_at_every_size_that_is_allowed_and_refused_at_others() {
    for exponent in [-30, -20, -10, 10, 20, 29] {
        let radius = libm::pow(10.0, f64::from(exponent));
        let text = |material: &str| {
            view([0.0, 0.0, 4.0 * radius], [0.0; 3], 20.0, 16)
                + "[render]\nsamples = 16\n"
                + &body("body", material, &[&format!("sphere = {{ center = [0, 0, 0], radius = {radius:e} }}")])
                + &environment(1.0)
        };
        for material in ["diffuse = { reflectance = 1 }", "dielectric = { index = 1.5 }"] {
            let (film, report) = render_film(&text(material), SPLITTING);
            assert_eq!((report.non_finite, report.unmatched), (0, 0), "radius {radius:e}");
            let mean = Mean::of(&film);
            let off = (mean.value[1] - 1.0).abs();
            assert!(off <= sigma_limit(12) * mean.error[1] + 1e-5, "radius {radius:e}: {mean:?}");
            assert!(film.pixels.iter().all(|pixel| pixel.depth != DEPTH_OF_NOTHING), "radius {radius:e}");
        }
    }
    for radius in ["1e-31", "1e31", "0", "5e-324"] {
        let shape = format!("sphere = {{ center = [0, 0, 0], radius = {radius} }}");
        let text = view([0.0, 0.0, 4.0], [0.0; 3], 20.0, 4) + &body("body", "mirror = {}", &[&shape]);
        let refused = abbe::Scene::parse(&text, "").map(|_| ()).map_err(|error| error.to_string());
        assert!(refused.is_err_and(|message| message.contains("radius")), "radius {radius}");
    }
}

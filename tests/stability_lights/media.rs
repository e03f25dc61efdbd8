//! Rows D6, M2, M5 and T6: media with nearly equal indices, and surfaces in the same place.

use std::path::Path;

use abbe::material::Interface;
use abbe::scene::Source;

use crate::support::scenes::{
    EVERY_BRANCH, GROUND, SPLITTING, body, environment, first_mistake, mean_color, quad, render_film, render_text,
    scene, view,
};

/// Returns the reflectance for diffuse light from outside of a medium: Walsh 1926, *The Reflection Factor of a Polished
/// Glass Surface for Diffused Light*.
fn walsh(n: f64) -> f64 {
    let (n2, n4) = (n * n, n * n * n * n);
    0.5 + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0) * (n + 1.0))
        + n2 * (n2 - 1.0) * (n2 - 1.0) / ((n2 + 1.0) * (n2 + 1.0) * (n2 + 1.0)) * libm::log((n - 1.0) / (n + 1.0))
        - 2.0 * n * n2 * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n4 - 1.0))
        + 8.0 * n4 * (n4 + 1.0) / ((n2 + 1.0) * (n4 - 1.0) * (n4 - 1.0)) * libm::log(n)
}

/// Schlick's approximation reflects 1 / 21 of diffuse light however close two indices are. The true value goes to 0.
#[test]
fn d6_even_light_between_glass_and_water_is_reflected_as_the_closed_form_says() {
    const STEPS: u32 = 1_000_000;
    // 2 c dc = d(c^2), so the mean is uniform over the squared cosine.
    let cosine = |step: u32| ((f64::from(step) + 0.5) / f64::from(STEPS)).sqrt();
    for (n1, n2) in [(1.333, 1.5168), (1.0, 1.1), (1.0, 1.5)] {
        let sum: f64 = (0..STEPS).map(|step| Interface::new(n1, n2, cosine(step)).reflectance).sum();
        let (found, expected) = (sum / f64::from(STEPS), walsh(n2 / n1));
        println!("D6: {n1} to {n2}: {found:.7} for {expected:.7}");
        assert!((found - expected).abs() <= 2e-6, "{n1} to {n2}: {found} for {expected}");
        assert!(n2 / n1 > 1.2 || (found - 1.0 / 21.0).abs() > 0.01, "as Schlick has it");
    }
}

#[test]
fn m2_clear_bodies_that_share_a_surface_are_refused_and_those_that_overlap_are_not() {
    let text = |half: f64| {
        let hollow = "sphere = { center = [0, 0, 0], radius = 1 }";
        let water = format!("sphere = {{ center = [0, 0, 0], radius = {half:?} }}");
        view([0.0, 0.0, 5.0], [0.0; 3], 30.0, 4)
            + &body("glass", "dielectric = { index = 1.5168, priority = 1 }", &[hollow])
            + &body("water", "dielectric = { index = 1.333 }", &[&water])
            + &environment(1.0)
    };
    assert!(first_mistake(Path::new(""), &text(1.0)).message.contains("partly coincide"));
    for half in [0.99, 1.01] {
        let (_, report) = render_film(&text(half), EVERY_BRANCH);
        assert_eq!(report.unmatched, 0, "{half}");
    }
}

/// Which of two surfaces in one place was hit depended on the order of the objects and on rounding. If it was that of
/// the clear box, the ray went on below the floor, which was then black in the sun and transparent under a sky.
#[test]
fn m2_a_clear_box_that_lies_on_a_floor_hides_nothing_of_it_whichever_comes_first() {
    let image = |height: f64, is_seen: bool, box_first: bool, light: &str| {
        let clear = body(
            "clear",
            "dielectric = { index = 1 }",
            &[&format!("cube = {{ center = [0, {:?}, 0], size = [4, 1, 4] }}", height + 0.5)],
        ) + &format!("visible_to_camera = {is_seen}\n");
        let floor = body(
            "floor",
            "diffuse = { reflectance = 0.5 }",
            &[&quad([0.0, height, 0.0], [0.0, 0.0, 5.0], [5.0, 0.0, 0.0])],
        );
        let objects = if box_first { clear + &floor } else { floor + &clear };
        let image = view([0.0, height + 3.0, 0.5], [0.0, height, 0.0], 20.0, 8);
        mean_color(render_text(&(image + "[render]\nsamples = 64\n" + &objects + light)).film())[1]
    };
    let sun = "[[light]]\nsun = { toward = [0.2, 1, 0.1], irradiance = 3 }\n";
    let in_sun = 0.5 / std::f64::consts::PI * 3.0 / f64::sqrt(1.05);
    // 0.1 and 0.3 have no exact binary form, so the box begins a rounding error above or below the floor.
    for height in [0.0, 0.1, 0.3, 1.0 / 3.0] {
        for (is_seen, box_first) in [(false, false), (false, true), (true, false), (true, true)] {
            // The photons that are seen through the box are a few thousand.
            for (light, expected, tolerance) in [(sun, in_sun, 0.03), (&environment(1.0), 0.5, 1e-5)] {
                let found = image(height, is_seen, box_first, light);
                let off = found / expected - 1.0;
                assert!(off.abs() < tolerance, "{height}, seen {is_seen}, first {box_first}: {found} for {expected}");
            }
        }
    }
}

/// A floor used to count as a neighbor of every bead above it. With twenty thousand neighbors, no others were looked
/// for.
#[test]
fn m2_two_of_many_beads_above_a_floor_are_refused_that_share_a_surface() {
    let place = |i: u32| format!("[{{ translate = [{}, {}, 0] }}]", i % 200, i / 200 + 1);
    let places: Vec<String> = (0..20_200).chain([20_199]).map(place).collect();
    let bead = body("glass", "dielectric.index = 1.5", &["sphere = { center = [0, 0, 0], radius = 0.4 }"]);
    let floor = body("floor", "diffuse.reflectance = 0.5", &["plane = { point = [0, 0, 0], normal = [0, 1, 0] }"]);
    let text =
        view([0.0, 3.0, 5.0], [0.0; 3], 30.0, 4) + &bead + &format!("instances = [{}]\n", places.join(", ")) + &floor;
    assert!(first_mistake(Path::new(""), &text).message.contains("partly coincide"));
}

/// One side of a glass block and a table below it lie in one plane but are divided into triangles in different ways.
/// Rounding would decide for each ray which is hit first.
#[test]
fn t6_sheets_in_one_plane_are_reported_where_light_must_cross_them_in_order() {
    let block = |y: f64| {
        format!(
            "mesh = {{ points = [[-1, {y:?}, -1], [1, {y:?}, -1], [1, {y:?}, 1], [-1, {y:?}, 1], [0, 2, 0]], faces = \
             [[0, 1, 2], [0, 2, 3], [1, 0, 4], [2, 1, 4], [3, 2, 4], [0, 3, 4]] }}"
        )
    };
    let table = "mesh = { points = [[-2, 0, -2], [2, 0, -2], [2, 0, 2], [-2, 0, 2]], faces = [[0, 3, 1], [3, 2, 1]] }";
    let text = |y: f64| {
        view([0.0, 3.0, 5.0], [0.0; 3], 30.0, 4)
            + &body("glass", "dielectric = { index = 1.5 }", &[&block(y)])
            + &body("table", "diffuse = { reflectance = 0.5 }", &[table])
            + &environment(1.0)
    };
    assert!(scene(&text(0.0)).warnings.iter().any(|warning| warning.contains("lies exactly on")));
    for y in [1e-6, -1e-6] {
        assert_eq!(scene(&text(y)).warnings, [""; 0]);
        let (_, report) = render_film(&text(y), SPLITTING);
        assert_eq!((report.unmatched, report.non_finite), (0, 0), "{y}");
    }
}

/// The order of the objects has no effect. Planes have no box that others could lie in.
#[test]
fn m2_a_plane_that_a_body_or_another_plane_lies_in_is_refused_whichever_comes_first() {
    let water = body("water", "dielectric = { index = 1.33 }", &[GROUND]);
    let block = |y: f64| {
        body("block", "dielectric = { index = 1.5 }", &[&format!("cube = {{ center = [0, {y:?}, 0], size = 1 }}")])
    };
    let ice = |y: f64, x: f64| {
        let plane = format!("plane = {{ point = [3, {y:?}, 1], normal = [{x:?}, -2, 0] }}");
        body("ice", "dielectric = { index = 1.31 }", &[&plane])
    };
    let is_refused = |objects: String| {
        let text = view([0.0, 3.0, 5.0], [0.0; 3], 30.0, 4) + &objects + &environment(1.0);
        let source = Source { path: "scene.toml".into(), text };
        source.compile().is_err_and(|error| error.to_string().contains("surface"))
    };
    for other in [block(0.5), block(-0.5), ice(0.0, 0.0)] {
        assert!(is_refused(water.clone() + &other) && is_refused(other.clone() + &water), "{other}");
    }
    for other in [block(0.5 + 1e-6), block(-0.4), ice(1e-3, 0.0), ice(0.0, 0.1)] {
        assert!(!is_refused(water.clone() + &other) && !is_refused(other.clone() + &water), "{other}");
    }
}

/// Closed bodies are left as often as they are entered, to the last ray. Rays that leave an open body are counted, and
/// it creates no light.
#[test]
fn m5_a_medium_that_was_never_entered_is_counted_and_left_as_if_nothing_were_there() {
    let (points, faces) = crate::support::bodies::ball();
    let points: Vec<[f64; 3]> = points.iter().map(|point| point.to_array()).collect();
    let text = |faces: &[[u32; 3]]| {
        let mesh = format!("mesh = {{ points = {points:?}, faces = {faces:?} }}");
        view([0.2, 0.3, 5.0], [0.0; 3], 26.0, 48)
            + "[render]\nsamples = 16\n"
            + &body("glass", "dielectric = { index = 1.5 }", &[&mesh])
            + &environment(1.0)
    };
    let (film, closed) = render_film(&text(&faces), SPLITTING);
    assert_eq!((closed.unmatched, closed.non_finite), (0, 0));
    assert!(closed.rays > 100_000, "{} rays", closed.rays);
    let lightless = |film: &abbe::film::Film| film.pixels.iter().filter(|pixel| pixel.rgb[0] < 0.5).count();
    assert_eq!(lightless(&film), 0);
    let (film, open) = render_film(&text(&faces[..faces.len() * 3 / 4]), SPLITTING);
    assert!(open.unmatched > 100, "{} rays leave what they never entered", open.unmatched);
    assert_eq!(open.non_finite, 0);
    assert!(film.pixels.iter().all(|pixel| pixel.rgb.iter().all(|x| (0.0..=16.0).contains(x))));
}

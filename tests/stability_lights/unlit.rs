//! Rows L6, L9 and M6: scenes that look right in their file, in which a light lights nothing or stands in a surface, or
//! a body is inside out.

use crate::support::scenes::{GROUND, body, environment, scene, view};

const BALL: &str = "sphere = { center = [0, 1, 0], radius = 1 }";
const LAMP: &str = "emissive = { radiance = 5, sides = \"front\" }";

/// Returns a ball on a floor, seen from the front, and whatever is added to them.
fn stage(more: &str) -> String {
    view([0.0, 2.0, 8.0], [0.0, 1.0, 0.0], 40.0, 16)
        + &body("white", "diffuse = { reflectance = 0.7 }", &[GROUND, BALL])
        + more
}

/// Returns a tetrahedron whose faces look outward or inward.
fn tetrahedron(outward: bool) -> String {
    let faces = if outward {
        "[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]"
    } else {
        "[[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]"
    };
    format!("mesh = {{ points = [[2, 0.5, 0], [3, 0.5, 0], [2, 1.5, 0], [2, 0.5, 1]], faces = {faces} }}")
}

fn assert_warns(text: &str, expected: &[&str]) {
    let warnings = scene(text).warnings;
    assert_eq!(warnings.len(), expected.len(), "{warnings:?} in\n{text}");
    for (warning, expected) in warnings.iter().zip(expected) {
        assert!(warning.contains(expected), "{warning}\ndoes not say\n{expected}\nin\n{text}");
    }
}

#[test]
fn l6_lights_that_light_nothing_in_sight_are_reported_with_a_remedy() {
    let quad = |v: i32| format!("quad = {{ center = [0, 5, 0], u = [1, 0, 0], v = [0, 0, {v}] }}");
    let housing = body("gray", "diffuse = { reflectance = 0.5 }", &["cube = { center = [0, 6, 0], size = 4 }"]);
    let light = |light: &str| format!("[[light]]\n{light}\n");
    let closed = "sphere = { center = [0, 0, 0], radius = 30 }";
    for (more, expected) in [
        (body("lamp", LAMP, &[&quad(-1)]), "shines away from every object"),
        (body("lamp", LAMP, &[&quad(-1)]) + &housing, "lights nothing that the camera sees"),
        (body("lamp", LAMP, &[&tetrahedron(false)]), "shines only into its own inside"),
        (
            light("spot = { position = [0, 5, 0], toward = [0, 1, 0], cone_angle = 30, intensity = 9 }"),
            "shines past every object",
        ),
        (
            light("spot = { position = [0, -1, 0], toward = [0, -1, 0], cone_angle = 30, intensity = 9 }"),
            "shines past every object",
        ),
        (
            light("point = { position = [0, 1, 0], intensity = 9 }"),
            "light 1 (point) lights nothing that the camera sees",
        ),
        (light("point = { position = [0, -1, 0], intensity = 9 }"), "lights nothing that the camera sees"),
        (light("sun = { toward = [0, -1, 0], irradiance = 9 }"), "`toward` points from the scene to the sun"),
        (
            environment(1.0) + &body("wall", "diffuse = { reflectance = 0.5 }", &[closed]),
            "light 1 (environment) lights nothing",
        ),
    ] {
        assert_warns(&stage(&more), &[expected]);
    }
}

/// Lights that light little, or only indirectly, cause no warning.
#[test]
fn l6_lights_of_which_something_may_be_seen_are_not_reported() {
    let light = |light: &str| format!("[[light]]\n{light}\n");
    let spot = |toward: &str, angle: f64| {
        light(&format!("spot = {{ position = [0, 5, 0], toward = {toward}, cone_angle = {angle:?}, intensity = 9 }}"))
    };
    let lamp = |quad: &str| body("lamp", LAMP, &[quad]);
    let mirror = body("mirror", "mirror = {}", &["quad = { center = [0, 8, 0], u = [2, 0, 0], v = [0, 0, 2] }"]);
    let prism = body("glass", "dielectric = { index = 1.6 }", &["cube = { center = [0, 6, 0], size = 1 }"]);
    for more in [
        lamp("quad = { center = [0, 5, 0], u = [1, 0, 0], v = [0, 0, 1] }"),
        // Straight down, by way of a mirror, into glass, and far outside of the picture.
        spot("[0, -1, 0]", 1.0),
        spot("[0, 1, 0]", 3.0) + &mirror,
        spot("[0, 1, 0]", 3.0) + &prism,
        spot("[1, -0.01, 0]", 1.0),
        // Facing away but visible, and facing a wall behind the camera.
        lamp("quad = { center = [0, 5, -20], u = [9, 0, 0], v = [0, 9, 0] }"),
        lamp("quad = { center = [0, 3, 12], u = [1, 0, 0], v = [0, 1, 0] }")
            + &body(
                "gray",
                "diffuse = { reflectance = 0.5 }",
                &["quad = { center = [0, 3, 30], u = [9, 0, 0], v = [0, 9, 0] }"],
            ),
        // Behind a pane, and through a cutout.
        light("point = { position = [0, 6, 0], intensity = 9 }")
            + &body(
                "pane",
                "thin = { index = 1.5 }",
                &["quad = { center = [0, 5, 0], u = [50, 0, 0], v = [0, 0, 50] }"],
            ),
        body(
            "net",
            "mask = { material = \"white\", opacity = 0.5 }",
            &["sphere = { center = [0, 6, 0], radius = 0.5 }"],
        ) + &light("point = { position = [0, 6, 0], intensity = 9 }"),
        light("sun = { toward = [0, 1, -0.2], irradiance = 9 }"),
        environment(1.0),
        // Behind an object that the camera does not see.
        lamp("quad = { center = [0, 5, -20], u = [9, 0, 0], v = [0, 9, 0] }")
            + &body(
                "gray",
                "diffuse = { reflectance = 0.5 }",
                &["disc = { center = [0, 5, -19], normal = [0, 0, 1], radius = 99 }\nvisible_to_camera = false"],
            ),
    ] {
        assert_warns(&stage(&more), &[]);
    }
}

#[test]
fn a_camera_that_sees_nothing_or_is_inside_an_opaque_body_is_reported() {
    let white = |shape: &str| body("white", "diffuse = { reflectance = 0.7 }", &[shape]);
    let light = "[[light]]\npoint = { position = [0, 5, 0], intensity = 9 }\n";
    let away = view([0.0, 2.0, 8.0], [0.0, 2.0, 20.0], 40.0, 16) + &white(BALL);
    assert_warns(&(away.clone() + light), &["the camera sees no object"]);
    assert_warns(&(away + &environment(1.0)), &[]);
    // A star, a wire and a distant plane that lie between the rays that look for objects.
    for small in [
        "sphere = { center = [0.03, 1, 0], radius = 0.001 }",
        "cube = { center = [0, 1, 0], size = [0.001, 40, 0.001] }",
        "plane = { point = [0, -0.935, 0], normal = [0, 1, 0.2] }",
    ] {
        assert_warns(&(view([0.0, 2.0, 8.0], [0.0, 2.0, 0.0], 40.0, 16) + &white(small) + light), &[]);
    }
    let inside = view([0.0, 2.0, 8.0], [0.0, 1.0, 0.0], 40.0, 16) + &white("cube = { center = [0, 0, 0], size = 40 }");
    assert_warns(&(inside.clone() + &environment(1.0)), &["the camera is inside object 1, which is opaque"]);
    assert_warns(&(inside.clone() + light), &[]);
    // The camera is inside glass, and the opaque body surrounds the glass.
    let bead = body("glass", "dielectric = { index = 1.5 }", &["sphere = { center = [0, 2, 8], radius = 1 }"]);
    let warnings = scene(&(inside + &bead + &environment(1.0))).warnings;
    assert!(warnings.len() == 1 && !warnings[0].contains("which is opaque"), "{warnings:?}");
}

#[test]
fn m6_a_clear_mesh_that_is_inside_out_is_reported_and_a_bubble_is_not() {
    let glass = |shapes: &[&str]| body("glass", "dielectric = { index = 1.5 }", shapes) + &environment(1.0);
    let larger = "sphere = { center = [2.2, 2.7, 0.2], radius = 2.5 }";
    assert_warns(&stage(&glass(&[&tetrahedron(true)])), &[]);
    assert_warns(&stage(&glass(&[&tetrahedron(false)])), &["point inward"]);
    assert_warns(&stage(&glass(&[&tetrahedron(false), larger])), &[]);
    let many =
        format!("{}\ninstances = [[{{ translate = [0, 0, 0] }}], [{{ translate = [0, 3, 0] }}]]", tetrahedron(false));
    assert_warns(&stage(&glass(&[&many])), &["[1] and 1 more: the faces"]);
    // A reflection in a transform does not turn faces around.
    let mirrored = format!("{}\ntransform = [{{ scale = [-1, 1, 1] }}]", tetrahedron(true));
    assert_warns(&stage(&glass(&[&mirrored])), &[]);
}

/// Flat glass that nothing closes is a half space of glass.
#[test]
fn flat_glass_that_nothing_closes_is_reported() {
    let glass = |shapes: &[&str]| body("glass", "dielectric = { index = 1.5 }", shapes) + &environment(1.0);
    let quad = |center: &str, u: &str, v: &str| format!("quad = {{ center = {center}, u = {u}, v = {v} }}");
    let front = quad("[3, 2, 0.5]", "[0.5, 0, 0]", "[0, 0.5, 0]");
    assert_warns(
        &stage(&glass(&[&front])),
        &["light that enters this dielectric through a flat surface may never leave it"],
    );
    let pond = quad("[3, 0.1, 0]", "[0, 0, 0.5]", "[0.5, 0, 0]");
    assert_warns(&stage(&glass(&[&pond])), &[]);
    let box_of_six = [
        front,
        quad("[3, 2, -0.5]", "[0, 0.5, 0]", "[0.5, 0, 0]"),
        quad("[3.5, 2, 0]", "[0, 0.5, 0]", "[0, 0, 0.5]"),
        quad("[2.5, 2, 0]", "[0, 0, 0.5]", "[0, 0.5, 0]"),
        quad("[3, 2.5, 0]", "[0, 0, 0.5]", "[0.5, 0, 0]"),
        quad("[3, 1.5, 0]", "[0.5, 0, 0]", "[0, 0, 0.5]"),
    ];
    let shapes: Vec<&str> = box_of_six.iter().map(String::as_str).collect();
    assert_warns(&stage(&glass(&shapes)), &[]);
}

/// A light or a camera exactly in a surface is on neither side of it.
#[test]
fn l9_lights_and_cameras_that_stand_exactly_in_a_surface_are_reported() {
    let ceiling = |shape: &str| body("ceiling", "diffuse = { reflectance = 0.5 }", &[shape]);
    let point = |y: f64| format!("[[light]]\npoint = {{ position = [0.3, {y:?}, 0.2], intensity = 9 }}\n");
    let spot = "[[light]]\nspot = { position = [0, 5, 0], toward = [0, -1, 0], cone_angle = 30, intensity = 9 }\n";
    let flat = "quad = { center = [0, 5, 0], u = [3, 0, 0], v = [0, 0, 3] }";
    for shape in [flat, "plane = { point = [0, 5, 0], normal = [0, -1, 0] }", "cube = { center = [0, 6, 0], size = 2 }"]
    {
        let message = "light 1 (point) lies exactly on the surface of object 3";
        assert_warns(&stage(&(ceiling(shape) + &point(5.0))), &[message]);
        assert_warns(&stage(&(ceiling(shape) + &point(5.0 - 1e-9))), &[]);
        assert_warns(&stage(&(ceiling(shape) + spot)), &["light 1 (spot) lies exactly on the surface of object 3"]);
    }
    let lamp =
        |y: f64| body("lamp", LAMP, &[&format!("quad = {{ center = [0, {y:?}, 0], u = [1, 0, 0], v = [0, 0, 1] }}")]);
    for both in [ceiling(flat) + &lamp(5.0), lamp(5.0) + &ceiling(flat)] {
        let text = view([0.0, 2.0, 8.0], [0.0, 1.0, 0.0], 40.0, 16)
            + &body("white", "diffuse = { reflectance = 0.7 }", &[GROUND, BALL])
            + &both;
        let warnings = scene(&text).warnings;
        let message = "which emits light, lies exactly on object";
        assert!(warnings.iter().any(|warning| warning.contains(message)), "{warnings:?}");
    }
    assert_warns(&stage(&(ceiling(flat) + &lamp(4.999))), &[]);
    let water = |y: f64| {
        let size = 2.0 * y;
        body("water", "dielectric = { index = 1.33 }", &[&format!("cube = {{ center = [0, 0, 8], size = {size:?} }}")])
    };
    let message = "the camera lies exactly on the surface of object 3, neither inside nor outside";
    assert_warns(&stage(&(water(2.0) + &environment(1.0))), &[message]);
    assert_warns(&stage(&(water(2.0 + 1e-9) + &environment(1.0))), &[]);
}

/// Nearly every direction that is sampled for this sky leads to its sun, which is behind the only wall.
#[test]
fn l6_a_sky_that_lights_a_wall_from_the_front_is_not_reported_for_its_sun_behind() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("sky.exr");
    let at = |x: usize, y: usize| if (x, y) == (0, 16) { (1e7, 1e7, 1e7) } else { (0.5, 0.5, 0.5) };
    exr::prelude::write_rgb_file(&file, 64, 32, at).expect("an image can be written");
    let wall = "quad = { center = [0, 0, 0], u = [50, 0, 0], v = [0, 50, 0] }";
    let text = view([0.0, 0.0, 5.0], [0.0, 0.0, 0.0], 40.0, 16)
        + &body("wall", "diffuse = { reflectance = 0.5 }", &[wall])
        + &format!("[[light]]\nenvironment = {{ radiance = {{ image = {file:?} }} }}\n");
    assert_warns(&text, &[]);
}

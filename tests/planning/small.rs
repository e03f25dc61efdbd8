//! Dispersion is noticed however small it is in the picture and wherever it is seen.

use abbe::plan::{Plan, plan};
use abbe::scene::Scene;
use abbe::spectrum::Curve;

use crate::support::scenes::{GROUND, object, quad, scene};

/// Width and height of the picture in pixels, for a field of view of 40 degrees.
const SIDE: f64 = 400.0;
/// Returns the width of a pixel at a distance of 1.
fn pixel() -> f64 {
    2.0 * libm::tan(20.0_f64.to_radians()) / SIDE
}

const MATERIALS: &str = "[material.flint]\ndielectric = { index = \"N-SF11\", priority = 2 }\n\
    [material.crown]\ndielectric = { index = \"N-BK7\", priority = 2 }\n[material.diamond]\ndielectric = { index = \"diamond\", priority = 2 }\n\
    [material.faint]\ndielectric = { index = { cauchy = [1.5168, 1e-7] }, priority = 2 }\n\
    [material.plain]\ndielectric = { index = 1.5 }\n[material.water]\ndielectric = { index = 1.33, priority = 1 }\n\
    [material.pane]\nthin = { index = 1.5 }\n[material.mirror]\nmirror = { reflectance = 0.9 }\n\
    [material.wall]\ndiffuse = { reflectance = { rgb = [0.7, 0.5, 0.3] } }\n[material.stripe]\ndiffuse = { reflectance = 0.1 }\n\
    [material.lamp]\nemissive = { radiance = 10 }\n";

/// Plans a scene with a camera at the origin that looks along -z, a striped wall, and a lamp behind the camera. Photons
/// are left out, since they do not affect whether wavelengths part.
fn plan_of(things: &str, width: f64) -> Plan {
    plan(&scene_of(things, width))
}

fn scene_of(things: &str, width: f64) -> Scene<Curve> {
    scene(&format!(
        "[render]\ncaustics = \"off\"\n[camera]\nposition = [0, 0, 0]\nlook_at = [0, 0, -1]\nvertical_fov = 40\n[film]\nwidth = {width}\nheight = {width}\n{MATERIALS}\
         [[object]]\nshape.quad = {{ center = [0, 0, -20], u = [30, 0, 0], v = [0, 30, 0] }}\nmaterial = \"wall\"\n\
         [[object]]\nshape.quad = {{ center = [0, 0, -19.9], u = [0.4, 0, 0], v = [0, 30, 0] }}\nmaterial = \"stripe\"\n\
         [[object]]\nshape.quad = {{ center = [0, 0, 20], u = [30, 0, 0], v = [0, 30, 0] }}\nmaterial = \"wall\"\n\
         [[object]]\nshape.sphere = {{ center = [0, 8, 5], radius = 1 }}\nmaterial = \"lamp\"\n{things}"
    ))
}

/// Returns a three-sided wedge or an eight-sided gem with a given width at a given place.
fn body(gem: bool, material: &str, width: f64, [x, y, z]: [f64; 3]) -> String {
    let (points, faces) = if gem {
        (
            "[[0.5, 0, 0], [-0.5, 0, 0], [0, 0.5, 0], [0, -0.5, 0], [0, 0, 0.5], [0, 0, -0.5]]",
            "[[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]",
        )
    } else {
        (
            "[[-0.5, -0.5, 0], [0.5, -0.5, 0], [0, -0.5, -0.9], [-0.5, 0.5, 0], [0.5, 0.5, 0], [0, 0.5, -0.9]]",
            "[[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]]",
        )
    };
    let turn = if gem { "[3, 2, 1], degrees = 25" } else { "[0, 1, 0], degrees = 40" };
    object(
        material,
        &format!(
            "mesh = {{ points = {points}, faces = {faces} }}\n\
             transform = [{{ rotate = {{ axis = {turn} }} }}, {{ scale = {width:?} }}, {{ translate = [{x:?}, {y:?}, {z:?}] }}]"
        ),
    )
}

fn lets_lanes_part(plan: &Plan) -> bool {
    plan.method.basis.draws_wavelengths()
}

/// Returns a body in one of the places, with what surrounds it. The body is sized to be seen `pixels` wide.
fn scene_at_place(place: &str, gem: bool, material: &str, pixels: f64) -> String {
    let at = |distance: f64| pixels * pixel() * distance;
    // Off center, so that no ray of a grid hits it by luck.
    let off_center = |distance: f64| [0.137 * distance, 0.071 * distance, -distance];
    let cube = |material: &str, z: f64, size: [f64; 3]| {
        object(material, &format!("cube = {{ center = [0, 0, {z:?}], size = {size:?} }}"))
    };
    let quad = |material: &str, center: [f64; 3], u: [f64; 3], v: [f64; 3]| object(material, &quad(center, u, v));
    let body_at = |distance: f64| body(gem, material, at(distance), off_center(distance));
    match place {
        "in the open" => body_at(10.0),
        "behind a thin pane" => body_at(10.0) + &quad("pane", [0.0, 0.0, -4.0], [3.0, 0.0, 0.4], [0.0, 3.0, 0.0]),
        "behind a slab of plain glass" => body_at(10.0) + &cube("plain", -4.0, [6.0, 6.0, 0.1]),
        "behind a slab of N-BK7" => body_at(10.0) + &cube("crown", -4.0, [6.0, 6.0, 0.1]),
        "behind two slabs" => {
            body_at(10.0) + &cube("plain", -4.0, [6.0, 6.0, 0.1]) + &cube("crown", -5.0, [8.0, 8.0, 0.1])
        }
        "in a flat mirror" => {
            let mirror = quad("mirror", [0.0, 0.0, -6.0], [2.0, 0.0, 2.0], [0.0, 3.0, 0.0]);
            // The mirror turns -z to -x: the body is as far to the side as it would be ahead.
            body(gem, material, at(12.0), [-6.5, 0.9, -5.5]) + &mirror
        }
        "in a mirror ball" => {
            // A ball of radius 2 shows an object 8 in front of it some 8.6 times smaller than a flat mirror would.
            let ball = object("mirror", "sphere = { center = [0, 0, -10], radius = 2 }");
            body(gem, material, at(8.0) * 9.0, [2.5, 1.5, -1.0]) + &ball
        }
        "in a body of water" => {
            body_at(10.0) + &object("water", "plane = { point = [0, 0, -3], normal = [0.1, 0.2, 1] }")
        }
        "in a tank" => body_at(10.0) + &cube("plain", -10.0, [9.0, 7.0, 6.0]) + &cube("water", -10.0, [8.8, 6.8, 5.8]),
        "in a mirror behind a pane" => {
            body(gem, material, at(14.0), [-6.5, 0.9, -7.5])
                + &quad("mirror", [0.0, 0.0, -7.0], [2.0, 0.0, 2.0], [0.0, 3.0, 0.0])
                + &object("pane", "quad = { center = [0, 0, -2], u = [4, 0, 0], v = [0, 4, 0] }")
        }
        _ => unreachable!("no such place: {place}"),
    }
}

const PLACES: [&str; 10] = [
    "in the open",
    "behind a thin pane",
    "behind a slab of plain glass",
    "behind a slab of N-BK7",
    "behind two slabs",
    "in a flat mirror",
    "in a mirror ball",
    "in a body of water",
    "in a tank",
    "in a mirror behind a pane",
];

/// Returns the sizes and places in which a body is missed.
fn missed_cases(gem: bool, material: &str) -> Vec<String> {
    let mut missed_cases = Vec::new();
    for place in PLACES {
        for pixels in [3.0, 10.0, 30.0] {
            let plan = plan_of(&scene_at_place(place, gem, material, pixels), SIDE);
            if !lets_lanes_part(&plan) {
                missed_cases.push(format!("{pixels} pixels {place}: {:?}", plan.because));
            }
        }
    }
    missed_cases
}

#[test]
fn w9_prisms_of_3_10_and_30_pixels_are_noticed_wherever_they_are() {
    assert_eq!(missed_cases(false, "flint"), [""; 0]);
}

#[test]
fn w9_gems_of_3_10_and_30_pixels_are_noticed_wherever_they_are() {
    assert_eq!(missed_cases(true, "flint"), [""; 0]);
}

#[test]
fn w9_prisms_of_low_dispersion_are_noticed_wherever_they_are() {
    assert_eq!(missed_cases(false, "crown"), [""; 0]);
}

#[test]
fn gems_of_vanishing_dispersion_keep_lanes_together_wherever_they_are() {
    for place in PLACES {
        let plan = plan_of(&scene_at_place(place, true, "faint", 10.0), SIDE);
        assert!(!lets_lanes_part(&plan), "{place}: {:?}", plan.because);
    }
}

#[test]
fn a_prism_of_3_pixels_is_noticed_in_pictures_of_any_size() {
    for width in [16.0, 100.0, 4000.0, 16384.0] {
        let at = 10.0 * 3.0 * pixel() * SIDE / width;
        let plan = plan_of(&body(false, "flint", at, [1.37, 0.71, -10.0]), width);
        assert!(lets_lanes_part(&plan), "{width}: {:?}", plan.because);
    }
}

#[test]
fn windows_of_optical_glass_keep_lanes_together_where_their_edges_are_seen() {
    for glass in ["crown", "flint"] {
        let pane = "cube = { center = [0.3, 0.2, -8], size = [3, 2, 0.02] }\n\
                    transform = [{ rotate = { axis = [0, 1, 0], degrees = 2 } }]";
        let plan = plan_of(&object(glass, pane), SIDE);
        assert!(!lets_lanes_part(&plan), "{glass}: {:?}", plan.because);
    }
}

#[test]
fn w9_diamonds_are_noticed_wherever_they_are() {
    assert_eq!(missed_cases(true, "diamond"), [""; 0]);
}

#[test]
fn dispersion_before_an_even_sky_with_nothing_behind_keeps_lanes_together() {
    let text = |sky: &str| {
        format!(
            "[camera]\nposition = [0, 0, 0]\nlook_at = [0, 0, -1]\nvertical_fov = 40\n[film]\nwidth = 200\nheight = 200\n{MATERIALS}{sky}{}",
            body(true, "diamond", 2.0, [0.0, 0.0, -6.0])
        )
    };
    let even = plan(&scene(&text("[[light]]\nenvironment = { radiance = 1 }\n")));
    assert!(!lets_lanes_part(&even), "{:?}", even.because);
    let block = object("stripe", "cube = { center = [0, 0, -9], size = [9, 0.4, 0.4] }");
    let behind = plan(&scene(&(text("[[light]]\nenvironment = { radiance = 1 }\n") + &block)));
    assert!(lets_lanes_part(&behind), "{:?}", behind.because);
}

#[test]
fn glass_that_no_path_comes_through_keeps_lanes_together() {
    let body = |place| scene_at_place(place, false, "flint", 30.0);
    let floor = body("in the open") + &object("wall", "plane = { point = [0, -8, 0], normal = [0, 1, 0] }");
    // Paths meet two surfaces of the glass, the wall, and the mirror.
    for (things, fewest) in [(body("in the open"), 3), (body("in a flat mirror"), 4), (floor, 3)] {
        for most in [0, 1, fewest - 1, fewest] {
            let mut scene = scene_of(&things, SIDE);
            scene.render.max_bounces = Some(most);
            let plan = plan(&scene);
            assert_eq!(lets_lanes_part(&plan), most == fewest, "max_bounces = {most}: {:?}", plan.because);
        }
    }
}

#[test]
fn light_through_a_gem_counts_where_paths_are_long_enough_to_show_it() {
    let gem = body(true, "flint", 0.05, [0.1, 2.7, -6.0]);
    let mirror = object("mirror", &quad([0.0, 0.0, 3.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0]));
    // Three surfaces of the gem and the floor, which the camera sees directly or in a mirror.
    for (looks, fewest) in [("0, 0, -6", 4), ("0, 0, 15", 5)] {
        for most in [fewest - 1, fewest] {
            let mut scene = scene(&format!(
                "[camera]\nposition = [0, 1, 0]\nlook_at = [{looks}]\nvertical_fov = 40\n[film]\nwidth = 400\nheight = 400\n\
                 {MATERIALS}{}{gem}{mirror}[[light]]\nsun = {{ toward = [0, 1, 0.2], irradiance = 3 }}\n",
                object("wall", GROUND)
            ));
            scene.render.max_bounces = Some(most);
            let plan = plan(&scene);
            assert_eq!(
                lets_lanes_part(&plan),
                most == fewest,
                "max_bounces = {most} toward {looks}: {:?}",
                plan.because
            );
        }
    }
}

#[test]
fn dispersion_inside_a_drop_is_noticed_where_only_what_it_mirrors_inside_shows() {
    let drop = |behind: &str| {
        plan(&scene(&format!(
            "[camera]\nposition = [0, 0, 0]\nlook_at = [0, 0, -1]\nvertical_fov = 2\n[film]\nwidth = 100\nheight = 100\n{MATERIALS}\
             [material.drop]\ndielectric = {{ index = \"water\" }}\n{}{}{behind}",
            object("drop", "sphere = { center = [0, 0, -9], radius = 0.1 }"),
            object("wall", "quad = { center = [0, 0, 1], u = [30, 0, 0], v = [0, 30, 0] }"),
        )))
    };
    let alone = drop("");
    assert!(lets_lanes_part(&alone), "{:?}", alone.because);
    let before_an_even_sky = drop("[[light]]\nenvironment = { radiance = 1 }\n");
    assert!(lets_lanes_part(&before_an_even_sky), "{:?}", before_an_even_sky.because);
}

#[test]
fn dispersion_is_assumed_where_no_ray_sees_anything_through_the_glass() {
    let glass = |z: f64| {
        plan(&scene(&format!(
            "[camera]\nposition = [0, 0, 0]\nlook_at = [0, 0, -1]\nvertical_fov = 40\n[film]\nwidth = 100\nheight = 100\n{MATERIALS}\
             [[object]]\nmaterial = \"lamp\"\nshape.sphere = {{ center = [0, 0, {z:?}], radius = 0.001 }}\n{}",
            body(true, "flint", 1.0, [0.0, 0.0, -6.0])
        )))
    };
    let dark = glass(9e3);
    assert!(lets_lanes_part(&dark), "{:?}", dark.because);
    let reason =
        "no probe ray saw anything through the dispersive glass in 2 % of the view, where dispersion is assumed; so";
    assert!(dark.because.iter().any(|line| line.contains(reason)), "{:?}", dark.because);
}

#[test]
fn sunlight_through_a_small_gem_out_of_sight_is_noticed() {
    let head = format!(
        "[camera]\nposition = [0, 1, 0]\nlook_at = [0, 0, -6]\nvertical_fov = 40\n[film]\nwidth = 400\nheight = 400\n{MATERIALS}{}",
        object("wall", GROUND)
    );
    let sun = "[[light]]\nsun = { toward = [0, 1, 0.2], irradiance = 3, angular_diameter = 0.53 }\n";
    // A place above the top of the picture.
    let place = [0.1, 2.7, -6.0];
    for (material, width) in [("flint", 0.05), ("crown", 0.02), ("diamond", 0.03)] {
        let found = plan(&scene(&(head.clone() + sun + &body(true, material, width, place))));
        assert!(lets_lanes_part(&found), "{material}: {:?}", found.because);
        let faint = plan(&scene(&(head.clone() + sun + &body(true, "faint", width, place))));
        assert!(!lets_lanes_part(&faint), "{:?}", faint.because);
    }
    let pane = object("crown", "cube = { center = [0.1, 2.7, -6], size = [1, 0.01, 1] }");
    let found = plan(&scene(&(head + sun + &pane)));
    assert!(!lets_lanes_part(&found), "through a pane: {:?}", found.because);
}

#[test]
fn the_light_of_a_drop_far_above_the_floor_counts_only_where_it_is_not_outshone() {
    let plan_of = |height: f64, cone_angle: f64| {
        plan(&scene(&format!(
            "[camera]\nposition = [0, 1, 0]\nlook_at = [0, 0, -6]\nvertical_fov = 40\n[film]\nwidth = 400\nheight = 400\n{MATERIALS}\
             [[light]]\nspot = {{ position = [0, 6, -6], look_at = [0, 0, -6], cone_angle = {cone_angle:?}, blend = 0, intensity = 3 }}\n{}{}",
            object("wall", GROUND),
            object("flint", &format!("sphere = {{ center = [0, {height:?}, -6], radius = 0.02 }}")),
        )))
    };
    let near = plan_of(0.04, 150.0);
    assert!(lets_lanes_part(&near), "{:?}", near.because);
    let far = plan_of(2.7, 150.0);
    assert!(!lets_lanes_part(&far), "{:?}", far.because);
    let alone = plan_of(2.7, 0.6);
    assert!(lets_lanes_part(&alone), "{:?}", alone.because);
}

#[test]
fn light_of_small_lamps_through_a_small_gem_out_of_sight_is_noticed() {
    let head = format!(
        "[camera]\nposition = [0, 1, 0]\nlook_at = [0, 0, -6]\nvertical_fov = 40\n[film]\nwidth = 400\nheight = 400\n{MATERIALS}{}",
        object("wall", GROUND)
    );
    let point = "[[light]]\npoint = { position = [0.15, 3.2, -5.9], intensity = 3 }\n".to_owned();
    let bulb = object("lamp", "sphere = { center = [0.15, 3.2, -5.9], radius = 0.02 }");
    let mut missed_cases = Vec::new();
    for (name, lamp) in [("point", point), ("bulb", bulb)] {
        for (material, seen) in [("flint", true), ("crown", true), ("diamond", true), ("faint", false)] {
            let found = plan(&scene(&(head.clone() + &lamp + &body(true, material, 0.05, [0.1, 2.7, -6.0]))));
            if lets_lanes_part(&found) != seen {
                missed_cases.push(format!("{name} {material}: {:?}", found.because));
            }
        }
    }
    assert!(missed_cases.is_empty(), "{}", missed_cases.join("\n"));
}

#[test]
fn a_rainbow_that_a_small_prism_out_of_sight_throws_on_a_wall_is_noticed() {
    // The minimum deviation of N-BK7, some 37 degrees, leads from the sun to the middle of the picture.
    let text = |material: &str| {
        format!(
            "[camera]\nposition = [0, 0.6, 0]\nlook_at = [2, 0.6, -4.36]\nvertical_fov = 40\n[film]\nwidth = 400\nheight = 400\n{MATERIALS}\
             [[light]]\nsun = {{ toward = [-0.52, 0.1, 0.854], irradiance = 3, angular_diameter = 0.53 }}\n{}{}",
            object("wall", "plane = { point = [2, 0, 0], normal = [-1, 0, 0] }"),
            body(false, material, 0.05, [-1.5, 1.0, -3.0])
        )
    };
    for (material, seen) in [("crown", true), ("faint", false)] {
        let found = plan(&scene(&text(material)));
        assert_eq!(lets_lanes_part(&found), seen, "{material}: {:?}", found.because);
    }
}

//! Caustics that are seen in mirrors, through glass or indirectly, by way of surfaces that they light: the photons that
//! land are gathered. Images with photons are compared with images of camera paths alone.

use std::f64::consts::PI;

use abbe::trace::MapPasses;

use super::agreement::{
    ABOVE, BALL, FLOOR, LAMP, assert_agree_with_map, blocks, camera_and_film, glass, scene_and_method,
};
use crate::support::scenes::{film_of, object, sigma_limit};

/// A map with a radius so small that its blur moves nothing between blocks that these samples could resolve.
pub const NARROW: MapPasses = MapPasses { count: 16, photons: 8192, radius: 0.1, chance: 1.0 };

fn assert_agree(what: &str, text: &str, samples: [u32; 2]) {
    assert_agree_with_map(what, text, samples, Some(NARROW));
}

/// Returns a ball in front of a leaning mirror.
pub fn mirror() -> String {
    camera_and_film("position = [0, 1.2, 2.5]\nlook_at = [0, 0.8, -2]\nvertical_fov = 40", "")
        + FLOOR
        + LAMP
        + &glass("index = 1.5")
        + "[material.mirror]\nmirror = { reflectance = 0.9 }\n"
        + &object("mirror", "quad = { center = [0, 2, -2], u = [3, 0, 0], v = [0, 2, 0.3] }")
        + &object("glass", BALL)
        + &object("lamp", "sphere = { center = [0.5, 5, 0], radius = 0.6 }")
}

#[test]
fn the_caustic_of_a_ball_seen_in_a_mirror() {
    assert_agree("mirror", &mirror(), [32; 2]);
}

#[test]
fn a_caustic_is_as_bright_where_few_places_look_for_photons() {
    assert_agree_with_map("few places", &mirror(), [64; 2], Some(MapPasses { chance: 0.25, ..NARROW }));
}

/// Returns a pool whose floor is under water, lit by a lamp beside it.
fn pool(film: &str) -> String {
    camera_and_film(ABOVE, film)
        + FLOOR
        + LAMP
        + "[material.water]\ndielectric = { index = 1.33, absorption = { rgb = [0.5, 0.2, 0.1] } }\n\
           [material.stone]\nplastic = { reflectance = 0.5, roughness = 0.3 }\n"
        + &object("water", "cube = { center = [0, 0.5, 0], size = [4, 1.2, 4] }")
        + &object("stone", "sphere = { center = [0.3, 0.3, 0.2], radius = 0.3 }")
        + &object("lamp", "disc = { center = [0.5, 4, 0], normal = [0, -1, 0], radius = 0.7 }")
}

#[test]
fn the_floor_of_a_pool_seen_through_its_water() {
    assert_agree("pool", &pool("filter = \"tent\""), [32; 2]);
}

/// The plan's own radius, on an image whose pixels are as wide as possible: the blur changes no block by a hundredth.
#[test]
fn the_bias_of_the_plans_radius_is_less_than_a_hundredth() {
    let pool = scene_and_method(&pool(""));
    let narrow = MapPasses { photons: 2 * NARROW.photons, ..NARROW };
    let wide = MapPasses { radius: 1.0, ..narrow };
    let [narrow, wide] = [narrow, wide].map(|map| blocks(&pool, true, Some(map), 256));
    let limit = 1.25 * sigma_limit(narrow.len());
    let (mut moved, mut whole, mut variance) = (0.0, 0.0, 0.0);
    for (a, b) in narrow.iter().zip(&wide) {
        let error = (a.1 + b.1).sqrt();
        assert!((a.0 - b.0).abs() < 0.01 * a.0 + limit * error, "{} for {}, error {error}", b.0, a.0);
        moved += b.0 - a.0;
        whole += a.0;
        variance += error * error;
    }
    // The three bands of a block are correlated.
    let error = (3.0 * variance).sqrt() / whole;
    println!("the whole is moved by {:.5}, error {error:.5}", moved / whole);
    assert!(moved.abs() / whole + 2.0 * error < 0.01, "bias {}, error {error}", moved / whole);
}

#[test]
fn a_caustic_that_lights_a_wall() {
    let text = camera_and_film("position = [0, 1, 3]\nlook_at = [0, 1, -2]\nvertical_fov = 40", "")
        + "[render]\ndiffuse_bounces = 2\n"
        + FLOOR
        + LAMP
        + &glass("index = { rgb = [1.5, 1.6, 1.7] }")
        + "[material.wall]\ndiffuse = { reflectance = { rgb = [0.9, 0.5, 0.3] } }\n\
           [material.veil]\nmask = { material = \"wall\", opacity = 0.3 }\n"
        + &object("wall", "quad = { center = [0, 2, -1.3], u = [3, 0, 0], v = [0, 2, 0] }")
        + &object("veil", "quad = { center = [0.9, 0.5, 0], u = [0, 0.5, 0], v = [0, 0, 0.8] }")
        + &object("glass", BALL)
        + &object("lamp", "cube = { center = [0, 4, 0], size = 0.8 }");
    assert_agree("wall", &text, [2, 16]);
}

#[test]
fn a_body_of_many_materials_under_a_dome_of_glass() {
    let text = camera_and_film(&format!("{ABOVE}\nlens = {{ radius = 0.1, focus_distance = 4 }}"), "")
        + "[render]\nmax_bounces = 6\n"
        + FLOOR
        + &glass("index = 1.5, priority = 1")
        + "[material.hollow]\ndielectric = { index = 1.0, priority = 2 }\n\
           [material.frost]\ndielectric = { index = 1.4, roughness = 0.4, priority = 3 }\n\
           [material.gold]\nconductor = { metal = \"Au\", roughness = 0.3 }\n\
           [material.matte]\ndiffuse = { reflectance = 0.7 }\n\
           [material.both]\nmix = { materials = [\"matte\", \"gold\"], amount = 0.5 }\n"
        + &object("glass", "sphere = { center = [0, 0.2, 0], radius = 1.2 }")
        + &object("hollow", "sphere = { center = [0, 0.2, 0], radius = 1.1 }")
        + &object("frost", "sphere = { center = [0.4, 0.5, 0], radius = 0.3 }")
        + &object("both", "cube = { center = [-0.4, 0.4, 0], size = 0.5 }")
        + "[[light]]\nsun = { toward = [0.3, 1, 0.2], angular_diameter = 30, irradiance = 3 }\n";
    assert_agree("dome", &text, [2, 24]);
}

/// The radius is given in pixels. Their width grows with the distance from the camera, not from the start of a ray.
#[test]
fn photons_are_gathered_as_widely_behind_a_near_plane() {
    let map = MapPasses { radius: 1.0, ..NARROW };
    let [whole, cut] = ["", "\nnear = 1.2"].map(|near| {
        let text = mirror().replace("vertical_fov = 40", &format!("vertical_fov = 40{near}"));
        blocks(&scene_and_method(&text), true, Some(map), 4)
    });
    for (a, b) in whole.iter().zip(&cut) {
        assert!((a.0 - b.0).abs() <= 1e-4 * a.0, "{} for {}", b.0, a.0);
    }
}

/// All light of a point in a round room with a perfect mirror ball ends on the wall. Its mean is that of an
/// integrating sphere, reflectance times power over pi, area and 1 - reflectance (Goebel 1967, *Generalized
/// Integrating-Sphere Theory*). The rows of the image are weighted by their solid angle, so the camera in the middle
/// takes the mean over the wall. Photons on a concave wall did not fill the disc by which their sum is divided: 5 % of
/// the light was missing.
#[test]
fn photons_in_a_round_room_fill_it_with_light_however_wide_the_radius() {
    const ROWS: usize = 16;
    let text = format!(
        "camera = {{ projection = \"equirectangular\", position = [0, 0, 0], look_at = [0, 0, 1] }}\n\
         film = {{ width = {}, height = {ROWS} }}\nrender = {{ samples = 64 }}\n[material]\n\
         wall.diffuse.reflectance = 0.8\nmirror.mirror.reflectance = 1\n\
         [[object]]\nshape.sphere = {{ center = [0, 0, 0], radius = 1 }}\nmaterial = \"wall\"\n\
         [[object]]\nshape.sphere = {{ center = [0, 0, 0], radius = 0.45 }}\nmaterial = \"mirror\"\n\
         visible_to_camera = false\n[[light]]\npoint = {{ position = [0.6, 0, 0], intensity = 1 }}\n",
        2 * ROWS
    );
    let (scene, method) = scene_and_method(&text);
    assert!(method.map().is_some(), "photons are gathered");
    let film = film_of(&scene, method);
    let edge = |row: usize| (PI * row as f64 / ROWS as f64).cos();
    let weight = |row: usize| 0.5 * (edge(row) - edge(row + 1)) / (2 * ROWS) as f64;
    let pixels = film.pixels.iter().enumerate();
    let mean: f64 = pixels.map(|(pixel, value)| weight(pixel / (2 * ROWS)) * f64::from(value.rgb[1])).sum();
    let expected = 0.8 * 4.0 * PI / (PI * 4.0 * PI * (1.0 - 0.8));
    // The standard error is 0.002.
    assert!((mean / expected - 1.0).abs() < 0.02, "{mean} for {expected}");
}

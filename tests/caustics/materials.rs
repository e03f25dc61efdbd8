//! Photons and camera paths agree on surfaces of every kind: layers, holes, images, bent normals, rough glass.

use super::agreement::{ABOVE, BALL, FLOOR, LAMP, assert_agree, assert_agree_with_map, camera_and_film, glass};
use crate::support::scenes::{GROUND, object};

pub const ROUND_LAMP: &str = "sphere = { center = [0, 7, 0], radius = 1 }";
/// A square with bent normals.
pub const BENT: &str = "mesh = { points = [[-2, 0, -2], [2, 0, -2], [2, 0, 2], [-2, 0, 2]], faces = [[0, 2, 1], [0, 3, 2]], \
                        normals = [[0.6, 1, 0], [0, 1, 0.5], [-0.5, 1, 0], [0, 1, -0.6]], smooth = true }";

#[test]
fn a_caustic_on_plastic_that_mirrors_it_onto_a_wall() {
    let text = camera_and_film(ABOVE, "")
        + "[material.coated]\nplastic = { reflectance = { checker = [0.9, { rgb = [0.2, 0.4, 0.6] }], repeat = 2 } }\n"
        + &object("coated", GROUND)
        + "[material.wall]\ndiffuse = { reflectance = 0.8 }\n"
        + &object("wall", "quad = { center = [-0.9, 0.5, 0], u = [0, 0, 1], v = [0, 0.5, 0] }")
        + LAMP
        + &glass("index = 1.5")
        + &object("glass", BALL)
        + &object("lamp", ROUND_LAMP);
    assert_agree("plastic", &text, 16);
}

#[test]
fn a_caustic_through_the_holes_of_sheets_above_and_below_the_glass() {
    let text = camera_and_film(ABOVE, "")
        + FLOOR
        + LAMP
        + "[material.grey]\ndiffuse = { reflectance = 0.4 }\n\
           [material.lattice]\nmask = { material = \"grey\", opacity = { checker = [0, { rgb = [1, 0.5, 0.2] }], repeat = 4 } }\n"
        + &object("lattice", "quad = { center = [0, 3, 0], u = [1.5, 0, 0], v = [0, 0, 1.5] }")
        + &object("lattice", "quad = { center = [0, 0.3, 0], u = [0.6, 0, 0], v = [0, 0, 0.6] }")
        + &glass("index = 1.5")
        + &object("glass", BALL)
        + &object("lamp", ROUND_LAMP);
    assert_agree("holes", &text, 16);
}

#[test]
fn a_caustic_on_a_floor_of_bent_normals_and_by_way_of_smoothed_glass() {
    let gem = "mesh = { points = [[1, 1.2, 0], [-0.2, 1.2, 0], [0.4, 1.8, 0], [0.4, 0.6, 0], [0.4, 1.2, 0.6], [0.4, 1.2, -0.6]], \
               faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]], smooth = true }";
    let text = camera_and_film(ABOVE, "")
        + "[material.floor]\ndiffuse = { reflectance = 0.8 }\n"
        + &object("floor", BENT)
        + LAMP
        + &glass("index = 1.5")
        + &object("glass", gem)
        + &object("glass", "sphere = { center = [-0.5, 1.2, 0.2], radius = 0.5 }")
        + &object("lamp", ROUND_LAMP);
    assert_agree_with_map("bent", &text, [4, 20], None);
}

#[test]
fn a_caustic_on_rough_glass_seen_from_both_sides() {
    let text = camera_and_film("position = [2.5, 1.5, 2.5]\nlook_at = [0, 0.2, 0]\nvertical_fov = 30", "")
        + FLOOR
        + LAMP
        + "[material.frost]\ndielectric = { index = 1.4, roughness = 0.5 }\n"
        + &object("frost", "cube = { center = [0, 0.2, 0], size = [1.6, 0.4, 1.6] }")
        + &glass("index = 1.5")
        + &object("glass", BALL)
        + &object("lamp", ROUND_LAMP);
    assert_agree("frost", &text, 32);
}

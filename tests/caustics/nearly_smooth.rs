//! Caustics of nearly smooth surfaces: what polished metal and glossy coats reflect in a narrow lobe, and what frosted
//! glass refracts.

use super::agreement::{ABOVE, BALL, FLOOR, LAMP, assert_agree, assert_agree_with_map, camera_and_film, glass};
use super::gathered::NARROW;
use super::materials::{BENT, ROUND_LAMP};
use crate::support::scenes::object;

const METAL: &str = "[material.metal]\nconductor = { metal = \"Au\", roughness = 0.3 }\n";
const GLOSSY: &str =
    "[material.glossy]\nplastic = { reflectance = { rgb = [0.4, 0.3, 0.2] }, index = 1.5, roughness = 0.3 }\n";
/// Half mirror, half glossy plastic, at an opacity of two thirds.
const MIX: &str = "[material.mirror]\nmirror = { reflectance = 0.9 }\n\
                   [material.half]\nmix = { materials = [\"mirror\", \"glossy\"], amount = 0.5 }\n\
                   [material.mixed]\nmask = { material = \"half\", opacity = 0.67 }\n";

#[test]
fn a_ball_under_a_lamp() {
    for (what, material) in [("metal", METAL), ("glossy", GLOSSY), ("mixed", &(GLOSSY.to_owned() + MIX))] {
        let text =
            camera_and_film(ABOVE, "") + FLOOR + LAMP + material + &object(what, BALL) + &object("lamp", ROUND_LAMP);
        assert_agree(what, &text, 32);
    }
}

/// The reflection of each body lands on the others: on matte ones and, from smooth surfaces only, on metal.
#[test]
fn all_kinds_in_the_sun_on_a_glossy_floor() {
    let text = camera_and_film(ABOVE, "")
        + GLOSSY
        + MIX
        + METAL
        + &glass("index = 1.5")
        + &object("glossy", "plane = { point = [0, 0, 0], normal = [0, 1, 0] }")
        + &object("metal", "quad = { center = [-0.9, 0.5, 0], u = [0, 0, 1], v = [0.2, 0.5, 0] }")
        + &object("metal", "sphere = { center = [0.2, 0.3, 0.6], radius = 0.3 }")
        + &object("mixed", "cube = { center = [0.6, 0.5, -0.6], size = [0.6, 1, 0.6] }")
        + &object("glass", "sphere = { center = [0.5, 0.4, 0.1], radius = 0.3 }")
        + "[[light]]\nsun = { toward = [0.3, 1, 0.2], angular_diameter = 20, irradiance = 3 }\n";
    assert_agree("all kinds", &text, 32);
    let few = |bounces: u32| text.clone() + &format!("[render]\nmax_bounces = {bounces}\n");
    assert_agree("all kinds, two bounces", &few(2), 32);
    assert_agree_with_map("all kinds, gathered", &few(4), [32; 2], Some(NARROW));
}

#[test]
fn bent_normals_and_a_polarizer_before_the_wall() {
    for material in [METAL, &GLOSSY.replace("glossy", "metal")] {
        let text = camera_and_film(ABOVE, "")
            + LAMP
            + material
            + "[material.wall]\ndiffuse = { reflectance = 0.8 }\n[material.sheet]\npolarizer = { axis = [0, 1, 0] }\n"
            + &object("metal", BENT)
            + &object("wall", "quad = { center = [-0.9, 0.5, 0], u = [0, 0, 1], v = [0, 0.5, 0] }")
            + &object("sheet", "quad = { center = [-0.7, 0.5, 0.4], u = [0, 0, 0.4], v = [0, 0.5, 0] }")
            + &object("lamp", ROUND_LAMP);
        assert_agree("bent", &text, 32);
    }
}

/// Balls in water that is either visible to the camera or not. The light crosses its surface first.
#[test]
fn a_ball_in_water() {
    for seen in ["", "visible_to_camera = false\n"] {
        let text = camera_and_film(ABOVE, "")
            + FLOOR
            + LAMP
            + &glass("index = 1.33")
            + METAL
            + &object("glass", "cube = { center = [0, 0.3, 0], size = 1.4 }")
            + seen
            + &object("metal", "sphere = { center = [0.2, 0.5, 0], radius = 0.3 }")
            + &object("metal", "sphere = { center = [-0.9, 0.4, 0], radius = 0.15 }")
            + &object("lamp", "sphere = { center = [0, 4, 0], radius = 0.8 }");
        assert_agree("in water", &text, 64);
        assert_agree_with_map("in water, gathered", &text, [64; 2], Some(NARROW));
    }
}

#[test]
fn caustics_of_metal_are_seen_in_a_mirror() {
    let text = camera_and_film("position = [0, 1.2, 2.5]\nlook_at = [0, 0.8, -2]\nvertical_fov = 40", "")
        + FLOOR
        + LAMP
        + METAL
        + GLOSSY
        + MIX
        + &object("mirror", "quad = { center = [0, 2, -2], u = [3, 0, 0], v = [0, 2, 0.3] }")
        + &object("metal", BALL)
        + &object("glossy", "cube = { center = [1.2, 0.4, 0.3], size = 0.8 }")
        + &object("lamp", "sphere = { center = [0.5, 5, 0], radius = 0.6 }");
    assert_agree_with_map("in a mirror", &text, [64; 2], Some(NARROW));
}

const FROSTED: &str = "[material.frosted]\ndielectric = { index = 1.5, roughness = 0.25 }\n";

/// Frosted glass without a coating, with an absorbing coating, tinted, and with dispersion. Light is refracted through
/// it and reflected inside repeatedly.
#[test]
fn frosted_glass() {
    let with = |more: &str| FROSTED.replace("0.25", &format!("0.25, {more}"));
    for (what, glass, samples) in [
        ("bare", FROSTED.to_owned(), 32),
        ("coated", with("coating = [{ metal = \"Au\", thickness_nm = 10 }]"), 12),
        ("tinted", with("absorption = { rgb = [0.2, 1, 2] }, transmittance = 0.9, reflectance = 0.7"), 32),
        ("dispersing", FROSTED.replace("1.5", "\"N-SF11\""), 12),
    ] {
        let text = camera_and_film(ABOVE, "")
            + FLOOR
            + LAMP
            + &glass
            + &object("frosted", "cube = { center = [-0.7, 0.36, 0.3], size = 0.7 }")
            + &object("frosted", "sphere = { center = [0.6, 0.5, -0.2], radius = 0.4 }")
            + &object("lamp", "sphere = { center = [0.5, 4, 0], radius = 1 }");
        assert_agree(what, &text, samples);
    }
}

/// A lamp in a frosted bulb, and liquid with the index of glass in a frosted shell that stands in a pool.
#[test]
fn frosted_glass_around_a_lamp_and_in_water() {
    let bulb = camera_and_film(ABOVE, "")
        + FLOOR
        + LAMP
        + FROSTED
        + "[material.air]\ndielectric = { index = 1, roughness = 0.2, priority = 1 }\n"
        + &object("frosted", "sphere = { center = [0, 1, 0], radius = 0.6 }")
        + &object("air", "sphere = { center = [0, 1, 0], radius = 0.55 }")
        + &object("lamp", "sphere = { center = [0, 1, 0], radius = 0.35 }");
    assert_agree("bulb", &bulb, 24);
    let pool = camera_and_film(ABOVE, "")
        + FLOOR
        + LAMP
        + FROSTED
        + &glass("index = 1.33")
        + "[material.liquid]\ndielectric = { index = 1.5, roughness = 0.2, priority = 2 }\n"
        + &object("glass", "cube = { center = [0, 0.3, 0], size = 1.4 }")
        + &object("frosted", "sphere = { center = [0.2, 0.5, 0], radius = 0.3 }")
        + &object("liquid", "sphere = { center = [0.2, 0.5, 0], radius = 0.2 }")
        + &object("lamp", "sphere = { center = [0, 4, 0], radius = 0.8 }");
    for bounces in [3, 12] {
        let text = pool.clone() + &format!("[render]\nmax_bounces = {bounces}\n");
        assert_agree_with_map("in a pool", &text, [16, 32], Some(NARROW));
    }
}

/// The map finds the photons on the floor, close below the glass, and not those on the glass.
#[test]
fn a_map_under_frosted_glass_that_nearly_touches_the_floor() {
    let text = camera_and_film(ABOVE, "")
        + FLOOR
        + LAMP
        + FROSTED
        + &object("frosted", "cube = { center = [0, 0.301, 0], size = 0.6 }")
        + &object("lamp", "sphere = { center = [0.5, 4, 0], radius = 0.8 }");
    assert_agree_with_map("under the glass", &text, [8, 32], Some(NARROW));
}

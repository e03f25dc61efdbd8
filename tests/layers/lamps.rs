//! Lamps over plastic and mixes: aiming at them and meeting them agree.

use super::arrivals::PARTS;
use crate::support::scenes::{Mean, SINGLE_PATH, SPLITTING, body, images, view};

const FLOOR: &str = "plane = { point = [0, 0, 0], normal = [0, 1, 0] }";
const LAMP: &str = "sphere = { center = [-1, 2, 0], radius = 0.7 }";
const RADIANCE: &str = "{ rgb = [10, 20, 5] }";

fn floor(material: &str, lamp: &str, samples: u32) -> String {
    view([4.0, 3.0, 0.5], [0.5, 0.0, 0.0], 25.0, 12)
        + &format!("[render]\nsamples = {samples}\n")
        + PARTS
        + &body("floor", material, &[FLOOR])
        + lamp
}

#[test]
fn aiming_at_a_lamp_and_meeting_it_show_the_same() {
    let aimed_at = body("lamp", &format!("emissive = {{ radiance = {RADIANCE} }}"), &[LAMP]);
    // Glass that only shines is met by chance, and never aimed at.
    let dark = "index = 1.5, reflectance = 0, transmittance = 0";
    let met = body("lamp", &format!("dielectric = {{ {dark}, emission = {RADIANCE} }}"), &[LAMP]);
    let cases = [
        "plastic = { reflectance = { rgb = [0.8, 0.4, 0.1] } }",
        "plastic = { reflectance = { rgb = [0.8, 0.4, 0.1] }, roughness = 0.3 }",
        "mix = { materials = [\"smooth\", \"silver\"], amount = { rgb = [0.2, 0.5, 0.8] } }",
        "mix = { materials = [\"white\", \"mirror\"], amount = 0.3 }",
    ];
    for material in cases {
        let by_chance = images(&floor(material, &met, 2048), SINGLE_PATH, 8);
        let by_chance = Mean::over_seeds(by_chance.iter().map(|(film, _)| film));
        for transport in [SINGLE_PATH, SPLITTING] {
            let aimed = images(&floor(material, &aimed_at, 256), transport, 8);
            let mut aimed = Mean::over_seeds(aimed.iter().map(|(film, _)| film));
            println!("{material}: {aimed:.5?} for {by_chance:.5?}");
            for band in 0..3 {
                aimed.error[band] = libm::hypot(aimed.error[band], by_chance.error[band]);
            }
            assert!(aimed.worst_error(by_chance.value) < 0.01, "{aimed:?}");
            aimed.assert_near(by_chance.value, 2 * cases.len(), material);
        }
    }
}

#[test]
fn a_smooth_coat_still_mirrors_where_diffuse_light_has_ended() {
    // Above the mirror image of a lamp, with no diffuse bounce left, the coat shows it and the base its irradiance.
    let lamp = body("lamp", &format!("emissive = {{ radiance = {RADIANCE} }}"), &[LAMP]);
    let shown = |bounces: &str| {
        let text = floor("plastic = { reflectance = 0.5 }", &lamp, 512)
            .replace("[render]\n", &format!("[render]\n{bounces}"))
            .replace("look_at = [0.5, 0.0, 0.0]", "look_at = [1.1, 0, 0.15]");
        Mean::over_seeds(images(&text, SPLITTING, 4).iter().map(|(film, _)| film))
    };
    let (all, none) = (shown(""), shown("diffuse_bounces = 0\n"));
    // A floor alone sends nothing back to itself.
    let mut off = none;
    (0..3).for_each(|band| off.error[band] = libm::hypot(none.error[band], all.error[band]));
    assert!(off.worst_error(all.value) < 0.01, "{off:?}");
    off.assert_near(all.value, 1, "without diffuse bounces");
}

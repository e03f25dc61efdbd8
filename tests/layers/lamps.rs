//! Lamps above plastic and mixes: next-event estimation and random hits agree.

use crate::support::materials::BASE_MATERIALS;
use crate::support::scenes::{GROUND, Mean, SPLITTING, assert_next_event_agrees, body, lamps, view};

const LAMP: &str = "sphere = { center = [-1, 2, 0], radius = 0.7 }";

fn floor(material: &str, lamp: &str, samples: u32) -> String {
    view([4.0, 3.0, 0.5], [0.5, 0.0, 0.0], 25.0, 12)
        + &format!("[render]\nsamples = {samples}\n")
        + BASE_MATERIALS
        + &body("floor", material, &[GROUND])
        + lamp
}

#[test]
fn aiming_at_a_lamp_and_meeting_it_show_the_same() {
    let [aimed_at, met] = lamps(&[LAMP]);
    let cases = [
        "plastic = { reflectance = { rgb = [0.8, 0.4, 0.1] } }",
        "plastic = { reflectance = { rgb = [0.8, 0.4, 0.1] }, roughness = 0.3 }",
        "mix = { materials = [\"smooth\", \"silver\"], amount = { rgb = [0.2, 0.5, 0.8] } }",
        "mix = { materials = [\"white\", \"mirror\"], amount = 0.3 }",
    ];
    for material in cases {
        let [aimed_at, met] = [floor(material, &aimed_at, 256), floor(material, &met, 2048)];
        assert_next_event_agrees([&aimed_at, &met], 8, 0.01, 2 * cases.len(), material);
    }
}

#[test]
fn a_smooth_coat_still_mirrors_where_diffuse_light_has_ended() {
    // At the mirror image of a lamp, with no diffuse bounce left, the coat shows the lamp and the base shows its
    // irradiance.
    let [lamp, _] = lamps(&[LAMP]);
    let floor_mean = |bounces: &str| {
        let text = floor("plastic = { reflectance = 0.5 }", &lamp, 512)
            .replace("[render]\n", &format!("[render]\n{bounces}"))
            .replace("look_at = [0.5, 0.0, 0.0]", "look_at = [1.1, 0, 0.15]");
        Mean::render_text(&text, SPLITTING, 4)
    };
    let (all, none) = (floor_mean(""), floor_mean("diffuse_bounces = 0\n"));
    // A lone floor sends no light back to itself.
    let off = none.with_joint_error(&all);
    assert!(off.worst_relative_error(all.value) < 0.01, "{off:?}");
    off.assert_near(all.value, 1, "without diffuse bounces");
}

//! How the plan treats plastic, mixes and masks.

use abbe::plan::plan;
use abbe::trace::Transport;

use crate::support::materials::BASE_MATERIALS;
use crate::support::scenes::{body, scene, view};

const BALL: &str = "sphere = { center = [0, 0, 0], radius = 1 }";

fn planned(material: &str, more: &str) -> abbe::plan::Plan {
    let head = view([0.0, 0.0, 9.0], [0.0; 3], 20.0, 8).replace("height = 8\n", "height = 8\nfilter = \"center\"\n");
    plan(&scene(&(head + more + BASE_MATERIALS + &body("tested", material, &[BALL]) + POINT)))
}

const POINT: &str = "[[light]]\npoint = { position = [0, 3, 3], intensity = 10 }\n";

#[test]
fn the_index_of_a_coat_disperses_nothing() {
    for index in ["\"N-SF11\"", "{ cauchy = [1.5, 0.02] }", "{ rgb = [1.4, 1.5, 1.6] }"] {
        let plan = planned(&format!("plastic = {{ reflectance = 0.5, index = {index} }}"), "");
        assert!(!plan.method.basis.draws_wavelengths(), "{index}: {:?}", plan.because);
        assert!(plan.because.iter().all(|line| !line.contains("dispersi")), "{index}: {:?}", plan.because);
    }
}

#[test]
fn colors_under_a_coat_and_within_mixes_ask_for_as_many_lanes_as_alone() {
    let measured = "{ samples = [[400, 0.1], [500, 0.8], [520, 0.1], [600, 0.9], [700, 0.2]] }";
    let part = format!("[material.part]\ndiffuse = {{ reflectance = {measured} }}\n");
    let lanes = |material: &str, more: &str| planned(material, more).method.basis.lanes();
    let alone = lanes(&format!("diffuse = {{ reflectance = {measured} }}"), "");
    assert!(alone > 3);
    assert!(lanes(&format!("plastic = {{ reflectance = {measured} }}"), "") >= alone);
    assert!(lanes("mix = { materials = [\"part\", \"mirror\"], amount = 0.5 }", &part) >= alone);
    assert!(lanes("mask = { material = \"part\", opacity = 0.5 }", &part) >= alone);
}

#[test]
fn only_what_scatters_widely_is_left_to_chance() {
    for (material, random) in [
        ("mix = { materials = [\"mirror\", \"pane\"], amount = 0.5 }", false),
        ("mask = { material = \"mirror\", opacity = 0.5 }", false),
        ("mix = { materials = [\"mirror\", \"white\"], amount = 0.5 }", true),
        ("mask = { material = \"rough\", opacity = 0.5 }", true),
        ("plastic = { reflectance = 0.5 }", true),
    ] {
        let plan = planned(material, "");
        assert_eq!(matches!(plan.method.transport, Transport::Random { .. }), random, "{material}: {:?}", plan.because);
        let left_out = plan.because.iter().any(|line| line.starts_with("left out"));
        assert_eq!(left_out, material.contains("white") || material.starts_with("plastic"), "{:?}", plan.because);
    }
    // With no bounce between diffuse surfaces, a smooth coat and its base need no random choices under a point light.
    let plan = planned("plastic = { reflectance = 0.5 }", "[render]\ndiffuse_bounces = 0\n");
    assert!(matches!(plan.method.transport, Transport::Deterministic { .. }), "{:?}", plan.because);
    let plan = planned("plastic = { reflectance = 0.5, roughness = 0.3 }", "[render]\ndiffuse_bounces = 0\n");
    assert!(matches!(plan.method.transport, Transport::Random { .. }), "{:?}", plan.because);
}

//! Rough metals under lamps: next-event estimation and random hits agree, and nearly smooth metals look smooth.

use abbe::material::{Material, Roughness, Scatter, ScatterContext};
use abbe::math::DVec3;
use abbe::plan::plan;
use abbe::spectrum::Draw;
use abbe::trace::{Transport, prepare};

use crate::support::materials::context;
use crate::support::scenes::{
    EVERY_BRANCH, GROUND, Mean, SINGLE_PATH, assert_next_event_agrees, body, lamps, method, render_film, scene, view,
};

const LAMP: &str = "sphere = { center = [-1, 2, 0], radius = 0.7 }";

/// Returns a floor of gold under a lamp that is not in view.
fn gold(roughness: f64, lamp: &str, samples: u32) -> String {
    view([4.0, 3.0, 0.5], [0.5, 0.0, 0.0], 25.0, 12)
        + &format!("[render]\nsamples = {samples}\n")
        + &body("gold", &format!("conductor = {{ metal = \"Au\", roughness = {roughness:?} }}"), &[GROUND])
        + lamp
}

#[test]
fn aiming_at_a_lamp_and_meeting_it_show_the_same() {
    let [aimed_at, met] = lamps(&[LAMP]);
    let cases = [0.15, 0.3, 0.6, 1.0];
    for roughness in cases {
        let [aimed_at, met] = [gold(roughness, &aimed_at, 128), gold(roughness, &met, 1024)];
        assert_next_event_agrees([&aimed_at, &met], 8, 0.01, 2 * cases.len(), &format!("roughness {roughness}"));
    }
}

#[test]
fn a_point_light_shows_the_brdf_itself() {
    let point = "[[light]]\npoint = { position = [-1, 2, 0.3], intensity = 10 }\n";
    for roughness in [0.2, 0.7] {
        let text = view([4.0, 3.0, 0.5], [0.5, 0.0, 0.0], 1e-6, 1)
            + &body("gold", &format!("conductor = {{ metal = \"Au\", roughness = {roughness:?} }}"), &[GROUND])
            + point;
        let scene = scene(&text);
        let world = prepare(&scene, method(&scene, SINGLE_PATH));
        let draw = Draw::<4>::fixed(3);
        let here = DVec3::new(0.5, 0.0, 0.0);
        let (wo, to_light) = ((DVec3::new(4.0, 3.0, 0.5) - here).normalize(), DVec3::new(-1.0, 2.0, 0.3) - here);
        let context = ScatterContext { normal: DVec3::Y, ..context(&draw, wo, 1.0) };
        let evaluated = world.scene().material_of(0).evaluate(&context, to_light.normalize());
        let (brdf_cos, _) = evaluated.expect("the light is above the floor");
        let shown = render_film(&text, SINGLE_PATH).0.pixels[0].rgb;
        for (band, shown) in shown.into_iter().enumerate() {
            let expected = 10.0 * f64::from(brdf_cos[band]) / to_light.length_squared();
            assert!((f64::from(shown) / expected - 1.0).abs() < 1e-5, "{roughness}: {shown} for {expected}");
        }
    }
}

#[test]
fn the_smoother_a_metal_the_more_it_looks_like_a_smooth_one() {
    // The mirror image of the lamp is in view, with its edge.
    let [lamp, _] = lamps(&[LAMP]);
    let shown = |roughness: f64| {
        let text = gold(roughness, &lamp, 256).replace("look_at = [0.5, 0.0, 0.0]", "look_at = [1.1, 0, 0.15]");
        Mean::render_text(&text, SINGLE_PATH, 8)
    };
    let smooth = shown(0.0);
    assert_eq!(smooth, shown(0.009), "below the least roughness the image is the same to the last bit");
    assert!(smooth.value[0] > 0.5, "the lamp is seen: {smooth:?}");
    let off = [0.4, 0.2, 0.05, 0.011].map(|roughness| {
        let rough = shown(roughness);
        let off = (rough.value[1] / smooth.value[1] - 1.0).abs();
        println!("roughness {roughness}: {off:.5} +- {:.5}", rough.error[1] / smooth.value[1]);
        (off, 4.0 * libm::hypot(rough.error[1], smooth.error[1]) / smooth.value[1])
    });
    assert!(off[0].0 > 0.1, "a rough metal looks different: {off:?}");
    assert!(off[3].0 < 0.001 + off[3].1 && off[3].1 < 0.01, "{off:?}");
}

#[test]
fn a_scene_with_a_rough_metal_is_left_to_chance_and_a_smooth_one_is_not() {
    for (roughness, random) in [(0.0, false), (0.009, false), (0.02, true), (1.0, true)] {
        for bounces in ["", "diffuse_bounces = 0\n"] {
            let text = gold(roughness, "", 1).replace("samples = 1\n", bounces);
            let text = text.replace("height = 12\n", "height = 12\nfilter = \"center\"\n")
                + "[[light]]\npoint = { position = [0, 3, 3], intensity = 10 }\n";
            let plan = plan(&scene(&text));
            assert_eq!(matches!(plan.method.transport, Transport::Random { .. }), random, "{:?}", plan.because);
            let left_out = plan.because.iter().any(|line| line.starts_with("left out"));
            assert!(!left_out, "no light of the point is left out: {:?}", plan.because);
        }
    }
}

#[test]
fn deterministic_transport_follows_rough_metals_as_well() {
    // The plan does not choose this, but it must not fail: one direction and all lights.
    let [lamp, _] = lamps(&[LAMP]);
    let (film, _) = render_film(&gold(0.5, &lamp, 16), EVERY_BRANCH);
    assert!(film.pixels.iter().all(|pixel| pixel.rgb.iter().all(|x| x.is_finite() && *x > 0.0)));
    assert!(Roughness::new(0.5).surface().is_some());
}

/// Tables of rough surfaces take long to compute. Surfaces with the same roughness share them, whatever they are made
/// of.
#[test]
fn surfaces_that_are_as_rough_share_their_tables() {
    let metal = |roughness: f64| format!("conductor = {{ metal = \"Au\", roughness = {roughness:?} }}");
    let text = view([4.0, 3.0, 0.5], [0.5, 0.0, 0.0], 10.0, 1)
        + &body("gold", &metal(0.25), &[GROUND])
        + &body("copper", "conductor = { metal = \"Cu\", roughness = 0.25 }", &[GROUND])
        + &body("other", &metal(0.5), &[GROUND])
        + &body("red", "plastic = { reflectance = 0.5, roughness = 0.25 }", &[GROUND])
        + &body(
            "frost",
            "dielectric = { index = 1.5, roughness = 0.25 }",
            &["sphere = { center = [0, 2, 0], radius = 1 }"],
        );
    let scene = scene(&text);
    let roughness = |object: u32| match scene.material_of(object) {
        Material::Conductor(conductor) => &conductor.roughness,
        Material::Plastic(plastic) => plastic.coat.roughness(),
        Material::Dielectric(dielectric) => &dielectric.roughness,
        other => panic!("{other:?}"),
    };
    let surface = |object: u32| std::ptr::from_ref(roughness(object).surface().expect("it is rough"));
    assert_eq!([1, 3, 4].map(surface), [surface(0); 3]);
    assert_ne!(surface(2), surface(0));
}

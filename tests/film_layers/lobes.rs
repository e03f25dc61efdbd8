//! Light sorted by the lobe of the first surface, where photons contribute it.

use abbe::film::Layer;

use super::{assert_sum, beauty, render_text, rgb};

/// A caustic in glass, seen by a camera that looks through the surface of water that the glass displaces. Photons are
/// gathered where the camera's ray first scatters. Some of them come straight from the lamp and cross only that
/// surface.
const BEHIND_HIDDEN_WATER: &str = r#"
camera = { position = [0, 1, 1.5], look_at = [0, 0, 0], vertical_fov = 50 }
film = { width = 12, height = 12 }
render = { samples = 8 }
[material]
glass.dielectric = { index = 1.5, priority = 1 }
water.dielectric = { index = 1.33 }
gem.dielectric = { index = 2.2, priority = 2 }
floor.diffuse.reflectance = 0.7
lamp.emissive.radiance = 300
[[object]]
shape.cube = { center = [0, 1, 0], size = 8 }
material = "glass"
[[object]]
shape.cube = { center = [0, 0, 0], size = [3, 0.6, 3] }
material = "water"
[[object]]
shape.sphere = { center = [0.2, 0.75, -0.3], radius = 0.25 }
material = "gem"
[[object]]
shape.quad = { center = [0, 0, 0], u = [1.4, 0, 0], v = [0, 0, -1.4] }
material = "floor"
[[object]]
shape.sphere = { center = [0.2, 3, -0.3], radius = 0.1 }
material = "lamp"
"#;

const LOBES: [Layer; 9] = [
    Layer::Emission,
    Layer::DiffuseDirect,
    Layer::DiffuseIndirect,
    Layer::GlossyDirect,
    Layer::GlossyIndirect,
    Layer::SpecularDirect,
    Layer::SpecularIndirect,
    Layer::TransmissionDirect,
    Layer::TransmissionIndirect,
];

#[test]
fn photons_that_are_gathered_at_the_first_surface_have_its_lobes_and_are_direct_where_they_come_straight() {
    let image = render_text(BEHIND_HIDDEN_WATER, &[LOBES.as_slice(), &[Layer::Caustics]].concat());
    let total = |layer: &str| rgb(&image, layer).iter().flatten().sum::<f64>();
    let all = beauty(&image).iter().flatten().sum::<f64>();
    assert!(total("caustics") > 0.3 * all && total("diffuse_direct") > 0.1 * all, "{} of {all}", total("caustics"));
    assert_sum(&image, &LOBES.map(Layer::name), 1.0);
    // The result does not depend on which other layers are asked for.
    let plain = render_text(BEHIND_HIDDEN_WATER, &[Layer::Direct]);
    let direct = rgb(&plain, "direct").iter().flatten().sum::<f64>();
    assert!((direct / total("diffuse_direct") - 1.0).abs() < 1e-5, "{direct}");
}

/// The light of [`BEHIND_HIDDEN_WATER`] is seen from below the water's surface, where photons are splatted.
#[test]
fn photons_that_are_shown_are_direct_where_they_come_straight() {
    let below = BEHIND_HIDDEN_WATER.replace("position = [0, 1, 1.5]", "position = [0, 0.2, 1.4]");
    let image = render_text(
        &below.replace("radius = 0.1 ", "radius = 0.05 "),
        &[Layer::Direct, Layer::DiffuseDirect, Layer::Caustics],
    );
    let total = |layer: &str| rgb(&image, layer).iter().flatten().sum::<f64>();
    let parts = ["direct", "diffuse_direct", "caustics"].map(total);
    assert!(parts[0] > 0.1 * parts[2] && (parts[1] / parts[0] - 1.0).abs() < 1e-5, "{parts:?}");
}

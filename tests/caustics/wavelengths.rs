//! Every camera sample has the same wavelengths with a photon map as without one.

use abbe::plan::plan;
use abbe::trace::{LightPass, MapPasses, Method, Smoothness};

use super::agreement::{ABOVE, FLOOR, assert_agree_with_map, camera_and_film, glass};
use crate::support::scenes::{SPLITTING, film_of, object, scene};

/// Everything seen through dispersive glass had one wrong color when the paths of a pass shared their wavelengths.
#[test]
fn k1_glass_that_no_photon_lights_is_the_same_to_the_last_bit_with_a_map_and_without() {
    let text = camera_and_film("position = [0, 0, 5]\nlook_at = [0, 0, 0]\nvertical_fov = 30", "")
        + "[render]\nmodel = \"hero\"\n"
        + &glass("index = \"N-SF66\"")
        + &object("glass", "sphere = { center = [0, 0, 0], radius = 1 }")
        + "[[light]]\nenvironment = { radiance = 1 }\n[[light]]\npoint = { position = [1, 5, 1], intensity = 1 }\n";
    let scene = scene(&text);
    for samples in [1, 4, 16, 64] {
        let image = |map: Option<MapPasses>| {
            let light_pass = map.map(|map| LightPass {
                photons: 4096,
                lights: vec![1],
                openings: Vec::new(),
                to: vec![Smoothness::Whole],
                map: Some(map),
            });
            let method = Method { samples, transport: SPLITTING, light_pass, ..plan(&scene).method };
            film_of(&scene, method).pixels
        };
        let map = MapPasses { count: samples.div_ceil(4), photons: 4096, radius: 1.0, chance: 1.0 };
        assert!(image(Some(map)) == image(None), "{samples} samples differ");
    }
}

/// The wavelengths of a line spectrum either coincide or belong to other lines. Those of a smooth spectrum fall into
/// bins. Photons and paths may part or not: the light of a prism and a mirror is seen directly and through another
/// prism.
#[test]
fn k2_lines_and_smooth_spectra_thrown_by_a_prism_and_a_mirror_are_seen_through_another_prism() {
    let prism = |x: f64| {
        format!(
            "mesh = {{ points = [[{0}, 0.4, -0.6], [{1}, 0.4, -0.6], [{x}, 1.4, -0.6], [{0}, 0.4, 0.6], [{1}, 0.4, 0.6], \
             [{x}, 1.4, 0.6]], faces = [[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]] }}",
            x - 0.6,
            x + 0.6
        )
    };
    for (what, radiance) in [
        ("lines", "{ lines = [[435.8, 3], [546.1, 4], [577.0, 1], [579.1, 1], [612, 5]] }"),
        ("smooth", "{ blackbody = 3000, scale = 5 }"),
    ] {
        let text = camera_and_film(ABOVE, "")
            + "[render]\nmodel = \"hero\"\n"
            + FLOOR
            + &format!("[material.lamp]\nemissive = {{ radiance = {radiance} }}\n")
            + "[material.mirror]\nmirror = { reflectance = { rgb = [0.9, 0.7, 0.5] } }\n\
               [material.frost]\ndielectric = { index = \"N-SF11\", roughness = 0.4 }\n"
            + &glass("index = \"N-SF11\"")
            + &object("glass", &prism(0.0))
            + &object("glass", &prism(1.4))
            + &object("mirror", "quad = { center = [0.2, 0.7, -1.1], u = [0.8, 0, 0], v = [0, 0.6, 0.1] }")
            + &object("frost", "cube = { center = [0.7, 0.15, 0.6], size = [0.8, 0.3, 0.5] }")
            + &object("lamp", "disc = { center = [-2, 2.5, 0], normal = [2, -2, 0], radius = 0.6 }");
        assert_agree_with_map(
            what,
            &text,
            [4; 2],
            Some(MapPasses { count: 4, photons: 4096, radius: 0.15, chance: 1.0 }),
        );
    }
}

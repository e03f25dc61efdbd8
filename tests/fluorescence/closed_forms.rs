//! Rendered colors without random choices.

use std::f64::consts::PI;

use abbe::plan::plan;
use abbe::spectrum::{ColorSpace, Curve, CurveKind, Dye, apply, visible};

use super::{BRIGHTENER, BellDye, RED, YELLOW, assert_color, color, light, pixel};
use crate::support::scenes::{body, film_of, scene, view};

const PAPER: &str = "quad = { center = [0, 0, 0], u = [2, 0, 0], v = [0, 2, 0] }";

/// Renders paper below a point light in a single pixel. The result is relative to the light's irradiance over pi.
fn lit_paper(material: &str, illuminant: &str, more: &str) -> [f64; 3] {
    pixel(&lit_scene(material, illuminant, more))
}

fn lit_scene(material: &str, illuminant: &str, more: &str) -> String {
    let intensity = 4.0 * PI;
    let lamp = format!(
        "point = {{ position = [0, 0, 2], intensity = {{ illuminant = \"{illuminant}\", scale = {intensity:?} }} }}"
    );
    view([0.5, 0.0, 4.0], [0.0; 3], 1e-3, 1)
        + "[render]\nsamples = 1\n[[light]]\n"
        + &format!("{lamp}\n")
        + &body("paper", material, &[PAPER])
        + more
}

#[test]
fn one_photon_gives_one() {
    let shines = |nm: f64| libm::exp(-0.5 * ((nm - 520.0) / 20.0_f64).powi(2)) / nm;
    let emission = visible::wavelengths().map(|nm| [nm, shines(nm)]).collect();
    let dye = Dye { absorption: 1.0.into(), emission: Curve::from(CurveKind::Samples(emission)), quantum_yield: 1.0 };
    let power = dye.power_per_nm() * 405.0;
    assert!((power - 0.780_003).abs() < 1e-6, "{power}");
    // Counted in photons, each with an energy of 1 / nm.
    let total: f64 = visible::wavelengths().map(shines).sum();
    let photons: f64 = visible::wavelengths().map(|nm| power * shines(nm) / total * nm / 405.0).sum();
    assert!((photons - 1.0).abs() < 1e-12, "{photons}");
}

#[test]
fn dyes_have_the_colors_of_their_matrices() {
    let rows: [(BellDye, &str, [f64; 3]); 9] = [
        (YELLOW, "D65", [0.803_904, 1.168_084, 0.346_924]),
        (YELLOW, "A", [0.991_020, 0.995_397, 0.129_157]),
        (YELLOW, "FL11", [0.879_344, 1.062_595, 0.186_003]),
        (RED, "D65", [1.050_030, 0.719_865, 0.962_303]),
        (RED, "A", [1.127_219, 0.743_343, 0.305_291]),
        (RED, "FL11", [1.081_292, 0.662_621, 0.572_306]),
        (BRIGHTENER, "D65", [0.908_949, 0.925_202, 1.184_591]),
        (BRIGHTENER, "A", [1.015_749, 0.920_782, 0.354_706]),
        (BRIGHTENER, "FL11", [0.929_920, 0.920_280, 0.600_078]),
    ];
    for (dye, illuminant, xyz) in rows {
        let what = format!("{} by {illuminant}", dye.name);
        let expected = apply(&ColorSpace::Rec709.matrix_from_xyz(), xyz);
        let light = light(illuminant);
        let brightness: f64 = visible::wavelengths().zip(&light).map(|(nm, light)| dye.excited(nm) * light).sum();
        let leaving: Vec<f64> = visible::wavelengths()
            .zip(light.iter().zip(dye.glow()))
            .map(|(nm, (light, glow))| dye.reflected(nm) * light + brightness * glow)
            .collect();
        assert_color(color(&leaving), expected, 2e-6, &format!("{what}, summed"));
        // The error is that of the paper's colors in 32 lanes.
        assert_color(lit_paper(&dye.material(), illuminant, ""), expected, 2e-4, &format!("{what}, rendered"));
    }
}

/// The stated error covers a dye's reflected and emitted light together.
#[test]
fn the_plan_bounds_the_error_of_dyed_paper() {
    for dye in [YELLOW, RED, BRIGHTENER] {
        for illuminant in ["D65", "A", "FL11"] {
            let text = lit_scene(&dye.material(), illuminant, "");
            let scene = scene(&text);
            let plan = plan(&scene);
            let found = film_of(&scene, plan.method.clone()).pixels[0].rgb.map(f64::from);
            // 32 lanes have errors of at most 2e-4.
            let share = plan.model_error + 2e-4;
            assert_color(found, pixel(&text), share, &format!("{} by {illuminant}, at most {share:.1e}", dye.name));
        }
    }
}

/// A sheet of colored glass filters both the light that arrives at the dye and the light that is seen.
#[test]
fn light_that_excites_and_light_that_is_seen_are_filtered_by_their_own_wavelengths() {
    let crosses = |nm: f64| 0.3 + 0.6 / (1.0 + libm::exp((470.0 - nm) / 15.0));
    let sheet = visible::wavelengths().map(|nm| format!("[{nm}, {:e}]", crosses(nm))).collect::<Vec<_>>().join(", ");
    let sheet = body(
        "sheet",
        &format!("thin = {{ index = 1.0000001, transmittance = {{ samples = [{sheet}] }} }}"),
        &["quad = { center = [0, 0, 1], u = [2, 0, 0], v = [0, 2, 0] }"],
    );
    for (dye, illuminant) in [(YELLOW, "D65"), (RED, "A"), (BRIGHTENER, "D65"), (BRIGHTENER, "FL11")] {
        let light = light(illuminant);
        let brightness: f64 =
            visible::wavelengths().zip(&light).map(|(nm, light)| dye.excited(nm) * crosses(nm) * light).sum();
        let leaving: Vec<f64> = visible::wavelengths()
            .zip(light.iter().zip(dye.glow()))
            .map(|(nm, (light, glow))| crosses(nm) * (crosses(nm) * dye.reflected(nm) * light + brightness * glow))
            .collect();
        let found = lit_paper(&dye.material(), illuminant, &sheet);
        assert_color(found, color(&leaving), 3e-4, &format!("{} by {illuminant}", dye.name));
    }
}

/// Patches of a dye between patches of gray. Light that a patch absorbs is emitted from the same patch.
#[test]
fn a_partly_dyed_surface_fluoresces_in_proportion() {
    let mixed = format!(
        "mix = {{ materials = [\"dyed\", \"gray\"], amount = 0.25 }}\n[material.dyed]\n{}\n[material.gray]\n\
         diffuse = {{ reflectance = 0.4 }}",
        YELLOW.material()
    );
    let [dyed, gray] =
        [YELLOW.material(), "diffuse = { reflectance = 0.4 }".to_owned()].map(|m| lit_paper(&m, "D65", ""));
    let expected = [0, 1, 2].map(|c| 0.75 * dyed[c] + 0.25 * gray[c]);
    assert_color(lit_paper(&mixed, "D65", ""), expected, 1e-6, "three quarters");
    let masked = format!("mask = {{ material = \"dyed\", opacity = 0.75 }}\n[material.dyed]\n{}\n", YELLOW.material());
    assert_color(lit_paper(&masked, "D65", ""), dyed.map(|x| 0.75 * x), 1e-6, "a mask");
}

/// The dye's absorption and the surface's reflectance are shares of the same light, also at each texel of an image.
#[test]
fn a_dye_under_an_image_is_refused_where_a_texel_leaves_no_room_for_it() {
    let refused = |absorbed: f64| {
        let text = format!(
            "[camera]\nposition = [0, 0, 5]\nlook_at = [0, 0, 0]\nvertical_fov = 40\n[film]\nwidth = 4\nheight = 4\n\
             [material.paper]\ndiffuse = {{ reflectance = {{ image = \"dots.png\" }}, fluorescence = {{ quantum_yield = 0.9, \
             absorption = {{ samples = [[400, {absorbed}], [500, 0]] }}, \
             emission = {{ samples = [[510, 0], [520, 1], [580, 0]] }} }} }}\n\
             [[object]]\nmaterial = \"paper\"\nshape.sphere = {{ center = [0, 0, 0], radius = 1 }}\n\
             [[light]]\nenvironment = {{ radiance = 1 }}\n"
        );
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/messages");
        abbe::Scene::parse(&text, folder).err().map(|error| error.to_string())
    };
    // The lightest dots reflect 0.7 of ultraviolet light.
    assert_eq!(refused(0.25), None);
    assert!(refused(0.5).is_some_and(|message| message.contains("reflectance and absorption add up to")));
}

//! The light that dyes emit is unpolarized, and is polarized on its way to the camera like any other light.

use super::YELLOW;
use crate::polarization::stokes_vectors;
use crate::support::scenes::{one_pixel, render_text};

/// Returns the Stokes vectors of red, green and blue that a pixel receives from a material under a point light.
fn stokes(material: &str, camera: &str, more: &str) -> [[f64; 3]; 4] {
    let text = one_pixel(camera, ", stokes = true")
        + &format!(
            "render.samples = 8\n[material.paper]\n{material}\n[[light]]\n\
             point = {{ position = [2, 0, 1], intensity = {{ illuminant = \"D65\", scale = 20 }} }}\n{more}"
        );
    stokes_vectors(render_text(&text).film())
}

const STRAIGHT: &str =
    "[[object]]\nmaterial = \"paper\"\nshape.quad = { center = [0, 0, 0], u = [1, 0, 0], v = [0, 1, 0] }\n";
/// Glass that reflects the paper, which stands to the side.
const IN_GLASS: &str = "[[object]]\nmaterial = \"paper\"\nshape.quad = { center = [-4, 0, 0], u = [0, 0, 1], v = [0, 1, 0] }\n\
     [material.glass]\ndielectric = { index = 1.5, absorption = 1000 }\n[[object]]\nmaterial = \"glass\"\n\
     shape.quad = { center = [0, 0, 0], u = [0.5, 0, 0.5], v = [0, 0.5, 0] }\n";

#[test]
fn a_filter_takes_half_of_what_a_dye_emits() {
    let paper = YELLOW.material();
    let open = stokes(&paper, "", STRAIGHT)[0];
    let filtered = stokes(&paper, ", polarizer = { axis = 30, extinction = 0 }", STRAIGHT);
    let strongest = open[1];
    let (cos, sin) = (0.5, 0.75_f64.sqrt());
    for c in 0..3 {
        for (component, share) in [0.5, 0.5 * cos, 0.5 * sin, 0.0].into_iter().enumerate() {
            let (found, expected) = (filtered[component][c], share * open[c]);
            assert!((found - expected).abs() < 1e-6 * strongest, "S{component} of {c}: {found} for {expected}");
        }
    }
}

#[test]
fn glass_polarizes_what_a_dye_emits_as_it_does_what_paper_scatters() {
    let [dyed, gray] =
        [YELLOW.material(), "diffuse = { reflectance = 0.5 }".to_owned()].map(|m| stokes(&m, "", IN_GLASS));
    assert!(gray[1][1].abs() > 0.3 * gray[0][1], "{gray:?}");
    for c in 0..3 {
        for component in 1..4 {
            let (found, expected) =
                (dyed[component][c] / dyed[0][1], gray[component][c] * dyed[0][c] / gray[0][c] / dyed[0][1]);
            assert!((found - expected).abs() < 1e-6, "S{component} of {c}: {found} for {expected}");
        }
    }
}

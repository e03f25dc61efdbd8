//! Light that a shading normal folds at the surface keeps its own polarization.

use abbe::math::DVec3;

use super::stokes;
use crate::support::scenes::assert_near;

/// Returns a surface of some material and a sun of irradiance 1.
fn sunlit(material: &str, shape: &str, toward: DVec3) -> String {
    let DVec3 { x, y, z } = toward;
    format!(
        "[material.rough]\n{material}\n[[object]]\nmaterial = \"rough\"\nshape.{shape}\n\
         [[light]]\nsun = {{ toward = [{x:?}, {y:?}, {z:?}], angular_diameter = 0, irradiance = 1 }}\n"
    )
}

/// A level triangle with a tilted shading normal scatters the light of a low sun and of its mirror image in the level
/// like a tilted surface. Mesh normals are f32.
#[test]
fn both_lights_of_a_bent_surface_are_polarized_as_they_arrive() {
    let tilt = DVec3::new(0.4_f64.sin() * 0.8, 0.4_f64.sin() * 0.6, 0.4_f64.cos());
    let normal = format!("[{:?}, {:?}, {:?}]", tilt.x, tilt.y, tilt.z);
    let bent = format!(
        "mesh = {{ points = [[-1, -1, 0], [1, -1, 0], [0, 1, 0]], faces = [[0, 1, 2]], \
         normals = [{normal}, {normal}, {normal}] }}"
    );
    let tilted = format!("disc = {{ center = [0, 0, 0], normal = {normal}, radius = 1 }}");
    let metal = "conductor = { n = 0.43, k = 2.455, roughness = 0.7 }";
    let plastic = "plastic = { reflectance = 0.4, roughness = 0.8 }";
    for toward in [DVec3::new(0.9, 0.3, 0.15), DVec3::new(0.5, 0.9, 0.2), DVec3::new(0.9, -0.2, 0.1)] {
        let below = DVec3 { z: -toward.z, ..toward };
        for (material, camera) in [
            (metal, ""),
            (metal, ", polarizer = { axis = 30 }"),
            (plastic, ""),
            (plastic, ", polarizer = { axis = 100 }"),
        ] {
            let stokes_of = |shape: &str, toward: DVec3| stokes(camera, &sunlit(material, shape, toward));
            let (found, [straight, folded]) =
                (stokes_of(&bent, toward), [toward, below].map(|sun| stokes_of(&tilted, sun)));
            assert!(straight[0] > 1e-3 && folded[0] > 1e-3, "{material}: both bring light");
            let expected = [0, 1, 2, 3].map(|i| straight[i] + folded[i]);
            assert_near(found, expected, 1e-6, &format!("{material}{camera}, sun toward {toward}"));
        }
    }
}

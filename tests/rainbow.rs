//! The rainbow: a drop of water returns parallel sunlight most strongly at the angles that Descartes found.
//!
//! ```text
//! cargo test --release --test all rainbow::
//! ```

use abbe::spectrum::{Basis, ColorSpace, data, visible};
use abbe::trace::{Method, Transport};

use crate::support::fresnel::reflectance_by_angles;
use crate::support::scenes::{film_of, method, scene};

const CAMERA: f64 = 1e6;
const SUN_DEGREES: f64 = 0.2;
/// All paths inside the drop are followed while they carry more than this. The secondary bow carries some thousandths.
const FAINT: Transport = Transport::Deterministic { cutoff: 1e-6, max_sample_surfaces: u64::MAX };

/// Light that is reflected a number of times inside the drop before it leaves.
struct Bow {
    reflections: i32,
    /// Range on the drop's disc of radius 1 in which light of this order is looked for.
    impact: [f64; 2],
    /// Deviations in degrees. At the first there is no light of this order, at the second there is some.
    dark_and_lit: [f64; 2],
}

const PRIMARY: Bow = Bow { reflections: 1, impact: [0.74, 0.94], dark_and_lit: [134.0, 140.0] };
const SECONDARY: Bow = Bow { reflections: 2, impact: [0.90, 0.99], dark_and_lit: [226.0, 234.5] };

impl Bow {
    /// Returns the incidence and the deviation in radians of Descartes's ray, the one with the least deviation.
    fn descartes(&self, index: f64) -> [f64; 2] {
        let k = f64::from(self.reflections);
        let incidence = ((index * index - 1.0) / (k * (k + 2.0))).sqrt().acos();
        let refraction = (incidence.sin() / index).asin();
        [incidence, k * std::f64::consts::PI + 2.0 * incidence - 2.0 * (k + 1.0) * refraction]
    }

    /// Returns the angle from the antisolar point in degrees.
    fn angle(deviation: f64) -> f64 {
        (deviation - 180.0).abs()
    }

    /// Returns the fraction of light that is left after two refractions and the reflections between them.
    fn share(&self, index: f64) -> f64 {
        let [incidence, _] = self.descartes(index);
        let refraction = (incidence.sin() / index).asin();
        let reflectance = reflectance_by_angles(incidence, refraction);
        (1.0 - reflectance).powi(2) * reflectance.powi(self.reflections)
    }

    /// Returns whether light of this order reaches the camera from a sun at a deviation in degrees.
    fn is_lit(&self, nm: f64, index: f64, deviation: f64) -> bool {
        const PIXELS: u32 = 600;
        let [low, high] = self.impact;
        let pixel = (high - low) / f64::from(PIXELS);
        let fov = 2.0 * (0.5 * pixel / CAMERA).atan().to_degrees();
        let (sin, cos) = deviation.to_radians().sin_cos();
        // The drop bends rays that hit it on the right to the left.
        let text = format!(
            "[camera]\nposition = [{x:?}, 0, {CAMERA:?}]\nlook_at = [{x:?}, 0, 0]\nvertical_fov = {fov:?}\n\
             [film]\nwidth = {PIXELS}\nheight = 1\nfilter = \"center\"\ncolor_space = \"lin_ciexyzd65_scene\"\n\
             [material.water]\ndielectric = {{ index = \"water\" }}\n\
             [[object]]\nmaterial = \"water\"\nshape.sphere = {{ center = [0, 0, 0], radius = 1 }}\n\
             [[light]]\nsun = {{ toward = [{:?}, 0, {:?}], angular_diameter = {SUN_DEGREES:?}, \
             irradiance = {{ lines = [[{nm:?}, 1]] }} }}\n",
            -sin,
            -cos,
            x = 0.5 * (low + high),
        );
        let scene = scene(&text);
        let basis = Basis::wavelengths(ColorSpace::Xyz, vec![550.0], &[nm]);
        let film = film_of(&scene, Method { basis, ..method(&scene, FAINT) });
        let half = (0.5 * SUN_DEGREES).to_radians();
        let disc = visible::color_matching(nm)[0] / visible::y_integral() / (std::f64::consts::PI * half.sin().powi(2));
        // Light of higher orders that passes here is fainter by a factor of a hundred or more.
        film.pixels.iter().any(|pixel| f64::from(pixel.rgb[0]) > 0.2 * disc * self.share(index))
    }

    /// Returns the least deviation in degrees, at which the edge of an approaching sun begins to reach the camera.
    fn least_deviation(&self, nm: f64, index: f64) -> f64 {
        let [mut dark, mut lit] = self.dark_and_lit;
        assert!(!self.is_lit(nm, index, dark) && self.is_lit(nm, index, lit), "{dark} is not dark or {lit} not lit");
        while lit - dark > 1e-3 {
            let middle = 0.5 * (dark + lit);
            if self.is_lit(nm, index, middle) { lit = middle } else { dark = middle }
        }
        0.5 * (dark + lit) + 0.5 * SUN_DEGREES
    }
}

/// Descartes 1637, *Les Météores*, discours VIII: 41 degrees 30 minutes and 51 degrees 54 minutes for 250 : 187, before
/// he allows for the width of the sun.
#[test]
fn the_formula_gives_the_angles_that_descartes_printed() {
    let [primary, secondary] =
        [PRIMARY, SECONDARY].map(|bow| Bow::angle(bow.descartes(250.0 / 187.0)[1].to_degrees()) * 60.0);
    assert!((primary - (41.0 * 60.0 + 30.0)).abs() < 1.0, "{primary} minutes");
    assert!((secondary - (51.0 * 60.0 + 54.0)).abs() < 1.0, "{secondary} minutes");
}

#[test]
fn both_bows_stand_where_descartes_found_them_in_every_color() {
    let water = data::glass("water").expect("water is in the catalog");
    for bow in [PRIMARY, SECONDARY] {
        for nm in [400.0, 589.0, 700.0] {
            let index = water.index(nm);
            let expected = bow.descartes(index)[1].to_degrees();
            let found = bow.least_deviation(nm, index);
            println!("k = {}, {nm} nm: {:.4} for {:.4}", bow.reflections, Bow::angle(found), Bow::angle(expected));
            // Half of the last interval, and the angle between neighboring pixels at the turning point.
            assert!((found - expected).abs() < 1e-3, "k = {}, {nm} nm: {found} for {expected}", bow.reflections);
        }
    }
}

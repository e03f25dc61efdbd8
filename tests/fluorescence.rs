//! Dyes: light that they emit at other wavelengths is compared with sums over their matrices.
//!
//! ```text
//! cargo test --test all fluorescence::
//! ```

mod closed_forms;
mod polarized;
mod rooms;
mod ways;

use std::fmt::Write;

use abbe::scene::Scene;
use abbe::spectrum::{Basis, ColorSpace, Curve, CurveKind, Emission, apply, visible};
use abbe::trace::Method;

use crate::support::larger::larger;
use crate::support::scenes::{EVERY_BRANCH, assert_near, film_of, method, scene};

/// A dye over white paper. Its absorption is bell-shaped, and so is its emission in photons.
#[derive(Clone, Copy)]
pub struct BellDye {
    pub name: &'static str,
    /// Mean and standard deviation in nm of the absorption, whose peak is 0.9, and of the emitted photons.
    absorption: [f64; 2],
    emission: [f64; 2],
    quantum_yield: f64,
}

pub const YELLOW: BellDye =
    BellDye { name: "yellow", absorption: [450.0, 25.0], emission: [520.0, 20.0], quantum_yield: 0.9 };
pub const RED: BellDye =
    BellDye { name: "red", absorption: [540.0, 25.0], emission: [600.0, 20.0], quantum_yield: 0.8 };
pub const BRIGHTENER: BellDye =
    BellDye { name: "brightener", absorption: [365.0, 20.0], emission: [440.0, 22.0], quantum_yield: 0.85 };

fn bell([middle, deviation]: [f64; 2], nm: f64) -> f64 {
    libm::exp(-0.5 * ((nm - middle) / deviation).powi(2))
}

fn samples(value: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
    visible::wavelengths().map(|nm| [nm, value(nm)]).collect()
}

impl BellDye {
    pub fn absorbed(&self, nm: f64) -> f64 {
        0.9 * bell(self.absorption, nm)
    }

    pub fn reflected(&self, nm: f64) -> f64 {
        0.92 - self.absorbed(nm)
    }

    /// Returns the emitted power per nm, normalized to a total of 1.
    pub fn glow(&self) -> Vec<f64> {
        let power: Vec<f64> = visible::wavelengths().map(|nm| bell(self.emission, nm) / nm).collect();
        let total: f64 = power.iter().sum();
        power.into_iter().map(|x| x / total).collect()
    }

    /// Returns the emitted power relative to the power that arrives at a wavelength.
    pub fn excited(&self, nm: f64) -> f64 {
        let [power, photons] =
            [1.0, 0.0].map(|by| visible::wavelengths().map(|nm| bell(self.emission, nm) / nm.powf(by)).sum::<f64>());
        self.quantum_yield * self.absorbed(nm) * nm * power / photons
    }

    /// Returns the material as scenes write it.
    pub fn material(&self) -> String {
        let written = |samples: Vec<[f64; 2]>| {
            let mut text = String::from("{ samples = [");
            samples.iter().for_each(|[nm, x]| write!(text, "[{nm}, {x:e}],").expect("a String takes all"));
            text + "] }"
        };
        format!(
            "diffuse = {{ reflectance = {}, fluorescence = {{ absorption = {}, emission = {}, quantum_yield = {} }} }}",
            written(samples(|nm| self.reflected(nm))),
            written(samples(|nm| self.absorbed(nm))),
            written(samples(|nm| 1e3 * bell(self.emission, nm) / nm)),
            self.quantum_yield
        )
    }
}

/// Returns the power per nm of an illuminant with Y = 1.
pub fn light(name: &str) -> Vec<f64> {
    let curve: Curve = CurveKind::illuminant(name).expect("it is in the catalog").into();
    Emission::new(&curve, ColorSpace::Rec709).spectrum().to_vec()
}

/// Converts a spectrum to linear Rec.709.
pub fn color(spectrum: &[f64]) -> [f64; 3] {
    apply(&ColorSpace::Rec709.matrix_from_xyz(), visible::xyz(spectrum))
}

pub fn lanes(scene: &Scene<Curve>, basis: Basis) -> Method {
    Method { basis, ..method(scene, EVERY_BRANCH) }
}

/// Renders the only pixel of an image in 32 lanes from 300 nm on, without random choices.
pub fn pixel(text: &str) -> [f64; 3] {
    let scene = scene(text);
    let method = lanes(&scene, Basis::bands_over(scene.film.color_space, 32, Basis::FROM_ULTRAVIOLET_NM, &[]));
    film_of(&scene, method).pixels[0].rgb.map(f64::from)
}

/// Asserts that each channel is within a fraction of the strongest one.
pub fn assert_color(found: [f64; 3], expected: [f64; 3], share: f64, what: &str) {
    let strongest = expected.iter().fold(0.0_f64, |most, x| larger(most, x.abs()));
    let off = (0..3).map(|c| (found[c] - expected[c]).abs() / strongest).fold(0.0, larger);
    println!("{what}: {off:.1e}");
    assert_near(found, expected, share * strongest, what);
}

//! Wave plates whose retardation is given as a length, between polarizers: sin^2 of half their phase at each
//! wavelength.

use std::f64::consts::PI;

use abbe::plan::plan;
use abbe::spectrum::{Basis, ColorSpace, Emission, Response};
use abbe::trace::{Method, Polarizing, prepare, render};

use crate::support::larger::larger;
use crate::support::scenes::{EVERY_BRANCH, film_of, method, one_pixel, scene};

/// Returns a sky seen straight through a polarizer along x, a plate at 45 degrees and a second polarizer.
fn between_polarizers(plate: &str, second: [f64; 3], sky: &str) -> String {
    let mut text = one_pixel("", "") + &format!("[[light]]\nenvironment.radiance = {sky}\n");
    let sheets = [
        "polarizer.axis = [1, 0, 0]".to_owned(),
        format!("retarder = {{ axis = [1, 1, 0], {plate} }}"),
        format!("polarizer.axis = {second:?}"),
    ];
    for (number, sheet) in sheets.into_iter().enumerate() {
        text += &format!(
            "[material.sheet{number}]\n{sheet}\n[[object]]\nmaterial = \"sheet{number}\"\n\
             shape.quad = {{ center = [0, 0, -{number}], u = [0.5, 0, 0], v = [0, 0.5, 0] }}\n"
        );
    }
    text
}

const CROSSED: [f64; 3] = [0.0, 1.0, 0.0];
const PARALLEL: [f64; 3] = [1.0, 0.0, 0.0];

/// Returns what is left of a uniform sky in three lanes of a basis.
fn lanes(text: &str, basis: &Basis, three: [usize; 3]) -> [f64; 3] {
    let scene = scene(text);
    let columns: Vec<[f64; 3]> =
        (0..basis.fixed_lanes()).map(|lane| three.map(|of| if of == lane { 1.0 } else { 0.0 })).collect();
    let method = Method { basis: basis.clone(), polarization: Polarizing::Traced, ..method(&scene, EVERY_BRANCH) };
    let world = prepare(&scene, method).with_responses(|_| Response::new(&columns, Vec::new()));
    render(&world, &|_| ()).0.pixels[0].rgb.map(f64::from)
}

/// Returns the transmittance of a plate between crossed polarizers for unpolarized light.
fn crossed_transmittance(nm: f64, retardation: f64) -> f64 {
    0.5 * (PI * retardation / nm).sin().powi(2)
}

/// Lanes of lines stand for single wavelengths, at which fringes of any order are visible.
#[test]
fn crossed_polarizers_let_through_sin_squared_of_half_the_phase() {
    let nm = [436.0, 546.0, 612.0];
    let basis = Basis::wavelengths(ColorSpace::Rec709, vec![600.0], &nm);
    for retardation in [0.0, 137.5, 550.0, -1300.0, 20_000.0, 1e6] {
        let plate = format!("retardation_nm = {retardation:?}");
        let dark = lanes(&between_polarizers(&plate, CROSSED, "1"), &basis, [1, 2, 3]);
        let bright = lanes(&between_polarizers(&plate, PARALLEL, "1"), &basis, [1, 2, 3]);
        for i in 0..3 {
            let expected = crossed_transmittance(nm[i], retardation);
            assert!((dark[i] - expected).abs() < 2e-6, "{retardation} nm at {} nm: {} for {expected}", nm[i], dark[i]);
            assert!(
                (dark[i] + bright[i] - 0.5).abs() < 2e-6,
                "{retardation} nm at {} nm: {} parallel",
                nm[i],
                bright[i]
            );
        }
    }
}

#[test]
fn a_retardation_is_a_retardance_at_its_wavelength() {
    let basis = Basis::wavelengths(ColorSpace::Rec709, vec![600.0], &[500.0, 550.0, 600.0]);
    let [_, by_length, _] = lanes(&between_polarizers("retardation_nm = 137.5", CROSSED, "1"), &basis, [1, 2, 3]);
    let by_phase = lanes(&between_polarizers("retardance = 90", CROSSED, "1"), &basis, [1, 2, 3]);
    assert!((by_length - 0.25).abs() < 1e-6 && (by_phase[1] - by_length).abs() < 1e-6, "{by_length}, {by_phase:?}");
    assert_eq!([by_phase[0], by_phase[2]], [by_phase[1]; 2]);
}

/// Lanes of bands evaluate the phase at their node. At orders so high that the phase varies within a band, they take
/// its mean.
#[test]
fn bands_of_many_orders_are_left_unpolarized() {
    let basis = Basis::bands(ColorSpace::Rec709, 16, &[]);
    let three = [2, 7, 11];
    let nm = three.map(|lane| basis.wavelengths_nm()[lane]);
    for retardation in [300.0, 1000.0, 2000.0] {
        let found =
            lanes(&between_polarizers(&format!("retardation_nm = {retardation:?}"), CROSSED, "1"), &basis, three);
        for i in 0..3 {
            let expected = crossed_transmittance(nm[i], retardation);
            assert!(
                (found[i] - expected).abs() < 2e-6,
                "{retardation} nm at {} nm: {} for {expected}",
                nm[i],
                found[i]
            );
        }
    }
    // Neighbors are 17 to 28 nm apart. If half the phase changes by x across a band, the mean cosine of the phase is
    // below 1 / x.
    for (retardation, most) in [(30_000.0, 0.25 / 4.0), (1e6, 0.25 / 100.0)] {
        let found =
            lanes(&between_polarizers(&format!("retardation_nm = {retardation:?}"), CROSSED, "1"), &basis, three);
        assert!(found.iter().all(|share| (share - 0.25).abs() < most), "{retardation} nm: {found:?}");
    }
}

/// The colors of the Michel-Levy chart under D65, compared with sums over 1 nm.
#[test]
fn plates_between_polarizers_have_their_colors_in_the_lanes_that_the_plan_chooses() {
    for retardation in [150.0, 560.0, 1100.0, 3000.0] {
        let text =
            between_polarizers(&format!("retardation_nm = {retardation:?}"), CROSSED, "{ illuminant = \"D65\" }");
        let scene = scene(&text);
        let chosen = plan(&scene);
        assert_eq!(chosen.method.polarization, Polarizing::Traced);
        let found = film_of(&scene, chosen.method.clone()).pixels[0].rgb.map(f64::from);
        let light = Emission::new(scene.lights[0].emission(), ColorSpace::Rec709);
        let mut expected = [0.0; 3];
        for (nm, column) in abbe::spectrum::visible::wavelengths().zip(light.columns()) {
            (0..3).for_each(|c| expected[c] += crossed_transmittance(nm, retardation) * column[c]);
        }
        let strongest = expected.iter().fold(0.0, |most: f64, x| larger(most, x.abs()));
        let off = (0..3).map(|c| (found[c] - expected[c]).abs()).fold(0.0, larger) / strongest;
        println!("{retardation} nm, {}: {off:.1e}", chosen.method.basis.name());
        assert!(found.iter().all(|x| x.is_finite()), "{retardation} nm: {found:?}");
        assert!(off <= chosen.model_error.max(1e-5), "{retardation} nm: {found:?} for {expected:?}, {chosen:?}");
        assert!(chosen.model_error < 0.011, "{retardation} nm: {}", chosen.model_error);
    }
}

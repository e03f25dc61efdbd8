//! Spectra of Stokes vectors: they make up the layers S1 to S3, and they show what sheets and glass do to an even
//! spectrum.

use std::f64::consts::TAU;

use abbe::Image;
use abbe::spectrum::{apply, data};

use super::{FINE, WHITE, room};
use crate::support::larger::larger;
use crate::support::scenes::{POLARIZING_SHEETS, one_pixel, render_text};

/// Returns the largest difference between the bands of S1, S2 and S3 and their layers, relative to the brightest
/// channel of the pixel or to one percent of the image's mean. The second result is how much of the image's light is
/// polarized.
fn worst_component(image: &Image) -> (f64, f64) {
    let film = image.film();
    let film_of_xyz = film.color_space.matrix_from_xyz();
    let spectral = film.spectral.as_ref().expect("spectra were asked for");
    assert!(spectral.has_stokes && spectral.bands.count() == data::color_matching().len());
    let y_integral: f64 = data::color_matching().iter().map(|cmf| cmf[1]).sum();
    let strongest = |rgb: [f32; 3]| rgb.iter().fold(0.0, |most: f64, &x| larger(most, f64::from(x).abs()));
    let mean = film.pixels.iter().map(|pixel| strongest(pixel.rgb)).sum::<f64>() / film.pixels.len() as f64;
    let (mut worst, mut polarized) = (0.0_f64, 0.0);
    for component in 1..4 {
        let layer = |channel: &str| image.layer(&format!("S{component}.{channel}")).expect("the layer is there");
        let layers = ["R", "G", "B"].map(layer);
        for (number, pixel) in film.pixels.iter().enumerate() {
            let mut xyz = [0.0; 3];
            for (&radiance, cmf) in spectral.component(number, component).iter().zip(data::color_matching()) {
                (0..3).for_each(|i| xyz[i] += f64::from(radiance) * cmf[i] / y_integral);
            }
            let color = apply(&film_of_xyz, xyz);
            assert!(color.iter().all(|x| x.is_finite()), "{color:?}");
            let off = (0..3).map(|i| (color[i] - f64::from(layers[i][number])).abs()).fold(0.0, larger);
            worst = larger(worst, off / strongest(pixel.rgb).max(0.01 * mean));
            polarized += f64::from(layers[1][number]).abs() / (mean * film.pixels.len() as f64);
        }
    }
    (worst, polarized)
}

/// Photons are splatted and gathered, samples are subtracted, wavelengths part, and a floor fluoresces. The tolerances
/// are those of the image's own spectra.
#[test]
fn spectra_of_stokes_vectors_make_their_layers() {
    let dye = "floor.diffuse = { reflectance = 0.1, fluorescence = { absorption = { samples = [[420, 0.9], [520, 0]] }, \
               emission = { samples = [[500, 0], [540, 1], [620, 0]] }, quantum_yield = 0.9 } }";
    let floor = "floor.diffuse.reflectance = { rgb = [0.7, 0.5, 0.3] }";
    for (filter, glass, floor_of, tolerance) in [
        ("box", "1.5", floor, WHITE),
        ("mitchell", "1.5", floor, 2.0 * WHITE),
        ("box", "\"N-SF11\"", floor, 0.06),
        ("box", "1.5", dye, 1e-3),
    ] {
        let film = format!("{FINE}, stokes = true, filter = \"{filter}\"");
        let (worst, polarized) =
            worst_component(&render_text(&(room(&film, glass).replace(floor, floor_of) + POLARIZING_SHEETS)));
        println!("{filter}, {glass}: {worst:.1e}, {polarized:.3} polarized");
        assert!(worst <= tolerance && polarized > 0.02, "{filter}, {glass}: {worst}, {polarized}");
    }
}

/// Returns the center of each band in nm with its S0 to S3, in one pixel that sees an even spectrum of 1.
fn spectrum(rest: &str) -> Vec<(f64, [f64; 4])> {
    let film = ", layers = [\"polarization\"], spectral = { from = 460, to = 660, step = 5 }";
    let sky = "light = [{ environment.radiance.samples = [[300, 1], [900, 1]] }]\n";
    let image = render_text(&(one_pixel("", film) + sky + rest));
    let radiance = image.spectrum_at(0, 0).expect("spectra were asked for");
    let [s1, s2, s3] = image.stokes_spectra_at(0, 0).expect("Stokes vectors were asked for");
    (0..radiance.len())
        .map(|band| (radiance[band][0], [radiance[band][1], s1[band][1], s2[band][1], s3[band][1]]))
        .collect()
}

fn sheet(name: &str, z: f64, material: &str) -> String {
    format!(
        "[material.{name}]\n{material}\n[[object]]\nmaterial = \"{name}\"\n\
         shape.quad = {{ center = [0, 0, {z}], u = [0.5, 0, 0], v = [0, 0.5, 0] }}\n"
    )
}

#[test]
fn a_sheet_polarizes_all_bands_alike() {
    let (sin, cos) = f64::to_radians(30.0).sin_cos();
    for (nm, found) in spectrum(&sheet("sheet", 0.0, &format!("polarizer.axis = [{cos}, {sin}, 0]"))) {
        let expected = [0.5, 0.25, 0.5 * f64::to_radians(60.0).sin(), 0.0];
        assert!((0..4).all(|i| (found[i] - expected[i]).abs() < 2e-6), "{nm} nm: {found:?} for {expected:?}");
    }
}

/// Behind a plate at 45 degrees, S1 and S3 are the cosine and the sine of its phase. Lanes are 10.6 nm apart. Values
/// interpolated between them are at least as accurate as a straight line, whose error is an eighth of the square of the
/// step in phase. The first and the last lanes, where spectra are assumed to be level, are some lanes away.
#[test]
fn a_wave_plate_shows_its_phase_band_by_band() {
    for retardation in [140.0, 400.0] {
        let plate = format!("retarder = {{ axis = [1, 1, 0], retardation_nm = {retardation:?} }}");
        for (nm, found) in spectrum(&(sheet("plate", 1.0, &plate) + &sheet("sheet", 0.0, "polarizer.axis = [1, 0, 0]")))
        {
            let phase = TAU * retardation / nm;
            let expected = [0.5, 0.5 * phase.cos(), 0.0, 0.5 * phase.sin()];
            let step = phase * 10.625 / nm;
            let within = 0.5 * step * step / 8.0;
            assert!(
                (0..4).all(|i| (found[i] - expected[i]).abs() < within),
                "{retardation} nm at {nm} nm: {found:?} for {expected:?} within {within:.1e}"
            );
        }
    }
}

#[test]
fn spectra_without_stokes_vectors_have_none() {
    let image = render_text(&room("spectral = true", "1.5"));
    assert!(image.stokes_spectra_at(0, 0).is_none());
    let spectral = image.film().spectral.as_ref().expect("spectra were asked for");
    assert_eq!(spectral.numbers(), spectral.bands.count());
}

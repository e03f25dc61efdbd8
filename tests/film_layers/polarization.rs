//! The layer `polarization` follows from the Stokes vectors of its pixel, whatever light they are summed from.

use abbe::Scene;
use abbe::film::{Layer, polarization};
use abbe::spectrum::ColorSpace;

use super::{ROOM, beauty, render_text, rgb};
use crate::support::scenes::POLARIZING_SHEETS;

#[test]
fn degrees_and_angles_are_those_of_the_sums_of_stokes_vectors() {
    let all = Layer::STOKES.into_iter().chain([Layer::Polarization]).collect::<Vec<_>>();
    // Photons are splatted and gathered, and some samples are subtracted.
    for (filter, space) in [("box", ColorSpace::Rec709), ("mitchell", ColorSpace::AcesCg)] {
        let film = format!("height = 28, filter = \"{filter}\", color_space = \"{}\"", space.interop_id());
        let image = render_text(&(ROOM.replace("height = 28", &film) + POLARIZING_SHEETS), &all);
        let weights = space.to_xyz()[1];
        let luminance = |rgb: [f64; 3]| (0..3).map(|c| weights[c] * rgb[c]).sum::<f64>();
        let [s1, s2, s3] = ["S1", "S2", "S3"].map(|layer| rgb(&image, layer));
        let mut polarized = 0;
        for (pixel, s0) in beauty(&image).into_iter().enumerate() {
            let stokes = [s0, s1[pixel], s2[pixel], s3[pixel]].map(luminance);
            let found = ["degree", "linear_degree", "angle"]
                .map(|channel| f64::from(image.layer(&format!("polarization.{channel}")).expect("it is there")[pixel]));
            let expected = polarization(stokes);
            // Sums are stored in f32. Cancellation magnifies the rounding errors of their differences.
            let rounding = 16.0 * f64::from(f32::EPSILON) * s0.iter().sum::<f64>().abs() / stokes[0].max(1e-9);
            assert!((found[0] - expected[0]).abs() <= rounding, "{filter}: pixel {pixel}: {found:?} for {expected:?}");
            assert!((found[1] - expected[1]).abs() <= rounding, "{filter}: pixel {pixel}: {found:?} for {expected:?}");
            let turned = (found[2] - expected[2]).abs();
            let turned = turned.min(180.0 - turned).to_radians();
            assert!(turned * expected[1] <= rounding, "{filter}: pixel {pixel}: {found:?} for {expected:?}");
            polarized += usize::from(found[1] > 0.1 && found[0] > 1.01 * found[1]);
        }
        assert!(polarized > 30, "{filter}: {polarized} pixels are polarized");
    }
}

#[test]
fn degrees_and_angles_need_no_other_layer() {
    let all = Layer::STOKES.into_iter().chain([Layer::Polarization]).collect::<Vec<_>>();
    let (both, alone) = (render_text(ROOM, &all), render_text(ROOM, &[Layer::Polarization]));
    for channel in ["R", "polarization.degree", "polarization.linear_degree", "polarization.angle"] {
        assert!(both.layer(channel) == alone.layer(channel), "{channel}");
    }
    assert!(alone.layer("S1.R").is_none());
}

#[test]
fn asking_for_all_layers_does_not_ask_for_polarization() {
    assert!(Layer::all().into_iter().all(|layer| !layer.is_of_polarization()));
    let scene =
        Scene::parse(&ROOM.replace("height = 28", "height = 28, layers = [\"polarization\"]"), "").expect("valid");
    assert_eq!(scene.format.layers, [Layer::Polarization]);
}

#[test]
fn stokes_vectors_that_the_film_asks_for_stay_whatever_other_layers_are_asked_for() {
    let film = ROOM.replace("height = 28", "height = 28, stokes = true, layers = [\"albedo\"]");
    let scene = Scene::parse(&film, "").expect("valid");
    assert_eq!(scene.format.layers, [Layer::Albedo, Layer::S1, Layer::S2, Layer::S3]);
    let image = render_text(&film, &[Layer::Normal, Layer::S2]);
    assert!(["N.X", "S1.R", "S2.R", "S3.R"].into_iter().all(|channel| image.layer(channel).is_some()));
    assert!(image.layer("albedo.R").is_none());
}

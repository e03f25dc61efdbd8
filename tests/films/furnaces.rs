//! The white furnace under films: clear materials return 1, and metal under a clear film returns what Abeles' matrices
//! predict.

use abbe::material::{Index, Lobes, Material, ScatterContext};
use abbe::spectrum::{Draw, Table};

use super::reference::shares;
use crate::support::materials::{self, context, direction_at, material};

const COSINES: [f64; 7] = [0.01, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0];
const DRAWS: u32 = 1 << 12;
const ROUGHNESSES: [f64; 5] = [0.0, 0.2, 0.45, 0.7, 1.0];
/// Wavelengths in nm at which the three bands are evaluated.
const BANDS_NM: [f64; 3] = [656.27, 546.07, 486.13];

/// Returns the brightness of each band under a uniform sky, with the deviation that noise may cause.
fn furnace(material: &Material<Table>, indices: [f64; 2], from_inside: bool, cos: f64) -> [[f64; 2]; 3] {
    let draw = Draw::<4>::fixed(3);
    let at = context(&draw, direction_at(cos, 0.4), indices[0]);
    let context = ScatterContext { beyond: Index::Same(indices[1]), from_inside, ..at };
    let allowed = if material.lobes().intersects(Lobes::GLOSSY_TRANSMISSION) { 4.0 } else { 0.0 };
    materials::furnace(material, &context, DRAWS).map(|[shown, error]| [shown, allowed * error])
}

/// Clear films: a quarter wave, soap, a mirror of five layers, and a layer thicker than a wavelength.
const CLEAR: [&str; 4] = [
    "[{ index = 1.38, thickness_nm = 99.6 }]",
    "[{ index = 1.33, thickness_nm = 300 }]",
    "[{ index = 2.35, thickness_nm = 58.5 }, { index = 1.38, thickness_nm = 99.6 }, { index = 2.35, thickness_nm = 58.5 }, \
     { index = 1.38, thickness_nm = 99.6 }, { index = 2.35, thickness_nm = 58.5 }]",
    "[{ index = 1.6, thickness_nm = 900 }]",
];

/// A mirror of nine layers, whose reflectance changes within a few degrees.
const NINE: &str = "[{ index = 2.35, thickness_nm = 58.5 }, { index = 1.38, thickness_nm = 99.6 }, { index = 2.35, thickness_nm = 58.5 }, \
     { index = 1.38, thickness_nm = 99.6 }, { index = 2.35, thickness_nm = 58.5 }, { index = 1.38, thickness_nm = 99.6 }, \
     { index = 2.35, thickness_nm = 58.5 }, { index = 1.38, thickness_nm = 99.6 }, { index = 2.35, thickness_nm = 58.5 }]";

#[test]
fn clear_films_lose_nothing_and_win_nothing() {
    let mut rows = vec![("thin = { index = 1.33, thickness_nm = 400 }".to_owned(), vec![([1.0; 2], false)])];
    for (coating, roughness) in CLEAR.into_iter().flat_map(|coating| ROUGHNESSES.map(|roughness| (coating, roughness)))
    {
        let glass = format!("dielectric = {{ index = 1.5, roughness = {roughness:?}, coating = {coating} }}");
        rows.push((glass, vec![([1.0, 1.5], false), ([1.5, 1.0], true)]));
        let plastic = format!("plastic = {{ reflectance = 1, roughness = {roughness:?}, coating = {coating} }}");
        rows.push((plastic, vec![([1.0; 2], false)]));
        let metal = format!("conductor = {{ n = 1e-6, k = 100, roughness = {roughness:?}, coating = {coating} }}");
        rows.push((metal, vec![([1.0; 2], false)]));
    }
    for coating in CLEAR.into_iter().chain([NINE]) {
        // Facets interpolate a film linearly between tabulated angles. Smooth surfaces evaluate it at every angle.
        let plastic = format!("plastic = {{ reflectance = 1, coating = {coating} }}");
        rows.push((plastic, vec![([1.0; 2], false), ([1.7; 2], false)]));
    }
    let mut worst = [1.0_f64; 2];
    for (text, sides) in rows {
        let material = material(&text);
        let [mut lowest, mut highest] = [f64::INFINITY, 0.0_f64];
        for ((indices, inside), cos) in sides.iter().flat_map(|side| COSINES.map(|cos| (*side, cos))) {
            for [shown, chance] in furnace(&material, indices, inside, cos) {
                [lowest, highest] = [lowest.min(shown), highest.max(shown)];
                let off = (shown - 1.0).abs() - chance;
                assert!(off <= 0.005, "{text}: {shown} +- {chance} between {indices:?} at the cosine {cos}");
            }
        }
        println!("{text:.110} {lowest:.5} to {highest:.5}");
        worst = [worst[0].min(lowest), worst[1].max(highest)];
    }
    println!("all {:.5} to {:.5}", worst[0], worst[1]);
}

#[test]
fn metal_under_a_clear_film_shows_what_it_reflects() {
    for (thickness, [n, k]) in [(50.0, [2.5418, 3.4345]), (100.0, [0.43, 2.455]), (300.0, [1.015, 6.627])] {
        let coating = format!("coating = [{{ index = 2.4, thickness_nm = {thickness:?} }}]");
        for cos in COSINES {
            let smooth = material(&format!("conductor = {{ n = {n:?}, k = {k:?}, {coating} }}"));
            for ([shown, _], nm) in furnace(&smooth, [1.0; 2], false, cos).into_iter().zip(BANDS_NM) {
                let [expected, _] = shares(1.0, &[([2.4, 0.0], thickness)], [n, -k], cos, nm);
                assert!((shown - expected).abs() < 1e-6 && shown < 1.0, "{shown} for {expected} at {cos}");
            }
        }
    }
}

//! Light that excites dyes repeatedly.

use abbe::spectrum::{Basis, visible};
use abbe::trace::Method;

use super::{BRIGHTENER, BellDye, RED, YELLOW, color, light};
use crate::support::larger::larger;
use crate::support::scenes::{Mean, SINGLE_PATH, SPLITTING, film_of, method, scene, view};

/// Returns the radiance in a closed room whose walls have a dye. What the walls do not cover is lost to the outside or
/// received from it: L = opacity (reflected + excited glow) L + (1 - opacity) E, a matrix of rank 1 plus a diagonal.
fn room(dye: &BellDye, opacity: f64, outside: &[f64]) -> Vec<f64> {
    let glow = dye.glow();
    let left = |nm: f64| 1.0 - opacity * dye.reflected(nm);
    let nm: Vec<f64> = visible::wavelengths().collect();
    let excited = |spectrum: &dyn Fn(usize) -> f64| {
        (0..nm.len()).map(|i| dye.excited(nm[i]) * spectrum(i) / left(nm[i])).sum::<f64>()
    };
    let brightness = excited(&|i| outside[i]) / (1.0 - opacity * excited(&|i| glow[i]));
    (0..nm.len()).map(|i| (outside[i] + opacity * brightness * glow[i]) / left(nm[i])).collect()
}

#[test]
fn the_formula_of_closed_rooms_gives_published_rows() {
    let rows = [
        (BRIGHTENER, [12.692_01, 12.633_09, 17.951_53]),
        (YELLOW, [11.405_77, 17.966_21, 2.757_34]),
        (RED, [14.126_39, 7.855_77, 11.690_62]),
    ];
    for (dye, expected) in rows {
        let found = visible::xyz(&room(&dye, 1.0, &light("D65")));
        for c in 0..3 {
            assert!((found[c] / expected[c] - 1.0).abs() < 2e-6, "{}: {found:?} for {expected:?}", dye.name);
        }
    }
}

/// The inside of a ball with holes in its wall, under a uniform sky.
#[test]
fn a_room_of_one_dye_shines_as_its_matrix_says() {
    const OPACITY: f64 = 0.8;
    for dye in [YELLOW, RED, BRIGHTENER] {
        for transport in [SPLITTING, SINGLE_PATH] {
            let text = view([0.0; 3], [0.0, 0.0, 1.0], 20.0, 16)
                + "[render]\nsamples = 64\n[[light]]\nenvironment = { radiance = { illuminant = \"D65\" } }\n"
                + "[[object]]\nmaterial = \"wall\"\nshape.sphere = { center = [0, 0, 0], radius = 1 }\n"
                + &format!("[material.wall]\nmask = {{ material = \"dyed\", opacity = {OPACITY} }}\n")
                + &format!("[material.dyed]\n{}\n", dye.material());
            let scene = scene(&text);
            let basis = Basis::bands_over(scene.film.color_space, 32, Basis::FROM_ULTRAVIOLET_NM, &[]);
            let film = film_of(&scene, Method { basis, ..method(&scene, transport) });
            let outside: Vec<f64> = light("D65").iter().map(|light| (1.0 - OPACITY) * light).collect();
            let expected = color(&room(&dye, OPACITY, &outside));
            let mean = Mean::of(&film);
            let strongest = expected.iter().fold(0.0_f64, |most, x| larger(most, x.abs()));
            for c in 0..3 {
                // Colors in 32 lanes have this error even without noise.
                let (off, lanes) = ((mean.value[c] - expected[c]).abs(), 3e-4 * strongest);
                println!("{} {c}: {:.5} +- {:.5} for {:.5}", dye.name, mean.value[c], mean.error[c], expected[c]);
                assert!(off < 4.0 * mean.error[c] + lanes, "{}: {mean:?} for {expected:?}", dye.name);
                assert!(mean.error[c] < 0.01 * strongest, "{}: the noise hides all", dye.name);
            }
        }
    }
}

//! The colors of soap and of anodized titanium under D65, in the lanes that the plan chooses.

use abbe::plan::plan;
use abbe::spectrum::{ColorSpace, Emission, apply, visible};
use abbe::trace::Method;

use super::reference::{Layer, shares};
use crate::support::colors::{self, difference};
use crate::support::larger::larger;
use crate::support::random::Random;
use crate::support::scenes::{EVERY_BRANCH, body, film_of, quad, scene, view};

/// Returns the XYZ of a material relative to a perfect mirror, which reflects a D65 lamp at an angle in degrees, and
/// the name of the basis that the plan chose.
fn reflected_color(material: &str, degrees: f64) -> ([f64; 3], String) {
    let (y, x) = degrees.to_radians().sin_cos();
    let center = [-6.0 * y, 0.0, 6.0 * x];
    let lamp = quad(center, [2.0 * x, 0.0, 2.0 * y], [0.0, 2.0, 0.0]);
    let plane = "plane = { point = [0, 0, 0], normal = [0, 0, 1] }";
    let text = view([4.0 * y, 0.0, 4.0 * x], [0.0; 3], 1e-3, 1)
        + "[render]\nsamples = 1\n"
        + &body("seen", material, &[plane])
        + &body("lamp", "emissive = { radiance = { illuminant = \"D65\" } }", &[&lamp]);
    let scene = scene(&text);
    let chosen = plan(&scene).method.basis;
    let name = chosen.name();
    let method = Method { basis: chosen, ..crate::support::scenes::method(&scene, EVERY_BRANCH) };
    let rgb = film_of(&scene, method).pixels[0].rgb.map(f64::from);
    (apply(&ColorSpace::Rec709.to_xyz(), rgb), name)
}

/// Converts XYZ to CIELAB under the film's white.
fn lab(xyz: [f64; 3]) -> [f64; 3] {
    colors::lab(xyz, apply(&ColorSpace::Rec709.to_xyz(), [1.0; 3]))
}

fn lab_of_xy(y: f64, chromaticity: [f64; 2]) -> [f64; 3] {
    let [x, small_y] = chromaticity;
    lab([x / small_y * y, y, (1.0 - x - small_y) / small_y * y])
}

/// Thickness in nm; Y, x and y at normal incidence and at 45 degrees. They are sums over 1 nm of Airy's formula,
/// computed with colour-science 0.4.7.
const SOAP: [(f64, [f64; 3], [f64; 3]); 9] = [
    (100.0, [0.075937, 0.31403, 0.33860], [0.092297, 0.29998, 0.32220]),
    (150.0, [0.046665, 0.43156, 0.43955], [0.088802, 0.35556, 0.38060]),
    (200.0, [0.005199, 0.28978, 0.12426], [0.035929, 0.50543, 0.45417]),
    (250.0, [0.029318, 0.18054, 0.22159], [0.006627, 0.19018, 0.08590]),
    (300.0, [0.067491, 0.32086, 0.41972], [0.045355, 0.19260, 0.24536]),
    (400.0, [0.017113, 0.30929, 0.15192], [0.079038, 0.44956, 0.48150]),
    (500.0, [0.055238, 0.30164, 0.52967], [0.020518, 0.21435, 0.13816]),
    (600.0, [0.028965, 0.33944, 0.20190], [0.076023, 0.33294, 0.51978]),
    (1000.0, [0.039067, 0.36622, 0.32763], [0.043342, 0.33752, 0.34450]),
];

#[test]
fn soap_has_its_colors() {
    for (thickness, straight, slanting) in SOAP {
        let material = format!("thin = {{ index = 1.33, thickness_nm = {thickness:?} }}");
        for (degrees, [y, x, small_y]) in [(0.0, straight), (45.0, slanting)] {
            let (found, model) = reflected_color(&material, degrees);
            let off = difference(lab(found), lab_of_xy(y, [x, small_y]));
            println!("{thickness} nm at {degrees} degrees, {model}: {off:.3}");
            assert!(off < 0.5, "{thickness} nm at {degrees} degrees in {model}: {off}, {found:?}");
        }
    }
}

/// Thickness in nm of a clear oxide of index 2.4 on titanium, and its CIELAB color.
const OXIDE: [(f64, [f64; 3]); 11] = [
    (0.0, [81.02, 1.04, 3.62]),
    (20.0, [65.57, 2.81, 22.48]),
    (30.0, [47.49, 11.33, 39.93]),
    (40.0, [29.87, 26.61, -22.37]),
    (50.0, [44.40, 1.21, -36.24]),
    (60.0, [62.96, -7.42, -23.22]),
    (80.0, [79.88, -4.95, -4.20]),
    (100.0, [83.09, -5.06, 14.61]),
    (120.0, [77.64, -4.05, 60.84]),
    (140.0, [59.85, 41.65, 4.53]),
    (160.0, [47.91, 34.35, -52.53]),
];

#[test]
fn titanium_has_the_colors_of_its_oxide() {
    for (thickness, expected) in OXIDE {
        let coating = format!("[{{ index = 2.4, thickness_nm = {thickness:?} }}]");
        let (found, model) = reflected_color(&format!("conductor = {{ metal = \"Ti\", coating = {coating} }}"), 0.0);
        let off = difference(lab(found), expected);
        println!("{thickness} nm in {model}: {off:.3}");
        assert!(off < 0.5, "{thickness} nm in {model}: {off}, {:?}", lab(found));
    }
}

/// A slab in air with the same quarter-wave layers on both faces, in front of a lamp. Light crosses the layers twice or
/// more.
#[test]
fn colors_through_slabs_coated_on_both_faces_are_missed_by_no_more_than_the_plan_says() {
    const SCENES: u64 = 40;
    let mut ratios = Vec::new();
    for number in 0..SCENES {
        let mut random = Random::new(number + 300);
        let (count, middle) = (1 + 2 * (number as usize % 5), 430.0 + 230.0 * random.number());
        let layers: Vec<Layer> = (0..count)
            .map(|i| {
                let index = [2.35, 1.38][i % 2];
                ([index, 0.0], (0.9 + 0.2 * random.number()) * middle / (4.0 * index))
            })
            .collect();
        let coating: Vec<String> =
            layers.iter().map(|(n, nm)| format!("{{ index = {:?}, thickness_nm = {nm:?} }}", n[0])).collect();
        let text = view([0.0, 0.0, 5.0], [0.0; 3], 1e-3, 1)
            + "[render]\nsamples = 1\n"
            + &body(
                "slab",
                &format!("dielectric = {{ index = 1.52, coating = [{}] }}", coating.join(", ")),
                &["cube = { center = [0, 0, 0], size = [9, 9, 1] }"],
            )
            + &body(
                "lamp",
                "emissive = { radiance = 1 }",
                &[&quad([0.0, 0.0, -5.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0])],
            );
        let scene = scene(&text);
        let emission = Emission::new(scene.lights[0].emission(), scene.film.color_space);
        let mut exact = [0.0; 3];
        for (nm, column) in visible::wavelengths().zip(emission.columns()) {
            let [r, t] = shares(1.0, &layers, [1.52, 0.0], 1.0, nm);
            // Incoherent reflections between two faces.
            let through = t * t / (1.0 - r * r);
            (0..3).for_each(|c| exact[c] += through * column[c]);
        }
        let strongest = exact.iter().fold(0.0_f64, |most, x| larger(most, x.abs()));
        for candidate in plan(&scene).candidates {
            let (bound, name) = (candidate.bound(), candidate.basis.name());
            let method = Method { basis: candidate.basis, ..crate::support::scenes::method(&scene, EVERY_BRANCH) };
            let rgb = film_of(&scene, method).pixels[0].rgb.map(f64::from);
            let color_error = (0..3).fold(0.0_f64, |most, c| larger(most, (rgb[c] - exact[c]).abs())) / strongest;
            println!(
                "scene {number}, {count} layers around {middle:.0} nm, {name}: misses {color_error:.5} of {bound:.5}"
            );
            ratios.push(color_error / bound.max(1e-6));
            assert!(
                color_error <= bound + 1e-5,
                "scene {number}, {count} layers, {name}: misses {color_error:.5}, stated {bound:.5}"
            );
        }
    }
    ratios.sort_by(f64::total_cmp);
    println!(
        "true over stated error of color: median {:.2}, most {:.2}",
        ratios[ratios.len() / 2],
        ratios[ratios.len() - 1]
    );
}

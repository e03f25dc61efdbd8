//! Interpolated lanes sample a reflectance so that its color is right under the lights of a scene. The reference is a
//! sum over 1 nm.

use std::sync::Arc;

use abbe::spectrum::{
    Basis, CatalogEntry, ColorSpace, Curve, CurveKind, Draw, Dye, Emission, Lanes, MAX_LANES, Quantity, data, visible,
};

use crate::support::larger::larger;

const SPACE: ColorSpace = ColorSpace::Rec709;

fn illuminant(name: &str) -> Curve {
    CurveKind::illuminant(name).expect("it is in the catalog").into()
}

fn emissions(lights: &[Curve]) -> Vec<Emission> {
    lights.iter().map(|light| Emission::new(light, SPACE)).collect()
}

/// Returns the reflectances of the ColorChecker.
fn patches() -> Vec<Curve> {
    let curve = |patch: data::Grid| {
        CurveKind::Reflectance(CatalogEntry { name: patch.name.to_owned(), entry: Arc::new(patch) }).into()
    };
    data::reflectances().map(|patch| curve(patch.clone())).collect()
}

fn read_lanes(basis: &Basis, reflectance: &Curve) -> Vec<f64> {
    basis.tabulate(Quantity::Reflectance, reflectance).bins().to_vec()
}

/// Returns the film color of a light after a reflection by each of the surfaces: in lanes, and by sums over 1 nm.
fn colors(basis: &Basis, light: &Curve, surfaces: &[&Curve]) -> [[f64; 3]; 2] {
    let draw = Draw::<MAX_LANES>::fixed(basis.fixed_lanes());
    let mut lanes = draw.read(&basis.tabulate(Quantity::Emission, light));
    for surface in surfaces {
        let numbers = read_lanes(basis, surface);
        lanes = lanes * Lanes::from_fn(|i| numbers.get(i).map_or(0.0, |&x| x as f32));
    }
    let left = |nm: f64| surfaces.iter().map(|surface| surface.values(Quantity::Reflectance)(nm)).product::<f64>();
    let emission = Emission::new(light, SPACE);
    let smooth = visible::wavelengths().zip(emission.columns());
    let lines = emission.lines().iter().map(|&[nm, power]| (nm, emission.film_color(nm).map(|x| x * power)));
    let mut exact = [0.0; 3];
    for (nm, color) in smooth.chain(lines) {
        let left = left(nm);
        (0..3).for_each(|c| exact[c] += left * color[c]);
    }
    [basis.response(light).film_rgb(&draw, lanes, false), exact]
}

/// Returns the error of the first color relative to the largest channel of the second.
fn color_error([found, exact]: [[f64; 3]; 2]) -> f64 {
    let largest = |color: [f64; 3]| color.into_iter().fold(0.0_f64, |most, x| larger(most, x.abs()));
    largest(std::array::from_fn(|c| found[c] - exact[c])) / largest(exact)
}

#[test]
fn a_reflectance_has_its_very_color_under_each_light_where_there_are_lanes_enough() {
    let lights = ["D65", "A", "FL11", "LED-B3", "FL2"].map(illuminant);
    let sodium: Curve = CurveKind::Lines(vec![[589.0, 2.0], [589.6, 1.0]]).into();
    let cases: [(usize, &[f64], Vec<Curve>); 6] = [
        (8, &[], lights[..1].into()),
        (12, &[], lights[1..2].into()),
        (12, &[], lights[2..4].into()),
        (16, &[], lights[..2].into()),
        (32, &[], lights.clone().into()),
        (16, &[589.0, 589.6], vec![lights[0].clone(), sodium]),
    ];
    for (bands, lines, lights) in cases {
        let basis = Basis::bands(SPACE, bands, lines).with_true_colors_under(&emissions(&lights), &[], None);
        for (patch, light) in patches().iter().flat_map(|patch| lights.iter().map(move |light| (patch, light))) {
            let off = color_error(colors(&basis, light, &[patch]));
            assert!(off < 1e-5, "{bands} lanes, {} lights: {patch:?} under {light:?}: {off:.1e}", lights.len());
        }
    }
}

#[test]
fn light_of_two_and_four_reflections_is_closer_than_where_lanes_are_read_at_their_own_wavelengths() {
    let patches = patches();
    for bands in [8, 12, 16, 32] {
        for (steps, at_most) in [(&[0, 7][..], 0.5), (&[0, 7, 3, 11], 0.8)] {
            // The 95th percentile of 24 chains of patches, summed over three lights.
            let mut sums = [0.0; 2];
            for light in ["D65", "A", "FL11"].map(illuminant) {
                let own = Basis::bands(SPACE, bands, &[]);
                let seen = own.clone().with_true_colors_under(&emissions(std::slice::from_ref(&light)), &[], None);
                for (basis, sum) in [own, seen].iter().zip(&mut sums) {
                    let chain = |first: usize| {
                        let surfaces: Vec<&Curve> = steps.iter().map(|step| &patches[(first + step) % 24]).collect();
                        color_error(colors(basis, &light, &surfaces))
                    };
                    let mut color_error: Vec<f64> = (0..24).map(chain).collect();
                    color_error.sort_by(f64::total_cmp);
                    *sum += color_error[22];
                }
            }
            let [own, seen] = sums;
            println!("{bands} lanes, {} reflections: {own:.1e} where lanes stand, {seen:.1e}", steps.len());
            assert!(seen < at_most * own, "{bands} lanes, {} reflections: {seen:.1e} and {own:.1e}", steps.len());
        }
    }
}

#[test]
fn numbers_stay_within_a_spectrums_bounds_and_even_spectra_are_even() {
    let lights = emissions(&["D65", "FL11"].map(illuminant));
    let step = |from: f64, to: f64| -> Curve {
        CurveKind::Samples(vec![[from, 0.0], [from + 1.0, 1.0], [to, 1.0], [to + 1.0, 0.0]]).into()
    };
    for bands in 1..=MAX_LANES {
        let basis = Basis::bands(SPACE, bands, &[]).with_true_colors_under(&lights, &[], None);
        for (from, to) in [(350.0, 550.0), (500.0, 560.0), (545.0, 547.0), (600.0, 900.0)] {
            let numbers = read_lanes(&basis, &step(from, to));
            assert!(numbers.iter().all(|x| (0.0..=1.0).contains(x)), "{bands} lanes, {from} to {to} nm: {numbers:?}");
        }
        assert_eq!(read_lanes(&basis, &0.3.into()), vec![0.3; bands]);
    }
}

#[test]
fn what_no_light_shows_and_no_lights_at_all_leave_finite_numbers() {
    let dark: Curve = 0.0.into();
    let invisible: Curve = CurveKind::Lines(vec![[320.0, 1.0]]).into();
    for lights in [vec![], vec![dark], vec![invisible.clone()], vec![illuminant("D65"), invisible]] {
        for basis in
            [Basis::bands(SPACE, 12, &[320.0]), Basis::bands_over(SPACE, 31, Basis::FROM_ULTRAVIOLET_NM, &[320.0])]
        {
            let basis = basis.with_true_colors_under(&emissions(&lights), &[], None);
            for patch in &patches() {
                let numbers = read_lanes(&basis, patch);
                assert!(numbers.iter().all(|x| (0.0..=1.0).contains(x)), "{} lights: {numbers:?}", lights.len());
            }
        }
    }
}

#[test]
fn a_filter_lets_as_much_light_excite_a_dye_as_it_does() {
    let bell = |middle: f64, deviation: f64, most: f64| -> Curve {
        let at = |nm: f64| [nm, most * (-0.5 * ((nm - middle) / deviation).powi(2)).exp()];
        CurveKind::Samples(visible::wavelengths().map(at).collect()).into()
    };
    let dye = Dye { absorption: bell(365.0, 20.0, 0.9), emission: bell(440.0, 22.0, 1.0), quantum_yield: 0.85 };
    let light = illuminant("D65");
    let own = Basis::bands_over(SPACE, 20, Basis::FROM_ULTRAVIOLET_NM, &[]);
    let seen =
        own.clone().with_true_colors_under(&emissions(std::slice::from_ref(&light)), std::slice::from_ref(&dye), None);
    let filter: Curve = CurveKind::Samples(vec![[350.0, 0.0], [390.0, 1.0]]).into();
    let exact = {
        let excited = dye.prepared().by(&Emission::new(&light, SPACE));
        let left = filter.values(Quantity::Transmittance);
        let kept: f64 = visible::wavelengths().zip(&excited.smooth).map(|(nm, power)| left(nm) * power).sum();
        kept / excited.parts().sum::<f64>()
    };
    let [own, seen] = [own, seen].map(|basis| {
        let basis = basis.for_dyes(std::slice::from_ref(&dye), &[&light]);
        let draw = Draw::<MAX_LANES>::fixed(basis.fixed_lanes());
        let numbers = basis.tabulate(Quantity::Transmittance, &filter);
        let emission = draw.read(&basis.tabulate(Quantity::Emission, &light));
        let brightness =
            |lanes| basis.excitation(&dye.prepared(), &Emission::new(&light, SPACE)).film_rgb(&draw, lanes, false)[0];
        (brightness(emission * draw.read(&numbers)) / brightness(emission) - exact).abs() / exact
    });
    println!("read at the lanes' wavelengths {own:.1e}, by what excites {seen:.1e}");
    assert!(seen < 1e-5 && own > 1e-3, "{own:.1e}, {seen:.1e}");
}

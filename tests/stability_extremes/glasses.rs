//! Rows H4 and H10: indices at the ends of a glass's known range, and bodies with hardly any index at all.

use abbe::spectrum::data::glasses;
use abbe::spectrum::{ColorSpace, Curve, CurveKind, Quantity, Upsampler};

use crate::support::scenes::{Mean, SPLITTING, body, environment, render_film, view};

/// The ends of visible light and of the glass's own range, one floating-point step inside them and far beyond. Beyond
/// the range, the index is that of its edge.
#[test]
fn h4_every_glass_has_an_index_at_and_beyond_the_ends_of_its_range() {
    let upsampler = Upsampler::new(ColorSpace::Rec709);
    let mut count = 0;
    for glass in glasses() {
        let curve = Curve::from(CurveKind::glass(glass.key).unwrap());
        let index = curve.reader(Quantity::Index, &upsampler);
        let (from, to) = glass.range_nm;
        for nm in [from, from.next_up(), 360.0, 830.0, to.next_down(), to] {
            assert!((1.0..5.0).contains(&index(nm)), "{} at {nm} nm: {}", glass.key, index(nm));
        }
        for (beyond, edge) in [(from.next_down(), from), (0.5 * from, from), (to.next_up(), to), (1e9, to)] {
            assert_eq!(index(beyond), index(edge), "{} at {beyond} nm", glass.key);
        }
        count += 1;
    }
    assert!(count > 1500, "{count} glasses");
}

/// In a uniform environment, a lossless body is invisible, whatever its index and roughness.
#[test]
fn h10_bodies_of_hardly_any_index_and_of_the_ends_of_roughness_are_invisible_in_an_even_sky() {
    let mut cases = Vec::new();
    for index in ["1.0000001", "1.0000000000000002", "1.5", "9.9"] {
        for roughness in ["0", "1e-9", "0.0001", "0.02", "1"] {
            cases.push(format!("dielectric = {{ index = {index}, roughness = {roughness} }}"));
        }
    }
    let claims = cases.len();
    for material in cases {
        let text = view([0.0, 0.0, 4.0], [0.0; 3], 20.0, 16)
            + "[render]\nsamples = 64\n"
            + &body("glass", &material, &["sphere = { center = [0.1, 0, 0], radius = 1 }"])
            + &environment(1.0);
        let (film, report) = render_film(&text, SPLITTING);
        assert_eq!((report.non_finite, report.unmatched), (0, 0), "{material}");
        let mean = Mean::of(&film);
        let rays = report.rays as f64 / report.samples as f64;
        println!(
            "H10: {material}: {:.5} +- {:.1e}, {rays:.0} rays, {} stopped",
            mean.value[1], mean.error[1], report.stopped
        );
        // Multiple scattering between facets is tabulated to 3 parts in 10^3 (Kulla & Conty 2017).
        let table = if material.contains("roughness = 1 ") || material.contains("0.02") { 3e-3 } else { 0.0 };
        let off = (mean.value[1] - 1.0).abs();
        let limit = crate::support::scenes::sigma_limit(claims) * mean.error[1] + table + 4e-6;
        assert!(off <= limit, "{material}: {mean:?}");
        assert!(mean.error[1] < 0.02, "{material}: {mean:?}");
    }
}

//! Perceived color differences.

use palette::Lab;
use palette::color_difference::Ciede2000;
use palette::white_point::D65;

/// Converts XYZ to CIELAB relative to a white (CIE 15:2018, section 8.2.1).
pub fn lab(xyz: [f64; 3], white: [f64; 3]) -> [f64; 3] {
    let f = |t: f64| {
        if t > (6.0_f64 / 29.0).powi(3) { t.cbrt() } else { t / (3.0 * (6.0_f64 / 29.0).powi(2)) + 4.0 / 29.0 }
    };
    let [x, y, z] = [0, 1, 2].map(|i| f(xyz[i] / white[i]));
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Returns the CIEDE2000 difference of two CIELAB colors.
pub fn difference(a: [f64; 3], b: [f64; 3]) -> f64 {
    let [a, b] = [a, b].map(|[l, a, b]| Lab::<D65, f64>::new(l, a, b));
    a.difference(b)
}

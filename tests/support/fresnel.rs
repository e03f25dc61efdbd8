//! Fresnel's equations of 1823 for surfaces of clear media, written without a look at the renderer's own.

/// Reflectances of s and of p, from vacuum to an index at a cosine.
pub fn reflectances(n: f64, cos: f64) -> [f64; 2] {
    let beyond = (n * n - 1.0 + cos * cos).sqrt() / n;
    let amplitudes = [(cos - n * beyond) / (cos + n * beyond), (n * cos - beyond) / (n * cos + beyond)];
    amplitudes.map(|amplitude| amplitude * amplitude)
}

/// Unpolarized reflectance by the angles on both sides of a surface in radians: the sine and the tangent law.
pub fn reflectance_by_angles(incidence: f64, refraction: f64) -> f64 {
    let (difference, sum) = (incidence - refraction, incidence + refraction);
    0.5 * ((difference.sin() / sum.sin()).powi(2) + (difference.tan() / sum.tan()).powi(2))
}

//! Fresnel's equations of 1823 for transparent media, written independently of the renderer's own code.

/// Returns the s and p reflectances of an interface from vacuum to index `n`, at the cosine of incidence `cos`.
pub fn reflectances(n: f64, cos: f64) -> [f64; 2] {
    let beyond = (n * n - 1.0 + cos * cos).sqrt() / n;
    let amplitudes = [(cos - n * beyond) / (cos + n * beyond), (n * cos - beyond) / (n * cos + beyond)];
    amplitudes.map(|amplitude| amplitude * amplitude)
}

/// Returns the unpolarized reflectance from the angles of incidence and refraction in radians: the sine and tangent
/// laws.
pub fn reflectance_by_angles(incidence: f64, refraction: f64) -> f64 {
    let (difference, sum) = (incidence - refraction, incidence + refraction);
    0.5 * ((difference.sin() / sum.sin()).powi(2) + (difference.tan() / sum.tan()).powi(2))
}

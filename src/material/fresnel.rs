//! Exact Fresnel equations for unpolarized light, the mean of s and p.

use crate::math::{DVec3, unit};

/// A smooth boundary between two clear media, at one angle of incidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interface {
    /// Share of the light that is reflected.
    pub reflectance: f64,
    /// Share of the light that is transmitted; `reflectance + transmittance` is 1 to within one rounding.
    pub transmittance: f64,
    /// Cosine of the refracted ray's angle, 0 under total reflection.
    pub cos_beyond: f64,
    /// Degree of polarization (s - p) / (s + p) of the reflected light.
    pub polarization_reflected: f64,
    /// Degree of polarization (s - p) / (s + p) of the refracted light.
    pub polarization_refracted: f64,
    eta: f64,
}

impl Interface {
    /// Makes the boundary from index `n1` to `n2` at an angle of incidence with cosine `c1` in 0..1. Between equal
    /// indices nothing happens at all, even at grazing incidence.
    ///
    /// Fresnel 1823; Born & Wolf 1999, *Principles of Optics*, section 1.5.2. The transmittance is computed as
    /// 2 n1 n2 c1 c2 (1 / (n1 c1 + n2 c2)^2 + 1 / (n2 c1 + n1 c2)^2), which stays precise at grazing angles. The
    /// squared cosine beyond is (n2^2 - n1^2) / n2^2 + (n1 c1 / n2)^2, which stays precise for nearly equal indices.
    #[inline(always)]
    pub fn new(n1: f64, n2: f64, c1: f64) -> Self {
        let c1 = c1.clamp(0.0, 1.0);
        let eta = n1 / n2;
        let unpolarized = |[reflectance, transmittance, cos_beyond]: [f64; 3]| Self {
            reflectance,
            transmittance,
            cos_beyond,
            polarization_reflected: 0.0,
            polarization_refracted: 0.0,
            eta,
        };
        if n1 == n2 {
            return unpolarized([0.0, 1.0, c1]);
        }
        let c2_squared = (n2 - n1) * (n2 + n1) / (n2 * n2) + (eta * c1) * (eta * c1);
        if c2_squared <= 0.0 {
            return unpolarized([1.0, 0.0, 0.0]);
        }
        let c2 = c2_squared.sqrt().min(1.0);
        let (s, p) = (n1 * c1 + n2 * c2, n2 * c1 + n1 * c2);
        let (r_s, r_p) = ((n1 * c1 - n2 * c2) / s, (n2 * c1 - n1 * c2) / p);
        let (reflected_s, reflected_p) = (r_s * r_s, r_p * r_p);
        let (refracted_s, refracted_p) = (1.0 / (s * s), 1.0 / (p * p));
        // Compute the smaller of the two and take the other as the rest, so that both are precise and sum to 1.
        let mut reflectance = 0.5 * (reflected_s + reflected_p);
        let mut transmittance = 1.0 - reflectance;
        if transmittance < 0.5 {
            transmittance = 2.0 * n1 * n2 * c1 * c2 * (refracted_s + refracted_p);
            reflectance = 1.0 - transmittance;
        }
        let degree = |s: f64, p: f64| if s + p > 0.0 { (s - p) / (s + p) } else { 0.0 };
        Self {
            reflectance,
            transmittance,
            cos_beyond: c2,
            polarization_reflected: degree(reflected_s, reflected_p),
            polarization_refracted: degree(refracted_s, refracted_p),
            eta,
        }
    }

    /// Returns the direction of the refracted ray, where the unit vector `wo` points back along the incident ray
    /// (Snell's law).
    #[inline]
    pub fn refract(&self, wo: DVec3, normal: DVec3) -> DVec3 {
        let c1 = wo.dot(normal);
        unit(normal * (self.eta * c1 - self.cos_beyond) - wo * self.eta)
    }
}

/// Returns the mirror image of the unit vector `wo` about the unit `normal`, normalized so that bounces do not drift.
#[inline]
pub fn reflect(wo: DVec3, normal: DVec3) -> DVec3 {
    unit(normal * (2.0 * wo.dot(normal)) - wo)
}

/// A ray at a smooth boundary, shared by lanes whose indices differ from its own.
///
/// Flat surfaces conserve k = n sin i. A ray with k up to 1 may come from vacuum, and every lane takes on its k: plates
/// then have the shares that they would have if each lane traveled alone. A ray with larger k never leaves a denser
/// medium, such as that of a camera in a liquid. There the lane's k^2 divides the interval from 1 to the square of its
/// own index in the rarer medium in the same proportion as the ray's: where the ray grazes the surface every lane does,
/// and none jumps to total reflection. The rule is the same from both sides, so that light takes the same paths in and
/// out.
pub(super) struct SharedRay {
    /// The ray's index on its own side, and the smaller index of the two sides.
    index: f64,
    min_index: f64,
    /// (n cos)^2 of the ray on its own side, and in the rarer medium, where it is not positive under total reflection.
    q_squared: f64,
    rarer_q_squared: f64,
}

impl SharedRay {
    /// Makes a ray that is refracted by the indices `direction` and meets the boundary at an angle with cosine `cos`.
    pub(super) fn new([d1, d2]: [f64; 2], cos: f64) -> Self {
        let (c, min_index) = (cos.clamp(0.0, 1.0), d1.min(d2));
        let q_squared = (d1 * c) * (d1 * c);
        Self { index: d1, min_index, q_squared, rarer_q_squared: (min_index - d1) * (min_index + d1) + q_squared }
    }

    /// Returns (n cos)^2 of a lane on both sides, if the ray is not reflected totally.
    #[inline]
    fn crossing(&self, [n1, n2]: [f64; 2]) -> [f64; 2] {
        let trapped = (self.min_index - 1.0) * (self.min_index + 1.0);
        if self.rarer_q_squared >= trapped {
            let here = (n1 - self.index) * (n1 + self.index) + self.q_squared;
            return [here, here + (n2 - n1) * (n2 + n1)];
        }
        let min_index = n1.min(n2);
        let there = self.rarer_q_squared * ((min_index - 1.0) * (min_index + 1.0) / trapped);
        [n1, n2].map(|n| (n - min_index) * (n + min_index) + there)
    }

    /// Returns n cos of a lane with indices `own` on the ray's side; 0 where the lane has no direction of its own.
    pub(super) fn normal_component(&self, own: [f64; 2]) -> f64 {
        if self.rarer_q_squared > 0.0 {
            return self.crossing(own)[0].max(0.0).sqrt();
        }
        let total = (self.index - self.min_index) * (self.index + self.min_index);
        if total == 0.0 {
            return 0.0;
        }
        let ([n1, _], min_index) = (own, own[0].min(own[1]));
        (self.q_squared * ((n1 - min_index) * (n1 + min_index) / total)).sqrt()
    }
}

/// Returns the transmittance of a smooth boundary for lanes that share a direction though their indices differ. The
/// rest is reflected.
///
/// `own` are the indices of each lane on both sides, `direction` those that refract their shared ray, which meets the
/// boundary at an angle with cosine `cos` in 0..1. A lane keeps the k = n sin i of the ray up to 1, and grazes the
/// surface where the ray does. With q = n cos of the lane on each side and p = q1 q2,
/// T = 2 p ((k^2 + p)^2 + (n1 n2)^2) / ((q1 + q2) (k^2 + p))^2 (Fresnel 1823, with Snell's law inserted), in which
/// nothing cancels. Nothing crosses under total reflection of the ray.
pub fn shared_transmittance<const N: usize>(own: [&[f64; N]; 2], direction: [f64; 2], cos: f64) -> [f64; N] {
    let ray = SharedRay::new(direction, cos);
    let mut crossing = [0.0; N];
    if ray.rarer_q_squared <= 0.0 {
        return crossing;
    }
    for (lane, crosses) in crossing.iter_mut().enumerate() {
        let [n1, n2] = own.map(|side| side[lane]);
        let [q1_squared, q2_squared] = ray.crossing([n1, n2]);
        let (q1, q2) = (q1_squared.sqrt(), q2_squared.sqrt());
        let (product, both) = (q1 * q2, n1 * n2);
        let (sum, k2_plus_p) = (q1 + q2, n1 * n1 - q1_squared + product);
        let amplitude = sum * k2_plus_p;
        let t = 2.0 * product * (k2_plus_p * k2_plus_p + both * both) / (amplitude * amplitude);
        *crosses = if (q1_squared > 0.0) & (q2_squared > 0.0) { t } else { 0.0 };
    }
    crossing
}

/// Returns the share of diffuse light that crosses a smooth boundary to a relative index m.
///
/// It is 1 - R with the closed form of R by Walsh 1926, in Duntley 1942, equation 49. The formula cancels near 1, where
/// R is (m - 1) / 3 - 3 (m - 1)^2 to within 1e-7. Below 1, T(m) = m^2 T(1 / m), since light takes the same paths in and
/// out.
pub fn diffuse_transmittance(m: f64) -> f64 {
    if m < 1.0 {
        return m * m * diffuse_transmittance(1.0 / m);
    }
    let excess = m - 1.0;
    if excess < 1e-3 {
        return 1.0 - excess / 3.0 + 3.0 * excess * excess;
    }
    let (m2, m4) = (m * m, m * m * m * m);
    let (sum, difference) = (m2 + 1.0, m4 - 1.0);
    let reflected = 0.5
        + excess * (3.0 * m + 1.0) / (6.0 * (m + 1.0) * (m + 1.0))
        + m2 * (m2 - 1.0) * (m2 - 1.0) / (sum * sum * sum) * libm::log(excess / (m + 1.0))
        - 2.0 * m2 * m * (m2 + 2.0 * m - 1.0) / (sum * difference)
        + 8.0 * m4 * (m4 + 1.0) / (sum * difference * difference) * libm::log(m);
    1.0 - reflected
}

/// Returns the reflectances (s, p) of a metal n - i k under a medium of index `n1`, at an angle of incidence with
/// cosine `c`.
///
/// Born & Wolf 1999, section 14.4, in the real form of Lagarde 2013, *Memo on Fresnel equations*.
#[inline]
pub fn conductor_reflectance(n1: f64, n: f64, k: f64, c: f64) -> [f64; 2] {
    let c = c.clamp(0.0, 1.0);
    let (eta, kappa) = (n / n1, k / n1);
    let (c2, s2) = (c * c, 1.0 - c * c);
    let t0 = eta * eta - kappa * kappa - s2;
    let modulus = (t0 * t0 + 4.0 * eta * eta * kappa * kappa).sqrt();
    let a = (0.5 * (modulus + t0)).max(0.0).sqrt();
    let (t1, t2) = (modulus + c2, 2.0 * a * c);
    // The code has no branches, so that several lanes can be computed at once.
    let (s, p) = ((t1 - t2) / (t1 + t2), [c2 * modulus + s2 * s2, t2 * s2]);
    let r_s = if t1 + t2 == 0.0 { 1.0 } else { s };
    let ratio = r_s * (p[0] - p[1]) / (p[0] + p[1]);
    [r_s, if p[0] + p[1] == 0.0 { 1.0 } else { ratio }]
}

/// Returns [`conductor_reflectance`] of each lane, for s and for p.
pub(super) fn conductor_reflectances<const N: usize>(n1: &[f64; N], [n, k]: [&[f64; N]; 2], cos: f64) -> [[f64; N]; 2] {
    let [mut s, mut p] = [[0.0; N]; 2];
    for i in 0..N {
        [s[i], p[i]] = conductor_reflectance(n1[i], n[i], k[i], cos);
    }
    [s, p]
}

//! What a surface does to the polarization of light.
//!
//! Light is described by its Stokes vector (S0, S1, S2, S3) in a frame whose z is the light's direction. S1 is the part
//! polarized along x minus that along y = z x x, S2 the same at 45 degrees from x toward y, S3 the right-handed minus
//! the left-handed part, seen looking toward the source (Hecht 2017, *Optics*, section 8.13; Born & Wolf 1999,
//! *Principles of Optics*, section 1.4.2). Fields vary as e^(i omega t), and an absorbing index is n - i k.

use crate::math::DVec3;
use crate::spectrum::{LaneSet, Lanes};

/// The Mueller matrix of a smooth boundary, or of one facet:
///
/// ```text
/// a  d  0  0
/// d  a  0  0
/// 0  0  c -q
/// 0  0  q  c
/// ```
///
/// Both frames have s as their x axis, perpendicular to the plane of incidence, so that p = z x s and r_p = -r_s at
/// normal incidence. With the factors S and P on the intensities and s and p on the amplitudes, a = (S + P) / 2,
/// d = (S - P) / 2 and c + i q = conj(s) p.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Block<T> {
    /// Factor on unpolarized light.
    pub a: T,
    /// Half the excess of s over p.
    pub d: T,
    /// Factor on light polarized at 45 degrees.
    pub c: T,
    /// Part of light polarized at 45 degrees that becomes right-handed.
    pub q: T,
}

impl Block<f64> {
    /// The block of a boundary that changes nothing.
    pub const IDENTITY: Self = Self { a: 1.0, d: 0.0, c: 1.0, q: 0.0 };

    /// Returns the block of amplitudes without a phase.
    fn of_amplitudes(s: f64, p: f64) -> Self {
        Self { a: 0.5 * (s * s + p * p), d: 0.5 * (s * s - p * p), c: s * p, q: 0.0 }
    }

    /// Returns the reflection of the boundary from index `n1` to a different index `n2`, at an angle of incidence with
    /// cosine `cos` in 0..1.
    ///
    /// Fresnel 1823. Beyond the critical angle p is ahead of s by delta,
    /// tan(delta / 2) = cos sqrt(sin^2 - n^2) / sin^2, n = n2 / n1 (Born & Wolf 1999, section 1.5.4).
    pub fn reflected(n1: f64, n2: f64, cos: f64) -> Self {
        match Fresnel::new(n1, n2, cos) {
            Ok(fresnel) => fresnel.reflected(),
            Err([x, y]) => {
                let inverse = 1.0 / (x * x + y * y);
                Self { a: 1.0, d: 0.0, c: (x * x - y * y) * inverse, q: 2.0 * x * y * inverse }
            }
        }
    }

    /// Returns the transmission of flux; radiance also changes by (n1 / n2)^2. It is 0 beyond the critical angle.
    pub fn refracted(n1: f64, n2: f64, cos: f64) -> Self {
        Fresnel::new(n1, n2, cos).map_or(Self::default(), |fresnel| fresnel.refracted())
    }

    /// Returns what happens to radiance at a smooth boundary between the indices `n1` and `n2`, met at an angle with
    /// cosine `cos`, if it crosses the boundary or is reflected. Between equal indices nothing happens.
    #[inline]
    pub(super) fn at_boundary([n1, n2, cos]: [f64; 3], crosses: bool) -> Self {
        match (n1 == n2, crosses) {
            (true, true) => Self::IDENTITY,
            (true, false) => Self::default(),
            (false, true) => Self::refracted(n1, n2, cos).times((n1 / n2) * (n1 / n2)),
            (false, false) => Self::reflected(n1, n2, cos),
        }
    }

    /// Returns the reflection of a metal n - i k under a medium of index `n1`.
    ///
    /// With u - i b = sqrt((n - i k)^2 / n1^2 - sin^2), r_s = (cos - u + i b) / (cos + u - i b) and r_p / r_s =
    /// -(u - i b - e) / (u - i b + e), e = sin^2 / cos (Born & Wolf 1999, section 14.4, with the signs of this module).
    pub(super) fn of_metal(n1: f64, n: f64, k: f64, cos: f64) -> Self {
        let cos = cos.clamp(0.0, 1.0);
        let (eta, kappa) = (n / n1, k / n1);
        let (c2, s2) = (cos * cos, 1.0 - cos * cos);
        let t0 = eta * eta - kappa * kappa - s2;
        let modulus = (t0 * t0 + 4.0 * eta * eta * kappa * kappa).sqrt();
        let u = (0.5 * (modulus + t0)).max(0.0).sqrt();
        let b = (0.5 * (modulus - t0)).max(0.0).sqrt();
        let squared = |u: f64, v: f64| u * u + v * v;
        let s_denominator = modulus + c2 + 2.0 * u * cos;
        let s = if s_denominator == 0.0 { 1.0 } else { (modulus + c2 - 2.0 * u * cos) / s_denominator };
        let (uc, bc) = (u * cos, b * cos);
        let p_denominator = squared(uc + s2, bc);
        if p_denominator == 0.0 {
            return Self { a: 1.0, d: 0.0, c: 1.0, q: 0.0 };
        }
        let p = s * squared(uc - s2, bc) / p_denominator;
        let [c, q] = [s2 * s2 - squared(uc, bc), 2.0 * s2 * bc].map(|part| s * part / p_denominator);
        Self { a: 0.5 * (s + p), d: 0.5 * (s - p), c, q }
    }

    /// Returns the transmission of a sheet that transmits all light polarized along its axis, which is s, and the share
    /// `extinction` of light polarized across it.
    pub fn of_polarizer(extinction: f64) -> Self {
        Self::of_amplitudes(1.0, extinction.sqrt())
    }

    /// Returns the transmission of a sheet in which light along its fast axis, which is s, is ahead by a phase in
    /// radians.
    pub(super) fn of_retarder(phase: f64) -> Self {
        let (sin, cos) = libm::sincos(phase);
        Self { a: 1.0, d: 0.0, c: cos, q: -sin }
    }

    /// Returns the transmission and the reflection of two equal parallel surfaces, each of which reflects `one` and
    /// transmits `crossing`; the share `t` is left after one way between them. The reflections add up incoherently.
    pub(super) fn of_pane(one: Self, crossing: Self, t: f64) -> [Self; 2] {
        if crossing.a <= 0.0 {
            return [Self::default(), one];
        }
        let [(r_s, x_s), (r_p, x_p)] = [1.0, -1.0].map(|sign| (one.a + sign * one.d, crossing.a + sign * crossing.d));
        // (through, back) of a component that is multiplied by r at a reflection and by x at a crossing. 1 - r^2 is
        // passed as a sum of what crosses, so that nothing cancels.
        let series = |r: f64, x: f64, crosses: f64| {
            let through = x * x * t / ((1.0 - t * t) + t * t * crosses);
            [through, r + r * t * through]
        };
        let (s, p) = (series(r_s, x_s, x_s * (1.0 + r_s)), series(r_p, x_p, x_p * (1.0 + r_p)));
        let mixed = series(one.c, crossing.c, x_s + x_p - x_s * x_p);
        [0, 1].map(|way| Self { a: 0.5 * (s[way] + p[way]), d: 0.5 * (s[way] - p[way]), c: mixed[way], q: 0.0 })
    }

    /// Returns the degree (s - p) / (s + p) to which unpolarized light becomes polarized; 0 if no light is left.
    pub(super) fn degree(self) -> f64 {
        if self.a > 0.0 { self.d / self.a } else { 0.0 }
    }

    /// Returns the block multiplied by a factor.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self { a: self.a * factor, d: self.d * factor, c: self.c * factor, q: self.q * factor }
    }
}

/// Fresnel's equations of a boundary, with one square root and one division.
struct Fresnel {
    /// n1 c1, n2 c2, n2^2 c1 and n1 n2 c2, with the cosines c1 and c2 on both sides.
    s: [f64; 2],
    p: [f64; 2],
    /// One over (n1 c1 + n2 c2) (n2^2 c1 + n1 n2 c2).
    inverse: f64,
    n2: f64,
}

impl Fresnel {
    /// Evaluates them at an angle with cosine `cos`. Beyond the critical angle, returns sin^2 and cos sqrt(sin^2 - n^2)
    /// instead, both times n1.
    fn new(n1: f64, n2: f64, cos: f64) -> Result<Self, [f64; 2]> {
        let c1 = cos.clamp(0.0, 1.0);
        let along = n1 * c1;
        let squared = (n2 - n1) * (n2 + n1) + along * along;
        if squared <= 0.0 {
            return Err([n1 * (1.0 - c1 * c1), c1 * (-squared).sqrt()]);
        }
        let beyond = squared.sqrt().min(n2);
        let (s, p) = ([along, beyond], [n2 * n2 * c1, n1 * beyond]);
        let inverse = 1.0 / ((s[0] + s[1]) * (p[0] + p[1]));
        Ok(Self { s, p, inverse, n2 })
    }

    fn reflected(&self) -> Block<f64> {
        let Self { s: [s1, s2], p: [p1, p2], inverse, .. } = *self;
        Block::of_amplitudes((s1 - s2) * (p1 + p2) * inverse, (p1 - p2) * (s1 + s2) * inverse)
    }

    fn refracted(&self) -> Block<f64> {
        let Self { s: [s1, s2], p: [p1, p2], inverse, n2 } = *self;
        // Both amplitudes are 2 sqrt(n1 n2 c1 c2) over a sum.
        let (s, p) = ((p1 + p2) * inverse, n2 * (s1 + s2) * inverse);
        Block::of_amplitudes(s, p).times(4.0 * s1 * s2)
    }
}

impl<const N: usize> Block<Lanes<N>> {
    /// The block that absorbs everything.
    const NONE: Self = Self { a: Lanes::ZERO, d: Lanes::ZERO, c: Lanes::ZERO, q: Lanes::ZERO };

    /// Sets a lane.
    pub fn set(&mut self, lane: usize, block: Block<f64>) {
        let Block { a, d, c, q } = block;
        (self.a.0[lane], self.d.0[lane], self.c.0[lane], self.q.0[lane]) = (a as f32, d as f32, c as f32, q as f32);
    }

    fn map(&self, of: impl Fn(Lanes<N>) -> Lanes<N>) -> Self {
        Self { a: of(self.a), d: of(self.d), c: of(self.c), q: of(self.q) }
    }

    fn plus(&self, other: &Self) -> Self {
        Self { a: self.a + other.a, d: self.d + other.d, c: self.c + other.c, q: self.q + other.q }
    }
}

/// What a coat does to the polarization of light that crosses it, is depolarized below and crosses it again: matrix
/// elements of the polarization that arises on the way out, on the way in, and on both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Base<const N: usize> {
    /// The coat's unit normal; s is perpendicular to it, for both the leaving and the arriving light.
    pub normal: DVec3,
    /// From S0 of arriving light to S1 of leaving light.
    pub leaving: Lanes<N>,
    /// From S1 of arriving light to S0 of leaving light.
    pub arriving: Lanes<N>,
    /// From S1 of arriving light to S1 of leaving light.
    pub both: Lanes<N>,
}

/// What a surface does to light that leaves it toward the viewer, in the unit of its share or of BSDF times cosine.
///
/// The rest of that share, in neither `block` nor `base`, leaves unpolarized however it arrives. Matrices are large, so
/// they are filled in place.
#[derive(Clone, Debug, PartialEq)]
pub struct Mueller<const N: usize> {
    /// Perpendicular to the plane of incidence of `block`, of any length; 0 if there is none.
    pub axis: DVec3,
    /// The light that meets one boundary.
    pub block: Block<Lanes<N>>,
    /// The light from below a coat. Boxed, since most surfaces have none and matrices are passed around.
    pub base: Option<Box<Base<N>>>,
}

impl<const N: usize> Mueller<N> {
    /// The matrix of a surface that leaves no polarization.
    pub const NONE: Self = Self { axis: DVec3::ZERO, block: Block::NONE, base: None };

    /// Sets the matrix of a boundary, with a block for each of some lanes. If `lanes` is a single one, the blocks of
    /// the others have no meaning.
    pub fn set_lanes(&mut self, axis: DVec3, lanes: LaneSet, mut block_of: impl FnMut(usize) -> Block<f64>) {
        (self.axis, self.base) = (axis, None);
        if lanes.single_lane().is_none() {
            self.block = Block::NONE;
        }
        for lane in lanes.iter() {
            self.block.set(lane, block_of(lane));
        }
    }

    /// Sets the matrix of a share of light that stays as it is.
    pub(super) fn set_unchanged(&mut self, share: Lanes<N>) {
        let block = Block { a: share, d: Lanes::ZERO, c: share, q: Lanes::ZERO };
        (self.axis, self.block, self.base) = (DVec3::ZERO, block, None);
    }

    /// Multiplies the matrix by a share.
    pub fn scale(&mut self, share: Lanes<N>) {
        self.block = self.block.map(|part| part * share);
        if let Some(base) = &mut self.base {
            [&mut base.leaving, &mut base.arriving, &mut base.both].into_iter().for_each(|part| *part = *part * share);
        }
    }

    /// Turns it into the matrix of the reversed path, Q M^T Q with Q = diag(1, 1, -1, 1), which leaves a block
    /// unchanged.
    pub fn turn_back(&mut self) {
        if let Some(base) = &mut self.base {
            (base.leaving, base.arriving) = (base.arriving, base.leaving);
        }
    }

    /// Adds another matrix. If both have a plane of incidence, it must be the same.
    pub fn add(&mut self, other: &Self) {
        if self.axis == DVec3::ZERO {
            self.axis = other.axis;
        }
        self.block = self.block.plus(&other.block);
        match (&mut self.base, &other.base) {
            (Some(base), Some(other)) => {
                base.leaving += other.leaving;
                base.arriving += other.arriving;
                base.both += other.both;
            }
            (base @ None, other) => *base = other.clone(),
            (Some(_), None) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Block;

    fn assert_near(got: f64, expected: f64) {
        assert!((got - expected).abs() < 6e-7, "{got} for {expected}");
    }

    #[test]
    fn glass_reflects_and_refracts_as_fresnel_has_it() {
        // (angle, R, d_R, c_R, T, d_T, c_T) from index 1 to 1.5.
        for [angle, r, d_r, c_r, t, d_t, c_t] in [
            [0.0, 0.04, 0.0, -1.0, 0.96, 0.0, 1.0],
            [30.0, 0.041523, 0.391918, -0.92, 0.958477, -0.016978, 0.999856],
            [45.0, 0.050240, 0.831479, -0.555556, 0.949760, -0.043983, 0.999032],
            [56.309932, 0.073964, 1.0, 0.0, 0.926036, -0.079872, 0.996805],
            [60.0, 0.089187, 0.979796, 0.2, 0.910813, -0.095941, 0.995387],
            [75.0, 0.253061, 0.578105, 0.815963, 0.746939, -0.195860, 0.980632],
        ] {
            let cos = f64::to_radians(angle).cos();
            let (back, through) = (Block::reflected(1.0, 1.5, cos), Block::refracted(1.0, 1.5, cos));
            [(back.a, r), (back.d / back.a, d_r), (back.c / back.a, c_r), (back.q, 0.0)]
                .into_iter()
                .for_each(|(x, y)| assert_near(x, y));
            [(through.a, t), (through.d / through.a, d_t), (through.c / through.a, c_t), (through.q, 0.0)]
                .into_iter()
                .for_each(|(x, y)| assert_near(x, y));
        }
    }

    #[test]
    fn total_reflection_has_its_phase() {
        for [angle, c, q] in [[45.0, 0.8, 0.6], [60.0, 0.760870, 0.648905], [75.0, 0.927532, 0.373743]] {
            let all = Block::reflected(1.5, 1.0, f64::to_radians(angle).cos());
            [(all.a, 1.0), (all.d, 0.0), (all.c, c), (all.q, q)].into_iter().for_each(|(x, y)| assert_near(x, y));
        }
    }

    #[test]
    fn metals_have_their_reflectances_and_phase() {
        // (n, k, angle, R_s, R_p, arg r_p / r_s in degrees).
        for [n, k, angle, s, p, argument] in [
            [0.43, 2.455, 45.0, 0.849414, 0.721504, 149.731837],
            [0.43, 2.455, 75.0, 0.943701, 0.706358, 72.742012],
            [0.06, 3.586, 45.0, 0.988061, 0.976265, 158.106852],
            [0.06, 3.586, 75.0, 0.995683, 0.965111, 91.712086],
            [1.015, 6.627, 45.0, 0.939707, 0.883049, 168.152672],
            [1.015, 6.627, 75.0, 0.977597, 0.763276, 124.230155],
        ] {
            let metal = Block::of_metal(1.0, n, k, f64::to_radians(angle).cos());
            [(metal.a + metal.d, s), (metal.a - metal.d, p)].into_iter().for_each(|(x, y)| assert_near(x, y));
            assert_near(metal.q.atan2(metal.c).to_degrees() / 1000.0, argument / 1000.0);
            assert_near(metal.c.hypot(metal.q), (s * p).sqrt());
        }
        let along = Block::of_metal(1.0, 0.43, 2.455, 1.0);
        assert!(along.d.abs() < 1e-15 && (along.c + along.a).abs() < 1e-15, "{along:?}");
    }

    #[test]
    fn a_pane_sums_all_reflections() {
        let cos = f64::to_radians(60.0).cos();
        let [through, back] = Block::of_pane(Block::reflected(1.0, 1.52, cos), Block::refracted(1.0, 1.52, cos), 0.9);
        [(back.a, 0.144024), (back.d / back.a, 0.980834), (back.c / back.a, 0.192978)]
            .into_iter()
            .for_each(|(x, y)| assert_near(x, y));
        [(through.a, 0.757083), (through.d / through.a, -0.185148), (through.c / through.a, 0.969445)]
            .into_iter()
            .for_each(|(x, y)| assert_near(x, y));
    }
}

//! Thin layers between two media, in which light interferes: R and T of both polarizations, and their difference in
//! phase.

use std::f64::consts::{PI, TAU};

use smallvec::SmallVec;

use super::Block;
use super::polarization_degree::degree;
use crate::math::Complex;

/// Maximum number of layers of one coating.
pub const MAX_LAYERS: usize = 32;
/// Optical thickness of a layer in nm beyond which a lane that stands for a band of wavelengths sees no interference.
/// There the eye hardly sees any, and bands of 32 lanes hold a fringe or more.
pub const COHERENT_NM: f64 = 6500.0;
/// Maximum change of phase over a band, in radians, up to which a fringe is evaluated at the band's own wavelength
/// only.
pub const PHASE_STEP: f64 = 2.0;
/// Number of samples over a band, or over a fringe, where a single one is not enough.
const BAND_SAMPLES: usize = 16;

/// One layer, for light of one wavelength.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Layer {
    /// Refractive index n - i k.
    pub index: Complex,
    /// Thickness in nm.
    pub thickness_nm: f64,
}

impl Layer {
    /// Optical thickness in nm.
    pub fn optical_nm(&self) -> f64 {
        self.index.re * self.thickness_nm
    }
}

/// Share of the light that is reflected, or that crosses, for both polarizations.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PolarizedShare {
    /// Share of light polarized perpendicular to the plane of incidence.
    pub s: f64,
    /// Share of light polarized in the plane of incidence.
    pub p: f64,
    /// conj(s) p of the amplitudes whose squares are the shares s and p.
    pub cross: Complex,
}

impl PolarizedShare {
    fn of(s: Complex, p: Complex, factors: [f64; 2]) -> Self {
        let cross = s.conjugate() * p * (factors[0] * factors[1]).sqrt();
        Self { s: s.norm_squared() * factors[0], p: p.norm_squared() * factors[1], cross }
    }

    /// Returns the share of unpolarized light.
    pub fn mean(&self) -> f64 {
        0.5 * (self.s + self.p)
    }

    /// Returns |s - p| / (s + p).
    pub fn degree(&self) -> f64 {
        degree([self.s, self.p])
    }

    /// Returns the block of the Mueller matrix: a and d are half the sum and half the difference of s and p, c + i q is
    /// `cross`.
    ///
    /// Fields vary as e^(i omega t) and decay with n - i k. For each ray p is z x s, so that r_p = -r_s and c = -a for
    /// reflection at normal incidence.
    pub fn block(&self) -> Block<f64> {
        Block { a: self.mean(), d: 0.5 * (self.s - self.p), c: self.cross.re, q: self.cross.im }
    }

    fn add(&mut self, other: &Self, weight: f64) {
        self.s += weight * other.s;
        self.p += weight * other.p;
        self.cross += other.cross * weight;
    }
}

/// What layers between two media reflect and transmit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StackShares {
    /// The reflected light.
    pub reflected: PolarizedShare,
    /// The light that crosses, as flux; radiance also changes by (n1 / n2)^2. For an absorbing medium, the light that
    /// enters it.
    pub refracted: PolarizedShare,
}

impl StackShares {
    /// Returns the shares of unpolarized light that are reflected and that cross.
    pub(super) fn means(&self) -> [f64; 2] {
        [self.reflected.mean(), self.refracted.mean()]
    }

    /// Reflects the light that would cross, with the phase of the reflected light.
    pub(super) fn reflect_all(&mut self) {
        let PolarizedShare { s, p, .. } = self.reflected;
        self.reflected.s += self.refracted.s;
        self.reflected.p += self.refracted.p;
        if s * p > 0.0 {
            self.reflected.cross = self.reflected.cross * (self.reflected.s * self.reflected.p / (s * p)).sqrt();
        }
        self.refracted = PolarizedShare::default();
    }
}

/// Layers for light of one wavelength, the viewer's side first.
#[derive(Clone, Debug)]
pub struct Stack {
    layers: SmallVec<[Layer; 4]>,
    /// Wavelength in vacuum, in nm.
    nm: f64,
    /// Width of the band of wavelengths that the light stands for, divided by its wavelength; 0 for a single
    /// wavelength.
    band: f64,
}

impl Stack {
    /// Makes a stack for light of a wavelength in nm and the relative width of its band. Layers without thickness are
    /// left out.
    pub fn new([nm, band]: [f64; 2], layers: impl Iterator<Item = Layer>) -> Self {
        Self { layers: nonempty_layers(layers).collect(), nm, band }
    }

    /// Returns whether [`new`](Self::new) would make this stack.
    pub fn is(&self, [nm, band]: [f64; 2], layers: impl Iterator<Item = Layer>) -> bool {
        self.nm == nm && self.band == band && self.layers.iter().copied().eq(nonempty_layers(layers))
    }

    /// Returns the layers, the viewer's side first.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// Returns the thickness of all layers in nm.
    pub fn thickness_nm(&self) -> f64 {
        self.layers().iter().map(|layer| layer.thickness_nm).sum()
    }

    /// Returns whether its shares change slowly with the angle: few layers, with a total of at most a micrometer. The
    /// shares of a mirror of nine quarter waves change within a few degrees.
    pub(super) fn varies_slowly(&self) -> bool {
        self.layers().len() <= 3 && self.thickness_nm() <= 1000.0
    }

    /// Returns the largest possible difference of phase between the two ends of the band, in radians, through all
    /// layers and back.
    pub fn phase_step(&self) -> f64 {
        2.0 * TAU * self.layers().iter().map(Layer::optical_nm).sum::<f64>() / self.nm * self.band
    }

    /// Returns the layers seen from the other side.
    #[must_use]
    pub fn turned_around(&self) -> Self {
        Self { layers: self.layers.iter().rev().copied().collect(), ..*self }
    }

    /// Returns what the layers do between index `n1`, where the viewer is, and index `n2`, n - i k, beyond. `q1` is the
    /// normal component n1 cos of the light.
    ///
    /// A band over which the phase changes by more than [`PHASE_STEP`] gets the mean over its wavelengths, and over all
    /// phases of layers thicker than [`COHERENT_NM`].
    pub fn shares(&self, n1: f64, n2: Complex, q1: f64) -> StackShares {
        if self.layers.is_empty() && n2 == n1.into() {
            let all = PolarizedShare { s: 1.0, p: 1.0, cross: Complex::ONE };
            return StackShares { refracted: all, ..StackShares::default() };
        }
        if self.phase_step() <= PHASE_STEP {
            return self.coherent_shares(n1, n2, q1, |_, _| 0.0);
        }
        let is_thick = |layer: &Layer| layer.optical_nm() > COHERENT_NM;
        let has_several_thick = self.layers().iter().filter(|layer| is_thick(layer)).count() > 1;
        let samples = if has_several_thick { 4 * BAND_SAMPLES } else { BAND_SAMPLES };
        let mut mean = StackShares::default();
        for sample in 0..samples {
            // A lattice over the phases of thick layers (Korobov 1959), which is uniform in each of them.
            let mut at = sample;
            let shares = self.coherent_shares(n1, n2, q1, |layer, delta| {
                if is_thick(layer) {
                    let extra_phase = at as f64 / samples as f64 * PI;
                    at = at * 27 % samples;
                    return extra_phase;
                }
                ((sample as f64 + 0.5) / samples as f64 - 0.5) * self.band * delta
            });
            mean.reflected.add(&shares.reflected, 1.0 / samples as f64);
            mean.refracted.add(&shares.refracted, 1.0 / samples as f64);
        }
        mean
    }

    /// Returns the shares of light of one wavelength; `extra_phase` returns what to add to each layer's phase.
    ///
    /// Abeles' matrices (Born & Wolf 1999, *Principles of Optics*, section 1.6.2), with y = q for s and y = q / n^2 for
    /// p, q = sqrt(n^2 - n1^2 sin^2), Im q <= 0. The amplitudes of p are thus those of the magnetic field, and
    /// r_p = -r_s at normal incidence. sin(delta) / q serves both off-diagonal terms and is finite at the critical
    /// angle of a layer. Each matrix is divided by e^|Im delta|, so that nothing overflows, however much is absorbed.
    fn coherent_shares(
        &self,
        n1: f64,
        n2: Complex,
        q1: f64,
        mut extra_phase: impl FnMut(&Layer, f64) -> f64,
    ) -> StackShares {
        let normal_component = |n: Complex| ((n - n1.into()) * (n + n1.into()) + (q1 * q1).into()).decaying_root();
        let q2 = normal_component(n2);
        let (y1, y2) = ([q1, q1 / (n1 * n1)].map(Complex::from), [q2, q2 / (n2 * n2)]);
        let mut fields = y2.map(|y| [Complex::ONE, y]);
        let mut decay = 0.0;
        for layer in self.layers().iter().rev() {
            let waves = layer.thickness_nm / self.nm;
            let n = layer.index.re;
            let q_squared = (n - n1) * (n + n1) + q1 * q1;
            if layer.index.im == 0.0 && q_squared > 0.0 {
                let q = q_squared.sqrt();
                let delta = q * (TAU * waves);
                propagate_clear(&mut fields, q, n * n, delta + extra_phase(layer, delta));
                continue;
            }
            let q = normal_component(layer.index);
            let delta = q * (TAU * waves);
            let mut phase = delta.re;
            // Waves that only decay have no fringes.
            if q.re > -q.im {
                phase += extra_phase(layer, delta.re);
            }
            let (sin, cos) = libm::sincos(phase);
            let lost = -libm::expm1(2.0 * delta.im);
            let (even, odd) = (1.0 - 0.5 * lost, 0.5 * lost);
            decay -= delta.im;
            let cosine = Complex::new(cos * even, sin * odd);
            let over_q = match q == Complex::default() {
                true => Complex::from(TAU * waves),
                false => Complex::new(sin * even, -cos * odd) / q,
            };
            let n_squared = layer.index * layer.index;
            let [s, p] = [[over_q, over_q * q * q], [over_q * n_squared, over_q * q * q / n_squared]]
                .map(|pair| pair.map(Complex::times_i));
            for (field, [above, below]) in fields.iter_mut().zip([s, p]) {
                let [b, c] = *field;
                *field = [cosine * b + above * c, below * b + cosine * c];
            }
        }
        let left = libm::exp(-2.0 * decay);
        let amplitudes = [0, 1].map(|i| {
            let [b, c] = fields[i];
            let sum = y1[i] * b + c;
            [(y1[i] * b - c) / sum, (y1[i] + y1[i]) / sum]
        });
        let [[r_s, t_s], [r_p, t_p]] = amplitudes;
        let crossing = [0, 1].map(|i| if y1[i].re > 0.0 { left * y2[i].re.max(0.0) / y1[i].re } else { 0.0 });
        StackShares {
            reflected: PolarizedShare::of(r_s, r_p, [1.0; 2]),
            refracted: PolarizedShare::of(t_s, t_p, crossing),
        }
    }
}

fn nonempty_layers(layers: impl Iterator<Item = Layer>) -> impl Iterator<Item = Layer> {
    layers.filter(|layer| layer.thickness_nm > 0.0)
}

/// Propagates the fields of s and p to the near side of a layer that neither absorbs nor reflects totally. Its matrices
/// are real except for a factor i.
fn propagate_clear(fields: &mut [[Complex; 2]; 2], q: f64, n_squared: f64, phase: f64) {
    let (sin, cos) = libm::sincos(phase);
    let (over_q, times_q) = (sin / q, sin * q);
    let [s, p] = [[over_q, times_q], [over_q * n_squared, times_q / n_squared]];
    for (field, [above, below]) in fields.iter_mut().zip([s, p]) {
        let [b, c] = *field;
        *field = [b * cos + (c * above).times_i(), (b * below).times_i() + c * cos];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BK7: f64 = 1.518_522_366;
    const DEGREE: f64 = PI / 180.0;

    /// Makes layers of clear indices and thicknesses in nm, or absorbing ones, at a wavelength in nm.
    fn stack(layers: &[([f64; 2], f64)], nm: f64) -> Stack {
        let layer = |&([n, k], thickness_nm): &([f64; 2], f64)| Layer { index: Complex::new(n, -k), thickness_nm };
        Stack::new([nm, 0.0], layers.iter().map(layer))
    }

    fn shares_at(layers: &[([f64; 2], f64)], nm: f64, n1: f64, n2: [f64; 2], degrees: f64) -> StackShares {
        stack(layers, nm).shares(n1, Complex::new(n2[0], -n2[1]), n1 * (degrees * DEGREE).cos())
    }

    /// Returns a, and d, c and q divided by it.
    fn normalized_elements(share: &PolarizedShare) -> [f64; 4] {
        let Block { a, d, c, q } = share.block();
        [a, d / a, c / a, q / a]
    }

    fn assert_near(found: f64, expected: f64, tolerance: f64) {
        assert!((found - expected).abs() < tolerance, "{found} for {expected}");
    }

    fn phase(share: &PolarizedShare) -> f64 {
        let [_, _, c, q] = normalized_elements(share);
        q.atan2(c).abs() / DEGREE
    }

    #[test]
    fn without_layers_the_boundary_is_fresnel_s() {
        let both_ways = |degrees: f64| [(degrees, [1.0, 1.5]), (degrees, [1.5, 1.0])];
        for (degrees, [n1, n2]) in [0.0, 30.0, 45.0, 60.0, 75.0].into_iter().flat_map(both_ways) {
            let (shares, cos) = (shares_at(&[], 550.0, n1, [n2, 0.0], degrees), f64::cos(degrees * DEGREE));
            let fresnel = [Block::reflected(n1, n2, cos), Block::refracted(n1, n2, cos)];
            for (share, Block { a, d, c, q }) in [shares.reflected, shares.refracted].iter().zip(fresnel) {
                let found = share.block();
                for (found, expected) in [(found.a, a), (found.d, d), (found.c, c), (found.q, q)] {
                    assert_near(found, expected, 1e-14);
                }
            }
        }
    }

    /// A linear congruential generator, for layers of any kind.
    fn random() -> impl FnMut(f64, f64) -> f64 {
        let mut state = 1_u64;
        move |from, to| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            from + (to - from) * (state >> 11) as f64 / 9_007_199_254_740_992.0
        }
    }

    #[test]
    fn clear_layers_lose_nothing_and_are_the_same_from_both_sides() {
        let mut random = random();
        for _ in 0..5000 {
            let count = random(1.0, 33.0) as usize;
            let thickest = [300.0, 3000.0, 100_000.0][random(0.0, 3.0) as usize];
            let layers: Vec<_> = (0..count).map(|_| ([random(1.0, 2.5), 0.0], random(0.0, thickest))).collect();
            let (stack, [n1, n2]) = (stack(&layers, random(380.0, 730.0)), [random(1.0, 2.0), random(1.0, 2.0)]);
            let q1 = n1 * random(0.0, 1.0);
            let shares = stack.shares(n1, n2.into(), q1);
            let (r, t) = (shares.reflected, shares.refracted);
            assert_near(r.s + t.s, 1.0, 1e-12);
            assert_near(r.p + t.p, 1.0, 1e-12);
            let q2_squared = q1 * q1 + (n2 - n1) * (n2 + n1);
            if q2_squared > 0.0 {
                let back = stack.turned_around().shares(n2, n1.into(), q2_squared.sqrt());
                assert_near(back.refracted.s, t.s, 1e-10);
                assert_near(back.refracted.p, t.p, 1e-10);
            }
        }
    }

    #[test]
    fn clear_layers_act_like_layers_that_hardly_absorb() {
        let mut random = random();
        for _ in 0..2000 {
            let layer = |random: &mut dyn FnMut(f64, f64) -> f64| (random(1.0, 2.5), random(0.0, 2000.0));
            let layers: Vec<_> = (0..3).map(|_| layer(&mut random)).collect();
            let (nm, degrees) = (random(380.0, 730.0), random(0.0, 89.0));
            // Light that comes from glass is totally reflected by some of the layers, and part of it tunnels through.
            let of = |k: f64| {
                let layers: Vec<_> = layers.iter().map(|&(n, thickness)| ([n, k], thickness)).collect();
                shares_at(&layers, nm, 1.5, [1.7, 0.0], degrees)
            };
            let [clear, dim] = [of(0.0), of(1e-18)].map(|shares| {
                [shares.reflected, shares.refracted].map(|way| [way.s, way.p, way.cross.re, way.cross.im])
            });
            for (clear, dim) in clear.as_flattened().iter().zip(dim.as_flattened()) {
                assert_near(*clear, *dim, 1e-11);
            }
        }
    }

    #[test]
    fn an_absorbing_layer_reflects_transmits_and_absorbs() {
        let StackShares { reflected: r, refracted: t } =
            shares_at(&[([2.3, 0.1], 100.0)], 550.0, 1.0, [1.5, 0.0], 30.0);
        let found = [r.s, t.s, 1.0 - r.s - t.s, r.p, t.p, 1.0 - r.p - t.p];
        let expected = [0.170_494, 0.654_205, 0.175_300, 0.099_452, 0.711_481, 0.189_067];
        (0..6).for_each(|i| assert_near(found[i], expected[i], 1e-6));
    }

    #[test]
    fn a_quarter_wave_darkens_glass() {
        let quarter = [([1.38, 0.0], 550.0 / 4.0 / 1.38)];
        let reflected = |degrees| shares_at(&quarter, 550.0, 1.0, [BK7, 0.0], degrees).reflected;
        let amplitude = (BK7 - 1.38 * 1.38) / (BK7 + 1.38 * 1.38);
        assert_near(reflected(0.0).mean(), amplitude * amplitude, 1e-12);
        assert_near(reflected(0.0).mean(), 0.012_709, 1e-6);
        for (degrees, s, p, delta) in [
            (30.0, 0.020_783, 0.007_085, 178.5563),
            (45.0, 0.040_246, 0.001_373, 165.1251),
            (60.0, 0.101_084, 0.006_016, 17.7510),
            (75.0, 0.304_050, 0.114_505, 5.9963),
        ] {
            let found = reflected(degrees);
            assert_near(found.s, s, 1e-6);
            assert_near(found.p, p, 1e-6);
            assert_near(phase(&found), delta, 2e-3);
        }
    }

    #[test]
    fn quarter_waves_of_two_kinds_are_a_mirror() {
        let [high, low] = [2.35, 1.38].map(|n| ([n, 0.0], 550.0 / 4.0 / n));
        for (pairs, at_550, at_450) in
            [(1, 0.683_313, 0.535_443), (3, 0.955_855, 0.589_673), (5, 0.994_646, 0.123_001), (9, 0.999_924, 0.620_067)]
        {
            let layers: Vec<_> = std::iter::repeat_n([high, low], pairs).flatten().chain([high]).collect();
            let reflected = |nm, degrees| shares_at(&layers, nm, 1.0, [1.52, 0.0], degrees).reflected;
            let y = (2.35_f64 / 1.38).powi(2 * pairs as i32) * 2.35 * 2.35 / 1.52;
            assert_near(reflected(550.0, 0.0).mean(), ((1.0 - y) / (1.0 + y)).powi(2), 1e-12);
            assert_near(reflected(550.0, 0.0).mean(), at_550, 1e-6);
            assert_near(reflected(450.0, 0.0).mean(), at_450, 1e-6);
            if pairs == 5 {
                assert_near(reflected(550.0, 45.0).s, 0.997_526, 1e-6);
                assert_near(reflected(550.0, 45.0).p, 0.951_827, 1e-6);
            }
        }
    }

    #[test]
    fn a_layer_changes_what_metal_reflects() {
        let found = shares_at(&[([1.46, 0.0], 100.0)], 550.0, 1.0, [1.015, 6.627], 60.0).reflected;
        assert_near(found.s, 0.791_828, 1e-6);
        assert_near(found.p, 0.867_711, 1e-6);
        assert_near(phase(&found), 160.8335, 1e-3);
    }

    #[test]
    fn empty_layers_do_nothing_and_gaps_frustrate_total_reflection() {
        let none = shares_at(&[([1.33, 0.0], 0.0)], 550.0, 1.0, [1.0, 0.0], 37.0);
        assert_eq!([none.reflected.mean(), none.refracted.mean()], [0.0, 1.0]);
        for (gap, s, p) in [
            (50.0, 0.196_161, 0.335_224),
            (100.0, 0.547_909, 0.714_642),
            (200.0, 0.914_268, 0.956_591),
            (500.0, 0.999_695, 0.999_853),
        ] {
            let found = shares_at(&[([1.0, 0.0], gap)], 550.0, 1.5, [1.5, 0.0], 60.0);
            assert_near(found.reflected.s, s, 1e-6);
            assert_near(found.reflected.p, p, 1e-6);
            assert_near(found.reflected.s + found.refracted.s, 1.0, 1e-12);
        }
        // At the critical angle of the gap, with a gap so thick that no light is left, and along the surface.
        let critical = (1.0_f64 / 1.5).asin() / DEGREE;
        for (degrees, gap) in [(critical, 300.0), (60.0, 100_000.0), (90.0, 300.0)] {
            let found = shares_at(&[([1.0, 0.0], gap)], 550.0, 1.5, [1.5, 0.0], degrees);
            assert_near(found.reflected.mean() + found.refracted.mean(), 1.0, 1e-12);
        }
        let opaque = shares_at(&[([0.06, 3.586], 100_000.0)], 548.6, 1.0, [1.5, 0.0], 20.0);
        assert_eq!(opaque.refracted.mean(), 0.0);
        assert_near(opaque.reflected.mean(), shares_at(&[], 548.6, 1.0, [0.06, 3.586], 20.0).reflected.mean(), 1e-12);
    }

    #[test]
    fn beyond_its_coherence_a_film_is_a_pane() {
        let layers = [(1.33, 11_000.0), (2.4, 18_000.0)]
            .map(|(index, thickness_nm)| Layer { index: Complex::from(index), thickness_nm });
        let [stack, both] = [1, 2].map(|count| Stack::new([550.0, 0.02], layers.into_iter().take(count)));
        let r = (0.33_f64 / 2.33).powi(2);
        assert_near(stack.shares(1.0, 1.0.into(), 1.0).reflected.mean(), 2.0 * r / (1.0 + r), 1e-12);
        assert_near(stack.shares(1.0, 1.0.into(), 1.0).reflected.mean(), 0.039_329_698, 1e-9);
        // Two thick layers, against the mean over all pairs of phases.
        let found = both.shares(1.0, 1.5.into(), 0.8).reflected.mean();
        let mut mean = 0.0;
        for pair in 0..10_000 {
            let phases = [f64::from(pair % 100), f64::from(pair / 100)].map(|i| 0.01 * i * PI);
            let mut layer = 0;
            let at_phases = both.coherent_shares(1.0, 1.5.into(), 0.8, |_, _| {
                layer += 1;
                phases[layer - 1]
            });
            mean += 1e-4 * at_phases.reflected.mean();
        }
        assert_near(found, mean, 1e-4);
    }
}

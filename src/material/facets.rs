use std::f64::consts::{PI, TAU};

use crate::math::DVec3;
use crate::shape::{Computation, Instructions, Vectors};

/// Microscopic mirrors with GGX-distributed slopes, in the frame in which +z is the surface's normal.
///
/// Walter et al. 2007, *Microfacet Models for Refraction through Rough Surfaces*, with height-correlated masking and
/// shadowing: Heitz 2014, *Understanding the Masking-Shadowing Function*, equation 99. [`Facets::slant`] takes the
/// place of tangents, so that nothing overflows at grazing angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facets {
    alpha: f64,
}

impl Facets {
    /// Makes facets with slopes of width `alpha`, above 0 and up to 1.
    pub fn new(alpha: f64) -> Self {
        Self { alpha }
    }

    /// Returns the width of the slopes.
    pub fn alpha(&self) -> f64 {
        self.alpha
    }

    /// Returns the area of the facets with unit normal `h`, per steradian and per area of the surface.
    ///
    /// Walter et al. 2007, equation 33, divided by cos^4. Both terms are squares, so nothing cancels.
    pub fn density(&self, h: DVec3) -> f64 {
        let a2 = self.alpha * self.alpha;
        let stretched = (h.x * h.x + h.y * h.y) / a2 + h.z * h.z;
        1.0 / (PI * a2 * stretched * stretched)
    }

    /// Returns S = sqrt(alpha^2 (x^2 + y^2) + z^2). Smith's masking is G1 = 2 z / (z + S).
    #[inline(always)]
    pub fn slant(&self, w: DVec3) -> f64 {
        (self.alpha * self.alpha * (w.x * w.x + w.y * w.y) + w.z * w.z).sqrt()
    }

    /// Returns the density per steradian of `wi`, the mirror image of `wo` about a visible facet of normal `h`:
    /// D G1 / (4 cos).
    pub fn pdf(&self, wo: DVec3, h: DVec3) -> f64 {
        self.density(h) / (2.0 * (wo.z + self.slant(wo)))
    }

    /// Returns the BRDF of perfect mirrors times the cosine, D G2 / (4 cos cos) cos, for `wi` above the surface.
    pub fn reflection(&self, wo: DVec3, wi: DVec3, h: DVec3) -> f64 {
        self.density(h) / (2.0 * (wo.z * self.slant(wi) / wi.z + self.slant(wo)))
    }

    /// Returns the density per steradian of `wi`, the direction into which a visible facet of normal `h` refracts `wo`
    /// from index `n1` to a different index `n2`. `cos` are the cosines of both directions to the facet.
    ///
    /// It is D G1 cos / z, times the steradians of facets per steradian of directions: Walter et al. 2007, equation 17,
    /// but without the difference n1 cos - n2 cos, so that it is precise for nearly equal indices.
    pub(super) fn refraction_pdf(&self, wo: DVec3, h: DVec3, [n1, n2]: [f64; 2], cos: [f64; 2]) -> f64 {
        let turn = (n1 * cos[0] + n2 * cos[1]) / ((n2 - n1) * (n2 + n1));
        let visible = self.density(h) * 2.0 * cos[0] / (wo.z + self.slant(wo));
        visible * n2 * n2 * cos[1] * turn * turn
    }

    /// Returns Smith's masking G1 of a direction above or below the surface, and 1 - G1, both at full precision.
    #[inline(always)]
    pub fn masking(&self, w: DVec3) -> [f64; 2] {
        let (z, slant) = (w.z.abs(), self.slant(w));
        let excess = self.alpha * self.alpha * (w.x * w.x + w.y * w.y) / (slant + z);
        [2.0 * z / (z + slant), excess / (z + slant)]
    }

    /// Returns the share of the light refracted by a visible facet from `wo` toward `wi`, beyond the surface, that
    /// leaves unshadowed, and the rest of it, at full precision.
    ///
    /// Both directions see a facet with probability G1 G1 if their visibilities are independent, and min(G1, G1) if
    /// they are correlated as strongly as possible (the two ends between which Ashikhmin, Premoze & Shirley 2000, *A
    /// Microfacet-Based BRDF Generator*, blend). `straight` is the weight of the latter.
    #[inline(always)]
    pub fn passed(&self, wo: DVec3, wi: DVec3, straight: f64) -> [f64; 2] {
        let ([seen, hidden], [from, _]) = (self.masking(wi), self.masking(wo));
        let [max_seen, min_hidden] = if seen < from { [seen / from, 1.0 - seen / from] } else { [1.0, 0.0] };
        [seen + straight * (max_seen - seen), hidden + straight * (min_hidden - hidden)]
    }

    /// Returns the share of the light from a visible facet toward `wi` that leaves, G2 / G1, and the share that meets
    /// another facet. Both are precise, by S^2 - z^2 = alpha^2 (x^2 + y^2).
    #[inline(always)]
    pub fn unshadowed_and_shadowed(&self, wo: DVec3, wi: DVec3) -> [f64; 2] {
        if wi.z <= 0.0 {
            return [0.0, 1.0];
        }
        let (from, to) = (self.slant(wo), self.slant(wi));
        let excess = self.alpha * self.alpha * (wi.x * wi.x + wi.y * wi.y) / (to + wi.z);
        [wi.z * (wo.z + from), wo.z * excess].map(|share| share / (wo.z * to + wi.z * from))
    }

    /// Samples the normal of a facet that is visible from `wo`.
    ///
    /// Dupuy & Benyoub 2023, *Sampling Visible GGX Normals with Spherical Caps*. As `u[1]` grows, the facets go from
    /// those that mirror straight up, after stretching to a hemisphere, down to upright ones.
    pub fn visible_normal(&self, wo: DVec3, u: [f64; 2]) -> DVec3 {
        let (sin, cos) = libm::sincos(TAU * u[0]);
        self.visible_normal_from_complement(wo, [cos, sin], 1.0 - u[1])
    }

    /// Computes `visible_normal` from `left` = 1 - `u[1]`, precise even among the last facets, where `left` is small.
    #[inline(always)]
    fn visible_normal_from_complement(&self, wo: DVec3, azimuth: [f64; 2], left: f64) -> DVec3 {
        let slant = self.slant(wo);
        let stretched = DVec3::new(self.alpha * wo.x, self.alpha * wo.y, wo.z) / slant;
        let height = 1.0 + stretched.z;
        let (down, up) = ((1.0 - left) * height, 1.0 - stretched.z + left * height);
        let sin = (down * up).max(0.0).sqrt();
        let [x, y] = azimuth;
        let cap = DVec3::new(stretched.x + sin * x, stretched.y + sin * y, left * height);
        DVec3::new(self.alpha * cap.x, self.alpha * cap.y, cap.z).normalize()
    }

    /// Returns the visible facets for a quadrature, where the index beyond is `ratio` times that on this side.
    pub(super) fn visible(&self, ratio: f64) -> VisibleFacets {
        VisibleFacets {
            facets: *self,
            rows: (0..facet_count(ratio)).step_by(ROW_LENGTH).map(|first| Row::new(first, ratio)).collect(),
        }
    }
}

/// A function of a facet, to be averaged over visible facets.
///
/// Vector instructions process several facets at once if nothing is called and only values at hand are read. So
/// implementations are `#[inline(always)]`, which closures cannot be, and hold no references.
pub(super) trait FacetFunction {
    /// Returns its value for the facet of normal `h`, seen from `wo`.
    fn value_at(&self, wo: DVec3, h: DVec3) -> f64;
}

/// Number of visible facets that are processed at once.
const ROW_LENGTH: usize = 16;

/// Visible facets for a quadrature from any direction.
pub(super) struct VisibleFacets {
    facets: Facets,
    rows: Vec<Row>,
}

/// A block of sample points for visible facets, independent of the viewing direction.
struct Row {
    /// Cosine and sine of the angle around.
    azimuth: [[f64; ROW_LENGTH]; 2],
    /// Square root of `left` = 1 - `u[1]`. This is dense among upright facets, which are few and shadow most.
    v: [f64; ROW_LENGTH],
    /// Weights, which sum to 1 over all rows.
    weights: [f64; ROW_LENGTH],
}

impl Row {
    fn new(first: u32, ratio: f64) -> Self {
        let facet_count = f64::from(facet_count(ratio));
        let mut row = Self { azimuth: [[0.0; ROW_LENGTH]; 2], v: [0.0; ROW_LENGTH], weights: [0.0; ROW_LENGTH] };
        for (i, place) in (first..).take(ROW_LENGTH).map(f64::from).enumerate() {
            // A golden-ratio lattice: none of its rows can follow the curve along which total reflection sets in.
            (row.azimuth[1][i], row.azimuth[0][i]) = libm::sincos(TAU * (place * GOLDEN).fract());
            row.v[i] = (place + 0.5) / facet_count;
            row.weights[i] = 2.0 * row.v[i] / facet_count;
        }
        row
    }

    #[inline(always)]
    fn normal(&self, facets: &Facets, wo: DVec3, i: usize) -> DVec3 {
        facets.visible_normal_from_complement(wo, [self.azimuth[0][i], self.azimuth[1][i]], self.v[i] * self.v[i])
    }
}

impl VisibleFacets {
    /// Returns the facets visible from the cosine `z`: the direction they are seen from, their normals, and their
    /// weights.
    pub(super) fn from(&self, z: f64) -> impl Iterator<Item = ([DVec3; 2], f64)> {
        let wo = direction(z);
        self.rows
            .iter()
            .flat_map(move |row| (0..ROW_LENGTH).map(move |i| ([wo, row.normal(&self.facets, wo, i)], row.weights[i])))
    }

    /// Returns the mean of a function over the facets visible from the cosine `z`.
    pub(super) fn mean(&self, z: f64, function: impl FacetFunction) -> f64 {
        Instructions::best().run(Mean { facets: self.facets, rows: &self.rows, wo: direction(z), function })
    }
}

/// Returns a direction with the cosine `z`.
fn direction(z: f64) -> DVec3 {
    DVec3::new((1.0 - z * z).max(0.0).sqrt(), 0.0, z)
}

/// The mean of a function over visible facets, seen from `wo`.
struct Mean<'a, F> {
    facets: Facets,
    rows: &'a [Row],
    wo: DVec3,
    function: F,
}

impl<F: FacetFunction> Computation for Mean<'_, F> {
    type Output = f64;

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) -> f64 {
        let Self { facets, rows, wo, function } = self;
        let mut sum = 0.0;
        for row in rows {
            let mut parts = [0.0; ROW_LENGTH];
            for (i, part) in parts.iter_mut().enumerate() {
                *part = row.weights[i] * function.value_at(wo, row.normal(&facets, wo, i));
            }
            for part in parts {
                sum += part;
            }
        }
        sum
    }
}

/// (sqrt(5) - 1) / 2.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Returns the number of visible facets in a mean, where the index beyond is `ratio` times that on this side.
///
/// Shares are off by at most 1e-4, and by 8e-4 where some facets reflect totally and others do not, compared with half
/// a million facets at 13 cosines and 6 roughnesses.
fn facet_count(ratio: f64) -> u32 {
    if ratio < 1.0 { 4096 } else { 2048 }
}

/// Makes two more random numbers from the later digits of `u`, for decisions after `u` has been used up.
///
/// The factor 4096 (sqrt(5) + 1) / 2 is irrational, so that evenly spaced numbers stay evenly spaced.
pub(super) fn later_digits(u: [f64; 2]) -> [f64; 2] {
    u.map(|u| (u * 6_627.467_215_575_981).fract())
}

use std::array;
use std::sync::{Arc, OnceLock};

use super::{Interface, RoughSurface, Roughness, reflect};
use crate::math::DVec3;

/// The clear surface of an opaque body, smooth or rough: what of the light it lets in, and out again.
///
/// A rough one's share is the smooth one's and a difference read from a table, which is computed when it is first needed:
/// row by row for the relative index m, evenly in the square root of ln m, near which 1 changes most.
#[derive(Clone, Debug)]
pub struct Coat {
    roughness: Roughness,
    rows: Arc<[OnceLock<Row>; ROWS]>,
}

/// Rows of the table on each side of a relative index of 1.
const SIDE: usize = 76;
const ROWS: usize = 2 * SIDE + 1;
/// Square root of the logarithm of a relative index of 10.1, more than any two indices of a scene have.
const WIDEST: f64 = 1.52;

/// Steps of a row over the cosine.
const STEPS: usize = 64;
/// Steps of the quadrature over the visible facets: around the normal's half turn, and up.
const AROUND: usize = 48;
const UP: usize = 96;

/// What a rough surface reflects once, beyond a smooth one of the same index.
#[derive(Clone, Debug)]
struct Row {
    /// At places evenly spaced in 0..1.
    more: Vec<f64>,
    /// Of light from all around.
    mean: f64,
}

/// What crosses a coat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Crossing {
    /// Share of the light from the direction of one cosine that gets in.
    pub(super) from: f64,
    /// From the direction of the other.
    pub(super) to: f64,
    /// Share of the light from all around that gets in.
    pub(super) around: f64,
    /// Square of the relative index.
    squared: f64,
}

impl Crossing {
    /// BRDF times pi of a diffuse base of reflectance `r` under the coat: T T' r / (m^2 (1 - r R)), where R is the coat's
    /// reflectance of diffuse light from inside.
    ///
    /// The radiance is 1 / m^2 times as large outside, and the geometric series sums what the coat sends back to the
    /// base. With T from all around outside, 1 - R = T / m^2 (Duntley 1942, *The Optical Properties of Diffusing
    /// Materials*, equations 42 to 45), so a white base under a clear coat loses nothing.
    pub(super) fn base(&self, r: f64) -> f64 {
        self.from * self.to * r / self.unabsorbed(r)
    }

    /// Shares of the light from the first direction that the coat and the base reflect.
    pub(super) fn reflected(&self, r: f64) -> [f64; 2] {
        [1.0 - self.from, self.from * self.around * r / self.unabsorbed(r)]
    }

    fn unabsorbed(&self, r: f64) -> f64 {
        self.squared * (1.0 - r) + r * self.around
    }
}

impl Coat {
    pub(super) fn new(roughness: f64) -> Self {
        Self { roughness: Roughness::new(roughness), rows: Arc::new(array::from_fn(|_| OnceLock::new())) }
    }

    /// How rough it is.
    pub fn roughness(&self) -> &Roughness {
        &self.roughness
    }

    /// What crosses into index `n2` under `n1`, from two directions of the given cosines.
    pub(super) fn crossing(&self, n1: f64, n2: f64, from: f64, to: f64) -> Crossing {
        let m = n2 / n1;
        let squared = m * m;
        let around = diffuse_transmittance(m);
        let [from_smooth, to_smooth] = [from, to].map(|cos| transmittance(n1, n2, cos));
        let Some(surface) = self.roughness.surface() else {
            return Crossing { from: from_smooth, to: to_smooth, around, squared };
        };
        let again = surface.reflected_again(1.0 - around);
        let rows = self.rows(surface, m);
        let rough = |smooth: f64, cos: f64| {
            let place = Places::new(surface).of(cos);
            let more: f64 = rows.iter().map(|(part, row)| part * row.at(place)).sum();
            (smooth - more - again * surface.blocked(cos)).clamp(0.0, 1.0)
        };
        let more: f64 = rows.iter().map(|(part, row)| part * row.mean).sum();
        let around = around - more - again * surface.mean_blocked();
        Crossing { from: rough(from_smooth, from), to: rough(to_smooth, to), around, squared }
    }

    /// What of the light reflected by perfect mirrors more than once the coat reflects.
    pub(super) fn reflected_again(surface: &RoughSurface, n1: f64, n2: f64) -> f64 {
        surface.reflected_again(1.0 - diffuse_transmittance(n2 / n1))
    }

    /// The rows on both sides of a relative index, and how much of each is taken.
    fn rows(&self, surface: &RoughSurface, m: f64) -> [(f64, &Row); 2] {
        let log = libm::log(m);
        let at = (log.abs().sqrt().copysign(log) / WIDEST + 1.0) * SIDE as f64;
        let below = (at.max(0.0) as usize).min(ROWS - 2);
        let part = (at - below as f64).clamp(0.0, 1.0);
        let row = |number: usize| {
            self.rows[number].get_or_init(|| {
                let root = (number as f64 / SIDE as f64 - 1.0) * WIDEST;
                Row::new(surface, libm::exp(root * root.abs()))
            })
        };
        [(1.0 - part, row(below)), (part, row(below + 1))]
    }
}

impl Row {
    fn new(surface: &RoughSurface, m: f64) -> Self {
        let (places, mut more) = (Places::new(surface), vec![0.0; STEPS + 1]);
        for (step, more) in more.iter_mut().enumerate() {
            // At the very horizon a rough surface still lets light in, which a smooth one does not.
            let z = places.cosine(step as f64 / STEPS as f64).max(HORIZON);
            *more = reflected_once(surface, m, z) - (1.0 - transmittance(1.0, m, z));
        }
        Self { mean: places.mean(&more), more }
    }

    /// The difference at a place, linear between those of the row.
    fn at(&self, place: f64) -> f64 {
        let place = place * STEPS as f64;
        let step = (place as usize).min(STEPS - 1);
        self.more[step] + (place - step as f64) * (self.more[step + 1] - self.more[step])
    }
}

/// Where a row has its places w: at the cosines alpha ((1 + 1 / alpha)^(w w) - 1), as [`RoughSurface`] has its own.
struct Places {
    alpha: f64,
    /// ln(1 + 1 / alpha).
    span: f64,
}

impl Places {
    fn new(surface: &RoughSurface) -> Self {
        let alpha = surface.facets().alpha();
        Self { alpha, span: libm::log1p(1.0 / alpha) }
    }

    fn cosine(&self, place: f64) -> f64 {
        (self.alpha * libm::expm1(self.span * place * place)).min(1.0)
    }

    fn of(&self, cos: f64) -> f64 {
        (libm::log1p(cos / self.alpha) / self.span).clamp(0.0, 1.0).sqrt()
    }

    /// Twice the integral of a row times cosine over the cosine, exact for its linear pieces but for 1e-8.
    fn mean(&self, row: &[f64]) -> f64 {
        /// Places and half weights of the Gauss-Legendre rule of order 6.
        const GAUSS: [[f64; 2]; 3] =
            [[0.112_701_665_379_258_3, 5.0 / 18.0], [0.5, 8.0 / 18.0], [0.887_298_334_620_741_7, 5.0 / 18.0]];
        let mut sum = 0.0;
        for (step, pair) in row.windows(2).enumerate() {
            for [x, weight] in GAUSS {
                let place = (step as f64 + x) / STEPS as f64;
                let z = self.cosine(place);
                let slope = 2.0 * self.span * place * (z + self.alpha);
                sum += weight * (pair[0] + x * (pair[1] - pair[0])) * 2.0 * z * slope;
            }
        }
        sum / STEPS as f64
    }
}

/// Cosine taken for the horizon's.
const HORIZON: f64 = 1e-9;

/// Share of the light from the cosine `z` that facets of relative index m reflect and no facet blocks.
fn reflected_once(surface: &RoughSurface, m: f64, z: f64) -> f64 {
    let facets = surface.facets();
    let wo = DVec3::new((1.0 - z * z).max(0.0).sqrt(), 0.0, z);
    let mut sum = 0.0;
    for up in 0..UP {
        // left = v^2: dense among upright facets, which are few.
        let v = (up as f64 + 0.5) / UP as f64;
        for around in 0..AROUND {
            let h = facets.visible_normal_from_end(wo, 0.5 * (around as f64 + 0.5) / AROUND as f64, v * v);
            let reflected = 1.0 - transmittance(1.0, m, wo.dot(h).clamp(0.0, 1.0));
            sum += 2.0 * v * reflected * (1.0 - facets.blocked(wo, reflect(wo, h)));
        }
    }
    sum / (UP * AROUND) as f64
}

/// Share of the light that crosses a smooth boundary; all of it where there is none.
fn transmittance(n1: f64, n2: f64, cos: f64) -> f64 {
    if n1 == n2 { 1.0 } else { Interface::new(n1, n2, cos).transmittance }
}

/// Share of diffuse light that crosses a smooth boundary to a relative index m.
///
/// 1 - R for the closed form of R by Walsh 1926, in Duntley 1942, equation 49. It cancels near 1, where R is
/// (m - 1) / 3 - 3 (m - 1)^2 to 1e-8. Below 1, T(m) = m^2 T(1 / m), for light takes the same ways in and out.
pub fn diffuse_transmittance(m: f64) -> f64 {
    if m < 1.0 {
        return m * m * diffuse_transmittance(1.0 / m);
    }
    let over = m - 1.0;
    if over < 1e-3 {
        return 1.0 - over / 3.0 + 3.0 * over * over;
    }
    let (m2, m4) = (m * m, m * m * m * m);
    let (sum, difference) = (m2 + 1.0, m4 - 1.0);
    let reflected = 0.5
        + over * (3.0 * m + 1.0) / (6.0 * (m + 1.0) * (m + 1.0))
        + m2 * (m2 - 1.0) * (m2 - 1.0) / (sum * sum * sum) * libm::log(over / (m + 1.0))
        - 2.0 * m2 * m * (m2 + 2.0 * m - 1.0) / (sum * difference)
        + 8.0 * m4 * (m4 + 1.0) / (sum * difference * difference) * libm::log(m);
    1.0 - reflected
}

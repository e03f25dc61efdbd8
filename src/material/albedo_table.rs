use std::f64::consts::TAU;

use crate::math::DVec3;

/// A share of the light that meets a rough surface, tabulated over the cosine to the normal. Directions can be sampled
/// from the table if no value is negative.
///
/// Its places w in 0..1 are evenly spaced, with z = alpha ((1 + 1 / alpha)^(w w) - 1) for the cosine z. The energy
/// missing from facets with slopes of width alpha changes as z log z near 0, most where z is about alpha, and as
/// 1 / z^2 beyond.
#[derive(Clone, Debug)]
pub(super) struct AlbedoTable {
    alpha: f64,
    /// ln(1 + 1 / alpha).
    span: f64,
    values: Vec<f64>,
    /// Cosine-weighted mean over the hemisphere: the share for diffuse light.
    pub(super) mean: f64,
    /// Density of the places of sampled directions, linear between the table's places.
    pdf: Vec<f64>,
    /// Cumulative distribution of `pdf` at each place.
    cdf: Vec<f64>,
}

impl AlbedoTable {
    /// Tabulates `value` in a number of steps, for facets of width `alpha`. `value` is called once per place, in order.
    pub(super) fn new(alpha: f64, steps: usize, mut value: impl FnMut(f64) -> f64) -> Self {
        let zeros = vec![0.0; steps + 1];
        let span = libm::log1p(1.0 / alpha);
        let mut table = Self { alpha, span, values: zeros.clone(), mean: 0.0, pdf: zeros.clone(), cdf: zeros };
        table.values[0] = value(0.0);
        for step in 1..=steps {
            let place = step as f64 / steps as f64;
            let z = table.cosine(place);
            table.values[step] = value(z);
            table.pdf[step] = table.values[step] * z * table.slope(place, z);
            let area = 0.5 * (table.pdf[step - 1] + table.pdf[step]) / steps as f64;
            table.cdf[step] = table.cdf[step - 1] + area;
        }
        // From a share that is 0 everywhere, no direction is ever drawn.
        let total = if table.cdf[steps] > 0.0 { table.cdf[steps] } else { 1.0 };
        table.pdf.iter_mut().chain(&mut table.cdf).for_each(|x| *x /= total);
        table.mean = table.hemisphere_mean();
        table
    }

    fn steps(&self) -> usize {
        self.values.len() - 1
    }

    /// Returns the cosine at a place of the table.
    pub(super) fn cosine(&self, place: f64) -> f64 {
        (self.alpha * libm::expm1(self.span * place * place)).min(1.0)
    }

    /// Returns the place of a cosine in 0..1, equal in all tables of facets of this width.
    pub(super) fn place(&self, z: f64) -> f64 {
        (libm::log1p(z / self.alpha) / self.span).clamp(0.0, 1.0).sqrt()
    }

    /// Returns the derivative of the cosine with respect to the place.
    fn slope(&self, place: f64, z: f64) -> f64 {
        2.0 * self.span * place * (z + self.alpha)
    }

    /// Returns twice the integral of the table times cosine over the cosine, within 1e-8 of that of its linear pieces.
    fn hemisphere_mean(&self) -> f64 {
        /// Nodes and half weights of the Gauss-Legendre rule of order 6.
        const GAUSS: [[f64; 2]; 3] =
            [[0.112_701_665_379_258_3, 5.0 / 18.0], [0.5, 8.0 / 18.0], [0.887_298_334_620_741_7, 5.0 / 18.0]];
        let (mut sum, steps) = (0.0, self.steps() as f64);
        for (step, pair) in self.values.windows(2).enumerate() {
            for [x, weight] in GAUSS {
                let place = (step as f64 + x) / steps;
                let z = self.cosine(place);
                sum += weight * (pair[0] + x * (pair[1] - pair[0])) * 2.0 * z * self.slope(place, z);
            }
        }
        sum / steps
    }

    /// Returns the share at the cosine `z`.
    pub(super) fn value(&self, z: f64) -> f64 {
        self.at(self.place(z))
    }

    /// Returns the share at a place.
    pub(super) fn at(&self, place: f64) -> f64 {
        interpolate(&self.values, place)
    }

    /// Returns the share at the place of the cosine `z`, and the density per steradian with which [`AlbedoTable::draw`]
    /// draws directions there.
    pub(super) fn value_and_density(&self, place: f64, z: f64) -> [f64; 2] {
        let place = place.max(f64::MIN_POSITIVE);
        [self.at(place), interpolate(&self.pdf, place) / (TAU * self.slope(place, z))]
    }

    /// Samples a direction in the frame in which +z is the normal, nearly in proportion to the share times the cosine:
    /// its place is drawn from a density that is linear between the places of the table.
    pub(super) fn draw(&self, u: [f64; 2]) -> DVec3 {
        let steps = self.steps();
        let step = self.cdf.partition_point(|&cdf| cdf <= u[1]).clamp(1, steps) - 1;
        let [low, high] = [self.pdf[step], self.pdf[step + 1]];
        let area = (u[1] - self.cdf[step]).max(0.0) * steps as f64;
        // The root of low x + (high - low) x^2 / 2 = area, in the form that does not cancel.
        let root = (low * low + 2.0 * (high - low) * area).max(0.0).sqrt();
        let x = if area > 0.0 { (2.0 * area / (low + root)).min(1.0) } else { 0.0 };
        let z = self.cosine((step as f64 + x) / steps as f64);
        let (sin, (y, x)) = ((1.0 - z * z).max(0.0).sqrt(), libm::sincos(TAU * u[0]));
        DVec3::new(sin * x, sin * y, z)
    }
}

/// Interpolates a table linearly between its places.
fn interpolate(table: &[f64], place: f64) -> f64 {
    let (step, fraction) = step_at(place, table.len() - 1);
    table[step] + fraction * (table[step + 1] - table[step])
}

/// Returns the step in which a place in 0..1 lies, and the fraction of the step below the place.
pub(super) fn step_at(place: f64, steps: usize) -> (usize, f64) {
    let place = place * steps as f64;
    let step = (place as usize).min(steps - 1);
    (step, place - step as f64)
}

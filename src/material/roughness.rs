use std::f64::consts::{PI, TAU};
use std::sync::{Arc, OnceLock};

use super::{Facets, reflect};
use crate::math::DVec3;

/// How rough a surface is, from 0 (smooth) to 1, and what follows from it.
#[derive(Clone, Debug, Default)]
pub struct Roughness {
    value: f64,
    /// Computed once for all copies, when it is first needed.
    surface: Arc<OnceLock<RoughSurface>>,
}

/// Width of the facets' slopes below which a surface is taken as smooth.
const SMOOTH: f64 = 1e-4;

impl Roughness {
    /// A surface of roughness `value`: the slopes of its facets are as wide as its square.
    pub fn new(value: f64) -> Self {
        Self { value, surface: Arc::default() }
    }

    /// As the scene file has it.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// Whether the surface is too smooth to be told from a mirror.
    pub fn is_smooth(&self) -> bool {
        self.value * self.value < SMOOTH
    }

    /// How the surface reflects; none if it is smooth.
    pub fn surface(&self) -> Option<&RoughSurface> {
        if self.is_smooth() {
            return None;
        }
        Some(self.surface.get_or_init(|| RoughSurface::new(self.value * self.value)))
    }
}

/// Facets that reflect once or more often: what light loses that meets a second facet is given back by a lobe of its own.
///
/// Kulla & Conty 2017, *Revisiting Physically Based Shading at Imageworks*: the lobe is reciprocal, and perfect mirrors
/// reflect all light. Vectors are unit vectors in the frame in which +z is the normal.
///
/// The tables have evenly spaced places w in 0..1, with z = alpha ((1 + 1 / alpha)^(w w) - 1) for the cosine z: what is
/// blocked changes as z log z near 0, most where z is about alpha, and as 1 / z^2 beyond.
#[derive(Clone, Debug)]
pub struct RoughSurface {
    facets: Facets,
    /// ln(1 + 1 / alpha).
    span: f64,
    /// The share of light that meets a second facet.
    blocked: Vec<f64>,
    /// Its mean over the hemisphere, by cosine.
    mean_blocked: f64,
    /// Density of the lobe's places, linear between them.
    lobe: Vec<f64>,
    /// The part of the lobe below each place.
    below: Vec<f64>,
}

/// Directions of light at a rough surface, and what is reflected between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughReflection {
    /// Unit vector toward the light.
    pub wi: DVec3,
    /// BRDF times cosine of light reflected once, by perfect mirrors.
    pub once: f64,
    /// The same of light reflected more often.
    pub again: f64,
    /// Cosine of the angle at which a facet meets the light that is reflected once.
    pub cos: f64,
    /// Density per steradian with which `scatter` draws `wi`.
    pub pdf: f64,
}

/// Steps of the table over the cosine.
const STEPS: usize = 64;
/// Steps of the quadrature over the visible facets: around the normal's half turn, and up.
const AROUND: usize = 48;
const UP: usize = 96;

impl RoughSurface {
    fn new(alpha: f64) -> Self {
        let (facets, span, zeros) = (Facets::new(alpha), libm::log1p(1.0 / alpha), vec![0.0; STEPS + 1]);
        let mut surface =
            Self { facets, span, blocked: zeros.clone(), mean_blocked: 0.0, lobe: zeros.clone(), below: zeros };
        for step in 1..=STEPS {
            let place = step as f64 / STEPS as f64;
            let z = surface.cosine(place);
            surface.blocked[step] = surface.quadrature(z);
            surface.lobe[step] = surface.blocked[step] * z * surface.slope(place, z);
            let area = 0.5 * (surface.lobe[step - 1] + surface.lobe[step]) / STEPS as f64;
            surface.below[step] = surface.below[step - 1] + area;
        }
        let all = surface.below[STEPS];
        surface.lobe.iter_mut().chain(&mut surface.below).for_each(|x| *x /= all);
        surface.mean_blocked = surface.mean();
        surface
    }

    /// The cosine at a place of the tables.
    fn cosine(&self, place: f64) -> f64 {
        (self.facets.alpha() * libm::expm1(self.span * place * place)).min(1.0)
    }

    /// The place of a cosine.
    fn place(&self, z: f64) -> f64 {
        (libm::log1p(z / self.facets.alpha()) / self.span).clamp(0.0, 1.0).sqrt()
    }

    /// How fast the cosine grows with the place.
    fn slope(&self, place: f64, z: f64) -> f64 {
        2.0 * self.span * place * (z + self.facets.alpha())
    }

    /// The share of light from the cosine `z` that meets a second facet: the mean of `blocked` over the visible facets.
    fn quadrature(&self, z: f64) -> f64 {
        let wo = DVec3::new((1.0 - z * z).max(0.0).sqrt(), 0.0, z);
        let mut sum = 0.0;
        for up in 0..UP {
            // left = v^2: dense among upright facets, which are few and block most.
            let v = (up as f64 + 0.5) / UP as f64;
            for around in 0..AROUND {
                let turn = 0.5 * (around as f64 + 0.5) / AROUND as f64;
                let h = self.facets.visible_normal_from_end(wo, turn, v * v);
                sum += 2.0 * v * self.facets.blocked(wo, reflect(wo, h));
            }
        }
        sum / (UP * AROUND) as f64
    }

    /// Twice the integral of the table times cosine over the cosine, exact for its linear pieces but for 1e-8.
    fn mean(&self) -> f64 {
        /// Places and half weights of the Gauss-Legendre rule of order 6.
        const GAUSS: [[f64; 2]; 3] =
            [[0.112_701_665_379_258_3, 5.0 / 18.0], [0.5, 8.0 / 18.0], [0.887_298_334_620_741_7, 5.0 / 18.0]];
        let mut sum = 0.0;
        for (step, pair) in self.blocked.windows(2).enumerate() {
            for [x, weight] in GAUSS {
                let place = (step as f64 + x) / STEPS as f64;
                let z = self.cosine(place);
                sum += weight * (pair[0] + x * (pair[1] - pair[0])) * 2.0 * z * self.slope(place, z);
            }
        }
        sum / STEPS as f64
    }

    /// The facets themselves.
    pub fn facets(&self) -> &Facets {
        &self.facets
    }

    /// The share of light from all around that perfect mirrors would reflect more than once.
    pub fn mean_blocked(&self) -> f64 {
        self.mean_blocked
    }

    /// What is left, beside perfect mirrors, of light that is reflected more than once by facets of reflectance `mean`.
    ///
    /// A geometric series over further reflections: Hill 2018, *A Multi-Faceted Exploration*, part 3.
    pub fn reflected_again(&self, mean: f64) -> f64 {
        mean * mean * (1.0 - self.mean_blocked) / (1.0 - mean * self.mean_blocked)
    }

    /// The share of light from the cosine `z` that perfect mirrors would reflect more than once.
    pub fn blocked(&self, z: f64) -> f64 {
        between(&self.blocked, self.place(z))
    }

    /// Draws a direction of light for the viewer's direction `wo`; none if it lies below the surface.
    ///
    /// It is drawn from the lobe as often as perfect mirrors would reflect light more than once.
    pub fn scatter(&self, wo: DVec3, u: [f64; 2]) -> Option<RoughReflection> {
        let again = self.blocked(wo.z);
        if u[0] < again {
            return self.evaluate(wo, self.draw_from_lobe([u[0] / again, u[1]]));
        }
        let h = self.facets.visible_normal(wo, [(u[0] - again) / (1.0 - again), u[1]]);
        self.reflection(wo, reflect(wo, h), h)
    }

    /// A direction of the lobe: its place is drawn from a density that is linear between the places of the table.
    fn draw_from_lobe(&self, u: [f64; 2]) -> DVec3 {
        let step = self.below.partition_point(|&below| below <= u[1]).clamp(1, STEPS) - 1;
        let [low, high] = [self.lobe[step], self.lobe[step + 1]];
        let area = (u[1] - self.below[step]).max(0.0) * STEPS as f64;
        // The root of low x + (high - low) x^2 / 2 = area that does not cancel.
        let root = (low * low + 2.0 * (high - low) * area).max(0.0).sqrt();
        let x = if area > 0.0 { (2.0 * area / (low + root)).min(1.0) } else { 0.0 };
        let z = self.cosine((step as f64 + x) / STEPS as f64);
        let (sin, (y, x)) = ((1.0 - z * z).max(0.0).sqrt(), libm::sincos(TAU * u[0]));
        DVec3::new(sin * x, sin * y, z)
    }

    /// What is reflected from `wi` to `wo`; none if `wi` lies below the surface.
    pub fn evaluate(&self, wo: DVec3, wi: DVec3) -> Option<RoughReflection> {
        self.reflection(wo, wi, (wo + wi).try_normalize()?)
    }

    fn reflection(&self, wo: DVec3, wi: DVec3, h: DVec3) -> Option<RoughReflection> {
        if wi.z <= 0.0 {
            return None;
        }
        let (again, place) = (self.blocked(wo.z), self.place(wi.z).max(f64::MIN_POSITIVE));
        let lobe = between(&self.lobe, place) / (TAU * self.slope(place, wi.z));
        Some(RoughReflection {
            wi,
            once: self.facets.reflection(wo, wi, h),
            again: again * between(&self.blocked, place) / self.mean_blocked * wi.z / PI,
            cos: wo.dot(h).clamp(0.0, 1.0),
            pdf: (1.0 - again) * self.facets.pdf(wo, h) + again * lobe,
        })
    }
}

/// A table, linear between its places.
fn between(table: &[f64], place: f64) -> f64 {
    let place = place * STEPS as f64;
    let step = (place as usize).min(STEPS - 1);
    table[step] + (place - step as f64) * (table[step + 1] - table[step])
}

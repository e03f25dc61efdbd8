use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

use super::{Facets, reflect};
use crate::math::{DVec3, cosine_hemisphere};

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

/// Facets that reflect once or more often: what light loses that meets a second facet is given back by a wide lobe.
///
/// Kulla & Conty 2017, *Revisiting Physically Based Shading at Imageworks*: the lobe is reciprocal, and perfect mirrors
/// reflect all light. Vectors are unit vectors in the frame in which +z is the normal.
#[derive(Clone, Debug)]
pub struct RoughSurface {
    facets: Facets,
    /// The share of light that meets a second facet, at evenly spaced places of [`RoughSurface::place`].
    blocked: Vec<f64>,
    /// Its mean over the hemisphere, by cosine.
    mean_blocked: f64,
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
        let mut surface = Self { facets: Facets::new(alpha), blocked: vec![0.0; STEPS + 1], mean_blocked: 0.0 };
        for step in 1..=STEPS {
            let t = step as f64 / STEPS as f64;
            surface.blocked[step] = surface.quadrature((alpha * t / (1.0 + alpha - t)).min(1.0));
        }
        surface.mean_blocked = surface.mean();
        surface
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
        let alpha = self.facets.alpha();
        let mut sum = 0.0;
        for (step, pair) in self.blocked.windows(2).enumerate() {
            for [x, weight] in GAUSS {
                let left = 1.0 + alpha - (step as f64 + x) / STEPS as f64;
                let (z, slope) = (alpha * (1.0 + alpha - left) / left, alpha * (1.0 + alpha) / (left * left));
                sum += weight * (pair[0] + x * (pair[1] - pair[0])) * 2.0 * z * slope;
            }
        }
        sum / STEPS as f64
    }

    /// The facets themselves.
    pub fn facets(&self) -> &Facets {
        &self.facets
    }

    /// The mean over the hemisphere, by cosine, of the share of light that is reflected once, by perfect mirrors.
    pub fn mean_reflected_once(&self) -> f64 {
        1.0 - self.mean_blocked
    }

    /// The share of light from the cosine `z` that perfect mirrors would reflect more than once.
    ///
    /// The table is dense where shares change: z (1 + alpha) / (z + alpha) goes from 0 to 1.
    pub fn blocked(&self, z: f64) -> f64 {
        let alpha = self.facets.alpha();
        let place = (z * (1.0 + alpha) / (z + alpha)).clamp(0.0, 1.0) * STEPS as f64;
        let below = (place as usize).min(STEPS - 1);
        let [low, high] = [self.blocked[below], self.blocked[below + 1]];
        low + (place - below as f64) * (high - low)
    }

    /// Draws a direction of light for the viewer's direction `wo`; none if it lies below the surface.
    ///
    /// Light is as often drawn from the wide lobe as perfect mirrors reflect it more than once.
    pub fn scatter(&self, wo: DVec3, u: [f64; 2]) -> Option<RoughReflection> {
        let wide = self.blocked(wo.z);
        if u[0] < wide {
            return self.evaluate(wo, cosine_hemisphere([u[0] / wide, u[1]]));
        }
        let h = self.facets.visible_normal(wo, [(u[0] - wide) / (1.0 - wide), u[1]]);
        self.between(wo, reflect(wo, h), h)
    }

    /// What is reflected from `wi` to `wo`; none if `wi` lies below the surface.
    pub fn evaluate(&self, wo: DVec3, wi: DVec3) -> Option<RoughReflection> {
        self.between(wo, wi, (wo + wi).try_normalize()?)
    }

    fn between(&self, wo: DVec3, wi: DVec3, h: DVec3) -> Option<RoughReflection> {
        if wi.z <= 0.0 {
            return None;
        }
        let wide = self.blocked(wo.z);
        let lambert = wi.z / PI;
        Some(RoughReflection {
            wi,
            once: self.facets.reflection(wo, wi, h),
            again: wide * self.blocked(wi.z) / self.mean_blocked * lambert,
            cos: wo.dot(h).clamp(0.0, 1.0),
            pdf: (1.0 - wide) * self.facets.pdf(wo, h) + wide * lambert,
        })
    }
}

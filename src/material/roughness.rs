use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

use super::albedo_table::AlbedoTable;
use super::facets::FacetFunction;
use super::{Facets, Lobes, RoughInterface, ScatterContext, reflect};
use crate::math::{DVec3, Frame};

/// The roughness of a surface, from 0 (smooth) to 1, and what is computed from it.
#[derive(Clone, Debug, Default)]
pub struct Roughness {
    value: f64,
    /// Computed once for all copies, when first needed.
    surface: Arc<OnceLock<RoughSurface>>,
    interface: Arc<OnceLock<RoughInterface>>,
}

/// Width of the facets' slopes, alpha, below which a surface counts as smooth.
const MAX_SMOOTH_ALPHA: f64 = 1e-4;
/// Alpha below which a lobe counts as narrow. Photons then find the light that the surface sends on faster than random
/// scattering does, by a factor of two or more at half this width (`benches/README.md`).
const MAX_NARROW_ALPHA: f64 = 0.1;

impl Roughness {
    /// Makes a surface of roughness `value`. The width alpha of its facets' slopes is the square of that.
    pub fn new(value: f64) -> Self {
        Self { value, surface: Arc::default(), interface: Arc::default() }
    }

    /// Returns the value in the scene file.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// Returns the kind of lobe in which the surface reflects.
    pub fn reflection(&self) -> Lobes {
        match self.alpha() {
            ..MAX_SMOOTH_ALPHA => Lobes::DELTA_REFLECTION,
            ..MAX_NARROW_ALPHA => Lobes::NARROW_REFLECTION,
            _ => Lobes::GLOSSY_REFLECTION,
        }
    }

    /// Returns the kinds of lobes in which a boundary between clear media reflects and refracts. Between equal indices
    /// light passes straight through, however rough the boundary is.
    pub fn of_interface(&self) -> Lobes {
        match self.alpha() {
            ..MAX_SMOOTH_ALPHA => Lobes::DELTA,
            ..MAX_NARROW_ALPHA => Lobes::NARROW.union(Lobes::DELTA),
            _ => Lobes::GLOSSY_REFLECTION.union(Lobes::GLOSSY_TRANSMISSION).union(Lobes::DELTA),
        }
    }

    /// Returns the solid angle in steradians into which the surface spreads light that a mirror would send in one
    /// direction: one over the mean density of directions, weighted by the density itself. That mean is a third of
    /// 1 / (4 pi alpha^2), the density in the mirror direction.
    pub fn spread(&self) -> f64 {
        if self.is_smooth() { 0.0 } else { 12.0 * PI * self.alpha() * self.alpha() }
    }

    /// Returns the width of its facets' slopes.
    fn alpha(&self) -> f64 {
        self.value * self.value
    }

    /// Returns whether the surface is too smooth to be distinguished from a mirror.
    pub fn is_smooth(&self) -> bool {
        self.alpha() < MAX_SMOOTH_ALPHA
    }

    /// Returns the reflecting surface, or None if it is smooth.
    pub fn surface(&self) -> Option<&RoughSurface> {
        (!self.is_smooth()).then(|| self.surface.get_or_init(|| RoughSurface::new(self.alpha())))
    }

    /// Returns the boundary between clear media, or None if it is smooth.
    pub fn interface(&self) -> Option<&RoughInterface> {
        (!self.is_smooth()).then(|| self.interface.get_or_init(|| RoughInterface::new(self.alpha())))
    }
}

/// Facets that reflect once or more often. Light that meets a second facet is lost to single scattering, and restored
/// by a lobe of its own.
///
/// Kulla & Conty 2017, *Revisiting Physically Based Shading at Imageworks*: the lobe is reciprocal, and perfect mirrors
/// reflect all light. Vectors are unit vectors in the frame in which +z is the normal.
#[derive(Clone, Debug)]
pub struct RoughSurface {
    facets: Facets,
    /// Share of light that meets a second facet, which single scattering loses.
    missing_energy: AlbedoTable,
}

/// A pair of directions at a rough surface, and what is reflected between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughReflection {
    /// Unit vector toward the light.
    pub wi: DVec3,
    /// BRDF times cosine of light that is reflected once, by perfect mirrors.
    pub single: f64,
    /// BRDF times cosine of light that is reflected more than once, by perfect mirrors.
    pub multiple: f64,
    /// Cosine of the angle at which light that is reflected once meets its facet.
    pub cos: f64,
    /// Density per steradian with which `scatter` draws `wi`.
    pub pdf: f64,
}

/// Steps of the table over the cosine.
const COSINE_STEPS: usize = 64;

impl RoughSurface {
    fn new(alpha: f64) -> Self {
        let facets = Facets::new(alpha);
        Self { facets, missing_energy: missing_energy(&facets) }
    }

    /// The facets themselves.
    pub fn facets(&self) -> &Facets {
        &self.facets
    }

    /// Returns the share of diffuse light that perfect mirrors would reflect more than once.
    pub fn mean_missing_energy(&self) -> f64 {
        self.missing_energy.mean
    }

    /// Returns the factor on light that is reflected more than once, relative to perfect mirrors, for facets whose mean
    /// reflectance is `mean`.
    ///
    /// A geometric series over further reflections: Hill 2018, *A Multi-Faceted Exploration*, part 3.
    pub fn multiply_reflected(&self, mean: f64) -> f64 {
        mean * mean * (1.0 - self.mean_missing_energy()) / (1.0 - mean * self.mean_missing_energy())
    }

    /// Returns the share of light from the cosine `z` that perfect mirrors would reflect more than once.
    pub fn missing_energy(&self, z: f64) -> f64 {
        self.missing_energy.value(z)
    }

    /// Samples a direction of light for the viewer's direction `wo`. Returns None if it lies below the surface.
    ///
    /// The lobe is chosen with the probability that perfect mirrors would reflect the light more than once.
    pub fn scatter(&self, wo: DVec3, u: [f64; 2]) -> Option<RoughReflection> {
        let multiple = self.missing_energy(wo.z);
        if u[0] < multiple {
            return self.evaluate(wo, self.missing_energy.draw([u[0] / multiple, u[1]]));
        }
        let h = self.facets.visible_normal(wo, [(u[0] - multiple) / (1.0 - multiple), u[1]]);
        self.reflection(wo, reflect(wo, h), h)
    }

    /// Returns what is reflected from `wi` to `wo`, or None if `wi` lies below the surface.
    pub fn evaluate(&self, wo: DVec3, wi: DVec3) -> Option<RoughReflection> {
        self.reflection(wo, wi, (wo + wi).try_normalize()?)
    }

    /// Evaluates light from `wi` for the viewer of a context, with both directions in world space. Returns None from
    /// below.
    pub(super) fn evaluate_at<const N: usize>(
        &self,
        context: &ScatterContext<N>,
        wi: DVec3,
    ) -> Option<RoughReflection> {
        let frame = Frame::about(context.normal);
        self.evaluate(to_local_above(&frame, context.wo), frame.to_local(wi))
    }

    fn reflection(&self, wo: DVec3, wi: DVec3, h: DVec3) -> Option<RoughReflection> {
        if wi.z <= 0.0 {
            return None;
        }
        let [missing, lobe] = self.missing_energy.value_and_density(self.missing_energy.place(wi.z), wi.z);
        let multiple = self.missing_energy(wo.z);
        Some(RoughReflection {
            wi,
            single: self.facets.reflection(wo, wi, h),
            multiple: multiple * missing / self.mean_missing_energy() * wi.z / PI,
            cos: wo.dot(h).clamp(0.0, 1.0),
            pdf: (1.0 - multiple) * self.facets.pdf(wo, h) + multiple * lobe,
        })
    }
}

/// Returns the viewer's direction in the surface's frame, moved onto the surface if rounding has put it below.
pub(super) fn to_local_above(frame: &Frame, wo: DVec3) -> DVec3 {
    let local = frame.to_local(wo);
    DVec3 { z: local.z.max(0.0), ..local }
}

/// Tabulates the share of light from each cosine that meets a second facet, the mean over the visible facets.
fn missing_energy(facets: &Facets) -> AlbedoTable {
    let visible = facets.visible(1.0);
    AlbedoTable::new(facets.alpha(), COSINE_STEPS, |z| visible.mean(z, ShadowedShare(*facets)))
}

/// The share that meets a second facet if the first one reflects all light.
struct ShadowedShare(Facets);

impl FacetFunction for ShadowedShare {
    #[inline(always)]
    fn value_at(&self, wo: DVec3, h: DVec3) -> f64 {
        self.0.unshadowed_and_shadowed(wo, reflect(wo, h))[1]
    }
}

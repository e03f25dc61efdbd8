use std::array;
use std::sync::{Arc, OnceLock};

use super::albedo_table::AlbedoTable;
use super::facets::FacetFunction;
use super::film_averages::{FilmAverages, HatWeights};
use super::film_kernel::FilmKernel;
use super::fresnel::diffuse_transmittance;
use super::{Block, Facets, Interface, RoughSurface, Roughness, reflect};
use crate::math::DVec3;

/// The clear surface of an opaque body, smooth or rough: how much light it lets in, and out again.
///
/// The share of a rough coat is that of a smooth one plus a difference from a table. The table's rows are computed when
/// first needed. They are evenly spaced in the square root of ln m for the relative index m, since the difference
/// changes most near 1.
#[derive(Clone, Debug)]
pub struct Coat {
    roughness: Roughness,
    /// What a rough coat reflects once, minus what a smooth one reflects.
    rows: Rows,
    /// The polarization, s minus p, of light that a rough coat reflects once, minus that of a smooth one.
    polarized: Rows,
    /// What a film adds to the reflection of a rough coat.
    kernel: Arc<OnceLock<FilmKernel>>,
}

/// Rows of a table, by relative index.
type Rows = Arc<[OnceLock<AlbedoTable>; ROWS]>;

/// Number of rows on each side of a relative index of 1.
const ROWS_PER_SIDE: usize = 76;
const ROWS: usize = 2 * ROWS_PER_SIDE + 1;
/// Square root of the logarithm of a relative index of 10.1, larger than that of any two indices in a scene.
const MAX_SQRT_LN: f64 = 1.52;

/// Number of steps of a row over the cosine.
const COSINE_STEPS: usize = 64;

/// The transmittance of a coat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CoatTransmittance {
    /// Share of the light from a direction with the first cosine that gets in.
    pub(super) from: f64,
    /// Share of the light from a direction with the second cosine that gets in.
    pub(super) to: f64,
    /// Share of diffuse light that gets in.
    pub(super) diffuse: f64,
    /// Share reflected by multiple scattering, of the energy that single scattering by a rough coat's facets would lose
    /// if they were perfect mirrors.
    pub(super) multiple: f64,
    /// Square of the relative index.
    m_squared: f64,
    /// Share of diffuse light from inside that a film absorbs, times `m_squared`.
    absorbed: f64,
}

impl CoatTransmittance {
    /// Returns BRDF times pi of a diffuse base of reflectance `r` under the coat, T T' r / (m^2 (1 - r R)), where R is
    /// the coat's reflectance of diffuse light from inside.
    ///
    /// Radiance is 1 / m^2 times as large outside, and the geometric series sums what the coat sends back to the base.
    /// With T for diffuse light from outside, 1 - R = T / m^2 (Duntley 1942, *The Optical Properties of Diffusing
    /// Materials*, equations 42 to 45), so a white base under a clear coat loses nothing.
    pub(super) fn base(&self, r: f64) -> f64 {
        self.from * self.to * r / self.series_denominator(r)
    }

    /// Returns the shares of the light from the first direction that the coat and the base reflect.
    pub(super) fn reflected(&self, r: f64) -> [f64; 2] {
        [1.0 - self.from, self.from * self.diffuse * r / self.series_denominator(r)]
    }

    /// Returns the transmittance under a film. On a smooth coat, `from` and `to` are what both transmit from the two
    /// directions.
    pub(super) fn with_film(&self, averages: &FilmAverages, [from, to]: [f64; 2]) -> Self {
        Self { from, to, diffuse: averages.mean[1], absorbed: self.m_squared * averages.absorbed_inside, ..*self }
    }

    fn series_denominator(&self, r: f64) -> f64 {
        self.m_squared * (1.0 - r) + r * (self.diffuse + self.absorbed)
    }
}

/// The energy that single scattering by the facets of a rough coat loses, for light from two directions. It is equal
/// for all lanes.
pub(super) struct CoatMissingEnergy<'a> {
    surface: &'a RoughSurface,
    /// The missing energy if the facets were perfect mirrors.
    mirror_energy: [f64; 2],
    /// The missing energy of a film's changes: from the two directions, and of diffuse light.
    hat_weights: [HatWeights; 2],
    diffuse_hat_weights: &'a HatWeights,
}

impl CoatMissingEnergy<'_> {
    /// Returns the transmittance of the coat with a film; `bare` is that of the coat alone.
    ///
    /// Of light that the coat would reflect more than once, the part that is not reflected gets in.
    pub(super) fn transmittance_with_film(
        &self,
        averages: &FilmAverages,
        bare: &CoatTransmittance,
    ) -> CoatTransmittance {
        let multiple = self.surface.multiply_reflected(averages.mean[0]);
        let not_reflected = bare.multiple - multiple;
        let [from, to] = [(bare.from, 0), (bare.to, 1)].map(|(bare, end)| {
            let difference =
                averages.added_missing_energy(&self.hat_weights[end]) + not_reflected * self.mirror_energy[end];
            (bare + difference).clamp(0.0, 1.0)
        });
        let diffuse = bare.diffuse
            + averages.added_missing_energy(self.diffuse_hat_weights)
            + not_reflected * self.surface.mean_missing_energy();
        let absorbed = bare.m_squared * averages.absorbed_inside;
        CoatTransmittance { from, to, diffuse: diffuse.max(f64::MIN_POSITIVE), multiple, absorbed, ..*bare }
    }
}

impl Coat {
    /// Makes a coat of a roughness from 0 to 1.
    pub fn new(roughness: f64) -> Self {
        let [rows, polarized] = array::from_fn(|_| Arc::new(array::from_fn(|_| OnceLock::new())));
        Self { roughness: Roughness::new(roughness), rows, polarized, kernel: Arc::default() }
    }

    /// Returns its roughness.
    pub fn roughness(&self) -> &Roughness {
        &self.roughness
    }

    /// Returns the transmittance from index `n1` into index `n2`, from two directions of the given cosines.
    pub(super) fn transmittance(&self, [n1, n2]: [f64; 2], [from, to]: [f64; 2]) -> CoatTransmittance {
        let m = n2 / n1;
        let m_squared = m * m;
        let diffuse = diffuse_transmittance(m);
        let [from_smooth, to_smooth] = [from, to].map(|cos| Interface::new(n1, n2, cos).transmittance);
        let Some(surface) = self.roughness.surface() else {
            return CoatTransmittance {
                from: from_smooth,
                to: to_smooth,
                diffuse,
                multiple: 0.0,
                m_squared,
                absorbed: 0.0,
            };
        };
        let multiple = surface.multiply_reflected(1.0 - diffuse);
        let rows = neighboring_rows(&self.rows, m, |m| row(surface, m));
        let rough = |smooth: f64, cos: f64| {
            let place = rows[0].1.place(cos);
            let difference: f64 = rows.iter().map(|(weight, row)| weight * row.at(place)).sum();
            (smooth - difference - multiple * surface.missing_energy(cos)).clamp(0.0, 1.0)
        };
        let difference: f64 = rows.iter().map(|(weight, row)| weight * row.mean).sum();
        let diffuse = diffuse - difference - multiple * surface.mean_missing_energy();
        CoatTransmittance {
            from: rough(from_smooth, from),
            to: rough(to_smooth, to),
            diffuse,
            multiple,
            m_squared,
            absorbed: 0.0,
        }
    }

    /// Returns the energy that single scattering by a rough coat loses, for light from two directions, or None for a
    /// smooth coat.
    pub(super) fn missing_energy(&self, cosines: [f64; 2]) -> Option<CoatMissingEnergy<'_>> {
        let surface = self.roughness.surface()?;
        let kernel = self.kernel.get_or_init(|| kernel(surface));
        Some(CoatMissingEnergy {
            surface,
            mirror_energy: cosines.map(|cos| surface.missing_energy(cos)),
            hat_weights: cosines.map(|cos| kernel.at(cos)),
            diffuse_hat_weights: &kernel.mean,
        })
    }

    /// Returns the degree of polarization, (s - p) / (s + p), of light that crosses from a direction with cosine `cos`.
    ///
    /// Unpolarized light from all around leaves unpolarized in total, reflected and transmitted together, as in a
    /// closed room of one temperature. So the light that crosses, a `share` of it all, is polarized as much as the
    /// light that facets reflect once, with the opposite sign.
    pub(super) fn transmitted_degree(&self, [n1, n2]: [f64; 2], cos: f64, share: f64) -> f64 {
        if n1 == n2 {
            return 0.0;
        }
        let Some(surface) = self.roughness.surface() else {
            return Block::refracted(n1, n2, cos).degree();
        };
        let rows = neighboring_rows(&self.polarized, n2 / n1, |m| polarized_row(surface, m));
        let place = rows[0].1.place(cos);
        let difference: f64 = rows.iter().map(|(weight, row)| weight * row.at(place)).sum();
        let reflected = Block::reflected(n1, n2, cos).d + difference;
        if share > 0.0 { (-reflected / share).clamp(-1.0, 1.0) } else { 0.0 }
    }
}

/// Returns the rows on both sides of a relative index, and the weight of each.
fn neighboring_rows(rows: &Rows, m: f64, row: impl Fn(f64) -> AlbedoTable) -> [(f64, &AlbedoTable); 2] {
    let log = libm::log(m);
    let at = (log.abs().sqrt().copysign(log) / MAX_SQRT_LN + 1.0) * ROWS_PER_SIDE as f64;
    let below = (at.max(0.0) as usize).min(ROWS - 2);
    let weight = (at - below as f64).clamp(0.0, 1.0);
    let get_row = |number: usize| {
        rows[number].get_or_init(|| {
            let root = (number as f64 / ROWS_PER_SIDE as f64 - 1.0) * MAX_SQRT_LN;
            row(libm::exp(root * root.abs()))
        })
    };
    [(1.0 - weight, get_row(below)), (weight, get_row(below + 1))]
}

/// Tabulates what a rough surface reflects once and unshadowed, minus what a smooth one of the same relative index m
/// reflects.
fn row(surface: &RoughSurface, m: f64) -> AlbedoTable {
    // Exactly at the horizon a rough surface still lets light in, unlike a smooth one.
    let (facets, visible) = (surface.facets(), surface.facets().visible(m));
    AlbedoTable::new(facets.alpha(), COSINE_STEPS, |z| {
        let z = z.max(HORIZON);
        visible.mean(z, SingleReflectance { facets: *facets, m }) - (1.0 - Interface::new(1.0, m, z).transmittance)
    })
}

/// The share that facets of relative index m reflect and no other facet shadows.
struct SingleReflectance {
    facets: Facets,
    m: f64,
}

impl FacetFunction for SingleReflectance {
    #[inline(always)]
    fn value_at(&self, wo: DVec3, h: DVec3) -> f64 {
        let reflectance = 1.0 - Interface::new(1.0, self.m, wo.dot(h)).transmittance;
        reflectance * self.facets.unshadowed_and_shadowed(wo, reflect(wo, h))[0]
    }
}

/// Tabulates the polarization, s minus p, of diffuse light that a rough surface reflects once, minus that of a smooth
/// one of the same relative index m.
fn polarized_row(surface: &RoughSurface, m: f64) -> AlbedoTable {
    let (facets, visible) = (surface.facets(), surface.facets().visible(m));
    AlbedoTable::new(facets.alpha(), COSINE_STEPS, |z| {
        let z = z.max(HORIZON);
        visible.mean(z, ReflectedPolarization { facets: *facets, m }) - Block::at_boundary([1.0, m, z], false).d
    })
}

/// The polarization, s minus p, of light that facets of relative index m reflect and no other facet shadows.
struct ReflectedPolarization {
    facets: Facets,
    m: f64,
}

impl FacetFunction for ReflectedPolarization {
    #[inline(always)]
    fn value_at(&self, wo: DVec3, h: DVec3) -> f64 {
        // The direction perpendicular to the surface's plane of incidence is y.
        let across = wo.cross(h);
        let cos_squared = if across == DVec3::ZERO { 0.5 } else { across.y * across.y / across.length_squared() };
        let facet_d = Block::at_boundary([1.0, self.m, wo.dot(h)], false).d;
        facet_d * (2.0 * cos_squared - 1.0) * self.facets.unshadowed_and_shadowed(wo, reflect(wo, h))[0]
    }
}

/// Tabulates the energy missing from the light that facets reflect. All light that they transmit counts as missing.
fn kernel(surface: &RoughSurface) -> FilmKernel {
    let (facets, visible) = (surface.facets(), surface.facets().visible(1.0));
    // This takes the body to be denser than its surroundings, which it nearly always is.
    FilmKernel::new(facets.alpha(), 1.0, COSINE_STEPS, |z, add| {
        for ([wo, h], weight) in visible.from(z.max(HORIZON)) {
            let [_, missing] = facets.unshadowed_and_shadowed(wo, reflect(wo, h));
            add(wo.dot(h), weight, [missing, 1.0]);
        }
    })
}

/// The cosine that stands for the horizon.
const HORIZON: f64 = 1e-9;

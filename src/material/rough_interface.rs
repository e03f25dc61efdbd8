use std::f64::consts::{LN_10, PI};
use std::sync::OnceLock;

use super::albedo_table::AlbedoTable;
use super::facets::{FacetFunction, later_digits};
use super::film_kernel::FilmKernel;
use super::fresnel::diffuse_transmittance;
use super::{BsdfValue, Facet, Facets};
use crate::math::DVec3;

/// A rough boundary between two clear media: single scattering by its facets, and lobes that restore the missing
/// energy, tabulated over the cosine and the ratio of the indices.
///
/// Walter et al. 2007, *Microfacet Models for Refraction through Rough Surfaces*: a facet reflects and refracts by
/// Fresnel's equations. Masking of reflected light is height-correlated; refracted light is masked on each side
/// separately. Light that is shadowed beyond the surface meets the boundary again, from the other side. Of it, the
/// share of diffuse light that crosses both there and back, T T', continues as if unshadowed ([`Facets::passed`]),
/// since facets turn it there as little as here. So glass in a liquid of nearly its index is as invisible rough as
/// smooth. All other light that meets a second facet is restored after Kulla & Conty 2017, *Revisiting Physically Based
/// Shading at Imageworks*: see [`FacetSides`]. A row of the tables is computed when a ratio near it is first needed.
#[derive(Clone, Debug)]
pub struct RoughInterface {
    facets: Facets,
    rows: Box<[OnceLock<AlbedoTable>]>,
    /// What films add to the tables.
    kernels: Box<[OnceLock<FilmKernel>]>,
}

/// Number of steps between rows for ratios above 1, and as many below.
const RATIO_STEPS: usize = 160;
/// The smallest and the largest |ln(n2 / n1)| of the rows; the largest is that of the highest possible index and
/// vacuum. From row to row it grows by a sixteenth, since nearly equal indices reflect grazing light below a cosine of
/// about its square root.
const LOG_RATIO_RANGE: [f64; 2] = [1e-4, LN_10];
/// Steps of a row over the cosine.
const COSINE_STEPS: usize = 192;
/// Steps of a row of a film's kernel over the cosine.
const KERNEL_STEPS: usize = 64;

impl RoughInterface {
    /// Makes a boundary whose facets have slopes of width `alpha`.
    pub fn new(alpha: f64) -> Self {
        let rows = (0..2 * (RATIO_STEPS + 1)).map(|_| OnceLock::new()).collect();
        let kernels = (0..2 * (RATIO_STEPS + 1)).map(|_| OnceLock::new()).collect();
        Self { facets: Facets::new(alpha), rows, kernels }
    }

    /// The facets themselves.
    pub fn facets(&self) -> &Facets {
        &self.facets
    }

    /// Returns the boundary for light that arrives in index `n1` and finds a different index `n2` beyond.
    pub fn between(&self, n1: f64, n2: f64) -> FacetSides<'_> {
        let (denser, place) = place(n1, n2);
        let [near, far] = [denser, !denser].map(|denser| self.side(denser, place));
        // Diffuse light in equilibrium arrives in proportion to n^2 from each side, and equally much crosses both ways.
        let enters = diffuse_transmittance(n2 / n1);
        let leaves = enters * (n1 / n2) * (n1 / n2);
        let largest = near.mean_missing_energy().max(far.mean_missing_energy());
        let crossing = [enters * far.mean_missing_energy() / largest, leaves * near.mean_missing_energy() / largest];
        FacetSides { facets: &self.facets, indices: [n1, n2], near, far, crossing, straight: enters * leaves }
    }

    /// Returns what films add to the missing energy, on the viewer's side and beyond, for the ratio nearest to that of
    /// the indices.
    pub(super) fn film_kernels(&self, n1: f64, n2: f64) -> [&FilmKernel; 2] {
        let (denser, place) = place(n1, n2);
        [denser, !denser].map(|denser| {
            let row = place.round() as usize;
            self.kernels[row + if denser { RATIO_STEPS + 1 } else { 0 }]
                .get_or_init(|| kernel(&self.facets, ratio(denser, row)))
        })
    }

    /// Returns the tables at a place in 0..RATIOS, for light that meets the denser medium or the rarer one.
    fn side(&self, denser: bool, place: f64) -> Side<'_> {
        let below = (place as usize).min(RATIO_STEPS - 1);
        let rows = [below, below + 1].map(|row| self.row(denser, row));
        Side { rows, fraction: place - below as f64 }
    }

    fn row(&self, denser: bool, row: usize) -> &AlbedoTable {
        self.rows[row + if denser { RATIO_STEPS + 1 } else { 0 }]
            .get_or_init(|| missing_energy(&self.facets, ratio(denser, row)))
    }
}

/// Returns whether the medium beyond is denser, and the place of the indices among the rows.
fn place(n1: f64, n2: f64) -> (bool, f64) {
    let ratio = libm::log(n2 / n1);
    let [smallest, largest] = LOG_RATIO_RANGE;
    let place =
        libm::log(ratio.abs().clamp(smallest, largest) / smallest) / libm::log(largest / smallest) * RATIO_STEPS as f64;
    (ratio > 0.0, place)
}

/// Returns the ratio of the indices of a row.
fn ratio(denser: bool, row: usize) -> f64 {
    let [smallest, largest] = LOG_RATIO_RANGE;
    let size = smallest * libm::pow(largest / smallest, row as f64 / RATIO_STEPS as f64);
    libm::exp(if denser { size } else { -size })
}

/// Tabulates the energy that is missing if facets reflect all light, and if they transmit all light.
fn kernel(facets: &Facets, ratio: f64) -> FilmKernel {
    let (straight, visible) = (straight(ratio), facets.visible(ratio));
    FilmKernel::new(facets.alpha(), ratio, KERNEL_STEPS, |z, add| {
        for (directions, weight) in visible.from(z) {
            let facet = Facet::new(facets, [1.0, ratio], straight, directions, None);
            add(facet.cos[0], weight, facet.unshadowed.map(|left| 1.0 - left));
        }
    })
}

/// Tabulates the share of the light from each cosine that meets a second facet, the mean over the visible facets. The
/// index beyond is `ratio` times that on this side.
fn missing_energy(facets: &Facets, ratio: f64) -> AlbedoTable {
    let (straight, visible) = (straight(ratio), facets.visible(ratio));
    AlbedoTable::new(facets.alpha(), COSINE_STEPS, |z| {
        visible.mean(z, SecondFacetShare { facets: *facets, ratio, straight })
    })
}

/// The share of light that meets a second facet.
struct SecondFacetShare {
    facets: Facets,
    ratio: f64,
    straight: f64,
}

impl FacetFunction for SecondFacetShare {
    #[inline(always)]
    fn value_at(&self, wo: DVec3, h: DVec3) -> f64 {
        Facet::new(&self.facets, [1.0, self.ratio], self.straight, [wo, h], None).multiple
    }
}

/// Returns the share of diffuse light that crosses a boundary both there and back, which is equal from either side.
fn straight(ratio: f64) -> f64 {
    let enters = diffuse_transmittance(ratio);
    enters * enters / (ratio * ratio)
}

/// A rough boundary seen from one side, interpolated between two rows of the tables.
#[derive(Clone, Copy, Debug)]
pub struct Side<'a> {
    rows: [&'a AlbedoTable; 2],
    fraction: f64,
}

impl Side<'_> {
    fn interpolate(&self, read: impl Fn(&AlbedoTable) -> f64) -> f64 {
        let [a, b] = self.rows.map(read);
        a + self.fraction * (b - a)
    }

    /// Returns the share of light from the cosine `z` that meets a second facet.
    pub fn missing_energy(&self, z: f64) -> f64 {
        let place = self.rows[0].place(z);
        self.interpolate(|row| row.at(place))
    }

    /// Returns the share of diffuse light that meets a second facet.
    pub fn mean_missing_energy(&self) -> f64 {
        self.interpolate(|row| row.mean)
    }

    /// Returns the missing energy at the cosine `z`, and the density per steradian with which [`Side::draw`] draws
    /// directions there.
    fn missing_energy_and_density(&self, z: f64) -> [f64; 2] {
        let place = self.rows[0].place(z);
        let [[a, a_density], [b, b_density]] = self.rows.map(|row| row.value_and_density(place, z));
        [a + self.fraction * (b - a), a_density + self.second_row_chance() * (b_density - a_density)]
    }

    /// Returns the probability of drawing from the second row.
    fn second_row_chance(&self) -> f64 {
        self.fraction * self.rows[1].mean / self.mean_missing_energy()
    }

    /// Samples a direction above the surface, nearly in proportion to the missing energy times the cosine.
    pub fn draw(&self, u: [f64; 2]) -> DVec3 {
        let second_row_chance = self.second_row_chance();
        let (row, left) = if u[0] < second_row_chance {
            (1, u[0] / second_row_chance)
        } else {
            (0, (u[0] - second_row_chance) / (1.0 - second_row_chance))
        };
        self.rows[row].draw([left, u[1]])
    }
}

/// A rough boundary between index n1, where the viewer is, and n2 beyond.
///
/// The energy of light that meets a second facet, M(z), is restored on the sides a and b by lobes M_a M_b k_ab / pi
/// with k_11 m_1 + k_12 m_2 = 1, where m is the mean of M: no energy is lost or gained. The lobes are reciprocal, as
/// k_ab / n_b^2 is symmetric. As far as that allows, the share of the missing energy that crosses is that of diffuse
/// light at smooth glass: k_12 m_2 = T_12 m_2 / max(m_1, m_2).
#[derive(Clone, Copy, Debug)]
pub struct FacetSides<'a> {
    facets: &'a Facets,
    indices: [f64; 2],
    /// The tables for light that arrives on the viewer's side.
    pub near: Side<'a>,
    /// The tables for light that arrives from beyond.
    pub far: Side<'a>,
    /// Share of the energy missing on each side that crosses in the end.
    pub crossing: [f64; 2],
    /// Share of the light shadowed beyond the surface that continues as if unshadowed.
    pub straight: f64,
}

/// A direction sampled for the viewer, and the facet that sent light from there, if it was a single one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacetSample {
    /// Unit vector toward where the light came from.
    pub wi: DVec3,
    /// The facet.
    pub facet: Option<Facet>,
}

impl FacetSides<'_> {
    /// Samples a direction above the surface and one beyond it for the viewer's direction `wo`; None where no light
    /// comes from.
    ///
    /// A visible facet is sampled. With the probability that its light meets a second facet, both directions are drawn
    /// from the lobes, otherwise they are its own. Sampling thus follows the light: the value over the density is at
    /// most 1 on each side and nearly 1 for both. Along a path its product stays so, however many surfaces the path
    /// meets.
    pub fn draw(&self, wo: DVec3, u: [f64; 2]) -> [Option<FacetSample>; 2] {
        let facet = self.facet([wo, self.facets.visible_normal(wo, u)], None);
        let [chance, around] = later_digits(u);
        if chance < facet.multiple {
            let u = [around, chance / facet.multiple];
            let [above, beyond] = [self.near.draw(u), self.far.draw(u)];
            return [above, DVec3 { z: -beyond.z, ..beyond }]
                .map(|wi| (wi.z != 0.0).then_some(FacetSample { wi, facet: None }));
        }
        [0, 1].map(|i| (facet.single[i] > 0.0).then(|| FacetSample { wi: facet.directions[i], facet: Some(facet) }))
    }

    fn facet(&self, directions: [DVec3; 2], known_wi: Option<DVec3>) -> Facet {
        Facet::new(self.facets, self.indices, self.straight, directions, known_wi)
    }

    /// Returns what is reflected from `wi`, above the surface, to `wo`. The facet is computed if it is not given.
    pub fn reflected(&self, wo: DVec3, wi: DVec3, facet: Option<Facet>) -> BsdfValue {
        let multiple = self.near.missing_energy(wo.z);
        let [missing, lobe] = self.near.missing_energy_and_density(wi.z);
        let lobes = (1.0 - self.crossing[0]) * multiple * missing / self.near.mean_missing_energy() * wi.z / PI;
        let facet = facet.or_else(|| Some(self.facet([wo, (wo + wi).try_normalize()?], Some(wi))));
        let single = facet.map_or(BsdfValue::default(), |facet| facet.bsdf(0, self.facets.pdf(wo, facet.h)));
        single + BsdfValue { value: lobes, pdf: multiple * lobe, ..BsdfValue::default() }
    }

    /// Returns what crosses from `wi`, beyond the surface, to `wo`, as radiance, which changes by (n1 / n2)^2. The
    /// facet is computed if it is not given.
    pub fn crossed(&self, wo: DVec3, wi: DVec3, facet: Option<Facet>) -> BsdfValue {
        let multiple = self.near.missing_energy(wo.z);
        let [missing, lobe] = self.far.missing_energy_and_density(-wi.z);
        let [n1, n2] = self.indices;
        let square = (n1 / n2) * (n1 / n2);
        let lobes = self.crossing[0] * multiple * missing / self.far.mean_missing_energy() * -wi.z / PI;
        let facet = facet.or_else(|| {
            let h = ((wo * n1 + wi * n2) * (n1 - n2).signum()).try_normalize()?;
            let is_visible = h.z > 0.0 && wo.dot(h) > 0.0 && wi.dot(h) < 0.0;
            is_visible.then(|| self.facet([wo, h], Some(wi)))
        });
        let single = facet.filter(|facet| facet.cos[1] > 0.0).map_or(BsdfValue::default(), |facet| {
            let bsdf = facet.bsdf(1, self.facets.refraction_pdf(wo, facet.h, self.indices, facet.cos));
            BsdfValue { value: bsdf.value * square, facet: bsdf.facet * square, ..bsdf }
        });
        single + BsdfValue { value: lobes * square, pdf: multiple * lobe, ..BsdfValue::default() }
    }
}

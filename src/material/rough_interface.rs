use std::f64::consts::{LN_10, PI};
use std::sync::OnceLock;

use super::by_cosine::ByCosine;
use super::{Facets, Interface, reflect};
use crate::math::DVec3;

/// A rough boundary between two clear media: what its facets reflect and refract once, and lobes that give back what they
/// block, as tables by the cosine and by the ratio of the indices.
///
/// Walter et al. 2007, *Microfacet Models for Refraction through Rough Surfaces*: a facet reflects and refracts by Fresnel's
/// equations; reflected light is masked as correlated by height, refracted light on each side by itself. Light that meets
/// a second facet is given back after Kulla & Conty 2017, *Revisiting Physically Based Shading at Imageworks*: see
/// [`Sides`]. One row of the tables is computed when a ratio near it is first asked for.
#[derive(Clone, Debug)]
pub struct RoughInterface {
    facets: Facets,
    rows: Box<[OnceLock<Row>]>,
}

/// What becomes of light that meets a boundary from one side, for one ratio of indices.
#[derive(Clone, Debug)]
struct Row {
    ratio: f64,
    /// Computed when first asked for: only a surface under this one needs it.
    reflected: OnceLock<ByCosine>,
    blocked: ByCosine,
    /// The mean Fresnel transmittance of light from all around.
    transmittance: f64,
}

impl Row {
    /// The share of light that is reflected once. Fresnel's reflectance changes with the cosine itself, however smooth the
    /// surface.
    fn reflected(&self, facets: &Facets) -> &ByCosine {
        self.reflected.get_or_init(|| ByCosine::new(1.0, |z| quadrature(facets, z, self.ratio)[0]))
    }
}

/// Steps between rows for ratios above 1, and as many below.
const RATIOS: usize = 80;
/// The smallest |ln(n2 / n1)| of the rows and the largest, of the largest index there is to vacuum. Between them it grows by
/// an eighth from row to row: light that grazes nearly equal indices is reflected below a cosine of about its root.
const SPAN: [f64; 2] = [1e-4, LN_10];
/// Steps of the quadrature over the visible facets: around the normal's half turn, and up.
const AROUND: usize = 32;
const UP: usize = 64;

impl RoughInterface {
    /// The boundary whose facets have slopes as wide as `alpha`.
    pub fn new(alpha: f64) -> Self {
        Self { facets: Facets::new(alpha), rows: (0..2 * (RATIOS + 1)).map(|_| OnceLock::new()).collect() }
    }

    /// The facets themselves.
    pub fn facets(&self) -> &Facets {
        &self.facets
    }

    /// The boundary as light meets it that comes from index `n1` and finds a different index `n2` beyond.
    pub fn between(&self, n1: f64, n2: f64) -> Sides<'_> {
        let ratio = libm::log(n2 / n1);
        let denser = ratio > 0.0;
        let [least, most] = SPAN;
        let place = libm::log(ratio.abs().clamp(least, most) / least) / libm::log(most / least) * RATIOS as f64;
        let [near, far] = [denser, !denser].map(|denser| self.side(denser, place));
        // Light meets a boundary evenly as often from both sides if n^2 of it comes: what crosses is the same both ways.
        let square = (n1 / n2) * (n1 / n2);
        let enters = if denser { near.transmittance() } else { far.transmittance() / square };
        let leaves = enters * square;
        let most = near.mean_blocked().max(far.mean_blocked());
        let crossing = [enters * far.mean_blocked() / most, leaves * near.mean_blocked() / most];
        Sides { facets: &self.facets, indices: [n1, n2], near, far, crossing }
    }

    /// The tables at a place in 0..RATIOS, of light that meets the denser medium or the rarer.
    fn side(&self, denser: bool, place: f64) -> Side<'_> {
        let below = (place as usize).min(RATIOS - 1);
        let rows = [below, below + 1].map(|row| self.row(denser, row));
        Side { facets: &self.facets, rows, part: place - below as f64 }
    }

    fn row(&self, denser: bool, row: usize) -> &Row {
        self.rows[row + if denser { RATIOS + 1 } else { 0 }].get_or_init(|| {
            let [least, most] = SPAN;
            let size = least * libm::pow(most / least, row as f64 / RATIOS as f64);
            let ratio = libm::exp(if denser { size } else { -size });
            let blocked = ByCosine::new(self.facets.alpha(), |z| quadrature(&self.facets, z, ratio)[1]);
            Row { ratio, reflected: OnceLock::new(), blocked, transmittance: mean_transmittance(ratio) }
        })
    }
}

/// The shares of the light from the cosine `z` that is reflected once, and that meets a second facet: the means over the
/// visible facets, where the index beyond is `ratio` times that on this side.
fn quadrature(facets: &Facets, z: f64, ratio: f64) -> [f64; 2] {
    let wo = DVec3::new((1.0 - z * z).max(0.0).sqrt(), 0.0, z);
    let mut sum = [0.0; 2];
    for up in 0..UP {
        // left = v^2: dense among upright facets, which are few and block most.
        let v = (up as f64 + 0.5) / UP as f64;
        for around in 0..AROUND {
            let turn = 0.5 * (around as f64 + 0.5) / AROUND as f64;
            let h = facets.visible_normal_from_end(wo, turn, v * v);
            let interface = Interface::new(1.0, ratio, wo.dot(h));
            let again = facets.blocked(wo, reflect(wo, h));
            let lost = match interface.transmittance {
                0.0 => 0.0,
                t => t * blocked_beyond(facets, interface.refract(wo, h)),
            };
            sum[0] += 2.0 * v * interface.reflectance * (1.0 - again);
            sum[1] += 2.0 * v * (interface.reflectance * again + lost);
        }
    }
    sum.map(|sum| sum / (UP * AROUND) as f64)
}

/// The share of refracted light that meets another facet, by the far side's masking.
fn blocked_beyond(facets: &Facets, wi: DVec3) -> f64 {
    if wi.z < 0.0 { facets.masking(wi)[1] } else { 1.0 }
}

/// Twice the integral of Fresnel's transmittance times cosine over the cosine.
fn mean_transmittance(ratio: f64) -> f64 {
    const STEPS: u32 = 4096;
    let at = |i| (f64::from(i) + 0.5) / f64::from(STEPS);
    (0..STEPS).map(|i| 2.0 * at(i) * Interface::new(1.0, ratio, at(i)).transmittance).sum::<f64>() / f64::from(STEPS)
}

/// A rough boundary as it is met from one side, between two rows of the tables.
#[derive(Clone, Copy, Debug)]
pub struct Side<'a> {
    facets: &'a Facets,
    rows: [&'a Row; 2],
    part: f64,
}

impl Side<'_> {
    fn mix(&self, read: impl Fn(&Row) -> f64) -> f64 {
        let [a, b] = self.rows.map(read);
        a + self.part * (b - a)
    }

    /// The share of light from the cosine `z` that is reflected once, and no facet blocks.
    pub fn reflected_once(&self, z: f64) -> f64 {
        self.mix(|row| row.reflected(self.facets).value(z))
    }

    /// The share of light from the cosine `z` that meets a second facet.
    pub fn blocked(&self, z: f64) -> f64 {
        self.mix(|row| row.blocked.value(z))
    }

    /// The share of light from all around that meets a second facet.
    pub fn mean_blocked(&self) -> f64 {
        self.mix(|row| row.blocked.mean())
    }

    fn transmittance(&self) -> f64 {
        self.mix(|row| row.transmittance)
    }

    /// What is blocked at the cosine `z`, and the density per steradian with which [`Side::draw`] draws directions there.
    pub fn blocked_and_density(&self, z: f64) -> [f64; 2] {
        let [a, b] = self.rows.map(|row| row.blocked.value_and_density(z));
        let often = self.often();
        [a.0 + self.part * (b.0 - a.0), a.1 + often * (b.1 - a.1)]
    }

    /// How often the second row is drawn from.
    fn often(&self) -> f64 {
        self.part * self.rows[1].blocked.mean() / self.mean_blocked()
    }

    /// A direction above the surface, drawn by nearly what is blocked times the cosine.
    pub fn draw(&self, u: [f64; 2]) -> DVec3 {
        let often = self.often();
        let (row, left) = if u[0] < often { (1, u[0] / often) } else { (0, (u[0] - often) / (1.0 - often)) };
        self.rows[row].blocked.draw([left, u[1]])
    }
}

/// A rough boundary between index n1, where the viewer is, and n2 beyond.
///
/// What light loses that meets a second facet, M(z), is given back on the sides a and b by lobes M_a M_b k_ab / pi with
/// k_11 m_1 + k_12 m_2 = 1, where m is the mean of M: no light is lost or won. They are reciprocal, as k_ab / n_b^2 is the
/// same both ways; and as far as that allows, as much crosses of what is blocked as of light from all around smooth glass:
/// k_12 m_2 = T_12 m_2 / max(m_1, m_2).
#[derive(Clone, Copy, Debug)]
pub struct Sides<'a> {
    facets: &'a Facets,
    indices: [f64; 2],
    /// As met from the viewer's side.
    pub near: Side<'a>,
    /// As met from beyond.
    pub far: Side<'a>,
    /// The share of what is blocked on each side that crosses in the end.
    pub crossing: [f64; 2],
}

/// The BSDF times cosine between two directions, and the density with which one is drawn for the other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flow {
    /// BSDF times cosine.
    pub value: f64,
    /// Density per steradian.
    pub pdf: f64,
}

/// Directions drawn for one viewer; each with the facet that sent it there, if one did.
pub type Ways = [Option<(DVec3, Option<DVec3>)>; 2];

impl Sides<'_> {
    /// The share of light from the viewer's side at the cosine `z` that comes back there: all else crosses.
    ///
    /// Inside the denser medium tables round the edge of total reflection, where the surface is nearly smooth.
    pub fn reflectance(&self, z: f64) -> f64 {
        self.near.reflected_once(z) + (1.0 - self.crossing[0]) * self.near.blocked(z)
    }

    /// The same of light from all around.
    pub fn mean_reflectance(&self) -> f64 {
        self.near.mix(|row| row.reflected(self.facets).mean()) + (1.0 - self.crossing[0]) * self.near.mean_blocked()
    }

    /// A direction above the surface and one beyond it for the viewer's direction `wo`: from the lobes as often as light
    /// is blocked, else by a visible facet; none where it leads to the wrong side.
    pub fn draw(&self, wo: DVec3, u: [f64; 2]) -> Ways {
        let again = self.near.blocked(wo.z);
        if u[0] < again {
            let u = [u[0] / again, u[1]];
            let [above, beyond] = [self.near.draw(u), self.far.draw(u)];
            return [above, DVec3 { z: -beyond.z, ..beyond }].map(|wi| (wi.z != 0.0).then_some((wi, None)));
        }
        let h = self.facets.visible_normal(wo, [(u[0] - again) / (1.0 - again), u[1]]);
        let [n1, n2] = self.indices;
        let interface = Interface::new(n1, n2, wo.dot(h));
        let beyond = (interface.transmittance > 0.0).then(|| interface.refract(wo, h));
        [Some(reflect(wo, h)).filter(|wi| wi.z > 0.0), beyond.filter(|wi| wi.z < 0.0)]
            .map(|wi| wi.map(|wi| (wi, Some(h))))
    }

    /// What is reflected from `wi`, above the surface, to `wo`.
    pub fn reflected(&self, wo: DVec3, wi: DVec3, h: DVec3) -> Flow {
        let again = self.near.blocked(wo.z);
        let [blocked, lobe] = self.near.blocked_and_density(wi.z);
        let [n1, n2] = self.indices;
        let once = Interface::new(n1, n2, wo.dot(h)).reflectance * self.facets.reflection(wo, wi, h);
        let lobes = (1.0 - self.crossing[0]) * again * blocked / self.near.mean_blocked() * wi.z / PI;
        Flow { value: once + lobes, pdf: (1.0 - again) * self.facets.pdf(wo, h) + again * lobe }
    }

    /// What crosses from `wi`, beyond the surface, to `wo`: radiance, which changes by (n1 / n2)^2. The facet's normal is
    /// found where it is not given.
    pub fn crossed(&self, wo: DVec3, wi: DVec3, h: Option<DVec3>) -> Flow {
        let again = self.near.blocked(wo.z);
        let [blocked, lobe] = self.far.blocked_and_density(-wi.z);
        let [n1, n2] = self.indices;
        let lobes = self.crossing[0] * again * blocked / self.far.mean_blocked() * -wi.z / PI;
        let h = h.or_else(|| ((wo * n1 + wi * n2) * (n1 - n2).signum()).try_normalize());
        let met = h.filter(|h| h.z > 0.0 && wo.dot(*h) > 0.0 && wi.dot(*h) < 0.0);
        let (mut once, mut pdf) = (0.0, 0.0);
        if let Some(h) = met {
            let cos = wo.dot(h);
            let interface = Interface::new(n1, n2, cos);
            if interface.transmittance > 0.0 {
                pdf = self.facets.refraction_pdf(wo, h, self.indices, [cos, interface.cos_beyond]);
                once = interface.transmittance * self.facets.masking(wi)[0] * pdf;
            }
        }
        let square = (n1 / n2) * (n1 / n2);
        Flow { value: (once + lobes) * square, pdf: (1.0 - again) * pdf + again * lobe }
    }
}

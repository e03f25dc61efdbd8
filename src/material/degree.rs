//! To what degree light leaves a surface polarized.

use super::{Arrival, Interface, Material, Part, conductor_reflectance};
use crate::math::DVec3;
use crate::spectrum::Table;

/// Lanes of a metal that are asked: its indices vary smoothly from lane to lane.
const LANES: usize = 8;

impl Material<Table> {
    /// The largest degree |s - p| / (s + p) to which unpolarized light from the unit vector `wi` leaves polarized, where the
    /// material scatters it by a density of directions: by the facet that mirrors or refracts it, or the coat that it crosses.
    pub fn degree_of_scattered<const N: usize>(&self, arrival: &Arrival<N>, wi: DVec3) -> f32 {
        match self {
            Self::Conductor(metal) => {
                let Some(h) = (arrival.wo + wi).try_normalize() else { return 0.0 };
                let (n, k) = (arrival.draw.read_exact(&metal.n), arrival.draw.read_exact(&metal.k));
                let degree = |lane: usize| {
                    degree(conductor_reflectance(arrival.incident[lane], n[lane], k[lane], arrival.wo.dot(h)))
                };
                largest((0..N).step_by(N.div_ceil(LANES)).map(degree))
            }
            Self::Dielectric(_) => self.degree_of_facet(arrival, wi),
            Self::Plastic(plastic) => {
                let index = arrival.draw.read_exact(&plastic.index);
                let lanes = || (0..N).filter(|&lane| index[lane] != arrival.incident[lane]);
                let coat = |lane: usize, cos: f64| Interface::new(arrival.incident[lane], index[lane], cos);
                let crossed = |lane: usize| {
                    let cosines = [arrival.wo, wi].map(|direction| direction.dot(arrival.normal).abs());
                    cosines.map(|cos| coat(lane, cos).polarization_refracted.abs()).into_iter().fold(0.0, f64::max)
                };
                let base = largest(lanes().step_by(N.div_ceil(LANES)).map(crossed));
                match (plastic.coat.roughness().is_smooth(), (arrival.wo + wi).try_normalize()) {
                    (false, Some(h)) => {
                        let mirrored = |lane: usize| coat(lane, arrival.wo.dot(h)).polarization_reflected.abs();
                        base.max(largest(lanes().step_by(N.div_ceil(LANES)).map(mirrored)))
                    }
                    _ => base,
                }
            }
            _ => {
                let parts = self.parts().iter().map(Part::material).filter(|part| part.scatters_widely());
                parts.map(|part| part.degree_of_scattered(arrival, wi)).fold(0.0, f32::max)
            }
        }
    }

    /// The same of rough glass: Walter et al. 2007, *Microfacet Models for Refraction through Rough Surfaces*, equations 13 and 16.
    fn degree_of_facet<const N: usize>(&self, arrival: &Arrival<N>, wi: DVec3) -> f32 {
        let (mut last, mut most) = (None, 0.0_f64);
        for lane in 0..N {
            let pair @ [n1, n2] = [arrival.incident[lane], arrival.beyond[lane]];
            if n1 == n2 || last.replace(pair) == Some(pair) {
                continue;
            }
            let crosses = wi.dot(arrival.normal) < 0.0;
            let h = if crosses { (arrival.wo * n1 + wi * n2) * (n1 - n2).signum() } else { arrival.wo + wi };
            let Some(h) = h.try_normalize() else { continue };
            let facet = Interface::new(n1, n2, arrival.wo.dot(h));
            let degree = if crosses { facet.polarization_refracted } else { facet.polarization_reflected };
            most = most.max(degree.abs());
        }
        most as f32
    }
}

/// |s - p| / (s + p) of what is left of both polarizations.
pub(super) fn degree([s, p]: [f64; 2]) -> f64 {
    if s + p > 0.0 { (s - p).abs() / (s + p) } else { 0.0 }
}

fn largest(degrees: impl Iterator<Item = f64>) -> f32 {
    degrees.fold(0.0, f64::max) as f32
}

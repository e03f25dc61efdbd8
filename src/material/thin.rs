use serde::Deserialize;

use super::degree::degree;
use super::dielectric::flat;
use super::{Arrival, Branch, Interface, reflect};
use crate::spectrum::{Lanes, Quantity, Table};

/// A pane of clear material without thickness: a window of which nothing but its two surfaces is seen. Light goes straight
/// on or is mirrored; all reflections between the two surfaces are summed.
///
/// ```toml
/// thin = { index = 1.52 }     # transmittance = 1: what is left after one way through the pane, straight on
/// ```
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[serde(bound(deserialize = "S: Deserialize<'de> + From<f64>"))]
pub struct Thin<S> {
    /// Refractive index.
    pub index: S,
    /// Share of the light that is left after one way through the pane, at every angle.
    #[serde(default = "flat::<S, 1>")]
    pub transmittance: S,
}

impl<S> Thin<S> {
    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Thin<T> {
        Thin {
            index: convert(Quantity::Index, &self.index),
            transmittance: convert(Quantity::Transmittance, &self.transmittance),
        }
    }
}

impl Thin<Table> {
    /// With R of one surface and t of one way: T = (1 - R)^2 t / (1 - R^2 t^2), and R + R t T comes back (Born & Wolf 1999,
    /// section 7.6, without interference).
    pub(super) fn scatter<const N: usize>(&self, arrival: &Arrival<N>, branches: &mut Vec<Branch<N>>) {
        let (index, way) = (arrival.draw.read_exact(&self.index), arrival.read(&self.transmittance));
        let cos = arrival.wo.dot(arrival.normal);
        let (mut crossed, mut reflected) = (Lanes::ZERO, Lanes::ZERO);
        let (mut through, mut back) = (0.0_f64, 0.0_f64);
        for lane in (0..N).filter(|&lane| arrival.present[lane] != 0.0) {
            if index[lane] == arrival.incident[lane] {
                crossed.0[lane] = way[lane];
                continue;
            }
            let surface = Interface::new(arrival.incident[lane], index[lane], cos);
            let (r, t) = (surface.reflectance, f64::from(way[lane]));
            let transmitted = surface.transmittance * surface.transmittance * t / (1.0 - r * r * t * t);
            // Where no light enters at all, 1 - R^2 may be 0 as well.
            let transmitted = if surface.transmittance == 0.0 { 0.0 } else { transmitted };
            crossed.0[lane] = transmitted as f32;
            reflected.0[lane] = (r + r * t * transmitted) as f32;
            let [s, p] = [1.0, -1.0].map(|sign| series(r * (1.0 + sign * surface.polarization_reflected), t));
            (through, back) = (through.max(degree([s[0], p[0]])), back.max(degree([s[1], p[1]])));
        }
        let branch = |wi, share, crosses, polarization: f64| Branch {
            wi,
            share,
            pdf: None,
            crosses,
            eta_scale: 1.0,
            polarization: polarization as f32,
        };
        if !crossed.is_zero() {
            branches.push(branch(-arrival.wo, crossed, true, through));
        }
        if !reflected.is_zero() {
            branches.push(branch(reflect(arrival.wo, arrival.normal), reflected, false, back));
        }
    }
}

/// Transmittance and reflectance of a pane for one polarization, of which a surface reflects `r`.
fn series(r: f64, t: f64) -> [f64; 2] {
    let transmitted = if r < 1.0 { (1.0 - r) * (1.0 - r) * t / (1.0 - r * r * t * t) } else { 0.0 };
    [transmitted, r + r * t * transmitted]
}

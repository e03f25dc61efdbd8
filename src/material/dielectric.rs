use serde::Deserialize;

use super::{Arrival, Branch, Interface, reflect};
use crate::math::DVec3;
use crate::spectrum::{Draw, Lanes, Quantity, Table};

/// A smooth clear body: light is reflected and refracted by Snell's law and Fresnel's equations.
///
/// It fills the space behind its surface's front. The classic tracer's {r, t, g, n} are its reflectance, transmittance,
/// emission and index. Its emission shines from both sides of the surface by being met, never by being aimed at: a lamp
/// is `emissive`.
///
/// ```toml
/// dielectric = { index = "N-SF11" }
/// dielectric = { index = { rgb = [1.513, 1.517, 1.523] }, transmittance = { rgb = [0.9, 1, 0.9] }, absorption = 0.2 }
/// ```
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[serde(bound(deserialize = "S: Deserialize<'de> + From<f64>"))]
pub struct Dielectric<S> {
    /// Refractive index.
    pub index: S,
    /// Factor on the reflected light.
    #[serde(default = "flat::<S, 1>")]
    pub reflectance: S,
    /// Factor on the refracted light.
    #[serde(default = "flat::<S, 1>")]
    pub transmittance: S,
    /// Radiance of the surface itself.
    #[serde(default = "flat::<S, 0>")]
    pub emission: S,
    /// Absorption coefficient inside, per scene unit, base e (Beer 1852).
    #[serde(default = "flat::<S, 0>")]
    pub absorption: S,
    /// Where bodies overlap, the one of higher priority is there; of equal ones, the one whose material is used later in
    /// the file. Bodies of one material merge.
    #[serde(default)]
    pub priority: i32,
}

/// The default of an optional spectrum.
pub(super) fn flat<S: From<f64>, const VALUE: i32>() -> S {
    f64::from(VALUE).into()
}

impl<S> Dielectric<S> {
    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Dielectric<T> {
        Dielectric {
            index: convert(Quantity::Index, &self.index),
            reflectance: convert(Quantity::Reflectance, &self.reflectance),
            transmittance: convert(Quantity::Transmittance, &self.transmittance),
            emission: convert(Quantity::Emission, &self.emission),
            absorption: convert(Quantity::Absorption, &self.absorption),
            priority: self.priority,
        }
    }
}

impl Dielectric<Table> {
    /// One reflected branch with all lanes, and one refracted branch per distinct pair of indices: here lanes part, and
    /// only those go on that are there for it.
    pub(super) fn scatter<const N: usize>(&self, arrival: &Arrival<N>, branches: &mut Vec<Branch<N>>) {
        let pairs: [(f64, f64); N] = std::array::from_fn(|i| (arrival.incident[i], arrival.beyond[i]));
        let cos = arrival.wo.dot(arrival.normal);
        let (tint, reflectance) = (arrival.read(&self.transmittance), arrival.read(&self.reflectance));
        let parts = arrival.parts();
        let tint = if parts { tint * arrival.draw.parting() } else { tint };
        let (mut reflected, mut polarization) = (Lanes::ZERO, 0.0);
        let mut crossed: Option<Branch<N>> = None;
        for ((n1, n2), lanes) in arrival.present.groups_by(pairs) {
            let crosses = lanes * tint;
            let branch = if n1 == n2 {
                // Nothing happens at all: the direction keeps its bits.
                crossing(-arrival.wo, crosses, 1.0, 0.0)
            } else {
                let interface = Interface::new(n1, n2, cos);
                reflected += lanes * reflectance * interface.reflectance as f32;
                polarization = interface.polarization_reflected;
                if interface.transmittance == 0.0 || crosses.is_zero() {
                    continue;
                }
                let eta_scale = (n1 / n2) * (n1 / n2);
                let share = crosses * (interface.transmittance * eta_scale) as f32;
                crossing(
                    interface.refract(arrival.wo, arrival.normal),
                    share,
                    eta_scale,
                    interface.polarization_refracted,
                )
            };
            match &mut crossed {
                Some(first) if !parts => first.share += branch.share,
                _ => branches.extend(crossed.replace(branch)),
            }
        }
        branches.extend(crossed);
        if !reflected.is_zero() {
            let wi = reflect(arrival.wo, arrival.normal);
            let polarization = polarization as f32;
            branches.push(Branch { wi, share: reflected, pdf: None, crosses: false, eta_scale: 1.0, polarization });
        }
    }

    fn is_clear(&self) -> bool {
        self.absorption.is_flat() && self.absorption.bins()[0] == 0.0
    }

    /// The share of each lane that is left after a distance inside, e^(-absorption * distance).
    pub fn transmission<const N: usize>(&self, draw: &Draw<N>, distance: f64) -> Lanes<N> {
        if self.is_clear() {
            return Lanes::ONE;
        }
        let absorption = draw.read_exact(&self.absorption);
        Lanes::from_fn(|i| if absorption[i] == 0.0 { 1.0 } else { libm::exp(-absorption[i] * distance) as f32 })
    }
}

fn crossing<const N: usize>(wi: DVec3, share: Lanes<N>, eta_scale: f64, polarization: f64) -> Branch<N> {
    Branch { wi, share, pdf: None, crosses: true, eta_scale, polarization: polarization as f32 }
}

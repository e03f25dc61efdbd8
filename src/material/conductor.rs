use serde::{Deserialize, Deserializer};

use super::{Arrival, Branch, conductor_reflectance, reflect};
use crate::spectrum::{Curve, CurveKind, Lanes, Quantity, Table};

/// A smooth metal.
///
/// ```toml
/// conductor = { metal = "Au" }
/// conductor = { n = 0.2, k = 3.9 }
/// ```
#[derive(Clone, Debug)]
pub struct Conductor<S> {
    /// Real part of the refractive index.
    pub n: S,
    /// Extinction coefficient.
    pub k: S,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ConductorText {
    metal: Option<String>,
    n: Option<Curve>,
    k: Option<Curve>,
}

impl<'de> Deserialize<'de> for Conductor<Curve> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match ConductorText::deserialize(deserializer)? {
            ConductorText { metal: Some(name), n: None, k: None } => {
                let named: Curve = CurveKind::Name(name).into();
                Ok(Self { n: named.clone(), k: named })
            }
            ConductorText { metal: None, n: Some(n), k: Some(k) } => Ok(Self { n, k }),
            _ => Err(serde::de::Error::custom("a conductor needs either `metal`, or both `n` and `k`")),
        }
    }
}

impl<S> Conductor<S> {
    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Conductor<T> {
        Conductor { n: convert(Quantity::MetalIndex, &self.n), k: convert(Quantity::MetalExtinction, &self.k) }
    }
}

impl Conductor<Table> {
    pub(super) fn scatter<const N: usize>(&self, arrival: &Arrival<N>) -> Branch<N> {
        let (n, k) = (arrival.draw.read_exact(&self.n), arrival.draw.read_exact(&self.k));
        let cos = arrival.wo.dot(arrival.normal);
        let reflected: [[f64; 2]; N] = std::array::from_fn(|i| match arrival.present[i] {
            0.0 => [0.0; 2],
            _ => conductor_reflectance(arrival.incident[i], n[i], k[i], cos),
        });
        let (s, p) = reflected.iter().fold((0.0, 0.0), |sum, r| (sum.0 + r[0], sum.1 + r[1]));
        Branch {
            wi: reflect(arrival.wo, arrival.normal),
            share: Lanes::from_fn(|i| (0.5 * (reflected[i][0] + reflected[i][1])) as f32),
            pdf: None,
            crosses: false,
            eta_scale: 1.0,
            polarization: if s + p > 0.0 { ((s - p) / (s + p)) as f32 } else { 0.0 },
        }
    }
}

use std::f64::consts::{FRAC_1_PI, PI};

use super::{Branch, Fluorescence, ScatterContext};
use crate::math::{DVec3, Frame, sample_cosine_hemisphere, unit};
use crate::spectrum::{Lanes, Quantity, Table};

/// A matte surface: equal radiance in every direction, on both sides (Lambert 1760).
///
/// ```toml
/// diffuse = { reflectance = { rgb = [0.7, 0.7, 0.7] } }
/// ```
#[derive(Clone, Debug)]
pub struct Diffuse<S> {
    /// Share of the arriving light that leaves again.
    pub reflectance: S,
    /// A dye, given by the key `fluorescence`.
    pub fluorescence: Option<Fluorescence<S>>,
}

impl<S> Diffuse<S> {
    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Diffuse<T> {
        let reflectance = convert(Quantity::Reflectance, &self.reflectance);
        Diffuse { reflectance, fluorescence: self.fluorescence.as_ref().map(|dye| dye.map(convert)) }
    }
}

impl Diffuse<Table> {
    pub(super) fn scatter<const N: usize>(&self, context: &ScatterContext<N>, u: [f64; 2]) -> Branch<N> {
        let local = sample_cosine_hemisphere(u);
        let wi = unit(Frame::about(context.normal).to_world(local));
        Branch::drawn(wi, context.read(&self.reflectance), local.z * FRAC_1_PI)
    }

    pub(super) fn evaluate<const N: usize>(&self, context: &ScatterContext<N>, wi: DVec3) -> Option<(Lanes<N>, f64)> {
        let pdf = wi.dot(context.normal) / PI;
        (pdf > 0.0).then(|| (context.read(&self.reflectance) * pdf as f32, pdf))
    }
}

//! One facet of a rough boundary.

use super::{Facets, Interface, reflect};
use crate::math::DVec3;

/// BSDF times cosine between two directions, and the density with which [`FacetSides::draw`](super::FacetSides::draw)
/// draws one for the other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BsdfValue {
    /// BSDF times cosine.
    pub value: f64,
    /// Density per steradian.
    pub pdf: f64,
    /// The part of `value` from single scattering, if facets reflected, or transmitted, all light.
    pub facet: f64,
    /// Cosine of the angle at which light meets the facets.
    pub cos: f64,
}

impl std::ops::Add for BsdfValue {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, pdf: self.pdf + other.pdf, ..self }
    }
}

/// What a visible facet does to light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet {
    pub(super) h: DVec3,
    /// The directions in which it reflects and refracts light.
    pub(super) directions: [DVec3; 2],
    /// Shares of the light that leave in these directions.
    pub(super) single: [f64; 2],
    /// Shares that would leave in these directions if it reflected, or transmitted, all light.
    pub(super) unshadowed: [f64; 2],
    /// Share that meets a second facet.
    pub(super) multiple: f64,
    /// Cosines of the angles to the facet's normal at which light meets it and continues beyond it.
    pub(super) cos: [f64; 2],
}

impl Facet {
    /// Makes the facet with normal `h` between two indices, seen from `wo`. `known_wi` is one of its two directions, if
    /// that is known already.
    #[inline(always)]
    pub(super) fn new(
        facets: &Facets,
        [n1, n2]: [f64; 2],
        straight: f64,
        [wo, h]: [DVec3; 2],
        known_wi: Option<DVec3>,
    ) -> Self {
        let interface = Interface::new(n1, n2, wo.dot(h));
        let (reflected, crossing) = (interface.reflectance, interface.transmittance);
        let above = known_wi.filter(|wi| wi.z > 0.0).unwrap_or_else(|| reflect(wo, h));
        let transmitted_wi = known_wi.filter(|wi| wi.z < 0.0).unwrap_or_else(|| interface.refract(wo, h));
        let [left, missing] = facets.unshadowed_and_shadowed(wo, above);
        let [passed, lost] = if crossing > 0.0 && transmitted_wi.z < 0.0 {
            facets.passed(wo, transmitted_wi, straight)
        } else {
            [0.0, 1.0]
        };
        Self {
            h,
            directions: [above, transmitted_wi],
            single: [reflected * left, crossing * passed],
            unshadowed: [left, passed],
            multiple: reflected * missing + crossing * lost,
            cos: [wo.dot(h), interface.cos_beyond],
        }
    }

    /// Returns its contribution in one of its two directions. `pdf` is the density of that direction over the visible
    /// facets.
    pub(super) fn bsdf(&self, side: usize, pdf: f64) -> BsdfValue {
        let (value, unshadowed) = (pdf * self.single[side], pdf * self.unshadowed[side]);
        BsdfValue { value, pdf: pdf * (self.single[0] + self.single[1]), facet: unshadowed, cos: self.cos[0] }
    }
}

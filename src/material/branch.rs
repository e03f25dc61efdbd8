//! Light that leaves a surface: in a scattered direction, or straight through.

use super::{ScatterContext, reflect};
use crate::math::{DVec3, Ray};
use crate::spectrum::{LaneSet, Lanes};

/// A direction from which light came to the surface, and the lanes that came from there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branch<const N: usize> {
    /// Unit vector toward where the light came from.
    pub wi: DVec3,
    /// Factor on each lane's throughput; 0 for lanes that did not come from this direction.
    pub share: Lanes<N>,
    /// Density per steradian with which `wi` was drawn; None for the single direction that a smooth surface allows.
    pub pdf: Option<f64>,
    /// Whether the light came from beyond the surface.
    pub crosses: bool,
    /// The part of `share` that only converts radiance between media, (n_incident / n_beyond)^2 of the ray's indices.
    pub eta_scale: f64,
    /// Largest degree |s - p| / (s + p) over all lanes to which unpolarized light from this single direction leaves
    /// polarized. 0 if it leaves unpolarized, and for directions drawn with a density: see
    /// [`Scatter::degree_of_scattered`](super::Scatter::degree_of_scattered).
    pub polarization: f32,
}

/// Where light comes from before it leaves a surface toward the viewer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Incoming {
    /// Unit vector toward where it comes from.
    pub wi: DVec3,
    /// Whether it comes from beyond the surface.
    pub crosses: bool,
    /// Whether this is the single direction that a smooth surface allows.
    pub single: bool,
    /// The lanes in which light arrives. Results for other lanes have no meaning.
    pub lanes: LaneSet,
}

impl<const N: usize> Branch<N> {
    /// Makes the branch in the mirror direction; `polarization` is the degree to which unpolarized light leaves
    /// polarized.
    pub(super) fn mirrored(context: &ScatterContext<N>, share: Lanes<N>, polarization: f32) -> Self {
        let wi = reflect(context.wo, context.normal);
        Self { wi, share, pdf: None, crosses: false, eta_scale: 1.0, polarization }
    }

    /// Makes a branch on the viewer's side that was drawn with the density `pdf`.
    pub fn drawn(wi: DVec3, share: Lanes<N>, pdf: f64) -> Self {
        Self { wi, share, pdf: Some(pdf), crosses: false, eta_scale: 1.0, polarization: 0.0 }
    }

    /// Returns where its light arrives from, for the lanes that are present on the ray.
    #[inline(always)]
    pub fn incoming(&self, present: &Lanes<N>) -> Incoming {
        let lanes = (self.share * *present).nonzero();
        Incoming { wi: self.wi, crosses: self.crosses, single: self.pdf.is_none(), lanes }
    }

    /// Makes the branch of a ray that passes straight through, with the light that it carries.
    pub fn through(ray: &Ray, straight: &Straight<N>) -> Self {
        let (share, polarization) = (straight.share(), straight.polarization);
        Self { wi: ray.direction, share, pdf: None, crosses: false, eta_scale: 1.0, polarization }
    }

    /// Returns the branch with its light multiplied by `share`.
    pub(super) fn scaled(&self, share: Lanes<N>) -> Self {
        Self { share: self.share * share, ..*self }
    }

    /// Returns whether both are the same single direction.
    pub(super) fn has_same_direction(&self, other: &Self) -> bool {
        let single = self.pdf.is_none() && other.pdf.is_none();
        single && self.wi == other.wi && self.crosses == other.crosses
    }

    /// Adds the light of another branch in the same direction.
    pub(super) fn join(&mut self, other: &Self) {
        self.polarization = self.polarization.max(other.polarization);
        self.share += other.share;
    }
}

/// What passes straight through a surface, as a share of each lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Straight<const N: usize> {
    /// Through holes, where nothing is hit.
    pub holes: Lanes<N>,
    /// Through panes.
    pub panes: Lanes<N>,
    /// Largest degree |s - p| / (s + p) to which unpolarized light leaves the panes polarized.
    pub polarization: f32,
}

impl<const N: usize> Straight<N> {
    /// Nothing.
    pub(super) const NONE: Self = Self { holes: Lanes::ZERO, panes: Lanes::ZERO, polarization: 0.0 };

    /// Returns all that passes straight through.
    pub fn share(&self) -> Lanes<N> {
        self.holes + self.panes
    }

    /// Returns what passes through holes, without what passes through panes.
    #[must_use]
    pub fn through_holes(self) -> Self {
        Self { panes: Lanes::ZERO, ..self }
    }

    /// Combines what two materials let pass, each of which covers a share of a surface.
    pub(super) fn combine(parts: [Option<Self>; 2], shares: [Lanes<N>; 2]) -> Option<Self> {
        if parts.iter().all(Option::is_none) {
            return None;
        }
        let [a, b] = parts.map(|part| part.unwrap_or(Self::NONE));
        Some(Self {
            holes: a.holes * shares[0] + b.holes * shares[1],
            panes: a.panes * shares[0] + b.panes * shares[1],
            polarization: a.polarization.max(b.polarization),
        })
    }
}

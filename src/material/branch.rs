//! Light that leaves a surface: by ways of its own, or straight on.

use super::{ScatterContext, reflect};
use crate::math::{DVec3, Ray};
use crate::spectrum::{LaneSet, Lanes};

/// One way light came to the surface, and the lanes that came by it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branch<const N: usize> {
    /// Unit vector toward where the light came from.
    pub wi: DVec3,
    /// Factor on each lane's throughput; 0 for lanes that did not come this way.
    pub share: Lanes<N>,
    /// Density per steradian with which `wi` was drawn, none for the one direction a smooth surface allows.
    pub pdf: Option<f64>,
    /// Whether the light came from beyond the surface.
    pub crosses: bool,
    /// The part of `share` that only converts radiance between media, (n_incident / n_beyond)^2 of the ray's indices.
    pub eta_scale: f64,
    /// Largest degree |s - p| / (s + p), of any lane, to which unpolarized light that comes by this one direction
    /// leaves polarized; 0 where it does not, and of directions that were drawn: see
    /// [`Scatter::degree_of_scattered`](super::Scatter::degree_of_scattered).
    pub polarization: f32,
}

/// From where light arrives that leaves a surface to the viewer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Incoming {
    /// Unit vector toward it.
    pub wi: DVec3,
    /// Whether it is beyond the surface.
    pub crosses: bool,
    /// Whether it is the one direction that a smooth surface allows.
    pub single: bool,
    /// The lanes in which it arrives. What becomes of others has no meaning.
    pub lanes: LaneSet,
}

impl<const N: usize> Branch<N> {
    /// The mirror image of the viewer's direction; `polarization` is the degree that it gives to unpolarized light.
    pub(super) fn mirrored(context: &ScatterContext<N>, share: Lanes<N>, polarization: f32) -> Self {
        let wi = reflect(context.wo, context.normal);
        Self { wi, share, pdf: None, crosses: false, eta_scale: 1.0, polarization }
    }

    /// A way on the viewer's side that was drawn with a density.
    pub fn drawn(wi: DVec3, share: Lanes<N>, pdf: f64) -> Self {
        Self { wi, share, pdf: Some(pdf), crosses: false, eta_scale: 1.0, polarization: 0.0 }
    }

    /// From where its light arrives, of the lanes that are present on the ray.
    #[inline(always)]
    pub fn incoming(&self, present: &Lanes<N>) -> Incoming {
        let lanes = (self.share * *present).not_zero();
        Incoming { wi: self.wi, crosses: self.crosses, single: self.pdf.is_none(), lanes }
    }

    /// The way of a ray that goes straight on, with the light that comes by it.
    pub fn through(ray: &Ray, straight: &Straight<N>) -> Self {
        let (share, polarization) = (straight.share(), straight.polarization);
        Self { wi: ray.direction, share, pdf: None, crosses: false, eta_scale: 1.0, polarization }
    }

    /// The same way with a share of its light.
    pub(super) fn scaled(&self, share: Lanes<N>) -> Self {
        Self { share: self.share * share, ..*self }
    }

    /// Whether both are the same single direction.
    pub(super) fn is_same_way(&self, other: &Self) -> bool {
        let single = self.pdf.is_none() && other.pdf.is_none();
        single && self.wi == other.wi && self.crosses == other.crosses
    }

    /// Takes in the light of another branch that goes the same way.
    pub(super) fn join(&mut self, other: &Self) {
        self.polarization = self.polarization.max(other.polarization);
        self.share += other.share;
    }
}

/// What goes straight on through a surface, as a share of each lane.
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

    /// All that goes straight on.
    pub fn share(&self) -> Lanes<N> {
        self.holes + self.panes
    }

    /// What goes through holes, without what goes through panes.
    #[must_use]
    pub fn through_holes(self) -> Self {
        Self { panes: Lanes::ZERO, ..self }
    }

    /// What two materials let through that each cover a share of a surface.
    pub(super) fn of_both(parts: [Option<Self>; 2], shares: [Lanes<N>; 2]) -> Option<Self> {
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

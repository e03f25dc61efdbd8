//! Light that a surface lets straight on, into the same media.

use super::{Arrival, Material};
use crate::spectrum::{Lanes, Table};

/// What goes straight on through a surface, as a share of each lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Straight<const N: usize> {
    /// Through holes, where nothing is met.
    pub holes: Lanes<N>,
    /// Through panes.
    pub panes: Lanes<N>,
    /// Largest degree |s - p| / (s + p) to which unpolarized light leaves the panes polarized.
    pub polarization: f32,
}

impl<const N: usize> Straight<N> {
    /// Nothing.
    const NONE: Self = Self { holes: Lanes::ZERO, panes: Lanes::ZERO, polarization: 0.0 };

    /// All that goes straight on.
    pub fn share(&self) -> Lanes<N> {
        self.holes + self.panes
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

impl<S> Material<S> {
    /// Whether it lets light straight on: through holes, or as a pane does that bends nothing.
    pub fn is_see_through(&self) -> bool {
        matches!(self, Self::Mask(_) | Self::Thin(_))
            || self.parts().iter().any(|part| part.material().is_see_through())
    }
}

impl Material<Table> {
    /// The share of the light that goes straight on and into the same media; none where nothing does. `scatter` leaves it
    /// out.
    pub fn straight<const N: usize>(&self, arrival: &Arrival<N>) -> Option<Straight<N>> {
        match self {
            Self::Thin(thin) => Some(thin.straight(arrival)),
            Self::Mix(mix) => mix.straight(arrival),
            Self::Mask(mask) => Some(mask.straight(arrival)),
            Self::Diffuse(_) | Self::Mirror(_) | Self::Conductor(_) | Self::Dielectric(_) => None,
            Self::Emissive(_) | Self::Plastic(_) => None,
        }
    }
}

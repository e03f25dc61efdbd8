//! A white light, in which surfaces are measured.

use crate::spectrum::{Basis, Curve, Draw, Lanes, Quantity, Response, Table};

/// A light of radiance 1.
#[derive(Clone, Debug)]
pub(super) struct White {
    response: Response,
    emission: Table,
}

impl White {
    pub(super) fn new(basis: &Basis) -> Self {
        let one = Curve::from(1.0);
        Self { response: basis.response(&one), emission: basis.tabulate(Quantity::Emission, &one) }
    }

    /// Returns the film's red, green and blue of it, times a factor on each lane; `parted` tells whether lanes parted.
    pub(super) fn times<const N: usize>(&self, draw: &Draw<N>, lanes: Lanes<N>, parted: bool) -> [f64; 3] {
        self.response.film_rgb(draw, lanes * draw.read(&self.emission), parted)
    }
}

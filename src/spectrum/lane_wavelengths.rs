use super::{Draw, Table};

/// The position of each lane in the spectrum, for light that interferes.
#[derive(Clone, Debug)]
pub struct Waves {
    /// Wavelengths in nm, in vacuum.
    wavelengths: Table,
    /// Widths of the bands that lanes stand for, over their wavelengths; 0 for lines and heroes.
    widths: Table,
}

impl Waves {
    pub(super) fn new(wavelengths: Table, widths: Table) -> Self {
        Self { wavelengths, widths }
    }

    /// Returns the wavelength of a lane in vacuum, in nm, and its band's width over that: 0 for lines and heroes.
    pub fn of_lane<const N: usize>(&self, draw: &Draw<N>, lane: usize) -> [f64; 2] {
        [&self.wavelengths, &self.widths].map(|table| draw.read_lane(table, lane))
    }

    /// Returns the wavelength in nm and the relative bandwidth of every fixed lane.
    pub fn of_fixed_lanes(&self) -> impl Iterator<Item = [f64; 2]> {
        self.wavelengths.bins().iter().zip(self.widths.bins()).map(|(&nm, &width)| [nm, width])
    }
}

//! Lanes as they arrive at the sensor.

use crate::spectrum::{Draw, Lanes, Response};

/// The number of a source of light: a light or, beyond the number of lights, a dye.
pub(super) type SourceId = usize;

/// The lanes by which light arrives at the sensor.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReceivedLight<'a, const N: usize> {
    pub(super) source: SourceId,
    pub(super) draw: &'a Draw<N>,
    pub(super) lanes: &'a Lanes<N>,
    /// Whether the lanes parted on the way.
    pub(super) parted: bool,
}

impl<const N: usize> ReceivedLight<'_, N> {
    /// Returns the film's red, green and blue, by the sensor's response to the lanes of each source.
    #[inline]
    pub(super) fn rgb(&self, responses: &[Response]) -> [f64; 3] {
        responses[self.source].film_rgb(self.draw, *self.lanes, self.parted)
    }

    /// Returns the film's red, green and blue of a part of each lane, which may be negative.
    pub(super) fn times(&self, part: Lanes<N>, responses: &[Response]) -> [f64; 3] {
        responses[self.source].film_rgb(self.draw, *self.lanes * part, self.parted)
    }
}

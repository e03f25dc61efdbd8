//! Lanes at the end of their way.

use crate::spectrum::{Draw, Lanes, Response};

/// What light comes from: the number of a light, or beyond those of a dye.
pub(super) type SourceId = usize;

/// The lanes by which light arrives at the sensor.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReceivedLight<'a, const N: usize> {
    pub(super) source: SourceId,
    pub(super) draw: &'a Draw<N>,
    pub(super) lanes: &'a Lanes<N>,
    /// Whether they parted on the way.
    pub(super) parted: bool,
}

impl<const N: usize> ReceivedLight<'_, N> {
    /// The film's red, green and blue, by what the lanes of each light are worth.
    #[inline]
    pub(super) fn rgb(&self, responses: &[Response]) -> [f64; 3] {
        responses[self.source].sensor(self.draw, *self.lanes, self.parted)
    }

    /// The same of a part of each lane, which may be negative.
    pub(super) fn times(&self, part: Lanes<N>, responses: &[Response]) -> [f64; 3] {
        responses[self.source].sensor(self.draw, *self.lanes * part, self.parted)
    }
}

//! Whether bounces are aimed at what lights a room.

use crate::trace::{BrightPlaces, World, bright_places, samples_worth};

/// How much less variance times rays must be: an aimed bounce takes a tenth longer, and a pilot knows no better.
const CLEARLY: f64 = 1.25;

/// Bounces that are aimed.
pub(super) struct Aimed {
    /// At what.
    pub(super) places: BrightPlaces,
    /// How many times as long an equal error takes without.
    pub(super) gain: f64,
}

/// The bright places that bounces are aimed at, if that pays.
///
/// The variance is that without the worst hundredth of the pixels, in which light is found too rarely to tell anything.
/// Rays followed stand for time, so that the plan is the same everywhere.
pub(super) fn aimed(plain: &World) -> Option<Aimed> {
    let places = bright_places(plain)?;
    let [before, after] = [samples_worth(plain), samples_worth(&plain.with_bright(Some(places.clone())))];
    let gain = before.common_variance * before.rays / (after.common_variance * after.rays);
    (gain > CLEARLY).then_some(Aimed { places, gain })
}

impl Aimed {
    /// What a person is told of them.
    pub(super) fn reason(&self) -> String {
        let (count, gain) = (self.places.places.len(), self.gain);
        let [places, light] = if count == 1 { ["place", "lights"] } else { ["places", "light"] };
        format!(
            "bounces in the room are aimed at {count} bright {places} that {light} it; without, the same error would take about {gain:.1} times \
             as long"
        )
    }
}

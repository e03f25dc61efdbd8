//! Whether bounces are aimed at what lights a room.

use crate::trace::{BrightPlaces, World, bright_places, samples_worth};

/// How much less variance times rays must be: an aimed bounce takes a tenth longer, and a pilot knows no better.
const CLEARLY: f64 = 1.25;

/// The bright places that bounces are aimed at, if that pays, and why.
///
/// The variance is that without the worst hundredth of the pixels, in which light is found too rarely to tell anything.
/// Rays followed stand for time, so that the plan is the same everywhere.
pub(super) fn aimed(plain: &World) -> (Option<BrightPlaces>, Option<String>) {
    let Some(places) = bright_places(plain) else { return (None, None) };
    let [before, after] = [samples_worth(plain), samples_worth(&plain.with_bright(Some(places.clone())))];
    let gain = before.common_variance * before.rays / (after.common_variance * after.rays);
    if gain.is_nan() || gain <= CLEARLY {
        return (None, None);
    }
    let count = places.places.len();
    let line = format!(
        "bounces in the room are aimed at {count} bright place{} that light{} it; without, the same error would take about {gain:.1} times as \
         long",
        if count == 1 { "" } else { "s" },
        if count == 1 { "s" } else { "" },
    );
    (Some(places), Some(line))
}

//! Whether bounces are aimed at what lights a room.

use crate::scene::Scene;
use crate::spectrum::Curve;
use crate::trace::{BrightPlaces, Method, World, bright_places, samples_worth};

/// How much less variance times rays must be: an aimed bounce takes longer, and a pilot does not know better.
const CLEARLY: f64 = 0.1;

/// The bright places that bounces are aimed at, if that pays, and why.
pub(super) fn aimed(scene: &Scene<Curve>, method: &Method) -> (Option<BrightPlaces>, Option<String>) {
    let plain = World::untaught(scene, Method { light_pass: None, bright: None, ..method.clone() });
    let Some(places) = bright_places(&plain) else { return (None, None) };
    let with = Method { bright: Some(places.clone()), ..plain.method().clone() };
    let [before, after] = [samples_worth(&plain), samples_worth(&World::untaught(scene, with))];
    let gain = before.common_variance * before.rays / (after.common_variance * after.rays);
    if std::env::var("BRIGHT_DEBUG").is_ok() {
        eprintln!("gain {gain} {places:#?}");
    }
    if gain.is_nan() || gain <= CLEARLY {
        return (None, None);
    }
    let count = places.places.len();
    let line = format!(
        "bounces in the room are aimed at {count} bright place{} that light it: noise falls as if of {gain:.1} times the samples",
        if count == 1 { "" } else { "s" },
    );
    (Some(places), Some(line))
}

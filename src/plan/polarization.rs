//! What the plan says of polarization, which is not traced.

use super::survey::tolerance;
use super::words::percent;
use crate::scene::Scene;
use crate::spectrum::Curve;
use crate::trace::{World, seen_light};

/// How much polarization may change; nothing where it can hardly be told.
pub(super) fn left_out(scene: &Scene<Curve>, world: &World) -> Option<String> {
    let light = seen_light(world);
    let (all, part) = (light.change(), light.change_of_part());
    let tolerated = tolerance(scene);
    if part > tolerated {
        let part = if part > 1.05 * all {
            format!(", and up to {} in a part of the view", percent(part))
        } else {
            String::new()
        };
        return Some(format!(
            "polarization may change up to {} of the light seen{part}; it is not traced ({} is tolerated)",
            percent(all),
            percent(tolerated)
        ));
    }
    (part > NOTHING)
        .then(|| format!("polarization is not traced: it changes at most {} of the light seen", percent(part)))
}

/// A share that is not worth a word.
const NOTHING: f64 = 1e-4;

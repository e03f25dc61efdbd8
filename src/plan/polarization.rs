//! What the plan says of polarization, which is not traced.

use super::model::tolerance;
use super::percent;
use crate::scene::Scene;
use crate::spectrum::Curve;
use crate::trace::{Method, Probe, World, probe};

/// How much polarization may change; nothing where it can hardly be told.
pub(super) fn left_out(
    scene: &Scene<Curve>,
    method: &Method,
    without_pass: &World,
    probe_of_method: &Probe,
) -> Option<String> {
    // Light that photons bring is left out by the camera's rays of the method.
    let found = method.light_pass.as_ref().map(|_| probe(without_pass));
    let found = found.as_ref().unwrap_or(probe_of_method);
    let (all, part) = (found.polarization, found.polarization_of_part);
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

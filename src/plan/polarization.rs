//! Decides whether polarization is traced, and why.

use super::format::{percent, percent_and_limit};
use super::survey::tolerance;
use crate::scene::{PolarizationText, Scene};
use crate::spectrum::Curve;
use crate::trace::{Polarizing, World, most_changed, polarization_error};

/// What is decided about polarization, and what the user is told.
pub(super) struct Decision {
    pub(super) polarization: Polarizing,
    pub(super) reason: Option<String>,
    pub(super) left_out: Option<String>,
    /// How far the image is off without polarization, if that was measured.
    pub(super) error: Option<f64>,
}

/// Factor by which the error may be larger than measured, since so few samples may miss some of it.
const SAFETY: f64 = 2.0;

/// Traces polarization where the scene asks for it, or where leaving it out would cause an error above the tolerance:
/// in the whole format, so that all parts of an image are rendered the same way.
pub(super) fn decide(scene: &Scene<Curve>, world: &World) -> Decision {
    let decide_on = |reason: String| {
        let reason = Some(format!("polarization on: {reason}"));
        Decision { polarization: Polarizing::Traced, reason, left_out: None, error: None }
    };
    let decide_off = |reason: Option<String>, left_out: Option<String>| {
        let reason = reason.map(|reason| format!("polarization off: {reason}"));
        Decision { polarization: Polarizing::Averaged, reason, left_out, error: None }
    };
    let world = &world.of_the_format();
    match scene.render.polarization {
        PolarizationText::On => return decide_on("the scene asks for it".into()),
        PolarizationText::Off => {
            return decide_off(Some("the scene asks for it".into()), left_out(most_changed(world)));
        }
        PolarizationText::Auto => {}
    }
    if let Some(why_required) = why_required(scene) {
        return decide_on(why_required);
    }
    let bound = most_changed(world);
    let tolerated = tolerance(scene);
    if bound <= tolerated {
        let within = |what: String| format!("{what}, within the {} that is tolerated", percent(tolerated));
        return decide_off(None, left_out(bound).map(within));
    }
    let error = polarization_error(world);
    let traced_above = tolerated / SAFETY;
    let [found, limit] = percent_and_limit(error, traced_above);
    let measured = format!("{found} (it is traced above {limit})");
    if error > traced_above {
        decide_on(format!("without it, the image would be wrong by {measured}"))
    } else {
        Decision {
            error: Some(error),
            ..decide_off(Some(format!("without it, the image is wrong by {measured}")), None)
        }
    }
}

/// Describes what in a scene has no meaning without polarization, if anything.
fn why_required(scene: &Scene<Curve>) -> Option<String> {
    if scene.camera.filter().is_some() {
        return Some("there is a filter in front of the camera".into());
    }
    if scene.format.has_stokes() {
        return Some("the film asks for Stokes vectors".into());
    }
    if scene.lights.iter().any(|light| light.polarization().is_some()) {
        return Some("the sky is polarized".into());
    }
    let sheet = scene.materials.iter().find(|material| material.material.has_axis())?;
    Some(format!("the scene has a sheet that polarizes ({})", sheet.name))
}

/// Describes how much polarization may change; `None` where that is negligible.
fn left_out(change: f64) -> Option<String> {
    (change > NEGLIGIBLE)
        .then(|| format!("left out: polarization, which changes at most {} of the light seen", percent(change)))
}

/// A share that is too small to mention.
const NEGLIGIBLE: f64 = 1e-4;

//! Light in physical units, for scenes whose film is absolute.
//!
//! A number is a luminance in cd/m^2, an intensity in cd or an irradiance in lx. It stands for that many times white
//! light of 1. Measured spectra and lines are radiances in W / (m^2 sr nm) and W / (m^2 sr), or intensities and
//! irradiances in the corresponding units.

use super::context::Context;
use super::curve_text::CurveText;
use crate::scene::text::Value;
use crate::spectrum::visible::{EFFICACY, y_integral};
use crate::spectrum::{Curve, CurveKind};

/// Converts the light of a curve to a film whose white has the luminance that the scene gives. Without one, the curve
/// stays as it is.
pub(super) fn scale_to_film(context: &Context, text: &CurveText, curve: Curve) -> Option<Curve> {
    let Some(white) = context.white_luminance else { return Some(curve) };
    let unit = match curve.kind {
        CurveKind::Illuminant(_) | CurveKind::Blackbody(_) if curve.luminance.is_none() => {
            let message = "in absolute light, this spectrum needs a `luminance`";
            let help = "add it: in cd/m2 for a radiance, in cd for an intensity, in lx for an irradiance";
            return text.value.advise(message, help);
        }
        // A flat spectrum of 1 otherwise has luminance 1.
        CurveKind::Samples(_) | CurveKind::Lines(_) if curve.luminance.is_none() => EFFICACY * y_integral(),
        _ => 1.0,
    };
    Some(scaled(curve, unit / white))
}

/// Converts an intensity in cd or W / (sr nm) for distances in scene units.
pub(super) fn intensity(context: &Context, place: Value, intensity: Curve) -> Option<Curve> {
    match (context.white_luminance, context.meters_per_unit) {
        (None, _) => Some(intensity),
        (Some(_), Some(meters)) => Some(scaled(intensity, 1.0 / (meters * meters))),
        (Some(_), None) => {
            let message =
                "absolute light falls off with distance in meters, but the scene does not say how long its unit is";
            place.advise(message, "for a scene in meters: [render] meters_per_unit = 1")
        }
    }
}

fn scaled(curve: Curve, factor: f64) -> Curve {
    let luminance = curve.luminance.map(|luminance| luminance * factor);
    Curve { scale: curve.scale * factor, luminance, ..curve }
}

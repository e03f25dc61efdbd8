//! Warnings for viewers of an image.

use super::image_error::ImageError;
use crate::film::{Layer, TELL_VARIANCE};
use crate::look::percent;
use crate::scene::Scene;
use crate::trace::{MAX_MEDIA, RareLight, Report};

/// Returns all warnings about a render.
pub(super) fn warnings(report: &Report, error: Option<&ImageError>) -> Vec<String> {
    let mut warnings: Vec<String> = error
        .into_iter()
        .flat_map(|error| [outlier(error), error_not_reached(error), error_unknown(report, error)])
        .flatten()
        .collect();
    let place = report.first_non_finite.map(|[x, y, sample]| format!("sample {sample} of pixel ({x}, {y})"));
    warnings.extend(match (report.non_finite, place) {
        (0, _) => None,
        (1, None) => Some("1 sample was not finite and is left out".into()),
        (1, Some(place)) => Some(format!("1 sample was not finite and is left out: {place}")),
        (count, None) => Some(format!("{count} samples were not finite and are left out")),
        (count, Some(place)) => Some(format!("{count} samples were not finite and are left out; the first is {place}")),
    });
    if report.unmatched > 0 {
        let times = if report.unmatched == 1 { "once".into() } else { format!("{} times", report.unmatched) };
        let times = format!("{times}, light left a clear body it had not entered");
        let crowded = format!(", or do more than {MAX_MEDIA} clear materials overlap in one place");
        let crowded = if report.has_many_media { &crowded } else { "" };
        warnings.push(format!("{times} and passed through undeflected: is the surface of a dielectric open{crowded}?"));
    }
    if report.by_chance > 0 {
        let share = format!("in {} of {} camera samples", report.by_chance, report.samples);
        let what =
            "light had too many paths to follow them all, and some were chosen at random: these pixels have noise";
        warnings.push(format!("{share} {what}"));
    }
    warnings
}

/// Returns a warning about an image without any light, or none if that is intended or already explained.
pub(super) fn dark_warning(scene: &Scene) -> Option<String> {
    let limits = [("max_bounces", scene.render.max_bounces), ("diffuse_bounces", scene.render.diffuse_bounces)];
    let limits: Vec<String> = limits.iter().filter_map(|(key, limit)| Some(format!("{key} = {}", (*limit)?))).collect();
    let why = match limits.is_empty() {
        true => String::new(),
        false => format!(" within {}", limits.join(" and ")),
    };
    scene.is_dark_by_surprise().then(|| format!("no light was found in any pixel{why}, so the image is black"))
}

/// Returns a warning about layers that need more samples per pixel.
pub(super) fn few_samples(layers: &[Layer], samples: u64) -> Option<String> {
    let noise_layers = [Layer::Variance, Layer::HalfA, Layer::HalfB];
    let requested: Vec<&str> =
        noise_layers.iter().filter(|layer| layers.contains(layer)).map(|layer| layer.name()).collect();
    (!requested.is_empty() && samples < TELL_VARIANCE.into()).then(|| {
        let (layers, verb) = (requested.join(", "), if requested.len() == 1 { "shows" } else { "show" });
        format!("{layers} {verb} the noise only with {TELL_VARIANCE} or more samples per pixel, not with {samples}")
    })
}

/// Warns of light too rare to know how much there is, unless an error was requested and is reached all the same.
fn outlier(error: &ImageError) -> Option<String> {
    let outlier = error.noise.outlier.filter(|_| error.requested.is_none() || !error.is_reached())?;
    let ([x, y], share) = (outlier.pixel, percent(outlier.share));
    let light = error.rare_light.as_ref().map_or("light".into(), describe);
    Some(format!(
        "pixel ({x}, {y}) accounts for {share} of the noise: one of eight renders found {light} there, and no other \
         did. There may be more such light than the samples show"
    ))
}

/// Warns that the requested error is not reached.
fn error_not_reached(error: &ImageError) -> Option<String> {
    let requested = error.requested.filter(|_| !error.is_reached())?;
    let why = if error.model > requested {
        format!(": the model of color alone may be off by {}", percent(error.model))
    } else if error.alpha.is_some_and(|alpha| alpha.at_most > error.noise.at_most.hypot(error.blur.at_most)) {
        ": most of it is noise of alpha, where shadow catchers are".into()
    } else if error.blur.at_most > error.noise.at_most {
        ": most of it is the blur of gathered photons, which halves with 8 to 64 times as many samples".into()
    } else {
        String::new()
    };
    Some(format!("the error of {} that was asked for is not reached{why}", percent(requested)))
}

/// Warns of an image without any light, whose noise is unknown.
fn error_unknown(report: &Report, error: &ImageError) -> Option<String> {
    let is_dark = report.light == 0.0 && error.alpha.is_none() && error.requested.is_some();
    is_dark.then(|| "no light was found in any pixel, so the error of the image is unknown".into())
}

/// Describes rare light and its path.
fn describe(light: &RareLight) -> String {
    let RareLight { name, bounces, found } = light;
    let origin = name.as_ref().map_or(String::new(), |name| format!(" of {name}"));
    let bounce_count = if *bounces == 1 { "after 1 bounce".into() } else { format!("after {bounces} bounces") };
    format!("light{origin} ({found} {bounce_count})")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn too_many_clear_materials_are_mentioned_only_where_there_are_that_many() {
        let describe = |has_many_media| warnings(&Report { unmatched: 1, has_many_media, ..Report::default() }, None);
        let once = "once, light left a clear body it had not entered and passed through undeflected: is the surface of a dielectric open";
        assert_eq!(describe(false), [format!("{once}?")]);
        assert_eq!(describe(true), [format!("{once}, or do more than 16 clear materials overlap in one place?")]);
    }
}

//! Decides when enough samples are taken.

use super::format::{format_duration, percent};
use crate::film::Window;
use crate::scene::{RenderText, Scene};
use crate::spectrum::Curve;
use crate::trace::{FIRST_LOOK, Stop};

/// Fewest samples that replicates can share.
const MIN_SAMPLES: u32 = 8;
/// Fewest camera samples of an image whose error is trusted: 64 in one pixel would often miss a small lamp.
const MIN_TRUSTED_SAMPLES: u32 = 4096;
/// Most samples where the scene does not specify them.
const MAX_SAMPLES: u32 = 65_536;
/// Samples for which photons are counted: their number per sample is the same, however many samples there will be.
pub(super) const NOMINAL_SAMPLES: u32 = 1024;
/// The least share of the error that is left for noise: where the model of color misses a third of it.
const MIN_NOISE_SHARE: f64 = 0.942_809_041_582_063_4;

/// Returns when a render has enough samples, if it does not take all of them whatever they show.
///
/// The model of color may miss a third of the error. What it does not miss is left for noise, as squares add up.
pub(super) fn stop(render: &RenderText, window: Window, model_error: f64) -> Option<Stop> {
    let RenderText { error, time, samples, is_part, .. } = *render;
    let most = samples.unwrap_or(MAX_SAMPLES) / MIN_SAMPLES * MIN_SAMPLES;
    let min_samples = if time.is_some() { MIN_SAMPLES } else { FIRST_LOOK };
    let is_requested = error.is_some() || time.is_some();
    let pixels = window.width.saturating_mul(window.height).max(1);
    let least = MIN_TRUSTED_SAMPLES.div_ceil(pixels).clamp(FIRST_LOOK.min(most), most);
    let noise =
        error.map(|error| (error * error - model_error * model_error).max(0.0).sqrt().max(MIN_NOISE_SHARE * error));
    (is_requested && most >= min_samples && !is_part).then_some(Stop {
        noise,
        time,
        min_samples: least,
        max_samples: most,
    })
}

/// Returns the explanation for the user.
pub(super) fn reason(scene: &Scene<Curve>, stop: Option<&Stop>, model_error: f64) -> Option<String> {
    let RenderText { error, time, samples, is_part, .. } = scene.render;
    let Some(stop) = stop else {
        let samples = samples.filter(|_| error.is_some() || time.is_some())?;
        let all = if samples == 1 { "one sample".into() } else { format!("all {samples} samples") };
        return Some(match is_part {
            true => format!("takes {all}: a part of an image does not show the error of the whole"),
            false if error.is_none() => format!("takes {all}: a time limit never ends a render before {MIN_SAMPLES}"),
            false => format!("takes {all}: the error cannot be estimated from fewer than {FIRST_LOOK}"),
        });
    };
    let error_rule = |error: f64| {
        let (all, noise) = (percent(error), stop.noise.map(percent).unwrap_or_default());
        let color = match model_error {
            alone if alone > error => format!("; color alone may be off by {}", percent(alone)),
            _ => String::new(),
        };
        let hint = if error == 1.0 { " (0.01 asks for 1 %)" } else { "" };
        let parts = if noise == all { color } else { format!(" (noise {noise}, the rest color{color})") };
        format!("when the error is at most {all}{hint} in 95 of 100 renders{parts}")
    };
    let time_rule = |time: std::time::Duration| {
        format!("after {} and at least {MIN_SAMPLES} samples per pixel", format_time(time.as_secs_f64()))
    };
    let rules =
        [error.map(error_rule), time.map(time_rule), Some(format!("at {} samples per pixel", stop.max_samples))];
    let rules: Vec<String> = rules.into_iter().flatten().collect();
    Some(format!("stops {}, whichever comes first", rules.join(", or ")))
}

/// Formats a time as people say it, also a short one.
fn format_time(seconds: f64) -> String {
    if seconds < 10.0 { format!("{seconds} s") } else { format_duration(seconds) }
}

//! Summaries of plans and renders, for programs to read.

use std::time::Duration;

use cpu_time::ProcessTime;
use serde::Serialize;

use super::image::Image;
use super::image_error::ImageError;
use crate::plan::Plan;
use crate::trace::Report;

/// How a scene will be rendered.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct PlanAccount<'a> {
    /// How spectra are represented.
    pub model: String,
    /// The light transport algorithm.
    pub transport: &'static str,
    /// The number of camera samples per pixel, or the maximum number if there is a stop rule.
    pub samples: u32,
    /// The number of photons in all passes, if it is known in advance.
    pub photons: Option<u64>,
    /// The time of all processors together, if the number of samples is known in advance.
    pub processor_seconds: Option<f64>,
    /// The error that colors may have.
    pub model_error: f64,
    /// The light that is left out.
    pub left_out: &'a [String],
    /// The plan in words, one decision per entry.
    pub because: &'a [String],
}

impl<'a> PlanAccount<'a> {
    /// Summarizes a plan.
    pub fn new(plan: &'a Plan) -> Self {
        let method = &plan.method;
        let (pass, is_known) = (method.light_pass.as_ref(), method.stop.is_none());
        let map_photons = method.map().map_or(0, |map| map.all_photons());
        Self {
            model: method.basis.name(),
            transport: method.transport.name(),
            samples: method.stop.as_ref().map_or(method.samples, |stop| stop.max_samples),
            photons: is_known.then(|| pass.map_or(0, |pass| pass.photons) + map_photons),
            processor_seconds: is_known.then_some(plan.processor_time.as_secs_f64()),
            model_error: plan.model_error,
            left_out: &plan.left_out,
            because: &plan.because,
        }
    }
}

/// What was noticed during a render.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct RenderAccount<'a> {
    /// What the tracer noticed.
    #[serde(flatten)]
    pub report: &'a Report,
    /// How long the render took.
    pub seconds: f64,
    /// How long the plan expected the render to take.
    pub expected_seconds: f64,
    /// The error of the image, if it was measured.
    pub error: Option<ErrorAccount<'a>>,
    /// The processor time of the process so far, if the system reports it.
    pub processor_seconds: Option<f64>,
    /// The peak memory of the process, if the system reports it.
    pub peak_memory_bytes: Option<u64>,
}

impl<'a> RenderAccount<'a> {
    /// Summarizes the render of an image, given the time that it took and the time that its plan expected.
    pub fn new(image: &'a Image, took: Duration, expected: Duration) -> Self {
        Self {
            report: image.report(),
            seconds: took.as_secs_f64(),
            expected_seconds: expected.as_secs_f64(),
            error: image.error().map(ErrorAccount::new),
            processor_seconds: ProcessTime::try_now().ok().map(|time| time.as_duration().as_secs_f64()),
            peak_memory_bytes: peak_memory(),
        }
    }
}

/// The error of an image. All errors are relative to the image.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct ErrorAccount<'a> {
    /// The requested error, if any.
    #[serde(rename = "asked")]
    pub requested: Option<f64>,
    /// Whether the requested error was reached. True if none was requested.
    pub is_reached: bool,
    /// What ended the render: error, time or samples.
    pub stopped_by: Option<&'static str>,
    /// The number of camera samples per pixel.
    pub samples_per_pixel: u32,
    /// The error is at most this in 95 of 100 renders.
    pub at_most: f64,
    /// The expected noise: the part of the error that is due to chance.
    pub noise: f64,
    /// The noise is at most this in 95 of 100 renders.
    pub noise_at_most: f64,
    /// The expected blur: the part of the error that is due to gathered photons.
    pub blur: f64,
    /// The blur is at most this in 95 of 100 renders.
    pub blur_at_most: f64,
    /// The expected noise of alpha, relative to alpha. None without shadow catchers.
    pub alpha: Option<f64>,
    /// The noise of alpha is at most this in 95 of 100 renders.
    pub alpha_at_most: Option<f64>,
    /// The part of the error that is due to the color model.
    pub model: f64,
    /// The first column and row of the 16 x 16 pixels with the most noise.
    pub worst_tile: [i64; 2],
    /// The expected noise of the worst tile.
    pub worst_tile_noise: f64,
    /// The column and row of a pixel with light that only one of eight renders found.
    pub outlier: Option<[i64; 2]>,
    /// The outlier's share of the variance.
    pub outlier_share: Option<f64>,
    /// The light that was found in the outlier.
    pub outlier_light: Option<&'a str>,
    /// How often the outlier's light was scattered, mirrored or refracted on its way.
    pub outlier_bounces: Option<u32>,
    /// How the outlier's light was found.
    pub outlier_found: Option<&'static str>,
}

impl<'a> ErrorAccount<'a> {
    /// Summarizes an error.
    pub fn new(error: &'a ImageError) -> Self {
        let light = error.rare_light.as_ref();
        let (noise, outlier) = (&error.noise, error.noise.outlier.as_ref());
        Self {
            requested: error.requested,
            is_reached: error.is_reached(),
            stopped_by: error.stopped_by.map(|reason| reason.name()),
            samples_per_pixel: noise.samples,
            at_most: error.at_most(),
            noise: noise.expected,
            noise_at_most: noise.at_most,
            blur: error.blur.expected,
            blur_at_most: error.blur.at_most,
            alpha: error.alpha.map(|alpha| alpha.expected),
            alpha_at_most: error.alpha.map(|alpha| alpha.at_most),
            model: error.model,
            worst_tile: noise.worst_tile.corner,
            worst_tile_noise: noise.worst_tile.expected,
            outlier: outlier.map(|outlier| outlier.pixel),
            outlier_share: outlier.map(|outlier| outlier.share),
            outlier_light: light.and_then(|light| light.name.as_deref()),
            outlier_bounces: light.map(|light| light.bounces),
            outlier_found: light.map(|light| light.found),
        }
    }
}

/// Returns the peak memory of the process, if Linux reports it.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kilobytes)
}

//! What is known of a plan and of a render, as programs read it.

use std::time::Duration;

use cpu_time::ProcessTime;
use serde::Serialize;

use super::image::Image;
use super::image_error::ImageError;
use crate::plan::Plan;
use crate::trace::Report;

/// How a scene will be rendered.
#[derive(Clone, Debug, Serialize)]
pub struct PlanAccount<'a> {
    /// How spectra are carried.
    pub model: String,
    /// How light is followed.
    pub transport: &'static str,
    /// Camera samples per pixel, or the most.
    pub samples: u32,
    /// Photons of all passes, where it is known how many there will be.
    pub photons: Option<u64>,
    /// Time of all processors together, where it is known how many samples there will be.
    pub processor_seconds: Option<f64>,
    /// How far colors may be off.
    pub model_error: f64,
    /// What light is left out.
    pub left_out: &'a [String],
    /// The plan in words, a decision each.
    pub because: &'a [String],
}

impl<'a> PlanAccount<'a> {
    /// Of a plan.
    pub fn new(plan: &'a Plan) -> Self {
        let method = &plan.method;
        let (pass, is_known) = (method.light_pass.as_ref(), method.stop.is_none());
        let of_map = method.map().map_or(0, |map| map.all_photons());
        Self {
            model: method.basis.name(),
            transport: method.transport.name(),
            samples: method.stop.as_ref().map_or(method.samples, |stop| stop.most),
            photons: is_known.then(|| pass.map_or(0, |pass| pass.photons) + of_map),
            processor_seconds: is_known.then_some(plan.processor_time.as_secs_f64()),
            model_error: plan.model_error,
            left_out: &plan.left_out,
            because: &plan.because,
        }
    }
}

/// What rendering noticed.
#[derive(Clone, Debug, Serialize)]
pub struct RenderAccount<'a> {
    /// What the tracer noticed.
    #[serde(flatten)]
    pub report: &'a Report,
    /// How long it took.
    pub seconds: f64,
    /// How long the plan expected it to take.
    pub expected_seconds: f64,
    /// How far the image is off, where that was measured.
    pub error: Option<ErrorAccount<'a>>,
    /// What the process has taken so far, where the system tells it.
    pub processor_seconds: Option<f64>,
    /// The most memory that the process has had at once, where the system tells it.
    pub peak_memory_bytes: Option<u64>,
}

impl<'a> RenderAccount<'a> {
    /// Of an image that took some time, where its plan expected another.
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

/// How far an image is off. All errors are relative to the image.
#[derive(Clone, Debug, Serialize)]
pub struct ErrorAccount<'a> {
    /// The error that was asked for, if one was.
    pub asked: Option<f64>,
    /// Whether it is reached; so it is where none was.
    pub is_reached: bool,
    /// What ended the render: error, time or samples.
    pub stopped_by: Option<&'static str>,
    /// Camera samples of each pixel.
    pub samples_per_pixel: u32,
    /// In 95 of 100 renders the error is at most this.
    pub at_most: f64,
    /// The part of it that is chance, as it is expected.
    pub noise: f64,
    /// What the noise is at most in 95 of 100 renders.
    pub noise_at_most: f64,
    /// The part of photons that are gathered, which blur, as it is expected.
    pub blur: f64,
    /// What the blur is at most in 95 of 100 renders.
    pub blur_at_most: f64,
    /// The noise of alpha, relative to alpha, as it is expected; none without shadow catchers.
    pub alpha: Option<f64>,
    /// What the noise of alpha is at most in 95 of 100 renders.
    pub alpha_at_most: Option<f64>,
    /// The part that is color.
    pub model: f64,
    /// First column and row of the 16 x 16 pixels with most noise.
    pub worst_tile: [i64; 2],
    /// How much it is.
    pub worst_tile_noise: f64,
    /// Column and row of a pixel whose light one of eight renders found alone.
    pub outlier: Option<[i64; 2]>,
    /// Its share of the variance.
    pub outlier_share: Option<f64>,
    /// The light that was found there.
    pub outlier_light: Option<&'a str>,
    /// How often it was scattered, mirrored or refracted on its way.
    pub outlier_bounces: Option<u32>,
    /// How it was found.
    pub outlier_found: Option<&'static str>,
}

impl<'a> ErrorAccount<'a> {
    /// Of an error.
    pub fn new(error: &'a ImageError) -> Self {
        let light = error.rare_light.as_ref();
        let (noise, outlier) = (&error.noise, error.noise.outlier.as_ref());
        Self {
            asked: error.asked,
            is_reached: error.is_reached(),
            stopped_by: error.stopped_by.map(|by| by.name()),
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

/// The most memory that the process has had at once, where Linux tells it.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kilobytes)
}

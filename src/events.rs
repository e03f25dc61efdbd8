//! What is said with `--json`: an object a line. `tools/events.schema.json` tells all of their keys.

use std::io::Write;
use std::path::Path;
use std::time::Duration;

use abbe::film::replace_file;
use abbe::plan::Plan;
use abbe::{Diagnostic, Error, Image, ImageError, Result};
use cpu_time::ProcessTime;
use serde::Serialize;

/// Something that happened or was found out.
#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Event<'e> {
    /// The scene is right.
    Checked { scene: &'e Path, objects: usize },
    /// How it will be rendered.
    Plan {
        model: String,
        transport: &'static str,
        /// Camera samples per pixel, or the most.
        samples: u32,
        /// Photons of all passes, where it is known how many there will be.
        photons: Option<u64>,
        processor_seconds: Option<f64>,
        /// How far colors may be off.
        model_error: f64,
        /// What light is left out.
        left_out: &'e [String],
        /// The plan in words, a decision each.
        because: &'e [String],
    },
    /// How far it is, in camera samples and photons.
    Progress { done: u64, total: u64, seconds: f64, seconds_left: Option<f64> },
    /// What rendering noticed.
    Report {
        samples: u64,
        rays: u64,
        photons: u64,
        seconds: f64,
        expected_seconds: f64,
        dropped: f64,
        stopped: f64,
        by_chance: u64,
        non_finite: u64,
        unmatched: u64,
        polarization: f64,
        polarization_of_tile: f64,
        /// How far the image is off, where that was measured.
        error: Option<Box<ErrorOfImage<'e>>>,
        /// What the process has taken so far, where the system tells it.
        processor_seconds: Option<f64>,
        peak_memory_bytes: Option<u64>,
    },
    /// A file that was written.
    Written { path: &'e Path },
    /// Words for people.
    Note { message: &'e str },
    /// Something to know that stops nothing.
    Warning { message: &'e str },
    /// What went wrong.
    Error { message: String, file: Option<String>, line: Option<usize>, column: Option<usize>, help: Option<&'e str> },
}

/// How far an image is off. All errors are relative to the image.
#[derive(Serialize)]
pub struct ErrorOfImage<'e> {
    /// The error that was asked for, if one was.
    asked: Option<f64>,
    is_reached: bool,
    /// What ended the render: error, time or samples.
    stopped_by: Option<&'static str>,
    samples_per_pixel: u32,
    /// In 95 of 100 renders the error is at most this.
    at_most: f64,
    /// The part of it that is chance, as it is expected and at most, that of photons that are gathered, which blur, and
    /// the part that is color.
    noise: f64,
    noise_at_most: f64,
    blur: f64,
    blur_at_most: f64,
    model: f64,
    /// First column and row of the 16 x 16 pixels with most noise, and how much it is.
    worst_tile: [i64; 2],
    worst_tile_noise: f64,
    /// Column and row of a pixel whose light one of eight renders found alone, and its share of the variance.
    outlier: Option<[i64; 2]>,
    outlier_share: Option<f64>,
    /// The light, how often it was scattered, mirrored or refracted on its way, and how it was found.
    outlier_light: Option<&'e str>,
    outlier_bounces: Option<u32>,
    outlier_found: Option<&'static str>,
}

impl<'e> ErrorOfImage<'e> {
    fn new(error: &'e ImageError) -> Self {
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

/// All that is known of a render, for a file.
#[derive(Serialize)]
struct Account<'e> {
    plan: Event<'e>,
    report: Event<'e>,
    /// The files that were written.
    written: &'e [&'e Path],
}

/// Writes all that is known of a render as JSON: what `--json` says of its plan and its end.
///
/// # Errors
/// If it cannot be written; a file that was there before is then untouched.
pub fn write_account(path: &Path, plan: Event, report: Event, written: &[&Path]) -> Result<()> {
    let text = serde_json::to_string_pretty(&Account { plan, report, written });
    let text = text.map_err(|error| Error::Encode { path: path.to_owned(), message: error.to_string() })?;
    replace_file(path, format!("{text}\n").as_bytes())
}

impl<'e> Event<'e> {
    pub fn plan(plan: &'e Plan) -> Self {
        let method = &plan.method;
        let (pass, is_known) = (method.light_pass.as_ref(), method.stop.is_none());
        let of_map = pass.and_then(|pass| pass.map).map_or(0, |map| u64::from(map.count) * map.photons);
        Self::Plan {
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

    pub fn report(image: &'e Image, took: Duration, expected: Duration) -> Self {
        let report = image.report();
        Self::Report {
            samples: report.samples,
            rays: report.rays,
            photons: report.photons,
            seconds: took.as_secs_f64(),
            expected_seconds: expected.as_secs_f64(),
            dropped: report.dropped,
            stopped: report.stopped,
            by_chance: report.by_chance,
            non_finite: report.non_finite,
            unmatched: report.unmatched,
            polarization: report.polarization,
            polarization_of_tile: report.polarization_of_tile,
            error: image.error().map(|error| Box::new(ErrorOfImage::new(error))),
            processor_seconds: ProcessTime::try_now().ok().map(|time| time.as_duration().as_secs_f64()),
            peak_memory_bytes: peak_memory(),
        }
    }

    /// All that an error says.
    pub fn errors(error: &'e Error) -> Vec<Self> {
        let mistake = |mistake: &'e Diagnostic| {
            let (line, column) = mistake.line_and_column();
            let file = Some(mistake.file.display().to_string());
            let (message, help) = (mistake.message.clone(), mistake.help.as_deref());
            Self::Error { message, file, line: Some(line), column: Some(column), help }
        };
        let plain = |message: String, file: Option<&Path>, help: Option<&'e str>| {
            let file = file.map(|file| file.display().to_string());
            vec![Self::Error { message, file, line: None, column: None, help }]
        };
        match error {
            Error::Scene(mistakes) => mistakes.iter().map(mistake).collect(),
            Error::Arguments { message, help } => plain(message.clone(), None, help.as_deref()),
            Error::Io { path, .. } | Error::Decode { path, .. } | Error::Encode { path, .. } => {
                plain(error.to_string(), Some(path), None)
            }
        }
    }

    /// Says it on stdout. Where nobody listens the work goes on.
    pub fn tell(&self) {
        if let Ok(line) = serde_json::to_string(self) {
            let mut stdout = std::io::stdout().lock();
            let _ = writeln!(stdout, "{line}").and_then(|()| stdout.flush());
        }
    }
}

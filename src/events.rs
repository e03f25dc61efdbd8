//! What is said with `--json`: an object a line. `tools/events.schema.json` tells all of their keys.

use std::io::Write;
use std::path::Path;
use std::time::Duration;

use abbe::plan::Plan;
use abbe::trace::Report;
use abbe::{Diagnostic, Error};
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
        /// Camera samples per pixel.
        samples: u32,
        /// Photons of all passes.
        photons: u64,
        processor_seconds: f64,
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

impl<'e> Event<'e> {
    pub fn plan(plan: &'e Plan) -> Self {
        let method = &plan.method;
        let pass = method.light_pass.as_ref();
        let of_map = pass.and_then(|pass| pass.map).map_or(0, |map| u64::from(map.count) * map.photons);
        Self::Plan {
            model: method.basis.name(),
            transport: method.transport.name(),
            samples: method.samples,
            photons: pass.map_or(0, |pass| pass.photons) + of_map,
            processor_seconds: plan.processor_time.as_secs_f64(),
            because: &plan.because,
        }
    }

    pub fn report(report: &Report, took: Duration, expected: Duration) -> Self {
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

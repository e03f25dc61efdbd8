//! The events that `--json` prints, one object per line. `tools/events.schema.json` describes all of their keys.

use std::path::Path;
use std::time::Duration;

use abbe::film::replace_file;
use abbe::plan::Plan;
use abbe::{Diagnostic, Error, Image, Lines, PlanAccount, RenderAccount, Result};
use serde::{Serialize, Serializer};

use super::error_text::problem;
use super::stdout::print;

/// Something that happened or was found out.
#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Event<'e> {
    /// The scene has no mistakes.
    Checked {
        #[serde(serialize_with = "shown")]
        scene: &'e Path,
        objects: usize,
    },
    /// A frame begins, the `number`th of `count`.
    Frame { frame: u32, number: u64, count: u64 },
    /// How the scene will be rendered.
    Plan(PlanAccount<'e>),
    /// The work done so far, in camera samples. A photon counts as the number of samples that take as long.
    Progress { done: u64, total: u64, seconds: f64, seconds_left: Option<f64> },
    /// The report on a finished render.
    Report(Box<RenderAccount<'e>>),
    /// A file that was written.
    Written {
        #[serde(serialize_with = "shown")]
        path: &'e Path,
    },
    /// A message for people.
    Note { message: &'e str },
    /// A warning, which stops nothing.
    Warning { message: &'e str },
    /// What went wrong.
    Error { message: String, file: Option<String>, line: Option<usize>, column: Option<usize>, help: Option<&'e str> },
}

/// The contents of the file for the report on a render.
#[derive(Serialize)]
struct Account<'e> {
    plan: Event<'e>,
    report: Event<'e>,
    /// The files that were written.
    written: Vec<String>,
}

/// Serializes a path as it is shown to people. A path that is not Unicode has no other form in JSON.
fn shown<S: Serializer>(path: &Path, serializer: S) -> std::result::Result<S::Ok, S::Error> {
    serializer.collect_str(&path.display())
}

/// Writes the report on a render as JSON: what `--json` prints about its plan and its end.
///
/// # Errors
/// If the file cannot be written. An existing file is then left as it is.
pub fn write_account(path: &Path, plan: Event, report: Event, written: &[&Path]) -> Result<()> {
    let written = written.iter().map(|file| file.display().to_string()).collect();
    let text = serde_json::to_string_pretty(&Account { plan, report, written });
    let text = text.map_err(|error| Error::Encode { path: path.to_owned(), message: error.to_string() })?;
    replace_file(path, format!("{text}\n").as_bytes())
}

impl<'e> Event<'e> {
    pub fn plan(plan: &'e Plan) -> Self {
        Self::Plan(PlanAccount::new(plan))
    }

    pub fn report(image: &'e Image, took: Duration, expected: Duration) -> Self {
        Self::Report(Box::new(RenderAccount::new(image, took, expected)))
    }

    /// Returns an event for each mistake in a scene, or a single one for any other error.
    pub fn errors(error: &'e Error) -> Vec<Self> {
        let mut lines = Lines::default();
        let mistake = |mistake: &'e Diagnostic| {
            let (line, column) = lines.place_of(mistake);
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
                plain(problem(error), Some(path), None)
            }
            other => plain(problem(other), None, None),
        }
    }

    /// Returns the event as a line of JSON, or none if it cannot be serialized.
    pub fn line(&self) -> Option<String> {
        serde_json::to_string(self).ok()
    }

    /// Prints the event on stdout. If nobody reads it, the work goes on.
    pub fn print(&self) {
        self.line().iter().for_each(|line| print(line));
    }
}

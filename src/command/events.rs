//! What is said with `--json`: an object a line. `tools/events.schema.json` tells all of their keys.

use std::path::Path;
use std::time::Duration;

use abbe::film::replace_file;
use abbe::plan::Plan;
use abbe::{Diagnostic, Error, Image, Lines, PlanAccount, RenderAccount, Result};
use serde::{Serialize, Serializer};

use super::problem::problem;
use super::stdout::tell;

/// Something that happened or was found out.
#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Event<'e> {
    /// The scene is right.
    Checked {
        #[serde(serialize_with = "shown")]
        scene: &'e Path,
        objects: usize,
    },
    /// A frame begins, the `number`th of `count`.
    Frame { frame: u32, number: u64, count: u64 },
    /// How it will be rendered.
    Plan(PlanAccount<'e>),
    /// How far it is, in camera samples; a photon counts as the samples that take as long.
    Progress { done: u64, total: u64, seconds: f64, seconds_left: Option<f64> },
    /// What rendering noticed.
    Report(Box<RenderAccount<'e>>),
    /// A file that was written.
    Written {
        #[serde(serialize_with = "shown")]
        path: &'e Path,
    },
    /// Words for people.
    Note { message: &'e str },
    /// Something to know that stops nothing.
    Warning { message: &'e str },
    /// What went wrong.
    Error { message: String, file: Option<String>, line: Option<usize>, column: Option<usize>, help: Option<&'e str> },
}

/// All that is known of a render, for a file.
#[derive(Serialize)]
struct Account<'e> {
    plan: Event<'e>,
    report: Event<'e>,
    /// The files that were written.
    written: Vec<String>,
}

/// A path as people read it: one that is no text has no other form.
fn shown<S: Serializer>(path: &Path, serializer: S) -> std::result::Result<S::Ok, S::Error> {
    serializer.collect_str(&path.display())
}

/// Writes all that is known of a render as JSON: what `--json` says of its plan and its end.
///
/// # Errors
/// If it cannot be written; a file that was there before is then untouched.
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

    /// All that an error says.
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
        }
    }

    /// The event as a line of JSON; none where a path in it is no text.
    pub fn line(&self) -> Option<String> {
        serde_json::to_string(self).ok()
    }

    /// Says it on stdout. Where nobody listens the work goes on.
    pub fn tell(&self) {
        self.line().iter().for_each(|line| tell(line));
    }
}

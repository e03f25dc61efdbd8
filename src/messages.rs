//! What the command says to the person who runs it, on stderr.

use std::io::{ErrorKind, IsTerminal, Write};
use std::path::Path;

use abbe::trace::Report;
use abbe::{Diagnostic, Error};
use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

/// One plain line.
pub fn say(line: &str) {
    eprintln!("{line}");
}

/// What was asked for, a line each, on stdout. A reader that stops listening ends it without a word.
pub fn answer(lines: &[String]) {
    let mut stdout = std::io::stdout().lock();
    let _ = lines.iter().try_for_each(|line| writeln!(stdout, "{line}"));
}

/// Something to know that stops nothing.
pub fn warn(message: &str) {
    eprintln!("warning: {message}");
}

/// What went wrong, where, and what to do.
pub fn print_error(error: &Error) {
    match error {
        Error::Scene(diagnostic) => eprintln!("{}", underlined(diagnostic)),
        Error::Arguments { message, help } => {
            eprintln!("error: {message}");
            help.iter().for_each(|help| eprintln!("help: {help}"));
        }
        Error::Io { doing, path, source } => eprintln!("error: cannot {doing} {}: {}", path.display(), reason(source)),
        other => eprintln!("error: {other}"),
    }
}

/// What the system said, in plain words where it is terse.
fn reason(error: &std::io::Error) -> String {
    match error.kind() {
        ErrorKind::NotFound => "its folder does not exist and cannot be made".into(),
        ErrorKind::AlreadyExists | ErrorKind::NotADirectory => "a file stands where its folder should be".into(),
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => "permission is denied".into(),
        ErrorKind::StorageFull => "the disk is full".into(),
        _ => error.to_string(),
    }
}

/// The mistake with its line, the word underlined.
fn underlined(diagnostic: &Diagnostic) -> String {
    let path = diagnostic.file.display().to_string();
    // An empty span, as at the end of a file, is shown as one column.
    let end = diagnostic.span.end.max(diagnostic.span.start).min(diagnostic.text.len());
    let start = diagnostic.span.start.min(end);
    let snippet = Snippet::source(&diagnostic.text).path(path).annotation(AnnotationKind::Primary.span(start..end));
    let mut group = Level::ERROR.primary_title(diagnostic.message.as_str()).element(snippet);
    if let Some(help) = &diagnostic.help {
        group = group.element(Level::HELP.message(help.as_str()));
    }
    let renderer = if std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none() {
        Renderer::styled()
    } else {
        Renderer::plain()
    };
    renderer.render(&[group])
}

/// What the render noticed and where the image is.
pub fn print_report(report: &Report, exr: &Path, png: Option<&Path>) {
    if let Some([x, y, sample]) = report.first_non_finite {
        warn(&format!(
            "{} samples were not finite and are left out; the first is sample {sample} of pixel ({x}, {y})",
            report.non_finite
        ));
    }
    if report.unmatched > 0 {
        warn(&format!(
            "{} times light left a clear body it had not entered and went straight on: is a dielectric mesh open?",
            report.unmatched
        ));
    }
    if report.dropped + report.stopped > 0.0 {
        say(&format!("branches that were not followed: {:.1e} of the weight", report.dropped + report.stopped));
    }
    if report.by_chance > 0 {
        warn(&format!(
            "in {} of {} camera samples light had too many ways to follow all, and went on by chance: these pixels have noise",
            report.by_chance, report.samples
        ));
    }
    if report.polarization_of_tile > TOLD {
        let [all, tile] = [report.polarization, report.polarization_of_tile].map(|share| 100.0 * share);
        let tile = if tile > 1.05 * all { format!(", up to {tile:.1} % in 16 x 16 pixels") } else { String::new() };
        say(&format!("polarization may change up to {all:.1} % of the light seen{tile}: it is not traced"));
    }
    for path in [Some(exr), png].into_iter().flatten() {
        say(&format!("wrote {}", path.display()));
    }
}

/// The share of the light from which on it is said what polarization may change.
const TOLD: f64 = 0.01;

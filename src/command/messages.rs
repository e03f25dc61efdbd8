//! Messages of the command: on stderr for the person who runs it, as JSON on stdout for a program.
//!
//! If nobody can be told, because stderr is a closed pipe or the disk is full, messages are dropped and the work goes
//! on.

use std::io::{ErrorKind, IsTerminal, Write};
use std::path::Path;
use std::sync::OnceLock;
use std::time::Duration;

use abbe::film::Format;
use abbe::look::{Misexposure, percent};
use abbe::plan::Plan;
use abbe::trace::FIRST_LOOK;
use abbe::{Diagnostic, Error, Image, ImageError, Result};
use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use clap::ValueEnum;

use super::error_text::{problem, reason};
use super::events::Event;
use super::openjd;
use super::stdout;

/// The reader of the messages.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Listener {
    /// A person.
    Person,
    /// A person who wants only warnings and errors.
    Quiet,
    /// A program.
    Program,
    /// A farm that runs a task of Open Job Description. Messages for people go to its log.
    Farm,
}

/// The lines by which progress is reported on stdout.
#[derive(Clone, Copy, ValueEnum)]
pub enum Protocol {
    /// Open Job Description
    Openjd,
}

static LISTENER: OnceLock<Listener> = OnceLock::new();

/// Chooses the reader of all messages from now on. Only the first call has an effect.
pub fn set_listener(listener: Listener) {
    let _ = LISTENER.set(listener);
}

pub fn listener() -> Listener {
    *LISTENER.get().unwrap_or(&Listener::Person)
}

/// The maximum number of mistakes in a scene that are shown.
const MAX_SHOWN_MISTAKES: usize = 20;

/// Prints one plain line, or several, unless the reader wants only warnings and errors.
pub fn say(line: &str) {
    match listener() {
        Listener::Person => print(line),
        Listener::Quiet => {}
        Listener::Program => Event::Note { message: line }.print(),
        Listener::Farm => openjd::status(line),
    }
}

/// Reports that one of several frames begins.
pub fn say_frame(frame: u32, number: u64, count: u64) {
    match listener() {
        Listener::Program => Event::Frame { frame, number, count }.print(),
        _ => say(&format!("frame {frame}, {number} of {count}")),
    }
}

/// Prints a line and ends the process. Holds a lock until then, so that other threads print nothing after it.
pub fn say_and_exit(line: &str, code: u8) -> ! {
    let _stderr = std::io::stderr().lock();
    // A thread that is sending an image to stdout holds this lock, and must not delay the end.
    let _stdout = matches!(listener(), Listener::Program | Listener::Farm).then(|| std::io::stdout().lock());
    say(line);
    std::process::exit(code.into())
}

fn print(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

/// Prints an answer on stdout. If the reader stops reading, this is no error.
///
/// # Errors
/// If the answer cannot be written for another reason.
pub fn answer(text: &str) -> Result<()> {
    let mut stdout = std::io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(source) if source.kind() != ErrorKind::BrokenPipe => {
            Err(Error::Io { doing: "write", path: "the answer to stdout".into(), source })
        }
        _ => Ok(()),
    }
}

/// Prints lines as an answer on stdout.
///
/// # Errors
/// The errors of [`answer`].
pub fn answer_lines(lines: &[String]) -> Result<()> {
    answer(&lines.iter().flat_map(|line| [line, "\n"]).collect::<String>())
}

/// Sends an image to stdout, all of which has to arrive.
///
/// # Errors
/// If the image cannot be written, or is not read to its end.
pub fn send_image(image: &[u8]) -> Result<()> {
    let mut stdout = std::io::stdout().lock();
    let sent = stdout.write_all(image).and_then(|()| stdout.flush());
    sent.map_err(|source| Error::Io { doing: "write", path: "the image to stdout".into(), source })
}

/// Joins the cells of each line. Each column is as wide as its widest cell.
pub fn align_columns(lines: &[Vec<String>]) -> Vec<String> {
    let width = |column: usize| lines.iter().map(|cells| cells[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<_> = (0..lines.first().map_or(0, Vec::len)).map(width).collect();
    let line = |cells: &Vec<String>| {
        let padded: Vec<_> = cells.iter().zip(&widths).map(|(cell, &width)| format!("{cell:width$}")).collect();
        padded.join("  ").trim_end().to_owned()
    };
    lines.iter().map(line).collect()
}

/// Prints a warning, which stops nothing.
pub fn warn(message: &str) {
    match listener() {
        Listener::Program => Event::Warning { message }.print(),
        _ => print(&format!("warning: {message}")),
    }
}

/// Warns of values that were too large for the file, if there are any.
pub fn warn_of_clamped(format: &Format, clamped: u64) {
    if clamped > 0 {
        let lossless = if format.compression.is_of_16_bits() { " with compression = \"zip\"" } else { "" };
        let [values, them] = if clamped == 1 { ["value was", "it"] } else { ["values were", "them"] };
        warn(&format!(
            "{clamped} {values} too bright for 16 bits and became 65504: precision = \"float\"{lossless} keeps {them}"
        ));
    }
}

/// Suggests a better exposure if nearly all of a picture is white or black. `exr` is the file of the image.
pub fn warn_of_exposure(image: &Image, png: &Path, exr: Option<&Path>, stops: f64) {
    let Some(found) = Misexposure::of_film(image.film(), stops) else { return };
    let (png, flag) = (png.display(), format!("--exposure {}", found.stops));
    let again = exr.map_or(flag.clone(), |exr| format!("`render view {} --png {png} {flag}`", exr.display()));
    warn(&format!("{}: {again} shows more", found.shows.told_of(&png.to_string())));
}

/// Returns whether lines for a program were lost, and reports this on stderr.
pub fn has_lost_lines() -> bool {
    let write_error = stdout::write_error();
    write_error
        .iter()
        .for_each(|why| print(&format!("error: cannot write all output to stdout: {}", reason("write", why))));
    write_error.is_some()
}

/// Prints what went wrong, where, and what to do about it.
pub fn print_error(error: &Error) {
    if listener() == Listener::Farm {
        openjd::fail(&summary(error));
    }
    match error {
        _ if listener() == Listener::Program => Event::errors(error).iter().for_each(Event::print),
        Error::Scene(mistakes) => print_mistakes(mistakes),
        Error::Arguments { message, help } => {
            print(&format!("error: {message}"));
            help.iter().for_each(|help| print(&format!("help: {help}")));
        }
        other => print(&format!("error: {}", problem(other))),
    }
}

/// Describes an error in one line.
fn summary(error: &Error) -> String {
    let Error::Scene(mistakes) = error else { return problem(error) };
    let [first, more @ ..] = &**mistakes else { return problem(error) };
    let (line, column) = first.line_and_column();
    let more = if more.is_empty() { String::new() } else { format!(", and {} more", more.len()) };
    format!("{}:{line}:{column}: {}{more}", first.file.display(), first.message)
}

/// Prints the mistakes in a scene, in the order of its files, and their number if there are several.
fn print_mistakes(mistakes: &[Diagnostic]) {
    let shown = &mistakes[..mistakes.len().min(MAX_SHOWN_MISTAKES)];
    print(&shown.iter().map(underlined_mistake).collect::<Vec<_>>().join("\n\n"));
    let (count, more) = (mistakes.len(), mistakes.len() - shown.len());
    if count < 2 {
        return;
    }
    let mut files: Vec<_> = mistakes.iter().map(|mistake| mistake.file.display().to_string()).collect();
    files.dedup();
    let more = if more > 0 { format!(": these and {more} more") } else { String::new() };
    print(&format!("\n{count} mistakes in {}{more}", files.join(", ")));
}

/// Returns a mistake with its line in the file, where the wrong part is underlined.
fn underlined_mistake(diagnostic: &Diagnostic) -> String {
    let path = diagnostic.file.display().to_string();
    // An empty span, as at the end of a file, is shown as one column.
    let end = diagnostic.span.end.max(diagnostic.span.start).min(diagnostic.text.len());
    let start = diagnostic.span.start.min(end);
    let snippet = Snippet::source(&*diagnostic.text).path(path).annotation(AnnotationKind::Primary.span(start..end));
    let mut group = Level::ERROR.primary_title(diagnostic.message.as_str()).element(snippet);
    if let Some(help) = &diagnostic.help {
        group = group.element(Level::HELP.message(help.as_str()));
    }
    let renderer = if is_colored(&std::io::stderr()) { Renderer::styled() } else { Renderer::plain() };
    renderer.render(&[group])
}

/// Returns whether text written to a stream may have colors.
pub fn is_colored(stream: &impl IsTerminal) -> bool {
    stream.is_terminal() && std::env::var_os("NO_COLOR").is_none()
}

/// Prints an event as the whole answer to a program.
fn answer_event(event: &Event) -> Result<()> {
    event.line().map_or(Ok(()), |line| answer_lines(&[line]))
}

/// Reports that a scene has no mistakes.
///
/// # Errors
/// If a program reads the answer, and it cannot be written.
pub fn print_checked(scene: &Path, objects: usize) -> Result<()> {
    if listener() == Listener::Program {
        return answer_event(&Event::Checked { scene, objects });
    }
    let what = if objects == 1 { "object" } else { "objects" };
    say(&format!("{} is a valid scene: {objects} {what}", scene.display()));
    Ok(())
}

/// Prints on stdout how a scene would be rendered.
///
/// # Errors
/// The errors of [`answer`].
pub fn answer_plan(plan: &Plan) -> Result<()> {
    match listener() {
        Listener::Program => answer_event(&Event::plan(plan)),
        _ => answer_lines(&plan.because),
    }
}

/// Prints how a scene is rendered. On a terminal, prints only how long it takes, how accurate it is and what is left
/// out.
pub fn print_plan(plan: &Plan) {
    match listener() {
        Listener::Program => Event::plan(plan).print(),
        Listener::Farm => plan.because.iter().for_each(|line| print(line)),
        _ if std::io::stderr().is_terminal() => {
            plan.because.iter().take(plan.summary_lines).for_each(|line| say(line));
            say("(--plan explains how and why)");
        }
        _ => plan.because.iter().for_each(|line| say(line)),
    }
}

/// Reports that a file was written.
pub fn print_written(path: &Path) {
    match listener() {
        Listener::Program => Event::Written { path }.print(),
        _ => say(&format!("wrote {}", path.display())),
    }
}

/// Describes in one line the error of an image that is being rendered. `more` holds the total number of samples per
/// pixel that will be taken and the time left, if they are known.
pub fn error_so_far(error: &ImageError, more: Option<&(u32, String)>) -> String {
    let goal = error.requested.map_or(String::new(), |goal| format!("; {} is asked for", percent(goal)));
    let more =
        more.map_or(String::new(), |(samples, left)| format!("; about {samples} samples will be taken, {left} left"));
    let bound = percent(error.at_most());
    let rare = error.noise.outlier.map_or("", |_| ", as some light is rare");
    format!("{} samples per pixel: the image is off by at most {bound}{rare}{goal}{more}", error.noise.samples)
}

/// Prints the error of a finished image, its sources and where the noise is worst.
fn print_error_of_image(error: &ImageError) {
    let noise = &error.noise;
    let [at_most, expected, model_error] = [error.at_most(), noise.expected, error.model].map(percent);
    let blur = match error.blur.at_most {
        0.0 => String::new(),
        at_most => format!(", blur of photons {}", percent(at_most)),
    };
    let alpha = error.alpha.map_or(String::new(), |alpha| format!(", alpha {}", percent(alpha.at_most)));
    let rest = noise.outlier.map_or("noise", |_| "noise and rare light");
    let parts = format!("color {model_error}{blur}{alpha}, the rest {rest}");
    let bound = format!("at most {at_most} in 95 of 100 renders ({parts})");
    say(&format!("{} samples per pixel: the image is off by {bound}", noise.samples));
    let ([x, y], worst) = (noise.worst_tile.corner, percent(noise.worst_tile.expected));
    let alpha = error.alpha.map_or(String::new(), |alpha| format!("; that of alpha is {}", percent(alpha.expected)));
    say(&format!(
        "noise is about {expected} of the image's brightness, and {worst} in the 16 x 16 pixels from ({x}, {y}){alpha}"
    ));
}

/// Prints the warnings and the report of a finished render.
pub fn print_report(image: &Image, plan: &Plan, took: Duration, expected: Duration) {
    let report = image.report();
    if listener() == Listener::Program {
        Event::report(image, took, expected).print();
    }
    image.warnings().iter().for_each(|warning| warn(warning));
    match (image.error(), report.stopped_by) {
        (Some(error), _) => print_error_of_image(error),
        (None, Some(_)) => {
            say(&format!("the error cannot be estimated from fewer than {FIRST_LOOK} samples per pixel"))
        }
        (None, None) => {}
    }
    if listener() == Listener::Program {
        return;
    }
    if report.dropped + report.stopped > 0.0 {
        let share = percent(report.dropped + report.stopped);
        say(&format!("paths that were not followed to their ends: {share} of the weight"));
    }
    // If the plan has measured the effect of polarization, the bound adds nothing.
    if report.polarization_of_tile > MIN_REPORTED_POLARIZATION && plan.polarization_error.is_none() {
        let is_uneven = report.polarization_of_tile > 1.05 * report.polarization;
        let [all, tile] = [report.polarization, report.polarization_of_tile].map(at_most);
        let tile = if is_uneven && tile != all { format!(", and {tile} in 16 x 16 pixels") } else { String::new() };
        say(&format!(
            "polarization is not traced: it may change {all} of the light seen{tile}; render.polarization = \"on\" traces it"
        ));
    }
}

/// Returns a bound in words. A bound of 1 or more limits nothing.
fn at_most(share: f64) -> String {
    if share < 1.0 { format!("at most {:.1} %", 100.0 * share) } else { "most".into() }
}

/// The share of the light that polarization may change without being reported.
const MIN_REPORTED_POLARIZATION: f64 = 0.01;

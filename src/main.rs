//! The `render` command: read, compile, plan, render, write.

mod command;

use std::collections::HashSet;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use abbe::plan::plan;
use abbe::scene::Source;
use abbe::{Error, Image, Rendering, Result, Scene, write_plan};

use command::cli::{self, Job, Jobs, Output, Request};
use command::events::{Event, write_account};
use command::outputs::{Folders, check_not_input, check_outputs, check_stdout, check_text_file, is_stdio};
use command::saving::Saver;
use command::{catalog, diff, info, merge, messages, progress, signals, view};

fn main() -> ExitCode {
    signals::ignore_file_size_signal();
    let outcome = cli::parse().and_then(|request| match request {
        Request::Render(jobs) => run(&jobs),
        Request::Answer(text) => messages::answer(&text).map(|()| ExitCode::SUCCESS),
        Request::Catalog(query) => print_lines(catalog::lines(&query, std::io::stdout().is_terminal())),
        Request::Info(query) => print_lines(info::lines(&query)),
        Request::View(query) => view::run(&query).map(|()| ExitCode::SUCCESS),
        Request::Merge(query) => merge::run(&query).map(|()| ExitCode::SUCCESS),
        Request::Diff(query) => Ok(diff::run(&query)),
    });
    let code = outcome.unwrap_or_else(|error| {
        messages::print_error(&error);
        ExitCode::from(error.exit_code())
    });
    if messages::has_lost_lines() && code == ExitCode::SUCCESS { ExitCode::FAILURE } else { code }
}

fn print_lines(lines: Result<Vec<String>>) -> Result<ExitCode> {
    messages::answer_lines(&lines?).map(|()| ExitCode::SUCCESS)
}

/// Checks, plans or renders one frame after another, until one is stopped.
fn run(jobs: &Jobs) -> Result<ExitCode> {
    jobs.saving().catch_signals()?;
    if let Some(threads) = jobs.threads() {
        // Planning without a render and writing files use the global threads, as each render has threads of its own.
        rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    }
    let (mut read, mut warned, count) = (None, HashSet::new(), jobs.count());
    for (number, job) in (1..=count).zip(jobs.each()) {
        if signals::begin_image() {
            messages::say("stopped between two frames");
            return Ok(ExitCode::from(signals::STOPPED_CODE));
        }
        let job = job?;
        let source = match &mut read {
            Some(source) => source,
            none if is_stdio(&job.scene) => none.insert(Source::standard_input()?),
            none => none.insert(Source::read(&job.scene)?),
        };
        if let Some(frame) = job.frame.filter(|_| count > 1) {
            messages::say_frame(frame, number, count);
        }
        if number == 1 {
            check_end_frames(jobs, &job, source)?;
        }
        let code = run_job(&job, source, &mut warned)?;
        if code != ExitCode::SUCCESS {
            return Ok(code);
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Refuses to render any of several frames if the one with the lowest or the highest number has a mistake. As the
/// values that are allowed mostly form a range, this finds most mistakes before any frame is rendered.
fn check_end_frames(jobs: &Jobs, first: &Job, source: &Source) -> Result<()> {
    if !matches!(first.output, Output::Image { .. }) {
        return Ok(());
    }
    for job in jobs.ends() {
        let job = job?;
        if let (Some(frame), Err(error)) = (job.frame.filter(|_| job.frame != first.frame), check_job(&job, source)) {
            // A mistake that all frames share is reported for the first frame.
            check_job(first, source)?;
            messages::say(&format!("frame {frame} has a mistake, so no frame is rendered"));
            return Err(error);
        }
    }
    Ok(())
}

fn check_job(job: &Job, source: &Source) -> Result<()> {
    job.options.apply(&mut source.compile_with(&job.set)?)
}

/// Checks, plans or renders one frame. Prints each warning only once for all frames.
fn run_job(job: &Job, source: &Source, warned: &mut HashSet<String>) -> Result<ExitCode> {
    let began = Instant::now();
    let mut scene = progress::during("reading the scene", || source.compile_with(&job.set))?;
    // Spectra are only written beside an EXR. A plan that is followed covers them as well, so they stay.
    if let (Output::Image { exr: None, .. }, None) = (&job.output, &job.options.plan) {
        scene.format.spectral = None;
    }
    job.options.apply(&mut scene)?;
    let new_warnings = scene.warnings.iter().filter(|warning| warned.insert((*warning).clone()));
    new_warnings.for_each(|warning| messages::warn(warning));
    match &job.output {
        Output::Check => {
            messages::print_checked(&source.path, scene.objects.len())?;
            Ok(ExitCode::SUCCESS)
        }
        Output::Plan(file) => answer_plan(&scene, file.as_deref()),
        Output::Image { exr, png } => image(job, &scene, [exr.as_deref(), png.as_deref()], began),
    }
}

/// Prints how the scene is rendered, and writes the plan to `file` if one is given.
fn answer_plan(scene: &Scene, file: Option<&Path>) -> Result<ExitCode> {
    let files = Vec::from_iter(file);
    check_outputs(scene, &files)?;
    check_text_file("--plan-file", "frame.plan", file)?;
    let _folders = Folders::of_files(&files)?;
    let plan = progress::during("planning", || plan(scene));
    messages::answer_plan(&plan)?;
    if let Some(file) = file {
        write_plan(&plan, scene, file)?;
        messages::print_written(file);
    }
    Ok(ExitCode::SUCCESS)
}

/// Writes the image to its file, or to standard output. Returns the number of values that were too bright for it.
fn write(image: &Image, exr: &Path) -> Result<u64> {
    if !is_stdio(exr) {
        return image.write_exr(exr);
    }
    let (bytes, clamped) = image.exr_bytes()?;
    messages::send_image(&bytes)?;
    Ok(clamped)
}

/// Renders what an earlier run has not finished of a scene, and writes its files.
fn image(job: &Job, scene: &Scene, [exr, png]: [Option<&Path>; 2], began: Instant) -> Result<ExitCode> {
    let outputs = Outputs::new(job, scene, [exr, png])?;
    let (images, files) = (outputs.images(), outputs.files());
    let main = images.first().copied().unwrap_or(Path::new("image"));
    let checkpoint = job.saving.checkpoint(main);
    let all: Vec<&Path> = images.iter().copied().chain(checkpoint.as_deref()).chain(outputs.report).collect();
    check_outputs(scene, &all)?;
    if let Some(plan) = &job.options.plan {
        all.iter().try_for_each(|output| check_not_input(plan, "plan that is followed", output))?;
    }
    check_text_file("--report", "frame.json", outputs.report)?;
    let _folders = Folders::of_files(&all)?;
    let settings = format!("exposure {:?}, stamp {}", job.exposure, job.options.stamp);
    let mut saver = Saver::new(&job.saving, main, checkpoint, settings)?;
    if saver.has_finished(scene, &job.options, &files) {
        return Ok(ExitCode::SUCCESS);
    }
    let mut rendering = progress::during("planning", || Rendering::new(scene, &job.options))?.since(began);
    messages::print_plan(rendering.plan());
    if !saver.resume(&mut rendering, &files)? {
        return Ok(ExitCode::SUCCESS);
    }
    let progress = progress::Progress::new(&rendering);
    let is_finished = saver.run(&mut rendering, &progress)?;
    if !is_finished {
        drop(progress);
        saver.say_how_to_resume();
        return Ok(ExitCode::from(signals::STOPPED_CODE));
    }
    let took = progress.finish(rendering.expected());
    let written = outputs.write(&rendering, job.exposure, took);
    saver.finish(&rendering, &written.files);
    written.finish()
}

/// The outputs of a render.
struct Outputs<'j> {
    /// The EXR image: a file, or standard output.
    exr: Option<&'j Path>,
    /// The file for a part of the image, which is written instead of `exr`.
    part: Option<PathBuf>,
    spectral: Option<PathBuf>,
    png: Option<&'j Path>,
    report: Option<&'j Path>,
}

impl<'j> Outputs<'j> {
    fn new(job: &'j Job, scene: &Scene, [exr, png]: [Option<&'j Path>; 2]) -> Result<Self> {
        let has_spectra = scene.format.spectral.is_some();
        if exr.is_some_and(is_stdio) {
            check_stdout(has_spectra)?;
            job.saving.check_stdout()?;
        }
        let part = exr.and_then(|exr| job.saving.part(exr));
        let exr = exr.filter(|_| part.is_none());
        let spectral = exr.filter(|_| has_spectra).map(|exr| exr.with_extension("spectral.exr"));
        Ok(Self { exr, part, spectral, png, report: job.report.as_deref() })
    }

    fn exr_file(&self) -> Option<&Path> {
        self.exr.filter(|exr| !is_stdio(exr))
    }

    /// Returns the files of the image, the main one first.
    fn images(&self) -> Vec<&Path> {
        let images = [self.part.as_deref(), self.exr_file(), self.spectral.as_deref(), self.png];
        images.into_iter().flatten().collect()
    }

    /// Returns all files.
    fn files(&self) -> Vec<&Path> {
        self.images().into_iter().chain(self.report).collect()
    }

    /// Writes all outputs of a finished render, and prints its warnings and its report.
    fn write(&self, rendering: &Rendering, exposure: f64, took: Duration) -> Written<'_> {
        let mut written = Written::default();
        written.file(self.part.as_deref(), |part| rendering.write_part(part));
        let image = if self.part.is_some() { rendering.summary() } else { rendering.image() };
        written.file(self.exr, |exr| {
            messages::warn_of_clamped(image.format(), write(&image, exr)?);
            Ok(())
        });
        written.file(self.spectral.as_deref(), |spectral| image.write_spectral_exr(spectral));
        written.file(self.png, |png| {
            image.write_png(png, exposure)?;
            messages::warn_of_exposure(&image, png, self.exr_file(), exposure);
            Ok(())
        });
        let (plan, expected) = (rendering.plan(), rendering.expected());
        messages::print_report(&image, plan, took, expected);
        let images = written.files.clone();
        written.file(self.report, |report| {
            write_account(report, Event::plan(plan), Event::report(&image, took, expected), &images)
        });
        written
    }
}

/// The files of an image that were written, and the errors of those that were not. One failure does not keep the other
/// files from being written.
#[derive(Default)]
struct Written<'f> {
    files: Vec<&'f Path>,
    errors: Vec<Error>,
}

impl<'f> Written<'f> {
    fn file(&mut self, file: Option<&'f Path>, write: impl FnOnce(&Path) -> Result<()>) {
        let Some(file) = file else { return };
        match write(file) {
            Ok(()) if is_stdio(file) => {}
            Ok(()) => {
                signals::note_written();
                self.files.push(file);
            }
            Err(error) => self.errors.push(error),
        }
    }

    /// Prints the names of the written files, and all errors but the last one, which it returns.
    fn finish(mut self) -> Result<ExitCode> {
        self.files.into_iter().for_each(messages::print_written);
        let last = self.errors.pop();
        self.errors.iter().for_each(messages::print_error);
        last.map_or(Ok(ExitCode::SUCCESS), Err)
    }
}

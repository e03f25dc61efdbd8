//! The `render` command: read, compile, plan, render, write.

mod catalog;
mod cli;
mod diff;
mod events;
mod frames;
mod info;
mod manual;
mod messages;
mod outputs;
mod progress;
mod view;

use std::path::Path;
use std::process::ExitCode;

use abbe::film::check_writable;
use abbe::plan::plan;
use abbe::scene::Source;
use abbe::{Rendering, Result, Scene};

use cli::{Job, Output, Request};
use outputs::{check_standard, is_standard, spare};

fn main() -> ExitCode {
    let answered = cli::parse().and_then(|request| match request {
        Request::Render(job) => run(&job).map(|()| ExitCode::SUCCESS),
        Request::Answer(text) => messages::answer(&text).map(|()| ExitCode::SUCCESS),
        Request::Catalog(query) => listed(catalog::lines(&query)),
        Request::Info(query) => listed(info::lines(&query)),
        Request::View(query) => view::run(&query).map(|()| ExitCode::SUCCESS),
        Request::Diff(query) => Ok(diff::run(&query)),
    });
    answered.unwrap_or_else(|error| {
        messages::print_error(&error);
        ExitCode::from(error.exit_code())
    })
}

fn listed(lines: Result<Vec<String>>) -> Result<ExitCode> {
    messages::answer_lines(&lines?).map(|()| ExitCode::SUCCESS)
}

fn run(job: &Job) -> Result<()> {
    let source = if is_standard(&job.scene) { Source::standard_input() } else { Source::read(&job.scene) }?;
    let mut scene = source.compile_with(&job.set)?;
    if let Output::Image { exr: None, .. } = job.output {
        scene.format.spectral = None;
    }
    job.options.apply(&mut scene)?;
    scene.warnings.iter().for_each(|warning| messages::warn(warning));
    match &job.output {
        Output::Check => {
            messages::print_checked(&source.path, scene.objects.len());
            Ok(())
        }
        Output::Plan => messages::answer_plan(&plan(&scene)),
        Output::Image { exr, png } => image(job, &scene, exr.as_deref(), png.as_deref()),
    }
}

fn image(job: &Job, scene: &Scene, exr: Option<&Path>, png: Option<&Path>) -> Result<()> {
    let exr_file = exr.filter(|exr| !is_standard(exr));
    let spectral = exr_file.filter(|_| scene.format.spectral.is_some()).map(|exr| exr.with_extension("spectral.exr"));
    let outputs = || [exr_file, spectral.as_deref(), png].into_iter().flatten();
    if exr_file != exr {
        check_standard(scene.format.spectral.is_some())?;
    }
    outputs().try_for_each(|output| spare(&job.scene, "scene", output))?;
    outputs().try_for_each(check_writable)?;
    let rendering = Rendering::new(scene, &job.options)?;
    messages::print_plan(rendering.plan());
    let (progress, expected) = (progress::Progress::new(rendering.work()), rendering.expected());
    let image = rendering.run(&|done| progress.advance(done));
    let took = progress.finish(expected);
    if exr.is_some() {
        let clamped = match exr_file {
            Some(exr) => image.write_exr(exr)?,
            None => {
                let (bytes, clamped) = image.exr_bytes()?;
                messages::send(&bytes)?;
                clamped
            }
        };
        warn_of_clamped(clamped, scene);
    }
    spectral.as_ref().map_or(Ok(()), |spectral| image.write_spectral_exr(spectral))?;
    png.map_or(Ok(()), |png| image.write_png(png, job.exposure))?;
    messages::print_report(image.report(), took, expected);
    outputs().for_each(messages::print_written);
    Ok(())
}

fn warn_of_clamped(clamped: u64, scene: &Scene) {
    if clamped > 0 {
        let lossless = if scene.format.compression.is_of_16_bits() { " with compression = \"zip\"" } else { "" };
        messages::warn(&format!(
            "{clamped} values were too bright for 16 bits and became 65504: precision = \"float\"{lossless} keeps them"
        ));
    }
}

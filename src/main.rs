//! The `render` command: read, compile, plan, render, write.

mod catalog;
mod cli;
mod diff;
mod info;
mod messages;
mod outputs;
mod progress;
mod view;

use std::path::Path;
use std::process::ExitCode;

use abbe::film::check_writable;
use abbe::plan::plan;
use abbe::{Rendering, Result, Scene};

use cli::{Job, Output, Request};
use outputs::spare;

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
    let mut scene = Scene::read(&job.scene)?;
    if let Output::Image { exr: None, .. } = job.output {
        scene.format.spectral = None;
    }
    job.options.apply(&mut scene)?;
    scene.warnings.iter().for_each(|warning| messages::warn(warning));
    match &job.output {
        Output::Check => {
            let count = scene.objects.len();
            let objects = if count == 1 { "object" } else { "objects" };
            messages::say(&format!("{} is a valid scene: {count} {objects}", job.scene.display()));
            Ok(())
        }
        Output::Plan => messages::answer_lines(&plan(&scene).because),
        Output::Image { exr, png } => image(job, &scene, exr.as_deref(), png.as_deref()),
    }
}

fn image(job: &Job, scene: &Scene, exr: Option<&Path>, png: Option<&Path>) -> Result<()> {
    let spectral = exr.filter(|_| scene.format.spectral.is_some()).map(|exr| exr.with_extension("spectral.exr"));
    let outputs = || [exr, spectral.as_deref(), png].into_iter().flatten();
    outputs().try_for_each(|output| spare(&job.scene, "scene", output))?;
    outputs().try_for_each(check_writable)?;
    let rendering = Rendering::new(scene, &job.options)?;
    rendering.plan().because.iter().for_each(|line| messages::say(line));
    let (progress, expected) = (progress::Progress::new(rendering.work()), rendering.expected());
    let image = rendering.run(&|done| progress.advance(done));
    progress.finish(expected);
    if let Some(exr) = exr {
        let clamped = image.write_exr(exr)?;
        if clamped > 0 {
            let lossless = if scene.format.compression.is_of_16_bits() { " with compression = \"zip\"" } else { "" };
            messages::warn(&format!(
                "{clamped} values were too bright for 16 bits and became 65504: precision = \"float\"{lossless} keeps them"
            ));
        }
    }
    spectral.as_ref().map_or(Ok(()), |spectral| image.write_spectral_exr(spectral))?;
    png.map_or(Ok(()), |png| image.write_png(png, job.exposure))?;
    messages::print_report(image.report(), outputs());
    Ok(())
}

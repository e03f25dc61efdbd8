//! The `render` command: read, compile, plan, render, write.

mod catalog;
mod cli;
mod messages;
mod progress;

use std::path::Path;
use std::process::ExitCode;

use abbe::Result;
use abbe::film::{Fact, Provenance, View, check_writable, write_exr, write_png};
use abbe::plan::{Plan, plan};
use abbe::scene::{Projection, Scene, Source, compile};
use abbe::spectrum::{Basis, Curve};
use abbe::trace::{World, render, work};

use cli::{Job, Output, Request};

fn main() -> ExitCode {
    let answered = cli::parse().and_then(|request| match request {
        Request::Render(job) => run(&job),
        Request::Answer(text) => messages::answer(&text),
        Request::Catalog(query) => catalog::lines(&query).and_then(|lines| messages::answer_lines(&lines)),
    });
    match answered {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            messages::print_error(&error);
            ExitCode::from(error.exit_code())
        }
    }
}

fn run(job: &Job) -> Result<()> {
    let source = Source::read(&job.scene)?;
    let mut description = source.parse()?;
    job.apply(&mut description.render);
    let mut scene = compile(&description, &source)?;
    job.crop(&mut scene.film)?;
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

fn image(job: &Job, scene: &Scene<Curve>, exr: Option<&Path>, png: Option<&Path>) -> Result<()> {
    let outputs = || [exr, png].into_iter().flatten();
    outputs().try_for_each(|output| job.spares_scene(output))?;
    outputs().try_for_each(check_writable)?;
    let plan = job.on_threads(|| plan(scene));
    plan.because.iter().for_each(|line| messages::say(line));
    let world = World::new(scene, plan.method.clone());
    let progress = progress::Progress::new(work(&world));
    let (film, report) = job.on_threads(|| render(&world, &|done| progress.advance(done)));
    progress.finish();
    if let Some(exr) = exr {
        write_exr(&film, &view(scene), &provenance(scene, &plan, report.non_finite), exr)?;
    }
    if let Some(png) = png {
        write_png(&film, job.exposure, png)?;
    }
    messages::print_report(&report, exr, png);
    Ok(())
}

fn view(scene: &Scene<Curve>) -> View {
    let camera = &scene.camera;
    View {
        world_to_camera: camera.world_to_camera(),
        screen_window_width: camera.screen_window_width(),
        screen_window_center: camera.screen_window_center(),
        latlong: camera.projection() == Projection::Equirectangular,
    }
}

/// Where the fixed lanes read spectra, in nm.
fn wavelengths(basis: &Basis) -> String {
    let shown: Vec<String> = basis.wavelengths_nm().iter().map(f64::to_string).collect();
    shown.join(" ")
}

fn provenance(scene: &Scene<Curve>, plan: &Plan, non_finite: u64) -> Provenance {
    let text = |text: &str| Fact::Text(text.to_owned());
    let projection = scene.camera.projection().name();
    let pass = plan.method.light_pass.as_ref();
    let photons = pass.map(|pass| ("photons", Fact::Count(pass.photons)));
    let blur = pass.and_then(|pass| pass.map).map(|map| ("photonRadius", text(&format!("{:.3} pixels", map.radius))));
    Provenance {
        facts: [
            ("version", text(env!("CARGO_PKG_VERSION"))),
            ("sceneHash", text(&scene.hash)),
            ("model", text(&plan.method.basis.name())),
            ("wavelengths", text(&wavelengths(&plan.method.basis))),
            ("projection", text(projection)),
            ("transport", text(plan.method.transport.name())),
            ("filter", text(&scene.film.filter.described())),
            ("samples", Fact::Count(plan.method.samples.into())),
            ("seed", text(&plan.method.seed.to_string())),
            ("nonFinite", Fact::Count(non_finite)),
        ]
        .into_iter()
        .chain(photons)
        .chain(blur)
        .collect(),
    }
}

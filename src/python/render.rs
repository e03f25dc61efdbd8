//! Renders and plans.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use abbe::film::check_writable;
use abbe::scene;
use abbe::trace::Advance;
use abbe::{Error, Options, PlanAccount, RenderAccount, Rendering, Result, Resumed, Timer, is_checkpoint};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;

use super::errors::{bug_error, for_python, refuse, to_exception};
use super::image::Image;
use super::options::{options, time};
use super::scene::Scene;
use super::work::{self, Work};

/// The time between two reports of progress.
const PERIOD: Duration = Duration::from_millis(500);
/// The maximum time to wait for a stopped render that keeps nothing.
const PATIENCE: Duration = Duration::from_millis(500);

/// Plans a render, and returns the plan as JSON and the number of threads that it would use.
#[pyfunction]
pub(super) fn plan(py: Python<'_>, scene: &Scene, settings: &Bound<'_, PyDict>) -> PyResult<(String, usize)> {
    let (scene, options) = (scene.0.clone(), options(settings)?);
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = options.threads.unwrap_or(processors).clamp(1, processors);
    let planned = move || -> Result<String> {
        let mut scene = (*scene).clone();
        options.apply(&mut scene)?;
        json(&PlanAccount::new(&abbe::plan::plan(&scene)))
    };
    Ok((work::run(py, planned)?.map_err(to_exception)?, threads))
}

/// Renders a scene. Calls `progress` with the work done, all work, and the seconds since the render began.
#[pyfunction]
pub(super) fn render(
    py: Python<'_>,
    scene: &Scene,
    settings: &Bound<'_, PyDict>,
    progress: Option<Bound<'_, PyAny>>,
    checkpoint: Option<PathBuf>,
    every: &Bound<'_, PyAny>,
    resume: bool,
) -> PyResult<Image> {
    let every = time("every", every)?;
    let state = Arc::new(State::default());
    let checkpoint = checkpoint.map(|path| Checkpoint { path, every, resume });
    if resume && checkpoint.is_none() {
        return refuse("there is no checkpoint to resume from", "name its file: checkpoint=\"image.checkpoint\"");
    }
    let keeps = checkpoint.is_some();
    let job = Job { scene: scene.0.clone(), options: options(settings)?, checkpoint, state: state.clone() };
    let work = Work::begin(move || job.run())?;
    let mut next = Instant::now() + PERIOD;
    let rendered = work.finish(py, &mut || match &progress {
        Some(progress) if Instant::now() >= next && state.has_begun() => {
            next = Instant::now() + PERIOD;
            state.call(progress)
        }
        _ => Ok(()),
    });
    let rendered = rendered.inspect_err(|_| {
        state.stop.store(true, Relaxed);
        // What is done is saved before the exception is raised. A render that has not begun has nothing to save.
        let patience = if keeps && state.has_begun() { Duration::MAX } else { PATIENCE };
        let _ = work.wait(py, patience);
    });
    let image =
        rendered?.map_err(to_exception)?.ok_or_else(|| bug_error("a render stopped although nobody stopped it"))?;
    progress.map_or(Ok(()), |progress| state.call(&progress))?;
    Ok(image)
}

/// What the rendering thread and the waiting thread tell each other.
#[derive(Default)]
struct State {
    stop: AtomicBool,
    done: AtomicU64,
    work: AtomicU64,
    /// When the render began, if it has.
    began: OnceLock<Instant>,
}

impl State {
    /// Reports that a render begins, with the work done so far and the total work. Returns when it began.
    fn begin(&self, done: u64, work: u64) -> Instant {
        self.done.store(done, Relaxed);
        self.work.store(work, Relaxed);
        *self.began.get_or_init(Instant::now)
    }

    fn has_begun(&self) -> bool {
        self.began.get().is_some()
    }

    fn call(&self, progress: &Bound<'_, PyAny>) -> PyResult<()> {
        let seconds = self.began.get().map_or(0.0, |began| began.elapsed().as_secs_f64());
        progress.call1((self.done.load(Relaxed), self.work.load(Relaxed), seconds)).map(drop)
    }
}

struct Checkpoint {
    path: PathBuf,
    every: Duration,
    resume: bool,
}

struct Job {
    scene: Arc<scene::Scene>,
    options: Options,
    checkpoint: Option<Checkpoint>,
    state: Arc<State>,
}

/// The account of a render for Python: its report, its plan and its warnings.
#[derive(Serialize)]
struct Account<'a> {
    #[serde(flatten)]
    report: RenderAccount<'a>,
    plan: PlanAccount<'a>,
    warnings: Vec<String>,
}

impl Job {
    /// Returns the image, or none if the render was stopped.
    fn run(self) -> Result<Option<Image>> {
        let checkpoint = self.checkpoint.as_ref();
        checkpoint.map_or(Ok(()), Checkpoint::check_overwrite)?;
        let mut rendering = Rendering::new(&self.scene, &self.options)?;
        if self.state.stop.load(Relaxed) {
            // Nobody waits any longer, and there is nothing to save.
            return Ok(None);
        }
        checkpoint.map_or(Ok(()), |checkpoint| checkpoint.resume_render(&mut rendering))?;
        let began = self.state.begin(rendering.done(), rendering.work());
        let mut warnings: Vec<_> = self.scene.warnings.iter().map(|warning| for_python(warning)).collect();
        let is_finished = self.advance(&mut rendering, &mut warnings)?;
        let saved = checkpoint.map_or(Ok(()), |checkpoint| rendering.save(&checkpoint.path));
        if !is_finished {
            return saved.map(|()| None);
        }
        // A failure is only a warning, because the image exists all the same.
        warnings.extend(saved.err().map(|error| format!("the render is finished, but {error}")));
        let (took, expected, image) = (began.elapsed(), rendering.expected(), rendering.image());
        warnings.extend(image.warnings());
        let report = RenderAccount::new(&image, took, expected);
        let account = json(&Account { report, plan: PlanAccount::new(rendering.plan()), warnings })?;
        Ok(Some(Image { image: Arc::new(image), account }))
    }

    /// Takes all samples, and saves them now and then. Returns true if all were taken, and false if somebody stopped
    /// the render.
    fn advance(&self, rendering: &mut Rendering, warnings: &mut Vec<String>) -> Result<bool> {
        let state = &self.state;
        let count = |more| {
            state.done.fetch_add(more, Relaxed);
        };
        let mut timer = Timer::new(self.checkpoint.as_ref().map(|checkpoint| checkpoint.every));
        loop {
            let advance = rendering.advance_until(&count, &|| state.stop.load(Relaxed) || timer.is_due());
            state.work.store(rendering.work(), Relaxed);
            if advance == Advance::Finished {
                return Ok(true);
            }
            if state.stop.load(Relaxed) {
                return Ok(false);
            }
            if let Some(checkpoint) = self.checkpoint.as_ref().filter(|_| advance == Advance::Stopped) {
                // The render is worth more than a failed save, so it continues.
                let saved = timer.run(|| rendering.save(&checkpoint.path));
                warnings.extend(saved.err().map(|error| format!("the render went on, but {error}")));
            }
        }
    }
}

impl Checkpoint {
    /// Refuses to overwrite the checkpoint of an earlier run, or a file that is no checkpoint.
    fn check_overwrite(&self) -> Result<()> {
        let name = self.path.display();
        if self.path.is_dir() {
            return Error::refuse(
                format!("the checkpoint {name} is a folder"),
                "name a file, such as \"image.checkpoint\"",
            );
        }
        check_writable(&self.path)?;
        if !self.path.exists() {
            return Ok(());
        }
        if !is_checkpoint(&self.path)? {
            return Error::refuse(
                format!("{name} would be overwritten, but it is not a checkpoint"),
                "name another file",
            );
        }
        match self.resume {
            true => Ok(()),
            false => Error::refuse(
                format!("{name} already exists from an earlier run"),
                "add resume=True to go on from it, or delete it to start over",
            ),
        }
    }

    /// Resumes from the checkpoint of an earlier run, if requested and if there is one.
    fn resume_render(&self, rendering: &mut Rendering) -> Result<()> {
        if !self.resume || !self.path.exists() {
            return Ok(());
        }
        match rendering.resume(&self.path)? {
            Resumed::Continues | Resumed::Finished => Ok(()),
            Resumed::HasMore(samples) => {
                let message = format!("{} has {samples} samples per pixel, more than asked for", self.path.display());
                Error::refuse(message, format!("ask for samples={samples}"))
            }
        }
    }
}

fn json(account: &impl Serialize) -> Result<String> {
    serde_json::to_string(account)
        .map_err(|error| Error::Encode { path: "the report".into(), message: error.to_string() })
}

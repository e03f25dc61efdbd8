//! Renders a scene, step by step.

use std::borrow::Cow;
use std::fmt;
use std::io::ErrorKind;
use std::path::Path;
use std::time::{Duration, Instant, SystemTime};

use super::checkpoint::{self, Finished, Resumed, Written};
use super::identity::Identity;
use super::image::Image;
use super::image_error::ImageError;
use super::options::{Options, check_layers};
use super::part;
use super::plan_file::read_plan;
use super::provenance::{NON_FINITE, SAMPLES, origin};
use super::warnings::dark_warning;
use crate::error::{Error, Result};
use crate::film::{CameraView, Fact, Film, Format, Provenance, Shard};
use crate::plan::{Plan, plan};
use crate::scene::{Projection, RenderText, Scene};
use crate::trace::{self, Advance, Measured, Method, bytes_of_film, prepare, run_on};

/// Renders a scene.
///
/// # Errors
/// The errors of [`Rendering::new`].
pub fn render(scene: &Scene, options: &Options) -> Result<Image> {
    Ok(Rendering::new(scene, options)?.run(&|_| ()))
}

/// A planned render, which runs to its end, or pass by pass with a look at the image after each.
///
/// ```
/// # let scene = abbe::Scene::parse("camera = { position = [0, 0, 4], look_at = [0, 0, 0], vertical_fov = 40 }
/// # film = { width = 8, height = 8 }
/// # light = [{ environment = { radiance = 1 } }]", "")?;
/// let rendering = abbe::Rendering::new(&scene, &abbe::Options::default())?;
/// println!("{}", rendering.plan().because.join("\n"));
/// let all = rendering.work();
/// let done = std::sync::atomic::AtomicU64::new(0);
/// let image = rendering.run(&|more| {
///     let before = done.fetch_add(more, std::sync::atomic::Ordering::Relaxed);
///     println!("{} %", 100 * (before + more) / all);
/// });
/// assert_eq!(done.into_inner(), all);
/// # assert_eq!(image.rgb_at(3, 4), [1.0; 3]);
/// # Ok::<(), abbe::Error>(())
/// ```
pub struct Rendering {
    plan: Plan,
    passes: trace::Rendering<'static>,
    view: CameraView,
    format: Format,
    /// What the image's file records about the render, except for the counts of what it has done.
    provenance: Provenance,
    threads: rayon::ThreadPool,
    /// The identity that another render must have to continue this one.
    identity: Identity,
    shard: Shard,
    /// The requested settings.
    render: RenderText,
    /// When the render began, if the file records it.
    began: Option<Instant>,
    /// The files of the finished render that this one was resumed from.
    written: Vec<Written>,
    /// The amount of work that an earlier run has done.
    resumed_at: u64,
    /// The warning for an image without any light.
    dark_warning: Option<String>,
}

impl fmt::Debug for Rendering {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        let mut shown = formatter.debug_struct("Rendering");
        shown.field("work", &self.work()).field("done", &self.done()).field("plan", &self.plan).finish_non_exhaustive()
    }
}

impl Rendering {
    /// Plans how to render a scene, and prepares it.
    ///
    /// # Errors
    /// [`Error::Arguments`] if the options do not fit the scene, its plan belongs to something else, or threads cannot
    /// be started; [`Error::Decode`] if the plan is damaged; [`Error::Io`] if it cannot be read, or the film does not
    /// fit into memory.
    pub fn new(scene: &Scene, options: &Options) -> Result<Self> {
        let now = Instant::now();
        let began = (options.stamp && options.shard == Shard::WHOLE).then_some(now);
        let mut scene = Cow::Borrowed(scene);
        let threads = options.threads()?;
        let is_unchanged = options.merged_with(&scene)? == (scene.render.clone(), scene.film);
        if is_unchanged && options.layers.is_none() && !options.spectral {
            check_layers(&scene, options.shard)?;
        } else {
            options.apply(scene.to_mut())?;
        }
        let threads = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        let plan = match &options.plan {
            Some(path) => read_plan(path, &scene)?,
            None => run_on(&threads, || plan(&scene)),
        };
        check_memory(&scene, &plan.method, options.shard)?;
        let (world, photon_cost) = (run_on(&threads, || prepare(&scene, plan.method.clone())), plan.photon_cost);
        let camera = &scene.camera;
        let view = CameraView {
            world_to_camera: camera.world_to_camera(),
            world_to_ndc: camera.world_to_ndc(),
            screen_window_width: camera.screen_window_width(),
            screen_window_center: camera.screen_window_center(),
            latlong: camera.projection() == Projection::Equirectangular,
            optics: camera.optics(scene.render.meters_per_unit),
        };
        Ok(Self {
            identity: Identity::new(&scene, &plan.method, options.shard),
            shard: options.shard,
            provenance: origin(&scene, &plan),
            plan,
            passes: trace::Rendering::of_shard(Cow::Owned(world), options.shard)
                .since(now)
                .counting_photons_as(photon_cost),
            view,
            format: scene.format.clone(),
            threads,
            render: scene.render.clone(),
            began,
            written: Vec::new(),
            resumed_at: 0,
            dark_warning: dark_warning(&scene).filter(|_| options.shard == Shard::WHOLE),
        })
    }

    /// Counts the time that the render may take from an earlier moment, such as before the scene was read.
    #[must_use]
    pub fn since(mut self, began: Instant) -> Self {
        self.began = self.began.map(|_| began);
        self.passes = self.passes.since(began);
        self
    }

    /// Returns the plan: how the scene will be rendered, and why.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Returns the amount of work: camera samples, and photons, each of which counts as the number of samples that take
    /// as long. With a stop rule this is an estimate, which improves after each pass. It is the maximum until more [is
    /// known](Self::is_work_known).
    pub fn work(&self) -> u64 {
        self.passes.work()
    }

    /// Returns whether the amount of work is approximately known. If an error is requested and no time, it is not known
    /// before the first look at the noise.
    pub fn is_work_known(&self) -> bool {
        self.passes.is_work_known()
    }

    /// Estimates how long all the [work](Self::work) takes if nothing else keeps the processors busy, without the work
    /// done before the render was resumed.
    pub fn expected(&self) -> Duration {
        let work = self.work().saturating_sub(self.resumed_at);
        let part = work as f64 / self.passes.work_of_all_parts().max(1) as f64;
        self.plan.processor_time.mul_f64(part / self.threads.current_num_threads() as f64)
    }

    /// Renders the next pass, if one is left, and returns whether another one is left. Passes take more and more
    /// samples, or gather photons of their own.
    ///
    /// `progress` receives the amount of [`work`](Self::work) done since its last call. Any thread may call it.
    ///
    /// ```
    /// # let scene = abbe::Scene::parse("camera = { position = [0, 0, 4], look_at = [0, 0, 0], vertical_fov = 40 }
    /// # film = { width = 8, height = 8 }
    /// # light = [{ environment = { radiance = 1 } }]", "")?;
    /// let options = abbe::Options { samples: Some(64), ..Default::default() };
    /// let mut rendering = abbe::Rendering::new(&scene, &options)?;
    /// while rendering.advance(&|_| ()) {
    ///     let so_far = rendering.image();
    ///     println!("{} camera samples", so_far.report().samples);
    /// }
    /// # assert_eq!(rendering.image().report().samples, 64 * 64);
    /// # Ok::<(), abbe::Error>(())
    /// ```
    pub fn advance(&mut self, progress: &(dyn Fn(u64) + Sync)) -> bool {
        run_on(&self.threads, || self.passes.advance(progress))
    }

    /// Renders the next pass like [`advance`](Self::advance), but stops before the next pixels once `is_due` returns
    /// true. `is_due` is called again and again, from any thread.
    ///
    /// A render that has stopped can be looked at, [saved](Self::save) and continued. The final image is the same.
    ///
    /// ```
    /// # let scene = abbe::Scene::parse("camera = { position = [0, 0, 4], look_at = [0, 0, 0], vertical_fov = 40 }
    /// # film = { width = 8, height = 8 }
    /// # light = [{ environment = { radiance = 1 } }]", "")?;
    /// # let folder = tempfile::tempdir().expect("a folder");
    /// # let path = folder.path().join("image.checkpoint");
    /// use std::time::{Duration, Instant};
    /// let mut rendering = abbe::Rendering::new(&scene, &abbe::Options::default())?;
    /// let mut due = Instant::now() + Duration::from_secs(60);
    /// loop {
    ///     match rendering.advance_until(&|_| (), &|| Instant::now() > due) {
    ///         abbe::Advance::Finished => break,
    ///         abbe::Advance::Passed => {}
    ///         abbe::Advance::Stopped => {
    ///             rendering.save(&path)?;
    ///             due = Instant::now() + Duration::from_secs(60);
    ///         }
    ///     }
    /// }
    /// # Ok::<(), abbe::Error>(())
    /// ```
    pub fn advance_until(&mut self, progress: &(dyn Fn(u64) + Sync), is_due: &(dyn Fn() -> bool + Sync)) -> Advance {
        run_on(&self.threads, || self.passes.advance_until(progress, is_due))
    }

    /// Returns how much of the [`work`](Self::work) is done.
    pub fn done(&self) -> u64 {
        self.passes.done()
    }

    /// Returns the number of camera samples taken so far.
    pub fn camera_samples(&self) -> u64 {
        self.passes.camera_samples()
    }

    /// Writes a checkpoint: all sums so far, from which another run continues to the same image.
    ///
    /// # Errors
    /// If it cannot be written. An existing file is then untouched.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        checkpoint::save(path.as_ref(), &self.identity, &Finished::default(), &self.passes)
    }

    /// Writes the checkpoint of a finished render that has written its files, so that
    /// [`has_written`](Self::has_written) recognizes them after it is resumed. `way` describes how they were written,
    /// for example with which exposure.
    ///
    /// # Errors
    /// The errors of [`save`](Self::save).
    pub fn save_finished(&self, path: impl AsRef<Path>, files: &[impl AsRef<Path>], way: &str) -> Result<()> {
        let written = files.iter().filter_map(|file| Written::from_file(file.as_ref(), way)).collect();
        checkpoint::save(path.as_ref(), &self.identity, &Finished::new(&self.render, written), &self.passes)
    }

    /// Returns whether the finished render that this one was resumed from has written a file in the same way, and
    /// nobody has changed it since.
    pub fn has_written(&self, file: impl AsRef<Path>, way: &str) -> bool {
        Written::from_file(file.as_ref(), way).is_some_and(|file| self.written.contains(&file))
    }

    /// Continues from a checkpoint of the same scene, seed, image, layers and plan. More samples may be requested.
    ///
    /// ```
    /// # let scene = abbe::Scene::parse("camera = { position = [0, 0, 4], look_at = [0, 0, 0], vertical_fov = 40 }
    /// # film = { width = 8, height = 8 }
    /// # light = [{ environment = { radiance = 1 } }]", "")?;
    /// # let folder = tempfile::tempdir().expect("a folder");
    /// # let path = folder.path().join("image.checkpoint");
    /// let options = abbe::Options { samples: Some(64), ..Default::default() };
    /// let mut first = abbe::Rendering::new(&scene, &options)?;
    /// first.advance(&|_| ());
    /// first.save(&path)?;
    /// let mut second = abbe::Rendering::new(&scene, &options)?;
    /// assert_eq!(second.resume(&path)?, abbe::Resumed::Continues);
    /// assert_eq!(second.run(&|_| ()).film(), first.run(&|_| ()).film());
    /// # Ok::<(), abbe::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Arguments`] if it is a checkpoint of something else, or cannot become this image; [`Error::Decode`] if
    /// it is damaged. In that case this render must not be used any more.
    pub fn resume(&mut self, path: impl AsRef<Path>) -> Result<Resumed> {
        let (resumed, written) = checkpoint::resume(path.as_ref(), &self.identity, &mut self.passes)?;
        (self.written, self.resumed_at) = (written, self.done());
        Ok(resumed)
    }

    /// Writes the finished tiles of a part of an image, for [`merge`](super::merge).
    ///
    /// # Errors
    /// [`Error::Arguments`] if samples are left to take. If the file cannot be written, an existing one is untouched.
    pub fn write_part(&self, path: impl AsRef<Path>) -> Result<()> {
        if !self.passes.is_finished() {
            let message = "a part of an image can be written only once all its samples are taken".to_owned();
            return Err(Error::Arguments { message, help: None });
        }
        part::write(path.as_ref(), &self.identity, self.shard, self.summary(), &self.passes)
    }

    /// Returns the error of the image at the last look, if a stop rule measures it.
    pub fn error(&self) -> Option<ImageError> {
        let &Measured { noise, blur, alpha } = self.passes.measured()?;
        let (model, stopped_by) = (self.plan.model_error, self.passes.stopped_by());
        let rare_light = run_on(&self.threads, || stopped_by.and_then(|_| self.passes.rare_light()));
        let method = &self.plan.method;
        let has_highlights = !(method.highlights.is_empty() && method.lens_lights.is_empty());
        Some(ImageError {
            requested: self.render.error,
            noise,
            blur,
            alpha,
            rare_light,
            has_highlights,
            model,
            stopped_by,
        })
    }

    /// Returns the image of all samples so far.
    pub fn image(&self) -> Image {
        self.image_with(run_on(&self.threads, || self.passes.film()))
    }

    /// Returns all that is known about the image so far, except its pixels and layer values. It takes little memory.
    pub fn summary(&self) -> Image {
        self.image_with(self.passes.frame())
    }

    fn image_with(&self, film: Film) -> Image {
        let (report, error) = (self.passes.report(), self.error());
        // Within a pass, some pixels have more samples than others. Then this is the mean.
        let mean_samples = report.samples.div_ceil((u64::from(film.width) * u64::from(film.height)).max(1));
        let samples = if self.passes.is_finished() { self.passes.samples().into() } else { mean_samples };
        let mut provenance = self.provenance.clone();
        provenance.set_count(SAMPLES, samples);
        provenance.set_count(NON_FINITE, report.non_finite);
        let stopped_by = report.stopped_by.map(|reason| ("stoppedBy".into(), Fact::Text(reason.name().to_owned())));
        provenance.facts.extend(stopped_by.into_iter().chain(error.iter().flat_map(error_facts)));
        if !self.passes.is_finished() {
            provenance.facts.push(("complete".into(), Fact::Count(0)));
        }
        if let Some(began) = self.began {
            provenance.time = Some(SystemTime::now());
            let threads = Fact::Count(self.threads.current_num_threads() as u64);
            let time = Fact::Number(began.elapsed().as_secs_f64());
            provenance.facts.extend([("renderTime".into(), time), ("threads".into(), threads)]);
        }
        let (because, format) = (self.plan.because.clone(), self.format.clone());
        let dark_warning = self.dark_warning.clone().filter(|_| self.passes.is_finished());
        Image { film, report, error, because, view: self.view, format, provenance, dark_warning }
    }

    /// Renders all remaining passes. `progress` is called like by [`advance`](Self::advance).
    pub fn run(mut self, progress: &(dyn Fn(u64) + Sync)) -> Image {
        while self.advance(progress) {}
        self.image()
    }
}

/// Refuses a film that is known not to fit into memory, before the first sample is taken: an allocation that fails
/// later ends the process without a message. A small film always fits.
fn check_memory(scene: &Scene, method: &Method, shard: Shard) -> Result<()> {
    let bytes = (bytes_of_film(scene, method) + scene.layer_bytes()) / u64::from(shard.count());
    let is_available = || Vec::<u8>::new().try_reserve_exact(usize::try_from(bytes).unwrap_or(usize::MAX)).is_ok();
    if bytes < 1_000_000_000 || is_available() {
        return Ok(());
    }
    let path = format!("the film in memory, {:.1} GB", bytes as f64 / 1e9).into();
    Err(Error::Io { doing: "keep", path, source: ErrorKind::OutOfMemory.into() })
}

/// Returns the facts about an image's error that its file records.
fn error_facts(error: &ImageError) -> Vec<(Cow<'static, str>, Fact)> {
    let [at_most, noise] = [error.at_most(), error.noise.expected].map(Fact::Number);
    let facts = [("errorAtMost", at_most), ("noise", noise), ("modelError", Fact::Number(error.model))];
    let blur = (error.blur.at_most > 0.0).then_some(("blur", Fact::Number(error.blur.expected)));
    let alpha = error.alpha.map(|alpha| ("alphaNoise", Fact::Number(alpha.expected)));
    facts.into_iter().chain(blur).chain(alpha).map(|(key, fact)| (key.into(), fact)).collect()
}

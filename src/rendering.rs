//! Floor 6: a scene made into an image, for programs; the `render` command is one of them.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::{Duration, Instant, SystemTime};

use crate::error::{Error, Result};
use crate::film::{
    Fact, Film, Format, LONGEST_NAME, Layer, Overscan, Pixel, Provenance, View, Window, encode_exr, light_layer_name,
    write_exr, write_png, write_spectral_exr,
};
use crate::plan::{Plan, plan};
use crate::scene::{FilmSettings, ModelText, Projection, Scene};
use crate::trace::{self, Report, World, prepare};

/// What replaces the scene's own settings. By default nothing does.
///
/// ```
/// let quick = abbe::Options { samples: Some(4), ..abbe::Options::default() };
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Camera samples per pixel, 1 or more.
    pub samples: Option<u32>,
    /// Chooses another set of random numbers.
    pub seed: Option<u64>,
    /// What is made around the format, in pixels.
    pub overscan: Option<Overscan>,
    /// The part of the image and its overscan that is made, in pixels of the format.
    pub crop: Option<Window>,
    /// Layers in place of the scene's own.
    pub layers: Option<Vec<Layer>>,
    /// Whether spectra are made, as they are where the scene asks for them.
    pub spectral: bool,
    /// Processor threads; one for each processor if absent. The image is the same for any number.
    pub threads: Option<usize>,
    /// Whether the file says when the image was made, on how many threads, and how long it took. Then no two files are
    /// the same to the byte.
    pub stamp: bool,
}

impl Options {
    /// Puts these settings in place of the scene's own.
    ///
    /// # Errors
    /// [`Error::Arguments`] if there are no samples, the overscan is too wide, the crop lies outside the image and its
    /// overscan, or its layers cannot be written, together or in the scene's format.
    pub fn apply(&self, scene: &mut Scene) -> Result<()> {
        if self.samples == Some(0) {
            return refuse("a pixel needs at least 1 sample".into(), "leave the samples out to take the scene's own");
        }
        let (samples, seed, film) = self.instead_of(scene);
        if let Some(message) = film.objection_to_overscan() {
            return refuse(
                message,
                "--overscan takes one number of pixels, or those to the left, above, to the right and below",
            );
        }
        if let Some(message) = film.objection_to_crop() {
            return refuse(message, "--crop takes first column, first row, width and height");
        }
        (scene.render.samples, scene.render.seed, scene.film) = (samples, seed, film);
        if let Some(layers) = &self.layers {
            scene.format.layers.clone_from(layers);
        }
        if self.spectral {
            scene.format.spectral.get_or_insert_default();
        }
        check_layers(scene)
    }

    /// Samples, seed and film that replace those of a scene.
    fn instead_of(&self, scene: &Scene) -> (Option<u32>, u64, FilmSettings) {
        let samples = self.samples.or(scene.render.samples);
        let (overscan, crop) = (self.overscan.unwrap_or(scene.film.overscan), self.crop.or(scene.film.crop));
        (samples, self.seed.unwrap_or(scene.render.seed), FilmSettings { overscan, crop, ..scene.film })
    }
}

fn refuse<T>(message: String, help: &str) -> Result<T> {
    Err(Error::Arguments { message, help: Some(help.to_owned()) })
}

/// Most bytes of memory that layers may take: 64 GB.
const MOST_OF_LAYERS: u64 = 64_000_000_000;

/// Refuses layers that fill all memory, cannot be made or do not fit the format, and lights whose layers' names cannot
/// be written.
fn check_layers(scene: &Scene) -> Result<()> {
    if let Some((message, help)) = scene.format.objection() {
        return refuse(message, &help);
    }
    if scene.layer_bytes() > MOST_OF_LAYERS {
        let gigabytes = scene.layer_bytes() / 1_000_000_000;
        let message = format!("{} channels of layers would take {gigabytes} GB of memory", scene.layer_channels());
        return refuse(message, "ask for fewer layers, or make a part of the image at a time with --crop");
    }
    if scene.format.spectral.is_some() && scene.render.model == ModelText::Rgb {
        let message = "model = \"rgb\" has no wavelengths to make spectra of".into();
        return refuse(message, "leave the model out, or ask for wavelengths: model = { bands = 32 }");
    }
    if !scene.format.layers.contains(&Layer::Lights) {
        return Ok(());
    }
    let help = "give that light or object a `group` of at most 23 letters a to z, digits and _";
    let mut known = BTreeMap::new();
    for group in &scene.light_groups {
        let name = light_layer_name(group);
        if name.len() + ".R".len() > LONGEST_NAME {
            let message = format!("the layer {name} would have a name that not every program reads: it is too long");
            return refuse(message, help);
        }
        let other = known.entry(name.clone()).or_insert(group);
        if *other != group {
            return refuse(format!("the lights {other} and {group} would share the layer {name}"), help);
        }
    }
    Ok(())
}

/// Renders a scene.
///
/// # Errors
/// As [`Rendering::new`].
pub fn render(scene: &Scene, options: &Options) -> Result<Image> {
    Ok(Rendering::new(scene, options)?.run(&|_| ()))
}

/// A render that is planned: run to its end, or pass by pass with a look at the image after each.
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
    passes: trace::Rendering<World>,
    view: View,
    format: Format,
    /// The scene file's hash, the projection and the filter.
    origin: Origin,
    threads: rayon::ThreadPool,
    /// When it began, if the file says that.
    began: Option<Instant>,
}

struct Origin {
    hash: String,
    projection: Projection,
    filter: String,
    /// Values in place of the scene file's, as on a command line.
    settings: String,
}

impl Rendering {
    /// Decides how to render a scene, and prepares it.
    ///
    /// # Errors
    /// [`Error::Arguments`] if the options do not fit the scene, or threads cannot be started.
    pub fn new(scene: &Scene, options: &Options) -> Result<Self> {
        let began = options.stamp.then(Instant::now);
        let mut scene = Cow::Borrowed(scene);
        let is_as_asked = options.instead_of(&scene) == (scene.render.samples, scene.render.seed, scene.film);
        if is_as_asked && options.layers.is_none() && !options.spectral {
            check_layers(&scene)?;
        } else {
            options.apply(scene.to_mut())?;
        }
        let threads = rayon::ThreadPoolBuilder::new().num_threads(options.threads.unwrap_or(0)).build();
        let threads = threads
            .map_err(|error| Error::Arguments { message: format!("cannot start threads: {error}"), help: None })?;
        let plan = threads.install(|| plan(&scene));
        let world = prepare(&scene, plan.method.clone());
        let camera = &scene.camera;
        let view = View {
            world_to_camera: camera.world_to_camera(),
            world_to_ndc: camera.world_to_ndc(),
            screen_window_width: camera.screen_window_width(),
            screen_window_center: camera.screen_window_center(),
            latlong: camera.projection() == Projection::Equirectangular,
            optics: camera.optics(scene.render.meters_per_unit),
        };
        let settings: Vec<String> = scene.settings.iter().map(|setting| format!("--set {setting}")).collect();
        let (hash, filter, settings) = (scene.hash.clone(), scene.film.filter.described(), settings.join(" "));
        Ok(Self {
            plan,
            passes: trace::Rendering::new(world),
            view,
            format: scene.format.clone(),
            origin: Origin { hash, projection: camera.projection(), filter, settings },
            threads,
            began,
        })
    }

    /// How it will be rendered, and why.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// How much there is to do: camera samples and photons.
    pub fn work(&self) -> u64 {
        trace::work(self.passes.world())
    }

    /// How long it will take, about, if nothing else keeps the processors busy.
    pub fn expected(&self) -> Duration {
        self.plan.processor_time.div_f64(self.threads.current_num_threads() as f64)
    }

    /// Renders the next pass, if one is left, and answers whether another one is. Passes take more and more samples, or
    /// gather photons of their own.
    ///
    /// `progress` is told how much of the [`work`](Self::work) was done since it was last told, from any thread.
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
        self.threads.install(|| self.passes.advance(progress))
    }

    /// The image of all samples so far.
    pub fn image(&self) -> Image {
        let (film, report) = (self.passes.film(), self.passes.report());
        let mut provenance = provenance(&self.origin, &self.plan, self.passes.samples(), &report);
        if let Some(began) = self.began {
            provenance.time = Some(SystemTime::now());
            let threads = Fact::Count(self.threads.current_num_threads() as u64);
            let time = Fact::Seconds(began.elapsed().as_secs_f64());
            provenance.facts.extend([("renderTime", time), ("threads", threads)]);
        }
        let (because, format) = (self.plan.because.clone(), self.format.clone());
        Image { film, report, because, view: self.view, format, provenance }
    }

    /// Renders all passes that are left; `progress` as of [`advance`](Self::advance).
    pub fn run(mut self, progress: &(dyn Fn(u64) + Sync)) -> Image {
        while self.advance(progress) {}
        self.image()
    }
}

/// A rendered image, and all that is known of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    film: Film,
    report: Report,
    because: Vec<String>,
    view: View,
    format: Format,
    provenance: Provenance,
}

impl Image {
    /// Pixels per row of what was made: the format, with its overscan or a part of it.
    pub fn width(&self) -> u32 {
        self.film.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.film.height
    }

    /// Linear red, green and blue of all pixels in the film's color space, row by row from the top left.
    pub fn rgb(&self) -> Vec<[f32; 3]> {
        self.film.pixels.iter().map(|pixel| pixel.rgb).collect()
    }

    /// Linear red, green and blue of the pixel in column `x`, row `y`, counted from 0 at the top left of what was made.
    ///
    /// # Panics
    /// If there is no such pixel.
    pub fn rgb_at(&self, x: u32, y: u32) -> [f32; 3] {
        assert!(x < self.width(), "there is no column {x} in an image of {} pixels per row", self.width());
        self.film.at(x, y).rgb
    }

    /// All values of a layer by its name in the file, row by row from the top left; none if there is no such layer.
    ///
    /// | name | value |
    /// |---|---|
    /// | `R`, `G`, `B` | linear color |
    /// | `A` | share of the camera rays that met something, 0 to 1 |
    /// | `Z` | nearest depth in scene units, 1e10 where nothing is met |
    /// | `albedo.R`, `N.X`, .. | what was asked for beside them |
    pub fn layer(&self, name: &str) -> Option<Vec<f32>> {
        let value: fn(&Pixel) -> f32 = match name {
            "R" => |pixel| pixel.rgb[0],
            "G" => |pixel| pixel.rgb[1],
            "B" => |pixel| pixel.rgb[2],
            "A" => |pixel| pixel.alpha,
            "Z" => |pixel| pixel.depth,
            _ => return self.layer_beside(name),
        };
        Some(self.film.pixels.iter().map(value).collect())
    }

    /// A channel of a layer that was asked for.
    fn layer_beside(&self, name: &str) -> Option<Vec<f32>> {
        let (layer, channel) = name.rsplit_once('.')?;
        let image = self.film.layers.iter().find(|image| image.name == layer)?;
        let number = image.layer.channels().iter().position(|known| *known == channel)?;
        Some(image.channel(number).collect())
    }

    /// The pixels as they are, with what they mean.
    pub fn film(&self) -> &Film {
        &self.film
    }

    /// What rendering noticed: samples, rays, light that was left out.
    pub fn report(&self) -> &Report {
        &self.report
    }

    /// How it was rendered and why, one decision a line.
    pub fn because(&self) -> &[String] {
        &self.because
    }

    /// Writes a linear OpenEXR file with all layers, the camera, and everything that another run needs to make the same
    /// bytes. Answers how many values were too large for 16 bits, if it has those, and became 65504.
    ///
    /// # Errors
    /// If it cannot be written; a file that was there before is then untouched.
    pub fn write_exr(&self, path: impl AsRef<Path>) -> Result<u64> {
        write_exr(&self.film, &self.format, &self.view, &self.provenance, path.as_ref())
    }

    /// The bytes of that file, and how many values became 65504.
    ///
    /// # Errors
    /// If it cannot be encoded.
    pub fn exr_bytes(&self) -> Result<(Vec<u8>, u64)> {
        encode_exr(&self.film, &self.format, &self.view, &self.provenance, Path::new("the image"))
    }

    /// The spectrum of the pixel in column `x`, row `y`, counted from 0 at the top left; none if spectra were not asked
    /// for.
    ///
    /// Each band is its center in nm and its radiance per nm, the mean over the band, on the scale of the scene's
    /// `samples`: an even spectrum of 1 is 1 in all of them, and has luminance 1 in the image.
    ///
    /// # Panics
    /// If there is no such pixel.
    pub fn spectrum_at(&self, x: u32, y: u32) -> Option<Vec<[f64; 2]>> {
        let spectral = self.film.spectral.as_ref()?;
        assert!(x < self.width(), "there is no column {x} in an image of {} pixels per row", self.width());
        let values = spectral.pixel(y as usize * self.film.width as usize + x as usize).iter();
        Some(spectral.bands.centers_nm().zip(values).map(|(nm, &value)| [nm, value.into()]).collect())
    }

    /// Writes the spectra of all pixels as an OpenEXR file, in the layout of Fichet, Pacanowski & Wilkie 2021; nothing
    /// if they were not asked for.
    ///
    /// # Errors
    /// As [`write_exr`](Self::write_exr).
    pub fn write_spectral_exr(&self, path: impl AsRef<Path>) -> Result<()> {
        write_spectral_exr(&self.film, &self.format, &self.view, &self.provenance, path.as_ref())
    }

    /// Writes an 8-bit sRGB picture for looking, brightened by 2^`exposure`.
    ///
    /// # Errors
    /// If it cannot be written; a file that was there before is then untouched.
    pub fn write_png(&self, path: impl AsRef<Path>, exposure: f64) -> Result<()> {
        write_png(&self.film, exposure, path.as_ref())
    }
}

fn provenance(origin: &Origin, plan: &Plan, samples: u32, report: &Report) -> Provenance {
    let text = |text: &str| Fact::Text(text.to_owned());
    let method = &plan.method;
    let wavelengths: Vec<String> = method.basis.wavelengths_nm().iter().map(f64::to_string).collect();
    let pass = method.light_pass.as_ref();
    let photons = pass.map(|pass| ("photons", Fact::Count(pass.photons)));
    let blur = pass.and_then(|pass| pass.map).map(|map| ("photonRadius", text(&format!("{:.3} pixels", map.radius))));
    let facts = [
        ("version", text(env!("CARGO_PKG_VERSION"))),
        ("sceneHash", text(&origin.hash)),
        ("model", text(&method.basis.name())),
        ("wavelengths", text(&wavelengths.join(" "))),
        ("projection", text(origin.projection.name())),
        ("transport", text(method.transport.name())),
        ("filter", text(&origin.filter)),
        ("samples", Fact::Count(samples.into())),
        ("seed", text(&method.seed.to_string())),
        ("nonFinite", Fact::Count(report.non_finite)),
    ];
    let settings = (!origin.settings.is_empty()).then(|| ("set", text(&origin.settings)));
    Provenance { facts: facts.into_iter().chain(settings).chain(photons).chain(blur).collect(), time: None }
}

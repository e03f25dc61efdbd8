//! The command line.

use std::error::Error as _;
use std::ffi::{OsStr, OsString};
use std::num::{ParseFloatError, ParseIntError};
use std::path::{Path, PathBuf};
use std::time::Duration;

use abbe::film::{Layer, Overscan, Window};
use abbe::scene::share;
use abbe::{Error, Options, Result};
use clap::error::{ContextKind, ErrorKind};
use clap::{Command, CommandFactory, Parser};

use super::frames::{Frames, check_has_number, frame_path};
use super::messages::{Listener, Protocol, is_colored, listener, set_listener};
use super::outputs::{check_exposure, check_png, has_extension, is_stdio};
use super::suggestions::{suggest, suggest_for_subcommand};
use super::{catalog, diff, info, manual, merge, saving, view};

const HELP: &str = "\
Commands:
  render catalog      list the glasses, metals, lights and colors it knows
  render info         describe an OpenEXR image
  render view         show an image on the terminal
  render diff         test whether two images agree
  render merge        combine the parts of an image
  render completions  write a completion script for a shell
  render man          write the manual page
Each has its own help: render merge --help

Examples:
  render --exr scenes/prism.toml                  write ./prism.exr
  render scenes/prism.toml --exr out/frame.exr    name the file
  render scenes/prism.toml --png look.png         write only a picture
  render --exr scenes/prism.toml --png look.png   write both
  render --plan scenes/prism.toml                 explain how it would render
  render --check scenes/prism.toml                find mistakes in the scene
  render --samples 16 --exr scenes/prism.toml     take a quick look
  render --error 0.01 --exr scenes/prism.toml     stop at an error of 1 %
  render --layers all --exr scenes/prism.toml     write layers beside the image
  render --spectral --exr scenes/prism.toml       write spectra beside the image
  render --checkpoint 60s --exr scenes/prism.toml save progress for --resume
  render --shard 1/4 --exr scenes/prism.toml      make one of four parts
  render merge prism.exr prism.*.part             combine them
  render --plan s.toml --plan-file s.plan         make a plan for all parts
  render --set film.width=320 scenes/prism.toml   change a value of the scene
  render --frame 1-24 turn.toml                   render frames, one by one
  render - --exr frame.exr < scenes/prism.toml    read it from standard input
  render --json --exr scenes/prism.toml           report to a program
  render catalog --help                           see which glasses it knows
  render info prism.exr                           list what an image holds
  render view prism.exr                           show it on the terminal
  render diff prism.exr other.exr                 compare two images
  render completions bash                         write completions for bash
  render man                                      write the manual page

Exit codes: 0 done, 1 the render or a file failed, 2 bad arguments or scene,
130 stopped by Ctrl-C, SIGTERM or SIGHUP.";

/// Render a TOML scene to a linear OpenEXR image.
#[derive(Clone, Parser)]
#[command(name = "render", version, after_help = HELP)]
struct Arguments {
    /// The scene, a TOML file; - is standard input
    scene: Option<PathBuf>,

    /// The image to write; without a path, the scene's name in the current folder; - is standard output. It is written
    /// unless --png alone is given
    #[arg(long, value_name = "FILE.exr", num_args = 0..=1)]
    exr: Option<Option<PathBuf>>,

    /// Write an 8-bit sRGB picture to look at; without --exr, no EXR is written then
    #[arg(long, value_name = "FILE.png")]
    png: Option<PathBuf>,

    /// Brighten the picture of --png by 2^STOPS (the EXR never changes)
    #[arg(long, value_name = "STOPS", allow_negative_numbers = true)]
    exposure: Option<f64>,

    /// Report what would be modeled, why, and at what cost; render nothing
    #[arg(long, conflicts_with_all = ["check", "png"])]
    plan: bool,

    /// With --plan, write the plan to this file. Otherwise read it from there, so that the parts of an image need not
    /// all plan for themselves. A plan belongs to one scene with its options, and does not change the image. If the
    /// scene sets an error or a time, write the plan with --shard 1/N as well
    #[arg(long, value_name = "FILE.plan", conflicts_with = "check")]
    plan_file: Option<PathBuf>,

    /// Check the scene; render nothing
    #[arg(long, conflicts_with = "png")]
    check: bool,

    /// Replace a value of the scene: the path of a key and a TOML value, such as film.width=320 or
    /// object.ball.shape.sphere.radius=2. Objects, lights and other list entries go by name, or by number from 1. A
    /// value that is not TOML is taken as text: object.wine glass.material=gold. A name with a dot needs quotes:
    /// object."a.b". A single word sets a variable of the scene: angle=45
    #[arg(long, value_name = "KEY=VALUE", allow_hyphen_values = true)]
    set: Vec<String>,

    /// The frame to render: the value of the variable frame, and of every %04d or %d in the names of the files to
    /// write, where %% is a percent sign. 1-24 renders a range of frames, 1-24x2 every second of them, and 3,17,40-50
    /// a list
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    frame: Option<Frames>,

    /// Write only warnings and errors
    #[arg(long, conflicts_with = "json")]
    quiet: bool,

    /// Write everything to standard output as one JSON object per line: plan, progress, report, files, warnings, errors
    #[arg(long)]
    json: bool,

    /// Report progress on standard output, in the protocol of a render farm; everything else goes to its log
    #[arg(long, value_name = "PROTOCOL", conflicts_with_all = ["json", "quiet", "plan", "check"])]
    progress: Option<Protocol>,

    /// Camera samples per pixel, instead of the scene's; with --error or --time, the maximum
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..))]
    samples: Option<u32>,

    /// Take samples until the image is off by no more than this in 95 of 100 renders: 0.01 is one percent. The first of
    /// --error, --time and --samples to be reached ends the render; the scene's own samples then no longer count
    #[arg(long, value_name = "RATIO", allow_negative_numbers = true, value_parser = ratio)]
    error: Option<f64>,

    /// Take samples for this long: 90s, 10m, 1.5h
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, value_parser = saving::time)]
    time: Option<Duration>,

    /// Choose another set of random numbers, instead of the scene's
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = seed)]
    seed: Option<u64>,

    /// Render extra pixels around the format, instead of the scene's overscan: one number for all sides, or four for
    /// left, top, right and bottom
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = overscan)]
    overscan: Option<Overscan>,

    /// Render only this part of the image, instead of the scene's crop: first column, first row, width, height; in the
    /// overscan, the first column and row may be negative
    #[arg(long, value_name = "X,Y,W,H", allow_hyphen_values = true, value_parser = crop)]
    crop: Option<Window>,

    /// Layers of the EXR beside the image, instead of the scene's, such as albedo,N,lights; all for all but those of
    /// polarization, or "" for none. S1, S2 and S3 stay if film.stokes is set
    #[arg(long, value_name = "NAMES", value_parser = layers)]
    layers: Option<LayerList>,

    /// Write the spectrum of each pixel beside the EXR, as NAME.spectral.exr
    #[arg(long, conflicts_with = "check")]
    spectral: bool,

    /// Processor threads; all if absent. The image does not depend on the number
    #[arg(long, value_name = "N", allow_negative_numbers = true,
          value_parser = clap::value_parser!(u16).range(1..=i64::from(Options::MAX_THREADS)))]
    threads: Option<u16>,

    /// Write a report on the render as JSON: its plan, its time and memory, the error of the image and why it stopped
    #[arg(long, value_name = "FILE.json", conflicts_with_all = ["plan", "check"])]
    report: Option<PathBuf>,

    #[command(flatten)]
    saving: saving::Flags,

    /// Record in the EXR when it was made, how long that took, and on how many threads. Without it, two runs write the
    /// same bytes
    #[arg(long, conflicts_with_all = ["plan", "check"])]
    stamp: bool,
}

fn seed(text: &str) -> std::result::Result<u64, String> {
    text.parse().map_err(|_| format!("a seed is a whole number from 0 to {}", u64::MAX))
}

fn ratio(text: &str) -> std::result::Result<f64, String> {
    text.parse().map_err(|_| match share(text) {
        Some(share) => format!("write {share} for {} %", text.trim_end_matches('%').trim()),
        None => "an error is a number, such as 0.01 for one percent".into(),
    })
}

fn overscan(text: &str) -> std::result::Result<Overscan, String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[pixels]) => Ok(Overscan::even(pixels)),
        Some(&[left, top, right, bottom]) => Ok(Overscan { left, top, right, bottom }),
        _ => Err("overscan is one or four whole numbers of pixels, such as 16 or 16,8,16,8".into()),
    }
}

fn crop(text: &str) -> std::result::Result<Window, String> {
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    let parse_as = |[left, top, width, height]: [&str; 4]| {
        let [left, top] = [left, top].map(str::parse::<i32>);
        let [width, height] = [width, height].map(str::parse::<u32>);
        Some(Window { left: left.ok()?, top: top.ok()?, width: width.ok()?, height: height.ok()? })
    };
    let window = <[&str; 4]>::try_from(parts).ok().and_then(parse_as);
    window.ok_or_else(|| "a crop is four whole numbers of pixels, such as 100,50,320,180".into())
}

/// The layers in the argument of `--layers`.
#[derive(Clone)]
struct LayerList(Vec<Layer>);

fn layers(text: &str) -> std::result::Result<LayerList, String> {
    if text.trim().is_empty() {
        return Ok(LayerList(Vec::new()));
    }
    Layer::of_names(text.split(',').map(str::trim)).map(LayerList)
}

/// The jobs that the arguments describe: one, or one per frame.
pub struct Jobs(Box<Arguments>);

impl Jobs {
    /// Returns the number of jobs.
    pub fn count(&self) -> u64 {
        self.0.frame.as_ref().map_or(1, Frames::count)
    }

    /// Returns the requested number of processor threads.
    pub fn threads(&self) -> Option<usize> {
        self.0.threads.map(usize::from)
    }

    /// Returns the flags for checkpoints, snapshots and parts.
    pub fn saving(&self) -> &saving::Flags {
        &self.0.saving
    }

    /// Returns one job after another.
    pub fn each(&self) -> impl Iterator<Item = Result<Job>> {
        let numbers = self.0.frame.iter().flat_map(Frames::numbers).map(Some);
        let no_frame = self.0.frame.is_none().then_some(None);
        numbers.chain(no_frame).map(|frame| job((*self.0).clone(), frame))
    }

    /// Returns the jobs of the frames with the lowest and the highest number.
    pub fn ends(&self) -> impl Iterator<Item = Result<Job>> {
        self.0.frame.iter().flat_map(Frames::ends).map(|frame| job((*self.0).clone(), Some(frame)))
    }

    /// Refuses arguments that do not work with several frames.
    fn check(&self) -> Result<()> {
        let Arguments { exr, png, report, plan_file, progress, scene, .. } = &*self.0;
        if self.count() == 1 {
            return Ok(());
        }
        if progress.is_some() {
            return Error::refuse("--progress reports a single frame", "give the farm one task per frame: --frame 1");
        }
        // Without a scene argument, the argument of --exr is the scene.
        let exr = exr.iter().flatten().filter(|_| scene.is_some());
        let files = exr.chain(png).chain(report).chain(plan_file);
        files.into_iter().try_for_each(|path| check_has_number(path))
    }
}

/// A scene, and what to do with it.
pub struct Job {
    /// The number of the frame, if one is given.
    pub frame: Option<u32>,
    pub scene: PathBuf,
    /// Values that replace those of the scene, as `KEY=VALUE`.
    pub set: Vec<String>,
    pub output: Output,
    pub exposure: f64,
    pub options: Options,
    pub saving: saving::Flags,
    /// The file for the report on the render.
    pub report: Option<PathBuf>,
}

/// What to make of a scene.
pub enum Output {
    Image {
        exr: Option<PathBuf>,
        png: Option<PathBuf>,
    },
    /// The plan, and the file to write it to, if any.
    Plan(Option<PathBuf>),
    Check,
}

/// What the command line requests.
pub enum Request {
    Render(Jobs),
    Catalog(catalog::Query),
    Info(info::Query),
    View(view::Query),
    Diff(diff::Query),
    Merge(merge::Query),
    /// Help, the version, completions or the manual page.
    Answer(String),
}

/// Returns whether the arguments, which may contain mistakes, include `--progress` for a farm.
fn has_progress_flag(words: &[OsString]) -> bool {
    words.iter().filter_map(|word| word.to_str()).any(|word| word.split('=').next() == Some("--progress"))
}

/// Parses the command line. Prints clap's own errors and exits, unless a program or a farm reads the messages.
pub fn parse() -> Result<Request> {
    let words: Vec<OsString> = std::env::args_os().collect();
    let sub = SUBCOMMANDS.iter().find(|(name, ..)| words.get(1).is_some_and(|first| first == name));
    if let Some((_, _, request)) = sub {
        return request(&words[1..]);
    }
    let parsed = Arguments::try_parse_from(&words);
    set_listener(match &parsed {
        Ok(arguments) if arguments.quiet => Listener::Quiet,
        Ok(arguments) if arguments.json => Listener::Program,
        Ok(Arguments { progress: Some(Protocol::Openjd), .. }) => Listener::Farm,
        Err(_) if words.iter().any(|word| word == "--json") => Listener::Program,
        Err(_) if has_progress_flag(&words) => Listener::Farm,
        _ => Listener::Person,
    });
    if let Some((message, help)) = suggest(parsed.as_ref().err(), &words, &SUBCOMMANDS.map(|(name, ..)| name)) {
        return Error::refuse(message, help);
    }
    parsed.map_or_else(handle_clap_error, |arguments| {
        let jobs = Jobs(Box::new(arguments));
        jobs.check().map(|()| Request::Render(jobs))
    })
}

/// A subcommand: its name, its arguments, and a parser for its words, the first of which is its name.
type Subcommand = (&'static str, fn() -> Command, fn(&[OsString]) -> Result<Request>);

const SUBCOMMANDS: [Subcommand; 7] = [
    ("catalog", catalog::Query::command, |words| parse_as(words, Request::Catalog)),
    ("info", info::Query::command, |words| parse_as(words, Request::Info)),
    ("view", view::Query::command, |words| parse_as(words, Request::View)),
    ("diff", diff::Query::command, |words| parse_as(words, Request::Diff)),
    ("merge", merge::Query::command, |words| {
        if has_progress_flag(words) {
            set_listener(Listener::Farm);
        }
        parse_as(words, Request::Merge)
    }),
    ("completions", manual::Completions::command, |words| {
        parse_as(words, |query| Request::Answer(manual::completions(&query, root())))
    }),
    ("man", manual::Manual::command, |words| {
        parse_as(words, |manual::Manual {}| Request::Answer(manual::page(root())))
    }),
];

/// Returns the command with all its subcommands.
fn root() -> Command {
    let sub = SUBCOMMANDS.map(|(name, arguments, _)| arguments().name(name).bin_name(format!("render {name}")));
    Arguments::command().subcommands(sub).disable_help_subcommand(true)
}

fn parse_as<A: Parser>(words: &[OsString], request: fn(A) -> Request) -> Result<Request> {
    let refused = |clap_report| match suggest_for_subcommand(&clap_report, words) {
        Some((message, help)) => Error::refuse(message, help),
        None => handle_clap_error(clap_report),
    };
    A::try_parse_from(words).map_or_else(refused, |arguments| Ok(request(arguments)))
}

/// Converts what clap reports: help and the version become answers, mistakes become errors or end the process.
fn handle_clap_error(clap_report: clap::Error) -> Result<Request> {
    if let (ErrorKind::ValueValidation, Some(why)) = (clap_report.kind(), clap_report.source()) {
        // Such as `--layers <NAMES>`.
        let flag = clap_report.get(ContextKind::InvalidArg).map(ToString::to_string).unwrap_or_default();
        let flag = flag.split(' ').next().unwrap_or_default();
        let given = clap_report.get(ContextKind::InvalidValue).map(ToString::to_string).unwrap_or_default();
        let message = match (why.is::<ParseIntError>(), why.is::<ParseFloatError>()) {
            (true, _) => format!("{flag} takes a whole number, not {given}"),
            (_, true) => format!("{flag} takes a number, not {given}"),
            _ => match allowed_range(&why.to_string()) {
                Some(range) => format!("{flag} takes a whole number {range}, not {given}"),
                None => format!("{flag}: {why}"),
            },
        };
        return Err(Error::Arguments { message, help: None });
    }
    if clap_report.use_stderr() && matches!(listener(), Listener::Program | Listener::Farm) {
        let text = clap_report.render().to_string();
        let (message, _) = text.split_once("\n\n").unwrap_or((&text, ""));
        return Error::refuse(message.strip_prefix("error: ").unwrap_or(message), "render --help lists all arguments");
    }
    if clap_report.use_stderr() {
        clap_report.exit();
    }
    let styled = clap_report.render();
    let text = if is_colored(&std::io::stdout()) { styled.ansi().to_string() } else { styled.to_string() };
    Ok(Request::Answer(text))
}

/// Finds the allowed range of a number in clap's message, and returns it in words.
fn allowed_range(clap_report: &str) -> Option<String> {
    let (_, range) = clap_report.split_once(" is not in ")?;
    let (first, last) = range.split_once("..=")?;
    Some(format!("from {first} to {last}"))
}

fn job(arguments: Arguments, frame: Option<u32>) -> Result<Job> {
    let noop = [("--plan", arguments.plan), ("--check", arguments.check)];
    let noop = noop.into_iter().find_map(|(flag, is_given)| is_given.then_some(flag));
    let with_exr = noop.is_none() && (arguments.exr.is_some() || arguments.png.is_none());
    let (scene, exr) = scene_and_image(arguments.scene, arguments.exr, noop)?;
    check_exposure(arguments.exposure)?;
    if arguments.exposure.is_some() && arguments.png.is_none() {
        let help = "add --png look.png, or leave --exposure out";
        return Error::refuse("--exposure brightens only the picture of --png, and --png is not given", help);
    }
    check_png(arguments.png.as_deref())?;
    arguments.saving.check(noop, with_exr, arguments.png.is_some(), arguments.stamp)?;
    if arguments.spectral && !with_exr && arguments.png.is_some() {
        let help = "add --exr, or leave --spectral out";
        return Error::refuse("--spectral writes spectra beside an EXR, and --png alone writes no EXR", help);
    }
    let mut plan_file = arguments.plan_file.map(|path| frame_path(&path, frame)).transpose()?;
    let output = if arguments.plan {
        Output::Plan(plan_file.take())
    } else if arguments.check {
        Output::Check
    } else {
        let named = |exr: Option<PathBuf>| exr.map_or_else(|| exr_path(&scene, frame), |exr| frame_path(&exr, frame));
        let exr = with_exr.then(|| named(exr)).transpose()?;
        Output::Image { exr, png: arguments.png.map(|path| frame_path(&path, frame)).transpose()? }
    };
    let flags = [("--json", arguments.json), ("--progress", arguments.progress.is_some())];
    if let (Output::Image { exr: Some(exr), .. }, Some((flag, _))) =
        (&output, flags.iter().find(|(_, is_given)| *is_given))
        && is_stdio(exr)
    {
        let message = format!("{flag} and --exr - would both write to standard output");
        return Error::refuse(message, "name the image, as in --exr out/frame.exr");
    }
    let Arguments { samples, error, time, seed, overscan, crop, layers, spectral, threads, stamp, saving, .. } =
        arguments;
    let (exposure, layers) = (arguments.exposure.unwrap_or(0.0), layers.map(|LayerList(layers)| layers));
    let shard = saving.shard();
    let options = Options {
        samples,
        error,
        time,
        seed,
        overscan,
        crop,
        layers,
        spectral,
        threads: threads.map(usize::from),
        shard,
        plan: plan_file,
        stamp,
    };
    let report = arguments.report.map(|path| frame_path(&path, frame)).transpose()?;
    let set = frame.map(|frame| format!("set.frame={frame}")).into_iter().chain(arguments.set).collect();
    Ok(Job { frame, scene, set, output, exposure, options, saving, report })
}

/// Tells the scene from the image. `--exr` may take an image, but right before the only path it takes the scene.
///
/// `noop` is the flag that renders nothing, if one is given.
fn scene_and_image(
    scene: Option<PathBuf>,
    exr: Option<Option<PathBuf>>,
    noop: Option<&str>,
) -> Result<(PathBuf, Option<PathBuf>)> {
    let is_exr = |path: &Path| has_extension(path, "exr");
    match (scene, exr.flatten()) {
        (Some(scene), Some(image)) if is_exr(&image) || is_stdio(&image) => match noop {
            Some(flag) => {
                let message = format!("{flag} renders nothing, so {} would not be written", image.display());
                Error::refuse(message, "leave one of them out")
            }
            None => Ok((scene, Some(image))),
        },
        (Some(_), Some(image)) => {
            let message = format!("--exr writes a file that ends in .exr, not {}", image.display());
            Error::refuse(message, "name the scene once, and the image as in --exr out/frame.exr")
        }
        (Some(scene), None) => Ok((scene, None)),
        (None, Some(scene)) if !is_exr(&scene) => Ok((scene, None)),
        (None, _) => Error::refuse("no scene is given", "name a scene, a TOML file: render --exr scene.toml"),
    }
}

/// Returns the name of the scene, followed by the number of its frame and `.exr`, in the current folder.
fn exr_path(scene: &Path, frame: Option<u32>) -> Result<PathBuf> {
    if is_stdio(scene) {
        let message = "a scene from standard input has no file name to name the image after";
        return Error::refuse(message, "name the image, as in render - --exr out/frame.exr");
    }
    let mut name = scene.file_stem().unwrap_or(OsStr::new("image")).to_owned();
    if let Some(frame) = frame {
        name.push(format!(".{frame:04}"));
    }
    name.push(".exr");
    Ok(name.into())
}

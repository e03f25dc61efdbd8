//! Checkpoints and snapshots, so that a stopped render loses nothing.

use std::cell::Cell;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::time::Duration;

use abbe::film::Shard;
use abbe::scene::duration;
use abbe::{Advance, Error, ImageError, Options, Rendering, Result, Resumed, Scene, Timer};
use abbe::{has_finished, is_checkpoint};
use clap::Args;

use super::error_text::problem;
use super::messages::{error_so_far, say, warn};
use super::progress::Progress;
use super::signals::{self, is_stopped};

/// The flags for checkpoints, snapshots and parts.
#[derive(Args, Clone)]
pub struct Flags {
    /// Save the state to NAME.checkpoint beside the image at this interval (60s, 5m, 1h), and when Ctrl-C stops it.
    /// Saving takes at most 1 % of the time, so large images are saved less often
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, value_parser = time)]
    checkpoint: Option<Duration>,

    /// Continue from NAME.checkpoint, if it exists, to the same image. From 16, 32, 64 and so on samples it also
    /// continues to more of them, unless these need another plan (as where photons are gathered) or half_a and half_b
    /// are requested. It also saves a checkpoint, every 60 s unless --checkpoint sets the interval
    #[arg(long)]
    resume: bool,

    /// Write the image so far at this interval while rendering: 30s, 5m
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, value_parser = time)]
    snapshot: Option<Duration>,

    /// Render one of N parts of the image to NAME.i-of-N.part, for `render merge`
    #[arg(long, value_name = "i/N", value_parser = shard)]
    shard: Option<Shard>,
}

/// The time between checkpoints if --resume is given without --checkpoint.
const DEFAULT_INTERVAL: Duration = Duration::from_secs(60);

pub fn time(text: &str) -> std::result::Result<Duration, String> {
    duration(text).ok_or_else(|| "a time is a number with a unit, such as 60s, 5m or 1h".into())
}

fn shard(text: &str) -> std::result::Result<Shard, String> {
    let parts = text.split_once('/');
    let numbers = parts.and_then(|(number, count)| Some([number.parse().ok()?, count.parse().ok()?]));
    let shard = numbers.and_then(|[number, count]| Shard::new(number, count));
    shard.ok_or_else(|| "a part is given as its number and the number of parts, such as 1/16, 2/16, up to 16/16".into())
}

impl Flags {
    /// Returns the part of the image to render.
    pub fn shard(&self) -> Shard {
        self.shard.unwrap_or_default()
    }

    /// Refuses flags that do not fit the other arguments. `noop` is the flag that renders nothing, if one is given, and
    /// `exr` and `png` tell whether these images are written.
    ///
    /// # Errors
    /// If there is such a flag.
    pub fn check(&self, noop: Option<&str>, exr: bool, png: bool, stamp: bool) -> Result<()> {
        let keeps = [("--checkpoint", self.checkpoint.is_some()), ("--resume", self.resume)];
        // If an error or a time ends the render, each part has a plan of its own, so --plan may go with --shard.
        let is_planned = noop == Some("--plan");
        let flags = [("--snapshot", self.snapshot.is_some()), ("--shard", self.shard.is_some() && !is_planned)];
        if let Some((flag, _)) = keeps.into_iter().chain(flags).find(|(_, given)| *given && noop.is_some()) {
            return Error::refuse(format!("{flag} belongs to a render, and nothing is rendered"), "leave it out");
        }
        if self.shard.is_some() && !is_planned && (!exr || png) {
            let help = "leave --png out, and make a picture of the merged image";
            return Error::refuse("--shard makes a part of an EXR, not a picture", help);
        }
        if self.shard.is_some() && stamp {
            return Error::refuse(
                "parts of an image record no time, so --stamp cannot be used with --shard",
                "leave it out",
            );
        }
        if self.snapshot.is_some() && (!exr || self.shard.is_some()) {
            return Error::refuse("--snapshot keeps an EXR up to date, but no EXR is written", "leave it out");
        }
        Ok(())
    }

    /// Refuses to keep anything of an image that goes to standard output.
    ///
    /// # Errors
    /// If a flag asks to keep something.
    pub fn check_stdout(&self) -> Result<()> {
        let keeps = self.checkpoint.or(self.snapshot).is_some() || self.resume || self.shard.is_some();
        if keeps {
            let message = "--checkpoint, --resume, --snapshot and --shard write files beside the image, which standard output does not allow";
            return Error::refuse(message, "name the image, as in --exr out/frame.exr");
        }
        Ok(())
    }

    /// Lets Ctrl-C stop the command, either at once or after saving what is done.
    ///
    /// # Errors
    /// If Ctrl-C cannot be caught.
    pub fn catch_signals(&self) -> Result<()> {
        signals::catch_ctrl_c(self.checkpoint.or(self.snapshot).is_none() && !self.resume)
    }

    /// Returns the path of the checkpoint of a render to `file`, if one is kept.
    pub fn checkpoint(&self, file: &Path) -> Option<PathBuf> {
        let mut name = file.file_stem().unwrap_or(OsStr::new("image")).to_owned();
        name.push(".checkpoint");
        (self.checkpoint.is_some() || self.resume).then(|| file.with_file_name(name))
    }

    /// Returns the path of the part of an image, if only a part is rendered.
    pub fn part(&self, image: &Path) -> Option<PathBuf> {
        self.shard.map(|shard| image.with_extension(format!("{}-of-{}.part", shard.number(), shard.count())))
    }
}

/// The files that keep the state of a render, and when they are written.
pub struct Saver {
    files: Files,
    checkpoints: Timer,
    snapshots: Timer,
    resume: bool,
    /// What the files of a finished render depend on besides its samples.
    settings: String,
}

/// The files that keep the state of a render.
struct Files {
    /// The path of the checkpoint, if one is kept.
    checkpoint: Option<PathBuf>,
    /// The path of the image that is updated during the render, if one is.
    snapshot: Option<PathBuf>,
    /// Whether the last update of the snapshot succeeded.
    has_snapshot: Cell<bool>,
}

impl Files {
    fn save(&self, rendering: &Rendering) -> Result<()> {
        self.checkpoint.as_ref().map_or(Ok(()), |path| rendering.save(path))
    }

    fn take_snapshot(&self, rendering: &Rendering) -> Result<()> {
        let Some(path) = &self.snapshot else { return Ok(()) };
        // Before the first camera samples, the image would show only a part of the photons' light.
        if rendering.camera_samples() == 0 {
            return Ok(());
        }
        let image = rendering.image();
        let (colors, spectra) = (image.write_exr(path), image.write_spectral_exr(path.with_extension("spectral.exr")));
        self.has_snapshot.set(colors.is_ok());
        colors.and(spectra)
    }
}

impl Saver {
    /// Prepares to keep a render to `file`, with a checkpoint if its path is given. `settings` is what the files of the
    /// render depend on besides its samples.
    ///
    /// # Errors
    /// If the checkpoint of an earlier run or another file would be overwritten.
    pub fn new(flags: &Flags, file: &Path, checkpoint: Option<PathBuf>, settings: String) -> Result<Self> {
        if let Some(existing) = checkpoint.as_deref().filter(|path| !flags.resume && path.exists()) {
            let name = existing.display();
            if !is_checkpoint(existing)? {
                let help = "name another image, or move that file away";
                return Error::refuse(format!("{name} would be overwritten, but it is not a checkpoint"), help);
            }
            let help = "add --resume to go on from it, or delete it to start over";
            return Error::refuse(format!("{name} already exists from an earlier run"), help);
        }
        let snapshot = flags.snapshot.map(|_| file.to_owned());
        Ok(Self {
            files: Files { checkpoint, snapshot, has_snapshot: Cell::new(false) },
            checkpoints: Timer::new(flags.checkpoint.or(flags.resume.then_some(DEFAULT_INTERVAL))),
            snapshots: Timer::new(flags.snapshot),
            resume: flags.resume,
            settings,
        })
    }

    /// Returns whether an earlier run has finished the same render and written its files, and reports it. Needs no
    /// plan.
    pub fn has_finished(&self, scene: &Scene, options: &Options, outputs: &[&Path]) -> bool {
        // A plan that is followed is checked in any case.
        let path = self.files.checkpoint.as_deref().filter(|_| self.resume && options.plan.is_none());
        let finished = path.filter(|path| has_finished(path, scene, options.shard, outputs, &self.settings));
        finished.inspect(|path| say_finished(path)).is_some()
    }

    /// Resumes from the checkpoint, if requested and if there is one. Returns whether anything is left to do. `outputs`
    /// are the files that have to exist in the end.
    ///
    /// # Errors
    /// If the checkpoint is damaged or of another render, or if it has more samples than requested but not all of the
    /// files.
    pub fn resume(&self, rendering: &mut Rendering, outputs: &[&Path]) -> Result<bool> {
        let Some(path) = self.files.checkpoint.as_deref().filter(|_| self.resume) else { return Ok(true) };
        if !path.exists() {
            say(&format!("there is no {} yet: the render starts from the beginning", path.display()));
            return Ok(true);
        }
        let name = path.display();
        let resumed = rendering.resume(path)?;
        let missing = outputs.iter().find(|output| !rendering.has_written(output, &self.settings));
        match resumed {
            Resumed::Continues => {
                let share = rendering.done() as f64 / rendering.work().max(1) as f64;
                let of_work = format!(", which has {:.0} % of the work", (100.0 * share).floor());
                say(&format!("going on from {name}{}", if rendering.is_work_known() { &of_work } else { "" }));
                Ok(true)
            }
            Resumed::Finished if missing.is_none() => {
                say_finished(path);
                Ok(false)
            }
            Resumed::Finished => Ok(true),
            Resumed::HasMore(samples) => match missing {
                None => {
                    say(&format!("{name} has {samples} samples per pixel, more than asked for: nothing is left to do"));
                    Ok(false)
                }
                Some(missing) => Error::refuse(
                    format!("{name} has {samples} samples per pixel, but {} was not written", missing.display()),
                    format!("add --samples {samples} to write it"),
                ),
            },
        }
    }

    /// Renders what is left. Returns true if the image is finished, and false if somebody stopped the render.
    ///
    /// # Errors
    /// If the render was stopped and cannot be saved.
    pub fn run(&mut self, rendering: &mut Rendering, progress: &Progress) -> Result<bool> {
        signals::begin_work();
        let mut last_error = rendering.error();
        loop {
            let is_due = || is_stopped() || self.checkpoints.is_due() || self.snapshots.is_due();
            let advance = rendering.advance_until(&|done| progress.advance(done), &is_due);
            progress.update_total(rendering);
            if advance == Advance::Finished {
                return Ok(true);
            }
            let error = rendering.error();
            if error != last_error {
                let more = expected_samples(rendering, error.as_ref()).zip(progress.left());
                error.iter().for_each(|error| progress.say(&error_so_far(error, more.as_ref())));
                last_error = error;
            }
            if is_stopped() {
                return self.save_stopped(rendering, progress).map(|()| false);
            }
            if advance == Advance::Stopped {
                let kept = self.save_progress(rendering);
                // The render is worth more than a failed save: it continues, and its image may still be written.
                kept.unwrap_or_else(|error| {
                    progress.warn(&format!("the render goes on, but {}", problem(&error)));
                });
            }
        }
    }

    /// Saves a stopped render as a checkpoint and as a snapshot. If one fails, the other is still written.
    fn save_stopped(&self, rendering: &Rendering, progress: &Progress) -> Result<()> {
        let (saved, taken) = (self.files.save(rendering), self.files.take_snapshot(rendering));
        if self.files.checkpoint.is_some() && saved.is_ok() {
            // The render can be resumed without its snapshot.
            taken.err().iter().for_each(|error| progress.warn(&problem(error)));
            return Ok(());
        }
        match (&saved, &taken) {
            (Ok(()), Ok(())) => {}
            (Err(_), Err(error)) => progress.say(&format!("stopped; {}", problem(error))),
            (Err(_), Ok(())) if self.files.has_snapshot.get() => {
                progress.say("stopped; the snapshot is kept, but no checkpoint");
            }
            _ => progress.say("stopped; what is done is not kept"),
        }
        saved.and(taken)
    }

    /// Writes the checkpoint, and the snapshot if it is due.
    fn save_progress(&mut self, rendering: &Rendering) -> Result<()> {
        let Self { files, checkpoints, snapshots, .. } = self;
        let mut save = || checkpoints.run(|| files.save(rendering));
        if !snapshots.is_due() {
            return save();
        }
        // The snapshot timer counts the time of the checkpoint as well.
        snapshots.run(|| save().and(files.take_snapshot(rendering)))
    }

    /// Writes the checkpoint of a finished render and records its written files, if one is kept. A failure is only a
    /// warning, because the image exists all the same.
    pub fn finish(&self, rendering: &Rendering, written: &[&Path]) {
        let kept = self
            .files
            .checkpoint
            .as_ref()
            .map_or(Ok(()), |path| rendering.save_finished(path, written, &self.settings));
        kept.unwrap_or_else(|error| warn(&format!("the render is finished, but {}", problem(&error))));
    }

    /// Prints what was kept, and how to resume.
    pub fn say_how_to_resume(&self) {
        let Some(path) = &self.files.checkpoint else {
            if !self.files.has_snapshot.get() {
                return say(signals::NOTHING_KEPT);
            }
            return say("stopped; the snapshot is kept. With --checkpoint 60s, a render can also be continued later");
        };
        let mut words: Vec<String> = std::env::args_os().map(|word| quoted(&word)).collect();
        if !self.resume {
            words.push("--resume".into());
        }
        say(&format!("stopped; {} keeps what is done. Go on with\n  {}", path.display(), words.join(" ")));
    }
}

fn say_finished(checkpoint: &Path) {
    let name = checkpoint.display();
    say(&format!("{name} has all samples that are needed, and the image is written: nothing is left to do"));
}

/// Estimates how many samples per pixel will be taken in total. Returns none if that is not known, or if there are
/// already as many.
fn expected_samples(rendering: &Rendering, error: Option<&ImageError>) -> Option<u32> {
    let max = rendering.plan().method.stop.as_ref()?.max_samples;
    let times = rendering.work() as f64 / rendering.done().max(1) as f64;
    scaled_up(error?.noise.samples, times, max)
}

/// Returns `taken` multiplied by `times`, but at most `max`, if that is more than `taken`. The work is known only to
/// within a few photons, so `times` may be slightly too large.
fn scaled_up(taken: u32, times: f64, max: u32) -> Option<u32> {
    let scaled = ((f64::from(taken) * times).round() as u32).min(max);
    (scaled > taken).then_some(scaled)
}

/// Quotes a word for the shell.
fn quoted(word: &OsStr) -> String {
    let Some(word) = word.to_str() else {
        // Shells read $'\xe9' as a byte.
        let of_byte = |&byte: &u8| match byte {
            b'\'' | b'\\' => format!("\\{}", char::from(byte)),
            b' '..=b'~' => char::from(byte).into(),
            _ => format!("\\x{byte:02x}"),
        };
        return format!("$'{}'", word.as_encoded_bytes().iter().map(of_byte).collect::<String>());
    };
    let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "_-./=,:+%@".contains(letter);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.into()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_more_samples_are_announced_than_allowed() {
        assert_eq!(scaled_up(8192, 8.0002, 65536), Some(65536));
        assert_eq!(scaled_up(8192, 2.0, 65536), Some(16384));
        assert_eq!(scaled_up(65536, 1.0001, 65536), None);
    }

    #[test]
    fn a_word_is_quoted_where_the_shell_would_split_it() {
        let words = ["a/b.toml", "a b", "it's", ""].map(|word| quoted(OsStr::new(word)));
        assert_eq!(words, ["a/b.toml", "'a b'", "'it'\\''s'", "''"]);
    }
}

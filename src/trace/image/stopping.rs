//! Decides when enough samples are taken.

use std::time::{Duration, Instant};

use serde::Serialize;

use super::noise::Measured;
use super::passes::Progress;
use crate::trace::Stop;
use crate::trace::replicates::REPLICATES;

/// Samples of each replicate before the first look at the noise. Further looks come whenever they have doubled.
const FIRST_STAGE: u32 = 8;
/// Fewest samples of a pixel that tell its noise.
pub const FIRST_LOOK: u32 = REPLICATES as u32 * FIRST_STAGE;
/// Share of the time left that a stage is planned to take, and share of all time that is too short for another one.
const STAGE_TIME_SHARE: f64 = 0.95;
const MIN_TIME_SHARE: f64 = 0.02;

/// What ended a render that had a stop rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Stopped {
    /// The error is as small as requested.
    #[serde(rename = "error")]
    Noise,
    /// The time is up.
    Time,
    /// The most samples allowed are taken.
    Samples,
}

impl Stopped {
    /// Returns what ended a render.
    pub(super) fn new(stop: &Stop, progress: &Progress) -> Self {
        match () {
            () if is_enough(stop, progress.measured.as_ref()) => Self::Noise,
            () if progress.stage.before >= max_each(stop) => Self::Samples,
            () => Self::Time,
        }
    }

    /// Returns the word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Noise => "error",
            Self::Time => "time",
            Self::Samples => "samples",
        }
    }
}

/// The speed of a render.
#[derive(Clone, Debug)]
pub struct Clock {
    began: Instant,
    /// When this run began its first stage, and the samples of each pixel at that time.
    first: Option<(Instant, u32)>,
}

impl Clock {
    pub fn new(began: Instant) -> Self {
        Self { began, first: None }
    }

    /// Notes that a stage begins, after `samples` samples of each pixel.
    pub fn begin(&mut self, samples: u32) {
        self.first.get_or_insert((Instant::now(), samples));
    }

    /// Returns what is left of a time since the render began.
    fn remaining(&self, time: Duration) -> Duration {
        time.saturating_sub(self.began.elapsed())
    }

    /// Estimates how many samples of each pixel a time allows, after `samples` of them; `None` if that is not known.
    fn samples_in(&self, time: Duration, samples: u32) -> Option<f64> {
        let (since, before) = self.first?;
        let taken = samples.checked_sub(before).filter(|&taken| taken > 0)?;
        Some(f64::from(taken) * time.as_secs_f64() / since.elapsed().as_secs_f64())
    }
}

/// Whether noise and blur are small enough, measured with enough samples to say so.
fn is_enough(stop: &Stop, measured: Option<&Measured>) -> bool {
    let is_small = |wanted: f64, error: &Measured| error.noise.samples >= stop.min_samples && error.at_most() <= wanted;
    stop.noise.zip(measured).is_some_and(|(wanted, error)| is_small(wanted, error))
}

fn max_each(stop: &Stop) -> u32 {
    stop.max_samples / REPLICATES as u32
}

/// Returns how many samples each replicate takes next after `each`, if there is room and time for them.
pub fn next_stage_size(stop: &Stop, each: u32) -> u32 {
    match (each, stop.time) {
        (0, None) => FIRST_STAGE,
        (0, Some(_)) => 1,
        _ => each,
    }
}

/// Returns how many samples each replicate takes in the next stage; 0 if enough are taken.
pub fn next_stage(stop: &Stop, progress: &Progress, clock: &Clock) -> u32 {
    if is_enough(stop, progress.measured.as_ref()) {
        return 0;
    }
    let each = progress.stage.before;
    let size = next_stage_size(stop, each).min(max_each(stop) - each.min(max_each(stop)));
    match stop.time {
        Some(time) if each > 0 => {
            let remaining_time = clock.remaining(time);
            let all = REPLICATES as u32 * each;
            if remaining_time < time.mul_f64(MIN_TIME_SHARE) {
                return 0;
            }
            // A run that continues from a checkpoint does not yet know how fast it is.
            let fits = clock
                .samples_in(remaining_time.mul_f64(STAGE_TIME_SHARE), all)
                .map_or(1.0, |samples| samples / REPLICATES as f64);
            size.min(fits as u32)
        }
        _ => size,
    }
}

/// Whether it is roughly known how many samples of a pixel are enough: for an error alone, not before the first look.
pub fn can_estimate_samples(stop: &Stop, progress: &Progress) -> bool {
    stop.noise.is_none() || stop.time.is_some() || progress.measured.is_some()
}

/// Estimates how many samples of a pixel will be enough; if that is not known, returns the most that are taken.
pub fn estimate_samples(stop: &Stop, progress: &Progress, clock: &Clock) -> u32 {
    let stage = progress.stage;
    let each = stage.before + stage.size;
    let mut wanted = each.max(FIRST_STAGE).min(max_each(stop));
    if let (Some(goal), Some(measured)) = (stop.noise, &progress.measured) {
        let times = (measured.at_most() / goal).powi(2);
        let least = (times * f64::from(stage.before)).max(f64::from(stop.min_samples / REPLICATES as u32));
        while f64::from(wanted) < least && wanted < max_each(stop) {
            wanted = wanted.saturating_mul(2).min(max_each(stop));
        }
    } else {
        wanted = max_each(stop);
    }
    let wanted = REPLICATES as u32 * wanted;
    let (taken, time) = (REPLICATES as u32 * stage.before, stop.time);
    let in_time = time.and_then(|time| clock.samples_in(clock.remaining(time), taken));
    in_time.map_or(wanted, |more| wanted.min(taken.saturating_add(more as u32)).max(REPLICATES as u32 * each))
}
